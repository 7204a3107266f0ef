//! The homoclinic orbit beside a double zero, as its normal form predicts it.
//!
//! On the centre manifold x = x_0 + q_0 w_0 + q_1 w_1 + ... the equations are those of Bogdanov and Takens, w_0' = w_1, w_1' = beta_1 + beta_2 w_1 + a w_0^2 + b w_0 w_1.
//! In w_0 = eps^2 u/a, w_1 = eps^3 v/a, t = s/eps, beta_1 = -4 eps^4/a, beta_2 = b tau eps^2/a the orbit is u = 2 - 6/cosh(s)^2 with tau = 10/7 to first order (Al-Hdaibat,
//! Govaerts, Kuznetsov and Meijer 2016, SIAM J. Appl. Dyn. Syst. 15, 952-980).

use super::connection::Connection;
use crate::bifurcation::equilibria::centre_manifold::DoubleZero;
use crate::field::Vector;
use crate::integrate::AnyField;
use crate::orbit::ParametrisedField;

/// A double zero with what its normal form is made of.
pub(super) struct BogdanovTakens {
    state: Vector,
    at: [f64; 2],
    /// Of the critical plane.
    q: [Vector; 2],
    /// Of the quadratic terms.
    a: f64,
    b: f64,
    /// How the parameters go with beta_1, beta_2 and half of its square.
    by_first: [f64; 2],
    by_second: [f64; 2],
    by_square: [f64; 2],
    /// How the equilibrium moves with beta_1 and beta_2.
    moved: [Vector; 2],
}

/// f and its derivatives in both coordinates of a family.
struct InParameters<'f> {
    family: &'f dyn ParametrisedField,
    state: &'f Vector,
    at: [f64; 2],
}

impl InParameters<'_> {
    /// The first derivatives of f.
    fn slopes(&self, at: [f64; 2]) -> [Vector; 2] {
        let (field, scale) = (self.family.field(at), self.family.scale(at));
        let places = self.family.plane();
        [0, 1].map(|i| field.parameter_derivative(self.state, places[i]) * scale[i])
    }

    /// By a central difference: they are part of a guess.
    fn difference<T>(
        &self,
        along: [f64; 2],
        of: impl Fn([f64; 2]) -> T,
        apart: impl Fn(T, T) -> Vector,
    ) -> Vector {
        const APART: f64 = 1e-5;
        let size = along[0].hypot(along[1]);
        let step = APART / size;
        let beside = |sign: f64| of([0, 1].map(|i| self.at[i] + sign * step * along[i]));
        apart(beside(1.0), beside(-1.0)) / (2.0 * step)
    }

    /// How the Jacobian times a vector changes along a change of the coordinates.
    fn of_jacobian(&self, x: &Vector, along: [f64; 2]) -> Vector {
        let product = |at| self.family.field(at).jacobian(self.state) * x;
        self.difference(along, product, |a, b| a - b)
    }

    /// The second derivative of f along a change of the coordinates.
    fn second(&self, along: [f64; 2]) -> Vector {
        let slope = |at| {
            let [first, second] = self.slopes(at);
            first * along[0] + second * along[1]
        };
        self.difference(along, slope, |a, b| a - b)
    }
}

