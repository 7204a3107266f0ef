//! Bifurcation diagrams, and curves in the plane of V_H and K.

use super::labels::{colour_name, distinct, meanings, named_strokes, with_hopf_points};
use crate::scene::{BranchParameter, Quantity, System, Units};
use twinslip::bifurcation::{BranchRow, Label, LocusRow, Parameter, Special};
use twinslip::equilibrium::{Solver, Symmetry, Verdict, steady_states};
use twinslip::orbit::InterfaceSystem;
use twinslip_output::plot::{Axis, Drawing, Mark, Panel, PlotSeries, Stroke};
use twinslip_output::seven_digits;

/// Colours of branches on which both interfaces move alike, and of the others.
const ALIKE: usize = 0;
const APART: usize = 1;

/// A Hopf point as a row of orbits, of which the least and the largest stress are one.
fn at_hopf(special: &Special, slab: &InterfaceSystem) -> Option<BranchRow> {
    let symmetry = special.symmetry.filter(|_| special.label == Label::Hb)?;
    let driving = special.driving.value;
    let found = steady_states(&slab.law, driving, slab.interfaces, Solver::Newton).ok()?;
    let mut all = found.equilibria.iter();
    let there = all.find(|one| one.symmetry == symmetry)?;
    let [first, last] = [0, there.log_state.len() - 1];
    Some(BranchRow {
        branch: special.branch,
        symmetry,
        driving,
        stiffness: special.stiffness.value,
        stress: there.stress.value,
        stress_range: (there.stress.value, there.stress.value),
        period: special.period.map(|period| period.value),
        state: [first, last].map(|i| there.log_state[i].exp()),
        slip_rate: [first, last].map(|i| there.slip_rate[i]),
        ln_abs_multiplier: [None; 2],
        verdict: Verdict::Undecided,
        label: Some(Label::Hb),
        equilibrium: None,
    })
}

/// Stress against the parameter, of orbits the least and the largest, with the period beside and the Hopf points at their ends.
pub fn branches(
    rows: &[BranchRow],
    special: &[Special],
    along: &BranchParameter,
    slab: &InterfaceSystem,
    system: &System,
) -> Drawing {
    let units = &system.units;
    let orbits = rows.iter().any(|row| row.period.is_some());
    let rows = &match orbits {
        true => {
            let numbers = (|row: &BranchRow| row.branch, |one: &Special| one.branch);
            with_hopf_points(rows, special, numbers, |one| at_hopf(one, slab))
        }
        false => rows.to_vec(),
    };
    let stress = |x| units.outward(Quantity::Stress, x);
    let least = |row: &BranchRow| stress(row.stress_range.0);
    let most = |row: &BranchRow| stress(row.stress_range.1);
    let at = |row: &BranchRow| along.of(row.driving, row.stiffness, units);
    let mut series = branch_lines(rows, &at, &most, true);
    let mut points = marks(rows, &at, &most, true);
    if orbits {
        series.extend(branch_lines(rows, &at, &least, false));
        points.extend(marks(rows, &at, &least, false));
    }
    let symbol = match along.parameter {
        Parameter::Driving => "V_H",
        Parameter::Stiffness => "K",
    };
    let x = Axis::log(axis_label(symbol, along.quantity, units));
    let (what, tau) = if orbits {
        ("orbits", "least and largest stress τ")
    } else {
        ("equilibria", "stress τ")
    };
    let first = Panel {
        strokes: named_strokes(&series),
        series,
        marks: points,
        keys: meanings(rows.iter().filter_map(|row| row.label)),
        ..Panel::new(
            format!("{what} at {}", fixed(along, slab, units)),
            x.clone(),
            Axis::linear(axis_label(tau, Quantity::Stress, units)),
        )
    };
    if !orbits {
        return Drawing::columns(vec![vec![first]]);
    }
    let period = |row: &BranchRow| {
        let period = row.period.unwrap_or(f64::NAN);
        units.outward(Quantity::Time, period)
    };
    let second = Panel {
        series: branch_lines(rows, &at, &period, false),
        marks: marks(rows, &at, &period, true),
        ..Panel::new(
            format!("period at {}", fixed(along, slab, units)),
            x,
            Axis::log(axis_label("period", Quantity::Time, units)),
        )
    };
    Drawing::columns(vec![vec![first], vec![second]])
}

