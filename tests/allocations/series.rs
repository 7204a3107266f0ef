//! Steps that change between the recurrences of interfaces and their recorded formula, near tau = 0, allocate nothing: it is recorded once.

use allocation_counter::measure;
use twinslip::Error;
use twinslip::expression::{Binary, Builder, Function};
use twinslip::field::VectorField;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::model::{
    Loading, MAX_LANES, TextSystem, batch_solution, interfaces_in_difference_chart, two_interfaces,
};
use twinslip::number::DoubleDouble;
use twinslip::series::Accuracy;

const ACCURACY: Accuracy = Accuracy {
    order: 20,
    tolerances: (1e-12, 1e-12),
};
/// Stresses, of which the last two are near 0.
const STRESSES: [f64; 4] = [3.0, -3.0, 0.1, -0.1];

fn laws() -> [AnyLaw; 2] {
    // The second one has no recurrences of its own.
    let plain = Parameters::heslot_1994();
    let damped = plain.damped(1e-3).expect("positive");
    [plain, damped].map(|all| AnyLaw::named("spinodal", all).expect("known"))
}

fn loading() -> Loading {
    Loading::new(10.0, 0.14).expect("positive")
}

/// The allocations of these steps once more.
fn again(mut steps: impl FnMut(f64)) -> u64 {
    STRESSES.into_iter().for_each(&mut steps);
    measure(|| STRESSES.into_iter().for_each(&mut steps)).count_total
}

#[test]
fn no_step_allocates_near_zero_stress() {
    for law in laws() {
        let field = two_interfaces(law, loading());
        let analytic = field.analytic().expect("series");
        let limit = DoubleDouble::from(1e-3);
        let mut solution = analytic.solution();
        let counted = again(|tau| {
            solution.start(&[tau, -1.0, -2.0]);
            assert!(solution.advance(&ACCURACY, limit).is_finite());
        });
        assert_eq!(counted, 0, "{law:?}");
        let mut tangent = analytic.tangent(&[0, 1]);
        let counted = again(|tau| {
            tangent.start(&[tau, -1.0, -2.0]);
            assert!(tangent.advance(&ACCURACY, limit).is_finite());
        });
        assert_eq!(counted, 0, "tangent of {law:?}");
        let Some(mut lanes) = batch_solution(law) else {
            continue;
        };
        let counted = again(|tau| {
            lanes.start(0, &loading(), &[tau, -1.0, -2.0]);
            assert!(lanes.advance(&ACCURACY, &[1e-3; MAX_LANES])[0].is_finite());
        });
        assert_eq!(counted, 0, "lanes of {law:?}");
    }
}

#[test]
fn a_solution_records_no_formula_that_is_known() {
    /// A solution that is made, and its memory.
    const MADE: u64 = 4;
    let [law, damped] = laws();
    let apart = interfaces_in_difference_chart(law, loading());
    let together = two_interfaces(damped, loading());
    let fields: [&dyn VectorField<3>; 2] = [&*apart, &*together];
    for field in fields {
        let make = || {
            let analytic = field.analytic().expect("series");
            let mut solution = analytic.solution();
            solution.start(&[3.0, -1.0, -2.0]);
            solution.advance(&ACCURACY, DoubleDouble::from(1e-3));
        };
        make();
        let counted = measure(make).count_total;
        assert!(counted <= MADE, "{counted}");
    }
}

/// A system whose equations are read, at a value of its parameter.
fn relaxation(p: f64) -> TextSystem {
    let mut builder = Builder::default();
    let mut made = || {
        let [x, y] = [builder.variable(0)?, builder.variable(1)?];
        let p = builder.parameter(0)?;
        let cube = builder.binary(Binary::Product, x, x)?;
        let cube = builder.binary(Binary::Product, cube, x)?;
        let rise = builder.binary(Binary::Difference, x, cube)?;
        let rate = builder.binary(Binary::Difference, rise, y)?;
        let way = builder.binary(Binary::Difference, x, p)?;
        let slow = builder.binary(Binary::Product, way, p)?;
        let slow = builder.call(Function::Tanh, &[slow])?;
        Ok::<_, Error>(vec![rate, slow])
    };
    let rates = made().expect("few operations");
    TextSystem::new(builder.complete(rates), &["x", "y"], &[("p", p)]).expect("few states")
}

#[test]
fn solutions_go_over_to_other_values_of_the_parameters() {
    /// What they are known by, what would record their formulas, which variables are factors of their own rates, and the entries of the Jacobian.
    const FEW: u64 = 20;
    let steps = |p: f64| {
        let system = relaxation(p);
        let field = system.field::<2>().expect("two variables");
        let analytic = field.analytic().expect("series");
        let limit = DoubleDouble::from(1e-3);
        let mut state = [0.0; 2];
        let counted = measure(|| {
            let mut solution = analytic.solution();
            solution.start(&[0.5, 0.1]);
            assert!(solution.advance(&ACCURACY, limit).is_finite());
            let mut tangent = analytic.tangent(&[0]);
            tangent.start(&solution.state());
            assert!(tangent.advance(&ACCURACY, limit).is_finite());
            state = tangent.state();
        });
        (state, counted.count_total)
    };
    let (before, made) = steps(0.3);
    let (after, set) = steps(0.31);
    assert_ne!(before, after);
    assert!(made > 100 && set <= FEW, "{made}, then {set}");
}
