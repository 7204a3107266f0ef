//! What runs of two equal interfaces settle on at points of a grid: runs in lanes, classified one by one.

use super::classify::{Classified, Classifier, FIRST_STAGE, undecided};
use super::flows::Flows;
use super::start::{SweepStart, missing, point};
use super::watch::SweepRun;
use super::{Grid, SweepRow, SweepSettings};
use crate::error::Result;
use crate::field::State;
use crate::integrate::{BatchRun, Step};
use crate::section::{Regime, Watching};

/// The difference of the log states with which a run follows a symmetric steady state: from equal ones it would come to rest
/// where that is unstable.
const APART: f64 = 1e-4;

/// Computes rows of two equal interfaces.
pub(super) struct InterfaceSweeper {
    settings: SweepSettings,
    flows: Flows,
    classify: Classifier,
}

impl InterfaceSweeper {
    /// Lanes have one law: where it varies, runs are taken one after the other.
    pub fn new(settings: &SweepSettings) -> Result<Self> {
        let flows = match settings.grid {
            Grid::Laws { .. } => Flows::one_by_one,
            _ => Flows::lanes,
        };
        Ok(InterfaceSweeper {
            settings: settings.clone(),
            flows: flows(settings.law, settings.rtol, settings.max_steps)?,
            classify: Classifier::new(settings)?,
        })
    }

    pub fn take_one_by_one(&mut self) -> Result<()> {
        let SweepSettings {
            law,
            rtol,
            max_steps,
            ..
        } = self.settings;
        self.flows = Flows::one_by_one(law, rtol, max_steps)?;
        Ok(())
    }

    pub fn rows(&mut self, units: &[usize], out: &mut Vec<SweepRow>) {
        if self.settings.follow {
            self.lines(units, out);
            return;
        }
        let points = units.iter().map(|&unit| self.point(unit));
        let told = self.settle(points.collect());
        out.extend(told.into_iter().map(|told| told.row));
    }

    /// A point, or the row of one that there is not.
    fn point(&self, number: usize) -> std::result::Result<SweepStart, Box<Classified>> {
        point(&self.settings, number).map_err(|error| {
            Box::new(Classified {
                row: missing(&self.settings, number, error.to_string()),
                attractor: None,
            })
        })
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
                    let mut point = self.point(line * each + column + s);
                    if let (Ok(point), Some(state)) = (&mut point, attractors[l * starts + s]) {
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

    /// What the runs of these points settle on.
    fn settle(
        &mut self,
        points: Vec<std::result::Result<SweepStart, Box<Classified>>>,
    ) -> Vec<Classified> {
        if let Grid::Laws { .. } = self.settings.grid {
            let mut one = |point: SweepStart| {
                self.flows.set_law(point.law);
                self.settle_side_by_side(vec![point])
            };
            let told = points.into_iter();
            let told = told.flat_map(|point| point.map_or_else(|missing| vec![*missing], &mut one));
            return told.collect();
        }
        // Of one law there is a point everywhere.
        self.settle_side_by_side(points.into_iter().flatten().collect())
    }

    /// The same of one law: all go on side by side until each is to be judged, and those that are not settled then go round again.
    fn settle_side_by_side(&mut self, points: Vec<SweepStart>) -> Vec<Classified> {
        let settings = &self.settings;
        let watching = Watching {
            skip: 0,
            returns: settings.max_returns + 1,
            patience: 0.0,
            accuracy: settings.rtol,
            max_step: f64::INFINITY,
            waypoints: false,
        };
        let stage = FIRST_STAGE.min(settings.max_returns);
        let mut runs: Vec<SweepRun> = points
            .into_iter()
            .map(|point| SweepRun::new(point, watching, stage))
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
