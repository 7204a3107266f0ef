//! Gaussian elimination for the equations of a connection, in nearly all of which nearly all unknowns are missing.
//!
//! The equations of an arc hold the unknowns of its two nodes, those of the equilibrium and both parameters. Unknowns are eliminated in the order of the nodes, and
//! of the equations with a large enough coefficient that of the fewest unknowns is taken (threshold pivoting: Duff, Erisman and Reid 2017, Direct Methods for
//! Sparse Matrices, section 5.2): so all that is filled in is beside the next node.

use super::connection::Layout;
use crate::field::{Matrix, Vector};

/// A pivot is no smaller than this part of the largest coefficient of its unknown.
const LARGE: f64 = 0.1;

/// An equation: its coefficients by the place of their unknown in the order, and its right-hand sides.
struct Equation {
    coefficients: Vec<(usize, f64)>,
    right: Vec<f64>,
}

impl Equation {
    /// Without its first unknown, by means of another one that has it first too.
    fn without_first(&mut self, pivot: &Equation) {
        let factor = self.coefficients[0].1 / pivot.coefficients[0].1;
        let (mut own, mut others) = (&self.coefficients[1..], &pivot.coefficients[1..]);
        let mut merged = Vec::with_capacity(own.len() + others.len());
        while let (Some(&(i, a)), Some(&(k, b))) = (own.first(), others.first()) {
            merged.push(match i.cmp(&k) {
                std::cmp::Ordering::Less => (i, a),
                std::cmp::Ordering::Equal => (i, a - factor * b),
                std::cmp::Ordering::Greater => (k, -factor * b),
            });
            own = &own[usize::from(i <= k)..];
            others = &others[usize::from(k <= i)..];
        }
        merged.extend_from_slice(own);
        merged.extend(others.iter().map(|&(k, b)| (k, -factor * b)));
        self.coefficients = merged;
        for (x, y) in self.right.iter_mut().zip(&pivot.right) {
            *x -= factor * y;
        }
    }
}

/// The solutions with several right-hand sides, of unknowns that are eliminated in this order; `None` where the matrix is singular or they are not finite.
fn solved(matrix: &Matrix, order: &[usize], rights: &[Vector]) -> Option<Vec<Vector>> {
    let count = matrix.nrows();
    let mut left: Vec<Equation> = (0..count)
        .map(|row| {
            let all = order
                .iter()
                .enumerate()
                .map(|(k, &i)| (k, matrix[(row, i)]));
            Equation {
                coefficients: all.filter(|(_, x)| *x != 0.0).collect(),
                right: rights.iter().map(|right| right[row]).collect(),
            }
        })
        .collect();
    let mut done: Vec<Equation> = Vec::with_capacity(count);
    for unknown in 0..count {
        let begins = |one: &Equation| one.coefficients.first().is_some_and(|(k, _)| *k == unknown);
        let having = || left.iter().enumerate().filter(|(_, one)| begins(one));
        let size = |one: &Equation| one.coefficients[0].1.abs();
        let largest = having().map(|(_, one)| size(one)).fold(0.0, f64::max);
        let large = having().filter(|(_, one)| size(one) >= LARGE * largest);
        let (place, _) = large.min_by_key(|(_, one)| one.coefficients.len())?;
        let pivot = left.swap_remove(place);
        for one in left.iter_mut().filter(|one| begins(one)) {
            one.without_first(&pivot);
        }
        done.push(pivot);
    }
    let mut solutions = vec![Vector::zeros(count); rights.len()];
    for Equation {
        coefficients,
        right,
    } in done.iter().rev()
    {
        let (first, others) = coefficients.split_first()?;
        for (solution, right) in solutions.iter_mut().zip(right) {
            let known: f64 = others.iter().map(|(k, x)| x * solution[order[*k]]).sum();
            solution[order[first.0]] = (right - known) / first.1;
        }
    }
    let known = solutions.iter().flatten().all(|x| x.is_finite());
    known.then_some(solutions)
}

impl Layout {
    /// The unknowns in the order of the nodes, each with the time to the next; last those that all equations have.
    fn order(self) -> Vec<usize> {
        let n = self.dimension;
        let node = |k: usize| {
            let own = self.node(k)..self.node(k) + n;
            own.chain((k < self.arcs).then(|| self.duration(k)))
        };
        let nodes = (0..=self.arcs).flat_map(node);
        let parameters = [0, 1].map(|i| self.parameter(i));
        nodes.chain(0..n).chain(parameters).collect()
    }

    /// The right-hand sides that ask for the two parameters.
    pub fn units(self) -> [Vector; 2] {
        [0, 1].map(|i| {
            let mut unit = Vector::zeros(self.count());
            unit[self.parameter(i)] = 1.0;
            unit
        })
    }

    /// The solution of as many equations of a connection as there are unknowns.
    pub fn solved(self, equations: &Matrix, right: &Vector) -> Option<Vector> {
        let rights = std::slice::from_ref(right);
        solved(equations, &self.order(), rights)?.pop()
    }

    /// The same of the transposed equations, with several right-hand sides: their unknowns, one for each equation, in the order of the nodes.
    pub fn solved_transposed(self, equations: &Matrix, rights: &[Vector]) -> Option<Vec<Vector>> {
        let order = self.order();
        // Those with unknowns of all nodes come last.
        let first = |row: &usize| {
            let has = |i: &usize| equations[(*row, *i)] != 0.0;
            let many = order.iter().filter(|i| has(i)).count() > order.len() / 2;
            let first = order.iter().position(has);
            first.filter(|_| !many).unwrap_or(order.len())
        };
        let mut rows: Vec<usize> = (0..equations.nrows()).collect();
        rows.sort_by_cached_key(first);
        solved(&equations.transpose(), &rows, rights)
    }
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn it_solves_what_dense_elimination_solves() {
        let layout = Layout {
            dimension: 2,
            arcs: 5,
        };
        let count = layout.count();
        let order = layout.order();
        let mut place = vec![0; count];
        order.iter().enumerate().for_each(|(k, &i)| place[i] = k);
        // Numbers without a pattern near the diagonal and in the last columns, and zeros on some of the diagonal.
        let number = |i: usize, j: usize| ((i * 31 + j * 17) as f64 * 0.618).fract() - 0.5;
        let has = |i: usize, j: usize| {
            let (k, l) = (i, place[j]);
            (k.abs_diff(l) < 4 && (k != l || k % 3 > 0)) || l + 4 > count || k + 1 == count
        };
        let matrix = Matrix::from_fn(
            count,
            count,
            |i, j| {
                if has(i, j) { number(i, j) } else { 0.0 }
            },
        );
        let right = Vector::from_fn(count, |i, _| number(i, 3));
        let near = |one: &Vector, other: &Vector| {
            assert!(
                (one - other).amax() < 1e-11 * (1.0 + other.amax()),
                "{one} {other}"
            );
        };
        let dense = matrix.clone().lu().solve(&right).expect("regular");
        near(&layout.solved(&matrix, &right).expect("regular"), &dense);
        let dense = matrix.transpose().lu().solve(&right).expect("regular");
        let made = layout
            .solved_transposed(&matrix, &[right])
            .expect("regular");
        near(&made[0], &dense);
    }
}
