//! Fifty models of textbooks, each by every method: every error within its estimate, and the orbits of those that oscillate. The references
//! (`tests/data/models.json`) are of another program.

use crate::command::{number, twinslip};
use crate::common::data;
use rayon::prelude::*;
use serde_json::Value;
use std::collections::BTreeMap;

/// The default absolute tolerance is larger than the states, in mol/L: the estimate says so.
const NO_DIGIT: &str = "enzyme-mm";
/// Its orbit, one of a family of a stiff system, takes a minute.
const SLOW_ORBIT: &str = "tyson-cell-cycle";
/// Estimates are below this part of a state's size, but for methods of low order on long runs.
const SHARP: f64 = 1e-4;
const LESS_SHARP: f64 = 0.1;

fn models() -> BTreeMap<String, Value> {
    let all = data("models.json");
    serde_json::from_value(all["models"].clone()).expect("models")
}

fn made(arguments: &str) -> Option<Value> {
    let ended = twinslip(&format!("{arguments} --format json -q"));
    [0, 3]
        .contains(&ended.code)
        .then(|| serde_json::from_str(&ended.out).expect("JSON"))
}

/// What is wrong with the run of a model by a method.
fn off(name: &str, model: &Value, method: &str) -> Option<String> {
    let until = number(model, "/until");
    let run = format!(
        "integrate --system tests/data/models/{name}.toml --until {until:?} --method {method} --final-only --estimate-error"
    );
    let Some(made) = made(&run) else {
        return Some(format!("fails: {run}"));
    };
    let end = model["end"].as_object().expect("states");
    end.iter().find_map(|(state, truth)| {
        let (value, own) = (number(truth, "/0"), number(truth, "/1"));
        let size = number(model, &format!("/size/{state}"));
        let told = number(&made, &format!("/result/final/{state}"));
        let off = (told - value).abs();
        let uncertainty = &made["result"]["final"][format!("{state}_uncertainty")];
        let Some(within) = uncertainty.as_f64() else {
            return Some(format!("{state}: no estimate, {off:e} off: {run}"));
        };
        let widest = match (name, method) {
            (NO_DIGIT, _) => f64::INFINITY,
            (_, "cvode-bdf" | "cvode-adams") | ("rectifier", _) => LESS_SHARP,
            _ => SHARP,
        };
        let holds = off <= within + own && within <= widest * size;
        (!holds).then(|| format!("{state} = {told} ± {within:e} for {value}: {run}"))
    })
}

#[test]
fn every_error_is_within_its_estimate() {
    let methods: &[&str] = match cfg!(feature = "sundials") {
        true => &["auto", "taylor", "rodas5p", "cvode-bdf", "cvode-adams"],
        false => &["auto", "taylor", "rodas5p"],
    };
    let models = models();
    assert_eq!(models.len(), 50);
    // Every other one, others each time.
    let half = crate::common::random() as usize % 2;
    let runs: Vec<_> = models
        .iter()
        .flat_map(|(name, model)| methods.iter().map(move |method| (name, model, method)))
        .skip(half)
        .step_by(2)
        .collect();
    let wrong: Vec<String> = runs
        .par_iter()
        .filter_map(|(name, model, method)| off(name, model, method))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Whether the period of a model's orbit is off its reference by more than its bound, or the bound is wide: in words.
fn period_off(name: &str, model: &Value) -> Option<String> {
    let run = format!("orbit --system tests/data/models/{name}.toml --crosscheck none");
    let (period, own) = (number(model, "/period/0"), number(model, "/period/1"));
    let Some(made) = made(&run) else {
        return Some(format!("no orbit: {run}"));
    };
    let told = number(&made, "/result/orbit/period/value");
    let within = number(&made, "/result/orbit/period/uncertainty");
    let holds = (told - period).abs() <= within + own * period && within < SHARP * period;
    (!holds).then(|| format!("T = {told} ± {within:e} for {period}: {run}"))
}

#[test]
fn those_that_oscillate_have_their_periods() {
    let models = models();
    let all: Vec<_> = models
        .iter()
        .filter(|(name, model)| model.get("period").is_some() && *name != SLOW_ORBIT)
        .collect();
    assert!(all.len() >= 29, "{}", all.len());
    let wrong: Vec<String> = all
        .par_iter()
        .filter_map(|(name, model)| period_off(name, model))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What is conserved makes Newton's equations singular: corrections would wander along the family.
#[test]
#[ignore = "takes a minute: .ci/run runs it"]
fn an_orbit_of_a_stiff_system_that_conserves_has_its_period() {
    assert_eq!(period_off(SLOW_ORBIT, &models()[SLOW_ORBIT]), None);
}
