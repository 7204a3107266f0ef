"""Time against error from Python, beside SciPy and heyoka, and what Python adds to a run.

    python python/benchmarks/peers.py            # some ten minutes; prints markdown
    python python/benchmarks/peers.py overhead   # only what Python adds

All runs of a scene are measured in turns, and the least time of each counts: what else the machine
does meets all alike. SciPy gets rates in scalars of the math module, which is faster than arrays of
three, and exact Jacobians. heyoka is left out where it is not installed; its compilation is told
apart.
"""

from __future__ import annotations

import math
import os
import platform
import sys
import time
import warnings
from collections.abc import Callable
from typing import Any, NamedTuple, Optional

import numpy as np
import scipy
from scipy import integrate

import twinslip
from twinslip import System, _core

try:
    import heyoka
except ImportError:
    heyoka = None

#: Errors at which times are compared.
ERRORS = (1e-6, 1e-9, 1e-12)
#: Turns of a scene; the seconds of a run in each turn, and in all of them.
ROUNDS, TURN, ENOUGH = 7, 0.01, 1.0
#: Turns by which the overhead of Python is measured, and repeats in Rust in each.
TURNS, REPEATS = 30, 30

Rates = Callable[[float, Any], list[float]]
Run = Callable[[], Any]


class Scene(NamedTuple):
    """What is run."""

    name: str
    system: System
    #: For SciPy and odeint, in the states of the system.
    rates: Rates
    jacobian: Callable[[float, Any], Any]
    #: For heyoka: rates of its variables.
    formulas: Callable[[Any, list[Any]], list[Any]]
    start: list[float]
    until: float
    #: SciPy's methods that come to an end.
    methods: tuple[str, ...]
    #: The smallest of the states, for absolute tolerances.
    least: float


DIRECT, EVOLUTION, FRICTION, HEALING, RESIDUAL = 0.0349, 0.0489, 0.369, 100.0, 1e-3
GAMMA0, BETA = 2.0 * math.exp(-FRICTION / DIRECT), EVOLUTION / DIRECT
DRIVING, STIFFNESS = 10.0, 0.14


def slab_rates(t: float, y: Any) -> list[float]:
    """Two interfaces with the paper's law, in (tau, psi_1, psi_2)."""
    tau, psi1, psi2 = y.tolist()
    a = GAMMA0 * math.sinh(tau)
    v1 = a / (RESIDUAL + (1.0 + HEALING) * psi1) ** BETA
    v2 = a / (RESIDUAL + (1.0 + HEALING) * psi2) ** BETA
    return [
        STIFFNESS * (DRIVING - v1 - v2),
        (1.0 - psi1) / HEALING - v1 * psi1,
        (1.0 - psi2) / HEALING - v2 * psi2,
    ]


def slab_jacobian(t: float, y: Any) -> Any:
    tau, psi1, psi2 = y.tolist()
    a, rate = GAMMA0 * math.sinh(tau), 1.0 / math.tanh(tau)
    s1, s2 = RESIDUAL + (1.0 + HEALING) * psi1, RESIDUAL + (1.0 + HEALING) * psi2
    v1, v2 = a / s1**BETA, a / s2**BETA
    d1, d2 = -v1 * BETA * (1.0 + HEALING) / s1, -v2 * BETA * (1.0 + HEALING) / s2
    k = STIFFNESS
    return np.array(
        [
            [-k * rate * (v1 + v2), -k * d1, -k * d2],
            [-rate * v1 * psi1, -1.0 / HEALING - v1 - d1 * psi1, 0.0],
            [-rate * v2 * psi2, 0.0, -1.0 / HEALING - v2 - d2 * psi2],
        ]
    )


def slab_formulas(hy: Any, y: list[Any]) -> list[Any]:
    tau, *states = y
    a = GAMMA0 * hy.sinh(tau)
    slip = [a / (RESIDUAL + (1.0 + HEALING) * psi) ** BETA for psi in states]
    ageing = [1.0 / HEALING - (1.0 / HEALING + v) * psi for v, psi in zip(slip, states)]
    return [STIFFNESS * (DRIVING - slip[0] - slip[1]), *ageing]


def van_der_pol(mu: float, until: float, methods: tuple[str, ...]) -> Scene:
    def rates(t: float, y: Any) -> list[float]:
        x, v = y.tolist()
        return [v, mu * (1.0 - x * x) * v - x]

    def jacobian(t: float, y: Any) -> Any:
        x, v = y.tolist()
        return np.array([[0.0, 1.0], [-2.0 * mu * x * v - 1.0, mu * (1.0 - x * x)]])

    def formulas(hy: Any, y: list[Any]) -> list[Any]:
        x, v = y
        return [v, mu * (1.0 - x * x) * v - x]

    name = f"van der Pol, mu = {mu:g}, to {until:g}"
    system = System.from_file("van-der-pol", mu=mu)
    return Scene(name, system, rates, jacobian, formulas, [2.0, 0.0], until, methods, 1.0 / mu)


