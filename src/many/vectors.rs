//! Work on eight lanes with the vectors of the machine.

use pulp::NullaryFnOnce;
#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};

/// Work that the processor's vectors do several lanes at a time.
pub(super) trait Vectorised: NullaryFnOnce + Sized {
    /// Does it with the vectors that the processor has and the user allows. The operations, and so all digits, are the same.
    fn vectorised(self) -> Self::Output {
        #[cfg(target_arch = "x86_64")]
        {
            use crate::series::{Vectors, used_vectors};
            let used = used_vectors();
            if used == Vectors::Avx512
                && let Some(simd) = V4::try_new()
            {
                return simd.vectorize(self);
            }
            if used >= Vectors::Avx2
                && let Some(simd) = V3::try_new()
            {
                return simd.vectorize(self);
            }
        }
        self.call()
    }
}
