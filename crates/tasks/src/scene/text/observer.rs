//! What is seen of a run of a user-defined system: rows, slips and the points of a picture.

use super::plan::{TextInstant, TextPlan};
use crate::scene::column::Column;
use crate::scene::plan::Sampling;
use crate::scene::program::Stretch;
use crate::scene::run::{PICTURED, RESTS, RunOutcome, Sink};
use crate::scene::slip::GAUSS;
use crate::scene::system::Described;
use twinslip::error::Result;
use twinslip::field::Vector;
use twinslip::integrate::{AnyStep, Control, MotionUnits, Work};
use twinslip::model::TextSystem;
use twinslip::number::DoubleDouble;

/// Sees the steps of a run and makes rows of them.
pub(super) struct TextObserver<'a> {
    plan: &'a TextPlan,
    sink: &'a mut dyn Sink,
    pictured: Vec<Column<TextInstant>>,
    /// How V_H is here.
    stretch: Stretch,
    /// The units of the steps.
    units: MotionUnits,
    here: TextInstant,
    /// The slips there, in all digits.
    slips: Vec<DoubleDouble>,
    row: Vec<f64>,
    /// Rows at fixed times made so far.
    sampled: usize,
    /// How many stretches have begun.
    begun: usize,
    /// The time of the last row.
    shown: Option<f64>,
    stopped: bool,
}

impl<'a> TextObserver<'a> {
    pub fn new(plan: &'a TextPlan, sink: &'a mut dyn Sink) -> Self {
        let driving = plan.model.driving();
        let slab = plan.model.slab.as_ref();
        let interfaces = slab.map_or(0, |slab| slab.clusters().len());
        TextObserver {
            plan,
            sink,
            pictured: plan.pictured(),
            stretch: Stretch::new((0.0, 0.0), (driving, driving)),
            units: plan.units.clone(),
            here: TextInstant {
                time: 0.0,
                state: plan.start.as_slice().to_vec(),
                slip: vec![0.0; interfaces],
                driving,
            },
            slips: vec![DoubleDouble::ZERO; interfaces],
            row: Vec::new(),
            sampled: 0,
            begun: 0,
            shown: None,
            stopped: false,
        }
    }

    /// Whether the sink stopped the run.
    pub fn stopped(&self) -> bool {
        self.stopped
    }

    /// The next steps are in these units.
    pub fn in_units(&mut self, units: &MotionUnits) {
        self.units.clone_from(units);
    }

    /// A stretch begins: the first one with the first row, the others with one at either side of a change.
    pub fn begin(&mut self, stretch: &Stretch, from: &Vector) {
        let first = self.begun == 0;
        self.begun += 1;
        let rows = self.plan.sampling != Sampling::FinalOnly;
        let changes = !first && self.plan.nodes.is_empty();
        if rows && changes && self.shown != Some(stretch.span.0) {
            let before = self.here.clone();
            self.emit(&before);
        }
        let jumps = stretch.driving.0 != self.stretch.driving.1;
        self.stretch = *stretch;
        self.here.time = stretch.span.0;
        let count = self.here.state.len();
        self.here.state.copy_from_slice(&from.as_slice()[..count]);
        self.here.driving = stretch.driving.0;
        let here = self.here.clone();
        if self.plan.picture {
            self.draw(&here);
        }
        if rows && (first || jumps) {
            self.emit(&here);
        }
        if first && rows {
            self.sampled = 1;
        }
    }

