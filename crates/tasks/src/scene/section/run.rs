//! From the plan of a return map to its rows and its verdict.

use super::super::equations::Subspace;
use super::super::run::Sink;
use super::super::system::Described;
use super::super::units::Quantity;
use super::SectionPlan;
use super::exponents::{CheckedExponents, ProgressObserver, embedded, of_orbit, of_record};
use super::row::RowMaker;
use twinslip::error::{Error, MessageUnits, Result};
use twinslip::field::Vector;
use twinslip::integrate::{AnyField, AnyIntegrator, Control, MotionUnits, Work};
use twinslip::number::Uncertain;
use twinslip::section::{
    Ended, Exponents, FEWEST_FOR_EXPONENTS, FEWEST_RETURNS, Periodic, Regime, RegimeVerdict,
    Return, ReturnRecord, SeriesVariables, Surface, Watching, aperiodic, record, record_finely,
    verdict,
};

/// Where exponents are asked for, the run takes this part of the time, and has come to this part when their own run is done.
const RUN: f64 = 0.2;
const OWN_RUN: f64 = 0.4;

/// What a return map came to, dimensionless.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionOutcome {
    /// What the run has settled on.
    pub regime: Regime,
    /// q, where the map is q-periodic.
    pub period_of_orbit: Option<usize>,
    /// The time of these q returns.
    pub period: Option<Uncertain>,
    /// Turns per return around the section of a torus, from 0 to 1/2; where the torus has several curves, around one of them
    /// per visit to it.
    pub rotation_number: Option<Uncertain>,
    /// How many closed curves the torus has in the section.
    pub curves: Option<usize>,
    /// The Lyapunov exponents, where asked for and known.
    pub lyapunov: Option<CheckedExponents>,
    /// What it rests on, or why it is undecided and what to try.
    pub note: Option<String>,
    /// Returns recorded.
    pub returns: usize,
    /// What the run cost, without tangents.
    pub work: Work,
    /// Why it ended early.
    pub failure: Option<Error>,
    /// Whether the sink stopped it.
    pub stopped: bool,
}

impl SectionOutcome {
    /// The same in a system's own units of time and of the state of the section.
    fn outward(self, units: &MotionUnits, state: usize) -> Self {
        SectionOutcome {
            period: self.period.map(|period| units.outward_time(period)),
            lyapunov: self.lyapunov.map(|found| found.outward(units)),
            failure: self.failure.map(|error| units.outward_error(error, state)),
            ..self
        }
    }
}

/// The exponents by means along a record.
type Means<'a> =
    &'a dyn Fn(&ReturnRecord, ProgressObserver<'_>) -> Result<Option<CheckedExponents>>;

/// Runs the plan of a return map. A row is complete, and given to the sink, when the next return is known.
///
/// # Errors
/// [`Error::Parameter`] if the integrator refuses its settings; a failure on the way is in [`SectionOutcome::failure`].
pub fn run_section(plan: &SectionPlan, sink: &mut dyn Sink) -> Result<SectionOutcome> {
    let mut rows = RowMaker::new(plan);
    let mut outcome = run_in(plan, &plan.units, &mut rows, sink)?;
    if matches!(outcome.failure, Some(Error::Underflow { .. }))
        && let Some(units) = plan.system.units_below_doubles(&plan.units, &plan.start)
        && units.signs[plan.state] * plan.value >= 0.0
    {
        rows.restart();
        outcome = run_in(plan, &units, &mut rows, sink)?;
    }
    if !outcome.stopped {
        rows.end(sink);
    }
    outcome.failure = outcome.failure.map(|error| told(plan, error));
    Ok(outcome)
}

