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

    /// One by one, if all are finite.
    #[inline(always)]
    fn exact(self) -> Option<[DoubleDouble; 4]> {
        let (hi, lo) = (self.hi.lanes(), self.lo.lanes());
        // Infinite or no number once, it is for good.
        let finite = hi.iter().chain(&lo).all(|x| x.is_finite());
        finite.then(|| std::array::from_fn(|i| DoubleDouble::of_finite(hi[i], lo[i])))
    }

    #[inline(always)]
    fn sum(self, o: Self) -> Self {
        let (sum, error) = two_sum(self.hi, o.hi);
        let (low_sum, low_error) = two_sum(self.lo, o.lo);
        let first = Self::normalised(sum, error + low_sum);
        Self::normalised(first.hi, first.lo + low_error)
    }

    /// With the products of one number and four. No closure does this: compiled for any processor, it would call every instruction.
    #[inline(always)]
    fn with_product(self, simd: V3, a: &DoubleDouble, b: [DoubleDouble; 4]) -> Self {
        self.sum(Numbers::of(simd, &[*a; 4]).product(Numbers::of(simd, &b)))
    }
}

/// The sums for four orders from k, with the products a_j b_(k-j) of coefficients from the fourth to before the k-th; `None` where the
/// processor has no such registers, or something on the way is not finite.
pub(super) fn sums_of_older(
    sums: [DoubleDouble; 4],
    [a, b]: [&[DoubleDouble]; 2],
) -> Option<[DoubleDouble; 4]> {
    let (simd, zero) = (vectors::avx2()?, DoubleDouble::ZERO);
    let ([b_0, b_1, b_2], newest) = (*b.first_chunk::<3>()?, a.last_chunk::<3>()?);
    let sums = simd.vectorize(
        #[inline(always)]
        || {
            let mut sums = Numbers::of(simd, &sums);
            for (a, b) in a.iter().zip(b.windows(4).rev()) {
                sums = sums.with_product(simd, a, [b[0], b[1], b[2], b[3]]);
            }
            // What is left are products for the later ones of these orders.
            sums = sums.with_product(simd, &newest[0], [zero, b_0, b_1, b_2]);
            sums = sums.with_product(simd, &newest[1], [zero, zero, b_0, b_1]);
            sums.with_product(simd, &newest[2], [zero, zero, zero, b_0])
        },
    );
    sums.exact()
}

/// The sums of three orders with what newest coefficients of two rows add, given the first of both: the one times the first of the
/// other.
pub(super) fn sums_with_newest(
    [a, b, c]: [DoubleDouble; 3],
    newest: [DoubleDouble; 2],
    first: [&[DoubleDouble; 3]; 2],
) -> Option<[DoubleDouble; 3]> {
    let (simd, zero) = (vectors::avx2()?, DoubleDouble::ZERO);
    let sums = simd.vectorize(
        #[inline(always)]
        || {
            let mut sums = Numbers::of(simd, &[a, b, c, zero]);
            for (newest, [a, b, c]) in newest.iter().zip(first.iter().rev()) {
                let first = Numbers::of(simd, &[*a, *b, *c, zero]);
                sums = sums.sum(Numbers::of(simd, &[*newest; 4]).product(first));
            }
            sums
        },
    );
    let [a, b, c, _] = sums.exact()?;
    Some([a, b, c])
}
