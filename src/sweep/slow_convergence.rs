//! Slow convergence: close to a bifurcation runs come nearer to what attracts them so slowly that they never arrive.
//!
//! They need not. A run that has come near an attractor, and comes nearer as fast as its eigenvalues or multipliers say, goes on
//! doing so: in the linear neighbourhood nothing else acts, and short of it what slows the approach, an unstable orbit or
//! torus around, shows as an approach that is slower than it should be.
//!
//! Farther off, such a run leaps: most of the way to the orbit that it is on its way to, from where it goes on as any other
//! (projective integration, Gear & Kevrekidis 2003). What is slow is the state of an interface that sticks, which comes to its end
//! exponentially in psi, not in ln psi: there distances are measured and leaps taken. A leap says nothing by itself. It is taken back unless the run there comes
//! nearer to the same orbit, again as fast as its multipliers say.

use super::closing::apart;
use crate::field::Vector;
use crate::integrate::{AnyField, AnyIntegrator};
use crate::section::{
    LONGEST_PERIOD, Periodic, PeriodicSearch, Return, SeriesVariables, Surface, growth,
};

/// The distance, in every component, that Newton's method may go to an orbit, from where the returns seem to end, and to an
/// equilibrium.
const NEAR: f64 = 0.05;
const FROM_END: f64 = 0.5;
const NEAR_REST: f64 = 0.3;
/// Newton's method ends at this step.
const CONVERGED: f64 = 1e-9;
const ITERATIONS: usize = 12;
/// Distances shrink, in the logarithm, by these parts of what is said.
const AS_SAID: std::ops::Range<f64> = 0.6..1.6;
/// What shrinks by less shows nothing.
const LEAST: f64 = 0.01;
/// The part of the way that a leap leaves.
const LEFT: f64 = 0.25;

/// A leap that is yet to be confirmed.
#[derive(Debug)]
pub(super) struct Leap {
    /// From where.
    pub from: Vector,
    /// The periodic point that it is to lead to.
    pub to: Periodic,
}

impl Leap {
    /// Where one lands, from a state most of the way to a point.
    pub fn landing(from: &Vector, to: &Vector, surface: &Surface) -> Vector {
        let lands = |i: usize, _| match i {
            0 => to[0] + LEFT * (from[0] - to[0]),
            // In psi, of which these are logarithms.
            _ => to[i] + (LEFT * (from[i] - to[i]).exp_m1()).ln_1p(),
        };
        surface.nearest(&Vector::from_fn(to.len(), lands))
    }

    /// Whether the returns since come to the point as they should.
    pub fn is_confirmed_by(&self, returns: &[Return]) -> bool {
        comes_as_said(SeriesVariables::LogStates, returns, &self.to)
    }

    /// Whether they have come so near that nothing else is to be asked.
    pub fn is_near(&self, returns: &[Return]) -> bool {
        let near = |last: &Return| apart(&last.state, &self.to.point) < NEAR;
        returns.last().is_some_and(near)
    }
}

/// The stable equilibrium that these returns come to.
pub(super) fn to_rest(
    field: &AnyField<'_>,
    surface: &Surface,
    returns: &[Return],
    unit: f64,
) -> Option<Vector> {
    let last = returns.last()?;
    let mut at = last.state.clone();
    for _ in 0..ITERATIONS {
        let step = field.newton_step(at.as_slice())?;
        at -= &step;
        if apart(&at, &last.state) > NEAR_REST * unit {
            return None;
        }
        if step.amax() < CONVERGED * unit {
            let (shrunk, time) = approach(surface.chart, returns, &at, 1)?;
            let said = -growth(field, at.as_slice()) * time;
            return as_said(shrunk, said).then_some(at);
        }
    }
    None
}

/// The returns of a run, good to an accuracy, and what another one is computed by.
pub(super) struct SlowReturns<'a> {
    pub field: &'a AnyField<'a>,
    pub surface: &'a Surface,
    pub taylor: &'a mut AnyIntegrator,
    pub returns: &'a [Return],
    pub accuracy: f64,
    /// What distances are measured in.
    pub unit: f64,
}

