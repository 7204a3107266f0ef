//! The tangent flow of the Rosenbrock integrators: against the same method on the extended system, against differences,
//! and against the identities that tangent flows obey.

use crate::common::trajectories;
use trajectories::Run;
use twinslip::field::{Jacobian, State, VectorField};
use twinslip::integrate::{
    Control, Integrator, MAX_STEPS, Rosenbrock, RosenbrockMethod, Step, Tolerances,
};
use twinslip::model::{Driven, two_interfaces};

fn integrator<const N: usize>(method: RosenbrockMethod, tolerance: f64) -> Rosenbrock<N> {
    Rosenbrock::new(method, Tolerances::equal(tolerance).unwrap(), MAX_STEPS).unwrap()
}

/// The state and the columns of its tangent as one system of twelve equations.
struct Extended(Box<dyn Driven<3>>);

/// (y, Y), the columns of Y one after the other.
fn joined(y: &State<3>, tangent: &Jacobian<3>) -> State<12> {
    State::<12>::from_iterator(y.iter().chain(tangent.iter()).copied())
}

fn split(z: &State<12>) -> (State<3>, Jacobian<3>) {
    (
        z.fixed_rows::<3>(0).into(),
        Jacobian::from_column_slice(&z.as_slice()[3..]),
    )
}

impl VectorField<12> for Extended {
    fn f(&self, z: &State<12>) -> State<12> {
        let (y, tangent) = split(z);
        joined(&self.0.f(&y), &(self.0.jacobian(&y) * tangent))
    }

    fn jacobian(&self, z: &State<12>) -> Jacobian<12> {
        let (y, tangent) = split(z);
        let j = self.0.jacobian(&y);
        let mut all = Jacobian::<12>::zeros();
        for block in 0..4 {
            all.fixed_view_mut::<3, 3>(3 * block, 3 * block)
                .copy_from(&j);
        }
        for column in 0..3 {
            for k in 0..3 {
                let e = State::<3>::from_fn(|i, _| f64::from(u8::from(i == k)));
                let coupling = self
                    .0
                    .second_derivative(&y, &tangent.column(column).into(), &e);
                all.fixed_view_mut::<3, 1>(3 * column + 3, k)
                    .copy_from(&coupling);
            }
        }
        all
    }

    fn second_derivative(&self, _: &State<12>, _: &State<12>, _: &State<12>) -> State<12> {
        unreachable!("a plain flow takes no second derivatives")
    }
}

fn field(run: &Run) -> Box<dyn Driven<3>> {
    two_interfaces(run.law, run.loading)
}

/// One step of both, of the same length, does the same arithmetic up to rounding.
#[test]
fn a_step_is_that_of_the_extended_system() {
    let run = Run::named("A3_K0.14_VH100, t = 2");
    // So loose that each call takes one step of its whole length.
    let tolerances = Tolerances::new(0.5, 1e9).unwrap();
    for method in RosenbrockMethod::ALL {
        let mut small = Rosenbrock::<3>::new(method, tolerances, 1).unwrap();
        let mut large = Rosenbrock::<12>::new(method, tolerances, 1).unwrap();
        let start = joined(&run.start, &Jacobian::identity());
        for h in [1e-3, -1e-3, 0.02, 0.1] {
            let t = (0.0, h);
            let (y, tangent) = small.tangent_flow(&*field(&run), t, &run.start).unwrap();
            let extended = large.flow(&Extended(field(&run)), t, &start, None).unwrap();
            let difference = (joined(&y, &tangent) - extended).amax() / extended.amax();
            assert!(difference < 1e-12, "{method:?}, {h}: {difference:e}");
        }
    }
}

/// Largest entry of the difference relative to the largest entry.
fn distance(a: &Jacobian<3>, exact: &Jacobian<3>) -> f64 {
    (a - exact).amax() / exact.amax()
}

#[test]
fn a_run_is_that_of_the_extended_system() {
    for name in [
        "A3_K0.14_VH100, t = 2",
        "A5_K0.14_VH1000_far, t = 1",
        "E1_DR_K0.45, t = 50",
    ] {
        let run = Run::named(name);
        let t = (0.0, run.end_time);
        let start = joined(&run.start, &Jacobian::identity());
        let exact = integrator::<12>(RosenbrockMethod::Rodas5P, 1e-12)
            .flow(&Extended(field(&run)), t, &start, None)
            .unwrap();
        let (_, exact) = split(&exact);
        for (method, tolerance, allowed) in [
            (RosenbrockMethod::Rodas5P, 1e-10, 1e-7),
            (RosenbrockMethod::Rodas4, 1e-10, 1e-7),
            (RosenbrockMethod::Ros23, 1e-7, 3e-2),
        ] {
            let mut rosenbrock = integrator::<3>(method, tolerance);
            let (y, tangent) = rosenbrock
                .tangent_flow(&*field(&run), t, &run.start)
                .unwrap();
            let error = distance(&tangent, &exact);
            println!("{name}, {method:?}: {error:.1e}, {:?}", rosenbrock.work());
            assert!(error < allowed, "{name}, {method:?}: {error:e}");
            assert!(run.error(&y) < allowed);
        }
    }
}

