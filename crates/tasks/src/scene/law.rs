//! The steady-state friction law from options: at which slip rates.

use super::options::{LawOptions, ModelOptions};
use super::system::System;
use super::units::{Quantity, Units};
use twinslip::error::{Error, Result};
use twinslip::friction::{
    Extremum, Formulas, Law, ScaledLaw, StiffnessMaximum, critical_stiffness, positive,
    steady_stress,
};
use twinslip::number::between_in_log;

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
    /// What slides together, where V_H or K is given.
    pub together: Option<Together>,
}

/// Interfaces that slide steadily together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Together {
    /// The slip rate of each, V_H/N, in V*, where V_H is given.
    pub slip_rate: Option<f64>,
    /// The stiffness that each slides on, N K, where K is given.
    pub stiffness: Option<f64>,
}

impl Together {
    /// What the options say of N, V_H and K.
    ///
    /// # Errors
    /// [`Error::Input`] for clusters; [`Error::Parameter`] for values that are not positive.
    pub(super) fn of(model: &ModelOptions, units: &Units) -> Result<Option<Self>> {
        if model.slab.clusters.is_some() {
            return Err(Error::Input(
                "`clusters`: the law is that of one interface; leave it out".into(),
            ));
        }
        let [driving, stiffness] = model.loading()?;
        if driving.is_none() && stiffness.is_none() {
            return Ok(None);
        }
        let count = f64::from(model.slab.count());
        let spring = |k: f64| -> Result<f64> {
            Ok(count * units.inward(Quantity::Stiffness, positive("stiffness", k)?))
        };
        let share = |v: f64| -> Result<f64> {
            Ok(units.inward(Quantity::SlipRate, positive("driving", v)?) / count)
        };
        Ok(Some(Together {
            slip_rate: driving.map(share).transpose()?,
            stiffness: stiffness.map(spring).transpose()?,
        }))
    }
}

/// The steady sliding of an interface, at rates and what it is known by.
#[derive(Debug, Clone, PartialEq)]
pub struct LawCurve<P = LawPoint> {
    /// Whose it is: 1 or 2; 1 where both are equal.
    pub interface: usize,
    /// tau_ss at these rates.
    pub points: Vec<P>,
    /// The same at V_H/N, where V_H is given.
    pub together: Option<P>,
    /// What it is known by, whatever the rates.
    pub landmarks: LawLandmarks,
    /// The coefficient of friction over the stress, where it is known.
    pub coefficient: Option<f64>,
}

/// The law of an interface at a slip rate, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawPoint {
    /// Whose it is, as of [`LawCurve`].
    pub interface: usize,
    /// V.
    pub slip_rate: f64,
    /// tau_ss(V).
    pub stress: f64,
    /// The friction coefficient, a tau_ss where all interfaces are equal; `None` for a law without an a.
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
        let system = System::new(&options.model)?;
        Ok(LawPlan {
            slip_rates: slip_rates(options, &system.units)?,
            together: Together::of(&options.model, &system.units)?,
            system,
        })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        format!(
            "plan of this command\n  4 closed formulas at {} slip rates{}; extrema enclosed by interval arithmetic; no integration",
            self.slip_rates.len(),
            of_each(self.system.unequal.is_some())
        )
    }

    /// The law of both interfaces, where they differ of each.
    ///
    /// # Errors
    /// Those of [`ScaledLaw::critical_stiffness_maximum`].
    pub fn curves(&self) -> Result<Vec<LawCurve>> {
        let laws = self.system.laws();
        let count = if self.system.unequal.is_some() { 2 } else { 1 };
        (0..count).map(|i| self.curve(i, &laws[i])).collect()
    }

    fn curve(&self, place: usize, law: &ScaledLaw) -> Result<LawCurve> {
        let interface = place + 1;
        // The stress is measured in a sigma of the first one.
        let coefficient = self.system.constants[place].direct_effect * law.stress_factor;
        let point = |&v: &f64| {
            let stress = steady_stress(law, v);
            LawPoint {
                interface,
                slip_rate: v,
                stress,
                friction: Some(coefficient * stress),
                state: law.steady_state(v),
                critical_stiffness: critical_stiffness(law, v),
            }
        };
        Ok(LawCurve {
            interface,
            points: self.slip_rates.iter().map(point).collect(),
            together: self
                .together
                .and_then(|all| all.slip_rate.as_ref().map(&point)),
            landmarks: LawLandmarks {
                extrema: Extremum::all(law),
                critical_stiffness_maximum: law.critical_stiffness_maximum()?,
                transition_rate: law.transition_rate(),
            },
            coefficient: Some(coefficient),
        })
    }
}

/// In plans, where there are two laws.
pub(super) fn of_each(two: bool) -> &'static str {
    if two { " for each interface" } else { "" }
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
    let slip_rate = |i| match i {
        0 => from,
        _ if i + 1 == n => to,
        _ => between_in_log(from, to, i as f64 / (n - 1) as f64),
    };
    Ok((0..n).map(slip_rate).collect())
}
