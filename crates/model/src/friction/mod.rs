//! How an interface resists: rate-and-state friction laws, each written once.
//!
//! Everything is dimensionless: stress in a sigma, slip rate in V*, time in L/V*. A law is two formulas, the direct effect
//! tau = F(v, psi) with its inverse v(tau, psi), and the evolution of the state; steady state, extrema and the critical
//! stiffness follow from them.
//!
//! A law's formulas take constants of any kind: doubles in what is compiled for speed, numbers where derivatives in them are asked
//! for. A new law is one file and its entry in the list of laws: the tests then run over it too.

mod bounded;
mod damped;
mod dieterich_ruina;
mod direct;
mod form;
mod regularised_ageing;
mod rounding;
mod scaled;
mod slip;
mod spinodal;
mod steady;
mod unequal;

pub use damped::Damped;
pub use form::{AgeingForm, LawForm};
#[doc(hidden)]
pub use rounding::{Rounded, effects, rounding};
pub use scaled::ScaledLaw;
pub use steady::{
    Extremum, ExtremumKind, StiffnessMaximum, critical_stiffness, critical_stiffness_maximum,
    steady_log_activation, steady_log_slope, steady_slope, steady_stress, steady_stress_within,
};
pub use unequal::{InterfaceConstants, UnequalLaws};

use crate::error::{Error, Result};
use crate::number::{Constant, Free, Real, With};
use std::fmt::Debug;

/// The formulas of a rate-and-state friction law (1), for a state psi > 0, whose constants are of the kind C.
///
/// The stress acts through one function of its own, as in any thermally activated process: v = s(tau) / strength(psi).
/// Interfaces under the same stress share s(tau), which is why it is a formula apart.
pub trait Formulas<C = f64> {
    /// Whether s is (gamma0/2) e^tau, as in the plain laws; else gamma0 sinh(tau).
    const EXPONENTIAL: bool = false;

    /// s(tau), the activation by the stress. Same sign as the slip rate.
    fn activation<T: With<C>>(&self, tau: T) -> T;

    /// v, from s(tau) and psi: the direct effect, solved for the slip rate.
    fn slip_rate<T: With<C>>(&self, activation: T, psi: T) -> T;

    /// ln h(psi), h being strength(psi): it has a double where h overflows.
    fn log_strength<T: With<C>>(&self, psi: T) -> T;

    /// dv/dtau = 1/F_V at the slip rate v and this ln h.
    fn compliance<T: With<C>>(&self, v: T, log_strength: T) -> T;

    /// tau = F(v, psi): the direct effect as printed.
    fn stress<T: With<C>>(&self, v: T, psi: T) -> T;

    /// dpsi/dt = -G(v, psi) as printed.
    fn evolution<T: With<C>>(&self, v: T, psi: T) -> T;

    /// psi_ss(V) for V > 0: the zero of the evolution (3).
    fn steady_state<T: With<C>>(&self, v: T) -> T;
}

/// A friction law: its formulas, and what is known of it.
pub trait Law: Formulas + Copy + Debug + Send + Sync {
    /// The law with constants that are numbers, in which its formulas then have derivatives.
    type Freed<T: Real>: Formulas<Free<T>>;

    /// A law of this kind with these constants, as far as it has them.
    fn freed<T: Real>(&self, constants: Parameters<Free<T>>) -> Self::Freed<T>;

    /// The name by which the command line knows the law.
    fn name(&self) -> &'static str;

    /// Its constants, in the order of [`Parameters::NAMES`], as far as it has them.
    fn constants(&mut self) -> [Option<&mut f64>; Parameters::NAMES.len()];

    /// eta, the radiation damping; 0 where the law is that of the friction alone.
    fn damping(&self) -> f64 {
        0.0
    }

    /// ln s(tau) for tau > 0.
    fn log_activation(&self, tau: f64) -> f64;

    /// The extrema of tau_ss(V), by slip rate ascending: a maximum V_M, then a minimum V_m, where the law has them; of a law that weakens
    /// from rest the minimum alone.
    fn steady_extrema(&self) -> Vec<f64>;

