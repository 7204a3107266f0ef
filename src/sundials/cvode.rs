//! CVODES: dy/dt = f(y) by BDF or Adams formulas of variable order and step, with an analytic Jacobian.
#![allow(unsafe_code)]

use super::callback::{self, Problem, Slot, UserData, all_finite};
use super::linear_solver::{LinearSolver, Matrix};
use super::sensitivity::SensitivityVectors;
use super::vector::{NVector, OwnVectors, Serial};
use super::{Context, Messages, Stable, check, failure, flags, native, null};
use crate::contract::{MAX_STEPS, Tolerances};
use crate::error::{Error, Result};
use crate::field::State;
use std::ffi::{c_int, c_long, c_void};
use std::ptr::NonNull;

/// The family of formulas.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MultistepMethod {
    /// Backward differentiation, orders 1 to 5: for stiff systems.
    Bdf,
    /// Adams-Moulton, orders 1 to 12: cheaper where the system is not stiff, here along stick-slip cycles.
    Adams,
}

/// Whose vector operations and linear solver are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Operations {
    /// Ours, of fixed length.
    #[default]
    Fixed,
    /// SUNDIALS's serial vectors and dense direct solver: about twice as slow; kept for comparison.
    Stock,
}

/// When [`Cvode::advance`] returns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// At the time asked for, by interpolation from a step that may reach beyond.
    Normal,
    /// After every step.
    OneStep,
}

/// Why [`Cvode::advance`] returned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The time asked for is reached.
    Time,
    /// A step is done ([`Mode::OneStep`]).
    Step,
    /// The stop time is reached, exactly.
    StopTime,
    /// An event function has a zero here; [`Cvode::events_found`] says which.
    Event,
    /// Success with a warning: a positive flag other than these.
    Warning(i32),
}

/// Where [`Cvode::advance`] returned, and why.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Arrival {
    /// Time of [`Cvode::state`].
    pub t: f64,
    /// Why there.
    pub reason: Reason,
}

/// Steps between two looks at whether t still advances. Before a singularity, or a point beyond which f is not finite, the
/// steps shrink forever, and CVODE would burn the whole bound on work there.
const WATCH: usize = 50;

/// Steps in a row that may leave t where it is. At the start of a stiff problem there are some, until the steps have grown.
const STANDSTILL: usize = 200;

/// The owner of a CVODES memory.
pub(super) struct CvodeMemory(NonNull<c_void>);

impl CvodeMemory {
    pub(super) fn new(method: MultistepMethod, context: &Context) -> Result<Self> {
        let lmm = match method {
            MultistepMethod::Bdf => sundials_sys::CV_BDF,
            MultistepMethod::Adams => sundials_sys::CV_ADAMS,
        };
        // SAFETY: a live context, which the solver keeps longer.
        let memory = unsafe { sundials_sys::CVodeCreate(lmm, context.as_ptr()) };
        Ok(CvodeMemory(
            NonNull::new(memory).ok_or_else(|| null("CVodeCreate"))?,
        ))
    }

    pub(super) fn as_ptr(&self) -> *mut c_void {
        self.0.as_ptr()
    }
}

impl Drop for CvodeMemory {
    fn drop(&mut self) {
        let mut memory = self.as_ptr();
        // SAFETY: a live memory that this value alone owns.
        unsafe { sundials_sys::CVodeFree(&mut memory) };
    }
}

