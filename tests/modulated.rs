//! Interfaces whose driving velocity or normal stress varies in time, against references of thirty digits.

use crate::command::{number, object, object_or_undecided, refused_in_one_line, twinslip};
use crate::common::{self, data};
use serde_json::Value;

/// Whether a case is of interfaces.
fn is_of_interfaces(case: &Value) -> bool {
    !case["problem"]["parameters"]["mustar"].is_null()
}

/// The options of a case, its start and what it comes back to after a period: tau, psi and v.
fn forced(case: &Value) -> (String, [f64; 3]) {
    let all = &case["problem"]["parameters"];
    let of = |name: &str| common::number(&all[name]);
    let point = &case["values"]["point_at_phase_0"];
    let at = |name: &str| common::number(&point[name]);
    let law = format!(
        "--interfaces 1 --law ageing --direct-effect {} --evolution-effect {} --reference-friction {}",
        of("a"),
        of("b"),
        of("mustar")
    );
    let (eps, period) = (of("eps"), of("P"));
    if all.get("alpha").is_none() {
        let model = format!(
            "{law} --driving {} --stiffness {} --damping {} --modulate driving={eps}:{period}",
            of("V0"),
            of("K"),
            of("eta")
        );
        return (model, [at("tau"), at("psi"), at("v")]);
    }
    // In units of sigma; their tau is less by the stress that is radiated.
    let model = format!(
        "{law} --driving {} --stiffness {} --damping {} --modulate normal_stress={eps}:{period} --normal-stress-coupling {}",
        of("VL"),
        of("k") / of("a"),
        of("eta") / of("a"),
        of("alpha")
    );
    let tau = (at("tau") + of("eta") * at("V")) / of("a");
    (model, [tau, at("theta"), at("V")])
}

#[test]
fn forced_motion_comes_back_to_its_references() {
    let all = data("forced.json");
    let all = all["cases"].as_array().expect("a list").iter();
    let all: Vec<&Value> = all.filter(|case| is_of_interfaces(case)).collect();
    assert_eq!(all.len(), 4);
    for case in all {
        let (model, [tau, psi, v]) = forced(case);
        let period = common::number(&case["values"]["period"]);
        for start in [0.0, 0.25 * period] {
            // A phase is a shift of time.
            let phase = start / period;
            let model = model.replace(
                &format!(":{}", common::number(&case["problem"]["parameters"]["P"])),
                &format!(":{period}:{phase}"),
            );
            let until = period * (1.0 - phase) + if phase == 0.0 { 0.0 } else { period };
            let from = match phase {
                0.0 => format!("--start {tau:?},{psi:?}"),
                // From elsewhere it comes to the same orbit.
                _ => format!("--until {}", until + 60.0 * period),
            };
            let span = match phase {
                0.0 => format!("--until {until}"),
                _ => String::new(),
            };
            let made = object(&format!(
                "integrate {model} {from} {span} --final-only --rtol 1e-13 --method taylor"
            ));
            let last = &made["result"]["final"];
            // The entrained cycle comes to its orbit slowly.
            let tolerance = match phase {
                0.0 => 1e-10,
                _ => 1e-6,
            };
            for (name, known) in [("stress", tau), ("state_1", psi), ("slip_rate_1", v)] {
                let value = number(last, &format!("/{name}"));
                let off = (value / known - 1.0).abs();
                assert!(
                    off < tolerance,
                    "{}: {name} {value} for {known}",
                    case["id"]
                );
            }
        }
    }
}

/// The orbit under the forcing: its point, multipliers and largest slip rate.
#[test]
fn forced_orbits_are_their_references() {
    let all = data("forced.json");
    let all = all["cases"].as_array().expect("a list").iter();
    for case in all.filter(|case| is_of_interfaces(case)) {
        let (model, [tau, psi, _]) = forced(case);
        let made = object(&format!("orbit {model}"));
        let orbit = &made["result"]["orbit"];
        let (id, values) = (&case["id"], &case["values"]);
        let period = common::number(&values["period"]);
        assert!((number(orbit, "/forcing_period") / period - 1.0).abs() < 1e-15);
        assert_eq!(orbit["turns"], 1, "{id}");
        let within = orbit["point_uncertainty"].as_f64().expect("a number");
        assert!(within < 1e-11, "{id}: {within}");
        for (i, known) in [tau, psi.ln()].into_iter().enumerate() {
            let off = (number(orbit, &format!("/point/{i}")) - known).abs();
            assert!(off <= within * (1.0 + known.abs()), "{id}: {off}");
        }
        let multipliers = orbit["multipliers"].as_array().expect("a list");
        assert_eq!(multipliers.len(), 2, "{id}: no trivial one");
        for (made, known) in multipliers
            .iter()
            .zip(values["multipliers"].as_array().expect("two"))
        {
            let (re, im) = match known {
                Value::Array(parts) => (common::number(&parts[0]), common::number(&parts[1])),
                real => (common::number(real), 0.0),
            };
            let size = re.hypot(im);
            assert!(
                (number(made, "/0") - re).abs() < 1e-10 * size,
                "{id}: {made}"
            );
            assert!(
                (number(made, "/1").abs() - im.abs()).abs() < 1e-10 * size,
                "{id}: {made}"
            );
        }
        let fastest = ["v_max", "V_max"].iter().find_map(|name| values.get(*name));
        let fastest = common::number(fastest.expect("the largest slip rate"));
        assert!(
            (number(orbit, "/slip_rate_max") / fastest - 1.0).abs() < 1e-10,
            "{id}"
        );
    }
}

