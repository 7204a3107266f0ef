//! What the rounding of the law's own parameters does: 0.0489/0.0349 is no double, and the truth is that of the decimals.

use super::{AnyLaw, Law, Parameters};

/// How much a parameter is changed to see its effect, relative.
const CHANGE: f64 = 1e-6;
/// How much the parameters may be off: b/a by two roundings and a division.
const ROUNDING: f64 = 2.0 * f64::EPSILON;

/// How much a constant may be off, relative: gamma0 = 2 exp(-a_v/a) by a_v/a times more than others.
fn rounding_of(name: &str, value: f64) -> f64 {
    match name {
        "gamma0" => ROUNDING * (1.0 + (0.5 * value).ln().abs()),
        _ => ROUNDING,
    }
}

/// The law with each of its constants changed, and how much of the change rounding makes.
fn changed(law: &AnyLaw) -> Vec<(AnyLaw, f64)> {
    let change = |(i, name): (usize, &&str)| {
        let mut other = *law;
        let constant = other.constants().into_iter().nth(i).flatten()?;
        let rounding = rounding_of(name, *constant);
        *constant *= 1.0 + CHANGE;
        Some((other, rounding / CHANGE))
    };
    let names = Parameters::NAMES.iter().enumerate();
    names.filter_map(change).collect()
}

/// What a number that depends on the law is off by the rounding of the parameters; infinite where it does not exist.
#[doc(hidden)]
pub fn rounding(law: &AnyLaw, number: impl Fn(&AnyLaw) -> Option<f64>) -> f64 {
    let [sum] = roundings(law, |law| [number(law).unwrap_or(f64::NAN)]);
    sum
}

/// The same of several numbers.
fn roundings<const N: usize>(law: &AnyLaw, numbers: impl Fn(&AnyLaw) -> [f64; N]) -> [f64; N] {
    let each = effects(law, numbers);
    std::array::from_fn(|i| {
        let sum: f64 = each.iter().map(|effect| effect[i].abs()).sum();
        if sum.is_finite() { sum } else { f64::INFINITY }
    })
}

/// What the rounding of each parameter does to the numbers, of either sign.
#[doc(hidden)]
pub fn effects<const N: usize>(
    law: &AnyLaw,
    numbers: impl Fn(&AnyLaw) -> [f64; N],
) -> Vec<[f64; N]> {
    let here = numbers(law);
    let effect = |(other, part): (AnyLaw, f64)| {
        let there = numbers(&other);
        std::array::from_fn(|i| (there[i] - here[i]) * part)
    };
    changed(law).into_iter().map(effect).collect()
}
