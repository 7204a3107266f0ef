//! From options to a plan: what is integrated, in which dimension, and which extras the outputs need. What no output needs
//! is not in the plan, and so is not done.

use super::any_system::AnySystem;
use super::column::Column;
use super::equations::Subspace;
use super::estimate::Companion;
use super::instant::{Instant, driving_column, pictured_columns, run_columns};
use super::options::IntegrateOptions;
use super::program::{Program, Stretch};
use super::system::{Described, System};
use super::units::{Quantity, Units};
use serde_json::Value;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::friction::{Formulas, Law, beside, positive};
use twinslip::integrate::{Choice, MotionUnits, Tolerances};
use twinslip::model::Loading;

/// How a run starts where nobody says otherwise.
pub(super) const USUAL_START: &str = "near-symmetric";
/// The steady state itself.
pub(super) const STEADY_START: &str = "near-symmetric:0";
/// The asymmetry of `--start near-symmetric` where none is given.
pub(super) const NEAR_SYMMETRIC: f64 = 0.01;
/// Total slip rate over V_H from which on an excursion counts as a stick-slip event.
pub(super) const EVENT_THRESHOLD: f64 = 2.0;
/// Upper limit on the number of rows, to catch typing errors.
const MAX_ROWS: f64 = 1e9;
/// tau, and ln psi of both interfaces: twice the same where there is one, or where both move alike.
pub type Point = (f64, [f64; 2]);

/// At which times there are rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sampling {
    /// At the ends of the integrator's own steps.
    EveryStep,
    /// At so many times, equally spaced, both ends included.
    Points(usize),
    /// At all multiples of a time, in the user's units.
    Every(f64),
    /// At the end alone.
    FinalOnly,
}

impl Sampling {
    /// When the i-th row is, of those at fixed times of a run until then. The end of a stretch of it, or its own, is met where rounding
    /// alone is in between. Times are counted in the user's units, in which they are round numbers.
    pub(super) fn time(self, i: usize, (until, end): (f64, f64), units: &Units) -> Option<f64> {
        let (t, interval) = match self {
            Sampling::EveryStep | Sampling::FinalOnly => return None,
            Sampling::Points(n) if i >= n => return None,
            Sampling::Points(n) if i + 1 == n => return Some(until),
            Sampling::Points(n) => {
                let (whole, intervals) = (units.outward(Quantity::Time, until), (n - 1) as f64);
                (whole * i as f64 / intervals, whole / intervals)
            }
            Sampling::Every(dt) => (multiple(i, dt), dt),
        };
        let [t, interval] = [t, interval].map(|t| units.inward(Quantity::Time, t));
        let meets = (t - end).abs() <= 1e-9 * interval;
        Some(if meets { end } else { t })
    }

    /// As plans tell it.
    pub(super) fn in_words(self) -> String {
        match self {
            Sampling::FinalOnly => "off: only the end is asked for".to_owned(),
            Sampling::EveryStep => "a row at every step".to_owned(),
            Sampling::Points(n) => format!("{n} rows equally spaced in time"),
            Sampling::Every(dt) => format!("a row every {dt}"),
        }
    }
}

/// i dt, rounded once: of a decimal fraction dt the decimal fraction, 0.3 and not 0.30000000000000004.
fn multiple(i: usize, dt: f64) -> f64 {
    /// Powers of ten up to here are exact.
    const MOST_DIGITS: i32 = 22;
    /// Integers up to here are exact.
    const LARGEST: f64 = (1_u64 << 53) as f64;
    let i = i as f64;
    let as_decimal = |digits| {
        let unit = 10_f64.powi(digits);
        let count = (dt * unit).round();
        (count / unit == dt && i * count <= LARGEST).then(|| i * count / unit)
    };
    (0..=MOST_DIGITS).find_map(as_decimal).unwrap_or(i * dt)
}

/// When a run begins.
const BEGIN: f64 = 0.0;

