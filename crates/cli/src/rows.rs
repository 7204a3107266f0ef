//! The rows of branches and of curves, and the way back from CSV.

use twinslip::bifurcation::equilibria::{ClusterOfRow, EquilibriumOfRow};
use twinslip::bifurcation::{BranchRow, Criticality, Event, Label, LocusRow, Special};
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::number::Uncertain;
use twinslip_output::seven_digits;
use twinslip_tasks::scene::{GeneralRow, Quantity, Units};

/// A row of a branch or of a curve.
pub trait CurveRow: Sized {
    /// What special points are.
    type Special: SpecialPoint;
    /// The number of the branch or curve.
    fn number(&self) -> usize;
    /// Where it is, in the user's units.
    fn place(&self, names: &[&str], units: &Units) -> String;
    /// Whether its stability is undecided where it could be told.
    fn undecided(&self) -> bool;
    /// Whether it is of two equal interfaces that do not move alike, and stands for its mirror image too.
    fn is_mirrored(&self) -> bool {
        false
    }
}

/// A special point.
pub trait SpecialPoint: Sized {
    /// The number of the branch or curve.
    fn number(&self) -> usize;
    /// What it is.
    fn label(&self) -> Option<Label>;
    /// To which side the bifurcation goes.
    fn criticality(&self) -> Option<Criticality>;
    /// What else is to be said.
    fn note(&self) -> Option<&str>;
    /// Changes that.
    fn noted(&mut self, note: Option<String>);
    /// Where it is, in the user's units.
    fn place(&self, names: &[&str], units: &Units) -> String;
}

/// A row, or a special point.
pub enum Found<R: CurveRow> {
    /// A row.
    Row(R),
    /// A special point.
    Special(R::Special),
}

/// A row of interfaces in V_H and K.
pub trait SlabRow: CurveRow<Special = Special> {
    /// The row that an event is, if it is one of these.
    fn of(event: Event) -> Option<Self>;
    /// From the cells of a CSV in the user's units.
    fn read(cell: &dyn Fn(&str) -> String, units: &Units) -> Option<Self>;

    /// What an event is, if it is of this kind.
    fn found(event: Event) -> Option<Found<Self>> {
        match event {
            Event::Special(special) => Some(Found::Special(special)),
            row => Self::of(row).map(Found::Row),
        }
    }
}

/// V_H and K to seven digits.
fn loading(driving: f64, stiffness: f64, units: &Units) -> String {
    let driving = seven_digits(units.outward(Quantity::SlipRate, driving));
    let stiffness = seven_digits(units.outward(Quantity::Stiffness, stiffness));
    format!("V_H = {driving}, K = {stiffness}")
}

impl SpecialPoint for Special {
    fn number(&self) -> usize {
        self.branch
    }

    fn label(&self) -> Option<Label> {
        Some(self.label)
    }

    fn criticality(&self) -> Option<Criticality> {
        self.criticality
    }

    fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    fn noted(&mut self, note: Option<String>) {
        self.note = note;
    }

