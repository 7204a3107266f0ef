//! Which runs end on the same attractor.

use super::PointOutcome;
use super::tints::RegimeKind;
use twinslip::section::Regime;

/// Periods and stresses that agree to this, relatively, are those of one orbit: runs close in on it to far less.
const SAME: f64 = 1e-4;
/// What differs by less is the same, as of states at zero.
const ROUNDING: f64 = 1e-9;

/// Attractors with how many runs end on them, those with the most first; and the number of each run's. What is undecided is none.
///
/// Orbits and steady states are the same if regime, symmetry, period and stresses are. A torus or chaos is one attractor: the
/// stresses of a wandering run depend on how long it is watched. So two chaotic attractors are not told apart, nor are an
/// asymmetric attractor and its mirror image.
pub fn attractors(outcomes: &[PointOutcome]) -> (Vec<(PointOutcome, usize)>, Vec<Option<usize>>) {
    let mut all: Vec<(PointOutcome, usize)> = Vec::new();
    let mut of: Vec<Option<usize>> = Vec::with_capacity(outcomes.len());
    for outcome in outcomes {
        if outcome.regime == Regime::Undecided {
            of.push(None);
            continue;
        }
        let known = all.iter().position(|(other, _)| same(other, outcome));
        let at = known.unwrap_or_else(|| {
            all.push((*outcome, 0));
            all.len() - 1
        });
        all[at].1 += 1;
        of.push(Some(at));
    }
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by_key(|&at| std::cmp::Reverse(all[at].1));
    let mut rank = vec![0; all.len()];
    for (place, &at) in order.iter().enumerate() {
        rank[at] = place;
    }
    let sorted = order.iter().map(|&at| all[at]).collect();
    let of = of.into_iter().map(|at| at.map(|at| rank[at])).collect();
    (sorted, of)
}

fn same(a: &PointOutcome, b: &PointOutcome) -> bool {
    let alike = a.regime == b.regime
        && a.symmetry == b.symmetry
        && a.returns_per_period == b.returns_per_period
        && RegimeKind::of(a) == RegimeKind::of(b);
    if !alike || matches!(a.regime, Regime::Torus | Regime::Chaotic) {
        return alike;
    }
    let near = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs());
    let periods = a.period.zip(b.period);
    let stresses = a.stress_range.zip(b.stress_range);
    periods.is_none_or(|(a, b)| near(a, b))
        && stresses.is_none_or(|(a, b)| {
            // The range, not its middle, is what is large: stress may be near zero.
            let size = (a.1 - a.0).abs().max(a.0.abs()).max(a.1.abs());
            (a.0 - b.0).abs().max((a.1 - b.1).abs()) <= (SAME * size).max(ROUNDING)
        })
}
