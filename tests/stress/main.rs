//! Stress: every method far outside the scenes that anybody would ask for.
#![allow(missing_docs)]

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
use trial::{Trial, methods, run};

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

#[test]
#[ignore = "minutes: writes the table"]
fn full() {
    let stride: usize = std::env::var("STRIDE").map_or(1, |s| s.parse().unwrap());
    let scenes: Vec<_> = grid().into_iter().step_by(stride).collect();
    let tally = count(&scenes, |_| &[1e-3, 1e-6, 1e-9, 1e-12, 1e-14]);
    std::fs::write("/tmp/stress-table.md", tally.markdown()).unwrap();
    for fault in tally.faults.iter().take(50) {
        println!("{fault}");
    }
    assert!(tally.faults.is_empty(), "{} faults", tally.faults.len());
}
