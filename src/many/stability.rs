//! Stability of a steady state of many interfaces, in time that grows with their number.
//!
//! The eigenvalues are the zeros of F(z) = z + K (T + sum_i a_i b_i/(z - d_i)), with T the sum of dv_i/dtau, a_i = dv_i/dw_i,
//! b_i = d(dw_i/dt)/dtau and d_i = d(dw_i/dt)/dw_i, and each d_i as often as it occurs again. By the argument principle the number of those
//! that grow is (number of d_i > 0) + 1/2 - phi/pi, with phi the change of arg F(i omega) as omega goes from 0 to infinity.
//!
//! The way along the axis is certain up to rounding: F changes by no more than a bound that is computed with it, and steps are so long that
//! F stays in a disc without the origin.

use super::equilibrium::{ManyEquilibrium, rounded, rounding_of_sum};
use super::interfaces::ManyInterfaces;
use crate::equilibrium::Verdict;
use rayon::prelude::*;
use std::f64::consts::PI;

/// What is known of the stability of many interfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ManyStability {
    /// How many eigenvalues have positive real parts, each as often as it counts; `None` where that is within rounding.
    pub unstable: Option<usize>,
    /// Stable, unstable or undecided.
    pub verdict: Verdict,
}

impl From<Option<usize>> for ManyStability {
    fn from(unstable: Option<usize>) -> Self {
        ManyStability {
            unstable,
            verdict: match unstable {
                None => Verdict::Undecided,
                Some(0) => Verdict::Stable,
                Some(_) => Verdict::Unstable,
            },
        }
    }
}

/// How many motions of the interfaces grow out of a steady state.
pub fn stability_of_many(
    interfaces: &ManyInterfaces,
    equilibrium: &ManyEquilibrium,
) -> ManyStability {
    Response::new(interfaces, equilibrium).unstable().into()
}

/// What one interface adds to F.
#[derive(Debug, Clone, Copy)]
struct Pole {
    /// a b
    strength: f64,
    /// d
    at: f64,
    /// What a b may be off.
    strength_is_off: f64,
    /// What d may be off.
    at_is_off: f64,
}

/// F of a steady state.
struct Response {
    stiffness: f64,
    /// T
    by_stress: f64,
    by_stress_is_off: f64,
    poles: Vec<Pole>,
    /// What sums over the interfaces are off, relative.
    of_sum: f64,
}

/// F at a point of the axis.
#[derive(Debug, Clone, Copy)]
struct Value {
    re: f64,
    im: f64,
    /// What it may be off.
    doubt: f64,
    /// K times the sum of |a b| omega/(omega^2 + d^2): the terms of F change by no more with ln omega.
    sway: f64,
    /// K times T and the sum of |a b|/|i omega - d|, all that F differs from i omega by.
    size: f64,
}

/// Interfaces whose terms are added up together.
const PIECE: usize = 512;

impl Response {
    fn new(interfaces: &ManyInterfaces, equilibrium: &ManyEquilibrium) -> Self {
        let all = rounded(interfaces, equilibrium.stress.value, &equilibrium.log_state);
        let mut response = Response {
            stiffness: interfaces.loading.stiffness,
            by_stress: 0.0,
            by_stress_is_off: 0.0,
            poles: Vec::with_capacity(all.len()),
            of_sum: rounding_of_sum(all.len()),
        };
        for (i, one) in all.iter().enumerate() {
            let local = &one.local;
            let by_stress = local.rate_by_stress;
            // Where the state is uncertain, so are derivatives: exponentials and powers of exponents of order one.
            let rate = equilibrium.slip_rate_uncertainty[i] / equilibrium.slip_rate[i].abs();
            let state = equilibrium.log_state_uncertainty[i];
            let moved =
                rate + 4.0 * (state + equilibrium.stress.uncertainty * by_stress / local.rate);
            let part = 4.0 * (one.relative + moved);
            let strength = local.rate_by_log * local.evolution_by_stress;
            // d is the difference of two terms, of which this is one.
            let term = (strength / by_stress).abs();
            response.by_stress += by_stress;
            response.by_stress_is_off += part * by_stress.abs();
            response.poles.push(Pole {
                strength,
                at: local.evolution_by_log,
                strength_is_off: 2.0 * part * strength.abs(),
                at_is_off: part * (local.evolution_by_log.abs() + 2.0 * term),
            });
        }
        response
    }