/// Along the amplitude and the period of what varies, in a curve over both, and on a grid of them.
#[test]
fn what_varies_is_followed_in_its_amplitude_and_its_period() {
    const MODEL: &str =
        "--law ageing --interfaces 1 --driving 1 --damping 1e-2 --modulate driving=0.2:13.8";
    let made = object(&format!(
        "branch orbits {MODEL} --stiffness 0.35 --along driving_period --from 13.8 --to 11"
    ));
    let special = made["result"]["special"].as_array().expect("a list");
    let torus = special
        .iter()
        .find(|one| one["label"] == "TR")
        .expect("a torus bifurcation");
    let at = number(torus, "/driving_period/value");
    // There the orbit's multipliers are on the unit circle.
    let words = MODEL.replace(":13.8", &format!(":{at:?}"));
    let there = object_or_undecided(&format!("orbit {words} --stiffness 0.35"));
    let logs = &there["result"]["orbit"]["log_multipliers"];
    assert!(number(logs, "/0/ln_abs/value").abs() < 1e-9, "{logs}");
    let period = number(&there["result"]["orbit"], "/period/value");
    assert!((period / at - 1.0).abs() < 1e-14);
    // A curve of these over the period and the amplitude goes through the point.
    let curve = object(&format!(
        "locus torus {MODEL} --stiffness 0.35 --in driving_period,driving_amplitude --range driving_period=11:13.9 --range driving_amplitude=0.1:0.4 --at driving_amplitude=0.2"
    ));
    let special = curve["result"]["special"].as_array().expect("a list");
    let same = special.iter().filter(|one| one["label"] == "UZ");
    let near = same.map(|one| (number(one, "/driving_period/value") - at).abs());
    assert!(near.fold(f64::INFINITY, f64::min) < 1e-9, "{special:?}");
    // On either side runs are periodic, or on a torus.
    let grid = twinslip(&format!(
        "sweep {MODEL} --stiffness 0.35 --grid driving_amplitude=0.3:0.3:1 --grid driving_period=12:14:2"
    ));
    let text = grid.out;
    assert!(
        text.contains(",torus,") && text.contains(",periodic,"),
        "{text}"
    );
}

#[test]
fn what_varies_by_two_periods_has_no_orbits() {
    const MODEL: &str = "--law ageing --interfaces 1 --driving 1 --stiffness 0.5 --damping 1e-2";
    refused_in_one_line(
        &format!("orbit {MODEL} --modulate driving=0.2:13.8 --modulate normal_stress=0.1:7"),
        "must have one period",
    );
    refused_in_one_line(
        &format!("orbit {MODEL} --turns 2"),
        "nothing is forced here",
    );
    refused_in_one_line(
        &format!("equilibria {MODEL} --modulate driving=0.2:13.8"),
        "no equilibria",
    );
    refused_in_one_line(
        &format!("section {MODEL} --modulate driving=0.2:13.8 --surface stress=10"),
        "phase=VALUE",
    );
    // Beside an unstable state of rest the answer to a forcing is found, though every run leaves it.
    let made = object(
        "orbit --driving 10 --stiffness 0.14 --interfaces 1 --modulate normal_stress=0.01:5 --crosscheck none",
    );
    let orbit = &made["result"]["orbit"];
    assert_eq!(
        (&orbit["turns"], &orbit["verdict"]),
        (&1.into(), &"unstable".into())
    );
    // Both by one period are one forcing.
    let made = object(&format!(
        "orbit {MODEL} --modulate driving=0.2:13.8 --modulate normal_stress=0.1:13.8:0.25"
    ));
    assert_eq!(made["result"]["orbit"]["turns"], 1);
}

/// Slips are integrals of the slip rates that rows have, by whatever method.
#[test]
fn slips_and_rates_agree_under_a_varying_normal_stress() {
    let command = "integrate --interfaces 2 --driving 1 --stiffness 0.5 --modulate normal_stress=0.2:3:0.1 --program 2:2,4-5:1 --start near-symmetric --until 6 --final-only --rtol 1e-10";
    let of = |more: &str| object(&format!("{command} {more}"))["result"]["final"].clone();
    let (series, steps) = (of("--method taylor"), of("--method rodas5p"));
    for (name, value) in series.as_object().expect("an object") {
        let (Some(x), Some(y)) = (value.as_f64(), steps[name].as_f64()) else {
            continue;
        };
        assert!((x - y).abs() <= 1e-6 * x.abs(), "{name}: {x} and {y}");
    }
}

#[test]
fn what_cannot_vary_is_refused() {
    let run = "integrate --interfaces 1 --driving 1 --stiffness 0.3 --until 1";
    for (arguments, sentence) in [
        ("--modulate driving=0.1", "must be NAME=EPS:PERIOD[:PHASE]"),
        (
            "--modulate stiffness=0.1:1",
            "must be driving or normal_stress",
        ),
        ("--modulate driving=0.1:0", "the PERIOD of --modulate is 0"),
        (
            "--modulate normal_stress=1:2",
            "the EPS of normal_stress in --modulate is 1",
        ),
        (
            "--modulate driving=0.1:1 --modulate driving=0.1:2",
            "varies driving twice",
        ),
        (
            "--normal-stress-coupling 0.2",
            "is of a normal stress that varies",
        ),
        (
            "--modulate driving=0.1:1 --program 0.5:2",
            "both say how the driving velocity changes",
        ),
    ] {
        refused_in_one_line(&format!("{run} {arguments}"), sentence);
    }
    for (command, sentence) in [
        ("equilibria", "no equilibria"),
        ("branch equilibria", "no equilibria"),
        ("law", "a law is the same at all times"),
    ] {
        refused_in_one_line(
            &format!("{command} --driving 1 --stiffness 0.3 --modulate normal_stress=0.1:1"),
            sentence,
        );
    }
    refused_in_one_line(
        "locus hopf --in stiffness,driving --modulate driving=0.1:1",
        "no equilibria",
    );
}
