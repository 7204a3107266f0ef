//! A second opinion on derivatives: by forward sensitivities of CVODES, which know no power series.

use super::problem::Problem;
use crate::error::Result;

/// By how much the derivatives of the friction at these variables differ from those of power series, relative to the largest of each
/// parameter: at some fifty of the times.
///
/// # Errors
/// Those of both methods; [`crate::Error::Input`] in a build without SUNDIALS.
#[cfg(not(feature = "sundials"))]
pub fn by_sensitivities<const N: usize>(_: &Problem<'_, N>, _: &[f64]) -> Result<f64> {
    Err(crate::Error::Input(
        "`crosscheck` needs CVODES, and this program was built without SUNDIALS".into(),
    ))
}

/// By how much the derivatives of the friction at these variables differ from those of power series, relative to the largest of each
/// parameter: at some fifty of the times.
///
/// # Errors
/// Those of both methods; [`crate::Error::Input`] in a build without SUNDIALS.
#[cfg(feature = "sundials")]
pub fn by_sensitivities<const N: usize>(
    problem: &Problem<'_, N>,
    variables: &[f64],
) -> Result<f64> {
    let mut each = (0..problem.records.len()).map(|record| of_record(problem, record, variables));
    each.try_fold(0.0, |most: f64, one| Ok(most.max(one?)))
}

#[cfg(feature = "sundials")]
fn of_record<const N: usize>(
    problem: &Problem<'_, N>,
    at: usize,
    variables: &[f64],
) -> Result<f64> {
    use super::response::{Response, Slopes, steady_slopes};
    use crate::integrate::{CvodeIntegrator, MAX_STEPS, Tolerances};
    use crate::sundials::MultistepMethod;

    /// How many times, about.
    const TIMES: usize = 50;
    const TOLERANCE: f64 = 1e-11;

    let (places, _) = problem.places(at);
    let (parameters, _) = problem.parameters_at(at, variables);
    let record = problem.records[at].record.thinned(TIMES);
    let (sliders, motion) = (problem.sliders, problem.records[at].motion);
    let series = Response::of(sliders, motion, &record.times, (&parameters, &places))?;
    let tolerances = Tolerances::equal(TOLERANCE)?;
    let mut cvode = CvodeIntegrator::<N>::new(MultistepMethod::Bdf, tolerances, MAX_STEPS)?;
    let reference = sliders.reference_rate();
    let steady = sliders.field(&parameters, 0.0)?;
    let mut y = sliders.steady(&parameters, motion.before / reference)?;
    let mut slopes: Slopes<N> = steady_slopes(&*steady, &y, &places)?;
    let mut worst = vec![0.0_f64; places.len()];
    let mut seen = 0;
    for (i, stretch) in motion.stretches.iter().enumerate() {
        let ((begin, end), (from, to)) = (stretch.span, stretch.velocity);
        let field = sliders.field(&parameters, (to - from) / (end - begin) / reference)?;
        y[N - 1] = from / reference;
        slopes.row_mut(N - 1).fill(0.0);
        let is_last = i + 1 == motion.stretches.len();
        let rest = record.times[seen..].iter().copied();
        let inside = rest.take_while(|&t| t < end || is_last && t <= end);
        let stops: Vec<f64> = inside.collect();
        let mut now = begin;
        for (stop, is_seen) in stops.iter().map(|&t| (t, true)).chain([(end, false)]) {
            if stop > now {
                let run = (0.0, stop - now);
                let (reached, flow, columns) = cvode.derivatives(&*field, run, &y, &places)?;
                y = reached;
                slopes = flow * slopes;
                for (mut column, own) in slopes.column_iter_mut().zip(&columns) {
                    column += own;
                }
                now = stop;
            }
            if is_seen {
                for (j, worst) in worst.iter_mut().enumerate() {
                    let difference = slopes[(0, j)] - series.derivatives[(seen, j)];
                    *worst = worst.max(difference.abs());
                }
                seen += 1;
            }
        }
    }
    let relative = worst.iter().zip(series.derivatives.column_iter());
    let relative =
        relative.map(|(worst, column)| worst / f64::max(column.amax(), f64::MIN_POSITIVE));
    Ok(relative.fold(0.0, f64::max))
}
