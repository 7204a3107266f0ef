//! Where the nodes of an orbit stand that is followed along a curve: spread over it by how far it goes, and away from its corners and its jumps.
//!
//! At a corner, where a fast motion begins or ends, the plane across the flow sees the neighbouring orbits under any angle: a small
//! displacement there is no small one of the orbit. The corner itself moves when the parameters change, and comes to a node next to it.

use super::arc::{Tracer, share};
use super::linear::{axes, frame};
use super::shooting_nodes::ShootingNodes;
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::integrate::{AnyField, AnyStep, Control};
use crate::number::eigenvalues;

/// The least and the largest number of nodes.
const NODES: (usize, usize) = (12, 256);
/// Where the steps are so long that fewer nodes have a place, arcs are split; and where fewer still have one, nodes are spread evenly in time.
const FEWEST: usize = 8;
const FEW: usize = 3;

/// How long arcs are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    /// How far an arc goes: by the variable that moves most, in parts of its extent, and in time, in parts of the period.
    way: f64,
    /// What ln |volume| changes by on an arc, from so many dimensions on.
    volume: (f64, usize),
    /// Whether jumps may be as fast as can be: nodes stand aside of them and of their corners, or are left out.
    jumps: bool,
}

impl Spread {
    /// Along a branch: few arcs, which take the least time. In three dimensions the trace of the Jacobian and one of the map tell both
    /// multipliers; in more the conditions are functions of the maps.
    pub const BRANCH: Spread = Spread {
        way: 0.25,
        volume: (4.0, 4),
        jumps: false,
    };
    /// Along a curve of bifurcations, whose condition is a function of the maps.
    pub const CURVE: Spread = Spread {
        way: 0.1,
        volume: (2.0, 2),
        jumps: false,
    };

    /// The same where jumps may be as fast as can be.
    pub fn beside_jumps(self, jumps: bool) -> Self {
        Spread { jumps, ..self }
    }

    /// In extents per period.
    fn fastest(&self) -> f64 {
        if self.jumps { FASTEST } else { f64::INFINITY }
    }

    /// How many arcs a piece is worth.
    fn arcs(&self, dimension: usize, way: f64, volume: f64) -> f64 {
        let (most, from) = self.volume;
        let of_volume = if dimension < from {
            0.0
        } else {
            volume * share(dimension) / most
        };
        way / self.way + of_volume
    }
}

/// ln of what a displacement may grow by on an arc. Where a displacement grows along a slow motion, what is off in the start is soon off it altogether.
const GROWTH: f64 = 4.0;
/// A curve that turns on less than this way has a corner.
const CORNER: f64 = 0.1;
/// In extents per period. Along faster motions rounding of the time is seen in the state: their way counts no more than at this speed.
const FASTEST: f64 = 1e6;
/// A node is left out rather than to stand so many times nearer to a corner, or where the motion is so many times faster.
const NO_PLACE: f64 = 10.0;
/// A variable that moves by less than this part of what the liveliest does, both in the units of the motion, may move by any factor more.
const STILL_BESIDE: f64 = 1e-4;
/// How far a node may stand from where it would by the measure alone, in parts of an arc.
const ASIDE: f64 = 0.45;

/// A step along the orbit.
struct TracedStep {
    begin: f64,
    length: f64,
    from: Vector,
    /// The integral of |trace|.
    volume: f64,
    /// What grows most along it, as a logarithm.
    growth: f64,
}

/// The units in which the way of an orbit is measured: how far each variable moves, and the period.
struct Extents {
    states: Vector,
    period: f64,
    /// In these units: the way along faster motions counts no more than at this speed.
    fastest: f64,
}

impl Extents {
    fn of<'a>(points: impl Iterator<Item = &'a Vector> + Clone, period: f64, fastest: f64) -> Self {
        Extents {
            states: extents(points),
            period: period.abs(),
            fastest,
        }
    }

    fn way(&self, from: &Vector, to: &Vector, length: f64) -> f64 {
        let time = length.abs() / self.period;
        self.moved(to - from).min(self.fastest * time) + time
    }

    /// By the variable that moves most, in parts of its extent.
    fn moved(&self, way: Vector) -> f64 {
        way.component_div(&self.states).amax()
    }

    /// In extents per period.
    fn speed(&self, field: &AnyField<'_>, x: &Vector) -> f64 {
        self.moved(field.f(x)) * self.period
    }

    /// The way on which the curve turns here: its radius of curvature, with time as one more coordinate.
    fn radius(&self, field: &AnyField<'_>, x: &Vector) -> f64 {
        let flow = field.f(x);
        let change = (field.jacobian(x) * &flow).component_div(&self.states);
        let flow = flow.component_div(&self.states);
        let speed = flow.norm_squared() + self.period.powi(-2);
        let along = flow.dot(&change) / speed;
        // What of the change is across; time itself does not change.
        let across = (change - &flow * along).norm_squared() + (along / self.period).powi(2);
        speed / across.sqrt()
    }

    fn radii(&self, field: &AnyField<'_>, steps: &[TracedStep]) -> Vec<f64> {
        let radius = |step: &TracedStep| self.radius(field, &step.from);
        steps.iter().map(radius).collect()
    }

    /// How far from a corner each of the steps begins: the least sum of the way to a place and the radius there.
    fn clearances(&self, field: &AnyField<'_>, steps: &[TracedStep]) -> Vec<f64> {
        let count = steps.len();
        let next = steps.iter().cycle().skip(1);
        let ways = steps.iter().zip(next).map(|(step, next)| {
            self.moved(&next.from - &step.from) + step.length.abs() / self.period
        });
        let ways: Vec<f64> = ways.collect();
        let mut all = self.radii(field, steps);
        // Once around and once more, in both senses.
        for k in 0..2 * count {
            let (here, next) = (k % count, (k + 1) % count);
            all[next] = all[next].min(all[here] + ways[here]);
        }
        for k in (0..2 * count).rev() {
            let (here, next) = (k % count, (k + 1) % count);
            all[here] = all[here].min(all[next] + ways[here]);
        }
        all
    }
}

