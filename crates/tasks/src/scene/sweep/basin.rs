//! A grid of starts of any system, over two of its states.

use super::layout::Moving;
use super::options::SweepOptions;
use crate::scene::units::{Quantity, Units};
use twinslip::error::{Error, Result, option_name};
use twinslip::friction::positive;
use twinslip::random::Random;
use twinslip::sweep::{Range, SystemPoint, SystemPoints};

/// Two states of a system with the values that they start from; the first varies fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct BasinStates {
    /// Their names.
    pub names: [String; 2],
    /// What they measure.
    pub quantities: [Quantity; 2],
    /// Where they stand among the variables.
    places: [usize; 2],
    /// Their values, in the user's units.
    pub ranges: [Range; 2],
    units: Units,
}

impl BasinStates {
    /// Whether the options say psi of both interfaces, without names.
    pub fn are_plain(options: &SweepOptions) -> bool {
        let named = |text: &Option<String>| text.as_ref().is_some_and(|text| text.contains('='));
        !named(&options.state_1) && !named(&options.state_2)
    }

    /// What the options say of the states of what moves: NAME=A:B:N; of interfaces A:B:N is of psi.
    ///
    /// # Errors
    /// [`Error::Input`] for what can't be read, and where both are the same state; [`Error::Parameter`] for a name that no state has, and
    /// for values outside their domain.
    pub fn read(options: &SweepOptions, moves: &Moving, units: &Units) -> Result<Self> {
        let known: Vec<(String, Quantity)> = match moves {
            Moving::Interfaces(count) => {
                let states = (1..=*count).map(|i| (format!("state_{i}"), Quantity::State));
                let stress = ("stress".to_owned(), Quantity::Stress);
                std::iter::once(stress).chain(states).collect()
            }
            Moving::States(states, _) => {
                let plain = |state: &&str| ((*state).to_owned(), Quantity::Number);
                states.iter().map(plain).collect()
            }
        };
        let names: Vec<&str> = known.iter().map(|(name, _)| name.as_str()).collect();
        let one = |option: &'static str, text: &Option<String>, usual: &str| {
            let text = text.as_deref().unwrap_or_default();
            let (name, range) = match text.split_once('=') {
                Some((name, range)) => (name.trim(), range),
                None => (usual, text),
            };
            if name.is_empty() {
                return Err(Error::Input(format!(
                    "{} {text:?} must be NAME=A:B:N, NAME one of {}",
                    option_name(option),
                    names.join(", ")
                )));
            }
            let place = names.iter().position(|known| *known == name);
            let place = place.ok_or_else(|| Error::unknown(option, name, &names))?;
            let range = Range::of_any_sign(option, range)?;
            let quantity = known[place].1;
            if quantity == Quantity::State {
                positive(name, range.from)?;
            }
            Ok((name.to_owned(), place, quantity, range))
        };
        // A single interface has its stress beside its one state.
        let usual = match moves {
            Moving::Interfaces(1) => ["state_1", "stress"],
            Moving::Interfaces(_) => ["state_1", "state_2"],
            Moving::States(..) => [""; 2],
        };
        let first = one("state-1", &options.state_1, usual[0])?;
        let second = one("state-2", &options.state_2, usual[1])?;
        if first.1 == second.1 {
            return Err(Error::Input(format!(
                "`state-1` and `state-2` are both of {}; a basin is over two states",
                first.0
            )));
        }
        Ok(BasinStates {
            names: [first.0, second.0],
            places: [first.1, second.1],
            quantities: [first.2, second.2],
            ranges: [first.3, second.3],
            units: *units,
        })
    }

    /// Where they stand among the variables.
    pub fn places(&self) -> &[usize] {
        &self.places
    }

    /// The options that say so.
    pub fn said(&self) -> Vec<(&'static str, String)> {
        let text = |i: usize| {
            let Range {
                from,
                to,
                count,
                log,
            } = self.ranges[i];
            let log = if log { "log" } else { "" };
            format!("{}={from:?}:{to:?}:{count}{log}", self.names[i])
        };
        vec![("state-1", text(0)), ("state-2", text(1))]
    }
}

/// The starts of one system.
#[derive(Debug)]
pub(super) struct BasinPoints<P> {
    /// The system, of which no parameter varies.
    pub system: P,
    /// What varies.
    pub states: BasinStates,
}

impl<P: SystemPoints> SystemPoints for BasinPoints<P> {
    fn parameters(&self, _: &[f64]) -> Vec<f64> {
        self.system.parameters(&[])
    }

    fn at(&self, values: &[f64], start: usize, random: Random) -> Result<SystemPoint> {
        let mut point = self.system.at(&[], start, random)?;
        let states = &self.states;
        for (i, &value) in values.iter().enumerate() {
            let value = states.units.inward(states.quantities[i], value);
            let place = states.places[i];
            let value = match states.quantities[i] {
                // Interfaces have the logarithm among their variables.
                Quantity::State => value.ln(),
                _ => value,
            };
            point.start[place] = value / point.units.sizes[place];
        }
        Ok(point)
    }
}
