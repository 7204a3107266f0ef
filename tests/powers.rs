//! Powers of what is 0, or changes sign, and functions beyond the range of numbers.
//!
//! Values were computed independently of this code, to the digits that are written; those of Hertz's impact have an energy.

use crate::command;
use crate::common::text::{ends_at, file};
use command::{number, object};

/// Those that there are.
fn methods() -> impl Iterator<Item = &'static str> {
    let all = ["auto", "taylor", "rodas5p", "cvode-bdf", "cvode-adams"];
    let here = |method: &&str| cfg!(feature = "sundials") || !method.starts_with("cvode");
    all.into_iter().filter(here)
}

/// x'' = -9.81 + k max(-x, 0)^1.5 has the energy v^2/2 + 9.81 x + k max(-x, 0)^2.5 / 2.5.
#[test]
fn a_power_that_is_zero_for_whole_stretches_is_left_and_met() {
    for method in methods() {
        let run = format!("hertz-impact.toml --until 2 --method {method}");
        ends_at(&run, &[("x", -0.03660411), ("v", -0.79335603)], 1e-3);
    }
    let run = "hertz-impact.toml --until 2 --rtol 1e-13 --atol 1e-13";
    let made = ends_at(run, &[], 0.0);
    let [x, v] = ["x", "v"].map(|name| number(&made, &format!("/result/final/{name}")));
    let energy = 0.5 * v * v + 9.81 * x + 1e4 * (-x).powf(2.5) / 2.5;
    assert!((energy - 0.981).abs() < 1e-11, "{energy}");
}

#[test]
fn powers_begin_at_zero() {
    for method in methods() {
        let toggle = [("u", 155.763408), ("v", 0.0995130192)];
        let run = format!("toggle.toml --until 30 --method {method}");
        ends_at(&run, &toggle, 1e-4);
        // A whole exponent that is a parameter.
        let run = format!("hill-from-zero.toml --until 5 --method {method}");
        let [x, y, z] = [24.6104964593, 24.1473824573, 23.1133266131];
        ends_at(&run, &[("X", x), ("Y", y), ("Z", z)], 1e-5);
    }
}

/// Hysteresis: abs(z)^(n-1) z and abs(z)^n, where z is 0 at the start and passes 0 again and again.
#[test]
fn powers_of_what_changes_sign_have_kinks() {
    for (n, at) in [
        (1.0, [0.2815363973, 0.0509313451, 0.0877947910]),
        (1.5, [0.3232127041, -0.0069277052, 0.1631936850]),
        (2.0, [0.3405132830, -0.0612664051, 0.2057504142]),
        (3.0, [0.3514889534, -0.1382009108, 0.2497262558]),
    ] {
        let [x, v, z] = at;
        for method in methods() {
            let run = format!("bouc-wen.toml --set n={n} --until 40 --method {method}");
            ends_at(&run, &[("x", x), ("v", v), ("z", z)], 1e-5);
        }
    }
    // From rest, by methods that have nothing in common.
    let ends = methods().map(|method| {
        let run = format!("bouc-wen.toml --start 1,0,0 --until 40 --method {method}");
        let made = ends_at(&run, &[], 0.0);
        ["x", "v", "z"].map(|name| number(&made, &format!("/result/final/{name}")))
    });
    let ends: Vec<[f64; 3]> = ends.collect();
    for end in &ends[1..] {
        for (a, b) in end.iter().zip(&ends[0]) {
            assert!((a - b).abs() < 1e-5, "{ends:?}");
        }
    }
}

/// exp(2000) is beyond the range of numbers, and 1/(1 + exp(2000)) is 0.
#[test]
fn what_overflows_may_have_an_inverse() {
    for method in methods() {
        let run = format!("steep-switch.toml --until 5 --method {method}");
        ends_at(&run, &[("x", 0.973048145502)], 1e-6);
    }
}

/// x = (t - 1)^3 by whole powers of either sign, with the exponent a parameter.
#[test]
fn whole_exponents_take_any_base() {
    let path = file(
        "whole-exponents",
        r#"
        name = "whole exponents"
        states = ["s", "cube", "inverse"]
        [parameters]
        n = 2.0
        m = -2.0
        [rates]
        s = "1"
        cube = "3*(s - 1)^n"
        inverse = "2*(s - 5)^m"
        [start]
        s = 0.0
        cube = -1.0
        inverse = 0.4
        "#,
    );
    for method in methods() {
        let made = object(&format!(
            "integrate --system {path} --until 3 --method {method} --rtol 1e-10 --atol 1e-10 --final-only"
        ));
        let at = |name: &str| number(&made, &format!("/result/final/{name}"));
        assert!((at("cube") - 8.0).abs() < 1e-7, "{method}");
        assert!((at("inverse") - 1.0).abs() < 1e-7, "{method}");
    }
}

/// Dampers of any exponent below and above 1, and a root of what changes sign: slopes are infinite or kinked at each zero, where the run also begins.
#[test]
fn powers_of_any_exponent_pass_zero_with_estimates() {
    let text = "name = \"damper\"
states = [\"h\", \"q\"]
[parameters]
p = 0.5
[rates]
h = \"-q\"
q = \"h - 0.3*q*abs(q)^(p-1) - 0.2*h*abs(h)^(-0.5)\"
[start]
h = 1.0
q = 0.0
";
    let file = file("damper", text);
    for p in [0.1, 0.3, 0.5, 0.75, 1.25] {
        let end = |method: &str, rtol: f64| {
            let made = object(&format!(
                "integrate --system {file} --set p={p} --until 30 --rtol {rtol} --method {method} --final-only --estimate-error"
            ));
            ["h", "q", "h_uncertainty", "q_uncertainty"]
                .map(|name| number(&made, &format!("/result/final/{name}")))
        };
        let fine = end("rodas5p", 1e-12);
        for method in methods() {
            let coarse = end(method, 1e-8);
            for i in 0..2 {
                let apart = (coarse[i] - fine[i]).abs();
                let within = coarse[i + 2] + fine[i + 2];
                assert!(
                    apart <= within && within < 1e-5,
                    "{p} {method}: {apart:e} {within:e}"
                );
            }
        }
    }
}
