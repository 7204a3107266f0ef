//! What runs settle on at points of a grid.

use super::start::{Point, point};
use super::{Row, Settings};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::field::State;
use crate::integrate::{Control, Taylor, Tolerances};
use crate::model::two_interfaces;
use crate::number::polynomial::Crossing;
use crate::section::{
    Ended, Record, Regime, Return, Surface, Watching, at_equilibrium, half_driving_stress, record,
    verdict,
};

/// Computes rows; one for each thread.
pub struct Sweeper {
    settings: Settings,
    taylor: Taylor,
}

impl Sweeper {
    /// # Errors
    /// Those of [`Settings::checked`].
    pub fn new(settings: &Settings) -> Result<Self> {
        settings.checked()?;
        Ok(Sweeper {
            settings: settings.clone(),
            taylor: Taylor::new(Tolerances::equal(settings.rtol)?, settings.max_steps)?,
        })
    }

    /// Appends the rows of these units, in their order.
    pub fn rows(&mut self, units: impl IntoIterator<Item = usize>, out: &mut Vec<Row>) {
        let each = self.settings.points_per_unit();
        for unit in units {
            let mut last: Vec<Option<State<3>>> = vec![None; self.settings.starts];
            for number in unit * each..(unit + 1) * each {
                let mut point = point(&self.settings, number);
                let of_start = &mut last[number % self.settings.starts];
                if let (true, Some(state)) = (self.settings.follow, *of_start) {
                    point.start = state;
                }
                let (row, end) = self.row(&point);
                *of_start = end;
                out.push(row);
            }
        }
    }

    fn row(&mut self, point: &Point) -> (Row, Option<State<3>>) {
        let Settings {
            law,
            rtol,
            max_returns,
            ..
        } = self.settings;
        let field = two_interfaces(law, point.loading);
        let tau = half_driving_stress(&law, point.loading.driving, 2);
        let surface = Surface::<3>::stress(tau, Crossing::Downwards);
        let skip = max_returns / 2;
        let watching = Watching {
            skip,
            returns: max_returns - skip,
            patience: 1e4 + 1e3 / (point.loading.stiffness * point.loading.driving),
            accuracy: rtol,
            waypoints: false,
        };
        let see = &mut |_: usize, _: Option<&Return<3>>| Control::Continue;
        let found = record(
            &mut self.taylor,
            &*field,
            &point.start,
            &surface,
            &watching,
            see,
        );
        let mut row = Row {
            number: point.number,
            driving: point.loading.driving,
            stiffness: point.loading.stiffness,
            start: point.start.into(),
            regime: Regime::Undecided,
            symmetry: None,
            returns_per_period: None,
            period: None,
            stress_range: None,
            lyapunov_max: None,
            returns: found.returns.len(),
            note: None,
        };
        let end = ended(&found);
        match &found.ended {
            Ended::Failed(error) => row.note = Some(error.to_string()),
            Ended::Steady { equilibrium, .. } => {
                row.regime = Regime::Steady;
                row.symmetry = Some(symmetry(equilibrium));
                row.stress_range = Some((equilibrium[0], equilibrium[0]));
                row.lyapunov_max = Some(at_equilibrium(&*field, equilibrium)[0]);
            }
            _ => match verdict(&*field, &surface, &found, None) {
                Err(error) => row.note = Some(error.to_string()),
                Ok(verdict) => {
                    row.regime = verdict.regime;
                    row.note = verdict.why.map(str::to_owned);
                    if let Some(periodic) = verdict.periodic {
                        row.symmetry = Some(symmetry(&periodic.point));
                        row.returns_per_period = Some(periodic.returns);
                        row.period = Some(periodic.period.value);
                    }
                }
            },
        }
        (row, end)
    }
}

/// Where a run came to.
fn ended(record: &Record<3>) -> Option<State<3>> {
    match &record.ended {
        Ended::Steady { equilibrium, .. } => Some(*equilibrium),
        _ => record.returns.last().map(|at| at.state),
    }
}

fn symmetry(y: &State<3>) -> Symmetry {
    if (y[1] - y[2]).abs() < 1e-6 {
        Symmetry::Symmetric
    } else {
        Symmetry::Asymmetric
    }
}
