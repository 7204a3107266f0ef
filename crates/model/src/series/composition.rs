//! The series of a function of a series, from the function's coefficients at the first one: for functions that no recurrence yields
//! with all digits.

use super::element::Element;
use crate::number::{Numerator, Ratio};

/// The first coefficients of a ratio around x.
pub(super) fn ratio_coefficients<E: Element>(ratio: Ratio, x: E, count: usize) -> Vec<E> {
    if E::LANES == 1 {
        return ratio.coefficients(
            (x, x.first()),
            numerator(ratio.numerator, x),
            |c| x.like(c),
            count,
        );
    }
    // In each lane another end may be the one to begin at.
    let mut all = vec![x; count];
    for i in 0..E::LANES {
        let lane = x.lane(i);
        let of_lane =
            ratio.coefficients((lane, lane), numerator(ratio.numerator, lane), |c| c, count);
        for (all, c) in all.iter_mut().zip(of_lane) {
            *all = all.with_lane(i, c);
        }
    }
    all
}

/// N(x) and N'(x).
fn numerator<E: Element>(numerator: Numerator, x: E) -> [E; 2] {
    let one = x.like(1.0);
    match numerator {
        Numerator::ExpM1 => [x.exp_m1(), x.exp()],
        Numerator::Sin => x.sin_cos().into(),
        Numerator::Sinh => x.sinh_cosh().into(),
        Numerator::Tanh => {
            // As of Numerator::slope.
            let e = (-(x.abs() + x.abs())).exp();
            let whole = e + one;
            [x.tanh(), x.like(4.0) * e / (whole * whole)]
        }
        Numerator::Ln1p => [x.ln_1p(), one / (x + one)],
    }
}

/// The sum of c_m d^m, d being a series without its first coefficient.
#[derive(Debug, Clone)]
pub(super) struct Composition<T> {
    room: usize,
    coefficients: Vec<T>,
    /// d, d^2, ... one after the other.
    powers: Vec<T>,
}

impl<T: Element> Composition<T> {
    /// With room for so many coefficients; `any` is any number.
    pub fn new(any: T, room: usize) -> Self {
        Composition {
            room,
            coefficients: vec![any.like(0.0); room],
            powers: vec![any.like(0.0); room * room],
        }
    }

    /// Begins where the series has this first coefficient.
    pub fn begin(&mut self, ratio: Ratio, first: T) {
        self.coefficients = ratio_coefficients(ratio, first, self.room);
    }

    /// The coefficients of the function.
    pub fn coefficients(&self) -> &[T] {
        &self.coefficients
    }

    /// The next coefficient, from those of the series before the newest and that; orders follow each other.
    #[inline(always)]
    pub fn next(&mut self, older: &[T], newest: T) -> T {
        let k = older.len();
        self.powers[k] = newest;
        let mut sum = self.coefficients[1] * newest;
        for m in 2..=k {
            let (below, above) = self.powers.split_at_mut((m - 1) * self.room);
            let below = &below[(m - 2) * self.room..];
            let mut power = newest.like(0.0);
            // d has no first coefficient, and d^(m-1) none before the (m-1)-th.
            for j in 1..=k + 1 - m {
                power = older[j].mul_add(below[k - j], power);
            }
            above[k] = power;
            sum = self.coefficients[m].mul_add(power, sum);
        }
        sum
    }
}
