//! The matrix and the linear solver of a system in linear time behind SUNDIALS's interfaces.
#![allow(unsafe_code)]

use super::vector::{numbers, numbers_mut};
use super::{Frame, LinearTime, frame};
use crate::error::Result;
use crate::sundials::callback::{FATAL, GOOD};
use crate::sundials::linear_solver::{LinearSolver, Matrix, SINGULAR};
use crate::sundials::{Context, null};
use std::ffi::{c_int, c_void};
use std::ptr::NonNull;
use sundials_sys::{
    N_Vector, SUNLinearSolver, SUNLinearSolver_ID, SUNLinearSolver_Type, SUNMatrix, SUNMatrix_ID,
};

/// The content of a matrix: J, and what stands for s (d I - J).
pub(super) struct Content<S: LinearTime> {
    pub matrix: S::Matrix,
    pub diagonal: f64,
    /// s: 1/d for CVODE's I - gamma J, and -1 for KINSOL's J, with d = 0.
    pub scale: f64,
}

/// # Safety
/// `a` is a live matrix of this system, and nothing else refers to its content for the life of the reference.
pub(super) unsafe fn content<'a, S: LinearTime>(a: SUNMatrix) -> &'a mut Content<S> {
    // SAFETY: the caller's promise.
    unsafe { &mut *(*a).content.cast() }
}

/// A matrix of a system.
pub(super) fn matrix<S: LinearTime>(context: &Context) -> Result<Matrix> {
    // SAFETY: a live context, which the solver keeps longer than its matrix.
    let a = unsafe { new_matrix::<S>(context.as_ptr()) };
    let a = NonNull::new(a).ok_or_else(|| null("SUNMatNewEmpty"))?;
    // SAFETY: a matrix that nothing else owns.
    Ok(unsafe { Matrix::owned(a) })
}

/// The solver of a system, whose frame lives longer.
pub(super) fn solver<S: LinearTime>(context: &Context, of: &Frame<S>) -> Result<LinearSolver> {
    // SAFETY: a live context, which the solver keeps longer.
    let s = unsafe { sundials_sys::SUNLinSolNewEmpty(context.as_ptr()) };
    let s = NonNull::new(s).ok_or_else(|| null("SUNLinSolNewEmpty"))?;
    // SAFETY: SUNLinSolNewEmpty made the table of operations, all NULL. The content is the frame, which belongs to another.
    unsafe {
        let ops = &mut *(*s.as_ptr()).ops;
        ops.gettype = Some(solver_type);
        ops.getid = Some(solver_id);
        ops.setup = Some(factorise::<S>);
        ops.solve = Some(substitute::<S>);
        ops.free = Some(free_solver);
        (*s.as_ptr()).content = std::ptr::from_ref(of).cast_mut().cast();
        Ok(LinearSolver::owned(s))
    }
}

/// # Safety
/// `context` is live.
unsafe fn new_matrix<S: LinearTime>(context: sundials_sys::SUNContext) -> SUNMatrix {
    // SAFETY: a live context. SUNMatNewEmpty made the table of operations, all NULL; `destroy_matrix` frees the content.
    unsafe {
        let a = sundials_sys::SUNMatNewEmpty(context);
        if a.is_null() {
            return a;
        }
        let ops = &mut *(*a).ops;
        ops.getid = Some(matrix_id);
        ops.clone = Some(clone_matrix::<S>);
        ops.destroy = Some(destroy_matrix::<S>);
        ops.zero = Some(zero_matrix);
        (*a).content = Box::into_raw(Box::new(Content::<S> {
            matrix: S::Matrix::default(),
            diagonal: 1.0,
            scale: 1.0,
        }))
        .cast();
        a
    }
}

// SUNDIALS calls the operations with live matrices, solvers and vectors of one system.

unsafe extern "C" fn matrix_id(_: SUNMatrix) -> SUNMatrix_ID {
    sundials_sys::SUNMatrix_ID_SUNMATRIX_CUSTOM
}

unsafe extern "C" fn clone_matrix<S: LinearTime>(a: SUNMatrix) -> SUNMatrix {
    // SAFETY: a live matrix has a live context.
    unsafe { new_matrix::<S>((*a).sunctx) }
}

unsafe extern "C" fn destroy_matrix<S: LinearTime>(a: SUNMatrix) {
    if a.is_null() {
        return;
    }
    // SAFETY: a live matrix of ours, which nobody uses again; the content came from a Box.
    unsafe {
        if !(*a).content.is_null() {
            drop(Box::from_raw((*a).content.cast::<Content<S>>()));
            (*a).content = std::ptr::null_mut::<c_void>();
        }
        sundials_sys::SUNMatFreeEmpty(a);
    }
}

/// What is to be written anew as a whole needs no zeros.
unsafe extern "C" fn zero_matrix(_: SUNMatrix) -> c_int {
    0
}

unsafe extern "C" fn solver_type(_: SUNLinearSolver) -> SUNLinearSolver_Type {
    sundials_sys::SUNLinearSolver_Type_SUNLINEARSOLVER_DIRECT
}

unsafe extern "C" fn solver_id(_: SUNLinearSolver) -> SUNLinearSolver_ID {
    sundials_sys::SUNLinearSolver_ID_SUNLINEARSOLVER_CUSTOM
}

unsafe extern "C" fn free_solver(s: SUNLinearSolver) -> c_int {
    // SAFETY: a live solver of ours, which nobody uses again; its content is another's.
    unsafe {
        (*s).content = std::ptr::null_mut::<c_void>();
        sundials_sys::SUNLinSolFreeEmpty(s);
    }
    0
}

unsafe extern "C" fn factorise<S: LinearTime>(s: SUNLinearSolver, a: SUNMatrix) -> c_int {
    // SAFETY: a live solver and matrix of ours.
    let (frame, content) = unsafe { (frame::<S>((*s).content), content::<S>(a)) };
    let Content {
        matrix, diagonal, ..
    } = content;
    match frame
        .guard
        .run(|| frame.system.factorise(*diagonal, matrix))
    {
        None => FATAL,
        Some(false) => SINGULAR,
        Some(true) => GOOD,
    }
}

/// x = M^-1 b.
unsafe extern "C" fn substitute<S: LinearTime>(
    s: SUNLinearSolver,
    a: SUNMatrix,
    x: N_Vector,
    b: N_Vector,
    _tolerance: f64,
) -> c_int {
    // SAFETY: a live solver, matrix and vectors of ours; where both vectors are the same nothing is copied.
    let (frame, content, x) = unsafe {
        if x != b {
            numbers_mut::<S>(x).copy_from_slice(numbers::<S>(b));
        }
        (
            frame::<S>((*s).content),
            content::<S>(a),
            numbers_mut::<S>(x),
        )
    };
    let solved = frame.guard.run(|| {
        for number in &mut *x {
            *number /= content.scale;
        }
        frame.system.solve(&content.matrix, x);
    });
    match solved {
        None => FATAL,
        Some(()) => GOOD,
    }
}
