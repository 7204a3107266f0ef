//! What errors are measured against. The one place that knows the reference.

use super::scene::Problem;
use twinslip::field::{Jacobian, State};
use twinslip::integrate::{Integrator, MAX_STEPS, Rosenbrock, RosenbrockMethod, Tolerances};

/// TODO before any claim: the double-double reference instead.
fn stand_in() -> Rosenbrock<3> {
    let tolerances = Tolerances::equal(1e-13).expect("checked");
    Rosenbrock::new(RosenbrockMethod::Rodas5P, tolerances, MAX_STEPS).expect("checked")
}

/// The state at the end of a scene.
pub fn exact_end(problem: &Problem) -> State<3> {
    stand_in()
        .flow(
            &*problem.field(),
            (0.0, problem.until),
            &problem.start,
            None,
        )
        .unwrap_or_else(|error| panic!("the reference of {}: {error}", problem.name))
}

/// The tangent flow from `start` over a time.
pub fn exact_tangent(problem: &Problem, start: &State<3>, time: f64) -> Jacobian<3> {
    stand_in()
        .tangent_flow(&*problem.field(), (0.0, time), start)
        .unwrap_or_else(|error| panic!("the reference of {}: {error}", problem.name))
        .1
}
