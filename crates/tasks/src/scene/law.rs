//! The steady-state friction law from options: at which slip rates.

use super::fit::{MeasuredFriction, measured_friction};
use super::options::{LawOptions, ModelOptions};
use super::system::{Described, System};
use super::text::{TextModel, curve_of_formulas};
use super::units::{Quantity, Units};
use twinslip::error::{Error, Result};
use twinslip::friction::{
    Extremum, Formulas, Law, StiffnessMaximum, critical_stiffness, positive, steady_stress_within,
};
use twinslip::number::{Interval, Real, Uncertain, between_in_log};

/// The slip rates from, to where none are given.
const GRID: (f64, f64) = (1e-3, 1e6);
/// More points than this are a slip of the pen.
const MOST_POINTS: usize = 10_000_000;

/// A friction law that is asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct LawPlan {
    laws: Laws,
    /// Where it is evaluated, ascending, in V*.
    pub slip_rates: Vec<f64>,
    /// What slides together, where V_H or K is given.
    pub together: Option<Together>,
    /// What was measured, where a file of that is given.
    pub measured: Vec<MeasuredFriction>,
}

/// Whose laws they are.
#[derive(Debug, Clone, PartialEq)]
enum Laws {
    /// Interfaces with a built-in law, which has closed forms.
    Closed(Box<System>),
    /// Interfaces with a law given by its formulas.
    Formulas(Box<TextModel>),
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
    fn of(model: &ModelOptions, units: &Units) -> Result<Option<Self>> {
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
pub struct LawCurve {
    /// Whose it is: 1 or 2; 1 where both are equal.
    pub interface: usize,
    /// tau_ss at these rates.
    pub points: Vec<LawPoint>,
    /// The same at V_H/N, where V_H is given.
    pub together: Option<LawPoint>,
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
    /// tau_ss(V), with an infinite bound where none is known.
    pub stress: Uncertain,
    /// The friction coefficient, a tau_ss where all interfaces are equal; `None` for a law without an a.
    pub friction: Option<f64>,
    /// psi_ss(V), likewise.
    pub state: Uncertain,
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
        if !options.model.slab.modulate.is_empty() {
            return Err(Error::Input(
                "`modulate` varies a parameter in time, and a law is the same at all times".into(),
            ));
        }
        let laws = Laws::of(&options.model)?;
        let units = *laws.described().units();
        let measured = options.data.as_deref();
        let measured = measured.map(|path| measured_friction(path, &units));
        let measured = measured.transpose()?.unwrap_or_default();
        if options.data.is_some() && laws.count() > 1 {
            return Err(Error::Input(
                "`data`: the two interfaces have laws of their own; compare one law at a time"
                    .into(),
            ));
        }
        Ok(LawPlan {
            measured,
            slip_rates: slip_rates(options, &units)?,
            together: Together::of(&options.model, &units)?,
            laws,
        })
    }

    /// Whose law it is.
    pub fn system(&self) -> &dyn Described {
        self.laws.described()
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let count = self.slip_rates.len();
        let each = match self.laws.count() {
            1 => "",
            _ => " for each interface",
        };
        let how = match &self.laws {
            Laws::Closed(_) => format!(
                "4 closed formulas at {count} slip rates{each}; extrema enclosed by interval arithmetic"
            ),
            Laws::Formulas(_) => format!(
                "zeros of both formulas at {count} slip rates{each}, enclosed by interval arithmetic; extrema where slopes change sign between these"
            ),
        };
        format!("plan of this command\n  {how}; no integration")
    }

    /// The law of both interfaces, where they differ of each, up to a rate at which one has no steady state, and why that is.
    ///
    /// # Errors
    /// Those of [`critical_stiffness_maximum()`](twinslip::friction::critical_stiffness_maximum); [`Error::NotConverged`] where a law has no steady state between two points that
    /// have.
    pub fn curves(&self) -> Result<(Vec<LawCurve>, Option<Error>)> {
        let mut curves = Vec::new();
        let together = self.together.and_then(|all| all.slip_rate);
        for i in 0..self.laws.count() {
            let (curve, failure) = self.laws.curve(i, (&self.slip_rates, together))?;
            curves.push(curve);
            if failure.is_some() {
                return Ok((curves, failure));
            }
        }
        Ok((curves, None))
    }

    /// What was measured, each beside the friction coefficient of the law at that rate; `None` where the law has no steady state.
    ///
    /// # Errors
    /// Those of [`LawPlan::curves`]; [`Error::Input`] for a law whose friction coefficient is not known.
    pub fn compared(&self) -> Result<Vec<(MeasuredFriction, Option<f64>)>> {
        let rates: Vec<f64> = self.measured.iter().map(|one| one.slip_rate).collect();
        if rates.is_empty() {
            return Ok(Vec::new());
        }
        let (curve, _) = self.laws.curve(0, (&rates, None))?;
        if curve.coefficient.is_none() {
            return Err(Error::Input(
                "`data`: this law has no friction coefficient to compare with, as it has no direct_effect".into(),
            ));
        }
        let mut points = curve.points.iter().map(|point| point.friction);
        let each = self.measured.iter();
        Ok(each.map(|one| (*one, points.next().flatten())).collect())
    }
}

impl Laws {
    /// The law of an interface at rates that ascend, and at V_H/N; up to a rate at which it has no steady state, and why that is.
    fn curve(&self, place: usize, at: (&[f64], Option<f64>)) -> Result<(LawCurve, Option<Error>)> {
        match self {
            Laws::Closed(system) => Ok((curve(system, place, at)?, None)),
            Laws::Formulas(model) => curve_of_formulas(model, place, at),
        }
    }

