//! The units in which a system moves by about 1: in these it is searched and followed, whatever units its formulas are in.
//!
//! They are measured along a run, by how far each state moves and how fast, and are powers of two: numbers come back without rounding.

use super::model::TextModel;
use crate::error::{Error, MessageUnits, Result};
use crate::field::{Matrix, Vector};
use crate::integrate::{AnyField, AnyIntegrator, AnyStep, Choice, Control, Tolerances};
use crate::model::TextSystem;
use crate::number::{Interval, Uncertain, eigenvalues, eigenvector};
use crate::orbit::{Crosscheck, Orbit, OrbitAccuracy};
use std::borrow::Cow;

/// The units of the states and of time.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionUnits {
    /// Of each state.
    pub sizes: Vec<f64>,
    /// Of time.
    pub time: f64,
}

/// Steps of a run that is watched, in its second half.
const STEPS: usize = 400;
/// As long as a run may be, which ends by its steps, in units of the fastest rate.
const FOREVER: f64 = 1e30;
/// Its tolerances: sizes are all that is wanted.
const ROUGH: f64 = 1e-6;
/// A state that moves by less than this part of itself does not move.
const STILL: f64 = 1e-3;

/// The nearest power of two.
fn round(x: f64) -> f64 {
    x.log2().round().exp2()
}

impl MotionUnits {
    /// Those in which the numbers stay what they are.
    pub fn given(count: usize) -> Self {
        MotionUnits {
            sizes: vec![1.0; count],
            time: 1.0,
        }
    }

    /// Of a model's run from here; interfaces keep theirs, in which all are of order 1.
    ///
    /// # Errors
    /// Those of the field.
    pub fn of(model: &TextModel, start: &Vector) -> Result<Self> {
        match model.slab {
            Some(_) => Ok(Self::given(start.len())),
            None => Self::measured(&model.system, start),
        }
    }

    /// Of a box in which equilibria are looked for, where no start is known: a part of its widths, and the fastest rate in its middle.
    ///
    /// # Errors
    /// Those of the field.
    pub fn within(model: &TextModel, ranges: &[Interval]) -> Result<Self> {
        /// A box is some times as wide as what moves in it.
        const PART: f64 = 0.125;
        if model.slab.is_some() {
            return Ok(Self::given(ranges.len()));
        }
        let middle = ranges.iter().map(|range| 0.5 * (range.lo() + range.hi()));
        let middle = Vector::from_iterator(ranges.len(), middle);
        let widths = ranges.iter().map(|range| round(range.hi() - range.lo()));
        let sizes = widths.map(|width| if width.is_normal() { PART * width } else { 1.0 });
        Ok(MotionUnits {
            sizes: sizes.collect(),
            ..Self::at_start(&model.system, &middle)?
        })
    }

    /// Of a run from here: first in units of the state itself and of the fastest rate there, then in those that this run shows, from its end.
    ///
    /// # Errors
    /// Those of the field.
    fn measured(system: &TextSystem, start: &Vector) -> Result<Self> {
        let mut units = Self::at_start(system, start)?;
        let mut here = start.clone();
        for _ in 0..2 {
            let Some((end, measured)) = units.run(system, &here)? else {
                break;
            };
            (here, units) = (end, measured);
        }
        Ok(units)
    }

    /// By the state, and the fastest rate of the linearised system; where a state is 0, by how far it moves in such a time.
    fn at_start(system: &TextSystem, start: &Vector) -> Result<Self> {
        let field = AnyField::of_text(Cow::Borrowed(system))?;
        let fastest = eigenvalues(&field.jacobian(start))
            .map_or(0.0, |all| all.iter().map(|z| z.norm()).fold(0.0, f64::max));
        let time = round(1.0 / fastest);
        let time = if time.is_normal() { time } else { 1.0 };
        let rates = field.f(start);
        let size = |(x, rate): (&f64, &f64)| {
            let own = [x.abs(), rate.abs() * time].map(round);
            own.into_iter().find(|x| x.is_normal()).unwrap_or(1.0)
        };
        Ok(MotionUnits {
            sizes: start.iter().zip(&rates).map(size).collect(),
            time,
        })
    }

