"""What a run in parts has given so far."""

from __future__ import annotations

import numpy as np

from . import _core
from ._ivp_result import Array

#: An event as near to the last one of its function, in parts of the time, is the same one.
_SAME = 1e-14


class Rows:
    """What a run has given so far."""

    def __init__(self, events: int, count: int) -> None:
        self.t: list[Array] = []
        self.y: list[Array] = []
        self.t_events: list[list[float]] = [[] for _ in range(events)]
        self.y_events: list[list[Array]] = [[] for _ in range(events)]
        self.pieces: list[_core.Solution] = []
        self.work = np.zeros(3, dtype=int)
        self.undecided = [False] * events
        self.count = count

    def add(self, run: _core.IvpRun, units: Array, chosen: bool) -> None:
        """One part of the run, with its rows, which begin where the last one ended, and its events."""
        t, y = run.t(), run.y().reshape(-1, run.dimension) * units
        again = 1 if self.t and not chosen else 0
        self.t.append(t[again:])
        self.y.append(y[again:])
        solution = run.solution()
        if solution is not None:
            self.pieces.append(solution)
        self.work += run.work
        found = zip(run.t_events(), run.y_events(), run.undecided())
        for i, (times, values, undecided) in enumerate(found):
            if i >= len(self.t_events):
                break
            values = values.reshape(-1, run.dimension) * units
            for time, value in zip(times.tolist(), values):
                # What ends one part is not found again as the beginning of the next one.
                last = self.t_events[i][-1] if self.t_events[i] else None
                if last is None or len(self.t) == 1 or abs(time - last) > _SAME * abs(time):
                    self.t_events[i].append(time)
                    self.y_events[i].append(value)
            self.undecided[i] |= undecided
