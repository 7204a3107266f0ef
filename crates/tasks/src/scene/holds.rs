//! Holds of a run under a program: how far stress falls in each, and to which peak it rises as sliding goes on.

use super::plan::Plan;
use super::system::Described;
use super::units::Quantity;
use twinslip::fit::{Motion, Stretch, holds_of};

/// A hold of a run, in the user's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HoldOfRun {
    /// When it begins.
    pub start: f64,
    /// How long it lasts.
    pub duration: f64,
    /// The stress at its begin and its end.
    pub stress: (f64, f64),
    /// The largest stress as sliding goes on; none where it still rises as the velocity changes again or the run ends.
    pub peak: Option<f64>,
    /// What stress is to be multiplied by for the friction coefficient, where that is known.
    pub friction: Option<f64>,
}

/// Where a run has begun its stretches.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Begun(Vec<(f64, f64)>);

impl Begun {
    /// A stretch begins at a time with a stress.
    pub fn begin(&mut self, time: f64, stress: f64) {
        self.0.push((time, stress));
    }

    /// The holds that a run has come through, from all maxima of its stress.
    pub fn holds(&self, plan: &Plan, maxima: &[(f64, f64)]) -> Vec<HoldOfRun> {
        let Some(motion) = plan.motion() else {
            return Vec::new();
        };
        let at = |time: f64| {
            let here = self.0.iter().find(|(own, _)| *own == time);
            here.map(|(_, stress)| *stress)
        };
        let units = plan.system.units();
        let time = |t| units.outward(Quantity::Time, t);
        let stress = |x| units.outward(Quantity::Stress, x);
        // Dimensionless stress is that over a sigma.
        let friction = plan
            .system
            .closed_forms()
            .map(|(system, _)| system.direct_effect / stress(1.0));
        let each = holds_of(&motion)
            .into_iter()
            .filter_map(|(start, end, after)| {
                let inside = maxima.iter().filter(|(t, _)| *t > end && *t <= after);
                let peak = inside.map(|(_, x)| *x).reduce(f64::max);
                Some(HoldOfRun {
                    start: time(start),
                    duration: time(end - start),
                    stress: (stress(at(start)?), stress(at(end)?)),
                    peak: peak.map(stress),
                    friction,
                })
            });
        each.collect()
    }
}

impl Plan {
    /// How the load point moves under a program with holds; dimensionless.
    fn motion(&self) -> Option<Motion> {
        self.program.as_ref()?;
        let stretches = self.stretches().ok()?.into_iter();
        let stretches: Vec<Stretch> = stretches
            .map(|own| Stretch {
                span: own.span,
                velocity: own.driving,
            })
            .collect();
        let motion = Motion {
            before: stretches.first()?.velocity.0,
            stretches,
        };
        Some(motion).filter(|motion| !holds_of(motion).is_empty())
    }

    /// Whether the program has holds.
    pub(super) fn holds(&self) -> bool {
        self.motion().is_some()
    }
}
