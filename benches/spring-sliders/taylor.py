"""First reference: power series in time, by recurrences, in numbers of MPFR (gmpy2).

Each formula becomes a list of operations. Order by order every operation gets its next coefficient from those known
(Moore 1966; Jorba and Zou 2005), and each state from the coefficient of its rate. A step ends where the last terms of
the series are negligible. The form is that of logarithms.
"""

import ast
from fractions import Fraction
from operator import mul

import gmpy2
from gmpy2 import mpfr

from problems import value_of

BITS = 220
ORDER = 45
#: What the last terms of a series may add, relative to 1 + |y|.
NEGLIGIBLE = mpfr("1e-37")


def number(text):
    """An exact decimal, rounded once; a double as it is."""
    fraction = Fraction(text)
    return mpfr(fraction.numerator) / mpfr(fraction.denominator)


class Functions:
    """What formulas may call, of numbers."""

    exp, log, sinh, cosh, sin, cos = gmpy2.exp, gmpy2.log, gmpy2.sinh, gmpy2.cosh, gmpy2.sin, gmpy2.cos

    @property
    def pi(self):
        return gmpy2.const_pi()


class Series:
    """The operations of the rates of a form, in the order in which they can be done."""

    def __init__(self, form, known):
        self.done, self.steps = {}, []
        self.states = [[] for _ in form.states]
        self.t = []
        names = {name: self.constant(value) for name, value in known.items()}
        names |= dict(zip(form.states, self.states)) | {"t": self.t, "pi": self.constant(gmpy2.const_pi())}
        for name, formula in form.where.items():
            names[name] = self.record(formula, names)
        self.rates = [self.record(formula, names) for formula in form.rates]

    def constant(self, value):
        series = []
        self.steps.append(lambda k: series.append(value if k == 0 else mpfr(0)))
        self.done[id(series)] = series
        return series

    def record(self, formula, names):
        def visit(node):
            match node:
                case ast.Constant():
                    return self.constant(number(ast.get_source_segment(formula, node)))
                case ast.Name():
                    return names[node.id]
                case ast.UnaryOp(op=ast.USub()):
                    return self.linear(visit(node.operand), self.constant(mpfr(0)), -1, 1)
                case ast.BinOp(op=ast.Add()):
                    return self.linear(visit(node.left), visit(node.right), 1, 1)
                case ast.BinOp(op=ast.Sub()):
                    return self.linear(visit(node.left), visit(node.right), 1, -1)
                case ast.BinOp(op=ast.Mult()):
                    return self.product(visit(node.left), visit(node.right))
                case ast.BinOp(op=ast.Div()):
                    return self.quotient(visit(node.left), visit(node.right))
                case ast.Call(func=ast.Name(id="exp")):
                    return self.exp(visit(node.args[0]))
                case ast.Call(func=ast.Name(id="log")):
                    return self.log(visit(node.args[0]))
                case ast.Call(func=ast.Name(id="sinh" | "cosh" as name)):
                    return self.pair(visit(node.args[0]), gmpy2.sinh, gmpy2.cosh, 1)[name == "cosh"]
                case ast.Call(func=ast.Name(id="sin" | "cos" as name)):
                    return self.pair(visit(node.args[0]), gmpy2.sin, gmpy2.cos, -1)[name == "cos"]
            raise ValueError(f"no recurrence for what {formula!r} has")

        return visit(ast.parse(formula, mode="eval").body)

    def linear(self, a, b, p, q):
        made = []
        self.steps.append(lambda k: made.append(p * a[k] + q * b[k]))
        return made

    def product(self, a, b):
        made = []
        self.steps.append(lambda k: made.append(sum(map(mul, a[: k + 1], b[k::-1]), mpfr(0))))
        return made

    def quotient(self, a, b):
        """c b = a."""
        made = []
        self.steps.append(lambda k: made.append((a[k] - sum(map(mul, made, b[k:0:-1]), mpfr(0))) / b[0]))
        return made

    def exp(self, a):
        """c' = a' c."""
        made, slope = [], []

        def step(k):
            slope.append(k * a[k])
            made.append(gmpy2.exp(a[0]) if k == 0 else sum(map(mul, slope[1:], made[::-1]), mpfr(0)) / k)

        self.steps.append(step)
        return made

    def log(self, a):
        """a c' = a'."""
        made, slope = [], []

        def step(k):
            if k == 0:
                made.append(gmpy2.log(a[0]))
                slope.append(mpfr(0))
                return
            slope.append((k * a[k] - sum(map(mul, slope[1:], a[k - 1 : 0 : -1]), mpfr(0))) / a[0])
            made.append(slope[k] / k)

        self.steps.append(step)
        return made

    def pair(self, a, first, second, sign):
        """s' = a' c and c' = sign a' s."""
        s, c, slope = [], [], []

        def step(k):
            slope.append(k * a[k])
            if k == 0:
                s.append(first(a[0]))
                c.append(second(a[0]))
                return
            next_s = sum(map(mul, slope[1:], c[::-1]), mpfr(0)) / k
            next_c = sign * sum(map(mul, slope[1:], s[::-1]), mpfr(0)) / k
            s.append(next_s)
            c.append(next_c)

        self.steps.append(step)
        return s, c

    def expand(self, t, y):
        """The coefficients of all states at a time."""
        for series in self.all_series():
            series.clear()
        for k in range(ORDER):
            self.t.append(t if k == 0 else mpfr(k == 1))
            for series, value, rate in zip(self.states, y, self.rates):
                series.append(value if k == 0 else rate[k - 1] / k)
            for step in self.steps:
                step(k)
        for series, rate in zip(self.states, self.rates):
            series.append(rate[ORDER - 1] / ORDER)
        return self.states

    def all_series(self):
        seen = [self.t, *self.states]
        for step in self.steps:
            seen += [cell.cell_contents for cell in step.__closure__ or () if isinstance(cell.cell_contents, list)]
        return seen


def solve(form, times, kind=number):
    """(compared quantities, steps so far) at each of these times. `kind` makes numbers of texts, as through doubles."""
    asked = set(map(Fraction, times))
    with gmpy2.context(gmpy2.get_context(), precision=BITS):
        functions = Functions()
        y, t, steps = form.begin(kind, functions), mpfr(0), 0
        for stop, parameters in form.segments(times):
            series, end = Series(form, form.numbers(parameters, kind, functions)), number(stop)
            while t < end:
                made = series.expand(t, y)
                # The last two terms say how long a step makes them negligible.
                h = end - t
                for state in made:
                    scale = 1 + abs(state[0])
                    for k in (ORDER - 1, ORDER):
                        if state[k] != 0:
                            h = min(h, gmpy2.root(NEGLIGIBLE * scale / abs(state[k]), k) * mpfr("0.9"))
                y = [horner(state, h) for state in made]
                t = end if h == end - t else t + h
                steps += 1
            if stop in asked:
                yield form.compare(y, kind, functions), steps


def horner(coefficients, h):
    value = mpfr(0)
    for coefficient in reversed(coefficients):
        value = value * h + coefficient
    return value


def through_doubles(text):
    """The nearest double of a decimal: what a program in double precision is given."""
    return mpfr(float(Fraction(text)))
