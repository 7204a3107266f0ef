//! All steady states of two interfaces that differ, and none overlooked.
//!
//! Interface 1 slides at V and interface 2 at V_H - V where tau_1ss(V) = tau_2ss(V_H - V). No symmetry helps: (0, V_H) is cut in two, and in each
//! part the slower rate s is the unknown, which V_H - s does not rob of digits. Branch and bound in interval arithmetic leaves
//! pieces in which the difference of the stresses has certainly no zero, or is certainly monotonic, and its signs at the ends decide.
//! Where that can't be told, as within rounding of a fold, it is said.
//!
//! Neumaier, A. (1990). Interval Methods for Systems of Equations, chapter 5. Cambridge University Press.

use super::refine::newton;
use super::{Equilibrium, OF_31_DIGITS, SteadyStates, Symmetry};
use crate::error::Result;
use crate::friction::{
    Law, ScaledLaw, UnequalLaws, positive, rounding, steady_log_slope, steady_slope, steady_stress,
};
use crate::number::{DoubleDouble, Interval, Jet, Real, bracketed_root, log_ratio};

/// Pieces that are looked at, at most, in each part.
const MOST: usize = 20_000;
/// Where a piece is cut, in parts of its width in ln s: at the first of these at which the sign is certain.
const CUTS: [f64; 5] = [0.4871, 0.313, 0.687, 0.117, 0.883];
/// Where (0, V_H) is cut, in parts of it, likewise.
const MIDDLES: [f64; 4] = [0.5, 0.5371, 0.6119, 0.7313];

/// All steady states of two interfaces that differ at V_H, for every stiffness, by stress descending. The slip rates of each are in the
/// order of the interfaces.
///
/// ```
/// use twinslip::equilibrium::unequal_steady_states;
/// use twinslip::friction::{InterfaceConstants, UnequalLaws};
/// let first = InterfaceConstants::heslot_1994();
/// let second = InterfaceConstants { slip_length: 1.05, ..first };
/// let laws = UnequalLaws::new("spinodal", [first, second], 0.0)?;
/// let found = unequal_steady_states(&laws, 10.0)?;
/// assert!(found.complete);
/// assert_eq!(found.equilibria.len(), 3);
/// # Ok::<(), twinslip::Error>(())
/// ```
///
/// # Errors
/// [`crate::Error::Parameter`] unless V_H is positive and finite; [`crate::Error::NotConverged`] if a search fails, which a certain bracket
/// excludes.
pub fn unequal_steady_states(laws: &UnequalLaws, driving: f64) -> Result<SteadyStates> {
    positive("driving", driving)?;
    let mut found = SteadyStates {
        equilibria: Vec::new(),
        complete: true,
    };
    let parts = [0, 1].map(|slower| Part {
        laws,
        driving,
        slower,
    });
    let middle = MIDDLES.into_iter().flat_map(|part| {
        // One of them is exactly V_H less the other.
        let more = part * driving;
        [[more, driving - more], [driving - more, more]]
    });
    let ends = { middle }.find(|ends| parts[0].sign(ends[0]).is_some());
    found.complete = ends.is_some();
    let ends = ends.unwrap_or([0.5 * driving; 2]);
    for (part, end) in parts.into_iter().zip(ends) {
        let (brackets, certain) = part.brackets(end);
        found.complete &= certain;
        for bracket in brackets {
            let state = part.state(bracket)?;
            found.complete &= state.radius.is_finite();
            found.add(state, laws, driving);
        }
    }
    Ok(found.sorted())
}

/// The part of (0, V_H) in which one interface is the slower one.
#[derive(Clone, Copy)]
struct Part<'a> {
    laws: &'a UnequalLaws,
    driving: f64,
    slower: usize,
}

