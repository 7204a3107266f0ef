//! Branches and curves of two interfaces in any parameter, equal or not, against numbers known to 28 digits.

use crate::command;
use crate::common::{data, number as of_reference};
use crate::unequal::{second, set};
use command::{number, object, refused_in_one_line};
use serde_json::Value;

/// The special points of a label.
fn special<'o>(made: &'o Value, label: &str) -> Vec<&'o Value> {
    let all = made["result"]["special"].as_array().expect("a list");
    all.iter().filter(|one| one["label"] == label).collect()
}

/// One of these holds the exact number in its budget, which is sharp.
#[track_caller]
fn one_holds(all: &[&Value], name: &str, exact: f64, sharp: f64) {
    let holds = |one: &&Value| {
        let [value, uncertainty] =
            ["value", "uncertainty"].map(|part| one[name][part].as_f64().unwrap_or(f64::INFINITY));
        (value - exact).abs() <= uncertainty + f64::EPSILON * exact && uncertainty <= sharp * exact
    };
    assert!(
        all.iter().any(holds),
        "{name} = {exact} is not among {:?}",
        all.iter().map(|one| &one[name]).collect::<Vec<_>>()
    );
}

#[test]
fn hopf_points_and_pitchforks_along_a_constant_of_the_law() {
    let known = data("parameters.json");
    let known = &known["vary_one"];
    let at = "--driving 10 --stiffness 0.14";
    let along_c = object(&format!(
        "branch equilibria {at} --along residual_strength --from 1e-5 --to 0.2"
    ));
    one_holds(
        &special(&along_c, "HB"),
        "residual_strength",
        of_reference(&known["hopf_symmetric_in_c"][0]["value"]),
        1e-12,
    );
    one_holds(
        &special(&along_c, "BP"),
        "residual_strength",
        of_reference(&known["pitchfork_in_c"][0]["value"]),
        1e-12,
    );
    let along_r = object(&format!(
        "branch equilibria {at} --along healing_time --from 0.1 --to 1000"
    ));
    one_holds(
        &special(&along_r, "BP"),
        "healing_time",
        of_reference(&known["pitchfork_in_R"][0]["value"]),
        1e-11,
    );
    for one in special(&along_r, "BP") {
        assert_eq!(number(one, "/driving/value"), 10.0);
        assert_eq!(number(one, "/stiffness/uncertainty"), 0.0);
    }
}

#[test]
fn curves_in_the_plane_of_the_driving_velocity_and_a_constant() {
    let known = data("parameters.json");
    let ranges =
        "--stiffness 0.14 --range residual_strength=4e-4,1e-3 --at residual_strength=0.0005,0.0008";
    let curve = |kind: &str| {
        let made = object(&format!(
            "locus {kind} --in driving,residual_strength {ranges}"
        ));
        let landed = special(&made, "UZ").into_iter().cloned();
        landed.collect::<Vec<Value>>()
    };
    let (hopf, pitchforks) = (curve("hopf"), curve("pitchfork"));
    for case in known["hopf_and_pitchforks_at_four_c"]
        .as_array()
        .expect("cases")
    {
        let c = of_reference(&case["c"]);
        let here = |all: &'_ [Value]| -> Vec<Value> {
            let landed = all
                .iter()
                .filter(|one| one["residual_strength"]["value"] == c);
            landed.cloned().collect()
        };
        let (hopf, pitchforks) = (here(&hopf), here(&pitchforks));
        let [hopf, pitchforks] = [&hopf, &pitchforks].map(|all| all.iter().collect::<Vec<_>>());
        for one in case["hopf"].as_array().expect("points") {
            one_holds(&hopf, "driving", of_reference(&one["V_H"]), 1e-11);
        }
        for one in case["pitchforks_V_H"].as_array().expect("points") {
            one_holds(&pitchforks, "driving", of_reference(one), 1e-11);
        }
    }
}

