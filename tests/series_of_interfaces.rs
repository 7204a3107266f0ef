//! The series of two interfaces by the recurrences that they have of their own, one trajectory and several side by side, against the
//! laws' formulas in 31 digits.

use proptest::prelude::*;
use twinslip::field::VectorField;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::model::{
    Loading, MAX_LANES, batch_solution, interfaces_in_difference_chart, two_interfaces,
};
use twinslip::number::DoubleDouble;
use twinslip::series::{Accuracy, Derivatives, Expansion, MAX_ORDER, REFERENCE_ORDER};

/// The coefficients of one series, and its unit of time.
type Terms<'a> = (&'a [f64], f64);

/// The stress, or its opposite where the law has a slip rate there.
fn signed(law: AnyLaw, tau: f64, pulled: bool) -> f64 {
    let one_sign = ["dieterich-ruina", "slip"].contains(&law.name());
    if pulled && !one_sign { -tau } else { tau }
}

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
        beside_rest: bool,
    ) {
        let constants = Parameters { beta, gamma0, healing_time, residual_strength, damping: 0.0 };
        let law = AnyLaw::named(AnyLaw::NAMES[law], constants).expect("known");
        let tau = signed(law, tau, pulled);
        let loading = Loading::new(f64::exp(driving), f64::exp(stiffness)).expect("positive");
        let start = [tau, psi[0], psi[1]];
        let limit = if backwards { -1e3 } else { 1e3 };
        let accuracy = Accuracy { order, tolerances: (1e-10, 1e-10) };
        let field = two_interfaces(law, loading);
        let analytic = field.analytic().expect("series");
        let mut reference = analytic.reference();
        reference.start(&start);
        let near = reference.advance(&accuracy, DoubleDouble::from(limit)).hi();
        let mut exact = Expansion::new();
        reference.expansion(order, &mut exact);
        // The reference is in ln psi, whose series do not reach as far: beyond, rounding of theirs is all that there is to see.
        for log_state in &mut exact.variables[1..] {
            *log_state = exponential(log_state);
        }
        let bound = Bound { loading, order };

        let mut solution = analytic.solution();
        solution.start(&start);
        let h = solution.advance(&accuracy, DoubleDouble::from(limit)).hi();
        let time = if near.abs() < h.abs() { near } else { h };
        let mut one = Expansion::new();
        solution.expansion(order, &mut one);
        bound.check("one", &one, &exact, time)?;

        let Some(mut lanes) = batch_solution(law) else {
            // This processor has one alone.
            return Ok(());
        };
        (0..lanes.lanes()).for_each(|lane| lanes.start(lane, &loading, &start));
        if beside_rest {
            lanes.start(1, &loading, &[0.1, -1.0, -2.0]);
        }
        let steps = lanes.advance(&accuracy, &[limit; MAX_LANES]);
        let mut lane = Expansion::new();
        lanes.expansion(0, order, &mut lane);
        bound.check("lanes", &lane, &exact, time)?;
        bound.check("lanes beside one", &lane, &one, h)?;
        prop_assert!((steps[0] / h - 1.0).abs() < 1e-3, "{h} and {}", steps[0]);
    }
}

/// The exponential of a series.
fn exponential<const M: usize>(x: &[f64; M]) -> [f64; M] {
    let mut e = [x[0].exp(); M];
    for k in 1..M {
        let terms = (1..=k).map(|j| j as f64 * x[j] * e[k - j]);
        e[k] = terms.sum::<f64>() / k as f64;
    }
    e
}

/// How far series may be apart.
struct Bound {
    loading: Loading,
    order: usize,
}

