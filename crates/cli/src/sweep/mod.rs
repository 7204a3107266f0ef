//! `twinslip sweep`: rows in the order of the grid, written as soon as all before them are done.

mod curves;
pub(super) mod file;
mod out;
mod parquet;
#[cfg(feature = "parquet")]
pub mod parquet_file;
mod picture;
#[cfg_attr(not(feature = "mpi"), path = "no_ranks.rs")]
mod ranks;
#[cfg(feature = "mpi")]
pub(crate) mod wire;

use super::call::Call;
use super::report::Report;
use super::words::several;
use super::{Ending, written};
use out::SweepOut;
use ranks::Ranks;
use serde_json::{Value, json};
use twinslip::error::Result;
use twinslip::sweep::{self, UnitShare};
use twinslip_output::Format;
use twinslip_tasks::scene::{Described, SweepOptions, SweepPlan};
use twinslip_tasks::views;

pub fn run(options: &SweepOptions, call: &Call) -> Result<Ending> {
    let Some(mut ranks) = Ranks::join()? else {
        return lead(options, call, None);
    };
    if !ranks.leads() {
        ranks.serve(SweepPlan::new(options).ok().as_ref());
        return Ok(Ending::Done);
    }
    let ended = lead(options, call, Some(&mut ranks));
    ranks.dismiss();
    ended
}

/// Computes and writes, into CSV first where Parquet is asked for.
fn lead(options: &SweepOptions, call: &Call, ranks: Option<&mut Ranks>) -> Result<Ending> {
    match parquet::asked(options)? {
        None => rows(options, call, ranks),
        Some((target, by_csv)) => parquet::finish(&target, rows(&by_csv, call, ranks)?),
    }
}

/// Computes, by the other ranks if there are any, and writes.
fn rows(options: &SweepOptions, call: &Call, ranks: Option<&mut Ranks>) -> Result<Ending> {
    let plan = SweepPlan::new(options)?;
    let (resume, plot) = (options.resume.as_deref(), options.plot.as_deref());
    let report = Report::resuming(&options.output, call, (resume, plot))?;
    if options.output.explain {
        call.say(plan.explain());
        if let Some(text) = curves::explain(&plan.curves) {
            call.say(text);
        }
    }
    let columns = views::sweep_columns(&plan.layout);
    let mut out = SweepOut::new(&plan, &report, &columns, plot.is_some());
    let done = resume.map_or(Ok(0), |path| out.keep(path, &columns))?;
    if let Err(error) = out.open(resume.is_some()) {
        return written(Err(error), &report.place);
    }
    let shard = plan.part();
    let units = UnitShare::shard(shard.index, shard.of, done);
    call.watch();
    let mut seen = |rows: &[sweep::SweepRow]| out.take(rows);
    let failure = match ranks {
        Some(ranks) => ranks.run(&plan.settings, units, call.flag(), &mut seen),
        None => sweep::run(&plan.settings, units, plan.threads, call.flag(), &mut seen),
    };
    call.unwatch();
    let seconds = out.progress.finish().as_secs_f64();
    if let Some(error) = out.broken.take() {
        return written(Err(error), &report.place);
    }
    failure?;
    out.end(call.stops())?;
    let ending = write(&plan, &report, &out)?;
    if let Some(path) = plot {
        picture::draw(&plan, &report, &out.rows, path)?;
    }
    report.say(out.summary(seconds));
    Ok(match ending {
        _ if call.stops() => Ending::Interrupted,
        Ending::Done if out.undecided() > 0 => report.undecided(undecided_rows(out.undecided())),
        ending => ending,
    })
}

/// What is said of rows whose regime is undecided.
pub(super) fn undecided_rows(count: usize) -> String {
    format!(
        "the regime of {}, whose notes say why; more `max_returns` and a smaller `rtol` may decide more",
        several(count, "row", "rows")
    )
}

/// The object; tables and CSV are written already.
fn write(plan: &SweepPlan, report: &Report<'_>, out: &SweepOut<'_>) -> Result<Ending> {
    if report.format != Format::Json {
        return Ok(Ending::Done);
    }
    let units = plan.system.units();
    // Those that were handed on need not be there twice.
    let rows = out.rows.iter().filter(|_| report.repeats());
    let rows: Vec<Value> = match &out.of_dots {
        Some(columns) => rows
            .flat_map(|row| views::dots(row, plan.settings.starts))
            .map(|dot| Value::Object(views::object(columns, &dot, units)))
            .collect(),
        None => rows
            .map(|row| Value::Object(views::object(out.columns, row, units)))
            .collect(),
    };
    let regimes: serde_json::Map<String, Value> = out
        .regimes()
        .map(|(name, count)| (name.to_owned(), json!(count)))
        .collect();
    let result = json!({"rows": rows, "regimes": regimes});
    let work = json!({"points": out.new});
    let bytes = report.envelope(&plan.system, plan.numerics.clone(), result, work, None);
    report.write(&bytes)
}
