//! Eigenvalues and stability of an equilibrium, from the characteristic polynomials (14), (26) and (30).
//!
//! The coefficients are computed in 31 digits, with bounds on what they may be off: the slope in the slower rate over its
//! bounds, in intervals, and the effect of the rounding of the law's parameters. The verdict does not look at eigenvalues: it is
//! the Routh-Hurwitz criterion over these bounds, and "undecided" where that can't tell.

use super::interface::{Interface, LawOfEach, weighted};
use super::polynomial::{InexactCoefficients, roots};
use super::{Equilibrium, OF_31_DIGITS, Symmetry};
use crate::error::Result;
use crate::friction::{effects, positive};
use crate::number::{Interval, Jet, Real};
use nalgebra::Complex;

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
#[non_exhaustive]
pub struct Stability {
    /// In V*/L; one beyond the range of doubles is left out.
    pub eigenvalues: Vec<Complex<f64>>,
    /// The distance in the complex plane within which the true eigenvalue lies, for each; infinite where there is no bound.
    pub uncertainty: Vec<f64>,
    /// Stable, unstable or undecided.
    pub verdict: Verdict,
}

impl Stability {
    /// How many eigenvalues have a positive real part, as they are.
    pub fn unstable(&self) -> usize {
        self.eigenvalues.iter().filter(|z| z.re > 0.0).count()
    }
}

/// Eigenvalues and verdict of an equilibrium at stiffness K.
///
/// # Errors
/// [`crate::Error::Parameter`] unless K is positive and finite.
pub fn stability(
    law: &impl LawOfEach,
    equilibrium: &Equilibrium,
    stiffness: f64,
) -> Result<Stability> {
    positive("stiffness", stiffness)?;
    let known = bounded(law, equilibrium, stiffness);
    let found = sorted(equilibrium, &known);
    Ok(Stability {
        eigenvalues: found.iter().map(|(z, _)| *z).collect(),
        uncertainty: found.iter().map(|(_, radius)| *radius).collect(),
        verdict: verdict(equilibrium, &known),
    })
}

/// The eigenvalues alone, largest real part first: without bounds, at a part of the price.
///
/// # Errors
/// As of [`stability`].
pub fn eigenvalues(
    law: &impl LawOfEach,
    equilibrium: &Equilibrium,
    stiffness: f64,
) -> Result<Vec<Complex<f64>>> {
    positive("stiffness", stiffness)?;
    let values = coefficients(law, equilibrium.symmetry, &equilibrium.precise, stiffness);
    let known = InexactCoefficients {
        values: values.to_vec(),
        shifts: Vec::new(),
        rest: vec![0.0; COUNT],
    };
    let found = sorted(equilibrium, &known);
    Ok(found.into_iter().map(|(z, _)| z).collect())
}

/// Of the polynomials whose product is the characteristic one: [p_0, p_1] of a linear factor, then [p_0, p_1, ..] of the rest.
const COUNT: usize = 6;

/// Where the second polynomial begins.
const SECOND: usize = 2;

/// All coefficients, over the larger one of K and 1, so that none overflows. Those that are not there are zero.
fn coefficients<T: Real>(
    laws: &impl LawOfEach,
    symmetry: Symmetry,
    rates: &[T],
    stiffness: f64,
) -> [T; COUNT] {
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    let (m, k) = if stiffness > 1.0 {
        (one / stiffness, one)
    } else {
        (one, T::constant(stiffness))
    };
    let first = Interface::at(laws.law(0), rates[0]);
    // s^2 - s (k_c - k)/F_V + k G_psi/F_V: (14), and P_2 of (26) with 2 k for k
    let quadratic = |k: T| {
        [
            k * first.g_psi * first.compliance,
            k * first.compliance - first.s * m,
        ]
    };
    match (symmetry, rates) {
        (Symmetry::Symmetric, [_]) => {
            let [p_0, p_1] = quadratic(k);
            [zero, zero, p_0, p_1, m, zero]
        }
        (Symmetry::Symmetric, _) => {
            let [p_0, p_1] = quadratic(k * 2.0);
            [-first.s, one, p_0, p_1, m, zero]
        }
        (Symmetry::Asymmetric, _) => {
            // P_3 (30)
            let second = Interface::at(laws.law(1), rates[1]);
            let [p_2, p_1, p_0] = weighted(&first, &second, m, k);
            [zero, zero, p_0, p_1, p_2, m]
        }
    }
}

