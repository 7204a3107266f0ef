//! The transient of a system of which no scale of time is known: how long it takes to swing, and between which values.

use super::classify::Classifier;
use super::points::SectionPlace;
use super::watch::{BETWEEN_LOOKS, SweepRun, caught, see_all};
use crate::error::Result;
use crate::integrate::{AnyStep, Control};
use crate::section::equilibrium_near;
use std::rc::Rc;

/// Steps of the first window; each later one has twice as many as the one before.
const FIRST_WINDOW: usize = 512;
/// Steps of the last one.
const LAST_WINDOW: usize = 1 << 16;
/// A run that has turned round so often within a window has shown how it swings.
const TURNS: usize = 6;
/// How close an equilibrium is that the run has come to.
const AT_REST: f64 = 1e-7;
/// A run may be away from its section for so many times the last window.
const PATIENCE: f64 = 4.0;

impl Classifier {
    /// Lets the transient pass, puts the section in the middle of what the run then swings through where that is asked for, and measures
    /// the time that it may wait for a return.
    ///
    /// # Errors
    /// Those of the integrator.
    pub(super) fn pass_transient(&mut self, run: &mut SweepRun) -> Result<()> {
        if run.is_timed() || run.recorder.ended.is_some() {
            return Ok(());
        }
        // The first window shows nothing but the way to where the run swings.
        let mut window = FIRST_WINDOW;
        self.pass(run, window)?;
        let duration = loop {
            if run.recorder.ended.is_some() || run.hopeless.is_some() {
                return Ok(());
            }
            if run.leaves_rest() {
                window = FIRST_WINDOW;
            }
            let begun = run.time;
            run.begin_stage();
            let turns = self.pass(run, window)?;
            run.end_window(turns);
            if turns >= TURNS || window >= LAST_WINDOW {
                break run.time - begun;
            }
            window *= 2;
        };
        if run.recorder.ended.is_some() || run.hopeless.is_some() {
            return Ok(());
        }
        run.watching.patience = PATIENCE * duration;
        let x = run.state[run.variable];
        // A run that made no step has no reach.
        let (low, high) = run.reach[run.variable];
        let middle = if low <= high { 0.5 * (low + high) } else { x };
        run.begin_stage();
        if let SectionPlace::Middle(_) = run.place {
            run.put_section(middle);
        } else {
            run.recorder.resume(run.time);
        }
        Ok(())
    }

    /// Goes so many steps on, unless a stable equilibrium is reached; how often the variable of the section has turned round.
    fn pass(&mut self, run: &mut SweepRun, window: usize) -> Result<usize> {
        let (now, from, field) = (run.time, run.state.clone(), Rc::clone(&run.field));
        let (mut steps, mut turns, mut rising) = (0, 0, None);
        let mut observer = |step: &AnyStep<'_>| {
            let rises = step.y1[run.variable] > run.state[run.variable];
            turns += usize::from(rising.is_some_and(|before| before != rises));
            rising = Some(rises);
            run.come_to(step);
            see_all(&mut run.reach, step, run.variable);
            steps += 1;
            run.recorder.steps += 1;
            if run.goes_to_infinity(step) {
                return Ok(Control::Stop);
            }
            let ended = steps % BETWEEN_LOOKS == 0
                && match equilibrium_near(&field, step.y1, AT_REST) {
                    Some((equilibrium, true)) => {
                        run.recorder.ended = Some(caught(step.t1, equilibrium));
                        true
                    }
                    _ => run.is_caught(step),
                };
            Ok(match ended || steps >= window {
                true => Control::Stop,
                false => Control::Continue,
            })
        };
        let span = (now, f64::MAX);
        let one = self.flows.one();
        one.flow(&field, span, &from, Some(&mut observer))?;
        Ok(turns)
    }
}
