//! Strong resonances along curves of tori, in four and more variables.

use crate::common::among::{Among, langford};
use crate::common::branches::first;
use std::ops::ControlFlow::{Break, Continue};
use twinslip::continuation::{Met, WatchedFunction};
use twinslip::model::classics::Langford;
use twinslip::number::Real;
use twinslip::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, OverParameters, Palc, PalcSettings, TestFunction,
};
use twinslip::series::Equations;

/// Langford's system with its frequency as a parameter: x' = (z - 0.7) x - omega y, y' = omega x + (z - 0.7) y,
/// z' = 0.6 + z - z^3/3 - (x^2 + y^2)(1 + rho z) + eps z x^3.
#[derive(Debug, Clone, Copy)]
struct Turning {
    eps: f64,
}

impl Equations<3, 2> for Turning {
    const PARAMETERS: [&'static str; 2] = ["rho", "omega"];

    fn rates<T: Real>(&self, [x, y, z]: [T; 3], [rho, omega]: [T; 2]) -> [T; 3] {
        let one = T::constant(1.0);
        let lifted = z - one * 0.7;
        [
            lifted * x - omega * y,
            omega * x + lifted * y,
            z - z * z * z / 3.0 - (x * x + y * y) * (one + rho * z)
                + z * x * x * x * self.eps
                + 0.6,
        ]
    }
}

/// The values of (rho, omega) at which two multipliers on the torus curve have this sum, from omega = 3.5 on until `end`.
fn resonances<const N: usize>(eps: f64, sums: &[f64], end: f64) -> Vec<(f64, [f64; 2])> {
    let family = OverParameters::<_, N, 2>::both(Among(Turning { eps }));
    let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
    let circle = ContinuationPoint {
        at: [0.3, 3.5],
        ..langford::<N>(0.3)
    };
    let held = [Condition::Parameter(0, 0.3)];
    let orbit = corrector.correct(circle, &[0], &held, Goal::SHARP);
    let site = orbit.expect("an orbit").site;
    let torus = first(&mut corrector, site, (0, 1.5), TestFunction::Torus);
    let settings = PalcSettings::locus(TestFunction::Torus, 0.05);
    let meets = [Condition::TestFunction(TestFunction::Torus)];
    let here = corrector.look(torus.expect("a torus"), &[0, 1], &meets);
    let here = here.expect("an orbit");
    let direction = settings.direction(&here, &here.along[0]);
    let direction = direction.expect("a direction");
    let sign = direction.parameters[1].signum() * (end - 3.5).signum();
    let begun = Palc::from(&mut corrector, settings, here.site, direction.scaled(sign));
    let watched: Vec<_> = sums
        .iter()
        .map(|&sum| WatchedFunction::TestFunction(TestFunction::Trace(sum)))
        .collect();
    let mut met = Vec::new();
    let mut palc = begun.expect("a continuation");
    palc.follow(&watched, 400, &mut |_, _, now| match now {
        Met::Zero(WatchedFunction::TestFunction(sum), at) => {
            met.push((sum, at.here.site.clone()));
            Continue(())
        }
        Met::Point(now) if (now.here.site.at[1] - end) * (end - 3.5) > 0.0 => Break(()),
        _ => Continue(()),
    })
    .expect("a curve");
    let sharp = met.into_iter().map(|(sum, site)| {
        let meets = [TestFunction::Torus, sum].map(Condition::TestFunction);
        let orbit = corrector.correct(site, &[0, 1], &meets, Goal::SHARP);
        let TestFunction::Trace(sum) = sum else {
            unreachable!("only sums are watched")
        };
        (sum, orbit.expect("a resonance").site.at)
    });
    sharp.collect()
}

/// At eps = 0 the angle of the critical pair is 2 pi k r / omega.
#[test]
fn strong_resonances_are_where_the_closed_form_says() {
    let rho = Langford::torus();
    let frequency = (2.0 * (1.0 + 0.7 * rho)).sqrt() * Langford::radius(rho);
    let (third, fourth) = (-1.0, 0.0);
    let known = [
        (6.5, [(third, 1.0 / 3.0), (fourth, 1.0 / 4.0)]),
        (2.0, [(third, 2.0 / 3.0), (fourth, 3.0 / 4.0)]),
    ];
    fn assert_known<const N: usize>(known: &[(f64, f64)], end: f64, rho: f64, frequency: f64) {
        let met = resonances::<N>(0.0, &[-1.0, 0.0], end);
        assert_eq!(met.len(), known.len(), "{N}: {met:?}");
        for ((sum, at), (known, part)) in met.iter().zip(known) {
            assert_eq!(sum, known);
            assert!((at[0] / rho - 1.0).abs() < 1e-10, "{N}: {met:?}");
            assert!(
                (at[1] * part / frequency - 1.0).abs() < 1e-10,
                "{N}: {met:?}"
            );
        }
    }
    for (end, known) in known {
        assert_known::<4>(&known, end, rho, frequency);
    }
    let (end, known) = known[0];
    assert_known::<6>(&known, end, rho, frequency);
}

/// Where both multipliers are -1 they are no smooth functions; their sum is.
#[test]
fn the_resonance_one_to_two_is_where_the_trace_of_three_variables_says() {
    let three = resonances::<3>(0.5, &[-2.0], 2.6);
    let four = resonances::<4>(0.5, &[-2.0], 2.6);
    assert!(
        !three.is_empty() && three.len() == four.len(),
        "{three:?}, {four:?}"
    );
    for ((_, three), (_, four)) in three.iter().zip(&four) {
        for i in 0..2 {
            assert!(
                (three[i] / four[i] - 1.0).abs() < 1e-9,
                "{three:?}, {four:?}"
            );
        }
    }
}

#[test]
fn resonances_need_two_multipliers() {
    assert!(TestFunction::Trace(0.0).checked(2).is_err());
    assert!(TestFunction::Trace(0.0).checked(4).is_ok());
}
