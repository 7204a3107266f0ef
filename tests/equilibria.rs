//! Steady states and eigenvalues against references of 20 and more digits.

use crate::common;
use common::{assert_close, complex, data, number, relative};
use nalgebra::Complex;
use twinslip::equilibrium::{Equilibrium, Solver, Symmetry, Verdict, stability, steady_states};
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::model::{Loading, two_interfaces};

const SOLVERS: &[Solver] = &[
    #[cfg(feature = "sundials")]
    Solver::Kinsol,
    Solver::Newton,
];

fn spinodal() -> AnyLaw {
    AnyLaw::Spinodal(Parameters::heslot_1994().spinodal())
}

fn asymmetric(law: &AnyLaw, driving: f64, solver: Solver) -> Vec<Equilibrium> {
    let found =
        steady_states(law, driving, 2, solver).unwrap_or_else(|e| panic!("V_H = {driving}: {e}"));
    assert!(
        found.complete,
        "V_H = {driving}: the number of steady states is uncertain"
    );
    let mut states = found.equilibria;
    states.retain(|e| e.symmetry == Symmetry::Asymmetric);
    states.sort_by(|a, b| a.slip_rate[0].total_cmp(&b.slip_rate[0]));
    states
}

/// Over nine decades, and within 1e-6, 1e-9 and 1e-13 of both pitchforks and of the fold, on both sides.
#[test]
fn every_asymmetric_state_is_found_and_no_other() {
    let reference = data("steady_states_f64.json");
    let special = ["V_M", "V_m", "V_sn"]
        .map(|name| number(&reference[name]) * if name == "V_sn" { 1.0 } else { 2.0 });
    for &solver in SOLVERS {
        for point in reference["points"].as_array().expect("points") {
            let driving = number(&point["V_H"]);
            let expected = point["asymmetric"].as_array().expect("solutions");
            let found = asymmetric(&spinodal(), driving, solver);
            assert_eq!(found.len(), expected.len(), "{solver:?}, V_H = {driving}");
            // closer to a bifurcation than this the last digit of V_H alone moves the rates by more than 1e-12
            let distance = special
                .iter()
                .map(|&s| relative(driving, s))
                .fold(f64::INFINITY, f64::min);
            for (state, truth) in found.iter().zip(expected) {
                let what = format!("{solver:?}, V_H = {driving}");
                let rates = [number(&truth["V_slow"]), number(&truth["V_fast"])];
                if distance > 0.99e-6 {
                    for (computed, rate) in state.slip_rate.iter().zip(rates) {
                        assert_close(*computed, rate, 1e-12, &what);
                    }
                    for (psi, rate) in state.state().iter().zip(rates) {
                        assert_close(*psi, 1.0 / (1.0 + 100.0 * rate), 1e-12, &what);
                    }
                    assert!(state.residual(&spinodal(), driving) < 1e-12, "{what}");
                }
                assert_close(state.stress.value, number(&truth["tau"]), 1e-14, &what);
                // the error budgets hold, everywhere
                assert!(
                    (state.stress.value - number(&truth["tau"])).abs() <= state.stress.uncertainty,
                    "{what}"
                );
                for (i, rate) in rates.iter().enumerate().take(2) {
                    let error = (state.slip_rate[i] - rate).abs();
                    assert!(
                        error <= state.slip_rate_uncertainty()[i],
                        "{what}: {error:e}"
                    );
                }
            }
        }
    }
}

