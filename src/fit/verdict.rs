//! Whether a fit determines its parameters, and if not, in words, which.

use super::FittedParameter;
use super::free::Scale;
use super::least_squares::Minimum;
use super::problem::Problem;
use nalgebra::DMatrix;

/// A parameter whose standard error is a factor of more than this, e, is not determined.
const UNDETERMINED: f64 = 1.0;
/// Beyond this correlation two parameters are known by one combination.
const INSEPARABLE: f64 = 0.9995;

/// What is certain of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Whether the search ended at a minimum.
    pub is_minimum: bool,
    /// A sentence for each parameter, or pair, that the data do not determine.
    pub undecided: Vec<String>,
    /// The parameters that are not determined.
    pub undetermined: Vec<String>,
}

impl Verdict {
    /// Whether a parameter is not determined to the point that its value says nothing: it has no error, or one that is larger than itself where
    /// it can only be positive. Its interval then says what is known.
    pub fn has_run_away(&self, parameter: &FittedParameter) -> bool {
        let is_told = self.undetermined.contains(&parameter.label());
        is_told && (!parameter.uncertainty.is_finite() || is_wide(parameter))
    }

    /// "converged" where it is a minimum that determines all parameters, else "undecided".
    pub fn name(&self) -> &'static str {
        if self.is_minimum && self.undecided.is_empty() {
            "converged"
        } else {
            "undecided"
        }
    }
}

/// Whether a parameter that is varied by its logarithm is not even known to a factor of e.
fn is_wide(parameter: &FittedParameter) -> bool {
    parameter.scale == Scale::Logarithmic && parameter.uncertainty > UNDETERMINED * parameter.value
}

/// The verdict on a minimum.
pub fn undecided<const N: usize>(
    problem: &Problem<'_, N>,
    minimum: &Minimum,
    parameters: &[FittedParameter],
    correlation: &DMatrix<f64>,
) -> Verdict {
    let mut sentences = Vec::new();
    if !minimum.converged {
        sentences.push("the search ended before a minimum of the sum of squares".to_owned());
    }
    let bounds = problem.bounds();
    let mut told = vec![false; parameters.len()];
    for (i, one) in parameters.iter().enumerate() {
        let (low, high) = bounds[i];
        let variable = minimum.variables[i];
        let zero = if one.scale == Scale::Logarithmic {
            0.0
        } else {
            f64::NEG_INFINITY
        };
        let gone = problem
            .records
            .iter()
            .flat_map(|one| &one.record.displacement);
        let gone = gone.fold(0.0, |most: f64, x| most.max(x.abs()));
        let is_length = one.name.starts_with("slip_length");
        let why = if !one.uncertainty.is_finite() {
            "the friction does not depend on it, or not on it alone"
        } else if is_length && one.value > gone {
            "it is longer than the load point moves"
        } else if variable <= low || variable >= high {
            "it is at its bound"
        } else if one.interval.0 <= zero && one.interval.1.is_infinite() {
            "its 95 % interval is unbounded"
        } else if one.interval.1.is_infinite() {
            "its 95 % interval has no upper bound"
        } else if one.interval.0 <= zero {
            "its 95 % interval has no lower bound"
        } else if is_wide(one) {
            "its standard error is larger than itself"
        } else {
            continue;
        };
        told[i] = true;
        let partner = partner(correlation, i).filter(|(_, rho)| rho.abs() > 0.9);
        let with = partner.map_or(String::new(), |(j, rho)| {
            format!(
                ", and these data determine it only together with {} (correlation {rho:.4})",
                parameters[j].label()
            )
        });
        sentences.push(format!("{} is not determined: {why}{with}", one.label()));
    }
    for i in 0..parameters.len() {
        for j in 0..i {
            let rho = correlation[(i, j)];
            if rho.abs() > INSEPARABLE && !told[i] && !told[j] {
                sentences.push(format!(
                    "only one combination of {} and {} is determined (correlation {rho:.5}): fix one of them",
                    parameters[j].label(), parameters[i].label()
                ));
            }
        }
    }
    let names = parameters.iter().map(FittedParameter::label);
    Verdict {
        is_minimum: minimum.converged,
        undecided: sentences,
        undetermined: names
            .zip(&told)
            .filter(|(_, told)| **told)
            .map(|(name, _)| name)
            .collect(),
    }
}

/// The parameter with which one is correlated most.
fn partner(correlation: &DMatrix<f64>, of: usize) -> Option<(usize, f64)> {
    let others = (0..correlation.ncols()).filter(|&j| j != of);
    let each = others.map(|j| (j, correlation[(of, j)]));
    each.max_by(|one, other| one.1.abs().total_cmp(&other.1.abs()))
}
