//! Several records that are fitted together: what each says alone, and whether they agree.

use super::{Fitted, object};
use serde_json::{Value, json};
use twinslip::fit::{Agreement, Fit, FittedParameter};
use twinslip::number::Uncertain;
use twinslip_output::plot::{Axis, Bars, Drawing, Mark, Panel, PlotSeries, Stroke, Symbol};
use twinslip_tasks::scene::FitPlan;
use twinslip_tasks::views::{in_digits, label_of};

/// `result.records`
pub fn objects(plan: &FitPlan, fitted: &Fitted<'_>) -> Value {
    let pairs = plan.recordings.iter().zip(&fitted.together.alone);
    let each = pairs.enumerate().map(|(at, (own, alone))| {
        let mut one = json!({
            "file": own.measured.file,
            "samples": own.record.times.len(),
            "weight": alone.weight,
            "outlying": outlying(fitted, at),
        });
        match &alone.fit {
            Ok(fit) => one["fit"] = object::of_fit(plan, fitted.law, &of_record(fit, at)),
            Err(error) => one["error"] = json!(error.to_string()),
        }
        one
    });
    each.collect()
}

/// A fit of one record, as the one of that number.
fn of_record(fit: &Fit, at: usize) -> Fit {
    let mut fit = fit.clone();
    fit.parameters
        .iter_mut()
        .for_each(|one| one.of_record = Some(at));
    let undetermined = fit.verdict.undetermined.iter();
    fit.verdict.undetermined = undetermined
        .map(|name| format!("{name} of record {}", at + 1))
        .collect();
    fit
}

/// The parameters in which a record differs from the others by more than chance explains.
fn outlying<'a>(fitted: &'a Fitted<'_>, at: usize) -> Vec<&'a str> {
    let all = fitted.together.agreements.iter();
    let own = all.filter(|one| one.outlying.contains(&at));
    own.map(|one| one.name.as_str()).collect()
}

/// `result.agreement`
pub fn agreement(fitted: &Fitted<'_>) -> Value {
    let each = fitted.together.agreements.iter().map(|one| {
        json!({
            "name": one.name,
            "q": one.q,
            "degrees_of_freedom": one.degrees_of_freedom,
            "probability": one.probability,
            "widening": one.widening,
        })
    });
    each.collect()
}

/// In words, one a line.
pub fn lines(plan: &FitPlan, fitted: &Fitted<'_>) -> Vec<String> {
    let mut lines = Vec::new();
    for (at, (own, alone)) in plan
        .recordings
        .iter()
        .zip(&fitted.together.alone)
        .enumerate()
    {
        let shared = fitted.together.agreements.iter();
        let name = format!("record {}, {}", at + 1, own.name());
        lines.push(match &alone.fit {
            Err(error) => format!("{name}: alone it is not fitted: {error}"),
            Ok(fit) => {
                let each = shared.filter_map(|one| {
                    let found = fit.parameters.iter().find(|own| own.name == one.name)?;
                    Some(in_words(plan, at, fit, found))
                });
                format!(
                    "{name}, alone: {}; residuals {}, weight {}",
                    each.collect::<Vec<_>>().join(", "),
                    in_digits(fit.rms, 3),
                    in_digits(alone.weight, 3)
                )
            }
        });
    }
    for Agreement {
        name,
        outlying,
        probability,
        widening,
        ..
    } in &fitted.together.agreements
    {
        if *widening > 1.0 {
            let far: Vec<String> = outlying
                .iter()
                .map(|at| format!("record {}", at + 1))
                .collect();
            let far = match far.is_empty() {
                true => String::new(),
                false => format!("; far from the others: {}", far.join(", ")),
            };
            lines.push(format!(
                "the records differ in {name} more than their noise explains (probability {probability:.1e}), and all errors are widened, for this by {widening:.3}{far}"
            ));
        }
    }
    if !fitted.together.alone.is_empty() {
        lines.push("samples count by the inverse variance of their record's noise, so that a longer record says more".into());
    }
    lines
}

fn in_words(plan: &FitPlan, at: usize, fit: &Fit, one: &FittedParameter) -> String {
    if fit.verdict.has_run_away(one) {
        return format!("{} not determined", one.name);
    }
    let (factor, unit) = object::unit(plan, &one.name, Some(at));
    let unit = if unit == "1" {
        String::new()
    } else {
        format!(" {unit}")
    };
    let known = Uncertain::new(one.value * factor, one.uncertainty * factor);
    format!("{} = {known}{unit}", one.name)
}

/// A panel for each parameter that is shared: what each record says, from the top, and all together.
pub fn picture(plan: &FitPlan, fitted: &Fitted<'_>) -> Drawing {
    let count = plan.recordings.len();
    let shared = fitted
        .fit()
        .parameters
        .iter()
        .filter(|one| one.of_record.is_none());
    let columns = shared.map(|one| {
        let stress = object::stress(plan, None);
        let (label, by) = label_of(one, stress);
        let mark = |own: &FittedParameter, height: f64, symbol: Symbol, colour: usize| {
            let (low, high) = own.interval;
            let bars = (low * by, high * by);
            let is_whole = bars.0.is_finite() && bars.1.is_finite();
            Mark {
                bars: Bars {
                    x: is_whole.then_some(bars),
                    y: None,
                },
                ..Mark::new(own.value * by, height, "")
                    .symbol(symbol)
                    .colour(colour)
            }
        };
        let alone = fitted.together.alone.iter().enumerate();
        let alone = alone.filter_map(|(at, alone)| {
            let fit = alone.fit.as_ref().ok()?;
            let own = fit.parameters.iter().find(|own| own.name == one.name)?;
            let is_known = !fit.verdict.has_run_away(own);
            is_known.then(|| mark(own, (at + 1) as f64, Symbol::Circle, 0))
        });
        let mut marks: Vec<Mark> = alone.collect();
        marks.push(mark(one, 0.0, Symbol::Diamond, 1));
        let (low, high) = one.interval;
        let ends = [low, high].into_iter().filter(|x| x.is_finite());
        let lines = ends.map(|x| {
            let along = vec![x * by; 2];
            PlotSeries::new("", along, vec![-0.5, count as f64 + 0.5])
                .stroke(Stroke::Dashed)
                .colour(6)
        });
        let panel = Panel {
            series: lines.collect(),
            marks,
            ..Panel::new(
                one.name.clone(),
                Axis::linear(label),
                Axis::linear("record; 0: all").within(-0.5, count as f64 + 0.5),
            )
        };
        vec![panel]
    });
    Drawing::columns(columns.collect())
}
