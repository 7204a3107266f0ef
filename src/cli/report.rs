//! What all commands share: format and place of the output, the object around a result, remarks, messages.

use crate::error::{Error, Result};
use crate::integrate::Work;
use crate::number::Uncertain;
use crate::output::{self, CsvRows, Envelope, Format, Place, RowWriter, TableRows, plot};
use crate::scene::{OutputOptions, Quantity, System, Units};
use serde::Serialize;
use serde_json::{Value, json};
use std::io::{IsTerminal, Write};
use std::path::Path;

/// Where a command's output goes, checked.
pub struct Report<'a> {
    /// In which form.
    pub format: Format,
    /// Where to.
    pub place: Place,
    /// No talk.
    pub quiet: bool,
    words: &'a [String],
}

impl<'a> Report<'a> {
    /// Chooses the format and makes sure that all files can be written, before anything is computed.
    pub fn new(options: &OutputOptions, words: &'a [String], others: &[&Path]) -> Result<Self> {
        let place = Place::new(options.output.as_deref());
        let terminal = std::io::stdout().is_terminal();
        let format = Format::choose(options.format.as_deref(), place.path(), terminal)?;
        place.check()?;
        for path in others {
            Place::File(path.to_path_buf()).check()?;
            if place.path() == Some(path) {
                return Err(Error::Input(format!(
                    "{} cannot be both data and picture",
                    path.display()
                )));
            }
        }
        Ok(Report {
            format,
            place,
            quiet: options.quiet,
            words,
        })
    }

    /// The same where the CSV of an earlier run may be gone on with, which is then the place of the output.
    pub fn resuming(
        options: &OutputOptions,
        words: &'a [String],
        (resume, plot): (Option<&Path>, Option<&Path>),
    ) -> Result<Self> {
        if let Some(path) = plot {
            plot::Kind::of(path)?;
        }
        let others: Vec<&Path> = plot.into_iter().collect();
        let Some(resumed) = resume else {
            return Report::new(options, words, &others);
        };
        let refused = |why: &str| Err(Error::Input(format!("--resume {}{why}", resumed.display())));
        let output = options.output.as_deref();
        if output.is_some_and(|output| output != resumed) {
            return refused(" writes into that file; leave out --output");
        }
        let output = OutputOptions {
            output: Some(resumed.to_owned()),
            ..options.clone()
        };
        let report = Report::new(&output, words, &others)?;
        match (report.format, report.place.path()) {
            (Format::Csv, Some(_)) => Ok(report),
            (_, None) => refused(": only a file can be gone on with"),
            _ => refused(
                ": only CSV can be gone on with; leave out --format, and name a file that does not end in .json",
            ),
        }
    }

    /// A message on standard error.
    pub fn say(&self, text: impl std::fmt::Display) {
        if !self.quiet {
            eprintln!("{text}");
        }
    }

    /// The `# ` lines of CSV: program, command, parameters, units.
    pub fn remarks(&self, system: &System, numerics: &Value) -> Vec<String> {
        remarks(self.words, system, numerics)
    }

    /// Opens the table or CSV.
    pub fn rows(
        &self,
        to: Box<dyn std::io::Write>,
        remarks: &[String],
        columns: &[String],
        units: &[String],
    ) -> std::io::Result<Box<dyn RowWriter>> {
        rows(self.format, to, remarks, columns, units)
    }

    /// Writes the CSV file of an earlier run anew, with the rows that stay in it, and goes on after them.
    pub fn rows_after(
        &self,
        remarks: &[String],
        columns: &[String],
        kept: &[String],
    ) -> std::io::Result<Box<dyn RowWriter>> {
        let mut text = Vec::new();
        CsvRows::new(&mut text, remarks, columns)?;
        kept.iter().try_for_each(|line| writeln!(text, "{line}"))?;
        self.place.write(&text)?;
        let to = self.place.append().map_err(std::io::Error::other)?;
        Ok(Box::new(CsvRows::continued(to)))
    }

    /// The object of a command as one line.
    pub fn envelope<R: Serialize>(
        &self,
        system: &System,
        numerics: Value,
        result: R,
        work: Value,
        error: Option<&Error>,
    ) -> Vec<u8> {
        let envelope = Envelope {
            twinslip: env!("CARGO_PKG_VERSION"),
            command: self.words,
            sundials: sundials(),
            model: system.echo(),
            units: units(&system.units),
            numerics,
            result,
            work,
            error: error.map(|error| system.units.told(error.clone()).to_string()),
        };
        let mut bytes = serde_json::to_vec(&envelope).expect("numbers and names can be written");
        bytes.push(b'\n');
        bytes
    }
}

/// Opens a table, or CSV with its remarks.
pub fn rows(
    format: Format,
    to: Box<dyn std::io::Write>,
    remarks: &[String],
    columns: &[String],
    units: &[String],
) -> std::io::Result<Box<dyn RowWriter>> {
    Ok(match format {
        Format::Table => Box::new(TableRows::new(to, columns, units)?),
        Format::Csv | Format::Json => Box::new(CsvRows::new(to, remarks, columns)?),
    })
}

/// The `# ` lines of CSV made by a command: program, command, parameters, units.
pub fn remarks(words: &[String], system: &System, numerics: &Value) -> Vec<String> {
    let list = |pairs: &serde_json::Map<String, Value>| {
        let pairs: Vec<String> = pairs
            .iter()
            .filter(|(_, value)| !value.is_null())
            .map(|(name, value)| match value.as_str() {
                Some(text) => format!("{name} = {text}"),
                None => format!("{name} = {value}"),
            })
            .collect();
        pairs.join(", ")
    };
    let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
    let units: Vec<String> = system
        .units
        .names()
        .map(|(name, unit)| format!("{name} [{unit}]"))
        .into();
    let mut remarks = vec![
        format!("twinslip {}", env!("CARGO_PKG_VERSION")),
        format!("command: {}", words.join(" ")),
        format!("model: {}", list(system.echo())),
    ];
    if let Some(numerics) = numerics.as_object().filter(|map| !map.is_empty()) {
        remarks.push(format!("numerics: {}", list(numerics)));
    }
    remarks.push(format!("units: {}", units.join(", ")));
    remarks
}

/// The version of SUNDIALS, where it is built in.
pub fn sundials() -> Option<String> {
    #[cfg(feature = "sundials")]
    return Some(crate::sundials::version().to_owned());
    #[cfg(not(feature = "sundials"))]
    return None;
}

fn units(units: &Units) -> Value {
    let names = units
        .names()
        .map(|(name, unit)| (name.to_owned(), json!(unit)));
    Value::Object(names.into_iter().collect())
}

/// The names of the units of some quantities.
pub fn unit_names(units: &Units, quantities: impl Iterator<Item = Quantity>) -> Vec<String> {
    quantities
        .map(|quantity| units.name(quantity).to_owned())
        .collect()
}

/// A quantity with its error budget, in the user's units.
pub fn uncertain(units: &Units, quantity: Quantity, x: Uncertain) -> Value {
    let x = units.outward_uncertain(quantity, x);
    output::uncertain((x.value, x.uncertainty))
}

/// The work as an object.
pub fn work(work: &Work) -> Value {
    json!({
        "steps": work.steps,
        "rejected": work.rejected,
        "rhs": work.rhs,
        "jacobians": work.jacobians,
        "factorisations": work.factorisations,
        "nonlinear": work.nonlinear,
    })
}

/// A word as a shell would need it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_=./,:+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''").replace('\n', " "))
    }
}
