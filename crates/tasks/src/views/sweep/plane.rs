//! Regimes over a plane of two parameters; over that of V_H and K with curves of bifurcations over them.

use super::tints::{LIGHTEST, RegimeKind};
use super::{GridSide, PointOutcome};
use crate::scene::{Quantity, Units};
use crate::views::axis_label;
use twinslip::bifurcation::LocusRow;
use twinslip_output::plot::{Axis, Cells, Drawing, Panel, PlotSeries, Shade, Stroke, Swatch};

/// Steps of lightness between the least and the largest exponent: few enough that cells still merge.
const STEPS: usize = 6;
/// Black, the only colour that no regime has.
const BLACK: usize = 7;
const STROKES: [Stroke; 5] = [
    Stroke::Solid,
    Stroke::Dashed,
    Stroke::DashDot,
    Stroke::Dotted,
    Stroke::DashDotDot,
];

/// The regimes over V_H and K, with named curves over them. Points that are missing, as of a sweep that goes on, stay white.
/// Where several starts end differently the cell has stripes of all regimes; a start that is undecided shows only where no other
/// has a verdict, as it says nothing of another attractor. Chaos is the darker the larger the exponent; attractors of the same
/// regime are not told apart.
pub fn regime_map(
    outcomes: &[PointOutcome],
    (driving, stiffness): (&GridSide, &GridSide),
    starts: usize,
    curves: &[(&str, &[LocusRow])],
    units: &Units,
) -> Drawing {
    let label = |name, quantity| axis_label(name, quantity, units);
    let x = driving.axis(label("V_H", Quantity::SlipRate), |x| {
        units.outward(Quantity::SlipRate, x)
    });
    let y = stiffness.axis(label("K", Quantity::Stiffness), |x| {
        units.outward(Quantity::Stiffness, x)
    });
    drawn(outcomes, [x, y], starts, over(curves, units), units)
}

/// The same over two parameters whose values are in the user's units, with the labels of their axes.
pub fn parameter_map(
    outcomes: &[PointOutcome],
    sides: [(&GridSide, String); 2],
    starts: usize,
    curves: &[(&str, &[LocusRow])],
    units: &Units,
) -> Drawing {
    let axes = sides.map(|(side, label)| side.axis(label, |x| x));
    drawn(outcomes, axes, starts, over(curves, units), units)
}

/// A map over axes with the edges of their cells.
fn drawn(
    outcomes: &[PointOutcome],
    [(x, x_edges), (y, y_edges)]: [(Axis, Vec<f64>); 2],
    starts: usize,
    series: Vec<PlotSeries>,
    units: &Units,
) -> Drawing {
    let [columns, lines] = [&x_edges, &y_edges].map(|edges| edges.len().saturating_sub(1));
    let starts = starts.max(1);
    let exponents = LargestExponents::of(outcomes);
    let mut found = vec![Vec::new(); columns * lines];
    for outcome in outcomes {
        if let Some(cell) = found.get_mut(outcome.number / starts) {
            cell.push((RegimeKind::of(outcome), exponents.shade(outcome)));
        }
    }
    let fills: Vec<_> = found.iter_mut().map(told).collect();
    let mut title = format!("regimes at {columns} × {lines} points");
    if starts > 1 {
        title += &format!(", {starts} starts each");
    }
    let striped = fills.iter().any(|fill| fill.len() > 1);
    let map = Cells {
        x_edges,
        y_edges,
        fills: fills
            .into_iter()
            .map(|fill| fill.into_iter().map(|(_, shade)| shade).collect())
            .collect(),
        swatches: legend(outcomes, &found, &exponents, striped, units),
    };
    let panel = Panel {
        cells: Some(map),
        series,
        ..Panel::new(title, x, y)
    };
    Drawing::columns(vec![vec![panel]])
}

