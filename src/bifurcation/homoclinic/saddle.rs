//! The equilibrium at both ends of a homoclinic orbit: its eigenvalues, and what its linearisation splits the space of states into.

use crate::field::{Matrix, Vector};
use crate::number::{eigenvalues, eigenvector, null_vector, singular_values};
use nalgebra::Complex;

/// What homoclinic orbits are to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A saddle.
    Saddle,
    /// A saddle-node, which the orbit leaves and comes to along the direction of the eigenvalue 0.
    SaddleNode,
    /// A saddle-node to which the orbit comes along another direction: where both of the others end.
    NonCentral,
}

/// The linearisation at an equilibrium, whose variables are in units of the frame.
#[derive(Debug, Clone)]
pub(super) struct Splitting {
    /// The Jacobian.
    pub matrix: Matrix,
    /// By real part, the largest first.
    pub eigenvalues: Vec<Complex<f64>>,
    pub kind: Kind,
    /// What leaves the equilibrium, and what comes to it. At a saddle-node the direction of the eigenvalue 0 leaves it, and comes to it unless the orbit is
    /// non-central.
    pub unstable: Side,
    pub stable: Side,
}

/// An invariant subspace.
#[derive(Debug, Clone)]
pub(super) struct Side {
    /// The projection onto it, along the other invariant subspace.
    pub projection: Matrix,
    /// Orthonormal rows that vanish on it.
    pub across: Matrix,
    /// The least and the largest absolute real part of its eigenvalues that are not 0.
    pub rates: [f64; 2],
    /// The square of a distance, y^T Q y, that grows or shrinks all along orbits on it, whatever turns they take; of its largest part 1.
    pub distance: Matrix,
}

/// An equilibrium is hyperbolic where no eigenvalue is nearer to the axis than this part of the largest.
const HYPERBOLIC: f64 = 1e-7;

impl Splitting {
    /// Of this Jacobian. `None` where it is no such equilibrium as far as can be told.
    pub fn new(matrix: Matrix, kind: Kind) -> Option<Self> {
        let saddle_node = kind != Kind::Saddle;
        let mut eigenvalues = eigenvalues(&matrix)?;
        eigenvalues.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        let largest = eigenvalues.iter().map(|z| z.norm()).fold(0.0, f64::max);
        let zero = saddle_node.then(|| {
            let places = 0..eigenvalues.len();
            places.min_by(|&i, &j| eigenvalues[i].norm().total_cmp(&eigenvalues[j].norm()))
        });
        let zero = zero.flatten();
        let others = eigenvalues.iter().enumerate();
        let others = others.filter(|(i, _)| Some(*i) != zero).map(|(_, z)| z.re);
        let least = others.clone().map(f64::abs).fold(f64::INFINITY, f64::min);
        if least <= HYPERBOLIC * largest || zero.is_some_and(|i| eigenvalues[i].im != 0.0) {
            return None;
        }
        let shift = if saddle_node { 0.5 * least } else { 0.0 };
        let positive = others.clone().filter(|re| *re > 0.0).count();
        let negative = others.clone().count() - positive;
        let rates = |sign: f64| {
            let own = others.clone().map(|re| sign * re).filter(|re| *re > 0.0);
            let least = own.clone().fold(f64::INFINITY, f64::min);
            [least, own.fold(0.0, f64::max)]
        };
        let side = |sign: f64, takes_zero: bool, count: usize| {
            let shift = if takes_zero { shift } else { -shift };
            Side::new(
                &matrix,
                (sign, shift),
                count + usize::from(takes_zero),
                rates(sign),
            )
        };
        Some(Splitting {
            unstable: side(1.0, saddle_node, positive)?,
            stable: side(-1.0, kind == Kind::SaddleNode, negative)?,
            eigenvalues,
            kind,
            matrix,
        })
    }

    /// The larger one of the leading rates of both sides.
    pub fn fastest(&self) -> f64 {
        self.stable.rates[0].max(self.unstable.rates[0])
    }

