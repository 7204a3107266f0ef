//! A scene file: TOML that holds what the flags of a command hold, by the same names, and `command = "NAME"`.
//!
//! Its keys are turned into the flags themselves, so a scene and a command line are read, checked and run by the same code.

use super::ensemble::EnsembleFile;
use super::words::with_unit;
use clap::{Arg, ArgAction, Command};
use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};
use twinslip::error::{Error, Result, did_you_mean};

/// No scene is longer, in bytes.
const LONGEST: u64 = 1 << 18;

/// The keys of the word after the command, as in `branch orbits` and `fit DATA.csv`.
const POSITIONAL: [&str; 2] = ["of", "data"];

/// A scene file, read.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneFile {
    /// Where it came from.
    pub name: String,
    /// The subcommand that it sets.
    pub command: String,
    /// What the subcommand is of, where it takes such a word.
    of: Option<String>,
    /// Its keys as flags, with the line of each.
    flags: Vec<(String, Option<String>, usize)>,
}

impl SceneFile {
    /// Reads a file; `program` is the command line that it stands for.
    ///
    /// # Errors
    /// [`Error::File`] if it can't be read; [`Error::Input`] with file, line and key for what is wrong in it.
    pub fn read(path: &Path, program: &Command) -> Result<Self> {
        let text = read_bounded(path, LONGEST)?;
        let mut scene = Self::parse(&path.display().to_string(), &text, program)?;
        // Where a file is, its systems and laws are; those that are built in have no place.
        for (flag, value, _) in &mut scene.flags {
            if let ("system" | "law" | "ensemble", Some(value), Some(folder)) =
                (flag.as_str(), value, path.parent())
            {
                let beside = folder.join(value.as_str());
                // A number of draws may stand behind a fit.
                let counted =
                    || EnsembleFile::parse(value).is_ok_and(|file| folder.join(file.path).exists());
                if beside.exists() || (flag == "ensemble" && counted()) {
                    *value = beside.display().to_string();
                }
            }
        }
        Ok(scene)
    }

    /// Reads a text under the name that messages shall use for it.
    ///
    /// # Errors
    /// As [`SceneFile::read`].
    pub fn parse(name: &str, text: &str, program: &Command) -> Result<Self> {
        let reader = Reader { name, text };
        let table = DeTable::parse(text).map_err(|error| {
            let place = error.span().unwrap_or(0..0);
            let message = error.message().replace('\n', ", ");
            reader.wrong(&place, reader.unquoted(&place).unwrap_or(message))
        })?;
        let table = table.get_ref();
        let command = reader.command(table, program)?;
        let options: Vec<&Arg> = command
            .get_arguments()
            .filter(|arg| key_of(arg).is_some_and(|key| key != "help"))
            .collect();
        let (mut of, mut flags) = (None, Vec::new());
        for (key, value) in table {
            if key.get_ref() == "command" {
                continue;
            }
            let line = reader.line(&key.span());
            match reader.flag(key, value, &options)? {
                Some((key, value)) if POSITIONAL.contains(&key.as_str()) => of = value,
                Some((flag, value)) => flags.push((flag, value, line)),
                None => {}
            }
        }
        Ok(SceneFile {
            name: name.to_owned(),
            command: command.get_name().to_owned(),
            of,
            flags,
        })
    }

    /// The command line that the scene stands for: subcommand and flags, without the keys in `replaced`.
    pub fn arguments(&self, replaced: &[&str]) -> Vec<String> {
        let mut arguments = vec![self.command.clone()];
        arguments.extend(self.of.clone());
        for (flag, value, _) in &self.flags {
            if !replaced.contains(&flag.as_str()) {
                arguments.push(match value {
                    Some(value) => format!("--{flag}={value}"),
                    None => format!("--{flag}"),
                });
            }
        }
        arguments
    }

    /// The same error, with the file and, if it names a key of this file, the line.
    pub fn locate(&self, error: &Error) -> Error {
        let text = match error {
            Error::Parameter { name, .. } => name,
            Error::Input(text) => text,
            _ => return error.clone(),
        };
        // A field's name stands in backticks and has underscores where its key has hyphens.
        let words = text.split_whitespace().map(|word| {
            let word = word.trim_matches(|c: char| !c.is_alphanumeric());
            word.replace('_', "-")
        });
        let mut lines = words.filter_map(|word| {
            let found = self.flags.iter().find(|(flag, ..)| *flag == word);
            found.map(|(.., line)| format!("{line}:"))
        });
        let line = lines.next().unwrap_or_default();
        Error::Input(format!("{}:{line} {error}", self.name))
    }
}

