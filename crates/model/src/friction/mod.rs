//! How an interface resists: rate-and-state friction laws, each written once.
//!
//! Everything is dimensionless: stress in a sigma, slip rate in V*, time in L/V*. A law is two formulas, the direct effect
//! tau = F(v, psi) with its inverse v(tau, psi), and the evolution of the state; steady state, extrema and the critical
//! stiffness follow from them.
//!
//! A new law is one file and its entry in the list of laws: the tests then run over it too.

mod bounded;
mod dieterich_ruina;
mod direct;
mod regularised_ageing;
mod rounding;
mod slip;
mod spinodal;
mod steady;

#[doc(hidden)]
pub use rounding::{effects, rounding};
pub use steady::{
    Extremum, ExtremumKind, StiffnessMaximum, critical_stiffness, critical_stiffness_maximum,
    steady_log_activation, steady_log_slope, steady_slope, steady_stress, steady_stress_within,
};

use crate::error::{Error, Result};
use crate::number::Real;
use std::fmt::Debug;

/// A rate-and-state friction law (1), for a state psi > 0.
///
/// The stress acts through one function of its own, as in any thermally activated process: v = s(tau) / strength(psi).
/// Interfaces under the same stress share s(tau), which is why it is a formula apart.
pub trait Law: Copy + Debug + Send + Sync {
    /// The law whose formulas this one's are: itself, or that of which it is a special case. Machine code is made for each of
    /// these only.
    type Core: Law;

    /// Whether its power series are compiled order by order: those of the laws that the paper computes with are.
    const UNROLLED: bool = false;

    /// Whether those of several trajectories at once are too, which takes a minute.
    const UNROLLED_IN_LANES: bool = false;

    /// This law as one of those.
    fn core(&self) -> Self::Core;

    /// The name by which the command line knows the law.
    fn name(&self) -> &'static str;

    /// Its constants with their names, to see what changes with them.
    fn constants(&mut self) -> Vec<(&'static str, &mut f64)>;

    /// s(tau), the activation by the stress. Same sign as the slip rate.
    fn activation<T: Real>(&self, tau: T) -> T;

    /// v, from s(tau) and psi: the direct effect, solved for the slip rate.
    fn slip_rate<T: Real>(&self, activation: T, psi: T) -> T;

    /// ln h(psi), h being strength(psi): it has a double where h overflows.
    fn log_strength<T: Real>(&self, psi: T) -> T;

    /// ln s(tau) for tau > 0.
    fn log_activation(&self, tau: f64) -> f64;

    /// dv/dtau = 1/F_V at the slip rate v and this ln h.
    fn compliance<T: Real>(&self, v: T, log_strength: T) -> T;

    /// tau = F(v, psi): the direct effect as printed.
    fn stress<T: Real>(&self, v: T, psi: T) -> T;

    /// dpsi/dt = -G(v, psi) as printed.
    fn evolution<T: Real>(&self, v: T, psi: T) -> T;

    /// psi_ss(V) for V > 0: the zero of the evolution (3).
    fn steady_state<T: Real>(&self, v: T) -> T;

    /// The extrema of tau_ss(V), by slip rate ascending: a maximum V_M, then a minimum V_m, where the law has them.
    fn steady_extrema(&self) -> Vec<f64>;

    /// Whether the evolution keeps psi in (0, 1].
    fn bounds_state(&self) -> bool {
        false
    }

    /// Whether every motion that it allows, forwards in time, exists for all time. Where v has the sign of tau the stress can't
    /// pass through zero, so that the slip in a time t stays below |tau_0|/K + V_H t, and psi above a bound: then it does.
    fn lasts(&self) -> bool {
        false
    }

    /// V_T = V*/c, where high-velocity strengthening sets in (Weeks 1993).
    fn transition_rate(&self) -> Option<f64> {
        None
    }
}

/// The dimensionless parameters that the laws share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// beta = b/a.
    pub beta: f64,
    /// gamma0 = 2 exp(-a_v/a).
    pub gamma0: f64,
    /// R = t** V*/L.
    pub healing_time: f64,
    /// c.
    pub residual_strength: f64,
}

impl Parameters {
    /// From the coefficients a, b, a_v and from R and c.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a, b or R is not positive and finite, c is negative, or a_v/a so large that gamma0 is 0.
    pub fn new(
        direct_effect: f64,
        evolution_effect: f64,
        reference_friction: f64,
        healing_time: f64,
        residual_strength: f64,
    ) -> Result<Self> {
        positive("direct-effect", direct_effect)?;
        positive("evolution-effect", evolution_effect)?;
        positive("healing-time", healing_time)?;
        if !(residual_strength >= 0.0 && residual_strength.is_finite()) {
            return Err(Error::parameter(
                "residual-strength",
                residual_strength,
                "zero or positive, and finite",
            ));
        }
        let gamma0 = 2.0 * (-reference_friction / direct_effect).exp();
        if !(gamma0.is_normal() && reference_friction >= 0.0) {
            return Err(Error::parameter(
                "reference-friction",
                reference_friction,
                "zero or positive, and less than 700 times the direct effect",
            ));
        }
        Ok(Parameters {
            beta: evolution_effect / direct_effect,
            gamma0,
            healing_time,
            residual_strength,
        })
    }

