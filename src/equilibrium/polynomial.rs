//! The roots of a real polynomial of degree three at most, or four where one is known to lie between two numbers, each with a bound on
//! its error, whatever the sizes of its coefficients.
//!
//! Roots of a stiff equilibrium differ by hundreds of decades, where matrix algorithms have an absolute accuracy only, overflow
//! or iterate for ever. Here all is done in 31 digits: a real root of a cubic by its sign change along ln |z|, the others from
//! what is left. Errors of the coefficients become discs that contain the roots (Smith 1970, Error bounds for zeros of a
//! polynomial based upon Gerschgorin's theorems, J. ACM 17).

use crate::number::{DoubleDouble, Real, bracketed_root};
use nalgebra::Complex;

/// The coefficients of 1, z, z^2, ... and how far they may be off.
///
/// What moves all of them together, such as the slip rate or a parameter, often moves a root much less than errors of any signs of
/// that size would: so each such shift is kept apart.
#[derive(Debug, Clone)]
pub(super) struct InexactCoefficients {
    pub values: Vec<DoubleDouble>,
    /// The largest shifts, either way, each of all coefficients at once.
    pub shifts: Vec<Vec<f64>>,
    /// What each coefficient may be off besides.
    pub rest: Vec<f64>,
}

impl InexactCoefficients {
    /// How far each one may be off in all.
    pub fn error(&self, i: usize) -> f64 {
        let shifts = self.shifts.iter().map(|shift| shift[i].abs());
        let sum = shifts.sum::<f64>() + self.rest[i];
        if sum.is_nan() { f64::INFINITY } else { sum }
    }

    /// A part of them, which is a polynomial of its own.
    pub fn part(&self, range: std::ops::Range<usize>) -> Self {
        InexactCoefficients {
            values: self.values[range.clone()].to_vec(),
            shifts: self
                .shifts
                .iter()
                .map(|shift| shift[range.clone()].to_vec())
                .collect(),
            rest: self.rest[range].to_vec(),
        }
    }
}

/// A root and the radius of the disc about it within which the true one lies.
pub(super) type RootDisc = (Complex<f64>, f64);

type Digits = DoubleDouble;

/// All roots of the polynomial with coefficients p, the constant first; a root that has no double is left out, and all are where a coefficient has none.
pub(super) fn roots(p: &InexactCoefficients) -> Vec<RootDisc> {
    roots_with(p, None)
}

/// The same; of a polynomial of degree four a real root lies between two numbers.
pub(super) fn roots_with(p: &InexactCoefficients, between: Option<[f64; 2]>) -> Vec<RootDisc> {
    let values = &p.values;
    let degree = values.iter().rposition(|c| c.to_f64() != 0.0);
    if values.iter().any(|c| !c.is_finite()) {
        return Vec::new();
    }
    let found = match degree {
        None | Some(0) => Vec::new(),
        Some(1) => vec![real(-values[0] / values[1])],
        Some(2) => quadratic([values[0], values[1], values[2]]).into(),
        Some(3) => cubic([values[0], values[1], values[2], values[3]]),
        Some(_) => quartic(values, between),
    };
    // in two doubles what overflows may come out as no number
    let finite = |z: &Complex<f64>| z.re.is_finite() && z.im.is_finite();
    let found: Vec<_> = found.into_iter().filter(finite).collect();
    (0..found.len())
        .map(|i| (found[i], radius(p, &found, i)))
        .collect()
}

fn real(z: Digits) -> Complex<f64> {
    Complex::new(z.to_f64(), 0.0)
}

/// c + b z + a z^2 = 0: the larger root by addition of like signs, the other one from the product.
fn quadratic([c, b, a]: [Digits; 3]) -> [Complex<f64>; 2] {
    let half = b * 0.5;
    // the discriminant over half^2 is 1 - t
    let t = a / half * (c / half);
    if half.to_f64() == 0.0 || t.to_f64().abs() > 1e280 || t.to_f64().is_nan() {
        let square = -(c / a);
        let root = square.abs().sqrt().to_f64();
        let off = (half / a).to_f64();
        return if square.to_f64() < 0.0 {
            [root, -root].map(|im| Complex::new(-off, im))
        } else {
            [root, -root].map(|re| Complex::new(re, 0.0))
        };
    }
    let discriminant = -(t - 1.0);
    if discriminant.to_f64() < 0.0 {
        let re = (-(half / a)).to_f64();
        let im = (half / a * (-discriminant).sqrt()).to_f64().abs();
        return [im, -im].map(|im| Complex::new(re, im));
    }
    let sum = discriminant.sqrt() + 1.0;
    [real(-(half / a * sum)), real(-(c / half / sum))]
}

