//! Functions of the Jacobian that are zero at folds and at Hopf points, for few variables and for many.
//!
//! For few these are determinants: of the Jacobian and of its bialternate product. For many they leave the range of doubles, and the second one takes a time that
//! grows as the sixth power of the number of variables. There these are the least singular value, with the sign of the determinant, and of all sums of two eigenvalues the one
//! nearest to zero, with the sign of their product. A sum of two eigenvalues is the trace of what the Jacobian is in their plane, which stays smooth where the
//! two meet.

use super::bialternate::bialternate;
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::number::{eigenvalues, singular_values};
use nalgebra::Complex;
use nalgebra::linalg::balancing::balance_parlett_reinsch;

/// Of no more variables the functions are determinants.
const FEW: usize = 8;

/// Whether there are more.
pub(super) fn is_large(variables: usize) -> bool {
    variables > FEW
}

/// Zero where an eigenvalue is: there its sign changes.
pub(super) fn zero_function(jacobian: &Matrix) -> f64 {
    match is_large(jacobian.nrows()) {
        false => jacobian.determinant(),
        true => least_of(jacobian),
    }
}

/// The least singular value with the sign of the determinant, in units in which rows and columns have norms near one.
pub(super) fn least_of(matrix: &Matrix) -> f64 {
    least_singular(matrix).map_or(f64::NAN, |found| found.value)
}

/// Zero where the sum of two eigenvalues is: there its sign changes.
pub(super) fn sum_function(jacobian: &Matrix) -> f64 {
    match is_large(jacobian.nrows()) {
        false => bialternate(jacobian).determinant(),
        true => nearest_sum(jacobian, None).map_or(f64::NAN, |found| found.over_largest()),
    }
}

/// The same without the pair that is followed: zero where a second pair comes to the imaginary axis.
pub(super) fn other_sums(jacobian: &Matrix, pair: FollowedPair) -> f64 {
    nearest_sum(jacobian, Some(pair)).map_or(f64::NAN, |found| found.over_largest())
}

/// omega of a second pair that is on the imaginary axis with one that is followed.
pub(super) fn second_frequency(jacobian: &Matrix, pair: FollowedPair) -> Option<f64> {
    /// What is left of the real part, over the imaginary one.
    const AXIS: f64 = 1e-6;
    let (a, _) = nearest_sum(jacobian, Some(pair))?.of;
    (a.re.abs() < AXIS * a.im.abs()).then_some(a.im.abs())
}

/// The sum of two eigenvalues itself, or what is zero with it. Where two sums vanish together the determinant has a double zero; the sum of a pair that is
/// followed has a simple one.
pub(super) fn pair_function(jacobian: &Matrix, pair: Option<FollowedPair>) -> f64 {
    match is_large(jacobian.nrows()) || pair.is_some() {
        false => bialternate(jacobian).determinant(),
        true => pair_sum(jacobian, pair).map_or(f64::NAN, |found| found.value),
    }
}

/// Two eigenvalues r and -r that a curve goes along, told by the one that is on the positive imaginary axis, or on the positive real one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FollowedPair(Complex<f64>);

impl FollowedPair {
    /// The two eigenvalues that are next to those of another pair; without one, those whose sum is nearest to zero.
    pub fn of(jacobian: &Matrix, other: Option<FollowedPair>) -> Option<Self> {
        let product = pair_sum(jacobian, other)?.product;
        let pair = FollowedPair(Complex::from(-product).sqrt());
        (pair.0.re.is_finite() && pair.0.im.is_finite()).then_some(pair)
    }

    /// Whether another sum of two eigenvalues is next to zero, against this pair.
    pub fn is_near_another(self, jacobian: &Matrix) -> bool {
        const NEAR: f64 = 0.1;
        let other = nearest_sum(jacobian, Some(self));
        other.is_some_and(|other| other.sum.abs() < NEAR * self.0.norm())
    }

