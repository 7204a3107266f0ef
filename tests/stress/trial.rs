//! One method on one scene at one tolerance: what came out, and whether it is as good as it has to be.

use super::scene::Scene;
use super::truth::{Rule, Truth, error};
use std::panic::{AssertUnwindSafe, catch_unwind};
use twinslip::error::{Error, Result};
use twinslip::field::{State, VectorField};
use twinslip::integrate::{Choice, Control, Observer, Step, Tolerances};
use twinslip::model::{symmetric, two_interfaces};

/// Bound on the steps of a run, so that none hangs.
pub const MAX_STEPS: usize = 50_000;
/// Rounding in a step, in the units of a relative tolerance: the field's own evaluation loses some digits of sixteen.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// An error larger than this can't be measured by a linear growth of errors.
const LINEAR: f64 = 0.1;
/// The reference is worth nothing where its own uncertainty is more than this part of what is allowed.
const CERTAIN: f64 = 0.1;

/// The time of a singularity may err by this multiple of `conditioning * (tolerance + rounding) * steps`, relative to the time.
const SINGULAR: f64 = 10.0;

/// What a method promises: at the end of a run no more than
/// `factor * conditioning * (tolerance + rounding) * steps`, steps being the accepted ones.
///
/// So 1 is the promise that no step errs by more than its tolerance.
#[derive(Debug, Clone, Copy)]
pub struct Promise {
    pub method: &'static str,
    pub factor: f64,
    /// The least part of the runs at tolerances from 1e-3 to 1e-7 that has an answer: a state, or a singularity where there is
    /// one. A method that refuses everything would keep its factor.
    pub answers: f64,
}

/// The factors; the full run writes the worst measured beside them into `table.md`.
pub const PROMISES: [Promise; 8] = [
    Promise {
        method: "taylor",
        factor: 0.4,
        answers: 0.6,
    },
    Promise {
        method: "auto",
        factor: 1.0,
        answers: 0.6,
    },
    Promise {
        method: "rodas5p",
        factor: 3.0,
        answers: 0.95,
    },
    Promise {
        method: "rodas4",
        factor: 1.0,
        answers: 0.95,
    },
    Promise {
        method: "rosenbrock23",
        factor: 2.0,
        answers: 0.95,
    },
    Promise {
        method: "radau",
        factor: 3.0,
        answers: 0.95,
    },
    Promise {
        method: "cvode-bdf",
        factor: 3.0,
        answers: 0.9,
    },
    Promise {
        method: "cvode-adams",
        factor: 3.0,
        answers: 0.85,
    },
];

/// What this method is held to.
pub fn promised(method: &str) -> Promise {
    let promise = PROMISES.iter().find(|promise| promise.method == method);
    *promise.unwrap_or_else(|| panic!("no factor is stated for {method}"))
}

