//! What differs between SUNDIALS 6 and 7, and the version found: the one file to touch for another major version.
//!
//! `build.rs` sets `cfg(sundials_major)` from the headers.
#![allow(unsafe_code)]

use super::{Context, Messages, Stable};
use crate::error::Result;
use std::ffi::{CStr, c_char, c_int, c_void};

/// The functions that `sundials-sys` lacks, or that exist in one major version only.
#[allow(
    missing_docs,
    non_camel_case_types,
    non_snake_case,
    non_upper_case_globals,
    dead_code,
    clippy::all,
    clippy::undocumented_unsafe_blocks
)]
mod missing {
    include!(concat!(env!("OUT_DIR"), "/missing.rs"));
}

/// The version of the headers, whose major and minor number the linked library must have.
pub(super) const HEADERS: [i32; 3] = [
    missing::SUNDIALS_VERSION_MAJOR as i32,
    missing::SUNDIALS_VERSION_MINOR as i32,
    missing::SUNDIALS_VERSION_PATCH as i32,
];

// The same trap as in `linked_version`, caught as early as it can be.
const _: () = assert!(
    sundials_sys::SUNDIALS_VERSION_MAJOR == missing::SUNDIALS_VERSION_MAJOR,
    "sundials-sys was built for another major version of SUNDIALS than the headers found: install libclang-dev and build afresh"
);

/// The version of the library linked.
pub(super) fn linked() -> [i32; 3] {
    let mut version = [0; 3];
    let [major, minor, patch] = &mut version;
    let mut label = [0 as c_char; 32];
    // SAFETY: three valid places for numbers, and a buffer with its length.
    unsafe {
        missing::SUNDIALSGetVersionNumber(
            major,
            minor,
            patch,
            label.as_mut_ptr(),
            label.len() as c_int,
        )
    };
    version
}

/// # Safety
/// `message` is NULL or a C string; `data` is the address of a live [`Messages`].
unsafe fn keep(code: c_int, message: *const c_char, data: *mut c_void) {
    // SAFETY: the caller's promise.
    let (messages, message) = unsafe {
        if message.is_null() || data.is_null() {
            return;
        }
        (&*data.cast::<Messages>(), CStr::from_ptr(message))
    };
    if code != messages.expected.get() {
        messages.keep(&message.to_string_lossy());
    }
}

#[cfg(sundials_major = "6")]
mod major {
    use super::*;
    use crate::sundials::check;

    /// # Safety
    /// As SUNDIALS 6 calls it: C strings, and the data given with the handler.
    unsafe extern "C" fn handler(
        code: c_int,
        _module: *const c_char,
        _function: *const c_char,
        message: *mut c_char,
        data: *mut c_void,
    ) {
        // SAFETY: SUNDIALS gives a C string, and the data are the solver's Messages.
        unsafe { keep(code, message, data) };
    }

    /// Version 6 has error handlers of the solvers, none of the context.
    pub fn keep_context_messages(_: &Context, _: &Stable<Messages>) -> Result<()> {
        Ok(())
    }

    /// # Safety
    /// `memory` is a live CVODE memory whose solver keeps `messages` for longer.
    pub unsafe fn keep_cvode_messages(
        memory: *mut c_void,
        messages: &Stable<Messages>,
    ) -> Result<()> {
        // SAFETY: the caller's promise; the handler has the type that is asked for.
        unsafe {
            check!(
                CV,
                messages,
                missing::CVodeSetErrHandlerFn(memory, Some(handler), messages.as_ptr())
            )?;
        }
        Ok(())
    }

    /// # Safety
    /// `memory` is a live KINSOL memory whose solver keeps `messages` for longer.
    pub unsafe fn keep_kinsol_messages(
        memory: *mut c_void,
        messages: &Stable<Messages>,
    ) -> Result<()> {
        // SAFETY: the caller's promise; the handler has the type that is asked for.
        unsafe {
            check!(
                KIN,
                messages,
                missing::KINSetErrHandlerFn(memory, Some(handler), messages.as_ptr())
            )?;
        }
        Ok(())
    }
}

#[cfg(sundials_major = "7")]
mod major {
    use super::*;
    use crate::sundials::check;

    /// # Safety
    /// As SUNDIALS 7 calls it: C strings, and the data given with the handler.
    unsafe extern "C" fn handler(
        _line: c_int,
        _function: *const c_char,
        _file: *const c_char,
        message: *const c_char,
        code: missing::SUNErrCode,
        data: *mut c_void,
        _context: missing::SUNContext,
    ) {
        // SAFETY: SUNDIALS gives a C string or NULL, and the data are the solver's Messages.
        unsafe { keep(code, message, data) };
    }

    /// Takes the place of the handler that prints.
    pub fn keep_context_messages(context: &Context, messages: &Stable<Messages>) -> Result<()> {
        let context: missing::SUNContext = context.as_ptr().cast();
        // SAFETY: a live context; the solver keeps the messages longer than the context.
        unsafe {
            check!(SUN, messages, missing::SUNContext_ClearErrHandlers(context))?;
            check!(
                SUN,
                messages,
                missing::SUNContext_PushErrHandler(context, Some(handler), messages.as_ptr())
            )?;
        }
        Ok(())
    }

    /// Version 7 has error handlers of the context, none of the solvers.
    ///
    /// # Safety
    /// None is needed; the signature is that of version 6.
    pub unsafe fn keep_cvode_messages(_: *mut c_void, _: &Stable<Messages>) -> Result<()> {
        Ok(())
    }

    /// Version 7 has error handlers of the context, none of the solvers.
    ///
    /// # Safety
    /// None is needed; the signature is that of version 6.
    pub unsafe fn keep_kinsol_messages(_: *mut c_void, _: &Stable<Messages>) -> Result<()> {
        Ok(())
    }
}

pub(super) use major::{keep_context_messages, keep_cvode_messages, keep_kinsol_messages};
