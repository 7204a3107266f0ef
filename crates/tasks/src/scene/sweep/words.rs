//! A sweep in words that equal sweeps share, whatever was typed.

use super::options::{SweepLine, SweepOptions};
use clap::Parser;
use serde_json::{Value, json};
use std::path::Path;

/// The option that may be given again.
const GRID: &str = "grid";

/// The settings for the output.
pub(super) fn numerics(options: &SweepOptions, grid: &[(&str, String)]) -> Value {
    let mut pairs: serde_json::Map<String, Value> = grid
        .iter()
        .filter(|(name, _)| *name != GRID)
        .map(|(name, text)| (name.replace('-', "_"), json!(text)))
        .collect();
    let axes = grid.iter().filter(|(name, _)| *name == GRID);
    let axes: Vec<&str> = axes.map(|(_, text)| text.as_str()).collect();
    if !axes.is_empty() {
        pairs.insert(GRID.to_owned(), json!(axes));
    }
    if options.slab.text.system.is_some() {
        pairs.insert("surface".to_owned(), json!(options.surface));
        pairs.insert("start".to_owned(), json!(options.start));
    }
    let others = [
        ("basin", json!(options.basin)),
        ("starts", json!(options.starts)),
        ("seed", json!(options.seed)),
        ("follow", json!(options.follow)),
        ("lyapunov", json!(options.lyapunov)),
        ("rtol", json!(options.rtol)),
        ("max_returns", json!(options.max_returns)),
        ("max_steps", json!(options.max_steps)),
    ];
    pairs.extend(others.map(|(name, value)| (name.to_owned(), value)));
    if let Some(state) = &options.diagram {
        pairs.insert("diagram".to_owned(), json!(state));
    }
    Value::Object(pairs)
}

/// The words in a fixed order, each setting with its value unless that is the default.
pub(super) fn canonical(options: &SweepOptions, grid: &[(&str, String)]) -> Vec<String> {
    let default = SweepLine::parse_from(["sweep"]).options;
    let mut words = vec!["twinslip".to_owned(), "sweep".to_owned()];
    for (name, text) in grid {
        words.extend([format!("--{name}"), text.clone()]);
    }
    let texts = |options: &SweepOptions| {
        let slab = &options.slab;
        let maybe = |x: Option<f64>| x.map(|x| format!("{x:?}"));
        let plain = |x: f64| Some(format!("{x:?}"));
        let count = |n: usize| Some(n.to_string());
        let path = |path: Option<&Path>| path.map(|path| path.display().to_string());
        // A word has no spaces.
        let plain_text = |text: Option<&str>| text.map(|text| text.split_whitespace().collect());
        [
            ("law", Some(slab.law.clone())),
            ("interfaces", Some(slab.count().to_string())),
            ("clusters", plain_text(slab.clusters.as_deref())),
            ("system", path(slab.text.system.as_deref())),
            ("surface", plain_text(options.surface.as_deref())),
            ("start", plain_text(options.start.as_deref())),
            ("healing-time", maybe(slab.healing_time)),
            ("residual-strength", plain(slab.c())),
            ("damping", maybe(slab.damping)),
            ("shear-modulus", maybe(slab.shear_modulus)),
            ("shear-wave-speed", maybe(slab.shear_wave_speed)),
            ("direct-effect", plain(slab.a())),
            ("evolution-effect", plain(slab.b())),
            ("reference-friction", plain(slab.a_v())),
            ("slip-length", maybe(slab.slip_length)),
            ("reference-rate", maybe(slab.reference_rate)),
            ("normal-stress", maybe(slab.normal_stress)),
            (
                "second-evolution-effect",
                maybe(slab.second_evolution_effect),
            ),
            ("second-slip-length", maybe(slab.second_slip_length)),
            ("mass", maybe(slab.mass)),
            ("normal-stress-coupling", maybe(slab.normal_stress_coupling)),
            ("diagram", options.diagram.clone()),
            (
                "set",
                Some(slab.text.set.join(",")).filter(|set| !set.is_empty()),
            ),
            ("time-unit", Some(slab.time_unit.clone())),
            ("starts", count(options.starts)),
            ("seed", Some(options.seed.to_string())),
            ("rtol", plain(options.rtol)),
            ("max-returns", count(options.max_returns)),
            ("max-steps", count(options.max_steps)),
        ]
    };
    for ((name, text), (_, usual)) in texts(options).into_iter().zip(texts(&default)) {
        if let Some(text) = text.filter(|text| Some(text) != usual.as_ref()) {
            words.extend([format!("--{name}"), text]);
        }
    }
    for text in &options.slab.modulate {
        words.extend(["--modulate".to_owned(), text.split_whitespace().collect()]);
    }
    let switches = [
        ("si", options.slab.si),
        ("basin", options.basin),
        ("follow", options.follow),
        ("lyapunov", options.lyapunov),
    ];
    let on = switches.into_iter().filter(|(_, on)| *on);
    words.extend(on.map(|(name, _)| format!("--{name}")));
    words
}
