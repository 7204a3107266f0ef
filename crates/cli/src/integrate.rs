//! `twinslip integrate`.

use super::call::Call;
use super::fault;
use super::holds;
use super::report::{self, Report, unit_names};
use super::stream::StreamOut;
use super::words::{count, several, time};
use super::{Ending, written};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use twinslip::error::{Error, Result};
use twinslip_output::{Format, Over, Place, RowList, object, plot, seven_digits};
use twinslip_tasks::scene::{
    Change, Described, FaultSummary, IntegrateOptions, Keeping, ManyPlan, OutputOptions, Plan,
    Program, Quantity, RunOutcome, explain,
};
use twinslip_tasks::views::{self, Listed, Listing};

/// A run that is planned, of a system or of many interfaces.
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
    /// The tables beside the rows.
    fn beside<'a>(&'a self, _: &'a RunOutcome) -> Beside<'a> {
        Beside::default()
    }
    /// The run of a fault in a few numbers.
    fn fault(&self, _: &RunOutcome) -> Option<FaultSummary> {
        None
    }
    /// How V_H changes on the way, where it does.
    fn program(&self) -> Option<&Program>;
    /// The states whose errors are estimated each.
    fn states(&self) -> Vec<Cow<'static, str>> {
        Vec::new()
    }
    /// Whether anything is seen between start and end.
    fn observed(&self) -> bool;
    /// Of rows of an earlier run that are gone on with, how many bytes stay.
    fn kept_bytes(&self) -> Option<u64> {
        None
    }
    /// All is written.
    fn ended(&self) {}
    /// Goes along it.
    fn run(&self, out: &mut StreamOut<'_>) -> Result<RunOutcome>;
    /// The picture of these points.
    fn picture(&self, drawn: &RowList) -> plot::Drawing;
    /// The picture of the events, of runs that have one.
    fn picture_of_events(&self, _: &RunOutcome) -> Option<plot::Drawing> {
        None
    }
}

/// Tables beside the rows of a run, those that are asked for.
#[derive(Default)]
pub struct Beside<'a> {
    /// The events.
    pub events: Option<Box<dyn Listing + 'a>>,
    /// What each interface does in them.
    pub participation: Option<Box<dyn Listing + 'a>>,
}

pub fn run(options: &IntegrateOptions, call: &Call) -> Result<Ending> {
    if ManyPlan::is_of(options) {
        return super::many::run(options, call);
    }
    if options.checkpoint.is_some() {
        return Err(Error::Input(
            "`checkpoint` works only for runs of many interfaces: 8 or more without clusters, or with `draw`".into(),
        ));
    }
    integrate(&Plan::new(options)?, options, call)
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
            "atol": self.told_atol(),
            "max_step": self.system.units().max_step(self.tolerances),
            "max_steps": self.max_steps,
            "dimension": self.start.len(),
        })
    }

    fn columns(&self) -> Vec<(String, Quantity)> {
        views::names(&self.columns, false)
    }

    fn pictured(&self) -> Vec<(String, Quantity)> {
        views::names(&self.pictured(), false)
    }

    fn beside<'a>(&'a self, outcome: &'a RunOutcome) -> Beside<'a> {
        let events = self.events.map(|_| Listed {
            columns: views::event_columns(self.system.clusters().len()),
            rows: Cow::Borrowed(&*outcome.events),
            units: self.system.units(),
        });
        Beside {
            events: events.map(|events| Box::new(events) as _),
            participation: None,
        }
    }

    fn fault(&self, outcome: &RunOutcome) -> Option<FaultSummary> {
        FaultSummary::new(self, outcome)
    }

    fn program(&self) -> Option<&Program> {
        self.program.as_ref()
    }

    fn states(&self) -> Vec<Cow<'static, str>> {
        self.system.states()
    }

    fn observed(&self) -> bool {
        self.observed()
    }

    fn run(&self, out: &mut StreamOut<'_>) -> Result<RunOutcome> {
        twinslip_tasks::scene::run(self, out)
    }

    fn picture(&self, drawn: &RowList) -> plot::Drawing {
        views::picture_of_run(self, drawn)
    }
}

