//! The series of columns ([`super::super::column_series`]) as a kernel: the same sums in the same order.

use super::formulas::{Kernels, Known, LOWEST_ORDER, MOST_OPERATIONS, When};
use crate::series::column_series::JacobianEntry;
use crate::series::element::Element;
use crate::series::program::Source;
use crate::series::program_rows::ProgramRows;
use std::collections::HashMap;
use std::sync::Arc;
use twinslip_kernel::{Array, Operations, Place, Value, Width};

/// What the code depends on.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct Shape {
    variables: usize,
    chunks: usize,
    /// Entries of the Jacobian, row by row, and of the derivatives in parameters: where they stand, and where their coefficients begin; `None` for
    /// numbers.
    jacobian: Vec<((usize, usize), Option<usize>)>,
    forcing: Vec<((usize, usize), Option<usize>)>,
    /// Coefficients that a row has room for.
    room: usize,
}

static COLUMNS: Known<Arc<Shape>> = Known::new();

/// The columns in lanes of X, and what their kernel is given: of each order what a rate counts in the next coefficient, then one in each lane, then
/// the entries of the Jacobian that are numbers, then those of the derivatives in parameters.
#[derive(Debug, Clone)]
pub struct CompiledColumns<X> {
    shape: Arc<Shape>,
    kernels: Arc<Kernels>,
    when: When,
    numbers: Vec<X>,
    unit: f64,
    any: X,
}

/// The lanes of a vector.
const WIDTH: Width = Width::Four;
const LANES: usize = 4;

impl Shape {
    /// Where the first one in a lane stands among the numbers.
    fn ones(&self) -> usize {
        self.room
    }

    /// Where the numbers of the Jacobian's entries stand, whether they are numbers or not.
    fn entries(&self) -> usize {
        self.room + LANES
    }

    fn forcing_entries(&self) -> usize {
        self.entries() + self.jacobian.len()
    }

    /// Fewer operations than this there are not, up to an order.
    fn operations_at_least(&self, order: usize) -> usize {
        self.jacobian.len() * self.chunks * order * order / 2
    }
}

impl<X: Element> CompiledColumns<X> {
    /// `None` where columns in lanes of X are not compiled.
    pub fn of(
        entries: (&[JacobianEntry], &[JacobianEntry]),
        sizes: (usize, usize),
        room: usize,
        any: X,
    ) -> Option<Self> {
        Self::when(When::allowed()?, entries, sizes, (room, any))
    }

    /// To be compiled at the time that is told.
    pub fn when(
        when: When,
        (jacobian, forcing): (&[JacobianEntry], &[JacobianEntry]),
        (variables, chunks): (usize, usize),
        (room, any): (usize, X),
    ) -> Option<Self> {
        if X::WIDTH != Some(WIDTH) {
            return None;
        }
        let placed = |entries: &[JacobianEntry]| {
            let place = |entry: &JacobianEntry| match entry.series {
                Source::Row(row) => (entry.place, Some(row * room)),
                Source::Number(_) => (entry.place, None),
            };
            entries.iter().map(place).collect()
        };
        let shape = Arc::new(Shape {
            variables,
            chunks,
            jacobian: placed(jacobian),
            forcing: placed(forcing),
            room,
        });
        if shape.operations_at_least(LOWEST_ORDER) > MOST_OPERATIONS {
            return None;
        }
        let kernels = COLUMNS.kernels(Arc::clone(&shape))?;
        let zero = any.like(0.0);
        let mut numbers = vec![zero; room];
        numbers.extend((0..LANES).map(|lane| zero.with_lane(lane, 1.0)));
        numbers.resize(shape.forcing_entries() + forcing.len(), zero);
        let mut made = CompiledColumns {
            shape,
            kernels,
            when,
            numbers,
            unit: f64::NAN,
            any,
        };
        made.set((jacobian, forcing));
        Some(made)
    }

    /// Takes over the numbers among these entries, which are as they were but for these.
    pub fn set(&mut self, (jacobian, forcing): (&[JacobianEntry], &[JacobianEntry])) {
        let numbers = &mut self.numbers[self.shape.entries()..];
        for (number, entry) in numbers.iter_mut().zip(jacobian.iter().chain(forcing)) {
            if let Source::Number(x) = entry.series {
                *number = self.any.like_exact(x);
            }
        }
    }

    /// Makes the series of the columns, which are begun, from the coefficients of these rows; returns whether it did: there may be no kernel yet.
    #[inline(always)]
    pub fn expand<T: Element>(
        &mut self,
        series: &mut [X],
        rows: &ProgramRows<T>,
        (order, unit): (usize, f64),
    ) -> bool {
        let Some(coefficients) = T::as_doubles(rows.coefficients()) else {
            return false;
        };
        let made = || {
            let fits = self.shape.operations_at_least(order) <= MOST_OPERATIONS;
            fits.then(|| operations(&self.shape, order))
        };
        let Some(kernel) = self.kernels.kernel((order, self.when), made) else {
            return false;
        };
        if unit != self.unit {
            self.unit = unit;
            for (k, share) in self.numbers[..self.shape.room].iter_mut().enumerate() {
                *share = self.any.like(unit) / self.any.like((k + 1) as f64);
            }
        }
        X::run_kernel(kernel, series, &self.numbers, coefficients);
        true
    }
}

