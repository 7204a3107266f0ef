//! Basins: on which attractor the runs from starts (psi_1, psi_2) end.

use super::attractors::attractors;
use super::tints::RegimeKind;
use super::{GridSide, PointOutcome};
use crate::scene::{Quantity, Units};
use crate::views::{axis_label, parameters};
use twinslip::equilibrium::Symmetry;
use twinslip::section::Regime;
use twinslip_output::plot::{Cells, Drawing, Panel, PlotSeries, Shade, Stroke, Swatch};

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

/// What the starts of basins are of.
#[derive(Debug, Clone, PartialEq)]
pub struct Basins {
    /// What stands above the map.
    pub title: String,
    /// What the starts are of, with units: across and upwards.
    pub labels: [String; 2],
    /// Whether starts with equal values are symmetric and stay so.
    pub equal_stay_equal: bool,
    /// Where no symmetry tells attractors apart: what is said of their range, and what it measures.
    pub range_of: Option<(String, Quantity)>,
}

/// The attractor that each start (psi_1, psi_2) of two equal interfaces goes to, as [`basins_of_states`]. V_H and K are for the title.
pub fn basin_map(
    outcomes: &[PointOutcome],
    (state_1, state_2): (&GridSide, &GridSide),
    (driving, stiffness): (f64, f64),
    units: &Units,
) -> Drawing {
    let label = |name| axis_label(name, Quantity::State, units);
    let basins = Basins {
        title: format!("basins at {}", parameters(driving, stiffness, units)),
        labels: [label("ψ₁ at the start"), label("ψ₂ at the start")],
        equal_stay_equal: true,
        range_of: None,
    };
    basins_of_states(outcomes, [state_1, state_2], basins, units)
}

/// The attractor that each start goes to, numbered by the size of their basins, of which equal states that stay so are no part. Points
/// that are missing stay white; all beyond the eighth attractor share a colour. Values along the sides are in the user's units.
pub fn basins_of_states(
    outcomes: &[PointOutcome],
    [first, second]: [&GridSide; 2],
    basins: Basins,
    units: &Units,
) -> Drawing {
    let [across, upwards] = basins.labels;
    let (x, x_edges) = first.axis(across, |x| x);
    let (y, y_edges) = second.axis(upwards, |y| y);
    let columns = first.values.len();
    let equal = |number: usize| {
        let start = first.values.get(number % columns.max(1));
        let other = second.values.get(number / columns.max(1));
        basins.equal_stay_equal && start.is_some() && start == other
    };
    let (symmetric, beside): (Vec<PointOutcome>, Vec<PointOutcome>) = outcomes
        .iter()
        .copied()
        .partition(|outcome| equal(outcome.number));
    let (all, of) = attractors(&beside);
    let mut fills = vec![Vec::new(); columns * second.values.len()];
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
    let map = Cells {
        x_edges,
        y_edges,
        fills,
        swatches: swatches(&all, &of, (basins.range_of.as_ref(), units)),
    };
    let panel = Panel {
        series: if symmetric.is_empty() {
            Vec::new()
        } else {
            vec![diagonal(&map)]
        },
        cells: Some(map),
        ..Panel::new(basins.title, x, y)
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
fn swatches(
    all: &[(PointOutcome, usize)],
    of: &[Option<usize>],
    told: (Option<&(String, Quantity)>, &Units),
) -> Vec<Swatch> {
    let share = |count: usize| 100.0 * count as f64 / of.len().max(1) as f64;
    let last = ORDER.len() - 1;
    let named = all
        .iter()
        .take(last)
        .enumerate()
        .map(|(i, (one, count))| Swatch {
            shades: vec![tint(i)],
            label: format!("{}: {}, {:.1} %", i + 1, words(one, told), share(*count)),
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

/// Regime, symmetry and period; without a symmetry, the range where it is told.
fn words(one: &PointOutcome, (range_of, units): (Option<&(String, Quantity)>, &Units)) -> String {
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
        let unit = match units.short_name(Quantity::Time) {
            // That of a system without units.
            unit if unit == "1" => String::new(),
            unit => format!(" {unit}"),
        };
        words.extend(period.map(|period| format!("T = {}{unit}", four_digits(period))));
    }
    if let (Some((name, quantity)), Some((least, most)), None) =
        (range_of, one.stress_range, one.symmetry)
    {
        let [least, most] = [least, most].map(|x| four_digits(units.outward(*quantity, x)));
        words.push(match one.regime {
            Regime::Steady => format!("{name} = {least}"),
            _ => format!("{name} from {least} to {most}"),
        });
    }
    words.join(", ")
}

/// Enough to tell attractors apart.
fn four_digits(x: f64) -> String {
    /// What is less is zero, but for rounding.
    const NOTHING: f64 = 1e-9;
    if x.abs() < NOTHING {
        return "0".into();
    }
    let digits = (3.0 - x.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{x:.digits$}")
}
