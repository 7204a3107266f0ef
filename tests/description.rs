//! What programs are told of a model: its parameters can be set and varied as it says, and its loci are those that `locus` follows.

use crate::command::{Ended, number, run};
use crate::common::ROOT;
use serde_json::Value;
use std::fs;
use std::path::Path;
use twinslip::error::Error;
use twinslip_tasks::scene::ModelDescription;

/// All kinds of models.
const MODELS: [&str; 14] = [
    "",
    "--si",
    "--law=slip",
    "--law=dieterich-ruina --si --damping=1e6",
    "--interfaces=1",
    "--set=residual_strength_2=0.002",
    "--si --set=slip_length_2=2e-6,normal_stress_1=2e6",
    "--set=slip_length_2=2",
    "--interfaces=3",
    "--interfaces=3 --set=residual_strength_3=0.002",
    "--clusters=2,3",
    "--clusters=2,1 --si --time-unit=hour",
    "--law=composite.toml",
    "--system=lorenz",
];

/// What `locus` may be asked for.
const LOCI: [&str; 8] = [
    "pitchfork",
    "saddle-node",
    "hopf",
    "orbit-pitchfork",
    "orbit-saddle-node",
    "period-doubling",
    "torus",
    "homoclinic",
];

fn words(options: &str) -> Vec<String> {
    options.split_whitespace().map(str::to_owned).collect()
}

fn described_by(words: &[String]) -> Value {
    let described = ModelDescription::of_words(words).unwrap_or_else(|e| panic!("{words:?}: {e}"));
    serde_json::to_value(described).expect("JSON")
}

fn described(options: &str) -> Value {
    described_by(&words(options))
}

fn list(described: &Value, key: &str) -> Vec<Value> {
    described[key].as_array().expect(key).clone()
}

fn names(described: &Value, key: &str) -> Vec<String> {
    let all = list(described, key);
    let name = |one: &Value| one.get("name").unwrap_or(one).as_str().map(str::to_owned);
    all.iter().map(|one| name(one).expect("a name")).collect()
}

fn parameter(described: &Value, name: &str) -> Value {
    let all = list(described, "parameters");
    let found = all.iter().find(|one| one["name"] == name);
    found
        .unwrap_or_else(|| panic!("{name} is not told: {all:?}"))
        .clone()
}

/// A command with the options of a model, and with others.
fn commanded(command: &str, model: &str, more: &[String]) -> Ended {
    let mut all = words(command);
    all.extend(words(model));
    all.extend_from_slice(more);
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    run(&all)
}

/// What sets a parameter, as its description says.
fn setting(parameter: &Value, value: f64) -> String {
    let name = parameter["name"].as_str().expect("a name");
    match parameter["option"].as_bool().expect("a switch") {
        true => format!("--{}={value:e}", name.replace('_', "-")),
        false => format!("--set={name}={value:e}"),
    }
}

#[test]
fn two_equal_interfaces() {
    let told = described("--driving=3");
    assert_eq!(told["kind"], "interfaces");
    assert_eq!(told["title"], "two interfaces, spinodal law");
    assert_eq!(
        names(&told, "states"),
        ["stress", "log_state_1", "log_state_2"]
    );
    assert_eq!(
        told["states"][0],
        serde_json::json!({"name": "stress", "label": "stress τ", "unit": "a sigma"})
    );
    assert_eq!(told["states"][2]["label"], "ln ψ_2");
    assert_eq!(told["states"][2]["unit"], Value::Null);
    assert_eq!(
        parameter(&told, "driving"),
        serde_json::json!({
            "name": "driving", "symbol": "V_H", "meaning": "Driving velocity", "unit": "V*", "value": 3.0, "option": true,
            "range": [1e-3, 1e4], "log": true, "positive": true, "integer": false,
        })
    );
    // Up to 1.2 times the largest critical stiffness, 0.39369.
    let stiffness = parameter(&told, "stiffness");
    assert_eq!(stiffness["range"], serde_json::json!([0.012, 0.48]));
    assert_eq!(
        (&stiffness["value"], &stiffness["log"]),
        (&0.14.into(), &false.into())
    );
    let strength = parameter(&told, "residual_strength");
    assert_eq!(strength["range"], serde_json::json!([1e-4, 1e-2]));
    let meanings: Vec<(String, String)> = list(&told, "parameters")
        .iter()
        .map(|one| ["symbol", "meaning"].map(|key| one[key].as_str().expect("text").to_owned()))
        .map(|[symbol, meaning]| (symbol, meaning))
        .collect();
    let meanings: Vec<(&str, &str)> = meanings.iter().map(|(a, b)| (&**a, &**b)).collect();
    assert_eq!(
        meanings,
        [
            ("V_H", "Driving velocity"),
            ("K", "Stiffness"),
            ("eta", "Radiation damping"),
            ("R", "Healing time"),
            ("c", "Residual strength of the spinodal law"),
            ("a", "Direct effect"),
            ("b", "Evolution effect"),
            ("a_v", "Friction coefficient at V*"),
        ]
    );
    assert_eq!(names(&told, "axes"), ["driving", "stiffness"]);
    assert_eq!(names(&told, "symmetries"), ["symmetric", "asymmetric"]);
    assert_eq!(names(&told, "loci"), LOCI[..7]);
    assert_eq!(told["interfaces"], 2);
    assert_eq!(
        (&told["surface"], &told["text"]),
        (&Value::Null, &Value::Null)
    );
    assert_eq!(
        (&told["si"], &told["time_unit"]),
        (&false.into(), &"L/V*".into())
    );
    let laws = list(&told, "laws");
    assert_eq!(laws[0]["name"], "spinodal");
    assert!(
        laws.iter()
            .all(|law| law["meaning"].as_str().is_some_and(|text| !text.is_empty()))
    );
    // What is said of laws can be asked for.
    for law in &laws {
        described(&format!("--law={}", law["name"].as_str().expect("a name")));
    }
}

