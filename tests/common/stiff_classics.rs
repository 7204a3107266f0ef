//! The classics of the stiff test sets, with published digits.
//!
//! Hairer, E. and Wanner, G. (1996). Solving Ordinary Differential Equations II, section IV.10, and
//! Mazzia, F. and Magherini, C. (2008). Test Set for Initial Value Problem Solvers, release 2.4.

use twinslip::field::{Jacobian, State, VectorField};

/// Robertson's chemical reaction.
pub struct Robertson;

/// At t = 1e11, from (1, 0, 0): test set, problem ROBER.
pub const ROBERTSON_AT_1E11: [f64; 3] = [
    0.2083340149701255e-7,
    0.8333360770334713e-13,
    0.999999979166505,
];

impl VectorField<3> for Robertson {
    fn f(&self, y: &State<3>) -> State<3> {
        let first = -0.04 * y[0] + 1e4 * y[1] * y[2];
        let third = 3e7 * y[1] * y[1];
        State::<3>::new(first, -first - third, third)
    }

    fn jacobian(&self, y: &State<3>) -> Jacobian<3> {
        let (a, b, c) = (1e4 * y[2], 1e4 * y[1], 6e7 * y[1]);
        Jacobian::<3>::new(-0.04, a, b, 0.04, -a - c, -b, 0.0, c, 0.0)
    }

    fn second_derivative(&self, _: &State<3>, u: &State<3>, v: &State<3>) -> State<3> {
        let first = 1e4 * (u[1] * v[2] + u[2] * v[1]);
        let third = 6e7 * u[1] * v[1];
        State::<3>::new(first, -first - third, third)
    }
}

/// Van der Pol's equation with epsilon = 1e-6, in the time of Hairer & Wanner.
pub struct VanDerPol;

const EPSILON: f64 = 1e-6;

/// At t = 1 and t = 2, from (2, 0): Hairer's test set, problem VDPOL.
pub const VAN_DER_POL: [[f64; 2]; 2] = [
    [-0.186364625480813e1, 0.753543086543546],
    [0.1706167732170456e1, -0.8928097010248257],
];

impl VectorField<2> for VanDerPol {
    fn f(&self, y: &State<2>) -> State<2> {
        State::<2>::new(y[1], ((1.0 - y[0] * y[0]) * y[1] - y[0]) / EPSILON)
    }

    fn jacobian(&self, y: &State<2>) -> Jacobian<2> {
        Jacobian::<2>::new(
            0.0,
            1.0,
            (-2.0 * y[0] * y[1] - 1.0) / EPSILON,
            (1.0 - y[0] * y[0]) / EPSILON,
        )
    }

    fn second_derivative(&self, y: &State<2>, u: &State<2>, v: &State<2>) -> State<2> {
        let mixed = -2.0 * (y[1] * u[0] * v[0] + y[0] * (u[0] * v[1] + u[1] * v[0]));
        State::<2>::new(0.0, mixed / EPSILON)
    }
}

/// The oregonator.
pub struct Orego;

/// At t = 360, from (1, 2, 3): test set, problem OREGO.
pub const OREGO_AT_360: [f64; 3] = [
    0.1000814870318523e1,
    0.1228178521549917e4,
    0.1320554942846706e3,
];

impl VectorField<3> for Orego {
    fn f(&self, y: &State<3>) -> State<3> {
        State::<3>::new(
            77.27 * (y[1] + y[0] * (1.0 - 8.375e-6 * y[0] - y[1])),
            (y[2] - (1.0 + y[0]) * y[1]) / 77.27,
            0.161 * (y[0] - y[2]),
        )
    }

    fn jacobian(&self, y: &State<3>) -> Jacobian<3> {
        Jacobian::<3>::new(
            77.27 * (1.0 - 2.0 * 8.375e-6 * y[0] - y[1]),
            77.27 * (1.0 - y[0]),
            0.0,
            -y[1] / 77.27,
            -(1.0 + y[0]) / 77.27,
            1.0 / 77.27,
            0.161,
            0.0,
            -0.161,
        )
    }

    fn second_derivative(&self, _: &State<3>, u: &State<3>, v: &State<3>) -> State<3> {
        let mixed = u[0] * v[1] + u[1] * v[0];
        let first = -77.27 * (2.0 * 8.375e-6 * u[0] * v[0] + mixed);
        State::<3>::new(first, -mixed / 77.27, 0.0)
    }
}

/// High irradiance response of photomorphogenesis.
pub struct Hires;

/// From (1, 0, 0, 0, 0, 0, 0, 0.0057) to t = 321.8122: test set, problem HIRES.
pub const HIRES_AT_END: [f64; 8] = [
    0.7371312573325668e-3,
    0.1442485726316185e-3,
    0.5888729740967575e-4,
    0.1175651343283149e-2,
    0.2386356198831331e-2,
    0.6238968252742796e-2,
    0.2849998395185769e-2,
    0.2850001604814231e-2,
];

/// Its linear part; the product 280 y6 y8 comes in addition.
#[rustfmt::skip]
const HIRES_LINEAR: [f64; 64] = [
    -1.71, 0.43,  8.32,   0.0,  0.0,    0.0,   0.0,  0.0,
    1.71,  -8.75, 0.0,    0.0,  0.0,    0.0,   0.0,  0.0,
    0.0,   0.0,   -10.03, 0.43, 0.035,  0.0,   0.0,  0.0,
    0.0,   8.32,  1.71,   -1.12, 0.0,   0.0,   0.0,  0.0,
    0.0,   0.0,   0.0,    0.0,  -1.745, 0.43,  0.43, 0.0,
    0.0,   0.0,   0.0,    0.69, 1.71,   -0.43, 0.69, 0.0,
    0.0,   0.0,   0.0,    0.0,  0.0,    0.0,   -1.81, 0.0,
    0.0,   0.0,   0.0,    0.0,  0.0,    0.0,   1.81, 0.0,
];

impl Hires {
    /// The three components in which the product appears.
    fn product(value: f64) -> State<8> {
        let mut f = State::<8>::zeros();
        (f[5], f[6], f[7]) = (-value, value, -value);
        f
    }
}

impl VectorField<8> for Hires {
    fn f(&self, y: &State<8>) -> State<8> {
        let mut f = Jacobian::<8>::from_row_slice(&HIRES_LINEAR) * y;
        f[0] += 0.0007;
        f + Self::product(280.0 * y[5] * y[7])
    }

    fn jacobian(&self, y: &State<8>) -> Jacobian<8> {
        let mut j = Jacobian::<8>::from_row_slice(&HIRES_LINEAR);
        for (column, other) in [(5, 7), (7, 5)] {
            let changed = j.column(column) + Self::product(280.0 * y[other]);
            j.set_column(column, &changed);
        }
        j
    }

    fn second_derivative(&self, _: &State<8>, u: &State<8>, v: &State<8>) -> State<8> {
        Self::product(280.0 * (u[5] * v[7] + u[7] * v[5]))
    }
}
