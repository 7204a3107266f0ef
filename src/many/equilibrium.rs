//! A state in which many interfaces slide at constant rates, near a start.
//!
//! Newton's method finds one state, in time that grows with the number of interfaces. There may be very many others: of N interfaces on
//! three branches up to 3^N.

use super::constants::{LANES, of};
use super::field::{Arrow, ManyField, Slips};
use super::interfaces::ManyInterfaces;
use super::local::{Local, Stress};
use super::newton;
use crate::equilibrium::Solver;
use crate::error::{Error, Result};
use crate::number::Uncertain;
use rayon::prelude::*;

/// A steady state of many interfaces: all slide at constant rates, which add up to V_H.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ManyEquilibrium {
    /// tau
    pub stress: Uncertain,
    /// ln psi of each interface.
    pub log_state: Vec<f64>,
    /// What these may be off.
    pub log_state_uncertainty: Vec<f64>,
    /// v of each.
    pub slip_rate: Vec<f64>,
    /// What these may be off.
    pub slip_rate_uncertainty: Vec<f64>,
    /// The largest of d(ln psi)/dt over V_H/N and of what the slip rates miss of V_H, over V_H.
    pub residual: f64,
    /// Iterations of the solver.
    pub iterations: usize,
}

/// The steady state that Newton's method comes to from (tau, psi of each): one of possibly many.
///
/// ```
/// use twinslip::equilibrium::Solver;
/// use twinslip::friction::{AnyLaw, Parameters};
/// use twinslip::many::{ManyInterfaces, equilibrium_of_many};
/// use twinslip::model::Loading;
/// # fn main() -> twinslip::Result<()> {
/// let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
/// let thousand = ManyInterfaces::alike(law, 1000, Loading::new(10.0, 0.14)?)?;
/// let found = equilibrium_of_many(&thousand, (9.9, &[90.0; 1000]), Solver::Newton)?;
/// assert!((found.slip_rate[0] / 0.01 - 1.0).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`Error::Parameter`] for a start that is not positive; [`Error::Input`] where several processes share the interfaces;
/// [`Error::NotConverged`] and [`Error::NonFinite`] where the method comes to none, [`Error::Sundials`] of KINSOL.
pub fn equilibrium_of_many(
    interfaces: &ManyInterfaces,
    (stress, states): (f64, &[f64]),
    solver: Solver,
) -> Result<ManyEquilibrium> {
    interfaces.checked(stress, states)?;
    if interfaces.share.ranks() > 1 {
        return Err(Error::Input(
            "the equilibrium of many interfaces is found by one process alone".into(),
        ));
    }
    let field = ManyField::new(interfaces, &Slips::default());
    let mut y = field.start(stress, states);
    let iterations = match solver {
        #[cfg(feature = "sundials")]
        Solver::Kinsol => {
            let field = ManyField::new(interfaces, &Slips::default());
            let (found, iterations) = super::kinsol::zero(field, y)?;
            y = found;
            iterations
        }
        Solver::Newton => {
            let iterations = newton::near(&field, &mut y)?;
            newton::settled(&field, &mut y, iterations)?
        }
    };
    bounded(&field, &y, iterations)
}

/// An interface at a state, with what rounding does to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rounded {
    pub local: Local,
    /// Of v, relative.
    pub relative: f64,
    /// Of dw/dt.
    pub evolution: f64,
}

/// All interfaces at tau and these ln psi.
pub(super) fn rounded(interfaces: &ManyInterfaces, tau: f64, w: &[f64]) -> Vec<Rounded> {
    let stress = Stress::new(interfaces.kind, tau);
    let one = |(i, &w): (usize, &f64)| {
        let (of, lane) = (of(&interfaces.constants, i / LANES), i % LANES);
        let at = (stress, w);
        let local = of.linearised(interfaces.kind, lane, at);
        // A few operations; the exponentials of tau and of w multiply what their arguments are off, and these are off by how the
        // constants are rounded.
        let exponents =
            (of.stress_factor[lane] * tau).abs() + of.beta[lane].abs() * (2.0 + w.abs());
        let relative = f64::EPSILON * (8.0 + exponents);
        Rounded {
            local,
            relative,
            evolution: relative * of.turnover(interfaces.kind, lane, at),
        }
    };
    w.par_iter().enumerate().map(one).collect()
}

