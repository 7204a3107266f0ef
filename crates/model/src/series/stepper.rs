//! One step after the other along interfaces under one stress, each by the Taylor series at its beginning.

use super::element::Element;
use super::interpreted::{BISECTIONS, LEAST, SAFETY, SHORTER, SHORTER_UNITS};
use super::{Accuracy, ROOM};
use std::cell::Cell;

/// Times that a step is halved because it leads where the formula has no meaning.
const HALVINGS: usize = 60;
/// Rows of coefficients: those of the variables first, then those of the slip rates.
const ROWS: usize = 5;

/// Coefficients of all rows, of which each has the same room.
type Memory<E> = [[E; ROOM]; ROWS];

/// dx/dt = f(x) in C variables, the first of which is the stress. |v| has a kink where v = 0, which is where the stress is 0.
pub trait Formula<E: Element, const C: usize>: Copy {
    /// f(x)
    fn rates(&self, x: &[E; C]) -> [E; C];

    /// What may err by one in a step, from the state and the tolerances: the unit of every variable.
    fn units(&self, x: &[E; C], tolerances: (f64, f64)) -> [E; C];

    /// Positive and finite in the lanes whose state is one that the formula is meant for.
    fn allows(&self, x: &[E; C]) -> E;
}

/// How the coefficients of a series are made from the first ones.
pub trait Recurrences<E: Element, F: Formula<E, C>, const C: usize> {
    /// To an order, in a unit of time, into rows of [`ROOM`] coefficients: those of the variables first, then those of the slip rates.
    fn make(&mut self, formula: &F, memory: &[Cell<E>], order: usize, unit: E);
}

/// A solution of a formula on its way, in every lane of E.
pub struct Stepper<E, F, const C: usize> {
    formula: F,
    memory: Box<Memory<E>>,
    /// The state at the end of the last step, and what rounding took from it.
    x: [E; C],
    lost: [E; C],
    /// The unit of time of the series, and of the next one. The coefficients neither overflow nor vanish if it is near the
    /// step.
    unit: E,
    next_unit: E,
}

impl<E: Element, F: Formula<E, C>, const C: usize> Stepper<E, F, C> {
    /// To be started; `any` is any element.
    pub fn new(formula: F, any: E) -> Self {
        let (zero, one) = (any.like(0.0), any.like(1.0));
        Stepper {
            formula,
            memory: Box::new([[zero; ROOM]; ROWS]),
            x: [zero; C],
            lost: [zero; C],
            unit: one,
            next_unit: one,
        }
    }

    /// Begins at x.
    #[inline(always)]
    pub fn start(&mut self, x: [E; C]) {
        self.start_where(x[0].like(-1.0), x);
    }

    /// Begins at x in the lanes where `new` is negative; the others stay on their way.
    #[inline(always)]
    pub fn start_where(&mut self, new: E, x: [E; C]) {
        let (zero, one) = (new.like(0.0), new.like(1.0));
        for (c, x) in x.into_iter().enumerate() {
            self.x[c] = new.if_negative(x, self.x[c]);
            self.lost[c] = new.if_negative(zero, self.lost[c]);
        }
        // The time in which the state would change by its own size; of a variable that is zero, by the rounding of the largest.
        let mut least = zero.like(LEAST);
        for c in 0..C {
            let rounding = (self.x[c] * zero.like(f64::EPSILON)).abs();
            least = Element::max(least, rounding.largest_over_interfaces());
        }
        let mut rate = zero;
        for (x, of_x) in self.x.iter().zip(self.formula.rates(&self.x)) {
            let size = Element::max(x.abs(), least);
            rate = Element::max(rate, (of_x / size).abs());
        }
        let rate = rate.largest_over_interfaces();
        let next_unit = one / Element::max(rate, zero.like(f64::MIN_POSITIVE));
        self.next_unit = new.if_negative(next_unit, self.next_unit);
    }

    /// The formula, whose constants may change between solutions.
    #[cfg(target_arch = "x86_64")]
    pub fn formula_mut(&mut self) -> &mut F {
        &mut self.formula
    }

    /// The state reached.
    pub fn state(&self) -> &[E; C] {
        &self.x
    }