/// The parameter that stays fixed, with its value.
pub(super) fn fixed(along: &BranchParameter, slab: &InterfaceSystem, units: &Units) -> String {
    match along.parameter {
        Parameter::Driving => value("K", Quantity::Stiffness, slab.loading.stiffness, units),
        Parameter::Stiffness => value("V_H", Quantity::SlipRate, slab.loading.driving, units),
    }
}

/// V_H and K of a run, for its title.
pub fn parameters(driving: f64, stiffness: f64, units: &Units) -> String {
    let driving = value("V_H", Quantity::SlipRate, driving, units);
    let stiffness = value("K", Quantity::Stiffness, stiffness, units);
    format!("{stiffness}, {driving}")
}

/// A symbol with its value and unit, but for that of what has none.
pub(super) fn value(name: &str, quantity: Quantity, x: f64, units: &Units) -> String {
    format!("{name} = {}", number(quantity, x, units))
}

/// A value with its unit, but for that of what has none.
pub(super) fn number(quantity: Quantity, x: f64, units: &Units) -> String {
    let digits = seven_digits(units.outward(quantity, x));
    let (mantissa, exponent) = digits.split_at(digits.find('e').unwrap_or(digits.len()));
    let mantissa = match mantissa.contains('.') {
        true => mantissa.trim_end_matches('0').trim_end_matches('.'),
        false => mantissa,
    };
    let unit = if units.si() {
        format!(" {}", units.short_name(quantity))
    } else {
        String::new()
    };
    format!("{mantissa}{exponent}{unit}")
}

/// The label of an axis: name and unit, but for that of a number without one.
pub fn axis_label(name: &str, quantity: Quantity, units: &Units) -> String {
    match units.short_name(quantity).as_str() {
        "" | "1" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    }
}

/// Consecutive rows of the same branch.
fn whole(rows: &[BranchRow]) -> impl Iterator<Item = &[BranchRow]> {
    rows.chunk_by(|a, b| a.branch == b.branch)
}

/// Whether the interfaces differ somewhere on a branch.
fn apart(branch: &[BranchRow]) -> bool {
    branch
        .iter()
        .any(|row| row.slip_rate[0] != row.slip_rate[1])
}

/// Stable parts solid, all others dashed; in two colours. With `legend` the colours have names; [`named_strokes`] tells the dashes.
pub fn branch_lines(
    rows: &[BranchRow],
    x: &dyn Fn(&BranchRow) -> f64,
    y: &dyn Fn(&BranchRow) -> f64,
    legend: bool,
) -> Vec<PlotSeries> {
    let kinds = [(ALIKE, true), (APART, true), (ALIKE, false), (APART, false)];
    let part = |(colour, stable): (usize, bool)| {
        let (mut xs, mut ys, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
        for branch in whole(rows).filter(|branch| apart(branch) == (colour == APART)) {
            let belongs = |pair: &[BranchRow]| solid(&pair[0], &pair[1]) == stable;
            if !branch.windows(2).any(belongs) {
                continue;
            }
            // All of it, so that a part goes on into the next one.
            xs.extend(branch.iter().map(x));
            ys.extend(branch.iter().map(y));
            left_out.extend(branch.windows(2).map(|pair| !belongs(pair)));
            xs.push(f64::NAN);
            ys.push(f64::NAN);
            left_out.extend([true, true]);
        }
        let stroke = if stable {
            Stroke::Solid
        } else {
            Stroke::Dashed
        };
        PlotSeries {
            left_out,
            ..PlotSeries::new("", xs, ys).stroke(stroke).colour(colour)
        }
    };
    let series = kinds.into_iter().map(part);
    let series: Vec<PlotSeries> = series.filter(|series| !series.x.is_empty()).collect();
    let occurs = |colour: &usize| series.iter().any(|one| one.colour == Some(*colour));
    let names = [ALIKE, APART].into_iter().filter(|_| legend);
    let names: Vec<PlotSeries> = names
        .filter(occurs)
        .map(|colour| colour_name(symmetry_name(colour), colour))
        .collect();
    [names, series].concat()
}

/// What a colour says of how interfaces move.
pub(super) fn symmetry_name(colour: usize) -> &'static str {
    match colour {
        ALIKE => Symmetry::Symmetric.name(),
        _ => Symmetry::Asymmetric.name(),
    }
}

/// The colour of a branch or a curve on which interfaces move so.
pub(super) fn symmetry_colour(symmetry: Symmetry) -> usize {
    match symmetry {
        Symmetry::Symmetric => ALIKE,
        Symmetry::Asymmetric => APART,
    }
}

