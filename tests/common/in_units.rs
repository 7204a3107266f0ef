//! Systems from files in units that are drawn: of their states, their parameters and time.

use super::ROOT;
use crate::command::folder;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;
use std::fs;

/// A system, with the units of its states and parameters and of its time in those of another.
pub struct Scaled {
    pub file: String,
    units: Vec<(String, f64)>,
    pub time: f64,
}

impl Scaled {
    /// The unit of a state or a parameter.
    pub fn of(&self, name: &str) -> f64 {
        let known = self.units.iter().find(|(known, _)| known == name);
        known.map_or(1.0, |(_, unit)| *unit)
    }

    /// The value of a state or a parameter in its unit. Never with an exponent: what begins with a minus is to be an option's value.
    pub fn inward(&self, name: &str, value: f64) -> String {
        (value / self.of(name)).to_string()
    }
}

/// The file of a model in `tests/data/models`, or in another folder of `tests/data` that its name begins with.
fn file(name: &str) -> String {
    match name.contains('/') {
        true => format!("tests/data/{name}.toml"),
        false => format!("tests/data/models/{name}.toml"),
    }
}

/// A model as it is.
pub fn own(name: &str) -> Scaled {
    Scaled {
        file: file(name),
        units: Vec::new(),
        time: 1.0,
    }
}

/// A formula with each state and each parameter in its unit.
fn in_units(formula: &str, units: &[(String, f64)]) -> String {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut made = String::new();
    let mut rest = formula;
    while let Some(first) = rest.chars().next() {
        // Names, numbers and the rest by turns.
        let end = rest.find(|c| is_name(c) != is_name(first));
        let (word, after) = rest.split_at(end.unwrap_or(rest.len()));
        match units.iter().find(|(name, _)| name == word) {
            Some((name, unit)) => made += &format!("({unit:e}*{name})"),
            None => made += word,
        }
        rest = after;
    }
    made
}

/// A model with its states, its parameters and its time in units that are drawn from twelve decades.
pub fn drawn(test: &str, name: &str, random: &mut ChaCha8Rng) -> Scaled {
    let text = fs::read_to_string(format!("{ROOT}/{}", file(name))).expect("a model");
    let model: toml::Table = text.parse().expect("TOML");
    let model = serde_json::to_value(model).expect("JSON");
    let mut unit = || 10.0_f64.powf(12.0 * (random.next_u64() as f64 / u64::MAX as f64) - 6.0);
    let states = model["states"].as_array().expect("states").iter();
    let states = states.map(|name| name.as_str().expect("a name"));
    let parameters = model["parameters"].as_object();
    let parameters = parameters.into_iter().flatten();
    let names = states.chain(parameters.map(|(name, _)| name.as_str()));
    let units: Vec<(String, f64)> = names.map(|name| (name.to_owned(), unit())).collect();
    let time = unit();
    let mut made = format!("name = {}\nstates = {}\n", model["name"], model["states"]);
    for table in ["parameters", "where", "rates", "start"] {
        let entries = model[table].as_object();
        made += &format!("[{table}]\n");
        for (name, entry) in entries.into_iter().flatten() {
            let own = units.iter().find(|(known, _)| known == name);
            let own = own.map_or(1.0, |(_, unit)| *unit);
            let text = entry
                .as_str()
                .map_or_else(|| entry.to_string(), str::to_owned);
            let scaled = match table {
                "where" => format!("{:?}", in_units(&text, &units)),
                "rates" => format!("\"{time:e}*({})/{own:e}\"", in_units(&text, &units)),
                _ => format!("{:e}", text.parse::<f64>().expect("a number") / own),
            };
            made += &format!("{name} = {scaled}\n");
        }
    }
    let name = name.replace('/', "_");
    let file = folder(&format!("any_units_{test}_{name}")).join("system.toml");
    fs::write(&file, made).expect("a file");
    Scaled {
        file: file.display().to_string(),
        units,
        time,
    }
}
