//! What tests of systems from files share.

use crate::command::folder;
use std::fs;

/// The law of the paper and two interfaces, written as a user would.
pub const SPINODAL: &str = r#"
name = "two interfaces"
states = ["tau", "w1", "w2"]
[parameters]
V = 10.0
K = 0.14
R = 100.0
c = 0.001
a = 0.0349
b = 0.0489
a_v = 0.369
[rates]
tau = "K*(V - v1 - v2)"
w1 = "(exp(-w1) - 1)/R - abs(v1)"
w2 = "(exp(-w2) - 1)/R - abs(v2)"
[where]
v1 = "gamma*sinh(tau)/(c + (1 + R)*exp(w1))^(b/a)"
v2 = "gamma*sinh(tau)/(c + (1 + R)*exp(w2))^(b/a)"
gamma = "2*exp(-a_v/a)"
[start]
tau = 9.9
w1 = -6.0
w2 = -6.2
"#;

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
