//! Solutions of a recorded formula: any system in any number of variables, in numbers of any kind.
//!
//! The series come from a [`Program`]. How far a series is followed, its end decides: [`advance`].

mod advance;
mod held_powers;
mod transported;

pub(super) use transported::Transported;

use super::compiled::Compiled;
use super::element::{Element, rough_exp2, rough_log2};
use super::program::{Program, Source};
use super::program_rows::ProgramRows;
use super::{Accuracy, usual_order};
use crate::number::DoubleDouble;
use crate::number::polynomial::Root;
use pulp::NullaryFnOnce;

/// Part of the estimated step that is taken.
pub(super) const SAFETY: f64 = 0.95;
/// By which the unit of time is shortened while the coefficients overflow, and how often.
pub(super) const SHORTER: f64 = 1.0 / (1u64 << 40) as f64;
pub(super) const SHORTER_UNITS: usize = 24;
/// Size that a state of zeros is given, whose rates it shall divide without overflow.
pub(super) const LEAST: f64 = 1e-150;
/// Bisections of a step: enough for the last bit.
pub(super) const BISECTIONS: usize = 64;

/// Records the formula at a state.
pub(super) type RecordFormula<'a> = Box<dyn Fn(&[f64]) -> Program + 'a>;

/// A program, and what records it anew: needed where it holds only where it was recorded.
pub(super) type Anew<'a> = (Program, Option<RecordFormula<'a>>);

/// A solution on its way, in a number of dimensions known when the program runs.
pub(super) trait Trajectory {
    /// As [`super::Solution::order`].
    fn order(&self, rtol: f64) -> usize {
        usual_order(rtol)
    }
    /// Whether it is that of these values of the parameters.
    fn is_at(&self, _parameters: &[f64]) -> bool {
        false
    }
    /// Takes over these values, where these variables are factors of their own rates. Returns whether it could: where its program does not hold for
    /// them it is to be dropped. Solutions that are made but once don't ask.
    fn set(&mut self, _parameters: &[f64], _own_factors: &[bool]) -> bool {
        false
    }
    /// Begins at y.
    fn start(&mut self, y: &[f64]);
    /// As [`super::Solution::advance`].
    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble;
    /// How many steps, or parts of them, were tried and not taken since the start.
    fn rejected(&self) -> usize;
    /// The i-th variable of the state reached.
    fn state(&self, i: usize) -> f64;
    /// The unit of time of the last step's series.
    fn unit(&self) -> f64;
    /// The first coefficients of the i-th variable's series, as many as there is room for.
    fn series(&self, i: usize, into: &mut [f64]);
    /// How many interfaces slide.
    fn sliding(&self) -> usize;
    /// The same of the slip rate of an interface; zeros where there is none.
    fn slip_rates(&self, interface: usize, into: &mut [f64]);
    /// In how many parameters it has derivatives.
    fn free(&self) -> usize {
        0
    }
    /// The derivative of the i-th variable in a component of the start, or after these in a parameter; zero if not asked for.
    fn derivative(&self, _i: usize, _direction: usize) -> f64 {
        0.0
    }
    /// The k-th coefficients of the i-th variable's derivatives in all directions; none if not asked for.
    fn derivative_level(&self, _i: usize, _k: usize, _into: &mut Vec<f64>) {}
    /// The integral of the Jacobian's trace, and the logarithm of the growth across a symmetric subspace.
    fn log_growth(&self) -> (f64, Option<f64>) {
        (0.0, None)
    }
}

/// A solution on its way, in numbers T. What the program gives first are the rates of the variables; what it gives after them
/// as many slip rates as `watched` says are kept with its series.
///
/// In two lanes ([`Program::in_two_lanes`]) two variables share a row, and x is as many numbers less.
pub struct Interpreted<'a, T: Element> {
    record: Option<RecordFormula<'a>>,
    program: Program,
    rows: ProgramRows<T>,
    /// The rows' formula as machine code; none where it is recorded anew at every step.
    compiled: Option<Compiled<T>>,
    /// For the first coefficients elsewhere than where the series begin.
    probe: ProgramRows<T>,
    /// Whether these are the ones at the state reached.
    probed: bool,
    /// Whether the rows hold the first coefficients there, as where a solution begins.
    begun: bool,
    room: usize,
    reached: Reached<T>,
    /// Where a step may lead.
    next: Reached<T>,
    any: T,
    watched: usize,
    /// The unit of time of the series, and of the next one. The coefficients neither overflow nor vanish if it is near the
    /// step.
    unit: f64,
    next_unit: f64,
    /// Steps, or parts of them, that were not taken.
    rejected: usize,
    zeros: Vec<Root>,
    /// What the rates are off without a reason, where that has been measured.
    noise: Vec<T>,
    /// The derivatives of the series where a step may lead.
    slopes: Vec<T>,
    /// The step over a zero of the base of a power, in units of the series; 0 where it leads over none.
    crossing: f64,
    /// The largest absolute values that the variables had where steps began, if there are such bases.
    largest_so_far: Vec<T>,
    /// Whether a variable is counted relative to itself alone, as it is a factor of its own rate.
    relative: Vec<bool>,
}

