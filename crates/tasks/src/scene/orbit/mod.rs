//! A periodic orbit from options: which one, where the search begins, how accurately, and by which second method.

mod derivatives;
mod search;

use super::any_system::AnySystem;
use super::equations::Subspace;
use super::instant::run_columns;
use super::options::{ModelOptions, OrbitOptions};
use super::plan::{Plan, Sampling, equally_spaced, longest_in_words, stepping};
use super::system::Described;
pub use derivatives::OrbitDerivatives;
use search::Search;
use serde_json::Value;
use twinslip::equilibrium::Symmetry;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
#[cfg(not(feature = "sundials"))]
use twinslip::integrate::RosenbrockMethod;
use twinslip::integrate::{Choice, MotionUnits, Tolerances};
use twinslip::orbit::{Crosscheck, FoundOrbit, Orbit, OrbitAccuracy, PhaseResponse};
#[cfg(feature = "sundials")]
use twinslip::sundials::MultistepMethod;

/// A periodic orbit that is asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct OrbitPlan {
    /// The system.
    pub system: AnySystem,
    /// How the orbit is looked for.
    search: Search,
    /// By which method.
    pub accuracy: OrbitAccuracy,
    /// Whether the absolute tolerance is the user's, in the system's own units.
    atol_is_given: bool,
    /// By which second method once more.
    pub second: Option<OrbitAccuracy>,
    /// Whether the user names it.
    pub second_is_asked: bool,
    /// The rows of a run over one period, where there are to be any.
    pub rows: Option<Sampling>,
    /// At how many points the phase response is asked for.
    pub response: Option<usize>,
    /// The parameters in which derivatives are asked for, and the options of the model.
    derivatives: Option<(Vec<String>, ModelOptions)>,
    /// Whether the orbit is drawn.
    pub picture: bool,
}

