//! Taylor's method for all interfaces at once.

use super::block::{
    Advance, Extent, LastTerms, Layout, Look, MOST, NextOrder, Shared, larger, look_at,
};
use super::constants::{Constants, LANES, Lanes, of};
use super::interfaces::ManyInterfaces;
use super::share::CHUNK;
use super::step::{Beginning, Looking, ManyObserver, ManyStep, Saved};
use super::vectors::Vectorised;
use crate::error::{Error, Result};
use crate::friction::positive;
use crate::number::{DoubleDouble, polynomial::evaluate};
use rayon::prelude::*;

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

    /// Bytes that a run takes, without rows.
    pub fn memory(&self, interfaces: &ManyInterfaces) -> usize {
        let layout = Layout {
            order: self.order,
            kind: interfaces.kind,
        };
        let rows = interfaces.blocks() * layout.rows() * size_of::<Lanes>();
        rows + interfaces.constants_memory() + interfaces.share.held().len() * size_of::<f64>()
    }

    /// The order of its series.
    pub fn order(&self) -> usize {
        self.order
    }

    /// From (tau, psi of every interface that is held here) at time 0 on, until a time, or until the observer says `false`; it sees every
    /// step.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a stress or states that are not positive, or too few of these; [`Error::StepTooSmall`],
    /// [`Error::TooManySteps`]; those of the observer.
    pub fn flow<'a>(
        &self,
        interfaces: &'a ManyInterfaces,
        (stress, states): (f64, &[f64]),
        until: f64,
        observer: &mut dyn FnMut(&dyn ManyStep) -> Result<bool>,
    ) -> Result<ManySolution<'a>> {
        let beginning = Beginning::Start(stress, states);
        self.run(interfaces, beginning, until, &mut Looking(observer))
    }

    /// The same from any beginning on, with all that an observer may see.
    ///
    /// # Errors
    /// As [`ManyTaylor::flow`].
    pub fn run<'a>(
        &self,
        interfaces: &'a ManyInterfaces,
        beginning: Beginning<'_>,
        until: f64,
        observer: &mut dyn ManyObserver,
    ) -> Result<ManySolution<'a>> {
        let mut solution = self.begun(interfaces, beginning)?;
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
            let goes_on = observer.step(&TaylorStep {
                solution: &solution,
                length,
                end: end.hi(),
            })?;
            solution.advance(length);
            solution.time = end;
            if observer
                .save_every()
                .is_some_and(|every| solution.steps.is_multiple_of(every))
            {
                observer.save(solution.saved())?;
            }
            if !goes_on {
                break;
            }
        }
        Ok(solution)
    }

    fn begun<'a>(
        &self,
        interfaces: &'a ManyInterfaces,
        beginning: Beginning<'_>,
    ) -> Result<ManySolution<'a>> {
        let layout = Layout {
            order: self.order,
            kind: interfaces.kind,
        };
        let mut solution = ManySolution {
            interfaces,
            rows: vec![[0.0; LANES]; layout.rows() * interfaces.blocks()],
            layout,
            time: DoubleDouble::ZERO,
            stress: DoubleDouble::ZERO,
            series: [0.0; MOST + 1],
            rates: [0.0; MOST],
            unit: FIRST,
            steps: 0,
            sums: Vec::new(),
        };
        match beginning {
            Beginning::Start(stress, states) => {
                interfaces.checked(stress, states)?;
                solution.stress = DoubleDouble::from(stress);
                solution.put(states, |of, psi, lane| of.strength(layout.kind, psi, lane));
            }
            Beginning::Saved(saved) => {
                let &[high, low, unit] = &saved.shared[..] else {
                    return Err(Error::Input("what was saved is of another method".into()));
                };
                solution.stress = DoubleDouble::new(high, low);
                solution.unit = unit;
                solution.time = DoubleDouble::new(saved.time[0], saved.time[1]);
                solution.steps = saved.steps;
                solution.put(&saved.held, |_, strength, _| strength);
            }
        }
        solution.series[0] = solution.stress.hi();
        Ok(solution)
    }
}

