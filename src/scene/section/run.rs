//! From the plan of a return map to its rows and its verdict.

use super::super::plan::Dimension;
use super::super::run::Sink;
use super::super::units::Quantity;
use super::SectionPlan;
use crate::error::{Error, Result};
use crate::field::State;
use crate::integrate::{Control, Work};
use crate::model::{self, Driven};
use crate::number::Uncertain;
use crate::section::{
    Ended, Exponents, FEWEST_FOR_EXPONENTS, Record, Regime, Return, Surface, Verdict, Watching,
    at_equilibrium, record, spectrum, verdict,
};

/// One column of a return map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectionColumn {
    /// `n`, the number of the return after those let pass, from 0.
    Number,
    /// `time`
    Time,
    /// `log_state_1`, `log_state_2`
    LogState(usize),
    /// `slip_rate_1`, `slip_rate_2`
    SlipRate(usize),
    /// `slip_rate_sum`
    Sum,
    /// `next_slip_rate_sum`, at the return that follows.
    NextSum,
}

impl SectionColumn {
    /// All of a system of one or two interfaces.
    pub fn all(interfaces: usize) -> Vec<Self> {
        let mut all = vec![SectionColumn::Number, SectionColumn::Time];
        all.extend((0..interfaces).map(SectionColumn::LogState));
        all.extend((0..interfaces).map(SectionColumn::SlipRate));
        all.extend([SectionColumn::Sum, SectionColumn::NextSum]);
        all
    }

    /// The name in CSV and JSON.
    pub fn name(&self) -> String {
        match self {
            SectionColumn::Number => "n".into(),
            SectionColumn::Time => "time".into(),
            SectionColumn::LogState(i) => format!("log_state_{}", i + 1),
            SectionColumn::SlipRate(i) => format!("slip_rate_{}", i + 1),
            SectionColumn::Sum => "slip_rate_sum".into(),
            SectionColumn::NextSum => "next_slip_rate_sum".into(),
        }
    }

    /// What it measures.
    pub fn quantity(&self) -> Quantity {
        match self {
            SectionColumn::Number => Quantity::Number,
            SectionColumn::Time => Quantity::Time,
            SectionColumn::LogState(_) => Quantity::LogState,
            _ => Quantity::SlipRate,
        }
    }
}

/// The Lyapunov exponents of a run, dimensionless, with what checks them.
#[derive(Debug, Clone, PartialEq)]
pub struct Lyapunov {
    /// In descending order.
    pub exponents: Vec<Uncertain>,
    /// Whether both halves of the returns agree on them.
    pub converged: bool,
    /// The growth rate along the flow itself, which is zero but for errors; `None` at rest, where there is none.
    pub along_flow: Option<f64>,
    /// The sum of the exponents less the mean of the trace, of which that sum knows nothing; `None` at rest.
    pub liouville_defect: Option<f64>,
}

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
    pub lyapunov: Option<Lyapunov>,
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

/// Runs the plan of a return map. A row is complete, and given to the sink, when the next return is known.
///
/// # Errors
/// [`Error::Parameter`] if the integrator refuses its settings; a failure on the way is in [`SectionOutcome::failure`].
pub fn run_section(plan: &SectionPlan, sink: &mut dyn Sink) -> Result<SectionOutcome> {
    let (law, loading) = (plan.system.law, plan.loading);
    let (tau, [first, second]) = plan.start;
    let y = State::<2>::new(tau, first);
    match plan.dimension {
        Dimension::Single => {
            let field = model::single_interface(law, loading);
            follow(plan, &*field, y, sink, |record| exponents(&*field, record))
        }
        Dimension::Symmetric => {
            let field = model::symmetric(law, loading);
            // The third exponent is that of the perturbations across the subspace.
            let whole = model::two_interfaces(law, loading);
            follow(plan, &*field, y, sink, |record| {
                exponents(&*whole, &embedded(record))
            })
        }
        Dimension::Full => {
            let field = model::two_interfaces(law, loading);
            let y = State::<3>::new(tau, first, second);
            follow(plan, &*field, y, sink, |record| exponents(&*field, record))
        }
    }
}

fn exponents<const N: usize>(
    field: &dyn Driven<N>,
    record: &Record<N>,
) -> Result<Option<Lyapunov>> {
    if let Ended::Steady { equilibrium, .. } = &record.ended {
        return Ok(Some(Lyapunov {
            exponents: at_equilibrium(field, equilibrium).into(),
            converged: true,
            along_flow: None,
            liouville_defect: None,
        }));
    }
    if record.returns.len() < FEWEST_FOR_EXPONENTS {
        return Ok(None);
    }
    let found = spectrum(field, record)?;
    Ok(Some(Lyapunov {
        exponents: found.exponents.into(),
        converged: found.converged,
        along_flow: Some(found.along_flow),
        liouville_defect: Some(found.liouville_defect),
    }))
}

