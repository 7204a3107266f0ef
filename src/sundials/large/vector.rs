//! Vectors of any length behind SUNDIALS's interface, worked on by all cores where they are long.
#![allow(unsafe_code)]

use super::LinearTime;
use crate::error::Result;
use crate::sundials::vector::NVector;
use crate::sundials::{Context, null};
use rayon::prelude::*;
use std::ffi::{c_int, c_void};
use std::ptr::{self, NonNull};
use sundials_sys::{N_Vector, N_Vector_ID, sunindextype};

/// Numbers that one core works on at a time.
const PIECE: usize = 4096;
/// Lengths from which on several cores pay.
const LONG: usize = 65_536;

/// The content of a vector.
struct Content<S> {
    numbers: Vec<f64>,
    /// Whose vector it is: it knows the numbers of other processes.
    system: *const S,
}

/// A vector with these numbers, of a system that lives longer.
pub(super) fn vector<S: LinearTime>(
    context: &Context,
    system: &S,
    numbers: Vec<f64>,
) -> Result<NVector> {
    // SAFETY: a live context, which the solver keeps longer than its vectors.
    let v = unsafe { sundials_sys::N_VNewEmpty(context.as_ptr()) };
    let v = NonNull::new(v).ok_or_else(|| null("N_VNewEmpty"))?;
    let content = Box::new(Content { numbers, system });
    // SAFETY: N_VNewEmpty made the table of operations, all NULL, and this vector is ours alone. The content is freed by `destroy`,
    // which is in the table from here on.
    unsafe {
        install::<S>(&mut *(*v.as_ptr()).ops);
        (*v.as_ptr()).content = Box::into_raw(content).cast();
        Ok(NVector::owned(v))
    }
}

/// The numbers of a vector.
///
/// # Safety
/// `v` is a live vector of this system, and nothing writes to it for the life of the result.
pub(super) unsafe fn numbers<'v, S>(v: N_Vector) -> &'v [f64] {
    // SAFETY: the caller's promise.
    unsafe { &(*(*v).content.cast::<Content<S>>()).numbers }
}

/// The same to write to.
///
/// # Safety
/// `v` is a live vector of this system, and nothing else reads it or writes to it for the life of the result.
pub(super) unsafe fn numbers_mut<'v, S>(v: N_Vector) -> &'v mut [f64] {
    // SAFETY: the caller's promise.
    unsafe { &mut (*(*v).content.cast::<Content<S>>()).numbers }
}

fn install<S: LinearTime>(ops: &mut sundials_sys::_generic_N_Vector_Ops) {
    ops.nvgetvectorid = Some(id);
    ops.nvclone = Some(clone::<S>);
    ops.nvdestroy = Some(destroy::<S>);
    ops.nvgetlength = Some(length::<S>);
    ops.nvlinearsum = Some(linear_sum::<S>);
    ops.nvconst = Some(constant::<S>);
    ops.nvprod = Some(product::<S>);
    ops.nvdiv = Some(quotient::<S>);
    ops.nvscale = Some(scale::<S>);
    ops.nvabs = Some(absolute::<S>);
    ops.nvinv = Some(inverse::<S>);
    ops.nvaddconst = Some(add_constant::<S>);
    ops.nvdotprod = Some(dot_product::<S>);
    ops.nvmaxnorm = Some(max_norm::<S>);
    ops.nvwrmsnorm = Some(weighted_norm::<S>);
    ops.nvwl2norm = Some(weighted_length::<S>);
    ops.nvmin = Some(minimum::<S>);
    ops.nvlinearcombination = Some(linear_combination::<S>);
    ops.nvscaleaddmulti = Some(scale_add_multi::<S>);
}

/// Where the numbers of a vector are, for all cores.
#[derive(Clone, Copy)]
struct Place(*mut f64);

// SAFETY: cores work on pieces that are apart.
unsafe impl Send for Place {}
// SAFETY: the same.
unsafe impl Sync for Place {}

impl Place {
    /// # Safety
    /// `v` is a live vector of this system.
    unsafe fn of<S>(v: N_Vector) -> Self {
        // SAFETY: the caller's promise.
        Place(unsafe { (*(*v).content.cast::<Content<S>>()).numbers.as_mut_ptr() })
    }