/// Where a flow is, with the series from there on.
#[derive(Debug, Clone)]
pub struct ManySolution<'a> {
    interfaces: &'a ManyInterfaces,
    /// Of every block those that its layout says.
    rows: Vec<Lanes>,
    layout: Layout,
    time: DoubleDouble,
    stress: DoubleDouble,
    /// Of tau, in `unit`.
    series: [f64; MOST + 1],
    /// Of the sum of all slip rates.
    rates: [f64; MOST],
    unit: f64,
    steps: usize,
    /// Of the chunks, while an order is made.
    sums: Vec<f64>,
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

    /// psi there of an interface that is held here.
    ///
    /// # Panics
    /// Where it is not.
    pub fn state(&self, interface: usize) -> f64 {
        let (block, lane) = self.place(interface);
        let rows = self.block(block);
        of(&self.interfaces.constants, block).state(self.layout.kind, rows[0][lane], lane)
    }

    /// Steps so far.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Makes strengths of a number of every interface held here.
    fn put(&mut self, held: &[f64], strength: impl Fn(&Constants, f64, usize) -> f64) {
        let rows = self.layout.rows();
        for (i, held) in held.chunks(LANES).enumerate() {
            let of = of(&self.interfaces.constants, i);
            self.rows[i * rows] =
                std::array::from_fn(|lane| strength(of, held[lane.min(held.len() - 1)], lane));
        }
    }

    /// What the run needs to go on.
    fn saved(&self) -> Saved {
        let strengths = self.rows.iter().step_by(self.layout.rows()).flatten();
        let held = self.interfaces.share.held().len();
        Saved {
            time: [self.time.hi(), self.time.lo()],
            steps: self.steps,
            shared: vec![self.stress.hi(), self.stress.lo(), self.unit],
            held: strengths.take(held).copied().collect(),
        }
    }

    /// The block and the lane of an interface.
    fn place(&self, interface: usize) -> (usize, usize) {
        let here = interface - self.interfaces.share.held().start;
        (here / LANES, here % LANES)
    }

    fn block(&self, block: usize) -> &[Lanes] {
        let rows = self.layout.rows();
        &self.rows[block * rows..][..rows]
    }

    /// The rows of a chunk.
    fn chunk(&self, chunk: usize) -> &[Lanes] {
        let rows = CHUNK * self.layout.rows();
        let begin = chunk * rows;
        &self.rows[begin..self.rows.len().min(begin + rows)]
    }

    /// Works on the rows of every chunk, with its number.
    fn on_chunks<T: Send>(
        &mut self,
        made: &mut Vec<T>,
        work: impl Fn(usize, &mut [Lanes]) -> T + Send + Sync,
    ) {
        let rows = CHUNK * self.layout.rows();
        let each = |(chunk, rows): (usize, &mut [Lanes])| work(chunk, rows);
        if self.interfaces.share.is_large() {
            let chunks = self.rows.par_chunks_mut(rows).enumerate();
            chunks.map(each).collect_into_vec(made);
        } else {
            made.clear();
            made.extend(self.rows.chunks_mut(rows).enumerate().map(each));
        }
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
        let interfaces = self.interfaces;
        let (loading, kind) = (interfaces.loading, self.layout.kind);
        for k in 0..self.layout.order {
            // s = sinh tau, or e^tau, and its derivative in tau.
            let tau = self.series[0];
            if k == 0 {
                (activation[0], other[0]) = match kind.exponential {
                    true => (tau.exp(), tau.exp()),
                    false => (tau.sinh(), tau.cosh()),
                };
            } else {
                for j in 1..=k {
                    let slope = j as f64 * self.series[j] / k as f64;
                    activation[k] += slope * other[k - j];
                    if !kind.exponential {
                        other[k] += slope * activation[k - j];
                    }
                }
                if kind.exponential {
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
        let (layout, interfaces) = (self.layout, self.interfaces);
        let stress = self.series;
        let shared = Shared {
            stress: &stress,
            activation,
            unit: self.unit,
        };
        let mut sums = std::mem::take(&mut self.sums);
        self.on_chunks(&mut sums, |at, blocks| {
            NextOrder {
                constants: chunk(&interfaces.constants, at),
                blocks,
                layout,
                shared,
                k,
            }
            .vectorised()
        });
        let total = interfaces.share.sum(&sums);
        self.sums = sums;
        total
    }

    /// The longest step that the tolerance allows, by the last two terms of all series (Jorba and Zou 2005).
    fn longest(&self, tolerance: f64) -> f64 {
        let layout = self.layout;
        let order = layout.order;
        let share = &self.interfaces.share;
        let both = |a: [f64; 2], b: [f64; 2]| [larger(a[0], b[0]), larger(a[1], b[1])];
        let of_chunks = share.by_chunks(|at| {
            let blocks = self.chunk(at);
            LastTerms { blocks, layout }.vectorised()
        });
        let most = share.largest(of_chunks.into_iter().fold([0.0; 2], both));
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
        let (layout, by) = (self.layout, length / self.unit);
        self.on_chunks(&mut Vec::new(), |_, blocks| {
            Advance { blocks, layout, by }.vectorised();
        });
        let change = evaluate(&self.series[1..=layout.order], by) * by;
        self.stress = self.stress + change;
        self.series[0] = self.stress.hi();
        if length > 0.0 {
            self.unit = length;
        }
        self.steps += 1;
    }
}

/// The constants of the blocks of a chunk: one for all, or each its own.
fn chunk(all: &[Constants], chunk: usize) -> &[Constants] {
    match all {
        [_] => all,
        _ => &all[chunk * CHUNK..],
    }
}

/// A step by the series at its beginning.
struct TaylorStep<'a> {
    solution: &'a ManySolution<'a>,
    length: f64,
    end: f64,
}

/// The power series of a step, at its beginning.
#[derive(Debug, Clone, Copy)]
pub struct StepSeries<'a> {
    solution: &'a ManySolution<'a>,
    length: f64,
}

