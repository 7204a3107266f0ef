"""From a Python function to the text of a system: the function is called once, with symbols."""

from __future__ import annotations

import inspect
import math
import numbers
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Callable, cast

import numpy as np

from ._symbols import Formulas, Symbol
from ._text import NAMES_OF_FUNCTIONS, definitions, number, quoted

#: No system has more states, and no table of its text more entries.
MOST_STATES = 100
MOST_ENTRIES = 200
#: No text is longer, in bytes, and no name.
LONGEST = 1 << 16
LONGEST_NAME = 200
#: What time is called in formulas.
TIME = "t"
#: What stands in rows beside the states.
_COLUMNS = {"time", "return", "period", "verdict", "residual", "point"}

#: ``f(x, p)``: the rates of the states x with the parameters p; or ``f(t, x, p)``.
RateFunction = Callable[..., Any]


class States(np.ndarray):
    """The symbols of all states: an array of objects, ``x[0]``, that has them by name as well,
    ``x["theta"]``.
    """

    names: tuple[str, ...] | None

    def __array_finalize__(self, source: Any) -> None:
        # Of what is made of it nothing has these names.
        self.names = None

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            names = self.names or ()
            if key not in names:
                known = ", ".join(names) or "no names in an array that was made of x"
                raise KeyError(f"{key!r} is no state; there are {known}")
            return super().__getitem__(names.index(key))
        return super().__getitem__(key)