pub fn integrate(
    plan: &impl PlannedRun,
    options: &IntegrateOptions,
    call: &Call,
) -> Result<Ending> {
    let pictures = [&options.plot, &options.plot_events];
    for path in pictures.into_iter().flatten() {
        plot::PictureFormat::of(path)?;
    }
    let places = match call.outlet {
        // All is in the object.
        Some(_) => [None, None],
        None => [
            place(&options.output, "events", &options.events)?,
            place(&options.output, "participation", &options.participation)?,
        ],
    };
    let tables = places.iter().flatten().map(|(path, _)| path.as_path());
    let pictures = pictures.into_iter().flatten().map(PathBuf::as_path);
    let others: Vec<&Path> = pictures.chain(tables).collect();
    let kept_bytes = plan.kept_bytes();
    let report = match kept_bytes {
        None => Report::new(&options.output, call, &others)?,
        Some(_) => Report::over(&options.output, call, &others, Over::All)?,
    };
    let kept = report.repeats();
    if options.output.explain {
        let keeping = if kept {
            Keeping::Stored
        } else {
            Keeping::Streamed
        };
        call.say(plan.explain(keeping).trim_end());
    }
    let remarks = report.remarks(plan.system(), &plan.numerics());
    let columns = (plan.columns(), plan.system().units());
    let begun = match kept_bytes {
        Some(bytes) if bytes > 0 => StreamOut::after(&report, columns.0, bytes),
        _ => StreamOut::new(&report, remarks, columns, kept),
    };
    let mut out = match begun {
        Ok(out) => out.drawing(plan.pictured()),
        Err(error) => return written(Err(error), &report.place),
    };
    if plan.observed() {
        call.watch();
    }
    let outcome = plan.run(&mut out)?;
    call.unwatch();
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
    let beside = plan.beside(&outcome);
    let events = beside.events.as_ref().map(|events| events.count());
    let ending = write(plan, &report, (&rows, &beside), &outcome, &places)?;
    drop(beside);
    if let Some(path) = &options.plot {
        report.draw(path, &plan.picture(&drawn))?;
    }
    if let Some(path) = &options.plot_events
        && let Some(picture) = plan.picture_of_events(&outcome)
    {
        report.draw(path, &picture)?;
    }
    report.say(summary(&outcome, events, seconds));
    for line in holds::run_in_words(&outcome.holds) {
        report.say(line);
    }
    if let Some(fault) = plan.fault(&outcome) {
        report.say(fault::line(&fault, plan.system().units()));
    }
    let complete = outcome.failure.is_none() && !outcome.stopped;
    let ended = report.ended(match outcome.failure {
        Some(error) => Err(error),
        None if call.stops() => Ok(Ending::Interrupted),
        None => Ok(ending),
    });
    if complete && ended.is_ok() {
        plan.ended();
    }
    ended
}

/// Where a table goes that has a file of its own.
type TablePlace = Option<(PathBuf, Format)>;

/// The file of a table beside the rows: the one that is named, or one beside the file of the rows; `None` where it is in the
/// object, or below the table on the standard output.
///
/// # Errors
/// [`Error::Input`] where it would stand below the rows of one CSV, and where a file is named for that of an object.
fn place(output: &OutputOptions, name: &str, asked: &Option<PathBuf>) -> Result<TablePlace> {
    let Some(named) = asked else {
        return Ok(None);
    };
    let named = Some(named.clone()).filter(|path| !path.as_os_str().is_empty());
    let file = output
        .output
        .as_deref()
        .filter(|path| *path != Path::new("-"));
    let terminal = std::io::stdout().is_terminal();
    let format = Format::choose(output.format.as_deref(), file, terminal)?;
    match (format, named, file) {
        (Format::Json, Some(named), _) => Err(Error::Input(format!(
            "--{name} {}: a JSON object holds its {name} itself; leave the file out",
            named.display()
        ))),
        (Format::Json, None, _) | (Format::Table, None, None) => Ok(None),
        (_, Some(named), _) => Ok(Some((named, Format::Csv))),
        (Format::Csv, None, None) => Err(Error::Input(format!(
            "--{name} needs a separate file when rows go to standard output as CSV: --{name} FILE, or -o FILE, --format json or --format table"
        ))),
        (_, None, Some(file)) => {
            let mut beside = file.file_stem().unwrap_or_default().to_owned();
            beside.push(format!(".{name}."));
            beside.push(file.extension().unwrap_or("csv".as_ref()));
            Ok(Some((file.with_file_name(beside), format)))
        }
    }
}

