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

/// v and g = dpsi/dt with their derivatives in tau and psi.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slopes<T> {
    pub v: T,
    pub v_tau: T,
    pub v_psi: T,
    pub g: T,
    pub g_tau: T,
    pub g_psi: T,
}

impl LawForm {
    /// The law with its first derivatives written out, in half the operations that jets take, and half the code: it is compiled into
    /// the series of tangents. Tests hold it to jets of the laws' own formulas.
    ///
    /// With u = eta v = g(y), y + g(y) = tau, and dg/dy = s'(y) eta/h: du/dtau = (dg/dy) / (1 + dg/dy), du/dpsi = -(u/h) (dh/dpsi) / (1 +
    /// dg/dy).
    #[inline(always)]
    pub(crate) fn slopes<T: Real>(&self, tau: T, psi: T) -> Slopes<T> {
        let AgeingForm {
            strength: [_, linear],
            healing: [_, growth],
            beta,
            gamma0,
            exponential,
        } = self.ageing;
        let a = self.ageing.linear_strength(psi);
        let weakness = a.powf(-beta);
        let (v, v_tau, v_psi) = if self.damping == 0.0 {
            let (v, v_tau) = if exponential {
                let v = weakness * tau.exp() * (0.5 * gamma0);
                (v, v)
            } else {
                let (sinh, cosh) = tau.sinh_cosh();
                (weakness * sinh * gamma0, weakness * cosh * gamma0)
            };
            (v, v_tau, v / a * -(beta * linear))
        } else {
            let rate = weakness * gamma0 * self.damping;
            let (u, slope) = if exponential {
                let u = tau.balanced(Balance::Exponential(rate * 0.5)).1;
                (u, u)
            } else {
                let (y, u) = tau.balanced(Balance::Sinh(rate));
                (u, rate * y.cosh())
            };
            let whole = slope + 1.0;
            (
                u / self.damping,
                slope / whole / self.damping,
                u / (a * whole) * -(beta * linear / self.damping),
            )
        };
        let (g, g_tau, g_psi) = if self.slip_law {
            let x = v * psi;
            let log = x.ln();
            let falls = -(log + 1.0);
            (-(x * log), falls * psi * v_tau, falls * (v + psi * v_psi))
        } else {
            let sign = v.sign();
            let magnitude = v * sign;
            (
                self.ageing.evolution(v, psi),
                -(v_tau * psi * sign),
                -(v_psi * psi * sign) - magnitude + growth,
            )
        };
        Slopes {
            v,
            v_tau,
            v_psi,
            g,
            g_tau,
            g_psi,
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

    /// v
    #[inline(always)]
    pub(crate) fn slip_rate<T: Real>(&self, activation: T, psi: T) -> T {
        activation * self.weakness(psi)
    }

    /// dpsi/dt
    #[inline(always)]
    pub(crate) fn evolution<T: Real>(&self, v: T, psi: T) -> T {
        psi * self.healing[1] + self.healing[0] - v.abs() * psi
    }
}
