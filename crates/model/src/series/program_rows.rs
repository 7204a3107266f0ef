//! The rows of a [`Program`], and how its operations fill them: the recurrences of [`super::tape`], in loops.

use super::element::Element;
use super::program::{Instruction, Operation, Program, Source};
use crate::number::{Balance, DoubleDouble};

/// The rows of a program: the coefficients of each, one after the other.
#[derive(Debug, Clone)]
pub(super) struct ProgramRows<T> {
    coefficients: Vec<T>,
    /// Coefficients that a row has room for.
    room: usize,
    /// 1/k for every order k.
    inverses: Vec<DoubleDouble>,
    any: T,
}

impl<T: Element> ProgramRows<T> {
    /// With room for these; `any` is any number.
    pub fn new(program: &Program, room: usize, any: T) -> Self {
        ProgramRows {
            coefficients: vec![any.like(0.0); program.rows() * room],
            room,
            inverses: (0..room)
                .map(|k| DoubleDouble::from(1.0) / k as f64)
                .collect(),
            any,
        }
    }

    /// 1/k
    pub fn one_over(&self, k: usize) -> DoubleDouble {
        self.inverses[k]
    }

    /// The coefficients of a row.
    pub fn row(&self, row: usize) -> &[T] {
        &self.coefficients[row * self.room..][..self.room]
    }

    /// Puts down the k-th coefficient of a row.
    pub fn set(&mut self, row: usize, k: usize, x: T) {
        self.coefficients[row * self.room + k] = x;
    }

    fn get(&self, row: usize, k: usize) -> T {
        self.coefficients[row * self.room + k]
    }

    /// The k-th coefficient of a quantity.
    pub fn coefficient(&self, of: Source, k: usize) -> T {
        match of {
            Source::Row(row) => self.get(row, k),
            Source::Number(x) if k == 0 => self.any.like_exact(x),
            Source::Number(_) => self.any.like(0.0),
        }
    }

    /// sum of a_j b_(k-j) over `from` <= j < `to`.
    fn convolution(&self, a: usize, b: usize, k: usize, (from, to): (usize, usize)) -> T {
        let zero = self.any.like(0.0);
        if from >= to {
            return zero;
        }
        let a = &self.row(a)[from..to];
        let b = &self.row(b)[k + 1 - to..=k - from];
        inner_product(a, b, zero)
    }

    /// The k-th coefficients of all rows but those of the variables, from those up to the k-th of these.
    pub fn level(&mut self, program: &Program, k: usize) {
        for instruction in program.instructions() {
            self.carry_out(instruction, k);
        }
    }

