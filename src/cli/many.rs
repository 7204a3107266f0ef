//! `twinslip integrate` of many interfaces.

use super::integrate::PlannedRun;
use super::stream::StreamOut;
use crate::error::Result;
use crate::output::{RowList, plot};
use crate::scene::{Described, Keeping, ManyPlan, Program, Quantity, RunOutcome, run_many};
use crate::views;
use serde_json::{Value, json};

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
}
