//! Diagrams of branches, and of curves, in any parameters.

use super::diagram::{axis_label, symmetry_colour, symmetry_name, value};
use super::labels::{colour_name, distinct, meanings_of, named_strokes, with_hopf_points};
use crate::scene::{
    Free, GeneralBranchPlan, GeneralLocusPlan, GeneralRow, Quantity, RowKind, Subject, Units,
    symbol_of_state,
};
use twinslip::bifurcation::Label;
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip_output::plot::{Axis, Drawing, Key, Mark, Panel, PlotSeries, Stroke};

/// The axis of a parameter: logarithmic where its range spans more than a factor of ten.
fn axis(free: &Free, units: &Units) -> Axis {
    /// Of the ends of a range that is shown by its logarithm.
    const RATIO: f64 = 10.0;
    let (low, high) = (
        free.range.0.min(free.range.1),
        free.range.0.max(free.range.1),
    );
    let name = axis_label(symbol(free.name), free.quantity, units);
    if low > 0.0 && high > RATIO * low {
        Axis::log(name)
    } else {
        Axis::linear(name)
    }
}

/// The axis of what is drawn: logarithmic where all of it is positive, and is so by nature or spans more than a factor of a hundred.
fn value_axis(name: &str, quantity: Quantity, series: &[PlotSeries], units: &Units) -> Axis {
    /// Of the ends of what is shown by its logarithm.
    const RATIO: f64 = 100.0;
    let values = series.iter().flat_map(|one| one.y.iter().copied());
    let (low, high) = values
        .filter(|y| y.is_finite())
        .fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), y| {
            (low.min(y), high.max(y))
        });
    let positive = matches!(
        quantity,
        Quantity::SlipRate | Quantity::State | Quantity::Time
    );
    let name = axis_label(name, quantity, units);
    if low > 0.0 && (positive || high > RATIO * low) {
        Axis::log(name)
    } else {
        Axis::linear(name)
    }
}

/// V_H and K by their symbols, all else by its name.
fn symbol(name: &str) -> &str {
    match name {
        "driving" => "V_H",
        "stiffness" => "K",
        other => other,
    }
}

/// Whether it is interfaces: what has V_H and K.
fn slides(subject: &dyn Subject) -> bool {
    let parameters = subject.parameters();
    let has = |wanted: &str| parameters.iter().any(|(name, _)| *name == wanted);
    has("driving") && has("stiffness")
}

/// What rows tell, of interfaces by its symbol: `ψ_1` for state_1. The states of another system have the names that its file gives them.
fn symbol_of(name: &str, subject: &dyn Subject) -> String {
    if !slides(subject) {
        return name.to_owned();
    }
    symbol_of_state(name).unwrap_or_else(|| symbol(name).to_owned())
}

/// What is drawn, and at which values of what every row tells though it is held, or else of all parameters.
fn title(what: &str, subject: &dyn Subject, free: &[Free]) -> String {
    /// More of these would hide what is drawn.
    const MOST: usize = 8;
    let mut told = match subject.always_told() {
        none if none.is_empty() => subject.parameters(),
        told => told,
    };
    if slides(subject) {
        told.retain(|(name, _)| ["driving", "stiffness"].contains(name));
    }
    let told = told.into_iter();
    let held = told.filter(|(name, _)| free.iter().all(|free| free.name != *name));
    let held = held.take(MOST);
    let held = held.filter_map(|(name, quantity)| {
        let held = subject.value(name).ok()?;
        Some(value(symbol(name), quantity, held, subject.units()))
    });
    match held.collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => what.to_owned(),
        held => format!("{what} at {held}"),
    }
}

/// The colour of a branch or curve: by how equal interfaces move on it, or one of its own.
fn colour_of(branch: &[GeneralRow]) -> usize {
    let symmetries = || branch.iter().filter_map(|row| row.symmetry);
    if symmetries().any(|symmetry| symmetry == Symmetry::Asymmetric) {
        return symmetry_colour(Symmetry::Asymmetric);
    }
    match symmetries().next() {
        Some(symmetry) => symmetry_colour(symmetry),
        None => branch[0].number,
    }
}

