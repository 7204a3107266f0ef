//! Far outside what anybody would ask for: a finite state or a typed error within the bound on steps, and nothing else.

use twinslip::error::{Error, Result};
use twinslip::field::{Jacobian, State, VectorField};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Integrator, Rosenbrock, RosenbrockMethod, Tolerances, Work};
use twinslip::model::{Driven, Loading, two_interfaces};

const LIMIT: usize = 400;

/// Calls `check` with a fifth of the systems and starts of the grid, another one each time.
fn grid(check: impl Fn(&str, &dyn Driven<3>, &State<3>)) {
    const PARTS: u64 = 5;
    let mut at = crate::common::random() % PARTS;
    for law in AnyLaw::NAMES {
        let any = AnyLaw::named(law, Parameters::heslot_1994()).unwrap();
        for stiffness in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
            for driving in [1e-8, 1e-3, 1.0, 1e3, 1e8] {
                at += crate::common::random() % PARTS;
                let field = two_interfaces(any, Loading::new(driving, stiffness).unwrap());
                for tau in [-50.0, 0.0, 10.0, 50.0, 500.0] {
                    for psi in [[1.0, 1.0], [1e-3, 0.5], [1e-300, 1.0], [1e-300, 1e-300]] {
                        at += 1;
                        if !at.is_multiple_of(PARTS) {
                            continue;
                        }
                        let [first, second] = psi.map(f64::ln);
                        let start = State::<3>::new(tau, first, second);
                        let name = format!("{law}, K {stiffness}, V_H {driving}, {start:?}");
                        check(&name, &*field, &start);
                    }
                }
            }
        }
    }
}

/// Whether this is one of the outcomes that a flow may have, with no more work than allowed.
fn check_outcome(name: &str, outcome: Result<Vec<f64>>, work: Work) {
    assert!(work.steps + work.rejected <= LIMIT, "{name}: {work:?}");
    match outcome {
        Ok(values) => assert!(values.iter().all(|x| x.is_finite()), "{name}: {values:?}"),
        Err(Error::TooManySteps { t, .. } | Error::NonFinite { t, .. }) => assert!(t.is_finite()),
        Err(Error::StepTooSmall { t, h }) => assert!(t.is_finite() && h.is_finite(), "{name}"),
        Err(Error::BlowUp { t, rate, .. } | Error::TooFast { t, rate, .. }) => {
            assert!(t.is_finite() && rate.is_finite(), "{name}")
        }
        Err(other) => panic!("{name}: {other:?}"),
    }
}

fn integrator(method: RosenbrockMethod) -> Rosenbrock<3> {
    Rosenbrock::new(method, Tolerances::equal(1e-6).unwrap(), LIMIT).unwrap()
}

#[test]
fn every_flow_ends_in_a_state_or_a_named_failure() {
    for method in RosenbrockMethod::ALL {
        grid(|name, field, start| {
            for t in [(0.0, 1e3), (1e3, 0.0), (0.0, 1e300)] {
                let mut rosenbrock = integrator(method);
                let outcome = rosenbrock.flow(field, t, start, None);
                let outcome = outcome.map(|y| y.as_slice().to_vec());
                check_outcome(name, outcome, rosenbrock.work());
            }
        });
    }
}

#[test]
fn every_tangent_flow_ends_in_a_state_or_a_named_failure() {
    for method in RosenbrockMethod::ALL {
        grid(|name, field, start| {
            let mut rosenbrock = integrator(method);
            let outcome = rosenbrock.tangent_flow(field, (0.0, 1e3), start);
            let outcome =
                outcome.map(|(y, tangent)| y.iter().chain(tangent.iter()).copied().collect());
            check_outcome(name, outcome, rosenbrock.work());
        });
    }
}

