//! A law in the constants that its power series are made from: one form of all laws, so that what makes series is compiled once and
//! not once for each law.

use crate::number::{Balance, Real};

/// v = s(y) (a_0 + a_1 psi)^(-beta) with y = tau - eta v, and the evolution of psi.
///
/// Without damping y is tau. With it v is defined by an equation: see [`Balance`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawForm {
    /// a_0 and a_1, s, and g_0 and g_1 of a state that ages.
    pub ageing: AgeingForm,
    /// Whether the state obeys the slip law, dpsi/dt = -v psi ln(v psi), and does not age.
    pub slip_law: bool,
    /// eta
    pub damping: f64,
}

/// v = s(tau) (a_0 + a_1 psi)^(-beta), dpsi/dt = g_0 + g_1 psi - |v| psi.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AgeingForm {
    /// a_0 and a_1.
    pub strength: [f64; 2],
    /// g_0 and g_1.
    pub healing: [f64; 2],
    /// beta
    pub beta: f64,
    /// gamma0: s = gamma0 e^tau / 2, and the same less gamma0 e^(-tau) / 2.
    pub gamma0: f64,
    /// Whether s is the exponential alone.
    pub exponential: bool,
}

impl From<AgeingForm> for LawForm {
    /// Without damping.
    fn from(ageing: AgeingForm) -> Self {
        LawForm {
            ageing,
            slip_law: false,
            damping: 0.0,
        }
    }
}

impl LawForm {
    /// The law where its state ages and nothing is damped: its series have recurrences of their own.
    pub fn undamped_ageing(&self) -> Option<AgeingForm> {
        (!self.slip_law && self.damping == 0.0).then_some(self.ageing)
    }

    /// s(tau); tau itself where there is damping, as interfaces under the same stress then share no more.
    #[inline(always)]
    pub(crate) fn activation<T: Real>(&self, tau: T) -> T {
        if self.damping == 0.0 {
            self.ageing.activation(tau)
        } else {
            tau
        }
    }

    /// v. With damping, eta v is (eta/h) s(y) of the y with y + (eta/h) s(y) = tau.
    #[inline(always)]
    pub(crate) fn slip_rate<T: Real>(&self, activation: T, psi: T) -> T {
        let weakness = self.ageing.weakness(psi);
        if self.damping == 0.0 {
            return activation * weakness;
        }
        let rate = weakness * self.ageing.gamma0 * self.damping;
        let g = if self.ageing.exponential {
            Balance::Exponential(rate * 0.5)
        } else {
            Balance::Sinh(rate)
        };
        activation.balanced(g).1 / self.damping
    }

    /// dpsi/dt
    #[inline(always)]
    pub(crate) fn evolution<T: Real>(&self, v: T, psi: T) -> T {
        if self.slip_law {
            let x = v * psi;
            -(x * x.ln())
        } else {
            self.ageing.evolution(v, psi)
        }
    }
}

impl AgeingForm {
    /// v = gamma0 sinh(tau) psi^(-beta), dpsi/dt = 1 - |v| psi.
    pub(super) fn of_ageing(beta: f64, gamma0: f64) -> Self {
        AgeingForm {
            strength: [0.0, 1.0],
            healing: [1.0, 0.0],
            beta,
            gamma0,
            exponential: false,
        }
    }

    /// a_0 + a_1 psi
    #[inline(always)]
    fn linear_strength<T: Real>(&self, psi: T) -> T {
        // psi itself, where it is that, spares series a row.
        if self.strength == [0.0, 1.0] {
            psi
        } else {
            psi * self.strength[1] + self.strength[0]
        }
    }

    /// (a_0 + a_1 psi)^(-beta)
    #[inline(always)]
    fn weakness<T: Real>(&self, psi: T) -> T {
        self.linear_strength(psi).powf(-self.beta)
    }

    /// s(tau)
    #[inline(always)]
    pub(crate) fn activation<T: Real>(&self, tau: T) -> T {
        if self.exponential {
            tau.exp() * (0.5 * self.gamma0)
        } else {
            tau.sinh() * self.gamma0
        }
    }

    /// dpsi/dt
    #[inline(always)]
    pub(crate) fn evolution<T: Real>(&self, v: T, psi: T) -> T {
        psi * self.healing[1] + self.healing[0] - v.abs() * psi
    }
}
