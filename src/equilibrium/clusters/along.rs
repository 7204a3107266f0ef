//! Equilibria as curves: under the stress of a middle rate x a share of the interfaces has one V_H, so that x is a coordinate along the
//! equilibria of the share, and V_H and the linearised equations are functions of it that are written down.

use super::super::Equilibrium;
use super::super::interface::Interface;
use super::super::polynomial::{InexactCoefficients, roots};
use super::super::refine::newton;
use super::cell::weighted;
use super::curve::{FAST, MIDDLE, Rates, SLOW, SteadyCurve};
use super::root::{Reach, change, reach};
use super::stability::characteristic;
use crate::error::Result;
use crate::friction::AnyLaw;
use crate::number::{DoubleDouble, Interval, Jet, Real, bracketed_root};
use std::cell::OnceCell;

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

/// The steady state under the stress of one rate, for any partition; in 31 digits once these are asked for.
#[derive(Debug, Clone)]
pub(crate) struct SteadyPoint<'a> {
    curve: EquilibriumCurve<'a>,
    /// The coordinate.
    pub x: DoubleDouble,
    /// The rates on the branches as doubles; 0 where there is none.
    near: Rates<f64>,
    /// The branch that the middle one meets here.
    meets: Option<usize>,
    rates: Rates<OnceCell<Along>>,
    letters: Rates<OnceCell<Interface<Along>>>,
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

    /// The steady curve of another law, to measure its effect: its extrema are known roughly. `None` where it has others.
    pub fn of<'b>(&self, law: &'b AnyLaw) -> Option<EquilibriumCurve<'b>> {
        match self {
            EquilibriumCurve::Alike(_) => Some(EquilibriumCurve::Alike(law)),
            EquilibriumCurve::Shares(curve) => {
                let rough = SteadyCurve::rough(law, curve.fastest());
                (rough.has() == curve.has()).then_some(EquilibriumCurve::Shares(rough))
            }
        }
    }

    /// What there is at a rate.
    pub fn point(&self, x: DoubleDouble) -> SteadyPoint<'a> {
        let near = match self {
            EquilibriumCurve::Alike(_) => [0.0, x.to_f64(), 0.0],
            EquilibriumCurve::Shares(curve) => curve.rates(x.to_f64()),
        };
        SteadyPoint::new(*self, x, near, None)
    }

    /// Where the middle branch meets the slow or the fast one. `None` where there is no such branch.
    pub fn end(&self, branch: usize) -> Option<SteadyPoint<'a>> {
        let EquilibriumCurve::Shares(curve) = self else {
            return None;
        };
        let x = curve.extremum(branch)?.leading();
        let mut near = curve.rates(x);
        near[branch] = x;
        Some(SteadyPoint::new(
            *self,
            DoubleDouble::from(x),
            near,
            Some(branch),
        ))
    }

    /// The zero of a function in a bracket, in 31 digits where its derivative is known.
    ///
    /// # Errors
    /// [`crate::Error::NotConverged`] where the function is no number in the bracket.
    pub fn zero(
        &self,
        what: &'static str,
        (low, high, left): Bracket,
        f: impl Fn(&SteadyPoint<'a>) -> Along,
    ) -> Result<SteadyPoint<'a>> {
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
    pub fn state(&self, share: &Share, driving: f64, point: &SteadyPoint<'_>) -> Equilibrium {
        match self {
            EquilibriumCurve::Alike(law) => super::alike(law, driving, share.iter().sum()),
            EquilibriumCurve::Shares(curve) => {
                let rates = std::array::from_fn(|i| match share[i] {
                    0 if i != MIDDLE => DoubleDouble::ZERO,
                    _ => point.rate_on(i).value,
                });
                let reach = match point.meets.and_then(|branch| curve.extremum(branch)) {
                    Some(extremum) => {
                        let enclosed = curve.enclosed(extremum);
                        Reach::apart(std::array::from_fn(|i| {
                            let v = rates[i].to_f64();
                            enclosed[i].distance_from(v) + v * f64::EPSILON
                        }))
                    }
                    None => reach(curve, share, driving, &rates),
                };
                super::of_share(curve.law, driving, share, &rates, &reach)
            }
        }
    }

    /// How far the rates of a point at which branches meet may be off, for the law's parameters as they are.
    pub fn radii_at_end(&self, point: &SteadyPoint<'_>) -> Rates<f64> {
        let (EquilibriumCurve::Shares(curve), Some(branch)) = (self, point.meets) else {
            return [0.0; 3];
        };
        let enclosed = curve
            .extremum(branch)
            .map(|extremum| curve.enclosed(extremum));
        let distance = |i: usize| {
            enclosed.map_or(0.0, |all: Rates<Interval>| {
                all[i].distance_from(point.rate_on(i).value.to_f64())
            })
        };
        std::array::from_fn(distance)
    }
}

