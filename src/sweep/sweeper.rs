//! The computation of the rows of a sweep.

use super::classify::{Classifier, Settled, undecided};
use super::flows::Leg;
use super::start::{missing, point};
use super::watch::SweepRun;
use super::{SweepRow, SweepSettings};
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::integrate::AnyStep;
use std::rc::Rc;

/// Computes rows; one for each thread. Its buffers grow to what a chunk of points needs, and nothing is allocated from step to
/// step.
///
/// ```
/// use twinslip::friction::{AnyLaw, Parameters};
/// use twinslip::section::Regime;
/// use twinslip::sweep::{Grid, Range, Sweeper, SweepSettings};
/// # fn main() -> twinslip::Result<()> {
/// let settings = SweepSettings {
///     grid: Grid::Plane {
///         law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
///         driving: Range::parse("driving", "0.05:0.07:2")?,
///         stiffness: Range::parse("stiffness", "0.14:0.14:1")?,
///     },
///     starts: 1,
///     seed: 0,
///     follow: false,
///     rtol: 1e-9,
///     lyapunov: false,
///     diagram: None,
///     max_returns: 2000,
///     max_steps: 10_000_000,
/// };
/// let mut rows = Vec::new();
/// Sweeper::new(&settings)?.rows(0..settings.units(), &mut rows);
/// // The Hopf point of the asymmetric steady state lies at V_H = 0.06304.
/// assert_eq!(rows[0].regime, Regime::Steady);
/// assert_eq!(rows[1].regime, Regime::Periodic);
/// # Ok(())
/// # }
/// ```
pub struct Sweeper(Classifier);

/// A run that is followed, or the row of a point that there is not.
type Begun = std::result::Result<SweepRun, Box<Settled>>;

impl Sweeper {
    /// # Errors
    /// Those of [`SweepSettings::checked`].
    pub fn new(settings: &SweepSettings) -> Result<Self> {
        settings.checked()?;
        Ok(Sweeper(Classifier::new(settings)?))
    }

    /// One that takes its runs one after the other, without lanes: to measure these by. Its rows differ by rounding.
    ///
    /// # Errors
    /// Those of [`Sweeper::new`].
    pub fn one_by_one(settings: &SweepSettings) -> Result<Self> {
        let mut sweeper = Self::new(settings)?;
        sweeper.0.flows.without_lanes();
        Ok(sweeper)
    }

    /// Appends the rows of these units, in their order. A point that fails is a row too, undecided, with its reason.
    pub fn rows(&mut self, units: impl IntoIterator<Item = usize>, out: &mut Vec<SweepRow>) {
        let units: Vec<usize> = units.into_iter().collect();
        if self.0.settings.follow {
            self.lines(&units, out);
            return;
        }
        let begun = units.iter().map(|&unit| self.begin(unit, None)).collect();
        out.extend(self.settle(begun).into_iter().map(|told| told.row));
    }

    /// Lines of points that follow one another, side by side.
    fn lines(&mut self, lines: &[usize], out: &mut Vec<SweepRow>) {
        let settings = &self.0.settings;
        let (starts, each) = (settings.starts, settings.points_per_unit());
        let mut attractors: Vec<Option<Vector>> = vec![None; lines.len() * starts];
        let mut columns: Vec<Vec<SweepRow>> = Vec::new();
        for column in (0..each).step_by(starts) {
            let numbers = lines
                .iter()
                .flat_map(|line| (0..starts).map(move |s| line * each + column + s));
            let begun = numbers.zip(attractors);
            let begun = begun.map(|(number, before)| self.begin(number, before));
            let begun = begun.collect();
            let (rows, after) = self
                .settle(begun)
                .into_iter()
                .map(|told| (told.row, told.attractor))
                .unzip();
            columns.push(rows);
            attractors = after;
        }
        for l in 0..lines.len() {
            for column in &columns {
                out.extend_from_slice(&column[l * starts..(l + 1) * starts]);
            }
        }
    }

    /// The run of a point, which starts on the attractor of the point before where there is one.
    fn begin(&self, number: usize, before: Option<Vector>) -> Begun {
        let settings = &self.0.settings;
        let mut point = point(settings, number).map_err(|error| {
            Box::new(Settled {
                row: missing(settings, number, error.to_string()),
                attractor: None,
                rest: None,
            })
        })?;
        if let Some(before) = before {
            point.start = point.units.inward(&before);
        }
        let start = point.units.outward(&point.start);
        let row = SweepRow {
            start: start.as_slice().to_vec(),
            note: None,
            ..missing(settings, number, String::new())
        };
        Ok(SweepRun::new(point, row, settings))
    }

    /// The regimes of these runs: all go on side by side until each is to be classified, and those that are not settled then go round again.
    fn settle(&mut self, begun: Vec<Begun>) -> Vec<Settled> {
        let mut told = Vec::with_capacity(begun.len());
        let (mut runs, mut active) = (Vec::new(), Vec::new());
        for (place, run) in begun.into_iter().enumerate() {
            told.push(match run {
                Err(missing) => Some(*missing),
                Ok(mut run) => {
                    let failed = self.0.pass_transient(&mut run).err();
                    let failed = failed.map(|error| undecided(&run, run.in_words(error)));
                    if failed.is_none() {
                        active.push(runs.len());
                    }
                    let failed = failed.map(|told| told.outward(&run));
                    runs.push((place, run));
                    failed
                }
            });
        }
        while !active.is_empty() {
            let failed = self.advance(&mut runs, &active);
            let mut failed = failed.into_iter();
            active.retain(|&i| {
                let (place, run) = &mut runs[i];
                let settled = match failed.next().flatten() {
                    Some(_) if run.leaps_back() => None,
                    Some(error) => Some(undecided(run, run.in_words(error))),
                    None => self.0.classify(run),
                };
                let settled = settled.map(|mut settled| {
                    settled.row.dots = self.0.dots(run, &settled);
                    settled.outward(run)
                });
                let goes_on = settled.is_none();
                told[*place] = settled;
                goes_on
            });
        }
        told.into_iter().flatten().collect()
    }

    /// Takes the runs to where they are to be classified; what failed.
    fn advance(&mut self, runs: &mut [(usize, SweepRun)], active: &[usize]) -> Vec<Option<Error>> {
        let leg = |&i: &usize| {
            let run = &runs[i].1;
            let (now, end) = run.span();
            // A run that has ended at its start has no way to go.
            let is_over = run.recorder.ended.is_some() || run.hopeless.is_some();
            Leg {
                field: Rc::clone(&run.field),
                lane: run.lane,
                start: run.state.clone(),
                t: (now, if is_over { now } else { end }),
            }
        };
        let legs: Vec<Leg> = active.iter().map(leg).collect();
        let mut observer = |k: usize, step: &AnyStep<'_>| runs[active[k]].1.step(step);
        let ends = self.0.flows.flow(&legs, &mut observer);
        for (leg, &i) in legs.iter().zip(active) {
            runs[i].1.end_leg(leg.t.1);
        }
        ends.into_iter().map(Result::err).collect()
    }
}
