//! The stable equilibria that a run comes near, with neighbourhoods that no run leaves: it need not be followed there, where it converges slowly.
//!
//! For equations that are known over boxes these are balls of a Lyapunov function, certified by interval arithmetic. For others they are boxes in the
//! coordinates z = W^-1 x of the eigenvectors of J(x_0), x the distance from the equilibrium. Each mode has
//! d|z_i|/dt <= -s_i |z_i| + H_ijk |z_j| |z_k| / 2, -s_i the real part of its eigenvalue and H_ijk a bound on the second derivative of its rate
//! along two modes. Where the last sum is less than s_i r_i for all i, no run leaves the box |z_i| <= r_i, nor any smaller one of its shape. A slow
//! mode is held to its own rate, not to that of the fast ones.

use crate::equilibrium::{Enclosed, LyapunovBall};
use crate::field::Vector;
use crate::integrate::AnyField;
use crate::number::{eigenvalues, eigenvector};
use crate::section::growth;
use nalgebra::{Complex, DMatrix, DVector};

/// An equilibrium is looked for so near to a state: within what a run swings around, in units of 1 + |y|; of what moves in logarithms, in every
/// component, and there second derivatives are bounded so far.
const NEAR: f64 = 0.75;
const NEAR_IN_LOGARITHMS: f64 = 0.3;
/// At an equilibrium, for what rounding may hold there.
const AT_REST: f64 = 1e-5;
/// As many are remembered.
const MOST: usize = 8;
/// Newton's method ends at this step, in units of 1 + |y|, or fails.
const CONVERGED: f64 = 1e-11;
const ITERATIONS: usize = 12;
/// Two that are so near, in the same units, are the same.
const SAME: f64 = 1e-6;
/// By how much a second derivative may be larger somewhere in the neighbourhood than at its corners.
const MARGIN: f64 = 1.5;
/// A box is widened so often, each time by this more than it must be.
const WIDENED: usize = 16;
const MORE: f64 = 1.1;

/// The equilibria that were found.
#[derive(Debug, Default)]
pub(super) struct Attraction {
    known: Vec<Neighbourhood>,
}

/// Where no run leaves an equilibrium.
#[derive(Debug)]
struct Neighbourhood {
    equilibrium: Vector,
    stable: bool,
    held: Held,
}

/// The states that an equilibrium holds.
#[derive(Debug)]
enum Held {
    Ball(LyapunovBall),
    Box(Modes),
    /// None are known.
    None,
}

/// The eigenvectors of an equilibrium, and what the field does along them.
#[derive(Debug)]
struct Modes {
    /// W, each column of modulus 1, and W^-1.
    vectors: DMatrix<Complex<f64>>,
    inverse: DMatrix<Complex<f64>>,
    /// s.
    decay: Vec<f64>,
    /// H, for each i a matrix.
    curvature: Vec<DMatrix<f64>>,
}

impl Attraction {
    /// The stable equilibrium at which the run through y ends; `equations` are those over boxes, where they are known.
    pub fn of(
        &mut self,
        field: &AnyField<'_>,
        equations: Option<&dyn Enclosed>,
        y: &[f64],
    ) -> Option<Vector> {
        let size = 1.0 + y.iter().fold(0.0_f64, |size, y| size.max(y.abs()));
        let distance = match equations {
            Some(_) => NEAR * size,
            None => NEAR_IN_LOGARITHMS,
        };
        let near = |here: &&Neighbourhood| here.is_within(y, distance);
        if let Some(here) = self.known.iter().find(near) {
            return here.holds(y);
        }
        if self.known.len() == MOST {
            return None;
        }
        let state = Vector::from_column_slice(y);
        let at = equilibrium(field, &state, distance)?;
        let same = |here: &Neighbourhood| (&here.equilibrium - &at).amax() < SAME * size;
        if self.known.iter().any(same) {
            return None;
        }
        let here = Neighbourhood::of(field, equations, at);
        let held = here.holds(y);
        self.known.push(here);
        held
    }

    /// Whether y is at an unstable equilibrium that it was found near before.
    pub fn rests_unstably(&self, y: &[f64]) -> bool {
        let at = |here: &Neighbourhood| !here.stable && here.is_within(y, AT_REST);
        self.known.iter().any(at)
    }
}

