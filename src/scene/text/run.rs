//! A run of a system of one's own: from options to rows.

use super::model::TextModel;
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::friction::positive;
use crate::integrate::{AnyField, AnyIntegrator, AnyStep, Choice, Control, Tolerances, Work};
use crate::scene::column::Column;
use crate::scene::estimate::{Companion, GROWTH, MARGIN, PIECES, ROUNDING, TIME_SPACINGS};
use crate::scene::options::{IntegrateOptions, NumericsOptions};
use crate::scene::plan::{Sampling, sampling, until};
use crate::scene::run::{PICTURED, RESTS, Sink};
use crate::scene::system::Described;
use crate::scene::units::Quantity;

/// A run of a system of one's own, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct TextPlan {
    /// The system.
    pub model: TextModel,
    /// Where it starts.
    pub start: Vector,
    /// End of the run.
    pub until: f64,
    /// When there are rows.
    pub sampling: Sampling,
    /// What a row holds.
    pub columns: Vec<Column<TextInstant>>,
    /// Whether the run is drawn.
    pub picture: bool,
    /// The second run that estimates the error, if one does.
    pub estimate: Option<Companion>,
    /// The method's name as it was asked for.
    pub asked_method: String,
    /// The method.
    pub method: Choice,
    /// The tolerances.
    pub tolerances: Tolerances,
    /// The bound on steps.
    pub max_steps: usize,
}

/// A point of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct TextInstant {
    /// Time.
    pub time: f64,
    /// The values of all states.
    pub state: Vec<f64>,
}

/// The columns of a run: the time, and every state by its name.
pub fn text_columns(model: &TextModel) -> Vec<Column<TextInstant>> {
    let time = Column::new("time", Quantity::Number, |at: &TextInstant| at.time.into());
    let states = model.system.states().iter().enumerate();
    let state = |(i, name): (usize, &&'static str)| {
        Column::new(*name, Quantity::Number, move |at: &TextInstant| {
            at.state[i].into()
        })
    };
    std::iter::once(time).chain(states.map(state)).collect()
}

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

/// The method and the tolerances, checked.
pub(super) fn numerics(options: &NumericsOptions) -> Result<(Choice, Tolerances)> {
    if options.max_steps == 0 {
        return Err(Error::parameter("max-steps", 0, "at least 1"));
    }
    let atol = options.atol.unwrap_or(options.rtol);
    let tolerances = Tolerances::new(options.rtol, atol)?;
    Ok((Choice::named(&options.method)?, tolerances))
}

impl TextPlan {
    /// Checks the options of a run of this system.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &IntegrateOptions, model: TextModel) -> Result<Self> {
        if options.events.is_some() {
            return Err(Error::Input(
                "`events` are stick-slip events, which need interfaces; a `system` of one's own has none".into(),
            ));
        }
        let start = model.start(options.start.as_deref())?;
        let until = until(options)?;
        let sampling = sampling(options, model.units(), until)?;
        let mut columns = text_columns(&model);
        if let Some(names) = &options.columns {
            columns = Column::listed(&columns, names)?;
        }
        let (method, tolerances) = numerics(&options.numerics)?;
        Ok(TextPlan {
            start,
            until: positive("until", until)?,
            sampling,
            columns,
            picture: options.plot.is_some(),
            estimate: (options.estimate_error || options.reference)
                .then(|| Companion::of(tolerances, options.reference)),
            asked_method: options.numerics.method.clone(),
            method,
            tolerances,
            max_steps: options.numerics.max_steps,
            model,
        })
    }

    /// Whether anything must be seen between start and end.
    pub fn observed(&self) -> bool {
        self.sampling != Sampling::FinalOnly || self.picture
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let rows = match self.sampling {
            Sampling::FinalOnly => "off: only the end is asked for".to_owned(),
            Sampling::EveryStep => "a row at every step".to_owned(),
            Sampling::Points(n) => format!("{n} rows equally spaced in time"),
            Sampling::Every(dt) => format!("a row every {dt}"),
        };
        let estimate = match self.estimate {
            Some(Companion::Tighter(second)) => format!(
                "on: twice the distance to a second run by auto with rtol {:e}, and the rounding of the start by a tangent flow",
                second.rtol
            ),
            Some(Companion::Reference) => {
                "on: twice the distance to a second run in double-double arithmetic, and the rounding of the start by a tangent flow".into()
            }
            None => "off: `estimate_error` is not given".into(),
        };
        format!(
            "plan of this run
  dimension         {}: {}
  method            {}: {}
  tolerances        rtol {:e}, atol {:e} on every state, at most {} steps
  trajectory        {rows}
  error estimate    {estimate}",
            self.start.len(),
            self.model.system.states().join(", "),
            self.method.name(),
            self.method.reason(),
            self.tolerances.rtol,
            self.tolerances.atol,
            crate::error::count(self.max_steps)
        )
    }
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
        let next = |sampled: usize| plan.sampling.time(sampled, plan.until);
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
