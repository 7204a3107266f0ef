//! What the rows of a sweep are of.

use super::super::units::Quantity;
use twinslip::error::{Error, Result};

/// The columns that all rows have.
const OWN: [&str; 9] = [
    "regime",
    "symmetry",
    "returns_per_period",
    "period_of_orbit",
    "period",
    "lyapunov_max",
    "lyapunov_max_uncertainty",
    "returns",
    "note",
];

/// What the rows of a sweep have beside their verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepLayout {
    /// The parameters in front.
    pub parameters: Vec<(String, Quantity)>,
    /// What moves.
    pub moves: Moving,
}

/// What moves at the points of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub enum Moving {
    /// So many interfaces.
    Interfaces(usize),
    /// These states, with the place of the one that the section is in.
    States(Vec<&'static str>, usize),
}

impl SweepLayout {
    /// Of interfaces: V_H and K, and what else varies.
    pub fn interfaces(count: usize, others: impl Iterator<Item = String>) -> Self {
        let loading = [
            ("driving".to_owned(), Quantity::SlipRate),
            ("stiffness".to_owned(), Quantity::Stiffness),
        ];
        let others = others.map(|name| (name, Quantity::Number));
        SweepLayout {
            parameters: loading.into_iter().chain(others).collect(),
            moves: Moving::Interfaces(count),
        }
    }

    /// Whether no parameter has the name of another column.
    ///
    /// # Errors
    /// [`Error::Input`] for one that has.
    pub(super) fn names_differ(&self) -> Result<()> {
        let taken = |name: &str| {
            let of_state = |state: &&str| {
                let stems = [name.strip_prefix("start_"), name.strip_suffix("_min")];
                let stems = stems.into_iter().chain([name.strip_suffix("_max")]);
                stems.flatten().any(|stem| stem == *state)
            };
            OWN.contains(&name)
                || match &self.moves {
                    Moving::Interfaces(_) => {
                        name.starts_with("start_") || name.starts_with("stress_m")
                    }
                    Moving::States(states, _) => states.iter().any(of_state),
                }
        };
        match self.parameters.iter().find(|(name, _)| taken(name)) {
            None => Ok(()),
            Some((name, _)) => Err(Error::Input(format!(
                "`grid` {name}: rows have another column of this name; rename the parameter in its file"
            ))),
        }
    }
}
