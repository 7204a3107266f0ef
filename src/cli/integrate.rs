//! `twinslip integrate`.

use super::interrupt;
use super::report::{self, Report, unit_names};
use super::stream::StreamOut;
use super::text;
use super::words::{count, several, time};
use super::{Ending, say, written};
use crate::error::{Error, Result};
use crate::integrate::Work;
use crate::output::{Format, Place, RowList, object, plot};
use crate::scene::{
    Change, IntegrateOptions, Keeping, Plan, Program, RunOutcome, TextModel, explain,
};
use crate::views;
use serde_json::{Map, Value, json};
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

pub fn run(options: &IntegrateOptions, words: &[String]) -> Result<Ending> {
    // A program may say itself which V_H is the first.
    let free: &[&str] = if options.program.is_some() {
        &["driving"]
    } else {
        &[]
    };
    if let Some(model) = TextModel::of(&options.model, free)? {
        return text::integrate::run(options, model, words);
    }
    let plan = Plan::new(options)?;
    if let Some(path) = &options.plot {
        plot::PictureFormat::of(path)?;
    }
    let events = events_place(options)?;
    let events_path = events.as_ref().map(|(path, _)| path.as_path());
    let others: Vec<&Path> = [options.plot.as_deref(), events_path]
        .into_iter()
        .flatten()
        .collect();
    let report = Report::new(&options.output, words, &others)?;
    let kept = report.format == Format::Json;
    if options.output.explain {
        let keeping = if kept {
            Keeping::Stored
        } else {
            Keeping::Streamed
        };
        say(explain(&plan, keeping).trim_end());
    }
    let columns = views::names(&plan.columns, false);
    let pictured = views::names(&plan.pictured(), false);
    let numbers = numerics(&plan);
    let remarks = report.remarks(&plan.system, &numbers);
    let columns = (columns, &plan.system.units);
    let mut out = match StreamOut::new(&report, remarks, columns, kept) {
        Ok(out) => out.drawing(pictured.into_iter().map(|(name, _)| name).collect()),
        Err(error) => return written(Err(error), &report.place),
    };
    if plan.observed() {
        interrupt::watch();
    }
    let outcome = crate::scene::run(&plan, &mut out)?;
    interrupt::unwatch();
    let seconds = out.progress.finish().as_secs_f64();
    let StreamOut {
        rows,
        drawn,
        broken,
        ..
    } = out;
    if let Some(error) = broken {
        return written(Err(error), &report.place);
    }
    let ending = write(&plan, &report, &rows, &outcome, events.as_ref())?;
    if let Some(path) = &options.plot {
        plot::write(path, &views::picture_of_run(&plan, &drawn))?;
    }
    report.say(summary(&outcome, plan.events.is_some(), seconds));
    report.ended(match outcome.failure {
        Some(error) => Err(error),
        None if interrupt::asked() => Ok(Ending::Interrupted),
        None => Ok(ending),
    })
}

fn numerics(plan: &Plan) -> Value {
    json!({
        "method": plan.method.name(),
        "asked": plan.asked_method,
        "rtol": plan.tolerances.rtol,
        "atol": plan.tolerances.atol,
        "max_steps": plan.max_steps,
        "dimension": plan.dimension.number(),
    })
}

/// The file of the events table: the one that is named, or one beside the file of the rows; `None` where events are in the
/// object, or below the table on the standard output.
///
/// # Errors
/// [`Error::Input`] where events would stand below the rows of one CSV, and where a file is named for those of an object.
fn events_place(options: &IntegrateOptions) -> Result<Option<(PathBuf, Format)>> {
    let Some(named) = &options.events else {
        return Ok(None);
    };
    let named = Some(named.clone()).filter(|path| !path.as_os_str().is_empty());
    let output = &options.output;
    let file = output
        .output
        .as_deref()
        .filter(|path| *path != Path::new("-"));
    let terminal = std::io::stdout().is_terminal();
    let format = Format::choose(output.format.as_deref(), file, terminal)?;
    match (format, named, file) {
        (Format::Json, Some(named), _) => Err(Error::Input(format!(
            "--events {}: a JSON object holds its events itself; leave the file out",
            named.display()
        ))),
        (Format::Json, None, _) | (Format::Table, None, None) => Ok(None),
        (_, Some(named), _) => Ok(Some((named, Format::Csv))),
        (Format::Csv, None, None) => Err(Error::Input(
            "--events needs a file of its own where rows go to standard output as CSV: --events FILE, or -o FILE, --format json or --format table"
                .into(),
        )),
        (_, None, Some(file)) => {
            let mut name = file.file_stem().unwrap_or_default().to_owned();
            name.push(".events.");
            name.push(file.extension().unwrap_or("csv".as_ref()));
            Ok(Some((file.with_file_name(name), format)))
        }
    }
}

