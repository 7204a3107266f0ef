//! Branches from options: what is followed, along what, from where to where.

use super::continuation::BranchOptions;
use super::following::{self, Following, landings, range};
use super::general::{RowKind, user_functions};
use super::system::System;
use super::units::{Quantity, Units};
use serde_json::{Value, json};
use twinslip::bifurcation::{BranchRequest, EventObserver, Parameter, equilibria, orbits};
use twinslip::error::{Error, Result};
use twinslip::friction::positive;
use twinslip::model::Loading;
use twinslip::orbit::InterfaceSystem;

/// Of what the branches are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BranchKind {
    /// Steady states.
    Equilibria,
    /// Periodic orbits.
    Orbits,
}

impl BranchKind {
    /// What branches there are.
    pub(super) const NAMES: [&'static str; 2] = ["equilibria", "orbits"];

    pub(super) fn named(name: Option<&str>) -> Result<Self> {
        match name {
            Some("equilibria") => Ok(BranchKind::Equilibria),
            Some("orbits") => Ok(BranchKind::Orbits),
            Some(other) => Err(Error::unknown("branch", other, &BranchKind::NAMES)),
            None => Err(Error::Input(
                "say what to follow: twinslip branch equilibria, or twinslip branch orbits".into(),
            )),
        }
    }

    /// How many period doublings are followed.
    ///
    /// # Errors
    /// [`Error::Input`] for any of equilibria.
    pub(super) fn doublings(self, doublings: usize) -> Result<usize> {
        if self == BranchKind::Equilibria && doublings > 0 {
            return Err(Error::Input(format!(
                "`doublings` {doublings} applies only to orbits: equilibria have no period"
            )));
        }
        Ok(doublings)
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            BranchKind::Equilibria => "equilibria",
            BranchKind::Orbits => "orbits",
        }
    }
}

/// What varies, with its name and its default range.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchParameter {
    /// Which parameter.
    pub parameter: Parameter,
    name: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    range: (f64, f64),
}

impl BranchParameter {
    /// What may vary.
    pub(super) const NAMES: [&'static str; 2] = ["driving", "stiffness"];

    fn named(name: &str) -> Result<Self> {
        match name {
            "driving" => Ok(BranchParameter {
                parameter: Parameter::Driving,
                name: "driving",
                quantity: Quantity::SlipRate,
                range: following::DRIVING,
            }),
            "stiffness" => Ok(BranchParameter {
                parameter: Parameter::Stiffness,
                name: "stiffness",
                quantity: Quantity::Stiffness,
                range: following::STIFFNESS,
            }),
            other => Err(Error::unknown("along", other, &BranchParameter::NAMES)),
        }
    }

    /// Its value at a V_H and a K, in the user's units.
    pub fn of(&self, driving: f64, stiffness: f64, units: &Units) -> f64 {
        let x = match self.parameter {
            Parameter::Driving => driving,
            Parameter::Stiffness => stiffness,
        };
        units.outward(self.quantity, x)
    }

    /// From where to where, dimensionless.
    fn ends(&self, options: &BranchOptions, units: &Units) -> Result<(f64, f64)> {
        let end = |name, given: Option<f64>, default| {
            given.map_or(Ok(default), |x| {
                Ok(units.inward(self.quantity, positive(name, x)?))
            })
        };
        range(
            "the range `from` `to`",
            (
                end("from", options.from, self.range.0)?,
                end("to", options.to, self.range.1)?,
            ),
        )
    }
}

/// Branches that are asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchPlan {
    /// Of what.
    pub of: BranchKind,
    /// What varies.
    pub along: BranchParameter,
    /// What slides.
    pub system: System,
    /// What is followed.
    pub request: BranchRequest,
    /// How.
    pub following: Following,
    /// The same for the output.
    pub numerics: Value,
}

