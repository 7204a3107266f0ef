"""Reference equilibria of two interfaces with law (35) beside folds and pitchforks and for extreme parameters.

Writes equilibria_bounds.json: all steady states with their eigenvalues, 30 digits, once for the decimals as typed and once for
the doubles next to them (mpmath; roots of ln sinh tau_ss(V_H - s) - ln sinh tau_ss(s) by bisection of monotonic pieces, eigenvalues
as the roots of the characteristic polynomials). Run: python3 equilibria_bounds.py > equilibria_bounds.json
"""
import json
import math
from mpmath import mp, mpf, mpc, log, exp, sqrt, asinh, sign, nstr, polyroots

mp.dps = 60
DEFAULT = {"direct_effect": "0.0349", "evolution_effect": "0.0489", "reference_friction": "0.369",
           "healing_time": "100", "residual_strength": "0.001"}


class Law:
    def __init__(self, texts, doubles):
        a, b, a_v, r, c = (texts[k] for k in DEFAULT)
        if doubles:
            self.beta = mpf(float(b) / float(a))
            self.gamma0 = mpf(2.0 * math.exp(-float(a_v) / float(a)))
            self.r, self.c = mpf(float(r)), mpf(float(c))
        else:
            self.beta, self.gamma0 = mpf(b) / mpf(a), 2 * exp(-mpf(a_v) / mpf(a))
            self.r, self.c = mpf(r), mpf(c)

    def state(self, v):
        return 1 / (1 + self.r * v)

    def log_strength(self, psi):
        return self.beta * log(self.c + (1 + self.r) * psi)

    def level(self, v):  # ln(gamma0 sinh tau_ss)
        return log(v) + self.log_strength(self.state(v))

    def stress(self, v):
        return asinh(exp(self.level(v) - log(self.gamma0)))

    def steepness(self, psi):
        return self.beta * (1 + self.r) / (self.c + (1 + self.r) * psi)

    def slope(self, v):  # d level / d ln v
        psi = self.state(v)
        return 1 - self.steepness(psi) * self.r * v * psi**2

    def extrema(self):
        q = self.c / (1 + self.r)
        half = (self.beta - 1) / 2 - q
        d = half**2 - q * (1 + q)
        if half <= 0 or d <= 0:
            return []
        total = half + sqrt(d)
        return [(1 + q) / total / self.r, total / q / self.r]

    def interface(self, v):  # 1/F_V, G_psi, s, a s
        psi = self.state(v)
        g = 1 / self.r + v
        compliance = sqrt(v**2 + (self.gamma0 * exp(-self.log_strength(psi)))**2)
        return compliance, g, -g * self.slope(v), v * self.steepness(psi) * psi * compliance


def bisect(g, lo, hi):
    lo, hi = log(lo), log(hi)
    at_lo = sign(g(exp(lo)))
    for _ in range(320):
        mid = (lo + hi) / 2
        if sign(g(exp(mid))) == at_lo:
            lo = mid
        else:
            hi = mid
    return exp((lo + hi) / 2)


def asymmetric(law, v_h):
    half = v_h / 2
    cuts = sorted(s for e in law.extrema() for s in (e, v_h - e) if 0 < s < half)
    if not cuts:
        return []
    phi = lambda s: law.level(v_h - s) - law.level(s)
    phi_slope = lambda s: -(law.slope(v_h - s) * s / (v_h - s) + law.slope(s))
    cuts = [cuts[0] * mpf(10) ** -1000] + cuts + [half]
    points = []
    for lo, hi in zip(cuts, cuts[1:]):
        points.append(lo)
        grid = sorted({lo * (hi / lo) ** (mpf(j) / 300) for j in range(301)}
                      | {lo * (hi / lo) ** (mpf(2) ** -j) for j in range(1, 100)}
                      | {lo * (hi / lo) ** (1 - mpf(2) ** -j) for j in range(1, 100)})
        for a, b in zip(grid, grid[1:]):
            if phi_slope(a) * phi_slope(b) < 0:
                points.append(bisect(phi_slope, a, b))
    quotient = lambda s: phi(s) / (v_h - 2 * s)
    points.append(half * (1 - mpf(10) ** -25))
    return [bisect(quotient, a, b) for a, b in zip(points, points[1:]) if quotient(a) * quotient(b) < 0]


def roots(coefficients):
    digits, mp.dps = mp.dps, 1500
    found = polyroots([mpf(x) for x in coefficients], maxsteps=5000, extraprec=3000)
    mp.dps = digits
    return [mpc(z) for z in found]


def eigenvalues(law, rates, k):
    if rates[0] == rates[1]:
        compliance, g, s, _ = law.interface(rates[0])
        return [mpc(s)] + roots([1, 2 * k * compliance - s, 2 * k * g * compliance])
    (c_1, _, s_1, a_1), (c_2, _, s_2, a_2) = (law.interface(v) for v in rates)
    a_3 = c_1 + c_2
    return roots([1, k * a_3 - s_1 - s_2, s_1 * s_2 - k * a_3 * (s_1 + s_2) + (a_1 + a_2) * k,
                  k * (a_3 * s_1 * s_2 - a_1 * s_2 - a_2 * s_1)])


def states(texts, v_h, k, doubles):
    law = Law(texts, doubles)
    read = (lambda x: mpf(float(x))) if doubles else mpf
    v_h, k = read(v_h), read(k)
    found = []
    for slow in asymmetric(law, v_h) + [v_h / 2]:
        rates = [slow, v_h - slow]
        values = sorted(eigenvalues(law, rates, k), key=lambda z: (-z.real, -z.imag))
        found.append({
            "slip_rate": [nstr(v, 30) for v in rates],
            "state": [nstr(law.state(v), 30) for v in rates],
            "log_state": [nstr(log(law.state(v)), 30) for v in rates],
            "stress": nstr(law.stress(rates[1]), 30),
            "eigenvalues": [[nstr(z.real, 30), nstr(z.imag, 30)] for z in values],
        })
    return found


paper = Law(DEFAULT, True)
V_M, V_m = paper.extrema()
V_SN = mpf("42982.859581643406589007914236")
POINTS = [({}, repr(float(x * (1 + mpf(e)))), k)
          for x in (2 * V_M, 2 * V_m, V_SN) for e in ("-1e-5", "1e-5", "-1e-8", "1e-8", "1e-10") for k in ("0.14", "0.45")]
POINTS += [({}, repr(float(V_SN * (1 - mpf("1e-12")))), "0.14")]
POINTS += [({}, v, k) for v in ("0.12", "10", "1000") for k in ("0.14", "1e20", "1e100", "1e300", "1e306")]
POINTS += [({"evolution_effect": b}, v, "0.14") for b in ("0.5", "3", "5") for v in ("0.001", "10")]
POINTS += [({"residual_strength": c}, "10", "0.14") for c in ("1e-300", "1e-20", "0.3")]
POINTS += [({"healing_time": "1e150"}, "10", "0.14"), ({"reference_friction": "20"}, "10", "0.14")]

out = []
for changed, v_h, k in POINTS:
    texts = {**DEFAULT, **changed}
    exact, doubles = (states(texts, v_h, k, d) for d in (False, True))
    assert len(exact) == len(doubles), (changed, v_h)
    out.append({"parameters": texts, "V_H": v_h, "K": k, "decimals": exact, "doubles": doubles})
print(json.dumps({"about": "Equilibria beside folds and pitchforks and for extreme parameters; from equilibria_bounds.py",
                  "points": out}, indent=1))
