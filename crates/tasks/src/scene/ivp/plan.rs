//! What an initial value problem is of, checked.

use super::chart::Chart;
use crate::scene::any_system::AnySystem;
use crate::scene::equations::{Equations, Subspace};
use crate::scene::options::{ModelOptions, NumericsOptions};
use crate::scene::system::Described;
use crate::scene::units::Units;
use serde_json::{Map, Value};
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::friction::positive;
use twinslip::integrate::{AnyIntegrator, Choice, Tolerances};

/// An initial value problem, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct IvpPlan {
    system: AnySystem,
    subspace: Subspace,
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
        let system = AnySystem::in_time(model, None)?;
        if system.units().si() && system.layout().is_some_and(|all| all.mass) {
            return Err(Error::Input(
                "`si`: solve_ivp takes interfaces with `mass` without units alone; `integrate` has them".into(),
            ));
        }
        let chart = Chart::new(&system, Subspace::Whole);
        let from = Vector::from_vec(started(&chart, start, &names(&system))?);
        system.allowed(&from)?;
        let (method, tolerances) = system.numerics(numerics)?;
        let (subspace, from) = system.reduced(from);
        let chart = Chart::new(&system, subspace);
        let inner_span = (chart.time_inward(span.0), chart.time_inward(span.1));
        if !inner_span.0.is_finite() || !inner_span.1.is_finite() || inner_span.0 == inner_span.1 {
            let must = "of two times that differ and are within doubles without their unit";
            return Err(Error::parameter("span", told(span), must));
        }
        let from = match system.is_timed() {
            true => from.push(inner_span.0),
            false => from,
        };
        let plan = IvpPlan {
            system,
            subspace,
            chart,
            span,
            start: start.to_vec(),
            inner_span,
            from,
            method,
            tolerances,
            max_steps: numerics.max_steps,
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
        names(&self.system)
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
    pub(super) fn equations(&self) -> Equations<'_> {
        self.system.equations(self.subspace)
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
        self.system.echo()
    }

    fn units(&self) -> &Units {
        self.system.units()
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

/// The names of the values: psi stands in the place of its logarithm.
fn names(system: &AnySystem) -> Vec<String> {
    let states = system.states().into_iter();
    let name = |name: std::borrow::Cow<'static, str>| match system.slides() {
        true => name.trim_start_matches("log_").to_owned(),
        false => name.into_owned(),
    };
    states.map(name).collect()
}
