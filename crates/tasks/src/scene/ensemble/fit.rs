//! What `twinslip fit` has written: parameters of friction with their covariance, and those that were fixed.

use super::super::file::read_bounded;
use super::super::text::given_text;
use super::file::told;
use nalgebra::{DMatrix, DVector};
use serde::Deserialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;
use twinslip::error::{Error, Result};
use twinslip::friction::AnyLaw;
use twinslip::number::symmetric_eigenvalues;

/// No file of a fit is longer, in bytes: it may hold all rows.
const LONGEST: u64 = 1 << 30;
/// The parameters of friction, by the names of `--set`, with V*.
pub(super) const NAMES: [&str; 9] = [
    "direct_effect",
    "evolution_effect",
    "reference_friction",
    "slip_length",
    "reference_rate",
    "normal_stress",
    "healing_time",
    "residual_strength",
    "damping",
];
/// What is of the apparatus in the laboratory, and not of the interfaces here.
const APPARATUS: [&str; 3] = ["stiffness", "drift", "driving"];
/// Correlations are asymmetric, and variances negative, by rounding to this much.
const ROUNDED: f64 = 1e-8;

/// A parameter that was fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedParameter {
    /// Its name.
    pub name: &'static str,
    /// The estimate, in SI.
    pub value: f64,
    /// The standard error of its logarithm, or of itself.
    pub deviation: f64,
    /// Whether its logarithm is normally distributed, and not itself.
    pub log: bool,
}

impl FittedParameter {
    /// Its value so many standard errors above the estimate.
    pub fn above(&self, deviations: f64) -> f64 {
        let by = deviations * self.deviation;
        match self.log {
            true => self.value * by.exp(),
            false => self.value + by,
        }
    }
}

/// The friction that a fit has found.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionFit {
    /// The law, one that is built in.
    pub law: String,
    /// Whether the fit has converged.
    pub converged: bool,
    /// What was fitted, without the apparatus.
    pub parameters: Vec<FittedParameter>,
    /// A factor of their correlations: correlated standard normal numbers are its product with independent ones.
    pub factor: DMatrix<f64>,
    /// Their correlations.
    pub correlation: DMatrix<f64>,
    /// Draws of all parameters from the posterior, where the fit has any.
    pub draws: Vec<Vec<f64>>,
    /// What was fixed, in SI.
    pub fixed: Vec<(&'static str, f64)>,
}

#[derive(Deserialize)]
struct Envelope {
    result: Outcome,
}

#[derive(Deserialize)]
struct Outcome {
    fit: Fitted,
    posterior: Option<Drawn>,
}

#[derive(Deserialize)]
struct Drawn {
    parameters: Vec<DrawnParameter>,
}

#[derive(Deserialize)]
struct DrawnParameter {
    name: String,
    draws: Vec<f64>,
}

#[derive(Deserialize)]
struct Fitted {
    law: String,
    states: u64,
    verdict: String,
    parameters: Vec<OneFitted>,
    correlation: Vec<Vec<Option<f64>>>,
    fixed: BTreeMap<String, Option<f64>>,
}

#[derive(Deserialize)]
struct OneFitted {
    name: String,
    value: Option<f64>,
    uncertainty: Option<f64>,
    scale: String,
}

impl FrictionFit {
    /// Reads the object that `twinslip fit --format json` writes, from a file or a text in its place.
    ///
    /// # Errors
    /// [`Error::File`] if it can't be read; [`Error::Input`] for what is no fit, and for one that has no meaning here.
    pub fn read(path: &Path) -> Result<Self> {
        let text: Cow<'_, str> = match given_text(path) {
            Some(text) => text.into(),
            None => read_bounded(path, LONGEST)?.into(),
        };
        let wrong = |what: String| Error::Input(format!("`ensemble` {}: {what}", told(path)));
        let object: Envelope = serde_json::from_str(&text).map_err(|error| {
            wrong(format!(
                "it is not what twinslip fit writes as JSON: {error}"
            ))
        })?;
        let Outcome { fit, posterior } = object.result;
        let mut read = Self::of(fit).map_err(wrong)?;
        if let Some(drawn) = posterior {
            read.draws = draws(&read.parameters, &drawn).map_err(wrong)?;
        }
        Ok(read)
    }

    fn of(fit: Fitted) -> Result<Self, String> {
        if fit.states != 1 {
            return Err(format!(
                "the fit has {} state variables, and interfaces have one",
                fit.states
            ));
        }
        if !AnyLaw::NAMES.contains(&fit.law.as_str()) {
            return Err(format!(
                "the fit has the law {}, which is not built in: a law from a file has no units here",
                fit.law
            ));
        }
        let kept: Vec<usize> = (0..fit.parameters.len())
            .filter(|&i| !APPARATUS.contains(&fit.parameters[i].name.as_str()))
            .collect();
        if kept.is_empty() {
            return Err("the fit has no parameter of friction".into());
        }
        let parameters = kept.iter().map(|&i| fitted(&fit.parameters[i]));
        let parameters: Vec<FittedParameter> = parameters.collect::<Result<_, String>>()?;
        for (i, one) in parameters.iter().enumerate() {
            if parameters[..i].iter().any(|other| other.name == one.name) {
                return Err(format!(
                    "the fit has {} for each of several records, and interfaces have one: fit it as what they share, by `each`",
                    one.name
                ));
            }
        }
        let correlation = correlation(&fit.correlation, fit.parameters.len())?;
        let own = |i: usize, j: usize| correlation[(kept[i], kept[j])];
        let correlation = DMatrix::from_fn(kept.len(), kept.len(), own);
        let fixed = fit.fixed.iter().filter_map(|(name, value)| {
            let name = NAMES.into_iter().find(|known| known == name)?;
            Some((name, (*value)?))
        });
        Ok(FrictionFit {
            converged: fit.verdict == "converged",
            law: fit.law,
            factor: factor(&correlation)?,
            parameters,
            correlation,
            draws: Vec::new(),
            fixed: fixed.collect(),
        })
    }

    /// The values of all parameters at the estimate.
    pub fn middle(&self) -> Vec<f64> {
        self.parameters.iter().map(|one| one.value).collect()
    }

    /// The values of all parameters in a draw: one of the posterior, spread over all of them, or else by the covariance from independent
    /// normal numbers.
    pub fn draw(&self, number: usize, normal: impl FnOnce(usize) -> DVector<f64>) -> Vec<f64> {
        /// Steps of the golden section hit all draws before they hit one twice, and any number of them evenly.
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let count = self.draws.len();
        if count == 0 {
            return self.above(&(&self.factor * normal(self.parameters.len())));
        }
        let place = (number as f64 * GOLDEN).fract() * count as f64;
        self.draws[(place as usize).min(count - 1)].clone()
    }

    /// The values of all parameters so many standard errors above the estimate.
    pub fn above(&self, deviations: &DVector<f64>) -> Vec<f64> {
        let all = self.parameters.iter().zip(deviations.iter());
        all.map(|(one, &by)| one.above(by)).collect()
    }
}

