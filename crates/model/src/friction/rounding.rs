//! What the rounding of the law's own parameters does: 0.0489/0.0349 is no double, and the truth is that of the decimals.

use super::{AnyLaw, Law, Parameters};

/// What is made of constants that were rounded.
#[doc(hidden)]
pub trait Rounded: Sized {
    /// The same with each constant changed, and how much of the change rounding makes.
    fn changed(&self) -> Vec<(Self, f64)>;
}

/// How much a parameter is changed to see its effect, relative.
pub(super) const CHANGE: f64 = 1e-6;
/// How much the parameters may be off: b/a by two roundings and a division.
pub(super) const ROUNDING: f64 = 2.0 * f64::EPSILON;

/// How much a constant may be off, relative: gamma0 = 2 exp(-a_v/a) by a_v/a times more than others.
fn rounding_of(name: &str, value: f64) -> f64 {
    match name {
        "gamma0" => ROUNDING * (1.0 + (0.5 * value).ln().abs()),
        _ => ROUNDING,
    }
}

impl Rounded for AnyLaw {
    fn changed(&self) -> Vec<(AnyLaw, f64)> {
        let change = |(i, name): (usize, &&str)| {
            let mut other = *self;
            let constant = other.constants().into_iter().nth(i).flatten()?;
            let rounding = rounding_of(name, *constant);
            *constant *= 1.0 + CHANGE;
            Some((other, rounding / CHANGE))
        };
        let names = Parameters::NAMES.iter().enumerate();
        names.filter_map(change).collect()
    }
}

/// What a number that depends on the law is off by the rounding of the parameters; infinite where it does not exist.
#[doc(hidden)]
pub fn rounding<R: Rounded>(law: &R, number: impl Fn(&R) -> Option<f64>) -> f64 {
    let [sum] = roundings(law, |law| [number(law).unwrap_or(f64::NAN)]);
    sum
}

/// The same of several numbers.
fn roundings<R: Rounded, const N: usize>(law: &R, numbers: impl Fn(&R) -> [f64; N]) -> [f64; N] {
    let each = effects(law, numbers);
    std::array::from_fn(|i| {
        let sum: f64 = each.iter().map(|effect| effect[i].abs()).sum();
        if sum.is_finite() { sum } else { f64::INFINITY }
    })
}

/// What the rounding of each parameter does to the numbers, of either sign.
#[doc(hidden)]
pub fn effects<R: Rounded, const N: usize>(
    law: &R,
    numbers: impl Fn(&R) -> [f64; N],
) -> Vec<[f64; N]> {
    let here = numbers(law);
    let effect = |(other, part): (R, f64)| {
        let there = numbers(&other);
        std::array::from_fn(|i| (there[i] - here[i]) * part)
    };
    law.changed().into_iter().map(effect).collect()
}
