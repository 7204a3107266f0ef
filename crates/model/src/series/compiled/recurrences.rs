//! The recurrences of a [`Shape`] as operations of a kernel: what [`super::super::later_orders`] carries out, in the same order, so
//! that the results are the same bit by bit.

use super::data::{Layout, OfRecurrence};
use super::shape::{Factor, Kind, Recurrence, Shape, Step, SumTerm};
use super::sums::Sums;
use crate::series::placed::Products;
use crate::series::products::ORDERS;
use std::collections::HashMap;
use twinslip_kernel::{Array, Operations, Place, Value, Width};

/// The operations that make all coefficients of an order below `order`, and of the variables that one too, from the first ones and the second ones
/// of the variables. The results are the rows, the first inputs the numbers of a [`Layout`].
pub fn operations(shape: &Shape, layout: &Layout, order: usize) -> Operations {
    let mut operations = Operations::new();
    let zero = operations.zero(shape.width);
    let mut code = Recurrences {
        operations,
        shape,
        layout,
        zero,
        coefficients: HashMap::new(),
        numbers: HashMap::new(),
        k: 0,
        step: 0,
    };
    let of_step = |step: &Step| match step {
        Step::Sum { .. } => Vec::new(),
        Step::Recurrence(one) => {
            let rows = match one.products {
                Products::Nothing => vec![],
                Products::One(rows) => vec![rows],
                Products::Two(both) => both.to_vec(),
                Products::Shared(row, both) => both.map(|other| [row, other]).to_vec(),
            };
            rows.into_iter().map(|rows| Sums::new(rows, zero)).collect()
        }
    };
    let mut sums: Vec<Vec<Sums>> = shape.steps.iter().map(of_step).collect();
    let mut powers = vec![Vec::new(); shape.steps.len()];
    for k in 1..order {
        code.k = k;
        for (at, step) in shape.steps.iter().enumerate() {
            code.step = at;
            match step {
                Step::Sum {
                    terms,
                    result,
                    rate_of,
                } => code.sum(terms, *result, *rate_of),
                Step::Recurrence(one) => {
                    if k % ORDERS == 0 {
                        for sums in &mut sums[at] {
                            sums.go_on(&mut code, k);
                        }
                    }
                    let older: Vec<Value> = sums[at].iter().map(|sums| sums.of(k)).collect();
                    code.recurrence(one, &older, &mut powers[at]);
                    for sums in &mut sums[at] {
                        sums.add(&mut code, k);
                    }
                }
            }
        }
        for &(variable, rate) in &shape.rates_apart {
            let next = match rate {
                Some(rate) => {
                    let (rate, share) = (code.newest(rate), code.share());
                    code.operations.multiply(rate, share)
                }
                None => code.zero,
            };
            code.put_at(variable, k + 1, next);
        }
    }
    code.operations
}

/// Operations that are being made, at an order and a step.
pub struct Recurrences<'a> {
    pub operations: Operations,
    pub shape: &'a Shape,
    pub layout: &'a Layout,
    pub zero: Value,
    /// Coefficients and numbers that are loaded or made, by their places.
    coefficients: HashMap<usize, Value>,
    numbers: HashMap<usize, Value>,
    pub k: usize,
    pub step: usize,
}

