//! The Taylor method: every step is the power series of the solution at its beginning.
//!
//! The order is 12 to 24 by the tolerance, and every step as long as the last terms of its series allow (Jorba & Zou
//! 2005). The polynomial is the dense output, to the order of the method and at no cost. A step is tried but once: it is
//! shortened, without another series, only where it would leave the domain of the law.
//!
//! Along stick-slip cycles no method here comes near it. On strongly damped stretches its step is held by stability, at some
//! 5 to 8 over the fastest rate by the order, whatever the tolerance: an implicit method is better there.

mod batch;
mod way;

pub use batch::{Batch, BatchObserver, BatchRun};

use super::{Control, Integrator, Observer, Step, Tolerances, Work, step_underflow};
use crate::error::{Error, Result};
use crate::field::{Analytic, Jacobian, State, VectorField, checked_places};
use crate::number::DoubleDouble;
use crate::series::{
    Accuracy, Derivatives, Expansion, Jet3, REFERENCE_ORDER, Solution, Tangent, TaylorMap,
    usual_order,
};
use std::cell::LazyCell;
use way::{Clock, Unseen, Way};

/// A Taylor integrator. A step may err by `atol + rtol |tau|` in tau, and in psi by `atol + rtol` of itself.
///
/// ```
/// use twinslip::field::State;
/// use twinslip::friction::Parameters;
/// use twinslip::integrate::{Integrator, MAX_STEPS, Taylor, Tolerances};
/// use twinslip::model::{Loading, TwoInterfaces};
/// # fn main() -> twinslip::Result<()> {
/// let law = Parameters::heslot_1994().spinodal();
/// let field = TwoInterfaces { law, loading: Loading::new(10.0, 0.14)? };
/// let y0 = State::<3>::new(10.0, 0.5_f64.ln(), 0.001_f64.ln());
/// let mut taylor = Taylor::new(Tolerances::equal(1e-12)?, MAX_STEPS)?;
/// let there = taylor.flow(&field, (0.0, 1.0), &y0, None)?;
/// let back = taylor.flow(&field, (1.0, 0.0), &there, None)?;
/// assert!((back - y0).amax() < 1e-9);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Taylor {
    arithmetic: Arithmetic,
    accuracy: Accuracy,
    max_step: f64,
    max_steps: usize,
    work: Work,
}

/// Whether to halt after a step of this order and length, at the state that a call gives.
type Halt<'a, const N: usize> = &'a mut dyn FnMut(usize, f64, &dyn Fn() -> State<N>) -> bool;

/// What the series are made in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Arithmetic {
    Double,
    DoubleDouble,
}

impl Taylor {
    /// At most `max_steps` steps in a flow.
    ///
    /// # Errors
    /// [`Error::Parameter`] for tolerances outside their domain or no steps.
    pub fn new(tolerances: Tolerances, max_steps: usize) -> Result<Self> {
        let Tolerances {
            rtol,
            atol,
            max_step,
        } = tolerances.checked()?;
        if max_steps == 0 {
            return Err(Error::parameter("max-steps", 0, "at least 1"));
        }
        let accuracy = Accuracy {
            order: usual_order(rtol),
            tolerances: (rtol, atol),
        };
        Ok(Taylor {
            arithmetic: Arithmetic::Double,
            accuracy,
            max_step,
            max_steps,
            work: Work::default(),
        })
    }

    /// The same in double-double arithmetic, with some 28 digits in a step: what the others are measured by. It solves the
    /// problem whose parameters and start are the given doubles, exactly. At most `max_steps` steps in a flow.
    ///
    /// # Errors
    /// [`Error::Parameter`] for no steps.
    pub fn reference(max_steps: usize) -> Result<Self> {
        /// Tolerances of a step. Rounding stays below.
        const FINE: f64 = 1e-29;
        let fine = Self::new(Tolerances::equal(1e-16)?, max_steps)?;
        Ok(Taylor {
            arithmetic: Arithmetic::DoubleDouble,
            accuracy: Accuracy {
                order: REFERENCE_ORDER,
                tolerances: (FINE, FINE),
            },
            ..fine
        })
    }

    /// The state at `t.1` and its derivatives in `y0` and in the parameters of these places among those of
    /// [`VectorField::parametrised`]. The integral of the trace of the Jacobian comes along.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a place where there is no parameter; those of [`Integrator::flow`].
    pub fn derivatives<const N: usize>(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        free: &[usize],
    ) -> Result<(State<N>, Derivatives<N>)> {
        let mut tangent = self.tangent(field, free)?;
        self.derivatives_by(&mut *tangent, field, t, y0)
    }

