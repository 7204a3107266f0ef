//! `twinslip fit`.

mod look;
mod object;
mod page;
mod posterior;
mod records;
mod sanity;
mod steps;

use super::Ending;
use super::call::Call;
use super::holds;
use super::report::Report;
use serde_json::{Map, Value, json};
use std::path::Path;
use twinslip::error::{Error, Result};
use twinslip::fit::{
    Comparison, Fit, Hold, Posterior, Problem, Sampling, akaike, cross_validation,
};
use twinslip_output::{Format, plot};
use twinslip_tasks::scene::{
    Described, FitOptions, FitPlan, FittedRecords, LawToFit, Measured, Recording, Units,
    WithProblem,
};
use twinslip_tasks::views::{self, FitRow};

/// A law that was fitted, with what it is compared by where there are several.
pub struct Fitted<'a> {
    pub law: &'a LawToFit,
    pub together: FittedRecords,
    pub holds: Vec<Hold>,
    pub drawn: Option<Drawn>,
    pub comparison: Option<Comparison>,
    /// By how much derivatives by sensitivities of CVODES differ, relative to the largest of each parameter.
    pub crosscheck: Option<f64>,
}

impl Fitted<'_> {
    /// The fit of all records.
    pub fn fit(&self) -> &Fit {
        &self.together.fit
    }
}

/// Draws from a posterior.
pub struct Drawn {
    pub posterior: Posterior,
    pub sampling: Sampling,
    /// The minima that chains began at.
    pub minima: usize,
}

pub fn run(options: &FitOptions, call: &Call) -> Result<Ending> {
    let pictures = [
        &options.plot,
        &options.plot_parameters,
        &options.plot_law,
        &options.plot_holds,
        &options.plot_records,
    ];
    if options.look {
        return look::run(options, call);
    }
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
    if options.plot_holds.is_some() && !holds::are_there(&plan) {
        return Err(Error::Input(
            "`plot_holds`: the load point is never held, so there is nothing to draw".into(),
        ));
    }
    if options.plot_records.is_some() && plan.recordings.len() == 1 {
        return Err(Error::Input(
            "`plot_records`: there is one record, and none to compare it with".into(),
        ));
    }
    for own in &plan.recordings {
        report.say(own.measured.taken_in_words());
    }
    if options.output.explain {
        call.say(plan.explain());
    }
    let mut progress = report.progress();
    let mut found = Vec::with_capacity(plan.laws.len());
    let mut stopped = false;
    for (i, law) in plan.laws.iter().enumerate() {
        let number = match plan.laws.len() {
            1 => String::new(),
            all => format!(", {} of {all}", i + 1),
        };
        progress.begin(&format!("fitting the law {}{number}", law.name));
        let mut fitted = fitted(&plan, law, options)?;
        if let Some(sampling) = plan.sampling.get(i).filter(|_| !stopped) {
            // Watched before it is said: whoever reads that draws come may interrupt them.
            call.watch();
            call.holds();
            progress.begin(&format!(
                "drawing from the posterior of {}{number}",
                law.name
            ));
            let drawn = draw(&plan, &fitted, sampling, call);
            call.unwatch();
            // The fit is kept.
            stopped = matches!(drawn, Err(Error::Interrupted));
            fitted.drawn = match drawn {
                Err(Error::Interrupted) => None,
                drawn => Some(drawn?),
            };
        }
        found.push(fitted);
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
    let rows = rows(&plan, best.fit());
    let about = About::new(&plan);
    if let Some(path) = &options.plot {
        report.draw(path, &views::picture_of_fit(&rows, &best.law.name))?;
    }
    if let Some(path) = &options.plot_parameters {
        report.draw(path, &page::parameters_picture(&plan, best))?;
    }
    if let Some(path) = &options.plot_holds {
        report.draw(path, &views::picture_of_holds(&best.holds))?;
    }
    if let Some(path) = &options.plot_records {
        report.draw(path, &records::picture(&plan, best))?;
    }
    if let Some(path) = &options.plot_law {
        report.draw(path, &page::law_picture(&plan, best)?)?;
    }
    if let Some(path) = &options.report {
        page::write(path, call, &plan, (&found, &steps), &rows)?;
    }
    let mut result = object::result(&plan, &found, &steps);
    let doubts = best.drawn.iter().flat_map(|one| &one.posterior.undecided);
    let mut undecided = best.fit().verdict.undecided.clone();
    undecided.extend(doubts.cloned());
    let mut lines = object::lines(&plan, &found, &steps);
    let questions = sanity::questions(&plan, best.law, best.fit());
    if let Some(notes) = result["notes"].as_array_mut() {
        notes.extend(questions.iter().cloned().map(Value::String));
    }
    lines.extend(questions);
    let written = if report.format == Format::Table && options.output.format.is_none() {
        // A terminal shows what was found; thousands of rows beside it are for files, or for who asks for them.
        let result = std::mem::take(&mut lines).join("\n") + "\n";
        report.say("for the rows give --output FILE, or a --format");
        report.write(result.as_bytes())?
    } else if report.format == Format::Json {
        let mut result = result;
        let objects = rows.iter().map(|row| {
            Value::Object(views::object(
                &views::fit_columns(plan.recordings.len() > 1),
                row,
                &about.units,
            ))
        });
        result["rows"] = objects.collect();
        let evaluations: usize = found.iter().map(evaluations).sum();
        let work = json!({ "evaluations": evaluations });
        report.write(&report.envelope(&about, json!({}), result, work, None))?
    } else {
        let mut remarks = report.remarks(&about, &Value::Null);
        remarks.extend(lines.iter().cloned());
        report.write_all(
            &about.units,
            remarks,
            &views::fit_columns(plan.recordings.len() > 1),
            &rows,
        )?
    };
    for line in lines {
        report.say(line);
    }
    Ok(match written {
        Ending::Done if stopped => Ending::Interrupted,
        Ending::Done if best.fit().verdict.name() != "converged" => report.undecided(format_args!(
            "the fit, as {}; give that parameter a value, or use a record that determines it",
            undecided.join("; ")
        )),
        Ending::Done if !undecided.is_empty() => {
            report.undecided(format_args!("the posterior, as {}", undecided.join("; ")))
        }
        ending => ending,
    })
}

fn evaluations(one: &Fitted<'_>) -> usize {
    let alone = one.together.alone.iter();
    let alone = alone.filter_map(|own| own.fit.as_ref().ok());
    let drawn = one
        .drawn
        .as_ref()
        .map_or(0, |one| one.posterior.evaluations);
    one.fit().evaluations + alone.map(|fit| fit.evaluations).sum::<usize>() + drawn
}

fn fitted<'a>(plan: &FitPlan, law: &'a LawToFit, options: &FitOptions) -> Result<Fitted<'a>> {
    let together = plan.fit(law)?;
    let (fit, whole) = (&together.fit, together.pieces(plan));
    let comparison = if plan.laws.len() > 1 {
        let akaike = akaike(&together.records, fit);
        let mut validate = Validate(fit);
        Some(Comparison {
            akaike,
            cross_validation: law.with_problem(plan, &whole, &mut validate)?,
        })
    } else {
        None
    };
    let crosscheck = if options.crosscheck {
        Some(law.with_problem(plan, &whole, &mut Recheck(fit))?)
    } else {
        None
    };
    Ok(Fitted {
        law,
        holds: law.with_problem(plan, &whole, &mut Holds(fit))?,
        drawn: None,
        together,
        comparison,
        crosscheck,
    })
}

