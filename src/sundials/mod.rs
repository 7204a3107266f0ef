//! CVODES and KINSOL as safe types: the only folder of the crate with `unsafe`.
//!
//! [`Cvode`] integrates, [`Kinsol`] solves F(u) = 0; both with analytic Jacobians. The rules of the folder:
//!
//! 1. One C pointer is one private newtype over `NonNull` with one `Drop`, made only from a checked pointer, so that an
//!    early return frees what exists. Solvers declare them in the order in which they must go: solver memory, linear solver,
//!    matrix, vectors, context.
//! 2. Every C call that returns a code goes through `check!`: negative codes become [`Error::Sundials`], others are returned.
//! 3. User code runs behind `callback`: a panic in it is kept, C is told to stop, and it is resumed in Rust.
//! 4. SUNDIALS prints nothing: its messages are kept for the [`Error`].
//!
//! Supporting another major version of SUNDIALS is a matter of `native` alone.
#![allow(unsafe_code)]

mod callback;
mod cvode;
mod events;
mod kinsol;
mod large;
mod linear_solver;
mod native;
mod output;
mod sensitivity;
mod start;
mod vector;

pub use callback::{Events, Forcing, Problem};
pub use cvode::{Arrival, Cvode, Mode, MultistepMethod, Operations, Reason};
pub use kinsol::{Constraint, Kinsol, KinsolSettings, KinsolWork, Outcome, Residual, Strategy};
pub(crate) use large::{LargeCvode, LargeKinsol, LinearTime, Until};

pub use sensitivity::{ErrorControl, Sensitivity, SensitivityMethod};
pub(crate) use start::part_of_mean;

use crate::error::{Error, Result};
use std::cell::{Cell, RefCell};
use std::ffi::{c_int, c_void};
use std::ops::Deref;
use std::ptr::NonNull;
use std::sync::OnceLock;

/// The names of the flags, generated from the headers.
pub(crate) mod flags {
    include!(concat!(env!("OUT_DIR"), "/flags.rs"));
}

/// A table of flags with their names.
type Flags = &'static [(i32, &'static str)];

/// Calls a C function; a negative code becomes an [`Error::Sundials`] with the function's name, the flag's name from the
/// table and the message that SUNDIALS left. Must stand inside an `unsafe` block, which gives the reason.
macro_rules! check {
    ($table:ident, $messages:expr, $function:ident($($argument:expr),* $(,)?)) => {
        check!($table, $messages, sundials_sys::$function($($argument),*))
    };
    ($table:ident, $messages:expr, $home:ident::$function:ident($($argument:expr),* $(,)?)) => {{
        let code: i32 = $home::$function($($argument),*);
        if code < 0 {
            let table = $crate::sundials::flags::$table;
            Err($crate::sundials::failure(table, stringify!($function), code, None, $messages))
        } else {
            Ok(code)
        }
    }};
}
use check;

/// The error that a negative code stands for.
fn failure(
    table: Flags,
    function: &'static str,
    code: i32,
    time: Option<f64>,
    messages: &Messages,
) -> Error {
    Error::Sundials {
        function,
        name: flag_name(table, code),
        code,
        time,
        message: messages.take(),
    }
}

fn flag_name(table: Flags, code: i32) -> String {
    table.iter().find(|(value, _)| *value == code).map_or_else(
        || "a flag without a name".to_owned(),
        |(_, name)| (*name).to_owned(),
    )
}

/// The failure of a C constructor, which says no more than NULL.
fn null(function: &'static str) -> Error {
    Error::Sundials {
        function,
        name: "NULL".to_owned(),
        code: 0,
        time: None,
        message: "out of memory, or an argument that it refuses".to_owned(),
    }
}

/// The last message of SUNDIALS, where it would have printed.
#[derive(Default)]
struct Messages {
    last: RefCell<String>,
    /// A flag whose message is not worth keeping: a way of working, no failure.
    expected: Cell<c_int>,
}

impl Messages {
    /// Called by the error handlers, which C calls: must not panic.
    fn keep(&self, message: &str) {
        if let Ok(mut last) = self.last.try_borrow_mut() {
            last.clear();
            last.push_str(message.trim());
        }
    }

