//! What the points of a friction law show.

use crate::scene::{Column, LawPoint, Quantity};

/// The columns of a steady-state friction law.
pub fn law_columns() -> Vec<Column<LawPoint>> {
    use Quantity::{Number, SlipRate, State, Stiffness, Stress};
    vec![
        Column::new("slip_rate", SlipRate, |at: &LawPoint| at.slip_rate.into()),
        Column::new("stress", Stress, |at: &LawPoint| at.stress.into()),
        Column::new("friction", Number, |at: &LawPoint| at.friction.into()),
        Column::new("state", State, |at: &LawPoint| at.state.into()),
        Column::new("critical_stiffness", Stiffness, |at: &LawPoint| {
            at.critical_stiffness.into()
        }),
    ]
}
