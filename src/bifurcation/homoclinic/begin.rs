//! A connection from a periodic orbit that passes near a saddle.

use super::bogdanov_takens::BogdanovTakens;
use super::connection::{Connection, Fold, Frame, Place, extents};
use super::curve::HomoclinicPoint;
use super::linear::{Condition, Solver};
use super::saddle::{Kind, Side, Splitting};
use crate::error::Result;
use crate::field::{Matrix, Vector};
use crate::integrate::AnyField;
use crate::orbit::{ContinuationPoint, ShootingNodes, Tracer, method_for};

/// What the orbit is looked at with, and how many steps it may take in an arc and in all.
const ROUGH: f64 = 1e-9;
pub(super) const ARC: usize = 20_000;
pub(super) const WORK: usize = 50_000_000;
/// Places on each arc.
const PLACES: usize = 32;
/// An equilibrium that an orbit passes is nearer than this to where it is slowest, in parts of the extent of the orbit.
const PASSED: f64 = 0.15;
/// An orbit that passes the equilibrium again nearer than so many times the least distance is one of two loops.
const AGAIN: f64 = 3.0;
/// Up to this distance the flow near the equilibrium is taken for linear.
const LINEAR: f64 = 0.3;
/// ln of what arcs near the equilibrium grow by.
const GROWTH: f64 = 4.0;
/// Arcs are no longer than this, in parts of the extent of the orbit.
const FAR: f64 = 0.1;

/// An orbit seen at many places in time.
struct Seen {
    time: f64,
    place: Vector,
    is_node: bool,
}

