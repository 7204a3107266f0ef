//! Hopf points of equilibria, in 31 digits and with error budgets.
//!
//! A pair of eigenvalues is on the imaginary axis where the last but one Hurwitz determinant vanishes: of one interface, and of those that
//! all slide alike, at the stiffness (16) or (29), of two at (34). What the rounding of the law's parameters, and of K or V_H, does to such a
//! point follows from the derivatives.

use super::lyapunov::{FirstLyapunov, first_lyapunov};
use crate::bifurcation::{Criticality, Label, Parameter, Special, Symmetry};
use crate::equilibrium::{
    Along, Bracket, EquilibriumCurve, Share, SteadyCurve, SteadyPoint, constant, share_states,
};
use crate::error::Result;
use crate::friction::{AnyLaw, effects};
use crate::number::{DoubleDouble, Jet, Real, Uncertain};
use crate::orbit::HopfPoint;
use std::cell::OnceCell;
use std::f64::consts::TAU;

/// A Hopf point near one that is roughly known, as [`branch`](super::branch()) tells of it. `None` where it is not decided that there is
/// one.
pub(in crate::bifurcation) fn hopf(
    law: &AnyLaw,
    along: Parameter,
    near: &HopfPoint,
) -> Option<Special> {
    /// In ln V_H and ln K: that it is this one.
    const CLOSE: f64 = 1e-6;
    let (driving, stiffness) = (near.driving, near.stiffness);
    let interfaces = near.equilibrium.slip_rate.len();
    let mut states = Vec::new();
    share_states(law, driving, interfaces, |one| {
        states.push(one);
    })
    .ok()?;
    states.retain(|one| one.state.symmetry == near.equilibrium.symmetry);
    let slowest = near.equilibrium.slip_rate[0];
    let state = states.into_iter().min_by(|a, b| {
        let [a, b] = [a, b].map(|one| (one.state.slip_rate[0] - slowest).abs());
        a.total_cmp(&b)
    })?;
    let curve = match state.state.symmetry {
        Symmetry::Symmetric => EquilibriumCurve::Alike(law),
        Symmetry::Asymmetric => EquilibriumCurve::Shares(SteadyCurve::new(law, 4.0 * driving)?),
    };
    let found = match along {
        Parameter::Driving => {
            let x = state.rate.to_f64();
            let bracket = straddling(x, |x| {
                let point = curve.point(DoubleDouble::from(x));
                point
                    .oscillation(&state.share)
                    .relative_determinant(stiffness)
            })?;
            ShareHopf::at_stiffness(&curve, &state.share, stiffness, bracket).ok()??
        }
        Parameter::Stiffness => {
            let point = curve.point(state.rate);
            let all = point.oscillation(&state.share).stiffnesses();
            let far = |k: &DoubleDouble| (k.to_f64() / stiffness).ln().abs();
            let nearest = all.into_iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
            ShareHopf::new(curve, state.share, point, nearest, along)
        }
    };
    let same = |(a, b): (f64, f64)| (a / b).ln().abs() < CLOSE;
    let [v, k] = found.place();
    (same((v, driving)) && same((k, stiffness))).then(|| found.special())
}

/// Two values around x > 0, as close as may be, at which g has opposite signs, and the sign at the first.
fn straddling(x: f64, g: impl Fn(f64) -> f64) -> Option<Bracket> {
    let mut part = 1e-14;
    while part < 1e-2 {
        let (low, high) = (x * (1.0 - part), x * (1.0 + part));
        let signs = [low, high].map(|x| g(x).signum());
        if signs[0] * signs[1] < 0.0 {
            return Some((low, high, signs[0]));
        }
        part *= 4.0;
    }
    None
}

/// A Hopf point of a share: which of V_H and K is exact, and where.
#[derive(Debug, Clone)]
pub(super) struct ShareHopf<'a> {
    pub curve: EquilibriumCurve<'a>,
    pub share: Share,
    pub point: SteadyPoint<'a>,
    pub stiffness: DoubleDouble,
    /// The parameter that varies along the path to it; the other one is exact.
    pub along: Parameter,
    /// How far the rate that is the coordinate may be off along the curve of Hopf points, where a condition on these sets it.
    pub off: f64,
    l_1: OnceCell<FirstLyapunov>,
}

/// V_H, the determinant and omega^2 as they change in some way.
type Changes = [f64; 3];

impl<'a> ShareHopf<'a> {
    /// At a point of a share with this stiffness, at which a pair of eigenvalues is on the imaginary axis.
    pub fn new(
        curve: EquilibriumCurve<'a>,
        share: Share,
        point: SteadyPoint<'a>,
        stiffness: DoubleDouble,
        along: Parameter,
    ) -> Self {
        ShareHopf {
            curve,
            share,
            point,
            stiffness,
            along,
            off: 0.0,
            l_1: OnceCell::new(),
        }
    }

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
        let found = ShareHopf::new(*curve, *share, point, k, Parameter::Driving);
        let oscillates = found.frequency_squared().value.to_f64() > 0.0;
        Ok(oscillates.then_some(found))
    }

    /// V_H and K.
    pub fn place(&self) -> [f64; 2] {
        let driving = self.point.driving(&self.share).value;
        [driving, self.stiffness].map(DoubleDouble::to_f64)
    }

    /// dK/dx along the curve of Hopf points.
    pub fn slope(&self) -> DoubleDouble {
        self.point.oscillation(&self.share).slope(self.stiffness)
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
        let point = curve.point(self.point.x);
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

    /// Error bounds of V_H, K and omega^2.
    fn budgets(&self) -> [f64; 3] {
        let mut all = effects(self.curve.law(), |law| {
            let curve = self.curve.of(law);
            curve.map_or([f64::NAN; 3], |curve| self.values(&curve))
        });
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
        if self.off > 0.0 {
            // along the curve h stays zero
            let slope = -by_x[1] / by_k[1];
            let along = [by_x[0], slope, by_x[2] + by_k[2] * slope];
            for (sum, change) in sums.iter_mut().zip(along) {
                *sum += change.abs() * self.off;
            }
        }
        sums
    }

    /// l_1 here.
    pub fn lyapunov(&self) -> FirstLyapunov {
        *self.l_1.get_or_init(|| {
            let omega = self.frequency_squared().value.sqrt();
            let rates = self.point.rate_of_each(&self.share);
            first_lyapunov(self.curve.law(), &rates, self.stiffness, omega)
        })
    }

    /// All that is told of it.
    pub fn special(&self) -> Special {
        let [driving, stiffness, squared] = self.budgets();
        let omega = self.frequency_squared().value.sqrt();
        let period = TAU / omega.to_f64();
        // d ln T = -d omega^2/(2 omega^2)
        let relative = 0.5 * squared / (omega * omega).to_f64();
        // what may be off by more than itself is not known
        let period = (relative < 1.0)
            .then(|| Uncertain::new(period, period * (relative + 2.0 * f64::EPSILON)));
        let l_1 = self.lyapunov();
        let criticality = match l_1.sign() {
            None => Criticality::Undecided,
            Some(sign) if sign < 0.0 => Criticality::Supercritical,
            Some(_) => Criticality::Subcritical,
        };
        let value = self.point.driving(&self.share).value.to_f64();
        Special {
            period: period.filter(|period| period.value.is_finite()),
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
