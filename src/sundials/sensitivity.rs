//! Forward sensitivities of CVODES: columns s with ds/dt = J s + df/dp, integrated beside the state.
#![allow(unsafe_code)]

use super::callback::{self, all_finite};
use super::cvode::{Cvode, Operations, vector};
use super::vector::{NVector, OwnVectors, Serial};
use super::{Context, Messages, check, counted, failure, flags};
use crate::contract::Tolerances;
use crate::error::{Error, Result};
use crate::field::State;
use std::ffi::c_int;
use sundials_sys::N_Vector;

/// How the nonlinear systems of state and sensitivities are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SensitivityMethod {
    /// In one iteration (CV_SIMULTANEOUS).
    #[default]
    Simultaneous,
    /// The state first, then all sensitivities (CV_STAGGERED).
    Staggered,
}

impl SensitivityMethod {
    fn flag(self) -> c_int {
        match self {
            SensitivityMethod::Simultaneous => sundials_sys::CV_SIMULTANEOUS,
            SensitivityMethod::Staggered => sundials_sys::CV_STAGGERED,
        }
    }
}

/// Whether sensitivities take part in the error test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ErrorControl {
    /// They do.
    #[default]
    Full,
    /// They don't, which is what CVODES does unless told otherwise. Steps then fit the state alone, and sensitivities along
    /// stick-slip cycles have come out wrong by a factor of thousands, without a word.
    OffAndWrongWithoutWarning,
}

/// How sensitivities are integrated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sensitivity {
    /// Together with the state or after it.
    pub scheme: SensitivityMethod,
    /// Their own tolerances; `None` for those of the state.
    pub tolerances: Option<Tolerances>,
    /// Leave it on.
    pub error_control: ErrorControl,
}

/// The vectors of the sensitivities.
pub(super) struct SensitivityVectors {
    vectors: Vec<NVector>,
    // What C reads: the same vectors.
    pointers: Vec<N_Vector>,
}

impl SensitivityVectors {
    fn new<const N: usize>(
        count: usize,
        operations: Operations,
        context: &Context,
    ) -> Result<Self> {
        let vectors = (0..count)
            .map(|_| vector::<N>(operations, context))
            .collect::<Result<Vec<_>>>()?;
        let pointers = vectors.iter().map(NVector::as_ptr).collect();
        Ok(SensitivityVectors { vectors, pointers })
    }

    fn get<const N: usize>(&self, t: f64) -> Result<Vec<State<N>>> {
        let columns: Vec<State<N>> = self.vectors.iter().map(NVector::get).collect();
        if columns.iter().all(|s| all_finite(s.as_slice())) {
            Ok(columns)
        } else {
            Err(Error::NonFinite {
                what: "a sensitivity",
                t,
            })
        }
    }
}

/// The error for sensitivities that were never started: CVODES then says that all none of them were got.
fn none(function: &'static str, messages: &Messages) -> Error {
    let code = sundials_sys::CV_NO_SENS;
    messages.keep("no sensitivities were started");
    failure(flags::CV, function, code, None, messages)
}

impl<const N: usize> Cvode<N> {
    /// Begins at `y0` with sensitivities that begin at `columns`: the columns of the unit matrix for those of the initial
    /// state, zero for that of a parameter, whose df/dp the [`super::Problem`] then gives.
    ///
    /// # Errors
    /// [`Error::NonFinite`] if a number is not finite, [`Error::Input`] if there is no column, [`Error::Parameter`] if there
    /// are more than C can count.
    pub fn start_with_sensitivities(
        &mut self,
        t0: f64,
        y0: &State<N>,
        columns: &[State<N>],
        settings: &Sensitivity,
    ) -> Result<()> {
        if columns.is_empty() {
            return Err(Error::Input("sensitivities of nothing".to_owned()));
        }
        if !columns.iter().all(|s| all_finite(s.as_slice())) {
            return Err(Error::NonFinite {
                what: "an initial sensitivity",
                t: t0,
            });
        }
        let count = counted("the number of sensitivities", columns.len())?;
        self.restart(t0, y0)?;
        let reuse = self
            .columns
            .as_ref()
            .is_some_and(|c| c.vectors.len() == columns.len());
        if !reuse {
            self.free_sensitivities();
        }
        if self.columns.is_none() {
            let made = SensitivityVectors::new::<N>(columns.len(), self.operations, &self.context)?;
            self.columns = Some(made);
        }
        let kept = self.columns.as_mut().expect("made above");
        for (vector, column) in kept.vectors.iter_mut().zip(columns) {
            vector.set(column);
        }
        let ism = settings.scheme.flag();
        let pointers = kept.pointers.as_mut_ptr();
        let m = self.memory.as_ptr();
        let messages = &self.messages;
        // SAFETY: a live memory; the array holds as many live vectors as announced, which CVODES copies; the callback is of
        // this N and storage.
        unsafe {
            if reuse {
                check!(CV, messages, CVodeSensReInit(m, ism, pointers))?;
            } else {
                let f = match self.operations {
                    Operations::Fixed => callback::sensitivity_right_hand_side::<OwnVectors, N>,
                    Operations::Stock => callback::sensitivity_right_hand_side::<Serial, N>,
                };
                let begun = check!(
                    CV,
                    messages,
                    CVodeSensInit(m, count, ism, Some(f), pointers)
                );
                if begun.is_err() {
                    // CVODES has none then, and must not be asked to go on with them.
                    self.columns = None;
                }
                begun?;
            }
        }
        self.set_sensitivity_tolerances(columns.len(), settings)
    }

