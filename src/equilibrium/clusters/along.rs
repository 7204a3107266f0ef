//! Equilibria as curves: under the stress of a middle rate x a share of the interfaces has one V_H, so that x is a coordinate along the
//! equilibria of the share, and V_H and the linearised equations are functions of it that are written down.

use super::super::Equilibrium;
use super::super::interface::Interface;
use super::super::polynomial::{InexactCoefficients, roots};
use super::super::refine::newton;
use super::cell::weighted;
use super::curve::{FAST, MIDDLE, Rates, SLOW, SteadyCurve};
use super::root::{changes, radii};
use super::stability::characteristic;
use crate::error::Result;
use crate::friction::AnyLaw;
use crate::number::{DoubleDouble, Interval, Jet, Real, bracketed_root};

/// How many interfaces slide on the slow, the middle and the fast branch of the steady curve. Where all slide alike, along all of the
/// curve, they count as on the middle one.
pub(crate) type Share = Rates<usize>;

/// A number along a curve of equilibria, with its derivative by the rate that is the coordinate.
pub(crate) type Along = Jet<DoubleDouble, 1>;

/// A curve of equilibria.
#[derive(Debug, Clone, Copy)]
pub(crate) enum EquilibriumCurve<'a> {
    /// All interfaces slide alike, at any rate: it is the coordinate.
    Alike(&'a AnyLaw),
    /// Each slides on a branch; the coordinate is the middle rate.
    Shares(SteadyCurve<'a>),
}

/// What is known under the stress of one rate, whatever the share.
#[derive(Debug, Clone)]
pub(crate) struct SteadyPoint {
    /// The rates on the branches; 0 where there is none.
    pub rates: Rates<Along>,
    letters: Rates<Interface<Along>>,
    /// The branch that the middle one meets here.
    meets: Option<usize>,
}

/// Where a function changes its sign: from where to where, and its sign at the first.
pub(crate) type Bracket = (f64, f64, f64);

impl<'a> EquilibriumCurve<'a> {
    /// The law.
    pub fn law(&self) -> &'a AnyLaw {
        match self {
            EquilibriumCurve::Alike(law) => law,
            EquilibriumCurve::Shares(curve) => curve.law,
        }
    }

    /// The same of another law. `None` where an extremum of it is not certainly one.
    pub fn of<'b>(&self, law: &'b AnyLaw) -> Option<EquilibriumCurve<'b>> {
        Some(match self {
            EquilibriumCurve::Alike(_) => EquilibriumCurve::Alike(law),
            EquilibriumCurve::Shares(curve) => {
                EquilibriumCurve::Shares(SteadyCurve::new(law, curve.fastest())?)
            }
        })
    }

    /// What there is at a rate.
    pub fn point(&self, x: DoubleDouble) -> SteadyPoint {
        let law = self.law();
        let (rates, slopes) = match self {
            EquilibriumCurve::Alike(_) => {
                let (zero, one) = (DoubleDouble::ZERO, DoubleDouble::ONE);
                ([zero, x, zero], [zero, one, zero])
            }
            EquilibriumCurve::Shares(curve) => {
                let rates = curve.precise(x, curve.rates(x.to_f64()));
                (rates, changes(curve, &rates).map(|change| change / x))
            }
        };
        SteadyPoint::new(law, rates, slopes, None)
    }

    /// Where the middle branch meets the slow or the fast one. `None` where there is no such branch.
    pub fn end(&self, branch: usize) -> Option<SteadyPoint> {
        let EquilibriumCurve::Shares(curve) = self else {
            return None;
        };
        let x = DoubleDouble::from(curve.extremum(branch)?.leading());
        let mut rates = curve.precise(x, curve.rates(x.to_f64()));
        rates[branch] = x;
        // the stress does not change with x, and one rate falls as the other one rises
        let mut slopes = [DoubleDouble::ZERO; 3];
        slopes[MIDDLE] = DoubleDouble::ONE;
        slopes[branch] = -DoubleDouble::ONE;
        Some(SteadyPoint::new(curve.law, rates, slopes, Some(branch)))
    }

    /// The zero of a function in a bracket, in 31 digits where its derivative is known.
    ///
    /// # Errors
    /// [`crate::Error::NotConverged`] where the function is no number in the bracket.
    pub fn zero(
        &self,
        what: &'static str,
        (low, high, left): Bracket,
        f: impl Fn(&SteadyPoint) -> Along,
    ) -> Result<SteadyPoint> {
        let x = bracketed_root(what, low, high, |x| {
            // of the ends the signs are known
            if x == low {
                return (left, f64::NAN);
            }
            if x == high {
                return (-left, f64::NAN);
            }
            let f = f(&self.point(DoubleDouble::from(x)));
            (f.value.to_f64(), f.gradient[0].to_f64())
        })?;
        let near = DoubleDouble::from(x);
        let precise = newton(near, high, |x: Along| f(&self.point(x.value)));
        Ok(self.point(if precise.is_finite() { precise } else { near }))
    }

    /// The equilibrium of a share here, which is that at this V_H.
    pub fn state(&self, share: &Share, driving: f64, point: &SteadyPoint) -> Equilibrium {
        match self {
            EquilibriumCurve::Alike(law) => super::alike(law, driving, share.iter().sum()),
            EquilibriumCurve::Shares(curve) => {
                let rates = point.rates.map(|rate| rate.value);
                let radii = match point.meets.and_then(|branch| curve.extremum(branch)) {
                    Some(extremum) => {
                        let enclosed = curve.enclosed(extremum);
                        std::array::from_fn(|i| {
                            let v = rates[i].to_f64();
                            enclosed[i].distance_from(v) + v * f64::EPSILON
                        })
                    }
                    None => radii(curve, share, driving, &rates),
                };
                super::of_share(curve.law, driving, share, &rates, &radii)
            }
        }
    }

    /// How far the rates of a point at which branches meet may be off, for the law's parameters as they are.
    pub fn radii_at_end(&self, point: &SteadyPoint) -> Rates<f64> {
        let (EquilibriumCurve::Shares(curve), Some(branch)) = (self, point.meets) else {
            return [0.0; 3];
        };
        let enclosed = curve
            .extremum(branch)
            .map(|extremum| curve.enclosed(extremum));
        let distance = |i: usize| {
            enclosed.map_or(0.0, |all: Rates<Interval>| {
                all[i].distance_from(point.rates[i].value.to_f64())
            })
        };
        std::array::from_fn(distance)
    }
}

