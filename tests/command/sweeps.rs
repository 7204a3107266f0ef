//! A quick sweep that has more than one regime.

use super::{Ended, twinslip};
use std::fs;
use std::path::Path;

/// About the Hopf points: rest, and quick cycles.
pub const GRID: &str = "sweep --driving 0.14:0.5:6 --stiffness 0.3:0.5:4";

pub fn sweep(more: &str) -> Ended {
    twinslip(&format!("{GRID} -q {more}"))
}

/// The sweep of one run, to compare with.
pub fn whole(place: &Path, more: &str) -> String {
    let path = place.join("whole.csv");
    let ended = sweep(&format!("{more} -o {}", path.display()));
    assert_eq!((ended.code, ended.err.as_str()), (0, ""));
    fs::read_to_string(path).expect("written")
}