impl ShootingNodes {
    /// The same orbit with its nodes spread anew, and the time from the first of the old ones to the first of the new.
    ///
    /// # Errors
    /// Those of the flow.
    pub(super) fn spread(
        &self,
        tracer: &mut Tracer,
        field: &AnyField<'_>,
        spread: Spread,
    ) -> Result<(Self, f64)> {
        let steps = self.traced(tracer, field, spread.jumps)?;
        let period = self.period();
        let extents = Extents::of(
            steps.iter().map(|step| &step.from),
            period,
            spread.fastest(),
        );
        let next = steps.iter().cycle().skip(1);
        let measures = steps.iter().zip(next).map(|(step, next)| {
            let way = extents.way(&step.from, &next.from, step.length);
            spread.arcs(self.dimension(), way, step.volume) + step.growth / GROWTH
        });
        let ends: Vec<f64> = measures
            .scan(0.0, |sum, measure| {
                *sum += measure;
                Some(*sum)
            })
            .collect();
        let all = ends.last().copied().unwrap_or(f64::NAN);
        if !all.is_finite() {
            return Err(Error::NonFinite {
                what: "the length of the orbit",
                t: period,
            });
        }
        let count = (all.ceil() as usize).clamp(NODES.0, NODES.1);
        let each = all / count as f64;
        let clearances = match spread.jumps {
            true => extents.clearances(field, &steps),
            false => extents.radii(field, &steps),
        };
        let placed = steps.iter().zip(&clearances);
        let mut begins = std::iter::once(0.0).chain(ends).zip(placed).peekable();
        let (mut nodes, mut times, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..count {
            let middle = (k as f64 + 0.5) * each;
            let mut best: Option<(f64, f64, &TracedStep)> = None;
            while let Some((at, (step, clearance))) =
                begins.next_if(|(at, _)| *at < middle + ASIDE * each)
            {
                let aside = (at - middle).abs() / each;
                if aside > ASIDE {
                    continue;
                }
                let corner = (CORNER / clearance).max(1.0);
                let fast = (extents.speed(field, &step.from) / extents.fastest).max(1.0);
                let cost = corner * fast * (1.0 + aside * aside);
                let has_place = !spread.jumps || cost < NO_PLACE;
                if has_place && best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, at, step));
                }
            }
            // A step of much measure takes the place of several arcs; and some have no good place.
            if let Some((_, at, step)) = best {
                nodes.push(step.from.clone());
                times.push(step.begin);
                places.push(at);
            }
        }
        if nodes.len() < FEW {
            let whole = ShootingNodes {
                nodes: self.nodes[..1].to_vec(),
                durations: vec![period],
            };
            return Ok((whole.split(tracer, field, &[NODES.0])?, 0.0));
        }
        let begin = times[0];
        let ends = times.iter().copied().skip(1).chain([begin + period]);
        let durations = times.iter().zip(ends).map(|(from, to)| to - from).collect();
        let chosen = ShootingNodes { nodes, durations };
        if chosen.nodes.len() >= FEWEST {
            return Ok((chosen, begin));
        }
        // Long arcs in more parts: short ones may last no longer than they are known to.
        let next = places.iter().copied().skip(1).chain([places[0] + all]);
        let parts = places.iter().zip(next).map(|(from, to)| {
            let share = (to - from) / all;
            (share * FEWEST as f64).ceil().max(1.0) as usize
        });
        let parts: Vec<usize> = parts.collect();
        Ok((chosen.split(tracer, field, &parts)?, begin))
    }

    /// Whether the other orbit, with as many nodes, has about the same shape: no variable moves farther or less far by this factor, and the nodes
    /// are on the same sides of their mean. An orbit that has shrunk to an equilibrium and grown again behind it is on the other side.
    pub(super) fn is_like(&self, other: &Self, factor: f64) -> bool {
        let [own, others] = [self, other].map(|one| extents(one.nodes.iter()));
        // What hardly moves beside the others moves by rounding.
        let least = STILL_BESIDE * own.amax();
        let alike = |(a, b): (&f64, &f64)| (a.max(least) / b.max(least)).ln().abs() <= factor.ln();
        if !own.iter().zip(&others).all(alike) {
            return false;
        }
        let [mean, middle] = [self, other].map(|one| {
            let sum = one
                .nodes
                .iter()
                .fold(Vector::zeros(own.len()), |sum, x| sum + x);
            sum / one.nodes.len() as f64
        });
        let nodes = self.nodes.iter().zip(&other.nodes);
        let product = |(a, b): (&Vector, &Vector)| {
            let [a, b] = [a - &mean, b - &middle].map(|x| x.component_div(&own));
            a.dot(&b)
        };
        nodes.map(product).sum::<f64>() > 0.0
    }

    /// All steps once around, none across a node.
    fn traced(
        &self,
        tracer: &mut Tracer,
        field: &AnyField<'_>,
        jumps: bool,
    ) -> Result<Vec<TracedStep>> {
        let (mut steps, mut begin) = (Vec::new(), 0.0);
        for (start, &duration) in self.nodes.iter().zip(&self.durations) {
            let mut trace = field.trace(start.as_slice()).abs();
            let mut from = start.clone();
            let mut observer = |step: &AnyStep<'_>| {
                let next = field.trace(step.y1).abs();
                let length = step.length.abs();
                steps.push(TracedStep {
                    begin: begin + step.t0,
                    length,
                    growth: growth_rate(field, &from, jumps) * length,
                    from: std::mem::replace(&mut from, Vector::from_column_slice(step.y1)),
                    volume: 0.5 * (trace + next) * length,
                });
                trace = next;
                Ok(Control::Continue)
            };
            tracer.flow(field, start, duration, Some(&mut observer))?;
            begin += duration;
        }
        Ok(steps)
    }

    /// Whether its nodes had better be spread anew: an arc takes far more than its part, or a node has come to a corner.
    pub(super) fn is_uneven(
        &self,
        field: &AnyField<'_>,
        spread: Spread,
        volumes: impl Iterator<Item = f64>,
    ) -> bool {
        /// The measure of an arc over the mean; and the part of a corner's way on which the curve may turn at a node.
        const WORST: f64 = 3.0;
        const SHARP: f64 = 0.1;
        let extents = Extents::of(self.nodes.iter(), self.period(), spread.fastest());
        let next = self.nodes.iter().cycle().skip(1);
        let arcs = self
            .nodes
            .iter()
            .zip(next)
            .zip(&self.durations)
            .zip(volumes);
        let measures = arcs.map(|(((from, to), &length), volume)| {
            spread.arcs(
                self.dimension(),
                extents.way(from, to, length),
                volume.abs(),
            )
        });
        let measures: Vec<f64> = measures.collect();
        let mean = measures.iter().sum::<f64>() / measures.len() as f64;
        let worst = measures.into_iter().fold(0.0, f64::max);
        let sharp = |x: &Vector| extents.radius(field, x) < SHARP * CORNER;
        worst > WORST * mean.max(1.0) || self.nodes.iter().any(sharp)
    }
}

