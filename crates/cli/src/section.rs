//! `twinslip section`.

use super::call::Call;
use super::report::{self, Report, unit_names};
use super::stream::StreamOut;
use super::words::{count, flagged, several, time};
use super::{Ending, written};
use serde_json::{Map, Value, json};
use std::io::Write;
use std::path::Path;
use twinslip::error::Result;
use twinslip::number::Uncertain;
use twinslip::number::polynomial::Crossing;
use twinslip::section::Regime;
use twinslip_output::{Cell, Format, RowList, plot};
use twinslip_tasks::scene::{
    CheckedExponents, Described, Quantity, SectionOptions, SectionOutcome, SectionPlan, Units,
    explain_section, run_section, section_columns,
};
use twinslip_tasks::views;

pub fn run(options: &SectionOptions, call: &Call) -> Result<Ending> {
    let plan = SectionPlan::new(options)?;
    if let Some(path) = &options.plot {
        plot::PictureFormat::of(path)?;
    }
    let others: Vec<&Path> = options.plot.as_deref().into_iter().collect();
    let report = Report::new(&options.output, call, &others)?;
    if options.output.explain {
        call.say(explain_section(&plan).trim_end());
    }
    let units = plan.system.units();
    let remarks = report.remarks(&plan.system, &numerics(&plan));
    let kept = options.plot.is_some() || report.repeats();
    let columns = views::names(&section_columns(&plan.system), false);
    let mut out = match StreamOut::new(&report, remarks, (columns, units), kept) {
        Ok(out) => out.counting(),
        Err(error) => return written(Err(error), &report.place),
    };
    call.watch();
    let outcome = run_section(&plan, &mut out)?;
    call.unwatch();
    let seconds = out.progress.finish().as_secs_f64();
    let StreamOut { rows, broken, .. } = out;
    if let Some(error) = broken {
        return written(Err(error), &report.place);
    }
    // Those that were handed on need not be there twice.
    let handed_on = RowList::default();
    let listed = if report.repeats() { &rows } else { &handed_on };
    let ending = write(&plan, &report, listed, &outcome)?;
    if let Some(path) = &options.plot {
        match views::picture_of_section(&plan, &rows) {
            Some(picture) => report.draw(path, &picture)?,
            None => report.say("there are too few returns to draw"),
        }
    }
    report.say(summary(units, &outcome, seconds));
    report.ended(match outcome.failure {
        Some(error) => Err(error),
        None if call.stops() => Ok(Ending::Interrupted),
        None if ending == Ending::Done && outcome.regime == Regime::Undecided => {
            let why = outcome.note.as_deref();
            let why = why.unwrap_or("the returns do not decide; record more, or skip more");
            Ok(report.undecided(format_args!("the regime: {why}")))
        }
        None => Ok(ending),
    })
}

fn numerics(plan: &SectionPlan) -> Value {
    let units = plan.system.units();
    let value = plan.outward_value();
    let mut numerics = json!({
        "method": plan.method.name(),
        "asked": plan.asked_method,
        "rtol": plan.tolerances.rtol,
        "atol": plan.told_atol(),
        "max_step": units.max_step(plan.tolerances),
        "max_steps": plan.max_steps,
        "dimension": plan.start.len(),
        "surface": format!("{}={value}", plan.state_name()),
        "upwards": plan.direction == Crossing::Upwards,
        "skip": plan.skip,
        "returns": plan.returns,
        "patience": units.outward(Quantity::Time, plan.patience),
    });
    if plan.system.quantity(plan.state) == Quantity::Stress {
        numerics["surface_stress"] = json!(value);
    }
    numerics
}

