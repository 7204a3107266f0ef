"""Reference steady states of two interfaces with law (35), for the very doubles that the program computes with.

Writes steady_states_f64.json: for driving velocities close to the pitchforks and the fold, and over nine decades, all
asymmetric solutions of (20) with 30 digits (mpmath at 80 digits; every root of tau_ss(V_H - s) - tau_ss(s) between the
extrema, by bisection of monotonic pieces). Run: python3 steady_states_f64.py > steady_states_f64.json
"""
import json
import math
from mpmath import mp, mpf, log, findroot, sqrt, nstr, asinh

mp.dps = 80
BETA, GAMMA0 = mpf(0.0489 / 0.0349), mpf(2.0 * math.exp(-0.369 / 0.0349))
R, C = mpf(100.0), mpf(1e-3)


def ln_strength(v):  # ln(sinh tau_ss) up to a constant
    return log(v) + BETA * log(C + (1 + R) / (1 + R * v))


def slope(v):
    x = 1 + R * v
    return 1 / v - BETA * R * (1 + R) / x**2 / (C + (1 + R) / x)


def extrema():
    a, b, c = C * R * R, -R * ((1 + R) * (BETA - 1) - 2 * C), 1 + R + C
    root = sqrt(b * b - 4 * a * c)
    return (-b - root) / (2 * a), (-b + root) / (2 * a)


V_M, V_m = extrema()


def bisect(g, lo, hi):
    glo = g(lo)
    for _ in range(300):
        mid = sqrt(lo * hi)
        if (g(mid) > 0) == (glo > 0):
            lo = mid
        else:
            hi = mid
    return findroot(g, (lo, hi), solver="anderson", tol=mpf(10) ** -140, verify=False)


def asymmetric(v_h):
    half = v_h / 2
    phi = lambda s: ln_strength(v_h - s) - ln_strength(s)
    phi_slope = lambda s: -(slope(v_h - s) + slope(s))
    cuts = sorted(s for s in (V_M, V_m, v_h - V_M, v_h - V_m) if 0 < s < half)
    if not cuts:
        return []
    cuts = [cuts[0] * mpf(10) ** -20] + cuts + [half]
    points = []
    for lo, hi in zip(cuts, cuts[1:]):
        grid = sorted({lo * (hi / lo) ** (mpf(j) / 400) for j in range(401)}
                      | {lo * (hi / lo) ** (mpf(2) ** -j) for j in range(1, 120)}
                      | {lo * (hi / lo) ** (1 - mpf(2) ** -j) for j in range(1, 120)})
        points.append(lo)
        for a, b in zip(grid, grid[1:]):
            if phi_slope(a) * phi_slope(b) < 0:
                points.append(bisect(phi_slope, a, b))
    quotient = lambda s: phi(s) / (v_h - 2 * s)
    points.append(half * (1 - mpf(10) ** -30))
    return [bisect(quotient, a, b) for a, b in zip(points, points[1:]) if quotient(a) * quotient(b) < 0]


def fold():
    # phi = phi' = 0 in (V_H, s), close to the maximum
    g = lambda v, s: (ln_strength(v - s) - ln_strength(s), slope(v - s) + slope(s))
    return findroot(g, (mpf("42982.85958164"), mpf("0.024931632")))


V_SN = fold()[0]
DRIVINGS = [float(x * (1 + mpf(e))) for x in (2 * V_M, 2 * V_m, V_SN) for e in ("-1e-6", "1e-6", "-1e-9", "1e-9")]
DRIVINGS += [float(V_SN * (1 + mpf(e))) for e in ("-1e-13", "-3e-13")]
DRIVINGS += [10.0 ** (k / 4) for k in range(-12, 25)]

print(json.dumps({
    "about": "All asymmetric solutions of (20) for the nearest doubles of the parameters and of V_H; from steady_states_f64.py",
    "beta": float(BETA), "gamma0": float(GAMMA0), "R": float(R), "c": float(C),
    "V_M": nstr(V_M, 30), "V_m": nstr(V_m, 30), "V_sn": nstr(V_SN, 30),
    "points": [{
        "V_H": v,
        "asymmetric": [{"V_slow": nstr(s, 30), "V_fast": nstr(mpf(v) - s, 30),
                        "tau": nstr(asinh(mpf(1) / GAMMA0 * s * (C + (1 + R) / (1 + R * s)) ** BETA), 30)}
                       for s in asymmetric(mpf(v))],
    } for v in DRIVINGS],
}, indent=1))
