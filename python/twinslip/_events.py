"""Functions of events: their formulas, and what is said of those that have none."""

from __future__ import annotations

from typing import Any, Callable, NamedTuple, Optional, Union

import numpy as np

from ._called import Untraced
from ._errors import InputError
from ._function import Array, Function, differs
from ._symbols import Symbol
from ._trace import MOST_STATES

EventFunction = Callable[..., Any]


class AskedEvent(NamedTuple):
    """An event as it is asked for: its function, its direction, and after how many the run ends."""

    #: As the user gave it.
    function: EventFunction
    #: The same of time and values alone, a number.
    called: Callable[[float, Array], float]
    way: float
    most: Optional[int]


class Asked(NamedTuple):
    """A function of an event with what is known of it."""

    sampled: Callable[[float, Array], float]
    symbol: Optional[Symbol]
    function: Function
    reason: Optional[str]

    def given(self) -> Union[str, Callable[[float, Array], float]]:
        """What is looked at along a run: the formula where there is one."""
        text = None if self.symbol is None else self.function.formula(self.symbol.place)
        return self.sampled if text is None else text


def traced_event(function: Function, asked: AskedEvent, t: float, y: Array) -> Asked:
    """The formula of an event of a function."""
    units = np.array(function.units)

    def sampled(time: float, inward: Array) -> float:
        return asked.called(time, inward * units)

    def none(reason: Optional[str]) -> Asked:
        return Asked(sampled, None, function, reason)

    try:
        symbol = function.event(asked.function)
    except Untraced as error:
        return none(str(error).replace("events can't be traced", "it can't be traced", 1))
    if symbol.known() is not None:
        # It has no zeros, or nothing else.
        return none(None)
    if function.formula(symbol.place) is None:
        return none(f"its formula has t beside {function.count} values")
    if differs([function.point(t, y.tolist()).value(symbol.place)], [asked.called(t, y.copy())]):
        return none("it gives other values with numbers than with symbols")
    return Asked(sampled, symbol, function, None)


class GivenEvent(NamedTuple):
    """An event of a system: as it is asked for, and its formula or its function."""

    asked: AskedEvent
    given: Union[str, Callable[[float, Array], float]]


def traced_for_system(asked: AskedEvent, more: tuple[Any, ...], count: int) -> GivenEvent:
    """The formula of an event of a system with so many values; what has none is called with numbers.

    It is called as it is, and nothing in it is replaced.
    """
    if not 1 <= count <= MOST_STATES:
        return GivenEvent(asked, asked.called)
    function = Function(asked.function, more, count, [1.0] * count, False)
    try:
        symbol = function.event(asked.function, copies=False)
    except InputError as error:
        if not isinstance(error, Untraced):
            raise
        return GivenEvent(asked, asked.called)
    text = None if symbol.known() is not None else function.formula(symbol.place)
    return GivenEvent(asked, asked.called if text is None else text)


def with_notes(message: str, notes: list[str]) -> str:
    """A message with what else is to be said."""
    said = [note for note in notes if note]
    if said and not message.endswith((".", "!", "?")):
        message += "."
    return " ".join([message, *said])


def sampled_note(i: int, reason: Optional[str], undecided: bool) -> str:
    """What is to be said of an event whose zeros are not all isolated."""
    if reason is not None:
        return f"Event {i} was only looked at within steps, where zeros close to each other may be missed, as {reason}."
    if undecided:
        return f"Event {i} was in part only looked at within steps, where zeros close to each other may be missed, as there are too many or they can't be told from rounding."
    return ""