/// A record of the symmetric subspace in all three dimensions.
fn embedded(record: &Record<2>) -> Record<3> {
    let state = |y: &State<2>| State::<3>::new(y[0], y[1], y[1]);
    let point = |at: &Return<2>| Return {
        time: at.time,
        state: state(&at.state),
    };
    Record {
        returns: record.returns.iter().map(point).collect(),
        waypoints: record.waypoints.iter().map(point).collect(),
        ended: match &record.ended {
            Ended::Complete => Ended::Complete,
            Ended::Steady {
                time,
                equilibrium,
                stable,
            } => Ended::Steady {
                time: *time,
                equilibrium: state(equilibrium),
                stable: *stable,
            },
            Ended::Stopped => Ended::Stopped,
            Ended::Failed(error) => Ended::Failed(error.clone()),
        },
        accuracy: record.accuracy,
    }
}

fn follow<const N: usize>(
    plan: &SectionPlan,
    field: &dyn Driven<N>,
    start: State<N>,
    sink: &mut dyn Sink,
    exponents: impl Fn(&Record<N>) -> Result<Option<Lyapunov>>,
) -> Result<SectionOutcome> {
    let mut integrator = plan
        .method
        .integrator::<N>(plan.tolerances, plan.max_steps)?;
    let surface = Surface::stress(plan.stress, plan.direction);
    // One more, for the last row's next.
    let returns = plan.returns + 1;
    let watching = Watching {
        skip: plan.skip,
        returns,
        patience: plan.patience,
        accuracy: plan.tolerances.rtol,
        waypoints: plan.lyapunov,
    };
    let mut rows = RowMaker::new(plan, field);
    let all = (plan.skip + returns) as f64;
    let mut see = |passed: usize, at: Option<&Return<N>>| match at {
        Some(at) if passed >= plan.skip => rows.next(at, sink),
        Some(_) => Control::Continue,
        None => sink.reached(passed as f64 / all),
    };
    let record = record(
        &mut *integrator,
        field,
        &start,
        &surface,
        &watching,
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
        returns: record.returns.len().min(plan.returns),
        work: integrator.work(),
        failure: None,
        stopped: record.ended == Ended::Stopped,
    };
    if let Ended::Failed(error) = &record.ended {
        outcome.failure = Some(error.clone());
        return Ok(outcome);
    }
    if outcome.stopped {
        return Ok(outcome);
    }
    if plan.lyapunov {
        match exponents(&record) {
            Ok(found) => outcome.lyapunov = found,
            Err(error) => {
                outcome.failure = Some(error);
                return Ok(outcome);
            }
        }
    }
    judge(&mut outcome, field, &surface, &record)?;
    Ok(outcome)
}

fn judge<const N: usize>(
    outcome: &mut SectionOutcome,
    field: &dyn Driven<N>,
    surface: &Surface<N>,
    record: &Record<N>,
) -> Result<()> {
    let known = outcome.lyapunov.as_ref().map(|found| Exponents {
        values: &found.exponents,
        converged: found.converged,
    });
    let Verdict {
        regime,
        periodic,
        curve,
        why,
    } = verdict(field, surface, record, known)?;
    outcome.regime = regime;
    outcome.rotation_number = curve.map(|curve| curve.rotation);
    outcome.curves = curve.map(|curve| curve.curves);
    outcome.note = why.map(str::to_owned);
    if let Some(periodic) = periodic {
        outcome.period_of_orbit = Some(periodic.returns);
        outcome.period = Some(periodic.period);
    }
    if let Ended::Steady { stable: false, .. } = record.ended {
        outcome.note = Some(
            "the run begins at an unstable equilibrium, which it leaves only by rounding; start elsewhere".into(),
        );
    }
    Ok(())
}

/// Makes a row of each return and the next.
struct RowMaker<'a, const N: usize> {
    plan: &'a SectionPlan,
    field: &'a dyn Driven<N>,
    /// The last return, as a row without its end.
    open: Option<Vec<f64>>,
    made: usize,
}

impl<'a, const N: usize> RowMaker<'a, N> {
    fn new(plan: &'a SectionPlan, field: &'a dyn Driven<N>) -> Self {
        RowMaker {
            plan,
            field,
            open: None,
            made: 0,
        }
    }

    fn next(&mut self, at: &Return<N>, sink: &mut dyn Sink) -> Control {
        let (units, interfaces) = (&self.plan.system.units, self.plan.system.interfaces);
        let v = self.field.slip_rates(&at.state);
        let sum = units.outward(Quantity::SlipRate, v[..interfaces].iter().sum());
        let told = self.open.take().map(|mut row| {
            row.push(sum);
            self.made += 1;
            sink.row(&row)
        });
        let states = [at.state[1], at.state[N - 1]];
        let mut row = vec![self.made as f64, units.outward(Quantity::Time, at.time)];
        row.extend(
            states[..interfaces]
                .iter()
                .map(|&w| units.outward(Quantity::LogState, w)),
        );
        row.extend(
            v[..interfaces]
                .iter()
                .map(|&v| units.outward(Quantity::SlipRate, v)),
        );
        row.push(sum);
        self.open = Some(row);
        told.unwrap_or(Control::Continue)
    }
}
