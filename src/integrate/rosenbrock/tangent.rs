//! One step of the state together with its tangent flow Y' = J(y) Y.
//!
//! The Jacobian of the extended system is [[J, 0], [D2f[Y, .], J]]: block triangular, so every column of Y is solved with
//! the factors that the state needs anyway, and the coupling goes to the right-hand side,
//!
//!   (I/(h gamma) - J) V_i = J(y0 + sum_j a_ij u_j) (Y + sum_j a_ij V_j) + D2f(y0)[Y, u_i] + (1/h) sum_j c_ij V_j.
//!
//! That is the method applied to the extended system, exactly: the tangent has the method's order. Every entry of Y is in
//! the error test; scaled by columns or by the whole matrix the work at equal error was the same.
//!
//! In few dimensions all of D2f is made once in a step. In many that is more work than D2f[., u_i] at every stage, and more than the stack holds.

use super::control::{MayErr, error_norm};
use super::drive::Steppable;
use super::factors::{Factors, SMALL};
use super::stages::{Linearisation, Scheme, Staged, Stages, combination, error_order};
use crate::error::Error;
use crate::field::{Jacobian, State, VectorField};
use crate::integrate::tableau::{MAX_STAGES, Tableau};
use crate::integrate::{Tolerances, Work, step_underflow};

/// f, J, and D2f(y)[e_b, .] for every b at one state, as far as there is room for it: for all b or none.
#[derive(Debug, Clone, Copy)]
struct SecondDerivatives<const N: usize, const KEPT: usize> {
    linear: Linearisation<N>,
    quadratic: [Jacobian<N>; KEPT],
}

impl<const N: usize, const KEPT: usize> SecondDerivatives<N, KEPT> {
    /// `None` if something is not finite. All of D2f is evaluated once: it serves all stages and columns.
    #[inline]
    fn new(field: &dyn VectorField<N>, y: &State<N>, linear: Linearisation<N>) -> Option<Self> {
        let mut quadratic = [Jacobian::<N>::zeros(); KEPT];
        let mut finite = true;
        for a in 0..KEPT {
            for b in 0..=a {
                let d2 = field.second_derivative(y, &unit(a), &unit(b));
                finite &= d2.iter().all(|x| x.is_finite());
                quadratic[a].set_column(b, &d2);
                quadratic[b].set_column(a, &d2);
            }
        }
        finite.then_some(SecondDerivatives { linear, quadratic })
    }

    /// D2f(y)[u, .]
    #[inline]
    fn along(&self, field: &dyn VectorField<N>, y: &State<N>, u: &State<N>) -> Jacobian<N> {
        let mut sum = Jacobian::<N>::zeros();
        if KEPT < N {
            for b in 0..field.dimension() {
                sum.set_column(b, &field.second_derivative(y, u, &unit(b)));
            }
            return sum;
        }
        for b in 0..KEPT {
            sum += self.quadratic[b] * u[b];
        }
        sum
    }
}

fn unit<const N: usize>(i: usize) -> State<N> {
    let mut e = State::zeros();
    e[i] = 1.0;
    e
}

/// A step in the making.
struct TangentStepping<'a, const N: usize, const KEPT: usize> {
    field: &'a dyn VectorField<N>,
    y: &'a State<N>,
    tangent: &'a Jacobian<N>,
    here: &'a SecondDerivatives<N, KEPT>,
    factors: Factors<N>,
    per_h: f64,
    u: &'a mut Stages<N, 1>,
    v: &'a mut Stages<N, N>,
    /// f at the argument of the newest stage.
    newest: State<N>,
}

impl<const N: usize, const KEPT: usize> Staged for TangentStepping<'_, N, KEPT> {
    #[inline(always)]
    fn stage(&mut self, tableau: &Tableau, i: usize) {
        let (mut slope, rate) = if i == 0 {
            let linear = &self.here.linear;
            (linear.f, linear.jacobian * self.tangent)
        } else {
            let at = combination(*self.y, &tableau.a[i], i, self.u);
            let columns = combination(*self.tangent, &tableau.a[i], i, self.v);
            (self.field.f(&at), self.field.jacobian(&at) * columns)
        };
        self.newest = slope;
        slope += combination(State::zeros(), &tableau.c[i], i, self.u) * self.per_h;
        self.u[i] = self.factors.solve(&slope);
        let coupling = combination(Jacobian::zeros(), &tableau.c[i], i, self.v);
        let along = self.here.along(self.field, self.y, &self.u[i]);
        let right = rate + along * self.tangent + coupling * self.per_h;
        let columns = if N > SMALL { self.field.dimension() } else { N };
        for column in 0..columns {
            let solved = self.factors.solve(&right.column(column).into_owned());
            self.v[i].set_column(column, &solved);
        }
    }
}

