//! The recurrences of series: the newest coefficient of a product, a quotient or a function, from those of its arguments.

use super::composition::ratio_coefficients;
use super::element::Element;
use super::tape::{Order, ROOM, Row};
use crate::number::{Balance, DoubleDouble, Ratio};
use pulp::NullaryFnOnce;
use std::cell::Cell;

/// sum of a_j b_(k-j) over 0 < j < k, k being the length of both.
struct CauchyProduct<'a, E> {
    a: &'a [Cell<E>],
    b: &'a [Cell<E>],
    zero: E,
}

impl<E: Element> NullaryFnOnce for CauchyProduct<'_, E> {
    type Output = E;
    /// With four sums side by side: one or two would wait for each other.
    #[inline(always)]
    fn call(self) -> E {
        let CauchyProduct { a, b, zero } = self;
        let k = a.len();
        let (mut first, mut second, mut third, mut fourth) = (zero, zero, zero, zero);
        let (mut i, mut j) = (1, k.saturating_sub(1));
        while i + 3 < k {
            first = a[i].get().mul_add(b[j].get(), first);
            second = a[i + 1].get().mul_add(b[j - 1].get(), second);
            third = a[i + 2].get().mul_add(b[j - 2].get(), third);
            fourth = a[i + 3].get().mul_add(b[j - 3].get(), fourth);
            i += 4;
            j -= 4;
        }
        while i < k {
            first = a[i].get().mul_add(b[j].get(), first);
            i += 1;
            j -= 1;
        }
        (first + second) + (third + fourth)
    }
}

