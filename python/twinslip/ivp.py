"""Initial value problems in the terms of SciPy."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._errors import InputError, Interrupted
from ._values import Record
from .system import System

__all__ = ["IvpResult", "OdeSolution", "solve_ivp"]

Array = npt.NDArray[np.float64]
EventFunction = Callable[..., Any]

MESSAGES = {
    0: "The solver successfully reached the end of the integration interval.",
    1: "A termination event occurred.",
}


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

    def __init__(self, solution: _core.Solution) -> None:
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
        times = _array("t", t)
        if times.ndim > 1:
            raise InputError(f"t has {times.ndim} dimensions, but must be a number or have 1", "t")
        values = self._solution.at(times.reshape(-1).tolist())
        n = self._solution.dimension
        return values.reshape(n) if times.ndim == 0 else values.reshape(-1, n).T

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


def solve_ivp(
    system: System,
    t_span: npt.ArrayLike,
    y0: npt.ArrayLike,
    method: str = "auto",
    t_eval: Optional[npt.ArrayLike] = None,
    dense_output: bool = False,
    events: Union[EventFunction, Sequence[EventFunction], None] = None,
    vectorized: bool = False,
    args: Optional[Sequence[Any]] = None,
    *,
    rtol: float = 1e-8,
    atol: Optional[float] = None,
    max_steps: Optional[int] = None,
    jac: Any = None,
    first_step: Optional[float] = None,
    max_step: float = np.inf,
) -> IvpResult:
    """Solves an initial value problem; a call of SciPy's needs another first argument.

    Parameters
    ----------
    system : System
        What is integrated, in place of a function.
    t_span : (float, float)
        Where it begins and ends [L/V*; s in SI]; backward in time where the end is the smaller
        one.
    y0 : array_like, shape (n,)
        The start: (tau, psi_1, psi_2, ...) of interfaces, or the states of a system of one's own.
    method : str
        ``"auto"``, ``"taylor"``, ``"rodas5p"``, ``"rodas4"``, ``"rosenbrock23"``,
        ``"cvode-bdf"`` or ``"cvode-adams"``.
    t_eval : array_like, optional
        Times at which the solution is kept, within the span and in its order; else the ends of
        all steps.
    dense_output : bool
        Whether ``sol`` is made.
    events : callable or sequence of callables, optional
        ``event(t, y)``, whose zeros are found; with the attributes ``terminal`` (True, or after
        how many the run ends) and ``direction`` (only upwards if positive, only downwards if
        negative, along the run). What it raises comes through.
    args : sequence, optional
        More arguments of the events.
    rtol, atol : float
        Local error tolerances, each one number; of interfaces they are of tau and ln psi,
        dimensionless. atol is rtol unless it is given.
    max_steps : int, optional
        Give up after so many steps.
    vectorized, jac, first_step
        Taken as SciPy takes them, and not needed: derivatives are exact, and the first step finds
        itself.
    max_step : float
        The largest step in time, for what is shorter than a step: a pulse that begins and ends
        within one is seen by no method. Long steps of power series are looked at for events in half as many parts
        as their order; two zeros within one part are missed, as by SciPy within a step.

    Returns
    -------
    IvpResult
        With the fields of SciPy. A failure is ``success = False`` with its message, as there.

    Raises
    ------
    ValueError
        If the input is to blame; its ``field`` is the argument.
    """
    del vectorized, jac, first_step
    if not isinstance(system, System):
        hint = "; make one with System.from_function" if callable(system) else ""
        raise InputError(f"system is {system!r}, but must be a twinslip.System{hint}", "system")
    if not (isinstance(max_step, (int, float, np.number)) and max_step > 0):
        raise InputError(f"max_step is {max_step!r}, but must be a positive number", "max_step")
    span = _numbers("t_span", t_span)
    if len(span) != 2:
        raise InputError(f"t_span is {t_span!r}, but must be two times", "t_span")
    start = _numbers("y0", y0)
    times = None if t_eval is None else _numbers("t_eval", t_eval)
    # A class of SciPy's is told by its name, as the names of SciPy are.
    named = method if isinstance(method, str) else getattr(method, "__name__", repr(method))
    words = system._solver_words(named, rtol, atol, None if max_step == np.inf else max_step, max_steps)
    told = _events(events, args)
    run, refused, raised = _core.solve_ivp(
        words, (span[0], span[1]), start, times, told, bool(dense_output)
    )
    if refused is not None:
        raise _refusal(*refused)
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


def _refusal(field: Optional[str], message: str) -> InputError:
    """What the input is refused for, in the names of SciPy."""
    for ours, theirs in (("start", "y0"), ("span", "t_span"), ("t_eval", "t_eval")):
        if field is not None and re.search(rf"\b{ours}\b", field):
            message = re.sub(r"(?<![\w])start(?=\b)", "y0", message)
            message = re.sub(r"(?<![\w])span(?=\b)", "t_span", message)
            return InputError(message, theirs)
    return InputError(message, field)


def _array(field: str, values: npt.ArrayLike) -> Array:
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


def _numbers(field: str, values: npt.ArrayLike) -> list[float]:
    array = np.atleast_1d(_array(field, values))
    if array.ndim != 1:
        raise InputError(f"{field} has {array.ndim} dimensions, but must have 1", field)
    numbers: list[float] = array.tolist()
    return numbers


def _events(
    events: Union[EventFunction, Sequence[EventFunction], None], args: Optional[Sequence[Any]]
) -> list[tuple[EventFunction, float, Optional[int]]]:
    try:
        more = () if args is None else tuple(args)
    except TypeError:
        told = f"args is {args!r}, but must be a sequence, such as ({args!r},)"
        raise InputError(told, "args") from None
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


def _event(
    function: EventFunction, more: tuple[Any, ...]
) -> tuple[EventFunction, float, Optional[int]]:
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
        raise InputError(f"events has a `terminal` of {terminal!r}, but must have {must}", "events")
    try:
        way = 0.0 if direction is None else float(direction)
    except (TypeError, ValueError, OverflowError):
        way = np.nan
    if way != way:
        told = f"events has a `direction` of {direction!r}, but must have a number"
        raise InputError(told, "events")

    def called(t: float, y: Array) -> float:
        return float(function(t, y, *more))

    return called, way, most or None