    fn carry_out(&mut self, instruction: &Instruction, k: usize) {
        let Instruction {
            operation,
            result,
            spare,
        } = *instruction;
        let any = self.any;
        let new = match operation {
            Operation::Sum(a, b) => self.get(a, k) + self.get(b, k),
            Operation::Difference(a, b) => self.get(a, k) - self.get(b, k),
            Operation::Negative(a) => -self.get(a, k),
            Operation::Shifted(a, x) if k == 0 => self.get(a, 0) + any.like_exact(x),
            Operation::Shifted(a, _) => self.get(a, k),
            Operation::Complement(x, a) if k == 0 => any.like_exact(x) - self.get(a, 0),
            Operation::Complement(_, a) => -self.get(a, k),
            Operation::Scaled(a, x) => self.get(a, k).scale(x),
            Operation::Over(a, x) => self.get(a, k) / any.like_exact(x),
            Operation::Product(a, b) => self.convolution(a, b, k, (0, k + 1)),
            Operation::Quotient(a, b) => {
                // b_0 q_k = a_k - sum of q_j b_(k-j) over j < k
                let a = self.coefficient(a, k);
                if k == 0 {
                    self.set(spare, 0, any.like(1.0) / self.get(b, 0));
                    a / self.get(b, 0)
                } else {
                    (a - self.convolution(result, b, k, (0, k))) * self.get(spare, 0)
                }
            }
            Operation::Exponential(a) => {
                // k e_k = sum of j a_j e_(k-j) over 0 < j <= k
                self.slope(a, spare, k);
                if k == 0 {
                    self.get(a, 0).exp()
                } else {
                    self.convolution(spare, result, k, (1, k + 1))
                        .scale(self.one_over(k))
                }
            }
            Operation::ExponentialLessOne(a, _) if k == 0 => self.get(a, 0).exp_m1(),
            Operation::ExponentialLessOne(_, whole) => self.get(whole, k),
            Operation::Logarithm(a) => {
                // a_0 k l_k = k a_k - sum of j l_j a_(k-j) over 0 < j < k
                if k == 0 {
                    self.set(spare, 0, any.like(1.0) / self.get(a, 0));
                    self.get(a, 0).ln()
                } else {
                    let sum = self
                        .convolution(spare, a, k, (1, k))
                        .scale(self.one_over(k));
                    let new = (self.get(a, k) - sum) * self.get(spare, 0);
                    self.set(spare, k, new.scale(DoubleDouble::from(k as f64)));
                    new
                }
            }
            Operation::LogarithmOfOneMore(a, _) if k == 0 => self.get(a, 0).ln_1p(),
            Operation::LogarithmOfOneMore(_, whole) => self.get(whole, k),
            Operation::Hyperbolic(a, cosh) => {
                // k s_k = sum of j a_j c_(k-j), k c_k = sum of j a_j s_(k-j) over 0 < j <= k
                self.slope(a, spare, k);
                if k == 0 {
                    let (s, c) = self.get(a, 0).sinh_cosh();
                    self.set(cosh, 0, c);
                    s
                } else {
                    let one_over = self.one_over(k);
                    let c = self
                        .convolution(spare, result, k, (1, k + 1))
                        .scale(one_over);
                    let s = self.convolution(spare, cosh, k, (1, k + 1)).scale(one_over);
                    self.set(cosh, k, c);
                    s
                }
            }
            Operation::Circular(a, cos) => {
                // k s_k = sum of j a_j c_(k-j), k c_k = -sum of j a_j s_(k-j) over 0 < j <= k
                self.slope(a, spare, k);
                if k == 0 {
                    let (s, c) = self.get(a, 0).sin_cos();
                    self.set(cos, 0, c);
                    s
                } else {
                    let one_over = self.one_over(k);
                    let c = self.convolution(spare, result, k, (1, k + 1));
                    let s = self.convolution(spare, cos, k, (1, k + 1));
                    self.set(cos, k, c.scale(-one_over));
                    s.scale(one_over)
                }
            }
            Operation::Arctangent(a, u) | Operation::InverseHyperbolicSine(a, u) => {
                // y' = a' / u: u_0 k y_k = k a_k - sum of j y_j u_(k-j) over 0 < j < k
                if k == 0 {
                    self.set(spare, 0, any.like(1.0) / self.get(u, 0));
                    match operation {
                        Operation::Arctangent(..) => self.get(a, 0).atan(),
                        _ => self.get(a, 0).asinh(),
                    }
                } else {
                    let sum = self
                        .convolution(spare, u, k, (1, k))
                        .scale(self.one_over(k));
                    let new = (self.get(a, k) - sum) * self.get(spare, 0);
                    self.set(spare, k, new.scale(DoubleDouble::from(k as f64)));
                    new
                }
            }
            Operation::HyperbolicTangent(a, u) => {
                // k y_k = sum of j a_j u_(k-j) over 0 < j <= k, u_k = -sum of y_j y_(k-j) over 0 <= j <= k
                self.slope(a, spare, k);
                if k == 0 {
                    let y = self.get(a, 0).tanh();
                    self.set(u, 0, any.like(1.0) - y * y);
                    y
                } else {
                    let y = self
                        .convolution(spare, u, k, (1, k + 1))
                        .scale(self.one_over(k));
                    let first = self.get(result, 0);
                    let squared = self.convolution(result, result, k, (1, k));
                    self.set(u, k, -(first + first).mul_add(y, squared));
                    y
                }
            }
            Operation::Power(a, p) => self.power(a, p, (result, spare), k),
            Operation::Sign(a) if k == 0 => self.get(a, 0).sign(),
            Operation::Sign(_) => any.like(0.0),
            Operation::Signed(a, b) => self.get(a, k) * self.get(b, 0).sign(),
            Operation::Balanced(a, g) => self.balanced(a, g, (result, spare), k),
        };
        self.set(result, k, new);
    }

    /// y = a^p: k a_0 y_k = sum of (p (k-j) - j) a_(k-j) y_j over 0 <= j < k
    ///                     = p k sum a_(k-j) y_j - (1+p) sum a_(k-j) j y_j.
    fn power(&mut self, a: usize, p: f64, (y, slopes): (usize, usize), k: usize) -> T {
        let any = self.any;
        if k == 0 {
            self.set(slopes, 0, any.like(1.0) / self.get(a, 0));
            return self.get(a, 0).powf(p);
        }
        let one_and_p = DoubleDouble::of_finite(1.0, p) * self.one_over(k);
        let plain = self
            .convolution(y, a, k, (0, k))
            .scale(DoubleDouble::from(p));
        let weighted = self.convolution(slopes, a, k, (1, k)).scale(one_and_p);
        let new = (plain - weighted) * self.get(slopes, 0);
        self.set(slopes, k, new.scale(DoubleDouble::from(k as f64)));
        new
    }

