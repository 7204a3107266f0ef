//! Radiation damping: a slip rate v radiates seismic waves, which take eta v of the stress, so that tau - eta v stands in the place of
//! tau in a law (Rice 1993).
//!
//! v is then defined by an equation. With the direct effect v = s(y)/h(psi) of the stress y = tau - eta v that is left,
//! y + (eta/h) s(y) = tau: see [`Balance`].
//!
//! Rice, J. R. (1993). Spatio-temporal complexity of slip on a fault. J. Geophys. Res. 98, 9885-9907.

use super::{Formulas, Law, LawForm, Parameters, Undamped, steady_log_slope, with_undamped};
use crate::number::{Balance, Constant, Free, Jet, Real, With, bracketed_root};

/// tau = F(v, psi) + eta v, dpsi/dt = -G(v, psi), with F and G of another law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damped<C = f64> {
    law: Undamped,
    constants: Parameters<C>,
}

impl<C> Damped<C> {
    pub(super) fn new(law: Undamped, constants: Parameters<C>) -> Self {
        Damped { law, constants }
    }
}

impl Damped {
    /// The same law with these constants.
    pub(super) fn of_kind<T: Real>(&self, constants: Parameters<Free<T>>) -> Damped<Free<T>> {
        Damped::new(self.law, constants)
    }
}

impl<C: Constant> Formulas<C> for Damped<C> {
    /// tau itself: interfaces under the same stress share no more.
    #[inline(always)]
    fn activation<T: With<C>>(&self, tau: T) -> T {
        tau
    }

    // eta v is (eta/h) s(y) of the y with y + (eta/h) s(y) = tau, where s is gamma0 sinh, or half of gamma0 exp
    #[inline(always)]
    fn slip_rate<T: With<C>>(&self, tau: T, psi: T) -> T {
        let Parameters {
            gamma0, damping, ..
        } = self.constants;
        let one = T::constant(1.0);
        let (weakness, exponential) = with_undamped!(self.law, self.constants, law => {
            (law.slip_rate(one, psi), is_exponential(&law))
        });
        let rate = weakness.times(gamma0).times(damping);
        let g = if exponential {
            Balance::Exponential(rate * 0.5)
        } else {
            Balance::Sinh(rate)
        };
        tau.balanced(g).1.over(damping)
    }

    fn log_strength<T: With<C>>(&self, psi: T) -> T {
        with_undamped!(self.law, self.constants, law => law.log_strength(psi))
    }

    // 1 / (F_V + eta)
    fn compliance<T: With<C>>(&self, v: T, log_strength: T) -> T {
        let alone =
            with_undamped!(self.law, self.constants, law => law.compliance(v, log_strength));
        let one = T::constant(1.0);
        one / (one / alone).plus(self.constants.damping)
    }

    fn stress<T: With<C>>(&self, v: T, psi: T) -> T {
        let alone = with_undamped!(self.law, self.constants, law => law.stress(v, psi));
        alone + v.times(self.constants.damping)
    }

    #[inline(always)]
    fn evolution<T: With<C>>(&self, v: T, psi: T) -> T {
        with_undamped!(self.law, self.constants, law => law.evolution(v, psi))
    }

    fn steady_state<T: With<C>>(&self, v: T) -> T {
        with_undamped!(self.law, self.constants, law => law.steady_state(v))
    }
}

impl Damped {
    /// The law in the constants that its power series are made from.
    pub(super) fn form(&self) -> LawForm {
        let form = with_undamped!(self.law, self.constants, law => law.form());
        LawForm {
            damping: self.constants.damping,
            ..form
        }
    }
}

impl Law for Damped {
    type Freed<T: Real> = Damped<Free<T>>;

    fn freed<T: Real>(&self, constants: Parameters<Free<T>>) -> Damped<Free<T>> {
        self.of_kind(constants)
    }

