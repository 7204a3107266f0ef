//! Small dense matrices and a direct solver behind SUNDIALS's interfaces, and the owners of any matrix and linear solver.
//!
//! Ours hold N by N numbers in place. The solver is Gauss's elimination with partial pivoting, unrolled; the matrix keeps the
//! Jacobian of the last evaluation beside the system M = I - gamma J, so that CVODE can ask for another gamma alone.
#![allow(unsafe_code)]

use super::vector::{self, NVector, OwnVectors};
use super::{Context, null};
use crate::error::Result;
use crate::field::Jacobian;
use std::ffi::{c_int, c_void};
use std::ptr::{self, NonNull};
use sundials_sys::{
    N_Vector, SUNLinearSolver, SUNLinearSolver_ID, SUNLinearSolver_Type, SUNMatrix, SUNMatrix_ID,
};

/// SUNLS_LUFACT_FAIL: positive, hence recoverable with another step.
pub(super) const SINGULAR: c_int = 808;

/// The content of our matrices.
pub(super) struct Newton<const N: usize> {
    /// J at its last evaluation.
    pub jacobian: Jacobian<N>,
    /// The matrix of the linear system; its factors once the solver has set it up.
    pub system: Jacobian<N>,
    /// How many of the N components are variables: beside these the system is the identity.
    pub variables: usize,
}

impl<const N: usize> Newton<N> {
    /// The rows that elimination goes through: of few all, so that their number is known to the compiler.
    #[inline(always)]
    fn rows(&self) -> usize {
        const FEW: usize = 8;
        if N > FEW { self.variables } else { N }
    }
}

/// The owner of a matrix.
pub(super) struct Matrix(NonNull<sundials_sys::_generic_SUNMatrix>);

impl Matrix {
    /// # Safety
    /// A live matrix that nothing else owns.
    pub(super) unsafe fn owned(a: NonNull<sundials_sys::_generic_SUNMatrix>) -> Self {
        Matrix(a)
    }

    /// SUNDIALS's dense matrix.
    pub fn dense<const N: usize>(context: &Context) -> Result<Self> {
        // SAFETY: a live context, which the solver keeps longer than its matrix.
        let a = unsafe { sundials_sys::SUNDenseMatrix(N as _, N as _, context.as_ptr()) };
        Ok(Matrix(
            NonNull::new(a).ok_or_else(|| null("SUNDenseMatrix"))?,
        ))
    }

    /// A matrix of ours.
    pub fn fixed<const N: usize>(context: &Context) -> Result<Self> {
        // SAFETY: a live context, which the solver keeps longer than its matrix.
        let a = unsafe { new_matrix::<N>(context.as_ptr()) };
        Ok(Matrix(
            NonNull::new(a).ok_or_else(|| null("SUNMatNewEmpty"))?,
        ))
    }

    pub fn as_ptr(&self) -> SUNMatrix {
        self.0.as_ptr()
    }
}

impl Drop for Matrix {
    fn drop(&mut self) {
        // SAFETY: a live matrix that this value alone owns.
        unsafe { sundials_sys::SUNMatDestroy(self.as_ptr()) };
    }
}

/// The owner of a linear solver.
pub(super) struct LinearSolver(NonNull<sundials_sys::_generic_SUNLinearSolver>);

impl LinearSolver {
    /// # Safety
    /// A live solver that nothing else owns.
    pub(super) unsafe fn owned(s: NonNull<sundials_sys::_generic_SUNLinearSolver>) -> Self {
        LinearSolver(s)
    }

    /// SUNDIALS's dense direct solver.
    pub fn dense(context: &Context, y: &NVector, a: &Matrix) -> Result<Self> {
        // SAFETY: live objects of one context, which the solver keeps longer.
        let s = unsafe { sundials_sys::SUNLinSol_Dense(y.as_ptr(), a.as_ptr(), context.as_ptr()) };
        Ok(LinearSolver(
            NonNull::new(s).ok_or_else(|| null("SUNLinSol_Dense"))?,
        ))
    }