/// At tau = 500 the slip rate is 1e212: the first step is that short, and yet the run goes through.
#[test]
fn a_step_of_1e_minus_210_is_one_to_start_with() {
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let field = two_interfaces(law, Loading::new(1.0, 0.14).unwrap());
    let start = State::<3>::new(500.0, -2.0, -3.0);
    assert!(field.f(&start).amax() > 1e200);
    for method in RosenbrockMethod::ALL {
        let mut rosenbrock =
            Rosenbrock::<3>::new(method, Tolerances::equal(1e-6).unwrap(), 1_000_000).unwrap();
        let end = rosenbrock.flow(&*field, (0.0, 1.0), &start, None).unwrap();
        println!("{method:?}: {end:?}, {:?}", rosenbrock.work());
        assert!(end[0] < 100.0 && end.iter().all(|x| x.is_finite()));
    }
}

/// y' = 1 where y < 1, and nothing beyond.
struct Cliff;

impl VectorField<1> for Cliff {
    fn f(&self, y: &State<1>) -> State<1> {
        State::<1>::new(if y[0] < 1.0 { 1.0 } else { f64::NAN })
    }
    fn jacobian(&self, _: &State<1>) -> Jacobian<1> {
        Jacobian::<1>::zeros()
    }
    fn second_derivative(&self, _: &State<1>, _: &State<1>, _: &State<1>) -> State<1> {
        State::zeros()
    }
}

#[test]
fn where_the_field_ends_the_flow_ends() {
    for method in RosenbrockMethod::ALL {
        let mut rosenbrock =
            Rosenbrock::<1>::new(method, Tolerances::equal(1e-6).unwrap(), LIMIT).unwrap();
        let outcome = rosenbrock.flow(&Cliff, (0.0, 2.0), &State::zeros(), None);
        let Err(Error::StepTooSmall { t, .. }) = outcome else {
            panic!("{method:?}: {outcome:?}");
        };
        assert!((t - 1.0).abs() < 1e-12, "{method:?}: {t}");
        let tangent = rosenbrock.tangent_flow(&Cliff, (0.0, 2.0), &State::zeros());
        assert!(matches!(tangent, Err(Error::StepTooSmall { .. })));
    }
}

/// y' = -y, in any dimension.
struct Decay;

impl<const N: usize> VectorField<N> for Decay {
    fn f(&self, y: &State<N>) -> State<N> {
        -y
    }
    fn jacobian(&self, _: &State<N>) -> Jacobian<N> {
        -Jacobian::<N>::identity()
    }
    fn second_derivative(&self, _: &State<N>, _: &State<N>, _: &State<N>) -> State<N> {
        State::zeros()
    }
}

/// Matrices stand on the stack, two megabytes of which are all that a thread has here.
#[test]
fn what_the_stack_cannot_hold_is_refused() {
    const MOST: usize = Rosenbrock::<1>::MAX_DIMENSION;
    const MOST_TANGENT: usize = Rosenbrock::<1>::MAX_TANGENT_DIMENSION;
    let tolerances = Tolerances::equal(1e-6).unwrap();
    for method in RosenbrockMethod::ALL {
        let refused = Rosenbrock::<400>::new(method, tolerances, LIMIT);
        assert!(refused.is_err_and(|error| error.is_input()));
        let mut rosenbrock = Rosenbrock::<MOST>::new(method, tolerances, LIMIT).unwrap();
        let end = rosenbrock.flow(&Decay, (0.0, 1.0), &State::repeat(1.0), None);
        assert!((end.unwrap()[MOST - 1] - (-1.0_f64).exp()).abs() < 1e-4);
        let refused = rosenbrock.tangent_flow(&Decay, (0.0, 1.0), &State::repeat(1.0));
        assert!(refused.is_err_and(|error| error.is_input()));
        let mut rosenbrock = Rosenbrock::<MOST_TANGENT>::new(method, tolerances, LIMIT).unwrap();
        let (_, tangent) = rosenbrock
            .tangent_flow(&Decay, (0.0, 1.0), &State::repeat(1.0))
            .unwrap();
        assert!((tangent[(0, 0)] - (-1.0_f64).exp()).abs() < 1e-4);
    }
}