    fn place(&self, _: &[&str], units: &Units) -> String {
        let driving = units.outward(Quantity::SlipRate, self.driving.value);
        let stiffness = units.outward(Quantity::Stiffness, self.stiffness.value);
        format!("V_H = {driving}, K = {stiffness}")
    }
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

fn verdict(cell: &dyn Fn(&str) -> String) -> Option<Verdict> {
    let verdicts = [Verdict::Stable, Verdict::Unstable, Verdict::Undecided];
    let name = cell("verdict");
    verdicts.into_iter().find(|verdict| verdict.name() == name)
}

/// How many interfaces slide on the slow, the middle and the fast branch.
fn share(cell: &dyn Fn(&str) -> String) -> Option<[usize; 3]> {
    let count = |name: &str| cell(name).parse().ok();
    Some([count("slow")?, count("middle")?, count("fast")?])
}

/// A special point from the cells of a CSV in the user's units.
pub fn special_row(cell: &dyn Fn(&str) -> String, units: &Units) -> Option<Special> {
    let uncertain = |name: &str, quantity| uncertain(cell, units, name, quantity);
    let number = |name: &str, quantity| {
        let x: f64 = cell(name).parse().ok()?;
        Some(units.inward(quantity, x))
    };
    let state = number("stress", Quantity::Stress).map(|stress| {
        let states = ["state_1", "state_2"];
        let states = states.map(|name| number(name, Quantity::State).map(f64::ln));
        [Some(stress)].into_iter().chain(states).flatten().collect()
    });
    Some(Special {
        state,
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
    type Special = Special;

    fn number(&self) -> usize {
        self.branch
    }

    fn is_mirrored(&self) -> bool {
        let share = self.equilibrium.as_ref().and_then(|one| one.share);
        self.symmetry == Symmetry::Asymmetric && share.is_none()
    }

    fn place(&self, _: &[&str], units: &Units) -> String {
        loading(self.driving, self.stiffness, units)
    }

    /// At a bifurcation, and where a branch ends in one, there is nothing to decide.
    fn undecided(&self) -> bool {
        self.verdict == Verdict::Undecided && matches!(self.label, None | Some(Label::Uz))
    }
}

impl SlabRow for BranchRow {
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
            verdict: verdict(cell)?,
            label: Label::named(&cell("label")),
            equilibrium: equilibrium(cell, units),
        })
    }
}

/// The fields of an equilibrium beside those of the contract; for more than two interfaces the columns have clusters.
fn equilibrium(cell: &dyn Fn(&str) -> String, units: &Units) -> Option<EquilibriumOfRow> {
    let number = |name: &str, quantity| {
        let x = cell(name).parse::<f64>().ok()?;
        Some(units.inward(quantity, x))
    };
    let count = |name: &str| cell(name).parse::<usize>().ok();
    let cluster = |i: usize| {
        Some(ClusterOfRow {
            count: count(&format!("count_{i}"))?,
            state: number(&format!("state_{i}"), Quantity::State)?,
            slip_rate: number(&format!("slip_rate_{i}"), Quantity::SlipRate)?,
        })
    };
    Some(EquilibriumOfRow {
        share: share(cell),
        clusters: (1..=3).map_while(cluster).collect(),
        // Not shown but in the line itself, which is kept as it stands.
        eigenvalues: Vec::new(),
        unstable: count("unstable")?,
    })
}

impl CurveRow for LocusRow {
    type Special = Special;

    fn number(&self) -> usize {
        self.curve
    }

    fn is_mirrored(&self) -> bool {
        self.symmetry == Symmetry::Asymmetric && self.share.is_none()
    }

    fn place(&self, _: &[&str], units: &Units) -> String {
        loading(self.driving.value, self.stiffness.value, units)
    }

    /// Points of a curve have no verdict.
    fn undecided(&self) -> bool {
        false
    }
}

impl SlabRow for LocusRow {
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
            share: share(cell),
        })
    }
}

/// The names of the free parameters with their values.
fn named(names: &[&str], row: &GeneralRow) -> String {
    let pairs = names.iter().zip(&row.parameters);
    let pairs: Vec<_> = pairs
        .map(|(name, x)| format!("{name} = {}", seven_digits(x.value)))
        .collect();
    pairs.join(", ")
}

impl SpecialPoint for GeneralRow {
    fn number(&self) -> usize {
        self.number
    }

    fn label(&self) -> Option<Label> {
        self.label
    }

    fn criticality(&self) -> Option<Criticality> {
        self.criticality
    }

    fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    fn noted(&mut self, note: Option<String>) {
        self.note = note;
    }

    fn place(&self, names: &[&str], _: &Units) -> String {
        named(names, self)
    }
}

impl CurveRow for GeneralRow {
    type Special = GeneralRow;

    fn number(&self) -> usize {
        self.number
    }

    fn is_mirrored(&self) -> bool {
        self.symmetry == Some(Symmetry::Asymmetric)
    }

    fn place(&self, names: &[&str], _: &Units) -> String {
        named(names, self)
    }

    fn undecided(&self) -> bool {
        self.verdict == Some(Verdict::Undecided) && matches!(self.label, None | Some(Label::Uz))
    }
}
