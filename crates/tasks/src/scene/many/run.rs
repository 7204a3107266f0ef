//! A run of many interfaces: from a plan to rows.

use super::plan::{ManyInstant, ManyPlan};
use super::saved::ManyCheckpoint;
use crate::scene::column::Column;
use crate::scene::plan::Sampling;
use crate::scene::run::{PICTURED, RunOutcome, Sink};
use crate::scene::system::Described;
use twinslip::error::{Error, Result};
use twinslip::integrate::{Control, Work};
use twinslip::many::{Beginning, Extent, ManyObserver, ManyStep, Saved, SlipEvents};
use twinslip::number::DoubleDouble;

/// Runs a plan.
///
/// # Errors
/// [`Error::Parameter`] for a start that is refused; a failure on the way is in [`RunOutcome::failure`].
pub fn run_many(plan: &ManyPlan, sink: &mut dyn Sink) -> Result<RunOutcome> {
    if !plan.begin() {
        return Err(Error::Input("another process has not begun".into()));
    }
    let (stress, states) = (plan.start.0, &plan.start.1);
    let from = plan.saving.from.as_ref();
    let events = match (plan.catalogue, from) {
        (None, _) => None,
        (Some(asked), None) => Some(asked.events(&plan.interfaces)?),
        (Some(asked), Some(from)) => {
            let saved = SlipEvents::restored(&plan.interfaces, asked.rate, &from.events);
            Some(saved?)
        }
    };
    let mut watch = Watch {
        plan,
        sink,
        events,
        pictured: plan.pictured(),
        slip: DoubleDouble::ZERO,
        slips: vec![DoubleDouble::ZERO; plan.watched.len()],
        row: Vec::new(),
        sampled: 0,
        steps: 0,
        begun: false,
        stopped: false,
        last: None,
    };
    let mut beginning = Beginning::Start(stress, states);
    if let Some(from) = from {
        watch.go_on(&from.rows);
        watch.steps = from.state.steps;
        beginning = Beginning::Saved(&from.state);
    }
    let end = plan.method.run(
        &plan.interfaces,
        beginning,
        plan.until,
        &plan.slips,
        &mut watch,
    );
    if let Err(error @ Error::Parameter { .. }) = end {
        return Err(error);
    }
    let (work, failure) = match end {
        Ok(work) => (work, None),
        Err(error) => {
            let work = Work {
                steps: watch.steps,
                ..Work::default()
            };
            (work, Some(error))
        }
    };
    Ok(RunOutcome {
        last: watch.last,
        events: Vec::new(),
        holds: Vec::new(),
        catalogue: watch.events.map(Into::into),
        work,
        errors: None,
        error_estimate: None,
        estimate_failure: None,
        failure,
        stopped: watch.stopped,
    })
}

/// Makes rows of steps.
struct Watch<'a> {
    plan: &'a ManyPlan,
    sink: &'a mut dyn Sink,
    events: Option<SlipEvents>,
    pictured: Vec<Column<ManyInstant>>,
    /// The slip of all together at the beginning of the step.
    slip: DoubleDouble,
    /// Those of the watched interfaces there.
    slips: Vec<DoubleDouble>,
    row: Vec<f64>,
    sampled: usize,
    steps: usize,
    begun: bool,
    stopped: bool,
    last: Option<Vec<f64>>,
}

impl ManyObserver for Watch<'_> {
    fn step(&mut self, step: &dyn ManyStep) -> Result<bool> {
        Ok(self.see(step))
    }

    fn save_every(&self) -> Option<usize> {
        self.plan.saving.every
    }

    fn save(&mut self, state: Saved) -> Result<()> {
        let held = self.plan.interfaces.share().at_first(state.held);
        let checkpoint = ManyCheckpoint {
            state: Saved { held, ..state },
            rows: self.so_far(),
            events: self.events.as_ref().map_or(Vec::new(), SlipEvents::saved),
        };
        self.sink.save(&checkpoint)
    }
}

