//! `twinslip locus`.

use super::call::Call;
use super::continuation::Task;
use super::rows::{SlabRow, special_row};
use super::{Ending, general, special};
use std::ops::ControlFlow;
use twinslip::bifurcation::{LocusRow, Special, orbits};
use twinslip::error::Result;
use twinslip_tasks::scene::{
    CurveChoice, Described, LocusOptions, LocusPlan, TextModel, TextSubject, plane,
};
use twinslip_tasks::views;

/// What the rows of one number make up.
pub const CURVES: [&str; 2] = ["curve", "curves"];

pub fn run(options: &LocusOptions, call: &Call) -> Result<Ending> {
    if !options.by_shares()? {
        if let Some(model) = TextModel::of(
            &options.model,
            &plane(options.plane.as_deref().unwrap_or("driving,stiffness"))?,
        )? {
            let search = &options.search;
            let subject = TextSubject::new(
                model,
                search.within.as_deref(),
                search.start.as_deref(),
                search.period_guess,
                CurveChoice::named(options.of.as_deref())?.of_orbits(),
            )?;
            return general::locus(options, &subject, call);
        }
        if let Some(subject) = options.any_parameter()? {
            return general::locus(options, &subject, call);
        }
    }
    options.search.unused()?;
    let plan = LocusPlan::new(options)?;
    let units = plan.system.units();
    let again = |one: &Special| {
        let second = plan.following.second;
        let checked = second.map(|method| orbits::crosscheck(&plan.request.slab, one, method));
        Ok(checked.transpose()?.flatten().map(Vec::from))
    };
    let nothing = format!(
        "no {} bifurcation is found in these ranges; give others by `driving_range` and `stiffness_range`, or other constants of the law",
        plan.curve.name
    );
    let task = Task {
        system: &plan.system,
        whole: CURVES,
        nothing: &nothing,
        names: vec![],
        columns: views::locus_columns(plan.system.interfaces),
        special_columns: views::special_columns(),
        read: (&|cell| LocusRow::read(cell, units), &|cell| {
            special_row(cell, units)
        }),
        lines: &|special, checks| special::lines(special, checks, units),
        numerics: plan.numerics.clone(),
        second: plan.following.second.map(|second| (second, &again as _)),
        resume: options.resume.as_ref(),
        plot: options.plot.as_ref(),
        output: &options.output,
        call,
    };
    let report = task.report()?;
    if options.output.explain {
        call.say(plan.explain());
    }
    task.run(
        &report,
        |known, seen| {
            plan.follow(known, &mut |event| {
                LocusRow::found(event).map_or(ControlFlow::Continue(()), &mut *seen)
            })
        },
        |rows, special| views::curves(rows, special, plan.curve.title, units),
    )
}
