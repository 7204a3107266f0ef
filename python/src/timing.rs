//! How long a command takes without Python.

use crate::run::{Shared, file};
use crate::threads::STACK;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;
use std::thread;
use std::time::Instant;
use twinslip_cli::{Failure, run_into};

/// The seconds of the fastest of so many runs of a command, which keeps its rows as `Run` does, but starts no thread for each and hands
/// nothing to Python.
#[pyfunction]
pub fn timed(py: Python<'_>, words: Vec<String>, repeats: usize) -> PyResult<f64> {
    let program = file(py)?.clone();
    let work = move || {
        let mut least = f64::INFINITY;
        for _ in 0..repeats {
            let shared = Arc::new(Shared::new(program.clone()));
            let begin = Instant::now();
            run_into(&words, shared)?;
            least = least.min(begin.elapsed().as_secs_f64());
        }
        Ok(least)
    };
    let thread = thread::Builder::new().stack_size(STACK).spawn(work)?;
    let panicked = |panic: Box<dyn std::any::Any + Send>| Failure::of_panic(&*panic).words;
    let ended = py.detach(|| match thread.join() {
        Ok(ended) => ended.map_err(|error: twinslip::Error| error.to_string()),
        Err(panic) => Err(panicked(panic)),
    });
    ended.map_err(PyValueError::new_err)
}
