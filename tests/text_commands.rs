//! What the commands take, write and refuse of user-defined systems.

use crate::command;
use crate::common::text::{SPINODAL, near};
use command::{folder, number, object, refused_in_one_line, run, twinslip};
use serde_json::Value;
use std::fs;

#[test]
fn every_method_integrates_a_file() {
    let exact = object(
        "integrate --system brusselator --until 5 --rtol 1e-14 --method taylor --final-only",
    );
    for method in twinslip::integrate::Choice::names() {
        let made = object(&format!(
            "integrate --system brusselator --until 5 --rtol 1e-9 --method {method} --final-only"
        ));
        for state in ["x", "y"] {
            let pointer = format!("/result/final/{state}");
            near(number(&made, &pointer), number(&exact, &pointer), 2e-5);
        }
    }
}

#[test]
fn an_estimate_of_the_error_holds_the_truth() {
    let arguments = "integrate --system lorenz --until 10 --estimate-error --final-only";
    let exact = object(&format!("{arguments} --rtol 1e-15 --reference"));
    for rtol in ["1e-6", "1e-9", "1e-12"] {
        let made = object(&format!("{arguments} --rtol {rtol}"));
        for state in ["x", "y", "z"] {
            let value = |made: &Value| number(made, &format!("/result/final/{state}"));
            let error = |made: &Value| number(made, &format!("/result/final/{state}_uncertainty"));
            let off = (value(&made) - value(&exact)).abs();
            assert!(
                off <= error(&made) + error(&exact),
                "{rtol}: {off} of {}",
                error(&made)
            );
        }
    }
}

#[test]
fn rows_have_the_names_of_the_states() {
    let ended = twinslip(
        "integrate --system roessler --until 10 --points 11 --columns time,z -q --format csv",
    );
    assert_eq!(ended.code, 0, "{}", ended.err);
    let rows = command::csv(&ended.out);
    assert_eq!(rows[0], ["time", "z"]);
    assert_eq!(rows.len(), 12);
    assert!(
        ended.out.contains("# model: system = Roessler"),
        "{}",
        ended.out
    );
    assert!(!ended.out.contains("# units"), "{}", ended.out);
}

#[test]
fn the_roessler_band_is_chaotic_and_its_orbit_periodic() {
    let made = object(
        "section --system roessler --set c=5.7 --surface x=0 --returns 400 --skip 100 --lyapunov",
    );
    assert_eq!(made["result"]["regime"], "chaotic");
    // The largest and the smallest of long runs in the literature: 0.0714 and -5.39 (Sprott 2003, Chaos and Time-Series Analysis).
    for (i, exact) in [0.0714, 0.0, -5.3943].into_iter().enumerate() {
        let [value, uncertainty] = ["value", "uncertainty"]
            .map(|part| number(&made, &format!("/result/lyapunov/{i}/{part}")));
        assert!(
            (value - exact).abs() <= uncertainty + 1e-4 && uncertainty < 0.05,
            "{value} +- {uncertainty}"
        );
    }
    let rows = made["result"]["rows"].as_array().expect("a list");
    assert_eq!(rows.len(), 400);
    assert!(
        rows.iter()
            .all(|row| row["x"].as_f64().is_some_and(|x| x.abs() < 1e-9))
    );
    let made =
        object("section --system roessler --surface x=0 --returns 100 --skip 200 --lyapunov");
    assert_eq!(made["result"]["regime"], "periodic");
    assert_eq!(made["result"]["period_of_orbit"], 1);
    let orbit = object("orbit --system roessler");
    let period = number(&orbit, "/result/orbit/period/value");
    near(number(&made, "/result/period/value"), period, 1e-12);
    let ln_abs = number(&orbit, "/result/orbit/log_multipliers/0/ln_abs/value");
    near(
        number(&made, "/result/lyapunov/1/value"),
        ln_abs / period,
        1e-10,
    );
}

#[test]
fn scenes_take_a_system_beside_them() {
    let place = folder("text_scene");
    fs::write(place.join("mine.toml"), SPINODAL).expect("a file");
    let scene = place.join("scene.toml");
    let text = "command = \"integrate\"\nsystem = \"mine.toml\"\nset = { K = 0.2 }\nuntil = 1\nfinal-only = true\nformat = \"json\"\n";
    fs::write(&scene, text).expect("a file");
    let ended = run(&["run", scene.to_str().unwrap(), "-q"]);
    assert_eq!(ended.code, 0, "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    assert_eq!(made["model"]["parameters"]["K"], 0.2);
    assert_eq!(made["model"]["system"], "two interfaces");
}

#[test]
fn what_makes_no_sense_with_a_system_is_refused() {
    for option in [
        "--law bounded",
        "--driving 1",
        "--stiffness 1",
        "--interfaces 1",
        "--si",
        "--healing-time 3",
    ] {
        let ended = twinslip(&format!("integrate --system lorenz --until 1 {option}"));
        assert_eq!(ended.code, 2, "{option}: {}", ended.err);
        let name = option.split(' ').next().unwrap();
        assert!(
            ended.err.starts_with("error: ") && ended.err.contains(name),
            "{}",
            ended.err
        );
    }
    refused_in_one_line(
        "integrate --system lorenz --until 1 --events",
        "stick-slip events of one or two interfaces",
    );
    refused_in_one_line("law --system lorenz", "this command is for interfaces");
    refused_in_one_line(
        "sweep --driving 1:2:3 --stiffness 1:2:3 --system lorenz",
        "--driving and --stiffness belong to interfaces",
    );
    refused_in_one_line(
        "integrate --system lorenz --until 1 --set rr=3",
        "--set: no parameter `rr`; known are s, r, b; did you mean \"r\"?",
    );
    refused_in_one_line(
        "integrate --system lorenz --until 1 --set r=x",
        "is not a finite number",
    );
    refused_in_one_line(
        "integrate --system lorenz --until 1 --start 1,2",
        "must have 3 values, one for each of x, y, z",
    );
    refused_in_one_line(
        "section --system lorenz",
        "--surface STATE=VALUE is missing",
    );
    refused_in_one_line(
        "section --system lorenz --surface w=0",
        "the state of --surface is w, but must be x, y or z",
    );
    refused_in_one_line(
        "equilibria --system lorenz --box x=0:1,y=0:1",
        "has no range of z",
    );
    refused_in_one_line(
        "equilibria --system lorenz --box x=1:0,y=0:1,z=0:1",
        "must increase",
    );
    refused_in_one_line(
        "integrate --system lorentz --until 1",
        "did you mean \"lorenz\"?",
    );
}
