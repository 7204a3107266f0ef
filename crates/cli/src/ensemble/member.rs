//! A command with certain parameters, run in process: all that it yields is kept.

use crate::call::{Call, Outlet};
use crate::{Ending, compute, interrupt, say};
use serde_json::Value;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use twinslip::error::Result;
use twinslip_output::Cell;
use twinslip_output::plot::Drawing;
use twinslip_tasks::scene::Command;

/// What a member has yielded.
#[derive(Debug, Default)]
pub struct Yield {
    /// The columns of its rows, as in CSV.
    pub columns: Vec<String>,
    /// Their units.
    pub units: Vec<String>,
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
    /// The columns of special points.
    pub special_columns: Vec<String>,
    /// The special points.
    pub special: Vec<Vec<Cell>>,
    /// The object with all of it.
    pub object: Value,
    /// The picture, if one is asked for.
    pub picture: Option<Drawing>,
}

impl Yield {
    /// The place of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|own| own == name)
    }

    /// The number of a row in a column of this name; NaN where there is none.
    pub fn number(&self, row: &[Cell], name: &str) -> f64 {
        self.column(name).map_or(f64::NAN, |at| number(&row[at]))
    }

    /// The word of a row in a column of this name; empty where there is none.
    pub fn word<'a>(&self, row: &'a [Cell], name: &str) -> &'a str {
        self.column(name).map_or("", |at| word(&row[at]))
    }
}

/// The number in a cell; NaN where there is none.
pub fn number(cell: &Cell) -> f64 {
    match cell {
        Cell::Number(x) => *x,
        Cell::Text(text) => text.parse().unwrap_or(f64::NAN),
        Cell::Missing => f64::NAN,
    }
}

/// The word in a cell.
pub fn word(cell: &Cell) -> &str {
    match cell {
        Cell::Text(text) => text,
        Cell::Number(_) | Cell::Missing => "",
    }
}

/// Runs a command in the place of one that was called.
///
/// # Errors
/// Those of the command.
pub fn run(command: &Command, call: &Call, speaks: bool) -> Result<(Yield, Ending)> {
    let collector = Arc::new(Collector {
        kept: Mutex::default(),
        parent: call.outlet.clone(),
        speaks,
    });
    let own = Call {
        words: call.words.clone(),
        outlet: Some(collector.clone()),
    };
    let ending = compute(command, &own)?;
    let kept = std::mem::take(&mut *collector.kept());
    Ok((kept, ending))
}

/// Keeps what a member yields.
struct Collector {
    kept: Mutex<Yield>,
    /// Who has called the command, if that is no terminal.
    parent: Option<Arc<dyn Outlet>>,
    /// Whether messages are heard.
    speaks: bool,
}

impl Collector {
    fn kept(&self) -> MutexGuard<'_, Yield> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Outlet for Collector {
    fn columns(&self, names: &[String]) {
        self.kept().columns = names.to_vec();
    }

    fn units(&self, names: &[String]) {
        self.kept().units = names.to_vec();
    }

    fn row(&self, cells: &[Cell]) {
        self.kept().rows.push(cells.to_vec());
    }

    fn special(&self, columns: &[String], rows: Vec<Vec<Cell>>) {
        let mut kept = self.kept();
        kept.special_columns = columns.to_vec();
        kept.special = rows;
    }

    fn keeps_all(&self) -> bool {
        true
    }

    fn object(&self, json: &[u8]) {
        self.kept().object = serde_json::from_slice(json).unwrap_or_default();
    }

    fn picture(&self, drawing: &Drawing) {
        self.kept().picture = Some(drawing.clone());
    }

    fn say(&self, text: &str) {
        match &self.parent {
            _ if !self.speaks => {}
            Some(parent) => parent.say(text),
            None => say(text),
        }
    }

    fn reached(&self, _: f64) {}

    fn stop(&self) -> &AtomicBool {
        match &self.parent {
            Some(parent) => parent.stop(),
            None => interrupt::flag(),
        }
    }

    fn program(&self) -> PathBuf {
        match &self.parent {
            Some(parent) => parent.program(),
            None => std::env::current_exe().unwrap_or_default(),
        }
    }
}
