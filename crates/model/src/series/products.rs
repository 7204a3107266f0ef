//! Sums of products of older coefficients, of which power series are made: of a_j b_(k-j) over 0 < j < k.
//!
//! They are made for four orders k side by side. Products with one of the first coefficients are added as soon as the other
//! coefficient is there, to the sums of the next orders: always the same few operations, whatever the order. The products of all
//! other coefficients are there before the first of the four orders is, and are added at once, in four sums that do not wait for
//! each other.

use super::element::Element;

/// Orders side by side; the first of them is a multiple of it.
pub(super) const ORDERS: usize = 4;

/// The sums for two rows.
#[derive(Debug, Clone)]
pub(super) struct Sums<T> {
    /// Of the orders from the last multiple of [`ORDERS`].
    sums: [T; 2 * ORDERS - 1],
    /// The coefficients before that of this order, from the one after the first, of either row.
    first: [[T; ORDERS - 1]; 2],
}

impl<T: Element> Sums<T> {
    /// Before there are coefficients.
    #[inline(always)]
    pub fn new(any: T) -> Self {
        let zero = any.like(0.0);
        Sums {
            sums: [zero; 2 * ORDERS - 1],
            first: [[zero; ORDERS - 1]; 2],
        }
    }

    /// As before there are coefficients.
    #[inline(always)]
    pub fn clear(&mut self, zero: T) {
        self.sums.fill(zero);
    }

    /// The sum for the k-th coefficient.
    #[inline(always)]
    pub fn of(&self, k: usize) -> T {
        self.sums[k % ORDERS]
    }

    /// Adds what the k-th coefficients make in the next orders.
    #[inline(always)]
    pub fn add(&mut self, k: usize, [a, b]: [T; 2]) {
        if k < ORDERS {
            self.add_first(k, [a, b]);
            return;
        }
        let [of_a, of_b] = &self.first;
        if let Some(sums) = self.sums[k % ORDERS + 1..].first_chunk_mut() {
            *sums = T::sums_with_newest(*sums, [a, b], [of_a, of_b]).unwrap_or_else(|| {
                std::array::from_fn(|j| b.mul_add(of_a[j], a.mul_add(of_b[j], sums[j])))
            });
        }
    }

    /// The same of the first coefficients. Apart, as it loads what was stored just before: where one instruction does so at some orders and
    /// not at others, the processor foresees it wrongly and begins anew.
    #[inline(always)]
    fn add_first(&mut self, k: usize, [a, b]: [T; 2]) {
        let [of_a, of_b] = &mut self.first;
        for j in 1..k {
            let sum = a.mul_add(of_b[j - 1], self.sums[k + j]);
            self.sums[k + j] = b.mul_add(of_a[j - 1], sum);
        }
        self.sums[2 * k] = a.mul_add(b, self.sums[2 * k]);
        (of_a[k - 1], of_b[k - 1]) = (a, b);
    }

    /// Goes on to the orders from k, a multiple of [`ORDERS`], of rows that are known up to there.
    #[inline(always)]
    pub fn go_on(&mut self, k: usize, rows: [&[T]; 2], zero: T) {
        let [.., a, b, c] = self.sums;
        let mut sums = [a, b, c, zero];
        if k > ORDERS {
            let [a, b] = rows.map(|row| &row[ORDERS..k]);
            sums = T::sums_of_older(sums, [a, b]).unwrap_or_else(|| sums_of_older(sums, [a, b]));
        }
        let [a, b, c, d] = sums;
        self.sums = [a, b, c, d, zero, zero, zero];
    }
}

/// The sums for the orders from k, with the products of coefficients from the fourth to before the k-th, which are given.
#[inline(always)]
fn sums_of_older<T: Element>(mut sums: [T; ORDERS], [a, b]: [&[T]; 2]) -> [T; ORDERS] {
    for (a, b) in a.iter().zip(b.windows(ORDERS).rev()) {
        for i in 0..ORDERS {
            sums[i] = a.mul_add(b[i], sums[i]);
        }
    }
    // What is left are products for the later ones of these orders.
    let (Some(newest), Some(first)) = (a.last_chunk::<{ ORDERS - 1 }>(), b.first_chunk()) else {
        return sums;
    };
    let first: &[T; ORDERS - 1] = first;
    for (j, a) in newest.iter().enumerate() {
        for i in j + 1..ORDERS {
            sums[i] = a.mul_add(first[i - 1 - j], sums[i]);
        }
    }
    sums
}

/// sum of a_j b_(n-1-j) over j < n, n being the length of both
#[inline(always)]
pub(super) fn sum_of_products<T: Element>(a: &[T], b: &[T], zero: T) -> T {
    let all = a.iter().zip(b.iter().rev());
    all.fold(zero, |sum, (a, b)| a.mul_add(*b, sum))
}
