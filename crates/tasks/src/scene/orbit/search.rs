//! How orbits are looked for: of interfaces with a built-in law by their symmetry and from Hopf points, of any other system from a start.

use super::super::any_system::AnySystem;
use super::super::equations::Subspace;
use super::super::options::OrbitOptions;
use super::super::plan::start;
use super::super::system::System;
use super::super::text::{not_forced, orbit_start, symmetry as symmetry_of_start};
use super::super::units::Quantity;
use std::sync::OnceLock;
use twinslip::equilibrium::Symmetry;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::friction::positive;
use twinslip::integrate::{AnyField, MotionUnits};
use twinslip::model::UnequalInterfaces;
use twinslip::orbit::{
    Crosscheck, FoundOrbit, InitialGuess, InterfaceSystem, Orbit, OrbitAccuracy, PhaseResponse,
    Query, crosscheck, crosscheck_of, find, find_either, find_from, find_unequal, phase_response,
};

/// How an orbit is looked for, and computed once more.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Search {
    /// One interface or two equal ones; where no symmetry is asked for, the orbit that runs settle on.
    BySymmetry {
        slab: InterfaceSystem,
        query: Query,
        either: bool,
    },
    /// Two interfaces that differ.
    Unequal(UnequalInterfaces, InitialGuess),
    /// From a start, at or near the orbit.
    FromStart {
        start: Vector,
        /// The period, roughly, where it is given.
        period: Option<f64>,
        /// The units in which it is looked for.
        units: MotionUnits,
        /// The units in which it was found, where a state fell below the range of doubles.
        logarithmic: OnceLock<MotionUnits>,
    },
}

impl Search {
    pub fn new(options: &OrbitOptions, system: &AnySystem) -> Result<Self> {
        if let Some(model) = system.formulas() {
            let symmetry = symmetry_of_start(options, model)?;
            let start = orbit_start(options.start.as_deref(), symmetry, model)?;
            return Ok(Search::FromStart {
                units: system.units_of_run(&start)?,
                period: model.period(options.turns, options.period_guess)?,
                start,
                logarithmic: OnceLock::new(),
            });
        }
        if let Some(turns) = options.turns {
            return Err(not_forced(turns));
        }
        let (system, loading) = system.closed_forms().expect("a system without formulas");
        let slab = InterfaceSystem {
            law: system.law,
            interfaces: system.interfaces,
            loading,
        };
        let query = Query {
            symmetry: symmetry(options.symmetry.as_deref(), system)?,
            begin: begin(options, system, &slab)?,
        };
        if let Some(interfaces) = system.unequal(loading) {
            return Ok(Search::Unequal(interfaces, query.begin));
        }
        let anywhere = query.begin == InitialGuess::Anywhere;
        Ok(Search::BySymmetry {
            either: options.symmetry.is_none() && anywhere && system.interfaces == 2,
            slab,
            query,
        })
    }

    /// How many variables the orbit has, in words.
    pub fn dimension(&self) -> String {
        match self {
            Search::FromStart { start, .. } => start.len().to_string(),
            Search::Unequal(..) => "3: the interfaces differ".into(),
            Search::BySymmetry { either: true, .. } => {
                "2: both interfaces in phase; 3 where that orbit is not stable, or does not exist"
                    .into()
            }
            Search::BySymmetry { slab, query, .. } => match (query.symmetry, slab.interfaces) {
                (Symmetry::Asymmetric, _) => "3".into(),
                (Symmetry::Symmetric, 2) => {
                    "2: both interfaces in phase; the transverse multiplier is a quadrature".into()
                }
                (Symmetry::Symmetric, _) => "2".into(),
            },
        }
    }

