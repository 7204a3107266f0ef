//! Where branches of equilibria end: at the boundary of a box, and at infinity.

use crate::command::{self, folder, number};
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;

fn branch(arguments: &str) -> Value {
    let ended = command::twinslip(&format!("branch equilibria {arguments} --format json -q"));
    assert_eq!(ended.code, 0, "{arguments}: {}", ended.err);
    serde_json::from_str(&ended.out).expect("JSON")
}

fn list<'v>(made: &'v Value, name: &str) -> &'v Vec<Value> {
    made["result"][name].as_array().expect("a list")
}

/// The special points whose note begins so.
fn noted<'v>(made: &'v Value, note: &str) -> Vec<&'v Value> {
    let is = |one: &&Value| {
        one["note"]
            .as_str()
            .is_some_and(|text| text.starts_with(note))
    };
    list(made, "special").iter().filter(is).collect()
}

/// The parameter of a point is this within its bound, and the bound is at most `sharp`.
#[track_caller]
fn is_at(point: &Value, parameter: &str, truth: f64, sharp: f64) {
    let value = number(point, &format!("/{parameter}/value"));
    let off = number(point, &format!("/{parameter}/uncertainty"));
    assert!(
        (value - truth).abs() <= off && off <= sharp,
        "{value} +- {off}, not {truth}"
    );
    assert_eq!(point["label"], "EP");
}

/// A system of one variable x and one parameter p.
fn scalar(name: &str, rate: &str, start: f64) -> String {
    let text = format!(
        "name = \"{name}\"\nstates = [\"x\"]\n[parameters]\np = 0.1\n[rates]\nx = \"{rate}\"\n[start]\nx = {start}\n"
    );
    let file = folder(name).join("system.toml");
    std::fs::write(&file, text).expect("a file");
    format!("--system {}", file.display())
}

const CHEMOSTAT: &str =
    "--system tests/data/cases/chemostat-wash-out.toml --along D --from 0.1 --to 1.2";

/// S = D/(2 (1 - D)), N = 10 - S, and N = 0, S = 10.
#[test]
fn a_branch_ends_where_it_leaves_the_box() {
    let made = branch(&format!("{CHEMOSTAT} --box S=0:11,N=-5:11"));
    let ends = noted(
        &made,
        "the branch leaves the box at S = 11, its upper bound",
    );
    assert_eq!(ends.len(), 1);
    is_at(ends[0], "D", 22.0 / 23.0, 1e-13);
    let rows = list(&made, "rows");
    let last = rows.iter().find(|row| row["S"] == 11.0).expect("a row");
    assert_eq!(last["label"], "EP");
    assert!((number(last, "/N") + 1.0).abs() < 1e-13);
    assert!(
        rows.iter()
            .all(|row| number(row, "/S") <= 11.0 && number(row, "/N") >= -5.0)
    );
    assert!(rows.len() < 300, "{}", rows.len());

    // In a corner of the box, at the branch point, and along its side.
    let made = branch(&format!("{CHEMOSTAT} --box S=0:11,N=0:11"));
    let ends = noted(&made, "the branch leaves the box at N = 0, its lower bound");
    assert_eq!(ends.len(), 1);
    is_at(ends[0], "D", 20.0 / 21.0, 1e-13);
    let special = list(&made, "special");
    let labels = |label: &str| special.iter().filter(|one| one["label"] == label).count();
    // Of one branch both ends of the range, of the other one.
    assert_eq!((labels("BP"), labels("EP")), (2, 4));
    assert!(
        special
            .iter()
            .all(|one| one["branch"] == 0 || one["branch"] == 1)
    );
}

#[test]
fn a_branch_ends_at_both_sides_of_a_box() {
    let arctangent = scalar("arctangent-in-a-box", "p - atan(x)", 0.1);
    let made = branch(&format!(
        "{arctangent} --along p --from -3 --to 3 --box x=-10:5"
    ));
    let [low, high] = noted(&made, "the branch leaves the box")[..] else {
        panic!("two ends: {made}");
    };
    is_at(low, "p", -(10.0_f64.atan()), 1e-13);
    is_at(high, "p", 5.0_f64.atan(), 1e-13);
}

