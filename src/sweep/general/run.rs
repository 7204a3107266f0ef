//! A run of any system on its way: its returns, and how far it swings.

use super::super::SweepSettings;
use super::super::closing::{FEWEST_TO_CLOSE, closing};
use super::super::watch::{SWING, see, turn};
use super::attraction::Attraction;
use super::{Enclosure, SectionPlace, SystemPoint};
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::integrate::{AnyField, AnyIntegrator, AnyStep, Control, MotionUnits};
use crate::number::polynomial::Crossing;
use crate::section::{
    AT_START, Ended, Recorder, Return, SeriesVariables, Surface, Watched, Watching,
    equilibrium_near, growth,
};

/// How often a run may be let go from an unstable state or orbit, by how much of its size, and how close to it that is held.
const MOST_PUSHES: usize = 2;
const PUSH: f64 = 1e-3;
const HELD: f64 = 1e-5;
/// How much longer than usual a run may wait once for a return.
const LONGER: f64 = 10.0;
/// Steps between two looks for an equilibrium.
pub(super) const BETWEEN_LOOKS: usize = 32;
/// A state beyond this, in its unit, goes to infinity.
const INFINITE: f64 = 1e100;
/// Windows, one after the other, in which a run that never turns grows each time by more than this factor, until it is seen to go on so.
const GROWING_WINDOWS: usize = 4;
const GROWTH: f64 = 1.5;
/// Distances are measured by how far a system swings, but not by less than this.
const LEAST_UNIT: f64 = 1e-2;

/// A run of any system.
pub(super) struct GeneralRun {
    pub units: MotionUnits,
    pub field: AnyField<'static>,
    pub equal_parts: bool,
    pub place: SectionPlace,
    pub surface: Surface,
    /// The variable that the section is in, or most in.
    pub variable: usize,
    pub watching: Watching,
    pub recorder: Recorder,
    /// The time and the state reached.
    pub time: f64,
    pub state: Vector,
    /// Returns before this one tell nothing any more.
    pub fresh: usize,
    /// The number of returns before which no candidate is looked for again, and at which the run is judged anyway.
    pub next_look: usize,
    pub next_stage: usize,
    /// A candidate for the number of returns per period.
    pub candidate: Option<usize>,
    /// The least and the greatest value of every variable since the last stage began.
    pub reach: Vec<(f64, f64)>,
    /// What distances are measured in.
    pub unit: f64,
    /// How often it was let go.
    pub pushes: usize,
    /// Why nothing more is to be waited for.
    pub hopeless: Option<String>,
    growing: Growing,
    pub enclosed: Option<Enclosure>,
    pub attraction: Attraction,
    moved: bool,
    waited: bool,
}

/// How long a run has grown without turning.
#[derive(Debug, Default)]
struct Growing {
    /// The size of the state at the end of the last window.
    size: f64,
    /// In so many windows.
    windows: usize,
}

impl GeneralRun {
    pub fn new(point: SystemPoint, settings: &SweepSettings) -> Self {
        let dimension = point.field.dimension();
        let (surface, patience) = match &point.section {
            SectionPlace::Known(surface, patience) => (surface.clone(), *patience),
            SectionPlace::Untimed(surface) => (surface.clone(), f64::INFINITY),
            SectionPlace::Middle(state) => (across(*state, dimension, 0.0), f64::INFINITY),
        };
        let mut run = GeneralRun {
            units: point.units,
            field: point.field,
            equal_parts: point.equal_parts,
            variable: surface.normal.iamax(),
            place: point.section,
            surface,
            watching: Watching {
                skip: 0,
                returns: settings.max_returns + 1,
                patience,
                accuracy: settings.rtol,
                max_step: f64::INFINITY,
                waypoints: false,
            },
            recorder: Recorder::new(),
            time: 0.0,
            state: point.start,
            fresh: 0,
            next_look: FEWEST_TO_CLOSE,
            next_stage: super::super::classify::FIRST_STAGE.min(settings.max_returns),
            candidate: None,
            reach: vec![(f64::INFINITY, f64::NEG_INFINITY); dimension],
            unit: 1.0,
            pushes: 0,
            hopeless: None,
            growing: Growing::default(),
            enclosed: point.enclosed,
            attraction: Attraction::default(),
            moved: false,
            waited: false,
        };
        run.begin();
        run
    }