    /// In another unit of time.
    fn over(self, unit: f64) -> Self {
        FollowedPair(self.0 / unit)
    }

    /// How far two eigenvalues are from it. What is left of their sum tells most, but where two sums are all but zero.
    fn distance(self, a: &Complex<f64>, b: &Complex<f64>) -> f64 {
        /// What a sum counts.
        const SUM: f64 = 10.0;
        let of = |a: &Complex<f64>, b: &Complex<f64>| (a - self.0).norm() + (b + self.0).norm();
        SUM * (a + b).norm() + of(a, b).min(of(b, a))
    }
}

/// How such a function depends on the Jacobian.
pub(super) enum Slope {
    /// By all of it.
    Whole(Box<dyn Fn(&Matrix) -> f64>),
    /// By the sum of l . C r over these pairs of l and r, where C is the change.
    Vectors(Vec<(Vector, Vector)>),
}

impl Slope {
    /// Of [`zero_function`].
    ///
    /// # Errors
    /// [`Error::NotConverged`] where the singular values are not found.
    pub fn of_zero_function(jacobian: &Matrix) -> Result<Self> {
        match is_large(jacobian.nrows()) {
            false => Ok(Slope::Whole(Box::new(determinant_slope(jacobian)?))),
            true => Self::by(least_singular(jacobian)),
        }
    }

    /// Of [`pair_function`].
    ///
    /// # Errors
    /// As of [`Slope::of_zero_function`].
    pub fn of_pair_function(jacobian: &Matrix, pair: Option<FollowedPair>) -> Result<Self> {
        match is_large(jacobian.nrows()) || pair.is_some() {
            false => {
                let slope = determinant_slope(&bialternate(jacobian))?;
                let whole = move |change: &Matrix| slope(&bialternate(change));
                Ok(Slope::Whole(Box::new(whole)))
            }
            true => Self::by(pair_sum(jacobian, pair)),
        }
    }

    fn by(found: Option<Critical>) -> Result<Self> {
        let found = found.ok_or_else(|| not_found("the critical vectors of a Jacobian"))?;
        Ok(Slope::Vectors(found.pairs))
    }

    /// Along a change of the Jacobian of so many variables, which is told by what it does to a vector.
    pub fn along(&self, variables: usize, change: impl Fn(&Vector) -> Vector) -> f64 {
        match self {
            Slope::Whole(slope) => {
                let unit =
                    |i: usize| Vector::from_fn(variables, |k, _| f64::from(u8::from(i == k)));
                let columns: Vec<Vector> = (0..variables).map(|i| change(&unit(i))).collect();
                slope(&Matrix::from_columns(&columns))
            }
            Slope::Vectors(pairs) => pairs.iter().map(|(l, r)| l.dot(&change(r))).sum(),
        }
    }
}

fn not_found(what: &'static str) -> Error {
    Error::NotConverged {
        what,
        iterations: 0,
        residual: f64::INFINITY,
        tolerance: 0.0,
    }
}

/// The derivative of det A along a change of A: the trace of the adjugate times it, which exists where A is singular.
fn determinant_slope(a: &Matrix) -> Result<impl Fn(&Matrix) -> f64 + use<>> {
    let decomposed = singular_values(a.clone(), [true, true]);
    let parts = decomposed.and_then(|made| Some((made.u?, made.v_t?, made.singular_values)));
    let Some((u, v_t, sigma)) = parts else {
        return Err(not_found("the adjugate of a Jacobian"));
    };
    let sign = u.determinant() * v_t.determinant();
    Ok(move |change: &Matrix| {
        let turned = u.transpose() * change * v_t.transpose();
        let others = |i: usize| (0..sigma.len()).filter(move |&j| j != i);
        let term = |i: usize| turned[(i, i)] * others(i).map(|j| sigma[j]).product::<f64>();
        sign * (0..sigma.len()).map(term).sum::<f64>()
    })
}

