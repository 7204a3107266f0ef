//! Runs as a user meets them: where they write, what they say meanwhile, and that they end.

use crate::command;
use command::{RUN, contents, csv, folder, object, refused, twinslip};
use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};

#[test]
fn every_method_of_this_build_runs() {
    let methods = ["auto", "rodas5p", "rodas4", "rosenbrock23"];
    let sundials: &[&str] = if cfg!(feature = "sundials") {
        &["cvode-bdf", "cvode-adams"]
    } else {
        &[]
    };
    for method in methods.iter().chain(sundials) {
        let made = object(&format!("{RUN} --rtol 1e-6 --method {method}"));
        assert_eq!(made["numerics"]["asked"], *method);
    }
}

#[test]
fn paths_are_tried_before_computing_and_nothing_is_left() {
    let place = folder("paths");
    let missing = place.join("no").join("run.csv");
    refused(&format!("{RUN} -o {}", missing.display()), "cannot write");
    refused(&format!("{RUN} --plot x.png/"), "cannot write x.png/");
    refused(
        &format!("{RUN} --plot {}/no/run.svg", place.display()),
        "cannot write",
    );
    refused(
        &format!("{RUN} -o {}", place.display()),
        "it is a directory",
    );
    // A good path and bad input: no file.
    let good = place.join("run.csv");
    refused(&format!("{RUN} --rtol -1 -o {}", good.display()), "rtol");
    refused(
        &format!(
            "{RUN} --start 10,2,0.1 -o {}",
            place.join("run.json").display()
        ),
        "psi",
    );
    assert_eq!(contents(&place), Vec::<String>::new());
    let same = place.join("same.svg");
    refused(
        &format!("{RUN} -o {0} --plot {0}", same.display()),
        "cannot be both",
    );
}

#[test]
fn files_get_the_format_of_their_extension() {
    let place = folder("formats");
    for (name, begins) in [
        ("a.json", "{"),
        ("a.csv", "# twinslip"),
        ("a.dat", "# twinslip"),
    ] {
        let path = place.join(name);
        let ended = twinslip(&format!("{RUN} -q -o {}", path.display()));
        assert_eq!(
            (ended.code, ended.out.as_str(), ended.err.as_str()),
            (0, "", "")
        );
        let text = std::fs::read_to_string(&path).expect("written");
        assert!(text.starts_with(begins), "{name}: {text}");
    }
    let dash = twinslip(&format!("{RUN} -q -o - --format json"));
    assert!(dash.out.starts_with('{'));
    assert_eq!(contents(&place).len(), 3, "no temporary file is left");
}

#[test]
fn endings_of_other_formats_are_refused() {
    let place = folder("endings");
    let path = |name: &str| place.join(name).display().to_string();
    for (name, hint) in [
        ("run.xlsx", "data is written as .csv or .json, not as .xlsx"),
        ("run.svg", "pictures are drawn by --plot"),
        ("run.parquet", "Parquet is written by sweep alone"),
    ] {
        refused(&format!("{RUN} -o {}", path(name)), hint);
    }
    assert_eq!(contents(&place), Vec::<String>::new());
    // What is said outright holds for any name.
    let named = twinslip(&format!("{RUN} -q --format csv -o {}", path("run.xlsx")));
    assert_eq!(named.code, 0, "{}", named.err);
    let large = twinslip(&format!("{RUN} -q -o {}", path("run.JSON")));
    assert_eq!(large.code, 0, "{}", large.err);
    let text = std::fs::read_to_string(place.join("run.JSON")).expect("written");
    assert!(text.starts_with('{'), "{text}");
}

#[test]
fn talk_goes_to_standard_error() {
    let ended = twinslip(RUN);
    assert_eq!(ended.err.lines().count(), 1, "{}", ended.err);
    assert!(ended.err.contains("steps"), "{}", ended.err);
    assert!(csv(&ended.out)[0][0] == "time");
    assert_eq!(twinslip(&format!("{RUN} -q")).err, "");
}

#[test]
fn a_reader_who_leaves_is_no_error() {
    let mut child = crate::command::program()
        .args("integrate --driving 10 --stiffness 0.14 --until 2000".split(' '))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut first = String::new();
    BufReader::new(child.stdout.take().expect("a pipe"))
        .read_line(&mut first)
        .expect("a line");
    let ended = child.wait_with_output().expect("it ends");
    assert_eq!(ended.status.code(), Some(0));
    assert!(first.starts_with("# twinslip"));
    assert_eq!(String::from_utf8_lossy(&ended.stderr), "");
}