impl<'a> SteadyPoint<'a> {
    fn new(
        curve: EquilibriumCurve<'a>,
        x: DoubleDouble,
        near: Rates<f64>,
        meets: Option<usize>,
    ) -> Self {
        SteadyPoint {
            curve,
            x,
            near,
            meets,
            rates: Rates::default(),
            letters: Rates::default(),
        }
    }

    /// The coordinate as a double.
    pub fn rate(&self) -> f64 {
        self.x.to_f64()
    }

    /// The rate on a branch.
    pub fn rate_on(&self, branch: usize) -> Along {
        *self.rates[branch].get_or_init(|| {
            let x = Along::variable(self.x, 0);
            match self.curve {
                _ if branch == MIDDLE => x,
                EquilibriumCurve::Alike(_) => Along::constant(0.0),
                // the stress does not change with x, and one rate falls as the other one rises
                EquilibriumCurve::Shares(_) if self.meets == Some(branch) => Jet {
                    value: self.x,
                    gradient: [-DoubleDouble::ONE],
                },
                EquilibriumCurve::Shares(curve) => {
                    let rate = curve.precise_on(branch, self.x, self.near[branch]);
                    let change = match self.meets {
                        Some(_) => DoubleDouble::ZERO,
                        None => change(&curve, branch, self.x, rate) / self.x,
                    };
                    Jet {
                        value: rate,
                        gradient: [change],
                    }
                }
            }
        })
    }

    /// V_H of a share.
    pub fn driving(&self, share: &Share) -> Along {
        let each = std::array::from_fn(|i| match share[i] {
            0 => Along::constant(0.0),
            _ => self.rate_on(i),
        });
        weighted(share, &each)
    }

    /// V_H of a share, as a double.
    pub fn driving_near(&self, share: &Share) -> f64 {
        weighted(share, &self.near)
    }

    /// dV_H/dx of a share, with its own derivative.
    pub fn driving_slope(&self, share: &Share) -> Along {
        let x = Along::variable(self.x, 0);
        let each = std::array::from_fn(|i| match (share[i], self.curve) {
            (1.., EquilibriumCurve::Shares(curve)) if i != MIDDLE => {
                change(&curve, i, x, self.rate_on(i)) / x
            }
            _ => Along::constant(1.0),
        });
        weighted(share, &each)
    }

    /// A number with the sign of dV_H/dx of a share, from doubles where these are enough.
    pub fn slope_sign(&self, share: &Share) -> f64 {
        /// A sum that is smaller, in parts of its terms, is computed in 31 digits.
        const CLOSE: f64 = 1e-9;
        let each: Rates<f64> = std::array::from_fn(|i| match (share[i], self.curve) {
            (1.., EquilibriumCurve::Shares(curve)) if i != MIDDLE => {
                change(&curve, i, self.near[MIDDLE], self.near[i])
            }
            _ => self.near[MIDDLE],
        });
        let (sum, size) = (weighted(share, &each), weighted(share, &each.map(f64::abs)));
        match self.meets.is_none() && sum.abs() > CLOSE * size {
            true => sum,
            false => self.driving(share).gradient[0].to_f64(),
        }
    }

