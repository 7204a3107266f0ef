//! What is asked of the run of an initial value problem, and what it comes to.

use super::event::IvpEvent;
use super::solution::IvpSolution;
use std::fmt;
use twinslip::error::Error;
use twinslip::integrate::{Control, Work};

/// What is asked of a run; nothing else is computed.
pub struct IvpAsked<'a, E> {
    /// The times of the rows, within the span and in its direction; without any they are the start and the ends of all steps.
    pub times: Option<&'a [f64]>,
    /// The events.
    pub events: Vec<IvpEvent<'a, E>>,
    /// Whether the solution is kept as a function of time.
    pub dense_output: bool,
    /// Is told after every step to which fraction of its span the run has come, and may stop it.
    pub reached: Option<&'a mut dyn FnMut(f64) -> Control>,
}

impl<E> Default for IvpAsked<'_, E> {
    fn default() -> Self {
        IvpAsked {
            times: None,
            events: Vec::new(),
            dense_output: false,
            reached: None,
        }
    }
}

impl<E> fmt::Debug for IvpAsked<'_, E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("IvpAsked")
            .field("times", &self.times)
            .field("events", &self.events)
            .field("dense_output", &self.dense_output)
            .finish_non_exhaustive()
    }
}

/// What a run came to, in the user's units.
#[derive(Debug, Clone, PartialEq)]
pub struct IvpOutcome {
    /// The times of the rows.
    pub t: Vec<f64>,
    /// The values at the first of these times, then those at the second, and so on: [`IvpPlan::dimension`](super::IvpPlan::dimension) at each.
    pub y: Vec<f64>,
    /// For each event the times at which it was.
    pub t_events: Vec<Vec<f64>>,
    /// For each event the values at these times, one after the other.
    pub y_events: Vec<Vec<f64>>,
    /// Whether of each event that is a formula there are parts of the run of which it is not known how many zeros they have.
    pub undecided: Vec<bool>,
    /// The solution as a function of time, where it was asked for and there is a step of it.
    pub solution: Option<IvpSolution>,
    /// 0: the end of the span was reached; 1: a terminal event has ended it; -1: it went no further, as `failure` says.
    pub status: i32,
    /// Why it went no further; all that came before is kept.
    pub failure: Option<Error>,
    /// What it cost.
    pub work: Work,
    /// Whether it was stopped from outside: the failure is then [`Error::Interrupted`].
    pub stopped: bool,
}

/// Why there is no outcome.
#[derive(Debug, Clone, PartialEq)]
pub enum IvpError<E> {
    /// What is asked can't be done.
    Own(Error),
    /// The error of an event's function, as it is.
    Event(E),
}

impl<E> From<Error> for IvpError<E> {
    fn from(error: Error) -> Self {
        IvpError::Own(error)
    }
}

impl<E: fmt::Display> fmt::Display for IvpError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            IvpError::Own(error) => error.fmt(f),
            IvpError::Event(error) => error.fmt(f),
        }
    }
}

impl<E: fmt::Debug + fmt::Display> std::error::Error for IvpError<E> {}

impl IvpOutcome {
    pub(super) fn new(events: usize) -> Self {
        IvpOutcome {
            t: Vec::new(),
            y: Vec::new(),
            t_events: vec![Vec::new(); events],
            y_events: vec![Vec::new(); events],
            undecided: vec![false; events],
            solution: None,
            status: 0,
            failure: None,
            work: Work::default(),
            stopped: false,
        }
    }

    /// Stopped before its first step.
    pub(super) fn interrupted(events: usize) -> Self {
        IvpOutcome {
            status: -1,
            failure: Some(Error::Interrupted),
            stopped: true,
            ..IvpOutcome::new(events)
        }
    }
}
