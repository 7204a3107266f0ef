"""The values of a system's text, worked out by Python's own parser and arithmetic: nothing of
twinslip is in it.
"""

from __future__ import annotations

import ast
import math
import sys
from typing import Any, Callable

import numpy as np

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_FUNCTIONS: dict[str, Callable[..., float]] = {
    "exp": np.exp,
    "ln": np.log,
    "log10": np.log10,
    "sqrt": np.sqrt,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "asinh": np.arcsinh,
    "atan": np.arctan,
    "abs": abs,
    "min": min,
    "max": max,
    "pow": pow,
}


class TextOfSystem:
    """A system's text, read."""

    def __init__(self, text: str) -> None:
        self.table: dict[str, Any] = tomllib.loads(text)
        self.states: list[str] = self.table["states"]
        self.parameters: dict[str, float] = self.table.get("parameters", {})
        self.defined: dict[str, str] = self.table.get("where", {})

    def rates(self, values: list[float], t: float = math.nan) -> list[float]:
        """The rates of all states at these values, and at this time."""
        known = {"t": t, "pi": math.pi, **self.parameters, **dict(zip(self.states, values))}

        def of_name(name: str) -> float:
            if name not in known:
                known[name] = of_formula(self.defined[name])
            return known[name]

        def of_formula(text: str) -> float:
            return value(ast.parse(text.replace("^", "**"), mode="eval").body)

        def value(node: ast.AST) -> float:
            if isinstance(node, ast.Constant):
                return float(node.value)
            if isinstance(node, ast.Name):
                return of_name(node.id)
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                return _FUNCTIONS[node.func.id](*map(value, node.args))
            if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
                return -value(node.operand)
            assert isinstance(node, ast.BinOp), ast.dump(node)
            a, b = value(node.left), value(node.right)
            return _operation(node.op, a, b)

        return [of_formula(self.table["rates"][state]) for state in self.states]


def _operation(operator: ast.operator, a: float, b: float) -> float:
    made: float | complex
    if isinstance(operator, ast.Add):
        made = a + b
    elif isinstance(operator, ast.Sub):
        made = a - b
    elif isinstance(operator, ast.Mult):
        made = a * b
    elif isinstance(operator, ast.Div):
        made = a / b
    else:
        assert isinstance(operator, ast.Pow), ast.dump(operator)
        made = a**b
    assert not isinstance(made, complex)
    return made
