//! The run of an initial value problem, step by step: its events, its rows and its solution.

use super::chart::Given;
use super::event::{Halt, zero};
use super::outcome::{IvpAsked, IvpError, IvpOutcome};
use super::plan::IvpPlan;
use super::solution::IvpSolution;
use crate::scene::system::Described;
use twinslip::error::{Error, Result};
use twinslip::integrate::{AnyStep, Control, MotionUnits};

/// What ends a run on its way.
enum Ended<E> {
    Halt(Halt<E>),
    Failed(Error),
}

impl<E> From<Halt<E>> for Ended<E> {
    fn from(halt: Halt<E>) -> Self {
        Ended::Halt(halt)
    }
}

impl IvpPlan {
    /// Runs it.
    ///
    /// # Errors
    /// [`IvpError::Own`] for times that are not within the span or not in its direction (they are called `t_eval`), and for what the
    /// integrator refuses; [`IvpError::Event`]. A failure on the way is in [`IvpOutcome::failure`].
    pub fn solve<E>(&self, asked: IvpAsked<'_, E>) -> Result<IvpOutcome, IvpError<E>> {
        if let Some(times) = asked.times {
            self.check(times)?;
        }
        let equations = self.equations();
        let field = equations.field(&MotionUnits::given(equations.variables()))?;
        let mut integrator = self.integrator()?;
        let events = asked.events.len();
        let mut watch = match Watch::new(self, asked) {
            Ok(watch) => watch,
            Err(Halt::Failed(error)) => return Err(IvpError::Event(error)),
            Err(Halt::Stop) => return Ok(IvpOutcome::interrupted(events)),
        };
        let mut ended = None;
        let mut observer = |step: &AnyStep<'_>| {
            Ok(watch.see(step).unwrap_or_else(|how| {
                ended = Some(how);
                Control::Stop
            }))
        };
        let end = integrator.flow(&field, self.inner_span, &self.from, Some(&mut observer));
        let mut outcome = watch.outcome;
        outcome.work = integrator.work();
        let failure = match (ended, end) {
            (Some(Ended::Halt(Halt::Failed(error))), _) => return Err(IvpError::Event(error)),
            (Some(Ended::Halt(Halt::Stop)), _) => Some(Error::Interrupted),
            (Some(Ended::Failed(error)), _) => Some(error),
            (None, Err(error @ Error::Parameter { .. })) => return Err(error.into()),
            (None, Err(error)) => Some(self.units().told(error)),
            (None, Ok(_)) => None,
        };
        outcome.stopped = failure == Some(Error::Interrupted);
        if failure.is_some() {
            outcome.status = -1;
        }
        outcome.failure = failure;
        outcome.solution = outcome.solution.filter(|made| made.times().len() > 1);
        Ok(outcome)
    }

    fn check(&self, times: &[f64]) -> Result<()> {
        let (begin, end) = self.span;
        let forward = end > begin;
        for (i, &time) in times.iter().enumerate() {
            let name = || format!("t_eval[{i}]");
            if !(begin.min(end)..=begin.max(end)).contains(&time) {
                let must = format!("within `span`, from {begin} to {end}");
                return Err(Error::parameter(name(), time, must));
            }
            let Some(&before) = i.checked_sub(1).and_then(|i| times.get(i)) else {
                continue;
            };
            if (forward && time <= before) || (!forward && time >= before) {
                let way = if forward { "greater" } else { "less" };
                let must = format!("{way} than {before}, the time before, as `span` goes that way");
                return Err(Error::parameter(name(), time, must));
            }
        }
        Ok(())
    }
}

/// The parts of a step that are looked at for the zeros of a formula.
const MOST_PARTS: usize = 1 << 16;
/// So many in each step are no more than usual, and those of a run beyond them are no more than these.
const USUAL_PARTS: [usize; 2] = [1 << 6, 1 << 16];

