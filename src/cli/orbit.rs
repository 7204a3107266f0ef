//! `twinslip orbit`.

use super::report::{self, Report};
use super::stream::StreamOut;
use super::text;
use super::words::several;
use super::{Ending, progress, say, written};
use crate::equilibrium::Verdict;
use crate::error::Result;
use crate::number::Uncertain;
use crate::orbit::{Crosscheck, FoundOrbit, Kind, Multiplier, Orbit};
use crate::output::{self, Format, RowList, plot};
use crate::scene::{OrbitOptions, OrbitPlan, Quantity, System, TextModel, Units};
use crate::views;
use serde_json::{Value, json};
use std::path::Path;

pub fn run(options: &OrbitOptions, words: &[String]) -> Result<Ending> {
    if let Some(model) = TextModel::of(&options.model, &[])? {
        return text::orbit::run(options, model, words);
    }
    let plan = OrbitPlan::new(options)?;
    let picture = options.plot.as_deref();
    picture.map(plot::PictureFormat::of).transpose()?;
    let others: Vec<&Path> = picture.into_iter().collect();
    let report = Report::new(&options.output, words, &others)?;
    if options.output.explain {
        say(plan.explain());
    }
    let FoundOrbit { orbit, others } =
        progress::during(report.quiet, "looking for the orbit", || plan.find())?;
    // Only the object tells of the second opinion: rows need not wait for it.
    let in_rows = report.format != Format::Json;
    let mut ending = Ending::Done;
    if in_rows && plan.rows.is_none() {
        ending = write_orbits(&plan, &report, &orbit, &others)?;
    }
    let rows = along(&plan, &report, &orbit, picture)?;
    let second = plan.second.map_or("", |second| second.method.name());
    let words = format!("once more, by {second}");
    let checked = progress::during(report.quiet, &words, || plan.crosscheck(&orbit));
    let checked = checked.unwrap_or_else(|error| {
        report.say(format!("the crosscheck by {second} failed: {error}"));
        None
    });
    if !in_rows {
        let result = result(&plan, &orbit, &others, checked.as_ref(), rows.as_ref());
        ending = write_object(&plan, &report, &orbit, result)?;
    }
    report.say(summary(&orbit, checked.as_ref(), &plan.system.units));
    if ending == Ending::Done && orbit.verdict() == Verdict::Undecided {
        return Ok(Ending::Undecided);
    }
    Ok(ending)
}

