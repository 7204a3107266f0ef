//! A return map from options: the section, the run and what is asked of its returns.

mod explain;
mod exponents;
mod row;
mod run;

pub use explain::explain_section;
pub use exponents::CheckedExponents;
pub use row::{SectionRow, section_columns};
pub use run::{SectionOutcome, run_section};

use super::any_system::AnySystem;
use super::equations::Subspace;
use super::options::{SectionOptions, number};
use super::system::Described;
use super::text::PHASE;
use super::units::Quantity;
use serde_json::Value;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::friction::positive;
use twinslip::integrate::{Choice, MotionUnits, Tolerances};
use twinslip::number::polynomial::Crossing;
use twinslip::section::{FEWEST_FOR_EXPONENTS, Surface};

/// The section of the paper.
const USUAL_SURFACE: &str = "stress=auto";
/// More returns than this are a slip of the pen.
const MOST_RETURNS: usize = 100_000_000;

/// A return map, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionPlan {
    /// The system.
    pub system: AnySystem,
    /// The states among which it stays.
    pub subspace: Subspace,
    /// The values of these states at the start.
    pub start: Vector,
    /// The place of the state that has a fixed value in the section.
    pub state: usize,
    /// That value.
    pub value: f64,
    /// The direction in which it is crossed.
    pub direction: Crossing,
    /// Returns that are let pass.
    pub skip: usize,
    /// Returns that are recorded.
    pub returns: usize,
    /// The longest time to wait for one.
    pub patience: f64,
    /// Whether the Lyapunov exponents are asked for.
    pub lyapunov: bool,
    /// The method's name as it was asked for.
    pub asked_method: String,
    /// The method.
    pub method: Choice,
    /// The tolerances.
    pub tolerances: Tolerances,
    /// Whether the absolute one is the user's, in the system's own units.
    atol_is_given: bool,
    /// The units in which the run is made and its regime is decided.
    units: MotionUnits,
    /// The bound on steps.
    pub max_steps: usize,
}

impl SectionPlan {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &SectionOptions) -> Result<Self> {
        let system = AnySystem::new(&options.model)?;
        if system.states().len() < 2 {
            return Err(Error::Input(
                "a system of one state has no return map: it never comes back".into(),
            ));
        }
        let start = system.start(options.start.as_deref(), false)?;
        let (method, tolerances) = system.numerics(&options.numerics)?;
        counted(options)?;
        let (state, value) = surface(options.surface.as_deref(), &system)?;
        let mut units = system.units_of_run(&start)?;
        // No logarithm is that of a value of another sign.
        if units.signs[state] * value <= 0.0 {
            units.signs[state] = 0.0;
        }
        let patience = match (options.patience, system.forcing_period()) {
            (Some(patience), _) => {
                let patience = positive("patience", patience)?;
                system.units().inward(Quantity::Time, patience)
            }
            // A phase comes again in a period.
            (None, Some(period)) => 2.0 * period,
            (None, None) => system.patience(&units),
        };
        let (subspace, start) = system.reduced(start);
        Ok(SectionPlan {
            subspace,
            start,
            state,
            value,
            direction: if options.upwards || system.forcing_period().is_some() {
                Crossing::Upwards
            } else {
                Crossing::Downwards
            },
            skip: options.skip,
            returns: options.returns,
            patience,
            lyapunov: options.lyapunov,
            asked_method: options.numerics.method.clone(),
            method,
            tolerances,
            atol_is_given: options.numerics.atol.is_some(),
            units,
            max_steps: options.numerics.max_steps,
            system,
        })
    }

    /// The absolute tolerance as it is told.
    pub fn told_atol(&self) -> Value {
        let atol = self.tolerances.atol;
        self.system
            .absolute_tolerance(&self.units, atol, self.atol_is_given)
    }

    /// The value of the state in the section, in the user's units.
    pub fn outward_value(&self) -> f64 {
        let quantity = self.system.quantity(self.state);
        self.system.units().outward(quantity, self.value)
    }

    /// The name of the state that has this value.
    pub fn state_name(&self) -> String {
        self.system.states()[self.state].to_string()
    }

    /// The section in the units of the run.
    fn surface(&self, units: &MotionUnits) -> Surface {
        if self.system.forcing_period().is_some() {
            let size = units.sizes[self.state];
            let phase = (self.state, 1.0 / size);
            return Surface::stroboscopic(self.start.len(), phase, self.value / size);
        }
        // In the subspace one variable stands for both states.
        let place = self.state.min(self.start.len() - 1);
        let direction = units.direction(place);
        let mut normal = Vector::zeros(self.start.len());
        normal[place] = direction;
        let chart = self.system.series_variables();
        let mut value = normal.clone();
        value[place] = units.inward_value(place, self.value);
        Surface {
            offset: direction * chart.variables(value.as_slice())[place],
            normal,
            direction: self.direction,
            chart,
            turn: None,
        }
    }
}

/// The phase of a stroboscopic section.
///
/// # Errors
/// [`Error::Input`] for a text that is not phase=VALUE with a value from 0 on and below 1.
pub(in crate::scene) fn phase_of_section(text: &str) -> Result<f64> {
    let read = text
        .split_once('=')
        .filter(|(name, _)| name.trim() == PHASE);
    let read = read.and_then(|(_, value)| number(value.trim()).ok());
    read.filter(|phase| (0.0..1.0).contains(phase)).ok_or_else(|| {
        Error::Input(format!(
            "`surface` {text:?} must be {PHASE}=VALUE, from 0 on and below 1: the section of a forced system is at a phase of its forcing"
        ))
    })
}

/// That the numbers of returns are allowed.
fn counted(options: &SectionOptions) -> Result<()> {
    if !(1..=MOST_RETURNS).contains(&options.returns) {
        return Err(Error::parameter(
            "returns",
            options.returns,
            "from 1 to 1e8",
        ));
    }
    if options.lyapunov && options.returns < FEWEST_FOR_EXPONENTS {
        return Err(Error::parameter(
            "returns",
            options.returns,
            "at least 60 with `lyapunov`",
        ));
    }
    if options.skip > MOST_RETURNS {
        return Err(Error::parameter("skip", options.skip, "at most 1e8"));
    }
    Ok(())
}

/// STATE=VALUE, and of interfaces stress=auto; under a forcing one of its phases, 0 where nothing is said.
fn surface(text: Option<&str>, system: &AnySystem) -> Result<(usize, f64)> {
    if system.forcing_period().is_some() {
        let last = system.states().len() - 1;
        return Ok((last, text.map_or(Ok(0.0), phase_of_section)?));
    }
    let names = || system.states().join(", ");
    if text.is_none_or(|text| text == USUAL_SURFACE)
        && let Some(stress) = system.mean_stress()?
    {
        return Ok((0, stress));
    }
    let Some(text) = text else {
        return Err(Error::Input(format!(
            "`surface` STATE=VALUE is missing: where is the section? The states are {}",
            names()
        )));
    };
    let read = text.split_once('=');
    let read = read.and_then(|(name, value)| Some((name, number(value).ok()?)));
    let Some((name, value)) = read else {
        let auto = if system.slides() {
            "stress=auto or "
        } else {
            ""
        };
        return Err(Error::Input(format!(
            "`surface` {text:?} must be {auto}STATE=VALUE, where the states are {}",
            names()
        )));
    };
    let state = system.state("the state of `surface`", name.trim())?;
    let value = system.units().inward(system.quantity(state), value);
    Ok((state, value))
}
