//! KINSOL: F(u) = 0 by Newton's method with an analytic Jacobian, with or without line search.
#![allow(unsafe_code)]

use super::callback::{self, ResidualFrame, Slot};
use super::linear_solver::{LinearSolver, Matrix};
use super::vector::NVector;
use super::{Context, Messages, Stable, check, failure, flags, native, null};
use crate::error::{Error, Result};
use crate::field::{Jacobian, State};
use std::ffi::{c_int, c_long, c_void};
use std::ptr::NonNull;

/// F(u) and dF/du.
///
/// ```
/// use twinslip::field::{Jacobian, State};
/// use twinslip::sundials::{Kinsol, Residual};
/// struct SquareRoot(f64);
/// impl Residual<1> for SquareRoot {
///     fn residual(&self, u: &State<1>) -> State<1> { State::<1>::new(u[0] * u[0] - self.0) }
///     fn jacobian(&self, u: &State<1>) -> Jacobian<1> { Jacobian::<1>::new(2.0 * u[0]) }
/// }
/// # fn main() -> twinslip::Result<()> {
/// let one = State::<1>::new(1.0);
/// let root = Kinsol::<1>::new()?.solve(&SquareRoot(2.0), &one, &one, &one)?;
/// assert!((root[0] - 2.0_f64.sqrt()).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
pub trait Residual<const N: usize> {
    /// F(u). May be non-finite outside its domain: the step is then shortened.
    fn residual(&self, u: &State<N>) -> State<N>;

    /// dF/du.
    fn jacobian(&self, u: &State<N>) -> Jacobian<N>;
}

/// How far a Newton step is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Strategy {
    /// As far as the residual decreases enough (KIN_LINESEARCH).
    #[default]
    LineSearch,
    /// All the way (KIN_NONE).
    Newton,
}

impl Strategy {
    pub(super) fn flag(self) -> c_int {
        match self {
            Strategy::LineSearch => sundials_sys::KIN_LINESEARCH as c_int,
            Strategy::Newton => sundials_sys::KIN_NONE as c_int,
        }
    }
}

/// The sign that an unknown must keep at every iterate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Constraint {
    /// Any.
    #[default]
    Free,
    /// u > 0.
    Positive,
    /// u >= 0.
    NonNegative,
    /// u <= 0.
    NonPositive,
    /// u < 0.
    Negative,
}

impl Constraint {
    fn code(self) -> f64 {
        match self {
            Constraint::Free => 0.0,
            Constraint::Positive => 2.0,
            Constraint::NonNegative => 1.0,
            Constraint::NonPositive => -1.0,
            Constraint::Negative => -2.0,
        }
    }
}

/// What [`Kinsol::solve`] is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KinsolSettings<const N: usize> {
    /// Line search or plain Newton.
    pub strategy: Strategy,
    /// Solved when the largest component of `f_scale * F(u)` is at most this.
    pub residual_tolerance: f64,
    /// A step whose largest component relative to u is at most this ends the iteration.
    pub step_tolerance: f64,
    /// Bound on Newton iterations.
    pub max_iterations: usize,
    /// Iterations for which a Jacobian is used; 1 is Newton's method proper.
    pub jacobian_lifetime: usize,
    /// Longest step in the norm of `u_scale * u`; `None` leaves it to KINSOL.
    pub longest_step: Option<f64>,
    /// Signs to keep.
    pub constraints: [Constraint; N],
}

impl<const N: usize> Default for KinsolSettings<N> {
    fn default() -> Self {
        KinsolSettings {
            strategy: Strategy::default(),
            residual_tolerance: 1e-12,
            step_tolerance: 1e-14,
            max_iterations: 200,
            jacobian_lifetime: 1,
            longest_step: None,
            constraints: [Constraint::Free; N],
        }
    }
}

/// How an iteration ended that KINSOL calls successful.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The residual tolerance is met.
    Converged,
    /// The guess met it.
    GuessWasSolution,
    /// The steps became small before the residual did: a root to rounding, or no root.
    SmallStep,
    /// The bound on iterations was reached.
    IterationLimit,
}