/// Reference points with eigenvalues; the parameters there are exact decimals, here the nearest doubles.
#[test]
fn states_and_eigenvalues_match_the_reference() {
    for &solver in SOLVERS {
        for point in data("equilibria.json")["points"]
            .as_array()
            .expect("points")
        {
            let (driving, stiffness) = (number(&point["V_H"]), number(&point["K"]));
            let found = steady_states(&spinodal(), driving, 2, solver).expect("solved");
            let symmetric = found
                .equilibria
                .iter()
                .find(|e| e.symmetry == Symmetry::Symmetric)
                .expect("always there");
            let mut expected = point["asym"].as_array().expect("a list").clone();
            expected.sort_by(|a, b| number(&a["V_slow"]).total_cmp(&number(&b["V_slow"])));
            let states = asymmetric(&spinodal(), driving, solver);
            assert_eq!(states.len(), expected.len());
            for (state, truth) in states
                .iter()
                .zip(&expected)
                .chain([(symmetric, &point["sym"])])
            {
                let what = format!("{solver:?}, V_H = {driving}, {:?}", state.symmetry);
                assert_close(state.stress.value, number(&truth["tau"]), 1e-12, &what);
                if state.symmetry == Symmetry::Asymmetric {
                    for (i, (v, psi)) in [("V_slow", "psi_slow"), ("V_fast", "psi_fast")]
                        .into_iter()
                        .enumerate()
                    {
                        assert_close(state.slip_rate[i], number(&truth[v]), 1e-12, &what);
                        assert_close(state.state()[i], number(&truth[psi]), 1e-12, &what);
                    }
                } else {
                    assert_close(state.state()[0], number(&truth["psi"]), 1e-12, &what);
                }
                let computed = stability(&spinodal(), state, stiffness).expect("K is valid");
                let mut unmatched: Vec<_> = computed.eigenvalues.clone();
                for truth in truth["eigs"].as_array().expect("eigenvalues") {
                    let (re, im) = complex(truth);
                    let nearest = (0..unmatched.len())
                        .min_by(|&i, &j| {
                            let off = |k: usize| (unmatched[k].re - re).hypot(unmatched[k].im - im);
                            off(i).total_cmp(&off(j))
                        })
                        .expect("as many as in the reference");
                    let s = unmatched.remove(nearest);
                    let error = (s.re - re).hypot(s.im - im) / re.hypot(im);
                    assert!(error < 1e-10, "{what}: {s} against {re} {im}: {error:e}");
                }
                let unstable = computed.eigenvalues.iter().any(|s| s.re > 0.0);
                assert_eq!(
                    computed.verdict,
                    if unstable {
                        Verdict::Unstable
                    } else {
                        Verdict::Stable
                    },
                    "{what}"
                );
            }
        }
    }
}

/// The characteristic polynomials (26) and (30) against the eigenvalues of the Jacobian matrix of (19).
#[test]
fn eigenvalues_are_those_of_the_jacobian() {
    for driving in [0.01, 0.06, 0.2, 5.0, 300.0, 1000.0, 30000.0, 1e6] {
        for stiffness in [0.01, 0.14, 0.45, 20.0] {
            let loading = Loading::new(driving, stiffness).expect("valid");
            let field = two_interfaces(spinodal(), loading);
            for state in steady_states(&spinodal(), driving, 2, Solver::Newton)
                .expect("solved")
                .equilibria
            {
                let y = State::<3>::new(state.stress.value, state.log_state[0], state.log_state[1]);
                let j = field.jacobian(&y);
                // a small residual, but the field is stiff: compare with the rate at which it answers
                assert!(
                    field.f(&y).amax() < 1e-12 * (j.amax() + stiffness * driving),
                    "V_H = {driving}"
                );
                let mut matrix: Vec<_> = j.complex_eigenvalues().iter().copied().collect();
                matrix.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
                for (a, b) in stability(&spinodal(), &state, stiffness)
                    .expect("valid")
                    .eigenvalues
                    .iter()
                    .zip(matrix)
                {
                    assert!(
                        (a - b).norm() < 1e-10 * j.amax().min(1.0).max(a.norm()),
                        "V_H = {driving}, K = {stiffness}: {a} {b}"
                    );
                }
            }
        }
    }
}

