//! Interfaces that differ, as a user asks for them: runs, equilibria, orbits, return maps and scenes, in SI too, and what is refused.

use crate::command;
use crate::common::{assert_close, data, number as known};
use crate::unequal::{second, set};
use command::{csv, folder, number, object, refused_in_one_line, twinslip};
use serde_json::Value;
use twinslip::friction::InterfaceConstants;

const SECOND: &str =
    "--set residual_strength_2=0.0011,slip_length_2=1.05 --set evolution_effect_2=0.0485";

/// The second interface of the references.
fn of_references() -> InterfaceConstants {
    second(&data("unequal.json")["cases"]["U4_all_three"]["second"])
}

fn loading(driving: f64) -> String {
    let second = set(&of_references());
    format!("--driving {driving} --stiffness 0.14 {second}")
}

fn uncertain(value: &Value) -> (f64, f64) {
    (number(value, "/value"), number(value, "/uncertainty"))
}

#[test]
fn equilibria_are_in_the_order_of_the_interfaces() {
    let made = object(&format!("equilibria {}", loading(10.0)));
    let all = data("unequal.json");
    let exact = all["cases"]["U4_all_three"]["equilibria"]
        .as_array()
        .expect("a list");
    let exact: Vec<_> = exact
        .iter()
        .filter(|one| known(&one["V_H"]) == 10.0)
        .collect();
    let found = made["result"]["equilibria"].as_array().expect("a list");
    assert_eq!(found.len(), exact.len());
    assert_eq!(made["result"]["complete"], true);
    for state in found {
        assert_eq!(state["symmetry"], "asymmetric");
        assert_eq!(state["verdict"], "unstable");
        let v = number(state, "/slip_rate/0");
        let near = |one: &&&Value| (known(&one["v1"]) / v - 1.0).abs() < 1e-6;
        let exact = exact.iter().find(near).expect("the state");
        let (stress, uncertainty) = uncertain(&state["stress"]);
        assert!((stress - known(&exact["stress"])).abs() <= uncertainty);
        assert_close(
            number(state, "/slip_rate/1"),
            known(&exact["v2"]),
            1e-12,
            "v_2",
        );
        assert_close(
            number(state, "/state/1"),
            known(&exact["psi2"]),
            1e-12,
            "psi_2",
        );
    }
    let model = &made["model"];
    for (name, value) in [
        ("residual_strength", 1e-3),
        ("residual_strength_1", 1e-3),
        ("residual_strength_2", of_references().residual_strength),
        ("slip_length_1", 1.0),
        ("slip_length_2", 1.05),
        ("evolution_effect_2", 0.0485),
    ] {
        assert_eq!(number(model, &format!("/{name}")), value, "{name}");
    }
    assert!(model.get("healing_time_2").is_none());
    assert_eq!(made["numerics"]["solver"], "newton");
    let told = twinslip(&format!("equilibria {} --explain", loading(10.0)));
    assert!(told.err.contains("branch and bound"), "{}", told.err);
}

