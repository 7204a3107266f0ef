//! What the rows of a sweep show, and how they are read again.

use super::PointOutcome;
use crate::equilibrium::Symmetry;
use crate::number::Uncertain;
use crate::scene::{CellValue, Column, Quantity, Units};
use crate::section::Regime;
use crate::sweep::SweepRow;

/// The regimes in the order of summaries and legends.
pub const REGIMES: [Regime; 5] = [
    Regime::Steady,
    Regime::Periodic,
    Regime::Torus,
    Regime::Chaotic,
    Regime::Undecided,
];

/// The columns of the points of a sweep. A row's start is one that `integrate --start` takes.
pub fn sweep_columns() -> Vec<Column<SweepRow>> {
    use Quantity::{Growth, Number, SlipRate, State, Stiffness, Stress, Time};
    let mut columns = vec![
        Column::new("driving", SlipRate, |row: &SweepRow| row.driving.into()),
        Column::new("stiffness", Stiffness, |row: &SweepRow| {
            row.stiffness.into()
        }),
        Column::new("regime", Number, |row: &SweepRow| row.regime.name().into()),
        Column::new("symmetry", Number, |row: &SweepRow| {
            row.symmetry.map(Symmetry::name).into()
        }),
        Column::new("period", Time, |row: &SweepRow| row.period.into()),
        Column::new("stress_min", Stress, |row: &SweepRow| {
            row.stress_range.map(|range| range.0).into()
        }),
        Column::new("stress_max", Stress, |row: &SweepRow| {
            row.stress_range.map(|range| range.1).into()
        }),
        Column::uncertain("lyapunov_max", Growth, |row: &SweepRow| {
            row.lyapunov_max.into()
        }),
        Column::new("returns", Number, |row: &SweepRow| row.returns.into()),
        Column::new("period_of_orbit", Number, |row: &SweepRow| {
            CellValue::Word(row.returns_per_period.map(|q| q.to_string()))
        }),
        Column::new("start_stress", Stress, |row: &SweepRow| row.start[0].into()),
        Column::new("start_state_1", State, |row: &SweepRow| {
            row.start[1].exp().into()
        }),
        Column::new("start_state_2", State, |row: &SweepRow| {
            row.start[2].exp().into()
        }),
        Column::new("note", Number, |row: &SweepRow| {
            // A row is a line, whatever the reason says.
            CellValue::Word(row.note.as_ref().map(|note| note.replace('\n', " ")))
        }),
    ];
    for column in &mut columns {
        column.in_table = !column.name.starts_with("start_") && column.name != "note";
    }
    columns
}

/// A row from the cells of its line, by the names of their columns; `None` if they are not those of a row.
pub fn sweep_row<'a>(
    number: usize,
    cell: &dyn Fn(&str) -> &'a str,
    units: &Units,
) -> Option<SweepRow> {
    let maybe = |name: &str, quantity| {
        let text = cell(name);
        match text.is_empty() {
            true => Some(None),
            false => Some(Some(units.inward(quantity, text.parse().ok()?))),
        }
    };
    let known = |name: &str, quantity| maybe(name, quantity)?;
    let both = (
        maybe("stress_min", Quantity::Stress)?,
        maybe("stress_max", Quantity::Stress)?,
    );
    let exponent = maybe("lyapunov_max", Quantity::Growth)?;
    let bound = maybe("lyapunov_max_uncertainty", Quantity::Growth)?;
    let text = |name: &str| Some(cell(name)).filter(|text| !text.is_empty());
    Some(SweepRow {
        number,
        driving: known("driving", Quantity::SlipRate)?,
        stiffness: known("stiffness", Quantity::Stiffness)?,
        start: [
            known("start_stress", Quantity::Stress)?,
            known("start_state_1", Quantity::State)?.ln(),
            known("start_state_2", Quantity::State)?.ln(),
        ],
        regime: REGIMES
            .into_iter()
            .find(|regime| regime.name() == cell("regime"))?,
        symmetry: Symmetry::named(cell("symmetry")),
        returns_per_period: text("period_of_orbit").and_then(|text| text.parse().ok()),
        period: maybe("period", Quantity::Time)?,
        stress_range: both.0.zip(both.1),
        lyapunov_max: exponent.map(|x| Uncertain::new(x, bound.unwrap_or(f64::INFINITY))),
        returns: cell("returns").parse().ok()?,
        note: text("note").map(str::to_owned),
    })
}

/// What a picture shows of a row.
pub fn outcome(row: &SweepRow) -> PointOutcome {
    PointOutcome {
        number: row.number,
        regime: row.regime,
        symmetry: row.symmetry,
        returns_per_period: row.returns_per_period,
        period: row.period,
        stress_range: row.stress_range,
        lyapunov_max: row.lyapunov_max,
    }
}
