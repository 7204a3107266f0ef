//! What an initial value problem is of, checked.

use super::chart::Chart;
use crate::scene::options::{ModelOptions, NumericsOptions};
use crate::scene::plan::{self, Dimension, bounded};
use crate::scene::system::{Described, System};
use crate::scene::text::{self, TextModel};
use crate::scene::units::Units;
use serde_json::{Map, Value};
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::friction::positive;
use twinslip::integrate::{AnyField, AnyIntegrator, Choice, Tolerances};
use twinslip::model::{self, Loading};

/// An initial value problem, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct IvpPlan {
    model: Model,
    pub(super) chart: Chart,
    /// The user's.
    pub(super) span: (f64, f64),
    pub(super) start: Vec<f64>,
    /// What is integrated: dimensionless times, and the variables, of which the last may be time.
    pub(super) inner_span: (f64, f64),
    pub(super) from: Vector,
    method: Choice,
    tolerances: Tolerances,
    max_steps: usize,
}

/// What moves.
#[derive(Debug, Clone, PartialEq)]
enum Model {
    /// One or two interfaces with a law that is built in.
    Slab(Box<System>, Loading, Dimension),
    /// Interfaces with a law from a file, or a system from one.
    Text(Box<TextModel>),
}

impl IvpPlan {
    /// A solution over a span of time, its beginning first: where that is the later one it goes back in time. It starts at the values of
    /// (tau, psi_1, psi_2, ...), or at those of all states of a system in their order.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`] in the user's own names: `start`, `span` and those of the options; [`Error::File`].
    pub fn new(
        model: &ModelOptions,
        numerics: &NumericsOptions,
        span: (f64, f64),
        start: &[f64],
    ) -> Result<Self> {
        checked_span(span)?;
        if let Some(i) = start.iter().position(|x| !x.is_finite()) {
            return Err(Error::parameter(format!("start[{i}]"), start[i], "finite"));
        }
        let (model, chart, from, numerics) = match TextModel::in_time(model, &[])? {
            Some(text) => {
                let slides = text.slab.is_some();
                let chart = Chart::new(text.system.states().len(), slides, false, text.units());
                let from = started(&chart, start, &text_names(&text))?;
                let numerics = (text::numerics(numerics, text.units())?, numerics.max_steps);
                (Model::Text(Box::new(text)), chart, from, numerics)
            }
            None => {
                let system = System::new(model)?;
                let loading = system.loading()?;
                let whole = Chart::new(system.interfaces + 1, true, false, &system.units);
                let mut from = started(&whole, start, &slab_names(system.interfaces))?;
                let both = [from[1], from[system.interfaces]];
                bounded(both, &system)?;
                let dimension = Dimension::of(&system, &(from[0], both));
                let variables = dimension.number();
                from.truncate(variables);
                let doubled = dimension == Dimension::Symmetric;
                let chart = Chart::new(variables, true, doubled, &system.units);
                let numerics = (plan::numerics(numerics, &system.units)?, numerics.max_steps);
                let model = Model::Slab(Box::new(system), loading, dimension);
                (model, chart, from, numerics)
            }
        };
        let ((method, tolerances), max_steps) = numerics;
        let inner_span = (chart.time_inward(span.0), chart.time_inward(span.1));
        if !inner_span.0.is_finite() || !inner_span.1.is_finite() || inner_span.0 == inner_span.1 {
            let must = "of two times that differ and are within doubles without their unit";
            return Err(Error::parameter("span", told(span), must));
        }
        let from = Vector::from_vec(from);
        let from = match &model {
            Model::Text(text) => text.at_time(from, inner_span.0),
            Model::Slab(..) => from,
        };
        let plan = IvpPlan {
            model,
            chart,
            span,
            start: start.to_vec(),
            inner_span,
            from,
            method,
            tolerances,
            max_steps,
        };
        // It says what is wrong with the numerics.
        plan.integrator()?;
        Ok(plan)
    }

    /// How many values there are at a time.
    pub fn dimension(&self) -> usize {
        self.chart.values()
    }

