//! Between metres, seconds, pascals and the dimensionless system: stress in a sigma, slip rate in V*, length in L, time in L/V*.

use super::Loading;
use crate::error::Result;
use crate::friction::{Parameters, positive};

/// An interface as a laboratory describes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// a
    pub direct_effect: f64,
    /// b
    pub evolution_effect: f64,
    /// a_v, the friction coefficient at V*
    pub reference_friction: f64,
    /// L in m
    pub slip_length: f64,
    /// V* in m/s
    pub reference_rate: f64,
    /// sigma in Pa
    pub normal_stress: f64,
    /// t** in s
    pub healing_time: f64,
    /// c
    pub residual_strength: f64,
}

/// How the slab is driven, as a laboratory describes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Machine {
    /// V_H in m/s
    pub driving: f64,
    /// k = G/H in Pa/m
    pub stiffness: f64,
}

impl Material {
    /// The paper's constants, fitted to the experiments of Heslot et al. (1994) on Bristol board: a = 0.0349, b = 0.0489,
    /// a_v = 0.369, L = 0.9 um, V* = 1 um/s, t** = 100 L/V*, c = 1e-3. The paper states no normal stress; it only scales
    /// stress and stiffness, and is an argument here.
    pub fn heslot_1994(normal_stress: f64) -> Self {
        Material {
            direct_effect: 0.0349,
            evolution_effect: 0.0489,
            reference_friction: 0.369,
            slip_length: 0.9e-6,
            reference_rate: 1e-6,
            normal_stress,
            healing_time: 90.0,
            residual_strength: 1e-3,
        }
    }

    /// The dimensionless parameters and the units that lead back.
    ///
    /// # Errors
    /// [`crate::error::Error::Parameter`] for a value outside its domain.
    pub fn dimensionless(&self) -> Result<(Parameters, Scales)> {
        let scales = Scales::new(
            self.direct_effect,
            self.slip_length,
            self.reference_rate,
            self.normal_stress,
        )?;
        let healing_time = positive("healing-time", self.healing_time)? / scales.time;
        let parameters = Parameters::new(
            self.direct_effect,
            self.evolution_effect,
            self.reference_friction,
            healing_time,
            self.residual_strength,
        )?;
        Ok((parameters, scales))
    }
}

/// The units of the dimensionless system, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Scales {
    /// a sigma in Pa
    pub stress: f64,
    /// V* in m/s
    pub slip_rate: f64,
    /// L in m
    pub length: f64,
    /// L/V* in s
    pub time: f64,
    /// a sigma / L in Pa/m
    pub stiffness: f64,
    /// a: a dimensionless stress times this is a friction coefficient
    pub friction: f64,
}

impl Scales {
    /// From a, L in m, V* in m/s and sigma in Pa.
    ///
    /// # Errors
    /// [`crate::error::Error::Parameter`] unless all are positive and finite.
    pub fn new(
        direct_effect: f64,
        slip_length: f64,
        reference_rate: f64,
        normal_stress: f64,
    ) -> Result<Self> {
        let a = positive("direct-effect", direct_effect)?;
        let length = positive("slip-length", slip_length)?;
        let slip_rate = positive("reference-rate", reference_rate)?;
        let stress = a * positive("normal-stress", normal_stress)?;
        Ok(Scales {
            stress,
            slip_rate,
            length,
            time: length / slip_rate,
            stiffness: stress / length,
            friction: a,
        })
    }

    /// V_H and K from a machine.
    ///
    /// # Errors
    /// [`crate::error::Error::Parameter`] unless both are positive and finite.
    pub fn loading(&self, machine: &Machine) -> Result<Loading> {
        Loading::new(
            machine.driving / self.slip_rate,
            machine.stiffness / self.stiffness,
        )
    }

    /// The machine that loads so.
    pub fn machine(&self, loading: &Loading) -> Machine {
        Machine {
            driving: loading.driving * self.slip_rate,
            stiffness: loading.stiffness * self.stiffness,
        }
    }

    /// The material of these units and dimensionless parameters.
    pub fn material(&self, parameters: &Parameters) -> Material {
        Material {
            direct_effect: self.friction,
            evolution_effect: parameters.beta * self.friction,
            reference_friction: self.friction * (2.0 / parameters.gamma0).ln(),
            slip_length: self.length,
            reference_rate: self.slip_rate,
            normal_stress: self.stress / self.friction,
            healing_time: parameters.healing_time * self.time,
            residual_strength: parameters.residual_strength,
        }
    }
}
