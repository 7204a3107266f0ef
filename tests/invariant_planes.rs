//! Variables that are factors of their own rates: no run crosses the plane where one is 0, however near it comes.

use crate::command;
use crate::common::assert_close;
use command::{number, object};
use serde_json::Value;
use twinslip::expression::{Binary, Builder, Function, Place};

/// In logarithms the same system goes at once, and never near a plane.
const IN_LOGARITHMS: &str = "
name = \"May-Leonard in logarithms\"
states = [\"u\", \"v\", \"w\"]
[parameters]
a = 0.8
b = 1.3
[rates]
u = \"1 - exp(u) - a*exp(v) - b*exp(w)\"
v = \"1 - b*exp(u) - exp(v) - a*exp(w)\"
w = \"1 - a*exp(u) - b*exp(v) - exp(w)\"
[start]
u = \"ln(0.5)\"
v = \"ln(0.3)\"
w = \"ln(0.2)\"
";
const MAY_LEONARD: &str = "--system tests/data/cases/may-leonard.toml";

fn last(arguments: &str) -> Value {
    object(&format!("integrate {arguments} --final-only"))["result"]["final"].clone()
}

/// Three competitors go round and round nearer to the planes of two: by 1e-15 there at t = 300, 1e-43 at 1000.
#[test]
fn a_heteroclinic_cycle_is_followed_by_every_method() {
    let place = command::folder("in-logarithms");
    let file = place.join("system.toml");
    let text = IN_LOGARITHMS
        .replace("\"ln(0.5)\"", "-0.6931471805599453")
        .replace("\"ln(0.3)\"", "-1.2039728043259361")
        .replace("\"ln(0.2)\"", "-1.6094379124341003");
    std::fs::write(&file, text).expect("a file");
    for until in [300, 1000] {
        let exact = last(&format!(
            "--system {} --until {until} --rtol 1e-14 --atol 1e-14 --method taylor",
            file.display()
        ));
        for method in ["taylor", "rodas5p", "cvode-bdf", "cvode-adams"] {
            if method.starts_with("cvode") && !cfg!(feature = "sundials") {
                continue;
            }
            let run = format!("{MAY_LEONARD} --until {until} --method {method} --rtol 1e-10");
            let made = last(&run);
            for (state, log) in [("x", "u"), ("y", "v"), ("z", "w")] {
                let made = number(&made, &format!("/{state}"));
                assert!(made > 0.0, "{run}: {state} = {made}");
                let log = number(&exact, &format!("/{log}"));
                assert_close(made.ln(), log, 1e-4, &format!("{run}: {state}"));
            }
        }
    }
}

#[test]
fn a_heteroclinic_cycle_is_no_steady_state() {
    let ended = command::twinslip(&format!(
        "section {MAY_LEONARD} --surface x=0.3 --format json -q"
    ));
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    assert_ne!(made["result"]["verdict"], "steady", "{}", made["result"]);
    assert_ne!(made["result"]["regime"], "steady", "{}", made["result"]);
}

/// Whether x is a factor of a rate that is made of x, another variable y, and a parameter that is 0.
fn is_factor(rate: impl Fn(&mut Builder, [Place; 3]) -> twinslip::Result<Place>) -> bool {
    let mut b = Builder::default();
    let of = |b: &mut Builder| -> twinslip::Result<Vec<Place>> {
        let all = [b.variable(0)?, b.variable(1)?, b.parameter(0)?];
        Ok(vec![rate(b, all)?, all[1]])
    };
    let outputs = of(&mut b).expect("formulas");
    let own = b.complete(outputs).own_factors(2, &[0.0]);
    assert!(own[1]);
    own[0]
}

#[test]
fn factors_are_seen_and_what_only_looks_like_one_is_not() {
    use Binary::{Difference, Power, Product, Quotient, Sum};
    // x (1 - x - y)
    assert!(is_factor(|b, [x, y, _]| {
        let (one, sum) = (b.number(1.0)?, b.binary(Sum, x, y)?);
        let rest = b.binary(Difference, one, sum)?;
        b.binary(Product, x, rest)
    }));
    // x/(x + 1) - x y
    assert!(is_factor(|b, [x, y, _]| {
        let one = b.number(1.0)?;
        let (more, product) = (b.binary(Sum, x, one)?, b.binary(Product, x, y)?);
        let first = b.binary(Quotient, x, more)?;
        b.binary(Difference, first, product)
    }));
    assert!(is_factor(|b, [x, ..]| {
        let exponent = b.number(1.5)?;
        b.binary(Power, x, exponent)
    }));
    assert!(is_factor(|b, [x, ..]| b.call(Function::Sin, &[x])));
    // The parameter p is 0, but x + p is no multiple of x.
    assert!(!is_factor(|b, [x, _, p]| b.binary(Sum, x, p)));
    // x/sqrt(x) goes to 0 too slowly.
    assert!(!is_factor(|b, [x, ..]| {
        let root = b.call(Function::Sqrt, &[x])?;
        b.binary(Quotient, x, root)
    }));
    assert!(!is_factor(|b, [x, ..]| {
        let one = b.number(1.0)?;
        let inverse = b.binary(Quotient, one, x)?;
        b.binary(Product, x, inverse)
    }));
    assert!(!is_factor(|_, [_, y, _]| Ok(y)));
    assert!(!is_factor(|b, [x, ..]| b.call(Function::Cos, &[x])));
}
