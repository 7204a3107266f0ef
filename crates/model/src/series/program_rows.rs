//! The rows of a [`Program`], and how its operations fill them: the recurrences of [`super::tape`], in loops.

use super::element::Element;
use super::placed::{OlderSums, PlacedInstruction, PlacedLater, PlacedTerm};
use super::products::{inner_product, inner_products};
use super::program::{Operation, Program, Source};
use crate::number::{Balance, DoubleDouble};

/// The rows of a program: the coefficients of each, one after the other, and after these a number that its operation needs at all
/// orders.
#[derive(Debug, Clone)]
pub(super) struct ProgramRows<T> {
    coefficients: Vec<T>,
    /// Coefficients that a row has room for.
    room: usize,
    /// 1/k for every order k.
    inverses: Vec<DoubleDouble>,
    /// The operations of the first order and of all later ones; rows are where they begin among the coefficients.
    first: Vec<PlacedInstruction>,
    later: Vec<PlacedLater>,
    terms: Vec<PlacedTerm<T>>,
    any: T,
}

impl<T: Element> ProgramRows<T> {
    /// With room for these; `any` is any number.
    pub fn new(program: &Program, room: usize, any: T) -> Self {
        let place = |row: usize| row * (room + 1);
        let placed = |one| PlacedInstruction::new(one, place);
        let later = program.later.all.iter();
        let terms = program.later.terms.iter();
        ProgramRows {
            coefficients: vec![any.like(0.0); place(program.rows())],
            room,
            inverses: (0..room)
                .map(|k| DoubleDouble::from(1.0) / k as f64)
                .collect(),
            first: program.instructions().iter().map(placed).collect(),
            later: later.map(|later| PlacedLater::new(later, place)).collect(),
            terms: terms
                .map(|term| PlacedTerm::new(term, place, any))
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
        &self.coefficients[row * (self.room + 1)..][..self.room]
    }

    /// Puts down the k-th coefficient of a row.
    #[inline(always)]
    pub fn set(&mut self, row: usize, k: usize, x: T) {
        self.coefficients[row * (self.room + 1) + k] = x;
    }

    /// The k-th coefficient of a quantity.
    #[inline(always)]
    pub fn coefficient(&self, of: Source, k: usize) -> T {
        match of {
            Source::Row(row) => self.coefficients[row * (self.room + 1) + k],
            Source::Number(x) if k == 0 => self.any.like_exact(x),
            Source::Number(_) => self.any.like(0.0),
        }
    }

    /// The k-th coefficients of all rows but those of the variables, from those up to the k-th of these.
    #[inline(always)]
    pub fn level(&mut self, k: usize) {
        let mut level = Level {
            coefficients: &mut self.coefficients,
            room: self.room,
            k,
            one_over: self.inverses[k],
            order: DoubleDouble::from(k as f64),
            any: self.any,
        };
        if k == 0 {
            for one in &self.first {
                level.carry_out(one);
            }
            // The signs that hold for all later orders.
            for term in &mut self.terms {
                if let Some(row) = term.sign {
                    term.factor = level.any.like_exact(term.exact) * level.get(row, 0).sign();
                }
            }
            return;
        }
        for one in &self.later {
            match one {
                PlacedLater::Sum { from, to, result } => {
                    level.sum(&self.terms[*from..*to], *result);
                }
                PlacedLater::Other(one) => level.carry_out(one),
            }
        }
    }
}

/// The coefficients of all rows while those of one order are made.
struct Level<'a, T> {
    coefficients: &'a mut [T],
    room: usize,
    k: usize,
    /// 1/k
    one_over: DoubleDouble,
    /// k
    order: DoubleDouble,
    any: T,
}

