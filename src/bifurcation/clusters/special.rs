//! Special points of equilibria of N interfaces, in 31 digits and with error budgets.
//!
//! A fold is where V_H of a share has an extremum, a branch point where two branches of the steady curve meet, a Hopf point where the
//! Hurwitz determinant vanishes. What the rounding of the law's parameters, and of K or V_H, does to them follows from the derivatives.

use crate::bifurcation::equilibria::lyapunov::first_lyapunov;
use crate::bifurcation::{Criticality, Label, Parameter, Special, Symmetry};
use crate::equilibrium::{Along, Bracket, EquilibriumCurve, MIDDLE, Share, SteadyPoint, constant};
use crate::error::Result;
use crate::friction::{AnyLaw, effects, rounding};
use crate::number::{DoubleDouble, Jet, Real, Uncertain};
use std::f64::consts::TAU;

/// The fold of a share in a bracket.
///
/// # Errors
/// [`crate::Error::NotConverged`] if the search fails.
pub(super) fn fold(
    curve: &EquilibriumCurve<'_>,
    share: &Share,
    bracket: Bracket,
) -> Result<(SteadyPoint, Uncertain)> {
    let point = curve.zero("a fold of a share", bracket, |point| Jet {
        value: point.driving(share).gradient[0],
        gradient: [DoubleDouble::from(f64::NAN)],
    })?;
    // V_H has an extremum: what x is off does not count
    let driving = point.driving(share).value.to_f64();
    let x = point.rates[MIDDLE].value;
    let at = |law: &AnyLaw| Some(curve.of(law)?.point(x).driving(share).value.to_f64());
    let budget = rounding(curve.law(), at) + driving * f64::EPSILON;
    Ok((point, Uncertain::new(driving, budget)))
}

/// V_H of a share where the middle branch meets the slow or the fast one.
pub(super) fn meeting(
    curve: &EquilibriumCurve<'_>,
    share: &Share,
    branch: usize,
) -> Option<(SteadyPoint, Uncertain)> {
    let point = curve.end(branch)?;
    let driving = point.driving(share).value.to_f64();
    let radii = curve.radii_at_end(&point);
    let own = (0..3).filter(|&i| share[i] > 0);
    let own: f64 = own.map(|i| radii[i] * share[i] as f64).sum();
    let at = |law: &AnyLaw| Some(curve.of(law)?.end(branch)?.driving(share).value.to_f64());
    let budget = rounding(curve.law(), at) + own + driving * f64::EPSILON;
    Some((point, Uncertain::new(driving, budget)))
}

/// A Hopf point of a share: which of V_H and K is exact, and where.
#[derive(Debug, Clone)]
pub(super) struct ShareHopf<'a> {
    pub curve: EquilibriumCurve<'a>,
    pub share: Share,
    pub point: SteadyPoint,
    pub stiffness: DoubleDouble,
    /// What varies on the way to it: the other one is exact.
    pub along: Parameter,
}

/// V_H, the determinant and omega^2 as they change in some way.
type Changes = [f64; 3];

impl<'a> ShareHopf<'a> {
    /// At this K in a bracket. `None` where no pair is on the imaginary axis: two real eigenvalues of opposite sign are no bifurcation.
    ///
    /// # Errors
    /// [`crate::Error::NotConverged`] if the search fails.
    pub fn at_stiffness(
        curve: &EquilibriumCurve<'a>,
        share: &Share,
        stiffness: f64,
        bracket: Bracket,
    ) -> Result<Option<Self>> {
        let k = DoubleDouble::from(stiffness);
        let point = curve.zero("a Hopf point of a share", bracket, |point| {
            point.oscillation(share).determinant_at(constant(k))
        })?;
        let found = ShareHopf {
            curve: *curve,
            share: *share,
            point,
            stiffness: k,
            along: Parameter::Driving,
        };
        let oscillates = found.frequency_squared().value.to_f64() > 0.0;
        Ok(oscillates.then_some(found))
    }

    /// V_H and K.
    pub fn place(&self) -> [f64; 2] {
        let driving = self.point.driving(&self.share).value;
        [driving, self.stiffness].map(DoubleDouble::to_f64)
    }

    /// Whether all interfaces slide alike.
    pub fn symmetry(&self) -> Symmetry {
        match self.share.iter().filter(|&&n| n > 0).count() {
            1 => Symmetry::Symmetric,
            _ => Symmetry::Asymmetric,
        }
    }

