//! The returns of one run to a section, recorded as they come.

use super::dense::crossings;
use super::rest::{equilibrium_near, spirals_into};
use super::surface::Surface;
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::integrate::{AnyField, AnyIntegrator, AnyStep, Control, of_dimension};
use crate::series::{Passage, Zeros};

/// Steps between two looks for an equilibrium.
const BETWEEN_LOOKS: usize = 32;
/// A start so close to an equilibrium, in every component, would leave it by rounding alone.
pub(crate) const AT_START: f64 = 1e-11;
/// Steps between two waypoints: over so few no tangent shrinks by more than doubles can tell from its largest.
const BETWEEN_WAYPOINTS: usize = 6;
/// The part of the patience after which a run lingers, and into how many parts its steps are then divided to see how far it swings.
const LINGERING: f64 = 1.0 / 8.0;
const WITHIN: u32 = 4;

/// A point of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Return {
    /// Its time.
    pub time: f64,
    /// The state there.
    pub state: Vector,
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
    /// The largest step of the run, which is also that of what is computed along it.
    pub max_step: f64,
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

/// A patience that is enough: a time, for what heals, and times in which the loading alone raises the stress by one.
pub fn usual_patience(driving: f64, stiffness: f64) -> f64 {
    const HEALING: f64 = 1e4;
    const LOADINGS: f64 = 1e3;
    (HEALING + LOADINGS / (stiffness * driving)).min(f64::MAX)
}

/// How a recording ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ended {
    /// With all returns.
    Complete,
    /// At an equilibrium, which it can't leave.
    Steady {
        /// The time when it had come there; 0 if it began there.
        time: f64,
        /// The equilibrium.
        equilibrium: Vector,
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
pub struct ReturnRecord {
    /// The returns after those that were let pass.
    pub returns: Vec<Return>,
    /// Points of the run between the first and the last of these, both included, a few steps apart.
    pub waypoints: Vec<Return>,
    /// How it ended.
    pub ended: Ended,
    /// The relative tolerance of the run.
    pub accuracy: f64,
    /// Its largest step.
    pub max_step: f64,
}

/// Follows a run from `start` at time 0 and records its returns to the surface. `see` is told of every return, with the number
/// of those before it, and may end the recording; so may it after every step, where it is told of none.
///
/// A run that comes to a stable equilibrium ends there ([`Ended::Steady`]); one that wanders but does not return within the
/// patience ends as [`Ended::Failed`] with [`Error::NoReturn`], and one whose start or surface is of another dimension than the
/// field with [`Error::Parameter`].
pub fn record(
    integrator: &mut AnyIntegrator,
    field: &AnyField<'_>,
    start: &Vector,
    surface: &Surface,
    watching: &Watching,
    see: See<'_>,
) -> ReturnRecord {
    let nothing = |ended: Ended| ReturnRecord {
        returns: Vec::new(),
        waypoints: Vec::new(),
        ended,
        accuracy: watching.accuracy,
        max_step: watching.max_step,
    };
    let variables = field.dimension();
    let fits = of_dimension(start.len(), variables)
        .and_then(|()| of_dimension(surface.normal.len(), variables));
    if let Err(error) = fits {
        return nothing(Ended::Failed(error));
    }
    if let Some((equilibrium, stable)) = equilibrium_near(field, start.as_slice(), AT_START) {
        return nothing(Ended::Steady {
            time: 0.0,
            equilibrium,
            stable,
        });
    }
    let mut recorder = Recorder::new();
    let watched = Watched {
        field,
        surface,
        watching,
    };
    let all = (watching.skip + watching.returns) as f64;
    // The patience ends a run before this, but a flow needs an end.
    let span = (0.0, (2.0 * (all + 1.0) * watching.patience).min(f64::MAX));
    let mut observer = |step: &AnyStep<'_>| recorder.step(&watched, step, see);
    let flowed = integrator.flow(field, span, start, Some(&mut observer));
    let ended = match (flowed, recorder.ended.take()) {
        (Err(error), _) => Ended::Failed(error),
        (Ok(_), Some(ended)) => ended,
        (Ok(_), None) => Ended::Failed(recorder.no_return(surface, span.1)),
    };
    let mut waypoints = recorder.waypoints;
    if let Some(last) = recorder.returns.last() {
        waypoints.retain(|point| point.time <= last.time);
    }
    ReturnRecord {
        returns: recorder.returns,
        waypoints,
        ended,
        accuracy: watching.accuracy,
        max_step: watching.max_step,
    }
}

/// What a recorder watches a run by.
#[derive(Clone, Copy)]
pub(crate) struct Watched<'a> {
    pub field: &'a AnyField<'a>,
    pub surface: &'a Surface,
    pub watching: &'a Watching,
}

