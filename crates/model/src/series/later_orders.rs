//! The coefficients of a program's rows after the first, by recurrences.

use super::element::Element;
use super::placed::{PlacedInstruction, Products};
use super::products::{Sums, sum_of_products};
use super::program::{Operation, Source};
use super::program_rows::Level;
use crate::number::Balance;

/// What the first coefficient of an exponential or a power counts in the later ones. Beyond the range of numbers it has none: the function stays as it is,
/// as long as the rates at the end of the step agree.
#[inline(always)]
fn or_none<T: Element>(counts: T) -> T {
    if counts.all_finite() {
        counts
    } else {
        where_finite(counts, counts)
    }
}

/// x in the lanes where the first coefficient is not infinite, else 0.
#[cold]
#[inline(never)]
fn where_finite<T: Element>(first: T, x: T) -> T {
    (x.like(1.0) / first).if_zero(x.like(0.0), x)
}

impl<T: Element> Level<'_, T> {
    /// What holds for all orders, from the first coefficients.
    #[inline(always)]
    pub fn prepare(&self, one: &mut PlacedInstruction<T>) {
        let factor = one.operand.factor;
        let first = |row: usize| self.first(row);
        let one_over = |x: T| self.any.like(1.0) / x;
        let zero = self.any.like(0.0);
        match one.operation {
            Operation::Product(_, b) => {
                one.counts = [first(b).scale(factor), first(one.operand.row)];
                one.inverse = self.any.like_exact(factor);
                let made = first(one.result);
                if !made.all_finite() {
                    one.counts = one.counts.map(|count| where_finite(made, count));
                    one.inverse = where_finite(made, one.inverse);
                }
            }
            Operation::Quotient(_, b) => {
                one.counts[0] = -first(one.result);
                one.inverse = one_over(first(b));
            }
            Operation::Exponential(_) => {
                one.counts[0] = or_none(first(one.result).scale(factor));
            }
            Operation::Exponentials(_, falling) => {
                one.counts = [one.result, falling].map(|row| or_none(first(row).scale(factor)));
            }
            Operation::Hyperbolic(_, other) | Operation::Circular(_, other) => {
                one.counts = [other, one.result].map(|row| or_none(first(row).scale(factor)));
            }
            Operation::HyperbolicTangent(_, u) => {
                let y = first(one.result);
                one.counts = [first(u).scale(factor), y + y];
            }
            Operation::Logarithm(_) => one.inverse = one_over(first(one.operand.row)).scale(factor),
            Operation::Arctangent(_, u) | Operation::InverseHyperbolicSine(_, u) => {
                one.inverse = one_over(first(u));
            }
            Operation::Power(_, p) => {
                let one_and_p = self.any.like(1.0) + self.any.like_exact(p);
                one.counts = [or_none(first(one.result).scale(p)), one_and_p];
                let base = first(one.operand.row);
                one.inverse = if one.held {
                    zero
                } else {
                    base.if_zero(zero, one_over(base)).scale(factor)
                };
            }
            Operation::Ratio(a, ratio) => {
                if let Some(composition) = &mut one.composition {
                    composition.begin(ratio, first(a));
                }
            }
            Operation::Balanced(..) => {
                let [_, _, steepness, ..] = self.of_balance(one.result);
                one.inverse = one_over(self.any.like(1.0) + first(steepness));
            }
            _ => {}
        }
    }

    /// The sums of products before there are coefficients.
    #[inline(always)]
    pub fn clear_sums(&self, one: &mut PlacedInstruction<T>) {
        let zero = self.any.like(0.0);
        match one.products {
            Products::Nothing => {}
            Products::One(_) => one.sums[0].clear(zero),
            Products::Two(_) | Products::Shared(..) => match &mut one.shared {
                Some(shared) => shared.clear(zero),
                None => {
                    one.sums[0].clear(zero);
                    one.sums[1].clear(zero);
                }
            },
        }
    }

    /// The newest coefficients, and what these add to the sums of products for the next ones.
    #[inline(always)]
    pub fn carry_out(&mut self, one: &mut PlacedInstruction<T>) {
        let (result, spare) = (one.result, one.spare);
        let older = one.sums[0].of(self.phase);
        let [first, second] = one.counts;
        match one.operation {
            Operation::Product(a, b) => {
                let (a, b) = (self.newest(a), self.newest(b));
                let older = older * one.inverse;
                self.put(result, a.mul_add(first, b.mul_add(second, older)));
                self.add(&mut one.sums[0], [a, b]);
            }
            Operation::Quotient(a, b) => {
                // b_0 q_k = a_k - q_0 b_k - sum of q_j b_(k-j) over 0 < j < k
                // The difference first: where b_0 is tiny it may cancel to the last digit.
                let rest = self.of(a).scale(one.operand.factor) - older;
                let b = self.newest(b);
                let new = b.mul_add(first, rest) * one.inverse;
                self.put(result, new);
                self.add(&mut one.sums[0], [new, b]);
            }
            Operation::Exponential(a) => {
                // k e_k = k a_k e_0 + sum of j a_j e_(k-j) over 0 < j < k
                let a = self.newest(a);
                let new = a.mul_add(first, older.scale(self.one_over));
                self.put(result, new);
                let slope = self.slope(a, one);
                self.add(&mut one.sums[0], [slope, new]);
            }
            Operation::Exponentials(a, falling) => {
                // The same twice but for the sign
                let (a, [older, other]) = (self.newest(a), self.of_both(one));
                let e = a.mul_add(first, older.scale(self.one_over));
                let f = -a.mul_add(second, other.scale(self.one_over));
                self.put(result, e);
                self.put(falling, f);
                let slope = self.slope(a, one);
                self.add_both(one, slope, [e, f]);
            }
            Operation::ExponentialLessOne(_, whole) | Operation::LogarithmOfOneMore(_, whole) => {
                self.put(result, self.newest(whole));
            }
            Operation::Logarithm(u) => {
                // u_0 k l_k = k u_k - sum of j l_j u_(k-j) over 0 < j < k
                let u = self.newest(u);
                let new = (u - older.scale(self.one_over)) * one.inverse;
                self.put(result, new);
                let slope = new.scale(self.order);
                self.put(spare, slope);
                self.add(&mut one.sums[0], [slope, u]);
            }
            Operation::Arctangent(a, u) | Operation::InverseHyperbolicSine(a, u) => {
                // y' = a' / u: u_0 k y_k = k a_k - sum of j y_j u_(k-j) over 0 < j < k
                let rest = self.newest(a).scale(one.operand.factor) - older.scale(self.one_over);
                let new = rest * one.inverse;
                self.put(result, new);
                let slope = new.scale(self.order);
                self.put(spare, slope);
                self.add(&mut one.sums[0], [slope, self.newest(u)]);
            }
            Operation::Hyperbolic(a, cosh) => {
                // k s_k = k a_k c_0 + sum of j a_j c_(k-j), k c_k = k a_k s_0 + sum of j a_j s_(k-j) over 0 < j < k
                let (a, [older, other]) = (self.newest(a), self.of_both(one));
                let s = a.mul_add(first, older.scale(self.one_over));
                let c = a.mul_add(second, other.scale(self.one_over));
                self.put(result, s);
                self.put(cosh, c);
                let slope = self.slope(a, one);
                self.add_both(one, slope, [c, s]);
            }
            Operation::Circular(a, cos) => {
                // The same but for the sign of c_k
                let (a, [older, other]) = (self.newest(a), self.of_both(one));
                let s = a.mul_add(first, older.scale(self.one_over));
                let c = -a.mul_add(second, other.scale(self.one_over));
                self.put(result, s);
                self.put(cos, c);
                let slope = self.slope(a, one);
                self.add_both(one, slope, [c, s]);
            }
            Operation::HyperbolicTangent(a, u) => {
                // k y_k = k a_k u_0 + sum of j a_j u_(k-j) over 0 < j < k, u_k = -sum of y_j y_(k-j) over 0 <= j <= k
                let (a, squared) = (self.newest(a), one.sums[1].of(self.phase));
                let y = a.mul_add(first, older.scale(self.one_over));
                let new = -y.mul_add(second, squared);
                self.put(result, y);
                self.put(u, new);
                let slope = self.slope(a, one);
                self.add(&mut one.sums[0], [slope, new]);
                self.add(&mut one.sums[1], [y, y]);
            }
            Operation::Power(a, p) => {
                // y = a^p: k a_0 y_k = sum of (p (k-j) - j) a_(k-j) y_j over 0 <= j < k
                //                    = p k a_k y_0 + p k sum a_(k-j) y_j - (1+p) sum a_(k-j) j y_j over 0 < j < k
                let (a, [older, weighted]) = (self.newest(a), self.of_both(one));
                let weighted = (weighted * second).scale(self.one_over);
                let rest = older.scale(p) - weighted;
                let new = a.mul_add(first, rest) * one.inverse;
                self.put(result, new);
                let slope = new.scale(self.order);
                self.put(spare, slope);
                self.add_both(one, a, [new, slope]);
            }
            Operation::Ratio(a, _) => {
                if let Some(composition) = &mut one.composition {
                    let new = composition.next(self.older(a), self.newest(a));
                    self.put(result, new);
                }
            }
            Operation::Sign(_) => self.put(result, self.any.like(0.0)),
            Operation::Balanced(x, g) => self.apart().balanced(x, g, one),
            Operation::Lane(..)
            | Operation::Sum(..)
            | Operation::Difference(..)
            | Operation::Negative(_)
            | Operation::Shifted(..)
            | Operation::Complement(..)
            | Operation::Scaled(..)
            | Operation::Over(..)
            | Operation::Signed(..) => unreachable!("a sum of terms"),
        }
    }

    /// What there is to the sums of products for the next few orders.
    #[inline(always)]
    pub fn go_on(&self, one: &mut PlacedInstruction<T>) {
        let (k, zero) = (self.k, self.any.like(0.0));
        let older = |row: usize| self.older(row);
        match one.products {
            Products::Nothing => {}
            Products::One(rows) => one.sums[0].go_on(k, rows.map(older), zero),
            Products::Two(both) => {
                for (sums, rows) in one.sums.iter_mut().zip(both) {
                    sums.go_on(k, rows.map(older), zero);
                }
            }
            Products::Shared(row, both) => match &mut one.shared {
                Some(shared) => shared.go_on(k, older(row), zero),
                None => {
                    for (sums, other) in one.sums.iter_mut().zip(both) {
                        sums.go_on(k, [row, other].map(older), zero);
                    }
                }
            },
        }
    }

    /// What the newest coefficients of two rows add to the sums of their products.
    #[inline(always)]
    fn add(&self, sums: &mut Sums<T>, newest: [T; 2]) {
        if self.begins {
            sums.add_first(self.k, newest);
        } else {
            sums.add(self.phase, newest);
        }
    }

    /// The sums of products of a row with either of two others.
    #[inline(always)]
    fn of_both(&self, one: &PlacedInstruction<T>) -> [T; 2] {
        match &one.shared {
            Some(shared) => shared.of(self.phase),
            None => {
                let [first, second] = &one.sums;
                [first.of(self.phase), second.of(self.phase)]
            }
        }
    }

    /// What the newest coefficients of these add to such sums.
    #[inline(always)]
    fn add_both(&self, one: &mut PlacedInstruction<T>, a: T, both: [T; 2]) {
        match &mut one.shared {
            Some(shared) if self.begins => shared.add_first(self.k, a, both),
            Some(shared) => shared.add((self.k, self.phase), a, both),
            None => {
                let [first, second] = &mut one.sums;
                self.add(first, [a, both[0]]);
                self.add(second, [a, both[1]]);
            }
        }
    }

    /// k times this multiple of a_k, put down.
    #[inline(always)]
    fn slope(&mut self, a: T, one: &PlacedInstruction<T>) -> T {
        let slope = a.scale(self.order).scale(one.operand.factor);
        self.put(one.spare, slope);
        slope
    }

    /// y and g = g(y) with y + g = x. As e = exp y has k e_k = k y_k e_0 + sum of j y_j e_(k-j) over 0 < j < k, and the other functions
    /// likewise, g_k = g'(y_0) y_k + r, and so y_k = (x_k - r) / (1 + g'(y_0)) and g_k = (g'(y_0) x_k + r) / (1 + g'(y_0)).
    fn balanced(&mut self, x: Source, g: Balance<Source>, one: &mut PlacedInstruction<T>) {
        let y = one.result;
        let [e, f, steepness, of_a, of_b, of_y] = self.of_balance(y);
        let newest = self.of(x);
        let [of_e, of_f] = self.of_both(one).map(|sum| sum.scale(self.one_over));
        // what is known of the newest coefficient of a product
        let known = |a: Source, of: usize, newest: T, first: T| match a {
            Source::Row(row) => {
                let zero = self.any.like(0.0);
                let sum = sum_of_products(&self.older(row)[1..], &self.older(of)[1..], zero);
                let sum = sum + self.newest(row) * first;
                self.first(row).mul_add(newest, sum)
            }
            Source::Number(x) => newest.scale(x),
        };
        let [of_a, of_b] = [of_a, of_b].map(|row| self.first(row));
        let (rest, of_e, of_f) = match g {
            Balance::Exponential(a) => (known(a, e, of_e, of_a), of_e, of_f),
            Balance::Sinh(a) => (known(a, e, of_f, of_a), of_f, of_e),
            Balance::Difference(a, b) => {
                let falling = known(b, f, -of_f, of_b);
                (known(a, e, of_e, of_a) - falling, of_e, -of_f)
            }
        };
        let (first_e, first_f) = (self.first(e), self.first(f));
        let (counts_e, counts_f) = match g {
            Balance::Sinh(_) => (first_f, first_e),
            _ => (first_e, -first_f),
        };
        let new = (newest - rest) * one.inverse;
        let (new_e, new_f) = (new.mul_add(counts_e, of_e), new.mul_add(counts_f, of_f));
        self.put(y, new);
        self.put(of_y, (newest * self.first(steepness) + rest) * one.inverse);
        self.put(e, new_e);
        self.put(f, new_f);
        let slope = new.scale(self.order);
        self.put(one.spare, slope);
        self.add_both(one, slope, [new_e, new_f]);
    }
}
