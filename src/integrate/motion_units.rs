//! The units in which a system moves by about 1: in these it is searched and followed, whatever units its formulas are in.
//!
//! They are measured along a run, by how far each state moves and how fast, and are powers of two: numbers come back without rounding.

use super::{AnyField, AnyIntegrator, AnyStep, Choice, Control, Tolerances};
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::model::TextSystem;
use crate::number::{Uncertain, eigenvalues, eigenvector};
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

    /// Of a run from here: first in units of the state itself and of the fastest rate there, then in those that this run shows, from its end.
    /// Of what goes on growing the units at its start are all that there are.
    ///
    /// # Errors
    /// Those of the field.
    pub fn measured(system: &TextSystem, start: &Vector) -> Result<Self> {
        /// By what factor a state that has been measured may still grow.
        const GROWN: f64 = 1e4;
        let first = Self::at_start(system, start)?;
        let Some((there, second)) = first.run(system, start)? else {
            return Ok(first);
        };
        let Some((_, third)) = second.run(system, &there)? else {
            return Ok(second);
        };
        let mut growth = third.sizes.iter().zip(&second.sizes);
        let grows = growth.any(|(new, old)| new / old > GROWN);
        Ok(if grows { first } else { third })
    }

    /// By the state, and the fastest rate of the linearised system; where a state is 0, by how far it moves in such a time, at first or by what
    /// others then do to it.
    ///
    /// # Errors
    /// Those of the field.
    pub fn at_start(system: &TextSystem, start: &Vector) -> Result<Self> {
        let field = AnyField::of_text(Cow::Borrowed(system))?;
        let jacobian = field.jacobian(start);
        let fastest = eigenvalues(&jacobian)
            .map_or(0.0, |all| all.iter().map(|z| z.norm()).fold(0.0, f64::max));
        let time = round(1.0 / fastest);
        let time = if time.is_normal() { time } else { 1.0 };
        let mut sizes = start.map(|x| round(x.abs()));
        let mut way = field.f(start) * time;
        for _ in 0..start.len() {
            for (size, way) in sizes.iter_mut().zip(&way) {
                if !size.is_normal() {
                    *size = round(way.abs());
                }
            }
            way = &jacobian * way * time;
        }
        let size = |size: &f64| if size.is_normal() { *size } else { 1.0 };
        Ok(MotionUnits {
            sizes: sizes.iter().map(size).collect(),
            time,
        })
    }

    /// With which a run from here that lasts so long begins: those at its start, and of a state that begins at 0 no less than a tiny part of what
    /// it comes to. The rate there may be all but 0, as before a switch.
    ///
    /// # Errors
    /// Those of the field.
    pub fn beginning(system: &TextSystem, start: &Vector, lasting: f64) -> Result<Self> {
        /// Of what a state comes to.
        const PART: f64 = 1e-8;
        let mut units = Self::at_start(system, start)?;
        if start.iter().all(|x| *x != 0.0) {
            return Ok(units);
        }
        if let Some(seen) = units.watched(&units.field(system)?, start, lasting / units.time)? {
            let sizes = units.sizes.iter_mut().zip(&seen.largest).zip(start);
            for ((size, largest), x) in sizes {
                if *x == 0.0 {
                    *size *= round(PART * largest).max(1.0);
                }
            }
        }
        Ok(units)
    }

    /// Of a box in which something is looked for, of these widths: a part of them, and the fastest rate in its middle.
    ///
    /// # Errors
    /// Those of the field.
    pub fn in_box(system: &TextSystem, middle: &Vector, widths: &[f64]) -> Result<Self> {
        /// A box is some times as wide as what moves in it.
        const PART: f64 = 0.125;
        let sizes = widths.iter().map(|&width| PART * round(width));
        let sizes = sizes.map(|size| if size.is_normal() { size } else { 1.0 });
        Ok(MotionUnits {
            sizes: sizes.collect(),
            ..Self::at_start(system, middle)?
        })
    }

    /// The same where a state has come to this, beyond what it is measured in; `None` where all are within.
    pub fn outgrown(&self, state: &[f64]) -> Option<Self> {
        /// In its unit, as far as a state may come.
        const FAR: f64 = 256.0;
        let beyond = |x: &f64| x.is_finite() && x.abs() > FAR;
        state.iter().any(beyond).then(|| {
            let larger = |(size, x): (&f64, &f64)| size * round(x.abs().max(1.0));
            MotionUnits {
                sizes: self.sizes.iter().zip(state).map(larger).collect(),
                time: self.time,
            }
        })
    }

    /// Where a run from here ends, and the units that it shows; `None` where it fails.
    fn run(&self, system: &TextSystem, start: &Vector) -> Result<Option<(Vector, Self)>> {
        let field = self.field(system)?;
        let Some(seen) = self.watched(&field, start, FOREVER)? else {
            return Ok(None);
        };
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

    /// A run from here that lasts so long at most, in the field of these units; `None` where it fails.
    fn watched(&self, field: &AnyField<'_>, start: &Vector, lasting: f64) -> Result<Option<Seen>> {
        let tolerances = Tolerances::equal(ROUGH)?;
        let mut integrator = AnyIntegrator::new(Choice::Auto, tolerances, 2 * STEPS)?;
        let mut seen = Seen::of(start.len());
        let mut observer = |step: &AnyStep<'_>| Ok(seen.see(step));
        let span = (0.0, lasting);
        let end = integrator.flow(field, span, &self.inward(start), Some(&mut observer));
        Ok((end.is_ok() && seen.steps > 0).then_some(seen))
    }

    /// A time, in the system's own unit.
    pub fn outward_time(&self, time: Uncertain) -> Uncertain {
        Uncertain::new(time.value * self.time, time.uncertainty * self.time)
    }

    /// A rate, likewise.
    pub fn outward_rate(&self, rate: Uncertain) -> Uncertain {
        Uncertain::new(rate.value / self.time, rate.uncertainty / self.time)
    }

    /// An error of a run or a search, with its times, and the values of the state that it names, in the system's own units.
    pub fn outward_error(&self, mut error: Error, state: usize) -> Error {
        let time = self.time;
        match &mut error {
            Error::StepTooSmall { t, h } => (*t, *h) = (*t * time, *h * time),
            Error::BlowUp {
                t,
                uncertainty,
                rate,
            }
            | Error::TooFast {
                t,
                uncertainty,
                rate,
                ..
            } => {
                (*t, *rate) = (*t * time, *rate / time);
                *uncertainty = uncertainty.map(|x| x * time);
            }
            Error::UndecidedEnd { t, again } => {
                (*t, *again) = (*t * time, again.map(|t| t * time));
            }
            Error::TooManySteps { t, end, .. } => (*t, *end) = (*t * time, *end * time),
            Error::NonFinite { t, .. } => *t *= time,
            Error::Sundials { time: t, .. } => *t = t.map(|t| t * time),
            Error::WrongTime { asked, returned } => {
                (*asked, *returned) = (*asked * time, *returned * time);
            }
            Error::NoOrbit { period, .. } => *period = period.map(|t| t * time),
            Error::NoReturn {
                since,
                t,
                section,
                lowest,
                highest,
            } => {
                (*since, *t) = (*since * time, *t * time);
                for x in [section, lowest, highest] {
                    *x *= self.sizes[state];
                }
            }
            _ => {}
        }
        error
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

    /// Tolerances in these units: an absolute one in the system's own holds for the state with the largest unit.
    pub fn inward_tolerances(&self, tolerances: Tolerances, atol_is_given: bool) -> Tolerances {
        let mut inward = tolerances.stepping(tolerances.max_step / self.time);
        if atol_is_given {
            inward.atol /= self.sizes.iter().copied().fold(0.0, f64::max);
        }
        inward
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

    /// At rest: in proportion to the slowest motion there, until the first state moves by its own value, but no less than a part of its value;
    /// what has no part in it has its value.
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
        /// Of a value: elsewhere a state may move by more than it does here.
        const LEAST: f64 = 1.0 / 16.0;
        let size = |(moved, value): (&f64, &f64)| {
            let own = moved * reach;
            let size = round(if own.is_finite() && own > STILL * value {
                own.max(LEAST * value)
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
