//! The friction laws: their formulas against one another, and their steady states against references of 20 and more digits.

use crate::common;
use common::{assert_close, data, number};
use proptest::prelude::*;
use twinslip::friction::{
    AnyLaw, Extremum, ExtremumKind, Formulas, Law, Parameters, critical_stiffness,
    critical_stiffness_maximum, steady_slope, steady_stress,
};
use twinslip::model::Loading;
use twinslip::model::scales::{Machine, Material};
use twinslip::number::{Jet, Real};

fn laws(parameters: Parameters) -> Vec<AnyLaw> {
    AnyLaw::NAMES
        .iter()
        .map(|name| AnyLaw::named(name, parameters).expect("a known name"))
        .collect()
}

fn parameters() -> impl Strategy<Value = Parameters> {
    (0.02..0.05, 0.3..3.0, 0.2..0.6, 1.0..1e4, 0.0..0.1).prop_map(|(a, beta, a_v, r, c)| {
        Parameters::new(a, a * beta, a_v, r, c).expect("in the domain")
    })
}

proptest! {
    #[test]
    fn slip_rate_inverts_stress(p in parameters(), ln_v in -12.0..12.0_f64, ln_psi in -16.0..0.0_f64) {
        for law in laws(p) {
            let (v, psi) = (ln_v.exp(), ln_psi.exp());
            let tau = law.stress(v, psi);
            let back = law.slip_rate(law.activation(tau), psi);
            // the condition number of the inversion is tau coth(tau)
            let tolerance = 1e-14 * (1.0 + tau.abs());
            prop_assert!((back / v - 1.0).abs() < tolerance, "{law:?}: {v:e} came back as {back:e}");
        }
    }

    #[test]
    fn steady_state_is_the_zero_of_the_evolution(p in parameters(), ln_v in -14.0..14.0_f64) {
        for law in laws(p) {
            let v = ln_v.exp();
            let psi = law.steady_state(v);
            // relative to the rate v psi at which slip renews the state
            prop_assert!((law.evolution(v, psi) / (v * psi)).abs() < 1e-14 * (1.0 + 1.0 / (p.healing_time * v)), "{law:?}");
        }
    }

    #[test]
    fn slope_vanishes_at_the_extrema_and_nowhere_else(p in parameters()) {
        for law in laws(p) {
            let extrema = Extremum::all(&law);
            for e in &extrema {
                let relative = e.slip_rate.uncertainty / e.slip_rate.value;
                prop_assert!(relative < 1e-5, "{law:?}: {e:?}");
            }
            // signs between the extrema alternate, starting with strengthening where there is a maximum
            let mut bounds = vec![1e-12];
            bounds.extend(extrema.iter().map(|e| e.slip_rate.value));
            bounds.push(1e14);
            if !extrema.is_empty() {
                for (i, pair) in bounds.windows(2).enumerate() {
                    let slope = steady_slope(&law, (pair[0] * pair[1]).sqrt());
                    prop_assert!(slope * if i % 2 == 0 { 1.0 } else { -1.0 } > 0.0, "{law:?} between {pair:?}");
                }
            }
        }
    }

    #[test]
    fn scales_convert_both_ways(p in parameters(), a in 0.02..0.05, sigma in 1e5..1e9, l in 1e-7..1e-3, v_star in 1e-9..1e-3, v_h in 1e-3..1e6, k in 1e-3..1e3) {
        let scales = twinslip::model::scales::Scales::new(a, l, v_star, sigma).expect("positive");
        let (back, units) = scales.material(&p).dimensionless().expect("valid");
        for (x, y) in [(back.beta, p.beta), (back.healing_time, p.healing_time), (back.residual_strength + 1.0, p.residual_strength + 1.0),
                       (units.stress, scales.stress), (units.time, scales.time), (units.stiffness, scales.stiffness)] {
            prop_assert!((x / y - 1.0).abs() < 1e-14);
        }
        // gamma0 = 2 exp(-a_v/a) magnifies rounding by a_v/a
        prop_assert!((back.gamma0 / p.gamma0 - 1.0).abs() < 1e-13);
        let loading = Loading::new(v_h, k).expect("positive");
        let again = scales.loading(&scales.machine(&loading)).expect("positive");
        prop_assert!((again.driving / v_h - 1.0).abs() < 1e-15 && (again.stiffness / k - 1.0).abs() < 1e-15);
    }
}

fn constant(name: &str) -> f64 {
    number(&data("steady_states.json")["constants"][name])
}

