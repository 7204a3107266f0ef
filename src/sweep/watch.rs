//! A run on its way: its returns, how far it swings, and whether it is to be classified yet.

use super::attraction::Attraction;
use super::classify::FIRST_STAGE;
use super::closing::{FEWEST_TO_CLOSE, closing};
use super::points::{Enclosure, SectionPlace, SystemPoint};
use super::slow_convergence::Leap;
use super::{SweepRow, SweepSettings};
use crate::equilibrium::Enclosed;
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::friction::AnyLaw;
use crate::integrate::{AnyField, AnyStep, Control, MotionUnits, StepSeries};
use crate::model::Loading;
use crate::number::bracketed_root;
use crate::number::polynomial::{Crossing, evaluate};
use crate::section::{
    AT_START, Ended, Periodic, Recorder, Return, SeriesVariables, Surface, Watched, Watching,
    equilibrium_near, growth,
};
use std::rc::Rc;

/// Steps between two looks whether an equilibrium has caught the run.
pub(super) const BETWEEN_LOOKS: usize = 48;
/// How much longer than usual a run may wait once for a return.
const LONGER: f64 = 10.0;
/// A run that swings by less is at rest.
pub(super) const SWING: f64 = 1e-7;
/// A run so near an unstable equilibrium is held at it.
const HELD: f64 = 1e-5;
/// Equal parts that differ by less, all along, move in phase.
pub(super) const ALIKE: f64 = 1e-6;
/// By how much of its size a run is let go from an unstable state or orbit, and how often.
const PUSH: f64 = 1e-3;
const MOST_PUSHES: usize = 2;
/// Returns before the range of a run with a known section is recorded: turns of a variable take time to compute.
const RANGE_FROM: usize = 512;
/// A state beyond this, in its unit, goes to infinity.
const INFINITE: f64 = 1e100;
/// Windows, one after the other, in which a run that never turns grows each time by more than this factor, until it is seen to go on so.
const GROWING_WINDOWS: usize = 4;
const GROWTH: f64 = 1.5;
/// Distances are measured by how far a system swings, but not by less than this.
const LEAST_UNIT: f64 = 1e-2;

/// A run of a sweep.
pub(super) struct SweepRun {
    /// The row, with what is known of its point.
    pub row: SweepRow,
    pub units: MotionUnits,
    /// Shared with what advances the run.
    pub field: Rc<AnyField<'static>>,
    /// The law and loading of two equal interfaces, whose runs may go side by side.
    pub lane: Option<(AnyLaw, Loading)>,
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
    fresh: usize,
    /// The number of returns before which no candidate is looked for again, and at which the run is classified anyway.
    pub next_look: usize,
    pub next_stage: usize,
    /// A candidate for the number of returns per period.
    pub candidate: Option<usize>,
    /// The least and the greatest value of every variable since the last stage began; of a run whose section is known, of that variable alone.
    pub reach: Vec<(f64, f64)>,
    /// The unit of distances.
    pub unit: f64,
    /// How often it was let go.
    pub pushes: usize,
    /// Why nothing more is to be waited for.
    pub hopeless: Option<String>,
    /// A leap that is yet to be confirmed.
    pub leap: Option<Leap>,
    /// Whether one was taken back: there is no other.
    taken_back: bool,
    growing: Growing,
    enclosed: Option<Enclosure>,
    attraction: Attraction,
    /// Whether the section was moved, and a return waited for longer than usual.
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

impl SweepRun {
    /// From the start of a point; the row has what is known of it.
    pub fn new(point: SystemPoint, row: SweepRow, settings: &SweepSettings) -> Self {
        let dimension = point.field.dimension();
        let (surface, patience) = match &point.section {
            SectionPlace::Known(surface, patience) => (surface.clone(), *patience),
            SectionPlace::Untimed(surface) => (surface.clone(), f64::INFINITY),
            SectionPlace::Middle(state) => (across(*state, dimension, 0.0), f64::INFINITY),
        };
        let stage = FIRST_STAGE.min(settings.max_returns);
        let mut run = SweepRun {
            row,
            units: point.units,
            field: Rc::new(point.field),
            lane: point.lane,
            equal_parts: point.equal_parts,
            // A phase is seen by its section alone: what rows have of the range is the first variable's.
            variable: match surface.turn {
                None => surface.normal.iamax(),
                Some(_) => 0,
            },
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
            next_stage: stage,
            candidate: None,
            reach: vec![(f64::INFINITY, f64::NEG_INFINITY); dimension],
            unit: 1.0,
            pushes: 0,
            hopeless: None,
            leap: None,
            taken_back: false,
            growing: Growing::default(),
            enclosed: point.enclosed,
            attraction: Attraction::default(),
            moved: false,
            waited: false,
        };
        run.recorder.returns.reserve(2 * stage);
        // A start at an equilibrium is left by rounding alone: a stable one is where the run stays.
        match equilibrium_near(&run.field, run.state.as_slice(), AT_START) {
            Some((equilibrium, true)) => run.recorder.ended = Some(caught(0.0, equilibrium)),
            Some(_) => run.push(),
            None => (),
        }
        run
    }

