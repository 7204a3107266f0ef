//! A sweep into a Parquet file. Such a file can't be gone on with, so rows are kept in a CSV file beside it until all are there.

use crate::Ending;
use std::path::{Path, PathBuf};
use twinslip::error::{Error, Result};
use twinslip_output::Place;
use twinslip_tasks::scene::SweepOptions;

const NAME: &str = "parquet";

/// The Parquet file, where one is asked for, and the options that make the CSV for it.
pub fn asked(options: &SweepOptions) -> Result<Option<(PathBuf, SweepOptions)>> {
    let target = options.resume.as_ref().or(options.output.output.as_ref());
    let ends = |path: &PathBuf| path.extension().is_some_and(|extension| extension == NAME);
    let named = options.output.format.as_deref() == Some(NAME);
    if !named && (options.output.format.is_some() || !target.is_some_and(ends)) {
        return Ok(None);
    }
    let Some(target) = target.filter(|path| path.as_path() != Path::new("-")) else {
        return Err(Error::Input(
            "--format parquet needs a file: such data can't be written to a pipe; name one with --output".into(),
        ));
    };
    if !cfg!(feature = "parquet") {
        return Err(Error::Input(format!(
            "{}: this build writes no Parquet; build with --features parquet, or write CSV",
            target.display()
        )));
    }
    Place::File(target.clone()).check()?;
    let rows = beside(target);
    let mut by_csv = options.clone();
    by_csv.output.format = Some("csv".into());
    by_csv.output.output = Some(rows.clone());
    by_csv.resume = options.resume.as_ref().map(|_| rows);
    Ok(Some((target.clone(), by_csv)))
}

/// The CSV file of rows so far.
fn beside(target: &Path) -> PathBuf {
    let mut name = target.file_name().unwrap_or_default().to_owned();
    name.push(".csv");
    target.with_file_name(name)
}

/// Makes the Parquet file of a sweep that is complete, and removes the CSV.
pub fn finish(target: &Path, ending: Ending) -> Result<Ending> {
    if ending == Ending::Interrupted {
        return Ok(ending);
    }
    let rows = beside(target);
    #[cfg(feature = "parquet")]
    super::parquet_file::from_csv(
        &rows,
        target,
        &["returns", twinslip_output::ROW_CHECK],
        &["regime", "symmetry", "note"],
    )?;
    std::fs::remove_file(&rows).map_err(|error| Error::File {
        action: "remove",
        path: rows,
        reason: error.to_string(),
    })?;
    Ok(ending)
}
