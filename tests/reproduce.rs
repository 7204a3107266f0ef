//! The whole paper by one command: what is made, what is left, and what is kept when a run ends early.

use crate::command;
use command::{contents, csv, folder, run};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

/// Products that take no more than a second together, one of each kind but the scorecard.
const QUICK: &str = "fig03,fig05,fig08";

fn reproduce(out: &Path, more: &[&str]) -> command::Ended {
    let out = out.to_str().expect("UTF-8");
    run(&[&["reproduce", "--out", out], more].concat())
}

fn manifest(out: &Path) -> Value {
    let text = fs::read_to_string(out.join("manifest.json")).expect("a manifest");
    serde_json::from_str(&text).expect("JSON")
}

/// All files but those that tell of times.
fn results(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let timeless = |name: &String| name != "manifest.json" && name != "report.html";
    contents(out)
        .into_iter()
        .filter(timeless)
        .map(|name| {
            let bytes = fs::read(out.join(&name)).expect("a file");
            (name, bytes)
        })
        .collect()
}

/// Every file that the manifest vouches for is there, to the byte, and nothing is half done.
fn whole(out: &Path) -> usize {
    let manifest = manifest(out);
    let products = manifest["products"].as_object().expect("products");
    for product in products.values() {
        for file in product["files"].as_array().expect("files") {
            let name = file["name"].as_str().expect("a name");
            let bytes = fs::read(out.join(name)).expect("a file");
            assert_eq!(file["bytes"], bytes.len(), "{name}");
            let hash = twinslip_paper::hash(&bytes);
            assert_eq!(file["sha256"], hash, "{name}");
        }
    }
    let left = contents(out);
    assert!(!left.iter().any(|name| name.ends_with(".tmp")), "{left:?}");
    products.len()
}

#[test]
fn only_what_is_asked_for_is_made_and_told_in_the_report() {
    let out = folder("reproduce-only");
    let ended = reproduce(&out, &["--only", "fig14,5"]);
    assert_eq!(ended.code, 0, "{}", ended.err);
    let mut files = contents(&out);
    files.sort();
    let expected = [
        "fig05.csv",
        "fig05.svg",
        "fig14.csv",
        "fig14.svg",
        "manifest.json",
        "report.html",
    ];
    assert_eq!(files, expected);
    let report = fs::read_to_string(out.join("report.html")).expect("a report");
    for words in ["id=\"fig05\"", "id=\"fig14\"", "fig14.csv", "fig05.csv"] {
        assert!(report.contains(words), "{words}");
    }
    assert!(!report.contains("id=\"fig06\""));
    // The angle reaches pi at the end of the curve, and the CSV has it.
    let rows = csv(&fs::read_to_string(out.join("fig14.csv")).expect("rows"));
    let angle = rows[0].iter().position(|name| name == "angle_over_pi");
    let angle = angle.expect("a column");
    let largest = rows[1..]
        .iter()
        .filter_map(|row| row[angle].parse::<f64>().ok())
        .fold(0.0, f64::max);
    assert!((largest - 1.0).abs() < 1e-6, "{largest}");
}

