//! Along a branch of periodic orbits, past its folds: pseudo-arclength continuation of polygons in ln V_H.
//!
//! The arclength is of the nodes' mean square displacement across the flow, and of ln V_H; the period is not in it.

use super::arc::Tracer;
use super::hopf::{HopfPoint, hopf_points};
use super::linear::Linear;
use super::polygon::Polygon;
use super::shooting::close;
use super::slab::Slab;
use super::space::Space;
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::field::{State, VectorField};

/// A direction in the space of nodes and ln V_H.
#[derive(Debug, Clone)]
struct Direction<const N: usize> {
    nodes: Vec<State<N>>,
    log_driving: f64,
}

impl<const N: usize> Direction<N> {
    fn dot(&self, other: &Self) -> f64 {
        let nodes = self.nodes.iter().zip(&other.nodes).map(|(a, b)| a.dot(b));
        nodes.sum::<f64>() / self.nodes.len() as f64 + self.log_driving * other.log_driving
    }

    fn scaled(mut self, by: f64) -> Self {
        self.nodes.iter_mut().for_each(|x| *x *= by);
        self.log_driving *= by;
        self
    }

    fn normalised(self) -> Option<Self> {
        let length = self.dot(&self).sqrt();
        (length.is_finite() && length > 0.0).then(|| self.scaled(1.0 / length))
    }

    /// The same at the nodes of another polygon of the cycle, by phase.
    fn resampled(&self, from: &Polygon<N>, to: &Polygon<N>) -> Self {
        let phases = |polygon: &Polygon<N>| {
            let period = polygon.period();
            let mut at = 0.0;
            let each = polygon.durations.iter().map(move |duration| {
                let phase = at / period;
                at += duration;
                phase
            });
            each.collect::<Vec<f64>>()
        };
        let (old, new) = (phases(from), phases(to));
        let nodes = new.iter().map(|&phase| {
            let k = old.partition_point(|&p| p <= phase).max(1) - 1;
            let next = (k + 1) % old.len();
            let end = if next == 0 { 1.0 } else { old[next] };
            let part = (phase - old[k]) / (end - old[k]);
            self.nodes[k] * (1.0 - part) + self.nodes[next] * part
        });
        Direction {
            nodes: nodes.collect(),
            log_driving: self.log_driving,
        }
    }
}

/// A point of the branch.
#[derive(Debug, Clone)]
struct Point<const N: usize> {
    polygon: Polygon<N>,
    log_driving: f64,
    direction: Direction<N>,
}

/// Size of the first orbit.
const FIRST: f64 = 0.02;
/// Lengths of steps.
const LONGEST: f64 = 0.5;
const SHORTEST: f64 = 1e-6;
/// Newton iterations of a step; after fewer than this the next one is longer.
const ITERATIONS: usize = 8;
const EASY: usize = 3;
const LONGER: f64 = 1.6;
/// Correction at which a step is done: a guess for Newton's method at the V_H that is wanted.
const DONE: f64 = 1e-7;
/// Steps on a branch.
const STEPS: usize = 400;
/// How far beyond the wanted ln V_H a branch is followed, in its distance from the Hopf point and absolutely.
const BEYOND: f64 = 2.0;
/// Orbits of less extent have come to another Hopf point.
const SMALL: f64 = 1e-3;

/// The closed orbits at the slab's V_H on the branches from the Hopf points of a symmetry, the nearest Hopf point first. The
/// search ends with the first branch that has one.
pub(super) fn from_hopf<const N: usize>(
    slab: &Slab,
    symmetry: Symmetry,
    space: &impl Space<N>,
    tracer: &mut Tracer<N>,
) -> Result<Vec<Polygon<N>>> {
    let mut found = Vec::new();
    for hopf in hopf_points(slab, symmetry)? {
        follow(slab, space, tracer, &hopf, &mut found);
        if !found.is_empty() {
            break;
        }
    }
    Ok(found)
}

/// Follows one branch, and closes an orbit wherever it passes the slab's V_H.
fn follow<const N: usize>(
    slab: &Slab,
    space: &impl Space<N>,
    tracer: &mut Tracer<N>,
    hopf: &HopfPoint,
    found: &mut Vec<Polygon<N>>,
) {
    let wanted = slab.loading.driving.ln();
    let begin = hopf.driving.ln();
    let field_at = |log: f64| space.field_at(&slab.driven_at(log.exp()));
    let polygon = hopf.ellipse(&*field_at(begin), FIRST);
    let centre = polygon.nodes.iter().sum::<State<N>>() / polygon.nodes.len() as f64;
    let outwards = Direction {
        nodes: polygon.nodes.iter().map(|x| x - centre).collect(),
        log_driving: 0.0,
    };
    let Some(direction) = outwards.normalised() else {
        return;
    };
    let first = Point {
        polygon,
        log_driving: begin,
        direction,
    };
    // The ellipse itself is the first prediction.
    let Some((mut point, _)) = correct(&field_at, tracer, &first) else {
        return;
    };
    let mut length = FIRST;
    let reach = BEYOND + 2.0 * (wanted - begin).abs();
    for _ in 0..STEPS {
        let mut predicted = point.clone();
        for (x, along) in predicted
            .polygon
            .nodes
            .iter_mut()
            .zip(&point.direction.nodes)
        {
            *x += along * length;
        }
        predicted.log_driving += length * point.direction.log_driving;
        let Some((next, iterations)) = correct(&field_at, tracer, &predicted) else {
            length *= 0.4;
            if length < SHORTEST {
                return;
            }
            continue;
        };
        if (next.log_driving - wanted) * (point.log_driving - wanted) <= 0.0 {
            // The nearer of both is the guess.
            let before = (point.log_driving - wanted).abs() < (next.log_driving - wanted).abs();
            let guess = if before { &point } else { &next };
            if let Ok(closed) = close(tracer, space.field(), guess.polygon.clone()) {
                found.push(closed.polygon);
            }
        }
        point = next;
        let far = (point.log_driving - begin).abs() > reach;
        if far || point.polygon.extent() < SMALL {
            return;
        }
        if iterations <= EASY {
            length = (length * LONGER).min(LONGEST);
        }
    }
}

