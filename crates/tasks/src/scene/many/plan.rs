//! A run of many interfaces from options: what they are, where they start, and what rows hold.

use super::catalogue::CataloguePlan;
use super::draw::Drawn;
use super::saved::Saving;
use super::setup::{Asked, Setup, needed};
use crate::scene::column::Column;
use crate::scene::options::{IntegrateOptions, NumericsOptions};
use crate::scene::plan::{Sampling, USUAL_START, sampling, until};
use crate::scene::system::Described;
use crate::scene::units::{Quantity, Units};
use serde_json::{Map, Value};
use std::cell::Cell;
use twinslip::error::{Error, Result};
use twinslip::integrate::Choice;
#[cfg(feature = "sundials")]
use twinslip::many::ManyCvode;
use twinslip::many::{
    Extent, ManyInterfaces, ManyMethod, ManyRosenbrock, ManyTaylor, Processes, Slips,
};
use twinslip::model::Loading;
#[cfg(feature = "sundials")]
use twinslip::sundials::MultistepMethod;

/// A run of many interfaces, checked.
#[derive(Debug, Clone)]
pub struct ManyPlan {
    /// What slides.
    pub interfaces: ManyInterfaces,
    /// tau, and psi of each.
    pub start: (f64, Vec<f64>),
    /// End of the run.
    pub until: f64,
    /// When there are rows.
    pub sampling: Sampling,
    /// What a row holds.
    pub columns: Vec<Column<ManyInstant>>,
    /// The interfaces that columns are of, from 0.
    pub watched: Vec<usize>,
    /// Whether the run is drawn.
    pub picture: bool,
    /// What is asked for of slip events.
    pub catalogue: Option<CataloguePlan>,
    /// The constants that are drawn, where they are shown.
    pub drawn: Vec<Drawn>,
    /// The method.
    pub method: ManyMethod,
    /// The slips that columns are of.
    pub slips: Slips,
    /// The method's name as it was asked for.
    pub asked_method: String,
    /// The tolerance.
    pub rtol: f64,
    /// The bound on steps.
    pub max_steps: usize,
    /// Whether it can be gone on with.
    pub saving: Saving,
    units: Units,
    echo: Map<String, Value>,
    /// Whether its run has begun.
    begun: Cell<bool>,
}

/// A point of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct ManyInstant {
    /// Time.
    pub time: f64,
    /// tau
    pub stress: f64,
    /// The slip of all interfaces together since the start.
    pub slip: f64,
    /// What they do together.
    pub extent: Extent,
    /// psi, v and the slip of those that are watched.
    pub each: Vec<[f64; 3]>,
}

/// Interfaces from which on the other engines have no room for all.
const MANY: u32 = 8;

impl ManyPlan {
    /// Whether the options are of a run of this kind.
    pub fn is_of(options: &IntegrateOptions) -> bool {
        let slab = &options.model.slab;
        let named = slab.text.system.is_some() || slab.clusters.is_some();
        // The events of one or two have a meaning of their own, and laws from files have none.
        let listed = options.events.is_some() && slab.law_file().is_none();
        let least = if listed { 3 } else { MANY };
        !options.draws.draw.is_empty() || slab.count() >= least && !named
    }

