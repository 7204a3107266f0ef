//! The units in which a system moves by about 1: in these it is searched and followed, whatever units its formulas are in.
//!
//! They are measured along a run, by how far each state moves and how fast. Rounded to powers of two numbers come back without rounding; as they are
//! steps are as long whatever the system's own units. Where time is a variable, the one after the states, it has the unit of time.

mod forced;
mod seen;

use super::static_field::SUNKEN;
use super::{AnyField, AnyIntegrator, AnyStep, Choice, Tolerances};
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::model::TextSystem;
use crate::number::{Uncertain, eigenvalues};
use seen::Seen;
use std::borrow::Cow;

/// The units of the states and of time.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionUnits {
    /// Of each state.
    pub sizes: Vec<f64>,
    /// Of time.
    pub time: f64,
    /// The signs of the states that are followed by their logarithms, and 0 of the others.
    pub signs: Vec<f64>,
}

/// Steps of a run that is watched, in its second half.
const STEPS: usize = 400;
/// As long as a run may be, which ends by its steps, in units of the fastest rate.
const FOREVER: f64 = 1e30;
/// Its tolerances: sizes are all that is wanted.
const ROUGH: f64 = 1e-6;
/// A state that moves by less than this part of itself does not move.
const STILL: f64 = 1e-3;