/// The same with what they may be off.
fn bounded(law: &impl LawOfEach, equilibrium: &Equilibrium, stiffness: f64) -> InexactCoefficients {
    let (symmetry, rates) = (equilibrium.symmetry, &equilibrium.slip_rate);
    let slower = equilibrium.slower();
    let (slow, driving) = (rates[slower], equilibrium.driving);
    let exact = coefficients(law, symmetry, &equilibrium.precise, stiffness);
    let of_inputs = effects(law, |law| coefficients(law, symmetry, rates, stiffness));
    // both rates, of which the faster one is V_H less the other
    let both = |slow: Jet<Interval, 2>, driving: Jet<Interval, 2>| match symmetry {
        Symmetry::Symmetric => vec![driving / rates.len() as f64; rates.len()],
        Symmetry::Asymmetric if slower == 0 => vec![slow, driving - slow],
        Symmetry::Asymmetric => vec![driving - slow, slow],
    };
    let point = [slow, driving].map(Interval::constant);
    let [at_slow, at_driving] = Jet::variables(point);
    let at_point = coefficients(law, symmetry, &both(at_slow, at_driving), stiffness);
    let apart = driving * f64::EPSILON;
    let around = [
        equilibrium.rate_bounds[slower],
        Interval::around(driving, apart),
    ];
    let [near_slow, near_driving] = Jet::variables(around);
    let around = coefficients(law, symmetry, &both(near_slow, near_driving), stiffness);
    let reach = [equilibrium.radius, apart];
    let mut shifts: Vec<_> = of_inputs.iter().map(|effect| effect.to_vec()).collect();
    let slope = |i: usize, of: usize| around[i].gradient[of];
    for (of, reach) in reach.into_iter().enumerate() {
        let middle = |i| slope(i, of).leading() * reach;
        shifts.push((0..COUNT).map(middle).collect());
    }
    let rest = |i: usize| {
        let value = exact[i].to_f64();
        // below, 31 digits are no longer that many
        let digits = (1e-250..1e250).contains(&value.abs());
        let part = if digits { OF_31_DIGITS } else { 1.0 };
        let rounding = part * at_point[i].value.distance_from(value);
        let within = |of: usize| slope(i, of).distance_from(slope(i, of).leading());
        rounding + within(0) * reach[0] + within(1) * reach[1]
    };
    InexactCoefficients {
        values: exact.to_vec(),
        shifts,
        rest: (0..COUNT).map(rest).collect(),
    }
}

/// All roots, largest real part first.
fn sorted(equilibrium: &Equilibrium, known: &InexactCoefficients) -> Vec<(Complex<f64>, f64)> {
    let mut found = roots(&known.part(SECOND..COUNT));
    if equilibrium.symmetry == Symmetry::Symmetric && equilibrium.slip_rate.len() == 2 {
        found.extend(roots(&known.part(0..SECOND)));
    }
    found.sort_by(|(a, _), (b, _)| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    found
}

fn verdict(equilibrium: &Equilibrium, known: &InexactCoefficients) -> Verdict {
    let within = |i: usize| {
        let value = known.values[i].to_f64();
        Interval::around(value, known.error(i) + f64::EPSILON * value.abs())
    };
    let [q_0, _, p_0, p_1, p_2, p_3] = std::array::from_fn(within);
    match (equilibrium.symmetry, equilibrium.slip_rate.len()) {
        // one interface: stable where k > k_c  (16), p_0 being positive
        (Symmetry::Symmetric, 1) => all_positive(&[p_1]),
        // the symmetric state is stable exactly where k_c < 0, whatever the stiffness (27)
        (Symmetry::Symmetric, _) => all_positive(&[q_0]),
        // Routh-Hurwitz for (30)
        (Symmetry::Asymmetric, _) => all_positive(&[p_2, p_0, p_2 * p_1 - p_3 * p_0]),
    }
}

/// Stable where all of these are positive.
pub(super) fn all_positive(conditions: &[Interval]) -> Verdict {
    let signs = || conditions.iter().map(|x| x.sign());
    if signs().any(|sign| sign == Some(-1.0)) {
        Verdict::Unstable
    } else if signs().any(|sign| sign.is_none()) {
        Verdict::Undecided
    } else {
        Verdict::Stable
    }
}
