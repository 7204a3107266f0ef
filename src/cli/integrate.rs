//! `twinslip integrate`.

use super::interrupt;
use super::report::{self, Report, unit_names};
use super::stream::StreamOut;
use super::words::{count, several, time};
use super::{Ending, say, written};
use crate::error::{Error, Result};
use crate::output::{Format, Place, RowList, object, plot};
use crate::scene::{
    Change, Described, IntegrateOptions, Keeping, ManyPlan, Plan, Program, Quantity, RunOutcome,
    TextModel, TextPlan, explain,
};
use crate::views;
use serde_json::{Map, Value, json};
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

/// A run that is planned, of interfaces or of a system of one's own.
pub trait PlannedRun {
    /// The plan in words.
    fn explain(&self, keeping: Keeping) -> String;
    /// What is integrated.
    fn system(&self) -> &dyn Described;
    /// How it is integrated.
    fn numerics(&self) -> Value;
    /// The columns of rows.
    fn columns(&self) -> Vec<(String, Quantity)>;
    /// The columns of the points of a picture.
    fn pictured(&self) -> Vec<(String, Quantity)>;
    /// Of how many interfaces there are events; `None` where they are not asked for.
    fn interfaces_of_events(&self) -> Option<usize> {
        None
    }
    /// How V_H changes on the way, where it does.
    fn program(&self) -> Option<&Program>;
    /// The states whose errors are estimated each.
    fn states(&self) -> &[&'static str] {
        &[]
    }
    /// Whether anything is seen between start and end.
    fn observed(&self) -> bool;
    /// Goes along it.
    fn run(&self, out: &mut StreamOut) -> Result<RunOutcome>;
    /// The picture of these points.
    fn picture(&self, drawn: &RowList) -> plot::Drawing;
}

pub fn run(options: &IntegrateOptions, words: &[String]) -> Result<Ending> {
    if ManyPlan::is_of(options) {
        return super::many::run(options, words);
    }
    // A program may say itself which V_H is the first.
    let free: &[&str] = if options.program.is_some() {
        &["driving"]
    } else {
        &[]
    };
    match TextModel::of(&options.model, free)? {
        Some(model) => integrate(&TextPlan::new(options, model)?, options, words),
        None => integrate(&Plan::new(options)?, options, words),
    }
}

impl PlannedRun for Plan {
    fn explain(&self, keeping: Keeping) -> String {
        explain(self, keeping)
    }

    fn system(&self) -> &dyn Described {
        &self.system
    }

    fn numerics(&self) -> Value {
        json!({
            "method": self.method.name(),
            "asked": self.asked_method,
            "rtol": self.tolerances.rtol,
            "atol": self.tolerances.atol,
            "max_steps": self.max_steps,
            "dimension": self.dimension.number(),
        })
    }

    fn columns(&self) -> Vec<(String, Quantity)> {
        views::names(&self.columns, false)
    }

    fn pictured(&self) -> Vec<(String, Quantity)> {
        views::names(&self.pictured(), false)
    }

    fn interfaces_of_events(&self) -> Option<usize> {
        self.events.map(|_| self.system.interfaces)
    }

    fn program(&self) -> Option<&Program> {
        self.program.as_ref()
    }

    fn observed(&self) -> bool {
        self.observed()
    }

    fn run(&self, out: &mut StreamOut) -> Result<RunOutcome> {
        crate::scene::run(self, out)
    }

    fn picture(&self, drawn: &RowList) -> plot::Drawing {
        views::picture_of_run(self, drawn)
    }
}

pub fn integrate(
    plan: &impl PlannedRun,
    options: &IntegrateOptions,
    words: &[String],
) -> Result<Ending> {
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
        say(plan.explain(keeping).trim_end());
    }
    let remarks = report.remarks(plan.system(), &plan.numerics());
    let columns = (plan.columns(), plan.system().units());
    let mut out = match StreamOut::new(&report, remarks, columns, kept) {
        Ok(out) => out.drawing(plan.pictured()),
        Err(error) => return written(Err(error), &report.place),
    };
    if plan.observed() {
        interrupt::watch();
    }
    let outcome = plan.run(&mut out)?;
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
    let ending = write(plan, &report, &rows, &outcome, events.as_ref())?;
    if let Some(path) = &options.plot {
        plot::write(path, &plan.picture(&drawn))?;
    }
    let events = plan.interfaces_of_events().map(|_| outcome.events.len());
    report.say(summary(&outcome, events, seconds));
    report.ended(match outcome.failure {
        Some(error) => Err(error),
        None if interrupt::asked() => Ok(Ending::Interrupted),
        None => Ok(ending),
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
    plan: &impl PlannedRun,
    report: &Report<'_>,
    rows: &RowList,
    outcome: &RunOutcome,
    events: Option<&(PathBuf, Format)>,
) -> Result<Ending> {
    if report.format == Format::Json {
        let bytes = report.envelope(
            plan.system(),
            plan.numerics(),
            result(plan, rows, outcome),
            report::work(&outcome.work),
            outcome.failure.as_ref(),
        );
        return written(report.place.write(&bytes), &report.place);
    }
    let Some(interfaces) = plan.interfaces_of_events() else {
        return Ok(Ending::Done);
    };
    let place = Place::new(events.map(|(path, _)| path.as_path()));
    let mut to = place.stream()?;
    let mut remarks = Vec::new();
    let begun = if events.is_some() {
        remarks = report.remarks(plan.system(), &plan.numerics());
        Ok(())
    } else {
        writeln!(to)
    };
    let (columns, units) = (views::event_columns(interfaces), plan.system().units());
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

fn result<'a>(
    plan: &impl PlannedRun,
    rows: &'a RowList,
    outcome: &RunOutcome,
) -> IntegrationResult<'a> {
    let last = outcome.last.as_ref().map(|row| {
        let mut last = object(&rows.columns, row);
        last.insert("error_estimate".into(), json!(outcome.error_estimate));
        let states = plan.states().iter();
        for (state, error) in states.zip(outcome.errors.iter().flatten()) {
            last.insert(format!("{state}_uncertainty"), json!(error));
        }
        last
    });
    let events = plan.interfaces_of_events().map(|interfaces| {
        let columns = views::event_columns(interfaces);
        let object = |event| views::object(&columns, event, plan.system().units());
        outcome.events.iter().map(object).collect()
    });
    IntegrationResult {
        rows,
        last,
        program: plan.program().map(changes),
        events,
    }
}

/// The changes of V_H, as they were given.
fn changes(program: &Program) -> Vec<Value> {
    let one = |change: &Change| json!({"time": change.time, "until": change.until, "driving": change.driving});
    program.changes.iter().map(one).collect()
}

/// What a run has cost, how many events there were where they are asked for, and its error or why that is not known.
fn summary(outcome: &RunOutcome, events: Option<usize>, seconds: f64) -> String {
    let work = &outcome.work;
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
    if let Some(estimate) = outcome.error_estimate {
        text.push_str(&format!(", error estimate {estimate:.1e}"));
    }
    if let Some(error) = &outcome.estimate_failure {
        text.push_str(&format!(", no error estimate: {error}"));
    }
    text
}
