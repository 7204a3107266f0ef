//! Stress: every method far outside the scenes that anybody would ask for.
//!
//! A run either meets its tolerance, up to a factor that is stated for each method ([`trial::PROMISES`]) and relative to the
//! conditioning of the scene ([`truth`]), or it returns a typed error; never NaN, a panic, a step in the wrong direction, or
//! more work than allowed. The tests here run a part of the grid; all of it, some minutes, runs with
//!
//! ```sh
//! cargo test --test features -- stress::full --ignored --nocapture
//! ```
//!
//! which holds it to the same factors and writes `tests/stress/table.md`.

mod edges;
mod long;
mod random;
mod scene;
mod tally;
mod trial;
mod truth;

use scene::{Scene, grid};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use tally::Tally;
use trial::{Trial, methods, promised, run};

/// Every how many runs one is watched.
const WATCHED: usize = 5;

/// All methods on one scene, at these tolerances.
fn trials(i: usize, tolerances: &[f64]) -> (Vec<&'static str>, Vec<Trial>) {
    let all = tolerances
        .iter()
        .flat_map(|&tolerance| methods().into_iter().map(move |m| (m, tolerance)));
    all.enumerate()
        .map(|(j, ((name, method), tolerance))| {
            let watched = (i + j).is_multiple_of(WATCHED);
            (
                name,
                Trial {
                    method,
                    tolerance,
                    watched,
                },
            )
        })
        .unzip()
}

/// Runs and counts scenes, in two threads. `tolerances` says at which the i-th scene is run.
fn count<'a>(scenes: &[Scene], tolerances: impl Fn(usize) -> &'a [f64] + Sync) -> Tally {
    let next = AtomicUsize::new(0);
    let total = Mutex::new(Tally::default());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                let mut tally = Tally::default();
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    let Some(scene) = scenes.get(i) else { break };
                    let (names, trials) = trials(i, tolerances(i));
                    let (rule, outcomes) = run(scene, &trials);
                    tally.ends_known_by(rule);
                    for ((name, trial), outcome) in names.into_iter().zip(trials).zip(outcomes) {
                        let place = || format!("tolerance {:e}, {scene:?}", trial.tolerance);
                        tally.note(name, scene.law.name(), trial.tolerance, outcome, place);
                    }
                }
                total.lock().expect("no panic above").merge(tally);
            });
        }
    });
    total.into_inner().expect("no panic above")
}

const TOLERANCES: [f64; 6] = [1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 1e-14];

/// No fault, and answers enough: a method that refuses everything would be without a fault.
fn check(tally: &Tally) {
    for fault in tally.faults.iter().take(40) {
        println!("{fault}");
    }
    assert!(tally.faults.is_empty(), "{} faults", tally.faults.len());
    for (method, count) in tally.loose() {
        let (answered, least) = (count.answered(), promised(method).answers);
        assert!(
            answered >= least,
            "{method} answers {answered:.3} of its runs"
        );
    }
}

#[test]
fn a_part_of_the_grid_meets_its_tolerances_or_says_why_not() {
    /// Without a divisor in common with the paces of the grid.
    const STRIDE: usize = 43;
    let scenes: Vec<_> = grid().into_iter().step_by(STRIDE).collect();
    let tally = count(&scenes, |i| {
        let at = i % TOLERANCES.len();
        &TOLERANCES[at..=at]
    });
    println!("{}", tally.markdown());
    check(&tally);
}

#[test]
#[ignore = "takes minutes and writes the table"]
fn full() {
    let tally = count(&grid(), |_| &TOLERANCES);
    let text = format!(
        "# Stress\n\nWritten by `cargo test --test features -- stress::full --ignored`.\n\n{}\n## Long runs\n\n{}",
        tally.markdown(),
        long::table()
    );
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/stress/table.md");
    std::fs::write(path, text).expect("a writable folder");
    check(&tally);
}

/// From tau = -50 the stress could be loaded to -20 in one step, in which the rates grow by e^30 and none of the stages sees it.
#[test]
fn rates_that_grow_in_the_first_step_are_seen() {
    let law = twinslip::friction::AnyLaw::named("slip", parameters(0.9)).expect("known");
    let scene = Scene {
        law,
        loading: twinslip::model::Loading::new(1e-8, 10.0).expect("valid"),
        start: [-50.0, 0.0, 1e-3_f64.ln()],
        end: 3e8,
        dimension: 3,
    };
    for (method, tolerance) in [("rodas5p", 1e-3), ("rodas5p", 1e-5), ("rodas4", 1e-3)] {
        let trial = Trial {
            method: twinslip::integrate::Choice::named(method).expect("known"),
            tolerance,
            watched: false,
        };
        let (_, outcomes) = run(&scene, &[trial]);
        let trial::Outcome::Measured(factor) = outcomes[0] else {
            panic!("{outcomes:?}");
        };
        assert!(factor < promised(method).factor, "{method}: {factor}");
    }
}

fn parameters(beta: f64) -> twinslip::friction::Parameters {
    const DIRECT: f64 = 0.0349;
    let parameters = twinslip::friction::Parameters::new(DIRECT, DIRECT * beta, 0.369, 100.0, 1e-3);
    parameters.expect("valid")
}