impl<'a> Part<'a> {
    fn slow(&self) -> &'a ScaledLaw {
        &self.laws.laws()[self.slower]
    }

    fn fast(&self) -> &'a ScaledLaw {
        &self.laws.laws()[1 - self.slower]
    }

    /// The steady stress of the slower interface less that of the faster one.
    fn difference<T: Real>(&self, s: T) -> T {
        steady_stress(self.slow(), s) - steady_stress(self.fast(), T::constant(self.driving) - s)
    }

    /// Its derivative in s.
    fn slope<T: Real>(&self, s: T) -> T {
        steady_slope(self.slow(), s) + steady_slope(self.fast(), T::constant(self.driving) - s)
    }

    /// The difference at a rate within bounds: in 31 digits where 16 do not tell its sign.
    fn bounds(&self, s: f64) -> Interval {
        let bounds = self.difference(Interval::constant(s));
        if bounds.sign().is_some() {
            return bounds;
        }
        let value = self.difference(DoubleDouble::from(s)).to_f64();
        let ordinary = (1e-200..1e200).contains(&s) && (1e-200..1e200).contains(&self.driving);
        if !(ordinary && value.is_finite()) {
            return bounds;
        }
        let lost = OF_31_DIGITS * bounds.distance_from(value);
        Interval::around(value, lost + f64::EPSILON * value.abs())
    }

    /// Its certain sign.
    fn sign(&self, s: f64) -> Option<f64> {
        self.bounds(s).sign()
    }

    /// The slope over a range: as it is, or to second order from the middle, whichever tells more.
    fn slope_within(&self, within: Interval, middle: f64) -> Interval {
        let along = self.slope(Jet::<Interval, 1>::variable(within, 0));
        let from_middle =
            self.slope(Interval::constant(middle)) + along.gradient[0] * (within - middle);
        let both = (
            along.value.lo().max(from_middle.lo()),
            along.value.hi().min(from_middle.hi()),
        );
        Interval::new(both.0, both.1)
    }

    /// A rate up to which there is no state: the slower interface's stress rises or falls monotonically from rest on. `None` where no
    /// double is so small.
    fn below_all(&self) -> Option<f64> {
        let first = self.slow().steady_extrema().into_iter().next();
        let mut s = 0.5 * first.map_or(self.driving, |first| first.min(self.driving));
        while s > f64::MIN_POSITIVE {
            let here = Interval::constant(s);
            let fastest = Interval::new((self.driving - s).next_down(), self.driving);
            let apart = steady_stress(self.slow(), here) - steady_stress(self.fast(), fastest);
            let sense = steady_log_slope(self.slow(), here).sign();
            match (apart.sign(), sense) {
                (Some(apart), Some(sense)) if apart == -sense => return Some(s),
                (Some(_), None) => return Some(s),
                _ => s *= 0.125,
            }
        }
        None
    }

    /// A bracket of the slower rate for each state up to this one, at which the sign is certain; and whether their number is.
    fn brackets(&self, end: f64) -> (Vec<[f64; 2]>, bool) {
        let (mut found, mut certain) = (Vec::new(), true);
        let low = self.below_all().unwrap_or_else(|| {
            certain = false;
            f64::MIN_POSITIVE
        });
        let mut open = vec![[low, end]];
        let mut looked = 0;
        while let Some([a, b]) = open.pop() {
            if a >= b {
                continue;
            }
            looked += 1;
            if looked > MOST {
                return (found, false);
            }
            let within = Interval::new(a, b);
            let width = log_ratio(a, b);
            let at = |part: f64| (a.ln() + part * width).exp();
            let middle = at(0.5);
            let slope = self.slope_within(within, middle);
            let by_slope = self.bounds(middle) + slope * (within - middle);
            if by_slope.sign().is_some() || self.difference(within).sign().is_some() {
                continue;
            }
            if slope.sign().is_some() {
                match (self.sign(a), self.sign(b)) {
                    (Some(left), Some(right)) if left == right => {}
                    (Some(_), Some(_)) => found.push([a, b]),
                    _ => certain = false,
                }
                continue;
            }
            let inside = |s: &f64| *s > a && *s < b && self.sign(*s).is_some();
            match CUTS.into_iter().map(at).find(inside) {
                Some(cut) => open.extend([[a, cut], [cut, b]]),
                None => certain = false,
            }
        }
        (found, certain)
    }

    /// The state in a bracket: without bounds where it can't be enclosed, as at a fold.
    fn state(&self, [low, high]: [f64; 2]) -> Result<Equilibrium> {
        let [left, right] = [low, high].map(|end| self.sign(end));
        let slow = bracketed_root("the steady state", low, high, |s| {
            // of the ends the signs are known, which rounding may hide
            let known = if s == low {
                left
            } else if s == high {
                right
            } else {
                None
            };
            match known {
                Some(sign) => (sign, f64::NAN),
                None => (self.difference(s), self.slope(s)),
            }
        })?;
        let near = DoubleDouble::from(slow);
        let precise = newton(near, self.driving, |s: Jet<DoubleDouble, 1>| {
            self.difference(s)
        });
        let slow = if precise.is_finite() { precise } else { near };
        let radius = self.radius(slow.to_f64());
        // Of the other rate, with the rounding of V_H.
        let fast = DoubleDouble::from(self.driving) - slow;
        let mut rates = [(slow, radius), (fast, radius + self.driving * f64::EPSILON)];
        if self.slower == 1 {
            rates.reverse();
        }
        Ok(Equilibrium::at(
            self.laws,
            self.driving,
            Symmetry::Asymmetric,
            &rates,
        ))
    }

    /// The smallest radius (by powers of two) about the slower rate within which the difference changes its sign for certain, whatever the
    /// rounding of V_H and of the constants; infinite if there is none.
    fn radius(&self, slow: f64) -> f64 {
        let unknown = self.of_inputs(slow);
        let sign = |s: f64| {
            let difference = self.difference(DoubleDouble::from(s)).to_f64();
            (difference.abs() > unknown).then(|| difference.signum())
        };
        let mut radius = slow * f64::EPSILON;
        while radius < slow.min(self.driving - slow) {
            if let (Some(left), Some(right)) = (sign(slow - radius), sign(slow + radius))
                && left != right
            {
                return radius;
            }
            radius *= 2.0;
        }
        f64::INFINITY
    }

    /// How far the difference may be off by the rounding of V_H and of the constants.
    fn of_inputs(&self, slow: f64) -> f64 {
        /// Of V_H, relative, to see its effect.
        const CHANGE: f64 = 1e-6;
        let faster = Part {
            driving: self.driving * (1.0 + CHANGE),
            ..*self
        };
        let moved = (faster.difference(slow) - self.difference(slow)).abs();
        let of_laws = |laws: &UnequalLaws| Part { laws, ..*self }.difference(slow);
        moved * f64::EPSILON / CHANGE + rounding(self.laws, |laws| Some(of_laws(laws)))
    }
}
