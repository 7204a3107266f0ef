//! A slider in the laboratory: one interface under a measured friction, loaded through the spring of the apparatus.
//!
//! In seconds and metres, unlike everything else here: what is fitted to measurements are a, b, L and the stiffness, and with
//! dimensionless time L would be the unit of all of it.

use crate::error::Result;
use crate::field::State;
use crate::friction::{AnyLaw, Formulas, Parameters, positive};
use crate::number::{Free, Real};
use crate::series::Equations;

/// dmu/dt = k (V - v), dw_i/dt = (V*/L_i) (dpsi_i/dt)/psi_i, dV/dt = A, in the state (mu, w_1, ..., V/V*) with the friction
/// coefficient mu = a tau and w_i = ln psi_i, psi_i in L_i/V*.
///
/// With two state variables the strengths are multiplied, v = s(tau)/(strength_1(psi_1) strength_2(psi_2)): for the plain laws tau =
/// a_v/a + ln v + (b_1/a) ln psi_1 + (b_2/a) ln psi_2 (Gu, Rice, Ruina and Tse 1984, J. Mech. Phys. Solids 32, 167-196).
///
/// Parameters: [`Slider::NAMES`], in SI; k is friction per metre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slider {
    /// Which law: its constants are parameters here, and those that it has do not count.
    pub law: AnyLaw,
    /// V* in m/s.
    pub reference_rate: f64,
    /// A, in V* per second.
    pub acceleration: f64,
}

/// How many parameters there are.
const COUNT: usize = Slider::NAMES.len();

impl Slider {
    /// The names of the parameters, those of a second state variable last.
    pub const NAMES: [&'static str; 9] = [
        "stiffness",
        "direct_effect",
        "evolution_effect",
        "slip_length",
        "reference_friction",
        "healing_time",
        "residual_strength",
        "evolution_effect_2",
        "slip_length_2",
    ];

    /// The law of the name, loaded at a steady velocity.
    ///
    /// # Errors
    /// [`crate::error::Error::Parameter`] for a name that no law has, and unless V* is positive and finite.
    pub fn new(law: &str, reference_rate: f64) -> Result<Self> {
        Ok(Slider {
            law: AnyLaw::named(law, Parameters::heslot_1994())?,
            reference_rate: positive("reference-rate", reference_rate)?,
            acceleration: 0.0,
        })
    }

    /// The law of each state variable at these parameters.
    fn laws<T: Real, const S: usize>(&self, parameters: [T; COUNT]) -> [StateLaw<T>; S] {
        let [_, a, b, length, a_v, healing_time, c, b_2, length_2] = parameters;
        let gamma0 = (-(a_v / a)).exp() * 2.0;
        std::array::from_fn(|i| {
            let (b, length) = if i == 0 { (b, length) } else { (b_2, length_2) };
            let rate = T::constant(self.reference_rate) / length;
            let constants = Parameters {
                beta: Free(b / a),
                gamma0: Free(gamma0),
                healing_time: Free(healing_time * rate),
                residual_strength: Free(c),
                damping: Free(T::constant(0.0)),
            };
            StateLaw {
                law: crate::friction::Law::freed(&self.law, constants),
                rate,
            }
        })
    }

    fn rates_of<T: Real, const S: usize>(
        &self,
        (friction, log_states, velocity): (T, [T; S], T),
        parameters: [T; COUNT],
    ) -> (T, [T; S], T) {
        let laws: [StateLaw<T>; S] = self.laws(parameters);
        let [stiffness, a, ..] = parameters;
        let states = log_states.map(|w| w.exp());
        let v = slip_rate(&laws, friction / a, states);
        let stress_rate = stiffness * self.reference_rate * (velocity - v);
        let evolution = std::array::from_fn(|i| {
            let StateLaw { law, rate } = laws[i];
            law.evolution(v, states[i]) / states[i] * rate
        });
        (stress_rate, evolution, T::constant(self.acceleration))
    }

    /// mu and the w_i of steady sliding at v V*.
    fn steady<const S: usize>(&self, parameters: [f64; COUNT], v: f64) -> (f64, [f64; S]) {
        let laws: [StateLaw<f64>; S] = self.laws(parameters);
        let states = laws.map(|StateLaw { law, .. }| law.steady_state(v));
        let others = (1..S).map(|i| laws[i].law.log_strength(states[i]));
        // s(tau) = v strength_1 strength_2
        let activated = v * others.sum::<f64>().exp();
        let [_, a, ..] = parameters;
        let friction = a * laws[0].law.stress(activated, states[0]);
        (friction, states.map(f64::ln))
    }

    /// Steady sliding at v V* with one state variable.
    pub fn steady_one(&self, parameters: [f64; COUNT], v: f64) -> State<3> {
        let (friction, [w]) = self.steady(parameters, v);
        State::from([friction, w, v])
    }

    /// Steady sliding at v V* with two state variables.
    pub fn steady_two(&self, parameters: [f64; COUNT], v: f64) -> State<4> {
        let (friction, [first, second]) = self.steady(parameters, v);
        State::from([friction, first, second, v])
    }
}

/// The law with one of the state variables, and V*/L of that.
#[derive(Debug, Clone, Copy)]
struct StateLaw<T: Real> {
    law: AnyLaw<Free<T>>,
    rate: T,
}

/// v = s(tau)/(strength_1 strength_2)
fn slip_rate<T: Real, const S: usize>(laws: &[StateLaw<T>; S], tau: T, states: [T; S]) -> T {
    let activation = laws[0].law.activation(tau);
    let each = laws.iter().zip(states);
    each.fold(activation, |v, (of, psi)| of.law.slip_rate(v, psi))
}

impl Equations<3, COUNT> for Slider {
    const PARAMETERS: [&'static str; COUNT] = Slider::NAMES;

    fn rates<T: Real>(&self, [mu, w, velocity]: [T; 3], parameters: [T; COUNT]) -> [T; 3] {
        let (mu, [w], velocity) = self.rates_of((mu, [w], velocity), parameters);
        [mu, w, velocity]
    }
}

impl Equations<4, COUNT> for Slider {
    const PARAMETERS: [&'static str; COUNT] = Slider::NAMES;

    fn rates<T: Real>(
        &self,
        [mu, first, second, velocity]: [T; 4],
        parameters: [T; COUNT],
    ) -> [T; 4] {
        let (mu, [first, second], velocity) =
            self.rates_of((mu, [first, second], velocity), parameters);
        [mu, first, second, velocity]
    }
}
