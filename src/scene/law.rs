//! The steady-state friction law from options: at which slip rates.

use super::options::LawOptions;
use super::system::System;
use super::units::{Quantity, Units};
use crate::error::{Error, Result};
use crate::friction::{
    Extremum, Formulas, Law, StiffnessMaximum, critical_stiffness, critical_stiffness_maximum,
    positive, steady_stress,
};

/// The slip rates from, to where none are given.
const GRID: (f64, f64) = (1e-3, 1e6);
/// More points than this are a slip of the pen.
const MOST_POINTS: usize = 10_000_000;

/// A friction law that is asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct LawPlan {
    /// Whose law it is.
    pub system: System,
    /// Where it is evaluated, ascending, in V*.
    pub slip_rates: Vec<f64>,
}

/// The law at a slip rate, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawPoint {
    /// V.
    pub slip_rate: f64,
    /// tau_ss(V).
    pub stress: f64,
    /// The friction coefficient a tau_ss; `None` for a law without an a.
    pub friction: Option<f64>,
    /// psi_ss(V).
    pub state: f64,
    /// k_c(V): a single interface on a stiffer spring slides steadily.
    pub critical_stiffness: f64,
}

/// What a law is known by, dimensionless.
#[derive(Debug, Clone, PartialEq)]
pub struct LawLandmarks {
    /// The maximum and the minimum of tau_ss, where there are any.
    pub extrema: Vec<Extremum>,
    /// The maximum of k_c, where it has one.
    pub critical_stiffness_maximum: Option<StiffnessMaximum>,
    /// The slip rate from which on the law strengthens again, where it has one.
    pub transition_rate: Option<f64>,
}

impl LawPlan {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &LawOptions) -> Result<Self> {
        let system = System::new(&options.model)?.alike("law")?;
        let slip_rates = slip_rates(options, &system.units)?;
        Ok(LawPlan { slip_rates, system })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        format!(
            "plan of this command\n  4 closed formulas at {} slip rates; extrema enclosed by interval arithmetic; no integration",
            self.slip_rates.len()
        )
    }

    /// The law at all slip rates.
    pub fn points(&self) -> Vec<LawPoint> {
        let law = &self.system.law;
        let point = |&v: &f64| {
            let stress = steady_stress(law, v);
            LawPoint {
                slip_rate: v,
                stress,
                friction: Some(self.system.direct_effect * stress),
                state: law.steady_state(v),
                critical_stiffness: critical_stiffness(law, v),
            }
        };
        self.slip_rates.iter().map(point).collect()
    }

    /// What the law is known by, whatever the slip rates.
    ///
    /// # Errors
    /// Those of [`critical_stiffness_maximum`].
    pub fn landmarks(&self) -> Result<LawLandmarks> {
        let law = &self.system.law;
        Ok(LawLandmarks {
            extrema: Extremum::all(law),
            critical_stiffness_maximum: critical_stiffness_maximum(law)?,
            transition_rate: law.transition_rate(),
        })
    }
}

/// The slip rates of the grid, ascending, in V*.
pub(super) fn slip_rates(options: &LawOptions, units: &Units) -> Result<Vec<f64>> {
    let end = |name, value: Option<f64>, default: f64| match value {
        Some(v) => Ok(units.inward(Quantity::SlipRate, positive(name, v)?)),
        None => Ok(default),
    };
    let from = end("from", options.from, GRID.0)?;
    let to = end("to", options.to, GRID.1)?;
    if from >= to {
        return Err(Error::Input("`from` must be less than `to`".into()));
    }
    let n = options.points;
    if !(2..=MOST_POINTS).contains(&n) {
        return Err(Error::parameter("points", n, "from 2 to 1e7"));
    }
    let ratio = (to / from).ln();
    let slip_rate = |i| match i {
        0 => from,
        _ if i + 1 == n => to,
        _ => from * (ratio * i as f64 / (n - 1) as f64).exp(),
    };
    Ok((0..n).map(slip_rate).collect())
}
