//! Holds of a fit or of a run: as objects, and in lines.

use serde_json::{Value, json};
use twinslip::fit::{Hold, Levels, healing_rate, holds_of};
use twinslip::number::Uncertain;
use twinslip_output::seven_digits;
use twinslip_tasks::scene::{FitPlan, HoldOfRun};
use twinslip_tasks::views::measured_healing;

/// Whether the load point is held in any record.
pub fn are_there(plan: &FitPlan) -> bool {
    let mut each = plan.recordings.iter();
    each.any(|own| !holds_of(&own.motion).is_empty())
}

/// `result.holds`; `several` with the number of the record.
pub fn object(holds: &[Hold], several: bool) -> Value {
    let each = holds.iter().map(|hold| {
        let mut object = levels(&hold.measured);
        object["start"] = json!(hold.start);
        object["duration"] = json!(hold.duration);
        object["fitted"] = levels(&hold.fitted);
        if several {
            object["record"] = json!(hold.record + 1);
        }
        object
    });
    each.collect()
}

fn levels(of: &Levels) -> Value {
    json!({
        "minimum": of.minimum.map(estimate),
        "peak": of.peak.map(estimate),
        "healing": of.healing.map(estimate),
    })
}

fn estimate(one: Uncertain) -> Value {
    let uncertainty = Some(one.uncertainty).filter(|x| x.is_finite());
    json!({ "value": one.value, "uncertainty": uncertainty })
}

/// `result.healing_rate`, per decade of the duration.
pub fn rate(holds: &[Hold]) -> Value {
    let fitted = holds
        .iter()
        .filter_map(|hold| Some((hold.duration, hold.fitted.healing?)));
    let mut object =
        measured_healing(holds).map_or(json!({ "value": null, "uncertainty": null }), estimate);
    object["fitted"] = json!(healing_rate(fitted).map(|one| one.value));
    object
}

/// `result.holds` of a run: friction coefficients as in a fit, without errors of measurement, and stresses.
pub fn of_run(holds: &[HoldOfRun]) -> Value {
    let each = holds.iter().map(|hold| {
        let (before, least) = hold.stress;
        let healing = hold.peak.map(|peak| peak - before);
        let friction = |stress: Option<f64>| {
            let value = stress.zip(hold.friction).map(|(x, by)| x * by);
            json!({ "value": value, "uncertainty": null })
        };
        json!({
            "start": hold.start,
            "duration": hold.duration,
            "minimum": friction(Some(least)),
            "peak": friction(hold.peak),
            "healing": friction(healing),
            "stress": { "before": before, "minimum": least, "peak": hold.peak, "healing": healing },
        })
    });
    each.collect()
}

/// The holds of a run in words, one a line.
pub fn run_in_words(holds: &[HoldOfRun]) -> Vec<String> {
    let each = holds.iter().map(|hold| {
        let (before, least) = hold.stress;
        let begun = format!(
            "hold of {} at {}: stress falls from {} to {}",
            seven_digits(hold.duration),
            seven_digits(hold.start),
            seven_digits(before),
            seven_digits(least)
        );
        let Some(peak) = hold.peak else {
            return format!("{begun}, and reaches no peak after it");
        };
        let healing = peak - before;
        let friction = hold.friction.map_or(String::new(), |by| {
            format!(", {} of friction", seven_digits(healing * by))
        });
        format!(
            "{begun}, peak {}, healing {}{friction}",
            seven_digits(peak),
            seven_digits(healing)
        )
    });
    let rate = healing_of_run(holds).map(|rate| {
        format!(
            "healing rate {} of friction per decade",
            seven_digits(rate.value)
        )
    });
    each.chain(rate).collect()
}

/// `result.healing_rate` of a run; its error is how far the holds are from a straight line.
pub fn rate_of_run(holds: &[HoldOfRun]) -> Value {
    json!(healing_of_run(holds).map(estimate))
}

fn healing_of_run(holds: &[HoldOfRun]) -> Option<Uncertain> {
    let healing = holds.iter().filter_map(|hold| {
        let value = (hold.peak? - hold.stress.0) * hold.friction?;
        let exact = Uncertain {
            value,
            uncertainty: 0.0,
        };
        Some((hold.duration, exact))
    });
    healing_rate(healing)
}

/// In words, one a line.
pub fn lines(holds: &[Hold], several: bool) -> Vec<String> {
    let told = |one: Option<Uncertain>| one.map_or("unknown".to_owned(), |one| one.to_string());
    let each = holds.iter().map(|hold| {
        let of = match several {
            true => format!(" in record {}", hold.record + 1),
            false => String::new(),
        };
        let seconds = seven_digits(hold.duration);
        let begun = format!("hold of {seconds} s at {} s{of}", seven_digits(hold.start));
        let Levels {
            minimum,
            peak,
            healing,
        } = hold.measured;
        format!(
            "{begun}: minimum {}, peak {}, healing {} (fitted {})",
            told(minimum),
            told(peak),
            told(healing),
            told(hold.fitted.healing)
        )
    });
    let rate = measured_healing(holds);
    each.chain(rate.map(|rate| format!("healing rate {} per decade", told(Some(rate)))))
        .collect()
}
