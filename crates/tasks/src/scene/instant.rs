//! The points of a run in time, and their columns: what no column asks for is not computed.

use super::any_system::AnySystem;
use super::column::Column;
use super::units::Quantity;

/// A point of a run, dimensionless.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Instant {
    /// Time.
    pub time: f64,
    /// The values of all states: of interfaces tau, ln psi of each, and what else they have.
    pub state: Vec<f64>,
    /// Slip of each interface since the start; none of what is no interface.
    pub slip: Vec<f64>,
    /// V_H; 0 where nothing is driven.
    pub driving: f64,
}

/// All columns of a run, in the order of the output: of interfaces what they do, of another system its states.
pub fn run_columns(system: &AnySystem) -> Vec<Column<Instant>> {
    use Quantity::{Length, LogState, SlipRate, State, Stress, Time};
    let mut columns =
        vec![Column::new("time", Time, |at: &Instant| at.time.into()).meaning("time")];
    if !system.slides() {
        let states = system.states().into_iter().enumerate();
        columns.extend(states.map(|(i, name)| {
            let value = move |at: &Instant| at.state[i].into();
            Column::new(name, system.quantity(i), value)
        }));
        return columns;
    }
    let Some(layout) = system.layout() else {
        return columns;
    };
    let interfaces = layout.parts;
    let second = if layout.states > 1 { interfaces } else { 0 };
    let each = |name: &'static str, quantity, entry: fn(&Instant, usize) -> f64, meaning| {
        (0..interfaces).map(move |i| {
            let entry = move |at: &Instant| entry(at, i).into();
            Column::new(format!("{name}_{}", i + 1), quantity, entry).meaning(meaning)
        })
    };
    let stress = |at: &Instant| at.state[0].into();
    columns.push(Column::new("stress", Stress, stress).meaning("shear stress τ"));
    columns.extend(each(
        "state",
        State,
        |at, i| at.state[i + 1].exp(),
        "ψ of interface or cluster i",
    ));
    columns.extend(each(
        "log_state",
        LogState,
        |at, i| at.state[i + 1],
        "ln ψ of interface i",
    ));
    // The second state variables stand behind the first ones.
    let offset = 1 + interfaces;
    for (name, quantity, meaning) in [
        (
            "second_state",
            State,
            "second state variable ψ of interface i",
        ),
        (
            "log_second_state",
            LogState,
            "ln of the second state variable of interface i",
        ),
    ] {
        columns.extend((0..second).map(|i| {
            let entry = move |at: &Instant| {
                let w = at.state[offset + i];
                if quantity == State { w.exp() } else { w }.into()
            };
            Column::new(format!("{name}_{}", i + 1), quantity, entry).meaning(meaning)
        }));
    }
    columns.extend((0..interfaces).map(|i| {
        let slip_rate = system.slip_rate();
        let entry = move |at: &Instant| slip_rate(i, &at.state, at.time).into();
        Column::new(format!("slip_rate_{}", i + 1), SlipRate, entry)
            .meaning("slip rate of interface or cluster i")
    }));
    columns.extend(each(
        "slip",
        Length,
        |at, i| at.slip[i],
        "slip of interface i since the start of the run",
    ));
    columns
}

/// V_H, of runs in which it changes.
pub fn driving_column() -> Column<Instant> {
    Column::new("driving", Quantity::SlipRate, |at: &Instant| {
        at.driving.into()
    })
    .meaning("driving velocity V_H")
}

/// Those that a picture shows.
pub fn pictured_columns(system: &AnySystem) -> Vec<Column<Instant>> {
    let mut columns = run_columns(system);
    columns.retain(|column| !matches!(column.quantity, Quantity::LogState | Quantity::Length));
    columns
}