/// The error in the user's units.
fn told(plan: &SectionPlan, mut error: Error) -> Error {
    let units = plan.system.units();
    let quantity = plan.system.quantity(plan.state);
    if quantity != Quantity::LogState {
        return units.told(error);
    }
    // In the variables of the series psi stands for its logarithm.
    let is_psi = plan.system.series_variables() == SeriesVariables::LogStates;
    if let Error::NoReturn {
        section,
        lowest,
        highest,
        ..
    } = &mut error
    {
        for x in [section, lowest, highest] {
            *x = units.outward(quantity, if is_psi { x.ln() } else { *x });
        }
    }
    if !units.si() || !matches!(error, Error::NoReturn { .. }) {
        return units.told(error);
    }
    let none = (1.0, "");
    error.in_units(&MessageUnits {
        time: (units.factor(Quantity::Time), units.name(Quantity::Time)),
        stress: none,
        slip_rate: none,
        stiffness: none,
    })
}

/// The run in these units.
fn run_in(
    plan: &SectionPlan,
    units: &MotionUnits,
    rows: &mut RowMaker<'_>,
    sink: &mut dyn Sink,
) -> Result<SectionOutcome> {
    let equations = plan.system.equations(plan.subspace);
    let field = &equations.field(units)?;
    let tolerances = units.inward_tolerances(plan.tolerances, plan.atol_is_given);
    let means: Means<'_> = &|record, see| match plan.subspace {
        // The third exponent is that of the perturbations across the subspace.
        Subspace::Symmetric => {
            let whole = plan.system.equations(Subspace::Whole);
            let units = MotionUnits::given(whole.variables());
            of_record(&whole.field(&units)?, &embedded(record), see)
        }
        Subspace::Whole => of_record(field, record, see),
    };
    let settling = Settling {
        field,
        start: units.inward(&plan.start),
        surface: plan.surface(units),
        watching: Watching {
            skip: plan.skip,
            // One more, for the last row's next.
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
        by_orbit: &|periodic| of_orbit(plan, field, periodic, tolerances.max_step),
    };
    let see = &mut |at: &Return, sink: &mut dyn Sink| {
        let state = units.outward(&at.state);
        rows.next(at.time * units.time, state.as_slice(), sink)
    };
    let outcome = settling.run(see, sink)?;
    Ok(outcome.outward(units, plan.state))
}

/// Whether all returns that were asked for are there, and only the one more that rows and verdicts would have used did not come.
fn has_all(record: &ReturnRecord, returns: usize) -> bool {
    matches!(record.ended, Ended::Failed(Error::NoReturn { .. }))
        && record.returns.len() + 1 >= returns
}

/// What a run settles on, of any field.
struct Settling<'a> {
    field: &'a AnyField<'a>,
    start: Vector,
    surface: Surface,
    watching: Watching,
    integrator: AnyIntegrator,
    max_steps: usize,
    /// Whether the exponents are asked for.
    lyapunov: bool,
    /// Exponents by means along a record.
    means: Means<'a>,
    /// Exponents by the orbit through a periodic point, with its period.
    by_orbit: &'a dyn Fn(&Periodic) -> Option<(Uncertain, CheckedExponents)>,
}

