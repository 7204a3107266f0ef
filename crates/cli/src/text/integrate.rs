//! `twinslip integrate --system`.

use crate::integrate::PlannedRun;
use crate::stream::StreamOut;
use serde_json::{Value, json};
use twinslip::error::Result;
use twinslip_output::{RowList, plot};
use twinslip_tasks::scene::{
    Described, Keeping, Program, Quantity, RunOutcome, TextPlan, run_text,
};
use twinslip_tasks::views;

impl PlannedRun for TextPlan {
    fn explain(&self, _: Keeping) -> String {
        self.explain()
    }

    fn system(&self) -> &dyn Described {
        &self.model
    }

    fn numerics(&self) -> Value {
        json!({
            "method": self.method.name(),
            "asked": self.asked_method,
            "rtol": self.tolerances.rtol,
            "atol": self.told_atol(),
            "max_step": self.model.units().max_step(self.tolerances),
            "max_steps": self.max_steps,
            "dimension": self.start.len(),
        })
    }

    fn columns(&self) -> Vec<(String, Quantity)> {
        views::names(&self.columns, false)
    }

    fn pictured(&self) -> Vec<(String, Quantity)> {
        views::names(&self.pictured(), false)
    }

    fn program(&self) -> Option<&Program> {
        self.program.as_ref()
    }

    fn states(&self) -> &[&'static str] {
        self.model.system.states()
    }

    fn observed(&self) -> bool {
        self.observed()
    }

    fn run(&self, out: &mut StreamOut<'_>) -> Result<RunOutcome> {
        run_text(self, out)
    }

    fn picture(&self, drawn: &RowList) -> plot::Drawing {
        views::text_run(self, drawn)
    }
}