    /// An error in words, in the system's own units.
    pub fn in_words(&self, error: Error) -> String {
        self.units.outward_error(error, self.variable).to_string()
    }

    /// Whether the section and the time to wait for a return to it were known at the beginning.
    pub fn is_timed(&self) -> bool {
        matches!(self.place, SectionPlace::Known(..))
    }

    /// The returns that tell.
    pub fn returns(&self) -> &[Return] {
        &self.recorder.returns[self.fresh.min(self.recorder.returns.len())..]
    }

    /// Where the run stands, or was last on the section.
    pub fn last(&self) -> &Vector {
        self.returns().last().map_or(&self.state, |at| &at.state)
    }

    /// The time now, and one that the run is classified before.
    pub fn span(&self) -> (f64, f64) {
        let all = (self.watching.skip + self.watching.returns + 1) as f64;
        let end = self.time + 2.0 * all * self.watching.patience;
        (self.time, end.min(f64::MAX))
    }

    /// Sees that a leg of the run ends at a time: before it the run had to return.
    pub fn end_leg(&mut self, end: f64) {
        if self.time >= end && self.recorder.ended.is_none() && self.hopeless.is_none() {
            let error = self.recorder.no_return(&self.surface, end);
            self.recorder.ended = Some(Ended::Failed(error));
        }
    }

    /// Sees a step; the run stops where it is to be classified.
    pub fn step(&mut self, step: &AnyStep<'_>) -> Result<Control> {
        self.come_to(step);
        let passed = self.recorder.passed;
        let watched = Watched {
            field: &self.field,
            surface: &self.surface,
            watching: &self.watching,
        };
        let go_on = &mut |_: usize, _: Option<&Return>| Control::Continue;
        let told = self.recorder.step(&watched, step, go_on)?;
        if self.is_timed() {
            self.see_range(step);
        } else {
            see_all(&mut self.reach, step, self.variable);
        }
        if told == Control::Stop || self.goes_to_infinity(step) {
            return Ok(Control::Stop);
        }
        if self.recorder.passed > passed {
            let n = self.recorder.returns.len();
            self.candidate = (n >= self.next_look)
                .then(|| closing(self.returns(), self.unit))
                .flatten();
            if self.candidate.is_some() || n >= self.next_stage {
                return Ok(Control::Stop);
            }
        }
        if !self.recorder.steps.is_multiple_of(BETWEEN_LOOKS) {
            return Ok(Control::Continue);
        }
        Ok(match self.is_caught(step) || self.is_held(step.y1) {
            true => Control::Stop,
            false => Control::Continue,
        })
    }

