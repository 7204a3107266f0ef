//! Non-integer powers that are held constant: those of what is next to 0, or may be all rounding.

use super::Interpreted;
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
