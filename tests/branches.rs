//! `branch` and `locus` as a user meets them: reference points in the output, formats, resumption, refusals.

use crate::command;
use command::{csv, folder, number, object, refused_in_one_line as refused, run, twinslip};
use serde_json::Value;
#[cfg(unix)]
use std::{
    process::{Command, Stdio},
    time::Duration,
};

const EQUILIBRIA: &str = "branch equilibria --stiffness 0.14";

/// A file of references; its numbers are texts of more digits than a double holds.
fn reference(name: &str) -> Value {
    let text = match name {
        "hopf" => include_str!("data/hopf.json"),
        "steady_states" => include_str!("data/steady_states.json"),
        "orbit_bifurcations" => include_str!("data/orbit_bifurcations.json"),
        other => panic!("no reference {other}"),
    };
    serde_json::from_str(text).expect("JSON")
}

fn digits(value: &Value, path: &str) -> f64 {
    let text = value.pointer(path).and_then(Value::as_str);
    let text = text.unwrap_or_else(|| panic!("{path} is no text"));
    text.parse().expect("a number")
}

/// The special points with a label.
fn special<'a>(made: &'a Value, label: &str) -> Vec<&'a Value> {
    let list = made["result"]["special"].as_array().expect("a list");
    list.iter().filter(|one| one["label"] == label).collect()
}

/// Whether one of these points lies at V_H within 1e-10, relatively, and the truth within its error budget.
fn listed<'a>(points: &[&'a Value], driving: f64) -> &'a Value {
    /// Roundings of the reference to a double, and of the parameters, which are doubles of decimals.
    const ROUNDINGS: f64 = 1e-13;
    let near = |one: &&&Value| (number(one, "/driving/value") / driving - 1.0).abs() < 1e-10;
    let found = points
        .iter()
        .find(near)
        .unwrap_or_else(|| panic!("nothing at V_H = {driving} in {points:#?}"));
    let off = (number(found, "/driving/value") - driving).abs();
    let budget = number(found, "/driving/uncertainty");
    assert!(
        off <= budget + ROUNDINGS * driving,
        "{off:e} off at {driving}, {budget:e} claimed"
    );
    found
}

fn hopf(stiffness: &str, symmetry: &str) -> Vec<f64> {
    let list = reference("hopf")["points"][stiffness][symmetry].clone();
    let list = list.as_array().expect("a list");
    list.iter().map(|point| digits(point, "/V_H")).collect()
}

#[test]
fn the_bifurcations_of_equilibria_are_the_reference_ones() {
    let made = object(EQUILIBRIA);
    let constants = reference("steady_states")["constants"].clone();
    for name in ["/2V_M", "/2V_m"] {
        listed(&special(&made, "BP"), digits(&constants, name));
    }
    listed(&special(&made, "LP"), digits(&constants, "/V_sn_fold"));
    let found = special(&made, "HB");
    for driving in ["sym", "asym"].iter().flat_map(|s| hopf("0.14", s)) {
        let one = listed(&found, driving);
        assert_eq!(one["criticality"], "supercritical", "{one}");
        assert_eq!(one["name"], "Hopf");
    }
    // Of one symmetry alone.
    for (symmetry, there, absent) in [("symmetric", "sym", "asym"), ("asymmetric", "asym", "sym")] {
        let made = object(&format!("{EQUILIBRIA} --symmetry {symmetry}"));
        let found = special(&made, "HB");
        for driving in hopf("0.14", there) {
            listed(&found, driving);
        }
        for driving in hopf("0.14", absent) {
            let near = |one: &&Value| (number(one, "/driving/value") / driving - 1.0).abs() < 1e-6;
            assert!(!found.iter().any(near), "{driving} is not {symmetry}");
        }
    }
}

