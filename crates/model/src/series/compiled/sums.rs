//! Sums of products of older coefficients ([`super::super::products`]) as operations of a kernel: the same additions in the same order.

use super::recurrences::Recurrences;
use crate::series::products::ORDERS;
use twinslip_kernel::Value;

/// The sums for two rows.
#[derive(Debug, Clone)]
pub struct Sums {
    /// Of the orders from the last multiple of [`ORDERS`].
    sums: [Value; 2 * ORDERS - 1],
    rows: [usize; 2],
}

impl Sums {
    /// Before there are coefficients.
    pub fn new(rows: [usize; 2], zero: Value) -> Self {
        Sums {
            sums: [zero; 2 * ORDERS - 1],
            rows,
        }
    }

    /// The sum for the order at hand.
    pub fn of(&self, k: usize) -> Value {
        self.sums[k % ORDERS]
    }

    /// Goes on to the orders from k, a multiple of [`ORDERS`].
    pub fn go_on(&mut self, code: &mut Recurrences<'_>, k: usize) {
        let zero = code.zero;
        let [.., a, b, c] = self.sums;
        let mut sums = [a, b, c, zero];
        if k > ORDERS {
            self.add_older(code, k, &mut sums);
        }
        let [a, b, c, d] = sums;
        self.sums = [a, b, c, d, zero, zero, zero];
    }

    /// Adds the products of coefficients from the fourth to before the k-th.
    fn add_older(&self, code: &mut Recurrences<'_>, k: usize, sums: &mut [Value; ORDERS]) {
        let [a, b] = self.rows;
        for j in ORDERS..k {
            let of_a = code.coefficient(a, j);
            for (i, sum) in sums.iter_mut().enumerate() {
                // The newest make products for the later ones of these orders only.
                if k + i >= ORDERS + j {
                    let of_b = code.coefficient(b, k + i - j);
                    *sum = code.multiply_add(of_a, of_b, *sum);
                }
            }
        }
    }

    /// Adds what the k-th coefficients make in the next orders.
    pub fn add(&mut self, code: &mut Recurrences<'_>, k: usize) {
        let rows = self.rows;
        let [a, b] = rows.map(|row| code.coefficient(row, k));
        let begins = k < ORDERS;
        let after = k % ORDERS;
        let last = if begins { k } else { ORDERS };
        for j in 1..last {
            let [of_a, of_b] = rows.map(|row| code.coefficient(row, j));
            let sum = &mut self.sums[after + j];
            *sum = code.add_both((a, of_b), (b, of_a), *sum);
        }
        if begins {
            let sum = &mut self.sums[after + k];
            *sum = code.multiply_add(a, b, *sum);
        }
    }
}