    fn take(&self) -> String {
        self.last.take()
    }

    fn clear(&self) {
        self.last.borrow_mut().clear();
    }
}

/// A value at an address that C may keep: it stays there while its owner moves.
struct Stable<T>(NonNull<T>);

impl<T> Stable<T> {
    fn new(value: T) -> Self {
        Stable(NonNull::from(Box::leak(Box::new(value))))
    }

    fn as_ptr(&self) -> *mut c_void {
        self.0.as_ptr().cast()
    }
}

impl<T> Deref for Stable<T> {
    type Target = T;

    fn deref(&self) -> &T {
        // SAFETY: the pointer came from a Box in `new`, is freed in `drop` only, and no `&mut T` to it is ever made.
        unsafe { self.0.as_ref() }
    }
}

impl<T> Drop for Stable<T> {
    fn drop(&mut self) {
        // SAFETY: the pointer came from a Box in `new`, and this is the only place that takes it back.
        drop(unsafe { Box::from_raw(self.0.as_ptr()) });
    }
}

/// A SUNContext: everything of one solver belongs to one context, and no context is shared.
struct Context(NonNull<c_void>);

impl Context {
    /// # Errors
    /// If the library is not of the version of the headers, or the context can't be made.
    fn new(messages: &Stable<Messages>) -> Result<Self> {
        linked_version()?;
        let mut context: sundials_sys::SUNContext = std::ptr::null_mut();
        // SAFETY: `context` is a valid place for the result; no MPI communicator is given.
        unsafe {
            check!(
                SUN,
                messages,
                SUNContext_Create(sundials_sys::comm_no_mpi(), &mut context)
            )?;
        }
        let context =
            Context(NonNull::new(context.cast()).ok_or_else(|| null("SUNContext_Create"))?);
        native::keep_context_messages(&context, messages)?;
        Ok(context)
    }

    fn as_ptr(&self) -> sundials_sys::SUNContext {
        self.0.as_ptr().cast()
    }
}

impl Drop for Context {
    fn drop(&mut self) {
        let mut context = self.as_ptr();
        // SAFETY: a live context that this value alone owns; solvers declare it last, so nothing made from it lives.
        unsafe { sundials_sys::SUNContext_Free(&mut context) };
    }
}

/// The version of SUNDIALS that is linked, such as `6.4.1`.
///
/// ```
/// assert!(twinslip::sundials::version().starts_with(['6', '7']));
/// ```
pub fn version() -> &'static str {
    static VERSION: OnceLock<String> = OnceLock::new();
    VERSION.get_or_init(|| {
        let [major, minor, patch] = native::linked();
        format!("{major}.{minor}.{patch}")
    })
}

/// A number of things as C counts them.
#[doc(hidden)]
pub fn counted(what: &str, count: usize) -> Result<c_int> {
    c_int::try_from(count).map_err(|_| Error::parameter(what, count, "at most 2147483647"))
}

/// sundials-sys turns to a source of its own, without a word, where it can't read the installed headers. What is linked then
/// is not what this crate was built for.
///
/// Functions, structures and the types of numbers and indices are the same within a minor version: the loader looks for the
/// library by its major version alone, and a distribution may update the patch.
fn linked_version() -> Result<()> {
    static SAME: OnceLock<bool> = OnceLock::new();
    if *SAME.get_or_init(|| compatible(native::linked(), native::HEADERS)) {
        return Ok(());
    }
    let [major, minor, _] = native::HEADERS;
    Err(Error::Sundials {
        function: "SUNDIALSGetVersionNumber",
        name: "another version".to_owned(),
        code: 0,
        time: None,
        message: format!(
            "built for SUNDIALS {major}.{minor}, but linked with {}; major and minor version must be the same: install libclang-dev and build afresh",
            version()
        ),
    })
}

/// Whether a library of this version does what headers of that one say.
#[doc(hidden)]
pub fn compatible(linked: [i32; 3], headers: [i32; 3]) -> bool {
    linked[..2] == headers[..2]
}
