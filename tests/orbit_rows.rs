//! Rows and pictures of periodic orbits over one period.

use crate::command;
use crate::common;
use command::{csv, folder, number, object, refused_in_one_line, run, twinslip};
use common::assert_close;
use common::text::{alike, law};
use serde_json::Value;

const COLUMNS: [&str; 10] = [
    "time",
    "stress",
    "state_1",
    "state_2",
    "log_state_1",
    "log_state_2",
    "slip_rate_1",
    "slip_rate_2",
    "slip_1",
    "slip_2",
];

/// Stable and unstable, symmetric and not, of two interfaces and of one: the command, V_H and K, and how near rows are to
/// what they should be, by the tolerance of the method.
const ORBITS: &[(&str, f64, f64, f64)] = &[
    (
        "--driving 10 --stiffness 0.14 --symmetry asymmetric",
        10.0,
        0.14,
        1e-9,
    ),
    ("--driving 0.2 --stiffness 0.14", 0.2, 0.14, 1e-9),
    (
        "--driving 0.2 --stiffness 0.05 --symmetry asymmetric --start 11.377,1.53e-6,1.83e-4 --period-guess 480",
        0.2,
        0.05,
        1e-9,
    ),
    (
        "--driving 1 --stiffness 0.28 --interfaces 1",
        1.0,
        0.28,
        1e-9,
    ),
    (
        "--driving 10 --stiffness 0.14 --symmetry asymmetric --method rodas5p",
        10.0,
        0.14,
        1e-8,
    ),
    #[cfg(feature = "sundials")]
    (
        "--driving 10 --stiffness 0.14 --symmetry asymmetric --method cvode-adams",
        10.0,
        0.14,
        1e-8,
    ),
];

fn rows(made: &Value) -> &Vec<Value> {
    made["result"]["rows"].as_array().expect("rows")
}

#[test]
fn rows_go_around_the_orbit_once() {
    for (flags, driving, stiffness, near) in ORBITS {
        let made = object(&format!("orbit {flags} --crosscheck none --points 65"));
        let (orbit, rows) = (&made["result"]["orbit"], rows(&made));
        let one = flags.contains("interfaces 1");
        assert_eq!(rows.len(), 65, "{flags}");
        let names: Vec<&str> = rows[0]
            .as_object()
            .expect("a row")
            .keys()
            .map(String::as_str)
            .collect();
        let expected = COLUMNS.iter().filter(|name| !(one && name.ends_with("_2")));
        assert_eq!(names, expected.copied().collect::<Vec<_>>(), "{flags}");
        let (first, last) = (&rows[0], &rows[64]);
        assert_eq!(number(first, "/time"), 0.0);
        assert_eq!(last["time"], orbit["period"]["value"], "{flags}");
        assert_eq!(first["stress"], orbit["point"][0], "{flags}");
        assert_eq!(first["log_state_1"], orbit["point"][1], "{flags}");
        for name in &names {
            if (name.contains("rate") || !name.starts_with("slip_")) && *name != "time" {
                let path = format!("/{name}");
                assert_close(
                    number(last, &path),
                    number(first, &path),
                    *near,
                    &format!("{flags}: {name}"),
                );
            }
        }
        // Over a period the interfaces slip as far as the drive goes.
        let way = driving * number(last, "/time");
        let slipped = number(last, "/slip_1") + if one { 0.0 } else { number(last, "/slip_2") };
        assert_close(slipped, way, *near, flags);
        let (least, most) = (&orbit["stress_min"], &orbit["stress_max"]);
        for row in rows {
            let stress = number(row, "/stress");
            assert!(
                stress > number(least, "/value") - near && stress < number(most, "/value") + near
            );
            let pull = stiffness
                * (driving * number(row, "/time")
                    - number(row, "/slip_1")
                    - if one { 0.0 } else { number(row, "/slip_2") });
            let defect = (pull - (stress - number(first, "/stress"))).abs();
            assert!(defect < near * stiffness * way, "{flags}: {defect:e}");
        }
    }
}

/// Where the orbit is stable a run from its point has the same rows.
#[test]
fn a_run_from_the_point_has_the_same_rows() {
    let model = "--driving 10 --stiffness 0.14";
    let made = object(&format!(
        "orbit {model} --symmetry asymmetric --crosscheck none --points 33"
    ));
    let orbit = &made["result"]["orbit"];
    let psi = |i: usize| number(orbit, &format!("/point/{i}")).exp();
    let run = object(&format!(
        "integrate {model} --start {},{},{} --until {} --points 33 --rtol 1e-14 --method taylor",
        orbit["point"][0],
        psi(1),
        psi(2),
        orbit["period"]["value"]
    ));
    for (row, other) in rows(&made).iter().zip(rows(&run)) {
        for name in COLUMNS {
            let path = format!("/{name}");
            let (a, b) = (number(row, &path), number(other, &path));
            assert!(
                (a - b).abs() <= 1e-8 * (b.abs() + 1e-3),
                "{name}: {a} and {b}"
            );
        }
    }
}