#[test]
fn values_and_units_in_si_are_the_users() {
    let told =
        described("--si --driving=3nm/s --slip-length=10um --set=sigma=50MPa --time-unit=day");
    assert_eq!(parameter(&told, "driving")["value"], 3e-9);
    assert_eq!(parameter(&told, "driving")["unit"], "m/s");
    assert_eq!(
        parameter(&told, "driving")["range"],
        serde_json::json!([3e-10, 1e-2])
    );
    let length = parameter(&told, "slip_length");
    assert_eq!(
        (&length["value"], &length["unit"]),
        (&1e-5.into(), &"m".into())
    );
    assert_eq!(
        (&length["symbol"], &length["meaning"]),
        (&"L".into(), &"Slip length".into())
    );
    assert_eq!(length["option"], true);
    assert_eq!(parameter(&told, "normal_stress")["value"], 5e7);
    assert_eq!(parameter(&told, "healing_time")["unit"], "s");
    assert_eq!(parameter(&told, "damping")["unit"], "Pa s/m");
    // k_c sigma a/L in Pa/m, rounded up.
    assert_eq!(parameter(&told, "stiffness")["range"][1], 8.3e10);
    assert_eq!(
        (&told["si"], &told["time_unit"]),
        (&true.into(), &"day".into())
    );
    // A value with a unit says so too.
    assert_eq!(described("--driving=3nm/s")["si"], true);
    // The point to begin with is the same in all units.
    let begin = described("--si");
    assert_eq!(parameter(&begin, "driving")["value"], 1e-5);
    let stiffness = number(&parameter(&begin, "stiffness"), "/value");
    assert!((stiffness / (0.14 * 0.0349e6 / 0.9e-6) - 1.0).abs() < 1e-10);
}

#[test]
fn interfaces_that_differ_have_the_constants_of_each() {
    let told = described("--set=residual_strength_2=0.002");
    assert_eq!(told["title"], "two unequal interfaces, spinodal law");
    let second = parameter(&told, "residual_strength_2");
    assert_eq!(
        (&second["value"], &second["option"]),
        (&0.002.into(), &false.into())
    );
    assert_eq!(second["symbol"], "c_2");
    assert_eq!(
        second["meaning"],
        "Residual strength of the spinodal law, interface 2"
    );
    assert_eq!(parameter(&told, "residual_strength_1")["value"], 0.001);
    assert!(!names(&told, "parameters").contains(&"residual_strength".to_owned()));
    assert!(names(&told, "symmetries").is_empty());
    assert_eq!(
        names(&told, "loci"),
        [
            "saddle-node",
            "hopf",
            "orbit-saddle-node",
            "period-doubling",
            "torus"
        ]
    );
    // Without SI the slip length of the first is the unit, and 1.
    let lengths = names(&described("--set=slip_length_2=2"), "parameters");
    assert!(lengths.contains(&"slip_length_2".to_owned()));
    assert!(!lengths.contains(&"slip_length_1".to_owned()));
}

