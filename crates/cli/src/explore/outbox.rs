//! What a command yields, as lines of JSON on their way to whoever asked for it.
//!
//! The thread of the command writes, the connection takes. Where the connection is slow the command waits, so that no more than
//! [`ROOM`] bytes are kept; where it is gone the command is stopped.

use super::queue::Queue;
use crate::Ending;
use crate::call::Outlet;
use crate::failure::Failure;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::task::Waker;
use std::time::{Duration, Instant};
use twinslip_output::plot::Drawing;
use twinslip_output::{Cell, shortest};

/// Bytes that may wait to be taken before the command waits.
const ROOM: usize = 1 << 20;
/// The least time between two lines that tell how far the command is.
const BETWEEN: Duration = Duration::from_millis(100);
/// Rows of one answer; more are a slip of the pen, and no page draws them.
pub const MOST_ROWS: usize = 200_000;
/// Numbers that are kept for the picture of one answer, of four points in each step: their description takes fifty bytes for each.
const MOST_DRAWN: usize = 500_000;
/// Cells of the rows of one answer.
pub const MOST_CELLS: usize = 2_000_000;

/// Takes what a command yields.
pub struct Outbox {
    kept: Mutex<Kept>,
    /// Bytes were taken, or nobody takes any more.
    room: Condvar,
    stop: AtomicBool,
    /// Whether rows go out as they come, and not only in the object.
    streams: bool,
    /// Where background work waits while other work runs.
    behind: Option<Arc<Queue>>,
    program: PathBuf,
}

#[derive(Default)]
struct Kept {
    /// Lines.
    text: Vec<u8>,
    /// The rows of a line that is still open.
    rows: Vec<u8>,
    /// Columns whose line waits for their units.
    columns: Option<Vec<String>>,
    /// The object, where it does not go out as a line.
    object: Vec<u8>,
    /// Rows and their cells so far.
    count: (usize, usize),
    /// Whether there were more rows than an answer may have.
    exceeded: bool,
    /// When it was last told how far the command is.
    told: Option<Instant>,
    waker: Option<Waker>,
    /// Whether it is called at the end alone, as there is something to take already.
    waits_for_end: bool,
    ended: Option<Result<Ending, Failure>>,
}

impl Kept {
    fn line(&mut self, value: &Value) {
        self.close();
        serde_json::to_writer(&mut self.text, value).expect("a value can be written");
        self.text.push(b'\n');
    }

    /// Writes the line of the columns, with their units where these are known.
    fn begin(&mut self, units: Option<&[String]>) {
        if let Some(columns) = self.columns.take() {
            let unit = |i: usize| {
                units
                    .and_then(|units| units.get(i))
                    .filter(|unit| is_unit(unit))
            };
            let units: Vec<_> = (0..columns.len()).map(unit).collect();
            self.line(&json!({"columns": columns, "units": units}));
        }
    }

    /// Ends the line of rows.
    fn close(&mut self) {
        if !self.rows.is_empty() {
            self.text.extend_from_slice(b"{\"rows\":[");
            self.text.append(&mut self.rows);
            self.text.extend_from_slice(b"]}\n");
        }
    }

    fn length(&self) -> usize {
        self.text.len() + self.rows.len()
    }
}

fn is_unit(unit: &str) -> bool {
    !["", "1"].contains(&unit)
}