/// A text, and the name that messages use for it.
pub(super) struct Reader<'a> {
    pub name: &'a str,
    pub text: &'a str,
}

impl Reader<'_> {
    fn line(&self, span: &Range<usize>) -> usize {
        let upto = span.start.min(self.text.len());
        1 + self.text.as_bytes()[..upto]
            .iter()
            .filter(|&&byte| byte == b'\n')
            .count()
    }

    fn wrong(&self, span: &Range<usize>, what: impl std::fmt::Display) -> Error {
        Error::Input(format!("{}:{}: {what}", self.name, self.line(span)))
    }

    /// What is wrong at a byte, by line and column.
    pub(super) fn misplaced(&self, at: usize, what: impl std::fmt::Display) -> Error {
        let (line, column) = self.place(at);
        Error::Input(format!("{}:{line}:{column}: {what}", self.name))
    }

    /// The line and the column of a byte.
    pub(super) fn place(&self, at: usize) -> (usize, usize) {
        let begin = self.text.get(..at).unwrap_or(self.text);
        let column = 1 + begin.chars().rev().take_while(|c| *c != '\n').count();
        (self.line(&(at..at)), column)
    }

    /// What is wrong on the line of `span` if a text there has no quotes, with the line as it should be.
    fn unquoted(&self, span: &Range<usize>) -> Option<String> {
        let line = self.text.lines().nth(self.line(span) - 1)?;
        let (key, value) = line.split_once('=')?;
        let (key, value) = (key.trim(), value.split('#').next()?.trim());
        let bare = |c: char| c.is_alphanumeric() || "_-+:;,./=()* ".contains(c);
        let begins = |c: char| c.is_alphabetic() || "./".contains(c);
        let text = value.starts_with(begins) || value.contains(':');
        let other = value.parse::<f64>().is_ok() || ["true", "false"].contains(&value);
        (text && !other && value.chars().all(bare) && !key.is_empty())
            .then(|| format!("a text needs quotes in a scene: {key} = {value:?}"))
    }

    fn command<'c>(&self, table: &DeTable<'_>, program: &'c Command) -> Result<&'c Command> {
        let known = || {
            program
                .get_subcommands()
                .map(Command::get_name)
                .filter(|&name| name != "help")
        };
        let list = known().collect::<Vec<_>>().join(", ");
        let Some((_, value)) = table.iter().find(|(key, _)| key.get_ref() == "command") else {
            return Err(self.wrong(
                &(0..0),
                format!("the key command is missing; it must be one of {list}"),
            ));
        };
        let text = value.get_ref().as_str().unwrap_or_default();
        known()
            .find(|&name| name == text)
            .and_then(|name| program.find_subcommand(name))
            .ok_or_else(|| {
                let hint = did_you_mean(text, known());
                self.wrong(
                    &value.span(),
                    format!("command must be one of {list}, not {text:?}{hint}"),
                )
            })
    }

    /// One key as a flag; `None` for a switch that is off.
    fn flag(
        &self,
        key: &Spanned<std::borrow::Cow<'_, str>>,
        value: &Spanned<DeValue<'_>>,
        options: &[&Arg],
    ) -> Result<Option<(String, Option<String>)>> {
        let name = key.get_ref().as_ref();
        let keys = || options.iter().filter_map(|arg| key_of(arg));
        let Some(option) = options.iter().find(|arg| key_of(arg) == Some(name)) else {
            let hint = did_you_mean(name, keys());
            return Err(self.wrong(&key.span(), format!("unknown key {name:?}{hint}")));
        };
        let wrong = |must: &str| {
            let kind = value.get_ref().type_str();
            self.wrong(&value.span(), format!("{name} must be {must}, not {kind}"))
        };
        if matches!(option.get_action(), ArgAction::SetTrue) {
            let on = value
                .get_ref()
                .as_bool()
                .ok_or_else(|| wrong("true or false"))?;
            return Ok(on.then(|| (name.to_owned(), None)));
        }
        // A switch that may name something.
        let optional = option
            .get_num_args()
            .is_some_and(|count| count.min_values() == 0);
        if let (true, Some(on)) = (optional, value.get_ref().as_bool()) {
            return Ok(on.then(|| (name.to_owned(), None)));
        }
        let numeric = is_numeric(option);
        let text = match value.get_ref() {
            DeValue::Integer(number) if number.radix() == 10 => number.as_str().to_owned(),
            DeValue::Float(number) => number.as_str().to_owned(),
            DeValue::String(text) if !numeric => text.to_string(),
            // Its unit is read with those of flags.
            DeValue::String(text) if with_unit(text).is_some() => text.to_string(),
            // What may be given again: NAME=VALUE for each, or NAME=V1,V2,... where that has commas of its own.
            DeValue::Table(entries) if matches!(option.get_action(), ArgAction::Append) => {
                let lists = option.get_value_delimiter().is_none();
                let pair = |(name, value): (&Spanned<_>, &Spanned<DeValue<'_>>)| {
                    let name: &std::borrow::Cow<'_, str> = name.get_ref();
                    let value = match value.get_ref() {
                        DeValue::Array(items) if lists => list(items, ',')?,
                        value => scalar(value)?,
                    };
                    Some(format!("{name}={value}"))
                };
                let pairs: Option<Vec<String>> = entries.iter().map(pair).collect();
                let separator = if lists { ";" } else { "," };
                pairs
                    .ok_or_else(|| wrong("a table of numbers"))?
                    .join(separator)
            }
            DeValue::Array(items) if !numeric => {
                let between = option.get_value_delimiter().unwrap_or(',');
                list(items, between).ok_or_else(|| wrong("a list of numbers or names"))?
            }
            _ => return Err(wrong(if numeric { "a number" } else { "a text" })),
        };
        if text.is_empty() {
            return Err(self.wrong(&value.span(), format!("{name} is empty")));
        }
        let number = with_unit(&text).is_some() || text.parse().is_ok_and(f64::is_finite);
        if numeric && !number {
            return Err(self.wrong(
                &value.span(),
                format!("{name} is {text}, but must be finite"),
            ));
        }
        Ok(Some((name.to_owned(), Some(text))))
    }
}

