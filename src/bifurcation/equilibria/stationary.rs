//! Branch points and folds: both are properties of the steady-state friction law alone, the same at every stiffness.

use crate::bifurcation::{Criticality, Label, Special};
use crate::equilibrium::{Along, Bracket, EquilibriumCurve, Share, SteadyCurve, SteadyPoint};
use crate::error::Result;
use crate::friction::{AnyLaw, rounding, steady_stress};
use crate::number::{Jet, Real, Uncertain};

/// V_H of a share where the middle branch meets the slow or the fast one.
pub(super) fn meeting<'a>(
    curve: &EquilibriumCurve<'a>,
    share: &Share,
    branch: usize,
) -> Option<(SteadyPoint<'a>, Uncertain)> {
    let point = curve.end(branch)?;
    let driving = point.driving(share).value.to_f64();
    let radii = curve.radii_at_end(&point);
    let own = (0..3).filter(|&i| share[i] > 0);
    let own: f64 = own.map(|i| radii[i] * share[i] as f64).sum();
    let at = |law: &AnyLaw| Some(curve.of(law)?.end(branch)?.driving_near(share));
    let budget = rounding(curve.law(), at) + own + driving * f64::EPSILON;
    Some((point, Uncertain::new(driving, budget)))
}

/// tau_ss'' and tau_ss'''.
fn curvatures<T: Real>(law: &AnyLaw, v: T) -> [T; 2] {
    let v = Jet::<_, 1>::variable(Jet::<_, 1>::variable(Jet::<T, 1>::variable(v, 0), 0), 0);
    let stress = steady_stress(law, v);
    [
        stress.value.gradient[0].gradient[0],
        stress.gradient[0].gradient[0].gradient[0],
    ]
}

/// The branch point at which so many of all interfaces, which slide alike, may part.
pub(super) fn parting(
    steady: &SteadyCurve<'_>,
    branch: usize,
    [driving, stiffness]: [Uncertain; 2],
    (together, interfaces): (usize, usize),
) -> Special {
    let point = Special::new(Label::Bp, driving, stiffness);
    let pitchfork = steady.extremum(branch).filter(|_| interfaces == 2);
    let Some(extremum) = pitchfork else {
        return Special {
            note: Some(format!("a cluster of {together} interfaces may split")),
            ..point
        };
    };
    // close by, the asymmetric states have [(V_1 - V_2)/2]^2 = coefficient (V_H - 2 V_e)  (24)
    let [second, third] = curvatures(steady.law, extremum.leading());
    // the symmetric state is stable where tau_ss rises: z' = -(tau_ss' z + tau_ss''' z^3 / 6) times a positive number
    let criticality = match curvatures(steady.law, extremum)[1].sign() {
        Some(sign) if sign > 0.0 => Criticality::Supercritical,
        Some(_) => Criticality::Subcritical,
        None => Criticality::Undecided,
    };
    Special {
        criticality: Some(criticality),
        coefficient: Some(-3.0 * second / third),
        note: Some(
            "coefficient: -3 tau''/tau''' of (24); asymmetric states at larger V_H if positive"
                .into(),
        ),
        ..point
    }
}

/// A fold of a share, such as V_sn: there V_H has an extremum.
#[derive(Debug, Clone)]
pub(super) struct Fold<'a> {
    curve: EquilibriumCurve<'a>,
    share: Share,
    bracket: Bracket,
    pub point: SteadyPoint<'a>,
    pub driving: Uncertain,
}

impl<'a> Fold<'a> {
    /// The one in a bracket.
    ///
    /// # Errors
    /// [`crate::Error::NotConverged`] if the search fails.
    pub fn new(curve: EquilibriumCurve<'a>, share: &Share, bracket: Bracket) -> Result<Self> {
        let point = place(&curve, share, bracket)?;
        // V_H has an extremum: what x is off does not count
        let driving = point.driving(share).value.to_f64();
        let x = point.x;
        let at = |law: &AnyLaw| Some(curve.of(law)?.point(x).driving_near(share));
        let budget = rounding(curve.law(), at) + driving * f64::EPSILON;
        Ok(Fold {
            curve,
            share: *share,
            bracket,
            point,
            driving: Uncertain::new(driving, budget),
        })
    }

    /// The stiffness at which a second eigenvalue is zero (Bogdanov-Takens). `None` where it isn't positive.
    pub fn bogdanov_takens(&self) -> Option<Uncertain> {
        let second_zero = |point: &SteadyPoint<'_>| point.oscillation(&self.share).second_zero();
        let Along { value, gradient } = second_zero(&self.point);
        let value = value.to_f64();
        let of_inputs = rounding(self.curve.law(), |law| {
            let moved = place(&self.curve.of(law)?, &self.share, self.bracket).ok()?;
            Some(second_zero(&moved).value.to_f64())
        });
        let of_place = gradient[0].to_f64().abs() * self.point.rate() * f64::EPSILON;
        let budget = of_inputs + of_place + value * f64::EPSILON;
        (value > 0.0 && value.is_finite()).then_some(Uncertain::new(value, budget))
    }
}

/// Where V_H of a share has an extremum.
fn place<'a>(
    curve: &EquilibriumCurve<'a>,
    share: &Share,
    bracket: Bracket,
) -> Result<SteadyPoint<'a>> {
    curve.zero("a fold of a share", bracket, |point| {
        point.driving_slope(share)
    })
}
