//! Branches of equilibria of many interfaces: their columns, and the staircase of stress against V_H.

use super::diagram::{axis_label, fixed};
use super::labels::{colour_name, distinct, meanings, named_strokes};
use crate::scene::{BranchParameter, CellValue, Column, Quantity, System};
use twinslip::bifurcation::clusters::{ClusterOfRow, ClusterRow};
use twinslip::bifurcation::{Label, Parameter};
use twinslip::equilibrium::Verdict;
use twinslip::orbit::InterfaceSystem;
use twinslip_output::plot::{Axis, Drawing, Panel, PlotSeries, Stroke};

/// An equilibrium has so many clusters at most.
const CLUSTERS: usize = 3;

/// The columns of branches of equilibria of many interfaces, told by clusters, slowest first.
pub fn cluster_columns() -> Vec<Column<ClusterRow>> {
    use Quantity::{Growth, Number, SlipRate, State, Stiffness, Stress, Time};
    type Row = ClusterRow;
    let each = |name: &str, quantity, of: fn(&ClusterOfRow) -> CellValue| -> Vec<Column<Row>> {
        let column = |i| {
            Column::new(format!("{name}_{}", i + 1), quantity, move |row: &Row| {
                row.clusters.get(i).map_or(CellValue::Number(None), of)
            })
        };
        (0..CLUSTERS).map(column).collect()
    };
    let aside = |columns: Vec<Column<Row>>| columns.into_iter().map(Column::not_in_table);
    let mut columns = vec![
        Column::new("driving", SlipRate, |row: &Row| row.driving.into()),
        Column::new("stiffness", Stiffness, |row: &Row| row.stiffness.into()),
        Column::new("stress", Stress, |row: &Row| row.stress.into()),
        Column::new("stress_min", Stress, |row: &Row| row.stress.into()).not_in_table(),
        Column::new("stress_max", Stress, |row: &Row| row.stress.into()).not_in_table(),
        // of an orbit
        Column::new("period", Time, |_: &Row| CellValue::Number(None)).not_in_table(),
    ];
    for (i, name) in ["slow", "middle", "fast"].into_iter().enumerate() {
        columns.push(Column::new(name, Number, move |row: &Row| {
            row.share[i].into()
        }));
    }
    columns.extend(aside(each("count", Number, |one| one.count.into())));
    columns.extend(aside(each("state", State, |one| one.state.into())));
    columns.extend(each("slip_rate", SlipRate, |one| one.slip_rate.into()));
    for i in 1..=2 {
        // of an orbit
        let name = format!("ln_abs_multiplier_{i}");
        let none = |_: &Row| CellValue::Number(None);
        columns.push(Column::new(name, Growth, none).not_in_table());
    }
    columns.extend([
        Column::new("unstable", Number, |row: &Row| row.unstable.into()),
        Column::new("verdict", Number, |row: &Row| row.verdict.name().into()),
        Column::new("label", Number, |row: &Row| {
            row.label.map(Label::name).into()
        }),
        Column::new("branch", Number, |row: &Row| row.branch.into()),
        Column::new("symmetry", Number, |row: &Row| row.symmetry().name().into()).not_in_table(),
    ]);
    columns
}

/// Stress against the parameter; branches of as many clusters in one colour, stable parts solid and wide, all others dashed.
pub fn staircase(
    rows: &[ClusterRow],
    along: &BranchParameter,
    slab: &InterfaceSystem,
    system: &System,
) -> Drawing {
    /// More special points than these would hide the branches.
    const MOST_MARKS: usize = 20;
    let units = &system.units;
    let x = |row: &ClusterRow| along.of(row.driving, row.stiffness, units);
    let y = |row: &ClusterRow| units.outward(Quantity::Stress, row.stress);
    // Where clusters part and where they fold lie side by side at either end of each: of these what all alike meet.
    let named = |row: &ClusterRow| match row.label? {
        Label::Ep => None,
        Label::Bp | Label::Lp if row.clusters.len() > 1 => None,
        label => Some((label, x(row), y(row))),
    };
    let special: Vec<(Label, f64, f64)> = rows.iter().filter_map(named).collect();
    let labels = special.iter().map(|(label, ..)| *label);
    let mut keys = meanings(labels);
    let mut marks = distinct(special.into_iter(), true);
    if marks.len() > MOST_MARKS {
        marks.clear();
        keys.clear();
    }
    let series = lines(rows, slab.interfaces, &x, &y);
    let symbol = match along.parameter {
        Parameter::Driving => "V_H",
        Parameter::Stiffness => "K",
    };
    let panel = Panel {
        strokes: named_strokes(&series),
        series,
        marks,
        keys,
        ..Panel::new(
            format!(
                "equilibria of {} interfaces at {}",
                slab.interfaces,
                fixed(along, slab, units)
            ),
            Axis::log(axis_label(symbol, along.quantity, units)),
            Axis::linear(axis_label("stress τ", Quantity::Stress, units)),
        )
    };
    Drawing::columns(vec![vec![panel]])
}

/// What there are most of is drawn first, what is stable last.
fn lines(
    rows: &[ClusterRow],
    interfaces: usize,
    x: &dyn Fn(&ClusterRow) -> f64,
    y: &dyn Fn(&ClusterRow) -> f64,
) -> Vec<PlotSeries> {
    /// The stairs of more interfaces would run into each other.
    const MOST_WIDE: usize = 10;
    let names = ["all alike", "two clusters", "three clusters"];
    let clusters = |branch: &[ClusterRow]| {
        let most = branch.iter().map(|row| row.clusters.len()).max();
        most.unwrap_or(1)
    };
    let mut all: Vec<PlotSeries> = Vec::new();
    for (stable, number) in [false, true]
        .into_iter()
        .flat_map(|s| [(s, 3), (s, 2), (s, 1)])
    {
        let stroke = match stable {
            true => Stroke::Solid,
            false => Stroke::Dashed,
        };
        for branch in rows.chunk_by(|a, b| a.branch == b.branch) {
            let belongs = |pair: &[ClusterRow]| solid(&pair[0], &pair[1]) == stable;
            if clusters(branch) != number || !branch.windows(2).any(belongs) {
                continue;
            }
            let (xs, ys) = (branch.iter().map(x), branch.iter().map(y));
            all.push(PlotSeries {
                // all of it, so that a part goes on into the next one
                left_out: branch.windows(2).map(|pair| !belongs(pair)).collect(),
                wide: stable && interfaces <= MOST_WIDE,
                ..PlotSeries::new("", xs.collect(), ys.collect())
                    .stroke(stroke)
                    .colour(number - 1)
            });
        }
    }
    let occurs = |colour: usize| all.iter().any(|one| one.colour == Some(colour));
    let legend = names.into_iter().enumerate().filter(|(i, _)| occurs(*i));
    let legend: Vec<PlotSeries> = legend.map(|(i, name)| colour_name(name, i)).collect();
    [legend, all].concat()
}

/// Between two points: stable if one is, and the other is, or is a bifurcation.
fn solid(a: &ClusterRow, b: &ClusterRow) -> bool {
    let verdicts = [a.verdict, b.verdict];
    verdicts.contains(&Verdict::Stable) && !verdicts.contains(&Verdict::Unstable)
}