    pub fn see(&mut self, system: &TextSystem, step: &AnyStep<'_>) -> Control {
        let (plan, stretch) = (self.plan, self.stretch);
        let before = std::mem::take(&mut self.slips);
        let needs_slip = plan.needs_slip();
        let slip = |t: f64| {
            if needs_slip {
                slips(system, step, &before, t)
            } else {
                before.clone()
            }
        };
        let count = plan.start.len();
        let units = std::mem::replace(&mut self.units, MotionUnits::given(0));
        // Units of time are powers of two: times come and go without rounding.
        let (begin, end) = (step.t0 * units.time, step.t1 * units.time);
        let instant = |t: f64, slips: &[DoubleDouble]| {
            let state = match t == end {
                true => Vector::from_column_slice(step.y1),
                false => step.dense(t / units.time),
            };
            // On a ramp V_H is a variable more, and so is time where formulas name it.
            let state = state.iter().take(count).enumerate();
            let state = state.map(|(i, &x)| units.outward_value(i, x));
            TextInstant {
                time: t,
                state: state.collect(),
                slip: leading(slips),
                driving: stretch.driving_at(t),
            }
        };
        while let Some(t) = self.next_sample().filter(|&t| t <= end) {
            self.emit(&instant(t, &slip(t)));
            self.sampled += 1;
        }
        if plan.picture {
            for part in 1..=PICTURED {
                let t = begin + (end - begin) * part as f64 / PICTURED as f64;
                self.draw(&instant(t, &before));
            }
        }
        self.slips = slip(end);
        self.here = instant(end, &self.slips);
        self.units = units;
        if plan.sampling == Sampling::EveryStep {
            let here = self.here.clone();
            self.emit(&here);
        }
        if self.sink.reached(end / plan.until) == Control::Stop {
            self.stopped = true;
        }
        let only_end = plan.sampling == Sampling::FinalOnly && !plan.picture && !needs_slip;
        match (self.stopped, only_end) {
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
        let units = plan.model.units();
        plan.sampling.time(self.sampled, (plan.until, end), units)
    }

    fn draw(&mut self, at: &TextInstant) {
        fill(&mut self.row, &self.pictured, self.plan, at);
        self.sink.drawn(&self.row);
    }

    fn emit(&mut self, at: &TextInstant) {
        fill(&mut self.row, &self.plan.columns, self.plan, at);
        self.shown = Some(at.time);
        if self.sink.row(&self.row) == Control::Stop {
            self.stopped = true;
        }
    }

    pub fn finish(mut self, end: &Result<Vector>) -> RunOutcome {
        let plan = self.plan;
        if let Ok(y) = end
            && !self.stopped
        {
            self.here.time = plan.until;
            self.here.state.copy_from_slice(y.as_slice());
            self.here.driving = self.stretch.driving.1;
            if plan.sampling == Sampling::FinalOnly {
                let here = self.here.clone();
                self.emit(&here);
            }
        }
        let known = end.is_ok() || plan.observed();
        fill(&mut self.row, &plan.columns, plan, &self.here);
        RunOutcome {
            last: known.then_some(self.row),
            events: Vec::new(),
            catalogue: None,
            work: Work::default(),
            errors: None,
            error_estimate: None,
            estimate_failure: None,
            failure: end.as_ref().err().cloned(),
            stopped: self.stopped,
        }
    }
}

/// The slips at t, from those at the beginning of the step: term by term where the step is a series, else by quadrature.
fn slips(
    system: &TextSystem,
    step: &AnyStep<'_>,
    before: &[DoubleDouble],
    t: f64,
) -> Vec<DoubleDouble> {
    let h = step.since_begin(t);
    let within = match step.series() {
        Some(series) => {
            let interfaces = 0..before.len();
            interfaces.map(|i| series.slip(i, h)).collect()
        }
        None => {
            let mut slips = vec![0.0; before.len()];
            for (node, weight) in GAUSS {
                let rates = system.slip_rates(step.after(node * h).as_slice());
                for (slip, v) in slips.iter_mut().zip(rates) {
                    *slip += weight * h * v;
                }
            }
            slips
        }
    };
    let both = before.iter().zip(within);
    both.map(|(before, within): (_, f64)| *before + within)
        .collect()
}

fn leading(slips: &[DoubleDouble]) -> Vec<f64> {
    slips.iter().map(|slip| slip.hi()).collect()
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
