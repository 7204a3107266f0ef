//! `twinslip law`.

use super::report::{self, Report};
use super::text;
use super::{Ending, say, written};
use crate::error::{Error, Result};
use crate::friction::ExtremumKind;
use crate::number::Uncertain;
use crate::output::{Format, plot};
use crate::scene::{
    Column, Described, LawLandmarks, LawOptions, LawPlan, LawPoint, Quantity, TextModel, Units,
};
use crate::views;
use serde_json::{Value, json};

pub fn run(options: &LawOptions, words: &[String]) -> Result<Ending> {
    match TextModel::of(&options.model, &["driving", "stiffness"])? {
        Some(model) if model.slab.is_some() => return text::law::run(options, model, words),
        _ => {}
    }
    let plan = LawPlan::new(options)?;
    let report = begun(options, words, || plan.explain())?;
    let (points, landmarks) = (plan.points(), plan.landmarks()?);
    let (system, curve) = (&plan.system, (points.as_slice(), &landmarks));
    if let Some(path) = &options.plot {
        let drawing = picture(&system.units, Some(system.direct_effect), curve);
        plot::write(path, &drawing)?;
    }
    write(&report, system, &views::law_columns(), curve, None)
}

/// Checks where results and pictures go, and says what will be computed.
pub fn begun<'a>(
    options: &LawOptions,
    words: &'a [String],
    explain: impl FnOnce() -> String,
) -> Result<Report<'a>> {
    if let Some(path) = &options.plot {
        plot::PictureFormat::of(path)?;
    }
    let plots: Vec<&std::path::Path> = options.plot.as_deref().into_iter().collect();
    let report = Report::new(&options.output, words, &plots)?;
    if options.output.explain {
        say(explain());
    }
    Ok(report)
}

/// Extrema and the maximum of k_c, in the user's units.
fn objects(landmarks: &LawLandmarks, units: &Units) -> (Vec<Value>, Value) {
    let out = |quantity, x| report::uncertain(units, quantity, x);
    let extrema = landmarks.extrema.iter().map(|extremum| {
        json!({
            "kind": kind(extremum.kind),
            "slip_rate": out(Quantity::SlipRate, extremum.slip_rate),
            "stress": out(Quantity::Stress, extremum.stress),
        })
    });
    let maximum = landmarks.critical_stiffness_maximum.map(|maximum| {
        json!({
            "slip_rate": out(Quantity::SlipRate, maximum.slip_rate),
            "stiffness": out(Quantity::Stiffness, maximum.stiffness),
        })
    });
    (extrema.collect(), json!(maximum))
}

fn kind(kind: ExtremumKind) -> &'static str {
    match kind {
        ExtremumKind::Maximum => "maximum",
        ExtremumKind::Minimum => "minimum",
    }
}

pub fn write<R>(
    report: &Report<'_>,
    system: &dyn Described,
    columns: &[Column<R>],
    (points, landmarks): (&[R], &LawLandmarks),
    failure: Option<&Error>,
) -> Result<Ending> {
    let units = system.units();
    let (extrema, maximum) = objects(landmarks, units);
    let transition = landmarks
        .transition_rate
        .map(|v| units.outward(Quantity::SlipRate, v));
    if report.format == Format::Json {
        let rows = points.iter();
        let rows: Vec<Value> = rows
            .map(|point| Value::Object(views::object(columns, point, units)))
            .collect();
        let result = json!({
            "extrema": extrema,
            "critical_stiffness_maximum": maximum,
            "transition_rate": transition,
            "rows": rows,
        });
        let work = json!({"evaluations": points.len()});
        let bytes = report.envelope(system, json!({}), result, work, failure);
        return written(report.place.write(&bytes), &report.place);
    }
    let found = landmark_lines(&extrema, &maximum, transition);
    let mut remarks = report.remarks(system, &Value::Null);
    remarks.extend(found.iter().cloned());
    let ending = report.write_all(units, remarks, columns, points)?;
    found.iter().for_each(|line| report.say(line));
    Ok(ending)
}

