//! The end of a step: a series is followed only as far as it is the solution.
//!
//! A series knows its formula from one point. It does not see a switch whose trace at that point is below rounding, nor what lies
//! beyond a branch point of a root; and behind a zero of a quantity whose sign the formula takes it is the solution of another formula.
//! So the rates where a step ends, which the next step begins with, are compared with the derivative of the series there, and the zeros
//! of these quantities within the step are found.

use super::{BISECTIONS, Interpreted, Reached, finite, power_of_two};
use crate::number::DoubleDouble;
use crate::number::polynomial::{Crossing, roots};
use crate::series::element::Element;
use crate::series::program::Source;
use crate::series::rounding::rounding;
use crate::series::{Accuracy, REFERENCE_ORDER};

/// How far the rates at the end of a step may be off the derivative of the series: times the length of the step, in units of what the
/// state may err. The terms that a series of order p leaves out are p times as large in its derivative, and a solution that decays
/// within the step makes as much of them again.
const EXPLAINED: f64 = 3000.0;
/// Rounding of the rates, in units of themselves.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// How much more than what rounding makes of the rates at both ends it may make of the series between.
const NOISIER: f64 = 8.0;
/// Where a series is compared with the rates before a kink or a branch point: at that itself a formula may have no value.
const BEFORE: f64 = 0.999;
/// The part of a step at which the series is compared with the rates beside its end: what rises and falls again within a step is seen there.
const MIDDLE: f64 = 0.5;
/// Times that a step is halved: one that begins at the zero of a power's base is next to nothing where values may not err absolutely.
const HALVINGS: usize = 200;
/// What leads behind a branch point.
const BEHIND: f64 = 1.0 + 4.0 * f64::EPSILON;