/// A run, checked, and only what its outputs need.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The system; with a program, at V_H before its first change, which may be 0.
    pub system: AnySystem,
    /// How V_H changes on the way, where it does.
    pub program: Option<Program>,
    /// The states among which it stays.
    pub subspace: Subspace,
    /// The values of these states at the start.
    pub start: Vector,
    /// Where the run begins anew from known points of the same solution, as an orbit from its shooting nodes: their times, ascending,
    /// and the points. Empty for a run from its start alone.
    pub nodes: Vec<(f64, Vector)>,
    /// End of the run.
    pub until: f64,
    /// When there are rows.
    pub sampling: Sampling,
    /// What a row holds.
    pub columns: Vec<Column<Instant>>,
    /// The threshold of stick-slip events over V_H, where they are asked for.
    pub events: Option<f64>,
    /// Whether the run is drawn, which takes points between the steps and whatever rows are asked for.
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

impl Plan {
    /// Checks the options of a run and keeps what its outputs need.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &IntegrateOptions) -> Result<Self> {
        let program = options.program.as_deref();
        let program = program
            .map(|text| Program::read(text, until(options)?))
            .transpose()?;
        let system = AnySystem::in_time(&options.model, program.as_ref())?;
        let events = events(options, &system)?;
        let start = system.start(options.start.as_deref(), program.is_some())?;
        let until = system.units().inward(Quantity::Time, until(options)?);
        let sampling = sampling(options, system.units(), until)?;
        let mut columns = run_columns(&system);
        columns.extend(program.as_ref().map(|_| driving_column()));
        if let Some(names) = &options.columns {
            columns = Column::listed(&columns, names)?;
        }
        let (method, tolerances) = system.numerics(&options.numerics)?;
        let atol_is_given = options.numerics.atol.is_some();
        let units = system.units_of_lasting_run((&start, BEGIN), until, atol_is_given)?;
        let (subspace, start) = system.reduced(start);
        let plan = Plan {
            program,
            subspace,
            start,
            nodes: Vec::new(),
            until,
            sampling,
            columns,
            events,
            picture: options.plot.is_some(),
            estimate: (options.estimate_error || options.reference)
                .then(|| Companion::of(tolerances, options.reference)),
            asked_method: options.numerics.method.clone(),
            method,
            tolerances,
            atol_is_given,
            units,
            max_steps: options.numerics.max_steps,
            system,
        };
        plan.stretches().map(|_| plan)
    }

    /// The stretches of the run, one after the other.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a program whose velocities are beyond doubles without their unit.
    pub fn stretches(&self) -> Result<Vec<Stretch>> {
        let driving = self.system.driving();
        if let Some(program) = &self.program {
            return program.stretches(driving, self.until, self.system.units());
        }
        let times = || self.nodes.iter().map(|&(time, _)| time);
        let begins = [BEGIN].into_iter().chain(times());
        let spans = begins.zip(times().chain([self.until]));
        let stretch = |span| Stretch {
            span,
            driving: (driving, driving),
        };
        Ok(spans.map(stretch).collect())
    }

    /// The absolute tolerance as it is told: as the run begins.
    pub fn told_atol(&self) -> Value {
        let atol = self.tolerances.atol;
        self.system
            .absolute_tolerance(&self.units, atol, self.atol_is_given)
    }

    /// The columns of the points of a picture.
    pub fn pictured(&self) -> Vec<Column<Instant>> {
        let mut columns = pictured_columns(&self.system);
        columns.extend(self.program.as_ref().map(|_| driving_column()));
        columns
    }

    /// Whether a column or the events need the slip, and with it a quadrature along every step.
    pub fn needs_slip(&self) -> bool {
        self.events.is_some()
            || self
                .columns
                .iter()
                .any(|column| column.quantity == Quantity::Length)
    }

    /// Whether anything must be seen between start and end.
    pub fn observed(&self) -> bool {
        self.sampling != Sampling::FinalOnly || self.needs_slip() || self.picture || self.holds()
    }
}

