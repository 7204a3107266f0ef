//! The normal form on the centre manifold of an equilibrium whose critical eigenvalues are simple, by its power series.
//!
//! The manifold is y = H(w), with coordinates w along the critical eigenvectors q_j, on which w' = g(w). Order by order
//!
//! f(H(w)) = DH(w) g(w),
//!
//! where g keeps the terms that no change of coordinates takes away: those w^a of g_j for which the sum of a_i lambda_i is lambda_j for all values of the
//! frequencies (Kuznetsov 2004, section 8.7.1, the method of Coullet and Spiegel). What f is of the terms known so far comes from its power series along curves
//! H(s u), whose coefficients are polynomials in u that are found from enough directions u. So no multilinear form is needed.

use crate::field::{Matrix, Vector};
use crate::integrate::AnyField;
use crate::number::{null_vector, singular_values};
use nalgebra::{Complex, DMatrix, DVector};

type C = Complex<f64>;
type CVector = DVector<C>;
/// The powers of up to four coordinates.
pub(super) type Powers = [u8; 4];

/// The highest order of a term.
const HIGHEST: usize = 5;

/// What is critical at an equilibrium.
pub(super) struct Critical<'a> {
    pub field: &'a AnyField<'a>,
    pub state: &'a Vector,
    /// Whether an eigenvalue is zero; its coordinate is the first.
    pub zero: bool,
    /// omega of the pairs on the imaginary axis; each has two coordinates, conjugate to each other.
    pub frequencies: &'a [f64],
}

/// A polynomial with coefficients that are vectors, by the powers of its terms.
type Terms = Vec<(Powers, CVector)>;

/// The terms of g.
pub(super) struct CentreManifold {
    terms: Vec<(Powers, usize, C)>,
}

/// A critical eigenvalue with what tells resonances: how often each of the frequencies is in it.
struct Coordinate {
    value: C,
    weights: [i8; 2],
}

impl CentreManifold {
    /// To this order; eigenvectors have the length 1 in units of the variables. The directions are different ones for another `trial`. `None` where the
    /// field has no series along curves, or a matrix is singular that is not where eigenvalues are simple.
    pub fn of(
        critical: &Critical<'_>,
        units: Option<&[f64]>,
        (order, trial): (usize, usize),
    ) -> Option<Self> {
        let coordinates = critical.coordinates();
        let (n, d) = (critical.state.len(), coordinates.len());
        let jacobian = critical.field.jacobian(critical.state).map(C::from);
        let (q, p) = eigenvectors(&jacobian, &coordinates, units)?;
        let mut manifold: Terms = (0..d)
            .map(|j| (unit(j), q.column(j).into_owned()))
            .collect();
        let mut terms: Vec<(Powers, usize, C)> = Vec::new();
        for k in 2..=order {
            let powers = of_order(d, k);
            let known = critical.of_order(&manifold, (&powers, k), trial)?;
            for (power, mut right) in powers.iter().zip(known) {
                // What the terms of g of lower order move along the manifold.
                for (own, vector) in &manifold {
                    for (other, j, g) in &terms {
                        if own[*j] > 0 && product(own, other, *j) == *power {
                            right -= vector * (*g * f64::from(own[*j]));
                        }
                    }
                }
                let sum = |of: &dyn Fn(usize) -> C| (0..d).map(of).sum::<C>();
                let rate = sum(&|i| coordinates[i].value * f64::from(power[i]));
                let weight = |m: usize| -> i8 {
                    let each = (0..d).map(|i| power[i] as i8 * coordinates[i].weights[m]);
                    each.sum()
                };
                let resonant = |j: &usize| (0..2).all(|m| weight(m) == coordinates[*j].weights[m]);
                let resonant: Vec<usize> = (0..d).filter(resonant).collect();
                let size = n + resonant.len();
                let mut bordered = DMatrix::<C>::zeros(size, size);
                let shifted = DMatrix::<C>::identity(n, n) * rate - &jacobian;
                bordered.view_mut((0, 0), (n, n)).copy_from(&shifted);
                for (at, &j) in resonant.iter().enumerate() {
                    bordered
                        .view_mut((0, n + at), (n, 1))
                        .copy_from(&q.column(j));
                    let left = p.column(j).adjoint();
                    bordered.view_mut((n + at, 0), (1, n)).copy_from(&left);
                }
                let right = right.resize_vertically(size, C::ZERO);
                let solved = bordered.lu().solve(&right)?;
                manifold.push((*power, solved.rows(0, n).into_owned()));
                for (at, &j) in resonant.iter().enumerate() {
                    terms.push((*power, j, solved[n + at]));
                }
            }
        }
        let finite = |(_, _, g): &(Powers, usize, C)| g.re.is_finite() && g.im.is_finite();
        terms.iter().all(finite).then_some(CentreManifold { terms })
    }