/// What a sum of so many positive numbers is off, relative to it: chunk by chunk.
pub(super) fn rounding_of_sum(count: usize) -> f64 {
    f64::EPSILON * (100.0 + count as f64 / 512.0)
}

/// The state with its error: what Newton's method would still change, and what rounding can do to the equations, as far as the arrow matrix
/// amplifies it.
fn bounded(field: &ManyField<'_>, y: &[f64], iterations: usize) -> Result<ManyEquilibrium> {
    let interfaces = field.interfaces;
    let count = interfaces.count();
    let driving = interfaces.loading.driving;
    let tau = y[field.stress()];
    let w = &y[..count];
    let mut rates = vec![0.0; y.len()];
    field.rates(y, &mut rates);
    let sum_is_off = rates[field.stress()] / interfaces.loading.stiffness;
    let of_each = rates[..count].iter().map(|rate| rate.abs() * count as f64);
    let residual = of_each.fold(sum_is_off.abs(), f64::max) / driving;
    let mut arrow = Arrow::default();
    newton::linearised(field, y, &mut arrow, iterations)?;
    let mut left = rates;
    newton::correction(field, &arrow, y, &mut left);
    let left_of_tau = left[field.stress()];

    let all = rounded(interfaces, tau, w);
    let mut sums = [0.0; 4];
    for one in &all {
        let Local {
            rate,
            rate_by_stress,
            rate_by_log,
            evolution_by_stress,
            evolution_by_log,
            ..
        } = one.local;
        let by_log = rate_by_log / evolution_by_log;
        sums[0] += rate.abs();
        sums[1] += rate.abs() * one.relative;
        sums[2] += (by_log * one.evolution).abs();
        sums[3] += rate_by_stress - by_log * evolution_by_stress;
    }
    let [total, of_rates, of_states, compliance] = sums;
    let of_sum = rounding_of_sum(count) * (total + driving);
    let rounding_of_tau = ((of_rates + of_sum + of_states) / compliance).abs();
    let bound = |x: f64| if x.is_nan() { f64::INFINITY } else { x };
    let stress = Uncertain::new(
        tau,
        2.0 * left_of_tau.abs() + rounding_of_tau + f64::EPSILON * tau,
    );
    let log_state_uncertainty = all.iter().zip(&left).zip(w).map(|((one, left), w)| {
        let local = &one.local;
        let rounding = one.evolution + (local.evolution_by_stress * rounding_of_tau).abs();
        let rounding = rounding / local.evolution_by_log.abs();
        bound(2.0 * left.abs() + rounding + f64::EPSILON * w.abs())
    });
    let slip_rate_uncertainty = all.iter().zip(&left).map(|(one, left)| {
        let local = &one.local;
        let moved = local.rate_by_stress * left_of_tau + local.rate_by_log * left;
        let by_log = local.rate_by_log / local.evolution_by_log;
        let along = local.rate_by_stress - by_log * local.evolution_by_stress;
        let rounding = (along * rounding_of_tau).abs() + (by_log * one.evolution).abs();
        bound(2.0 * moved.abs() + rounding + one.relative * local.rate.abs())
    });
    Ok(ManyEquilibrium {
        stress,
        log_state: w.to_vec(),
        log_state_uncertainty: log_state_uncertainty.collect(),
        slip_rate: all.iter().map(|one| one.local.rate).collect(),
        slip_rate_uncertainty: slip_rate_uncertainty.collect(),
        residual,
        iterations,
    })
}
