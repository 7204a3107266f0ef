//! `sweep` over any parameters of any system: against the literature, against the sweeps of equal interfaces, and against itself.

use crate::command;
use command::{csv, folder, object, refused_in_one_line as refused, twinslip};
use std::collections::BTreeMap;
use std::fs;

/// The rows of a sweep, each by the names of its columns.
fn rows(arguments: &str) -> Vec<BTreeMap<String, String>> {
    let ended = twinslip(&format!("sweep -q --format csv {arguments}"));
    assert!(matches!(ended.code, 0 | 3), "{arguments}: {}", ended.err);
    let table = csv(&ended.out);
    let named = |row: &Vec<String>| table[0].iter().cloned().zip(row.iter().cloned()).collect();
    table[1..].iter().map(named).collect()
}

/// Regimes, with q of what is periodic.
fn regimes(rows: &[BTreeMap<String, String>]) -> Vec<String> {
    let told = |row: &BTreeMap<String, String>| {
        let q = row.get("returns_per_period").or(row.get("period_of_orbit"));
        format!("{} {}", row["regime"], q.expect("a column"))
    };
    rows.iter().map(|row| told(row).trim().to_owned()).collect()
}

fn number(row: &BTreeMap<String, String>, name: &str) -> f64 {
    let text = &row[name];
    text.parse().unwrap_or_else(|_| panic!("{name}: {row:?}"))
}

/// That two sweeps of the same points find the same.
fn agree(
    one: &[BTreeMap<String, String>],
    other: &[BTreeMap<String, String>],
    names: &[&str],
    tolerance: f64,
) {
    assert_eq!(one.len(), other.len());
    for (one, other) in one.iter().zip(other) {
        for name in names {
            assert_eq!(one[*name], other[*name], "{one:?} {other:?}");
        }
        for name in ["period", "stress_min", "stress_max"] {
            if one[name].is_empty() {
                assert_eq!(one[name], other[name]);
                continue;
            }
            let (x, y) = (number(one, name), number(other, name));
            assert!((x / y - 1.0).abs() < tolerance, "{name}: {x} {y}");
        }
    }
}

/// Sparrow (1982): nonzero fixed points are stable up to r = 470/19 = 24.74; runs from afar are chaotic at 28, and periodic in the
/// windows around 160 and above 313.
#[test]
fn lorenz_is_steady_chaotic_and_periodic_along_r() {
    let below = rows("--system lorenz --grid r=10:20:3");
    assert_eq!(regimes(&below), ["steady"; 3]);
    // Chaos that ends in rest, sooner or later.
    let transient = rows("--system lorenz --grid r=22:24:5 --max-returns 1024");
    for row in &transient {
        assert!(
            ["steady", "undecided"].contains(&row["regime"].as_str()),
            "{row:?}"
        );
    }
    for row in &below {
        let x = (8.0 / 3.0 * (number(row, "r") - 1.0)).sqrt();
        assert!((number(row, "x_min").abs() - x).abs() < 1e-9, "{row:?}");
        assert!(number(row, "lyapunov_max") < 0.0);
    }
    let beside = rows("--system lorenz --start 7.7,7.7,23 --grid r=23.5:24.5:2");
    assert_eq!(regimes(&beside), ["steady"; 2]);
    let chaos = rows("--system lorenz --grid r=28:28:1");
    assert_eq!(regimes(&chaos), ["chaotic"]);
    // Sprott (2003): 0.9056.
    let found = number(&chaos[0], "lyapunov_max") - 0.9056;
    assert!(found.abs() < number(&chaos[0], "lyapunov_max_uncertainty"));
    for row in rows("--system lorenz --grid r=160:350:2") {
        assert_eq!(row["regime"], "periodic", "{row:?}");
    }
}

