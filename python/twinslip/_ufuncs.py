"""What numpy's functions make of symbols."""

from __future__ import annotations

import math
from typing import Any, Callable

import numpy as np

from ._symbols import NO_CHOICE, Formulas, Symbol, greatest, least

#: Those that formulas have, by the names that numpy gives to them.
_CALLS = {
    "arcsinh": "asinh",
    "arctan": "atan",
    "cos": "cos",
    "cosh": "cosh",
    "exp": "exp",
    "log": "ln",
    "log10": "log10",
    "sin": "sin",
    "sinh": "sinh",
    "sqrt": "sqrt",
    "tan": "tan",
    "tanh": "tanh",
}


def _call(name: str) -> Callable[[Symbol], Symbol]:
    return lambda a: a.call(name)


def _expm1(a: Symbol) -> Symbol:
    # no difference that loses digits
    half: Symbol = a / 2.0
    return 2.0 * half.call("exp") * half.call("sinh")  # type: ignore[no-any-return]


def _log1p(a: Symbol) -> Symbol:
    # sinh(ln(1 + a)), without a sum that loses digits
    quotient: Symbol = a * (a + 2.0) / (2.0 * (a + 1.0))
    return quotient.call("asinh")


def _arcsin(a: Symbol) -> Symbol:
    root: Symbol = (1.0 - a) * (1.0 + a)
    quotient: Symbol = a / root.call("sqrt")
    return quotient.call("atan")


def _arccos(a: Symbol) -> Symbol:
    square: Symbol = (1.0 - a) / (1.0 + a)
    return 2.0 * square.call("sqrt").call("atan")  # type: ignore[no-any-return]


def _arccosh(a: Symbol) -> Symbol:
    square: Symbol = (a - 1.0) * (a + 1.0)
    return square.call("sqrt").call("asinh")


def _arctanh(a: Symbol) -> Symbol:
    root: Symbol = (1.0 - a) * (1.0 + a)
    quotient: Symbol = a / root.call("sqrt")
    return quotient.call("asinh")


def _hypot(a: Symbol, b: Symbol) -> Symbol:
    sum_of_squares: Symbol = a**2.0 + b**2.0
    return sum_of_squares.call("sqrt")


#: All that there are, each of one or two symbols.
FUNCTIONS: dict[str, Callable[..., Symbol]] = {
    **{name: _call(called) for name, called in _CALLS.items()},
    "absolute": abs,
    "add": lambda a, b: a + b,
    "arccos": _arccos,
    "arccosh": _arccosh,
    "arcsin": _arcsin,
    "arctanh": _arctanh,
    "deg2rad": lambda a: a * (math.pi / 180.0),
    "divide": lambda a, b: a / b,
    "exp2": lambda a: 2.0**a,
    "expm1": _expm1,
    "fabs": abs,
    "float_power": lambda a, b: a**b,
    "fmax": greatest,
    "fmin": least,
    "hypot": _hypot,
    "log1p": _log1p,
    "log2": lambda a: a.call("ln") / math.log(2.0),
    "maximum": greatest,
    "minimum": least,
    "multiply": lambda a, b: a * b,
    "negative": lambda a: -a,
    "positive": lambda a: a,
    "power": lambda a, b: a**b,
    "rad2deg": lambda a: a * (180.0 / math.pi),
    "reciprocal": lambda a: 1.0 / a,
    "sqrt": _call("sqrt"),
    "square": lambda a: a**2.0,
    "subtract": lambda a, b: a - b,
}
for other, usual in (("conjugate", "positive"), ("degrees", "rad2deg"), ("radians", "deg2rad")):
    FUNCTIONS[other] = FUNCTIONS[usual]

_COMPARISONS = {
    "equal": "==",
    "greater": ">",
    "greater_equal": ">=",
    "less": "<",
    "less_equal": "<=",
    "not_equal": "!=",
}
#: What is decided by whether a symbol is 0.
_LOGIC = {"logical_and", "logical_not", "logical_or", "logical_xor"}


