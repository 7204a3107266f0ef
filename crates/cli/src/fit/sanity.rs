//! What a user may want to look at again: sizes that rocks do not have, and residuals with a trend.

use twinslip::fit::{Autoregression, DRIFT, Fit};
use twinslip_tasks::scene::{FitPlan, LawToFit, Recording};
use twinslip_tasks::views::in_digits;

/// Longest slip lengths of rocks and gouges in m, most of a and b, and between what friction coefficients are.
const LONGEST: f64 = 1e-2;
const MOST_EFFECT: f64 = 0.1;
const FRICTION: (f64, f64) = (0.05, 1.5);
/// V* and the velocities of a record are not farther apart than this factor.
const FAR: f64 = 1e3;
/// A trend is more than this many of its standard errors.
const CERTAIN: f64 = 4.0;

/// Questions on a fit, a sentence each.
pub fn questions(plan: &FitPlan, law: &LawToFit, fit: &Fit) -> Vec<String> {
    let fixed = law.fixed(plan.reference_rate);
    let value = |name: &str| {
        let fitted = fit.parameters.iter().find(|one| one.name == name);
        let fitted = fitted.filter(|one| !fit.verdict.has_run_away(one));
        let given = fixed.iter().find(|(own, _)| *own == name).map(|(_, x)| *x);
        fitted.map(|one| one.value).or(given)
    };
    let mut all = Vec::new();
    for name in ["slip_length", "slip_length_2"] {
        if let Some(length) = value(name).filter(|x| *x > LONGEST) {
            all.push(format!(
                "{name} is {} m, but rocks and gouges have micrometres to millimetres: is the unit of the displacement right?",
                in_digits(length, 3)
            ));
        }
    }
    for name in ["direct_effect", "evolution_effect", "evolution_effect_2"] {
        if let Some(effect) = value(name).filter(|x| x.abs() > MOST_EFFECT) {
            all.push(format!(
                "{name} is {}, but rocks have about 0.01, and hardly more than {MOST_EFFECT}: are the columns and their units right?",
                in_digits(effect, 3)
            ));
        }
    }
    let (least, most) = FRICTION;
    if let Some(friction) = value("reference_friction").filter(|x| !(least..=most).contains(x)) {
        all.push(format!(
            "reference_friction is {}, but rocks and gouges have {least} to {most}: are the stresses and their units right?",
            in_digits(friction, 3)
        ));
    }
    all.extend(far_reference(plan));
    all.extend(stick_slip(law, &value));
    let mut fitted = &fit.fitted[..];
    for own in &plan.recordings {
        let (here, rest) = fitted.split_at(own.record.times.len());
        all.extend(trend(law, (own, here), plan.recordings.len() > 1));
        fitted = rest;
    }
    all
}

/// V* where the record has no velocity near it.
fn far_reference(plan: &FitPlan) -> Option<String> {
    let velocities = plan.recordings.iter().flat_map(|own| &own.steps.stretches);
    let velocities = velocities.flat_map(|one| [one.velocity.0, one.velocity.1]);
    let velocities = velocities.filter(|v| *v > 0.0);
    let (low, high) = velocities.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| {
        (low.min(v), high.max(v))
    });
    let rate = plan.reference_rate;
    let is_far = rate > FAR * high || rate < low / FAR;
    is_far.then(|| {
        format!(
            "reference_rate is {rate:e} m/s, but the load point moves at {} to {} m/s: is that its unit?",
            in_digits(low, 3),
            in_digits(high, 3)
        )
    })
}

/// A spring below the critical stiffness (b - a)/L of the ageing and the slip law, on which steady sliding is unstable.
fn stick_slip(law: &LawToFit, value: &dyn Fn(&str) -> Option<f64>) -> Option<String> {
    let has_one_length = law.states == 1
        && ["dieterich-ruina", "ageing", "aging", "slip"].contains(&law.name.as_str());
    if !has_one_length {
        return None;
    }
    let critical = (value("evolution_effect")? - value("direct_effect")?) / value("slip_length")?;
    let ratio = value("stiffness")? / critical;
    (critical > 0.0 && ratio < 1.0).then(|| {
        format!(
            "k/k_c is {}: on this spring steady sliding is unstable, and grows to stick-slip; does the record begin at steady sliding?",
            in_digits(ratio, 3)
        )
    })
}

/// Residuals that follow a straight line in the displacement, by least squares with the error of their autoregression.
fn trend(
    law: &LawToFit,
    (recording, fitted): (&Recording, &[f64]),
    several: bool,
) -> Option<String> {
    let is_known = law.free().iter().any(|free| free.name == DRIFT);
    let record = &recording.record;
    let count = record.times.len() as f64;
    let mean = record.displacement.iter().sum::<f64>() / count;
    let along = record.displacement.iter().map(|x| x - mean);
    let along = nalgebra::DMatrix::from_iterator(record.times.len(), 1, along);
    let residuals = record.friction.iter().zip(fitted);
    let residuals: Vec<f64> = residuals.map(|(measured, made)| measured - made).collect();
    let spread = along.norm_squared();
    if is_known || spread <= 0.0 {
        return None;
    }
    let together: f64 = along.iter().zip(&residuals).map(|(x, r)| x * r).sum();
    let slope = together / spread;
    let beside = residuals.iter().zip(along.iter());
    let beside: Vec<f64> = beside.map(|(r, x)| r - slope * x).collect();
    let error = Autoregression::of(&beside).covariance_of(&along)[(0, 0)].sqrt() / spread;
    let is_certain = error.is_finite() && slope.abs() > CERTAIN * error;
    is_certain.then(|| {
        let of = match several {
            true => format!(" of {}", recording.name()),
            false => String::new(),
        };
        format!(
            "the residuals{of} follow a straight line of {} ± {} per metre of displacement: add drift to `free`",
            in_digits(slope, 2),
            in_digits(error, 2)
        )
    })
}
