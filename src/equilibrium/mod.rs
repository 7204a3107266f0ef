//! Equilibria: all steady states at a driving velocity, by KINSOL and by a pure-Rust Newton method, with eigenvalues.
//!
//! The steady states depend on V_H alone (20); the stiffness enters their stability. Both solvers start from the same
//! brackets (one for each solution, see `isolate`): Newton follows one unknown, the slower rate, KINSOL the two logarithms of the
//! rates. What either finds is then carried to 31 digits, and bounded (see `refine`).

mod boxes;
mod clusters;
mod eigenvalues;
mod interface;
mod isolate;
#[cfg(feature = "sundials")]
mod kinsol;
mod lyapunov_ball;
mod newton;
mod pitchfork;
mod polynomial;
mod refine;
mod spectrum;
mod unequal;

pub use boxes::{Enclosed, IntervalBox, IsolatedZero, ZerosInBox, zero_near, zeros_in_box};
pub(crate) use clusters::{
    Along, Bracket, EquilibriumCurve, FAST, MIDDLE, SLOW, Share, ShareState, SteadyCurve,
    SteadyPoint, constant, share_states, shares,
};
pub use clusters::{
    ClusterEigenvalue, ClusterStability, EigenvalueKind, MOST_INTERFACES, cluster_stability,
    cluster_steady_states,
};
pub use eigenvalues::{Stability, Verdict, eigenvalues, stability};
pub use interface::LawOfEach;
pub(crate) use interface::{Interface, routh_hurwitz};
pub use lyapunov_ball::LyapunovBall;
pub use pitchfork::Pitchfork;
pub(crate) use refine::refined;
pub use spectrum::spectrum_within;
pub use unequal::unequal_steady_states;

use crate::error::Result;
use crate::friction::{
    AnyLaw, Formulas, Law, Rounded, positive, rounding, steady_log_activation, steady_slope,
    steady_stress,
};
use crate::number::{DoubleDouble, Interval, Jet, Real, Uncertain};

/// A state with a larger residual, which is a relative error, is none.
const VANISHING: f64 = 1e-9;

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
    /// V_1 < V_2; exchanging the interfaces gives another equilibrium, which is not listed. Also said of every state of interfaces that
    /// differ, where exchange gives none.
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
    /// Slip rate of each interface in V*, of equal ones the slower one first.
    pub slip_rate: Vec<f64>,
    /// ln psi of each interface.
    pub log_state: Vec<f64>,
    /// How many interfaces each of these numbers is of: one, but in a state that is told by its clusters.
    pub counts: Vec<usize>,
    /// V_H.
    pub(crate) driving: f64,
    /// The slip rates in 31 digits.
    pub(crate) precise: Vec<DoubleDouble>,
    /// The true slip rates.
    pub(crate) rate_bounds: Vec<Interval>,
    /// The true slower rate lies within this distance.
    pub(crate) radius: f64,
    /// The part of the distances of the true rates by which they move together; zero where no such part is known.
    pub(crate) together: Vec<f64>,
    /// The true psi and ln psi lie within these distances.
    state_uncertainty: Vec<[f64; 2]>,
}

impl Equilibrium {
    /// The state in which one or two interfaces slide alike at V_H.
    pub(crate) fn symmetric(law: &AnyLaw, driving: f64, interfaces: usize) -> Self {
        let each = DoubleDouble::from(driving) / interfaces as f64;
        let radius = each.to_f64() * f64::EPSILON;
        let rates = vec![(each, radius); interfaces];
        Self::at(law, driving, Symmetry::Symmetric, &rates)
    }

    /// The asymmetric state at V_H with about this slower rate: without bounds where it can't be enclosed, as at the fold V_sn.
    pub(crate) fn asymmetric(law: &AnyLaw, driving: f64, slow: f64) -> Self {
        if slow < f64::MIN_POSITIVE {
            return Self::at_rest(law, driving);
        }
        let precise = refined(law, driving, DoubleDouble::from(slow));
        let slow = if precise.is_finite() {
            precise
        } else {
            DoubleDouble::from(slow)
        };
        // The error budget belongs to the number, not to the solver: signs on both sides of it.
        let radius = refine::radius(law, driving, slow.to_f64());
        Self::pair(law, driving, slow, radius)
    }

