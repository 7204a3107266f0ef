//! `FIT.json[:N]`.

use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

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

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn a_number_of_draws_stands_behind_the_file() {
        let read = |text: &str| EnsembleFile::parse(text).expect("readable");
        let file = read("a/fit.json:50");
        assert_eq!(file.path, Path::new("a/fit.json"));
        assert_eq!(file.draws, Some(50));
        assert_eq!(read("fit.json:0").draws, Some(0));
        assert_eq!(read("fit.json").draws, None);
        assert_eq!(read("C:\\fit.json").path, Path::new("C:\\fit.json"));
        for wrong in ["fit.json:", "fit.json:-1", "fit.json:many", "fit.json:1e7"] {
            assert!(EnsembleFile::parse(wrong).is_err(), "{wrong}");
        }
    }
}
