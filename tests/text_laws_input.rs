//! What the commands take, draw and refuse of user-defined friction laws from files.

use crate::command;
use crate::common::ROOT;
use crate::common::text::{law, near};
use command::{folder, number, object, refused_in_one_line, run, twinslip};
use serde_json::Value;
use std::fs;
use std::path::Path;

#[test]
fn parameters_are_set_by_flags_and_by_name() {
    let file = law("spinodal");
    let end = |options: &str| {
        let made = object(&format!(
            "integrate {options} --driving 1 --stiffness 0.5 --until 1 --final-only --rtol 1e-14 --method taylor"
        ));
        number(&made, "/result/final/stress")
    };
    let known = end("--law spinodal --residual-strength 0.003");
    for options in [
        "--residual-strength 0.003",
        "--set residual_strength=0.003",
        "--set residual_strength_1=0.003,residual_strength_2=0.003",
    ] {
        near(end(&format!("--law {file} {options}")), known, 1e-12);
    }
    // A scene names its law from where it stands. Not in `scenes`, which is compiled into the program: all would be built anew.
    let place = folder("law_beside_a_scene");
    fs::copy(Path::new(ROOT).join(&file), place.join("spinodal.toml")).expect("a copy");
    let scene = place.join("scene.toml");
    let text = "command = \"integrate\"\nlaw = \"spinodal.toml\"\ndriving = 1\nset = { stiffness = 0.5 }\nuntil = 1\nfinal-only = true\nformat = \"json\"\n";
    fs::write(&scene, text).expect("a file");
    let ended = run(&["run", scene.to_str().unwrap(), "-q"]);
    assert_eq!(ended.code, 0, "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    near(
        number(&made, "/result/final/stress"),
        end("--law spinodal"),
        1e-6,
    );
}

#[test]
fn pictures_of_runs_and_curves_are_drawn() {
    let place = folder("law_pictures");
    let file = law("spinodal");
    for (command, name) in [
        (
            format!("integrate --law {file} --driving 1 --stiffness 0.5 --until 2 --program 1:2"),
            "run.svg",
        ),
        (format!("law --law {file}"), "law.svg"),
        (
            format!("section --law {file} --driving 10 --stiffness 0.14 --returns 5 --skip 0"),
            "map.svg",
        ),
    ] {
        let path = place.join(name);
        let ended = twinslip(&format!("{command} -q --plot {}", path.display()));
        assert!([0, 3].contains(&ended.code), "{command}: {}", ended.err);
        let picture = fs::read_to_string(&path).expect("a picture");
        assert!(
            picture.starts_with("<svg") && picture.len() > 2000,
            "{name}"
        );
    }
}

/// A run of this text as a law: status and standard error.
fn broken(text: &str) -> (i32, String) {
    let path = folder("law_broken").join("law.toml");
    fs::write(&path, text).expect("a file");
    let path = path.to_str().expect("a path");
    let ended = run(&[
        "integrate",
        "--law",
        path,
        "--driving",
        "1",
        "--stiffness",
        "1",
        "--until",
        "1e-3",
        "--final-only",
    ]);
    assert_eq!(ended.out, "");
    (ended.code, ended.err)
}

