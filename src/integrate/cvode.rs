//! CVODES as an [`Integrator`]: BDF and Adams formulas of variable order and step.
//!
//! The reference that everything else is compared with, and not the fastest here: its global error over twenty stick-slip
//! cycles is some 1e4 times the tolerance, and the one-step methods reach the same error in less time.

use super::{Control, Integrator, Observer, Step, Tolerances, Work, step_underflow};
use crate::error::{Error, Result};
use crate::field::{Jacobian, State, VectorField, checked_places};
use crate::number::DoubleDouble;
use crate::sundials::{
    Cvode, ErrorControl, Mode, MultistepMethod, Operations, Problem, Reason, Sensitivity,
    SensitivityMethod, part_of_mean,
};
use std::cell::RefCell;

/// Failures of one step before it is given up. CVODE's own 7 and 10 end a run before the step is small enough to tell a
/// singularity from a tolerance that can't be met.
const MAX_FAILURES: u16 = 1000;

/// The times by which CVODE integrates. It takes times within a hundred spacings for the same, and so refuses a short interval
/// or ends before its end; the fields are autonomous, and from zero on the same interval is long.
fn clock(t: (f64, f64)) -> (f64, f64) {
    const SHORT: f64 = 1024.0 * f64::EPSILON;
    let length = t.1 - t.0;
    if length.abs() < SHORT * t.0.abs().max(t.1.abs()) {
        (0.0, length)
    } else {
        t
    }
}

/// CVODES with our fixed-length operations.
///
/// ```
/// use twinslip::friction::{AnyLaw, Parameters};
/// use twinslip::integrate::{CvodeIntegrator, Integrator, MAX_STEPS, Tolerances};
/// use twinslip::model::{Loading, two_interfaces};
/// use twinslip::sundials::MultistepMethod;
/// use twinslip::field::State;
/// # fn main() -> twinslip::Result<()> {
/// let law = AnyLaw::named("spinodal", Parameters::heslot_1994())?;
/// let field = two_interfaces(law, Loading::new(1000.0, 0.14)?);
/// let mut cvode = CvodeIntegrator::new(MultistepMethod::Bdf, Tolerances::equal(1e-8)?, MAX_STEPS)?;
/// let y0 = State::<3>::new(10.0, 0.5_f64.ln(), 0.001_f64.ln());
/// let y = cvode.flow(&*field, (0.0, 200.0), &y0, None)?;
/// assert!((y[0] - 8.78022825).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
pub struct CvodeIntegrator<const N: usize> {
    solver: Cvode<N>,
    method: MultistepMethod,
    tolerances: Tolerances,
    max_steps: usize,
    work: Work,
}

impl<const N: usize> CvodeIntegrator<N> {
    /// At most `max_steps` steps in a flow.
    ///
    /// # Errors
    /// [`Error::Sundials`] if SUNDIALS can't allocate.
    pub fn new(method: MultistepMethod, tolerances: Tolerances, max_steps: usize) -> Result<Self> {
        let mut solver = Cvode::new(method, Operations::Fixed)?;
        solver.set_tolerances(tolerances)?;
        solver.set_max_steps(max_steps);
        solver.set_max_failures(MAX_FAILURES)?;
        Ok(CvodeIntegrator {
            solver,
            method,
            tolerances,
            max_steps,
            work: Work::default(),
        })
    }

    /// The flow after the solver has been started.
    fn run(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        observer: Option<Observer<'_, N>>,
    ) -> Result<()> {
        self.solver.set_stop_time(Some(t.1));
        let ended = match observer {
            None => self
                .solver
                .advance(&Problem::new(field), t.1, Mode::Normal)
                .map(|_| ()),
            Some(observer) => self.observed(field, t, y0, observer),
        };
        ended.map_err(|error| self.explain(field, t, error))
    }

    fn observed(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        observer: Observer<'_, N>,
    ) -> Result<()> {
        let problem = Problem::new(field);
        let (mut t0, mut y0) = (t.0, *y0);
        loop {
            let arrival = self.solver.advance(&problem, t.1, Mode::OneStep)?;
            let (t1, y1) = (arrival.t, self.solver.state());
            // Near a singularity CVODE takes steps that do not move time: they are part of the next one that does.
            if t1 == t0 && arrival.reason != Reason::StopTime {
                continue;
            }
            let solver = &self.solver;
            // An observer's dense output can't fail; what CVODES objects to is raised after it.
            let objection = RefCell::new(None);
            let continuous = |time: f64| {
                let within = (t0 + time).clamp(t0.min(t1), t0.max(t1));
                solver.dense(within).unwrap_or_else(|error| {
                    objection.replace(Some(error));
                    State::repeat(f64::NAN)
                })
            };
            let control = observer(&Step {
                t0,
                y0: &y0,
                t1,
                y1: &y1,
                begin: DoubleDouble::from(t0),
                length: t1 - t0,
                continuous: &continuous,
                reach: f64::INFINITY,
                expansion: None,
                slips: None,
            })?;
            if let Some(error) = objection.take() {
                return Err(error);
            }
            if control == Control::Stop || arrival.reason == Reason::StopTime {
                return Ok(());
            }
            (t0, y0) = (t1, y1);
        }
    }

