//! Priors of what is fitted: those that are given, and wide ones.

use super::law::LawToFit;
use super::options::FitOptions;
use super::plan::FitPlan;
use twinslip::error::{Error, Result};
use twinslip::fit::{DRIFT, FreeParameter, Prior, Scale};

/// Priors as one gives them.
const SHAPES: &str = "NAME=normal:MEAN:DEVIATION, NAME=uniform:A:B or NAME=log-uniform:A:B";

/// One prior for each parameter that is fitted to all records.
///
/// # Errors
/// [`Error::Input`] for a prior that can't be read, of what is not fitted, or beyond what the parameter can be.
pub(super) fn priors(options: &FitOptions, plan: &FitPlan, law: &LawToFit) -> Result<Vec<Prior>> {
    let free = law.free_of(plan.recordings.len());
    let given = options.prior.iter().map(|text| given(text));
    let given: Vec<(String, Prior)> = given.collect::<Result<_>>()?;
    for (text, (name, prior)) in options.prior.iter().zip(&given) {
        let own = free.iter().find(|free| free.name == *name);
        let own =
            own.ok_or_else(|| Error::Input(format!("`prior` {text:?}: {name} is not fitted")))?;
        let (low, high) = prior.support();
        if high <= own.bounds.0 || low >= own.bounds.1 {
            return Err(Error::Input(format!(
                "`prior` {text:?}: {name} is looked for between {:e} and {:e}",
                own.bounds.0, own.bounds.1
            )));
        }
    }
    let of = |free: &FreeParameter| {
        let own = given.iter().rev().find(|(name, _)| *name == free.name);
        own.map_or_else(|| usual(plan, law, free), |(_, prior)| Ok(*prior))
    };
    free.iter().map(of).collect()
}

fn given(text: &str) -> Result<(String, Prior)> {
    let wrong = |what: &str| Error::Input(format!("`prior` {text:?} must be {SHAPES}{what}"));
    let (name, shape) = text.split_once('=').ok_or_else(|| wrong(""))?;
    let parts: Vec<&str> = shape.split(':').map(str::trim).collect();
    let [shape, one, other] = parts[..] else {
        return Err(wrong(""));
    };
    let number = |text: &str| {
        let read = text.parse::<f64>().ok().filter(|x| x.is_finite());
        read.ok_or_else(|| wrong(&format!("; {text:?} is no number")))
    };
    let (one, other) = (number(one)?, number(other)?);
    let prior = match shape {
        "normal" if other > 0.0 => Prior::Normal {
            mean: one,
            deviation: other,
        },
        "normal" => return Err(wrong("; the deviation must be positive")),
        "uniform" if one < other => Prior::Uniform {
            low: one,
            high: other,
        },
        "log-uniform" if 0.0 < one && one < other => Prior::LogUniform {
            low: one,
            high: other,
        },
        "uniform" => return Err(wrong(", A below B")),
        "log-uniform" => return Err(wrong(", 0 < A < B")),
        _ => return Err(wrong("")),
    };
    Ok((name.trim().replace('-', "_"), prior))
}

/// A prior as wide as what a record of this length could show.
fn usual(plan: &FitPlan, law: &LawToFit, free: &FreeParameter) -> Result<Prior> {
    let records = || plan.recordings.iter().map(|own| &own.record);
    let lasts = |times: &Vec<f64>| times[times.len() - 1] - times[0];
    let duration = records().map(|own| lasts(&own.times)).fold(0.0, f64::max);
    let moved = records().flat_map(|own| &own.displacement);
    let moved = moved.fold(0.0, |most: f64, x| most.max(x.abs()));
    let fewest = records().map(|own| own.times.len()).min().unwrap_or(1) as f64;
    let log = |low: f64, high: f64| Prior::LogUniform { low, high };
    let symmetric = |most: f64| Prior::Uniform {
        low: -most,
        high: most,
    };
    Ok(match free.name.as_str() {
        "evolution_effect" if free.scale == Scale::Linear => symmetric(1.0),
        "direct_effect" | "evolution_effect" => log(1e-6, 1.0),
        "slip_length" | "slip_length_2" => log(free.bounds.0, free.bounds.1),
        // Friction rises by 0.01 over the whole record, or by 10 within a sample.
        "stiffness" => log(0.01 / moved, 10.0 * fewest / moved),
        "reference_friction" => Prior::Uniform {
            low: 0.0,
            high: 3.0,
        },
        "evolution_effect_2" => symmetric(1.0),
        DRIFT => symmetric(1.0 / moved),
        "healing_time" => log(duration / fewest, 1e6 * duration),
        "residual_strength" => log(1e-6, 1.0),
        name => match (law.value(name), free.scale) {
            (Some(value), Scale::Logarithmic) => log(1e-3 * value, 1e3 * value),
            (Some(value), Scale::Linear) if value != 0.0 => symmetric(1e3 * value.abs()),
            _ => {
                return Err(Error::Input(format!(
                    "`prior` of {name} is missing: its size is not known; give {SHAPES}"
                )));
            }
        },
    })
}
