//! KINSOL for a system in linear time: f(y) = 0.
#![allow(unsafe_code)]

use super::solver::{content, matrix, solver};
use super::vector::{numbers, numbers_mut, vector};
use super::{Frame, LinearTime, frame};
use crate::error::{Error, Result};
use crate::sundials::callback::{FATAL, GOOD, all_finite};
use crate::sundials::kinsol::{KinsolMemory, Outcome, Strategy};
use crate::sundials::linear_solver::{LinearSolver, Matrix};
use crate::sundials::vector::NVector;
use crate::sundials::{Context, Messages, Stable, check, native};
use std::ffi::{c_int, c_long, c_void};
use sundials_sys::{N_Vector, SUNMatrix};

/// When an iteration of [`LargeKinsol`] ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Until {
    /// The largest number of f(y), by the system's weights, is at most this.
    pub residual: f64,
    /// A step is at most this, relative to y.
    pub step: f64,
    /// No step is longer than this, as a root of a sum of squares.
    pub longest_step: f64,
    /// So many iterations are done.
    pub iterations: usize,
}

/// An iteration, which goes on from where it is. The numbers of y should be of order one.
pub(crate) struct LargeKinsol<S: LinearTime> {
    // In the order in which they must go.
    memory: KinsolMemory,
    _solver: LinearSolver,
    _matrix: Matrix,
    unknown: NVector,
    unknown_scale: NVector,
    residual_scale: NVector,
    _context: Context,
    frame: Stable<Frame<S>>,
    messages: Stable<Messages>,
}

impl<S: LinearTime> LargeKinsol<S> {
    /// From a guess on.
    ///
    /// # Errors
    /// [`Error::Sundials`] if SUNDIALS can't allocate, or is not of the version of its headers.
    pub fn new(system: S, guess: Vec<f64>) -> Result<Self> {
        let messages = Stable::new(Messages::default());
        let frame = Stable::new(Frame::new(system));
        let context = Context::new(&messages)?;
        let ones = vec![1.0; guess.len()];
        let residual_scale = vector(&context, &frame.system, ones.clone())?;
        let unknown_scale = vector(&context, &frame.system, ones)?;
        let unknown = vector(&context, &frame.system, guess)?;
        let matrix = matrix::<S>(&context)?;
        let solver = solver(&context, &*frame)?;
        let memory = KinsolMemory::new(&context)?;
        let m = memory.as_ptr();
        // SAFETY: live objects of one context, kept by the solver longer than the memory; the callbacks are of this system, whose frame's
        // address never changes.
        unsafe {
            native::keep_kinsol_messages(m, &messages)?;
            // Before everything that copies the user data.
            check!(KIN, &messages, KINSetUserData(m, frame.as_ptr()))?;
            check!(
                KIN,
                &messages,
                KINInit(m, Some(residual::<S>), unknown.as_ptr())
            )?;
            check!(
                KINLS,
                &messages,
                KINSetLinearSolver(m, solver.as_ptr(), matrix.as_ptr())
            )?;
            check!(KINLS, &messages, KINSetJacFn(m, Some(jacobian::<S>)))?;
            // Newton's method proper: a new Jacobian at every iterate
            check!(KIN, &messages, KINSetMaxSetupCalls(m, 1))?;
        }
        Ok(LargeKinsol {
            memory,
            _solver: solver,
            _matrix: matrix,
            unknown,
            unknown_scale,
            residual_scale,
            _context: context,
            frame,
            messages,
        })
    }