#[test]
fn one_interface_many_and_clusters() {
    let one = described("--interfaces=1");
    assert_eq!(names(&one, "states"), ["stress", "log_state_1"]);
    assert_eq!(names(&one, "loci"), ["hopf", "orbit-saddle-node"]);
    assert!(names(&one, "symmetries").is_empty());
    let three = described("--interfaces=3");
    assert_eq!(names(&three, "states").len(), 4);
    assert!(names(&three, "loci").contains(&"pitchfork".to_owned()));
    assert!(!names(&three, "loci").contains(&"orbit-pitchfork".to_owned()));
    let clusters = described("--clusters=2,3 --driving=4");
    assert_eq!(
        clusters["title"],
        "5 interfaces in clusters of 2, 3, spinodal law"
    );
    assert_eq!(clusters["interfaces"], 5);
    assert_eq!(names(&clusters, "states").len(), 3);
    assert_eq!(parameter(&clusters, "driving")["value"], 4.0);
    assert_eq!(parameter(&clusters, "stiffness")["value"], 0.14);
    let si = described("--clusters=2,3 --si");
    assert_eq!(parameter(&si, "stiffness")["unit"], "Pa/m");
    assert_eq!(parameter(&si, "slip_length")["value"], 9e-7);
    let many = described("--interfaces=100");
    assert_eq!(names(&many, "states"), ["stress", "state_min", "state_max"]);
    assert_eq!(names(&many, "loci"), ["pitchfork", "saddle-node", "hopf"]);
    assert!(names(&described("--interfaces=1000000"), "loci").is_empty());
}

#[test]
fn a_law_of_a_text_tells_its_own_parameters() {
    let text = "slip_rate = \"exp(tau - mu/a)*psi^(-b/a)\"\nevolution = \"1 - v*psi\"\n[parameters]\na = 0.01 # direct effect\n\
        b = 0.015\nmu = 0.6\ndrift_1 = -2.0 # of nothing\n";
    let told = described_by(&[format!("--law={text}"), "--driving=1".to_owned()]);
    assert_eq!(told["title"], "two interfaces, the law");
    let direct = parameter(&told, "a");
    assert_eq!(
        (&direct["value"], &direct["option"]),
        (&0.01.into(), &false.into())
    );
    assert_eq!(
        (&direct["symbol"], &direct["meaning"]),
        (&"a".into(), &"direct effect".into())
    );
    assert_eq!(direct["range"], serde_json::json!([1e-3, 0.1]));
    let drift = parameter(&told, "drift_1");
    assert_eq!(drift["meaning"], "of nothing");
    assert_eq!(drift["range"], serde_json::json!([-4.0, 0.0]));
    assert_eq!(parameter(&told, "b")["meaning"], "");
    assert_eq!(
        (&told["text"], &told["time_unit"]),
        (&Value::Null, &Value::Null)
    );
    // k_c = b - a over a.
    assert_eq!(parameter(&told, "stiffness")["range"][1], 0.6);
}

#[test]
fn systems_tell_their_text_and_a_section() {
    let told = described("--system=lorenz --set=r=30");
    assert_eq!(
        (&told["kind"], &told["title"]),
        (&"system".into(), &"Lorenz".into())
    );
    assert_eq!(names(&told, "states"), ["x", "y", "z"]);
    assert_eq!(names(&told, "axes"), ["s", "r"]);
    assert_eq!(
        parameter(&told, "r"),
        serde_json::json!({
            "name": "r", "symbol": "r", "meaning": "", "unit": null, "value": 30.0, "option": false,
            "range": [0.0, 60.0], "log": false, "positive": false, "integer": false,
        })
    );
    assert_eq!(
        names(&told, "loci"),
        [
            "saddle-node",
            "hopf",
            "orbit-saddle-node",
            "period-doubling",
            "torus",
            "homoclinic"
        ]
    );
    let file = fs::read_to_string(Path::new(ROOT).join("scenes/systems/lorenz.toml"));
    assert_eq!(told["text"], file.expect("a file"));
    assert!(list(&told, "laws").is_empty());
    assert_eq!(
        (&told["interfaces"], &told["time_unit"]),
        (&Value::Null, &Value::Null)
    );
    // The same of its text; and where it comes to rest there is no section.
    let text = told["text"].as_str().expect("text");
    let of_text = described_by(&[format!("--system={text}"), "--set=r=30".to_owned()]);
    assert_eq!(of_text, told);
    assert_eq!(
        described("--system=lorenz --set=r=10")["surface"],
        Value::Null
    );
    // One parameter makes no plane, and time is a matter of runs.
    let oscillator = described("--system=van-der-pol");
    assert_eq!(names(&oscillator, "axes").len(), 1);
    assert!(names(&oscillator, "loci").is_empty());
    let forced = described("--system=duffing");
    assert_eq!(forced["surface"], Value::Null);
    // Nothing rests under a forcing, and its orbits have a multiplier for each variable.
    assert_eq!(forced["rests"], false);
    assert_eq!(told["rests"], true);
    let of_orbits = ["orbit-saddle-node", "period-doubling", "torus"];
    assert_eq!(names(&forced, "loci"), of_orbits);
    let none = "name = \"n\"\nstates = [\"x\"]\n[parameters]\np = 0\nq = -1.5 # below 0\n[rates]\nx = \"p + q*x\"\n";
    let none = described_by(&[format!("--system={none}")]);
    assert_eq!(none["surface"], Value::Null);
    assert_eq!(names(&none, "loci"), ["saddle-node"]);
    assert_eq!(
        parameter(&none, "p")["range"],
        serde_json::json!([-1.0, 1.0])
    );
    assert_eq!(
        parameter(&none, "q")["range"],
        serde_json::json!([-3.0, 0.0])
    );
    assert_eq!(parameter(&none, "q")["meaning"], "below 0");
}

