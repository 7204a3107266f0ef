//! The infinitesimal phase response of a periodic orbit: the gradient of the phase, by which a small kick at a point of the orbit
//! advances it.
//!
//! With the phase in units of time, Z . f = 1 along the orbit, and Z is carried backwards by the transposed tangents: the bounded solution
//! of the adjoint equation dZ/dt = -J^T Z (Brown, Moehlis & Holmes (2004). On the phase reduction and response dynamics of neural
//! oscillator populations. Neural Computation 16, 673-715). In the planes across the flow, from which the trivial multiplier is gone,
//! that is a cyclic system: what a displacement in one plane advances the phase by is what it does in the next plane, and the time by
//! which it arrives there sooner.

use super::arc::Tracer;
use super::cyclic;
use super::linear::{Linear, axes};
use super::no_orbit;
use super::noise::{PROBES, Signs, TANGENT, graded};
use super::shooting::close;
use super::shooting_nodes::ShootingNodes;
use super::solve::{Orbit, OrbitAccuracy, SHIFTS, SPREAD};
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::integrate::AnyField;
use crate::number::Uncertain;

/// At a point of the orbit.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseResponse {
    /// Between 0 and 1, in parts of the period since the orbit's point.
    pub phase: f64,
    /// The time since then.
    pub time: f64,
    /// The point.
    pub state: Vec<f64>,
    /// By which time a kick in each of the variables advances the orbit, over the kick.
    pub response: Vec<Uncertain>,
}

impl PhaseResponse {
    /// The same in so many variables, of which all from the last of these on have its value and move alike: a kick in one of them is a part of one in
    /// all.
    pub fn share_last(&mut self, count: usize) {
        let (Some(&last), Some(&z)) = (self.state.last(), self.response.last()) else {
            return;
        };
        let parts = (count - self.state.len() + 1) as f64;
        self.response.pop();
        self.state.resize(count, last);
        self.response.resize(
            count,
            Uncertain::new(z.value / parts, z.uncertainty / parts),
        );
    }
}

/// Standard deviations that are claimed of noise.
const DEVIATIONS: f64 = 3.0;
/// Of the sums, in units of the largest response at a point.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The response at so many points, equally spaced in time, from the orbit's point back to it.
///
/// # Errors
/// [`Error::Input`] where a forcing fixes the phase; [`Error::NoOrbit`] for one of a family of orbits, on which a kick moves to a
/// neighbour of another period; those of the flow.
pub fn phase_response(
    field: &AnyField<'_>,
    orbit: &Orbit,
    accuracy: &OrbitAccuracy,
    points: usize,
) -> Result<Vec<PhaseResponse>> {
    if field.phase().is_some() {
        return Err(Error::Input(
            "under a periodic forcing the phase of an orbit is that of the forcing, and no kick moves it".into(),
        ));
    }
    let mut tracer = tracer(accuracy)?;
    let closed = close(&mut tracer, field, orbit.clone().beginning().shooting)?;
    let last = (points - 1) as f64;
    let phases: Vec<f64> = (0..points).map(|i| i as f64 / last).collect();
    let shooting = &closed.shooting;
    let along = Along::new(&mut tracer, field, shooting, (orbit.point_time, &phases))?;
    let noise = along.noise(field).ok_or_else(undetermined)?;
    let mut apart = vec![Vector::zeros(field.dimension()); points];
    for shift in SHIFTS {
        let mut other = self::tracer(&accuracy.looser())?;
        let moved = shooting.shifted(&mut other, field, shift)?;
        let again = close(&mut other, field, moved)?.shooting;
        // The first node stands later by this.
        let begin = orbit.point_time - shift * shooting.durations[0];
        let again = Along::new(&mut other, field, &again, (begin, &phases))?;
        for (i, apart) in apart.iter_mut().enumerate() {
            *apart = apart.sup(&along.differs(field, &again, i));
        }
    }
    let row = |(i, &phase): (usize, &f64)| {
        let k = along.rows[i];
        let responses = along.responses[k].iter().enumerate();
        PhaseResponse {
            phase,
            time: phase * shooting.period(),
            state: along.shooting.nodes[k].iter().copied().collect(),
            response: responses
                .map(|(j, &z)| {
                    let rounding = ROUNDING * along.responses[k].amax();
                    let off = DEVIATIONS * noise[k][j] + SPREAD * apart[i][j];
                    Uncertain::new(z, off + rounding)
                })
                .collect(),
        }
    };
    Ok(phases.iter().enumerate().map(row).collect())
}

fn tracer(accuracy: &OrbitAccuracy) -> Result<Tracer> {
    Tracer::new(accuracy.method, accuracy.tolerances, accuracy.max_steps)
}

fn undetermined() -> Error {
    no_orbit(
        "the orbit has no phase response: a second multiplier is 1, as on a family of orbits"
            .into(),
        "ask for it at other parameters",
    )
}

/// The response at the nodes of an orbit and at all points that are asked for.
struct Along {
    /// With a node at each of these points.
    shooting: ShootingNodes,
    /// Which nodes these are.
    rows: Vec<usize>,
    linear: Linear,
    /// At every node.
    responses: Vec<Vector>,
}