/// The object, or the tables after the rows.
fn write(
    plan: &impl PlannedRun,
    report: &Report<'_>,
    (rows, beside): (&RowList, &Beside<'_>),
    outcome: &RunOutcome,
    places: &[TablePlace; 2],
) -> Result<Ending> {
    if report.format == Format::Json {
        let bytes = report.envelope(
            plan.system(),
            plan.numerics(),
            result(plan, rows, beside, outcome),
            report::work(&outcome.work),
            outcome.failure.as_ref(),
        );
        return report.write(&bytes);
    }
    for (table, place) in [&beside.events, &beside.participation]
        .into_iter()
        .zip(places)
    {
        if let Some(table) = table {
            let ending = write_table(plan, report, &**table, place)?;
            if ending != Ending::Done {
                return Ok(ending);
            }
        }
    }
    Ok(Ending::Done)
}

/// A table in its file, or below the others.
fn write_table(
    plan: &impl PlannedRun,
    report: &Report<'_>,
    table: &dyn Listing,
    own: &TablePlace,
) -> Result<Ending> {
    let place = Place::new(own.as_ref().map(|(path, _)| path.as_path()));
    let mut to = place.stream()?;
    let mut remarks = Vec::new();
    let begun = if own.is_some() {
        remarks = report.remarks(plan.system(), &plan.numerics());
        Ok(())
    } else {
        writeln!(to)
    };
    let units = plan.system().units();
    let format = own.as_ref().map_or(report.format, |(_, format)| *format);
    let in_table = format == Format::Table;
    let names = table.names(in_table).into_iter();
    let (names, quantities): (Vec<_>, Vec<_>) = names.unzip();
    let unit_names = unit_names(units, quantities.into_iter());
    let all = begun
        .and_then(|()| report.rows_as(format, to, &remarks, &names, &unit_names))
        .and_then(|mut writer| {
            (0..table.count()).try_for_each(|row| writer.row(&table.cells(row, in_table)))
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
    holds: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    healing_rate: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    summary: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    events: Option<Vec<Map<String, Value>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    participation: Option<Vec<Map<String, Value>>>,
}

fn result<'a>(
    plan: &impl PlannedRun,
    rows: &'a RowList,
    beside: &Beside<'_>,
    outcome: &RunOutcome,
) -> IntegrationResult<'a> {
    let last = outcome.last.as_ref().map(|row| {
        let mut last = object(&rows.columns, row);
        last.insert("error_estimate".into(), json!(outcome.error_estimate));
        for (state, error) in plan.states().iter().zip(outcome.errors.iter().flatten()) {
            last.insert(format!("{state}_uncertainty"), json!(error));
        }
        last
    });
    let objects =
        |table: &Option<Box<dyn Listing + '_>>| table.as_ref().map(|table| table.objects());
    let has_holds = !outcome.holds.is_empty();
    IntegrationResult {
        rows,
        last,
        program: plan.program().map(changes),
        holds: has_holds.then(|| holds::of_run(&outcome.holds)),
        healing_rate: has_holds.then(|| holds::rate_of_run(&outcome.holds)),
        summary: plan.fault(outcome).map(|fault| fault::object(&fault)),
        events: objects(&beside.events),
        participation: objects(&beside.participation),
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
    let catalogue = outcome.catalogue.as_ref();
    if let Some(open) = catalogue.and_then(|catalogue| catalogue.under_way) {
        let participants = several(open.participants, "participant", "participants");
        let since = open.since.map_or("the start".to_owned(), |t| {
            format!("t = {}", seven_digits(t))
        });
        text.push_str(&format!(
            " and one under way since {since} with {participants}"
        ));
    }
    if let Some(estimate) = outcome.error_estimate {
        text.push_str(&format!(", error estimate {estimate:.1e}"));
    }
    if let Some(error) = &outcome.estimate_failure {
        text.push_str(&format!(", no error estimate: {error}"));
    }
    text
}
