//! The equations (19) once more, in either chart, for the crates that want them as closures.

use twinslip::friction::AnyLaw;
use twinslip::model::Loading;

/// What the state variables of an interface are.
#[derive(Clone, Copy, PartialEq)]
pub enum Chart {
    /// psi itself.
    Psi,
    /// ln psi.
    LnPsi,
}

impl Chart {
    /// From (tau, ln psi1, ln psi2).
    pub fn inward(self, y: [f64; 3]) -> [f64; 3] {
        match self {
            Chart::Psi => [y[0], y[1].exp(), y[2].exp()],
            Chart::LnPsi => y,
        }
    }

    /// To (tau, ln psi1, ln psi2).
    pub fn outward(self, y: [f64; 3]) -> [f64; 3] {
        match self {
            Chart::Psi => [y[0], y[1].ln(), y[2].ln()],
            Chart::LnPsi => y,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Chart::Psi => "psi",
            Chart::LnPsi => "ln psi",
        }
    }
}

/// v = a(tau) / (c + p psi)^beta, dpsi/dt = h - (q + v) psi, with a = gamma0 sinh(tau) or gamma0/2 exp(tau).
#[derive(Clone, Copy)]
pub struct Model {
    k: f64,
    v_h: f64,
    beta: f64,
    gamma0: f64,
    c: f64,
    p: f64,
    h: f64,
    q: f64,
    odd: bool,
    chart: Chart,
}

/// An interface: v, dx/dt, and their derivatives, that of dx/dt at constant v.
struct Response {
    v: f64,
    v_x: f64,
    g: f64,
    g_v: f64,
    g_x: f64,
}

impl Model {
    /// `None` for a law that the peers don't know.
    pub fn new(law: AnyLaw, loading: Loading, chart: Chart) -> Option<Self> {
        let (beta, gamma0, [c, p, h, q], odd) = match law {
            AnyLaw::Spinodal(law) => {
                let heal = 1.0 / law.r;
                let numbers = [law.c, 1.0 + law.r, heal, heal];
                (law.beta, law.gamma0, numbers, true)
            }
            AnyLaw::DieterichRuina(law) => (law.beta, law.gamma0, [0.0, 1.0, 1.0, 0.0], false),
            _ => return None,
        };
        Some(Model {
            k: loading.stiffness,
            v_h: loading.driving,
            beta,
            gamma0,
            c,
            p,
            h,
            q,
            odd,
            chart,
        })
    }

    /// a and da/dtau.
    fn activation(&self, tau: f64) -> (f64, f64) {
        if self.odd {
            (self.gamma0 * tau.sinh(), self.gamma0 * tau.cosh())
        } else {
            let a = 0.5 * self.gamma0 * tau.exp();
            (a, a)
        }
    }

    fn response(&self, a: f64, x: f64) -> Response {
        match self.chart {
            Chart::Psi => {
                let strength = self.c + self.p * x;
                let v = a / strength.powf(self.beta);
                Response {
                    v,
                    v_x: -v * self.beta * self.p / strength,
                    g: self.h - (self.q + v) * x,
                    g_v: -x,
                    g_x: -(self.q + v),
                }
            }
            Chart::LnPsi => {
                let psi = x.exp();
                let strength = self.c + self.p * psi;
                let v = a / strength.powf(self.beta);
                let heal = self.h / psi;
                Response {
                    v,
                    v_x: -v * self.beta * self.p * psi / strength,
                    g: heal - self.q - v,
                    g_v: -1.0,
                    g_x: -heal,
                }
            }
        }
    }

    /// The right-hand side.
    pub fn f(&self, y: [f64; 3]) -> [f64; 3] {
        let (a, _) = self.activation(y[0]);
        let (first, second) = (self.response(a, y[1]), self.response(a, y[2]));
        let slip = first.v + second.v;
        [self.k * (self.v_h - slip), first.g, second.g]
    }

    /// Its Jacobian by rows.
    pub fn jacobian(&self, y: [f64; 3]) -> [[f64; 3]; 3] {
        let (a, slope) = self.activation(y[0]);
        let relative = slope / a;
        let (first, second) = (self.response(a, y[1]), self.response(a, y[2]));
        let tau = |r: &Response| r.v * relative;
        [
            [
                -self.k * (tau(&first) + tau(&second)),
                -self.k * first.v_x,
                -self.k * second.v_x,
            ],
            [
                first.g_v * tau(&first),
                first.g_x + first.g_v * first.v_x,
                0.0,
            ],
            [
                second.g_v * tau(&second),
                0.0,
                second.g_x + second.g_v * second.v_x,
            ],
        ]
    }
}
