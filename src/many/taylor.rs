//! Taylor's method for all interfaces at once.

use super::block::{
    Advance, Block, Extent, LANES, LastTerms, Look, MOST, NextOrder, larger, of, vectorised,
};
use super::interfaces::ManyInterfaces;
use crate::error::{Error, Result};
use crate::friction::positive;
use crate::number::{DoubleDouble, polynomial::evaluate};
use rayon::prelude::*;

/// Blocks whose slip rates are added up together: on this, and on nothing that differs from machine to machine, the digits of sums
/// depend.
pub(super) const CHUNK: usize = 64;
/// Interfaces from which on several cores pay.
pub(super) const MANY: usize = 8192;
/// The first unit of time: a step follows from it.
const FIRST: f64 = 1e-3;

/// Taylor's method with a tolerance relative to every state, and to 1 + |tau|.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ManyTaylor {
    tolerance: f64,
    max_steps: usize,
    order: usize,
}

impl ManyTaylor {
    /// # Errors
    /// [`Error::Parameter`] for a tolerance or a bound on steps that is not positive.
    pub fn new(tolerance: f64, max_steps: usize) -> Result<Self> {
        /// Orders that take the least time, by tolerance.
        const LOOSE: f64 = 1e-7;
        const MIDDLE: f64 = 1e-12;
        positive("rtol", tolerance)?;
        if max_steps == 0 {
            return Err(Error::parameter("max-steps", 0, "at least 1"));
        }
        let order = if tolerance > LOOSE {
            12
        } else if tolerance > MIDDLE {
            16
        } else {
            MOST
        };
        Ok(ManyTaylor {
            tolerance: tolerance.max(f64::EPSILON),
            max_steps,
            order,
        })
    }

    /// The order of its series.
    pub fn order(&self) -> usize {
        self.order
    }

    /// From (tau, psi of every interface) at time 0 on, until a time, or until the observer says `false`; it sees every step.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a stress or states that are not positive, or too few of these; [`Error::StepTooSmall`],
    /// [`Error::TooManySteps`]; those of the observer.
    pub fn flow<'a>(
        &self,
        interfaces: &'a ManyInterfaces,
        (stress, states): (f64, &[f64]),
        until: f64,
        observer: &mut dyn FnMut(&ManyStep<'_>) -> Result<bool>,
    ) -> Result<ManySolution<'a>> {
        positive("tau in `start`", stress)?;
        for &psi in states {
            positive("psi in `start`", psi)?;
        }
        if states.len() != interfaces.count {
            let must = format!("{}, one for each interface", interfaces.count);
            return Err(Error::parameter("the number of states", states.len(), must));
        }
        let mut solution = ManySolution {
            interfaces,
            blocks: interfaces.blocks(states),
            order: self.order,
            time: DoubleDouble::ZERO,
            stress: DoubleDouble::from(stress),
            series: [0.0; MOST + 1],
            rates: [0.0; MOST],
            unit: FIRST,
            steps: 0,
        };
        solution.series[0] = stress;
        while solution.time.hi() < until {
            if solution.steps == self.max_steps {
                return Err(Error::TooManySteps {
                    t: solution.time.hi(),
                    end: until,
                    limit: self.max_steps,
                });
            }
            let longest = solution.expanded(self.tolerance);
            let left = (DoubleDouble::from(until) - solution.time).hi();
            let ends = longest >= left;
            let length = if ends { left } else { longest };
            let begin = solution.time;
            let end = if ends {
                DoubleDouble::from(until)
            } else {
                begin + length
            };
            if !(length > 0.0 && end.hi() > begin.hi() || ends) {
                return Err(Error::StepTooSmall {
                    t: begin.hi(),
                    h: if length.is_nan() { 0.0 } else { length },
                });
            }
            let goes_on = observer(&ManyStep {
                solution: &solution,
                length,
                end: end.hi(),
            })?;
            solution.advance(length);
            solution.time = end;
            if !goes_on {
                break;
            }
        }
        Ok(solution)
    }
}

/// Where a flow is, with the series from there on.
#[derive(Debug, Clone)]
pub struct ManySolution<'a> {
    interfaces: &'a ManyInterfaces,
    blocks: Vec<Block>,
    order: usize,
    time: DoubleDouble,
    stress: DoubleDouble,
    /// Of tau, in `unit`.
    series: [f64; MOST + 1],
    /// Of the sum of all slip rates.
    rates: [f64; MOST],
    unit: f64,
    steps: usize,
}

