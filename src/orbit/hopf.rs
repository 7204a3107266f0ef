//! Hopf points of a slab along V_H, and the small orbits beside them.

use super::family::ParametrisedField;
use super::interface_system::InterfaceSystem;
use super::settle::axis;
use super::small_orbits::SmallOrbits;
use crate::equilibrium::{Equilibrium, Solver, Symmetry, eigenvalues, steady_states};
use crate::error::Result;
use crate::field::Vector;
use crate::model::{Loading, Parameter};
use nalgebra::Complex;

type C = Complex<f64>;

/// A Hopf point.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct HopfPoint {
    /// V_H.
    pub driving: f64,
    /// K.
    pub stiffness: f64,
    /// The equilibrium there.
    pub equilibrium: Equilibrium,
    /// The imaginary part of the pair that crosses.
    pub frequency: f64,
}

/// Between which values of a parameter Hopf points are looked for, and how many are tried.
const DRIVINGS: (f64, f64) = (1e-4, 1e7);
const STIFFNESSES: (f64, f64) = (1e-6, 1e3);
const TRIED: usize = 400;
/// Bisections of an interval: to the last digits of the logarithm.
const BISECTIONS: usize = 60;

/// The equilibrium of a symmetry, which does not depend on K. Of several asymmetric ones that of the largest stress.
fn equilibrium(slab: &InterfaceSystem, symmetry: Symmetry) -> Result<Option<Equilibrium>> {
    let InterfaceSystem {
        law, interfaces, ..
    } = slab;
    let driving = slab.loading.driving;
    Ok(match symmetry {
        // The others take most of the time.
        Symmetry::Symmetric => Some(Equilibrium::symmetric(law, driving, *interfaces)),
        Symmetry::Asymmetric => {
            let states = steady_states(law, driving, *interfaces, Solver::Newton)?;
            let mut all = states.equilibria.into_iter();
            all.find(|e| e.symmetry == symmetry)
        }
    })
}

/// The product of the sums of all pairs of eigenvalues: it changes its sign at Hopf points also where the pair is soon real
/// again, as it is at small stiffness; and at neutral saddles.
fn sums(eigenvalues: &[C]) -> f64 {
    let mut product = C::from(1.0);
    for (i, a) in eigenvalues.iter().enumerate() {
        for b in &eigenvalues[i + 1..] {
            product *= a + b;
        }
    }
    product.re
}

/// The frequency of the pair on the imaginary axis, if there is one.
fn frequency(eigenvalues: &[C]) -> Option<f64> {
    /// What is left of the real part, over the imaginary one.
    const AXIS: f64 = 1e-5;
    let pair = eigenvalues.iter().find(|z| z.im > 0.0)?;
    (pair.re.abs() < AXIS * pair.im).then_some(pair.im)
}

/// All Hopf points of equilibria of this symmetry along a parameter, the other one that of the slab; the nearest to the slab's
/// own first.
///
/// # Errors
/// Those of [`steady_states`] and [`eigenvalues`].
pub fn hopf_points(
    slab: &InterfaceSystem,
    symmetry: Symmetry,
    along: Parameter,
) -> Result<Vec<HopfPoint>> {
    EquilibriaAlong::new(slab, symmetry, along)?.hopf_points(slab)
}

/// The equilibria of a symmetry along a parameter: along V_H, the same for all K.
pub(crate) struct EquilibriaAlong {
    symmetry: Symmetry,
    along: Parameter,
    /// By the logarithm of the parameter. Where there is none beside one that there is, as near to it as can be.
    known: Vec<(f64, Option<Equilibrium>)>,
}

impl EquilibriaAlong {
    /// # Errors
    /// Those of [`steady_states`].
    pub fn new(slab: &InterfaceSystem, symmetry: Symmetry, along: Parameter) -> Result<Self> {
        let (from, to) = match along {
            Parameter::Driving => DRIVINGS,
            Parameter::Stiffness => STIFFNESSES,
        };
        let (from, to) = (from.ln(), to.ln());
        let grid = (0..=TRIED).map(|i| from + (to - from) * i as f64 / TRIED as f64);
        let mut equilibria = EquilibriaAlong {
            symmetry,
            along,
            known: Vec::new(),
        };
        if along == Parameter::Stiffness {
            let one = equilibrium(slab, symmetry)?;
            equilibria.known = grid.map(|log| (log, one.clone())).collect();
            return Ok(equilibria);
        }
        let at = |log: f64| equilibrium(&slab.driven_at(log.exp()), symmetry);
        for log in grid {
            let here = (log, at(log)?);
            // An equilibrium may have its Hopf point soon after it appears.
            if let Some(last) = equilibria.known.last()
                && last.1.is_some() != here.1.is_some()
            {
                let appears = here.1.is_some();
                let (mut none, mut some) = if appears {
                    (last.0, here.clone())
                } else {
                    (here.0, last.clone())
                };
                for _ in 0..BISECTIONS {
                    let middle = 0.5 * (none + some.0);
                    match at(middle)? {
                        None => none = middle,
                        known => some = (middle, known),
                    }
                }
                equilibria.known.push(some);
            }
            equilibria.known.push(here);
        }
        Ok(equilibria)
    }