/// What starts on the invariant axis, where the origin is unstable, does not stay.
#[test]
fn runs_that_a_symmetry_holds_are_let_go() {
    for start in ["0,0,5", "0,0,0"] {
        let found = rows(&format!(
            "--system lorenz --start {start} --grid r=0.5:10:2"
        ));
        assert_eq!(regimes(&found), ["steady"; 2]);
        assert!(number(&found[0], "x_max").abs() < 1e-6);
        assert!((number(&found[1], "x_max").abs() - 24_f64.sqrt()).abs() < 1e-9);
        assert!(found[0]["note"].is_empty());
        assert!(found[1]["note"].contains("stayed on an unstable symmetric"));
    }
}

/// Roessler (1976) and the cascade of period doublings at a = b = 0.2; the exponent is Sprott's (2003).
#[test]
fn roessler_doubles_its_period_to_chaos() {
    let first = rows("--system roessler --grid c=2.5:3.5:2");
    assert_eq!(regimes(&first), ["periodic 1", "periodic 2"]);
    let second = rows("--system roessler --grid c=4:5.7:2");
    assert_eq!(regimes(&second), ["periodic 4", "chaotic"]);
    let exponent = number(&second[1], "lyapunov_max");
    let bound = number(&second[1], "lyapunov_max_uncertainty");
    assert!(exponent > bound && (exponent - 0.0714).abs() < bound);
}

/// The periods at mu = 1 and 5 are those of Andersen and Geer (1982).
#[test]
fn van_der_pol_is_periodic_everywhere() {
    let found = rows("--system van-der-pol --grid mu=1:5:2 --starts 3");
    assert_eq!(regimes(&found), ["periodic 1"; 6]);
    for (row, period) in found
        .iter()
        .zip([[6.663_286_859_3; 3], [11.612_230_667_8; 3]].concat())
    {
        assert!(
            (number(row, "period") / period - 1.0).abs() < 3e-9,
            "{row:?}"
        );
    }
}

/// FitzHugh-Nagumo fires between its Hopf points, where 1 - v^2 = eps b: at I = 0.3313 and 1.4187. Its parameters may be negative.
#[test]
fn a_nerve_fires_between_its_hopf_points() {
    let found = rows("--system fitzhugh-nagumo --grid I=0.3:0.37:2");
    assert_eq!(regimes(&found), ["steady", "periodic 1"]);
    let found = rows("--system fitzhugh-nagumo --grid I=1.38:1.45:2 --surface w");
    assert_eq!(regimes(&found), ["periodic 1", "steady"]);
    assert!(found[0].contains_key("w_min"));
    let found = rows("--system fitzhugh-nagumo --grid a=-0.7:0.7:3 --set I=0 --surface v=0.1");
    assert_eq!(regimes(&found), ["steady", "periodic 1", "steady"]);
    let rest = number(&found[0], "v_min") + number(&found[2], "v_min");
    assert!(rest.abs() < 1e-9);
}

#[test]
fn another_parameter_of_equal_interfaces_gives_what_its_own_sweep_gives() {
    let plane = rows("--driving 0.14 --stiffness 0.3:0.4:2 --grid residual_strength=1e-3:4e-3:2");
    for (j, c) in ["1e-3", "4e-3"].into_iter().enumerate() {
        let own = rows(&format!(
            "--driving 0.14 --stiffness 0.3:0.4:2 --residual-strength {c}"
        ));
        let names = [
            "driving",
            "stiffness",
            "regime",
            "symmetry",
            "period_of_orbit",
        ];
        agree(&plane[2 * j..2 * j + 2], &own, &names, 1e-7);
        assert_eq!(plane[2 * j]["residual_strength"].parse(), c.parse::<f64>());
    }
    // In another order of the axes, and of other parameters.
    let turned =
        rows("--stiffness 0.3 --grid residual_strength=1e-3:4e-3:2 --grid driving=0.14:0.2:2");
    agree(
        &[turned[0].clone(), turned[1].clone()],
        &[plane[0].clone(), plane[2].clone()],
        &["regime", "start_state_2"],
        1e-9,
    );
    let damped = rows("--driving 0.5 --stiffness 0.3 --grid damping=0:1e-2:2");
    let own = rows("--driving 0.5 --stiffness 0.3 --damping 1e-2");
    agree(&damped[1..], &own, &["regime", "symmetry"], 1e-7);
}