    /// Whether tau_ss falls from rest on: the first of its extrema is then a minimum.
    fn weakens_from_rest(&self) -> bool {
        false
    }

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
pub struct Parameters<C = f64> {
    /// beta = b/a.
    pub beta: C,
    /// gamma0 = 2 exp(-a_v/a).
    pub gamma0: C,
    /// R = t** V*/L.
    pub healing_time: C,
    /// c.
    pub residual_strength: C,
    /// eta V*/(a sigma), the radiation damping.
    pub damping: C,
}

impl<T> From<[T; Parameters::NAMES.len()]> for Parameters<Free<T>> {
    /// In the order of [`Parameters::NAMES`].
    fn from(constants: [T; Parameters::NAMES.len()]) -> Self {
        let [beta, gamma0, healing_time, residual_strength, damping] = constants.map(Free);
        Parameters {
            beta,
            gamma0,
            healing_time,
            residual_strength,
            damping,
        }
    }
}

impl<T: Real> Parameters<T> {
    /// The constants of an interface with l times the slip length by which R, the state of an ageing law and time are dimensionless.
    ///
    /// Its friction is that of its own units, where the state is psi/l and, of laws whose state heals in a finite time, R is R/l. Its strength
    /// is then psi/l or c + (1 + R/l) psi, which is s times that of the formulas with c/s for c. So the friction of steady sliding at V* does
    /// not depend on l.
    pub fn of_slip_length(self, l: T, heals_in_finite_time: bool) -> Self {
        let s = match heals_in_finite_time {
            true => (self.healing_time / l + 1.0) / (self.healing_time + 1.0),
            false => T::constant(1.0) / l,
        };
        Parameters {
            gamma0: self.gamma0 * (-(s.ln() * self.beta)).exp(),
            residual_strength: self.residual_strength / s,
            ..self
        }
    }
}

impl Parameters {
    /// Their names. Every law has the first two, those whose state is bounded the third, the spinodal one the fourth, and those that are
    /// damped the last.
    pub const NAMES: [&'static str; 5] = [
        "beta",
        "gamma0",
        "healing_time",
        "residual_strength",
        "damping",
    ];

