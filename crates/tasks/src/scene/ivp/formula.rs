//! Events that are formulas: within a step their zeros are isolated, so that none is missed.

use super::solution::IvpSolution;
use crate::scene::text::SystemFile;
use twinslip::error::{Error, Result};
use twinslip::model::TextSystem;
use twinslip::number::{Interval, Jet, Real};

/// A function of the user's values, and of time, as a formula.
#[derive(Debug, Clone, PartialEq)]
pub struct IvpFormula {
    /// Its first rate is the function.
    system: TextSystem,
}

/// The parts into which a step was divided.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Parts {
    /// Where they meet, from 0 at the beginning of the step to 1 at its end, both left out: in each part there is one zero at most.
    pub inner: Vec<f64>,
    /// How many parts were looked at.
    pub count: usize,
    /// Whether there are parts of which that is not known.
    pub undecided: bool,
}

impl IvpFormula {
    /// From the text of a system, whose first rate is the function: its states are so many values in their order, and it may name time.
    ///
    /// # Errors
    /// [`Error::Input`] for what is wrong in the text, and for another number of states.
    pub fn parse(text: &str, values: usize) -> Result<Self> {
        let system = SystemFile::parse("event", text)?.system;
        let count = system.states().len();
        if count != values {
            return Err(Error::Input(format!(
                "the formula of an event has {count} states, but must have the {values} values"
            )));
        }
        Ok(IvpFormula { system })
    }

    /// The function.
    pub fn at(&self, time: f64, values: &[f64]) -> f64 {
        self.of(values.to_vec(), time)
    }

    fn of<T: Real>(&self, mut x: Vec<T>, time: T) -> T {
        if self.system.is_timed() {
            x.push(time);
        }
        self.system.rates(&x)[0]
    }

    /// The function and its slope over a part of the last step of a solution.
    fn bounds(&self, steps: &IvpSolution, part: (f64, f64)) -> Jet<Interval, 1> {
        self.of(steps.bounds(part), steps.time_bounds(part))
    }

    /// Divides the last step of a solution until the function or its slope has one sign in each part, or the part can't be told from a
    /// point: bounds for both are by interval arithmetic. There are no more parts than `most`.
    pub(super) fn parts(&self, steps: &IvpSolution, most: usize) -> Parts {
        /// Of a step; a part that is narrower is not divided.
        const NARROW: f64 = 1.0 / (1_u64 << 40) as f64;
        /// What is smaller than so many times what is rounded there has no sign that could be told.
        const NOISE: f64 = 4.0;
        /// Of a step; where a part as wide as this is all rounding, or bounds are no better than that, zeros may be anywhere in it.
        const WIDE: f64 = 1.0 / 64.0;
        let mut made = Parts::default();
        let mut ends = Vec::new();
        let mut parts = vec![(0.0, 1.0)];
        while !parts.is_empty() {
            // All of one width, so that what is left over where there are too many is everywhere as fine.
            if made.count + parts.len() > most {
                made.undecided = true;
                ends.extend(parts.iter().flat_map(|&(a, b)| [a, b]));
                break;
            }
            made.count += parts.len();
            let mut halves = Vec::new();
            for part @ (begin, end) in parts {
                let middle = 0.5 * (begin + end);
                let bounds = self.bounds(steps, part);
                let [slope] = bounds.gradient;
                let at = self.bounds(steps, (middle, middle)).value;
                let half = 0.5 * (end - begin);
                let value = (at + slope * Interval::new(-half, half)).common(bounds.value);
                let decided = value.sign().is_some() || slope.sign().is_some();
                if decided || end - begin <= NARROW {
                    ends.extend([begin, end]);
                    continue;
                }
                let rounded = f64::MIN_POSITIVE + NOISE * (at.hi() - at.lo());
                let wide = value != Interval::constant(0.0) && end - begin >= WIDE;
                if value.distance_from(0.0) > rounded || (wide && end - begin > WIDE) {
                    halves.extend([(begin, middle), (middle, end)]);
                } else {
                    made.undecided |= wide;
                }
            }
            parts = halves;
        }
        ends.retain(|&u| u > 0.0 && u < 1.0);
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        made.inner = ends;
        made
    }
}