    /// Notes where a step ends.
    pub fn come_to(&mut self, step: &AnyStep<'_>) {
        self.time = step.t1;
        self.state.copy_from_slice(step.y1);
    }

    /// Whether a stable equilibrium has caught the run at the end of a step; then it ends there.
    pub fn is_caught(&mut self, step: &AnyStep<'_>) -> bool {
        let enclosed = self.enclosed.as_ref();
        let equations = enclosed.map(|Enclosure(equations)| &**equations as &dyn Enclosed);
        let at = self.attraction.of(&self.field, equations, step.y1);
        if let Some(equilibrium) = at {
            self.recorder.ended = Some(caught(step.t1, equilibrium));
        }
        self.recorder.ended.is_some()
    }

    /// Whether equal parts move alike, and rounding holds them at an unstable equilibrium.
    fn is_held(&self, y: &[f64]) -> bool {
        self.equal_parts && self.may_be_let_go(y) && self.attraction.rests_unstably(y)
    }

    /// Whether a run that a state or orbit holds may be let go: of equal parts those that move alike, any other.
    fn may_be_let_go(&self, y: &[f64]) -> bool {
        self.pushes < MOST_PUSHES && (!self.equal_parts || are_alike(y, ALIKE))
    }

    /// Lets a run go from an unstable state or orbit that nothing but rounding or its start holds it on; whether it may be.
    pub fn let_go(&mut self, from: &Vector) -> bool {
        let may = self.may_be_let_go(from.as_slice());
        if may {
            self.state.copy_from(from);
            self.push();
        }
        may
    }

    /// Lets it go from where it is. Of equal parts that move alike one side is the mirror image of the other: either will do.
    fn push(&mut self) {
        self.pushes += 1;
        let mut to = self.state.clone();
        let last = to.len() - 1;
        if self.equal_parts && are_alike(to.as_slice(), ALIKE) {
            to[last] += PUSH;
        } else {
            to = pushed(&to, PUSH);
        }
        self.go_on_from(to);
    }

    /// Lets a run go from an unstable equilibrium that it is held at, by a symmetry or by its start; whether it was.
    pub fn leaves_rest(&mut self) -> bool {
        if !self.may_be_let_go(self.state.as_slice()) {
            return false;
        }
        let near = equilibrium_near(&self.field, self.state.as_slice(), HELD);
        let held = near.is_some_and(|(at, _)| growth(&self.field, at.as_slice()) > 0.0);
        if held {
            self.push();
        }
        held
    }

