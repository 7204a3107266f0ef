//! CVODE for a system in linear time, step by step.
#![allow(unsafe_code)]

use super::solver::{content, matrix, solver};
use super::vector::{numbers, numbers_mut, vector};
use super::{Frame, LinearTime, frame};
use crate::contract::Work;
use crate::error::{Error, Result};
use crate::sundials::callback::{FATAL, GOOD, all_finite};
use crate::sundials::cvode::{CvodeMemory, MultistepMethod};
use crate::sundials::linear_solver::{LinearSolver, Matrix};
use crate::sundials::vector::NVector;
use crate::sundials::{Context, Messages, Stable, check, failure, flags, native};
use std::ffi::{c_int, c_void};
use sundials_sys::{N_Vector, SUNMatrix};

/// Steps in a row that may leave t where it is.
const STANDSTILL: usize = 200;

/// An integration by BDF of orders 1 to 5.
pub(crate) struct LargeCvode<S: LinearTime> {
    // In the order in which they must go.
    memory: CvodeMemory,
    _solver: LinearSolver,
    _matrix: Matrix,
    state: NVector,
    dense: NVector,
    _context: Context,
    frame: Stable<Frame<S>>,
    messages: Stable<Messages>,
    time: f64,
    until: f64,
    /// Steps in a row that did not change t.
    stalled: usize,
}

impl<S: LinearTime> LargeCvode<S> {
    /// From y0 at a time towards another, with this first step.
    ///
    /// # Errors
    /// [`Error::Sundials`] if SUNDIALS can't allocate, or is not of the version of its headers.
    pub fn new(
        system: S,
        y0: Vec<f64>,
        (from, until): (f64, f64),
        first_step: f64,
    ) -> Result<Self> {
        let messages = Stable::new(Messages::default());
        let frame = Stable::new(Frame::new(system));
        let context = Context::new(&messages)?;
        let dense = vector(&context, &frame.system, vec![0.0; y0.len()])?;
        let state = vector(&context, &frame.system, y0)?;
        let matrix = matrix::<S>(&context)?;
        let solver = solver(&context, &*frame)?;
        let memory = CvodeMemory::new(MultistepMethod::Bdf, &context)?;
        let m = memory.as_ptr();
        // SAFETY: live objects of one context, kept by the solver longer than the memory; the callbacks are of this system, whose frame's
        // address never changes.
        unsafe {
            native::keep_cvode_messages(m, &messages)?;
            // Before everything that copies the user data.
            check!(CV, &messages, CVodeSetUserData(m, frame.as_ptr()))?;
            check!(
                CV,
                &messages,
                CVodeInit(m, Some(right_hand_side::<S>), from, state.as_ptr())
            )?;
            check!(CV, &messages, CVodeWFtolerances(m, Some(weights::<S>)))?;
            check!(CV, &messages, CVodeSetMaxHnilWarns(m, -1))?;
            check!(CV, &messages, CVodeSetStopTime(m, until))?;
            check!(CV, &messages, CVodeSetInitStep(m, first_step))?;
            check!(
                CVLS,
                &messages,
                CVodeSetLinearSolver(m, solver.as_ptr(), matrix.as_ptr())
            )?;
            check!(
                CVLS,
                &messages,
                CVodeSetLinSysFn(m, Some(linear_system::<S>))
            )?;
        }
        Ok(LargeCvode {
            memory,
            _solver: solver,
            _matrix: matrix,
            state,
            dense,
            _context: context,
            frame,
            messages,
            time: from,
            until,
            stalled: 0,
        })
    }

    /// The system.
    pub fn system(&self) -> &S {
        &self.frame.system
    }

    /// One step; it ends at the end exactly.
    ///
    /// # Errors
    /// [`Error::Sundials`] with the flag's name and the time; [`Error::StepTooSmall`] where steps no longer change t; [`Error::NonFinite`]
    /// where f is not finite and can't be avoided. A panic of the system's code goes on here.
    pub fn step(&mut self) -> Result<f64> {
        let m = self.memory.as_ptr();
        self.messages.clear();
        let mut t = self.time;
        // SAFETY: a live memory that `new` has set up, a live vector like the one it was given, and a place for the time.
        let code = unsafe {
            let task = sundials_sys::CV_ONE_STEP;
            sundials_sys::CVode(m, self.until, self.state.as_ptr(), &mut t, task)
        };
        self.frame.guard.resume();
        if code < 0 {
            return Err(match self.frame.guard.not_finite() {
                Some(what) => Error::NonFinite { what, t },
                None => failure(flags::CV, "CVode", code, Some(t), &self.messages),
            });
        }
        if t > self.time {
            self.stalled = 0;
        } else {
            self.stalled += 1;
            if self.stalled >= STANDSTILL {
                return Err(Error::StepTooSmall {
                    t,
                    h: t - self.time,
                });
            }
        }
        self.time = t;
        if !all_finite(self.state()) {
            let what = "the state";
            return Err(Error::NonFinite { what, t });
        }
        Ok(t)
    }