/// omega of the two eigenvalues that are followed, or else of those whose sum is nearest to zero; `None` where these are real.
pub(super) fn pair_frequency(jacobian: &Matrix, pair: Option<FollowedPair>) -> Option<f64> {
    /// What is left of the real part, over the imaginary one.
    const AXIS: f64 = 1e-6;
    let found = pair_sum(jacobian, pair)?;
    let half = 0.5 * found.value;
    let omega = (found.product - half * half).sqrt();
    (half.abs() < AXIS * omega).then_some(omega)
}

/// What vanishes, and how it depends on the Jacobian.
struct Critical {
    value: f64,
    /// Of two eigenvalues.
    product: f64,
    /// As of [`Slope::Vectors`].
    pairs: Vec<(Vector, Vector)>,
}

/// The power of two next below a number that is not zero.
fn power_of_two(x: f64) -> f64 {
    x.log2().floor().exp2()
}

/// [`least_of`], which so does not depend on units; how it changes is known where it is zero.
fn least_singular(jacobian: &Matrix) -> Option<Critical> {
    let scale = |norm: f64| match norm.is_normal() {
        true => 1.0 / norm,
        false => 1.0,
    };
    let mut even = jacobian.clone();
    let rows = Vector::from_iterator(even.nrows(), even.row_iter().map(|row| scale(row.norm())));
    for (mut row, by) in even.row_iter_mut().zip(&rows) {
        row *= *by;
    }
    let of_columns = even.column_iter().map(|column| scale(column.norm()));
    let columns = Vector::from_iterator(even.ncols(), of_columns);
    for (mut column, by) in even.column_iter_mut().zip(&columns) {
        column *= *by;
    }
    let made = singular_values(even, [true, true])?;
    let least = made.singular_values.imin();
    let (u, v_t) = (made.u?, made.v_t?);
    // That of the determinant, as both vectors have it: where that is zero its own sign is rounding.
    let sign = (u.determinant() * v_t.determinant()).signum();
    let left = u.column(least).component_mul(&rows) * sign;
    let right = v_t.row(least).transpose().component_mul(&columns);
    // The iteration takes what is next to nothing for zero, and so hides how well it is known.
    let value = left.dot(&(jacobian * &right));
    value.is_finite().then(|| Critical {
        value,
        product: f64::NAN,
        pairs: vec![(left, right)],
    })
}

/// The least sum of two eigenvalues.
struct NearestSum {
    /// Its size, with the sign of the product of all.
    sum: f64,
    /// The eigenvalues.
    of: (Complex<f64>, Complex<f64>),
    /// The largest eigenvalue in size.
    largest: f64,
}

impl NearestSum {
    fn over_largest(&self) -> f64 {
        if self.largest > 0.0 {
            self.sum / self.largest
        } else {
            0.0
        }
    }
}

/// Of all sums of two eigenvalues, or of all but that of a pair, the least in size. Sums that are not real come in conjugate pairs. `None` where eigenvalues
/// are not found, or there is no sum.
fn nearest_sum(jacobian: &Matrix, but: Option<FollowedPair>) -> Option<NearestSum> {
    let Balanced {
        matrix: even, size, ..
    } = balanced(jacobian)?;
    let all = eigenvalues(&even)?;
    let but = match but {
        Some(pair) => Some(places_of_pair(&all, Some(pair.over(size)))?),
        None => None,
    };
    let mut least: Option<(f64, &Complex<f64>, &Complex<f64>)> = None;
    let mut sign = 1.0;
    for (i, a) in all.iter().enumerate() {
        for (j, b) in all[..i].iter().enumerate() {
            if but == Some((i, j)) {
                continue;
            }
            let sum = a + b;
            if least.is_none_or(|(least, ..)| sum.norm() < least) {
                least = Some((sum.norm(), a, b));
            }
            if is_real(a, b) && sum.re < 0.0 {
                sign = -sign;
            }
        }
    }
    let (least, a, b) = least?;
    let largest = all.iter().map(|z| z.norm()).fold(0.0, f64::max);
    (least.is_finite() && largest.is_finite()).then(|| NearestSum {
        sum: sign * least * size,
        of: (a * size, b * size),
        largest: largest * size,
    })
}

