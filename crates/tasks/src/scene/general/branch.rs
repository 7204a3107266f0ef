//! Branches along any parameter, from options.

use super::following::{self, Free, general, numbers, shown};
use super::{GeneralRow, RowKind, Subject, Watched};
use crate::scene::branch::BranchKind;
use crate::scene::continuation::BranchOptions;
use crate::scene::following::Following;
use serde_json::{Value, json};
use std::ops::ControlFlow;
use twinslip::bifurcation::general::{
    FoundOrbits, GeneralBranch, GeneralEvent, GeneralPoint, GeneralSystem, equilibria, orbits,
};
use twinslip::error::{Error, Result};
use twinslip::integrate::Choice;
use twinslip::number::Uncertain;
use twinslip::orbit::{Coordinate, ParametrisedField};

/// Branches that are asked for, checked.
pub struct GeneralBranchPlan<'s> {
    /// Of equilibria, or of orbits.
    pub kind: RowKind,
    /// What is followed.
    pub subject: &'s dyn Subject,
    /// What varies.
    pub free: Free,
    /// The formulas whose zeros are special points.
    pub watched: Watched,
    /// How many times orbits may double their period.
    pub doublings: usize,
    /// How.
    pub following: Following,
    /// The same for the output.
    pub numerics: Value,
}

/// A row, or a special point.
pub enum GeneralFound {
    /// A row.
    Row(GeneralRow),
    /// A special point.
    Special(GeneralRow),
}

impl<'s> GeneralBranchPlan<'s> {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &BranchOptions, subject: &'s dyn Subject) -> Result<Self> {
        let of = BranchKind::named(options.of.as_deref())?;
        let known = subject.parameters();
        let along = match options.along.as_deref() {
            Some(along) => along,
            None if known.iter().any(|(name, _)| *name == "driving") => "driving",
            None => {
                let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
                return Err(Error::Input(format!(
                    "say which parameter varies: `along` one of {}",
                    names.join(", ")
                )));
            }
        };
        let default = subject.default_range(along);
        let end = |name: &str, given: Option<f64>, default: Option<f64>| {
            given.or(default).ok_or_else(|| {
                Error::Input(format!(
                    "`{name}` is missing, and has no default along {along}"
                ))
            })
        };
        let at = options.at.as_deref();
        let at = at.map_or(Ok(Vec::new()), |text| numbers("at", text))?;
        // A name that is none is told of first.
        let range = match (options.from, options.to) {
            _ if !known.iter().any(|(name, _)| *name == along) => (0.0, 1.0),
            (from, to) => (
                end("from", from, default.map(|range| range.0))?,
                end("to", to, default.map(|range| range.1))?,
            ),
        };
        let free = Free::new(subject, ("along", along), range, &at)?;
        let orbits = of == BranchKind::Orbits;
        following::varies(&options.model, &[along])?;
        following::both_symmetries(&options.symmetry)?;
        let following = Following::new(&options.continuation, orbits)?;
        let kind = RowKind {
            orbits,
            curve: false,
            homoclinic: false,
        };
        let watched = Watched::new((None, &options.watch), subject, kind)?;
        let mut numerics = json!({
            "of": of.name(),
            "along": along,
            "from": range.0,
            "to": range.1,
            "at": at,
            "step_limit": following.step,
            "tolerance": following.tolerance,
            "crosscheck": following.second.map(|second| second.name()),
            "doublings": options.doublings,
        });
        watched.told_in(&mut numerics);
        Ok(GeneralBranchPlan {
            kind,
            subject,
            free,
            watched,
            doublings: of.doublings(options.doublings)?,
            following,
            numerics,
        })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let out = |x| self.subject.units().outward(self.free.quantity, x);
        let method = match self.kind.orbits {
            true => {
                "taylor, tangents on, multiple shooting; begins at the Hopf points, or at an orbit that is given"
            }
            false => {
                "pseudo-arclength continuation from the equilibria at both ends, and through branch points"
            }
        };
        format!(
            "plan of this command
  range             {} from {:e} to {:e}
  method            {method}
  derivatives       exact, in the states and in {}
  landings          {}
  watched           {}
  points            at most {}",
            self.free.name,
            out(self.free.range.0),
            out(self.free.range.1),
            self.free.name,
            match self.free.at.len() {
                0 => "off: no `at` values are given".to_owned(),
                n => format!("on {n} values, each solved for"),
            },
            self.watched.explain(),
            self.following.max_points
        )
    }

    /// A special point of orbits once more, by another method: what the parameter and the period differ by.
    ///
    /// # Errors
    /// Those of the second method.
    pub fn crosscheck(&self, one: &GeneralRow, method: Choice) -> Result<Option<Vec<f64>>> {
        let name = self.free.name;
        let coordinates = [self.free.coordinate, Coordinate::Logarithm];
        let family = self.subject.family(&[name], coordinates)?;
        let alike = self.subject.alike(&[name]);
        let functions = self.watched.of(self.subject, &*family);
        let family = functions.with(&*family);
        let alike = alike.as_deref().map(|alike| functions.with(alike));
        let system = GeneralSystem {
            family: &family,
            alike: alike.as_ref().map(|alike| alike as _),
            difference: None,
            names: [name; 2],
            interchangeable: &[],
            equilibria: &|_| Ok(Vec::new()),
            bounds: &[],
        };
        let unit = self.subject.unit_of_time();
        following::crosscheck(&system, (1, unit), one, method)
    }

    /// Follows them, but those whose numbers are known.
    ///
    /// # Errors
    /// Those of the branches, and of what rows tell.
    pub fn follow(
        &self,
        known: &[usize],
        seen: &mut dyn FnMut(GeneralFound) -> ControlFlow<()>,
    ) -> Result<()> {
        let name = self.free.name;
        let coordinates = [self.free.coordinate, Coordinate::Logarithm];
        let family = self.subject.family(&[name], coordinates)?;
        let alike = self.subject.alike(&[name]);
        let functions = self.watched.of(self.subject, &*family);
        let family = functions.with(&*family);
        let alike = alike.as_deref().map(|alike| functions.with(alike));
        let equilibria_at = |at: [f64; 2]| {
            let value = family.parameters(at)[0];
            self.subject
                .equilibria(&[(name, self.free.asked(at[0]).unwrap_or(value))])
        };
        let within = |point: &GeneralPoint, sharp: bool| self.subject.within(&family, point, sharp);
        let clusters = !self.subject.clusters().is_empty();
        let interchangeable = self.subject.interchangeable();
        let bounds = self.subject.bounds();
        let mut branch = GeneralBranch {
            system: GeneralSystem {
                family: &family,
                alike: alike.as_ref().map(|alike| alike as _),
                difference: None,
                names: [name; 2],
                interchangeable: &interchangeable,
                equilibria: &equilibria_at,
                bounds: &bounds,
            },
            range: self.free.ends(),
            beyond: self.free.beyond(),
            held: 0.0,
            at: self.free.landings(),
            watch: self.watched.texts.clone(),
            orbit: None,
            found: None,
            hopfs: None,
            symmetry: None,
            doublings: self.doublings,
            within: clusters.then_some(&within),
            following: general(&self.following, known),
        };
        if self.kind.orbits {
            branch.orbit = self.subject.orbit(&[(name, self.free.range.0)])?;
            if let Some(orbit) = &mut branch.orbit {
                orbit.at = [branch.range.0, 0.0];
            }
        }
        let found_at = |coordinate: f64| {
            let value = family.parameters([coordinate, 0.0])[0];
            let value = self.free.asked(coordinate).unwrap_or(value);
            self.subject.orbits(&[(name, value)])
        };
        let own = self.subject.value(name).ok();
        let own = own.map(|value| self.free.coordinate.inward(value));
        branch.found = self.kind.orbits.then_some(FoundOrbits {
            at: &found_at,
            within: own,
        });
        let mut failed = None;
        let mut met = 0;
        let mut look = |event: GeneralEvent| {
            met += 1;
            let how = (self.kind, self.following.tolerance);
            let found = found(self.subject, &family, how, &[&self.free], event);
            match found {
                Ok(found) => seen(found),
                Err(error) => {
                    failed = Some(error);
                    ControlFlow::Break(())
                }
            }
        };
        match self.kind.orbits {
            true => orbits(&branch, &mut look)?,
            false => equilibria(&branch, &mut look)?,
        }
        match failed {
            Some(error) => Err(error),
            None if met == 0 && known.is_empty() && !self.subject.may_rest() => Err(Error::NoOrbit {
                what: "no orbit of so many periods of the forcing was found at the ends of the range".into(),
                period: None,
                hint: "give a `start` near an orbit, other `turns`, or another range",
            }),
            None if met == 0 && known.is_empty() => Err(nothing(self.kind.orbits)),
            None => Ok(()),
        }
    }
}