impl ManySolution<'_> {
    /// The time reached.
    pub fn time(&self) -> f64 {
        self.time.hi()
    }

    /// tau there.
    pub fn stress(&self) -> f64 {
        self.stress.hi()
    }

    /// psi of an interface there.
    ///
    /// # Panics
    /// Where there are fewer interfaces.
    pub fn state(&self, interface: usize) -> f64 {
        let (block, lane) = (interface / LANES, interface % LANES);
        self.blocks[block].state(of(&self.interfaces.constants, block), lane)
    }

    /// Steps so far.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Makes the series from here on, in a unit of time in which they have doubles, and tells the longest step that the tolerance
    /// allows; not a number where there is no such unit.
    fn expanded(&mut self, tolerance: f64) -> f64 {
        /// A smaller unit, so often.
        const SMALLER: f64 = 1e-6;
        const TRIES: usize = 40;
        /// In a much longer step the last terms would have been smaller than any double.
        const LONGEST: f64 = 1e4;
        for _ in 0..TRIES {
            self.expand();
            let longest = self.longest(tolerance);
            if !longest.is_nan() {
                return longest.min(LONGEST * self.unit);
            }
            self.unit *= SMALLER;
        }
        f64::NAN
    }

    /// The series of all variables from here on.
    fn expand(&mut self) {
        let (mut activation, mut other) = ([0.0; MOST], [0.0; MOST]);
        let loading = self.interfaces.loading;
        for k in 0..self.order {
            // s = sinh tau, or e^tau, and its derivative in tau.
            let tau = self.series[0];
            if k == 0 {
                (activation[0], other[0]) = match self.interfaces.exponential {
                    true => (tau.exp(), tau.exp()),
                    false => (tau.sinh(), tau.cosh()),
                };
            } else {
                for j in 1..=k {
                    let slope = j as f64 * self.series[j] / k as f64;
                    activation[k] += slope * other[k - j];
                    if !self.interfaces.exponential {
                        other[k] += slope * activation[k - j];
                    }
                }
                if self.interfaces.exponential {
                    other[k] = activation[k];
                }
            }
            let total = self.total(&activation, k);
            self.rates[k] = total;
            let driving = if k == 0 { loading.driving } else { 0.0 };
            let rate = loading.stiffness * (driving - total);
            self.series[k + 1] = self.unit * rate / (k + 1) as f64;
        }
    }

    /// The sum of the k-th coefficients of all slip rates.
    fn total(&mut self, activation: &[f64; MOST], k: usize) -> f64 {
        let unit = self.unit;
        let constants = &self.interfaces.constants;
        let add = |(at, blocks): (usize, &mut [Block])| {
            vectorised(NextOrder {
                constants: chunk(constants, at, blocks.len()),
                blocks,
                activation,
                k,
                unit,
            })
        };
        if self.interfaces.count >= MANY {
            let chunks = self.blocks.par_chunks_mut(CHUNK).enumerate();
            let sums: Vec<f64> = chunks.map(add).collect();
            return sums.iter().sum();
        }
        self.blocks.chunks_mut(CHUNK).enumerate().map(add).sum()
    }

    /// The longest step that the tolerance allows, by the last two terms of all series (Jorba and Zou 2005).
    fn longest(&self, tolerance: f64) -> f64 {
        let order = self.order;
        let look = |blocks: &[Block]| vectorised(LastTerms { blocks, order });
        let both = |a: [f64; 2], b: [f64; 2]| [larger(a[0], b[0]), larger(a[1], b[1])];
        let most = if self.interfaces.count >= MANY {
            let chunks = self.blocks.par_chunks(CHUNK);
            chunks.map(look).reduce(|| [0.0; 2], both)
        } else {
            self.blocks.chunks(CHUNK).map(look).fold([0.0; 2], both)
        };
        let size = 1.0 + self.series[0].abs();
        let own = [order, order - 1].map(|k| self.series[k].abs() / size);
        let most = both(most, own);
        let of = |ratio: f64, order: usize| (tolerance / ratio).powf(1.0 / order as f64);
        let (last, before) = (of(most[0], order), of(most[1], order - 1));
        // Neither is a number where a series has overflowed.
        if last.is_nan() || before.is_nan() {
            return f64::NAN;
        }
        last.min(before) * self.unit
    }

    fn advance(&mut self, length: f64) {
        let (order, by) = (self.order, length / self.unit);
        let go = |blocks: &mut [Block]| vectorised(Advance { blocks, order, by });
        if self.interfaces.count >= MANY {
            self.blocks.par_chunks_mut(CHUNK).for_each(go);
        } else {
            self.blocks.chunks_mut(CHUNK).for_each(go);
        }
        let change = evaluate(&self.series[1..=order], by) * by;
        self.stress = self.stress + change;
        self.series[0] = self.stress.hi();
        if length > 0.0 {
            self.unit = length;
        }
        self.steps += 1;
    }
}

