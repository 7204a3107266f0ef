"""What decides comparisons of symbols: on which side of 0 their differences are at a point."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ._evaluation import Point
from ._symbols import Symbol

NO_EQUALITY = (
    "two symbols are compared by == or != where they are equal, which holds for no time: use <, "
    "<=, > or >= instead"
)
NOTHING = (
    "what is compared or rounded there is not a number where the solution is, so use another form"
)


class Decisions:
    """Comparisons at a point, and the sides on which their differences have to stay for them to hold.

    Some of these sides are known: there a difference may be 0 but for rounding.
    """

    def __init__(self, point: Point, known: Mapping[int, float], kinks: bool = False) -> None:
        self._point = point
        #: Whether it is decided too which of two numbers is the lesser, and the sign in an absolute value.
        self.kinks = kinks
        self._known = known
        #: Of each difference that was looked at 1 or -1, by the place of its operation.
        self.sides: dict[int, float] = {}

    def compare(self, operator: str, a: Symbol, b: Symbol) -> bool:
        """Whether a comparison holds."""
        # A difference and its opposite are one.
        turned = a.place > b.place
        difference: Symbol = b - a if turned else a - b
        sign = -1.0 if turned else 1.0
        number = difference.known()
        value = sign * self._value(difference)
        if operator in ("==", "!="):
            if value == 0.0 and number is None:
                raise TypeError(NO_EQUALITY)
            return (value == 0.0) == (operator == "==")
        rises = operator in (">", ">=")
        if value == 0.0:
            # It counts to the side of which the comparison says so.
            value = 1.0 if operator in (">=", "<") else -1.0
        if number is None:
            place = difference.place
            side = self.sides.get(place, self._known.get(place))
            self.sides[place] = math.copysign(1.0, sign * value) if side is None else side
            value = sign * self.sides[place]
        return (value > 0.0) == rises

    def floor(self, a: Symbol) -> Symbol:
        """The largest whole number that is no larger."""
        whole = float(math.floor(self._value(a)))
        formulas = a.formulas
        while self.compare(">=", a, formulas.number(whole + 1.0)):
            whole += 1.0
        while self.compare("<", a, formulas.number(whole)):
            whole -= 1.0
        return formulas.number(whole)

    def _value(self, a: Symbol) -> float:
        number = a.known()
        value = float(self._point.value(a.place)) if number is None else number
        if not math.isfinite(value):
            raise ValueError(NOTHING)
        return value
