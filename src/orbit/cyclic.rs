//! Cyclic two-point systems: u_{k+1} = P_k u_k + r_k around a circle of nodes.
//!
//! Eliminated node by node with rotations, which keep what grows and what decays around the circle apart; a product of all P_k
//! would mix them, and so would reflections, in which a small row is the difference of two large ones. The elimination is
//! that of structured orthogonal factorisation: Wright, S. J. (1992). Stable parallel algorithms for two-point boundary value
//! problems. SIAM J. Sci. Stat. Comput. 13, 742-764.

use crate::field::{Jacobian, State};
use nalgebra::{ComplexField, DMatrix, SMatrix, SVector};

/// What the equations are in: real or complex numbers.
pub trait Scalar: ComplexField<RealField = f64> + Copy {}

impl<T: ComplexField<RealField = f64> + Copy> Scalar for T {}

/// A pivot below this part of its row's size is zero.
const SINGULAR: f64 = 1e-14;

/// The rows that a node's elimination leaves behind: `diagonal` (upper triangular) times u_k plus `first` u_0 plus `next`
/// u_{k+1} equals the right-hand sides.
#[derive(Debug, Clone, Copy)]
struct Rows<T, const N: usize, const C: usize> {
    diagonal: SMatrix<T, N, N>,
    first: SMatrix<T, N, N>,
    next: SMatrix<T, N, N>,
    right: SMatrix<T, N, C>,
}

/// The equations u_{k+1} = P_k u_k + r_k, u_m = u_0, for C right-hand sides, with all but u_0 eliminated.
#[derive(Debug, Clone)]
pub(super) struct Reduced<T, const N: usize, const C: usize> {
    left: Vec<Rows<T, N, C>>,
    /// What is left: `closing` (upper triangular) times u_0 equals `right`.
    pub closing: SMatrix<T, N, N>,
    pub right: SMatrix<T, N, C>,
    /// The same equations as they were before, and of every row the size of what it is the sum of.
    end: (SMatrix<T, N, N>, SMatrix<T, N, C>),
    sizes: [f64; N],
}

/// Eliminates all nodes but the first.
pub(super) fn reduce<T: Scalar, const N: usize, const C: usize>(
    maps: &[SMatrix<T, N, N>],
    right: &[SMatrix<T, N, C>],
) -> Reduced<T, N, C> {
    let nodes = maps.len();
    // e u_0 + f u_k = c, at first from k = 1.
    let mut e = -maps[0];
    let mut f = SMatrix::identity();
    let mut c = right[0];
    let mut left = Vec::with_capacity(nodes);
    for k in 1..nodes {
        let mut stacked = Stacked {
            pivot: [f, -maps[k]],
            first: [e, SMatrix::zeros()],
            next: [SMatrix::zeros(), SMatrix::identity()],
            right: [c, right[k]],
        };
        stacked.triangulate();
        left.push(Rows {
            diagonal: stacked.pivot[0],
            first: stacked.first[0],
            next: stacked.next[0],
            right: stacked.right[0],
        });
        (e, f, c) = (stacked.first[1], stacked.next[1], stacked.right[1]);
    }
    let sizes = std::array::from_fn(|i| e.row(i).camax().max(f.row(i).camax()));
    let last = closed(e + f, c);
    Reduced {
        left,
        end: (e + f, c),
        sizes,
        closing: last.0,
        right: last.1,
    }
}

/// The last equations, with an upper triangular matrix.
fn closed<T: Scalar, const N: usize, const C: usize>(
    matrix: SMatrix<T, N, N>,
    right: SMatrix<T, N, C>,
) -> (SMatrix<T, N, N>, SMatrix<T, N, C>) {
    let mut last = Stacked {
        pivot: [matrix, SMatrix::zeros()],
        first: [SMatrix::zeros(); 2],
        next: [SMatrix::zeros(); 2],
        right: [right, SMatrix::zeros()],
    };
    last.triangulate();
    (last.pivot[0], last.right[0])
}

impl<T: Scalar, const N: usize, const C: usize> Reduced<T, N, C> {
    /// The last equations with rows of order one: those that belong to what has grown or decayed on the way are of any size, and
    /// only beside its own is a pivot zero.
    fn scaled_end(&self) -> (SMatrix<T, N, N>, SMatrix<T, N, C>) {
        let (mut matrix, mut right) = self.end;
        for (i, size) in self.sizes.iter().enumerate().filter(|row| *row.1 > 0.0) {
            matrix.row_mut(i).scale_mut(1.0 / size);
            right.row_mut(i).scale_mut(1.0 / size);
        }
        (matrix, right)
    }

