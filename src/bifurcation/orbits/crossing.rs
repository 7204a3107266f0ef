//! Where branches of periodic orbits of a system without a known symmetry cross: a multiplier is 1, and the parameter does not turn.
//!
//! There the orbits of a value of the parameter are no simple solutions, and Newton's method does not find them as it finds folds. Along each branch the test function of
//! folds goes through zero as an analytic function of the parameter: it is interpolated between orbits at some distance, to both sides.

use super::branches::{ASIDE, new_corrector};
use super::chart::Chart;
use crate::bifurcation::general::FREE;
use crate::number::Uncertain;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, DirectedPoint, Goal, Regular, Switch, TangentVector,
    TestFunction,
};
use std::f64::consts::PI;

/// Where two branches cross.
#[derive(Debug, Clone)]
pub(super) struct Crossing {
    /// The coordinate of the parameter.
    pub at: Uncertain,
    /// The period.
    pub period: Uncertain,
    /// Onto the other branch.
    pub switch: Switch,
    /// Whether the orbits that leave to both sides are mirror images of each other.
    pub is_pitchfork: bool,
    /// The number of the branch that it was found on.
    pub of: usize,
    /// How often the period has doubled before it.
    pub times: usize,
    /// Whether the other branch has been followed from here or has come here.
    pub visited: bool,
}

impl Crossing {
    /// At an orbit near it, where it is not known better.
    pub fn rough(
        chart: Chart<'_>,
        near: &Regular,
        before: &DirectedPoint,
        (of, times): (usize, usize),
    ) -> Option<Self> {
        let switch = near.aside(&before.direction)?;
        let unknown = |x: f64| Uncertain::new(x, f64::INFINITY);
        Some(Crossing {
            at: unknown(near.site.at[FREE]),
            period: unknown(near.site.shooting.period()),
            is_pitchfork: is_pitchfork(chart, (&switch.0, &switch.1)),
            switch,
            of,
            times,
            visited: false,
        })
    }
}

/// An orbit of the branch at a value of the parameter.
struct Sample {
    value: f64,
    noise: f64,
    period: f64,
}

/// The samples at Chebyshev's points of an interval, as a polynomial.
struct Interpolated {
    nodes: Vec<f64>,
    samples: Vec<Sample>,
}

impl Interpolated {
    /// `None` where one of the orbits is not found.
    fn new(
        count: usize,
        (middle, reach): (f64, f64),
        sample: &mut dyn FnMut(f64) -> Option<Sample>,
    ) -> Option<Self> {
        let angle = |k: usize| PI * (k as f64 + 0.5) / count as f64;
        let nodes: Vec<f64> = (0..count)
            .map(|k| middle + reach * angle(k).cos())
            .collect();
        let samples = nodes
            .iter()
            .map(|&x| sample(x))
            .collect::<Option<Vec<_>>>()?;
        Some(Interpolated { nodes, samples })
    }

    /// By the barycentric formula (Berrut and Trefethen 2004, SIAM Rev. 46, 501-517).
    fn at(&self, x: f64, of: impl Fn(&Sample) -> f64) -> f64 {
        let count = self.nodes.len();
        let (mut above, mut below) = (0.0, 0.0);
        for (k, (node, sample)) in self.nodes.iter().zip(&self.samples).enumerate() {
            if x == *node {
                return of(sample);
            }
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let weight = sign * (PI * (k as f64 + 0.5) / count as f64).sin() / (x - node);
            above += weight * of(sample);
            below += weight;
        }
        above / below
    }

    /// The zero of the test function, and its slope there; `None` where it has the same sign at both ends.
    fn zero(&self) -> Option<(f64, f64)> {
        const BISECTIONS: usize = 60;
        let value = |x| self.at(x, |sample| sample.value);
        let (mut a, mut b) = (self.nodes[0], self.nodes[self.nodes.len() - 1]);
        let (from, to) = (a, b);
        let (at_a, at_b) = (value(a), value(b));
        if at_a * at_b >= 0.0 {
            return None;
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (a + b);
            match value(middle) * at_a > 0.0 {
                true => a = middle,
                false => b = middle,
            }
        }
        Some((0.5 * (a + b), (at_b - at_a) / (to - from)))
    }
}

