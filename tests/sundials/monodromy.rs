//! Monodromy matrices by CVODES as a user would make them: one run over the period, all tolerances, both schemes, with the
//! sensitivities in the error test and without.

use super::*;
use twinslip::equilibrium::Symmetry;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::Choice;
use twinslip::model::Loading;
use twinslip::orbit::{InitialGuess, InterfaceSystem, Orbit, OrbitAccuracy, Query, find};
use twinslip::sundials::{ErrorControl, Mode, Problem, Sensitivity, SensitivityMethod};

fn orbit(driving: f64, stiffness: f64) -> (InterfaceSystem, Orbit) {
    let slab = InterfaceSystem {
        law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
        interfaces: 2,
        loading: Loading::new(driving, stiffness).unwrap(),
    };
    let query = Query {
        symmetry: Symmetry::Asymmetric,
        begin: InitialGuess::Anywhere,
    };
    let found = find(&slab, &query, &OrbitAccuracy::of(Choice::Taylor)).unwrap();
    (slab, found.orbit)
}

/// The derivative of the state after so many cycles in its start, on the orbit where it is slowest: in the midst of slip the
/// matrix is large, and its trace a small difference.
fn monodromy(
    slab: &InterfaceSystem,
    orbit: &Orbit,
    cycles: f64,
    rtol: f64,
    settings: &Sensitivity,
) -> Jacobian<3> {
    let field = slab.whole();
    let problem = Problem::new(&*field);
    let mut cvode = cvode::<3>(MultistepMethod::Bdf, Operations::Fixed, rtol, rtol);
    let nodes = orbit.nodes.iter().map(|x| State::<3>::from_fn(|i, _| x[i]));
    let speed = |x: &State<3>| field.f(x).amax();
    let start = nodes.min_by(|a, b| speed(a).total_cmp(&speed(b))).unwrap();
    let columns: Vec<State<3>> = (0..3)
        .map(|j| State::from_fn(|i, _| f64::from(u8::from(i == j))))
        .collect();
    cvode
        .start_with_sensitivities(0.0, &start, &columns, settings)
        .unwrap();
    cvode
        .advance(&problem, cycles * orbit.period.value, Mode::Normal)
        .unwrap();
    Jacobian::from_columns(&cvode.sensitivities().unwrap())
}

#[test]
fn the_larger_multiplier_comes_with_the_tolerance_in_both_schemes() {
    // K = 0.14, V_H = 1: 0.767 and 9e-9, whose sum is the trace less the trivial one.
    let (slab, orbit) = orbit(1.0, 0.14);
    let exact = 0.767_210_343_340_776_4 + 9.259_333_9e-9;
    for scheme in [
        SensitivityMethod::Simultaneous,
        SensitivityMethod::Staggered,
    ] {
        let settings = Sensitivity {
            scheme,
            ..Sensitivity::default()
        };
        let error = |rtol| {
            let m = monodromy(&slab, &orbit, 1.0, rtol, &settings);
            (m.trace() - 1.0 - exact).abs()
        };
        for rtol in [1e-6, 1e-8, 1e-10, 1e-12] {
            let error = error(rtol);
            assert!(error < 3e4 * rtol, "{scheme:?} at {rtol:e}: {error:e}");
        }
    }
}

#[test]
fn without_error_control_twenty_cycles_are_wrong_by_orders_of_magnitude() {
    let (slab, orbit) = orbit(0.2, 0.05);
    // The multipliers are 0.60 and 2e-22: after twenty cycles only the trivial one is left of the trace.
    let trace = |error_control| {
        let settings = Sensitivity {
            scheme: SensitivityMethod::Staggered,
            error_control,
            ..Sensitivity::default()
        };
        monodromy(&slab, &orbit, 20.0, 1e-6, &settings).trace()
    };
    let on = (trace(ErrorControl::Full) - 1.0).abs();
    let off = (trace(ErrorControl::OffAndWrongWithoutWarning) - 1.0).abs();
    assert!(on < 1.0, "with it the trace is off by {on:e}");
    assert!(off > 100.0, "without it only by {off:e}");
}