/// A state, and what rounding took from it.
#[derive(Clone)]
struct Reached<T> {
    x: Vec<T>,
    lost: Vec<T>,
}

impl<'a, T: Element> Interpreted<'a, T> {
    /// To be started, with room for so many coefficients; `any` is any number.
    pub(super) fn new((program, record): Anew<'a>, watched: usize, room: usize, any: T) -> Self {
        let zeros = vec![any.like(0.0); program.variables()];
        let reached = Reached {
            x: zeros.clone(),
            lost: zeros.clone(),
        };
        let rows = ProgramRows::new(&program, room, any);
        let compiled = (!program.branches).then(|| Compiled::of(&rows, any));
        Interpreted {
            compiled: compiled.flatten(),
            rows,
            probe: ProgramRows::new(&program, 1, any),
            probed: false,
            begun: false,
            record,
            room,
            next: reached.clone(),
            reached,
            any,
            watched,
            unit: 1.0,
            next_unit: 1.0,
            rejected: 0,
            zeros: Vec::new(),
            noise: zeros.clone(),
            slopes: zeros.clone(),
            crossing: 0.0,
            largest_so_far: zeros,
            relative: program.relative(),
            program,
        }
    }

    /// What a step may err in the i-th row of variables where that is of this size.
    #[inline(always)]
    fn may_err(&self, i: usize, size: T, (rtol, atol): (f64, f64)) -> T {
        let atol = if self.relative[i] {
            f64::MIN_POSITIVE
        } else {
            atol
        };
        let may_err = size.mul_add(size.like(rtol), size.like(atol));
        if self.crossing != 0.0 {
            Element::max(may_err, self.rounding_of_sign(i))
        } else {
            may_err
        }
    }

    /// Begins at x.
    pub(super) fn begin(&mut self, x: &[T]) {
        self.reached.x.copy_from_slice(x);
        self.reached.lost.fill(self.any.like(0.0));
        self.largest_so_far.fill(self.any.like(0.0));
        self.noise.fill(self.any.like(0.0));
        self.crossing = 0.0;
        self.probed = false;
        self.begun = false;
        self.rejected = 0;
        self.record_here();
        self.begun = true;
        // The time in which the state would change by its own size; of a variable that is zero, by the rounding of the largest. A series that
        // ends after its second term, as that of time, asks for no unit.
        let ends = |i: &usize| matches!(self.program.outputs[*i], Source::Number(_));
        let rows = || (0..self.reached.x.len()).filter(|i| !ends(i));
        let size = |i: usize| self.reached.x[i].abs();
        let largest = rows().map(|i| size(i).largest_lane()).fold(0.0, f64::max);
        if largest == 0.0 {
            // Nothing says in what time they change: as long as a step may be.
            self.next_unit = power_of_two(f64::MAX);
            return;
        }
        let least = self.any.like(f64::max(LEAST, largest * f64::EPSILON));
        let rate = |i: usize| {
            (self.rows.rate(i) / size(i).max(least))
                .abs()
                .largest_lane()
        };
        let rate = rows().map(rate).fold(0.0, f64::max);
        self.next_unit = power_of_two(1.0 / f64::max(rate, f64::MIN_POSITIVE));
    }

    /// The formula as it is here, if it is not the same everywhere, and the first coefficients.
    #[inline(always)]
    fn record_here(&mut self) {
        if std::mem::take(&mut self.begun) {
            return;
        }
        if self.program.branches
            && let Some(record) = &self.record
        {
            let x: Vec<f64> = self.reached.x.iter().map(|x| x.first()).collect();
            self.program = record(&x);
            self.rows = ProgramRows::new(&self.program, self.room, self.any);
            self.probe = ProgramRows::new(&self.program, 1, self.any);
            self.probed = false;
        }
        if self.probed {
            self.rows.begin_as(&self.probe);
        } else {
            self.rows.begin(&self.reached.x);
        }
    }