impl OrbitPlan {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &OrbitOptions) -> Result<Self> {
        let system = AnySystem::new(&options.model)?;
        let search = Search::new(options, &system)?;
        let accuracy = accuracy(options, &system)?;
        if options.phase_response && system.forcing_period().is_some() {
            return Err(Error::Input(
                "`phase_response` is of an orbit whose phase is free: under a periodic forcing no kick moves it".into(),
            ));
        }
        let derivatives = options.derivatives.as_deref();
        let derivatives = derivatives.map(|text| derivatives::names(text, &system));
        let derivatives = derivatives.transpose()?;
        let rows = options.points.map(equally_spaced).transpose()?;
        let points = options.points.unwrap_or(RESPONSES);
        let response = options.phase_response.then_some(points);
        Ok(OrbitPlan {
            search,
            atol_is_given: options.atol.is_some(),
            second: second(options.crosscheck.as_deref(), &accuracy)?,
            second_is_asked: options.crosscheck.is_some(),
            rows: rows.filter(|_| response.is_none()),
            response,
            derivatives: derivatives.map(|names| (names, options.model.clone())),
            picture: options.plot.is_some(),
            accuracy,
            system,
        })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let second = match &self.second {
            Some(second) => format!(
                "{}, from nodes rounded to three digits; rtol {:e}",
                second.method.name(),
                second.tolerances.rtol
            ),
            None => "off: `crosscheck` none".to_owned(),
        };
        let formulas = self.system.formulas_in_words();
        let formulas = formulas.map_or_else(String::new, |words| {
            format!("\n  formulas          {words}")
        });
        format!(
            "plan of this command
  dimension         {}
  guess             {}
  method            {}, tangents on, multiple shooting; rtol {:e}{}{formulas}
  uncertainties     the noise of all arcs, and two more solutions: at other nodes, and with a tolerance 8 times larger
  crosscheck        {second}
  dense output      {}",
            self.search.dimension(),
            self.search.guess(),
            method_name(self.accuracy.method),
            self.accuracy.tolerances.rtol,
            longest_in_words(self.accuracy.tolerances, self.system.units()),
            dense_output(self.rows, self.picture && self.response.is_none())
        ) + &self.explain_sensitivity()
    }

    /// The lines of what is asked for beside the orbit.
    fn explain_sensitivity(&self) -> String {
        let derivatives = self.derivatives.iter().map(|(names, _)| {
            format!(
                "\n  derivatives       in {}: of the period and the extremes by the linear equations of the orbit, of ln |mu| by extrapolated differences",
                names.join(", ")
            )
        });
        let response = self.response.iter().map(|points| {
            format!(
                "\n  phase response    the adjoint of the tangents, at {points} points; uncertainties by noise and two more solutions"
            )
        });
        derivatives.chain(response).collect()
    }

    /// Finds the orbit.
    ///
    /// # Errors
    /// Those of [`find()`](twinslip::orbit::find), [`find_either()`](twinslip::orbit::find_either),
    /// [`find_unequal()`](twinslip::orbit::find_unequal) and [`find_from()`](twinslip::orbit::find_from).
    pub fn find(&self) -> Result<FoundOrbit> {
        let mut found = self
            .search
            .find(&self.system, &self.accuracy, self.atol_is_given)?;
        for orbit in std::iter::once(&mut found.orbit).chain(&mut found.others) {
            self.complete(orbit, &self.accuracy)?;
        }
        Ok(found)
    }

    /// With its multipliers within clusters, by the method that it was found by.
    fn complete(&self, orbit: &mut Orbit, accuracy: &OrbitAccuracy) -> Result<()> {
        let Some(model) = self.system.formulas() else {
            return Ok(());
        };
        let is_forced = self.system.forcing_period().is_some();
        let layout = self.system.layout();
        if let Some(layout) = layout.filter(|all| all.has_more() || is_forced) {
            let states = (0..layout.parts).map(|part| layout.log_state(0, part));
            let least = states.map(|place| orbit.extremes[place][0].value);
            orbit.state_min = least.fold(f64::INFINITY, f64::min).exp();
        }
        model.complete_orbit(orbit, accuracy)
    }

    /// The units in which the orbit is looked for.
    fn units(&self) -> MotionUnits {
        let given = || MotionUnits::given(self.system.states().len());
        self.search.units().cloned().unwrap_or_else(given)
    }

    /// The absolute tolerance of this accuracy as it is told.
    pub fn told_atol(&self, accuracy: &OrbitAccuracy) -> Value {
        let atol = accuracy.tolerances.atol;
        self.system
            .absolute_tolerance(&self.units(), atol, self.atol_is_given)
    }

    /// How accurately an orbit was computed, and is to be once more: of a stiff system by other methods than those of the plan.
    pub fn accuracies(&self, orbit: &Orbit) -> (OrbitAccuracy, Option<OrbitAccuracy>) {
        if orbit.method == method_name(self.accuracy.method) {
            return (self.accuracy, self.second);
        }
        #[cfg(feature = "sundials")]
        let implicit = Choice::Cvode(MultistepMethod::Bdf);
        #[cfg(not(feature = "sundials"))]
        let implicit = Choice::Rosenbrock(RosenbrockMethod::Rodas4);
        let second = self.second.map(|second| match self.second_is_asked {
            true => second,
            false => OrbitAccuracy {
                checked: false,
                ..OrbitAccuracy::of(implicit).stepping(second.tolerances.max_step)
            },
        });
        (self.accuracy.stiff(), second)
    }

    /// The run over one period of an orbit, from its point back to it: along the arcs between its shooting nodes, each from its own
    /// node, as an unstable orbit is soon left. `None` where neither rows nor a picture are asked for.
    pub fn along(&self, orbit: &Orbit) -> Option<Plan> {
        if self.rows.is_none() && !(self.picture && self.response.is_none()) {
            return None;
        }
        let vector = |y: &[f64]| Vector::from_column_slice(y);
        let units = self.units();
        // A node where a state is below the doubles is gone past.
        let is_held = |node: &(f64, &[f64])| {
            let inward = units.inward(&vector(node.1));
            inward.iter().all(|x| x.is_finite())
        };
        let nodes = orbit.nodes_since_point().into_iter().filter(is_held);
        let (OrbitAccuracy { tolerances, .. }, _) = self.accuracies(orbit);
        let method = Choice::named(orbit.method).unwrap_or(self.accuracy.method);
        // Where both interfaces move alike they share a state.
        let subspace = match orbit.point.len() < self.system.states().len() {
            true => Subspace::Symmetric,
            false => Subspace::Whole,
        };
        Some(Plan {
            program: None,
            subspace,
            start: vector(&orbit.point),
            nodes: nodes.map(|(time, node)| (time, vector(node))).collect(),
            until: orbit.period.value,
            sampling: self.rows.unwrap_or(Sampling::FinalOnly),
            columns: run_columns(&self.system),
            events: None,
            picture: self.picture,
            estimate: None,
            asked_method: method.name().into(),
            method,
            tolerances,
            atol_is_given: self.atol_is_given,
            units,
            max_steps: self.accuracy.max_steps,
            system: self.system.clone(),
        })
    }

    /// The derivatives of an orbit in the parameters that are asked for.
    ///
    /// # Errors
    /// Those of [`sensitivity()`](twinslip::orbit::sensitivity).
    pub fn derivatives(&self, orbit: &Orbit) -> Result<Vec<OrbitDerivatives>> {
        let Some((names, model)) = &self.derivatives else {
            return Ok(Vec::new());
        };
        let (accuracy, _) = self.accuracies(orbit);
        let accuracy = (&accuracy, self.atol_is_given);
        let of = (&self.system, model);
        let one = |name: &String| derivatives::derivatives(&self.search, of, orbit, accuracy, name);
        names.iter().map(one).collect()
    }

    /// The phase response along an orbit, in all states; `None` where it is not asked for.
    ///
    /// # Errors
    /// Those of [`phase_response()`](twinslip::orbit::phase_response).
    pub fn responses(&self, orbit: &Orbit) -> Result<Option<Vec<PhaseResponse>>> {
        let Some(points) = self.response else {
            return Ok(None);
        };
        let (accuracy, _) = self.accuracies(orbit);
        let accuracy = (&accuracy, self.atol_is_given);
        let mut rows = self
            .search
            .responses(&self.system, orbit, accuracy, points)?;
        let (states, own) = (self.system.states().len(), orbit.point.len());
        if own < states {
            // Interfaces that move alike share a state, and each has its part of the response.
            rows.iter_mut().for_each(|row| row.share_last(states));
        }
        Ok(Some(rows))
    }

    /// The orbit once more, by the second method; `None` where there is none.
    ///
    /// # Errors
    /// Those of [`crosscheck()`](twinslip::orbit::crosscheck) and [`crosscheck_of`](twinslip::orbit::crosscheck_of).
    pub fn crosscheck(&self, orbit: &Orbit) -> Result<Option<Crosscheck>> {
        let (_, Some(second)) = self.accuracies(orbit) else {
            return Ok(None);
        };
        let second = match self.second_is_asked {
            true => second,
            false => worth(second, orbit),
        };
        let mut again = self
            .search
            .crosscheck(&self.system, orbit, &second, self.atol_is_given)?;
        self.complete(&mut again.orbit, &second)?;
        Ok(Some(again))
    }

    /// Whether all interfaces move alike on an orbit; `None` of what are none.
    pub fn symmetry(&self, orbit: &Orbit) -> Option<Symmetry> {
        if !self.system.slides() {
            return None;
        }
        if self.system.closed_forms().is_some() {
            return Some(orbit.symmetry);
        }
        let error = orbit.point_uncertainty;
        let same = |x: f64, y: f64| (x - y).abs() <= error * (1.0 + x.abs());
        let slab = self.system.formulas().and_then(|model| model.slab.as_ref());
        let alike = |node: &Vec<f64>| slab.is_some_and(|slab| slab.move_alike(node, same));
        Some(
            match !self.system.differ() && orbit.nodes.iter().all(alike) {
                true => Symmetry::Symmetric,
                false => Symmetry::Asymmetric,
            },
        )
    }
}

