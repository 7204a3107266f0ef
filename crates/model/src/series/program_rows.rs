//! The rows of a [`Program`], and how its operations fill them: the recurrences of [`super::tape`], in loops.

use super::element::Element;
use super::later::Later;
use super::products::{inner_product, inner_products};
use super::program::{Instruction, Operation, Program, Source};
use crate::number::{Balance, DoubleDouble};

/// The rows of a program: the coefficients of each, one after the other.
#[derive(Debug, Clone)]
pub(super) struct ProgramRows<T> {
    coefficients: Vec<T>,
    /// For every row a number that its operation needs at all orders.
    aside: Vec<T>,
    /// Coefficients that a row has room for.
    room: usize,
    /// 1/k for every order k.
    inverses: Vec<DoubleDouble>,
    /// The factors of the terms of later orders, with their signs as they are here.
    factors: Vec<T>,
    any: T,
}

impl<T: Element> ProgramRows<T> {
    /// With room for these; `any` is any number.
    pub fn new(program: &Program, room: usize, any: T) -> Self {
        ProgramRows {
            coefficients: vec![any.like(0.0); program.rows() * room],
            aside: vec![any.like(0.0); program.rows()],
            room,
            inverses: (0..room)
                .map(|k| DoubleDouble::from(1.0) / k as f64)
                .collect(),
            factors: (program.later.terms.iter())
                .map(|term| any.like_exact(term.factor))
                .collect(),
            any,
        }
    }

    /// 1/k
    #[inline(always)]
    pub fn one_over(&self, k: usize) -> DoubleDouble {
        self.inverses[k]
    }

    /// The coefficients of a row.
    #[inline(always)]
    pub fn row(&self, row: usize) -> &[T] {
        &self.coefficients[row * self.room..][..self.room]
    }

    /// Puts down the k-th coefficient of a row.
    #[inline(always)]
    pub fn set(&mut self, row: usize, k: usize, x: T) {
        self.coefficients[row * self.room + k] = x;
    }

    #[inline(always)]
    fn get(&self, row: usize, k: usize) -> T {
        self.coefficients[row * self.room + k]
    }

    /// The k-th coefficient of a quantity.
    #[inline(always)]
    pub fn coefficient(&self, of: Source, k: usize) -> T {
        match of {
            Source::Row(row) => self.get(row, k),
            Source::Number(x) if k == 0 => self.any.like_exact(x),
            Source::Number(_) => self.any.like(0.0),
        }
    }

    /// sum of a_j b_(k-j) over 0 < j < k: what no operation of this order has part in. So it need not wait for any, and what is added of
    /// the newest coefficients takes little time.
    #[inline(always)]
    fn inner(&self, a: usize, b: usize, k: usize) -> T {
        inner_product(&self.row(a)[1..k], &self.row(b)[1..k], self.any.like(0.0))
    }

    /// The same of two rows b: side by side, as the a_j are the same.
    #[inline(always)]
    fn inners(&self, a: usize, [b, c]: [usize; 2], k: usize) -> [T; 2] {
        let both = [&self.row(b)[1..k], &self.row(c)[1..k]];
        inner_products(&self.row(a)[1..k], both, self.any.like(0.0))
    }

    /// The k-th coefficients of all rows but those of the variables, from those up to the k-th of these.
    #[inline(always)]
    pub fn level(&mut self, program: &Program, k: usize) {
        if k == 0 {
            self.first_level(program);
            return;
        }
        for later in &program.later.all {
            match later {
                Later::Sum { from, to, result } => {
                    let mut sum = self.any.like(0.0);
                    let terms = &program.later.terms[*from..*to];
                    for (term, factor) in terms.iter().zip(&self.factors[*from..*to]) {
                        let x = self.get(term.row, k);
                        let x = match term.lane {
                            Some(lane) => self.any.like(x.lane(lane)),
                            None => x,
                        };
                        sum = x.mul_add(*factor, sum);
                    }
                    self.set(*result, k, sum);
                }
                Later::Other(instruction) => self.carry_out(instruction, k),
            }
        }
    }

    /// The first coefficients, and the signs that hold for all others.
    #[inline(always)]
    fn first_level(&mut self, program: &Program) {
        for instruction in program.instructions() {
            self.carry_out(instruction, 0);
        }
        for (i, term) in program.later.terms.iter().enumerate() {
            if let Some(row) = term.sign {
                self.factors[i] = self.any.like_exact(term.factor) * self.get(row, 0).sign();
            }
        }
    }