#[test]
fn a_tangent_is_the_limit_of_differences() {
    let run = Run::named("D_K0.2_VH0.102_torus, t = 2000");
    let t = (0.0, 300.0);
    for (method, tolerance) in [
        (RosenbrockMethod::Rodas5P, 1e-12),
        (RosenbrockMethod::Rodas4, 1e-11),
    ] {
        let mut rosenbrock = integrator::<3>(method, tolerance);
        let (_, tangent) = rosenbrock
            .tangent_flow(&*field(&run), t, &run.start)
            .unwrap();
        let mut differences = Jacobian::<3>::zeros();
        let delta = 1e-5;
        for k in 0..3 {
            let mut end = |sign: f64| {
                let mut start = run.start;
                start[k] += sign * delta;
                rosenbrock.flow(&*field(&run), t, &start, None).unwrap()
            };
            let column = (end(1.0) - end(-1.0)) / (2.0 * delta);
            differences.set_column(k, &column);
        }
        let error = distance(&differences, &tangent);
        println!("{method:?}: {error:e}");
        assert!(error < 1e-6, "{method:?}: {error:e}");
    }
}

/// det Y = exp(integral of tr J): Liouville.
#[test]
fn the_determinant_is_that_of_liouville() {
    let run = Run::named("A3_K0.14_VH100, t = 2");
    let field = field(&run);
    let mut rosenbrock = integrator::<3>(RosenbrockMethod::Rodas5P, 1e-11);
    let (_, tangent) = rosenbrock
        .tangent_flow(&*field, (0.0, 0.1), &run.start)
        .unwrap();
    let mut logarithm = 0.0;
    // Gauss's three points on each step
    let mut add = |step: &Step<'_, 3>| {
        let (middle, half) = (0.5 * (step.t0 + step.t1), 0.5 * (step.t1 - step.t0));
        let trace = |x: f64| field.jacobian(&step.dense(middle + half * x)).trace();
        let outer = 0.6_f64.sqrt();
        logarithm += half * (5.0 * trace(-outer) + 8.0 * trace(0.0) + 5.0 * trace(outer)) / 9.0;
        Ok(Control::Continue)
    };
    rosenbrock
        .flow(&*field, (0.0, 0.1), &run.start, Some(&mut add))
        .unwrap();
    let error = (tangent.determinant().ln() - logarithm).abs();
    assert!(error < 1e-8, "{error:e}");
}

#[test]
fn backwards_the_tangent_is_the_inverse() {
    let run = Run::named("E1_DR_K0.45, t = 50");
    for (method, tolerance) in [
        (RosenbrockMethod::Rodas5P, 1e-12),
        (RosenbrockMethod::Rodas4, 1e-12),
        (RosenbrockMethod::Ros23, 1e-9),
    ] {
        let mut rosenbrock = integrator::<3>(method, tolerance);
        let field = field(&run);
        let (there, forth) = rosenbrock
            .tangent_flow(&*field, (0.0, 1.0), &run.start)
            .unwrap();
        let (back, inverse) = rosenbrock
            .tangent_flow(&*field, (1.0, 0.0), &there)
            .unwrap();
        let error = (inverse * forth - Jacobian::identity()).amax();
        println!("{method:?}: {error:e}");
        assert!(error < 1e4 * tolerance, "{method:?}: {error:e}");
        assert!((back - run.start).amax() < 1e4 * tolerance);
    }
}

/// Loose tolerances give a loose tangent, and not a wrong one: the tangent is inside the error test.
#[test]
fn the_tangent_error_falls_with_the_tolerance() {
    let run = Run::named("A3_K0.14_VH100, t = 2");
    let t = (0.0, run.end_time);
    let tangent = |tolerance| {
        let mut rosenbrock = integrator::<3>(RosenbrockMethod::Rodas5P, tolerance);
        rosenbrock
            .tangent_flow(&*field(&run), t, &run.start)
            .unwrap()
            .1
    };
    let exact = tangent(1e-13);
    let errors = [1e-5, 1e-7, 1e-9].map(|tolerance| distance(&tangent(tolerance), &exact));
    println!("{errors:?}");
    for (error, allowed) in errors.into_iter().zip([1e-1, 1e-3, 1e-5]) {
        assert!(error < allowed, "{errors:?}");
    }
    assert!(errors[2] < 2e-3 * errors[0]);
}
