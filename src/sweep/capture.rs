//! Runs that a stable equilibrium has caught: states in its neighbourhood from which no run leaves.
//!
//! In the coordinates z = W^-1 x of the eigenvectors of J(x_0), x the distance from the equilibrium, each mode has
//! d|z_i|/dt <= -s_i |z_i| + H_ijk |z_j| |z_k| / 2, -s_i the real part of its eigenvalue and H_ijk a bound on the second derivative of
//! its rate along two modes. Where the last sum is less than s_i r_i for all i, no run leaves the box |z_i| <= r_i, nor any smaller
//! one of its shape: all runs in it end at the equilibrium. A run need not be followed there, where it creeps; and a slow mode is
//! held to its own rate, not to that of the fast ones.

use crate::field::{Jacobian, State, Vector, state, vector};
use crate::integrate::AnyField;
use crate::number::eigenvalues;
use crate::section::growth;
use nalgebra::{Complex, Matrix3, Vector3};

/// Distance, in every component, at which an equilibrium is looked for, and within which second derivatives are bounded.
const NEAR: f64 = 0.3;
/// At an equilibrium, for what rounding may hold there.
const AT_REST: f64 = 1e-5;
/// There are three; more are remembered for what Newton's method may invent.
const MOST: usize = 8;
/// Newton's method ends at this step, or fails.
const CONVERGED: f64 = 1e-11;
const ITERATIONS: usize = 12;
/// By how much a second derivative may be larger somewhere in the neighbourhood than at its corners.
const MARGIN: f64 = 1.5;
/// A box is widened so often, each time by this more than it must be.
const WIDENED: usize = 16;
const MORE: f64 = 1.1;

/// The equilibria that a run came near, and which of its states they hold.
#[derive(Debug, Default)]
pub(super) struct Capture {
    known: Vec<Neighbourhood>,
}

/// Where no run leaves an equilibrium.
#[derive(Debug)]
struct Neighbourhood {
    equilibrium: State<3>,
    /// `None` of an unstable equilibrium, and where eigenvectors coincide.
    modes: Option<Modes>,
    stable: bool,
}

/// The eigenvectors of an equilibrium, and what the field does along them.
#[derive(Debug)]
struct Modes {
    /// W, each column of modulus 1, and W^-1.
    vectors: Matrix3<Complex<f64>>,
    inverse: Matrix3<Complex<f64>>,
    /// s.
    decay: [f64; 3],
    /// H.
    curvature: [[[f64; 3]; 3]; 3],
}

impl Capture {
    /// The stable equilibrium that no run through y leaves, if y is so close to one.
    pub fn of(&mut self, field: &AnyField<'_>, y: &State<3>) -> Option<State<3>> {
        let close = |here: &&Neighbourhood| (y - here.equilibrium).amax() < NEAR;
        if let Some(here) = self.known.iter().find(close) {
            return here.around(y);
        }
        let step = newton_step(field, y)?;
        if step.amax() > NEAR || self.known.len() == MOST {
            return None;
        }
        let here = Neighbourhood::of(field, equilibrium(field, y - step)?);
        let captured = here.around(y);
        self.known.push(here);
        captured
    }

    /// Whether y is at an unstable equilibrium that it was found near before.
    pub fn rests_unstably(&self, y: &State<3>) -> bool {
        let at = |here: &Neighbourhood| (y - here.equilibrium).amax() < AT_REST;
        self.known.iter().any(|here| !here.stable && at(here))
    }
}

/// The step of Newton's method to an equilibrium.
fn newton_step(field: &AnyField<'_>, y: &State<3>) -> Option<State<3>> {
    let step = field.newton_step(y.as_slice())?;
    Some(state(step.as_slice()))
}

/// The equilibrium that Newton's method leads to.
fn equilibrium(field: &AnyField<'_>, near: State<3>) -> Option<State<3>> {
    let (mut at, mut before) = (near, f64::INFINITY);
    for _ in 0..ITERATIONS {
        let step = newton_step(field, &at)?;
        at -= step;
        let size = step.amax();
        // Rounding ends the convergence too.
        if size < CONVERGED || (size < CONVERGED.sqrt() && size >= before) {
            return Some(at);
        }
        before = size;
    }
    None
}

