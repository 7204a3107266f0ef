//! A run of a system of one's own: from a plan to rows.

use super::plan::{TextInstant, TextPlan, text_columns};
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::integrate::{AnyField, AnyIntegrator, AnyStep, Choice, Control, Tolerances, Work};
use crate::scene::column::Column;
use crate::scene::estimate::{Companion, GROWTH, MARGIN, PIECES, ROUNDING, TIME_SPACINGS};
use crate::scene::plan::Sampling;
use crate::scene::run::{PICTURED, RESTS, Sink};
use crate::scene::system::Described;

/// What a run came to.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TextOutcome {
    /// The last row; `None` if a run that nobody watched failed.
    pub last: Option<Vec<f64>>,
    /// What it cost, the second run of an error estimate included.
    pub work: Work,
    /// Estimates of the global errors of all states at the end, not below them; `None` where not asked for or not known.
    pub errors: Option<Vec<f64>>,
    /// The largest of them, in units of 1 + |x|.
    pub error_estimate: Option<f64>,
    /// Why they could not be estimated.
    pub estimate_failure: Option<Error>,
    /// Why it ended early.
    pub failure: Option<Error>,
    /// Whether the sink stopped it.
    pub stopped: bool,
}

/// Runs a plan.
///
/// # Errors
/// [`Error::Parameter`] if the integrator refuses its settings; a failure on the way is in [`TextOutcome::failure`].
pub fn run_text(plan: &TextPlan, sink: &mut dyn Sink) -> Result<TextOutcome> {
    let field = plan.model.field()?;
    let mut integrator = AnyIntegrator::new(plan.method, plan.tolerances, plan.max_steps)?;
    let mut watch = TextObserver::new(plan, &mut *sink);
    watch.start();
    let span = (0.0, plan.until);
    let end = if plan.observed() {
        let mut observer = |step: &AnyStep<'_>| Ok(watch.see(step));
        integrator.flow(&field, span, &plan.start, Some(&mut observer))
    } else {
        integrator.flow(&field, span, &plan.start, None)
    };
    let mut outcome = watch.finish(&end);
    outcome.work = integrator.work();
    match (end, plan.estimate) {
        (Ok(end), Some(companion)) if !outcome.stopped => {
            let second = second_run(companion, plan, &field, &mut outcome, sink);
            match second.and_then(|second| errors(plan, &field, &end, &second, &mut outcome)) {
                Ok(errors) => {
                    let sizes = errors.iter().zip(&end).map(|(e, x)| e / (1.0 + x.abs()));
                    outcome.error_estimate = Some(sizes.fold(0.0, f64::max));
                    outcome.errors = Some(errors);
                }
                Err(Error::Interrupted) => outcome.stopped = true,
                Err(error) => outcome.estimate_failure = Some(error),
            }
        }
        (Err(error @ (Error::BlowUp { .. } | Error::TooFast { .. })), _) => {
            let companion = Companion::of(plan.tolerances, false);
            let second = second_run(companion, plan, &field, &mut outcome, sink);
            outcome.failure = Some(timed(error, second.err()));
        }
        _ => {}
    }
    Ok(outcome)
}

/// The end of the run by another method.
fn second_run(
    companion: Companion,
    plan: &TextPlan,
    field: &AnyField<'_>,
    outcome: &mut TextOutcome,
    sink: &mut dyn Sink,
) -> Result<Vector> {
    let mut integrator = companion.any_integrator(plan.max_steps)?;
    let mut stopped = false;
    let mut observer = |step: &AnyStep<'_>| {
        let told = sink.reached(step.t1 / plan.until);
        stopped |= told == Control::Stop;
        Ok(told)
    };
    let end = integrator.flow(field, (0.0, plan.until), &plan.start, Some(&mut observer));
    outcome.work += integrator.work();
    if stopped {
        Err(Error::Interrupted)
    } else {
        end
    }
}

/// The error of every state at the end: what the second run says, and what becomes of the rounding of the start.
fn errors(
    plan: &TextPlan,
    field: &AnyField<'_>,
    end: &Vector,
    second: &Vector,
    outcome: &mut TextOutcome,
) -> Result<Vec<f64>> {
    let tolerances = Tolerances::equal(GROWTH)?;
    let mut integrator = AnyIntegrator::new(Choice::Auto, tolerances, plan.max_steps)?;
    let count = plan.start.len();
    let (mut y, mut tangent) = (plan.start.clone(), Matrix::identity(count, count));
    let time = |piece: usize| plan.until * (piece as f64 / PIECES as f64);
    for piece in 0..PIECES {
        let span = (time(piece), time(piece + 1));
        let (next, part) = integrator.derivatives(field, span, &y, &[])?;
        outcome.work += integrator.work();
        y = next;
        tangent = part.start * tangent;
    }
    let rounded = plan.start.map(|x| 0.5 * f64::EPSILON * x.abs());
    let moved = tangent.abs() * rounded;
    let error =
        |i: usize| MARGIN * (end[i] - second[i]).abs() + moved[i] + ROUNDING * (1.0 + end[i].abs());
    Ok((0..count).map(error).collect())
}