    /// F(i omega).
    fn at(&self, omega: f64) -> Value {
        let sums = self.poles.par_chunks(PIECE).map(|poles| {
            let mut sums = [0.0; 5];
            for pole in poles {
                let square = 1.0 / (omega * omega + pole.at * pole.at);
                let distance = square.sqrt();
                let size = pole.strength.abs();
                sums[0] -= pole.strength * pole.at * square;
                sums[1] -= pole.strength * square;
                sums[2] += pole.strength_is_off * distance + size * pole.at_is_off * square;
                sums[3] += size * square;
                sums[4] += size * distance;
            }
            sums
        });
        // In the order of the interfaces: the same digits on any number of cores.
        let mut total = [0.0; 5];
        for sums in sums.collect::<Vec<_>>() {
            for (total, sum) in total.iter_mut().zip(sums) {
                *total += sum;
            }
        }
        let [re, im, doubt, square, distance] = total;
        let k = self.stiffness;
        let size = k * (self.by_stress.abs() + distance);
        Value {
            re: k * (self.by_stress + re),
            im: omega * (1.0 + k * im),
            doubt: k * (self.by_stress_is_off + doubt) + self.of_sum * (size + omega),
            sway: k * omega * square,
            size,
        }
    }

    /// How many zeros F has right of the axis, with those that its poles hide; `None` where rounding could change that.
    fn unstable(&self) -> Option<usize> {
        /// Points of the axis, at most.
        const POINTS: usize = 100_000;
        /// Part of the distance to the origin that F may move by from point to point.
        const PART: f64 = 0.9;
        if !self.poles.iter().all(|pole| pole.at.abs() > pole.at_is_off) {
            return None;
        }
        let growing = self.poles.iter().filter(|pole| pole.at > 0.0).count();
        let mut last = self.at(0.0);
        // At 0 terms change by no more than omega |a b|/d^2.
        let steepness: f64 = { self.poles.iter() }
            .map(|pole| pole.strength.abs() / (pole.at * pole.at))
            .sum();
        let mut omega = PART * last.clearance()? / (1.0 + self.stiffness * steepness);
        let mut turned = 0.0;
        for _ in 0..POINTS {
            let value = self.at(omega);
            let clearance = value.clearance()?;
            turned += value.argument_from(&last);
            if value.size + value.doubt <= PART * omega {
                // From here on F stays within a disc around i omega, up to infinity.
                let upwards = Value {
                    re: 0.0,
                    im: 1.0,
                    ..value
                };
                turned += upwards.argument_from(&value);
                let found = growing as f64 + 0.5 - turned / PI;
                let whole = found.round();
                return ((found - whole).abs() < 1e-3 && whole >= 0.0).then_some(whole as usize);
            }
            // Up to r omega the terms change by no more than r ln(r) sway <= (r - 1) r sway.
            let longer = |most: f64| {
                let change = omega + (1.0 + most) * value.sway;
                f64::min(most, PART * clearance / change)
            };
            let further = longer(1.0).max(longer(8.0));
            if further < 4.0 * f64::EPSILON {
                return None;
            }
            omega *= 1.0 + further;
            last = value;
        }
        None
    }
}

impl Value {
    /// How far F is from the origin for certain; `None` where it may be there.
    fn clearance(&self) -> Option<f64> {
        let clearance = self.re.hypot(self.im) - self.doubt;
        (clearance > 0.0 && clearance.is_finite()).then_some(clearance)
    }

    /// The angle between two values, less than half a turn.
    fn argument_from(&self, last: &Value) -> f64 {
        let cross = last.re * self.im - last.im * self.re;
        let dot = last.re * self.re + last.im * self.im;
        cross.atan2(dot)
    }
}