/// The law of the paper, as a file has it.
const SPINODAL: &str = include_str!("../scenes/laws/spinodal.toml");

#[test]
fn a_law_from_a_file_gives_what_the_built_in_one_gives() {
    let path = folder("sweep-law").join("spinodal.toml");
    fs::write(&path, SPINODAL).expect("a file");
    let file = path.display();
    let names = [
        "driving",
        "stiffness",
        "regime",
        "symmetry",
        "period_of_orbit",
    ];
    for grid in [
        "--driving 0.14:0.3:2 --stiffness 0.3:0.4:2",
        "--driving 0.14 --stiffness 0.4 --starts 3",
        "--driving 0.14 --stiffness 0.3 --grid healing_time=50:100:2",
        "--driving 0.14 --stiffness 0.3 --grid residual_strength_2=5e-4:2e-3:2",
        "--driving 0.2 --stiffness 0.2 --interfaces 1",
    ] {
        let built_in = rows(grid);
        agree(
            &rows(&format!("--law {file} {grid}")),
            &built_in,
            &names,
            1e-6,
        );
    }
}

#[test]
fn interfaces_that_hardly_differ_move_as_equal_ones() {
    let grid = "--driving 0.12:0.3:2 --stiffness 0.2:0.4:2";
    let equal = rows(grid);
    let unequal = rows(&format!("{grid} --set residual_strength_2=1.0000000001e-3"));
    agree(&unequal, &equal, &["regime", "period_of_orbit"], 1e-6);
    assert!(unequal.iter().all(|row| row["symmetry"].is_empty()));
}

#[test]
fn one_interface_has_the_orbit_that_orbit_finds() {
    let found = rows("--interfaces 1 --driving 1 --stiffness 0.2:2:2");
    assert_eq!(regimes(&found), ["periodic 1", "steady"]);
    let orbit = object("orbit --interfaces 1 --driving 1 --stiffness 0.2");
    let period = command::number(&orbit, "/result/orbit/period/value");
    assert!((number(&found[0], "period") / period - 1.0).abs() < 1e-7);
    assert!(found[0].contains_key("start_state_1") && !found[0].contains_key("start_state_2"));
}

/// Where an attractor coexists with another, a line that follows stays on it.
/// A damped fault in granite: earthquakes where K < k_c(V_H), which `law` has, and creep where K > k_c(V_H).
#[test]
fn a_fault_quakes_below_its_critical_stiffness_and_creeps_above_it() {
    let fault = "--law regularised-ageing --interfaces 1 --si --time-unit year --direct-effect 0.010 --evolution-effect 0.015 \
        --reference-friction 0.6 --slip-length 10e-6 --normal-stress 50e6 --shear-modulus 30e9 --shear-wave-speed 3000";
    let rows = rows(&format!(
        "{fault} --driving 1e-10:0.3:4log --stiffness 1e9:1e11:3log"
    ));
    assert_eq!(rows.len(), 12);
    for row in &rows {
        let (driving, stiffness) = (number(row, "driving"), number(row, "stiffness"));
        let ends = format!("--from {driving} --to {} --points 2", 2.0 * driving);
        let law = object(&format!("law {fault} {ends}"));
        let critical = command::number(&law, "/result/rows/0/critical_stiffness");
        let expected = if stiffness < critical {
            "periodic"
        } else {
            "steady"
        };
        assert_eq!(row["regime"], expected, "{critical}: {row:?}");
    }
    let picture = folder("sweep-any-fault").join("map.svg");
    let ended = twinslip(&format!(
        "sweep {fault} --driving 1e-10:1e-3:2log --stiffness 1e9:1e11:2log --plot {} --format csv",
        picture.display()
    ));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let picture = fs::read_to_string(picture).expect("a picture");
    assert!(picture.contains("Hopf"));
}