#[test]
fn equal_numbers_are_as_if_they_had_no_index() {
    let commands = [
        "equilibria --driving 10 --stiffness 0.14",
        "integrate --driving 10 --stiffness 0.14 --until 3 --events",
        "orbit --driving 10 --stiffness 0.14 --symmetry asymmetric --crosscheck none",
    ];
    for command in commands {
        let plain = object(&format!("{command} --residual-strength 0.002"));
        for set in [
            "residual_strength_1=0.002,residual_strength_2=0.002",
            "residual_strength=0.002,healing_time_2=100,slip_length_2=1,normal_stress_1=1",
            "residual_strength_2=0.002,residual_strength=0.002",
        ] {
            let made = object(&format!("{command} --set {set}"));
            assert_eq!(made["result"], plain["result"], "{command}, {set}");
            assert_eq!(made["model"], plain["model"], "{command}, {set}");
        }
    }
    // An index has the last word, whatever the order.
    let one = object(&format!(
        "{} --set residual_strength_2=0.003,residual_strength=0.002",
        commands[0]
    ));
    let other = object(&format!(
        "{} --set residual_strength=0.002,residual_strength_2=0.003",
        commands[0]
    ));
    assert_eq!(one["result"], other["result"]);
    // Exchanged interfaces are the same system, where no unit is exchanged.
    let exchanged = object(&format!(
        "{} --set residual_strength=0.003,residual_strength_2=0.002",
        commands[0]
    ));
    let (mine, theirs) = (
        &one["result"]["equilibria"],
        &exchanged["result"]["equilibria"],
    );
    for (mine, theirs) in mine
        .as_array()
        .expect("a list")
        .iter()
        .zip(theirs.as_array().expect("a list"))
    {
        assert_close(
            number(mine, "/slip_rate/0"),
            number(theirs, "/slip_rate/1"),
            1e-13,
            "v",
        );
        assert_close(
            number(mine, "/slip_rate/1"),
            number(theirs, "/slip_rate/0"),
            1e-13,
            "v",
        );
    }
}

#[test]
fn runs_end_alike_by_all_methods() {
    let run = format!(
        "integrate {} --until 5 --start 9.9,0.003,0.0021",
        loading(10.0)
    );
    let end = |more: &str| {
        let made = object(&format!("{run} --final-only {more}"));
        ["stress", "log_state_1", "log_state_2", "slip_1", "slip_2"]
            .map(|name| number(&made, &format!("/result/final/{name}")))
    };
    let exact = end("--rtol 1e-14");
    let mut methods = vec![("auto", 1e-7), ("rodas5p", 1e-6), ("rosenbrock23", 1e-3)];
    if cfg!(feature = "sundials") {
        methods.extend([("cvode-bdf", 1e-5), ("cvode-adams", 1e-5)]);
    }
    for (method, tolerance) in methods {
        let made = end(&format!("--method {method} --rtol 1e-10"));
        for (made, exact) in made.into_iter().zip(exact) {
            assert_close(made, exact, tolerance, method);
        }
    }
    let told = object(&format!("{run} --estimate-error --reference"));
    let estimate = number(&told, "/result/final/error_estimate");
    let off = (number(&told, "/result/final/stress") / exact[0] - 1.0).abs();
    assert!(off <= estimate && estimate < 1e-6, "{off:e} {estimate:e}");
    // K (V_H t - slips) = tau - tau(0)
    let balance = 9.9 + 0.14 * (50.0 - exact[3] - exact[4]);
    assert_close(balance, exact[0], 1e-9, "balance");
}

#[test]
fn programs_and_events_are_of_both() {
    let program = format!(
        "integrate --driving 1 --stiffness 0.14 {SECOND} --program 5:10,8-9:3,12:0 --until 14 --rtol 1e-11"
    );
    let row = |more: &str| {
        let ended = twinslip(&format!("{program} {more} --format csv -q"));
        assert_eq!(ended.code, 0, "{}", ended.err);
        let rows = csv(&ended.out);
        let header = rows[0].join(",");
        assert_eq!(
            header,
            "time,stress,state_1,state_2,log_state_1,log_state_2,slip_rate_1,slip_rate_2,slip_1,slip_2,driving"
        );
        rows.last()
            .expect("rows")
            .iter()
            .map(|x| x.parse::<f64>().expect("a number"))
            .collect::<Vec<_>>()
    };
    let [taylor, other] = ["--method taylor", "--method rodas5p"].map(row);
    for (a, b) in taylor.iter().zip(&other).take(10) {
        assert_close(*a, *b, 1e-5, "program");
    }
    // dtau/dt = K (V_H - v_1 - v_2): 5 at 1, 3 at 10, a ramp from 10 to 3, 3 at 3.
    let slipped = taylor[8] + taylor[9];
    let start = object(&format!("{program} --points 2"));
    let first = number(&start, "/result/rows/0/stress");
    assert_close(
        first + 0.14 * (5.0 + 30.0 + 6.5 + 9.0 - slipped),
        taylor[1],
        1e-9,
        "balance",
    );
    let events = object(&format!("integrate {} --until 20 --events", loading(10.0)));
    let events = events["result"]["events"].as_array().expect("events");
    assert!(events.len() > 3);
    assert!(
        events
            .iter()
            .all(|event| number(event, "/stress_drop") > 0.0)
    );
}