#[test]
fn the_sections_of_systems_are_crossed() {
    for system in [
        "brusselator",
        "fitzhugh-nagumo",
        "inertial-block",
        "lorenz-84",
        "lorenz",
        "roessler",
        "two-blocks",
        "van-der-pol",
    ] {
        let told = described(&format!("--system={system}"));
        let surface = told["surface"]
            .as_str()
            .unwrap_or_else(|| panic!("{system}: none"));
        let ended = commanded(
            &format!("section --surface {surface} --returns 20 --skip 5 --format csv -q"),
            &format!("--system={system}"),
            &[],
        );
        assert!(
            ended.code == 0 || ended.code == 3,
            "{system} {surface}: {}",
            ended.err
        );
        let rows = ended
            .out
            .lines()
            .filter(|line| !line.starts_with('#'))
            .count();
        assert!(rows > 20, "{system} {surface}: {rows}");
    }
}

#[test]
fn what_is_wrong_is_said_in_one_sentence_that_names_the_option() {
    for (options, sentence) in [
        ("--driving=-1", "driving is -1, but must be positive"),
        (
            "--driving=0 --clusters=1,2",
            "driving is 0, but must be positive",
        ),
        ("--stiffness=0", "stiffness is 0, but must be positive"),
        ("--interfaces=0", "interfaces is 0, but must be at least 1"),
        (
            "--interfaces=3 --set=damping=-1",
            "damping is -1, but must be zero or positive",
        ),
        ("--law=ageng", "law is ageng, but must be one of spinodal"),
        ("--law=none.toml", "cannot read none.toml"),
        (
            "--system=lorenzz",
            "`system` lorenzz: there is no such file",
        ),
        ("--set=q=3", "`set`: no parameter `q`"),
        (
            "--system=lorenz --set=q=3",
            "`set`: no parameter `q`; known are s, r, b",
        ),
        (
            "--system=lorenz --driving=3",
            "'--system <FILE>' cannot be used with '--driving",
        ),
        ("--driving=3s", "`driving` 3s: a velocity is wanted"),
        (
            "--clusters=2,3 --interfaces=4",
            "`clusters` \"2,3\" must be numbers that together are 4",
        ),
        ("--si --time-unit=week", "time-unit is week"),
        (
            "--interfaces=9 --law=composite.toml",
            "`interfaces` 9: at most 7",
        ),
        (
            "--set=driving=2 --driving=3",
            "`set` driving and `driving` say the same thing",
        ),
        ("--until=3", "unexpected argument '--until'"),
    ] {
        let error = ModelDescription::of_words(&words(options)).expect_err(options);
        assert!(
            error.is_input() || matches!(error, Error::File { .. }),
            "{options}: {error}"
        );
        let error = error.to_string();
        assert!(error.contains(sentence), "{options}: {error}");
        assert_eq!(error.lines().count(), 1, "{options}: {error}");
    }
}

/// The words of a model without what they say of a parameter.
fn without(model: &str, name: &str) -> Vec<String> {
    let option = format!("--{}=", name.replace('_', "-"));
    let words = model
        .split_whitespace()
        .filter(|word| !word.starts_with(&option));
    let others = |word: &str| match word.strip_prefix("--set=") {
        None => vec![word.to_owned()],
        Some(all) => {
            let others = all
                .split(',')
                .filter(|one| !one.starts_with(&format!("{name}=")));
            others.map(|one| format!("--set={one}")).collect()
        }
    };
    words.flat_map(others).collect()
}