/// A singularity with the uncertainty of its time, by that of a second run.
fn timed(mut error: Error, second: Option<Error>) -> Error {
    if let Error::BlowUp { t, uncertainty, .. } | Error::TooFast { t, uncertainty, .. } = &mut error
        && let Some(Error::BlowUp { t: again, .. } | Error::TooFast { t: again, .. }) = second
    {
        let rounding = TIME_SPACINGS * f64::EPSILON * again.abs();
        *uncertainty = Some(MARGIN * (again - *t).abs() + rounding);
    }
    error
}

/// Sees the steps of a run and makes rows of them.
struct TextObserver<'a> {
    plan: &'a TextPlan,
    sink: &'a mut dyn Sink,
    pictured: Vec<Column<TextInstant>>,
    here: TextInstant,
    row: Vec<f64>,
    /// Rows at fixed times made so far.
    sampled: usize,
    stopped: bool,
}

impl<'a> TextObserver<'a> {
    fn new(plan: &'a TextPlan, sink: &'a mut dyn Sink) -> Self {
        TextObserver {
            plan,
            sink,
            pictured: text_columns(&plan.model),
            here: TextInstant {
                time: 0.0,
                state: plan.start.as_slice().to_vec(),
            },
            row: Vec::new(),
            sampled: 0,
            stopped: false,
        }
    }

    fn start(&mut self) {
        let here = self.here.clone();
        if self.plan.picture {
            self.draw(&here);
        }
        if self.plan.sampling != Sampling::FinalOnly {
            self.emit(&here);
            self.sampled = 1;
        }
    }

    fn see(&mut self, step: &AnyStep<'_>) -> Control {
        let instant = |t: f64| TextInstant {
            time: t,
            state: if t == step.t1 {
                step.y1.to_vec()
            } else {
                step.dense(t).as_slice().to_vec()
            },
        };
        let plan = self.plan;
        let next = |sampled: usize| plan.sampling.time(sampled, plan.until, plan.until);
        while let Some(t) = next(self.sampled).filter(|&t| t <= step.t1) {
            self.emit(&instant(t));
            self.sampled += 1;
        }
        if plan.picture {
            for part in 1..=PICTURED {
                let t = step.t0 + (step.t1 - step.t0) * part as f64 / PICTURED as f64;
                self.draw(&instant(t));
            }
        }
        self.here.time = step.t1;
        self.here.state.copy_from_slice(step.y1);
        if plan.sampling == Sampling::EveryStep {
            let here = self.here.clone();
            self.emit(&here);
        }
        if self.sink.reached(step.t1 / plan.until) == Control::Stop {
            self.stopped = true;
        }
        match (
            self.stopped,
            plan.sampling == Sampling::FinalOnly && !plan.picture,
        ) {
            (true, _) => Control::Stop,
            (false, true) => Control::Rest(RESTS),
            (false, false) => Control::Continue,
        }
    }

    fn draw(&mut self, at: &TextInstant) {
        fill(&mut self.row, &self.pictured, self.plan, at);
        self.sink.drawn(&self.row);
    }

    fn emit(&mut self, at: &TextInstant) {
        fill(&mut self.row, &self.plan.columns, self.plan, at);
        if self.sink.row(&self.row) == Control::Stop {
            self.stopped = true;
        }
    }

    fn finish(mut self, end: &Result<Vector>) -> TextOutcome {
        let plan = self.plan;
        if let Ok(y) = end
            && !self.stopped
        {
            self.here = TextInstant {
                time: plan.until,
                state: y.as_slice().to_vec(),
            };
            if plan.sampling == Sampling::FinalOnly {
                let here = self.here.clone();
                self.emit(&here);
            }
        }
        let known = end.is_ok() || plan.observed();
        fill(&mut self.row, &plan.columns, plan, &self.here);
        TextOutcome {
            last: known.then_some(self.row),
            work: Work::default(),
            errors: None,
            error_estimate: None,
            estimate_failure: None,
            failure: end.as_ref().err().cloned(),
            stopped: self.stopped,
        }
    }
}

/// Fills a row with the columns at an instant.
fn fill(row: &mut Vec<f64>, columns: &[Column<TextInstant>], plan: &TextPlan, at: &TextInstant) {
    row.clear();
    row.extend(
        columns
            .iter()
            .map(|column| column.number(at, plan.model.units())),
    );
}