/// Rows at values asked for agree with `equilibria`, which solves at one V_H at a time.
#[test]
fn a_branch_lands_on_values_and_agrees_with_single_solutions() {
    let made = object(&format!("{EQUILIBRIA} --at 0.1,1,10"));
    let rows = made["result"]["rows"].as_array().expect("rows");
    for driving in [0.1, 1.0, 10.0] {
        let single = object(&format!("equilibria --driving {driving} --stiffness 0.14"));
        let list = single["result"]["equilibria"].as_array().expect("a list");
        let there: Vec<&Value> = rows
            .iter()
            .filter(|row| row["label"] == "UZ" && row["driving"] == driving)
            .collect();
        assert_eq!(there.len(), list.len(), "V_H = {driving}");
        for one in list {
            let stress = number(one, "/stress/value");
            let near = |row: &&&Value| (number(row, "/stress") / stress - 1.0).abs() < 1e-10;
            let row = there.iter().find(near).expect("the same state");
            assert_eq!(row["verdict"], one["verdict"], "V_H = {driving}");
            assert_eq!(row["stress_min"], row["stress_max"]);
        }
    }
}

#[test]
fn the_bifurcations_of_orbits_are_the_reference_ones() {
    let made = object(
        "branch orbits --stiffness 0.14 --symmetry asymmetric --from 0.05 --to 0.15 --crosscheck",
    );
    let list = reference("orbit_bifurcations")["K=0.14"].clone();
    for one in list.as_array().expect("a list") {
        let label = one["type"].as_str().expect("a text");
        let found = listed(&special(&made, label), digits(one, "/V_H"));
        let period = number(found, "/period/value") / digits(one, "/period") - 1.0;
        assert!(period.abs() < 1e-9, "{label}: the period is {period:e} off");
        // An unlike method on its own trajectories.
        if let Some(off) = found.pointer("/crosscheck/driving_difference") {
            assert!(off.as_f64().is_some_and(|off| off.abs() < 1e-6), "{found}");
        }
    }
    let single = object("orbit --driving 0.07 --stiffness 0.14 --symmetry asymmetric");
    let landed = object(
        "branch orbits --stiffness 0.14 --symmetry asymmetric --from 0.05 --to 0.075 --at 0.07",
    );
    let rows = landed["result"]["rows"].as_array().expect("rows");
    let row = rows.iter().find(|row| row["driving"] == 0.07).expect("UZ");
    let ratio = number(row, "/period") / number(&single, "/result/orbit/period/value");
    assert!((ratio - 1.0).abs() < 1e-8, "{ratio}");
    assert_eq!(
        (&row["label"], &row["verdict"]),
        (&"UZ".into(), &"stable".into())
    );
}

#[test]
fn a_curve_of_hopf_points_passes_the_reference_ones() {
    let made = object("locus hopf --at-stiffness 0.05,0.14 --criticality");
    let found = special(&made, "UZ");
    for stiffness in ["0.05", "0.14"] {
        let k: f64 = stiffness.parse().expect("a number");
        let there: Vec<&Value> = found
            .iter()
            .copied()
            .filter(|one| (number(one, "/stiffness/value") / k - 1.0).abs() < 1e-12)
            .collect();
        for driving in ["sym", "asym"].iter().flat_map(|s| hopf(stiffness, s)) {
            listed(&there, driving);
        }
    }
    let rows = made["result"]["rows"].as_array().expect("rows");
    assert!(rows.iter().any(|row| row["criticality"] == "supercritical"));
}

#[test]
fn a_curve_of_torus_points_has_its_resonances() {
    let made = object("locus torus --stiffness-range 0.03,0.3 --at-stiffness 0.14");
    let references = reference("orbit_bifurcations");
    for one in references["resonances"].as_array().expect("a list") {
        let label = match one["name"].as_str() {
            Some("1:4") => "R4",
            Some("1:3") => "R3",
            Some("1:2") => "R2",
            other => panic!("{other:?}"),
        };
        let found = listed(&special(&made, label), digits(one, "/V_H"));
        let ratio = number(found, "/stiffness/value") / digits(one, "/K");
        assert!((ratio - 1.0).abs() < 1e-9, "{label}: {ratio}");
    }
    let uz = special(&made, "UZ");
    let torus = references["K=0.14"].as_array().expect("a list").iter();
    for one in torus.filter(|one| one["type"] == "TR") {
        listed(&uz, digits(one, "/V_H"));
    }
}

