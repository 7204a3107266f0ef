"""Initial value problems in the terms of SciPy."""

from __future__ import annotations

import math
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
        times = np.asarray(t, dtype=float)
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
    t_events, y_events : list of ndarray, or None
        For each event its times, and the values there.
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

    def __reduce__(self) -> Any:
        return (IvpResult, (dict(self),))


def solve_ivp(
    system: System,
    t_span: Sequence[float],
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
    max_step: float = math.inf,
) -> IvpResult:
    """Solves an initial value problem; a call of ``scipy.integrate.solve_ivp`` needs another first argument.

    Parameters
    ----------
    system : System
        What is integrated, in place of a function.
    t_span : (float, float)
        Where it begins and ends [L/V*; s in SI]; backward in time where the end is the smaller one.
    y0 : array_like, shape (n,)
        The start: (tau, psi_1, psi_2, ...) of interfaces, or the states of a system of one's own.
    method : str
        ``"auto"``, ``"taylor"``, ``"rodas5p"``, ``"rodas4"``, ``"rosenbrock23"``, ``"cvode-bdf"`` or ``"cvode-adams"``.
    t_eval : array_like, optional
        Times at which the solution is kept, within the span and in its order; else the ends of all steps.
    dense_output : bool
        Whether ``sol`` is made.
    events : callable or sequence of callables, optional
        ``event(t, y)``, whose zeros are found; with the attributes ``terminal`` (True, or after how many the run ends) and
        ``direction`` (only upwards if positive, only downwards if negative).
    args : sequence, optional
        More arguments of the events.
    rtol, atol : float
        Local error tolerances; of interfaces they are of tau and ln psi, dimensionless. atol is rtol unless it is given.
    max_steps : int, optional
        Give up after so many steps.
    vectorized, jac, first_step
        Taken as SciPy takes them, and not needed: derivatives are exact, and the first step finds itself.
    max_step : float
        Must be infinite: no event and no change of the system is missed for the length of a step.

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
    if not math.isinf(max_step):
        raise InputError(f"max_step is {max_step!r}, but must be infinite", "max_step")
    span = _numbers("t_span", t_span)
    if len(span) != 2:
        raise InputError(f"t_span has {len(span)} numbers, but must have 2", "t_span")
    start = _numbers("y0", y0)
    times = None if t_eval is None else _numbers("t_eval", t_eval)
    functions: list[EventFunction] = [] if events is None else [events] if callable(events) else list(events)
    words = system._solver_words(method, rtol, atol, max_steps)
    told = [_event(function, args) for function in functions]
    run, refused, raised = _core.solve_ivp(
        words, (span[0], span[1]), start, times, told, bool(dense_output)
    )
    if refused is not None:
        field, message = refused
        for ours, theirs in (("start", "y0"), ("span", "t_span")):
            field = theirs if field is not None and field.startswith(ours) else field
        raise InputError(message, field)
    assert run is not None
    result = _result(run, bool(functions))
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


def _numbers(field: str, values: npt.ArrayLike) -> list[float]:
    try:
        array = np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        raise InputError(f"{field} is {values!r}, but must be numbers", field) from None
    if array.ndim != 1:
        raise InputError(f"{field} has {array.ndim} dimensions, but must have 1", field)
    numbers: list[float] = array.tolist()
    return numbers


def _event(
    function: EventFunction, args: Optional[Sequence[Any]]
) -> tuple[EventFunction, float, Optional[int]]:
    if not callable(function):
        raise InputError(f"events has {function!r}, but must be functions", "events")
    terminal = getattr(function, "terminal", None)
    direction = float(getattr(function, "direction", 0.0) or 0.0)
    if terminal is None or terminal is False:
        most = None
    elif terminal is True:
        most = 1
    elif int(terminal) == terminal and terminal > 0:
        most = int(terminal)
    else:
        raise InputError("the `terminal` of an event must be True, False or a positive whole number", "events")
    more = () if args is None else tuple(args)

    def called(t: float, y: Array) -> float:
        return float(function(t, y, *more))

    return called, direction, most
