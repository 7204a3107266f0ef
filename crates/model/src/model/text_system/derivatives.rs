//! Derivatives of the formulas of a system: along directions, in all variables and in parameters.

use super::TextSystem;
use crate::field::SecondDerivative;
use crate::number::{Jet, Real};

/// Directions in which derivatives are made at once.
const AT_ONCE: usize = 4;

impl TextSystem {
    /// The Jacobian, row by row, in numbers of any kind.
    pub fn jacobian<T: Real>(&self, x: &[T]) -> Vec<T> {
        let n = self.variables();
        let mut all = vec![T::constant(0.0); n * n];
        for first in (0..self.columns.count()).step_by(AT_ONCE) {
            let along = |(j, &value): (usize, &T)| {
                let seed = |lane: usize| T::constant(self.columns.seed(j, first + lane));
                Jet {
                    value,
                    gradient: std::array::from_fn::<T, AT_ONCE, _>(seed),
                }
            };
            let x: Vec<_> = x.iter().enumerate().map(along).collect();
            for (i, rate) in self.rates(&x).into_iter().enumerate() {
                for &(group, j) in self.columns.row(i) {
                    if let Some(slope) = group.checked_sub(first).and_then(|k| rate.gradient.get(k))
                    {
                        all[i * n + j] = *slope;
                    }
                }
            }
        }
        all
    }

    /// The rates and their first three derivatives in the last variable, in the others held fixed: by time, where that is one.
    ///
    /// # Panics
    /// As of [`TextSystem::rates`].
    pub fn derivatives_in_last(&self, x: &[f64]) -> [Vec<f64>; 4] {
        type Third = Jet<Jet<Jet<f64, 1>, 1>, 1>;
        let mut all: Vec<Third> = x.iter().map(|&x| Third::constant(x)).collect();
        if let (Some(last), Some(&x)) = (all.last_mut(), x.last()) {
            let [x] = Jet::variables([x]);
            let [x] = Jet::variables([x]);
            [*last] = Jet::variables([x]);
        }
        let rates = self.rates(&all);
        let of = |part: fn(&Third) -> f64| rates.iter().map(part).collect();
        [
            of(|f| f.value.value.value),
            of(|f| f.gradient[0].value.value),
            of(|f| f.gradient[0].gradient[0].value),
            of(|f| f.gradient[0].gradient[0].gradient[0]),
        ]
    }

    pub(super) fn second_derivative(&self, [y, u, v]: [&[f64]; 3]) -> Vec<f64> {
        // f(y + a u + b v), differentiated in a and in b.
        let of = |i: usize| Jet {
            value: with_slope(y[i], u[i]),
            gradient: [with_slope(v[i], 0.0)],
        };
        let x: Vec<_> = (0..self.variables()).map(of).collect();
        let rates = self.rates(&x).into_iter();
        rates.map(|f| f.gradient[0].gradient[0]).collect()
    }

    /// The rates along a curve, as power series to the fifth order. With five numbers whose squares are 0 the k-th power of their sum is k! times the sum of
    /// all products of k of them.
    pub(super) fn series_along(&self, curve: [&[f64]; 6]) -> [Vec<f64>; 6] {
        const FACTORIALS: [f64; 6] = [1.0, 1.0, 2.0, 6.0, 24.0, 120.0];
        let at = |i: usize| {
            let of = |k: usize| FACTORIALS[k] * curve[k][i];
            let one = |k: usize| with_slope(of(k), of(k + 1));
            let two = |k: usize| with_slope(one(k), one(k + 1));
            let three = |k: usize| with_slope(two(k), two(k + 1));
            let four = |k: usize| with_slope(three(k), three(k + 1));
            with_slope(four(0), four(1))
        };
        let x: Vec<_> = (0..self.variables()).map(at).collect();
        let rates = self.rates(&x);
        let of = |k: usize, f: fn(&FifthJet) -> f64| -> Vec<f64> {
            rates.iter().map(|rate| f(rate) / FACTORIALS[k]).collect()
        };
        [
            of(0, |f| f.value.value.value.value.value),
            of(1, |f| f.gradient[0].value.value.value.value),
            of(2, |f| f.gradient[0].gradient[0].value.value.value),
            of(3, |f| f.gradient[0].gradient[0].gradient[0].value.value),
            of(4, |f| {
                f.gradient[0].gradient[0].gradient[0].gradient[0].value
            }),
            of(5, |f| {
                f.gradient[0].gradient[0].gradient[0].gradient[0].gradient[0]
            }),
        ]
    }

    pub(super) fn parameter_derivative(&self, y: &[f64], place: usize) -> Vec<f64> {
        let x: Vec<_> = y.iter().map(|&y| with_slope(y, 0.0)).collect();
        let along = |(q, &p): (usize, &f64)| with_slope(p, f64::from(u8::from(q == place)));
        let parameters: Vec<_> = self.parameters.iter().enumerate().map(along).collect();
        let rates = self.rates.evaluate(&x, &parameters).into_iter();
        rates.map(|f| f.gradient[0]).collect()
    }

    /// All second derivatives of the rates that the formulas don't show to be zero.
    pub(super) fn second_derivatives(&self, y: &[f64]) -> Vec<SecondDerivative> {
        let (n, groups) = (self.variables(), self.columns.count());
        let mut all = Vec::new();
        for (a, b) in (0..groups).flat_map(|a| (a..groups).map(move |b| (a, b))) {
            let [u, v] = [a, b]
                .map(|group| -> Vec<f64> { (0..n).map(|j| self.columns.seed(j, group)).collect() });
            let values = self.second_derivative([y, &u, &v]);
            for (of, value) in values.into_iter().enumerate() {
                let variable = |group: usize| {
                    let mut row = self.columns.row(of).iter();
                    row.find(|entry| entry.0 == group).map(|entry| entry.1)
                };
                if let (Some(i), Some(j)) = (variable(a), variable(b)) {
                    all.push(SecondDerivative {
                        of,
                        by: [i, j],
                        value,
                    });
                }
            }
        }
        all
    }

    /// The derivative of the Jacobian in a parameter, row by row.
    pub(super) fn parameter_jacobian(&self, y: &[f64], place: usize) -> Vec<f64> {
        let fixed = |value: Jet<f64, 1>| Jet {
            value,
            gradient: [with_slope(0.0, 0.0)],
        };
        let beside = |(q, &p): (usize, &f64)| Jet {
            value: with_slope(p, 0.0),
            gradient: [with_slope(f64::from(u8::from(q == place)), 0.0)],
        };
        let parameters: Vec<_> = self.parameters.iter().enumerate().map(beside).collect();
        let n = self.variables();
        let mut all = vec![0.0; n * n];
        for group in 0..self.columns.count() {
            let along = |(j, &y): (usize, &f64)| fixed(with_slope(y, self.columns.seed(j, group)));
            let x: Vec<_> = y.iter().enumerate().map(along).collect();
            let rates = self.rates.evaluate(&x, &parameters);
            for (i, rate) in rates.iter().enumerate() {
                for &(_, j) in self.columns.row(i).iter().filter(|entry| entry.0 == group) {
                    all[i * n + j] = rate.gradient[0].gradient[0];
                }
            }
        }
        all
    }
}

/// A number with its derivative in a direction, or in one more.
fn with_slope<T>(value: T, slope: T) -> Jet<T, 1> {
    Jet {
        value,
        gradient: [slope],
    }
}

/// With derivatives in five directions.
type FifthJet = Jet<Jet<Jet<Jet<Jet<f64, 1>, 1>, 1>, 1>, 1>;
