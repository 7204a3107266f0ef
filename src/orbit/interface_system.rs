//! What slides: one or two interfaces with a law and a loading, and its vector fields.

use super::find::rough_period;
use crate::error::Result;
use crate::field::place;
use crate::friction::{AnyLaw, Formulas, Law, positive, steady_stress};
use crate::model::{
    DRIVING, Driven, Loading, Parameter, STIFFNESS, interfaces_in_difference_chart,
    single_interface, symmetric, two_interfaces,
};

/// One or two interfaces between elastic slabs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterfaceSystem {
    /// The law of every interface.
    pub law: AnyLaw,
    /// 1 or 2.
    pub interfaces: usize,
    /// V_H and K.
    pub loading: Loading,
}

impl InterfaceSystem {
    /// The system (19) in (tau, ln psi_1, ln psi_2).
    pub fn whole(&self) -> Box<dyn Driven<3>> {
        two_interfaces(self.law, self.loading)
    }

    /// The same in (tau, ln psi_2, ln(psi_1 - psi_2)), for psi_1 > psi_2: there small differences keep all their digits.
    pub(crate) fn in_difference_chart(&self) -> Box<dyn Driven<3>> {
        interfaces_in_difference_chart(self.law, self.loading)
    }

    /// In (tau, ln psi): the symmetric subspace of (19), or a single interface (11).
    pub fn plane(&self) -> Box<dyn Driven<2>> {
        if self.interfaces == 1 {
            single_interface(self.law, self.loading)
        } else {
            symmetric(self.law, self.loading)
        }
    }

    /// The names of its parameters: V_H, K and the constants that its law has.
    pub fn parameter_names(&self) -> &'static [&'static str] {
        Parameter::names(&self.law)
    }

    /// The value of the parameter of this name.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a name that is not among [`InterfaceSystem::parameter_names`].
    pub fn parameter(&self, name: &str) -> Result<f64> {
        let place = place(self.parameter_names(), name)?;
        let mut slab = *self;
        Ok(*slab.at_place(place))
    }

    /// The same slab with another value of the parameter of this name.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a name that is not among [`InterfaceSystem::parameter_names`], and for a
    /// value that is not positive and finite; a residual strength may be zero.
    pub fn with(&self, name: &str, value: f64) -> Result<InterfaceSystem> {
        let names = self.parameter_names();
        let place = place(names, name)?;
        if !(value == 0.0 && name == "residual_strength") {
            positive(names[place], value)?;
        }
        Ok(self.with_parameter(place, value))
    }

    /// The same by the place of a parameter that it has.
    pub(super) fn with_parameter(mut self, place: usize, value: f64) -> InterfaceSystem {
        *self.at_place(place) = value;
        self
    }

    fn at_place(&mut self, place: usize) -> &mut f64 {
        match place {
            DRIVING => &mut self.loading.driving,
            STIFFNESS => &mut self.loading.stiffness,
            _ => {
                let mut constants = self.law.constants().into_iter().flatten();
                constants
                    .nth(place - Parameter::PLANE.len())
                    .expect("one that the law has")
            }
        }
    }

    /// The same slab at another V_H > 0.
    pub(crate) fn driven_at(&self, driving: f64) -> InterfaceSystem {
        InterfaceSystem {
            loading: Loading {
                driving,
                ..self.loading
            },
            ..*self
        }
    }

    /// The same slab with another K > 0.
    pub(crate) fn of_stiffness(&self, stiffness: f64) -> InterfaceSystem {
        InterfaceSystem {
            loading: Loading {
                stiffness,
                ..self.loading
            },
            ..*self
        }
    }

    /// The slip rate of each interface where all slide steadily alike.
    pub(crate) fn steady_rate(&self) -> f64 {
        self.loading.driving / self.interfaces as f64
    }

    /// tau_ss(V_H / 2), or of V_H where there is one interface: the stress of the symmetric equilibrium, which every
    /// symmetric orbit passes.
    pub fn steady_stress(&self) -> f64 {
        steady_stress(&self.law, self.steady_rate())
    }

    /// The time in which the loading alone raises the stress by some units: that of a stick-slip cycle, roughly.
    pub fn rough_period(&self) -> f64 {
        rough_period(&self.loading)
    }

    /// ln psi of the symmetric equilibrium.
    pub fn steady_log_state(&self) -> f64 {
        self.law.steady_state(self.steady_rate()).ln()
    }
}
