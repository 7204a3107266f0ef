//! The recurrences of ratios and of balances as operations of a kernel.

use super::data::OfRecurrence;
use super::recurrences::Recurrences;
use super::shape::{Function, Recurrence};
use twinslip_kernel::Value;

impl Recurrences<'_> {
    /// As [`crate::series::composition::Composition`]; `powers` are those of the series without its first coefficient, from the second power on,
    /// by the order.
    pub fn ratio(&mut self, a: usize, powers: &mut Vec<Vec<Value>>) -> Value {
        let k = self.k;
        let newest = self.newest(a);
        let first = self.number(self.layout.of_ratio(self.step, 1));
        let mut sum = self.operations.multiply(first, newest);
        powers.push(Vec::new());
        // powers[i][m - 2] is the (i + 1)-th coefficient of the m-th power
        for m in 2..=k {
            let mut power = self.zero;
            for j in 1..=k + 1 - m {
                let below = match m {
                    2 => self.coefficient(a, k - j),
                    _ => powers[k - j - 1][m - 3],
                };
                let of_a = self.coefficient(a, j);
                power = self.multiply_add(of_a, below, power);
            }
            powers[k - 1].push(power);
            let count = self.number(self.layout.of_ratio(self.step, m));
            sum = self.multiply_add(count, power, sum);
        }
        sum
    }

    pub fn balanced(
        &mut self,
        one: &Recurrence,
        (x, g): (Option<usize>, Function),
        older: &[Value],
    ) {
        let y = one.result;
        let room = self.shape.room;
        let [e, f, steepness, of_a, of_b, of_y] =
            [6, 5, 4, 3, 2, 1].map(|before| y - before * room);
        let newest = self.of(x);
        let [first_sum, second_sum] = [0, 1].map(|i| older[i]);
        let (of_e, of_f) = (self.over_order(first_sum), self.over_order(second_sum));
        let (of_a, of_b) = (self.first(of_a), self.first(of_b));
        let (first, second) = (OfRecurrence::Constant, OfRecurrence::OtherConstant);
        let (rest, of_e, of_f) = match g {
            Function::Exponential(a) => (self.known((a, first), e, of_e, of_a), of_e, of_f),
            Function::Sinh(a) => (self.known((a, first), e, of_f, of_a), of_f, of_e),
            Function::Difference(a, b) => {
                let negative = self.operations.negate(of_f);
                let falling = self.known((b, second), f, negative, of_b);
                let rising = self.known((a, first), e, of_e, of_a);
                let rest = self.operations.subtract(rising, falling);
                (rest, of_e, negative)
            }
        };
        let (first_e, first_f) = (self.first(e), self.first(f));
        let (counts_e, counts_f) = match g {
            Function::Sinh(_) => (first_f, first_e),
            _ => (first_e, self.operations.negate(first_f)),
        };
        let new = self.operations.subtract(newest, rest);
        let new = self.put_times_inverse(y, new);
        let new_e = self.multiply_add(new, counts_e, of_e);
        let new_f = self.multiply_add(new, counts_f, of_f);
        let steepness = self.first(steepness);
        let value = self.operations.multiply(newest, steepness);
        let value = self.operations.add(value, rest);
        self.put_times_inverse(of_y, value);
        self.put(e, new_e);
        self.put(f, new_f);
        let slope = self.times_order(new);
        self.put(one.spare, slope);
    }

    /// What is known of the newest coefficient of a product of a balance's coefficient and a function.
    fn known(
        &mut self,
        (a, number): (Option<usize>, OfRecurrence),
        of: usize,
        newest: Value,
        first: Value,
    ) -> Value {
        let Some(row) = a else {
            let number = self.of_recurrence(number);
            return self.operations.multiply(newest, number);
        };
        let mut sum = self.zero;
        for j in 1..self.k {
            let (a, b) = (self.coefficient(row, j), self.coefficient(of, self.k - j));
            sum = self.multiply_add(a, b, sum);
        }
        let of_newest = self.newest(row);
        let of_newest = self.operations.multiply(of_newest, first);
        let sum = self.operations.add(sum, of_newest);
        let begin = self.first(row);
        self.multiply_add(begin, newest, sum)
    }
}
