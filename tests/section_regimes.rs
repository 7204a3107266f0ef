//! Verdicts on returns: regimes of the paper's runs, rotation numbers against Floquet theory, what is never said wrongly.

use crate::command;
use crate::common::sections::{Case, mean, orbit_beyond_hopf};
use std::f64::consts::TAU;
use twinslip::field::Vector;
use twinslip::section::{Ended, Regime, ReturnRecord, verdict};

/// K = 0.2, V_H = 0.102, the paper's Fig. 13: an invariant circle around the orbit that has lost its stability. Where it is
/// born the rotation number is the angle of the multipliers over 2 pi; it departs from that as the square of the circle's
/// radius, which is as the distance in V_H.
#[test]
fn the_torus_turns_as_floquet_theory_says() {
    let settled = |v: f64, skip: usize| {
        let case = Case::paper(0.2, v);
        let record = case.record("auto", 1e-11, case.near_symmetric(0.3), (skip, 1000));
        let made = case.verdict(&record);
        assert_eq!(made.regime, Regime::Torus, "{v}: {made:?}");
        let rotation = made.curve.unwrap().rotation;
        assert!(rotation.uncertainty < 1e-6, "{rotation:?}");
        let (point, mu) = case.fixed_point(mean(&record));
        assert!(mu[0].norm() > 1.0 && mu[0].im != 0.0, "{mu:?}");
        let angle = mu[0].arg().abs() / TAU;
        println!(
            "V_H = {v}: {rotation:?}, angle {angle}, modulus {}",
            mu[0].norm()
        );
        (point, (rotation.value - angle).abs())
    };
    let (point, whole) = settled(0.102, 2000);
    // The torus bifurcation, where the modulus is one.
    let (mut low, mut high) = (0.099, 0.102);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        let (_, mu) = Case::paper(0.2, middle).fixed_point(point.clone());
        if mu[0].norm() > 1.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    assert!(low > 0.0991 && high < 0.1019, "{low}");
    let departure = |part: f64| settled(high + part * (0.102 - high), 10_000).1;
    let (some, quarter_of_it) = (departure(0.2), departure(0.05));
    let ratio = some / quarter_of_it;
    println!("torus bifurcation at {low}, ratio {ratio}");
    assert!(
        whole < 1e-3 && (3.5..5.0).contains(&ratio),
        "{whole:e} {ratio}"
    );
}

/// K = 0.14, V_H = 0.0765: before the torus bifurcation at 0.0767399 the orbit is stable, but runs from afar stay away: the
/// bifurcation looks subcritical, as in the paper's Fig. 16(a).
#[test]
fn beside_the_stable_orbit_there_is_another_attractor() {
    let case = Case::paper(0.14, 0.0765);
    let far = case.record("auto", 1e-10, case.near_symmetric(0.3), (1500, 400));
    let away = case.periodic(&far);
    assert!(away.returns > 1, "{away:?}");
    let (point, mu) = orbit_beyond_hopf(0.0765);
    assert!(mu[0].norm() < 1.0 && mu[0].im != 0.0, "{mu:?}");
    let near = case.record(
        "auto",
        1e-10,
        &point + Vector::from_vec(vec![0.0, 1e-3, 0.0]),
        (3000, 400),
    );
    let orbit = case.periodic(&near);
    assert_eq!(orbit.returns, 1);
    assert!((&orbit.point - point).amax() < 1e-8, "{orbit:?}");
    assert!((orbit.multiplier - mu[0].norm()).abs() < 1e-6);
}

