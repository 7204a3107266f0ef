//! Whether formulas are compiled to machine code while the program runs.

use crate::error::{Error, Result};
use std::sync::OnceLock;

/// The environment variable that says so: `on`, the default, `off` or `always`.
#[doc(hidden)]
pub const VARIABLE: &str = "TWINSLIP_COMPILE";

/// When a formula is compiled.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compiling {
    /// Never.
    Off,
    /// Once so many steps have been made of it that compiling it saves time.
    On,
    /// Before the first step.
    Always,
}

/// What the user allows. Asked once: it holds for the process.
///
/// # Errors
/// [`Error::Parameter`] for what is none of these; the default holds then.
#[doc(hidden)]
pub fn allowed() -> Result<Compiling> {
    static ALLOWED: OnceLock<Result<Compiling>> = OnceLock::new();
    let asked = || match std::env::var(VARIABLE).as_deref() {
        Err(_) | Ok("on") => Ok(Compiling::On),
        Ok("off") => Ok(Compiling::Off),
        Ok("always") => Ok(Compiling::Always),
        Ok(other) => Err(Error::unknown(VARIABLE, other, &["on", "off", "always"])),
    };
    ALLOWED.get_or_init(asked).clone()
}

impl Compiling {
    /// As it is told to users.
    #[doc(hidden)]
    pub fn in_words(self) -> &'static str {
        match self {
            Compiling::Off => "carried out in loops",
            Compiling::On => "compiled to machine code once a run has made enough steps",
            Compiling::Always => "compiled to machine code before the first step",
        }
    }
}

/// What holds for the process: without AVX2 nothing is compiled.
#[doc(hidden)]
pub fn used() -> Compiling {
    #[cfg(target_arch = "x86_64")]
    if super::vectors::avx2().is_some() {
        return allowed().unwrap_or(Compiling::On);
    }
    Compiling::Off
}
