//! What runs settle on at points of a grid: runs in lanes, classified one by one.

use super::classify::{Classified, Classifier, FIRST_STAGE, undecided};
use super::flows::Flows;
use super::start::{SweepStart, point};
use super::watch::SweepRun;
use super::{SweepRow, SweepSettings};
use crate::error::Result;
use crate::field::State;
use crate::integrate::{BatchRun, Step};
use crate::section::{Regime, Watching};

/// The difference of the log states with which a run follows a symmetric steady state: from equal ones it would come to rest
/// where that is unstable.
const APART: f64 = 1e-4;

/// Computes rows; one for each thread. Its buffers grow to what a chunk of points needs, and nothing is allocated from step to
/// step.
///
/// ```
/// use twinslip::friction::{AnyLaw, Parameters};
/// use twinslip::section::Regime;
/// use twinslip::sweep::{Grid, Range, Sweeper, SweepSettings};
/// # fn main() -> twinslip::Result<()> {
/// let settings = SweepSettings {
///     law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
///     grid: Grid::Plane {
///         driving: Range::parse("driving", "0.05:0.07:2")?,
///         stiffness: Range::parse("stiffness", "0.14:0.14:1")?,
///     },
///     starts: 1,
///     seed: 0,
///     follow: false,
///     rtol: 1e-9,
///     lyapunov: false,
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
pub struct Sweeper {
    settings: SweepSettings,
    flows: Flows,
    classify: Classifier,
}

impl Sweeper {
    /// # Errors
    /// Those of [`SweepSettings::checked`].
    pub fn new(settings: &SweepSettings) -> Result<Self> {
        settings.checked()?;
        Ok(Sweeper {
            settings: settings.clone(),
            flows: Flows::lanes(settings.law, settings.rtol, settings.max_steps)?,
            classify: Classifier::new(settings)?,
        })
    }

    /// One that takes its runs one after the other, without lanes: to measure these by. Its rows differ by rounding.
    ///
    /// # Errors
    /// Those of [`Sweeper::new`].
    pub fn one_by_one(settings: &SweepSettings) -> Result<Self> {
        Ok(Sweeper {
            flows: Flows::one_by_one(settings.law, settings.rtol, settings.max_steps)?,
            ..Self::new(settings)?
        })
    }

    /// Appends the rows of these units, in their order. A point that fails is a row too, undecided, with its reason.
    pub fn rows(&mut self, units: impl IntoIterator<Item = usize>, out: &mut Vec<SweepRow>) {
        let units: Vec<usize> = units.into_iter().collect();
        if self.settings.follow {
            self.lines(&units, out);
            return;
        }
        let points = units.iter().map(|&unit| point(&self.settings, unit));
        let told = self.settle(points.collect());
        out.extend(told.into_iter().map(|told| told.row));
    }

    /// Lines of points that follow one another, side by side.
    fn lines(&mut self, lines: &[usize], out: &mut Vec<SweepRow>) {
        let (starts, each) = (self.settings.starts, self.settings.points_per_unit());
        let mut attractors: Vec<Option<State<3>>> = vec![None; lines.len() * starts];
        let mut columns: Vec<Vec<Classified>> = Vec::new();
        for column in (0..each).step_by(starts) {
            let mut points = Vec::with_capacity(attractors.len());
            for (l, line) in lines.iter().enumerate() {
                for s in 0..starts {
                    let mut point = point(&self.settings, line * each + column + s);
                    if let Some(state) = attractors[l * starts + s] {
                        point.start = state;
                    }
                    points.push(point);
                }
            }
            let told = self.settle(points);
            for (attractor, told) in attractors.iter_mut().zip(&told) {
                *attractor = told.attractor;
                if let (Regime::Steady, Some(y)) = (told.row.regime, attractor)
                    && (y[2] - y[1]).abs() < APART
                {
                    y[2] = y[1] + APART;
                }
            }
            columns.push(told);
        }
        for l in 0..lines.len() {
            for column in &columns {
                let rows = column[l * starts..(l + 1) * starts].iter();
                out.extend(rows.map(|told| told.row.clone()));
            }
        }
    }

    /// What these points' runs settle on: all go on side by side until each is to be judged, and those that are not settled then go
    /// round again.
    fn settle(&mut self, points: Vec<SweepStart>) -> Vec<Classified> {
        let settings = &self.settings;
        let watching = Watching {
            skip: 0,
            returns: settings.max_returns + 1,
            patience: 0.0,
            accuracy: settings.rtol,
            waypoints: false,
        };
        let stage = FIRST_STAGE.min(settings.max_returns);
        let mut runs: Vec<SweepRun> = points
            .into_iter()
            .map(|point| SweepRun::new(settings.law, point, watching, stage))
            .collect();
        let mut told: Vec<Option<Classified>> = runs.iter().map(|_| None).collect();
        let mut active: Vec<usize> = (0..runs.len()).collect();
        loop {
            active.retain(|&i| told[i].is_none());
            if active.is_empty() {
                return told.into_iter().flatten().collect();
            }
            let failed = self.advance(&mut runs, &active);
            for (&i, failed) in active.iter().zip(failed) {
                told[i] = match failed {
                    Some(_) if runs[i].leaps_back() => None,
                    Some(why) => Some(undecided(&runs[i], why)),
                    None => self.classify.classify(&mut runs[i], &mut self.flows),
                };
            }
        }
    }

    /// Takes the runs to where they are to be judged; what failed, in words.
    fn advance(&mut self, runs: &mut [SweepRun], active: &[usize]) -> Vec<Option<String>> {
        // A run that has ended at its start has no way to go.
        let span = |run: &SweepRun| match run.recorder.ended {
            Some(_) => (run.time, run.time),
            None => (run.time, run.end()),
        };
        let way = |&i: &usize| BatchRun {
            loading: runs[i].point.loading,
            start: runs[i].state,
            t: span(&runs[i]),
        };
        let ways: Vec<BatchRun> = active.iter().map(way).collect();
        let mut observer = |k: usize, step: &Step<'_, 3>| runs[active[k]].step(step);
        let ends = self.flows.flow(&ways, &mut observer);
        let failed = ends.into_iter().map(Result::err);
        failed.map(|e| e.map(|e| e.to_string())).collect()
    }
}