/// The operations that make the series up to an order. The results are the series, the first inputs the numbers, the second ones the
/// coefficients of the rows.
fn operations(shape: &Shape, order: usize) -> Operations {
    let mut code = Columns {
        operations: Operations::new(),
        shape,
        series: HashMap::new(),
        entries: HashMap::new(),
        numbers: HashMap::new(),
    };
    let zero = code.operations.zero(WIDTH);
    // Two orders share what they load.
    for k in (0..order).step_by(2) {
        let orders = k..(k + 2).min(order);
        let mut sums = vec![vec![zero; shape.variables * shape.chunks]; orders.len()];
        for i in 0..shape.variables {
            code.add_older(i, orders.clone(), &mut sums, zero);
        }
        for (k, sums) in orders.zip(&sums) {
            code.order(k, sums, zero);
        }
    }
    code.operations
}

/// Operations that are being made.
struct Columns<'a> {
    operations: Operations,
    shape: &'a Shape,
    /// What is loaded or made, by its place.
    series: HashMap<usize, Value>,
    entries: HashMap<usize, Value>,
    numbers: HashMap<usize, Value>,
}

impl Columns<'_> {
    /// Where the k-th coefficients of a variable stand in the series.
    fn place(&self, i: usize, chunk: usize, k: usize) -> usize {
        (k * self.shape.variables + i) * self.shape.chunks + chunk
    }

    fn column(&mut self, i: usize, chunk: usize, k: usize) -> Value {
        let at = self.place(i, chunk, k);
        *self.series.entry(at).or_insert_with(|| {
            let place = Place {
                array: Array::Results,
                offset: at * LANES,
            };
            self.operations.load(place, WIDTH)
        })
    }

    fn put(&mut self, i: usize, chunk: usize, k: usize, x: Value) {
        let at = self.place(i, chunk, k);
        self.operations.store(at * LANES, x);
        self.series.insert(at, x);
    }

    /// A coefficient of an entry's row.
    fn entry(&mut self, at: usize) -> Value {
        *self.entries.entry(at).or_insert_with(|| {
            let place = Place {
                array: Array::Second,
                offset: at,
            };
            self.operations.broadcast(place, WIDTH)
        })
    }

    fn number(&mut self, at: usize) -> Value {
        *self.numbers.entry(at).or_insert_with(|| {
            let place = Place {
                array: Array::First,
                offset: at * LANES,
            };
            self.operations.load(place, WIDTH)
        })
    }

    /// The entries of a row of the Jacobian: their places in the list, columns, and where their coefficients begin.
    fn of_row(&self, i: usize) -> Vec<(usize, usize, Option<usize>)> {
        let all = self.shape.jacobian.iter().enumerate();
        all.filter(|(_, ((row, _), _))| *row == i)
            .map(|(at, ((_, column), begin))| (at, *column, *begin))
            .collect()
    }

    /// The sums of the products with all but the last two coefficients of the columns, for these orders.
    fn add_older(
        &mut self,
        i: usize,
        orders: std::ops::Range<usize>,
        sums: &mut [Vec<Value>],
        zero: Value,
    ) {
        let chunks = self.shape.chunks;
        let mut in_turn = vec![vec![[zero; 2]; chunks]; orders.len()];
        for (_, j, begin) in self.of_row(i) {
            let Some(begin) = begin else { continue };
            for of_column in 0..orders.end.saturating_sub(2) {
                for chunk in 0..chunks {
                    for (k, in_turn) in orders.clone().zip(&mut in_turn) {
                        if of_column + 2 > k {
                            continue;
                        }
                        let a = self.entry(begin + k - of_column);
                        let b = self.column(j, chunk, of_column);
                        let sum = &mut in_turn[chunk][of_column % 2];
                        *sum = self.operations.multiply_add(a, b, *sum);
                    }
                }
            }
        }
        for (sums, in_turn) in sums.iter_mut().zip(in_turn) {
            for (chunk, [even, odd]) in in_turn.into_iter().enumerate() {
                sums[i * chunks + chunk] = self.operations.add(even, odd);
            }
        }
    }

    /// The coefficients after the k-th, given the sums with older ones.
    fn order(&mut self, k: usize, older: &[Value], zero: Value) {
        let Shape {
            variables, chunks, ..
        } = *self.shape;
        let mut sums = older.to_vec();
        let share = self.number(k);
        for i in 0..variables {
            let of_row = self.of_row(i);
            for chunk in 0..chunks {
                let sum = &mut sums[i * chunks + chunk];
                if k > 0 {
                    for &(_, j, begin) in &of_row {
                        if let Some(begin) = begin {
                            let (a, b) = (self.entry(begin + 1), self.column(j, chunk, k - 1));
                            *sum = self.operations.multiply_add(a, b, *sum);
                        }
                    }
                }
                let mut other = zero;
                for (place, &(at, j, begin)) in of_row.iter().enumerate() {
                    let a = match begin {
                        Some(begin) => self.entry(begin),
                        None => self.number(self.shape.entries() + at),
                    };
                    let b = self.column(j, chunk, k);
                    let to = if place % 2 == 0 {
                        &mut *sum
                    } else {
                        &mut other
                    };
                    *to = self.operations.multiply_add(a, b, *to);
                }
                *sum = self.operations.add(*sum, other);
            }
        }
        for (at, &((i, parameter), begin)) in self.shape.forcing.iter().enumerate() {
            let x = match begin {
                Some(begin) => self.entry(begin + k),
                None if k == 0 => self.number(self.shape.forcing_entries() + at),
                None => continue,
            };
            let lane = variables + parameter;
            let one = self.number(self.shape.ones() + lane % LANES);
            let sum = &mut sums[i * chunks + lane / LANES];
            *sum = self.operations.multiply_add(one, x, *sum);
        }
        for i in 0..variables {
            for chunk in 0..chunks {
                let next = self.operations.multiply(sums[i * chunks + chunk], share);
                self.put(i, chunk, k + 1, next);
            }
        }
    }
}
