//! KINSOL on classic problems (J. J. More, B. S. Garbow and K. E. Hillstrom, Testing unconstrained optimization software,
//! ACM Transactions on Mathematical Software 7, 1981, and their numbers), and its failures.

use super::*;
use twinslip::error::Error;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::model::{Loading, two_interfaces};
use twinslip::sundials::{Constraint, Kinsol, Outcome, Residual, Strategy};

struct System<F, J>(F, J);

impl<const N: usize, F, J> Residual<N> for System<F, J>
where
    F: Fn(&State<N>) -> State<N>,
    J: Fn(&State<N>) -> Jacobian<N>,
{
    fn residual(&self, u: &State<N>) -> State<N> {
        (self.0)(u)
    }
    fn jacobian(&self, u: &State<N>) -> Jacobian<N> {
        (self.1)(u)
    }
}

fn ones<const N: usize>() -> State<N> {
    State::repeat(1.0)
}

/// (1), whose only root is (1, 1).
fn rosenbrock() -> impl Residual<2> {
    System(
        |u: &State<2>| State::<2>::new(10.0 * (u[1] - u[0] * u[0]), 1.0 - u[0]),
        |u: &State<2>| Jacobian::<2>::new(-20.0 * u[0], 10.0, -1.0, 0.0),
    )
}

/// u^2 + 1, which has no root.
fn rootless() -> impl Residual<1> {
    System(
        |u: &State<1>| State::<1>::new(u[0] * u[0] + 1.0),
        |u: &State<1>| Jacobian::<1>::new(2.0 * u[0]),
    )
}

#[test]
fn rosenbrock_has_its_root_with_both_strategies() {
    let mut kinsol = Kinsol::<2>::new().unwrap();
    for strategy in [Strategy::LineSearch, Strategy::Newton] {
        kinsol.settings.strategy = strategy;
        let guess = State::<2>::new(-1.2, 1.0);
        let root = kinsol
            .solve(&rosenbrock(), &guess, &ones(), &ones())
            .unwrap();
        assert!((root - ones::<2>()).amax() < 1e-12, "{strategy:?}: {root}");
        let work = kinsol.work().unwrap();
        assert!(work.iterations >= 1 && work.jacobians >= work.iterations);
        assert!(work.residuals > work.iterations && work.residual_norm < 1e-12);
    }
}

#[test]
fn freudenstein_and_roth_have_their_root() {
    // (2), root (5, 4)
    let problem = System(
        |u: &State<2>| {
            State::<2>::new(
                -13.0 + u[0] + ((5.0 - u[1]) * u[1] - 2.0) * u[1],
                -29.0 + u[0] + ((u[1] + 1.0) * u[1] - 14.0) * u[1],
            )
        },
        |u: &State<2>| {
            Jacobian::<2>::new(
                1.0,
                (10.0 - 3.0 * u[1]) * u[1] - 2.0,
                1.0,
                (3.0 * u[1] + 2.0) * u[1] - 14.0,
            )
        },
    );
    let mut kinsol = Kinsol::<2>::new().unwrap();
    let root = kinsol
        .solve(&problem, &State::<2>::new(6.0, 3.0), &ones(), &ones())
        .unwrap();
    assert!((root - State::<2>::new(5.0, 4.0)).amax() < 1e-10, "{root}");
}

#[test]
fn powell_badly_scaled_needs_and_uses_its_scales() {
    // (3): 1e4 u1 u2 = 1, exp(-u1) + exp(-u2) = 1.0001; root (1.098...e-5, 9.106...)
    let problem = System(
        |u: &State<2>| {
            State::<2>::new(
                1e4 * u[0] * u[1] - 1.0,
                (-u[0]).exp() + (-u[1]).exp() - 1.0001,
            )
        },
        |u: &State<2>| Jacobian::<2>::new(1e4 * u[1], 1e4 * u[0], -(-u[0]).exp(), -(-u[1]).exp()),
    );
    let mut kinsol = Kinsol::<2>::new().unwrap();
    let root = kinsol
        .solve(
            &problem,
            &State::<2>::new(0.0, 1.0),
            &State::<2>::new(1e5, 0.1),
            &State::<2>::new(1.0, 1e4),
        )
        .unwrap();
    assert!((root[0] / 1.098_159_327_e-5 - 1.0).abs() < 1e-8, "{root}");
    assert!((root[1] / 9.106_146_739 - 1.0).abs() < 1e-9, "{root}");
}

