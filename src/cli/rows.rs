//! The rows of branches and of curves, and the way back from CSV.

use crate::bifurcation::{BranchRow, Criticality, Event, Label, LocusRow, Special};
use crate::equilibrium::{Symmetry, Verdict};
use crate::number::Uncertain;
use crate::scene::{Quantity, Units};

/// A row of a branch or of a curve.
pub trait CurveRow: Sized {
    /// What rows of one number make up.
    const WHOLE: &'static str;
    /// The same, more of them.
    const WHOLES: &'static str;
    /// The row that an event is, if it is one of these.
    fn of(event: Event) -> Option<Self>;
    /// From the cells of a CSV in the user's units.
    fn read(cell: &dyn Fn(&str) -> String, units: &Units) -> Option<Self>;
    /// The number of the branch or curve.
    fn number(&self) -> usize;
    /// V_H and K.
    fn loading(&self) -> (Uncertain, Uncertain);
    /// Whether its stability is undecided where it could be told.
    fn undecided(&self) -> bool;
}

/// A value whose error budget was not written.
pub fn unknown(value: f64) -> Uncertain {
    Uncertain::new(value, f64::INFINITY)
}

/// A value with its error budget.
fn uncertain(
    cell: &dyn Fn(&str) -> String,
    units: &Units,
    name: &str,
    quantity: Quantity,
) -> Option<Uncertain> {
    let number = |name: &str| cell(name).parse::<f64>().ok();
    let value = units.inward(quantity, number(name)?);
    let bound = number(&format!("{name}_uncertainty"));
    Some(bound.map_or(unknown(value), |bound| {
        Uncertain::new(value, bound / units.factor(quantity))
    }))
}

fn criticality(cell: &dyn Fn(&str) -> String) -> Option<Criticality> {
    let sides = [
        Criticality::Supercritical,
        Criticality::Subcritical,
        Criticality::Undecided,
    ];
    let name = cell("criticality");
    sides.into_iter().find(|side| side.name() == name)
}

/// A special point from the cells of a CSV in the user's units.
pub fn special_row(cell: &dyn Fn(&str) -> String, units: &Units) -> Option<Special> {
    let uncertain = |name: &str, quantity| uncertain(cell, units, name, quantity);
    Some(Special {
        label: Label::named(&cell("label"))?,
        branch: cell("branch").parse().ok()?,
        symmetry: Symmetry::named(&cell("symmetry")),
        driving: uncertain("driving", Quantity::SlipRate)?,
        stiffness: uncertain("stiffness", Quantity::Stiffness)?,
        period: uncertain("period", Quantity::Time),
        criticality: criticality(cell),
        coefficient: cell("coefficient").parse().ok(),
        coefficient_uncertainty: cell("coefficient_uncertainty").parse().ok(),
        note: Some(cell("note")).filter(|note| !note.is_empty()),
        orbit: None,
    })
}

impl CurveRow for BranchRow {
    const WHOLE: &'static str = "branch";
    const WHOLES: &'static str = "branches";

    fn of(event: Event) -> Option<Self> {
        match event {
            Event::Branch(row) => Some(row),
            _ => None,
        }
    }

    fn read(cell: &dyn Fn(&str) -> String, units: &Units) -> Option<Self> {
        let maybe = |name: &str, quantity| {
            let x = cell(name).parse::<f64>().ok()?;
            Some(units.inward(quantity, x))
        };
        let both = |name: &str, quantity| {
            let first = maybe(&format!("{name}_1"), quantity)?;
            // A single interface has one column.
            Some([
                first,
                maybe(&format!("{name}_2"), quantity).unwrap_or(first),
            ])
        };
        let verdicts = [Verdict::Stable, Verdict::Unstable, Verdict::Undecided];
        Some(BranchRow {
            branch: cell("branch").parse().ok()?,
            symmetry: Symmetry::named(&cell("symmetry"))?,
            driving: maybe("driving", Quantity::SlipRate)?,
            stiffness: maybe("stiffness", Quantity::Stiffness)?,
            stress: maybe("stress", Quantity::Stress)?,
            stress_range: (
                maybe("stress_min", Quantity::Stress)?,
                maybe("stress_max", Quantity::Stress)?,
            ),
            period: maybe("period", Quantity::Time),
            state: both("state", Quantity::State)?,
            slip_rate: both("slip_rate", Quantity::SlipRate)?,
            // Not shown but in the line itself, which is kept as it stands.
            ln_abs_multiplier: [None; 2],
            verdict: verdicts
                .into_iter()
                .find(|&verdict| verdict.name() == cell("verdict"))?,
            label: Label::named(&cell("label")),
        })
    }

    fn number(&self) -> usize {
        self.branch
    }

    fn loading(&self) -> (Uncertain, Uncertain) {
        (unknown(self.driving), unknown(self.stiffness))
    }

    /// At a bifurcation, and where a branch ends in one, there is nothing to decide.
    fn undecided(&self) -> bool {
        self.verdict == Verdict::Undecided && matches!(self.label, None | Some(Label::Uz))
    }
}

impl CurveRow for LocusRow {
    const WHOLE: &'static str = "curve";
    const WHOLES: &'static str = "curves";

    fn of(event: Event) -> Option<Self> {
        match event {
            Event::Locus(row) => Some(row),
            _ => None,
        }
    }

    fn read(cell: &dyn Fn(&str) -> String, units: &Units) -> Option<Self> {
        let number = |name: &str| cell(name).parse::<f64>().ok();
        let uncertain = |name: &str, quantity| uncertain(cell, units, name, quantity);
        Some(LocusRow {
            curve: cell("curve").parse().ok()?,
            symmetry: Symmetry::named(&cell("symmetry"))?,
            driving: uncertain("driving", Quantity::SlipRate)?,
            stiffness: uncertain("stiffness", Quantity::Stiffness)?,
            period: number("period").map(|t| units.inward(Quantity::Time, t)),
            angle_over_pi: number("angle_over_pi"),
            criticality: criticality(cell),
            label: Label::named(&cell("label")),
        })
    }

    fn number(&self) -> usize {
        self.curve
    }

    fn loading(&self) -> (Uncertain, Uncertain) {
        (self.driving, self.stiffness)
    }

    /// Points of a curve have no verdict.
    fn undecided(&self) -> bool {
        false
    }
}