/// Fig. 16(b), K = 0.14 near the 1:4 resonance: three little loops and one long excursion, in turn. Another method finds the
/// same.
#[test]
fn the_fourfold_map_has_three_little_loops_and_one_excursion() {
    let case = Case::paper(0.14, 0.079);
    let start = case.near_symmetric(-0.01);
    let record = case.record("auto", 1e-10, start.clone(), (1000, 100));
    let found = case.periodic(&record);
    assert_eq!(found.returns, 4, "{found:?}");
    let last = &record.returns[record.returns.len() - 5..];
    let mut times: Vec<f64> = last
        .windows(2)
        .map(|pair| pair[1].time - pair[0].time)
        .collect();
    times.sort_by(f64::total_cmp);
    assert!(
        times[2] < 1.35 * times[0] && times[3] > 1.5 * times[2],
        "{times:?}"
    );
    let sum: f64 = times.iter().sum();
    assert!(
        (sum - found.period.value).abs() < 1e-5,
        "{sum} {:?}",
        found.period
    );
    let other = case.periodic(&case.record("rodas5p", 1e-9, start, (400, 60)));
    assert_eq!(other.returns, 4);
    assert!((other.period.value / found.period.value - 1.0).abs() < 1e-10);
}

/// K = 0.14: relaxation oscillations are period-1; strongly driven, the run comes to rest.
#[test]
fn relaxation_orbits_and_rest() {
    for (v, skip) in [(1.0, 100), (10.0, 400), (100.0, 8000)] {
        let case = Case::paper(0.14, v);
        let record = case.record("auto", 1e-10, case.near_symmetric(0.01), (skip, 60));
        assert_eq!(case.periodic(&record).returns, 1, "V_H = {v}");
    }
    let case = Case::paper(0.14, 1000.0);
    for start in [
        case.near_symmetric(0.01),
        Vector::from_vec(vec![10.0, 0.5_f64.ln(), 1e-3_f64.ln()]),
    ] {
        let record = case.record("auto", 1e-9, start, (10, 1000));
        let Ended::Steady {
            equilibrium,
            stable,
            ..
        } = &record.ended
        else {
            panic!("{:?}", record.ended);
        };
        assert!(*stable && case.field.f(equilibrium).amax() < 1e-4);
        assert_eq!(case.verdict(&record).regime, Regime::Steady);
    }
    // Just before the Hopf point the way to rest is a spiral too long to wait for: its rate says where it ends.
    let case = Case::paper(0.18, 0.07);
    let record = case.record("auto", 1e-9, case.near_symmetric(0.3), (10, 1000));
    assert!(
        matches!(record.ended, Ended::Steady { stable: true, .. }),
        "{:?}",
        record.ended
    );
}

/// A torus near a resonance almost repeats: that is not periodic. Ended early, a spiral into an orbit is.
#[test]
fn nearly_periodic_is_not_periodic() {
    let case = Case::paper(0.2, 0.102);
    let record = case.record("auto", 1e-10, case.near_symmetric(0.3), (4000, 900));
    let made = case.verdict(&record);
    assert!(made.periodic.is_none(), "{made:?}");
    // Returns of K = 0.14, V_H = 0.0765 that still spiral: multipliers of modulus 0.997.
    let case = Case::paper(0.14, 0.0765);
    let (point, mu) = orbit_beyond_hopf(0.0765);
    assert!(mu[0].norm() > 0.98 && mu[0].norm() < 1.0, "{mu:?}");
    let spiral = case.record(
        "auto",
        1e-10,
        point + Vector::from_vec(vec![0.0, 2e-3, 0.0]),
        (0, 400),
    );
    assert_eq!(case.periodic(&spiral).returns, 1);
}

/// A run that leaves an equilibrium just beyond its Hopf point, so slowly that its exponent is positive all the while.
#[test]
fn a_slow_passage_is_not_chaos() {
    let ended = command::twinslip(
        "section --driving 0.08615384615384616 --stiffness 0.23517241379310346 --start near-symmetric:0.01 --surface stress=11.4455 --skip 20 --returns 600 --lyapunov --format json -q",
    );
    assert_eq!(ended.code, 3, "{}", ended.err);
    let made: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
    let largest = command::number(&made, "/result/lyapunov/0/value");
    let bound = command::number(&made, "/result/lyapunov/0/uncertainty");
    assert!(largest > bound, "{largest} +- {bound}");
    assert_eq!(made["result"]["regime"], "undecided");
}

