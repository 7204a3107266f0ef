//! The report: one page of all that lies in the directory.

use super::record::Record;
use crate::error::Result;
use std::path::Path;

/// Writes it.
///
/// # Errors
/// [`crate::Error::File`].
pub fn write(_dir: &Path, _record: &Record) -> Result<()> {
    Ok(())
}
