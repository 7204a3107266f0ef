//! Systems whose formulas name time with a period: orbits of whole periods, branches, curves, sections and sweeps, against references of thirty
//! digits.

use crate::command::{folder, number, object, object_or_undecided, refused_in_one_line, twinslip};
use crate::common::{self, data};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};

fn case(id: &str) -> Value {
    let all = data("forced.json");
    let all = all["cases"].as_array().expect("a list");
    let found = all.iter().find(|case| case["id"] == id);
    found.unwrap_or_else(|| panic!("{id}")).clone()
}

/// A file with the equations of a case, begun at its point or at this start.
fn file(case: &Value, start: Option<[f64; 2]>) -> String {
    let id = case["id"].as_str().expect("a name");
    let point = &case["values"]["point_at_phase_0"];
    let start = start.unwrap_or_else(|| ["x", "y"].map(|name| common::number(&point[name])));
    let mut text = format!(
        "name = \"{id}\"\nstates = [\"x\", \"y\"]\nperiod = \"2*pi/w\"\n[start]\nx = {:?}\ny = {:?}\n[rates]\n",
        start[0], start[1]
    );
    for equation in case["problem"]["equations"].as_array().expect("a list") {
        let (rate, formula) = equation
            .as_str()
            .expect("a text")
            .split_once('=')
            .expect("an equation");
        let state = rate.trim().trim_start_matches('d').trim_end_matches("/dt");
        writeln!(text, "{state} = \"{}\"", formula.replace("**", "^")).expect("a string");
    }
    text += "[parameters]\n";
    for (name, value) in case["problem"]["parameters"].as_object().expect("a table") {
        writeln!(text, "{name} = {}", value.as_str().expect("a number")).expect("a string");
    }
    // What a bifurcation is looked for in begins beside it.
    for name in ["g", "w"] {
        if let Some(value) = case["values"].get(name) {
            writeln!(text, "{name} = {:?}", 0.99 * common::number(value)).expect("a string");
        }
    }
    written(&text)
}

/// A file of this test run with a text.
fn written(text: &str) -> String {
    static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| folder("forced"));
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let path = FOLDER.join(format!("{number}.toml"));
    fs::write(&path, text).expect("a file");
    path.to_str().expect("UTF-8").to_owned()
}

/// That a number with an error contains what is known.
#[track_caller]
fn holds(made: &Value, known: f64, sharp: f64) {
    let (value, error) = (number(made, "/value"), number(made, "/uncertainty"));
    assert!(
        (value - known).abs() <= error + 2.0 * f64::EPSILON * known.abs(),
        "{made}: {known}"
    );
    assert!(error <= sharp, "{made}");
}

#[test]
fn orbits_have_the_points_and_multipliers_of_references() {
    for id in [
        "duffing_doublewell_g0.2",
        "duffing_hardening_low_w2.2",
        "forced_vdp_entrained_mu1_g0.5_w1",
    ] {
        let case = case(id);
        let made = object(&format!("orbit --system {}", file(&case, None)));
        let (orbit, values) = (&made["result"]["orbit"], &case["values"]);
        holds(&orbit["period"], common::number(&values["period"]), 1e-12);
        assert_eq!(orbit["turns"], 1);
        assert_eq!(orbit["verdict"], "stable");
        let within = number(orbit, "/point_uncertainty");
        assert!(within < 1e-11, "{id}: {within}");
        for (i, name) in ["x", "y"].into_iter().enumerate() {
            let known = common::number(&values["point_at_phase_0"][name]);
            let off = (number(orbit, &format!("/point/{i}")) - known).abs();
            assert!(off <= within * (1.0 + known.abs()), "{id}: {off}");
        }
        assert_eq!(number(orbit, "/point/2"), 0.0, "{id}: at the phase 0");
        let multipliers = orbit["multipliers"].as_array().expect("a list");
        assert_eq!(multipliers.len(), 2, "{id}");
        for (i, known) in values["multipliers"]
            .as_array()
            .expect("two")
            .iter()
            .enumerate()
        {
            let (re, im) = match known {
                Value::Array(parts) => (common::number(&parts[0]), common::number(&parts[1])),
                real => (common::number(real), 0.0),
            };
            let own = &orbit["log_multipliers"][i];
            holds(&own["ln_abs"], re.hypot(im).ln(), 1e-10);
            let angle = im.abs().atan2(re) / std::f64::consts::PI;
            assert!(
                (number(own, "/angle_over_pi") - angle).abs() < 1e-11,
                "{id}"
            );
        }
    }
}

/// The special points of a kind on a branch.
fn special(made: &Value, label: &str) -> Vec<Value> {
    let all = made["result"]["special"].as_array().expect("a list").iter();
    all.filter(|one| one["label"] == label).cloned().collect()
}

