//! Where the runs of a sweep start.

use super::{Grid, SweepSettings};
use crate::field::State;
use crate::friction::{Formulas, beside};
use crate::model::Loading;
use crate::section::half_driving_stress;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// ln psi_2 - ln psi_1 of the start beside the symmetric steady state.
const BESIDE: f64 = 0.01;
/// ln psi of the symmetric start, less that of the symmetric steady state: it swings from the beginning.
const SWUNG: f64 = -1.0;
/// The far start: how much more stress, and how much less of ln psi_2, than at the symmetric steady state.
const FAR: (f64, f64) = (1.0, -4.0);
/// The same of random starts, at the least and at the most.
const RANDOM_STRESS: (f64, f64) = (-1.0, 1.5);
const RANDOM_LOG_STATE: (f64, f64) = (-5.0, 1.0);

/// A run of a sweep: where, and from which state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SweepStart {
    pub number: usize,
    pub loading: Loading,
    /// (tau, ln psi_1, ln psi_2)
    pub start: State<3>,
}

/// The point of that number.
pub(super) fn point(settings: &SweepSettings, number: usize) -> SweepStart {
    let starts = settings.starts;
    let (k, s) = (number / starts, number % starts);
    let stress = |driving: f64| half_driving_stress(&settings.law, driving, 2);
    match &settings.grid {
        Grid::Plane { driving, stiffness } => {
            let loading = Loading {
                driving: driving.value(k % driving.count),
                stiffness: stiffness.value(k / driving.count),
            };
            let tau = stress(loading.driving);
            let w = settings.law.steady_state(0.5 * loading.driving).ln();
            let start = match s {
                0 => State::<3>::new(tau, w, beside(&settings.law, w, BESIDE)),
                1 => State::<3>::new(tau, w + SWUNG, w + SWUNG),
                2 => State::<3>::new(tau + FAR.0, w, w + FAR.1),
                _ => random(settings.seed, number, (tau, w)),
            };
            SweepStart {
                number,
                loading,
                start,
            }
        }
        Grid::Basin {
            loading,
            state_1,
            state_2,
        } => {
            let first = state_1.value(k % state_1.count).ln();
            let second = state_2.value(k / state_1.count).ln();
            SweepStart {
                number,
                loading: *loading,
                start: State::<3>::new(stress(loading.driving), first, second),
            }
        }
    }
}

/// A start around the symmetric steady state, from the seed and the point's number alone: the generator counts, and each point
/// has a stream of its own.
fn random(seed: u64, number: usize, (tau, w): (f64, f64)) -> State<3> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(number as u64);
    let mut between = |(low, high): (f64, f64)| {
        let part = (generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        low + part * (high - low)
    };
    State::<3>::new(
        tau + between(RANDOM_STRESS),
        w + between(RANDOM_LOG_STATE),
        w + between(RANDOM_LOG_STATE),
    )
}