    /// What [`Taylor::derivatives`] are made by, for several of them one after the other.
    pub(super) fn tangent<'f, const N: usize>(
        &mut self,
        field: &'f dyn VectorField<N>,
        free: &[usize],
    ) -> Result<Box<dyn Tangent<N> + 'f>> {
        self.work = Work::default();
        checked_places(field, free)?;
        let analytic = analytic(field)?;
        Ok(match self.arithmetic {
            Arithmetic::Double => analytic.tangent(free),
            Arithmetic::DoubleDouble => analytic.reference_tangent(free),
        })
    }

    /// The derivatives by that.
    pub(super) fn derivatives_by<const N: usize>(
        &mut self,
        tangent: &mut dyn Tangent<N>,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
    ) -> Result<(State<N>, Derivatives<N>)> {
        self.work = Work::default();
        let (end, _) = self.trajectory(field, t, y0, tangent, None, &mut |_, _, _| false)?;
        Ok((end, numbers(tangent.derivatives(), t.1)?))
    }

    /// The state at `t.1` to third order in two variations, those of `y0`.
    ///
    /// # Errors
    /// Those of [`Integrator::flow`].
    pub fn transport<const N: usize>(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: [Jet3; N],
    ) -> Result<[Jet3; N]> {
        let (transport, _) = self.transported(field, t, y0)?;
        // Without a step there is nothing that was started.
        Ok(if self.work.steps == 0 {
            y0
        } else {
            transport.polynomials()
        })
    }

    /// The map onto the plane normal . (x - point) = 0, passed near `t.1`, to third order in the variations of `y0`: the time of
    /// the passage since `t.0`, and the state there.
    ///
    /// # Errors
    /// Those of [`Integrator::flow`]; [`Error::NotConverged`] if the plane is not passed within the step that ends at `t.1`.
    pub fn transport_onto<const N: usize>(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: [Jet3; N],
        (normal, point): (&State<N>, &State<N>),
    ) -> Result<(Jet3, [Jet3; N])> {
        let (transport, last) = self.transported(field, t, y0)?;
        let plane = (&normal.data.0[0], &point.data.0[0]);
        let Some((mut time, state)) = transport.onto_plane(plane, last) else {
            let end = State::from(transport.state());
            return Err(Error::NotConverged {
                what: "the passage of a plane",
                iterations: 8,
                residual: normal.dot(&(end - point)).abs(),
                tolerance: 1e-12,
            });
        };
        // The last step ended at t.1.
        time.0[0] += (t.1 - t.0) - last;
        Ok((time, state))
    }

    /// A transport at `t.1`, and the length of its last step.
    fn transported<'f, const N: usize>(
        &mut self,
        field: &'f dyn VectorField<N>,
        t: (f64, f64),
        y0: [Jet3; N],
    ) -> Result<(Box<dyn TaylorMap<N> + 'f>, f64)> {
        self.work = Work::default();
        let transport = analytic(field)?.transport(y0);
        let mut transport = transport.ok_or(Error::NotAnalytic)?;
        let start = State::from(y0.map(Jet3::value));
        let mut last = 0.0;
        let mut halt = |_, h: f64, _: &dyn Fn() -> State<N>| {
            last = h;
            false
        };
        self.trajectory(field, t, &start, &mut *transport, None, &mut halt)?;
        Ok((transport, last))
    }

    /// The flow up to the step after which `halt` says so, and the time then.
    pub(super) fn flow_until<const N: usize>(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        observer: Option<Observer<'_, N>>,
        halt: Halt<'_, N>,
    ) -> Result<(State<N>, f64)> {
        self.work = Work::default();
        let mut solution = analytic(field)?.solution();
        self.trajectory(field, t, y0, &mut *solution, observer, halt)
    }

    /// The same with the tangent flow.
    pub(super) fn tangent_until<const N: usize>(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        halt: Halt<'_, N>,
    ) -> Result<((State<N>, f64), Jacobian<N>)> {
        let mut tangent = self.tangent(field, &[])?;
        let end = self.trajectory(field, t, y0, &mut *tangent, None, halt)?;
        Ok((
            end,
            Jacobian::from(numbers(tangent.derivatives(), t.1)?.start),
        ))
    }

    /// With this largest step.
    pub fn stepping(self, max_step: f64) -> Self {
        Taylor { max_step, ..self }
    }

    /// Another bound on steps.
    pub(super) fn set_max_steps(&mut self, max_steps: usize) {
        self.max_steps = max_steps;
    }

    fn trajectory<const N: usize>(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        solution: &mut dyn Solution<N>,
        mut observer: Option<Observer<'_, N>>,
        halt: Halt<'_, N>,
    ) -> Result<(State<N>, f64)> {
        let accuracy = match self.arithmetic {
            Arithmetic::Double => Accuracy {
                order: solution.order(self.accuracy.tolerances.0),
                ..self.accuracy
            },
            Arithmetic::DoubleDouble => self.accuracy,
        };
        solution.start(&y0.data.0[0]);
        let mut way = Way {
            clock: Clock::new(t),
            y: *y0,
            unseen: Unseen::default(),
        };
        let on_the_way = self.steps(field, &accuracy, solution, &mut way, &mut observer, halt);
        // Where the rates are no numbers there is no first step.
        if self.work.steps == 0 && !field.f(y0).iter().all(|x| x.is_finite()) {
            return Err(Error::NonFinite {
                what: "the right-hand side",
                t: t.0,
            });
        }
        if let (Err(_), Some(observer), true) = (&on_the_way, &mut observer, way.unseen.passed) {
            way.show_unseen(&State::from(solution.state()), observer)?;
        }
        on_the_way?;
        // Without a step not even the logarithm of an exponential shall come between.
        let end = if self.work.steps == 0 {
            *y0
        } else {
            State::from(solution.state())
        };
        Ok((end, way.clock.now.hi()))
    }

    /// One step after the other, to the end or where it is to stop.
    fn steps<const N: usize>(
        &mut self,
        field: &dyn VectorField<N>,
        accuracy: &Accuracy,
        solution: &mut dyn Solution<N>,
        Way { clock, y, unseen }: &mut Way<N>,
        observer: &mut Option<Observer<'_, N>>,
        halt: Halt<'_, N>,
    ) -> Result<()> {
        // Made where it is asked for: most flows have no observer.
        let mut room = None;
        while let Some(remaining) = clock.remaining() {
            if self.work.steps == self.max_steps {
                return Err(Error::TooManySteps {
                    t: clock.now.hi(),
                    end: clock.end,
                    limit: self.max_steps,
                });
            }
            let limit = if remaining.hi().abs() > self.max_step {
                DoubleDouble::from(self.max_step.copysign(remaining.hi()))
            } else {
                remaining
            };
            let h = solution.advance(accuracy, limit);
            // Also of what fails.
            self.work.rejected = solution.rejected();
            let (begin, before) = (clock.now, clock.now.hi());
            if !clock.tick(h, remaining) {
                let h = if h.is_finite() { h.hi() } else { 0.0 };
                let h = h.copysign(remaining.hi());
                let here = State::from(solution.state());
                return Err(step_underflow(field, before, h, &here));
            }
            self.work.steps += 1;
            // One evaluation of the law for each coefficient.
            self.work.rhs += accuracy.order;
            let halted = halt(accuracy.order, h.hi(), &|| State::from(solution.state()));
            if let Some(observer) = observer {
                let last = halted || clock.remaining().is_none();
                if unseen.passes(last, before, || solution.slips(accuracy.order, h.hi())) {
                    continue;
                }
                let made = LazyCell::new(|| {
                    let expansion = room.get_or_insert_with(Expansion::new);
                    solution.expansion(accuracy.order, expansion);
                    (expansion.begin, expansion.length) = (begin, h.hi());
                    &*expansion
                });
                if unseen.passed {
                    *y = State::from(made.state(0.0));
                }
                let end = State::from(solution.state());
                let slips = || solution.slips(accuracy.order, h.hi());
                let control = observer(&Step {
                    t0: before,
                    y0: y,
                    t1: clock.now.hi(),
                    y1: &end,
                    begin,
                    length: h.hi(),
                    continuous: &|time| State::from(made.state(time)),
                    reach: f64::INFINITY,
                    expansion: Some(&made),
                    slips: Some(&|| slips().map(|slips| unseen.and(slips))),
                })?;
                *y = end;
                *unseen = Unseen::default();
                match control {
                    Control::Continue => {}
                    Control::Stop => break,
                    Control::Rest(steps) => unseen.steps = steps,
                }
            }
            if halted {
                break;
            }
        }
        Ok(())
    }
}

