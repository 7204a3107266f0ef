"""Functions of SciPy's form, ``fun(t, y)``, as systems: called with symbols, at a point that decides their comparisons."""

from __future__ import annotations

import numbers
from collections.abc import Sequence
from typing import Any, Callable, NamedTuple, Optional

import numpy as np
import numpy.typing as npt

from ._called import Untraced, refused, with_symbols
from ._decisions import Decisions
from ._errors import InputError
from ._evaluation import Point
from ._symbols import Formulas, Symbol
from ._text import definitions, quoted
from ._trace import LONGEST, MOST_ENTRIES, MOST_STATES, TIME

Array = npt.NDArray[np.float64]

#: Of all traces together, as each change of a comparison makes some more.
MOST_OPERATIONS = 200_000
#: A formula and a number are the same up to this part of them.
_SAME = 1e-6


class Side(NamedTuple):
    """What has to stay on its side of 0 for formulas to hold: the place of the operation, and 1 or -1."""

    place: int
    side: float


class Traced(NamedTuple):
    """The rates of a function where its comparisons are decided."""

    rates: list[int]
    sides: list[Side]


class Function:
    """A function ``fun(t, y)`` with the formulas that it gives."""

    def __init__(
        self,
        fun: Callable[..., Any],
        args: tuple[Any, ...],
        count: int,
        units: Sequence[float],
        vectorized: bool,
    ) -> None:
        if count > MOST_STATES:
            raise InputError(
                f"y0 has {count} values, but must have 1 to {MOST_STATES} where a function is traced",
                "y0",
            )
        self.fun = fun
        self.args = args
        self.count = count
        self.units = tuple(units)
        self.vectorized = vectorized
        #: Whether kinks are places where a run ends and begins again, as comparisons are.
        self.kinks = False
        self.formulas = Formulas(MOST_OPERATIONS)
        self.names = tuple(f"y{i}" for i in range(count))
        self.time = self.formulas.named(TIME)
        named = [self.formulas.named(name) for name in self.names]
        self.states = [unit * name for unit, name in zip(self.units, named)]

    def point(self, t: float, y: Sequence[float], slopes: Sequence[float] = ()) -> Point:
        """The values of all formulas at a time, and their slopes where the states have these."""
        inward = [value / unit for value, unit in zip(y, self.units)]
        rates = [slope / unit for slope, unit in zip(slopes, self.units)]
        known = {TIME: t, **dict(zip(self.names, inward))}
        return Point(self.formulas, known, {TIME: 1.0, **dict(zip(self.names, rates))})

    def symbols(self) -> Any:
        """The states as an array."""
        y = np.empty(self.count, dtype=object)
        y[:] = self.states
        return y

    def traced(self, t: float, y: Sequence[float], forced: dict[int, float]) -> Traced:
        """The rates as they are at a point, where some operations are on sides that are known."""
        decisions = Decisions(self.point(t, y), forced, self.kinks)
        self.formulas.decisions = decisions
        try:
            states = self.symbols()
            given = states[:, np.newaxis] if self.vectorized else states
            made = with_symbols("fun", self.fun, (self.time, given, *self.args))
        except Untraced:
            # What it raises of numbers as well is no matter of symbols.
            self.numbers(t, y)
            raise
        finally:
            self.formulas.decisions = None
        rates = self._rates(made)
        scaled: list[Symbol] = [rate / unit for rate, unit in zip(rates, self.units)]
        return Traced(
            [rate.place for rate in scaled], [Side(*one) for one in decisions.sides.items()]
        )

    def numbers(self, t: float, y: Sequence[float]) -> Any:
        """What the function gives for numbers."""
        values = np.array(y, dtype=np.float64)
        with np.errstate(all="ignore"):
            return self.fun(t, values[:, np.newaxis] if self.vectorized else values, *self.args)

    def _rates(self, made: Any) -> list[Symbol]:
        if isinstance(made, (Symbol, numbers.Real)) and self.count == 1:
            made = [made]
        try:
            array = np.asarray(made, dtype=object)
        except ValueError:
            array = np.empty(0, dtype=object)
        rates = list(array.reshape(-1) if self.vectorized else array)
        if array.size != self.count or len(rates) != self.count:
            raise InputError(
                f"fun gives an array of shape {array.shape}, but must give {self.count} rates, one for each value of y0",
                "fun",
            )
        symbols = []
        for i, rate in enumerate(rates):
            try:
                symbol = self.formulas.symbol(rate)
            except (ValueError, TypeError) as error:
                raise InputError(
                    f"fun gives as rate {i} {error}".replace("f: ", ""), "fun"
                ) from error
            if symbol is None:
                raise InputError(
                    f"fun gives as rate {i} {rate!r}, but must give real numbers", "fun"
                )
            symbols.append(symbol)
        return symbols

    def event(self, event: Callable[..., Any], copies: bool = True) -> Symbol:
        """The formula of a function ``event(t, y)``."""
        made = with_symbols("events", event, (self.time, self.symbols(), *self.args), copies)
        if isinstance(made, np.ndarray) and made.size == 1:
            made = made.reshape(-1)[0]
        try:
            symbol = self.formulas.symbol(made)
        except (TypeError, ValueError) as error:
            raise refused("events", error) from error
        if symbol is None:
            raise refused("events", TypeError(f"it gives {made!r}, but must give a number"))
        return symbol

    def of_time(self, places: Sequence[int]) -> bool:
        """Whether time is in any of these formulas."""
        needed = [False] * len(self.formulas.operations)
        for place in places:
            needed[place] = True
        for place in reversed(range(len(needed))):
            if needed[place]:
                for operand in self.formulas.operations[place].operands:
                    needed[operand] = True
        return needed[self.time.place]

    def text(self, places: Sequence[int]) -> str:
        """The text of the system with these rates, which may name time."""
        if self.count >= MOST_STATES and self.of_time(places):
            raise InputError(
                f"y0 has {self.count} values, but must have 1 to {MOST_STATES - 1} where rates depend on t",
                "y0",
            )
        taken = {*self.names, TIME}
        texts, defined = definitions(self.formulas, list(places), taken, MOST_ENTRIES)
        lines = ['name = "fun"', f"states = [{', '.join(map(quoted, self.names))}]", "[rates]"]
        lines += [f"{name} = {quoted(text)}" for name, text in zip(self.names, texts)]
        if defined:
            lines += ["[where]", *(f"{name} = {quoted(text)}" for name, text in defined)]
        text = "\n".join(lines) + "\n"
        if len(text) > LONGEST:
            raise InputError(
                f"fun has formulas of {len(text)} bytes, but must have no more than {LONGEST}",
                "fun",
            )
        return text

    def formula(self, place: int) -> Optional[str]:
        """The text of one function for an event; None where there are too many values beside time."""
        if self.count >= MOST_STATES and self.of_time([place]):
            return None
        names = [self.formulas.named(name).place for name in self.names[1:]]
        return self.text([place, *names])


def differs(formulas: Sequence[float], numbers_: Sequence[float]) -> bool:
    """Whether formulas give other values than the function does with numbers."""
    ours, theirs = np.asarray(formulas, dtype=float), np.asarray(numbers_, dtype=float)
    if ours.shape != theirs.shape:
        return True
    with np.errstate(all="ignore"):
        near = np.abs(ours - theirs) <= _SAME * (np.abs(ours) + np.abs(theirs)).max(initial=0.0)
    # What is not finite can't be compared.
    return not bool((near | ~np.isfinite(ours) | ~np.isfinite(theirs)).all())
