//! Many runs at once, one in every lane of the processor's vectors.

use super::super::{Control, Step, Tolerances, Work, step_underflow};
use super::Taylor;
use super::way::Clock;
use crate::error::{Error, Result};
use crate::field::State;
use crate::friction::AnyLaw;
use crate::integrate::Integrator;
use crate::model::{BatchSolution, Loading, MAX_LANES, batch_solution, two_interfaces};
use crate::number::DoubleDouble;
use crate::series::Expansion;
use std::cell::LazyCell;

/// A run of two interfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BatchRun {
    /// V_H and K.
    pub loading: Loading,
    /// (tau, ln psi_1, ln psi_2) at `t.0`. Equal interfaces stay equal, to the bit.
    pub start: State<3>,
    /// From `t.0` to `t.1`; backwards in time if that is less.
    pub t: (f64, f64),
}

/// Sees every step of every run, with the number of the run. What it returns is for that run alone.
pub type BatchObserver<'a> = &'a mut dyn FnMut(usize, &Step<'_, 3>) -> Result<Control>;

/// The Taylor method on many runs with one law, such as a sweep over V_H and K: every lane of the processor's vectors goes
/// its own way, with its own steps, and takes the next run when it has done one.
///
/// Where the processor has no AVX2 the runs are done one after the other. The results are those of [`Taylor`] within the tolerance
/// (at some tolerances the order is another), and do not depend on which runs share a batch, to the bit.
///
/// ```
/// use twinslip::field::State;
/// use twinslip::friction::{AnyLaw, Parameters};
/// use twinslip::integrate::{Batch, BatchRun, MAX_STEPS, Tolerances};
/// use twinslip::model::Loading;
/// # fn main() -> twinslip::Result<()> {
/// let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
/// let start = State::<3>::new(10.0, 0.5_f64.ln(), 0.001_f64.ln());
/// let mut runs = Vec::new();
/// for driving in [1.0, 3.0, 10.0, 30.0] {
///     let loading = Loading::new(driving, 0.14)?;
///     runs.push(BatchRun { loading, start, t: (0.0, 1.0) });
/// }
/// let mut batch = Batch::new(law, Tolerances::equal(1e-9)?, MAX_STEPS)?;
/// for end in batch.flow(&runs, None) {
///     assert!(end?[0] > 5.0);
/// }
/// # Ok(())
/// # }
/// ```
pub struct Batch {
    law: AnyLaw,
    taylor: Taylor,
    batch_solution: Option<Box<dyn BatchSolution>>,
    work: Work,
}

/// A run on its way in a lane.
struct Seat {
    run: usize,
    clock: Clock,
    remaining: DoubleDouble,
    steps: usize,
    /// The state at the beginning of the next step; kept only for an observer.
    y: State<3>,
}

/// What becomes of a run after a step.
enum Fate {
    On,
    Done,
    Failed(Error),
}

impl Batch {
    /// For runs with this law, of at most `max_steps` steps each.
    ///
    /// # Errors
    /// [`Error::Parameter`] for tolerances outside their domain or no steps.
    pub fn new(law: AnyLaw, tolerances: Tolerances, max_steps: usize) -> Result<Self> {
        Ok(Batch {
            law,
            taylor: Taylor::new(tolerances, max_steps)?,
            batch_solution: batch_solution(law),
            work: Work::default(),
        })
    }

    /// How many runs this one has on their way at the same time: 8 with AVX-512, 4 with AVX2, otherwise 1.
    pub fn lanes(&self) -> usize {
        self.batch_solution
            .as_ref()
            .map_or(1, |batch_solution| batch_solution.lanes())
    }

    /// The work of the last call, of all runs together.
    pub fn work(&self) -> Work {
        self.work
    }

    /// The end of every run, in their order. A run that fails leaves the others alone.
    ///
    /// # Errors
    /// Those of [`Integrator::flow`], each in the place of its run.
    pub fn flow(
        &mut self,
        runs: &[BatchRun],
        mut observer: Option<BatchObserver<'_>>,
    ) -> Vec<Result<State<3>>> {
        self.work = Work::default();
        let Some(mut batch_solution) = self.batch_solution.take() else {
            return self.one_by_one(runs, observer);
        };
        let mut ends: Vec<Result<State<3>>> = runs.iter().map(|run| Ok(run.start)).collect();
        let mut next = 0;
        let mut seats: [Option<Seat>; MAX_LANES] = [const { None }; MAX_LANES];
        let mut limits = [1.0; MAX_LANES];
        let mut expansion = Expansion::new();
        let accuracy = self.taylor.accuracy;
        for (lane, seat) in seats.iter_mut().enumerate().take(batch_solution.lanes()) {
            *seat = self.seated(&mut *batch_solution, lane, runs, &mut next, &mut ends);
        }
        while seats.iter().any(Option::is_some) {
            for (limit, seat) in limits.iter_mut().zip(&seats) {
                *limit = seat.as_ref().map_or(1.0, |seat| seat.remaining.hi());
            }
            let steps = batch_solution.advance(&accuracy, &limits);
            for (lane, seat) in seats.iter_mut().enumerate() {
                let Some(here) = seat else { continue };
                let (begin, before) = (here.clock.now, here.clock.now.hi());
                let mut fate = self.ticked(here, &*batch_solution, lane, steps[lane], runs);
                if let (Some(observer), Fate::On | Fate::Done) = (&mut observer, &fate) {
                    let end = State::from(batch_solution.state(lane));
                    let made = LazyCell::new(|| {
                        batch_solution.expansion(lane, accuracy.order, &mut expansion);
                        (expansion.begin, expansion.length) = (begin, steps[lane]);
                        &expansion
                    });
                    let control = observer(
                        here.run,
                        &Step {
                            t0: before,
                            y0: &here.y,
                            t1: here.clock.now.hi(),
                            y1: &end,
                            begin,
                            length: steps[lane],
                            continuous: &|time| State::from(made.state(time)),
                            reach: batch_solution.reaches()[lane],
                            expansion: Some(&made),
                            slips: None,
                        },
                    );
                    here.y = end;
                    match control {
                        Ok(Control::Continue | Control::Rest(_)) => (),
                        Ok(Control::Stop) => fate = Fate::Done,
                        Err(error) => fate = Fate::Failed(error),
                    }
                }
                if let Fate::On = fate {
                    fate = self.within_bounds(here, runs);
                }
                ends[here.run] = match fate {
                    Fate::On => continue,
                    Fate::Done => Ok(State::from(batch_solution.state(lane))),
                    Fate::Failed(error) => Err(error),
                };
                *seat = self.seated(&mut *batch_solution, lane, runs, &mut next, &mut ends);
            }
        }
        self.batch_solution = Some(batch_solution);
        ends
    }

    /// The next run that has any steps to do, begun in this lane; those before it are at their ends.
    fn seated(
        &self,
        batch_solution: &mut dyn BatchSolution,
        lane: usize,
        runs: &[BatchRun],
        next: &mut usize,
        ends: &mut [Result<State<3>>],
    ) -> Option<Seat> {
        while *next < runs.len() {
            let (run, BatchRun { loading, start, t }) = (*next, runs[*next]);
            *next += 1;
            let field = two_interfaces(self.law, loading);
            if !field.f(&start).iter().all(|x| x.is_finite()) {
                ends[run] = Err(Error::NonFinite {
                    what: "the right-hand side",
                    t: t.0,
                });
            } else {
                let clock = Clock::new(t);
                let Some(remaining) = clock.remaining() else {
                    continue;
                };
                batch_solution.start(lane, &loading, &start.data.0[0]);
                return Some(Seat {
                    run,
                    clock,
                    remaining,
                    steps: 0,
                    y: start,
                });
            }
        }
        batch_solution.idle(lane);
        None
    }

    /// Goes on by a step that the series took.
    fn ticked(
        &mut self,
        seat: &mut Seat,
        batch_solution: &dyn BatchSolution,
        lane: usize,
        h: f64,
        runs: &[BatchRun],
    ) -> Fate {
        let before = seat.clock.now.hi();
        if !seat.clock.tick(h.into(), seat.remaining) {
            let h = if h.is_finite() { h } else { 0.0 };
            let h = h.copysign(seat.remaining.hi());
            let here = State::from(batch_solution.state(lane));
            let field = two_interfaces(self.law, runs[seat.run].loading);
            return Fate::Failed(step_underflow(&*field, before, h, &here));
        }
        seat.steps += 1;
        self.work.steps += 1;
        self.work.rhs += self.taylor.accuracy.order;
        match seat.clock.remaining() {
            Some(remaining) => {
                seat.remaining = remaining;
                Fate::On
            }
            None => Fate::Done,
        }
    }

    /// Whether a run that is not at its end may go on.
    fn within_bounds(&self, seat: &Seat, runs: &[BatchRun]) -> Fate {
        if seat.steps < self.taylor.max_steps {
            return Fate::On;
        }
        Fate::Failed(Error::TooManySteps {
            t: seat.clock.now.hi(),
            end: runs[seat.run].t.1,
            limit: self.taylor.max_steps,
        })
    }

    /// Without lanes.
    fn one_by_one(
        &mut self,
        runs: &[BatchRun],
        mut observer: Option<BatchObserver<'_>>,
    ) -> Vec<Result<State<3>>> {
        let mut ends = Vec::with_capacity(runs.len());
        for (i, run) in runs.iter().enumerate() {
            let field = two_interfaces(self.law, run.loading);
            let end = match &mut observer {
                None => self.taylor.flow(&*field, run.t, &run.start, None),
                Some(observer) => {
                    let mut of_run = |step: &Step<'_, 3>| observer(i, step);
                    self.taylor
                        .flow(&*field, run.t, &run.start, Some(&mut of_run))
                }
            };
            let work = Integrator::<3>::work(&self.taylor);
            self.work.steps += work.steps;
            self.work.rhs += work.rhs;
            ends.push(end);
        }
        ends
    }
}
