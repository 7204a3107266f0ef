//! Two interfaces that differ: their equations against the formulas written out, derivatives in every parameter, and orbits against values of
//! 27 digits.

use crate::common;
use common::{assert_close, data, number};
use proptest::prelude::*;
use serde_json::Value;
use twinslip::Error;
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::field::{Parametrised, State, VectorField};
use twinslip::friction::{
    AnyLaw, Formulas, InterfaceConstants, Law, Parameters, UnequalLaws, steady_stress,
};
use twinslip::integrate::{AnyField, Choice, Integrator, MAX_STEPS, Taylor, Tolerances};
use twinslip::model::{Driven, Loading, UnequalInterfaces, two_interfaces};
use twinslip::number::Uncertain;
use twinslip::orbit::{
    InitialGuess, Orbit, OrbitAccuracy, OverInterfaces, ParametrisedField, crosscheck_of,
    find_unequal,
};

/// The second interface of the references, whose friction is written with (1 + R) psi whatever its slip length is: with c + (1 + R/l) psi,
/// which is s times that at c/s, and its reference friction at V* moved by b ln s, it is the same interface.
pub fn second(value: &Value) -> InterfaceConstants {
    let mut second = InterfaceConstants::heslot_1994();
    for (name, value) in value.as_object().expect("constants") {
        let value = number(value);
        match name.as_str() {
            "c" => second.residual_strength = value,
            "l" => second.slip_length = value,
            "b" => second.evolution_effect = value,
            other => panic!("{other}"),
        }
    }
    let healing_time = second.healing_time;
    let s = (1.0 + healing_time / second.slip_length) / (1.0 + healing_time);
    second.residual_strength *= s;
    second.reference_friction -= second.evolution_effect * s.ln();
    second
}

/// The option that sets the constants of the second interface, where they are not those of the paper.
pub fn set(second: &InterfaceConstants) -> String {
    let values = |of: InterfaceConstants| -> [f64; InterfaceConstants::NAMES.len()] { of.into() };
    let both = values(*second)
        .into_iter()
        .zip(values(InterfaceConstants::heslot_1994()));
    let words: Vec<String> = InterfaceConstants::NAMES
        .iter()
        .zip(both)
        .filter(|(_, (value, usual))| value != usual)
        .map(|(name, (value, _))| format!("{name}_2={value:?}"))
        .collect();
    format!("--set {}", words.join(","))
}

/// Interfaces that differ in everything.
fn unlike(law: &str, damping: f64) -> UnequalInterfaces {
    let first = InterfaceConstants {
        healing_time: 80.0,
        residual_strength: 2e-3,
        direct_effect: 0.03,
        evolution_effect: 0.05,
        reference_friction: 0.35,
        ..InterfaceConstants::heslot_1994()
    };
    let second = InterfaceConstants {
        slip_length: 1.3,
        normal_stress: 0.85,
        ..InterfaceConstants::heslot_1994()
    };
    UnequalInterfaces {
        laws: UnequalLaws::new(law, [first, second], damping).expect("valid"),
        loading: Loading::new(10.0, 0.14).expect("positive"),
    }
}

/// The slip rate and dpsi/dt of an interface as the formulas are written.
fn by_hand(
    law: &str,
    (first, own): (&InterfaceConstants, &InterfaceConstants),
    tau: f64,
    psi: f64,
) -> [f64; 2] {
    let InterfaceConstants {
        healing_time: r,
        residual_strength: c,
        direct_effect: a,
        evolution_effect: b,
        reference_friction: a_v,
        slip_length: l,
        normal_stress: n,
    } = *own;
    let stress = first.direct_effect / (n * a) * tau;
    let factor = (-a_v / a).exp();
    let ageing = |v: f64| 1.0 - v.abs() / l * psi;
    let bounded = |v: f64| (1.0 - psi) / r - v.abs() / l * psi;
    let sinh = 2.0 * factor * stress.sinh();
    // The state of an ageing law in units of its own, l times those of the first.
    let exponential = factor * stress.exp() * (psi / l).powf(-b / a);
    match law {
        "spinodal" => {
            let v = sinh / (c + (1.0 + r / l) * psi).powf(b / a);
            [v, bounded(v)]
        }
        "bounded" => {
            let v = sinh / ((1.0 + r / l) * psi).powf(b / a);
            [v, bounded(v)]
        }
        "regularised-ageing" => {
            let v = sinh * (psi / l).powf(-b / a);
            [v, ageing(v)]
        }
        "dieterich-ruina" => [exponential, ageing(exponential)],
        "slip" => {
            let x = exponential / l * psi;
            [exponential, -x * x.ln()]
        }
        other => panic!("{other}"),
    }
}

