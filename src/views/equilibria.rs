//! What steady states show.

use crate::equilibrium::Equilibrium;
use crate::scene::{CellValue, ClassifiedEquilibrium, Column, Quantity};

/// The columns of the steady states of so many interfaces. A table has room for what is looked at first: of the eigenvalues for the
/// leading one, which decides.
pub fn equilibria_columns(interfaces: usize) -> Vec<Column<ClassifiedEquilibrium>> {
    use Quantity::{Growth, LogState, Number, SlipRate, State, Stress};
    type Row = ClassifiedEquilibrium;
    let each = |name: &str, quantity, list: fn(&Equilibrium) -> Vec<f64>| -> Vec<Column<Row>> {
        let column = |i| {
            Column::new(format!("{name}_{}", i + 1), quantity, move |row: &Row| {
                CellValue::from(list(&row.equilibrium)[i])
            })
        };
        (0..interfaces).map(column).collect()
    };
    let aside = |columns: Vec<Column<Row>>| columns.into_iter().map(Column::not_in_table);
    let mut columns = vec![
        Column::new("symmetry", Number, |row: &Row| {
            row.equilibrium.symmetry.name().into()
        }),
        Column::uncertain("stress", Stress, |row: &Row| row.equilibrium.stress.into()),
    ];
    columns.extend(each("state", State, Equilibrium::state));
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
    for i in 0..=interfaces {
        let eigenvalue = move |row: &Row| row.stability.as_ref()?.eigenvalues.get(i).copied();
        let uncertainty = move |row: &Row| row.stability.as_ref()?.uncertainty.get(i).copied();
        let place = i + 1;
        let mut of_one = [
            Column::new(
                format!("eigenvalue_{place}_re"),
                Growth,
                move |row: &Row| eigenvalue(row).map(|z| z.re).into(),
            ),
            Column::new(
                format!("eigenvalue_{place}_im"),
                Growth,
                move |row: &Row| eigenvalue(row).map(|z| z.im).into(),
            ),
            Column::new(
                format!("eigenvalue_uncertainty_{place}"),
                Growth,
                move |row: &Row| uncertainty(row).into(),
            )
            .not_in_table(),
        ];
        for column in &mut of_one {
            column.in_table &= i == 0;
        }
        columns.extend(of_one);
    }
    columns.extend([
        Column::new("verdict", Number, |row: &Row| {
            row.stability.as_ref().map(|s| s.verdict.name()).into()
        }),
        Column::new("residual", Number, |row: &Row| row.residual.into()).not_in_table(),
    ]);
    columns
}
