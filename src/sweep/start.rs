//! Where the runs of a sweep start.

use super::points::{SectionPlace, SystemPoint};
use super::{Grid, SweepRow, SweepSettings};
use crate::error::Result;
use crate::field::Vector;
use crate::friction::{AnyLaw, Formulas, beside};
use crate::integrate::{AnyField, MotionUnits};
use crate::model::{Loading, two_interfaces};
use crate::number::polynomial::Crossing;
use crate::random::Random;
use crate::section::{Regime, Surface, half_driving_stress, usual_patience};

/// ln psi_2 - ln psi_1 of the start beside the symmetric steady state.
const BESIDE: f64 = 0.01;
/// ln psi of the symmetric start, less that of the symmetric steady state: it swings from the beginning.
const SWUNG: f64 = -1.0;
/// The far start: how much more stress, and how much less of ln psi_2, than at the symmetric steady state.
const FAR: (f64, f64) = (1.0, -4.0);
/// The same of random starts, at the least and at the most.
const RANDOM_STRESS: (f64, f64) = (-1.0, 1.5);
const RANDOM_LOG_STATE: (f64, f64) = (-5.0, 1.0);

/// Part of the usual patience: some 20 periods of stick-slip.
const PATIENCE: f64 = 0.1;

/// The point of that number.
///
/// # Errors
/// Those of the system at the point.
pub(super) fn point(settings: &SweepSettings, number: usize) -> Result<SystemPoint> {
    let place @ [i, j] = settings.place(number);
    let kind = number % settings.starts;
    let random = Random::new(settings.seed, number);
    match &settings.grid {
        Grid::Plane {
            law,
            driving,
            stiffness,
        } => {
            let loading = Loading {
                driving: driving.value(i),
                stiffness: stiffness.value(j),
            };
            Ok(equal_interfaces(*law, loading, kind, random))
        }
        Grid::Basin {
            law,
            loading,
            state_1,
            state_2,
        } => {
            let mut point = equal_interfaces(*law, *loading, kind, random);
            point.start[1] = state_1.value(i).ln();
            point.start[2] = state_2.value(j).ln();
            Ok(point)
        }
        Grid::Systems { at, .. } => at.at(&settings.grid.values(place), kind, random),
    }
}

/// Two equal interfaces, with the start of this kind: the first beside the symmetric steady state.
#[doc(hidden)]
pub fn equal_interfaces(law: AnyLaw, loading: Loading, kind: usize, random: Random) -> SystemPoint {
    let stress = half_driving_stress(&law, loading.driving, 2);
    let w = law.steady_state(0.5 * loading.driving).ln();
    let start = match kind {
        0 => vec![stress, w, beside(&law, w, BESIDE)],
        kind => start_of_interfaces(kind, random, stress, &[w, w]),
    };
    let patience = PATIENCE * usual_patience(loading.driving, loading.stiffness);
    SystemPoint {
        units: MotionUnits::given(3),
        field: AnyField::new::<3>(two_interfaces(law, loading)),
        start: Vector::from_vec(start),
        section: SectionPlace::Known(Surface::stress(3, stress, Crossing::Downwards), patience),
        equal_parts: true,
        lane: Some((law, loading)),
        enclosed: None,
    }
}

/// The row of a point that there is not.
pub(super) fn missing(settings: &SweepSettings, number: usize, why: String) -> SweepRow {
    let parameters = settings.parameters(number);
    SweepRow {
        note: Some(why),
        ..SweepRow::new(number, parameters, Vec::new(), Regime::Undecided)
    }
}

/// The start of this kind, from the second on, of interfaces with their steady stress tau and their steady ln psi: swung and alike, far,
/// or random, from the seed and the point's number alone.
#[doc(hidden)]
pub fn start_of_interfaces(kind: usize, mut random: Random, tau: f64, steady: &[f64]) -> Vec<f64> {
    let last = steady.len() - 1;
    let (stress, moved): (f64, Vec<f64>) = match kind {
        1 => (0.0, vec![SWUNG; steady.len()]),
        2 => {
            let far = |i: usize| if i == last { FAR.1 } else { 0.0 };
            (FAR.0, (0..steady.len()).map(far).collect())
        }
        _ => {
            let stress = random.between(RANDOM_STRESS);
            let states = steady.iter().map(|_| random.between(RANDOM_LOG_STATE));
            (stress, states.collect())
        }
    };
    let states = steady.iter().zip(moved).map(|(w, by)| w + by);
    std::iter::once(tau + stress).chain(states).collect()
}
