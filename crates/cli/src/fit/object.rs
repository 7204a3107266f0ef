//! What a fit says of itself: as an object, and in lines.

use super::steps::FittedStep;
use super::{Fitted, posterior, records};
use crate::holds;
use serde_json::{Map, Value, json};
use twinslip::fit::{Autoregression, DRIFT, Fit, FittedParameter, Scale, Verdict};
use twinslip_output::seven_digits;
use twinslip_tasks::scene::{FitPlan, LawToFit, Recording};
use twinslip_tasks::views::{digits_of, in_digits, scale_name};

/// `result`, without rows.
pub fn result(plan: &FitPlan, found: &[Fitted<'_>], steps: &[FittedStep]) -> Value {
    let best = &found[0];
    let mut fit = of_fit(plan, best.law, best.fit());
    fit["derivatives_difference"] = json!(best.crosscheck);
    let programs: Vec<Value> = plan.recordings.iter().map(program).collect();
    let mut result = json!({
        "fit": fit,
        "program": match &programs[..] {
            [one] => one.clone(),
            _ => json!(programs),
        },
        "notes": notes(plan).collect::<Vec<_>>(),
    });
    if !best.holds.is_empty() {
        result["holds"] = holds::object(&best.holds, plan.recordings.len() > 1);
        result["healing_rate"] = holds::rate(&best.holds);
    }
    if !best.together.alone.is_empty() {
        result["records"] = records::objects(plan, best);
        result["agreement"] = records::agreement(best);
    }
    if let Some(drawn) = &best.drawn {
        result["posterior"] = posterior::object(plan, best, drawn);
    }
    if found.len() > 1 {
        let least = best.comparison.map(|one| one.akaike);
        let each = found.iter().map(|one| {
            let akaike = one.comparison.map(|one| one.akaike);
            let mut object = of_fit(plan, one.law, one.fit());
            object["aicc"] = json!(akaike);
            object["aicc_difference"] = json!(akaike.zip(least).map(|(own, least)| own - least));
            object["cross_validation_rms"] =
                json!(one.comparison.and_then(|one| one.cross_validation));
            object
        });
        result["laws"] = each.collect();
    }
    if !steps.is_empty() {
        let each = steps.iter().map(|step| {
            let mut object = json!({
                "record": step.record + 1,
                "time": step.time,
                "from": step.window.0,
                "to": step.window.1,
                "driving": [step.driving.0, step.driving.1],
            });
            match &step.fit {
                Ok(fit) => object["fit"] = of_fit(plan, best.law, fit),
                Err(error) => object["error"] = json!(error.to_string()),
            }
            object
        });
        result["steps"] = each.collect();
    }
    result
}

/// How the load point moved, where that is not from sample to sample.
fn program(recording: &Recording) -> Value {
    /// More stretches are not told.
    const TOLD: usize = 100;
    let stretches = &recording.motion.stretches;
    if stretches.len() > TOLD {
        return Value::Null;
    }
    let each = stretches.iter().map(|stretch| {
        json!({
            "from": stretch.span.0,
            "to": stretch.span.1,
            "driving": [stretch.velocity.0, stretch.velocity.1],
        })
    });
    each.collect()
}

/// What was made of the records that a user may not have meant.
fn notes(plan: &FitPlan) -> impl Iterator<Item = String> {
    let each = plan.recordings.iter();
    each.flat_map(|own| own.measured.notes.iter().cloned())
}

pub(super) fn of_fit(plan: &FitPlan, law: &LawToFit, fit: &Fit) -> Value {
    let parameters: Vec<Value> = fit
        .parameters
        .iter()
        .map(|parameter| of_parameter(plan, &fit.verdict, parameter))
        .collect();
    let count = fit.parameters.len();
    let correlation: Vec<Vec<f64>> = (0..count)
        .map(|i| (0..count).map(|j| fit.correlation[(i, j)]).collect())
        .collect();
    let mut fixed = Map::new();
    fixed.insert("reference_rate".into(), json!(plan.reference_rate));
    fixed.insert("normal_stress".into(), json!(stress(plan, None)));
    for (name, value) in law.fixed(plan.reference_rate) {
        let (factor, _) = unit(plan, name, None);
        fixed.insert(name.into(), json!(value * factor));
    }
    json!({
        "law": law.name,
        "states": law.states,
        "verdict": fit.verdict.name(),
        "undecided": fit.verdict.undecided,
        "undetermined": fit.verdict.undetermined,
        "parameters": parameters,
        "correlation": correlation,
        "fixed": fixed,
        "residual_rms": fit.rms,
        "degrees_of_freedom": fit.degrees_of_freedom,
        "effective_samples": fit.effective_samples,
        "noise": match &fit.noise[..] {
            [one] => noise(one),
            all => all.iter().map(noise).collect(),
        },
        "evaluations": fit.evaluations,
    })
}

fn noise(one: &Autoregression) -> Value {
    json!({
        "autoregression": one.coefficients,
        "innovation": one.innovation.sqrt(),
    })
}

/// The normal stress of a record, or of the first one.
pub(super) fn stress(plan: &FitPlan, of_record: Option<usize>) -> Option<f64> {
    let own = &plan.recordings[of_record.unwrap_or(0)];
    own.measured.normal_stress
}

/// The unit of a parameter and how large it is in what fits compute with.
pub(super) fn unit(plan: &FitPlan, name: &str, of_record: Option<usize>) -> (f64, &'static str) {
    match (name, stress(plan, of_record)) {
        ("stiffness", Some(sigma)) => (sigma, "Pa/m"),
        ("stiffness", None) => (1.0, "1/m"),
        ("slip_length" | "slip_length_2", _) => (1.0, "m"),
        ("healing_time", _) => (1.0, "s"),
        (DRIFT, _) => (1.0, "1/m"),
        _ => (1.0, "1"),
    }
}

fn of_parameter(plan: &FitPlan, verdict: &Verdict, parameter: &FittedParameter) -> Value {
    let (factor, unit) = unit(plan, &parameter.name, parameter.of_record);
    // An end that there is not is null.
    let number = |x: f64| Some(x * factor).filter(|x| x.is_finite());
    let mut object = json!({
        "name": parameter.name,
        "unit": unit,
        "value": number(parameter.value).filter(|_| !verdict.has_run_away(parameter)),
        "uncertainty": number(parameter.uncertainty),
        "interval_95": [number(parameter.interval.0), number(parameter.interval.1)],
        "scale": scale_name(parameter.scale),
        "widening": number(parameter.widening / factor),
    });
    if let Some(at) = parameter.of_record {
        object["record"] = json!(at + 1);
    }
    object
}

/// In words, one a line.
pub fn lines(plan: &FitPlan, found: &[Fitted<'_>], steps: &[FittedStep]) -> Vec<String> {
    let best = &found[0];
    let mut lines: Vec<String> = notes(plan).collect();
    let samples: usize = plan
        .recordings
        .iter()
        .map(|own| own.record.times.len())
        .sum();
    let told = |law: &LawToFit| match law.states {
        1 => law.name.clone(),
        states => format!("{} with {states} state variables", law.name),
    };
    lines.push(format!(
        "{}: {}, residuals {} (root mean square), {} samples (effective sample size {:.0})",
        told(best.law),
        best.fit().verdict.name(),
        in_digits(best.fit().rms, 4),
        samples,
        best.fit().effective_samples
    ));
    lines.extend(all_in_words(plan, best.fit()));
    lines.extend(best.fit().verdict.undecided.iter().cloned());
    lines.extend(records::lines(plan, best));
    lines.extend(holds::lines(&best.holds, plan.recordings.len() > 1));
    if let Some(drawn) = &best.drawn {
        lines.extend(posterior::lines(plan, best, drawn));
    }
    if let Some(difference) = best.crosscheck {
        lines.push(format!(
            "derivatives by sensitivities of CVODES differ by {difference:.1e} of the largest"
        ));
    }
    for other in &found[1..] {
        let difference = |of: fn(&Fitted<'_>) -> Option<f64>| Some((of(other)?, of(best)?));
        let akaike = difference(|one| one.comparison.map(|one| one.akaike));
        let predicted = difference(|one| one.comparison?.cross_validation);
        let by = akaike.map_or(f64::NAN, |(own, least)| own - least);
        let blocks = predicted.map_or(String::new(), |(own, best)| {
            format!("; predicts blocks left out to {own:.3e}, the other to {best:.3e}")
        });
        // What predicts worse is not better, whatever its likelihood is.
        let is_against = predicted.is_some_and(|(own, best)| own < best);
        let judged = match by {
            by if by < 2.0 => "the data do not distinguish them",
            _ if is_against => "but it predicts better: the data do not distinguish them",
            by if by < 10.0 => "some evidence for the other",
            _ => "decidedly worse",
        };
        lines.push(format!(
            "{}: AICc {by:.1} above that of {}, {judged}; residuals {:.3e}, verdict {}{blocks}",
            told(other.law),
            told(best.law),
            other.fit().rms,
            other.fit().verdict.name()
        ));
    }
    for step in steps {
        match &step.fit {
            Ok(fit) => {
                let each: Vec<String> = all_in_words(plan, fit).collect();
                lines.push(format!(
                    "step at {} s, {:e} to {:e} m/s, {}: {}",
                    seven_digits(step.time),
                    step.driving.0,
                    step.driving.1,
                    fit.verdict.name(),
                    each.join("; ")
                ));
            }
            Err(error) => lines.push(format!("step at {} s: {error}", seven_digits(step.time))),
        }
    }
    lines
}

fn all_in_words(plan: &FitPlan, fit: &Fit) -> impl Iterator<Item = String> {
    let has_run_away = |one: &FittedParameter| fit.verdict.has_run_away(one);
    fit.parameters
        .iter()
        .map(move |one| in_words(plan, one, has_run_away(one)))
}

fn in_words(plan: &FitPlan, parameter: &FittedParameter, has_run_away: bool) -> String {
    let (factor, unit) = unit(plan, &parameter.name, parameter.of_record);
    let unit = match unit {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let digits = digits_of(parameter);
    // A positive parameter has no lower end at zero.
    let no_end = match parameter.scale {
        Scale::Logarithmic => 0.0,
        Scale::Linear => f64::NEG_INFINITY,
    };
    let (low, high) = parameter.interval;
    let interval = match (low > no_end, high.is_finite()) {
        (true, true) => format!(
            "from {} to {}{unit}",
            in_digits(low * factor, digits),
            in_digits(high * factor, digits)
        ),
        (true, false) => format!("above {}{unit}", in_digits(low * factor, digits)),
        (false, true) => format!("below {}{unit}", in_digits(high * factor, digits)),
        (false, false) => "without ends".into(),
    };
    let name = parameter.label();
    if has_run_away {
        return format!("{name}: not determined, 95 % interval {interval}");
    }
    format!(
        "{name} = {} ± {}{unit}, 95 % {interval}",
        in_digits(parameter.value * factor, digits),
        in_digits(parameter.uncertainty * factor, 2),
    )
}