/// Newton's method across the direction of the prediction, then a new mesh and its tangent.
fn correct<const N: usize>(
    field_at: &dyn Fn(f64) -> Box<dyn VectorField<N>>,
    tracer: &mut Tracer<N>,
    predicted: &Point<N>,
) -> Option<(Point<N>, usize)> {
    let mut polygon = predicted.polygon.clone();
    let mut log_driving = predicted.log_driving;
    let across = &predicted.direction;
    for iteration in 1..=ITERATIONS {
        let field = field_at(log_driving);
        let linear = Linear::new(tracer, &*field, &polygon, true).ok()?;
        let closing = linear.correction(&linear.gaps)?;
        let sliding = linear.correction(&linear.in_log_driving(log_driving))?;
        let off = Direction {
            nodes: polygon
                .nodes
                .iter()
                .zip(&predicted.polygon.nodes)
                .map(|(x, p)| x - p)
                .collect(),
            log_driving: log_driving - predicted.log_driving,
        };
        let of = |nodes: &Vec<State<N>>, log_driving: f64| {
            across.dot(&Direction {
                nodes: nodes.clone(),
                log_driving,
            })
        };
        let slide = -(across.dot(&off) + of(&closing.0, 0.0)) / of(&sliding.0, 1.0);
        let mut size = slide.abs();
        for k in 0..polygon.nodes.len() {
            let dx = closing.0[k] + sliding.0[k] * slide;
            let dt = closing.1[k] + sliding.1[k] * slide;
            size = size.max(dx.amax()).max((dt / polygon.durations[k]).abs());
            polygon.nodes[k] += dx;
            polygon.durations[k] += dt;
        }
        log_driving += slide;
        let small = size < 1.0;
        if !small || polygon.durations.iter().any(|&t| t <= 0.0) {
            return None;
        }
        if size < DONE {
            let field = field_at(log_driving);
            let meshed = polygon.meshed(tracer, &*field).ok()?;
            let old = across.resampled(&polygon, &meshed);
            let linear = Linear::new(tracer, &*field, &meshed, true).ok()?;
            let (nodes, _) = linear.correction(&linear.in_log_driving(log_driving))?;
            let tangent = Direction {
                nodes,
                log_driving: 1.0,
            };
            let tangent = tangent.normalised()?;
            let sign = if tangent.dot(&old) < 0.0 { -1.0 } else { 1.0 };
            let point = Point {
                polygon: meshed,
                log_driving,
                direction: tangent.scaled(sign),
            };
            return Some((point, iteration));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::{AnyLaw, Parameters};
    use crate::model::Loading;
    use crate::orbit::space::{Plane, Whole};

    fn slab(driving: f64) -> Slab {
        Slab {
            law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
            interfaces: 2,
            loading: Loading::new(driving, 0.14).unwrap(),
        }
    }

    #[test]
    fn hopf_points_are_where_they_are_known_to_be() {
        let fast = |symmetry| hopf_points(&slab(200.0), symmetry).unwrap()[0].driving;
        assert!((fast(Symmetry::Asymmetric) - 231.309).abs() < 5e-4);
        assert!((fast(Symmetry::Symmetric) - 190.983).abs() < 5e-4);
    }

    #[test]
    fn branches_lead_from_there_to_the_orbits_known() {
        let mut tracer = Tracer::taylor(1e-10).unwrap();
        let (whole, plane) = (slab(200.0).whole(), slab(100.0).plane());
        let asymmetric = Whole(&*whole);
        let orbits = from_hopf(&slab(200.0), Symmetry::Asymmetric, &asymmetric, &mut tracer);
        let period = orbits.unwrap()[0].period();
        assert!(
            (period / 0.087_116_411_866_969_16 - 1.0).abs() < 1e-7,
            "{period}"
        );
        let mut tracer = Tracer::taylor(1e-10).unwrap();
        let symmetric = Plane {
            plane: &*plane,
            whole: None,
        };
        let orbits = from_hopf(&slab(100.0), Symmetry::Symmetric, &symmetric, &mut tracer);
        let period = orbits.unwrap()[0].period();
        assert!(
            (period / 0.269_687_217_909_473_3 - 1.0).abs() < 1e-7,
            "{period}"
        );
    }
}
