//! Periodic orbits and their multipliers against references of twenty digits, against other methods, and against each other.

use crate::common;
use common::{assert_close, complex, data, number, relative};
use serde_json::Value;
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::error::Error;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::Choice;
use twinslip::model::Loading;
use twinslip::orbit::{
    InitialGuess, InterfaceSystem, Kind, Orbit, OrbitAccuracy, Query, crosscheck, find,
};

fn slab(driving: f64, stiffness: f64) -> InterfaceSystem {
    InterfaceSystem {
        law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
        interfaces: 2,
        loading: Loading::new(driving, stiffness).expect("positive"),
    }
}

fn query(symmetry: Symmetry) -> Query {
    Query {
        symmetry,
        begin: InitialGuess::Anywhere,
    }
}

fn taylor() -> OrbitAccuracy {
    OrbitAccuracy::of(Choice::Taylor)
}

/// A reference orbit: the slab, its symmetry, the period, and the multipliers by (ln |mu|, |arg mu| / pi), largest first.
struct Reference {
    slab: InterfaceSystem,
    symmetry: Symmetry,
    period: f64,
    multipliers: Vec<(f64, f64)>,
    place: String,
}

fn references() -> Vec<Reference> {
    let orbits = data("orbits.json");
    let read = |orbit: &Value| {
        let (driving, stiffness) = (number(&orbit["V_H"]), number(&orbit["K"]));
        let mut multipliers: Vec<_> = orbit["mu"]
            .as_array()
            .expect("a list")
            .iter()
            .map(|mu| {
                let (re, im) = complex(mu);
                (re.hypot(im).ln(), im.atan2(re).abs() / std::f64::consts::PI)
            })
            .collect();
        multipliers.sort_by(|a, b| b.0.total_cmp(&a.0));
        let symmetric = orbit["type"] == "sym";
        Reference {
            slab: slab(driving, stiffness),
            symmetry: if symmetric {
                Symmetry::Symmetric
            } else {
                Symmetry::Asymmetric
            },
            period: number(&orbit["period"]),
            multipliers,
            place: format!("K = {stiffness}, V_H = {driving}, symmetric: {symmetric}"),
        }
    };
    orbits["orbits"]
        .as_array()
        .expect("a list")
        .iter()
        .map(read)
        .collect()
}

fn found(reference: &Reference) -> Orbit {
    let found = find(&reference.slab, &query(reference.symmetry), &taylor());
    found
        .unwrap_or_else(|error| panic!("{}: {error}", reference.place))
        .orbit
}

#[test]
fn every_reference_orbit_is_found_and_its_budgets_hold() {
    let references = references();
    assert_eq!(references.len(), 14);
    for reference in references {
        let orbit = found(&reference);
        let place = &reference.place;
        assert_eq!(orbit.symmetry, reference.symmetry, "{place}");
        assert_close(orbit.period.value, reference.period, 1e-12, place);
        let off = (orbit.period.value - reference.period).abs();
        assert!(
            off <= orbit.period.uncertainty,
            "{place}: period off by {off:e}"
        );
        assert!(
            orbit.period.uncertainty < 1e-10 * reference.period,
            "{place}"
        );
        let mut unstable = false;
        for (mine, &(ln_abs, angle)) in orbit.floquet.multipliers.iter().zip(&reference.multipliers)
        {
            let off = (mine.ln_abs.value - ln_abs).abs();
            assert!(off < 1e-9, "{place}: ln |mu| = {ln_abs} off by {off:e}");
            assert!(
                off <= mine.ln_abs.uncertainty,
                "{place}: {ln_abs} off by {off:e}"
            );
            assert!(mine.ln_abs.uncertainty < 1e-8, "{place}");
            assert!((mine.angle_over_pi - angle).abs() < 1e-10, "{place}");
            let kind = if angle == 0.0 {
                Kind::Real
            } else {
                Kind::Complex
            };
            assert_eq!(mine.kind, kind, "{place}");
            unstable |= ln_abs > 0.0;
        }
        let verdict = if unstable {
            Verdict::Unstable
        } else {
            Verdict::Stable
        };
        assert_eq!(orbit.verdict(), verdict, "{place}");
        assert!(orbit.floquet.trivial_defect < 1e-11, "{place}");
        let liouville = orbit.floquet.liouville_defect.expect("of taylor");
        assert!(liouville.abs() < 1e-10, "{place}: {liouville:e}");
    }
}

