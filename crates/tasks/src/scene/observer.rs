//! The observer of a run: rows, slips, events and the points of a picture.

use super::column::Column;
use super::event::Detector;
use super::holds::Begun;
use super::instant::Instant;
use super::plan::{EVENT_THRESHOLD, Plan, Sampling};
use super::program::Stretch;
use super::run::{PICTURED, RESTS, RunOutcome, Sink};
use super::slip::{SlipRates, Slips, slips};
use super::system::Described;
use twinslip::error::Result;
use twinslip::field::Vector;
use twinslip::integrate::{AnyField, AnyStep, Control, MotionUnits, Work};
use twinslip::number::DoubleDouble;

/// Sees the steps of a run and makes rows, slips and events of them.
pub(super) struct RunObserver<'a> {
    plan: &'a Plan,
    sink: &'a mut dyn Sink,
    detector: Option<Detector>,
    /// Where stretches have begun.
    begins: Begun,
    rates: SlipRates,
    needs_slip: bool,
    /// Whether the units of the steps are those of the system.
    keeps_units: bool,
    /// Whether nothing but the end is shown.
    only_end: bool,
    /// How V_H is here.
    stretch: Stretch,
    /// The units of the steps.
    units: MotionUnits,
    /// Where the run is.
    here: Instant,
    /// The slips there, and at the beginning of the step, in all digits.
    slips: Slips,
    before: Slips,
    row: Vec<f64>,
    pictured: Vec<Column<Instant>>,
    /// Rows at fixed times made so far.
    sampled: usize,
    /// How many stretches have begun.
    begun: usize,
    /// The time of the last row.
    shown: Option<f64>,
    stopped: bool,
}

impl<'a> RunObserver<'a> {
    pub fn new(plan: &'a Plan, sink: &'a mut dyn Sink) -> Self {
        let driving = plan.system.driving();
        let rates = SlipRates::of(&plan.system, plan.subspace);
        let mut observer = RunObserver {
            plan,
            sink,
            detector: match (plan.detected(), plan.holds()) {
                (threshold, true) => {
                    let threshold = threshold.unwrap_or(EVENT_THRESHOLD);
                    Some(Detector::new(&plan.system, &rates, threshold).with_maxima())
                }
                (Some(threshold), false) => Some(Detector::new(&plan.system, &rates, threshold)),
                (None, false) => None,
            },
            begins: Begun::default(),
            needs_slip: plan.needs_slip(),
            keeps_units: plan.system.slides(),
            only_end: plan.sampling == Sampling::FinalOnly
                && plan.events.is_none()
                && !plan.holds()
                && !plan.picture,
            stretch: Stretch {
                span: (0.0, 0.0),
                driving: (driving, driving),
            },
            units: plan.units.clone(),
            here: Instant {
                driving,
                ..Instant::default()
            },
            slips: vec![DoubleDouble::ZERO; rates.count()],
            before: Slips::new(),
            rates,
            row: Vec::new(),
            pictured: plan.pictured(),
            sampled: 0,
            begun: 0,
            shown: None,
            stopped: false,
        };
        observer.stand(0.0, &plan.start);
        observer
    }

    /// Whether the sink stopped the run.
    pub fn stopped(&self) -> bool {
        self.stopped
    }

    /// The next steps are in these units.
    pub fn in_units(&mut self, units: &MotionUnits) {
        self.units.clone_from(units);
    }

    /// The run is at these values of the states of its subspace.
    fn stand(&mut self, time: f64, y: &Vector) {
        let here = &mut self.here;
        here.time = time;
        here.state.clear();
        let count = self.plan.start.len();
        self.plan
            .subspace
            .whole(&y.as_slice()[..count], &mut here.state);
        here.slip.clear();
        here.slip.extend(self.slips.iter().map(|slip| slip.hi()));
    }

    /// A stretch begins: the first one with the first row, the others with one at either side of a change.
    pub fn begin(&mut self, stretch: &Stretch, from: &Vector) {
        let first = self.begun == 0;
        self.begun += 1;
        self.begins.begin(stretch.span.0, from[0]);
        if let Some(detector) = &mut self.detector {
            detector.begin(stretch, from.as_slice(), &self.slips);
        }
        let rows = self.plan.sampling != Sampling::FinalOnly;
        let changes = !first && self.plan.nodes.is_empty();
        if rows && changes && self.shown != Some(stretch.span.0) {
            self.emit();
        }
        let jumps = stretch.driving.0 != self.stretch.driving.1;
        self.stretch = *stretch;
        self.stand(stretch.span.0, from);
        self.here.driving = stretch.driving.0;
        if self.plan.picture {
            self.draw();
        }
        if rows && (first || jumps) {
            self.emit();
        }
        if first && rows {
            self.sampled = 1;
        }
    }