/// One real root, which is always there, and those of the quotient.
fn cubic(p: [Digits; 4]) -> Vec<Complex<f64>> {
    // a real root beyond all doubles leaves the quadratic of the others
    let Some(z) = real_root(&p) else {
        return quadratic([p[0], p[1], p[2]]).into();
    };
    let q = quotient(&p, z);
    let mut all = vec![real(z)];
    all.extend(quadratic([q[0], q[1], q[2]]));
    all
}

/// The real root between two numbers, at which the polynomial has unlike signs, and those of the quotient. A root that is so close to one of
/// these that rounding has no sign there is looked for from it.
fn quartic(p: &[Digits], between: Option<[f64; 2]>) -> Vec<Complex<f64>> {
    let value = |z: f64| {
        let (mut value, mut slope) = (Digits::ZERO, Digits::ZERO);
        for &c in p.iter().rev() {
            slope = slope * z + value;
            value = value * z + c;
        }
        (value.to_f64(), slope.to_f64())
    };
    let Some([a, b]) = between else {
        return Vec::new();
    };
    let step = |z: f64| {
        let (value, slope) = value(z);
        (value / slope).abs()
    };
    let nearest = if step(a) < step(b) { a } else { b };
    let root = bracketed_root("a real eigenvalue", a, b, value).unwrap_or(nearest);
    let z = polished(p, Digits::from(root));
    let q = quotient(p, z);
    let mut all = vec![real(z)];
    all.extend(cubic([q[0], q[1], q[2], q[3]]));
    all
}

/// The coefficients of the polynomial over that of one of its roots.
fn quotient(p: &[Digits], z: Digits) -> Vec<Digits> {
    let degree = p.len() - 1;
    if z.to_f64() == 0.0 {
        return p[1..].to_vec();
    }
    // From the top down to the term that is largest at z, and from the bottom up to it: neither recurrence subtracts like numbers.
    let size = |j: usize| p[j].to_f64().abs().ln() + j as f64 * z.to_f64().abs().ln();
    let largest = (0..=degree).max_by(|&i, &j| size(i).total_cmp(&size(j)));
    let mut q = vec![p[degree]; degree];
    let top = largest.unwrap_or(0);
    for i in (top..degree - 1).rev() {
        q[i] = p[i + 1] + z * q[i + 1];
    }
    for i in 0..top.min(degree - 1) {
        let below = if i == 0 { Digits::ZERO } else { q[i - 1] };
        q[i] = (below - p[i]) / z;
    }
    q
}

/// The real root on that side of 0 on which the polynomial certainly changes its sign.
fn real_root(p: &[Digits; 4]) -> Option<Digits> {
    /// Logarithms of the smallest and the largest double.
    const ENDS: (f64, f64) = (-744.0, 709.7);
    if p[0].to_f64() == 0.0 {
        return Some(Digits::ZERO);
    }
    let side = if (p[0].to_f64() < 0.0) == (p[3].to_f64() > 0.0) {
        1.0
    } else {
        -1.0
    };
    let terms: Vec<(f64, f64)> = (0..4)
        .map(|j| (p[j].to_f64(), f64::from(j as u8)))
        .collect();
    // over its largest term
    let scaled = |t: f64| {
        let size = |&(c, j): &(f64, f64)| c.abs().ln() + j * t;
        let largest = terms.iter().map(size).fold(f64::NEG_INFINITY, f64::max);
        let mut sums = (0.0, 0.0);
        for &(c, j) in &terms {
            let term = c.signum() * f64::powf(side, j) * (size(&(c, j)) - largest).exp();
            sums = (sums.0 + term, sums.1 + j * term);
        }
        sums
    };
    let t = bracketed_root("a real eigenvalue", ENDS.0, ENDS.1, scaled).ok()?;
    Some(polished(p, Digits::from(side * t.exp())))
}

