//! The coefficients of the Radau IIA methods: collocation at the zeros of P_s - P_(s-1), shifted to (0, 1], the last of which is 1
//! (Hairer & Wanner 1996, Solving Ordinary Differential Equations II, section IV.5).

use nalgebra::{DMatrix, DVector};
use std::sync::LazyLock;

/// A method of s stages and order 2s - 1.
#[derive(Debug, Clone)]
pub struct Coefficients {
    /// The places of the stages as parts of a step, ascending.
    pub c: DVector<f64>,
    /// a_ij, the integral of the j-th Lagrange polynomial from 0 to c_i. The weights are its last row.
    pub a: DMatrix<f64>,
    /// The values of the Lagrange polynomials at 0: they extrapolate the slope to the beginning of the step.
    pub at_begin: DVector<f64>,
    /// The reciprocal of the real eigenvalue of the inverse of a, by which the error estimate is damped (section IV.8).
    pub damping: f64,
}

/// Stages that there are methods of, with the real eigenvalue of the inverse of a. Three, of order 5, need more work at any tolerance.
const METHODS: [(usize, f64); 2] = [(5, 6.286_704_751_729_276), (7, 8.936_832_788_405_217)];

/// The method that takes the least work at this relative tolerance.
pub fn suited(rtol: f64) -> &'static Coefficients {
    /// From this tolerance on five stages.
    const ROUGH: f64 = 1e-7;
    static BOTH: LazyLock<[Coefficients; 2]> = LazyLock::new(|| METHODS.map(Coefficients::new));
    &BOTH[usize::from(rtol < ROUGH)]
}

impl Coefficients {
    fn new((stages, eigenvalue): (usize, f64)) -> Self {
        let c = places(stages);
        let a = DMatrix::from_fn(stages, stages, |i, j| {
            integral(c[i], |x| lagrange(c.as_slice(), j, x))
        });
        let at_begin = DVector::from_fn(stages, |j, _| lagrange(c.as_slice(), j, 0.0));
        Coefficients {
            c,
            a,
            at_begin,
            damping: 1.0 / eigenvalue,
        }
    }

    /// The number of stages.
    pub fn stages(&self) -> usize {
        self.c.len()
    }

    /// The weights of the stages in the polynomial through them and 0 at the beginning of the step, at this part of it.
    pub fn dense(&self, at: f64) -> DVector<f64> {
        let known: Vec<f64> = std::iter::once(0.0).chain(self.c.iter().copied()).collect();
        DVector::from_fn(self.stages(), |j, _| lagrange(&known, j + 1, at))
    }
}

/// The polynomial that is 1 at the j-th place and 0 at all others.
fn lagrange(places: &[f64], j: usize, x: f64) -> f64 {
    let others = places.iter().enumerate().filter(|(k, _)| *k != j);
    others
        .map(|(_, place)| (x - place) / (places[j] - place))
        .product()
}

/// The integral from 0 to `end` of a polynomial of degree 7 at most, by Gauss's rule of four places.
fn integral(end: f64, of: impl Fn(f64) -> f64) -> f64 {
    let rules = [(-1.0, 18.0 + 30_f64.sqrt()), (1.0, 18.0 - 30_f64.sqrt())];
    let half = 0.5 * end;
    let parts = rules.map(|(sign, weight)| {
        let aside = (3.0 / 7.0 + sign * 2.0 / 7.0 * 1.2_f64.sqrt()).sqrt();
        weight / 36.0 * (of(half * (1.0 - aside)) + of(half * (1.0 + aside)))
    });
    half * (parts[0] + parts[1])
}

/// The zeros of P_s - P_(s-1) on (-1, 1], shifted to (0, 1], by Newton's method.
fn places(stages: usize) -> DVector<f64> {
    const ITERATIONS: usize = 20;
    let count = (2 * stages - 1) as f64;
    let zero = |k: usize| {
        // Near the places of Chebyshev's polynomials.
        let mut x = (std::f64::consts::TAU * k as f64 / count).cos();
        for _ in 0..ITERATIONS {
            let (value, slope) = difference(stages, x);
            x -= value / slope;
        }
        0.5 * (1.0 + x)
    };
    let all = (1..stages).rev().map(zero).chain([1.0]);
    DVector::from_iterator(stages, all)
}

/// P_s - P_(s-1) and its derivative, by the recurrence of Legendre's polynomials.
fn difference(stages: usize, x: f64) -> (f64, f64) {
    let (mut before, mut now) = ((1.0, 0.0), (x, 1.0));
    for n in 1..stages {
        let n = n as f64;
        let next = |p: f64, before: f64| ((2.0 * n + 1.0) * p - n * before) / (n + 1.0);
        // The derivative of x P_n is P_n + x P_n'.
        let both = (next(x * now.0, before.0), next(now.0 + x * now.1, before.1));
        (before, now) = (now, both);
    }
    (now.0 - before.0, now.1 - before.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hairer & Wanner, table IV.5.6.
    #[test]
    fn three_stages_are_those_of_the_table() {
        let made = Coefficients::new((3, 3.637_834_252_744_496));
        let root = 6_f64.sqrt();
        let c = [(4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0];
        let a = [
            [
                (88.0 - 7.0 * root) / 360.0,
                (296.0 - 169.0 * root) / 1800.0,
                (-2.0 + 3.0 * root) / 225.0,
            ],
            [
                (296.0 + 169.0 * root) / 1800.0,
                (88.0 + 7.0 * root) / 360.0,
                (-2.0 - 3.0 * root) / 225.0,
            ],
            [(16.0 - root) / 36.0, (16.0 + root) / 36.0, 1.0 / 9.0],
        ];
        let a = DMatrix::from_fn(3, 3, |i, j| a[i][j]);
        assert!((made.c - DVector::from_column_slice(&c)).amax() < 1e-15);
        assert!((made.a - a).amax() < 1e-15);
    }

    /// The simplifying assumptions B(2s - 1) and C(s) of the order 2s - 1, and the eigenvalue.
    #[test]
    fn all_have_their_order() {
        for method in METHODS {
            let made = Coefficients::new(method);
            let s = made.stages();
            for k in 1..2 * s {
                let powers = made.c.map(|c| c.powi(k as i32 - 1));
                let quadrature = made.a.row(s - 1).transpose().dot(&powers);
                assert!((quadrature - 1.0 / k as f64).abs() < 1e-15, "{s} {k}");
                if k <= s {
                    let off = &made.a * powers - made.c.map(|c| c.powi(k as i32) / k as f64);
                    assert!(off.amax() < 1e-15, "{s} {k}");
                }
            }
            let inverse = made.a.clone().try_inverse().expect("regular");
            let shifted = inverse - DMatrix::identity(s, s) / made.damping;
            assert!(shifted.determinant().abs() < 1e-9 * method.1.powi(s as i32));
        }
    }
}
