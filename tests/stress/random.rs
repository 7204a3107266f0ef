//! Random scenes. The seed is fixed, so that every run of the tests sees the same scenes; what has ever failed is kept in
//! `regressions.txt` and run first.

use super::scene::random;
use super::trial::{Outcome, Trial, methods, promised, run};
use proptest::prelude::*;
use proptest::test_runner::{Config, FileFailurePersistence, RngAlgorithm, TestRng, TestRunner};

#[test]
fn random_scenes_meet_their_tolerance_or_say_why_not() {
    let config = Config {
        cases: 20,
        max_shrink_iters: 40,
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../tests/stress/regressions.txt"
        )))),
        ..Config::default()
    };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let mut runner = TestRunner::new_with_rng(config, rng);
    let tolerance = (-14.0..-3.0_f64).prop_map(|log| 10f64.powf(log));
    let checked = runner.run(&(random(), tolerance), |(scene, tolerance)| {
        let (names, trials): (Vec<_>, Vec<_>) = methods()
            .into_iter()
            .enumerate()
            .map(|(i, (name, method))| {
                let watched = i % 2 == 0;
                (
                    name,
                    Trial {
                        method,
                        tolerance,
                        watched,
                    },
                )
            })
            .unzip();
        let (_, outcomes) = run(&scene, &trials);
        for (name, outcome) in names.into_iter().zip(outcomes) {
            match outcome {
                Outcome::Measured(factor) => {
                    prop_assert!(factor <= promised(name).factor, "{name}: factor {factor:e}");
                }
                Outcome::Broken(what) => prop_assert!(false, "{name}: {what}"),
                Outcome::Unmeasured | Outcome::Refused(_) => {}
            }
        }
        Ok(())
    });
    if let Err(failure) = checked {
        panic!("{failure}");
    }
}
