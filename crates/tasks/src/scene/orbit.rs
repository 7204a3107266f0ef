//! A periodic orbit from options: which one, where the search begins, how accurately, and by which second method.

use super::instant::run_columns;
use super::options::OrbitOptions;
use super::plan::{Dimension, Plan, Point, Sampling, equally_spaced, start, stepping, tolerances};
use super::system::System;
use super::units::{Quantity, Units};
use twinslip::equilibrium::Symmetry;
use twinslip::error::{Error, Result};
use twinslip::friction::positive;
use twinslip::integrate::{AnyField, Choice};
use twinslip::model::UnequalInterfaces;
use twinslip::orbit::{
    Crosscheck, FoundOrbit, InitialGuess, InterfaceSystem, Orbit, OrbitAccuracy, Query, crosscheck,
    crosscheck_of, find, find_either, find_unequal,
};

/// A periodic orbit that is asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct OrbitPlan {
    /// What slides.
    pub system: System,
    /// The same for the search; of interfaces that differ with the law of the first.
    pub slab: InterfaceSystem,
    /// Which orbit, and where the search begins.
    pub query: Query,
    /// Whether one of the other symmetry will do as well: the one that runs settle on.
    pub either: bool,
    /// By which method.
    pub accuracy: OrbitAccuracy,
    /// By which second method once more.
    pub second: Option<OrbitAccuracy>,
    /// Whether the user names it.
    pub second_is_asked: bool,
    /// The rows over one period, where there are to be any.
    pub rows: Option<Sampling>,
    /// Whether the orbit is drawn.
    pub picture: bool,
}

impl OrbitPlan {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &OrbitOptions) -> Result<Self> {
        let system = System::new(&options.model)?;
        let slab = InterfaceSystem {
            law: system.law,
            interfaces: system.interfaces,
            loading: system.loading()?,
        };
        let query = Query {
            symmetry: symmetry(options.symmetry.as_deref(), &system)?,
            begin: begin(options, &system, &slab)?,
        };
        let accuracy = accuracy(options, &system.units)?;
        let anywhere = query.begin == InitialGuess::Anywhere;
        let alike = system.interfaces == 2 && system.unequal.is_none();
        Ok(OrbitPlan {
            either: options.symmetry.is_none() && anywhere && alike,
            second: second(options.crosscheck.as_deref(), &accuracy)?,
            second_is_asked: options.crosscheck.is_some(),
            rows: options.points.map(equally_spaced).transpose()?,
            picture: options.plot.is_some(),
            slab,
            query,
            accuracy,
            system,
        })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let dimension = match (self.query.symmetry, self.slab.interfaces) {
            _ if self.system.unequal.is_some() => "3: the interfaces differ",
            _ if self.either => {
                "2: both interfaces in phase; 3 where that orbit is not stable, or does not exist"
            }
            (Symmetry::Asymmetric, _) => "3",
            (Symmetry::Symmetric, 2) => {
                "2: both interfaces in phase; the transverse multiplier is a quadrature"
            }
            (Symmetry::Symmetric, _) => "2",
        };
        let guess = match self.query.begin {
            InitialGuess::At {
                period: Some(_), ..
            } => "the start, over the period given",
            InitialGuess::At { .. } => "the returns of the start, else what it settles on",
            InitialGuess::Anywhere if self.system.unequal.is_some() => "what runs settle on",
            InitialGuess::Anywhere => {
                "what runs settle on, else the branch from the nearest Hopf point"
            }
            InitialGuess::Hopf => "the branch from the nearest Hopf point, past its folds",
        };
        let second = match &self.second {
            Some(second) => format!(
                "{}, from nodes cut to three digits; rtol {:e}",
                second.method.name(),
                second.tolerances.rtol
            ),
            None => "off: `crosscheck` none".to_owned(),
        };
        let dense = dense_output(self.rows, self.picture);
        format!(
            "plan of this command
  dimension         {dimension}
  guess             {guess}
  method            {}, tangents on, multiple shooting; rtol {:e}
  uncertainties     the noise of all arcs, and two more solutions at other nodes and 8 times looser
  crosscheck        {second}
  dense output      {dense}",
            method_name(self.accuracy.method),
            self.accuracy.tolerances.rtol
        )
    }

    /// Finds the orbit.
    ///
    /// # Errors
    /// Those of [`find()`], [`find_either()`] and [`find_unequal()`].
    pub fn find(&self) -> Result<FoundOrbit> {
        match self.unequal() {
            Some(interfaces) => find_unequal(&interfaces, self.query.begin, &self.accuracy),
            None if self.either => find_either(&self.slab, &self.accuracy),
            None => find(&self.slab, &self.query, &self.accuracy),
        }
    }

    fn unequal(&self) -> Option<UnequalInterfaces> {
        self.system.unequal(self.slab.loading)
    }

    /// The run over one period of an orbit, from its point back to it: along the arcs between its shooting nodes, each from its own
    /// node, as an unstable orbit is soon left. `None` where neither rows nor a picture are asked for.
    pub fn along(&self, orbit: &Orbit) -> Option<Plan> {
        if self.rows.is_none() && !self.picture {
            return None;
        }
        let dimension = match (orbit.symmetry, self.slab.interfaces) {
            (Symmetry::Asymmetric, _) => Dimension::Full,
            (Symmetry::Symmetric, 2) => Dimension::Symmetric,
            (Symmetry::Symmetric, _) => Dimension::Single,
        };
        let point = |y: &[f64]| -> Point { (y[0], [y[1], y[y.len() - 1]]) };
        let nodes = orbit.nodes_since_point().into_iter();
        let method = run_method(self.accuracy.method);
        Some(Plan {
            loading: self.slab.loading,
            program: None,
            start: point(&orbit.point),
            nodes: nodes.map(|(time, node)| (time, point(node))).collect(),
            dimension,
            until: orbit.period.value,
            sampling: self.rows.unwrap_or(Sampling::FinalOnly),
            columns: run_columns(self.system.interfaces),
            events: None,
            picture: self.picture,
            estimate: None,
            asked_method: method.name().into(),
            method,
            tolerances: self.accuracy.tolerances,
            max_steps: self.accuracy.max_steps,
            system: self.system.clone(),
        })
    }

    /// The orbit once more, by the second method; `None` where there is none.
    ///
    /// # Errors
    /// Those of [`crosscheck`].
    pub fn crosscheck(&self, orbit: &Orbit) -> Result<Option<Crosscheck>> {
        let again = |second| match self.unequal() {
            Some(interfaces) => crosscheck_of(&AnyField::of::<3>(&interfaces), orbit, &second),
            None => crosscheck(&self.slab, orbit, &second),
        };
        let second = self.second.filter(|_| self.second_is_asked);
        let usual = || Some(worth(self.second?, orbit));
        second.or_else(usual).map(again).transpose()
    }
}