    fn set_sensitivity_tolerances(&mut self, count: usize, settings: &Sensitivity) -> Result<()> {
        let tolerances = settings.tolerances.unwrap_or(self.tolerances);
        let mut atol = vec![tolerances.atol; count];
        let full = c_int::from(settings.error_control == ErrorControl::Full);
        let m = self.memory.as_ptr();
        let messages = &self.messages;
        // SAFETY: a live memory; CVODES copies the `count` absolute tolerances.
        unsafe {
            check!(
                CV,
                messages,
                CVodeSensSStolerances(m, tolerances.rtol, atol.as_mut_ptr())
            )?;
            // Off unless set: the trap that `ErrorControl` names.
            check!(CV, messages, CVodeSetSensErrCon(m, full))?;
        }
        Ok(())
    }

    /// The sensitivities where [`Cvode::advance`] last returned.
    ///
    /// # Errors
    /// [`Error::Sundials`] with `CV_NO_SENS` if there are none, [`Error::NonFinite`].
    pub fn sensitivities(&mut self) -> Result<Vec<State<N>>> {
        let mut t = 0.0;
        let m = self.memory.as_ptr();
        let messages = &self.messages;
        let Some(columns) = &mut self.columns else {
            return Err(none("CVodeGetSens", messages));
        };
        let pointers = columns.pointers.as_mut_ptr();
        // SAFETY: a live memory, a place for the time, and as many live vectors as there are sensitivities.
        unsafe { check!(CV, messages, CVodeGetSens(m, &mut t, pointers))? };
        columns.get(t)
    }

    /// The continuous sensitivities at `t`, which must be within the last step.
    ///
    /// # Errors
    /// [`Error::Sundials`] with `CV_BAD_T` outside it, with `CV_NO_SENS` if there are none; [`Error::NonFinite`].
    pub fn dense_sensitivities(&mut self, t: f64) -> Result<Vec<State<N>>> {
        // CVodeGetSensDky prints a time outside the step with arguments that it forgets to pass (6.4.1, 7.1.1); CVodeGetDky tests the
        // same bounds and does not.
        self.dense(t)?;
        let m = self.memory.as_ptr();
        let messages = &self.messages;
        let Some(columns) = &mut self.columns else {
            return Err(none("CVodeGetSensDky", messages));
        };
        let pointers = columns.pointers.as_mut_ptr();
        // SAFETY: as in `sensitivities`.
        unsafe { check!(CV, messages, CVodeGetSensDky(m, t, 0, pointers))? };
        columns.get(t)
    }

    /// Goes on without sensitivities; their memory stays for the next start with as many.
    pub(super) fn forget_sensitivities(&mut self) -> Result<()> {
        if self.columns.is_some() {
            let m = self.memory.as_ptr();
            // SAFETY: a live memory.
            unsafe { check!(CV, &self.messages, CVodeSensToggleOff(m))? };
        }
        Ok(())
    }

    fn free_sensitivities(&mut self) {
        if self.columns.take().is_some() {
            // SAFETY: a live memory; it keeps no pointer to our vectors.
            unsafe { sundials_sys::CVodeSensFree(self.memory.as_ptr()) };
        }
    }
}
