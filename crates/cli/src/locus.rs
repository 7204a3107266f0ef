//! `twinslip locus`.

use super::call::Call;
use super::slab::SlabCurves;
use super::{Ending, general};
use twinslip::bifurcation::LocusRow;
use twinslip::error::Result;
use twinslip_tasks::scene::{
    CurveChoice, Described, LocusOptions, LocusPlan, TextModel, TextSubject, plane,
};
use twinslip_tasks::views;

/// What the rows of one number make up.
pub const CURVES: [&str; 2] = ["curve", "curves"];

pub fn run(options: &LocusOptions, call: &Call) -> Result<Ending> {
    let (options, begin) = options.beginning()?;
    let options = &*options;
    if !options.by_shares()? {
        if let Some(model) = TextModel::of(
            &options.reference()?,
            &plane(options.plane.as_deref().unwrap_or("driving,stiffness"))?,
        )? {
            let (search, orbits) = match &begin {
                None => (
                    options.search.clone(),
                    CurveChoice::named(options.of.as_deref())?.of_orbits(),
                ),
                Some(begin) => (
                    begin.search(&model, options.search.turns),
                    begin.of_orbits(),
                ),
            };
            let subject = TextSubject::new(model, &search, orbits)?;
            return general::locus(options, begin, &subject, call);
        }
        if let Some(subject) = options.any_parameter()? {
            return general::locus(options, begin, &subject, call);
        }
    }
    options.search.unused()?;
    let plan = LocusPlan::new(options)?;
    let nothing = format!(
        "no {} bifurcation is found in these ranges; give others by `driving_range` and `stiffness_range`, or other constants of the law",
        plan.curve.name
    );
    let curves = SlabCurves {
        whole: CURVES,
        nothing: &nothing,
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
    curves.follow(
        views::locus_columns(plan.system.interfaces),
        |known, seen| plan.follow(known, seen),
        |rows: &[LocusRow], special| {
            views::curves(rows, special, plan.curve.title, plan.system.units())
        },
    )
}