impl Solver<'_> {
    /// The guess of a connection by an orbit at these coordinates, with the units of its variables; `None` where it passes no saddle. A saddle-node is where this
    /// parameter has its value.
    fn opened(&mut self, orbit: &ContinuationPoint, along: usize) -> Option<Connection> {
        let mut at = orbit.at;
        let field = self.family.field(at);
        let (seen, period) = seen(&field, &orbit.shooting)?;
        self.frame.sizes = extents(seen.iter().map(|one| &one.place));
        self.frame.first = self.frame.sizes.clone();
        let sizes = self.frame.sizes.clone();
        let speed = |one: &&Seen| field.f(&one.place).component_div(&sizes).amax();
        let slowest = seen.iter().min_by(|a, b| speed(a).total_cmp(&speed(b)))?;
        let saddle = match self.frame.kind {
            Kind::Saddle => passed(&field, &slowest.place, &sizes)?,
            _ => self.fold_near(&slowest.place, &mut at, along)?,
        };
        let away = |x: &Vector| (x - &saddle).component_div(&sizes);
        if away(&slowest.place).amax() > PASSED {
            return None;
        }
        let splitting = self.splitting(&saddle, at)?;
        let loops = one_loop(&seen, period, |x| away(x).norm());
        let near = |one: &&Seen| away(&one.place).norm() < LINEAR;
        let mut leaving = loops.iter().enumerate().take_while(|(_, one)| near(one));
        let mut arriving = loops
            .iter()
            .enumerate()
            .rev()
            .take_while(|(_, one)| near(one));
        let (begin, end) = if self.frame.kind == Kind::Saddle {
            // Where it is nearest to the unstable and to the stable subspace.
            let across = |one: &Seen, projection: &Matrix| {
                let away = away(&one.place);
                (projection * &away).norm() / away.norm()
            };
            let nearest = |side: &mut dyn Iterator<Item = (usize, &Seen)>, projection: &Matrix| {
                let best = side.map(|(i, one)| (i, across(one, projection)));
                best.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
            };
            (
                nearest(&mut leaving, &splitting.stable.projection)?,
                nearest(&mut arriving, &splitting.unstable.projection)?,
            )
        } else {
            let radius = self.frame.radii[0].max(2.0 * away(&loops[0].place).norm());
            self.frame.radii = [radius; 2];
            let is_out = |one: &Seen| away(&one.place).norm() >= radius;
            (
                loops.iter().position(is_out)?,
                loops.iter().rposition(is_out)?,
            )
        };
        if end <= begin {
            return None;
        }
        let between = loops[begin..=end].iter().enumerate();
        let kept = between.filter(|(i, one)| *i == 0 || *i == end - begin || one.is_node);
        let kept: Vec<&Seen> = kept.map(|(_, one)| one).collect();
        let connection = Connection {
            nodes: kept.iter().map(|one| one.place.clone()).collect(),
            durations: kept
                .windows(2)
                .map(|pair| pair[1].time - pair[0].time)
                .collect(),
            saddle,
            at,
        };
        Some(match self.frame.kind {
            Kind::Saddle => self.extended(connection, &splitting, [true; 2]),
            _ => connection,
        })
    }

    /// The linearisation at an equilibrium.
    pub fn splitting(&self, saddle: &Vector, at: [f64; 2]) -> Option<Splitting> {
        let jacobian = self.family.field(at).jacobian(saddle);
        let scaled = self.frame.scaled(&jacobian);
        Splitting::new(scaled, self.frame.kind)
    }

    /// Where the nodes of a connection may move.
    pub fn places(&self, of: &Connection) -> Option<Vec<Place>> {
        let splitting = self.splitting(&of.saddle, of.at)?;
        let field = self.family.field(of.at);
        Some(of.places(&field, &self.frame, &splitting))
    }

    /// With more nodes at its begin and at its end, by the linearised flow, to where it is as near the equilibrium as the frame says.
    pub fn extended(
        &self,
        connection: Connection,
        splitting: &Splitting,
        ends: [bool; 2],
    ) -> Connection {
        let sizes = &self.frame.sizes;
        let saddle = connection.saddle.clone();
        let pace = GROWTH / splitting.unstable.rates[1].max(splitting.stable.rates[0]);
        let linear = |side: &Side, from: &Vector, time: f64, radius: f64| {
            /// More nodes than this are none that help.
            const MOST: usize = 1000;
            let own = &side.projection * &splitting.matrix * &side.projection;
            let step = (own * time).exp();
            let mut place = &side.projection * (from - &saddle).component_div(sizes);
            let mut places = Vec::new();
            while side.distance_of(&place).0 > 1.5 * radius && places.len() < MOST {
                place = &step * place;
                places.push(&saddle + place.component_mul(sizes));
            }
            places
        };
        let Connection {
            mut nodes,
            mut durations,
            at,
            ..
        } = connection;
        let [from, to] = self.frame.radii;
        if ends[1] {
            let after = linear(&splitting.stable, &nodes[nodes.len() - 1], pace, to);
            durations.extend(vec![pace; after.len()]);
            nodes.extend(after);
        }
        if ends[0] {
            let before = linear(&splitting.unstable, &nodes[0], -pace, from);
            durations.splice(0..0, vec![pace; before.len()]);
            nodes.splice(0..0, before.into_iter().rev());
        }
        Connection {
            saddle,
            nodes,
            durations,
            at,
        }
    }

    /// The fold of equilibria near a place, at a value of this parameter near the one that is given.
    fn fold_near(&self, place: &Vector, at: &mut [f64; 2], along: usize) -> Option<Vector> {
        const ITERATIONS: usize = 30;
        const DONE: f64 = 1e-10;
        let sizes = &self.frame.sizes;
        let n = sizes.len();
        let parameter = self.family.plane()[along];
        let mut x = place.clone();
        for _ in 0..ITERATIONS {
            let field = self.family.field(*at);
            let scale = self.family.scale(*at)[along] * self.frame.widths[along];
            let scaled = self.frame.scaled(&field.jacobian(&x));
            let fold = Fold::of(&field, &x, &scaled, &self.frame)?;
            let slope = field.parameter_derivative(&x, parameter);
            let mut all = scaled.resize(n + 1, n + 1, 0.0);
            all.view_mut((0, n), (n, 1))
                .copy_from(&(slope.component_div(sizes) * scale));
            all.view_mut((n, 0), (1, n))
                .copy_from(&fold.in_states.transpose());
            all[(n, n)] = fold.in_parameter(&field, &x, parameter, &self.frame) * scale;
            let missing = field.f(&x).component_div(sizes).push(fold.value);
            let by = all.lu().solve(&-missing)?;
            x += by.rows(0, n).component_mul(sizes);
            at[along] += by[n] * self.frame.widths[along];
            if by.amax() < DONE {
                return Some(x);
            }
        }
        None
    }

    /// The homoclinic orbit near an orbit, at the value of one of its parameters, in the direction in which that grows; `None` where there is none.
    pub fn first(&mut self, orbit: &ContinuationPoint, held: usize) -> Option<HomoclinicPoint> {
        let guess = self.opened(orbit, 1 - held)?;
        self.near(guess, (held, orbit.at[held]))
    }

    /// The homoclinic orbit near the one that the normal form of a double zero predicts, of which the largest variable goes through `size`, with the number of
    /// the parameter along which its curve leaves; `None` where there is none.
    pub fn beside(&mut self, zero: &BogdanovTakens, size: f64) -> Option<(HomoclinicPoint, usize)> {
        let Connection {
            saddle,
            nodes,
            durations,
            at,
        } = zero.predicted(size);
        self.frame.sizes = extents(nodes.iter());
        self.frame.first = self.frame.sizes.clone();
        let saddle = passed(&self.family.field(at), &saddle, &self.frame.sizes)?;
        let splitting = self.splitting(&saddle, at)?;
        let guess = Connection {
            saddle,
            nodes,
            durations,
            at,
        };
        let guess = self.extended(guess, &splitting, [true; 2]);
        let held = zero.along(self.frame.widths);
        Some((self.near(guess, (held, at[held]))?, held))
    }

    /// The homoclinic orbit near a guess, at a value of one of its parameters, in the direction in which that grows.
    fn near(&mut self, guess: Connection, (held, value): (usize, f64)) -> Option<HomoclinicPoint> {
        let places = self.places(&guess)?;
        let condition = Condition::Parameter(held, value);
        let solved = self.correct(guess, &places, &condition).ok()?;
        let layout = solved.connection.layout();
        let mut along = Vector::zeros(layout.count());
        along[layout.parameter(held)] = 1.0;
        self.point(solved, &along, None)
    }

    /// The same connection over other nodes, evenly along its way and what arcs grow by.
    ///
    /// # Errors
    /// Those of the flow.
    pub fn spread(&mut self, old: &Connection, growths: &[f64]) -> Result<Connection> {
        let field = self.family.field(old.at);
        let (mut nodes, mut durations) = (vec![old.nodes[0].clone()], Vec::new());
        let (mut time, mut filled) = (0.0, 0.0);
        let mut before = old.nodes[0].clone();
        for (k, (&duration, growth)) in old.durations.iter().zip(growths).enumerate() {
            let part = duration / PLACES as f64;
            let seen = self.tracer.seen(&field, &old.nodes[k], duration, PLACES)?;
            let next = old.nodes[k + 1].clone();
            for x in seen.into_iter().skip(1).chain([next]) {
                let way = (&x - &before).component_div(&self.frame.sizes).amax();
                time += part;
                filled += way / FAR + growth.max(0.0) / (PLACES as f64 * GROWTH);
                if filled >= 1.0 {
                    nodes.push(x.clone());
                    durations.push(time);
                    (time, filled) = (0.0, 0.0);
                }
                before = x;
            }
        }
        if time > 0.0 {
            nodes.push(before);
            durations.push(time);
        }
        Ok(Connection {
            nodes,
            durations,
            ..old.clone()
        })
    }
}