#[test]
fn orbits_are_found_by_the_command() {
    let made = object(&format!("orbit {} --points 50", loading(10.0)));
    let orbit = &made["result"]["orbit"];
    assert_eq!(orbit["symmetry"], "asymmetric");
    assert_eq!(orbit["verdict"], "stable");
    let exact = &data("unequal.json")["orbits_K0_14_VH10"]["U4_all_three_2slips"];
    let all = [orbit]
        .into_iter()
        .chain(made["result"]["others"].as_array().expect("a list"));
    let period = known(&exact["period"]);
    let near = |one: &&Value| (number(one, "/period/value") / period - 1.0).abs() < 1e-3;
    let orbit = { all }.find(near).expect("the one of the reference");
    let (made_period, uncertainty) = uncertain(&orbit["period"]);
    assert!((made_period - period).abs() <= uncertainty && uncertainty < 1e-10);
    for (i, logarithm) in orbit["log_multipliers"]
        .as_array()
        .expect("two")
        .iter()
        .enumerate()
    {
        let (made, uncertainty) = uncertain(&logarithm["ln_abs"]);
        let exact = known(&exact["ln_abs_multipliers_reduced"][i]);
        assert!(
            (made - exact).abs() <= uncertainty.min(1e-8),
            "{made} {exact} {uncertainty:e}"
        );
    }
    let rows = made["result"]["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 50);
    assert_close(
        number(&rows[49], "/stress"),
        number(&rows[0], "/stress"),
        1e-10,
        "closed",
    );
    let check = &made["result"]["orbit"]["crosscheck"];
    assert!(number(check, "/period_difference").abs() < 1e-7);
}

#[test]
fn return_maps_of_both() {
    let made = object(&format!(
        "section {} --skip 200 --returns 80 --lyapunov",
        loading(10.0)
    ));
    let result = &made["result"];
    assert_eq!(result["regime"], "periodic", "{result}");
    assert_eq!(number(result, "/period_of_orbit"), 1.0);
    assert_eq!(number(result, "/lyapunov/0/value"), 0.0);
    // ln |mu| / T of one of the orbits of the references.
    let exact = &data("unequal.json")["orbits_K0_14_VH10"]["U4_all_three_2slips"];
    let rate = known(&exact["ln_abs_multipliers_reduced"][0]) / known(&exact["period"]);
    let second = number(result, "/lyapunov/1/value");
    assert!(
        (second - rate).abs() < 1e-8 || second < 0.0,
        "{second} {rate}"
    );
}

#[test]
fn in_si_the_first_interface_has_the_units() {
    let plain = object(
        "equilibria --driving 10 --stiffness 0.14 --set residual_strength_2=0.0011,slip_length_2=1.05,normal_stress_2=0.9,healing_time_2=90",
    );
    // L_1 = 2 um, sigma_1 = 3 MPa, V* = 1 um/s: L_1/V* = 2 s and a sigma_1/L_1 = 0.0349 * 3e6 / 2e-6 Pa/m
    let stiffness = 0.14 * 0.0349 * 3e6 / 2e-6;
    let made = object(&format!(
        "equilibria --si --driving 1e-5 --stiffness {stiffness} --slip-length 2e-6 --normal-stress 3e6 \
         --set residual_strength_2=0.0011,slip_length_2=2.1e-6,normal_stress_2=2.7e6,healing_time_2=180"
    ));
    let unit = 0.0349 * 3e6;
    let lists = [&plain, &made].map(|one| one["result"]["equilibria"].as_array().expect("a list"));
    assert_eq!(lists[0].len(), lists[1].len());
    for (plain, made) in lists[0].iter().zip(lists[1]) {
        assert_close(
            number(made, "/stress/value"),
            unit * number(plain, "/stress/value"),
            1e-12,
            "stress",
        );
        assert_close(
            number(made, "/slip_rate/0"),
            1e-6 * number(plain, "/slip_rate/0"),
            1e-11,
            "v_1",
        );
        assert_close(
            number(made, "/state/1"),
            number(plain, "/state/1"),
            1e-11,
            "psi_2",
        );
        assert_close(
            number(made, "/eigenvalues/0/0"),
            0.5 * number(plain, "/eigenvalues/0/0"),
            1e-9,
            "eigenvalue",
        );
    }
    assert_eq!(number(&made, "/model/slip_length_1"), 2e-6);
    assert_eq!(number(&made, "/model/slip_length_2"), 2.1e-6);
    assert_eq!(number(&made, "/model/normal_stress_2"), 2.7e6);
    // The units are those of interface 1 also where it is that one that is given.
    let other = object(&format!(
        "equilibria --si --driving 1e-5 --stiffness {stiffness} --slip-length 2.1e-6 --normal-stress 2.7e6 --healing-time 180 --residual-strength 0.0011 \
         --set residual_strength_1=1e-3,slip_length_1=2e-6,normal_stress_1=3e6,healing_time_1=200"
    ));
    assert_eq!(other["result"], made["result"]);
    let run = |words: &str| object(&format!("integrate --final-only {words}"));
    let plain = run(&format!("--driving 10 --stiffness 0.14 {SECOND} --until 3"));
    let made = run(
        "--si --driving 1e-5 --stiffness 5.428888888888889e9 --until 2.7 --normal-stress 1e6 \
        --set residual_strength_2=0.0011,slip_length_2=0.945e-6,evolution_effect_2=0.0485",
    );
    let stress = number(&made, "/result/final/stress") / (0.0349 * 1e6);
    assert_close(
        stress,
        number(&plain, "/result/final/stress"),
        1e-6,
        "stress",
    );
}

#[test]
fn scenes_have_a_table_for_it() {
    let folder = folder("unequal_scene");
    let scene = folder.join("unequal.toml");
    let text = "command = \"equilibria\"\ndriving = 10\nstiffness = 0.14\nformat = \"json\"\n\n[set]\nresidual_strength_2 = 0.0011\nslip_length_2 = 1.05\nevolution_effect_2 = 0.0485\n";
    std::fs::write(&scene, text).expect("a file");
    let ended = twinslip(&format!("run {} -q", scene.display()));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let flags = object(&format!(
        "equilibria --driving 10 --stiffness 0.14 {SECOND}"
    ));
    assert_eq!(made["result"], flags["result"]);
    let wrong = text.replace("slip_length_2 = 1.05", "slip_length_2 = -1");
    std::fs::write(&scene, wrong).expect("a file");
    let told = twinslip(&format!("run {}", scene.display()));
    assert_eq!(told.code, 2);
    assert!(
        told.err
            .contains("slip_length_2 is -1, but must be positive"),
        "{}",
        told.err
    );
}

#[test]
fn plans_say_that_the_interfaces_differ() {
    for (command, words) in [
        ("integrate --until 1", "3: the interfaces differ"),
        ("orbit --crosscheck none", "3: the interfaces differ"),
        ("section --skip 0 --returns 1", "3: the interfaces differ"),
    ] {
        let told = twinslip(&format!("{command} {} --explain", loading(10.0)));
        assert!(told.err.contains(words), "{command}: {}", told.err);
    }
    // Equal states do not stay equal.
    let made = object(&format!(
        "integrate {} --until 1 --start 9.9,0.003,0.003",
        loading(10.0)
    ));
    let states =
        ["log_state_1", "log_state_2"].map(|name| number(&made, &format!("/result/final/{name}")));
    assert!((states[0] - states[1]).abs() > 1e-3, "{states:?}");
}

#[test]
fn equilibria_of_more_than_two_that_differ_are_refused_with_what_takes_them() {
    let ended = twinslip(
        "equilibria --interfaces 3 --driving 10 --stiffness 0.14 --set residual_strength_3=1",
    );
    assert_eq!(ended.code, 2, "{}", ended.err);
    let said = "--set: this command takes 3 interfaces only if they are equal";
    assert!(ended.err.contains(said), "{}", ended.err);
}

#[test]
fn what_is_wrong_is_refused_in_one_sentence() {
    let model = "equilibria --driving 10 --stiffness 0.14";
    for (set, sentence) in [
        (
            "residual_strength_3=1",
            "the index is 3, but must be 1 or 2",
        ),
        (
            "residual_strength_0=1",
            "the index is 0, but must be 1 or 2",
        ),
        ("residual_strenght_2=1", "did you mean"),
        ("damping_2=1", "have one damping in common"),
        ("driving_1=1", "have one driving in common"),
        (
            "residual_strength_2=-1",
            "residual_strength_2 is -1, but must be zero or positive",
        ),
        (
            "healing_time_2=0",
            "healing_time_2 is 0, but must be positive",
        ),
        (
            "direct_effect_1=-0.03",
            "direct_effect_1 is -0.03, but must be positive",
        ),
        ("reference_friction_2=1e9", "reference_friction_2 is"),
        ("slip_length_1=2", "slip_length_1 is 2, but must be 1"),
        ("normal_stress_1=2", "normal_stress_1 is 2, but must be 1"),
        ("slip_length_2=much", "is not a finite number"),
        ("slip_length=2", "it is the unit"),
    ] {
        refused_in_one_line(&format!("{model} --set {set}"), sentence);
    }
    let differ = "--set residual_strength_2=0.002";
    refused_in_one_line(
        &format!("{model} --interfaces 1 {differ}"),
        "there is one interface",
    );
    refused_in_one_line(
        &format!("{model} --solver kinsol {differ}"),
        "choose newton",
    );
    let orbit = "orbit --driving 10 --stiffness 0.14";
    refused_in_one_line(
        &format!("{orbit} --symmetry symmetric {differ}"),
        "unequal interfaces have no symmetric orbits",
    );
    refused_in_one_line(
        &format!("{orbit} --start hopf {differ}"),
        "for equal interfaces",
    );
}

/// tau_ss of interface 2 by (35) at v_2/l_2 and R/l_2, in the unit of the first one, and k_c by its slope.
#[test]
fn the_laws_of_both_interfaces_stand_one_after_the_other() {
    let (n, l, a, b, r, c) = (1.5, 2.0, 0.03, 0.045, 60.0, 0.002);
    let made = object(&format!(
        "law --points 25 --set normal_stress_2={n},slip_length_2={l},direct_effect_2={a},evolution_effect_2={b},healing_time_2={r},residual_strength_2={c}"
    ));
    let rows = made["result"]["rows"].as_array().expect("rows");
    let (first, second) = rows.split_at(25);
    let equal = object("law --points 25");
    let equal = equal["result"]["rows"].as_array().expect("rows");
    for (row, plain) in first.iter().zip(equal) {
        assert_eq!(row["interface"], 1);
        for (name, value) in plain.as_object().expect("a row") {
            assert_eq!(row[name], *value, "{name}");
        }
    }
    let gamma = 2.0 * (-0.369f64 / a).exp();
    let stress = |v: f64| {
        let psi = 1.0 / (1.0 + r * v / l);
        let strength = (c + (1.0 + r / l) * psi).powf(b / a);
        n * a / 0.0349 * (v / gamma * strength).asinh()
    };
    let stiffness = |v: f64| {
        let h = 1e-4;
        let slope = (stress(v * (1.0 + h)) - stress(v * (1.0 - h))) / (2.0 * h * v);
        -(1.0 / r + v / l) * slope
    };
    for row in second {
        assert_eq!(row["interface"], 2);
        let v = number(row, "/slip_rate");
        assert_close(number(row, "/stress"), stress(v), 1e-13, "stress");
        let friction = 0.0349 / n * stress(v);
        assert_close(number(row, "/friction"), friction, 1e-13, "friction");
        let critical = number(row, "/critical_stiffness");
        assert_close(
            critical,
            stiffness(v),
            1e-5 * (1.0 + 1.0 / critical.abs()),
            "k_c",
        );
    }
    let of = |name: &str, interface: u64| -> Vec<Value> {
        let all = made["result"][name].as_array().expect("a list").iter();
        all.filter(|one| one["interface"] == interface)
            .cloned()
            .collect()
    };
    for interface in [1, 2] {
        assert_eq!(of("extrema", interface).len(), 2);
        assert_eq!(of("transition_rates", interface).len(), 1);
    }
    for extremum in of("extrema", 2) {
        let ((v, radius), (peak, error)) = (
            uncertain(&extremum["slip_rate"]),
            uncertain(&extremum["stress"]),
        );
        let sign = if extremum["kind"] == "maximum" {
            1.0
        } else {
            -1.0
        };
        assert!((stress(v) - peak).abs() <= error + 1e-14 * peak && radius < 1e-9 * v);
        for beside in [0.999 * v, 1.001 * v] {
            assert!(sign * (stress(v) - stress(beside)) > 0.0);
        }
    }
    let [top] = &of("critical_stiffness_maxima", 2)[..] else {
        panic!("one maximum");
    };
    let ((v, _), (most, error)) = (uncertain(&top["slip_rate"]), uncertain(&top["stiffness"]));
    assert!((stiffness(v) - most).abs() < 1e-6 * most && error < 1e-9 * most);
    for beside in [0.9 * v, 1.1 * v] {
        assert!(stiffness(beside) < stiffness(v));
    }
}

#[test]
fn laws_of_both_interfaces_are_told_and_drawn() {
    let place = folder("laws-of-both");
    let picture = place.join("law.svg");
    let ended = twinslip(&format!(
        "law {SECOND} --points 5 --format csv --plot {}",
        picture.display()
    ));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let table = csv(&ended.out);
    assert_eq!((table[0][0].as_str(), table.len()), ("interface", 11));
    assert!(ended.err.contains("interface 2: maximum of stress"));
    let picture = std::fs::read_to_string(picture).expect("a picture");
    assert!(picture.contains("interface 1") && picture.contains("interface 2"));
    // Marks say whose they are.
    for label in ["maximum (1)", "maximum (2)"] {
        assert!(picture.contains(label), "{label}");
    }
    // Equal by --set, though each has its own.
    let same = object("law --points 3 --set slip_length_2=1,residual_strength_2=0.001");
    assert!(same["result"]["rows"][0].get("interface").is_none());
    // Of a law from a file.
    let made = object("law --law composite.toml --set cutoff_2=0.1 --points 3");
    let rows = made["result"]["rows"].as_array().expect("rows");
    let plain = object("law --law composite.toml --set cutoff=0.1 --points 3");
    assert_eq!(rows.len(), 6);
    assert_eq!(rows[5]["interface"], 2);
    assert_eq!(rows[5]["stress"], plain["result"]["rows"][2]["stress"]);
}

#[test]
fn every_law_runs_damped_or_not() {
    for law in [
        "spinodal",
        "bounded",
        "regularised-ageing",
        "dieterich-ruina",
        "slip",
    ] {
        for damping in ["0", "0.01"] {
            let model = format!(
                "--law {law} --damping {damping} --driving 1 --stiffness 3 --set direct_effect_2=0.034,normal_stress_2=1.1,slip_length_2=0.9"
            );
            let made = object(&format!("integrate {model} --until 2 --final-only"));
            assert!(number(&made, "/result/final/stress").is_finite());
            let made = twinslip(&format!("equilibria {model} --format json -q"));
            assert!([0, 3].contains(&made.code), "{law}: {}", made.err);
        }
    }
}
