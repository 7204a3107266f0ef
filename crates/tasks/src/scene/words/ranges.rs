//! `NAME=NUMBERS` in all options that have it: parameters by their symbols, values with units, ranges.

use super::symbols::REFERENCE_RATE;
use super::{Kind, Made};

/// A name and what is said of it.
struct Pair {
    name: String,
    /// What stands behind the equals sign, if it does.
    value: Option<String>,
}

impl Made<'_> {
    /// `set`, `grid`, `range`, `at`, ...: one option for each name.
    pub(super) fn pairs(&mut self, text: &str) -> Result<Vec<(String, String)>, String> {
        let pairs = self.read(text)?;
        let lists = ["range", "at"].contains(&self.flag);
        Ok(pairs
            .into_iter()
            .map(|Pair { name, value }| match value {
                Some(value) if self.flag == "set" && name == REFERENCE_RATE => {
                    (name.replace('_', "-"), value)
                }
                // These have commas between the ends.
                Some(value) if self.flag == "range" => (
                    self.flag.to_owned(),
                    format!("{name}={}", value.replace(':', ",")),
                ),
                Some(value) => (self.flag.to_owned(), format!("{name}={value}")),
                None => (self.flag.to_owned(), name),
            })
            .fold(
                Vec::new(),
                |mut all: Vec<(String, String)>, (flag, value)| {
                    match all.last_mut().filter(|(last, _)| *last == flag) {
                        Some((_, before)) => {
                            *before += if lists { ";" } else { "," };
                            *before += &value;
                        }
                        None => all.push((flag, value)),
                    }
                    all
                },
            ))
    }

    /// `NAME` or `NAME=A:B`.
    pub(super) fn along(&mut self, text: &str) -> Result<Vec<(String, String)>, String> {
        let pairs = self.read(text)?;
        let [Pair { name, value }] = &pairs[..] else {
            return Err(format!("{text:?}: one parameter varies, as NAME=A:B"));
        };
        let mut options = vec![(self.flag.to_owned(), name.clone())];
        if let Some(value) = value {
            let (from, to) = ends(text, value)?;
            options.extend([("from".to_owned(), from), ("to".to_owned(), to)]);
        }
        Ok(options)
    }

    /// `NAME1,NAME2`, each of which may have `=A:B`.
    pub(super) fn within(&mut self, text: &str) -> Result<Vec<(String, String)>, String> {
        let pairs = self.read(text)?;
        let names: Vec<&str> = pairs.iter().map(|pair| pair.name.as_str()).collect();
        let mut options = vec![(self.flag.to_owned(), names.join(","))];
        for Pair { name, value } in &pairs {
            if let Some(value) = value {
                let (from, to) = ends(&format!("{name}={value}"), value)?;
                options.push(("range".to_owned(), format!("{name}={from},{to}")));
            }
        }
        Ok(options)
    }

    /// The pairs of a text; numbers after a comma are of the name before.
    fn read(&mut self, text: &str) -> Result<Vec<Pair>, String> {
        let mut pairs: Vec<Pair> = Vec::new();
        for part in text.split([',', ';']) {
            let (name, value) = match part.split_once('=') {
                Some((name, value)) => (name.trim(), Some(value)),
                None => (part.trim(), None),
            };
            let number = value.is_none()
                && name.starts_with(|c: char| "+-.".contains(c) || c.is_ascii_digit());
            match pairs
                .last_mut()
                .and_then(|pair| Some((&pair.name, pair.value.as_mut()?)))
            {
                Some((known, before)) if number => {
                    let next = match self.context.measures(known) {
                        Some(kind) => self.measured(&known.clone(), part, kind)?,
                        None => part.to_owned(),
                    };
                    *before += ",";
                    *before += &next;
                }
                _ => {
                    let name = self.context.parameter(name);
                    let value = match (value, self.context.measures(&name)) {
                        (Some(value), Some(kind)) => Some(self.measured(&name, value, kind)?),
                        (value, _) => value.map(str::to_owned),
                    };
                    pairs.push(Pair { name, value });
                }
            }
        }
        Ok(pairs)
    }

    fn measured(&mut self, name: &str, value: &str, kind: Kind) -> Result<String, String> {
        let numbers = self.numbers(value, kind, 1.0);
        numbers.map_err(|why| format!("{name}={why}"))
    }
}

/// Both ends of a range.
fn ends(text: &str, value: &str) -> Result<(String, String), String> {
    let parts: Vec<&str> = value.split(':').collect();
    match parts[..] {
        [from, to] => Ok((from.to_owned(), to.to_owned())),
        [_, _, _] => Err(format!(
            "{text:?}: points are placed by the curve, so give NAME=A:B without a number of points"
        )),
        _ => Err(format!("{text:?} must be NAME=A:B, from A to B")),
    }
}
