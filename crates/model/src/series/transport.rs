//! Taylor maps of a flow to third order: solutions whose state is a polynomial in two variations of the start, and their maps onto
//! planes.
//!
//! Composed, such maps give the return map of a periodic orbit with all its derivatives to the third, of which the normal
//! forms of its bifurcations are made.

use super::Solution;
use super::cubic::Jet3;

/// A solution with its third-order dependence on two variations of its start. [`Solution::start`] gives the start without
/// them.
///
/// A step may err by `atol + rtol |x_i|` in x_i, and in every coefficient by `rtol` of the largest of that kind, each counted in
/// units of 1 + |x_i|.
pub trait TaylorMap<const N: usize>: Solution<N> {
    /// The state reached.
    fn polynomials(&self) -> [Jet3; N];

    /// The state at a time after the beginning of the last step, and its time derivative. By the series of that step: the
    /// time must be within it, or beyond it by a part of it.
    fn after(&self, time: Jet3) -> [[Jet3; N]; 2];

    /// The passage of the plane normal . (x - point) = 0 near a time after the beginning of the last step: that time, and the
    /// state there. `None` if the solution does not pass it there, transversally and for all variations.
    fn onto_plane(
        &self,
        (normal, point): (&[f64; N], &[f64; N]),
        near: f64,
    ) -> Option<(Jet3, [Jet3; N])> {
        /// Newton steps: the number of digits doubles with each, and then the degree with each.
        const STEPS: usize = 8;
        /// Distance, in units of 1 + |x|, at which the solution is on the plane.
        const ON_PLANE: f64 = 1e-12;
        let mut time = Jet3::constant(near);
        for _ in 0..STEPS {
            let [state, rates] = self.after(time);
            let (mut distance, mut speed) = (Jet3::default(), Jet3::default());
            for i in 0..N {
                let apart = state[i] - Jet3::constant(point[i]);
                distance = distance + apart.scaled(normal[i]);
                speed = speed + rates[i].scaled(normal[i]);
            }
            time = time - distance / speed;
        }
        let [state, _] = self.after(time);
        let (mut distance, mut size) = (0.0, 0.0);
        for i in 0..N {
            distance += (state[i].value() - point[i]) * normal[i];
            size += (1.0 + point[i].abs()) * normal[i].abs();
        }
        let there = distance.abs() <= ON_PLANE * size;
        let finite = time.0.iter().all(|c| c.is_finite());
        (there && finite).then_some((time, state))
    }
}