/// The legend of the colours, where there are several: `what` with a number where interfaces do not differ in how they move.
fn colour_names(rows: &[GeneralRow], what: &str) -> Vec<PlotSeries> {
    /// More branches than this have no names.
    const MOST: usize = 8;
    let branches = rows.chunk_by(|a, b| a.number == b.number);
    let mut colours: Vec<usize> = branches.map(colour_of).collect();
    colours.sort_unstable();
    colours.dedup();
    if !(2..=MOST).contains(&colours.len()) {
        return Vec::new();
    }
    let symmetric = rows.iter().any(|row| row.symmetry.is_some());
    let name = |colour: usize| match symmetric {
        true => colour_name(symmetry_name(colour), colour),
        false => colour_name(format!("{what} {}", colour + 1), colour),
    };
    colours.into_iter().map(name).collect()
}

/// A number of every row against the parameter, stable parts solid, all others dashed; branches in colours of their own.
pub fn general_lines(
    rows: &[GeneralRow],
    x: &dyn Fn(&GeneralRow) -> f64,
    y: &dyn Fn(&GeneralRow) -> f64,
) -> Vec<PlotSeries> {
    let mut series = Vec::new();
    for branch in rows.chunk_by(|a, b| a.number == b.number) {
        for stable in [true, false] {
            let belongs = |pair: &[GeneralRow]| solid(&pair[0], &pair[1]) == stable;
            if !branch.windows(2).any(belongs) {
                continue;
            }
            let stroke = if stable {
                Stroke::Solid
            } else {
                Stroke::Dashed
            };
            let (xs, ys) = (branch.iter().map(x), branch.iter().map(y));
            series.push(PlotSeries {
                left_out: branch.windows(2).map(|pair| !belongs(pair)).collect(),
                ..PlotSeries::new("", xs.collect(), ys.collect())
                    .stroke(stroke)
                    .colour(colour_of(branch))
            });
        }
    }
    series
}

/// Between two points: stable if one is, and the other is, or is a bifurcation.
fn solid(a: &GeneralRow, b: &GeneralRow) -> bool {
    let verdicts = [a.verdict, b.verdict];
    verdicts.contains(&Some(Verdict::Stable)) && !verdicts.contains(&Some(Verdict::Unstable))
}

fn marks(
    rows: &[GeneralRow],
    x: &dyn Fn(&GeneralRow) -> f64,
    y: &dyn Fn(&GeneralRow) -> f64,
    named: bool,
) -> Vec<Mark> {
    let special = rows.iter().filter_map(|row| {
        let label = row.label.filter(|&label| label != Label::Ep)?;
        Some((label, x(row), y(row)))
    });
    distinct(special, named)
}

/// The legend of the points of a picture.
fn keys(rows: &[GeneralRow]) -> Vec<Key> {
    let named = rows
        .iter()
        .filter_map(|row| Some((row.label?, row.meaning()?)));
    meanings_of(named)
}

/// What there is to draw of rows: the names and places of numbers, of orbits the least and the largest together.
fn drawn(subject: &dyn Subject, kind: RowKind) -> Vec<(String, Quantity, Vec<usize>)> {
    let numbers = subject.numbers(kind);
    if !kind.orbits {
        // An equilibrium has no least and largest.
        let range = |name: &str| name.ends_with("_min") || name.ends_with("_max");
        let all = numbers.into_iter().enumerate();
        let all = all.filter(|(_, (name, _))| !range(name));
        return all
            .map(|(i, (name, quantity))| (symbol_of(&name, subject), quantity, vec![i]))
            .collect();
    }
    let mut pairs = Vec::new();
    for (i, (name, quantity)) in numbers.iter().enumerate() {
        if let Some(name) = name.strip_suffix("_min") {
            let title = format!("least and largest {}", symbol_of(name, subject));
            pairs.push((title, *quantity, vec![i, i + 1]));
        }
    }
    pairs
}

/// A Hopf point as a row of orbits with so many numbers, of which the least and the largest are one.
fn at_hopf(special: &GeneralRow, numbers: usize) -> Option<GeneralRow> {
    let mut row = (special.label == Some(Label::Hb)).then(|| special.clone())?;
    if 2 * row.numbers.len() == numbers {
        row.numbers = row.numbers.iter().flat_map(|&x| [x, x]).collect();
    }
    (row.numbers.len() == numbers).then_some(row)
}

