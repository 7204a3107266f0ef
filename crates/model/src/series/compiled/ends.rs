//! The series of the variables and their derivatives at two points at once, as a kernel.

use super::formulas::{Kernels, Known, When};
use crate::series::element::Element;
use crate::series::program_rows::ProgramRows;
use std::sync::Arc;
use twinslip_kernel::{Array, Operations, Place, Value, Width};

/// What the code depends on: the numbers of variables and of coefficients that a row has room for, and the numbers that it computes in.
type Shape = (usize, usize, Width);

static ENDS: Known<Shape> = Known::new();

/// Variables whose sums are made side by side.
const SIDE_BY_SIDE: usize = 4;

/// Two points, in units of a series, and what the series are there.
#[derive(Debug, Clone)]
pub struct Ends<T> {
    shape: Shape,
    kernels: Arc<Kernels>,
    /// The points, then for each variable the sums of the terms after the first over the point, at both, and likewise the derivatives.
    numbers: Vec<T>,
}

impl<T: Element> Ends<T> {
    /// `None` where they are not compiled.
    pub fn of(variables: usize, room: usize, any: T) -> Option<Self> {
        let shape = (variables, room, T::WIDTH?);
        Some(Ends {
            kernels: ENDS.kernels(shape)?,
            shape,
            numbers: vec![any.like(0.0); 2 + 4 * variables],
        })
    }

    /// Evaluates the series of these rows; returns whether it did: there may be no kernel yet.
    #[inline(always)]
    pub fn evaluate(
        &mut self,
        rows: &ProgramRows<T>,
        (order, when): (usize, When),
        points: [T; 2],
    ) -> bool {
        let made = || Some(operations(self.shape, order));
        let Some(kernel) = self.kernels.kernel((order, when), made) else {
            return false;
        };
        self.numbers[..2].copy_from_slice(&points);
        T::run_kernel(kernel, &mut self.numbers, rows.coefficients(), &[]);
        true
    }

    /// The sum of the terms after the first over the point, and the derivative, of a variable at one of the points.
    #[inline(always)]
    pub fn of_variable(&self, i: usize, point: usize) -> [T; 2] {
        [0, 2].map(|after| self.numbers[2 + 4 * i + after + point])
    }
}

/// Horner's scheme for the sums and the derivatives. The results are the numbers of [`Ends`], the first inputs the coefficients. Single doubles stand in
/// two lanes, one for each point.
fn operations((variables, room, width): Shape, order: usize) -> Operations {
    let mut code = Operations::new();
    let lanes = width.lanes();
    let result = |offset| Place {
        array: Array::Results,
        offset,
    };
    let points: Vec<Value> = match width {
        Width::One => vec![code.load(result(0), Width::Two)],
        _ => (0..2)
            .map(|point| code.load(result(point * lanes), width))
            .collect(),
    };
    let zero = code.zero(code.width(points[0]));
    let all: Vec<usize> = (0..variables).collect();
    for variables in all.chunks(SIDE_BY_SIDE) {
        let coefficient = |code: &mut Operations, i: usize, k: usize| {
            let place = Place {
                array: Array::First,
                offset: (i * room + k) * lanes,
            };
            match width {
                Width::One => code.broadcast(place, Width::Two),
                _ => code.load(place, width),
            }
        };
        let mut sums: Vec<Vec<[Value; 2]>> = variables
            .iter()
            .map(|&i| {
                let last = coefficient(&mut code, i, order);
                vec![[last, zero]; points.len()]
            })
            .collect();
        for k in (0..order).rev() {
            for (&i, sums) in variables.iter().zip(&mut sums) {
                let of_k = (k > 0).then(|| coefficient(&mut code, i, k));
                for ([sum, slope], &h) in sums.iter_mut().zip(&points) {
                    *slope = multiply_add(&mut code, width, [*slope, h, *sum]);
                    if let Some(of_k) = of_k {
                        *sum = multiply_add(&mut code, width, [*sum, h, of_k]);
                    }
                }
            }
        }
        for (&i, sums) in variables.iter().zip(&sums) {
            for (point, both) in sums.iter().enumerate() {
                for (after, &value) in [0, 2].into_iter().zip(both) {
                    code.store((2 + 4 * i + after + point) * lanes, value);
                }
            }
        }
    }
    code
}

/// a b + c as [`Element::mul_add`] has it: of single doubles rounded twice.
fn multiply_add(code: &mut Operations, width: Width, [a, b, c]: [Value; 3]) -> Value {
    if width == Width::One {
        let product = code.multiply(a, b);
        code.add(product, c)
    } else {
        code.multiply_add(a, b, c)
    }
}