    /// Where it begins, in words.
    pub fn guess(&self) -> &'static str {
        let near = |period: Option<f64>| match period {
            Some(_) => "the start, with the period given",
            None => "the returns of the run from the start, else its attractor",
        };
        match self {
            Search::FromStart { period, .. } => near(*period),
            Search::BySymmetry {
                query: Query { begin, .. },
                ..
            }
            | Search::Unequal(_, begin) => match (begin, self) {
                (InitialGuess::At { period, .. }, _) => near(*period),
                (InitialGuess::Anywhere, Search::Unequal(..)) => "what runs settle on",
                (InitialGuess::Anywhere, _) => {
                    "the attractor of runs, else the branch from the nearest Hopf point"
                }
                (InitialGuess::Hopf, _) => "the branch from the nearest Hopf point, past its folds",
            },
        }
    }

    /// The units in which it looks, where these are not those of the system.
    pub fn units(&self) -> Option<&MotionUnits> {
        match self {
            Search::FromStart {
                units, logarithmic, ..
            } => Some(logarithmic.get().unwrap_or(units)),
            _ => None,
        }
    }

    /// Finds the orbit.
    pub fn find(
        &self,
        system: &AnySystem,
        accuracy: &OrbitAccuracy,
        atol_is_given: bool,
    ) -> Result<FoundOrbit> {
        let (start, period, first, logarithmic) = match self {
            Search::BySymmetry { slab, either, .. } if *either => {
                return find_either(slab, accuracy);
            }
            Search::BySymmetry { slab, query, .. } => return find(slab, query, accuracy),
            Search::Unequal(interfaces, begin) => {
                return find_unequal(interfaces, *begin, accuracy);
            }
            Search::FromStart {
                start,
                period,
                units,
                logarithmic,
            } => (start, period, units, logarithmic),
        };
        let equations = system.equations(Subspace::Whole);
        let found_in = |units: &MotionUnits| {
            find_from(
                &equations.field(units)?,
                &units.inward(start),
                period.map(|period| period / units.time),
                &units.inward_accuracy(*accuracy, atol_is_given),
            )
        };
        let mut found = found_in(logarithmic.get().unwrap_or(first));
        if let Err(Error::Underflow { .. } | Error::NotConverged { .. }) = found
            && let Some(units) = system.units_below_doubles(first, start)
        {
            let units = logarithmic.get_or_init(|| units);
            // Where that is of no use either the first failure is told.
            found = found_in(units).or(found);
        }
        let units = logarithmic.get().unwrap_or(first);
        let found = found.map_err(|error| units.outward_error(error, 0))?;
        let others = found.others.into_iter();
        Ok(FoundOrbit {
            orbit: units.outward_orbit(found.orbit),
            others: others.map(|other| units.outward_orbit(other)).collect(),
        })
    }

    /// The phase response along an orbit, at so many points.
    pub fn responses(
        &self,
        system: &AnySystem,
        orbit: &Orbit,
        (accuracy, atol_is_given): (&OrbitAccuracy, bool),
        points: usize,
    ) -> Result<Vec<PhaseResponse>> {
        let units = match self {
            Search::BySymmetry { slab, .. } => {
                let field = match orbit.point.len() {
                    2 => AnyField::new::<2>(slab.plane()),
                    _ => AnyField::new::<3>(slab.whole()),
                };
                return phase_response(&field, orbit, accuracy, points);
            }
            Search::Unequal(interfaces, _) => {
                let field = AnyField::of::<3>(interfaces);
                return phase_response(&field, orbit, accuracy, points);
            }
            Search::FromStart {
                units, logarithmic, ..
            } => logarithmic.get().unwrap_or(units),
        };
        let inward = units.inward_accuracy(*accuracy, atol_is_given);
        let known = held(units, orbit)?;
        let equations = system.equations(Subspace::Whole);
        let rows = phase_response(&equations.field(units)?, &known, &inward, points)
            .map_err(|error| units.outward_error(error, 0))?;
        Ok(rows
            .into_iter()
            .map(|row| units.outward_response(row))
            .collect())
    }

    /// The orbit once more, by another method.
    pub fn crosscheck(
        &self,
        system: &AnySystem,
        orbit: &Orbit,
        second: &OrbitAccuracy,
        atol_is_given: bool,
    ) -> Result<Crosscheck> {
        let units = match self {
            Search::BySymmetry { slab, .. } => return crosscheck(slab, orbit, second),
            Search::Unequal(interfaces, _) => {
                return crosscheck_of(&AnyField::of::<3>(interfaces), orbit, second);
            }
            Search::FromStart {
                units, logarithmic, ..
            } => logarithmic.get().unwrap_or(units),
        };
        let inward = units.inward_accuracy(*second, atol_is_given);
        let known = held(units, orbit)?;
        let equations = system.equations(Subspace::Whole);
        let again = crosscheck_of(&equations.field(units)?, &known, &inward)
            .map_err(|error| units.outward_error(error, 0))?;
        Ok(units.outward_crosscheck(again))
    }
}

/// An orbit in the units in which it was found.
pub(super) fn held(units: &MotionUnits, orbit: &Orbit) -> Result<Orbit> {
    let known = units.inward_orbit(orbit);
    match known.nodes.iter().flatten().all(|x| x.is_finite()) {
        true => Ok(known),
        false => Err(Error::Input(
            "on the orbit a state is below the least double".into(),
        )),
    }
}

/// The symmetry that is asked for; interfaces that differ have no symmetric orbit.
fn symmetry(name: Option<&str>, system: &System) -> Result<Symmetry> {
    let unknown = |name| Error::unknown("symmetry", name, &["symmetric", "asymmetric"]);
    let asked = name.map(|name| Symmetry::named(name).ok_or_else(|| unknown(name)));
    match (system.unequal, asked.transpose()?) {
        (None, asked) => Ok(asked.unwrap_or(Symmetry::Symmetric)),
        (Some(_), Some(asked)) => Err(Error::Input(format!(
            "`symmetry` {}: unequal interfaces have no symmetric orbits; leave it out",
            asked.name()
        ))),
        (Some(_), None) => Ok(Symmetry::Asymmetric),
    }
}

/// Where the search begins.
fn begin(options: &OrbitOptions, system: &System, slab: &InterfaceSystem) -> Result<InitialGuess> {
    let inward = |t| {
        Ok(system
            .units
            .inward(Quantity::Time, positive("period-guess", t)?))
    };
    let period = options.period_guess.map(inward).transpose()?;
    Ok(match options.start.as_deref() {
        None if period.is_some() => {
            return Err(Error::Input(
                "`period_guess` needs a `start` near the orbit".into(),
            ));
        }
        None => InitialGuess::Anywhere,
        Some("hopf") if period.is_some() => {
            return Err(Error::Input(
                "`period_guess` goes with a `start` near the orbit, not with `start` hopf".into(),
            ));
        }
        Some("hopf") => InitialGuess::Hopf,
        Some(text) => InitialGuess::At {
            start: start(text, system, &slab.loading)?,
            period,
        },
    })
}