/// An integrator of N equations. Reuse it: [`Cvode::start`] is a hundred times cheaper than making one.
///
/// ```
/// use twinslip::field::{Jacobian, State, VectorField};
/// use twinslip::integrate::Tolerances;
/// use twinslip::sundials::{Cvode, Mode, MultistepMethod, Operations, Problem, Reason};
/// struct Decay;
/// impl VectorField<1> for Decay {
///     fn f(&self, y: &State<1>) -> State<1> { -y }
///     fn jacobian(&self, _: &State<1>) -> Jacobian<1> { Jacobian::<1>::new(-1.0) }
///     fn second_derivative(&self, _: &State<1>, _: &State<1>, _: &State<1>) -> State<1> { State::zeros() }
/// }
/// # fn main() -> twinslip::Result<()> {
/// let mut cvode = Cvode::<1>::new(MultistepMethod::Bdf, Operations::Fixed)?;
/// cvode.set_tolerances(Tolerances::equal(1e-10)?)?;
/// cvode.start(0.0, &State::<1>::new(1.0))?;
/// let arrival = cvode.advance(&Problem::new(&Decay), 2.0, Mode::Normal)?;
/// assert_eq!((arrival.t, arrival.reason), (2.0, Reason::Time));
/// assert!((cvode.state()[0] - (-2.0_f64).exp()).abs() < 1e-8);
/// # Ok(())
/// # }
/// ```
pub struct Cvode<const N: usize> {
    // In the order in which they must go.
    pub(super) memory: CvodeMemory,
    _solver: LinearSolver,
    _matrix: Matrix,
    pub(super) state: NVector,
    pub(super) dense: NVector,
    pub(super) columns: Option<SensitivityVectors>,
    pub(super) context: Context,
    slot: Stable<Slot>,
    pub(super) messages: Stable<Messages>,
    pub(super) operations: Operations,
    pub(super) tolerances: Tolerances,
    // Whether CVODES has a tolerance for each variable instead of those given.
    pub(super) has_vector_tolerances: bool,
    max_steps: usize,
    pub(super) start: f64,
    pub(super) stop_time: Option<f64>,
    // What CVODES was told, where it still knows: it forgets a stop time when it has reached it.
    pub(super) armed: Option<Option<f64>>,
    pub(super) event_count: usize,
    // Steps in a row that did not change t, and the state at the first of them.
    pub(super) stalled: usize,
    standstill: State<N>,
    pub(super) tangents: usize,
    watched: usize,
}

// SAFETY: a solver owns its context and everything made from it, shares nothing with other solvers, and SUNDIALS keeps no
// thread-local state; it may be used from any one thread at a time. Frames with borrowed user code live in `advance` only.
unsafe impl<const N: usize> Send for Cvode<N> {}

impl<const N: usize> Cvode<N> {
    /// With tolerances of 1e-8, [`MAX_STEPS`], no stop time and no events; [`Cvode::start`] comes next.
    ///
    /// # Errors
    /// [`Error::Sundials`] if SUNDIALS can't allocate, or is not of the version of its headers.
    pub fn new(method: MultistepMethod, operations: Operations) -> Result<Self> {
        let messages = Stable::new(Messages::default());
        let slot = Stable::new(Slot::new());
        let context = Context::new(&messages)?;
        let state = vector::<N>(operations, &context)?;
        let dense = vector::<N>(operations, &context)?;
        let (matrix, solver) = match operations {
            Operations::Fixed => (
                Matrix::fixed::<N>(&context)?,
                LinearSolver::fixed::<N>(&context)?,
            ),
            Operations::Stock => {
                let matrix = Matrix::dense::<N>(&context)?;
                let solver = LinearSolver::dense(&context, &state, &matrix)?;
                (matrix, solver)
            }
        };
        let memory = CvodeMemory::new(method, &context)?;
        let tolerances = Tolerances {
            rtol: 1e-8,
            atol: 1e-8,
            max_step: f64::INFINITY,
        };
        let m = memory.as_ptr();
        // SAFETY: live objects of one context, kept by the solver longer than the memory; the callbacks are of this N and of
        // the storage of these vectors and matrix, and the user data are the slot, whose address never changes.
        unsafe {
            native::keep_cvode_messages(m, &messages)?;
            // Before everything that copies the user data.
            check!(CV, &messages, CVodeSetUserData(m, slot.as_ptr()))?;
            let f = match operations {
                Operations::Fixed => callback::right_hand_side::<OwnVectors, N>,
                Operations::Stock => callback::right_hand_side::<Serial, N>,
            };
            check!(CV, &messages, CVodeInit(m, Some(f), 0.0, state.as_ptr()))?;
            check!(
                CV,
                &messages,
                CVodeSStolerances(m, tolerances.rtol, tolerances.atol)
            )?;
            // Steps below the spacing of t are watched for here, and not worth a message.
            check!(CV, &messages, CVodeSetMaxHnilWarns(m, -1))?;
            check!(
                CVLS,
                &messages,
                CVodeSetLinearSolver(m, solver.as_ptr(), matrix.as_ptr())
            )?;
            match operations {
                Operations::Fixed => check!(
                    CVLS,
                    &messages,
                    CVodeSetLinSysFn(m, Some(callback::linear_system::<N>))
                )?,
                Operations::Stock => check!(
                    CVLS,
                    &messages,
                    CVodeSetJacFn(m, Some(callback::dense_jacobian::<Serial, N>))
                )?,
            };
        }
        Ok(Cvode {
            memory,
            _solver: solver,
            _matrix: matrix,
            state,
            dense,
            columns: None,
            context,
            slot,
            messages,
            operations,
            tolerances,
            has_vector_tolerances: false,
            max_steps: MAX_STEPS,
            start: 0.0,
            stop_time: None,
            armed: None,
            event_count: 0,
            stalled: 0,
            standstill: State::zeros(),
            tangents: 0,
            watched: 0,
        })
    }