/// Both ends of the range of a parameter.
fn range(parameter: &Value) -> [f64; 2] {
    [0, 1].map(|end| number(parameter, &format!("/range/{end}")))
}

/// The value of each, given as the description says, is accepted and told again; so are both ends of its range.
#[test]
fn every_parameter_can_be_set_as_it_is_told() {
    for model in MODELS {
        for one in list(&described(model), "parameters") {
            let name = one["name"].as_str().expect("a name");
            let ([low, high], value) = (range(&one), number(&one, "/value"));
            assert!(low < high, "{model} {name}");
            assert!(
                (low..=high).contains(&value) || value == 0.0,
                "{model} {name}"
            );
            assert!(low > 0.0 || one["log"] == false, "{model} {name}");
            for value in [value, low, high] {
                let mut words = without(model, name);
                words.push(setting(&one, value));
                let again = parameter(&described_by(&words), name);
                assert_eq!(number(&again, "/value"), value, "{words:?}");
            }
        }
    }
}

/// What sets V_H and K, but those that vary, to the values that are told.
fn loading(told: &Value, free: &[&str]) -> Vec<String> {
    let fixed = ["driving", "stiffness"]
        .into_iter()
        .filter(|name| !free.contains(name));
    let slides = told["kind"] == "interfaces";
    let fixed = fixed.filter(|_| slides).map(|name| parameter(told, name));
    fixed
        .map(|one| setting(&one, number(&one, "/value")))
        .collect()
}

/// `branch equilibria` takes each as what varies, over the range that is told. Points are few: of three interfaces they take long.
#[test]
fn branches_follow_every_parameter_over_its_range() {
    for model in MODELS
        .iter()
        .filter(|model| !model.contains("interfaces=3"))
    {
        let told = described(model);
        for one in list(&told, "parameters") {
            let name = one["name"].as_str().expect("a name");
            let [low, high] = range(&one);
            let mut options = without(model, name);
            options.extend(loading(&told, &[name]));
            options.push(format!("--along={name}={low:e}:{high:e}"));
            // The driving velocity of equal interfaces has all its points at once.
            let points = if ["driving", "stiffness"].contains(&name) {
                2000
            } else {
                3
            };
            let branch = format!("branch equilibria --format csv -q --max-points {points}");
            let ended = commanded(&branch, "", &options);
            assert_ne!(ended.code, 2, "{options:?}: {}", ended.err);
            assert!(ended.out.contains(name), "{options:?}: {}", ended.err);
        }
    }
}

/// `locus` takes every bifurcation that is told, in the plane to begin with, and refuses the others in one sentence. Those of equilibria in all
/// of the plane; of orbits, which take long, near the values that are told.
#[test]
fn loci_are_those_that_locus_follows() {
    const FEW: [&str; 9] = [
        "",
        "--si",
        "--law=slip",
        "--interfaces=1",
        "--interfaces=12",
        "--set=residual_strength_2=0.002",
        "--clusters=2",
        "--system=lorenz",
        "--system=brusselator",
    ];
    for model in FEW {
        let told = described(model);
        let axes = names(&told, "axes");
        let axes: Vec<&str> = axes.iter().map(String::as_str).collect();
        for kind in LOCI {
            let is_told = names(&told, "loci").iter().any(|name| name == kind);
            let near = kind.starts_with("orbit")
                || ["period-doubling", "torus", "homoclinic"].contains(&kind);
            let ends = |name: &&str| {
                let one = parameter(&told, name);
                let value = number(&one, "/value");
                let [low, high] = match near {
                    true => [0.99 * value, 1.01 * value],
                    false => range(&one),
                };
                format!("{name}={low:e}:{high:e}")
            };
            let plane: Vec<String> = axes.iter().map(ends).collect();
            let points = if near { 3 } else { 5000 };
            let ended = commanded(
                &format!("locus {kind} --format csv -q --max-points {points}"),
                model,
                &[format!("--in={}", plane.join(","))],
            );
            let refused = ended.code == 2 && ended.err.lines().count() == 1;
            let none = ended.err.contains("bifurcation is found");
            // Those of interfaces are not told, as the page would take minutes for them.
            assert!(
                if is_told {
                    ended.code != 2
                } else {
                    refused || none || kind == "homoclinic" && ended.code != 2
                },
                "{model} {kind}: {}",
                ended.err
            );
        }
    }
}
