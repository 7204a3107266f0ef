"""Initial value problems in the terms of SciPy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._errors import InputError, Interrupted
from ._events import AskedEvent, EventFunction, traced_for_system
from ._function_input import (
    Numerics,
    Problem,
    first_step_of,
    least_rtol,
    spanned,
    times_within,
    unpacked,
)
from ._function_ivp import solve_function
from ._ivp_result import MESSAGES, Array, IvpResult, OdeSolution, numbers_of, refusal
from .system import System

__all__ = ["IvpResult", "OdeSolution", "solve_ivp"]

RateFunction = Callable[..., Any]


def solve_ivp(
    fun: Union[System, RateFunction, None] = None,
    t_span: Optional[npt.ArrayLike] = None,
    y0: Optional[npt.ArrayLike] = None,
    method: Any = "auto",
    t_eval: Optional[npt.ArrayLike] = None,
    dense_output: bool = False,
    events: Union[EventFunction, Sequence[EventFunction], None] = None,
    vectorized: bool = False,
    args: Optional[Sequence[Any]] = None,
    *,
    system: Optional[System] = None,
    rtol: Union[float, npt.ArrayLike] = 1e-8,
    atol: Union[float, npt.ArrayLike, None] = None,
    max_steps: Optional[int] = None,
    jac: Any = None,
    first_step: Optional[float] = None,
    max_step: float = np.inf,
    jac_sparsity: Any = None,
    lband: Optional[int] = None,
    uband: Optional[int] = None,
    min_step: float = 0.0,
) -> IvpResult:
    """Solves an initial value problem, of a function as SciPy takes it or of a system.

    Parameters
    ----------
    fun : callable or System
        ``fun(t, y, *args)`` gives the rates of 1 to 100 values, as in SciPy. It is called once, with
        symbols, and again wherever one of its comparisons changes: arithmetic, numpy's functions
        of each element and those of ``math``, indexing, slices, loops, arrays, ``np.where`` and
        ``if`` go, steps such as ``t % 1`` too. Runs end and begin again where a comparison
        changes, as exactly as anywhere. With t in the rates there may be 99 values. A System is
        taken too, also by the name ``system``.
    t_span : (float, float)
        Where it begins and ends [of interfaces L/V*; s in SI]; backward in time where the end is
        the smaller one. Of a function the end may be infinite.
    y0 : array_like, shape (n,)
        The start: real values; of interfaces (tau, psi_1, psi_2, ...).
    method : str or class
        ``"auto"``, ``"taylor"``, ``"rodas5p"``, ``"rodas4"``, ``"rosenbrock23"``, ``"radau"``,
        ``"cvode-bdf"`` or ``"cvode-adams"``. Of a function also SciPy's: ``"RK23"``, ``"RK45"`` and
        ``"DOP853"`` are ``"taylor"``, ``"Radau"``, ``"BDF"`` and ``"LSODA"`` are ``"auto"``; the first
        two look at the Jacobian first, and are ``"rodas5p"`` where the problem is stiff from its
        start. The message says so, but where an event ends the run, as scripts compare that one.
    t_eval : array_like, optional
        Times at which the solution is kept, within the span and in its order; else the ends of
        all steps.
    dense_output : bool
        Whether ``sol`` is made.
    events : callable or sequence of callables, optional
        ``event(t, y, *args)``, whose zeros are found; with the attributes ``terminal`` (True, or
        after how many the run ends) and ``direction`` (only upwards if positive, only downwards if
        negative, along the run). It is called with symbols too, and the zeros of its formula are
        isolated within each step, so that none is missed. One that has no formula is looked at at
        the ends of steps and, within the long ones of power series, at half as many points as
        their order: two zeros between two looks are missed. Of a function the message says so. What
        it raises comes through.
    vectorized : bool
        Whether the function takes an array of columns.
    args : sequence, optional
        More arguments of the function and the events.
    system : System, optional
        Another name of the first argument.
    rtol : float or array_like
        Relative tolerance of a step. Of several the smallest holds for all.
    atol : float or array_like, shape (n,), optional
        Absolute tolerance, rtol unless it is given. Of a function each value may have its own, which
        is rounded down to a power of two times the largest. Of interfaces it is of tau and ln psi,
        dimensionless.
    max_steps : int, optional
        Give up after so many steps; of a function that compares, between two changes.
    jac, jac_sparsity, lband, uband, min_step
        Taken as SciPy takes them, and not needed: derivatives are exact. ``njev`` is 0 with a matrix.
    first_step : float, optional
        Of a function the first step ends there, or before where the tolerances ask for that.
    max_step : float
        The largest step in time, for what is shorter than a step: a smooth pulse that begins and
        ends within one is seen by no method.

    Returns
    -------
    IvpResult
        With the fields of SciPy. A failure is ``success = False`` with its message, as there.

    Raises
    ------
    ValueError
        If the input is to blame; its ``field`` is the argument.
    """
    del jac_sparsity, lband, uband, min_step
    if fun is not None and system is not None:
        raise InputError("system is given twice, as the first argument and by its name", "system")
    # A class of SciPy's is told by its name, as the names of SciPy are.
    named = method if isinstance(method, str) else getattr(method, "__name__", repr(method))
    if not (isinstance(max_step, (int, float, np.number)) and max_step > 0):
        raise InputError(f"max_step is {max_step!r}, but must be a positive number", "max_step")
    largest = None if max_step == np.inf else float(max_step)
    if callable(fun) and not isinstance(fun, System):
        more = unpacked(args)
        span, start = spanned(t_span, y0)
        step = None if first_step is None else first_step_of(first_step, span)
        return solve_function(
            Problem(
                fun,
                span,
                start,
                None if t_eval is None else times_within(t_eval, span),
                None if events is None else _events(events, more),
                more,
                Numerics(named, least_rtol(rtol), atol, largest, max_steps, step),
                bool(dense_output),
                bool(vectorized),
                jac is not None and not callable(jac),
            )
        )
    known = fun if system is None else system
    if not isinstance(known, System):
        hint = "; make one with System.from_function" if callable(known) else ""
        raise InputError(
            f"system is {known!r}, but must be a twinslip.System, or a function fun(t, y) as the first argument{hint}",
            "system",
        )
    ends = numbers_of("t_span", t_span)
    if len(ends) != 2:
        raise InputError(f"t_span is {t_span!r}, but must be two times", "t_span")
    start = numbers_of("y0", y0)
    times = None if t_eval is None else numbers_of("t_eval", t_eval)
    words = known._solver_words(named, rtol, atol, largest, max_steps)
    try:
        more = () if args is None else tuple(args)
    except TypeError:
        told = f"args is {args!r}, but must be a sequence, such as ({args!r},)"
        raise InputError(told, "args") from None
    found = [traced_for_system(one, more, len(start)) for one in _events(events, more)]
    given = [(one.given, one.asked.way, one.asked.most, None) for one in found]
    run, refused, raised = _core.solve_ivp(
        words, (ends[0], ends[1]), start, times, given, bool(dense_output)
    )
    if refused is not None:
        raise refusal(*refused)
    assert run is not None
    result = _result(run, events is not None)
    if raised is not None:
        if isinstance(raised, KeyboardInterrupt):
            raise Interrupted("interrupted; what was computed is in the result", result) from None
        raise raised
    return result


def _result(run: _core.IvpRun, has_events: bool) -> IvpResult:
    n, nfev_njev_nlu = run.dimension, run.work
    solution = run.solution()
    status = run.status
    return IvpResult(
        t=run.t(),
        y=run.y().reshape(-1, n).T,
        sol=None if solution is None else OdeSolution(solution),
        t_events=run.t_events() if has_events else None,
        y_events=[one.reshape(-1, n) for one in run.y_events()] if has_events else None,
        nfev=nfev_njev_nlu[0],
        njev=nfev_njev_nlu[1],
        nlu=nfev_njev_nlu[2],
        status=status,
        message=MESSAGES[status] if status in MESSAGES else str(run.failure),
        success=status >= 0,
    )


def _events(
    events: Union[EventFunction, Sequence[EventFunction], None], more: tuple[Any, ...]
) -> list[AskedEvent]:
    if events is None:
        return []
    if callable(events):
        return [_event(events, more)]
    try:
        functions = list(events)
    except TypeError:
        told = f"events is {events!r}, but must be a function or a sequence of functions"
        raise InputError(told, "events") from None
    return [_event(function, more) for function in functions]


def _event(function: EventFunction, more: tuple[Any, ...]) -> AskedEvent:
    if not callable(function):
        raise InputError(f"events has {function!r}, but must have functions", "events")
    terminal: Any = getattr(function, "terminal", None)
    direction: Any = getattr(function, "direction", None)
    try:
        most = 0 if terminal is None else int(terminal)
        right = most >= 0 and (terminal is None or most == terminal)
    except (TypeError, ValueError, OverflowError):
        right = False
    if not right:
        must = "True, False or a whole number, not negative"
        told = f"The `terminal` attribute of one of the events is {terminal!r}, but must be {must}"
        raise InputError(told, "events")
    try:
        way = 0.0 if direction is None else float(direction)
    except (TypeError, ValueError, OverflowError):
        way = np.nan
    if way != way:
        told = f"events has a `direction` of {direction!r}, but must have a number"
        raise InputError(told, "events")

    def called(t: float, y: Array) -> float:
        made = function(t, y, *more)
        # SciPy takes arrays of one value too.
        return float(
            made.reshape(-1)[0] if isinstance(made, np.ndarray) and made.size == 1 else made
        )

    return AskedEvent(function, called, way, most or None)