#[test]
fn rows_and_special_points_go_where_they_belong() {
    let ended = twinslip(&format!("{EQUILIBRIA} --format csv"));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let table = csv(&ended.out);
    assert!(table.len() > 20 && table.iter().all(|row| row.len() == table[0].len()));
    for label in ["BP", "HB", "LP"] {
        let at = table[0]
            .iter()
            .position(|name| name == "label")
            .expect("it");
        assert!(table.iter().any(|row| row[at] == label), "{label}");
        let told = |line: &str| line.trim_start().starts_with(label);
        assert!(ended.err.lines().any(told), "{label}: {}", ended.err);
    }
    assert!(ended.err.contains("special points"), "{}", ended.err);
    let quiet = twinslip(&format!("{EQUILIBRIA} --format csv -q"));
    assert_eq!((quiet.err.as_str(), &csv(&quiet.out)), ("", &table));
    let place = folder("branches-drawn");
    for name in ["a.svg", "a.png"] {
        let path = place.join(name);
        let drawn = twinslip(&format!("{EQUILIBRIA} -q --plot {}", path.display()));
        assert_eq!((drawn.code, drawn.err.as_str()), (0, ""));
        assert!(path.exists());
    }
    let svg = std::fs::read_to_string(place.join("a.svg")).expect("written");
    for word in [
        "equilibria at K = 0.14",
        "asymmetric",
        "unstable",
        ">BP<",
        ">HB<",
    ] {
        assert!(svg.contains(word), "{word}");
    }
}

/// Cut off in the middle of its last row, a file is gone on with and ends as if it had never been interrupted.
#[test]
fn an_interrupted_file_is_gone_on_with() {
    let place = folder("resumed");
    let path = place.join("whole.csv");
    let command = |option: &str, path: &std::path::Path| {
        format!("{EQUILIBRIA} -q {option} {}", path.display())
    };
    assert_eq!(twinslip(&command("-o", &path)).code, 0);
    let whole = std::fs::read_to_string(&path).expect("written");
    let rows = |text: &str| {
        let mut rows = csv(text).split_off(1);
        // Branches may come in another order, and the rows of each must not.
        rows.sort_by_key(|row| row.last().and_then(|n| n.parse::<usize>().ok()));
        rows
    };
    for part in [
        0,
        whole.len() / 3,
        whole.len() * 4 / 5,
        whole.len() - 9,
        whole.len(),
    ] {
        let torn = place.join("torn.csv");
        std::fs::write(&torn, &whole[..part]).expect("written");
        let ended = twinslip(&command("--resume", &torn));
        assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{part}");
        let text = std::fs::read_to_string(&torn).expect("written");
        assert_eq!(rows(&text), rows(&whole), "{part} bytes were there");
        assert_eq!(text.matches("# twinslip").count(), 1);
    }
    let absent = place.join("absent.csv");
    assert_eq!(twinslip(&command("--resume", &absent)).code, 0);
    let text = std::fs::read_to_string(&absent).expect("written");
    assert_eq!(rows(&text), rows(&whole));
    // Of another model, another command, or no CSV at all.
    for (arguments, sentence) in [
        (
            format!(
                "branch equilibria --stiffness 0.2 --resume {}",
                path.display()
            ),
            "it was written with stiffness = 0.14, but this run has stiffness = 0.2",
        ),
        (
            format!("{EQUILIBRIA} --law bounded --resume {}", path.display()),
            "it was written with law = spinodal, but this run has law = bounded",
        ),
        (
            format!("{EQUILIBRIA} --to 10 --resume {}", path.display()),
            "it was written with to = 1000000.0, but this run has to = 10.0",
        ),
        (
            format!("locus hopf --resume {}", path.display()),
            "its columns are not those of this command",
        ),
        (
            format!("{EQUILIBRIA} --format json --resume {}", path.display()),
            "only CSV can be resumed",
        ),
        (
            format!("{EQUILIBRIA} -o other.csv --resume {}", path.display()),
            "leave out --output",
        ),
    ] {
        refused(&arguments, sentence);
    }
    let still = std::fs::read_to_string(&path).expect("there");
    assert_eq!(still, whole, "a file that is refused stays as it was");
}