impl<const N: usize> Integrator<N> for Taylor {
    fn name(&self) -> &'static str {
        match self.arithmetic {
            Arithmetic::Double => "taylor",
            Arithmetic::DoubleDouble => "reference",
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
        let analytic = analytic(field)?;
        let mut solution = match self.arithmetic {
            Arithmetic::Double => analytic.solution(),
            Arithmetic::DoubleDouble => analytic.reference(),
        };
        let end = self.trajectory(field, t, y0, &mut *solution, observer, &mut |_, _, _| false)?;
        Ok(end.0)
    }

    fn tangent_flow(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
    ) -> Result<(State<N>, Jacobian<N>)> {
        let ((end, _), tangent) = self.tangent_until(field, t, y0, &mut |_, _, _| false)?;
        Ok((end, tangent))
    }

    fn work(&self) -> Work {
        self.work
    }
}

/// The field in power series, or the reason why this method can't.
fn analytic<const N: usize>(field: &dyn VectorField<N>) -> Result<&dyn Analytic<N>> {
    field.analytic().ok_or(Error::NotAnalytic)
}

/// The derivatives, if all are numbers.
fn numbers<const N: usize>(derivatives: Derivatives<N>, t: f64) -> Result<Derivatives<N>> {
    let mut columns = derivatives.start.iter().chain(&derivatives.parameters);
    if columns.any(|column| column.iter().any(|x| x.is_nan())) {
        return Err(Error::NonFinite {
            what: "a derivative of the solution",
            t,
        });
    }
    Ok(derivatives)
}
