//! Branches of equilibria of many interfaces: the staircase of stress against V_H.

use super::diagram::{axis_label, fixed, solid};
use super::labels::{colour_name, distinct, meanings, named_strokes};
use crate::scene::{BranchParameter, Quantity, System};
use twinslip::bifurcation::{BranchRow, Label, Parameter};
use twinslip::orbit::InterfaceSystem;
use twinslip_output::plot::{Axis, Drawing, Panel, PlotSeries, Stroke};

/// Stress against the parameter; branches of as many clusters in one colour, stable parts solid and wide, all others dashed.
pub fn staircase(
    rows: &[BranchRow],
    along: &BranchParameter,
    slab: &InterfaceSystem,
    system: &System,
) -> Drawing {
    /// More special points than these would hide the branches.
    const MOST_MARKS: usize = 20;
    let units = &system.units;
    let x = |row: &BranchRow| along.of(row.driving, row.stiffness, units);
    let y = |row: &BranchRow| units.outward(Quantity::Stress, row.stress);
    // Where clusters part and where they fold lie side by side at either end of each: of these what all alike meet.
    let named = |row: &BranchRow| match row.label? {
        Label::Ep => None,
        Label::Bp | Label::Lp if clusters_of(row) > 1 => None,
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

/// How many groups of interfaces slide alike.
fn clusters_of(row: &BranchRow) -> usize {
    row.equilibrium.as_ref().map_or(1, |one| one.clusters.len())
}

/// What there are most of is drawn first, what is stable last.
fn lines(
    rows: &[BranchRow],
    interfaces: usize,
    x: &dyn Fn(&BranchRow) -> f64,
    y: &dyn Fn(&BranchRow) -> f64,
) -> Vec<PlotSeries> {
    /// The stairs of more interfaces would run into each other.
    const MOST_WIDE: usize = 10;
    let names = ["all alike", "two clusters", "three clusters"];
    let clusters = |branch: &[BranchRow]| {
        let most = branch.iter().map(clusters_of).max();
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
            let belongs = |pair: &[BranchRow]| solid(&pair[0], &pair[1]) == stable;
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