    /// Where a run from here ends, and the units that it shows; `None` where it fails.
    fn run(&self, system: &TextSystem, start: &Vector) -> Result<Option<(Vector, Self)>> {
        let field = self.field(system)?;
        let tolerances = Tolerances::equal(ROUGH)?;
        let mut integrator = AnyIntegrator::new(Choice::Auto, tolerances, 2 * STEPS)?;
        let mut seen = Seen::of(start.len());
        let mut observer = |step: &AnyStep<'_>| Ok(seen.see(step));
        let start = self.inward(start);
        let span = (0.0, FOREVER);
        let end = integrator.flow(&field, span, &start, Some(&mut observer));
        if end.is_err() || seen.steps == 0 {
            return Ok(None);
        }
        let last = Vector::from_column_slice(&seen.last);
        let end = self.outward(&last);
        let seen = match seen.rests() {
            true => seen.at_rest(&field.jacobian(&last)),
            false => seen.units(),
        };
        // What dies out, or has not begun to move, keeps the unit that it has.
        let sizes = seen.sizes.iter().zip(&self.sizes);
        let sizes = sizes.map(|(new, old)| if *new < STILL { *old } else { new * old });
        let measured = MotionUnits {
            sizes: sizes.collect(),
            time: seen.time * self.time,
        };
        Ok(Some((end, measured)))
    }

    /// A system in these units.
    ///
    /// # Errors
    /// Those of [`TextSystem::in_units`].
    pub fn inward_system(&self, system: &TextSystem) -> Result<TextSystem> {
        system.in_units(&self.sizes, self.time)
    }

    /// The field of a system in these units.
    ///
    /// # Errors
    /// Those of [`TextSystem::in_units`], and of the field.
    pub fn field(&self, system: &TextSystem) -> Result<AnyField<'static>> {
        AnyField::of_text(Cow::Owned(self.inward_system(system)?))
    }

    /// A state in these units.
    pub fn inward(&self, state: &Vector) -> Vector {
        Vector::from_fn(state.len(), |i, _| state[i] / self.sizes[i])
    }

    /// A state in the system's own.
    pub fn outward(&self, state: &Vector) -> Vector {
        Vector::from_fn(state.len(), |i, _| state[i] * self.sizes[i])
    }

    /// The accuracy of an orbit: a bound on the error of a state holds for the one with the largest unit.
    pub fn inward_accuracy(&self, accuracy: OrbitAccuracy, atol_is_given: bool) -> OrbitAccuracy {
        let mut tolerances = accuracy
            .tolerances
            .stepping(accuracy.tolerances.max_step / self.time);
        if atol_is_given {
            tolerances.atol /= self.sizes.iter().copied().fold(0.0, f64::max);
        }
        OrbitAccuracy {
            tolerances,
            ..accuracy
        }
    }

    /// An orbit in the system's own units.
    pub fn outward_orbit(&self, mut orbit: Orbit) -> Orbit {
        let time = self.time;
        let uncertain =
            |x: Uncertain, unit: f64| Uncertain::new(x.value * unit, x.uncertainty * unit);
        let parts = orbit.point.iter().zip(&self.sizes);
        // In units of 1 + |y| here and there.
        let wider = parts.map(|(x, size)| (size + (x * size).abs()) / (1.0 + (x * size).abs()));
        orbit.point_uncertainty *= wider.fold(0.0, f64::max);
        orbit.period = uncertain(orbit.period, time);
        orbit.point_time *= time;
        orbit.durations.iter_mut().for_each(|t| *t *= time);
        for state in std::iter::once(&mut orbit.point).chain(&mut orbit.nodes) {
            state
                .iter_mut()
                .zip(&self.sizes)
                .for_each(|(x, size)| *x *= size);
        }
        for (extremes, size) in orbit.extremes.iter_mut().zip(&self.sizes) {
            *extremes = extremes.map(|x| uncertain(x, *size));
        }
        orbit.stress_min = uncertain(orbit.stress_min, self.sizes[0]);
        orbit.stress_max = uncertain(orbit.stress_max, self.sizes[0]);
        orbit
    }

    /// An orbit in these units, for what does not look at its bounds.
    pub fn inward_orbit(&self, orbit: &Orbit) -> Orbit {
        let inverse = MotionUnits {
            sizes: self.sizes.iter().map(|size| 1.0 / size).collect(),
            time: 1.0 / self.time,
        };
        inverse.outward_orbit(orbit.clone())
    }

    /// An error of a search, with its times in the system's own unit.
    pub fn outward_error(&self, error: Error) -> Error {
        error.in_units(&MessageUnits {
            time: (self.time, ""),
            stress: (1.0, ""),
            slip_rate: (1.0, ""),
            stiffness: (1.0, ""),
        })
    }

    /// The same orbit by a second method.
    pub fn outward_crosscheck(&self, crosscheck: Crosscheck) -> Crosscheck {
        Crosscheck {
            orbit: self.outward_orbit(crosscheck.orbit),
            period_difference: crosscheck.period_difference * self.time,
            ..crosscheck
        }
    }
}