#[test]
fn bifurcations_along_branches_are_the_references() {
    for (id, along, label) in [
        ("duffing_PD_in_g_w1.2", "g", "PD"),
        ("duffing_PD_in_w_g0.25", "w", "PD"),
        ("duffing_fold_in_w_upper_g0.3", "w", "SN"),
        ("duffing_fold_in_g_w1.6", "g", "SN"),
        ("forced_vdp_SN_upper_w", "w", "SN"),
        ("forced_vdp_mu0.2_NS_lower_w", "w", "TR"),
    ] {
        let case = case(id);
        let known = common::number(&case["values"][along]);
        // From its side of stable orbits; torus and period doubling bifurcations are met from either side.
        let (from, to) = (0.93 * known, 1.05 * known);
        let path = file(&case, None);
        let made = object(&format!(
            "branch orbits --system {path} --along {along} --from {from} --to {to}"
        ));
        let found = special(&made, label);
        let best = found.iter().min_by(|a, b| {
            let off = |one: &Value| (number(one, &format!("/{along}/value")) - known).abs();
            off(a).total_cmp(&off(b))
        });
        let best = best.unwrap_or_else(|| panic!("{id}: {}", made["result"]["special"]));
        let (value, error) = (
            number(best, &format!("/{along}/value")),
            number(best, &format!("/{along}/uncertainty")),
        );
        assert!(
            (value - known).abs() <= error,
            "{id}: {value} ± {error} for {known}"
        );
        assert!(error < 1e-11, "{id}: {error}");
    }
}

/// A branch that turns back leaves the range where it began, by another orbit of the same period: its end is listed.
#[test]
fn a_branch_ends_where_it_began_by_another_orbit() {
    let case = case("forced_vdp_SN_upper_w");
    let path = file(&case, Some([2.0, 0.0]));
    let made = object(&format!(
        "branch orbits --system {path} --along w --from 0.95 --to 1.1"
    ));
    let ends = special(&made, "EP");
    assert_eq!(ends.len(), 2, "{ends:?}");
    assert!(
        ends.iter().all(|end| number(end, "/w/value") == 0.95),
        "{ends:?}"
    );
    assert_eq!(special(&made, "SN").len(), 1);
}

/// The whole tongue of one turn a period: folds of orbits down to no forcing, and the torus bifurcations with their strong resonances.
#[test]
fn a_tongue_is_bounded_by_folds_and_by_torus_bifurcations() {
    let case = case("forced_vdp_mu0.2_NS_lower_w");
    let path = file(&case, None);
    let made = object(&format!(
        "locus torus --system {path} --in w,g --range w=0.5:1.5 --range g=0.05:1 --at g=0.3"
    ));
    let known = common::number(&case["values"]["w"]);
    let asked = special(&made, "UZ");
    let nearest = asked
        .iter()
        .map(|one| (number(one, "/w/value") - known).abs());
    assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-11, "{asked:?}");
    for label in ["R1", "R3", "R4"] {
        assert!(!special(&made, label).is_empty(), "{label}");
    }
}

#[test]
fn sections_are_stroboscopic() {
    let quasiperiodic = case("forced_vdp_quasiperiodic_w1.3");
    let path = file(&quasiperiodic, Some([2.0, 0.0]));
    let made = object(&format!(
        "section --system {path} --returns 2000 --skip 300 --lyapunov"
    ));
    let result = &made["result"];
    assert_eq!(result["regime"], "torus");
    // Rotations backwards are those forwards less whole ones.
    let known = common::number(&quasiperiodic["values"]["rotations_per_forcing_period"]);
    let made = &result["rotation_number"];
    let off = (number(made, "/value") - (1.0 - known)).abs();
    assert!(off <= number(made, "/uncertainty"), "{made}");
    // A phase later the same orbit is elsewhere.
    let doublewell = case("duffing_doublewell_g0.2");
    let path = file(&doublewell, None);
    let at = |phase: f64| {
        let made = object(&format!(
            "section --system {path} --surface phase={phase} --skip 60 --returns 12"
        ));
        assert_eq!(made["result"]["regime"], "periodic");
        assert_eq!(made["result"]["period_of_orbit"], 1);
        let last = made["result"]["rows"]
            .as_array()
            .expect("rows")
            .last()
            .cloned();
        let last = last.expect("a row");
        assert_eq!(number(&last, "/phase"), phase);
        number(&last, "/x")
    };
    let known = common::number(&doublewell["values"]["point_at_phase_0"]["x"]);
    assert!((at(0.0) - known).abs() < 1e-7);
    assert!((at(0.5) - known).abs() > 1e-2);
}

