//! Straight-line arithmetic on vectors of doubles, compiled to machine code when the program runs.
//!
//! A list of [`Operations`] becomes a [`Kernel`], a function of three arrays. Its results are those of [`execute()`], which carries the same
//! list out in Rust, bit by bit. There is code for x86-64 with AVX2 and FMA on Unix; elsewhere, and where the system allows no
//! memory to be executed, [`compile`] returns `None`, and the caller goes on without.
//!
//! Another processor is another [`target::Target`].

mod execute;
mod memory;
mod operations;
pub mod target;
#[cfg(all(target_arch = "x86_64", unix))]
mod x86_64;

pub use execute::execute;
pub use memory::{Doubles, Kernel};
pub use operations::{Array, Operation, Operations, Place, Signs, Value, Width};

use target::{Here, Target};

/// The operations as machine code, of at most so many bytes; `None` where there is none for this machine.
pub fn compile(operations: &Operations, most_bytes: usize) -> Option<Kernel> {
    if !Here::is_here() {
        return None;
    }
    let code = Here::assemble(operations, most_bytes)?;
    Kernel::new(&code, operations.extents())
}
