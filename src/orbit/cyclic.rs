//! Cyclic two-point systems: u_{k+1} = P_k u_k + r_k around a circle of nodes.
//!
//! Eliminated node by node with rotations, which keep what grows and what decays around the circle apart; a product of all P_k
//! would mix them, and so would reflections, in which a small row is the difference of two large ones. The elimination is
//! that of structured orthogonal factorisation: Wright, S. J. (1992). Stable parallel algorithms for two-point boundary value
//! problems. SIAM J. Sci. Stat. Comput. 13, 742-764.

use crate::field::{Matrix, Vector};
use crate::number::{null_vector, singular_values};
use nalgebra::{ComplexField, DMatrix, DVector, Dim, Dyn, VecStorage};

/// What the equations are in: real or complex numbers.
pub trait Scalar: ComplexField<RealField = f64> + Copy {}

impl<T: ComplexField<RealField = f64> + Copy> Scalar for T {}

/// Right-hand sides of one node, each in a column.
type RightHandSides<T, C> = nalgebra::Matrix<T, Dyn, C, VecStorage<T, Dyn, C>>;

/// A pivot below this part of its row's size is zero.
const SINGULAR: f64 = 1e-14;

/// The equations u_{k+1} = P_k u_k + r_k, u_m = u_0, for some right-hand sides, with all but u_0 eliminated.
#[derive(Debug, Clone)]
pub(super) struct Reduced<T> {
    nodes: usize,
    /// The number of components of a u_k.
    size: usize,
    /// Of every node but the first, the rows that its elimination leaves behind: an upper triangular matrix times u_k plus a
    /// second one times u_0 plus a third one times u_{k+1} equals the right-hand sides, all four side by side.
    left: Rows<T>,
    /// What is left: a matrix times u_0 equals the right-hand sides beside it.
    end: Rows<T>,
    /// Of every row of these the size of what it is the sum of.
    sizes: Vec<f64>,
}

/// Eliminates all nodes but the first.
pub(super) fn reduce<T: Scalar, C: Dim>(
    maps: &[DMatrix<T>],
    right: &[RightHandSides<T, C>],
) -> Reduced<T> {
    let (n, columns) = right[0].shape();
    let width = 3 * n + columns;
    // The rows of e u_0 + f u_k = c, at first from k = 1, above those of the next node: of every row what u_k, u_0 and u_{k+1}
    // are multiplied by, and the right-hand sides.
    let mut work = Rows::zeros(2 * n, width);
    for i in 0..n {
        let row = work.row_mut(i);
        row[i] = T::one();
        for j in 0..n {
            row[n + j] = -maps[0][(i, j)];
        }
        for j in 0..columns {
            row[3 * n + j] = right[0][(i, j)];
        }
    }
    let mut left = Vec::with_capacity((maps.len() - 1) * n * width);
    for (map, right) in maps.iter().zip(right).skip(1) {
        for i in 0..n {
            let row = work.row_mut(n + i);
            row.fill(T::zero());
            for j in 0..n {
                row[j] = -map[(i, j)];
            }
            row[2 * n + i] = T::one();
            for j in 0..columns {
                row[3 * n + j] = right[(i, j)];
            }
        }
        work.triangulate(n);
        let (done, rest) = work.entries.split_at_mut(n * width);
        left.extend_from_slice(done);
        done.copy_from_slice(rest);
        // What u_{k+1} is multiplied by comes first now.
        for i in 0..n {
            let row = work.row_mut(i);
            row.copy_within(2 * n..3 * n, 0);
            row[2 * n..3 * n].fill(T::zero());
        }
    }
    let mut end = Rows::zeros(n, n + columns);
    let mut sizes = Vec::with_capacity(n);
    for i in 0..n {
        let (matrices, right) = work.row(i).split_at(3 * n);
        let (f, e) = matrices[..2 * n].split_at(n);
        let row = end.row_mut(i);
        for j in 0..n {
            row[j] = e[j] + f[j];
        }
        row[n..].copy_from_slice(right);
        let all = matrices.iter().map(|x| x.norm1());
        sizes.push(all.fold(0.0, f64::max));
    }
    let left = Rows {
        width,
        entries: left,
    };
    Reduced {
        nodes: maps.len(),
        size: n,
        left,
        end,
        sizes,
    }
}