    fn frequency_squared(&self) -> Along {
        let oscillation = self.point.oscillation(&self.share);
        oscillation.frequency_squared(constant(self.stiffness))
    }

    fn values(&self, curve: &EquilibriumCurve<'_>) -> Changes {
        let x = self.point.rates[MIDDLE].value;
        let point = curve.point(x);
        let oscillation = point.oscillation(&self.share);
        let k = constant(self.stiffness);
        [
            point.driving(&self.share),
            oscillation.determinant_at(k),
            oscillation.frequency_squared(k),
        ]
        .map(|one| one.value.to_f64())
    }

    /// By x, and by K.
    fn derivatives(&self) -> [Changes; 2] {
        let oscillation = self.point.oscillation(&self.share);
        let at = |k: Along| {
            let [h, w] = [
                oscillation.determinant_at(k),
                oscillation.frequency_squared(k),
            ];
            [self.point.driving(&self.share), h, w].map(|one| one.gradient[0])
        };
        let by_x = at(constant(self.stiffness));
        // x and K change at once
        let by_both = at(Jet::variable(self.stiffness, 0));
        let by_k = std::array::from_fn(|i| match i {
            0 => 0.0,
            _ => (by_both[i] - by_x[i]).to_f64(),
        });
        [by_x.map(DoubleDouble::to_f64), by_k]
    }

    /// What V_H, K and omega^2 may be off.
    fn budgets(&self) -> [f64; 3] {
        let unknown = |law: &AnyLaw| match self.curve.of(law) {
            Some(curve) => self.values(&curve),
            None => [f64::NAN; 3],
        };
        let mut all = effects(self.curve.law(), unknown);
        let [by_x, by_k] = self.derivatives();
        let k = self.stiffness.to_f64();
        let driving = self.point.driving(&self.share).value.to_f64();
        all.push(match self.along {
            Parameter::Driving => by_k.map(|change| change * k * f64::EPSILON),
            Parameter::Stiffness => [driving * f64::EPSILON, 0.0, 0.0],
        });
        let mut sums = [driving * f64::EPSILON, k * f64::EPSILON, 0.0];
        for [v, h, w] in all {
            let moved = match self.along {
                Parameter::Driving => {
                    let x = -h / by_x[1];
                    [v + by_x[0] * x, 0.0, w + by_x[2] * x]
                }
                Parameter::Stiffness => {
                    let x = -v / by_x[0];
                    let k = -(h + by_x[1] * x) / by_k[1];
                    [0.0, k, w + by_x[2] * x + by_k[2] * k]
                }
            };
            for (sum, one) in sums.iter_mut().zip(moved) {
                *sum += one.abs();
            }
        }
        match self.along {
            Parameter::Driving => sums[1] = 0.0,
            Parameter::Stiffness => sums[0] = 0.0,
        }
        sums
    }

    /// All that is told of it.
    pub fn special(&self) -> Special {
        let [driving, stiffness, squared] = self.budgets();
        let omega = self.frequency_squared().value.sqrt();
        let period = TAU / omega.to_f64();
        // d ln T = -d omega^2/(2 omega^2)
        let relative = 0.5 * squared / (omega * omega).to_f64();
        let period = Uncertain::new(period, period * (relative + 2.0 * f64::EPSILON));
        let rates = self.point.rate_of_each(&self.share);
        let l_1 = first_lyapunov(self.curve.law(), &rates, self.stiffness, omega);
        /// The law's parameters are rounded: of a coefficient that is a smaller part of its terms the sign is not known.
        const KNOWN: f64 = 100.0 * f64::EPSILON;
        let criticality = match l_1.value {
            x if x.abs() <= KNOWN * l_1.scale => Criticality::Undecided,
            x if x < 0.0 => Criticality::Supercritical,
            _ => Criticality::Subcritical,
        };
        let value = self.point.driving(&self.share).value.to_f64();
        Special {
            period: period.value.is_finite().then_some(period),
            criticality: Some(criticality),
            coefficient: l_1.value.is_finite().then_some(l_1.value),
            ..Special::new(
                Label::Hb,
                Uncertain::new(value, driving),
                Uncertain::new(self.stiffness.to_f64(), stiffness),
            )
        }
    }
}
