//! Arcs of multiple shooting: pieces of trajectories with their derivatives, by any of the methods.

use crate::error::{Error, Result};
use crate::field::{Jacobian, State, VectorField};
use crate::integrate::{Choice, Integrator, MAX_STEPS, Taylor, Tolerances, Work};

/// A piece of a trajectory, from a start that the caller knows.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Arc<const N: usize> {
    /// The state at its end.
    pub end: State<N>,
    /// The derivative of the end in the start.
    pub tangent: Jacobian<N>,
    /// The derivatives of the end in the two parameters that were asked for; zero from methods that make none, and where none
    /// were.
    pub parameters: [State<N>; 2],
    /// The integral of the trace of the Jacobian, of methods that make it beside the tangent.
    pub log_determinant: Option<f64>,
    /// In the plane of symmetric states: the logarithm by which a small difference between the interfaces grows, where the
    /// method makes it.
    pub log_transverse: Option<f64>,
    /// Steps that the method took.
    pub steps: usize,
    /// Bound on what the method errs by at the end, in units of 1 + |y|: steps times tolerance and rounding.
    pub error: f64,
}

impl<const N: usize> Arc<N> {
    /// Its error where the steps' errors are rounding, which adds up like a random walk.
    pub(crate) fn noise(&self) -> f64 {
        self.error / (self.steps.max(1) as f64).sqrt()
    }

    /// The same where the tolerance leaves little but rounding: half a unit in the last place of the sum with which a step ends.
    #[doc(hidden)]
    pub fn rounding(&self) -> f64 {
        /// In units of 1 + |y|; and the nominal errors of steps of which truncation is the lesser part.
        const UNIT: f64 = 0.5 * f64::EPSILON;
        const NOMINAL: f64 = 20.0 * f64::EPSILON;
        let steps = self.steps.max(1) as f64;
        if self.error > NOMINAL * steps {
            return self.noise();
        }
        UNIT * steps.sqrt()
    }

    /// ln |det| of the tangent: by the trace if the method has it, else by the tangent.
    pub fn volume(&self) -> f64 {
        self.log_determinant
            .unwrap_or_else(|| self.tangent_volume())
    }

    /// The logarithm of the digits that the tangent's determinant loses to its rounding: of |M|^N / |det M|.
    #[doc(hidden)]
    pub fn loss(&self) -> f64 {
        (N as f64 * self.tangent.norm().ln() - self.volume()).max(0.0)
    }

    /// ln |det| of the tangent, by the tangent.
    pub(crate) fn tangent_volume(&self) -> f64 {
        log_determinant(self.tangent)
    }
}

/// ln |det m|, by elimination with the largest pivots.
fn log_determinant<const N: usize>(mut m: Jacobian<N>) -> f64 {
    let mut log = 0.0;
    for j in 0..N {
        let pivot = (j..N).max_by(|&a, &b| m[(a, j)].abs().total_cmp(&m[(b, j)].abs()));
        m.swap_rows(j, pivot.unwrap_or(j));
        log += m[(j, j)].abs().ln();
        for i in j + 1..N {
            let part = m[(i, j)] / m[(j, j)];
            for l in j..N {
                m[(i, l)] -= part * m[(j, l)];
            }
        }
    }
    log
}

/// What makes arcs.
pub struct Tracer<const N: usize> {
    method: ArcIntegrator<N>,
    name: &'static str,
    /// What a step may err by, in units of 1 + |y|.
    step_error: f64,
    work: Work,
    /// How many steps it may take in all.
    limit: Option<usize>,
}

enum ArcIntegrator<const N: usize> {
    Taylor(Taylor),
    Other(Box<dyn Integrator<N>>),
}

