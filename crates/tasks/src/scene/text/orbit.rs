//! A periodic orbit of a user-defined system.

use super::model::TextModel;
use super::plan::{TextPlan, text_columns};
use crate::scene::options::OrbitOptions;
use crate::scene::orbit::{dense_output, run_method, second, worth};
use crate::scene::plan::{Sampling, equally_spaced, longest_in_words, stepping};
use crate::scene::system::Described;
use serde_json::Value;
use std::sync::OnceLock;
use twinslip::equilibrium::Symmetry;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::friction::positive;
#[cfg(not(feature = "sundials"))]
use twinslip::integrate::RosenbrockMethod;
use twinslip::integrate::{AnyField, Choice, MotionUnits, Tolerances, used_compiling};
use twinslip::orbit::{
    AlongArcs, Crosscheck, FoundOrbit, Orbit, OrbitAccuracy, ShootingNodes, crosscheck_of,
    find_from,
};
#[cfg(feature = "sundials")]
use twinslip::sundials::MultistepMethod;

/// A periodic orbit that is asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct TextOrbitPlan {
    /// The system.
    pub model: TextModel,
    /// The units in which it is looked for.
    units: MotionUnits,
    /// Those in which it was, where a state fell below what doubles hold.
    logarithmic: OnceLock<MotionUnits>,
    /// At or near the orbit.
    pub start: Vector,
    /// The period, roughly, where it is given.
    pub period: Option<f64>,
    /// By which method.
    pub accuracy: OrbitAccuracy,
    /// Whether the absolute tolerance is the user's, in the system's own units.
    atol_is_given: bool,
    /// By which second method once more.
    pub second: Option<OrbitAccuracy>,
    /// Whether the user names it.
    pub second_is_asked: bool,
    /// The rows over one period, where there are to be any.
    pub rows: Option<Sampling>,
    /// Whether the orbit is drawn.
    pub picture: bool,
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
        let tolerances = Tolerances::new(rtol, options.atol.unwrap_or(rtol))?;
        let accuracy = OrbitAccuracy {
            max_steps: options.max_steps,
            tolerances: stepping(tolerances, options.max_step, model.units())?,
            ..usual
        };
        let guess = |period| positive("period-guess", period);
        let start = orbit_start(options.start.as_deref(), symmetry(options, &model)?, &model)?;
        Ok(TextOrbitPlan {
            units: model.motion_units_of_run(&start)?,
            logarithmic: OnceLock::new(),
            atol_is_given: options.atol.is_some(),
            start,
            period: options.period_guess.map(guess).transpose()?,
            second: second(options.crosscheck.as_deref(), &accuracy)?,
            second_is_asked: options.crosscheck.is_some(),
            rows: options.points.map(equally_spaced).transpose()?,
            picture: options.plot.is_some(),
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
  method            {}, tangents on, multiple shooting; rtol {:e}{}
  formulas          {}
  crosscheck        {second}
  dense output      {}",
            self.start.len(),
            run_method(self.accuracy.method).name(),
            self.accuracy.tolerances.rtol,
            longest_in_words(self.accuracy.tolerances, self.model.units()),
            used_compiling().in_words(),
            dense_output(self.rows, self.picture)
        )
    }

    /// Finds the orbit.
    ///
    /// # Errors
    /// Those of [`find_from`].
    pub fn find(&self) -> Result<FoundOrbit> {
        let mut found = self.found();
        if let Err(Error::Underflow { .. } | Error::NotConverged { .. }) = found
            && let Some(units) = self.model.units_below_doubles(&self.units, &self.start)
        {
            self.logarithmic.get_or_init(|| units);
            // Where that is of no use either the first failure is told.
            found = self.found().or(found);
        }
        let units = self.units();
        let found = found.map_err(|error| units.outward_error(error, 0))?;
        let others = found.others.into_iter();
        let mut found = FoundOrbit {
            orbit: units.outward_orbit(found.orbit),
            others: others.map(|other| units.outward_orbit(other)).collect(),
        };
        for orbit in std::iter::once(&mut found.orbit).chain(&mut found.others) {
            self.complete(orbit, &self.accuracy)?;
        }
        Ok(found)
    }

    fn found(&self) -> Result<FoundOrbit> {
        let units = self.units();
        find_from(
            &self.field()?,
            &units.inward(&self.start),
            self.period.map(|period| period / units.time),
            &units.inward_accuracy(self.accuracy, self.atol_is_given),
        )
    }

    fn units(&self) -> &MotionUnits {
        self.logarithmic.get().unwrap_or(&self.units)
    }

    /// The absolute tolerance of this accuracy as it is told.
    pub fn told_atol(&self, accuracy: &OrbitAccuracy) -> Value {
        let atol = accuracy.tolerances.atol;
        self.model
            .absolute_tolerance(self.units(), atol, self.atol_is_given)
    }

    /// The field in the units in which the orbit is looked for.
    fn field(&self) -> Result<AnyField<'static>> {
        self.units().field(&self.model.system)
    }

    /// With its multipliers within clusters, by the method that it was found by.
    fn complete(&self, orbit: &mut Orbit, accuracy: &OrbitAccuracy) -> Result<()> {
        let Some(slab) = &self.model.slab else {
            return Ok(());
        };
        let vector = |node: &Vec<f64>| Vector::from_column_slice(node);
        let shooting = ShootingNodes {
            nodes: orbit.nodes.iter().map(vector).collect(),
            durations: orbit.durations.clone(),
        };
        let along = AlongArcs {
            method: accuracy.method,
            tolerances: accuracy.tolerances,
            uncertainty: orbit.point_uncertainty,
        };
        orbit.floquet.within = slab.within(&self.model.system, &shooting, along)?;
        Ok(())
    }

    /// How accurately an orbit was computed, and is to be once more: of a stiff system by other methods than those of the plan.
    pub fn accuracies(&self, orbit: &Orbit) -> (OrbitAccuracy, Option<OrbitAccuracy>) {
        if orbit.method == run_method(self.accuracy.method).name() {
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

    /// The run over one period of an orbit, from its point back to it, along the arcs between its shooting nodes. `None` where neither
    /// rows nor a picture are asked for.
    pub fn along(&self, orbit: &Orbit) -> Option<TextPlan> {
        if self.rows.is_none() && !self.picture {
            return None;
        }
        let vector = |y: &[f64]| Vector::from_column_slice(y);
        // A node where a state is below the doubles is gone past.
        let is_held = |node: &(f64, &[f64])| {
            let inward = self.units().inward(&vector(node.1));
            inward.iter().all(|x| x.is_finite())
        };
        let nodes = orbit.nodes_since_point().into_iter().filter(is_held);
        let (OrbitAccuracy { tolerances, .. }, _) = self.accuracies(orbit);
        let method = Choice::named(orbit.method).unwrap_or(self.accuracy.method);
        Some(TextPlan {
            program: None,
            start: vector(&orbit.point),
            nodes: nodes.map(|(time, node)| (time, vector(node))).collect(),
            until: orbit.period.value,
            sampling: self.rows.unwrap_or(Sampling::FinalOnly),
            columns: text_columns(&self.model),
            picture: self.picture,
            estimate: None,
            asked_method: method.name().into(),
            method,
            tolerances,
            atol_is_given: self.atol_is_given,
            units: self.units().clone(),
            max_steps: self.accuracy.max_steps,
            model: self.model.clone(),
        })
    }

    /// The orbit once more, by the second method; `None` where there is none.
    ///
    /// # Errors
    /// Those of [`crosscheck_of`].
    pub fn crosscheck(&self, orbit: &Orbit) -> Result<Option<Crosscheck>> {
        let (_, Some(second)) = self.accuracies(orbit) else {
            return Ok(None);
        };
        let second = match self.second_is_asked {
            true => second,
            false => worth(second, orbit),
        };
        let units = self.units();
        let inward = units.inward_accuracy(second, self.atol_is_given);
        let known = units.inward_orbit(orbit);
        if !known.nodes.iter().flatten().all(|x| x.is_finite()) {
            return Err(Error::Input(
                "on the orbit a state is below the least double".into(),
            ));
        }
        let again = crosscheck_of(&self.field()?, &known, &inward)
            .map_err(|error| units.outward_error(error, 0))?;
        let mut again = units.outward_crosscheck(again);
        self.complete(&mut again.orbit, &second)?;
        Ok(Some(again))
    }
}

/// Where the search begins. Interfaces that start alike stay so: their symmetric orbits are found from such a start, and others from one
/// beside it.
pub(in crate::scene) fn orbit_start(
    given: Option<&str>,
    symmetry: Symmetry,
    model: &TextModel,
) -> Result<Vector> {
    match (&model.slab, given) {
        (Some(slab), None) if symmetry == Symmetry::Symmetric => {
            Ok(Vector::from_vec(slab.alike(&model.system)?))
        }
        _ => model.start(given),
    }
}

fn symmetry(options: &OrbitOptions, model: &TextModel) -> Result<Symmetry> {
    let name = options.symmetry.as_deref().unwrap_or("symmetric");
    let symmetry = Symmetry::named(name)
        .ok_or_else(|| Error::unknown("symmetry", name, &["symmetric", "asymmetric"]))?;
    if let (Some(slab), Some(name)) = (&model.slab, &options.symmetry) {
        let refused = |why: &str| Err(Error::Input(format!("`symmetry` {name}: {why}")));
        if slab.differ(&model.system) {
            return refused("unequal interfaces have no symmetric orbits; leave it out");
        }
        if slab.clusters().len() == 1 && symmetry == Symmetry::Asymmetric {
            return refused("what moves alike has nothing to differ from");
        }
        if let Some(text) = &options.start {
            let start = model.start(Some(text))?;
            let alike = start.iter().skip(2).all(|state| *state == start[1]);
            if alike != (symmetry == Symmetry::Symmetric) {
                let how = if alike { "alike" } else { "apart" };
                return refused(&format!("in `start` {text} the interfaces move {how}"));
            }
        }
    }
    Ok(symmetry)
}
