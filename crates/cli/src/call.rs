//! What a command is called by: a terminal, with files and streams for what is computed, or another program, which keeps it in its memory.

use super::interrupt;
use super::progress::Progress;
use super::words::flagged;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use twinslip_output::plot::Drawing;
use twinslip_output::{Cell, RowWriter};

/// Takes what a command computes, as it comes, in place of files, standard output and standard error.
pub trait Outlet: Send + Sync {
    /// The names of the columns of all rows that follow; error budgets have columns of their own, as in CSV.
    fn columns(&self, names: &[String]);
    /// The units of these columns, by their names.
    fn units(&self, _names: &[String]) {}
    /// A row.
    fn row(&self, cells: &[Cell]);
    /// So many numbers are kept for the picture by now.
    fn draws(&self, _numbers: usize) {}
    /// All special points, by the names of the columns that they have in CSV.
    fn special(&self, _columns: &[String], _rows: Vec<Vec<Cell>>) {}
    /// Whether it takes rows of every command, also those that are in the object, and an object with all of them.
    fn keeps_all(&self) -> bool {
        false
    }
    /// The object as `--format json` has it, without the rows that were handed on.
    fn object(&self, json: &[u8]);
    /// The picture, where one is asked for.
    fn picture(&self, drawing: &Drawing);
    /// A message.
    fn say(&self, text: &str);
    /// The computation has come to this fraction, where that is known.
    fn reached(&self, fraction: f64);
    /// Set when the computation is to end; rows so far stay.
    fn stop(&self) -> &AtomicBool;
    /// The file of the program that computes: what another one has left is not trusted.
    fn program(&self) -> PathBuf;
}

/// A call of a command.
pub struct Call {
    /// The command line.
    pub words: Vec<String>,
    /// Where all goes, if not to files and streams.
    pub outlet: Option<Arc<dyn Outlet>>,
}

impl Call {
    /// A message, with flags for the options that it names, where nobody has asked for silence.
    pub fn say(&self, text: impl std::fmt::Display) {
        match &self.outlet {
            Some(outlet) => outlet.say(&text.to_string()),
            None => super::say(text),
        }
    }

    /// A message or a note that is kept, with flags for the options that it names where it is read at a terminal.
    pub fn told(&self, text: &str) -> String {
        match self.outlet {
            Some(_) => text.to_owned(),
            None => flagged(text),
        }
    }

    /// Progress on standard error, or reported to the program that called.
    pub fn progress(&self, quiet: bool) -> Progress {
        match &self.outlet {
            Some(outlet) => Progress::handed_on(outlet.clone()),
            None => Progress::new(quiet, self.words.get(1).map_or("", String::as_str)),
        }
    }

    /// From now on somebody asks [`Call::stops`] after every step.
    pub fn watch(&self) {
        if self.outlet.is_none() {
            interrupt::watch();
        }
    }

    /// Nobody asks any more.
    pub fn unwatch(&self) {
        if self.outlet.is_none() {
            interrupt::unwatch();
        }
    }

    /// What was found is in memory alone: an interruption waits for the step that is being computed.
    pub fn holds(&self) {
        if self.outlet.is_none() {
            interrupt::holds();
        }
    }

    /// Whether the computation is to end.
    pub fn stops(&self) -> bool {
        match &self.outlet {
            Some(outlet) => outlet.stop().load(Ordering::Relaxed),
            None => interrupt::asked(),
        }
    }

    /// What is set then, for those who ask it themselves.
    pub fn flag(&self) -> &AtomicBool {
        match &self.outlet {
            Some(outlet) => outlet.stop(),
            None => interrupt::flag(),
        }
    }

    /// What stays of a run that is interrupted, in words.
    pub fn keeps(&self, what: impl Into<String>) {
        if self.outlet.is_none() {
            interrupt::keeps(what);
        }
    }

    /// The file of the program that computes.
    pub fn program(&self) -> io::Result<PathBuf> {
        match &self.outlet {
            Some(outlet) => Ok(outlet.program()),
            None => std::env::current_exe(),
        }
    }

    /// So many numbers are kept for the picture by now.
    pub fn draws(&self, numbers: usize) {
        if let Some(outlet) = &self.outlet {
            outlet.draws(numbers);
        }
    }

    /// A writer of rows to the outlet, if there is one.
    pub fn rows(&self, columns: &[String], units: &[String]) -> Option<Box<dyn RowWriter>> {
        let outlet = self.outlet.clone()?;
        outlet.columns(columns);
        outlet.units(units);
        Some(Box::new(HandedOn(outlet)))
    }
}

/// Rows on their way to an outlet.
struct HandedOn(Arc<dyn Outlet>);

impl RowWriter for HandedOn {
    fn row(&mut self, cells: &[Cell]) -> io::Result<()> {
        self.0.row(cells);
        Ok(())
    }
}