#[test]
fn spinodal_extrema_match_the_reference() {
    let law = Parameters::heslot_1994().spinodal();
    let [peak, trough] = Extremum::all(&law)[..] else {
        panic!("two extrema")
    };
    assert_eq!(
        (peak.kind, trough.kind),
        (ExtremumKind::Maximum, ExtremumKind::Minimum)
    );
    for (computed, name) in [
        (peak.slip_rate, "V_M"),
        (trough.slip_rate, "V_m"),
        (peak.stress, "tau_ss(V_M)"),
        (trough.stress, "tau_ss(V_m)"),
    ] {
        assert_close(computed.value, constant(name), 1e-14, name);
        assert!(
            computed.uncertainty < 1e-13 * computed.value,
            "{name}: {computed:?}"
        );
        // the reference has exact decimal parameters: rounding them to doubles moves it by a few units in the last place
        assert!(
            (computed.value - constant(name)).abs()
                <= computed.uncertainty + 4.0 * f64::EPSILON * computed.value
        );
    }
    assert_close(
        steady_stress(&law, 1.0),
        constant("tau_ss(1)"),
        1e-15,
        "tau_ss(1)",
    );
    assert_eq!(law.transition_rate(), Some(1000.0));
}

#[test]
fn higher_derivatives_match_the_reference() {
    let law = Parameters::heslot_1994().spinodal();
    for (at, second, third) in [
        ("V_M", "tau_ss2(V_M)", "tau_ss3(V_M)"),
        ("V_m", "tau_ss2(V_m)", "tau_ss3(V_m)"),
    ] {
        let v = Jet::<_, 1>::variable(
            Jet::<_, 1>::variable(Jet::<f64, 1>::variable(constant(at), 0), 0),
            0,
        );
        let stress = steady_stress(&law, v);
        assert_close(
            stress.gradient[0].gradient[0].value,
            constant(second),
            1e-12,
            second,
        );
        assert_close(
            stress.gradient[0].gradient[0].gradient[0],
            constant(third),
            1e-12,
            third,
        );
    }
}

#[test]
fn bounded_law_has_a_maximum_only() {
    let law = Parameters::heslot_1994().bounded();
    let [peak] = Extremum::all(&law)[..] else {
        panic!("one extremum")
    };
    assert_close(
        peak.slip_rate.value,
        constant("law6_V_M_over_Vstar"),
        1e-14,
        "V_M (7)",
    );
    assert_close(
        0.0349 * peak.stress.value,
        constant("law6_mu_ss(V_M)"),
        1e-14,
        "mu_ss(V_M)",
    );
    assert_eq!(critical_stiffness_maximum(&law).expect("no search"), None);
}

#[test]
fn critical_stiffness_matches_reference_and_closed_forms() {
    let p = Parameters::heslot_1994();
    let best = critical_stiffness_maximum(&p.spinodal())
        .expect("found")
        .expect("a maximum");
    assert_close(
        best.slip_rate.value,
        constant("max_k_c_V"),
        1e-7,
        "argmax k_c",
    );
    assert!((best.slip_rate.value - constant("max_k_c_V")).abs() <= best.slip_rate.uncertainty);
    assert_close(best.stiffness.value, constant("max_k_c"), 1e-14, "max k_c");
    assert!((best.stiffness.value - constant("max_k_c")).abs() <= best.stiffness.uncertainty);
    // (17): K_c = (b - a)/a for Dieterich-Ruina at every rate, and for the slip law, whose steady state and G_psi agree
    for law in [
        AnyLaw::DieterichRuina(p.dieterich_ruina()),
        AnyLaw::Slip(p.slip()),
    ] {
        for v in [1e-3, 1.0, 1e4] {
            assert_close(
                critical_stiffness(&law, v),
                constant("K_c_DR") * v / v,
                1e-13,
                "K_c (17)",
            );
        }
    }
}

#[test]
fn dieterich_ruina_steady_stress_matches_the_reference() {
    let law = Parameters::heslot_1994().dieterich_ruina();
    assert_close(
        steady_stress(&law, 1.0),
        constant("DR_tau_ss(1)"),
        1e-15,
        "tau_ss(1)",
    );
    assert_close(
        steady_stress(&law, 0.5),
        constant("DR_tau_ss(1/2)"),
        1e-15,
        "tau_ss(1/2)",
    );
    assert!(law.steady_extrema().is_empty());
}

#[test]
fn a_law_without_weakening_has_no_extrema() {
    for beta in [0.5, 1.0] {
        let p = Parameters::new(0.05, 0.05 * beta, 0.4, 100.0, 1e-3).expect("valid");
        for law in laws(p) {
            assert!(Extremum::all(&law).is_empty(), "{law:?}");
        }
    }
}

