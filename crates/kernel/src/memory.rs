//! Memory that holds code, and the call of it: all that is unsafe here.
//!
//! Pages are written first and made executable then; they are never both.
#![allow(unsafe_code)]

/// A vector of doubles in memory.
///
/// # Safety
/// A value is as many doubles one after the other as `COUNT` says, with nothing between or behind them, and any bits will do.
pub unsafe trait Doubles: Copy {
    /// The number of doubles.
    const COUNT: usize;
}

// SAFETY: a double, of any bits.
unsafe impl Doubles for f64 {
    const COUNT: usize = 1;
}

// SAFETY: arrays have nothing between their elements.
unsafe impl<const N: usize> Doubles for [f64; N] {
    const COUNT: usize = N;
}

#[cfg(target_arch = "x86_64")]
mod registers {
    use super::Doubles;
    use std::arch::x86_64::{__m128d, __m256d};

    // SAFETY: two doubles, of any bits.
    unsafe impl Doubles for __m128d {
        const COUNT: usize = 2;
    }

    // SAFETY: four doubles, of any bits.
    unsafe impl Doubles for __m256d {
        const COUNT: usize = 4;
    }
}

/// Makes a type of doubles ([`Doubles`]) of a struct of these two fields: the first one is doubles, and the second one has no size.
#[macro_export]
macro_rules! doubles {
    ($type:ident { $lanes:ident: $doubles:ty, $token:ident: $empty:ty }) => {
        const _: () = {
            // There are no other fields than these, of these types.
            #[allow(dead_code)]
            fn fields(of: $type) -> ($doubles, $empty) {
                let $type { $lanes, $token } = of;
                ($lanes, $token)
            }
            assert!(size_of::<$empty>() == 0);
            assert!(size_of::<$type>() == size_of::<$doubles>());
        };
        // SAFETY: the only field with a size is doubles, and the struct is as large.
        unsafe impl $crate::Doubles for $type {
            const COUNT: usize = <$doubles as $crate::Doubles>::COUNT;
        }
    };
}

/// A compiled list of operations.
#[derive(Debug)]
pub struct Kernel {
    pages: Pages,
    extents: [usize; 3],
}

/// The function that code is.
#[cfg(all(target_arch = "x86_64", unix))]
type Function = unsafe extern "sysv64" fn(*mut f64, *const f64, *const f64);
/// The function that code is.
#[cfg(not(all(target_arch = "x86_64", unix)))]
type Function = unsafe extern "C" fn(*mut f64, *const f64, *const f64);

impl Kernel {
    /// Of code that reads and writes so many doubles of the arrays that it is called with, and has no other effect.
    pub(crate) fn new(code: &[u8], extents: [usize; 3]) -> Option<Self> {
        let pages = Pages::of(code)?;
        Some(Kernel { pages, extents })
    }

    /// The bytes of its code.
    #[must_use]
    pub fn size(&self) -> usize {
        self.pages.length
    }

    /// Carries the operations out on these arrays.
    ///
    /// # Panics
    /// If an array is shorter than the operations reach.
    #[inline]
    pub fn run<R: Doubles, A: Doubles, B: Doubles>(
        &self,
        results: &mut [R],
        first: &[A],
        second: &[B],
    ) {
        let [of_results, of_first, of_second] = self.extents;
        assert!(results.len() * R::COUNT >= of_results, "results");
        assert!(first.len() * A::COUNT >= of_first, "first inputs");
        assert!(second.len() * B::COUNT >= of_second, "second inputs");
        // SAFETY: the pages hold the code of such a function, from their first byte on, and are executable.
        let function: Function = unsafe { std::mem::transmute(self.pages.begin) };
        // SAFETY: the function reads and writes no more of the arrays than their extents, which there are, of doubles of any bits; the
        // results are borrowed by nobody else. It keeps the registers that are to be kept.
        unsafe {
            function(
                results.as_mut_ptr().cast(),
                first.as_ptr().cast(),
                second.as_ptr().cast(),
            );
        }
    }
}

/// Pages of executable memory.
#[derive(Debug)]
struct Pages {
    begin: *mut u8,
    length: usize,
}

// SAFETY: nobody writes to the pages after they are made.
unsafe impl Send for Pages {}
// SAFETY: likewise.
unsafe impl Sync for Pages {}

#[cfg(all(unix, target_pointer_width = "64"))]
mod system {
    //! The functions and constants of POSIX, as the C library has them on Linux, Android, and the systems of BSD and Apple.

    use std::ffi::{c_int, c_void};

    pub const READ: c_int = 1;
    pub const WRITE: c_int = 2;
    pub const EXECUTE: c_int = 4;
    const PRIVATE: c_int = 2;
    const ANONYMOUS: c_int = if cfg!(any(target_os = "linux", target_os = "android")) {
        0x20
    } else {
        0x1000
    };
    pub const FLAGS: c_int = PRIVATE | ANONYMOUS;

    unsafe extern "C" {
        pub fn mmap(
            address: *mut c_void,
            length: usize,
            protection: c_int,
            flags: c_int,
            file: c_int,
            offset: i64,
        ) -> *mut c_void;
        pub fn mprotect(address: *mut c_void, length: usize, protection: c_int) -> c_int;
        pub fn munmap(address: *mut c_void, length: usize) -> c_int;
    }
}

#[cfg(all(unix, target_pointer_width = "64"))]
impl Pages {
    /// With this code; `None` where the system refuses.
    fn of(code: &[u8]) -> Option<Self> {
        use system::{EXECUTE, FLAGS, READ, WRITE, mmap, mprotect};
        if code.is_empty() {
            return None;
        }
        // SAFETY: new pages anywhere, of no file.
        let begin = unsafe { mmap(std::ptr::null_mut(), code.len(), READ | WRITE, FLAGS, -1, 0) };
        // The address of all ones says that there are none.
        if begin.is_null() || begin.addr() == usize::MAX {
            return None;
        }
        let pages = Pages {
            begin: begin.cast(),
            length: code.len(),
        };
        // SAFETY: the pages are as long as the code, writable, and nobody else knows them.
        unsafe { std::ptr::copy_nonoverlapping(code.as_ptr(), pages.begin, code.len()) };
        // SAFETY: these pages, which are not written any more.
        let protected = unsafe { mprotect(begin, code.len(), READ | EXECUTE) };
        (protected == 0).then_some(pages)
    }
}

#[cfg(all(unix, target_pointer_width = "64"))]
impl Drop for Pages {
    fn drop(&mut self) {
        // SAFETY: these pages, once, when nobody can call what they hold.
        unsafe { system::munmap(self.begin.cast(), self.length) };
    }
}

#[cfg(not(all(unix, target_pointer_width = "64")))]
impl Pages {
    fn of(_: &[u8]) -> Option<Self> {
        None
    }
}
