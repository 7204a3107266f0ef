//! The friction that a slider shows while its load point moves, with its derivatives in the parameters.

use super::slider::{Motion, Sliders};
use crate::error::{Error, Result};
use crate::field::{Matrix, State, VectorField, vector};
use crate::number::DoubleDouble;
use crate::series::{Accuracy, Expansion, Tangent};
use nalgebra::{Const, DMatrix, Dyn, OMatrix, SMatrix};

/// What a step may err by, relative and absolute, in the friction coefficient and in ln psi.
pub(super) const TOLERANCE: f64 = 2e-9;
/// A slider that takes more steps, and as many more for each stretch, is unstable, as nothing is that was measured at steady sliding.
const MAX_STEPS: usize = 20_000;
const STEPS_EACH: usize = 20;
/// Series that are evaluated together.
const WIDTH: usize = 4;

/// The derivatives of a state in the parameters: a column for each.
pub(super) type Slopes<const N: usize> = OMatrix<f64, Const<N>, Dyn>;

/// The friction coefficient at some times, and its derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// mu, one for each time.
    pub friction: Vec<f64>,
    /// Its derivatives in the free parameters: a row for each time, a column for each parameter.
    pub derivatives: DMatrix<f64>,
    /// How many steps it took.
    pub steps: usize,
}

impl Response {
    /// That of a slider at these parameters, with derivatives in those of these places among [`Sliders::names`], at times that ascend
    /// and that the motion covers.
    ///
    /// # Errors
    /// Those of [`Sliders`]; [`Error::TooManySteps`] for an unstable slider, and [`Error::NonFinite`] where its friction is not finite.
    pub fn of<const N: usize>(
        sliders: &dyn Sliders<N>,
        motion: &Motion,
        times: &[f64],
        given: (&[f64], &[usize]),
    ) -> Result<Self> {
        Self::to(TOLERANCE, (sliders, motion), times, given)
    }

    /// The same, where steps may err by so much.
    pub(super) fn to<const N: usize>(
        tolerance: f64,
        (sliders, motion): (&dyn Sliders<N>, &Motion),
        times: &[f64],
        (parameters, free): (&[f64], &[usize]),
    ) -> Result<Self> {
        let reference = sliders.reference_rate();
        let field = sliders.field(parameters, 0.0)?;
        let mut y = sliders.steady(parameters, motion.before / reference)?;
        let mut slopes = steady_slopes(&*field, &y, free)?;
        let mut tangent = tangent_of(&*field, free)?;
        let mut along = Observations::new(times, free.len(), tolerance);
        along.limit = MAX_STEPS + STEPS_EACH * motion.stretches.len();
        for (i, stretch) in motion.stretches.iter().enumerate() {
            let ((begin, end), (from, to)) = (stretch.span, stretch.velocity);
            let is_last = i + 1 == motion.stretches.len();
            let until = if is_last { f64::INFINITY } else { end };
            // The load point moves as it does, whatever the parameters are.
            y[N - 1] = from / reference;
            slopes.row_mut(N - 1).fill(0.0);
            let flow = if from == to {
                along.follow(&mut *tangent, (begin, end, until), (&y, &slopes))?
            } else {
                let ramp = sliders.field(parameters, (to - from) / (end - begin) / reference)?;
                let mut tangent = tangent_of(&*ramp, free)?;
                along.follow(&mut *tangent, (begin, end, until), (&y, &slopes))?
            };
            (y, slopes) = flow;
        }
        Ok(along.response())
    }
}

/// The friction coefficient of steady sliding at v V*, and its derivatives in the parameters of these places.
///
/// # Errors
/// Those of [`Sliders`].
pub fn steady_friction<const N: usize>(
    sliders: &dyn Sliders<N>,
    (parameters, free): (&[f64], &[usize]),
    v: f64,
) -> Result<(f64, Vec<f64>)> {
    let field = sliders.field(parameters, 0.0)?;
    let y = sliders.steady(parameters, v)?;
    let slopes = steady_slopes(&*field, &y, free)?;
    Ok((y[0], slopes.row(0).iter().copied().collect()))
}

/// dy/dp of a steady state, V being given: zero = J dy + df.
pub(super) fn steady_slopes<const N: usize>(
    field: &dyn VectorField<N>,
    y: &State<N>,
    free: &[usize],
) -> Result<Slopes<N>> {
    let parametrised = field.parametrised().ok_or(Error::NotAnalytic)?;
    let mut jacobian = Matrix::from_column_slice(N, N, field.jacobian(y).as_slice());
    // The last variable is V, which stays.
    jacobian.row_mut(N - 1).fill(0.0);
    jacobian[(N - 1, N - 1)] = 1.0;
    let inverse = jacobian.lu();
    let mut slopes = Slopes::<N>::zeros(free.len());
    for (j, &place) in free.iter().enumerate() {
        let mut forcing = vector(&-parametrised.parameter_derivative(y, place));
        forcing[N - 1] = 0.0;
        let moved = inverse.solve(&forcing).ok_or(Error::NonFinite {
            what: "the steady sliding of the slider",
            t: 0.0,
        })?;
        slopes.column_mut(j).copy_from_slice(moved.as_slice());
    }
    Ok(slopes)
}

