//! `twinslip integrate --system`.

use crate::cli::integrate::{changes, summary_of};
use crate::cli::interrupt;
use crate::cli::report::{self, Report};
use crate::cli::stream::StreamOut;
use crate::cli::{Ending, say, written};
use crate::error::Result;
use crate::output::{Format, RowList, object, plot};
use crate::scene::{Described, IntegrateOptions, TextModel, TextOutcome, TextPlan, run_text};
use crate::views;
use serde_json::{Map, Value, json};
use std::path::Path;

pub fn run(options: &IntegrateOptions, model: TextModel, words: &[String]) -> Result<Ending> {
    let plan = TextPlan::new(options, model)?;
    if let Some(path) = &options.plot {
        plot::PictureFormat::of(path)?;
    }
    let others: Vec<&Path> = options.plot.as_deref().into_iter().collect();
    let report = Report::new(&options.output, words, &others)?;
    if options.output.explain {
        say(plan.explain());
    }
    let columns = views::names(&plan.columns, false);
    let pictured = views::names(&plan.pictured(), false);
    let numbers = numerics(&plan);
    let kept = report.format == Format::Json;
    let remarks = report.remarks(&plan.model, &numbers);
    let columns = (columns, plan.model.units());
    let mut out = match StreamOut::new(&report, remarks, columns, kept) {
        Ok(out) => out.drawing(pictured.into_iter().map(|(name, _)| name).collect()),
        Err(error) => return written(Err(error), &report.place),
    };
    if plan.observed() {
        interrupt::watch();
    }
    let outcome = run_text(&plan, &mut out)?;
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
    let mut ending = Ending::Done;
    if kept {
        let bytes = report.envelope(
            &plan.model,
            numbers,
            result(&plan, &rows, &outcome),
            report::work(&outcome.work),
            outcome.failure.as_ref(),
        );
        ending = written(report.place.write(&bytes), &report.place)?;
    }
    if let Some(path) = &options.plot {
        plot::write(path, &views::text_run(&plan, &drawn))?;
    }
    let estimate = (outcome.error_estimate, outcome.estimate_failure.as_ref());
    report.say(summary_of(&outcome.work, None, estimate, seconds));
    report.ended(match outcome.failure {
        Some(error) => Err(error),
        None if interrupt::asked() => Ok(Ending::Interrupted),
        None => Ok(ending),
    })
}

fn numerics(plan: &TextPlan) -> Value {
    json!({
        "method": plan.method.name(),
        "asked": plan.asked_method,
        "rtol": plan.tolerances.rtol,
        "atol": plan.tolerances.atol,
        "max_steps": plan.max_steps,
        "dimension": plan.start.len(),
    })
}

/// What the object holds.
#[derive(serde::Serialize)]
struct RunResult<'a> {
    rows: &'a RowList,
    #[serde(rename = "final")]
    last: Option<Map<String, Value>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    program: Option<Vec<Value>>,
}

fn result<'a>(plan: &TextPlan, rows: &'a RowList, outcome: &TextOutcome) -> RunResult<'a> {
    let last = outcome.last.as_ref().map(|row| {
        let mut last = object(&rows.columns, row);
        last.insert("error_estimate".into(), json!(outcome.error_estimate));
        let states = plan.model.system.states().iter();
        for (state, error) in states.zip(outcome.errors.iter().flatten()) {
            last.insert(format!("{state}_uncertainty"), json!(error));
        }
        last
    });
    RunResult {
        rows,
        last,
        program: plan.program.as_ref().map(changes),
    }
}