    /// # Safety
    /// i is below the length.
    #[inline(always)]
    unsafe fn get(self, i: usize) -> f64 {
        // SAFETY: the caller's promise.
        unsafe { *self.0.add(i) }
    }

    /// # Safety
    /// i is below the length, and no other core has to do with that number.
    #[inline(always)]
    unsafe fn set(self, i: usize, x: f64) {
        // SAFETY: the caller's promise.
        unsafe { *self.0.add(i) = x }
    }
}

/// Pieces of a vector, by several cores if it is long.
fn by_pieces<T: Send>(
    length: usize,
    work: impl Fn(std::ops::Range<usize>) -> T + Send + Sync,
) -> Vec<T> {
    let pieces = length.div_ceil(PIECE);
    let piece = |i: usize| work(i * PIECE..length.min((i + 1) * PIECE));
    if length >= LONG {
        (0..pieces).into_par_iter().map(piece).collect()
    } else {
        (0..pieces).map(piece).collect()
    }
}

/// z_i = f(i) for all i below the length of z.
///
/// # Safety
/// `z` is a live vector of this system; f reads no number of it but the i-th.
#[inline(always)]
unsafe fn fill<S>(z: N_Vector, f: impl Fn(usize) -> f64 + Send + Sync) {
    // SAFETY: the caller's promise; pieces are apart.
    unsafe {
        let length = numbers::<S>(z).len();
        let place = Place::of::<S>(z);
        by_pieces(length, move |range| {
            let place = place;
            for i in range {
                place.set(i, f(i));
            }
        });
    }
}

/// The largest |f(i)| of all processes, or what is not a number.
///
/// # Safety
/// `x` is a live vector of this system.
#[inline(always)]
unsafe fn largest<S: LinearTime>(x: N_Vector, f: impl Fn(usize) -> f64 + Send + Sync) -> f64 {
    let larger = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
    // SAFETY: the caller's promise; the system lives longer than its vectors.
    let (length, system) = unsafe {
        let content = &*(*x).content.cast::<Content<S>>();
        (content.numbers.len(), &*content.system)
    };
    let of_pieces = by_pieces(length, |range| range.map(|i| f(i).abs()).fold(0.0, larger));
    system.largest(of_pieces.into_iter().fold(0.0, larger))
}

/// The sum of f(i), in pieces.
///
/// # Safety
/// `x` is a live vector of this system.
#[inline(always)]
unsafe fn sum<S>(x: N_Vector, f: impl Fn(usize) -> f64 + Send + Sync) -> f64 {
    // SAFETY: the caller's promise.
    let length = unsafe { numbers::<S>(x) }.len();
    by_pieces(length, |range| range.map(&f).sum::<f64>())
        .iter()
        .sum()
}

/// Defines operations that C calls.
macro_rules! operations {
    ($($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),*) $(-> $result:ty)? $body:block)*) => {$(
        $(#[$doc])*
        unsafe extern "C" fn $name<S: LinearTime>($($argument: $type),*) $(-> $result)? {
            // SAFETY: SUNDIALS calls the operation with live vectors made or cloned by us, all of one system and length, and with arrays
            // as long as the counts that it passes. Vectors may be the same: number by number all are read before one is written.
            unsafe { $body }
        }
    )*};
}

unsafe extern "C" fn id(_: N_Vector) -> N_Vector_ID {
    sundials_sys::N_Vector_ID_SUNDIALS_NVEC_CUSTOM
}

