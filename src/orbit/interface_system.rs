//! What slides: one or two interfaces with a law and a loading, and its vector fields.

use crate::friction::{AnyLaw, Formulas, steady_stress};
use crate::model::{
    Driven, Loading, interfaces_in_difference_chart, single_interface, symmetric, two_interfaces,
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
        /// Typical stress drop of a cycle, in a sigma.
        const DROP: f64 = 5.0;
        DROP / (self.loading.stiffness * self.loading.driving)
    }

    /// ln psi of the symmetric equilibrium.
    pub fn steady_log_state(&self) -> f64 {
        self.law.steady_state(self.steady_rate()).ln()
    }
}
