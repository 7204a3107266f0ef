//! Every law in every system: Jacobian, second derivatives and parameter derivatives against differences of the field.

use proptest::prelude::*;
use twinslip::field::{Jacobian, State};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::model::{Driven, Loading, symmetric, two_interfaces};
use twinslip::orbit::InterfaceSystem;

/// Richardson-extrapolated central difference of g at 0, of sixth order: errors near 1e-12 for steps of 1e-2.
fn derivative<const N: usize>(g: impl Fn(f64) -> State<N>) -> State<N> {
    let central = |h: f64| (g(h) - g(-h)) / (2.0 * h);
    let h = 8e-3;
    let (a, b, c) = (central(h), central(h / 2.0), central(h / 4.0));
    let (ab, bc) = (b + (b - a) / 3.0, c + (c - b) / 3.0);
    bc + (bc - ab) / 15.0
}

fn unit<const N: usize>(i: usize) -> State<N> {
    let mut e = State::<N>::zeros();
    e[i] = 1.0;
    e
}

fn assert_near<const N: usize>(exact: State<N>, difference: State<N>, scale: f64, what: &str) {
    let error = (exact - difference).amax();
    assert!(
        error <= 1e-9 * scale,
        "{what}: {exact:?} against {difference:?}, off by {error:e} of {scale:e}"
    );
}

fn check<const N: usize>(
    make: fn(&InterfaceSystem) -> Box<dyn Driven<N>>,
    slab: InterfaceSystem,
    y: State<N>,
    what: &str,
) {
    /// The part of a parameter by which it is changed: powers change fast with beta.
    const PART: f64 = 0.1;
    let field = make(&slab);
    let j = field.jacobian(&y);
    // the field itself, with room for its growth over the differencing interval
    let scale = field.f(&y).amax() + j.amax() + 1.0;
    for i in 0..N {
        let e = unit::<N>(i);
        assert_near(
            j * e,
            derivative(|h| field.f(&(y + e * h))),
            scale,
            &format!("{what}, column {i} of J"),
        );
        let second_scale = scale * 10.0;
        for k in 0..N {
            let d = unit::<N>(k);
            let exact = field.second_derivative(&y, &e, &d);
            let differenced = derivative(|h| field.jacobian(&(y + d * h)) * e);
            assert_near(
                exact,
                differenced,
                second_scale,
                &format!("{what}, D2f [{i}, {k}]"),
            );
            let exchanged = (exact - field.second_derivative(&y, &d, &e)).amax();
            assert!(
                exchanged <= 1e-14 * second_scale,
                "{what}: symmetric in its directions"
            );
        }
    }
    assert_eq!(field.names(), slab.parameter_names());
    for (place, name) in field.names().iter().enumerate() {
        let value = slab.parameter(name).expect("a name");
        let moved = |h: f64| {
            let other = slab.with(name, value * (1.0 + PART * h));
            make(&other.expect("a value"))
        };
        let by_value = |h: f64| moved(h).f(&y);
        assert_near(
            field.parameter_derivative(&y, place) * value * PART,
            derivative(by_value),
            scale,
            &format!("{what}, {name}"),
        );
        for i in 0..N {
            let e = unit::<N>(i);
            let exact: Jacobian<N> = field.parameter_jacobian(&y, place) * value * PART;
            let differenced = derivative(|h| moved(h).jacobian(&y) * e);
            assert_near(
                exact * e,
                differenced,
                scale,
                &format!("{what}, dJ/d{name}"),
            );
        }
    }
}

fn law() -> impl Strategy<Value = AnyLaw> {
    (0..AnyLaw::NAMES.len(), 0.3..3.0, 1.0..1e3, 0.0..0.1).prop_map(|(i, beta, r, c)| {
        let p = Parameters::new(0.0349, 0.0349 * beta, 0.369, r, c).expect("valid");
        AnyLaw::named(AnyLaw::NAMES[i], p).expect("known")
    })
}

fn slab(law: AnyLaw, interfaces: usize, driving: f64, stiffness: f64) -> InterfaceSystem {
    InterfaceSystem {
        law,
        interfaces,
        loading: Loading::new(driving, stiffness).expect("valid"),
    }
}

/// |v| has a corner at v = 0, where no difference quotient makes sense.
fn away_from_the_corner(tau: f64) -> bool {
    tau.abs() > 0.05
}

proptest! {
    #[test]
    fn derivatives_of_two_interfaces(law in law(), tau in -12.0..12.0, w1 in -9.0..0.0, w2 in -9.0..0.0, v_h in 0.01..100.0, k in 0.01..10.0) {
        prop_assume!(away_from_the_corner(tau));
        let y = State::<3>::new(tau, w1, w2);
        check(InterfaceSystem::whole, slab(law, 2, v_h, k), y, &format!("{law:?}"));
    }

    #[test]
    fn derivatives_in_two_dimensions(law in law(), tau in -12.0..12.0, w in -9.0..0.0, v_h in 0.01..100.0, k in 0.01..10.0) {
        prop_assume!(away_from_the_corner(tau));
        let y = State::<2>::new(tau, w);
        check(InterfaceSystem::plane, slab(law, 1, v_h, k), y, &format!("single {law:?}"));
        check(InterfaceSystem::plane, slab(law, 2, v_h, k), y, &format!("symmetric {law:?}"));
    }

    #[test]
    fn symmetric_subspace_is_the_diagonal_of_two_interfaces(law in law(), tau in -12.0..12.0, w in -9.0..0.0, v_h in 0.01..100.0, k in 0.01..10.0) {
        let at = Loading::new(v_h, k).expect("valid");
        let (whole, diagonal) = (two_interfaces(law, at), symmetric(law, at));
        let (f3, f2) = (whole.f(&State::<3>::new(tau, w, w)), diagonal.f(&State::<2>::new(tau, w)));
        prop_assert!(f3[1] == f3[2] && f3[1] == f2[1]);
        let scale = k * (v_h + 2.0 * diagonal.slip_rates(&State::<2>::new(tau, w))[0].abs());
        prop_assert!((f3[0] - f2[0]).abs() <= 4.0 * f64::EPSILON * scale);
    }

    #[test]
    fn exchanging_the_interfaces_exchanges_the_states(law in law(), tau in -12.0..12.0, w1 in -9.0..0.0, w2 in -9.0..0.0) {
        let field = two_interfaces(law, Loading::new(1.0, 0.2).expect("valid"));
        let (f, g) = (field.f(&State::<3>::new(tau, w1, w2)), field.f(&State::<3>::new(tau, w2, w1)));
        prop_assert!(f[1] == g[2] && f[2] == g[1]);
        prop_assert!((f[0] - g[0]).abs() <= 1e-14 * (1.0 + f[0].abs()));
    }
}