    /// A solver of ours, for our matrices and vectors.
    pub fn fixed<const N: usize>(context: &Context) -> Result<Self> {
        // SAFETY: a live context, which the solver keeps longer.
        let s = unsafe { sundials_sys::SUNLinSolNewEmpty(context.as_ptr()) };
        let solver = LinearSolver(NonNull::new(s).ok_or_else(|| null("SUNLinSolNewEmpty"))?);
        // SAFETY: SUNLinSolNewEmpty made the table of operations, all NULL. The content is freed by `free_solver`, which
        // is in the table from here on.
        unsafe {
            let ops = &mut *(*s).ops;
            ops.gettype = Some(solver_type);
            ops.getid = Some(solver_id);
            ops.setup = Some(factorise::<N>);
            ops.solve = Some(substitute::<N>);
            ops.free = Some(free_solver::<N>);
            (*s).content = Box::into_raw(Box::new([0_usize; N])).cast();
        }
        Ok(solver)
    }

    pub fn as_ptr(&self) -> SUNLinearSolver {
        self.0.as_ptr()
    }
}

impl Drop for LinearSolver {
    fn drop(&mut self) {
        // SAFETY: a live solver that this value alone owns.
        unsafe { sundials_sys::SUNLinSolFree(self.as_ptr()) };
    }
}

/// The content of one of our matrices.
///
/// # Safety
/// `a` is a live matrix of ours with this N, and nothing else refers to its content for the life of the reference.
#[inline(always)]
pub(super) unsafe fn newton<'a, const N: usize>(a: SUNMatrix) -> &'a mut Newton<N> {
    // SAFETY: the caller's promise.
    unsafe { &mut *(*a).content.cast() }
}

/// # Safety
/// `context` is live.
unsafe fn new_matrix<const N: usize>(context: sundials_sys::SUNContext) -> SUNMatrix {
    // SAFETY: a live context. SUNMatNewEmpty made the table of operations, all NULL; `destroy_matrix` frees the content.
    unsafe {
        let a = sundials_sys::SUNMatNewEmpty(context);
        if a.is_null() {
            return a;
        }
        let ops = &mut *(*a).ops;
        ops.getid = Some(matrix_id);
        ops.clone = Some(clone_matrix::<N>);
        ops.destroy = Some(destroy_matrix::<N>);
        ops.zero = Some(zero_matrix::<N>);
        ops.copy = Some(copy_matrix::<N>);
        (*a).content = Box::into_raw(Box::new(Newton::<N> {
            jacobian: Jacobian::zeros(),
            system: Jacobian::zeros(),
            variables: N,
        }))
        .cast();
        a
    }
}

// SUNDIALS calls the operations with live matrices, solvers and vectors of ours, of one N.

unsafe extern "C" fn matrix_id(_: SUNMatrix) -> SUNMatrix_ID {
    sundials_sys::SUNMatrix_ID_SUNMATRIX_CUSTOM
}

unsafe extern "C" fn clone_matrix<const N: usize>(a: SUNMatrix) -> SUNMatrix {
    // SAFETY: a live matrix has a live context.
    unsafe { new_matrix::<N>((*a).sunctx) }
}

unsafe extern "C" fn destroy_matrix<const N: usize>(a: SUNMatrix) {
    if a.is_null() {
        return;
    }
    // SAFETY: a live matrix of ours, which nobody uses again; the content came from a Box.
    unsafe {
        if !(*a).content.is_null() {
            drop(Box::from_raw((*a).content.cast::<Newton<N>>()));
            (*a).content = ptr::null_mut::<c_void>();
        }
        sundials_sys::SUNMatFreeEmpty(a);
    }
}

unsafe extern "C" fn zero_matrix<const N: usize>(a: SUNMatrix) -> c_int {
    // SAFETY: a live matrix of ours.
    unsafe { newton::<N>(a) }.system = Jacobian::zeros();
    0
}