/// What was found, and at which cost.
pub fn summary(orbit: &Orbit, checked: Option<&Crosscheck>, units: &Units) -> String {
    let unit = match units.name(Quantity::Time) {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let period = units.outward_uncertain(Quantity::Time, orbit.period);
    let mut text = format!(
        "period ({period}){unit}, {}; {}, {}, {}",
        orbit.verdict().name(),
        several(orbit.nodes.len(), "node", "nodes"),
        several(orbit.iterations, "iteration", "iterations"),
        several(orbit.work.steps, "step", "steps")
    );
    if let Some(Crosscheck {
        orbit: second,
        period_difference,
        ..
    }) = checked
    {
        let relative = period_difference / orbit.period.value;
        text += &format!(
            "; the period by {} differs by {relative:.1e} of it",
            second.method
        );
    }
    text
}

/// Goes along the orbit for the rows and the picture that are asked for, and gives the rows; none where nobody asks for them, or reads
/// them.
fn along(
    plan: &OrbitPlan,
    report: &Report<'_>,
    orbit: &Orbit,
    picture: Option<&Path>,
) -> Result<Option<RowList>> {
    let Some(run) = plan.along(orbit) else {
        return Ok(None);
    };
    let columns = views::names(&run.columns, false);
    let out = if plan.rows.is_some() {
        let mut remarks = report.remarks(&plan.system, &numerics(plan, orbit));
        remarks.push(format!(
            "orbit: {}",
            summary(orbit, None, &plan.system.units)
        ));
        let columns = (columns, &plan.system.units);
        StreamOut::new(report, remarks, columns, false)
    } else {
        Ok(StreamOut::kept(report, columns))
    };
    let mut out = match out {
        Ok(out) => {
            let pictured = views::names(&run.pictured(), false).into_iter();
            out.drawing(pictured.map(|(name, _)| name).collect())
        }
        Err(error) => return written(Err(error), &report.place).map(|_| None),
    };
    let outcome = crate::scene::run(&run, &mut out)?;
    out.progress.finish();
    if let Some(error) = out.broken {
        return written(Err(error), &report.place).map(|_| None);
    }
    if let Some(path) = picture {
        plot::write(path, &views::picture_of_run(&run, &out.drawn))?;
    }
    if plan.rows.is_none() {
        return outcome.failure.map_or(Ok(None), Err);
    }
    report.ended(outcome.failure.map_or(Ok(Ending::Done), Err))?;
    Ok(Some(out.rows))
}

fn numerics(plan: &OrbitPlan, orbit: &Orbit) -> Value {
    json!({
        "method": orbit.method,
        "rtol": plan.accuracy.tolerances.rtol,
        "atol": plan.accuracy.tolerances.atol,
        "max_steps": plan.accuracy.max_steps,
        "crosscheck": plan.second.map(|second| second.method.name()),
    })
}

/// What the object holds.
fn result(
    plan: &OrbitPlan,
    orbit: &Orbit,
    others: &[Orbit],
    checked: Option<&Crosscheck>,
    rows: Option<&RowList>,
) -> Value {
    let system = &plan.system;
    let mut main = object(orbit, system);
    main["crosscheck"] = checked.map_or(Value::Null, |checked| comparison(checked, system));
    let rest: Vec<Value> = others.iter().map(|other| object(other, system)).collect();
    let mut result = json!({"orbit": main, "others": rest});
    if let Some(rows) = rows {
        result["rows"] = json!(rows);
    }
    result
}

fn write_object(
    plan: &OrbitPlan,
    report: &Report<'_>,
    orbit: &Orbit,
    result: Value,
) -> Result<Ending> {
    let mut work = report::work(&orbit.work);
    work["nodes"] = json!(orbit.nodes.len());
    work["iterations"] = json!(orbit.iterations);
    let bytes = report.envelope(&plan.system, numerics(plan, orbit), result, work, None);
    written(report.place.write(&bytes), &report.place)
}

/// A row for each orbit.
fn write_orbits(
    plan: &OrbitPlan,
    report: &Report<'_>,
    orbit: &Orbit,
    others: &[Orbit],
) -> Result<Ending> {
    let system = &plan.system;
    report.write_all(
        &system.units,
        report.remarks(system, &numerics(plan, orbit)),
        &views::orbit_columns(system.interfaces),
        std::iter::once(orbit).chain(others),
    )
}

/// tau and ln psi of each interface in the user's units.
fn outward_point(orbit: &Orbit, system: &System) -> Vec<f64> {
    let quantity = |i| {
        if i == 0 {
            Quantity::Stress
        } else {
            Quantity::LogState
        }
    };
    let point = orbit.point.iter().enumerate();
    let mut point: Vec<f64> = point
        .map(|(i, &x)| system.units.outward(quantity(i), x))
        .collect();
    // Where both interfaces move alike they share a state.
    while point.len() < system.interfaces + 1 {
        point.push(point[1]);
    }
    point
}

fn object(orbit: &Orbit, system: &System) -> Value {
    let units = &system.units;
    let logs: Vec<Value> = orbit.floquet.multipliers.iter().map(logarithm).collect();
    json!({
        "symmetry": orbit.symmetry.name(),
        "period": report::uncertain(units, Quantity::Time, orbit.period),
        "point": outward_point(orbit, system),
        "point_uncertainty": orbit.point_uncertainty,
        "stress_min": report::uncertain(units, Quantity::Stress, orbit.stress_min),
        "stress_max": report::uncertain(units, Quantity::Stress, orbit.stress_max),
        "slip_rate_max": units.outward(Quantity::SlipRate, orbit.slip_rate_max),
        "state_min": units.outward(Quantity::State, orbit.state_min),
        "multipliers": multipliers(orbit),
        "log_multipliers": logs,
        "trivial_defect": orbit.floquet.trivial_defect,
        "liouville_defect": orbit.floquet.liouville_defect,
        "verdict": orbit.verdict().name(),
        "method": orbit.method,
    })
}

/// All multipliers, the trivial one first; of a conjugate pair the second one below the axis.
pub fn multipliers(orbit: &Orbit) -> Vec<[f64; 2]> {
    let mut multipliers = vec![[1.0, 0.0]];
    let mut above = true;
    for multiplier in &orbit.floquet.multipliers {
        let mu = multiplier.value();
        let complex = multiplier.kind == Kind::Complex;
        multipliers.push([mu.re, if complex && !above { -mu.im } else { mu.im }]);
        above = !complex || !above;
    }
    multipliers
}

/// A multiplier by its logarithm.
pub fn logarithm(multiplier: &Multiplier) -> Value {
    let Uncertain { value, uncertainty } = multiplier.ln_abs;
    let known = multiplier.kind != Kind::BelowFloor;
    json!({
        "ln_abs": known.then(|| output::uncertain((value, uncertainty))),
        "ln_abs_at_most": (!known).then_some(value),
        "angle_over_pi": multiplier.known_angle(),
        "kind": multiplier.kind.name(),
    })
}

fn comparison(checked: &Crosscheck, system: &System) -> Value {
    let second = object(&checked.orbit, system);
    let difference = system
        .units
        .outward(Quantity::Time, checked.period_difference);
    json!({
        "method": checked.orbit.method,
        "period_difference": difference,
        "ln_abs_difference": checked.ln_abs_difference,
        "period": second["period"],
        "log_multipliers": second["log_multipliers"],
        "verdict": second["verdict"],
        "steps": checked.orbit.work.steps,
    })
}
