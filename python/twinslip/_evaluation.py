"""Formulas in numbers: their values at a point, and how fast they change along a direction."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Callable

import numpy as np

from ._symbols import Formulas, Operation

#: A value, and its slope in the direction.
Dual = tuple[float, float]

#: Functions of one number, each with its slope.
_FUNCTIONS: dict[str, tuple[Callable[[float], float], Callable[[float], float]]] = {
    "abs": (np.abs, np.sign),
    "asinh": (np.arcsinh, lambda x: 1 / np.sqrt(x * x + 1)),
    "atan": (np.arctan, lambda x: 1 / (x * x + 1)),
    "cos": (np.cos, lambda x: -np.sin(x)),
    "cosh": (np.cosh, np.sinh),
    "exp": (np.exp, np.exp),
    "ln": (np.log, lambda x: 1 / x),
    "log10": (np.log10, lambda x: 1 / (x * math.log(10.0))),
    "sin": (np.sin, np.cos),
    "sinh": (np.sinh, np.cosh),
    "sqrt": (np.sqrt, lambda x: 0.5 / np.sqrt(x)),
    "tan": (np.tan, lambda x: 1 / np.cos(x) ** 2),
    "tanh": (np.tanh, lambda x: 1 / np.cosh(x) ** 2),
}


class Point:
    """The values of formulas where their names have these values, which may change at these rates."""

    def __init__(
        self,
        formulas: Formulas,
        values: Mapping[str, float],
        slopes: Mapping[str, float] | None = None,
    ) -> None:
        self._formulas = formulas
        self._values = values
        self._slopes = {} if slopes is None else slopes
        self._known: dict[int, Dual] = {}

    def value(self, place: int) -> float:
        """The value of the operation at this place; what is no number is not refused."""
        return self._at(place)[0]

    def slope(self, place: int) -> float:
        """How fast it changes."""
        return self._at(place)[1]

    def _at(self, place: int) -> Dual:
        operations, known = self._formulas.operations, self._known
        waiting = [place]
        with np.errstate(all="ignore"):
            while waiting:
                last = waiting[-1]
                missing = [one for one in operations[last].operands if one not in known]
                if last in known or not missing:
                    waiting.pop()
                    if last not in known:
                        known[last] = self._of(operations[last])
                else:
                    waiting.extend(missing)
        return known[place]

    def _of(self, operation: Operation) -> Dual:
        kind = operation.kind
        if kind == "name":
            name = operation.name
            return np.float64(self._values[name]), np.float64(self._slopes.get(name, 0.0))
        if kind == "number":
            return np.float64(operation.number), np.float64(0.0)
        pairs = [self._known[operand] for operand in operation.operands]
        (a, da), (b, db) = pairs[0], pairs[-1]
        if kind == "negative":
            return -a, -da
        if kind == "+":
            return a + b, da + db
        if kind == "-":
            return a - b, da - db
        if kind == "*":
            return a * b, da * b + a * db
        if kind == "/":
            return a / b, (da - a / b * db) / b
        if kind == "^":
            # The logarithm has no part in it where the exponent is a number.
            grown = a**b * np.log(a) * db if db != 0.0 else 0.0
            return a**b, b * a ** (b - 1) * da + grown
        if operation.name in ("min", "max"):
            first = (a <= b) == (operation.name == "min")
            return (a, da) if first else (b, db)
        value, slope = _FUNCTIONS[operation.name]
        return value(a), slope(a) * da