impl Outbox {
    /// An empty one; background work waits in the queue while other work runs.
    pub fn new(streams: bool, behind: Option<Arc<Queue>>) -> Self {
        Outbox {
            kept: Mutex::default(),
            room: Condvar::new(),
            stop: AtomicBool::new(false),
            streams,
            behind,
            program: std::env::current_exe().unwrap_or_default(),
        }
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes what is kept, and wakes who waits for it.
    fn change(&self, change: impl FnOnce(&mut Kept)) {
        let mut kept = self.kept();
        change(&mut kept);
        let waits = kept.ended.is_none() && kept.waits_for_end;
        if let Some(waker) = kept.waker.take_if(|_| !waits) {
            waker.wake();
        }
    }

    /// Whether it is background work.
    pub fn is_background(&self) -> bool {
        self.behind.is_some()
    }

    /// Whether nobody waits for it any more, or it has more rows than are allowed.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Nobody waits for it any more.
    pub fn leave(&self) {
        self.stop.store(true, Ordering::Relaxed);
        // Who looks for room just now has seen this, or waits already.
        drop(self.kept());
        self.room.notify_all();
        if let Some(queue) = &self.behind {
            queue.changed();
        }
    }

    /// The command has ended.
    pub fn end(&self, ended: Result<Ending, Failure>) {
        self.change(|kept| {
            if self.streams {
                kept.begin(None);
                let last = match &ended {
                    Ok(ending) => json!({"ended": name(*ending)}),
                    Err(failure) => json!({"error": object(failure)}),
                };
                kept.line(&last);
            }
            kept.ended = Some(ended);
        });
    }

    /// All bytes so far, and whether they are the last ones.
    pub fn take(&self) -> (Vec<u8>, bool) {
        let mut kept = self.kept();
        kept.close();
        let text = std::mem::take(&mut kept.text);
        let ended = kept.ended.is_some();
        drop(kept);
        self.room.notify_all();
        (text, ended)
    }

    /// Whether there are bytes to take, and whether the command has ended; the waker is called when one of these comes to be.
    pub fn is_ready(&self, waker: &Waker) -> (bool, bool) {
        let mut kept = self.kept();
        let (some, ended) = (kept.length() > 0, kept.ended.is_some());
        kept.waker = (!ended).then(|| waker.clone());
        kept.waits_for_end = some;
        (some, ended)
    }

    /// The object and how the command ended, when it has.
    pub fn whole(&self, waker: &Waker) -> Option<Whole> {
        let mut kept = self.kept();
        let Some(ended) = kept.ended.clone() else {
            kept.waker = Some(waker.clone());
            kept.waits_for_end = true;
            return None;
        };
        Some(Whole {
            object: std::mem::take(&mut kept.object),
            exceeded: kept.exceeded,
            ended,
        })
    }

    /// Waits until there is room, and background work until no other runs.
    fn wait(&self) {
        if let Some(queue) = &self.behind {
            queue.wait_for_others(&self.stop);
        }
        let full = |kept: &mut Kept| kept.length() > ROOM && !self.is_stopped();
        let waited = self.room.wait_while(self.kept(), full);
        drop(waited);
    }
}

/// A command that has ended, of whom the object alone was asked.
pub struct Whole {
    /// The object as `--format json` prints it; empty where there is none.
    pub object: Vec<u8>,
    /// Whether it was stopped at too many rows.
    pub exceeded: bool,
    /// How it ended.
    pub ended: Result<Ending, Failure>,
}

impl Outlet for Outbox {
    fn columns(&self, names: &[String]) {
        if self.streams {
            self.change(|kept| {
                kept.begin(None);
                kept.columns = Some(names.to_vec());
            });
        }
    }

    fn units(&self, names: &[String]) {
        if self.streams {
            self.change(|kept| kept.begin(Some(names)));
        }
    }

    fn row(&self, cells: &[Cell]) {
        if self.is_stopped() {
            return;
        }
        self.wait();
        self.change(|kept| {
            let (rows, all) = kept.count;
            if rows >= MOST_ROWS || all + cells.len() > MOST_CELLS {
                if !std::mem::replace(&mut kept.exceeded, true) && self.streams {
                    kept.line(&json!({"say": too_many_rows()}));
                }
                self.stop.store(true, Ordering::Relaxed);
                return;
            }
            kept.count = (rows + 1, all + cells.len());
            if self.streams {
                kept.begin(None);
                write_row(&mut kept.rows, cells);
            }
        });
    }

    fn draws(&self, numbers: usize) {
        if numbers > MOST_DRAWN && !self.is_stopped() {
            self.change(|kept| {
                kept.exceeded = true;
                if self.streams {
                    kept.line(&json!({"say": "stopped: the picture has as many points as one answer may have; ask for a shorter run"}));
                }
            });
            self.stop.store(true, Ordering::Relaxed);
        }
    }