    /// Puts this in the place of the i-th variable, where it is known better.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub fn replace(&mut self, i: usize, x: E) {
        self.x[i] = x;
    }

    /// The unit of time of the last step's series.
    pub fn unit(&self) -> E {
        self.unit
    }

    #[inline(always)]
    fn coefficient(&self, i: usize, j: usize) -> E {
        self.memory[i][j]
    }

    /// The series of the i-th variable.
    #[inline(always)]
    pub fn series(&self, i: usize) -> &[E] {
        &self.memory[i]
    }

    /// The series of the i-th row of slip rates, without its last coefficient.
    #[inline(always)]
    pub fn slip_rates(&self, i: usize) -> &[E] {
        &self.memory[C + i]
    }

    /// Goes on by the step that the accuracy asks for, at most `limit`, in every lane, and returns it. The state is not moved
    /// in a lane where that is not a number: there is no step then.
    #[inline(always)]
    pub fn advance_with(
        &mut self,
        recurrences: &mut impl Recurrences<E, F, C>,
        accuracy: &Accuracy,
        limit: E,
    ) -> E {
        self.expand_with(recurrences, accuracy);
        let h = self.longest(accuracy);
        self.advance_by(accuracy, h, limit)
    }

    /// A bound on how far the i-th variable strays from where the series begins, within this time.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub fn reach(&self, i: usize, order: usize, time: E) -> E {
        let h = (time / self.unit).abs();
        let mut sum = self.coefficient(i, order).abs();
        let mut j = order - 1;
        while j > 0 {
            sum = sum.mul_add(h, self.coefficient(i, j).abs());
            j -= 1;
        }
        sum * h
    }

    /// Makes the series at the state reached.
    #[inline(always)]
    pub fn expand_with(
        &mut self,
        recurrences: &mut impl Recurrences<E, F, C>,
        accuracy: &Accuracy,
    ) {
        self.unit = self.next_unit;
        self.load();
        // A copy, which the compiler sees that no coefficient written changes.
        let formula = self.formula;
        let mut tried = 0;
        loop {
            let memory = Cell::from_mut(self.memory.as_flattened_mut()).as_slice_of_cells();
            recurrences.make(&formula, memory, accuracy.order, self.unit);
            // Zero where all coefficients are finite. Close to a steady state the state changes by its own size in no time
            // that is near the step; in a shorter unit the coefficients do not overflow.
            let zero = self.unit.like(0.0);
            let (mut finite, mut c) = (zero, 0);
            while c < C {
                finite = self.coefficient(c, accuracy.order).mul_add(zero, finite);
                c += 1;
            }
            tried += 1;
            if finite.if_zero(zero, zero.like(-1.0)).none_negative() || tried > SHORTER_UNITS {
                break;
            }
            self.unit = finite.if_zero(self.unit, self.unit * zero.like(SHORTER));
        }
    }

    /// Goes on by h, counted in units of the series, at most `limit`, and returns the time that this took.
    #[inline(always)]
    pub fn advance_by(&mut self, accuracy: &Accuracy, h: E, limit: E) -> E {
        let unit = self.unit;
        let in_units = limit / unit;
        let mut h = Element::min(h, in_units.abs()) * limit.sign();
        let (mut x, mut lost) = self.evaluate(accuracy.order, h);
        let allowed = self.formula.allows(&x).all_positive();
        if !allowed || !(x[0] * self.x[0]).none_negative() {
            h = self.shortened(accuracy.order, h);
            (x, lost) = self.evaluate(accuracy.order, h);
            let finite = h.mul_add(h.like(0.0), h.like(1.0));
            for c in 0..C {
                x[c] = finite.if_positive(x[c], self.x[c]);
                lost[c] = finite.if_positive(lost[c], self.lost[c]);
            }
        }
        self.x = x;
        self.lost = lost;
        let time = (in_units - h).if_zero(limit, h * unit);
        self.next_unit = time.abs();
        time
    }

    /// A part of the step h that leads where the formula has a meaning, and no further than just behind a kink; every lane's
    /// own. Not a number where there is none.
    #[cold]
    fn shortened(&self, order: usize, h: E) -> E {
        let h = self.halved(order, h);
        if (self.sum(order, h).0[0] * self.x[0]).none_negative() {
            return h;
        }
        self.halved(order, self.up_to_kink(order, h))
    }

    /// The step h, halved until it leads where the formula has a meaning.
    #[cold]
    fn halved(&self, order: usize, mut h: E) -> E {
        let mut halvings = 0;
        loop {
            let allowed = self.formula.allows(&self.sum(order, h).0);
            if allowed.all_positive() {
                return h;
            }
            if halvings == HALVINGS {
                return allowed.if_positive(h, h.like(f64::NAN));
            }
            h = allowed.if_positive(h, h * h.like(0.5));
            halvings += 1;
        }
    }

    #[inline(always)]
    fn load(&mut self) {
        let mut c = 0;
        while c < C {
            self.memory[c][0] = self.x[c];
            c += 1;
        }
    }

    /// The step, in units of the series, at which the last two terms of the series reach what may err (Jorba & Zou 2005, section 3.2, in the norm that
    /// the tolerances make).
    #[inline(always)]
    pub fn longest(&self, accuracy: &Accuracy) -> E {
        let order = accuracy.order;
        let units = self.formula.units(&self.x, accuracy.tolerances);
        let zero = units[0].like(0.0);
        let (mut before, mut last) = (zero, zero);
        let mut c = 0;
        while c < C {
            let one_over = zero.like(1.0) / units[c];
            before = Element::max(before, (self.coefficient(c, order - 1) * one_over).abs());
            last = Element::max(last, (self.coefficient(c, order) * one_over).abs());
            c += 1;
        }
        let before = before.largest_over_interfaces().rough_log2();
        let last = last.largest_over_interfaces().rough_log2();
        let log = Element::min(
            before * zero.like(-1.0 / (order - 1) as f64),
            last * zero.like(-1.0 / order as f64),
        );
        // Where the last term is larger than the one before, that is mostly chance.
        let log = if (before - last - log).none_negative() {
            log
        } else {
            self.while_terms_fall(order, &units, log)
        };
        zero.like(SAFETY) * log.rough_exp2()
    }

    /// The logarithm of a step, shortened to where the last terms cease to grow.
    ///
    /// Small terms bound the rest of the series only where they fall. Those of an exponential of 30 h are small and grow up to
    /// the thirtieth if its factor is small enough.
    #[inline(always)]
    fn while_terms_fall(&self, order: usize, units: &[E; C], log: E) -> E {
        /// Coefficients below two to this say nothing.
        const NONE: f64 = -900.0;
        let zero = log.like(0.0);
        let first = self.pair(order - 4, units);
        let (second, third) = (self.pair(order - 2, units), self.pair(order, units));
        let two = log + log;
        let grown = third - second + two;
        let grow = Element::min(grown, second - first + two);
        let grow = (first - zero.like(NONE)).if_positive(grow, zero);
        grow.if_positive(log - grown * zero.like(0.5), log)
    }

    /// The logarithm of the largest coefficient of order j or j - 1. By pairs: the terms of an even or odd function vanish in turn.
    #[inline(always)]
    fn pair(&self, j: usize, units: &[E; C]) -> E {
        let mut largest = units[0].like(0.0);
        let mut c = 0;
        while c < C {
            for j in [j - 1, j] {
                largest = Element::max(largest, (self.coefficient(c, j) / units[c]).abs());
            }
            c += 1;
        }
        largest.largest_over_interfaces().rough_log2()
    }

    /// The step h, cut just behind the zero of the stress, where the formula has a kink: a series does not reach beyond. By bisection, for it happens once in a run.
    #[cold]
    fn up_to_kink(&self, order: usize, h: E) -> E {
        let start = self.x[0];
        let zero = h.like(0.0);
        let crosses = self.sum(order, h).0[0] * start;
        let (mut near, mut far) = (crosses.if_negative(zero, h), h);
        for _ in 0..BISECTIONS {
            let middle = (near + far) * h.like(0.5);
            let sign = self.sum(order, middle).0[0] * start;
            near = sign.if_negative(near, middle);
            far = sign.if_negative(middle, far);
        }
        far
    }

    /// The state after h units, and what rounding took from it. With the order a constant the sums are unrolled.
    #[inline(always)]
    fn evaluate(&self, order: usize, h: E) -> ([E; C], [E; C]) {
        match order {
            12 => self.sum(12, h),
            16 => self.sum(16, h),
            18 => self.sum(18, h),
            20 => self.sum(20, h),
            24 => self.sum(24, h),
            _ => self.sum(order, h),
        }
    }

    #[inline(always)]
    fn sum(&self, order: usize, h: E) -> ([E; C], [E; C]) {
        let (mut x, mut lost) = (self.x, self.lost);
        let squared = h * h;
        let mut c = 0;
        while c < C {
            // Even and odd terms apart: two short chains instead of a long one. All orders are even.
            let mut even = self.coefficient(c, order);
            let mut odd = self.coefficient(c, order - 1);
            let mut j = order - 2;
            while j > 0 {
                even = even.mul_add(squared, self.coefficient(c, j));
                odd = odd.mul_add(squared, self.coefficient(c, j - 1));
                j -= 2;
            }
            let change = even.mul_add(squared, odd.mul_add(h, self.lost[c]));
            let start = self.x[c];
            let sum = start + change;
            x[c] = sum;
            lost[c] = change - (sum - start);
            c += 1;
        }
        (x, lost)
    }
}