    /// Tolerances of the state, and of sensitivities that have none of their own, from the next [`Cvode::start`] on.
    ///
    /// # Errors
    /// [`Error::Sundials`] if CVODES refuses them.
    pub fn set_tolerances(&mut self, tolerances: Tolerances) -> Result<()> {
        let m = self.memory.as_ptr();
        // SAFETY: a live memory.
        unsafe {
            check!(
                CV,
                &self.messages,
                CVodeSStolerances(m, tolerances.rtol, tolerances.atol)
            )?;
            // To CVODES none is 0.
            let max_step = if tolerances.max_step.is_finite() {
                tolerances.max_step
            } else {
                0.0
            };
            check!(CV, &self.messages, CVodeSetMaxStep(m, max_step))?;
        }
        self.tolerances = tolerances;
        self.has_vector_tolerances = false;
        Ok(())
    }

    /// Bound on the steps from one [`Cvode::start`] to the next.
    pub fn set_max_steps(&mut self, max_steps: usize) {
        self.max_steps = max_steps;
    }

    /// Failures of the error test, and failures of Newton's iteration, that one step may have before it is given up; CVODES's
    /// own choice is 7 and 10. More let the step shrink farther before the integration fails.
    ///
    /// # Errors
    /// [`Error::Sundials`] if CVODES refuses the number.
    pub fn set_max_failures(&mut self, failures: u16) -> Result<()> {
        let m = self.memory.as_ptr();
        // SAFETY: a live memory.
        unsafe {
            check!(
                CV,
                &self.messages,
                CVodeSetMaxErrTestFails(m, c_int::from(failures))
            )?;
            check!(
                CV,
                &self.messages,
                CVodeSetMaxConvFails(m, c_int::from(failures))
            )?;
        }
        Ok(())
    }

    /// A time beyond which f is never evaluated and at which [`Cvode::advance`] returns; `None` for none.
    pub fn set_stop_time(&mut self, t: Option<f64>) {
        self.stop_time = t;
    }

    /// Integrates towards `to`, and says where and why it stopped. The field must be the one of the last calls since
    /// [`Cvode::start`].
    ///
    /// # Errors
    /// [`Error::Sundials`] with the flag's name and the time; [`Error::StepTooSmall`] where steps no longer change t;
    /// [`Error::WrongTime`] if CVODES succeeds elsewhere; [`Error::NonFinite`] where f is not finite and can't be avoided;
    /// [`Error::Input`] for watched events without event functions. A panic of the user's code goes on here.
    pub fn advance(&mut self, problem: &Problem<'_, N>, to: f64, mode: Mode) -> Result<Arrival> {
        if self.event_count > 0 && problem.events.is_none() {
            return Err(Error::Input(
                "events are watched, but the problem has no event functions".to_owned(),
            ));
        }
        if !to.is_finite() {
            return Err(Error::parameter("time", to, "finite"));
        }
        self.arm_stop_time(to)?;
        if self.steps()? == 0 {
            self.set_absolute_tolerances(problem)?;
            self.set_first_step(problem, to)?;
        }
        let frame = UserData::new(*problem, self.event_count);
        loop {
            let before = self.steps()?;
            let left = self.max_steps.saturating_sub(before);
            let (t, code) = if left == 0 {
                self.messages
                    .keep("the bound on steps had been used up before");
                (self.time()?, sundials_sys::CV_TOO_MUCH_WORK)
            } else {
                // The end of a portion is no failure, the end of the bound is.
                let expected = if left > WATCH {
                    sundials_sys::CV_TOO_MUCH_WORK
                } else {
                    sundials_sys::CV_SUCCESS
                };
                self.messages.expected.set(expected);
                self.enter(&frame, to, mode, left.min(WATCH))?
            };
            self.tangents += frame.tangents.take();
            frame.guard.resume();
            match code {
                // A return to look at the step, not the end of the bound.
                sundials_sys::CV_TOO_MUCH_WORK if self.steps()? < self.max_steps => {
                    let h = self.step_size()?;
                    if self.stands_still(t, h, WATCH) {
                        return Err(Error::StepTooSmall { t, h });
                    }
                }
                code if code < 0 => return Err(self.explain(code, t, &frame)),
                code => return self.arrived(t, code, to, mode),
            }
        }
    }

