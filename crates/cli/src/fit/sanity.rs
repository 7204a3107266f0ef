//! What a user may want to look at again: sizes that rocks do not have, and residuals with a trend.

use nalgebra::{DMatrix, DVector};
use twinslip::error::Result;
use twinslip::fit::{Autoregression, DRIFT, Fit, Problem, Record, Scale};
use twinslip_tasks::scene::{FitPlan, LawToFit, WithProblem};
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
    let b = fit
        .parameters
        .iter()
        .find(|one| one.name == "evolution_effect");
    if b.is_some_and(|b| {
        b.scale == Scale::Logarithmic && fit.verdict.undetermined.contains(&b.label())
    }) {
        all.push(
            "evolution_effect is looked for above zero only: does friction, after its jump, go on in the direction of the step, as that of clays does? Then it is negative: give `bounds` evolution_effect=-0.1:0.1"
                .into(),
        );
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
    all.extend(trends(plan, law, fit));
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

/// Straight lines in the displacement of a record that would be found beside all that is fitted.
fn trends(plan: &FitPlan, law: &LawToFit, fit: &Fit) -> Vec<String> {
    if law.free().iter().any(|free| free.name == DRIFT) {
        return Vec::new();
    }
    let found = law.with_problem(plan, &plan.pieces(), &mut Trends(fit));
    let each = plan.recordings.iter().zip(found.unwrap_or_default());
    let certain = each.filter(|(_, (slope, error))| slope.abs() > CERTAIN * error);
    let told = certain.map(|(own, (slope, error))| {
        let of = match plan.recordings.len() {
            1 => String::new(),
            _ => format!(" of {}", own.name()),
        };
        format!(
            "the residuals{of} follow a straight line of {} ± {} per metre of displacement: add drift to `free`",
            in_digits(slope, 2),
            in_digits(error, 2)
        )
    });
    told.collect()
}

/// The slope of such a line in each record and its standard error, by one linear step from the fit, with the noise as the residuals are then. A
/// slope that is not known has an infinite error.
struct Trends<'a>(&'a Fit);

impl WithProblem for Trends<'_> {
    type Output = Vec<(f64, f64)>;
    fn call<const N: usize>(&mut self, problem: &Problem<'_, N>) -> Result<Self::Output> {
        let (fitted, mut slopes) = problem.response(&self.0.variables)?;
        for mut column in slopes.column_iter_mut() {
            let norm = column.norm();
            column /= if norm > 0.0 { norm } else { 1.0 };
        }
        let Some(inverse) = slopes.tr_mul(&slopes).cholesky() else {
            return Ok(Vec::new());
        };
        // What the parameters of the fit cannot follow.
        let beside = |all: DVector<f64>| {
            let followed = inverse.solve(&slopes.tr_mul(&all));
            all - &slopes * followed
        };
        let records = problem.records.iter().map(|one| one.record);
        let measured = records.clone().flat_map(|record| &record.friction);
        let residuals = measured.zip(&fitted).map(|(own, made)| own - made);
        let residuals = beside(DVector::from_iterator(fitted.len(), residuals));
        let mut begin = 0;
        let of = |record: &Record| {
            let rows = begin..begin + record.times.len();
            begin = rows.end;
            let mut along = DVector::zeros(fitted.len());
            let mut own = along.rows_mut(rows.start, rows.len());
            own.copy_from_slice(&record.displacement);
            let along = beside(along);
            let spread = along.norm_squared();
            let slope = along.dot(&residuals) / spread;
            let left = &residuals - &along * slope;
            let noise = Autoregression::of(&left.as_slice()[rows.clone()]);
            let own = DMatrix::from_column_slice(rows.len(), 1, &along.as_slice()[rows]);
            let error = noise.covariance_of(&own)[(0, 0)].sqrt() / spread;
            match slope.is_finite() && error.is_finite() {
                true => (slope, error),
                false => (0.0, f64::INFINITY),
            }
        };
        Ok(records.map(of).collect())
    }
}
