//! How much the period may change in a step where the orbit gains turns about an equilibrium or about another periodic orbit.
//!
//! Beside a homoclinic orbit a branch winds: with every further turn about the saddle-focus, or about the periodic orbit, the parameter and the multipliers come
//! back to nearly the same values (Glendinning & Sparrow 1984, J. Stat. Phys. 35, 645; Gavrilov & Shilnikov 1972, Math. USSR Sbornik 17, 467). A step over
//! a whole turn has the same slopes at both of its ends, and the two folds between them would be lost.

use super::shooting_nodes::ShootingNodes;
use super::spread::extents;
use crate::field::Vector;
use crate::integrate::AnyField;
use crate::number::eigenvalues;
use std::f64::consts::FRAC_PI_2;

/// In the time of a radian an orbit that lingers moves by this part of its extents.
const LINGERS: f64 = 0.05;
/// The part of a turn that a step may add to an orbit.
const PART: f64 = 0.5;

/// The time of a quarter of a turn about the focus where the orbit is slowest, if it lingers there; `flows` are the rates at its nodes.
pub(super) fn quarter_turn(
    field: &AnyField<'_>,
    orbit: &ShootingNodes,
    flows: &[Vector],
) -> Option<f64> {
    let extents = extents(orbit.nodes.iter());
    let speed = |flow: &Vector| flow.component_div(&extents).amax();
    let nodes = orbit.nodes.iter().zip(flows.iter().map(speed));
    let (slowest, speed) = nodes.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let found = eigenvalues(&field.jacobian(slowest))?;
    let turns = found.iter().map(|z| z.im).fold(0.0, f64::max);
    (speed < LINGERS * turns).then(|| FRAC_PI_2 / turns)
}

/// The turns of an orbit: for each arc, the time between the maxima before and after it of the variable that has most of them.
pub(super) struct Turns(Vec<f64>);

impl Turns {
    /// By the signs of the rates at its nodes; `None` where no variable has more than one maximum.
    pub fn of(orbit: &ShootingNodes, flows: &[Vector]) -> Option<Self> {
        let nodes = flows.len();
        let maxima = |i: usize| {
            let falls = move |k: usize| flows[k % nodes][i] <= 0.0;
            (0..nodes).filter(move |&k| !falls(k) && falls(k + 1))
        };
        let liveliest = (0..orbit.dimension()).max_by_key(|&i| maxima(i).count())?;
        let places: Vec<usize> = maxima(liveliest).collect();
        if places.len() < 2 {
            return None;
        }
        let mut times = vec![0.0; nodes];
        let next = places.iter().cycle().skip(1);
        for (&from, &to) in places.iter().zip(next) {
            let to = if to > from { to } else { to + nodes };
            let arcs = || (from..to).map(|k| k % nodes);
            let time: f64 = arcs().map(|k| orbit.durations[k].abs()).sum();
            arcs().for_each(|k| times[k] = time);
        }
        Some(Turns(times))
    }

    /// Whether the orbit may have gained or lost a turn as the times between its nodes changed from `before` to `then`.
    pub fn may_be_more(&self, before: &[f64], then: &[f64]) -> bool {
        let times = before.iter().zip(then);
        let parts = times
            .zip(&self.0)
            .map(|((a, b), turn)| (b - a).abs() / turn);
        parts.sum::<f64>() > PART
    }
}