/// Between two points: stable if one is, and the other is, or is a bifurcation.
pub(super) fn solid(a: &BranchRow, b: &BranchRow) -> bool {
    let verdicts = [a.verdict, b.verdict];
    verdicts.contains(&Verdict::Stable) && !verdicts.contains(&Verdict::Unstable)
}

/// The special points of branches, but their ends; several branches may pass the same one.
fn marks(
    rows: &[BranchRow],
    x: &dyn Fn(&BranchRow) -> f64,
    y: &dyn Fn(&BranchRow) -> f64,
    named: bool,
) -> Vec<Mark> {
    let special = rows.iter().filter_map(|row| {
        let label = row.label.filter(|&label| label != Label::Ep)?;
        Some((label, x(row), y(row)))
    });
    distinct(special, named)
}

/// The name and the colour of a curve: of many interfaces by how many slide slowly, at a middle rate and fast.
fn curve_name(row: &LocusRow) -> String {
    match row.share {
        Some(_) if row.symmetry == Symmetry::Symmetric => "all alike".to_owned(),
        Some(share) => {
            let each = share.into_iter().zip(["slow", "middle", "fast"]);
            let each = each.filter(|(count, _)| *count > 0);
            let each = each.map(|(count, name)| format!("{count} {name}"));
            each.collect::<Vec<_>>().join(", ")
        }
        None => row.symmetry.name().to_owned(),
    }
}

/// The names of curves, those that occur, in the order of their colours; none where all curves are of one kind.
fn curve_names(rows: &[LocusRow]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for curve in rows.chunk_by(|a, b| a.curve == b.curve) {
        let name = curve_name(&curve[0]);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    // The colours of symmetric and asymmetric ones are those of branches.
    if rows.iter().all(|row| row.share.is_none()) {
        match names.len() {
            2 => {
                names = [ALIKE, APART]
                    .map(|one| symmetry_name(one).to_owned())
                    .into()
            }
            _ => names.clear(),
        }
    }
    names
}

/// K against V_H; where multipliers have an angle, that beside it.
pub fn curves(rows: &[LocusRow], special: &[Special], name: &str, units: &Units) -> Drawing {
    let driving = |x| units.outward(Quantity::SlipRate, x);
    let stiffness = |x| units.outward(Quantity::Stiffness, x);
    let x = Axis::log(axis_label("V_H", Quantity::SlipRate, units));
    let names = curve_names(rows);
    let legend = names.iter().enumerate();
    let legend: Vec<PlotSeries> = legend.map(|(i, name)| colour_name(name, i)).collect();
    let series = |y: &dyn Fn(&LocusRow) -> f64| -> Vec<PlotSeries> {
        let pieces = rows.chunk_by(|a, b| a.curve == b.curve);
        let line = |curve: &[LocusRow]| {
            let driving = curve.iter().map(|row| driving(row.driving.value));
            let (driving, y) = (driving.collect(), curve.iter().map(y).collect());
            let name = curve_name(&curve[0]);
            let colour = names.iter().position(|other| *other == name);
            PlotSeries::new("", driving, y).colour(colour.unwrap_or(curve[0].curve))
        };
        pieces.map(line).collect()
    };
    let labels: Vec<Label> = special.iter().map(|one| one.label).collect();
    let special = special.iter().filter(|one| one.label != Label::Ep);
    let points = special.map(|one| {
        let (v, k) = (one.driving.value, one.stiffness.value);
        (one.label, driving(v), stiffness(k))
    });
    let plane = Panel {
        series: [legend, series(&|row| stiffness(row.stiffness.value))].concat(),
        marks: distinct(points, true),
        keys: meanings(labels.into_iter()),
        ..Panel::new(
            name,
            x.clone(),
            Axis::linear(axis_label("K", Quantity::Stiffness, units)),
        )
    };
    if rows.iter().all(|row| row.angle_over_pi.is_none()) {
        return Drawing::columns(vec![vec![plane]]);
    }
    let labelled = rows.iter().filter_map(|row| {
        let label = row.label.filter(|&label| label != Label::Ep)?;
        Some((label, driving(row.driving.value), row.angle_over_pi?))
    });
    let angle = Panel {
        series: series(&|row| row.angle_over_pi.unwrap_or(f64::NAN)),
        marks: distinct(labelled, true),
        ..Panel::new("angle θ of the multipliers", x, Axis::linear("θ/π"))
    };
    Drawing::columns(vec![vec![plane], vec![angle]])
}
