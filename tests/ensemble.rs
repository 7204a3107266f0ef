//! The uncertainty of a fit in what follows from it, against closed forms with the covariance propagated by hand.

use crate::command::{csv, folder, number, object, twinslip};
use crate::common::ROOT;
use crate::common::relative;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// Between these multiples of a standard error a normal number is with 95 %.
const DEVIATIONS: f64 = 1.959_963_984_540_054;
/// Derivatives by differences are as good as this.
const ACCURACY: f64 = 1e-6;

fn data(name: &str) -> PathBuf {
    Path::new(ROOT).join("tests/data").join(name)
}

/// A fit of the law of Dieterich and Ruina; its parameters are ln a, ln b, ln L and a_v.
fn fit() -> String {
    data("fit.json").display().to_string()
}

/// Of the spinodal law, with ln c too.
fn spinodal() -> String {
    data("fit-spinodal.json").display().to_string()
}

const A: f64 = 0.0101;
const B: f64 = 0.0152;
const L: f64 = 9.1e-6;
const A_V: f64 = 0.607;
const SIGMA: f64 = 2e7;
const V_STAR: f64 = 3e-6;

/// sqrt(g' C g), with the correlations that the file has and the standard errors of ln a, ln b, ln L and a_v.
fn deviation(gradient: [f64; 4]) -> f64 {
    let errors = [0.02, 0.025, 0.03, 1e-4];
    let correlation = [
        [1.0, 0.75, 0.12, -0.05],
        [0.75, 1.0, -0.02, 0.04],
        [0.12, -0.02, 1.0, -0.26],
        [-0.05, 0.04, -0.26, 1.0],
    ];
    let mut variance = 0.0;
    for i in 0..4 {
        for j in 0..4 {
            variance += gradient[i] * errors[i] * correlation[i][j] * gradient[j] * errors[j];
        }
    }
    variance.sqrt()
}

/// k_c = (b - a) sigma/L and its standard error.
fn critical_stiffness() -> (f64, f64) {
    let k = (B - A) * SIGMA / L;
    let gradient = [-A * SIGMA / L, B * SIGMA / L, -k, 0.0];
    (k, deviation(gradient))
}

/// That a band is value ± half, half to [`ACCURACY`] of itself.
#[track_caller]
fn is_band(object: &Value, name: &str, value: f64, half: f64) {
    let end = |end: &str| number(object, &format!("/{name}_{end}"));
    let (low, high) = (end("lower"), end("upper"));
    assert!(
        relative(0.5 * (high - low), half) < ACCURACY,
        "{name}: {low} to {high}, but {value} with {half}"
    );
    assert!((0.5 * (low + high) - value).abs() < ACCURACY * half);
}

/// The same of the logarithm.
#[track_caller]
fn is_log_band(object: &Value, name: &str, value: f64, half: f64) {
    let end = |end: &str| number(object, &format!("/{name}_{end}")).ln();
    let logs = json!({ "x_lower": end("lower"), "x_upper": end("upper") });
    is_band(&logs, "x", value.ln(), half);
}

