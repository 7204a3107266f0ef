//! Sums of products, of which power series are made.

use super::element::Element;

/// sum of a_j b_(n-1-j) over j < n, n being the length of both. With four sums side by side: one or two would wait for each
/// other.
#[inline(always)]
pub(super) fn inner_product<T: Element>(a: &[T], b: &[T], zero: T) -> T {
    let sums = T::four_sums(a, b).unwrap_or_else(|| four_sums(a, b, zero));
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// Two of these with the same a, in two sums each.
#[inline(always)]
pub(super) fn inner_products<T: Element>(a: &[T], [b, c]: [&[T]; 2], zero: T) -> [T; 2] {
    let mut sums = [zero; 4];
    let (pairs, rest) = a.as_chunks::<2>();
    let ((rest_b, of_b), (rest_c, of_c)) = (b.as_rchunks::<2>(), c.as_rchunks::<2>());
    for (a, (b, c)) in pairs.iter().zip(of_b.iter().zip(of_c).rev()) {
        sums[0] = a[0].mul_add(b[1], sums[0]);
        sums[1] = a[1].mul_add(b[0], sums[1]);
        sums[2] = a[0].mul_add(c[1], sums[2]);
        sums[3] = a[1].mul_add(c[0], sums[3]);
    }
    if let ([a], [b], [c]) = (rest, rest_b, rest_c) {
        sums[0] = a.mul_add(*b, sums[0]);
        sums[2] = a.mul_add(*c, sums[2]);
    }
    [sums[0] + sums[1], sums[2] + sums[3]]
}

#[inline(always)]
fn four_sums<T: Element>(a: &[T], b: &[T], zero: T) -> [T; 4] {
    let mut sums = [zero; 4];
    let (blocks, rest) = a.as_chunks::<4>();
    let (rest_b, of_b) = b.as_rchunks::<4>();
    for (a, b) in blocks.iter().zip(of_b.iter().rev()) {
        for i in 0..4 {
            sums[i] = a[i].mul_add(b[3 - i], sums[i]);
        }
    }
    for (sum, (a, b)) in sums.iter_mut().zip(rest.iter().zip(rest_b.iter().rev())) {
        *sum = a.mul_add(*b, *sum);
    }
    sums
}