#[test]
fn what_is_not_asked_for_is_not_there() {
    let plain = "orbit --driving 1 --stiffness 0.14 --symmetry asymmetric --crosscheck none";
    let without = object(plain);
    assert!(without["result"].get("rows").is_none());
    let mut with = object(&format!("{plain} --points 5"));
    with["result"]
        .as_object_mut()
        .expect("an object")
        .remove("rows");
    for made in [&without["result"], &with["result"]] {
        assert!(made["orbit"]["period"]["value"].is_f64());
    }
    assert_eq!(without["result"], with["result"]);
    let told = twinslip(&format!("{plain} --points 5 --explain --format csv"));
    assert!(
        told.err.contains("on, for the extremes and the rows"),
        "{}",
        told.err
    );
    let table = csv(&told.out);
    assert_eq!(
        (table[0].as_slice(), table.len()),
        (&COLUMNS.map(str::to_owned)[..], 6)
    );
    assert!(told.out.contains("# orbit: period ("), "{}", told.out);
    refused_in_one_line(
        &format!("{plain} --points 1"),
        "points is 1, but must be from 2",
    );
    refused_in_one_line(
        &format!("{plain} --plot orbit.pdf"),
        "must end in .svg or .png",
    );
}

#[test]
fn rows_in_si_units_are_the_same() {
    let stiffness = 0.14 * 0.0349 * 1e6 / 0.9e-6;
    let si = object(&format!(
        "orbit --si --driving 1e-5 --stiffness {stiffness} --symmetry asymmetric --crosscheck none --points 9"
    ));
    let plain = object(
        "orbit --driving 10 --stiffness 0.14 --symmetry asymmetric --crosscheck none --points 9",
    );
    for (row, other) in rows(&si).iter().zip(rows(&plain)) {
        for (name, unit) in [("time", 0.9), ("stress", 0.0349 * 1e6), ("slip_1", 0.9e-6)] {
            let path = format!("/{name}");
            let (a, b) = (number(row, &path) / unit, number(other, &path));
            assert!((a - b).abs() <= 1e-7 * b.abs(), "{name}: {a} and {b}");
        }
    }
}

#[test]
fn an_orbit_is_drawn_from_flags_and_scenes() {
    let place = folder("orbit-rows");
    let flags = "orbit --driving 1 --stiffness 0.14 --symmetry asymmetric --crosscheck none";
    let [typed, of_scene, data] =
        ["typed.svg", "scene.svg", "orbit.csv"].map(|name| place.join(name));
    let ended = twinslip(&format!(
        "{flags} -q --plot {} -o {}",
        typed.display(),
        data.display()
    ));
    assert_eq!((ended.code, ended.err.as_str()), (0, ""));
    // Without --points the file has the orbit itself.
    assert!(
        std::fs::read_to_string(&data)
            .expect("rows")
            .contains("symmetry,period,")
    );
    let scene = place.join("orbit.toml");
    let text = "command = \"orbit\"\ndriving = 1\nstiffness = 0.14\nsymmetry = \"asymmetric\"\ncrosscheck = \"none\"\npoints = 7\n";
    std::fs::write(&scene, text).expect("written");
    let scene = scene.to_str().expect("UTF-8");
    let ended = run(&[
        "run",
        scene,
        "-q",
        "--plot",
        of_scene.to_str().expect("UTF-8"),
        "--format",
        "csv",
    ]);
    assert_eq!((ended.code, csv(&ended.out).len()), (0, 8), "{}", ended.err);
    let [typed, of_scene] =
        [typed, of_scene].map(|path| std::fs::read_to_string(path).expect("a picture"));
    assert!(typed.contains("phase plane") && typed.contains("slow"));
    assert_eq!(typed, of_scene);
}

/// Of systems from files: stable, unstable, and one whose period others computed.
const OF_SYSTEMS: &[(&str, &[&str], f64)] = &[
    ("--system van-der-pol", &["time", "x", "y"], 1e-12),
    (
        "--system lorenz --set r=24 --start 12,12,23 --period-guess 0.68",
        &["time", "x", "y", "z"],
        1e-12,
    ),
    (
        "--system van-der-pol --method rodas5p",
        &["time", "x", "y"],
        1e-8,
    ),
];

