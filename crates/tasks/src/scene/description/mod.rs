//! What a model is, for programs that show it: its states, its parameters with symbols, units and ranges, and what can be computed of it.
//!
//! All of it comes from what declares it: the options and their help, the symbols of `--set`, the parameters that branches can follow, the
//! tables of a system's file.

mod interfaces;
mod parameters;
mod surface;
mod system;

use super::command::model_options;
use super::options::ModelOptions;
use super::units::{Quantity, Units};
use serde::Serialize;
use std::borrow::Cow;
use twinslip::error::{Error, Result};

/// A model as programs show it. Numbers are in the user's units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelDescription {
    /// Interfaces, or a user-defined system.
    pub kind: ModelKind,
    /// What it is called.
    pub title: String,
    /// Its states, as `section` names them.
    pub states: Vec<StateDescription>,
    /// Its parameters, as `branch` names them.
    pub parameters: Vec<ParameterDescription>,
    /// The parameters of the plane to begin with: two, or as many as there are.
    pub axes: Vec<String>,
    /// The friction laws that interfaces may have.
    pub laws: Vec<LawDescription>,
    /// What `symmetry` may say; nothing where there is none.
    pub symmetries: Vec<&'static str>,
    /// How many interfaces there are.
    pub interfaces: Option<u32>,
    /// The bifurcations that `locus` may find in a plane of two parameters.
    pub loci: Vec<&'static str>,
    /// Whether it may rest: under a periodic forcing nothing does, and there are no equilibria.
    pub rests: bool,
    /// A section for `section`, STATE=VALUE; `None` where its default will do, or where a system comes to rest.
    pub surface: Option<String>,
    /// How long a run from the system's own start may be shown, where its equilibria and orbits do not say; `None` where these do.
    pub duration: Option<f64>,
    /// The text of a user-defined system.
    pub text: Option<String>,
    /// Whether all numbers are in SI.
    pub si: bool,
    /// The unit of times.
    pub time_unit: Option<&'static str>,
}

/// What kind of model it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ModelKind {
    /// Frictional interfaces under one stress.
    Interfaces,
    /// A user-defined system.
    System,
}

/// A state of a model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StateDescription {
    /// Its name in columns and options.
    pub name: Cow<'static, str>,
    /// Its name on axes.
    pub label: String,
    /// Its unit.
    pub unit: Option<&'static str>,
}

/// A parameter of a model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterDescription {
    /// Its name in options.
    pub name: String,
    /// Its symbol, or its name.
    pub symbol: String,
    /// What it is, in words; empty where a file says nothing of it.
    pub meaning: String,
    /// Its unit.
    pub unit: Option<&'static str>,
    /// Its value; of a driving velocity or a stiffness that is not given one to begin with.
    pub value: f64,
    /// Whether an option has its name; else `set` takes it.
    pub option: bool,
    /// A range in which it is worth varying.
    pub range: [f64; 2],
    /// Whether that is better shown by logarithms.
    pub log: bool,
    /// Whether it must be greater than 0.
    pub positive: bool,
    /// Whether it must be a whole number.
    pub integer: bool,
}

/// A friction law that has a name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LawDescription {
    /// What `law` takes.
    pub name: String,
    /// What it is.
    pub meaning: String,
}

impl ModelDescription {
    /// Describes the model of these options, of which V_H and K may be missing.
    ///
    /// # Errors
    /// Those of the model, in the user's own names.
    pub fn new(options: &ModelOptions) -> Result<Self> {
        match &options.slab.text.system {
            Some(path) => system::described(options, path),
            None => interfaces::described(options),
        }
    }

    /// The same of the options as words of a command line, such as `--driving=10`, without a command.
    ///
    /// # Errors
    /// As of [`ModelDescription::new`]; [`Error::Input`] for words that are no options of a model.
    pub fn of_words(words: &[String]) -> Result<Self> {
        Self::new(&model_options(words).map_err(Error::Input)?)
    }
}

/// The unit of a quantity, where it has one.
fn unit(units: &Units, quantity: Quantity) -> Option<&'static str> {
    Some(units.name(quantity)).filter(|name| *name != "1")
}

/// The name that pictures have for a state or a slip rate of interfaces, by its symbol: `ψ_1` for state_1.
pub fn symbol_of_state(name: &str) -> Option<String> {
    if name == "stress" {
        return Some("stress τ".to_owned());
    }
    let symbols = [
        ("log_state_", "ln ψ"),
        ("state_", "ψ"),
        ("log_second_state_", "ln ψ'"),
        ("second_state_", "ψ'"),
        ("log_slip_rate_", "ln v"),
        ("slip_rate_", "v"),
    ];
    symbols.into_iter().find_map(|(prefix, symbol)| {
        let number: usize = name.strip_prefix(prefix)?.parse().ok()?;
        Some(format!("{symbol}_{number}"))
    })
}