impl<T: Element> Interpreted<'_, T> {
    /// Goes on by h > 0, counted in units of the series, at most `limit`, and returns the time that this took: not a number if
    /// there is no step.
    #[inline(always)]
    pub(in crate::series) fn advance_by(
        &mut self,
        accuracy: &Accuracy,
        h: f64,
        limit: DoubleDouble,
    ) -> DoubleDouble {
        let in_units = limit / self.unit;
        let whole = h >= in_units.hi().abs();
        let mut step = if whole {
            in_units
        } else {
            DoubleDouble::from(h.copysign(limit.hi()))
        };
        let mut time = if whole { limit } else { step * self.unit };
        let both = self.is_solution_at_both(accuracy, [step * MIDDLE, step]);
        let followed = both && self.kinks_converge(accuracy, step);
        if !followed || self.meets_kink(accuracy.order, step) {
            self.crossing = 0.0;
            step = self.shortened(accuracy, step);
            if !step.is_finite() {
                return step;
            }
            time = step * self.unit;
            self.look_at(accuracy.order, step);
        }
        self.crossing = 0.0;
        self.probed = true;
        std::mem::swap(&mut self.reached, &mut self.next);
        self.next_unit = power_of_two(time.hi().abs());
        time
    }

    /// A part of the step h at whose end the series is the solution, and which leads no further than just behind a kink; not a number
    /// where there is none.
    #[cold]
    #[inline(never)]
    fn shortened(&mut self, accuracy: &Accuracy, h: DoubleDouble) -> DoubleDouble {
        let shortened = self.without_noise(accuracy, h);
        self.noise.fill(self.any.like(0.0));
        shortened
    }

    /// The same, but for the noise of the rates.
    fn without_noise(&mut self, accuracy: &Accuracy, mut h: DoubleDouble) -> DoubleDouble {
        let order = accuracy.order;
        for _ in 0..HALVINGS {
            self.look_at(order, h);
            let end = if !finite(&self.next.x) || !self.kinks_converge(accuracy, h) {
                None
            } else if let Some(behind) = self.behind_kink(order, h) {
                self.cut(order, behind)
            } else if let Some(branch) = self.first_zero(order, h, Watched::Branches) {
                let at = DoubleDouble::from(branch.at);
                self.look_at(order, at * BEHIND);
                // Where a root is 0 to all digits the solution ends: steps come closer and closer.
                let ends = self.program.branch_points.iter().any(|&row| {
                    let root = self.probe.row(row)[0];
                    (0..T::LANES).any(|lane| root.lane(lane) == 0.0)
                });
                self.rejected += usize::from(ends);
                Some((at * BEFORE, at * if ends { BEFORE } else { BEHIND }))
            } else {
                Some((h, h))
            };
            if let Some((before, behind)) = end {
                let explained = [MIDDLE, 1.0].iter().all(|part| {
                    self.look_at(order, before * *part);
                    self.measure_noise();
                    self.is_solution(accuracy, before * *part)
                });
                if explained {
                    return behind;
                }
                h = before;
            }
            self.rejected += 1;
            h = h * 0.5;
        }
        DoubleDouble::from(f64::NAN)
    }

    /// The ends of a step before and just behind the kink that is first passed on the way to this step, which is behind it. By bisection:
    /// it happens once in a run.
    fn cut(&mut self, order: usize, behind: f64) -> Option<(DoubleDouble, DoubleDouble)> {
        let (mut near, mut far) = (DoubleDouble::ZERO, DoubleDouble::from(behind));
        for _ in 0..BISECTIONS {
            let middle = (near + far) * 0.5;
            self.look_at(order, middle);
            if self.passes_kink() {
                far = middle;
            } else {
                near = middle;
            }
        }
        Some((near * BEFORE, far))
    }

    /// The state at the end of this step, and all that the formula makes of it.
    #[inline(always)]
    fn look_at(&mut self, order: usize, h: DoubleDouble) {
        self.evaluate(order, h);
        self.probe.begin(&self.next.x);
    }

    /// Whether the series is the solution at these parts of a step, of which the last one is looked at then; at the other one the rates alone are.
    #[inline(always)]
    fn is_solution_at_both(&mut self, accuracy: &Accuracy, parts: [DoubleDouble; 2]) -> bool {
        let points = parts.map(|h| self.any.like_exact(h));
        let evaluated = match &mut self.compiled {
            Some(compiled) => compiled.evaluate(&self.rows, accuracy.order, points),
            None => false,
        };
        let mut explained = true;
        for (point, h) in parts.into_iter().enumerate() {
            match &self.compiled {
                Some(compiled) if evaluated => {
                    for i in 0..self.next.x.len() {
                        let [sum, slope] = compiled.end(i, point);
                        self.slopes[i] = slope;
                        self.next.arrive(i, &self.reached, sum, points[point]);
                    }
                }
                _ => self.evaluate(accuracy.order, h),
            }
            if point == 0 {
                self.probe.begin_rates(&self.next.x);
            } else {
                self.probe.begin(&self.next.x);
            }
            explained &= self.is_solution(accuracy, h);
        }
        explained
    }

    /// Whether the zeros of the quantities whose signs the formula takes can be found from their series within a step. Each series must either
    /// converge there, which those of the states do not show, or its first term must be so large that there is no zero.
    #[inline(always)]
    fn kinks_converge(&self, accuracy: &Accuracy, h: DoubleDouble) -> bool {
        let mut kinks = self.program.kinks.iter();
        kinks.all(|&row| {
            (0..T::LANES).all(|lane| {
                self.converges(accuracy, h.hi(), row, lane)
                    || self.has_no_zero(accuracy, h.hi(), row, lane)
                    || self.crosses_zero(row, lane)
            })
        })
    }

    /// Whether the first term of a row is larger than the sum of all others. Terms beyond the order are counted as those of a square root, which
    /// fall most slowly.
    #[cold]
    fn has_no_zero(&self, accuracy: &Accuracy, h: f64, row: usize, lane: usize) -> bool {
        let order = accuracy.order;
        let series = &self.rows.row(row)[..order];
        let (mut others, mut last, mut power) = (0.0_f64, 0.0_f64, h);
        for (j, c) in series.iter().enumerate().skip(1) {
            let term = (c.lane(lane) * power).abs();
            others += term;
            if j + 2 >= order {
                last = last.max(term);
            }
            power *= h;
        }
        series[0].lane(lane).abs() > others + 2.0 * order as f64 * last
    }

    /// Whether the last two terms of a row are small beside those of its first half.
    fn converges(&self, accuracy: &Accuracy, h: f64, row: usize, lane: usize) -> bool {
        /// In what the states may err relatively.
        const SMALL: f64 = 10.0;
        let order = accuracy.order;
        let (mut size, mut last, mut power) = (0.0_f64, 0.0_f64, 1.0);
        for (j, c) in self.rows.row(row)[..order].iter().enumerate() {
            let term = (c.lane(lane) * power).abs();
            if j < order / 2 {
                size = size.max(term);
            } else if j + 2 >= order {
                last = last.max(term);
            }
            power *= h;
        }
        last <= SMALL * accuracy.tolerances.0.max(f64::EPSILON) * size
    }

    /// Whether the rates at the end of the step, which has been looked at, are those of the series.
    #[inline(always)]
    fn is_solution(&self, accuracy: &Accuracy, h: DoubleDouble) -> bool {
        let step = self.any.like(h.hi().abs());
        let by_order = if self.crossing != 0.0 || self.holds_powers(accuracy.order) {
            1.0
        } else {
            EXPLAINED
        };
        let mut explained = finite(&self.next.x);
        for (i, x) in self.next.x.iter().enumerate() {
            let [slope, rate] = self.slope_and_rate(i);
            let largest = Element::max(x.abs(), self.reached.x[i].abs());
            let may_err = self.may_err(i, largest, accuracy.tolerances);
            let rounding =
                Element::max(slope.abs(), rate.abs()).mul_add(x.like(ROUNDING), self.noise[i]);
            let allowed = may_err.mul_add(x.like(by_order), rounding * step);
            // A number that is none is not explained.
            explained &= (allowed - (slope - rate).abs() * step).all_positive();
        }
        explained
    }

    /// Whether a power that is not whole is held as its base begins at 0, or next to it, and does not stay there: that is a series of order 0
    /// and not of that of the others.
    #[inline(always)]
    fn holds_powers(&self, order: usize) -> bool {
        let begins_at_zero = |&row: &usize| {
            let series = &self.rows.row(row)[..order];
            let is_zero = |x: T, lane: usize| x.lane(lane) == 0.0;
            (0..T::LANES)
                .any(|lane| is_zero(series[0], lane) && !series.iter().all(|x| is_zero(*x, lane)))
        };
        let bases = &self.program.bases;
        !bases.is_empty() && (self.rows.holds_powers() || bases.iter().any(begins_at_zero))
    }

    /// The derivative of the series of a variable at the end that was looked at, and the rate there, in units of the series.
    #[inline(always)]
    fn slope_and_rate(&self, i: usize) -> [T; 2] {
        let rate = self.probe.rate(i);
        [self.slopes[i], rate * self.any.like(self.unit)]
    }

    /// Measures what rounding makes of the rates of a formula that cancels, here and at the end that was looked at.
    fn measure_noise(&mut self) {
        self.noise.fill(self.any.like(0.0));
        for lane in 0..T::LANES {
            for rows in [&self.rows, &self.probe] {
                let off = rounding(&self.program, |row| rows.row(row)[0].lane(lane));
                for (i, noise) in self.noise.iter_mut().enumerate() {
                    if let Source::Row(row) = self.program.outputs[i] {
                        let off = NOISIER * self.unit * off[row];
                        *noise = noise.with_lane(lane, noise.lane(lane).max(off));
                    }
                }
            }
        }
    }

    /// Whether there is a zero, within the step or at its end, behind which the series is not the solution.
    #[inline(always)]
    fn meets_kink(&mut self, order: usize, h: DoubleDouble) -> bool {
        if self.program.kinks.is_empty() && self.program.branch_points.is_empty() {
            return false;
        }
        if self.crossing != 0.0 {
            // What is crossed itself is known; a root without a value at the end is seen by the check there.
            return self.first_zero(order, h, Watched::Kinks).is_some();
        }
        self.passes_kink()
            || self.first_zero(order, h, Watched::Kinks).is_some()
            || self.first_zero(order, h, Watched::Branches).is_some()
    }

    /// A part of the step at which a quantity whose sign the formula takes has another one.
    fn behind_kink(&mut self, order: usize, h: DoubleDouble) -> Option<f64> {
        if let Some(zero) = self.first_zero(order, h, Watched::Kinks) {
            let middle = 0.5 * (zero.at + zero.next);
            self.look_at(order, DoubleDouble::from(middle));
            // Two zeros that only rounding parts are none.
            if self.passes_kink() {
                return Some(middle);
            }
            self.look_at(order, h);
        }
        self.passes_kink().then(|| h.hi())
    }

    /// Whether a quantity whose sign the formula takes has another one at the end that was looked at.
    #[inline(always)]
    fn passes_kink(&self) -> bool {
        // A zero counts as positive, as where the formula takes its sign: what begins on a kink leaves it to either side.
        let changes = |&row: &usize| {
            let signs = self.rows.row(row)[0].sign() * self.probe.row(row)[0];
            (0..T::LANES).any(|lane| signs.lane(lane) < 0.0)
        };
        self.program.kinks.iter().any(changes)
    }

    /// The first zero of what is watched within the step, by its own series.
    fn first_zero(&mut self, order: usize, h: DoubleDouble, watched: Watched) -> Option<Zero> {
        let h = h.hi();
        let rows = match watched {
            Watched::Kinks => &self.program.kinks,
            Watched::Branches => &self.program.branch_points,
        };
        let mut first: Option<Zero> = None;
        for &row in rows {
            for lane in 0..T::LANES {
                if self.crosses_zero(row, lane) {
                    continue;
                }
                let mut series = [0.0; REFERENCE_ORDER + 1];
                let known = &mut series[..order];
                for (to, c) in known.iter_mut().zip(self.rows.row(row)) {
                    *to = c.lane(lane);
                }
                self.zeros.clear();
                roots(known, h, &mut self.zeros);
                let mut crossed = self
                    .zeros
                    .iter()
                    .filter(|zero| zero.crossing != Crossing::Touching);
                let Some(zero) = crossed.next() else { continue };
                if first.is_none_or(|first| zero.at.abs() < first.at.abs()) {
                    first = Some(Zero {
                        at: zero.at,
                        next: crossed.next().map_or(h, |next| next.at),
                    });
                }
            }
        }
        first
    }

    /// The state after h units, and what rounding took from it; and the derivatives of the series there.
    #[inline(always)]
    fn evaluate(&mut self, order: usize, h: DoubleDouble) {
        let h = self.any.like_exact(h);
        for i in 0..self.next.x.len() {
            let series = self.rows.row(i);
            let mut sum = series[order];
            let mut slope = self.any.like(0.0);
            for c in series[1..order].iter().rev() {
                slope = slope.mul_add(h, sum);
                sum = sum.mul_add(h, *c);
            }
            self.slopes[i] = slope.mul_add(h, sum);
            self.next.arrive(i, &self.reached, sum, h);
        }
    }
}

impl<T: Element> Reached<T> {
    /// Sets a variable to what it is h after another state, where the terms after the first of its series add up to h times this sum.
    #[inline(always)]
    fn arrive(&mut self, i: usize, from: &Self, sum: T, h: T) {
        let x = from.x[i];
        let change = sum.mul_add(h, from.lost[i]);
        let reached = x + change;
        self.x[i] = reached;
        self.lost[i] = change - (reached - x);
    }
}

/// Rows whose zeros end a step.
#[derive(Clone, Copy)]
enum Watched {
    /// Those whose signs the formula takes.
    Kinks,
    /// Roots: a series goes on to the other branch of them.
    Branches,
}

/// A zero within a step, and where the sign changes again or the step ends.
#[derive(Clone, Copy)]
struct Zero {
    at: f64,
    next: f64,
}
