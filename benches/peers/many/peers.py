"""Interfaces under one stress by scipy and heyoka: the scene of benches/many.rs.

prints method, tolerance, seconds (compilation apart), tau and ln psi of the first at the end.
"""

import sys
import time

import numpy as np

A, B, A_V, R, C = 0.0349, 0.0489, 0.369, 100.0, 1e-3
BETA, GAMMA0 = B / A, 2.0 * np.exp(-A_V / A)
UNTIL = 2.0


def scene(n):
    share = n / 10.0
    states = 0.002 * (1.0 + 1e-2 * (np.arange(n) % 97))
    return 10.0 * share, 0.14 / share, np.concatenate([[9.9], np.log(states)])


def told(method, tolerance, seconds, y, more=""):
    print(f"{method:<22} {tolerance:>6.0e} {seconds:>10.4f} {y[0]:.13g} {y[1]:.13g} {more}", flush=True)


def scipy(n):
    from scipy.integrate import solve_ivp

    driving, stiffness, start = scene(n)

    def f(_, y):
        psi = np.exp(y[1:])
        v = GAMMA0 * np.sinh(y[0]) * (C + (1 + R) * psi) ** -BETA
        return np.concatenate([[stiffness * (driving - v.sum())], (1 / psi - 1) / R - v])

    # LSODA and the implicit methods make matrices of all elements.
    methods = ["LSODA", "BDF", "Radau", "DOP853", "RK45"] if n <= 1000 else ["DOP853", "RK45"]
    for method in methods:
        for tolerance in [1e-6, 1e-8, 1e-10]:
            begin = time.perf_counter()
            end = solve_ivp(f, (0, UNTIL), start, method=method, rtol=tolerance, atol=tolerance)
            told("scipy " + method, tolerance, time.perf_counter() - begin, end.y[:, -1], end.message if end.status else "")


def heyoka(n):
    import heyoka as hy

    driving, stiffness, start = scene(n)
    tau, *logs = hy.make_vars("tau", *[f"w{i}" for i in range(n)])
    s = GAMMA0 * hy.sinh(tau)
    psis = [hy.exp(w) for w in logs]
    rates = [s * (C + (1 + R) * psi) ** -BETA for psi in psis]
    system = [(tau, stiffness * (driving - hy.sum(rates)))]
    system += [(w, (1 / psi - 1) / R - v) for w, psi, v in zip(logs, psis, rates)]
    for tolerance in [1e-6, 1e-10]:
        begin = time.perf_counter()
        ta = hy.taylor_adaptive(system, start, tol=tolerance, compact_mode=n > 20)
        compiled = time.perf_counter() - begin
        begin = time.perf_counter()
        ta.propagate_until(UNTIL)
        told("heyoka", tolerance, time.perf_counter() - begin, ta.state, f"compiled in {compiled:.1f} s")


for n in map(int, sys.argv[1:]):
    print(n, "interfaces", flush=True)
    for peer in [scipy, heyoka]:
        try:
            peer(n)
        except Exception as error:  # what can't go is told
            print(peer.__name__, "fails:", repr(error)[:200], flush=True)
