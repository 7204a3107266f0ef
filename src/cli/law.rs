//! `twinslip law`.

use super::report::{self, Report, unit_names};
use super::{Ending, say, written};
use crate::error::{Error, Result};
use crate::friction::{
    Extremum, ExtremumKind, Law, critical_stiffness, critical_stiffness_maximum, positive,
    steady_stress,
};
use crate::number::Uncertain;
use crate::output::{Cell, Format, RowList, object, plot};
use crate::scene::{LawOptions, Quantity, System};
use serde_json::{Value, json};

/// The grid where none is given.
const GRID: (f64, f64) = (1e-3, 1e6);

const COLUMNS: [(&str, Quantity); 5] = [
    ("slip_rate", Quantity::SlipRate),
    ("stress", Quantity::Stress),
    ("friction", Quantity::Number),
    ("state", Quantity::State),
    ("critical_stiffness", Quantity::Stiffness),
];

pub fn run(options: &LawOptions, words: &[String]) -> Result<Ending> {
    let system = System::new(&options.model)?;
    let grid = grid(options, &system)?;
    if let Some(path) = &options.plot {
        plot::PictureFormat::of(path)?;
    }
    let plots: Vec<&std::path::Path> = options.plot.as_deref().into_iter().collect();
    let report = Report::new(&options.output, words, &plots)?;
    if options.output.explain {
        report_plan(&grid);
    }
    let rows = rows(&system, &grid);
    if let Some(path) = &options.plot {
        let drawing = picture(&system, &rows)?;
        plot::write(path, &drawing)?;
    }
    write(&report, &system, &rows)
}

fn report_plan(grid: &[f64]) {
    say(format_args!(
        "plan of this command\n  {} closed formulas at {} slip rates; extrema enclosed by interval arithmetic; no integration",
        COLUMNS.len() - 1,
        grid.len()
    ));
}

/// Slip rates equally spaced in ln V, dimensionless.
fn grid(options: &LawOptions, system: &System) -> Result<Vec<f64>> {
    let end = |name, value: Option<f64>, default: f64| match value {
        Some(v) => Ok(system.units.inward(Quantity::SlipRate, positive(name, v)?)),
        None => Ok(default),
    };
    let from = end("from", options.from, GRID.0)?;
    let to = end("to", options.to, GRID.1)?;
    if from >= to {
        return Err(Error::Input("--from must be less than --to".into()));
    }
    let n = options.points;
    if !(2..=10_000_000).contains(&n) {
        return Err(Error::parameter("points", n, "from 2 to 1e7"));
    }
    let ratio = (to / from).ln();
    Ok((0..n)
        .map(|i| match i {
            0 => from,
            _ if i + 1 == n => to,
            _ => from * (ratio * i as f64 / (n - 1) as f64).exp(),
        })
        .collect())
}

fn rows(system: &System, grid: &[f64]) -> RowList {
    let (law, units) = (&system.law, &system.units);
    let mut rows = RowList::new(COLUMNS.map(|(name, _)| name.to_owned()).into());
    for &v in grid {
        let stress = steady_stress(law, v);
        let values = [
            v,
            stress,
            system.direct_effect * stress,
            law.steady_state(v),
            critical_stiffness(law, v),
        ];
        let outward = COLUMNS
            .iter()
            .zip(values)
            .map(|((_, quantity), x)| units.outward(*quantity, x));
        rows.numbers.extend(outward);
    }
    rows
}

/// Extrema and the maximum of k_c, in the user's units.
fn landmarks(system: &System) -> Result<(Vec<Value>, Value)> {
    let out = |quantity, x| report::uncertain(&system.units, quantity, x);
    let extrema = Extremum::all(&system.law)
        .iter()
        .map(|extremum| {
            json!({
                "kind": kind(extremum.kind),
                "slip_rate": out(Quantity::SlipRate, extremum.slip_rate),
                "stress": out(Quantity::Stress, extremum.stress),
            })
        })
        .collect();
    let maximum = critical_stiffness_maximum(&system.law)?.map(|maximum| {
        json!({
            "slip_rate": out(Quantity::SlipRate, maximum.slip_rate),
            "stiffness": out(Quantity::Stiffness, maximum.stiffness),
        })
    });
    Ok((extrema, json!(maximum)))
}