    /// Makes the unit of the next series no longer than a step may be. At a steady state nothing says how long that is, and series of
    /// derivatives would overflow.
    #[inline(always)]
    pub(super) fn stay_within(&mut self, limit: DoubleDouble) {
        self.next_unit = self.next_unit.min(power_of_two(limit.hi().abs()));
    }

    /// The state reached.
    pub(super) fn reached(&self) -> &[T] {
        &self.reached.x
    }

    /// What the program gives, and its series.
    pub(super) fn made(&self) -> (&Program, &ProgramRows<T>) {
        (&self.program, &self.rows)
    }

    /// Makes the series at the state reached.
    #[inline(always)]
    pub(super) fn expand(&mut self, order: usize) {
        self.unit = self.next_unit;
        self.record_here();
        let powers = !self.program.bases.is_empty();
        for _ in 0..=SHORTER_UNITS {
            let unit = self.any.like(self.unit);
            let (mut k, mut anew) = (0, powers);
            let mut may_compile = true;
            while k < order {
                if k == 0 {
                    self.rows.prepare();
                    self.rows.integrate(unit);
                } else {
                    if !anew && may_compile {
                        // Once in a step: each time it asks counts as one.
                        may_compile = false;
                        if let Some(compiled) = &mut self.compiled
                            && compiled.expand(&mut self.rows, order, unit)
                        {
                            break;
                        }
                    }
                    self.rows.level(k, unit);
                }
                k += 1;
                if k == 2 && anew {
                    anew = false;
                    if self.hold_powers() {
                        k = 0;
                    }
                }
            }
            // Close to a steady state the state changes by its own size in no time that is near the step; in a shorter unit the
            // coefficients do not overflow.
            if (0..self.reached.x.len()).all(|i| self.rows.row(i)[order].all_finite()) {
                break;
            }
            self.unit *= SHORTER;
        }
    }

    /// The step, in units of the series, at which the last two terms of the series reach what may err (Jorba & Zou 2005, section
    /// 3.2, in the norm that the tolerances make).
    #[inline(always)]
    pub(super) fn longest(&self, accuracy: &Accuracy) -> f64 {
        let (log, falls) = self.by_last_terms(accuracy);
        let log = if falls {
            log
        } else {
            self.while_terms_fall(accuracy, log)
        };
        SAFETY * rough_exp2(log)
    }

    /// The logarithm of the step at which the last two terms reach what may err, and whether the last one falls: where it is larger than the one
    /// before, that is mostly chance.
    #[inline(always)]
    fn by_last_terms(&self, accuracy: &Accuracy) -> (f64, bool) {
        let order = accuracy.order;
        let log_of = |j: usize| rough_log2(self.largest(j, accuracy.tolerances));
        let (before, last) = (log_of(order - 1), log_of(order));
        let log = f64::min(-before / (order - 1) as f64, -last / order as f64);
        (log, before - last - log >= 0.0)
    }

    /// The largest j-th coefficient, in what may err. A loop: a closure would not be compiled for the processor.
    #[inline(always)]
    fn largest(&self, j: usize, tolerances: (f64, f64)) -> f64 {
        let mut largest = 0.0;
        for (i, x) in self.reached.x.iter().enumerate() {
            let may_err = self.may_err(i, x.abs(), tolerances);
            let relative = (self.rows.row(i)[j] / may_err).abs().largest_lane();
            largest = f64::max(largest, relative);
        }
        largest
    }

    /// The logarithm of a step, shortened to where the last terms cease to grow.
    ///
    /// Small terms bound the rest of the series only where they fall. Those of an exponential of 30 h are small and grow up to
    /// the thirtieth if its factor is small enough.
    #[inline(always)]
    fn while_terms_fall(&self, accuracy: &Accuracy, log: f64) -> f64 {
        /// Coefficients below two to this say nothing.
        const NONE: f64 = -900.0;
        // By pairs: the terms of an even or odd function vanish in turn.
        let pair = |j: usize| {
            let of = |j| self.largest(j, accuracy.tolerances);
            rough_log2(f64::max(of(j - 1), of(j)))
        };
        let order = accuracy.order;
        let (first, second, third) = (pair(order - 4), pair(order - 2), pair(order));
        let grown = third - second + 2.0 * log;
        let grow = f64::min(grown, second - first + 2.0 * log);
        if first > NONE && grow > 0.0 {
            log - 0.5 * grown
        } else {
            log
        }
    }
}

