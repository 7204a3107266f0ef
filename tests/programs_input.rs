//! How loading histories are given, as text, file and scene, and what is told of them.

use crate::command;
use crate::common;
use command::{csv, folder, number, object, refused_in_one_line, run, twinslip};
use common::assert_close;
use proptest::prelude::*;
use serde_json::Value;

fn rows(object: &Value) -> &Vec<Value> {
    object["result"]["rows"].as_array().expect("rows")
}

#[test]
fn a_file_says_what_a_text_says() {
    let place = folder("program");
    let path = place.join("steps.csv");
    std::fs::write(
        &path,
        "# a remark\ntime, driving, until\n1, 0,\n2.5,4,3.5\n\n4,1,\n",
    )
    .expect("written");
    let scene = "integrate --driving 10 --stiffness 0.14 --until 5 --points 11 --program";
    let file = object(&format!("{scene} {}", path.display()));
    let text = object(&format!("{scene} 1:0,2.5-3.5:4,4:1"));
    for made in [&file, &text] {
        let change = |time: f64, until: Option<f64>, driving: f64| serde_json::json!({"time": time, "until": until, "driving": driving});
        assert_eq!(
            made["result"]["program"],
            Value::from(vec![
                change(1.0, None, 0.0),
                change(2.5, Some(3.5), 4.0),
                change(4.0, None, 1.0)
            ])
        );
        assert_eq!(made["model"]["program"], "1:0,2.5-3.5:4,4:1");
    }
    assert_eq!(file["result"], text["result"]);
    let scene_file = place.join("scene.toml");
    let toml = "command = \"integrate\"\ndriving = 10\nstiffness = 0.14\nuntil = 5\npoints = 11\n\
        program = [\"1:0\", \"2.5-3.5:4\", \"4:1\"]\nformat = \"json\"\nquiet = true\n";
    std::fs::write(&scene_file, toml).expect("written");
    let ended = run(&["run", scene_file.to_str().expect("UTF-8")]);
    let scene: Value = serde_json::from_str(&ended.out).expect("JSON");
    assert_eq!(scene["result"], text["result"]);
    let table = csv(&twinslip(&format!(
        "integrate --driving 10 --stiffness 0.14 --until 5 --points 11 --program {}",
        path.display()
    ))
    .out);
    assert_eq!(table[0][10], "driving");
    assert_eq!(table.len() - 1, rows(&file).len());
}

#[test]
fn a_program_in_si_units_is_the_same_run() {
    let stiffness = 0.14 * 0.0349 * 1e6 / 0.9e-6;
    let si = object(&format!(
        "integrate --si --driving 1e-5 --stiffness {stiffness} --program 1.8:0,2.7-4.5:5e-6 --until 5.4 --final-only --rtol 1e-12"
    ));
    let plain = object(
        "integrate --driving 10 --stiffness 0.14 --program 2:0,3-5:5 --until 6 --final-only --rtol 1e-12",
    );
    for (name, unit) in [
        ("stress", 0.0349 * 1e6),
        ("state_1", 1.0),
        ("slip_1", 0.9e-6),
        ("driving", 1e-6),
    ] {
        let path = format!("/result/final/{name}");
        assert_close(number(&si, &path) / unit, number(&plain, &path), 1e-9, name);
    }
    assert_eq!(
        si["result"]["program"][0],
        serde_json::json!({"time": 1.8, "until": null, "driving": 0.0})
    );
}

