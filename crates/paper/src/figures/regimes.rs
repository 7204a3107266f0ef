//! The regimes of Fig. 6: the areas between its curves.

use crate::Curves;
use crate::pieces::Pieces;
use twinslip::bifurcation::LocusRow;
use twinslip::equilibrium::Symmetry;
use twinslip::error::Result;
use twinslip::number::between_in_log;
use twinslip_output::plot::Area;

/// Driving velocities at which the curves are looked up, beside those of their own points.
const POINTS: usize = 400;
/// Stiffnesses at and beyond the ends of the frame.
const BOTTOM: f64 = 0.0;
const TOP: f64 = 1.0;

/// A regime: its name in the legend, its colour, and its stiffnesses at a driving velocity, from where to where.
type Regime<'a> = (&'static str, usize, &'a dyn Fn(f64) -> Option<(f64, f64)>);

/// The areas of all regimes but that in which both interfaces slide steadily.
pub fn regimes(pieces: &Pieces<'_>) -> Result<Vec<Area>> {
    let (hopf, forks) = (
        pieces.curves("fig06")?,
        pieces.curves("fig06-orbit-pitchforks")?,
    );
    let (torus, doubling) = (
        pieces.curves("fig12")?,
        pieces.curves("fig12-period-doubling")?,
    );
    let pitchforks = pieces.curves("fig06-pitchforks")?;
    let folds = pieces.curves("fig06-folds")?;
    let ends = |curves: &Curves| {
        let all = curves.rows.iter().map(|row| row.driving.value);
        all.fold((f64::INFINITY, 0.0_f64), |(low, high), v| {
            (low.min(v), high.max(v))
        })
    };
    let (first, second) = ends(&pitchforks);
    let (_, fold) = ends(&folds);
    let hopf: Vec<LocusRow> = hopf
        .rows
        .iter()
        .filter(|row| row.symmetry == Symmetry::Asymmetric)
        .cloned()
        .collect();
    // Above it the asymmetric state is stable; beyond its ends it is at all stiffnesses.
    let steady_from = |v: f64| heights(&hopf, v).map_or(BOTTOM, |(_, high)| high);
    let symmetric_to = |v: f64| heights(&forks.rows, v).map_or(BOTTOM, |(_, high)| high);
    let loop_rows = [&torus.rows[..], &doubling.rows[..]].concat();
    let unstable = |v: f64| heights(&loop_rows, v).filter(|(low, high)| low < high);
    let nonempty = |(low, high): (f64, f64)| (low < high).then_some((low, high));
    let below_loop = |v: f64| {
        let top = unstable(v).map_or(steady_from(v), |(low, _)| low);
        nonempty((symmetric_to(v), top))
    };
    let above_loop = |v: f64| unstable(v).and_then(|(_, high)| nonempty((high, steady_from(v))));
    let one = |v: f64| nonempty((steady_from(v).max(symmetric_to(v)), TOP));
    let asymmetric = "asymmetric stick-slip";
    let all: [Regime<'_>; 5] = [
        ("one slides steadily", 2, &one),
        (asymmetric, 5, &below_loop),
        (asymmetric, 5, &above_loop),
        ("complicated motion", 0, &unstable),
        ("symmetric stick-slip too", 3, &|v| {
            nonempty((BOTTOM, symmetric_to(v)))
        }),
    ];
    let rates = rates((first, second), &[&hopf, &forks.rows, &loop_rows]);
    let mut areas: Vec<Area> = all.into_iter().map(|regime| area(regime, &rates)).collect();
    let bistable: Regime<'_> = ("one or both slide steadily", 6, &|_| Some((BOTTOM, TOP)));
    areas.push(area(bistable, &[second, fold]));
    Ok(areas)
}

/// The driving velocities between two at which the areas have corners.
fn rates((first, last): (f64, f64), curves: &[&[LocusRow]]) -> Vec<f64> {
    let grid = (0..=POINTS).map(|i| between_in_log(first, last, i as f64 / POINTS as f64));
    let own = curves
        .iter()
        .flat_map(|rows| rows.iter().map(|row| row.driving.value));
    let mut rates: Vec<f64> = grid
        .chain(own)
        .filter(|v| (first..=last).contains(v))
        .collect();
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    rates
}

/// The least and the largest stiffness of curves at a driving velocity, between their points.
fn heights(rows: &[LocusRow], driving: f64) -> Option<(f64, f64)> {
    let mut found: Option<(f64, f64)> = None;
    for pair in rows
        .windows(2)
        .filter(|pair| pair[0].curve == pair[1].curve)
    {
        let [a, b] = [&pair[0], &pair[1]];
        let (from, to) = (a.driving.value, b.driving.value);
        if driving < from.min(to) || driving > from.max(to) {
            continue;
        }
        let part = if from == to {
            0.0
        } else {
            (driving - from) / (to - from)
        };
        let height = a.stiffness.value + part * (b.stiffness.value - a.stiffness.value);
        let (low, high) = found.unwrap_or((height, height));
        found = Some((low.min(height), high.max(height)));
    }
    found
}

fn area((label, colour, at): Regime<'_>, rates: &[f64]) -> Area {
    let sides = rates.iter().map(|&v| at(v).unwrap_or((f64::NAN, f64::NAN)));
    let (lower, upper) = sides.unzip();
    Area {
        label: label.into(),
        x: rates.to_vec(),
        lower,
        upper,
        colour,
        left_out: Vec::new(),
    }
}
