//! Return maps: landings, derivatives, and the curves on which points of a map lie.

use crate::common as shared;
use shared::sections::{Case, orbit_beyond_hopf};
use std::f64::consts::TAU;
use twinslip::Error;
use twinslip::field::Vector;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{AnyIntegrator, AnyStep, Choice, Control, MAX_STEPS, Tolerances};
use twinslip::internals::weighted_mean;
use twinslip::section::{Ended, invariant_curve, regularity, return_map};

fn taylor(tolerance: f64) -> AnyIntegrator {
    let tolerances = Tolerances::equal(tolerance).unwrap();
    AnyIntegrator::new(Choice::Taylor, tolerances, MAX_STEPS).unwrap()
}

/// Every crossing is found and landed on, whatever the method: their number is that of the sign changes on a fine grid.
#[test]
fn landings_are_on_the_section_and_none_is_missed() {
    let case = Case::paper(0.14, 10.0);
    let start = case.near_symmetric(0.01);
    let exact = case.record("taylor", 1e-13, start.clone(), (0, 60));
    for point in &exact.returns {
        assert!((point.state[0] - case.surface.offset).abs() < 4e-15 * case.surface.offset);
        assert!(case.field.f(&point.state)[0] < 0.0, "not downwards");
    }
    let end = exact.returns.last().unwrap().time;
    let (mut before, mut falls) = (1.0, 0);
    let mut count = |step: &AnyStep<'_>| {
        let time = |part: u32| step.t0 + (step.t1 - step.t0) * f64::from(part) / 50.0;
        for part in 1..=50 {
            let height = step.dense(time(part))[0] - case.surface.offset;
            falls += usize::from(before > 0.0 && height < 0.0 && time(part - 1) <= end);
            before = height;
        }
        Ok(Control::Continue)
    };
    taylor(1e-13)
        .flow(&case.field, (0.0, end + 0.1), &start, Some(&mut count))
        .unwrap();
    assert_eq!(falls, exact.returns.len());
    for method in ["auto", "rodas5p", "rodas4"] {
        let other = case.record(method, 1e-9, start.clone(), (0, 60));
        assert_eq!(other.returns.len(), exact.returns.len());
        for (a, b) in other.returns.iter().zip(&exact.returns) {
            assert!(
                (a.time - b.time).abs() < 1e-4,
                "{method}: {} {}",
                a.time,
                b.time
            );
        }
    }
}

/// Slip localises on one interface: the stress never comes back up. The error says where the run has been.
#[test]
fn a_run_that_does_not_return_says_where_it_stays() {
    let law = AnyLaw::DieterichRuina(Parameters::heslot_1994().dieterich_ruina());
    let case = Case::new(law, 0.45, 1.0);
    let start = Vector::from_vec(vec![10.85, 1.99_f64.ln(), 2.01_f64.ln()]);
    let record = case.record("auto", 1e-9, start, (10, 10));
    let Ended::Failed(Error::NoReturn {
        since,
        t,
        section,
        lowest,
        highest,
    }) = record.ended
    else {
        panic!("{:?}", record.ended);
    };
    assert_eq!(section, case.surface.offset);
    assert!(t - since >= 2e4 && lowest <= highest && highest < section);
}

/// The derivative of the map against differences.
#[test]
fn the_map_has_the_derivative_that_it_says() {
    let case = Case::paper(0.2, 0.102);
    let mut taylor = taylor(1e-15);
    let y = Vector::from_vec(vec![case.surface.offset, -3.6, -2.1]);
    let mut map = |y: &Vector| return_map(&case.field, &case.surface, &mut taylor, y, 2e4).unwrap();
    let here = map(&y);
    const STEP: f64 = 1e-5;
    for j in 1..3 {
        let mut e = Vector::zeros(3);
        e[j] = STEP;
        let difference = (map(&(&y + &e)).state - map(&(&y - &e)).state) / (2.0 * STEP);
        for i in 1..3 {
            let apart = (difference[i] - here.derivative[(i, j)]).abs();
            assert!(
                apart < 1e-6 * here.derivative.amax(),
                "d{i}/d{j}: {apart:e}"
            );
        }
    }
}

/// At the torus bifurcation of K = 0.14 the derivative of the map has the multipliers of an independent computation.
#[test]
fn the_multipliers_at_a_torus_bifurcation() {
    let data = &shared::data("multipliers.json")["torus_bifurcation"];
    let (_, mu) = orbit_beyond_hopf(shared::number(&data["V_H"]));
    let (re, im) = shared::complex(&data["mu"][0]);
    assert!((mu[0].norm() - 1.0).abs() < 1e-9, "{mu:?}");
    assert!(
        (mu[0].re - re).abs() < 1e-8 && (mu[0].im.abs() - im.abs()).abs() < 1e-8,
        "{mu:?}"
    );
    let angle = mu[0].arg().abs() / (0.5 * TAU);
    assert!(
        (angle - shared::number(&data["theta/pi"])).abs() < 1e-8,
        "{angle}"
    );
}

/// Points of a rotation by known amounts, on an ellipse, bent, or on several curves.
#[test]
fn rotation_numbers_of_known_rotations() {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for turn in [
        golden,
        0.25 + 0.1 * golden,
        golden / 7.0,
        1.0 - golden / 3.0,
    ] {
        let points: Vec<[f64; 2]> = (0..1500)
            .map(|n| {
                let a = TAU * turn * f64::from(n);
                // Not a rotation, but conjugate to one.
                let a = a + 0.3 * a.sin();
                [
                    3.0 + a.cos(),
                    1e-3 * (a.sin() + 0.2 * (2.0 * a).cos()) - 2.0 * a.cos(),
                ]
            })
            .collect();
        assert!(
            regularity(&points) < 1e-7,
            "{turn}: {:e}",
            regularity(&points)
        );
        let curve = invariant_curve(&points).unwrap();
        let expected = turn.min(1.0 - turn);
        let apart = (curve.rotation.value - expected).abs();
        assert_eq!(curve.curves, 1);
        assert!(
            apart <= curve.rotation.uncertainty + 1e-12,
            "{turn}: {curve:?}"
        );
        assert!(apart < 1e-9, "{turn}: {apart:e}");
    }
    let three: Vec<[f64; 2]> = (0..1800)
        .map(|n| {
            let (a, b) = (
                TAU * golden * f64::from(n / 3),
                TAU * f64::from(n % 3) / 3.0,
            );
            [5.0 * b.cos() + a.cos(), 5.0 * b.sin() + a.sin()]
        })
        .collect();
    let curve = invariant_curve(&three).unwrap();
    assert_eq!(curve.curves, 3);
    assert!(
        (curve.rotation.value - (1.0 - golden)).abs() < 1e-9,
        "{curve:?}"
    );
}

/// The Henon map at its usual parameters is chaotic: no curve, no convergence of averages.
#[test]
fn chaos_is_no_curve() {
    let mut p = [0.1, 0.1];
    let points: Vec<[f64; 2]> = (0..4000)
        .map(|_| {
            p = [1.0 - 1.4 * p[0] * p[0] + p[1], 0.3 * p[0]];
            p
        })
        .collect();
    assert!(regularity(&points[100..]) > 1e-3);
    assert!(invariant_curve(&points[100..]).is_none());
    let first = weighted_mean(points.iter().map(|p| p[0]));
    assert!((first - 0.2569).abs() < 0.02, "{first}");
    assert_eq!(
        weighted_mean(std::iter::empty::<f64>().collect::<Vec<_>>().into_iter()),
        0.0
    );
}