    /// Why the orbit can't be followed much farther: it turns about the equilibrium without end, or the equilibrium has two eigenvalues 0. The latter is
    /// told by the leading rates, beside this one somewhere else on the curve.
    pub fn degenerates(&self, fastest: f64) -> Option<&'static str> {
        /// The real part beside the imaginary part, and rates beside those elsewhere.
        const NEAR: f64 = 0.05;
        const SLOW: f64 = 0.02;
        let near = |sign: f64| {
            let own = self.of_side(sign);
            own.first().is_some_and(|z| z.re.abs() < NEAR * z.im.abs())
        };
        if near(1.0) || near(-1.0) {
            return Some(
                "a pair of eigenvalues comes to the imaginary axis: a Shilnikov-Hopf point is near",
            );
        }
        let slow = self.kind == Kind::Saddle && self.fastest() < SLOW * fastest;
        slow.then_some("two eigenvalues come to 0: a Bogdanov-Takens point is near")
    }

    /// What leaves the equilibrium, or what comes to it.
    pub fn side(&self, leaves: bool) -> &Side {
        match leaves {
            true => &self.unstable,
            false => &self.stable,
        }
    }

    /// The eigenvalues of one side, those nearest to the axis first.
    pub fn of_side(&self, sign: f64) -> Vec<Complex<f64>> {
        let own = self.eigenvalues.iter().filter(|z| z.re * sign > 0.0);
        let mut own: Vec<_> = own.copied().collect();
        own.sort_by(|a, b| {
            a.re.abs()
                .total_cmp(&b.re.abs())
                .then(b.im.total_cmp(&a.im))
        });
        own
    }

    /// Which periodic orbits exist near an orbit homoclinic to this equilibrium (Shilnikov 1970; Kuznetsov 2004, chapter 6).
    pub fn consequence(&self) -> &'static str {
        match self.kind {
            Kind::Saddle => {}
            Kind::SaddleNode => {
                return "saddle-node on a cycle: the period grows as the inverse root of the distance";
            }
            Kind::NonCentral => return "orbits to saddles and to saddle-nodes meet here",
        }
        let [stable, unstable] = [-1.0, 1.0].map(|sign| self.of_side(sign));
        /// Below this part of the eigenvalues their sum is rounding.
        const NEUTRAL: f64 = 1e-12;
        let (Some(one), Some(other)) = (stable.first(), unstable.first()) else {
            return "";
        };
        let quantity = one.re + other.re;
        if quantity.abs() <= NEUTRAL * (other.re - one.re) {
            return "the saddle quantity is zero within its error";
        }
        match (one.im != 0.0, other.im != 0.0) {
            (false, false) if unstable.len() == 1 && quantity < 0.0 => {
                "saddle, saddle quantity negative: a single periodic orbit leaves it, which is stable"
            }
            (false, false) => {
                "saddle: a single periodic orbit leaves it, which is a saddle or unstable"
            }
            (true, true) => "bi-focus: infinitely many saddle orbits are near",
            // The pair is the nearer one.
            (pair, _) if (quantity > 0.0) == pair => {
                "saddle-focus, Shilnikov's condition holds: infinitely many saddle orbits are near, and chaos"
            }
            (true, _) if unstable.len() == 1 => {
                "saddle-focus, Shilnikov's condition does not hold: a single periodic orbit leaves it, which is stable"
            }
            _ => {
                "saddle-focus, Shilnikov's condition does not hold: a single periodic orbit leaves it"
            }
        }
    }

    /// The real right and left eigenvectors of the eigenvalue of one side that is the nearest to the axis, where that is real and there are others.
    pub fn leading(&self, sign: f64) -> Option<[Vector; 2]> {
        let own = self.of_side(sign);
        let first = own.first().filter(|z| z.im == 0.0 && own.len() > 1)?;
        let real = |matrix: &Matrix| Some(eigenvector(matrix, *first)?.map(|z| z.re));
        Some([real(&self.matrix)?, real(&self.matrix.transpose())?])
    }
}

