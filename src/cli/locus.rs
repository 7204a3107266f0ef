//! `twinslip locus`.

use super::continuation::Task;
use super::{Ending, say};
use crate::error::Result;
use crate::scene::{LocusOptions, LocusPlan};
use crate::views;

pub fn run(options: &LocusOptions, words: &[String]) -> Result<Ending> {
    let plan = LocusPlan::new(options)?;
    let task = Task {
        system: &plan.system,
        columns: views::locus_columns(),
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
        |rows, special| views::curves(rows, special, plan.curve.title, &plan.system.units),
    )
}