    /// Goes on, with weights taken where it is. [`Outcome::SmallStep`] and [`Outcome::IterationLimit`] are left to the caller's
    /// judgement, with the last iterate.
    ///
    /// # Errors
    /// [`Error::NotConverged`] where the line search finds no way down, [`Error::NonFinite`] if f is not finite where it must be,
    /// [`Error::Sundials`] otherwise. A panic of the system's code goes on here.
    pub fn iterate(&mut self, strategy: Strategy, until: Until) -> Result<Outcome> {
        let m = self.memory.as_ptr();
        self.messages.clear();
        // SAFETY: live vectors of this system, which are not the same, and nothing else refers to their numbers.
        let (unknown, scale) = unsafe {
            (
                numbers::<S>(self.unknown.as_ptr()),
                numbers_mut::<S>(self.residual_scale.as_ptr()),
            )
        };
        self.frame.system.weights(unknown, scale);
        let messages = &self.messages;
        let iterations = until.iterations as c_long;
        // SAFETY: a live memory that `new` has set up.
        unsafe {
            check!(KIN, messages, KINSetFuncNormTol(m, until.residual))?;
            check!(KIN, messages, KINSetScaledStepTol(m, until.step))?;
            check!(KIN, messages, KINSetNumMaxIters(m, iterations))?;
            check!(KIN, messages, KINSetMaxNewtonStep(m, until.longest_step))?;
        }
        // SAFETY: a live memory that `new` has set up, and live vectors like the one it was given.
        let code = unsafe {
            sundials_sys::KINSol(
                m,
                self.unknown.as_ptr(),
                strategy.flag(),
                self.unknown_scale.as_ptr(),
                self.residual_scale.as_ptr(),
            )
        };
        self.frame.guard.resume();
        let Some(outcome) = Outcome::of(code) else {
            let not_finite = self.frame.guard.not_finite();
            return Err(self
                .memory
                .explain(code, not_finite, until.residual, messages));
        };
        if !all_finite(self.unknown()) {
            let what = "the root";
            return Err(Error::NonFinite { what, t: 0.0 });
        }
        Ok(outcome)
    }

    /// Where it is.
    pub fn unknown(&self) -> &[f64] {
        // SAFETY: a live vector of this system, which only `iterate` writes to, exclusively.
        unsafe { numbers::<S>(self.unknown.as_ptr()) }
    }

    /// Newton iterations of the last call.
    ///
    /// # Errors
    /// [`Error::Sundials`] before the first one.
    pub fn iterations(&self) -> Result<usize> {
        Ok(self.memory.reached(&self.messages)?.0)
    }
}

/// f(y).
///
/// # Safety
/// As KINSOL calls it, for a solver of this system.
unsafe extern "C" fn residual<S: LinearTime>(
    y: N_Vector,
    f: N_Vector,
    user_data: *mut c_void,
) -> c_int {
    // SAFETY: KINSOL passes live vectors, which are not the same, and the frame of the system.
    let (frame, y, f) = unsafe { (frame::<S>(user_data), numbers::<S>(y), numbers_mut::<S>(f)) };
    let made = frame.guard.run(|| {
        frame.system.rates(y, f);
        // All processes must take the same way.
        let own = if all_finite(f) { 0.0 } else { f64::NAN };
        frame.system.largest(own).is_finite()
    });
    match made {
        None => FATAL,
        Some(false) => frame.guard.refuse("the residual"),
        Some(true) => GOOD,
    }
}

/// J = -(0 I - J).
///
/// # Safety
/// As KINSOL calls it, for a solver of this system.
unsafe extern "C" fn jacobian<S: LinearTime>(
    y: N_Vector,
    _f: N_Vector,
    a: SUNMatrix,
    user_data: *mut c_void,
    _: N_Vector,
    _: N_Vector,
) -> c_int {
    // SAFETY: KINSOL passes live objects like those it was given at first, and the frame of the system.
    let (frame, y, content) = unsafe { (frame::<S>(user_data), numbers::<S>(y), content::<S>(a)) };
    (content.diagonal, content.scale) = (0.0, -1.0);
    let made = frame
        .guard
        .run(|| frame.system.linearise(y, &mut content.matrix));
    match made {
        None => FATAL,
        Some(()) => GOOD,
    }
}
