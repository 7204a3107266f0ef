//! The slower rate of an asymmetric state in 31 digits, and how far it may be off.
//!
//! Beside a fold or a pitchfork a state moves much farther than what moved it, so that 16 digits of Q (see `isolate`) leave few of
//! the rate. In 31 digits what is left is the rounding of the law's parameters and of V_H: the bound covers it, and holds for
//! the decimals that were typed as for the doubles next to them.

use super::isolate::quotient;
use crate::friction::{AnyLaw, Law, rounding};
use crate::number::{DoubleDouble, Jet, Real};

/// The slower rate at V_H by Newton's method from one that is nearly right; stops where the corrections no longer shrink.
pub(crate) fn refined<T: Real>(law: &impl Law, driving: f64, slow: T) -> T {
    newton(slow, 0.5 * driving, |slow| quotient(law, driving, slow))
}

/// The zero of a function near a rate, which stays below another one.
pub(super) fn newton<T: Real>(near: T, below: f64, f: impl Fn(Jet<T, 1>) -> Jet<T, 1>) -> T {
    /// From 15 digits to 30 and a spare one; from 8, as beside a fold, it takes two more.
    const STEPS: usize = 6;
    let (mut slow, mut last) = (near, f64::INFINITY);
    for _ in 0..STEPS {
        let q = f(Jet::variable(slow, 0));
        let next = slow - q.value / q.gradient[0];
        let change = (next - slow).leading().abs();
        let fits = change < 0.1 * slow.leading() && change < last && next.leading() < below;
        if !fits {
            break;
        }
        (slow, last) = (next, change);
    }
    slow
}

/// The smallest radius (by powers of two) about the slower rate within which Q changes its sign for certain, whatever the
/// rounding of V_H and of the law's parameters; infinite if there is none. Next to a pitchfork V_H/2 is the end.
pub(super) fn radius(law: &AnyLaw, driving: f64, slow: f64) -> f64 {
    let half = 0.5 * driving;
    let unknown = of_inputs(law, driving, slow);
    let sign = |s: f64| {
        let q = quotient(law, driving, DoubleDouble::from(s)).to_f64();
        (q.abs() > unknown).then(|| q.signum())
    };
    let mut radius = slow * f64::EPSILON;
    while radius < slow {
        if let Some(left) = sign(slow - radius) {
            if slow + radius >= half {
                return radius.max(half - slow);
            }
            if sign(slow + radius).is_some_and(|right| right != left) {
                return radius;
            }
        }
        radius *= 2.0;
    }
    f64::INFINITY
}

/// How far Q may be off by the rounding of V_H and of the law's parameters.
fn of_inputs(law: &AnyLaw, driving: f64, slow: f64) -> f64 {
    /// Of V_H, relative, to see its effect.
    const CHANGE: f64 = 1e-6;
    let at = |v: f64| quotient(law, v, slow);
    let of_driving = (at(driving * (1.0 + CHANGE)) - at(driving)).abs() * f64::EPSILON / CHANGE;
    of_driving + rounding(law, |law| Some(quotient(law, driving, slow)))
}
