//! The returns of one run to a section, recorded as they come.

use super::section::Surface;
use crate::error::{Error, Result};
use crate::field::{State, VectorField};
use crate::integrate::{Control, Integrator, Step};
use crate::number::bracketed_root;
use crate::series::{Passage, Section, Zeros};
use nalgebra::DMatrix;

/// Steps between two looks for an equilibrium.
const BETWEEN_LOOKS: usize = 32;
/// A start so close to an equilibrium, in every component, would leave it by rounding alone.
const AT_START: f64 = 1e-11;
/// Steps between two waypoints: over so few no tangent shrinks by more than doubles can tell from its largest.
const BETWEEN_WAYPOINTS: usize = 6;
/// Parts of a step without a series. As the slope is looked at too, a crossing is missed only where the dense output turns
/// three times in one of them.
const PARTS: usize = 4;

/// A point of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Return<const N: usize> {
    /// Its time.
    pub time: f64,
    /// The state there.
    pub state: State<N>,
}

/// How many returns are wanted, and how long to wait for them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watching {
    /// Returns that are let pass.
    pub skip: usize,
    /// Returns that are recorded after these.
    pub returns: usize,
    /// The longest time to wait for a return.
    pub patience: f64,
    /// The relative tolerance of the run: what its returns are good to follows from it.
    pub accuracy: f64,
    /// Whether waypoints are recorded too, for [`super::spectrum`].
    pub waypoints: bool,
}

impl Watching {
    /// An equilibrium is reached where each component of the state is so close to it.
    fn settled(&self) -> f64 {
        const LEAST: f64 = 1e-7;
        const PER_ACCURACY: f64 = 10.0;
        LEAST.max(PER_ACCURACY * self.accuracy)
    }
}

/// How a recording ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ended<const N: usize> {
    /// With all returns.
    Complete,
    /// At an equilibrium, which it can't leave.
    Steady {
        /// The time when it had come there; 0 if it began there.
        time: f64,
        /// The equilibrium.
        equilibrium: State<N>,
        /// Whether the run was drawn to it; an unstable one holds only a run that begins on it.
        stable: bool,
    },
    /// By the caller's word.
    Stopped,
    /// By an error; what was recorded before is good.
    Failed(Error),
}

/// What was recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Record<const N: usize> {
    /// The returns after those that were let pass.
    pub returns: Vec<Return<N>>,
    /// Points of the run between the first and the last of these, both included, a few steps apart.
    pub waypoints: Vec<Return<N>>,
    /// How it ended.
    pub ended: Ended<N>,
    /// The relative tolerance of the run.
    pub accuracy: f64,
}

/// Follows a run from `start` at time 0 and records its returns to the surface. `see` is told of every return, with the number
/// of those before it, and may end the recording; so may it after every step, where it is told of none.
///
/// A run that comes to a stable equilibrium ends there ([`Ended::Steady`]); one that wanders but does not return within the
/// patience ends as [`Ended::Failed`] with [`Error::NoReturn`].
pub fn record<const N: usize>(
    integrator: &mut dyn Integrator<N>,
    field: &dyn VectorField<N>,
    start: &State<N>,
    surface: &Surface<N>,
    watching: &Watching,
    see: &mut dyn FnMut(usize, Option<&Return<N>>) -> Control,
) -> Record<N> {
    if let Some((equilibrium, stable)) = equilibrium_near(field, start, AT_START) {
        return Record {
            returns: Vec::new(),
            waypoints: Vec::new(),
            ended: Ended::Steady {
                time: 0.0,
                equilibrium,
                stable,
            },
            accuracy: watching.accuracy,
        };
    }
    let mut recorder = Recorder::new(field, surface, watching, see);
    let all = (watching.skip + watching.returns) as f64;
    // The patience ends a run before this, but a flow needs an end.
    let span = (0.0, (all + 1.0) * watching.patience);
    let mut observer = |step: &Step<'_, N>| recorder.step(step);
    let flowed = integrator.flow(field, span, start, Some(&mut observer));
    let ended = match (flowed, recorder.ended.take()) {
        (Err(error), _) => Ended::Failed(error),
        (Ok(_), Some(ended)) => ended,
        (Ok(_), None) => Ended::Failed(recorder.no_return(span.1)),
    };
    let mut waypoints = recorder.waypoints;
    if let Some(last) = recorder.returns.last() {
        waypoints.retain(|point| point.time <= last.time);
    }
    Record {
        returns: recorder.returns,
        waypoints,
        ended,
        accuracy: watching.accuracy,
    }
}

