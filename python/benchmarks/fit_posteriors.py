#!/usr/bin/env python3
"""Fits of two published examples, by twinslip and by the other codes that can be imported.

Prints, in one run, the time of each, its values with their errors, and how many of these errors they are off the truth:

    python python/benchmarks/fit_posteriors.py [--draws N]

- `step`: the first example of `diabayes` (commit 4e32db9, `examples/simple_inversion.ipynb`), with its settings: a record of 1000 samples that
  begins with the step, noise of 1e-3; a, b and L are looked for.
- `levels`: the example of one state variable of `rsfmodel` (commit d04d546), with noise of 5e-4; a, b, L and the friction at V* are looked for.

The friction is made anew, by scipy at a tolerance of 1e-11, with noise of a seed of its own. A code that cannot be imported is passed over with a
sentence. MCRASTA (commit b3fcf02) is a folder of scripts: the environment variable MCRASTA says where it is; `--draws` is of each of its four
chains, of which its own example takes 200,000.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

import numpy as np
from scipy.integrate import odeint
from scipy.optimize import curve_fit

import twinslip

SEED = 42
NAMES = {"a": "direct_effect", "b": "evolution_effect", "L": "slip_length", "mu0": "reference_friction"}
Estimates = dict[str, tuple[float, float]]


@dataclass
class Example:
    """A slider of the ageing law whose load point goes from one velocity to another; lengths in micrometres."""

    name: str
    truth: dict[str, float]
    stiffness: float
    velocities: tuple[float, float]
    step: float
    time: np.ndarray
    noise: float
    looked_for: list[str]

    def friction(self, t: np.ndarray, *values: float) -> np.ndarray:
        """Without noise, in (mu, ln(V* theta/L)); V* is the velocity before the step."""
        a, b, length, level = (dict(self.truth) | dict(zip(self.looked_for, values))).values()
        slow, fast = self.velocities

        def rates(y: np.ndarray, _: float) -> list[float]:
            v = slow * np.exp((y[0] - level - b * y[1]) / a)
            return [self.stiffness * (fast - v), (slow * np.exp(-y[1]) - v) / length]

        times = np.append(self.step, t[t > self.step])
        after = odeint(rates, [level, 0.0], times, rtol=1e-11, atol=1e-12, mxstep=100_000)
        return np.concatenate([np.full(np.sum(t <= self.step), level), after[1:, 0]])

    def loaded(self) -> np.ndarray:
        """How far the load point has moved."""
        slow, fast = self.velocities
        return np.where(self.time <= self.step, slow, fast) * (self.time - self.step)

    def guess(self) -> list[float]:
        """Where searches begin that have to be told: as the example of diabayes does, and the level itself."""
        factors = {"a": 1.1, "b": 1.2, "L": 2.0, "mu0": 1.0}
        return [self.truth[name] * factors[name] for name in self.looked_for]


EXAMPLES = [
    Example("step", {"a": 0.01, "b": 0.009, "L": 10.0, "mu0": 0.6}, 1e-3, (1.0, 10.0), 0.0,
            np.linspace(0.0, 15.0, 1000), 1e-3, ["a", "b", "L"]),
    Example("levels", {"a": 0.005, "b": 0.01, "L": 10.0, "mu0": 0.6}, 1e-3, (1.0, 10.0), 10.0,
            np.arange(4001) * 0.01, 5e-4, ["a", "b", "L", "mu0"]),
]


def ours(example: Example, mu: np.ndarray, posterior: int | None = None) -> Estimates:
    """By twinslip, which looks for a start itself; with `posterior`, the mean and the deviation of so many draws."""
    slow, fast = example.velocities
    known = {} if "mu0" in example.looked_for else {"reference_friction": example.truth["mu0"]}
    slider = twinslip.System(law="ageing", reference_rate=slow * 1e-6, driving=slow * 1e-6, **known)
    record = {"time [s]": example.time, "displacement [um]": example.loaded(), "friction": mu}
    fit = slider.fit(record, program=f"{example.step}:{fast * 1e-6}", stiffness=f"{example.stiffness}/um", posterior=posterior)
    scale = {"L": 1e6}
    if posterior is None:
        found = {one: (fit[NAMES[one]].value, fit[NAMES[one]].uncertainty) for one in example.looked_for}
    else:
        drawn = {one["name"]: one for one in fit.result["posterior"]["parameters"]}
        found = {one: (drawn[NAMES[one]]["mean"], drawn[NAMES[one]]["standard_deviation"]) for one in example.looked_for}
    return {one: (x * scale.get(one, 1.0), e * scale.get(one, 1.0)) for one, (x, e) in found.items()}


def by_curve_fit(example: Example, mu: np.ndarray, friction: Callable[..., np.ndarray] | None = None) -> Estimates:
    """By scipy, around odeint or the friction of another code, told where to begin."""
    best, covariance = curve_fit(friction or example.friction, example.time, mu, p0=example.guess(), xtol=1e-10, ftol=1e-10)
    return dict(zip(example.looked_for, zip(best, np.sqrt(np.diag(covariance)))))


def by_rsfmodel(example: Example, mu: np.ndarray) -> Estimates:
    """By scipy, around rsfmodel, which has no fit of its own."""
    from rsfmodel import rsf, staterelations

    def friction(t: np.ndarray, *values: float) -> np.ndarray:
        a, b, length, level = (dict(example.truth) | dict(zip(example.looked_for, values))).values()
        slow, fast = example.velocities
        model = rsf.Model()
        model.mu0, model.a, model.k, model.v, model.vref = level, a, example.stiffness, slow, slow
        state = staterelations.DieterichState()
        state.b, state.Dc = b, length
        model.state_relations = [state]
        model.time = t
        model.loadpoint_velocity = np.where(t < example.step, slow, fast)
        model.solve()
        return np.array(model.results.friction)

    return by_curve_fit(example, mu, friction)


def by_diabayes(example: Example, mu: np.ndarray, particles: int = 0) -> Estimates:
    """By diabayes: least squares by JAX, which gives no errors; with `particles`, Stein variational inference from there, as in its example."""
    import diabayes as db
    import jax.numpy as jnp
    from diabayes.forward_models import Forward, ageing_law, rsf, springblock
    from diabayes.solver import ODESolver

    a, b, length, level = example.truth.values()
    slow, fast = (v * 1e-6 for v in example.velocities)
    forward = Forward(friction_model=rsf, state_evolution={"theta": ageing_law}, stress_transfer=springblock)
    solver = ODESolver(forward_model=forward)
    forward.set_initial_values(mu=level, theta=length * 1e-6 / slow)
    common = {
        "y0": forward.variables,
        "friction_constants": db.RSFConstants(v0=slow, mu0=level),
        "block_constants": db.SpringBlockConstants(k=example.stiffness * 1e6, v_lp=fast),
    }
    t, mu = jnp.asarray(example.time), jnp.asarray(mu)
    begun = db.RSFParams(a=1.1 * a, b=1.2 * b, Dc=2e-6 * length)
    best = solver.max_likelihood_inversion(t, mu, params=begun, **common).value
    if particles == 0:
        return {"a": (float(best.a), np.nan), "b": (float(best.b), np.nan), "L": (float(best.Dc) * 1e6, np.nan)}
    drawn = solver.bayesian_inversion(
        t, mu, noise_std=0.5 * example.noise, params=best, Nparticles=particles, Nsteps=100, rng=42, **common
    ).final_state
    mean, spread = np.mean(drawn, axis=0), np.std(drawn, axis=0)
    return {"a": (mean[0], spread[0]), "b": (mean[1], spread[1]), "L": (mean[2] * 1e6, spread[2] * 1e6)}


# What MCRASTA is run by: its likelihood, with the priors of its configuration and its sampler.
MCRASTA = """
import json, sys, time
import numpy as np, pymc as pm, pytensor.tensor as pt
from Loglikelihood import Loglike
from config import cfig
given = json.load(open("record.json"))
t, v, mu = (np.array(given[name]) for name in ("time", "velocity", "friction"))
fastest = v.max()
loglike = Loglike((t - t[0]) * fastest / cfig.lc, v / fastest, cfig.k * cfig.lc, v[0] / fastest, mu, fastest)
begun = time.perf_counter()
with pm.Model():
    a, b, mu0 = (pm.LogNormal(name, mu=m, sigma=s) for name, m, s in (("a", -5, 0.8), ("b", -5, 0.8), ("mu0", -1, 0.3)))
    length, noise = pm.Weibull("Dc", alpha=1.5, beta=40), pm.Weibull("s", alpha=1.5, beta=0.2)
    pm.Potential("likelihood", loglike(pt.as_tensor_variable([a, b, length, mu0, noise])))
    drawn = pm.sample(draws=given["draws"], tune=given["draws"], chains=4, cores=1, step=pm.Metropolis(), progressbar=False,
                      compute_convergence_checks=False, random_seed=1)
