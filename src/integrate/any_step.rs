//! The steps of a flow in any dimension, as an observer sees them.

use super::{Control, Step, since};
use crate::error::Result;
use crate::field::Vector;
use crate::number::{DoubleDouble, polynomial::Crossing};
use crate::series::{Expansion, Passage, Section, Zeros};

/// Sees every accepted step; an error from it ends the flow.
pub type AnyObserver<'a> = &'a mut dyn FnMut(&AnyStep<'_>) -> Result<Control>;

/// One accepted step in any dimension, as [`Step`].
#[non_exhaustive]
pub struct AnyStep<'a> {
    /// Time at the beginning.
    pub t0: f64,
    /// State at `t0`.
    pub y0: &'a [f64],
    /// Time at the end.
    pub t1: f64,
    /// State at `t1`.
    pub y1: &'a [f64],
    /// A bound on how far the first component strays from its value at `t0`, of methods to which it costs nothing; else
    /// infinity.
    pub reach: f64,
    /// `t0` in 31 digits. Steps may be shorter than the spacing of the doubles around `t0`.
    pub begin: DoubleDouble,
    /// The time from the beginning to the end, signed.
    pub length: f64,
    continuous: &'a dyn Fn(f64) -> Vector,
    series: &'a dyn Fn() -> Option<&'a dyn StepSeries>,
    slips: &'a dyn Fn() -> Option<[DoubleDouble; 2]>,
}

impl<'a> AnyStep<'a> {
    /// What `see` makes of a step of a field whose dimension the compiler knows, and so many of its components are variables.
    pub(crate) fn of<const N: usize, T>(
        step: &Step<'_, N>,
        variables: usize,
        see: impl FnOnce(&AnyStep<'_>) -> T,
    ) -> T {
        see(&AnyStep {
            t0: step.t0,
            y0: &step.y0.as_slice()[..variables],
            t1: step.t1,
            y1: &step.y1.as_slice()[..variables],
            reach: step.reach,
            begin: step.begin,
            length: step.length,
            continuous: &|time| {
                Vector::from_column_slice(&step.after(time).as_slice()[..variables])
            },
            series: &|| step.series().map(|series| series as &dyn StepSeries),
            slips: &|| step.slips(),
        })
    }

    /// The continuous solution so long after the beginning, from 0 to `length`.
    pub fn after(&self, time: f64) -> Vector {
        (self.continuous)(time)
    }

    /// The same at a time, as near to it as this step comes.
    pub fn dense(&self, t: f64) -> Vector {
        self.after(self.since_begin(t))
    }

    /// Between which numbers a time within the step is looked for, by [`AnyStep::at`]: times of the run, in which solvers may have their solutions, or where
    /// doubles have no room for them those since the beginning.
    pub(crate) fn room(&self) -> (f64, f64) {
        match self.is_short() {
            true => (0.0, self.length),
            false => (self.t0, self.t1),
        }
    }

    /// The continuous solution there, and how long after the beginning that is.
    pub(crate) fn at(&self, time: f64) -> (Vector, f64) {
        let after = match self.is_short() {
            true => time,
            false => self.since_begin(time),
        };
        (self.after(after), after)
    }

    /// Whether it is so short, in spacings of the doubles around it, that these are no places within it.
    fn is_short(&self) -> bool {
        const ROOM: f64 = 1e4;
        self.length.abs() < ROOM * f64::EPSILON * self.t0.abs().max(self.t1.abs())
    }

    /// As [`Step::since_begin`].
    pub fn since_begin(&self, t: f64) -> f64 {
        since((self.begin, self.t1, self.length), t)
    }

    /// As [`Step::slips`].
    pub fn slips(&self) -> Option<[DoubleDouble; 2]> {
        (self.slips)()
    }

    /// The series at `t0`, of methods that step by one.
    pub fn series(&self) -> Option<&'a dyn StepSeries> {
        (self.series)()
    }
}

/// The power series of a step in any dimension: an [`Expansion`].
pub trait StepSeries {
    /// The time of the beginning, in 31 digits.
    fn begin(&self) -> DoubleDouble;
    /// The time from the beginning of the step to its end.
    fn length(&self) -> f64;
    /// The unit of time.
    fn unit(&self) -> f64;
    /// The order to which the variables are known.
    fn order(&self) -> usize;
    /// The coefficients of the i-th variable, to the order.
    fn variable(&self, i: usize) -> &[f64];
    /// How many interfaces slide; two at least.
    fn sliding(&self) -> usize;
    /// The coefficients of the slip rate of an interface, to one order less; zero for fields without any.
    fn slip_rate(&self, interface: usize) -> &[f64];
    /// The slip of an interface up to a time after the beginning of the step ([`Expansion::slip`]).
    fn slip(&self, interface: usize, time: f64) -> f64;
    /// The state that these values of the variables stand for ([`Expansion::chart`]).
    fn state_of(&self, variables: &[f64]) -> Vector;
    /// Appends the zeros of a section within this step to `found` ([`Expansion::crossings`]).
    fn crossings(
        &self,
        section: Section<'_>,
        direction: Option<Crossing>,
        zeros: &mut Zeros,
        found: &mut Vec<Passage>,
    );
}

impl<const N: usize> StepSeries for Expansion<N> {
    fn begin(&self) -> DoubleDouble {
        self.begin
    }

    fn length(&self) -> f64 {
        self.length
    }

    fn unit(&self) -> f64 {
        self.unit
    }

    fn order(&self) -> usize {
        self.order
    }

    fn variable(&self, i: usize) -> &[f64] {
        &self.variables[i][..=self.order]
    }

    fn sliding(&self) -> usize {
        self.slip_rates.len()
    }

    fn slip_rate(&self, interface: usize) -> &[f64] {
        &self.slip_rates[interface][..self.order]
    }

    fn slip(&self, interface: usize, time: f64) -> f64 {
        self.slip(interface, time)
    }

    fn state_of(&self, variables: &[f64]) -> Vector {
        let all = std::array::from_fn(|i| variables.get(i).copied().unwrap_or_default());
        Vector::from_row_slice(&(self.chart)(all)[..variables.len()])
    }

    fn crossings(
        &self,
        section: Section<'_>,
        direction: Option<Crossing>,
        zeros: &mut Zeros,
        found: &mut Vec<Passage>,
    ) {
        self.crossings(section, direction, zeros, found);
    }
}
