//! The points of a run in time, and their columns: what no column asks for is not computed.

use super::column::Column;
use super::units::Quantity;
use twinslip::friction::{Formulas, ScaledLaw};

/// A point of a run in the full chart. With one interface, or two equal ones, both entries are the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// The law of each interface.
    pub laws: [ScaledLaw; 2],
    /// Time.
    pub time: f64,
    /// tau.
    pub stress: f64,
    /// ln psi of each interface.
    pub log_state: [f64; 2],
    /// Slip of each interface since the start.
    pub slip: [f64; 2],
    /// V_H.
    pub driving: f64,
}

impl Instant {
    /// The same laws and V_H at another point, of tau and ln psi.
    pub fn at(&self, time: f64, (stress, log_state): (f64, [f64; 2]), slip: [f64; 2]) -> Self {
        Instant {
            time,
            stress,
            log_state,
            slip,
            ..*self
        }
    }

    /// The slip rate of an interface, 0 or 1, in V*.
    pub fn slip_rate(&self, interface: usize) -> f64 {
        let law = &self.laws[interface];
        law.slip_rate(law.activation(self.stress), self.log_state[interface].exp())
    }
}

/// All columns of a run of one or two interfaces, in the order of the output.
pub fn run_columns(interfaces: usize) -> Vec<Column<Instant>> {
    use Quantity::{Length, LogState, SlipRate, State, Stress, Time};
    let each = |name: &'static str, quantity, entry: fn(&Instant, usize) -> f64| {
        (0..interfaces).map(move |i| {
            Column::new(
                format!("{name}_{}", i + 1),
                quantity,
                move |at: &Instant| entry(at, i).into(),
            )
        })
    };
    let mut columns = vec![
        Column::new("time", Time, |at: &Instant| at.time.into()),
        Column::new("stress", Stress, |at: &Instant| at.stress.into()),
    ];
    columns.extend(each("state", State, |at, i| at.log_state[i].exp()));
    columns.extend(each("log_state", LogState, |at, i| at.log_state[i]));
    columns.extend(each("slip_rate", SlipRate, Instant::slip_rate));
    columns.extend(each("slip", Length, |at, i| at.slip[i]));
    columns
}

/// V_H, of runs in which it changes.
pub fn driving_column() -> Column<Instant> {
    Column::new("driving", Quantity::SlipRate, |at: &Instant| {
        at.driving.into()
    })
}

/// Those that a picture shows.
pub fn pictured_columns(interfaces: usize) -> Vec<Column<Instant>> {
    let mut columns = run_columns(interfaces);
    columns.retain(|column| !matches!(column.quantity, Quantity::LogState | Quantity::Length));
    columns
}