/// What is said where nothing is found to begin with.
fn nothing(orbits: bool) -> Error {
    Error::NoOrbit {
        what: match orbits {
            true => "there is no Hopf point on the equilibria in the range, and no orbit was found at its ends".into(),
            false => "no equilibrium is found at either end of the range".into(),
        },
        period: None,
        hint: match orbits {
            true => {
                "give a `start` near an orbit, or a `box` with all equilibria, or another range"
            }
            false => "give a `start` near one, or a `box`, or another range",
        },
    }
}

/// What is found, as a row or a special point.
pub(super) fn found(
    subject: &dyn Subject,
    family: &dyn ParametrisedField,
    (kind, tolerance): (RowKind, f64),
    free: &[&Free],
    event: GeneralEvent,
) -> Result<GeneralFound> {
    let names = shown(subject, free);
    let exactly = |mut point: GeneralPoint| {
        for (i, free) in free.iter().enumerate() {
            // As it was given, and not the exponential of its logarithm.
            if let Some(given) = free.asked(point.at[i]) {
                point.parameters[i] = Uncertain::new(given, 0.0);
            }
        }
        point
    };
    let row = |point| GeneralRow::of(subject, family, (kind, &names), point);
    Ok(match event {
        GeneralEvent::Row(point) => GeneralFound::Row(row(exactly(point))?),
        GeneralEvent::Special(point) => {
            let point = exactly(point);
            let values = free.iter().zip(&point.parameters);
            let sizes: Vec<f64> = values.map(|(free, x)| free.size(x.value)).collect();
            GeneralFound::Special(row(point.against(tolerance, &sizes))?)
        }
    })
}
