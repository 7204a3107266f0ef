//! Extremes on the command line end in a right answer or a typed error: never a panic, a hang or a number that isn't one.
//! "Right" is what two unlike methods agree on.

use crate::command;
use command::twinslip;
use serde_json::Value;

const STIFFNESSES: [&str; 3] = ["1e-6", "1", "1e4"];
const DRIVINGS: [&str; 3] = ["1e-8", "1", "1e8"];
const STARTS: [&str; 6] = [
    "-50,0.5,1e-3",
    "500,0.5,1e-3",
    "10,1e-300,1",
    "0,1,1",
    "500,1e-300,1e-300",
    "-50,1,1e-300",
];

/// The end (tau, w1, w2), or the exit status and the sentence.
fn end(
    method: &str,
    driving: &str,
    stiffness: &str,
    start: &str,
) -> Result<[f64; 3], (i32, String)> {
    // 200,000 steps bound the work, and a thousandth of the time in which the spring reaches its stress bounds the run
    let until =
        1e-3 / (driving.parse::<f64>().unwrap() * stiffness.parse::<f64>().unwrap()).max(1e-3);
    let ended = twinslip(&format!(
        "integrate --driving {driving} --stiffness {stiffness} --start={start} --until {until} --method {method} \
         --max-steps 200000 --columns time,stress,log_state_1,log_state_2 --final-only --format json"
    ));
    assert!(!ended.err.contains("panicked"), "{}", ended.err);
    let object: Value = serde_json::from_str(&ended.out).expect("JSON in any case");
    if ended.code != 0 {
        assert!(object["error"].is_string(), "{object}");
        return Err((ended.code, ended.err));
    }
    Ok(["stress", "log_state_1", "log_state_2"].map(|name| {
        let value = object["result"]["final"][name].as_f64();
        value.filter(|x| x.is_finite()).expect("a finite number")
    }))
}

#[test]
fn runs_end_right_or_say_why_not() {
    let methods: &[&str] = if cfg!(feature = "sundials") {
        &["rodas5p", "cvode-bdf"]
    } else {
        &["rodas5p", "rodas4"]
    };
    let mut answered = 0;
    for stiffness in STIFFNESSES {
        for driving in DRIVINGS {
            for start in STARTS {
                let what = format!("K = {stiffness}, V_H = {driving}, start {start}");
                let mut ends = Vec::new();
                for method in methods {
                    match end(method, driving, stiffness, start) {
                        Ok(y) => ends.push(y),
                        Err((code, words)) => {
                            assert_eq!(code, 1, "{what}, {method}: {words}");
                            assert!(words.contains("error: "), "{what}: {words}");
                        }
                    }
                }
                if let [first, second] = ends[..] {
                    answered += 1;
                    for i in 0..3 {
                        let off = (first[i] - second[i]).abs() / (1.0 + first[i].abs());
                        assert!(off < 1e-5, "{what}: {first:?} against {second:?}");
                    }
                }
            }
        }
    }
    // most of these have an answer: all errors would be no answer at all
    assert!(
        answered >= 50,
        "only {answered} of 54 runs were answered by both methods"
    );
}

#[test]
fn equilibria_are_found_or_said_to_be_undecided() {
    for law in [
        "spinodal",
        "bounded",
        "regularised-ageing",
        "dieterich-ruina",
        "slip",
    ] {
        for driving in ["1e-8", "0.05", "1e8"] {
            for stiffness in STIFFNESSES {
                let ended = twinslip(&format!(
                    "equilibria --law {law} --driving {driving} --stiffness {stiffness} --format json"
                ));
                assert!(ended.code == 0 || ended.code == 3, "{law}: {}", ended.err);
                let object: Value = serde_json::from_str(&ended.out).expect("JSON");
                let states = object["result"]["equilibria"].as_array().expect("a list");
                assert!(!states.is_empty());
                for state in states {
                    let stress = &state["stress"];
                    assert!(
                        stress["value"].is_number() && stress["uncertainty"].is_number(),
                        "{law}: {stress}"
                    );
                }
            }
        }
    }
}
