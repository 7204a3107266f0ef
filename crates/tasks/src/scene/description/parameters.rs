//! The parameters of interfaces: what declares them, and between which values they are worth varying.

use super::{ParameterDescription, unit};
use crate::scene::law::largest_critical_stiffness;
use crate::scene::options::{ModelOptions, SlabOptions};
use crate::scene::system::{NORMAL_STRESS, SLIP_LENGTH};
use crate::scene::units::{Quantity, Units};
use crate::scene::words::{indexed, symbol};
use clap::Args;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use twinslip::error::Result;
use twinslip::friction::positive;
use twinslip::number::between_in_log;

/// V_H and K to begin with, where they are not given: the first chaotic point of figure 12.
const DRIVING: f64 = 10.0;
const STIFFNESS: f64 = 0.14;
/// V_H is worth varying between these.
const DRIVING_RANGE: (f64, f64) = (1e-3, 1e4);
/// K is worth varying up to this many critical stiffnesses, and to this where the law has none.
const ABOVE_CRITICAL: f64 = 1.2;
const STIFFEST: f64 = 1.0;
/// The least K of its range over the largest: not 0, which no branch reaches, and not where curves of orbits take minutes.
const SOFTEST: f64 = 0.025;
/// Radiation damping in the middle of its range, and the factor to its ends.
const DAMPING: (f64, f64) = (1e-4, 100.0);
/// The factor to both ends of the range of another positive parameter.
const AROUND: f64 = 10.0;
/// Constants that may be 0, and then have the range of this value.
const MAY_BE_ZERO: [(&str, f64); 3] = [
    ("damping", 0.0),
    ("residual_strength", 1e-3),
    ("reference_friction", 0.369),
];

/// A parameter of interfaces, as its name, its option and the help of that declare it.
#[derive(Debug, Clone)]
pub(super) struct Declared {
    name: &'static str,
    /// The name without the index of an interface.
    base: &'static str,
    symbol: String,
    /// In words; empty where no help has any.
    meaning: String,
    /// Whether an option has its name.
    option: bool,
    quantity: Quantity,
}

impl Declared {
    /// The parameter of this name; of one without a help the file of the law may say what it is, in a remark.
    pub fn of(name: &'static str, slab: &SlabOptions, remarks: &BTreeMap<String, String>) -> Self {
        let (base, index) = indexed(name);
        let command = ModelOptions::augment_args(clap::Command::new("model"));
        let argument = |name: &str| command.get_arguments().find(|one| one.get_id() == name);
        let help = argument(base).and_then(clap::Arg::get_help);
        let meaning = match (help, remarks.get(name).or(remarks.get(base))) {
            (Some(help), _) => meaning(&help.to_string(), &symbol(base)),
            (None, remark) => remark.cloned().unwrap_or_default(),
        };
        // A name in a law's own file may end in a number.
        let of_interface = match index.strip_prefix('_') {
            Some(number) if !meaning.is_empty() && !remarks.contains_key(name) => {
                format!(", interface {number}")
            }
            _ => String::new(),
        };
        // The option is there in SI alone, where it sets the unit.
        let of_units = ["slip_length", "normal_stress"].contains(&base);
        Declared {
            name,
            base,
            symbol: symbol(name),
            meaning: meaning + &of_interface,
            option: argument(name).is_some() && (slab.si || !of_units),
            quantity: Quantity::of_parameter(name),
        }
    }
}

/// The words of a help before the symbol, and what they are of or at: "Friction coefficient at V*" of "Friction coefficient a_v at V* [...]".
fn meaning(help: &str, symbol: &str) -> String {
    // Where an option has a meaning in SI alone, its help begins with that.
    let sentence = help.split_once("si: ").map_or(help, |(_, rest)| rest);
    let end = sentence
        .find(['[', ':', ';', '('])
        .unwrap_or(sentence.len());
    let mut words = sentence[..end].split_whitespace();
    let before: Vec<&str> = words.by_ref().take_while(|word| *word != symbol).collect();
    let after: Vec<&str> = words.collect();
    let kept = match after.first() {
        Some(&("of" | "at")) => after,
        _ => Vec::new(),
    };
    let text = [before, kept].concat().join(" ");
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).collect()
}

/// What the values of parameters are found in.
pub(super) struct InterfaceParameters<'m> {
    /// The options.
    pub options: &'m ModelOptions,
    /// The units of numbers.
    pub units: &'m Units,
    /// What the output tells of the interfaces.
    pub echo: &'m Map<String, Value>,
}

