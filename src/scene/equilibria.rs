//! Steady states from options: where, by which solver, and whether their stability is known.

use super::options::EquilibriaOptions;
use super::system::System;
use crate::equilibrium::{
    Equilibrium, Solver, Stability, SteadyStates, Verdict, stability, steady_states,
};
use crate::error::{Error, Result};

/// Steady states that are asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct EquilibriaPlan {
    /// What slides; its stiffness, where it is given, decides about stability.
    pub system: System,
    /// V_H.
    pub driving: f64,
    /// What finds the asymmetric ones.
    pub solver: Solver,
    /// Its name.
    pub solver_name: &'static str,
}

/// A steady state, with what the stiffness makes of it.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassifiedEquilibrium {
    /// The state.
    pub equilibrium: Equilibrium,
    /// Its eigenvalues and verdict, where the stiffness is given.
    pub stability: Option<Stability>,
    /// The largest residual of its equations.
    pub residual: f64,
}

/// All steady states of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassifiedEquilibria {
    /// By stress, descending.
    pub equilibria: Vec<ClassifiedEquilibrium>,
    /// Whether their number is certain.
    pub complete: bool,
}

impl ClassifiedEquilibria {
    /// Whether their number or a verdict is undecided.
    pub fn undecided(&self) -> bool {
        let verdict = |one: &ClassifiedEquilibrium| one.stability.as_ref().map(|s| s.verdict);
        let undecided = |one| verdict(one) == Some(Verdict::Undecided);
        !self.complete || self.equilibria.iter().any(undecided)
    }
}

impl EquilibriaPlan {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &EquilibriaOptions) -> Result<Self> {
        let system = System::new(&options.model)?;
        for (name, given) in [("box", &options.within), ("start", &options.start)] {
            if given.is_some() {
                return Err(Error::Input(format!(
                    "`{name}` is where steady states of a `system` or a `law` from a file are looked for; of built-in laws all are found without it"
                )));
            }
        }
        let driving = system.needed_driving()?;
        let (solver_name, solver) = solver(options.solver.as_deref())?;
        Ok(EquilibriaPlan {
            system,
            driving,
            solver,
            solver_name,
        })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let asymmetric = match self.system.interfaces {
            2 => format!(
                "{}, from a certain bracket around each solution",
                self.solver_name
            ),
            _ => "off: one interface has none".to_owned(),
        };
        let stability = match self.system.stiffness {
            Some(_) => {
                "on: Routh-Hurwitz in interval arithmetic, eigenvalues from the characteristic polynomials"
            }
            None => "off: it depends on the stiffness, which is not given",
        };
        format!(
            "plan of this command
  symmetric         closed formula at V_H over the number of interfaces
  asymmetric        {asymmetric}
  stability         {stability}"
        )
    }

    /// Finds them.
    ///
    /// # Errors
    /// Those of [`steady_states`] and [`stability`].
    pub fn solve(&self) -> Result<ClassifiedEquilibria> {
        let (law, driving) = (&self.system.law, self.driving);
        let SteadyStates {
            equilibria,
            complete,
        } = steady_states(law, driving, self.system.interfaces, self.solver)?;
        let classified = |equilibrium: Equilibrium| {
            let stiffness = self.system.stiffness;
            let stability = stiffness
                .map(|k| stability(law, &equilibrium, k))
                .transpose()?;
            Ok(ClassifiedEquilibrium {
                residual: equilibrium.residual(law, driving),
                stability,
                equilibrium,
            })
        };
        let equilibria: Result<_> = equilibria.into_iter().map(classified).collect();
        Ok(ClassifiedEquilibria {
            equilibria: equilibria?,
            complete,
        })
    }
}

fn solver(name: Option<&str>) -> Result<(&'static str, Solver)> {
    #[cfg(feature = "sundials")]
    const DEFAULT: &str = "kinsol";
    #[cfg(not(feature = "sundials"))]
    const DEFAULT: &str = "newton";
    match name.unwrap_or(DEFAULT) {
        #[cfg(feature = "sundials")]
        "kinsol" => Ok(("kinsol", Solver::Kinsol)),
        #[cfg(not(feature = "sundials"))]
        "kinsol" => Err(Error::Input(
            "solver kinsol needs SUNDIALS, which this build is without; choose newton".into(),
        )),
        "newton" => Ok(("newton", Solver::Newton)),
        other => Err(Error::unknown("solver", other, &["kinsol", "newton"])),
    }
}