    /// One stay in C, of at most `steps` steps: the time reached and the flag.
    fn enter(
        &mut self,
        frame: &UserData<'_, N>,
        to: f64,
        mode: Mode,
        steps: usize,
    ) -> Result<(f64, c_int)> {
        let m = self.memory.as_ptr();
        if self.watched != steps {
            // SAFETY: a live memory.
            unsafe { check!(CV, &self.messages, CVodeSetMaxNumSteps(m, steps as c_long))? };
            self.watched = steps;
        }
        self.messages.clear();
        let task = match mode {
            Mode::Normal => sundials_sys::CV_NORMAL,
            Mode::OneStep => sundials_sys::CV_ONE_STEP,
        };
        let mut t = self.start;
        let entered = self.slot.enter(frame);
        // SAFETY: a live memory that `new` has set up, a live vector like the one it was given, and a place for the time.
        let code = unsafe { sundials_sys::CVode(m, to, self.state.as_ptr(), &mut t, task) };
        drop(entered);
        self.messages.expected.set(sundials_sys::CV_SUCCESS);
        Ok((t, code))
    }

    fn arrived(&mut self, t: f64, code: c_int, to: f64, mode: Mode) -> Result<Arrival> {
        let reason = match (code, mode) {
            (sundials_sys::CV_SUCCESS, Mode::Normal) => Reason::Time,
            (sundials_sys::CV_SUCCESS, Mode::OneStep) => Reason::Step,
            (sundials_sys::CV_TSTOP_RETURN, _) => Reason::StopTime,
            (sundials_sys::CV_ROOT_RETURN, _) => Reason::Event,
            (code, _) => Reason::Warning(code),
        };
        match reason {
            Reason::Time if t != to => {
                return Err(Error::WrongTime {
                    asked: to,
                    returned: t,
                });
            }
            Reason::StopTime => self.armed = None,
            _ => {}
        }
        let h = self.step_size()?;
        if h == 0.0 {
            return Err(Error::WrongTime {
                asked: to,
                returned: t,
            });
        }
        if reason == Reason::Step && self.stands_still(t, h, 1) {
            return Err(Error::StepTooSmall { t, h });
        }
        if !all_finite(self.state().as_slice()) {
            return Err(Error::NonFinite {
                what: "the state",
                t,
            });
        }
        Ok(Arrival { t, reason })
    }

    /// Whether t has stood still for too long. The state is then that of the first such step: later ones at the same t have
    /// followed a singularity to where numbers mean nothing.
    fn stands_still(&mut self, t: f64, h: f64, steps: usize) -> bool {
        if t + h != t {
            self.stalled = 0;
            return false;
        }
        if self.stalled == 0 {
            self.standstill = self.state();
        }
        self.stalled += steps;
        let too_long = self.stalled >= STANDSTILL;
        if too_long {
            self.state.set(&self.standstill);
        }
        too_long
    }

    fn explain(&self, code: c_int, t: f64, frame: &UserData<'_, N>) -> Error {
        use sundials_sys::{
            CV_CONV_FAILURE, CV_FIRST_RHSFUNC_ERR, CV_FIRST_SRHSFUNC_ERR, CV_REPTD_RHSFUNC_ERR,
            CV_REPTD_SRHSFUNC_ERR, CV_RTFUNC_FAIL, CV_UNREC_RHSFUNC_ERR, CV_UNREC_SRHSFUNC_ERR,
        };
        const OF_USER_CODE: [c_int; 8] = [
            // What a Jacobian that is never finite ends in.
            CV_CONV_FAILURE,
            CV_FIRST_RHSFUNC_ERR,
            CV_FIRST_SRHSFUNC_ERR,
            CV_REPTD_RHSFUNC_ERR,
            CV_REPTD_SRHSFUNC_ERR,
            CV_UNREC_RHSFUNC_ERR,
            CV_UNREC_SRHSFUNC_ERR,
            CV_RTFUNC_FAIL,
        ];
        match frame.guard.not_finite() {
            Some(what) if OF_USER_CODE.contains(&code) => Error::NonFinite { what, t },
            _ => failure(flags::CV, "CVode", code, Some(t), &self.messages),
        }
    }
}

pub(super) fn vector<const N: usize>(operations: Operations, context: &Context) -> Result<NVector> {
    match operations {
        Operations::Fixed => NVector::fixed::<N>(context),
        Operations::Stock => NVector::serial::<N>(context),
    }
}
