//! Files that rows are written into one by one: of one writer at a time, and with a remark that says whether all rows are there.
//!
//! One rule for all: a file is replaced without a word only if it is empty, or a run of this program has ended in it. A run that
//! was killed or interrupted is gone on with or replaced on request, and so is what this program has not written.

use crate::error::{Error, Result};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// What the remark on rows begins with.
const REMARK: &str = "rows: ";
/// The room for what it says: it is written over in place.
const ROOM: usize = 32;
/// What a file with remarks begins with.
pub const OURS: &str = "# twinslip ";
/// No head is longer.
const LONGEST_HEAD: u64 = 1 << 16;

/// How far the rows of a file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// A run writes them, or was killed or interrupted.
    Unfinished,
    /// All are there: so many, where that is known.
    Complete(Option<usize>),
    /// An error ended the run: no more will come.
    Failed,
}

impl Status {
    /// The remark, without `# `: equally long whatever it says.
    pub fn remark(self) -> String {
        let said = match self {
            Status::Unfinished => "unfinished".to_owned(),
            Status::Complete(None) => "complete".to_owned(),
            Status::Complete(Some(rows)) => format!("{rows}, complete"),
            Status::Failed => "ended by an error".to_owned(),
        };
        format!("{REMARK}{said:<ROOM$}")
    }

    /// What a file with these remarks says of itself, if it does.
    pub fn of<'a>(mut remarks: impl Iterator<Item = &'a str>) -> Option<Self> {
        let said = remarks
            .find_map(|remark| remark.strip_prefix(REMARK))?
            .trim_end();
        match said {
            "unfinished" => Some(Status::Unfinished),
            "complete" => Some(Status::Complete(None)),
            "ended by an error" => Some(Status::Failed),
            said => {
                let rows = said.strip_suffix(", complete")?;
                Some(Status::Complete(Some(rows.parse().ok()?)))
            }
        }
    }

    /// Where the remark stands in the bytes that a file begins with, from its first letter on.
    pub fn place(head: &[u8]) -> Option<std::ops::Range<usize>> {
        let line = format!("\n# {REMARK}");
        let at = head
            .windows(line.len())
            .position(|found| found == line.as_bytes())?;
        let begin = at + line.len() - REMARK.len();
        let range = begin..begin + REMARK.len() + ROOM;
        (head.get(range.end) == Some(&b'\n')).then_some(range)
    }
}

/// What may be written over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// Nothing, and what a run has ended in.
    Ended,
    /// What this program has written, ended or not.
    Ours,
    /// Anything.
    All,
}

/// A file that nobody else writes rows into.
#[derive(Debug)]
pub struct RowFile {
    path: PathBuf,
    file: File,
    /// Whether it was not there before.
    new: bool,
    /// Whether rows have been written.
    written: AtomicBool,
}

impl RowFile {
    /// Opens the file, as it is, and locks it. `None` for a device or a pipe: nothing of that is kept.
    ///
    /// # Errors
    /// [`Error::File`] if it can't be written, another run writes it, or it holds what must not be lost.
    pub fn claim(path: &Path, over: Over) -> Result<Option<Self>> {
        let wrong = |reason: &str| Error::File {
            action: "write",
            path: path.to_owned(),
            reason: reason.to_owned(),
        };
        if path.is_dir() {
            return Err(wrong("it is a directory"));
        }
        if super::place::special(path) {
            return super::Place::File(path.to_owned()).check().map(|()| None);
        }
        let claimed = loop {
            let new = !path.exists();
            let opened = OpenOptions::new()
                .read(true)
                .write(true)
                .create(true)
                .truncate(false)
                .open(path);
            let file = opened.map_err(|error| wrong(&error.to_string()))?;
            match RowFile::lock(path, file, new) {
                None => return Err(wrong("another run is writing to it")),
                // Its writer of before has just taken it away.
                Some(locked) if locked.gone() => (),
                Some(locked) => break locked,
            }
        };
        let head = claimed.head().map_err(|error| wrong(&error.to_string()))?;
        let text = String::from_utf8_lossy(&head);
        let remarks = text.lines().map_while(|line| line.strip_prefix("# "));
        let status = Status::of(remarks).filter(|_| text.starts_with(OURS));
        match (status, over) {
            _ if head.is_empty() || over == Over::All => Ok(Some(claimed)),
            _ if text.starts_with(OURS) && over == Over::Ours => Ok(Some(claimed)),
            (Some(Status::Complete(_) | Status::Failed), _) => Ok(Some(claimed)),
            // Remarks and names of columns, and no row.
            (Some(Status::Unfinished), _)
                if text.lines().filter(|line| !line.starts_with("# ")).count() < 2 =>
            {
                Ok(Some(claimed))
            }
            (Some(Status::Unfinished), _) => Err(wrong(
                "it holds an unfinished run; go on with it by `resume` (branch, locus, sweep) or replace it with `force`",
            )),
            (None, _) => Err(wrong(
                "it is there already and no run of this program has ended in it; replace it with `force`",
            )),
        }
    }

