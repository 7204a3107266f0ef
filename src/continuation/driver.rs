//! The steps along a curve, their control, and what is met on the way.

use super::detect::{Known, sign_changes};
use super::land::landed;
use super::{CurveStep, SolutionCurve, Stop, Watched};
use crate::error::Result;
use std::collections::VecDeque;
use std::ops::ControlFlow;

/// Limits of the steps, in units of the curve's own measure of length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepControl {
    /// The first step.
    pub first: f64,
    /// Never longer.
    pub longest: f64,
    /// Below this, in units of [`SolutionCurve::scale`], the curve is given up.
    pub shortest: f64,
    /// What the prediction may be off by, in the measure of [`SolutionCurve::correct`].
    pub error: f64,
    /// The tangents at both ends of a step have a scalar product greater than this.
    pub cosine: f64,
    /// A dozen steps in a row that do not grow and together are shorter than this part of the way so far are no progress.
    pub progress: f64,
}

/// So many steps tell whether there is progress.
const WINDOW: usize = 12;
/// The least and largest ratio of one step to the one before.
const RATIO: (f64, f64) = (0.5, 2.0);
/// By how much less than it may the direction is made to turn in the next step.
const SAFE: f64 = 0.8;
/// A step that fails is shortened to this.
const SHORTER: f64 = 0.4;
/// For points between that can't be corrected no step is made shorter than this part of the longest.
const FINE: f64 = 0.01;

/// A curve with the place on it and the next step's length.
pub struct Continuation<C: SolutionCurve> {
    /// What is followed.
    pub curve: C,
    /// Where it stands.
    pub now: C::Point,
    /// The next step.
    length: f64,
    control: StepControl,
    /// Whether the point has been described anew where it stands.
    renewed: bool,
    /// What is watched there, if it is known.
    known: Option<Known>,
    /// The way so far, and the last steps' lengths.
    travelled: f64,
    lengths: VecDeque<f64>,
}

