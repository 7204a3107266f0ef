//! `twinslip integrate` of many interfaces.

use super::integrate::{Beside, PlannedRun};
use super::stream::StreamOut;
use crate::error::Result;
use crate::output::{RowList, plot};
use crate::scene::{Described, Keeping, ManyPlan, Program, Quantity, RunOutcome, run_many};
use crate::views::{self, Listed};
use serde_json::{Value, json};
use std::borrow::Cow;

impl PlannedRun for ManyPlan {
    fn explain(&self, _: Keeping) -> String {
        self.explain()
    }

    fn system(&self) -> &dyn Described {
        self
    }

    fn numerics(&self) -> Value {
        json!({
            "method": "taylor",
            "asked": self.asked_method,
            "order": self.taylor.order(),
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
