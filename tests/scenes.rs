//! Scene files: those that the repository ships, and what is wrong in others.

use crate::command;
use crate::common::ROOT;
use command::{folder, run, twinslip};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn shipped() -> Vec<PathBuf> {
    let folder = Path::new(ROOT).join("scenes");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("scenes/")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_file())
        .collect();
    paths.sort_by_key(|path| path.file_stem().map(ToOwned::to_owned));
    paths
}

/// Those that take longest, what says how far they go, and what takes a part of the time.
const LONG: [(&str, &str, &str); 4] = [
    ("fig06-orbit-folds", "[0.003, 0.3]", "[0.06, 0.3]"),
    ("fig12", "[0.006, 0.3]", "[0.1, 0.3]"),
    ("fig12-period-doubling", "[0.01, 0.3]", "[0.1, 0.3]"),
    ("fig12-period-doubling", "[0.02, ", "["),
];

#[test]
fn every_scene_runs_and_can_be_drawn() {
    let place = folder("scenes");
    let scenes = shipped();
    assert!(scenes.len() >= 10);
    for scene in scenes {
        let name = scene.file_stem().unwrap().to_str().unwrap().to_owned();
        let [data, svg, png] =
            ["json", "svg", "png"].map(|end| place.join(format!("{name}.{end}")));
        let mut text = std::fs::read_to_string(&scene).expect("the scene");
        // A table of states or of orbits, which has no picture; what it holds is looked at in `scenes_of_states`.
        if ["orbit", "equilibria"].contains(&name.as_str()) {
            assert!(text.contains(&format!("command = \"{name}\"")));
            continue;
        }
        // Their tops alone: figures are made of the whole ones.
        let mut scene = scene;
        for (_, whole, part) in LONG.iter().filter(|(long, ..)| *long == name) {
            assert_eq!(text.matches(whole).count(), 1, "{name}");
            text = text.replace(whole, part);
            scene = place.join(format!("{name}.toml"));
            std::fs::write(&scene, &text).expect("a scene");
        }
        // Pixels are made of the SVG, whatever that shows: two scenes of them are enough.
        let pixels = ["fig13", "fig13-map"].contains(&name.as_str());
        let pictures = [Some(&svg), pixels.then_some(&png)];
        for picture in pictures.into_iter().flatten() {
            let ended = run(&[
                "run",
                scene.to_str().unwrap(),
                "-q",
                "-o",
                data.to_str().unwrap(),
                "--plot",
                picture.to_str().unwrap(),
            ]);
            assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{name}");
        }
        let made: Value =
            serde_json::from_slice(&std::fs::read(data).expect("data")).expect("JSON");
        assert!(
            made["result"]["rows"]
                .as_array()
                .is_some_and(|rows| rows.len() > 10)
        );
        let drawn = std::fs::read_to_string(svg).expect("a picture");
        let has = |field: &str| made["result"].get(field).is_some();
        let panel = match (has("regime"), has("special") || has("regimes")) {
            (true, _) => "return map",
            _ if name == "basin" => "ψ₁ at the start",
            _ if has("extrema") => "critical stiffness",
            (_, true) => "H</tspan><tspan dy=\"-29\"> [V*]",
            _ => "phase plane",
        };
        assert!(drawn.starts_with("<svg") && drawn.contains(panel), "{name}");
        if pixels {
            let bytes = std::fs::read(png).expect("a picture");
            assert!(bytes.starts_with(b"\x89PNG"), "{name}");
        }
    }
}

#[test]
fn shipped_scenes_are_in_the_program() {
    let listed = run(&["run", "--list"]);
    assert_eq!((listed.code, listed.err.as_str()), (0, ""));
    let scenes = shipped();
    assert_eq!(listed.out.lines().count(), scenes.len());
    for (scene, line) in scenes.iter().zip(listed.out.lines()) {
        let name = scene.file_stem().unwrap().to_str().unwrap();
        let (listed, about) = line.split_once(' ').expect("a name and what it shows");
        assert_eq!(listed, name);
        assert!(about.trim().len() > 10, "{line}");
        let shown = run(&["run", name, "--show"]);
        let text = std::fs::read_to_string(scene).expect("the scene");
        assert_eq!((shown.code, shown.out), (0, text), "{name}");
    }
}

