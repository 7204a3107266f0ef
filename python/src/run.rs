//! A command that runs on a thread of its own, and what it has come to.

use crate::table::{Column, Table, Values};
use crate::threads;
use numpy::IntoPyArray;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyDict, PyList};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use twinslip::Error;
use twinslip_cli::{Ending, Failure, Outlet, run_into};
use twinslip_output::Cell;
use twinslip_output::plot::Drawing;

/// Nobody waits longer at once.
const LONGEST: Duration = Duration::from_secs(3600);

/// What a command has yielded so far.
#[derive(Default)]
struct Kept {
    table: Table,
    object: Vec<u8>,
    pictures: Vec<Arc<Drawing>>,
    messages: Vec<String>,
    ended: Option<Result<Ending, Failure>>,
}

/// What the thread of a command and those who wait for it share.
#[derive(Default)]
pub struct Shared {
    kept: Mutex<Kept>,
    changed: Condvar,
    stop: AtomicBool,
    /// The bits of the fraction that is done.
    fraction: AtomicU64,
    /// Whether somebody waits for rows, and not only for the end.
    watched: AtomicBool,
    /// The file of this module.
    program: PathBuf,
}

impl Shared {
    /// Nothing yet; the file is that of this module.
    pub fn new(program: PathBuf) -> Self {
        Shared {
            program,
            ..Shared::default()
        }
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits without the lock of the interpreter for this or the end, at most so many seconds; how many rows there are, and whether it
    /// has ended.
    fn wait(
        &self,
        py: Python<'_>,
        seconds: f64,
        come: impl Fn(&Kept) -> bool + Sync,
    ) -> (usize, bool) {
        py.detach(|| {
            let patience = Duration::try_from_secs_f64(seconds)
                .unwrap_or_default()
                .min(LONGEST);
            let waiting = |kept: &mut Kept| kept.ended.is_none() && !come(kept);
            let waited = self
                .changed
                .wait_timeout_while(self.kept(), patience, waiting);
            let (kept, _) = waited.unwrap_or_else(PoisonError::into_inner);
            (kept.table.rows, kept.ended.is_some())
        })
    }
}

impl Outlet for Shared {
    fn columns(&self, names: &[String]) {
        self.kept().table = Table::new(names);
    }

    fn row(&self, cells: &[Cell]) {
        self.kept().table.push(cells);
        if self.watched.load(Ordering::Relaxed) {
            self.changed.notify_all();
        }
    }

    fn object(&self, json: &[u8]) {
        self.kept().object = json.to_vec();
    }

    fn picture(&self, drawing: &Drawing) {
        self.kept().pictures.push(Arc::new(drawing.clone()));
    }

    fn say(&self, text: &str) {
        self.kept().messages.push(text.to_owned());
    }

    fn reached(&self, fraction: f64) {
        self.fraction.store(fraction.to_bits(), Ordering::Relaxed);
    }

    fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    fn program(&self) -> PathBuf {
        self.program.clone()
    }
}

/// The file of this module.
pub fn file(py: Python<'_>) -> PyResult<&PathBuf> {
    static FILE: PyOnceLock<PathBuf> = PyOnceLock::new();
    FILE.get_or_try_init(py, || {
        py.import("twinslip._core")?.getattr("__file__")?.extract()
    })
}

/// The names of columns, and the cells of rows in their order.
type NamedRows<'py> = (Vec<String>, Vec<Vec<Bound<'py, PyAny>>>);

/// A command that runs, or has run.
///
/// Parameters
/// ----------
/// words : list of str
///     The command line without the name of the program.
#[pyclass(frozen, module = "twinslip._core")]
pub struct Run {
    shared: Arc<Shared>,
}

#[pymethods]
impl Run {
    /// Begins at once, on a thread of its own.
    #[new]
    fn new(py: Python<'_>, words: Vec<String>) -> PyResult<Self> {
        let shared = Arc::new(Shared::new(file(py)?.clone()));
        let own = Arc::clone(&shared);
        let work = move || {
            let ended = catch_unwind(AssertUnwindSafe(|| run_into(&words, own.clone())));
            let ended = match ended {
                Ok(ended) => ended.map_err(|error| Failure::of(&error)),
                Err(panic) => Err(Failure::of_panic(&*panic)),
            };
            own.kept().ended = Some(ended);
            own.changed.notify_all();
        };
        threads::run(work)?;
        Ok(Run { shared })
    }

    /// Waits for its end, at most so many seconds; whether it has ended.
    fn wait(&self, py: Python<'_>, seconds: f64) -> bool {
        self.shared.wait(py, seconds, |_| false).1
    }

    /// Waits for a row after the first so many, or the end, at most so many seconds; how many rows there are, and whether it has
    /// ended.
    fn wait_for_rows(&self, py: Python<'_>, known: usize, seconds: f64) -> (usize, bool) {
        self.shared.watched.store(true, Ordering::Relaxed);
        self.shared
            .wait(py, seconds, |kept| kept.table.rows > known)
    }

