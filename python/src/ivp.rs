//! Initial value problems in the terms of SciPy.

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use twinslip::Error;
use twinslip::integrate::Control;
use twinslip_cli::{Failure, parsed};
use twinslip_tasks::scene::{
    Command, Halt, IntegrateOptions, IvpAsked, IvpError, IvpEvent, IvpFormula, IvpOutcome,
    IvpParts, IvpPlan, IvpSolution,
};

/// Between two looks at whether Ctrl-C was pressed.
const LOOK: Duration = Duration::from_millis(20);
/// Steps between two looks at the clock.
const STEPS: u32 = 16;

type Array<'py> = Bound<'py, PyArray1<f64>>;

/// An event: the function, or its formula as text; its direction, after how many it ends the run, and the side on which it begins.
type Event = (Asked, f64, Option<usize>, Option<f64>);

/// What an event is of, as it is given.
#[derive(FromPyObject)]
pub enum Asked {
    Formula(String),
    Function(Py<PyAny>),
}

/// The same, read.
enum Source {
    Formula(IvpFormula),
    Function(Py<PyAny>),
}

/// What a run came to.
#[pyclass(frozen, module = "twinslip._core")]
pub struct IvpRun {
    outcome: IvpOutcome,
    dimension: usize,
}

#[pymethods]
impl IvpRun {
    /// The times of the rows.
    fn t<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.outcome.t.clone().into_pyarray(py)
    }

    /// The values, those at the first time first.
    fn y<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.outcome.y.clone().into_pyarray(py)
    }

    /// For each event its times.
    fn t_events<'py>(&self, py: Python<'py>) -> Vec<Array<'py>> {
        let all = self.outcome.t_events.iter();
        all.map(|times| times.clone().into_pyarray(py)).collect()
    }

    /// For each event the values at its times.
    fn y_events<'py>(&self, py: Python<'py>) -> Vec<Array<'py>> {
        let all = self.outcome.y_events.iter();
        all.map(|values| values.clone().into_pyarray(py)).collect()
    }

    /// For each event whether not all of its zeros are isolated, though it is a formula.
    fn undecided(&self) -> Vec<bool> {
        self.outcome.undecided.clone()
    }

    /// The solution as a function of time, where it was asked for.
    fn solution(&self) -> Option<Solution> {
        self.outcome.solution.clone().map(Solution)
    }

    /// So many values at a time.
    #[getter]
    fn dimension(&self) -> usize {
        self.dimension
    }

    /// 0, 1 or -1, as in SciPy.
    #[getter]
    fn status(&self) -> i32 {
        self.outcome.status
    }

    /// Why it went no further.
    #[getter]
    fn failure(&self) -> Option<String> {
        self.outcome.failure.as_ref().map(Error::to_string)
    }

    /// Evaluations of f, of its Jacobian, and factorisations.
    #[getter]
    fn work(&self) -> (usize, usize, usize) {
        let work = &self.outcome.work;
        (work.rhs, work.jacobians, work.factorisations)
    }
}

/// A solution as a function of time.
#[pyclass(frozen, module = "twinslip._core", skip_from_py_object)]
#[derive(Clone)]
pub struct Solution(IvpSolution);

/// Its numbers: chart, times, pieces, coefficients.
type Parts<'py> = (Array<'py>, Array<'py>, Array<'py>, Array<'py>);

#[pymethods]
impl Solution {
    /// From the numbers of `parts`.
    #[new]
    fn new(
        chart: PyReadonlyArray1<'_, f64>,
        times: PyReadonlyArray1<'_, f64>,
        pieces: PyReadonlyArray1<'_, f64>,
        coefficients: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Self> {
        let parts = IvpParts {
            chart: chart.as_slice()?.to_vec(),
            times: times.as_slice()?.to_vec(),
            pieces: pieces.as_slice()?.to_vec(),
            coefficients: coefficients.as_slice()?.to_vec(),
        };
        IvpSolution::from_parts(parts)
            .map(Solution)
            .map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// The values at these times, those at the first one first.
    fn at<'py>(&self, py: Python<'py>, times: Vec<f64>) -> Array<'py> {
        py.detach(|| self.0.fill(&times)).into_pyarray(py)
    }

    /// The times at which steps begin and end.
    fn times<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.0.times().to_vec().into_pyarray(py)
    }

    /// So many values at a time.
    #[getter]
    fn dimension(&self) -> usize {
        self.0.dimension()
    }

    /// As plain numbers, from which it can be made again.
    fn parts<'py>(&self, py: Python<'py>) -> Parts<'py> {
        let IvpParts {
            chart,
            times,
            pieces,
            coefficients,
        } = self.0.to_parts();
        (
            chart.into_pyarray(py),
            times.into_pyarray(py),
            pieces.into_pyarray(py),
            coefficients.into_pyarray(py),
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Parts<'py>)> {
        let class = py.get_type::<Solution>().into_any();
        Ok((class, self.parts(py)))
    }
}

