//! The methods that integrate many interfaces, one as the other.

#[cfg(feature = "sundials")]
use super::cvode::ManyCvode;
use super::field::Slips;
use super::interfaces::ManyInterfaces;
use super::rosenbrock::ManyRosenbrock;
use super::step::{Beginning, ManyObserver};
use super::taylor::ManyTaylor;
use crate::error::Result;
use crate::integrate::Work;

/// A method with its tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ManyMethod {
    /// Taylor's series.
    Taylor(ManyTaylor),
    /// Rosenbrock's linearly implicit stages.
    Rosenbrock(ManyRosenbrock),
    /// BDF by CVODE.
    #[cfg(feature = "sundials")]
    Cvode(ManyCvode),
}

impl ManyMethod {
    /// The name by which the command line knows it.
    pub fn name(&self) -> &'static str {
        match self {
            ManyMethod::Taylor(_) => "taylor",
            ManyMethod::Rosenbrock(method) => method.method().tableau().name,
            #[cfg(feature = "sundials")]
            ManyMethod::Cvode(_) => "cvode-bdf",
        }
    }

    /// Its order; the highest one where it changes.
    pub fn order(&self) -> usize {
        match self {
            ManyMethod::Taylor(method) => method.order(),
            ManyMethod::Rosenbrock(method) => method.method().tableau().order as usize,
            #[cfg(feature = "sundials")]
            ManyMethod::Cvode(_) => 5,
        }
    }

    /// Bytes that a run takes, without rows.
    pub fn memory(&self, interfaces: &ManyInterfaces) -> usize {
        match self {
            ManyMethod::Taylor(method) => method.memory(interfaces),
            ManyMethod::Rosenbrock(method) => method.memory(interfaces),
            #[cfg(feature = "sundials")]
            ManyMethod::Cvode(method) => method.memory(interfaces),
        }
    }

    /// From a beginning on until a time, or until the observer says `false`, with the slips that are asked for.
    ///
    /// # Errors
    /// Those of the methods.
    pub fn run(
        &self,
        interfaces: &ManyInterfaces,
        beginning: Beginning<'_>,
        until: f64,
        slips: &Slips,
        observer: &mut dyn ManyObserver,
    ) -> Result<Work> {
        match self {
            ManyMethod::Taylor(method) => {
                let end = method.run(interfaces, beginning, until, observer)?;
                Ok(Work {
                    steps: end.steps(),
                    rhs: end.steps() * method.order(),
                    ..Work::default()
                })
            }
            ManyMethod::Rosenbrock(method) => {
                let end = method.run(interfaces, beginning, until, slips, observer)?;
                Ok(end.work())
            }
            #[cfg(feature = "sundials")]
            ManyMethod::Cvode(method) => {
                let end = method.run(interfaces, beginning, until, slips, observer)?;
                Ok(end.work())
            }
        }
    }
}