impl Neighbourhood {
    fn of(field: &AnyField<'_>, equilibrium: State<3>) -> Self {
        let stable = growth(field, equilibrium.as_slice()) < 0.0;
        let modes = stable.then(|| Modes::of(field, &equilibrium)).flatten();
        Neighbourhood {
            equilibrium,
            modes,
            stable,
        }
    }

    fn around(&self, y: &State<3>) -> Option<State<3>> {
        let modes = self.modes.as_ref()?;
        modes
            .hold(&(y - self.equilibrium))
            .then_some(self.equilibrium)
    }
}

impl Modes {
    fn of(field: &AnyField<'_>, equilibrium: &State<3>) -> Option<Self> {
        let jacobian = field.jacobian(&vector(equilibrium));
        let values = eigenvalues(&jacobian)?;
        let jacobian = Jacobian::<3>::from_column_slice(jacobian.as_slice());
        let vectors = Matrix3::from_columns(&[0, 1, 2].map(|i| eigenvector(&jacobian, values[i])));
        let inverse = vectors.try_inverse()?;
        let mut curvature = [[[0.0_f64; 3]; 3]; 3];
        for corner in 0..8 {
            let side = |i: usize| if corner >> i & 1 == 0 { NEAR } else { -NEAR };
            let here = vector(&(equilibrium + State::<3>::from_fn(|i, _| side(i))));
            let second = second_derivatives(field, &here);
            for j in 0..3 {
                for k in 0..3 {
                    let mut along = Vector3::<Complex<f64>>::zeros();
                    for a in 0..3 {
                        for b in 0..3 {
                            along += second[a][b] * (vectors[(a, j)] * vectors[(b, k)]);
                        }
                    }
                    let along = inverse * along;
                    for i in 0..3 {
                        let largest = &mut curvature[i][j][k];
                        *largest = largest.max(MARGIN * along[i].norm());
                    }
                }
            }
        }
        let known = curvature.iter().flatten().flatten().all(|h| h.is_finite());
        known.then_some(Modes {
            vectors,
            inverse,
            decay: [0, 1, 2].map(|i| -values[i].re),
            curvature,
        })
    }

    /// Whether no run from this distance leaves: whether there is a box around it.
    fn hold(&self, x: &State<3>) -> bool {
        let mut r = (self.inverse * complex(x)).map(|z| z.norm());
        for _ in 0..WIDENED {
            let reach = self.vectors.map(|w| w.norm()) * r;
            let inside = reach.amax() < NEAR;
            if !inside {
                return false;
            }
            let mut holds = true;
            for (i, curvature) in self.curvature.iter().enumerate() {
                let along = |j: usize| (0..3).map(|k| curvature[j][k] * r[k]).sum::<f64>();
                let least = 0.5 * (0..3).map(|j| r[j] * along(j)).sum::<f64>() / self.decay[i];
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

fn complex(x: &State<3>) -> Vector3<Complex<f64>> {
    x.map(|x| Complex::new(x, 0.0))
}

/// d2f/dy_a dy_b.
fn second_derivatives(field: &AnyField<'_>, y: &Vector) -> [[Vector3<Complex<f64>>; 3]; 3] {
    let axis = |i: usize| Vector::from_fn(3, |j, _| f64::from(u8::from(i == j)));
    let along = |a: usize, b: usize| {
        let second = field.second_derivative(y, &axis(a), &axis(b));
        complex(&state(second.as_slice()))
    };
    [0, 1, 2].map(|a| [0, 1, 2].map(|b| along(a, b)))
}

/// The eigenvector to an eigenvalue, of modulus 1: orthogonal to all rows of A - lambda, so along the largest of their products.
fn eigenvector(a: &Jacobian<3>, value: Complex<f64>) -> Vector3<Complex<f64>> {
    let shifted = a.map(|x| Complex::new(x, 0.0)) - Matrix3::from_diagonal_element(value);
    let row = |i: usize| shifted.row(i).transpose();
    let products = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| row(i).cross(&row(j)));
    let [first, second, third] = products;
    let larger = |a: Vector3<Complex<f64>>, b: Vector3<Complex<f64>>| {
        if b.norm_squared() > a.norm_squared() {
            b
        } else {
            a
        }
    };
    larger(larger(first, second), third).normalize()
}