#[test]
fn material_of_heslot_gives_the_papers_numbers() {
    let (p, scales) = Material::heslot_1994(1e6).dimensionless().expect("valid");
    assert_close(p.healing_time, 100.0, 1e-15, "R");
    assert_close(p.beta, 489.0 / 349.0, 1e-15, "beta");
    let peak = Extremum::all(&p.bounded())[0].slip_rate.value * scales.slip_rate;
    assert_close(peak, constant("law6_V_M_m_per_s"), 1e-14, "V_M in m/s");
    let machine = Machine {
        driving: 2e-6,
        stiffness: 0.1 * scales.stiffness,
    };
    let loading = scales.loading(&machine).expect("valid");
    assert_close(loading.driving, 2.0, 1e-15, "V_H");
    assert_close(loading.stiffness, 0.1, 1e-15, "K");
}

#[test]
fn parameters_outside_their_domain_are_named() {
    for (made, name) in [
        (Parameters::new(0.0, 0.04, 0.3, 100.0, 0.0), "direct-effect"),
        (
            Parameters::new(0.03, -1.0, 0.3, 100.0, 0.0),
            "evolution-effect",
        ),
        (
            Parameters::new(0.03, 0.04, f64::NAN, 100.0, 0.0),
            "reference-friction",
        ),
        (
            Parameters::new(0.03, 0.04, 100.0, 100.0, 0.0),
            "reference-friction",
        ),
        (
            Parameters::new(0.03, 0.04, 0.3, f64::INFINITY, 0.0),
            "healing-time",
        ),
        (
            Parameters::new(0.03, 0.04, 0.3, 100.0, -1e-3),
            "residual-strength",
        ),
    ] {
        let error = made.expect_err(name);
        assert!(
            error.is_input() && error.to_string().starts_with(name),
            "{error}"
        );
    }
}

/// Slip backwards under negative stress: the laws with sinh are odd, the state sees |v|.
#[test]
fn sinh_laws_are_odd_in_the_stress() {
    let p = Parameters::heslot_1994();
    let laws = [
        AnyLaw::Spinodal(p.spinodal()),
        AnyLaw::Bounded(p.bounded()),
        AnyLaw::RegularisedAgeing(p.regularised_ageing()),
    ];
    for law in laws {
        let forward = law.slip_rate(law.activation(3.0), 0.2);
        let backward = law.slip_rate(law.activation(-3.0), 0.2);
        assert_eq!(forward, -backward);
        assert_eq!(law.evolution(forward, 0.2), law.evolution(backward, 0.2));
        assert_eq!(law.activation(0.0_f64).abs(), 0.0);
    }
    assert!(Real::asinh(-1e200_f64) < 0.0);
}

/// tau_ss(1e-3), the slip rate of the largest k_c and that k_c, for b = 10.
const STEEP: [f64; 3] = [
    1_298.743_026_402_031,
    0.187_783_936_135_283_4,
    285.423_599_073_890_4,
];

/// Of laws whose strength or stress leaves the range of doubles nothing comes out as no number, and what has a double is right:
/// values of mpmath at 60 digits.
#[test]
fn extreme_parameters_leave_no_nan() {
    let law = |b: f64, r: f64, c: f64| {
        AnyLaw::Spinodal(
            Parameters::new(0.0349, b, 0.369, r, c)
                .expect("valid")
                .spinodal(),
        )
    };
    for b in [0.0489, 0.5, 3.0, 10.0, 100.0, 1e6] {
        for r in [1e-200, 1e-3, 100.0, 1e150] {
            for c in [1e-300, 1e-20, 1e-3, 1e300] {
                let law = law(b, r, c);
                let what = format!("{law:?}");
                let known = |x: f64| assert!(!x.is_nan(), "{what}");
                for e in Extremum::all(&law) {
                    for x in [e.slip_rate, e.stress] {
                        known(x.value);
                        known(x.uncertainty);
                    }
                }
                let top =
                    critical_stiffness_maximum(&law).unwrap_or_else(|e| panic!("{what}: {e}"));
                for x in top.iter().flat_map(|top| [top.slip_rate, top.stiffness]) {
                    known(x.value);
                    known(x.uncertainty);
                }
                for v in [1e-300, 1e-3, 1.0, 1e6, 1e300] {
                    known(steady_stress(&law, v));
                    known(law.steady_state(v));
                }
            }
        }
    }
    let steep = law(10.0, 100.0, 1e-3);
    assert_close(steady_stress(&steep, 1e-3), STEEP[0], 1e-13, "b = 10");
    let top = critical_stiffness_maximum(&steep)
        .expect("found")
        .expect("there is one");
    let off = (top.stiffness.value - STEEP[2]).abs();
    // b/a is no double
    assert!(
        off <= top.stiffness.uncertainty + 1e-15 * STEEP[2],
        "{top:?}"
    );
    let off = (top.slip_rate.value - STEEP[1]).abs();
    assert!(
        off <= top.slip_rate.uncertainty + 1e-14 * STEEP[1],
        "{top:?}"
    );
}
