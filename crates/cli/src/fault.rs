//! The summary of a run of a fault, as an object and as a line.

use super::words::several;
use serde_json::{Value, json};
use twinslip_tasks::scene::{FaultSummary, Quantity, Spread, Units};

/// The object `result.summary`.
pub fn object(fault: &FaultSummary) -> Value {
    let spread = |spread: Option<Spread>| {
        spread.map(|spread| json!({"mean": spread.mean, "min": spread.least, "max": spread.most}))
    };
    json!({
        "critical_stiffness": fault.criticality.map(|critical| critical.stiffness),
        "stiffness_ratio": fault.criticality.and_then(|critical| critical.ratio),
        "events": fault.events,
        "recurrence": spread(fault.recurrence),
        "stress_drop": spread(fault.stress_drop),
        "first_event_left_out": fault.first_left_out,
        "peak_slip_rate": fault.peak_slip_rate,
    })
}

/// `k_c = 2.1e6 Pa/m, k/k_c = 0.5; 12 events: mean recurrence 87 year (85 to 90), ...`.
pub fn line(fault: &FaultSummary, units: &Units) -> String {
    let name = |quantity| units.name(quantity);
    let mut parts = Vec::new();
    if let Some(critical) = fault.criticality {
        let stiffness = digits(critical.stiffness);
        let unit = name(Quantity::Stiffness);
        parts.push(match critical.ratio {
            Some(ratio) => format!("k_c = {stiffness} {unit}, k/k_c = {}", digits(ratio)),
            None => format!("k_c = {stiffness} {unit}, steady sliding on any spring"),
        });
    }
    let mut events = match fault.events {
        0 => "no complete event".to_owned(),
        events => several(events, "event", "events"),
    };
    let mut found = Vec::new();
    let without_first = match fault.first_left_out {
        true => "mean stress drop without the first event",
        false => "mean stress drop",
    };
    for (what, spread, quantity) in [
        ("mean recurrence", fault.recurrence, Quantity::Time),
        (without_first, fault.stress_drop, Quantity::Stress),
    ] {
        let Some(Spread { mean, least, most }) = spread else {
            continue;
        };
        let mut text = format!("{what} {} {}", digits(mean), name(quantity));
        if least < most {
            text += &format!(" ({} to {})", digits(least), digits(most));
        }
        found.push(text);
    }
    if let Some(peak) = fault.peak_slip_rate {
        let unit = name(Quantity::SlipRate);
        found.push(format!("peak slip rate {} {unit}", digits(peak)));
    }
    if !found.is_empty() {
        events += &format!(": {}", found.join(", "));
    }
    parts.push(events);
    parts.join("; ")
}

/// At most four digits.
fn digits(x: f64) -> String {
    let rounded: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    match rounded.abs() {
        size if size == 0.0 || (1e-3..1e5).contains(&size) => format!("{rounded}"),
        _ => format!("{rounded:e}"),
    }
}
