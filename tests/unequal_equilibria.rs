//! Steady states of interfaces that differ: against values of 28 digits, and their numbers against scans.

use crate::common;
use crate::unequal::second;
use common::{assert_close, data, number};
use proptest::prelude::*;
use serde_json::Value;
use twinslip::equilibrium::{
    Equilibrium, LawOfEach, Solver, Symmetry, Verdict, stability, steady_states,
    unequal_steady_states,
};
use twinslip::friction::{
    AnyLaw, InterfaceConstants, Law, Parameters, ScaledLaw, UnequalLaws, steady_stress,
};

fn spinodal(second: InterfaceConstants) -> UnequalLaws {
    let first = InterfaceConstants::heslot_1994();
    UnequalLaws::new("spinodal", [first, second], 0.0).expect("valid")
}

fn cases() -> Vec<(String, Value)> {
    let all = data("unequal.json");
    let cases = all["cases"].as_object().expect("cases");
    cases
        .iter()
        .map(|(name, case)| (name.clone(), case.clone()))
        .collect()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

/// A real number, or both parts of a complex one.
fn parts(value: &Value) -> (f64, f64) {
    match value {
        Value::Array(parts) => (number(&parts[0]), number(&parts[1])),
        _ => (number(value), 0.0),
    }
}

#[test]
fn states_are_those_of_the_references() {
    let mut seen = 0;
    for (name, case) in cases() {
        let laws = spinodal(second(&case["second"]));
        let stiffness = number(&case["K"]);
        let known = list(&case["equilibria"]);
        let mut drivings: Vec<f64> = known.iter().map(|one| number(&one["V_H"])).collect();
        drivings.dedup();
        for driving in drivings {
            let found = unequal_steady_states(&laws, driving).expect("solved");
            let at = known.iter().filter(|one| number(&one["V_H"]) == driving);
            let at: Vec<_> = at.collect();
            assert!(found.complete);
            assert_eq!(found.equilibria.len(), at.len(), "{name}, {driving}");
            let stresses = found.equilibria.iter().map(|one| one.stress.value);
            assert!(stresses.is_sorted_by(|a, b| a >= b));
            for exact in at {
                let v = number(&exact["v1"]);
                let near = |one: &&Equilibrium| (one.slip_rate[0] / v - 1.0).abs() < 1e-6;
                let state = found.equilibria.iter().find(near).expect("the state");
                check(
                    &laws,
                    state,
                    exact,
                    stiffness,
                    &format!("{name}, {driving}, {v}"),
                );
                seen += 1;
            }
        }
    }
    assert_eq!(seen, 20);
}

fn check(laws: &UnequalLaws, state: &Equilibrium, exact: &Value, stiffness: f64, what: &str) {
    let within = |made: f64, exact: f64, uncertainty: f64, of: &str| {
        assert_close(made, exact, 1e-12, &format!("{what}: {of}"));
        assert!(
            (made - exact).abs() <= uncertainty,
            "{what}, {of}: {made} {exact} {uncertainty:e}"
        );
        assert!(
            uncertainty <= 1e-12 * exact.abs().max(1e-3),
            "{what}, {of}: {uncertainty:e}"
        );
    };
    assert_eq!(state.symmetry, Symmetry::Asymmetric);
    let stress = state.stress;
    within(
        stress.value,
        number(&exact["stress"]),
        stress.uncertainty,
        "stress",
    );
    for (i, (rate, psi)) in [("v1", "psi1"), ("v2", "psi2")].into_iter().enumerate() {
        within(
            state.slip_rate[i],
            number(&exact[rate]),
            state.slip_rate_uncertainty()[i],
            rate,
        );
        within(
            state.state()[i],
            number(&exact[psi]),
            state.state_uncertainty()[i],
            psi,
        );
        let log = number(&exact[psi]).ln();
        let known = state.log_state_uncertainty()[i] + f64::EPSILON * log.abs();
        assert!(
            (state.log_state[i] - log).abs() <= known,
            "{what}: ln {psi}"
        );
    }
    assert!(
        state.residual(laws, number(&exact["V_H"])) < 1e-11,
        "{what}"
    );
    let made = stability(laws, state, stiffness).expect("K");
    let known = list(&exact["eigenvalues"]);
    assert_eq!(made.eigenvalues.len(), known.len(), "{what}");
    for known in known {
        let (re, im) = parts(known);
        let off = |i: &usize| {
            let z = made.eigenvalues[*i];
            (z.re - re).hypot(z.im - im)
        };
        let nearest = (0..3)
            .min_by(|i, j| off(i).total_cmp(&off(j)))
            .expect("three");
        let size = re.hypot(im);
        assert!(
            off(&nearest) <= 1e-11 * size,
            "{what}: {:?} {known}",
            made.eigenvalues
        );
        assert!(
            off(&nearest) <= made.uncertainty[nearest] + f64::EPSILON * size,
            "{what}: {known}"
        );
        assert!(
            made.uncertainty[nearest] <= 1e-9 * size,
            "{what}: {:?}",
            made.uncertainty
        );
    }
    let grows = known.iter().any(|known| parts(known).0 > 0.0);
    let verdict = if grows {
        Verdict::Unstable
    } else {
        Verdict::Stable
    };
    assert_eq!(made.verdict, verdict, "{what}");
}

#[test]
fn folds_part_one_number_from_another() {
    let mut seen = 0;
    for (_, case) in cases() {
        let laws = spinodal(second(&case["second"]));
        for fold in list(&case["folds"]) {
            let driving = number(&fold["V_H"]);
            let count = |factor: f64| {
                let found = unequal_steady_states(&laws, driving * factor).expect("solved");
                assert!(found.complete, "{driving} {factor}");
                found.equilibria.len()
            };
            for by in [1e-3, 1e-8, 1e-11] {
                let (less, more) = (count(1.0 - by), count(1.0 + by));
                assert_eq!(less.abs_diff(more), 2, "{driving}, {by:e}: {less} {more}");
            }
            seen += 1;
        }
    }
    assert_eq!(seen, 8);
}

#[test]
fn hopf_points_part_one_verdict_from_another() {
    for (_, case) in cases() {
        let laws = spinodal(second(&case["second"]));
        let stiffness = number(&case["K"]);
        for hopf in list(&case["hopf"]) {
            let (driving, v) = (number(&hopf["V_H"]), number(&hopf["v1"]));
            let pair = |factor: f64| {
                let found = unequal_steady_states(&laws, driving * factor).expect("solved");
                let off = |one: &&Equilibrium| (one.slip_rate[0] / v).ln().abs();
                let state = { found.equilibria.iter() }.min_by(|a, b| off(a).total_cmp(&off(b)));
                let made = stability(&laws, state.expect("one"), stiffness).expect("K");
                *made
                    .eigenvalues
                    .iter()
                    .find(|z| z.im > 0.0)
                    .expect("a pair")
            };
            let (less, more) = (pair(1.0 - 1e-6), pair(1.0 + 1e-6));
            assert!(less.re * more.re < 0.0, "{driving}: {less} {more}");
            assert_close(pair(1.0).im, number(&hopf["omega"]), 1e-11, "omega");
        }
    }
}

/// As the difference goes to zero there are as many as of equal interfaces, where these are counted twice when they are asymmetric.
#[test]
fn small_differences_leave_the_numbers() {
    let base = InterfaceConstants::heslot_1994();
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let [low, high] = law.steady_extrema()[..] else {
        panic!("two extrema");
    };
    for difference in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        let differ: [fn(&mut InterfaceConstants, f64); 4] = [
            |one, by| one.residual_strength *= 1.0 + by,
            |one, by| one.slip_length *= 1.0 + by,
            |one, by| one.normal_stress *= 1.0 + by,
            |one, by| one.direct_effect *= 1.0 - by,
        ];
        for (i, differ) in differ.into_iter().enumerate() {
            let mut second = base;
            differ(&mut second, difference);
            let laws = spinodal(second);
            // Folds stand off the pitchforks by the difference to the power of 2/3, times some.
            let apart = 40.0 * difference.powf(2.0 / 3.0);
            if apart > 0.5 {
                continue;
            }
            for pitchfork in [2.0 * low, 2.0 * high] {
                for factor in [1.0 - apart, 1.0 + apart] {
                    let driving = pitchfork * factor;
                    let equal = steady_states(&law, driving, 2, Solver::Newton).expect("solved");
                    assert!(equal.complete);
                    let asymmetric = |one: &&Equilibrium| one.symmetry == Symmetry::Asymmetric;
                    let pairs = equal.equilibria.iter().filter(asymmetric).count();
                    let found = unequal_steady_states(&laws, driving).expect("solved");
                    let what = format!("{i}: {difference:e} at {driving}");
                    assert!(found.complete, "{what}");
                    assert_eq!(found.equilibria.len(), 1 + 2 * pairs, "{what}");
                }
            }
        }
    }
}