/// The equilibrium within `distance` of a state in every component, by a step of Newton's method, and whether it is stable.
pub(super) fn equilibrium_near<const N: usize>(
    field: &dyn VectorField<N>,
    y: &State<N>,
    distance: f64,
) -> Option<(State<N>, bool)> {
    let jacobian = DMatrix::from_iterator(N, N, field.jacobian(y).iter().copied());
    let f = DMatrix::from_iterator(N, 1, field.f(y).iter().copied());
    let step = jacobian.clone().lu().solve(&f)?;
    if !step.iter().all(|x| x.abs() < distance) {
        return None;
    }
    let equilibrium = State::from_fn(|i, _| y[i] - step[i]);
    let stable = jacobian.complex_eigenvalues().iter().all(|z| z.re < 0.0);
    Some((equilibrium, stable))
}

/// Sees the steps of a run.
struct Recorder<'a, const N: usize> {
    field: &'a dyn VectorField<N>,
    surface: &'a Surface<N>,
    section: Section<N>,
    watching: &'a Watching,
    see: &'a mut dyn FnMut(usize, Option<&Return<N>>) -> Control,
    /// Of the height over the surface; its sign is carried over steps of either kind.
    zeros: Zeros,
    found: Vec<Passage<N>>,
    passed: usize,
    returns: Vec<Return<N>>,
    waypoints: Vec<Return<N>>,
    steps: usize,
    /// The time of the last return, and the lowest and highest height since.
    since: f64,
    range: (f64, f64),
    ended: Option<Ended<N>>,
}

impl<'a, const N: usize> Recorder<'a, N> {
    fn new(
        field: &'a dyn VectorField<N>,
        surface: &'a Surface<N>,
        watching: &'a Watching,
        see: &'a mut dyn FnMut(usize, Option<&Return<N>>) -> Control,
    ) -> Self {
        Recorder {
            field,
            surface,
            section: surface.section(),
            watching,
            see,
            zeros: Zeros::default(),
            found: Vec::new(),
            passed: 0,
            returns: Vec::new(),
            waypoints: Vec::new(),
            steps: 0,
            since: 0.0,
            range: (f64::INFINITY, f64::NEG_INFINITY),
            ended: None,
        }
    }

    fn step(&mut self, step: &Step<'_, N>) -> Result<Control> {
        self.steps += 1;
        self.found.clear();
        match step.series {
            Some(series) => {
                let direction = Some(self.surface.direction);
                series.crossings(&self.section, direction, &mut self.zeros, &mut self.found);
                for passage in &mut self.found {
                    passage.time = (series.begin + passage.time).hi();
                }
            }
            None => self.dense(step)?,
        }
        for k in 0..self.found.len() {
            let Passage { time, state, .. } = self.found[k];
            let state = State::from(state);
            self.arrive(Return { time, state });
            if self.ended.is_some() {
                return Ok(Control::Stop);
            }
        }
        let here = Return {
            time: step.t1,
            state: *step.y1,
        };
        if (self.see)(self.passed, None) == Control::Stop {
            self.ended = Some(Ended::Stopped);
        }
        self.between_returns(&here);
        Ok(if self.ended.is_some() {
            Control::Stop
        } else {
            Control::Continue
        })
    }

