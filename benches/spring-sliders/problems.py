#!/usr/bin/env python3
"""The problems of problems.json, their formulas in the languages of the runners, and the norm of the error; run as a
program it writes PROBLEMS.md.

Formulas consist of numbers, names, `+ - * /`, parentheses, `pi` and exp, log, sinh, cosh, sin, cos, pow(x, y). Names are, in
this order: `t`, parameters, constants, states, and what `where` defines, each by those before it.
"""

import ast
import json
import math
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

HERE = Path(__file__).resolve().parent


@dataclass
class Form:
    """A problem in one choice of variables. `segments` are (end, changed parameters), in order of time."""

    problem: dict
    name: str
    states: list
    sizes: list
    start: list
    where: dict
    rates: list
    compared: dict

    def segments(self, stops=()):
        """(end, parameters as texts) of each stretch of time, which end at these stops too; the last is that of the last comparison."""
        until = Fraction(self.problem["times"][-1])
        changes = self.problem.get("segments", [{"until": self.problem["times"][-1]}])
        made = []
        for end in sorted({until, *map(Fraction, stops), *(Fraction(change["until"]) for change in changes)}):
            change = next((change for change in changes if end <= Fraction(change["until"])), changes[-1])
            changed = {name: value for name, value in change.items() if name != "until"}
            made.append((end, self.problem["parameters"] | changed))
        return made

    def numbers(self, parameters, number=float, functions=math):
        """Parameters and constants as numbers of a kind."""
        known = {name: number(value) for name, value in parameters.items()}
        for name, formula in self.problem["constants"].items():
            known[name] = value_of(formula, known, number, functions)
        return known

    def begin(self, number=float, functions=math):
        known = self.numbers(self.problem["parameters"], number, functions)
        return [value_of(formula, known, number, functions) for formula in self.start]

    def compare(self, state, number=float, functions=math):
        """The compared quantities in this state."""
        known = self.numbers(self.problem["parameters"], number, functions) | dict(zip(self.states, state))
        return {name: value_of(formula, known, number, functions) for name, formula in self.compared.items()}


def load():
    with open(HERE / "problems.json") as file:
        return json.load(file)["problems"]


def form(problem, name):
    """A form of a problem by its name."""
    found = next(found for found in problem["forms"] if found["name"] == name)
    states = found["states"]
    sizes = [float(found.get("sizes", {}).get(state, 1)) for state in states]
    start = [found["start"][state] for state in states]
    rates = [found["rates"][state] for state in states]
    return Form(problem, name, states, sizes, start, found["where"], rates, found["compared"])


def references():
    with open(HERE / "references.json") as file:
        return {made["name"]: made for made in json.load(file)["problems"]}


def error(compared, reference):
    """The largest of |q - Q|/(1 + |Q|) over the compared quantities q with the references Q."""
    if not all(map(math.isfinite, compared.values())):
        raise ValueError("the result is not a number")
    return max(abs(compared[name] - float(known)) / (1.0 + abs(float(known))) for name, known in reference.items())


def value_of(formula, known, number=float, functions=math):
    """The value of a formula, where numbers are of a kind, and functions those of a module."""

    def value(node):
        match node:
            case ast.Constant():
                return number(ast.get_source_segment(formula, node))
            case ast.Name(id="pi"):
                return +functions.pi
            case ast.Name():
                return known[node.id]
            case ast.UnaryOp(op=ast.USub()):
                return -value(node.operand)
            case ast.BinOp():
                left, right = value(node.left), value(node.right)
                match node.op:
                    case ast.Add():
                        return left + right
                    case ast.Sub():
                        return left - right
                    case ast.Mult():
                        return left * right
                    case ast.Div():
                        return left / right
            case ast.Call(func=ast.Name(id="pow")):
                base, exponent = map(value, node.args)
                return base**exponent
            case ast.Call():
                return getattr(functions, node.func.id)(value(node.args[0]))
        raise ValueError(f"{formula!r} has what formulas here may not have")

    return value(ast.parse(formula, mode="eval").body)