impl<E: Element, O: Order> Row<'_, E, O> {
    /// Puts down what is known of the coefficient after the newest.
    #[inline(always)]
    fn begin_next(self, x: E) {
        self.tape.set(self.row, self.order() + 1, x);
    }

    /// sum of a_j b_(k-j) over 0 < j < k. From the middle outward, so that the newest coefficients come last and nobody waits
    /// for them; in two sums, which the processor forms side by side.
    ///
    /// At even orders the terms of the next sum that are known are added up too, with the coefficients that are in registers
    /// anyway: loads are what limits such sums. It is kept where the next coefficient of the result will stand.
    #[inline(always)]
    fn inner_product(self, other: Self, result: Self) -> E {
        let k = self.order();
        let zero = self.get(0).like(0.0);
        if !O::UNROLLED {
            return self.running_product(other);
        }
        if k < 2 {
            return zero;
        }
        if k % 2 == 1 {
            let begun = self.get(1).mul_add(other.get(k - 1), result.get(k));
            return self.get(k - 1).mul_add(other.get(1), begun);
        }
        let mut i = k / 2;
        let (mut a, mut b) = (self.get(i), other.get(i));
        let (mut left, mut right) = (a * b, zero);
        let (mut next_left, mut next_right) = (zero, zero);
        while i > 1 {
            i -= 1;
            let (a_far, b_far) = (self.get(k - i), other.get(k - i));
            next_left = a.mul_add(b_far, next_left);
            next_right = a_far.mul_add(b, next_right);
            (a, b) = (self.get(i), other.get(i));
            left = a.mul_add(b_far, left);
            right = a_far.mul_add(b, right);
        }
        result.begin_next(next_left + next_right);
        left + right
    }

    /// The same in loops.
    #[inline(always)]
    fn running_product(self, other: Self) -> E {
        let k = self.order();
        let product = CauchyProduct {
            a: &self.coefficients()[..k],
            b: &other.coefficients()[..k],
            zero: self.get(0).like(0.0),
        };
        if E::CALLED {
            product.zero.run(product)
        } else {
            product.call()
        }
    }

    /// The sums of a_(k-j) f_j and of a_(k-j) g_j over 0 < j < k, for these results, likewise: every a_j is read but once.
    #[inline(always)]
    fn inner_products(self, f: Self, g: Self, results: (Self, Self)) -> (E, E) {
        if !O::UNROLLED {
            return (self.running_product(f), self.running_product(g));
        }
        let k = self.order();
        let zero = self.get(0).like(0.0);
        if k < 2 {
            return (zero, zero);
        }
        if k % 2 == 1 {
            let (near, far) = (self.get(1), self.get(k - 1));
            let of_f = near.mul_add(f.get(k - 1), results.0.get(k));
            let of_g = near.mul_add(g.get(k - 1), results.1.get(k));
            return (far.mul_add(f.get(1), of_f), far.mul_add(g.get(1), of_g));
        }
        let mut i = k / 2;
        let (mut a, mut b, mut c) = (self.get(i), f.get(i), g.get(i));
        let (mut left, mut right) = ((a * b, a * c), (zero, zero));
        let (mut next_left, mut next_right) = ((zero, zero), (zero, zero));
        while i > 1 {
            i -= 1;
            let (a_far, b_far, c_far) = (self.get(k - i), f.get(k - i), g.get(k - i));
            next_left.0 = a.mul_add(b_far, next_left.0);
            next_left.1 = a.mul_add(c_far, next_left.1);
            next_right.0 = a_far.mul_add(b, next_right.0);
            next_right.1 = a_far.mul_add(c, next_right.1);
            (a, b, c) = (self.get(i), f.get(i), g.get(i));
            left.0 = a.mul_add(b_far, left.0);
            left.1 = a.mul_add(c_far, left.1);
            right.0 = a_far.mul_add(b, right.0);
            right.1 = a_far.mul_add(c, right.1);
        }
        results.0.begin_next(next_left.0 + next_right.0);
        results.1.begin_next(next_left.1 + next_right.1);
        (left.0 + right.0, left.1 + right.1)
    }

    // In what follows the newest coefficient of the argument, which is known last, enters by one multiplication at the end:
    // the next order waits for that chain.

    /// (a b)_k
    #[inline(always)]
    pub(super) fn product(self, other: Self) -> Self {
        let (k, (this, first), (other, second)) = (self.order(), self.parts(), other.parts());
        let result = self.another();
        let new = if k == 0 {
            this.get(0) * other.get(0)
        } else {
            let sum = this.inner_product(other, result);
            let sum = this.get(0).mul_add(other.get(k), sum);
            this.get(k).mul_add(other.get(0), sum)
        };
        let result = result.put(new);
        match (first, second) {
            (Some(x), Some(y)) => result.scaled(x * y),
            (Some(x), None) | (None, Some(x)) => result.scaled(x),
            (None, None) => result,
        }
    }

    /// q = a / b from a = q b: b_0 q_k = a_k - sum of b_j q_(k-j) over 0 < j <= k.
    #[inline(always)]
    pub(super) fn quotient(self, other: Self) -> Self {
        let (k, denominator) = (self.order(), other);
        let other = other.stored();
        // The first coefficients of this row are 1 / b_0, -1 / b_0 and -q_0 / b_0.
        let inverse = other.another();
        let q = other.another();
        if k == 0 {
            let one_over = other.get(0).like(1.0) / other.get(0);
            let first = self.newest() / other.get(0);
            inverse.put(one_over);
            inverse.tape.set(inverse.row, 1, -one_over);
            inverse.tape.set(inverse.row, 2, -(first * one_over));
            return q.put(first);
        }
        let rest = q.inner_product(other, q) * inverse.get(1);
        let rest = self.mul_add(inverse.get(0), rest);
        q.put(denominator.mul_add(inverse.get(2), rest))
    }

    /// j a_j as a row of its own, whose first coefficient is free.
    #[inline(always)]
    fn slopes(self) -> Self {
        let k = self.order();
        let slopes = self.another();
        if k > 0 {
            slopes.put(self.times(self.unscaled().like(k as f64)));
        }
        slopes
    }

    /// 1/k
    #[inline(always)]
    fn one_over_order(self) -> E {
        let x = self.unscaled();
        x.like(1.0) / x.like(self.order() as f64)
    }

    /// e = exp a from e' = e a'.
    #[inline(always)]
    pub(super) fn exponential(self) -> Self {
        let k = self.order();
        let slopes = self.slopes();
        let e = self.another();
        if k == 0 {
            return e.put(self.newest().exp());
        }
        let rest = slopes.inner_product(e, e) * self.one_over_order();
        e.put(self.mul_add(e.get(0), rest))
    }

    /// exp a - 1: beyond the first coefficient those of exp a, which are as small as those of a.
    #[inline(always)]
    pub(super) fn exponential_less_one(self) -> Self {
        let e = self.exponential();
        if self.order() == 0 {
            return e.mapped(self.newest().exp_m1());
        }
        e.loose()
    }

    /// s = sinh a, c = cosh a from s' = c a', c' = s a'.
    #[inline(always)]
    pub(super) fn hyperbolic(self) -> (Self, Self) {
        let k = self.order();
        let slopes = self.slopes();
        let (s, c) = (self.another(), self.another());
        if k == 0 {
            let (sinh, cosh) = self.newest().sinh_cosh();
            return (s.put(sinh), c.put(cosh));
        }
        let (of_c, of_s) = slopes.inner_products(c, s, (s, c));
        let one_over = self.one_over_order();
        (
            s.put(self.mul_add(c.get(0), of_c * one_over)),
            c.put(self.mul_add(s.get(0), of_s * one_over)),
        )
    }

    /// s = sin a, c = cos a from s' = c a', c' = -s a'.
    #[inline(always)]
    pub(super) fn circular(self) -> (Self, Self) {
        let k = self.order();
        let slopes = self.slopes();
        let (s, c) = (self.another(), self.another());
        if k == 0 {
            let (sin, cos) = self.newest().sin_cos();
            return (s.put(sin), c.put(cos));
        }
        // Twice one sum: what is begun of the next is added to what stands there, and c changes its sign.
        let of_c = slopes.running_product(c);
        let of_s = slopes.running_product(s);
        let one_over = self.one_over_order();
        (
            s.put(self.mul_add(c.get(0), of_c * one_over)),
            c.put(-self.mul_add(s.get(0), of_s * one_over)),
        )
    }

    /// y = atan a from u y' = a', u = 1 + a^2: u_0 k y_k = k a_k - sum of u_(k-j) j y_j over 0 < j < k.
    #[inline(always)]
    pub(super) fn arctangent(self) -> Self {
        let k = self.order();
        let this = self.stored();
        let u = this.product(this).plus(self.any().like(1.0)).stored();
        let y = self.another();
        // The first coefficient of this row is 1 / u_0.
        let slopes = self.another();
        if k == 0 {
            slopes.put(u.get(0).like(1.0) / u.get(0));
            return y.put(this.get(0).atan());
        }
        let sum = slopes.running_product(u);
        let one_over = slopes.get(0);
        let rest = sum * -(self.one_over_order() * one_over);
        let new = this.mul_add(one_over, rest);
        slopes.put(new * new.like(k as f64));
        y.put(new)
    }

    /// y = tanh a from y' = u a', u = 1 - y^2.
    #[inline(always)]
    pub(super) fn hyperbolic_tangent(self) -> Self {
        let k = self.order();
        let slopes = self.slopes();
        let (y, u) = (self.another(), self.another());
        if k == 0 {
            let tanh = self.newest().tanh();
            u.put(tanh.like(1.0) - tanh * tanh);
            return y.put(tanh);
        }
        let sum = slopes.running_product(u);
        let new = self.mul_add(u.get(0), sum * self.one_over_order());
        let first = y.get(0);
        u.put(-(first + first).mul_add(new, y.running_product(y)));
        y.put(new)
    }

    /// l = ln a from a l' = a': a_0 k l_k = k a_k - sum of a_(k-j) j l_j over 0 < j < k.
    #[inline(always)]
    pub(super) fn logarithm(self) -> Self {
        let (k, this) = (self.order(), self.stored());
        let l = self.another();
        // The first coefficient of this row is 1 / a_0.
        let slopes = self.another();
        if k == 0 {
            slopes.put(this.get(0).like(1.0) / this.get(0));
            return l.put(this.get(0).ln());
        }
        let sum = slopes.inner_product(this, l);
        let one_over = slopes.get(0);
        let rest = sum * -(self.one_over_order() * one_over);
        let new = self.mul_add(one_over, rest);
        slopes.put(new * new.like(k as f64));
        l.put(new)
    }

    /// ln(1 + a): beyond the first coefficient those of the logarithm.
    #[inline(always)]
    pub(super) fn logarithm_of_one_more(self) -> Self {
        let l = self.plus(self.any().like(1.0)).logarithm();
        if self.order() == 0 {
            return l.mapped(self.newest().ln_1p());
        }
        l.loose()
    }

    /// y = a^p from a y' = p a' y: k a_0 y_k = sum of (p (k-j) - j) a_(k-j) y_j over 0 <= j < k
    ///                                      = p k sum a_(k-j) y_j - (1+p) sum a_(k-j) j y_j.
    #[inline(always)]
    pub(super) fn power(self, p: f64) -> Self {
        let (k, this) = (self.order(), self.stored());
        let y = self.another();
        let slopes = self.another();
        // What all orders take: p / a_0, -(1+p) / a_0 and p y_0 / a_0.
        let factors = self.another();
        let a0 = this.get(0);
        if k == 0 {
            let one_over = a0.like(1.0) / a0;
            let one_and_p = a0.like_exact(DoubleDouble::of_finite(1.0, p));
            let first = a0.powf(p);
            let p_over = a0.like(p) * one_over;
            factors.put(p_over);
            factors.tape.set(factors.row, 1, -(one_and_p * one_over));
            factors.tape.set(factors.row, 2, p_over * first);
            return y.put(first);
        }
        let (plain, weighted) = this.inner_products(y, slopes, (y, slopes));
        let of_weighted = factors.get(1) * self.one_over_order();
        let rest = weighted.mul_add(of_weighted, plain * factors.get(0));
        let new = self.mul_add(factors.get(2), rest);
        slopes.put(new * new.like(k as f64));
        y.put(new)
    }

    /// A ratio at a: with d = a - a_0 the sum of its coefficients there times d^m, of which each has a row.
    #[inline(always)]
    pub(super) fn ratio(self, ratio: Ratio) -> Self {
        let (k, this) = (self.order(), self.stored());
        let (y, coefficients) = (this.another(), this.another());
        // d^2 stands in the first of these, d^k in as many behind it as there may be orders.
        let second = this.another();
        for _ in 3..ROOM {
            this.another();
        }
        if k == 0 {
            let all = ratio_coefficients(ratio, this.get(0), ROOM);
            for (m, c) in all.into_iter().enumerate() {
                coefficients.tape.set(coefficients.row, m, c);
            }
            return y.put(coefficients.get(0));
        }
        let power = |m: usize| Row {
            row: second.row + m - 2,
            ..second
        };
        let mut sum = coefficients.get(1) * this.get(k);
        for m in 2..=k {
            let below = if m == 2 { this } else { power(m - 1) };
            let mut new = sum.like(0.0);
            for j in 1..=k + 1 - m {
                new = this.get(j).mul_add(below.get(k - j), new);
            }
            sum = coefficients.get(m).mul_add(power(m).put(new).get(k), sum);
        }
        y.put(sum)
    }

    /// y and g = g(y) with y + g = x. As e = exp y has k e_k = k y_k e_0 + sum of j y_j e_(k-j) over 0 < j < k, and the other functions
    /// likewise, g_k = g'(y_0) y_k + r, and so y_k = (x_k - r) / (1 + g'(y_0)).
    #[inline(always)]
    pub(super) fn balanced(self, g: Balance<Self>) -> (Self, Self) {
        let k = self.order();
        let g = g.map(Self::stored);
        let (y, of_y, slopes) = (self.another(), self.another(), self.another());
        // The first coefficients: 1 / (1 + g'(y_0)), the same times g'(y_0), and what the newest coefficients of g count at y_0.
        let firsts = self.another();
        // exp y and exp(-y), or sinh y and cosh y
        let (e, f) = (self.another(), self.another());
        if k == 0 {
            let (first, value) = self.newest().balanced(g.map(|c| c.get(0)));
            let ((of_e, of_f), counts) = match g {
                Balance::Sinh(_) => (first.sinh_cosh(), [first; 2]),
                _ => {
                    let (rising, falling) = (first.exp_m1(), (-first).exp_m1());
                    ((first.exp(), (-first).exp()), [rising, falling])
                }
            };
            e.put(of_e);
            f.put(of_f);
            let slope = match g {
                Balance::Exponential(a) => a.get(0) * of_e,
                Balance::Sinh(a) => a.get(0) * of_f,
                Balance::Difference(a, b) => a.get(0).mul_add(of_e, b.get(0) * of_f),
            };
            let one_over = first.like(1.0) / (slope + first.like(1.0));
            let all = [one_over, slope * one_over, counts[0], counts[1]];
            for (j, x) in all.into_iter().enumerate() {
                firsts.tape.set(firsts.row, j, x);
            }
            return (y.put(first), of_y.put(value));
        }
        let one_over = self.one_over_order();
        // what is known of the newest coefficient of a product
        let known = |a: Self, of: Self, newest: E, first: E| {
            let sum = a.get(k).mul_add(first, a.running_product(of));
            a.get(0).mul_add(newest, sum)
        };
        // Of e and f, but for y_k, and what y_k counts in f.
        let (of_e, of_f, rest, count);
        match g {
            Balance::Exponential(a) => {
                of_e = slopes.running_product(e) * one_over;
                (of_f, count) = (of_e.like(0.0), of_e.like(0.0));
                rest = known(a, e, of_e, e.get(0));
            }
            Balance::Sinh(a) => {
                of_e = slopes.running_product(f) * one_over;
                of_f = slopes.running_product(e) * one_over;
                count = e.get(0);
                rest = known(a, e, of_e, e.get(0));
            }
            Balance::Difference(a, b) => {
                of_e = slopes.running_product(e) * one_over;
                of_f = -(slopes.running_product(f) * one_over);
                count = -f.get(0);
                let falling = known(b, f, of_f, firsts.get(3));
                rest = known(a, e, of_e, firsts.get(2)) - falling;
            }
        }
        let newest = self.newest();
        let new = (newest - rest) * firsts.get(0);
        let of_new = match g {
            Balance::Sinh(_) => f.get(0),
            _ => e.get(0),
        };
        e.put(new.mul_add(of_new, of_e));
        f.put(new.mul_add(count, of_f));
        slopes.put(new * new.like(k as f64));
        // g_k = (g' x_k + r) / (1 + g')
        let value = newest.mul_add(firsts.get(1), rest * firsts.get(0));
        (y.put(new), of_y.put(value))
    }
}
