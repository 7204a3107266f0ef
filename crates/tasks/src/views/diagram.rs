//! Bifurcation diagrams, and curves in the plane of V_H and K.

use crate::scene::{BranchParameter, Quantity, System, Units};
use twinslip::bifurcation::{BranchRow, Label, LocusRow, Parameter, Special};
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::orbit::InterfaceSystem;
use twinslip_output::plot::{Axis, Drawing, Mark, Panel, PlotSeries, Stroke};
use twinslip_output::seven_digits;

/// Colours of branches on which both interfaces move alike, and of the others.
const ALIKE: usize = 0;
const APART: usize = 1;

/// Stress against the parameter, of orbits the least and the largest, with the period beside.
pub fn branches(
    rows: &[BranchRow],
    along: &BranchParameter,
    slab: &InterfaceSystem,
    system: &System,
) -> Drawing {
    let units = &system.units;
    let orbits = rows.iter().any(|row| row.period.is_some());
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
    format!("{name} = {mantissa}{exponent}{unit}")
}

/// The label of an axis: name and unit.
pub fn axis_label(name: &str, quantity: Quantity, units: &Units) -> String {
    format!("{name} [{}]", units.short_name(quantity))
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
    let mut series: Vec<PlotSeries> = series.filter(|series| !series.x.is_empty()).collect();
    let mut known = Vec::new();
    for one in series.iter_mut().filter(|_| legend) {
        if !known.contains(&one.colour) {
            let name = if one.colour == Some(ALIKE) {
                "symmetric"
            } else {
                "asymmetric"
            };
            one.label = name.to_owned();
            known.push(one.colour);
        }
    }
    series
}

/// The legend of the strokes that occur: dashes are what is not stable, in whatever colour.
pub fn named_strokes(series: &[PlotSeries]) -> Vec<(Stroke, String)> {
    let named = [(Stroke::Solid, "stable"), (Stroke::Dashed, "unstable")];
    let occurs = |stroke| series.iter().any(|one| one.stroke == stroke);
    let broken = occurs(Stroke::Dashed);
    let present = named
        .into_iter()
        .filter(|(stroke, _)| broken && occurs(*stroke));
    present
        .map(|(stroke, words)| (stroke, words.to_owned()))
        .collect()
}

/// Between two points: stable if one is, and the other is, or is a bifurcation.
fn solid(a: &BranchRow, b: &BranchRow) -> bool {
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

/// The points with their labels, each once.
pub(super) fn distinct(points: impl Iterator<Item = (Label, f64, f64)>, named: bool) -> Vec<Mark> {
    /// Points nearer than this, relatively, are drawn as one.
    const SAME: f64 = 1e-6;
    let near = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs());
    let mut marks: Vec<(Label, Mark)> = Vec::new();
    for (label, x, y) in points {
        let known =
            |(other, mark): &(Label, Mark)| *other == label && near(mark.x, x) && near(mark.y, y);
        if !marks.iter().any(known) {
            let text = if named { label.name() } else { "" };
            marks.push((label, Mark::new(x, y, text)));
        }
    }
    marks.into_iter().map(|(_, mark)| mark).collect()
}

/// Of many interfaces, how many slide slowly, at a middle rate and fast.
fn share(row: &LocusRow) -> String {
    match row.share {
        Some(_) if row.symmetry == Symmetry::Symmetric => "all alike".to_owned(),
        Some([slow, middle, fast]) => format!("({slow}, {middle}, {fast})"),
        None => String::new(),
    }
}

/// K against V_H; where multipliers have an angle, that beside it.
pub fn curves(rows: &[LocusRow], special: &[Special], name: &str, units: &Units) -> Drawing {
    let driving = |x| units.outward(Quantity::SlipRate, x);
    let stiffness = |x| units.outward(Quantity::Stiffness, x);
    let x = Axis::log(axis_label("V_H", Quantity::SlipRate, units));
    let series = |y: &dyn Fn(&LocusRow) -> f64| -> Vec<PlotSeries> {
        let pieces = rows.chunk_by(|a, b| a.curve == b.curve);
        let mut known: Vec<String> = Vec::new();
        pieces
            .map(|curve| {
                let driving = curve.iter().map(|row| driving(row.driving.value));
                let (driving, y) = (driving.collect(), curve.iter().map(y).collect());
                let share = share(&curve[0]);
                if share.is_empty() {
                    return PlotSeries::new("", driving, y).colour(curve[0].curve);
                }
                // the curves of a share have one colour, and one name
                match known.iter().position(|other| *other == share) {
                    Some(colour) => PlotSeries::new("", driving, y).colour(colour),
                    None => {
                        known.push(share.clone());
                        PlotSeries::new(share, driving, y).colour(known.len() - 1)
                    }
                }
            })
            .collect()
    };
    let special = special.iter().filter(|one| one.label != Label::Ep);
    let points = special.map(|one| {
        let (v, k) = (one.driving.value, one.stiffness.value);
        (one.label, driving(v), stiffness(k))
    });
    let plane = Panel {
        series: series(&|row| stiffness(row.stiffness.value)),
        marks: distinct(points, true),
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
