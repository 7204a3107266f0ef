//! Arcs of multiple shooting: pieces of trajectories with their derivatives, by any of the methods.

use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::integrate::{
    AnyField, AnyIntegrator, AnyObserver, AnyStep, Choice, Control, DerivativesAlongArcs,
    MAX_STEPS, Tolerances, Work,
};

/// No more variables are few.
const FEW: usize = 8;

/// What counts of a sum over all directions, as the trace is one: of many their mean.
pub(super) fn share(dimension: usize) -> f64 {
    if dimension > FEW {
        1.0 / dimension as f64
    } else {
        1.0
    }
}

/// A piece of a trajectory, from a start that the caller knows.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Arc {
    /// The state at its end.
    pub end: Vector,
    /// The derivative of the end in the start.
    pub tangent: Matrix,
    /// The derivatives of the end in the parameters that were asked for, a column for each; none from methods that make none.
    pub parameters: Matrix,
    /// The integral of the trace of the Jacobian, of methods that make it beside the tangent.
    pub log_determinant: Option<f64>,
    /// The error of the quadrature by which it was computed, where it was; 0 elsewhere.
    pub(super) volume_error: f64,
    /// In the plane of symmetric states: the logarithm by which a small difference between the interfaces grows, where the
    /// method makes it.
    pub log_transverse: Option<f64>,
    /// Steps that the method took.
    pub steps: usize,
    /// Bound on what the method errs by at the end, in units of 1 + |y|: steps times tolerance and rounding.
    pub error: f64,
}

impl Arc {
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

    /// The logarithm of the digits that the tangent loses to its rounding: those of its determinant, |M|^N / |det M|; of many variables those of the direction
    /// that shrinks most, |M| |M^-1|, as small losses in each of them would add up to one that none has.
    #[doc(hidden)]
    pub fn loss(&self) -> f64 {
        self.loss_of(&self.tangent)
    }

    /// The same with every variable in units of its size.
    pub(super) fn loss_in(&self, sizes: &Vector) -> f64 {
        let scaled = |i: usize, j: usize| self.tangent[(i, j)] * (sizes[j] / sizes[i]);
        let count = sizes.len();
        self.loss_of(&Matrix::from_fn(count, count, scaled))
    }

    fn loss_of(&self, tangent: &Matrix) -> f64 {
        let count = self.end.len();
        let loss = if count > FEW {
            let inverse = tangent.clone().try_inverse();
            inverse.map_or(f64::INFINITY, |inverse| {
                tangent.norm().ln() + inverse.norm().ln() - (count as f64).ln()
            })
        } else {
            count as f64 * tangent.norm().ln() - self.volume()
        };
        // Of a tangent that is 0 to all digits all are lost.
        if loss.is_nan() {
            f64::INFINITY
        } else {
            loss.max(0.0)
        }
    }

    /// ln |det| of the tangent, by the tangent.
    pub(crate) fn tangent_volume(&self) -> f64 {
        log_determinant(self.tangent.clone())
    }
}

/// ln |det m|, by elimination with the largest pivots.
fn log_determinant(mut m: Matrix) -> f64 {
    let (mut log, count) = (0.0, m.nrows());
    for j in 0..count {
        let pivot = (j..count).max_by(|&a, &b| m[(a, j)].abs().total_cmp(&m[(b, j)].abs()));
        m.swap_rows(j, pivot.unwrap_or(j));
        log += m[(j, j)].abs().ln();
        for i in j + 1..count {
            let part = m[(i, j)] / m[(j, j)];
            for l in j..count {
                m[(i, l)] -= part * m[(j, l)];
            }
        }
    }
    log
}

/// What makes arcs.
pub struct Tracer {
    /// With its own tolerances, and with a coarse relative one.
    methods: [AnyIntegrator; 2],
    /// Which of them is used.
    used: usize,
    /// What a step may err by, in units of 1 + |y|.
    step_error: f64,
    bound: WorkBound,
}

