//! The picture of a sweep: the map of regimes with bifurcations over it, what there is along one parameter, or the basins of starts.

use super::super::report::Report;
use super::curves::curves;
use std::path::Path;
use twinslip::bifurcation::LocusRow;
use twinslip::error::Result;
use twinslip::sweep::{Grid, Range, SweepRow};
use twinslip_output::plot::Drawing;
use twinslip_tasks::scene::{Described, Moving, Quantity, SweepPlan, Swept};
use twinslip_tasks::views::{self, Basins, GridSide, PointOutcome};

/// Draws what there is: points that are missing stay white.
pub fn draw(plan: &SweepPlan, report: &Report<'_>, rows: &[SweepRow], path: &Path) -> Result<()> {
    if rows.is_empty() {
        report.say("there is no point to draw");
        return Ok(());
    }
    if plan.diagram.is_some() {
        return report.draw(path, &dots(plan, rows));
    }
    let outcomes: Vec<PointOutcome> = rows.iter().map(views::outcome).collect();
    let units = plan.system.units();
    let side = |range: &Range| GridSide {
        values: range.values().collect(),
        log: range.log,
    };
    // Who has ended the sweep does not wait for them.
    let curves = match report.call.stops() {
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
            ..
        } => views::basin_map(
            &outcomes,
            (&side(state_1), &side(state_2)),
            (loading.driving, loading.stiffness),
            units,
        ),
        Grid::Systems { axes, .. } => {
            let sides: Vec<GridSide> = axes.iter().map(side).collect();
            let [along, up] = plan.axis_labels();
            match (&sides[..], basins(plan, &outcomes)) {
                ([x, y], Some(basins)) => views::basins_of_states(&outcomes, [x, y], basins, units),
                ([x, y], None) => {
                    let sides = [(x, along), (y, up)];
                    views::parameter_map(&outcomes, sides, plan.settings.starts, &curves, units)
                }
                ([x], _) => line(plan, &outcomes, (x, along)),
                _ => unreachable!("a plan with a picture has an axis or two"),
            }
        }
        Grid::Plane {
            driving, stiffness, ..
        } => {
            let outward = |range: &Range, quantity| GridSide {
                values: range.values().map(|x| units.outward(quantity, x)).collect(),
                log: range.log,
            };
            let label = |name, quantity| views::axis_label(name, quantity, units);
            match (driving.count, stiffness.count) {
                (2.., 1) => {
                    let side = outward(driving, Quantity::SlipRate);
                    line(plan, &outcomes, (&side, label("V_H", Quantity::SlipRate)))
                }
                (1, 2..) => {
                    let side = outward(stiffness, Quantity::Stiffness);
                    line(plan, &outcomes, (&side, label("K", Quantity::Stiffness)))
                }
                _ => {
                    let sides = (&side(driving), &side(stiffness));
                    views::regime_map(&outcomes, sides, plan.settings.starts, &curves, units)
                }
            }
        }
    };
    report.draw(path, &drawing)
}

/// The values that a state comes back to along the parameter that varies.
fn dots(plan: &SweepPlan, rows: &[SweepRow]) -> Drawing {
    let units = plan.system.units();
    let ranges = plan.settings.grid.ranges();
    let of = ranges.iter().position(|range| range.count > 1).unwrap_or(0);
    let of_plane = ["V_H", "K"].map(str::to_owned);
    let quantities = [Quantity::SlipRate, Quantity::Stiffness];
    let (label, values) = match &plan.settings.grid {
        Grid::Systems { axes, .. } => (plan.axis_labels()[of].clone(), axes[of].values().collect()),
        _ => (
            views::axis_label(&of_plane[of], quantities[of], units),
            ranges[of]
                .values()
                .map(|x| units.outward(quantities[of], x))
                .collect(),
        ),
    };
    let side = GridSide {
        values,
        log: ranges[of].log,
    };
    let title = match &plan.system {
        Swept::Text(model) if model.slab.is_none() => {
            let varies = |name: &str| plan.layout.parameters.iter().any(|(own, _)| own == name);
            views::with_fixed_parameters(model, varies)
        }
        _ => String::new(),
    };
    let diagram = plan.diagram.as_ref().expect("a diagram is asked for");
    let starts = plan.settings.starts;
    views::diagram_picture(rows, (&side, label), starts, (diagram, title), units)
}

/// What runs go through along one parameter.
fn line(plan: &SweepPlan, outcomes: &[PointOutcome], side: (&GridSide, String)) -> Drawing {
    let (name, quantity) = range_of(plan);
    let units = plan.system.units();
    views::regime_line(
        outcomes,
        side,
        plan.settings.starts,
        (&name, quantity),
        units,
    )
}

/// What is to be said of the basins of starts of another system than two equal interfaces; `None` where the grid is of none.
fn basins(plan: &SweepPlan, outcomes: &[PointOutcome]) -> Option<Basins> {
    let states = plan.basin.as_ref()?;
    let units = plan.system.units();
    let label = |i: usize| {
        let name = format!("{} at the start", symbol(&states.names[i]));
        views::axis_label(&name, states.quantities[i], units)
    };
    let loading = plan.settings.parameters(0);
    let title = match (&plan.system, &loading[..]) {
        (Swept::Text(model), _) if model.slab.is_none() => {
            format!("of {}", views::with_parameters(model))
        }
        (_, [driving, stiffness, ..]) => {
            format!("at {}", views::parameters(*driving, *stiffness, units))
        }
        _ => String::new(),
    };
    let of_psi = states.quantities == [Quantity::State; 2];
    Some(Basins {
        title: format!("basins {title}"),
        labels: [label(0), label(1)],
        equal_stay_equal: of_psi && outcomes.iter().any(|one| one.symmetry.is_some()),
        range_of: Some(range_of(plan)),
    })
}

/// What the range that rows tell is of, and what it measures.
fn range_of(plan: &SweepPlan) -> (String, Quantity) {
    match &plan.layout.moves {
        Moving::Interfaces(_) => ("stress τ".into(), Quantity::Stress),
        Moving::States(states, section) => (states[*section].into(), Quantity::Number),
    }
}

/// The symbol of a state of interfaces; other names are their own.
fn symbol(name: &str) -> &str {
    match name {
        "stress" => "τ",
        "state_1" => "ψ₁",
        "state_2" => "ψ₂",
        other => other,
    }
}
