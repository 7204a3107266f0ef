//! Shooting nodes: the polygon along a closed curve that a periodic orbit is solved on, and its mesh.

use super::arc::{Tracer, share};
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::{AnyField, Control, of_dimension};

/// Points along a closed curve, and the times from each to the next: a periodic orbit, or a guess of one.
#[derive(Debug, Clone, PartialEq)]
pub struct ShootingNodes {
    /// The points.
    pub nodes: Vec<Vector>,
    /// From each node to the next, from the last to the first; all of one sign.
    pub durations: Vec<f64>,
}

/// The end of an arc from a start over a duration, and the logarithm of what its tangent loses.
pub type EndAndLoss<'a> = &'a mut dyn FnMut(&Vector, f64) -> Result<(Vector, f64)>;

/// The least and the largest number of nodes.
const NODES: (usize, usize) = (3, 128);
/// Steps on an arc, of the tracer's method, and the change of ln |volume|: few arcs, which take the least time from a good guess.
const STEPS: f64 = 12.0;
const VOLUME: f64 = 3.0;

/// A step along a closed curve that is cut into arcs.
struct TracedStep {
    begin: f64,
    from: Vector,
    length: f64,
    /// The integral of |trace|.
    volume: f64,
    /// Whether it is as long as the method makes it: not cut short by the end of an arc.
    whole: bool,
}

/// What part each step is of one that is not cut short. Where old arcs have become short they would be taken for much work, and
/// come back as many short ones.
fn parts(steps: &[TracedStep]) -> Vec<f64> {
    let last_whole = |longest: &mut Option<f64>, step: &TracedStep| {
        if step.whole {
            *longest = Some(step.length);
        }
        Some(*longest)
    };
    let before: Vec<_> = steps.iter().scan(None, last_whole).collect();
    let mut after: Vec<_> = steps.iter().rev().scan(None, last_whole).collect();
    after.reverse();
    let part = |((step, before), after): ((&TracedStep, &Option<f64>), &Option<f64>)| {
        let whole = match (before, after) {
            (Some(a), Some(b)) => a.min(*b),
            (Some(one), None) | (None, Some(one)) => *one,
            (None, None) => return 1.0,
        };
        (step.length / whole).min(1.0)
    };
    steps.iter().zip(&before).zip(&after).map(part).collect()
}

/// The largest loss on a refined arc, some four digits, and how often one is halved for it.
const LARGEST_LOSS: f64 = 10.0;
const DEPTH: usize = 10;
/// How many arcs there may be: along stiff orbits e^-10 is soon lost, and what is lost beyond is below any floor.
pub(super) const MOST_ARCS: usize = 4096;
/// The same of methods that begin every arc with short steps.
pub(super) const MOST_IMPLICIT_ARCS: usize = 256;

/// A number with only so many significant digits left.
pub fn of_digits(digits: i32, x: f64) -> f64 {
    if x == 0.0 {
        return 0.0;
    }
    let unit = 10.0_f64.powi(x.abs().log10().floor() as i32 + 1 - digits);
    (x / unit).round() * unit
}

impl ShootingNodes {
    /// The number of variables.
    pub fn dimension(&self) -> usize {
        self.nodes.first().map_or(0, |x| x.len())
    }

    /// That all nodes are points of a field with so many variables.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) where one is not.
    pub fn checked(&self, dimension: usize) -> Result<()> {
        let mut nodes = self.nodes.iter();
        nodes.try_for_each(|x| of_dimension(x.len(), dimension))
    }

    /// Nodes and durations, with only so many significant digits left: what a second method begins
    /// with.
    pub(crate) fn of_digits(digits: i32, nodes: &[Vec<f64>], durations: &[f64]) -> Self {
        let node = |x: &Vec<f64>| Vector::from_fn(x.len(), |i, _| of_digits(digits, x[i]));
        ShootingNodes {
            nodes: nodes.iter().map(node).collect(),
            durations: durations.iter().map(|&t| of_digits(digits, t)).collect(),
        }
    }

    /// The trajectory from `start` over this duration, cut into arcs of about equal work and contraction.
    ///
    /// # Errors
    /// Those of the flow.
    pub fn along(
        tracer: &mut Tracer,
        field: &AnyField<'_>,
        start: &Vector,
        duration: f64,
    ) -> Result<Self> {
        let whole = ShootingNodes {
            nodes: vec![start.clone()],
            durations: vec![duration],
        };
        whole.meshed(tracer, field)
    }

    /// The same curve, its arcs cut anew: of about equal work and contraction.
    ///
    /// # Errors
    /// Those of the flow.
    pub fn meshed(&self, tracer: &mut Tracer, field: &AnyField<'_>) -> Result<Self> {
        // No cut but at the ends of steps.
        let (mut steps, mut begin) = (Vec::new(), 0.0);
        for (start, &duration) in self.nodes.iter().zip(&self.durations) {
            let mut trace = field.trace(start.as_slice()).abs();
            let mut from = start.clone();
            tracer.flow(
                field,
                start,
                duration,
                Some(&mut |step| {
                    let next = field.trace(step.y1).abs();
                    let length = step.length.abs();
                    let to = Vector::from_column_slice(step.y1);
                    steps.push(TracedStep {
                        begin: begin + step.t0,
                        from: std::mem::replace(&mut from, to),
                        length,
                        volume: 0.5 * (trace + next) * length * share(start.len()),
                        whole: true,
                    });
                    trace = next;
                    Ok(Control::Continue)
                }),
            )?;
            if let Some(last) = steps.last_mut() {
                last.whole = false;
            }
            // The next arc begins here: at its own node.
            begin += duration;
        }
        let measures = steps.iter().zip(parts(&steps));
        let measures = measures.map(|(step, part)| part / STEPS + step.volume / VOLUME);
        let measures: Vec<f64> = measures.collect();
        let all: f64 = measures.iter().sum();
        let count = (all.ceil() as usize).clamp(NODES.0, NODES.1);
        let (mut nodes, mut times) = (Vec::new(), Vec::new());
        let (each, mut last) = (all / count as f64, 0.0);
        let (mut before, mut next) = (0.0, 0.0);
        for (step, measure) in steps.into_iter().zip(measures) {
            // No arc is a short one, the last one neither.
            let short = f64::min(before - last, all - before) < 0.5 * each && !times.is_empty();
            if before + 0.5 * measure >= next && !short {
                nodes.push(step.from);
                times.push(step.begin);
                // A step of much measure takes the place of several arcs: what follows it is not cut the finer for that.
                next = f64::max(next + each, before + 0.5 * each);
                last = before;
            }
            before += measure;
        }
        times.push(begin);
        let durations = times.windows(2).map(|t| t[1] - t[0]).collect();
        Ok(ShootingNodes { nodes, durations })
    }

