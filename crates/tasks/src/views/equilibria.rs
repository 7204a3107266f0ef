//! What steady states show.

use crate::scene::{CellValue, ClassifiedEquilibrium, Column, Quantity};
use twinslip::equilibrium::{ClusterEigenvalue, ClusterStability, Equilibrium};

type Row = ClassifiedEquilibrium;

/// Interfaces that are told one by one; of more what is told is their clusters.
const ONE_BY_ONE: usize = 2;
/// A steady state has so many clusters at most, and so many eigenvalues of different kinds and values.
pub(super) const CLUSTERS: usize = 3;
const EIGENVALUES: usize = CLUSTERS + 1 + CLUSTERS;

/// The columns of the steady states of so many interfaces, of more than two by clusters. A table has room for what is looked at first: of
/// the eigenvalues for the leading one, which decides.
pub fn equilibria_columns(interfaces: usize) -> Vec<Column<ClassifiedEquilibrium>> {
    use Quantity::{LogState, Number, SlipRate, State, Stress};
    let by_clusters = interfaces > ONE_BY_ONE;
    let numbers = if by_clusters { CLUSTERS } else { interfaces };
    let each = |name: &str, quantity, list: fn(&Equilibrium) -> Vec<f64>| -> Vec<Column<Row>> {
        let column = |i| {
            Column::new(format!("{name}_{}", i + 1), quantity, move |row: &Row| {
                CellValue::from(list(&row.equilibrium).get(i).copied())
            })
        };
        (0..numbers).map(column).collect()
    };
    let aside = |columns: Vec<Column<Row>>| columns.into_iter().map(Column::not_in_table);
    let mut columns = vec![
        Column::new("symmetry", Number, |row: &Row| {
            row.equilibrium.symmetry.name().into()
        })
        .in_table_if(interfaces > 1),
        Column::uncertain("stress", Stress, |row: &Row| row.equilibrium.stress.into()),
    ];
    if by_clusters {
        let count = |i: usize| {
            Column::new(format!("count_{}", i + 1), Number, move |row: &Row| {
                let count = row.equilibrium.counts.get(i).copied();
                count.map_or(CellValue::Number(None), CellValue::from)
            })
        };
        columns.extend((0..CLUSTERS).map(count));
        columns.push(Column::new("arrangements", Number, |row: &Row| {
            /// Whole numbers up to this are exact as doubles.
            const EXACT: f64 = (1_u64 << 53) as f64;
            match row.equilibrium.arrangements() {
                ways if ways < EXACT => CellValue::from(ways as usize),
                ways => ways.into(),
            }
        }));
    }
    let state = each("state", State, Equilibrium::state);
    columns.extend(state.into_iter().map(|column| match by_clusters {
        true => column.not_in_table(),
        false => column,
    }));
    columns.extend(aside(each(
        "state_uncertainty",
        State,
        Equilibrium::state_uncertainty,
    )));
    columns.extend(aside(each("log_state", LogState, |one| {
        one.log_state.clone()
    })));
    columns.extend(aside(each(
        "log_state_uncertainty",
        // Of a logarithm: whatever the unit.
        Number,
        Equilibrium::log_state_uncertainty,
    )));
    columns.extend(each("slip_rate", SlipRate, |one| one.slip_rate.clone()));
    columns.extend(aside(each(
        "slip_rate_uncertainty",
        SlipRate,
        Equilibrium::slip_rate_uncertainty,
    )));
    columns.extend(eigenvalue_columns(interfaces, |row: &Row| {
        let known = row.stability.as_ref();
        known.map_or(&[], |stability| &stability.eigenvalues)
    }));
    for column in &mut columns {
        column.in_table &=
            !column.name.starts_with("eigenvalue_") || column.name.starts_with("eigenvalue_1_");
    }
    columns.extend([
        Column::new("verdict", Number, |row: &Row| {
            row.stability.as_ref().map(|s| s.verdict.name()).into()
        }),
        Column::new("residual", Number, |row: &Row| row.residual.into()).not_in_table(),
        Column::new("unstable", Number, |row: &Row| {
            let count = row.stability.as_ref().map(ClusterStability::unstable);
            count.map_or(CellValue::Number(None), CellValue::from)
        })
        .not_in_table(),
    ]);
    columns
}

/// The columns of the eigenvalues; for more than two interfaces with their multiplicity and direction.
pub(super) fn eigenvalue_columns<R: 'static>(
    interfaces: usize,
    of: fn(&R) -> &[ClusterEigenvalue],
) -> Vec<Column<R>> {
    use Quantity::{Growth, Number};
    let by_clusters = interfaces > ONE_BY_ONE;
    let of_one = move |i: usize| {
        let place = i + 1;
        let at = move |row: &R, i: usize| of(row).get(i).map(|one| one.value);
        let mut columns = Vec::from(Column::eigenvalue(i, Growth, at));
        columns.push(
            Column::new(
                format!("eigenvalue_uncertainty_{place}"),
                Growth,
                move |row: &R| of(row).get(i).map(|one| one.uncertainty).into(),
            )
            .not_in_table(),
        );
        if by_clusters {
            let multiplicity = move |row: &R| {
                let count = of(row).get(i).map(|one| one.multiplicity);
                count.map_or(CellValue::Number(None), CellValue::from)
            };
            let kind = move |row: &R| of(row).get(i).map(|one| one.kind.name()).into();
            columns.extend([
                Column::new(
                    format!("eigenvalue_{place}_multiplicity"),
                    Number,
                    multiplicity,
                )
                .not_in_table(),
                Column::new(format!("eigenvalue_{place}_kind"), Number, kind).not_in_table(),
            ]);
        }
        columns
    };
    let count = if by_clusters {
        EIGENVALUES
    } else {
        interfaces + 1
    };
    (0..count).flat_map(of_one).collect()
}
