//! A return map from options: the section, the run and what is asked of its returns.

mod explain;
mod exponents;
mod row;
mod run;

pub use explain::explain_section;
pub use exponents::CheckedExponents;
pub(super) use exponents::{SAME_PERIOD, of_multipliers, of_record};
pub use row::{SectionRow, section_columns};
pub(super) use run::{Means, Settling};
pub use run::{SectionOutcome, run_section};

use super::options::SectionOptions;
use super::plan::{Dimension, USUAL_START, numerics, start};
use super::system::System;
use super::units::Quantity;
use twinslip::error::{Error, Result};
use twinslip::friction::positive;
use twinslip::integrate::{Choice, Tolerances};
use twinslip::model::Loading;
use twinslip::number::polynomial::Crossing;
use twinslip::section::{FEWEST_FOR_EXPONENTS, usual_patience};

/// The section of the paper.
pub(super) const USUAL_SURFACE: &str = "stress=auto";
/// More returns than this are a slip of the pen.
const MOST_RETURNS: usize = 100_000_000;

/// A return map, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionPlan {
    /// What slides.
    pub system: System,
    /// V_H and K.
    pub loading: Loading,
    /// tau and ln psi_1, ln psi_2 at the start.
    pub start: (f64, [f64; 2]),
    /// What is integrated.
    pub dimension: Dimension,
    /// The stress of the section.
    pub stress: f64,
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
    /// The bound on steps.
    pub max_steps: usize,
}

impl SectionPlan {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &SectionOptions) -> Result<Self> {
        let system = System::new(&options.model)?;
        let loading = system.loading()?;
        let text = options.start.as_deref().unwrap_or(USUAL_START);
        let start = start(text, &system, &loading)?;
        let (method, tolerances) = numerics(&options.numerics, &system.units)?;
        let patience = match options.patience {
            Some(patience) => {
                let patience = positive("patience", patience)?;
                system.units.inward(Quantity::Time, patience)
            }
            None => usual_patience(loading.driving, loading.stiffness),
        };
        counted(options)?;
        if options.numerics.max_steps == 0 {
            return Err(Error::parameter("max-steps", 0, "at least 1"));
        }
        Ok(SectionPlan {
            stress: stress(
                options.surface.as_deref().unwrap_or(USUAL_SURFACE),
                &system,
                &loading,
            )?,
            dimension: Dimension::of(&system, &start),
            start,
            direction: if options.upwards {
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
            max_steps: options.numerics.max_steps,
            loading,
            system,
        })
    }
}

/// That the numbers of returns are allowed.
pub(super) fn counted(options: &SectionOptions) -> Result<()> {
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

/// The stress of the section.
fn stress(text: &str, system: &System, loading: &Loading) -> Result<f64> {
    let unreadable = || {
        Error::Input(format!(
            "`surface` {text:?} must be stress=auto or stress=VALUE"
        ))
    };
    let value = text.strip_prefix("stress=").ok_or_else(unreadable)?;
    if value == "auto" {
        return Ok(system.steady_stress(loading.driving));
    }
    match value.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(system.units.inward(Quantity::Stress, x)),
        _ => Err(unreadable()),
    }
}