    /// The coefficient of w^a in g_j; zero where that is no resonant term.
    pub fn term(&self, powers: &[u8], j: usize) -> C {
        let is = |own: &Powers| (0..4).all(|i| own[i] == powers.get(i).copied().unwrap_or(0));
        let found = self.terms.iter().find(|(own, at, _)| *at == j && is(own));
        found.map_or(C::ZERO, |(_, _, g)| *g)
    }
}

impl Critical<'_> {
    fn coordinates(&self) -> Vec<Coordinate> {
        let zero = self.zero.then_some(Coordinate {
            value: C::ZERO,
            weights: [0; 2],
        });
        let pairs = self.frequencies.iter().enumerate().flat_map(|(m, omega)| {
            [1_i8, -1].map(|sign| Coordinate {
                value: C::new(0.0, omega * f64::from(sign)),
                weights: [0, 1].map(|i| if i == m { sign } else { 0 }),
            })
        });
        zero.into_iter().chain(pairs).collect()
    }

    /// The coordinates w = w(u) at a real direction: of a pair u_1 + i u_2 and its conjugate.
    fn coordinates_at(&self, u: &[f64]) -> Vec<C> {
        let first = usize::from(self.zero);
        let zero = u[..first].iter().map(|&x| C::from(x));
        let pairs = u[first..].chunks_exact(2).flat_map(|pair| {
            let z = C::new(pair[0], pair[1]);
            [z, z.conj()]
        });
        zero.chain(pairs).collect()
    }

    /// The terms with these powers, of an order, of f on a manifold that is known to lower orders.
    fn of_order(
        &self,
        manifold: &Terms,
        (powers, k): (&[Powers], usize),
        trial: usize,
    ) -> Option<Vec<CVector>> {
        let n = self.state.len();
        let directions = directions(usize::from(self.zero) + 2 * self.frequencies.len(), trial);
        let directions: Vec<_> = directions.take(2 * powers.len()).collect();
        let mut monomials = DMatrix::<C>::zeros(directions.len(), powers.len());
        let mut values = DMatrix::<C>::zeros(directions.len(), n);
        for (row, u) in directions.iter().enumerate() {
            let w = self.coordinates_at(u);
            let of = |powers: &Powers| -> C {
                let each = w.iter().zip(powers);
                each.map(|(w, &power)| w.powu(u32::from(power))).product()
            };
            let mut curve: [Vector; HIGHEST + 1] = std::array::from_fn(|_| Vector::zeros(n));
            curve[0] = self.state.clone();
            for (own, vector) in manifold {
                let order: u8 = own.iter().sum();
                let factor = of(own);
                curve[usize::from(order)] += vector.map(|x| (x * factor).re);
            }
            let series = self.field.series_along(&curve)?;
            values.set_row(row, &series[k].transpose().map(C::from));
            let row_of: Vec<C> = powers.iter().map(of).collect();
            monomials.set_row(row, &DVector::from_vec(row_of).transpose());
        }
        let solved = singular_values(monomials, [true, true])?;
        let found = solved.solve(&values, 0.0).ok()?;
        Some(found.row_iter().map(|row| row.transpose()).collect())
    }
}

/// Real directions of so many components that are spread evenly.
fn directions(components: usize, trial: usize) -> impl Iterator<Item = Vec<f64>> {
    /// Irrational parts of a turn.
    const PARTS: [f64; 4] = [
        0.618_033_988_749_894_9,
        0.414_213_562_373_095_1,
        0.732_050_807_568_877_2,
        0.236_067_977_499_789_7,
    ];
    (1..).map(move |row| {
        let at = (row + 1000 * trial) as f64;
        let u = (0..components).map(|i| 2.0 * (at * PARTS[i]).fract() - 1.0);
        let u: Vec<f64> = u.collect();
        let length = u.iter().map(|x| x * x).sum::<f64>().sqrt();
        u.into_iter().map(|x| x / length).collect()
    })
}