fn tangent_of<'a, const N: usize>(
    field: &'a dyn VectorField<N>,
    free: &[usize],
) -> Result<Box<dyn Tangent<N> + 'a>> {
    let analytic = field.analytic().ok_or(Error::NotAnalytic)?;
    Ok(analytic.tangent(free))
}

/// What is seen on the way.
struct Observations<'a> {
    times: &'a [f64],
    parameters: usize,
    /// So many elements hold mu and its derivatives.
    groups: usize,
    seen: usize,
    /// `groups` for each time.
    values: Vec<[f64; WIDTH]>,
    /// The series along a step: `groups` for each power.
    series: Vec<[f64; WIDTH]>,
    steps: usize,
    limit: usize,
    /// What a step may err by.
    tolerance: f64,
}

impl<'a> Observations<'a> {
    fn new(times: &'a [f64], parameters: usize, tolerance: f64) -> Self {
        let groups = (parameters + 1).div_ceil(WIDTH);
        Observations {
            times,
            parameters,
            groups,
            seen: 0,
            values: vec![[0.0; WIDTH]; groups * times.len()],
            series: Vec::new(),
            steps: 0,
            limit: MAX_STEPS,
            tolerance,
        }
    }

    /// Goes through a stretch from `begin` to `end`, and sees the times before `until`.
    fn follow<const N: usize>(
        &mut self,
        tangent: &mut dyn Tangent<N>,
        (begin, end, until): (f64, f64, f64),
        (y, slopes): (&State<N>, &Slopes<N>),
    ) -> Result<(State<N>, Slopes<N>)> {
        let accuracy = Accuracy {
            order: tangent.order(self.tolerance),
            tolerances: (self.tolerance, self.tolerance),
        };
        tangent.start(&y.data.0[0]);
        let (mut expansion, mut derivatives) = (Expansion::new(), Vec::new());
        let lasts = DoubleDouble::from(end - begin);
        let mut gone = DoubleDouble::ZERO;
        while (lasts - gone).hi() > 0.0 {
            let h = tangent.advance(&accuracy, lasts - gone);
            let t = begin + gone.hi();
            if !h.is_finite() {
                let what = "the friction of the slider";
                return Err(Error::NonFinite { what, t });
            }
            self.steps += 1;
            if self.steps > self.limit {
                return Err(Error::TooManySteps {
                    t,
                    end,
                    limit: self.limit,
                });
            }
            let reached = begin + (gone + h).hi();
            let rest = self.times[self.seen..].iter();
            let here = rest.take_while(|&&t| t < until && (t <= reached || reached >= end));
            let here = self.seen..self.seen + here.count();
            if !here.is_empty() {
                tangent.expansion(accuracy.order, &mut expansion);
                tangent.derivative_series(0, accuracy.order, &mut derivatives);
                self.expand(&expansion, &derivatives, slopes);
                for at in here {
                    let since = (DoubleDouble::from(self.times[at] - begin) - gone).hi();
                    self.see(at, since / expansion.unit);
                }
            }
            gone = gone + h;
        }
        let derivatives = tangent.derivatives();
        let flow = SMatrix::<f64, N, N>::from_fn(|i, j| derivatives.start[j][i]);
        let mut after = flow * slopes;
        for (mut column, own) in after.column_iter_mut().zip(&derivatives.parameters) {
            column += State::from(*own);
        }
        Ok((State::from(tangent.state()), after))
    }

    /// The series of mu and, in the parameters, of its derivatives: those of the stretch alone, and those that it began with.
    fn expand<const N: usize>(
        &mut self,
        expansion: &Expansion<N>,
        derivatives: &[f64],
        slopes: &Slopes<N>,
    ) {
        let width = N + self.parameters;
        self.series.clear();
        for (k, level) in derivatives.chunks_exact(width).enumerate() {
            let (start, parameters) = level.split_at(N);
            let begin = self.series.len();
            self.series.resize(begin + self.groups, [0.0; WIDTH]);
            let all = self.series[begin..].as_flattened_mut();
            all[0] = expansion.variables[0][k];
            for (j, own) in parameters.iter().enumerate() {
                let begun = start.iter().enumerate();
                all[j + 1] = own + begun.map(|(i, by)| by * slopes[(i, j)]).sum::<f64>();
            }
        }
    }

    /// The values at a time in units after the beginning of the step.
    fn see(&mut self, at: usize, since: f64) {
        let values = &mut self.values[at * self.groups..][..self.groups];
        for level in self.series.chunks_exact(self.groups).rev() {
            for (value, coefficient) in values.iter_mut().zip(level) {
                for lane in 0..WIDTH {
                    value[lane] = value[lane] * since + coefficient[lane];
                }
            }
        }
        self.seen = at + 1;
    }

    fn response(self) -> Response {
        let width = self.groups * WIDTH;
        let all = self.values.as_flattened();
        let at = |i: usize, j: usize| all[i * width + j];
        Response {
            friction: (0..self.times.len()).map(|i| at(i, 0)).collect(),
            derivatives: DMatrix::from_fn(self.times.len(), self.parameters, |i, j| at(i, j + 1)),
            steps: self.steps,
        }
    }
}