def lorenz_rates(t: float, y: Any) -> list[float]:
    a, b, c = y.tolist()
    return [10.0 * (b - a), a * (28.0 - c) - b, a * b - 8.0 / 3.0 * c]


def lorenz_jacobian(t: float, y: Any) -> Any:
    a, b, c = y.tolist()
    return np.array([[-10.0, 10.0, 0.0], [28.0 - c, -1.0, -a], [b, a, -8.0 / 3.0]])


def lorenz_formulas(hy: Any, y: list[Any]) -> list[Any]:
    a, b, c = y
    return [10.0 * (b - a), a * (28.0 - c) - b, a * b - 8.0 / 3.0 * c]


ALL = ("DOP853", "LSODA", "odeint", "Radau", "BDF")
SLAB = System(driving=DRIVING, stiffness=STIFFNESS)
START = [9.95, 0.002, 0.00199]
SCENES = [
    Scene("slab, 20 cycles", SLAB, slab_rates, slab_jacobian, slab_formulas, START, 65.0, ALL, 1e-6),
    van_der_pol(5.0, 60.0, ALL),
    # DOP853 takes a million steps here.
    van_der_pol(1000.0, 2000.0, ALL[1:]),
    Scene(
        "Lorenz, to 5", System.from_file("lorenz"), lorenz_rates, lorenz_jacobian, lorenz_formulas,
        [1.0, 1.0, 20.0], 5.0, ALL, 1.0,
    ),
]  # fmt: skip


# What is measured: for each method and tolerance a run that gives the end.


def ours(scene: Scene, rtol: float) -> dict[str, Run]:
    names = ["stress", "state_1", "state_2"] if scene.system is SLAB else ["x", "y", "z"]
    names = names[: len(scene.start)]

    def solved() -> Any:
        run = twinslip.solve_ivp(
            scene.system, (0.0, scene.until), scene.start, t_eval=[scene.until], rtol=rtol
        )
        return run.y[:, -1]

    def integrated() -> Any:
        run = scene.system.integrate(
            until=scene.until, start=scene.start, final_only=True, rtol=rtol, atol=rtol
        )
        return np.array([run[name][-1] for name in names])

    return {"twinslip.solve_ivp": solved, "System.integrate": integrated}


def scipys(scene: Scene, rtol: float) -> dict[str, Run]:
    atol = rtol * scene.least
    runs: dict[str, Run] = {}
    for method in scene.methods:
        if method == "odeint":
            runs["scipy odeint"] = lambda: integrate.odeint(
                scene.rates, scene.start, [0.0, scene.until], Dfun=scene.jacobian,
                tfirst=True, rtol=rtol, atol=atol, mxstep=10**8,
            )[-1]  # fmt: skip
            continue
        more = {} if method == "DOP853" else {"jac": scene.jacobian}

        def solved(method: str = method, more: dict[str, Any] = more) -> Any:
            run = integrate.solve_ivp(
                scene.rates, (0.0, scene.until), scene.start, method, rtol=rtol, atol=atol, **more
            )
            return run.y[:, -1] if run.success else np.full(len(scene.start), np.nan)

        runs[f"scipy {method}"] = solved
    return runs


def heyokas(scene: Scene, rtol: float) -> tuple[Run, float]:
    """A run, and the seconds of its compilation."""
    begin = time.perf_counter()
    variables = heyoka.make_vars(*(f"y{i}" for i in range(len(scene.start))))
    equations = list(zip(variables, scene.formulas(heyoka, list(variables))))
    ta = heyoka.taylor_adaptive(equations, scene.start, tol=rtol)
    took = time.perf_counter() - begin

    def run() -> Any:
        ta.time = 0.0
        ta.state[:] = scene.start
        ta.propagate_until(scene.until)
        return np.array(ta.state)

    return run, took


class Curve:
    """Times and errors of a method at its tolerances."""

    def __init__(self) -> None:
        self.seconds: list[float] = []
        self.errors: list[float] = []

    def at(self, error: float) -> Optional[float]:
        """The seconds to reach an error: along the line between two neighbours, both in logarithms."""
        found = [t for t, e in zip(self.seconds, self.errors) if e <= error]
        points = list(zip(self.seconds, self.errors))
        for (t0, e0), (t1, e1) in zip(points, points[1:]):
            if e0 > error >= e1 > 0.0:
                part = math.log(e0 / error) / math.log(e0 / e1)
                found.append(math.exp((1.0 - part) * math.log(t0) + part * math.log(t1)))
        return min(found, default=None)


def measured(runs: list[Run], rounds: int = ROUNDS) -> list[float]:
    """The least seconds of each, in turns; in a turn short ones are repeated, as the caches are
    another one's at first."""
    least, spent = [math.inf] * len(runs), [0.0] * len(runs)
    for _ in range(rounds):
        for i, run in enumerate(runs):
            in_turn = 0.0
            while in_turn < TURN and spent[i] < ENOUGH:
                begin = time.perf_counter()
                run()
                took = time.perf_counter() - begin
                least[i] = min(least[i], took)
                spent[i], in_turn = spent[i] + took, in_turn + took
    return least