#[test]
fn a_law_has_the_bands_of_its_closed_form() {
    let made = object(&format!("law --points 7 --ensemble {}:0", fit()));
    let rows = made["result"]["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 7);
    let (k, of_k) = critical_stiffness();
    for row in rows {
        let v = number(row, "/slip_rate");
        let x = (v / V_STAR).ln();
        let friction = A_V + (A - B) * x;
        let half = DEVIATIONS * deviation([A * x, -B * x, 0.0, 1.0]);
        assert!(relative(number(row, "/friction"), friction) < 1e-12);
        is_band(row, "friction", friction, half);
        is_band(row, "stress", SIGMA * friction, SIGMA * half);
        is_band(row, "critical_stiffness", k, DEVIATIONS * of_k);
        is_log_band(row, "state", L / v, DEVIATIONS * 0.03);
    }
    // Nothing is known of draws that there are not.
    let ensemble = &made["result"]["ensemble"];
    assert_eq!(ensemble["draws"], 0);
    assert_eq!(ensemble["check"], Value::Null);
    let fitted = [
        "direct_effect",
        "evolution_effect",
        "slip_length",
        "reference_friction",
    ];
    assert_eq!(ensemble["parameters"], json!(fitted));
    assert_eq!(number(&made, "/model/healing_time"), 300.0);
}

#[test]
fn draws_agree_with_derivatives_where_a_law_is_nearly_linear() {
    let made = object(&format!("law --points 5 --ensemble {}:2000", fit()));
    let ensemble = &made["result"]["ensemble"];
    assert_eq!(
        (&ensemble["draws"], &ensemble["failed"]),
        (&json!(2000), &json!(0))
    );
    let check = &ensemble["check"];
    // Of 20 ends or more none is further off than three standard errors of a quantile make it, and the curvature of exp little.
    assert!(
        number(check, "/largest") < number(check, "/by_chance") + 0.03,
        "{check}"
    );
    assert!((number(check, "/by_chance") - 0.0914).abs() < 1e-3);
    assert_eq!(check["apart"], 0);
    // The same draws again.
    let again = object(&format!("law --points 5 --ensemble {}:2000", fit()));
    assert_eq!(made["result"], again["result"]);
}

#[test]
fn landmarks_have_bands_and_a_probability() {
    let made = object(&format!("law --points 3 --ensemble {}:50", spinodal()));
    let result = &made["result"];
    let maximum = &result["extrema"][0];
    assert_eq!(
        (&maximum["kind"], &maximum["probability"]),
        (&json!("maximum"), &json!(1.0))
    );
    // High-velocity strengthening begins at V = V*/c: 5 % of a standard error.
    let rate = number(result, "/transition_rate");
    assert!(relative(rate, 1e-3) < 1e-12);
    is_log_band(result, "transition_rate", rate, DEVIATIONS * 0.05);
    assert_eq!(result["transition_rate_probability"], 1.0);
    let top = &result["critical_stiffness_maximum"];
    let value = number(top, "/stiffness/value");
    let (low, high) = (
        number(top, "/stiffness_lower"),
        number(top, "/stiffness_upper"),
    );
    assert!(low < value && value < high, "{top}");
    assert!(top["stiffness_draws"].is_array());
}

#[test]
fn steady_states_have_bands_and_the_probability_that_they_are_stable() {
    let (k, of_k) = critical_stiffness();
    // Half a standard error stiffer than critical: stable with Phi(1/2).
    let stiffness = k + 0.5 * of_k;
    let asked = format!(
        "equilibria --interfaces 1 --driving 1e-6 --stiffness {stiffness:e} --ensemble {}:2000",
        fit()
    );
    let made = object(&asked);
    let state = &made["result"]["equilibria"][0];
    let x = (1e-6 / V_STAR).ln();
    let half = SIGMA * DEVIATIONS * deviation([A * x, -B * x, 0.0, 1.0]);
    is_band(state, "stress", SIGMA * (A_V + (A - B) * x), half);
    let of_state = json!({
        "state_lower": state["state_lower"][0],
        "state_upper": state["state_upper"][0],
    });
    is_log_band(&of_state, "state", L / 1e-6, DEVIATIONS * 0.03);
    assert_eq!(state["probability"], 1.0);
    assert_eq!(made["result"]["ensemble"]["counts"], json!({ "1": 1.0 }));
    // Four standard errors of the part of 2000 draws.
    let expected = 0.691_462_461_274;
    let error = (expected * (1.0 - expected) / 2000_f64).sqrt();
    let found = number(state, "/probability_stable");
    assert!((found - expected).abs() < 4.0 * error, "{found}");
}

#[test]
fn a_sweep_has_the_probability_of_each_regime() {
    let (k, of_k) = critical_stiffness();
    let stiffness = k + 0.5 * of_k;
    let asked = format!(
        "sweep --interfaces 1 --driving 1e-6 --stiffness {stiffness:e}:{:e}:2 --ensemble {}:60",
        k + 4.0 * of_k,
        fit()
    );
    let made = object(&asked);
    let rows = made["result"]["rows"].as_array().expect("rows");
    assert_eq!(
        (&rows[0]["regime"], &rows[1]["regime"]),
        (&json!("steady"), &json!("steady"))
    );
    let expected = 0.691_462_461_274;
    let error = (expected * (1.0 - expected) / 60_f64).sqrt();
    let found = number(&rows[0], "/probability_steady");
    assert!((found - expected).abs() < 3.0 * error, "{found}");
    assert!(number(&rows[1], "/probability_steady") > 0.98);
    // What is not steady runs away: this law has no bound.
    let all = found + number(&rows[0], "/probability_undecided");
    assert!((all - 1.0).abs() < 1e-12);
    let regimes = &made["result"]["ensemble"]["regimes"];
    let mean = 0.5 * (found + number(&rows[1], "/probability_steady"));
    assert!((number(regimes, "/steady") - mean).abs() < 1e-12);
    // The same draws as those of equilibria, and the same stability.
    let of_equilibria = object(&format!(
        "equilibria --interfaces 1 --driving 1e-6 --stiffness {stiffness:e} --ensemble {}:60",
        fit()
    ));
    let stable = number(&of_equilibria, "/result/equilibria/0/probability_stable");
    assert_eq!(found, stable);
}

#[test]
fn a_hopf_curve_has_the_band_of_the_critical_stiffness() {
    let place = folder("ensemble-hopf");
    let path = place.join("hopf.csv");
    let asked = format!(
        "locus hopf --interfaces 1 --driving-range 1e-7:1e-5 --ensemble {}:0 -q -o {}",
        fit(),
        path.display()
    );
    let ended = twinslip(&asked);
    assert_eq!((ended.code, ended.err.as_str()), (0, ""));
    let rows = csv(&fs::read_to_string(&path).expect("written"));
    let at = |name: &str| {
        rows[0]
            .iter()
            .position(|own| own == name)
            .expect("a column")
    };
    let (k, of_k) = critical_stiffness();
    assert!(rows.len() > 10);
    for row in &rows[1..] {
        let cell = |name: &str| row[at(name)].parse::<f64>().expect("a number");
        let object = json!({
            "k_lower": cell("stiffness_lower"),
            "k_upper": cell("stiffness_upper"),
        });
        assert!(relative(cell("stiffness"), k) < 1e-12);
        is_band(&object, "k", k, DEVIATIONS * of_k);
    }
    // Both new columns are the last ones.
    let last = &rows[0][rows[0].len() - 2..];
    assert_eq!(last, ["stiffness_lower", "stiffness_upper"]);
    // The ends of the curve have periods: 2 pi (L/V) sqrt(a/(b - a)).
    let special = csv(&fs::read_to_string(place.join("hopf.special.csv")).expect("written"));
    let at = |name: &str| {
        special[0]
            .iter()
            .position(|own| own == name)
            .expect("a column")
    };
    let part = [0.5 * (1.0 + A / (B - A)), -0.5 * B / (B - A), 1.0, 0.0];
    for row in &special[1..] {
        let cell = |name: &str| row[at(name)].parse::<f64>().expect("a number");
        let period = std::f64::consts::TAU * L / cell("driving") * (A / (B - A)).sqrt();
        assert!(relative(cell("period"), period) < 1e-10);
        let object = json!({
            "period_lower": cell("period_lower"),
            "period_upper": cell("period_upper"),
        });
        is_log_band(&object, "period", period, DEVIATIONS * deviation(part));
        assert_eq!(row[at("probability")], "");
    }
}

#[test]
fn a_pitchfork_has_the_band_of_the_maximum_of_the_law() {
    let asked = "branch equilibria --stiffness 5e9 --from 2e-8 --to 2e-7";
    let made = object(&format!("{asked} --ensemble {}:4", spinodal()));
    let law = object(&format!("law --points 3 --ensemble {}:0", spinodal()));
    let special = made["result"]["special"].as_array().expect("a list");
    let pitchfork = special.iter().find(|one| one["label"] == "BP");
    let pitchfork = pitchfork.expect("a pitchfork");
    // Two interfaces begin to differ where each slides at the rate of largest stress.
    let maximum = &law["result"]["extrema"][0];
    for end in ["lower", "upper"] {
        let twice = 2.0 * number(maximum, &format!("/slip_rate_{end}"));
        let found = number(pitchfork, &format!("/driving_{end}"));
        assert!(relative(found, twice) < 1e-7, "{found} {twice}");
    }
    assert_eq!(pitchfork["probability"], 1.0);
    // Along the symmetric branch the stress is that of the law, at half the rate.
    let rows = made["result"]["rows"].as_array().expect("rows");
    let symmetric: Vec<&Value> = rows
        .iter()
        .filter(|row| row["symmetry"] == "symmetric" && row["label"].is_null())
        .collect();
    assert!(symmetric.len() > 5);
    for row in symmetric.iter().step_by(4) {
        let rate = number(row, "/driving") / 2.0;
        let law = object(&format!(
            "law --from {rate:e} --to {:e} --points 2 --ensemble {}:0",
            2.0 * rate,
            spinodal()
        ));
        let at = &law["result"]["rows"][0];
        let (low, high) = (number(at, "/stress_lower"), number(at, "/stress_upper"));
        is_band(row, "stress", number(at, "/stress"), 0.5 * (high - low));
    }
}

#[test]
fn rows_begin_with_those_of_the_same_parameters_given() {
    let given = "--si --law dieterich-ruina --direct-effect 0.0101 --evolution-effect 0.0152 --slip-length 9.1e-6 \
        --reference-friction 0.607 --reference-rate 3e-6 --normal-stress 2e7 --healing-time 300 --residual-strength 1e-3";
    for asked in [
        "law --points 9",
        "equilibria --driving 1e-6 --stiffness 1.2e10",
        "locus hopf --interfaces 1 --driving-range 1e-7:1e-6",
        "branch equilibria --interfaces 1 --stiffness 1.2e10 --from 1e-7 --to 1e-6",
    ] {
        let plain = csv(&twinslip(&format!("{asked} {given} -q")).out);
        let with = csv(&twinslip(&format!("{asked} --ensemble {}:2 -q", fit())).out);
        assert_eq!(plain.len(), with.len(), "{asked}");
        // Rows that can be gone on with end with a check.
        let checked = asked.starts_with("locus") || asked.starts_with("branch");
        for (plain, with) in plain.iter().zip(&with) {
            let own = plain.len() - usize::from(checked);
            assert_eq!(plain[..own], with[..own], "{asked}");
            assert!(with.len() > own, "{asked}");
        }
    }
}

#[test]
fn a_scene_may_ask_for_it() {
    let place = folder("ensemble-scene");
    fs::copy(data("fit.json"), place.join("fit.json")).expect("a copy");
    let scene = place.join("scene.toml");
    let text = "command = \"law\"\npoints = 3\nensemble = \"fit.json:0\"\n";
    fs::write(&scene, text).expect("a place to write");
    let made = object(&format!("run {}", scene.display()));
    assert_eq!(made["result"]["ensemble"]["draws"], 0);
    assert!(number(&made, "/result/rows/0/stress_lower") > 0.0);
}

#[test]
fn pictures_have_areas_and_bars() {
    let place = folder("ensemble-pictures");
    let law = place.join("law.svg");
    let asked = format!(
        "law --points 20 --ensemble {}:0 -q --plot {} -o {}",
        spinodal(),
        law.display(),
        place.join("law.csv").display()
    );
    assert_eq!(twinslip(&asked).code, 0);
    let svg = fs::read_to_string(law).expect("drawn");
    // One area in each of both panels, and an entry of the legend for each.
    assert_eq!(svg.matches("fill-opacity=\"0.22\"").count(), 2);
    assert_eq!(svg.matches("95 % of the fit").count(), 2);
    let map = place.join("map.svg");
    let (k, of_k) = critical_stiffness();
    let asked = format!(
        "sweep --interfaces 1 --driving 1e-6:2e-6:2 --stiffness {:e}:{:e}:2 --curves none --ensemble {}:4 -q --plot {} -o {}",
        k - 3.0 * of_k,
        k + 3.0 * of_k,
        fit(),
        map.display(),
        place.join("map.csv").display()
    );
    let ended = twinslip(&asked);
    assert!([0, 3].contains(&ended.code), "{}", ended.err);
    let svg = fs::read_to_string(map).expect("drawn");
    assert!(svg.contains("likeliest regimes at 2 × 2 points"));
    assert!(svg.contains("of the fit, or less"));
}
