//! Non-integer powers near a zero of their base: held constant where it is next to 0, or may be all rounding; and the steps that lead over it.

use super::{Interpreted, SAFETY, rough_exp2};
use crate::number::DoubleDouble;
use crate::series::Accuracy;
use crate::series::element::Element;
use crate::series::rounding::rounding;

impl<T: Element> Interpreted<'_, T> {
    /// Holds the powers of bases that are next to 0 constant in the series that is begun, and no others. Returns whether this differs from the
    /// series before.
    #[inline(always)]
    pub(super) fn hold_powers(&mut self) -> bool {
        let off = self.noise_of_bases();
        let off = |row: usize| off.as_ref().map_or(0.0, |off| off[row]);
        self.rows
            .hold_powers(|row, base| is_next_to_zero(base, off(row)))
    }

    /// The step h, or one that leads over the zero of a base, if that is nearer than where the last terms of the series say that they matter.
    ///
    /// No series converges beyond the zero, and the growth of the terms shows this: steps that end where they cease to fall come closer to the zero
    /// for ever. Next to it the power is so small in what the state may err that its series is good enough beyond; the check at the end of the step,
    /// without what it grants other steps, says whether it is.
    #[inline(always)]
    pub(super) fn over_zero(&mut self, accuracy: &Accuracy, h: f64, limit: DoubleDouble) -> f64 {
        if self.program.bases.is_empty() {
            return h;
        }
        self.over_nearest_zero(accuracy, h, limit.hi())
    }

    #[cold]
    fn over_nearest_zero(&mut self, accuracy: &Accuracy, h: f64, limit: f64) -> f64 {
        /// In distances from the zero that the first two terms of the base have.
        const BEYOND: f64 = 1.25;
        for (largest, x) in self.largest_so_far.iter_mut().zip(&self.reached.x) {
            *largest = Element::max(*largest, x.abs());
        }
        let nearest = self
            .program
            .bases
            .iter()
            .flat_map(|&row| (0..T::LANES).map(move |lane| (row, lane)))
            .map(|(row, lane)| self.first_order_zero(row, lane) * limit.signum())
            .filter(|&zero| zero > 0.0)
            .fold(f64::INFINITY, f64::min);
        let beyond = BEYOND * nearest;
        if beyond < h || beyond >= (limit / self.unit).abs() {
            return h;
        }
        self.crossing = beyond.copysign(limit);
        let (most, _) = self.by_last_terms(accuracy);
        if beyond < SAFETY * rough_exp2(most) {
            return beyond;
        }
        self.crossing = 0.0;
        h
    }

    /// What a variable may err in a step over a zero that changes its sign: it is not known better than to the rounding of what it was.
    #[cold]
    pub(super) fn rounding_of_sign(&self, i: usize) -> T {
        let mut rounding = self.any.like(0.0);
        for lane in 0..T::LANES {
            if self.crosses_zero(i, lane) {
                let x = self.largest_so_far[i].lane(lane);
                rounding = rounding.with_lane(lane, f64::EPSILON * x);
            }
        }
        rounding
    }

    /// Where the first two terms of a row have a zero.
    fn first_order_zero(&self, row: usize, lane: usize) -> f64 {
        let [first, change] = [0, 1].map(|k| self.rows.row(row)[k].lane(lane));
        -first / change
    }

    /// Whether a step leads over the zero of a base of a power, and this row has a zero in it as well.
    #[inline(always)]
    pub(super) fn crosses_zero(&self, row: usize, lane: usize) -> bool {
        let crossed = |zero: f64| zero > 0.0 && zero < 1.0;
        self.crossing != 0.0 && crossed(self.first_order_zero(row, lane) / self.crossing)
    }

    /// Bounds on the rounding errors of all rows, if a base of a power is so close to 0 that it may be nothing but rounding error, as |x + y| is
    /// behind its kink. `None` otherwise: this is not computed in ordinary steps.
    #[inline(always)]
    fn noise_of_bases(&self) -> Option<Vec<f64>> {
        /// In changes of the base in about a step.
        const NEAR: f64 = 1e-6;
        let near = |&row: &usize| {
            let [first, change] = [0, 1].map(|k| self.rows.row(row)[k].abs());
            (0..T::LANES).any(|lane| first.lane(lane) <= NEAR * change.lane(lane))
        };
        if !self.program.bases.iter().any(near) {
            return None;
        }
        let mut most = vec![0.0_f64; self.program.rows()];
        for lane in 0..T::LANES {
            let off = rounding(&self.program, |row| self.rows.row(row)[0].lane(lane));
            for (most, off) in most.iter_mut().zip(off) {
                *most = most.max(off);
            }
        }
        Some(most)
    }
}

/// Whether a row begins so close to 0 that the series of its non-integer powers converge only on a negligible part of a step. Such powers are
/// held constant, and the check at the end of the step limits its length. So are those of a row that is rounding, which is up to `off`.
fn is_next_to_zero<T: Element>(row: &[T], off: f64) -> bool {
    /// In changes of the row in the unit of time, which is about a step.
    const NEXT: f64 = 1.0 / (1_u64 << 44) as f64;
    (0..T::LANES).any(|lane| {
        let [first, change] = [0, 1].map(|k| row[k].lane(lane).abs());
        change > 0.0 && first <= f64::max(NEXT * change, off)
    })
}
