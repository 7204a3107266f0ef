//! Along branches of interfaces in clusters: where a cluster can begin to split, which its own equations do not see.

use super::{GeneralBranch, GeneralEvent, GeneralObserver, GeneralPoint, GeneralSolution};
use crate::bifurcation::Label;
use crate::bifurcation::orbits::{Chart, orbit_point};
use crate::error::Result;
use crate::field::Vector;
use crate::number::Uncertain;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, ParametrisedField, WithinCluster,
};
use std::ops::ControlFlow;

/// What a small split of each cluster grows by at a point: ln mu on an orbit, an eigenvalue at an equilibrium. The second argument
/// says whether all digits are asked for.
pub type WithinClusters<'a> =
    &'a (dyn Fn(&GeneralPoint, bool) -> Result<Vec<WithinCluster>> + Sync);

/// The tolerance of orbits at which a cluster splits.
const SHARP: f64 = 1e-15;
/// Steps towards such a point.
const ITERATIONS: usize = 60;
/// What the period of an orbit in its last digits may be off, relatively.
const ROUNDED: f64 = 1e-13;
/// What a growth may be off zero, in units of its uncertainty.
const CLOSE: f64 = 0.05;
/// Ends that differ by less, relatively, are one.
const SAME: f64 = 1e-14;

/// Completes points and tells of those between them at which a cluster splits.
struct Splits<'s, 'a> {
    branch: &'s GeneralBranch<'a>,
    within: WithinClusters<'a>,
    last: Option<GeneralPoint>,
}

impl<'s, 'a> Splits<'s, 'a> {
    /// `None` where there are no clusters.
    fn of(branch: &'s GeneralBranch<'a>) -> Option<Self> {
        let within = branch.within?;
        Some(Splits {
            branch,
            within,
            last: None,
        })
    }

    /// Looks at what is found and hands it on.
    fn see(&mut self, event: GeneralEvent, seen: GeneralObserver<'_>) -> ControlFlow<()> {
        let mut event = event;
        let (GeneralEvent::Row(point) | GeneralEvent::Special(point)) = &mut event;
        // Without it the verdict is open.
        point.within = (self.within)(point, false).unwrap_or_else(|_| unknown());
        let point = point.clone();
        if let Some(last) = self.last.take()
            && last.number == point.number
        {
            let pairs = last.within.iter().zip(&point.within).enumerate();
            let changes = pairs.filter(|(_, (a, b))| a.ln_abs.value * b.ln_abs.value < 0.0);
            let places: Vec<usize> = changes.map(|(i, _)| i).collect();
            for i in places {
                if let Some(split) = self.between(&last, &point, i) {
                    seen(GeneralEvent::Special(split.clone()))?;
                    seen(GeneralEvent::Row(split))?;
                }
            }
        }
        self.last = Some(point);
        seen(event)
    }

    /// Where the i-th of these multipliers is 1, or eigenvalues 0, between two points: by secants that keep a bracket.
    fn between(&self, from: &GeneralPoint, to: &GeneralPoint, i: usize) -> Option<GeneralPoint> {
        let family = self.branch.system.family;
        let mut corrector = Corrector::new(family, SHARP).ok()?;
        let mut solve = |x: f64| {
            let near = if (x - from.at[0]).abs() < (x - to.at[0]).abs() {
                from
            } else {
                to
            };
            let chart = Chart::whole(&self.branch.system);
            let mut point = solution_at(chart, &mut corrector, near, [x, near.at[1]])?;
            point.within = (self.within)(&point, true).ok()?;
            Some(point)
        };
        let value = |point: &GeneralPoint| point.within[i].ln_abs.value;
        let mut low = solve(from.at[0])?;
        let mut high = solve(to.at[0])?;
        let (mut at_low, mut at_high) = (value(&low), value(&high));
        if at_low * at_high >= 0.0 {
            return None;
        }
        for _ in 0..ITERATIONS {
            let (a, b) = (low.at[0], high.at[0]);
            let x = (a * at_high - b * at_low) / (at_high - at_low);
            let next = solve(x)?;
            let Uncertain {
                value: here,
                uncertainty,
            } = next.within[i].ln_abs;
            // The side that stays counts half, so that it does not stay for ever (Illinois).
            if here * at_low < 0.0 {
                (high, at_high) = (next.clone(), here);
                at_low *= 0.5;
            } else {
                (low, at_low) = (next.clone(), here);
                at_high *= 0.5;
            }
            let (a, b) = (low.at[0], high.at[0]);
            if here.abs() <= CLOSE * uncertainty || (b - a).abs() <= SAME * (1.0 + a.abs()) {
                let slope = (value(&high) - value(&low)) / (b - a);
                let off = (here.abs() + uncertainty) / slope.abs();
                let mut split = self.split(next, off, i);
                if let [Some(first), Some(last)] = [&low, &high].map(|end| end.period) {
                    let change = (last.value - first.value) / (b - a);
                    let known = |period: Uncertain| {
                        let rounded = ROUNDED * period.value;
                        Uncertain::new(period.value, change.abs() * off + rounded)
                    };
                    split.period = split.period.map(known);
                }
                return Some(split);
            }
        }
        None
    }

    fn split(&self, at: GeneralPoint, off: f64, i: usize) -> GeneralPoint {
        let point = GeneralPoint {
            label: Some(Label::Bp),
            note: Some(format!("cluster {} splits", at.within[i].cluster)),
            ..at
        };
        point.placed(self.branch.system.family, [off, 0.0])
    }
}

/// Goes along a branch with an observer that splits are told to as well.
pub(in crate::bifurcation) fn with_splits(
    branch: &GeneralBranch<'_>,
    seen: GeneralObserver<'_>,
    along: impl FnOnce(GeneralObserver<'_>) -> Result<()>,
) -> Result<()> {
    match Splits::of(branch) {
        Some(mut splits) => along(&mut |event| splits.see(event, seen)),
        None => along(seen),
    }
}

/// The solution at these coordinates near another one.
fn solution_at(
    chart: Chart<'_>,
    corrector: &mut Corrector<'_>,
    near: &GeneralPoint,
    at: [f64; 2],
) -> Option<GeneralPoint> {
    match &near.solution {
        GeneralSolution::Orbit { shooting, .. } => {
            let site = ContinuationPoint {
                shooting: shooting.clone(),
                at,
            };
            let held = [Condition::Parameter(0, at[0])];
            let orbit = corrector.correct(site, &[0], &held, Goal::SHARP).ok()?;
            Some(orbit_point(chart, near.number, &orbit, None))
        }
        GeneralSolution::Equilibrium { state, eigenvalues } => {
            let state = equilibrium(corrector.family, at, state.clone())?;
            let eigenvalues = eigenvalues.clone();
            let solution = GeneralSolution::Equilibrium { state, eigenvalues };
            Some(GeneralPoint::new(near.number, at, solution))
        }
    }
}

/// The equilibrium near a state, by Newton's method.
fn equilibrium(family: &dyn ParametrisedField, at: [f64; 2], mut state: Vector) -> Option<Vector> {
    const STEPS: usize = 20;
    const DONE: f64 = 1e-12;
    let field = family.field(at);
    for _ in 0..STEPS {
        let step = field.jacobian(&state).lu().solve(&field.f(&state))?;
        state -= &step;
        if step.amax() <= DONE * (1.0 + state.amax()) {
            return Some(state);
        }
    }
    None
}

/// Where nothing is known.
fn unknown() -> Vec<WithinCluster> {
    vec![WithinCluster {
        cluster: 0,
        multiplicity: 1,
        ln_abs: Uncertain::new(f64::NAN, f64::INFINITY),
    }]
}
