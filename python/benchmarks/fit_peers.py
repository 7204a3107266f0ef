#!/usr/bin/env python3
"""Fits of a velocity step by twinslip and by scipy's curve_fit around odeint, as fits are usually written.

Prints, for the slip and the ageing law, both minima and the ratio of the times, in one run:

    python python/benchmarks/fit_peers.py [DATA [FROM TO]]

Where friction goes on in the direction of the step, b is negative; the search is told that it may be. The values of the basalt record are those
that `tests/fit_records.rs` keeps.
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
    path, window = DATA, {"from_": 11650.0, "to": 11690.0}
    if len(sys.argv) > 1:
        path = Path(sys.argv[1])
        window = dict(zip(["from_", "to"], map(float, sys.argv[2:])))
    for law in ["slip", "ageing"]:
        compare(path, law, window)


def compare(path: Path, law: str, window: dict[str, float]) -> None:
    slider = twinslip.System(law=law)
    given = {"bounds": "evolution_effect=-0.1:0.1", **window}
    fit = slider.fit(path, **given)
    times = [_timed(lambda: slider.fit(path, intervals="linear", **given).verdict) for _ in range(5)]
    ours = min(times)
    sigma = fit.model["normal_stress"]
    (slow, fast) = (one["driving"][0] for one in fit.result["program"][:2])
    step = fit.result["program"][0]["to"]
    t, mu = np.asarray(fit.time), np.asarray(fit.observed)

    def friction(t: np.ndarray, a: float, b: float, length: float, k: float, level: float) -> np.ndarray:
        """In ln(V* theta/L), lengths in micrometres."""
        def rates(y: np.ndarray, _: float, drive: float) -> list[float]:
            v = slow * np.exp((y[0] - level - b * y[1]) / a)
            renewal = -v * (y[1] + np.log(v / slow)) if law == "slip" else slow * np.exp(-y[1]) - v
            return [k * 1e6 * (drive - v), renewal / (length * 1e-6)]

        def along(times: np.ndarray, start: list[float], drive: float) -> np.ndarray:
            return odeint(rates, start, times, args=(drive,), rtol=1e-10, atol=1e-10, mxstep=100_000)

        before = along(np.append(t[t <= step], step), [level, 0.0], slow)
        after = along(np.append(step, t[t > step]), list(before[-1]), fast)
        return np.concatenate([before[:-1, 0], after[1:, 0]])

    best = np.array([fit[name].value for name in NAMES])
    errors = np.array([fit[name].uncertainty for name in NAMES])
    for of in [best, errors]:
        of[2] *= 1e6
        of[3] *= 1e-6 / sigma
    start = best * [1.4, 1.2, 0.7, 0.7, 1.0]
    found: list[np.ndarray] = []
    # By differences of the usual size curve_fit ends as far as 0.2 standard errors from the minimum: the noise of odeint is in them.
    careful = {"method": "trf", "x_scale": np.abs(start), "diff_step": 1e-6, "xtol": 1e-13, "ftol": 1e-13, "gtol": 1e-13}
    theirs = _timed(lambda: found.append(curve_fit(friction, t, mu, p0=start, **careful)[0]))
    squares = lambda p: float(np.sum((mu - friction(t, *p)) ** 2))  # noqa: E731
    print(f"{law}, {len(t)} samples")
    print(f"sum of squares: twinslip {squares(best):.12e}, curve_fit {squares(found[0]):.12e}")
    for name, x, error, y in zip(NAMES, best, errors, found[0]):
        print(f"{name:20s} {x:.9g} ± {error:.2g}  {y:.9g}  apart {abs(x - y) / error:.1e} standard errors")
    print(f"twinslip {ours * 1e3:.1f} ms (with the search for a start), curve_fit {theirs * 1e3:.0f} ms "
          f"(started near the minimum): {theirs / ours:.0f} times")


def _timed(work: object) -> float:
    begun = time.perf_counter()
    work()  # type: ignore[operator]
    return time.perf_counter() - begun


if __name__ == "__main__":
    main()