/// The equilibrium that Newton's method leads to from a state without leaving its surroundings.
fn equilibrium(field: &AnyField<'_>, state: &Vector, distance: f64) -> Option<Vector> {
    let (mut at, mut before) = (state.clone(), f64::INFINITY);
    for _ in 0..ITERATIONS {
        let step = field.newton_step(at.as_slice())?;
        at -= &step;
        if (&at - state).amax() > distance {
            return None;
        }
        let size = step.amax() / (1.0 + at.amax());
        // Rounding ends the convergence too.
        if size < CONVERGED || (size < CONVERGED.sqrt() && size >= before) {
            return Some(at);
        }
        before = size;
    }
    None
}

impl Neighbourhood {
    fn of(field: &AnyField<'_>, equations: Option<&dyn Enclosed>, equilibrium: Vector) -> Self {
        let stable = growth(field, equilibrium.as_slice()) < 0.0;
        let held = match equations {
            _ if !stable => None,
            Some(equations) => LyapunovBall::around(equations, &equilibrium).map(Held::Ball),
            None => Modes::of(field, &equilibrium).map(Held::Box),
        };
        Neighbourhood {
            equilibrium,
            stable,
            held: held.unwrap_or(Held::None),
        }
    }

    /// Whether a state is so near in all components.
    fn is_within(&self, y: &[f64], distance: f64) -> bool {
        let mut all = y.iter().zip(self.equilibrium.iter());
        all.all(|(y, at)| (y - at).abs() < distance)
    }

    /// The equilibrium, if the run through a state ends there.
    fn holds(&self, y: &[f64]) -> Option<Vector> {
        let holds = match &self.held {
            Held::Ball(ball) => ball.holds(y),
            Held::Box(modes) => {
                let from = Vector::from_column_slice(y) - &self.equilibrium;
                modes.hold(&from)
            }
            Held::None => false,
        };
        holds.then(|| self.equilibrium.clone())
    }
}

impl Modes {
    fn of(field: &AnyField<'_>, equilibrium: &Vector) -> Option<Self> {
        let n = equilibrium.len();
        let jacobian = field.jacobian(equilibrium);
        let values = eigenvalues(&jacobian)?;
        let vectors = values.iter().map(|&value| eigenvector(&jacobian, value));
        let vectors = DMatrix::from_columns(&vectors.collect::<Option<Vec<_>>>()?);
        let inverse = vectors.clone().try_inverse()?;
        let mut curvature = vec![DMatrix::<f64>::zeros(n, n); n];
        for corner in 0..1_usize << n {
            let side = |i: usize| match corner >> i & 1 {
                0 => NEAR_IN_LOGARITHMS,
                _ => -NEAR_IN_LOGARITHMS,
            };
            let here = equilibrium + Vector::from_fn(n, |i, _| side(i));
            let second = second_derivatives(field, &here);
            for j in 0..n {
                for k in 0..n {
                    let mut along = DVector::<Complex<f64>>::zeros(n);
                    for a in 0..n {
                        for b in 0..n {
                            let part = vectors[(a, j)] * vectors[(b, k)];
                            along += second[a * n + b].map(|x| part * x);
                        }
                    }
                    let along = &inverse * along;
                    for (largest, along) in curvature.iter_mut().zip(along.iter()) {
                        largest[(j, k)] = largest[(j, k)].max(MARGIN * along.norm());
                    }
                }
            }
        }
        let known = curvature.iter().flatten().all(|h| h.is_finite());
        known.then_some(Modes {
            vectors,
            inverse,
            decay: values.iter().map(|value| -value.re).collect(),
            curvature,
        })
    }

    /// Whether no run from this distance leaves: whether there is a box around it.
    fn hold(&self, x: &Vector) -> bool {
        let mut r = (&self.inverse * x.map(|x| Complex::new(x, 0.0))).map(|z| z.norm());
        for _ in 0..WIDENED {
            let reach = self.vectors.map(|w| w.norm()) * &r;
            if reach.amax() >= NEAR_IN_LOGARITHMS || reach.iter().any(|x| x.is_nan()) {
                return false;
            }
            let mut holds = true;
            for (i, curvature) in self.curvature.iter().enumerate() {
                let least = 0.5 * r.dot(&(curvature * &r)) / self.decay[i];
                if least >= r[i] {
                    r[i] = MORE * least;
                    holds = false;
                }
            }
            if holds {
                return true;
            }
        }
        false
    }
}

/// d2f/dy_a dy_b, row by row.
fn second_derivatives(field: &AnyField<'_>, y: &Vector) -> Vec<Vector> {
    let n = y.len();
    let mut all = vec![Vector::zeros(n); n * n];
    for second in field.second_derivatives(y) {
        for (i, j) in second.orders() {
            all[i * n + j][second.of] = second.value;
        }
    }
    all
}