    /// The constants of the paper, fitted to Heslot et al. (1994), Bristol board: a = 0.0349, b = 0.0489, a_v = 0.369,
    /// with R = 100 and c = 1e-3.
    pub fn heslot_1994() -> Self {
        Self::new(0.0349, 0.0489, 0.369, 100.0, 1e-3).expect("the preset is valid")
    }
}

/// ln psi beside that of a steady state, by so much; towards less where more would leave the states of the law.
#[doc(hidden)]
pub fn beside(law: &impl Law, log_state: f64, by: f64) -> f64 {
    let moved = log_state + by;
    if law.bounds_state() && moved > 0.0 {
        log_state - by.abs()
    } else {
        moved
    }
}

/// A positive and finite number, or an error that names it.
#[doc(hidden)]
pub fn positive(name: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(Error::parameter(name, value, "positive and finite"))
    }
}

/// What there is once for all laws, from their list: the type of each, [`AnyLaw`], and the dispatch. It is handed a `$`, for the macro
/// that it makes.
macro_rules! laws {
    ($d:tt $($(#[$equation:meta])* $file:ident::$law:ident,)+) => {
        $(pub use $file::$law;)+

        /// Any of the laws, chosen at run time.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[non_exhaustive]
        pub enum AnyLaw {
            $($(#[$equation])* $law($law),)+
        }

        impl AnyLaw {
            /// The names by which the command line knows the laws.
            pub const NAMES: [&'static str; [$($law::NAME),+].len()] = [$($law::NAME),+];

            /// The law of that name.
            ///
            /// # Errors
            /// [`Error::Parameter`] for a name that is not in [`AnyLaw::NAMES`].
            pub fn named(name: &str, parameters: Parameters) -> Result<Self> {
                match name {
                    $($law::NAME => Ok(AnyLaw::$law(parameters.$file())),)+
                    _ => Err(Error::unknown("law", name, &AnyLaw::NAMES)),
                }
            }
        }

        /// Runs the expression with `law` bound to the law inside: it is then compiled for each law.
        macro_rules! with_law {
            ($d any:expr, $d law:ident => $d body:expr) => {
                match $d any {
                    $($crate::friction::AnyLaw::$law($d law) => $d body,)+
                }
            };
        }
    };
}

// The list: the equation, and the file with the type; `Parameters` has a method of the file's name that makes it.
laws! { $
    /// (35)
    spinodal::Spinodal,
    /// (6)
    bounded::Bounded,
    /// (5)
    regularised_ageing::RegularisedAgeing,
    /// (4)
    dieterich_ruina::DieterichRuina,
    /// Ruina (1983)
    slip::Slip,
}
pub(crate) use with_law;

impl AnyLaw {
    /// The name by which the command line knows this law.
    pub fn name(&self) -> &'static str {
        Law::name(self)
    }
}

impl Law for AnyLaw {
    type Core = AnyLaw;
    fn core(&self) -> AnyLaw {
        *self
    }
    fn name(&self) -> &'static str {
        with_law!(self, law => law.name())
    }
    fn constants(&mut self) -> Vec<(&'static str, &mut f64)> {
        with_law!(self, law => law.constants())
    }
    fn activation<T: Real>(&self, tau: T) -> T {
        with_law!(self, law => law.activation(tau))
    }
    fn slip_rate<T: Real>(&self, activation: T, psi: T) -> T {
        with_law!(self, law => law.slip_rate(activation, psi))
    }
    fn log_strength<T: Real>(&self, psi: T) -> T {
        with_law!(self, law => law.log_strength(psi))
    }
    fn log_activation(&self, tau: f64) -> f64 {
        with_law!(self, law => law.log_activation(tau))
    }
    fn compliance<T: Real>(&self, v: T, log_strength: T) -> T {
        with_law!(self, law => law.compliance(v, log_strength))
    }
    fn stress<T: Real>(&self, v: T, psi: T) -> T {
        with_law!(self, law => law.stress(v, psi))
    }
    fn evolution<T: Real>(&self, v: T, psi: T) -> T {
        with_law!(self, law => law.evolution(v, psi))
    }
    fn steady_state<T: Real>(&self, v: T) -> T {
        with_law!(self, law => law.steady_state(v))
    }
    fn steady_extrema(&self) -> Vec<f64> {
        with_law!(self, law => law.steady_extrema())
    }
    fn bounds_state(&self) -> bool {
        with_law!(self, law => law.bounds_state())
    }
    fn lasts(&self) -> bool {
        with_law!(self, law => law.lasts())
    }
    fn transition_rate(&self) -> Option<f64> {
        with_law!(self, law => law.transition_rate())
    }
}
