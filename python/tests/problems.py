"""Initial value problems: for SciPy, and for twinslip."""

from __future__ import annotations

import math
from typing import Any, Callable, NamedTuple

import numpy as np

from twinslip import System


class Problem(NamedTuple):
    """A system twice, with a start, a span and how SciPy solves it."""

    system: System
    #: For SciPy, without any name of twinslip in it.
    rates: Callable[[float, Any], list[float]]
    y0: list[float]
    until: float
    #: SciPy's method.
    method: str
    #: So far apart both may be, of the largest value of each variable: three to six times what SciPy is off at its tightest
    #: tolerance, and less than its runs at 1e-12 and there differ by where those are not exact to rounding.
    bound: float


def slab_rates(t: float, y: Any, driving: float = 10.0, stiffness: float = 0.14) -> list[float]:
    """Equations (19) with the law (35) and the paper's constants, in (tau, psi_1, psi_2)."""
    a, b, a_v, healing, residual = 0.0349, 0.0489, 0.369, 100.0, 1e-3
    gamma0, beta = 2.0 * math.exp(-a_v / a), b / a
    tau, *states = y
    slip = [gamma0 * math.sinh(tau) / (residual + (1.0 + healing) * psi) ** beta for psi in states]
    ageing = [(1.0 - psi) / healing - abs(v) * psi for v, psi in zip(slip, states)]
    return [stiffness * (driving - sum(slip)), *ageing]


def oscillator(x: Any, p: Any) -> Any:
    return [x[1], -(p.w**2) * x[0]]


def lotka_volterra(x: Any, p: Any) -> Any:
    prey, hunters = x
    return [p.a * prey - p.b * prey * hunters, p.d * prey * hunters - p.c * hunters]


def kepler(x: Any, p: Any) -> Any:
    cubed = (x[0] ** 2 + x[1] ** 2) ** 1.5
    return [x[2], x[3], -x[0] / cubed, -x[1] / cubed]


def pendulum(x: Any, p: Any) -> Any:
    return [x[1], -np.sin(x[0])]


def robertson(x: Any, p: Any) -> Any:
    slow, fast, back = 0.04 * x[0], 3e7 * x[1] ** 2, 1e4 * x[1] * x[2]
    return [back - slow, slow - back - fast, fast]


def stiff_relaxation(x: Any, p: Any) -> Any:
    """Towards the cosine, with a clock of its own: x = cos(t) + exp(-L t) (x_0 - 1)."""
    y, c, s = x
    return [-p.L * (y - c) - s, -s, c]


OSCILLATOR = System.from_function(oscillator, ["x", "v"], {"w": 1.0})
LOTKA_VOLTERRA = System.from_function(
    lotka_volterra, ["prey", "hunters"], {"a": 1.0, "b": 0.5, "c": 0.75, "d": 0.25}
)
KEPLER = System.from_function(kepler, ["x", "y", "u", "v"])
PENDULUM = System.from_function(pendulum, ["angle", "rate"])
ROBERTSON = System.from_function(robertson, ["x", "y", "z"])
RELAXATION = System.from_function(stiff_relaxation, ["y", "c", "s"], {"L": 1e4})
DECAY = System.from_function(lambda x, p: [-p.k * x[0]], ["x"], {"k": 0.7}, name="decay")
SLAB = System(driving=10, stiffness=0.14)
SLAB_START = [9.95, 0.002, 0.00199]


def _lorenz(t: float, y: Any) -> list[float]:
    return [10.0 * (y[1] - y[0]), y[0] * (28.0 - y[2]) - y[1], y[0] * y[1] - 8.0 / 3.0 * y[2]]


def _roessler(t: float, y: Any) -> list[float]:
    return [-y[1] - y[2], y[0] + 0.2 * y[1], 0.2 + y[2] * (y[0] - 2.5)]


def _van_der_pol(mu: float) -> Callable[[float, Any], list[float]]:
    return lambda t, y: [y[1], mu * (1.0 - y[0] ** 2) * y[1] - y[0]]


def _brusselator(t: float, y: Any) -> list[float]:
    return [1.0 - 4.0 * y[0] + y[0] ** 2 * y[1], 3.0 * y[0] - y[0] ** 2 * y[1]]


def _fitzhugh_nagumo(t: float, y: Any) -> list[float]:
    return [y[0] - y[0] ** 3 / 3.0 - y[1] + 0.5, 0.08 * (y[0] + 0.7 - 0.8 * y[1])]


def _lotka_volterra(t: float, y: Any) -> list[float]:
    return [y[0] - 0.5 * y[0] * y[1], 0.25 * y[0] * y[1] - 0.75 * y[1]]


def _kepler(t: float, y: Any) -> list[float]:
    cubed = math.hypot(y[0], y[1]) ** 3
    return [y[2], y[3], -y[0] / cubed, -y[1] / cubed]


def _robertson(t: float, y: Any) -> list[float]:
    slow, fast, back = 0.04 * y[0], 3e7 * y[1] ** 2, 1e4 * y[1] * y[2]
    return [back - slow, slow - back - fast, fast]


def _relaxation(t: float, y: Any) -> list[float]:
    return [-1e4 * (y[0] - y[1]) - y[2], -y[2], y[1]]


PROBLEMS = {
    "oscillator": Problem(
        OSCILLATOR, lambda t, y: [y[1], -y[0]], [1.0, 0.5], 20.0, "DOP853", 2e-13
    ),
    "decay": Problem(DECAY, lambda t, y: [-0.7 * y[0]], [3.0], 10.0, "DOP853", 1e-13),
    "van der Pol, 5": Problem(
        System.from_file("van-der-pol", mu=5), _van_der_pol(5.0), [2.0, 0.0], 30.0, "DOP853", 1e-12
    ),
    "van der Pol, 1000": Problem(
        System.from_file("van-der-pol", mu=1000),
        _van_der_pol(1000.0),
        [2.0, 0.0],
        1000.0,
        "Radau",
        1e-11,
    ),
    "Lorenz": Problem(System.from_file("lorenz"), _lorenz, [1.0, 1.0, 20.0], 5.0, "DOP853", 5e-12),
    "Roessler": Problem(
        System.from_file("roessler"), _roessler, [1.0, 1.0, 0.0], 50.0, "DOP853", 5e-13
    ),
    "Brusselator": Problem(
        System.from_file("brusselator"), _brusselator, [1.5, 3.0], 20.0, "DOP853", 1e-13
    ),
    "FitzHugh-Nagumo": Problem(
        System.from_file("fitzhugh-nagumo"), _fitzhugh_nagumo, [-1.0, 1.0], 100.0, "DOP853", 1e-12
    ),
    "Lotka-Volterra": Problem(LOTKA_VOLTERRA, _lotka_volterra, [2.0, 1.0], 30.0, "DOP853", 2e-13),
    "Kepler": Problem(KEPLER, _kepler, [0.4, 0.0, 0.0, 2.0], 20.0, "DOP853", 2e-11),
    "pendulum": Problem(
        PENDULUM, lambda t, y: [y[1], -math.sin(y[0])], [3.0, 0.0], 30.0, "DOP853", 2e-11
    ),
    "Robertson": Problem(ROBERTSON, _robertson, [1.0, 0.0, 0.0], 1e4, "Radau", 1e-12),
    "relaxation": Problem(RELAXATION, _relaxation, [2.0, 1.0, 0.0], 5.0, "Radau", 2e-13),
    "slab": Problem(SLAB, slab_rates, SLAB_START, 20.0, "DOP853", 5e-10),
}
