//! The method that suits the run: Taylor, and Rodas5P for as long as strong damping would hold Taylor's steps short; Rodas4,
//! whose steps are cheaper, in its place at loose tolerances.
//!
//! An explicit method's step is bound by h |lambda| for the fastest decaying mode lambda, Taylor's at 0.45 times its
//! order. So a run begins with Taylor, and every few steps the dominant mode of the Jacobian is looked at; where h |lambda|
//! has come to that bound in a decaying mode, Rodas5P is tried. It stays while its steps are longer by more than what they
//! cost more, and hands back to Taylor otherwise. A try that did not pay makes the next one wait twice as long.
//!
//! CVODE is never chosen: in no scene of the benchmarks is it ahead of Rodas5P at equal error.

use super::rosenbrock::{Rosenbrock, RosenbrockMethod};
use super::taylor::Taylor;
use super::{Control, Integrator, Observer, Step, Tolerances, Work};
use crate::error::{Error, Result};
use crate::field::{Jacobian, State, VectorField};

/// Steps of Taylor before the first look at the Jacobian, and from one look to the next.
const FIRST_LOOK: usize = 6;
const TAYLOR_LOOKS: usize = 16;
/// Steps before a look, but the first, from which on they must not have changed by more than this factor: held ones are of one length.
const STEADY_STEPS: usize = 4;
const STEADY: f64 = 2.0;
/// Steps of Rodas5P from one look at the Jacobian to the next.
const RODAS_LOOKS: usize = 4;
/// h |lambda| over the order from which on Taylor's step counts as held by stability, which does so at 0.45.
const HELD: f64 = 0.35;
/// h |lambda| that Rodas5P has to keep: at less Taylor, with a third of the time a step, is ahead.
const PAYS: f64 = 20.0;
/// Steps of Rodas5P, which begins with short ones, before it is judged by that.
const TRIAL: usize = 12;
/// h |lambda| without which a trial ends at its first look: Taylor goes as far.
const FUTILE: f64 = 4.0;
/// Longest wait for the next try, in looks.
const PATIENCE: usize = 1 << 12;

/// The Rosenbrock method that needs the least time at a tolerance.
fn implicit(rtol: f64) -> RosenbrockMethod {
    /// Above it the lower order wins.
    const LOOSE: f64 = 1e-5;
    if rtol > LOOSE {
        RosenbrockMethod::Rodas4
    } else {
        RosenbrockMethod::Rodas5P
    }
}

/// An integrator that switches between Taylor and Rodas5P along the run.
///
/// ```
/// use twinslip::field::State;
/// use twinslip::friction::Parameters;
/// use twinslip::integrate::{Auto, Integrator, MAX_STEPS, Tolerances};
/// use twinslip::model::{Loading, TwoInterfaces};
/// # fn main() -> twinslip::Result<()> {
/// let law = Parameters::heslot_1994().spinodal();
/// let field = TwoInterfaces { law, loading: Loading::new(1000.0, 0.14)? };
/// let y0 = State::<3>::new(10.0, 0.5_f64.ln(), 0.001_f64.ln());
/// let mut auto = Auto::new(Tolerances::equal(1e-8)?, MAX_STEPS)?;
/// let y = auto.flow(&field, (0.0, 200.0), &y0, None)?;
/// assert!((y[0] - 8.78022825).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Auto<const N: usize> {
    taylor: Taylor,
    rodas: Rosenbrock<N>,
    max_steps: usize,
    work: Work,
}

impl<const N: usize> Auto<N> {
    /// At most `max_steps` steps in a flow.
    ///
    /// # Errors
    /// [`Error::Parameter`] for tolerances outside their domain or no steps.
    pub fn new(tolerances: Tolerances, max_steps: usize) -> Result<Self> {
        Ok(Auto {
            taylor: Taylor::new(tolerances, max_steps)?,
            rodas: Rosenbrock::new(implicit(tolerances.rtol), tolerances, max_steps)?,
            max_steps,
            work: Work::default(),
        })
    }

