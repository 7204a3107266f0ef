//! Orbits that are unlike the usual ones: of stiff relaxation, members of a family, and of which several are met.

use crate::command;
use command::{number, object, twinslip};
use serde_json::Value;

/// A value with its uncertainty, which holds the truth, and how far off it may be.
#[track_caller]
fn holds(made: &Value, path: &str, truth: f64, near: f64) {
    let [value, off] = ["value", "uncertainty"].map(|part| number(made, &format!("{path}/{part}")));
    let rounding = 4.0 * f64::EPSILON * truth.abs();
    assert!(
        (value - truth).abs() <= off + rounding && off <= near,
        "{path}: {value} ± {off} for {truth}"
    );
}

/// What an orbit is whose stability is not decided, which is told by the status too.
fn undecided(arguments: &str) -> Value {
    let ended = twinslip(&format!("{arguments} --format json -q"));
    assert_eq!(ended.code, 3, "{arguments}: {}", ended.err);
    serde_json::from_str(&ended.out).expect("an object")
}

/// Van der Pol's oscillator at mu = 1000: the period as Taylor's method has it in ten million steps, and as the expansion for large mu,
/// (3 - 2 ln 2) mu + 3 a mu^(-1/3) - (2/3) (ln mu)/mu + ..., to some 1e-3 (Dorodnicyn 1947).
#[test]
fn a_stiff_orbit_is_found_by_the_implicit_method() {
    let asked = "orbit --system van-der-pol --set mu=1000 --points 11";
    let made = object(asked);
    // What is told is what was used.
    assert_eq!(number(&made, "/numerics/rtol"), 1e-13);
    if cfg!(feature = "sundials") {
        assert_eq!(made["numerics"]["crosscheck"], "cvode-bdf");
        let made = object(&format!("{asked} --crosscheck cvode-bdf"));
        let difference = number(&made, "/result/orbit/crosscheck/period_difference");
        assert!(difference.abs() < 1e-4, "{difference}");
    }
    assert_eq!(made["result"]["orbit"]["method"], "radau");
    assert_eq!(made["result"]["orbit"]["verdict"], "stable");
    holds(&made, "/result/orbit/period", 1_614.401_125_8, 1e-6);
    let mu = 1000.0_f64;
    let expansion = (3.0 - 2.0 * 2.0_f64.ln()) * mu + 3.0 * 2.338_107_41 / mu.cbrt();
    let period = number(&made, "/result/orbit/period/value");
    assert!(
        (period - expansion).abs() < 1e-2,
        "{period} for {expansion}"
    );
}

/// The orbit of an undamped system through the start: T = 4 K(m)/sqrt(1 + A^2) with m = A^2/(2 (1 + A^2)), for A = 1.
#[test]
fn an_orbit_of_a_conservative_system_is_one_of_a_family() {
    let made = undecided("orbit --system tests/data/cases/duffing-undamped-orbit.toml");
    holds(&made, "/result/orbit/period", 4.768_022_029_102_461, 1e-13);
    assert_eq!(made["result"]["orbit"]["family"], true);
    assert_eq!(made["result"]["orbit"]["verdict"], "undecided");
    holds(&made, "/result/orbit/extremes/u/max", 1.0, 1e-12);
    let difference = number(&made, "/result/orbit/crosscheck/period_difference");
    assert!(difference.abs() < 1e-7, "{difference}");
}

/// An orbit one of whose multipliers is 1 as its logarithm is the integral of -b cos(2 t) over a turn; the others are e^(-2 L T) and e^(-a T).
#[test]
fn a_multiplier_that_is_one_is_undecided() {
    let made =
        undecided("orbit --system tests/data/cases/exact-multipliers-4d.toml --crosscheck none");
    let turn = 2.0 * std::f64::consts::PI;
    holds(&made, "/result/orbit/period", turn, 1e-12);
    assert_eq!(made["result"]["orbit"]["family"], true);
    assert_eq!(made["result"]["orbit"]["verdict"], "undecided");
    for (i, truth) in [0.0, -100.0 * turn, -400.0 * turn].into_iter().enumerate() {
        let path = format!("/result/orbit/log_multipliers/{i}/ln_abs");
        holds(&made, &path, truth, 1e-9 * (1.0 + truth.abs()));
    }
}

/// Where the symmetric orbit is unstable, runs settle on another one.
#[test]
fn the_orbit_that_runs_settle_on_comes_first() {
    let made = object("orbit --driving 10 --stiffness 0.14 --crosscheck none");
    let orbit = &made["result"]["orbit"];
    assert_eq!(orbit["verdict"], "stable");
    assert_eq!(orbit["symmetry"], "asymmetric");
    let asked =
        object("orbit --driving 10 --stiffness 0.14 --symmetry asymmetric --crosscheck none");
    assert_eq!(orbit["period"], asked["result"]["orbit"]["period"]);
    let others = made["result"]["others"].as_array().expect("others");
    assert!(
        others
            .iter()
            .any(|other| { other["symmetry"] == "symmetric" && other["verdict"] == "unstable" })
    );
    let symmetric =
        object("orbit --driving 10 --stiffness 0.14 --symmetry symmetric --crosscheck none");
    assert_eq!(symmetric["result"]["orbit"]["verdict"], "unstable");
}

/// How an orbit is cut into arcs does not depend on the units of its states: here one of some 100 among three of order one.
#[test]
fn arcs_are_as_many_as_the_orbit_needs() {
    let made = object("orbit --system tests/data/cases/hodgkin-huxley.toml --crosscheck none");
    let nodes = made["work"]["nodes"].as_f64().expect("a number");
    assert!(nodes < 100.0, "{nodes} nodes");
}
