//! The equations of a part of a run, and the states among which it stays.
//!
//! The hand-written fields of two equal interfaces, in their plane too, stand behind [`Equations::field`].

use super::system::System;
use std::borrow::Cow;
use twinslip::error::Result;
use twinslip::integrate::{AnyField, MotionUnits};
use twinslip::model::{self, Loading, TextSystem};

/// The states among which a motion stays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subspace {
    /// All of them.
    Whole,
    /// The states in which two equal interfaces move in phase: one state stands for both.
    Symmetric,
}

impl Subspace {
    /// Appends the values of all states where these are those of the subspace.
    pub(super) fn whole(self, y: &[f64], states: &mut Vec<f64>) {
        states.extend_from_slice(y);
        self.complete(states);
    }

    /// Makes the values of all states of those of the subspace.
    pub(super) fn complete(self, states: &mut Vec<f64>) {
        if self == Subspace::Symmetric {
            states.extend(states.last().copied());
        }
    }
}

/// The equations of a part of a run.
pub(super) enum Equations<'a> {
    /// Interfaces with a built-in law; `rate` is the rate of V_H.
    BuiltIn {
        system: &'a System,
        loading: Loading,
        rate: f64,
        subspace: Subspace,
    },
    /// Formulas, and whether they are of interfaces.
    Formulas(Cow<'a, TextSystem>, bool),
}

impl Equations<'_> {
    /// The field in these units.
    ///
    /// # Errors
    /// The formulas of a user-defined system or law.
    pub fn field(&self, units: &MotionUnits) -> Result<AnyField<'_>> {
        match self {
            Equations::Formulas(system, _) => units.field(system),
            Equations::BuiltIn {
                system,
                loading,
                rate,
                subspace,
            } => Ok(built_in_field(system, *loading, *rate, *subspace)),
        }
    }

    /// How many variables they have: the states, V_H on a ramp, and time where formulas name it.
    pub fn variables(&self) -> usize {
        match self {
            Equations::Formulas(system, _) => system.variables(),
            Equations::BuiltIn {
                system,
                rate,
                subspace,
                ..
            } => {
                let states = match subspace {
                    Subspace::Whole => system.interfaces + 1,
                    Subspace::Symmetric => 2,
                };
                states + usize::from(*rate != 0.0)
            }
        }
    }

    /// Their states with V_H on a ramp, of which a run has this many without.
    pub fn has_driving(&self, states: usize) -> bool {
        match self {
            Equations::Formulas(system, _) => system.states().len() > states,
            Equations::BuiltIn { rate, .. } => *rate != 0.0,
        }
    }

    /// Whether they keep their units: those of interfaces are all of order 1.
    pub fn keep_units(&self) -> bool {
        match self {
            Equations::Formulas(_, slides) => *slides,
            Equations::BuiltIn { .. } => true,
        }
    }

    /// Which states can be followed by their logarithms.
    pub fn have_logarithms(&self) -> Vec<bool> {
        match self {
            Equations::Formulas(system, false) => system.have_logarithms(),
            _ => Vec::new(),
        }
    }

    /// Whether slopes may be infinite.
    pub fn takes_powers(&self) -> bool {
        match self {
            Equations::Formulas(system, _) => system.takes_powers(),
            Equations::BuiltIn { .. } => false,
        }
    }

    /// Whether time is a variable.
    pub fn is_timed(&self) -> bool {
        match self {
            Equations::Formulas(system, _) => system.is_timed(),
            Equations::BuiltIn { .. } => false,
        }
    }
}

/// The fastest field that there is.
fn built_in_field(
    system: &System,
    loading: Loading,
    rate: f64,
    subspace: Subspace,
) -> AnyField<'static> {
    let (law, ramp) = (system.law, (rate, loading.stiffness));
    let alike = subspace == Subspace::Symmetric || system.interfaces == 1;
    match (alike, rate == 0.0, system.unequal) {
        (true, true, _) if system.interfaces == 1 => {
            AnyField::new::<2>(model::single_interface(law, loading))
        }
        (true, true, _) => AnyField::new::<2>(model::symmetric(law, loading)),
        (true, false, _) => {
            let field = model::alike_on_ramp(law, system.interfaces, ramp);
            AnyField::new::<3>(Box::new(field))
        }
        (false, true, Some(laws)) => {
            AnyField::new::<3>(Box::new(model::UnequalInterfaces { laws, loading }))
        }
        (false, true, None) => AnyField::new::<3>(model::two_interfaces(law, loading)),
        (false, false, Some(laws)) => {
            AnyField::new::<4>(Box::new(model::unequal_interfaces_on_ramp(laws, ramp)))
        }
        (false, false, None) => {
            AnyField::new::<4>(Box::new(model::two_interfaces_on_ramp(law, ramp)))
        }
    }
}
