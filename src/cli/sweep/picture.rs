//! The picture of a sweep: the map of regimes with bifurcations over it, or the basins of starts.

use super::super::interrupt;
use super::super::report::Report;
use super::curves::curves;
use crate::bifurcation::LocusRow;
use crate::error::Result;
use crate::output::plot;
use crate::scene::{Described, SweepPlan};
use crate::sweep::{Grid, Range, SweepRow};
use crate::views::{self, GridSide, PointOutcome};
use std::path::Path;

/// Draws what there is: points that are missing stay white.
pub fn draw(plan: &SweepPlan, report: &Report<'_>, rows: &[SweepRow], path: &Path) -> Result<()> {
    if rows.is_empty() {
        report.say("there is no point to draw");
        return Ok(());
    }
    let outcomes: Vec<PointOutcome> = rows.iter().map(views::outcome).collect();
    let units = plan.system.units();
    let side = |range: &Range| GridSide {
        values: range.values().collect(),
        log: range.log,
    };
    // Who has ended the sweep does not wait for them.
    let curves = match interrupt::asked() {
        true => Vec::new(),
        false => curves(&plan.curves, report),
    };
    let curves: Vec<(&str, &[LocusRow])> = curves
        .iter()
        .map(|(title, points)| (*title, &points[..]))
        .collect();
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
        Grid::Laws { axes, .. } | Grid::Systems { axes, .. } => {
            let [x, y] = &axes[..] else {
                unreachable!("a plan with a picture has two axes");
            };
            let (x, y) = (side(x), side(y));
            let [along, up] = plan.axis_labels();
            let sides = [(&x, along), (&y, up)];
            views::parameter_map(&outcomes, sides, plan.settings.starts, &curves, units)
        }
        Grid::Plane { driving, stiffness } => {
            let sides = (&side(driving), &side(stiffness));
            views::regime_map(&outcomes, sides, plan.settings.starts, &curves, units)
        }
    };
    plot::write(path, &drawing)
}
