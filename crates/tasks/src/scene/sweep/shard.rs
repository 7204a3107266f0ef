//! Parts of a sweep for several machines.

use twinslip::error::{Error, Result};

/// More parts than this are a slip of the pen.
const MOST_PARTS: usize = 1_000_000;

/// A part of a grid: of its units those whose numbers leave the remainder `index` - 1 after division by `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which part, from 1.
    pub index: usize,
    /// How many parts there are.
    pub of: usize,
}

impl Shard {
    /// The one part that is all.
    pub const WHOLE: Shard = Shard { index: 1, of: 1 };

    /// From `I/N`.
    ///
    /// # Errors
    /// [`Error::Input`] for anything else, and for more parts than a million.
    pub fn parse(text: &str) -> Result<Self> {
        let numbers = text
            .split_once('/')
            .and_then(|(index, of)| Some((index.parse().ok()?, of.parse().ok()?)));
        match numbers {
            Some((index, of)) if of <= MOST_PARTS && (1..=of).contains(&index) => {
                Ok(Shard { index, of })
            }
            _ => Err(Error::Input(format!(
                "shard is {text}, but must be I/N with I from 1 to N, and N at most {MOST_PARTS}"
            ))),
        }
    }

    /// How many of so many units it has.
    pub fn units(self, all: usize) -> usize {
        (all + self.of - self.index) / self.of
    }

    /// The number of its unit at a place, both from 0.
    pub fn unit(self, place: usize) -> usize {
        self.index - 1 + place * self.of
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}