/// Every number against the parameter, and the period of orbits.
pub fn general_branches(
    rows: &[GeneralRow],
    special: &[GeneralRow],
    plan: &GeneralBranchPlan<'_>,
) -> Drawing {
    /// So many numbers at most, in so many columns.
    const MOST: usize = 6;
    let units = plan.subject.units();
    let x = |row: &GeneralRow| units.outward(plan.free.quantity, row.parameters[0].value);
    let what = if plan.kind.orbits {
        "orbits"
    } else {
        "equilibria"
    };
    let numbers = plan.subject.numbers(plan.kind).len();
    let rows = &match plan.kind.orbits {
        true => {
            let number = |row: &GeneralRow| row.number;
            with_hopf_points(rows, special, (number, number), |one| at_hopf(one, numbers))
        }
        false => rows.to_vec(),
    };
    let mut panels = Vec::new();
    let all = drawn(plan.subject, plan.kind);
    let what = match all.len() {
        count if count > MOST => &format!("{what}, the first {MOST} of {count} states,"),
        _ => what,
    };
    let all = all.into_iter().take(MOST);
    for (number, (name, quantity, places)) in all.enumerate() {
        let (mut series, mut points) = (Vec::new(), Vec::new());
        for (k, &i) in places.iter().enumerate() {
            let y = |row: &GeneralRow| units.outward(quantity, row.numbers[i]);
            series.extend(general_lines(rows, &x, &y));
            points.extend(marks(rows, &x, &y, k + 1 == places.len()));
        }
        let first = if number == 0 {
            title(what, plan.subject, std::slice::from_ref(&plan.free))
        } else {
            String::new()
        };
        let vertical = value_axis(&name, quantity, &series, units);
        panels.push(Panel {
            strokes: if number == 0 {
                named_strokes(&series)
            } else {
                Vec::new()
            },
            keys: if number == 0 {
                keys(special)
            } else {
                Vec::new()
            },
            series: match number {
                0 => [colour_names(rows, "branch"), series].concat(),
                _ => series,
            },
            marks: points,
            ..Panel::new(first, axis(&plan.free, units), vertical)
        });
    }
    if plan.kind.orbits {
        let period = |row: &GeneralRow| {
            let period = row.period.map_or(f64::NAN, |period| period.value);
            units.outward(Quantity::Time, period)
        };
        let series = general_lines(rows, &x, &period);
        let vertical = value_axis("period", Quantity::Time, &series, units);
        panels.push(Panel {
            series,
            marks: marks(rows, &x, &period, true),
            ..Panel::new("", axis(&plan.free, units), vertical)
        });
    }
    let half = panels.len().div_ceil(2);
    let second = panels.split_off(half);
    Drawing::columns(
        [panels, second]
            .into_iter()
            .filter(|part| !part.is_empty())
            .collect(),
    )
}

/// The second parameter against the first; where multipliers have an angle, that beside it.
pub fn general_curves(
    rows: &[GeneralRow],
    special: &[GeneralRow],
    plan: &GeneralLocusPlan<'_>,
) -> Drawing {
    let units = plan.subject.units();
    let of = |i: usize| {
        let quantity = plan.free[i].quantity;
        move |row: &GeneralRow| units.outward(quantity, row.parameters[i].value)
    };
    let (x, y) = (of(0), of(1));
    let series = |y: &dyn Fn(&GeneralRow) -> f64| -> Vec<PlotSeries> {
        let curves = rows.chunk_by(|a, b| a.number == b.number);
        curves
            .map(|curve| {
                let (xs, ys) = (curve.iter().map(&x), curve.iter().map(y));
                PlotSeries::new("", xs.collect(), ys.collect()).colour(colour_of(curve))
            })
            .collect()
    };
    let plane = Panel {
        series: [colour_names(rows, "curve"), series(&y)].concat(),
        marks: marks(special, &x, &y, true),
        keys: keys(special),
        ..Panel::new(
            title(plan.choice.title, plan.subject, &plan.free),
            axis(&plan.free[0], units),
            axis(&plan.free[1], units),
        )
    };
    if rows.iter().all(|row| row.angle_over_pi.is_none()) {
        return Drawing::columns(vec![vec![plane]]);
    }
    let angle = |row: &GeneralRow| row.angle_over_pi.unwrap_or(f64::NAN);
    let second = Panel {
        series: series(&angle),
        marks: marks(rows, &x, &angle, true),
        ..Panel::new(
            "angle θ of the multipliers",
            axis(&plan.free[0], units),
            Axis::linear("θ/π"),
        )
    };
    Drawing::columns(vec![vec![plane], vec![second]])
}