#[test]
fn rows_of_a_system_go_around_its_orbit_once() {
    for (flags, columns, near) in OF_SYSTEMS {
        let command = format!("orbit {flags} --crosscheck none");
        let made = object(&format!("{command} --points 41"));
        let (orbit, rows) = (&made["result"]["orbit"], rows(&made));
        assert_eq!(rows.len(), 41, "{flags}");
        let names: Vec<&str> = rows[0]
            .as_object()
            .expect("a row")
            .keys()
            .map(String::as_str)
            .collect();
        assert_eq!(names, *columns, "{flags}");
        let (first, last) = (&rows[0], &rows[40]);
        assert_eq!(last["time"], orbit["period"]["value"], "{flags}");
        alike(last, first, *near, &columns[1..]);
        for (i, name) in columns[1..].iter().enumerate() {
            assert_eq!(first[*name], orbit["point"][i], "{flags}");
            let end = |of: &str| number(orbit, &format!("/extremes/{name}/{of}/value"));
            let path = format!("/{name}");
            assert!(rows.iter().all(|row| {
                let x = number(row, &path);
                x > end("min") - near && x < end("max") + near
            }));
        }
        // A run from the point, for as long as it stays by an orbit that is not stable.
        let run = object(&format!(
            "integrate {} --start={} --until {} --points 41 --rtol 1e-15 --method taylor",
            flags
                .split(" --start")
                .next()
                .unwrap_or_default()
                .replace(" --method rodas5p", ""),
            columns[1..]
                .iter()
                .map(|name| first[*name].to_string())
                .collect::<Vec<_>>()
                .join(","),
            orbit["period"]["value"]
        ));
        for (row, other) in rows.iter().zip(self::rows(&run)) {
            alike(row, other, near.max(1e-9), columns);
        }
        let without = object(&command);
        assert_eq!(without["result"]["orbit"], *orbit, "{flags}");
        assert!(without["result"].get("rows").is_none());
    }
}

#[test]
fn rows_of_a_law_from_a_file_are_those_of_the_built_in_law() {
    let file = law("spinodal");
    for loading in [
        "--symmetry asymmetric --driving 10 --stiffness 0.14 --start 9.91,0.00204,0.00198",
        "--interfaces 1 --driving 10 --stiffness 0.1",
    ] {
        let orbit = |law: &str| {
            object(&format!(
                "orbit --law {law} {loading} --crosscheck none --points 33"
            ))
        };
        let (made, known) = (orbit(&file), orbit("spinodal"));
        let columns: Vec<&str> = COLUMNS
            .into_iter()
            .filter(|name| !(loading.contains("interfaces 1") && name.ends_with("_2")))
            .collect();
        let (first, last) = (&rows(&made)[0], &rows(&made)[32]);
        let periodic: Vec<&str> = columns
            .iter()
            .copied()
            .filter(|name| (name.contains("rate") || !name.starts_with("slip_")) && *name != "time")
            .collect();
        alike(last, first, 1e-10, &periodic);
        // The point is a node: the rows of the built-in law begin elsewhere on the orbit, and are of another phase.
        let point: Vec<String> = (0..columns
            .iter()
            .filter(|name| name.contains("log_state"))
            .count()
            + 1)
            .map(|i| {
                let x = number(&made, &format!("/result/orbit/point/{i}"));
                if i == 0 { x } else { x.exp() }.to_string()
            })
            .collect();
        let model = loading
            .split(" --start")
            .next()
            .unwrap_or_default()
            .replace("--symmetry asymmetric ", "");
        let run = object(&format!(
            "integrate --law spinodal {model} --start {} --until {} --points 33 --rtol 1e-14 --method taylor",
            point.join(","),
            made["result"]["orbit"]["period"]["value"]
        ));
        let period = "/result/orbit/period/value";
        assert_close(
            number(&made, period),
            number(&known, period),
            1e-12,
            loading,
        );
        for (row, other) in rows(&made).iter().zip(rows(&run)) {
            alike(row, other, 1e-8, &columns);
        }
    }
}

#[test]
fn orbits_of_systems_are_drawn_and_told() {
    let place = folder("orbit-rows-system");
    let picture = place.join("orbit.svg");
    let command = "orbit --system van-der-pol --crosscheck none";
    let ended = twinslip(&format!(
        "{command} --points 5 --format csv --explain --plot {}",
        picture.display()
    ));
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert_eq!(csv(&ended.out)[0], ["time", "x", "y"]);
    assert!(ended.out.contains("# orbit: period (11.6122306677"));
    assert!(
        ended
            .err
            .contains("on, for the extremes, the rows and the picture")
    );
    let picture = std::fs::read_to_string(picture).expect("a picture");
    assert!(picture.contains("phase plane") && picture.contains("van der Pol"));
    refused_in_one_line(
        &format!("{command} --points 1"),
        "points is 1, but must be from 2",
    );
    refused_in_one_line(
        &format!("{command} --plot orbit.pdf"),
        "must end in .svg or .png",
    );
}
