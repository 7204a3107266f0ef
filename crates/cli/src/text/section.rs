//! `twinslip section` of a user-defined system, or with a user-defined law.

use crate::Ending;
use crate::call::Call;
use crate::section::ReturnMap;
use serde_json::{Value, json};
use twinslip::error::Result;
use twinslip::number::polynomial::Crossing;
use twinslip_output::RowList;
use twinslip_tasks::scene::{
    Described, SectionOptions, TextModel, TextSectionPlan, run_text_section, text_section_columns,
};
use twinslip_tasks::views;

pub fn run(options: &SectionOptions, model: TextModel, call: &Call) -> Result<Ending> {
    let plan = TextSectionPlan::new(options, model)?;
    let map = ReturnMap {
        system: &plan.model,
        explanation: plan.explain(),
        columns: views::names(&text_section_columns(&plan.model), false),
        numerics: numerics(&plan),
    };
    let picture =
        |rows: &RowList| (rows.iter().len() > 1).then(|| views::text_return_map(&plan, rows));
    map.run(options, call, |out| run_text_section(&plan, out), picture)
}

fn numerics(plan: &TextSectionPlan) -> Value {
    json!({
        "method": plan.method.name(),
        "asked": plan.asked_method,
        "rtol": plan.tolerances.rtol,
        "atol": plan.told_atol(),
        "max_step": plan.model.units().max_step(plan.tolerances),
        "max_steps": plan.max_steps,
        "dimension": plan.start.len(),
        "surface": format!("{}={}", plan.model.system.states()[plan.state], plan.value),
        "upwards": plan.direction == Crossing::Upwards,
        "skip": plan.skip,
        "returns": plan.returns,
        "patience": plan.patience,
    })
}