    /// A start at an equilibrium is left by rounding alone: a stable one is where the run stays.
    fn begin(&mut self) {
        match equilibrium_near(&self.field, self.state.as_slice(), AT_START) {
            Some((equilibrium, stable @ true)) => {
                self.recorder.ended = Some(Ended::Steady {
                    time: self.time,
                    equilibrium,
                    stable,
                });
            }
            Some(_) => drop(self.let_go(&self.state.clone())),
            None => (),
        }
    }

    /// An error in words, in the system's own units.
    pub fn in_words(&self, error: Error) -> String {
        self.units.outward_error(error, self.variable).to_string()
    }

    /// The returns that tell.
    pub fn returns(&self) -> &[Return] {
        &self.recorder.returns[self.fresh.min(self.recorder.returns.len())..]
    }

    /// Where the run stands, or was last on the section.
    pub fn last(&self) -> &Vector {
        self.returns().last().map_or(&self.state, |at| &at.state)
    }

    /// Follows the run until it is to be judged.
    ///
    /// # Errors
    /// Those of the integrator.
    pub fn advance(&mut self, integrator: &mut AnyIntegrator) -> Result<()> {
        let all = (self.watching.returns + 1) as f64;
        let end = (self.time + 2.0 * all * self.watching.patience).min(f64::MAX);
        let (now, from) = (self.time, self.state.clone());
        let GeneralRun {
            units,
            field,
            surface,
            variable,
            watching,
            recorder,
            time,
            state,
            fresh,
            next_look,
            next_stage,
            candidate,
            reach,
            unit,
            hopeless,
            enclosed,
            attraction,
            ..
        } = self;
        let watched = Watched {
            field,
            surface,
            watching,
        };
        let mut observer = |step: &AnyStep<'_>| {
            *time = step.t1;
            state.copy_from_slice(step.y1);
            see_all(reach, step, *variable);
            if goes_to_infinity(units, step, hopeless) {
                return Ok(Control::Stop);
            }
            if recorder.steps % BETWEEN_LOOKS == 0
                && let Some(Enclosure(equations)) = enclosed
                && let Some(equilibrium) = attraction.of(field, &**equations, step.y1)
            {
                recorder.ended = Some(caught(step, equilibrium));
                return Ok(Control::Stop);
            }
            let passed = recorder.passed;
            let go_on = &mut |_: usize, _: Option<&Return>| Control::Continue;
            if recorder.step(&watched, step, go_on)? == Control::Stop {
                return Ok(Control::Stop);
            }
            if recorder.passed == passed {
                return Ok(Control::Continue);
            }
            let n = recorder.returns.len();
            *candidate = (n >= *next_look)
                .then(|| closing(&recorder.returns[(*fresh).min(n)..], *unit))
                .flatten();
            Ok(match candidate.is_some() || n >= *next_stage {
                true => Control::Stop,
                false => Control::Continue,
            })
        };
        integrator.flow(field, (now, end), &from, Some(&mut observer))?;
        if self.time >= end && self.recorder.ended.is_none() && self.hopeless.is_none() {
            let error = self.recorder.no_return(&self.surface, end);
            self.recorder.ended = Some(Ended::Failed(error));
        }
        Ok(())
    }

    /// A new stage begins: distances are measured by how far the run has swung in the last one.
    pub fn begin_stage(&mut self) {
        if !matches!(self.place, SectionPlace::Known(..)) {
            let swings = self.reach.iter().map(|(low, high)| high - low);
            let swing = swings.fold(0.0, f64::max);
            self.unit = swing.clamp(LEAST_UNIT, f64::MAX);
        }
        self.reach.fill((f64::INFINITY, f64::NEG_INFINITY));
    }

    /// Sees the end of a window of the transient, in which the run has turned round so often: one that never turns, and grows by its own
    /// size from one window to the next, is not waited for.
    pub fn end_window(&mut self, turns: usize) {
        let size = self.state.amax();
        let grows = turns == 0 && size > GROWTH * self.growing.size.max(1.0);
        let windows = if grows { self.growing.windows + 1 } else { 0 };
        self.growing = Growing { size, windows };
        if windows >= GROWING_WINDOWS && self.hopeless.is_none() {
            self.hopeless = Some(format!(
                "it goes on growing without turning: a state has come to {:.1e} at t = {:.6e}",
                self.units.outward(&self.state).amax(),
                self.time * self.units.time
            ));
        }
    }

    /// Puts the section at another value of its variable.
    pub fn put_section(&mut self, value: f64) {
        self.surface.offset = value;
        self.fresh = self.recorder.returns.len();
        self.recorder.resume(self.time);
    }

    /// Moves the section, unless it was asked for by its value, to where a run swings that does not cross it; once.
    pub fn section_moves_between(&mut self, lowest: f64, highest: f64) -> bool {
        let asked = matches!(self.place, SectionPlace::Untimed(_));
        if asked || self.moved || highest - lowest <= SWING * self.unit {
            return false;
        }
        self.moved = true;
        self.put_section(0.5 * (lowest + highest));
        true
    }

    /// Waits longer than usual, once: close to a bifurcation a run may creep.
    pub fn waits_longer(&mut self) -> bool {
        let longer = !self.waited;
        if longer {
            self.waited = true;
            self.watching.patience *= LONGER;
            self.recorder.resume(self.time);
        }
        longer
    }

    /// Lets a run go from an unstable equilibrium that it is held at, by a symmetry or by its start; whether it was.
    pub fn leaves_rest(&mut self) -> bool {
        let near = equilibrium_near(&self.field, self.state.as_slice(), HELD);
        let at = near.map(|(at, _)| at);
        let held = at.is_some_and(|at| growth(&self.field, at.as_slice()) > 0.0);
        held && self.let_go(&self.state.clone())
    }

    /// Lets a run go from a state or orbit that does not attract it, but holds it; whether it may be.
    pub fn let_go(&mut self, from: &Vector) -> bool {
        let may = self.pushes < MOST_PUSHES;
        if may {
            self.pushes += 1;
            self.state = pushed(from, PUSH);
            self.fresh = self.recorder.returns.len();
            self.recorder.resume(self.time);
        }
        may
    }
}