    /// The same with this radiation damping eta V*/(a sigma).
    ///
    /// # Errors
    /// [`Error::Parameter`] if it is negative or not finite.
    pub fn damped(self, damping: f64) -> Result<Self> {
        if damping >= 0.0 && damping.is_finite() {
            Ok(Parameters { damping, ..self })
        } else {
            let must = "zero or positive, and finite";
            Err(Error::parameter("damping", damping, must))
        }
    }

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
            damping: 0.0,
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
    ($d:tt $(#[doc = $equation:literal] $file:ident::$law:ident,)+) => {
        $(pub use $file::$law;)+

        /// Any of the laws, chosen at run time.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[non_exhaustive]
        pub enum AnyLaw<C = f64> {
            $(#[doc = $equation] $law($law<C>),)+
            /// One of these with radiation damping.
            Damped(Damped<C>),
        }

        $(impl From<$law> for AnyLaw {
            fn from(law: $law) -> Self {
                AnyLaw::$law(law)
            }
        })+

        /// A law without damping, by its name alone.
        #[derive(Debug, Clone, Copy, PartialEq)]
        enum Undamped {
            $($law,)+
        }

        impl AnyLaw {
            /// The names by which the command line knows the laws.
            pub const NAMES: [&'static str; [$($law::NAME),+].len()] = [$($law::NAME),+];

            /// Where each is from: the paper's equation, or who wrote of it and when.
            pub const SOURCES: [&'static str; AnyLaw::NAMES.len()] = [$($equation.trim_ascii()),+];

            /// The law of that name, damped where the parameters say so.
            ///
            /// # Errors
            /// [`Error::Parameter`] for a name that is not in [`AnyLaw::NAMES`].
            pub fn named(name: &str, parameters: Parameters) -> Result<Self> {
                let damped = parameters.damping != 0.0;
                match name {
                    $($law::NAME if damped => Ok(AnyLaw::Damped(Damped::new(Undamped::$law, parameters))),)+
                    $($law::NAME => Ok(AnyLaw::$law(parameters.$file())),)+
                    _ => Err(Error::unknown("law", name, &AnyLaw::NAMES)),
                }
            }

            /// The law of this name with these constants, of an interface with l times the slip length by which they are dimensionless.
            ///
            /// # Errors
            /// Those of [`AnyLaw::named`].
            pub fn of_slip_length(name: &str, parameters: Parameters, l: f64) -> Result<Self> {
                let heals = Self::named(name, parameters)?.bounds_state();
                Self::named(name, parameters.of_slip_length(l, heals))
            }

            /// [`Law::freed`].
            fn of_kind<T: Real>(&self, constants: Parameters<Free<T>>) -> AnyLaw<Free<T>> {
                match self {
                    $(AnyLaw::$law(_) => AnyLaw::$law(constants.$file()),)+
                    AnyLaw::Damped(law) => AnyLaw::Damped(law.of_kind(constants)),
                }
            }
        }

        /// Runs the expression with `law` bound to the law inside: it is then compiled for each law.
        macro_rules! with_law {
            ($d any:expr, $d law:ident => $d body:expr) => {
                match $d any {
                    $($crate::friction::AnyLaw::$law($d law) => $d body,)+
                    $crate::friction::AnyLaw::Damped($d law) => $d body,
                }
            };
        }

        /// The same with `law` the law of this name with these constants.
        macro_rules! with_undamped {
            ($d name:expr, $d constants:expr, $d law:ident => $d body:expr) => {
                match $d name {
                    $($crate::friction::Undamped::$law => {
                        let $d law = $d constants.$file();
                        $d body
                    })+
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
use with_undamped;

impl From<Damped> for AnyLaw {
    fn from(law: Damped) -> Self {
        AnyLaw::Damped(law)
    }
}

impl AnyLaw {
    /// The name by which the command line knows this law.
    pub fn name(&self) -> &'static str {
        Law::name(self)
    }

    /// The law in the constants that its power series are made from.
    pub fn form(&self) -> LawForm {
        with_law!(self, law => law.form())
    }
}

impl<C: Constant> Formulas<C> for AnyLaw<C> {
    fn activation<T: With<C>>(&self, tau: T) -> T {
        with_law!(self, law => law.activation(tau))
    }
    fn slip_rate<T: With<C>>(&self, activation: T, psi: T) -> T {
        with_law!(self, law => law.slip_rate(activation, psi))
    }
    fn log_strength<T: With<C>>(&self, psi: T) -> T {
        with_law!(self, law => law.log_strength(psi))
    }
    fn compliance<T: With<C>>(&self, v: T, log_strength: T) -> T {
        with_law!(self, law => law.compliance(v, log_strength))
    }
    fn stress<T: With<C>>(&self, v: T, psi: T) -> T {
        with_law!(self, law => law.stress(v, psi))
    }
    fn evolution<T: With<C>>(&self, v: T, psi: T) -> T {
        with_law!(self, law => law.evolution(v, psi))
    }
    fn steady_state<T: With<C>>(&self, v: T) -> T {
        with_law!(self, law => law.steady_state(v))
    }
}

impl Law for AnyLaw {
    type Freed<T: Real> = AnyLaw<Free<T>>;
    fn freed<T: Real>(&self, constants: Parameters<Free<T>>) -> AnyLaw<Free<T>> {
        self.of_kind(constants)
    }
    fn name(&self) -> &'static str {
        with_law!(self, law => law.name())
    }
    fn constants(&mut self) -> [Option<&mut f64>; Parameters::NAMES.len()] {
        with_law!(self, law => law.constants())
    }
    fn damping(&self) -> f64 {
        with_law!(self, law => law.damping())
    }
    fn weakens_from_rest(&self) -> bool {
        with_law!(self, law => law.weakens_from_rest())
    }
    fn log_activation(&self, tau: f64) -> f64 {
        with_law!(self, law => law.log_activation(tau))
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
