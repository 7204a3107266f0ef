//! From C back into Rust: the functions that CVODES and KINSOL call, and the slot that keeps a panic until C has returned.
//!
//! SUNDIALS copies its user-data pointer into several of its own structures, some of them only when they are made, so the
//! pointer must never change. It is the address of a [`Slot`], which lives as long as the solver; the slot points at the
//! [`UserData`] on the stack of the one method that is inside C, and at nothing otherwise.
#![allow(unsafe_code)]

use super::kinsol::Residual;
use super::linear_solver::newton;
use super::vector::{OwnVectors, Storage, read, write};
use crate::field::{Jacobian, State, VectorField, with_differences};
use std::any::Any;
use std::cell::Cell;
use std::ffi::{c_int, c_void};
use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::ptr;
use sundials_sys::{N_Vector, SUNMatrix};

/// What a callback tells C.
pub(super) const GOOD: c_int = 0;
const RECOVERABLE: c_int = 1;
pub(super) const FATAL: c_int = -1;

/// Functions whose zeros are events, evaluated at (t, y) into a slice.
pub type Events<'a, const N: usize> = &'a dyn Fn(f64, &State<N>, &mut [f64]);

/// The inhomogeneous term of a sensitivity: df/dp at y for the parameter of a column, zero for a column of initial values.
pub type Forcing<'a, const N: usize> = &'a dyn Fn(usize, &State<N>) -> State<N>;

/// What is integrated, and what is watched on the way.
#[derive(Clone, Copy)]
pub struct Problem<'a, const N: usize> {
    /// dy/dt = f(y).
    pub field: &'a dyn VectorField<N>,
    /// Event functions; needed if and only if events are watched.
    pub events: Option<Events<'a, N>>,
    /// df/dp by column of the sensitivities; without it they are those of initial values alone.
    pub forcing: Option<Forcing<'a, N>>,
}

impl<'a, const N: usize> Problem<'a, N> {
    /// A field alone.
    pub fn new(field: &'a dyn VectorField<N>) -> Self {
        Problem {
            field,
            events: None,
            forcing: None,
        }
    }
}

/// What the user-data pointer points at.
#[derive(Default)]
pub(super) struct Slot {
    frame: Cell<*const c_void>,
}

impl Slot {
    pub fn new() -> Self {
        Slot {
            frame: Cell::new(ptr::null()),
        }
    }

    /// Makes the frame visible to callbacks for the life of the result.
    pub fn enter<'s, T>(&'s self, frame: &'s T) -> Entered<'s> {
        self.frame.set(ptr::from_ref(frame).cast());
        Entered {
            slot: self,
            frame: PhantomData,
        }
    }
}

/// Takes the frame out of the slot when dropped.
pub(super) struct Entered<'s> {
    slot: &'s Slot,
    frame: PhantomData<&'s ()>,
}

impl Drop for Entered<'_> {
    fn drop(&mut self) {
        self.slot.frame.set(ptr::null());
    }
}

/// What user code did during one stay in C.
#[derive(Default)]
pub(super) struct Guard {
    panicked: Cell<bool>,
    payload: Cell<Option<Box<dyn Any + Send>>>,
    not_finite: Cell<Option<&'static str>>,
}

impl Guard {
    /// Runs user code; `None` if it panicked, now or before: once a panic is pending no further user code runs.
    #[inline(always)]
    pub(super) fn run<T>(&self, code: impl FnOnce() -> T) -> Option<T> {
        if self.panicked.get() {
            return None;
        }
        self.not_finite.set(None);
        match catch_unwind(AssertUnwindSafe(code)) {
            Ok(value) => Some(value),
            Err(payload) => {
                self.panicked.set(true);
                self.payload.set(Some(payload));
                None
            }
        }
    }

    /// Tells C that a value is not finite: another, shorter step may help.
    #[cold]
    pub(super) fn refuse(&self, what: &'static str) -> c_int {
        self.not_finite.set(Some(what));
        RECOVERABLE
    }

    /// Goes on with a panic, if there was one. Only after C has returned.
    pub fn resume(&self) {
        if let Some(payload) = self.payload.take() {
            resume_unwind(payload);
        }
    }

    /// What was not finite at the last call of user code; `None` if that call was good.
    pub fn not_finite(&self) -> Option<&'static str> {
        self.not_finite.get()
    }
}

/// What CVODES's callbacks work with.
pub(super) struct UserData<'a, const N: usize> {
    pub problem: Problem<'a, N>,
    pub event_count: usize,
    pub guard: Guard,
    /// Jacobians evaluated for sensitivities.
    pub tangents: Cell<usize>,
}

impl<'a, const N: usize> UserData<'a, N> {
    pub fn new(problem: Problem<'a, N>, event_count: usize) -> Self {
        UserData {
            problem,
            event_count,
            guard: Guard::default(),
            tangents: Cell::new(0),
        }
    }

    #[inline(always)]
    fn jacobian(&self, y: &State<N>) -> Result<Jacobian<N>, c_int> {
        match self.guard.run(|| self.problem.field.jacobian(y)) {
            None => Err(FATAL),
            Some(j) if !all_finite(j.as_slice()) => Err(self.guard.refuse("the Jacobian")),
            Some(j) => Ok(j),
        }
    }

