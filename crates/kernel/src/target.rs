//! The processors that there is code for.

use crate::operations::Operations;

/// A kind of processor.
pub trait Target {
    /// Whether this machine is one.
    fn is_here() -> bool;

    /// The code of a function that carries out the operations on the arrays that it is called with; `None` where it would be longer than so
    /// many bytes, or cannot be made.
    fn assemble(operations: &Operations, most_bytes: usize) -> Option<Vec<u8>>;
}

/// Any processor that there is no code for.
#[cfg(not(all(target_arch = "x86_64", unix)))]
pub struct Other;

#[cfg(not(all(target_arch = "x86_64", unix)))]
impl Target for Other {
    fn is_here() -> bool {
        false
    }

    fn assemble(_: &Operations, _: usize) -> Option<Vec<u8>> {
        None
    }
}

/// The processor that the program is compiled for.
#[cfg(all(target_arch = "x86_64", unix))]
pub type Here = crate::x86_64::Avx2;
/// The processor that the program is compiled for.
#[cfg(not(all(target_arch = "x86_64", unix)))]
pub type Here = Other;
