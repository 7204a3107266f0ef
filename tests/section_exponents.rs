//! Exponents of runs by their returns: of orbits, tori and chaos, against multipliers and long runs, with bounds that hold.

use crate::command;
use crate::common as shared;
use shared::sections::Case;
use twinslip::section::{Regime, spectrum, verdict};

/// With exponents a torus has two that vanish and one that does not.
#[test]
fn the_exponents_of_a_torus() {
    let case = Case::paper(0.2, 0.102);
    let record = case.record("auto", 1e-10, case.near_symmetric(0.3), (3000, 2000));
    let found = spectrum(&case.field, &record).unwrap();
    assert!(found.converged);
    for x in &found.exponents[..2] {
        assert!(
            x.value.abs() <= x.uncertainty && x.uncertainty < 1e-5,
            "{x:?}"
        );
    }
    assert!(found.exponents[2].value < -1e-4);
    let made = verdict(&case.field, &case.surface, &record, Some(found.known())).unwrap();
    assert_eq!(made.regime, Regime::Torus, "{made:?}");
}

/// Chaos: K = 0.14, V_H = 0.094, between the period-doubling points. Positive beyond its interval, by two unlike methods.
#[test]
fn chaos_has_a_positive_exponent() {
    let case = Case::paper(0.14, 0.094);
    for (method, rtol, returns) in [("auto", 1e-10, 6000), ("rodas5p", 1e-7, 1500)] {
        let record = case.record(method, rtol, case.near_symmetric(0.01), (500, returns));
        let found = spectrum(&case.field, &record).unwrap();
        println!("{method}: {:?}", found.exponents);
        assert!(
            found.exponents[0].value > found.exponents[0].uncertainty,
            "{method}: {found:?}"
        );
        assert!(found.liouville_defect.abs() < 1e-6 && found.converged);
        let made = verdict(&case.field, &case.surface, &record, Some(found.known())).unwrap();
        assert_eq!(made.regime, Regime::Chaotic, "{method}: {made:?}");
        assert_eq!(case.verdict(&record).regime, Regime::Undecided);
    }
}

fn exponents(found: &serde_json::Value) -> Vec<(f64, f64)> {
    let all = found["result"]["lyapunov"].as_array().expect("exponents");
    let pair = |x: &serde_json::Value| {
        let number = |name: &str| x[name].as_f64().expect("a number");
        (number("value"), number("uncertainty"))
    };
    all.iter().map(pair).collect()
}

/// Methods and tolerances whose errors differ by orders.
fn numerics() -> Vec<&'static str> {
    let mut all = vec!["", "--rtol 1e-4", "--method rodas5p --rtol 1e-6"];
    if cfg!(feature = "sundials") {
        all.push("--method cvode-bdf");
    }
    all
}

/// ln |mu| / T by the multipliers of an independent computation, whatever the run was made with.
#[test]
fn exponents_of_periodic_orbits_are_those_of_their_multipliers() {
    let data = shared::data("multipliers.json");
    for orbit in data["orbits"].as_array().unwrap() {
        let at = |name: &str| shared::number(&orbit[name]);
        let text = |name: &str| orbit[name].as_str().unwrap().to_owned();
        let period = at("period");
        for numerics in numerics() {
            let words = format!(
                "section --driving {} --stiffness {} --start {},{},{} --skip 20 --returns 60 --lyapunov {numerics}",
                text("V_H"),
                text("K"),
                text("section tau_s"),
                text("psi1"),
                text("psi2")
            );
            let found = command::object(&words);
            assert_eq!(found["result"]["regime"], "periodic", "{words}");
            let all = exponents(&found);
            assert_eq!(all[0], (0.0, 0.0), "{words}");
            for (i, (value, uncertainty)) in all[1..].iter().enumerate() {
                let (re, im) = shared::complex(&orbit["mu"][i]);
                let off = (value - re.hypot(im).ln() / period).abs();
                assert!(off <= *uncertainty, "{words}: {value} is off by {off:e}");
                assert!(uncertainty * period < 1e-7, "{words}: {uncertainty:e}");
            }
        }
    }
    // An orbit of three returns; the third exponent by multiple shooting at 31 digits.
    for numerics in &numerics()[..3] {
        let words = format!("section --driving 0.08433 --stiffness 0.14617 --lyapunov {numerics}");
        let (value, uncertainty) = exponents(&command::object(&words))[2];
        let off = (value + 0.002_595_534_446_2).abs();
        assert!(off < uncertainty + 5e-14, "{words}: {value}");
        assert!(uncertainty < 1e-11, "{words}: {uncertainty:e}");
    }
}

/// The error of the method would be a bias, the same at every return: two exponents of a torus vanish, and the third is that of
/// a long and accurate run.
#[test]
fn the_exponents_of_a_torus_have_no_bias() {
    let run = "section --driving 0.11 --stiffness 0.185 --start near-symmetric:0.3 --lyapunov";
    let long = exponents(&command::object(&format!(
        "{run} --returns 4000 --rtol 1e-12"
    )))[2];
    // Those whose errors are largest.
    for numerics in &numerics()[1..3] {
        let words = format!("{run} --skip 1500 --returns 2000 {numerics}");
        let ended = command::twinslip(&format!("{words} --format json -q"));
        let found: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
        let regime = found["result"]["regime"].as_str().expect("a regime");
        // The returns of a coarse run may be too rough to tell, but never tell anything else.
        let coarse = numerics.contains("1e-4") && regime == "undecided";
        assert!(regime == "torus" || coarse, "{words}: {found}");
        let all = exponents(&found);
        for (value, uncertainty) in &all[..2] {
            assert!(value.abs() <= *uncertainty, "{words}: {all:?}");
        }
        let (value, uncertainty) = all[2];
        let off = (value - long.0).abs();
        assert!(off <= uncertainty + long.1, "{words}: {all:?}, {long:?}");
        assert!(uncertainty < 0.05 * value.abs(), "{words}: {all:?}");
    }
}

/// Along a record that is made coarsely the bias is seen in the direction of the flow, and counted.
#[test]
fn the_bias_of_a_coarse_record_is_counted() {
    let case = Case::paper(0.2, 0.102);
    let start = case.near_symmetric(0.3);
    let of = |rtol: f64| {
        let record = case.record("taylor", rtol, start.clone(), (3000, 2000));
        spectrum(&case.field, &record).unwrap()
    };
    let (coarse, fine) = (of(1e-4), of(1e-12));
    for (coarse, fine) in coarse.exponents.iter().zip(&fine.exponents) {
        let off = (coarse.value - fine.value).abs();
        assert!(
            off <= coarse.uncertainty + fine.uncertainty,
            "{coarse:?} {fine:?}"
        );
    }
    let flow = coarse
        .exponents
        .iter()
        .find(|x| x.value == coarse.along_flow);
    assert!(flow.is_some_and(|x| x.value.abs() <= x.uncertainty));
}