impl Recurrences<'_> {
    /// The j-th coefficient of a row.
    pub fn coefficient(&mut self, row: usize, j: usize) -> Value {
        let width = self.shape.width;
        let offset = (row + j) * width.lanes();
        *self.coefficients.entry(row + j).or_insert_with(|| {
            let place = Place {
                array: Array::Results,
                offset,
            };
            self.operations.load(place, width)
        })
    }

    pub fn newest(&mut self, row: usize) -> Value {
        self.coefficient(row, self.k)
    }

    pub fn first(&mut self, row: usize) -> Value {
        self.coefficient(row, 0)
    }

    /// The newest coefficient of a row; of a number zero.
    pub fn of(&mut self, row: Option<usize>) -> Value {
        row.map_or(self.zero, |row| self.newest(row))
    }

    pub fn put(&mut self, row: usize, x: Value) {
        self.put_at(row, self.k, x);
    }

    fn put_at(&mut self, row: usize, j: usize, x: Value) {
        let lanes = self.shape.width.lanes();
        self.operations.store((row + j) * lanes, x);
        self.coefficients.insert(row + j, x);
    }

    /// One of the numbers that the kernel is given.
    pub fn number(&mut self, at: usize) -> Value {
        let width = self.shape.width;
        *self.numbers.entry(at).or_insert_with(|| {
            let place = Place {
                array: Array::First,
                offset: at * width.lanes(),
            };
            self.operations.load(place, width)
        })
    }

    pub fn of_recurrence(&mut self, what: OfRecurrence) -> Value {
        self.number(self.layout.of_recurrence(self.step, what))
    }

    fn share(&mut self) -> Value {
        self.number(self.layout.share(self.k))
    }

    /// a b + c as [`crate::series::element::Element::mul_add`] has it: of single doubles rounded twice.
    pub fn multiply_add(&mut self, a: Value, b: Value, c: Value) -> Value {
        if self.shape.width == Width::One {
            let product = self.operations.multiply(a, b);
            self.operations.add(product, c)
        } else {
            self.operations.multiply_add(a, b, c)
        }
    }

    /// Two products, added one after the other; of a square they are the same.
    pub fn add_both(&mut self, first: (Value, Value), second: (Value, Value), sum: Value) -> Value {
        if self.shape.width == Width::One && first == second {
            let product = self.operations.multiply(first.0, first.1);
            let sum = self.operations.add(product, sum);
            return self.operations.add(product, sum);
        }
        let sum = self.multiply_add(first.0, first.1, sum);
        self.multiply_add(second.0, second.1, sum)
    }

    /// a/k
    pub fn over_order(&mut self, a: Value) -> Value {
        if self.k == 1 {
            return a;
        }
        let one_over = self.number(self.layout.one_over(self.k));
        self.operations.multiply(a, one_over)
    }

    /// k a
    pub fn times_order(&mut self, a: Value) -> Value {
        if self.k == 1 {
            return a;
        }
        let order = self.number(self.layout.order(self.k));
        self.operations.multiply(a, order)
    }

    /// The multiple of a that the first operand is.
    fn multiple(&mut self, one: &Recurrence, a: Value) -> Value {
        if one.factor == Factor::One {
            return a;
        }
        let factor = self.of_recurrence(OfRecurrence::Factor);
        self.operations.multiply(a, factor)
    }

    fn sum(&mut self, terms: &[SumTerm], result: usize, rate_of: Option<usize>) {
        let mut sum = None;
        for (j, term) in terms.iter().enumerate() {
            let x = self.newest(term.row);
            let (width, lanes) = (self.shape.width, self.shape.width.lanes());
            let x = match term.lane {
                None => x,
                _ if width == Width::One => x,
                Some(0) => self.operations.lane(x, 0, width),
                Some(_) => self.operations.lane(x, lanes - 1, width),
            };
            sum = Some(match (term.factor, sum) {
                (Factor::One, None) => x,
                (Factor::One, Some(sum)) => self.operations.add(sum, x),
                (Factor::MinusOne, None) => self.operations.negate(x),
                (Factor::MinusOne, Some(sum)) => self.operations.subtract(sum, x),
                (Factor::Other, sum) => {
                    let factor = self.number(self.layout.factor_of_term(self.step, j));
                    match sum {
                        None => self.operations.multiply(x, factor),
                        Some(sum) => self.multiply_add(x, factor, sum),
                    }
                }
            });
        }
        let sum = sum.unwrap_or(self.zero);
        self.put(result, sum);
        if let Some(variable) = rate_of {
            let share = self.share();
            let next = self.operations.multiply(sum, share);
            self.put_at(variable, self.k + 1, next);
        }
    }

    /// The newest coefficients, given the sums of products of older ones.
    fn recurrence(&mut self, one: &Recurrence, older: &[Value], powers: &mut Vec<Vec<Value>>) {
        let (result, spare) = (one.result, one.spare);
        match one.kind {
            Kind::Product(a, b) => {
                let (a, b) = (self.newest(a), self.newest(b));
                let older = self.multiple(one, older[0]);
                let rest = self.with_count(OfRecurrence::SecondCount, b, older);
                let new = self.with_count(OfRecurrence::FirstCount, a, rest);
                self.put(result, new);
            }
            Kind::Quotient(a, b) => {
                let a = self.of(a);
                let a = self.multiple(one, a);
                let rest = self.operations.subtract(a, older[0]);
                let b = self.newest(b);
                let rest = self.with_count(OfRecurrence::FirstCount, b, rest);
                self.put_times_inverse(result, rest);
            }
            Kind::Exponential(a) => {
                let a = self.newest(a);
                let rest = self.over_order(older[0]);
                let new = self.with_count(OfRecurrence::FirstCount, a, rest);
                self.put(result, new);
                self.put_slope(one, a);
            }
            Kind::Exponentials(a, other)
            | Kind::Hyperbolic(a, other)
            | Kind::Circular(a, other) => {
                let a = self.newest(a);
                let rest = self.over_order(older[0]);
                let new = self.with_count(OfRecurrence::FirstCount, a, rest);
                let rest = self.over_order(older[1]);
                let mut beside = self.with_count(OfRecurrence::SecondCount, a, rest);
                if !matches!(one.kind, Kind::Hyperbolic(..)) {
                    beside = self.operations.negate(beside);
                }
                self.put(result, new);
                self.put(other, beside);
                self.put_slope(one, a);
            }
            Kind::Copy(whole) => {
                let new = self.newest(whole);
                self.put(result, new);
            }
            Kind::Logarithm(u) => {
                let (u, rest) = (self.newest(u), self.over_order(older[0]));
                let rest = self.operations.subtract(u, rest);
                let new = self.put_times_inverse(result, rest);
                let slope = self.times_order(new);
                self.put(spare, slope);
            }
            Kind::Integral(a, _) => {
                let a = self.newest(a);
                let (a, rest) = (self.multiple(one, a), self.over_order(older[0]));
                let rest = self.operations.subtract(a, rest);
                let new = self.put_times_inverse(result, rest);
                let slope = self.times_order(new);
                self.put(spare, slope);
            }
            Kind::HyperbolicTangent(a, u) => {
                let a = self.newest(a);
                let rest = self.over_order(older[0]);
                let y = self.with_count(OfRecurrence::FirstCount, a, rest);
                let new = self.with_count(OfRecurrence::SecondCount, y, older[1]);
                let new = self.operations.negate(new);
                self.put(result, y);
                self.put(u, new);
                self.put_slope(one, a);
            }
            Kind::Power(a) => {
                let a = self.newest(a);
                let second = self.of_recurrence(OfRecurrence::SecondCount);
                let weighted = self.operations.multiply(older[1], second);
                let weighted = self.over_order(weighted);
                let p = self.of_recurrence(OfRecurrence::Constant);
                let plain = self.operations.multiply(older[0], p);
                let rest = self.operations.subtract(plain, weighted);
                let rest = self.with_count(OfRecurrence::FirstCount, a, rest);
                let new = self.put_times_inverse(result, rest);
                let slope = self.times_order(new);
                self.put(spare, slope);
            }
            Kind::Ratio(a) => {
                let new = self.ratio(a, powers);
                self.put(result, new);
            }
            Kind::Nothing => self.put(result, self.zero),
            Kind::Balanced(x, g) => self.balanced(one, (x, g), older),
        }
    }

    /// x times a number of the step, added to the rest.
    fn with_count(&mut self, count: OfRecurrence, x: Value, rest: Value) -> Value {
        let count = self.of_recurrence(count);
        self.multiply_add(x, count, rest)
    }

    pub fn put_times_inverse(&mut self, row: usize, x: Value) -> Value {
        let inverse = self.of_recurrence(OfRecurrence::Inverse);
        let new = self.operations.multiply(x, inverse);
        self.put(row, new);
        new
    }

    /// k times the multiple of a_k that the operand is.
    fn put_slope(&mut self, one: &Recurrence, a: Value) {
        let slope = self.times_order(a);
        let slope = self.multiple(one, slope);
        self.put(one.spare, slope);
    }
}
