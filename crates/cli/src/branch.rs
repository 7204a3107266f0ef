//! `twinslip branch`.

use super::call::Call;
use super::continuation::Task;
use super::rows::{SlabRow, special_row};
use super::{Ending, general, special};
use std::ops::ControlFlow;
use twinslip::bifurcation::clusters::ClusterRow;
use twinslip::bifurcation::{BranchRow, Special, orbits};
use twinslip::error::Result;
use twinslip_output::plot;
use twinslip_tasks::scene::{
    BranchKind, BranchOptions, BranchPlan, Column, Described, TextModel, TextSubject,
};
use twinslip_tasks::views;

/// What the rows of one number make up.
pub const BRANCHES: [&str; 2] = ["branch", "branches"];

pub fn run(options: &BranchOptions, call: &Call) -> Result<Ending> {
    if !options.by_shares()? {
        if let Some(model) = TextModel::of(
            &options.model,
            &[options.along.as_deref().unwrap_or("driving")],
        )? {
            let search = &options.search;
            let subject = TextSubject::new(
                model,
                search.within.as_deref(),
                search.start.as_deref(),
                search.period_guess,
                options.of.as_deref() == Some("orbits"),
            )?;
            return general::branch(options, &subject, call);
        }
        if let Some(subject) = options.any_parameter()? {
            return general::branch(options, &subject, call);
        }
    }
    options.search.unused()?;
    let plan = BranchPlan::new(options)?;
    if plan.system.interfaces > 2 {
        let columns = views::cluster_columns();
        return follow(options, call, &plan, columns, &|rows: &[ClusterRow]| {
            views::staircase(rows, &plan.along, &plan.request.slab, &plan.system)
        });
    }
    let columns = views::branch_columns(plan.of == BranchKind::Orbits, plan.system.interfaces);
    follow(options, call, &plan, columns, &|rows: &[BranchRow]| {
        views::branches(rows, &plan.along, &plan.request.slab, &plan.system)
    })
}

/// Follows the branches, whose rows are of one kind.
fn follow<R: SlabRow>(
    options: &BranchOptions,
    call: &Call,
    plan: &BranchPlan,
    columns: Vec<Column<R>>,
    picture: &dyn Fn(&[R]) -> plot::Drawing,
) -> Result<Ending> {
    let units = plan.system.units();
    let again = |one: &Special| {
        let second = plan.following.second;
        let checked = second.map(|method| orbits::crosscheck(&plan.request.slab, one, method));
        Ok(checked.transpose()?.flatten().map(Vec::from))
    };
    let task = Task {
        system: &plan.system,
        whole: BRANCHES,
        nothing: "no branch of orbits comes into the range: none begins at a Hopf point along the parameter; `orbit` at a value within the range looks for others",
        names: vec![],
        columns,
        special_columns: views::special_columns(),
        read: (&|cell| R::read(cell, units), &|cell| {
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
                R::found(event).map_or(ControlFlow::Continue(()), &mut *seen)
            })
        },
        |rows, _| picture(rows),
    )
}
