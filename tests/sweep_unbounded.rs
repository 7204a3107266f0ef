//! `sweep` of systems whose runs have no end: told with the reason, long before steps or returns are used up.

use crate::command;
use command::{csv, folder, twinslip};
use std::fs;

/// The rows of a sweep over a = 0.05 and 0.1: regime, returns and note.
fn told(name: &str, rates: [&str; 2]) -> Vec<(String, usize, String)> {
    let path = folder(&format!("unbounded-{name}")).join("system.toml");
    let text = format!(
        "name = \"{name}\"\nstates = [\"x\", \"y\"]\n[parameters]\na = 0.1\n[rates]\nx = \"{}\"\ny = \"{}\"\n[start]\nx = 1.0\ny = 1.0\n",
        rates[0], rates[1]
    );
    fs::write(&path, text).expect("a file");
    let ended = twinslip(&format!(
        "sweep -q --system {} --grid a=0.05:0.1:2 --format csv --max-returns 2000",
        path.display()
    ));
    assert_eq!(ended.code, 3, "{}", ended.err);
    let rows = csv(&ended.out);
    let place = |name: &str| {
        let place = rows[0].iter().position(|known| known == name);
        place.expect("a column")
    };
    let cell = |row: &Vec<String>, name: &str| row[place(name)].trim_matches('"').to_owned();
    let one = |row: &Vec<String>| {
        let returns = cell(row, "returns").parse().expect("a number");
        (cell(row, "regime"), returns, cell(row, "note"))
    };
    rows[1..].iter().map(one).collect()
}

/// The time that a note ends with.
fn time(note: &str) -> f64 {
    let digits = note.rsplit("t = ").next().expect("a time");
    digits.parse().unwrap_or_else(|_| panic!("{note}"))
}

/// Both grow as exp(a t), and so are beyond 1e100 at t = 100 ln(10)/a.
#[test]
fn what_grows_as_an_exponential_goes_to_infinity() {
    for (name, rates) in [("spiral", ["a*x - y", "x + a*y"]), ("node", ["a*x", "-y"])] {
        let told = told(name, rates);
        assert_eq!(told.len(), 2);
        for ((regime, returns, note), a) in told.iter().zip([0.05, 0.1]) {
            assert_eq!(regime, "undecided", "{note}");
            assert!(note.starts_with("it goes to infinity"), "{note}");
            let exact = 100.0 * 10_f64.ln() / a;
            let late = time(note) / exact - 1.0;
            assert!(late.abs() < 0.02, "{name}: {note}, {exact}");
            assert!(*returns < 1000, "{returns}");
        }
    }
}

#[test]
fn what_drifts_away_is_not_waited_for() {
    for (regime, returns, note) in told("drift", ["a", "-y"]) {
        assert_eq!((regime.as_str(), returns), ("undecided", 0));
        assert!(
            note.starts_with("it keeps growing: a state has reached"),
            "{note}"
        );
    }
}
