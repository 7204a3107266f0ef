//! Eigenvalues and stability of an equilibrium, from the characteristic polynomials (14), (26) and (30).
//!
//! The polynomials keep the small eigenvalues of a stiff equilibrium to full relative accuracy, where a matrix algorithm has
//! only an absolute one. The verdict does not look at eigenvalues: it is the Routh-Hurwitz criterion in interval arithmetic
//! over the error budget of the equilibrium, and "undecided" where that can't tell.

use super::interface::{Interface, routh_hurwitz};
use super::{Equilibrium, Symmetry};
use crate::error::Result;
use crate::friction::{AnyLaw, Law, positive, with_law};
use crate::number::{Interval, Real};
use nalgebra::{Complex, Matrix3};

/// Newton corrections of an eigenvalue; two suffice from the start that the matrix algorithm gives.
const POLISH: usize = 6;

/// What is known of the stability.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// All eigenvalues have negative real parts, certainly.
    Stable,
    /// One has a positive real part, certainly.
    Unstable,
    /// Too close to call with the error budget at hand.
    Undecided,
}

impl Verdict {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Stable => "stable",
            Verdict::Unstable => "unstable",
            Verdict::Undecided => "undecided",
        }
    }
}

/// Eigenvalues, largest real part first, and the verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Stability {
    /// In V*/L.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Stable, unstable or undecided.
    pub verdict: Verdict,
}

/// Eigenvalues and verdict of an equilibrium at stiffness K.
///
/// # Errors
/// [`crate::Error::Parameter`] unless K is positive and finite.
pub fn stability(law: &AnyLaw, equilibrium: &Equilibrium, stiffness: f64) -> Result<Stability> {
    positive("stiffness", stiffness)?;
    Ok(with_law!(law, law => of_law(law, equilibrium, stiffness)))
}

fn of_law(law: &impl Law, equilibrium: &Equilibrium, k: f64) -> Stability {
    let rates = &equilibrium.slip_rate;
    let bounds: Vec<_> = equilibrium
        .rate_bounds
        .iter()
        .map(|&v| Interface::at(law, v))
        .collect();
    let first = Interface::at(law, rates[0]);
    let (mut eigenvalues, verdict) = match (equilibrium.symmetry, rates.len()) {
        (_, 1) => (
            quadratic(&first, k).to_vec(),
            oscillation_verdict(&bounds[0], k),
        ),
        (Symmetry::Symmetric, _) => {
            let [plus, minus] = quadratic(&first, 2.0 * k);
            (
                vec![Complex::new(first.s, 0.0), plus, minus],
                symmetric_verdict(&bounds[0], k),
            )
        }
        (Symmetry::Asymmetric, _) => {
            let second = Interface::at(law, rates[1]);
            (
                cubic(&first, &second, k),
                asymmetric_verdict(&bounds[0], &bounds[1], k),
            )
        }
    };
    eigenvalues.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    Stability {
        eigenvalues,
        verdict,
    }
}

/// The roots of s^2 - s (k_c - k)/F_V + k G_psi/F_V: (14), and P_2 of (26) with 2 k for k.
fn quadratic(one: &Interface<f64>, k: f64) -> [Complex<f64>; 2] {
    let half = 0.5 * (one.s - k * one.compliance);
    let product = k * one.g_psi * one.compliance;
    let discriminant = half * half - product;
    if discriminant < 0.0 {
        let im = (-discriminant).sqrt();
        return [Complex::new(half, im), Complex::new(half, -im)];
    }
    // The larger root by addition of like signs, the other from the product: no digit is lost.
    let large = half + discriminant.sqrt().copysign(half);
    let small = if large == 0.0 { 0.0 } else { product / large };
    [Complex::new(large, 0.0), Complex::new(small, 0.0)]
}

/// The roots of P_3 (30): (s_3 + s)(s - s_1)(s - s_2) + k a_2 s_2 (s - s_1) + k a_1 s_1 (s - s_2) = 0.
fn cubic(one: &Interface<f64>, two: &Interface<f64>, k: f64) -> Vec<Complex<f64>> {
    let s_3 = k * (one.compliance + two.compliance);
    // Symmetrised: the product of the off-diagonal entries is all that the eigenvalues see.
    let (p_1, p_2) = (k * one.a_s, k * two.a_s);
    let (r_1, r_2) = (p_1.abs().sqrt(), p_2.abs().sqrt());
    #[rustfmt::skip]
    let matrix = Matrix3::new(
        -s_3,                     r_1,   r_2,
        -r_1.copysign(p_1),       one.s, 0.0,
        -r_2.copysign(p_2),       0.0,   two.s,
    );
    let polynomial = |s: Complex<f64>| {
        let (d_1, d_2, d_3) = (s - one.s, s - two.s, s + s_3);
        let value = d_3 * d_1 * d_2 + d_1 * p_2 + d_2 * p_1;
        let slope = d_1 * d_2 + d_3 * d_2 + d_3 * d_1 + p_1 + p_2;
        (value, slope)
    };
    matrix
        .complex_eigenvalues()
        .iter()
        .map(|&start| polished(start, polynomial))
        .collect()
}

/// Newton's method for a zero that is nearly known; stops where the residual no longer falls.
fn polished(
    start: Complex<f64>,
    g: impl Fn(Complex<f64>) -> (Complex<f64>, Complex<f64>),
) -> Complex<f64> {
    let mut s = start;
    let (mut value, mut slope) = g(s);
    for _ in 0..POLISH {
        let next = s - value / slope;
        let (at_next, slope_at_next) = g(next);
        if at_next.norm().is_nan() || at_next.norm() >= value.norm() {
            break;
        }
        (s, value, slope) = (next, at_next, slope_at_next);
    }
    s
}

fn verdict(stable_if_negative: Interval) -> Verdict {
    match stable_if_negative.sign() {
        Some(sign) if sign < 0.0 => Verdict::Stable,
        Some(_) => Verdict::Unstable,
        None => Verdict::Undecided,
    }
}

/// One interface: stable where k > k_c  (16).
fn oscillation_verdict(one: &Interface<Interval>, k: f64) -> Verdict {
    verdict(one.s - one.compliance * k)
}

/// The symmetric state is stable exactly where k_c < 0, whatever the stiffness (27).
fn symmetric_verdict(one: &Interface<Interval>, _k: f64) -> Verdict {
    verdict(one.s)
}

/// Routh-Hurwitz for (30).
fn asymmetric_verdict(one: &Interface<Interval>, two: &Interface<Interval>, k: f64) -> Verdict {
    let [c_2, c_1, c_0] = routh_hurwitz(one, two, Interval::constant(k));
    let conditions = [c_2, c_0, c_2 * c_1 - c_0].map(Interval::sign);
    if conditions.contains(&Some(-1.0)) {
        Verdict::Unstable
    } else if conditions.contains(&None) {
        Verdict::Undecided
    } else {
        Verdict::Stable
    }
}