impl<T: Scalar> Reduced<T> {
    /// What is left, an upper triangular matrix times u_0 equals the right-hand sides beside it.
    pub fn closing(&self) -> Rows<T> {
        let mut closing = self.end.clone();
        closing.triangulate(self.size);
        closing
    }

    /// The last equations with rows of order one: those that belong to what has grown or decayed on the way are of any size, and
    /// only beside its own is a pivot zero.
    fn scaled_end(&self) -> Rows<T> {
        let mut end = self.end.clone();
        for (i, size) in self.sizes.iter().enumerate().filter(|row| *row.1 > 0.0) {
            for x in end.row_mut(i) {
                *x = x.scale(1.0 / size);
            }
        }
        end
    }

    /// All u_k from u_0, for this combination of the right-hand sides; `None` where they are not finite.
    pub fn extended(
        &self,
        start: &DVector<T>,
        combination: &DVector<T>,
    ) -> Option<Vec<DVector<T>>> {
        let n = self.size;
        let mut u = vec![start.clone(); self.nodes];
        for k in (1..self.nodes).rev() {
            let next = (k + 1) % self.nodes;
            for i in (0..n).rev() {
                let row = self.left.row((k - 1) * n + i);
                let (matrices, right) = row.split_at(3 * n);
                let (diagonal, others) = matrices.split_at(n);
                let (first, onto) = others.split_at(n);
                let mut rest = product(right, combination.as_slice())
                    - product(first, start.as_slice())
                    - product(onto, u[next].as_slice());
                let u = &mut u[k];
                for j in (i + 1..n).rev() {
                    rest -= diagonal[j] * u[j];
                }
                u[i] = divided(rest, diagonal[i])?;
            }
        }
        let finite = |u: &DVector<T>| u.iter().all(|x| x.is_finite());
        u.iter().all(finite).then_some(u)
    }
}

/// The sum of the products of two rows' entries.
fn product<T: Scalar>(a: &[T], b: &[T]) -> T {
    let products = a.iter().zip(b).map(|(a, b)| *a * *b);
    products.fold(T::zero(), |sum, x| sum + x)
}

/// a / b; `None` where b is zero.
fn divided<T: Scalar>(a: T, b: T) -> Option<T> {
    (b != T::zero()).then(|| a / b)
}

/// The solution of u_{k+1} = P_k u_k + r_k for k = 0 .. m - 1, u_m = u_0; `None` where it is singular.
pub fn solve<T: Scalar>(maps: &[DMatrix<T>], right: &[DVector<T>]) -> Option<Vec<DVector<T>>> {
    let reduced = reduce(maps, right);
    let n = reduced.size;
    let mut closing = reduced.scaled_end();
    closing.triangulate(n);
    let mut start = DVector::zeros(n);
    for i in (0..n).rev() {
        let row = closing.row(i);
        let mut rest = row[n];
        for j in (i + 1..n).rev() {
            rest -= row[j] * start[j];
        }
        start[i] = divided(rest, row[i])?;
    }
    // Where one direction is free, rounding alone keeps the last pivot from being zero.
    let pivots = (0..n).map(|i| closing.row(i)[i].modulus());
    let free = pivots.fold(f64::INFINITY, f64::min) <= SINGULAR;
    if free {
        return None;
    }
    reduced.extended(&start, &DVector::from_element(1, T::one()))
}

