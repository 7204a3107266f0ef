"""Values, derivatives, differences and integrals of N(x)/x, by mpmath: writes ratios.json."""

import json

from mpmath import cos, cosh, exp, expm1, factorial, linspace, log1p, mp, mpf, quad, sin, sinh, tanh

mp.dps = 400
NAMES = {"ExpM1": expm1, "Sin": sin, "Sinh": sinh, "Tanh": tanh, "Ln1p": log1p}
POINTS = [0.0, 1e-30, 1e-8, 0.125, 0.328125, 0.34375, 0.5, 0.515625, 1.0, 1.5, 3.0, 8.5, 20.25, 50.0]
DERIVATIVES = 4
GAPS = [2.0**-40, 2.0**-10, 0.0625, 0.125, 2.0]


def split(x):
    high = float(x)
    return [high, float(x - mpf(high))]


def numerator_coefficients(name, x, count):
    """Those of N around x."""
    if name == "ExpM1":
        return [expm1(x)] + [exp(x) / factorial(m) for m in range(1, count)]
    if name == "Sin":
        waves = [sin(x), cos(x), -sin(x), -cos(x)]
        return [waves[m % 4] / factorial(m) for m in range(count)]
    if name == "Sinh":
        return [(sinh(x), cosh(x))[m % 2] / factorial(m) for m in range(count)]
    if name == "Ln1p":
        return [log1p(x)] + [(-1) ** (m + 1) / (m * (1 + x) ** m) for m in range(1, count)]
    # y' = 1 - y^2
    y = [tanh(x)]
    for m in range(1, count):
        squares = sum(y[j] * y[m - 1 - j] for j in range(m))
        y.append(((1 if m == 1 else 0) - squares) / m)
    return y


def coefficients(name, x, count):
    b = numerator_coefficients(name, x, count + 1)
    if x == 0:
        return b[1:]
    a = []
    for m in range(count):
        a.append((b[m] - (a[-1] if m else 0)) / x)
    return a


def value(name, x):
    return NAMES[name](x) / x if x != 0 else mpf(1)


def main():
    made = {"about": "f(x) = N(x)/x: derivatives of order 0 to 3 as sums of two doubles; f(x + gap) - f(x); integrals from -0.75 to 1.5."}
    for name in NAMES:
        points = []
        for x in sorted({s * x for x in POINTS for s in (-1.0, 1.0)}):
            if name == "Ln1p" and x <= -1.0:
                continue
            a = coefficients(name, mpf(x), DERIVATIVES)
            points.append({"x": x, "derivatives": [split(c * factorial(m)) for m, c in enumerate(a)]})
        gaps = []
        for x in (-0.5, -0.03125, 0.0, 0.25, 1.0, 6.0):
            for gap in GAPS:
                gaps.append({"x": x, "gap": gap, "difference": float(value(name, mpf(x + gap)) - value(name, mpf(x)))})
        mp.dps = 40
        ends = sorted(set(linspace(mpf(-0.75), mpf(1.5), 10) + [mpf(0)]))
        integral = quad(lambda x: value(name, x), ends)
        inverse = quad(lambda x: 1 / value(name, x), ends)
        mp.dps = 400
        made[name] = {"points": points, "gaps": gaps, "integral": float(integral), "integral of the inverse": float(inverse)}
    with open("ratios.json", "w") as file:
        json.dump(made, file, indent=1)
        file.write("\n")


if __name__ == "__main__":
    main()
