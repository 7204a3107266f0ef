//! Fig. 7: periodic orbits and equilibria at K = 0.14.

use super::plane::{keys, labels, mark, marks, method};
use crate::product::{Made, Make, Product};
use crate::sheet::Sheet;
use crate::{Branches, Pieces};
use twinslip::bifurcation::{BranchRow, Label};
use twinslip::error::Result;
use twinslip_output::plot::{Axis, Drawing, Panel};
use twinslip_tasks::views::{branch_lines, named_strokes};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig07",
    title: "Bifurcation diagram at K = 0.14",
    caption: "(a) Stress of the equilibria, thin, and greatest and least stress of the periodic orbits, broad; stable solid, unstable dashed. Symmetric ones are blue, asymmetric ones vermillion. The asymmetric orbits come from the Hopf points of the asymmetric equilibrium, lose stability at a torus bifurcation (TR) at V_H = 0.07674 and are unstable from there to a second one at V_H = 0.100026, throughout; two period doublings (PD) between, at 0.08842 and 0.09980, only change how many multipliers are outside the unit circle, two or one. From 0.100026 on they are stable again. The symmetric orbits are unstable against asymmetry for all V_H at this stiffness, and hardly differ from the others in stress.

(b) Periods: they fall as 1/V_H and are nearly the same for both kinds.",
    alt: "Two panels against driving velocity: the extremes of stress over periodic orbits with the equilibria, and the periods. The asymmetric branch is stable but for the interval from 0.0767 to 0.1000 between two torus points, with two period-doubling points in it; the symmetric branch is unstable.",
    scenes: &["fig07", "fig07-equilibria"],
    make: Make::Figure(make),
};

/// V_H in the frames.
const DRIVING: (f64, f64) = (0.03, 1e5);
const OSCILLATING: (f64, f64) = (0.05, 300.0);

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let (orbits, rest) = (
        pieces.branches("fig07")?,
        pieces.branches("fig07-equilibria")?,
    );
    let mut sheet = Sheet::new();
    sheet.add_branches("orbits", &orbits);
    sheet.add_branches("equilibria", &rest);
    let tolerance = orbits.plan.following.tolerance;
    Ok(Made {
        sheet,
        drawing: Some(Drawing::columns(vec![vec![
            amplitudes("(a) extremes of stress, K = 0.14", &orbits, &rest, DRIVING),
            periods("(b) periods", &orbits, OSCILLATING),
        ]])),
        method: method(tolerance),
    })
}

fn x(row: &BranchRow) -> f64 {
    row.driving
}

/// Extremes of stress over orbits, with the equilibria.
pub fn amplitudes(title: &str, orbits: &Branches, rest: &Branches, driving: (f64, f64)) -> Panel {
    let most = |row: &BranchRow| row.stress_range.1;
    let least = |row: &BranchRow| row.stress_range.0;
    let mut series = branch_lines(&orbits.rows, &x, &most, true);
    series.extend(branch_lines(&orbits.rows, &x, &least, false));
    series.iter_mut().for_each(|orbits| orbits.wide = true);
    series.extend(branch_lines(&rest.rows, &x, &most, false));
    let mut points = marks(&rest.rows, x, most);
    points.extend(marks(&orbits.rows, x, most));
    points.extend(marks(&orbits.rows, x, least));
    let (lo, hi) = driving;
    points.retain(|mark| (lo..=hi).contains(&mark.x));
    Panel {
        strokes: named_strokes(&series),
        series,
        marks: points,
        keys: keys(labels([orbits, rest])),
        ..Panel::new(
            title,
            Axis::log("driving velocity V_H [V*]").within(lo, hi),
            Axis::linear("stress τ [aσ]"),
        )
    }
}

/// Periods of orbits.
pub fn periods(title: &str, orbits: &Branches, driving: (f64, f64)) -> Panel {
    let period = |row: &BranchRow| row.period.unwrap_or(f64::NAN);
    let hopf = orbits.special.iter().filter(|one| one.label == Label::Hb);
    let hopf = hopf.filter_map(|one| mark(one.label, one.driving.value, one.period?.value));
    let mut series = branch_lines(&orbits.rows, &x, &period, false);
    series.iter_mut().for_each(|orbits| orbits.wide = true);
    Panel {
        series,
        marks: marks(&orbits.rows, x, period)
            .into_iter()
            .chain(hopf)
            .collect(),
        ..Panel::new(
            title,
            Axis::log("driving velocity V_H [V*]").within(driving.0, driving.1),
            Axis::log("period T [L/V*]"),
        )
    }
}
