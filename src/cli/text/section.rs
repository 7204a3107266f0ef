//! `twinslip section --system`.

use crate::cli::interrupt;
use crate::cli::report::Report;
use crate::cli::section::{summary, write};
use crate::cli::stream::StreamOut;
use crate::cli::{Ending, say, written};
use crate::error::Result;
use crate::number::polynomial::Crossing;
use crate::output::plot;
use crate::scene::{
    Described, SectionOptions, TextModel, TextSectionPlan, run_text_section, text_section_columns,
};
use crate::section::Regime;
use crate::views;
use serde_json::{Value, json};
use std::path::Path;

pub fn run(options: &SectionOptions, model: TextModel, words: &[String]) -> Result<Ending> {
    let plan = TextSectionPlan::new(options, model)?;
    if let Some(path) = &options.plot {
        plot::PictureFormat::of(path)?;
    }
    let others: Vec<&Path> = options.plot.as_deref().into_iter().collect();
    let report = Report::new(&options.output, words, &others)?;
    if options.output.explain {
        say(plan.explain());
    }
    let columns = views::names(&text_section_columns(&plan.model), false);
    let numbers = numerics(&plan);
    let drawn = options.plot.is_some();
    let remarks = report.remarks(&plan.model, &numbers);
    let columns = (columns, plan.model.units());
    let mut out = match StreamOut::new(&report, remarks, columns, drawn) {
        Ok(out) => out.counting(),
        Err(error) => return written(Err(error), &report.place),
    };
    interrupt::watch();
    let outcome = run_text_section(&plan, &mut out)?;
    interrupt::unwatch();
    let seconds = out.progress.finish().as_secs_f64();
    let StreamOut { rows, broken, .. } = out;
    if let Some(error) = broken {
        return written(Err(error), &report.place);
    }
    let asked = (numbers, plan.lyapunov);
    let ending = write(&plan.model, asked, &report, &rows, &outcome)?;
    match &options.plot {
        Some(path) if rows.iter().len() > 1 => {
            plot::write(path, &views::text_return_map(&plan, &rows))?;
        }
        Some(_) => report.say("there are no two returns to draw"),
        None => {}
    }
    report.say(summary(plan.model.units(), &outcome, seconds));
    report.ended(match outcome.failure {
        Some(error) => Err(error),
        None if interrupt::asked() => Ok(Ending::Interrupted),
        None if ending == Ending::Done && outcome.regime == Regime::Undecided => {
            Ok(Ending::Undecided)
        }
        None => Ok(ending),
    })
}

fn numerics(plan: &TextSectionPlan) -> Value {
    json!({
        "method": plan.method.name(),
        "asked": plan.asked_method,
        "rtol": plan.tolerances.rtol,
        "atol": plan.tolerances.atol,
        "max_steps": plan.max_steps,
        "dimension": plan.start.len(),
        "surface": format!("{}={}", plan.model.system.states()[plan.state], plan.value),
        "upwards": plan.direction == Crossing::Upwards,
        "skip": plan.skip,
        "returns": plan.returns,
        "patience": plan.patience,
    })
}
