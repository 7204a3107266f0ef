//! What a killed run of many interfaces needs to go on to the same bytes.

use twinslip::many::Saved;

/// A run on its way, in numbers: whole numbers as they are.
#[derive(Debug, Clone, PartialEq)]
pub struct ManyCheckpoint {
    /// The state, and what the method has beside it.
    pub state: Saved,
    /// How far the rows are: those at given times so far, the slip of all and of those watched in two doubles each, and the last row.
    pub rows: Vec<f64>,
    /// The slip events, where they are asked for.
    pub events: Vec<f64>,
}

/// How often a run is saved, and from where it goes on.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Saving {
    /// Steps between two.
    pub every: Option<usize>,
    /// Where it goes on.
    pub from: Option<ManyCheckpoint>,
}