took = time.perf_counter() - begun
import arviz
table = arviz.summary(drawn, round_to="none")
rows = {name: [float(table.loc[name, one]) for one in ("mean", "sd", "ess_bulk", "r_hat")] for name in ("a", "b", "Dc", "mu0", "s")}
print(json.dumps({"seconds": took, "rows": rows}))
"""
CONFIGURATION = """
{samplename: record, section_id: 1, mintime: 0, maxtime: 1, k: %g, lc: 125, vel_windowlen: 20, filter_windowlen: 20, q: 4,
 ndr: 1, nch: 4, ntune: 1, ncores: 1, threshold: 0.13, input_data_dir: data, output_mcmc_dirname: out, %s}
"""


def by_mcrasta(example: Example, mu: np.ndarray, draws: int) -> tuple[float, Estimates, str]:
    """By MCRASTA, which takes one sample of four: the seconds that its sampler took, what it found, and how well it converged."""
    prior = "{dist_type: None, mu: None, sigma: None, alpha: None, beta: None}"
    priors = ", ".join(f"{name}_prior: {prior}" for name in ("a", "b", "Dc", "mu0", "s"))
    slow, fast = example.velocities
    thin = slice(None, None, 4)
    record = {
        "time": example.time[thin].tolist(),
        "velocity": np.where(example.time < example.step, slow, fast)[thin].tolist(),
        "friction": mu[thin].tolist(),
        "draws": draws,
    }
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "config.yaml").write_text(CONFIGURATION % (example.stiffness, priors))
        (Path(folder) / "record.json").write_text(json.dumps(record))
        known = {**os.environ, "HOME": folder, "PYTHONPATH": os.environ["MCRASTA"], "PYTHONWARNINGS": "ignore",
                 "PYTENSOR_FLAGS": "optimizer=fast_compile"}
        done = subprocess.run([sys.executable, "-c", MCRASTA], cwd=folder, env=known, capture_output=True, text=True)
    if done.returncode != 0:
        raise ImportError(done.stderr.strip().splitlines()[-1])
    found = json.loads(done.stdout.strip().splitlines()[-1])
    rows = found["rows"]
    estimates = {one: tuple(rows["Dc" if one == "L" else one][:2]) for one in example.looked_for}
    least, worst = min(row[2] for row in rows.values()), max(row[3] for row in rows.values())
    mean, spread = rows["s"][:2]
    return found["seconds"], estimates, f"effective draws {least:.0f} at least, R-hat up to {worst:.2f}; its noise s = {mean:.3g} ± {spread:.2g}"


def line(example: Example, who: str, seconds: float | list[float], found: Estimates) -> None:
    took = " then ".join(f"{one:.3g}" for one in np.atleast_1d(seconds))
    print(f"{who:32s} {took:>16s} s  " + "  ".join(told(example, one, *found[one]) for one in example.looked_for), flush=True)


def told(example: Example, name: str, value: float, error: float) -> str:
    truth = example.truth[name]
    if not np.isfinite(error):
        return f"{name} {value:.6g} ({value / truth - 1:+.1%})"
    return f"{name} {value:.6g} ± {error:.2g} ({(value - truth) / error:+.1f})"


def timed(work: Callable[[], Estimates], times: int = 1) -> tuple[list[float], Estimates]:
    """The times of the first run and, of several, the least of the others."""
    took = []
    for _ in range(times):
        begun = time.perf_counter()
        found = work()
        took.append(time.perf_counter() - begun)
    return ([took[0], min(took[1:])] if times > 1 else took), found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--draws", type=int, default=500, help="draws of each chain of MCRASTA, after as many that it discards [500]")
    draws = parser.parse_args().draws
    for example in EXAMPLES:
        noise = np.random.default_rng(SEED).standard_normal(len(example.time))
        mu = example.friction(example.time) + example.noise * noise
        print(f"\n{example.name}: {len(mu)} samples, noise {example.noise:g}; truth "
              + ", ".join(f"{name} = {example.truth[name]:g}" for name in example.looked_for)
              + " (L in um); in brackets, how many errors off the truth")
        line(example, "twinslip, fit", *timed(lambda: ours(example, mu), 3))
        line(example, "twinslip, 4000 posterior draws", *timed(lambda: ours(example, mu, 4000)))
        line(example, "curve_fit around odeint", *timed(lambda: by_curve_fit(example, mu)))
        others: list[tuple[str, Callable[[], Estimates], int]] = [
            ("curve_fit around rsfmodel", lambda: by_rsfmodel(example, mu), 1)]
        if "mu0" not in example.looked_for:
            others += [("diabayes, least squares", lambda: by_diabayes(example, mu), 2),
                       ("diabayes, 1500 particles", lambda: by_diabayes(example, mu, 1500), 1)]
        for who, work, times in others:
            try:
                line(example, who, *timed(work, times))
            except ImportError as missing:
                print(f"{who:32s} is passed over: {missing}")
        if "mu0" in example.looked_for:
            try:
                seconds, found, converged = by_mcrasta(example, mu, draws)
                line(example, f"MCRASTA, 4 x {draws} draws", seconds, found)
                print(f"{'':34s}{converged}")
            except KeyError:
                print(f"{'MCRASTA':32s} is passed over: the environment variable MCRASTA does not say where it is")
            except ImportError as missing:
                print(f"{'MCRASTA':32s} is passed over: {missing}")


if __name__ == "__main__":
    main()