    /// y + g(y) = x, as the recurrence of [`super::tape`]'s rows has it.
    fn balanced(
        &mut self,
        x: Source,
        g: Balance<Source>,
        (y, slopes): (usize, usize),
        k: usize,
    ) -> T {
        let [e, f, steepness, of_a, of_b, of_y] = [6, 5, 4, 3, 2, 1].map(|before| y - before);
        let newest = self.coefficient(x, k);
        if k == 0 {
            let coefficients = g.map(|c| self.coefficient(c, 0));
            let (first, value) = newest.balanced(coefficients);
            let (rising, falling) = match g {
                Balance::Sinh(_) => first.sinh_cosh(),
                _ => (first.exp(), (-first).exp()),
            };
            let (slope, counts) = match coefficients {
                Balance::Exponential(a) => (a * rising, [rising, falling]),
                Balance::Sinh(a) => (a * falling, [rising, falling]),
                Balance::Difference(a, b) => (
                    a * rising + b * falling,
                    [first.exp_m1(), (-first).exp_m1()],
                ),
            };
            let one = self.any.like(1.0);
            let all = [
                (e, rising),
                (f, falling),
                (steepness, slope),
                (of_a, counts[0]),
                (of_b, counts[1]),
                (of_y, value),
            ];
            for (row, x) in all {
                self.set(row, 0, x);
            }
            self.set(slopes, 0, one / (one + slope));
            return first;
        }
        let one_over = self.one_over(k);
        let of_e = self.convolution(slopes, e, k, (1, k)).scale(one_over);
        let of_f = self.convolution(slopes, f, k, (1, k)).scale(one_over);
        // what is known of the newest coefficient of a product
        let known = |a: Source, of: usize, newest: T, first: T| match a {
            Source::Row(row) => {
                let sum = self.convolution(row, of, k, (1, k)) + self.get(row, k) * first;
                self.get(row, 0).mul_add(newest, sum)
            }
            Source::Number(x) => newest.scale(x),
        };
        let [of_a, of_b] = [of_a, of_b].map(|row| self.get(row, 0));
        let (rest, of_e, of_f) = match g {
            Balance::Exponential(a) => (known(a, e, of_e, of_a), of_e, of_f),
            Balance::Sinh(a) => (known(a, e, of_f, of_a), of_f, of_e),
            Balance::Difference(a, b) => {
                let falling = known(b, f, -of_f, of_b);
                (known(a, e, of_e, of_a) - falling, of_e, -of_f)
            }
        };
        let (first_e, first_f) = (self.get(e, 0), self.get(f, 0));
        let (counts_e, counts_f) = match g {
            Balance::Sinh(_) => (first_f, first_e),
            _ => (first_e, -first_f),
        };
        let one_over = self.get(slopes, 0);
        let new = (newest - rest) * one_over;
        self.set(of_y, k, (newest * self.get(steepness, 0) + rest) * one_over);
        self.set(e, k, new.mul_add(counts_e, of_e));
        self.set(f, k, new.mul_add(counts_f, of_f));
        self.set(slopes, k, new.scale(DoubleDouble::from(k as f64)));
        new
    }

    /// j a_j
    fn slope(&mut self, a: usize, slopes: usize, k: usize) {
        let new = self.get(a, k).scale(DoubleDouble::from(k as f64));
        self.set(slopes, k, new);
    }
}

/// sum of a_j b_(n-1-j) over j < n, n being the length of both. With four sums side by side: one or two would wait for each
/// other.
pub(super) fn inner_product<T: Element>(a: &[T], b: &[T], zero: T) -> T {
    let sums = T::four_sums(a, b).unwrap_or_else(|| four_sums(a, b, zero));
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

fn four_sums<T: Element>(a: &[T], b: &[T], zero: T) -> [T; 4] {
    let mut sums = [zero; 4];
    let mut left = a.chunks_exact(4);
    let mut right = b.rchunks_exact(4);
    for (a, b) in left.by_ref().zip(right.by_ref()) {
        for i in 0..4 {
            sums[i] = a[i].mul_add(b[3 - i], sums[i]);
        }
    }
    let rest = left.remainder().iter().zip(right.remainder().iter().rev());
    for (sum, (a, b)) in sums.iter_mut().zip(rest) {
        *sum = a.mul_add(*b, *sum);
    }
    sums
}