    fn arrive(&mut self, here: Return<N>) {
        let Watching { skip, returns, .. } = *self.watching;
        let recorded = self.passed >= skip;
        if recorded {
            self.returns.push(here);
            if self.watching.waypoints {
                self.waypoints.push(here);
            }
        }
        let told = (self.see)(self.passed, Some(&here));
        self.passed += 1;
        self.since = here.time;
        self.range = (f64::INFINITY, f64::NEG_INFINITY);
        // An equilibrium may lie on the section: then its noise returns for ever.
        self.look(&here);
        if self.ended.is_none() && self.passed == skip + returns {
            self.ended = Some(Ended::Complete);
        }
        if self.ended.is_none() && told == Control::Stop {
            self.ended = Some(Ended::Stopped);
        }
    }

    fn between_returns(&mut self, here: &Return<N>) {
        let height = self.surface.height(&here.state);
        self.range = (self.range.0.min(height), self.range.1.max(height));
        if self.steps.is_multiple_of(BETWEEN_WAYPOINTS)
            && self.watching.waypoints
            && !self.returns.is_empty()
        {
            self.waypoints.push(*here);
        }
        let late = here.time - self.since > self.watching.patience;
        if late || self.steps.is_multiple_of(BETWEEN_LOOKS) {
            self.look(here);
        }
        if late && self.ended.is_none() {
            self.ended = Some(Ended::Failed(self.no_return(here.time)));
        }
    }

    /// Ends at a stable equilibrium.
    fn look(&mut self, here: &Return<N>) {
        let near = equilibrium_near(self.field, &here.state, self.watching.settled());
        if let Some((equilibrium, stable @ true)) = near {
            self.ended = Some(Ended::Steady {
                time: here.time,
                equilibrium,
                stable,
            });
        }
    }

    fn no_return(&self, t: f64) -> Error {
        let offset = self.surface.offset;
        Error::NoReturn {
            since: self.since,
            t,
            section: offset,
            lowest: offset + self.range.0,
            highest: offset + self.range.1,
        }
    }

    /// The crossings within a step that has no series, by its dense output.
    fn dense(&mut self, step: &Step<'_, N>) -> Result<()> {
        let at = |t: f64| {
            if t == step.t1 {
                *step.y1
            } else {
                (step.dense)(t)
            }
        };
        let (surface, field) = (self.surface, self.field);
        let knot = |t: f64| {
            let y = at(t);
            let slope = surface.gradient(&y).dot(&field.f(&y));
            (t, surface.height(&y), slope)
        };
        let mut left = knot(step.t0);
        if self.zeros.sign == 0.0 {
            self.zeros.sign = if left.1 == 0.0 { left.2 } else { left.1 }.signum();
        }
        for part in 1..=PARTS {
            let t = if part == PARTS {
                step.t1
            } else {
                step.t0 + (step.t1 - step.t0) * part as f64 / PARTS as f64
            };
            let right = knot(t);
            let mut knots = vec![right];
            if left.2 * right.2 < 0.0 {
                let slope = |t: f64| (knot(t).2, f64::NAN);
                if let Ok(t) = bracketed_root("the extremum of a height", left.0, right.0, slope) {
                    knots.insert(0, knot(t));
                }
            }
            for right in knots {
                // At 0 the next knot decides.
                if right.1 * self.zeros.sign < 0.0 {
                    self.zeros.sign = -self.zeros.sign;
                    // The sign may have been lost at the joint of two steps.
                    let t = if left.1 * right.1 < 0.0 {
                        let height = |t: f64| {
                            let (_, height, slope) = knot(t);
                            (height, slope)
                        };
                        bracketed_root("the crossing of a section", left.0, right.0, height)?
                    } else {
                        left.0
                    };
                    if self.zeros.sign == surface.sign_behind() {
                        self.found.push(Passage {
                            time: t,
                            crossing: surface.direction,
                            state: at(t).data.0[0],
                        });
                    }
                }
                left = right;
            }
        }
        Ok(())
    }
}