    /// The flow, stretch by stretch, and with it its tangent where that is asked for.
    fn stretches(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        mut observer: Option<Observer<'_, N>>,
        mut tangent: Option<&mut Jacobian<N>>,
    ) -> Result<State<N>> {
        self.work = Work::default();
        let (mut now, mut y) = (t.0, *y0);
        let mut implicit = field.analytic().is_none();
        let (mut wait, mut stopped) = (0, false);
        loop {
            let mut reached = now;
            let mut relay = Relay {
                observer: observer.as_deref_mut(),
                reached: &mut reached,
                stopped: &mut stopped,
                tangent: tangent.as_deref_mut(),
            };
            let steps = self.work.steps;
            let left = self.max_steps - steps;
            let begin = y;
            let end = if implicit {
                let fixed = field.analytic().is_none();
                self.implicit(field, (now, t.1), &y, left, fixed, &mut relay)
            } else {
                self.explicit(field, (now, t.1), &y, left, wait, &mut relay)
            };
            self.work += self.last_work(implicit);
            y = end.map_err(|error| self.whole(error, t.1))?;
            if let (true, Some(tangent)) = (implicit, &mut tangent) {
                // The run of the state has found where its stretch ends.
                self.rodas.set_max_steps(self.max_steps);
                let along = self.rodas.tangent_flow(field, (now, reached), &begin);
                self.work += self.last_work(implicit);
                let (end, part) = along.map_err(|error| self.whole(error, t.1))?;
                y = end;
                **tangent = part * **tangent;
            }
            now = reached;
            if stopped || now == t.1 {
                return Ok(y);
            }
            if implicit {
                let paid = self.work.steps - steps > 2 * TRIAL;
                wait = if paid {
                    0
                } else {
                    (2 * wait).clamp(1, PATIENCE)
                };
            }
            implicit = !implicit;
            if self.work.steps >= self.max_steps {
                return Err(Error::TooManySteps {
                    t: now,
                    end: t.1,
                    limit: self.max_steps,
                });
            }
        }
    }

    /// Taylor until its step is held by stability.
    fn explicit(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y: &State<N>,
        left: usize,
        wait: usize,
        relay: &mut Relay<'_, '_, N>,
    ) -> Result<State<N>> {
        const BEFORE_LOOK: usize = FIRST_LOOK - STEADY_STEPS;
        self.taylor.set_max_steps(left);
        let (mut steps, mut wait, mut earlier) = (0, wait, 0.0);
        let mut held = |order: usize, h: f64, state: &dyn Fn() -> State<N>| {
            steps += 1;
            match steps % TAYLOR_LOOKS {
                FIRST_LOOK => {}
                BEFORE_LOOK => {
                    earlier = h;
                    return false;
                }
                _ => return false,
            }
            let steady = (1.0 / STEADY..=STEADY).contains(&(h / earlier));
            if !(steady || steps == FIRST_LOOK) {
                return false;
            }
            if wait > 0 {
                wait -= 1;
                return false;
            }
            let (rate, decays) = dominant_mode(&field.jacobian(&state()));
            decays && h.abs() * rate > HELD * order as f64
        };
        let (end, reached) = match (&mut relay.tangent, &relay.observer) {
            (Some(tangent), _) => {
                let (end, part) = self.taylor.tangent_until(field, t, y, &mut held)?;
                **tangent = part * **tangent;
                end
            }
            (None, None) => self.taylor.flow_until(field, t, y, None, &mut held)?,
            (None, Some(_)) => {
                let mut observer = |step: &Step<'_, N>| relay.see(step);
                self.taylor
                    .flow_until(field, t, y, Some(&mut observer), &mut held)?
            }
        };
        *relay.reached = reached;
        Ok(end)
    }