impl InterfaceParameters<'_> {
    /// These parameters with values and ranges.
    ///
    /// # Errors
    /// Those of `set`; [`twinslip::error::Error::Parameter`] for a driving velocity of 0.
    pub fn described(&self, all: &[Declared]) -> Result<Vec<ParameterDescription>> {
        let one = |declared: &Declared| {
            let value = self.value(declared)?;
            let (range, log) = self.range(declared, value);
            let may_be_zero = MAY_BE_ZERO.iter().any(|(name, _)| *name == declared.base);
            Ok(ParameterDescription {
                name: declared.name.to_owned(),
                symbol: declared.symbol.clone(),
                meaning: declared.meaning.clone(),
                unit: unit(self.units, declared.quantity),
                value,
                option: declared.option,
                range: [range.0, range.1].map(rounded),
                log,
                positive: value > 0.0 && !may_be_zero,
                integer: false,
            })
        };
        all.iter().map(one).collect()
    }

    /// The value, in the user's units; where none is given of V_H and K one to begin with.
    fn value(&self, declared: &Declared) -> Result<f64> {
        let name = declared.name;
        let own = self.echo.get("parameters").and_then(|all| all.get(name));
        let told = own.or_else(|| self.echo.get(name)).and_then(Value::as_f64);
        let [driving, stiffness] = self.options.loading()?;
        let outward = |x| rounded(self.units.outward(declared.quantity, x));
        Ok(match name {
            "slip_length" | "normal_stress" if own.is_none() => {
                self.unit_of_length_or_stress(name)?
            }
            // A program of V_H may begin at rest, and a model without one has no range there.
            "driving" => positive(name, driving.unwrap_or_else(|| outward(DRIVING)))?,
            "stiffness" => stiffness.unwrap_or_else(|| outward(STIFFNESS)),
            // A law without damping tells none.
            _ => told.unwrap_or(0.0),
        })
    }

    /// L or sigma of all interfaces in SI, as it was given.
    fn unit_of_length_or_stress(&self, name: &str) -> Result<f64> {
        let slab = self.options.resolved()?.slab;
        Ok(match name {
            "slip_length" => slab.slip_length.unwrap_or(SLIP_LENGTH),
            _ => slab.normal_stress.unwrap_or(NORMAL_STRESS),
        })
    }

    /// Between which values it is worth varying, with its value among them, and whether by its logarithm.
    fn range(&self, declared: &Declared, value: f64) -> ((f64, f64), bool) {
        let outward = |x| self.units.outward(declared.quantity, x);
        let zero = MAY_BE_ZERO.iter().find(|(name, _)| *name == declared.base);
        match declared.base {
            "driving" => {
                let (low, high) = DRIVING_RANGE;
                let low = outward(low).min(value / AROUND);
                ((low, outward(high).max(value * AROUND)), true)
            }
            "stiffness" => {
                let critical = self.critical_stiffness();
                let stiffest = critical.map_or(STIFFEST, |k| ABOVE_CRITICAL * k);
                let high = outward(stiffest).max(ABOVE_CRITICAL * value);
                let high = two_digits_above(high);
                (((SOFTEST * high).min(value), high), false)
            }
            "damping" if value == 0.0 => {
                let (middle, factor) = DAMPING;
                ((outward(middle / factor), outward(middle * factor)), true)
            }
            _ if value > 0.0 => ((value / AROUND, value * AROUND), true),
            _ => match zero {
                Some((_, usual)) => ((usual / AROUND, usual * AROUND), true),
                None => around(value),
            },
        }
    }

    /// The largest critical stiffness of the law, dimensionless, where it has a positive one.
    fn critical_stiffness(&self) -> Option<f64> {
        const RATES: usize = 71;
        let (low, high) = DRIVING_RANGE;
        let part = |i: usize| i as f64 / (RATES - 1) as f64;
        let rates = (0..RATES).map(|i| between_in_log(low, high, part(i)));
        largest_critical_stiffness(self.options, &rates.collect::<Vec<f64>>())
    }
}

/// The range of a parameter of which nothing else is known: from 0 to twice its value, or around 0.
pub(super) fn around(value: f64) -> ((f64, f64), bool) {
    let ends = match value {
        0.0 => (-1.0, 1.0),
        _ if value > 0.0 => (0.0, 2.0 * value),
        _ => (2.0 * value, 0.0),
    };
    (ends, false)
}

/// Without the last digits, which conversions leave.
fn rounded(x: f64) -> f64 {
    format!("{x:.11e}").parse().unwrap_or(x)
}

/// The next number of two digits, for the end of an axis.
fn two_digits_above(x: f64) -> f64 {
    let unit = 10f64.powi(x.abs().log10().floor() as i32 - 1);
    rounded((x / unit - 1e-9).ceil() * unit)
}