/// Whether both are real or conjugate to each other.
fn is_real(a: &Complex<f64>, b: &Complex<f64>) -> bool {
    match a.im == 0.0 {
        true => b.im == 0.0,
        false => *b == a.conj(),
    }
}

/// A matrix in units in which its rows are about as large as its columns.
struct Balanced {
    matrix: Matrix,
    /// Powers of two.
    units: Vector,
    /// What it is to be multiplied by, a power of two.
    size: f64,
}

fn balanced(matrix: &Matrix) -> Option<Balanced> {
    let largest = matrix.amax();
    let size = if largest.is_normal() {
        power_of_two(largest)
    } else {
        1.0
    };
    let mut matrix = matrix / size;
    if !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let units = balance_parlett_reinsch(&mut matrix);
    Some(Balanced {
        matrix,
        units,
        size,
    })
}

/// The numbers of the two eigenvalues, conjugate or both real, that are next to a pair, or else whose sum is nearest to zero.
fn places_of_pair(all: &[Complex<f64>], pair: Option<FollowedPair>) -> Option<(usize, usize)> {
    let places = (0..all.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let real = places.filter(|&(i, j)| is_real(&all[i], &all[j]));
    let off = |&(i, j): &(usize, usize)| match pair {
        Some(pair) => pair.distance(&all[i], &all[j]),
        None => (all[i] + all[j]).re.abs(),
    };
    real.min_by(|one, other| off(one).total_cmp(&off(other)))
}

/// The real sum of two eigenvalues that are followed, or else the one that is nearest to zero, with the planes that the Jacobian and its transpose map to
/// themselves.
fn pair_sum(jacobian: &Matrix, pair: Option<FollowedPair>) -> Option<Critical> {
    /// So often the least that keeps a matrix from being singular is added.
    const TRIED: u8 = 3;
    let Balanced {
        matrix: even,
        units,
        size,
    } = balanced(jacobian)?;
    let all = eigenvalues(&even)?;
    let (i, j) = places_of_pair(&all, pair.map(|pair| pair.over(size)))?;
    let (a, b) = (all[i], all[j]);
    let (sum, product) = ((a + b).re, (a * b).re);
    // Singular in the plane alone, but for what keeps it from being so to the last digit.
    let n = even.nrows();
    let off = f64::EPSILON * even.norm_squared();
    let squares = &even * &even - &even * sum;
    // Rounding may take just that away.
    let (left, right) = (1..=TRIED).find_map(|times| {
        let both = &squares + Matrix::identity(n, n) * (product + f64::from(times) * off);
        Some((plane(&both.transpose())?, plane(&both)?))
    })?;
    // Dual to each other.
    let left = &left * (left.transpose() * &right).try_inverse()?.transpose();
    let inside = left.transpose() * &even * &right;
    let value = inside.trace() * size;
    let pairs = (0..2).map(|k| {
        let l = left.column(k).component_div(&units);
        let r = right.column(k).component_mul(&units);
        (l, r)
    });
    value.is_finite().then(|| Critical {
        value,
        product: inside.determinant() * size * size,
        pairs: pairs.collect(),
    })
}

/// Orthonormal vectors of the plane that a matrix maps to nearly zero, by inverse iteration.
fn plane(matrix: &Matrix) -> Option<Matrix> {
    const ITERATIONS: usize = 4;
    let lu = matrix.clone().lu();
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let mut plane = Matrix::from_fn(matrix.nrows(), 2, |i, k| {
        (golden * ((i + 1) * (2 * k + 1)) as f64).fract() - 0.5
    });
    for _ in 0..ITERATIONS {
        plane = lu.solve(&plane)?.qr().q();
    }
    plane.iter().all(|x| x.is_finite()).then_some(plane)
}