def compared(scene: Scene) -> tuple[dict[str, Curve], str]:
    """The curves of all methods, and how well the reference is known."""
    reference = ours(scene, 1e-15)["twinslip.solve_ivp"]()
    checks = {"31 digits": _estimated(scene), "DOP853": math.nan, "heyoka": math.nan}

    def off(y: Any) -> float:
        return float(np.max(np.abs(y / reference - 1.0)))

    if "DOP853" in scene.methods:
        checks["DOP853"] = off(scipys(scene._replace(methods=("DOP853",)), 3e-14)["scipy DOP853"]())
    named: list[tuple[str, Run]] = []
    compiled = []
    for exponent in range(4, 16):
        rtol = 10.0**-exponent
        named += ours(scene, rtol).items()
        if exponent <= 13:
            named += scipys(scene, rtol).items()
        if heyoka is not None:
            run, took = heyokas(scene, rtol)
            compiled.append(took)
            named.append(("heyoka", run))
    if heyoka is not None:
        checks["heyoka"] = off(named[-1][1]())
    # Where a loose tolerance leads out of the domain of the law there is no run.
    tried = [(name, run, tried_error(run, off)) for name, run in named]
    tried = [one for one in tried if math.isfinite(one[2])]
    seconds = measured([run for _, run, _ in tried])
    curves: dict[str, Curve] = {}
    for (name, _, error), took in zip(tried, seconds):
        curve = curves.setdefault(name, Curve())
        curve.seconds.append(took)
        curve.errors.append(error)
    told = ", ".join(f"{by} {far:.0e}" for by, far in checks.items() if far == far)
    told = f"{scene.name}: the reference is off from {told}"
    if compiled:
        told += f"; heyoka compiles for up to {max(compiled):.2f} s a tolerance"
    return curves, told


def tried_error(run: Run, off: Callable[[Any], float]) -> float:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return off(run())
    except (TypeError, ValueError, OverflowError, ZeroDivisionError):
        return math.nan


def _estimated(scene: Scene) -> float:
    """The error of the reference by a run of 31 digits, as `integrate` tells it: twice the distance."""
    run = scene.system.integrate(
        until=scene.until, start=scene.start, final_only=True, method="taylor", rtol=1e-15, atol=1e-15,
        estimate_error=True, reference=True,
    )  # fmt: skip
    return float(run.final["error_estimate"])


def told(seconds: Optional[float], best: Optional[float]) -> str:
    if seconds is None:
        return "not reached"
    ratio = f" ({seconds / best:.2g})" if best else ""
    return f"{1e3 * seconds:.3g} ms{ratio}"


def table(name: str, curves: dict[str, Curve]) -> list[str]:
    """Rows of a scene; in brackets the ratio to the fastest that is not of twinslip."""
    peers = [curve for by, curve in curves.items() if by.startswith(("scipy", "heyoka"))]
    best = [
        min((t for peer in peers if (t := peer.at(e)) is not None), default=None) for e in ERRORS
    ]
    rows = []
    for by, curve in curves.items():
        cells = (told(curve.at(e), fastest) for e, fastest in zip(ERRORS, best))
        rows.append(f"| {name} | {by} | " + " | ".join(cells) + " |")
        name = ""
    return rows


def overhead() -> list[str]:
    """`System.integrate` over 20 cycles against the same command without Python."""
    kinds: dict[str, dict[str, Any]] = {
        "the end": {"final_only": True},
        "a row for each step": {},
        "2001 rows": {"points": 2001},
    }
    rows = ["| rows | from Python | the same in Rust | ratio |", "|---|---|---|---|"]
    for kind, more in kinds.items():

        def run(more: dict[str, Any] = more) -> Any:
            return SLAB.integrate(until=65.0, start=START, **more)

        words = run().command[1:]
        least = [math.inf, math.inf]
        for _ in range(TURNS):
            least[0] = min(least[0], *measured([run], 1))
            least[1] = min(least[1], _core.timed(words, REPEATS))
        python, rust = least
        rows.append(
            f"| {kind} | {1e6 * python:.0f} µs | {1e6 * rust:.0f} µs | {python / rust:.2f} |"
        )
    return rows


def main() -> None:
    # One thread for all.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    begun = os.getloadavg()[0]
    peers = f"scipy {scipy.__version__}, heyoka {heyoka.__version__ if heyoka else 'not installed'}"
    print(f"twinslip {_core.version()}, {peers}, Python {platform.python_version()}\n")
    print("\n".join(overhead()), "\n", flush=True)
    if "overhead" in sys.argv[1:]:
        return
    heads = [f"error {e:.0e}" for e in ERRORS]
    lines = ["| | | " + " | ".join(heads) + " |", "|---|---|" + "---|" * len(ERRORS)]
    notes = []
    for scene in SCENES:
        curves, note = compared(scene)
        lines += table(scene.name, curves)
        notes.append(note)
        print(f"{scene.name} is measured", file=sys.stderr)
    print("\n".join(lines), "\n")
    print("\n".join(notes))
    print(f"load of the machine: {begun:.1f} before, {os.getloadavg()[0]:.1f} after")


if __name__ == "__main__":
    main()
