//! `twinslip branch`.

use super::continuation::Task;
use super::{Ending, say};
use crate::error::Result;
use crate::scene::{BranchKind, BranchOptions, BranchPlan};
use crate::views;

pub fn run(options: &BranchOptions, words: &[String]) -> Result<Ending> {
    let plan = BranchPlan::new(options)?;
    let task = Task {
        system: &plan.system,
        columns: views::branch_columns(plan.of == BranchKind::Orbits, plan.system.interfaces),
        numerics: plan.numerics.clone(),
        slab: &plan.request.slab,
        second: plan.following.second,
        resume: options.resume.as_ref(),
        plot: options.plot.as_ref(),
        output: &options.output,
        words,
    };
    let report = task.report()?;
    if options.output.explain {
        say(plan.explain());
    }
    task.run(
        &report,
        |known, seen| plan.follow(known, seen),
        |rows, _| views::branches(rows, &plan.along, &plan.request.slab, &plan.system),
    )
}
