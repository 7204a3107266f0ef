//! `twinslip branch`.

use super::call::Call;
use super::slab::SlabCurves;
use super::{Ending, general};
use twinslip::bifurcation::BranchRow;
use twinslip::error::Result;
use twinslip_tasks::scene::{BranchKind, BranchOptions, BranchPlan, TextModel, TextSubject};
use twinslip_tasks::views;

/// What the rows of one number make up.
pub const BRANCHES: [&str; 2] = ["branch", "branches"];

pub fn run(options: &BranchOptions, call: &Call) -> Result<Ending> {
    if !options.by_shares()? {
        if let Some(model) = TextModel::of(
            &options.reference()?,
            &[options.along.as_deref().unwrap_or("driving")],
        )? {
            let orbits = options.of.as_deref() == Some("orbits");
            let subject = TextSubject::new(model, &options.search, orbits)?;
            return general::branch(options, &subject, call);
        }
        if let Some(subject) = options.any_parameter()? {
            return general::branch(options, &subject, call);
        }
    }
    options.search.unused()?;
    let plan = BranchPlan::new(options)?;
    let branches = SlabCurves {
        whole: BRANCHES,
        nothing: "no branch of orbits enters the range: none begins at a Hopf point along the parameter; `orbit` at a value in the range searches for others",
        system: &plan.system,
        slab: &plan.request.slab,
        watch: &plan.request.watch,
        second: plan.following.second,
        numerics: &plan.numerics,
        explain: &|| plan.explain(),
        files: (options.resume.as_ref(), options.plot.as_ref()),
        output: &options.output,
        call,
    };
    let (along, slab) = (&plan.along, &plan.request.slab);
    branches.follow(
        views::branch_columns(plan.of == BranchKind::Orbits, plan.system.interfaces),
        |known, seen| plan.follow(known, seen),
        |rows: &[BranchRow], special| match plan.system.interfaces > 2 {
            true => views::staircase(rows, along, slab, &plan.system),
            false => views::branches(rows, special, along, slab, &plan.system),
        },
    )
}
