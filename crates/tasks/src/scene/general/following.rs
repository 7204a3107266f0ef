//! Names, ranges and values that branches and curves in any parameters share.

use super::{GeneralRow, Subject};
use crate::scene::following::{self, Following};
use crate::scene::options::ModelOptions;
use crate::scene::units::Quantity;
use twinslip::bifurcation::general::{GeneralFollowing, GeneralSystem};
use twinslip::error::{Error, Result};
use twinslip::integrate::Choice;
use twinslip::orbit::Coordinate;

/// A parameter that varies, with its range and the values to land on, dimensionless.
#[derive(Debug, Clone, PartialEq)]
pub struct Free {
    /// Its name.
    pub name: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// From where to where; the larger one may come first.
    pub range: (f64, f64),
    /// Values to land on.
    pub at: Vec<f64>,
    /// How it is measured along the continuation.
    pub coordinate: Coordinate,
}

impl Free {
    /// Checks the range and the values, which are in the user's units.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is none; [`Error::Input`] for a range without two different ends, and for values
    /// outside of it.
    pub fn new(
        subject: &dyn Subject,
        (option, name): (&str, &str),
        range: (f64, f64),
        at: &[f64],
    ) -> Result<Self> {
        let known = subject.parameters();
        let Some(&(name, quantity)) = known.iter().find(|(known, _)| *known == name) else {
            let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
            if names.is_empty() {
                let what = format!("`{option}` {name}: the system has no parameters");
                return Err(Error::Input(what));
            }
            return Err(Error::unknown(option, name, &names));
        };
        if range.0 == range.1 {
            return Err(Error::Input(format!(
                "the range of {name} begins and ends at {:?}, but must have two different ends",
                range.0
            )));
        }
        let (low, high) = (range.0.min(range.1), range.0.max(range.1));
        if let Some(x) = at.iter().find(|x| !(low..=high).contains(*x)) {
            return Err(Error::Input(format!(
                "`at` of {name} is {x:?}, but must be in the range from {low:?} to {high:?}"
            )));
        }
        let inward = |x: f64| subject.units().inward(quantity, x);
        let range = (inward(range.0), inward(range.1));
        Ok(Free {
            name,
            quantity,
            coordinate: subject.coordinate(name, [range.0, range.1])?,
            range,
            at: at.iter().map(|&x| inward(x)).collect(),
        })
    }

    /// The range in the coordinate.
    pub fn ends(&self) -> (f64, f64) {
        let inward = |x| self.coordinate.inward(x);
        (inward(self.range.0), inward(self.range.1))
    }

    /// The range with as much again at both sides, or in logarithms a decade: there orbits may begin that come into it.
    pub fn beyond(&self) -> (f64, f64) {
        let (from, to) = self.ends();
        let more = match self.coordinate {
            Coordinate::Logarithm => std::f64::consts::LN_10,
            Coordinate::Linear(_) => (to - from).abs(),
        };
        let more = more.copysign(to - from);
        (from - more, to + more)
    }

    /// The values to land on in the coordinate.
    pub fn landings(&self) -> Vec<f64> {
        self.at.iter().map(|&x| self.coordinate.inward(x)).collect()
    }

    /// What an error of this value is relative to: the value, and near 0 no less than the unit in which it is followed.
    pub fn size(&self, value: f64) -> f64 {
        match self.coordinate {
            Coordinate::Logarithm => value.abs(),
            Coordinate::Linear(unit) => value.abs().max(unit),
        }
    }

    /// The number that was asked for and has this coordinate: not what comes back from it.
    pub fn asked(&self, coordinate: f64) -> Option<f64> {
        let ends = [self.range.0, self.range.1];
        let mut all = ends.into_iter().chain(self.at.iter().copied());
        all.find(|&x| self.coordinate.inward(x) == coordinate)
    }
}

/// The parameters that rows show: those that vary, and those that are always told.
pub fn shown(subject: &dyn Subject, free: &[&Free]) -> Vec<(&'static str, Quantity)> {
    let mut shown: Vec<_> = free.iter().map(|free| (free.name, free.quantity)).collect();
    for one in subject.always_told() {
        if !shown.contains(&one) {
            shown.push(one);
        }
    }
    shown
}

/// Checks that no parameter which varies is given a value, too.
///
/// # Errors
/// [`Error::Input`] for one that is.
pub fn varies(model: &ModelOptions, free: &[&str]) -> Result<()> {
    for name in free {
        if model.gives(name)? {
            return Err(Error::Input(format!(
                "`{name}` is a free parameter and cannot be given a value; give its range"
            )));
        }
    }
    Ok(())
}

/// Checks that V_H and K, which have no default, are given where an orbit is and they vary: it is one at these values.
///
/// # Errors
/// [`Error::Input`] for one that is missing.
pub fn starts_at(model: &ModelOptions, free: &[&str]) -> Result<()> {
    for name in free {
        if following::loading_range(name).is_some() && !model.gives(name)? {
            return Err(Error::Input(format!(
                "`start` belongs to an orbit at values of both free parameters; give its `{name}` too"
            )));
        }
    }
    Ok(())
}

/// Checks the symmetry where branches are followed together, whatever theirs is.
///
/// # Errors
/// [`Error::Input`] for one alone; [`Error::Parameter`] for a name that is none.
pub fn both_symmetries(name: &str) -> Result<()> {
    match following::symmetry(name, 2)? {
        None => Ok(()),
        Some(_) => Err(Error::Input(format!(
            "`symmetry` {name} applies only to equal interfaces with driving and stiffness as free parameters; leave it out"
        ))),
    }
}

/// Numbers, comma-separated.
///
/// # Errors
/// [`Error::Input`] for what is not a finite number.
pub fn numbers(option: &str, text: &str) -> Result<Vec<f64>> {
    let one = |word: &str| {
        let x = word.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        x.ok_or_else(|| {
            Error::Input(format!(
                "`{option}` {text:?}: {word:?} is not a finite number"
            ))
        })
    };
    text.split(',').map(one).collect()
}

/// How it is followed.
pub fn general(following: &Following, known: &[usize]) -> GeneralFollowing {
    GeneralFollowing {
        step: following.step,
        skip: known.to_vec(),
        max_points: following.max_points,
    }
}

/// Relative differences in the free parameters and, last, the period between a special orbit and the same one by another method; of a zero
/// the difference itself. `None` for points that are no orbit's.
///
/// # Errors
/// As of [`GeneralSystem::crosscheck`].
pub fn crosscheck(
    system: &GeneralSystem<'_>,
    (free, unit_of_time): (usize, f64),
    one: &GeneralRow,
    method: Choice,
) -> Result<Option<Vec<f64>>> {
    let (Some(orbit), Some(period)) = (&one.orbit, one.period) else {
        return Ok(None);
    };
    let second = system.crosscheck(orbit, method)?;
    let against = |first: f64, second: f64| match first {
        0.0 => second,
        first => second / first - 1.0,
    };
    let parameters = one.parameters[..free].iter().zip(second);
    let parameters = parameters.map(|(first, second)| against(first.value, second));
    let period = against(period.value, second[2] * unit_of_time);
    Ok(Some(parameters.chain([period]).collect()))
}
