//! What tests of systems and laws from files share.

use crate::command::folder;
use serde_json::Value;
use std::fs;

/// The law of the paper and two interfaces, written as a user would.
pub const SPINODAL: &str = include_str!("../data/two-interfaces.toml");

/// The parameters of these laws.
const PARAMETERS: &str = "[parameters]
healing_time = 100.0
residual_strength = 0.001
direct_effect = 0.0349
evolution_effect = 0.0489
reference_friction = 0.369
[where]
gamma = \"2*exp(-reference_friction/direct_effect)\"
beta = \"evolution_effect/direct_effect\"
";

/// The laws as the paper and others print them: the built-in name, v and dpsi/dt.
const LAWS: [(&str, &str, &str); 5] = [
    (
        "spinodal",
        "gamma*sinh(tau)/(residual_strength + (1 + healing_time)*psi)^beta",
        "(1 - psi)/healing_time - abs(v)*psi",
    ),
    (
        "bounded",
        "gamma*sinh(tau)*((1 + healing_time)*psi)^(-beta)",
        "(1 - psi)/healing_time - abs(v)*psi",
    ),
    (
        "regularised-ageing",
        "gamma*sinh(tau)*psi^(-beta)",
        "1 - abs(v)*psi",
    ),
    (
        "dieterich-ruina",
        "gamma/2*exp(tau)*psi^(-beta)",
        "1 - v*psi",
    ),
    (
        "slip",
        "gamma/2*exp(tau - beta*ln(psi))",
        "-v*psi*ln(v*psi)",
    ),
];

/// The path of a file with the law of this built-in name, in a folder of the test's own.
pub fn law(test: &str, name: &str) -> String {
    let (_, slip_rate, evolution) = LAWS
        .iter()
        .find(|(known, ..)| *known == name)
        .expect("a law");
    let path = folder(test).join(format!("{name}.toml"));
    let text = format!("slip_rate = \"{slip_rate}\"\nevolution = \"{evolution}\"\n{PARAMETERS}");
    fs::write(&path, text).expect("a file");
    path.display().to_string()
}

/// All numbers of an object that another has under the same names too.
#[track_caller]
pub fn alike(made: &Value, known: &Value, tolerance: f64, names: &[&str]) {
    for name in names {
        let value = |object: &Value| object[*name].as_f64();
        let (made, known) = (value(made), value(known));
        let both = made.zip(known);
        let (made, known) = both.unwrap_or_else(|| panic!("{name}: {made:?} for {known:?}"));
        let off = (made - known).abs();
        assert!(
            off <= tolerance * known.abs().max(1e-3),
            "{name}: {made} for {known}"
        );
    }
}

/// Fails unless a number is as near to another as is claimed, in units of 1 + |x|.
#[track_caller]
pub fn near(made: f64, exact: f64, tolerance: f64) {
    let off = (made - exact).abs();
    assert!(off <= tolerance * (1.0 + exact.abs()), "{made} for {exact}");
}

/// A file of this test's own.
pub fn file(folder_name: &str, text: &str) -> String {
    let path = folder(folder_name).join("system.toml");
    fs::write(&path, text).expect("a file");
    path.display().to_string()
}
