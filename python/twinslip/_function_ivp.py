"""Initial value problems of functions in SciPy's form: traced, and run from one change of their comparisons to the next."""

from __future__ import annotations

import math
from typing import Any, Optional, cast

import numpy as np

from . import _core
from ._errors import InputError, Interrupted
from ._events import Asked, sampled_note, traced_event, with_notes
from ._function import Array, Function, Side, Traced, differs
from ._function_input import Problem, tolerances
from ._ivp_result import MESSAGES, Constant, IvpResult, Joined, OdeSolution, refusal
from ._rows import Rows
from ._symbols import Symbol
from .system import System

#: What changes its side, with the time and the values there.
Turn = tuple[Side, float, list[float]]

#: SciPy's methods, and the nearest of ours.
METHODS = {
    "RK23": "taylor",
    "RK45": "taylor",
    "DOP853": "taylor",
    "Radau": "auto",
    "BDF": "auto",
    "LSODA": "auto",
}
#: Those that look at the Jacobian, and what they are where the problem is stiff from its start.
IMPLICIT = {"Radau": "rodas5p", "BDF": "rodas5p"}
#: A problem is stiff from its start where what decays fastest does so as many times within the span.
_STIFF = 1e4
#: As far as a span without an end goes.
_FOREVER = 1e300
#: Zeros at times no more apart are at one time, as far as their isolation can tell, in units of 1 and the time together.
_AT_ONCE = 16 * float(np.finfo(float).eps)
#: What has failed was at the border of a comparison where it would have come there within this time, in the same units.
_NEAR = 1e-9
#: No comparison changes more often at one time.
_MOST_TURNS = 2


def solve_function(problem: Problem) -> IvpResult:
    """Solves the problem of a function: :func:`twinslip.solve_ivp`."""
    if not problem.y0 or problem.span[0] == problem.span[1]:
        return _still(problem)
    result = _Run(problem).solve()
    if problem.constant_jacobian:
        # As in SciPy: what is given once is not evaluated.
        result["njev"] = 0
    return result


