//! The page of `twinslip explore` in a notebook: its parts, and answers to its questions.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use twinslip_cli::Failure;
use twinslip_cli::explore::{self, Engine};

/// Nobody waits longer at once.
const LONGEST: Duration = Duration::from_secs(3600);

/// The engine of this process: all its widgets share the processor.
fn engine() -> Arc<Engine> {
    /// With the process that it is of: another one that was forked from it has none of its threads.
    static ENGINE: Mutex<Option<(u32, Arc<Engine>)>> = Mutex::new(None);
    let mut kept = ENGINE.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    match &*kept {
        Some((own, engine)) if *own == process => Arc::clone(engine),
        _ => {
            let engine = Arc::new(Engine::default());
            *kept = Some((process, Arc::clone(&engine)));
            engine
        }
    }
}

/// A question of the page, which is answered on a thread of its own as soon as there is a place.
///
/// Parameters
/// ----------
/// command : str
///     One that the page may ask for.
/// options : str
///     Its options, a JSON object.
/// background : bool
///     Whether it waits while other questions are answered.
#[pyclass(frozen, module = "twinslip._core")]
pub struct Asked(explore::Asked);

#[pymethods]
impl Asked {
    #[new]
    fn new(command: &str, options: &str, background: bool) -> Self {
        Asked(engine().ask(command, options, background))
    }

    /// Waits for lines of the answer, at most so many seconds; none if none came.
    fn lines(&self, py: Python<'_>, seconds: f64) -> Vec<String> {
        let patience = Duration::try_from_secs_f64(seconds)
            .unwrap_or_default()
            .min(LONGEST);
        py.detach(|| self.0.lines(patience))
    }

    /// Stops it; no lines come any more.
    fn stop(&self) {
        self.0.stop();
    }

    /// Whether the last line was taken, or it was stopped.
    #[getter]
    fn ended(&self) -> bool {
        self.0.ended()
    }
}

/// Why there is nothing to begin with: as `Run.failure` has it.
type Refused = (&'static str, Option<String>, String);

/// What the page begins with for a model, as a text in JSON, or why there is no such model.
#[pyfunction]
pub fn explore_begin(py: Python<'_>, words: Vec<String>) -> (String, Option<Refused>) {
    match py.detach(|| explore::widget_begin(&words)) {
        Ok(begin) => (begin, None),
        Err(error) => {
            let Failure { kind, field, words } = Failure::of(&error);
            (String::new(), Some((kind, field, words)))
        }
    }
}

/// The script of the page, a module that exports `render`.
#[pyfunction]
pub fn explore_script() -> PyResult<String> {
    explore::widget_module().map_err(PyValueError::new_err)
}

/// The styles of the page.
#[pyfunction]
pub fn explore_style() -> String {
    explore::widget_style()
}
