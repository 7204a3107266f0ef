//! The picture of a sweep: the map of regimes with bifurcations over it, or the basins of starts.

use super::super::interrupt;
use super::super::report::Report;
use crate::bifurcation::{Event, LocusRow};
use crate::error::Result;
use crate::output::plot;
use crate::scene::{LocusPlan, SweepPlan};
use crate::sweep::{Grid, Range, Row};
use crate::views::{self, Outcome, Side};
use std::ops::ControlFlow;
use std::path::Path;

/// Draws what there is: points that are missing stay white.
pub fn draw(plan: &SweepPlan, report: &Report<'_>, rows: &[Row], path: &Path) -> Result<()> {
    if rows.is_empty() {
        report.say("there is no point to draw");
        return Ok(());
    }
    let outcomes: Vec<Outcome> = rows.iter().map(views::outcome).collect();
    let units = &plan.system.units;
    let side = |range: &Range| Side {
        values: range.values().collect(),
        log: range.log,
    };
    let drawing = match &plan.settings.grid {
        Grid::Basin {
            loading,
            state_1,
            state_2,
        } => views::basin_map(
            &outcomes,
            (&side(state_1), &side(state_2)),
            (loading.driving, loading.stiffness),
            units,
        ),
        Grid::Plane { driving, stiffness } => {
            let curves: Vec<(&str, Vec<LocusRow>)> = plan
                .curves
                .iter()
                .map(|locus| (locus.curve.title, points(locus, report)))
                .collect();
            let curves: Vec<(&str, &[LocusRow])> = curves
                .iter()
                .map(|(title, points)| (*title, &points[..]))
                .collect();
            let sides = (&side(driving), &side(stiffness));
            views::regime_map(&outcomes, sides, plan.settings.starts, &curves, units)
        }
    };
    plot::write(path, &drawing)
}

/// The points of a curve; a map without all of it is better than none.
fn points(locus: &LocusPlan, report: &Report<'_>) -> Vec<LocusRow> {
    let mut points = Vec::new();
    if interrupt::asked() {
        return points;
    }
    let followed = locus.follow(&[], &mut |event| {
        if let Event::Locus(row) = event {
            points.push(row);
        }
        match interrupt::asked() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    });
    if let Err(error) = followed {
        report.say(format!(
            "of the {} over the map: {error}",
            locus.curve.title
        ));
    }
    points
}
