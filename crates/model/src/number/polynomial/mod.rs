//! Real roots of a polynomial on an interval: where a function given by its Taylor series crosses or touches zero within
//! a step.
//!
//! Signs of Bernstein coefficients isolate the roots (Descartes' rule; Lane and Riesenfeld 1981, Rouillier and Zimmermann
//! 2004, Efficient isolation of polynomial's real roots), with intervals halved by de Casteljau's algorithm; bracketed
//! Newton steps refine them. Every sign is trusted only beyond the rounding error of the coefficient that has it.

mod isolate;

/// The highest degree of which [`roots`] are found.
pub const MAX_DEGREE: usize = 40;

/// How a polynomial goes through a root, as its argument grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crossing {
    /// From negative to positive.
    Upwards,
    /// From positive to negative.
    Downwards,
    /// Without a change of sign: a root of even multiplicity, or roots too close to be told from one.
    Touching,
}

/// A real root.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    /// Where it is.
    pub at: f64,
    /// How the sign changes there.
    pub crossing: Crossing,
}

/// Value of sum_k c_k t^k (Horner).
#[inline]
pub fn evaluate(coefficients: &[f64], t: f64) -> f64 {
    // No fold: its closure is not always inlined, in what runs at every step.
    let mut value = 0.0;
    for c in coefficients.iter().rev() {
        value = value * t + c;
    }
    value
}

/// The derivative of the given order, and its slope (Horner).
#[inline]
pub fn evaluate_derivative(coefficients: &[f64], order: usize, t: f64) -> (f64, f64) {
    let (mut value, mut slope) = (0.0, 0.0);
    for (k, c) in coefficients.iter().enumerate().skip(order).rev() {
        let factor: f64 = (0..order).map(|i| (k - i) as f64).product();
        slope = slope * t + value;
        value = value * t + factor * c;
    }
    (value, slope)
}

/// Appends the real roots of sum_k c_k t^k between 0 and `length` to `found`, in the order in which they are met from 0.
///
/// The interval is half open: a root at exactly 0 belongs to the step before, one at exactly `length`, which may be
/// negative, to this one. Signs at the ends are those of c_0 and of [`evaluate`] at `length`, however small, and where these
/// are 0 those of the next derivative that is not: in steps that begin with the sign that the step before ended with, no
/// crossing is lost or found twice. An extremum that touches zero belongs to the step in whose half-open interval it lies.
///
/// With u = 2^-53, n the degree and A(t) = sum_k |c_k t^k|, signs are trusted beyond E(t) = (6 (n + 1) + 3 n d) u A(t), where
/// d is the number of halvings that part the closest roots (some 20). Every crossing between points where |p| exceeds 16 E
/// is reported, no more of them and no fewer; where |p| falls below E and the sign stays the same,
/// [`Crossing::Touching`] is; where |p| stays above 4 E, nothing. Closer to 0 than 2^-100 of the length only a change of
/// sign is seen. A simple root is as accurate as p can be evaluated there; a multiple one is placed by its first or second
/// derivative.
///
/// No roots are found where a coefficient is not finite, a term overflows at `length`, or all coefficients are zero. Terms
/// that underflow count as zero. Nothing is allocated but in `found`.
///
/// ```
/// use twinslip::number::polynomial::{Crossing, Root, roots};
/// let mut found = Vec::new();
/// roots(&[0.1875, -1.0, 1.0], 1.0, &mut found); // (t - 1/4) (t - 3/4)
/// assert_eq!(found[0], Root { at: 0.25, crossing: Crossing::Downwards });
/// assert_eq!(found[1], Root { at: 0.75, crossing: Crossing::Upwards });
/// ```
///
/// # Panics
/// If the degree is above [`MAX_DEGREE`].
pub fn roots(coefficients: &[f64], length: f64, found: &mut Vec<Root>) {
    // Roots at 0 belong to the step before: divide by t.
    let Some(zeros) = coefficients.iter().position(|c| *c != 0.0) else {
        return;
    };
    let coefficients = &coefficients[zeros..];
    if length == 0.0 || first_outweighs(coefficients, length.abs()) {
        return;
    }
    let degree = coefficients.iter().rposition(|c| *c != 0.0).unwrap_or(0);
    assert!(
        degree <= MAX_DEGREE,
        "degree {degree} is above {MAX_DEGREE}"
    );
    let coefficients = &coefficients[..=degree];
    // p = t^zeros q, and on the way back t falls
    let turned = length < 0.0 && zeros % 2 == 0;
    isolate::search(coefficients, length, turned, found);
}

/// Room for the coefficients of any degree up to the highest.
type Coefficients = [f64; MAX_DEGREE + 1];

/// Whether |c_0| exceeds all other terms together up to |t| = h: then there is no root. Four sums at a time, as one alone
/// waits for each product.
#[inline]
fn first_outweighs(coefficients: &[f64], h: f64) -> bool {
    let h4 = (h * h) * (h * h);
    let (blocks, rest) = coefficients[1..].as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (sum, c) in sums.iter_mut().zip(rest) {
        *sum = c.abs();
    }
    for block in blocks.iter().rev() {
        for (sum, c) in sums.iter_mut().zip(block) {
            *sum = *sum * h4 + c.abs();
        }
    }
    let others = h * (sums[0] + h * (sums[1] + h * (sums[2] + h * sums[3])));
    // the margin is for the rounding of the sums
    coefficients[0].abs() > 1.000001 * others
}

/// c_k h^k, h^k in two factors, as it alone may overflow.
fn terms(coefficients: &[f64], length: f64) -> Coefficients {
    let mut terms = [0.0; MAX_DEGREE + 1];
    let mut power = 1.0;
    for (pair, c) in coefficients.chunks(2).enumerate() {
        for (odd, c) in c.iter().enumerate() {
            let next = if odd == 1 { power * length } else { power };
            terms[2 * pair + odd] = if *c == 0.0 { 0.0 } else { c * power * next };
        }
        power *= length;
    }
    terms
}

/// Bernstein coefficients on [0, 1]: B_i = sum_k C(i, k) / C(n, k) b_k, by the additions of Pascal's triangle.
fn bernstein(terms: &Coefficients, degree: usize) -> Coefficients {
    let mut control = *terms;
    let mut binomial = 1.0;
    for (k, c) in control[..=degree].iter_mut().enumerate().skip(1) {
        binomial = binomial * (degree + 1 - k) as f64 / k as f64;
        *c /= binomial;
    }
    let row = &mut control[..=degree];
    for k in 1..=degree {
        for i in (k..=degree).rev() {
            row[i] += row[i - 1];
        }
    }
    control
}
