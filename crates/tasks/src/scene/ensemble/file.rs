//! `FIT.json[:N]`.

use std::path::{Path, PathBuf};
use twinslip::error::{Error, Result};

/// More draws than this are a slip of the pen.
const MOST_DRAWS: usize = 1_000_000;

/// Which fit, and how often its parameters are drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EnsembleFile {
    /// The file.
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
        let Some((path, count)) = text.rsplit_once(':') else {
            return Ok(whole);
        };
        // A file may have a colon in its name, and a disk in its path.
        if Path::new(text).exists() || count.contains(['/', '\\', '.']) {
            return Ok(whole);
        }
        let draws = count.parse::<usize>().ok();
        match draws.filter(|&draws| draws <= MOST_DRAWS) {
            Some(draws) => Ok(EnsembleFile {
                path: PathBuf::from(path),
                draws: Some(draws),
            }),
            None => Err(Error::Input(format!(
                "`ensemble` {text:?}: the number of draws is {count:?}, but must be a whole number from 0 to 1e6"
            ))),
        }
    }
}