#[test]
fn rates_are_those_of_the_formulas() {
    let y = State::<3>::new(9.7, -1.2, -0.4);
    for law in AnyLaw::NAMES {
        for damping in [0.0, 0.3] {
            let field = unlike(law, damping);
            let constants = field.laws.constants();
            let v = field.slip_rates(&y);
            let f = field.f(&y);
            for i in 0..2 {
                let psi = y[1 + i].exp();
                let tau = y[0] - damping * v[i];
                let [rate, evolution] = by_hand(law, (&constants[0], &constants[i]), tau, psi);
                let what = format!("{law}, {damping}, interface {}", i + 1);
                assert_close(v[i], rate, 1e-12 * (1.0 + damping * v[i]), &what);
                assert_close(
                    f[1 + i],
                    evolution / psi,
                    1e-11 * (1.0 + damping * v[i]),
                    &what,
                );
            }
            assert_close(f[0], 0.14 * (10.0 - v[0] - v[1]), 1e-13, law);
        }
    }
}

/// An interface slides at V* under its own reference friction, whatever its slip length is.
#[test]
fn friction_at_the_reference_rate_does_not_depend_on_the_slip_length() {
    let first = InterfaceConstants::heslot_1994();
    for law in AnyLaw::NAMES {
        for slip_length in [1e-3, 0.5, 3.0, 1e3] {
            let second = InterfaceConstants {
                slip_length,
                ..first
            };
            let laws = UnequalLaws::new(law, [first, second], 0.0).expect("valid");
            let [one, other] = laws.laws();
            let [one, other] = [one, other].map(|law| steady_stress(law, 1.0));
            // a_v/a and b/a are some 10 and 1.4, and known to their rounding.
            assert_close(other, one, 1e-14, &format!("{law}, {slip_length}"));
        }
    }
}

#[test]
fn equal_ones_are_those_that_have_one_law() {
    let y = State::<3>::new(9.7, -1.2, -0.4);
    let (a, b) = (
        State::<3>::new(0.3, -1.0, 0.2),
        State::<3>::new(-0.5, 0.1, 2.0),
    );
    let loading = Loading::new(10.0, 0.14).unwrap();
    let same = InterfaceConstants::heslot_1994();
    for law in AnyLaw::NAMES {
        for damping in [0.0, 0.02] {
            let parameters = Parameters::heslot_1994().damped(damping).unwrap();
            let one = two_interfaces(AnyLaw::named(law, parameters).unwrap(), loading);
            let laws = UnequalLaws::new(law, [same; 2], damping).unwrap();
            let two = UnequalInterfaces { laws, loading };
            assert_eq!(one.slip_rates(&y), two.slip_rates(&y), "{law}");
            assert!((one.f(&y) - two.f(&y)).amax() <= 1e-14 * one.f(&y).amax());
            let (j, k) = (one.jacobian(&y), two.jacobian(&y));
            assert!((j - k).amax() <= 1e-14 * j.amax(), "{law}: {j} {k}");
            let (d, e) = (
                one.second_derivative(&y, &a, &b),
                two.second_derivative(&y, &a, &b),
            );
            assert!((d - e).amax() <= 1e-13 * d.amax(), "{law}: {d} {e}");
            assert_eq!(one.lasting(), two.lasting());
        }
    }
}

#[test]
fn jacobians_are_the_derivatives_of_the_rates() {
    let y = State::<3>::new(9.7, -1.2, -0.4);
    let (u, v) = (
        State::<3>::new(0.3, -1.0, 0.2),
        State::<3>::new(-0.5, 0.1, 2.0),
    );
    const STEP: f64 = 1e-6;
    for law in AnyLaw::NAMES {
        for damping in [0.0, 0.02] {
            let field = unlike(law, damping);
            let slope = (field.f(&(y + u * STEP)) - field.f(&(y - u * STEP))) / (2.0 * STEP);
            let made = field.jacobian(&y) * u;
            assert!(
                (slope - made).amax() < 1e-8 * made.amax(),
                "{law}: {slope} {made}"
            );
            let slope = (field.jacobian(&(y + v * STEP)) - field.jacobian(&(y - v * STEP))) * u
                / (2.0 * STEP);
            let made = field.second_derivative(&y, &u, &v);
            assert!(
                (slope - made).amax() < 1e-7 * made.amax(),
                "{law}: {slope} {made}"
            );
        }
    }
}

