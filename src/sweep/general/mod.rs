//! Maps of the regimes of any system, over any of its parameters: runs taken one by one, each until its verdict is open no more.
//!
//! What a run settles on is told as of two equal interfaces, but with less knowledge. Of a system from a file not even the scale of
//! time is known, nor where it swings: a transient, counted in steps, shows both.

mod attraction;
mod judge;
mod run;
mod transient;

use super::points::RandomStart;
use super::start::missing;
use super::{Grid, SweepRow, SweepSettings};
use crate::equilibrium::Enclosed;
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::{AnyField, AnyIntegrator, Choice, MAX_STEPS, MotionUnits, Tolerances};
use crate::section::{Regime, Surface};
use run::GeneralRun;
use std::fmt::Debug;

/// Systems by the values of the parameters that vary.
pub trait SystemPoints: Debug + Send + Sync {
    /// What rows tell of a point, dimensionless.
    fn parameters(&self, values: &[f64]) -> Vec<f64>;

    /// The system there, with the start of this number, from 0; random ones are made by the stream.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for values outside their domain, and what keeps the start from being found.
    fn at(&self, values: &[f64], start: usize, random: RandomStart) -> Result<SystemPoint>;
}

/// A system at a point of a grid, in the units in which it moves by about 1.
#[derive(Debug)]
pub struct SystemPoint {
    /// These units.
    pub units: MotionUnits,
    /// What moves.
    pub field: AnyField<'static>,
    /// Where its run starts.
    pub start: Vector,
    /// Which of its returns are recorded.
    pub section: SectionPlace,
    /// Whether the last two variables are of equal parts.
    pub equal_parts: bool,
    /// The same equations over boxes, where they are known: by these it is certain that a run has come to a stable equilibrium.
    pub enclosed: Option<Enclosure>,
}

/// Equations over boxes.
pub struct Enclosure(pub Box<dyn Enclosed + Send + Sync>);

impl Debug for Enclosure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Enclosure")
    }
}

/// Where the section of a run is.
#[derive(Debug, Clone, PartialEq)]
pub enum SectionPlace {
    /// At a place that is known, as is the longest time to wait for a return.
    Known(Surface, f64),
    /// At a place that is known, without a time to wait.
    Untimed(Surface),
    /// In the middle of what this variable swings through.
    Middle(usize),
}

impl SectionPlace {
    /// The same of a system in these units, which has no time of its own to wait.
    pub fn inward(self, units: &MotionUnits) -> Self {
        match self {
            SectionPlace::Untimed(mut surface) => {
                surface.offset /= units.sizes[surface.normal.iamax()];
                SectionPlace::Untimed(surface)
            }
            place => place,
        }
    }

    /// Where a variable, of so many, has a value and falls.
    pub fn at(variable: usize, dimension: usize, value: f64) -> Self {
        SectionPlace::Untimed(run::across(variable, dimension, value))
    }
}

/// What a point is found to settle on, and where the next one may start from it.
struct Settled {
    row: SweepRow,
    attractor: Option<Vector>,
}

impl Settled {
    /// The same in the system's own units; the section is in this variable. Words have them already.
    fn outward(mut self, units: &MotionUnits, variable: usize) -> Self {
        let size = units.sizes[variable];
        let row = &mut self.row;
        row.period = row.period.map(|period| period * units.time);
        row.range = row.range.map(|(low, high)| (low * size, high * size));
        row.lyapunov_max = row.lyapunov_max.map(|x| units.outward_rate(x));
        self.attractor = self.attractor.map(|state| units.outward(&state));
        self
    }
}

/// Computes rows of any system; its integrators are used over and over.
pub(super) struct GeneralSweeper {
    settings: SweepSettings,
    /// Of the runs, and of orbits.
    coarse: AnyIntegrator,
    fine: AnyIntegrator,
}

impl GeneralSweeper {
    pub fn new(settings: &SweepSettings) -> Result<Self> {
        let taylor = |tolerance: f64, max_steps: usize| {
            AnyIntegrator::new(Choice::Taylor, Tolerances::equal(tolerance)?, max_steps)
        };
        Ok(GeneralSweeper {
            settings: settings.clone(),
            coarse: taylor(settings.rtol, settings.max_steps)?,
            fine: taylor(super::orbit::TOLERANCE.min(settings.rtol), MAX_STEPS)?,
        })
    }

    pub fn rows(&mut self, units: &[usize], out: &mut Vec<SweepRow>) {
        let (starts, each) = (self.settings.starts, self.settings.points_per_unit());
        for unit in units {
            let mut attractors: Vec<Option<Vector>> = vec![None; starts];
            for place in 0..each {
                let before = &mut attractors[place % starts];
                let settled = self.point(unit * each + place, before.take());
                if self.settings.follow {
                    *before = settled.attractor;
                }
                out.push(settled.row);
            }
        }
    }

    /// What the run of a point settles on, which starts on the attractor of the point before where there is one.
    fn point(&mut self, number: usize, before: Option<Vector>) -> Settled {
        let settings = &self.settings;
        let Grid::Systems { at, .. } = &settings.grid else {
            unreachable!("equal interfaces have a sweeper of their own");
        };
        let values = settings.grid.values(settings.place(number));
        let random = RandomStart::new(settings.seed, number);
        match at.at(&values, number % settings.starts, random) {
            Err(error) => Settled {
                row: missing(settings, number, error.to_string()),
                attractor: None,
            },
            Ok(mut point) => {
                if let Some(before) = before {
                    point.start = point.units.inward(&before);
                }
                let start = point.units.outward(&point.start);
                let row = SweepRow::new(
                    number,
                    at.parameters(&values),
                    start.as_slice().to_vec(),
                    Regime::Undecided,
                );
                let run = GeneralRun::new(point, settings);
                let (units, variable) = (run.units.clone(), run.variable);
                self.settle(run, row).outward(&units, variable)
            }
        }
    }
}
