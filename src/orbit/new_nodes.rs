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
/// The cosine between two displacements that are the same, and by how much one may be longer.
const AGREED: f64 = 0.95;
const LONGER: f64 = 3.0;
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
        let spread = match self.settings.condition {
            None => Spread::BRANCH,
            Some(_) => Spread::CURVE,
        };
        spread.beside_jumps(self.corrector.family.is_any_system())
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
        let mut linear = self.corrector.linear(&site, &self.settings.free)?;
        for _ in 0..SPLITS {
            if linear.growth().all(|growth| growth < GROWTH) {
                break;
            }
            let parts = linear.parts(GROWTH);
            let tracer = &mut self.corrector.tracer;
            site.shooting = site.shooting.split(tracer, &field, &parts).ok()?;
            linear = self.corrector.linear(&site, &self.settings.free)?;
        }
        drop(field);
        let scale = self.corrector.family.scale(site.at);
        let (_, along) = linear.solutions(&self.settings.free, scale)?;
        let there = (&site.shooting, &along[..], begin);
        let (node, moved) = self.carried(old, direction, there, &linear)?;
        let first = most_moved(&along);
        let count = site.shooting.nodes.len();
        site.shooting = site.shooting.beginning_at(first);
        let node = (node + count - first) % count;
        let parameters = direction.parameters;
        self.arrived(site, linear.beginning_at(first), |_, new| {
            // The same direction moves the orbit and the parameters in the same way, whatever the nodes. Along a canard the parameters are
            // rounding, as on a vertical branch; and what the flow says may be rounding.
            let (of_flow, new_moved) = (moved.dot(&new.nodes[node]), &new.nodes[node]);
            let of_parameters = product(&parameters, &new.parameters);
            // Their lengths are those of directions over other nodes.
            let lengths = moved.norm() * new_moved.norm();
            let alike = (moved.norm() / new_moved.norm()).ln().abs() < LONGER.ln();
            let agreed = alike && of_flow.abs() > AGREED * lengths;
            let moves = moved.norm_squared() > STILL * of_parameters.abs();
            if (agreed && moves) || of_parameters.abs() < SLOPES {
                of_flow
            } else {
                of_parameters
            }
        })
    }

    /// What a direction displaces a new node by, across the flow, and which that is: the one next after an old node where both are displaced
    /// most. What contracts by more than all digits between them would say nothing. The first of the new nodes is so long after the first of the
    /// old ones.
    fn carried(
        &mut self,
        old: &ContinuationPoint,
        direction: &TangentVector,
        (new, along, begin): (&ShootingNodes, &[TangentVector], f64),
        linear: &Linear,
    ) -> Option<(usize, Vector)> {
        let period = new.period();
        let begins = |durations: &[f64], first: f64| -> Vec<f64> {
            let sums = durations.iter().scan(first, |at, duration| {
                *at += duration;
                Some(*at)
            });
            std::iter::once(first)
                .chain(sums)
                .take(durations.len())
                .collect()
        };
        let (olds, news) = (
            begins(&old.shooting.durations, 0.0),
            begins(&new.durations, begin),
        );
        // The new node after each old one, once around, and how much later.
        let after = olds.iter().map(|time| {
            let later = |at: &f64| ((at - time) / period).rem_euclid(1.0) * period;
            let nodes = news.iter().map(later).enumerate();
            nodes.min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        });
        let after = after.collect::<Option<Vec<_>>>()?;
        let seen = |&(k, (next, _)): &(usize, (usize, f64))| {
            direction.nodes[k].norm() * displacement(along, next).sqrt()
        };
        let pairs = after.into_iter().enumerate();
        let (most, (next, later)) = pairs.max_by(|a, b| seen(a).total_cmp(&seen(b)))?;
        let family = self.corrector.family;
        let field = family.field(old.at);
        let mut moved = direction.nodes[most].clone();
        if later != 0.0 {
            let (free, plane) = (&self.settings.free, family.plane());
            let places: Vec<usize> = free.iter().map(|&i| plane[i]).collect();
            let mut arcs = self.corrector.tracer.arcs(&field, &places).ok()?;
            let arc = arcs.arc(&old.shooting.nodes[most], later).ok()?;
            moved = &arc.tangent * moved;
            let scale = family.scale(old.at);
            // None where the method makes none.
            for (&i, column) in free.iter().zip(arc.parameters.column_iter()) {
                moved.axpy(scale[i] * direction.parameters[i], &column, 1.0);
            }
        }
        let node = &new.nodes[next];
        let flow = field.f(node);
        let normal = linear.normal(next);
        let of_flow = normal.dot(&moved) / normal.dot(&flow);
        moved.axpy(-of_flow, &flow, 1.0);
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
    let count = along.first().map_or(0, |tangent| tangent.nodes.len());
    let moved = |k: &usize| displacement(along, *k);
    (0..count)
        .max_by(|a, b| moved(a).total_cmp(&moved(b)))
        .unwrap_or(0)
}

/// The square of what these tangent vectors displace a node by.
fn displacement(along: &[TangentVector], node: usize) -> f64 {
    let each = along
        .iter()
        .map(|tangent| tangent.nodes[node].norm_squared());
    each.sum()
}

pub(super) fn no_nodes() -> Stop {
    Stop::Failed(
        "new shooting nodes cannot be placed: the integration along the orbit fails".into(),
    )
}
