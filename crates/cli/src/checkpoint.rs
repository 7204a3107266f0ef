//! Checkpoints of a run of many interfaces in a file that is replaced as a whole: a line of JSON that says of which run, numbers, and a check
//! sum. A run that was killed goes on from there to the same bytes.

use serde_json::{Map, Value};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use twinslip::error::{Error, Result};
use twinslip::integrate::Control;
use twinslip::many::{Saved, Share};
use twinslip_output::{check_sum, write_whole_by};
use twinslip_tasks::scene::{ManyCheckpoint, Sink};

/// The file of checkpoints of one run.
pub struct CheckpointFile {
    path: PathBuf,
    /// The rows, which are cut where a checkpoint knows them.
    rows: PathBuf,
    /// What the run is: another one can't go on from there.
    of: Map<String, Value>,
}

/// What there is of a run that was killed.
pub struct Earlier {
    /// Bytes of the rows that stay.
    pub bytes: u64,
    /// From where it goes on; `None` for its beginning.
    pub checkpoint: Option<ManyCheckpoint>,
}

/// How many numbers there are of each kind, and how far the rows are.
#[derive(serde::Serialize, serde::Deserialize)]
struct Head {
    twinslip: String,
    bytes: u64,
    steps: usize,
    shared: usize,
    rows: usize,
    events: usize,
    interfaces: usize,
    checkpoint_of: Map<String, Value>,
}

impl CheckpointFile {
    pub fn new(path: &Path, rows: &Path, of: Map<String, Value>) -> Self {
        CheckpointFile {
            path: path.to_owned(),
            rows: rows.to_owned(),
            of,
        }
    }

    fn wrong(&self, action: &'static str, reason: impl ToString) -> Error {
        Error::File {
            action,
            path: self.path.clone(),
            reason: reason.to_string(),
        }
    }

    /// The last checkpoint, if there is any, of the interfaces that are held here.
    ///
    /// # Errors
    /// [`Error::File`] for what is no checkpoint, or where rows are missing; [`Error::Input`] for the checkpoint of another run.
    pub fn read(&self, share: &Share) -> Result<Option<Earlier>> {
        if !self.path.exists() {
            return Ok(None);
        }
        let bytes = fs::read(&self.path).map_err(|error| self.wrong("read", error))?;
        let damaged = || {
            let what =
                "it is no checkpoint of this version, or is damaged; delete it to start again";
            self.wrong("read", what)
        };
        let (rest, sum) = bytes.split_last_chunk::<4>().ok_or_else(damaged)?;
        if check_sum(rest) != u32::from_le_bytes(*sum) {
            return Err(damaged());
        }
        let end = rest.iter().position(|byte| *byte == b'\n');
        let (head, numbers) = rest.split_at(end.ok_or_else(damaged)? + 1);
        let head: Head = serde_json::from_slice(head).map_err(|_| damaged())?;
        if head.twinslip != env!("CARGO_PKG_VERSION") {
            return Err(damaged());
        }
        if let Some(name) = self.differs(&head.checkpoint_of) {
            return Err(Error::Input(format!(
                "--checkpoint {}: it belongs to another run, as {name} differs; name another file, or delete it",
                self.path.display()
            )));
        }
        if head.steps == 0 {
            return Ok(Some(Earlier {
                bytes: 0,
                checkpoint: None,
            }));
        }
        let (numbers, beside) = numbers.as_chunks::<8>();
        let counts = [2, head.shared, head.rows, head.events, head.interfaces];
        if numbers.len() != counts.iter().sum::<usize>() || !beside.is_empty() {
            return Err(damaged());
        }
        let mut numbers = numbers;
        let mut next = |count: usize| {
            let (these, rest) = numbers.split_at(count);
            numbers = rest;
            these.iter().copied().map(f64::from_le_bytes).collect()
        };
        let [time, shared, rows, events, all]: [Vec<f64>; 5] = counts.map(&mut next);
        let written = fs::metadata(&self.rows).map_or(0, |file| file.len());
        if written < head.bytes {
            let rows = self.rows.display();
            return Err(self.wrong(
                "use",
                format!("{rows} has lost rows; delete both to start again"),
            ));
        }
        let state = Saved {
            time: [time[0], time[1]],
            steps: head.steps,
            shared,
            held: all[share.held()].to_vec(),
        };
        Ok(Some(Earlier {
            bytes: head.bytes,
            checkpoint: Some(ManyCheckpoint {
                state,
                rows,
                events,
            }),
        }))
    }

    /// What another run has another value of.
    fn differs<'a>(&'a self, other: &'a Map<String, Value>) -> Option<&'a str> {
        let names = self.of.keys().chain(other.keys());
        { names }
            .find(|name| self.of.get(*name) != other.get(*name))
            .map(String::as_str)
    }

    /// Marks that the run has begun: its first rows may be replaced.
    pub fn begin(&self) -> Result<()> {
        let state = Saved {
            time: [0.0; 2],
            steps: 0,
            shared: Vec::new(),
            held: Vec::new(),
        };
        let (rows, events) = (Vec::new(), Vec::new());
        let nothing = ManyCheckpoint {
            state,
            rows,
            events,
        };
        self.write(&nothing, 0)
    }

    /// Replaces the last checkpoint, after rows of so many bytes.
    fn write(&self, checkpoint: &ManyCheckpoint, bytes: u64) -> Result<()> {
        let ManyCheckpoint {
            state,
            rows,
            events,
        } = checkpoint;
        let head = Head {
            twinslip: env!("CARGO_PKG_VERSION").to_owned(),
            bytes,
            steps: state.steps,
            shared: state.shared.len(),
            rows: rows.len(),
            events: events.len(),
            interfaces: state.held.len(),
            checkpoint_of: self.of.clone(),
        };
        let mut all = serde_json::to_vec(&head).map_err(|error| self.wrong("write", error))?;
        all.push(b'\n');
        for numbers in [&state.time[..], &state.shared, rows, events, &state.held] {
            all.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        }
        all.extend(check_sum(&all).to_le_bytes());
        let system = |error: std::io::Error| self.wrong("write", error);
        write_whole_by(&self.path, system, |file| {
            let written = file.write_all(&all).and_then(|()| file.flush());
            written
                .and_then(|()| file.get_ref().sync_data())
                .map_err(system)
        })
    }

    /// The run is complete: there is nothing more to go on with.
    pub fn remove(&self) {
        // A short run has never come to one.
        let _absent = fs::remove_file(&self.path);
    }
}

/// The rows of a run on their way out, with checkpoints.
pub struct SavingOut<'a> {
    pub out: &'a mut dyn Sink,
    pub file: &'a CheckpointFile,
}

impl Sink for SavingOut<'_> {
    fn row(&mut self, row: &[f64]) -> Control {
        self.out.row(row)
    }

    fn drawn(&mut self, point: &[f64]) {
        self.out.drawn(point);
    }

    fn reached(&mut self, fraction: f64) -> Control {
        self.out.reached(fraction)
    }

    /// Rows first: a checkpoint never knows more of them than there are.
    fn save(&mut self, checkpoint: &ManyCheckpoint) -> Result<()> {
        let rows = File::open(&self.file.rows).and_then(|rows| {
            rows.sync_data()?;
            rows.metadata()
        });
        let rows = rows.map_err(|error| self.file.wrong("write", error))?;
        self.file.write(checkpoint, rows.len())
    }
}