/// The crossing near an orbit of a branch, on a step that begins `before`; `None` where it is not known.
pub(super) fn crossing(
    chart: Chart<'_>,
    near: &Regular,
    before: &DirectedPoint,
    (of, times): (usize, usize),
) -> Option<Crossing> {
    /// Error allowed in a step; the orbits of two interpolations, and how often the interval is halved where they differ by more than this part of it.
    const FINE: f64 = 1e-15;
    const ORBITS: [usize; 2] = [8, 6];
    const HALVINGS: usize = 6;
    const AGREED: f64 = 1e-6;
    /// What is claimed of their difference, and of the noise.
    const DEVIATIONS: f64 = 4.0;
    // At the crossing itself orbits move along both branches.
    let (from, along) = (&before.here.site, &before.direction);
    let mut fine = Corrector::new(chart.family(), FINE).ok()?;
    let middle = near.site.at[FREE];
    let mut sample = |x: f64| {
        let held = Condition::Parameter(FREE, x);
        let site = from.moved(along, (x - from.at[FREE]) / along.parameters[FREE]);
        let orbit = fine.correct(site, &[FREE], &[held], Goal::SHARP).ok()?;
        let value = TestFunction::Fold.of(&orbit.spectrum);
        let noise = fine.noise_of(TestFunction::Fold, &orbit, &[FREE], held)?;
        Some(Sample {
            value,
            noise,
            period: orbit.site.shooting.period(),
        })
    };
    let mut reach = (middle - from.at[FREE]).abs();
    for _ in 0..HALVINGS {
        let interval = (middle, reach);
        let made = ORBITS.map(|count| Interpolated::new(count, interval, &mut sample));
        reach *= 0.5;
        let [Some(more), Some(fewer)] = made else {
            continue;
        };
        let (Some((at, slope)), Some((other, _))) = (more.zero(), fewer.zero()) else {
            continue;
        };
        if (at - other).abs() > AGREED * reach {
            continue;
        }
        let noise = more.samples.iter().map(|one| one.noise).fold(0.0, f64::max);
        let off =
            DEVIATIONS * ((at - other).abs() + noise / slope.abs()) + 4.0 * f64::EPSILON * at.abs();
        let period = |one: &Interpolated, x: f64| one.at(x, |sample| sample.period);
        let (here, there) = (period(&more, at), period(&fewer, at));
        let by_place = (period(&more, at + off) - here).abs();
        let rounding = 16.0 * f64::EPSILON * here;
        let off_period = DEVIATIONS * ((here - there).abs() + by_place + rounding);
        let (site, direction) = near.aside(along)?;
        return Some(Crossing {
            at: Uncertain::new(at, off),
            period: Uncertain::new(here, off_period),
            is_pitchfork: is_pitchfork(chart, (&site, &direction)),
            switch: (site, direction),
            of,
            times,
            visited: false,
        });
    }
    None
}

/// Whether the orbits that leave to both sides are mirror images of each other: to the same side of the crossing, and of the same period where the parameter is the
/// same.
fn is_pitchfork(chart: Chart<'_>, (site, direction): (&ContinuationPoint, &TangentVector)) -> bool {
    /// In parts of what ln T changes by, and rounding.
    const SAME: f64 = 1e-3;
    const ROUNDING: f64 = 1e-9;
    let Ok(mut corrector) = new_corrector(chart.family()) else {
        return false;
    };
    let mut orbit = |site: &ContinuationPoint, condition: &Condition<'_>| {
        let found = corrector.correct(site.clone(), &[FREE], &[*condition], Goal::STEP);
        Some(found.ok()?.site)
    };
    let mut side = |sense: f64| {
        let moved = site.moved(direction, sense * ASIDE);
        orbit(&moved, &Condition::Plane(direction, &moved))
    };
    let (Some(one), Some(other)) = (side(1.0), side(-1.0)) else {
        return false;
    };
    let moved = [&one, &other].map(|orbit| orbit.at[FREE] - site.at[FREE]);
    let varies = |moved: f64| moved.abs() > ROUNDING * (1.0 + site.at[FREE].abs());
    if moved[0] * moved[1] <= 0.0 && moved.into_iter().any(varies) {
        return false;
    }
    let held = Condition::Parameter(FREE, one.at[FREE]);
    let Some(other) = orbit(&other, &held) else {
        return false;
    };
    let [begin, one, other] = [site, &one, &other].map(|orbit| orbit.shooting.period().ln());
    (one - other).abs() < SAME * (one - begin).abs() + ROUNDING
}