#[cfg(unix)]
#[test]
fn an_interrupt_keeps_whole_rows_and_says_how_to_go_on() {
    let path = folder("branch-interrupt").join("hopf.csv");
    let long = format!(
        "locus hopf --step-limit 1e-3 --max-points 1000000 -o {}",
        path.display()
    );
    let child = crate::command::program()
        .args(long.split(' '))
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // As soon as there are rows, which is far from the end of a curve in such small steps.
    let begun = std::time::Instant::now();
    while std::fs::metadata(&path).map_or(0, |data| data.len()) < 4000 {
        assert!(begun.elapsed() < Duration::from_secs(120), "no row came");
        std::thread::sleep(Duration::from_millis(5));
    }
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .expect("kill");
    assert!(killed.success());
    let ended = child.wait_with_output().expect("it ends");
    assert_eq!(ended.status.code(), Some(130));
    let said = String::from_utf8_lossy(&ended.stderr);
    assert!(said.contains("interrupted; resume with --resume"), "{said}");
    let text = std::fs::read_to_string(&path).expect("kept");
    assert!(text.ends_with('\n') && text.starts_with("# twinslip"));
    let table = csv(&text);
    assert!(table.len() > 2 && table.iter().all(|row| row.len() == table[0].len()));
}

/// However short the steps: as many points as are allowed, then a failure that names the number, and the points are kept.
#[test]
fn points_are_bounded() {
    for (arguments, limit) in [
        ("locus pitchfork --step-limit 1e-9", 50),
        ("locus pitchfork --step-limit 1e-300", 7),
        ("locus hopf --step-limit 1e-9", 40),
        ("branch equilibria --stiffness 0.14 --step-limit 1e-12", 30),
        (
            "branch equilibria --driving 10 --along stiffness --step-limit 1e-9",
            30,
        ),
        (
            "branch orbits --stiffness 0.14 --symmetry symmetric --from 150 --to 300",
            5,
        ),
    ] {
        let ended = twinslip(&format!("{arguments} --max-points {limit} --format csv"));
        assert_eq!(ended.code, 1, "{arguments}: {}", ended.err);
        let named = format!("stopped at the limit of {limit} points");
        assert!(ended.err.contains(&named), "{arguments}: {}", ended.err);
        // Points before the range count, but are no rows.
        let rows = csv(&ended.out).len().saturating_sub(1);
        assert!(rows <= limit, "{arguments}: {rows}");
        assert!(
            rows == limit || arguments.starts_with("locus hopf"),
            "{arguments}: {rows}"
        );
    }
    let wide = twinslip("locus pitchfork --stiffness-range 1e-300,1e300 --format csv");
    assert_eq!(wide.code, 0, "{}", wide.err);
    let rows = csv(&wide.out);
    let stiffness = rows[0]
        .iter()
        .position(|name| name == "stiffness")
        .expect("a column");
    let values: Vec<f64> = rows[1..]
        .iter()
        .map(|row| row[stiffness].parse().expect("a number"))
        .collect();
    let line = values.len() / 2;
    assert_eq!((values[0], values[line - 1]), (1e-300, 1e300));
    assert!(values[..line].windows(2).all(|pair| pair[0] < pair[1]));
    refused(
        "locus pitchfork --max-points 0",
        "max-points is 0, but must be at least 1",
    );
}

#[test]
fn wrong_branches_are_refused() {
    let orbits = |change: &str| format!("branch orbits --stiffness 0.14 {change}");
    for (arguments, sentence) in [
        (
            "branch",
            "twinslip branch equilibria, or twinslip branch orbits",
        ),
        (
            "branch cycles",
            "branch is cycles, but must be equilibria or orbits",
        ),
        ("branch orbits", "--stiffness K is missing"),
        (
            "branch orbits --along stiffness",
            "--driving V_H is missing",
        ),
        (
            "branch orbits --stiffness 1 --driving 1",
            "--driving cannot be given with --along driving",
        ),
        (
            "branch orbits --along period --driving 1",
            "along is period, but must be one of driving, stiffness",
        ),
        (
            "branch orbits --interfaces 1 --stiffness 0.2 --symmetry asymmetric",
            "a single interface",
        ),
        (
            "branch equilibria --stiffness 0.14 --crosscheck",
            "--crosscheck applies only to orbits",
        ),
    ] {
        refused(arguments, sentence);
    }
    for (change, sentence) in [
        ("--from 0", "from is 0, but must be positive"),
        ("--to -1", "to is -1, but must be positive"),
        ("--from 1 --to 1", "begins and ends at 1"),
        ("--at 1e9", "must be in the range from 0.001"),
        ("--at 1,,2", "is not a number"),
        ("--at 1,-2", "at is -2, but must be positive"),
        (
            "--symmetry odd",
            "symmetry is odd, but must be symmetric, asymmetric or both",
        ),
        (
            "--tolerance 1",
            "tolerance is 1, but must be at least 1e-15",
        ),
        ("--step-limit 0", "step-limit is 0, but must be positive"),
        (
            "--crosscheck=euler",
            "crosscheck is euler, but must be one of auto",
        ),
        ("--plot x.pdf", "must end in .svg or .png"),
    ] {
        refused(&orbits(change), sentence);
    }
}