    /// A new stage begins: of a run that shows its own size, distances are measured by how far it has swung in the last one.
    pub fn begin_stage(&mut self) {
        if !self.is_timed() {
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
                "it keeps growing: a state has reached {:.1e} at t = {:.6e}",
                self.units.outward(&self.state).amax(),
                self.time * self.units.time
            ));
        }
    }

    /// Whether a step leads to infinity; then the reason is put down.
    pub fn goes_to_infinity(&mut self, step: &AnyStep<'_>) -> bool {
        let Some(i) = step.y1.iter().position(|y| y.abs() > INFINITE) else {
            return false;
        };
        self.hopeless = Some(format!(
            "it goes to infinity: a state is at {:.1e} at t = {:.6e}",
            step.y1[i] * self.units.sizes[i],
            step.t1 * self.units.time
        ));
        true
    }

    /// Puts the section at another value of its variable.
    pub fn put_section(&mut self, value: f64) {
        self.surface.offset = value;
        self.fresh = self.recorder.returns.len();
        self.recorder.resume(self.time);
    }

    /// Moves the section, unless it was asked for by its value, to where a run swings that does not cross it, as just after a Hopf point; once.
    pub fn section_moves_between(&mut self, lowest: f64, highest: f64) -> bool {
        let asked = matches!(self.place, SectionPlace::Untimed(_));
        if asked || self.moved || highest - lowest <= SWING * self.unit {
            return false;
        }
        self.moved = true;
        self.put_section(0.5 * (lowest + highest));
        true
    }

    /// Waits longer than usual, once: close to a bifurcation a run may converge slowly.
    pub fn waits_longer(&mut self) -> bool {
        let longer = !self.waited;
        if longer {
            self.waited = true;
            self.watching.patience *= LONGER;
            self.recorder.resume(self.time);
        }
        longer
    }

    /// Leaps most of the way to this point, unless a leap was taken back before; whether it did.
    pub fn leaps(&mut self, to: Periodic) -> bool {
        let last = self.returns().last().filter(|_| !self.taken_back);
        let Some(last) = last.map(|at| at.state.clone()) else {
            return false;
        };
        let landing = Leap::landing(&last, &to.point, &self.surface);
        // Back is to where the first of several began.
        let from = self.leap.take().map_or(last, |before| before.from);
        self.leap = Some(Leap { from, to });
        self.go_on_from(landing);
        true
    }

    /// Whether leaps are known to work: along logarithms of states, which come to their end exponentially.
    pub fn may_leap(&self) -> bool {
        self.surface.chart == SeriesVariables::LogStates
    }

    /// Takes back what has leapt; whether there was anything.
    pub fn leaps_back(&mut self) -> bool {
        let Some(leap) = self.leap.take() else {
            return false;
        };
        self.taken_back = true;
        self.go_on_from(leap.from);
        true
    }

    fn go_on_from(&mut self, y: Vector) {
        self.state = y;
        self.fresh = self.recorder.returns.len();
        self.recorder.resume(self.time);
    }

    /// Widens the range of the section's variable by a step, whose turns are computed where they may lie outside.
    fn see_range(&mut self, step: &AnyStep<'_>) {
        if self.next_stage < RANGE_FROM {
            return;
        }
        let range = &mut self.reach[self.variable];
        see(range, step.y1[self.variable]);
        let (low, high) = *range;
        let y = step.y0[self.variable];
        let is_within = |y: f64| (low..=high).contains(&y);
        if self.variable == 0 && is_within(y - step.reach) && is_within(y + step.reach) {
            return;
        }
        if let Some(turn) = step.series().and_then(|series| turn(series, self.variable)) {
            see(range, turn);
        }
    }
}

/// Whether the last two variables, of equal parts, differ by less than this.
pub(super) fn are_alike(y: &[f64], by_less_than: f64) -> bool {
    let last = y.len() - 1;
    (y[last - 1] - y[last]).abs() < by_less_than
}

/// That a run ends at a stable equilibrium.
pub(super) fn caught(time: f64, equilibrium: Vector) -> Ended {
    Ended::Steady {
        time,
        equilibrium,
        stable: true,
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
        turn: None,
    }
}

/// A state a part of its size away, in a direction that no symmetry has.
pub(super) fn pushed(y: &Vector, part: f64) -> Vector {
    let by = |i: usize| (0.4 + 0.3 * (0.7 + 1.3 * i as f64).cos()) * (1.0 + y[i].abs());
    Vector::from_fn(y.len(), |i, _| y[i] - part * by(i))
}

/// Widens a range.
pub(super) fn see(range: &mut (f64, f64), x: f64) {
    *range = (range.0.min(x), range.1.max(x));
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

/// The value of a variable where it turns within a step, if it does once: where its rate, by the polynomial of the step, changes sign.
pub(super) fn turn(series: &dyn StepSeries, variable: usize) -> Option<f64> {
    let values = series.variable(variable);
    let end = series.length() / series.unit();
    let rate = |s: f64| {
        let (mut rate, mut slope) = (0.0, 0.0);
        for k in (1..values.len()).rev() {
            slope = slope * s + rate;
            rate = rate * s + k as f64 * values[k];
        }
        (rate, slope)
    };
    if values[1] * rate(end).0 >= 0.0 {
        return None;
    }
    let turn = bracketed_root("the turn of a variable", 0.0, end, rate).ok()?;
    Some(evaluate(values, turn))
}
