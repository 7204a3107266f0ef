//! Systems, laws, fits and programs whose text stands in the place of a file's name, as other programs give them.

use crate::command;
use crate::common::ROOT;
use command::{Ended, run};
use serde_json::Value;
use std::fs;
use std::path::Path;
use twinslip_tasks::scene::EnsembleFile;

fn text_of(path: &str) -> String {
    fs::read_to_string(Path::new(ROOT).join(path)).expect("a file")
}

/// A command with one more option whose value has any letters.
fn with(arguments: &str, option: &str, value: &str) -> Ended {
    let mut words: Vec<&str> = arguments.split_whitespace().collect();
    words.extend([option, value, "-q"]);
    run(&words)
}

fn made(arguments: &str, option: &str, value: &str) -> Value {
    let ended = with(arguments, option, value);
    assert_eq!(ended.code, 0, "{}", ended.err);
    serde_json::from_str(&ended.out).expect("JSON")
}

#[test]
fn a_text_is_the_system_that_its_file_is() {
    let run = "integrate --until 3 --points 4 --format json";
    let text = text_of("scenes/systems/lorenz.toml");
    let (given, named) = (
        made(run, "--system", &text),
        made(run, "--system", "lorenz"),
    );
    assert_eq!(given["result"], named["result"]);
    assert_eq!(given["model"], named["model"]);
    assert_eq!(given["model"]["system"], "Lorenz");
}

#[test]
fn a_text_is_the_law_that_its_file_is() {
    let text = text_of("scenes/laws/composite.toml");
    for run in [
        "integrate --driving 1 --stiffness 1 --until 3 --points 4 --format json",
        "equilibria --driving 1 --stiffness 1 --format json",
        "law --points 5 --format json",
    ] {
        let (given, named) = (
            made(run, "--law", &text),
            made(run, "--law", "composite.toml"),
        );
        assert_eq!(given["result"], named["result"], "{run}");
        assert_eq!(given["model"], named["model"], "{run}");
    }
}

/// With a number of draws behind it or without, as behind a file's name.
#[test]
fn a_text_is_the_fit_that_its_file_is() {
    let text = text_of("tests/data/fit.json");
    assert!(text.contains('\n'));
    for (command, draws) in [
        ("law --points 2 --format json", ":0"),
        ("law --points 2 --format json", ":20"),
        (
            "branch equilibria --stiffness 1e10 --from 1e-6 --to 1e-5 --format json",
            ":0",
        ),
    ] {
        let (given, named) = (
            made(command, "--ensemble", &format!("{text}{draws}")),
            made(
                command,
                "--ensemble",
                &format!("tests/data/fit.json{draws}"),
            ),
        );
        assert_eq!(given["model"], named["model"], "{command}");
        let mut result = named["result"].clone();
        assert_eq!(result["ensemble"]["file"], "tests/data/fit.json");
        result["ensemble"]["file"] = "(a text)".into();
        assert_eq!(given["result"], result, "{command}");
    }
    let whole = EnsembleFile::parse(&text).expect("a text");
    assert_eq!((whole.draws, &*whole.told()), (None, "(a text)"));
    let drawn = EnsembleFile::parse(&format!("{}\n:7", text.trim_end())).expect("a text");
    assert_eq!((drawn.draws, &*drawn.told()), (Some(7), "(a text)"));
}

#[test]
fn what_is_wrong_with_the_text_of_a_fit_is_said_without_it() {
    let text = text_of("tests/data/fit.json");
    let law = "law --points 2";
    let refused = |command: &str, given: &str, sentence: &str| {
        let ended = with(command, "--ensemble", given);
        assert_eq!(ended.code, 2, "{}", ended.err);
        assert!(ended.err.contains(sentence), "{}", ended.err);
        assert!(!ended.err.contains("correlation"), "{}", ended.err);
    };
    refused(
        law,
        "{\n}",
        "--ensemble (a text): it is not what twinslip fit writes as JSON",
    );
    refused(
        law,
        "none\n",
        "--ensemble (a text): it is not what twinslip fit writes as JSON",
    );
    refused(
        law,
        &format!("{text}:many"),
        "the number of draws is \"many\"",
    );
    refused(law, &format!("{text}:1e7"), "--ensemble \"(a text):1e7\"");
    refused(
        "law --law slip",
        &text,
        "--ensemble (a text) is a fit of the law",
    );
    refused(
        "law --direct-effect 0.01",
        &text,
        "--direct-effect is given, and --ensemble (a text) has it fitted",
    );
    refused(
        "sweep --driving 1e-6:1e-5:2 --stiffness 1e10",
        &format!("{text}:0"),
        "such as (a text):50",
    );
}

