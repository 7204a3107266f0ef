//! Interfaces whose driving velocity or normal stress varies in time, against references of thirty digits.

use crate::command::{number, object, refused_in_one_line};
use crate::common::{self, data};
use serde_json::Value;

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
    let all = data("forced_interfaces.json");
    let all = all["cases"].as_array().expect("a list");
    assert!(all.len() >= 4);
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
    for command in ["orbit", "equilibria", "section", "branch equilibria", "law"] {
        refused_in_one_line(
            &format!("{command} --driving 1 --stiffness 0.3 --modulate normal_stress=0.1:1"),
            "only `integrate`, and solve_ivp in Python",
        );
    }
}