impl SteadyPoint {
    fn new(
        law: &AnyLaw,
        rates: Rates<DoubleDouble>,
        slopes: Rates<DoubleDouble>,
        meets: Option<usize>,
    ) -> Self {
        let rates: Rates<Along> = std::array::from_fn(|i| Jet {
            value: rates[i],
            gradient: [slopes[i]],
        });
        SteadyPoint {
            rates,
            letters: rates.map(|v| Interface::at(law, v)),
            meets,
        }
    }

    /// The coordinate.
    pub fn rate(&self) -> f64 {
        self.rates[MIDDLE].value.to_f64()
    }

    /// V_H of a share.
    pub fn driving(&self, share: &Share) -> Along {
        weighted(share, &self.rates)
    }

    /// The rate of each interface.
    pub fn rate_of_each(&self, share: &Share) -> Vec<DoubleDouble> {
        let branches = [SLOW, MIDDLE, FAST].into_iter();
        branches
            .flat_map(|i| vec![self.rates[i].value; share[i]])
            .collect()
    }

    /// What decides whether the clusters of a share oscillate.
    pub fn oscillation(&self, share: &Share) -> Oscillation {
        let present = || [SLOW, MIDDLE, FAST].into_iter().filter(|&i| share[i] > 0);
        let counts: Vec<usize> = present().map(|i| share[i]).collect();
        let each: Vec<_> = present().map(|i| self.letters[i]).collect();
        let [free, stiff] = characteristic(&counts, &each);
        Oscillation {
            free,
            stiff,
            clusters: counts.len(),
        }
    }
}

