"""What is asked of an initial value problem of a function, checked."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import Any, Callable, NamedTuple, Optional

import numpy as np

from ._errors import InputError
from ._events import AskedEvent
from ._ivp_result import numbers_of


class Numerics(NamedTuple):
    """How a problem is solved, as it is asked."""

    method: str
    rtol: float
    atol: Any
    max_step: Optional[float]
    max_steps: Optional[int]
    first_step: Optional[float]


class Problem(NamedTuple):
    """An initial value problem of a function."""

    fun: Callable[..., Any]
    span: tuple[float, float]
    y0: Sequence[float]
    times: Optional[list[float]]
    #: None where no events are asked for.
    events: Optional[list[AskedEvent]]
    args: tuple[Any, ...]
    numerics: Numerics
    dense_output: bool
    vectorized: bool
    constant_jacobian: bool


def unpacked(args: Any) -> tuple[Any, ...]:
    """The further arguments of functions."""
    try:
        return () if args is None else tuple(args)
    except TypeError:
        # In the words of SciPy.
        raise TypeError(
            f"Supplied 'args' cannot be unpacked. Please supply `args` as a tuple (e.g. `args=({args},)`)"
        ) from None


def spanned(t_span: Any, y0: Any) -> tuple[tuple[float, float], list[float]]:
    """The span of time, which may have no end, and the start."""
    span = numbers_of("t_span", t_span)
    if len(span) != 2:
        raise InputError(f"t_span is {t_span!r}, but must be two times", "t_span")
    if not np.isfinite(span[0]) or np.isnan(span[1]):
        raise InputError(f"t_span is {t_span!r}, but must begin at a finite time", "t_span")
    if np.iscomplexobj(y0):
        raise InputError(
            f"y0 is {y0!r}, but must be real: write the real and imaginary parts of complex values as two states",
            "y0",
        )
    start = numbers_of("y0", y0)
    if not np.isfinite(start).all():
        told = "All components of the initial state `y0` must be finite."
        raise InputError(f"{told} It is {start}", "y0")
    return (span[0], span[1]), start


def times_within(t_eval: Any, span: tuple[float, float]) -> list[float]:
    """Times at which the solution is asked for."""
    times = numbers_of("t_eval", t_eval)
    way = 1.0 if span[1] >= span[0] else -1.0
    for i, time in enumerate(times):
        if not min(span) <= time <= max(span):
            told = (
                f"t_eval[{i}] is {time}, but must be within `t_span`, from {span[0]} to {span[1]}"
            )
            raise InputError(told, "t_eval")
        if i > 0 and not way * (time - times[i - 1]) > 0:
            word = "greater" if way > 0 else "less"
            told = f"t_eval[{i}] is {time}, but must be {word} than {times[i - 1]}, the time before"
            raise InputError(told, "t_eval")
    return times


def first_step_of(first_step: Any, span: tuple[float, float]) -> float:
    """The length of the first step."""
    length = abs(span[1] - span[0])
    if not (isinstance(first_step, (int, float, np.number)) and 0 < first_step <= length):
        told = f"first_step is {first_step!r}, but must be positive and no larger than t_span, {length}"
        raise InputError(told, "first_step")
    return float(first_step)


def least_rtol(rtol: Any) -> float:
    """The smallest of the relative tolerances, which holds for all states; too small ones are raised, as in SciPy."""
    least = float(np.finfo(float).eps)
    try:
        each = np.asarray(rtol, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(
            f"rtol is {rtol!r}, but must be a number or one for each value of y0", "rtol"
        ) from None
    if each.size == 0 or not (each >= 0).all():
        raise InputError(f"rtol is {rtol!r}, but must be positive", "rtol")
    if (each < least).any():
        warnings.warn(
            f"At least one element of `rtol` is too small. Setting `rtol = np.maximum(rtol, {least})`.",
            UserWarning,
            stacklevel=3,
        )
    return float(np.maximum(each, least).min())


def tolerances(atol: Any, count: int) -> tuple[Optional[float], list[float]]:
    """One absolute tolerance for all states, and the units of the states in which it is theirs.

    The units are powers of two, so that no value is rounded: a state's tolerance is no larger than what is asked, and no less than half
    of that.
    """
    if atol is None or np.ndim(atol) == 0:
        return (None if atol is None else atol), [1.0] * count
    try:
        each = np.asarray(atol, dtype=np.float64)
    except (TypeError, ValueError):
        each = np.full(0, np.nan)
    if each.shape != (count,) or not (np.isfinite(each).all() and (each >= 0).all()):
        raise InputError(
            f"atol is {atol!r}, but must be a number or {count} numbers, one for each value of y0, none of them negative",
            "atol",
        )
    most = float(each.max())
    if most == 0.0:
        return 0.0, [1.0] * count
    # Of a state whose tolerance is 0 it is so small that its relative one is all that counts.
    least = 2.0**-200
    return most, [2.0 ** math.floor(math.log2(max(one / most, least))) for one in each]
