//! The Radau integrators: reference trajectories, stiffness, derivatives, and what a run keeps of the one before.

use crate::common::trajectories::Run;
use twinslip::field::{Jacobian, State, Vector, VectorField};
use twinslip::integrate::{
    AnyField, AnyIntegrator, Choice, Control, Integrator, MAX_STEPS, Radau, Tolerances,
};
use twinslip::model::{Smooth, two_interfaces};
use twinslip::number::Real;
use twinslip::series::Equations;

fn radau(tolerance: f64) -> Radau {
    Radau::new(Tolerances::equal(tolerance).expect("positive"), MAX_STEPS).expect("a method")
}

/// Against ends of 27 digits: the errors of steps grow along some of these runs, but fall with the tolerance.
#[test]
fn reference_trajectories_are_met() {
    for run in Run::all() {
        let field = two_interfaces(run.law, run.loading);
        let start = State::<3>::from(run.start);
        let error = |tolerance: f64| {
            let end = radau(tolerance).flow(&*field, (0.0, run.end_time), &start, None);
            run.error(&end.expect(&run.name))
        };
        let (rough, fine) = (error(1e-6), error(1e-11));
        assert!(fine < 1e-9, "{}: {fine:e}", run.name);
        assert!(
            fine < 1e-2 * rough.max(1e-9),
            "{}: {rough:e} {fine:e}",
            run.name
        );
    }
}

/// y' = -k (y - cos t) - sin t with y(0) = 1, whose solution is cos t (Prothero & Robinson 1974, Math. Comp. 28, 145-162), and t.
struct ProtheroRobinson(f64);

impl VectorField<2> for ProtheroRobinson {
    fn f(&self, s: &State<2>) -> State<2> {
        State::<2>::new(-self.0 * (s[0] - s[1].cos()) - s[1].sin(), 1.0)
    }

    fn jacobian(&self, s: &State<2>) -> Jacobian<2> {
        Jacobian::<2>::new(-self.0, -self.0 * s[1].sin() - s[1].cos(), 0.0, 0.0)
    }

    fn second_derivative(&self, s: &State<2>, u: &State<2>, v: &State<2>) -> State<2> {
        State::<2>::new((s[1].sin() - self.0 * s[1].cos()) * u[1] * v[1], 0.0)
    }
}

#[test]
fn stiffness_neither_shortens_steps_nor_costs_digits() {
    for stiffness in [1e2, 1e5, 1e8] {
        for tolerance in [1e-5, 1e-8, 1e-11] {
            let mut radau = radau(tolerance);
            let start = State::<2>::new(1.0, 0.0);
            let field = ProtheroRobinson(stiffness);
            let mut inside = 0.0_f64;
            let mut see = |step: &twinslip::integrate::Step<'_, 2>| {
                let middle = 0.5 * (step.t0 + step.t1);
                inside = inside.max((step.dense(middle)[0] - middle.cos()).abs());
                Ok(Control::Continue)
            };
            let end = radau.flow(&field, (0.0, 20.0), &start, Some(&mut see));
            let end = end.expect("a run");
            assert!(
                (end[0] - 20.0_f64.cos()).abs() < 10.0 * tolerance,
                "{stiffness} {tolerance}: {end}"
            );
            assert!(
                inside < 100.0 * tolerance,
                "{stiffness} {tolerance}: {inside:e}"
            );
            // The start is off the slow solution by nothing: only the solution itself asks for steps.
            let steps = Integrator::<2>::work(&radau).steps;
            assert!(steps < 300, "{stiffness} {tolerance}: {steps}");
        }
    }
}

/// x' = y, y' = mu (1 - x^2) y - a x
#[derive(Debug, Clone, Copy)]
struct VanDerPol;

impl Equations<2, 2> for VanDerPol {
    const PARAMETERS: [&'static str; 2] = ["mu", "a"];

    fn rates<T: Real>(&self, [x, y]: [T; 2], [mu, a]: [T; 2]) -> [T; 2] {
        [y, mu * (T::constant(1.0) - x * x) * y - a * x]
    }
}

#[test]
fn derivatives_are_those_of_the_flow() {
    let field = Smooth {
        equations: VanDerPol,
        parameters: [20.0, 1.0],
    };
    let field = AnyField::of::<2>(&field);
    let start = Vector::from_vec(vec![2.0, 0.0]);
    let by = |choice: Choice, tolerance: f64| {
        let tolerances = Tolerances::equal(tolerance).expect("positive");
        let mut method = AnyIntegrator::new(choice, tolerances, MAX_STEPS).expect("a method");
        // Through a jump, where they change by powers of ten.
        let made = method.derivatives(&field, (0.0, 20.0), &start, &[0, 1]);
        made.expect("derivatives")
    };
    let (end, known) = by(Choice::Taylor, 1e-15);
    let (found, made) = by(Choice::Radau, 1e-12);
    assert!((found - end).amax() < 1e-10);
    let size = known.parameters.amax();
    assert!(
        (&made.parameters - &known.parameters).amax() < 1e-6 * size,
        "{made:?} {known:?}"
    );
    assert!(
        (&made.start - &known.start).amax() < 1e-6,
        "{made:?} {known:?}"
    );
    let volumes = [&made, &known].map(|made| made.log_determinant.expect("made with the tangent"));
    assert!(
        (volumes[0] - volumes[1]).abs() < 1e-9 * volumes[1].abs(),
        "{volumes:?}"
    );
}

/// A run that begins where another has ended takes up its steps, and ends as it would by itself.
#[test]
fn arcs_one_after_the_other_are_those_of_their_own() {
    let field = ProtheroRobinson(1e4);
    let mut along = radau(1e-10);
    let (mut y, mut steps, mut apart) = (State::<2>::new(1.0, 0.0), 0, 0);
    for k in 0..40 {
        let span = (0.5 * f64::from(k), 0.5 * f64::from(k + 1));
        let mut alone = radau(1e-10);
        let by_itself = alone.flow(&field, span, &y, None).expect("a run");
        y = along.flow(&field, span, &y, None).expect("a run");
        assert!((by_itself - y).amax() < 1e-9, "{span:?}");
        steps += Integrator::<2>::work(&along).steps;
        apart += Integrator::<2>::work(&alone).steps;
    }
    assert!(5 * steps < 4 * apart, "{steps} {apart}");
    // From elsewhere it does not.
    let start = State::<2>::new(0.3, 2.0);
    let end = along.flow(&field, (0.0, 3.0), &start, None).expect("a run");
    assert!((end[0] - 5.0_f64.cos()).abs() < 1e-9, "{end}");
}

#[test]
fn bad_input_is_refused() {
    assert!(Radau::new(Tolerances::equal(1e-8).expect("positive"), 0).is_err());
    let start = State::<2>::new(f64::NAN, 0.0);
    assert!(
        radau(1e-8)
            .flow(&ProtheroRobinson(1.0), (0.0, 1.0), &start, None)
            .is_err()
    );
    let end = radau(1e-8).flow(
        &ProtheroRobinson(1.0),
        (0.0, f64::INFINITY),
        &State::<2>::zeros(),
        None,
    );
    assert!(end.is_err());
}