#[test]
fn names_are_those_of_what_a_law_has() {
    let names = |law, damping| unlike(law, damping).names().to_vec();
    assert_eq!(names("spinodal", 0.1).len(), 24);
    assert!(!names("spinodal", 0.0).contains(&"damping"));
    assert!(!names("bounded", 0.1).contains(&"residual_strength_2"));
    assert!(names("bounded", 0.1).contains(&"healing_time_1"));
    assert!(!names("slip", 0.1).contains(&"healing_time"));
    let two = unlike("spinodal", 0.0);
    assert_eq!(two.parameter("slip_length_2"), Ok(1.3));
    assert_eq!(
        two.with("healing_time", 90.0)
            .unwrap()
            .parameter("healing_time"),
        Ok(90.0)
    );
    let twofold = two.parameter("healing_time").unwrap_err().to_string();
    assert_eq!(
        twofold,
        "healing_time is 80 and 100, but must be asked for as healing_time_1 or healing_time_2, as the interfaces differ in it"
    );
    let unknown = two.with("slip_length_3", 2.0).unwrap_err().to_string();
    assert!(unknown.contains("slip_length_2"), "{unknown}");
    for (name, value) in [
        ("residual_strength_2", -1.0),
        ("normal_stress_2", 0.0),
        ("direct_effect_1", f64::NAN),
    ] {
        let refused = two.with(name, value).unwrap_err();
        assert!(
            matches!(&refused, Error::Parameter { name: told, .. } if told == name),
            "{refused}"
        );
    }
}

fn apart(made: &[f64; 3], exact: &[f64; 3]) -> f64 {
    let (made, exact) = (State::from(*made), State::from(*exact));
    (made - exact).amax() / exact.amax()
}

/// The derivative of a function at 0 by differences of fourth order.
fn difference_quotient<const N: usize>(step: f64, mut of: impl FnMut(f64) -> State<N>) -> State<N> {
    let mut across = |step: f64| of(step) - of(-step);
    (across(step) * 8.0 - across(2.0 * step)) / (12.0 * step)
}

/// All derivatives of a flow: in 31 digits against differences, and by the methods against these.
fn check_derivatives(two: &UnequalInterfaces, y: State<3>) {
    let span = (0.0, 0.05);
    let mut reference = Taylor::reference(MAX_STEPS).unwrap();
    let names = two.names();
    let free: Vec<usize> = (0..names.len()).collect();
    // Two at a time, as continuation asks for them.
    let mut exact = reference.derivatives(two, span, &y, &[]).unwrap().1;
    for pair in free.chunks(2) {
        let (_, made) = reference.derivatives(two, span, &y, pair).unwrap();
        exact.parameters.extend(made.parameters);
    }
    for ((&name, exact), &at) in names.iter().zip(&exact.parameters).zip(&free) {
        // Both move together where there is no index, each from its own value.
        let of_both = [format!("{name}_1"), format!("{name}_2")];
        let moved = |change: f64| match two.parameter(name) {
            Ok(value) => two.with(name, value + change).unwrap(),
            Err(_) => of_both.iter().fold(*two, |two, name| {
                let value = two.parameter(name).unwrap();
                two.with(name, value + change).unwrap()
            }),
        };
        let step = 1e-3
            * two
                .parameter(name)
                .or_else(|_| two.parameter(&of_both[0]))
                .unwrap();
        let slope = difference_quotient(step, |change| {
            reference.flow(&moved(change), span, &y, None).unwrap()
        });
        let error = apart(&slope.into(), exact);
        assert!(error < 1e-6, "{name}: {error:e}");
        let slope = difference_quotient(step, |change| moved(change).f(&y));
        let made = two.parameter_derivative(&y, at);
        assert!(
            (slope - made).amax() <= 1e-6 * made.amax(),
            "{name}: {slope} {made}"
        );
    }
    let mut taylor = Taylor::new(Tolerances::equal(1e-14).unwrap(), MAX_STEPS).unwrap();
    let several = [free[0], free[5], free[3], free[4]];
    for free in free.windows(2).chain([&several[..]]) {
        let (_, made) = taylor.derivatives(two, span, &y, free).unwrap();
        for (made, &place) in made.parameters.iter().zip(free) {
            let error = apart(made, &exact.parameters[place]);
            assert!(error < 1e-11, "{}: {error:e}", names[place]);
        }
    }
    #[cfg(feature = "sundials")]
    {
        use twinslip::integrate::CvodeIntegrator;
        use twinslip::sundials::MultistepMethod;
        let tolerances = Tolerances::equal(1e-11).unwrap();
        let mut cvode = CvodeIntegrator::new(MultistepMethod::Bdf, tolerances, MAX_STEPS).unwrap();
        let (_, tangent, made) = cvode.derivatives(two, span, &y, &free).unwrap();
        for ((made, exact), name) in made.into_iter().zip(&exact.parameters).zip(names) {
            let error = apart(&made.into(), exact);
            assert!(error < 1e-6, "{name}, sensitivities: {error:e}");
        }
        for (j, exact) in exact.start.iter().enumerate() {
            let exact = State::<3>::from(*exact);
            let error = (tangent.column(j) - exact).amax() / (1.0 + exact.amax());
            assert!(error < 1e-7, "column {j}: {error:e}");
        }
    }
}