    /// The time where the last step ended.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The state where the last step ended.
    pub fn state(&self) -> &[f64] {
        // SAFETY: a live vector of this system, which only `step` writes to, exclusively.
        unsafe { numbers::<S>(self.state.as_ptr()) }
    }

    /// The state at a time within the last step.
    ///
    /// # Errors
    /// [`Error::Sundials`] with `CV_BAD_T` outside it.
    pub fn dense(&self, t: f64, state: &mut [f64]) -> Result<()> {
        let m = self.memory.as_ptr();
        // SAFETY: a live memory and a vector like the one it was given; nothing else reads or writes it meanwhile, since the solver is
        // not Sync and no reference into the vector is given away.
        unsafe {
            check!(
                CV,
                &self.messages,
                CVodeGetDky(m, t, 0, self.dense.as_ptr())
            )?;
            state.copy_from_slice(numbers::<S>(self.dense.as_ptr()));
        }
        Ok(())
    }

    /// The work so far.
    ///
    /// # Errors
    /// [`Error::Sundials`] before the first step.
    pub fn work(&self) -> Result<Work> {
        self.memory.work(&self.messages)
    }
}

/// f(y).
///
/// # Safety
/// As CVODE calls it, for a solver of this system.
unsafe extern "C" fn right_hand_side<S: LinearTime>(
    _t: f64,
    y: N_Vector,
    dy: N_Vector,
    user_data: *mut c_void,
) -> c_int {
    // SAFETY: CVODE passes live vectors, which are not the same, and the frame of the system.
    let (frame, y, dy) = unsafe { (frame::<S>(user_data), numbers::<S>(y), numbers_mut::<S>(dy)) };
    let made = frame.guard.run(|| {
        frame.system.rates(y, dy);
        // All processes must take the same way.
        let own = if all_finite(dy) { 0.0 } else { f64::NAN };
        frame.system.largest(own).is_finite()
    });
    match made {
        None => FATAL,
        Some(false) => frame.guard.refuse("the right-hand side"),
        Some(true) => GOOD,
    }
}

/// # Safety
/// As CVODE calls it, for a solver of this system.
unsafe extern "C" fn weights<S: LinearTime>(
    y: N_Vector,
    weights: N_Vector,
    user_data: *mut c_void,
) -> c_int {
    // SAFETY: CVODE passes live vectors, which are not the same, and the frame of the system.
    let (frame, y, weights) = unsafe {
        (
            frame::<S>(user_data),
            numbers::<S>(y),
            numbers_mut::<S>(weights),
        )
    };
    match frame.guard.run(|| frame.system.weights(y, weights)) {
        None => FATAL,
        Some(()) => GOOD,
    }
}

/// I - gamma J = gamma (1/gamma I - J), with J(y) new only if CVODE asks for it.
///
/// # Safety
/// As CVODE calls it, for a solver of this system.
unsafe extern "C" fn linear_system<S: LinearTime>(
    _t: f64,
    y: N_Vector,
    _fy: N_Vector,
    a: SUNMatrix,
    keep: c_int,
    current: *mut c_int,
    gamma: f64,
    user_data: *mut c_void,
    _: N_Vector,
    _: N_Vector,
    _: N_Vector,
) -> c_int {
    // SAFETY: CVODE passes live objects like those it was given at first, the frame of the system, and a place for the flag.
    let (frame, y, content) = unsafe {
        *current = c_int::from(keep == 0);
        (frame::<S>(user_data), numbers::<S>(y), content::<S>(a))
    };
    (content.diagonal, content.scale) = (1.0 / gamma, gamma);
    if keep == 0 {
        let made = frame
            .guard
            .run(|| frame.system.linearise(y, &mut content.matrix));
        if made.is_none() {
            return FATAL;
        }
    }
    GOOD
}
