//! Vectors of a fixed length behind SUNDIALS's interface, and the owner of any vector.
//!
//! SUNDIALS's own serial vector finds its length and its data through two pointers and loops; at length 3 that is half of
//! CVODE's time. Here the content is the array itself and its length a constant, so that the loops unroll. Sums are taken in
//! the order of the serial vector: the results are the same to the last bit.
#![allow(unsafe_code)]

use super::{Context, null};
use crate::error::Result;
use crate::field::State;
use std::ffi::{c_int, c_void};
use std::ptr::{self, NonNull};
use sundials_sys::{N_Vector, N_Vector_ID, sunindextype};

/// Where the numbers of a vector are: the one thing that callbacks must know of it.
pub(super) trait Storage {
    /// # Safety
    /// `v` is a live vector of this storage.
    unsafe fn data(v: N_Vector) -> *mut f64;
}

/// Our own vectors.
pub(super) struct OwnVectors;

impl Storage for OwnVectors {
    #[inline(always)]
    unsafe fn data(v: N_Vector) -> *mut f64 {
        // SAFETY: the content of our vectors is the array.
        unsafe { (*v).content.cast() }
    }
}

/// SUNDIALS's serial vectors.
pub(super) struct Serial;

impl Storage for Serial {
    #[inline(always)]
    unsafe fn data(v: N_Vector) -> *mut f64 {
        // SAFETY: this is the macro NV_DATA_S.
        unsafe { (*(*v).content.cast::<sundials_sys::_N_VectorContent_Serial>()).data }
    }
}

/// # Safety
/// `v` is a live vector of storage `S` and length N.
#[inline(always)]
pub(super) unsafe fn read<S: Storage, const N: usize>(v: N_Vector) -> State<N> {
    // SAFETY: the caller's promise; the array is copied.
    State::from(unsafe { *S::data(v).cast::<[f64; N]>() })
}

/// # Safety
/// `v` is a live vector of storage `S` and length N.
#[inline(always)]
pub(super) unsafe fn write<S: Storage, const N: usize>(v: N_Vector, y: &State<N>) {
    // SAFETY: the caller's promise; nothing borrows the array.
    unsafe { *S::data(v).cast::<[f64; N]>() = y.data.0[0] };
}

/// The owner of a vector.
pub(super) struct NVector(NonNull<sundials_sys::_generic_N_Vector>);

impl NVector {
    /// # Safety
    /// A live vector that nothing else owns.
    pub(super) unsafe fn owned(v: NonNull<sundials_sys::_generic_N_Vector>) -> Self {
        NVector(v)
    }

    /// A vector of SUNDIALS's own, zero.
    pub fn serial<const N: usize>(context: &Context) -> Result<Self> {
        // SAFETY: a live context, which the solver keeps longer than its vectors.
        let v = unsafe { sundials_sys::N_VNew_Serial(N as sunindextype, context.as_ptr()) };
        let mut vector = NVector(NonNull::new(v).ok_or_else(|| null("N_VNew_Serial"))?);
        vector.set(&State::<N>::zeros());
        Ok(vector)
    }

    /// A vector of ours, zero.
    pub fn fixed<const N: usize>(context: &Context) -> Result<Self> {
        // SAFETY: a live context, which the solver keeps longer than its vectors.
        let v = unsafe { sundials_sys::N_VNewEmpty(context.as_ptr()) };
        let vector = NVector(NonNull::new(v).ok_or_else(|| null("N_VNewEmpty"))?);
        // SAFETY: N_VNewEmpty made the table of operations, all NULL, and this vector is ours alone. The content is
        // freed by `destroy`, which is in the table from here on.
        unsafe {
            install::<N>(&mut *(*v).ops);
            (*v).content = Box::into_raw(Box::new([0.0_f64; N])).cast();
        }
        Ok(vector)
    }

    pub fn as_ptr(&self) -> N_Vector {
        self.0.as_ptr()
    }

    /// The numbers; N must be the length.
    pub fn get<const N: usize>(&self) -> State<N> {
        // SAFETY: a live vector; both storages keep N contiguous numbers, copied here. It is private to the folder that N
        // is the length it was made with, since solvers of one N make all their vectors with it.
        unsafe { State::from(*sundials_sys::N_VGetArrayPointer(self.as_ptr()).cast::<[f64; N]>()) }
    }

