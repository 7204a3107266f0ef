//! Basins: on which attractor the runs from starts (psi_1, psi_2) end.

use super::attractors::attractors;
use super::tints::RegimeKind;
use super::{GridSide, PointOutcome};
use crate::equilibrium::Symmetry;
use crate::output::plot::{Cells, Drawing, Panel, PlotSeries, Shade, Stroke, Swatch};
use crate::scene::{Quantity, Units};
use crate::section::Regime;
use crate::views::{axis_label, parameters};

/// Colours of attractors, the largest basin first, far apart in lightness and hue where there are few.
const ORDER: [RegimeKind; 9] = [
    RegimeKind::PeriodicSymmetric,
    RegimeKind::PeriodHigher,
    RegimeKind::SteadySymmetric,
    RegimeKind::Torus,
    RegimeKind::PeriodicAsymmetric,
    RegimeKind::Period4,
    RegimeKind::SteadyAsymmetric,
    RegimeKind::Period3,
    RegimeKind::Chaotic,
];

/// Starts with equal states stay symmetric for ever: a line, which has no area however large the cells of a grid are.
const DIAGONAL: &str = "ψ₁ = ψ₂ stays symmetric: not counted, its cells show what is beside them";
/// Of that line.
const BLACK: usize = 7;

/// The attractor that each start goes to, numbered by the size of their basins, of which equal states are no part. Points that
/// are missing stay white; all beyond the eighth attractor share a colour. V_H and K are for the title.
pub fn basin_map(
    outcomes: &[PointOutcome],
    (state_1, state_2): (&GridSide, &GridSide),
    (driving, stiffness): (f64, f64),
    units: &Units,
) -> Drawing {
    let label = |name| axis_label(name, Quantity::State, units);
    let outward = |x| units.outward(Quantity::State, x);
    let (x, x_edges) = state_1.axis(label("ψ₁ at the start"), outward);
    let (y, y_edges) = state_2.axis(label("ψ₂ at the start"), outward);
    let columns = state_1.values.len();
    let equal = |number: usize| {
        let start = state_1.values.get(number % columns.max(1));
        start.is_some() && start == state_2.values.get(number / columns.max(1))
    };
    let (symmetric, beside): (Vec<PointOutcome>, Vec<PointOutcome>) = outcomes
        .iter()
        .copied()
        .partition(|outcome| equal(outcome.number));
    let (all, of) = attractors(&beside);
    let mut fills = vec![Vec::new(); columns * state_2.values.len()];
    for (outcome, attractor) in beside.iter().zip(&of) {
        if let Some(cell) = fills.get_mut(outcome.number) {
            *cell = vec![attractor.map_or(RegimeKind::Undecided.shade(), tint)];
        }
    }
    for outcome in &symmetric {
        if let Some(fill) = around(&fills, outcome.number, columns) {
            fills[outcome.number] = fill;
        }
    }
    let title = format!("basins at {}", parameters(driving, stiffness, units));
    let map = Cells {
        x_edges,
        y_edges,
        fills,
        swatches: swatches(&all, &of, units),
    };
    let panel = Panel {
        series: if symmetric.is_empty() {
            Vec::new()
        } else {
            vec![diagonal(&map)]
        },
        cells: Some(map),
        ..Panel::new(title, x, y)
    };
    Drawing::columns(vec![vec![panel]])
}

/// The line of equal states across a map.
fn diagonal(map: &Cells) -> PlotSeries {
    let (x, y) = (&map.x_edges, &map.y_edges);
    let common = |of: fn(f64, f64) -> f64, a: Option<&f64>, b: Option<&f64>| {
        a.zip(b).map_or(f64::NAN, |(a, b)| of(*a, *b))
    };
    let from = common(f64::max, x.first(), y.first());
    let to = common(f64::min, x.last(), y.last());
    let line = PlotSeries::new(DIAGONAL, vec![from, to], vec![from, to]);
    line.stroke(Stroke::Dotted).colour(BLACK)
}

/// What all cells beside that one show: nothing where they differ.
fn around(fills: &[Vec<Shade>], number: usize, columns: usize) -> Option<Vec<Shade>> {
    let (i, j) = (number % columns, number / columns);
    let left = i.checked_sub(1).map(|i| (i, j));
    let below = j.checked_sub(1).map(|j| (i, j));
    let right = (i + 1 < columns).then_some((i + 1, j));
    let beside = [left, below, right, Some((i, j + 1))];
    let mut shown = beside
        .into_iter()
        .flatten()
        .filter_map(|(i, j)| fills.get(j * columns + i));
    let first = shown.next()?;
    shown.all(|fill| fill == first).then(|| first.clone())
}

fn tint(attractor: usize) -> Shade {
    ORDER[attractor.min(ORDER.len() - 1)].shade()
}

/// The legend: each attractor with what it is and its share of the starts.
fn swatches(all: &[(PointOutcome, usize)], of: &[Option<usize>], units: &Units) -> Vec<Swatch> {
    let share = |count: usize| 100.0 * count as f64 / of.len().max(1) as f64;
    let last = ORDER.len() - 1;
    let named = all
        .iter()
        .take(last)
        .enumerate()
        .map(|(i, (one, count))| Swatch {
            shades: vec![tint(i)],
            label: format!("{}: {}, {:.1} %", i + 1, words(one, units), share(*count)),
        });
    let others: usize = all.iter().skip(last).map(|(_, count)| count).sum();
    let others = (others > 0).then(|| Swatch {
        shades: vec![tint(last)],
        label: format!("{} others, {:.1} %", all.len() - last, share(others)),
    });
    let undecided = of.iter().filter(|attractor| attractor.is_none()).count();
    let undecided = (undecided > 0).then(|| Swatch {
        shades: vec![RegimeKind::Undecided.shade()],
        label: format!("undecided, {:.1} %", share(undecided)),
    });
    named.chain(others).chain(undecided).collect()
}

/// Regime, symmetry and period.
fn words(one: &PointOutcome, units: &Units) -> String {
    let mut words = vec![one.regime.name().to_owned()];
    words.extend(one.symmetry.map(|symmetry| match symmetry {
        Symmetry::Symmetric => "symmetric".to_owned(),
        Symmetry::Asymmetric => "asymmetric".to_owned(),
    }));
    if one.regime == Regime::Periodic {
        let returns = one.returns_per_period.filter(|&returns| returns > 1);
        words.extend(returns.map(|returns| format!("{returns} returns")));
        let period = one
            .period
            .map(|period| units.outward(Quantity::Time, period));
        let unit = units.short_name(Quantity::Time);
        words.extend(period.map(|period| format!("T = {} {unit}", four_digits(period))));
    }
    words.join(", ")
}

/// Enough to tell periods apart.
fn four_digits(x: f64) -> String {
    let digits = (3.0 - x.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{x:.digits$}")
}