/// The solution of u_{k+1} = P_k u_k + r_k for k = 0 .. m - 1, u_m + s b = u_0 with a number s and one condition more, that the product of u_0 with a row is a given
/// number: it is regular also where one direction of the equations is free, if b lies outside of what they can make. `None` where it is singular.
pub(crate) fn solve_bordered(
    maps: &[Matrix],
    right: &[Vector],
    column: &Vector,
    (row, value): (&Vector, f64),
) -> Option<Vec<Vector>> {
    let last = maps.len() - 1;
    let sides = right.iter().enumerate().map(|(k, right)| {
        let border = if k == last {
            column.clone()
        } else {
            column * 0.0
        };
        Matrix::from_columns(&[right.clone(), border])
    });
    let sides: Vec<_> = sides.collect();
    let reduced = reduce(maps, &sides);
    let n = reduced.size;
    let end = reduced.scaled_end();
    let matrix = Matrix::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
        (true, true) => end.row(i)[j],
        (true, false) => -end.row(i)[n + 1],
        (false, true) => row[j],
        (false, false) => 0.0,
    });
    let known = Vector::from_fn(n + 1, |i, _| if i < n { end.row(i)[n] } else { value });
    let solution = matrix.lu().solve(&known)?;
    let start = solution.rows(0, n).into_owned();
    reduced.extended(&start, &Vector::from_column_slice(&[1.0, solution[n]]))
}

/// Returns the solution of singular equations, as of an orbit in a family, whose first node has the minimum norm. `None` for regular
/// equations, or if the solution is not finite.
pub(super) fn solve_singular(maps: &[Matrix], right: &[Vector]) -> Option<Vec<Vector>> {
    /// Singular values below this are 0, in rows of order one: the derivatives of an orbit that is not closed yet are those beside it.
    const FREE: f64 = 1e-6;
    let reduced = reduce(maps, right);
    let n = reduced.size;
    let end = reduced.scaled_end();
    let end_matrix = Matrix::from_fn(n, n, |i, j| end.row(i)[j]);
    let svd = singular_values(end_matrix, [true, true])?;
    if svd.singular_values.min() > FREE {
        return None;
    }
    let known = Vector::from_fn(n, |i, _| end.row(i)[n]);
    let start = svd.solve(&known, FREE).ok()?;
    reduced.extended(&start, &Vector::from_element(1, 1.0))
}

/// The direction in which u_{k+1} = P_k u_k, u_m = u_0 is nearest to singular, as displacements of all nodes; `None` where these
/// are not finite.
pub(super) fn kernel(maps: &[Matrix]) -> Option<Vec<Vector>> {
    let n = maps.first()?.nrows();
    let reduced = reduce(maps, &vec![Vector::zeros(n); maps.len()]);
    let end = reduced.scaled_end();
    let end_matrix = Matrix::from_fn(n, n, |i, j| end.row(i)[j]);
    let start = null_vector(end_matrix)?;
    reduced.extended(&start, &Vector::zeros(1))
}

/// Equations, each in a row: what the unknowns are multiplied by, and the right-hand sides.
#[derive(Debug, Clone)]
pub(super) struct Rows<T> {
    width: usize,
    /// Row by row.
    entries: Vec<T>,
}

impl<T: Scalar> Rows<T> {
    fn zeros(count: usize, width: usize) -> Self {
        Rows {
            width,
            entries: vec![T::zero(); count * width],
        }
    }

    pub fn row(&self, i: usize) -> &[T] {
        &self.entries[i * self.width..(i + 1) * self.width]
    }

    fn row_mut(&mut self, i: usize) -> &mut [T] {
        &mut self.entries[i * self.width..(i + 1) * self.width]
    }

    /// Makes the first n columns upper triangular, with zeros below, by rotations of two rows at a time.
    fn triangulate(&mut self, n: usize) {
        let width = self.width;
        for j in 0..n {
            // To the left of their j-th entries these rows are zero.
            let (above, below) = self.entries.split_at_mut((j + 1) * width);
            let pivot = &mut above[j * width + j..];
            for row in below.chunks_exact_mut(width) {
                let row = &mut row[j..];
                if row[0] == T::zero() {
                    continue;
                }
                let length = pivot[0].modulus().hypot(row[0].modulus());
                let (cosine, sine) = (pivot[0].unscale(length), row[0].unscale(length));
                let (across, along) = (cosine.conjugate(), sine.conjugate());
                for (p, x) in pivot.iter_mut().zip(row.iter_mut()) {
                    (*p, *x) = (across * *p + along * *x, cosine * *x - sine * *p);
                }
                row[0] = T::zero();
            }
        }
    }
}