/// Folds along V_H at one c_2 and K are those of the curves in the plane of V_H and c_2 at another K, which end at the cusps known.
#[test]
fn the_unfolded_pitchforks_are_made_beside_both_figures() {
    let out = folder("reproduce-unfolded");
    let ended = reproduce(&out, &["--only", "5-unfolded,fig06-unfolded"]);
    assert_eq!(ended.code, 0, "{}", ended.err);
    let special = |id: &str, label: &str, columns: &[&str]| -> Vec<Vec<f64>> {
        let text = fs::read_to_string(out.join(format!("{id}.csv"))).expect("rows");
        let rows = csv(&text);
        let place = |name: &str| {
            let place = rows[0].iter().position(|known| known == name);
            place.unwrap_or_else(|| panic!("no column {name}"))
        };
        let (part, of) = (place("part"), place("label"));
        let chosen = rows[1..].iter();
        let chosen = chosen.filter(|row| row[part].starts_with("special") && row[of] == label);
        let number = |row: &Vec<String>, name: &&str| row[place(name)].parse().expect("a number");
        let numbers = |row| columns.iter().map(|name| number(row, name)).collect();
        chosen.map(numbers).collect()
    };
    let sorted = |rows: Vec<Vec<f64>>| {
        let mut first: Vec<f64> = rows.into_iter().map(|row| row[0]).collect();
        first.sort_by(f64::total_cmp);
        first
    };
    let along = sorted(special("fig05-unfolded", "LP", &["driving"]));
    let landed = special("fig06-unfolded", "UZ", &["driving", "residual_strength_2"]);
    assert!(landed.iter().all(|at| at[1] == 1.2e-3), "{landed:?}");
    let landed = sorted(landed);
    assert_eq!((along.len(), landed.len()), (4, 4));
    for (a, b) in along.iter().zip(&landed) {
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
    let cusps = sorted(special("fig06-unfolded", "CP", &["driving"]));
    let known: Value = serde_json::from_str(include_str!("data/unequal.json")).expect("JSON");
    let mut exact: Vec<f64> = (0..2)
        .map(|i| known["cusps_VH_c2"][i]["V_H"].as_str().expect("digits"))
        .map(|digits| digits.parse().expect("a number"))
        .collect();
    exact.sort_by(f64::total_cmp);
    assert_eq!(cusps.len(), 2);
    for (found, exact) in cusps.iter().zip(&exact) {
        assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
    }
    let report = fs::read_to_string(out.join("report.html")).expect("a report");
    assert!(report.contains("Figure\u{a0}5, unfolded"));
    assert!(report.contains("id=\"fig06-unfolded\""));
}

#[test]
fn what_stands_is_not_made_again_and_what_is_damaged_is_mended() {
    let out = folder("reproduce-mend");
    assert_eq!(reproduce(&out, &["--only", QUICK]).code, 0);
    let before = results(&out);
    let again = reproduce(&out, &["--only", QUICK]);
    assert_eq!(again.code, 0);
    assert!(
        again.err.contains("not made again: fig03, fig05, fig08"),
        "{}",
        again.err
    );
    assert!(again.err.contains("\n0 made"), "{}", again.err);
    // Deleted, cut, and changed in one byte.
    fs::remove_file(out.join("fig03.csv")).expect("removed");
    let mended = reproduce(&out, &["--only", QUICK]);
    assert!(
        mended.err.contains("not made again: fig05, fig08"),
        "{}",
        mended.err
    );
    assert_eq!(results(&out), before);
    let path = out.join("fig05.csv");
    let mut bytes = fs::read(&path).expect("rows");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&path, &bytes).expect("written");
    fs::write(out.join("fig08.svg"), "<svg>").expect("written");
    let mended = reproduce(&out, &["--only", QUICK]);
    assert!(
        mended.err.contains("not made again: fig03\n"),
        "{}",
        mended.err
    );
    assert_eq!(results(&out), before);
    // A manifest that can't be read vouches for nothing.
    fs::write(out.join("manifest.json"), "{").expect("written");
    assert!(reproduce(&out, &["--only", "fig05"]).err.contains("1 made"));
    assert!(
        reproduce(&out, &["--only", "fig05", "--force"])
            .err
            .contains("1 made")
    );
    assert_eq!(results(&out), before);
}

#[test]
fn results_do_not_depend_on_threads_or_company() {
    let [one, two, alone] = ["1", "2", "alone"].map(|n| folder(&format!("reproduce-threads-{n}")));
    let list = "fig03,fig05,fig07,fig08,fig10";
    for (out, threads) in [(&one, "1"), (&two, "2")] {
        let ended = reproduce(out, &["--only", list, "--threads", threads, "--png"]);
        assert_eq!(ended.code, 0, "{}", ended.err);
    }
    let together = results(&one);
    assert_eq!(together, results(&two));
    assert_eq!(together.len(), 15);
    let out = alone.to_str().expect("UTF-8");
    assert_eq!(run(&["figure", "7", "--out", out, "-q"]).code, 0);
    for name in ["fig07.csv", "fig07.svg"] {
        assert_eq!(
            fs::read(alone.join(name)).expect("a file"),
            together[name],
            "{name}"
        );
    }
    let mut files = contents(&alone);
    files.sort();
    assert_eq!(files, ["fig07.csv", "fig07.svg"]);
}