    /// The rate of each interface.
    pub fn rate_of_each(&self, share: &Share) -> Vec<DoubleDouble> {
        let present = [SLOW, MIDDLE, FAST].into_iter().filter(|&i| share[i] > 0);
        present
            .flat_map(|i| vec![self.rate_on(i).value; share[i]])
            .collect()
    }

    /// What decides whether the clusters of a share oscillate.
    pub fn oscillation(&self, share: &Share) -> Oscillation<Along> {
        let law = self.curve.law();
        Oscillation::new(share, |i| {
            *self.letters[i].get_or_init(|| {
                let mut letters = Interface::at(law, self.rate_on(i));
                // the extremum itself, of which the coordinate is the double next to it
                if self.meets.is_some_and(|branch| i == MIDDLE || i == branch) {
                    letters.s.value = DoubleDouble::ZERO;
                }
                letters
            })
        })
    }

    /// The last but one Hurwitz determinant at K over the sum of the sizes of its terms, from doubles where these are enough.
    pub fn relative_determinant(&self, share: &Share, stiffness: f64) -> f64 {
        /// A smaller one is computed in 31 digits.
        const CLOSE: f64 = 1e-9;
        let law = self.curve.law();
        let near = Oscillation::new(share, |i| Interface::at(law, self.near[i]));
        let near = near.relative_determinant(stiffness);
        match self.meets.is_none() && near.abs() > CLOSE {
            true => near,
            false => self.oscillation(share).relative_determinant(stiffness),
        }
    }
}

/// The characteristic polynomial A + K B of clusters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Oscillation<T> {
    free: [T; 5],
    stiff: [T; 5],
    clusters: usize,
}

impl<T: Real> Oscillation<T> {
    fn new(share: &Share, letters: impl Fn(usize) -> Interface<T>) -> Self {
        let present = || [SLOW, MIDDLE, FAST].into_iter().filter(|&i| share[i] > 0);
        let counts: Vec<usize> = present().map(|i| share[i]).collect();
        let each: Vec<_> = present().map(letters).collect();
        let [free, stiff] = characteristic(&counts, &each);
        Oscillation {
            free,
            stiff,
            clusters: counts.len(),
        }
    }

    /// The last but one Hurwitz determinant as a polynomial in K, its constant first: it vanishes where two eigenvalues are opposite, as
    /// a pair on the imaginary axis is. Positive where the clusters are stable.
    pub fn determinant(&self) -> [T; 4] {
        let zero = T::constant(0.0);
        let p = |i: usize| [self.free[i], self.stiff[i], zero, zero];
        let times = |a: [T; 4], b: [T; 4]| {
            let mut product = [zero; 4];
            for i in 0..4 {
                for j in 0..4 - i {
                    product[i + j] = product[i + j] + a[i] * b[j];
                }
            }
            product
        };
        let less = |a: [T; 4], b: [T; 4]| std::array::from_fn(|i| a[i] - b[i]);
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
        let terms = self.determinant().map(|term| term.leading());
        let powers = [1.0, stiffness, stiffness.powi(2), stiffness.powi(3)];
        let each = || terms.iter().zip(powers).map(|(term, power)| term * power);
        each().sum::<f64>() / each().map(f64::abs).sum::<f64>()
    }
}

impl Oscillation<Along> {
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

    /// K at which the coefficient of z vanishes: where the constant one does too, as at a fold, two eigenvalues are zero.
    pub fn second_zero(&self) -> Along {
        -(self.free[1] / self.stiff[1])
    }

    /// The determinant at K.
    pub fn determinant_at(&self, stiffness: Along) -> Along {
        let terms = self.determinant().into_iter().rev();
        terms.fold(Along::constant(0.0), |sum, term| sum * stiffness + term)
    }

    /// dK/dx where the determinant h vanishes at K and stays zero.
    pub fn slope(&self, stiffness: DoubleDouble) -> DoubleDouble {
        // -h_x/h_K
        let h_x = self.determinant_at(constant(stiffness)).gradient[0];
        let both = self.determinant_at(Jet::variable(stiffness, 0)).gradient[0];
        -(h_x / (both - h_x))
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
