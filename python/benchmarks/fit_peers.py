#!/usr/bin/env python3
"""One fit of a velocity step, by twinslip and by scipy's curve_fit around odeint, as fits are usually written.

Prints both minima and the ratio of the times, in one run: python python/benchmarks/fit_peers.py [DATA]
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from scipy.integrate import odeint
from scipy.optimize import curve_fit

import twinslip

DATA = Path(__file__).resolve().parents[2] / "tests" / "data" / "laboratory" / "basalt.txt"
NAMES = ["direct_effect", "evolution_effect", "slip_length", "stiffness", "reference_friction"]


def main() -> None:
    path = sys.argv[1] if len(sys.argv) > 1 else DATA
    given = {"from_": 11650.0, "to": 11690.0}
    slider = twinslip.System(law="slip")
    fit = slider.fit(path, **given)
    times = [_timed(lambda: slider.fit(path, intervals="linear", **given).verdict) for _ in range(5)]
    ours = min(times)
    sigma = fit.model["normal_stress"]
    (slow, fast) = (one["driving"][0] for one in fit.result["program"][:2])
    step = fit.result["program"][0]["to"]
    t, mu = np.asarray(fit.time), np.asarray(fit.observed)

    def friction(t: np.ndarray, a: float, b: float, length: float, k: float, level: float) -> np.ndarray:
        """The slip law in ln(V* theta/L), lengths in micrometres."""
        def rates(y: np.ndarray, _: float, drive: float) -> list[float]:
            v = slow * np.exp((y[0] - level - b * y[1]) / a)
            return [k * 1e6 * (drive - v), -v / (length * 1e-6) * (y[1] + np.log(v / slow))]

        def along(times: np.ndarray, start: list[float], drive: float) -> np.ndarray:
            return odeint(rates, start, times, args=(drive,), rtol=1e-10, atol=1e-10, mxstep=100_000)

        before = along(np.append(t[t <= step], step), [level, 0.0], slow)
        after = along(np.append(step, t[t > step]), list(before[-1]), fast)
        return np.concatenate([before[:-1, 0], after[1:, 0]])

    best = np.array([fit[name].value for name in NAMES])
    best[2] *= 1e6
    best[3] *= 1e-6 / sigma
    start = best * [1.4, 1.2, 0.7, 0.7, 1.0]
    found: list[np.ndarray] = []
    theirs = _timed(lambda: found.append(curve_fit(friction, t, mu, p0=start, xtol=1e-10, ftol=1e-10)[0]))
    squares = lambda p: float(np.sum((mu - friction(t, *p)) ** 2))  # noqa: E731
    print(f"samples {len(t)}")
    print(f"sum of squares: twinslip {squares(best):.12e}, curve_fit {squares(found[0]):.12e}")
    for name, x, y in zip(NAMES, best, found[0]):
        print(f"{name:20s} {x:.9g} {y:.9g}  relative difference {abs(x / y - 1):.1e}")
    print(f"twinslip {ours * 1e3:.1f} ms (with the search for a start), curve_fit {theirs * 1e3:.0f} ms "
          f"(started near the minimum): {theirs / ours:.0f} times")


def _timed(work: object) -> float:
    begun = time.perf_counter()
    work()  # type: ignore[operator]
    return time.perf_counter() - begun


if __name__ == "__main__":
    main()
