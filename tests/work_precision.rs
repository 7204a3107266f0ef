//! How the benchmarks interpolate: what their tables say must follow from what was measured.

#[path = "../benches/common/reach.rs"]
mod reach;

use reach::{Reached, median, time_to_reach};

/// Time ~ error^(-1/4), as of a method of order 4.
const POINTS: [(f64, f64); 4] = [(1e-2, 1.0), (1e-6, 10.0), (1e-10, 100.0), (1e-14, 1000.0)];

#[test]
fn interpolation_follows_a_power_law() {
    for (error, time) in [(1e-4, 10_f64.sqrt()), (1e-6, 10.0), (1e-8, 1e3_f64.sqrt())] {
        let reached = time_to_reach(&POINTS, error).expect("reached");
        assert!(!reached.at_most && (reached.seconds / time - 1.0).abs() < 1e-12);
    }
}

#[test]
fn what_is_not_reached_has_no_time() {
    assert_eq!(time_to_reach(&POINTS, 1e-15), None);
    assert_eq!(time_to_reach(&POINTS[..2], 1e-8), None);
    assert_eq!(time_to_reach(&[], 1e-8), None);
    assert_eq!(time_to_reach(&[(f64::NAN, 1.0)], 1e-8), None);
}

#[test]
fn a_time_at_the_loosest_tolerance_is_a_bound() {
    for (error, at_most) in [(1e-2, false), (0.1, true)] {
        let seconds = 1.0;
        assert_eq!(
            time_to_reach(&POINTS, error),
            Some(Reached { seconds, at_most })
        );
    }
}

#[test]
fn points_that_another_one_beats_do_not_count() {
    let mut points = POINTS.to_vec();
    points.push((1e-5, 50.0));
    points.push((1e-1, 2.0));
    points.reverse();
    for error in [1e-3, 1e-4, 1e-8] {
        assert_eq!(
            time_to_reach(&points, error),
            time_to_reach(&POINTS, error),
            "{error}"
        );
    }
}

#[test]
fn an_exact_result_reaches_everything() {
    let reached = time_to_reach(&[(1e-8, 1.0), (0.0, 2.0)], 1e-12).expect("reached");
    assert!((1.0..2.0).contains(&reached.seconds));
}

#[test]
fn medians() {
    assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
    assert_eq!(median(vec![4.0, 1.0, 3.0, 2.0]), Some(2.0));
    assert_eq!(median(vec![]), None);
}