/// All work, and what it may be.
struct WorkBound {
    work: Work,
    /// How many steps may be taken in all.
    limit: Option<usize>,
}

impl WorkBound {
    fn used_up(&self) -> Option<usize> {
        self.limit.filter(|&limit| self.work.steps >= limit)
    }

    fn allowed(&self, end: f64) -> Result<()> {
        match self.used_up() {
            Some(limit) => Err(Error::TooManySteps { t: 0.0, end, limit }),
            None => Ok(()),
        }
    }
}

/// The coarse relative tolerance of flows and their derivatives while an iteration is far from its end. The absolute one stays: what is small may set the
/// pace.
const COARSE: f64 = 1e-8;
/// The absolute tolerance of the implicit method over its relative one. In relaxation oscillations a variable that is far below its unit for most of
/// the time sets the pace of the others; below a hundredth the least of the relative tolerances leaves nothing but rounding.
const OF_UNIT: f64 = 0.01;
/// Rounding in a step, relative: of the sums, of the constants and of the change to logarithms.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Tracer {
    /// By this method, with at most so many steps in an arc. `auto` traces with Taylor: a periodic orbit is no place for
    /// strong damping.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for tolerances outside their domain or no steps.
    pub fn new(choice: Choice, tolerances: Tolerances, max_steps: usize) -> Result<Self> {
        let choice = match choice {
            Choice::Auto => Choice::Taylor,
            other => other,
        };
        let coarse = Tolerances {
            rtol: COARSE.max(tolerances.rtol),
            ..tolerances
        };
        let [own, coarse] =
            [tolerances, coarse].map(|these| AnyIntegrator::new(choice, these, max_steps));
        Ok(Tracer {
            methods: [own?, coarse?],
            used: 0,
            step_error: tolerances.rtol + tolerances.atol + ROUNDING,
            bound: WorkBound {
                work: Work::default(),
                limit: None,
            },
        })
    }

    /// The method's name.
    pub fn name(&self) -> &'static str {
        self.methods[0].name()
    }

    /// Whether arcs come with derivatives in the parameters.
    pub(crate) fn differentiates(&self) -> bool {
        self.methods[0].differentiates()
    }

    /// All work so far.
    pub fn work(&self) -> Work {
        self.bound.work
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
        Self::limited_by(Choice::Taylor, tolerance, arc, all)
    }

    /// The same by another method.
    ///
    /// # Errors
    /// As of [`Self::new`].
    pub(super) fn limited_by(
        method: Choice,
        tolerance: f64,
        arc: usize,
        all: usize,
    ) -> Result<Self> {
        let absolute = match method {
            Choice::Radau => tolerance * OF_UNIT,
            _ => tolerance,
        };
        let tolerances = Tolerances::new(tolerance, absolute)?;
        let tracer = Self::new(method, tolerances, arc.min(all))?;
        Ok(tracer.within(all))
    }

    /// The same for about so many steps in all.
    pub(super) fn within(mut self, all: usize) -> Self {
        self.bound.limit = Some(all);
        self
    }

    /// From now on with a coarse relative tolerance, or again with its own.
    pub(super) fn coarsely(&mut self, yes: bool) {
        self.used = usize::from(yes);
    }

    /// The bound on all steps, where it is used up.
    pub(crate) fn used_up(&self) -> Option<usize> {
        self.bound.used_up()
    }

    /// The arc of this duration from `start`, with the derivatives in the parameters of these places: two, or none.
    ///
    /// # Errors
    /// Those of [`AnyIntegrator::derivatives`].
    pub fn arc(
        &mut self,
        field: &AnyField<'_>,
        start: &Vector,
        duration: f64,
        free: &[usize],
    ) -> Result<Arc> {
        self.arcs(field, free)?.arc(start, duration)
    }

    /// The same for several arcs: what makes them is made once.
    ///
    /// # Errors
    /// Those of [`AnyIntegrator::arcs`].
    pub(crate) fn arcs<'f>(
        &'f mut self,
        field: &'f AnyField<'_>,
        free: &'f [usize],
    ) -> Result<Arcs<'f>> {
        Ok(Arcs {
            made: self.methods[self.used].arcs(field, free)?,
            step_error: self.step_error,
            bound: &mut self.bound,
        })
    }

    /// Returns the integral of the trace of the Jacobian along an arc and an estimate of its error, for methods that do not integrate it with
    /// the tangent: Gauss-Legendre quadrature with three points in each step, compared with two points.
    ///
    /// # Errors
    /// Those of [`AnyIntegrator::flow`].
    pub(super) fn trace_along(
        &mut self,
        field: &AnyField<'_>,
        start: &Vector,
        duration: f64,
    ) -> Result<(f64, f64)> {
        /// Places and weights on (-1, 1).
        const THREE: [(f64, f64); 3] = [
            (-0.774_596_669_241_483_4, 5.0 / 9.0),
            (0.0, 8.0 / 9.0),
            (0.774_596_669_241_483_4, 5.0 / 9.0),
        ];
        const TWO: [(f64, f64); 2] = [
            (-0.577_350_269_189_625_8, 1.0),
            (0.577_350_269_189_625_8, 1.0),
        ];
        let (mut sum, mut off) = (0.0, 0.0);
        let mut see = |step: &AnyStep<'_>| {
            let half = 0.5 * step.length;
            let by = |points: &[(f64, f64)]| -> f64 {
                let at = |(at, weight): &(f64, f64)| {
                    weight * half * field.trace(step.after(half * (1.0 + at)).as_slice())
                };
                points.iter().map(at).sum()
            };
            let three = by(&THREE);
            sum += three;
            off += (three - by(&TWO)).abs();
            Ok(Control::Continue)
        };
        self.flow(field, start, duration, Some(&mut see))?;
        Ok((sum, off))
    }

    /// The states at the begins of so many equal parts of an arc.
    ///
    /// # Errors
    /// Those of [`AnyIntegrator::flow`].
    pub(crate) fn seen(
        &mut self,
        field: &AnyField<'_>,
        start: &Vector,
        duration: f64,
        parts: usize,
    ) -> Result<Vec<Vector>> {
        let mut seen = Vec::with_capacity(parts);
        let mut times = (0..parts)
            .map(|i| i as f64 / parts as f64 * duration)
            .peekable();
        let mut see = |step: &AnyStep<'_>| {
            while let Some(time) = times.next_if(|&time| time < step.t1) {
                seen.push(step.dense(time));
            }
            Ok(Control::Continue)
        };
        self.flow(field, start, duration, Some(&mut see))?;
        Ok(seen)
    }

    /// The flow alone.
    ///
    /// # Errors
    /// Those of [`AnyIntegrator::flow`].
    pub fn flow(
        &mut self,
        field: &AnyField<'_>,
        start: &Vector,
        duration: f64,
        observer: Option<AnyObserver<'_>>,
    ) -> Result<Vector> {
        self.bound.allowed(duration)?;
        let method = &mut self.methods[self.used];
        let end = method.flow(field, (0.0, duration), start, observer);
        self.bound.work += method.work();
        end
    }
}

/// What makes arcs of one field, one after the other.
pub(crate) struct Arcs<'f> {
    made: DerivativesAlongArcs<'f>,
    step_error: f64,
    bound: &'f mut WorkBound,
}

impl Arcs<'_> {
    /// The arc of this duration from `start`.
    pub fn arc(&mut self, start: &Vector, duration: f64) -> Result<Arc> {
        self.bound.allowed(duration)?;
        let made = self.made.derivatives((0.0, duration), start);
        // Also of what fails.
        let work = self.made.work();
        self.bound.work += work;
        let (end, made) = made?;
        Ok(Arc {
            end,
            tangent: made.start,
            parameters: made.parameters,
            log_determinant: made.log_determinant,
            volume_error: 0.0,
            log_transverse: made.log_transverse,
            steps: work.steps,
            error: self.step_error * work.steps.max(1) as f64,
        })
    }
}