impl BranchPlan {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &BranchOptions) -> Result<Self> {
        let of = BranchKind::named(options.of.as_deref())?;
        let along = BranchParameter::named(options.along.as_deref().unwrap_or("driving"))?;
        let system = match of {
            BranchKind::Equilibria => System::several(&options.model)?,
            BranchKind::Orbits => System::new(&options.model)?,
        };
        let system = system.alike("branch")?;
        let units = &system.units;
        let ends = along.ends(options, units)?;
        let loading = loading(&system, &along, ends.0)?;
        let following = Following::new(&options.continuation, of == BranchKind::Orbits)?;
        let out = |x| units.outward(along.quantity, x);
        let at = landings("at", options.at.as_deref(), (along.quantity, units), ends)?;
        let kind = RowKind {
            orbits: of == BranchKind::Orbits,
            curve: false,
            homoclinic: false,
        };
        let watch = user_functions(&options.watch, &system, (kind, &[along.name]))?;
        let mut numerics = json!({
            "of": of.name(),
            "along": along.name,
            "from": out(ends.0),
            "to": out(ends.1),
            "symmetry": options.symmetry,
            "at": at.iter().map(|&x| out(x)).collect::<Vec<f64>>(),
            "step_limit": following.step,
            "tolerance": following.tolerance,
            "doublings": options.doublings,
            "crosscheck": following.second.map(|second| second.name()),
        });
        if !options.watch.is_empty() {
            numerics["watch"] = json!(options.watch);
        }
        let request = BranchRequest {
            watch,
            slab: InterfaceSystem {
                law: system.law,
                interfaces: system.interfaces,
                loading,
            },
            along: along.parameter,
            range: ends,
            symmetry: following::symmetry(&options.symmetry, system.interfaces)?,
            at,
            step: following.step,
            tolerance: following.tolerance,
            skip: Vec::new(),
            doublings: of.doublings(options.doublings)?,
            max_points: following.max_points,
        };
        Ok(BranchPlan {
            of,
            along,
            system,
            request,
            following,
            numerics,
        })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let out = |x| self.system.units.outward(self.along.quantity, x);
        let (from, to) = self.request.range;
        let method = match self.of {
            BranchKind::Equilibria => {
                "every partition of the interfaces among the slow, middle and fast branch of the law, along the middle rate; characteristic polynomials"
            }
            BranchKind::Orbits => {
                "taylor, tangents on, multiple shooting; begins at the Hopf points"
            }
        };
        format!(
            "plan of this command\n{}  range             {} from {:e} to {:e}\n  method            {method}\n{}",
            following::explain_symmetry(self.request.symmetry, self.system.interfaces),
            self.along.name,
            out(from),
            out(to),
            following::explain(&self.following, &self.request.at, &self.request.watch)
        )
    }

    /// Follows them, but those whose numbers are known.
    ///
    /// # Errors
    /// Those of the branches.
    pub fn follow(&self, known: &[usize], seen: EventObserver<'_>) -> Result<()> {
        let request = BranchRequest {
            skip: known.to_vec(),
            ..self.request.clone()
        };
        match self.of {
            BranchKind::Equilibria => equilibria::branch(&request, seen),
            BranchKind::Orbits => orbits::branch(&request, seen),
        }
    }
}

/// V_H and K; what varies begins at `from` and must not be given.
fn loading(system: &System, along: &BranchParameter, from: f64) -> Result<Loading> {
    let twice = |given: Option<f64>| match given {
        None => Ok(()),
        Some(_) => Err(Error::Input(format!(
            "`{0}` cannot be given with `along` {0}, which makes it the free parameter; use `from` and `to`",
            along.name
        ))),
    };
    match along.parameter {
        Parameter::Driving => {
            twice(system.driving)?;
            Loading::new(from, system.needed_stiffness()?)
        }
        Parameter::Stiffness => {
            twice(system.stiffness)?;
            Loading::new(system.needed_driving()?, from)
        }
    }
}
