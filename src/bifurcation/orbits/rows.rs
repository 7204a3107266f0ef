//! Parameters of special points as they were given.

use crate::bifurcation::Special;
use crate::number::Uncertain;

/// V_H and K as they were given, where they were: not the exponentials of their logarithms.
pub(super) type GivenParameters = [Option<f64>; 2];

/// The number that was asked for and has this logarithm, of a range's ends and the wanted values.
pub(super) fn asked(log: f64, range: (f64, f64), wanted: &[f64]) -> Option<f64> {
    let mut all = [range.0, range.1].into_iter().chain(wanted.iter().copied());
    all.find(|x| x.ln() == log)
}

impl Special {
    pub(super) fn given(&mut self, given: GivenParameters) {
        let places = [&mut self.driving, &mut self.stiffness];
        for (place, given) in places.into_iter().zip(given) {
            if let Some(exact) = given {
                *place = Uncertain::new(exact, 0.0);
            }
        }
    }
}