/// Returns that are made up, about the orbit inside a torus: each so far from it, at the angle of its number.
fn made_up(accuracy: f64, at: impl Fn(f64) -> [f64; 2]) -> (Case, ReturnRecord) {
    let case = Case::paper(0.2, 0.102);
    let settled = case.record("auto", 1e-10, case.near_symmetric(0.3), (1000, 300));
    let centre = case.fixed_point(mean(&settled)).0;
    let returns = (0..600).map(|n| {
        let [x, y] = at(f64::from(n));
        twinslip::section::Return {
            time: 60.0 * f64::from(n),
            state: &centre + Vector::from_vec(vec![0.0, x, y]),
        }
    });
    let record = ReturnRecord {
        returns: returns.collect(),
        waypoints: Vec::new(),
        ended: Ended::Complete,
        accuracy,
        max_step: f64::INFINITY,
    };
    (case, record)
}

/// Five points in turn that drift by less than the error of the run are no torus, though they never repeat to the last digit.
#[test]
fn returns_that_repeat_to_the_error_of_the_run_are_no_torus() {
    let turning = |rotation: f64| {
        move |n: f64| {
            let (sin, cos) = (TAU * rotation * n).sin_cos();
            [1e-2 * cos, 1e-2 * sin]
        }
    };
    let (case, drifting) = made_up(1e-8, turning(0.2 + 1e-9));
    let made = case.verdict(&drifting);
    assert_eq!(made.regime, Regime::Undecided, "{made:?}");
    assert!(
        made.why.is_some_and(|why| why.contains("repeat")),
        "{made:?}"
    );
    // The same circle is one where they don't.
    let (case, winding) = made_up(1e-8, turning(0.2 + 1e-3 * 2.0_f64.sqrt()));
    let made = case.verdict(&winding);
    assert_eq!(made.regime, Regime::Torus, "{made:?}");
}

/// A figure of eight has no order that could be seen: there only exponents that are known to vanish tell a torus.
#[test]
fn exponents_that_are_hardly_known_make_no_torus() {
    use twinslip::number::Uncertain;
    use twinslip::section::Exponents;
    let eight = |n: f64| {
        let angle = TAU * 0.381_966_011_250_105 * n;
        [1e-2 * angle.cos(), 1e-2 * (2.0 * angle).sin()]
    };
    let (case, record) = made_up(1e-10, eight);
    assert_eq!(case.verdict(&record).regime, Regime::Undecided);
    let duration = record.returns[599].time;
    let with = |uncertainty: f64| {
        let zero = Uncertain::new(0.0, uncertainty);
        let values = [zero, zero, Uncertain::new(-1e-3, 1e-6)];
        let known = Exponents {
            values: &values,
            converged: true,
        };
        let made = verdict(&case.field, &case.surface, &record, Some(known)).unwrap();
        made.regime
    };
    assert_eq!(with(0.05 / duration), Regime::Torus);
    assert_eq!(with(1.0 / duration), Regime::Undecided);
}

/// Two of three equal interfaces that begin alike stay alike, on an orbit that is stable as long as they are: the exponent of what would
/// part them is positive, and no sign of chaos.
#[test]
fn an_orbit_that_is_unstable_off_its_plane_is_not_chaos() {
    let ended = command::twinslip(
        "section --interfaces 3 --driving 10 --stiffness 0.14 --skip 300 --returns 220 --lyapunov --format json -q",
    );
    let made: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
    let largest = command::number(&made, "/result/lyapunov/0/value");
    let bound = command::number(&made, "/result/lyapunov/0/uncertainty");
    assert!(largest > bound, "{largest} +- {bound}");
    assert_eq!(made["result"]["regime"], "undecided");
    let note = made["result"]["note"].as_str().expect("a note");
    assert!(note.contains("unstable orbit"), "{note}");
}
