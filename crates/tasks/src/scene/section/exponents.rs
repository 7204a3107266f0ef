//! Lyapunov exponents of what a return map has settled on: of a periodic orbit by its multipliers, of anything else by means
//! along a run.

use super::super::equations::Subspace;
use super::SectionPlan;
use twinslip::equilibrium::Symmetry;
use twinslip::error::Result;
use twinslip::field::Vector;
use twinslip::integrate::{AnyField, Choice, Control, MotionUnits};
use twinslip::number::Uncertain;
use twinslip::orbit::{
    FoundOrbit, InitialGuess, InterfaceSystem, Kind, Orbit, OrbitAccuracy, Query, find, find_from,
    find_unequal,
};
use twinslip::section::{
    Ended, FEWEST_FOR_EXPONENTS, Periodic, Return, ReturnRecord, at_equilibrium, spectrum_watched,
};

/// Periods that differ by less, relatively, are of one orbit.
const SAME_PERIOD: f64 = 1e-6;

/// The Lyapunov exponents of a run, dimensionless, with what checks them.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedExponents {
    /// In descending order.
    pub exponents: Vec<Uncertain>,
    /// The largest of those across the flow; at rest, of all.
    pub across_flow: Option<Uncertain>,
    /// Whether both halves of the returns agree on them.
    pub converged: bool,
    /// The growth rate along the flow itself, which is zero but for errors; `None` at rest, where there is none.
    pub along_flow: Option<f64>,
    /// The sum of the exponents less the mean of the trace, of which that sum knows nothing; `None` at rest.
    pub liouville_defect: Option<f64>,
}

impl CheckedExponents {
    /// The same in a system's own unit of time.
    pub(super) fn outward(self, units: &MotionUnits) -> Self {
        let rate = |x: Uncertain| units.outward_rate(x);
        CheckedExponents {
            exponents: self.exponents.into_iter().map(rate).collect(),
            across_flow: self.across_flow.map(rate),
            converged: self.converged,
            along_flow: self.along_flow.map(|x| x / units.time),
            liouville_defect: self.liouville_defect.map(|x| x / units.time),
        }
    }
}

/// Told how far it has come; it may stop it.
pub(super) type ProgressObserver<'a> = &'a mut dyn FnMut(f64) -> Control;

/// The exponents by means along a record with waypoints, or of the equilibrium that it ends at; `None` of too few returns, and
/// if it is stopped.
pub(super) fn of_record(
    field: &AnyField<'_>,
    record: &ReturnRecord,
    see: ProgressObserver<'_>,
) -> Result<Option<CheckedExponents>> {
    if let Ended::Steady { equilibrium, .. } = &record.ended {
        let exponents = at_equilibrium(field, equilibrium);
        return Ok(Some(CheckedExponents {
            across_flow: exponents.first().copied(),
            exponents,
            converged: true,
            along_flow: None,
            liouville_defect: None,
        }));
    }
    if record.returns.len() < FEWEST_FOR_EXPONENTS {
        return Ok(None);
    }
    let found = spectrum_watched(field, record, see)?;
    Ok(found.map(|found| CheckedExponents {
        across_flow: found.across_flow(),
        exponents: found.exponents,
        converged: found.converged,
        along_flow: Some(found.along_flow),
        liouville_defect: Some(found.liouville_defect),
    }))
}

/// ln |mu| / T of the periodic orbit through a point of this field, with its period; `None` where that orbit or one of its multipliers is
/// not known.
pub(super) fn of_orbit(
    plan: &SectionPlan,
    field: &AnyField<'_>,
    periodic: &Periodic,
    max_step: f64,
) -> Option<(Uncertain, CheckedExponents)> {
    let (y, period) = (&periodic.point, periodic.period.value);
    let accuracy = OrbitAccuracy::of(Choice::Taylor).stepping(max_step);
    let same = |found: Result<FoundOrbit>| {
        let orbit = found.ok()?.orbit;
        let apart = orbit.period.value / period - 1.0;
        (apart.abs() < SAME_PERIOD).then_some(orbit)
    };
    let Some((system, loading)) = plan.system.closed_forms() else {
        let orbit = same(find_from(field, y, Some(period), &accuracy))?;
        return Some((orbit.period, of_multipliers(&orbit)?));
    };
    let begin = InitialGuess::At {
        start: (y[0], [y[1], y[y.len() - 1]]),
        period: Some(period),
    };
    let slab = InterfaceSystem {
        law: system.law,
        interfaces: system.interfaces,
        loading,
    };
    let closed = |symmetry| same(find(&slab, &Query { symmetry, begin }, &accuracy));
    let alike = plan.subspace == Subspace::Symmetric || system.interfaces == 1;
    let orbit = match system.unequal(loading) {
        Some(interfaces) => same(find_unequal(&interfaces, begin, &accuracy))?,
        None if alike => closed(Symmetry::Symmetric)?,
        // A run in all dimensions may have settled on a symmetric orbit.
        None => closed(Symmetry::Asymmetric).or_else(|| closed(Symmetry::Symmetric))?,
    };
    Some((orbit.period, of_multipliers(&orbit)?))
}

fn of_multipliers(orbit: &Orbit) -> Option<CheckedExponents> {
    let Uncertain {
        value: period,
        uncertainty,
    } = orbit.period;
    // That along the flow is zero: an orbit comes back to itself.
    let mut exponents = vec![Uncertain::new(0.0, 0.0)];
    for multiplier in &orbit.floquet.multipliers {
        if multiplier.kind == Kind::BelowFloor {
            return None;
        }
        let rate = multiplier.ln_abs.value / period;
        let error = (multiplier.ln_abs.uncertainty + rate.abs() * uncertainty) / period;
        let error = error + f64::EPSILON * rate.abs();
        exponents.push(Uncertain::new(rate, error));
    }
    let known = exponents.iter().all(|x| x.uncertainty.is_finite());
    let across_flow = exponents.get(1).copied();
    exponents.sort_by(|a, b| b.value.total_cmp(&a.value));
    known.then(|| CheckedExponents {
        across_flow,
        exponents,
        converged: true,
        along_flow: Some(orbit.floquet.trivial_defect.ln_1p() / period),
        liouville_defect: orbit.floquet.liouville_defect.map(|x| x / period),
    })
}

/// A record of the symmetric subspace in all three dimensions.
pub(super) fn embedded(record: &ReturnRecord) -> ReturnRecord {
    let state = |y: &Vector| Vector::from_vec(vec![y[0], y[1], y[1]]);
    let point = |at: &Return| Return {
        time: at.time,
        state: state(&at.state),
    };
    ReturnRecord {
        max_step: record.max_step,
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
