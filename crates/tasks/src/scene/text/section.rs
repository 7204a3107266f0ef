//! The return map of a user-defined system.

use super::model::{TextModel, number};
use super::plan::{atol_in_words, numerics};
use crate::scene::column::Column;
use crate::scene::options::SectionOptions;
use crate::scene::plan::longest_in_words;
use crate::scene::run::Sink;
use crate::scene::section::{
    CheckedExponents, Means, SAME_PERIOD, SectionOutcome, Settling, USUAL_SURFACE, counted,
    of_multipliers, of_record,
};
use crate::scene::system::Described;
use crate::scene::units::Quantity;
use serde_json::Value;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::friction::positive;
use twinslip::integrate::{
    AnyField, AnyIntegrator, Choice, Control, MotionUnits, Tolerances, used_compiling,
};
use twinslip::number::Uncertain;
use twinslip::number::polynomial::Crossing;
use twinslip::orbit::{OrbitAccuracy, find_from};
use twinslip::section::{Periodic, SeriesVariables, Surface, Watching, usual_patience};

/// The longest time to wait for a return where nobody says otherwise, in that in which the liveliest state goes through its range.
const PATIENCE: f64 = 1e4;

/// A return map of a user-defined system, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct TextSectionPlan {
    /// The system.
    pub model: TextModel,
    /// Where the run starts.
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
    pub atol_is_given: bool,
    /// The units in which the run is made and judged.
    units: MotionUnits,
    /// The bound on steps.
    pub max_steps: usize,
}

/// A return to the section.
#[derive(Debug, Clone, PartialEq)]
pub struct TextReturn {
    /// Its number after the returns let pass, from 0.
    pub number: usize,
    /// When it is.
    pub time: f64,
    /// The values of all states.
    pub state: Vec<f64>,
}

/// The columns of a return map: the number of the return, its time, and every state by its name.
pub fn text_section_columns(model: &TextModel) -> Vec<Column<TextReturn>> {
    let mut columns = vec![
        Column::new("return", Quantity::Number, |row: &TextReturn| {
            row.number.into()
        }),
        Column::new("time", Quantity::Number, |row: &TextReturn| row.time.into()),
    ];
    let states = model.system.states().iter().enumerate();
    columns.extend(states.map(|(i, name)| {
        Column::new(*name, Quantity::Number, move |row: &TextReturn| {
            row.state[i].into()
        })
    }));
    columns
}

impl TextSectionPlan {
    /// Checks the options for this system.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &SectionOptions, model: TextModel) -> Result<Self> {
        if model.system.states().len() < 2 {
            return Err(Error::Input(
                "a system of one state has no return map: it never comes back".into(),
            ));
        }
        counted(options)?;
        let (method, tolerances) = numerics(&options.numerics, model.units())?;
        let (state, value) = surface(options.surface.as_deref(), &model)?;
        let start = model.start(options.start.as_deref())?;
        let mut units = model.motion_units_of_run(&start)?;
        // No logarithm is that of a value of another sign.
        if units.signs[state] * value <= 0.0 {
            units.signs[state] = 0.0;
        }
        let patience = match options.patience {
            Some(patience) => positive("patience", patience)?,
            None => usual_patience_of(&model, &units),
        };
        Ok(TextSectionPlan {
            start,
            state,
            value,
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
            atol_is_given: options.numerics.atol.is_some(),
            units,
            max_steps: options.numerics.max_steps,
            model,
        })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let sense = match self.direction {
            Crossing::Downwards => "falling",
            _ => "rising",
        };
        let tangents = if self.lyapunov {
            "on, for the Lyapunov exponents"
        } else {
            "off but for the periodic point: `lyapunov` is not given"
        };
        format!(
            "plan of this return map
  dimension         {}
  method            {}: {}
  formulas          {}
  tolerances        rtol {:e}, {}, at most {} steps{}
  section           {} {sense} through {}
  returns           {} after {} that are skipped; a run that does not return for {} ends
  tangents          {tangents}",
            self.start.len(),
            self.method.name(),
            self.method.reason(),
            used_compiling().in_words(),
            self.tolerances.rtol,
            atol_in_words(self.tolerances.atol, self.told_atol().is_array()),
            twinslip::error::count(self.max_steps),
            longest_in_words(self.tolerances, self.model.units()),
            self.model.system.states()[self.state],
            self.value,
            self.returns,
            self.skip,
            self.patience
        )
    }

    /// The absolute tolerance as it is told.
    pub fn told_atol(&self) -> Value {
        let atol = self.tolerances.atol;
        self.model
            .absolute_tolerance(&self.units, atol, self.atol_is_given)
    }

    /// The section in the units of the run.
    fn surface(&self, units: &MotionUnits) -> Surface {
        let direction = units.direction(self.state);
        let along = |i: usize, _: usize| match i == self.state {
            true => direction,
            false => 0.0,
        };
        Surface {
            normal: Vector::from_fn(self.start.len(), along),
            offset: direction * units.inward_value(self.state, self.value),
            direction: self.direction,
            chart: SeriesVariables::Plain,
        }
    }
}

