//! What an observer of a run sees: every step, with everything at any time of it, and from time to time all that is needed to go on.

use super::block::Extent;
use super::taylor::StepSeries;
use crate::error::Result;

/// A step of all interfaces, from its beginning to its end.
pub trait ManyStep {
    /// The time at its beginning.
    fn begin(&self) -> f64;

    /// The time at its end.
    fn end(&self) -> f64;

    /// tau at a time of the step.
    fn stress(&self, time: f64) -> f64;

    /// What all interfaces do at a time of the step; `sliding` counts those that are faster than this.
    fn extent(&self, time: f64, faster_than: f64) -> Extent;

    /// psi and v of an interface that is held here at a time of the step.
    ///
    /// # Panics
    /// Where it is not held here, as the next.
    fn interface(&self, interface: usize, time: f64) -> [f64; 2];

    /// How far an interface whose slip is asked for slips from the beginning of the step to a time of it.
    fn slip(&self, interface: usize, time: f64) -> f64;

    /// The same of all interfaces together.
    fn slip_of_all(&self, time: f64) -> f64;

    /// The power series that the step is made of, where it is.
    fn series(&self) -> Option<StepSeries<'_>> {
        None
    }
}

/// All that a run needs to go on as if nothing had happened.
#[derive(Debug, Clone, PartialEq)]
pub struct Saved {
    /// The time reached, in two doubles.
    pub time: [f64; 2],
    /// Steps so far.
    pub steps: usize,
    /// What all processes know: tau, and what else the method has.
    pub shared: Vec<f64>,
    /// A number of every interface that is held here.
    pub held: Vec<f64>,
}

/// Where a run begins.
#[derive(Debug, Clone, Copy)]
pub enum Beginning<'a> {
    /// At time 0, with tau and psi of every interface that is held here.
    Start(f64, &'a [f64]),
    /// Where another one was.
    Saved(&'a Saved),
}

/// Goes along with a run.
pub trait ManyObserver {
    /// Sees a step; whether to go on.
    ///
    /// # Errors
    /// What ends the run as a failure.
    fn step(&mut self, step: &dyn ManyStep) -> Result<bool>;

    /// After how many steps to save, again and again. Methods with a memory begin anew there, whether anybody saves or not: a run that
    /// goes on from there is the same to the last bit.
    fn save_every(&self) -> Option<usize> {
        None
    }

    /// Keeps what the run needs to go on.
    ///
    /// # Errors
    /// What ends the run as a failure.
    fn save(&mut self, _saved: Saved) -> Result<()> {
        Ok(())
    }
}

/// An observer that looks at steps alone.
pub(super) struct Looking<'a>(pub &'a mut dyn FnMut(&dyn ManyStep) -> Result<bool>);

impl ManyObserver for Looking<'_> {
    fn step(&mut self, step: &dyn ManyStep) -> Result<bool> {
        (self.0)(step)
    }
}

/// How many steps there are from here to the next save, of so many so far.
pub(super) fn until_save(observer: &dyn ManyObserver, steps: usize) -> usize {
    match observer.save_every() {
        Some(every) => every - steps % every,
        None => usize::MAX,
    }
}
