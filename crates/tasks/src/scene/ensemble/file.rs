//! `FIT.json[:N]`, or the text of such a file in place of its name.

use super::super::text::given_text;
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use twinslip::error::{Error, Result};

/// More draws than this are a slip of the pen.
const MOST_DRAWS: usize = 1_000_000;

/// Which fit, and how often its parameters are drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EnsembleFile {
    /// The file, or its text.
    pub path: PathBuf,
    /// How many draws are asked for, if any number is.
    pub draws: Option<usize>,
}

impl EnsembleFile {
    /// From what stands behind `--ensemble`.
    ///
    /// # Errors
    /// [`Error::Input`] for a number of draws that is none.
    pub fn parse(text: &str) -> Result<Self> {
        let whole = EnsembleFile {
            path: PathBuf::from(text),
            draws: None,
        };
        if given_text(&whole.path).is_some() {
            // An object ends with a brace; a text that does not is read as it is, and refused.
            let (object, count) = text.split_at(text.rfind('}').map_or(text.len(), |end| end + 1));
            let Some(count) = count.trim().strip_prefix(':') else {
                return Ok(whole);
            };
            return Ok(EnsembleFile {
                // With a line's end it is still a text.
                path: PathBuf::from(format!("{object}\n")),
                draws: Some(number_of_draws(
                    &format!("{}:{count}", whole.told()),
                    count,
                )?),
            });
        }
        let Some((path, count)) = text.rsplit_once(':') else {
            return Ok(whole);
        };
        // A file may have a colon in its name, and a disk in its path.
        if Path::new(text).exists() || count.contains(['/', '\\', '.']) {
            return Ok(whole);
        }
        Ok(EnsembleFile {
            draws: Some(number_of_draws(text, count)?),
            path: PathBuf::from(path),
        })
    }

    /// What messages call it: not the text itself.
    pub fn told(&self) -> Cow<'_, str> {
        told(&self.path)
    }
}

/// What messages call a file, or a text in its place.
pub(super) fn told(path: &Path) -> Cow<'_, str> {
    match given_text(path) {
        Some(_) => "(a text)".into(),
        None => path.to_string_lossy(),
    }
}

/// The number of draws at the end of an option.
fn number_of_draws(option: &str, count: &str) -> Result<usize> {
    let draws = count.parse::<usize>().ok();
    draws.filter(|&draws| draws <= MOST_DRAWS).ok_or_else(|| {
        Error::Input(format!(
            "`ensemble` {option:?}: the number of draws is {count:?}, but must be a whole number from 0 to 1e6"
        ))
    })
}