    /// Rodas5P until its steps no longer pay; to the end if there is no other choice.
    fn implicit(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y: &State<N>,
        left: usize,
        fixed: bool,
        relay: &mut Relay<'_, '_, N>,
    ) -> Result<State<N>> {
        self.rodas.set_max_steps(left);
        let mut steps = 0;
        let mut observer = |step: &Step<'_, N>| {
            let control = relay.see(step)?;
            steps += 1;
            if control == Control::Stop || fixed || steps % RODAS_LOOKS != 0 {
                return Ok(control);
            }
            let (rate, decays) = dominant_mode(&field.jacobian(step.y1));
            let least = if steps < TRIAL { FUTILE } else { PAYS };
            let pays = decays && step.length.abs() * rate > least;
            Ok(if pays {
                Control::Continue
            } else {
                Control::Stop
            })
        };
        self.rodas.flow(field, t, y, Some(&mut observer))
    }

    fn last_work(&self, implicit: bool) -> Work {
        if implicit {
            Integrator::<N>::work(&self.rodas)
        } else {
            Integrator::<N>::work(&self.taylor)
        }
    }

    /// The error of a stretch as one of the whole run.
    fn whole(&self, error: Error, end: f64) -> Error {
        match error {
            Error::TooManySteps { t, .. } => Error::TooManySteps {
                t,
                end,
                limit: self.max_steps,
            },
            other => other,
        }
    }
}

type StepObserver<'o, const N: usize> = dyn FnMut(&Step<'_, N>) -> Result<Control> + 'o;

/// Hands steps on to the observer, and keeps how far the run has come, and its tangent so far.
struct Relay<'a, 'o, const N: usize> {
    observer: Option<&'a mut StepObserver<'o, N>>,
    reached: &'a mut f64,
    stopped: &'a mut bool,
    tangent: Option<&'a mut Jacobian<N>>,
}

impl<const N: usize> Relay<'_, '_, N> {
    fn see(&mut self, step: &Step<'_, N>) -> Result<Control> {
        *self.reached = step.t1;
        let Some(observer) = &mut self.observer else {
            return Ok(Control::Continue);
        };
        let control = observer(step)?;
        *self.stopped = control == Control::Stop;
        Ok(control)
    }
}

impl<const N: usize> Integrator<N> for Auto<N> {
    fn name(&self) -> &'static str {
        "auto"
    }

    fn flow(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        observer: Option<Observer<'_, N>>,
    ) -> Result<State<N>> {
        self.stretches(field, t, y0, observer, None)
    }

    fn tangent_flow(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
    ) -> Result<(State<N>, Jacobian<N>)> {
        let mut tangent = Jacobian::identity();
        let end = self.stretches(field, t, y0, None, Some(&mut tangent))?;
        Ok((end, tangent))
    }

    fn work(&self) -> Work {
        self.work
    }
}

/// |lambda| of the fastest mode, roughly, by powers of the Jacobian, and whether it decays: a pair of complex modes turns every
/// vector, but its trace tells.
fn dominant_mode<const N: usize>(jacobian: &Jacobian<N>) -> (f64, bool) {
    /// Powers whose growth is taken, after as many that turn the vector into the fastest modes.
    const POWERS: i32 = 4;
    /// Part of |lambda| that the trace has to be.
    const DAMPED: f64 = 0.3;
    // No mode of these systems is orthogonal to it.
    let mut v = State::<N>::from_fn(|i, _| 1.0 / (1.0 + i as f64));
    let mut log_growth = 0.0;
    for power in 0..2 * POWERS {
        let next = jacobian * v;
        let size = next.amax();
        if !(size.is_finite() && size > 0.0) {
            return (0.0, false);
        }
        if power >= POWERS {
            // The product overflows where K is 1e100.
            log_growth += size.ln();
        }
        v = next / size;
    }
    let rate = f64::exp(log_growth / f64::from(POWERS));
    (rate, -jacobian.trace() > DAMPED * rate)
}