/// The characteristic polynomial A + K B of clusters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Oscillation {
    free: [Along; 5],
    stiff: [Along; 5],
    clusters: usize,
}

impl Oscillation {
    /// The last but one Hurwitz determinant as a polynomial in K, its constant first: it vanishes where two eigenvalues are opposite, as
    /// a pair on the imaginary axis is. Positive where the clusters are stable.
    pub fn determinant(&self) -> [Along; 4] {
        let zero = Along::constant(0.0);
        let p = |i: usize| [self.free[i], self.stiff[i], zero, zero];
        let times = |a: [Along; 4], b: [Along; 4]| {
            let mut product = [zero; 4];
            for i in 0..4 {
                for j in 0..4 - i {
                    product[i + j] = product[i + j] + a[i] * b[j];
                }
            }
            product
        };
        let less = |a: [Along; 4], b: [Along; 4]| std::array::from_fn(|i| a[i] - b[i]);
        match self.clusters {
            1 => p(1),
            2 => less(times(p(2), p(1)), times(p(3), p(0))),
            _ => {
                let second = less(times(p(3), p(2)), times(p(4), p(1)));
                less(times(second, p(1)), times(times(p(3), p(3)), p(0)))
            }
        }
    }

    /// The same at K, over the sum of the sizes of its terms.
    pub fn relative_determinant(&self, stiffness: f64) -> f64 {
        let terms = self.determinant().map(|term| term.value.to_f64());
        let powers = [1.0, stiffness, stiffness.powi(2), stiffness.powi(3)];
        let each = || terms.iter().zip(powers).map(|(term, power)| term * power);
        each().sum::<f64>() / each().map(f64::abs).sum::<f64>()
    }

    /// The stiffnesses at which a pair of eigenvalues is on the imaginary axis, ascending.
    pub fn stiffnesses(&self) -> Vec<DoubleDouble> {
        let terms = self.determinant().map(|term| term.value);
        let polynomial = InexactCoefficients {
            values: terms.to_vec(),
            shifts: Vec::new(),
            rest: vec![0.0; terms.len()],
        };
        let real = roots(&polynomial).into_iter().map(|(root, _)| root);
        let positive = real.filter(|root| root.im == 0.0 && root.re > 0.0);
        let precise = positive.map(|root| {
            newton(DoubleDouble::from(root.re), f64::INFINITY, |k: Along| {
                let rising = terms.iter().rev();
                rising.fold(Along::constant(0.0), |sum, &term| sum * k + constant(term))
            })
        });
        let mut all: Vec<DoubleDouble> = precise
            .filter(|&k| self.frequency_squared(constant(k)).value.to_f64() > 0.0)
            .collect();
        all.sort_by(|a, b| a.to_f64().total_cmp(&b.to_f64()));
        all
    }

    /// The determinant at K.
    pub fn determinant_at(&self, stiffness: Along) -> Along {
        let terms = self.determinant().into_iter().rev();
        terms.fold(Along::constant(0.0), |sum, term| sum * stiffness + term)
    }

    /// omega^2 where the determinant vanishes at K; the pair is on the imaginary axis where it is positive.
    pub fn frequency_squared(&self, stiffness: Along) -> Along {
        let p = |i: usize| self.free[i] + self.stiff[i] * stiffness;
        match self.clusters {
            1 => p(0),
            2 => p(1),
            _ => p(1) / p(3),
        }
    }
}

/// A number that is the same all along.
pub(crate) fn constant(value: DoubleDouble) -> Along {
    Jet {
        value,
        gradient: [DoubleDouble::ZERO],
    }
}