/// Told of every return, with the number of those before it, and of the end of every step, where it is told of none.
pub type See<'a> = &'a mut dyn FnMut(usize, Option<&Return>) -> Control;

/// Sees the steps of a run.
pub(crate) struct Recorder {
    /// Of the height over the surface; its sign is carried over steps of either kind.
    zeros: Zeros,
    found: Vec<Passage>,
    pub passed: usize,
    /// After those let pass.
    pub returns: Vec<Return>,
    waypoints: Vec<Return>,
    pub steps: usize,
    /// The time of the last return, and the lowest and highest height since.
    since: f64,
    range: (f64, f64),
    /// Whether that was long ago; the range is of what has been since then.
    lingering: bool,
    /// Where the patience has been over once: when, and how far the run had swung until then.
    window: Option<(f64, f64)>,
    pub ended: Option<Ended>,
}

impl Recorder {
    pub fn new() -> Self {
        Recorder {
            zeros: Zeros::default(),
            found: Vec::new(),
            passed: 0,
            returns: Vec::new(),
            waypoints: Vec::new(),
            steps: 0,
            since: 0.0,
            range: (f64::INFINITY, f64::NEG_INFINITY),
            lingering: false,
            window: None,
            ended: None,
        }
    }

    /// The run goes on from another state or to another surface: no crossing is due between.
    pub fn resume(&mut self, time: f64) {
        self.since = time;
        self.zeros.sign = 0.0;
        self.window = None;
        self.lingering = false;
        self.range = (f64::INFINITY, f64::NEG_INFINITY);
    }

    /// Sees a step, the next of the same run.
    pub fn step(
        &mut self,
        watched: &Watched<'_>,
        step: &AnyStep<'_>,
        see: See<'_>,
    ) -> Result<Control> {
        let surface = watched.surface;
        self.steps += 1;
        self.found.clear();
        if surface.may_be_passed(step.y0, self.zeros.sign, step.reach) {
            self.cross(watched, step)?;
        }
        let mut found = std::mem::take(&mut self.found);
        for Passage { time, state, .. } in found.drain(..) {
            let (time, state) = ((step.begin + time).hi(), Vector::from_vec(state));
            self.arrive(watched, Return { time, state }, see);
            if self.ended.is_some() {
                return Ok(Control::Stop);
            }
        }
        // Its room is used again.
        self.found = found;
        if see(self.passed, None) == Control::Stop {
            self.ended = Some(Ended::Stopped);
        }
        if step.t1 - self.since > LINGERING * watched.watching.patience {
            self.linger(watched.surface, step);
        }
        self.between_returns(watched, step.t1, step.y1);
        Ok(if self.ended.is_some() {
            Control::Stop
        } else {
            Control::Continue
        })
    }

    /// Finds where a step crosses the surface.
    fn cross(&mut self, watched: &Watched<'_>, step: &AnyStep<'_>) -> Result<()> {
        let Watched { field, surface, .. } = *watched;
        if surface.turn.is_some() {
            return self.cross_phases(field, surface, step);
        }
        let Some(series) = step.series() else {
            return crossings(field, surface, step, &mut self.zeros, &mut self.found);
        };
        let direction = Some(surface.direction);
        series.crossings(
            surface.section(),
            direction,
            &mut self.zeros,
            &mut self.found,
        );
        Ok(())
    }

    /// The same of one phase of a forcing: every plane between the phases at the ends of the step is crossed.
    fn cross_phases(
        &mut self,
        field: &AnyField<'_>,
        surface: &Surface,
        step: &AnyStep<'_>,
    ) -> Result<()> {
        let mut y = step.y0.to_vec();
        let place = surface.normal.iamax();
        loop {
            let plane = surface.ahead(&y);
            if plane.height(step.y1) < 0.0 {
                return Ok(());
            }
            let rate = field.f(&Vector::from_column_slice(step.y0))[place];
            let time = ((plane.offset - step.y0[place]) / rate).min(step.length);
            let state = step.after(time).iter().copied().collect();
            self.found.push(Passage {
                time,
                crossing: surface.direction,
                state: surface.on_first(state),
            });
            y[place] = plane.offset;
        }
    }