/// The threshold of stick-slip events over V_H, where they are asked for.
fn events(options: &IntegrateOptions, system: &AnySystem) -> Result<Option<f64>> {
    let of_many = [
        ("participation", options.participation.is_some()),
        ("plot-events", options.plot_events.is_some()),
    ];
    if let Some((name, _)) = of_many.into_iter().find(|(_, asked)| *asked) {
        return Err(Error::Input(format!(
            "`{name}` is for the events of three or more interfaces with a built-in law; for one or two `events` has everything"
        )));
    }
    if options.events.is_none() {
        return Ok(None);
    }
    if !matches!(system.clusters(), [1] | [1, 1]) {
        return Err(Error::Input(
            "`events` are stick-slip events of one or two interfaces, or of three and more with a built-in law and without `clusters`"
                .into(),
        ));
    }
    let threshold = options.event_threshold.unwrap_or(EVENT_THRESHOLD);
    // Below 1 the excursions would not be slip faster than V_H, which is what an event is.
    if threshold < 1.0 {
        return Err(Error::parameter("event-threshold", threshold, "at least 1"));
    }
    Ok(Some(threshold))
}

/// The end of a run, in the user's units.
pub(super) fn until(options: &IntegrateOptions) -> Result<f64> {
    let until = options
        .until
        .ok_or_else(|| Error::Input("`until` T is missing: the end time of the run".into()))?;
    positive("until", until)
}

/// The tolerances of a run in (tau, ln psi), both those of rtol where atol is not given.
///
/// # Errors
/// [`Error::Parameter`] as of [`Tolerances::new`], and for an atol that is no tolerance of numbers of the order of ten.
pub fn tolerances(rtol: f64, atol: Option<f64>) -> Result<Tolerances> {
    let equal = Tolerances::equal(rtol)?;
    let atol = atol.unwrap_or(rtol);
    if !(atol > 0.0 && atol < 1.0) {
        return Err(Error::parameter(
            "atol",
            atol,
            "greater than 0 and less than 1: an error by 1 of ln psi is a factor of e",
        ));
    }
    Ok(Tolerances { atol, ..equal })
}

/// These tolerances with the largest step that is given in the user's time.
pub(super) fn stepping(
    tolerances: Tolerances,
    max_step: Option<f64>,
    units: &Units,
) -> Result<Tolerances> {
    let Some(max_step) = max_step else {
        return Ok(tolerances);
    };
    let max_step = units.inward(Quantity::Time, positive("max-step", max_step)?);
    Ok(tolerances.stepping(max_step))
}

/// The largest step in words, after those on tolerances.
pub(super) fn longest_in_words(tolerances: Tolerances, units: &Units) -> String {
    let longest = units.max_step(tolerances);
    longest.map_or_else(String::new, |h| format!(", none longer than {h}"))
}

/// The variables that are integrated, in words.
pub(super) fn dimension_in_words(system: &AnySystem, subspace: Subspace, start: &Vector) -> String {
    let count = start.len();
    if !system.slides() {
        let forced = if system.is_timed() {
            ", driven by t"
        } else {
            ""
        };
        return format!("{count}: {}{forced}", system.states().join(", "));
    }
    match (subspace, count) {
        (Subspace::Symmetric, _) => {
            "2: psi1 = psi2 at the start, so the run stays in the symmetric subspace (tau, ln psi)"
                .into()
        }
        (_, 2) if system.clusters() == [1] => "2: one interface, (tau, ln psi)".into(),
        (_, 3) if system.differ() => "3: the interfaces differ, (tau, ln psi1, ln psi2)".into(),
        (_, 3) if start[1] != start[2] => "3: psi1 and psi2 differ, (tau, ln psi1, ln psi2)".into(),
        _ => format!("{count}: {}", system.states().join(", ")),
    }
}

/// The absolute tolerance in words, where it follows the states and where it is one number for all.
pub(super) fn tolerance_in_words(system: &AnySystem, atol: f64, told: &Value) -> String {
    let of = match (system.slides(), told.is_array()) {
        (true, _) if system.layout().is_some_and(|all| all.has_more()) => "on every variable",
        (true, _) => "on (tau, ln psi)",
        (false, true) => "of the range of each state so far",
        (false, false) => "on every state",
    };
    format!("atol {atol:e} {of}")
}

/// So many rows, both ends included.
///
/// # Errors
/// [`Error::Parameter`] for less than two or far too many.
pub(super) fn equally_spaced(points: usize) -> Result<Sampling> {
    if (2..=MAX_ROWS as usize).contains(&points) {
        Ok(Sampling::Points(points))
    } else {
        Err(Error::parameter("points", points, "from 2 to 1e9"))
    }
}