#[test]
fn broken_files_are_told_in_one_sentence() {
    let good = "slip_rate = \"g*sinh(tau)/psi^beta\"\nevolution = \"1 - v*psi\"\n[parameters]\ng = 1e-4\nbeta = 1.4\n";
    let changed = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        good.replacen(from, to, 1)
    };
    let cases = [
        (
            changed("slip_rate", "sliprate"),
            "1:1: unknown key \"sliprate\", there are name, slip_rate, evolution, parameters, where; did you mean \"slip_rate\"?",
        ),
        (
            changed("evolution = \"1 - v*psi\"\n", ""),
            "1:1: the key evolution is missing: at which rate does the state change, in v and psi?",
        ),
        (
            changed("slip_rate = \"g*sinh(tau)/psi^beta\"\n", ""),
            "1:1: the key slip_rate is missing",
        ),
        (
            changed("g*sinh(tau)", "g*sinh(v)"),
            "1:21: \"v\" has no value in what this formula is part of, which is in tau and psi",
        ),
        (
            changed("1 - v*psi", "1 - tau*psi"),
            "2:18: \"tau\" has no value in what this formula is part of, which is in psi and v",
        ),
        (
            changed("psi^beta", "psi^betta"),
            "1:30: \"betta\" is no state, no parameter and not defined in [where]; did you mean \"beta\"?",
        ),
        (
            changed("1 - v*psi", "1 - v psi"),
            "2:20: `p` stands where an operator is expected; products need `*`",
        ),
        (
            changed("\"1 - v*psi\"", "3"),
            "2:13: a formula is a text in quotes, not integer",
        ),
        (
            changed("beta = 1.4", "beta = 1.4\ndriving = 3"),
            "6:1: no parameter of a law can be called driving",
        ),
        (
            changed("beta = 1.4", "beta = 1.4\nslip_rate_1 = 3"),
            "6:1: no parameter of a law can be called slip_rate_1",
        ),
        (
            changed("beta = 1.4", "beta = 1.4\npsi = 3"),
            "6:1: \"psi\" is given twice",
        ),
        (
            changed("beta = 1.4", "beta = inf"),
            "5:8: inf is not a finite number",
        ),
        (
            changed("beta = 1.4", "beta = 1.4\n[where]\nx = \"y\"\ny = \"x\""),
            "\"x\" is defined by",
        ),
        (String::new(), "1:1: the key slip_rate is missing"),
        ("slip_rate = ".into(), "1:"),
    ];
    for (text, sentence) in cases {
        let (code, err) = broken(&text);
        assert_eq!(code, 2, "{text}: {err}");
        assert!(
            err.starts_with("error: ") && err.lines().count() == 1,
            "{err}"
        );
        assert!(err.contains(sentence), "{err} for {sentence}");
    }
}

#[test]
fn what_has_no_meaning_for_a_law_from_a_file_is_refused() {
    let file = folder("law_refused").join("law.toml");
    let text = "slip_rate = \"1e-4*sinh(tau)/psi^1.4\"\nevolution = \"1 - v*psi\"\n";
    fs::write(&file, text).expect("a file");
    let file = file.display();
    let run = format!("integrate --law {file} --driving 1 --stiffness 1 --until 1");
    for (arguments, sentence) in [
        (
            format!("{run} --healing-time 3"),
            "is from a file, and has no parameter healing_time",
        ),
        (
            format!("{run} --damping -0.1"),
            "damping is -0.1, but must be zero or positive, and finite",
        ),
        (
            format!("{run} --set damping=-0.1"),
            "damping is -0.1, but must be zero or positive, and finite",
        ),
        (format!("{run} --si"), "whose numbers have no units"),
        (format!("{run} --interfaces 9"), "at most 7 interfaces"),
        (
            format!("{run} --set beta=3"),
            "--set: no parameter `beta`; known are driving, stiffness",
        ),
        (
            format!("{run} --clusters 1,1,1 --events --format json"),
            "or of three and more with a built-in law",
        ),
        (
            format!("{run} --start 1,2"),
            "must be TAU,PSI1,PSI2, near-symmetric[:EPS]",
        ),
        (format!("{run} --start 1,2,-1"), "psi in --start"),
        (
            format!("integrate --law {file} --stiffness 1 --until 1"),
            "--driving V_H is missing",
        ),
        (
            format!("orbit --law {file} --driving 1"),
            "--stiffness K is missing",
        ),
        (
            format!("equilibria --law {file} --driving 1 --stiffness 1 --box stress=0:1"),
            "has no range of log_state_1",
        ),
        (
            "integrate --law nowhere.toml --driving 1 --stiffness 1 --until 1".into(),
            "nowhere.toml",
        ),
        (
            "equilibria --driving 1 --box stress=0:1".into(),
            "limits the search for steady states of a",
        ),
    ] {
        refused_in_one_line(&arguments, sentence);
    }
    // Of a slip rate that rises otherwise with the stress no closed equation is known.
    let path = folder("law_refused").join("cubic.toml");
    let text = "slip_rate = \"tau^3/psi\"\nevolution = \"1 - abs(v)*psi\"\n";
    fs::write(&path, text).expect("a file");
    refused_in_one_line(
        &format!("law --law {} --damping 0.1", path.display()),
        "must be a factor times sinh or exp of a multiple of tau",
    );
    // A law that does not weaken as the laws here do may have no steady state.
    let path = folder("law_refused").join("none.toml");
    fs::write(
        &path,
        "slip_rate = \"sinh(tau)\"\nevolution = \"1 + psi\"\n",
    )
    .expect("a file");
    let ended = twinslip(&format!("law --law {}", path.display()));
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(
        ended.err.contains("the steady state of the law"),
        "{}",
        ended.err
    );
}