#[test]
fn wrong_curves_are_refused() {
    for (arguments, sentence) in [
        ("locus", "one of pitchfork, saddle-node, hopf"),
        (
            "locus fold",
            "bifurcation is fold, but must be one of pitchfork",
        ),
        (
            "locus hopf --stiffness 0.14",
            "--stiffness is a free parameter of a curve",
        ),
        ("locus hopf --driving 1", "use --driving-range"),
        ("locus hopf --driving-range 1", "must be A:B, two numbers"),
        (
            "locus hopf --driving-range 1:2:3",
            "must be A:B, two numbers",
        ),
        ("locus hopf --driving-range 1:", "\"\" is not a number"),
        ("locus hopf --driving-range 1,1", "begins and ends at 1"),
        ("locus hopf --driving-range 1,nan", "must be positive"),
        ("locus hopf --stiffness-range 0,1", "stiffness-range is 0"),
        ("locus torus --at-stiffness 7", "must be in the range"),
        ("locus torus --at-driving x", "is not a number"),
        (
            "locus hopf --crosscheck",
            "--crosscheck applies only to orbits",
        ),
    ] {
        refused(arguments, sentence);
    }
}

#[test]
fn the_plan_is_told_before() {
    let told = twinslip(&format!("{EQUILIBRIA} --explain"));
    for line in [
        "symmetry",
        "range",
        "method",
        "special points",
        "crosscheck",
    ] {
        assert!(told.err.contains(line), "{}", told.err);
    }
    let told = twinslip("locus pitchfork --explain");
    for line in ["curve", "V_H", "criticality"] {
        assert!(told.err.contains(line), "{}", told.err);
    }
}

/// Numbers in SI are those without, times the units.
#[test]
fn branches_in_si_are_the_same() {
    let stiffness = 0.14 * 0.0349 * 1e6 / 0.9e-6;
    let si = object(&format!("branch equilibria --si --stiffness {stiffness}"));
    let plain = object(EQUILIBRIA);
    for label in ["BP", "HB"] {
        let (si, plain) = (special(&si, label), special(&plain, label));
        assert_eq!(si.len(), plain.len());
        for (one, other) in si.iter().zip(plain) {
            let ratio = number(one, "/driving/value") / number(other, "/driving/value");
            assert!((ratio / 1e-6 - 1.0).abs() < 1e-10, "{ratio}");
        }
    }
}

#[test]
fn a_scene_is_the_same_as_its_words() {
    let path = folder("branch-scene").join("one.toml");
    let text = "command = \"branch\"\nof = \"equilibria\"\nstiffness = 0.14\nfrom = 0.01\nto = 10\n\
                at = [0.1, 1]\nsymmetry = \"symmetric\"\nformat = \"csv\"\nquiet = true\n";
    std::fs::write(&path, text).expect("written");
    let scene = run(&["run", path.to_str().expect("UTF-8")]);
    let words = twinslip(
        "branch equilibria --stiffness 0.14 --from 0.01 --to 10 --at 0.1,1 --symmetry symmetric --format csv -q",
    );
    assert_eq!(
        (scene.code, words.code),
        (0, 0),
        "{}{}",
        scene.err,
        words.err
    );
    assert_eq!(csv(&scene.out), csv(&words.out));
    let other = "command = \"locus\"\nof = \"fold\"\n";
    std::fs::write(&path, other).expect("written");
    let ended = run(&["run", path.to_str().expect("UTF-8")]);
    assert_eq!(ended.code, 2);
    assert!(
        ended
            .err
            .contains("one.toml: bifurcation is fold, but must be one of pitchfork,")
    );
}