def _sign(a: Symbol) -> Symbol:
    return a.formulas.number(1.0 if a > 0.0 else -1.0 if a < 0.0 else 0.0)


def _arctan2(y: Symbol, x: Symbol) -> Symbol:
    # Of each quarter by a quotient no larger than 1.
    if x > abs(y):
        return (y / x).call("atan")  # type: ignore[no-any-return]
    if y > abs(x):
        return math.pi / 2.0 - (x / y).call("atan")  # type: ignore[no-any-return]
    if y < -abs(x):
        return -math.pi / 2.0 - (x / y).call("atan")  # type: ignore[no-any-return]
    turn = math.pi if y >= 0.0 else -math.pi
    return (y / x).call("atan") + turn  # type: ignore[no-any-return]


def _heaviside(a: Symbol, at_zero: Symbol) -> Symbol:
    if a > 0.0:
        return a.formulas.number(1.0)
    return a.formulas.number(0.0) if a < 0.0 else at_zero


#: Those that jump, where something decides on which side they are.
_CHOICES: dict[str, Callable[..., Symbol]] = {
    "arctan2": _arctan2,
    "ceil": lambda a: -a.formulas.floor(-a),
    "floor": lambda a: a.formulas.floor(a),
    "floor_divide": lambda a, b: a // b,
    "heaviside": _heaviside,
    "remainder": lambda a, b: a % b,
    "sign": _sign,
}

_NO_ARRAY = (
    "a symbol has no value, and so no place in an array of numbers: make the array with "
    "dtype=object"
)


def applied(ufunc: np.ufunc, method: str, inputs: tuple[Any, ...], options: dict[str, Any]) -> Any:
    """What a function of numpy makes of inputs of which one at least is a symbol, the others
    numbers or arrays.

    Returns
    -------
    Symbol or numpy.ndarray
        An array of objects, in the shape to which all inputs are broadcast, where one of them is
        an array.

    Raises
    ------
    TypeError
        For a function that no formula has.
    """
    name = ufunc.__name__
    if name in _LOGIC:
        raise TypeError(NO_CHOICE)
    formulas = next(value.formulas for value in inputs if isinstance(value, Symbol))
    if name in _COMPARISONS:
        return _decided(_COMPARISONS[name], formulas, inputs)
    choices = {} if formulas.decisions is None else _CHOICES
    function = choices.get(name, FUNCTIONS.get(name))
    outputs = options.pop("out", ())
    if function is None or method != "__call__" or options:
        way = name if method == "__call__" else f"{name}.{method}"
        known = ", ".join(sorted(FUNCTIONS))
        raise TypeError(f"np.{way} of a symbol can't stand in a formula, there are {known}")
    made = _broadcast(function, formulas, inputs)
    for output in outputs:
        if output.dtype != object:
            raise TypeError(_NO_ARRAY)
        output[...] = made
        return output
    return made


def _decided(operator: str, formulas: Formulas, inputs: tuple[Any, ...]) -> Any:
    """A comparison, element by element."""
    a, b = (np.asarray(value, dtype=object) for value in inputs)

    def of_two(one: object, other: object) -> bool:
        return formulas.compared(operator, one, other)

    made = np.frompyfunc(of_two, 2, 1)(a, b)
    return made if isinstance(made, bool) else np.asarray(made, dtype=bool)


def _broadcast(function: Callable[..., Symbol], formulas: Formulas, inputs: tuple[Any, ...]) -> Any:
    if not any(isinstance(value, np.ndarray) and value.ndim > 0 for value in inputs):
        return function(*map(formulas.needed, inputs))
    # a symbol in an array of no dimension goes with all shapes
    arrays = [np.asarray(value, dtype=object) for value in inputs]

    def of_each(*values: object) -> Symbol:
        return function(*map(formulas.needed, values))

    return np.frompyfunc(of_each, len(arrays), 1)(*arrays)