fn kind(kind: ExtremumKind) -> &'static str {
    match kind {
        ExtremumKind::Maximum => "maximum",
        ExtremumKind::Minimum => "minimum",
    }
}

fn write(report: &Report<'_>, system: &System, rows: &RowList) -> Result<Ending> {
    let (extrema, maximum) = landmarks(system)?;
    let transition = system
        .law
        .transition_rate()
        .map(|v| system.units.outward(Quantity::SlipRate, v));
    if report.format == Format::Json {
        let rows: Vec<Value> = rows
            .iter()
            .map(|row| Value::Object(object(&rows.columns, row)))
            .collect();
        let result = json!({
            "extrema": extrema,
            "critical_stiffness_maximum": maximum,
            "transition_rate": transition,
            "rows": rows,
        });
        let work = json!({"evaluations": rows.len()});
        let bytes = report.envelope(system, json!({}), result, work, None);
        return written(report.place.write(&bytes), &report.place);
    }
    let mut remarks = report.remarks(system, &Value::Null);
    let found = landmark_lines(&extrema, &maximum, transition);
    remarks.extend(found.iter().cloned());
    let units = unit_names(&system.units, COLUMNS.iter().map(|(_, quantity)| *quantity));
    let all = report
        .begin(remarks, &rows.columns, &units)
        .and_then(|mut writer| {
            let mut cells = Vec::new();
            rows.iter().try_for_each(|row| {
                cells.clear();
                cells.extend(row.iter().map(|&x| Cell::Number(x)));
                writer.row(&cells)
            })
        });
    let ending = report.ended(written(all, &report.place))?;
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

fn picture(system: &System, rows: &RowList) -> Result<plot::Drawing> {
    let column = |name: &str| rows.column(name).unwrap_or_default();
    let out = |quantity, x| system.units.outward(quantity, x);
    let unit = |quantity| system.units.short_name(quantity);
    let marks = Extremum::all(&system.law)
        .iter()
        .map(|extremum| {
            let (name, side) = match extremum.kind {
                ExtremumKind::Maximum => ("maximum V_M", plot::Side::Above),
                ExtremumKind::Minimum => ("minimum V_m", plot::Side::Below),
            };
            let at = out(Quantity::SlipRate, extremum.slip_rate.value);
            let friction = system.direct_effect * extremum.stress.value;
            plot::Mark::new(at, friction, name).side(side)
        })
        .collect();
    let x = plot::Axis::log(format!("slip rate V [{}]", unit(Quantity::SlipRate)));
    let coefficient = plot::Axis::linear("friction coefficient τₛₛ/σ");
    let friction = plot::Panel {
        series: vec![plot::PlotSeries::new(
            "",
            column("slip_rate"),
            column("friction"),
        )],
        marks,
        ..plot::Panel::new("steady-state friction", x.clone(), coefficient)
    };
    let top = critical_stiffness_maximum(&system.law)?.map(|maximum| {
        let at = out(Quantity::SlipRate, maximum.slip_rate.value);
        let stiffness = out(Quantity::Stiffness, maximum.stiffness.value);
        plot::Mark::new(at, stiffness, "maximum").side(plot::Side::Above)
    });
    let title = "critical stiffness: a stiffer single interface slides steadily";
    let unit = unit(Quantity::Stiffness);
    let critical = plot::Axis::linear(format!("critical stiffness k_c [{unit}]"));
    let stiffness = plot::Panel {
        series: vec![plot::PlotSeries::new(
            "",
            column("slip_rate"),
            from_above(column("critical_stiffness")),
        )],
        marks: top.into_iter().collect(),
        zero_line: true,
        ..plot::Panel::new(title, x, critical)
    };
    Ok(plot::Drawing::columns(vec![vec![friction, stiffness]]))
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
