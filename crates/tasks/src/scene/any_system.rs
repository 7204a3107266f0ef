//! A system of any kind, resolved once from options, and what commands ask of it.
//!
//! Interfaces with a built-in law have fast fields, exact steady states and units; user-defined systems and laws have formulas. Commands ask
//! for what they need by the methods here, and never which kind a system is.

use super::equations::{Equations, Subspace};
use super::options::{ModelOptions, NumericsOptions};
use super::plan::{self, STEADY_START, USUAL_START};
use super::program::{Program, Stretch};
use super::system::{Described, System};
use super::text::{StateLayout, TextModel, TextSlab};
use super::units::{Quantity, Units};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::sync::Arc;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::friction::Formulas;
use twinslip::integrate::{Choice, MotionUnits, Tolerances, used_compiling};
use twinslip::model::Loading;
use twinslip::section::{SeriesVariables, usual_patience};

/// A system of any kind, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct AnySystem(Kind);

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    /// One or two interfaces with a built-in law.
    BuiltIn(Arc<System>, Loading),
    /// A user-defined system, or interfaces by the formulas of their law.
    Formulas(Arc<TextModel>),
}

/// The slip rate of an interface at values of all states and a time.
pub(super) type SlipRate = Arc<dyn Fn(usize, &[f64], f64) -> f64 + Send + Sync>;

