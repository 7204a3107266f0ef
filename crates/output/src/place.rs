//! Where output goes. A path is tried before anything is computed; whole files appear complete or not at all.

use crate::error::{Error, Result};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Standard output, or a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// Standard output.
    Standard,
    /// A file.
    File(PathBuf),
}

impl Place {
    /// `-` and nothing are standard output.
    pub fn new(path: Option<&Path>) -> Self {
        match path {
            None => Place::Standard,
            Some(path) if path == Path::new("-") => Place::Standard,
            Some(path) => Place::File(path.to_owned()),
        }
    }

    /// The file, where it is one.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Place::Standard => None,
            Place::File(path) => Some(path),
        }
    }

    /// Finds out whether it can be written, and leaves nothing behind.
    ///
    /// # Errors
    /// [`Error::File`] with the system's words.
    pub fn check(&self) -> Result<()> {
        let Place::File(path) = self else {
            return Ok(());
        };
        if path.is_dir() {
            return Err(wrong(path, "it is a directory"));
        }
        if path.as_os_str().as_encoded_bytes().ends_with(b"/") {
            return Err(wrong(path, "it ends in /, as names of directories do"));
        }
        if special(path) {
            return OpenOptions::new()
                .write(true)
                .open(path)
                .map(drop)
                .map_err(|error| wrong(path, error));
        }
        if path.exists() {
            OpenOptions::new()
                .append(true)
                .open(path)
                .map_err(|error| wrong(path, error))?;
        }
        let trial = beside(path);
        File::create(&trial).map_err(|error| wrong(path, error))?;
        fs::remove_file(&trial).map_err(|error| wrong(path, error))
    }

    /// A writer of rows that are to stay however the run ends.
    ///
    /// # Errors
    /// [`Error::File`] if the file can't be created.
    pub fn stream(&self) -> Result<Box<dyn Write>> {
        match self {
            Place::Standard => Ok(Box::new(io::stdout().lock())),
            Place::File(path) => File::create(path)
                .map(|file| Box::new(file) as Box<dyn Write>)
                .map_err(|error| wrong(path, error)),
        }
    }

    /// Writes it all at once; a file appears complete or not at all.
    ///
    /// # Errors
    /// The system's, which for standard output may be a broken pipe.
    pub fn write(&self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Place::Standard => {
                let mut out = io::stdout().lock();
                out.write_all(bytes)?;
                out.flush()
            }
            Place::File(path) => write_whole(path, bytes),
        }
    }
}

/// Writes beside the file and renames: a reader sees the old file or the new one.
///
/// # Errors
/// The system's.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_whole_by(path, |error| error, |file| file.write_all(bytes))
}

/// The same for what is not in memory all at once; `fill` writes it, and `system` says what an error of the system is to it.
///
/// # Errors
/// The system's, and those of `fill`.
pub fn write_whole_by<E>(
    path: &Path,
    system: impl Fn(io::Error) -> E,
    fill: impl FnOnce(&mut io::BufWriter<File>) -> std::result::Result<(), E>,
) -> std::result::Result<(), E> {
    let into = |path: &Path| {
        let mut file = io::BufWriter::new(File::create(path).map_err(&system)?);
        fill(&mut file)?;
        file.flush().map_err(&system)
    };
    if special(path) {
        return into(path);
    }
    let temporary = beside(path);
    list(|all| all.push(temporary.clone()));
    let written = into(&temporary);
    let written = written.and_then(|()| fs::rename(&temporary, path).map_err(&system));
    if written.is_err() {
        // What is left of it is of no use; that it may not exist at all is no second error.
        let _ = fs::remove_file(&temporary);
    }
    list(|all| all.retain(|one| *one != temporary));
    written
}

/// The files that are being written beside those whose place they will take.
static TEMPORARY: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn list(change: impl FnOnce(&mut Vec<PathBuf>)) {
    change(&mut TEMPORARY.lock().unwrap_or_else(PoisonError::into_inner));
}

/// Removes what is not complete, before the process ends.
pub fn remove_temporary() {
    list(|all| {
        for path in all.drain(..) {
            let _ = fs::remove_file(path);
        }
    });
}

/// A device or a pipe, such as /dev/null, must not be replaced by a file.
pub(super) fn special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|data| !data.is_file() && !data.is_dir())
}

fn beside(path: &Path) -> PathBuf {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.tmp", std::process::id()));
    path.with_file_name(name)
}

fn wrong(path: &Path, reason: impl ToString) -> Error {
    Error::File {
        action: "write",
        path: path.to_owned(),
        reason: reason.to_string(),
    }
}
