//! A run on its way: its returns, and whether they tell yet what it settles on.

use super::capture::Capture;
use super::closing::{FEWEST_TO_CLOSE, closing};
use super::slow_convergence::Leap;
use super::start::SweepStart;
use crate::error::Result;
use crate::field::{State, state, vector};
use crate::integrate::{AnyField, AnyStep, Control, Step, StepSeries};
use crate::model::two_interfaces;
use crate::number::bracketed_root;
use crate::number::polynomial::{Crossing, evaluate};
use crate::section::{
    AT_START, Ended, Periodic, Recorder, Return, Surface, Watched, Watching, equilibrium_near,
    half_driving_stress, usual_patience,
};

/// Steps between two looks whether an equilibrium has caught the run.
const BETWEEN_LOOKS: usize = 48;
/// Part of the usual patience: some 20 periods of stick-slip.
const PATIENCE: f64 = 0.1;
/// A run that swings by less is at rest.
pub(super) const SWING: f64 = 1e-7;
/// Interfaces of a run that is held in symmetry are no farther apart, in ln psi; it is let go by the second, and so often.
const HELD: f64 = 1e-6;
const PUSH: f64 = 1e-3;
const MOST_PUSHES: usize = 2;
/// Runs that are judged before so many returns are not judged by the stress on the way: its turns take time.
const STRESS_FROM: usize = 512;

/// A run of a sweep.
pub(super) struct SweepRun {
    pub point: SweepStart,
    pub field: AnyField<'static>,
    pub surface: Surface,
    pub watching: Watching,
    pub recorder: Recorder,
    capture: Capture,
    /// The time and the state reached.
    pub time: f64,
    pub state: State<3>,
    /// Returns before this one tell nothing any more.
    pub fresh: usize,
    /// The number of returns before which no candidate is looked for again, and at which the run is judged anyway.
    pub next_look: usize,
    pub next_stage: usize,
    /// A candidate for the number of returns per period.
    pub candidate: Option<usize>,
    /// The least and the greatest stress since the last stage began.
    pub stress: (f64, f64),
    /// How often it was let go from an unstable orbit.
    pub pushes: usize,
    /// Whether it rests where it would not but for rounding.
    pub held: bool,
    /// A leap that is yet to be confirmed.
    pub leap: Option<Leap>,
    /// Whether one was taken back: there is no other.
    taken_back: bool,
    /// Whether the section was moved, and a return waited for as long as it is usual.
    moved: bool,
    waited: bool,
}

impl SweepRun {
    pub fn new(point: SweepStart, watching: Watching, stage: usize) -> Self {
        let law = point.law;
        let field = AnyField::new::<3>(two_interfaces(law, point.loading));
        let tau = half_driving_stress(&law, point.loading.driving, 2);
        let mut run = SweepRun {
            surface: Surface::stress(field.dimension(), tau, Crossing::Downwards),
            field,
            watching: Watching {
                patience: PATIENCE * usual_patience(point.loading.driving, point.loading.stiffness),
                ..watching
            },
            recorder: Recorder::new(),
            capture: Capture::default(),
            time: 0.0,
            state: point.start,
            fresh: 0,
            next_look: FEWEST_TO_CLOSE,
            next_stage: stage,
            candidate: None,
            stress: (f64::INFINITY, f64::NEG_INFINITY),
            pushes: 0,
            held: false,
            leap: None,
            taken_back: false,
            moved: false,
            waited: false,
            point,
        };
        run.recorder.returns.reserve(2 * stage);
        let near = equilibrium_near(&run.field, run.state.as_slice(), AT_START);
        if let Some((equilibrium, stable)) = near {
            run.recorder.ended = Some(Ended::Steady {
                time: 0.0,
                equilibrium,
                stable,
            });
        }
        run
    }

    /// A time that the run ends before.
    pub fn end(&self) -> f64 {
        let all = (self.watching.skip + self.watching.returns + 1) as f64;
        (2.0 * all * self.watching.patience).min(f64::MAX)
    }

