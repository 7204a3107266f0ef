//! The state whose values on the attractors are asked for in the place of regimes.

use super::Swept;
use super::options::SweepOptions;
use crate::scene::units::Quantity;
use twinslip::error::{Error, Result};

/// A bifurcation diagram by brute force: of which state.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagram {
    /// Its name.
    pub name: String,
    /// What it measures.
    pub quantity: Quantity,
    /// Its place among the variables.
    pub place: usize,
    /// Whether its values are those at one phase of a forcing, and not its maxima.
    pub is_stroboscopic: bool,
}

impl Diagram {
    /// # Errors
    /// [`Error::Input`] for a state that there is not, and for what does not go with a diagram.
    pub(super) fn of(options: &SweepOptions, system: &Swept) -> Result<Option<Self>> {
        let Some(name) = &options.diagram else {
            return Ok(None);
        };
        let others = [
            ("basin", options.basin),
            ("resume", options.resume.is_some()),
            ("shard", options.shard.is_some()),
            ("lyapunov", options.lyapunov),
        ];
        if let Some((other, _)) = others.iter().find(|(_, given)| *given) {
            return Err(Error::Input(format!(
                "`diagram` has rows of values on attractors, and `{other}` is of rows of regimes; leave one of them out"
            )));
        }
        let (names, phase) = match system {
            Swept::Interfaces(system) => {
                let states = (1..=system.interfaces).map(|i| format!("log_state_{i}"));
                (
                    std::iter::once("stress".to_owned()).chain(states).collect(),
                    None,
                )
            }
            Swept::Text(model) => {
                let names = model.system.states().iter().take(model.moving());
                let names: Vec<String> = names.map(|name| (*name).to_owned()).collect();
                (names, model.system.phase())
            }
        };
        let known: Vec<&str> = names.iter().map(String::as_str).collect();
        let place = known.iter().position(|known| known == name);
        let place = place.ok_or_else(|| Error::unknown("diagram", name, &known))?;
        let quantity = match (system, place) {
            (Swept::Text(model), place) => model.quantity(place),
            (Swept::Interfaces(_), 0) => Quantity::Stress,
            (Swept::Interfaces(_), _) => Quantity::LogState,
        };
        Ok(Some(Diagram {
            name: name.clone(),
            quantity,
            place,
            is_stroboscopic: phase.is_some(),
        }))
    }
}