/// Sees the steps of a run.
struct Watch<'p, 'a, E> {
    plan: &'p IvpPlan,
    asked: IvpAsked<'a, E>,
    /// The degree of the dense output of steps without a series.
    degree: usize,
    /// The user's time and values at the beginning of the step.
    time: f64,
    values: Vec<f64>,
    /// When the function of each event was looked at last, and what it was.
    functions: Vec<(f64, f64)>,
    /// How many more parts of steps than usual are still looked at for the zeros of each formula.
    parts: Vec<usize>,
    /// How many of the times that are asked for have their row.
    sampled: usize,
    outcome: IvpOutcome,
}

/// A step with the user's time and values at its ends.
#[derive(Clone, Copy)]
struct Seen<'s, 'a> {
    plan: &'s IvpPlan,
    step: &'s AnyStep<'a>,
    begin: (f64, &'s [f64]),
    end: (f64, &'s [f64]),
}

impl Seen<'_, '_> {
    /// Where within the step, from 0 at its beginning to 1 at its end, functions without a formula are looked at. Steps of power series are many
    /// times longer than those of other methods: they are divided into half as many parts as their order, so that no more is missed than
    /// with short steps.
    fn parts(&self) -> Vec<f64> {
        let order = self.step.series().map_or(0, |series| series.order());
        let parts = (order / 2).max(1);
        (1..parts).map(|k| k as f64 / parts as f64).collect()
    }

    /// The times at these parts of the step, and its end.
    fn within(&self, parts: Vec<f64>) -> Vec<f64> {
        let (begin, end) = (self.begin.0, self.end.0);
        let times = parts.into_iter().map(|u| begin + (end - begin) * u);
        let mut looks: Vec<f64> = times.collect();
        // A step of a few roundings has no room.
        looks.dedup();
        looks.retain(|&time| time != begin && time != end);
        looks.push(end);
        looks
    }

    /// The user's values at a time.
    fn at(&self, time: f64) -> Vec<f64> {
        for (known, values) in [self.end, self.begin] {
            if time == known {
                return values.to_vec();
            }
        }
        let chart = &self.plan.chart;
        let mut values = Vec::with_capacity(chart.values());
        let y = self.step.dense(chart.time_inward(time));
        chart.outward(y.as_slice(), Given::Variables, &mut values);
        values
    }
}

impl<'p, 'a, E> Watch<'p, 'a, E> {
    fn new(plan: &'p IvpPlan, mut asked: IvpAsked<'a, E>) -> Result<Self, Halt<E>> {
        let (time, values) = (plan.span.0, plan.start.clone());
        let mut functions = Vec::with_capacity(asked.events.len());
        for event in &mut asked.events {
            let value = (event.function)(time, &values)?;
            functions.push((time, event.beginning(value)));
        }
        let mut outcome = IvpOutcome::new(functions.len());
        if asked.dense_output {
            outcome.solution = Some(IvpSolution::new(plan.chart, time));
        }
        if asked.times.is_none() {
            outcome.t.push(time);
            outcome.y.extend_from_slice(&values);
        }
        Ok(Watch {
            plan,
            asked,
            degree: plan.method().dense_degree(),
            time,
            values,
            parts: vec![USUAL_PARTS[1]; functions.len()],
            functions,
            sampled: 0,
            outcome,
        })
    }

    fn see(&mut self, step: &AnyStep<'_>) -> Result<Control, Ended<E>> {
        let end = self.plan.time_outward(step.t1);
        let mut values = Vec::with_capacity(self.values.len());
        let chart = &self.plan.chart;
        chart.outward(step.y1, Given::Variables, &mut values);
        let before = std::mem::take(&mut self.values);
        let seen = Seen {
            plan: self.plan,
            step,
            begin: (self.time, &before),
            end: (end, &values),
        };
        if let Some(solution) = &mut self.outcome.solution {
            solution.push(step, end, self.degree);
        }
        let last = self.events(&seen)?;
        let (time, here) = match last {
            None => (end, None),
            Some(time) => (time, Some(seen.at(time))),
        };
        self.rows(&seen, time, here.as_deref().unwrap_or(&values));
        (self.time, self.values) = (time, here.unwrap_or(values));
        self.reached(last.is_some())
    }

    /// Finds the events of a step; the time of the one that ends the run.
    fn events(&mut self, seen: &Seen<'_, '_>) -> Result<Option<f64>, Ended<E>> {
        if self.asked.events.is_empty() {
            return Ok(None);
        }
        let mut roots = Vec::new();
        for i in 0..self.asked.events.len() {
            for time in self.looks(seen, i) {
                self.look(seen, i, time, &mut roots)?;
            }
        }
        let way = (seen.end.0 - seen.begin.0).signum();
        roots.sort_by(|a, b| (way * a.1).total_cmp(&(way * b.1)));
        for (i, root) in roots {
            self.outcome.t_events[i].push(root);
            self.outcome.y_events[i].extend(seen.at(root));
            if self.asked.events[i].ends_after(self.outcome.t_events[i].len()) {
                self.outcome.status = 1;
                if let Some(solution) = &mut self.outcome.solution {
                    solution.end_at(root);
                }
                return Ok(Some(root));
            }
        }
        Ok(None)
    }

    /// The times within the step, and its end, at which the function of an event is looked at.
    fn looks(&mut self, seen: &Seen<'_, '_>, i: usize) -> Vec<f64> {
        let Some(formula) = &self.asked.events[i].formula else {
            return seen.within(seen.parts());
        };
        let mut step = IvpSolution::new(self.plan.chart, seen.begin.0);
        step.push(seen.step, seen.end.0, self.degree);
        let [usual, _] = USUAL_PARTS;
        let made = formula.parts(&step, MOST_PARTS.min(usual + self.parts[i]));
        self.parts[i] -= made.count.saturating_sub(usual);
        let mut inner = made.inner;
        if made.undecided {
            self.outcome.undecided[i] = true;
            inner.extend(seen.parts());
            inner.sort_by(f64::total_cmp);
        }
        seen.within(inner)
    }

    /// Finds the zeros of an event since the last look.
    fn look(
        &mut self,
        seen: &Seen<'_, '_>,
        i: usize,
        end: f64,
        roots: &mut Vec<(usize, f64)>,
    ) -> Result<(), Ended<E>> {
        let values = seen.at(end);
        let event = &mut self.asked.events[i];
        let after = (event.function)(end, &values)?;
        // What is not a number within a step hides no change of the sign.
        if after.is_nan() && end != seen.end.0 {
            return Ok(());
        }
        let (begin, before) = std::mem::replace(&mut self.functions[i], (end, after));
        // A zero at a look within the step is the end of one part, and not the beginning of another one too.
        let told = before == 0.0 && begin != seen.begin.0 && event.side.is_none();
        if told || !event.is_between(before, after) {
            return Ok(());
        }
        let function = |time: f64| (event.function)(time, &seen.at(time));
        let root = zero((begin, before), (end, after), function)?;
        let root = root.ok_or_else(|| {
            let where_ = format!("between t = {begin} and {end}");
            Ended::Failed(Error::Input(format!(
                "the function of event {i} is not a number {where_}, where it changes its sign"
            )))
        })?;
        roots.push((i, root));
        Ok(())
    }

    /// Adds the rows of a step up to a time, at which these are the values.
    fn rows(&mut self, seen: &Seen<'_, '_>, last: f64, values: &[f64]) {
        let outcome = &mut self.outcome;
        let Some(times) = self.asked.times else {
            let again = outcome.t.len() > 1 && outcome.t.last() == Some(&last);
            if !(again && self.asked.dense_output) {
                outcome.t.push(last);
                outcome.y.extend_from_slice(values);
            }
            return;
        };
        let forward = self.plan.span.1 > self.plan.span.0;
        while let Some(&time) = times.get(self.sampled) {
            if if forward { time > last } else { time < last } {
                break;
            }
            outcome.t.push(time);
            outcome.y.extend(seen.at(time));
            self.sampled += 1;
        }
    }

    /// The run has come to the end of a step.
    fn reached(&mut self, over: bool) -> Result<Control, Ended<E>> {
        let (begin, end) = self.plan.span;
        let told = match &mut self.asked.reached {
            Some(reached) => reached((self.time - begin) / (end - begin)),
            None => Control::Continue,
        };
        if over {
            return Ok(Control::Stop);
        }
        if told == Control::Stop && self.time != end {
            return Err(Halt::Stop.into());
        }
        Ok(Control::Continue)
    }
}