    /// The asymmetric state whose slower rate is positive, but smaller than any double.
    fn at_rest(law: &AnyLaw, driving: f64) -> Self {
        Self::pair(law, driving, DoubleDouble::ZERO, f64::MIN_POSITIVE)
    }

    fn pair(law: &AnyLaw, driving: f64, slow: DoubleDouble, radius: f64) -> Self {
        // of the two, the faster rate is the one that V_H - V does not rob of digits
        let fast = DoubleDouble::from(driving) - slow;
        let rates = [(slow, radius), (fast, radius + driving * f64::EPSILON)];
        Self::at(law, driving, Symmetry::Asymmetric, &rates)
    }

    /// The interfaces that slide alike, slowest first: how many they are, and the place of the first of them among the numbers of this
    /// state.
    pub fn clusters(&self) -> Vec<(usize, usize)> {
        match self.symmetry {
            Symmetry::Symmetric => vec![(self.counts.iter().sum(), 0)],
            Symmetry::Asymmetric => self.counts.iter().copied().zip(0..).collect(),
        }
    }

    /// How many equilibria of equal interfaces differ from this one by their order alone, with itself: N!/(n_1! n_2! ...).
    pub fn arrangements(&self) -> f64 {
        let mut placed = 0;
        let mut all = 1.0;
        for (count, _) in self.clusters() {
            // of whole numbers up to 2^53 exactly, as each partial product is a binomial coefficient times what went before
            let mut ways = 1.0;
            for i in 1..=count {
                placed += 1;
                ways = (ways * placed as f64 / i as f64).round();
            }
            all *= ways;
        }
        all
    }

    /// psi of each interface.
    pub fn state(&self) -> Vec<f64> {
        self.log_state.iter().map(|w| w.exp()).collect()
    }

    /// The true psi of each interface lies within this distance, for the law's parameters and V_H as doubles and as decimals.
    pub fn state_uncertainty(&self) -> Vec<f64> {
        self.state_uncertainty.iter().map(|both| both[0]).collect()
    }

