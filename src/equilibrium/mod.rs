//! Equilibria: all steady states at a driving velocity, by KINSOL and by a pure-Rust Newton method, with eigenvalues.
//!
//! The steady states depend on V_H alone (20); the stiffness enters their stability. Both solvers start from the same
//! brackets (one for each solution, see `isolate`) and share nothing after: Newton follows one unknown, the slower rate,
//! KINSOL the two logarithms of the rates.

mod eigenvalues;
mod interface;
mod isolate;
#[cfg(feature = "sundials")]
mod kinsol;
mod newton;
mod pitchfork;

pub use eigenvalues::{Stability, Verdict, stability};
pub(crate) use interface::{Interface, routh_hurwitz};
pub(crate) use isolate::quotient;
pub use pitchfork::Pitchfork;

use crate::error::Result;
use crate::friction::{AnyLaw, Law, positive, steady_stress_within, with_law};
use crate::number::{Interval, Jet, Uncertain, enclosing_radius};

/// Which solver finds the asymmetric steady states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// KINSOL, of SUNDIALS, in (ln V_slow, ln V_fast).
    #[cfg(feature = "sundials")]
    Kinsol,
    /// Newton's method in a bracket of V_slow.
    Newton,
}

/// Whether the interfaces slide alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// V_1 = V_2 (also said of the one state of a single interface).
    Symmetric,
    /// V_1 < V_2; exchanging the interfaces gives another equilibrium, which is not listed.
    Asymmetric,
}

impl Symmetry {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Symmetry::Symmetric => "symmetric",
            Symmetry::Asymmetric => "asymmetric",
        }
    }

    /// The one of that name.
    pub fn named(name: &str) -> Option<Self> {
        let both = [Symmetry::Symmetric, Symmetry::Asymmetric];
        both.into_iter().find(|symmetry| symmetry.name() == name)
    }
}

/// A steady state.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Whether the interfaces slide alike.
    pub symmetry: Symmetry,
    /// tau, in a sigma.
    pub stress: Uncertain,
    /// Slip rate of each interface in V*, the slower one first.
    pub slip_rate: Vec<f64>,
    /// ln psi of each interface.
    pub log_state: Vec<f64>,
    /// The true slip rates.
    pub(crate) rate_bounds: Vec<Interval>,
}

impl Equilibrium {
    /// The state in which one or two interfaces slide alike at V_H.
    pub(crate) fn symmetric(law: &impl Law, driving: f64, interfaces: usize) -> Self {
        let each = driving / interfaces as f64;
        Self::at(law, Symmetry::Symmetric, &vec![(each, 0.0); interfaces])
    }

    /// The asymmetric state at V_H with this slower rate, enclosed: without bounds where it can't be, as at the fold V_sn.
    pub(crate) fn asymmetric(law: &impl Law, driving: f64, slow: f64) -> Self {
        // of the two, the faster rate is the one that V_H - V does not rob of digits
        let fast = driving - slow;
        // The error budget belongs to the number, not to the solver: signs on both sides of it, in intervals.
        let radius = enclosing_radius(slow, |s| quotient(law, driving, s));
        let rates = [(slow, radius), (fast, radius + fast * f64::EPSILON)];
        Self::at(law, Symmetry::Asymmetric, &rates)
    }

    /// psi of each interface.
    pub fn state(&self) -> Vec<f64> {
        self.log_state.iter().map(|w| w.exp()).collect()
    }

    /// The true slip rate of each interface lies within this distance.
    pub fn slip_rate_uncertainty(&self) -> Vec<f64> {
        self.rate_bounds
            .iter()
            .zip(&self.slip_rate)
            .map(|(bounds, &v)| bounds.distance_from(v))
            .collect()
    }

    /// The largest residual of (19): of the balance of the rates, relative to V_H, and of each evolution, relative to the rate
    /// G_psi at which its state is renewed. Both then are relative errors, of a rate and of a state.
    pub fn residual(&self, law: &impl Law, driving: f64) -> f64 {
        let s = law.activation(self.stress.value);
        let rates: Vec<f64> = self
            .state()
            .iter()
            .map(|&psi| law.slip_rate(s, psi))
            .collect();
        let balance = (driving - rates.iter().sum::<f64>()).abs() / driving;
        let evolutions = rates.iter().zip(self.state()).map(|(&v, psi)| {
            let held = Jet {
                value: v,
                gradient: [0.0],
            };
            let rate = law.evolution(held, Jet::variable(psi, 0));
            (rate.value / (rate.gradient[0] * psi)).abs()
        });
        evolutions.fold(balance, f64::max)
    }

    fn at(law: &impl Law, symmetry: Symmetry, rates: &[(f64, f64)]) -> Self {
        let (slow, radius) = rates[0];
        Equilibrium {
            symmetry,
            stress: steady_stress_within(law, slow, radius),
            slip_rate: rates.iter().map(|&(v, _)| v).collect(),
            log_state: rates
                .iter()
                .map(|&(v, _)| law.steady_state(v).ln())
                .collect(),
            rate_bounds: rates.iter().map(|&(v, r)| Interval::around(v, r)).collect(),
        }
    }
}

/// All steady states at one driving velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyStates {
    /// By stress, descending.
    pub equilibria: Vec<Equilibrium>,
    /// Whether their number is certain. It isn't within rounding of a pitchfork or of the fold V_sn.
    pub complete: bool,
}

/// All steady states of one or two interfaces with this law at V_H, for every stiffness.
///
/// ```
/// use twinslip::equilibrium::{Solver, steady_states};
/// use twinslip::friction::{AnyLaw, Parameters};
/// let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
/// let found = steady_states(&law, 1000.0, 2, Solver::Newton)?;
/// assert_eq!(found.equilibria.len(), 3); // slow/fast, middle/fast, symmetric
/// # Ok::<(), twinslip::Error>(())
/// ```
///
/// # Errors
/// [`crate::Error::Parameter`] unless V_H is positive and finite and there are one or two interfaces;
/// [`crate::Error::NotConverged`] or [`crate::Error::Sundials`] if a solver fails.
pub fn steady_states(
    law: &AnyLaw,
    driving: f64,
    interfaces: usize,
    solver: Solver,
) -> Result<SteadyStates> {
    positive("driving", driving)?;
    if !(1..=2).contains(&interfaces) {
        return Err(crate::Error::parameter("interfaces", interfaces, "1 or 2"));
    }
    with_law!(law, law => of_law(law, driving, interfaces, solver))
}

fn of_law(law: &impl Law, driving: f64, interfaces: usize, solver: Solver) -> Result<SteadyStates> {
    let symmetric = Equilibrium::symmetric(law, driving, interfaces);
    let mut found = SteadyStates {
        equilibria: vec![symmetric],
        complete: true,
    };
    if interfaces == 2 {
        let isolation = isolate::asymmetric(law, driving)?;
        found.complete = isolation.certain;
        let slower_rates = match solver {
            #[cfg(feature = "sundials")]
            Solver::Kinsol => kinsol::solve(law, driving, &isolation.brackets)?,
            Solver::Newton => newton::solve(law, driving, &isolation.brackets)?,
        };
        for slow in slower_rates {
            found
                .equilibria
                .push(Equilibrium::asymmetric(law, driving, slow));
        }
    }
    found
        .equilibria
        .sort_by(|a, b| b.stress.value.total_cmp(&a.stress.value));
    Ok(found)
}
