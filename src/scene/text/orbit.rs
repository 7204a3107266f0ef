//! A periodic orbit of a system of one's own.

use super::model::TextModel;
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::friction::positive;
use crate::integrate::{Choice, Tolerances};
use crate::orbit::{Crosscheck, FoundOrbit, Orbit, OrbitAccuracy, crosscheck_of, find_from};
use crate::scene::options::OrbitOptions;
use crate::scene::orbit::second;

/// A periodic orbit that is asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct TextOrbitPlan {
    /// The system.
    pub model: TextModel,
    /// At or near the orbit.
    pub start: Vector,
    /// The period, roughly, where it is given.
    pub period: Option<f64>,
    /// By which method.
    pub accuracy: OrbitAccuracy,
    /// By which second method once more.
    pub second: Option<OrbitAccuracy>,
}

impl TextOrbitPlan {
    /// Checks the options for this system.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &OrbitOptions, model: TextModel) -> Result<Self> {
        let usual = OrbitAccuracy::of(Choice::named(&options.method)?);
        if options.max_steps == 0 {
            return Err(Error::parameter("max-steps", 0, "at least 1"));
        }
        let rtol = options.rtol.unwrap_or(usual.tolerances.rtol);
        let accuracy = OrbitAccuracy {
            max_steps: options.max_steps,
            tolerances: Tolerances::new(rtol, options.atol.unwrap_or(rtol))?,
            ..usual
        };
        let guess = |period| positive("period-guess", period);
        Ok(TextOrbitPlan {
            start: start(options, &model)?,
            period: options.period_guess.map(guess).transpose()?,
            second: second(options.crosscheck.as_deref(), accuracy.method)?,
            accuracy,
            model,
        })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let guess = match self.period {
            Some(_) => "the start, over the period given",
            None => "the returns of the start, else what it settles on",
        };
        let second = match &self.second {
            Some(second) => format!("{}, from nodes cut to three digits", second.method.name()),
            None => "off: `crosscheck` none".to_owned(),
        };
        format!(
            "plan of this command
  dimension         {}
  guess             {guess}
  method            {}, tangents on, multiple shooting; rtol {:e}
  crosscheck        {second}",
            self.start.len(),
            self.accuracy.method.name(),
            self.accuracy.tolerances.rtol
        )
    }

    /// Finds the orbit.
    ///
    /// # Errors
    /// Those of [`find_from`].
    pub fn find(&self) -> Result<FoundOrbit> {
        find_from(
            &self.model.field()?,
            &self.start,
            self.period,
            &self.accuracy,
        )
    }

    /// The orbit once more, by the second method; `None` where there is none.
    ///
    /// # Errors
    /// Those of [`crosscheck_of`].
    pub fn crosscheck(&self, orbit: &Orbit) -> Result<Option<Crosscheck>> {
        let field = self.model.field()?;
        let again = |second| crosscheck_of(&field, orbit, second);
        self.second.as_ref().map(again).transpose()
    }
}

/// Where the search begins. Interfaces that start alike stay so: their symmetric orbits are found from such a start, and others from one
/// beside it.
fn start(options: &OrbitOptions, model: &TextModel) -> Result<Vector> {
    let name = options.symmetry.as_deref().unwrap_or("symmetric");
    let symmetry = Symmetry::named(name)
        .ok_or_else(|| Error::unknown("symmetry", name, &["symmetric", "asymmetric"]))?;
    match (&model.slab, &options.start) {
        (Some(slab), None) if symmetry == Symmetry::Symmetric => {
            Ok(Vector::from_vec(slab.alike(&model.system)?))
        }
        _ => model.start(options.start.as_deref()),
    }
}