impl Bound {
    fn check(
        &self,
        which: &str,
        made: &Expansion<3>,
        exact: &Expansion<3>,
        h: f64,
    ) -> Result<(), TestCaseError> {
        const BOUND: f64 = 5e-12;
        let mut rates = 0.0;
        for i in 0..2 {
            let [a, b] = [made, exact].map(|all| (&all.slip_rates[i][..self.order], all.unit));
            let (off, size) = apart(a, b, h);
            prop_assert!(off <= BOUND * size, "{which}, v_{i}: {off:e} of {size:e}");
            rates += size;
        }
        for i in 0..3 {
            let [a, b] = [made, exact].map(|all| (&all.variables[i][..=self.order], all.unit));
            let (off, size) = apart(a, b, h);
            // Of differences of large rates no more digits are known.
            let Loading { driving, stiffness } = self.loading;
            let of_rates = match i {
                0 => stiffness * (driving + rates),
                _ => rates * b.0[0],
            };
            let size = size.max(of_rates * h.abs());
            prop_assert!(
                off <= BOUND * size,
                "{which}, variable {i}: {off:e} of {size:e}"
            );
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// One step of the columns, against 31 digits and the law's formulas.
    #[test]
    fn every_column_is_that_of_the_formula(
        law in 0..AnyLaw::NAMES.len(),
        beta in 0.3..3.0,
        gamma0 in 1e-6..1e-2,
        residual_strength in prop_oneof![Just(0.0), 1e-6..0.1],
        (driving, stiffness) in (-4.0..6.0, -4.0..1.0),
        tau in prop_oneof![0.1..1.0_f64, 1.0..12.0],
        pulled: bool,
        psi in prop::array::uniform2(-7.0..0.0),
        symmetric: bool,
        order in prop_oneof![Just(12), Just(16), Just(18), Just(20), Just(MAX_ORDER)],
        free in prop_oneof![Just(vec![]), Just(vec![1]), Just(vec![0, 1]), Just(vec![1, 0])],
    ) {
        let constants = Parameters { beta, gamma0, healing_time: 100.0, residual_strength, damping: 0.0 };
        let law = AnyLaw::named(AnyLaw::NAMES[law], constants).expect("known");
        let tau = signed(law, tau, pulled);
        let loading = Loading::new(f64::exp(driving), f64::exp(stiffness)).expect("positive");
        let step = Step { order, free };
        if symmetric {
            step.compare(&*twinslip::model::symmetric(law, loading), [tau, psi[0]])?;
        } else {
            step.compare(&*two_interfaces(law, loading), [tau, psi[0], psi[1]])?;
        }
    }

    /// The same in (tau, ln psi_2, ln D), however small D is, for laws whose state ages. What a change of ln D does to tau is as small
    /// as D, and so is what it errs by.
    #[test]
    fn every_column_of_the_difference_chart_is_that_of_the_formula(
        law in prop_oneof![Just("spinodal"), Just("bounded"), Just("regularised-ageing"), Just("dieterich-ruina")],
        beta in 0.3..3.0,
        residual_strength in prop_oneof![Just(0.0), 1e-6..0.1],
        (driving, stiffness) in (-4.0..6.0, -7.0..1.0),
        tau in prop_oneof![0.1..1.0_f64, 1.0..12.0],
        pulled: bool,
        log_second in -9.0..0.0,
        log_gap in prop_oneof![-300.0..-20.0, -20.0..1.0],
        order in prop_oneof![Just(12), Just(16), Just(18), Just(20), Just(MAX_ORDER)],
        free in prop_oneof![Just(vec![]), Just(vec![1]), Just(vec![0, 1]), Just(vec![1, 0])],
    ) {
        let constants = Parameters { beta, gamma0: 1e-4, healing_time: 100.0, residual_strength, damping: 0.0 };
        let law = AnyLaw::named(law, constants).expect("known");
        let tau = signed(law, tau, pulled);
        let loading = Loading::new(f64::exp(driving), f64::exp(stiffness)).expect("positive");
        let field = interfaces_in_difference_chart(law, loading);
        let step = Step { order, free };
        let [made, exact] = step.compare(&*field, [tau, log_second, log_gap])?;
        let (of_stress, exact) = (made.start[2][0], exact.start[2][0]);
        let bound = 1e-8 * exact.abs() + 1e-12 * log_gap.exp();
        prop_assert!((of_stress - exact).abs() < bound, "{of_stress} {exact}");
    }
}

/// A step of a tangent.
struct Step {
    order: usize,
    free: Vec<usize>,
}

impl Step {
    fn compare<const N: usize>(
        &self,
        field: &dyn VectorField<N>,
        start: [f64; N],
    ) -> Result<[Derivatives<N>; 2], TestCaseError> {
        /// A step at this tolerance, with which truncation does not count.
        const TOLERANCE: f64 = 1e-15;
        const BOUND: f64 = 2e-11;
        let analytic = field.analytic().expect("series");
        let accuracy = Accuracy {
            order: self.order,
            tolerances: (TOLERANCE, TOLERANCE),
        };
        let mut tangent = analytic.tangent(&self.free);
        tangent.start(&start);
        let h = tangent.advance(&accuracy, DoubleDouble::from(1e3));
        let made = tangent.derivatives();

        let mut reference = analytic.reference_tangent(&self.free);
        reference.start(&start);
        let fine = Accuracy {
            order: REFERENCE_ORDER,
            tolerances: (1e-25, 1e-25),
        };
        let mut remaining = h;
        while remaining.hi() > 0.0 {
            let taken = reference.advance(&fine, remaining);
            prop_assert!(taken.is_finite() && taken.hi() > 0.0, "no step after {h:?}");
            remaining = remaining - taken;
        }
        let exact = reference.derivatives();

        // Each column to a part of its largest component.
        let columns = |all: &Derivatives<N>| {
            let mut columns = all.start.to_vec();
            columns.extend(&all.parameters);
            columns
        };
        let (made_columns, exact_columns) = (columns(&made), columns(&exact));
        prop_assert_eq!(made_columns.len(), N + self.free.len());
        for (j, (a, b)) in made_columns.iter().zip(&exact_columns).enumerate() {
            let size = b
                .iter()
                .fold(f64::MIN_POSITIVE, |size, x| size.max(x.abs()));
            let off = a
                .iter()
                .zip(b)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            prop_assert!(
                off <= BOUND * size,
                "column {j}: {off:e} of {size:e}, {h:?}"
            );
        }
        let off = (made.log_determinant - exact.log_determinant).abs();
        prop_assert!(
            off <= BOUND * (1.0 + exact.log_determinant.abs()),
            "trace: {off:e}"
        );
        let across = made.log_transverse.zip(exact.log_transverse);
        prop_assert_eq!(across.is_some(), N == 2);
        if let Some((a, b)) = across {
            prop_assert!(
                (a - b).abs() <= BOUND * (1.0 + b.abs()),
                "across: {a} and {b}"
            );
        }
        Ok([made, exact])
    }
}