/// A state and its tangent on their way.
pub(super) struct Bundle<'a, S, const N: usize, const KEPT: usize> {
    field: &'a dyn VectorField<N>,
    tolerances: Tolerances,
    may_err: MayErr<N>,
    work: &'a mut Work,
    y: State<N>,
    tangent: Jacobian<N>,
    here: SecondDerivatives<N, KEPT>,
    /// The end of the tried step, its stages, f at the last of them, and what was looked up ahead.
    next: (State<N>, Jacobian<N>),
    u: Stages<N, 1>,
    v: &'a mut Stages<N, N>,
    last_f: State<N>,
    ahead: SecondDerivatives<N, KEPT>,
    scheme: S,
}

impl<'a, S: Scheme, const N: usize, const KEPT: usize> Bundle<'a, S, N, KEPT> {
    /// At y with the identity, with room for the stages of the tangent; `None` if the second derivative is not finite there.
    pub fn new(
        (scheme, v): (S, &'a mut Stages<N, N>),
        field: &'a dyn VectorField<N>,
        tolerances: Tolerances,
        work: &'a mut Work,
        y: State<N>,
        here: Linearisation<N>,
    ) -> Option<Self> {
        let here = SecondDerivatives::new(field, &y, here)?;
        let tangent = Jacobian::identity();
        Some(Bundle {
            field,
            tolerances,
            may_err: MayErr::new(tolerances, field),
            work,
            y,
            tangent,
            here,
            next: (y, tangent),
            u: [State::zeros(); MAX_STAGES],
            v,
            last_f: here.linear.f,
            ahead: here,
            scheme,
        })
    }

    pub fn state_and_tangent(&self) -> (State<N>, Jacobian<N>) {
        (self.y, self.tangent)
    }
}

impl<S: Scheme, const N: usize, const KEPT: usize> Steppable for Bundle<'_, S, N, KEPT> {
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
        let count = tableau.stages;
        self.work.factorisations += 1;
        let factors = Factors::shifted(
            self.field.dimension(),
            1.0 / (h * tableau.gamma),
            &self.here.linear.jacobian,
        )?;
        self.work.rhs += count - 1;
        self.work.jacobians += count - 1;
        let mut stepping = TangentStepping {
            field: self.field,
            y: &self.y,
            tangent: &self.tangent,
            here: &self.here,
            factors,
            per_h: 1.0 / h,
            u: &mut self.u,
            v: self.v,
            newest: self.here.linear.f,
        };
        stepping.all_stages(self.scheme);
        self.last_f = stepping.newest;
        let next = combination(self.y, &tableau.m, count, &self.u);
        self.next = (
            self.field.timed(next, &self.y, clock),
            combination(self.tangent, &tableau.m, count, self.v),
        );
        let error = combination(State::zeros(), &tableau.e, count, &self.u);
        let mut norm = error_norm(self.may_err, &error, &self.y, &self.next.0)?;
        let errors = combination(Jacobian::zeros(), &tableau.e, count, self.v);
        let of_columns = MayErr::equally(self.tolerances);
        for column in 0..N {
            let of = |matrix: &Jacobian<N>| matrix.column(column).into_owned();
            let (error, y0, y1) = (of(&errors), of(&self.tangent), of(&self.next.1));
            norm = norm.max(error_norm(of_columns, &error, &y0, &y1)?);
        }
        Some(norm)
    }

    fn fastest(&self) -> (f64, f64) {
        let [here, ahead] = [&self.here, &self.ahead].map(|at| at.linear.jacobian.amax());
        (here, ahead)
    }

    #[inline]
    fn look_ahead(&mut self) -> bool {
        let y = &self.next.0;
        let f = if self.scheme.tableau().ends_at_last_stage {
            self.last_f
        } else {
            self.work.rhs += 1;
            self.field.f(y)
        };
        self.work.jacobians += 1;
        let ahead = Linearisation::new(self.field, y, f)
            .and_then(|linear| SecondDerivatives::new(self.field, y, linear));
        if let Some(ahead) = ahead {
            self.ahead = ahead;
        }
        ahead.is_some()
    }

    #[inline]
    fn advance(&mut self) {
        (self.y, self.tangent) = self.next;
        self.here = self.ahead;
    }
}