    pub fn set<const N: usize>(&mut self, y: &State<N>) {
        // SAFETY: as in `get`; the borrow is exclusive.
        unsafe {
            *sundials_sys::N_VGetArrayPointer(self.as_ptr()).cast::<[f64; N]>() = y.data.0[0];
        }
    }
}

impl Drop for NVector {
    fn drop(&mut self) {
        // SAFETY: a live vector that this value alone owns.
        unsafe { sundials_sys::N_VDestroy(self.as_ptr()) };
    }
}

fn install<const N: usize>(ops: &mut sundials_sys::_generic_N_Vector_Ops) {
    ops.nvgetvectorid = Some(id);
    ops.nvclone = Some(clone::<N>);
    ops.nvdestroy = Some(destroy::<N>);
    ops.nvgetarraypointer = Some(array_pointer);
    ops.nvgetlength = Some(length::<N>);
    ops.nvlinearsum = Some(linear_sum::<N>);
    ops.nvconst = Some(constant::<N>);
    ops.nvprod = Some(product::<N>);
    ops.nvdiv = Some(quotient::<N>);
    ops.nvscale = Some(scale::<N>);
    ops.nvabs = Some(absolute::<N>);
    ops.nvinv = Some(inverse::<N>);
    ops.nvaddconst = Some(add_constant::<N>);
    ops.nvdotprod = Some(dot_product::<N>);
    ops.nvmaxnorm = Some(max_norm::<N>);
    ops.nvwrmsnorm = Some(wrms_norm::<N>);
    ops.nvmin = Some(minimum::<N>);
    ops.nvwl2norm = Some(wl2_norm::<N>);
    ops.nvconstrmask = Some(constraint_mask::<N>);
    ops.nvminquotient = Some(min_quotient::<N>);
    ops.nvlinearcombination = Some(linear_combination::<N>);
    ops.nvscaleaddmulti = Some(scale_add_multi::<N>);
    ops.nvlinearsumvectorarray = Some(linear_sum_array::<N>);
    ops.nvscalevectorarray = Some(scale_array::<N>);
    ops.nvconstvectorarray = Some(constant_array::<N>);
    ops.nvwrmsnormvectorarray = Some(wrms_norm_array::<N>);
    ops.nvscaleaddmultivectorarray = Some(scale_add_multi_array::<N>);
    ops.nvlinearcombinationvectorarray = Some(linear_combination_array::<N>);
}

// The operations. SUNDIALS calls them with live vectors cloned from ours, hence of length N, and with arrays of the counts
// it says; vectors may be the same, so inputs are copied before the result is written.

/// # Safety
/// `v` is one of our vectors of length N.
#[inline(always)]
unsafe fn get<const N: usize>(v: N_Vector) -> [f64; N] {
    // SAFETY: the caller's promise.
    unsafe { *(*v).content.cast() }
}

/// # Safety
/// `v` is one of our vectors of length N.
#[inline(always)]
unsafe fn put<const N: usize>(v: N_Vector, x: [f64; N]) {
    // SAFETY: the caller's promise.
    unsafe { *(*v).content.cast() = x };
}

/// # Safety
/// Both are our vectors of length N.
#[inline(always)]
unsafe fn map<const N: usize>(x: N_Vector, z: N_Vector, f: impl Fn(f64) -> f64) {
    // SAFETY: the caller's promise.
    unsafe {
        let mut x = get::<N>(x);
        for value in &mut x {
            *value = f(*value);
        }
        put(z, x);
    }
}

/// # Safety
/// All are our vectors of length N.
#[inline(always)]
unsafe fn zip<const N: usize>(x: N_Vector, y: N_Vector, z: N_Vector, f: impl Fn(f64, f64) -> f64) {
    // SAFETY: the caller's promise.
    unsafe {
        let (mut x, y) = (get::<N>(x), get::<N>(y));
        for i in 0..N {
            x[i] = f(x[i], y[i]);
        }
        put(z, x);
    }
}