#[test]
fn other_methods_agree_on_trajectories_of_their_own() {
    let mut names = vec!["rodas5p"];
    if cfg!(feature = "sundials") {
        names.push("cvode-bdf");
    }
    // Each of them by one method, by another one another time.
    let turn = common::random() as usize % names.len();
    for (i, reference) in references().into_iter().enumerate() {
        let orbit = found(&reference);
        let name = &names[(i + turn) % names.len()];
        let accuracy = OrbitAccuracy {
            checked: false,
            ..OrbitAccuracy::of(Choice::named(name).expect("known"))
        };
        let place = format!("{name}, {}", reference.place);
        let second = crosscheck(&reference.slab, &orbit, &accuracy)
            .unwrap_or_else(|error| panic!("{place}: {error}"));
        assert_eq!(second.orbit.method, *name);
        assert_close(second.orbit.period.value, reference.period, 1e-8, &place);
        let multipliers = second.orbit.floquet.multipliers.iter();
        for (mine, &(ln_abs, _)) in multipliers.zip(&reference.multipliers) {
            // ln |mu| within this is mu within the same, relatively.
            let off = (mine.ln_abs.value - ln_abs).abs();
            assert!(off < 1e-6, "{place}: ln |mu| = {ln_abs} off by {off:e}");
            assert!(
                off <= mine.ln_abs.uncertainty,
                "{place}: {ln_abs} off by {off:e}"
            );
        }
        assert_eq!(second.orbit.verdict(), orbit.verdict(), "{place}");
    }
}

#[test]
fn three_orbits_coexist_at_small_stiffness() {
    let slab = slab(0.2, 0.05);
    let of = |query: Query| find(&slab, &query, &taylor()).expect("an orbit").orbit;
    let symmetric = of(query(Symmetry::Symmetric));
    let stable = of(query(Symmetry::Asymmetric));
    let start = (11.377, [1.53e-6_f64.ln(), 1.83e-4_f64.ln()]);
    let unstable = of(Query {
        symmetry: Symmetry::Asymmetric,
        begin: InitialGuess::At {
            start,
            period: Some(480.0),
        },
    });
    assert_close(
        symmetric.period.value,
        492.286_467_631_213_3,
        1e-12,
        "symmetric",
    );
    assert_close(stable.period.value, 472.009_264_586_700_9, 1e-12, "stable");
    // the digits that are printed of it
    assert!(
        (unstable.period.value - 480.304).abs() < 5e-4,
        "{:?}",
        unstable.period
    );
    assert_eq!(symmetric.verdict(), Verdict::Stable);
    assert_eq!(stable.verdict(), Verdict::Stable);
    assert_eq!(unstable.verdict(), Verdict::Unstable);
    // without the period it is its returns that lead there
    let returned = of(Query {
        symmetry: Symmetry::Asymmetric,
        begin: InitialGuess::At {
            start,
            period: None,
        },
    });
    assert_close(
        returned.period.value,
        unstable.period.value,
        1e-11,
        "by its returns",
    );
}

#[test]
fn the_branch_from_a_hopf_point_leads_to_the_same_orbits() {
    for (driving, symmetry) in [(100.0, Symmetry::Symmetric), (200.0, Symmetry::Asymmetric)] {
        let slab = slab(driving, 0.14);
        let of = |begin| {
            find(&slab, &Query { symmetry, begin }, &taylor())
                .expect("an orbit")
                .orbit
        };
        let (settled, followed) = (of(InitialGuess::Anywhere), of(InitialGuess::Hopf));
        assert_close(followed.period.value, settled.period.value, 1e-12, "period");
        assert_eq!(followed.verdict(), settled.verdict());
    }
}

#[test]
fn a_cycle_is_not_taken_for_a_shorter_one_twice() {
    let slab = slab(1.0, 0.14);
    let orbit = find(&slab, &query(Symmetry::Asymmetric), &taylor())
        .expect("an orbit")
        .orbit;
    let start = (orbit.point[0], [orbit.point[1], orbit.point[2]]);
    let twice = Query {
        symmetry: Symmetry::Asymmetric,
        begin: InitialGuess::At {
            start,
            period: Some(2.0 * orbit.period.value),
        },
    };
    match find(&slab, &twice, &taylor()) {
        Err(Error::NoOrbit { what, .. }) => assert!(what.contains("traversed 2 times"), "{what}"),
        other => panic!("{other:?}"),
    }
    // A start alone leads to the cycle itself.
    let once = Query {
        begin: InitialGuess::At {
            start,
            period: None,
        },
        ..twice
    };
    let again = find(&slab, &once, &taylor()).expect("an orbit").orbit;
    assert_close(again.period.value, orbit.period.value, 1e-13, "once");
}

