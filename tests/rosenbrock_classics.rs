//! The Rosenbrock methods on the classics of the stiff test sets, against their published digits.

use crate::common::stiff_classics;
use nalgebra::SVector;
use stiff_classics::*;
use twinslip::field::{Jacobian, State, VectorField};
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

/// E5 of the stiff test set, without the second species: y2 = y3 + y4 for ever. With it the invariant is kept to the rounding of
/// J u alone, which at t = 1e3 is a thousand times the y2 of t = 1e13: see the remark on invariants in the module.
struct E5;

const A: f64 = 7.89e-10;
const B: f64 = 1.1e7;
const C: f64 = 1.13e3;
const MC: f64 = 1.13e9;

impl VectorField<3> for E5 {
    fn f(&self, y: &State<3>) -> State<3> {
        let (made, bound, freed) = (A * y[0], B * y[0] * y[1], C * y[2]);
        let lost = MC * (y[1] + y[2]) * y[1];
        State::<3>::new(-made - bound, made - bound - lost + freed, bound - freed)
    }

    fn jacobian(&self, y: &State<3>) -> Jacobian<3> {
        let (x, z) = (B * y[0], B * y[1]);
        #[rustfmt::skip]
        let j = Jacobian::<3>::new(
            -A - z, -x,                                   0.0,
            A - z,  -x - MC * (y[1] + y[2]) - MC * y[1],  C - MC * y[1],
            z,      x,                                    -C,
        );
        j
    }

    fn second_derivative(&self, _: &State<3>, u: &State<3>, v: &State<3>) -> State<3> {
        let bound = B * (u[0] * v[1] + u[1] * v[0]);
        let lost = MC * ((u[1] + u[2]) * v[1] + (v[1] + v[2]) * u[1]);
        State::<3>::new(-bound, -bound - lost, bound)
    }
}

#[test]
fn e5() {
    // At t = 1e13, twelve decades below its largest value: the same in arithmetic of 40 digits with all four species.
    const LAST: f64 = 8.8610e-23;
    for rtol in [1e-4, 1e-6] {
        let tolerances = Tolerances::new(rtol, 1.11e-24).unwrap();
        let mut rodas =
            Rosenbrock::<3>::new(RosenbrockMethod::Rodas5P, tolerances, MAX_STEPS).unwrap();
        let start = State::<3>::new(1.76e-3, 0.0, 0.0);
        let y = rodas.flow(&E5, (0.0, 1e13), &start, None).unwrap();
        assert!((y[1] / LAST - 1.0).abs() < 1e-4, "{rtol}: {:e}", y[1]);
    }
}
