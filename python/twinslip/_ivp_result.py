"""What initial value problems give."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, Optional, Protocol

import numpy as np
import numpy.typing as npt

from . import _core
from ._errors import InputError
from ._values import Record

Array = npt.NDArray[np.float64]


MESSAGES = {
    0: "The solver successfully reached the end of the integration interval.",
    1: "A termination event occurred.",
}


class Solution(Protocol):
    """Values at any time."""

    @property
    def dimension(self) -> int: ...
    def at(self, times: list[float]) -> Array: ...
    def times(self) -> Array: ...


class Joined:
    """Solutions one after the other, of the first so many states, in their units."""

    def __init__(
        self, pieces: Sequence[_core.Solution], count: int, units: Sequence[float]
    ) -> None:
        self._pieces = list(pieces)
        self._units = np.array(units)
        self.dimension = count
        times = [piece.times() for piece in self._pieces]
        self._times: Array = np.concatenate([times[0], *(more[1:] for more in times[1:])])
        self._ends: Array = np.array([more[-1] for more in times])

    def times(self) -> Array:
        """Those at which steps begin and end."""
        return self._times

    def at(self, times: list[float]) -> Array:
        """The values at these times, those at the first one first."""
        asked = np.array(times)
        way = 1.0 if self._times[-1] >= self._times[0] else -1.0
        places = np.searchsorted(way * self._ends, way * asked)
        places = np.minimum(places, len(self._pieces) - 1)
        values: Array = np.empty((len(asked), self.dimension))
        for place in np.unique(places):
            here = places == place
            piece = self._pieces[place]
            made = piece.at(asked[here].tolist()).reshape(-1, piece.dimension)
            values[here] = made[:, : self.dimension] * self._units
        return values.reshape(-1)

    def __reduce__(self) -> Any:
        return (Joined, (self._pieces, self.dimension, self._units.tolist()))


class Constant:
    """The same values at all times."""

    def __init__(self, span: tuple[float, float], values: Sequence[float]) -> None:
        self._span = span
        self._values = list(values)
        self.dimension = len(self._values)

    def times(self) -> Array:
        """Those at which it begins and ends."""
        return np.array(self._span)

    def at(self, times: list[float]) -> Array:
        """The values at these times, those at the first one first."""
        return np.array(self._values * len(times), dtype=np.float64)

    def __reduce__(self) -> Any:
        return (Constant, (self._span, self._values))


class OdeSolution:
    """The solution as a function of time.

    Attributes
    ----------
    ts : ndarray, shape (n_segments + 1,)
        The times at which steps begin and end.
    t_min, t_max : float
        Where it is known; outside, the first or last step goes on, which has no accuracy.
    n_segments : int
        The number of steps.
    """

    def __init__(self, solution: Solution) -> None:
        self._solution = solution
        self.ts: Array = solution.times()
        self.n_segments = len(self.ts) - 1
        self.t_min = float(min(self.ts[0], self.ts[-1]))
        self.t_max = float(max(self.ts[0], self.ts[-1]))

    def __call__(self, t: npt.ArrayLike) -> Array:
        """The values at a time or at many.

        Parameters
        ----------
        t : float or array_like, shape (m,)
            Times.

        Returns
        -------
        ndarray, shape (n,) or (n, m)
            Values.
        """
        times = array_of("t", t)
        if times.ndim > 1:
            raise InputError(f"t has {times.ndim} dimensions, but must be a number or have 1", "t")
        values = self._solution.at(times.reshape(-1).tolist())
        n = self._solution.dimension
        return values.reshape(n) if times.ndim == 0 else values.reshape(times.size, n).T

    def __reduce__(self) -> Any:
        return (OdeSolution, (self._solution,))


class IvpResult(Record):
    """What :func:`solve_ivp` gives: the fields of SciPy.

    Attributes
    ----------
    t : ndarray, shape (n_points,)
        Times.
    y : ndarray, shape (n, n_points)
        Values at these times.
    sol : OdeSolution or None
        The solution as a function of time, where it was asked for.
    t_events, y_events : list of ndarray, shapes (k,) and (k, n), or None
        For each event its times, and the values there; None where there are no events to look for.
    nfev, njev, nlu : int
        Evaluations of f and of its Jacobian, factorisations.
    status : int
        0: the end was reached; 1: a terminal event; -1: it went no further.
    message : str
        That in words.
    success : bool
        Whether the status is 0 or 1.
    """

    t: Array
    y: Array
    sol: Optional[OdeSolution]
    t_events: Optional[list[Array]]
    y_events: Optional[list[Array]]
    nfev: int
    njev: int
    nlu: int
    status: int
    message: str
    success: bool

    def __repr__(self) -> str:
        return f"Ivp{super().__repr__().replace('Record', 'Result', 1)}"

    def __reduce__(self) -> Any:
        return (IvpResult, (dict(self),))


def array_of(field: str, values: Optional[npt.ArrayLike]) -> Array:
    try:
        given = np.asarray(values)
        if given.dtype.kind in "biuf":
            return given.astype(np.float64)
        # Numbers of other kinds, such as fractions; imaginary parts are not dropped.
        if given.dtype.kind == "O":
            return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{field} is {values!r}, but must be numbers", field)


def numbers_of(field: str, values: Optional[npt.ArrayLike]) -> list[float]:
    array = np.atleast_1d(array_of(field, values))
    if array.ndim != 1:
        raise InputError(f"{field} has {array.ndim} dimensions, but must have 1", field)
    numbers: list[float] = array.tolist()
    return numbers


def refusal(field: Optional[str], message: str) -> InputError:
    """What the input is refused for, in the names of SciPy."""
    for ours, theirs in (("start", "y0"), ("span", "t_span"), ("t_eval", "t_eval")):
        if field is not None and re.search(rf"\b{ours}\b", field):
            message = re.sub(r"(?<![\w])start(?=\b)", "y0", message)
            message = re.sub(r"(?<![\w])span(?=\b)", "t_span", message)
            return InputError(message, theirs)
    return InputError(message, field)