    /// All u_k from u_0, for this combination of the right-hand sides; `None` where they are not finite.
    pub fn extended(
        &self,
        start: &SVector<T, N>,
        combination: &SVector<T, C>,
    ) -> Option<Vec<SVector<T, N>>> {
        let mut u = vec![*start; self.left.len() + 1];
        let mut next = *start;
        for (k, rows) in self.left.iter().enumerate().rev() {
            let rest = rows.right * combination - rows.first * start - rows.next * next;
            next = rows.diagonal.solve_upper_triangular(&rest)?;
            u[k + 1] = next;
        }
        u.iter()
            .all(|u| u.iter().all(|x| x.is_finite()))
            .then_some(u)
    }
}

/// The solution of u_{k+1} = P_k u_k + r_k for k = 0 .. m - 1, u_m = u_0; `None` where it is singular.
pub fn solve<T: Scalar, const N: usize>(
    maps: &[SMatrix<T, N, N>],
    right: &[SVector<T, N>],
) -> Option<Vec<SVector<T, N>>> {
    let reduced = reduce::<T, N, 1>(maps, right);
    let (matrix, right) = reduced.scaled_end();
    let (closing, right) = closed(matrix, right);
    let start = closing.solve_upper_triangular(&right)?;
    // Where one direction is free, rounding alone keeps the last pivot from being zero.
    let pivots = closing.diagonal().map(T::modulus);
    let free = pivots.min() <= SINGULAR;
    if free {
        return None;
    }
    reduced.extended(&start, &SVector::repeat(T::one()))
}

/// The direction in which u_{k+1} = P_k u_k, u_m = u_0 is nearest to singular, as displacements of all nodes; `None` where these
/// are not finite.
pub(super) fn kernel<const N: usize>(maps: &[Jacobian<N>]) -> Option<Vec<State<N>>> {
    let reduced = reduce::<f64, N, 1>(maps, &vec![State::zeros(); maps.len()]);
    let (matrix, _) = reduced.scaled_end();
    let svd = DMatrix::from_fn(N, N, |i, j| matrix[(i, j)]).svd(false, true);
    let least = svd.singular_values.imin();
    let start = svd.v_t?.row(least).transpose();
    reduced.extended(&State::from_fn(|i, _| start[i]), &SVector::zeros())
}

/// 2N rows in blocks of N.
struct Stacked<T, const N: usize, const C: usize> {
    pivot: [SMatrix<T, N, N>; 2],
    first: [SMatrix<T, N, N>; 2],
    next: [SMatrix<T, N, N>; 2],
    right: [SMatrix<T, N, C>; 2],
}

impl<T: Scalar, const N: usize, const C: usize> Stacked<T, N, C> {
    /// Makes the pivot's first block upper triangular and its second zero, by rotations of two rows at a time.
    fn triangulate(&mut self) {
        for j in 0..N {
            for row in j + 1..2 * N {
                let (block, i) = (row / N, row % N);
                let (p, x) = (self.pivot[0][(j, j)], self.pivot[block][(i, j)]);
                if x == T::zero() {
                    continue;
                }
                let length = p.modulus().hypot(x.modulus());
                let turn = Turn {
                    rows: [(0, j), (block, i)],
                    cosine: p.unscale(length),
                    sine: x.unscale(length),
                };
                turn.apply(&mut self.pivot);
                turn.apply(&mut self.first);
                turn.apply(&mut self.next);
                turn.apply(&mut self.right);
                self.pivot[block][(i, j)] = T::zero();
            }
        }
    }
}

/// A rotation of two rows of two blocks.
struct Turn<T> {
    rows: [(usize, usize); 2],
    cosine: T,
    sine: T,
}

impl<T: Scalar> Turn<T> {
    fn apply<const N: usize, const C: usize>(&self, blocks: &mut [SMatrix<T, N, C>; 2]) {
        let [(a, i), (b, k)] = self.rows;
        for column in 0..C {
            let (x, y) = (blocks[a][(i, column)], blocks[b][(k, column)]);
            blocks[a][(i, column)] = self.cosine.conjugate() * x + self.sine.conjugate() * y;
            blocks[b][(k, column)] = self.cosine * y - self.sine * x;
        }
    }
}