#[test]
fn a_text_is_the_program_that_its_file_is() {
    let path = command::folder("text_given_program").join("steps.csv");
    let text = "# a remark: of two changes\ntime, driving, until\n1, 0,\n\n2.5,4,3.5\n";
    fs::write(&path, text).expect("written");
    for run in [
        "integrate --driving 10 --stiffness 0.14 --until 5 --points 11 --format json",
        "integrate --si --driving 1e-5 --stiffness 5e9 --until 5 --points 3 --format json",
        "integrate --interfaces 3 --driving 10 --stiffness 0.14 --until 5 --points 3 --format json",
    ] {
        let (given, named) = (
            made(run, "--program", text),
            made(run, "--program", path.to_str().expect("UTF-8")),
        );
        assert_eq!(given["result"], named["result"], "{run}");
        assert_eq!(given["model"], named["model"], "{run}");
        assert_eq!(given["model"]["program"], "1:0,2.5-3.5:4");
    }
    // Changes on lines of their own have no header, and may have units.
    let run = "integrate --driving 1um/s --stiffness 5e9 --until 5 --final-only --format json";
    let lines = made(run, "--program", "1:0um/s,\n2.5-3.5:4um/s");
    assert_eq!(lines["model"]["program"], "1:0,2.5-3.5:0.000004");
}

#[test]
fn what_is_wrong_with_the_text_of_a_program_is_said_by_line() {
    let run = "integrate --driving 10 --stiffness 0.14 --until 5";
    for (text, sentence) in [
        (
            "time,driving\n1,0\nx,2\n",
            "--program (a text):3: time \"x\" is not a number",
        ),
        (
            "time,driving\n1,0\n9,2\n",
            "--program (a text):3: the time is 9",
        ),
        (
            "time,speed\n1,0\n",
            "a column of --program (a text) is speed",
        ),
        (
            "time\n1\n",
            "--program (a text):1: the column driving is missing",
        ),
        ("time,driving\n", "--program (a text):1: there is no row"),
        ("\n", "--program \"\" must be T:V"),
    ] {
        let ended = with(run, "--program", text);
        assert_eq!(ended.code, 2, "{text:?}: {}", ended.err);
        assert!(ended.err.contains(sentence), "{text:?}: {}", ended.err);
    }
}

#[test]
fn messages_name_the_place_in_the_text_and_not_the_text() {
    let system = "name = \"n\"\nstates = [\"x\"]\n[rates]\nx = \"x + q\"\n";
    let ended = with("integrate --until 1", "--system", system);
    assert_eq!(ended.code, 2, "{}", ended.err);
    assert!(
        ended
            .err
            .starts_with("error: the system:4:10: \"q\" is no state"),
        "{}",
        ended.err
    );
    let law = "slip_rate = \"tau\"\nevolution = \"1 - v*psi*b\"\n";
    let ended = with(
        "integrate --driving 1 --stiffness 1 --until 1",
        "--law",
        law,
    );
    assert!(ended.err.starts_with("error: the law:2:"), "{}", ended.err);
    let text = text_of("scenes/laws/composite.toml");
    let ended = with(
        "equilibria --driving 1 --stiffness 1 --interfaces 4",
        "--law",
        &text,
    );
    assert_eq!(ended.code, 2, "{}", ended.err);
    assert!(
        ended.err.contains("--law (a text) is from a file") && !ended.err.contains("slip_rate"),
        "{}",
        ended.err
    );
    let long = format!("# {}\n", "long ".repeat(1 << 14));
    let ended = with("integrate --until 1", "--system", &long);
    assert_eq!(
        ended.err,
        "error: the system: its text is longer than 65536 bytes\n"
    );
}

#[test]
fn the_remarks_of_rows_have_the_text_on_one_line() {
    let text =
        "name = \"one's \\\\ own\"\nstates = [\"x\"]\n[rates]\nx = \"-x\"\n[start]\nx = 1.0\n";
    let ended = with(
        "integrate --until 1 --points 2 --format csv",
        "--system",
        text,
    );
    assert_eq!(ended.code, 0, "{}", ended.err);
    let command: Vec<&str> = ended
        .out
        .lines()
        .filter(|line| line.starts_with("# command: "))
        .collect();
    let word = r#"--system $'name = "one\'s \\\\ own"\nstates = ["x"]\n[rates]\nx = "-x"\n[start]\nx = 1.0\n'"#;
    assert_eq!(command.len(), 1);
    assert!(command[0].contains(word), "{}", command[0]);
    let rows = command::csv(&ended.out);
    assert_eq!(rows[0], ["time", "x"]);
    assert_eq!(rows.len(), 3);
}

#[test]
fn parts_of_a_sweep_are_joined_of_files_alone() {
    let path = command::folder("text_given_sweep").join("map.csv");
    let file = path.to_str().expect("a path");
    let text = text_of("scenes/systems/roessler.toml");
    let sweep = format!("sweep --surface x=0 --grid c=2.5:3:2 --max-returns 200 -o {file}");
    let ended = with(&sweep, "--system", &text);
    assert_eq!(ended.code, 0, "{}", ended.err);
    let ended = run(&["merge", file, "-o", &format!("{file}.csv")]);
    assert_eq!(ended.code, 2, "{}", ended.err);
    assert!(
        ended
            .err
            .contains("map.csv: its system or law was given as text"),
        "{}",
        ended.err
    );
}
