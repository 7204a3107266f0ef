"""Reference values of the functions of `number::DoubleDouble`, for arguments that are doubles or sums of two.

Writes double_double.json: rows [argument high, argument low, v1, v2, v3], where v1 + v2 + v3 is the value to 48 digits
(mpmath at 120 digits), so that no reader of decimals stands between; of x^p, rows begin with p.
Run: python3 double_double.py > double_double.json
"""
import json
import random
from mpmath import mp, mpf, asinh, atan, cos, cosh, exp, expm1, log, log10, log1p, sin, sinh, sqrt, tanh

mp.dps = 120
random.seed(1)
LARGEST = mpf(1.7976931348623157e308)


def parts(v):
    if abs(v) > LARGEST:
        return None
    out = []
    for _ in range(3):
        out.append(float(v))
        v -= mpf(out[-1])
    return out


def both(x):
    """x itself, and with a random second half."""
    low = x * (random.random() - 0.5) * 2.0**-53
    return [(x, 0.0), (x, low)] if x + low == x else [(x, 0.0)]


def spread(lo, hi, count):
    return [10.0 ** random.uniform(lo, hi) for _ in range(count)]


def rows(f, arguments):
    found = []
    for x in arguments:
        for hi, low in both(x):
            v = parts(f(mpf(hi) + mpf(low)))
            if v:
                found.append([hi, low] + v)
    return found


def signed(xs):
    return [s * x for x in xs for s in (1, -1)]


small = spread(-300, -1, 8) + spread(-20, 0, 10)
logarithmic = (spread(-300, 300, 15) + spread(-2, 2, 15) + [1 + s * x for s in (1, -1) for x in spread(-15.9, -1, 10)]
               + [1.0, 2.0, 0.5, 0.75, 1.5, 5e-324, 2.0**-1074 * 3, 1.7976931348623157e308])
exponential = signed(small + [random.uniform(0, 2) for _ in range(10)] + [random.uniform(0, 700) for _ in range(12)]) + [
    0.0, 1.0, -1.0, 700.0, -700.0, 709.7, 709.78, -708.0]
powers = []
for p in (1.4, -1.4, 0.5, 1 / 3, 2.0, 3.0, -7.3, 9.9, 1e-10, 1e-3, 33.0, -150.25):
    for x in spread(-300, 300, 4) + spread(-1, 1, 4) + [1 + 1e-9, 1 - 1e-5]:
        for hi, low in both(x):
            with_low = mpf(hi) + mpf(low)
            if abs(p * log(with_low)) < 650:
                powers.append([p, hi, low] + parts(with_low ** mpf(p)))

table = {
    "about": "Values of elementary functions; from double_double.py",
    "exp": rows(exp, exponential),
    "exp_m1": rows(expm1, exponential),
    "ln": rows(log, logarithmic),
    "ln_1p": rows(log1p, signed(small) + spread(0, 300, 10) + [-x for x in spread(-9, -0.3, 8)] + [-1 + 2.0**-40]),
    "sqrt": rows(sqrt, logarithmic),
    "sinh": rows(sinh, exponential),
    "cosh": rows(cosh, exponential),
    "asinh": rows(asinh, signed(small + spread(0, 300, 10) + spread(-1, 2, 10))),
    "powf": powers,
}
# After the others, which keep their random arguments.
turning = signed(small + [random.uniform(0, 10) for _ in range(20)] + spread(1, 8, 20)) + [
    0.0] + [k * 1.5707963267948966 for k in (1, 2, 3, 4, 5, 1000, 1000001, 636619770)]
table |= {
    "sin": rows(sin, turning),
    "cos": rows(cos, turning),
    "atan": rows(atan, signed(small + spread(-1, 2, 20) + spread(0, 300, 15)) + [0.0, 1.0, 1e8, 1.1e8]),
    "tanh": rows(tanh, signed(small + spread(-2, 2, 25)) + [0.0]),
    "log10": rows(log10, logarithmic),
}
print("{")
print(",\n".join(f'"{name}": ' + (json.dumps(data) if isinstance(data, str)
      else "[\n" + ",\n".join(json.dumps(row) for row in data) + "\n]") for name, data in table.items()))
print("}")
