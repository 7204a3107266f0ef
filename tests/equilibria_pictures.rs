//! `equilibria --plot`: every steady state with its stability, and the eigenvalues.
#![allow(missing_docs)]

use crate::command::{folder, refused, twinslip};
use crate::common::ROOT;
use std::fs;

/// The SVG that this command draws.
fn drawn(name: &str, command: &str) -> String {
    let path = folder(name).join("states.svg");
    let ended = twinslip(&format!("{command} --format csv --plot {}", path.display()));
    assert_eq!(ended.code, 0, "{}", ended.err);
    fs::read_to_string(path).expect("a picture")
}

fn count(svg: &str, words: &str) -> usize {
    svg.matches(&format!(">{words}<")).count()
}

#[test]
fn steady_states_are_drawn_with_their_stability() {
    let command = "equilibria --driving 10 --stiffness 0.14";
    let svg = drawn("equilibria-pair", command);
    for words in [
        "interface 1",
        "interface 2",
        "all alike",
        "unstable",
        "real, grows",
        "complex pair, grows",
    ] {
        assert_eq!(count(&svg, words), 1, "{words}");
    }
    // The symmetric state, with a real eigenvalue and a pair beside that of the asymmetric one.
    assert!(
        count(&svg, "1") >= 2 && count(&svg, "2") >= 3,
        "states have numbers in both panels"
    );
    assert_eq!(count(&svg, "stable"), 0, "none is stable");
    // Without a stiffness there is no stability, and there are no eigenvalues.
    let svg = drawn("equilibria-alone", "equilibria --driving 10");
    assert_eq!(count(&svg, "unstable") + count(&svg, "eigenvalues λ"), 0);
}

#[test]
fn steady_states_of_systems_and_of_many_interfaces_are_drawn() {
    let svg = drawn(
        "equilibria-lorenz",
        "equilibria --system lorenz --box x=-30:30,y=-30:30,z=0:60",
    );
    assert!(svg.contains("equilibria of Lorenz: s = 10, r = 28"));
    assert!(count(&svg, "x") == 2 && count(&svg, "y") == 1 && count(&svg, "3") > 1);
    let svg = drawn(
        "equilibria-drawn",
        "equilibria --interfaces 12 --driving 50 --stiffness 0.02 --draw residual_strength=8e-4:1.2e-3",
    );
    assert!(svg.contains("12 interfaces at τ = ") && count(&svg, "residual_strength") == 2);
    assert_eq!(
        svg.matches("<circle").count(),
        2 * 12,
        "slip rate and state of each"
    );
}

#[test]
fn the_band_of_the_stress_is_drawn_and_other_names_are_refused() {
    let command = format!(
        "equilibria --interfaces 1 --driving 1e-6 --stiffness 1.2e10 --ensemble {ROOT}/tests/data/fit.json:0"
    );
    let svg = drawn("equilibria-ensemble", &command);
    assert!(count(&svg, "stable") == 1);
    // A bar with a line across at either end, in both panels.
    let bars = svg
        .lines()
        .filter(|line| line.contains("stroke-width=\"12\""));
    assert!(bars.count() >= 6);
    refused(
        "equilibria --driving 10 --plot states.pdf",
        "must end in .svg or .png",
    );
}
