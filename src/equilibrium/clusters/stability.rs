//! Eigenvalues and stability of clusters of equal interfaces.
//!
//! States in which the interfaces of a cluster slide alike are an invariant subspace: its eigenvalues are the roots of
//! z + K sum_j n_j (1/F_V + a_j/(z - s_j)) = 0, (30) for several clusters, with the letters of (31). Every a_j is positive, so that one root lies between
//! any two neighbouring s_j. Within a cluster the interfaces part at a fixed stress: there s_j is the eigenvalue, n_j - 1 times.

use super::super::eigenvalues::{Stability, Verdict};
use super::super::interface::Interface;
use super::super::polynomial::{InexactCoefficients, roots_with};
use super::super::{Equilibrium, OF_31_DIGITS};
use crate::error::Result;
use crate::friction::{AnyLaw, effects, positive};
use crate::number::{Interval, Jet, Real};
use nalgebra::Complex;

/// In which direction an eigenvector points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EigenvalueKind {
    /// The clusters stay together.
    Clusters,
    /// The interfaces of this cluster part.
    Within(usize),
}

impl EigenvalueKind {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            EigenvalueKind::Clusters => "clusters",
            EigenvalueKind::Within(_) => "within",
        }
    }
}

/// An eigenvalue of N interfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClusterEigenvalue {
    /// In V*/L.
    pub value: Complex<f64>,
    /// The true one lies within this distance in the complex plane; infinite where there is no bound.
    pub uncertainty: f64,
    /// How often it counts.
    pub multiplicity: usize,
    /// Its direction.
    pub kind: EigenvalueKind,
}

/// What is known of the stability among all motions of N interfaces.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ClusterStability {
    /// Largest real part first; one beyond the range of doubles is left out.
    pub eigenvalues: Vec<ClusterEigenvalue>,
    /// Stable, unstable or undecided.
    pub verdict: Verdict,
}

impl ClusterStability {
    /// How many eigenvalues have a positive real part, as they are.
    pub fn unstable(&self) -> usize {
        let growing = self.eigenvalues.iter().filter(|one| one.value.re > 0.0);
        growing.map(|one| one.multiplicity).sum()
    }
}

impl From<Stability> for ClusterStability {
    /// Where every interface is a cluster.
    fn from(stability: Stability) -> Self {
        let all = stability.eigenvalues.into_iter();
        let one = |(value, uncertainty)| ClusterEigenvalue {
            value,
            uncertainty,
            multiplicity: 1,
            kind: EigenvalueKind::Clusters,
        };
        ClusterStability {
            eigenvalues: all.zip(stability.uncertainty).map(one).collect(),
            verdict: stability.verdict,
        }
    }
}

/// Clusters there are at most: one on each branch of the steady curve.
const CLUSTERS: usize = 3;
/// The coefficients of the characteristic polynomial, then s of each cluster.
const COUNT: usize = CLUSTERS + 2 + CLUSTERS;
const WITHIN: usize = CLUSTERS + 2;

/// Eigenvalues and verdict, at stiffness K, of an equilibrium that is told by its clusters, among all motions of its interfaces.
///
/// # Errors
/// [`crate::Error::Parameter`] unless K is positive and finite.
pub fn cluster_stability(
    law: &AnyLaw,
    equilibrium: &Equilibrium,
    stiffness: f64,
) -> Result<ClusterStability> {
    positive("stiffness", stiffness)?;
    let known = bounded(law, equilibrium, stiffness);
    let clusters = equilibrium.counts.len();
    let of_clusters = known.part(0..clusters + 2);
    let within = known.part(WITHIN..WITHIN + clusters);
    let mut slopes: Vec<f64> = within.values.iter().map(|s| s.to_f64()).collect();
    slopes.sort_by(f64::total_cmp);
    let between = (clusters == CLUSTERS).then(|| [slopes[0], slopes[1]]);
    let collective = roots_with(&of_clusters, between).into_iter();
    let collective = collective.map(|(value, uncertainty)| ClusterEigenvalue {
        value,
        uncertainty,
        multiplicity: 1,
        kind: EigenvalueKind::Clusters,
    });
    let parting = (0..clusters).filter(|&i| equilibrium.counts[i] > 1);
    let parting = parting.map(|i| {
        let value = within.values[i].to_f64();
        ClusterEigenvalue {
            value: Complex::new(value, 0.0),
            uncertainty: within.error(i) + f64::EPSILON * value.abs(),
            multiplicity: equilibrium.counts[i] - 1,
            kind: EigenvalueKind::Within(i),
        }
    });
    let finite = |one: &ClusterEigenvalue| one.value.re.is_finite() && one.value.im.is_finite();
    let mut eigenvalues: Vec<_> = collective.chain(parting).filter(finite).collect();
    eigenvalues.sort_by(|a, b| {
        let (a, b) = (a.value, b.value);
        b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im))
    });
    Ok(ClusterStability {
        eigenvalues,
        verdict: verdict(equilibrium, &of_clusters, &within),
    })
}

