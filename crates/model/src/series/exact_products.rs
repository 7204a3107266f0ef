//! Sums of products of numbers of 31 digits, four side by side in the processor's vector registers: most of the time that a
//! reference solution takes. The operations are those of [`DoubleDouble`], to the last bit: the rounding error of a product is
//! exact by a fused multiplication as by parts.

use super::element::Element;
use super::lanes::Four;
use super::vectors;
use crate::number::{DoubleDouble, two_sum};
use pulp::x86::V3;

/// Four numbers.
#[derive(Clone, Copy)]
struct Numbers {
    hi: Four,
    lo: Four,
}

impl Numbers {
    #[inline(always)]
    fn of(simd: V3, x: &[DoubleDouble; 4]) -> Self {
        let [a, b, c, d] = x;
        Numbers {
            hi: Four::new(simd, [a.hi(), b.hi(), c.hi(), d.hi()]),
            lo: Four::new(simd, [a.lo(), b.lo(), c.lo(), d.lo()]),
        }
    }

    /// Dekker's fast two-sum, of what is finite.
    #[inline(always)]
    fn normalised(sum: Four, error: Four) -> Self {
        let hi = sum + error;
        let lo = error - (hi - sum);
        Numbers { hi, lo }
    }

    #[inline(always)]
    fn product(self, o: Self) -> Self {
        let product = self.hi * o.hi;
        let error = self.hi.mul_add(o.hi, -product);
        let cross = self.hi * o.lo + self.lo * o.hi;
        Self::normalised(product, error + (cross + self.lo * o.lo))
    }

    #[inline(always)]
    fn sum(self, o: Self) -> Self {
        let (sum, error) = two_sum(self.hi, o.hi);
        let (low_sum, low_error) = two_sum(self.lo, o.lo);
        let first = Self::normalised(sum, error + low_sum);
        Self::normalised(first.hi, first.lo + low_error)
    }
}

/// The sums of a_j b_(n-1-j) over the j of the same remainder by four, n being the length of both; `None` where the processor has no
/// such registers, or something on the way is not finite.
pub(super) fn four_sums(a: &[DoubleDouble], b: &[DoubleDouble]) -> Option<[DoubleDouble; 4]> {
    let simd = vectors::avx2()?;
    let sums = simd.vectorize(
        #[inline(always)]
        || {
            let zero = [DoubleDouble::ZERO; 4];
            let mut sums = Numbers::of(simd, &zero);
            let (left, left_rest) = a.as_chunks::<4>();
            let (right_rest, right) = b.as_rchunks::<4>();
            for (a, [b_3, b_2, b_1, b_0]) in left.iter().zip(right.iter().rev()) {
                let b = Numbers::of(simd, &[*b_0, *b_1, *b_2, *b_3]);
                sums = sums.sum(Numbers::of(simd, a).product(b));
            }
            if !left_rest.is_empty() {
                let (mut a, mut b) = (zero, zero);
                let rest = left_rest.iter().zip(right_rest.iter().rev());
                for (i, (of_a, of_b)) in rest.enumerate() {
                    (a[i], b[i]) = (*of_a, *of_b);
                }
                sums = sums.sum(Numbers::of(simd, &a).product(Numbers::of(simd, &b)));
            }
            sums
        },
    );
    let (hi, lo) = (sums.hi.lanes(), sums.lo.lanes());
    // Infinite or no number once, it is for good.
    let finite = hi.iter().chain(&lo).all(|x| x.is_finite());
    finite.then(|| std::array::from_fn(|i| DoubleDouble::of_finite(hi[i], lo[i])))
}