class Parameters(Mapping[str, Symbol]):
    """The symbols of all parameters, ``p["mu"]`` or ``p.mu``."""

    def __init__(self, symbols: dict[str, Symbol]) -> None:
        self._symbols = symbols

    def __getitem__(self, name: str) -> Symbol:
        if name not in self._symbols:
            raise KeyError(self._unknown(name))
        return self._symbols[name]

    def __getattr__(self, name: str) -> Symbol:
        symbols = self.__dict__.get("_symbols", {})
        if name not in symbols:
            raise AttributeError(self._unknown(name))
        return cast(Symbol, symbols[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self._symbols)

    def __len__(self) -> int:
        return len(self._symbols)

    def _unknown(self, name: str) -> str:
        known = ", ".join(self.__dict__.get("_symbols", {})) or "none"
        return f"{name!r} is no parameter; there are {known}"


def system_text(
    f: RateFunction,
    states: Sequence[str],
    parameters: Mapping[str, float] | None = None,
    *,
    name: str | None = None,
    start: Mapping[str, float] | Sequence[float] | None = None,
    period: str | float | None = None,
) -> str:
    """The text of the system dx/dt = f(x, p), or f(t, x, p), as a file of twinslip has it.

    Parameters
    ----------
    f : callable
        ``f(x, p)``, or ``f(t, x, p)`` of the time t, gives the rates of all states: a sequence
        in their order, or a mapping by their names. It is called once, with symbols: ``x[0]`` or ``x["theta"]``, ``p["mu"]`` or
        ``p.mu``. Arithmetic and numpy's functions go; a choice by the value of a symbol does not,
        nor do the functions of ``math``. A power whose exponent is no whole number, or is a
        parameter, needs a positive base.
    states : sequence of str
        The names of 1 to 100 states.
    parameters : mapping of str to float, optional
        The names and values of the parameters.
    name : str, optional
        What the system is called; by default as the function.
    start : sequence or mapping of float, optional
        Where runs start: the values of all states in their order, or of some by their names.
    period : str or float, optional
        The period of ``f(t, x, p)`` in t: a formula in the parameters, as "2*pi/omega", or a number.

    Returns
    -------
    str
        The text, TOML of several lines. Its numbers are those of the function, to the last bit.

    Raises
    ------
    ValueError
        For a name, number or shape that can't be, naming the argument.
    TypeError
        Where the function does with symbols what no formula can say.
    """
    names = _checked_states(states)
    values = _checked_parameters({} if parameters is None else parameters, names)
    called = _checked_name(f, name)
    starts = _checked_start(start, names)
    takes_time = _takes_time(f)
    if takes_time and TIME in (*names, *values):
        kind = "states" if TIME in names else "parameters"
        raise ValueError(f"{kind}: none can be called {TIME!r} where f takes the time")

    formulas = Formulas()
    # The variables first: so they have their places in order.
    x = np.empty(len(names), dtype=object).view(States)
    for i, state in enumerate(names):
        x[i] = formulas.named(state)
    x.names = names
    p = Parameters({parameter: formulas.named(parameter) for parameter in values})
    made = f(formulas.named(TIME), x, p) if takes_time else f(x, p)
    rates = _checked_rates(made, names, formulas)

    taken = {*names, *values, TIME}
    texts, defined = definitions(formulas, [rate.place for rate in rates], taken, MOST_ENTRIES)
    tables = [
        ("parameters", [(key, number(value)) for key, value in values.items()]),
        ("rates", [(key, quoted(text)) for key, text in zip(names, texts)]),
        ("where", [(key, quoted(text)) for key, text in defined]),
        ("start", [(key, number(value)) for key, value in starts.items()]),
    ]
    lines = [f"name = {quoted(called)}", f"states = [{', '.join(map(quoted, names))}]"]
    if period is not None:
        lines.append(f"period = {quoted(_checked_period(period, takes_time))}")
    for title, entries in tables:
        if entries:
            lines.append(f"[{title}]")
            lines.extend(f"{_key(key)} = {value}" for key, value in entries)
    text = "\n".join(lines) + "\n"
    if len(text.encode()) > LONGEST:
        raise ValueError(
            f"f: its formulas are {len(text.encode())} bytes long, at most {LONGEST} are allowed"
        )
    return text


def _checked_period(period: str | float, takes_time: bool) -> str:
    if not takes_time:
        raise ValueError("period: f does not take the time, so that it has none")
    if isinstance(period, str):
        return period
    if not (isinstance(period, numbers.Real) and 0 < period < math.inf):
        raise ValueError(f"period: {period!r} is no formula and no positive number")
    return number(period)


def _key(name: str) -> str:
    return name if re.fullmatch("[A-Za-z0-9_]+", name) else quoted(name)


def _check_identifier(argument: str, name: object) -> str:
    if not isinstance(name, str):
        raise ValueError(f"{argument}: {name!r} is not a name, but of type {type(name).__name__}")
    if not re.fullmatch(r"[^\W\d]\w*", name) or not name.isidentifier():
        raise ValueError(
            f"{argument}: {name!r} is not a name: names have letters, digits and _, and do not begin "
            "with a digit"
        )
    if name == "pi" or name in NAMES_OF_FUNCTIONS:
        raise ValueError(f"{argument}: {name!r} is reserved in formulas")
    return name


def _checked_states(states: Sequence[str]) -> tuple[str, ...]:
    if isinstance(states, str):
        raise ValueError(f"states: it must be a list of names, as [{states!r}], not a text")
    names = tuple(_check_identifier("states", state) for state in states)
    if not 1 <= len(names) <= MOST_STATES:
        raise ValueError(f"states: there are {len(names)}, but there must be 1 to {MOST_STATES}")
    for state in names:
        if state in _COLUMNS:
            raise ValueError(f"states: none can be called {state!r}, as a column of results is")
        if names.count(state) > 1:
            raise ValueError(f"states: {state!r} is given twice")
    return names


def _checked_number(argument: str, name: str, value: object) -> float:
    what = f"{argument}: the value of {name!r}"
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise ValueError(f"{what} is {value!r}, but must be a number")
    try:
        known = float(value)
    except OverflowError:
        known = math.inf
    if not math.isfinite(known):
        raise ValueError(f"{what} is {value!r}, but must be finite")
    return known


def _checked_parameters(
    parameters: Mapping[str, float], states: tuple[str, ...]
) -> dict[str, float]:
    if not isinstance(parameters, Mapping):
        raise ValueError(
            "parameters: it must be a mapping of names to numbers, not of type "
            f"{type(parameters).__name__}"
        )
    if len(parameters) > MOST_ENTRIES:
        raise ValueError(
            f"parameters: there are {len(parameters)}, at most {MOST_ENTRIES} are allowed"
        )
    values: dict[str, float] = {}
    for key, value in parameters.items():
        name = _check_identifier("parameters", key)
        if name in states:
            raise ValueError(f"parameters: {name!r} is a state already")
        values[name] = _checked_number("parameters", name, value)
    return values


def _checked_name(f: RateFunction, name: str | None) -> str:
    if name is None:
        name = getattr(f, "__name__", "")
        name = name if name and name != "<lambda>" else "system"
    if not isinstance(name, str) or not 1 <= len(name.encode(errors="replace")) <= LONGEST_NAME:
        raise ValueError(f"name: it must be a text of 1 to {LONGEST_NAME} letters, not {name!r}")
    if any(0xD800 <= ord(letter) < 0xE000 for letter in name):
        raise ValueError(f"name: {name!r} has letters that no file can have")
    return name


def _checked_start(
    start: Mapping[str, float] | Sequence[float] | None, states: tuple[str, ...]
) -> dict[str, float]:
    if start is None:
        return {}
    if isinstance(start, Mapping):
        for key in start:
            if key not in states:
                raise ValueError(f"start: {key!r} is no state, there are {', '.join(states)}")
        return {
            state: _checked_number("start", state, start[state])
            for state in states
            if state in start
        }
    try:
        values = list(start)
    except TypeError:
        values = []
    if isinstance(start, str) or len(values) != len(states):
        raise ValueError(
            f"start: it must have {len(states)} values, one for each of {', '.join(states)}, not "
            f"{start!r}"
        )
    return {state: _checked_number("start", state, value) for state, value in zip(states, values)}


def _takes_time(f: RateFunction) -> bool:
    """Whether it is ``f(t, x, p)`` and not ``f(x, p)``."""
    if not callable(f):
        raise ValueError(f"f: it must be a function f(x, p), not of type {type(f).__name__}")
    try:
        signature = inspect.signature(f)
    except (TypeError, ValueError):
        return False
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    places = [one.name for one in signature.parameters.values() if one.kind in kinds]
    takes_time = places[:1] in (["t"], ["time"])
    try:
        signature.bind(*[None] * (3 if takes_time else 2))
        return takes_time
    except TypeError:
        pass
    raise ValueError(
        f"f: it has the arguments {signature}, but must be f(x, p), or f(t, x, p) where rates depend on the time t"
    )


def _checked_rates(made: Any, states: tuple[str, ...], formulas: Formulas) -> list[Symbol]:
    if isinstance(made, Mapping):
        for key in made:
            if key not in states:
                raise ValueError(
                    f"f: it gives a rate of {key!r}, which is no state; there are "
                    f"{', '.join(states)}"
                )
        missing = [state for state in states if state not in made]
        if missing:
            raise ValueError(f"f: it gives no rate of {', '.join(missing)}")
        rates = [made[state] for state in states]
    elif isinstance(made, (Symbol, numbers.Real)) and len(states) == 1:
        rates = [made]
    elif isinstance(made, (Sequence, np.ndarray)) and not isinstance(made, str):
        rates = list(made)
    else:
        raise ValueError(
            f"f: it must give a sequence of {len(states)} rates, or a mapping by the states, not "
            f"{made!r}"
        )
    if len(rates) != len(states):
        raise ValueError(
            f"f: it gives {len(rates)} rates, but there are {len(states)} states, "
            f"{', '.join(states)}"
        )
    symbols = [formulas.symbol(rate) for rate in rates]
    for state, rate, symbol in zip(states, rates, symbols):
        if symbol is None:
            raise ValueError(
                f"f: the rate of {state} must be made of symbols and numbers, not {rate!r}"
            )
    return [symbol for symbol in symbols if symbol is not None]
