//! One step of the state alone.

use super::control::error_norm;
use super::drive::Motion;
use super::factors::Factors;
use crate::field::{Jacobian, State, VectorField};
use crate::integrate::tableau::{MAX_STAGES, Tableau};
use crate::integrate::{Tolerances, Work};

/// A method as a type, so that every step is compiled for its coefficients.
pub(super) trait Scheme {
    const TABLEAU: Tableau;
}

/// f and J at one state.
#[derive(Debug, Clone, Copy)]
pub(super) struct Linearisation<const N: usize> {
    pub f: State<N>,
    pub jacobian: Jacobian<N>,
}

impl<const N: usize> Linearisation<N> {
    /// `None` if something is not finite.
    #[inline]
    pub fn new(field: &dyn VectorField<N>, y: &State<N>, f: State<N>) -> Option<Self> {
        let jacobian = field.jacobian(y);
        let finite = f.iter().chain(jacobian.iter()).all(|x| x.is_finite());
        finite.then_some(Linearisation { f, jacobian })
    }
}

/// The u_i of a step.
pub(super) type Stages<const N: usize> = [State<N>; MAX_STAGES];

/// sum_j weights_j u_j over the first `count`; zero weights are no work, and constant ones leave no test.
#[inline(always)]
pub(super) fn combination<const N: usize>(
    start: State<N>,
    weights: &[f64; MAX_STAGES],
    count: usize,
    u: &Stages<N>,
) -> State<N> {
    let mut sum = start;
    for j in 0..count {
        if weights[j] == 1.0 {
            sum += u[j];
        } else if weights[j] != 0.0 {
            sum += u[j] * weights[j];
        }
    }
    sum
}

/// What all stages of a step have in common.
pub(super) struct Setting<'a, const N: usize> {
    pub field: &'a dyn VectorField<N>,
    pub y: &'a State<N>,
    pub factors: &'a Factors<N>,
    pub per_h: f64,
}

impl<const N: usize> Setting<'_, N> {
    /// Stage I > 0; returns f at its argument.
    #[inline(always)]
    fn stage<S: Scheme, const I: usize>(&self, u: &mut Stages<N>) -> State<N> {
        let tableau = const { &S::TABLEAU };
        let at = combination(*self.y, &tableau.a[I], I, u);
        let f = self.field.f(&at);
        let coupling = combination(State::zeros(), &tableau.c[I], I, u);
        u[I] = self.factors.solve(&(f + coupling * self.per_h));
        f
    }

    /// All stages, from f(y); returns f at the last argument. Written out, so that all coefficients are constants.
    #[inline(always)]
    pub fn stages<S: Scheme>(&self, f: &State<N>, u: &mut Stages<N>) -> State<N> {
        u[0] = self.factors.solve(f);
        self.stage::<S, 1>(u);
        let mut last = self.stage::<S, 2>(u);
        if S::TABLEAU.stages > 3 {
            self.stage::<S, 3>(u);
            self.stage::<S, 4>(u);
            last = self.stage::<S, 5>(u);
        }
        if S::TABLEAU.stages > 6 {
            self.stage::<S, 6>(u);
            last = self.stage::<S, 7>(u);
        }
        last
    }
}

/// A state on its way.
pub(super) struct Trajectory<'a, S, const N: usize> {
    pub field: &'a dyn VectorField<N>,
    pub tolerances: Tolerances,
    pub work: &'a mut Work,
    pub y: State<N>,
    pub here: Linearisation<N>,
    /// The end of the tried step, its stages, f at the last of them, and what was looked up ahead.
    pub next: State<N>,
    pub stages: Stages<N>,
    pub last_f: State<N>,
    pub ahead: Linearisation<N>,
    pub scheme: std::marker::PhantomData<S>,
}

impl<S: Scheme, const N: usize> Motion<N> for Trajectory<'_, S, N> {
    const ERROR_ORDER: u32 = error_order(&S::TABLEAU);

    fn field(&self) -> &dyn VectorField<N> {
        self.field
    }

    fn work(&mut self) -> &mut Work {
        self.work
    }

    fn state(&self) -> &State<N> {
        &self.y
    }

    #[inline]
    fn attempt(&mut self, h: f64) -> Option<f64> {
        let tableau = const { &S::TABLEAU };
        self.work.factorisations += 1;
        let factors = Factors::shifted(1.0 / (h * tableau.gamma), &self.here.jacobian)?;
        self.work.rhs += tableau.stages - 1;
        let setting = Setting {
            field: self.field,
            y: &self.y,
            factors: &factors,
            per_h: 1.0 / h,
        };
        self.last_f = setting.stages::<S>(&self.here.f, &mut self.stages);
        self.next = combination(self.y, &tableau.m, tableau.stages, &self.stages);
        let error = combination(State::zeros(), &tableau.e, tableau.stages, &self.stages);
        error_norm(self.tolerances, &error, &self.y, &self.next)
    }

    #[inline]
    fn look_ahead(&mut self) -> bool {
        let f = if S::TABLEAU.ends_at_last_stage {
            self.last_f
        } else {
            self.work.rhs += 1;
            self.field.f(&self.next)
        };
        self.work.jacobians += 1;
        let ahead = Linearisation::new(self.field, &self.next, f);
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

/// The error estimate is the difference of the two solutions: it is of the order of the lower one, plus one.
pub(super) const fn error_order(tableau: &Tableau) -> u32 {
    if tableau.order < tableau.embedded_order {
        tableau.order + 1
    } else {
        tableau.embedded_order + 1
    }
}

/// The continuous solution at the fraction theta of a step.
pub(super) fn interpolate<const N: usize>(
    tableau: &Tableau,
    theta: f64,
    y0: &State<N>,
    y1: &State<N>,
    stages: &Stages<N>,
) -> State<N> {
    let k = |l: usize| combination(State::zeros(), &tableau.d[l], tableau.stages, stages);
    let inner = k(0) + (k(1) + k(2) * theta) * theta;
    y0 * (1.0 - theta) + (y1 + inner * (1.0 - theta)) * theta
}