/// Rounding in a step, relative: of the sums, of the constants and of the change to logarithms.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl<const N: usize> Tracer<N> {
    /// By this method, with at most so many steps in an arc. `auto` traces with Taylor: a periodic orbit is no place for
    /// strong damping.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for tolerances outside their domain or no steps.
    pub fn new(choice: Choice, tolerances: Tolerances, max_steps: usize) -> Result<Self> {
        let (method, name) = match choice {
            Choice::Auto | Choice::Taylor => (
                ArcIntegrator::Taylor(Taylor::new(tolerances, max_steps)?),
                Choice::Taylor.name(),
            ),
            other => (
                ArcIntegrator::Other(other.integrator(tolerances, max_steps)?),
                other.name(),
            ),
        };
        Ok(Tracer {
            method,
            name,
            step_error: tolerances.rtol + tolerances.atol + ROUNDING,
            work: Work::default(),
            limit: None,
        })
    }

    /// The method's name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Whether arcs come with derivatives in the parameters.
    pub(crate) fn differentiates(&self) -> bool {
        matches!(self.method, ArcIntegrator::Taylor(_))
    }

    /// All work so far.
    pub fn work(&self) -> Work {
        self.work
    }

    /// By Taylor's method with this tolerance.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for a tolerance outside its domain.
    pub fn taylor(tolerance: f64) -> Result<Self> {
        Self::new(Choice::Taylor, Tolerances::equal(tolerance)?, MAX_STEPS)
    }

    /// By Taylor's method with this tolerance, for no more than so many steps in an arc and about so many in all.
    ///
    /// # Errors
    /// As of [`Self::taylor`].
    pub(crate) fn limited(tolerance: f64, arc: usize, all: usize) -> Result<Self> {
        Ok(Tracer {
            limit: Some(all),
            ..Self::new(Choice::Taylor, Tolerances::equal(tolerance)?, arc.min(all))?
        })
    }

    /// The bound on all steps, where it is used up.
    pub(crate) fn used_up(&self) -> Option<usize> {
        self.limit.filter(|&limit| self.work.steps >= limit)
    }

    fn allowed(&self, end: f64) -> Result<()> {
        match self.used_up() {
            Some(limit) => Err(Error::TooManySteps { t: 0.0, end, limit }),
            None => Ok(()),
        }
    }

    /// The arc of this duration from `start`, with the derivatives in the parameters of these places: two, or none.
    ///
    /// # Errors
    /// Those of [`Integrator::flow`].
    pub fn arc(
        &mut self,
        field: &dyn VectorField<N>,
        start: &State<N>,
        duration: f64,
        free: &[usize],
    ) -> Result<Arc<N>> {
        self.allowed(duration)?;
        let span = (0.0, duration);
        let (made, work) = match &mut self.method {
            ArcIntegrator::Taylor(taylor) => {
                let made = taylor.derivatives(field, span, start, free);
                let made = made.map(|(end, d)| {
                    let logs = (Some(d.log_determinant), d.log_transverse);
                    let mut columns = d.parameters.iter().copied().map(State::from);
                    let columns = [(); 2].map(|()| columns.next().unwrap_or_else(State::zeros));
                    (end, d.start.into(), columns, logs)
                });
                (made, Integrator::<N>::work(taylor))
            }
            ArcIntegrator::Other(integrator) => {
                let made = integrator.tangent_flow(field, span, start);
                let none = ([State::zeros(); 2], (None, None));
                let made = made.map(|(end, tangent)| (end, tangent, none.0, none.1));
                (made, integrator.work())
            }
        };
        // Also of what fails.
        self.work += work;
        let (end, tangent, in_parameters, logs) = made?;
        Ok(Arc {
            end,
            tangent,
            parameters: in_parameters,
            log_determinant: logs.0,
            log_transverse: logs.1,
            steps: work.steps,
            error: self.step_error * work.steps.max(1) as f64,
        })
    }

    /// The flow alone.
    ///
    /// # Errors
    /// Those of [`Integrator::flow`].
    pub fn flow(
        &mut self,
        field: &dyn VectorField<N>,
        start: &State<N>,
        duration: f64,
        observer: Option<crate::integrate::Observer<'_, N>>,
    ) -> Result<State<N>> {
        self.allowed(duration)?;
        let span = (0.0, duration);
        let (end, work) = match &mut self.method {
            ArcIntegrator::Taylor(taylor) => {
                let end = taylor.flow(field, span, start, observer);
                (end, Integrator::<N>::work(taylor))
            }
            ArcIntegrator::Other(integrator) => {
                let end = integrator.flow(field, span, start, observer);
                (end, integrator.work())
            }
        };
        self.work += work;
        end
    }
}