    /// Checks the options, of which this one of the processes computes a share.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &IntegrateOptions, processes: Processes) -> Result<Self> {
        refused(options)?;
        let model = options.model.resolved()?;
        let driving = needed("driving", model.driving)?;
        let loading = Loading::new(driving, needed("stiffness", model.stiffness)?)?;
        let Setup {
            interfaces,
            start,
            mut drawn,
            echo,
        } = Setup::new(&Asked {
            model: &model,
            loading,
            draws: &options.draws,
            start: options.start.as_deref().or(usual_start(options)),
            processes,
        })?;
        let count = interfaces.count();
        let catalogue = CataloguePlan::new(options, driving / count as f64)?;
        if !catalogue.is_some_and(|catalogue| catalogue.participation) {
            drawn.clear();
        }
        let units = Units::none();
        let until = until(options)?;
        let (columns, watched) = columns(options.columns.as_deref(), count)?;
        let method = method(&options.numerics)?;
        if catalogue.is_some() {
            if !matches!(method, ManyMethod::Taylor(_)) {
                let name = method.name();
                return Err(Error::Input(format!(
                    "`method` {name}: slip events are found on power series; take taylor, or leave out `events`"
                )));
            }
            if interfaces.share().ranks() > 1 {
                return Err(Error::Input(
                    "`events`: slip events are found by one process alone; leave them out, or start one without mpirun".into(),
                ));
            }
        }
        let picture = options.plot.is_some();
        let slips = Slips {
            of_all: picture || columns.iter().any(|column| column.name == "slip"),
            of: { watched.iter().copied() }
                .filter(|i| {
                    columns
                        .iter()
                        .any(|column| column.name == format!("slip_{}", i + 1))
                })
                .collect(),
        };
        Ok(ManyPlan {
            echo,
            interfaces,
            start,
            until,
            sampling: sampling(options, &units, until)?,
            columns,
            watched,
            picture,
            catalogue,
            drawn,
            method,
            slips,
            asked_method: options.numerics.method.clone(),
            rtol: options.numerics.rtol,
            max_steps: options.numerics.max_steps,
            saving: Saving::default(),
            units,
            begun: Cell::new(false),
        })
    }

    /// Waits for all processes to begin; whether they do.
    pub fn begin(&self) -> bool {
        self.begun.set(true);
        let [all] = self.interfaces.share().largest([0.0]);
        all == 0.0
    }

    /// Lets the other processes go where this one has not come to the run.
    pub fn dismiss(&self) {
        if !self.begun.replace(true) {
            self.interfaces.share().largest([f64::NAN]);
        }
    }

    /// The columns of the points of a picture.
    pub fn pictured(&self) -> Vec<Column<ManyInstant>> {
        many_run_columns()
    }

    /// Whether any column needs what all interfaces do.
    pub fn needs_extent(&self) -> bool {
        let of_all = many_run_columns();
        let extents = &of_all[EXTENTS..];
        self.picture || self.columns.iter().any(|column| extents.contains(column))
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let rows = self.sampling.in_words();
        let count = self.interfaces.count();
        format!(
            "plan of this run
  interfaces        {}, under one stress
  method            {}, order {}, all of them at once
  tolerance         {:e} of every psi and of 1 + |tau|, at most {} steps
  memory            {} MB
  trajectory        {rows}
  slips             {}
  events            {}",
            twinslip::error::count(count),
            self.method.name(),
            match self.method {
                ManyMethod::Taylor(taylor) => taylor.order().to_string(),
                ManyMethod::Rosenbrock(_) => format!(
                    "{}, linear systems with an arrow matrix",
                    self.method.order()
                ),
                #[cfg(feature = "sundials")]
                ManyMethod::Cvode(_) => "1 to 5, linear systems with an arrow matrix".to_owned(),
            },
            self.rtol,
            twinslip::error::count(self.max_steps),
            twinslip::error::count(self.method.memory(&self.interfaces) / 1_000_000),
            match (self.slips.of_all, self.slips.of.len()) {
                (false, 0) => "none".to_owned(),
                (true, 0) => "of all together".to_owned(),
                (false, n) => format!("of {n} interfaces"),
                (true, n) => format!("of all together and of {n} interfaces"),
            },
            match &self.catalogue {
                None => "off: `events` is not given".to_owned(),
                Some(catalogue) => format!(
                    "any interface faster than {} V_H/N = {}, by the roots of the rates' series where their terms do not rule them out{}",
                    catalogue.threshold,
                    catalogue.rate,
                    if catalogue.participation {
                        "; the participation of each is recorded"
                    } else {
                        ""
                    }
                ),
            }
        )
    }
}

impl Described for ManyPlan {
    fn echo(&self) -> &Map<String, Value> {
        &self.echo
    }

    fn units(&self) -> &Units {
        &self.units
    }
}

/// Where so few interfaces start that other engines could take them: as there. Whether events are asked for moves no start.
fn usual_start(options: &IntegrateOptions) -> Option<&'static str> {
    let few = options.draws.draw.is_empty() && options.model.slab.count() < MANY;
    few.then_some(USUAL_START)
}

/// What runs of many interfaces do not have.
fn refused(options: &IntegrateOptions) -> Result<()> {
    let slab = &options.model.slab;
    let asked: [(&str, bool, &str); 6] = [
        (
            "system",
            slab.text.system.is_some(),
            "constants of interfaces are drawn, and this has none; leave out `draw` or this",
        ),
        (
            "clusters",
            slab.clusters.is_some(),
            "each interface that is drawn moves on its own; leave out `draw` or this",
        ),
        (
            "atol",
            options.numerics.atol.is_some(),
            "many interfaces have one tolerance, `rtol`, of every psi and of 1 + |tau|",
        ),
        (
            "max_step",
            options.numerics.max_step.is_some(),
            "the laws of many interfaces have no pulses that a step could miss",
        ),
        (
            "program",
            options.program.is_some(),
            "V_H is constant for many interfaces",
        ),
        (
            "estimate_error",
            options.estimate_error,
            "runs of many interfaces have no estimate; compare with a smaller `rtol`",
        ),
    ];
    match asked.into_iter().find(|(_, asked, _)| *asked) {
        Some((name, _, why)) => Err(Error::Input(format!("`{name}`: {why}"))),
        None => Ok(()),
    }
}

