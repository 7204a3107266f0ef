"""From keyword arguments to the words of the command line, by the list of options that the commands have."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple, Optional

import numpy as np

from . import _core
from ._errors import InputError

#: Arguments whose names are words of Python, or mean something else there.
RENAMED = {"in": "within", "from": "from_"}


class Option(NamedTuple):
    """An option of a command."""

    name: str
    positional: bool
    kind: str
    form: str
    repeated: bool
    default: Optional[str]
    heading: str
    help: str

    @property
    def argument(self) -> str:
        """Its name in Python."""
        plain = self.name.replace("-", "_")
        return RENAMED.get(plain, plain)


@cache
def options(command: str) -> dict[str, Option]:
    """The options of a command by their names in Python."""
    every = (Option(*told) for told in _core.options(command))
    return {option.argument: option for option in every}


#: Headings of the options that make a system.
MODEL = ("Model", "SI units")


@cache
def model_options() -> dict[str, Option]:
    """The options that say what slides, by their names in Python."""
    every = options("orbit").items()
    return {name: option for name, option in every if option.heading in MODEL}


#: A number, perhaps with a unit behind it, which the command reads.
MEASURED = re.compile(r"\s*[+-]?\.?[0-9]")


def number(field: str, value: Any) -> str:
    """The shortest text that reads back as the same double; a number with its unit as it is."""
    if isinstance(value, str):
        if MEASURED.match(value):
            return value.strip()
        raise InputError(
            f"{field} is {value!r}, but must be a number, or a number with its unit such as '10um'",
            field,
        )
    try:
        x = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{field} is {value!r}, but must be a number", field) from None
    return repr(x)


def count(field: str, value: Any) -> str:
    """A whole number."""
    if isinstance(value, (bool, np.bool_)):
        raise InputError(f"{field} is {value!r}, but must be a whole number", field)
    try:
        x = float(value)
        if x == int(x) and x >= 0:
            return str(int(value))
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{field} is {value!r}, but must be a whole number, not negative", field)


def _item(field: str, value: Any) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool):
        return str(int(value))
    return number(field, value)


def _joined(field: str, values: Sequence[Any], form: str) -> str:
    """``(a, b, n, "log")`` as ``a:b:nlog``, or ``(a, b)`` as ``a,b``, as the form has it."""
    between = ":" if ":" in form.split("=")[-1] else ","
    items = [_item(field, value) for value in values]
    if len(items) > 2 and items[-1] == "log" and between == ":":
        items[-2:] = [items[-2] + "log"]
    return between.join(items)


def _change(field: str, change: Any) -> str:
    """``(t, v)`` as ``t:v``, ``((t1, t2), v)`` as ``t1-t2:v``."""
    try:
        when, driving = change
        if isinstance(when, (list, tuple)):
            begin, end = when
            return f"{number(field, begin)}-{number(field, end)}:{number(field, driving)}"
        return f"{number(field, when)}:{number(field, driving)}"
    except (TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"{field} has {change!r}, but must have (time, driving) for a step or "
            "((begin, end), driving) for a ramp",
            field,
        ) from None


def _columns(field: str, value: Any) -> str:
    """Columns by name, or a DataFrame, as the text of a CSV file."""
    try:
        names = [str(name) for name in value]
        columns = [np.asarray(value[name], dtype=float).ravel().tolist() for name in value]
    except (TypeError, ValueError, KeyError):
        raise InputError(
            f"{field} is a {type(value).__name__}, but must be a file, a mapping of columns or a DataFrame",
            field,
        ) from None
    if len({len(column) for column in columns}) > 1:
        raise InputError(f"{field} has columns of different lengths", field)
    rows = [",".join(names), *(",".join(map(repr, row)) for row in zip(*columns))]
    return "\n".join(rows) + "\n"


def text(option: Option, value: Any) -> list[str]:
    """The values of an option, as many as it is given."""
    field, form = option.argument, option.form
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (str, os.PathLike)):
        return [os.fspath(value)]
    if option.name == "program" and isinstance(value, Sequence):
        return [",".join(_change(field, change) for change in value)]
    if option.name == "data":
        several = value if isinstance(value, (list, tuple)) else [value]
        paths = (str, os.PathLike)
        return [os.fspath(one) if isinstance(one, paths) else _columns(field, one) for one in several]
    if isinstance(value, Mapping):
        if option.name == "box":
            pairs = (f"{name}={_joined(field, pair, 'A:B')}" for name, pair in value.items())
            return [",".join(pairs)]
        return [f"{name}={_value(field, one, form)}" for name, one in value.items()]
    if isinstance(value, Sequence):
        if option.repeated:
            return [_value(field, one, form) for one in value]
        return [_joined(field, value, form)]
    return [_item(field, value)]


def _value(field: str, value: Any, form: str) -> str:
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, str) or not isinstance(value, Sequence):
        return _item(field, value)
    return _joined(field, value, form)


def words(option: Option, value: Any) -> list[str]:
    """The words of one option; none where its value is None or False."""
    if value is None or value is False:
        return []
    field = option.argument
    flag = f"--{option.name}"
    if value is True or isinstance(value, np.bool_):
        if not bool(value):
            return []
        if option.kind in ("switch", "file") or option.name == "crosscheck":
            return [flag]
        raise InputError(f"{field} is True, but must be a {option.kind}", field)
    if option.kind == "switch":
        raise InputError(f"{field} is {value!r}, but must be True or False", field)
    if option.kind == "number":
        texts = [number(field, value)]
    elif option.kind == "count":
        texts = [count(field, value)]
    else:
        texts = text(option, value)
    for one in texts:
        if "\0" in one:
            raise InputError(f"{field} has a zero byte, which no text may have", field)
    if option.positional:
        return texts
    return [f"{flag}={one}" for one in texts]


def unknown(command: str, name: str, known: Sequence[str]) -> InputError:
    """That a command has no such argument, with the one that may have been meant."""
    import difflib

    near = difflib.get_close_matches(name, known, 1)
    hint = f"; did you mean {near[0]}?" if near else ""
    return InputError(f"{command} has no argument {name}{hint}", name)
