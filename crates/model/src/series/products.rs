//! Sums of products of older coefficients, of which power series are made: of a_j b_(k-j) over 0 < j < k.
//!
//! They are made for four orders k side by side. Products with one of the first coefficients are added as soon as the other
//! coefficient is there, to the sums of the next orders: always the same few operations, whatever the order. The products of all
//! other coefficients are there before the first of the four orders is, and are added at once, in four sums that do not wait for
//! each other.

use super::element::{Element, Two};

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

    /// The sum for an order so many after the multiple of [`ORDERS`].
    #[inline(always)]
    pub fn of(&self, phase: usize) -> T {
        self.sums[phase]
    }

    /// Adds what the newest coefficients make in the next orders; so many after the multiple of [`ORDERS`].
    #[inline(always)]
    pub fn add(&mut self, phase: usize, [a, b]: [T; 2]) {
        let [of_a, of_b] = &self.first;
        if let Some(sums) = self.sums[phase + 1..].first_chunk_mut() {
            if let Some(faster) = T::sums_with_newest(*sums, [a, b], [of_a, of_b]) {
                *sums = faster;
                return;
            }
            for j in 0..ORDERS - 1 {
                sums[j] = b.mul_add(of_a[j], a.mul_add(of_b[j], sums[j]));
            }
        }
    }

    /// The same of the k-th coefficients before the first multiple of [`ORDERS`], which are kept. Apart, as it loads what was stored just before: where one instruction does so at some orders and
    /// not at others, the processor foresees it wrongly and begins anew.
    #[inline(always)]
    pub fn add_first(&mut self, k: usize, [a, b]: [T; 2]) {
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
            sums = match T::sums_of_older(sums, [a, b]) {
                Some(faster) => faster,
                None => sums_of_older(
                    sums,
                    (a, b),
                    #[inline(always)]
                    |a, b, sum| a.mul_add(b, sum),
                ),
            };
        }
        let [a, b, c, d] = sums;
        self.sums = [a, b, c, d, zero, zero, zero];
    }
}

/// The sums for the orders from k, with the products of coefficients from the fourth to before the k-th, which are given.
#[inline(always)]
fn sums_of_older<T: Copy, B: Copy>(
    mut sums: [B; ORDERS],
    (a, b): (&[T], &[B]),
    times: impl Fn(T, B, B) -> B,
) -> [B; ORDERS] {
    let (a, b) = (a.as_chunks::<ORDERS>().0, b.as_chunks::<ORDERS>().0);
    let (Some((newest, a)), Some(first)) = (a.split_last(), b.first()) else {
        return sums;
    };
    for (a, b) in a.iter().zip(b.windows(2).rev()) {
        let b = b.as_flattened();
        for j in 0..ORDERS {
            for i in 0..ORDERS {
                sums[i] = times(a[j], b[ORDERS + i - j], sums[i]);
            }
        }
    }
    // The newest make products for the later ones of these orders only.
    for j in 0..ORDERS {
        for i in j..ORDERS {
            sums[i] = times(newest[j], first[i - j], sums[i]);
        }
    }
    sums
}

/// The sums for a row and either of two others, side by side.
#[derive(Debug, Clone)]
pub(super) struct SharedSums<T: Element> {
    /// As in [`Sums`].
    sums: [T::Two; 2 * ORDERS - 1],
    first: ([T; ORDERS - 1], [T::Two; ORDERS - 1]),
    /// The coefficients of both of the others.
    both: Vec<T::Two>,
}

impl<T: Element> SharedSums<T> {
    /// Before there are coefficients, with room for so many.
    pub fn new(any: T, room: usize) -> Self {
        let zero = any.like(0.0);
        let zeros = T::Two::of([zero; 2]);
        SharedSums {
            sums: [zeros; 2 * ORDERS - 1],
            first: ([zero; ORDERS - 1], [zeros; ORDERS - 1]),
            both: vec![zeros; room],
        }
    }

    /// As [`Sums::clear`].
    #[inline(always)]
    pub fn clear(&mut self, zero: T) {
        self.sums.fill(T::Two::of([zero; 2]));
    }

    /// As [`Sums::of`].
    #[inline(always)]
    pub fn of(&self, phase: usize) -> [T; 2] {
        self.sums[phase].both()
    }

    /// As [`Sums::add`], of the k-th coefficients.
    #[inline(always)]
    pub fn add(&mut self, (k, phase): (usize, usize), a: T, both: [T; 2]) {
        let both = T::Two::of(both);
        self.both[k] = both;
        let (of_a, of_both) = &self.first;
        if let Some(sums) = self.sums[phase + 1..].first_chunk_mut::<{ ORDERS - 1 }>() {
            // A loop: a closure might not be compiled for the processor.
            for j in 0..ORDERS - 1 {
                sums[j] = both.times(of_a[j], of_both[j].times(a, sums[j]));
            }
        }
    }

    /// As [`Sums::add_first`].
    #[inline(always)]
    pub fn add_first(&mut self, k: usize, a: T, both: [T; 2]) {
        let both = T::Two::of(both);
        self.both[k] = both;
        let (of_a, of_both) = &mut self.first;
        for j in 1..k {
            let sum = of_both[j - 1].times(a, self.sums[k + j]);
            self.sums[k + j] = both.times(of_a[j - 1], sum);
        }
        self.sums[2 * k] = both.times(a, self.sums[2 * k]);
        (of_a[k - 1], of_both[k - 1]) = (a, both);
    }

    /// As [`Sums::go_on`], of the row that they share.
    #[inline(always)]
    pub fn go_on(&mut self, k: usize, row: &[T], zero: T) {
        let [.., a, b, c] = self.sums;
        let zero = T::Two::of([zero; 2]);
        let mut sums = [a, b, c, zero];
        if k > ORDERS {
            sums = sums_of_older(
                sums,
                (&row[ORDERS..k], &self.both[ORDERS..k]),
                #[inline(always)]
                |a, both, sum| both.times(a, sum),
            );
        }
        let [a, b, c, d] = sums;
        self.sums = [a, b, c, d, zero, zero, zero];
    }
}

/// sum of a_j b_(n-1-j) over j < n, n being the length of both
#[inline(always)]
pub(super) fn sum_of_products<T: Element>(a: &[T], b: &[T], zero: T) -> T {
    let all = a.iter().zip(b.iter().rev());
    all.fold(zero, |sum, (a, b)| a.mul_add(*b, sum))
}
