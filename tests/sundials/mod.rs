//! CVODES and KINSOL through their safe types: classics with published digits, errors by name, panics through C, events,
//! dense output, sensitivities, monodromy matrices, threads, and silence.

mod classics;
mod errors;
mod events;
mod kinsol;
mod monodromy;
mod panics;
mod sensitivities;
mod threads;

use twinslip::field::{Jacobian, State, VectorField};
use twinslip::integrate::Tolerances;
use twinslip::sundials::{Cvode, MultistepMethod, Operations};

const METHODS: [MultistepMethod; 2] = [MultistepMethod::Bdf, MultistepMethod::Adams];
const OPERATIONS: [Operations; 2] = [Operations::Fixed, Operations::Stock];

/// A field from two functions.
struct Field<F, J>(F, J);

impl<const N: usize, F, J> VectorField<N> for Field<F, J>
where
    F: Fn(&State<N>) -> State<N> + Send + Sync,
    J: Fn(&State<N>) -> Jacobian<N> + Send + Sync,
{
    fn f(&self, y: &State<N>) -> State<N> {
        (self.0)(y)
    }

    fn jacobian(&self, y: &State<N>) -> Jacobian<N> {
        (self.1)(y)
    }

    fn second_derivative(&self, _: &State<N>, _: &State<N>, _: &State<N>) -> State<N> {
        unreachable!("CVODES needs first derivatives only")
    }
}

/// x'' = -x in the state (x, x').
fn oscillator() -> impl VectorField<2> {
    Field(
        |y: &State<2>| State::<2>::new(y[1], -y[0]),
        |_: &State<2>| Jacobian::<2>::new(0.0, 1.0, -1.0, 0.0),
    )
}

fn cvode<const N: usize>(
    method: MultistepMethod,
    operations: Operations,
    rtol: f64,
    atol: f64,
) -> Cvode<N> {
    let mut cvode = Cvode::new(method, operations).unwrap();
    cvode
        .set_tolerances(Tolerances::new(rtol, atol).unwrap())
        .unwrap();
    cvode
}

/// Largest componentwise relative error.
fn relative_error(y: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(y.len(), expected.len());
    y.iter()
        .zip(expected)
        .map(|(y, e)| ((y - e) / e).abs())
        .fold(0.0, f64::max)
}