    /// Asks it to end; rows so far stay.
    fn stop(&self) {
        self.shared.stop.store(true, Ordering::Relaxed);
    }

    /// The fraction that is done, where that is known; else 0.
    fn fraction(&self) -> f64 {
        f64::from_bits(self.shared.fraction.load(Ordering::Relaxed))
    }

    /// What it said.
    fn messages(&self) -> Vec<String> {
        self.shared.kept().messages.clone()
    }

    /// How it ended: `done`, `undecided`, `stuck` or `interrupted`; None while it runs or where it failed.
    fn ending(&self) -> Option<&'static str> {
        let kept = self.shared.kept();
        let ended = kept.ended.as_ref()?.as_ref().ok()?;
        Some(match ended {
            Ending::Done => "done",
            Ending::Undecided => "undecided",
            Ending::Stuck => "stuck",
            Ending::Interrupted => "interrupted",
        })
    }

    /// Why it failed, if it did: `input`, `file` or `numerical`; the field to blame, where it is known; and a sentence.
    fn failure(&self) -> Option<(&'static str, Option<String>, String)> {
        let kept = self.shared.kept();
        let failure = kept.ended.as_ref()?.as_ref().err()?;
        let Failure { kind, field, words } = failure.clone();
        // A defect is told as what keeps a result from being whole.
        let kind = if kind == "defect" { "numerical" } else { kind };
        Some((kind, field, words))
    }

    /// The object of `--format json`, without rows that are columns; empty where there is none.
    fn object<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.shared.kept().object)
    }

    /// All rows so far as arrays by the names of their columns, each with a mask of what is missing or None. The rows of a run that has
    /// ended are handed over, not copied: they can be taken once.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let table = {
            let mut kept = self.shared.kept();
            match kept.ended {
                Some(_) => std::mem::take(&mut kept.table),
                None => kept.table.clone(),
            }
        };
        let all = PyDict::new(py);
        for column in table.columns {
            let rows = column.len();
            let Column {
                name,
                values,
                mut missing,
            } = column;
            let values = match values {
                Values::Missing(count) => vec![0.0; count].into_pyarray(py).into_any(),
                Values::Numbers(numbers) => numbers.into_pyarray(py).into_any(),
                Values::Counts(counts) => counts.into_pyarray(py).into_any(),
                Values::Words(words) => PyList::new(py, words)?.into_any(),
            };
            let mask = (!missing.is_empty()).then(|| {
                missing.resize(rows, false);
                missing.into_pyarray(py)
            });
            all.set_item(name, (values, mask))?;
        }
        Ok(all)
    }

    /// The rows from one on to another one, as lists of cells in the order of the columns; None where a cell is missing.
    fn rows<'py>(&self, py: Python<'py>, first: usize, end: usize) -> PyResult<NamedRows<'py>> {
        let kept = self.shared.kept();
        let columns = &kept.table.columns;
        let names = columns.iter().map(|column| column.name.clone()).collect();
        let cell = |column: &Column, row: usize| {
            let missing = column.missing.get(row).copied().unwrap_or(false);
            match &column.values {
                _ if missing => Ok(py.None().into_bound(py)),
                Values::Missing(_) => Ok(py.None().into_bound(py)),
                Values::Numbers(all) => all[row].into_bound_py_any(py),
                Values::Counts(all) => all[row].into_bound_py_any(py),
                Values::Words(all) => all[row].as_str().into_bound_py_any(py),
            }
        };
        let rows = (first..end.min(kept.table.rows))
            .map(|row| columns.iter().map(|column| cell(column, row)).collect());
        Ok((names, rows.collect::<PyResult<_>>()?))
    }

    /// The pictures.
    fn pictures(&self) -> Vec<Picture> {
        let kept = self.shared.kept();
        let pictures = kept.pictures.iter();
        pictures
            .map(|drawing| Picture(Arc::clone(drawing)))
            .collect()
    }
}

/// Nobody can ask for what it computes any more.
impl Drop for Run {
    fn drop(&mut self) {
        self.stop();
    }
}

/// A picture that can be drawn.
#[pyclass(frozen, module = "twinslip._core")]
pub struct Picture(Arc<Drawing>);

#[pymethods]
impl Picture {
    /// As SVG.
    fn svg(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.0.svg()).map_err(told)
    }

    /// What it shows, as a text in JSON.
    fn describe(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.0.describe().map(|told| told.to_string()))
            .map_err(told)
    }

    /// As PNG.
    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let png = py.detach(|| self.0.png()).map_err(told)?;
        Ok(PyBytes::new(py, &png))
    }
}

fn told(error: Error) -> PyErr {
    pyo3::exceptions::PyValueError::new_err(error.to_string())
}
