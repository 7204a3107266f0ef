//! What runs settle on along one parameter.

use super::plane::{LargestExponents, legend, told};
use super::tints::RegimeKind;
use super::{GridSide, PointOutcome};
use crate::scene::{Quantity, Units};
use crate::views::axis_label;
use twinslip_output::plot::{Axis, Cells, Drawing, Panel, PlotSeries};

/// The part of the frame that the strip of regimes has, and what is left free at both ends of the values.
const STRIP: f64 = 0.06;
const FREE: f64 = 0.05;
/// Periods that span more than this ratio are shown by their logarithm.
const RATIO: f64 = 10.0;
/// Black.
const BLACK: usize = 7;

/// The least and the largest value that runs go through against the parameter, above a strip with the regimes in the colours of maps;
/// below, the periods, where there are any. The values along the side are in the user's units; `name` is what the range is of.
pub fn regime_line(
    outcomes: &[PointOutcome],
    (side, label): (&GridSide, String),
    starts: usize,
    (name, quantity): (&str, Quantity),
    units: &Units,
) -> Drawing {
    let starts = starts.max(1);
    let (x, x_edges) = side.axis(label, |x| x);
    let points = |of: &dyn Fn(&PointOutcome) -> Option<f64>| {
        let pair = |one: &PointOutcome| Some((*side.values.get(one.number / starts)?, of(one)?));
        let (xs, ys): (Vec<f64>, Vec<f64>) = outcomes.iter().filter_map(pair).unzip();
        PlotSeries::dots("", xs, ys).colour(BLACK)
    };
    let outward = |x| units.outward(quantity, x);
    let range = [
        points(&|one| one.stress_range.map(|range| outward(range.0))),
        points(&|one| one.stress_range.map(|range| outward(range.1))),
    ];
    let (least, most) = ends(range.iter().flat_map(|series| &series.y));
    let height = most - least;
    let foot = least - FREE * height;
    let bottom = foot - STRIP * height;
    let exponents = LargestExponents::of(outcomes);
    let mut found = vec![Vec::new(); side.values.len()];
    for outcome in outcomes {
        if let Some(cell) = found.get_mut(outcome.number / starts) {
            cell.push((RegimeKind::of(outcome), exponents.shade(outcome)));
        }
    }
    let fills: Vec<_> = found.iter_mut().map(told).collect();
    let striped = fills.iter().any(|fill| fill.len() > 1);
    let shades = |fill: Vec<(RegimeKind, _)>| fill.into_iter().map(|(_, shade)| shade).collect();
    let strip = Cells {
        x_edges,
        y_edges: vec![bottom, bottom + STRIP * height],
        fills: fills.into_iter().map(shades).collect(),
        swatches: legend(outcomes, &found, &exponents, striped, units),
    };
    let mut title = format!("regimes at {} points", side.values.len());
    if starts > 1 {
        title += &format!(", {starts} starts each");
    }
    let vertical = axis_label(&format!("least and largest {name}"), quantity, units);
    let first = Panel {
        cells: Some(strip),
        series: range.into(),
        ..Panel::new(
            title,
            x.clone(),
            Axis::linear(vertical).within(bottom, most + FREE * height),
        )
    };
    let period = points(&|one| {
        let period = one.period?;
        Some(units.outward(Quantity::Time, period))
    });
    if period.y.is_empty() {
        return Drawing::columns(vec![vec![first]]);
    }
    let (shortest, longest) = ends(&period.y);
    let vertical = axis_label("period", Quantity::Time, units);
    let vertical = match shortest > 0.0 && longest > RATIO * shortest {
        true => Axis::log(vertical),
        false => Axis::linear(vertical),
    };
    let second = Panel {
        series: vec![period],
        ..Panel::new("", x, vertical)
    };
    Drawing::columns(vec![vec![first, second]])
}

/// The least and the largest of numbers, apart in any case.
fn ends<'a>(values: impl IntoIterator<Item = &'a f64>) -> (f64, f64) {
    let values = values.into_iter().copied().filter(|x| x.is_finite());
    let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), x| {
        (least.min(x), most.max(x))
    });
    match least <= most {
        false => (0.0, 1.0),
        true if most - least <= 1e-9 * most.abs().max(least.abs()) => {
            let around = match most.abs() {
                0.0 => 1.0,
                size => FREE * size,
            };
            (least - around, most + around)
        }
        true => (least, most),
    }
}