fn usual_patience_of(model: &TextModel, units: &MotionUnits) -> f64 {
    match (&model.slab, model.system.parameters()) {
        (Some(_), [driving, stiffness, ..]) => usual_patience(*driving, *stiffness),
        _ => PATIENCE * units.time,
    }
}

/// STATE=VALUE, and of interfaces stress=auto.
fn surface(text: Option<&str>, model: &TextModel) -> Result<(usize, f64)> {
    if let Some(slab) = &model.slab
        && text.is_none_or(|text| text == USUAL_SURFACE)
    {
        return Ok((0, slab.mean_stress(&model.system)?));
    }
    let Some(text) = text else {
        let states = model.system.states().join(", ");
        return Err(Error::Input(format!(
            "`surface` STATE=VALUE is missing: where is the section? The states are {states}"
        )));
    };
    let read = text.split_once('=');
    let Some((name, value)) = read.and_then(|(name, value)| Some((name, number(value)?))) else {
        return Err(Error::Input(format!(
            "`surface` {text:?} must be STATE=VALUE"
        )));
    };
    Ok((model.state("the state of `surface`", name.trim())?, value))
}

/// Runs the plan of a return map.
///
/// # Errors
/// [`Error::Parameter`] if the integrator refuses its settings; a failure on the way is in [`SectionOutcome::failure`].
pub fn run_text_section(plan: &TextSectionPlan, sink: &mut dyn Sink) -> Result<SectionOutcome> {
    let (model, start) = (&plan.model, &plan.start);
    let mut made = 0;
    let outcome = run_in((plan, &plan.units), &mut made, sink)?;
    if !matches!(outcome.failure, Some(Error::Underflow { .. })) {
        return Ok(outcome);
    }
    match model.units_below_doubles(&plan.units, start) {
        Some(units) if units.signs[plan.state] * plan.value >= 0.0 => {
            run_in((plan, &units), &mut made, sink)
        }
        _ => Ok(outcome),
    }
}

/// The run in these units, of which so many rows are made already.
fn run_in(
    (plan, units): (&TextSectionPlan, &MotionUnits),
    made: &mut usize,
    sink: &mut dyn Sink,
) -> Result<SectionOutcome> {
    let field = &units.field(&plan.model.system)?;
    let tolerances = units.inward_tolerances(plan.tolerances, plan.atol_is_given);
    let means: Means<'_> = &|record, see| of_record(field, record, see);
    let settling = Settling {
        field,
        start: units.inward(&plan.start),
        surface: plan.surface(units),
        watching: Watching {
            skip: plan.skip,
            // One more, as for interfaces, so that the verdicts are on as many.
            returns: plan.returns + 1,
            patience: plan.patience / units.time,
            accuracy: tolerances.rtol,
            max_step: tolerances.max_step,
            waypoints: false,
        },
        integrator: AnyIntegrator::new(plan.method, tolerances, plan.max_steps)?,
        max_steps: plan.max_steps,
        lyapunov: plan.lyapunov,
        means,
        by_orbit: &|periodic| of_orbit(field, periodic, tolerances.max_step),
    };
    let columns = text_section_columns(&plan.model);
    let mut number = 0;
    let outcome = settling.run(
        &mut |at, sink| {
            number += 1;
            if number <= *made || *made == plan.returns {
                return Control::Continue;
            }
            let row = TextReturn {
                number: *made,
                time: at.time * units.time,
                state: units.outward(&at.state).as_slice().to_vec(),
            };
            *made += 1;
            let units = plan.model.units();
            let numbers = columns.iter().map(|column| column.number(&row, units));
            sink.row(&numbers.collect::<Vec<f64>>())
        },
        sink,
    )?;
    Ok(outcome.outward(units, plan.state))
}

/// ln |mu| / T of the periodic orbit through a point, with its period.
fn of_orbit(
    field: &AnyField<'_>,
    periodic: &Periodic,
    max_step: f64,
) -> Option<(Uncertain, CheckedExponents)> {
    let period = periodic.period.value;
    let accuracy = OrbitAccuracy::of(Choice::Taylor).stepping(max_step);
    let orbit = find_from(field, &periodic.point, Some(period), &accuracy)
        .ok()?
        .orbit;
    let apart = orbit.period.value / period - 1.0;
    let known = apart.abs() < SAME_PERIOD;
    let exponents = known.then(|| of_multipliers(&orbit)).flatten()?;
    Some((orbit.period, exponents))
}