impl<T: Element> Level<'_, T> {
    #[inline(always)]
    fn put(&mut self, row: usize, k: usize, x: T) {
        self.coefficients[row + k] = x;
    }

    #[inline(always)]
    fn get(&self, row: usize, k: usize) -> T {
        self.coefficients[row + k]
    }

    /// The number that a row needs at all orders.
    #[inline(always)]
    fn aside(&self, row: usize) -> T {
        self.get(row, self.room)
    }

    #[inline(always)]
    fn put_aside(&mut self, row: usize, x: T) {
        self.put(row, self.room, x);
    }

    /// The newest coefficient of a quantity.
    #[inline(always)]
    fn of(&self, source: Source) -> T {
        match source {
            Source::Row(row) => self.get(row, self.k),
            Source::Number(x) if self.k == 0 => self.any.like_exact(x),
            Source::Number(_) => self.any.like(0.0),
        }
    }

    #[inline(always)]
    fn inside(&self, row: usize) -> &[T] {
        &self.coefficients[row + 1..row + self.k]
    }

    /// What no operation of this order has part in. So it need not wait for any, and what is added of the newest coefficients takes
    /// little time.
    #[inline(always)]
    fn older(&self, sums: OlderSums) -> (T, T) {
        let zero = self.any.like(0.0);
        match sums {
            _ if self.k == 0 => (zero, zero),
            OlderSums::Nothing => (zero, zero),
            OlderSums::One(a, b) => (inner_product(self.inside(a), self.inside(b), zero), zero),
            OlderSums::Two(a, [b, c]) => {
                let both = [self.inside(b), self.inside(c)];
                inner_products(self.inside(a), both, zero).into()
            }
        }
    }

    #[inline(always)]
    fn sum(&mut self, terms: &[PlacedTerm<T>], result: usize) {
        let k = self.k;
        let mut sum = self.any.like(0.0);
        for term in terms {
            let x = self.get(term.row, k);
            let x = match term.lane {
                Some(lane) => self.any.like(x.lane(lane)),
                None => x,
            };
            sum = x.mul_add(term.factor, sum);
        }
        self.put(result, k, sum);
    }

    #[inline(always)]
    fn carry_out(&mut self, instruction: &PlacedInstruction) {
        let (result, spare, any) = (instruction.result, instruction.spare, self.any);
        let k = self.k;
        let (older, other) = self.older(instruction.older);
        let new = match instruction.operation {
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
                let sum = self.get(a, 0).mul_add(self.get(b, k), older);
                self.get(a, k).mul_add(self.get(b, 0), sum)
            }
            Operation::Quotient(a, b) => {
                // b_0 q_k = a_k - q_0 b_k - sum of q_j b_(k-j) over 0 < j < k
                let a = self.of(a);
                if k == 0 {
                    self.put_aside(result, any.like(1.0) / self.get(b, 0));
                    a / self.get(b, 0)
                } else {
                    // The difference first: where b_0 is tiny it may cancel to the last digit.
                    let rest = a - older;
                    let by_newest = -self.get(result, 0);
                    by_newest.mul_add(self.get(b, k), rest) * self.aside(result)
                }
            }
            Operation::Exponential(a) => {
                // k e_k = k a_k e_0 + sum of j a_j e_(k-j) over 0 < j < k
                self.slope(a, spare);
                if k == 0 {
                    self.get(a, 0).exp()
                } else {
                    let older = older.scale(self.one_over);
                    self.get(a, k).mul_add(self.get(result, 0), older)
                }
            }
            Operation::ExponentialLessOne(a, _) if k == 0 => self.get(a, 0).exp_m1(),
            Operation::ExponentialLessOne(_, whole) => self.get(whole, k),
            Operation::Logarithm(a) => {
                // a_0 k l_k = k a_k - sum of j l_j a_(k-j) over 0 < j < k
                if k == 0 {
                    self.put_aside(result, any.like(1.0) / self.get(a, 0));
                    self.get(a, 0).ln()
                } else {
                    self.of_slopes(a, (result, spare), older)
                }
            }
            Operation::LogarithmOfOneMore(a, _) if k == 0 => self.get(a, 0).ln_1p(),
            Operation::LogarithmOfOneMore(_, whole) => self.get(whole, k),
            Operation::Hyperbolic(a, cosh) => {
                // k s_k = k a_k c_0 + sum of j a_j c_(k-j), k c_k = k a_k s_0 + sum of j a_j s_(k-j) over 0 < j < k
                self.slope(a, spare);
                if k == 0 {
                    let (s, c) = self.get(a, 0).sinh_cosh();
                    self.put(cosh, 0, c);
                    s
                } else {
                    let (s, c) = self.of_both(a, (result, cosh), (older, other));
                    self.put(cosh, k, c);
                    s
                }
            }
            Operation::Circular(a, cos) => {
                // The same but for the sign of c_k
                self.slope(a, spare);
                if k == 0 {
                    let (s, c) = self.get(a, 0).sin_cos();
                    self.put(cos, 0, c);
                    s
                } else {
                    let (s, c) = self.of_both(a, (result, cos), (older, other));
                    self.put(cos, k, -c);
                    s
                }
            }
            Operation::Arctangent(a, u) | Operation::InverseHyperbolicSine(a, u) => {
                // y' = a' / u: u_0 k y_k = k a_k - sum of j y_j u_(k-j) over 0 < j < k
                if k == 0 {
                    self.put_aside(result, any.like(1.0) / self.get(u, 0));
                    match instruction.operation {
                        Operation::Arctangent(..) => self.get(a, 0).atan(),
                        _ => self.get(a, 0).asinh(),
                    }
                } else {
                    self.of_slopes(a, (result, spare), older)
                }
            }
            Operation::HyperbolicTangent(a, u) => {
                // k y_k = k a_k u_0 + sum of j a_j u_(k-j) over 0 < j < k, u_k = -sum of y_j y_(k-j) over 0 <= j <= k
                self.slope(a, spare);
                if k == 0 {
                    let y = self.get(a, 0).tanh();
                    self.put(u, 0, any.like(1.0) - y * y);
                    y
                } else {
                    let older = older.scale(self.one_over);
                    let y = self.get(a, k).mul_add(self.get(u, 0), older);
                    let first = self.get(result, 0);
                    let squared = self.inner(result, result);
                    self.put(u, k, -(first + first).mul_add(y, squared));
                    y
                }
            }
            Operation::Power(a, p) => self.power(a, p, (result, spare), (older, other)),
            Operation::Sign(a) if k == 0 => self.get(a, 0).sign(),
            Operation::Sign(_) => any.like(0.0),
            Operation::Signed(a, b) => self.get(a, k) * self.get(b, 0).sign(),
            Operation::Balanced(a, g) => self.balanced(a, g, (result, spare), (older, other)),
        };
        self.put(result, k, new);
    }

    /// (k a_k - sum of s_j u_(k-j) over 0 < j < k) / (k u_0), with s_j = j y_j, of y' = a' / u.
    #[inline(always)]
    fn of_slopes(&mut self, a: usize, (y, slopes): (usize, usize), older: T) -> T {
        let new = (self.get(a, self.k) - older.scale(self.one_over)) * self.aside(y);
        self.put(slopes, self.k, new.scale(self.order));
        new
    }

    /// a_k c_0 + (sum of j a_j c_(k-j) over 0 < j < k) / k, and the same of s.
    #[inline(always)]
    fn of_both(&self, a: usize, (s, c): (usize, usize), older: (T, T)) -> (T, T) {
        let (by_c, by_s) = (older.0.scale(self.one_over), older.1.scale(self.one_over));
        let newest = self.get(a, self.k);
        (
            newest.mul_add(self.get(c, 0), by_c),
            newest.mul_add(self.get(s, 0), by_s),
        )
    }

    /// y = a^p: k a_0 y_k = sum of (p (k-j) - j) a_(k-j) y_j over 0 <= j < k
    ///                     = p k a_k y_0 + p k sum a_(k-j) y_j - (1+p) sum a_(k-j) j y_j over 0 < j < k.
    #[inline(always)]
    fn power(&mut self, a: usize, p: f64, (y, slopes): (usize, usize), older: (T, T)) -> T {
        let (any, k) = (self.any, self.k);
        if k == 0 {
            self.put_aside(y, any.like(1.0) / self.get(a, 0));
            return self.get(a, 0).powf(p);
        }
        let one_and_p = DoubleDouble::of_finite(1.0, p);
        let p = DoubleDouble::from(p);
        let (plain, weighted) = older;
        let weighted = weighted.scale(one_and_p).scale(self.one_over);
        let by_newest = self.get(y, 0).scale(p);
        let rest = plain.scale(p) - weighted;
        let new = self.get(a, k).mul_add(by_newest, rest) * self.aside(y);
        self.put(slopes, k, new.scale(self.order));
        new
    }

    /// y + g(y) = x, as the recurrence of [`super::tape`]'s rows has it.
    fn balanced(
        &mut self,
        x: Source,
        g: Balance<Source>,
        (y, slopes): (usize, usize),
        (of_e, of_f): (T, T),
    ) -> T {
        let k = self.k;
        let [e, f, steepness, of_a, of_b, of_y] =
            [6, 5, 4, 3, 2, 1].map(|before| y - before * (self.room + 1));
        let newest = self.of(x);
        if k == 0 {
            let coefficients = g.map(|c| self.of(c));
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
                self.put(row, 0, x);
            }
            self.put_aside(y, one / (one + slope));
            return first;
        }
        let (of_e, of_f) = (of_e.scale(self.one_over), of_f.scale(self.one_over));
        // what is known of the newest coefficient of a product
        let known = |a: Source, of: usize, newest: T, first: T| match a {
            Source::Row(row) => {
                let sum = self.inner(row, of) + self.get(row, k) * first;
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
        let one_over = self.aside(y);
        let new = (newest - rest) * one_over;
        self.put(of_y, k, (newest * self.get(steepness, 0) + rest) * one_over);
        self.put(e, k, new.mul_add(counts_e, of_e));
        self.put(f, k, new.mul_add(counts_f, of_f));
        self.put(slopes, k, new.scale(self.order));
        new
    }

    /// j a_j
    #[inline(always)]
    fn slope(&mut self, a: usize, slopes: usize) {
        let new = self.get(a, self.k).scale(self.order);
        self.put(slopes, self.k, new);
    }

    #[inline(always)]
    fn inner(&self, a: usize, b: usize) -> T {
        inner_product(self.inside(a), self.inside(b), self.any.like(0.0))
    }
}