    /// The file, if nobody else has it. Who doesn't get it must not take it away from who did, also where both found none before.
    fn lock(path: &Path, file: File, new: bool) -> Option<Self> {
        // Where the file system knows no locks, there is none.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return None;
        }
        Some(RowFile {
            path: path.to_owned(),
            file,
            new,
            written: AtomicBool::new(false),
        })
    }

    /// A writer after the first so many bytes; what follows them is gone.
    ///
    /// # Errors
    /// The system's.
    pub fn after(&self, bytes: u64) -> io::Result<File> {
        self.written.store(true, Ordering::Relaxed);
        self.file.set_len(bytes)?;
        self.mark(Status::Unfinished)?;
        let mut to = self.file.try_clone()?;
        to.seek(SeekFrom::Start(bytes))?;
        Ok(to)
    }

    /// Says in the file how far its rows are. To be called when nothing more will be written.
    ///
    /// # Errors
    /// [`Error::File`] if it can't be written, or is not there any more.
    pub fn end(&self, status: Status) -> Result<()> {
        let wrong = |reason: String| Error::File {
            action: "write",
            path: self.path.clone(),
            reason,
        };
        if self.gone() {
            return Err(wrong(
                "it was deleted or replaced while rows were written to it: they are lost".into(),
            ));
        }
        self.mark(status).map_err(|error| wrong(error.to_string()))
    }

    fn mark(&self, status: Status) -> io::Result<()> {
        if let Some(place) = Status::place(&self.head()?) {
            let mut file = &self.file;
            file.seek(SeekFrom::Start(place.start as u64))?;
            file.write_all(status.remark().as_bytes())?;
        }
        Ok(())
    }

    fn head(&self) -> io::Result<Vec<u8>> {
        let (mut head, mut file) = (Vec::new(), &self.file);
        file.seek(SeekFrom::Start(0))?;
        file.take(LONGEST_HEAD).read_to_end(&mut head)?;
        Ok(head)
    }

    /// Whether its name belongs to no file any more, or to another one.
    fn gone(&self) -> bool {
        let Ok(now) = fs::metadata(&self.path) else {
            return true;
        };
        #[cfg(unix)]
        {
            use std::os::unix::fs::MetadataExt;
            let ours = self.file.metadata();
            ours.is_ok_and(|ours| (ours.dev(), ours.ino()) != (now.dev(), now.ino()))
        }
        #[cfg(not(unix))]
        {
            let _ = now;
            false
        }
    }
}

impl RowFile {
    /// Cuts what stands behind the end of the last line.
    fn cut(&self) -> io::Result<()> {
        const LONGEST: u64 = 1 << 16;
        let begin = self.file.metadata()?.len().saturating_sub(LONGEST);
        let (mut last, mut file) = (Vec::new(), &self.file);
        file.seek(SeekFrom::Start(begin))?;
        file.take(LONGEST).read_to_end(&mut last)?;
        match last.iter().rposition(|&byte| byte == b'\n') {
            Some(at) if at + 1 < last.len() => self.file.set_len(begin + at as u64 + 1),
            _ => Ok(()),
        }
    }
}

impl Drop for RowFile {
    /// A run that was refused leaves no file, and one that could write no more no part of a row.
    fn drop(&mut self) {
        if self.gone() {
            return;
        }
        if self.written.load(Ordering::Relaxed) {
            // What can't be read or cut now stays as it is: the row's check tells.
            let _ = self.cut();
        }
        if self.new && self.file.metadata().is_ok_and(|data| data.len() == 0) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn every_status_is_read_as_it_was_written_in_the_same_room() {
        let all = [
            Status::Unfinished,
            Status::Complete(None),
            Status::Complete(Some(0)),
            Status::Complete(Some(usize::MAX)),
            Status::Failed,
        ];
        for status in all {
            let remark = status.remark();
            assert_eq!(remark.len(), REMARK.len() + ROOM);
            assert_eq!(Status::of([&*remark].into_iter()), Some(status));
            let head = format!("# twinslip 1\n# {remark}\na,b\n");
            let place = Status::place(head.as_bytes()).expect("it is there");
            assert_eq!(head[place], remark);
        }
    }

    fn place(name: &str) -> PathBuf {
        std::env::temp_dir().join(format!("twinslip-{name}-{}.csv", std::process::id()))
    }

    #[test]
    fn who_is_refused_leaves_the_file_to_its_writer() {
        let path = place("refused");
        let first = RowFile::claim(&path, Over::Ended)
            .expect("free")
            .expect("a file");
        // Begun at the same time: it found no file either.
        let file = File::options()
            .write(true)
            .open(&path)
            .expect("it is there");
        assert!(RowFile::lock(&path, file, true).is_none());
        assert!(!first.gone());
        drop(first);
        assert!(!path.exists());
    }

    #[test]
    fn of_many_that_begin_at_once_one_has_the_file_and_keeps_it() {
        let path = place("at-once");
        let claims: usize = std::thread::scope(|scope| {
            let work = || {
                let mut claims = 0;
                for _ in 0..2000 {
                    if let Ok(Some(file)) = RowFile::claim(&path, Over::Ended) {
                        std::thread::yield_now();
                        assert!(!file.gone());
                        claims += 1;
                    }
                }
                claims
            };
            let all = [0; 4].map(|_| scope.spawn(work));
            all.into_iter()
                .map(|one| one.join().expect("no panic"))
                .sum()
        });
        assert!(claims > 0);
        // Empty, or not there: whose file it was is not always told.
        let _ = fs::remove_file(&path);
    }
}