impl SlowReturns<'_> {
    /// The periodic point that they come to.
    pub fn nearby(&mut self) -> Option<Periodic> {
        let returns = self.returns;
        let n = returns.len();
        let last = &returns[n - 1].state;
        // Around a focus the returns go round; what they turn about is close to their mean.
        let late = &returns[n - n / 4..];
        let none = Vector::zeros(self.field.dimension());
        let mean = late.iter().fold(none, |sum, at| sum + &at.state) / late.len() as f64;
        let moved = |q: usize, range: std::ops::Range<usize>| {
            let of = |i: usize| apart(&returns[i].state, &returns[i - q].state);
            range.map(of).fold(0.0, f64::max)
        };
        let quarter = n / 4;
        let now = |q: usize| moved(q, n - quarter..n);
        let shrinks = |q: usize| now(q) < moved(q, n - 2 * quarter..n - quarter);
        let closest =
            (1..=LONGEST_PERIOD.min(quarter)).min_by(|&q, &r| now(q).total_cmp(&now(r)))?;
        [(&mean, 1), (last, 1), (last, closest)]
            .into_iter()
            .filter(|&(_, q)| shrinks(q))
            .find_map(|(from, q)| self.search(from.clone(), NEAR * self.unit, q))
    }

    /// The periodic point, still far, that they creep to steadily: ever slower, along a line.
    pub fn ahead(&mut self) -> Option<Periodic> {
        self.search(steady_end(self.returns)?, FROM_END * self.unit, 1)
    }

    /// The q-periodic point so near to where Newton's method begins, if they come to it as they should.
    fn search(&mut self, from: Vector, near: f64, q: usize) -> Option<Periodic> {
        let returns = self.returns;
        let asked = (self.accuracy, q);
        let mut search = PeriodicSearch::new(self.field, self.surface, self.taylor, returns, asked)
            .in_units(self.unit);
        (search.from, search.near) = (from, near);
        (search.converged, search.shrunk) = (CONVERGED * self.unit, 1.0);
        let found = search.point()?;
        comes_as_said(self.surface.chart, returns, &found).then_some(found)
    }
}

/// Where the returns seem to end, by Aitken's extrapolation of every component; `None` unless that which moves most has moved less
/// from each quarter to the next, by the same factor.
fn steady_end(returns: &[Return]) -> Option<Vector> {
    let (last, quarter) = (returns.len() - 1, returns.len() / 4);
    let at = |back: usize| &returns[last - back * quarter].state;
    // In tau and psi.
    let y = |back: usize, i: usize| match i {
        0 => at(back)[0],
        _ => at(back)[i].exp(),
    };
    let moved = |back: usize, i: usize| y(back, i) - y(back + 1, i);
    let largest = (1..at(0).len()).max_by(|&i, &j| {
        let size = |i: usize| (moved(0, i) / y(0, i)).abs();
        size(i).total_cmp(&size(j))
    })?;
    let factors = [
        moved(0, largest) / moved(1, largest),
        moved(1, largest) / moved(2, largest),
    ];
    if !factors.iter().all(|factor| (0.0..1.0).contains(factor))
        || !AS_SAID.contains(&(factors[0].ln() / factors[1].ln()))
    {
        return None;
    }
    // What else moves follows it, by the same factor.
    let rest = factors[0] / (1.0 - factors[0]);
    let end = |i: usize, _| match i {
        0 => y(0, 0),
        _ => (y(0, i) + moved(0, i) * rest).ln(),
    };
    let end = Vector::from_fn(at(0).len(), end);
    end.iter().all(|x| x.is_finite()).then_some(end)
}

/// Whether these returns come nearer to a periodic point as fast as its multiplier says.
pub(super) fn comes_as_said(chart: SeriesVariables, returns: &[Return], to: &Periodic) -> bool {
    let rounds = (returns.len() / 4) as f64 / to.returns as f64;
    let said = -to.multiplier.ln() * rounds;
    let told = approach(chart, returns, &to.point, to.returns);
    told.is_some_and(|(shrunk, _)| as_said(shrunk, said))
}

/// By how much, in the logarithm, the distance of every q-th return has shrunk from the third quarter of them to the last, and
/// the time between.
fn approach(
    chart: SeriesVariables,
    returns: &[Return],
    to: &Vector,
    q: usize,
) -> Option<(f64, f64)> {
    let n = returns.len();
    let largest = |range: std::ops::Range<usize>| {
        let phase = range.filter(|i| (n - 1 - i).is_multiple_of(q));
        phase
            .map(|i| away(chart, &returns[i].state, to))
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

/// How far from a point, by the largest of the differences; in psi by the relative ones.
fn away(chart: SeriesVariables, y: &Vector, to: &Vector) -> f64 {
    let difference = |i: usize| match chart {
        SeriesVariables::LogStates if i > 0 => (y[i] - to[i]).exp_m1(),
        _ => y[i] - to[i],
    };
    (0..y.len())
        .map(|i| difference(i).abs())
        .fold(0.0, f64::max)
}

fn as_said(shrunk: f64, said: f64) -> bool {
    shrunk > LEAST && AS_SAID.contains(&(shrunk / said))
}