operations! {
    fn clone(v: N_Vector) -> N_Vector {
        let w = sundials_sys::N_VNewEmpty((*v).sunctx);
        if w.is_null() {
            return ptr::null_mut();
        }
        if sundials_sys::N_VCopyOps(v, w) != 0 {
            sundials_sys::N_VFreeEmpty(w);
            return ptr::null_mut();
        }
        let content = &*(*v).content.cast::<Content<S>>();
        let numbers = vec![0.0; content.numbers.len()];
        let system = content.system;
        (*w).content = Box::into_raw(Box::new(Content { numbers, system })).cast();
        w
    }

    fn destroy(v: N_Vector) {
        if v.is_null() {
            return;
        }
        if !(*v).content.is_null() {
            drop(Box::from_raw((*v).content.cast::<Content<S>>()));
            (*v).content = ptr::null_mut::<c_void>();
        }
        sundials_sys::N_VFreeEmpty(v);
    }

    fn length(v: N_Vector) -> sunindextype {
        numbers::<S>(v).len() as sunindextype
    }

    fn linear_sum(a: f64, x: N_Vector, b: f64, y: N_Vector, z: N_Vector) {
        let (x, y) = (Place::of::<S>(x), Place::of::<S>(y));
        fill::<S>(z, move |i| { let (x, y) = (x, y); a * x.get(i) + b * y.get(i) });
    }

    fn constant(c: f64, z: N_Vector) {
        fill::<S>(z, move |_| c);
    }

    fn product(x: N_Vector, y: N_Vector, z: N_Vector) {
        let (x, y) = (Place::of::<S>(x), Place::of::<S>(y));
        fill::<S>(z, move |i| { let (x, y) = (x, y); x.get(i) * y.get(i) });
    }

    fn quotient(x: N_Vector, y: N_Vector, z: N_Vector) {
        let (x, y) = (Place::of::<S>(x), Place::of::<S>(y));
        fill::<S>(z, move |i| { let (x, y) = (x, y); x.get(i) / y.get(i) });
    }

    fn scale(c: f64, x: N_Vector, z: N_Vector) {
        let x = Place::of::<S>(x);
        fill::<S>(z, move |i| { let x = x; c * x.get(i) });
    }

    fn absolute(x: N_Vector, z: N_Vector) {
        let x = Place::of::<S>(x);
        fill::<S>(z, move |i| { let x = x; x.get(i).abs() });
    }

    fn inverse(x: N_Vector, z: N_Vector) {
        let x = Place::of::<S>(x);
        fill::<S>(z, move |i| { let x = x; 1.0 / x.get(i) });
    }

    fn add_constant(x: N_Vector, b: f64, z: N_Vector) {
        let x = Place::of::<S>(x);
        fill::<S>(z, move |i| { let x = x; x.get(i) + b });
    }

    // Only KINSOL's line search asks for these two, of directions in one process.
    fn dot_product(x: N_Vector, y: N_Vector) -> f64 {
        let (a, b) = (Place::of::<S>(x), Place::of::<S>(y));
        sum::<S>(x, move |i| { let (a, b) = (a, b); a.get(i) * b.get(i) })
    }

    fn weighted_length(x: N_Vector, w: N_Vector) -> f64 {
        let (a, w) = (Place::of::<S>(x), Place::of::<S>(w));
        sum::<S>(x, move |i| { let (a, w) = (a, w); (a.get(i) * w.get(i)).powi(2) }).sqrt()
    }

    fn max_norm(x: N_Vector) -> f64 {
        let a = Place::of::<S>(x);
        largest::<S>(x, move |i| { let a = a; a.get(i) })
    }

    fn weighted_norm(x: N_Vector, w: N_Vector) -> f64 {
        let (a, w) = (Place::of::<S>(x), Place::of::<S>(w));
        largest::<S>(x, move |i| { let (a, w) = (a, w); a.get(i) * w.get(i) })
    }

    fn minimum(x: N_Vector) -> f64 {
        let content = &*(*x).content.cast::<Content<S>>();
        let least = content.numbers.iter().copied().fold(f64::MAX, f64::min);
        // the largest of all numbers is what processes tell each other
        -(*content.system).largest(-least)
    }

    // z = sum of c_j x_j
    fn linear_combination(count: c_int, c: *mut f64, x: *mut N_Vector, z: N_Vector) -> c_int {
        let terms: Vec<(f64, Place)> = (0..count as usize)
            .map(|j| (*c.add(j), Place::of::<S>(*x.add(j))))
            .collect();
        fill::<S>(z, |i| terms.iter().map(|(c, x)| c * x.get(i)).sum());
        0
    }

    // z_j = a_j x + y_j
    fn scale_add_multi(count: c_int, a: *mut f64, x: N_Vector, y: *mut N_Vector, z: *mut N_Vector) -> c_int {
        for j in 0..count as usize {
            linear_sum::<S>(*a.add(j), x, 1.0, *y.add(j), *z.add(j));
        }
        0
    }
}
