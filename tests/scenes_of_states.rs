//! Scenes of the commands that compute states rather than runs: laws, steady states, periodic orbits.

use crate::command;
use command::{Ended, folder, run, twinslip};
use serde_json::Value;
use std::sync::atomic::AtomicBool;
use twinslip::Error;
use twinslip_paper::Pieces;
use twinslip_tasks::scene::{Command, EquilibriaPlan, OrbitPlan, SceneFile};

/// A scene, and the command line that is the same.
const SAME: [(&str, &str); 5] = [
    (
        "command = \"law\"\nlaw = \"bounded\"\nsi = true\nfrom = 1e-8\nto = 1e-2\npoints = 7\n",
        "law --law bounded --si --from 1e-8 --to 1e-2 --points 7",
    ),
    (
        "command = \"equilibria\"\ndriving = 1000\nstiffness = 0.45\nsolver = \"newton\"\n",
        "equilibria --driving 1000 --stiffness 0.45 --solver newton",
    ),
    (
        "command = \"equilibria\"\ninterfaces = 1\ndriving = 10\n",
        "equilibria --interfaces 1 --driving 10",
    ),
    (
        "command = \"orbit\"\ndriving = 0.2\nstiffness = 0.05\nsymmetry = \"asymmetric\"\ncrosscheck = \"none\"\n",
        "orbit --driving 0.2 --stiffness 0.05 --symmetry asymmetric --crosscheck none",
    ),
    (
        "command = \"orbit\"\ninterfaces = 1\ndriving = 10\nstiffness = 0.14\nmethod = \"rodas5p\"\nrtol = 1e-9\n\
         crosscheck = \"taylor\"\n",
        "orbit --interfaces 1 --driving 10 --stiffness 0.14 --method rodas5p --rtol 1e-9 --crosscheck taylor",
    ),
];

/// Without the command, which is what differs.
fn without_command(out: &str) -> String {
    let Some((before, rest)) = out.split_once("\"command\":[") else {
        let lines = out.lines().filter(|line| !line.starts_with("# command: "));
        return lines.map(|line| line.to_owned() + "\n").collect();
    };
    let (_, after) = rest.split_once(']').expect("an end");
    format!("{before}{after}")
}

#[test]
fn a_scene_gives_the_bytes_of_its_command() {
    let place = folder("scenes-of-states");
    let path = place.join("one.toml");
    let path = path.to_str().expect("ASCII");
    for (text, flags) in SAME {
        std::fs::write(path, text).expect("written");
        for format in ["table", "csv", "json"] {
            let scene = run(&["run", path, "--format", format, "--explain"]);
            let typed = twinslip(&format!("{flags} --format {format} --explain"));
            assert_eq!((scene.code, typed.code), (0, 0), "{}", scene.err);
            assert_eq!(
                without_command(&scene.out),
                without_command(&typed.out),
                "{flags}"
            );
            assert!(scene.out.len() > 100, "{}", scene.out);
            assert!(
                scene.err.starts_with("plan of this command\n"),
                "{}",
                scene.err
            );
            assert_eq!(scene.err, typed.err, "{flags}");
        }
    }
}

#[test]
fn what_is_wrong_in_such_a_scene_is_said_with_its_line() {
    let place = folder("wrong-states");
    let path = place.join("bad.toml");
    let slab = "driving = 0.2\nstiffness = 0.05\n";
    let orbit = format!("command = \"orbit\"\n{slab}");
    let equilibria = format!("command = \"equilibria\"\n{slab}");
    let law = "command = \"law\"\n";
    for (text, place, sentence) in [
        (
            format!("{orbit}symetry = \"symmetric\""),
            ":4:",
            "unknown key \"symetry\"; did you mean \"symmetry\"?",
        ),
        (
            format!("{orbit}symmetry = \"asymetric\""),
            ":4:",
            "symmetry is asymetric, but must be symmetric or asymmetric; did you mean \"asymmetric\"?",
        ),
        (
            format!("{orbit}crosscheck = \"taylor\""),
            ":4:",
            "--crosscheck taylor is the method of the orbit itself; choose another, or none",
        ),
        (
            format!("{orbit}crosscheck = \"tailor\""),
            ":4:",
            "did you mean \"taylor\"?",
        ),
        (
            format!("{orbit}start = \"hopf\"\nperiod-guess = 9"),
            ":5:",
            "--period-guess goes with a --start near the orbit, not with --start hopf",
        ),
        (
            format!("{orbit}period-guess = 9"),
            ":4:",
            "--period-guess needs a --start near the orbit",
        ),
        (
            format!("{orbit}max-steps = 0"),
            ":4:",
            "max-steps is 0, but must be at least 1",
        ),
        (format!("{orbit}until = 9"), ":4:", "unknown key \"until\""),
        (
            orbit.replace("driving = 0.2\n", ""),
            ":",
            "--driving V_H is missing, and has no default",
        ),
        (
            format!("{equilibria}solver = \"newtn\""),
            ":4:",
            "solver is newtn, but must be kinsol or newton; did you mean \"newton\"?",
        ),
        (
            format!("{equilibria}solvr = \"newton\""),
            ":4:",
            "unknown key \"solvr\"; did you mean \"solver\"?",
        ),
        (
            format!("{law}from = 10\nto = 1"),
            ":2:",
            "--from must be less than --to",
        ),
        (
            format!("{law}points = 1"),
            ":2:",
            "points is 1, but must be from 2 to 1e7",
        ),
        (
            format!("{law}point = 9"),
            ":2:",
            "unknown key \"point\"; did you mean \"points\"?",
        ),
    ] {
        std::fs::write(&path, &text).expect("written");
        let Ended { code, out, err } = run(&["run", path.to_str().expect("ASCII")]);
        assert_eq!((code, out.as_str()), (2, ""), "{text}: {err}");
        assert_eq!(err.lines().count(), 1, "{err}");
        assert!(err.contains(&format!("bad.toml{place}")), "{text}: {err}");
        assert!(err.contains(sentence), "{text}: {err}");
    }
    // Their picture goes where a run is told to put it.
    let path = folder("equilibria-scene").join("states.svg");
    let ended = twinslip(&format!("run equilibria -q --plot {}", path.display()));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let svg = std::fs::read_to_string(path).expect("a picture");
    assert!(svg.contains("steady states at K = 0.45"));
}

