//! Where the runs of a sweep start.

use super::points::RandomStart;
use super::{Grid, SweepRow, SweepSettings};
use crate::error::Result;
use crate::field::State;
use crate::friction::{AnyLaw, Formulas, beside};
use crate::model::Loading;
use crate::section::{Regime, half_driving_stress};

/// ln psi_2 - ln psi_1 of the start beside the symmetric steady state.
const BESIDE: f64 = 0.01;
/// ln psi of the symmetric start, less that of the symmetric steady state: it swings from the beginning.
const SWUNG: f64 = -1.0;
/// The far start: how much more stress, and how much less of ln psi_2, than at the symmetric steady state.
const FAR: (f64, f64) = (1.0, -4.0);
/// The same of random starts, at the least and at the most.
const RANDOM_STRESS: (f64, f64) = (-1.0, 1.5);
const RANDOM_LOG_STATE: (f64, f64) = (-5.0, 1.0);

/// A run of a sweep: of which law, where, and from which state.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SweepStart {
    pub number: usize,
    /// What its row tells of it.
    pub parameters: Vec<f64>,
    pub law: AnyLaw,
    pub loading: Loading,
    /// (tau, ln psi_1, ln psi_2)
    pub start: State<3>,
}

/// The point of that number.
///
/// # Errors
/// Those of the law at the point.
pub(super) fn point(settings: &SweepSettings, number: usize) -> Result<SweepStart> {
    let place @ [i, j] = settings.place(number);
    let stress = |law: &AnyLaw, driving: f64| half_driving_stress(law, driving, 2);
    let ((law, loading), basin) = match &settings.grid {
        Grid::Plane { driving, stiffness } => {
            let loading = Loading {
                driving: driving.value(i),
                stiffness: stiffness.value(j),
            };
            ((settings.law, loading), None)
        }
        Grid::Basin {
            loading,
            state_1,
            state_2,
        } => {
            let states = (state_1.value(i).ln(), state_2.value(j).ln());
            ((settings.law, *loading), Some(states))
        }
        Grid::Laws { at, .. } => (at.at(&settings.grid.values(place))?, None),
        Grid::Systems { .. } => unreachable!("other systems have starts of their own"),
    };
    let tau = stress(&law, loading.driving);
    let start = match basin {
        Some((first, second)) => State::<3>::new(tau, first, second),
        None => {
            let w = law.steady_state(0.5 * loading.driving).ln();
            match number % settings.starts {
                0 => State::<3>::new(tau, w, beside(&law, w, BESIDE)),
                s => {
                    let random = RandomStart::new(settings.seed, number);
                    State::<3>::from_column_slice(&start_of_interfaces(s, random, tau, &[w, w]))
                }
            }
        }
    };
    Ok(SweepStart {
        number,
        parameters: settings.grid.parameters(place),
        law,
        loading,
        start,
    })
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
pub fn start_of_interfaces(
    kind: usize,
    mut random: RandomStart,
    tau: f64,
    steady: &[f64],
) -> Vec<f64> {
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
