//! Radau IIA methods of order 9 and 13: for stiff systems at tight tolerances, and for their periodic orbits.
//!
//! Where a Rosenbrock method of order 5 takes thousands of steps for eleven digits these take a few hundred, and the derivatives in the
//! start and in parameters are those of the steps themselves (Hairer & Wanner 1999, J. Comput. Appl. Math. 111, 93-111). The code is compiled
//! once: the dimension is known when the program runs.

mod coefficients;
mod stages;

use super::rosenbrock::control::{self, first_step};
use super::rosenbrock::drive::drive;
use super::{Control, Integrator, Observer, Step, Tolerances, Work, step_underflow};
use crate::error::{Error, Result};
use crate::field::{
    Jacobian, Matrix, State, Vector, VectorField, jacobian_of_rows, state, with_differences,
};
use coefficients::suited;
use stages::{Derivatives, LastStep, MayErr, StageField, Stages};

/// An integrator that steps by a Radau IIA method: of 5 or 7 stages, as the tolerance has it.
///
/// A step is accepted if no component errs by more than `atol + rtol |y_i|`, in a tangent flow no entry of the tangent either.
///
/// ```
/// use twinslip::field::State;
/// use twinslip::friction::Parameters;
/// use twinslip::integrate::{Integrator, MAX_STEPS, Radau, Tolerances};
/// use twinslip::model::{Loading, TwoInterfaces};
/// # fn main() -> twinslip::Result<()> {
/// let law = Parameters::heslot_1994().spinodal();
/// let field = TwoInterfaces { law, loading: Loading::new(1000.0, 0.14)? };
/// let start = State::<3>::new(10.0, 0.5_f64.ln(), 0.001_f64.ln());
/// let mut radau = Radau::new(Tolerances::equal(1e-10)?, MAX_STEPS)?;
/// let end = radau.flow(&field, (0.0, 200.0), &start, None)?;
/// assert!((end[0] - 8.7802282536803).abs() < 1e-9);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Radau {
    tolerances: Tolerances,
    max_steps: usize,
    work: Work,
    /// The last step of the last call.
    last: Option<LastStep>,
}

/// The end of an arc with its derivatives: in the start and in parameters, a column for each, and the integral of the trace of the Jacobian.
pub(super) type WithDerivatives = (Vector, Matrix, f64);

/// A field of a dimension that the compiler knows.
struct Of<'a, const N: usize>(&'a dyn VectorField<N>);

impl<const N: usize> StageField for Of<'_, N> {
    fn f(&self, y: &[f64], into: &mut [f64]) {
        into.copy_from_slice(&self.0.f(&state(y)).as_slice()[..y.len()]);
    }

    fn jacobian(&self, y: &[f64], exact: bool, into: &mut Matrix) {
        let (n, y) = (y.len(), state(y));
        let made = self.0.jacobian(&y);
        let known = exact || made.iter().all(|x| x.is_finite());
        let made = if known {
            made
        } else {
            with_differences(self.0, &y, made)
        };
        into.copy_from(&made.view((0, 0), (n, n)));
    }

    fn parameter_derivative(&self, y: &[f64], place: usize, into: &mut [f64]) {
        let field = self.0.parametrised().expect("a field with parameters");
        let made = field.parameter_derivative(&state(y), place);
        into.copy_from_slice(&made.as_slice()[..y.len()]);
    }

    fn underflow(&self, t: f64, h: f64, y: &[f64]) -> Error {
        step_underflow(self.0, t, h, &state(y))
    }

    fn has_spikes(&self) -> bool {
        self.0.has_spikes()
    }

    fn timed(&self, end: &mut [f64], begin: &[f64], h: f64) {
        let made = self.0.timed(state(end), &state(begin), h);
        end.copy_from_slice(&made.as_slice()[..end.len()]);
    }
}

impl Radau {
    /// With a bound on the steps of one call, refused ones included.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `max_steps` is 0 or the tolerances are not those of [`Tolerances::new`].
    pub fn new(tolerances: Tolerances, max_steps: usize) -> Result<Self> {
        if max_steps == 0 {
            return Err(Error::parameter("max-steps", max_steps, "at least 1"));
        }
        Ok(Radau {
            tolerances: tolerances.checked()?,
            max_steps,
            work: Work::default(),
            last: None,
        })
    }

    /// The name by which the command line knows the method.
    pub(super) const NAME: &'static str = "radau";

