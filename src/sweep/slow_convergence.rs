//! Slow convergence: close to a bifurcation runs come nearer to what attracts them so slowly that they never arrive.
//!
//! They need not. A run that has come near an attractor, and comes nearer as fast as its eigenvalues or multipliers say, goes on
//! doing so: in the linear neighbourhood nothing else acts, and short of it what slows the approach, an unstable orbit or
//! torus around, shows as an approach that is slower than it should be.

use super::watch::apart;
use crate::field::Vector;
use crate::integrate::{AnyField, AnyIntegrator};
use crate::section::{
    FEWEST_RETURNS, LONGEST_PERIOD, Periodic, PeriodicSearch, Return, Surface, growth,
};

/// The distance, in every component, that Newton's method may go to an orbit, and to an equilibrium.
const NEAR: f64 = 0.05;
const NEAR_REST: f64 = 0.3;
/// Newton's method ends at this step.
const CONVERGED: f64 = 1e-9;
const ITERATIONS: usize = 12;
/// Distances shrink, in the logarithm, by these parts of what is said.
const AS_SAID: std::ops::Range<f64> = 0.6..1.6;
/// What shrinks by less shows nothing.
const LEAST: f64 = 0.01;

/// The stable equilibrium that these returns slow_convergence to.
pub(super) fn to_rest(field: &AnyField<'_>, returns: &[Return]) -> Option<Vector> {
    let last = returns.last()?;
    let mut at = last.state.clone();
    for _ in 0..ITERATIONS {
        let step = field.newton_step(at.as_slice())?;
        at -= &step;
        if apart(&at, &last.state) > NEAR_REST {
            return None;
        }
        if step.amax() < CONVERGED {
            let (shrunk, time) = approach(returns, &at, 1)?;
            let said = -growth(field, at.as_slice()) * time;
            return as_said(shrunk, said).then_some(at);
        }
    }
    None
}

/// The periodic point that these returns slow_convergence to.
pub(super) fn to_orbit(
    field: &AnyField<'_>,
    surface: &Surface,
    taylor: &mut AnyIntegrator,
    returns: &[Return],
    accuracy: f64,
) -> Option<Periodic> {
    let n = returns.len();
    if n < FEWEST_RETURNS {
        return None;
    }
    let last = &returns[n - 1].state;
    // Around a focus the returns go round; what they turn about is close to their mean.
    let late = &returns[n - n / 4..];
    let none = Vector::zeros(field.dimension());
    let mean = late.iter().fold(none, |sum, at| sum + &at.state) / late.len() as f64;
    let moved = |q: usize, range: std::ops::Range<usize>| {
        let of = |i: usize| apart(&returns[i].state, &returns[i - q].state);
        range.map(of).fold(0.0, f64::max)
    };
    let quarter = n / 4;
    let now = |q: usize| moved(q, n - quarter..n);
    let shrinks = |q: usize| now(q) < moved(q, n - 2 * quarter..n - quarter);
    let closest = (1..=LONGEST_PERIOD.min(quarter)).min_by(|&q, &r| now(q).total_cmp(&now(r)))?;
    [(&mean, 1), (last, 1), (last, closest)]
        .into_iter()
        .filter(|&(_, q)| shrinks(q))
        .find_map(|(from, q)| {
            let mut search = PeriodicSearch::new(field, surface, taylor, returns, (accuracy, q));
            (search.from, search.near, search.converged) = (from.clone(), NEAR, CONVERGED);
            search.shrunk = 1.0;
            let found = search.point()?;
            let (shrunk, _) = approach(returns, &found.point, found.returns)?;
            let rounds = (n / 4) as f64 / found.returns as f64;
            let said = -found.multiplier.ln() * rounds;
            as_said(shrunk, said).then_some(found)
        })
}

/// By how much, in the logarithm, the distance of every q-th return has shrunk from the third quarter of them to the last, and
/// the time between.
fn approach(returns: &[Return], to: &Vector, q: usize) -> Option<(f64, f64)> {
    let n = returns.len();
    let largest = |range: std::ops::Range<usize>| {
        let phase = range.filter(|i| (n - 1 - i).is_multiple_of(q));
        phase
            .map(|i| apart(&returns[i].state, to))
            .fold(0.0, f64::max)
    };
    let quarter = n / 4;
    let (before, now) = (
        largest(n - 2 * quarter..n - quarter),
        largest(n - quarter..n),
    );
    let time = returns[n - 1].time - returns.get(n - 1 - quarter)?.time;
    (now > 0.0).then(|| ((before / now).ln(), time))
}

fn as_said(shrunk: f64, said: f64) -> bool {
    shrunk > LEAST && AS_SAID.contains(&(shrunk / said))
}
