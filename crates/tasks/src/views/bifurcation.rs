//! What the rows of branches and curves, and special points, show.

use crate::scene::{CellValue, Column, Quantity};
use twinslip::bifurcation::{BranchRow, Criticality, Label, LocusRow, Special};
use twinslip::equilibrium::Symmetry;

/// The columns of branches of orbits or of equilibria; a table leaves out what is less looked at.
pub fn branch_columns(orbits: bool, interfaces: usize) -> Vec<Column<BranchRow>> {
    use Quantity::{Growth, Number, SlipRate, State, Stiffness, Stress, Time};
    type Row = BranchRow;
    // The exponent of an equilibrium is a rate, that of an orbit belongs to its period.
    let exponent = if orbits { Number } else { Growth };
    let mut columns = vec![
        Column::new("driving", SlipRate, |row: &Row| row.driving.into()),
        Column::new("stiffness", Stiffness, |row: &Row| row.stiffness.into()),
        Column::new("stress", Stress, |row: &Row| row.stress.into()),
        Column::new("stress_min", Stress, |row: &Row| row.stress_range.0.into()),
        Column::new("stress_max", Stress, |row: &Row| row.stress_range.1.into()),
        Column::new("period", Time, |row: &Row| row.period.into()),
        Column::new("state_1", State, |row: &Row| row.state[0].into()),
        Column::new("state_2", State, |row: &Row| row.state[1].into()),
        Column::new("slip_rate_1", SlipRate, |row: &Row| row.slip_rate[0].into()),
        Column::new("slip_rate_2", SlipRate, |row: &Row| row.slip_rate[1].into()),
        Column::new("ln_abs_multiplier_1", exponent, |row: &Row| {
            row.ln_abs_multiplier[0].into()
        }),
        Column::new("ln_abs_multiplier_2", exponent, |row: &Row| {
            row.ln_abs_multiplier[1].into()
        }),
        Column::new("verdict", Number, |row: &Row| row.verdict.name().into()),
        Column::new("label", Number, |row: &Row| {
            row.label.map(Label::name).into()
        }),
        Column::new("branch", Number, |row: &Row| row.branch.into()),
        Column::new("symmetry", Number, |row: &Row| row.symmetry.name().into()),
    ];
    if interfaces == 1 {
        columns.retain(|column| !column.name.ends_with("_2"));
    }
    let left_out: &[&str] = if orbits {
        &[
            "stress",
            "slip_rate_1",
            "slip_rate_2",
            "ln_abs_multiplier_2",
            "symmetry",
        ]
    } else {
        &[
            "stress_min",
            "stress_max",
            "period",
            "ln_abs_multiplier_1",
            "ln_abs_multiplier_2",
            "symmetry",
        ]
    };
    for column in &mut columns {
        column.in_table = !left_out.contains(&&*column.name);
    }
    columns
}

/// The columns of curves, of more than two interfaces with their share.
pub fn locus_columns(interfaces: usize) -> Vec<Column<LocusRow>> {
    use Quantity::{Number, SlipRate, Stiffness, Time};
    type Row = LocusRow;
    let mut columns = vec![
        Column::uncertain("driving", SlipRate, |row: &Row| row.driving.into()),
        Column::uncertain("stiffness", Stiffness, |row: &Row| row.stiffness.into()),
        Column::new("period", Time, |row: &Row| row.period.into()),
        Column::new("angle_over_pi", Number, |row: &Row| {
            row.angle_over_pi.into()
        }),
        Column::new("criticality", Number, |row: &Row| {
            row.criticality.map(Criticality::name).into()
        }),
        Column::new("label", Number, |row: &Row| {
            row.label.map(Label::name).into()
        }),
        Column::new("curve", Number, |row: &Row| row.curve.into()),
        Column::new("symmetry", Number, |row: &Row| row.symmetry.name().into())
            .in_table_if(interfaces > 1),
    ];
    if interfaces > 2 {
        for (i, name) in ["slow", "middle", "fast"].into_iter().enumerate() {
            columns.push(Column::new(name, Number, move |row: &Row| {
                let count = row.share.map(|share| share[i]);
                count.map_or(CellValue::Number(None), CellValue::from)
            }));
        }
    }
    columns
}

/// The columns of special points.
pub fn special_columns() -> Vec<Column<Special>> {
    use Quantity::{Number, SlipRate, Stiffness, Time};
    vec![
        Column::new("label", Number, |one: &Special| one.label.name().into()),
        Column::new("name", Number, |one: &Special| one.label.meaning().into()),
        Column::new("branch", Number, |one: &Special| one.branch.into()),
        Column::new("symmetry", Number, |one: &Special| {
            one.symmetry.map(Symmetry::name).into()
        }),
        Column::uncertain("driving", SlipRate, |one: &Special| one.driving.into()),
        Column::uncertain("stiffness", Stiffness, |one: &Special| one.stiffness.into()),
        Column::uncertain("period", Time, |one: &Special| one.period.into()),
        Column::new("criticality", Number, |one: &Special| {
            one.criticality.map(Criticality::name).into()
        }),
        Column::new("coefficient", Number, |one: &Special| {
            one.coefficient.into()
        }),
        Column::new("note", Number, |one: &Special| {
            // A row is a line, whatever the reason says.
            CellValue::Word(one.note.as_ref().map(|note| note.replace('\n', " ")))
        }),
        Column::new("coefficient_uncertainty", Number, |one: &Special| {
            one.coefficient_uncertainty.into()
        }),
    ]
}
