//! The description of a model, from which the page makes its controls.

use serde_json::{Value, json};
use twinslip::error::Result;

/// The description of the model that these words of a command line make.
///
/// # Errors
/// Those of the options.
pub fn model_description(_words: &[String]) -> Result<Value> {
    let parameter = |name: &str,
                     symbol: &str,
                     meaning: &str,
                     value: f64,
                     range: [f64; 2],
                     log: bool| {
        json!({
            "name": name, "symbol": symbol, "meaning": meaning, "unit": null, "value": value, "option": true,
            "range": range, "log": log, "positive": true, "integer": false,
        })
    };
    let state = |name: &str, label: &str| json!({"name": name, "label": label, "unit": null});
    Ok(json!({
        "kind": "interfaces",
        "title": "Two interfaces, spinodal law",
        "states": [state("stress", "tau"), state("log_state_1", "ln psi_1"), state("log_state_2", "ln psi_2")],
        "parameters": [
            parameter("driving", "V_H", "Driving velocity", 10.0, [1e-3, 1e4], true),
            parameter("stiffness", "K", "Stiffness", 0.14, [1e-3, 0.6], false),
            parameter("healing_time", "R", "Healing time", 100.0, [10.0, 1000.0], true),
            parameter("residual_strength", "c", "Residual strength", 1e-3, [1e-4, 1e-2], true),
            parameter("direct_effect", "a", "Direct effect", 0.0349, [0.00349, 0.349], true),
            parameter("evolution_effect", "b", "Evolution effect", 0.0489, [0.00489, 0.489], true),
            parameter("reference_friction", "a_v", "Friction at V*", 0.369, [0.0369, 3.69], true),
            parameter("damping", "eta", "Radiation damping", 0.0, [0.0, 1.0], false),
        ],
        "axes": ["driving", "stiffness"],
        "laws": [
            {"name": "spinodal", "meaning": "spinodal"}, {"name": "bounded", "meaning": "bounded"},
            {"name": "regularised-ageing", "meaning": "regularised ageing"},
            {"name": "dieterich-ruina", "meaning": "ageing"}, {"name": "slip", "meaning": "slip"},
        ],
        "symmetries": ["symmetric", "asymmetric"],
        "interfaces": 2,
        "loci": ["pitchfork", "saddle-node", "hopf", "orbit-pitchfork", "orbit-saddle-node", "period-doubling", "torus"],
        "surface": null,
        "text": null,
        "si": false,
        "time_unit": "s",
    }))
}
