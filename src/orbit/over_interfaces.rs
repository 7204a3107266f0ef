//! Interfaces over any two of their parameters, in which their orbits are continued.

use super::family::{ParametrisedField, places};
use crate::error::Result;
use crate::field::Parametrised;
use crate::integrate::AnyField;
use crate::model::{AlikeInterfaces, Loading, UnequalInterfaces};

/// Orbits of interfaces over the logarithms of any two of their parameters; the others are held.
#[derive(Debug, Clone, Copy)]
pub struct OverInterfaces {
    interfaces: UnequalInterfaces,
    /// How many there are, where they move alike.
    alike: Option<usize>,
    names: [&'static str; 2],
    plane: [usize; 2],
}

impl OverInterfaces {
    /// Two interfaces that may differ, over the parameters of these names ([`Parametrised::names`]): with an index that of one
    /// interface, without one that of both.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a name that is not among them, if both are the same, and for a name without an index of which the
    /// interfaces have two values.
    pub fn new(interfaces: &UnequalInterfaces, names: [&str; 2]) -> Result<Self> {
        OverInterfaces::among(interfaces, None, interfaces.names(), names)
    }

    /// Equal interfaces that move alike, or one.
    ///
    /// # Errors
    /// As of [`OverInterfaces::new`]; there are no names with an index.
    pub fn alike(alike: &AlikeInterfaces, names: [&str; 2]) -> Result<Self> {
        OverInterfaces::among(&alike.interfaces, Some(alike.count), alike.names(), names)
    }

    fn among(
        interfaces: &UnequalInterfaces,
        alike: Option<usize>,
        all: &[&'static str],
        names: [&str; 2],
    ) -> Result<Self> {
        let plane = places(all, names)?;
        for name in names {
            interfaces.parameter(name)?;
        }
        Ok(OverInterfaces {
            interfaces: *interfaces,
            alike,
            names: plane.map(|place| all[place]),
            plane,
        })
    }

    /// The interfaces there.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for values outside the domain of the parameters.
    pub fn at(&self, at: [f64; 2]) -> Result<UnequalInterfaces> {
        let [first, second] = self.names;
        let moved = self.interfaces.with(first, at[0].exp())?;
        moved.with(second, at[1].exp())
    }
}

impl ParametrisedField for OverInterfaces {
    fn dimension(&self) -> usize {
        match self.alike {
            Some(_) => 2,
            None => 3,
        }
    }

    fn plane(&self) -> [usize; 2] {
        self.plane
    }

    /// Of a trial beyond the domain of the parameters a field without numbers, which no integrator follows.
    fn field(&self, at: [f64; 2]) -> AnyField<'_> {
        let nowhere = UnequalInterfaces {
            loading: Loading {
                driving: f64::NAN,
                stiffness: f64::NAN,
            },
            ..self.interfaces
        };
        let interfaces = self.at(at).unwrap_or(nowhere);
        match self.alike {
            Some(count) => AnyField::new::<2>(Box::new(AlikeInterfaces { interfaces, count })),
            None => AnyField::new::<3>(Box::new(interfaces)),
        }
    }

    fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
        at.map(f64::exp)
    }

    fn scale(&self, at: [f64; 2]) -> [f64; 2] {
        at.map(f64::exp)
    }
}
