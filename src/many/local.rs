//! One interface at one instant: its slip rate, how its state evolves, and the derivatives of both.

use super::constants::{Constants, Kind};
use crate::number::Balance;

/// What one interface does under a stress tau in a state w = ln psi.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Local {
    /// v
    pub rate: f64,
    /// dv/dtau
    pub rate_by_stress: f64,
    /// dv/dw
    pub rate_by_log: f64,
    /// dw/dt
    pub evolution: f64,
    /// Its derivative in tau.
    pub evolution_by_stress: f64,
    /// Its derivative in w.
    pub evolution_by_log: f64,
}

/// z with z + a s(z) = x.
#[inline(always)]
pub(super) fn balanced(exponential: bool, a: f64, x: f64) -> f64 {
    match (exponential, a) {
        (_, 0.0) => x,
        (true, a) => Balance::Exponential(a).solve(x),
        (false, a) => Balance::Sinh(a).solve(x),
    }
}

/// s(z) and its derivative.
#[inline(always)]
fn activation(exponential: bool, z: f64) -> (f64, f64) {
    if exponential {
        let s = z.exp();
        (s, s)
    } else {
        (z.sinh(), z.cosh())
    }
}

/// tau, with s(tau) and its derivative, which all interfaces share that have no stress of their own.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stress {
    tau: f64,
    activation: (f64, f64),
}

impl Stress {
    pub fn new(kind: Kind, tau: f64) -> Self {
        Stress {
            tau,
            activation: activation(kind.exponential, tau),
        }
    }
}

impl Constants {
    /// The strength x of a state, or ln psi where the slip law holds.
    pub fn strength(&self, kind: Kind, psi: f64, lane: usize) -> f64 {
        if kind.slip {
            psi.ln()
        } else {
            self.rest[lane] + self.slope[lane] * psi
        }
    }

    /// psi of a strength.
    #[inline(always)]
    pub fn state(&self, kind: Kind, strength: f64, lane: usize) -> f64 {
        if kind.slip {
            strength.exp()
        } else {
            (strength - self.rest[lane]) / self.slope[lane]
        }
    }

    /// s(z) and its derivative of a lane with this weakness f x^(-beta).
    #[inline(always)]
    fn activation(&self, kind: Kind, lane: usize, (stress, weakness): (Stress, f64)) -> (f64, f64) {
        if !kind.own_stress {
            return stress.activation;
        }
        let own = self.stress_factor[lane] * stress.tau;
        let z = balanced(kind.exponential, self.damping[lane] * weakness, own);
        activation(kind.exponential, z)
    }

    /// v of a lane with this strength.
    #[inline(always)]
    pub fn slip_rate(&self, kind: Kind, lane: usize, (stress, strength): (Stress, f64)) -> f64 {
        let weakness = self.weakness(kind, strength, lane);
        weakness * self.activation(kind, lane, (stress, weakness)).0
    }

    /// f x^(-beta)
    #[inline(always)]
    fn weakness(&self, kind: Kind, strength: f64, lane: usize) -> f64 {
        let power = if kind.slip {
            (-self.beta[lane] * strength).exp()
        } else {
            strength.powf(-self.beta[lane])
        };
        self.factor[lane] * power
    }

    /// What a lane does, with all derivatives.
    #[inline(always)]
    pub fn linearised(&self, kind: Kind, lane: usize, (stress, w): (Stress, f64)) -> Local {
        let factor = self.factor[lane];
        if factor == 0.0 {
            return Local::default();
        }
        let psi = w.exp();
        let strength = if kind.slip {
            w
        } else {
            self.rest[lane] + self.slope[lane] * psi
        };
        let weakness = self.weakness(kind, strength, lane);
        // d ln(weakness)/dw
        let weakening = if kind.slip {
            -self.beta[lane]
        } else {
            -self.beta[lane] * self.slope[lane] * psi / strength
        };
        let (q, damping) = (self.stress_factor[lane], self.damping[lane]);
        let (s, slope) = self.activation(kind, lane, (stress, weakness));
        let v = weakness * s;
        let stiff = weakness * slope;
        // dv = s d(weakness) + weakness s' dz with dz = q (dtau - eta dv)
        let share = 1.0 / (1.0 + damping * stiff);
        let (by_stress, by_log) = (stiff * q * share, v * weakening * share);
        let per_length = self.per_length[lane];
        // dw/dt in v at constant w, and in w at constant v
        let (evolution, by_rate, alone) = if kind.slip {
            let u = v * per_length;
            let log = u.ln() + w;
            (-u * log, -per_length * (log + 1.0), -u)
        } else {
            let healing = self.source[lane] / psi;
            let worn = v.abs() * per_length;
            let by_rate = -per_length.copysign(v);
            (healing + self.relaxation[lane] - worn, by_rate, -healing)
        };
        Local {
            rate: v,
            rate_by_stress: by_stress,
            rate_by_log: by_log,
            evolution,
            evolution_by_stress: by_rate * by_stress,
            evolution_by_log: alone + by_rate * by_log,
        }
    }

    /// v and dw/dt of a lane.
    #[inline(always)]
    pub fn rates(&self, kind: Kind, lane: usize, (stress, w): (Stress, f64)) -> [f64; 2] {
        if self.factor[lane] == 0.0 {
            return [0.0; 2];
        }
        let psi = w.exp();
        let strength = if kind.slip {
            w
        } else {
            self.rest[lane] + self.slope[lane] * psi
        };
        let v = self.slip_rate(kind, lane, (stress, strength));
        let u = v * self.per_length[lane];
        let evolution = if kind.slip {
            -u * (u.ln() + w)
        } else {
            self.source[lane] / psi + self.relaxation[lane] - u.abs()
        };
        [v, evolution]
    }

    /// The sizes of what dw/dt of a lane is made of, added up.
    pub fn turnover(&self, kind: Kind, lane: usize, (stress, w): (Stress, f64)) -> f64 {
        let [v, _] = self.rates(kind, lane, (stress, w));
        let u = (v * self.per_length[lane]).abs();
        if kind.slip {
            u * (1.0 + u.ln().abs() + w.abs())
        } else {
            self.source[lane] / w.exp() + self.relaxation[lane].abs() + u
        }
    }
}