/// What is asked for; of interfaces that differ no orbit is symmetric.
fn symmetry(name: Option<&str>, system: &System) -> Result<Symmetry> {
    let unknown = |name| Error::unknown("symmetry", name, &["symmetric", "asymmetric"]);
    let asked = name.map(|name| Symmetry::named(name).ok_or_else(|| unknown(name)));
    match (system.unequal, asked.transpose()?) {
        (None, asked) => Ok(asked.unwrap_or(Symmetry::Symmetric)),
        (Some(_), Some(asked)) => Err(Error::Input(format!(
            "`symmetry` {}: unequal interfaces have no symmetric orbits; leave it out",
            asked.name()
        ))),
        (Some(_), None) => Ok(Symmetry::Asymmetric),
    }
}

/// Where the search begins.
fn begin(options: &OrbitOptions, system: &System, slab: &InterfaceSystem) -> Result<InitialGuess> {
    let inward = |t| {
        Ok(system
            .units
            .inward(Quantity::Time, positive("period-guess", t)?))
    };
    let period = options.period_guess.map(inward).transpose()?;
    Ok(match options.start.as_deref() {
        None if period.is_some() => {
            return Err(Error::Input(
                "`period_guess` needs a `start` near the orbit".into(),
            ));
        }
        None => InitialGuess::Anywhere,
        Some("hopf") if period.is_some() => {
            return Err(Error::Input(
                "`period_guess` goes with a `start` near the orbit, not with `start` hopf".into(),
            ));
        }
        Some("hopf") => InitialGuess::Hopf,
        Some(text) => InitialGuess::At {
            start: start(text, system, &slab.loading)?,
            period,
        },
    })
}

/// The method with its tolerances, or those that are given.
fn accuracy(options: &OrbitOptions, units: &Units) -> Result<OrbitAccuracy> {
    let usual = OrbitAccuracy::of(Choice::named(&options.method)?);
    if options.max_steps == 0 {
        return Err(Error::parameter("max-steps", 0, "at least 1"));
    }
    let given = match (options.rtol, options.atol) {
        (None, None) => usual.tolerances,
        (rtol, atol) => tolerances(rtol.unwrap_or(usual.tolerances.rtol), atol)?,
    };
    Ok(OrbitAccuracy {
        max_steps: options.max_steps,
        tolerances: stepping(given, options.max_step, units)?,
        ..usual
    })
}

/// The method of the flow along orbits.
pub(super) fn run_method(choice: Choice) -> Choice {
    match choice {
        Choice::Auto => Choice::Taylor,
        other => other,
    }
}

fn method_name(choice: Choice) -> &'static str {
    run_method(choice).name()
}

/// What the plan says of dense output.
pub(super) fn dense_output(rows: Option<Sampling>, picture: bool) -> &'static str {
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
pub(super) fn worth(second: OrbitAccuracy, orbit: &Orbit) -> OrbitAccuracy {
    /// As a rule the second method takes a tenth of these.
    const LEAST: usize = 1_000_000;
    OrbitAccuracy {
        all_steps: orbit.work.steps.max(LEAST),
        ..second
    }
}

/// The method of the crosscheck: another one than the first.
pub(super) fn second(name: Option<&str>, by: &OrbitAccuracy) -> Result<Option<OrbitAccuracy>> {
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