#[test]
fn a_shipped_scene_runs_anywhere_and_a_file_goes_first() {
    let place = folder("anywhere");
    let there = |arguments: &[&str]| {
        let ended = crate::command::program()
            .args(arguments)
            .current_dir(&place)
            .output()
            .expect("the program starts");
        let err = String::from_utf8_lossy(&ended.stderr).into_owned();
        (
            ended.status.code(),
            String::from_utf8_lossy(&ended.stdout).into_owned(),
            err,
        )
    };
    let rows = |text: &str| -> Vec<String> {
        let rows = text.lines().filter(|line| !line.starts_with('#'));
        rows.map(str::to_owned).collect()
    };
    let (code, out, err) = there(&["run", "fig08b", "-q"]);
    assert_eq!(code, Some(0), "{err}");
    assert!(rows(&out).len() > 100);
    for name in ["fig08b.toml", "scenes/fig08b.toml"] {
        let (_, again, _) = there(&["run", name, "-q"]);
        assert_eq!(rows(&again), rows(&out), "{name}");
    }
    let own = "command = \"law\"\npoints = 3\n";
    std::fs::write(place.join("fig08b"), own).expect("written");
    let (code, law, _) = there(&["run", "fig08b", "-q"]);
    assert_eq!((code, rows(&law).len()), (Some(0), 4));
    let (code, _, err) = there(&["run", "fig08b", "--show"]);
    assert_eq!(code, Some(2), "{err}");
    let (code, _, err) = there(&["run"]);
    assert_eq!(code, Some(2), "{err}");
}

#[test]
fn a_scene_is_the_same_as_its_flags() {
    let place = folder("same");
    let path = place.join("one.toml");
    let text = "command = \"integrate\"\nlaw = \"spinodal\"\ndriving = 0.2\nstiffness = 5e-2\n\
                start = [11.4, 0.3, 0.05]\nuntil = 500\nmethod = \"rodas4\"\nrtol = 1e-7\n\
                points = 50\nevents = true\nestimate-error = false\ncolumns = [\"time\", \"slip_1\"]\n\
                format = \"json\"\nquiet = true\n";
    std::fs::write(&path, text).expect("written");
    let scene = run(&["run", path.to_str().unwrap()]);
    assert_eq!(scene.code, 0, "{}", scene.err);
    let flags = twinslip(
        "integrate --law spinodal --driving 0.2 --stiffness 5e-2 --start 11.4,0.3,0.05 --until 500 \
         --method rodas4 --rtol 1e-7 --points 50 --events --columns time,slip_1 --format json -q",
    );
    let mut made =
        [scene.out, flags.out].map(|text| serde_json::from_str::<Value>(&text).expect("JSON"));
    for object in &mut made {
        object["command"].take();
    }
    assert_eq!(made[0], made[1]);
    // What is said anew replaces what the scene says.
    let other = place.join("anew.csv");
    let anew = run(&[
        "run",
        path.to_str().unwrap(),
        "--format",
        "csv",
        "-o",
        other.to_str().unwrap(),
        "--explain",
    ]);
    let rows = std::fs::read_to_string(&other).expect("rows");
    assert!(rows.starts_with("# twinslip") && anew.err.contains("plan of this run"));
    for (text, begins) in [
        ("command = \"law\"\npoints = 3\n", "slip_rate,stress"),
        (
            "command = \"section\"\ndriving = 10\nstiffness = 0.14\nskip = 600\nreturns = 9\nsurface = \"stress=10\"\n",
            "n,time,log_state_1",
        ),
    ] {
        std::fs::write(&path, text).expect("written");
        let ended = run(&["run", path.to_str().unwrap()]);
        assert_eq!(ended.code, 0, "{}", ended.err);
        assert!(ended.out.contains(begins), "{}", ended.out);
    }
}