/// What a solution cost.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct KinsolWork {
    /// Newton iterations.
    pub iterations: usize,
    /// Evaluations of F.
    pub residuals: usize,
    /// Evaluations of dF/du.
    pub jacobians: usize,
    /// Shortenings of a step by the line search.
    pub backtracks: usize,
    /// Euclidean norm of `f_scale * F(u)` at the end.
    pub residual_norm: f64,
}

impl Outcome {
    /// What a return code of KINSol says; `None` if it failed.
    pub(super) fn of(code: c_int) -> Option<Self> {
        match code {
            sundials_sys::KIN_SUCCESS => Some(Outcome::Converged),
            sundials_sys::KIN_INITIAL_GUESS_OK => Some(Outcome::GuessWasSolution),
            sundials_sys::KIN_MAXITER_REACHED => Some(Outcome::IterationLimit),
            code if code < 0 => None,
            _ => Some(Outcome::SmallStep),
        }
    }
}

/// The owner of a KINSOL memory.
pub(super) struct KinsolMemory(NonNull<c_void>);

impl KinsolMemory {
    pub fn new(context: &Context) -> Result<Self> {
        // SAFETY: a live context, which the solver keeps longer.
        let memory = unsafe { sundials_sys::KINCreate(context.as_ptr()) };
        Ok(KinsolMemory(
            NonNull::new(memory).ok_or_else(|| null("KINCreate"))?,
        ))
    }

    pub fn as_ptr(&self) -> *mut c_void {
        self.0.as_ptr()
    }

    /// Iterations of the last solution, and the Euclidean norm of its scaled residual.
    pub fn reached(&self, messages: &Messages) -> Result<(usize, f64)> {
        let m = self.as_ptr();
        let (mut iterations, mut residual_norm): (c_long, f64) = (0, 0.0);
        // SAFETY: a live memory, and valid places for the results.
        unsafe {
            check!(KIN, messages, KINGetNumNonlinSolvIters(m, &mut iterations))?;
            check!(KIN, messages, KINGetFuncNorm(m, &mut residual_norm))?;
        }
        Ok((iterations as usize, residual_norm))
    }

    /// Why KINSol failed.
    pub fn explain(
        &self,
        code: c_int,
        not_finite: Option<&'static str>,
        tolerance: f64,
        messages: &Messages,
    ) -> Error {
        use sundials_sys::{
            KIN_FIRST_SYSFUNC_ERR, KIN_LINESEARCH_BCFAIL, KIN_LINESEARCH_NONCONV,
            KIN_MXNEWT_5X_EXCEEDED, KIN_REPTD_SYSFUNC_ERR, KIN_SYSFUNC_FAIL,
        };
        match (code, not_finite) {
            // Within a line search KINSOL calls any failure unrecoverable.
            (KIN_FIRST_SYSFUNC_ERR | KIN_REPTD_SYSFUNC_ERR | KIN_SYSFUNC_FAIL, Some(what)) => {
                Error::NonFinite { what, t: 0.0 }
            }
            (KIN_LINESEARCH_NONCONV | KIN_MXNEWT_5X_EXCEEDED | KIN_LINESEARCH_BCFAIL, _) => {
                let (iterations, residual) = self.reached(messages).unwrap_or_default();
                Error::NotConverged {
                    what: "the Newton iteration of KINSOL",
                    iterations,
                    residual,
                    tolerance,
                }
            }
            _ => failure(flags::KIN, "KINSol", code, None, messages),
        }
    }
}

impl Drop for KinsolMemory {
    fn drop(&mut self) {
        let mut memory = self.0.as_ptr();
        // SAFETY: a live memory that this value alone owns.
        unsafe { sundials_sys::KINFree(&mut memory) };
    }
}

/// A solver of N equations, with our fixed-length vectors and direct solver. Reuse it: making one costs more than a solution.
pub struct Kinsol<const N: usize> {
    /// What is asked for; may be changed between solutions.
    pub settings: KinsolSettings<N>,
    applied: Option<KinsolSettings<N>>,
    constrained: bool,
    // In the order in which they must go.
    memory: KinsolMemory,
    _solver: LinearSolver,
    _matrix: Matrix,
    unknown: NVector,
    unknown_scale: NVector,
    residual_scale: NVector,
    constraints: NVector,
    _context: Context,
    slot: Stable<Slot>,
    messages: Stable<Messages>,
}

