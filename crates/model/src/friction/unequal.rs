//! Two interfaces that differ: the constants of each, and their laws in the units of the first.
//!
//! Stress is measured in a_1 sigma_1, slip rate in V* and time in L_1/V*. Where L_1, sigma_1 or a_1 varies the units are those of some
//! fixed L, sigma and a instead ([`UnequalLaws::measured_in`]), and l_1 and n_1 need not be 1. Of interface i, with n_i = sigma_i/sigma,
//! l_i = L_i/L and q_i = a/(n_i a_i), v_i = law_i(q_i (tau - eta v_i), psi_i), and its state evolves as that of its law at the slip rate v_i/l_i. The
//! strength is that of its own slip length ([`Parameters::of_slip_length`]), and so the friction of steady sliding at V* its own a_v. In
//! u_i = v_i/l_i that is the law itself with gamma0_i/l_i in place of gamma0_i and q_i eta l_i in place of eta: see [`ScaledLaw`].

use super::{AnyLaw, Law, Parameters, Rounded, ScaledLaw, positive};
use crate::error::{Error, Result};
use crate::number::{Free, Real};

/// The constants of one interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterfaceConstants {
    /// R = t** V*/L.
    pub healing_time: f64,
    /// c.
    pub residual_strength: f64,
    /// a.
    pub direct_effect: f64,
    /// b.
    pub evolution_effect: f64,
    /// a_v.
    pub reference_friction: f64,
    /// L_i/L, in units of the first interface L_i/L_1.
    pub slip_length: f64,
    /// sigma_i/sigma, in units of the first interface sigma_i/sigma_1.
    pub normal_stress: f64,
}

/// So many constants an interface has.
const COUNT: usize = InterfaceConstants::NAMES.len();

impl InterfaceConstants {
    /// Their names.
    pub const NAMES: [&'static str; 7] = [
        "healing_time",
        "residual_strength",
        "direct_effect",
        "evolution_effect",
        "reference_friction",
        "slip_length",
        "normal_stress",
    ];

    /// Those of the paper.
    pub fn heslot_1994() -> Self {
        [100.0, 1e-3, 0.0349, 0.0489, 0.369, 1.0, 1.0].into()
    }
}

impl From<[f64; COUNT]> for InterfaceConstants {
    /// In the order of [`InterfaceConstants::NAMES`].
    fn from(all: [f64; COUNT]) -> Self {
        let [
            healing_time,
            residual_strength,
            direct_effect,
            evolution_effect,
            reference_friction,
            slip_length,
            normal_stress,
        ] = all;
        InterfaceConstants {
            healing_time,
            residual_strength,
            direct_effect,
            evolution_effect,
            reference_friction,
            slip_length,
            normal_stress,
        }
    }
}

impl From<InterfaceConstants> for [f64; COUNT] {
    fn from(of: InterfaceConstants) -> Self {
        [
            of.healing_time,
            of.residual_strength,
            of.direct_effect,
            of.evolution_effect,
            of.reference_friction,
            of.slip_length,
            of.normal_stress,
        ]
    }
}

/// The laws of two interfaces that differ in their constants, checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnequalLaws {
    constants: [InterfaceConstants; 2],
    damping: f64,
    /// The a of the unit of stress, where it is not that of the first interface.
    unit: Option<f64>,
    laws: [ScaledLaw; 2],
}

impl UnequalLaws {
    /// The law of this name with the constants of both interfaces, and the radiation damping eta V*/(a_1 sigma_1) that both have.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name, and for a value outside its domain, with the index of the interface.
    pub fn new(law: &str, constants: [InterfaceConstants; 2], damping: f64) -> Result<Self> {
        Self::in_unit(law, constants, damping, None)
    }

    /// The laws with these constants and this damping, with stress in the same unit.
    ///
    /// # Errors
    /// As [`UnequalLaws::new`].
    pub fn with(&self, constants: [InterfaceConstants; 2], damping: f64) -> Result<Self> {
        Self::in_unit(self.name(), constants, damping, self.unit)
    }

    /// The laws with stress in a sigma of this a, whatever a_1 is.
    ///
    /// # Errors
    /// As [`UnequalLaws::new`].
    pub fn measured_in(&self, direct_effect: f64) -> Result<Self> {
        let unit = Some(positive("direct_effect", direct_effect)?);
        Self::in_unit(self.name(), self.constants, self.damping, unit)
    }

