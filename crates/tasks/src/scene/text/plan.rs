//! A run of a user-defined system from options: what is integrated, when there are rows, and what they hold.

use super::model::TextModel;
use super::slab::TextSlab;
use crate::scene::column::Column;
use crate::scene::estimate::Companion;
use crate::scene::options::{IntegrateOptions, NumericsOptions};
use crate::scene::plan::{Sampling, longest_in_words, sampling, stepping, until};
use crate::scene::program::{Program, Stretch};
use crate::scene::system::Described;
use crate::scene::units::{Quantity, Units};
use serde_json::{Value, json};
use std::borrow::Cow;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::integrate::{Choice, MotionUnits, Tolerances, used_compiling};
use twinslip::model::TextSystem;

/// When a run begins.
const BEGIN: f64 = 0.0;

/// A run of a user-defined system, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct TextPlan {
    /// The system.
    pub model: TextModel,
    /// How V_H changes on the way, of interfaces, where it does.
    pub program: Option<Program>,
    /// Where it starts.
    pub start: Vector,
    /// Where the run begins anew from known points of the same solution, as an orbit from its shooting nodes: their times, ascending,
    /// and the points. Empty for a run from its start alone.
    pub nodes: Vec<(f64, Vector)>,
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
    /// Whether the absolute one is the user's, in the system's own units.
    pub atol_is_given: bool,
    /// The units in which the run begins, which grow with it.
    pub units: MotionUnits,
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
    /// The slip of each interface since the start; none where nothing slides.
    pub slip: Vec<f64>,
    /// V_H; 0 where nothing is driven.
    pub driving: f64,
}

/// The columns of a run: the time, and every state by its name; of interfaces those of interfaces that are built in.
pub fn text_columns(model: &TextModel) -> Vec<Column<TextInstant>> {
    let time = Column::new("time", Quantity::Number, |at: &TextInstant| at.time.into());
    if let Some(slab) = &model.slab {
        let mut columns = vec![time];
        columns.extend(interface_columns(slab, &model.system));
        return columns;
    }
    let states = model.system.states().iter().enumerate();
    let state = |(i, name): (usize, &&'static str)| {
        Column::new(*name, Quantity::Number, move |at: &TextInstant| {
            at.state[i].into()
        })
    };
    std::iter::once(time).chain(states.map(state)).collect()
}

fn interface_columns(slab: &TextSlab, system: &TextSystem) -> Vec<Column<TextInstant>> {
    use Quantity::{Length, Number};
    let each = |name: &str, quantity, entry: fn(&TextInstant, &TextSystem, usize) -> f64| {
        let column = |i: usize| {
            let system = system.clone();
            let entry = move |at: &TextInstant| entry(at, &system, i).into();
            Column::new(format!("{name}_{}", i + 1), quantity, entry)
        };
        (0..slab.clusters().len()).map(column).collect::<Vec<_>>()
    };
    let mut columns = vec![Column::new("stress", Number, |at: &TextInstant| {
        at.state[0].into()
    })];
    columns.extend(each("state", Number, |at, _, i| at.state[i + 1].exp()));
    columns.extend(each("log_state", Number, |at, _, i| at.state[i + 1]));
    columns.extend(each("slip_rate", Number, |at, system, i| {
        system.slip_rates(&at.state)[i]
    }));
    columns.extend(each("slip", Length, |at, _, i| at.slip[i]));
    columns
}

/// The method and the tolerances, checked.
pub(in crate::scene) fn numerics(
    options: &NumericsOptions,
    units: &Units,
) -> Result<(Choice, Tolerances)> {
    if options.max_steps == 0 {
        return Err(Error::parameter("max-steps", 0, "at least 1"));
    }
    let atol = options.atol.unwrap_or(options.rtol);
    let tolerances = Tolerances::new(options.rtol, atol)?;
    let tolerances = stepping(tolerances, options.max_step, units)?;
    Ok((Choice::named(&options.method)?, tolerances))
}