/// The key that stands for an option: its long name, or that of the word after the command.
fn key_of(arg: &Arg) -> Option<&str> {
    if arg.is_positional() {
        Some(arg.get_id().as_str()).filter(|id| POSITIONAL.contains(id))
    } else {
        arg.get_long()
    }
}

/// Numbers or names, with commas or what else parts the values of an option between.
fn list(items: &DeArray<'_>, between: char) -> Option<String> {
    let items: Option<Vec<String>> = items.iter().map(|item| scalar(item.get_ref())).collect();
    Some(items?.join(&between.to_string()))
}

fn scalar(value: &DeValue<'_>) -> Option<String> {
    match value {
        DeValue::Integer(number) => Some(number.as_str().to_owned()),
        DeValue::Float(number) => Some(number.as_str().to_owned()),
        DeValue::String(text) => Some(text.to_string()),
        _ => None,
    }
}

/// The text of a file that is not longer than so many bytes; of a longer one no more is read.
///
/// # Errors
/// [`Error::File`] if it can't be read, is no text or is longer.
pub(super) fn read_bounded(path: &Path, most: u64) -> Result<String> {
    let bytes = read_bytes(path, most)?;
    String::from_utf8(bytes).map_err(|_| Error::File {
        action: "read",
        path: path.to_owned(),
        reason: "it is not UTF-8".into(),
    })
}

/// The bytes of a file that is no longer than `most`.
///
/// # Errors
/// [`Error::File`].
pub(super) fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>> {
    let wrong = |reason: String| Error::File {
        action: "read",
        path: path.to_owned(),
        reason,
    };
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(most + 1).read_to_end(&mut bytes));
    read.map_err(|error| wrong(error.to_string()))?;
    if bytes.len() as u64 > most {
        return Err(wrong(format!("it is longer than {most} bytes")));
    }
    Ok(bytes)
}

/// Whether an option takes a number: its parser says what it makes.
fn is_numeric(option: &Arg) -> bool {
    let made = option.get_value_parser().type_id();
    made == std::any::TypeId::of::<f64>()
        || made == std::any::TypeId::of::<usize>()
        || made == std::any::TypeId::of::<u64>()
        || made == std::any::TypeId::of::<u8>()
}