    /// From `t.0` to `t.1`, with the derivatives in the start and in these parameters if any are asked for.
    fn run<const N: usize>(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        free: Option<(&[usize], f64)>,
        mut observer: Option<Observer<'_, N>>,
    ) -> Result<WithDerivatives> {
        self.work = Work::default();
        super::rosenbrock::check_times(t)?;
        if y0.iter().any(|x| !x.is_finite()) {
            return Err(Error::NonFinite {
                what: "the initial state",
                t: t.0,
            });
        }
        let of = Of(field);
        let f = field.f(y0);
        let n = field.dimension();
        let variables = |y: &State<N>| Vector::from_column_slice(&y.as_slice()[..n]);
        let mut jacobian = Matrix::zeros(n, n);
        of.jacobian(&y0.as_slice()[..n], free.is_some(), &mut jacobian);
        self.work.rhs += 1;
        self.work.jacobians += 1;
        if !f.iter().chain(jacobian.iter()).all(|x| x.is_finite()) {
            return Err(Error::NonFinite {
                what: "the right-hand side or its Jacobian",
                t: t.0,
            });
        }
        let method = suited(self.tolerances.rtol);
        let span = t.1 - t.0;
        let may_err = control::MayErr::new(self.tolerances, field);
        let order = method.stages() as u32;
        // What it takes for rows are its columns.
        let known = jacobian_of_rows::<N>(n, jacobian.as_slice()).transpose();
        let start = variables(y0);
        // The arcs of an orbit come one after the other: a run goes on where the one before has ended.
        let last = self.last.take();
        let last = last.filter(|last| last.is_before(&start, span));

        let length = match &last {
            Some(last) => last.following,
            None => first_step(may_err, order, span.abs(), y0, &f, &known).copysign(span),
        };
        let may_err = MayErr {
            rtol: self.tolerances.rtol,
            atol: variables(&field.absolute_tolerances(self.tolerances.atol)),
            of_tangents: free.map_or(0.0, |(_, tolerance)| tolerance),
        };
        let mut stages = Stages::new(
            (&of, method),
            (may_err, self.tolerances.max_step, observer.is_some()),
            &mut self.work,
            start,
            (variables(&f), jacobian),
            (free.map(|(places, _)| places), last),
        );
        drive(&mut stages, t, length, self.max_steps, |stages, time| {
            let Some(observer) = observer.as_mut() else {
                return Ok(Control::Continue);
            };
            observer(&Step {
                t0: time.begin.hi(),
                y0: &state(stages.y.as_slice()),
                t1: time.end.hi(),
                y1: &state(stages.end().as_slice()),
                begin: time.begin,
                length: time.length,
                continuous: &|time| state(stages.after(time).as_slice()),
                reach: f64::INFINITY,
                expansion: None,
                slips: None,
            })
        })?;
        self.last = stages.last.take();
        let none = Derivatives {
            places: &[],
            columns: Matrix::zeros(n, 0),
            volume: 0.0,
        };
        let derivatives = stages.derivatives.take().unwrap_or(none);
        Ok((stages.y, derivatives.columns, derivatives.volume))
    }

    /// The state at `t.1` with its derivatives in `y0` and in the parameters of these places. They are exactly those of the steps, whose
    /// own errors are tested as of a flow alone; theirs may be as large as the root of the tolerance in a step. What decays at once in an arc
    /// would else take most of its steps, and is nothing at the end.
    ///
    /// # Errors
    /// Those of [`Integrator::flow`].
    pub(super) fn derivatives<const N: usize>(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        free: &[usize],
    ) -> Result<WithDerivatives> {
        let tolerance = self.tolerances.rtol.sqrt();
        self.run(field, t, y0, Some((free, tolerance)), None)
    }
}

impl<const N: usize> Integrator<N> for Radau {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn flow(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        observer: Option<Observer<'_, N>>,
    ) -> Result<State<N>> {
        let (end, ..) = self.run(field, t, y0, None, observer)?;
        Ok(state(end.as_slice()))
    }

    fn tangent_flow(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
    ) -> Result<(State<N>, Jacobian<N>)> {
        let Tolerances { rtol, atol, .. } = self.tolerances;
        let (end, columns, _) = self.run(field, t, y0, Some((&[], rtol.min(atol))), None)?;
        Ok((
            state(end.as_slice()),
            jacobian_of_rows::<N>(field.dimension(), columns.as_slice()).transpose(),
        ))
    }

    fn work(&self) -> Work {
        self.work
    }
}
