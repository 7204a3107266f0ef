"""Second reference: extrapolation of the explicit midpoint rule in the multiple precision of mpmath.

Gragg's method with 2, 4, 6, ... steps, extrapolated to step 0 in powers of its square (Bulirsch and Stoer 1966; Hairer,
Norsett and Wanner, II.9). The form is that of states, not of their logarithms. Nothing but the problems and the
formulas of problems.json is shared with the first reference.
"""

from fractions import Fraction

from mpmath import mp, mpf

from problems import written

DIGITS = 50
ROWS = 16
#: Error of a step, relative to |y| and the size of a state.
TOLERANCE = mpf("1e-34")


def number(text):
    fraction = Fraction(text)
    return mpf(fraction.numerator) / fraction.denominator


def rates(form, known):
    """The rates as a function of mpmath's numbers."""
    lines = [f"    {name} = {written(formula, 'mp.', '{}')}\n" for name, formula in form.where.items()]
    # pow is what mpmath calls power
    text = f"def f(t, y):\n    {', '.join(form.states)}, = y\n{''.join(lines)}"
    text += f"    return [{', '.join(written(formula, 'mp.', '{}') for formula in form.rates)}]\n"
    scope = {"mp": mp} | known
    exec(text.replace("mp.pow(", "mp.power("), scope)  # noqa: S102
    return scope["f"]


def midpoint(f, t, y, h, count, slope):
    """Gragg's method: `count` steps over h, with his smoothing left out, as count is even."""
    small = h / count
    before, now = y, [a + small * b for a, b in zip(y, slope)]
    for i in range(1, count):
        rate = f(t + i * small, now)
        before, now = now, [a + 2 * small * b for a, b in zip(before, rate)]
    return now


def step(f, t, y, h, sizes):
    """A step, its error in units of the tolerance, and the row at which it was enough."""
    slope, table = f(t, y), []
    for row in range(1, ROWS + 1):
        new = [midpoint(f, t, y, h, 2 * row, slope)]
        for back in range(1, row):
            ratio = mpf(row) ** 2 / mpf(row - back) ** 2 - 1
            new.append([a + (a - b) / ratio for a, b in zip(new[-1], table[back - 1])])
        table = new
        if row > 8:
            off = max(abs(a - b) / (abs(c) + s) for a, b, c, s in zip(new[-1], new[-2], y, sizes)) / TOLERANCE
            if off <= 1:
                return new[-1], off, row
    return new[-1], off, ROWS


def solve(form, times):
    """(compared quantities, steps so far) at each of these times."""
    mp.dps = DIGITS
    asked = set(map(Fraction, times))
    sizes = [mpf(size) for size in form.sizes]
    y, t, h, steps = form.begin(number, mp), mpf(0), mpf("1e-3"), 0
    for stop, parameters in form.segments(times):
        f, end = rates(form, form.numbers(parameters, number, mp)), number(stop)
        while t < end:
            last = h >= end - t
            span = end - t if last else h
            try:
                new, off, row = step(f, t, y, span, sizes)
            except (ValueError, TypeError, OverflowError):
                off = None  # a trial state outside of the formulas
            if off is None or off > 1 or any(mp.im(value) != 0 for value in new):
                h = span / 3
                continue
            y, t, steps = new, end if last else t + span, steps + 1
            # Few rows: a longer step pays; many: a shorter one.
            factor = mpf(13) / row
            h = span * min(mpf("1.5"), max(mpf("0.7"), factor)) if not last else h
        h = mpf("1e-3")
        if stop in asked:
            yield form.compare(y, number, mp), steps