    fn name(&self) -> &'static str {
        with_undamped!(self.law, self.constants, law => law.name())
    }

    fn constants(&mut self) -> [Option<&mut f64>; Parameters::NAMES.len()] {
        let has = with_undamped!(self.law, self.constants, law => {
            let mut law = law;
            law.constants().map(|constant| constant.is_some())
        });
        let Parameters {
            beta,
            gamma0,
            healing_time,
            residual_strength,
            damping,
        } = &mut self.constants;
        let mut all = [beta, gamma0, healing_time, residual_strength]
            .into_iter()
            .zip(has)
            .map(|(constant, has)| has.then_some(constant));
        let mut next = || all.next().flatten();
        [next(), next(), next(), next(), Some(damping)]
    }

    fn damping(&self) -> f64 {
        self.constants.damping
    }

    /// ln tau: what equal stresses have in common.
    fn log_activation(&self, tau: f64) -> f64 {
        tau.ln()
    }

    // tau_ss falls where the friction alone falls faster than eta V rises: between V_M and V_m of the former, or from rest on. There
    // E(V) = -(d tau_ss/dV of the friction) has one maximum, or falls from rest on, and is at most (beta - 1)/V.
    fn steady_extrema(&self) -> Vec<f64> {
        let alone = with_undamped!(self.law, self.constants, law => law.steady_extrema());
        let beyond = 2.0 * (self.constants.beta - 1.0) / self.constants.damping;
        if self.weakens_from_rest() {
            return self
                .extremum(beyond * f64::EPSILON, beyond)
                .into_iter()
                .collect();
        }
        let (peak, trough) = match alone[..] {
            [peak, trough] => (peak, trough),
            [peak] => (peak, beyond.max(2.0 * peak)),
            _ => return Vec::new(),
        };
        let Some(steepest) = self.steepest(peak, trough) else {
            return Vec::new();
        };
        if steady_log_slope(self, steepest) >= 0.0 {
            return Vec::new();
        }
        let both = [
            self.extremum(peak, steepest),
            self.extremum(steepest, trough),
        ];
        both.into_iter().flatten().collect()
    }

    fn weakens_from_rest(&self) -> bool {
        self.constants.beta > 1.0 && !self.bounds_state()
    }

    fn bounds_state(&self) -> bool {
        with_undamped!(self.law, self.constants, law => law.bounds_state())
    }

    // The slip rate keeps the sign of the stress.
    fn lasts(&self) -> bool {
        with_undamped!(self.law, self.constants, law => law.lasts())
    }

    fn transition_rate(&self) -> Option<f64> {
        with_undamped!(self.law, self.constants, law => law.transition_rate())
    }
}

impl Damped {
    /// The one zero of d tau_ss/dV between these rates.
    fn extremum(&self, low: f64, high: f64) -> Option<f64> {
        let slope = |x: f64| {
            let slope = steady_log_slope(self, Jet::<f64, 1>::variable(x, 0).exp());
            (slope.value, slope.gradient[0])
        };
        let root = bracketed_root(
            "an extremum of the steady stress",
            low.ln(),
            high.ln(),
            slope,
        );
        root.ok().map(f64::exp)
    }

    /// Where the friction alone weakens most steeply with V between its extrema.
    fn steepest(&self, peak: f64, trough: f64) -> Option<f64> {
        let slope = |x: f64| {
            let v = Jet::<_, 1>::variable(Jet::<f64, 1>::variable(x, 0), 0).exp();
            // -d tau_ss/dV = -(d ln s/d ln V) F_V
            let steepness = with_undamped!(self.law, self.constants, law => {
                let strength = law.log_strength(law.steady_state(v));
                -(steady_log_slope(&law, v) / law.compliance(v, strength))
            });
            (
                steepness.gradient[0].value,
                steepness.gradient[0].gradient[0],
            )
        };
        // At the extrema themselves it is zero, and rises and falls.
        let root = bracketed_root("the steepest weakening", peak.ln(), trough.ln(), slope);
        root.ok().map(f64::exp)
    }
}

/// [`Formulas::EXPONENTIAL`] of a law.
#[inline(always)]
fn is_exponential<C, F: Formulas<C>>(_: &F) -> bool {
    F::EXPONENTIAL
}
