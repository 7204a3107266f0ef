//! The first coefficients of a program's rows: what its operations make of numbers.

use super::composition::ratio_coefficients;
use super::element::Element;
use super::program::{Instruction, Operation, Source};
use super::program_rows::Level;
use crate::number::Balance;

impl<T: Element> Level<'_, T> {
    /// The first coefficient.
    #[inline(always)]
    pub fn begin(&mut self, instruction: &Instruction) {
        let (result, any) = (instruction.result, self.any);
        let first = |row: usize| self.first(row);
        match instruction.operation {
            Operation::Lane(a, lane) => self.put(result, any.like(first(a).lane(lane))),
            Operation::Sum(a, b) => self.put(result, first(a) + first(b)),
            Operation::Difference(a, b) => self.put(result, first(a) - first(b)),
            Operation::Negative(a) => self.put(result, -first(a)),
            Operation::Shifted(a, x) => self.put(result, first(a) + any.like_exact(x)),
            Operation::Complement(x, a) => self.put(result, any.like_exact(x) - first(a)),
            Operation::Scaled(a, x) => self.put(result, first(a).scale(x)),
            Operation::Over(a, x) => self.put(result, first(a) / any.like_exact(x)),
            Operation::Product(a, b) => self.put(result, first(a) * first(b)),
            Operation::Quotient(a, b) => self.put(result, self.of(a) / first(b)),
            Operation::Exponential(a) => self.put(result, first(a).exp()),
            Operation::Exponentials(a, falling) => {
                let a = first(a);
                self.put(falling, (-a).exp());
                self.put(result, a.exp());
            }
            Operation::ExponentialLessOne(a, _) => self.put(result, first(a).exp_m1()),
            Operation::Logarithm(a) => self.put(result, first(a).ln()),
            Operation::LogarithmOfOneMore(a, _) => self.put(result, first(a).ln_1p()),
            Operation::Hyperbolic(a, cosh) => {
                let (s, c) = first(a).sinh_cosh();
                self.put(cosh, c);
                self.put(result, s);
            }
            Operation::Circular(a, cos) => {
                let (s, c) = first(a).sin_cos();
                self.put(cos, c);
                self.put(result, s);
            }
            Operation::Arctangent(a, _) => self.put(result, first(a).atan()),
            Operation::InverseHyperbolicSine(a, _) => self.put(result, first(a).asinh()),
            Operation::HyperbolicTangent(a, u) => {
                let y = first(a).tanh();
                // 1 - y^2 is 1/cosh^2, which keeps its digits where y is next to 1: from them a series knows what is ahead.
                let e = (first(a).abs() * any.like(-2.0)).exp();
                let whole = e + any.like(1.0);
                self.put(u, e * any.like(4.0) / (whole * whole));
                self.put(result, y);
            }
            Operation::Power(a, p) => self.put(result, first(a).power(p)),
            Operation::Ratio(a, ratio) => {
                self.put(result, ratio_coefficients(ratio, first(a), 1)[0]);
            }
            Operation::Sign(a) => self.put(result, first(a).sign()),
            Operation::Signed(a, b) => self.put(result, first(a) * first(b).sign()),
            Operation::Balanced(x, g) => self.apart().begin_balanced(x, g, result),
        }
    }

    /// The rows of a balance before that of its y.
    #[inline(always)]
    pub fn of_balance(&self, y: usize) -> [usize; 6] {
        [6, 5, 4, 3, 2, 1].map(|before| y - before * self.room)
    }

    /// The first y of y + g(y) = x, and what the later ones need.
    fn begin_balanced(&mut self, x: Source, g: Balance<Source>, y: usize) {
        let rows = self.of_balance(y);
        let coefficients = g.map(|c| self.of(c));
        let (first, value) = self.of(x).balanced(coefficients);
        let (rising, falling) = match g {
            Balance::Sinh(_) => first.sinh_cosh(),
            _ => (first.exp(), (-first).exp()),
        };
        let (slope, counts) = match coefficients {
            Balance::Exponential(a) => (a * rising, [rising, falling]),
            Balance::Sinh(a) => (a * falling, [rising, falling]),
            Balance::Difference(a, b) => (
                a * rising + b * falling,
                [first.exp_m1(), (-first).exp_m1()],
            ),
        };
        let all = [rising, falling, slope, counts[0], counts[1], value];
        for (row, x) in rows.into_iter().zip(all) {
            self.put(row, x);
        }
        self.put(y, first);
    }
}
