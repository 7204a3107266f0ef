//! CVODE and KINSOL for systems of very many equations whose linear systems are solved in linear time: vectors, matrix and linear solver are
//! ours, work on all cores, and no matrix of all elements is ever made.
//!
//! The norm of errors is the largest one, not the root of the mean square: that would let one variable that moves hide among a million that
//! rest. Nothing in it depends on the order in which processes or cores finish.

mod cvode;
mod kinsol;
mod solver;
mod vector;

pub(crate) use cvode::LargeCvode;
pub(crate) use kinsol::{LargeKinsol, Until};

use super::callback::Guard;
use std::ffi::c_void;

/// dy/dt = f(y), with linear systems (d I - J) x = b that cost no more than f.
pub(crate) trait LinearTime: Sync {
    /// J, and the factors of d I - J.
    type Matrix: Default;

    /// f(y). May be non-finite: the step is then shortened.
    fn rates(&self, y: &[f64], rates: &mut [f64]);

    /// J at y.
    fn linearise(&self, y: &[f64], matrix: &mut Self::Matrix);

    /// Makes d I - J ready for [`LinearTime::solve`]; false where that is not possible.
    fn factorise(&self, diagonal: f64, matrix: &mut Self::Matrix) -> bool;

    /// x with (d I - J) x = b, in place of b.
    fn solve(&self, matrix: &Self::Matrix, b: &mut [f64]);

    /// One over what an error of 1 is, of every number of y; for KINSOL, of f(y).
    fn weights(&self, y: &[f64], weights: &mut [f64]);

    /// The largest that any process has, or what is not a number.
    fn largest(&self, own: f64) -> f64;
}

/// What C works with: the system, and the panics of its code.
struct Frame<S> {
    system: S,
    guard: Guard,
}

impl<S> Frame<S> {
    fn new(system: S) -> Self {
        Frame {
            system,
            guard: Guard::default(),
        }
    }
}

/// # Safety
/// `user_data` is the address of a live frame of this system.
unsafe fn frame<'f, S>(user_data: *mut c_void) -> &'f Frame<S> {
    // SAFETY: the caller's promise.
    unsafe { &*user_data.cast() }
}
