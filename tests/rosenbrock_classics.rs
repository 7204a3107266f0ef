//! The Rosenbrock methods on the classics of the stiff test sets, against their published digits.

#[path = "common/stiff_classics.rs"]
mod stiff_classics;

use nalgebra::SVector;
use stiff_classics::*;
use twinslip::field::{State, VectorField};
use twinslip::integrate::{Integrator, MAX_STEPS, Rosenbrock, RosenbrockMethod, Tolerances};

/// The largest relative error of a component.
fn relative_error<const N: usize>(y: &State<N>, exact: &[f64; N]) -> f64 {
    (0..N)
        .map(|i| (y[i] - exact[i]).abs() / exact[i].abs())
        .fold(0.0, f64::max)
}

/// Integrates a classic with every method, and compares.
fn check_classic<const N: usize>(
    field: &dyn VectorField<N>,
    (end_time, start, exact): (f64, [f64; N], [f64; N]),
    tolerances: Tolerances,
    allowed: [f64; 3],
) {
    for (method, allowed) in RosenbrockMethod::ALL.into_iter().zip(allowed) {
        let mut rosenbrock = Rosenbrock::<N>::new(method, tolerances, MAX_STEPS).unwrap();
        let start = SVector::from(start);
        let y = rosenbrock
            .flow(field, (0.0, end_time), &start, None)
            .unwrap();
        let error = relative_error(&y, &exact);
        println!("{method:?}: {error:.1e} in {:?}", rosenbrock.work());
        assert!(error < allowed, "{method:?}: {error:e}");
    }
}

#[test]
fn robertson() {
    let problem = (1e11, [1.0, 0.0, 0.0], ROBERTSON_AT_1E11);
    let tolerances = Tolerances::new(1e-8, 1e-18).unwrap();
    check_classic(&Robertson, problem, tolerances, [1e-8, 1e-8, 1e-5]);
}

#[test]
fn van_der_pol() {
    for (i, exact) in VAN_DER_POL.into_iter().enumerate() {
        let problem = (1.0 + i as f64, [2.0, 0.0], exact);
        let tolerances = Tolerances::equal(1e-9).unwrap();
        check_classic(&VanDerPol, problem, tolerances, [1e-8, 1e-8, 1e-6]);
    }
}

#[test]
fn hires() {
    let start = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];
    let problem = (321.8122, start, HIRES_AT_END);
    let tolerances = Tolerances::new(1e-9, 1e-13).unwrap();
    check_classic(&Hires, problem, tolerances, [1e-9, 1e-9, 1e-6]);
}

#[test]
fn orego() {
    let problem = (360.0, [1.0, 2.0, 3.0], OREGO_AT_360);
    let tolerances = Tolerances::new(1e-9, 1e-9).unwrap();
    check_classic(&Orego, problem, tolerances, [1e-8, 1e-8, 1e-5]);
}