#[test]
fn what_is_no_orbit_is_said() {
    let no = |driving, stiffness, symmetry| match find(
        &slab(driving, stiffness),
        &query(symmetry),
        &taylor(),
    ) {
        Err(Error::NoOrbit { what, hint, .. }) => format!("{what}; {hint}"),
        other => panic!("{other:?}"),
    };
    // Beyond all Hopf points.
    assert!(no(1000.0, 0.14, Symmetry::Symmetric).contains("converges to an equilibrium"));
    assert!(no(1000.0, 0.14, Symmetry::Asymmetric).contains("converges to an equilibrium"));
    // Where asymmetric runs become symmetric.
    assert!(no(0.2, 0.01, Symmetry::Asymmetric).contains("symmetric orbit"));
    // Newton's method on a cycle as small as that has but the equilibrium to go to.
    let slab = slab(1000.0, 0.14);
    let small = Query {
        begin: InitialGuess::At {
            start: (slab.steady_stress(), [slab.steady_log_state() + 1e-9; 2]),
            period: Some(0.01),
        },
        symmetry: Symmetry::Symmetric,
    };
    match find(&slab, &small, &taylor()) {
        Err(Error::NoOrbit { what, .. }) => assert!(what.contains("equilibrium"), "{what}"),
        Err(Error::NotConverged { .. }) => {}
        other => panic!("{other:?}"),
    }
    let single = InterfaceSystem {
        interfaces: 1,
        ..slab
    };
    let error = find(&single, &query(Symmetry::Asymmetric), &taylor()).expect_err("there is none");
    assert!(error.is_input());
}

#[test]
fn a_single_interface_is_two_alike_at_half_the_stiffness_and_twice_the_velocity() {
    let single = InterfaceSystem {
        interfaces: 1,
        ..slab(0.1, 0.28)
    };
    let one = find(&single, &query(Symmetry::Symmetric), &taylor())
        .expect("an orbit")
        .orbit;
    let two = find(&slab(0.2, 0.14), &query(Symmetry::Symmetric), &taylor())
        .expect("an orbit")
        .orbit;
    assert_close(one.period.value, two.period.value, 1e-13, "period");
    assert_eq!(one.floquet.multipliers.len(), 1);
    let within = two.floquet.multipliers.last().expect("two").ln_abs.value;
    assert_close(
        one.floquet.multipliers[0].ln_abs.value,
        within,
        1e-11,
        "ln mu",
    );
    assert_eq!(one.verdict(), Verdict::Stable);
}

#[test]
fn budgets_hold_between_two_methods_at_random_places() {
    use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
    let config = Config {
        cases: 16,
        failure_persistence: None,
        ..Config::default()
    };
    let mut runner =
        TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let places = (-1.3..-0.5_f64, -0.3..1.8_f64, proptest::bool::ANY);
    let checked = runner.run(&places, |(log_k, log_v, symmetric)| {
        let slab = slab(10f64.powf(log_v), 10f64.powf(log_k));
        let symmetry = if symmetric {
            Symmetry::Symmetric
        } else {
            Symmetry::Asymmetric
        };
        let Ok(first) = find(&slab, &query(symmetry), &taylor()) else {
            return Ok(());
        };
        let other = OrbitAccuracy {
            checked: false,
            ..OrbitAccuracy::of(Choice::named("rodas5p").expect("known"))
        };
        let second = crosscheck(&slab, &first.orbit, &other).expect("the same orbit");
        let (a, b) = (first.orbit.period, second.orbit.period);
        proptest::prop_assert!((a.value - b.value).abs() <= a.uncertainty + b.uncertainty);
        proptest::prop_assert!(relative(a.value, b.value) < 1e-8);
        let pairs = first
            .orbit
            .floquet
            .multipliers
            .iter()
            .zip(&second.orbit.floquet.multipliers);
        for (a, b) in pairs {
            let (a, b) = (a.ln_abs, b.ln_abs);
            let apart = (a.value - b.value).abs();
            proptest::prop_assert!(apart <= a.uncertainty + b.uncertainty, "{a:?} {b:?}");
        }
        Ok(())
    });
    if let Err(failure) = checked {
        panic!("{failure}");
    }
}

/// A second method that may take few steps in all gives up, however few it takes on each arc.
#[test]
fn a_crosscheck_is_bounded_in_all_its_steps() {
    let slab = slab(1.0, 0.14);
    let first = find(&slab, &query(Symmetry::Symmetric), &taylor()).expect("found");
    let second = OrbitAccuracy {
        checked: false,
        ..OrbitAccuracy::of(Choice::named("rodas5p").expect("known"))
    };
    let steps = crosscheck(&slab, &first.orbit, &second).expect("the same orbit");
    let fewer = OrbitAccuracy {
        all_steps: steps.orbit.work.steps / 2,
        ..second
    };
    let bounded = crosscheck(&slab, &first.orbit, &fewer);
    assert!(
        matches!(bounded, Err(Error::TooManySteps { .. })),
        "{bounded:?}"
    );
}
