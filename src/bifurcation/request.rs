//! What a request must be.

use super::{BranchRequest, LocusRequest};
use crate::equilibrium::{MOST_INTERFACES, Symmetry};
use crate::error::{Error, Result};
use crate::orbit::InterfaceSystem;

impl BranchRequest {
    /// # Errors
    /// [`Error::Parameter`] or [`Error::Input`] unless there is something to follow: a slab, a range of positive values with
    /// two different ends, positive step limit and tolerance.
    pub fn checked(&self) -> Result<()> {
        self.checked_up_to(2)
    }

    /// The same of any number of equal interfaces.
    ///
    /// # Errors
    /// As of [`BranchRequest::checked`].
    pub(super) fn checked_of_many(&self) -> Result<()> {
        self.checked_up_to(MOST_INTERFACES)
    }

    fn checked_up_to(&self, most: usize) -> Result<()> {
        checked(&self.slab, most, self.symmetry, self.step, self.tolerance)?;
        positive("driving", self.slab.loading.driving)?;
        positive("stiffness", self.slab.loading.stiffness)?;
        range("range", self.range)?;
        values("wanted value", &self.at)
    }
}

impl LocusRequest {
    /// # Errors
    /// As of [`BranchRequest::checked`].
    pub fn checked(&self) -> Result<()> {
        self.checked_up_to(2)
    }

    /// The same of any number of equal interfaces.
    ///
    /// # Errors
    /// As of [`BranchRequest::checked`].
    pub(super) fn checked_of_many(&self) -> Result<()> {
        self.checked_up_to(MOST_INTERFACES)
    }

    fn checked_up_to(&self, most: usize) -> Result<()> {
        checked(&self.slab, most, self.symmetry, self.step, self.tolerance)?;
        range("driving range", self.driving)?;
        range("stiffness range", self.stiffness)?;
        values("wanted driving", &self.at_driving)?;
        values("wanted stiffness", &self.at_stiffness)
    }

    /// The same with the smaller end of every range first.
    pub(super) fn ordered(&self) -> Self {
        let ordered = |(a, b): (f64, f64)| (a.min(b), a.max(b));
        LocusRequest {
            driving: ordered(self.driving),
            stiffness: ordered(self.stiffness),
            ..self.clone()
        }
    }
}

fn checked(
    slab: &InterfaceSystem,
    most: usize,
    symmetry: Option<Symmetry>,
    step: f64,
    tolerance: f64,
) -> Result<()> {
    if !(1..=most).contains(&slab.interfaces) {
        let must = match most {
            2 => "1 or 2".to_owned(),
            _ => format!("between 1 and {most}"),
        };
        return Err(Error::parameter("interfaces", slab.interfaces, must));
    }
    if slab.interfaces == 1 && symmetry == Some(Symmetry::Asymmetric) {
        return Err(Error::Input(
            "a single interface has no asymmetric states; take two".into(),
        ));
    }
    positive("step", step)?;
    positive("tolerance", tolerance)?;
    Ok(())
}

fn positive(name: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(Error::parameter(name, value, "positive and finite"))
    }
}

fn range(name: &str, (from, to): (f64, f64)) -> Result<()> {
    positive(name, from)?;
    positive(name, to)?;
    if from == to {
        return Err(Error::parameter(
            name,
            format!("{from} to {to}"),
            "from one value to another",
        ));
    }
    Ok(())
}

fn values(name: &str, all: &[f64]) -> Result<()> {
    all.iter().try_for_each(|&x| positive(name, x).map(|_| ()))
}