/// At the reference's Hopf points a pair of eigenvalues is imaginary, with its frequency; on either side the verdict is firm.
#[test]
fn hopf_points_of_the_reference_have_imaginary_eigenvalues() {
    let hopf = data("hopf.json");
    for (stiffness, points) in hopf["points"].as_object().expect("by stiffness") {
        let k: f64 = stiffness.parse().expect("K");
        for kind in ["sym", "asym"] {
            for point in points[kind].as_array().expect("a list") {
                let driving = number(&point["V_H"]);
                let found = steady_states(&spinodal(), driving, 2, Solver::Newton)
                    .expect("solved")
                    .equilibria;
                let tau = number(&point["tau"]);
                let state = found.iter().min_by(|a, b| {
                    (a.stress.value - tau)
                        .abs()
                        .total_cmp(&(b.stress.value - tau).abs())
                });
                let state = state.expect("at least the symmetric one");
                assert_close(state.stress.value, tau, 1e-12, "stress");
                let at = stability(&spinodal(), state, k).expect("valid");
                let pair = at.eigenvalues.iter().find(|s| s.im > 0.0).expect("a pair");
                let omega = number(&point["omega"]);
                assert_close(pair.im, omega, 1e-12, "omega");
                assert!(
                    pair.re.abs() < 1e-12 * omega,
                    "K = {k}, V_H = {driving}: {pair}"
                );
                if kind == "asym" {
                    let verdict = |k| stability(&spinodal(), state, k).expect("valid").verdict;
                    assert_eq!(verdict(k * (1.0 + 1e-9)), Verdict::Stable);
                    assert_eq!(verdict(k * (1.0 - 1e-9)), Verdict::Unstable);
                }
            }
        }
    }
}

/// One interface is stable above k_c (16) and unstable below; at k_c itself nobody can tell.
#[test]
fn single_interface_loses_stability_at_the_critical_stiffness() {
    let law = AnyLaw::DieterichRuina(Parameters::heslot_1994().dieterich_ruina());
    let found = steady_states(&law, 3.0, 1, Solver::Newton).expect("solved");
    let [state] = &found.equilibria[..] else {
        panic!("one state")
    };
    let k_c = twinslip::friction::critical_stiffness(&law, 3.0);
    for (k, expected) in [
        (k_c * (1.0 + 1e-12), Verdict::Stable),
        (k_c * (1.0 - 1e-12), Verdict::Unstable),
        (k_c, Verdict::Undecided),
    ] {
        let at = stability(&law, state, k).expect("valid");
        assert_eq!(at.verdict, expected);
        assert_eq!(at.eigenvalues.len(), 2);
    }
}

#[test]
fn monotonic_laws_have_the_symmetric_state_only() {
    for name in ["dieterich-ruina", "slip", "regularised-ageing"] {
        let law = AnyLaw::named(name, Parameters::heslot_1994()).expect("known");
        for driving in [1e-8, 1e-3, 1.0, 1e6, 1e8] {
            let found = steady_states(&law, driving, 2, Solver::Newton).expect("solved");
            assert!(found.complete && found.equilibria.len() == 1, "{name}");
            let at = stability(&law, &found.equilibria[0], 0.3).expect("valid");
            assert_eq!(
                at.verdict,
                Verdict::Unstable,
                "{name} weakens everywhere (27)"
            );
        }
    }
}

/// The bounded law has a maximum and no minimum: beyond the pitchfork one slow/fast pair, for ever.
#[test]
fn bounded_law_keeps_its_asymmetric_state() {
    let law = AnyLaw::Bounded(Parameters::heslot_1994().bounded());
    for &solver in SOLVERS {
        assert!(asymmetric(&law, 0.049, solver).is_empty());
        for driving in [0.05, 1.0, 1e4, 1e8] {
            assert_eq!(
                asymmetric(&law, driving, solver).len(),
                1,
                "V_H = {driving}"
            );
        }
    }
}

/// A law with the parameters that a reference names.
fn law_of(parameters: &serde_json::Value) -> AnyLaw {
    let x = |name: &str| number(&parameters[name]);
    let parameters = Parameters::new(
        x("direct_effect"),
        x("evolution_effect"),
        x("reference_friction"),
        x("healing_time"),
        x("residual_strength"),
    );
    AnyLaw::Spinodal(parameters.expect("valid").spinodal())
}

