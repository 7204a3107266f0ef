//! The options that branches and curves share, checked.

use super::continuation::ContinuationOptions;
use super::units::{Quantity, Units};
use twinslip::bifurcation::UserFunction;
use twinslip::equilibrium::Symmetry;
use twinslip::error::{Error, Result, option_name};
use twinslip::friction::positive;
use twinslip::integrate::Choice;

/// V_H from, to: what the paper considers.
pub(super) const DRIVING: (f64, f64) = (1e-3, 1e6);
/// K from, to.
pub(super) const STIFFNESS: (f64, f64) = (1e-3, 1.0);

/// The range of V_H or K where none is given; `None` for other parameters.
pub(super) fn loading_range(name: &str) -> Option<(f64, f64)> {
    match name {
        "driving" => Some(DRIVING),
        "stiffness" => Some(STIFFNESS),
        _ => None,
    }
}

/// What `--symmetry` takes.
pub(super) const SYMMETRIES: [&str; 3] = ["symmetric", "asymmetric", "both"];

/// How to follow, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Following {
    /// Factor on the step limits.
    pub step: f64,
    /// Accuracy of special points.
    pub tolerance: f64,
    /// How many points there may be.
    pub max_points: usize,
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
                "`crosscheck` applies only to orbits: equilibria and their bifurcations are not integrated".into(),
            ));
        }
        Ok(Following {
            step: positive("step-limit", options.step_limit)?,
            tolerance,
            max_points: match options.max_points {
                0 => return Err(Error::parameter("max-points", 0, "at least 1")),
                points => points,
            },
            second: second
                .map(|name| Choice::named_by("crosscheck", name))
                .transpose()?,
        })
    }
}

/// One symmetry, or both.
pub(super) fn symmetry(name: &str, interfaces: usize) -> Result<Option<Symmetry>> {
    match name {
        "both" => Ok(None),
        "symmetric" => Ok(Some(Symmetry::Symmetric)),
        "asymmetric" if interfaces == 1 => Err(Error::Input(
            "symmetry is asymmetric, but there is a single interface".into(),
        )),
        "asymmetric" => Ok(Some(Symmetry::Asymmetric)),
        other => Err(Error::unknown("symmetry", other, &SYMMETRIES)),
    }
}

/// A range of a parameter, whose ends must differ.
pub(super) fn range(name: &str, (from, to): (f64, f64)) -> Result<(f64, f64)> {
    if from == to {
        return Err(Error::Input(format!(
            "{name} begins and ends at {from:?}, but must have two different ends"
        )));
    }
    Ok((from, to))
}

/// Positive numbers, comma-separated, in the user's units.
pub(super) fn numbers(name: &str, text: &str) -> Result<Vec<f64>> {
    text.split(',')
        .map(|word| number(name, text, word))
        .collect()
}

/// One of the positive numbers in the text of an option.
pub(super) fn number(name: &str, text: &str, word: &str) -> Result<f64> {
    match word.trim().parse::<f64>() {
        Ok(x) => positive(name, x),
        Err(_) => Err(Error::Input(format!(
            "{} {text}: {word:?} is not a number",
            option_name(name)
        ))),
    }
}

/// The values of an option to land on, dimensionless, which must lie in the range.
pub(super) fn landings(
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

/// The line of a plan on the symmetry.
pub(super) fn explain_symmetry(symmetry: Option<Symmetry>, interfaces: usize) -> String {
    let words = match symmetry {
        _ if interfaces == 1 => "none: a single interface, in dimension 2",
        None if interfaces > 2 => "both: all interfaces in phase, and in clusters",
        Some(_) if interfaces > 2 => "one: all interfaces in phase, or in clusters",
        None => "both: symmetric in dimension 2, asymmetric in 3",
        Some(Symmetry::Symmetric) => "symmetric only, in dimension 2, with the transverse mode",
        Some(Symmetry::Asymmetric) => "asymmetric only, in dimension 3",
    };
    format!("  symmetry          {words}\n")
}

/// The words of a plan on what is watched.
pub(super) fn explain_watched(texts: &[String]) -> String {
    match texts {
        [] => "off: no `watch` is given".to_owned(),
        texts => format!("zeros of {}, each solved for", texts.join("; ")),
    }
}

/// The lines of a plan on steps, accuracy, landings, what is watched and the crosscheck.
pub(super) fn explain(following: &Following, at: &[f64], watch: &[UserFunction]) -> String {
    let landings = match at.len() {
        0 => "off: no `at` values are given".to_owned(),
        n => format!("on {n} values, each solved for"),
    };
    let texts: Vec<String> = watch.iter().map(|one| one.text.clone()).collect();
    let watched = explain_watched(&texts);
    let second = match following.second {
        Some(second) => format!("{}, of every special point", second.name()),
        None => "off: `crosscheck` is not given".to_owned(),
    };
    format!(
        "  step limits       times {}
  points            at most {}
  special points    to {:e}, relatively
  landings          {landings}
  watched           {watched}
  crosscheck        {second}
  rows              written as they come, and kept for the picture and the object",
        following.step, following.max_points, following.tolerance
    )
}
