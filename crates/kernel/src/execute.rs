//! Carries out a list of operations in Rust: the reference that compiled code is compared with.

use crate::operations::{Array, Operation, Operations, Place, Value};

/// Carries out the operations on these arrays.
///
/// # Panics
/// If an array is shorter than [`Operations::extents`] says.
pub fn execute(operations: &Operations, results: &mut [f64], inputs: [&[f64]; 2]) {
    let mut values: Vec<[f64; 4]> = Vec::with_capacity(operations.len());
    for (operation, width) in operations.list() {
        let lanes = width.lanes();
        let at = |value: Value| values[value.index()];
        let read = |place: Place| match place.array {
            Array::Results => &results[place.offset..],
            Array::First => &inputs[0][place.offset..],
            Array::Second => &inputs[1][place.offset..],
        };
        let two = |a: Value, b: Value, f: fn(f64, f64) -> f64| {
            let (a, b) = (at(a), at(b));
            std::array::from_fn(|i| f(a[i], b[i]))
        };
        let made = match *operation {
            Operation::Zero => [0.0; 4],
            Operation::Load(place) => {
                let mut made = [0.0; 4];
                made[..lanes].copy_from_slice(&read(place)[..lanes]);
                made
            }
            Operation::Broadcast(place) => [read(place)[0]; 4],
            Operation::Store(place, a) => {
                let a = at(a);
                results[place.offset..][..lanes].copy_from_slice(&a[..lanes]);
                a
            }
            Operation::Add(a, b) => two(a, b, |a, b| a + b),
            Operation::Subtract(a, b) => two(a, b, |a, b| a - b),
            Operation::Multiply(a, b) => two(a, b, |a, b| a * b),
            Operation::Divide(a, b) => two(a, b, |a, b| a / b),
            Operation::Fused(signs, of) => {
                let [a, b, c] = of.map(at);
                let sign = |negative: bool, x: f64| if negative { -x } else { x };
                std::array::from_fn(|i| {
                    let a = sign(signs.negative_product, a[i]);
                    a.mul_add(b[i], sign(signs.negative_addend, c[i]))
                })
            }
            Operation::Negate(a) => at(a).map(|x| -x),
            Operation::Lane(a, i) => [at(a)[i]; 4],
            Operation::Beside(a, b) => {
                let (a, b, half) = (at(a), at(b), lanes / 2);
                std::array::from_fn(|i| if i < half { a[i] } else { b[i % half] })
            }
            Operation::Half(a, i) => {
                let a = at(a);
                let from = i * lanes;
                std::array::from_fn(|j| a[from + j % lanes])
            }
        };
        values.push(made);
    }
}
