//! Bifurcation diagrams and curves in the (V_H, K) plane: symbols, strokes and keys, the same in all figures.

use crate::{Branches, Curves};
use twinslip::bifurcation::{BranchRow, Label, LocusRow, Special};
use twinslip_output::plot::{Key, Mark, PlotSeries, Stroke, Symbol};

/// How a kind of special point is drawn: shape, whether it is filled, its words.
pub fn symbol(label: Label) -> Option<(Symbol, bool, &'static str)> {
    Some(match label {
        Label::Lp => (Symbol::Circle, false, "saddle-node of equilibria"),
        Label::Sn => (Symbol::Circle, true, "saddle-node of orbits"),
        Label::Bp => (Symbol::Square, false, "pitchfork of equilibria"),
        Label::Pf => (Symbol::Triangle, true, "pitchfork of orbits"),
        Label::Hb => (Symbol::Square, true, "Hopf"),
        Label::Tr => (Symbol::Diamond, true, "torus"),
        Label::Pd => (Symbol::Diamond, false, "period doubling"),
        Label::R2 => (Symbol::Circle, false, "1:2"),
        Label::R3 => (Symbol::Star, true, "1:3"),
        Label::R4 => (Symbol::Diamond, true, "1:4"),
        _ => return None,
    })
}

/// A mark of that kind, without a name.
pub fn mark(label: Label, x: f64, y: f64) -> Option<Mark> {
    let (shape, filled, _) = symbol(label)?;
    let mark = Mark::new(x, y, "").symbol(shape);
    Some(if filled { mark } else { mark.open() })
}

/// Legend entries for the kinds that occur among these marks' labels, in the order of [`Label::ALL`].
pub fn keys(labels: impl Iterator<Item = Label>) -> Vec<Key> {
    let present: Vec<Label> = labels.collect();
    let kinds = Label::ALL
        .into_iter()
        .filter(|label| present.contains(label));
    let key = |label| {
        let (symbol, filled, words) = symbol(label)?;
        Some(Key {
            symbol,
            filled,
            colour: None,
            label: words.to_owned(),
        })
    };
    kinds.filter_map(key).collect()
}

/// The marks of a branch's special rows, each place once.
pub fn marks(
    rows: &[BranchRow],
    x: impl Fn(&BranchRow) -> f64,
    y: impl Fn(&BranchRow) -> f64,
) -> Vec<Mark> {
    let special = rows
        .iter()
        .filter_map(|row| mark(row.label?, x(row), y(row)));
    let mut marks: Vec<Mark> = Vec::new();
    for one in special {
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * a.abs().max(b.abs());
        let known = |other: &Mark| {
            other.symbol == one.symbol
                && other.filled == one.filled
                && near(other.x, one.x)
                && near(other.y, one.y)
        };
        if !marks.iter().any(known) {
            marks.push(one);
        }
    }
    marks
}

/// The labels of rows.
pub fn labels<'a>(all: impl IntoIterator<Item = &'a Branches>) -> impl Iterator<Item = Label> {
    let rows = all.into_iter().flat_map(|branches| &branches.rows);
    rows.filter_map(|row| row.label)
}

/// The lines of curves, one label for all pieces; `x` and `y` of a row.
pub fn lines(
    curves: &Curves,
    label: &str,
    (colour, stroke): (usize, Stroke),
    x: impl Fn(&LocusRow) -> f64,
    y: impl Fn(&LocusRow) -> f64,
) -> PlotSeries {
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    for piece in curves.rows.chunk_by(|a, b| a.curve == b.curve) {
        xs.push(f64::NAN);
        ys.push(f64::NAN);
        xs.extend(piece.iter().map(&x));
        ys.extend(piece.iter().map(&y));
    }
    PlotSeries::new(label, xs, ys).stroke(stroke).colour(colour)
}

/// In the (V_H, K) plane.
pub fn in_plane(curves: &Curves, label: &str, look: (usize, Stroke)) -> PlotSeries {
    let (x, y) = (
        |row: &LocusRow| row.driving.value,
        |row: &LocusRow| row.stiffness.value,
    );
    lines(curves, label, look, x, y)
}

/// A special point of curves in the (V_H, K) plane, with its name.
pub fn named(special: &Special, name: &str) -> Option<Mark> {
    let mark = mark(
        special.label,
        special.driving.value,
        special.stiffness.value,
    )?;
    Some(Mark {
        label: name.to_owned(),
        ..mark
    })
}

/// The strong resonances of a torus curve, named.
pub fn resonances(torus: &Curves) -> Vec<Mark> {
    let strong = |one: &&Special| matches!(one.label, Label::R2 | Label::R3 | Label::R4);
    let named = |one: &Special| named(one, symbol(one.label)?.2);
    torus
        .special
        .iter()
        .filter(strong)
        .filter_map(named)
        .collect()
}

/// How branches and curves are computed, in words.
pub fn method(tolerance: f64) -> String {
    format!(
        "Orbits by multiple shooting on power series with tangents, followed by pseudo-arclength; special points to {tolerance:e}"
    )
}