/// Duffing's oscillator: one period, two, four, chaos, a window of five.
#[test]
fn sweeps_count_the_periods_of_the_forcing() {
    let case = case("duffing_doublewell_g0.2");
    let path = file(&case, None);
    let made = object(&format!("sweep --system {path} --grid g=0.2:0.38:19"));
    let rows = made["result"]["rows"].as_array().expect("rows");
    let at = |g: f64| {
        let row = rows.iter().find(|row| (number(row, "/g") - g).abs() < 1e-9);
        row.unwrap_or_else(|| panic!("{g}"))
    };
    for (g, turns) in [(0.2, 1), (0.28, 2), (0.29, 4), (0.36, 5)] {
        let row = at(g);
        assert_eq!(row["regime"], "periodic", "{row}");
        assert_eq!(row["returns_per_period"], turns.to_string(), "{row}");
        let period = f64::from(turns) * 2.0 * std::f64::consts::PI / 1.2;
        assert!(
            (number(row, "/period") / period - 1.0).abs() < 1e-12,
            "{row}"
        );
    }
    assert_eq!(at(0.32)["regime"], "chaotic");
    // Orbits of so many periods are found by the search, too.
    let orbit = object(&format!("orbit --system {path} --set g=0.36 --turns 5"));
    let orbit = &orbit["result"]["orbit"];
    assert_eq!(orbit["turns"], 5);
    assert_eq!(orbit["verdict"], "stable");
}

/// A rate that is 0 at the phase 0, and a rounding a period later, has that period.
#[test]
fn rates_that_vanish_have_their_period() {
    let path = written(
        "name = \"n\"\nstates = [\"x\", \"y\"]\nperiod = \"2*pi/w\"\n[parameters]\nw = 2\n[rates]\nx = \"y\"\ny = \"sin(w*t) - 0*x\"\n[start]\nx = 0.3\ny = -0.5\n",
    );
    let made = object_or_undecided(&format!("section --system {path} --returns 3"));
    let rows = made["result"]["rows"].as_array().expect("rows");
    // y = -cos(2 t)/2 returns to its start.
    assert!(
        rows.iter()
            .all(|row| (number(row, "/y") + 0.5).abs() < 1e-6),
        "{rows:?}"
    );
}

#[test]
fn what_cannot_be_is_refused() {
    let case = case("duffing_doublewell_g0.2");
    let path = file(&case, None);
    for (command, sentence) in [
        ("orbit --turns 0", "turns"),
        ("orbit --period-guess 5", "say how many by --turns"),
        ("orbit --turns 2", "shorter by a factor of 2"),
        (
            "branch orbits --along g --from 0.2 --to 0.21 --turns 3",
            "no orbit of so many periods",
        ),
        ("section --surface x=0", "phase=VALUE"),
        ("section --surface phase=1.5", "below 1"),
        ("equilibria", "no equilibria"),
        (
            "branch equilibria --along g --from 0 --to 1",
            "no equilibria",
        ),
        (
            "locus hopf --in w,g --range w=1:2 --range g=1:2",
            "no equilibria",
        ),
    ] {
        let ended = twinslip(&format!("{command} --system {path}"));
        assert!(
            ended.code != 0 && ended.err.contains(sentence),
            "{command}: {}",
            ended.err
        );
    }
    // On a torus nothing repeats.
    let drifts = file(
        &self::case("forced_vdp_quasiperiodic_w1.3"),
        Some([2.0, 0.0]),
    );
    let ended = twinslip(&format!("orbit --system {drifts}"));
    assert!(
        ended.code == 1 && ended.err.contains("does not repeat after"),
        "{}",
        ended.err
    );
    refused_in_one_line("orbit --system lorenz --turns 2", "nothing is forced here");
    let wrong = |text: &str, sentence: &str| {
        let text = text.replace('|', "\n");
        let path = written(&text);
        refused_in_one_line(&format!("orbit --system {path}"), sentence);
    };
    const BEGIN: &str = "name = \"n\"|states = [\"x\"]|";
    const END: &str = "|[parameters]|w = 2|[rates]|x = \"cos(w*t) - x\"|[start]|x = 0.3|";
    wrong(
        &format!("{BEGIN}period = \"3*pi/w\"{END}"),
        "is none: the rate of x is",
    );
    wrong(
        &format!("{BEGIN}period = \"x\"{END}"),
        "\"x\" is a state, on which a period cannot depend",
    );
    wrong(
        &format!("{BEGIN}period = \"t\"{END}"),
        "\"t\" is time, on which a period cannot depend",
    );
    wrong(&format!("{BEGIN}period = \"-2*pi/w\"{END}"), "positive");
    wrong(
        &format!("{BEGIN}period = \"2*pi/w\"{}", END.replace("w*t", "w")),
        "no formula names t",
    );
}
