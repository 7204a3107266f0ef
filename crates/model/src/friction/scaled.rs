//! A law in other units than its own: what an interface has beside another one, in whose units stress, time and slip are measured.
//!
//! With q, the other interface's a sigma over this one's, and l, this one's L over the other's, v = l u and tau = (tau of the law)/q: both in
//! the law's own formulas, u = law(q tau, psi), dpsi/dt = -G(u, psi).

use super::rounding::{CHANGE, ROUNDING};
use super::{
    AnyLaw, Formulas, Law, Parameters, Rounded, StiffnessMaximum, critical_stiffness_maximum,
};
use crate::error::Result;
use crate::number::{Constant, Free, Real, Uncertain, With};

/// v = l law(q tau, psi), dpsi/dt = -G(v/l, psi).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaledLaw<C = f64> {
    /// The law in units of its own.
    pub law: AnyLaw<C>,
    /// q, the stress of the law over that outside.
    pub stress_factor: C,
    /// l, the slip rate outside over that of the law.
    pub slip_rate_factor: C,
}

impl From<AnyLaw> for ScaledLaw {
    /// The law in its own units, to the bit.
    fn from(law: AnyLaw) -> Self {
        ScaledLaw {
            law,
            stress_factor: 1.0,
            slip_rate_factor: 1.0,
        }
    }
}

impl ScaledLaw {
    /// The largest critical stiffness, in the units outside: that of the law over q l, at l times its rate.
    ///
    /// # Errors
    /// As [`critical_stiffness_maximum`].
    pub fn critical_stiffness_maximum(&self) -> Result<Option<StiffnessMaximum>> {
        let stiffness = 1.0 / (self.stress_factor * self.slip_rate_factor);
        let own = critical_stiffness_maximum(&self.law)?;
        Ok(own.map(|own| StiffnessMaximum {
            slip_rate: times(own.slip_rate, self.slip_rate_factor),
            stiffness: times(own.stiffness, stiffness),
        }))
    }
}

/// A number in another unit: beside its own error that of the factor, which is known to three roundings, and its own rounding.
fn times(x: Uncertain, factor: f64) -> Uncertain {
    if factor == 1.0 {
        return x;
    }
    let value = factor * x.value;
    let rounding = 2.0 * f64::EPSILON * value.abs();
    Uncertain::new(value, factor * x.uncertainty + rounding)
}

impl<C: Constant> ScaledLaw<C> {
    #[inline(always)]
    fn own_rate<T: With<C>>(&self, v: T) -> T {
        v.over(self.slip_rate_factor)
    }
}

impl<C: Constant> Formulas<C> for ScaledLaw<C> {
    #[inline(always)]
    fn activation<T: With<C>>(&self, tau: T) -> T {
        self.law.activation(tau.times(self.stress_factor))
    }

    #[inline(always)]
    fn slip_rate<T: With<C>>(&self, activation: T, psi: T) -> T {
        self.law
            .slip_rate(activation, psi)
            .times(self.slip_rate_factor)
    }

    fn log_strength<T: With<C>>(&self, psi: T) -> T {
        self.law.log_strength(psi)
    }

    fn compliance<T: With<C>>(&self, v: T, log_strength: T) -> T {
        let own = self.law.compliance(self.own_rate(v), log_strength);
        own.times(self.stress_factor).times(self.slip_rate_factor)
    }

    fn stress<T: With<C>>(&self, v: T, psi: T) -> T {
        self.law
            .stress(self.own_rate(v), psi)
            .over(self.stress_factor)
    }

    #[inline(always)]
    fn evolution<T: With<C>>(&self, v: T, psi: T) -> T {
        self.law.evolution(self.own_rate(v), psi)
    }

    fn steady_state<T: With<C>>(&self, v: T) -> T {
        self.law.steady_state(self.own_rate(v))
    }
}

impl Law for ScaledLaw {
    type Freed<T: Real> = ScaledLaw<Free<T>>;

    fn freed<T: Real>(&self, constants: Parameters<Free<T>>) -> ScaledLaw<Free<T>> {
        ScaledLaw {
            law: self.law.freed(constants),
            stress_factor: Free::fixed(self.stress_factor),
            slip_rate_factor: Free::fixed(self.slip_rate_factor),
        }
    }

    fn name(&self) -> &'static str {
        Law::name(&self.law)
    }

    fn constants(&mut self) -> [Option<&mut f64>; Parameters::NAMES.len()] {
        self.law.constants()
    }

    // eta v of the stress outside is q eta l u of the law's own
    fn damping(&self) -> f64 {
        self.law.damping() / (self.stress_factor * self.slip_rate_factor)
    }

    /// With the factor of the slip rate, as v = s(tau)/h(psi) is that outside; with damping ln(q tau).
    fn log_activation(&self, tau: f64) -> f64 {
        let own = self.law.log_activation(self.stress_factor * tau);
        if self.law.damping() == 0.0 {
            own + self.slip_rate_factor.ln()
        } else {
            own
        }
    }

    fn steady_extrema(&self) -> Vec<f64> {
        let outside = |u: f64| u * self.slip_rate_factor;
        self.law.steady_extrema().into_iter().map(outside).collect()
    }

    fn weakens_from_rest(&self) -> bool {
        self.law.weakens_from_rest()
    }

    fn bounds_state(&self) -> bool {
        self.law.bounds_state()
    }

    fn lasts(&self) -> bool {
        self.law.lasts()
    }

    fn transition_rate(&self) -> Option<f64> {
        let outside = |u: f64| u * self.slip_rate_factor;
        self.law.transition_rate().map(outside)
    }
}

impl Rounded for ScaledLaw {
    fn changed(&self) -> Vec<(ScaledLaw, f64)> {
        let of_law = self.law.changed().into_iter();
        let mut all: Vec<_> = of_law
            .map(|(law, part)| (ScaledLaw { law, ..*self }, part))
            .collect();
        for (stress, slip_rate) in [(CHANGE, 0.0), (0.0, CHANGE)] {
            let other = ScaledLaw {
                stress_factor: self.stress_factor * (1.0 + stress),
                slip_rate_factor: self.slip_rate_factor * (1.0 + slip_rate),
                ..*self
            };
            all.push((other, ROUNDING / CHANGE));
        }
        all
    }
}
