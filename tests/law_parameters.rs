//! Every constant of a law is a parameter of its interfaces, of a name: fields, steady stresses and flows have derivatives in it.

use crate::common::relative;
use twinslip::equilibrium::Symmetry;
use twinslip::field::{State, VectorField, place};
use twinslip::friction::{AnyLaw, Law, Parameters, steady_stress};
use twinslip::integrate::{Integrator, MAX_STEPS, Taylor, Tolerances};
use twinslip::model::{Driven, Loading, Parameter};
use twinslip::number::{Jet, Real};
use twinslip::orbit::{InterfaceSystem, OverLogarithms};

fn slab(law: &str, interfaces: usize) -> InterfaceSystem {
    InterfaceSystem {
        law: AnyLaw::named(law, Parameters::heslot_1994()).unwrap(),
        interfaces,
        loading: Loading::new(1.0, 0.14).unwrap(),
    }
}

#[test]
fn a_law_has_its_own_constants_and_no_others() {
    let all = [
        "driving",
        "stiffness",
        "beta",
        "gamma0",
        "healing_time",
        "residual_strength",
        "damping",
    ];
    assert_eq!(Parameter::NAMES, all);
    for (law, count) in [
        ("spinodal", 6),
        ("bounded", 5),
        ("regularised-ageing", 4),
        ("dieterich-ruina", 4),
        ("slip", 4),
    ] {
        for interfaces in [1, 2] {
            let slab = slab(law, interfaces);
            assert_eq!(slab.parameter_names(), &all[..count], "{law}");
            assert_eq!(slab.whole().names(), &all[..count], "{law}");
            assert_eq!(slab.plane().names(), &all[..count], "{law}");
        }
    }
    let spinodal = slab("spinodal", 2).with("residual_strength", 0.01).unwrap();
    assert_eq!(spinodal.parameter("residual_strength").unwrap(), 0.01);
    assert_eq!(spinodal.parameter("healing_time").unwrap(), 100.0);
    assert!(spinodal.with("residual_strength", 0.0).is_ok());
}

#[test]
#[should_panic(expected = "no place 5")]
fn a_field_has_no_derivative_in_a_constant_that_its_law_lacks() {
    let slip = slab("slip", 2);
    let field = slip.whole();
    let field = field.parametrised().expect("named parameters");
    field.parameter_derivative(&State::<3>::new(9.0, -1.0, -2.0), 5);
}

#[test]
fn a_constant_that_a_law_does_not_have_is_an_error_of_input() {
    let slip = slab("slip", 2);
    let error = place(slip.whole().names(), "residual_strength").unwrap_err();
    assert!(
        error.is_input() && error.to_string().contains("beta"),
        "{error}"
    );
    assert!(slip.with("healing_time", 1.0).unwrap_err().is_input());
    assert!(slip.parameter("healing_time").unwrap_err().is_input());
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(slip.with("beta", value).unwrap_err().is_input(), "{value}");
    }
    for names in [["driving", "residual_strength"], ["beta", "beta"]] {
        let over = OverLogarithms::new(slip, Symmetry::Asymmetric, names);
        assert!(over.unwrap_err().is_input());
    }
    let y = State::<3>::new(9.0, -0.3, -0.1);
    let mut taylor = Taylor::new(Tolerances::equal(1e-10).unwrap(), MAX_STEPS).unwrap();
    let error = taylor.derivatives(&*slip.whole(), (0.0, 1.0), &y, &[4]);
    assert!(error.unwrap_err().is_input());
}

/// dv/dp and d(dpsi/dt)/dp of one interface at v > 0, from the formulas (4), (5), (6), (35) by hand.
fn by_hand(law: &str, name: &str, p: &Parameters, (v, psi): (f64, f64)) -> [f64; 2] {
    let r = p.healing_time;
    let strength = match law {
        "spinodal" => p.residual_strength + (1.0 + r) * psi,
        "bounded" => (1.0 + r) * psi,
        _ => psi,
    };
    let of_v = match name {
        "beta" => -v * strength.ln(),
        "gamma0" => v / p.gamma0,
        "healing_time" => -p.beta * v * psi / strength,
        "residual_strength" => -p.beta * v / strength,
        _ => unreachable!("{name}"),
    };
    let of_evolution = match law {
        "slip" => -psi * ((v * psi).ln() + 1.0),
        _ => -psi,
    };
    let healing = if name == "healing_time" {
        -(1.0 - psi) / (r * r)
    } else {
        0.0
    };
    [of_v, of_evolution * of_v + healing]
}

#[test]
fn fields_have_the_derivatives_that_the_laws_have_by_hand() {
    let p = Parameters::heslot_1994();
    let y = State::<3>::new(9.7, -1.2, -0.4);
    for law in AnyLaw::NAMES {
        let slab = slab(law, 2);
        let field = slab.whole();
        let v = field.slip_rates(&y);
        for (place, name) in field.names().iter().enumerate().skip(2) {
            let [first, second] = [0, 1].map(|i| by_hand(law, name, &p, (v[i], y[1 + i].exp())));
            let exact = State::<3>::new(
                -0.14 * (first[0] + second[0]),
                first[1] / y[1].exp(),
                second[1] / y[2].exp(),
            );
            let made = field.parameter_derivative(&y, place);
            let error = (made - exact).amax() / exact.amax();
            assert!(error < 1e-14, "{law}, {name}: {made:?}, {exact:?}");
        }
    }
}