pub(super) fn sampling(options: &IntegrateOptions, units: &Units, until: f64) -> Result<Sampling> {
    if options.final_only {
        return Ok(Sampling::FinalOnly);
    }
    if let Some(points) = options.points {
        return equally_spaced(points);
    }
    let Some(every) = options.every else {
        return Ok(Sampling::EveryStep);
    };
    let interval = units.inward(Quantity::Time, positive("every", every)?);
    if until / interval > MAX_ROWS {
        return Err(Error::parameter(
            "every",
            every,
            "at least a billionth of `until`",
        ));
    }
    Ok(Sampling::Every(every))
}

/// tau and ln psi of both interfaces, as `--start` gives them; equal entries stand for one interface too.
///
/// # Errors
/// [`Error::Input`] and [`Error::Parameter`] for what can't be read or is outside its domain.
pub fn start(text: &str, system: &System, loading: &Loading) -> Result<(f64, [f64; 2])> {
    if let Some(rest) = text.strip_prefix("near-symmetric") {
        let asymmetry = match rest.strip_prefix(':') {
            Some(number) => Some(start_number(number, text)?),
            None if rest.is_empty() => None,
            None => return Err(unreadable(text, system)),
        };
        return near_symmetric(asymmetry, system, loading);
    }
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| start_number(part, text))
        .collect::<Result<_>>()?;
    if numbers.len() != system.interfaces + 1 {
        return Err(unreadable(text, system));
    }
    let mut log_state = [0.0; 2];
    for (w, &psi) in log_state.iter_mut().zip(&numbers[1..]) {
        *w = system
            .units
            .inward(Quantity::State, positive("psi in `start`", psi)?)
            .ln();
    }
    if system.interfaces == 1 {
        log_state[1] = log_state[0];
    }
    bounded(log_state, system)?;
    Ok((system.units.inward(Quantity::Stress, numbers[0]), log_state))
}

/// The symmetric steady state, with the second interface (the only one, if there is one) moved off it by exp(EPS). Where no EPS
/// is given, to the side on which the law has states, as the starts of a sweep are. Of interfaces that differ the states in which each
/// slides steadily at V_H/2, and the mean of their stresses.
fn near_symmetric(
    asymmetry: Option<f64>,
    system: &System,
    loading: &Loading,
) -> Result<(f64, [f64; 2])> {
    if loading.driving == 0.0 {
        return Err(Error::Input(format!(
            "`start` near-symmetric is at the steady state, of which there is none at V_H = 0: give `start` {}",
            shape(system)
        )));
    }
    let v = loading.driving / system.interfaces as f64;
    let [first, w] = system.laws().map(|law| law.steady_state(v).ln());
    let moved = match asymmetry {
        None => beside(&system.law, w, NEAR_SYMMETRIC),
        Some(by) if system.law.bounds_state() && w + by > 0.0 => {
            return Err(Error::Input(format!(
                "`start` near-symmetric:{by}: EPS moves psi from {:.6} at the steady state to {:.6}, but this law keeps psi in (0, 1]; EPS must be at most {:.6e} here",
                w.exp(),
                (w + by).exp(),
                -w
            )));
        }
        Some(by) => w + by,
    };
    let log_state = if system.interfaces == 1 {
        [moved, moved]
    } else {
        [first, moved]
    };
    Ok((system.steady_stress(loading.driving), log_state))
}

pub(super) fn bounded(log_state: [f64; 2], system: &System) -> Result<()> {
    match log_state.into_iter().find(|&w| w > 0.0) {
        Some(w) if system.law.bounds_state() => Err(Error::parameter(
            "psi in `start`",
            w.exp(),
            "in (0, 1], where this law keeps the state",
        )),
        _ => Ok(()),
    }
}

fn start_number(part: &str, whole: &str) -> Result<f64> {
    match part.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(Error::Input(format!(
            "`start` {whole:?}: {part:?} is not a finite number"
        ))),
    }
}

fn unreadable(text: &str, system: &System) -> Error {
    let shape = shape(system);
    Error::Input(format!(
        "`start` {text:?} must be {shape} or near-symmetric[:EPS]"
    ))
}

fn shape(system: &System) -> &'static str {
    ["TAU,PSI", "TAU,PSI1,PSI2"][system.interfaces - 1]
}
