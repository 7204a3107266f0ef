//! What is asked of a numerical method, and what it cost.

use crate::error::{Error, Result};
use std::ops::AddAssign;

/// Local error tolerances: component i may err by `atol + rtol * |y_i|` in a step.
///
/// In the chart (tau, ln psi_1, ln psi_2) an absolute error of ln psi is a relative error of psi.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Relative tolerance.
    pub rtol: f64,
    /// Absolute tolerance.
    pub atol: f64,
    /// The largest step, infinite where it is the method's own choice: what rises and falls within a step and vanishes at both of its
    /// ends, as a short pulse, is seen by no method.
    pub max_step: f64,
}

impl Tolerances {
    /// Both tolerances, checked: atol positive and finite, rtol from 1e-16, where doubles end, to below one.
    pub fn new(rtol: f64, atol: f64) -> Result<Self> {
        if !(1e-16..1.0).contains(&rtol) {
            return Err(Error::parameter(
                "rtol",
                rtol,
                "at least 1e-16 and less than 1",
            ));
        }
        if !(atol > 0.0 && atol.is_finite()) {
            return Err(Error::parameter("atol", atol, "positive and finite"));
        }
        Ok(Tolerances {
            rtol,
            atol,
            max_step: f64::INFINITY,
        })
    }

    /// The same, checked as by [`Tolerances::new`], and that the largest step is positive.
    pub(crate) fn checked(self) -> Result<Self> {
        if self.max_step > 0.0 {
            let checked = Self::new(self.rtol, self.atol)?;
            return Ok(checked.stepping(self.max_step));
        }
        Err(Error::parameter("max-step", self.max_step, "positive"))
    }

    /// With this largest step.
    pub fn stepping(self, max_step: f64) -> Self {
        Tolerances { max_step, ..self }
    }

    /// The same number for both: sensible where all components are of order one to ten, as here.
    pub fn equal(tolerance: f64) -> Result<Self> {
        Self::new(tolerance, tolerance)
    }
}

/// What an integration cost. A result, never a log line.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Work {
    /// Accepted steps.
    pub steps: usize,
    /// Steps refused by the error test, or because a trial value was not finite.
    pub rejected: usize,
    /// Evaluations of f.
    pub rhs: usize,
    /// Evaluations of the Jacobian.
    pub jacobians: usize,
    /// Matrix factorisations.
    pub factorisations: usize,
    /// Nonlinear (Newton) iterations; zero for Rosenbrock methods.
    pub nonlinear: usize,
}

impl AddAssign for Work {
    fn add_assign(&mut self, more: Work) {
        self.steps += more.steps;
        self.rejected += more.rejected;
        self.rhs += more.rhs;
        self.jacobians += more.jacobians;
        self.factorisations += more.factorisations;
        self.nonlinear += more.nonlinear;
    }
}

/// The bound on steps where the caller names none.
pub const MAX_STEPS: usize = 10_000_000;