    #[inline(always)]
    fn carry_out(&mut self, instruction: &Instruction, k: usize) {
        let Instruction {
            operation,
            result,
            spare,
        } = *instruction;
        let any = self.any;
        let new = match operation {
            Operation::Lane(a, lane) => any.like(self.get(a, k).lane(lane)),
            Operation::Sum(a, b) => self.get(a, k) + self.get(b, k),
            Operation::Difference(a, b) => self.get(a, k) - self.get(b, k),
            Operation::Negative(a) => -self.get(a, k),
            Operation::Shifted(a, x) if k == 0 => self.get(a, 0) + any.like_exact(x),
            Operation::Shifted(a, _) => self.get(a, k),
            Operation::Complement(x, a) if k == 0 => any.like_exact(x) - self.get(a, 0),
            Operation::Complement(_, a) => -self.get(a, k),
            Operation::Scaled(a, x) => self.get(a, k).scale(x),
            Operation::Over(a, x) => self.get(a, k) / any.like_exact(x),
            Operation::Product(a, b) if k == 0 => self.get(a, 0) * self.get(b, 0),
            Operation::Product(a, b) => {
                let sum = self.get(a, 0).mul_add(self.get(b, k), self.inner(a, b, k));
                self.get(a, k).mul_add(self.get(b, 0), sum)
            }
            Operation::Quotient(a, b) => {
                // b_0 q_k = a_k - q_0 b_k - sum of q_j b_(k-j) over 0 < j < k
                let a = self.coefficient(a, k);
                if k == 0 {
                    self.aside[result] = any.like(1.0) / self.get(b, 0);
                    a / self.get(b, 0)
                } else {
                    // The difference first: where b_0 is tiny it may cancel to the last digit.
                    let rest = a - self.inner(result, b, k);
                    let by_newest = -self.get(result, 0);
                    by_newest.mul_add(self.get(b, k), rest) * self.aside[result]
                }
            }
            Operation::Exponential(a) => {
                // k e_k = k a_k e_0 + sum of j a_j e_(k-j) over 0 < j < k
                self.slope(a, spare, k);
                if k == 0 {
                    self.get(a, 0).exp()
                } else {
                    let older = self.inner(spare, result, k).scale(self.one_over(k));
                    self.get(a, k).mul_add(self.get(result, 0), older)
                }
            }
            Operation::ExponentialLessOne(a, _) if k == 0 => self.get(a, 0).exp_m1(),
            Operation::ExponentialLessOne(_, whole) => self.get(whole, k),
            Operation::Logarithm(a) => {
                // a_0 k l_k = k a_k - sum of j l_j a_(k-j) over 0 < j < k
                if k == 0 {
                    self.aside[result] = any.like(1.0) / self.get(a, 0);
                    self.get(a, 0).ln()
                } else {
                    self.of_slopes(a, (a, result, spare), k)
                }
            }
            Operation::LogarithmOfOneMore(a, _) if k == 0 => self.get(a, 0).ln_1p(),
            Operation::LogarithmOfOneMore(_, whole) => self.get(whole, k),
            Operation::Hyperbolic(a, cosh) => {
                // k s_k = k a_k c_0 + sum of j a_j c_(k-j), k c_k = k a_k s_0 + sum of j a_j s_(k-j) over 0 < j < k
                self.slope(a, spare, k);
                if k == 0 {
                    let (s, c) = self.get(a, 0).sinh_cosh();
                    self.set(cosh, 0, c);
                    s
                } else {
                    let (s, c) = self.of_both(a, (result, cosh, spare), k);
                    self.set(cosh, k, c);
                    s
                }
            }
            Operation::Circular(a, cos) => {
                // The same but for the sign of c_k
                self.slope(a, spare, k);
                if k == 0 {
                    let (s, c) = self.get(a, 0).sin_cos();
                    self.set(cos, 0, c);
                    s
                } else {
                    let (s, c) = self.of_both(a, (result, cos, spare), k);
                    self.set(cos, k, -c);
                    s
                }
            }
            Operation::Arctangent(a, u) | Operation::InverseHyperbolicSine(a, u) => {
                // y' = a' / u: u_0 k y_k = k a_k - sum of j y_j u_(k-j) over 0 < j < k
                if k == 0 {
                    self.aside[result] = any.like(1.0) / self.get(u, 0);
                    match operation {
                        Operation::Arctangent(..) => self.get(a, 0).atan(),
                        _ => self.get(a, 0).asinh(),
                    }
                } else {
                    self.of_slopes(a, (u, result, spare), k)
                }
            }
            Operation::HyperbolicTangent(a, u) => {
                // k y_k = k a_k u_0 + sum of j a_j u_(k-j) over 0 < j < k, u_k = -sum of y_j y_(k-j) over 0 <= j <= k
                self.slope(a, spare, k);
                if k == 0 {
                    let y = self.get(a, 0).tanh();
                    self.set(u, 0, any.like(1.0) - y * y);
                    y
                } else {
                    let older = self.inner(spare, u, k).scale(self.one_over(k));
                    let y = self.get(a, k).mul_add(self.get(u, 0), older);
                    let first = self.get(result, 0);
                    let squared = self.inner(result, result, k);
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

    /// (k a_k - sum of s_j u_(k-j) over 0 < j < k) / (k u_0), with s_j = j y_j, of y' = a' / u.
    #[inline(always)]
    fn of_slopes(&mut self, a: usize, (u, y, slopes): (usize, usize, usize), k: usize) -> T {
        let older = self.inner(slopes, u, k).scale(self.one_over(k));
        let new = (self.get(a, k) - older) * self.aside[y];
        self.set(slopes, k, new.scale(DoubleDouble::from(k as f64)));
        new
    }

    /// a_k c_0 + (sum of j a_j c_(k-j) over 0 < j < k) / k, and the same of s.
    #[inline(always)]
    fn of_both(&self, a: usize, (s, c, slopes): (usize, usize, usize), k: usize) -> (T, T) {
        let older = self.inners(slopes, [c, s], k);
        let [by_c, by_s] = older.map(|sum| sum.scale(self.one_over(k)));
        let newest = self.get(a, k);
        (
            newest.mul_add(self.get(c, 0), by_c),
            newest.mul_add(self.get(s, 0), by_s),
        )
    }

    /// y = a^p: k a_0 y_k = sum of (p (k-j) - j) a_(k-j) y_j over 0 <= j < k
    ///                     = p k a_k y_0 + p k sum a_(k-j) y_j - (1+p) sum a_(k-j) j y_j over 0 < j < k.
    #[inline(always)]
    fn power(&mut self, a: usize, p: f64, (y, slopes): (usize, usize), k: usize) -> T {
        let any = self.any;
        if k == 0 {
            self.aside[y] = any.like(1.0) / self.get(a, 0);
            return self.get(a, 0).powf(p);
        }
        let one_and_p = DoubleDouble::of_finite(1.0, p);
        let p = DoubleDouble::from(p);
        let [plain, weighted] = self.inners(a, [y, slopes], k);
        let weighted = weighted.scale(one_and_p).scale(self.one_over(k));
        let by_newest = self.get(y, 0).scale(p);
        let rest = plain.scale(p) - weighted;
        let new = self.get(a, k).mul_add(by_newest, rest) * self.aside[y];
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
            self.aside[y] = one / (one + slope);
            return first;
        }
        let one_over = self.one_over(k);
        let [of_e, of_f] = self.inners(slopes, [e, f], k);
        let (of_e, of_f) = (of_e.scale(one_over), of_f.scale(one_over));
        // what is known of the newest coefficient of a product
        let known = |a: Source, of: usize, newest: T, first: T| match a {
            Source::Row(row) => {
                let sum = self.inner(row, of, k) + self.get(row, k) * first;
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
        let one_over = self.aside[y];
        let new = (newest - rest) * one_over;
        self.set(of_y, k, (newest * self.get(steepness, 0) + rest) * one_over);
        self.set(e, k, new.mul_add(counts_e, of_e));
        self.set(f, k, new.mul_add(counts_f, of_f));
        self.set(slopes, k, new.scale(DoubleDouble::from(k as f64)));
        new
    }

    /// j a_j
    #[inline(always)]
    fn slope(&mut self, a: usize, slopes: usize, k: usize) {
        let new = self.get(a, k).scale(DoubleDouble::from(k as f64));
        self.set(slopes, k, new);
    }
}
