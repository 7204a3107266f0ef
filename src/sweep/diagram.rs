//! What a bifurcation diagram by brute force shows of a run: the values that a variable comes back to on the attractor.

use super::classify::{Classifier, Settled};
use super::watch::SweepRun;
use crate::field::Vector;
use crate::integrate::{AnyStep, Control};
use crate::number::polynomial::Crossing;
use crate::section::Regime;
use crate::series::{Section, Zeros};

/// Values of a run that does not repeat, at most.
const MOST: usize = 200;
/// Steps in which they are looked for.
const STEPS: usize = 200_000;
/// Of a period: what comes back so late is the first value once more.
const ONCE: f64 = 1.0 - 1e-6;

impl Classifier {
    /// The values of a variable that a settled run comes back to, in the system's own units: its local maxima, or under a forcing its values at
    /// the phase 0. A periodic run has those of one period, a steady one its value, any other run some hundreds. Where the run fails they end.
    pub(super) fn dots(&mut self, run: &SweepRun, told: &Settled) -> Vec<f64> {
        let Some(variable) = self.settings.diagram else {
            return Vec::new();
        };
        let outward = |y: &[f64]| run.units.outward(&Vector::from_column_slice(y))[variable];
        if told.row.regime == Regime::Steady {
            return told.rest.iter().map(|y| outward(y.as_slice())).collect();
        }
        let start = told.attractor.as_ref().unwrap_or_else(|| run.last());
        let (until, most) = match told.row.period {
            Some(period) => (period * ONCE, usize::MAX),
            None => (f64::INFINITY, MOST),
        };
        match run.field.forcing_period() {
            Some(period) => {
                let count = told.row.returns_per_period.unwrap_or(MOST);
                self.once_a_period(run, start, (period, count), &outward)
            }
            None => self.maxima(run, start, (variable, until, most), &outward),
        }
    }

    fn once_a_period(
        &mut self,
        run: &SweepRun,
        start: &Vector,
        (period, count): (f64, usize),
        outward: &dyn Fn(&[f64]) -> f64,
    ) -> Vec<f64> {
        let mut here = start.clone();
        let mut dots = Vec::with_capacity(count);
        while dots.len() < count {
            dots.push(outward(here.as_slice()));
            match self
                .flows
                .one()
                .flow(&run.field, (0.0, period), &here, None)
            {
                Ok(there) => here = run.field.turned(there, start),
                Err(_) => break,
            }
        }
        dots
    }

    fn maxima(
        &mut self,
        run: &SweepRun,
        start: &Vector,
        (variable, until, most): (usize, f64, usize),
        outward: &dyn Fn(&[f64]) -> f64,
    ) -> Vec<f64> {
        let mut normal = vec![0.0; start.len()];
        normal[variable] = 1.0;
        let section = Section::Extremum { normal: &normal };
        let (mut zeros, mut found) = (Zeros::default(), Vec::new());
        let (mut dots, mut steps) = (Vec::new(), 0);
        let mut see = |step: &AnyStep<'_>| {
            steps += 1;
            if let Some(series) = step.series() {
                found.clear();
                series.crossings(section, Some(Crossing::Downwards), &mut zeros, &mut found);
                dots.extend(found.iter().map(|passage| outward(&passage.state)));
            }
            let goes_on = dots.len() < most && steps < STEPS;
            Ok(if goes_on {
                Control::Continue
            } else {
                Control::Stop
            })
        };
        // A run without an end ends by the number of its values.
        let end = until
            .min(1e3 * most.min(MOST) as f64 * run.watching.patience)
            .min(f64::MAX);
        let _ = self
            .flows
            .one()
            .flow(&run.field, (0.0, end), start, Some(&mut see));
        dots.truncate(most);
        dots
    }
}