unsafe extern "C" fn copy_matrix<const N: usize>(a: SUNMatrix, b: SUNMatrix) -> c_int {
    // SAFETY: live matrices of ours; copied by value, since they may be the same.
    unsafe {
        let from = newton::<N>(a);
        let (jacobian, system, variables) = (from.jacobian, from.system, from.variables);
        *newton::<N>(b) = Newton {
            jacobian,
            system,
            variables,
        };
    }
    0
}

unsafe extern "C" fn solver_type(_: SUNLinearSolver) -> SUNLinearSolver_Type {
    sundials_sys::SUNLinearSolver_Type_SUNLINEARSOLVER_DIRECT
}

unsafe extern "C" fn solver_id(_: SUNLinearSolver) -> SUNLinearSolver_ID {
    sundials_sys::SUNLinearSolver_ID_SUNLINEARSOLVER_CUSTOM
}

unsafe extern "C" fn free_solver<const N: usize>(s: SUNLinearSolver) -> c_int {
    // SAFETY: a live solver of ours, which nobody uses again; the content came from a Box.
    unsafe {
        if !(*s).content.is_null() {
            drop(Box::from_raw((*s).content.cast::<[usize; N]>()));
            (*s).content = ptr::null_mut::<c_void>();
        }
        sundials_sys::SUNLinSolFreeEmpty(s);
    }
    0
}

/// M = P L U in place.
unsafe extern "C" fn factorise<const N: usize>(s: SUNLinearSolver, a: SUNMatrix) -> c_int {
    // SAFETY: a live solver and matrix of ours; their contents are apart.
    let (newton, pivots) = unsafe { (newton::<N>(a), &mut *(*s).content.cast::<[usize; N]>()) };
    let rows = newton.rows();
    let m = &mut newton.system;
    for k in 0..rows {
        let mut pivot = k;
        for i in k + 1..rows {
            if m[(i, k)].abs() > m[(pivot, k)].abs() {
                pivot = i;
            }
        }
        pivots[k] = pivot;
        let divisor = m[(pivot, k)];
        if divisor == 0.0 || !divisor.is_finite() {
            return SINGULAR;
        }
        if pivot != k {
            m.swap_rows(pivot, k);
        }
        // As SUNDIALS's dense solver does, so that both take the same steps. Column by column, as they lie in memory.
        let reciprocal = 1.0 / divisor;
        for i in k + 1..rows {
            m[(i, k)] *= reciprocal;
        }
        for j in k + 1..rows {
            let upper = m[(k, j)];
            for i in k + 1..rows {
                let factor = m[(i, k)];
                m[(i, j)] -= factor * upper;
            }
        }
    }
    0
}

/// x = M^-1 b.
unsafe extern "C" fn substitute<const N: usize>(
    s: SUNLinearSolver,
    a: SUNMatrix,
    x: N_Vector,
    b: N_Vector,
    _tolerance: f64,
) -> c_int {
    // SAFETY: a live solver, matrix and vectors of ours.
    let (newton, pivots, mut y) = unsafe {
        (
            newton::<N>(a),
            &*(*s).content.cast::<[usize; N]>(),
            vector::read::<OwnVectors, N>(b),
        )
    };
    let rows = newton.rows();
    let m = &newton.system;
    for (k, pivot) in pivots[..rows].iter().enumerate() {
        y.swap_rows(k, *pivot);
    }
    for k in 0..rows {
        for i in k + 1..rows {
            y[i] -= m[(i, k)] * y[k];
        }
    }
    for k in (0..rows).rev() {
        y[k] /= m[(k, k)];
        for i in 0..k {
            y[i] -= m[(i, k)] * y[k];
        }
    }
    // SAFETY: a live vector of ours.
    unsafe { vector::write::<OwnVectors, N>(x, &y) };
    0
}