impl Frame {
    /// Of connections over these ranges; the units of the variables are yet to be set.
    pub fn new(dimension: usize, ranges: [(f64, f64); 2], kind: Kind) -> Self {
        /// Where the orbit begins and ends: what the invariant manifolds differ by from their tangent spaces is of the order of its square.
        const RADIUS: f64 = 1e-6;
        /// The same along the direction of an eigenvalue 0, in which the orbit is slow; what it is off aside decays on the way.
        const BY_CENTRE: f64 = 0.02;
        Frame {
            sizes: Vector::from_element(dimension, 1.0),
            first: Vector::from_element(dimension, 1.0),
            widths: ranges.map(|(a, b)| (b - a).abs()),
            radii: match kind {
                Kind::Saddle => [RADIUS; 2],
                Kind::SaddleNode => [BY_CENTRE; 2],
                Kind::NonCentral => [BY_CENTRE, RADIUS],
            },
            kind,
        }
    }
}

/// Places along an orbit, and its period.
fn seen(field: &AnyField<'_>, orbit: &ShootingNodes) -> Option<(Vec<Seen>, f64)> {
    let mut tracer = Tracer::for_orbit(method_for(field, orbit), ROUGH, (ARC, WORK)).ok()?;
    let mut seen = Vec::with_capacity(PLACES * orbit.nodes.len());
    let mut begun = 0.0;
    for (node, &duration) in orbit.nodes.iter().zip(&orbit.durations) {
        let places = tracer.seen(field, node, duration, PLACES).ok()?;
        seen.extend(places.into_iter().enumerate().map(|(i, place)| Seen {
            time: begun + i as f64 / PLACES as f64 * duration,
            place,
            is_node: i == 0,
        }));
        begun += duration;
    }
    Some((seen, begun))
}

/// The equilibrium near a place.
fn passed(field: &AnyField<'_>, place: &Vector, sizes: &Vector) -> Option<Vector> {
    const ITERATIONS: usize = 50;
    const SMALL: f64 = 1e-9;
    let mut x = place.clone();
    let mut last = f64::INFINITY;
    for _ in 0..ITERATIONS {
        let step = field.newton_step(x.as_slice())?;
        let size = step.component_div(sizes).amax();
        x -= step;
        // The last digits come and go.
        if size < SMALL && size >= 0.5 * last || size == 0.0 {
            return Some(x);
        }
        last = size;
    }
    (last < SMALL).then_some(x)
}

/// One turn from where the orbit is nearest to the equilibrium to where it is so again, in the order of time.
fn one_loop(seen: &[Seen], period: f64, distance: impl Fn(&Vector) -> f64) -> Vec<Seen> {
    let count = seen.len();
    let distances: Vec<f64> = seen.iter().map(|one| distance(&one.place)).collect();
    let nearest = (0..count).min_by(|&i, &j| distances[i].total_cmp(&distances[j]));
    let nearest = nearest.unwrap_or(0);
    let at = |i: usize| distances[(nearest + i) % count];
    let is_pass = |i: &usize| {
        let here = at(*i);
        here < AGAIN * at(0) && here <= at(i - 1) && here <= at(i + 1)
    };
    // Beside the least distance there is none that is a pass of its own.
    let left = (1..count).find(|&i| at(i) > LINEAR).unwrap_or(count);
    let end = (left..count).find(is_pass).unwrap_or(count);
    let one = |i: usize| {
        let place = (nearest + i) % count;
        let turns = ((nearest + i) / count) as f64;
        Seen {
            time: seen[place].time + turns * period,
            place: seen[place].place.clone(),
            is_node: seen[place].is_node,
        }
    };
    (0..=end).map(one).collect()
}
