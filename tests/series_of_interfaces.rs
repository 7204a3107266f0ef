//! The series of two interfaces by the recurrences that they have of their own, against the laws' formulas on series, by which
//! several trajectories side by side are made.

use proptest::prelude::*;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::model::{Loading, MAX_LANES, batch_solution, two_interfaces};
use twinslip::number::DoubleDouble;
use twinslip::series::{Accuracy, Expansion, MAX_ORDER};

/// The coefficients of one series, and its unit of time.
type Terms<'a> = (&'a [f64], f64);

/// The largest difference of terms of two series after a time, and the largest term of the second.
fn apart(a: Terms<'_>, b: Terms<'_>, time: f64) -> (f64, f64) {
    let term = |(series, unit): Terms<'_>, j: usize| series[j] * (time / unit).powi(j as i32);
    let terms = (0..a.0.len()).map(|j| (term(a, j), term(b, j)));
    terms.fold((0.0, 0.0), |(off, size), (a, b)| {
        (off.max((a - b).abs()), size.max(b.abs()))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn every_term_is_that_of_the_formula(
        law in 0..AnyLaw::NAMES.len(),
        beta in 0.3..3.0,
        gamma0 in 1e-6..1e-2,
        healing_time in 1.0..1e3,
        residual_strength in prop_oneof![Just(0.0), 1e-6..0.1],
        (driving, stiffness) in (-4.0..6.0, -4.0..1.0),
        tau in prop_oneof![0.1..1.0_f64, 1.0..12.0],
        pulled: bool,
        psi in prop::array::uniform2(-7.0..0.0),
        order in prop_oneof![Just(12), Just(16), Just(18), Just(20), Just(MAX_ORDER)],
        backwards: bool,
    ) {
        const BOUND: f64 = 5e-12;
        let constants = Parameters { beta, gamma0, healing_time, residual_strength };
        let law = AnyLaw::named(AnyLaw::NAMES[law], constants).expect("known");
        // The slip rate of some laws has but one sign.
        let one_sign = ["dieterich-ruina", "slip"].contains(&law.name());
        let tau: f64 = if pulled && !one_sign { -tau } else { tau };
        let loading = Loading::new(f64::exp(driving), f64::exp(stiffness)).expect("positive");
        let start = [tau, psi[0], psi[1]];
        let limit = if backwards { -1e3 } else { 1e3 };
        let accuracy = Accuracy { order, tolerances: (1e-10, 1e-10) };
        let (mut here, mut there) = (Expansion::new(), Expansion::new());

        let field = two_interfaces(law, loading);
        let mut solution = field.analytic().expect("series").solution();
        solution.start(&start);
        let h = solution.advance(&accuracy, DoubleDouble::from(limit)).hi();
        solution.expansion(order, &mut here);

        let Some(mut lanes) = batch_solution(law) else {
            // This processor has the formula alone.
            return Ok(());
        };
        (0..lanes.lanes()).for_each(|lane| lanes.start(lane, &loading, &start));
        let steps = lanes.advance(&accuracy, &[limit; MAX_LANES]);
        lanes.expansion(0, order, &mut there);

        prop_assert!((steps[0] / h - 1.0).abs() < 1e-3, "{h} and {}", steps[0]);
        let mut rates = 0.0;
        for i in 0..2 {
            let [a, b] = [&here, &there].map(|all| (&all.slip_rates[i][..order], all.unit));
            let (off, size) = apart(a, b, h);
            prop_assert!(off <= BOUND * size, "v_{i}: {off:e} of {size:e}");
            rates += size;
        }
        for i in 0..3 {
            let [a, b] = [&here, &there].map(|all| (&all.variables[i][..=order], all.unit));
            let (off, size) = apart(a, b, h);
            // Of differences of large rates no more digits are known.
            let of_rates = match i {
                0 => loading.stiffness * (loading.driving + rates),
                _ => rates * b.0[0],
            };
            let size = size.max(of_rates * h.abs());
            prop_assert!(off <= BOUND * size, "variable {i}: {off:e} of {size:e}");
        }
    }
}