    /// The true ln psi of each interface lies within this distance.
    pub fn log_state_uncertainty(&self) -> Vec<f64> {
        self.state_uncertainty.iter().map(|both| both[1]).collect()
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
    pub fn residual(&self, laws: &impl LawOfEach, driving: f64) -> f64 {
        let tau = self.stress.value;
        // v = s(tau) / h(psi), neither of which need have a double
        let rate = |(i, psi): (usize, f64)| {
            let law = laws.law(i);
            if law.damping() != 0.0 {
                return law.slip_rate(law.activation(tau), psi);
            }
            let activation = if tau.is_normal() {
                law.log_activation(tau)
            } else {
                let fast = self.slip_rate[self.slip_rate.len() - 1];
                steady_log_activation(law, fast)
            };
            (activation - law.log_strength(psi)).exp()
        };
        let rates: Vec<f64> = self.state().into_iter().enumerate().map(rate).collect();
        let each = rates.iter().zip(&self.counts);
        let sum: f64 = each.map(|(v, &count)| v * count as f64).sum();
        let balance = (driving - sum).abs() / driving;
        let evolutions = rates.iter().zip(self.state()).enumerate();
        let evolutions = evolutions.map(|(i, (&v, psi))| {
            let held = Jet {
                value: v,
                gradient: [0.0],
            };
            let rate = laws.law(i).evolution(held, Jet::variable(psi, 0));
            (rate.value / (rate.gradient[0] * psi)).abs()
        });
        // of what has no value nothing vanishes
        let known = |x: f64| if x.is_nan() { f64::INFINITY } else { x };
        evolutions.map(known).fold(known(balance), f64::max)
    }

    fn at(
        laws: &impl LawOfEach,
        driving: f64,
        symmetry: Symmetry,
        rates: &[(DoubleDouble, f64)],
    ) -> Self {
        let bounds = |&(v, r): &(DoubleDouble, f64)| {
            let around = Interval::around(v.to_f64(), r);
            Interval::new(around.lo().max(0.0), around.hi())
        };
        let rate_bounds: Vec<_> = rates.iter().map(bounds).collect();
        let each = || rates.iter().zip(&rate_bounds).enumerate();
        let stress = each()
            .map(|(i, (&(v, radius), &within))| stress(laws.law(i), v, radius, within))
            .min_by(|a, b| a.uncertainty.total_cmp(&b.uncertainty));
        let states: Vec<_> = each()
            .map(|(i, (&(v, _), &within))| state(laws.law(i), v, within))
            .collect();
        Equilibrium {
            symmetry,
            stress: stress.unwrap_or(Uncertain::new(f64::INFINITY, f64::INFINITY)),
            slip_rate: rates.iter().map(|(v, _)| v.to_f64()).collect(),
            log_state: states.iter().map(|(w, _)| *w).collect(),
            counts: vec![1; rates.len()],
            driving,
            precise: rates.iter().map(|(v, _)| *v).collect(),
            rate_bounds,
            radius: rates
                .iter()
                .map(|rate| rate.1)
                .fold(f64::INFINITY, f64::min),
            together: vec![0.0; rates.len()],
            state_uncertainty: states.iter().map(|(_, both)| *both).collect(),
        }
    }

    /// The place of the slower interface: the other rate is V_H less that one.
    fn slower(&self) -> usize {
        usize::from(matches!(self.slip_rate[..], [first, second] if second < first))
    }
}

/// The part of the width of intervals, which is that of rounding in 16 digits, that the same operations err by in 31: 1e-15, and a
/// factor of a thousand.
const OF_31_DIGITS: f64 = 1e-12;

/// tau_ss at a rate known within bounds.
fn stress(law: &(impl Law + Rounded), v: DoubleDouble, radius: f64, within: Interval) -> Uncertain {
    let rate = v.to_f64();
    let value = steady_stress(law, v).to_f64();
    let bounds = steady_stress(law, Interval::constant(rate));
    let slope = steady_slope(law, within).abs();
    let spread = (slope * radius).hi();
    // in 31 digits nothing but the last one is lost, unless the numbers are too small or too large for these
    let ordinary = (1e-200..1e200).contains(&value) && (1e-200..1e200).contains(&rate);
    let (value, rounded) = if ordinary {
        let lost = OF_31_DIGITS * bounds.distance_from(value);
        (value, 0.5 * f64::EPSILON * value + lost)
    } else {
        let value = steady_stress(law, rate);
        (value, bounds.distance_from(value))
    };
    let inputs = rounding(law, |law| Some(steady_stress(law, rate)));
    Uncertain::new(value, (rounded + spread + inputs).next_up())
}

/// ln psi_ss at a rate known within bounds, with what psi_ss and it may be off.
fn state(law: &(impl Law + Rounded), v: DoubleDouble, within: Interval) -> (f64, [f64; 2]) {
    let log = law.steady_state(v).ln().to_f64();
    let rate = v.to_f64();
    let bounds = law.steady_state(within);
    let known = |x: f64| if x.is_nan() { f64::INFINITY } else { x };
    let of_state = rounding(law, |law| Some(law.steady_state(rate)));
    let of_log = rounding(law, |law| Some(law.steady_state(rate).ln()));
    let both = [
        bounds.distance_from(log.exp()) + of_state,
        bounds.ln().distance_from(log) + of_log,
    ];
    (log, both.map(known))
}

/// All steady states at one driving velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyStates {
    /// By stress, descending.
    pub equilibria: Vec<Equilibrium>,
    /// Whether their number is certain. It isn't within rounding of a pitchfork or of the fold V_sn.
    pub complete: bool,
}

impl SteadyStates {
    /// One more, unless it turns out to be none: then the number is not certain.
    fn add(&mut self, state: Equilibrium, laws: &impl LawOfEach, driving: f64) {
        if state.residual(laws, driving) <= VANISHING {
            self.equilibria.push(state);
        } else {
            self.complete = false;
        }
    }

    fn sorted(mut self) -> Self {
        self.equilibria
            .sort_by(|a, b| b.stress.value.total_cmp(&a.stress.value));
        self
    }
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
        let asymmetric = |slow| Equilibrium::asymmetric(law, driving, slow);
        let mut states: Vec<_> = slower_rates.into_iter().map(asymmetric).collect();
        if isolation.at_rest {
            states.push(Equilibrium::at_rest(law, driving));
        }
        for state in states {
            found.add(state, law, driving);
        }
    }
    Ok(found.sorted())
}
