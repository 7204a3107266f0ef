//! New nodes for an orbit that is followed, where the old ones have come to lie badly, and the direction of the continuation there.

use super::continuation_point::{ContinuationPoint, TangentVector};
use super::correct::Regular;
use super::linear::Linear;
use super::orbit_curve::{DirectedPoint, OrbitCurve, product};
use super::shooting_nodes::ShootingNodes;
use super::spread::Spread;
use crate::continuation::Stop;
use crate::field::Vector;

/// ln of what an arc of a new mesh may grow by, and one of an old mesh.
const GROWTH: f64 = 5.0;
const GROWN: f64 = 7.0;
/// What two displacements that are the same may differ by, in parts of themselves.
const AGREED: f64 = 0.25;
/// A product of two slopes of the parameters that is no rounding.
const SLOPES: f64 = 1e-12;
/// Nodes whose displacement is less than this part of that of the parameters, both squared, stay where they are but for rounding.
const STILL: f64 = 1e-6;
/// How often arcs are split for it.
const SPLITS: usize = 6;

impl OrbitCurve<'_, '_> {
    /// Whether the nodes had better be spread anew, or an arc grows by too much.
    pub(super) fn is_uneven(&self, orbit: &Regular) -> bool {
        let linear = &orbit.linear;
        let field = self.corrector.family.field(orbit.site.at);
        let volumes = linear.logs.iter().map(|logs| logs.volume);
        linear.growth().any(|growth| growth > GROWN)
            || orbit
                .site
                .shooting
                .is_uneven(&field, self.spread(), volumes)
    }

    fn spread(&self) -> Spread {
        match self.settings.test_function {
            None => Spread::BRANCH,
            Some(_) => Spread::CURVE,
        }
    }

    /// The orbit with its arcs cut anew.
    pub(super) fn cut(
        &mut self,
        DirectedPoint { here, direction }: &DirectedPoint,
    ) -> Option<DirectedPoint> {
        let old = &here.site;
        let field = self.corrector.family.field(old.at);
        let spread = self.spread();
        let (shooting, begin) = old
            .shooting
            .spread(&mut self.corrector.tracer, &field, spread)
            .ok()?;
        let mut site = ContinuationPoint {
            shooting,
            at: old.at,
        };
        let mut linear = self.corrector.linear(&site)?;
        for _ in 0..SPLITS {
            if linear.growth().all(|growth| growth < GROWTH) {
                break;
            }
            let parts = linear.parts(GROWTH);
            let tracer = &mut self.corrector.tracer;
            site.shooting = site.shooting.split(tracer, &field, &parts).ok()?;
            linear = self.corrector.linear(&site)?;
        }
        drop(field);
        let (node, moved) = self.carried(old, direction, (&site.shooting, begin), &linear)?;
        let scale = self.corrector.family.scale(site.at);
        let (_, along) = linear.solutions(&self.settings.free, scale)?;
        let first = most_moved(&along);
        let count = site.shooting.nodes.len();
        site.shooting = site.shooting.beginning_at(first);
        let node = (node + count - first) % count;
        let parameters = direction.parameters;
        self.arrived(site, linear.beginning_at(first), |_, new| {
            // The same direction moves the orbit and the parameters in the same way, whatever the nodes. Along a canard the parameters are
            // rounding, as on a vertical branch; and what the flow says may be rounding.
            let (of_flow, new_moved) = (moved.dot(&new.nodes[node]), &new.nodes[node]);
            let off = (&moved - new_moved * of_flow.signum()).norm();
            let of_parameters = product(&parameters, &new.parameters);
            let agreed = off < AGREED * moved.norm().max(new_moved.norm());
            let moves = moved.norm_squared() > STILL * of_parameters.abs();
            if (agreed && moves) || of_parameters.abs() < SLOPES {
                of_flow
            } else {
                of_parameters
            }
        })
    }

    /// What a direction displaces the next one of new nodes by after the node that it displaces most, across the flow; and which that is.
    /// The first of the new nodes is so long after the first of the old ones.
    fn carried(
        &mut self,
        old: &ContinuationPoint,
        direction: &TangentVector,
        (new, begin): (&ShootingNodes, f64),
        linear: &Linear,
    ) -> Option<(usize, Vector)> {
        let most = most_moved(std::slice::from_ref(direction));
        let (period, durations) = (new.period(), &old.shooting.durations);
        let time = durations[..most].iter().sum::<f64>() - begin;
        let mut later = Vec::with_capacity(new.nodes.len());
        let mut at = 0.0;
        for duration in &new.durations {
            // From the old node on, once around.
            later.push(((at - time) / period).rem_euclid(1.0) * period);
            at += duration;
        }
        let next = (0..later.len()).min_by(|&a, &b| later[a].abs().total_cmp(&later[b].abs()))?;
        let family = self.corrector.family;
        let field = family.field(old.at);
        let mut moved = direction.nodes[most].clone();
        if later[next] != 0.0 {
            let free = family.plane();
            let mut arcs = self.corrector.tracer.arcs(&field, &free).ok()?;
            let arc = arcs.arc(&old.shooting.nodes[most], later[next]).ok()?;
            moved = &arc.tangent * moved;
            let scale = family.scale(old.at);
            if arc.parameters.ncols() == scale.len() {
                for (i, (scale, change)) in scale.iter().zip(direction.parameters).enumerate() {
                    moved.axpy(scale * change, &arc.parameters.column(i), 1.0);
                }
            }
        }
        let node = &new.nodes[next];
        let flow = field.f(node);
        let normal = linear.normal(next);
        let along = normal.dot(&moved) / normal.dot(&flow);
        moved.axpy(-along, &flow, 1.0);
        Some((next, moved))
    }

    /// At an orbit that has other nodes than those before, going on in the direction whose product with the one so far is positive.
    pub(super) fn arrived(
        &mut self,
        site: ContinuationPoint,
        linear: Linear,
        with_old: impl FnOnce(&ContinuationPoint, &TangentVector) -> f64,
    ) -> Option<DirectedPoint> {
        let own = self.settings.own();
        let here = self
            .corrector
            .look_with(site, linear, &self.settings.free, &own)?;
        let any = here.along.first()?.clone();
        let mut direction = self.settings.direction(&here, &any)?;
        if with_old(&here.site, &direction) < 0.0 {
            direction = direction.scaled(-1.0);
        }
        Some(DirectedPoint { here, direction })
    }
}

/// The node that the tangent vectors left to the orbit move most. All others are found from the first one: from the small end of a
/// tangent vector that grows by many decades nothing is found.
fn most_moved(along: &[TangentVector]) -> usize {
    let moved = |k: usize| -> f64 {
        let each = along.iter().map(|tangent| tangent.nodes[k].norm_squared());
        each.sum()
    };
    let count = along.first().map_or(0, |tangent| tangent.nodes.len());
    (0..count)
        .max_by(|&a, &b| moved(a).total_cmp(&moved(b)))
        .unwrap_or(0)
}

pub(super) fn no_nodes() -> Stop {
    Stop::Failed("the orbit can't be cut into arcs anew: the integration along it fails".into())
}