/// Something that is met on the way.
pub enum Met<'a, C: SolutionCurve> {
    /// The next point.
    Point(&'a C::Point),
    /// A point where something that is watched is zero, to the accuracy of the continuation.
    Zero(Watched<C>, &'a C::Point),
}

/// Who is told of what is met: with the continuation, where its step began, described alike, and what that is.
pub type MetObserver<'t, C> = &'t mut dyn FnMut(
    &mut Continuation<C>,
    &<C as SolutionCurve>::Point,
    Met<'_, C>,
) -> ControlFlow<()>;

type Zeros<C> = Vec<(f64, Watched<C>, <C as SolutionCurve>::Point)>;

impl<C: SolutionCurve> Continuation<C> {
    /// From a point, in the direction of its tangent.
    pub fn new(curve: C, first: C::Point) -> Self {
        let control = curve.control();
        Continuation {
            curve,
            now: first,
            length: control.first,
            control,
            renewed: false,
            known: None,
            travelled: 0.0,
            lengths: VecDeque::new(),
        }
    }

    /// Going on with the next step and the way so far of another, as after a change of variables.
    pub fn resuming<D: SolutionCurve>(self, other: &Continuation<D>) -> Self {
        Continuation {
            length: other.length,
            travelled: other.travelled,
            renewed: true,
            ..self
        }
    }

    /// Follows the curve for so many points, past all that is watched.
    ///
    /// # Errors
    /// That something can't be watched on this curve.
    pub fn follow(
        &mut self,
        watches: &[Watched<C>],
        most: usize,
        met: MetObserver<'_, C>,
    ) -> Result<Stop> {
        for &watch in watches {
            self.curve.checked(watch)?;
        }
        self.known = None;
        for _ in 0..most {
            let step = match self.step() {
                Ok(step) => step,
                Err(stop) => return Ok(stop),
            };
            let Some(zeros) = self.zeros(&step, watches) else {
                self.back(step);
                continue;
            };
            for (_, watch, at) in &zeros {
                if met(self, &step.from, Met::Zero(*watch, at)).is_break() {
                    return Ok(Stop::Observer);
                }
            }
            if met(self, &step.from, Met::Point(&step.to)).is_break() {
                return Ok(Stop::Observer);
            }
            match self.curve.taken(&self.now) {
                Ok(None) => {}
                Ok(Some(now)) => self.renew(now),
                Err(stop) => return Ok(stop),
            }
        }
        Ok(Stop::MaxPoints(most))
    }

    /// The next step, at the end of which the continuation then stands. Its length is controlled asymptotically: the error of a
    /// prediction along the tangent grows with its square (den Heijer and Rheinboldt 1981, SIAM J. Numer. Anal. 18, 925-948).
    fn step(&mut self) -> Result<CurveStep<C::Point>, Stop> {
        self.progresses()?;
        let mut longest = self.control.longest * self.curve.stretch(&self.now);
        loop {
            let length = self.length;
            let failed = match self.curve.correct(&self.now, length) {
                Ok((next, error)) => {
                    let turn =
                        self.control.cosine.acos() / self.curve.cosine(&self.now, &next).acos();
                    // NaN where the direction does not turn at all.
                    let by_turn = if turn.is_finite() {
                        SAFE * turn
                    } else {
                        f64::INFINITY
                    };
                    if by_turn >= SAFE {
                        let ratio = (self.control.error / error).sqrt().min(by_turn);
                        let ratio = ratio.clamp(RATIO.0, RATIO.1);
                        return Ok(self.take(next, (length * ratio).min(longest)));
                    }
                    None
                }
                Err(error) => Some(error),
            };
            let least = self.control.shortest * self.curve.scale(&self.now);
            if let Some(now) = self.curve.failed(&self.now, self.renewed)? {
                self.renew(now);
            } else if length * SHORTER < least {
                return Err(Stop::StepTooSmall {
                    length,
                    because: failed,
                });
            }
            self.length *= SHORTER;
            // What has just failed is not tried again in the next step.
            longest = self.length;
        }
    }

    fn take(&mut self, next: C::Point, then: f64) -> CurveStep<C::Point> {
        let length = std::mem::replace(&mut self.length, then);
        self.renewed = false;
        self.travelled += length;
        self.lengths.push_back(length);
        if self.lengths.len() > WINDOW {
            self.lengths.pop_front();
        }
        CurveStep {
            from: std::mem::replace(&mut self.now, next.clone()),
            to: next,
            length,
        }
    }

    /// Takes a step back, to make a shorter one.
    fn back(&mut self, step: CurveStep<C::Point>) {
        self.now = step.from;
        self.length = SHORTER * step.length;
        self.travelled -= step.length;
        self.lengths.pop_back();
        self.known = None;
    }

    /// The same point otherwise described: neither the values nor the slopes of before can be compared with its own.
    fn renew(&mut self, now: C::Point) {
        self.now = now;
        self.renewed = true;
        self.known = None;
    }

    /// Whether the last steps lead somewhere: measured by the way so far, whatever the units of the variables.
    fn progresses(&self) -> Result<(), Stop> {
        let length: f64 = self.lengths.iter().sum();
        let grow = self.lengths.back() > self.lengths.front();
        let far = length > self.control.progress * self.travelled;
        if self.lengths.len() < WINDOW || grow || far {
            return Ok(());
        }
        Err(Stop::NoProgress {
            steps: WINDOW,
            length,
            travelled: self.travelled,
        })
    }

    /// All zeros on a step, in their order; `None` where it is to be taken back, as points between can't be corrected.
    fn zeros(&mut self, step: &CurveStep<C::Point>, watches: &[Watched<C>]) -> Option<Zeros<C>> {
        let (brackets, known) = sign_changes(&mut self.curve, step, self.known.take(), watches);
        self.known = Some(known);
        let (mut zeros, longest) = (Vec::new(), self.control.longest);
        for zero in brackets {
            let change = (zero.watch, zero.ends.each_ref().map(|end| end.value));
            match landed(&mut self.curve, step, &zero) {
                Ok(Some((distance, at))) if self.curve.certain(change, &at, step) => {
                    zeros.push((distance, zero.watch, at));
                }
                Ok(None) if self.curve.is_clear(change) && step.length > FINE * longest => {
                    return None;
                }
                // What can't be landed on is none: a sign that changes by noise, or through a pole.
                Ok(_) => {}
                Err(_) if step.length > FINE * longest => return None,
                Err(_) => {}
            }
        }
        // Of those at one place in the order in which they are watched.
        zeros.sort_by(|a, b| a.0.total_cmp(&b.0));
        Some(zeros)
    }
}