impl Side {
    /// The side of this sign, once the eigenvalues have moved towards it by so much.
    fn new(
        matrix: &Matrix,
        (sign, shift): (f64, f64),
        count: usize,
        rates: [f64; 2],
    ) -> Option<Self> {
        let n = matrix.nrows();
        if count == 0 {
            return None;
        }
        let identity = Matrix::identity(n, n);
        let moved = matrix + &identity * (sign * shift);
        let projection = (&identity + matrix_sign(moved)? * sign) * 0.5;
        if projection.trace().round() != count as f64 {
            return None;
        }
        let rows = singular_values(&identity - &projection, [false, true])?;
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&i, &j| rows.singular_values[j].total_cmp(&rows.singular_values[i]));
        let all = rows.v_t?;
        // A direction of eigenvalue 0 is slower than any other: there the distance is the plain one.
        let distance = match shift > 0.0 {
            true => identity,
            false => distance(matrix, &projection, sign, &rates)?,
        };
        Some(Side {
            distance,
            across: Matrix::from_fn(n - count, n, |i, j| all[(order[i], j)]),
            projection,
            rates,
        })
    }
}

/// The integral of |exp(-s A t) y|^2 over all times, for y projected on the side of sign s, of largest part 1: the sum over short steps, doubled again and again.
fn distance(matrix: &Matrix, projection: &Matrix, sign: f64, rates: &[f64; 2]) -> Option<Matrix> {
    /// A step, in units of the fastest rate, and the times of the slowest one after which nothing is left.
    const SHORT: f64 = 0.1;
    const LEFT: f64 = 20.0;
    let step = SHORT / matrix.norm();
    let mut flow = (matrix * (-sign * step)).exp() * projection;
    let mut sum = projection.transpose() * projection;
    let mut time = step;
    while time < LEFT / rates[0] {
        sum += flow.transpose() * &sum * &flow;
        flow = &flow * &flow;
        time *= 2.0;
    }
    let most = sum.norm();
    (most.is_finite() && most > 0.0).then(|| sum / most)
}

impl Side {
    /// The distance of this, and its gradient.
    pub fn distance_of(&self, away: &Vector) -> (f64, Vector) {
        let gradient = &self.distance * away;
        let distance = away.dot(&gradient).max(0.0).sqrt();
        (distance, gradient / distance)
    }
}

/// The sign of a matrix: 1 on the invariant subspace of eigenvalues of positive real part, -1 on the other one. By Newton's iteration, scaled by the
/// determinant (Higham 2008, Functions of matrices, section 5.5).
fn matrix_sign(mut x: Matrix) -> Option<Matrix> {
    const ITERATIONS: usize = 60;
    const DONE: f64 = 1e-14;
    let n = x.nrows() as f64;
    for _ in 0..ITERATIONS {
        let lu = x.clone().lu();
        let diagonal = lu.u().diagonal();
        let scale = (-diagonal.iter().map(|u| u.abs().ln()).sum::<f64>() / n).exp();
        let inverse = lu.try_inverse()?;
        // The scale is 1 in the end; then it would only add rounding.
        let scale = if (scale - 1.0).abs() < 0.01 {
            1.0
        } else {
            scale
        };
        let next = (&x * scale + inverse / scale) * 0.5;
        let moved = (&next - &x).amax();
        if !moved.is_finite() {
            return None;
        }
        x = next;
        if moved <= DONE * x.amax() {
            break;
        }
    }
    Some(x)
}

/// A function of a matrix that is zero where that is singular, with the vectors by which it changes: w^T dA v (Govaerts 2000, Numerical methods for bifurcations of
/// dynamical equilibria, chapter 3). `None` where the matrix is nothing like singular.
pub(super) struct Singular {
    pub value: f64,
    pub left: Vector,
    pub right: Vector,
}

impl Singular {
    pub fn of(matrix: &Matrix) -> Option<Self> {
        let n = matrix.nrows();
        let mut bordered = matrix.clone().resize(n + 1, n + 1, 0.0);
        let size = matrix.norm();
        let border = |matrix: Matrix| Some(null_vector(matrix)? * size);
        let (right, left) = (border(matrix.clone())?, border(matrix.transpose())?);
        bordered.view_mut((0, n), (n, 1)).copy_from(&left);
        bordered
            .view_mut((n, 0), (1, n))
            .copy_from(&right.transpose());
        let mut unit = Vector::zeros(n + 1);
        unit[n] = 1.0;
        let right = bordered.clone().lu().solve(&unit)?;
        let left = bordered.transpose().lu().solve(&unit)?;
        Some(Singular {
            value: right[n],
            left: -left.rows(0, n),
            right: right.rows(0, n).into_owned(),
        })
    }
}