    fn of(model: &ModelOptions) -> Result<Self> {
        let formulas = TextModel::of(model, &["driving", "stiffness"])?;
        Ok(match formulas.filter(|model| model.slab.is_some()) {
            Some(model) => Laws::Formulas(Box::new(model)),
            None => Laws::Closed(Box::new(System::new(model)?)),
        })
    }

    /// How many interfaces may differ.
    fn interfaces(&self) -> usize {
        match self {
            Laws::Closed(_) => self.count(),
            Laws::Formulas(model) => model.slab.as_ref().map_or(1, |slab| slab.clusters().len()),
        }
    }

    fn described(&self) -> &dyn Described {
        match self {
            Laws::Closed(system) => &**system,
            Laws::Formulas(model) => &**model,
        }
    }

    /// How many differ.
    fn count(&self) -> usize {
        let differ = match self {
            Laws::Closed(system) => system.unequal.is_some(),
            Laws::Formulas(model) => {
                let slab = model.slab.as_ref();
                slab.is_some_and(|slab| slab.differ(&model.system))
            }
        };
        if differ { 2 } else { 1 }
    }
}

/// The built-in law of an interface at these rates, and at V_H/N.
fn curve(
    system: &System,
    place: usize,
    (rates, together): (&[f64], Option<f64>),
) -> Result<LawCurve> {
    let (interface, law) = (place + 1, &system.laws()[place]);
    // The stress is measured in a sigma of the first one.
    let coefficient = system.constants[place].direct_effect * law.stress_factor;
    let point = |&v: &f64| {
        let stress = steady_stress_within(law, v, 0.0);
        let state = law.steady_state(v);
        let rounding = law.steady_state(Interval::constant(v)).distance_from(state);
        LawPoint {
            interface,
            slip_rate: v,
            stress,
            friction: Some(coefficient * stress.value),
            state: Uncertain::new(state, rounding),
            critical_stiffness: critical_stiffness(law, v),
        }
    };
    Ok(LawCurve {
        interface,
        points: rates.iter().map(point).collect(),
        together: together.as_ref().map(point),
        landmarks: LawLandmarks {
            extrema: Extremum::all(law),
            critical_stiffness_maximum: law.critical_stiffness_maximum()?,
            transition_rate: law.transition_rate(),
        },
        coefficient: Some(coefficient),
    })
}

/// The largest critical stiffness of interfaces at these slip rates, of those that differ of any; `None` where it is nowhere positive, or
/// where the law has no steady state. All that varies in the laws is given.
pub(super) fn largest_critical_stiffness(model: &ModelOptions, rates: &[f64]) -> Option<f64> {
    let mut model = model.clone();
    let slab = &mut model.slab;
    if slab.law_file().is_none() && slab.sets_one_interface() == Ok(false) {
        // Of equal interfaces the law is the same however many there are, and of two it has closed forms.
        (slab.interfaces, slab.clusters) = (None, None);
    }
    let laws = Laws::of(&model).ok()?;
    let each = (0..laws.interfaces()).map(|i| match &laws {
        Laws::Closed(system) => curve(system, i, (rates, None)),
        Laws::Formulas(model) => curve_of_formulas(model, i, (rates, None)).map(|(curve, _)| curve),
    });
    let largest = each.flatten().flat_map(|curve| {
        let maximum = curve.landmarks.critical_stiffness_maximum;
        let points = curve.points.into_iter().map(|at| at.critical_stiffness);
        points.chain(maximum.map(|at| at.stiffness.value))
    });
    largest
        .filter(|k| *k > 0.0 && k.is_finite())
        .max_by(f64::total_cmp)
}

/// The slip rates of the grid, ascending, in V*.
fn slip_rates(options: &LawOptions, units: &Units) -> Result<Vec<f64>> {
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
