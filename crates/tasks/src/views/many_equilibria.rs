//! What the interfaces of a steady state show where there are many of them.

use crate::scene::{Column, Drawn, Quantity, SteadyInterface};
use twinslip::number::Uncertain;

/// The columns of interfaces with these constants of their own.
pub fn steady_interface_columns(drawn: &[Drawn]) -> Vec<Column<SteadyInterface>> {
    use Quantity::{LogState, Number, SlipRate, State};
    type Row = SteadyInterface;
    let mut columns = vec![
        Column::new("interface", Number, |row: &Row| row.interface.into())
            .meaning("number of the interface"),
        Column::new("state", State, |row: &Row| row.log_state.0.exp().into()).meaning("ψ"),
        Column::uncertain("log_state", LogState, |row: &Row| {
            Uncertain::new(row.log_state.0, row.log_state.1).into()
        })
        .meaning("ln ψ of the interface"),
        Column::uncertain("slip_rate", SlipRate, |row: &Row| {
            Uncertain::new(row.slip_rate.0, row.slip_rate.1).into()
        })
        .meaning("slip rate"),
    ];
    let constants = drawn.iter().enumerate();
    let constants = constants
        .map(|(i, drawn)| Column::new(drawn.name, Number, move |row: &Row| row.drawn[i].into()));
    columns.extend(constants);
    columns
}