    pub fn see(&mut self, field: &AnyField<'_>, step: &AnyStep<'_>) -> Result<Control> {
        if let Some(detector) = &mut self.detector {
            detector.see(field, step, &self.slips)?;
        }
        // Units of time are powers of two: times come and go without rounding.
        let (begin, end) = (step.t0 * self.units.time, step.t1 * self.units.time);
        if self.needs_slip {
            self.before.clone_from(&self.slips);
        }
        while let Some(t) = self.next_sample().filter(|&t| t <= end) {
            self.slip_to(step, t);
            self.go_to(step, t);
            self.emit();
            self.sampled += 1;
        }
        if self.plan.picture {
            for part in 1..=PICTURED {
                let t = begin + (end - begin) * part as f64 / PICTURED as f64;
                self.go_to(step, t);
                self.draw();
            }
        }
        self.slip_to(step, end);
        self.go_to(step, end);
        if self.plan.sampling == Sampling::EveryStep {
            self.emit();
        }
        Ok(self.reached())
    }

    /// Goes on with the slips to a time of the step.
    fn slip_to(&mut self, step: &AnyStep<'_>, t: f64) {
        if self.needs_slip {
            let inside = t / self.units.time;
            slips(&self.rates, step, &self.before, inside, &mut self.slips);
        }
    }

    /// Goes to a time of the step.
    fn go_to(&mut self, step: &AnyStep<'_>, t: f64) {
        let (count, units) = (self.plan.start.len(), &self.units);
        let inside = t / units.time;
        let dense;
        let y = if inside == step.t1 {
            step.y1
        } else if inside == step.t0 {
            step.y0
        } else {
            dense = step.dense(inside);
            dense.as_slice()
        };
        let here = &mut self.here;
        here.time = t;
        here.driving = self.stretch.driving_at(t);
        here.state.clear();
        // On a ramp V_H is a variable more, and so is time where formulas name it.
        match self.keeps_units {
            true => here.state.extend_from_slice(&y[..count]),
            false => {
                let own = y[..count].iter().enumerate();
                let own = own.map(|(i, &x)| units.outward_value(i, x));
                here.state.extend(own);
            }
        }
        self.plan.subspace.complete(&mut here.state);
        if self.needs_slip {
            here.slip.clear();
            here.slip.extend(self.slips.iter().map(|slip| slip.hi()));
        }
    }

    /// The run has come to the end of a step.
    fn reached(&mut self) -> Control {
        if self.sink.reached(self.here.time / self.plan.until) == Control::Stop {
            self.stopped = true;
        }
        match (self.stopped, self.only_end) {
            (true, _) => Control::Stop,
            (false, true) => Control::Rest(RESTS),
            (false, false) => Control::Continue,
        }
    }

    /// The next fixed time of a row.
    fn next_sample(&self) -> Option<f64> {
        let plan = self.plan;
        let end = match plan.program {
            Some(_) => self.stretch.span.1,
            None => plan.until,
        };
        let units = plan.system.units();
        plan.sampling.time(self.sampled, (plan.until, end), units)
    }

    fn draw(&mut self) {
        fill(&mut self.row, &self.pictured, self.plan, &self.here);
        self.sink.drawn(&self.row);
    }

    fn emit(&mut self) {
        fill(&mut self.row, &self.plan.columns, self.plan, &self.here);
        self.shown = Some(self.here.time);
        if self.sink.row(&self.row) == Control::Stop {
            self.stopped = true;
        }
    }

    pub fn finish(mut self, end: &Result<Vector>) -> RunOutcome {
        let plan = self.plan;
        if let Ok(y) = end
            && !self.stopped
        {
            self.stand(plan.until, y);
            self.here.driving = self.stretch.driving.1;
            if plan.sampling == Sampling::FinalOnly {
                self.emit();
            }
        }
        let known = end.is_ok() || plan.observed();
        fill(&mut self.row, &plan.columns, plan, &self.here);
        let found = self.detector.map(Detector::into_found);
        let (events, maxima) = found.unwrap_or_default();
        RunOutcome {
            last: known.then_some(self.row),
            events: match plan.detected() {
                Some(_) => events,
                None => Vec::new(),
            },
            holds: self.begins.holds(plan, &maxima),
            catalogue: None,
            work: Work::default(),
            error_estimate: None,
            errors: None,
            estimate_failure: None,
            failure: end.as_ref().err().cloned(),
            stopped: self.stopped,
        }
    }
}

/// Fills a row with the columns at an instant, in the user's units.
fn fill(row: &mut Vec<f64>, columns: &[Column<Instant>], plan: &Plan, at: &Instant) {
    let units = plan.system.units();
    row.clear();
    row.extend(columns.iter().map(|column| column.number(at, units)));
}
