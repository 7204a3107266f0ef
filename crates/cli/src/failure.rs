//! Why a command failed, as programs that call it tell it: in a word, the option to blame, and a sentence.

use std::any::Any;
use twinslip::error::Error;

/// Why a command failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// `input`, `file`, `numerical`, or `defect` for a panic.
    pub kind: &'static str,
    /// The option that is to blame, where it is known.
    pub field: Option<String>,
    /// What went wrong, as a sentence.
    pub words: String,
}

impl Failure {
    /// The failure that an error tells of.
    pub fn of(error: &Error) -> Self {
        let kind = match error {
            Error::File { .. } => "file",
            error if error.is_input() => "input",
            _ => "numerical",
        };
        Failure {
            kind,
            field: Self::field(error),
            words: error.to_string(),
        }
    }

    /// The failure that a caught panic is.
    pub fn of_panic(panic: &(dyn Any + Send)) -> Self {
        let text = panic.downcast_ref::<&str>().copied();
        let text = text.or(panic.downcast_ref::<String>().map(String::as_str));
        Failure {
            kind: "defect",
            field: None,
            words: format!(
                "a defect of twinslip, which please report: {}",
                text.unwrap_or("a panic")
            ),
        }
    }

    /// The option that an error of the input names.
    pub fn field(error: &Error) -> Option<String> {
        let plain = |name: &str| name.trim_start_matches('-').replace('-', "_");
        match error {
            Error::Parameter { name, .. } => Some(plain(name)),
            Error::InUnits { error, .. } => Self::field(error),
            // The first name in backticks, or the first flag.
            Error::Input(words) => {
                let named = words.split('`').nth(1);
                let flag = words
                    .split(|c: char| c.is_whitespace() || "'\"`=,;:)".contains(c))
                    .find(|word| word.len() > 2 && word.starts_with("--"));
                named.or(flag).map(plain)
            }
            _ => None,
        }
    }
}
