//! Equilibria that a run comes to: near ones, and those that it spirals into so slowly that it would take too long to wait.

use crate::field::{Jacobian, State, VectorField};
use nalgebra::DMatrix;

/// Newton's method from a spiral ends at this step, or fails.
const CONVERGED: f64 = 1e-10;
const ITERATIONS: usize = 20;
/// What a spiral has shrunk by between two windows, in the logarithm, lies between these parts of what the slowest eigenvalue
/// says.
const AS_SAID: std::ops::Range<f64> = 0.6..1.6;
/// A spiral that shrinks by less than this shows nothing.
const LEAST: f64 = 0.02;

/// The equilibrium within `distance` of a state in every component, by a step of Newton's method, and whether it is stable.
pub(crate) fn equilibrium_near<const N: usize>(
    field: &dyn VectorField<N>,
    y: &State<N>,
    distance: f64,
) -> Option<(State<N>, bool)> {
    let step = newton_step(field, y)?;
    if !step.iter().all(|x| x.abs() < distance) {
        return None;
    }
    Some((y - step, growth(field, y) < 0.0))
}

/// The stable equilibrium that a run spirals into: it swung by the first of `swings` in one window of time and by the second in
/// the next, and that is how fast the slowest eigenvalue lets it.
pub(super) fn spirals_into<const N: usize>(
    field: &dyn VectorField<N>,
    y: &State<N>,
    swings: (f64, f64),
    window: f64,
) -> Option<State<N>> {
    let shrunk = (swings.0 / swings.1).ln();
    let mut at = *y;
    for _ in 0..ITERATIONS {
        let step = newton_step(field, &at)?;
        at -= step;
        if step.amax() < CONVERGED {
            let said = -growth(field, &at) * window;
            let agrees = shrunk > LEAST && AS_SAID.contains(&(shrunk / said));
            return agrees.then_some(at);
        }
    }
    None
}

/// How far Newton's method says that a state is from an equilibrium.
pub(crate) fn newton_step<const N: usize>(
    field: &dyn VectorField<N>,
    y: &State<N>,
) -> Option<State<N>> {
    let step = solve(field.jacobian(y), field.f(y))?;
    step.iter().all(|x| x.is_finite()).then_some(step)
}

/// The solution of A x = b by elimination with partial pivoting: runs ask for it so often that it shall not allocate.
fn solve<const N: usize>(mut a: Jacobian<N>, mut b: State<N>) -> Option<State<N>> {
    for k in 0..N {
        let pivot = (k..N).max_by(|&i, &j| a[(i, k)].abs().total_cmp(&a[(j, k)].abs()))?;
        if a[(pivot, k)] == 0.0 {
            return None;
        }
        a.swap_rows(k, pivot);
        b.swap_rows(k, pivot);
        for i in k + 1..N {
            let factor = a[(i, k)] / a[(k, k)];
            for j in k..N {
                a[(i, j)] -= factor * a[(k, j)];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..N).rev() {
        for j in k + 1..N {
            b[k] -= a[(k, j)] * b[j];
        }
        b[k] /= a[(k, k)];
    }
    Some(b)
}

/// The largest real part of the eigenvalues.
pub(crate) fn growth<const N: usize>(field: &dyn VectorField<N>, y: &State<N>) -> f64 {
    let jacobian = DMatrix::from_iterator(N, N, field.jacobian(y).iter().copied());
    let parts = jacobian.complex_eigenvalues().map(|z| z.re);
    parts.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}