/// All powers of so many coordinates with this sum.
fn of_order(coordinates: usize, order: usize) -> Vec<Powers> {
    let mut all = vec![[0; 4]];
    for i in 0..coordinates {
        let with = |powers: Powers| {
            (0..=order as u8).map(move |power| {
                let mut next = powers;
                next[i] = power;
                next
            })
        };
        all = all.into_iter().flat_map(with).collect();
    }
    let sum = |powers: &Powers| powers.iter().map(|&x| usize::from(x)).sum::<usize>();
    all.retain(|powers| sum(powers) == order);
    all
}

fn unit(j: usize) -> Powers {
    std::array::from_fn(|i| u8::from(i == j))
}

/// The powers of w^own / w_j w^other.
fn product(own: &Powers, other: &Powers, j: usize) -> Powers {
    std::array::from_fn(|i| own[i] + other[i] - u8::from(i == j))
}

/// The eigenvectors of a matrix and of its adjoint with the products 1, those of conjugate eigenvalues conjugate.
fn eigenvectors(
    jacobian: &DMatrix<C>,
    coordinates: &[Coordinate],
    units: Option<&[f64]>,
) -> Option<(DMatrix<C>, DMatrix<C>)> {
    let n = jacobian.nrows();
    let one = DMatrix::<C>::identity(n, n);
    let (mut right, mut left): (Vec<CVector>, Vec<CVector>) = (Vec::new(), Vec::new());
    for coordinate in coordinates {
        let is_second = coordinate.value.im < 0.0;
        if let (true, Some(q), Some(p)) = (is_second, right.last(), left.last()) {
            let (q, p) = (q.conjugate(), p.conjugate());
            right.push(q);
            left.push(p);
            continue;
        }
        let mut q = null_vector(jacobian - &one * coordinate.value)?;
        if coordinate.value == C::ZERO {
            q = q.map(|x| C::from(x.re));
        }
        let length = |i: usize| units.map_or(1.0, |units| units[i]) * q[i].norm();
        let length = (0..n).map(|i| length(i).powi(2)).sum::<f64>().sqrt();
        let q = q / C::from(length);
        let p = null_vector(jacobian.adjoint() - &one * coordinate.value.conj())?;
        let p = &p / p.dotc(&q).conj();
        right.push(q);
        left.push(p);
    }
    Some((DMatrix::from_columns(&right), DMatrix::from_columns(&left)))
}

/// Of a double zero eigenvalue: A q_0 = 0, A q_1 = q_0 and of the transpose p_1 and p_0, with the products 1 of those of one number and 0 of the others.
pub(in crate::bifurcation) struct DoubleZero {
    pub q: [Vector; 2],
    pub p: [Vector; 2],
}

impl DoubleZero {
    /// With q_0 of length 1 in units of the variables. `None` where that is singular.
    pub fn of(jacobian: &Matrix, units: Option<&[f64]>) -> Option<Self> {
        let n = jacobian.nrows();
        let q_0 = null_vector(jacobian.clone())?;
        let length = |i: usize| units.map_or(1.0, |units| units[i]) * q_0[i];
        let length = (0..n).map(|i| length(i).powi(2)).sum::<f64>().sqrt();
        let q_0 = q_0 / length;
        let p_1 = null_vector(jacobian.transpose())?;
        let q_1 = across(jacobian, (&p_1, &q_0), &q_0)?;
        let p_1 = &p_1 / p_1.dot(&q_1);
        let p_0 = across(&jacobian.transpose(), (&q_0, &p_1), &p_1)?;
        let p_0 = &p_0 - &p_1 * p_0.dot(&q_1);
        Some(DoubleZero {
            q: [q_0, q_1],
            p: [p_0, p_1],
        })
    }

    /// x with A x = y and <q_0, x> = 0, of y with <p_1, y> = 0.
    pub fn inverse(&self, jacobian: &Matrix, y: &Vector) -> Option<Vector> {
        across(jacobian, (&self.p[1], &self.q[0]), y)
    }
}

/// The vector x across `null` with A x = `right`, of a singular matrix whose transpose has another null vector.
fn across(
    matrix: &Matrix,
    (of_transpose, null): (&Vector, &Vector),
    right: &Vector,
) -> Option<Vector> {
    let n = matrix.nrows();
    let mut bordered = matrix.clone().insert_row(n, 0.0).insert_column(n, 0.0);
    bordered.view_mut((0, n), (n, 1)).copy_from(of_transpose);
    bordered
        .view_mut((n, 0), (1, n))
        .copy_from(&null.transpose());
    let solved = bordered.lu().solve(&right.push(0.0))?;
    Some(solved.rows(0, n).into_owned())
}