    /// With arcs halved, and again, until on none of them more digits than a few are lost to contraction. `end_and_loss` gives
    /// the end of an arc from a start over a duration, and the logarithm of the lost part.
    ///
    /// # Errors
    /// Those of the closure.
    #[doc(hidden)]
    pub fn refined(&self, end_and_loss: EndAndLoss<'_>) -> Result<Self> {
        self.refined_to(MOST_ARCS, end_and_loss)
    }

    /// The same with at most so many arcs.
    pub(super) fn refined_to(&self, most: usize, end_and_loss: EndAndLoss<'_>) -> Result<Self> {
        let mut finer = ShootingNodes {
            nodes: Vec::new(),
            durations: Vec::new(),
        };
        for (x, &duration) in self.nodes.iter().zip(&self.durations) {
            let mut x = x.clone();
            // Pieces still to be looked at, the next one last.
            let mut pieces = vec![(duration, 0)];
            while let Some((duration, depth)) = pieces.pop() {
                let (end, loss) = end_and_loss(&x, duration)?;
                let full = finer.nodes.len() + pieces.len() >= most;
                if loss <= LARGEST_LOSS || depth == DEPTH || full {
                    finer.nodes.push(x);
                    finer.durations.push(duration);
                    x = end;
                } else {
                    let half = 0.5 * duration;
                    pieces.push((duration - half, depth + 1));
                    pieces.push((half, depth + 1));
                }
            }
        }
        Ok(finer)
    }

    /// With more nodes: every arc cut into its number of parts, of equal duration.
    ///
    /// # Errors
    /// Those of the flow.
    pub(super) fn split(
        &self,
        tracer: &mut Tracer,
        field: &AnyField<'_>,
        parts: &[usize],
    ) -> Result<Self> {
        let mut finer = ShootingNodes {
            nodes: Vec::new(),
            durations: Vec::new(),
        };
        for ((x, duration), &parts) in self.nodes.iter().zip(&self.durations).zip(parts) {
            let part = duration / parts as f64;
            let mut node = x.clone();
            for i in 0..parts {
                if i > 0 {
                    node = tracer.flow(field, &node, part, None)?;
                }
                finer.nodes.push(node.clone());
                finer.durations.push(part);
            }
        }
        Ok(finer)
    }

    /// The same cycle from other nodes: each moved along its arc by this part of it.
    ///
    /// # Errors
    /// Those of the flow.
    pub fn shifted(&self, tracer: &mut Tracer, field: &AnyField<'_>, part: f64) -> Result<Self> {
        let mut moved = self.clone();
        for (x, duration) in moved.nodes.iter_mut().zip(&self.durations) {
            *x = tracer.flow(field, x, part * duration, None)?;
        }
        let count = moved.durations.len();
        for k in 0..count {
            let next = self.durations[(k + 1) % count];
            moved.durations[k] = (1.0 - part) * self.durations[k] + part * next;
        }
        Ok(moved)
    }

    /// The same, beginning at the k-th node.
    pub(super) fn beginning_at(mut self, k: usize) -> Self {
        self.nodes.rotate_left(k);
        self.durations.rotate_left(k);
        self
    }

    /// With this part of a correction of nodes and durations.
    pub(super) fn moved(&self, nodes: &[Vector], durations: &[f64], part: f64) -> Self {
        let moved = self.nodes.iter().zip(nodes);
        let stretched = self.durations.iter().zip(durations);
        ShootingNodes {
            nodes: moved.map(|(x, dx)| x + dx * part).collect(),
            durations: stretched.map(|(t, dt)| t + dt * part).collect(),
        }
    }

    /// The time once around.
    pub fn period(&self) -> f64 {
        self.durations.iter().sum()
    }

    /// How far each variable moves, between its smallest and its largest value at the nodes.
    pub(crate) fn extents(&self) -> Vector {
        let values = |i: usize| self.nodes.iter().map(move |x| x[i]);
        Vector::from_fn(self.dimension(), |i, _| {
            values(i).fold(f64::NEG_INFINITY, f64::max) - values(i).fold(f64::INFINITY, f64::min)
        })
    }

    /// The same; of a variable that does not move, its value.
    pub(crate) fn sizes(&self) -> Vector {
        let extents = self.extents();
        Vector::from_fn(self.dimension(), |i, _| {
            let value = self
                .nodes
                .iter()
                .fold(0.0, |most: f64, x| most.max(x[i].abs()));
            if extents[i] > f64::EPSILON * value {
                extents[i]
            } else if value > 0.0 {
                value
            } else {
                1.0
            }
        })
    }

    /// The largest extent over the components.
    pub fn extent(&self) -> f64 {
        self.extents().iter().copied().fold(0.0, f64::max)
    }
}