    /// J(y) for Newton's method, which converges with differences in place of what is no number; sensitivities need J itself.
    #[inline(always)]
    fn newton_jacobian(&self, y: &State<N>) -> Result<Jacobian<N>, c_int> {
        let field = self.problem.field;
        match self.guard.run(|| field.jacobian(y)) {
            None => Err(FATAL),
            Some(j) if all_finite(j.as_slice()) => Ok(j),
            Some(j) => match self.guard.run(|| with_differences(field, y, j)) {
                None => Err(FATAL),
                Some(j) if all_finite(j.as_slice()) => Ok(j),
                Some(_) => Err(self.guard.refuse("the Jacobian")),
            },
        }
    }
}

/// What KINSOL's callbacks work with.
pub(super) struct ResidualFrame<'a, const N: usize> {
    pub residual: &'a dyn Residual<N>,
    pub guard: Guard,
}

/// Whether all are finite. One sum instead of a branch for each: 0 x is zero where x is finite, NaN elsewhere.
#[inline(always)]
pub(super) fn all_finite(x: &[f64]) -> bool {
    let mut sum = 0.0;
    for value in x {
        sum += 0.0 * value;
    }
    sum == 0.0
}

/// The frame of the method that is inside C; `None` outside.
///
/// # Safety
/// `user_data` is the address of a live [`Slot`] into which only frames of type `T` are put.
#[inline(always)]
unsafe fn frame<'f, T>(user_data: *mut c_void) -> Option<&'f T> {
    // SAFETY: the caller's promise. The frame outlives the stay in C, by the life of `Entered`, and callbacks run within it.
    unsafe { (*user_data.cast::<Slot>()).frame.get().cast::<T>().as_ref() }
}

/// f(y).
///
/// # Safety
/// As CVODES calls it, for a solver of this N and storage.
pub(super) unsafe extern "C" fn right_hand_side<S: Storage, const N: usize>(
    _t: f64,
    y: N_Vector,
    dy: N_Vector,
    user_data: *mut c_void,
) -> c_int {
    // SAFETY: CVODES passes live vectors like the one it was given at first, and the solver's slot.
    unsafe {
        let Some(frame) = frame::<UserData<'_, N>>(user_data) else {
            return FATAL;
        };
        let y = read::<S, N>(y);
        match frame.guard.run(|| frame.problem.field.f(&y)) {
            None => FATAL,
            Some(f) if !all_finite(f.as_slice()) => frame.guard.refuse("the right-hand side"),
            Some(f) => {
                write::<S, N>(dy, &f);
                GOOD
            }
        }
    }
}

/// J(y) into a dense matrix of SUNDIALS's.
///
/// # Safety
/// As CVODES calls it, for a solver of this N with serial vectors and a dense matrix.
pub(super) unsafe extern "C" fn dense_jacobian<S: Storage, const N: usize>(
    _t: f64,
    y: N_Vector,
    _fy: N_Vector,
    a: SUNMatrix,
    user_data: *mut c_void,
    _: N_Vector,
    _: N_Vector,
    _: N_Vector,
) -> c_int {
    // SAFETY: CVODES passes live objects like those it was given at first, and the solver's slot; the dense matrix has N
    // columns of N numbers one after the other, as nalgebra's.
    unsafe {
        let Some(frame) = frame::<UserData<'_, N>>(user_data) else {
            return FATAL;
        };
        match frame.newton_jacobian(&read::<S, N>(y)) {
            Err(code) => code,
            Ok(j) => {
                let data = sundials_sys::SUNDenseMatrix_Data(a);
                ptr::copy_nonoverlapping(j.as_ptr(), data, N * N);
                GOOD
            }
        }
    }
}

/// M = I - gamma J, with J(y) new only if CVODES asks for it.
///
/// # Safety
/// As CVODES calls it, for a solver of this N with our vectors and matrix.
pub(super) unsafe extern "C" fn linear_system<const N: usize>(
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
    // SAFETY: CVODES passes live objects like those it was given at first, the solver's slot, and a place for the flag.
    unsafe {
        let Some(frame) = frame::<UserData<'_, N>>(user_data) else {
            return FATAL;
        };
        let content = newton::<N>(a);
        content.variables = frame.problem.field.dimension();
        *current = c_int::from(keep == 0);
        if keep == 0 {
            match frame.newton_jacobian(&read::<OwnVectors, N>(y)) {
                Err(code) => return code,
                Ok(j) => content.jacobian = j,
            }
        }
        content.system = content.jacobian * -gamma;
        for i in 0..N {
            content.system[(i, i)] += 1.0;
        }
        GOOD
    }
}