    /// What the values are called: `stress`, `state_1`, ..., or the states of a system.
    pub fn names(&self) -> Vec<String> {
        match &self.model {
            Model::Slab(system, ..) => slab_names(system.interfaces),
            Model::Text(text) => text_names(text),
        }
    }

    /// The span, its beginning first.
    pub fn span(&self) -> (f64, f64) {
        self.span
    }

    /// The method that runs it.
    pub fn method(&self) -> Choice {
        self.method
    }

    /// The tolerances of the variables that are integrated: of interfaces tau and ln psi, dimensionless.
    pub fn tolerances(&self) -> Tolerances {
        self.tolerances
    }

    /// What is integrated.
    pub(super) fn field(&self) -> Result<AnyField<'_>> {
        let (system, loading, dimension) = match &self.model {
            Model::Text(text) => return text.field(),
            Model::Slab(system, loading, dimension) => (system, *loading, dimension),
        };
        let law = system.law;
        Ok(match (dimension, system.unequal(loading)) {
            (Dimension::Single, _) => AnyField::new::<2>(model::single_interface(law, loading)),
            (Dimension::Symmetric, _) => AnyField::new::<2>(model::symmetric(law, loading)),
            (Dimension::Full, Some(unequal)) => AnyField::new::<3>(Box::new(unequal)),
            (Dimension::Full, None) => AnyField::new::<3>(model::two_interfaces(law, loading)),
        })
    }

    pub(super) fn integrator(&self) -> Result<AnyIntegrator> {
        AnyIntegrator::new(self.method, self.tolerances, self.max_steps)
    }

    /// The user's time; that of the ends is what was given, whatever the conversion rounds.
    pub(super) fn time_outward(&self, time: f64) -> f64 {
        let (begin, end) = self.span;
        if time == self.inner_span.1 {
            return end;
        }
        self.chart
            .time_outward(time)
            .clamp(begin.min(end), begin.max(end))
    }
}

impl Described for IvpPlan {
    fn echo(&self) -> &Map<String, Value> {
        match &self.model {
            Model::Slab(system, ..) => system.echo(),
            Model::Text(text) => text.echo(),
        }
    }

    fn units(&self) -> &Units {
        match &self.model {
            Model::Slab(system, ..) => &system.units,
            Model::Text(text) => text.units(),
        }
    }
}

fn checked_span(span: (f64, f64)) -> Result<()> {
    if span.0.is_finite() && span.1.is_finite() && span.0 != span.1 {
        return Ok(());
    }
    Err(Error::parameter(
        "span",
        told(span),
        "of two finite times that differ",
    ))
}

fn told((begin, end): (f64, f64)) -> String {
    format!("({begin}, {end})")
}

/// The variables at the start.
fn started(chart: &Chart, start: &[f64], names: &[String]) -> Result<Vec<f64>> {
    if start.len() != names.len() {
        let must = format!("{}: {}", names.len(), names.join(", "));
        return Err(Error::parameter(
            "the number of values of `start`",
            start.len(),
            must,
        ));
    }
    if !chart.slides {
        return Ok(start.to_vec());
    }
    let [_, stress, state] = chart.units;
    let mut from = vec![start[0] / stress];
    for (i, &psi) in start.iter().enumerate().skip(1) {
        let name = format!("start[{i}] ({})", names[i]);
        from.push((positive(&name, psi)? / state).ln());
    }
    match from.iter().position(|x| !x.is_finite()) {
        None => Ok(from),
        Some(i) => Err(Error::parameter(
            format!("start[{i}] ({})", names[i]),
            start[i],
            "within doubles without its unit",
        )),
    }
}

fn slab_names(interfaces: usize) -> Vec<String> {
    let states = (1..=interfaces).map(|i| format!("state_{i}"));
    std::iter::once("stress".to_owned()).chain(states).collect()
}

fn text_names(text: &TextModel) -> Vec<String> {
    match &text.slab {
        Some(slab) => slab_names(slab.clusters().len()),
        None => {
            let states = text.system.states().iter();
            states.map(|&name| name.to_owned()).collect()
        }
    }
}
