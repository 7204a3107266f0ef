//! What the rows of branches and curves, and special points, show.

use super::equilibria::{CLUSTERS, eigenvalue_columns};
use crate::scene::{CellValue, Column, Quantity};
use twinslip::bifurcation::equilibria::ClusterOfRow;
use twinslip::bifurcation::{BranchRow, Criticality, Label, LocusRow, Special};
use twinslip::equilibrium::Symmetry;

/// The columns of branches of orbits of one interface or two, or of equilibria of any number, of more than two by clusters, slowest first. A
/// table leaves out what is less looked at.
pub fn branch_columns(orbits: bool, interfaces: usize) -> Vec<Column<BranchRow>> {
    use Quantity::{Growth, Number, SlipRate, State, Stiffness, Stress, Time};
    type Row = BranchRow;
    // The exponent of an equilibrium is a rate, that of an orbit belongs to its period.
    let exponent = if orbits { Number } else { Growth };
    let many = interfaces > 2;
    let mut columns = vec![
        Column::new("driving", SlipRate, |row: &Row| row.driving.into()),
        Column::new("stiffness", Stiffness, |row: &Row| row.stiffness.into()),
        Column::new("stress", Stress, |row: &Row| row.stress.into()),
        Column::new("stress_min", Stress, |row: &Row| row.stress_range.0.into()),
        Column::new("stress_max", Stress, |row: &Row| row.stress_range.1.into()),
        Column::new("period", Time, |row: &Row| row.period.into()),
    ];
    let each = |name: &str, quantity, of: fn(&ClusterOfRow) -> CellValue| {
        let column = |i| {
            Column::new(format!("{name}_{}", i + 1), quantity, move |row: &Row| {
                let one = row.equilibrium.as_ref().and_then(|one| one.clusters.get(i));
                one.map_or(CellValue::Number(None), of)
            })
        };
        (0..CLUSTERS).map(column).collect::<Vec<_>>()
    };
    let pair = |name: &str, quantity, of: fn(&Row) -> [f64; 2]| {
        let column = |i: usize| {
            Column::new(format!("{name}_{}", i + 1), quantity, move |row: &Row| {
                of(row)[i].into()
            })
        };
        (0..interfaces.min(2)).map(column).collect::<Vec<_>>()
    };
    if many {
        columns.extend(share_columns(|row: &Row| row.equilibrium.as_ref()?.share));
        columns.extend(each("count", Number, |one| one.count.into()));
        columns.extend(each("state", State, |one| one.state.into()));
        columns.extend(each("slip_rate", SlipRate, |one| one.slip_rate.into()));
    } else {
        columns.extend(pair("state", State, |row| row.state));
        columns.extend(pair("slip_rate", SlipRate, |row| row.slip_rate));
    }
    for i in 0..interfaces.min(2) {
        let name = format!("ln_abs_multiplier_{}", i + 1);
        let entry = move |row: &Row| row.ln_abs_multiplier[i].into();
        columns.push(Column::new(name, exponent, entry));
    }
    let unstable = Column::new("unstable", Number, |row: &Row| {
        let count = row.equilibrium.as_ref().map(|known| known.unstable);
        count.map_or(CellValue::Number(None), CellValue::from)
    });
    let (before, behind) = match many {
        true => (Some(unstable), None),
        false => (None, (!orbits).then_some(unstable)),
    };
    columns.extend(before);
    columns.extend([
        Column::new("verdict", Number, |row: &Row| row.verdict.name().into()),
        Column::new("label", Number, |row: &Row| {
            row.label.map(Label::name).into()
        }),
        Column::new("branch", Number, |row: &Row| row.branch.into()),
        Column::new("symmetry", Number, |row: &Row| row.symmetry.name().into()),
    ]);
    if !orbits {
        columns.extend(eigenvalue_columns(interfaces, |row: &Row| {
            let known = row.equilibrium.as_ref();
            known.map_or(&[], |known| &known.eigenvalues)
        }));
    }
    columns.extend(behind);
    let left_out = |name: &str| match (orbits, many) {
        (true, _) => matches!(
            name,
            "stress" | "slip_rate_1" | "slip_rate_2" | "ln_abs_multiplier_2" | "symmetry"
        ),
        (false, true) => {
            let starts = |prefix: &&str| name.starts_with(prefix);
            let mut prefixes = ["stress_", "period", "count_", "state_"].iter();
            prefixes.any(starts) || left_out_of_equilibria(name)
        }
        (false, false) => {
            ["stress_min", "stress_max", "period", "unstable"].contains(&name)
                || left_out_of_equilibria(name)
        }
    };
    for column in &mut columns {
        column.in_table = !left_out(&column.name);
    }
    columns
}

fn left_out_of_equilibria(name: &str) -> bool {
    let aside = ["ln_abs_multiplier_", "eigenvalue_", "symmetry"];
    aside.iter().any(|prefix| name.starts_with(prefix))
}

/// How many interfaces slide on the slow, the middle and the fast branch of the steady curve.
fn share_columns<R: 'static>(share: fn(&R) -> Option<[usize; 3]>) -> Vec<Column<R>> {
    let names = ["slow", "middle", "fast"].into_iter().enumerate();
    let column = |(i, name): (usize, &'static str)| {
        Column::new(name, Quantity::Number, move |row: &R| {
            let count = share(row).map(|share| share[i]);
            count.map_or(CellValue::Number(None), CellValue::from)
        })
    };
    names.map(column).collect()
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
        columns.extend(share_columns(|row: &Row| row.share));
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
        Column::new("stress", Quantity::Stress, |one: &Special| {
            one.state.as_ref().map(|state| state[0]).into()
        })
        .not_in_table(),
        state_column(1),
        state_column(2),
    ]
}

/// The state of one of the interfaces; where both slide alike there is one for both.
fn state_column(interface: usize) -> Column<Special> {
    let state = move |one: &Special| {
        let state = one.state.as_ref()?;
        Some(state[interface.min(state.len() - 1)].exp())
    };
    Column::new(
        format!("state_{interface}"),
        Quantity::State,
        move |one: &Special| state(one).into(),
    )
    .not_in_table()
}