class _Run:
    def __init__(self, problem: Problem) -> None:
        self.problem, self.numerics = problem, problem.numerics
        self.times, self.asked = problem.times, problem.events or []
        span, count = problem.span, len(problem.y0)
        self.atol, units = tolerances(self.numerics.atol, count)
        self.function = Function(problem.fun, problem.args, count, units, problem.vectorized)
        self.t, self.y = span[0], list(problem.y0)
        end = math.copysign(_FOREVER, span[1]) if math.isinf(span[1]) else span[1]
        self.way = 1.0 if end > self.t else -1.0
        self.ends = [end]
        # Rows at chosen times are the same whatever the steps are.
        first = self.numerics.first_step if self.times is None else None
        if first is not None and first < abs(end - self.t):
            self.ends.insert(0, self.t + self.way * first)
        self.length = abs(end - self.t)
        self.units = np.array(units)
        self.rows = Rows(len(self.asked), count)
        self.systems: dict[tuple[int, ...], list[str]] = {}
        self.checked = False
        self.events: list[Asked] = []
        self.method = self.numerics.method
        self.looked = 0

    def solve(self) -> IvpResult:
        """Runs from one change of a comparison to the next, until the end."""
        forced: dict[int, float] = {}
        still: dict[int, int] = {}
        status, failure = 0, None
        while self.ends:
            traced = self.function.traced(self.t, self.y, forced)
            if not self.checked:
                self._begin(traced)
            stuck = self._stuck(traced, forced)
            if stuck is not None:
                status, failure = -1, stuck
                break
            run, raised = self._run(traced, forced)
            self.rows.add(run, self.units, self.times is not None)
            if raised is not None:
                if isinstance(raised, KeyboardInterrupt):
                    told = "interrupted; what was computed is in the result"
                    raise Interrupted(told, self._result(-1, run.failure)) from None
                raise raised
            ended = self._border(run) if run.status < 0 else self._ended_by(run, traced.sides)
            if ended is None and run.status != 0:
                status, failure = run.status, run.failure
                break
            if ended is None:
                self._arrive(self.ends.pop(0))
                forced = {}
                continue
            side, time, values = ended
            if abs(time - self.t) > _AT_ONCE * (1.0 + abs(time)):
                still, forced = {}, {}
            still[side.place] = still.get(side.place, 0) + 1
            self.t, self.y = time, values
            # What changed its side at the same time stays there too.
            forced = {**forced, side.place: -side.side}
            if still[side.place] > _MOST_TURNS:
                status, failure = -1, self._no_way()
                break
            if self.t == self.ends[0]:
                self.ends.pop(0)
        return self._result(status, failure)

    def _begin(self, traced: Traced) -> None:
        """Checks the formulas against the function, and finds those of the events and the method."""
        self.checked = True
        function = self.function
        point = function.point(self.t, self.y)
        given = np.array(self.y)
        made = function.numbers(self.t, self.y)
        ours = [point.value(place) * unit for place, unit in zip(traced.rates, function.units)]
        theirs = np.asarray(made).reshape(-1)
        if np.iscomplexobj(theirs) or differs(ours, theirs.tolist()):
            raise InputError(
                f"fun gives {theirs.tolist()} at t = {self.t}, but {[float(rate) for rate in ours]} by what it does with symbols: "
                "it must give the same whenever it is called, of t and y alone",
                "fun",
            )
        self.events = [traced_event(function, one, self.t, given) for one in self.asked]
        name = self.numerics.method
        self.method = METHODS.get(name, name)
        if name in IMPLICIT:
            self.looked = 1
            if self._is_stiff(traced):
                self.method = IMPLICIT[name]

    def _is_stiff(self, traced: Traced) -> bool:
        """Whether something decays many times within the span, by the Jacobian at the start."""
        n = self.function.count
        jacobian = np.zeros((n, n))
        for j in range(n):
            along = [float(i == j) for i in range(n)]
            point = self.function.point(self.t, self.y, along)
            jacobian[:, j] = [
                point.slope(place) * unit for place, unit in zip(traced.rates, self.units)
            ]
        if not np.isfinite(jacobian).all():
            return False
        decays = -self.way * np.linalg.eigvals(jacobian).real
        return bool(decays.max() * self.length > _STIFF)

    def _system(self, traced: Traced) -> list[str]:
        """The words of the system with these rates."""
        key = tuple(traced.rates)
        if key not in self.systems:
            system = System(system=self.function.text(traced.rates))
            numerics = self.numerics
            self.systems[key] = system._solver_words(
                self.method, numerics.rtol, self.atol, numerics.max_step, numerics.max_steps
            )
        return self.systems[key]

    def _run(
        self, traced: Traced, forced: dict[int, float]
    ) -> tuple[_core.IvpRun, Optional[BaseException]]:
        words = self._system(traced)
        start = (np.array(self.y) / self.units).tolist()
        told: list[Any] = []
        for i, (event, asked) in enumerate(zip(self.events, self.asked)):
            most = None if asked.most is None else asked.most - len(self.rows.t_events[i])
            told.append((event.given(), asked.way, most, None))
        for side in traced.sides:
            text = self.function.formula(self._bordered(side, forced))
            if text is None:
                raise InputError(
                    f"y0 has {len(self.y)} values, but must have one less where `fun` compares what depends on t",
                    "y0",
                )
            told.append((text, 0.0, 1, side.side))
        times = self._due()
        run, refused, raised = _core.solve_ivp(
            words, (self.t, self.ends[0]), start, times, told, self.problem.dense_output
        )
        if refused is not None:
            raise refusal(*refused)
        assert run is not None
        return run, raised

    def _bordered(self, side: Side, forced: dict[int, float]) -> int:
        """The function whose sign tells the side: where a side has just been come to, less what is left of the other one by rounding, so
        that what rests there does not come back.
        """
        if side.place in forced:
            left = float(self.function.point(self.t, self.y).value(side.place))
            if left * side.side < 0.0:
                difference: Symbol = Symbol(self.function.formulas, side.place) - left
                return difference.place
        return side.place

    def _due(self) -> Optional[list[float]]:
        """The times that are asked for up to the end of this part."""
        if self.times is None:
            return None
        first, rest = bool(not self.rows.t), []
        for time in self.times:
            since, until = self.way * (time - self.t), self.way * (self.ends[0] - time)
            if (since > 0 or (first and since == 0)) and until >= 0:
                rest.append(time)
        return rest

    def _ended_by(self, run: _core.IvpRun, sides: list[Side]) -> Optional[Turn]:
        """What changed its side at the end of a part, with the time and the values there; None where nothing did."""
        times, values = run.t_events(), run.y_events()
        first = len(self.asked)
        for side, at, y in zip(sides, times[first:], values[first:]):
            if len(at) > 0:
                y = y.reshape(-1, run.dimension)[0] * self.units
                return side, float(at[0]), y.tolist()
        return None

    def _border(self, run: _core.IvpRun) -> Optional[Turn]:
        """Where a run that failed was about to change a comparison: there rates may not be smooth, as that of a tank that has run empty, and
        from there on it is on its other side.
        """
        if self.times is not None:
            # The rows are at other times.
            traced = self.function.traced(self.t, self.y, {})
            words = self._system(traced)
            start = (np.array(self.y) / self.units).tolist()
            again, _, _ = _core.solve_ivp(words, (self.t, self.ends[0]), start, None, [], False)
            if again is None:
                return None
            run = again
        values = run.y().reshape(-1, run.dimension)[-1] * self.units
        t, y = float(run.t()[-1]), values.tolist()
        for kinks in (self.function.kinks, True):
            self.function.kinks = kinks
            traced = self.function.traced(t, y, {})
            point = self.function.point(t, y)
            rates = [point.value(place) * unit for place, unit in zip(traced.rates, self.units)]
            point = self.function.point(t, y, rates)
            for side in traced.sides:
                left = abs(point.value(side.place))
                fall = -self.way * side.side * point.slope(side.place)
                if fall > 0.0 and left <= _NEAR * (1.0 + abs(t)) * fall:
                    return side, t, y
        return None

    def _arrive(self, end: float) -> None:
        """At the end of a part that nothing ended."""
        self.t = end
        if self.ends:
            self.y = self.rows.y[-1][-1].tolist()

    def _stuck(self, traced: Traced, forced: dict[int, float]) -> Optional[str]:
        """Why it can't go on, where what has changed its side is led back at once."""
        point = self.function.point(self.t, self.y)
        rates = [point.value(place) * unit for place, unit in zip(traced.rates, self.units)]
        point = self.function.point(self.t, self.y, rates)
        for place, side in forced.items():
            if any(one.place == place for one in traced.sides):
                if self.way * point.slope(place) * side < 0.0:
                    return self._no_way()
        return None

    def _no_way(self) -> str:
        return (
            f"at t = {self.t} what `fun` compares is 0, and its rates lead there from both sides: where it is to stay there, use a smooth "
            "form, such as np.tanh(x/width)"
        )

    def _result(self, status: int, failure: Optional[str]) -> IvpResult:
        rows, n = self.rows, self.function.count
        has_events = self.problem.events is not None
        t = np.concatenate(rows.t) if rows.t else np.array([self.t])
        y = np.concatenate(rows.y) if rows.y else np.array([self.y])
        message = MESSAGES[status] if status in MESSAGES else str(failure)
        notes = []
        name = self.numerics.method
        if status != 1 and name in METHODS:
            notes.append(f"`{self.method}` ran in place of {name}.")
        for i, one in enumerate(self.events):
            notes.append(sampled_note(i, one.reason, rows.undecided[i]))
        sol = None
        if self.problem.dense_output and rows.pieces:
            sol = OdeSolution(Joined(rows.pieces, n, self.function.units))
        empty: Any = []
        return IvpResult(
            # SciPy has empty lists where none of the times was reached, which are false.
            t=t if t.size else cast(Array, empty),
            y=y.T if t.size else cast(Array, empty),
            sol=sol,
            t_events=[np.array(one) for one in rows.t_events] if has_events else None,
            y_events=[np.array(one) for one in rows.y_events] if has_events else None,
            nfev=int(rows.work[0]),
            njev=int(rows.work[1]) + self.looked,
            nlu=int(rows.work[2]) + self.looked,
            status=status,
            message=with_notes(message, notes),
            success=status >= 0,
        )


def _still(problem: Problem) -> IvpResult:
    """Where nothing moves: there are no values, or no time for them."""
    span, y0, times = problem.span, problem.y0, problem.times
    t = np.array(list(span) if times is None else times, dtype=np.float64)
    none = None if problem.events is None else [np.empty(0) for _ in problem.events]
    return IvpResult(
        t=t,
        y=np.repeat(np.array(y0, dtype=np.float64)[:, np.newaxis], len(t), axis=1),
        sol=OdeSolution(Constant(span, y0)) if problem.dense_output else None,
        t_events=none,
        y_events=None if none is None else [one.copy() for one in none],
        nfev=0,
        njev=0,
        nlu=0,
        status=0,
        message=MESSAGES[0],
        success=True,
    )