#[test]
fn lines_that_follow_stay_on_their_attractor() {
    let follow = rows("--system lorenz --start 7.7,7.7,23 --grid r=23:24.5:4 --follow");
    assert_eq!(regimes(&follow), ["steady"; 4]);
    let started = number(&follow[1], "start_x") - number(&follow[0], "x_min");
    assert!(started.abs() < 0.01 && started != 0.0);
}

#[test]
fn bytes_are_the_same_however_a_sweep_is_run() {
    let place = folder("sweep-any");
    for (number, sweep) in [
        "sweep -q --system van-der-pol --grid mu=1:4:3 --starts 2 --seed 3",
        "sweep -q --system fitzhugh-nagumo --grid I=0.2:0.6:2 --grid a=0.6:0.8:2 --surface v=0 --start 0,0.5 --follow",
        "sweep -q --driving 0.3 --stiffness 0.3:0.5:2 --grid residual_strength_2=1e-3:2e-3:2log",
        "sweep -q --driving 0.3 --stiffness 0.3:0.5:2 --grid healing_time=100:200:2 --lyapunov",
        "sweep -q --system fitzhugh-nagumo --basin --state-1 v=-1:1:2 --state-2 w=-0.5:0.5:3",
    ]
    .into_iter()
    .enumerate()
    {
        let path = |name: &str| place.join(format!("{number}-{name}.csv"));
        let write = |more: &str, name: &str| {
            let file = path(name);
            let ended = twinslip(&format!("{sweep} {more} -o {}", file.display()));
            assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{sweep} {more}");
            fs::read_to_string(file).expect("written")
        };
        let whole = write("--threads 1", "whole");
        assert_eq!(write("--threads 2", "two"), whole, "{sweep}");
        let cut = path("cut");
        fs::write(&cut, &whole[..whole.len() - 60]).expect("written");
        let ended = twinslip(&format!("{sweep} --resume {}", cut.display()));
        assert_eq!((ended.code, ended.err.as_str()), (0, ""));
        assert_eq!(fs::read_to_string(&cut).expect("read"), whole, "{sweep}");
        write("--shard 1/2", "first");
        write("--shard 2/2", "second");
        let ended = twinslip(&format!(
            "merge -q {} {} -o {}",
            path("second").display(),
            path("first").display(),
            path("merged").display()
        ));
        assert_eq!((ended.code, ended.err.as_str()), (0, ""));
        assert_eq!(fs::read_to_string(path("merged")).expect("read"), whole, "{sweep}");
    }
}

#[test]
fn a_scene_has_a_list_of_axes() {
    let place = folder("sweep-any-scene");
    let path = place.join("map.toml");
    let text = "command = \"sweep\"\nsystem = \"fitzhugh-nagumo\"\ngrid = [\"I=0.2:0.6:2\", \"a=0.6:0.8:2\"]\n";
    fs::write(&path, text).expect("a file");
    let ended = twinslip(&format!("run -q {} --format csv", path.display()));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let flags = twinslip(
        "sweep -q --system fitzhugh-nagumo --grid I=0.2:0.6:2 --grid a=0.6:0.8:2 --format csv",
    );
    assert_eq!(ended.out, flags.out);
    let made = object("sweep --system fitzhugh-nagumo --grid I=0.2:0.6:2");
    assert!(made["model"]["parameters"]["I"].is_null());
    assert_eq!(made["numerics"]["grid"][0], "I=0.2:0.6:2");
    assert_eq!(made["result"]["rows"][1]["I"], 0.6);
    assert_eq!(made["result"]["rows"][1]["start_v"], -1.0);
}

