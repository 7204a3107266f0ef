//! The paper's systems: one interface (11), two interfaces (19), the symmetric subspace of the latter, and the normal form
//! (39)-(40); and any other small system, written in Rust or read from a file.
//!
//! State (tau, w_1, w_2) with w = ln psi, so that psi stays positive by construction; everything dimensionless. [`scales`] alone knows metres and pascals.

#[cfg(target_arch = "x86_64")]
mod ageing_lanes;
#[cfg(target_arch = "x86_64")]
mod ageing_series;
mod alike;
mod batch;
pub mod classics;
mod difference_chart;
#[cfg(target_arch = "x86_64")]
mod difference_tangent;
mod in_states;
#[cfg(target_arch = "x86_64")]
mod lanes;
mod logarithmic;
pub mod normal_form;
mod ramp;
mod response;
pub mod scales;
#[cfg(target_arch = "x86_64")]
mod series;
mod single_interface;
mod slab;
mod slider;
mod smooth;
mod symmetric;
#[cfg(target_arch = "x86_64")]
mod tangent;
mod text_system;
mod two_interfaces;
mod unequal;

pub use alike::AlikeInterfaces;
#[doc(hidden)]
pub use batch::{BatchSolution, MAX_LANES, batch_solution};
pub use difference_chart::{DifferenceChart, from_difference_chart, to_difference_chart};
pub use ramp::{Ramp, alike_on_ramp, two_interfaces_on_ramp, unequal_interfaces_on_ramp};
pub use single_interface::SingleInterface;
pub use slider::Slider;
pub use smooth::Smooth;
pub use symmetric::Symmetric;
pub use text_system::{TextField, TextSystem};
pub use two_interfaces::TwoInterfaces;
pub use unequal::UnequalInterfaces;

use crate::error::Result;
use crate::field::{Parametrised, State, VectorField};
use crate::friction::{AnyLaw, Law, Parameters, positive, with_law};
use std::ops::{Mul, Sub};

/// The two control parameters of the paper: those of all systems of interfaces, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// V_H, the driving velocity in V*.
    Driving,
    /// K = k L / (a sigma), the stiffness.
    Stiffness,
}

/// The place of V_H among the parameters of interfaces, and in their plane.
pub const DRIVING: usize = Parameter::Driving.place();
/// The place of K.
pub const STIFFNESS: usize = Parameter::Stiffness.place();

impl Parameter {
    /// Their names.
    pub const LOADING: [&'static str; 2] = ["driving", "stiffness"];

    /// The names of all parameters of systems of interfaces: these two, and the constants of laws. A system has of these those that
    /// its law has ([`Law::constants`]).
    pub const NAMES: [&'static str; 7] = {
        let [driving, stiffness] = Parameter::LOADING;
        let [beta, gamma0, healing_time, residual_strength, damping] = Parameters::NAMES;
        [
            driving,
            stiffness,
            beta,
            gamma0,
            healing_time,
            residual_strength,
            damping,
        ]
    };

    /// The names of the parameters of a system whose interfaces have this law: the first ones of all, and the damping where there is one.
    pub fn names(law: &impl Law) -> &'static [&'static str] {
        const ALL: [&str; 7] = Parameter::NAMES;
        const DAMPED: [&[&str]; 2] = [
            &[ALL[0], ALL[1], ALL[2], ALL[3], ALL[6]],
            &[ALL[0], ALL[1], ALL[2], ALL[3], ALL[4], ALL[6]],
        ];
        let has = { *law }.constants().map(|constant| constant.is_some());
        match has {
            [_, _, true, true, true] => &Parameter::NAMES,
            [_, _, true, _, true] => DAMPED[1],
            [.., true] => DAMPED[0],
            _ => {
                let constants = has.iter().filter(|&&has| has).count();
                &Parameter::NAMES[..Parameter::LOADING.len() + constants]
            }
        }
    }

    /// The places of V_H and K.
    pub const PLANE: [usize; 2] = [DRIVING, STIFFNESS];

    /// The place of this one among the parameters of a system of interfaces.
    pub const fn place(self) -> usize {
        self as usize
    }
}

/// Interfaces under one stress.
pub trait Driven<const N: usize>: VectorField<N> + Parametrised<N> {
    /// The slip rates of both interfaces, in V*; a single one stands in both places.
    fn slip_rates(&self, y: &State<N>) -> [f64; 2];
}

/// V_H and K, checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loading {
    /// V_H in V*.
    pub driving: f64,
    /// K in a sigma / L.
    pub stiffness: f64,
}

impl Loading {
    /// # Errors
    /// [`crate::error::Error::Parameter`] unless both are positive and finite.
    pub fn new(driving: f64, stiffness: f64) -> Result<Self> {
        Ok(Loading {
            driving: positive("driving", driving)?,
            stiffness: positive("stiffness", stiffness)?,
        })
    }
}

impl From<Loading> for [f64; 2] {
    /// In the order of [`Parameter::LOADING`].
    fn from(Loading { driving, stiffness }: Loading) -> Self {
        [driving, stiffness]
    }
}

/// dtau/dt = K (V_H - v), from (V_H, K) and the slip rate of the whole slab  (11), (19)
#[inline(always)]
fn stress_rate<T: Sub<Output = T> + Mul<Output = T>>(
    (driving, stiffness): (T, T),
    slip_rate: T,
) -> T {
    stiffness * (driving - slip_rate)
}

/// Two interfaces (19) with a law chosen at run time, compiled for that law.
pub fn two_interfaces(law: AnyLaw, loading: Loading) -> Box<dyn Driven<3>> {
    with_law!(law, law => Box::new(TwoInterfaces { law, loading }))
}

/// Two interfaces (19) in (tau, ln psi_2, ln(psi_1 - psi_2)) with a law chosen at run time.
pub fn interfaces_in_difference_chart(law: AnyLaw, loading: Loading) -> Box<dyn Driven<3>> {
    Box::new(DifferenceChart::new(&law).at(&loading))
}

/// The symmetric subspace of (19) with a law chosen at run time.
pub fn symmetric(law: AnyLaw, loading: Loading) -> Box<dyn Driven<2>> {
    with_law!(law, law => Box::new(Symmetric::new(law, loading)))
}

/// One interface (11) with a law chosen at run time.
pub fn single_interface(law: AnyLaw, loading: Loading) -> Box<dyn Driven<2>> {
    with_law!(law, law => Box::new(SingleInterface { law, loading }))
}