/// The draws of these parameters, a list for each draw.
fn draws(parameters: &[FittedParameter], drawn: &Drawn) -> Result<Vec<Vec<f64>>, String> {
    let of = |own: &FittedParameter| {
        let found = drawn.parameters.iter().find(|one| one.name == own.name);
        let found = found.ok_or_else(|| format!("its posterior has no draws of {}", own.name))?;
        let is_right = |x: &&f64| x.is_finite() && (!own.log || **x > 0.0);
        match found.draws.iter().find(|x| !is_right(x)) {
            Some(wrong) => Err(format!("a draw of {} is {wrong}", own.name)),
            None => Ok(&found.draws),
        }
    };
    let columns = parameters
        .iter()
        .map(of)
        .collect::<Result<Vec<_>, String>>()?;
    let count = columns[0].len();
    if count == 0 || columns.iter().any(|own| own.len() != count) {
        return Err("its posterior has not as many draws of each parameter".to_owned());
    }
    let row = |i: usize| columns.iter().map(|own| own[i]).collect();
    Ok((0..count).map(row).collect())
}

fn fitted(one: &OneFitted) -> Result<FittedParameter, String> {
    let name = NAMES.into_iter().find(|known| *known == one.name);
    let name = name.ok_or_else(|| {
        format!(
            "the fit has {}, which is no parameter of an interface; these are {}",
            one.name,
            NAMES.join(", ")
        )
    })?;
    let told = |x: Option<f64>| x.map_or("null".to_owned(), |x| x.to_string());
    let value = one.value.filter(|x| x.is_finite());
    let value = value.ok_or_else(|| format!("{name} is {}", told(one.value)))?;
    let uncertainty = one.uncertainty.filter(|x| x.is_finite() && *x >= 0.0);
    let uncertainty = uncertainty.ok_or_else(|| {
        format!(
            "the uncertainty of {name} is {}, but must be 0 or positive",
            told(one.uncertainty)
        )
    })?;
    let log = match one.scale.as_str() {
        "log" if value > 0.0 => true,
        "log" => return Err(format!("{name} is {value}, but must be positive")),
        "linear" => false,
        other => {
            return Err(format!(
                "the scale of {name} is {other:?}, but must be log or linear"
            ));
        }
    };
    Ok(FittedParameter {
        name,
        value,
        deviation: if log {
            uncertainty / value
        } else {
            uncertainty
        },
        log,
    })
}

fn correlation(rows: &[Vec<Option<f64>>], size: usize) -> Result<DMatrix<f64>, String> {
    if rows.len() != size || rows.iter().any(|row| row.len() != size) {
        return Err(format!(
            "its correlations must be {size} rows of {size} numbers, as it has {size} parameters"
        ));
    }
    let all = DMatrix::from_fn(size, size, |i, j| rows[i][j].unwrap_or(f64::NAN));
    for i in 0..size {
        for j in 0..size {
            let (one, other) = (all[(i, j)], all[(j, i)]);
            let right = (one - other).abs() <= ROUNDED
                && one.abs() <= 1.0 + ROUNDED
                && (i != j || (one - 1.0).abs() <= ROUNDED);
            if !right {
                return Err(format!(
                    "the correlation in row {}, column {} is {one}, but must be between -1 and 1, the same across, and 1 with itself",
                    i + 1,
                    j + 1
                ));
            }
        }
    }
    Ok(all)
}

/// A factor of a matrix that may be singular, as of two parameters that are known only by their ratio.
fn factor(correlation: &DMatrix<f64>) -> Result<DMatrix<f64>, String> {
    let Some((eigenvalues, eigenvectors)) = symmetric_eigenvalues(correlation) else {
        return Err("its correlations have no eigenvalues".to_owned());
    };
    let least = eigenvalues.min();
    if least < -ROUNDED {
        return Err(format!(
            "its correlations are of no distribution: an eigenvalue of them is {least:e}"
        ));
    }
    let roots = eigenvalues.map(|x| x.max(0.0).sqrt());
    Ok(eigenvectors * DMatrix::from_diagonal(&roots))
}