/// The partial derivatives of tau_ss in V, c, R, b, a and a_v, computed in 50 digits and compared there with a law that is solved
/// numerically; tau in units of the varied a.
#[test]
fn steady_stresses_are_differentiated_in_the_constants() {
    const KNOWN: [[f64; 8]; 3] = [
        [
            0.1,
            11.377289975511813,
            -2.7363049842767118,
            0.15258345572079876,
            0.0011349182656918916,
            63.53392975421068,
            -391.9734975583412,
            28.653295121423323,
        ],
        [
            5.0,
            9.945521544352522,
            -0.07828946028950265,
            6.915933919936928,
            -0.00011021364727530055,
            -45.74605854142618,
            -238.85626336104082,
            28.653294997225107,
        ],
        [
            1000.0,
            8.780228341371663,
            0.00029595202520863215,
            697.091097570811,
            -6.963800788020262e-05,
            -177.9262260228232,
            -53.65252006400285,
            28.653293774389574,
        ],
    ];
    let (a, b, a_v) = (0.0349, 0.0489, 0.369);
    let p = Parameters::heslot_1994();
    let constants = [p.beta, p.gamma0, p.healing_time, p.residual_strength];
    for [v, stress, of_v, of_c, of_r, of_b, of_a, of_a_v] in KNOWN {
        let [v, beta, gamma0, r, c] =
            Jet::<f64, 5>::variables([v, constants[0], constants[1], constants[2], constants[3]]);
        let law = p
            .spinodal()
            .freed(Parameters::from([beta, gamma0, r, c, Real::constant(0.0)]));
        let made = steady_stress(&law, v);
        let [in_v, in_beta, in_gamma0, in_r, in_c] = made.gradient;
        let in_a = in_beta * -b / (a * a) + in_gamma0 * p.gamma0 * a_v / (a * a);
        for (made, known) in [
            (made.value, stress),
            (in_v, of_v),
            (in_c, of_c),
            (in_r, of_r),
            (in_beta / a, of_b),
            (in_a, of_a),
            (in_gamma0 * -p.gamma0 / a, of_a_v),
        ] {
            assert!(
                relative(made, known) < 1e-12,
                "{}: {made}, {known}",
                v.value
            );
        }
    }
}

fn apart<const N: usize>(made: &State<N>, exact: &[f64; N]) -> f64 {
    let exact = State::from(*exact);
    (made - exact).amax() / exact.amax()
}

/// The derivatives in these parameters, in this order: in 31 digits against differences, others against these.
fn check<const N: usize>(
    slab: &InterfaceSystem,
    make: fn(&InterfaceSystem) -> Box<dyn Driven<N>>,
    y: State<N>,
    free: &[usize],
) {
    /// By about so much the states differ that derivatives are compared with.
    const CHANGE: f64 = 2e-4;
    let what = format!("{}, {N}, {free:?}", slab.law.name());
    let (field, span) = (make(slab), (0.0, 1.0));
    let field: &dyn VectorField<N> = &*field;
    let mut reference = Taylor::reference(MAX_STEPS).unwrap();
    let (_, exact) = reference.derivatives(field, span, &y, free).unwrap();
    assert_eq!(exact.parameters.len(), free.len());
    for (&place, exact) in free.iter().zip(&exact.parameters) {
        let name = slab.parameter_names()[place];
        let value = slab.parameter(name).unwrap();
        let step = (CHANGE / State::from(*exact).amax()).min(0.2 * value);
        let mut at = |steps: f64| {
            let moved = make(&slab.with(name, value + steps * step).unwrap());
            reference.flow(&*moved, span, &y, None).unwrap()
        };
        let (near, far) = (at(1.0) - at(-1.0), at(2.0) - at(-2.0));
        let slope = (near * 8.0 - far) / (12.0 * step);
        let error = apart(&slope, exact);
        assert!(error < 1e-8, "{what}, {name}: {error:e}");
    }
    let mut taylor = Taylor::new(Tolerances::equal(1e-14).unwrap(), MAX_STEPS).unwrap();
    let (_, made) = taylor.derivatives(field, span, &y, free).unwrap();
    for (made, exact) in made.parameters.iter().zip(&exact.parameters) {
        let error = apart(&State::from(*made), exact);
        assert!(error < 1e-11, "{what}: {error:e}");
    }
    // With constants of the law free the series are made in loops, without them they are compiled.
    let (_, compiled) = taylor.derivatives(field, span, &y, &[0, 1]).unwrap();
    for (compiled, looped) in compiled.start.iter().zip(&made.start) {
        let error = apart(&State::from(*looped), compiled);
        assert!(error < 1e-11, "{what}, in the start: {error:e}");
    }
    #[cfg(feature = "sundials")]
    {
        use twinslip::integrate::CvodeIntegrator;
        use twinslip::sundials::MultistepMethod;
        let tolerances = Tolerances::equal(1e-11).unwrap();
        let mut cvode = CvodeIntegrator::new(MultistepMethod::Bdf, tolerances, MAX_STEPS).unwrap();
        let (_, _, made) = cvode.derivatives(field, span, &y, free).unwrap();
        assert_eq!(made.len(), free.len());
        for (made, exact) in made.iter().zip(&exact.parameters) {
            let error = apart(made, exact);
            assert!(error < 1e-6, "{what}, sensitivities: {error:e}");
        }
    }
}

#[test]
fn flows_are_differentiated_in_every_constant_of_every_law() {
    for law in AnyLaw::NAMES {
        let two = slab(law, 2);
        let (tau, w) = (two.steady_stress() - 0.3, two.steady_log_state());
        let count = two.parameter_names().len();
        let all: Vec<usize> = (0..count).rev().collect();
        for free in [&[2][..], &[count - 1, 0], &[3, 1], &all] {
            let y = State::<3>::new(tau, w + 0.2, w + 0.1);
            check(&two, InterfaceSystem::whole, y, free);
        }
        for slab in [two, slab(law, 1)] {
            let y = State::<2>::new(tau, slab.steady_log_state() + 0.1);
            check(&slab, InterfaceSystem::plane, y, &all);
        }
    }
}