impl<'a> StepSeries<'a> {
    /// The rows of all blocks, and which these are.
    pub(super) fn rows(&self) -> (&'a [Lanes], Layout) {
        (&self.solution.rows, self.solution.layout)
    }

    /// The length of the step in the unit of the series.
    pub(super) fn length(&self) -> f64 {
        self.length / self.solution.unit
    }

    /// The unit of time of the series.
    pub(super) fn unit(&self) -> f64 {
        self.solution.unit
    }

    /// Of the sum of all slip rates.
    pub(super) fn total_rates(&self) -> &'a [f64] {
        &self.solution.rates[..self.solution.layout.order]
    }

    /// The time and tau so many units after the beginning.
    pub(super) fn moment(&self, units: f64) -> (DoubleDouble, f64) {
        let solution = self.solution;
        let change = evaluate(&solution.series[1..=solution.layout.order], units) * units;
        let time = solution.time + units * solution.unit;
        (time, (solution.stress + change).hi())
    }
}

impl TaylorStep<'_> {
    /// How many units a time is after the beginning.
    fn units(&self, time: f64) -> f64 {
        let since = if time == self.end {
            self.length
        } else {
            (DoubleDouble::from(time) - self.solution.time).hi()
        };
        since / self.solution.unit
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

impl ManyStep for TaylorStep<'_> {
    fn begin(&self) -> f64 {
        self.solution.time.hi()
    }

    fn end(&self) -> f64 {
        self.end
    }

    fn stress(&self, time: f64) -> f64 {
        let series = &self.solution.series[1..=self.solution.layout.order];
        let units = self.units(time);
        (self.solution.stress + evaluate(series, units) * units).hi()
    }

    fn extent(&self, time: f64, faster_than: f64) -> Extent {
        let solution = self.solution;
        let (later, stress) = (self.units(time), self.stress(time));
        let constants = &solution.interfaces.constants;
        let share = &solution.interfaces.share;
        let of_chunks = share.by_chunks(|at| {
            Look {
                constants: chunk(constants, at),
                blocks: solution.chunk(at),
                layout: solution.layout,
                later,
                stress,
                faster_than,
            }
            .vectorised()
        });
        share.extent(&of_chunks)
    }

    fn interface(&self, interface: usize, time: f64) -> [f64; 2] {
        let solution = self.solution;
        let (block, lane) = solution.place(interface);
        let of = of(&solution.interfaces.constants, block);
        let at = (self.units(time), self.stress(time));
        look_at((solution.block(block), solution.layout), (of, lane), at)
    }

    fn slip(&self, interface: usize, time: f64) -> f64 {
        let (block, lane) = self.solution.place(interface);
        let rates = self.solution.layout.rate(self.solution.block(block));
        self.integral(rates.iter().map(|rate| rate[lane]), time)
    }

    fn slip_of_all(&self, time: f64) -> f64 {
        let rates = &self.solution.rates[..self.solution.layout.order];
        self.integral(rates.iter().copied(), time)
    }

    fn series(&self) -> Option<StepSeries<'_>> {
        Some(StepSeries {
            solution: self.solution,
            length: self.length,
        })
    }
}
