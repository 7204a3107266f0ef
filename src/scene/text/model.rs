//! A system of one's own with what the command line says about it.

use super::file::SystemFile;
use super::options::TextOptions;
use crate::error::{Error, Result, did_you_mean};
use crate::field::Vector;
use crate::integrate::AnyField;
use crate::model::TextSystem;
use crate::scene::file::read_bounded;
use crate::scene::set::assignments;
use crate::scene::shipped::{shipped_system, shipped_system_names};
use crate::scene::system::Described;
use crate::scene::units::Units;
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::path::Path;

/// No file is longer, in bytes.
const LONGEST: u64 = 1 << 16;

/// A system of one's own, its parameters as they were set.
#[derive(Debug, Clone, PartialEq)]
pub struct TextModel {
    /// Its equations.
    pub system: TextSystem,
    start: Vec<Option<f64>>,
    units: Units,
    echo: Map<String, Value>,
}

impl TextModel {
    /// The system that the options name; `None` where they name none.
    ///
    /// # Errors
    /// [`Error::File`] for a file that can't be read, [`Error::Input`] for what is wrong in it, by line and column, and
    /// [`Error::Parameter`] for a parameter that it does not have.
    pub fn named(options: &TextOptions) -> Result<Option<Self>> {
        let Some(path) = &options.system else {
            return Ok(None);
        };
        let mut read = read(path)?;
        for (name, value) in assignments(&options.set)? {
            if read.system.parameter_names().is_empty() {
                let what = format!("`set` {name}: the system {} has no parameters", read.name);
                return Err(Error::Input(what));
            }
            if !read.system.parameter_names().contains(&name) {
                return Err(Error::unknown("set", name, read.system.parameter_names()));
            }
            read.system.set(name, value)?;
        }
        let names = read.system.parameter_names().iter();
        let parameters: Map<String, Value> = names
            .zip(read.system.parameters())
            .map(|(name, value)| ((*name).to_owned(), json!(value)))
            .collect();
        let mut echo = Map::new();
        echo.insert("system".into(), json!(read.name));
        echo.insert("states".into(), json!(read.system.states()));
        echo.insert("parameters".into(), Value::Object(parameters));
        Ok(Some(TextModel {
            system: read.system,
            start: read.start,
            units: Units::none(),
            echo,
        }))
    }

    /// The same with another system of these states.
    pub fn with(&self, system: TextSystem) -> Self {
        TextModel {
            system,
            ..self.clone()
        }
    }

    /// Its field.
    ///
    /// # Errors
    /// Those of [`AnyField::of_text`].
    pub fn field(&self) -> Result<AnyField<'_>> {
        AnyField::of_text(Cow::Borrowed(&self.system))
    }

    /// The values of all states: those of a text, or of the file where none is given.
    ///
    /// # Errors
    /// [`Error::Input`] for a text that can't be read, and for a state without a start.
    pub fn start(&self, text: Option<&str>) -> Result<Vector> {
        let states = self.system.states();
        let Some(text) = text else {
            let start = states.iter().zip(&self.start);
            let value = |(state, value): (&&str, &Option<f64>)| {
                value.ok_or_else(|| {
                    Error::Input(format!(
                        "the state {state} has no start: give `start` {}, or {state} = ... in [start] of the file",
                        states.join(",").to_uppercase()
                    ))
                })
            };
            let start: Result<Vec<f64>> = start.map(value).collect();
            return Ok(Vector::from_vec(start?));
        };
        let number = |part: &str| {
            number(part).ok_or_else(|| {
                Error::Input(format!("`start` {text:?}: {part:?} is not a finite number"))
            })
        };
        let start: Result<Vec<f64>> = text.split(',').map(number).collect();
        let start = start?;
        if start.len() != states.len() {
            return Err(Error::Input(format!(
                "`start` {text:?} must have {} values, one for each of {}",
                states.len(),
                states.join(", ")
            )));
        }
        Ok(Vector::from_vec(start))
    }

    /// The place of the state of this name.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is none.
    pub fn state(&self, option: &str, name: &str) -> Result<usize> {
        let states = self.system.states();
        let place = states.iter().position(|state| *state == name);
        place.ok_or_else(|| Error::unknown(option, name, states))
    }
}

impl Described for TextModel {
    fn echo(&self) -> &Map<String, Value> {
        &self.echo
    }

    fn units(&self) -> &Units {
        &self.units
    }
}

/// A finite number.
pub(super) fn number(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|x| x.is_finite())
}

/// The file, or where there is none of that name the system that is built in.
fn read(path: &Path) -> Result<SystemFile> {
    let name = path.display().to_string();
    if path.exists() {
        return SystemFile::parse(&name, &read_bounded(path, LONGEST)?);
    }
    if let Some(text) = shipped_system(path) {
        return SystemFile::parse(&name, text);
    }
    let known = shipped_system_names();
    let hint = did_you_mean(&name, known.iter().copied());
    Err(Error::Input(format!(
        "`system` {name}: there is no such file, and no built-in system of this name; those are {}{hint}",
        known.join(", ")
    )))
}