fn command_of(text: &str) -> twinslip::Result<Command> {
    Command::of_scene(
        &SceneFile::parse("one.toml", text, &Command::program())?,
        &[],
    )
}

#[test]
fn the_library_speaks_of_fields() {
    let said = |text: &str| {
        let error = match command_of(text).expect("a scene") {
            Command::Orbit(options) => OrbitPlan::new(&options).expect_err("wrong"),
            Command::Equilibria(options) => EquilibriaPlan::new(&options).expect_err("wrong"),
            other => panic!("{other:?}"),
        };
        assert!(matches!(error, Error::Input(_)), "{error:?}");
        error.to_string()
    };
    let orbit = "command = \"orbit\"\ndriving = 0.2\nstiffness = 0.05\nstart = \"hopf\"\nperiod-guess = 9\n";
    assert_eq!(
        said(orbit),
        "`period_guess` goes with a `start` near the orbit, not with `start` hopf"
    );
    assert_eq!(
        said("command = \"equilibria\"\n"),
        "`driving` V_H is missing, and has no default"
    );
}

#[test]
fn what_is_kept_in_files_speaks_of_flags_too() {
    let run =
        twinslip("integrate --driving 10 --stiffness 0.14 --until 100 --max-steps 5 --format json");
    assert_eq!(run.code, 1, "{}", run.err);
    let object: Value = serde_json::from_str(&run.out).expect("JSON");
    let error = object["error"].as_str().expect("a sentence");
    assert!(error.contains("raise --max-steps, loosen"), "{error}");
    assert!(run.err.contains(error), "{}", run.err);
    let sweep =
        twinslip("sweep -q --driving 0.1:0.2:2 --stiffness 0.14 --max-steps 100 --format csv");
    let noted = sweep
        .out
        .lines()
        .filter(|line| line.contains("raise --max-steps"));
    assert_eq!(noted.count(), 2, "{}", sweep.out);
    let section = twinslip(
        "section -q --driving 0.094 --stiffness 0.14 --start near-symmetric:0.3 --skip 1000 --returns 600 --format json",
    );
    let object: Value = serde_json::from_str(&section.out).expect("JSON");
    let note = object["result"]["note"].as_str().expect("a reason");
    assert!(
        note.contains("the exponents (--lyapunov) may decide"),
        "{note}"
    );
}

#[test]
fn pieces_of_the_paper_may_be_such_scenes() {
    let stop = AtomicBool::new(false);
    let pieces = Pieces::new(&stop);
    let orbit = pieces.orbit("orbit").expect("an orbit");
    let printed = twinslip("run orbit --format json -q");
    let printed: Value = serde_json::from_str(&printed.out).expect("JSON");
    assert_eq!(
        printed["result"]["orbit"]["period"]["value"],
        orbit.found.orbit.period.value
    );
    assert_eq!(orbit.found.orbit.symmetry.name(), "asymmetric");
    assert!(orbit.checked.is_some());
    let equilibria = pieces.equilibria("equilibria").expect("steady states");
    assert!(equilibria.found.complete && equilibria.found.undecided() == 0);
    assert_eq!(equilibria.found.equilibria.len(), 3);
    let law = pieces.law_of("law").expect("a law");
    let [law] = &law.curves[..] else {
        panic!("one law");
    };
    assert_eq!((law.points.len(), law.landmarks.extrema.len()), (400, 2));
    assert!(pieces.orbit("law").is_err() && pieces.law_of("sweep").is_err());
}

/// Of a law whose state is a time.
#[test]
fn uncertainties_of_logarithms_know_no_unit() {
    let given = "equilibria --law dieterich-ruina --si --driving 1e-5 --interfaces 1";
    let object = twinslip(&format!("{given} --format json"));
    let object: Value = serde_json::from_str(&object.out).expect("JSON");
    let state = &object["result"]["equilibria"][0];
    let told = state["log_state_uncertainty"][0]
        .as_f64()
        .expect("a number");
    assert!((0.0..1e-12).contains(&told), "{told}");
    let table = twinslip(&format!("{given} --format csv"));
    let mut lines = table.out.lines().filter(|line| !line.starts_with('#'));
    let mut names = lines.next().expect("names").split(',');
    let row: Vec<&str> = lines.next().expect("a row").split(',').collect();
    let place = names.position(|name| name == "log_state_uncertainty_1");
    let written: f64 = row[place.expect("the column")].parse().expect("a number");
    assert_eq!(written, told);
}