#[test]
fn maps_show_the_parameters() {
    let place = folder("sweep-any-map").join("map.svg");
    let ended = twinslip(&format!(
        "sweep -q --driving 0.3 --grid healing_time=50:200:2log --grid residual_strength=1e-3:2e-3:2 --stiffness 0.4 --plot {} --format csv",
        place.display()
    ));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let svg = fs::read_to_string(place).expect("drawn");
    assert!(svg.contains("healing_time [L/V*]") && svg.contains("residual_strength"));
}

#[test]
fn what_cannot_vary_is_refused_in_one_sentence() {
    for (arguments, sentence) in [
        (
            "--system lorenz",
            "--grid NAME=A:B:N is missing: which parameter of Lorenz varies? They are s, r, b",
        ),
        (
            "--system lorenz --grid q=1:2:2",
            "grid is q, but must be s, r or b",
        ),
        (
            "--system lorenz --grid r",
            "--grid \"r\" must be NAME=A:B:N",
        ),
        ("--system lorenz --grid r=1:2", "\"1:2\" must be A:B:N"),
        (
            "--system lorenz --grid r=-1:2:3log",
            "grid r is -1, but must be positive at both ends",
        ),
        (
            "--system lorenz --grid r=1:2:3 --grid r=1:2:3",
            "--grid r: another --grid already sets it",
        ),
        (
            "--system lorenz --grid r=1:2:3 --set r=2",
            "--grid r: --set already sets it",
        ),
        (
            "--system lorenz --grid r=1:2:2 --grid s=1:2:2 --grid b=1:2:2",
            "two axes at most, but here 3 vary: r, s, b",
        ),
        (
            "--system lorenz --grid r=1:2:2 --driving 0.1",
            "belong to interfaces",
        ),
        (
            "--system lorenz --grid r=1:2:2 --surface q",
            "is q, but must be x, y or z",
        ),
        (
            "--system lorenz --grid r=1:2:2 --surface x=y",
            "must be STATE=VALUE",
        ),
        (
            "--system lorenz --grid r=1:2:2 --start 1,2",
            "must have 3 values",
        ),
        (
            "--interfaces 1 --driving 0.1 --stiffness 0.2 --plot map.svg",
            "here there is none",
        ),
        (
            "--driving 0.1 --grid healing_time=1:2:2",
            "--stiffness A:B:N is missing",
        ),
        (
            "--driving 0.1 --stiffness 0.1 --grid healing_tim=1:2:2",
            "did you mean \"healing_time\"?",
        ),
        (
            "--driving 0.1 --stiffness 0.1 --grid healing_time=-1:2:2",
            "healing-time is -1, but must be positive",
        ),
        (
            "--driving 0.1 --stiffness 0.1 --grid healing_time=1:2:2 --healing-time 3",
            "--healing-time already sets it",
        ),
        (
            "--driving 0.1 --stiffness 0.1 --grid driving=1:2:2",
            "--driving already sets it",
        ),
        (
            "--driving 0.1 --stiffness 0.1 --grid driving_2=1:2:2",
            "the interfaces have one driving in common",
        ),
        (
            "--driving 0.1 --stiffness 0.1 --grid slip_length=1:2:2",
            "it is the unit of other numbers",
        ),
        (
            "--interfaces 1 --driving 0.1 --stiffness 0.1 --grid healing_time_2=1:2:2",
            "there is one interface",
        ),
        (
            "--driving 0.1:0.2:2 --stiffness 0.1:0.2:2 --grid healing_time=1:2:2",
            "two axes at most",
        ),
        (
            "--law composite.toml --driving 0.1 --stiffness 0.1 --grid cutof=0.1:0.2:2",
            "did you mean \"cutoff\"?",
        ),
        (
            "--law composite.toml --driving 0.1 --stiffness 0.1 --grid driving=-0.1:0.2:2",
            "--driving already sets it",
        ),
        (
            "--law composite.toml --stiffness 0.1 --grid driving=-0.1:0.2:2",
            "driving is -0.1, but must be positive",
        ),
    ] {
        refused(&format!("sweep {arguments}"), sentence);
    }
}
