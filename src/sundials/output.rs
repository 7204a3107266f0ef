//! What CVODES tells of an integration: states, the continuous solution, step sizes and counts.
#![allow(unsafe_code)]

use super::cvode::{Cvode, CvodeMemory};
use super::{Messages, check};
use crate::contract::Work;
use crate::error::Result;
use crate::field::State;

use std::ffi::{c_int, c_long};

impl<const N: usize> Cvode<N> {
    /// The state where [`Cvode::advance`] last returned; after an error, where the integration had come.
    pub fn state(&self) -> State<N> {
        self.state.get()
    }

    /// The continuous solution at `t`, which must be within the last step.
    ///
    /// # Errors
    /// [`crate::Error::Sundials`] with `CV_BAD_T` outside it.
    pub fn dense(&self, t: f64) -> Result<State<N>> {
        self.dense_derivative(t, 0)
    }

    /// The derivative of the given order of the continuous solution at `t`, which must be within the last step.
    ///
    /// # Errors
    /// [`crate::Error::Sundials`] with `CV_BAD_T` outside it, with `CV_BAD_K` above the order of the last step.
    pub fn dense_derivative(&self, t: f64, order: usize) -> Result<State<N>> {
        let m = self.memory.as_ptr();
        let order = c_int::try_from(order).unwrap_or(c_int::MAX);
        // SAFETY: a live memory and a vector like the one it was given; nothing else reads or writes it meanwhile, since the
        // solver is not Sync and no reference into the vector is ever given away.
        unsafe {
            check!(
                CV,
                &self.messages,
                CVodeGetDky(m, t, order, self.dense.as_ptr())
            )?
        };
        Ok(self.dense.get())
    }

    /// The time that the integration has reached inside, at or beyond the last return.
    ///
    /// # Errors
    /// [`crate::Error::Sundials`]; not after a successful [`Cvode::start`].
    pub fn time(&self) -> Result<f64> {
        let mut t = 0.0;
        // SAFETY: a live memory and a valid place.
        unsafe {
            check!(
                CV,
                &self.messages,
                CVodeGetCurrentTime(self.memory.as_ptr(), &mut t)
            )?
        };
        Ok(t)
    }

    /// The size of the last step, with its sign.
    ///
    /// # Errors
    /// [`crate::Error::Sundials`]; not after a successful [`Cvode::start`].
    pub fn step_size(&self) -> Result<f64> {
        let mut h = 0.0;
        // SAFETY: a live memory and a valid place.
        unsafe {
            check!(
                CV,
                &self.messages,
                CVodeGetLastStep(self.memory.as_ptr(), &mut h)
            )?
        };
        Ok(h)
    }

    /// The size of the step that was being tried, or is to be tried next, with its sign.
    ///
    /// # Errors
    /// [`crate::Error::Sundials`]; not after a successful [`Cvode::start`].
    pub fn trial_step_size(&self) -> Result<f64> {
        let mut h = 0.0;
        // SAFETY: a live memory and a valid place.
        unsafe {
            check!(
                CV,
                &self.messages,
                CVodeGetCurrentStep(self.memory.as_ptr(), &mut h)
            )?
        };
        Ok(h)
    }

    /// The work since [`Cvode::start`]. Jacobians count those of sensitivities, right-hand sides don't.
    ///
    /// # Errors
    /// [`crate::Error::Sundials`]; not after a successful [`Cvode::start`].
    pub fn work(&self) -> Result<Work> {
        let mut work = self.memory.work(&self.messages)?;
        work.jacobians += self.tangents;
        Ok(work)
    }

    pub(super) fn steps(&self) -> Result<usize> {
        let mut steps = 0;
        // SAFETY: a live memory and a valid place.
        unsafe {
            check!(
                CV,
                &self.messages,
                CVodeGetNumSteps(self.memory.as_ptr(), &mut steps)
            )?
        };
        Ok(steps as usize)
    }
}

impl CvodeMemory {
    /// The work since the integration began.
    pub(super) fn work(&self, messages: &Messages) -> Result<Work> {
        let m = self.as_ptr();
        let mut counts: [c_long; 7] = [0; 7];
        let [steps, rejected, unsolved, rhs, jacobians, setups, nonlinear] = &mut counts;
        // SAFETY: a live memory, and valid places for the results.
        unsafe {
            check!(CV, messages, CVodeGetNumSteps(m, steps))?;
            check!(CV, messages, CVodeGetNumErrTestFails(m, rejected))?;
            check!(CV, messages, CVodeGetNumStepSolveFails(m, unsolved))?;
            check!(CV, messages, CVodeGetNumRhsEvals(m, rhs))?;
            check!(CVLS, messages, CVodeGetNumJacEvals(m, jacobians))?;
            check!(CV, messages, CVodeGetNumLinSolvSetups(m, setups))?;
            check!(CV, messages, CVodeGetNumNonlinSolvIters(m, nonlinear))?;
        }
        let [steps, rejected, unsolved, rhs, jacobians, setups, nonlinear] =
            counts.map(|n| n as usize);
        Ok(Work {
            steps,
            rejected: rejected + unsolved,
            rhs,
            jacobians,
            factorisations: setups,
            nonlinear,
        })
    }
}
