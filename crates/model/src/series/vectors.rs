//! Which vector instructions are used: those that the processor has, or fewer if the user says so.
//!
//! Results differ by rounding between them. Machines of different kinds write the same bytes where all are held to what each
//! of them has.

use crate::error::{Error, Result};
#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};
use std::sync::OnceLock;

/// The environment variable that says so: `avx512`, which is all there is and the default, `avx2` or `none`.
#[doc(hidden)]
pub const VARIABLE: &str = "TWINSLIP_VECTORS";

/// Up to which instructions.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Vectors {
    /// One number at a time.
    None,
    /// Registers of four doubles.
    Avx2,
    /// Registers of eight.
    Avx512,
}

/// What the user allows. Asked once: it holds for the process.
///
/// # Errors
/// [`Error::Parameter`] for what is none of these; all is allowed then.
#[doc(hidden)]
pub fn allowed() -> Result<Vectors> {
    static ALLOWED: OnceLock<Result<Vectors>> = OnceLock::new();
    let asked = || match std::env::var(VARIABLE).as_deref() {
        Err(_) | Ok("avx512") => Ok(Vectors::Avx512),
        Ok("avx2") => Ok(Vectors::Avx2),
        Ok("none") => Ok(Vectors::None),
        Ok(other) => Err(Error::unknown(VARIABLE, other, &["avx512", "avx2", "none"])),
    };
    ALLOWED.get_or_init(asked).clone()
}

impl Vectors {
    /// As the variable has it: `avx512`, `avx2` or `none`.
    pub fn name(self) -> &'static str {
        match self {
            Vectors::None => "none",
            Vectors::Avx2 => "avx2",
            Vectors::Avx512 => "avx512",
        }
    }
}

/// What this process computes with: the widest that the processor has and the user allows.
#[doc(hidden)]
pub fn used() -> Vectors {
    #[cfg(target_arch = "x86_64")]
    {
        if avx512().is_some() {
            return Vectors::Avx512;
        }
        if avx2().is_some() {
            return Vectors::Avx2;
        }
    }
    Vectors::None
}

#[cfg(target_arch = "x86_64")]
fn allows(vectors: Vectors) -> bool {
    allowed().unwrap_or(Vectors::Avx512) >= vectors
}

/// The right to AVX2.
#[cfg(target_arch = "x86_64")]
#[doc(hidden)]
pub fn avx2() -> Option<V3> {
    V3::try_new().filter(|_| allows(Vectors::Avx2))
}

/// The right to AVX-512.
#[cfg(target_arch = "x86_64")]
#[doc(hidden)]
pub fn avx512() -> Option<V4> {
    V4::try_new().filter(|_| allows(Vectors::Avx512))
}
