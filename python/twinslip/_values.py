"""What results are made of: numbers with their error bounds, and objects of named values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

#: Lists of pairs that are complex numbers.
COMPLEX = {"eigenvalues", "multipliers"}


class Uncertain(NamedTuple):
    """A number with a bound on its error.

    Attributes
    ----------
    value : float
        The number.
    uncertainty : float
        The true one is not further away than this.
    """

    value: float
    uncertainty: float

    def __float__(self) -> float:
        return self.value

    def __str__(self) -> str:
        return f"{self.value!r} ± {self.uncertainty:.1e}"


class Record(dict[str, Any]):
    """Named values, which are attributes too: ``record.verdict`` is ``record["verdict"]``."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"there is no {name}, but {', '.join(self)}") from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(name for name in self if name.isidentifier())]

    def __repr__(self) -> str:
        return f"Record({', '.join(f'{name}={value!r}' for name, value in self.items())})"

    def __str__(self) -> str:
        """A value on each line."""
        width = max(map(len, self), default=0)
        lines = []
        for name, value in self.items():
            told = str(value).replace("\n", "\n" + " " * (width + 2))
            lines.append(f"{name:>{width}}: {told}")
        return "\n".join(lines)

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        """What notebooks show."""
        for i, line in enumerate(str(self).split("\n")):
            if i:
                printer.break_()
            printer.text(line)

    def __reduce__(self) -> Any:
        return (Record, (dict(self),))


def value_of(found: Any, name: str = "") -> Any:
    """What JSON has, with error bounds, complex numbers and arrays made of it."""
    if isinstance(found, Mapping):
        if found.keys() == {"value", "uncertainty"}:
            if found["value"] is None:
                return None
            bound = found["uncertainty"]
            return Uncertain(found["value"], float("inf") if bound is None else bound)
        return Record({key: value_of(one, key) for key, one in found.items()})
    if isinstance(found, list):
        if name in COMPLEX and found and all(isinstance(one, list) for one in found):
            return np.array([complex(*one) for one in found])
        if found and all(type(one) in (int, float) for one in found):
            return np.array(found)
        return [value_of(one, name) for one in found]
    return found


def columns_of(rows: list[dict[str, Any]]) -> dict[str, tuple[Any, Any]]:
    """Rows of an object as columns, error bounds in columns of their own, each with a mask of what is missing."""
    flat: list[dict[str, Any]] = []
    for row in rows:
        cells: dict[str, Any] = {}
        for name, one in row.items():
            if isinstance(one, Mapping) and one.keys() == {"value", "uncertainty"}:
                cells[name], cells[f"{name}_uncertainty"] = one["value"], one["uncertainty"]
            else:
                cells[name] = one
        flat.append(cells)
    names = list(dict.fromkeys(name for cells in flat for name in cells))
    return {name: _column([cells.get(name) for cells in flat]) for name in names}


def _column(cells: list[Any]) -> tuple[Any, Any]:
    mask = np.array([one is None for one in cells], dtype=bool)
    known = [one for one in cells if one is not None]
    if all(type(one) in (int, float) for one in known):
        whole = bool(known) and all(type(one) is int for one in known)
        filled = [0 if one is None else one for one in cells]
        values: Any = np.array(filled, dtype=np.int64 if whole else np.float64)
    else:
        values = ["" if one is None else str(one) for one in cells]
    return values, (mask if mask.any() else None)


def flat(one: Record) -> dict[str, Any]:
    """Numbers with bounds in two cells, lists in as many as they have."""
    cells: dict[str, Any] = {}
    for name, value in one.items():
        if isinstance(value, Uncertain):
            cells[name], cells[f"{name}_uncertainty"] = value
        elif isinstance(value, np.ndarray) and value.ndim == 1:
            cells.update({f"{name}_{i}": x for i, x in enumerate(value, 1)})
        elif isinstance(value, list) and all(isinstance(x, Uncertain) for x in value):
            for i, x in enumerate(value, 1):
                cells[f"{name}_{i}"], cells[f"{name}_{i}_uncertainty"] = x
        else:
            cells[name] = value
    return cells
