"""scipy's integrators, in ln psi, with the analytic Jacobian where one is used."""

import math

import numpy as np
import scipy
from scipy.integrate import solve_ivp

from model import Scene, answer, timed

scene = Scene()
m = scene.model
K, V_H, BETA, GAMMA0, C, P, H, Q = m.k, m.v_h, m.beta, m.gamma0, m.c, m.p, m.h, m.q


def activation(tau):
    return GAMMA0 * (math.sinh(tau) if m.odd else 0.5 * math.exp(tau))


# Scalars of the math module: several times faster than arrays of three.
def f(_, y):
    tau, w1, w2 = y.tolist()
    a, psi1, psi2 = activation(tau), math.exp(w1), math.exp(w2)
    v1, v2 = a / (C + P * psi1) ** BETA, a / (C + P * psi2) ** BETA
    return [K * (V_H - v1 - v2), H / psi1 - Q - v1, H / psi2 - Q - v2]


def jacobian(_, y):
    tau, w1, w2 = y.tolist()
    a, psi1, psi2 = activation(tau), math.exp(w1), math.exp(w2)
    s1, s2 = C + P * psi1, C + P * psi2
    v1, v2 = a / s1**BETA, a / s2**BETA
    rate = 1.0 / math.tanh(tau) if m.odd else 1.0
    d1, d2 = -v1 * BETA * P * psi1 / s1, -v2 * BETA * P * psi2 / s2
    return np.array(
        [
            [-K * rate * (v1 + v2), -K * d1, -K * d2],
            [-rate * v1, -H / psi1 - d1, 0.0],
            [-rate * v2, 0.0, -H / psi2 - d2],
        ]
    )


def ask(method, _, tolerance, repeat):
    def run():
        extra = {} if method == "DOP853" else {"jac": jacobian}
        # Only the end is kept: t_eval stores nothing else.
        return solve_ivp(
            f, (0.0, scene.until), scene.start, method, t_eval=[scene.until], rtol=tolerance, atol=tolerance, **extra
        )

    result, seconds = timed(run, repeat)
    if not result.success:
        raise RuntimeError(result.message)
    return seconds, result.nfev, result.y[:, -1]


answer(f"scipy {scipy.__version__}", ask)