/// How far each variable moves over these points; of one that hardly does, a part of its value.
pub(super) fn extents<'a>(points: impl Iterator<Item = &'a Vector> + Clone) -> Vector {
    /// The part of its value by which a variable moves that counts as moving.
    const STILL: f64 = 1e-3;
    /// Of what the liveliest moves.
    const NOTHING: f64 = 1e-9;
    let count = points.clone().next().map_or(0, |x| x.len());
    let extent = |i: usize| {
        let values = points.clone().map(|x| x[i]);
        let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        let extent = f64::max(most - least, STILL * f64::max(most.abs(), least.abs()));
        if extent > 0.0 { extent } else { 1.0 }
    };
    let extents = Vector::from_fn(count, |i, _| extent(i));
    // What is rounding beside the others.
    let least = NOTHING * extents.amax();
    extents.map(|extent| extent.max(least))
}

/// How fast a displacement of this point grows, if any does. Where orbits jump those across the flow count: along it all grow as it becomes faster.
fn growth_rate(field: &AnyField<'_>, x: &Vector, jumps: bool) -> f64 {
    let mut jacobian = field.jacobian(x);
    if jumps {
        let frame = frame(&field.f(x));
        jacobian = axes(&frame).transpose() * jacobian * axes(&frame);
    }
    let rates = eigenvalues(&jacobian).into_iter().flatten();
    rates.fold(0.0, |most, rate| f64::max(most, rate.re))
}
