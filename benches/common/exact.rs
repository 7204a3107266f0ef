//! What errors are measured against: the Taylor method in double-double arithmetic. The one place that knows it.

use super::scene::Problem;
use twinslip::field::{Jacobian, State};
use twinslip::integrate::{Integrator, MAX_STEPS, Taylor};

fn reference() -> Taylor {
    Taylor::reference(MAX_STEPS).expect("checked")
}

/// The state at the end of a scene.
pub fn exact_end(problem: &Problem) -> State<3> {
    let t = (0.0, problem.until);
    reference()
        .flow(&*problem.field(), t, &problem.start, None)
        .unwrap_or_else(|error| panic!("the reference of {}: {error}", problem.name))
}

/// The tangent flow from the start to the end of a scene.
pub fn exact_tangent(problem: &Problem) -> Jacobian<3> {
    let t = (0.0, problem.until);
    reference()
        .tangent_flow(&*problem.field(), t, &problem.start)
        .unwrap_or_else(|error| panic!("the reference of {}: {error}", problem.name))
        .1
}
