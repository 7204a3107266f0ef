//! Zeros of the user's functions along branches of equal interfaces: of the rate along V_H, and of K where the states stay.

use super::course::{Course, Station, exact_stiffness};
use crate::bifurcation::{BranchRequest, Label, Special, UserFunction};
use crate::equilibrium::{Equilibrium, EquilibriumCurve, Share, SteadyPoint};
use crate::error::Result;
use crate::friction::{AnyLaw, rounding};
use crate::model::Loading;
use crate::number::{DoubleDouble, Uncertain, bracketed_root};
use crate::orbit::Profile;

/// What is told of a state, and of V_H or K, may be off by so many units in the last place.
const UNITS: f64 = 8.0;
/// Relative distances at which both sides of a zero are looked at, the nearest first.
const ASIDE: [f64; 3] = [1e-6, 1e-4, 1e-2];
/// The relative distance of differences.
const BESIDE: f64 = 1e-6;

/// The value of a function, and how far it may be off.
fn value(function: &UserFunction, state: &Equilibrium, loading: Loading) -> (f64, f64) {
    let (stress, all) = (state.stress.value, state.state());
    let ends = |all: &[f64]| [all[0], all[all.len() - 1]];
    let profile = Profile {
        mean_stress: stress,
        stress_range: (stress, stress),
        state: ends(&all),
        slip_rate: ends(&state.slip_rate),
    };
    let of = |loading: Loading, profile: &Profile| (function.value)(loading, profile, None);
    let here = of(loading, &profile);
    let part = UNITS * f64::EPSILON;
    // Logarithms of states and rates are known to that part, and the stress as far as it says.
    let logs = |x: f64| x * (1.0 + part * (1.0 + x.ln().abs()));
    let off = part * stress.abs() + state.stress.uncertainty;
    let moved = [
        of(
            Loading {
                driving: loading.driving * (1.0 + part),
                ..loading
            },
            &profile,
        ),
        of(
            Loading {
                stiffness: loading.stiffness * (1.0 + part),
                ..loading
            },
            &profile,
        ),
        of(
            loading,
            &Profile {
                mean_stress: stress + off,
                stress_range: (stress + off, stress + off),
                ..profile
            },
        ),
        of(
            loading,
            &Profile {
                state: [logs(profile.state[0]), profile.state[1]],
                ..profile
            },
        ),
        of(
            loading,
            &Profile {
                state: [profile.state[0], logs(profile.state[1])],
                ..profile
            },
        ),
        of(
            loading,
            &Profile {
                slip_rate: [logs(profile.slip_rate[0]), profile.slip_rate[1]],
                ..profile
            },
        ),
        of(
            loading,
            &Profile {
                slip_rate: [profile.slip_rate[0], logs(profile.slip_rate[1])],
                ..profile
            },
        ),
    ];
    let each = moved.iter().map(|moved| (moved - here).abs());
    (here, each.sum::<f64>())
}

/// Whether the values on both sides of x certainly have different signs, at the nearest distance that tells.
fn changes_sign(at: &dyn Fn(f64) -> (f64, f64), x: f64) -> bool {
    for aside in ASIDE {
        let [a, b] = [-aside, aside].map(|part| at(x * (1.0 + part)));
        if a.0.abs() > a.1 && b.0.abs() > b.1 {
            return a.0 * b.0 < 0.0;
        }
    }
    false
}

/// A zero as a special point.
fn special(function: &UserFunction, driving: Uncertain, stiffness: Uncertain) -> Special {
    Special {
        note: Some(function.note()),
        ..Special::new(Label::Uf, driving, stiffness)
    }
}

impl<'a> Course<'a> {
    /// The zeros along a share within a range of V_H.
    ///
    /// # Errors
    /// [`crate::Error::NotConverged`] if a search fails.
    pub fn user_zeros(
        &self,
        share: &Share,
        (low, high): (f64, f64),
        request: &BranchRequest,
    ) -> Result<Vec<Station<'a>>> {
        let stiffness = request.slab.loading.stiffness;
        let at =
            |curve: &EquilibriumCurve<'_>, function: &UserFunction, point: &SteadyPoint<'_>| {
                let driving = point.driving(share).value.to_f64();
                let state = curve.state(share, driving, point);
                value(function, &state, Loading { driving, stiffness })
            };
        let mut found = Vec::new();
        for function in &request.watch {
            let of = |point: &SteadyPoint<'a>| at(&self.curve, function, point).0;
            let values: Vec<f64> = self.points.iter().map(of).collect();
            for (from, to, _) in self.changes(&values, of) {
                let point_at = |x: f64| self.curve.point(DoubleDouble::from(x));
                let there = |x: f64| at(&self.curve, function, &point_at(x));
                let x = bracketed_root(WHAT, from, to, |x| (there(x).0, f64::NAN))?;
                let point = point_at(x);
                let driving = point.driving(share).value.to_f64();
                if !(low..=high).contains(&driving) || !changes_sign(&there, x) {
                    continue;
                }
                let difference =
                    |of: &dyn Fn(f64) -> f64| of(x * (1.0 + BESIDE)) - of(x * (1.0 - BESIDE));
                let slope = difference(&|x| there(x).0);
                let way = difference(&|x| point_at(x).driving(share).value.to_f64());
                // What rounding makes of the law's constants moves the zero too.
                let of_law = |law: &AnyLaw| {
                    let curve = self.curve.of(law)?;
                    let point = curve.point(DoubleDouble::from(x));
                    let (value, _) = at(&curve, function, &point);
                    Some(point.driving(share).value.to_f64() - value * way / slope)
                };
                let by_law = rounding(self.curve.law(), of_law);
                let by_value = (there(x).0.abs() + there(x).1) * (way / slope).abs();
                let off = by_law + by_value + UNITS * f64::EPSILON * driving;
                let special = special(
                    function,
                    Uncertain::new(driving, off),
                    exact_stiffness(request),
                );
                found.push(Station::special(share, &point, special));
            }
        }
        Ok(found)
    }
}

/// The zeros over these values of K, which ascend or descend, with their K.
///
/// # Errors
/// [`crate::Error::NotConverged`] if a search fails.
pub(super) fn over_stiffness(
    request: &BranchRequest,
    state: &Equilibrium,
    values: &[f64],
) -> Result<Vec<(f64, Special)>> {
    let driving = request.slab.loading.driving;
    let mut found = Vec::new();
    for function in &request.watch {
        let at = |stiffness: f64| value(function, state, Loading { driving, stiffness });
        for pair in values.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|k| at(k).0);
            if !(a * b < 0.0 || b == 0.0 && a != 0.0) {
                continue;
            }
            let k = bracketed_root(WHAT, pair[0], pair[1], |k| (at(k).0, f64::NAN))?;
            if !changes_sign(&at, k) {
                continue;
            }
            let slope = (at(k * (1.0 + BESIDE)).0 - at(k * (1.0 - BESIDE)).0) / (2.0 * BESIDE * k);
            let (left, noise) = at(k);
            let off = (left.abs() + noise) / slope.abs() + UNITS * f64::EPSILON * k;
            let exact = Uncertain::new(driving, 0.0);
            found.push((k, special(function, exact, Uncertain::new(k, off))));
        }
    }
    Ok(found)
}

/// What is looked for, in messages.
const WHAT: &str = "a zero of the user's function";