/// What a cell shows of what its starts found: each regime once, in the order of the legend.
pub(super) fn told(found: &mut Vec<(RegimeKind, Shade)>) -> Vec<(RegimeKind, Shade)> {
    // Of chaos the darkest.
    found.sort_by(|a, b| {
        let lightness = a.1.lightness.total_cmp(&b.1.lightness);
        a.0.cmp(&b.0).then(lightness)
    });
    found.dedup_by_key(|(kind, _)| *kind);
    if found.len() > 1 {
        found.retain(|(kind, _)| *kind != RegimeKind::Undecided);
    }
    found.clone()
}

/// The largest exponents of chaotic points.
pub(super) struct LargestExponents(Option<(f64, f64)>);

impl LargestExponents {
    pub fn of(outcomes: &[PointOutcome]) -> Self {
        let chaotic = outcomes
            .iter()
            .filter(|one| RegimeKind::of(one) == RegimeKind::Chaotic);
        let values = chaotic.filter_map(|one| Some(one.lyapunov_max?.value));
        LargestExponents(values.fold(None, |reach: Option<(f64, f64)>, x| {
            let (lo, hi) = reach.unwrap_or((x, x));
            Some((lo.min(x), hi.max(x)))
        }))
    }

    /// The colour of a point.
    pub fn shade(&self, outcome: &PointOutcome) -> Shade {
        let kind = RegimeKind::of(outcome);
        match (kind, self.0, outcome.lyapunov_max) {
            (RegimeKind::Chaotic, Some((lo, hi)), Some(x)) if lo < hi => {
                let part = (x.value - lo) / (hi - lo);
                lighter(
                    ((1.0 - part) * STEPS as f64)
                        .floor()
                        .min(STEPS as f64 - 1.0),
                )
            }
            _ => kind.shade(),
        }
    }
}

/// Chaos, so many steps lighter.
fn lighter(steps: f64) -> Shade {
    RegimeKind::Chaotic
        .shade()
        .lighter(LIGHTEST * steps / (STEPS - 1) as f64)
}

/// The legend: the regimes that there are.
pub(super) fn legend(
    outcomes: &[PointOutcome],
    found: &[Vec<(RegimeKind, Shade)>],
    exponents: &LargestExponents,
    striped: bool,
    units: &Units,
) -> Vec<Swatch> {
    let symmetries = outcomes.iter().any(|one| one.symmetry.is_some());
    let mut kinds: Vec<RegimeKind> = found.iter().flatten().map(|(kind, _)| *kind).collect();
    kinds.sort();
    kinds.dedup();
    let swatch = |kind: RegimeKind| match (kind, exponents.0) {
        (RegimeKind::Chaotic, Some((lo, hi))) if lo < hi => {
            let rate = |x| format!("{:.0e}", units.outward(Quantity::Growth, x));
            let range = format!("chaotic, exponent {} to {}", rate(lo), rate(hi));
            Swatch {
                shades: (0..STEPS).rev().map(|i| lighter(i as f64)).collect(),
                label: axis_label(&range, Quantity::Growth, units),
            }
        }
        _ => Swatch {
            shades: vec![kind.shade()],
            label: kind.words(symmetries).to_owned(),
        },
    };
    let stripes = striped.then(|| Swatch {
        shades: Vec::new(),
        label: "striped: the starts end differently".to_owned(),
    });
    kinds.into_iter().map(swatch).chain(stripes).collect()
}

/// Curves, told apart by their strokes.
fn over(curves: &[(&str, &[LocusRow])], units: &Units) -> Vec<PlotSeries> {
    let series = |(i, (name, rows)): (usize, &(&str, &[LocusRow]))| {
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for piece in rows.chunk_by(|a, b| a.curve == b.curve) {
            for row in piece {
                x.push(units.outward(Quantity::SlipRate, row.driving.value));
                y.push(units.outward(Quantity::Stiffness, row.stiffness.value));
            }
            // Curves don't go on into one another.
            x.push(f64::NAN);
            y.push(f64::NAN);
        }
        let series = PlotSeries::new(*name, x, y).colour(BLACK);
        series.stroke(STROKES[i % STROKES.len()])
    };
    let shown = curves.iter().filter(|(_, rows)| !rows.is_empty());
    shown.enumerate().map(series).collect()
}