/// The landmarks in words.
fn landmark_lines(extrema: &[Value], maximum: &Value, transition: Option<f64>) -> Vec<String> {
    let pair = |x: &Value| {
        let number = |name: &str| x[name].as_f64();
        match (number("value"), number("uncertainty")) {
            (Some(value), Some(uncertainty)) => Uncertain::new(value, uncertainty).to_string(),
            (Some(value), None) => format!("{value:e}, no digit of which is certain"),
            (None, _) => "unknown".to_owned(),
        }
    };
    let mut lines: Vec<String> = extrema
        .iter()
        .map(|extremum| {
            format!(
                "{} of stress at slip_rate {}, stress {}",
                extremum["kind"].as_str().unwrap_or_default(),
                pair(&extremum["slip_rate"]),
                pair(&extremum["stress"])
            )
        })
        .collect();
    if !maximum.is_null() {
        lines.push(format!(
            "maximum of critical_stiffness at slip_rate {}, stiffness {}",
            pair(&maximum["slip_rate"]),
            pair(&maximum["stiffness"])
        ));
    }
    lines.extend(
        transition.map(|v| format!("high-velocity strengthening sets in at slip_rate {v}")),
    );
    lines
}

/// tau_ss, as a coefficient of friction where a is known, and k_c against V.
pub fn picture(
    units: &Units,
    direct_effect: Option<f64>,
    (points, landmarks): (&[LawPoint], &LawLandmarks),
) -> plot::Drawing {
    let scale = direct_effect.unwrap_or(1.0);
    let out = |quantity, x| units.outward(quantity, x);
    let unit = |quantity| units.short_name(quantity);
    let each = |number: &dyn Fn(&LawPoint) -> f64| points.iter().map(number).collect::<Vec<f64>>();
    let slip_rates = each(&|at| out(Quantity::SlipRate, at.slip_rate));
    let marks = landmarks.extrema.iter().map(|extremum| {
        let (name, side) = match extremum.kind {
            ExtremumKind::Maximum => ("maximum V_M", plot::Side::Above),
            ExtremumKind::Minimum => ("minimum V_m", plot::Side::Below),
        };
        let at = out(Quantity::SlipRate, extremum.slip_rate.value);
        let friction = scale * extremum.stress.value;
        plot::Mark::new(at, friction, name).side(side)
    });
    let x = plot::Axis::log(format!("slip rate V [{}]", unit(Quantity::SlipRate)));
    let coefficient = plot::Axis::linear(match direct_effect {
        Some(_) => "friction coefficient τₛₛ/σ",
        None => "steady stress τₛₛ",
    });
    let friction = each(&|at| scale * at.stress);
    let curve = plot::PlotSeries::new("", slip_rates.clone(), friction);
    let friction = plot::Panel {
        series: vec![curve],
        marks: marks.collect(),
        ..plot::Panel::new("steady-state friction", x.clone(), coefficient)
    };
    let top = landmarks.critical_stiffness_maximum.map(|maximum| {
        let at = out(Quantity::SlipRate, maximum.slip_rate.value);
        let stiffness = out(Quantity::Stiffness, maximum.stiffness.value);
        plot::Mark::new(at, stiffness, "maximum").side(plot::Side::Above)
    });
    let title = "critical stiffness: a stiffer single interface slides steadily";
    let unit = unit(Quantity::Stiffness);
    let critical = plot::Axis::linear(format!("critical stiffness k_c [{unit}]"));
    let stiffness = each(&|at| out(Quantity::Stiffness, at.critical_stiffness));
    let curve = plot::PlotSeries::new("", slip_rates, from_above(stiffness));
    let stiffness = plot::Panel {
        series: vec![curve],
        marks: top.into_iter().collect(),
        zero_line: true,
        ..plot::Panel::new(title, x, critical)
    };
    plot::Drawing::columns(vec![vec![friction, stiffness]])
}

/// Without its far negative part: where a law strengthens, k_c falls without bound and only says that all is stable.
fn from_above(mut stiffness: Vec<f64>) -> Vec<f64> {
    let top = stiffness.iter().copied().fold(0.0, f64::max);
    if top > 0.0 {
        for k in &mut stiffness {
            if *k < -top {
                *k = f64::NAN;
            }
        }
    }
    stiffness
}
