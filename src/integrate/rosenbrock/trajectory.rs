//! One step of the state alone.

use super::control::{MayErr, error_norm};
use super::drive::{Steppable, TimeStep};
use super::factors::Factors;
use super::stages::{Linearisation, Scheme, Staged, Stages, combination, error_order};
use crate::error::Error;
use crate::field::{State, VectorField};
use crate::integrate::tableau::{MAX_STAGES, Tableau};
use crate::integrate::{Step, Tolerances, Work, step_underflow};

/// A step in the making.
struct Stepping<'a, const N: usize> {
    field: &'a dyn VectorField<N>,
    y: &'a State<N>,
    f: &'a State<N>,
    factors: Factors<N>,
    per_h: f64,
    u: &'a mut Stages<N, 1>,
    /// f at the argument of the newest stage.
    newest: State<N>,
}

impl<const N: usize> Staged for Stepping<'_, N> {
    #[inline(always)]
    fn stage(&mut self, tableau: &Tableau, i: usize) {
        if i == 0 {
            self.u[0] = self.factors.solve(self.f);
            return;
        }
        let at = combination(*self.y, &tableau.a[i], i, self.u);
        self.newest = self.field.f(&at);
        let coupling = combination(State::zeros(), &tableau.c[i], i, self.u);
        self.u[i] = self.factors.solve(&(self.newest + coupling * self.per_h));
    }
}

/// A state on its way.
pub(super) struct StepState<'a, S, const N: usize> {
    field: &'a dyn VectorField<N>,
    tolerances: Tolerances,
    may_err: MayErr<N>,
    work: &'a mut Work,
    y: State<N>,
    here: Linearisation<N>,
    /// The end of the tried step, its stages, f at the last of them, and what was looked up ahead.
    next: State<N>,
    stages: Stages<N, 1>,
    last_f: State<N>,
    ahead: Linearisation<N>,
    scheme: S,
}

impl<'a, S: Scheme, const N: usize> StepState<'a, S, N> {
    pub fn new(
        scheme: S,
        field: &'a dyn VectorField<N>,
        tolerances: Tolerances,
        work: &'a mut Work,
        y: State<N>,
        here: Linearisation<N>,
    ) -> Self {
        StepState {
            field,
            tolerances,
            may_err: MayErr::new(tolerances, field),
            work,
            y,
            here,
            next: y,
            stages: [State::zeros(); MAX_STAGES],
            last_f: here.f,
            ahead: here,
            scheme,
        }
    }

    pub fn state(&self) -> &State<N> {
        &self.y
    }

    /// The tried step, as an observer sees it.
    pub fn show<R>(&self, time: &TimeStep, observer: impl FnOnce(&Step<'_, N>) -> R) -> R {
        let continuous = |after: f64| {
            interpolate(
                self.scheme.tableau(),
                after / time.length,
                &self.y,
                &self.next,
                &self.stages,
            )
        };
        observer(&Step {
            t0: time.begin.hi(),
            y0: &self.y,
            t1: time.end.hi(),
            y1: &self.next,
            begin: time.begin,
            length: time.length,
            continuous: &continuous,
            reach: f64::INFINITY,
            expansion: None,
            slips: None,
        })
    }
}

impl<S: Scheme, const N: usize> Steppable for StepState<'_, S, N> {
    fn error_order(&self) -> u32 {
        error_order(self.scheme.tableau())
    }

    fn max_step(&self) -> f64 {
        self.tolerances.max_step
    }

    fn work(&mut self) -> &mut Work {
        self.work
    }

    fn goes_through_spikes(&self) -> bool {
        self.field.has_spikes()
    }

    fn underflow(&self, t: f64, h: f64) -> Error {
        step_underflow(self.field, t, h, &self.y)
    }

    #[inline]
    fn attempt(&mut self, h: f64, clock: f64) -> Option<f64> {
        let tableau = self.scheme.tableau();
        self.work.factorisations += 1;
        let factors = Factors::shifted(
            self.field.dimension(),
            1.0 / (h * tableau.gamma),
            &self.here.jacobian,
        )?;
        self.work.rhs += tableau.stages - 1;
        let mut stepping = Stepping {
            field: self.field,
            y: &self.y,
            f: &self.here.f,
            factors,
            per_h: 1.0 / h,
            u: &mut self.stages,
            newest: self.here.f,
        };
        stepping.all_stages(self.scheme);
        self.last_f = stepping.newest;
        let next = combination(self.y, &tableau.m, tableau.stages, &self.stages);
        self.next = self.field.timed(next, &self.y, clock);
        let error = combination(State::zeros(), &tableau.e, tableau.stages, &self.stages);
        error_norm(self.may_err, &error, &self.y, &self.next)
    }

    fn fastest(&self) -> (f64, f64) {
        (self.here.jacobian.amax(), self.ahead.jacobian.amax())
    }

    #[inline]
    fn look_ahead(&mut self) -> bool {
        let f = if self.scheme.tableau().ends_at_last_stage {
            self.last_f
        } else {
            self.work.rhs += 1;
            self.field.f(&self.next)
        };
        self.work.jacobians += 1;
        let ahead = Linearisation::for_steps(self.field, &self.next, f);
        if let Some(ahead) = ahead {
            self.ahead = ahead;
        }
        ahead.is_some()
    }

    #[inline]
    fn advance(&mut self) {
        self.y = self.next;
        self.here = self.ahead;
    }
}

/// The continuous solution at the fraction theta of a step.
fn interpolate<const N: usize>(
    tableau: &Tableau,
    theta: f64,
    y0: &State<N>,
    y1: &State<N>,
    stages: &Stages<N, 1>,
) -> State<N> {
    let k = |l: usize| combination(State::zeros(), &tableau.d[l], tableau.stages, stages);
    let inner = k(0) + (k(1) + k(2) * theta) * theta;
    y0 * (1.0 - theta) + (y1 + inner * (1.0 - theta)) * theta
}