#[test]
fn broyden_tridiagonal_of_ten_unknowns() {
    // (30): (3 - 2 u_i) u_i - u_{i-1} - 2 u_{i+1} + 1 = 0
    const N: usize = 10;
    let problem = System(
        |u: &State<N>| {
            State::<N>::from_fn(|i, _| {
                let before = if i > 0 { u[i - 1] } else { 0.0 };
                let after = if i + 1 < N { u[i + 1] } else { 0.0 };
                (3.0 - 2.0 * u[i]) * u[i] - before - 2.0 * after + 1.0
            })
        },
        |u: &State<N>| {
            Jacobian::<N>::from_fn(|i, j| {
                if i == j {
                    3.0 - 4.0 * u[i]
                } else if j + 1 == i {
                    -1.0
                } else if j == i + 1 {
                    -2.0
                } else {
                    0.0
                }
            })
        },
    );
    let mut kinsol = Kinsol::<N>::new().unwrap();
    let root = kinsol
        .solve(&problem, &State::<N>::repeat(-1.0), &ones(), &ones())
        .unwrap();
    assert!(problem.residual(&root).amax() < 1e-12);
    assert!(root.iter().all(|u| (-0.8..-0.4).contains(u)), "{root}");
}

#[test]
fn an_equilibrium_of_two_interfaces_with_its_scales() {
    let (k, v_h) = (0.14, 10.0);
    let law = AnyLaw::named("spinodal", Parameters::heslot_1994()).unwrap();
    let field = two_interfaces(law, Loading::new(v_h, k).unwrap());
    let problem = System(|u: &State<3>| field.f(u), |u: &State<3>| field.jacobian(u));
    // psi = 1/(1 + R v) at v = V_H/2 solves dw/dt = 0; tau follows.
    let psi: f64 = 1.0 / (1.0 + 100.0 * 5.0);
    let guess = State::<3>::new(9.9, psi.ln(), psi.ln());
    let mut kinsol = Kinsol::<3>::new().unwrap();
    let f_scale = State::<3>::new(1.0 / (k * v_h), 0.2, 0.2);
    let root = kinsol.solve(&problem, &guess, &ones(), &f_scale).unwrap();
    assert!(field.f(&root).component_mul(&f_scale).amax() < 1e-12);
    assert!((root[1] - psi.ln()).abs() < 1e-10 && (root[2] - psi.ln()).abs() < 1e-10);
}

#[test]
fn the_guess_may_be_the_root() {
    let mut kinsol = Kinsol::<2>::new().unwrap();
    let (root, outcome) = kinsol
        .iterate(&rosenbrock(), &ones(), &ones(), &ones())
        .unwrap();
    assert_eq!((root, outcome), (ones(), Outcome::GuessWasSolution));
}

#[test]
fn constraints_choose_the_root() {
    let problem = System(
        |u: &State<1>| State::<1>::new(u[0] * u[0] - 4.0),
        |u: &State<1>| Jacobian::<1>::new(2.0 * u[0]),
    );
    let mut kinsol = Kinsol::<1>::new().unwrap();
    // From 0.1 a full step leads to 20; from -0.1 to -20.
    for (constraint, guess, root) in [
        (Constraint::Positive, 0.1, 2.0),
        (Constraint::NonNegative, 0.1, 2.0),
        (Constraint::Negative, -0.1, -2.0),
        (Constraint::NonPositive, -0.1, -2.0),
    ] {
        kinsol.settings.constraints = [constraint];
        let found = kinsol
            .solve(&problem, &State::<1>::new(guess), &ones(), &ones())
            .unwrap();
        assert!((found[0] - root).abs() < 1e-10);
    }
    // A guess against its constraint is refused, by name; without constraints it is taken again.
    kinsol.settings.constraints = [Constraint::Positive];
    let guess = State::<1>::new(-1.0);
    match kinsol.solve(&problem, &guess, &ones(), &ones()) {
        Err(Error::Sundials { function, name, .. }) => {
            assert_eq!((function, name.as_str()), ("KINSol", "KIN_ILL_INPUT"));
        }
        other => panic!("{other:?}"),
    }
    kinsol.settings.constraints = [Constraint::Free];
    let found = kinsol.solve(&problem, &guess, &ones(), &ones()).unwrap();
    assert!((found[0] + 2.0).abs() < 1e-10);
}

