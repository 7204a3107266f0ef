//! Sums of products of 31-digit numbers in vector registers, against the operations one by one: to the last bit.

use proptest::prelude::*;
use twinslip::internals::Element;
use twinslip::number::DoubleDouble;

fn number() -> impl Strategy<Value = DoubleDouble> {
    (-1.0..1.0, -1.0..1.0, -60..60)
        .prop_map(|(a, b, power)| DoubleDouble::new(a, 1e-17 * b) * f64::powi(2.0, power))
}

/// The sums of a_j b_(n-1-j) over the j of the same remainder by four.
fn one_by_one(a: &[DoubleDouble], b: &[DoubleDouble]) -> [DoubleDouble; 4] {
    let mut sums = [DoubleDouble::ZERO; 4];
    for (j, (a, b)) in a.iter().zip(b.iter().rev()).enumerate() {
        sums[j % 4] = *a * *b + sums[j % 4];
    }
    sums
}

fn bits(sums: [DoubleDouble; 4]) -> [[u64; 2]; 4] {
    // 0 has two signs.
    sums.map(|x| [x.hi() + 0.0, x.lo() + 0.0].map(f64::to_bits))
}

proptest! {
    #[test]
    fn four_sums_are_those_of_single_operations(
        pairs in prop::collection::vec((number(), number()), 0..40),
    ) {
        let (a, b): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
        if let Some(sums) = DoubleDouble::four_sums(&a, &b) {
            prop_assert_eq!(bits(sums), bits(one_by_one(&a, &b)));
        }
    }
}

/// Where products overflow the operations know how to go on; the registers leave it to them.
#[test]
fn what_overflows_is_left_to_single_operations() {
    let large = DoubleDouble::from(1e200);
    for count in [1, 4, 7] {
        let mut a = vec![DoubleDouble::ONE; count];
        a[count - 1] = large;
        assert!(DoubleDouble::four_sums(&a, &vec![large; count]).is_none());
        a[count - 1] = DoubleDouble::from(f64::NAN);
        assert!(DoubleDouble::four_sums(&a, &vec![large; count]).is_none());
    }
}