impl Along {
    /// At these phases since the time `begin` after the first node.
    fn new(
        tracer: &mut Tracer,
        field: &AnyField<'_>,
        shooting: &ShootingNodes,
        (begin, phases): (f64, &[f64]),
    ) -> Result<Self> {
        let period = shooting.period();
        let times = phases
            .iter()
            .map(|phase| (begin + phase * period).rem_euclid(period));
        let times: Vec<f64> = times.collect();
        let (shooting, rows) = with_nodes_at(tracer, field, shooting, &times)?;
        let linear = Linear::new(tracer, field, &shooting)?;
        let responses = responses(&linear).ok_or_else(undetermined)?;
        Ok(Along {
            shooting,
            rows,
            linear,
            responses,
        })
    }

    /// The rate at which the response at the k-th node changes in time.
    fn rate(&self, field: &AnyField<'_>, k: usize) -> Vector {
        -field
            .jacobian(&self.shooting.nodes[k])
            .tr_mul(&self.responses[k])
    }

    /// What the response of another solution differs by at the i-th point, at the phase that its point has on this one.
    fn differs(&self, field: &AnyField<'_>, other: &Self, i: usize) -> Vector {
        let (k, there) = (self.rows[i], other.rows[i]);
        let here = &self.responses[k];
        let later = here.dot(&(&other.shooting.nodes[there] - &self.shooting.nodes[k]));
        let moved = here + self.rate(field, k) * later;
        (&other.responses[there] - moved).abs()
    }

    /// The standard deviations that the rounding of the arcs makes of the responses at all nodes: by their tangents, and by the phases of the
    /// nodes.
    fn noise(&self, field: &AnyField<'_>) -> Option<Vec<Vector>> {
        let Along {
            linear,
            shooting,
            responses,
            ..
        } = self;
        let count = responses.len();
        let rates: Vec<Vector> = (0..count).map(|k| self.rate(field, k)).collect();
        let mut squares = vec![Vector::zeros(field.dimension()); count];
        let mut signs = Signs::new();
        for _ in 0..PROBES {
            let noisy = linear.noisy(shooting, &mut signs);
            let (moved, _) = linear.correction(&noisy.gaps)?;
            let right = linear.arcs.iter().enumerate().map(|(k, arc)| {
                let sizes = graded(&arc.tangent) * (TANGENT * arc.rounding());
                let errors = sizes.map(|size| size * signs.next());
                axes(&linear.frames[k]).tr_mul(&errors.tr_mul(&responses[(k + 1) % count]))
            });
            let right: Vec<Vector> = right.collect();
            let changes = backwards(linear, right)?;
            for (k, squares) in squares.iter_mut().enumerate() {
                let phase = responses[k].dot(&moved[k]);
                let change = axes(&linear.frames[k]) * &changes[k] + &rates[k] * phase;
                *squares += change.component_mul(&change);
            }
        }
        let deviation = |squares: Vector| squares.map(|square| (square / PROBES as f64).sqrt());
        Some(squares.into_iter().map(deviation).collect())
    }
}

/// The gradients of the phase at all nodes.
fn responses(linear: &Linear) -> Option<Vec<Vector>> {
    let Linear {
        arcs,
        frames,
        slowness,
        ..
    } = linear;
    let count = arcs.len();
    let sooner = |k: usize| {
        let normal = frames[(k + 1) % count].column(0) * slowness[k];
        axes(&frames[k]).tr_mul(&arcs[k].tangent.tr_mul(&normal))
    };
    let in_planes = backwards(linear, (0..count).map(sooner).collect())?;
    let all = in_planes.iter().enumerate().map(|(k, z)| {
        // Of the arc that ends here: its normal is along the flow.
        let before = (k + count - 1) % count;
        axes(&frames[k]) * z + frames[k].column(0) * slowness[before]
    });
    Some(all.collect())
}

/// The solution of z_k = P_k^T z_{k+1} + r_k around the circle, with the maps from plane to plane.
fn backwards(linear: &Linear, mut right: Vec<Vector>) -> Option<Vec<Vector>> {
    let maps = linear.maps.iter().rev().map(|map| map.transpose());
    right.reverse();
    let mut all = cyclic::solve(&maps.collect::<Vec<_>>(), &right)?;
    // These are z_0, z_{m-1}, ..., z_1.
    all[1..].reverse();
    Some(all)
}

/// The same orbit with nodes at these times since the first one, too, and which these are.
fn with_nodes_at(
    tracer: &mut Tracer,
    field: &AnyField<'_>,
    shooting: &ShootingNodes,
    times: &[f64],
) -> Result<(ShootingNodes, Vec<usize>)> {
    /// A time nearer to a node than this part of the period is that of the node.
    const SAME: f64 = 4.0 * f64::EPSILON;
    let same = SAME * shooting.period();
    let mut order: Vec<usize> = (0..times.len()).collect();
    order.sort_by(|&i, &j| times[i].total_cmp(&times[j]));
    let mut order = order.into_iter().peekable();
    let mut rows = vec![0; times.len()];
    let mut finer = ShootingNodes {
        nodes: Vec::new(),
        durations: Vec::new(),
    };
    let mut begin = 0.0;
    for (node, &duration) in shooting.nodes.iter().zip(&shooting.durations) {
        let (mut here, mut at) = (node.clone(), 0.0);
        while let Some(i) = order.next_if(|&i| times[i] < begin + duration - same) {
            let next = times[i] - begin;
            if next - at > same {
                let end = tracer.flow(field, &here, next - at, None)?;
                finer.nodes.push(std::mem::replace(&mut here, end));
                finer.durations.push(next - at);
                at = next;
            }
            rows[i] = finer.nodes.len();
        }
        finer.nodes.push(here);
        finer.durations.push(duration - at);
        begin += duration;
    }
    // What is left stands at the first node again.
    Ok((finer, rows))
}