/// The constants of the blocks of a chunk: one for all, or each its own.
fn chunk<T>(all: &[T], at: usize, count: usize) -> &[T] {
    match all {
        [_] => all,
        _ => &all[at * CHUNK..][..count],
    }
}

/// A step, from its beginning to its end.
pub struct ManyStep<'a> {
    solution: &'a ManySolution<'a>,
    length: f64,
    end: f64,
}

impl ManyStep<'_> {
    /// The time at its beginning.
    pub fn begin(&self) -> f64 {
        self.solution.time.hi()
    }

    /// The time at its end.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// The series of all interfaces.
    pub(super) fn blocks(&self) -> &[Block] {
        &self.solution.blocks
    }

    /// The order of the series, and the length of the step in their unit.
    pub(super) fn expanded(&self) -> (usize, f64) {
        (self.solution.order, self.length / self.solution.unit)
    }

    /// The unit of time of the series.
    pub(super) fn unit(&self) -> f64 {
        self.solution.unit
    }

    /// The series of the sum of all slip rates.
    pub(super) fn total_rates(&self) -> &[f64] {
        &self.solution.rates[..self.solution.order]
    }

    /// The time and tau so many units after the beginning.
    pub(super) fn moment(&self, units: f64) -> (DoubleDouble, f64) {
        let solution = self.solution;
        let change = evaluate(&solution.series[1..=solution.order], units) * units;
        let time = solution.time + units * solution.unit;
        (time, (solution.stress + change).hi())
    }

    /// How many units a time is after the beginning.
    fn units(&self, time: f64) -> f64 {
        let since = if time == self.end {
            self.length
        } else {
            (DoubleDouble::from(time) - self.solution.time).hi()
        };
        since / self.solution.unit
    }

    /// tau at a time of the step.
    pub fn stress(&self, time: f64) -> f64 {
        let series = &self.solution.series[1..=self.solution.order];
        let units = self.units(time);
        (self.solution.stress + evaluate(series, units) * units).hi()
    }

    /// s(tau) without its factor.
    fn activation(&self, time: f64) -> f64 {
        let tau = self.stress(time);
        match self.solution.interfaces.exponential {
            true => tau.exp(),
            false => tau.sinh(),
        }
    }

    /// What all interfaces do at a time of the step; `sliding` counts those that are faster than this.
    pub fn extent(&self, time: f64, faster_than: f64) -> Extent {
        let solution = self.solution;
        let (later, activation) = (self.units(time), self.activation(time));
        let constants = &solution.interfaces.constants;
        let look = |(at, blocks): (usize, &[Block])| {
            vectorised(Look {
                constants: chunk(constants, at, blocks.len()),
                blocks,
                order: solution.order,
                later,
                activation,
                faster_than,
            })
        };
        let all: Vec<Extent> = if solution.interfaces.count >= MANY {
            let chunks = solution.blocks.par_chunks(CHUNK).enumerate();
            chunks.map(look).collect()
        } else {
            solution
                .blocks
                .chunks(CHUNK)
                .enumerate()
                .map(look)
                .collect()
        };
        all.into_iter().fold(Extent::NONE, Extent::and)
    }

    /// psi and v of an interface at a time of the step.
    ///
    /// # Panics
    /// Where there are fewer interfaces, as the next.
    pub fn interface(&self, interface: usize, time: f64) -> [f64; 2] {
        let (at, lane) = (interface / LANES, interface % LANES);
        let block = &self.solution.blocks[at];
        let of = of(&self.solution.interfaces.constants, at);
        let later = self.units(time);
        let terms = block.strength[..=self.solution.order].iter().rev();
        let strength = terms.fold(0.0, |sum, term| sum * later + term[lane]);
        let psi = (strength - of.rest[lane]) / of.slope[lane];
        let v = self.activation(time) * of.factor[lane] * strength.powf(-of.beta[lane]);
        [psi, v]
    }

    /// How far an interface slips from the beginning of the step to a time of it.
    pub fn slip(&self, interface: usize, time: f64) -> f64 {
        let (at, lane) = (interface / LANES, interface % LANES);
        let rates = &self.solution.blocks[at].rate[..self.solution.order];
        self.integral(rates.iter().map(|rate| rate[lane]), time)
    }

    /// The same of all together.
    pub fn slip_of_all(&self, time: f64) -> f64 {
        let rates = &self.solution.rates[..self.solution.order];
        self.integral(rates.iter().copied(), time)
    }

    /// The integral of a series, term by term.
    fn integral(
        &self,
        series: impl DoubleEndedIterator<Item = f64> + ExactSizeIterator,
        time: f64,
    ) -> f64 {
        let later = self.units(time);
        let terms = series.enumerate().rev();
        let mean = terms.fold(0.0, |sum, (k, term)| sum * later + term / (k + 1) as f64);
        mean * later * self.solution.unit
    }
}