/// The characteristic polynomial A + K B of clusters, the constants of A and of B first. What is not there is zero.
pub(super) fn characteristic<T: Real>(counts: &[usize], each: &[Interface<T>]) -> [[T; WITHIN]; 2] {
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    // the product of (z - s_j), all or all but one
    let product = |without: Option<usize>| {
        let mut p = [zero; WITHIN];
        p[0] = one;
        for (i, interface) in each.iter().enumerate() {
            if Some(i) != without {
                for j in (0..WITHIN).rev() {
                    let below = if j == 0 { zero } else { p[j - 1] };
                    p[j] = below - p[j] * interface.s;
                }
            }
        }
        p
    };
    let all = product(None);
    let mut parts = [[zero; WITHIN]; 2];
    parts[0][1..].copy_from_slice(&all[..WITHIN - 1]);
    for (i, interface) in each.iter().enumerate() {
        let others = product(Some(i));
        for j in 0..WITHIN {
            let term = all[j] * interface.compliance + others[j] * interface.a_s;
            parts[1][j] = parts[1][j] + term * counts[i] as f64;
        }
    }
    parts
}

/// The characteristic polynomial over the larger one of K and 1, its constant first, then s of each cluster. What is not there is zero.
fn coefficients<T: Real>(
    law: &AnyLaw,
    counts: &[usize],
    rates: &[T],
    stiffness: f64,
) -> [T; COUNT] {
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    let (m, k) = if stiffness > 1.0 {
        (one / stiffness, one)
    } else {
        (one, T::constant(stiffness))
    };
    let each: Vec<_> = rates.iter().map(|&v| Interface::at(law, v)).collect();
    let [free, stiff] = characteristic(counts, &each);
    let mut sum = [zero; COUNT];
    for j in 0..WITHIN {
        sum[j] = free[j] * m + stiff[j] * k;
    }
    for (i, interface) in each.iter().enumerate() {
        sum[WITHIN + i] = interface.s;
    }
    sum
}

/// The coefficients with what they may be off.
fn bounded(law: &AnyLaw, equilibrium: &Equilibrium, stiffness: f64) -> InexactCoefficients {
    let (counts, rates) = (&equilibrium.counts, &equilibrium.slip_rate);
    let exact = coefficients(law, counts, &equilibrium.precise, stiffness);
    let of_inputs = effects(law, |law| coefficients(law, counts, rates, stiffness));
    let point: Vec<Interval> = rates.iter().map(|&v| Interval::constant(v)).collect();
    let at_point = coefficients(law, counts, &point, stiffness);
    let bounds = &equilibrium.rate_bounds;
    let slopes: Vec<[Interval; COUNT]> = (0..rates.len())
        .map(|of| {
            let along = bounds.iter().enumerate().map(|(i, &value)| Jet {
                value,
                gradient: [Interval::constant(if i == of { 1.0 } else { 0.0 })],
            });
            let along: Vec<Jet<Interval, 1>> = along.collect();
            coefficients(law, counts, &along, stiffness).map(|one| one.gradient[0])
        })
        .collect();
    let radii = equilibrium.slip_rate_uncertainty();
    let mut shifts: Vec<_> = of_inputs.iter().map(|effect| effect.to_vec()).collect();
    let middle = |i: usize, of: usize| slopes[of][i].leading();
    let together = equilibrium.together.iter().enumerate();
    let together = |i: usize| {
        together
            .clone()
            .map(|(of, part)| middle(i, of) * part)
            .sum::<f64>()
    };
    shifts.push((0..COUNT).map(together).collect());
    for (of, radius) in radii.iter().enumerate() {
        let own = radius - equilibrium.together[of].abs();
        shifts.push((0..COUNT).map(|i| middle(i, of) * own).collect());
    }
    let rest = |i: usize| {
        let value = exact[i].to_f64();
        // below, 31 digits are no longer that many
        let digits = (1e-250..1e250).contains(&value.abs());
        let part = if digits { OF_31_DIGITS } else { 1.0 };
        let rounding = part * at_point[i].distance_from(value);
        let slope = |of: usize| slopes[of][i];
        let within = radii.iter().enumerate();
        let within = within.map(|(of, r)| slope(of).distance_from(slope(of).leading()) * r);
        rounding + within.sum::<f64>()
    };
    InexactCoefficients {
        values: exact.to_vec(),
        shifts,
        rest: (0..COUNT).map(rest).collect(),
    }
}

/// Routh-Hurwitz for the clusters, and the sign of s within each.
fn verdict(
    equilibrium: &Equilibrium,
    of_clusters: &InexactCoefficients,
    within: &InexactCoefficients,
) -> Verdict {
    let known = |p: &InexactCoefficients, i: usize| {
        let value = p.values[i].to_f64();
        Interval::around(value, p.error(i) + f64::EPSILON * value.abs())
    };
    let parting = (0..within.values.len()).filter(|&i| equilibrium.counts[i] > 1);
    let mut conditions: Vec<Interval> = parting.map(|i| -known(within, i)).collect();
    let p: Vec<Interval> = (0..of_clusters.values.len())
        .map(|i| known(of_clusters, i))
        .collect();
    match p[..] {
        [p_0, p_1, _] => conditions.extend([p_0, p_1]),
        [p_0, p_1, p_2, p_3] => conditions.extend([p_2, p_0, p_2 * p_1 - p_3 * p_0]),
        [p_0, p_1, p_2, p_3, p_4] => {
            let second = p_3 * p_2 - p_4 * p_1;
            conditions.extend([p_3, p_0, second, second * p_1 - p_3 * p_3 * p_0]);
        }
        _ => {}
    }
    super::super::eigenvalues::all_positive(&conditions)
}
