//! How a fit is told: on a terminal, in messages, on its page.

use super::command::{folder, run};
use crate::common::ROOT;
use std::fs;

const WORDS: &str = "fit tests/data/laboratory/basalt.txt --law slip --intervals linear --to 11690";

/// On a terminal the result is shown, and not thousands of rows.
#[test]
#[cfg(target_os = "linux")]
fn a_terminal_shows_what_was_found() {
    let program = env!("CARGO_BIN_EXE_twinslip");
    let shown = |more: &str| {
        let line = format!("{program} {WORDS} {more}");
        let made = std::process::Command::new("script")
            .current_dir(ROOT)
            .args(["-qec", &line, "/dev/null"])
            .output()
            .expect("`script` of util-linux, which makes a terminal");
        String::from_utf8(made.stdout).expect("UTF-8")
    };
    for more in ["", "-q"] {
        let text = shown(more);
        assert!(text.contains("slip_length = "), "{text}");
        assert!(text.lines().count() < 20, "{} lines", text.lines().count());
    }
    // Rows that are asked for are shown.
    let rows = shown("--format table -q").lines().count();
    assert!(rows > 2246, "{rows} lines");
}

#[test]
fn numbers_have_an_exponent_only_where_they_are_large_or_small() {
    let page = folder("fit_printing").join("fit.html");
    let mut words: Vec<&str> = WORDS.split(' ').collect();
    words.extend([
        "--report",
        page.to_str().expect("a name"),
        "--format",
        "csv",
    ]);
    let ended = run(&words);
    assert_eq!(ended.code, 0, "{}", ended.err);
    let page = fs::read_to_string(page).expect("a page");
    for text in [&ended.err, &ended.out, &page] {
        for odd in ["e0 ", "e-1 ", "e0<", " [1]"] {
            assert!(!text.contains(odd), "{odd:?}");
        }
    }
    let line = ended
        .err
        .lines()
        .find(|line| line.starts_with("slip_length"));
    let line = line.expect("a line");
    assert!(line.contains("e-6 ± ") && line.ends_with("e-6 m"), "{line}");
    assert!(
        page.contains("L [µm]</td><td class=\"value\">8."),
        "the table"
    );
}

#[test]
fn a_normal_stress_without_its_unit_is_not_taken_in_pascals() {
    let folder = folder("fit_stress");
    let text =
        fs::read_to_string(format!("{ROOT}/tests/data/laboratory/basalt.txt")).expect("a record");
    let rows = text.split_once('\n').expect("a header").1;
    let with = |name: &str, header: &str, row: &dyn Fn([f64; 4]) -> String| {
        let cells = |line: &str| {
            let cells: Vec<f64> = line
                .split_whitespace()
                .map(|x| x.parse().expect("it"))
                .collect();
            row([cells[0], cells[1], cells[2], cells[3]])
        };
        let all: Vec<String> = rows.lines().take(2000).map(cells).collect();
        let path = folder.join(name);
        fs::write(&path, format!("{header}\n{}\n", all.join("\n"))).expect("a file");
        path.display().to_string()
    };
    let plain = with(
        "plain.csv",
        "Time_s,Displ_um,Friction,Effective_Normal_stress",
        &|[t, x, mu, sigma]| format!("{t},{x},{mu},{sigma}"),
    );
    let ended = run(&["fit", &plain]);
    assert_eq!(ended.code, 2, "{}", ended.err);
    let says = "column Effective_Normal_stress, states no unit, and would be 19.9";
    assert!(ended.err.contains(says), "{}", ended.err);
    // Beside a shear stress that states its unit there is no doubt.
    let shear = with(
        "shear.csv",
        "Time_s,Displ_um,Shear_stress_MPa,Effective_Normal_stress",
        &|[t, x, mu, sigma]| format!("{t},{x},{},{sigma}", mu * sigma),
    );
    let ended = run(&[
        "fit",
        &shear,
        "--law=slip",
        "--intervals=linear",
        "--format=json",
        "-q",
    ]);
    let object: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
    let sigma = object["model"]["normal_stress"].as_f64().expect("a number");
    assert!((sigma / 2e7 - 1.0).abs() < 1e-2, "{sigma}");
}
