//! From the name of a method to an integrator: the one place that knows them all.

use super::auto::Auto;
use super::radau::Radau;
use super::rosenbrock::{Rosenbrock, RosenbrockMethod};
use super::taylor::Taylor;
use super::{Integrator, Tolerances};
use crate::error::{Error, Result};
#[cfg(feature = "sundials")]
use {super::CvodeIntegrator, crate::sundials};

/// A method that this build can run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choice {
    /// Taylor and Rodas5P, as the run has it.
    Auto,
    /// The Taylor method.
    Taylor,
    /// A Rosenbrock method.
    Rosenbrock(RosenbrockMethod),
    /// A Radau IIA method.
    Radau,
    /// CVODES, of SUNDIALS.
    #[cfg(feature = "sundials")]
    Cvode(sundials::MultistepMethod),
}

/// Whether the steps of a method are power series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HasSeries {
    /// Every step is.
    Always,
    /// Those of one of two methods are.
    Sometimes,
    /// None is.
    Never,
}

/// The names of the CVODES methods, in any build.
const CVODE: [&str; 2] = ["cvode-bdf", "cvode-adams"];

impl Choice {
    /// Every method of this build by itself: all but `auto`.
    pub fn all() -> Vec<Choice> {
        let rosenbrock = RosenbrockMethod::ALL.map(Choice::Rosenbrock);
        #[cfg(feature = "sundials")]
        let cvode = [
            sundials::MultistepMethod::Bdf,
            sundials::MultistepMethod::Adams,
        ]
        .map(Choice::Cvode);
        #[cfg(not(feature = "sundials"))]
        let cvode = [];
        let taylor = std::iter::once(Choice::Taylor);
        let implicit = rosenbrock.into_iter().chain([Choice::Radau]);
        taylor.chain(implicit).chain(cvode).collect()
    }

    /// The names of the methods of this build, `auto` first.
    pub fn names() -> Vec<&'static str> {
        let all = Choice::all().into_iter().map(Choice::name);
        std::iter::once(Choice::Auto.name()).chain(all).collect()
    }

    /// The method of that name.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a method that does not exist, [`Error::Input`] for one that is not in this build.
    pub fn named(name: &str) -> Result<Self> {
        Self::named_by("method", name)
    }

    /// The same where another option names it: what it is called in messages.
    pub fn named_by(option: &'static str, name: &str) -> Result<Self> {
        match name {
            "auto" => Ok(Choice::Auto),
            "taylor" => Ok(Choice::Taylor),
            Radau::NAME => Ok(Choice::Radau),
            #[cfg(feature = "sundials")]
            "cvode-bdf" => Ok(Choice::Cvode(sundials::MultistepMethod::Bdf)),
            #[cfg(feature = "sundials")]
            "cvode-adams" => Ok(Choice::Cvode(sundials::MultistepMethod::Adams)),
            _ if CVODE.contains(&name) => Err(Error::Input(format!(
                "method {name} needs SUNDIALS, and this build has none; choose one of {}",
                Choice::names().join(", ")
            ))),
            _ => RosenbrockMethod::named(name)
                .map(Choice::Rosenbrock)
                .map_err(|_| Error::unknown(option, name, &Choice::names())),
        }
    }

    /// An integrator in dimension N.
    ///
    /// # Errors
    /// [`Error::Parameter`] for tolerances or a bound on steps outside their domain.
    pub fn integrator<const N: usize>(
        self,
        tolerances: Tolerances,
        max_steps: usize,
    ) -> Result<Box<dyn Integrator<N>>> {
        Ok(match self {
            Choice::Auto => Box::new(Auto::new(tolerances, max_steps)?),
            Choice::Taylor => Box::new(Taylor::new(tolerances, max_steps)?),
            Choice::Rosenbrock(method) => Box::new(Rosenbrock::new(method, tolerances, max_steps)?),
            Choice::Radau => Box::new(Radau::new(tolerances, max_steps)?),
            #[cfg(feature = "sundials")]
            Choice::Cvode(method) => Box::new(CvodeIntegrator::new(method, tolerances, max_steps)?),
        })
    }

    /// The method's own name.
    pub fn name(self) -> &'static str {
        match self {
            Choice::Auto => "auto",
            Choice::Taylor => "taylor",
            Choice::Rosenbrock(method) => method.tableau().name,
            Choice::Radau => Radau::NAME,
            #[cfg(feature = "sundials")]
            Choice::Cvode(sundials::MultistepMethod::Bdf) => CVODE[0],
            #[cfg(feature = "sundials")]
            Choice::Cvode(sundials::MultistepMethod::Adams) => CVODE[1],
        }
    }

    /// Which of its steps come with a power series; the observer of any other has the dense output.
    pub fn series(self) -> HasSeries {
        match self {
            Choice::Taylor => HasSeries::Always,
            Choice::Auto => HasSeries::Sometimes,
            _ => HasSeries::Never,
        }
    }

    /// The highest degree in time of the dense output of steps that have no series.
    pub fn dense_degree(self) -> usize {
        match self {
            // Of either of the two methods that it takes beside Taylor's.
            Choice::Auto => Choice::Rosenbrock(RosenbrockMethod::Rodas5P).dense_degree(),
            // None is without.
            Choice::Taylor => 0,
            Choice::Rosenbrock(method) => {
                let weights = method.tableau().d;
                let used = weights.iter().filter(|row| row.iter().any(|&d| d != 0.0));
                1 + used.count()
            }
            Choice::Radau => 7,
            #[cfg(feature = "sundials")]
            Choice::Cvode(sundials::MultistepMethod::Bdf) => 5,
            #[cfg(feature = "sundials")]
            Choice::Cvode(sundials::MultistepMethod::Adams) => 12,
        }
    }

    /// Why one would take it, for a reader of `--explain`.
    pub fn reason(self) -> &'static str {
        match self {
            Choice::Auto => {
                "taylor, the fastest along stick-slip cycles, and rodas5p, or rodas4 above 1e-5, while strong damping would limit its steps"
            }
            Choice::Taylor => {
                "power series of order 12 to 18: by far the fastest along stick-slip cycles, slow where damping is strong"
            }
            Choice::Rosenbrock(RosenbrockMethod::Rodas5P) => {
                "order 5, one factorisation per step and no iteration, stable on stiff problems"
            }
            Choice::Rosenbrock(RosenbrockMethod::Rodas4) => {
                "order 4, six stages: cheaper steps than rodas5p"
            }
            Choice::Rosenbrock(RosenbrockMethod::Ros23) => {
                "order 2, the pair of ode23s, which the paper used: slow at tight tolerances"
            }
            Choice::Radau => {
                "order 9 or 13: the fewest steps on stiff problems at tight tolerances, each solved by Newton's method"
            }
            #[cfg(feature = "sundials")]
            Choice::Cvode(sundials::MultistepMethod::Bdf) => {
                "orders 1 to 5, a standard reference method: slower here at equal error"
            }
            #[cfg(feature = "sundials")]
            Choice::Cvode(sundials::MultistepMethod::Adams) => {
                "orders 1 to 12: good along stick-slip cycles, slow on stiff problems"
            }
        }
    }
}