/// Sign changes of tau_1ss(v) - tau_2ss(V_H - v) on a fine grid of v, logarithmic towards both ends.
fn scanned(laws: &UnequalLaws, driving: f64) -> usize {
    let [first, second] = laws.laws();
    let sign = |slow: &ScaledLaw, fast: &ScaledLaw, s: f64| {
        steady_stress(slow, s) > steady_stress(fast, driving - s)
    };
    let part = |i: i32| 0.5 * driving * (-0.01 * f64::from(i)).exp();
    let mut signs: Vec<bool> = (0..8000)
        .rev()
        .map(|i| sign(first, second, part(i)))
        .collect();
    signs.extend((1..8000).map(|i| !sign(second, first, part(i))));
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

/// Interfaces that differ by some per cent in everything, of any law.
fn unlike() -> impl Strategy<Value = UnequalLaws> {
    (
        0..AnyLaw::NAMES.len(),
        (0.3..3.0, 0.0..8.0_f64, -6.0..-1.0_f64),
        prop::array::uniform7(-1.0..1.0_f64),
        -12.0..-1.0_f64,
        prop_oneof![Just(0.0), (-6.0..0.0_f64).prop_map(|log| 10f64.powf(log))],
    )
        .prop_map(|(law, (beta, ln_r, log_c), parts, log_size, damping)| {
            let first = InterfaceConstants {
                healing_time: ln_r.exp(),
                residual_strength: 10f64.powf(log_c),
                evolution_effect: 0.0349 * beta,
                ..InterfaceConstants::heslot_1994()
            };
            let by = |i: usize| 1.0 + 2.0 * parts[i] * 10f64.powf(log_size);
            let second = InterfaceConstants {
                healing_time: first.healing_time * by(0),
                residual_strength: first.residual_strength * by(1),
                direct_effect: first.direct_effect * by(2),
                evolution_effect: first.evolution_effect * by(3),
                reference_friction: first.reference_friction * by(4),
                slip_length: by(5),
                normal_stress: by(6),
            };
            UnequalLaws::new(AnyLaw::NAMES[law], [first, second], damping).expect("valid")
        })
}

/// At the end of a bracket rounding hid the sign that is certain there.
#[test]
fn a_state_at_the_end_of_its_bracket_is_found() {
    let first = InterfaceConstants {
        healing_time: 31.67181409757817,
        residual_strength: 0.1,
        evolution_effect: 0.09880792288857881,
        ..InterfaceConstants::heslot_1994()
    };
    let second = InterfaceConstants {
        direct_effect: 0.0349000000008076,
        reference_friction: 0.3689999999878115,
        slip_length: 0.999999999980105,
        ..first
    };
    let laws = UnequalLaws::new("bounded", [first, second], 0.057990186177887565);
    let laws = laws.expect("valid");
    let driving = 10f64.powf(4.485635219161688);
    let found = unequal_steady_states(&laws, driving).expect("solved");
    assert!(!found.equilibria.is_empty());
    for state in &found.equilibria {
        assert!(state.residual(&laws, driving) < 1e-9);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn nothing_is_missed(laws in unlike(), log_v in -5.0..6.0_f64, log_k in -3.0..2.0_f64) {
        let (driving, k) = (10f64.powf(log_v), 10f64.powf(log_k));
        let found = unequal_steady_states(&laws, driving).expect("solved");
        if found.complete {
            let scan = scanned(&laws, driving);
            // States that are slower than the scan goes, and pairs between two of its points.
            let slowest = 0.5 * driving * (-79.98_f64).exp();
            let seen = |one: &&Equilibrium| one.slip_rate.iter().all(|&v| v > slowest);
            let count = found.equilibria.iter().filter(seen).count();
            prop_assert!(count >= scan, "{count} states found, a scan shows {scan}");
            prop_assert!((count - scan).is_multiple_of(2), "{count} states found, a scan shows {scan}");
        }
        for state in &found.equilibria {
            prop_assert!(state.residual(&laws, driving) < 1e-9);
            prop_assert!(state.slip_rate.iter().all(|&v| v > 0.0));
            let stresses = [0, 1].map(|i| steady_stress(laws.law(i), state.slip_rate[i]));
            let apart = (stresses[0] - stresses[1]).abs();
            prop_assert!(apart <= 1e-9 * (1.0 + stresses[0].abs()), "{stresses:?}");
            let at = stability(&laws, state, k).expect("K is valid");
            let growing = at.eigenvalues[0].re > 0.0;
            prop_assert!(at.verdict == Verdict::Undecided || growing == (at.verdict == Verdict::Unstable));
        }
    }

    #[test]
    fn budgets_hold_for_inputs_that_were_rounded(laws in unlike(), log_v in -5.0..6.0_f64, parts in prop::array::uniform7(-1.0..1.0_f64)) {
        let driving = 10f64.powf(log_v);
        let found = unequal_steady_states(&laws, driving).expect("solved");
        // The next doubles of the second interface's constants.
        let mut second: [f64; 7] = laws.constants()[1].into();
        for (constant, part) in second.iter_mut().zip(parts) {
            *constant = if part > 0.0 { constant.next_up() } else { constant.next_down() };
        }
        let other = [laws.constants()[0], second.into()];
        let other = UnequalLaws::new(laws.name(), other, laws.damping()).expect("valid");
        let moved = unequal_steady_states(&other, driving).expect("solved");
        if found.complete && moved.complete && found.equilibria.len() == moved.equilibria.len() {
            let is_within = |one: &Equilibrium, two: &Equilibrium| {
                let rates = (0..2).all(|i| {
                    let apart = (one.slip_rate[i] - two.slip_rate[i]).abs();
                    apart <= one.slip_rate_uncertainty()[i] + two.slip_rate_uncertainty()[i]
                });
                let apart = (one.stress.value - two.stress.value).abs();
                rates && apart <= one.stress.uncertainty + two.stress.uncertainty
            };
            // In any order: of interfaces that are all but equal two states have the same stress to all digits.
            for [all, others] in [[&found, &moved], [&moved, &found]] {
                for one in &all.equilibria {
                    let same = others.equilibria.iter().any(|two| is_within(one, two));
                    prop_assert!(same, "{one:?} {:?}", others.equilibria);
                }
            }
        }
    }
}

#[test]
fn where_the_number_is_not_certain_it_is_said() {
    // Equal interfaces at their pitchfork.
    let base = InterfaceConstants::heslot_1994();
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let pitchfork = 2.0 * law.steady_extrema()[0];
    let found = unequal_steady_states(&spinodal(base), pitchfork).expect("solved");
    assert!(!found.complete);
    let refused = unequal_steady_states(&spinodal(base), 0.0).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "driving is 0, but must be positive and finite"
    );
}