impl BogdanovTakens {
    /// At an equilibrium; `None` where its normal form is degenerate. The widths are units of both coordinates.
    pub fn of(
        family: &dyn ParametrisedField,
        state: &Vector,
        at: [f64; 2],
        widths: [f64; 2],
    ) -> Option<Self> {
        let field: AnyField<'_> = family.field(at);
        let jacobian = field.jacobian(state);
        let critical = DoubleZero::of(&jacobian, None)?;
        let ([q_0, q_1], [p_0, p_1]) = (&critical.q, &critical.p);
        let quadratic = |u: &Vector, v: &Vector| field.second_derivative(state, u, v);
        let of_q_0 = quadratic(q_0, q_0);
        let a = 0.5 * p_1.dot(&of_q_0);
        let b = p_1.dot(&quadratic(q_0, q_1)) + p_0.dot(&of_q_0);
        let parameters = InParameters { family, state, at };
        let slopes = parameters.slopes(at);
        let along = |k: [f64; 2]| &slopes[0] * k[0] + &slopes[1] * k[1];
        // Which coordinates change beta_1, and which leave it.
        let by = [0, 1].map(|i| p_1.dot(&slopes[i]) * widths[i]);
        let square = by[0] * by[0] + by[1] * by[1];
        let only_first = [0, 1].map(|i| by[i] / square * widths[i]);
        let neither = [-by[1] * widths[0], by[0] * widths[1]];
        // beta_2: with x = - A^{-1} J_1 k + delta q_0 the terms w_0 beta_2 vanish, and w_1 beta_2 has the coefficient 1.
        let aside = critical.inverse(&jacobian, &-along(neither))?;
        let of_terms = |u: &Vector| quadratic(u, &aside) + parameters.of_jacobian(u, neither);
        let (of_first, of_second) = (of_terms(q_0), of_terms(q_1));
        let vanish = [p_1.dot(&of_first), 2.0 * a];
        let one = [
            p_0.dot(&of_first) + p_1.dot(&of_second),
            p_0.dot(&of_q_0) + p_1.dot(&quadratic(q_0, q_1)),
        ];
        let determinant = vanish[0] * one[1] - vanish[1] * one[0];
        let (kappa, delta) = (-vanish[1] / determinant, vanish[0] / determinant);
        let by_second = neither.map(|k| k * kappa);
        let second = aside * kappa + q_0 * delta;
        // beta_2^2: the fold is bent.
        let bent = quadratic(&second, &second)
            + parameters.of_jacobian(&second, by_second) * 2.0
            + parameters.second(by_second);
        let by_square = only_first.map(|k| -k * p_1.dot(&bent));
        let first = critical.inverse(&jacobian, &(q_1 - along(only_first)))?;
        let all = [a, b, kappa, delta, by_square[0], by_square[1]];
        let known = all.iter().all(|x| x.is_finite()) && a != 0.0 && b != 0.0;
        known.then(|| BogdanovTakens {
            state: state.clone(),
            at,
            q: critical.q.clone(),
            a,
            b,
            by_first: only_first,
            by_second,
            by_square,
            moved: [first, second],
        })
    }

    /// The connection of which the largest variable goes through `size`.
    pub fn predicted(&self, size: f64) -> Connection {
        /// What u goes through.
        const WAY: f64 = 6.0;
        /// Nodes to each side of the middle, and the time between two.
        const EACH: i32 = 12;
        const APART: f64 = 0.25;
        const TAU: f64 = 10.0 / 7.0;
        let (a, b) = (self.a, self.b);
        let square = size * a.abs() / (WAY * self.q[0].amax());
        let eps = square.sqrt();
        let beta_1 = -4.0 / a * square * square;
        let beta_2 = b / a * square * TAU;
        let state = |u: f64, v: f64| {
            &self.state
                + &self.q[0] * (square / a * u)
                + &self.q[1] * (square * eps / a * v)
                + &self.moved[0] * beta_1
                + &self.moved[1] * beta_2
        };
        let node = |k: i32| {
            let s = APART * f64::from(k);
            let (sech, tanh) = (1.0 / s.cosh(), s.tanh());
            state(2.0 - WAY * sech * sech, 2.0 * WAY * sech * sech * tanh)
        };
        Connection {
            saddle: state(2.0, 0.0),
            nodes: (-EACH..=EACH).map(node).collect(),
            durations: vec![APART / eps; 2 * EACH as usize],
            at: [0, 1].map(|i| {
                self.at[i]
                    + self.by_first[i] * beta_1
                    + self.by_second[i] * beta_2
                    + 0.5 * self.by_square[i] * beta_2 * beta_2
            }),
        }
    }

    /// The coordinate along which the curve leaves, in units of these widths.
    pub fn along(&self, widths: [f64; 2]) -> usize {
        let part = |i: usize| (self.by_second[i] / widths[i]).abs();
        usize::from(part(1) > part(0))
    }
}
