//! Pitchforks and folds: both are properties of the steady-state friction law alone, the same at every stiffness.

use super::hopf::bound;
use crate::bifurcation::Criticality;
use crate::continuation::CurvePoint;
use crate::equilibrium::{Interface, routh_hurwitz};
use crate::friction::rounding;
use crate::friction::{AnyLaw, Extremum, Law, steady_slope, steady_stress};
use crate::number::{Interval, Jet, Real, Uncertain, bracketed_root, enclosing_radius};

/// A pitchfork V_H = 2 V_e, V_e an extremum of tau_ss  (23).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PitchforkPoint {
    pub driving: Uncertain,
    /// -3 tau_ss'' / tau_ss''': close by, the asymmetric states have [(V_1 - V_2)/2]^2 = this (V_H - 2 V_e)  (24)
    pub coefficient: f64,
    pub criticality: Criticality,
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

/// All pitchforks, by V_H ascending.
pub(super) fn pitchforks(law: &AnyLaw) -> Vec<PitchforkPoint> {
    Extremum::all(law)
        .into_iter()
        .enumerate()
        .map(|(i, Extremum { slip_rate, .. })| {
            let of_inputs = rounding(law, |law| law.steady_extrema().get(i).copied());
            let [second, third] = curvatures(law, slip_rate.value);
            let around = Interval::around(slip_rate.value, slip_rate.uncertainty);
            // the symmetric state is stable where tau_ss rises: z' = -(tau_ss' z + tau_ss''' z^3 / 6) times a positive number
            let criticality = match curvatures(law, around)[1].sign() {
                Some(sign) if sign > 0.0 => Criticality::Supercritical,
                Some(_) => Criticality::Subcritical,
                None => Criticality::Undecided,
            };
            PitchforkPoint {
                driving: Uncertain::new(
                    2.0 * slip_rate.value,
                    2.0 * (slip_rate.uncertainty + of_inputs),
                ),
                coefficient: -3.0 * second / third,
                criticality,
            }
        })
        .collect()
}

/// A fold of the asymmetric states, such as V_sn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fold {
    pub driving: Uncertain,
    pub rates: [f64; 2],
    /// Which of the rates is the one nearer to its extremum.
    unknown: usize,
}

/// Changes its sign at a fold of the asymmetric states and, as it is even in z, not at a pitchfork. Nothing but rounding so
/// close to one that it is not told.
pub(super) fn fold_test(point: &CurvePoint) -> f64 {
    const CLOSE: f64 = 1e-6;
    let z = point.u[0];
    if z.abs() < CLOSE {
        f64::NAN
    } else {
        point.lambda_slope() / z
    }
}

/// The rate near `guess` with the same stress as `rate`, and how far off it may be.
fn counterpart(law: &AnyLaw, rate: f64, guess: f64) -> (f64, f64) {
    let stress = steady_stress(law, rate);
    let mut v = guess;
    for _ in 0..4 {
        let here = steady_stress(law, Jet::<f64, 1>::variable(v, 0));
        v -= (here.value - stress) / here.gradient[0];
    }
    let exact = steady_stress(law, Interval::constant(rate));
    (v, enclosing_radius(v, |x| steady_stress(law, x) - exact))
}

/// The fold near these rates: where tau_ss'(V_1) + tau_ss'(V_2) = 0 and the stresses are equal. None if dV_H along the states does
/// not certainly change its sign there.
///
/// Of the two rates that nearer to its extremum of tau_ss is the unknown; the other one follows from it and is well determined.
pub(super) fn fold(law: &AnyLaw, near: [f64; 2]) -> Option<Fold> {
    let mut found = of_law(law, near)?;
    found.driving.uncertainty += rounding(law, |law| Some(of_law(law, near)?.driving.value));
    Some(found)
}

fn of_law(law: &AnyLaw, near: [f64; 2]) -> Option<Fold> {
    let steepness = near.map(|v| (steady_slope(law, v) * v).abs());
    let unknown = usize::from(steepness[1] < steepness[0]);
    let (p, d) = (near[unknown], near[1 - unknown]);
    // 1 + d(d)/dp, that is dV_H/dp, and its slope
    let condition = |p: f64| {
        let (d, _) = counterpart(law, p, d);
        let [at_p, at_d] = [p, d].map(|v| steady_slope(law, Jet::<f64, 1>::variable(v, 0)));
        let ratio = at_p.value / at_d.value;
        let slope = (at_p.gradient[0] - ratio * ratio * at_d.gradient[0]) / at_d.value;
        (1.0 + ratio, slope)
    };
    let (low, high) = around(p, |p| condition(p).0)?;
    let p = bracketed_root("a fold of equilibria", low, high, condition).ok()?;
    let certain = |x: Interval| {
        let (d, radius) = counterpart(law, x.leading(), d);
        steady_slope(law, x) / steady_slope(law, Interval::around(d, radius)) + 1.0
    };
    let radius = enclosing_radius(p, certain);
    if !radius.is_finite() {
        return None;
    }
    let (d, d_radius) = counterpart(law, p, d);
    // V_H = p + d(p); within the radius its slope is next to nothing
    let p_range = Interval::around(p, radius);
    let d_range = Interval::around(d, d_radius + 2.0 * radius);
    let slope = (steady_slope(law, p_range) / steady_slope(law, d_range) + 1.0).abs();
    let bounds = Interval::constant(p) + Interval::around(d, d_radius);
    let uncertainty = bound(p + d, bounds) + (slope * radius).hi();
    let rates = if unknown == 0 { [p, d] } else { [d, p] };
    Some(Fold {
        driving: Uncertain::new(
            p + d,
            if uncertainty.is_finite() {
                uncertainty
            } else {
                f64::INFINITY
            },
        ),
        rates,
        unknown,
    })
}

impl Fold {
    /// The stiffness at which a second eigenvalue is zero (Bogdanov-Takens): c_1 = 0 beside c_0 = 0. None where it isn't positive.
    pub fn bogdanov_takens(&self, law: &AnyLaw) -> Option<Uncertain> {
        let value = self.second_zero(law, self.rates);
        let reach = self.driving.uncertainty / self.driving.value;
        let bounds = self.second_zero(law, self.rates.map(|v| Interval::around(v, v * reach)));
        let of_inputs = rounding(law, |law| {
            let fold = of_law(law, self.rates)?;
            Some(fold.second_zero(law, fold.rates))
        });
        let within = Uncertain::new(value, bound(value, bounds) + of_inputs);
        (value > 0.0 && value.is_finite()).then_some(within)
    }

    /// K where c_1 of (30), which is linear in K, is zero.
    fn second_zero<T: Real>(&self, law: &AnyLaw, rates: [T; 2]) -> T {
        let mut pair = rates.map(|v| Interface::at(law, v));
        // tau_ss' next to its zero has few digits, but at a fold it is that of the other rate
        let (p, d) = (self.unknown, 1 - self.unknown);
        pair[p].s = pair[p].g_psi * pair[p].compliance * steady_slope(law, rates[d]);
        let [at_0, at_1] = [0.0, 1.0].map(|k| routh_hurwitz(&pair[0], &pair[1], T::constant(k))[1]);
        -at_0 / (at_1 - at_0)
    }
}

/// Two values next to p at which g has opposite signs.
fn around(p: f64, g: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
    let mut part = 1e-12;
    while part < 0.1 {
        let (low, high) = (p * (1.0 - part), p * (1.0 + part));
        if g(low) * g(high) < 0.0 {
            return Some((low, high));
        }
        part *= 4.0;
    }
    None
}
