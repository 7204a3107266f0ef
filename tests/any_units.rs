//! Systems from files in any units: the same points, periods and verdicts, and branches as long.

use crate::command::{self, folder, number};
use crate::common::in_units::{Scaled, drawn, own};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde_json::Value;
use std::fs;

fn made(arguments: &str) -> Value {
    let ended = command::twinslip(&format!("{arguments} --format json -q"));
    assert_eq!(ended.code, 0, "{arguments}: {}", ended.err);
    serde_json::from_str(&ended.out).expect("JSON")
}

/// Labels of special points, with the parameter and the period, and the number of rows.
fn branch(arguments: &str, parameter: &str) -> (Vec<(String, f64, f64)>, usize) {
    let made = made(&format!("branch orbits {arguments}"));
    let points = made["result"]["special"].as_array().expect("a list");
    let points = points.iter().map(|one| {
        let label = one["label"].as_str().expect("a label").to_owned();
        let value = number(one, &format!("/{parameter}/value"));
        (label, value, number(one, "/period/value"))
    });
    let rows = made["result"]["rows"].as_array().expect("rows").len();
    (points.collect(), rows)
}

/// A label, the parameter and, where it is told, the period.
type Known = (&'static str, f64, Option<f64>);

/// Points that AUTO-07p finds (NTST 100 to 300, NCOL 4, EPS 1e-8), with the parameter and, where it tells it, the period.
#[test]
fn branches_of_oscillators_in_their_own_units_are_whole() {
    let all: [(&str, &str, &[Known]); 4] = [
        (
            "morris-lecar-cycle.toml --along I --from 80 --to 230",
            "I",
            &[
                ("HB", 93.8576184, None),
                ("SN", 88.2932505, Some(135.386)),
                ("SN", 216.8998014, Some(77.929)),
                ("HB", 212.0188161, None),
            ],
        ),
        (
            "jansen-rit-cycle.toml --along p --from 50 --to 350",
            "p",
            &[("HB", 89.8291, None), ("HB", 315.6964, None)],
        ),
        (
            "goldbeter-cycle.toml --along vi --from 0.005 --to 0.095276",
            "vi",
            &[
                ("HB", 0.0119169, None),
                ("SN", 0.0108244, Some(21.2184)),
                ("EP", 0.095276, Some(14.0723)),
            ],
        ),
        // Relaxation: of a period of 194 jumps take some 1e-4. The period is that of SciPy's Radau with rtol = 1e-11.
        (
            "brusselator-stiff.toml --along B --from 1.5 --to 26.5",
            "B",
            &[("HB", 2.0, None), ("EP", 26.5, Some(194.064335412))],
        ),
    ];
    are_whole(&all, 80);
}

/// Along a canard everything grows by e^100, and AUTO-07p (NTST 200 and 400) tells a dozen false folds and branch points; these two folds
/// it finds. The symmetry v -> -v, w -> 7/4 - w, I -> 7/4 - I takes each half to the other.
#[test]
fn a_branch_with_two_canards_is_whole() {
    let all: [(&str, &str, &[Known]); 1] = [(
        "fitzhugh-nagumo-canard.toml --along I --from 0.1 --to 1.6",
        "I",
        &[
            ("HB", 0.2966607, None),
            ("SN", 0.2957290101, Some(514.35)),
            ("SN", 1.4542709899, Some(514.35)),
            ("HB", 1.4533393, None),
        ],
    )];
    are_whole(&all, 350);
}

fn are_whole(all: &[(&str, &str, &[Known])], most: usize) {
    for &(arguments, parameter, known) in all {
        let (points, rows) = branch(&format!("--system tests/data/cases/{arguments}"), parameter);
        assert_eq!(points.len(), known.len(), "{points:?}");
        assert!(rows < most, "{arguments}: {rows} rows");
        for ((label, value, period), (wanted, at, known)) in points.iter().zip(known) {
            // To the digits that are told.
            let digits = |x: f64| {
                0.5 * 10.0_f64.powi(-(x.to_string().split('.').nth(1).map_or(0, str::len) as i32))
            };
            assert_eq!(label, wanted, "{points:?}");
            assert!(
                (value - at).abs() <= 1.001 * digits(*at),
                "{label} {value} {at}"
            );
            if let Some(known) = known {
                assert!(
                    (period - known).abs() <= 2.0 * digits(*known),
                    "{label} {period} {known}"
                );
            }
        }
    }
}

/// Roessler's system with x = sx X, y = sy Y, z = sz Z and time in units of st.
fn roessler(test: &str, [sx, sy, sz]: [f64; 3], st: f64) -> String {
    let text = format!(
        "name = \"roessler-scaled\"\nstates = [\"x\", \"y\", \"z\"]\n[parameters]\na = 0.2\nb = 0.2\nc = 2.0\n[rates]\n\
         x = \"{st:e}*(-{sy:e}*y - {sz:e}*z)/{sx:e}\"\n\
         y = \"{st:e}*({sx:e}*x + a*{sy:e}*y)/{sy:e}\"\n\
         z = \"{st:e}*(b + {sz:e}*z*({sx:e}*x - c))/{sz:e}\"\n\
         [start]\nx = {:e}\ny = 0.0\nz = 0.0\n",
        1.0 / sx
    );
    let name = format!("any_units_{test}_{sx:e}_{sy:e}_{sz:e}_{st:e}");
    let file = folder(&name).join("system.toml");
    fs::write(&file, text).expect("a file");
    file.display().to_string()
}

const UNITS: [([f64; 3], f64); 5] = [
    ([1.0; 3], 1.0),
    ([1e3; 3], 1.0),
    ([1e-3; 3], 1e4),
    ([1e6, 1e-6, 3e2], 1e-5),
    ([7e-5, 2e4, 1e-6], 4e3),
];

#[test]
fn a_branch_of_orbits_is_the_same_in_any_units() {
    let known = branch(
        &format!(
            "--system {} --along c --from 0.5 --to 6",
            roessler("branch", [1.0; 3], 1.0)
        ),
        "c",
    );
    let doubling = known
        .0
        .iter()
        .find(|(label, ..)| label == "PD")
        .expect("a period doubling");
    assert!(
        (doubling.1 - 2.832_445_027_862_54).abs() < 1e-11,
        "{doubling:?}"
    );
    for (sizes, time) in UNITS {
        let (points, rows) = branch(
            &format!(
                "--system {} --along c --from 0.5 --to 6",
                roessler("branch", sizes, time)
            ),
            "c",
        );
        assert_eq!(points.len(), known.0.len(), "{points:?}");
        for (point, wanted) in points.iter().zip(&known.0) {
            assert_eq!(point.0, wanted.0, "{points:?}");
            assert!(
                (point.1 / wanted.1 - 1.0).abs() < 1e-11,
                "{point:?} {wanted:?}"
            );
            assert!(
                (point.2 * time / wanted.2 - 1.0).abs() < 1e-11,
                "{point:?} {wanted:?}"
            );
        }
        let more = rows as f64 / known.1 as f64;
        assert!(
            (0.7..1.4).contains(&more),
            "{rows} rows, {} in its own units",
            known.1
        );
    }
}

#[test]
fn an_orbit_is_the_same_in_any_units() {
    let orbit = |sizes, time| {
        made(&format!(
            "orbit --system {} --set c=2.5",
            roessler("orbit", sizes, time)
        ))
    };
    let known = orbit([1.0; 3], 1.0);
    let near = |made: &Value, pointer: &str, unit: f64| {
        let of = |object: &Value, part: &str| number(object, &format!("{pointer}/{part}"));
        let off = (of(made, "value") * unit - of(&known, "value")).abs();
        let told = of(made, "uncertainty") * unit + of(&known, "uncertainty");
        assert!(off <= told, "{pointer}: {off} > {told}");
        // No wider than it is in other units, by much.
        assert!(
            told < 100.0 * of(&known, "uncertainty"),
            "{pointer}: {told}"
        );
    };
    for (sizes, time) in UNITS {
        let made = orbit(sizes, time);
        near(&made, "/result/orbit/period", time);
        near(&made, "/result/orbit/log_multipliers/0/ln_abs", 1.0);
        assert_eq!(
            made["result"]["orbit"]["verdict"],
            known["result"]["orbit"]["verdict"]
        );
        let differs = number(&made, "/result/orbit/crosscheck/period_difference");
        assert!(differs.abs() < 1e-10 * number(&known, "/result/orbit/period/value") / time);
    }
}

/// The first Lyapunov coefficient is that of the file's own units, |q| = 1 in these.
#[test]
fn coefficients_are_those_of_the_units_of_the_file() {
    let coefficient = |sizes: [f64; 3]| {
        let file = roessler("coefficient", sizes, 1.0);
        let made = made(&format!(
            "branch equilibria --system {file} --along a --from -0.5 --to 0.5 --set c=2.5"
        ));
        let points = made["result"]["special"]
            .as_array()
            .expect("a list")
            .clone();
        let hopf = points
            .iter()
            .find(|one| one["label"] == "HB")
            .expect("a Hopf point")
            .clone();
        number(&hopf, "/coefficient")
    };
    // In units that are k times larger q is k times longer in the old ones: |q|^2 and with it the coefficient grows by k^2.
    let (own, larger) = (coefficient([1.0; 3]), coefficient([100.0; 3]));
    assert!((larger / own / 1e4 - 1.0).abs() < 1e-9, "{own} {larger}");
}

/// A branch begins so near its Hopf point that a value close by is landed on: on the unstable orbits between that and the fold, and on the others.
#[test]
fn values_beside_a_hopf_point_are_landed_on() {
    let arguments = "--system fitzhugh-nagumo --along I --from 0 --to 0.6 --at 0.33";
    let (points, _) = branch(arguments, "I");
    let landed = points.iter().filter(|(label, ..)| label == "UZ").count();
    assert_eq!(landed, 2, "{points:?}");
}

/// Models of mechanics, neuroscience, biochemistry, ecology and circuits.
#[test]
fn models_are_the_same_in_any_units() {
    const ALL: [(&str, &str, f64, bool); 30] = [
        ("chemostat-ciliate", "D", 0.0625, true),
        ("circadian-per", "hr", 3600.0, true),
        ("colpitts", "C", 5.4e-08, true),
        ("connor-stevens", "I", 12.0, true),
        ("cstr", "tau", 60.0, true),
        ("goldbeter-lefever", "v", 0.7, true),
        ("goldbeter-mitotic", "mi", 60.0, true),
        ("goodwin", "n", 12.5, true),
        // Its runs are chaotic for long: which of its orbits is met depends on rounding.
        ("hastings-powell", "ba", 2.2, false),
        ("hindmarsh-rose", "I", 2.0, true),
        ("holling-tanner", "a", 1.0, true),
        ("jansen-rit", "A", 3.25, true),
        ("lengyel-epstein", "a", 10.0, true),
        ("li-rinzel", "ip", 4e-07, true),
        ("loladze", "b", 1.2, true),
        ("mckean", "a", 0.25, true),
        ("morris-lecar-si", "C", 0.2, true),
        ("nf-kb", "A", 0.007, true),
        ("repressilator", "al", 216.0, true),
        ("rosenzweig-macarthur", "r", 0.5, true),
        ("selkov", "a", 0.08, true),
        ("sherman-beta-cell", "tau", 20.0, true),
        ("stribeck-belt", "m", 1.0, true),
        ("tsodyks-markram", "tau", 0.013, true),
        ("tunnel-diode", "C", 5e-12, true),
        ("wang-buzsaki", "phi", 5.0, true),
        ("watt-governor", "al", 0.5, false),
        ("wheel-shimmy", "I", 1.0, true),
        ("wien-bridge", "R", 10000.0, true),
        ("wilson-cowan", "tau", 0.008, true),
    ];
    let mut random = ChaCha8Rng::seed_from_u64(50);
    // Every other one, others each time.
    let half = crate::common::random() as usize % 2;
    for (name, parameter, value, oscillates) in ALL.into_iter().skip(half).step_by(2) {
        let systems = [own(name), drawn("branch", name, &mut random)];
        let points = |system: &Scaled| {
            let text = format!(
                "branch equilibria --system {} --along {parameter} --from {} --to {} --format json -q",
                system.file,
                system.inward(parameter, 0.7 * value),
                system.inward(parameter, 1.3 * value)
            );
            let ended = command::twinslip(&text);
            let made: Value = serde_json::from_str(&ended.out).expect("JSON");
            let special = made["result"]["special"]
                .as_array()
                .expect("a list")
                .clone();
            let mut points: Vec<(String, f64, f64)> = Vec::new();
            for one in &special {
                let at = &one[parameter];
                let at = [&at["value"], &at["uncertainty"]]
                    .map(|x| system.of(parameter) * x.as_f64().unwrap_or(f64::INFINITY));
                points.push((
                    one["label"].as_str().expect("a label").to_owned(),
                    at[0],
                    at[1],
                ));
            }
            points.sort_by(|a, b| (a.1, &a.0).partial_cmp(&(b.1, &b.0)).expect("numbers"));
            (ended.code, points)
        };
        let (known, found) = (points(&systems[0]), points(&systems[1]));
        assert_eq!(known.0, found.0, "{name}");
        assert_eq!(known.1.len(), found.1.len(), "{name}: {known:?} {found:?}");
        for (a, b) in known.1.iter().zip(&found.1) {
            assert_eq!(a.0, b.0, "{name}: {known:?} {found:?}");
            // The ends of the range are exact, but for their rounding in another unit.
            let told = a.2 + b.2 + 2.0 * f64::EPSILON * a.1.abs();
            assert!((a.1 - b.1).abs() <= told, "{name}: {a:?} {b:?}");
        }
        if oscillates {
            let [a, b] = systems.each_ref().map(|system| {
                let made = made(&format!("orbit --system {} --crosscheck none", system.file));
                let of = |part: &str| {
                    system.time * number(&made, &format!("/result/orbit/period/{part}"))
                };
                (
                    of("value"),
                    of("uncertainty"),
                    made["result"]["orbit"]["verdict"].clone(),
                )
            });
            assert!((a.0 - b.0).abs() <= a.1 + b.1, "{name}: {a:?} {b:?}");
            assert_eq!(a.2, b.2, "{name}");
        }
    }
}

/// At the default tolerances: each state at the end, within the bounds of both, and these are alike.
#[test]
fn runs_are_the_same_in_any_units() {
    const ALL: [(&str, f64); 20] = [
        ("chemostat-ciliate", 60.0),
        ("circadian-per", 60.0),
        ("connor-stevens", 30.0),
        ("cstr", 6.0),
        ("goldbeter-lefever", 40.0),
        ("goldbeter-mitotic", 1000.0),
        ("goodwin", 40.0),
        ("holling-tanner", 60.0),
        ("hindmarsh-rose", 80.0),
        ("jansen-rit", 0.4),
        ("lengyel-epstein", 20.0),
        ("li-rinzel", 30.0),
        ("mckean", 40.0),
        ("morris-lecar-si", 0.3),
        ("robertson", 40.0),
        ("rosenzweig-macarthur", 100.0),
        ("selkov", 60.0),
        ("stribeck-belt", 30.0),
        ("tunnel-diode", 1e-8),
        ("wilson-cowan", 0.1),
    ];
    let mut random = ChaCha8Rng::seed_from_u64(51);
    for (name, until) in ALL {
        let [a, b] = [own(name), drawn("run", name, &mut random)].map(|system| {
            let made = made(&format!(
                "integrate --system {} --until {:e} --final-only --estimate-error",
                system.file,
                until / system.time
            ));
            let states = made["model"]["states"].as_array().expect("states").clone();
            let last = &made["result"]["final"];
            let of = |state: &Value| {
                let state = state.as_str().expect("a name");
                let [x, off] = [state.to_owned(), format!("{state}_uncertainty")]
                    .map(|key| system.of(state) * number(last, &format!("/{key}")));
                (x, off)
            };
            states.iter().map(of).collect::<Vec<_>>()
        });
        for ((x, off), (y, other)) in a.iter().zip(&b) {
            assert!((x - y).abs() <= off + other, "{name}: {a:?} {b:?}");
            let size = x.abs().max(y.abs());
            assert!(*other < 100.0 * off.max(1e-9 * size), "{name}: {a:?} {b:?}");
        }
    }
}

/// What returns say, the periods and exponents, and what maps of regimes say.
#[test]
fn sections_and_sweeps_are_the_same_in_any_units() {
    const ALL: [(&str, &str, f64, &str, f64); 8] = [
        ("selkov", "x", 0.6, "a", 0.08),
        ("goodwin", "x", 0.3, "n", 12.5),
        ("holling-tanner", "x", 0.3, "a", 1.0),
        ("goldbeter-mitotic", "M", 0.3, "mi", 60.0),
        ("jansen-rit", "ya", 0.11, "A", 3.25),
        ("lengyel-epstein", "x", 2.0, "a", 10.0),
        ("wilson-cowan", "E", 0.2, "tau", 0.008),
        ("rosenzweig-macarthur", "N", 50.0, "r", 0.5),
    ];
    let mut random = ChaCha8Rng::seed_from_u64(52);
    for (name, state, value, parameter, at) in ALL {
        let systems = [own(name), drawn("section", name, &mut random)];
        let [a, b] = systems.each_ref().map(|system| {
            let made = made(&format!(
                "section --system {} --surface {state}={:e} --skip 60 --returns 60 --lyapunov",
                system.file,
                value / system.of(state)
            ));
            let result = &made["result"];
            let period = [0, 1].map(|i| {
                let part = ["value", "uncertainty"][i];
                system.time * result["period"][part].as_f64().unwrap_or(0.0)
            });
            let exponent = result["lyapunov"][1]["value"].as_f64().unwrap_or(0.0) / system.time;
            (result["regime"].clone(), period, exponent)
        });
        assert_eq!(a.0, b.0, "{name}: {a:?} {b:?}");
        assert_eq!(a.0, "periodic", "{name}");
        let off = (a.1[0] - b.1[0]).abs();
        assert!(off <= a.1[1] + b.1[1], "{name}: {a:?} {b:?}");
        assert!((a.2 / b.2 - 1.0).abs() < 1e-6, "{name}: {a:?} {b:?}");
        let [a, b] = systems.each_ref().map(|system| {
            let made = made(&format!(
                "sweep --system {} --grid {parameter}={}:{}:3",
                system.file,
                system.inward(parameter, 0.8 * at),
                system.inward(parameter, 1.2 * at)
            ));
            let rows = made["result"]["rows"].as_array().expect("rows").clone();
            let of = |row: &Value| {
                let period = system.time * row["period"].as_f64().unwrap_or(0.0);
                (
                    row["regime"].clone(),
                    row["returns_per_period"].clone(),
                    period,
                )
            };
            rows.iter().map(of).collect::<Vec<_>>()
        });
        for (x, y) in a.iter().zip(&b) {
            assert_eq!((&x.0, &x.1), (&y.0, &y.1), "{name}: {a:?} {b:?}");
            assert!((x.2 - y.2).abs() <= 1e-7 * x.2, "{name}: {a:?} {b:?}");
        }
    }
}

/// Along canards that grow by e^130 a step may turn round: then the branch does not end at the Hopf point that it began at, as one that has gone
/// round does, but says that it came back.
#[test]
fn no_branch_ends_at_the_hopf_point_that_it_begins_at() {
    let text = "branch orbits --system tests/data/cases/oregonator-canards.toml --along f --from 0.3 --to 3 --format json -q";
    let made: Value = serde_json::from_str(&command::twinslip(text).out).expect("JSON");
    let special = made["result"]["special"].as_array().expect("a list");
    let of = |branch: u64| special.iter().filter(move |one| one["branch"] == branch);
    for branch in 0..2 {
        let hopfs = of(branch).filter(|one| one["label"] == "HB");
        let at: Vec<f64> = hopfs.map(|one| number(one, "/f/value")).collect();
        assert!(at.len() < 2 || at[0] != at[1], "{branch}: {at:?}");
    }
    // It goes all the way, past the fold at which the canards explode.
    let whole = (0..2).any(|branch| {
        let labels: Vec<&str> = of(branch).filter_map(|one| one["label"].as_str()).collect();
        labels == ["HB", "SN", "HB"]
    });
    assert!(whole, "{special:?}");
}

/// Relaxation with a contraction by e^-1e6 and more, where Taylor's method would take millions of steps a period.
#[test]
fn a_stiff_branch_goes_on_by_the_implicit_method() {
    let file = "tests/data/cases/brusselator-stiff.toml";
    let (points, rows) = branch(
        &format!("--system {file} --along B --from 1.5 --to 70"),
        "B",
    );
    let labels: Vec<&str> = points.iter().map(|(label, ..)| label.as_str()).collect();
    assert_eq!(labels, ["HB", "EP"]);
    assert!(rows < 120, "{rows} rows");
    // The same orbit by another method from a start of its own.
    let orbit = made(&format!(
        "orbit --system {file} --set B=70 --method rodas5p --crosscheck none"
    ));
    let [period, off] = ["value", "uncertainty"]
        .map(|part| number(&orbit, &format!("/result/orbit/period/{part}")));
    assert!(off < 1e-3 * period, "{period} ± {off}");
    assert!(
        (points[1].2 - period).abs() <= off + 1e-9 * period,
        "{points:?} {period} ± {off}"
    );
}
