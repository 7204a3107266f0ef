//! Steady states from options: where, by which solver, and whether their stability is known.

use super::options::EquilibriaOptions;
use super::system::System;
use twinslip::equilibrium::{
    ClusterStability, Equilibrium, LawOfEach, Solver, SteadyStates, Verdict, cluster_stability,
    cluster_steady_states, stability, steady_states, unequal_steady_states,
};
use twinslip::error::{Error, Result};

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
    pub stability: Option<ClusterStability>,
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
    /// Of how many the stability is undecided.
    pub fn undecided(&self) -> usize {
        let undecided = |one: &&ClassifiedEquilibrium| {
            let known = one.stability.as_ref();
            known.is_some_and(|stability| stability.verdict == Verdict::Undecided)
        };
        self.equilibria.iter().filter(undecided).count()
    }
}

impl EquilibriaPlan {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &EquilibriaOptions) -> Result<Self> {
        let system = System::several(&options.model)?;
        for (name, given) in [("box", &options.within), ("start", &options.start)] {
            if given.is_some() {
                return Err(Error::Input(format!(
                    "`{name}` limits the search for steady states of a `system` or a `law` from a file; those of built-in laws are all found without it"
                )));
            }
        }
        let driving = system.needed_driving()?;
        let alone = newton_alone(&system);
        let (solver_name, solver) = solver(options.solver.as_deref(), alone)?;
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
            1 => "off: one interface has none".to_owned(),
            2 => format!(
                "{}, from a certified bracket of each solution",
                self.solver_name
            ),
            _ => "every partition of the interfaces among the slow, middle and fast branch of the law: interval arithmetic brackets every solution, then Newton's method with 31 digits".to_owned(),
        };
        let stability = self.explain_stability();
        format!(
            "plan of this command
  symmetric         closed form at V_H divided by the number of interfaces
  asymmetric        {asymmetric}
  stability         {stability}"
        )
    }

    fn explain_unequal(&self) -> String {
        format!(
            "plan of this command
  states            branch and bound in interval arithmetic, then Newton's method with 31 digits; none is symmetric, as the interfaces differ
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
                let found = if interfaces > 2 {
                    cluster_steady_states(law, self.driving, interfaces)?
                } else {
                    steady_states(law, self.driving, interfaces, self.solver)?
                };
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
            let stability = match stiffness {
                None => None,
                Some(k) if self.system.interfaces > 2 => {
                    Some(cluster_stability(&self.system.law, &equilibrium, k)?)
                }
                Some(k) => Some(stability(laws, &equilibrium, k)?.into()),
            };
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

/// Of whom Newton's method alone finds the states.
fn newton_alone(system: &System) -> Option<&'static str> {
    match (&system.unequal, system.interfaces) {
        (Some(_), _) => Some("equal interfaces, and these differ"),
        (None, 3..) => Some("one or two interfaces, and there are more"),
        _ => None,
    }
}

/// What finds the states; `alone` says why Newton's method alone does.
pub(super) fn solver(name: Option<&str>, alone: Option<&str>) -> Result<(&'static str, Solver)> {
    #[cfg(feature = "sundials")]
    const DEFAULT: &str = "kinsol";
    #[cfg(not(feature = "sundials"))]
    const DEFAULT: &str = "newton";
    let default = if alone.is_some() { "newton" } else { DEFAULT };
    match (name.unwrap_or(default), alone) {
        ("kinsol", Some(why)) => Err(Error::Input(format!(
            "solver kinsol is for {why}; choose newton"
        ))),
        #[cfg(feature = "sundials")]
        ("kinsol", None) => Ok(("kinsol", Solver::Kinsol)),
        #[cfg(not(feature = "sundials"))]
        ("kinsol", None) => Err(Error::Input(
            "solver kinsol needs SUNDIALS, and this build has none; choose newton".into(),
        )),
        ("newton", _) => Ok(("newton", Solver::Newton)),
        (other, _) => Err(Error::unknown("solver", other, &["kinsol", "newton"])),
    }
}