#[test]
fn flows_are_differentiated_in_every_parameter() {
    check_derivatives(&unlike("spinodal", 0.0), State::<3>::new(9.7, -5.0, -4.0));
    check_derivatives(&unlike("spinodal", 0.02), State::<3>::new(9.7, -5.0, -4.0));
    check_derivatives(
        &unlike("regularised-ageing", 0.02),
        State::<3>::new(11.0, -0.5, 0.3),
    );
    check_derivatives(&unlike("slip", 0.0), State::<3>::new(11.0, -0.5, 0.3));
}

#[test]
fn derivatives_of_the_jacobian_in_parameters() {
    let two = unlike("spinodal", 0.02);
    let y = State::<3>::new(9.7, -5.0, -4.0);
    let names = two.names();
    for (place, name) in names.iter().enumerate() {
        let Ok(value) = two.parameter(name) else {
            continue;
        };
        let step = 1e-5 * value;
        let at = |change: f64| two.with(name, value + change).unwrap().jacobian(&y);
        let slope = (at(step) - at(-step)) / (2.0 * step);
        let made = two.parameter_jacobian(&y, place);
        assert!(
            (slope - made).amax() <= 1e-6 * made.amax(),
            "{name}: {slope} {made}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn series_go_where_the_equations_do(
        law in 0..AnyLaw::NAMES.len(),
        damped in any::<bool>(),
        factors in prop::array::uniform7(0.8..1.25_f64),
        (tau, first, second) in (8.0..11.0_f64, -3.0..-0.1_f64, -3.0..-0.1_f64),
    ) {
        let base = InterfaceConstants::heslot_1994();
        let [a, b, a_v, c, r, l, n] = factors;
        let other = InterfaceConstants {
            healing_time: base.healing_time * r,
            residual_strength: base.residual_strength * c,
            direct_effect: base.direct_effect * a,
            evolution_effect: base.evolution_effect * b,
            reference_friction: base.reference_friction * a_v,
            slip_length: l,
            normal_stress: n,
        };
        let laws = UnequalLaws::new(AnyLaw::NAMES[law], [base, other], if damped { 0.05 } else { 0.0 }).unwrap();
        let two = UnequalInterfaces { laws, loading: Loading::new(1.0, 0.2).unwrap() };
        let y = State::<3>::new(tau, first, second);
        // Times in which the state follows.
        let rate = two.f(&y).amax();
        let span = (0.0, 0.3 / rate.max(0.1));
        let mut taylor = Taylor::new(Tolerances::equal(1e-13).unwrap(), MAX_STEPS).unwrap();
        let end = taylor.flow(&two, span, &y, None).unwrap();
        let mut reference = Taylor::reference(MAX_STEPS).unwrap();
        let exact = reference.flow(&two, span, &y, None).unwrap();
        prop_assert!((end - exact).amax() < 1e-11, "{end} {exact}");
        let tolerances = Tolerances::equal(1e-11).unwrap();
        let mut rosenbrock = twinslip::integrate::Choice::named("rodas5p").unwrap().integrator::<3>(tolerances, MAX_STEPS).unwrap();
        let unlike = rosenbrock.flow(&two, span, &y, None).unwrap();
        prop_assert!((unlike - exact).amax() < 1e-7, "{unlike} {exact}");
    }
}

#[test]
fn fields_over_two_parameters() {
    let two = unlike("spinodal", 0.0);
    let over = OverInterfaces::new(&two, ["driving", "residual_strength_2"]).unwrap();
    let at = [3.0_f64.ln(), 2e-3_f64.ln()];
    let there = over.at(at).unwrap();
    assert_close(there.loading.driving, 3.0, 1e-15, "V_H");
    assert_close(
        there.parameter("residual_strength_2").unwrap(),
        2e-3,
        1e-14,
        "c_2",
    );
    let field = over.field(at);
    let names = field.parameter_names();
    assert_eq!(
        over.plane().map(|place| names[place]),
        ["driving", "residual_strength_2"]
    );
    let refused = |names| OverInterfaces::new(&two, names).unwrap_err().to_string();
    assert!(refused(["driving", "residual_strength_3"]).contains("residual_strength_2"));
    assert!(refused(["driving", "driving"]).contains("different"));
    assert!(refused(["driving", "healing_time"]).contains("healing_time_1"));
}

/// What a law has beside its formulas, in the units of the first interface.
#[test]
fn scaled_laws_are_laws() {
    let two = unlike("spinodal", 0.02);
    for law in two.laws.laws() {
        for extremum in law.steady_extrema() {
            let slope = twinslip::friction::steady_log_slope(law, extremum);
            assert!(slope.abs() < 1e-12, "{slope:e}");
        }
        assert_close(law.damping(), 0.02, 1e-15, "damping");
        let (v, psi) = (0.7, 0.3);
        let back = law.slip_rate(law.activation(law.stress(v, psi)), psi);
        assert_close(back, v, 1e-13, "slip rate");
    }
}

#[test]
fn orbits_are_those_of_the_references() {
    let all = data("unequal.json");
    let orbits = all["orbits_K0_14_VH10"].as_object().expect("orbits");
    assert_eq!(orbits.len(), 3);
    for (name, exact) in orbits {
        let interfaces = exact["interfaces"].as_array().expect("two");
        let constants = [second(&interfaces[0]), second(&interfaces[1])];
        let two = UnequalInterfaces {
            laws: UnequalLaws::new("spinodal", constants, 0.0).expect("valid"),
            loading: Loading::new(10.0, 0.14).expect("positive"),
        };
        let psi = |i: usize| number(&exact["start"]["psi"][i]).ln();
        let period = number(&exact["period"]);
        let begin = InitialGuess::At {
            start: (number(&exact["start"]["tau"]), [psi(0), psi(1)]),
            period: Some(0.99 * period),
        };
        let accuracy = OrbitAccuracy::of(Choice::Taylor);
        let orbit = find_unequal(&two, begin, &accuracy).expect("found").orbit;
        assert_eq!(orbit.symmetry, Symmetry::Asymmetric);
        assert_eq!(orbit.verdict(), Verdict::Stable);
        let holds = |made: Uncertain, exact: f64, tolerance: f64, of: &str| {
            assert!(
                (made.value - exact).abs() <= tolerance,
                "{name}, {of}: {made:?} {exact}"
            );
            assert!(
                (made.value - exact).abs() <= made.uncertainty,
                "{name}, {of}: {made:?} {exact}"
            );
        };
        holds(orbit.period, period, 1e-10 * period, "period");
        for (i, known) in ["stress_min", "stress_max"].into_iter().enumerate() {
            let made = [orbit.stress_min, orbit.stress_max][i];
            holds(made, number(&exact[known]), 1e-10, known);
        }
        let peaks = [0, 1].map(|i| number(&exact["peak_slip_rate"][i]));
        assert_close(orbit.slip_rate_max, peaks[0].max(peaks[1]), 1e-9, name);
        for (i, multiplier) in orbit.floquet.multipliers.iter().enumerate() {
            let known = number(&exact["ln_abs_multipliers_reduced"][i]);
            holds(multiplier.ln_abs, known, 1e-8, "ln |mu|");
        }
        // Found from no start, and by another method.
        let anywhere = find_unequal(&two, InitialGuess::Anywhere, &accuracy).expect("found");
        let mut met = [&anywhere.orbit].into_iter().chain(&anywhere.others);
        let near = |one: &Orbit| (one.period.value / period - 1.0).abs() < 1e-10;
        assert!(met.any(near), "{name}: {:?}", anywhere.orbit.period);
        let second = OrbitAccuracy {
            checked: false,
            ..OrbitAccuracy::of(Choice::named("rodas5p").expect("a method"))
        };
        let field = AnyField::of::<3>(&two);
        let checked = crosscheck_of(&field, &orbit, &second).expect("again");
        assert!(
            checked.period_difference.abs() < 1e-8 * period,
            "{name}: {checked:?}"
        );
    }
}