    /// All Hopf points of a slab whose equilibria these are, the nearest to its own parameter first.
    ///
    /// # Errors
    /// Those of [`steady_states`] and [`eigenvalues`].
    pub fn hopf_points(&self, slab: &InterfaceSystem) -> Result<Vec<HopfPoint>> {
        let there = |log: f64| match self.along {
            Parameter::Driving => slab.driven_at(log.exp()),
            Parameter::Stiffness => slab.of_stiffness(log.exp()),
        };
        let spectrum = |log: f64, equilibrium: &Equilibrium| {
            eigenvalues(&slab.law, equilibrium, there(log).loading.stiffness)
        };
        let sums_at = |log: f64, equilibrium: &Option<Equilibrium>| -> Result<Option<f64>> {
            let of = |equilibrium| Ok(sums(&spectrum(log, equilibrium)?));
            equilibrium.as_ref().map(of).transpose()
        };
        let tried = self.known.iter();
        let tried = tried.map(|(log, equilibrium)| Ok((*log, sums_at(*log, equilibrium)?)));
        let tried: Vec<_> = tried.collect::<Result<_>>()?;
        let mut points = Vec::new();
        for pair in tried.windows(2) {
            let [(left, Some(before)), (right, Some(after))] = [pair[0], pair[1]] else {
                continue;
            };
            if before * after >= 0.0 {
                continue;
            }
            let log = zero([(left, before), (right, after)], &|log| {
                sums_at(log, &equilibrium(&there(log), self.symmetry)?)
            })?;
            if let Some(equilibrium) = equilibrium(&there(log), self.symmetry)?
                && let Some(frequency) = frequency(&spectrum(log, &equilibrium)?)
            {
                let Loading { driving, stiffness } = there(log).loading;
                let point = HopfPoint {
                    driving,
                    stiffness,
                    equilibrium,
                    frequency,
                };
                points.push((log, point));
            }
        }
        let own = match self.along {
            Parameter::Driving => slab.loading.driving,
            Parameter::Stiffness => slab.loading.stiffness,
        };
        let far = |log: f64| (log - own.ln()).abs();
        points.sort_by(|a, b| far(a.0).total_cmp(&far(b.0)));
        Ok(points.into_iter().map(|(_, point)| point).collect())
    }
}

/// A zero between two places with values of different signs, to the last digits: by the false position, of whose values that of an end
/// which stays twice is halved (the Illinois method: Dowell and Jarratt 1971, BIT 11, 168-174). A place without a value is beyond it.
fn zero(
    [(mut left, mut before), (mut right, mut after)]: [(f64, f64); 2],
    value: &dyn Fn(f64) -> Result<Option<f64>>,
) -> Result<f64> {
    /// In the logarithm: some units in the last place.
    const APART: f64 = 1e-15;
    // Which end came last: 1 the left, -1 the right one.
    let mut last = 0;
    for _ in 0..BISECTIONS {
        let far = (right - left).abs();
        if far <= APART * (1.0 + left.abs()) {
            break;
        }
        let guess = (left * after - right * before) / (after - before);
        let inside = guess > left && guess < right;
        let middle = if inside { guess } else { 0.5 * (left + right) };
        match value(middle)? {
            Some(0.0) => return Ok(middle),
            Some(here) if here * before > 0.0 => {
                (left, before) = (middle, here);
                after *= if last == 1 { 0.5 } else { 1.0 };
                last = 1;
            }
            Some(here) => {
                (right, after) = (middle, here);
                before *= if last == -1 { 0.5 } else { 1.0 };
                last = -1;
            }
            None => right = middle,
        }
    }
    Ok(0.5 * (left + right))
}

impl HopfPoint {
    /// The coordinates (ln V_H, ln K).
    pub fn at(&self) -> [f64; 2] {
        [self.driving.ln(), self.stiffness.ln()]
    }

    /// The small orbits beside it, of a system in (tau, ln psi) or (tau, ln psi_1, ln psi_2).
    pub fn small_orbits(&self, family: &dyn ParametrisedField) -> SmallOrbits {
        let dimension = family.dimension();
        let state = Vector::from_fn(dimension, |i, _| match i {
            0 => self.equilibrium.stress.value,
            i => self.equilibrium.log_state[i - 1],
        });
        let mut along = axis(dimension, 0);
        if dimension == 3 {
            // With the third eigenvalue l the vectors (J - l) v are of the pair's plane, and its own trace is zero.
            let jacobian = family.field(self.at()).jacobian(&state);
            along = &jacobian * &along - &along * jacobian.trace();
        }
        SmallOrbits {
            state,
            at: self.at(),
            frequency: self.frequency,
            along,
        }
    }
}