// SAFETY: a solver owns its context and everything made from it, shares nothing with other solvers, and SUNDIALS keeps no
// thread-local state; it may be used from any one thread at a time. Frames with borrowed user code live in `solve` only.
unsafe impl<const N: usize> Send for Kinsol<N> {}

impl<const N: usize> Kinsol<N> {
    /// With default settings.
    ///
    /// # Errors
    /// [`Error::Sundials`] if SUNDIALS can't allocate, or is not of the version of its headers.
    pub fn new() -> Result<Self> {
        let messages = Stable::new(Messages::default());
        let slot = Stable::new(Slot::new());
        let context = Context::new(&messages)?;
        let unknown = NVector::fixed::<N>(&context)?;
        let unknown_scale = NVector::fixed::<N>(&context)?;
        let residual_scale = NVector::fixed::<N>(&context)?;
        let constraints = NVector::fixed::<N>(&context)?;
        let matrix = Matrix::fixed::<N>(&context)?;
        let solver = LinearSolver::fixed::<N>(&context)?;
        let memory = KinsolMemory::new(&context)?;
        let m = memory.as_ptr();
        // SAFETY: live objects of one context, kept by the solver longer than the memory; the callbacks are of this N for
        // our vectors and matrix, and the user data are the slot, whose address never changes.
        unsafe {
            native::keep_kinsol_messages(m, &messages)?;
            check!(KIN, &messages, KINSetUserData(m, slot.as_ptr()))?;
            check!(
                KIN,
                &messages,
                KINInit(m, Some(callback::residual::<N>), unknown.as_ptr())
            )?;
            check!(
                KINLS,
                &messages,
                KINSetLinearSolver(m, solver.as_ptr(), matrix.as_ptr())
            )?;
            check!(
                KINLS,
                &messages,
                KINSetJacFn(m, Some(callback::residual_jacobian::<N>))
            )?;
        }
        Ok(Kinsol {
            settings: KinsolSettings::default(),
            applied: None,
            constrained: false,
            memory,
            _solver: solver,
            _matrix: matrix,
            unknown,
            unknown_scale,
            residual_scale,
            constraints,
            _context: context,
            slot,
            messages,
        })
    }

    /// The root that the iteration from `guess` finds.
    ///
    /// `u_scale` and `f_scale` are positive; `u_scale * u` and `f_scale * F` should be of order one near the root. Give
    /// `f_scale` thought: without it a system of mixed magnitudes ends in [`Error::NotConverged`] at a good root.
    ///
    /// # Errors
    /// [`Error::NotConverged`] if the residual tolerance is not met, [`Error::NonFinite`] if F or its Jacobian is not finite
    /// where it must be, [`Error::Parameter`] for a scale, [`Error::Sundials`] otherwise. The root is always finite.
    pub fn solve(
        &mut self,
        problem: &dyn Residual<N>,
        guess: &State<N>,
        u_scale: &State<N>,
        f_scale: &State<N>,
    ) -> Result<State<N>> {
        let (root, outcome) = self.iterate(problem, guess, u_scale, f_scale)?;
        if matches!(outcome, Outcome::SmallStep | Outcome::IterationLimit) {
            // KINSOL looks at the step first where both are small.
            let residual = problem.residual(&root).component_mul(f_scale).amax();
            if residual.is_nan() || residual > self.settings.residual_tolerance {
                return Err(Error::NotConverged {
                    what: "the Newton iteration of KINSOL",
                    iterations: self.work()?.iterations,
                    residual,
                    tolerance: self.settings.residual_tolerance,
                });
            }
        }
        Ok(root)
    }

