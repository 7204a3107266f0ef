//! What the rounding of the law's own parameters does: 0.0489/0.0349 is no double, and the truth is that of the decimals.

use crate::friction::AnyLaw;

/// How much a parameter is changed to see its effect, relative.
const CHANGE: f64 = 1e-6;
/// How much the parameters may be off: b/a by two roundings and a division.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// gamma0 = 2 exp(-a_v/a) by a_v/a times more, which is about 10.
const ROUNDING_OF_GAMMA0: f64 = 40.0 * f64::EPSILON;

/// The law with each of its parameters changed, and how much of the change rounding makes.
fn changed(law: &AnyLaw) -> Vec<(AnyLaw, f64)> {
    macro_rules! each {
        ($kind:ident, $law:expr, $($field:ident: $rounding:expr),+) => {
            vec![$({
                let mut other = *$law;
                other.$field *= 1.0 + CHANGE;
                (AnyLaw::$kind(other), $rounding / CHANGE)
            }),+]
        };
    }
    let (plain, gamma0) = (ROUNDING, ROUNDING_OF_GAMMA0);
    match law {
        AnyLaw::Spinodal(l) => each!(Spinodal, l, beta: plain, gamma0: gamma0, r: plain, c: plain),
        AnyLaw::Bounded(l) => each!(Bounded, l, beta: plain, gamma0: gamma0, r: plain),
        AnyLaw::RegularisedAgeing(l) => each!(RegularisedAgeing, l, beta: plain, gamma0: gamma0),
        AnyLaw::DieterichRuina(l) => each!(DieterichRuina, l, beta: plain, gamma0: gamma0),
        AnyLaw::Slip(l) => each!(Slip, l, beta: plain, gamma0: gamma0),
    }
}

/// What a number that depends on the law is off by the rounding of the parameters; infinite where it does not exist.
pub(super) fn rounding(law: &AnyLaw, number: impl Fn(&AnyLaw) -> Option<f64>) -> f64 {
    let Some(here) = number(law) else {
        return f64::INFINITY;
    };
    let effects = changed(law).into_iter().map(|(other, part)| {
        let there = number(&other).unwrap_or(f64::NAN);
        (there - here).abs() * part
    });
    let sum: f64 = effects.sum();
    if sum.is_finite() { sum } else { f64::INFINITY }
}
