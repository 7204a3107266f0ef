//! The way of a run: its clock, and the steps that its observer does not see.

use crate::error::Result;
use crate::field::State;
use crate::integrate::{Control, Step};
use crate::number::DoubleDouble;

/// Time in 31 digits: stress and state can change ten thousand times faster than time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    pub now: DoubleDouble,
    pub end: f64,
}

impl Clock {
    pub fn new((now, end): (f64, f64)) -> Self {
        let now = DoubleDouble::from(now);
        Clock { now, end }
    }

    /// The time to the end; `None` there.
    pub fn remaining(&self) -> Option<DoubleDouble> {
        let remaining = -(self.now - self.end);
        (remaining.hi() != 0.0).then_some(remaining)
    }

    /// Goes on by h, or says that time can't.
    pub fn tick(&mut self, h: DoubleDouble, remaining: DoubleDouble) -> bool {
        if h.hi() == remaining.hi() {
            self.now = DoubleDouble::from(self.end);
            return true;
        }
        // Runs in doubles take many a step: the short sum is as exact.
        let next = if h.lo() == 0.0 {
            self.now + h.hi()
        } else {
            self.now + h
        };
        // Nor is a step that is no number any progress.
        if !next.is_finite() || next.hi() == self.now.hi() {
            return false;
        }
        self.now = next;
        true
    }
}

/// Where a run has come to: the time, the state at the end of the last step seen, and what there was since.
pub(super) struct Way<const N: usize> {
    pub clock: Clock,
    pub y: State<N>,
    pub unseen: Unseen,
}

impl<const N: usize> Way<N> {
    /// Shows the steps that were not seen as one, of which the ends are known.
    pub fn show_unseen(
        &self,
        end: &State<N>,
        observer: &mut dyn FnMut(&Step<'_, N>) -> Result<Control>,
    ) -> Result<Control> {
        let t0 = self.unseen.since;
        observer(&Step {
            t0,
            y0: &self.y,
            t1: self.clock.now.hi(),
            y1: end,
            begin: DoubleDouble::from(t0),
            length: (self.clock.now - t0).hi(),
            continuous: &|time| if time == 0.0 { self.y } else { *end },
            reach: f64::INFINITY,
            expansion: None,
            slips: Some(&|| Some(self.unseen.and([0.0; 2]))),
        })
    }
}

/// Steps that an observer does not see.
#[derive(Default)]
pub(super) struct Unseen {
    /// How many more.
    pub steps: u32,
    /// Whether there were any, and when the first one began.
    pub passed: bool,
    since: f64,
    /// Their slips, and what rounding took from the sums.
    slips: [(f64, f64); 2],
}

impl Unseen {
    /// Whether a step passes unseen, which adds its slips to theirs. The last one does not, nor one whose slips are not had at once.
    pub fn passes(
        &mut self,
        last: bool,
        begin: f64,
        slips: impl FnOnce() -> Option<[f64; 2]>,
    ) -> bool {
        if self.steps == 0 || last {
            return false;
        }
        let Some(slips) = slips() else { return false };
        for ((sum, lost), slip) in self.slips.iter_mut().zip(slips) {
            // Of any two numbers the rounding of their sum is a number too (Knuth).
            let next = *sum + slip;
            let part = next - *sum;
            *lost += (*sum - (next - part)) + (slip - part);
            *sum = next;
        }
        self.steps -= 1;
        if !self.passed {
            (self.passed, self.since) = (true, begin);
        }
        true
    }

    /// With those of one step more.
    pub fn and(&self, slips: [f64; 2]) -> [DoubleDouble; 2] {
        [0, 1].map(|i| {
            let (sum, lost) = self.slips[i];
            DoubleDouble::from(sum) + lost + slips[i]
        })
    }
}
