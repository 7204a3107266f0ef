//! Steady states from options: where, by which solver, and whether their stability is known.

use super::options::EquilibriaOptions;
use super::system::System;
use crate::equilibrium::{
    Equilibrium, LawOfEach, Solver, Stability, SteadyStates, Verdict, stability, steady_states,
    unequal_steady_states,
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
        let differ = system.unequal.is_some();
        let (solver_name, solver) = solver(options.solver.as_deref(), differ)?;
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
            _ if self.system.unequal.is_some() => return self.explain_unequal(),
            2 => format!(
                "{}, from a certain bracket around each solution",
                self.solver_name
            ),
            _ => "off: one interface has none".to_owned(),
        };
        let stability = self.explain_stability();
        format!(
            "plan of this command
  symmetric         closed formula at V_H over the number of interfaces
  asymmetric        {asymmetric}
  stability         {stability}"
        )
    }

    fn explain_unequal(&self) -> String {
        format!(
            "plan of this command
  states            branch and bound in interval arithmetic, then Newton's method in 31 digits; the interfaces differ: none is symmetric
  stability         {}",
            self.explain_stability()
        )
    }

    fn explain_stability(&self) -> &'static str {
        match self.system.stiffness {
            Some(_) => {
                "on: Routh-Hurwitz in interval arithmetic, eigenvalues from the characteristic polynomials"
            }
            None => "off: it depends on the stiffness, which is not given",
        }
    }

    /// Finds them.
    ///
    /// # Errors
    /// Those of [`steady_states`], [`unequal_steady_states`] and [`stability`].
    pub fn solve(&self) -> Result<ClassifiedEquilibria> {
        match &self.system.unequal {
            Some(laws) => self.classified(laws, unequal_steady_states(laws, self.driving)?),
            None => {
                let (law, interfaces) = (&self.system.law, self.system.interfaces);
                let found = steady_states(law, self.driving, interfaces, self.solver)?;
                self.classified(law, found)
            }
        }
    }

    fn classified(
        &self,
        laws: &impl LawOfEach,
        SteadyStates {
            equilibria,
            complete,
        }: SteadyStates,
    ) -> Result<ClassifiedEquilibria> {
        let classified = |equilibrium: Equilibrium| {
            let stiffness = self.system.stiffness;
            let stability = stiffness
                .map(|k| stability(laws, &equilibrium, k))
                .transpose()?;
            Ok(ClassifiedEquilibrium {
                residual: equilibrium.residual(laws, self.driving),
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

/// What finds the states; those of interfaces that differ are found by Newton's method alone.
fn solver(name: Option<&str>, differ: bool) -> Result<(&'static str, Solver)> {
    #[cfg(feature = "sundials")]
    const DEFAULT: &str = "kinsol";
    #[cfg(not(feature = "sundials"))]
    const DEFAULT: &str = "newton";
    match name.unwrap_or(if differ { "newton" } else { DEFAULT }) {
        "kinsol" if differ => Err(Error::Input(
            "solver kinsol is for equal interfaces, and these differ; choose newton".into(),
        )),
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