    fn in_unit(
        law: &str,
        constants: [InterfaceConstants; 2],
        damping: f64,
        unit: Option<f64>,
    ) -> Result<Self> {
        let mut laws = Vec::with_capacity(constants.len());
        for (i, own) in constants.iter().enumerate() {
            let indexed = |error| of_interface(error, i + 1);
            let plain = Parameters::new(
                own.direct_effect,
                own.evolution_effect,
                own.reference_friction,
                own.healing_time,
                own.residual_strength,
            );
            plain.map_err(indexed)?;
            for (name, value) in [
                ("slip_length", own.slip_length),
                ("normal_stress", own.normal_stress),
            ] {
                positive(name, value).map_err(indexed)?;
            }
            let heals = AnyLaw::named(law, Parameters::heslot_1994())?.bounds_state();
            let unit = unit.or((i > 0).then_some(constants[0].direct_effect));
            let (parameters, factors) = in_units(unit, &(*own).into(), damping, heals);
            let [stress_factor, slip_rate_factor] = factors;
            let numbers = [parameters.gamma0, parameters.beta, stress_factor];
            if !numbers.iter().all(|x| x.is_normal()) {
                let what = "a value whose ratio to that of the first interface is within the range of doubles";
                return Err(of_interface(
                    Error::parameter("direct_effect", own.direct_effect, what),
                    i + 1,
                ));
            }
            laws.push(ScaledLaw {
                law: AnyLaw::named(law, parameters.damped(parameters.damping)?)?,
                stress_factor,
                slip_rate_factor,
            });
        }
        Ok(UnequalLaws {
            constants,
            damping,
            unit,
            laws: [laws[0], laws[1]],
        })
    }

    /// The constants of each interface.
    pub fn constants(&self) -> &[InterfaceConstants; 2] {
        &self.constants
    }

    /// eta V*/(a sigma).
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// The a of the unit of stress.
    pub fn unit_of_stress(&self) -> f64 {
        self.unit.unwrap_or(self.constants[0].direct_effect)
    }

    /// The law of each interface in the common units.
    pub fn laws(&self) -> &[ScaledLaw; 2] {
        &self.laws
    }

    /// The name of the law of both.
    pub fn name(&self) -> &'static str {
        self.laws[0].name()
    }

    /// The same laws with these constants, in the order of [`InterfaceConstants::NAMES`], and this damping, as numbers in which they have
    /// derivatives.
    pub fn freed<T: Real>(
        &self,
        constants: &[[T; COUNT]; 2],
        damping: T,
    ) -> [ScaledLaw<Free<T>>; 2] {
        std::array::from_fn(|i| {
            let heals = self.laws[i].law.bounds_state();
            let unit = self.unit.map(T::constant);
            let [_, _, a_1, ..] = constants[0];
            let unit = unit.or((i > 0).then_some(a_1));
            let (made, factors) = in_units(unit, &constants[i], damping, heals);
            let [stress_factor, slip_rate_factor] = factors.map(Free);
            let parameters = Parameters::from([
                made.beta,
                made.gamma0,
                made.healing_time,
                made.residual_strength,
                made.damping,
            ]);
            ScaledLaw {
                law: self.laws[i].law.freed(parameters),
                stress_factor,
                slip_rate_factor,
            }
        })
    }

    /// The mean of the steady stresses of both interfaces at half of V_H.
    pub fn half_driving_stress(&self, driving: f64) -> f64 {
        let [first, second] = self
            .laws
            .map(|law| super::steady_stress(&law, 0.5 * driving));
        0.5 * (first + second)
    }
}

impl Rounded for UnequalLaws {
    fn changed(&self) -> Vec<(UnequalLaws, f64)> {
        let mut all = Vec::new();
        for (i, law) in self.laws.iter().enumerate() {
            for (law, part) in law.changed() {
                let mut other = *self;
                other.laws[i] = law;
                all.push((other, part));
            }
        }
        all
    }
}

/// The parameters of a law in u = v/l, and q and l. Without the a of a unit of stress the unit has the interface's own.
fn in_units<T: Real>(
    unit: Option<T>,
    own: &[T; COUNT],
    damping: T,
    heals_in_finite_time: bool,
) -> (Parameters<T>, [T; 2]) {
    let [healing_time, residual_strength, a, b, a_v, l, n] = *own;
    let stress_factor = match unit {
        None => T::constant(1.0) / n,
        Some(unit) => unit / (n * a),
    };
    let parameters = Parameters {
        beta: b / a,
        gamma0: (-a_v / a).exp() * 2.0,
        healing_time,
        residual_strength,
        damping: damping * stress_factor * l,
    };
    let own = parameters.of_slip_length(l, heals_in_finite_time);
    let in_own_rate = Parameters {
        gamma0: own.gamma0 / l,
        ..own
    };
    (in_own_rate, [stress_factor, l])
}

/// The same error, with the name of the parameter of this interface.
fn of_interface(error: Error, index: usize) -> Error {
    match error {
        Error::Parameter { name, value, must } => Error::Parameter {
            name: format!("{}_{index}", name.replace('-', "_")),
            value,
            must,
        },
        other => other,
    }
}