/// The event functions.
///
/// # Safety
/// As CVODES calls it, for a solver of this N and storage, with as many places as events were announced.
pub(super) unsafe extern "C" fn events<S: Storage, const N: usize>(
    t: f64,
    y: N_Vector,
    g: *mut f64,
    user_data: *mut c_void,
) -> c_int {
    // SAFETY: CVODES passes a live vector, the solver's slot, and an array for as many values as CVodeRootInit was told.
    unsafe {
        let Some(frame) = frame::<UserData<'_, N>>(user_data) else {
            return FATAL;
        };
        let Some(events) = frame.problem.events else {
            return FATAL;
        };
        let y = read::<S, N>(y);
        let g = std::slice::from_raw_parts_mut(g, frame.event_count);
        match frame.guard.run(|| events(t, &y, &mut *g)) {
            None => FATAL,
            Some(()) if !all_finite(g) => frame.guard.refuse("an event function"),
            Some(()) => GOOD,
        }
    }
}

/// The product of J with many columns: of many variables by the entries that are not zero, as most of theirs are.
enum Product<'j, const N: usize> {
    Whole(&'j Jacobian<N>),
    /// Row, column and value.
    Entries(Vec<(usize, usize, f64)>),
}

impl<'j, const N: usize> Product<'j, N> {
    #[inline(always)]
    fn of(j: &'j Jacobian<N>) -> Self {
        const FEW: usize = 8;
        if N <= FEW {
            return Product::Whole(j);
        }
        let places = (0..N).flat_map(|k| (0..N).map(move |i| (i, k)));
        let entries = places.map(|(i, k)| (i, k, j[(i, k)]));
        Product::Entries(entries.filter(|entry| entry.2 != 0.0).collect())
    }

    #[inline(always)]
    fn with(&self, s: &State<N>) -> State<N> {
        match self {
            Product::Whole(j) => *j * s,
            Product::Entries(entries) => {
                let mut made = State::zeros();
                for &(i, k, value) in entries {
                    made[i] += value * s[k];
                }
                made
            }
        }
    }
}

/// ds/dt = J s + df/dp for every column.
///
/// # Safety
/// As CVODES calls it, for a solver of this N and storage.
pub(super) unsafe extern "C" fn sensitivity_right_hand_side<S: Storage, const N: usize>(
    count: c_int,
    _t: f64,
    y: N_Vector,
    _dy: N_Vector,
    s: *mut N_Vector,
    ds: *mut N_Vector,
    user_data: *mut c_void,
    _: N_Vector,
    _: N_Vector,
) -> c_int {
    // SAFETY: CVODES passes live vectors like the ones it was given at first, arrays of `count` of them, and the slot.
    unsafe {
        let Some(frame) = frame::<UserData<'_, N>>(user_data) else {
            return FATAL;
        };
        let y = read::<S, N>(y);
        frame.tangents.set(frame.tangents.get() + 1);
        let j = match frame.jacobian(&y) {
            Err(code) => return code,
            Ok(j) => j,
        };
        let product = Product::of(&j);
        for column in 0..count as usize {
            let mut derivative = product.with(&read::<S, N>(*s.add(column)));
            if let Some(forcing) = frame.problem.forcing {
                match frame.guard.run(|| forcing(column, &y)) {
                    None => return FATAL,
                    Some(p) => derivative += p,
                }
            }
            if !all_finite(derivative.as_slice()) {
                return frame
                    .guard
                    .refuse("the right-hand side of the sensitivities");
            }
            write::<S, N>(*ds.add(column), &derivative);
        }
        GOOD
    }
}

/// F(u).
///
/// # Safety
/// As KINSOL calls it, for a solver of this N with our vectors.
pub(super) unsafe extern "C" fn residual<const N: usize>(
    u: N_Vector,
    f: N_Vector,
    user_data: *mut c_void,
) -> c_int {
    // SAFETY: KINSOL passes live vectors like the one it was given at first, and the solver's slot.
    unsafe {
        let Some(frame) = frame::<ResidualFrame<'_, N>>(user_data) else {
            return FATAL;
        };
        let u = read::<OwnVectors, N>(u);
        match frame.guard.run(|| frame.residual.residual(&u)) {
            None => FATAL,
            Some(value) if !all_finite(value.as_slice()) => frame.guard.refuse("the residual"),
            Some(value) => {
                write::<OwnVectors, N>(f, &value);
                GOOD
            }
        }
    }
}

/// dF/du.
///
/// # Safety
/// As KINSOL calls it, for a solver of this N with our vectors and matrix.
pub(super) unsafe extern "C" fn residual_jacobian<const N: usize>(
    u: N_Vector,
    _f: N_Vector,
    a: SUNMatrix,
    user_data: *mut c_void,
    _: N_Vector,
    _: N_Vector,
) -> c_int {
    // SAFETY: KINSOL passes live objects like those it was given at first, and the solver's slot.
    unsafe {
        let Some(frame) = frame::<ResidualFrame<'_, N>>(user_data) else {
            return FATAL;
        };
        let u = read::<OwnVectors, N>(u);
        match frame.guard.run(|| frame.residual.jacobian(&u)) {
            None => FATAL,
            Some(j) if !all_finite(j.as_slice()) => {
                frame.guard.refuse("the Jacobian of the residual")
            }
            Some(j) => {
                newton::<N>(a).system = j;
                GOOD
            }
        }
    }
}
