//! `twinslip integrate` of many interfaces.

use super::Ending;
use super::integrate::{Beside, PlannedRun, integrate};
use super::ranks::Joined;
use super::stream::StreamOut;
use crate::error::Result;
#[cfg(feature = "mpi")]
use crate::integrate::Control;
use crate::many::Processes;
#[cfg(feature = "mpi")]
use crate::many::Share;
use crate::output::{RowList, plot};
#[cfg(feature = "mpi")]
use crate::scene::Sink;
use crate::scene::{
    Described, IntegrateOptions, Keeping, ManyPlan, Program, Quantity, RunOutcome, run_many,
};
use crate::views::{self, Listed};
use serde_json::{Value, json};
use std::borrow::Cow;

pub fn run(options: &IntegrateOptions, words: &[String]) -> Result<Ending> {
    match Joined::join()? {
        None => integrate(&ManyPlan::new(options, Processes::One)?, options, words),
        #[cfg(feature = "mpi")]
        Some(_joined) => by_ranks(options, words),
        #[cfg(not(feature = "mpi"))]
        Some(joined) => match joined {},
    }
}

/// The ranks integrate together, and the first one writes. What is wrong with the input, all of them see, and one says.
#[cfg(feature = "mpi")]
fn by_ranks(options: &IntegrateOptions, words: &[String]) -> Result<Ending> {
    let plan = ManyPlan::new(options, Processes::Ranks);
    let leads = Share::new(1, Processes::Ranks).rank() == 0;
    if leads {
        let plan = plan?;
        let ended = integrate(&plan, options, words);
        plan.dismiss();
        return ended;
    }
    if let Ok(plan) = plan {
        // A failure on the way is the same in all.
        let _same = run_many(&plan, &mut Silent);
    }
    Ok(Ending::Done)
}

/// Of a process that writes nothing.
#[cfg(feature = "mpi")]
struct Silent;

#[cfg(feature = "mpi")]
impl Sink for Silent {
    fn row(&mut self, _: &[f64]) -> Control {
        Control::Continue
    }

    fn reached(&mut self, _: f64) -> Control {
        Control::Continue
    }
}

impl PlannedRun for ManyPlan {
    fn explain(&self, _: Keeping) -> String {
        self.explain()
    }

    fn system(&self) -> &dyn Described {
        self
    }

    fn numerics(&self) -> Value {
        json!({
            "method": self.method.name(),
            "asked": self.asked_method,
            "order": self.method.order(),
            "rtol": self.rtol,
            "max_steps": self.max_steps,
            "dimension": self.start.1.len() + 1,
        })
    }

    fn columns(&self) -> Vec<(String, Quantity)> {
        views::names(&self.columns, false)
    }

    fn pictured(&self) -> Vec<(String, Quantity)> {
        views::names(&self.pictured(), false)
    }

    fn beside<'a>(&'a self, outcome: &'a RunOutcome) -> Beside<'a> {
        let catalogue = outcome.catalogue.as_ref();
        let count = self.interfaces.count();
        let events = catalogue.map(|catalogue| Listed {
            columns: views::many_event_columns(count),
            rows: Cow::Borrowed(&*catalogue.events),
            units: self.units(),
        });
        let all = catalogue.and_then(|catalogue| catalogue.participants(&self.drawn));
        let participation = all.map(|rows| Listed {
            columns: views::participation_columns(&self.drawn),
            rows: Cow::Owned(rows),
            units: self.units(),
        });
        Beside {
            events: events.map(|events| Box::new(events) as _),
            participation: participation.map(|all| Box::new(all) as _),
        }
    }

    fn program(&self) -> Option<&Program> {
        None
    }

    fn observed(&self) -> bool {
        true
    }

    fn run(&self, out: &mut StreamOut) -> Result<RunOutcome> {
        run_many(self, out)
    }

    fn picture(&self, drawn: &RowList) -> plot::Drawing {
        views::many_run(self, drawn)
    }

    fn picture_of_events(&self, outcome: &RunOutcome) -> Option<plot::Drawing> {
        let catalogue = outcome.catalogue.as_ref();
        catalogue.map(|catalogue| views::picture_of_events(self, &catalogue.events))
    }
}
