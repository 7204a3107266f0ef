//! `twinslip orbit --system`.

use crate::cli::orbit::{logarithm, multipliers, summary};
use crate::cli::report::{self, Report};
use crate::cli::{Ending, progress, say, written};
use crate::equilibrium::Verdict;
use crate::error::Result;
use crate::orbit::{Crosscheck, FoundOrbit, Orbit};
use crate::output::{self, Format};
use crate::scene::{Described, OrbitOptions, TextModel, TextOrbitPlan};
use crate::views;
use serde_json::{Map, Value, json};

pub fn run(options: &OrbitOptions, model: TextModel, words: &[String]) -> Result<Ending> {
    let plan = TextOrbitPlan::new(options, model)?;
    let report = Report::new(&options.output, words, &[])?;
    if options.output.explain {
        say(plan.explain());
    }
    let FoundOrbit { orbit, others } =
        progress::during(report.quiet, "looking for the orbit", || plan.find())?;
    let second = plan.second.map_or("", |second| second.method.name());
    let words = format!("once more, by {second}");
    let checked = progress::during(report.quiet, &words, || plan.crosscheck(&orbit));
    let checked = checked.unwrap_or_else(|error| {
        report.say(format!("the crosscheck by {second} failed: {error}"));
        None
    });
    let ending = write(&plan, &report, &orbit, &others, checked.as_ref())?;
    report.say(summary(&orbit, checked.as_ref(), plan.model.units()));
    if ending == Ending::Done && orbit.verdict() == Verdict::Undecided {
        return Ok(Ending::Undecided);
    }
    Ok(ending)
}

fn write(
    plan: &TextOrbitPlan,
    report: &Report<'_>,
    orbit: &Orbit,
    others: &[Orbit],
    checked: Option<&Crosscheck>,
) -> Result<Ending> {
    let numerics = json!({
        "method": orbit.method,
        "rtol": plan.accuracy.tolerances.rtol,
        "atol": plan.accuracy.tolerances.atol,
        "max_steps": plan.accuracy.max_steps,
        "crosscheck": plan.second.map(|second| second.method.name()),
    });
    let model = &plan.model;
    if report.format == Format::Json {
        let mut main = object(orbit, model);
        main["crosscheck"] = checked.map_or(Value::Null, |checked| comparison(checked, model));
        let rest: Vec<Value> = others.iter().map(|other| object(other, model)).collect();
        let result = json!({"orbit": main, "others": rest});
        let mut work = report::work(&orbit.work);
        work["nodes"] = json!(orbit.nodes.len());
        work["iterations"] = json!(orbit.iterations);
        let bytes = report.envelope(model, numerics, result, work, None);
        return written(report.place.write(&bytes), &report.place);
    }
    report.write_all(
        model.units(),
        report.remarks(model, &numerics),
        &views::text_orbit_columns(model),
        std::iter::once(orbit).chain(others),
    )
}

fn object(orbit: &Orbit, model: &TextModel) -> Value {
    let uncertain = |x: crate::number::Uncertain| output::uncertain((x.value, x.uncertainty));
    let states = || model.system.states().iter();
    let extremes: Map<String, Value> = states()
        .zip(&orbit.extremes)
        .map(|(name, [least, most])| {
            let ends = json!({"min": uncertain(*least), "max": uncertain(*most)});
            ((*name).to_owned(), ends)
        })
        .collect();
    let logs: Vec<Value> = orbit.floquet.multipliers.iter().map(logarithm).collect();
    json!({
        "period": uncertain(orbit.period),
        "point": orbit.point,
        "point_uncertainty": orbit.point_uncertainty,
        "extremes": extremes,
        "multipliers": multipliers(orbit),
        "log_multipliers": logs,
        "trivial_defect": orbit.floquet.trivial_defect,
        "liouville_defect": orbit.floquet.liouville_defect,
        "verdict": orbit.verdict().name(),
        "method": orbit.method,
    })
}

fn comparison(checked: &Crosscheck, model: &TextModel) -> Value {
    let second = object(&checked.orbit, model);
    json!({
        "method": checked.orbit.method,
        "period_difference": checked.period_difference,
        "ln_abs_difference": checked.ln_abs_difference,
        "period": second["period"],
        "log_multipliers": second["log_multipliers"],
        "verdict": second["verdict"],
        "steps": checked.orbit.work.steps,
    })
}