#[test]
fn figures_may_be_called_as_people_do() {
    let out = folder("figure-names");
    let place = out.to_str().expect("UTF-8");
    for name in ["5", "fig05", "Fig05", "Fig. 5"] {
        let ended = run(&["figure", name, "--out", place, "-q"]);
        assert_eq!(ended.code, 0, "{name}: {}", ended.err);
        fs::remove_file(out.join("fig05.csv")).expect("made");
        fs::remove_file(out.join("fig05.svg")).expect("made");
    }
    assert_eq!(run(&["figure", "fig9x", "--out", place]).code, 2);
    assert!(contents(&out).is_empty());
}

#[test]
fn pieces_tell_what_they_do_and_how_far_they_are() {
    use std::sync::Mutex;
    use std::sync::atomic::AtomicBool;
    use twinslip_paper::{Product, Reached, RunEvent, Selection, reproduce};
    let order = Selection {
        out: folder("reproduce-told"),
        products: Product::listed("fig03,fig05").expect("products"),
        force: false,
        png: false,
        report: false,
        command: |product| product.id.to_owned(),
        threads: Some(2),
        machine: BTreeMap::new(),
        program: String::new(),
    };
    let told = Mutex::new(Vec::new());
    let hear = |what: RunEvent<'_>| {
        let words = match what {
            RunEvent::Begun { products, pieces } => format!("begun {products} {pieces}"),
            RunEvent::Piece(going) => {
                let so_far = match going.reached {
                    Reached::Whole => "whole".to_owned(),
                    other => format!("{other:?}"),
                };
                format!("{} {} {so_far}", going.scene, going.what)
            }
            RunEvent::Making(product) => format!("making {}", product.id),
            RunEvent::Made(product, _) => format!("made {}", product.id),
        };
        told.lock().expect("no panic").push(words);
    };
    let done = reproduce(&order, &AtomicBool::new(false), &hear).expect("done");
    assert_eq!(done.made.len(), 2);
    let told = told.into_inner().expect("no panic");
    assert_eq!(told[0], "begun 2 3");
    let at = |words: &str| {
        let found = told.iter().position(|one| one == words);
        found.unwrap_or_else(|| panic!("no {words} in {told:?}"))
    };
    // Each point of a branch is told, then its end, then what is made of it.
    let order = [
        "fig05 branches of equilibria Points(0)",
        "fig05 branches of equilibria Points(1)",
        "fig05 branches of equilibria Points(20)",
        "fig05 branches of equilibria whole",
        "making fig05",
        "made fig05",
    ];
    assert!(order.map(at).is_sorted(), "{told:?}");
    for scene in ["fig03a", "fig03b"] {
        let begun = at(&format!("{scene} a run in time Percent(0)"));
        let ended = at(&format!("{scene} a run in time whole"));
        let within = told[begun..ended].iter();
        let steps = within.filter(|one| one.starts_with(&format!("{scene} a run in time Percent")));
        assert!((3..=101).contains(&steps.count()), "{told:?}");
        assert!(ended < at("making fig03"));
    }
}

