//! The columns of a run, and how each follows from the state: nothing else is computed.

use super::system::System;
use super::units::{Quantity, Units};
use crate::error::{Error, Result};
use crate::field::State;
use crate::friction::{AnyLaw, Law};

/// A point of a run in the full chart. With one interface, or two equal ones, both entries are the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// Time.
    pub time: f64,
    /// tau.
    pub stress: f64,
    /// ln psi of each interface.
    pub log_state: [f64; 2],
    /// Slip of each interface since the start.
    pub slip: [f64; 2],
}

impl Instant {
    /// From a state in dimension 2, (tau, w), or 3, (tau, w_1, w_2).
    pub fn new<const N: usize>(time: f64, y: &State<N>, slip: [f64; 2]) -> Self {
        Instant {
            time,
            stress: y[0],
            log_state: [y[1], y[N - 1]],
            slip,
        }
    }
}

/// One column of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputColumn {
    /// `time`
    Time,
    /// `stress`
    Stress,
    /// `state_1`, `state_2`
    State(usize),
    /// `log_state_1`, `log_state_2`
    LogState(usize),
    /// `slip_rate_1`, `slip_rate_2`
    SlipRate(usize),
    /// `slip_1`, `slip_2`
    Slip(usize),
}

impl OutputColumn {
    /// All columns of a system of one or two interfaces, in the order of the output.
    pub fn all(interfaces: usize) -> Vec<OutputColumn> {
        let mut all = vec![OutputColumn::Time, OutputColumn::Stress];
        for column in [
            OutputColumn::State,
            OutputColumn::LogState,
            OutputColumn::SlipRate,
            OutputColumn::Slip,
        ] {
            all.extend((0..interfaces).map(column));
        }
        all
    }

    /// The columns that a picture shows.
    pub fn pictured(interfaces: usize) -> Vec<OutputColumn> {
        let shown = |column: &OutputColumn| {
            !matches!(column, OutputColumn::LogState(_) | OutputColumn::Slip(_))
        };
        OutputColumn::all(interfaces)
            .into_iter()
            .filter(shown)
            .collect()
    }

    /// The columns of a comma-separated list of names.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is none, with the nearest that is one.
    pub fn listed(names: &str, interfaces: usize) -> Result<Vec<OutputColumn>> {
        let all = OutputColumn::all(interfaces);
        names
            .split(',')
            .map(str::trim)
            .map(|name| {
                let found = all.iter().copied().find(|column| column.name() == name);
                found.ok_or_else(|| {
                    let known: Vec<String> = all.iter().map(OutputColumn::name).collect();
                    let known: Vec<&str> = known.iter().map(String::as_str).collect();
                    Error::unknown("columns", name, &known)
                })
            })
            .collect()
    }

    /// The name in CSV and JSON.
    pub fn name(&self) -> String {
        match self {
            OutputColumn::Time => "time".into(),
            OutputColumn::Stress => "stress".into(),
            OutputColumn::State(i) => format!("state_{}", i + 1),
            OutputColumn::LogState(i) => format!("log_state_{}", i + 1),
            OutputColumn::SlipRate(i) => format!("slip_rate_{}", i + 1),
            OutputColumn::Slip(i) => format!("slip_{}", i + 1),
        }
    }

    /// What it measures.
    pub fn quantity(&self) -> Quantity {
        match self {
            OutputColumn::Time => Quantity::Time,
            OutputColumn::Stress => Quantity::Stress,
            OutputColumn::State(_) => Quantity::State,
            OutputColumn::LogState(_) => Quantity::LogState,
            OutputColumn::SlipRate(_) => Quantity::SlipRate,
            OutputColumn::Slip(_) => Quantity::Length,
        }
    }

    fn value(&self, law: &AnyLaw, units: &Units, at: &Instant) -> f64 {
        let x = match *self {
            OutputColumn::Time => at.time,
            OutputColumn::Stress => at.stress,
            OutputColumn::State(i) => at.log_state[i].exp(),
            OutputColumn::LogState(i) => at.log_state[i],
            OutputColumn::SlipRate(i) => {
                law.slip_rate(law.activation(at.stress), at.log_state[i].exp())
            }
            OutputColumn::Slip(i) => at.slip[i],
        };
        units.outward(self.quantity(), x)
    }
}

/// Fills a row with the columns at an instant, in the user's units.
pub(super) fn fill(row: &mut Vec<f64>, columns: &[OutputColumn], system: &System, at: &Instant) {
    row.clear();
    row.extend(
        columns
            .iter()
            .map(|column| column.value(&system.law, &system.units, at)),
    );
}
