//! A plan in words: what is computed, how, and why the rest is not.

use super::estimate::Companion;
use super::plan::{Plan, Sampling, dimension_in_words, longest_in_words, tolerance_in_words};
use super::system::Described;
use super::units::Quantity;
use std::fmt::Write;
use twinslip::error::count;
use twinslip::integrate::HasSeries;

/// What the caller does with the rows, which the plan does not know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keeping {
    /// Rows leave as they come.
    Streamed,
    /// Rows are kept for a JSON object.
    Stored,
}

/// The plan, one subject a line.
pub fn explain(plan: &Plan, keeping: Keeping) -> String {
    let mut text = String::from("plan of this run\n");
    let mut line = |subject: &str, words: String| {
        writeln!(text, "  {subject:<18}{words}").expect("writing to a string");
    };
    line(
        "dimension",
        dimension_in_words(&plan.system, plan.subspace, &plan.start),
    );
    line("method", method(plan));
    if let Some(words) = plan.system.formulas_in_words() {
        line("formulas", words);
    }
    line(
        "tolerances",
        format!(
            "rtol {:e}, {}, at most {} steps{}",
            plan.tolerances.rtol,
            tolerance_in_words(&plan.system, plan.tolerances.atol, &plan.told_atol()),
            count(plan.max_steps),
            longest_in_words(plan.tolerances, plan.system.units())
        ),
    );
    line(
        "tangents",
        "off: no output asks for multipliers or exponents".into(),
    );
    if plan.system.slides() {
        line("driving", driving(plan));
    }
    line("dense output", dense(plan));
    if plan.system.slides() {
        line("slip", slip(plan));
        line("events", events(plan));
    }
    line("trajectory", trajectory(plan, keeping));
    line(
        "error estimate",
        match plan.estimate {
            Some(Companion::Tighter(second)) => format!(
                "on: twice the distance to a second run by auto with rtol {:e}, atol {:e}, and the rounding of the start by a tangent flow, at the end only",
                second.rtol, second.atol
            ),
            Some(Companion::Reference { .. }) => {
                "on: twice the distance to a second run in double-double arithmetic, and the rounding of the start by a tangent flow, at the end only"
                    .into()
            }
            None => "off: `estimate_error` is not given".into(),
        },
    );
    text
}

fn method(plan: &Plan) -> String {
    let name = plan.method.name();
    let reason = plan.method.reason();
    if plan.asked_method == name {
        format!("{name}, as asked for: {reason}")
    } else {
        format!("{name}, chosen by {}: {reason}", plan.asked_method)
    }
}

fn driving(plan: &Plan) -> String {
    let Some(program) = &plan.program else {
        return "constant: `program` is not given".into();
    };
    let changes = program.changes.len();
    let ramps = program.changes.iter().any(|change| change.until.is_some());
    format!(
        "{} {}, at each of which the integrator restarts{}",
        count(changes),
        if changes == 1 { "change" } else { "changes" },
        if ramps {
            "; along ramps V_H is an additional variable"
        } else {
            ""
        }
    )
}

fn dense(plan: &Plan) -> String {
    let mut why = Vec::new();
    if matches!(plan.sampling, Sampling::Points(_) | Sampling::Every(_)) {
        why.push("rows at fixed times");
    }
    if plan.needs_slip() {
        why.push("slip");
    }
    if plan.detected().is_some() {
        why.push("events");
    }
    if plan.picture {
        why.push("the picture");
    }
    if why.is_empty() {
        "off: rows are the ends of steps, and no slip is asked for".into()
    } else {
        format!("on: for {}", why.join(", "))
    }
}

fn slip(plan: &Plan) -> String {
    if !plan.needs_slip() {
        return "off: no slip column and no events asked for".into();
    }
    let how = match plan.method.series() {
        HasSeries::Always => "the series of the slip rates integrated term by term",
        HasSeries::Sometimes => {
            "the series of the slip rates integrated term by term; five-point quadrature along the steps that have none"
        }
        HasSeries::Never => "five-point quadrature of the slip rates along every step",
    };
    format!("on: {how}")
}

fn events(plan: &Plan) -> String {
    let Some(threshold) = plan.detected() else {
        return "off: `events` is not given".into();
    };
    let how = location(plan.method.series());
    let why = match plan.events {
        Some(_) => "",
        None => ", for the summary",
    };
    format!("on: slip faster than V_H whose peak exceeds {threshold} V_H, by {how}{why}")
}

fn location(series: HasSeries) -> &'static str {
    match series {
        HasSeries::Always => "the roots of the series' polynomials",
        HasSeries::Sometimes => {
            "the roots of the series' polynomials; root finding on the dense output of the steps that have none"
        }
        HasSeries::Never => "root finding on the dense output",
    }
}

fn trajectory(plan: &Plan, keeping: Keeping) -> String {
    let unit = match plan.system.units().name(Quantity::Time) {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let rows = match plan.sampling {
        Sampling::FinalOnly if plan.observed() => {
            return "off: only the final state is requested; steps are observed only for slip"
                .into();
        }
        Sampling::FinalOnly => {
            return "off: only the final state is requested, and no output needs the steps".into();
        }
        Sampling::EveryStep => "a row at every step".to_owned(),
        Sampling::Points(n) => format!("{n} rows equally spaced in time"),
        Sampling::Every(dt) => format!("a row every {dt}{unit}"),
    };
    let rows = match keeping {
        Keeping::Streamed => format!("not stored: {rows}, written as it comes"),
        Keeping::Stored => format!("stored: {rows}, for the JSON object"),
    };
    if plan.picture {
        format!("{rows}; the points of the picture are stored")
    } else {
        rows
    }
}
