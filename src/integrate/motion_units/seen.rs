//! What is seen of a run whose units are measured.

use super::{MotionUnits, STEPS, STILL};
use crate::field::{Matrix, Vector};
use crate::integrate::{AnyStep, Control};
use crate::number::{eigenvalues, eigenvector};

/// What is seen of a run.
pub(super) struct Seen {
    pub steps: usize,
    begin: f64,
    end: f64,
    pub last: Vec<f64>,
    pub largest: Vec<f64>,
    /// The least size of each state so far, and by what factor one has grown from there.
    least: Vec<f64>,
    pub risen: Vec<f64>,
    ranges: Vec<(f64, f64)>,
    /// The ways of all states, forwards and backwards.
    ways: Vec<f64>,
}

impl Seen {
    pub fn of(count: usize) -> Self {
        Seen {
            steps: 0,
            begin: 0.0,
            end: 0.0,
            last: vec![0.0; count],
            largest: vec![0.0; count],
            least: vec![f64::INFINITY; count],
            risen: vec![1.0; count],
            ranges: vec![(f64::INFINITY, f64::NEG_INFINITY); count],
            ways: vec![0.0; count],
        }
    }

    pub fn see(&mut self, step: &AnyStep<'_>) -> Control {
        self.steps += 1;
        self.end = step.t1;
        self.last = step.y1.to_vec();
        if self.steps == STEPS / 2 {
            self.begin = step.t1;
        }
        for (largest, x) in self.largest.iter_mut().zip(step.y0.iter().zip(step.y1)) {
            *largest = largest.max(x.0.abs()).max(x.1.abs());
        }
        for (i, x) in step.y1.iter().enumerate() {
            self.least[i] = self.least[i].min(x.abs());
            self.risen[i] = self.risen[i].max(x.abs() / self.least[i].max(f64::MIN_POSITIVE));
        }
        if self.steps >= STEPS / 2 {
            for (i, &x) in step.y1.iter().enumerate() {
                let (least, most) = &mut self.ranges[i];
                (*least, *most) = (least.min(x), most.max(x));
            }
        }
        if self.steps > STEPS / 2 {
            for (i, way) in self.ways.iter_mut().enumerate() {
                *way += (step.y1[i] - step.y0[i]).abs();
            }
        }
        if self.steps == STEPS {
            Control::Stop
        } else {
            Control::Continue
        }
    }

    /// A run that ends sooner has come to rest.
    pub fn rests(&self) -> bool {
        self.steps < STEPS
    }

    /// The value of a state, or, where it has died out, the largest that it had.
    fn value(&self, i: usize) -> f64 {
        let (value, largest) = (self.last[i].abs(), self.largest[i]);
        if value > STILL * largest {
            value
        } else {
            largest
        }
    }

    /// At rest: in proportion to the slowest motion there, until the first state moves by its own value, but no less than a part of its value;
    /// what has no part in it has its value.
    pub fn at_rest(&self, jacobian: &Matrix) -> MotionUnits {
        let values = Vector::from_fn(self.last.len(), |i, _| self.value(i));
        let motion = slowest_motion(jacobian).unwrap_or_else(|| values.clone());
        let reach = motion.iter().zip(&values).zip(&self.last);
        let reach = reach
            .filter(|((_, value), last)| last.abs() > STILL * **value)
            .map(|((moved, value), _)| value / moved);
        let reach = reach
            .filter(|x| x.is_finite())
            .fold(f64::INFINITY, f64::min);
        /// Of a value: elsewhere a state may move by more than it does here.
        const LEAST: f64 = 1.0 / 16.0;
        let size = |(moved, value): (&f64, &f64)| {
            let own = moved * reach;
            let size = if own.is_finite() && own > STILL * value {
                own.max(LEAST * value)
            } else {
                *value
            };
            if size.is_normal() { size } else { 1.0 }
        };
        MotionUnits::new(motion.iter().zip(&values).map(size).collect(), 1.0)
    }

    /// States that move have their range, others their value; the time is that in which the liveliest one goes through its range.
    pub fn units(&self) -> MotionUnits {
        let mut time = f64::INFINITY;
        let mut sizes = Vec::with_capacity(self.last.len());
        for (i, (least, most)) in self.ranges.iter().enumerate() {
            let range = most - least;
            let moves = range > STILL * most.abs().max(least.abs());
            let size = if moves { range } else { self.value(i) };
            sizes.push(if size.is_normal() { size } else { 1.0 });
            if moves {
                time = time.min((self.end - self.begin) * range / self.ways[i]);
            }
        }
        let time = if time.is_normal() { time } else { 1.0 };
        MotionUnits::new(sizes, time)
    }
}

/// How far each variable moves in the motion of the linearised system that decays last.
fn slowest_motion(jacobian: &Matrix) -> Option<Vector> {
    let all = eigenvalues(jacobian)?;
    let slowest = all.into_iter().max_by(|a, b| a.re.total_cmp(&b.re))?;
    Some(eigenvector(jacobian, slowest)?.map(|z| z.norm()))
}
