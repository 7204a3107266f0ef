//! Signs and extrema of a function of which a few values are known.

/// Place and value of the extremum, inside, of the parabola through three values of one sign.
pub(super) fn vertex(s: [f64; 3], f: [f64; 3]) -> Option<(f64, f64)> {
    let one_sign = f[0] * f[1] > 0.0 && f[1] * f[2] > 0.0;
    if !one_sign {
        return None;
    }
    let left = (f[1] - f[0]) / (s[1] - s[0]);
    let right = (f[2] - f[1]) / (s[2] - s[1]);
    let curvature = (right - left) / (s[2] - s[0]);
    let slope = left + curvature * (s[1] - s[0]);
    let towards = -0.5 * slope / curvature;
    let at = s[1] + towards;
    let value = f[1] + 0.5 * slope * towards;
    let inside = at > s[0] && at < s[2] && value.is_finite() && curvature * f[1] > 0.0;
    inside.then_some((at, value))
}

/// Whether a function has a zero after one value and up to the other: one at the first belongs to what came before.
pub(super) fn crosses(a: f64, b: f64) -> bool {
    a.is_finite() && b.is_finite() && (a * b < 0.0 || (b == 0.0 && a != 0.0))
}

/// Where in the bracket to look next, as a part of it from its first end.
pub(super) fn next_fraction([a, b, c]: [f64; 3], [fa, fb, fc]: [f64; 3]) -> f64 {
    let xi = (a - b) / (c - b);
    let phi = (fa - fb) / (fc - fb);
    if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
        fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
    } else {
        0.5
    }
}
