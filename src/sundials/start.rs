//! How a run of CVODES begins: the initial state, the stop time, and the first step where CVODES's own would be too long.
#![allow(unsafe_code)]

use super::callback::{Problem, all_finite};
use super::cvode::vector;
use super::{Cvode, check};
use crate::contract::Tolerances;
use crate::error::{Error, Result};
use crate::field::{State, VectorField};

/// CVODES's norm is the root of the mean square of all N components. Those that are no variables do not err, and time is not judged; with
/// tolerances less by this factor it is that of the others.
pub(crate) fn part_of_mean<const N: usize>(field: &dyn VectorField<N>) -> f64 {
    let judged = field.dimension() - usize::from(field.last_is_time());
    (judged.max(1) as f64 / N as f64).sqrt()
}

impl<const N: usize> Cvode<N> {
    /// Begins at `y0`, without sensitivities. Forgets everything before but the settings.
    ///
    /// # Errors
    /// [`Error::NonFinite`] if `y0` or `t0` is not finite.
    pub fn start(&mut self, t0: f64, y0: &State<N>) -> Result<()> {
        self.restart(t0, y0)?;
        self.forget_sensitivities()
    }

    pub(super) fn restart(&mut self, t0: f64, y0: &State<N>) -> Result<()> {
        if !(t0.is_finite() && all_finite(y0.as_slice())) {
            return Err(Error::NonFinite {
                what: "the initial state",
                t: t0,
            });
        }
        self.state.set(y0);
        let m = self.memory.as_ptr();
        // SAFETY: a live memory and a vector like the one it was given at first.
        unsafe { check!(CV, &self.messages, CVodeReInit(m, t0, self.state.as_ptr()))? };
        (self.start, self.stalled, self.tangents, self.armed) = (t0, 0, 0, None);
        Ok(())
    }

    /// Tells CVODES the stop time, if it does not have it. There is no way to unset one before version 6.5: infinity does.
    pub(super) fn arm_stop_time(&mut self, to: f64) -> Result<()> {
        if self.armed == Some(self.stop_time) {
            return Ok(());
        }
        let t = self
            .stop_time
            .unwrap_or(f64::INFINITY.copysign(to - self.start));
        let m = self.memory.as_ptr();
        // SAFETY: a live memory.
        unsafe { check!(CV, &self.messages, CVodeSetStopTime(m, t))? };
        self.armed = Some(self.stop_time);
        Ok(())
    }

    /// What a step may err in each variable, where that is not the same for all ([`crate::field::VectorField::absolute_tolerances`]). CVODES takes the
    /// root mean square over all N: those that do not count, or are no variables, shall not make it less for the others.
    pub(super) fn set_absolute_tolerances(&mut self, problem: &Problem<'_, N>) -> Result<()> {
        let Tolerances { rtol, atol, .. } = self.tolerances;
        let each = problem.field.absolute_tolerances(atol);
        let part = part_of_mean(problem.field);
        let is_same = part == 1.0 && each.iter().all(|&one| one == atol);
        let m = self.memory.as_ptr();
        if is_same && self.has_vector_tolerances {
            // SAFETY: a live memory.
            unsafe { check!(CV, &self.messages, CVodeSStolerances(m, rtol, atol))? };
        } else if !is_same {
            let mut tolerances = vector::<N>(self.operations, &self.context)?;
            tolerances.set(&(each * part));
            let made = tolerances.as_ptr();
            // SAFETY: a live memory, and a vector like the one it was given at first, which CVODES copies.
            unsafe { check!(CV, &self.messages, CVodeSVtolerances(m, rtol * part, made))? };
        }
        self.has_vector_tolerances = !is_same;
        Ok(())
    }

    /// A first step for fields so fast that CVODES's own choice, never below a hundred spacings of t, would move the state by
    /// more than its size. Undoing the prediction of such a step leaves rounding in place of the state, and CVODES goes on
    /// from there with success. Everywhere else the choice stays CVODES's.
    pub(super) fn set_first_step(&mut self, problem: &Problem<'_, N>, to: f64) -> Result<()> {
        /// CVODES's bound from below, in spacings of the larger time.
        const SHORTEST: f64 = 100.0 * f64::EPSILON;
        let y = self.state();
        let f = problem.field.f(&y);
        let Tolerances { rtol, atol, .. } = self.tolerances;
        let atol = problem.field.absolute_tolerances(atol);
        let shortest = SHORTEST * self.start.abs().max(to.abs());
        let too_long = (0..N).any(|i| shortest * f[i].abs() > y[i].abs() + atol[i] / rtol);
        let h = if too_long && all_finite(f.as_slice()) {
            let within = (0..N).map(|i| (atol[i] + rtol * y[i].abs()) / f[i].abs());
            within
                .fold(f64::INFINITY, f64::min)
                .copysign(to - self.start)
        } else {
            0.0 // its own choice
        };
        let m = self.memory.as_ptr();
        // SAFETY: a live memory.
        unsafe { check!(CV, &self.messages, CVodeSetInitStep(m, h))? };
        Ok(())
    }
}