/// The section in which a variable has a value, falling.
pub(super) fn across(variable: usize, dimension: usize, value: f64) -> Surface {
    let along = |i: usize, _: usize| f64::from(u8::from(i == variable));
    Surface {
        normal: Vector::from_fn(dimension, along),
        offset: value,
        direction: Crossing::Downwards,
        chart: SeriesVariables::Plain,
    }
}

/// A state a part of its size away, in a direction that no symmetry has.
pub(super) fn pushed(y: &Vector, part: f64) -> Vector {
    let by = |i: usize| (0.4 + 0.3 * (0.7 + 1.3 * i as f64).cos()) * (1.0 + y[i].abs());
    Vector::from_fn(y.len(), |i, _| y[i] - part * by(i))
}

/// Widens the reach of all variables by the end of a step, and that of one of them by where it turns on the way.
pub(super) fn see_all(reach: &mut [(f64, f64)], step: &AnyStep<'_>, variable: usize) {
    for (range, &y) in reach.iter_mut().zip(step.y1) {
        see(range, y);
    }
    if let Some(turn) = step.series().and_then(|series| turn(series, variable)) {
        see(&mut reach[variable], turn);
    }
}

/// Whether a step leads to infinity; then the reason is put down.
pub(super) fn goes_to_infinity(
    units: &MotionUnits,
    step: &AnyStep<'_>,
    hopeless: &mut Option<String>,
) -> bool {
    let beyond = |(y, size): (&f64, &f64)| (y.abs() > INFINITE).then(|| y * size);
    let value = step.y1.iter().zip(&units.sizes).find_map(beyond);
    if let Some(value) = value {
        *hopeless = Some(format!(
            "it goes to infinity: a state is at {value:.1e} at t = {:.6e}",
            step.t1 * units.time
        ));
    }
    value.is_some()
}

/// That a run ends at a stable equilibrium.
pub(super) fn caught(step: &AnyStep<'_>, equilibrium: Vector) -> Ended {
    Ended::Steady {
        time: step.t1,
        equilibrium,
        stable: true,
    }
}