/// Points of the phase response where nobody says otherwise.
const RESPONSES: usize = 101;

/// The method with its tolerances, or those that are given.
fn accuracy(options: &OrbitOptions, system: &AnySystem) -> Result<OrbitAccuracy> {
    let usual = OrbitAccuracy::of(Choice::named(&options.method)?);
    if options.max_steps == 0 {
        return Err(Error::parameter("max-steps", 0, "at least 1"));
    }
    let given: Tolerances = match (options.rtol, options.atol) {
        (None, None) => usual.tolerances,
        (rtol, atol) => system.tolerances(rtol.unwrap_or(usual.tolerances.rtol), atol)?,
    };
    Ok(OrbitAccuracy {
        max_steps: options.max_steps,
        tolerances: stepping(given, options.max_step, system.units())?,
        ..usual
    })
}

/// The method of the flow along orbits.
fn run_method(choice: Choice) -> Choice {
    match choice {
        Choice::Auto => Choice::Taylor,
        other => other,
    }
}

fn method_name(choice: Choice) -> &'static str {
    run_method(choice).name()
}

/// The line of the plan about dense output.
fn dense_output(rows: Option<Sampling>, picture: bool) -> &'static str {
    match (rows, picture) {
        (None, false) => "on, for the extremes alone",
        (Some(_), false) => "on, for the extremes and the rows",
        (None, true) => "on, for the extremes and the picture",
        (Some(_), true) => "on, for the extremes, the rows and the picture",
    }
}

/// The method of second opinions. Along orbits Adams takes three fifths of the time of BDF, and is five times nearer at the same
/// tolerance.
#[cfg(feature = "sundials")]
pub const SECOND_METHOD: &str = "cvode-adams";
/// The method of second opinions.
#[cfg(not(feature = "sundials"))]
pub const SECOND_METHOD: &str = "rodas5p";

/// A crosscheck that nobody asks for, in no more steps than the orbit itself took, or than some seconds have.
fn worth(second: OrbitAccuracy, orbit: &Orbit) -> OrbitAccuracy {
    /// As a rule the second method takes a tenth of these.
    const LEAST: usize = 1_000_000;
    OrbitAccuracy {
        all_steps: orbit.work.steps.max(LEAST),
        ..second
    }
}

/// The method of the crosscheck: another one than the first.
fn second(name: Option<&str>, by: &OrbitAccuracy) -> Result<Option<OrbitAccuracy>> {
    let first = by.method;
    let name = match name {
        Some("none") => return Ok(None),
        Some(name) => name,
        None if method_name(first) == SECOND_METHOD => Choice::Taylor.name(),
        None => SECOND_METHOD,
    };
    let method = Choice::named_by("crosscheck", name)?;
    if method_name(method) == method_name(first) {
        return Err(Error::Input(format!(
            "`crosscheck` {name} is the method of the orbit itself; choose another, or none"
        )));
    }
    let second = OrbitAccuracy::of(method).stepping(by.tolerances.max_step);
    Ok(Some(OrbitAccuracy {
        checked: false,
        ..second
    }))
}