#[test]
fn what_is_wrong_in_a_scene_is_said_with_its_line() {
    let place = folder("wrong");
    let path = place.join("bad.toml");
    let good = "command = \"integrate\"\ndriving = 0.2\nstiffness = 0.05\nuntil = 10\n";
    for (text, line, sentence) in [
        (
            format!("{good}stifness = 1"),
            5,
            "unknown key \"stifness\"; did you mean \"stiffness\"?",
        ),
        (
            format!("{good}healing_time = 1"),
            5,
            "unknown key \"healing_time\"; did you mean \"healing-time\"?",
        ),
        (format!("{good}help = true"), 5, "unknown key \"help\""),
        (
            format!("# a\n\n{good}rtol = nan"),
            7,
            "rtol is nan, but must be finite",
        ),
        (
            format!("{good}rtol = inf"),
            5,
            "rtol is inf, but must be finite",
        ),
        (
            format!("{good}rtol = -1e-8"),
            5,
            "rtol is -1e-8, but must be at least 1e-16",
        ),
        (
            format!("{good}rtol = \"tight\""),
            5,
            "rtol must be a number, not string",
        ),
        (
            format!("{good}law = 3.5"),
            5,
            "law is 3.5, but must be one of",
        ),
        (format!("{good}law = \"\""), 5, "law is empty"),
        (
            format!("{good}law = true"),
            5,
            "law must be a text, not boolean",
        ),
        (
            format!("{good}final-only = 1"),
            5,
            "final-only must be true or false, not integer",
        ),
        (format!("{good}points = 2.5"), 5, "points"),
        (
            format!("{good}start = [10, 2, 0.5]"),
            5,
            "psi in --start is 2, but must be in (0, 1]",
        ),
        (
            format!("{good}start = [10, -1, 0.5]"),
            5,
            "psi in --start is -1",
        ),
        (
            format!("{good}start = [10, [1], 0.5]"),
            5,
            "start must be a list",
        ),
        (
            format!("{good}method = \"euler\""),
            5,
            "method is euler, but must be one of auto",
        ),
        (
            format!("{good}law = spinodl"),
            5,
            "a text needs quotes in a scene: law = \"spinodl\"",
        ),
        (
            format!("{good}start = near-symmetric:0.1 # close"),
            5,
            "a text needs quotes in a scene: start = \"near-symmetric:0.1\"",
        ),
        (
            good.replace("\"integrate\"", "integrate"),
            1,
            "a text needs quotes in a scene: command = \"integrate\"",
        ),
        (
            format!("{good}law = \"spinodl\""),
            5,
            "law is spinodl, but must be one of spinodal, bounded, regularised-ageing, dieterich-ruina, slip, composite, cutoff, flash-heating, nagata, perrin-rice-zheng; did you mean \"spinodal\"?",
        ),
        (format!("{good}driving = 3"), 5, "duplicate key"),
        (format!("{good}rtol = "), 5, ""),
        (
            good.replace("0.2", "0"),
            2,
            "driving is 0, but must be positive and finite",
        ),
        (
            good.replace("integrate", "integrat"),
            1,
            "did you mean \"integrate\"?",
        ),
        (
            good.replace("integrate", "run"),
            1,
            "command must be one of",
        ),
        (
            good.replace("command", "comand"),
            1,
            "the key command is missing",
        ),
        (
            good.replace("stiffness = 0.05\n", ""),
            0,
            "--stiffness K is missing",
        ),
        (
            format!("{good}points = 5\nevery = 1.0"),
            0,
            "cannot be used with",
        ),
    ] {
        std::fs::write(&path, &text).expect("written");
        let ended = run(&["run", path.to_str().unwrap()]);
        assert_eq!(ended.code, 2, "{text}: {}", ended.err);
        assert_eq!(ended.err.lines().count(), 1, "{}", ended.err);
        assert!(ended.err.contains(sentence), "{text}: {}", ended.err);
        if line > 0 {
            assert!(
                ended.err.contains(&format!("bad.toml:{line}:")),
                "{text}: {}",
                ended.err
            );
        } else {
            assert!(ended.err.contains("bad.toml:"), "{text}: {}", ended.err);
        }
    }
    let absent = run(&["run", place.join("none.toml").to_str().unwrap()]);
    assert_eq!(absent.code, 2);
    assert!(absent.err.contains("cannot read"), "{}", absent.err);
}