#[test]
fn folds_and_hopf_points_of_interfaces_that_differ() {
    let known = data("unequal.json");
    for case in ["U1_c2=0.0011", "U4_all_three"] {
        let known = &known["cases"][case];
        let set = set(&second(&known["second"]));
        let made = object(&format!("branch equilibria --stiffness 0.14 {set}"));
        for (label, name) in [("LP", "folds"), ("HB", "hopf")] {
            let found = special(&made, label);
            let exact = known[name].as_array().expect("a list");
            assert_eq!(found.len(), exact.len(), "{case}: {label}");
            for one in exact {
                one_holds(&found, "driving", of_reference(&one["V_H"]), 1e-11);
            }
        }
        // The pitchforks have unfolded.
        assert!(special(&made, "BP").is_empty());
    }
}

/// As the difference delta goes to zero the fold goes to the pitchfork as delta^(2/3), on the curve that has its cusp there.
#[test]
fn folds_go_to_the_pitchforks_with_the_two_thirds_power() {
    let differences = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10];
    let values: Vec<String> = differences
        .iter()
        .map(|delta| format!("{:?}", 1e-3 * (1.0 + delta)))
        .collect();
    let made = object(&format!(
        "locus saddle-node --in driving,residual_strength_2 --stiffness 0.14 --range driving=0.04,0.06 --range residual_strength_2=9e-4,1.1e-3 --at residual_strength_2={}",
        values.join(",")
    ));
    let cusps = special(&made, "CP");
    assert_eq!(cusps.len(), 1);
    let known = data("unequal.json");
    let exact = of_reference(&known["cusps_VH_c2"][0]["V_H"]);
    one_holds(&cusps, "driving", exact, 1e-11);
    // Where the state is 0.29 the strength hardly knows c: rounding of the rates is 2e4 times as much of it.
    one_holds(&cusps, "residual_strength_2", 1e-3, 1e-9);
    let landed = special(&made, "UZ");
    let fold = |value: &str| {
        let c: f64 = value.parse().expect("a number");
        let here = |one: &&&Value| one["residual_strength_2"]["value"] == c;
        let one = landed.iter().find(here).expect("a fold");
        number(one, "/driving/value") - exact
    };
    let shifts: Vec<f64> = values.iter().map(|value| fold(value)).collect();
    for pair in shifts.windows(2) {
        // From one to the next delta falls by a hundred.
        let power = (pair[0] / pair[1]).ln() / 100.0_f64.ln();
        assert!((power - 2.0 / 3.0).abs() < 0.02, "{power}: {shifts:?}");
    }
}