    fn special(&self, columns: &[String], rows: Vec<Vec<Cell>>) {
        if self.streams {
            let mut list = Vec::new();
            for row in &rows {
                write_row(&mut list, row);
            }
            let columns = json!(columns).to_string();
            self.change(|kept| {
                kept.begin(None);
                kept.close();
                kept.text.extend_from_slice(b"{\"special\":{\"columns\":");
                kept.text.extend_from_slice(columns.as_bytes());
                kept.text.extend_from_slice(b",\"rows\":[");
                kept.text.append(&mut list);
                kept.text.extend_from_slice(b"]}}\n");
            });
        }
    }

    fn keeps_all(&self) -> bool {
        !self.streams
    }

    fn object(&self, json: &[u8]) {
        self.change(|kept| {
            if self.streams {
                kept.begin(None);
                kept.close();
                kept.text.extend_from_slice(b"{\"object\":");
                kept.text.extend_from_slice(json.trim_ascii());
                kept.text.extend_from_slice(b"}\n");
            } else {
                kept.object = json.to_vec();
            }
        });
    }

    fn picture(&self, drawing: &Drawing) {
        if self.streams {
            let line = match drawing.describe() {
                Ok(description) => json!({ "picture": description }),
                Err(error) => json!({"say": error.to_string()}),
            };
            self.change(|kept| {
                kept.begin(None);
                kept.line(&line);
            });
        }
    }

    fn say(&self, text: &str) {
        if self.streams && !self.is_stopped() {
            self.wait();
            self.change(|kept| kept.line(&json!({"say": text})));
        }
    }

    fn reached(&self, fraction: f64) {
        if let Some(queue) = &self.behind {
            queue.wait_for_others(&self.stop);
        }
        if !self.streams {
            return;
        }
        self.change(|kept| {
            let long = kept.told.is_none_or(|told| told.elapsed() >= BETWEEN);
            if long && fraction.is_finite() {
                kept.told = Some(Instant::now());
                kept.line(&json!({"reached": fraction}));
            }
        });
    }

    fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    fn program(&self) -> PathBuf {
        self.program.clone()
    }
}

/// The sentence on rows that are left out.
pub fn too_many_rows() -> String {
    format!(
        "stopped at {MOST_ROWS} rows or {MOST_CELLS} numbers, the most that one answer has; ask for a shorter run or fewer rows (`points`)"
    )
}

/// A word for how a command ended.
fn name(ending: Ending) -> &'static str {
    match ending {
        Ending::Done => "done",
        Ending::Undecided => "undecided",
        Ending::Stuck => "stuck",
        Ending::Interrupted => "interrupted",
    }
}

/// A failure as an object.
pub fn object(failure: &Failure) -> Value {
    json!({"kind": failure.kind, "field": failure.field, "message": failure.words})
}

/// Adds a row to a list of rows.
fn write_row(list: &mut Vec<u8>, cells: &[Cell]) {
    if !list.is_empty() {
        list.push(b',');
    }
    list.push(b'[');
    for (i, cell) in cells.iter().enumerate() {
        if i > 0 {
            list.push(b',');
        }
        match cell {
            Cell::Number(x) if x.is_finite() => list.extend_from_slice(shortest(*x).as_bytes()),
            Cell::Number(_) | Cell::Missing => list.extend_from_slice(b"null"),
            // Counts come as words; no word is made of digits alone.
            Cell::Text(text) if is_count(text) => list.extend_from_slice(text.as_bytes()),
            Cell::Text(text) => {
                serde_json::to_writer(&mut *list, text).expect("a text can be written");
            }
        }
    }
    list.push(b']');
}

fn is_count(text: &str) -> bool {
    let digits = text.bytes().all(|byte| byte.is_ascii_digit());
    digits && !text.is_empty() && text.len() < 16 && (text == "0" || !text.starts_with('0'))
}
