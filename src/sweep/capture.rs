//! Runs that a stable equilibrium has caught: states in its neighbourhood from which no run leaves.
//!
//! With A = J(x_0) and A^T P + P A = -1, V = x^T P x of the distance x from the equilibrium changes by
//! dV/dt = -|x|^2 + 2 x^T P N(x), where the rest N of the field is at most C |x|^2 / 2, C a bound on its second derivative. So V
//! falls wherever |P| C |x| < 1, and a level set of V within that ball holds all runs that are in it (Lyapunov). A run need not be
//! followed into the equilibrium, where it creeps.

use crate::field::{Jacobian, State, Vector, state, vector};
use crate::integrate::AnyField;
use crate::section::growth;
use nalgebra::{SMatrix, SVector};

/// Distance, in every component, at which an equilibrium is looked for.
const NEAR: f64 = 0.3;
/// At an equilibrium, for what rounding may hold there.
const AT_REST: f64 = 1e-5;
/// There are three; more are remembered for what Newton's method may invent.
const MOST: usize = 8;
/// Newton's method ends at this step, or fails.
const CONVERGED: f64 = 1e-11;
const ITERATIONS: usize = 12;
/// By how much the second derivative may be larger in the neighbourhood than at the equilibrium.
const MARGIN: f64 = 2.0;

/// The equilibria that a run came near, and which of its states they hold.
#[derive(Debug, Default)]
pub(super) struct Capture {
    known: Vec<Neighbourhood>,
}

/// Where no run leaves an equilibrium.
#[derive(Debug)]
struct Neighbourhood {
    equilibrium: State<3>,
    /// P, and the largest V; `None` of an unstable equilibrium.
    holds: Option<(Jacobian<3>, f64)>,
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
        self.known
            .iter()
            .any(|here| here.holds.is_none() && at(here))
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
        let jacobian = field.jacobian(&vector(&equilibrium));
        let jacobian = Jacobian::<3>::from_column_slice(jacobian.as_slice());
        let matrix = lyapunov_matrix(&jacobian).filter(|_| stable);
        let holds = matrix.map(|p| {
            let sizes = p.symmetric_eigenvalues();
            let curvature = MARGIN * curvature(field, &equilibrium);
            (p, sizes.min() / (sizes.max() * curvature).powi(2))
        });
        Neighbourhood { equilibrium, holds }
    }

    fn around(&self, y: &State<3>) -> Option<State<3>> {
        let (p, level) = self.holds?;
        let x = y - self.equilibrium;
        (x.dot(&(p * x)) < level).then_some(self.equilibrium)
    }
}

/// A bound on |D2f(y)\[u, v\]| for |u| = |v| = 1.
fn curvature(field: &AnyField<'_>, y: &State<3>) -> f64 {
    let y = vector(y);
    let axis = |i: usize| Vector::from_fn(3, |j, _| f64::from(u8::from(i == j)));
    let mut squares = 0.0;
    for i in 0..3 {
        for j in 0..3 {
            squares += field
                .second_derivative(&y, &axis(i), &axis(j))
                .norm_squared();
        }
    }
    squares.sqrt()
}

/// P of A^T P + P A = -1; `None` where there is none.
fn lyapunov_matrix(a: &Jacobian<3>) -> Option<Jacobian<3>> {
    /// Where the entries of a symmetric matrix stand.
    const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
    let mut system = SMatrix::<f64, 6, 6>::zeros();
    for (column, (i, j)) in ENTRIES.into_iter().enumerate() {
        let mut unit = Jacobian::<3>::zeros();
        (unit[(i, j)], unit[(j, i)]) = (1.0, 1.0);
        let image = a.transpose() * unit + unit * a;
        for (row, entry) in ENTRIES.into_iter().enumerate() {
            system[(row, column)] = image[entry];
        }
    }
    let right = SVector::<f64, 6>::from_fn(|i, _| if i < 3 { -1.0 } else { 0.0 });
    let entries = system.lu().solve(&right)?;
    let mut p = Jacobian::<3>::zeros();
    for (k, (i, j)) in ENTRIES.into_iter().enumerate() {
        (p[(i, j)], p[(j, i)]) = (entries[k], entries[k]);
    }
    p.iter().all(|x| x.is_finite()).then_some(p)
}