    fn arrive(&mut self, watched: &Watched<'_>, here: Return, see: See<'_>) {
        let Watching { skip, returns, .. } = *watched.watching;
        let recorded = self.passed >= skip;
        if recorded {
            self.returns.push(here.clone());
            if watched.watching.waypoints {
                self.waypoints.push(here.clone());
            }
        }
        let told = see(self.passed, Some(&here));
        self.passed += 1;
        self.since = here.time;
        self.window = None;
        self.lingering = false;
        self.range = (f64::INFINITY, f64::NEG_INFINITY);
        // An equilibrium may lie on the section: then its noise returns for ever.
        self.look(watched, here.time, here.state.as_slice());
        if self.ended.is_none() && self.passed == skip + returns {
            self.ended = Some(Ended::Complete);
        }
        if self.ended.is_none() && told == Control::Stop {
            self.ended = Some(Ended::Stopped);
        }
    }

    /// The heights within a step of a run that has not returned for long: how far it swings may have to tell how fast it decays,
    /// and the ends of long steps miss by how far.
    fn linger(&mut self, surface: &Surface, step: &AnyStep<'_>) {
        if !self.lingering {
            self.lingering = true;
            self.range = (f64::INFINITY, f64::NEG_INFINITY);
        }
        for part in 1..WITHIN {
            let time = step.length * (f64::from(part) / f64::from(WITHIN));
            self.reaches(surface.height(step.after(time).as_slice()));
        }
    }

    fn reaches(&mut self, height: f64) {
        self.range = (self.range.0.min(height), self.range.1.max(height));
    }

    fn between_returns(&mut self, watched: &Watched<'_>, time: f64, y: &[f64]) {
        self.reaches(watched.surface.height(y));
        if self.steps.is_multiple_of(BETWEEN_WAYPOINTS)
            && watched.watching.waypoints
            && !self.returns.is_empty()
        {
            let state = Vector::from_column_slice(y);
            self.waypoints.push(Return { time, state });
        }
        let begun = self.window.map_or(self.since, |(begun, _)| begun);
        let late = time - begun > watched.watching.patience;
        if late || self.steps.is_multiple_of(BETWEEN_LOOKS) {
            self.look(watched, time, y);
        }
        if late && self.ended.is_none() {
            self.late(watched, time, y);
        }
    }

    /// Ends at a stable equilibrium.
    fn look(&mut self, watched: &Watched<'_>, time: f64, y: &[f64]) {
        let near = equilibrium_near(watched.field, y, watched.watching.settled());
        if let Some((equilibrium, stable @ true)) = near {
            self.ended = Some(Ended::Steady {
                time,
                equilibrium,
                stable,
            });
        }
    }

    /// The patience is over. A run that spirals into an equilibrium as slowly as its eigenvalues say has one window more to
    /// show it.
    fn late(&mut self, watched: &Watched<'_>, time: f64, y: &[f64]) {
        let size = self.range.1 - self.range.0;
        let window = time - self.window.map_or(self.since, |(begun, _)| begun);
        if let Some((_, before)) = self.window {
            let spiral = spirals_into(watched.field, y, (before, size), window);
            self.ended = Some(match spiral {
                Some(equilibrium) => Ended::Steady {
                    time,
                    equilibrium,
                    stable: true,
                },
                None => Ended::Failed(self.no_return(watched.surface, time)),
            });
        } else if window > 0.0 {
            self.window = Some((time, size));
            self.range = (f64::INFINITY, f64::NEG_INFINITY);
        }
    }

    /// That it has not returned until now.
    pub(crate) fn no_return(&self, surface: &Surface, t: f64) -> Error {
        let offset = surface.offset;
        Error::NoReturn {
            since: self.since,
            t,
            section: offset,
            lowest: offset + self.range.0,
            highest: offset + self.range.1,
        }
    }
}