/// Why there is no outcome: of the input, a sentence with the field to blame; or what a function of an event raised.
type Refused = (Option<String>, String);

/// The run, or why there is none; and the exception that ended it from outside.
type Solved = (Option<IvpRun>, Option<Refused>, Option<Py<PyAny>>);

/// Solves an initial value problem; the words are those of `integrate`, which say what it is of and how it is solved. Gives the run, or why
/// the input is refused; and an exception that ended the run from outside.
#[pyfunction]
#[pyo3(signature = (words, span, start, times, events, dense_output))]
pub fn solve_ivp(
    py: Python<'_>,
    words: Vec<String>,
    span: (f64, f64),
    start: Vec<f64>,
    times: Option<Vec<f64>>,
    events: Vec<Event>,
    dense_output: bool,
) -> PyResult<Solved> {
    let refused = |error: Error| {
        Ok((
            None,
            Some((Failure::field(&error), error.to_string())),
            None,
        ))
    };
    let options = match options(words) {
        Ok(options) => options,
        Err(error) => return refused(error),
    };
    let plan = match IvpPlan::new(&options.model, &options.numerics, span, &start) {
        Ok(plan) => plan,
        Err(error) => return refused(error),
    };
    let mut asked = Vec::new();
    for (of, direction, terminal, side) in events {
        let source = match of {
            Asked::Function(function) => Source::Function(function),
            Asked::Formula(text) => match IvpFormula::parse(&text, plan.dimension()) {
                Ok(formula) => Source::Formula(formula),
                Err(error) => return refused(error),
            },
        };
        asked.push((source, direction, terminal, side));
    }
    // Ctrl-C comes between steps, or while a function of an event runs.
    let raised: Mutex<Option<PyErr>> = Mutex::default();
    let stop = |error: PyErr| *raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
    let solved = py.detach(|| {
        let mut clock = Clock::new();
        let mut reached = |_: f64| match clock.look() {
            Ok(()) => Control::Continue,
            Err(error) => {
                stop(error);
                Control::Stop
            }
        };
        let events = asked
            .into_iter()
            .map(|(source, direction, terminal, side)| IvpEvent {
                direction,
                terminal,
                side,
                ..match source {
                    Source::Formula(formula) => IvpEvent::of(formula),
                    Source::Function(function) => IvpEvent::new(move |t, y| {
                        called(&function, t, y).map_err(|error| match interrupts(&error) {
                            true => {
                                stop(error);
                                Halt::Stop
                            }
                            false => Halt::Failed(error),
                        })
                    }),
                }
            });
        plan.solve(IvpAsked {
            times: times.as_deref(),
            events: events.collect(),
            dense_output,
            reached: Some(&mut reached),
        })
    });
    let outcome = match solved {
        Ok(outcome) => outcome,
        Err(IvpError::Own(error)) => return refused(error),
        Err(IvpError::Event(error)) => return Err(error),
    };
    let raised = raised.into_inner().unwrap_or_else(PoisonError::into_inner);
    let raised = raised.map(|error| error.into_value(py).into_any());
    let dimension = plan.dimension();
    Ok((Some(IvpRun { outcome, dimension }), None, raised))
}

/// The options of these words; those of the last call are kept, as calls often differ in their starts alone.
fn options(words: Vec<String>) -> Result<Arc<IntegrateOptions>, Error> {
    type Read = (Vec<String>, Arc<IntegrateOptions>);
    static LAST: Mutex<Option<Read>> = Mutex::new(None);
    let last = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((known, options)) = &*last()
        && *known == words
    {
        return Ok(Arc::clone(options));
    }
    let Command::Integrate(options) = parsed(&words)? else {
        return Err(Error::Input("not the words of integrate".into()));
    };
    let options = Arc::new(*options);
    *last() = Some((words, Arc::clone(&options)));
    Ok(options)
}

fn interrupts(error: &PyErr) -> bool {
    Python::attach(|py| error.is_instance_of::<PyKeyboardInterrupt>(py))
}

/// An event's function at a time.
fn called(function: &Py<PyAny>, t: f64, y: &[f64]) -> PyResult<f64> {
    Python::attach(|py| {
        let y = y.to_vec().into_pyarray(py);
        function.call1(py, (t, y))?.extract(py)
    })
}

/// When to look at what has happened to Python.
struct Clock {
    steps: u32,
    last: Instant,
}

impl Clock {
    fn new() -> Self {
        Clock {
            steps: 0,
            last: Instant::now(),
        }
    }

    fn look(&mut self) -> PyResult<()> {
        self.steps += 1;
        if !self.steps.is_multiple_of(STEPS) || self.last.elapsed() < LOOK {
            return Ok(());
        }
        self.last = Instant::now();
        Python::attach(|py| py.check_signals())
    }
}