/// Newton's method from a root that is nearly known; stops where the corrections no longer shrink.
fn polished(p: &[Digits], start: Digits) -> Digits {
    /// To a double root it halves the error only.
    const STEPS: usize = 100;
    let slopes: Vec<Digits> = (1..p.len()).map(|j| p[j] * j as f64).collect();
    // c_0 + c_1 x + .., and the same with the powers of x in the other order
    let rising = |x: Digits, c: &[Digits]| c.iter().rev().fold(Digits::ZERO, |sum, &c| sum * x + c);
    let falling = |x: Digits, c: &[Digits]| c.iter().fold(Digits::ZERO, |sum, &c| sum * x + c);
    let (mut z, mut last) = (start, f64::INFINITY);
    for _ in 0..STEPS {
        let change = if z.to_f64().abs() > 1.0 {
            let w = z.recip();
            z * (falling(w, p) / falling(w, &slopes))
        } else {
            rising(z, p) / rising(z, &slopes)
        };
        let size = change.to_f64().abs();
        // false for NaN too
        let shrinks = size < last && size < 0.5 * z.to_f64().abs();
        if !shrinks {
            break;
        }
        z = z - change;
        last = size;
        if size == 0.0 {
            break;
        }
    }
    z
}

/// The radius about the i-th root: the rounding to a double, and what the errors of the coefficients do.
fn radius(p: &InexactCoefficients, all: &[Complex<f64>], i: usize) -> f64 {
    let degree = all.len();
    let z = all[i];
    let rounding = f64::EPSILON * z.norm();
    if (0..=degree).all(|j| p.error(j) == 0.0) {
        return rounding;
    }
    let others = || (0..degree).filter(move |&j| j != i);
    // sum of errors |z|^j and product of |z - z_j|, the former over |z|^n and the latter over |z|^(n - 1) where z is large
    let large = z.norm() > 1.0;
    // 1/z in two factors: |z|^2 may overflow
    let (direction, length) = ((z / z.norm()).conj(), z.norm());
    let leading = p.values[degree].to_f64().abs();
    let mut product = leading;
    let mut nearest = f64::INFINITY;
    for j in others() {
        let apart = (z - all[j]).norm();
        let apart = if large {
            (all[j] / length * direction - 1.0).norm()
        } else {
            apart
        };
        product *= apart;
        nearest = nearest.min(apart);
    }
    let powers: Vec<_> = (0..=degree)
        .map(|j| match large {
            true => (direction / length).powu((degree - j) as u32),
            false => z.powu(j as u32),
        })
        .collect();
    let moved = |shift: &Vec<f64>| {
        let terms = powers.iter().zip(shift).map(|(power, x)| power * *x);
        terms.sum::<Complex<f64>>().norm()
    };
    let rest = powers
        .iter()
        .zip(&p.rest)
        .map(|(power, x)| power.norm() * x);
    let errors = p.shifts.iter().map(moved).sum::<f64>() + rest.sum::<f64>();
    let n = degree as f64;
    let mut radius = n * errors / product;
    // Two discs that overlap hold both roots. Discs about two places as far apart as the square root of the error are smaller,
    // and seven times that distance reaches from either root across both.
    if radius.is_nan() || radius >= nearest / 3.0 {
        let without = product / nearest;
        let product = if without.is_finite() {
            without
        } else {
            // the roots are one
            let rest = others().map(|j| (z - all[j]).norm());
            let scale = if large { z.norm() } else { 1.0 };
            let rest = rest.filter(|&apart| apart > 0.0).map(|apart| apart / scale);
            leading * rest.product::<f64>()
        };
        radius = 7.0 * (errors / product).sqrt();
    }
    let radius = if large { radius * z.norm() } else { radius };
    let bound = radius + rounding;
    if bound.is_nan() { f64::INFINITY } else { bound }
}