#[test]
fn what_has_no_root_does_not_converge() {
    let mut kinsol = Kinsol::<1>::new().unwrap();
    for strategy in [Strategy::LineSearch, Strategy::Newton] {
        kinsol.settings.strategy = strategy;
        let error = kinsol
            .solve(&rootless(), &State::<1>::new(0.7), &ones(), &ones())
            .unwrap_err();
        match error {
            Error::NotConverged {
                residual,
                tolerance,
                iterations,
                ..
            } => {
                assert!(residual >= 1.0 && tolerance == 1e-12 && iterations > 0);
            }
            other => panic!("{other}"),
        }
    }
}

#[test]
fn the_bound_on_iterations_is_kept() {
    let mut kinsol = Kinsol::<2>::new().unwrap();
    kinsol.settings.max_iterations = 1;
    kinsol.settings.strategy = Strategy::Newton;
    let error = kinsol
        .solve(&rosenbrock(), &State::<2>::new(-1.2, 1.0), &ones(), &ones())
        .unwrap_err();
    assert!(
        matches!(error, Error::NotConverged { iterations: 1, .. }),
        "{error}"
    );
}

#[test]
fn a_residual_outside_its_domain_is_stepped_back_from_or_reported() {
    // ln u = 0 from 5: the first Newton step leads to 5 - 5 ln 5 < 0.
    let logarithm = System(
        |u: &State<1>| State::<1>::new(u[0].ln()),
        |u: &State<1>| Jacobian::<1>::new(1.0 / u[0]),
    );
    let mut kinsol = Kinsol::<1>::new().unwrap();
    let root = kinsol
        .solve(&logarithm, &State::<1>::new(5.0), &ones(), &ones())
        .unwrap();
    assert!((root[0] - 1.0).abs() < 1e-11);
    for guess in [-1.0, f64::NAN] {
        let error = kinsol
            .solve(&logarithm, &State::<1>::new(guess), &ones(), &ones())
            .unwrap_err();
        assert!(matches!(error, Error::NonFinite { .. }), "{error}");
    }
}

#[test]
fn a_singular_jacobian_is_an_error_with_a_name() {
    let singular = System(
        |u: &State<2>| State::<2>::new(u[0] + u[1] - 1.0, u[0] + u[1] - 2.0),
        |_: &State<2>| Jacobian::<2>::repeat(1.0),
    );
    let mut kinsol = Kinsol::<2>::new().unwrap();
    match kinsol.solve(&singular, &State::<2>::zeros(), &ones(), &ones()) {
        Err(Error::Sundials { function, name, .. }) => {
            assert_eq!(function, "KINSol");
            assert!(name.starts_with("KIN_LS"), "{name}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn scales_must_be_positive_and_finite() {
    let mut kinsol = Kinsol::<2>::new().unwrap();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let bad = State::<2>::new(1.0, bad);
        for (u_scale, f_scale) in [(bad, ones()), (ones(), bad)] {
            let error = kinsol
                .solve(&rosenbrock(), &State::<2>::zeros(), &u_scale, &f_scale)
                .unwrap_err();
            assert!(error.is_input(), "{error}");
        }
    }
}

/// What makes KINSOL print when nobody listens.
pub fn provoke() {
    let mut kinsol = Kinsol::<1>::new().unwrap();
    kinsol
        .solve(&rootless(), &State::<1>::new(0.7), &ones(), &ones())
        .unwrap_err();
    kinsol.settings.constraints = [Constraint::Positive];
    kinsol
        .solve(&rootless(), &State::<1>::new(-0.7), &ones(), &ones())
        .unwrap_err();
}