/// The object, or in a table the verdict after the rows.
fn write(
    plan: &SectionPlan,
    report: &Report<'_>,
    rows: &RowList,
    outcome: &SectionOutcome,
) -> Result<Ending> {
    let units = plan.system.units();
    if report.format == Format::Json {
        let bytes = report.envelope(
            &plan.system,
            numerics(plan),
            result(units, plan.lyapunov, rows, outcome),
            report::work(&outcome.work),
            outcome.failure.as_ref(),
        );
        return report.write(&bytes);
    }
    if report.format == Format::Csv || report.place.path().is_some() {
        return Ok(Ending::Done);
    }
    let mut columns = vec!["regime".to_owned(), "period_of_orbit".to_owned()];
    let q = outcome.period_of_orbit.map(|q| Cell::Text(q.to_string()));
    let mut cells = vec![
        Cell::from(outcome.regime.name()),
        q.unwrap_or(Cell::Missing),
    ];
    let mut quantities = vec![Quantity::Number; 2];
    let mut add = |name: &str, quantity, x: Option<Uncertain>| {
        let x = x.map(|x| units.outward_uncertain(quantity, x));
        columns.extend([name.to_owned(), "±".to_owned()]);
        cells.extend([x.map(|x| x.value).into(), x.map(|x| x.uncertainty).into()]);
        quantities.extend([quantity; 2]);
    };
    add("rotation_number", Quantity::Number, outcome.rotation_number);
    for (i, x) in outcome
        .lyapunov
        .iter()
        .flat_map(|l| &l.exponents)
        .enumerate()
    {
        add(&format!("lyapunov_{}", i + 1), Quantity::Growth, Some(*x));
    }
    let units = unit_names(units, quantities.into_iter());
    let mut to = report.place.stream()?;
    let all = writeln!(to)
        .and_then(|()| report.rows(to, &[], &columns, &units))
        .and_then(|mut writer| writer.row(&cells));
    written(all, &report.place)
}

/// What the object holds.
#[derive(serde::Serialize)]
struct SectionResult<'a> {
    rows: &'a RowList,
    #[serde(flatten)]
    verdict: Map<String, Value>,
}

fn result<'a>(
    units: &Units,
    lyapunov: bool,
    rows: &'a RowList,
    outcome: &SectionOutcome,
) -> SectionResult<'a> {
    let uncertain = |quantity, x: Option<Uncertain>| {
        x.map_or(Value::Null, |x| report::uncertain(units, quantity, x))
    };
    let mut verdict = Map::new();
    let mut put = |name: &str, value: Value| verdict.insert(name.to_owned(), value);
    put("regime", json!(outcome.regime.name()));
    put("period_of_orbit", json!(outcome.period_of_orbit));
    put("period", uncertain(Quantity::Time, outcome.period));
    put(
        "rotation_number",
        uncertain(Quantity::Number, outcome.rotation_number),
    );
    put("curves", json!(outcome.curves));
    if lyapunov {
        let found = outcome.lyapunov.as_ref();
        let list = |found: &CheckedExponents| -> Value {
            let list = found.exponents.iter();
            list.map(|x| report::uncertain(units, Quantity::Growth, *x))
                .collect()
        };
        let rate = |x: f64| units.outward(Quantity::Growth, x);
        put("lyapunov", found.map_or(Value::Null, list));
        put("lyapunov_converged", json!(found.map(|x| x.converged)));
        let along_flow = found.and_then(|x| x.along_flow).map(rate);
        put("lyapunov_along_flow", json!(along_flow));
        let defect = found.and_then(|x| x.liouville_defect).map(rate);
        put("liouville_defect", json!(defect));
    }
    put("note", json!(outcome.note.as_deref().map(flagged)));
    SectionResult { rows, verdict }
}

/// What was found, and at which cost.
fn summary(units: &Units, outcome: &SectionOutcome, seconds: f64) -> String {
    let work = &outcome.work;
    let mut text = format!(
        "{} steps ({} rejected), {} evaluations of f, {}, {}: {}",
        count(work.steps),
        count(work.rejected),
        count(work.rhs),
        time(seconds),
        several(outcome.returns, "return", "returns"),
        outcome.regime.name()
    );
    if let Some(q) = outcome.period_of_orbit {
        text.push_str(&format!(", period {q}"));
    }
    if let Some(rotation) = outcome.rotation_number {
        text.push_str(&format!(", rotation number {rotation}"));
    }
    let exponents = outcome.lyapunov.iter().flat_map(|found| &found.exponents);
    let exponents: Vec<String> = exponents
        .map(|x| units.outward_uncertain(Quantity::Growth, *x).to_string())
        .collect();
    if !exponents.is_empty() {
        text.push_str(&format!(", exponents {}", exponents.join(", ")));
    }
    if outcome
        .lyapunov
        .as_ref()
        .is_some_and(|found| !found.converged)
    {
        text.push_str(", not converged");
    }
    if let Some(note) = &outcome.note {
        text.push_str(&format!("; {note}"));
    }
    text
}
