//! Arcs that end where the flow comes to the plane of the next node, whatever time that takes.
//!
//! Along a slow motion before a fast one the time to go is known to less than the fast motion takes: an arc of a given duration would end
//! anywhere along it.

use super::arc::Tracer;
use super::shooting_nodes::ShootingNodes;
use super::spread::extents;
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::{AnyField, AnyStep, Control};

/// A plane through a node, with its normal along the flow, and how far each variable moves along the orbit.
struct Target<'a> {
    node: Vector,
    normal: Vector,
    extents: &'a Vector,
    period: f64,
    /// The steps that the arc took before by the same method.
    steps: Option<usize>,
}

/// An arc comes to a plane within so many times what it took before; and as near to the node, in parts of the extents.
const LATE: f64 = 8.0;
const NEAR: f64 = 0.3;
/// A flow that takes so many times the steps that the arc took before, or else until it was expected, and so many more, has left the orbit for good.
const MORE: (usize, usize) = (10, 1000);

/// What becomes of the flow from a node.
enum Arrival {
    /// It comes to the plane after this time.
    After(f64),
    /// It does not, but stays where the orbit is.
    Astray,
    /// It takes too many steps.
    Lost,
}

impl Target<'_> {
    fn beyond(&self, x: &[f64]) -> f64 {
        let each = x.iter().zip(&self.node).zip(&self.normal);
        each.map(|((x, node), normal)| (x - node) * normal).sum()
    }

    fn away(&self, x: &Vector) -> f64 {
        (x - &self.node).component_div(self.extents).amax()
    }

    /// The time from `start` to the plane, crossed with the flow: of several the one nearest to `expected`.
    fn time_from(
        &self,
        tracer: &mut Tracer,
        field: &AnyField<'_>,
        start: &Vector,
        expected: f64,
    ) -> Result<Arrival> {
        let (mut lost, mut steps, mut expected_steps) = (false, 0, 0);
        let mut found: Option<f64> = None;
        let off = |time: f64| (time / expected).ln().abs();
        let mut observer = |step: &AnyStep<'_>| {
            if found
                .is_some_and(|found| off(found) < off(step.t0) && step.t0.abs() > expected.abs())
            {
                return Ok(Control::Stop);
            }
            steps += 1;
            if step.t0.abs() < expected.abs() {
                expected_steps = steps;
            }
            lost = steps > MORE.0 * self.steps.unwrap_or(expected_steps) + MORE.1;
            if lost {
                return Ok(Control::Stop);
            }
            let ends = [self.beyond(step.y0), self.beyond(step.y1)];
            if !(ends[0] < 0.0 && ends[1] >= 0.0) {
                return Ok(Control::Continue);
            }
            let after = zero((0.0, ends[0]), (step.length, ends[1]), |time| {
                self.beyond(step.after(time).as_slice())
            });
            let at = (step.begin + after).hi();
            if self.away(&step.after(after)) < NEAR
                && found.is_none_or(|found| off(at) < off(found))
            {
                found = Some(at);
            }
            Ok(match found {
                Some(found) if found.abs() >= expected.abs() => Control::Stop,
                _ => Control::Continue,
            })
        };
        let latest = (LATE * expected.abs()).min(expected.abs() + 0.5 * self.period);
        tracer.flow(field, start, latest.copysign(expected), Some(&mut observer))?;
        Ok(match found {
            Some(time) => Arrival::After(time),
            None if lost => Arrival::Lost,
            None => Arrival::Astray,
        })
    }
}

/// A zero between two values of opposite signs: by the secant with the Illinois rule.
fn zero(mut a: (f64, f64), mut b: (f64, f64), f: impl Fn(f64) -> f64) -> f64 {
    const ITERATIONS: usize = 60;
    for _ in 0..ITERATIONS {
        let t = b.0 - b.1 * (b.0 - a.0) / (b.1 - a.1);
        if t == a.0 || t == b.0 || !t.is_finite() {
            break;
        }
        let value = f(t);
        if value * b.1 <= 0.0 {
            a = b;
        } else {
            a.1 *= 0.5;
        }
        b = (t, value);
        if value == 0.0 {
            break;
        }
    }
    b.0
}

impl ShootingNodes {
    /// The same nodes with the times that the flow takes from each to the plane of the next, where it comes there, on the arcs for which
    /// `uncertain` says so; `None` where it leaves the orbit for good. By index, `normals` of the planes and `steps` that the arcs took before.
    ///
    /// # Errors
    /// Those of the flow.
    pub(super) fn arriving(
        mut self,
        tracer: &mut Tracer,
        field: &AnyField<'_>,
        normals: impl Fn(usize) -> Vector,
        steps: impl Fn(usize) -> Option<usize>,
        uncertain: impl Fn(usize) -> bool,
    ) -> Result<Option<Self>> {
        let (extents, period) = (extents(self.nodes.iter()), self.period().abs());
        let count = self.nodes.len();
        for k in (0..count).filter(|&k| uncertain(k)) {
            let next = (k + 1) % count;
            let target = Target {
                node: field.landing(&self.nodes[next], (&self.nodes[k], self.durations[k])),
                normal: normals(next),
                extents: &extents,
                period,
                steps: steps(k),
            };
            match target.time_from(tracer, field, &self.nodes[k], self.durations[k])? {
                Arrival::After(time) => self.durations[k] = time,
                Arrival::Astray => {}
                Arrival::Lost => return Ok(None),
            }
        }
        Ok(Some(self))
    }
}
