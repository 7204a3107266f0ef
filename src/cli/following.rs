//! The options that `branch` and `locus` share, checked.

use crate::bifurcation::Criticality;
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::friction::positive;
use crate::integrate::Choice;
use crate::scene::{ContinuationOptions, Quantity, Units};

/// V_H from, to: what the paper considers.
pub const DRIVING: (f64, f64) = (1e-3, 1e6);
/// K from, to.
pub const STIFFNESS: (f64, f64) = (1e-3, 1.0);

/// How to follow, checked.
pub struct Following {
    /// Factor on the step limits.
    pub step: f64,
    /// Accuracy of special points.
    pub tolerance: f64,
    /// The second method.
    pub second: Option<Choice>,
}

impl Following {
    /// Checks the options; a second method makes sense for orbits alone.
    pub fn new(options: &ContinuationOptions, orbits: bool) -> Result<Self> {
        let tolerance = options.tolerance;
        if !(1e-15..=1e-3).contains(&tolerance) {
            return Err(Error::parameter(
                "tolerance",
                tolerance,
                "at least 1e-15 and at most 1e-3",
            ));
        }
        let second = options.crosscheck.as_deref().filter(|&name| name != "none");
        if second.is_some() && !orbits {
            return Err(Error::Input(
                "--crosscheck goes with orbits: equilibria and their bifurcations are not integrated".into(),
            ));
        }
        Ok(Following {
            step: positive("step-limit", options.step_limit)?,
            tolerance,
            second: second.map(Choice::named).transpose()?,
        })
    }
}

/// One symmetry, or both.
pub fn symmetry(name: &str, interfaces: usize) -> Result<Option<Symmetry>> {
    match name {
        "both" => Ok(None),
        "symmetric" => Ok(Some(Symmetry::Symmetric)),
        "asymmetric" if interfaces == 1 => Err(Error::Input(
            "symmetry is asymmetric, but a single interface has nothing to differ from".into(),
        )),
        "asymmetric" => Ok(Some(Symmetry::Asymmetric)),
        other => Err(Error::parameter(
            "symmetry",
            other,
            "symmetric, asymmetric or both",
        )),
    }
}

/// A range of a parameter, whose ends must differ.
pub fn range(name: &str, (from, to): (f64, f64)) -> Result<(f64, f64)> {
    if from == to {
        return Err(Error::Input(format!(
            "{name} begins and ends at {from:?}, but must have two different ends"
        )));
    }
    Ok((from, to))
}

/// Positive numbers, comma-separated, in the user's units.
pub fn numbers(name: &str, text: &str) -> Result<Vec<f64>> {
    text.split(',')
        .map(|word| match word.trim().parse::<f64>() {
            Ok(x) => positive(name, x),
            Err(_) => Err(Error::Input(format!(
                "--{name} {text}: {word:?} is not a number; it must be positive numbers with commas between"
            ))),
        })
        .collect()
}

/// The values of an option to land on, dimensionless, which must lie in the range.
pub fn landings(
    name: &str,
    text: Option<&str>,
    (quantity, units): (Quantity, &Units),
    ends: (f64, f64),
) -> Result<Vec<f64>> {
    let (low, high) = (ends.0.min(ends.1), ends.0.max(ends.1));
    let values = text.map_or(Ok(Vec::new()), |text| numbers(name, text))?;
    let inside = |shown: f64| {
        let x = units.inward(quantity, shown);
        let out = |x| units.outward(quantity, x);
        if (low..=high).contains(&x) {
            return Ok(x);
        }
        Err(Error::Input(format!(
            "{name} is {shown:?}, but must be in the range from {:?} to {:?}",
            out(low),
            out(high)
        )))
    };
    values.into_iter().map(inside).collect()
}

/// To which side a bifurcation goes, in a word.
pub fn criticality(criticality: Criticality) -> &'static str {
    match criticality {
        Criticality::Supercritical => "supercritical",
        Criticality::Subcritical => "subcritical",
        Criticality::Undecided => "undecided",
    }
}

/// The line of `--explain` on the symmetry.
pub fn explain_symmetry(symmetry: Option<Symmetry>, interfaces: usize) {
    let words = match symmetry {
        _ if interfaces == 1 => "a single interface has none; dimension 2",
        None => "both: symmetric in dimension 2, asymmetric in 3",
        Some(Symmetry::Symmetric) => "symmetric alone, in dimension 2; the mode across beside it",
        Some(Symmetry::Asymmetric) => "asymmetric alone, in dimension 3",
    };
    eprintln!("  symmetry          {words}");
}

/// The lines of `--explain` on steps, accuracy, landings and the crosscheck.
pub fn explain(following: &Following, at: &[f64]) {
    eprintln!("  step limits       times {}", following.step);
    eprintln!(
        "  special points    to {:e}, relatively",
        following.tolerance
    );
    match at.len() {
        0 => eprintln!("  landings          off: no --at values are given"),
        n => eprintln!("  landings          on {n} values, each solved for"),
    }
    match following.second {
        Some(second) => eprintln!(
            "  crosscheck        {}, of every special point",
            second.name()
        ),
        None => eprintln!("  crosscheck        off: --crosscheck is not given"),
    }
    eprintln!("  rows              written as they come, and kept for the picture and the object");
}