/// The last return before a run comes to rest has a row too, and no next one.
#[test]
fn every_return_has_a_row() {
    let ended = twinslip(
        "section --driving 1 --stiffness 0.45 --interfaces 1 --start near-symmetric:0.3 --skip 0 --returns 200 --format csv",
    );
    assert_eq!(ended.code, 0, "{}", ended.err);
    let rows = ended.out.lines().filter(|line| !line.starts_with('#'));
    // One line is the header.
    let count = rows.count() - 1;
    let said = format!(" {count} returns: steady");
    assert!(count > 9 && ended.err.contains(&said), "{}", ended.err);
}

/// The section of a state is told in the numbers of that state.
#[test]
fn a_state_that_is_not_met_is_told_by_its_logarithm() {
    let ended = twinslip(
        "section --driving 10 --stiffness 0.14 --surface log_state_1=-20 --patience 50 --format csv",
    );
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(ended.err.contains("lies at -20"), "{}", ended.err);
    let si = twinslip(
        "section --si --driving 1e-5 --stiffness 5e9 --surface log_state_1=-20 --patience 50 --format csv",
    );
    assert!(
        si.err.contains("lies at -20;") && si.err.contains(" s: "),
        "{}",
        si.err
    );
}

/// A run that never comes to the surface ends with status 1, says where it has been, and keeps the header.
#[test]
fn a_surface_that_is_not_met_is_told() {
    let ended = twinslip(
        "section --driving 10 --stiffness 0.14 --surface stress=20 --patience 50 --format csv",
    );
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(
        ended.err.contains("no return to the section from t = 0")
            && ended.err.contains("lies at 20"),
        "{}",
        ended.err
    );
    assert!(ended.out.contains("n,time,log_state_1"), "{}", ended.out);
    let explained = twinslip(
        "section --driving 10 --stiffness 0.14 --skip 9 --returns 9 --explain --format csv",
    );
    for line in ["dimension", "section", "returns", "periodicity", "tangents"] {
        assert!(explained.err.contains(line), "{}", explained.err);
    }
}

/// A time to wait that is beyond doubles is the longest one; that the run doesn't end is no wrong input.
#[test]
fn patience_is_finite() {
    let ended = twinslip(
        "section --driving 1.7 --stiffness 2.2250738585072014e-308 --returns 2 --max-steps 1934 --start near-symmetric:0.0085 --format csv -q",
    );
    assert!(
        ended.code != 2 && !ended.err.contains("inf"),
        "{}",
        ended.err
    );
}

/// Nothing is heard of this branch for long; whoever looks at a terminal sees that it is at work.
#[test]
fn a_run_that_is_silent_for_long_shows_that_it_goes_on() {
    let branch = "branch orbits --stiffness 0.1379 --direct-effect 0.00593264152131 --symmetry asymmetric --from 1.49311502447 --to 1.675";
    // It ends with the terminal, or by itself.
    let command = format!("timeout 60 {} {branch}", env!("CARGO_BIN_EXE_twinslip"));
    let mut terminal = Command::new("script")
        .args(["-qec", &command, "/dev/null"])
        .env("TERM", "xterm")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .expect("a terminal by script(1)");
    let shown = terminal.stdout.take().expect("a pipe");
    let (mut seen, mut read) = (Vec::new(), [0; 256]);
    let words = b"looking for the first point";
    let mut shown = BufReader::new(shown);
    while !seen.windows(words.len()).any(|part| part == words) {
        let count = shown.read(&mut read).expect("what is shown");
        assert!(count > 0, "{}", String::from_utf8_lossy(&seen));
        seen.extend_from_slice(&read[..count]);
    }
    terminal.kill().expect("SIGKILL");
    terminal.wait().expect("it ends");
}

/// No orbit is looked for without end: the message names the bound.
#[test]
fn a_search_for_an_orbit_ends() {
    let ended = twinslip("orbit --interfaces 1 --driving 10 --stiffness 1e-6 --crosscheck none");
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(
        ended.err.contains("steps, the limit of a search"),
        "{}",
        ended.err
    );
    // One step in an arc leads nowhere, at once.
    let ended = twinslip("orbit --driving 1.831e-38 --stiffness 0.56 --max-steps 1");
    assert_eq!(ended.code, 1, "{}", ended.err);
    // Where the time to search in is beyond doubles, the message names none.
    let ended = twinslip(
        "orbit --driving 5e-324 --stiffness 0.022 --law bounded --symmetry symmetric --method rodas5p --max-steps 99",
    );
    assert_eq!(ended.code, 1, "{}", ended.err);
    let said = ended
        .err
        .contains("the limit of 99 steps was reached at t = ");
    assert!(said && !ended.err.contains("inf"), "{}", ended.err);
}
