//! The steady state of many interfaces that differ, from options: which, from where, by which solver.

use super::draw::Drawn;
use super::setup::{Asked, Setup, needed};
use crate::scene::equilibria::solver;
use crate::scene::options::EquilibriaOptions;
use crate::scene::system::Described;
use crate::scene::units::Units;
use serde_json::{Map, Value};
use twinslip::equilibrium::{Solver, Verdict};
use twinslip::error::{Error, Result};
use twinslip::friction::positive;
use twinslip::many::{
    ManyEquilibrium, ManyInterfaces, ManyStability, Processes, equilibrium_of_many,
    stability_of_many,
};
use twinslip::model::Loading;

/// A steady state that is asked for, checked.
#[derive(Debug, Clone)]
pub struct ManyEquilibriumPlan {
    /// What slides.
    pub interfaces: ManyInterfaces,
    /// tau, and psi of each, from which Newton's method starts.
    pub start: (f64, Vec<f64>),
    /// The constants that are drawn.
    pub drawn: Vec<Drawn>,
    /// What finds the state.
    pub solver: Solver,
    /// Its name.
    pub solver_name: &'static str,
    /// Whether the stiffness is given, which decides about stability.
    pub is_stiff: bool,
    units: Units,
    echo: Map<String, Value>,
}

/// The state that is found.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundManyEquilibrium {
    /// The state.
    pub equilibrium: ManyEquilibrium,
    /// Its stability, where the stiffness is given.
    pub stability: Option<ManyStability>,
}

/// One of the interfaces in it.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyInterface {
    /// Its number, from 1.
    pub interface: usize,
    /// ln psi and what it may be off.
    pub log_state: (f64, f64),
    /// v and what it may be off.
    pub slip_rate: (f64, f64),
    /// Its constants that are drawn, in the order in which they were asked for.
    pub drawn: Vec<f64>,
}

impl ManyEquilibriumPlan {
    /// Whether the options are of interfaces of this kind.
    pub fn is_of(options: &EquilibriaOptions) -> bool {
        !options.draws.draw.is_empty()
    }

    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &EquilibriaOptions) -> Result<Self> {
        let slab = &options.model.slab;
        let refused = [
            ("system", slab.text.system.is_some()),
            ("clusters", slab.clusters.is_some()),
            ("box", options.within.is_some()),
        ];
        if let Some((name, _)) = refused.into_iter().find(|(_, asked)| *asked) {
            return Err(Error::Input(format!(
                "`draw` gives each interface of a built-in law different constants, which `{name}` does not have; leave out one of them"
            )));
        }
        let model = options.model.resolved()?;
        let driving = needed("driving", model.driving)?;
        // The states do not depend on the stiffness: where it is not given, any will do.
        let stiffness = match model.stiffness {
            Some(stiffness) => positive("stiffness", stiffness)?,
            None => 1.0,
        };
        let (solver_name, solver) = solver(options.solver.as_deref(), None)?;
        let setup = Setup::new(&Asked {
            model: &model,
            loading: Loading::new(driving, stiffness)?,
            draws: &options.draws,
            start: Some(options.start.as_deref().unwrap_or("near-symmetric:0")),
            processes: Processes::One,
        })?;
        Ok(ManyEquilibriumPlan {
            interfaces: setup.interfaces,
            start: setup.start,
            drawn: setup.drawn,
            solver,
            solver_name,
            is_stiff: model.stiffness.is_some(),
            units: Units::none(),
            echo: setup.echo,
        })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let stability = match self.is_stiff {
            true => "on: the argument principle along the imaginary axis, certain up to rounding",
            false => "off: it depends on the stiffness, which is not given",
        };
        format!(
            "plan of this command
  interfaces        {}, each with constants of its own, under one stress
  state             one of possibly many: the one to which Newton's method ({}) converges from the start; of equal interfaces all are found
  stability         {stability}",
            twinslip::error::count(self.interfaces.count()),
            self.solver_name,
        )
    }

    /// Finds it.
    ///
    /// # Errors
    /// Those of [`equilibrium_of_many`].
    pub fn solve(&self) -> Result<FoundManyEquilibrium> {
        let (stress, states) = &self.start;
        let equilibrium = equilibrium_of_many(&self.interfaces, (*stress, states), self.solver)?;
        let stability = self
            .is_stiff
            .then(|| stability_of_many(&self.interfaces, &equilibrium));
        Ok(FoundManyEquilibrium {
            equilibrium,
            stability,
        })
    }
}

impl FoundManyEquilibrium {
    /// Whether its stability is asked for and undecided.
    pub fn undecided(&self) -> bool {
        { self.stability }.is_some_and(|stability| stability.verdict == Verdict::Undecided)
    }

    /// All interfaces, with their constants.
    pub fn interfaces(&self, drawn: &[Drawn]) -> Vec<SteadyInterface> {
        let found = &self.equilibrium;
        let one = |i: usize| SteadyInterface {
            interface: i + 1,
            log_state: (found.log_state[i], found.log_state_uncertainty[i]),
            slip_rate: (found.slip_rate[i], found.slip_rate_uncertainty[i]),
            drawn: drawn.iter().map(|drawn| drawn.values[i]).collect(),
        };
        (0..found.log_state.len()).map(one).collect()
    }
}

impl Described for ManyEquilibriumPlan {
    fn echo(&self) -> &Map<String, Value> {
        &self.echo
    }

    fn units(&self) -> &Units {
        &self.units
    }
}