#[test]
fn a_branch_that_runs_to_infinity_says_where() {
    let made = branch(CHEMOSTAT);
    let ends = noted(
        &made,
        "the branch runs to infinity as D tends to this value",
    );
    assert_eq!(ends.len(), 1);
    is_at(ends[0], "D", 1.0, 1e-6);
    let number_of_branch = &ends[0]["branch"];
    let rows = list(&made, "rows").iter();
    let rows = rows
        .filter(|row| &row["branch"] == number_of_branch)
        .count();
    assert!(rows < 150, "{rows}");
    // The limit is the end of the range, or just beyond it, or just before.
    let to = |end: f64| branch(&CHEMOSTAT.replace("1.2", &end.to_string()));
    let of = |made: &Value| noted(made, "the branch runs to infinity").len();
    assert_eq!(
        [1.0, 0.999_999, 1.000_001].map(|end| of(&to(end))),
        [1, 0, 1]
    );
}

/// x = (1 - p)^(-1/m) for some m, and tan p.
#[test]
fn limits_are_found_whatever_the_power() {
    for (name, rate) in [
        ("square-root", "1 - x^2*(1 - p)"),
        ("fourth-root", "1 - x^4*(1 - p)"),
        ("square", "1 - x*(1 - p)^2"),
        ("cubes-with-more", "2 + 1/(1 + x^2) - x^3*(1 - p)"),
    ] {
        let system = scalar(name, rate, 1.1);
        let made = branch(&format!("{system} --along p --from 0.1 --to 0.9999999"));
        assert!(noted(&made, "the branch runs").is_empty(), "{name}");
        let made = branch(&format!("{system} --along p --from 0.1 --to 7"));
        let ends = noted(
            &made,
            "the branch runs to infinity as p tends to this value",
        );
        assert!(!ends.is_empty(), "{name}");
        for end in ends {
            is_at(end, "p", 1.0, 1e-4);
        }
        let is_fold = |one: &&Value| one["label"] == "LP";
        assert_eq!(
            list(&made, "special").iter().filter(is_fold).count(),
            0,
            "{name}"
        );
    }
    let system = scalar("arctangent", "p - atan(x)", 0.1);
    let made = branch(&format!("{system} --along p --from -3 --to 3"));
    let [low, high] = noted(&made, "the branch runs to infinity as p tends")[..] else {
        panic!("two ends: {made}");
    };
    is_at(low, "p", -FRAC_PI_2, 1e-5);
    is_at(high, "p", FRAC_PI_2, 1e-5);
}

/// What grows without bound but reaches the end of the range, and what tends to its limit as one over a logarithm.
#[test]
fn a_limit_that_is_not_determined_is_not_told() {
    for (name, rate) in [
        ("exponential", "exp(3*p) - x"),
        ("exponential-of-squares", "exp(p^2) - x"),
        ("a-million", "1e6*p - x"),
    ] {
        let system = scalar(name, rate, 1.3);
        let made = branch(&format!("{system} --along p --from 0.1 --to 12"));
        assert!(noted(&made, "the branch runs").is_empty(), "{name}");
        let end = list(&made, "special").last().expect("an end");
        is_at(end, "p", 12.0, 0.0);
    }
    let system = scalar("one-over-a-logarithm", "ln(x)*(1 - p) - 1", 3.0);
    let made = branch(&format!("{system} --along p --from 0.1 --to 12"));
    let ends = noted(&made, "the branch runs to infinity");
    assert_eq!(ends.len(), 1, "{made}");
    assert!(!ends[0]["note"].as_str().expect("a note").contains("tends"));
}

/// The same chemostat with S in millionths, N in billions and time in thousands.
#[test]
fn ends_do_not_depend_on_units() {
    let file = folder("chemostat-in-other-units").join("system.toml");
    let text = "name = \"chemostat\"\nstates = [\"S\", \"N\"]\n[parameters]\nD = 0.0005\n[rates]
S = \"D*(1e7 - S) - 1e12*0.001*S/(0.5e6 + S)*N\"\nN = \"0.001*S/(0.5e6 + S)*N - D*N\"
[start]\nS = 1e7\nN = 1e-12\n";
    std::fs::write(&file, text).expect("a file");
    let system = format!(
        "--system {} --along D --from 1e-4 --to 1.2e-3",
        file.display()
    );
    let made = branch(&system);
    let ends = noted(
        &made,
        "the branch runs to infinity as D tends to this value",
    );
    assert_eq!(ends.len(), 1);
    is_at(ends[0], "D", 1e-3, 1e-9);
    let made = branch(&format!("{system} --box S=0:1.1e7,N=-5e-6:11e-6"));
    let ends = noted(
        &made,
        "the branch leaves the box at S = 11000000, its upper bound",
    );
    assert_eq!(ends.len(), 1);
    is_at(ends[0], "D", 22e-3 / 23.0, 1e-16);
}