    /// As [`Kinsol::solve`], with KINSOL's own word on how it ended: [`Outcome::SmallStep`] and
    /// [`Outcome::IterationLimit`] are left to the caller's judgement, with the last iterate.
    ///
    /// # Errors
    /// As [`Kinsol::solve`].
    pub fn iterate(
        &mut self,
        problem: &dyn Residual<N>,
        guess: &State<N>,
        u_scale: &State<N>,
        f_scale: &State<N>,
    ) -> Result<(State<N>, Outcome)> {
        if !callback::all_finite(guess.as_slice()) {
            return Err(Error::NonFinite {
                what: "the guess",
                t: 0.0,
            });
        }
        for (name, scale) in [("u_scale", u_scale), ("f_scale", f_scale)] {
            // False for NaN too, which KINSOL would let pass.
            if let Some(bad) = scale.iter().find(|s| !(**s > 0.0 && s.is_finite())) {
                return Err(Error::parameter(name, bad, "positive and finite"));
            }
        }
        self.apply_settings()?;
        self.unknown.set(guess);
        self.unknown_scale.set(u_scale);
        self.residual_scale.set(f_scale);
        self.messages.clear();

        let frame = ResidualFrame {
            residual: problem,
            guard: callback::Guard::default(),
        };
        let entered = self.slot.enter(&frame);
        // SAFETY: a live memory that `new` has set up, and live vectors like the one it was given.
        let code = unsafe {
            sundials_sys::KINSol(
                self.memory.as_ptr(),
                self.unknown.as_ptr(),
                self.settings.strategy.flag(),
                self.unknown_scale.as_ptr(),
                self.residual_scale.as_ptr(),
            )
        };
        drop(entered);
        frame.guard.resume();

        let Some(outcome) = Outcome::of(code) else {
            let tolerance = self.settings.residual_tolerance;
            let not_finite = frame.guard.not_finite();
            return Err(self
                .memory
                .explain(code, not_finite, tolerance, &self.messages));
        };
        let root = self.unknown.get::<N>();
        if !callback::all_finite(root.as_slice()) {
            return Err(Error::NonFinite {
                what: "the root",
                t: 0.0,
            });
        }
        Ok((root, outcome))
    }

    /// The work of the last solution, finished or failed.
    ///
    /// # Errors
    /// [`Error::Sundials`] before the first solution.
    pub fn work(&self) -> Result<KinsolWork> {
        let m = self.memory.as_ptr();
        let messages = &self.messages;
        let (iterations, residual_norm) = self.memory.reached(messages)?;
        let mut counts: [c_long; 3] = [0; 3];
        let [residuals, jacobians, backtracks] = &mut counts;
        // SAFETY: a live memory, and valid places for the results.
        unsafe {
            check!(KIN, messages, KINGetNumFuncEvals(m, residuals))?;
            check!(KINLS, messages, KINGetNumJacEvals(m, jacobians))?;
            check!(KIN, messages, KINGetNumBacktrackOps(m, backtracks))?;
        }
        let [residuals, jacobians, backtracks] = counts.map(|n| n as usize);
        Ok(KinsolWork {
            iterations,
            residuals,
            jacobians,
            backtracks,
            residual_norm,
        })
    }

    fn apply_settings(&mut self) -> Result<()> {
        let settings = self.settings;
        if self.applied == Some(settings) {
            return Ok(());
        }
        self.applied = None;
        // KINSetConstraints(NULL) frees the constraints but goes on using them (6.4.1, 7.1.1): once there are some, they stay,
        // all free if need be.
        self.constrained |= settings.constraints.iter().any(|c| *c != Constraint::Free);
        self.constraints
            .set(&State::from(settings.constraints.map(Constraint::code)));
        let m = self.memory.as_ptr();
        let messages = &self.messages;
        // SAFETY: a live memory; KINSOL copies the constraints.
        unsafe {
            check!(
                KIN,
                messages,
                KINSetFuncNormTol(m, settings.residual_tolerance)
            )?;
            check!(
                KIN,
                messages,
                KINSetScaledStepTol(m, settings.step_tolerance)
            )?;
            check!(
                KIN,
                messages,
                KINSetNumMaxIters(m, settings.max_iterations as c_long)
            )?;
            check!(
                KIN,
                messages,
                KINSetMaxSetupCalls(m, settings.jacobian_lifetime as c_long)
            )?;
            // Zero stands for KINSOL's own choice.
            check!(
                KIN,
                messages,
                KINSetMaxNewtonStep(m, settings.longest_step.unwrap_or(0.0))
            )?;
            if self.constrained {
                check!(
                    KIN,
                    messages,
                    KINSetConstraints(m, self.constraints.as_ptr())
                )?;
            }
        }
        self.applied = Some(settings);
        Ok(())
    }
}