/// What is seen of a run.
struct Seen {
    steps: usize,
    begin: f64,
    end: f64,
    last: Vec<f64>,
    largest: Vec<f64>,
    ranges: Vec<(f64, f64)>,
    /// The ways of all states, forwards and backwards.
    ways: Vec<f64>,
}

impl Seen {
    fn of(count: usize) -> Self {
        Seen {
            steps: 0,
            begin: 0.0,
            end: 0.0,
            last: vec![0.0; count],
            largest: vec![0.0; count],
            ranges: vec![(f64::INFINITY, f64::NEG_INFINITY); count],
            ways: vec![0.0; count],
        }
    }

    fn see(&mut self, step: &AnyStep<'_>) -> Control {
        self.steps += 1;
        self.end = step.t1;
        self.last = step.y1.to_vec();
        if self.steps == STEPS / 2 {
            self.begin = step.t1;
        }
        for (largest, x) in self.largest.iter_mut().zip(step.y0.iter().zip(step.y1)) {
            *largest = largest.max(x.0.abs()).max(x.1.abs());
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
    fn rests(&self) -> bool {
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

    /// At rest: in proportion to the slowest motion there, until the first state moves by its own value; what has no part in it has its value.
    fn at_rest(&self, jacobian: &Matrix) -> MotionUnits {
        let values = Vector::from_fn(self.last.len(), |i, _| self.value(i));
        let motion = slowest_motion(jacobian).unwrap_or_else(|| values.clone());
        let reach = motion.iter().zip(&values).zip(&self.last);
        let reach = reach
            .filter(|((_, value), last)| last.abs() > STILL * **value)
            .map(|((moved, value), _)| value / moved);
        let reach = reach
            .filter(|x| x.is_finite())
            .fold(f64::INFINITY, f64::min);
        let size = |(moved, value): (&f64, &f64)| {
            let own = moved * reach;
            let size = round(if own.is_finite() && own > STILL * value {
                own
            } else {
                *value
            });
            if size.is_normal() { size } else { 1.0 }
        };
        MotionUnits {
            sizes: motion.iter().zip(&values).map(size).collect(),
            time: 1.0,
        }
    }

    /// States that move have their range, others their value; the time is that in which the liveliest one goes through its range.
    fn units(&self) -> MotionUnits {
        let mut time = f64::INFINITY;
        let mut sizes = Vec::with_capacity(self.last.len());
        for (i, (least, most)) in self.ranges.iter().enumerate() {
            let range = most - least;
            let moves = range > STILL * most.abs().max(least.abs());
            let size = round(if moves { range } else { self.value(i) });
            sizes.push(if size.is_normal() { size } else { 1.0 });
            if moves {
                time = time.min((self.end - self.begin) * range / self.ways[i]);
            }
        }
        let time = round(time);
        let time = if time.is_normal() { time } else { 1.0 };
        MotionUnits { sizes, time }
    }
}

/// How far each variable moves in the motion of the linearised system that decays last.
fn slowest_motion(jacobian: &Matrix) -> Option<Vector> {
    let all = eigenvalues(jacobian)?;
    let slowest = all.into_iter().max_by(|a, b| a.re.total_cmp(&b.re))?;
    Some(eigenvector(jacobian, slowest)?.map(|z| z.norm()))
}
