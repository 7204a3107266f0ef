//! Periodic orbits of two interfaces that differ: in the whole space, as no symmetry leaves a part of it invariant.

use super::arc::Tracer;
use super::find::{
    FoundOrbit, Guesses, InitialGuess, ROUGH, SEARCH, completed, no_orbit_met, rough_period,
};
use super::solve::OrbitAccuracy;
use super::space::Alone;
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::friction::Formulas;
use crate::integrate::AnyField;
use crate::model::UnequalInterfaces;

/// The periodic orbit of interfaces that differ, at or near a start or as what runs from several starts settle on.
///
/// # Errors
/// [`Error::Input`] for [`InitialGuess::Hopf`]; [`Error::NoOrbit`] says what was found instead; [`Error::NotConverged`]; those of the
/// flow.
pub fn find_unequal(
    interfaces: &UnequalInterfaces,
    begin: InitialGuess,
    accuracy: &OrbitAccuracy,
) -> Result<FoundOrbit> {
    let field = AnyField::of::<3>(interfaces);
    let space = Alone {
        field: &field,
        symmetry: Symmetry::Asymmetric,
    };
    let mut tracer = Tracer::limited(ROUGH, accuracy.max_steps, SEARCH)?;
    let mut guesses = Guesses::new(&space, Symmetry::Asymmetric);
    let rough = rough_period(&interfaces.loading);
    let vector =
        |(tau, [first, second]): (f64, [f64; 2])| Vector::from_vec(vec![tau, first, second]);
    let mut whole_cycle = false;
    match begin {
        InitialGuess::At { start, period } => match period {
            Some(period) => {
                whole_cycle = true;
                guesses.over(period, &mut tracer, &vector(start))?;
            }
            None => guesses.near(rough, &mut tracer, &vector(start))?,
        },
        InitialGuess::Anywhere => {
            for start in starts(interfaces) {
                guesses.settled(rough, &mut tracer, &vector(start));
            }
        }
        InitialGuess::Hopf => {
            return Err(Error::Input(
                "`start` hopf is for equal interfaces, and these differ; give a `start` near the orbit".into(),
            ));
        }
    }
    if guesses.closed.is_empty() {
        let used_up = tracer.used_up().is_some();
        return Err(no_orbit_met(guesses, used_up));
    }
    let level = interfaces
        .laws
        .half_driving_stress(interfaces.loading.driving);
    completed(guesses, Some(level), accuracy, whole_cycle)
}

/// Starts from which runs are made: beside steady sliding at V_H/2, and far from it with either interface the stronger one.
fn starts(interfaces: &UnequalInterfaces) -> Vec<(f64, [f64; 2])> {
    let driving = interfaces.loading.driving;
    let tau = interfaces.laws.half_driving_stress(driving);
    let laws = interfaces.laws.laws();
    let [first, second] = laws.map(|law| law.steady_state(0.5 * driving).ln());
    vec![
        (tau, [first, second + 0.3]),
        (tau, [first + 0.3, second]),
        (tau + 1.0, [first, second - 4.0]),
        (tau + 1.0, [first - 4.0, second]),
    ]
}
