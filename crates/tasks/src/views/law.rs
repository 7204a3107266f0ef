//! What the points of a friction law show.

use crate::scene::{Column, LawPoint, Quantity};

/// The columns of a steady-state friction law, of two interfaces that differ with the number of each.
pub fn law_columns(two: bool) -> Vec<Column<LawPoint>> {
    use Quantity::{Number, SlipRate, State, Stiffness, Stress};
    let interface = Column::new("interface", Number, |at: &LawPoint| at.interface.into());
    let mut columns: Vec<_> = two.then_some(interface).into_iter().collect();
    columns.extend([
        Column::new("slip_rate", SlipRate, |at: &LawPoint| at.slip_rate.into()),
        Column::new("stress", Stress, |at: &LawPoint| at.stress.into()),
        Column::new("friction", Number, |at: &LawPoint| at.friction.into()),
        Column::new("state", State, |at: &LawPoint| at.state.into()),
        Column::new("critical_stiffness", Stiffness, |at: &LawPoint| {
            at.critical_stiffness.into()
        }),
    ]);
    columns
}
