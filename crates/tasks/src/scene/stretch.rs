//! Along the stretches of a run: the field of each, and the next one from where the last has ended, to the bit, or from a node.

use super::plan::{Dimension, Plan, Point};
use super::program::Stretch;
use twinslip::error::{Error, Result};
use twinslip::field::{State, VectorField};
use twinslip::integrate::Work;
use twinslip::model::{self, Driven, Loading};

/// What goes along a stretch, whatever the number of variables of its field: those of the plan's dimension, and on ramps V_H.
pub(super) trait Along {
    /// The state at the end of the stretch, or where it is stopped.
    fn along<const N: usize>(
        &mut self,
        stretch: &Stretch,
        field: &dyn Driven<N>,
        from: &State<N>,
    ) -> Result<State<N>>;

    /// Whether to go no further.
    fn stopped(&self) -> bool;
}

/// Goes along all stretches of a plan, from its start.
pub(super) fn go(plan: &Plan, by: &mut impl Along) -> Result<Point> {
    let mut here = plan.start;
    for stretch in plan.stretches()? {
        here = one(plan, &stretch, stretch.from.unwrap_or(here), by)?;
        if by.stopped() {
            break;
        }
    }
    Ok(here)
}

fn one(
    plan: &Plan,
    stretch: &Stretch,
    (tau, [first, second]): Point,
    by: &mut impl Along,
) -> Result<Point> {
    let (law, stiffness) = (plan.system.law, plan.loading.stiffness);
    let (driving, rate) = (stretch.driving.0, stretch.rate());
    let loading = Loading { driving, stiffness };
    let plane = State::<2>::new(tau, first);
    let on_ramp = State::<3>::new(tau, first, driving);
    let ramp = (rate, stiffness);
    Ok(match (plan.dimension, rate == 0.0) {
        (Dimension::Single, true) => {
            let field = model::single_interface(law, loading);
            point(plan, &by.along(stretch, &*field, &plane)?)
        }
        (Dimension::Symmetric, true) => {
            let field = model::symmetric(law, loading);
            point(plan, &by.along(stretch, &*field, &plane)?)
        }
        (Dimension::Full, true) => {
            let from = State::<3>::new(tau, first, second);
            let end = match plan.system.unequal(loading) {
                Some(field) => by.along(stretch, &field, &from)?,
                None => by.along(stretch, &*model::two_interfaces(law, loading), &from)?,
            };
            point(plan, &end)
        }
        (Dimension::Single, false) => {
            let field = model::alike_on_ramp(law, 1, ramp);
            point(plan, &by.along(stretch, &field, &on_ramp)?)
        }
        (Dimension::Symmetric, false) => {
            let field = model::alike_on_ramp(law, 2, ramp);
            point(plan, &by.along(stretch, &field, &on_ramp)?)
        }
        (Dimension::Full, false) => {
            let from = State::<4>::new(tau, first, second, driving);
            let end = match plan.system.unequal {
                Some(laws) => {
                    let field = model::unequal_interfaces_on_ramp(laws, ramp);
                    by.along(stretch, &field, &from)?
                }
                None => by.along(stretch, &model::two_interfaces_on_ramp(law, ramp), &from)?,
            };
            point(plan, &end)
        }
    })
}

/// The point that a state stands for.
pub(super) fn point<const N: usize>(plan: &Plan, y: &State<N>) -> Point {
    (y[0], [y[1], y[plan.dimension.number() - 1]])
}

pub(super) fn as_field<const N: usize>(field: &dyn Driven<N>) -> &dyn VectorField<N> {
    field
}

/// How many steps a run may still take that comes to this stretch.
pub(super) fn steps_left(plan: &Plan, stretch: &Stretch, work: &Work) -> Result<usize> {
    match plan.max_steps.saturating_sub(work.steps) {
        0 => Err(Error::TooManySteps {
            t: stretch.span.0,
            end: plan.until,
            limit: plan.max_steps,
        }),
        left => Ok(left),
    }
}

/// The error of a stretch as one of the run.
pub(super) fn of_run(plan: &Plan, error: Error) -> Error {
    match error {
        Error::TooManySteps { t, .. } => Error::TooManySteps {
            t,
            end: plan.until,
            limit: plan.max_steps,
        },
        other => other,
    }
}
