//! What the points of a friction law show.

use crate::scene::{Column, LawPoint, Quantity};

/// The columns of a steady-state friction law, of two interfaces that differ with the number of each.
pub fn law_columns(two: bool) -> Vec<Column<LawPoint>> {
    use Quantity::{Number, SlipRate, State, Stiffness, Stress};
    let interface = Column::new("interface", Number, |at: &LawPoint| at.interface.into())
        .meaning("number of the interface");
    let mut columns: Vec<_> = two.then_some(interface).into_iter().collect();
    columns.extend([
        Column::new("slip_rate", SlipRate, |at: &LawPoint| at.slip_rate.into())
            .meaning("slip rate"),
        Column::new("stress", Stress, |at: &LawPoint| at.stress.value.into())
            .meaning("steady-state stress τ_ss"),
        Column::new("friction", Number, |at: &LawPoint| at.friction.into())
            .meaning("friction coefficient, τ/σ"),
        Column::new("state", State, |at: &LawPoint| at.state.value.into())
            .meaning("steady state ψ_ss"),
        Column::new("critical_stiffness", Stiffness, |at: &LawPoint| {
            at.critical_stiffness.into()
        })
        .meaning("k_c: below it, steady sliding of a single interface at this rate is unstable"),
        Column::bound("stress_uncertainty", Stress, |at: &LawPoint| at.stress)
            .meaning("bound on the error of τ_ss"),
        Column::bound("state_uncertainty", State, |at: &LawPoint| at.state)
            .meaning("bound on the error of ψ_ss"),
    ]);
    columns
}