def written(formula, functions="", real="{}.0"):
    """A formula as text in Python or C: whole numbers become real ones, and functions belong to a module."""
    tree = ast.parse(formula, mode="eval")
    names = {node.func.id for node in ast.walk(tree) if isinstance(node, ast.Call)} | {"pi"}

    class Writer(ast.NodeTransformer):
        def visit_Name(self, node):
            return ast.Name(functions + node.id) if node.id in names else node

        def visit_BinOp(self, node):
            node = self.generic_visit(node)
            return ast.Call(ast.Name("pow"), [node.left, node.right], []) if isinstance(node.op, ast.Pow) else node

        def visit_Constant(self, node):
            return ast.Name(real.format(node.value)) if isinstance(node.value, int) else node

    return ast.unparse(Writer().visit(tree))


def jacobian(made):
    """Lines `name = formula` and rows of formulas: the exact Jacobian of the rates, common parts computed once."""
    import sympy

    symbols = {name: sympy.Symbol(name, real=True) for name in made.states}
    names = set(made.problem["parameters"]) | set(made.problem["constants"]) | {"t"}
    known = symbols | {name: sympy.Symbol(name, real=True) for name in names}
    exact = lambda text: sympy.Rational(text)  # noqa: E731
    for name, formula in made.where.items():
        known[name] = value_of(formula, known, exact, sympy)
    rates = [value_of(formula, known, exact, sympy) for formula in made.rates]
    entries = [rate.diff(symbols[state]) for rate in rates for state in made.states]
    common, entries = sympy.cse(entries, symbols=sympy.numbered_symbols("common"))
    return [(str(name), str(formula)) for name, formula in common], list(map(str, entries))


def python_rates(made, parameters):
    """`f(t, y)` and `jacobian(t, y)` of a form as Python functions of lists, in scalars of `math`."""
    unpack = f"    {', '.join(made.states)}, = y\n"
    lines = [f"    {name} = {written(formula)}\n" for name, formula in made.where.items()]
    rates = ", ".join(written(formula) for formula in made.rates)
    text = "def f(t, y):\n" + unpack + "".join(lines) + f"    return [{rates}]\n"
    common, entries = jacobian(made)
    lines = [f"    {name} = {written(expression)}\n" for name, expression in common]
    count = len(made.states)
    rows = [", ".join(map(written, entries[row * count : (row + 1) * count])) for row in range(count)]
    text += "def jacobian(t, y):\n" + unpack + "".join(lines) + f"    return [[{'], ['.join(rows)}]]\n"
    names = {name: getattr(math, name) for name in "exp log sinh cosh sin cos pow sqrt tanh pi".split()}
    scope = names | made.numbers(parameters)
    exec(text, scope)  # noqa: S102

    def guarded(function, failed):
        """Not numbers for a trial state outside of the formulas: a shorter step is wanted."""

        def value(t, y):
            try:
                made = function(t, y)
            except (ArithmeticError, ValueError):
                return failed
            return made

        return value

    nan = [math.nan] * count
    return guarded(scope["f"], nan), guarded(scope["jacobian"], [nan] * count)


def page(problems):
    """PROBLEMS.md."""
    lines = [
        "# The problems",
        "",
        "Written by `problems.py` from `problems.json`. [README.md](README.md) explains symbols, units and the norm of the error. Each problem is given in",
        "two choices of variables with the same solution: `logarithm` follows logarithms of the state (and of the slip rate), `state` these themselves.",
        "The value in brackets behind a variable is that at t = 0.",
    ]
    for problem in problems:
        lines += ["", f"## {problem['title']} (`{problem['name']}`)", "", problem["about"], "", "```text"]
        lines += [", ".join(f"{name} = {value}" for name, value in problem["parameters"].items())]
        lines += [", ".join(f"{name} = {formula}" for name, formula in problem["constants"].items())]
        begin = "0"
        for change in problem.get("segments", []):
            changed = ", ".join(f"{name} = {value}" for name, value in change.items() if name != "until")
            lines.append(f"{changed} from t = {begin} to {change['until']}")
            begin = change["until"]
        lines.append(f"compared at t = {', '.join(problem['times'])}; the last is the end")
        lines.append("```")
        for made in problem["forms"]:
            lines += ["", f"`{made['name']}`:", "", "```text"]
            lines += [f"{name} = {formula}" for name, formula in made["where"].items()]
            lines += [f"d{name}/dt = {formula}    ({made['start'][name]})" for name, formula in made["rates"].items()]
            lines.append("compared: " + ", ".join(f"{name} = {formula}" for name, formula in made["compared"].items()))
            lines.append("```")
        lines += ["", "twinslip:", "", "```text", problem["twinslip"], "```"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    (HERE / "PROBLEMS.md").write_text(page(load()))