fn draw(plan: &FitPlan, fitted: &Fitted<'_>, sampling: &Sampling, call: &Call) -> Result<Drawn> {
    let goes_on = || !call.stops();
    let given = (&fitted.together, sampling);
    let (posterior, minima) = plan.posterior(fitted.law, given, &goes_on)?;
    Ok(Drawn {
        posterior,
        sampling: sampling.clone(),
        minima: minima.len(),
    })
}

struct Holds<'a>(&'a Fit);

impl WithProblem for Holds<'_> {
    type Output = Vec<Hold>;
    fn call<const N: usize>(&mut self, problem: &Problem<'_, N>) -> Result<Vec<Hold>> {
        twinslip::fit::holds(problem, self.0)
    }
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
    let mut fitted = fit.fitted.iter();
    let mut rows = Vec::with_capacity(fit.fitted.len());
    for (number, Recording { record, .. }) in plan.recordings.iter().enumerate() {
        let each = record.times.iter().zip(&record.displacement);
        let each = each.zip(&record.friction).zip(&mut fitted);
        rows.extend(
            each.map(|(((&time, &displacement), &observed), &fitted)| FitRow {
                record: number + 1,
                time,
                displacement,
                observed,
                fitted,
            }),
        );
    }
    rows
}

/// What the result is of.
pub struct About {
    echo: Map<String, Value>,
    pub units: Units,
}

impl About {
    fn new(plan: &FitPlan) -> Self {
        let names: Vec<&str> = plan.laws.iter().map(|law| law.name.as_str()).collect();
        let law = json!({
            "law": names.join(","),
            "states": plan.laws[0].states,
            "reference_rate": plan.reference_rate,
        });
        let mut echo = law.as_object().cloned().unwrap_or_default();
        let mut each = plan
            .recordings
            .iter()
            .map(|own| Self::of_record(&own.measured));
        let Some(first) = each.next() else {
            unreachable!("there is a record")
        };
        let rest: Vec<About> = each.collect();
        for (name, value) in &first.echo {
            let others = rest.iter().map(|one| one.echo[name].clone());
            let value = match rest[..] {
                [] => value.clone(),
                _ => std::iter::once(value.clone()).chain(others).collect(),
            };
            echo.insert(name.clone(), value);
        }
        About { echo, ..first }
    }

    /// What is known of a record alone.
    fn of_record(measured: &Measured) -> Self {
        let [time, displacement, friction, normal] = &measured.columns;
        let columns = json!({
            "time": time,
            "displacement": displacement,
            "friction": friction,
            "normal_stress": normal,
        });
        let echo = json!({
            "normal_stress": measured.normal_stress,
            "samples": measured.times.len(),
            "columns": columns,
        });
        About {
            echo: echo.as_object().cloned().unwrap_or_default(),
            units: Units::measured(),
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