impl Watch<'_> {
    /// How far the rows are.
    fn so_far(&self) -> Vec<f64> {
        let share = self.plan.interfaces.share();
        let watched = self.plan.watched.iter().zip(&self.slips);
        let mut slips: Vec<f64> = watched
            .flat_map(|(interface, slip)| match share.held().contains(interface) {
                true => [slip.hi(), slip.lo()],
                false => [0.0; 2],
            })
            .collect();
        // Each process knows its own.
        share.told(&mut slips);
        let mut numbers = vec![self.sampled as f64, self.slip.hi(), self.slip.lo()];
        numbers.extend(slips);
        numbers.extend(self.last.iter().flatten());
        numbers
    }

    /// Goes on from there.
    fn go_on(&mut self, so_far: &[f64]) {
        let mut numbers = so_far.iter().copied();
        let mut next = || numbers.next().unwrap_or_default();
        self.begun = true;
        self.sampled = next() as usize;
        for slip in [&mut self.slip].into_iter().chain(&mut self.slips) {
            *slip = DoubleDouble::new(next(), next());
        }
        let last: Vec<f64> = numbers.collect();
        self.last = (!last.is_empty()).then_some(last);
    }

    /// Whether to go on.
    fn see(&mut self, step: &dyn ManyStep) -> bool {
        let plan = self.plan;
        let end = step.end();
        let first = !std::mem::replace(&mut self.begun, true);
        if first && plan.picture {
            self.draw(step, step.begin());
        }
        if first && plan.sampling == Sampling::EveryStep {
            self.emit(step, step.begin());
        }
        let ends = (plan.until, plan.until);
        while let Some(t) = plan.sampling.time(self.sampled, ends, plan.units())
            && t <= end
        {
            self.emit(step, t);
            self.sampled += 1;
        }
        if plan.picture {
            let length = end - step.begin();
            for part in 1..PICTURED {
                self.draw(step, step.begin() + length * part as f64 / PICTURED as f64);
            }
            self.draw(step, end);
        }
        if let (Some(events), Some(series)) = (&mut self.events, step.series()) {
            events.see(&series);
        }
        let ends = end >= plan.until;
        match plan.sampling {
            Sampling::EveryStep => self.emit(step, end),
            Sampling::FinalOnly if ends => self.emit(step, end),
            _ => {}
        }
        self.slip = self.slip + self.slip_of_all(step, end);
        for (slip, &interface) in self.slips.iter_mut().zip(&plan.watched) {
            *slip = *slip + slip_of(plan, step, interface, end);
        }
        self.steps += 1;
        if self.sink.reached(end / plan.until) == Control::Stop {
            self.stopped = true;
        }
        // What stops one process stops all.
        let own = f64::from(u8::from(self.stopped));
        let [stopped] = plan.interfaces.share().largest([own]);
        self.stopped = stopped > 0.0;
        !self.stopped
    }

    fn slip_of_all(&self, step: &dyn ManyStep, time: f64) -> f64 {
        match self.plan.slips.of_all {
            true => step.slip_of_all(time),
            false => 0.0,
        }
    }

    fn instant(&self, step: &dyn ManyStep, time: f64, whole: bool) -> ManyInstant {
        let plan = self.plan;
        let loading = plan.interfaces.loading;
        let stress = step.stress(time);
        let share = plan.interfaces.share();
        let each = plan.watched.iter().zip(&self.slips);
        let each = each.map(|(&interface, before)| {
            if !share.held().contains(&interface) {
                return [0.0; 3];
            }
            let [psi, v] = step.interface(interface, time);
            let slip = *before + slip_of(plan, step, interface, time);
            [psi, v, slip.hi()]
        });
        let mut each: Vec<[f64; 3]> = each.collect();
        share.told(each.as_flattened_mut());
        let mean = loading.driving / plan.interfaces.count() as f64;
        ManyInstant {
            time,
            stress,
            slip: (self.slip + self.slip_of_all(step, time)).hi(),
            extent: match whole {
                true => step.extent(time, mean),
                false => Extent::NONE,
            },
            each,
        }
    }

    fn draw(&mut self, step: &dyn ManyStep, time: f64) {
        let at = self.instant(step, time, true);
        let units = self.plan.units();
        let cells = self.pictured.iter().map(|column| column.number(&at, units));
        self.row.clear();
        self.row.extend(cells);
        self.sink.drawn(&self.row);
    }

    fn emit(&mut self, step: &dyn ManyStep, time: f64) {
        let at = self.instant(step, time, self.plan.needs_extent());
        let units = self.plan.units();
        let columns = self.plan.columns.iter();
        self.row.clear();
        self.row
            .extend(columns.map(|column| column.number(&at, units)));
        self.last = Some(self.row.clone());
        if self.sink.row(&self.row) == Control::Stop {
            self.stopped = true;
        }
    }
}

/// What is not asked for is not there.
fn slip_of(plan: &ManyPlan, step: &dyn ManyStep, interface: usize, time: f64) -> f64 {
    let here = plan.interfaces.share().held().contains(&interface);
    match here && plan.slips.of.contains(&interface) {
        true => step.slip(interface, time),
        false => 0.0,
    }
}