/// A computed number, its bound, and the truth for the doubles and for the decimals.
fn within((value, bound): (Complex<f64>, f64), truths: [Complex<f64>; 2], floor: f64, what: &str) {
    for truth in truths {
        // the reference itself is rounded to doubles here
        let slack = f64::EPSILON * truth.norm();
        let error = (value - truth).norm();
        assert!(
            error <= bound + slack,
            "{what}: {value} +- {bound:e}, not {truth}"
        );
    }
    let apart = (truths[0] - truths[1]).norm();
    let least = apart.max(f64::EPSILON * truths[0].norm()).max(floor);
    assert!(
        bound <= 400.0 * least,
        "{what}: {value} +- {bound:e} is loose, {apart:e} is the difference"
    );
}

/// Beside folds and pitchforks, in stiff slabs and for extreme parameters: all states and no other, each number within its bound
/// of the truth, whether the parameters are decimals or doubles, and verdicts that are right. Bounds are no wider than a few
/// hundred times what this difference makes, but where it is nothing by accident.
#[test]
fn bounds_hold_and_are_sharp_beside_bifurcations_and_for_extreme_parameters() {
    let reference = data("equilibria_bounds.json");
    let mut undecided = 0;
    for &solver in SOLVERS {
        for point in reference["points"].as_array().expect("points") {
            let law = law_of(&point["parameters"]);
            let (driving, k) = (number(&point["V_H"]), number(&point["K"]));
            let found = steady_states(&law, driving, 2, solver).expect("solved");
            let what = format!("{solver:?}, V_H = {driving:e}, K = {k:e}, {law:?}");
            let truths =
                ["doubles", "decimals"].map(|kind| point[kind].as_array().expect("states"));
            assert!(found.complete, "{what}");
            assert_eq!(found.equilibria.len(), truths[0].len(), "{what}");
            for state in &found.equilibria {
                let off = |truth: &&serde_json::Value| {
                    (number(&truth["slip_rate"][0]) - state.slip_rate[0]).abs()
                };
                let both = truths.map(|all| {
                    all.iter()
                        .min_by(|a, b| off(a).total_cmp(&off(b)))
                        .expect("one")
                });
                let real = |x: f64| Complex::new(x, 0.0);
                for i in 0..2 {
                    let numbers = [
                        (
                            "slip_rate",
                            state.slip_rate[i],
                            state.slip_rate_uncertainty()[i],
                            f64::MIN_POSITIVE,
                        ),
                        (
                            "state",
                            state.state()[i],
                            state.state_uncertainty()[i],
                            f64::MIN_POSITIVE,
                        ),
                        (
                            "log_state",
                            state.log_state[i],
                            state.log_state_uncertainty()[i],
                            f64::EPSILON,
                        ),
                    ];
                    for (name, value, bound, floor) in numbers {
                        let truths = both.map(|truth| real(number(&truth[name][i])));
                        within(
                            (real(value), bound),
                            truths,
                            floor,
                            &format!("{what}: {name}"),
                        );
                    }
                }
                let stress = both.map(|truth| real(number(&truth["stress"])));
                within(
                    (real(state.stress.value), state.stress.uncertainty),
                    stress,
                    0.0,
                    &format!("{what}: stress"),
                );
                assert!(state.residual(&law, driving) < 1e-10, "{what}");
                let at = stability(&law, state, k).expect("valid");
                let spectra = both.map(|truth| {
                    let list = truth["eigenvalues"].as_array().expect("eigenvalues");
                    list.iter()
                        .map(|z| Complex::new(number(&z[0]), number(&z[1])))
                        .collect::<Vec<_>>()
                });
                let growing = spectra[0].iter().any(|z| z.re > 0.0);
                match at.verdict {
                    Verdict::Undecided => undecided += 1,
                    verdict => assert_eq!(verdict == Verdict::Unstable, growing, "{what}"),
                }
                // one beyond the range of doubles is left out
                let finite = spectra[0].iter().filter(|z| z.re.is_finite()).count();
                assert_eq!(at.eigenvalues.len(), finite, "{what}");
                for (&z, &bound) in at.eigenvalues.iter().zip(&at.uncertainty) {
                    let nearest = |all: &Vec<Complex<f64>>| {
                        *all.iter()
                            .min_by(|a, b| (*a - z).norm().total_cmp(&(*b - z).norm()))
                            .expect("three")
                    };
                    let truths = spectra.each_ref().map(nearest);
                    within((z, bound), truths, 0.0, &format!("{what}: eigenvalue"));
                }
            }
        }
    }
    assert_eq!(undecided, 0);
}

