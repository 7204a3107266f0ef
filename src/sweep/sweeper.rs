//! What computes the rows of a sweep: a method of its own for two equal interfaces, another for all else.

use super::general::GeneralSweeper;
use super::interfaces::InterfaceSweeper;
use super::{Grid, SweepRow, SweepSettings};
use crate::error::Result;

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
pub struct Sweeper(Method);

enum Method {
    Interfaces(Box<InterfaceSweeper>),
    General(Box<GeneralSweeper>),
}

impl Sweeper {
    /// # Errors
    /// Those of [`SweepSettings::checked`].
    pub fn new(settings: &SweepSettings) -> Result<Self> {
        settings.checked()?;
        Ok(Sweeper(match settings.grid {
            Grid::Systems { .. } => Method::General(Box::new(GeneralSweeper::new(settings)?)),
            _ => Method::Interfaces(Box::new(InterfaceSweeper::new(settings)?)),
        }))
    }

    /// One that takes its runs one after the other, without lanes: to measure these by. Its rows differ by rounding.
    ///
    /// # Errors
    /// Those of [`Sweeper::new`].
    pub fn one_by_one(settings: &SweepSettings) -> Result<Self> {
        let mut sweeper = Self::new(settings)?;
        if let Method::Interfaces(interfaces) = &mut sweeper.0 {
            interfaces.take_one_by_one()?;
        }
        Ok(sweeper)
    }

    /// Appends the rows of these units, in their order. A point that fails is a row too, undecided, with its reason.
    pub fn rows(&mut self, units: impl IntoIterator<Item = usize>, out: &mut Vec<SweepRow>) {
        let units: Vec<usize> = units.into_iter().collect();
        match &mut self.0 {
            Method::Interfaces(interfaces) => interfaces.rows(&units, out),
            Method::General(general) => general.rows(&units, out),
        }
    }
}