impl Settling<'_> {
    /// Runs it; every return that is recorded goes to `row`.
    fn run(
        mut self,
        row: &mut dyn FnMut(&Return, &mut dyn Sink) -> Control,
        sink: &mut dyn Sink,
    ) -> Result<SectionOutcome> {
        let (skip, returns) = (self.watching.skip, self.watching.returns);
        let all = (skip + returns) as f64 / if self.lyapunov { RUN } else { 1.0 };
        let mut see = |passed: usize, at: Option<&Return>| match at {
            Some(at) if passed >= skip => row(at, sink),
            Some(_) => Control::Continue,
            None => sink.reached(passed as f64 / all),
        };
        let record = record(
            &mut self.integrator,
            self.field,
            &self.start,
            &self.surface,
            &self.watching,
            &mut see,
        );
        let mut outcome = SectionOutcome {
            regime: Regime::Undecided,
            period_of_orbit: None,
            period: None,
            rotation_number: None,
            curves: None,
            lyapunov: None,
            note: None,
            returns: record.returns.len().min(returns - 1),
            work: self.integrator.work(),
            failure: None,
            stopped: record.ended == Ended::Stopped,
        };
        if let Ended::Failed(error) = &record.ended
            && !has_all(&record, returns)
        {
            outcome.failure = Some(error.clone());
            return Ok(outcome);
        }
        if outcome.stopped {
            return Ok(outcome);
        }
        let mut made = verdict(self.field, &self.surface, &record, None)?;
        if self.lyapunov {
            match self.exponents((&record, &mut made), sink) {
                Ok(Some(found)) => outcome.lyapunov = Some(found),
                Ok(None) => outcome.stopped = record.returns.len() >= FEWEST_FOR_EXPONENTS,
                Err(error) => outcome.failure = Some(error),
            }
        }
        outcome.regime = made.regime;
        outcome.rotation_number = made.curve.map(|curve| curve.rotation);
        outcome.curves = made.curve.map(|curve| curve.curves);
        outcome.note = made.why.map(str::to_owned);
        if let Some(periodic) = made.periodic {
            outcome.period_of_orbit = Some(periodic.returns);
            outcome.period = Some(periodic.period);
        }
        if let Ended::Steady { stable: false, .. } = record.ended {
            outcome.note = Some(
                "the run begins at an unstable equilibrium, which it leaves only by rounding; start elsewhere".into(),
            );
        }
        Ok(outcome)
    }

    /// The exponents of what a run has settled on, and with them the verdict on a run in three dimensions or more that is not
    /// periodic. `None` if it is stopped, and of too few returns.
    ///
    /// Means along the run itself would have the error of its tolerance as a bias: they are taken along one of their own.
    fn exponents(
        &self,
        (record, made): (&ReturnRecord, &mut RegimeVerdict),
        sink: &mut dyn Sink,
    ) -> Result<Option<CheckedExponents>> {
        let (field, surface, watching) = (self.field, &self.surface, &self.watching);
        if let Ended::Steady { .. } = record.ended {
            return (self.means)(record, &mut |_| Control::Continue);
        }
        if let Some(found) = self.by_orbit(made) {
            return Ok(Some(found));
        }
        let Some(first) = record.returns.first() else {
            return Ok(None);
        };
        let all = watching.returns as f64;
        let see = &mut |passed: usize, at: Option<&Return>| match at {
            Some(_) => Control::Continue,
            None => sink.reached(RUN + (OWN_RUN - RUN) * passed as f64 / all),
        };
        let own = record_finely(field, &first.state, surface, watching, self.max_steps, see)?;
        match &own.ended {
            Ended::Stopped => return Ok(None),
            Ended::Failed(error) => return Err(error.clone()),
            Ended::Complete | Ended::Steady { .. } => {}
        }
        // What the error of the first run has hidden may show now.
        let open = made.periodic.is_none();
        if open && own.ended == Ended::Complete {
            *made = verdict(field, surface, &own, None)?;
            if let Some(found) = self.by_orbit(made) {
                return Ok(Some(found));
            }
        }
        let see = &mut |part: f64| sink.reached(OWN_RUN + (1.0 - OWN_RUN) * part);
        let Some(found) = (self.means)(&own, see)? else {
            return Ok(None);
        };
        if made.is_on_saddle() {
            return Ok(Some(found));
        }
        let many = own.ended == Ended::Complete && own.returns.len() >= FEWEST_RETURNS;
        if field.dimension() >= 3 && many && made.periodic.is_none() {
            let known = Exponents {
                values: &found.exponents,
                converged: found.converged,
            };
            // Either run may be the one whose returns tell.
            let by =
                |run: &ReturnRecord| aperiodic(surface, &run.returns, run.accuracy, Some(known));
            *made = by(record);
            if made.regime == Regime::Undecided {
                *made = by(&own);
            }
        }
        Ok(Some(found))
    }

    /// The exponents of the orbit that a verdict names, with its period then.
    fn by_orbit(&self, made: &mut RegimeVerdict) -> Option<CheckedExponents> {
        let periodic = made.periodic.as_mut()?;
        let (period, found) = (self.by_orbit)(periodic)?;
        periodic.period = period;
        Some(found)
    }
}