/// These sizes, and of a state whose size nothing tells, as it is 0 and stays so, that of the others: their geometric mean, or 1 where nothing tells any.
fn completed(sizes: &[f64]) -> Vec<f64> {
    let known = sizes.iter().filter(|size| size.is_normal());
    let logarithms: Vec<f64> = known.map(|size| size.abs().log2()).collect();
    let mean = logarithms.iter().sum::<f64>() / logarithms.len().max(1) as f64;
    let complete = |size: &f64| if size.is_normal() { *size } else { mean.exp2() };
    sizes.iter().map(complete).collect()
}

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
            signs: vec![0.0; count],
        }
    }

    fn new(sizes: Vec<f64>, time: f64) -> Self {
        MotionUnits {
            signs: vec![0.0; sizes.len()],
            sizes,
            time,
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
        let first = Self::at_start_exactly(system, start)?;
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

    /// The same as powers of two.
    #[must_use]
    pub fn rounded(mut self) -> Self {
        self.sizes.iter_mut().for_each(|size| *size = round(*size));
        self.time = round(self.time);
        self
    }

    /// The same, rounded, with the logarithms of states that are factors of their own rates and, in a run from here, sink to where rounding of what they were
    /// is larger than they are, and grow again by as much.
    ///
    /// # Errors
    /// Those of the field.
    pub fn measured_or_logarithmic(system: &TextSystem, start: &Vector) -> Result<Self> {
        let units = Self::measured(system, start)?.rounded();
        let has = system.have_logarithms();
        if !has.contains(&true) {
            return Ok(units);
        }
        let field = units.field(system)?;
        let (seen, end) = units.seen(&field, start, FOREVER)?;
        let is_lost = |end: &Result<Vector>| matches!(end, Err(Error::Underflow { .. }));
        let is_low = |i: usize| has[i] && start[i] != 0.0 && units.is_sunken(i, seen.last[i]);
        let sinks = is_lost(&end)
            || (0..has.len()).any(is_low) && {
                // Whether it comes back a longer run shows.
                let tolerances = Tolerances::equal(ROUGH)?;
                let mut integrator = AnyIntegrator::new(Choice::Auto, tolerances, 10 * STEPS)?;
                is_lost(&integrator.flow(&field, (0.0, FOREVER), &units.inward(start), None))
            };
        let far = |i: usize| sinks || seen.risen[i] * f64::EPSILON > 1.0;
        let which = |i: usize| has[i] && far(i);
        let logarithmic = units.in_logarithms(start.as_slice(), which);
        Ok(logarithmic.unwrap_or(units))
    }

    /// By the state, and the fastest rate of the linearised system; where a state is 0, by how far it moves in such a time, at first or by what
    /// others then do to it. Rounded.
    ///
    /// # Errors
    /// Those of the field.
    pub fn at_start(system: &TextSystem, start: &Vector) -> Result<Self> {
        Ok(Self::at_start_exactly(system, start)?.rounded())
    }

    fn at_start_exactly(system: &TextSystem, start: &Vector) -> Result<Self> {
        let field = AnyField::of_text(Cow::Borrowed(system))?;
        let jacobian = field.jacobian(start);
        let time = 1.0 / fastest(&jacobian);
        let time = if time.is_normal() { time } else { 1.0 };
        let sizes = sizes_at_start((&field, &jacobian), start, time);
        Ok(Self::new(completed(sizes.as_slice()), time))
    }

    /// With which a run from here that lasts so long begins: those at its start, and of a state that begins at 0 no less than a tiny part of what
    /// it comes to. The rate there may be all but 0, as before a switch. Where time is a variable the start has the initial time after the states.
    ///
    /// # Errors
    /// Those of the field.
    pub fn beginning(system: &TextSystem, start: &Vector, lasting: f64) -> Result<Self> {
        /// Of what a state comes to.
        const PART: f64 = 1e-8;
        let mut units = match system.is_timed() {
            true => Self::at_start_in_time(system, start, lasting)?,
            false => Self::at_start(system, start)?,
        };
        if start.iter().take(units.sizes.len()).all(|x| *x != 0.0) {
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
        // A logarithm says by itself how far its state has come.
        let plain = |i: usize| self.signs[i] == 0.0;
        let beyond = |i: usize| plain(i) && state[i].is_finite() && state[i].abs() > FAR;
        let states = 0..self.sizes.len();
        states.clone().any(beyond).then(|| {
            let larger = |i: usize| match plain(i) {
                true => self.sizes[i] * round(state[i].abs().max(1.0)),
                false => self.sizes[i],
            };
            MotionUnits {
                sizes: states.map(larger).collect(),
                ..self.clone()
            }
        })
    }

    /// The same where states have come to what doubles hardly hold, here in these units: those that have logarithms
    /// ([`TextSystem::have_logarithms`]) are followed by these. `None` where there are none such.
    pub fn sunken(&self, have_logarithms: &[bool], state: &[f64]) -> Option<Self> {
        let sinks = |i: usize| have_logarithms[i] && self.is_sunken(i, state[i]);
        self.in_logarithms(state, sinks)
    }

    /// Whether a state, here in its unit, is hardly above the least normal double.
    fn is_sunken(&self, state: usize, x: f64) -> bool {
        (x * self.sizes[state]).abs() < SUNKEN
    }

    /// The same with the logarithms of the states of `which` that are not 0; `None` where there are no more of these.
    pub fn in_logarithms(&self, state: &[f64], which: impl Fn(usize) -> bool) -> Option<Self> {
        let is_new = |i: usize| self.signs[i] == 0.0 && state[i] != 0.0 && which(i);
        let states = 0..self.sizes.len();
        if !states.clone().any(is_new) {
            return None;
        }
        let mut signs = self.signs.clone();
        for i in states.filter(|&i| is_new(i)) {
            signs[i] = state[i].signum();
        }
        Some(MotionUnits {
            signs,
            ..self.clone()
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
            signs: self.signs.clone(),
        };
        Ok(Some((end, measured)))
    }

    /// A run from here that lasts so long at most, in the field of these units; `None` where it fails.
    fn watched(&self, field: &AnyField<'_>, start: &Vector, lasting: f64) -> Result<Option<Seen>> {
        let (seen, end) = self.seen(field, start, lasting)?;
        Ok((end.is_ok() && seen.steps > 0).then_some(seen))
    }

    /// The same, failed or not, and how it ended.
    fn seen(
        &self,
        field: &AnyField<'_>,
        start: &Vector,
        lasting: f64,
    ) -> Result<(Seen, Result<Vector>)> {
        let tolerances = Tolerances::equal(ROUGH)?;
        let mut integrator = AnyIntegrator::new(Choice::Auto, tolerances, 2 * STEPS)?;
        let mut seen = Seen::of(start.len());
        let mut observer = |step: &AnyStep<'_>| Ok(seen.see(step));
        let span = (0.0, lasting);
        let end = integrator.flow(field, span, &self.inward(start), Some(&mut observer));
        Ok((seen, end))
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
            Error::NonFinite { t, .. } | Error::Underflow { t, .. } => *t *= time,
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
                    *x = self.outward_value(state, self.direction(state) * *x);
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
        let system = system.in_units(&self.sizes, self.time)?;
        if self.signs.iter().all(|sign| *sign == 0.0) {
            return Ok(system);
        }
        system.in_logarithms(&self.signs)?.ok_or_else(|| {
            Error::Input("the rate of a state over the state itself is not known".into())
        })
    }

    /// The field of a system in these units.
    ///
    /// # Errors
    /// Those of [`TextSystem::in_units`], and of the field.
    pub fn field(&self, system: &TextSystem) -> Result<AnyField<'static>> {
        AnyField::of_text(Cow::Owned(self.inward_system(system)?))
    }

    /// 1 where a state grows in the system's own units when it grows here, else -1.
    pub fn direction(&self, state: usize) -> f64 {
        if self.signs[state] < 0.0 { -1.0 } else { 1.0 }
    }

    /// The unit of a variable, and its sign where it is followed by its logarithm, else 0. After the states there may be time.
    fn of_variable(&self, i: usize) -> (f64, f64) {
        match self.sizes.get(i) {
            Some(&size) => (size, self.signs[i]),
            None => (self.time, 0.0),
        }
    }

    /// The value of a state in its unit here, or its logarithm.
    pub fn inward_value(&self, state: usize, x: f64) -> f64 {
        match self.of_variable(state) {
            (size, 0.0) => x / size,
            (size, sign) => (sign * (x / size)).ln(),
        }
    }

    /// The same in the system's own.
    pub fn outward_value(&self, state: usize, x: f64) -> f64 {
        match self.of_variable(state) {
            (size, 0.0) => size * x,
            (size, sign) => size * (sign * x.exp()),
        }
    }

    /// What the error of a value here makes of the value in the system's own unit.
    pub fn outward_error_of(&self, state: usize, x: f64, error: f64) -> f64 {
        match self.signs[state] {
            0.0 => error * self.sizes[state],
            // No less than the least double, which the value may be rounded to.
            _ => self.outward_value(state, x).abs() * error.exp_m1() + f64::from_bits(1),
        }
    }

    /// A state in these units.
    pub fn inward(&self, state: &Vector) -> Vector {
        Vector::from_fn(state.len(), |i, _| self.inward_value(i, state[i]))
    }

    /// The same state in other units, also where its value is below the doubles and only its logarithm is known.
    pub fn moved(&self, other: &Self, state: &[f64]) -> Vector {
        Vector::from_fn(state.len(), |i, _| {
            let ((here, sign), (there, new_sign)) = (self.of_variable(i), other.of_variable(i));
            match sign != 0.0 && sign == new_sign {
                true => state[i] + (here / there).ln(),
                false => other.inward_value(i, self.outward_value(i, state[i])),
            }
        })
    }

    /// A state in the system's own.
    pub fn outward(&self, state: &Vector) -> Vector {
        Vector::from_fn(state.len(), |i, _| self.outward_value(i, state[i]))
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

/// The fastest rate of a linearised system.
fn fastest(jacobian: &Matrix) -> f64 {
    let all = eigenvalues(jacobian);
    all.map_or(0.0, |all| all.iter().map(|z| z.norm()).fold(0.0, f64::max))
}

/// The size of every variable at the start; where it is 0, how far it moves in this time, at first or by what others then do to it. No number of
/// which that is known is 0 or none at all.
fn sizes_at_start(
    (field, jacobian): (&AnyField<'_>, &Matrix),
    start: &Vector,
    time: f64,
) -> Vector {
    let mut sizes = start.abs();
    let mut way = field.f(start) * time;
    for _ in 0..start.len() {
        for (size, way) in sizes.iter_mut().zip(&way) {
            if !size.is_normal() {
                *size = way.abs();
            }
        }
        way = jacobian * way * time;
    }
    sizes
}