    /// Sees a step; the run stops where it is to be judged.
    pub fn step(&mut self, step: &Step<'_, 3>) -> Result<Control> {
        (self.time, self.state) = (step.t1, *step.y1);
        let passed = self.recorder.passed;
        let watched = Watched {
            field: &self.field,
            surface: &self.surface,
            watching: &self.watching,
        };
        let go_on = &mut |_: usize, _: Option<&Return>| Control::Continue;
        let recorder = &mut self.recorder;
        let told = AnyStep::of(step, 3, |step| recorder.step(&watched, step, go_on))?;
        self.see_stress(step);
        if told == Control::Stop {
            return Ok(told);
        }
        if self.recorder.passed > passed {
            let n = self.recorder.returns.len();
            self.candidate = (n >= self.next_look)
                .then(|| closing(self.returns(), 1.0))
                .flatten();
            if self.candidate.is_some() || n >= self.next_stage {
                return Ok(Control::Stop);
            }
        }
        if !self.recorder.steps.is_multiple_of(BETWEEN_LOOKS) {
            return Ok(Control::Continue);
        }
        if let Some(equilibrium) = self.capture.of(&self.field, step.y1) {
            self.recorder.ended = Some(Ended::Steady {
                time: step.t1,
                equilibrium: vector(&equilibrium),
                stable: true,
            });
            return Ok(Control::Stop);
        }
        self.held = self.is_held(step.y1) && self.capture.rests_unstably(step.y1);
        Ok(if self.held {
            Control::Stop
        } else {
            Control::Continue
        })
    }

    /// Whether the interfaces are alike, and the run may be let go.
    fn is_held(&self, y: &State<3>) -> bool {
        (y[1] - y[2]).abs() < HELD && self.pushes < MOST_PUSHES
    }

    /// Moves the section to where a run swings that does not cross it, as just after a Hopf point of the asymmetric steady state;
    /// once.
    pub fn surface_moves_between(&mut self, lowest: f64, highest: f64) -> bool {
        if self.moved || highest - lowest <= SWING {
            return false;
        }
        self.moved = true;
        self.surface.offset = 0.5 * (lowest + highest);
        self.fresh = self.recorder.returns.len();
        self.recorder.resume(self.time);
        true
    }

    /// Waits as long as it is usual, once: close to a bifurcation a run may slow_convergence.
    pub fn waits_longer(&mut self) -> bool {
        let longer = !self.waited;
        if longer {
            self.waited = true;
            self.watching.patience /= PATIENCE;
            self.recorder.resume(self.time);
        }
        longer
    }

    /// Lets a run go from an unstable state or orbit of equal interfaces that nothing but rounding holds it on. What holds for one
    /// side holds for its mirror image: either will do. Whether there was anything to let go.
    pub fn let_go(&mut self, y: State<3>) -> bool {
        let held = self.is_held(&y);
        if held {
            self.pushes += 1;
            self.go_on_from(y + State::<3>::new(0.0, 0.0, PUSH));
        }
        held
    }

    /// Leaps most of the way to this point, unless a leap was taken back before; whether it did.
    pub fn leaps(&mut self, to: Periodic) -> bool {
        let Some(last) = self.returns().last().filter(|_| !self.taken_back) else {
            return false;
        };
        let last = state(last.state.as_slice());
        let landing = Leap::landing(&last, &to.point, &self.surface);
        // Back is to where the first of several began.
        let from = self.leap.take().map_or(last, |before| before.from);
        self.leap = Some(Leap { from, to });
        self.go_on_from(landing);
        true
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

    fn go_on_from(&mut self, y: State<3>) {
        self.state = y;
        self.fresh = self.recorder.returns.len();
        self.recorder.resume(self.time);
    }

    fn see_stress(&mut self, step: &Step<'_, 3>) {
        if self.next_stage < STRESS_FROM {
            return;
        }
        see(&mut self.stress, step.y1[0]);
        let (low, high) = self.stress;
        if (low..=high).contains(&(step.y0[0] - step.reach))
            && (low..=high).contains(&(step.y0[0] + step.reach))
        {
            return;
        }
        if let Some(turn) = step.series().and_then(|series| turn(series, 0)) {
            see(&mut self.stress, turn);
        }
    }

    /// The returns that tell.
    pub fn returns(&self) -> &[Return] {
        &self.recorder.returns[self.fresh.min(self.recorder.returns.len())..]
    }
}

/// Widens a range.
pub(super) fn see(range: &mut (f64, f64), x: f64) {
    *range = (range.0.min(x), range.1.max(x));
}

/// The value of a variable where it turns within a step, if it does once: where its rate, by the polynomial of the step, changes sign.
pub(super) fn turn(series: &dyn StepSeries, variable: usize) -> Option<f64> {
    let stress = series.variable(variable);
    let end = series.length() / series.unit();
    let rate = |s: f64| {
        let (mut rate, mut slope) = (0.0, 0.0);
        for k in (1..stress.len()).rev() {
            slope = slope * s + rate;
            rate = rate * s + k as f64 * stress[k];
        }
        (rate, slope)
    };
    if stress[1] * rate(end).0 >= 0.0 {
        return None;
    }
    let turn = bracketed_root("the turn of the stress", 0.0, end, rate).ok()?;
    Some(evaluate(stress, turn))
}