/// The object, or the events after the rows.
fn write(
    plan: &Plan,
    report: &Report<'_>,
    rows: &RowList,
    outcome: &RunOutcome,
    events: Option<&(PathBuf, Format)>,
) -> Result<Ending> {
    if report.format == Format::Json {
        let bytes = report.envelope(
            &plan.system,
            numerics(plan),
            result(plan, rows, outcome),
            report::work(&outcome.work),
            outcome.failure.as_ref(),
        );
        return written(report.place.write(&bytes), &report.place);
    }
    if plan.events.is_none() {
        return Ok(Ending::Done);
    }
    let place = Place::new(events.map(|(path, _)| path.as_path()));
    let mut to = place.stream()?;
    let mut remarks = Vec::new();
    let begun = if events.is_some() {
        remarks = report.remarks(&plan.system, &numerics(plan));
        Ok(())
    } else {
        writeln!(to)
    };
    let (columns, units) = (
        views::event_columns(plan.system.interfaces),
        &plan.system.units,
    );
    let (names, quantities): (Vec<_>, Vec<_>) = views::names(&columns, false).into_iter().unzip();
    let unit_names = unit_names(units, quantities.into_iter());
    let format = events.map_or(report.format, |(_, format)| *format);
    let all = begun
        .and_then(|()| report.rows_as(format, to, &remarks, &names, &unit_names))
        .and_then(|mut writer| {
            let mut events = outcome.events.iter();
            events.try_for_each(|event| writer.row(&views::cells(&columns, event, units, false)))
        });
    written(all, &place)
}

/// What the object holds.
#[derive(serde::Serialize)]
struct IntegrationResult<'a> {
    rows: &'a RowList,
    #[serde(rename = "final")]
    last: Option<Map<String, Value>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    program: Option<Vec<Value>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    events: Option<Vec<Map<String, Value>>>,
}

fn result<'a>(plan: &Plan, rows: &'a RowList, outcome: &RunOutcome) -> IntegrationResult<'a> {
    let last = outcome.last.as_ref().map(|row| {
        let mut last = object(&rows.columns, row);
        last.insert("error_estimate".into(), json!(outcome.error_estimate));
        last
    });
    let events = plan.events.is_some().then(|| {
        let columns = views::event_columns(plan.system.interfaces);
        let object = |event| views::object(&columns, event, &plan.system.units);
        outcome.events.iter().map(object).collect()
    });
    IntegrationResult {
        rows,
        last,
        program: plan.program.as_ref().map(changes),
        events,
    }
}

/// The changes of V_H, as they were given.
pub fn changes(program: &Program) -> Vec<Value> {
    let one = |change: &Change| json!({"time": change.time, "until": change.until, "driving": change.driving});
    program.changes.iter().map(one).collect()
}

fn summary(outcome: &RunOutcome, events: bool, seconds: f64) -> String {
    let estimate = (outcome.error_estimate, outcome.estimate_failure.as_ref());
    let events = events.then_some(outcome.events.len());
    summary_of(&outcome.work, events, estimate, seconds)
}

/// What a run has cost, how many events there were where they are asked for, and its error or why that is not known.
pub fn summary_of(
    work: &Work,
    events: Option<usize>,
    (estimate, failure): (Option<f64>, Option<&Error>),
    seconds: f64,
) -> String {
    let mut text = format!(
        "{} steps ({} rejected), {} evaluations of f, {} Jacobians, {}",
        count(work.steps),
        count(work.rejected),
        count(work.rhs),
        count(work.jacobians),
        time(seconds)
    );
    if let Some(events) = events {
        let events = several(events, "event", "events");
        text.push_str(&format!(", {events}"));
    }
    if let Some(estimate) = estimate {
        text.push_str(&format!(", error estimate {estimate:.1e}"));
    }
    if let Some(error) = failure {
        text.push_str(&format!(", no error estimate: {error}"));
    }
    text
}
