//! The members of an ensemble: on both sides of the estimate, and drawn.

use super::bands::{Sample, Sides};
use super::draws::normal;
use super::item::Item;
use super::member::{self, Yield};
use crate::Ending;
use crate::call::Call;
use crate::progress::Progress;
use crate::report::Report;
use nalgebra::DVector;
use rayon::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};
use twinslip::error::{Error, Result};
use twinslip_tasks::scene::{Command, EnsemblePlan, FittedParameter};

/// The step of a derivative, relative: its square and the last digits of what is located to 1e-12 over it are both small.
const STEP: f64 = 1e-4;
/// Room for the calls of a member: searches go deep.
const STACK: usize = 64 << 20;

/// Makes things of what a member yields.
pub type Items<'a> = &'a (dyn Fn(&Yield) -> Vec<Item> + Sync);

/// Runs members, counts them and those that fail.
pub struct Members<'a> {
    plan: &'a EnsemblePlan,
    call: &'a Call,
    standing: Mutex<Standing>,
    all: usize,
}

struct Standing {
    progress: Progress,
    done: usize,
    failed: usize,
    first_failure: Option<Error>,
}

/// What members have yielded.
pub struct Gathered {
    /// Those on both sides of the estimate.
    pub sides: Vec<Sides>,
    /// Those that are drawn.
    pub draws: Vec<Sample>,
}

impl<'a> Members<'a> {
    /// None yet, of so many besides those that are drawn.
    pub fn new(plan: &'a EnsemblePlan, report: &'a Report<'_>, besides: usize) -> Self {
        Members {
            plan,
            call: report.call,
            standing: Mutex::new(Standing {
                progress: report.progress(),
                done: 0,
                failed: 0,
                first_failure: None,
            }),
            all: plan.draws + besides,
        }
    }

    fn standing(&self) -> MutexGuard<'_, Standing> {
        self.standing.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How many failed, and why the first one did.
    pub fn failures(&self) -> (usize, Option<Error>) {
        let standing = self.standing();
        (standing.failed, standing.first_failure.clone())
    }

    /// What a command yields; `None` where it failed or the run is to stop.
    pub fn run(&self, command: &Command) -> Option<Yield> {
        if self.call.flag().load(std::sync::atomic::Ordering::Relaxed) {
            return None;
        }
        let ran = member::run(command, self.call, false);
        let mut standing = self.standing();
        standing.done += 1;
        let fraction = standing.done as f64 / self.all.max(1) as f64;
        standing.progress.come(fraction);
        match ran {
            Ok((_, Ending::Interrupted)) => None,
            Ok((found, _)) => Some(found),
            Err(error) => {
                standing.failed += 1;
                standing.first_failure.get_or_insert(error);
                None
            }
        }
    }

    /// The fitted parameters in a draw.
    pub fn drawn(&self, draw: usize) -> Vec<f64> {
        let fit = &self.plan.fit;
        fit.draw(draw, |count| normal(draw, count))
    }

    /// All members, as the things of the estimate that they have.
    ///
    /// # Errors
    /// [`Error::Input`] where the system has no threads.
    pub fn gather(
        &self,
        estimate: &[Item],
        (items, [of_sides, of_draws]): (Items<'_>, [&[f64]; 2]),
    ) -> Result<Gathered> {
        let pool = rayon::ThreadPoolBuilder::new()
            .stack_size(STACK)
            .build()
            .map_err(|error| Error::Input(format!("the threads of an ensemble: {error}")))?;
        let sample = |values: &[f64], landings: &[f64]| {
            let command = self.plan.landing(self.plan.member(values), landings);
            let found = self.run(&command)?;
            Some(Sample::of(estimate, &items(&found)))
        };
        let parameters = &self.plan.fit.parameters;
        let side = |i: usize| {
            let step = step(&parameters[i]);
            let at = |sign: f64| {
                let mut by = DVector::zeros(parameters.len());
                by[i] = sign * step;
                let known = step > 0.0;
                known
                    .then(|| sample(&self.plan.fit.above(&by), of_sides))
                    .flatten()
            };
            Sides {
                samples: [at(-1.0), at(1.0)],
                step,
            }
        };
        let sides = pool.install(|| (0..parameters.len()).into_par_iter().map(side).collect());
        let draw = |draw: usize| sample(&self.drawn(draw), of_draws);
        let draws = pool.install(|| {
            (0..self.plan.draws)
                .into_par_iter()
                .filter_map(draw)
                .collect()
        });
        Ok(Gathered { sides, draws })
    }
}

/// How far a derivative goes, in standard errors of the parameter; not at all where that is known exactly.
fn step(one: &FittedParameter) -> f64 {
    if one.deviation == 0.0 {
        return 0.0;
    }
    match one.log {
        true => STEP / one.deviation,
        false => STEP * (one.value.abs() / one.deviation).max(1.0),
    }
}