/// A step.
struct Advance<'s, 'a, T: Element> {
    solution: &'s mut Interpreted<'a, T>,
    accuracy: &'s Accuracy,
    limit: DoubleDouble,
}

impl<T: Element> NullaryFnOnce for Advance<'_, '_, T> {
    type Output = DoubleDouble;

    #[inline(always)]
    fn call(self) -> DoubleDouble {
        let Advance {
            solution,
            accuracy,
            limit,
        } = self;
        solution.stay_within(limit);
        solution.expand(accuracy.order);
        let h = solution.longest(accuracy);
        let h = solution.over_zero(accuracy, h, limit);
        solution.advance_by(accuracy, h, limit)
    }
}

/// The power of two that is next below x > 0: units of time that are such take nothing from coefficients.
#[inline(always)]
fn power_of_two(x: f64) -> f64 {
    f64::max(
        f64::from_bits(x.to_bits() & f64::INFINITY.to_bits()),
        f64::MIN_POSITIVE,
    )
}

#[inline(always)]
fn finite<T: Element>(x: &[T]) -> bool {
    x.iter().all(|x| x.all_finite())
}

impl<T: Element> Trajectory for Interpreted<'_, T> {
    /// The order rises within every two decades, so that a run and the tighter run that estimates its error have different orders. Where all
    /// steps of both end at the same kinks, runs of one order would have the same error. Higher orders gain nothing, and fail sooner next to
    /// a singularity of the formula. Below the last of these tolerances only rounding errors are left, which grow with the order.
    fn order(&self, rtol: f64) -> usize {
        const FROM: [(f64, usize); 5] = [
            (3e-7, 12),
            (3e-9, 16),
            (3e-11, 20),
            (3e-13, 22),
            (9e-15, 24),
        ];
        const FINEST: usize = 20;
        let least = FROM.iter().find(|(above, _)| rtol > *above);
        least.map_or(FINEST, |(_, order)| *order)
    }

    fn is_at(&self, parameters: &[f64]) -> bool {
        self.program.constants.are_at(parameters)
    }

    fn set(&mut self, parameters: &[f64], own_factors: &[bool]) -> bool {
        let program = &mut self.program;
        program.own_factors.copy_from_slice(own_factors);
        self.relative = program.relative();
        let compiled = &mut self.compiled;
        program.constants.set(parameters)
            && self.rows.set(program)
            && self.probe.set(program)
            && compiled.as_mut().is_none_or(|one| one.set(&self.rows))
    }

    fn start(&mut self, y: &[f64]) {
        let mut x = std::mem::take(&mut self.next.x);
        for (&(row, lane), &y) in self.program.places.iter().zip(y) {
            // The first lane fills all, as of rows that have but one number.
            x[row] = if lane == 0 {
                self.any.like(y)
            } else {
                x[row].with_lane(lane, y)
            };
        }
        self.begin(&x);
        self.next.x = x;
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        self.any.run(Advance {
            accuracy,
            limit,
            solution: self,
        })
    }

    fn rejected(&self) -> usize {
        self.rejected
    }

    fn state(&self, i: usize) -> f64 {
        let (row, lane) = self.program.places[i];
        self.reached.x[row].lane(lane)
    }

    fn unit(&self) -> f64 {
        self.unit
    }

    fn series(&self, i: usize, into: &mut [f64]) {
        let (row, lane) = self.program.places[i];
        for (to, x) in into.iter_mut().zip(self.rows.row(row)) {
            *to = x.lane(lane);
        }
    }

    fn sliding(&self) -> usize {
        self.watched
    }

    fn slip_rates(&self, interface: usize, into: &mut [f64]) {
        if self.watched == 0 {
            return;
        }
        // A single interface stands in both places.
        let at = self.reached.x.len() + interface.min(self.watched - 1);
        let (rate, lane) = (self.program.output(at), self.program.lanes[at]);
        for (k, to) in into.iter_mut().enumerate() {
            *to = self.rows.coefficient(rate, k).lane(lane);
        }
    }
}