/// Every method of this build under its name, `auto` included.
pub fn methods() -> Vec<(&'static str, Choice)> {
    let auto = Choice::named("auto").expect("always there");
    let mut all: Vec<_> = Choice::all().into_iter().map(|m| (m.name(), m)).collect();
    if !all.contains(&(auto.name(), auto)) {
        all.insert(1, (auto.name(), auto));
    }
    all
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// In a state whose error is this multiple of `conditioning * (tolerance + rounding) * steps`.
    Measured(f64),
    /// In a finite state, on a scene whose end is not known well enough or is too ill conditioned at this tolerance.
    Unmeasured,
    /// In a typed error of this kind.
    Refused(&'static str),
    /// As it must not.
    Broken(String),
}

/// What is run on a scene.
#[derive(Debug, Clone, Copy)]
pub struct Trial {
    pub method: Choice,
    pub tolerance: f64,
    /// Whether an observer watches each step.
    pub watched: bool,
}

/// Runs trials on a scene whose end is looked up once.
pub fn run(scene: &Scene, trials: &[Trial]) -> (Rule, Vec<Outcome>) {
    let [tau, first, second] = scene.start;
    if scene.dimension == 2 {
        let field = symmetric(scene.law, scene.loading);
        run_in(&*field, &State::<2>::new(tau, first), scene, trials)
    } else {
        let field = two_interfaces(scene.law, scene.loading);
        run_in(&*field, &State::<3>::new(tau, first, second), scene, trials)
    }
}

fn run_in<const N: usize>(
    field: &dyn VectorField<N>,
    start: &State<N>,
    scene: &Scene,
    trials: &[Trial],
) -> (Rule, Vec<Outcome>) {
    let (truth, rule) = Truth::of(field, start, scene);
    let until = truth.until(scene);
    let outcome = |trial: &Trial| one(field, start, until, &truth, trial);
    (rule, trials.iter().map(outcome).collect())
}

fn one<const N: usize>(
    field: &dyn VectorField<N>,
    start: &State<N>,
    until: f64,
    truth: &Truth<N>,
    trial: &Trial,
) -> Outcome {
    let tolerances = Tolerances::equal(trial.tolerance).expect("valid");
    let mut watch = Watch::new(until.signum());
    let ran = catch_unwind(AssertUnwindSafe(|| {
        let method = trial.method.integrator::<N>(tolerances, MAX_STEPS);
        let mut integrator = method.expect("a method with valid tolerances");
        let mut see = |step: &Step<'_, N>| watch.see(step);
        let observer: Option<Observer<'_, N>> = if trial.watched { Some(&mut see) } else { None };
        let ended = integrator.flow(field, (0.0, until), start, observer);
        (ended, integrator.work().steps)
    }));
    if let Some(fault) = watch.fault {
        return Outcome::Broken(fault);
    }
    match ran {
        Err(_) => Outcome::Broken("a panic".into()),
        Ok((_, steps)) if steps > MAX_STEPS => Outcome::Broken(format!("{steps} steps")),
        Ok((Err(error), steps)) => refusal(&error, steps, truth, trial.tolerance),
        Ok((Ok(state), steps)) => classify(&state, steps, truth, trial.tolerance),
    }
}

fn classify<const N: usize>(
    state: &State<N>,
    steps: usize,
    truth: &Truth<N>,
    tolerance: f64,
) -> Outcome {
    if !state.iter().all(|x| x.is_finite()) {
        return Outcome::Broken(format!("the end {state:?}"));
    }
    match truth {
        Truth::Unknown { .. } => Outcome::Unmeasured,
        Truth::Singular { time, .. } => {
            Outcome::Broken(format!("a state beyond the singularity at {time:e}"))
        }
        Truth::End {
            state: end,
            uncertainty,
            conditioning,
            ..
        } => {
            let unit = conditioning * (tolerance + ROUNDING) * steps.max(1) as f64;
            if unit > LINEAR || *uncertainty > CERTAIN * unit {
                return Outcome::Unmeasured;
            }
            Outcome::Measured(error(state, end) / unit)
        }
    }
}

/// The kind of a typed error of an integration; an error that speaks of the input is none, nor is the end of a solution at a
/// time where it does not end.
fn refusal<const N: usize>(
    error: &Error,
    steps: usize,
    truth: &Truth<N>,
    tolerance: f64,
) -> Outcome {
    let (kind, reached) = match *error {
        Error::TooManySteps { .. } => return Outcome::Refused("too many steps"),
        Error::StepTooSmall { t, .. } => ("step too small", t),
        Error::BlowUp { t, .. } => ("blow-up", t),
        Error::TooFast { t, .. } => ("too fast", t),
        Error::NonFinite { t, .. } => ("not finite", t),
        Error::Sundials { .. } => return Outcome::Refused("sundials"),
        ref other => return Outcome::Broken(format!("the error {other:?}")),
    };
    match truth {
        Truth::Singular { time, conditioning } => {
            let apart = (reached - time).abs();
            let unit = conditioning * (tolerance + ROUNDING) * steps.max(1) as f64;
            if unit <= LINEAR && apart > SINGULAR * unit * time.abs() {
                return Outcome::Broken(format!("{kind} at {reached:e}, but singular at {time:e}"));
            }
        }
        Truth::End { .. } if kind == "blow-up" => {
            return Outcome::Broken(format!("a singularity at {reached:e}, where there is none"));
        }
        Truth::End { .. } | Truth::Unknown { .. } => {}
    }
    Outcome::Refused(kind)
}

/// Watches the steps of a run, and takes a note of the first that is not as it must be.
struct Watch {
    /// 1, or -1 back in time.
    direction: f64,
    now: Option<f64>,
    fault: Option<String>,
}

impl Watch {
    fn new(direction: f64) -> Self {
        Watch {
            direction,
            now: None,
            fault: None,
        }
    }

    fn see<const N: usize>(&mut self, step: &Step<'_, N>) -> Result<Control> {
        let finite = |y: &State<N>| y.iter().all(|x| x.is_finite());
        let (t0, t1) = (step.t0, step.t1);
        let ahead = |time: f64| time * self.direction;
        // Within a spike the doubles next to the time may stand still.
        let fault = if ahead(t1 - t0) < 0.0 || ahead(step.length) <= 0.0 {
            Some(format!("a step from {t0:e} to {t1:e}"))
        } else if self.now.is_some_and(|now| now != t0) {
            Some(format!("a step from {t0:e} after one to {:?}", self.now))
        } else if !(finite(step.y0) && finite(step.y1)) {
            Some(format!("the states {:?} and {:?}", step.y0, step.y1))
        } else {
            let times = [0.0, 0.3, 0.7, 1.0].map(|part| part * step.length);
            let bad = times.into_iter().find(|&time| !finite(&step.after(time)));
            bad.map(|time| format!("dense output {:?} at {t0:e} + {time:e}", step.after(time)))
        };
        self.now = Some(t1);
        if self.fault.is_none() {
            self.fault = fault;
        }
        Ok(Control::Continue)
    }
}
