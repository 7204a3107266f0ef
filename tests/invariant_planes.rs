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

/// Rosenzweig & MacArthur: the prey falls below the least double in every turn and comes back; in logarithms too.
const PREY: &str = "name = \"prey\"
states = [\"x\", \"y\"]
[parameters]
K = 100.0
[rates]
x = \"x*(1 - x/K) - x*y/(1 + x)\"
y = \"x*y/(1 + x) - 0.1*y\"
[start]
x = 1.0
y = 1.0
";
const PREY_IN_LOGARITHMS: &str = "name = \"prey in logarithms\"
states = [\"u\", \"v\"]
[parameters]
K = 100.0
[rates]
u = \"1 - exp(u)/K - exp(v)/(1 + exp(u))\"
v = \"exp(u)/(1 + exp(u)) - 0.1\"
[start]
u = 0.0
v = 0.0
";

/// At t = 20000 the three competitors are 1, e^-1653.927 and e^-322.2332; y has been back from e^-897 before.
#[test]
fn what_sinks_below_the_least_double_comes_back() {
    for method in ["auto", "taylor", "rodas5p", "cvode-bdf"] {
        if method.starts_with("cvode") && !cfg!(feature = "sundials") {
            continue;
        }
        let end = last(&format!(
            "{MAY_LEONARD} --until 20000 --method {method} --rtol 1e-10 --estimate-error"
        ));
        let [x, y, z] = ["/x", "/y", "/z"].map(|name| number(&end, name));
        assert_close(x, 1.0, 1e-9, method);
        assert_eq!(y, 0.0, "{method}");
        assert!((z.ln() + 322.233_17).abs() < 1e-3, "{method}: {z:e}");
        let off = number(&end, "/z_uncertainty");
        assert!(
            (z - 1.146_2e-140).abs() < off + 1e-143,
            "{method}: {z:e} ± {off:e}"
        );
    }
    let prey = crate::common::text::file("sunken-prey", PREY);
    let end = last(&format!(
        "--system {prey} --until 1450 --rtol 1e-11 --estimate-error"
    ));
    let logs = crate::common::text::file("sunken-prey-logs", PREY_IN_LOGARITHMS);
    let exact = last(&format!(
        "--system {logs} --until 1450 --rtol 1e-13 --method taylor"
    ));
    for (state, log) in [("/x", "/u"), ("/y", "/v")] {
        let made = number(&end, state).ln();
        assert!((made - number(&exact, log)).abs() < 1e-5, "{state}: {made}");
    }
}

#[test]
fn orbits_and_sections_go_where_a_state_is_below_the_least_double() {
    let prey = crate::common::text::file("sunken-prey-orbit", PREY);
    let made = object(&format!("orbit --system {prey} --crosscheck none"));
    let orbit = &made["result"]["orbit"];
    let [period, off] = ["/period/value", "/period/uncertainty"].map(|name| number(orbit, name));
    assert!(
        // In logarithms it is known to 1.2e-9.
        (period - 1_496.560_244_056_4).abs() <= off + 1.2e-9,
        "{period} ± {off}"
    );
    assert!(off < 1e-6);
    let map = object(&format!(
        "section --system {prey} --surface x=1 --returns 20 --skip 2"
    ));
    assert_eq!(map["result"]["regime"], "periodic", "{}", map["result"]);
    // Each turn around the cycle of saddles takes (0.3/0.2)^3 as long as the one before.
    let ended = command::twinslip(&format!(
        "section {MAY_LEONARD} --surface x=0.3 --returns 12 --skip 0 --format json -q"
    ));
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let rows = made["result"]["rows"].as_array().expect("rows");
    let time = |i: usize| rows[i]["time"].as_f64().expect("a time");
    assert_eq!(rows.len(), 12, "{}", ended.err);
    let ratio = (time(11) - time(10)) / (time(10) - time(9));
    assert!((ratio - 3.375).abs() < 1e-3, "{ratio}");
}

/// The unit of a state that is followed by its logarithm stays: of what has died out nothing is left to err by.
#[test]
fn what_dies_out_for_good_is_known_to_be_small() {
    let text = "name = \"dying out\"
states = [\"x\", \"y\"]
[rates]
x = \"abs(x) + x*y\"
y = \"2*y + y*x - 0.693*y\"
[start]
x = -0.718
y = -1.478
";
    let file = crate::common::text::file("dying-out", text);
    let end = last(&format!("--system {file} --until 10 --estimate-error"));
    assert_eq!(number(&end, "/x"), 0.0);
    let off = number(&end, "/x_uncertainty");
    assert!(off < 1e-12, "{off:e}");
}

/// The formulas do not show what tan(x) is over x: what is lost there is told.
#[test]
fn what_cannot_be_followed_below_the_least_double_is_told() {
    let text = "name = \"odd\"
states = [\"x\", \"s\"]
[rates]
x = \"tan(x)*(s - 800)/400\"
s = \"1\"
[start]
x = 0.5
s = 0.0
";
    let file = crate::common::text::file("sunken-odd", text);
    for method in ["taylor", "rodas5p"] {
        let run = format!("integrate --system {file} --until 1599 --method {method} --final-only");
        let ended = command::twinslip(&run);
        assert_eq!(ended.code, 1, "{run}: {}{}", ended.out, ended.err);
        let told = "variable 1 fell below 2.2e-308, the smallest normal double, and grows again";
        assert!(ended.err.contains(told), "{run}: {}", ended.err);
    }
    // As long as it is as good as 0, nothing is lost.
    last(&format!("--system {file} --until 800"));
}

/// y = 0.5 e^(t (t - 1600)/800) goes down to e^-800 and comes back, whatever else sinks: the formulas do not show what tan(x) is over x.
#[test]
fn what_cannot_be_followed_does_not_stand_in_the_way_of_others() {
    let text = "name = \"odd and even\"
states = [\"x\", \"y\", \"s\"]
[rates]
x = \"-tan(x)\"
y = \"y*(s - 800)/400\"
s = \"1\"
[start]
x = 0.5
y = 0.5
s = 0.0
";
    let file = crate::common::text::file("sunken-odd-and-even", text);
    let end = last(&format!("--system {file} --until 1500 --rtol 1e-11"));
    assert!(number(&end, "/x").abs() < f64::MIN_POSITIVE);
    let off = number(&end, "/y").ln() - (0.5_f64.ln() - 187.5);
    assert!(off.abs() < 1e-6, "{off:e}");
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