impl TextPlan {
    /// Checks the options of a run of this system.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &IntegrateOptions, mut model: TextModel) -> Result<Self> {
        if options.events.is_some() {
            return Err(Error::Input(
                "`events` are stick-slip events of interfaces with a built-in law; a `system` or a `law` from a file has none".into(),
            ));
        }
        let until = until(options)?;
        let program = options.program.as_deref();
        let program = program
            .map(|text| programmed(text, until, &mut model))
            .transpose()?;
        let start = model.start(options.start.as_deref())?;
        let sampling = sampling(options, model.units(), until)?;
        let mut columns = text_columns(&model);
        columns.extend(program.as_ref().map(|_| driving_column()));
        if let Some(names) = &options.columns {
            columns = Column::listed(&columns, names)?;
        }
        let (method, tolerances) = numerics(&options.numerics, model.units())?;
        let atol_is_given = options.numerics.atol.is_some();
        let units = match atol_is_given || model.slab.is_some() {
            true => MotionUnits::given(start.len()),
            false => {
                let begin = model.at_time(start.clone(), BEGIN);
                MotionUnits::beginning(&model.system, &begin, until)?
            }
        };
        Ok(TextPlan {
            program,
            start,
            nodes: Vec::new(),
            until,
            sampling,
            columns,
            picture: options.plot.is_some(),
            estimate: (options.estimate_error || options.reference)
                .then(|| Companion::of(tolerances, options.reference)),
            asked_method: options.numerics.method.clone(),
            method,
            tolerances,
            atol_is_given,
            units,
            max_steps: options.numerics.max_steps,
            model,
        })
    }

    /// The absolute tolerance as it is told: as the run begins.
    pub fn told_atol(&self) -> Value {
        let atol = self.tolerances.atol;
        self.model
            .absolute_tolerance(&self.units, atol, self.atol_is_given)
    }

    /// The columns of the points of a picture.
    pub fn pictured(&self) -> Vec<Column<TextInstant>> {
        let mut columns = text_columns(&self.model);
        columns.retain(|column| column.quantity != Quantity::Length);
        columns.extend(self.program.as_ref().map(|_| driving_column()));
        columns
    }

    /// Whether a column needs the slip.
    pub fn needs_slip(&self) -> bool {
        let lengths = |column: &Column<TextInstant>| column.quantity == Quantity::Length;
        self.columns.iter().any(lengths)
    }

    /// Whether anything must be seen between start and end.
    pub fn observed(&self) -> bool {
        self.sampling != Sampling::FinalOnly || self.picture || self.needs_slip()
    }

    /// The stretches of the run, one after the other.
    pub(super) fn stretches(&self) -> Result<Vec<Stretch>> {
        let driving = self.model.driving();
        if let Some(program) = &self.program {
            return program.stretches(driving, self.until, self.model.units());
        }
        let times = || self.nodes.iter().map(|&(time, _)| time);
        let begins = [BEGIN].into_iter().chain(times());
        let spans = begins.zip(times().chain([self.until]));
        Ok(spans
            .map(|span| Stretch::new(span, (driving, driving)))
            .collect())
    }

    /// The equations of a stretch: on a ramp V_H is their last state.
    pub(super) fn system_on(&self, stretch: &Stretch) -> Result<Cow<'_, TextSystem>> {
        let Some(slab) = self.model.slab.as_ref().filter(|_| self.program.is_some()) else {
            return Ok(Cow::Borrowed(&self.model.system));
        };
        let rate = stretch.rate();
        if rate != 0.0 {
            return slab.on_ramp(&self.model.system, rate).map(Cow::Owned);
        }
        let mut model = self.model.clone();
        model.drive(stretch.driving.0)?;
        Ok(Cow::Owned(model.system))
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let rows = self.sampling.in_words();
        let estimate = match self.estimate {
            Some(Companion::Tighter(second)) => format!(
                "on: twice the distance to a second run by auto with rtol {:e}, and the rounding of the start by a tangent flow",
                second.rtol
            ),
            Some(Companion::Reference { .. }) => {
                "on: twice the distance to a second run in double-double arithmetic, and the rounding of the start by a tangent flow".into()
            }
            None => "off: `estimate_error` is not given".into(),
        };
        let forced = match self.model.system.is_timed() {
            true => ", driven by t",
            false => "",
        };
        format!(
            "plan of this run
  dimension         {}: {}{forced}
  method            {}: {}
  formulas          {}
  tolerances        rtol {:e}, {}, at most {} steps{}
  trajectory        {rows}
  error estimate    {estimate}",
            self.start.len(),
            self.model.system.states().join(", "),
            self.method.name(),
            self.method.reason(),
            used_compiling().in_words(),
            self.tolerances.rtol,
            atol_in_words(self.tolerances.atol, self.told_atol().is_array()),
            twinslip::error::count(self.max_steps),
            longest_in_words(self.tolerances, self.model.units())
        )
    }
}

/// The absolute tolerance in words, where it follows the states and where it is one number for all.
pub(super) fn atol_in_words(atol: f64, of_each: bool) -> String {
    match of_each {
        true => format!("atol {atol:e} of how far each state has come"),
        false => format!("atol {atol:e} on every state"),
    }
}

/// V_H, of runs in which it changes.
fn driving_column() -> Column<TextInstant> {
    Column::new("driving", Quantity::Number, |at: &TextInstant| {
        at.driving.into()
    })
}

/// The changes of V_H, whose first value the model then has.
fn programmed(text: &str, until: f64, model: &mut TextModel) -> Result<Program> {
    let Some(slab) = &model.slab else {
        return Err(Error::Input(
            "`program` changes the driving velocity of interfaces; a user-defined `system` has none".into(),
        ));
    };
    let program = Program::read(text, until)?;
    let Some(first) = slab.driving.or(program.first()) else {
        return Err(Error::Input(
            "`driving` V_H is missing: which velocity is it before the first change of `program`?"
                .into(),
        ));
    };
    model.drive(first)?;
    model.tell("driving", json!(first + 0.0));
    model.tell("program", json!(program.told()));
    Ok(program)
}