/// At the largest stiffness too eigenvalues are numbers; the work is that of any other.
#[test]
fn stiffness_has_no_end() {
    let found = steady_states(&spinodal(), 10.0, 2, Solver::Newton).expect("solved");
    for exponent in [290, 300, 305, 306, 307, 308] {
        let k = 10f64.powi(exponent);
        for (state, verdict) in found
            .equilibria
            .iter()
            .zip([Verdict::Unstable, Verdict::Stable])
        {
            let at = stability(&spinodal(), state, k).expect("valid");
            assert_eq!(at.verdict, verdict);
            assert_eq!(at.eigenvalues[0].re > 0.0, verdict == Verdict::Unstable);
            // -10 K is beyond the doubles at 1e308
            assert_eq!(at.eigenvalues.len(), if exponent < 308 { 3 } else { 2 });
            assert!(
                at.eigenvalues
                    .iter()
                    .all(|z| z.re.is_finite() && z.im == 0.0)
            );
            assert!(
                at.uncertainty
                    .iter()
                    .zip(&at.eigenvalues)
                    .all(|(u, z)| *u < 1e-12 * z.norm())
            );
        }
    }
}

/// Slip rates below all doubles: the state is listed, and nothing of it is no number.
#[test]
fn an_interface_may_be_as_good_as_at_rest() {
    for b in [5.0, 10.0, 40.0] {
        let parameters = Parameters::new(0.0349, b, 0.369, 100.0, 1e-3).expect("valid");
        let law = AnyLaw::Spinodal(parameters.spinodal());
        for &solver in SOLVERS {
            let found = steady_states(&law, 10.0, 2, solver).expect("solved");
            assert!(found.complete && found.equilibria.len() == 2, "b = {b}");
            let state = found
                .equilibria
                .iter()
                .find(|e| e.symmetry == Symmetry::Asymmetric)
                .expect("it is there");
            assert_eq!(state.slip_rate, [0.0, 10.0]);
            assert!(state.slip_rate_uncertainty()[0] <= 2.0 * f64::MIN_POSITIVE);
            assert!(state.residual(&law, 10.0) < 1e-10);
            let at = stability(&law, state, 0.14).expect("valid");
            assert_ne!(
                at.verdict,
                Verdict::Unstable,
                "the reference at b = 5 is stable"
            );
            assert!(!at.uncertainty.iter().any(|u| u.is_nan()));
            assert!(
                !at.eigenvalues
                    .iter()
                    .any(|z| z.re.is_nan() || z.im.is_nan())
            );
        }
    }
}

#[test]
fn bad_input_is_named() {
    let law = spinodal();
    for driving in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(
            steady_states(&law, driving, 2, Solver::Newton)
                .expect_err("refused")
                .is_input()
        );
    }
    assert!(
        steady_states(&law, 1.0, 3, Solver::Newton)
            .expect_err("refused")
            .is_input()
    );
    let state = &steady_states(&law, 1.0, 2, Solver::Newton)
        .expect("solved")
        .equilibria[0];
    assert!(
        stability(&law, state, -0.1)
            .expect_err("refused")
            .is_input()
    );
}