/// Last digits depend on the vector instructions: what was made with others is not vouched for, and the manifest says which.
#[test]
fn vectors_are_in_the_manifest_and_decide_what_stands() {
    let out = folder("reproduce-vectors");
    let made = |vectors: &str| {
        let ended = crate::command::program()
            .args(["reproduce", "--only", "fig05", "--out"])
            .arg(&out)
            .env("TWINSLIP_VECTORS", vectors)
            .output()
            .expect("it runs");
        let err = String::from_utf8(ended.stderr).expect("UTF-8");
        assert!(ended.status.success(), "{err}");
        err
    };
    assert!(made("none").contains("1 made"));
    assert_eq!(manifest(&out)["machine"]["vectors"], "none");
    assert!(made("none").contains("0 made"));
    let all = twinslip::integrate::used_vectors().name();
    let again = made("avx512");
    assert_eq!(again.contains("1 made"), all != "none", "{again}");
    assert_eq!(manifest(&out)["machine"]["vectors"], all);
    let report = fs::read_to_string(out.join("report.html")).expect("a report");
    assert!(report.contains("TWINSLIP_VECTORS"));
}

#[test]
fn wrong_orders_are_refused_in_one_sentence() {
    let out = folder("reproduce-wrong");
    let file = out.join("file");
    fs::write(&file, "").expect("written");
    let path = file.to_str().expect("UTF-8");
    for (words, sentence) in [
        (
            vec!["reproduce", "--only", "fig18", "--out", path],
            "figure is fig18, but must be one of fig01",
        ),
        (
            vec!["reproduce", "--only", "", "--out", path],
            "figure is \"\", but must be one of fig01",
        ),
        (
            vec!["reproduce", "--threads", "0", "--out", path],
            "threads is 0, but must be at least 1",
        ),
        (vec!["reproduce", "--out", path], "cannot create"),
        (
            vec!["figure", "18"],
            "figure is 18, but must be one of fig01",
        ),
        (
            vec!["reproduce", "--only", "scorcard", "--out", path],
            "did you mean \"scorecard\"?",
        ),
    ] {
        let ended = run(&words);
        assert_eq!(ended.code, 2, "{words:?}: {}", ended.err);
        assert!(ended.err.contains(sentence), "{words:?}: {}", ended.err);
        assert_eq!(ended.err.lines().count(), 1, "{}", ended.err);
    }
    assert_eq!(contents(&out), ["file"]);
}

/// A limit on the size of files stands for a full disk: writing fails in the midst of a file.
#[test]
fn a_full_disk_is_one_error_and_leaves_no_half_file() {
    let out = folder("reproduce-full");
    let script = format!(
        "trap '' XFSZ; ulimit -f 60; exec {} reproduce --only fig05,fig08 --out {}",
        env!("CARGO_BIN_EXE_twinslip"),
        out.display()
    );
    let ended = Command::new("bash")
        .args(["-c", &script])
        .output()
        .expect("bash");
    let err = String::from_utf8(ended.stderr).expect("UTF-8");
    assert_eq!(ended.status.code(), Some(2), "{err}");
    let errors: Vec<&str> = err
        .lines()
        .filter(|line| line.starts_with("error"))
        .collect();
    assert_eq!(errors.len(), 1, "{err}");
    assert!(
        errors[0].contains("cannot write") && errors[0].contains("large"),
        "{err}"
    );
    let left = contents(&out);
    assert!(!left.iter().any(|name| name.ends_with(".tmp")), "{left:?}");
    assert!(!left.contains(&"fig08.csv".to_owned()), "{left:?}");
    // What was small enough is whole, and the next run makes the rest.
    if out.join("manifest.json").exists() {
        whole(&out);
    }
    assert_eq!(reproduce(&out, &["--only", "fig05,fig08"]).code, 0);
    assert_eq!(whole(&out), 2);
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_what_is_finished_complete() {
    let out = folder("reproduce-interrupted");
    let mut child = crate::command::program()
        .args(["reproduce", "--only", "fig03,fig05,fig14"])
        .args(["--out", out.to_str().expect("UTF-8")])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the program starts");
    // As soon as something is finished, and long before all is.
    let begun = std::time::Instant::now();
    while !out.join("manifest.json").exists() {
        assert!(
            begun.elapsed() < Duration::from_secs(600),
            "nothing was finished"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .expect("kill");
    assert!(killed.success());
    let status = child.wait().expect("it ends");
    assert_eq!(status.code(), Some(130));
    let finished = whole(&out);
    assert!((1..3).contains(&finished), "{finished}");
}