    /// The crate's word for a failure of CVODES.
    fn explain(&self, field: &dyn VectorField<N>, t: (f64, f64), error: Error) -> Error {
        match error {
            Error::StepTooSmall { t, h } => step_underflow(field, t, h, &self.solver.state()),
            Error::Sundials { ref name, time, .. } => {
                let reached = time.unwrap_or(t.0);
                match name.as_str() {
                    "CV_TOO_MUCH_WORK" => Error::TooManySteps {
                        t: reached,
                        end: t.1,
                        limit: self.max_steps,
                    },
                    "CV_ERR_FAILURE" | "CV_CONV_FAILURE" | "CV_REPTD_RHSFUNC_ERR" => {
                        self.collapsed(field, reached).unwrap_or(error)
                    }
                    _ => error,
                }
            }
            Error::NonFinite { t: reached, .. } => self.collapsed(field, reached).unwrap_or(error),
            other => other,
        }
    }

    /// The error of a step that has collapsed, if it has.
    fn collapsed(&self, field: &dyn VectorField<N>, t: f64) -> Option<Error> {
        let h = self.solver.trial_step_size().ok()?;
        (h != 0.0 && t + h == t).then(|| step_underflow(field, t, h, &self.solver.state()))
    }

    fn record(&mut self) {
        self.work = self.solver.work().unwrap_or_default();
    }
}

impl<const N: usize> Integrator<N> for CvodeIntegrator<N> {
    fn name(&self) -> &'static str {
        match self.method {
            MultistepMethod::Bdf => "cvode-bdf",
            MultistepMethod::Adams => "cvode-adams",
        }
    }

    fn flow(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        observer: Option<Observer<'_, N>>,
    ) -> Result<State<N>> {
        self.work = Work::default();
        let clock = clock(t);
        self.solver.start(clock.0, y0)?;
        if t.0 == t.1 {
            return Ok(*y0);
        }
        if clock == t {
            let ended = self.run(field, t, y0, observer);
            self.record();
            return ended.map(|()| self.solver.state());
        }
        let ended = self.run(field, clock, y0, None);
        self.record();
        ended?;
        let y1 = self.solver.state();
        if let Some(observer) = observer {
            // Over so short an interval a chord is as good as the solution.
            let length = t.1 - t.0;
            let continuous = |time: f64| y0.lerp(&y1, (time / length).clamp(0.0, 1.0));
            observer(&Step {
                t0: t.0,
                y0,
                t1: t.1,
                y1: &y1,
                begin: DoubleDouble::from(t.0),
                length,
                continuous: &continuous,
                reach: f64::INFINITY,
                expansion: None,
                slips: None,
            })?;
        }
        Ok(y1)
    }

    fn tangent_flow(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
    ) -> Result<(State<N>, Jacobian<N>)> {
        let (end, tangent, _) = self.derivatives(field, t, y0, &[])?;
        Ok((end, tangent))
    }

    fn work(&self) -> Work {
        self.work
    }
}

impl<const N: usize> CvodeIntegrator<N> {
    /// The state at `t.1` with its derivatives in `y0` and in the parameters of these places among those of
    /// [`VectorField::parametrised`]: forward sensitivities.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a place where there is no parameter; those of [`Integrator::flow`].
    pub fn derivatives(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        free: &[usize],
    ) -> Result<(State<N>, Jacobian<N>, Vec<State<N>>)> {
        checked_places(field, free)?;
        self.work = Work::default();
        let n = field.dimension();
        let unit = |j: usize| State::from_fn(|i, _| f64::from(u8::from(i == j)));
        let mut columns: Vec<State<N>> = (0..n).map(unit).collect();
        columns.resize(n + free.len(), State::zeros());
        let part = part_of_mean(field);
        let settings = Sensitivity {
            scheme: SensitivityMethod::Simultaneous,
            tolerances: (part != 1.0).then_some(Tolerances {
                rtol: part * self.tolerances.rtol,
                atol: part * self.tolerances.atol,
                ..self.tolerances
            }),
            error_control: ErrorControl::Full,
        };
        let clock = clock(t);
        self.solver
            .start_with_sensitivities(clock.0, y0, &columns, &settings)?;
        if t.0 == t.1 {
            return Ok((*y0, Jacobian::identity(), columns.split_off(n)));
        }
        let forcing =
            |column: usize, y: &State<N>| match (column.checked_sub(n), field.parametrised()) {
                (Some(i), Some(field)) => field.parameter_derivative(y, free[i]),
                _ => State::zeros(),
            };
        let problem = Problem {
            forcing: (!free.is_empty()).then_some(&forcing),
            ..Problem::new(field)
        };
        self.solver.set_stop_time(Some(clock.1));
        let ended = self.solver.advance(&problem, clock.1, Mode::Normal);
        let ended = ended.map_err(|error| self.explain(field, clock, error));
        self.record();
        ended?;
        let mut columns = self.solver.sensitivities()?;
        let in_parameters = columns.split_off(n);
        columns.resize_with(N, State::zeros);
        Ok((
            self.solver.state(),
            Jacobian::from_columns(&columns),
            in_parameters,
        ))
    }
}
