"""heyoka's Taylor integrator, in psi; compilation is left out of all times.

`taylor` is one run; `batch` as many runs in one as the vectors of this machine hold, from starts a little apart: its time is
that of one of them, its error that of the first, whose start is the scene's own.
"""

import math
from functools import cache

import heyoka as hy
import numpy as np

from model import Scene, answer, timed

scene = Scene()
m = scene.model
START = [scene.start[0], math.exp(scene.start[1]), math.exp(scene.start[2])]


def width():
    with open("/proc/cpuinfo") as file:
        return 8 if "avx512f" in file.read() else 4


BATCH = width()


def system():
    tau, psi1, psi2 = hy.make_vars("tau", "psi1", "psi2")
    a = m.gamma0 * hy.sinh(tau) if m.odd else 0.5 * m.gamma0 * hy.exp(tau)
    v1, v2 = (a / (m.c + m.p * psi) ** m.beta for psi in (psi1, psi2))
    return [
        (tau, m.k * (m.v_h - v1 - v2)),
        (psi1, m.h - (m.q + v1) * psi1),
        (psi2, m.h - (m.q + v2) * psi2),
    ]


@cache
def integrator(method, what, tolerance):
    """Compiled once: the order, and so the code, depends on the tolerance."""
    if what == "tangent":
        variational = hy.var_ode_sys(system(), hy.var_args.vars, order=1)
        return hy.taylor_adaptive(variational, START, tol=tolerance)
    if method == "batch":
        return hy.taylor_adaptive_batch(system(), np.zeros((3, BATCH)), tol=tolerance)
    return hy.taylor_adaptive(system(), START, tol=tolerance)


def outward(state):
    return [state[0], math.log(state[1]), math.log(state[2])]


def ask(method, what, tolerance, repeat):
    ta = integrator(method, what, tolerance)
    if method == "batch":
        return batch(ta, repeat)
    begin = np.array(ta.state)
    begin[:3] = START
    if what == "tangent":
        begin[3:] = np.eye(3).ravel()

    def run():
        ta.time = 0.0
        ta.state[:] = begin
        return ta.propagate_until(scene.until)

    ended, seconds = timed(run, repeat)
    if ended[0] != hy.taylor_outcome.time_limit:
        raise RuntimeError(f"heyoka ended with {ended[0]}")
    state = np.array(ta.state)
    numbers = outward(state[:3])
    if what == "tangent":
        # From d psi / d psi to d ln psi / d ln psi.
        scale_out, scale_in = np.array([1.0, *state[1:3]]), np.array([1.0, *START[1:]])
        numbers += list((state[3:].reshape(3, 3) * scale_in / scale_out[:, None]).ravel())
    return seconds, ended[3], numbers


def batch(ta, repeat):
    begin = np.array(START)[:, None] * (1.0 + 1e-3 * np.arange(BATCH) * np.array([[0.0], [1.0], [0.0]]))

    def run():
        ta.set_time(0.0)
        ta.state[:] = begin
        ta.propagate_until(scene.until)
        return ta.propagate_res

    ended, seconds = timed(run, repeat)
    if any(lane[0] != hy.taylor_outcome.time_limit for lane in ended):
        raise RuntimeError(f"heyoka ended with {ended}")
    return seconds / BATCH, ended[0][3], outward(ta.state[:, 0])


answer(f"heyoka {hy.__version__}", ask)
