//! A run of a system of one's own from options: what is integrated, when there are rows, and what they hold.

use super::model::TextModel;
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::integrate::{Choice, Tolerances};
use crate::scene::column::Column;
use crate::scene::estimate::Companion;
use crate::scene::options::{IntegrateOptions, NumericsOptions};
use crate::scene::plan::{Sampling, sampling, until};
use crate::scene::system::Described;
use crate::scene::units::Quantity;

/// A run of a system of one's own, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct TextPlan {
    /// The system.
    pub model: TextModel,
    /// Where it starts.
    pub start: Vector,
    /// End of the run.
    pub until: f64,
    /// When there are rows.
    pub sampling: Sampling,
    /// What a row holds.
    pub columns: Vec<Column<TextInstant>>,
    /// Whether the run is drawn.
    pub picture: bool,
    /// The second run that estimates the error, if one does.
    pub estimate: Option<Companion>,
    /// The method's name as it was asked for.
    pub asked_method: String,
    /// The method.
    pub method: Choice,
    /// The tolerances.
    pub tolerances: Tolerances,
    /// The bound on steps.
    pub max_steps: usize,
}

/// A point of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct TextInstant {
    /// Time.
    pub time: f64,
    /// The values of all states.
    pub state: Vec<f64>,
}

/// The columns of a run: the time, and every state by its name.
pub fn text_columns(model: &TextModel) -> Vec<Column<TextInstant>> {
    let time = Column::new("time", Quantity::Number, |at: &TextInstant| at.time.into());
    let states = model.system.states().iter().enumerate();
    let state = |(i, name): (usize, &&'static str)| {
        Column::new(*name, Quantity::Number, move |at: &TextInstant| {
            at.state[i].into()
        })
    };
    std::iter::once(time).chain(states.map(state)).collect()
}

/// The method and the tolerances, checked.
pub(super) fn numerics(options: &NumericsOptions) -> Result<(Choice, Tolerances)> {
    if options.max_steps == 0 {
        return Err(Error::parameter("max-steps", 0, "at least 1"));
    }
    let atol = options.atol.unwrap_or(options.rtol);
    let tolerances = Tolerances::new(options.rtol, atol)?;
    Ok((Choice::named(&options.method)?, tolerances))
}

impl TextPlan {
    /// Checks the options of a run of this system.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &IntegrateOptions, model: TextModel) -> Result<Self> {
        if options.events.is_some() {
            return Err(Error::Input(
                "`events` are stick-slip events, which need interfaces; a `system` of one's own has none".into(),
            ));
        }
        let start = model.start(options.start.as_deref())?;
        let until = until(options)?;
        let sampling = sampling(options, model.units(), until)?;
        let mut columns = text_columns(&model);
        if let Some(names) = &options.columns {
            columns = Column::listed(&columns, names)?;
        }
        let (method, tolerances) = numerics(&options.numerics)?;
        Ok(TextPlan {
            start,
            until,
            sampling,
            columns,
            picture: options.plot.is_some(),
            estimate: (options.estimate_error || options.reference)
                .then(|| Companion::of(tolerances, options.reference)),
            asked_method: options.numerics.method.clone(),
            method,
            tolerances,
            max_steps: options.numerics.max_steps,
            model,
        })
    }

    /// Whether anything must be seen between start and end.
    pub fn observed(&self) -> bool {
        self.sampling != Sampling::FinalOnly || self.picture
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let rows = match self.sampling {
            Sampling::FinalOnly => "off: only the end is asked for".to_owned(),
            Sampling::EveryStep => "a row at every step".to_owned(),
            Sampling::Points(n) => format!("{n} rows equally spaced in time"),
            Sampling::Every(dt) => format!("a row every {dt}"),
        };
        let estimate = match self.estimate {
            Some(Companion::Tighter(second)) => format!(
                "on: twice the distance to a second run by auto with rtol {:e}, and the rounding of the start by a tangent flow",
                second.rtol
            ),
            Some(Companion::Reference) => {
                "on: twice the distance to a second run in double-double arithmetic, and the rounding of the start by a tangent flow".into()
            }
            None => "off: `estimate_error` is not given".into(),
        };
        format!(
            "plan of this run
  dimension         {}: {}
  method            {}: {}
  tolerances        rtol {:e}, atol {:e} on every state, at most {} steps
  trajectory        {rows}
  error estimate    {estimate}",
            self.start.len(),
            self.model.system.states().join(", "),
            self.method.name(),
            self.method.reason(),
            self.tolerances.rtol,
            self.tolerances.atol,
            crate::error::count(self.max_steps)
        )
    }
}