impl AnySystem {
    /// The system that the options describe, for commands that take no time in formulas.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &ModelOptions) -> Result<Self> {
        Self::of(TextModel::of(options, &[])?, options, None)
    }

    /// The system of a run in time, whose driving velocity may change.
    ///
    /// # Errors
    /// As [`AnySystem::new`].
    pub fn in_time(options: &ModelOptions, program: Option<&Program>) -> Result<Self> {
        // A program may say itself which V_H is the first.
        let free: &[&str] = if program.is_some() { &["driving"] } else { &[] };
        Self::of(TextModel::in_time(options, free)?, options, program)
    }

    fn of(
        formulas: Option<TextModel>,
        options: &ModelOptions,
        program: Option<&Program>,
    ) -> Result<Self> {
        let kind = match (formulas, program) {
            (Some(mut model), program) => {
                if let Some(program) = program {
                    model.programmed(program)?;
                }
                Kind::Formulas(Arc::new(model))
            }
            (None, Some(program)) => {
                let (system, loading) = System::programmed(options, program)?;
                Kind::BuiltIn(Arc::new(system), loading)
            }
            (None, None) => {
                let system = System::new(options)?;
                let loading = system.loading()?;
                Kind::BuiltIn(Arc::new(system), loading)
            }
        };
        Ok(AnySystem(kind))
    }

    /// Interfaces whose law has closed forms, with V_H and K.
    pub fn closed_forms(&self) -> Option<(&System, Loading)> {
        match &self.0 {
            Kind::BuiltIn(system, loading) => Some((system, *loading)),
            Kind::Formulas(_) => None,
        }
    }

    /// The formulas of the system, where it has these alone.
    pub(super) fn formulas(&self) -> Option<&TextModel> {
        match &self.0 {
            Kind::BuiltIn(..) => None,
            Kind::Formulas(model) => Some(model),
        }
    }

    /// Its name in titles, for a user-defined system or law.
    pub fn name(&self) -> Option<&str> {
        self.formulas().map(TextModel::name)
    }

    /// The parameters that titles show: V_H and K, or all of formulas.
    pub fn parameters(&self) -> Vec<(&'static str, Quantity, f64)> {
        use Quantity::{Number, SlipRate, Stiffness};
        match &self.0 {
            Kind::BuiltIn(_, Loading { driving, stiffness }) => {
                vec![("V_H", SlipRate, *driving), ("K", Stiffness, *stiffness)]
            }
            Kind::Formulas(model) => {
                let all = model.system.parameter_names().iter();
                let all = all.zip(model.system.parameters());
                all.map(|(name, x)| (*name, Number, *x)).collect()
            }
        }
    }

    /// The name of every state: of interfaces the stress and ln psi of each.
    pub fn states(&self) -> Vec<Cow<'static, str>> {
        match &self.0 {
            Kind::BuiltIn(system, _) => {
                let each = (1..=system.interfaces).map(|i| format!("log_state_{i}").into());
                std::iter::once("stress".into()).chain(each).collect()
            }
            Kind::Formulas(model) => model.system.states().iter().map(|&x| x.into()).collect(),
        }
    }

    /// The quantity that a state measures.
    pub fn quantity(&self, state: usize) -> Quantity {
        match (self.formulas(), state) {
            (Some(model), _) => model.quantity(state),
            (None, 0) => Quantity::Stress,
            (None, _) => Quantity::LogState,
        }
    }

    /// What measures the time by which a kick in a state advances an orbit, over the kick.
    pub fn response(&self, state: usize) -> Quantity {
        match self.quantity(state) {
            Quantity::Stress => Quantity::TimePerStress,
            // Logarithms have no unit, and what is in no units has none of time either.
            _ => Quantity::Time,
        }
    }

    /// Which variables interfaces have; `None` of what is no interface.
    pub(super) fn layout(&self) -> Option<StateLayout> {
        match &self.0 {
            Kind::BuiltIn(system, _) => Some(StateLayout {
                parts: system.interfaces,
                states: 1,
                mass: false,
            }),
            Kind::Formulas(model) => model.slab.as_ref().map(TextSlab::layout),
        }
    }

    /// The place of the state of this name.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is none.
    pub(super) fn state(&self, option: &str, name: &str) -> Result<usize> {
        let states = self.states();
        let place = states.iter().position(|state| state == name);
        let known: Vec<&str> = states.iter().map(|state| &**state).collect();
        place.ok_or_else(|| Error::unknown(option, name, &known))
    }

    /// Whether its states are the stress and ln psi of interfaces.
    pub fn slides(&self) -> bool {
        self.formulas().is_none_or(|model| model.slab.is_some())
    }

    /// Whether its formulas name time.
    pub(super) fn is_timed(&self) -> bool {
        self.formulas().is_some_and(|model| model.system.is_timed())
    }

    /// How many states there are without the phase of a forcing.
    pub fn moving(&self) -> usize {
        self.formulas()
            .map_or(self.states().len(), |model| model.moving())
    }

    /// The period of a forcing, where its phase is a state.
    pub fn forcing_period(&self) -> Option<f64> {
        let model = self.formulas()?;
        model.system.forcing_period()
    }

    /// How many interfaces, equal ones of a cluster together, each state beyond the stress stands for; none of what is no interface.
    pub fn clusters(&self) -> &[usize] {
        match &self.0 {
            Kind::BuiltIn(system, _) => &[1, 1][..system.interfaces],
            Kind::Formulas(model) => model.slab.as_ref().map_or(&[], |slab| slab.clusters()),
        }
    }

    /// K of interfaces.
    pub(super) fn stiffness(&self) -> f64 {
        match &self.0 {
            Kind::BuiltIn(_, loading) => loading.stiffness,
            Kind::Formulas(model) => model.stiffness(),
        }
    }

    /// V_H of interfaces; 0 where nothing is driven.
    pub(super) fn driving(&self) -> f64 {
        match &self.0 {
            Kind::BuiltIn(_, loading) => loading.driving,
            Kind::Formulas(model) => model.driving(),
        }
    }

    /// Whether two interfaces have other constants than each other.
    pub(super) fn differ(&self) -> bool {
        match &self.0 {
            Kind::BuiltIn(system, _) => system.unequal.is_some(),
            Kind::Formulas(model) => {
                let slab = model.slab.as_ref();
                slab.is_some_and(|slab| slab.differ(&model.system))
            }
        }
    }

    /// The slip rate of each interface or cluster at values of all states.
    pub(super) fn slip_rate(&self) -> SlipRate {
        match &self.0 {
            Kind::BuiltIn(system, _) => {
                let laws = system.laws();
                Arc::new(move |i, y, _| {
                    let law = &laws[i];
                    law.slip_rate(law.activation(y[0]), y[i + 1].exp())
                })
            }
            Kind::Formulas(model) => {
                let model = Arc::clone(model);
                Arc::new(move |i, y, time| match model.system.is_timed() {
                    true => {
                        let all: Vec<f64> = y.iter().copied().chain([time]).collect();
                        model.system.slip_rates(&all)[i]
                    }
                    false => model.system.slip_rates(y)[i],
                })
            }
        }
    }

    /// The values of all states that a text, or where there is none the system itself, says that a run starts at.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Parameter`] for what can't be read or is outside its domain.
    ///
    /// Under a program a single interface begins at its steady state, as experiments do: there is no symmetry to leave.
    pub(super) fn start(&self, text: Option<&str>, is_programmed: bool) -> Result<Vector> {
        match &self.0 {
            Kind::BuiltIn(system, loading) => {
                let is_steady = is_programmed && system.interfaces == 1 && loading.driving > 0.0;
                let usual = if is_steady { STEADY_START } else { USUAL_START };
                let text = text.unwrap_or(usual);
                let (tau, log_state) = plan::start(text, system, loading)?;
                let all = [tau, log_state[0], log_state[1]];
                Ok(Vector::from_column_slice(&all[..=system.interfaces]))
            }
            Kind::Formulas(model) => {
                let is_one = model
                    .slab
                    .as_ref()
                    .is_some_and(|slab| slab.interfaces() == 1);
                model.start(text.or((is_programmed && is_one).then_some(STEADY_START)))
            }
        }
    }

    /// That the law has these values of the states.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a state beyond those that it keeps to.
    pub(super) fn allowed(&self, start: &Vector) -> Result<()> {
        match self.closed_forms() {
            Some((system, _)) => plan::bounded([start[1], start[system.interfaces]], system),
            None => Ok(()),
        }
    }

    /// The smallest subspace that a motion from these values of all states stays in, and the values there.
    pub(super) fn reduced(&self, start: Vector) -> (Subspace, Vector) {
        match &self.0 {
            Kind::BuiltIn(system, _)
                if system.unequal.is_none() && start.len() == 3 && start[1] == start[2] =>
            {
                (Subspace::Symmetric, start.rows(0, 2).into_owned())
            }
            _ => (Subspace::Whole, start),
        }
    }

    /// The method and the tolerances, checked.
    pub(super) fn numerics(&self, options: &NumericsOptions) -> Result<(Choice, Tolerances)> {
        if options.max_steps == 0 {
            return Err(Error::parameter("max-steps", 0, "at least 1"));
        }
        let tolerances = self.tolerances(options.rtol, options.atol)?;
        let tolerances = plan::stepping(tolerances, options.max_step, self.units())?;
        Ok((Choice::named(&options.method)?, tolerances))
    }

    /// The tolerances of its states, both those of rtol where atol is not given.
    ///
    /// # Errors
    /// [`Error::Parameter`] for one outside its domain.
    pub(super) fn tolerances(&self, rtol: f64, atol: Option<f64>) -> Result<Tolerances> {
        match self.slides() {
            true => plan::tolerances(rtol, atol),
            false => Tolerances::new(rtol, atol.unwrap_or(rtol)),
        }
    }

    /// The units of a run from here that lasts so long, which grow with it.
    pub(super) fn units_of_lasting_run(
        &self,
        (start, begin): (&Vector, f64),
        lasting: f64,
        atol_is_given: bool,
    ) -> Result<MotionUnits> {
        match self.formulas().filter(|_| !self.slides() && !atol_is_given) {
            None => Ok(MotionUnits::given(start.len())),
            Some(model) => {
                let begin = model.at_time(start.clone(), begin);
                MotionUnits::beginning(&model.system, &begin, lasting)
            }
        }
    }

    /// The units of a run from here, in which states may be followed by their logarithms.
    pub(super) fn units_of_run(&self, start: &Vector) -> Result<MotionUnits> {
        match self.formulas() {
            None => Ok(MotionUnits::given(start.len())),
            Some(model) => model.motion_units_of_run(start),
        }
    }

    /// The units with the logarithms of states that fell below the range of doubles; `None` where none did.
    pub(super) fn units_below_doubles(
        &self,
        units: &MotionUnits,
        start: &Vector,
    ) -> Option<MotionUnits> {
        self.formulas()?.units_below_doubles(units, start)
    }

    /// The absolute tolerance as it is told: one number, or one for each state.
    pub(super) fn absolute_tolerance(
        &self,
        units: &MotionUnits,
        atol: f64,
        is_given: bool,
    ) -> Value {
        match self.formulas() {
            None => json!(atol),
            Some(model) => model.absolute_tolerance(units, atol, is_given),
        }
    }

    /// The longest time to wait for a return to a section where nobody says otherwise.
    pub(super) fn patience(&self, units: &MotionUnits) -> f64 {
        /// In the time in which the liveliest state goes through its range.
        const PATIENCE: f64 = 1e4;
        match self.slides() {
            true => usual_patience(self.driving(), self.stiffness()),
            false => PATIENCE * units.time,
        }
    }

    /// The steady stress at the mean slip rate, of interfaces.
    pub(super) fn mean_stress(&self) -> Result<Option<f64>> {
        match &self.0 {
            Kind::BuiltIn(system, loading) => Ok(Some(system.steady_stress(loading.driving))),
            Kind::Formulas(model) => {
                let slab = model.slab.as_ref();
                slab.map(|slab| slab.mean_stress(&model.system)).transpose()
            }
        }
    }

    /// The variables in which power series are made.
    pub(super) fn series_variables(&self) -> SeriesVariables {
        match &self.0 {
            Kind::BuiltIn(..) => SeriesVariables::LogStates,
            Kind::Formulas(_) => SeriesVariables::Plain,
        }
    }

    /// How formulas are evaluated, of systems that have these.
    pub(super) fn formulas_in_words(&self) -> Option<String> {
        self.formulas().map(|_| used_compiling().in_words().into())
    }

    /// The equations of a run at its own V_H.
    pub(super) fn equations(&self, subspace: Subspace) -> Equations<'_> {
        match &self.0 {
            Kind::BuiltIn(system, loading) => Equations::BuiltIn {
                system,
                loading: *loading,
                rate: 0.0,
                subspace,
            },
            Kind::Formulas(model) => {
                Equations::Formulas(Cow::Borrowed(&model.system), model.slab.is_some())
            }
        }
    }

    /// The equations of a stretch of a run: on a ramp V_H is their last variable.
    ///
    /// # Errors
    /// Those of the formulas.
    pub(super) fn on(&self, stretch: &Stretch, subspace: Subspace) -> Result<Equations<'_>> {
        match &self.0 {
            Kind::BuiltIn(system, loading) => Ok(Equations::BuiltIn {
                system,
                loading: Loading {
                    driving: stretch.driving.0,
                    ..*loading
                },
                rate: stretch.rate(),
                subspace,
            }),
            Kind::Formulas(model) => Ok(Equations::Formulas(
                model.on(stretch)?,
                model.slab.is_some(),
            )),
        }
    }
}

impl Described for AnySystem {
    fn echo(&self) -> &Map<String, Value> {
        match &self.0 {
            Kind::BuiltIn(system, _) => system.echo(),
            Kind::Formulas(model) => model.echo(),
        }
    }

    fn units(&self) -> &Units {
        match &self.0 {
            Kind::BuiltIn(system, _) => system.units(),
            Kind::Formulas(model) => model.units(),
        }
    }
}
