//! Where two conditions meet on a curve of bifurcations of orbits: multipliers 1 and -1, one of these and a pair on the unit circle, or two pairs.
//!
//! Kuznetsov, Y. A. (2004). Elements of Applied Bifurcation Theory, 3rd edition, chapter 9.

use crate::bifurcation::Label;
use crate::orbit::{Regular, TestFunction};
use nalgebra::Matrix2;

/// What else may vanish along a curve of bifurcations, and the least number of variables with which it can: the product of all multipliers is positive.
pub(super) fn met_along(test_function: TestFunction) -> &'static [(TestFunction, usize)] {
    match test_function {
        TestFunction::Fold => &[(TestFunction::Doubling, 4)],
        TestFunction::Doubling => &[(TestFunction::Fold, 4)],
        TestFunction::Torus => &[
            (TestFunction::Fold, 4),
            (TestFunction::Doubling, 5),
            (TestFunction::SecondPair, 5),
        ],
        _ => &[],
    }
}

/// What an orbit of a curve is at which this other test function is zero, where the sum of the pair whose product is nearest to 1 is known: nothing where two
/// real multipliers have the product 1.
pub(super) fn codimension_two(
    own: TestFunction,
    other: TestFunction,
    (near, sum): (&Regular, f64),
) -> Option<Label> {
    /// The sums of pairs that are certainly not real, or both 1 or -1, differ from 2 or -2 by more or less than this.
    const DOUBLE: f64 = 1e-4;
    /// ln of a product that is 1.
    const ONE: f64 = 1e-6;
    let is_pair = sum.abs() < 2.0 - DOUBLE;
    let is_double = |value: f64| (sum - value).abs() < DOUBLE;
    match (own, other) {
        (TestFunction::Fold, TestFunction::Torus) if is_double(2.0) => Some(Label::R1),
        (TestFunction::Doubling, TestFunction::Torus) if is_double(-2.0) => Some(Label::R2),
        (TestFunction::Fold, TestFunction::Torus) => is_pair.then_some(Label::Fn),
        (TestFunction::Doubling, TestFunction::Torus) => is_pair.then_some(Label::Pn),
        (TestFunction::Fold, TestFunction::Doubling) => Some(Label::Ff),
        (TestFunction::Doubling, TestFunction::Fold) => is_fold(near).then_some(Label::Ff),
        (TestFunction::Torus, TestFunction::Fold) => {
            (is_pair && is_fold(near)).then_some(Label::Fn)
        }
        (TestFunction::Torus, TestFunction::Doubling) => is_pair.then_some(Label::Pn),
        (TestFunction::Torus, TestFunction::SecondPair) => {
            let off = near.spectrum.pairs_off()?;
            off.iter().all(|off| off.abs() < ONE).then_some(Label::Nn)
        }
        _ => None,
    }
}

/// Whether an orbit with the multiplier 1 is a fold: the orbits next to it then move along it without both coordinates moving. At a branch point, as a pitchfork
/// is, they do not.
fn is_fold(orbit: &Regular) -> bool {
    /// The smaller of two rates over the larger one.
    const STAYS: f64 = 1e-4;
    let [first, second] = &orbit.along[..] else {
        return false;
    };
    let (a, b) = (first.parameters, second.parameters);
    let rates = Matrix2::new(a[0], b[0], a[1], b[1]).singular_values();
    rates.min() < STAYS * rates.max()
}