/// # Safety
/// Both are our vectors of length N.
#[inline(always)]
unsafe fn weighted_squares<const N: usize>(x: N_Vector, w: N_Vector) -> f64 {
    // SAFETY: the caller's promise.
    let (x, w) = unsafe { (get::<N>(x), get::<N>(w)) };
    let mut sum = 0.0;
    for i in 0..N {
        sum += (x[i] * w[i]) * (x[i] * w[i]);
    }
    sum
}

/// Defines operations that C calls.
macro_rules! operations {
    ($($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),*) $(-> $result:ty)? $body:block)*) => {$(
        $(#[$doc])*
        unsafe extern "C" fn $name<const N: usize>($($argument: $type),*) $(-> $result)? {
            // SAFETY: SUNDIALS calls the operation with live vectors made or cloned by us, hence of length N, and with
            // arrays as long as the counts that it passes.
            unsafe { $body }
        }
    )*};
}

unsafe extern "C" fn id(_: N_Vector) -> N_Vector_ID {
    sundials_sys::N_Vector_ID_SUNDIALS_NVEC_CUSTOM
}

unsafe extern "C" fn length<const N: usize>(_: N_Vector) -> sunindextype {
    N as sunindextype
}

unsafe extern "C" fn array_pointer(v: N_Vector) -> *mut f64 {
    // SAFETY: one of our vectors.
    unsafe { OwnVectors::data(v) }
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
        (*w).content = Box::into_raw(Box::new([0.0_f64; N])).cast();
        w
    }

    fn destroy(v: N_Vector) {
        if v.is_null() {
            return;
        }
        if !(*v).content.is_null() {
            drop(Box::from_raw((*v).content.cast::<[f64; N]>()));
            (*v).content = ptr::null_mut::<c_void>();
        }
        sundials_sys::N_VFreeEmpty(v);
    }

    fn linear_sum(a: f64, x: N_Vector, b: f64, y: N_Vector, z: N_Vector) {
        // The cases in which the serial vector rounds otherwise.
        if a == b {
            zip::<N>(x, y, z, |x, y| a * (x + y));
        } else if a == -b {
            zip::<N>(x, y, z, |x, y| a * (x - y));
        } else {
            zip::<N>(x, y, z, |x, y| a * x + b * y);
        }
    }

    fn constant(c: f64, z: N_Vector) {
        put(z, [c; N]);
    }

    fn product(x: N_Vector, y: N_Vector, z: N_Vector) {
        zip::<N>(x, y, z, |x, y| x * y);
    }

    fn quotient(x: N_Vector, y: N_Vector, z: N_Vector) {
        zip::<N>(x, y, z, |x, y| x / y);
    }

    fn scale(c: f64, x: N_Vector, z: N_Vector) {
        map::<N>(x, z, |x| c * x);
    }

    fn absolute(x: N_Vector, z: N_Vector) {
        map::<N>(x, z, f64::abs);
    }

    fn inverse(x: N_Vector, z: N_Vector) {
        map::<N>(x, z, |x| 1.0 / x);
    }

    fn add_constant(x: N_Vector, b: f64, z: N_Vector) {
        map::<N>(x, z, |x| x + b);
    }

    fn dot_product(x: N_Vector, y: N_Vector) -> f64 {
        let (x, y) = (get::<N>(x), get::<N>(y));
        let mut sum = 0.0;
        for i in 0..N {
            sum += x[i] * y[i];
        }
        sum
    }

    // Unlike f64::max, keeps a NaN.
    fn max_norm(x: N_Vector) -> f64 {
        let mut max = 0.0;
        for value in get::<N>(x) {
            if value.abs() > max || value.is_nan() {
                max = value.abs();
            }
        }
        max
    }

    fn wrms_norm(x: N_Vector, w: N_Vector) -> f64 {
        (weighted_squares::<N>(x, w) / N as f64).sqrt()
    }

    fn minimum(x: N_Vector) -> f64 {
        get::<N>(x).into_iter().fold(f64::MAX, |min, x| if x < min { x } else { min })
    }

    fn wl2_norm(x: N_Vector, w: N_Vector) -> f64 {
        weighted_squares::<N>(x, w).sqrt()
    }

    // As N_VConstrMask_Serial: c is 2 for > 0, 1 for >= 0, 0 for free, and so on below; m marks what is violated.
    fn constraint_mask(c: N_Vector, x: N_Vector, m: N_Vector) -> c_int {
        let (c, x) = (get::<N>(c), get::<N>(x));
        let mut mask = [0.0; N];
        for i in 0..N {
            let strict = c[i].abs() > 1.5 && x[i] * c[i] <= 0.0;
            let weak = c[i].abs() > 0.5 && x[i] * c[i] < 0.0;
            if strict || weak {
                mask[i] = 1.0;
            }
        }
        put(m, mask);
        c_int::from(mask == [0.0; N])
    }

    fn min_quotient(numerator: N_Vector, denominator: N_Vector) -> f64 {
        let (n, d) = (get::<N>(numerator), get::<N>(denominator));
        let mut min = f64::MAX;
        for i in 0..N {
            if d[i] != 0.0 && n[i] / d[i] < min {
                min = n[i] / d[i];
            }
        }
        min
    }

    // z = sum of c_j x_j
    fn linear_combination(count: c_int, c: *mut f64, x: *mut N_Vector, z: N_Vector) -> c_int {
        let mut sum = get::<N>(*x);
        for value in &mut sum {
            *value *= *c;
        }
        for j in 1..count as usize {
            let (c, x) = (*c.add(j), get::<N>(*x.add(j)));
            for i in 0..N {
                sum[i] += c * x[i];
            }
        }
        put(z, sum);
        0
    }

    // z_j = a_j x + y_j
    fn scale_add_multi(count: c_int, a: *mut f64, x: N_Vector, y: *mut N_Vector, z: *mut N_Vector) -> c_int {
        let x = get::<N>(x);
        for j in 0..count as usize {
            let (a, mut y) = (*a.add(j), get::<N>(*y.add(j)));
            for i in 0..N {
                y[i] += a * x[i];
            }
            put(*z.add(j), y);
        }
        0
    }

    fn linear_sum_array(count: c_int, a: f64, x: *mut N_Vector, b: f64, y: *mut N_Vector, z: *mut N_Vector) -> c_int {
        for j in 0..count as usize {
            linear_sum::<N>(a, *x.add(j), b, *y.add(j), *z.add(j));
        }
        0
    }

    fn scale_array(count: c_int, c: *mut f64, x: *mut N_Vector, z: *mut N_Vector) -> c_int {
        for j in 0..count as usize {
            scale::<N>(*c.add(j), *x.add(j), *z.add(j));
        }
        0
    }

    fn constant_array(count: c_int, c: f64, z: *mut N_Vector) -> c_int {
        for j in 0..count as usize {
            constant::<N>(c, *z.add(j));
        }
        0
    }

    fn wrms_norm_array(count: c_int, x: *mut N_Vector, w: *mut N_Vector, norms: *mut f64) -> c_int {
        for j in 0..count as usize {
            *norms.add(j) = wrms_norm::<N>(*x.add(j), *w.add(j));
        }
        0
    }

    // z_ji = a_j x_i + y_ji
    fn scale_add_multi_array(count: c_int, sums: c_int, a: *mut f64, x: *mut N_Vector, y: *mut *mut N_Vector, z: *mut *mut N_Vector) -> c_int {
        for i in 0..count as usize {
            let x = get::<N>(*x.add(i));
            for j in 0..sums as usize {
                let (a, mut y) = (*a.add(j), get::<N>(*(*y.add(j)).add(i)));
                for k in 0..N {
                    y[k] += a * x[k];
                }
                put(*(*z.add(j)).add(i), y);
            }
        }
        0
    }

    // z_i = sum over j of c_j x_ji
    fn linear_combination_array(count: c_int, sums: c_int, c: *mut f64, x: *mut *mut N_Vector, z: *mut N_Vector) -> c_int {
        for i in 0..count as usize {
            let mut sum = get::<N>(*(*x).add(i));
            for value in &mut sum {
                *value *= *c;
            }
            for j in 1..sums as usize {
                let (c, x) = (*c.add(j), get::<N>(*(*x.add(j)).add(i)));
                for k in 0..N {
                    sum[k] += c * x[k];
                }
            }
            put(*z.add(i), sum);
        }
        0
    }
}