/// The method of that name.
fn method(numerics: &NumericsOptions) -> Result<ManyMethod> {
    let (rtol, max_steps) = (numerics.rtol, numerics.max_steps);
    Ok(match Choice::named(&numerics.method)? {
        Choice::Auto | Choice::Taylor => ManyMethod::Taylor(ManyTaylor::new(rtol, max_steps)?),
        Choice::Rosenbrock(method) => {
            ManyMethod::Rosenbrock(ManyRosenbrock::new(method, rtol, max_steps)?)
        }
        #[cfg(feature = "sundials")]
        Choice::Cvode(MultistepMethod::Bdf) => ManyMethod::Cvode(ManyCvode::new(rtol, max_steps)?),
        _ => {
            return Err(Error::Input(format!(
                "`method` {}: many interfaces are integrated by taylor, a Rosenbrock method or cvode-bdf",
                numerics.method
            )));
        }
    })
}

/// Columns before those of what all interfaces do.
const EXTENTS: usize = 3;

/// The columns of what all interfaces do together.
pub fn many_run_columns() -> Vec<Column<ManyInstant>> {
    use Quantity::{Length, Number, SlipRate, State, Stress, Time};
    type Row = ManyInstant;
    vec![
        Column::new("time", Time, |at: &Row| at.time.into()).meaning("time"),
        Column::new("stress", Stress, |at: &Row| at.stress.into()).meaning("shear stress τ"),
        Column::new("slip", Length, |at: &Row| at.slip.into())
            .meaning("slip of all interfaces together"),
        Column::new("slip_rate", SlipRate, |at: &Row| at.extent.slip_rate.into())
            .meaning("slip rate of all interfaces together"),
        Column::new("slip_rate_max", SlipRate, |at: &Row| {
            at.extent.slip_rate_max.into()
        })
        .meaning("largest slip rate"),
        Column::new("sliding", Number, |at: &Row| at.extent.sliding.into())
            .meaning("number of interfaces that slide faster than V_H/N"),
        Column::new("state_min", State, |at: &Row| at.extent.state[0].into()).meaning("least ψ"),
        Column::new("state_max", State, |at: &Row| at.extent.state[1].into()).meaning("largest ψ"),
    ]
}

/// The columns that are asked for, and the interfaces that they are of.
fn columns(names: Option<&str>, count: usize) -> Result<(Vec<Column<ManyInstant>>, Vec<usize>)> {
    let of_all = many_run_columns();
    let Some(names) = names else {
        return Ok((of_all, Vec::new()));
    };
    let (mut columns, mut watched) = (Vec::new(), Vec::new());
    for name in names.split(',').map(str::trim) {
        let numbered = name.rsplit_once('_').and_then(|(base, number)| {
            let i: usize = number.parse().ok()?;
            (1..=count).contains(&i).then_some((base, i - 1))
        });
        if let Some((base, interface)) = numbered
            && let Some((quantity, entry)) = of_one(base)
        {
            let known = watched.iter().position(|one| *one == interface);
            let at = known.unwrap_or(watched.len());
            if known.is_none() {
                watched.push(interface);
            }
            let entry = move |row: &ManyInstant| entry(row.each[at]).into();
            columns.push(Column::new(name.to_owned(), quantity, entry));
            continue;
        }
        let found = of_all.iter().find(|column| column.name == name);
        columns.push(found.cloned().ok_or_else(|| {
            let known: Vec<&str> = of_all.iter().map(|column| &*column.name).collect();
            let known =
                known
                    .into_iter()
                    .chain(["state_1", "log_state_1", "slip_rate_1", "slip_1"]);
            Error::unknown("columns", name, &known.collect::<Vec<_>>())
        })?);
    }
    Ok((columns, watched))
}

/// From psi, v and slip of an interface to what a column shows.
type OfOne = fn([f64; 3]) -> f64;

/// What one interface has.
fn of_one(base: &str) -> Option<(Quantity, OfOne)> {
    Some(match base {
        "state" => (Quantity::State, |[psi, ..]| psi),
        "log_state" => (Quantity::LogState, |[psi, ..]| psi.ln()),
        "slip_rate" => (Quantity::SlipRate, |[_, v, _]| v),
        "slip" => (Quantity::Length, |[.., slip]| slip),
        _ => return None,
    })
}
