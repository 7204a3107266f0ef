//! KINSOL for a state in which all rates are zero, with the arrow matrix.

use super::constants::{LANES, of};
use super::field::{Arrow, ManyField};
use super::local::Stress;
use crate::error::{Error, Result};
use crate::sundials::{LargeKinsol, LinearTime, Outcome, Strategy, Until};
use rayon::prelude::*;

/// Residual, in parts of how fast each state is renewed, from which on full Newton steps converge quadratically.
const NEAR: f64 = 1e-8;
/// Line searches, each with the weights of where it begins.
const SEARCHES: usize = 20;
/// Rounds of full steps.
const ROUNDS: usize = 60;

/// A field whose zero is looked for.
struct Zero<'a>(ManyField<'a>);

impl LinearTime for Zero<'_> {
    type Matrix = Arrow;

    fn rates(&self, y: &[f64], rates: &mut [f64]) {
        self.0.rates(y, rates);
    }

    fn linearise(&self, y: &[f64], arrow: &mut Arrow) {
        self.0.linearise(y, arrow);
    }

    fn factorise(&self, diagonal: f64, arrow: &mut Arrow) -> bool {
        self.0.factorise(diagonal, arrow)
    }

    fn solve(&self, arrow: &Arrow, b: &mut [f64]) {
        self.0.solve(arrow, b);
    }

    /// One that slides a thousand times slower than others has equations a thousand times smaller: each counts by what it is made of.
    fn weights(&self, y: &[f64], weights: &mut [f64]) {
        let Zero(field) = self;
        let interfaces = field.interfaces;
        let stress = Stress::new(interfaces.kind, y[field.stress()]);
        let held = interfaces.share.held().len();
        weights.par_iter_mut().enumerate().for_each(|(i, weight)| {
            *weight = if i < held {
                let of = of(&interfaces.constants, i / LANES);
                let turnover = of.turnover(interfaces.kind, i % LANES, (stress, y[i]));
                let weight = 1.0 / turnover;
                if weight.is_finite() && weight > 0.0 {
                    weight
                } else {
                    1.0
                }
            } else {
                1.0
            };
        });
        let loading = interfaces.loading;
        weights[field.stress()] = 1.0 / (loading.stiffness * loading.driving);
    }

    fn largest(&self, own: f64) -> f64 {
        let [largest] = self.0.interfaces.share.largest([own]);
        largest
    }
}

/// Line searches to come near a zero of f from y, then full Newton steps until they no longer shrink. y, and the iterations it took.
///
/// # Errors
/// [`Error::NotConverged`], [`Error::NonFinite`], [`Error::Sundials`].
pub(super) fn zero(field: ManyField<'_>, y: Vec<f64>) -> Result<(Vec<f64>, usize)> {
    // One that is close to a fold must not send exponentials out of the range of doubles: a line search does not come back from there.
    let longest_step = (4.0 * (y.len() as f64).sqrt()).clamp(100.0, 300.0);
    let mut kinsol = LargeKinsol::new(Zero(field), y)?;
    let mut iterations = 0;
    let mut is_near = false;
    for _ in 0..SEARCHES {
        let until = Until {
            residual: NEAR,
            step: 1e-14,
            longest_step,
            iterations: 200,
        };
        let outcome = kinsol.iterate(Strategy::LineSearch, until);
        let outcome = outcome.map_err(|error| plain(error, iterations))?;
        iterations += kinsol.iterations()?;
        is_near = outcome == Outcome::GuessWasSolution;
        // after a small step what is left of the residual is rounding, or there is no zero: full steps tell
        if is_near || outcome != Outcome::Converged {
            break;
        }
    }
    let mut last = if is_near { f64::INFINITY } else { 1.0 };
    let mut before = kinsol.unknown().to_vec();
    for _ in 0..ROUNDS {
        let until = Until {
            residual: f64::MIN_POSITIVE,
            step: f64::MIN_POSITIVE,
            longest_step,
            iterations: 1,
        };
        let stepped = kinsol.iterate(Strategy::Newton, until);
        stepped.map_err(|error| plain(error, iterations))?;
        iterations += 1;
        let both = kinsol.unknown().iter().zip(&before);
        let change = both.fold(0.0, |change: f64, (y, before)| {
            change.max((y - before).abs())
        });
        before.copy_from_slice(kinsol.unknown());
        if change > 0.5 * last || change <= f64::EPSILON {
            if last <= NEAR.sqrt() || change <= f64::EPSILON {
                return Ok((before, iterations));
            }
            break;
        }
        last = change;
    }
    Err(not_converged(iterations, last))
}

fn not_converged(iterations: usize, change: f64) -> Error {
    Error::NotConverged {
        what: "KINSOL for the equilibrium of many interfaces",
        iterations,
        residual: change,
        tolerance: NEAR.sqrt(),
    }
}

/// Where rates leave the range of doubles the iteration has lost its way: there is no time to tell of.
fn plain(error: Error, iterations: usize) -> Error {
    match error {
        Error::NonFinite { .. } => not_converged(iterations, f64::INFINITY),
        error => error,
    }
}
