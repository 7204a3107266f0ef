use super::Entry; use crate::error::Result; use crate::paper::Pieces;
pub fn of_fig_8(_: &Pieces<'_>) -> Result<Vec<Entry>> { Ok(vec![]) }
pub fn of_figs_11_and_13(_: &Pieces<'_>) -> Result<Vec<Entry>> { Ok(vec![]) }
pub fn of_fig_16(_: &Pieces<'_>) -> Result<Vec<Entry>> { Ok(vec![]) }
