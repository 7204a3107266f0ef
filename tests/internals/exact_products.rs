//! Sums of products of 31-digit numbers in vector registers, against the operations one by one: to the last bit.

use proptest::prelude::*;
use twinslip::internals::Element;
use twinslip::number::DoubleDouble;

fn number() -> impl Strategy<Value = DoubleDouble> {
    (-1.0..1.0, -1.0..1.0, -60..60)
        .prop_map(|(a, b, power)| DoubleDouble::new(a, 1e-17 * b) * f64::powi(2.0, power))
}

fn numbers<const N: usize>() -> impl Strategy<Value = [DoubleDouble; N]> {
    prop::collection::vec(number(), N).prop_map(|all| all.try_into().expect("so many"))
}

/// The sums of the orders from k with a_j b_(order-j), of coefficients from the fourth to before the k-th.
fn with_older(mut sums: [DoubleDouble; 4], [a, b]: [&[DoubleDouble]; 2]) -> [DoubleDouble; 4] {
    let k = 4 + a.len();
    for (order, sum) in (k..).zip(&mut sums) {
        for j in order - k + 1..k {
            if j >= 4 && order - j >= 4 && order - j < k {
                *sum = a[j - 4] * b[order - j - 4] + *sum;
            }
        }
    }
    sums
}

fn bits<const N: usize>(sums: [DoubleDouble; N]) -> [[u64; 2]; N] {
    // 0 has two signs.
    sums.map(|x| [x.hi() + 0.0, x.lo() + 0.0].map(f64::to_bits))
}

proptest! {
    #[test]
    fn sums_of_older_products_are_those_of_single_operations(
        sums in numbers::<4>(),
        blocks in prop::collection::vec((numbers::<4>(), numbers::<4>()), 1..8),
    ) {
        let (a, b): (Vec<_>, Vec<_>) = blocks.into_iter().unzip();
        let rows = [a.as_flattened(), b.as_flattened()];
        if let Some(made) = DoubleDouble::sums_of_older(sums, rows) {
            prop_assert_eq!(bits(made), bits(with_older(sums, rows)));
        }
    }

    #[test]
    fn sums_with_newest_products_are_those_of_single_operations(
        sums in numbers::<3>(),
        newest in numbers::<2>(),
        first in (numbers::<3>(), numbers::<3>()),
    ) {
        let [a, b] = newest;
        let (of_a, of_b) = &first;
        let single = std::array::from_fn(|j| b * of_a[j] + (a * of_b[j] + sums[j]));
        if let Some(made) = DoubleDouble::sums_with_newest(sums, newest, [of_a, of_b]) {
            prop_assert_eq!(bits(made), bits::<3>(single));
        }
    }
}

/// Where products overflow the operations know how to go on; the registers leave it to them.
#[test]
fn what_overflows_is_left_to_single_operations() {
    let (large, one) = (DoubleDouble::from(1e200), DoubleDouble::ONE);
    let sums = [DoubleDouble::ZERO; 4];
    for count in [4, 8] {
        let mut a = vec![one; count];
        for what in [large, DoubleDouble::from(f64::NAN)] {
            a[count - 1] = what;
            assert!(DoubleDouble::sums_of_older(sums, [&a, &vec![large; count]]).is_none());
        }
    }
    let [sums, first] = [[DoubleDouble::ZERO; 3], [large; 3]];
    assert!(DoubleDouble::sums_with_newest(sums, [large, one], [&first, &first]).is_none());
}