#[test]
fn broken_programs_are_refused() {
    let scene = "integrate --driving 10 --stiffness 0.14 --until 20 --program";
    for (program, sentence) in [
        ("5", "--program \"5\" must be T:V, for a ramp T1-T2:V"),
        ("=", "must be T:V"),
        ("5:x", "--program \"5:x\": \"x\" is not a number"),
        ("5:1,,7:2", "--program \"\" must be T:V"),
        ("5:nan", "\"nan\" must be a finite number"),
        (
            "5:-1",
            "--program \"5:-1\": the driving velocity is -1, but must be 0 or positive",
        ),
        ("-5:1", "the time is -5, but must be 0 or positive"),
        (
            "5:1,5:2",
            "--program \"5:2\": the time is 5, but must be after 5",
        ),
        ("5:1,4:2", "the time is 4, but must be after 5"),
        ("3-6:1,5:2", "the time is 5, but must be after 6"),
        (
            "6-6:1",
            "the ramp ends at 6, but must end after it begins, at 6",
        ),
        (
            "6-4:1",
            "the ramp ends at 4, but must end after it begins, at 6",
        ),
        (
            "5:1,25:2",
            "the time is 25, but must be at most 20, when the run ends",
        ),
        ("15-25:1", "the time is 25, but must be at most 20"),
        ("1-2-3:4", "\"2-3\" is not a number"),
        ("none.csv", "cannot read none.csv"),
    ] {
        refused_in_one_line(&format!("{scene} {program}"), sentence);
    }
    for (arguments, sentence) in [
        (
            "--stiffness 1 --until 9 --program 2:1",
            "--driving V_H is missing: which velocity",
        ),
        (
            "--stiffness 1 --until 9 --program 0-2:1",
            "--driving V_H is missing: which velocity",
        ),
        (
            "--driving 1 --stiffness 1 --program 2:1",
            "--until T is missing",
        ),
        (
            "--driving -1 --stiffness 1 --until 9 --program 2:1",
            "driving is -1, but must be 0 or positive",
        ),
        (
            "--driving 0 --stiffness 1 --until 9",
            "driving is 0, but must be positive",
        ),
        (
            "--driving 0 --stiffness 1 --until 9 --program 2:1",
            "of which there is none at V_H = 0: give --start TAU,PSI1,PSI2",
        ),
        (
            "--stiffness 1 --until 9 --program 0:0 --interfaces 1",
            "give --start TAU,PSI",
        ),
        (
            "--driving 1 --stiffness 1 --until 9 --program 2:1 --columns drivng",
            "did you mean \"driving\"?",
        ),
        (
            "--si --driving 1 --stiffness 1 --until 9 --program 2:1e305",
            "program is 1e305, but must be a velocity within doubles",
        ),
    ] {
        refused_in_one_line(&format!("integrate {arguments}"), sentence);
    }
    let place = folder("broken-program");
    for (text, sentence) in [
        ("", ":1: the column time is missing"),
        ("time,driving\n", "there is no row"),
        ("time\n1\n", ":1: the column driving is missing"),
        ("time,drivng\n1,2\n", "did you mean \"driving\"?"),
        ("time,driving\n1,2\n3\n", ":3: it is no CSV"),
        (
            "time,driving\n1,2\n3,x\n",
            ":3: driving \"x\" is not a number",
        ),
        (
            "time,driving\n1,2\n\n1,3\n",
            ":4: the time is 1, but must be after 1",
        ),
        ("time,driving,until\n1,2,0.5\n", ":2: the ramp ends at 0.5"),
    ] {
        let path = place.join("steps.csv");
        std::fs::write(&path, text).expect("written");
        refused_in_one_line(&format!("{scene} {}", path.display()), sentence);
    }
}

#[test]
fn the_plan_and_the_picture_tell_of_changes() {
    let scene = "integrate --driving 10 --stiffness 0.14 --until 12 --program 2:0,3-5:4";
    let told = twinslip(&format!("{scene} --explain --final-only"));
    assert!(
        told.err.contains("2 changes, at each of which the integrator restarts; along ramps V_H is an additional variable"),
        "{}",
        told.err
    );
    let place = folder("program-picture");
    let picture = place.join("run.svg");
    let ended = twinslip(&format!("{scene} -q --plot {}", picture.display()));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let drawn = std::fs::read_to_string(picture).expect("a picture");
    for name in [">V<tspan", ">0</", ">to 4</", "#787878"] {
        assert!(drawn.contains(name), "{name}");
    }
}

#[test]
fn the_bound_on_steps_is_that_of_the_whole_run() {
    let told = twinslip(
        "integrate --driving 10 --stiffness 0.14 --program 1:0,2:10,3:5 --until 20 --max-steps 60 --format csv",
    );
    assert_eq!(told.code, 1, "{}", told.err);
    assert!(
        told.err
            .contains("the limit of 60 steps was reached at t = "),
        "{}",
        told.err
    );
    // The rows so far, and one more at each side of a change.
    assert!(csv(&told.out).len() > 60, "{}", told.out);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever is typed: a run, or one sentence and status 2; never a panic.
    #[test]
    fn any_text_is_a_program_or_is_refused(
        parts in prop::collection::vec("[-0-9.:e ,xn]{0,6}(:[0-9]{1,2})?", 0..4),
    ) {
        let text = parts.join(",");
        let program = format!("--program={text}");
        let ended = run(&["integrate", "--driving=10", "--stiffness=0.14", "--until=9", "--final-only", "--max-steps=9999", "-q", "--format=csv", &program]);
        if ended.code == 2 {
            prop_assert!(ended.err.starts_with("error: ") && ended.err.lines().count() == 1, "{}: {}", text, ended.err);
        } else {
            prop_assert!(ended.code == 0 || ended.code == 1, "{}: {}", text, ended.err);
            prop_assert!(!ended.out.contains("NaN") && !ended.out.contains("inf"), "{}", text);
        }
    }
}
