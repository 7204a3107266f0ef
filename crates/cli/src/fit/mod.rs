//! `twinslip fit`.

mod object;
mod page;
mod steps;

use super::Ending;
use super::call::Call;
use super::report::Report;
use serde_json::{Map, Value, json};
use std::path::Path;
use twinslip::error::Result;
use twinslip::fit::{Comparison, Fit, Problem, akaike, cross_validation};
use twinslip_output::{Format, plot};
use twinslip_tasks::scene::{Described, FitOptions, FitPlan, LawToFit, Units, WithProblem};
use twinslip_tasks::views::{self, FitRow};

/// A law that was fitted, with what it is compared by where there are several.
pub struct Fitted<'a> {
    pub law: &'a LawToFit,
    pub fit: Fit,
    pub comparison: Option<Comparison>,
    /// By how much derivatives by sensitivities of CVODES differ, relative to the largest of each parameter.
    pub crosscheck: Option<f64>,
}

pub fn run(options: &FitOptions, call: &Call) -> Result<Ending> {
    let pictures = [&options.plot, &options.plot_parameters, &options.plot_law];
    let pictures: Vec<&Path> = pictures
        .into_iter()
        .flatten()
        .map(|path| path.as_path())
        .collect();
    for path in &pictures {
        plot::PictureFormat::of(path)?;
    }
    if let Some(page) = &options.report {
        page::check_name(page)?;
    }
    let mut files = pictures;
    files.extend(options.report.as_deref());
    let report = Report::new(&options.output, call, &files)?;
    let plan = FitPlan::new(options)?;
    if options.output.explain {
        call.say(plan.explain());
    }
    let mut progress = report.progress();
    let mut found = Vec::with_capacity(plan.laws.len());
    for (i, law) in plan.laws.iter().enumerate() {
        let number = match plan.laws.len() {
            1 => String::new(),
            all => format!(", {} of {all}", i + 1),
        };
        progress.begin(&format!("fitting the law {}{number}", law.name));
        found.push(fitted(&plan, law, options)?);
    }
    // The law with the most information first.
    let least = |one: &Fitted<'_>| one.comparison.map_or(0.0, |comparison| comparison.akaike);
    found.sort_by(|one, other| least(one).total_cmp(&least(other)));
    let steps = if options.each_step {
        steps::each(&plan, found[0].law)?
    } else {
        Vec::new()
    };
    progress.finish();
    let best = &found[0];
    let rows = rows(&plan, &best.fit);
    let about = About::new(&plan);
    if let Some(path) = &options.plot {
        report.draw(path, &views::picture_of_fit(&rows, &best.law.name))?;
    }
    if let Some(path) = &options.plot_parameters {
        let stress = plan.measured.normal_stress;
        report.draw(path, &views::picture_of_parameters(&best.fit, stress))?;
    }
    if let Some(path) = &options.plot_law {
        report.draw(path, &page::law_picture(&plan, best)?)?;
    }
    if let Some(path) = &options.report {
        page::write(path, call, &plan, (&found, &steps), &rows)?;
    }
    let result = object::result(&plan, &found, &steps);
    let is_decided = best.fit.verdict.name() == "converged";
    let mut lines = object::lines(&plan, &found, &steps);
    let written = if report.format == Format::Table && options.output.format.is_none() {
        // A terminal shows what was found; thousands of rows beside it are for files, or for who asks for them.
        let result = std::mem::take(&mut lines).join("\n") + "\n";
        report.say("for the rows give --output FILE, or a --format");
        report.write(result.as_bytes())?
    } else if report.format == Format::Json {
        let mut result = result;
        let objects = rows
            .iter()
            .map(|row| Value::Object(views::object(&views::fit_columns(), row, &about.units)));
        result["rows"] = objects.collect();
        let evaluations: usize = found.iter().map(|one| one.fit.evaluations).sum();
        let work = json!({ "evaluations": evaluations });
        report.write(&report.envelope(&about, json!({}), result, work, None))?
    } else {
        let mut remarks = report.remarks(&about, &Value::Null);
        remarks.extend(lines.iter().cloned());
        report.write_all(&about.units, remarks, &views::fit_columns(), &rows)?
    };
    for line in lines {
        report.say(line);
    }
    Ok(match written {
        Ending::Done if !is_decided => report.undecided(format_args!(
            "the fit, as {}; give that parameter a value, or use a record that determines it",
            best.fit.verdict.undecided.join("; ")
        )),
        ending => ending,
    })
}

fn fitted<'a>(plan: &FitPlan, law: &'a LawToFit, options: &FitOptions) -> Result<Fitted<'a>> {
    let fit = plan.fit(law)?;
    let whole = (&plan.motion, &plan.record);
    let comparison = if plan.laws.len() > 1 {
        let akaike = akaike(&plan.record, &fit);
        let mut validate = Validate(&fit);
        Some(Comparison {
            akaike,
            cross_validation: law.with_problem(plan, whole, &mut validate)?,
        })
    } else {
        None
    };
    let crosscheck = if options.crosscheck {
        Some(law.with_problem(plan, whole, &mut Recheck(&fit))?)
    } else {
        None
    };
    Ok(Fitted {
        law,
        fit,
        comparison,
        crosscheck,
    })
}

struct Validate<'a>(&'a Fit);

impl WithProblem for Validate<'_> {
    type Output = Option<f64>;
    fn call<const N: usize>(&mut self, problem: &Problem<'_, N>) -> Result<Option<f64>> {
        cross_validation(problem, self.0)
    }
}

struct Recheck<'a>(&'a Fit);

impl WithProblem for Recheck<'_> {
    type Output = f64;
    fn call<const N: usize>(&mut self, problem: &Problem<'_, N>) -> Result<f64> {
        twinslip::fit::by_sensitivities(problem, &self.0.variables)
    }
}

fn rows(plan: &FitPlan, fit: &Fit) -> Vec<FitRow> {
    let record = &plan.record;
    let each = (0..record.times.len()).map(|i| FitRow {
        time: record.times[i],
        displacement: record.displacement[i],
        observed: record.friction[i],
        fitted: fit.fitted[i],
    });
    each.collect()
}

/// What the result is of.
pub struct About {
    echo: Map<String, Value>,
    pub units: Units,
}

impl About {
    fn new(plan: &FitPlan) -> Self {
        let [time, displacement, friction, normal] = &plan.measured.columns;
        let columns = json!({
            "time": time,
            "displacement": displacement,
            "friction": friction,
            "normal_stress": normal,
        });
        let names: Vec<&str> = plan.laws.iter().map(|law| law.name.as_str()).collect();
        let echo = json!({
            "law": names.join(","),
            "states": plan.laws[0].states,
            "reference_rate": plan.reference_rate,
            "normal_stress": plan.measured.normal_stress,
            "samples": plan.record.times.len(),
            "columns": columns,
        });
        About {
            echo: echo.as_object().cloned().unwrap_or_default(),
            units: plan.units(),
        }
    }
}

impl Described for About {
    fn echo(&self) -> &Map<String, Value> {
        &self.echo
    }

    fn units(&self) -> &Units {
        &self.units
    }
}
