//! Whether records agree on what they share.

use super::{Fit, FittedParameter, Scale};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Records that agree differ so much, or more, in this part of cases.
const DISAGREE: f64 = 0.01;

/// What several records say of a parameter that they share.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// Its name.
    pub name: String,
    /// The variable and its standard error by each record alone; none by one that does not determine it.
    pub alone: Vec<Option<(f64, f64)>>,
    /// Cochran's Q: the squares of what they differ by from their mean, in standard errors.
    pub q: f64,
    /// Records that determine it, less one.
    pub degrees_of_freedom: usize,
    /// How often records that agree have such a Q, or a larger one.
    pub probability: f64,
    /// By what standard errors are multiplied as the records differ more than their noise explains: the square root of Q over its degrees of
    /// freedom (Birge 1932), 1 where they agree.
    pub widening: f64,
    /// Records without which the others agree: the fewest, and less than half of them.
    pub outlying: Vec<usize>,
}

impl Agreement {
    /// Of a parameter, by fits of each record alone.
    pub fn of(name: &str, fits: &[Option<&Fit>]) -> Self {
        let alone = fits.iter().map(|fit| {
            let fit = (*fit)?;
            let one = fit.parameters.iter().find(|one| one.name == name)?;
            let is_lost = fit.verdict.undetermined.contains(&one.label());
            let (variable, error) = variable(one);
            (!is_lost && error.is_finite() && error > 0.0).then_some((variable, error))
        });
        let alone: Vec<Option<(f64, f64)>> = alone.collect();
        let known: Vec<(usize, (f64, f64))> = alone
            .iter()
            .enumerate()
            .filter_map(|(i, one)| Some((i, (*one)?)))
            .collect();
        let q = disagreement(&known);
        let degrees_of_freedom = known.len().saturating_sub(1);
        let probability = chance(q, degrees_of_freedom);
        let widening = match probability < DISAGREE {
            true => (q / degrees_of_freedom as f64).sqrt().max(1.0),
            false => 1.0,
        };
        Agreement {
            name: name.to_owned(),
            outlying: outlying(known),
            q,
            degrees_of_freedom,
            probability,
            widening,
            alone,
        }
    }
}

/// Records that are taken away one after the other, each time the one that the others disagree with most, until the rest agree. Of two records that
/// differ none is the one that is wrong, and of any number not half.
fn outlying(mut rest: Vec<(usize, (f64, f64))>) -> Vec<usize> {
    let count = rest.len();
    let mut out = Vec::new();
    while chance(disagreement(&rest), rest.len().saturating_sub(1)) < DISAGREE {
        let without = |at: usize| {
            let mut others = rest.clone();
            others.remove(at);
            disagreement(&others)
        };
        let places = 0..rest.len();
        let Some(at) = places.min_by(|&i, &j| without(i).total_cmp(&without(j))) else {
            break;
        };
        out.push(rest.remove(at).0);
    }
    if 2 * out.len() >= count {
        out.clear();
    }
    out.sort_unstable();
    out
}

/// Cochran's Q.
fn disagreement(each: &[(usize, (f64, f64))]) -> f64 {
    let all = || each.iter().map(|(_, one)| *one);
    let middle = mean(all());
    all().map(|(x, error)| ((x - middle) / error).powi(2)).sum()
}

/// How often records that agree have such a Q, or a larger one.
fn chance(q: f64, degrees_of_freedom: usize) -> f64 {
    match degrees_of_freedom {
        0 => 1.0,
        freedom => ChiSquared::new(freedom as f64).map_or(1.0, |chi| chi.sf(q)),
    }
}

/// The mean by weights of inverse variances.
fn mean(each: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (x, error) in each {
        let weight = error.powi(-2);
        sum += weight * x;
        weights += weight;
    }
    sum / weights
}

fn variable(one: &FittedParameter) -> (f64, f64) {
    let slope = one.scale.slope(one.value);
    (one.scale.inward(one.value), one.uncertainty / slope)
}

impl Fit {
    /// All errors as many times larger as records differ more in what they share than their noise explains: what one parameter cannot be the others
    /// make up for.
    pub fn widen(&mut self, by: f64) {
        for (i, one) in self.parameters.iter_mut().enumerate() {
            let best = one.scale.inward(one.value);
            let end =
                |end: f64, scale: Scale| scale.outward(best + by * (scale.inward(end) - best));
            one.uncertainty *= by;
            one.widening *= by;
            one.interval = (
                end(one.interval.0, one.scale),
                end(one.interval.1, one.scale),
            );
            if let Some(profile) = self.profiles.get_mut(i) {
                let points = profile.points.iter_mut();
                points.for_each(|point| point.deviation /= by);
                let (low, high) = profile.interval;
                profile.interval = (best + by * (low - best), best + by * (high - best));
            }
        }
    }
}
