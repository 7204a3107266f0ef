//! The regularised direct effect tau = asinh(v h / gamma0) of (5), (6) and (35), h being the factor by which the state
//! strengthens: in logarithms where h or the whole has no double, as for a large b/a.

use crate::number::{Constant, With};
use std::ops::Range;

/// Factors and arguments with which the formula as printed, and its derivatives, stay clear of overflow and underflow.
const ORDINARY: Range<f64> = 1e-100..1e100;
/// From here on asinh(e^y) = y + ln 2 to far more digits than a double has.
const LARGE: f64 = 350.0;

/// asinh(v h / gamma0)  (5), (6), (35)
pub(super) fn stress<C: Constant, T: With<C>>(
    v: T,
    h: T,
    log_h: impl FnOnce() -> T,
    gamma0: C,
) -> T {
    let x = (v * h).over(gamma0);
    let ordinary = |x: f64| ORDINARY.contains(&x);
    let positive = v.leading() > 0.0;
    if !positive || ordinary(x.leading()) && ordinary(h.leading()) {
        return x.asinh();
    }
    let y = v.ln() + log_h() - T::of(gamma0).ln();
    if y.leading() > LARGE {
        y + T::constant(2.0).ln()
    } else {
        y.exp().asinh()
    }
}

/// ln(gamma0 sinh tau) for tau > 0.
pub(super) fn log_activation(tau: f64, gamma0: f64) -> f64 {
    tau + (0.5 * gamma0).ln() + (-(-2.0 * tau).exp_m1()).ln()
}

/// dv/dtau = sqrt[v^2 + (gamma0/h)^2].
pub(super) fn compliance<C: Constant, T: With<C>>(v: T, log_h: T, gamma0: C) -> T {
    let least = (T::of(gamma0).ln() - log_h).exp();
    let root = |large: T, small: T| {
        if large.leading() == 0.0 {
            return large;
        }
        let ratio = small / large;
        large * (ratio * ratio + 1.0).sqrt()
    };
    if least.leading() > v.leading() {
        root(least, v)
    } else {
        root(v, least)
    }
}