#[test]
fn near_misses_are_no_branch_points() {
    // Nearer than steps can tell: said, and no pitchfork is made of it.
    let ended = command::twinslip(
        "branch equilibria --stiffness 0.14 --from 0.01 --to 1 --set residual_strength_2=1.000000001e-3 --format json -q",
    );
    assert!([0, 1].contains(&ended.code), "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    assert!(special(&made, "BP").is_empty());
    let folds = special(&made, "LP");
    let exact = of_reference(&data("unequal.json")["cusps_VH_c2"][0]["V_H"]);
    assert!(!folds.is_empty());
    for fold in folds {
        assert!((number(fold, "/driving/value") / exact - 1.0).abs() < 1e-6);
    }
    // Of equal interfaces it is one.
    let made = object(
        "branch equilibria --stiffness 0.14 --driving 10 --along residual_strength --from 0.05 --to 0.1",
    );
    assert!(!special(&made, "BP").is_empty());
}

/// K_c = k_c(V_H) of one interface, which `law` computes by its closed form.
#[test]
fn a_single_interface_is_followed_in_every_constant_of_its_law() {
    for (name, from, to) in [
        ("residual_strength", 1e-4, 1e-2),
        ("healing_time", 50.0, 500.0),
        ("direct_effect", 0.03, 0.04),
        ("evolution_effect", 0.045, 0.055),
        ("reference_friction", 0.3, 0.5),
    ] {
        let made = object(&format!(
            "locus hopf --interfaces 1 --driving 10 --in stiffness,{name} --range {name}={from},{to}"
        ));
        let rows = made["result"]["rows"].as_array().expect("rows");
        assert!(rows.len() > 3, "{name}");
        for row in [&rows[0], &rows[rows.len() / 2]] {
            let [k, at] = ["stiffness", name].map(|name| number(row, &format!("/{name}/value")));
            let flag = name.replace('_', "-");
            let law = object(&format!("law --from 10 --to 20 --points 2 --{flag} {at}"));
            let exact = number(&law, "/result/rows/0/critical_stiffness");
            assert!(
                (k / exact - 1.0).abs() < 1e-12,
                "{name} = {at}: {k} for {exact}"
            );
        }
    }
}

#[test]
fn orbits_of_a_single_interface_are_those_that_orbit_finds() {
    let at = "--interfaces 1 --driving 10 --stiffness 0.2";
    let made = object(&format!(
        "branch orbits {at} --along direct_effect --from 0.03 --to 0.05 --at 0.036"
    ));
    let hopf = special(&made, "HB");
    assert_eq!(hopf.len(), 1);
    let landed = special(&made, "UZ");
    let found = object(&format!("orbit {at} --direct-effect 0.036"));
    let exact = number(&found, "/result/orbit/period/value");
    assert!((number(landed[0], "/period/value") / exact - 1.0).abs() < 1e-10);
    let rows = made["result"]["rows"].as_array().expect("rows");
    let row = rows.iter().find(|row| row["label"] == "UZ").expect("a row");
    let exact = number(&found, "/result/orbit/log_multipliers/0/ln_abs/value");
    assert!((number(row, "/ln_abs_multiplier_1") / exact - 1.0).abs() < 1e-6);
    let exact = number(&found, "/result/orbit/stress_max/value");
    assert!((number(row, "/stress_max") / exact - 1.0).abs() < 1e-6);
    assert!(row.get("state_2").is_none());
}

#[test]
fn a_branch_of_orbits_goes_on_from_the_end_at_which_it_begins() {
    // ln V_H = 0 is met again by rounding.
    let made = object(
        "branch orbits --stiffness 0.14 --set residual_strength_2=0.0011 --from 1 --to 1.5 --start 9.95,0.002,0.00199",
    );
    let ends: Vec<f64> = special(&made, "EP")
        .iter()
        .map(|one| number(one, "/driving/value"))
        .collect();
    assert_eq!(ends, [1.0, 1.5]);
    assert!(made["result"]["rows"].as_array().expect("rows").len() > 4);
}

/// Where the way changes that the torus bifurcation goes, by both engines: in V_H and K of a law that is built in, and of the same law from a
/// file. Hopf points lie outside of the range.
#[test]
#[ignore = "takes half a minute: .ci/run runs it"]
fn the_chenciner_point_is_the_same_in_any_parameters() {
    const LAW: &str = r#"
slip_rate = "gamma*sinh(tau)/(residual_strength + (1 + healing_time)*psi)^beta"
evolution = "(1 - psi)/healing_time - abs(v)*psi"
[parameters]
direct_effect = 0.0349
evolution_effect = 0.0489
reference_friction = 0.369
residual_strength = 1e-3
healing_time = 100.0
[where]
beta = "evolution_effect/direct_effect"
gamma = "2*exp(-reference_friction/direct_effect)"
"#;
    let path = crate::common::text::file("chenciner", LAW);
    let ranges = "--criticality --driving-range 0.054:0.055 --stiffness-range 0.033:0.034";
    let found = ["", &format!("--law {path}")].map(|law| {
        let made = object(&format!("locus torus {law} {ranges}"));
        let points = special(&made, "CH");
        assert_eq!(points.len(), 1, "{law}");
        ["driving", "stiffness"].map(|name| {
            ["value", "uncertainty"].map(|part| number(points[0], &format!("/{name}/{part}")))
        })
    });
    for (i, most) in [1e-10, 1e-9].into_iter().enumerate() {
        let [[first, by], [second, more]] = [found[0][i], found[1][i]];
        assert!((first - second).abs() <= by + more, "{first} for {second}");
        assert!(by + more < most);
    }
}

#[test]
fn special_orbits_in_any_parameter_are_computed_once_more_by_another_method() {
    let made = object(
        "branch orbits --interfaces 1 --driving 10 --stiffness 0.2 --along direct_effect --from 0.034 --to 0.038 --at 0.036 --crosscheck cvode-adams",
    );
    let landed = special(&made, "UZ");
    let check = &landed[0]["crosscheck"];
    assert_eq!(check["method"], "cvode-adams");
    assert!(number(check, "/period_difference").abs() < 1e-10);
    assert!(number(check, "/direct_effect_difference").abs() < 1e-15);
    assert!(check.get("driving_difference").is_none());
}

/// At a steady state of equal interfaces the damping adds eta V_H / 2 to the stress, and nothing else: in Pa, of Pa s/m and m/s.
#[test]
fn the_damping_varies_in_pascal_seconds_per_metre() {
    let made = object(
        "branch equilibria --si --driving 1e-5 --stiffness 1e10 --along damping --from 1e9 --to 1e11",
    );
    let rows = made["result"]["rows"].as_array().expect("rows");
    let rest = |row: &Value| number(row, "/stress") - number(row, "/damping") * 0.5e-5;
    let alike = rows.iter().filter(|row| {
        row["slip_rate_1"]
            .as_f64()
            .is_some_and(|v| (v / 0.5e-5 - 1.0).abs() < 1e-6)
    });
    let all: Vec<f64> = alike.map(rest).collect();
    assert!(all.len() > 5);
    for stress in &all {
        assert!(
            (stress / all[0] - 1.0).abs() < 1e-11,
            "{stress} for {}",
            all[0]
        );
    }
}

/// The stress of the equilibria at one value of the parameter, ascending.
fn stresses_at(command: &str, value: &str) -> Vec<f64> {
    let made = object(&format!("{command} --at {value}"));
    let rows = made["result"]["rows"].as_array().expect("rows");
    let landed = rows.iter().filter(|row| row["label"] == "UZ");
    let mut all: Vec<f64> = landed.map(|row| number(row, "/stress")).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// Formulas are freed of what they have no value of: radiation damping, and the constant of one interface.
#[test]
fn the_formulas_of_a_law_vary_as_the_law_that_is_built_in() {
    for (along, value) in [
        ("damping=1e-4:1", "1e-2"),
        ("residual_strength_2=2e-3:3e-3", "2.5e-3"),
    ] {
        let branch = format!("branch equilibria --driving 10 --stiffness 0.14 --along {along}");
        let built_in = stresses_at(&branch, value);
        let formulas = stresses_at(&format!("{branch} --law scenes/laws/spinodal.toml"), value);
        assert!(!built_in.is_empty());
        assert_eq!(built_in.len(), formulas.len(), "{along}");
        for (one, other) in built_in.iter().zip(&formulas) {
            assert!((one / other - 1.0).abs() < 1e-9, "{along}: {one} {other}");
        }
    }
}

#[test]
fn a_constant_of_one_of_three_interfaces_varies_though_none_is_given() {
    let branch = "branch equilibria --interfaces 3 --driving 10 --stiffness 0.14";
    let along = format!("{branch} --along residual_strength_3=2e-3:3e-3");
    let here = stresses_at(&along, "2.5e-3");
    let given = stresses_at(
        &format!("{branch} --set residual_strength_3=2.5e-3 --along healing_time=90:110"),
        "100",
    );
    assert!(!here.is_empty());
    assert_eq!(here.len(), given.len());
    for (one, other) in here.iter().zip(&given) {
        assert!((one / other - 1.0).abs() < 1e-9, "{one} {other}");
    }
    let made = object(&format!("{branch} --along damping=1e-3:1e-2"));
    assert_eq!(made["model"]["parameters"]["damping"], Value::Null);
}

#[test]
fn what_interfaces_do_not_have_is_refused_in_one_sentence() {
    let branch = "branch equilibria --driving 10 --stiffness 0.14";
    for (words, sentence) in [
        (
            "--along residual_strenght --from 1 --to 2",
            "did you mean \"residual_strength\"",
        ),
        (
            "--along residual_strength --from 0 --to 2",
            "residual_strength is 0",
        ),
        ("--along residual_strength --from 0.1", "--to is missing"),
        (
            "--along residual_strength_2 --from 0.1 --to 0.2 --interfaces 1",
            "residual_strength",
        ),
        ("--along driving --set residual_strength_2=2e-3", "driving"),
        (
            "--along residual_strength --from 0.1 --to 0.2 --start 1,1,1",
            "--start has no meaning",
        ),
    ] {
        refused_in_one_line(&format!("{branch} {words}"), sentence);
    }
    refused_in_one_line(
        "locus pitchfork --in driving,residual_strength_2 --stiffness 0.14 --range residual_strength_2=1e-4,1e-2",
        "needs a symmetry",
    );
    refused_in_one_line(
        "locus hopf --in driving,residual_strength --range residual_strength=1e-4,1e-2",
        "stiffness",
    );
    refused_in_one_line(
        "locus hopf --in driving,residual_strength --stiffness 0.14 --stiffness-range 0.1:0.2 --range residual_strength=1e-4,1e-2",
        "does not vary in the plane",
    );
}

/// Branches of asymmetric orbits begin at the pitchforks of symmetric ones along any parameter, and pitchforks are known in their last digits.
#[test]
fn orbits_part_from_symmetry_along_any_parameter() {
    let made =
        object("branch orbits --along damping --driving 1 --stiffness 0.12 --from 1e-4 --to 1e-1");
    let pitchforks = special(&made, "PF");
    assert_eq!(pitchforks.len(), 1, "{pitchforks:?}");
    let [at, off] =
        ["value", "uncertainty"].map(|part| number(pitchforks[0], &format!("/damping/{part}")));
    assert!(off < 1e-11 * at, "{at} +- {off}");
    assert_eq!(pitchforks[0]["criticality"], "subcritical");
    assert_eq!(pitchforks[0]["symmetry"], "symmetric");
    // The unstable asymmetric orbits lie below it.
    let rows = made["result"]["rows"].as_array().expect("rows");
    let parted = rows
        .iter()
        .filter(|row| row["symmetry"] == "asymmetric" && row["verdict"] == "unstable");
    let parted: Vec<f64> = parted.map(|row| number(row, "/damping")).collect();
    assert!(parted.len() > 3, "{}", parted.len());
    assert!(parted.iter().all(|x| *x < at));
    assert!(parted.iter().any(|x| *x > 0.9 * at));
}

/// The largest K of a curve of folds of orbits, also of interfaces that differ: of those that differ by nothing it is that of equal ones.
#[test]
fn curves_of_orbits_of_interfaces_that_differ_have_tops() {
    let ranges = "--driving-range 0.05:1 --stiffness-range 0.15:0.3";
    let of = |set: &str| {
        let made = object(&format!("locus torus {set} {ranges}"));
        let tops: Vec<[f64; 2]> = special(&made, "TOP")
            .into_iter()
            .map(|one| ["driving", "stiffness"].map(|name| number(one, &format!("/{name}/value"))))
            .collect();
        tops
    };
    let equal = of("");
    assert_eq!(equal.len(), 1, "{equal:?}");
    let differ = of("--set residual_strength_2=0.001000001");
    assert!(!differ.is_empty());
    for top in &differ {
        for (a, b) in top.iter().zip(&equal[0]) {
            assert!((a / b - 1.0).abs() < 1e-4, "{differ:?} {equal:?}");
        }
    }
}
