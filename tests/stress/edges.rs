//! The edges: the kink of |v|, starts at the end of the numbers, runs of no length and back in time, the last tolerance.

use super::scene::Scene;
use super::trial::{Outcome, Trial, methods, promised, run};
use super::truth::Rule;
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{MAX_STEPS, Step, Tolerances};
use twinslip::model::{Loading, two_interfaces};

fn heslot(law: &str) -> AnyLaw {
    AnyLaw::named(law, Parameters::heslot_1994()).expect("known")
}

fn scene(law: &str, (driving, stiffness): (f64, f64), start: [f64; 3], end: f64) -> Scene {
    Scene {
        law: heslot(law),
        loading: Loading::new(driving, stiffness).expect("valid"),
        start,
        end,
        dimension: 3,
    }
}

/// The outcomes of every method at this tolerance.
fn outcomes(scene: &Scene, tolerance: f64) -> (Rule, Vec<(&'static str, Outcome)>) {
    let (names, trials): (Vec<_>, Vec<_>) = methods()
        .into_iter()
        .map(|(name, method)| {
            (
                name,
                Trial {
                    method,
                    tolerance,
                    watched: true,
                },
            )
        })
        .unzip();
    let (rule, outcomes) = run(scene, &trials);
    (rule, names.into_iter().zip(outcomes).collect())
}

/// Every method meets its tolerance, measured against the reference.
fn all_meet(scene: &Scene, tolerance: f64) {
    let (rule, outcomes) = outcomes(scene, tolerance);
    assert_eq!(rule, Rule::Reference, "{scene:?}");
    for (name, outcome) in outcomes {
        let Outcome::Measured(factor) = outcome else {
            panic!("{name} at {tolerance:e}: {outcome:?}, {scene:?}");
        };
        assert!(
            factor <= promised(name).factor,
            "{name} at {tolerance:e}: {factor:e}, {scene:?}"
        );
    }
}

/// Nothing worse than a typed error; how many runs ended in a state.
fn none_breaks(scene: &Scene, tolerance: f64) -> usize {
    let mut ended = 0;
    for (name, outcome) in outcomes(scene, tolerance).1 {
        match outcome {
            Outcome::Broken(what) => panic!("{name} at {tolerance:e}: {what}, {scene:?}"),
            Outcome::Measured(factor) => {
                assert!(
                    factor <= promised(name).factor,
                    "{name}: {factor:e}, {scene:?}"
                );
                ended += 1;
            }
            Outcome::Unmeasured => ended += 1,
            Outcome::Refused(_) => {}
        }
    }
    ended
}

#[test]
fn runs_through_the_kink_of_the_slip_rate_meet_their_tolerance() {
    for law in AnyLaw::NAMES {
        for tau in [-5.0, -2.0, -0.3] {
            // The stress rises by K V_H a unit of time, and faster while the interfaces slip back.
            let crossing = (2.0 - tau) / 1.4;
            let start = [tau, 0.9_f64.ln(), 0.1_f64.ln()];
            let scene = scene(law, (10.0, 0.14), start, crossing);
            for tolerance in [1e-4, 1e-6, 1e-8] {
                all_meet(&scene, tolerance);
            }
        }
    }
}

#[test]
fn runs_back_in_time_meet_their_tolerance() {
    for law in AnyLaw::NAMES {
        let start = [8.0, 0.3_f64.ln(), 0.1_f64.ln()];
        let scene = scene(law, (1.0, 0.14), start, -0.05);
        for tolerance in [1e-4, 1e-6, 1e-8] {
            all_meet(&scene, tolerance);
        }
    }
}

#[test]
fn starts_at_the_end_of_the_numbers_end_in_a_state_or_a_typed_error() {
    // A third of them, another one each time.
    const PARTS: u64 = 3;
    let mut at = crate::common::random() % PARTS;
    let tiny = 1e-300_f64.ln();
    for law in AnyLaw::NAMES {
        for tau in [-500.0, 500.0] {
            for end in [1e-3, 1.0] {
                at += crate::common::random() % PARTS;
                for start in [[tau, tiny, tiny], [tau, tiny, -1.0], [tau, -1.0, -2.0]] {
                    at += 1;
                    if !at.is_multiple_of(PARTS) {
                        continue;
                    }
                    none_breaks(&scene(law, (1.0, 0.14), start, end), 1e-6);
                }
            }
        }
    }
}

#[test]
fn the_last_tolerance_is_met_or_refused() {
    for law in AnyLaw::NAMES {
        let start = [10.0, 0.5_f64.ln(), 0.3_f64.ln()];
        let ended = none_breaks(&scene(law, (1.0, 0.14), start, 0.5), 1e-16);
        // The Taylor method has no difficulty there.
        assert!(ended >= 1, "{law}");
    }
}

#[test]
fn a_run_of_no_length_stays_where_it_is() {
    for law in AnyLaw::NAMES {
        let field = two_interfaces(heslot(law), Loading::new(1.0, 0.14).expect("valid"));
        let start = State::<3>::new(10.0, -0.7, -3.0);
        for (name, method) in methods() {
            for t in [0.0, 1e-300, -3.0, 1e15] {
                let tolerances = Tolerances::equal(1e-8).expect("valid");
                let mut integrator = method.integrator(tolerances, MAX_STEPS).expect("valid");
                let mut see = |step: &Step<'_, 3>| panic!("{name}: a step to {}", step.t1);
                let ended = integrator.flow(&*field, (t, t), &start, Some(&mut see));
                assert_eq!(ended, Ok(start), "{name}");
                assert_eq!(integrator.work().steps, 0, "{name}");
            }
        }
    }
}
