//! Commands on every kind of system, with their results as they were: the same verdicts, labels and lists, the same numbers within their bounds.
//!
//! `cargo test --profile dev -p twinslip-cli --test tests -- golden::write --ignored` takes what the program says now for the results. Look at the
//! difference before you keep it.

use crate::command::twinslip;
use crate::common::ROOT;
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use std::fs;
use std::path::PathBuf;

/// Numbers without a bound may differ by this part of the largest one of their name.
const OFF: f64 = 1e-7;
/// A bound may be larger than it was by this factor, which rounding may make.
const LOOSER: f64 = 10.0;
/// A curve may have more or fewer rows by this part of them.
const MORE: f64 = 0.3;
/// Of a longer list so many elements are kept.
const KEPT: usize = 6;
/// Objects that say what was done and what it took, and numbers that are rounding, the error of a second method or of a quadrature.
const LEFT_OUT: [&str; 20] = [
    "work",
    "steps",
    "evaluations",
    "iterations",
    "rejected",
    "switches",
    "nodes",
    "residual",
    "trivial_defect",
    "liouville_defect",
    "period_difference",
    "ln_abs_difference",
    "difference",
    "point_uncertainty",
    "crosscheck",
    "crosscheck_note",
    "seed",
    "seconds",
    "error_estimate",
    "bound_by_work",
];

fn folder() -> PathBuf {
    PathBuf::from(ROOT).join("tests/data/golden")
}

/// The name and the arguments of every command.
fn commands() -> Vec<(String, String)> {
    let text = fs::read_to_string(folder().join("commands.txt")).expect("readable");
    let both = |line: &str| {
        let (name, arguments) = line.split_once(": ").expect("a name and arguments");
        (name.to_owned(), arguments.to_owned())
    };
    text.lines().map(both).collect()
}

/// What a command says: its exit status; its model, units, numerics and result; where it fails, why, without the digits in the sentence.
fn said(arguments: &str) -> Value {
    let ended = twinslip(&format!("{arguments} --format json -q"));
    let mut said = Map::new();
    said.insert("code".to_owned(), json!(ended.code));
    if [1, 2].contains(&ended.code) {
        let first = ended.err.lines().next().unwrap_or("");
        said.insert("error".to_owned(), json!(without_digits(first)));
    }
    if let Ok(Value::Object(all)) = serde_json::from_str(&ended.out) {
        let kept = ["model", "units", "numerics", "result"];
        let kept = all.into_iter().filter(|(name, _)| kept.contains(&&**name));
        said.extend(kept);
        let is_curve = ["branch ", "locus "]
            .iter()
            .any(|of| arguments.starts_with(of));
        if is_curve && let Some(rows) = said.get_mut("result").and_then(|x| x.get_mut("rows")) {
            *rows = of_curve(rows);
        }
    }
    shortened(Value::Object(said))
}

/// A sentence without its numbers.
fn without_digits(text: &str) -> String {
    let parts = text.split(|c: char| c.is_ascii_digit());
    parts
        .filter(|part| !part.is_empty() && !["e-", "."].contains(part))
        .collect()
}

/// Where steps along a curve end is a matter of rounding: about how many rows there are, and the names of their columns.
fn of_curve(rows: &Value) -> Value {
    let rows = rows.as_array().expect("rows");
    let columns = rows.first().and_then(Value::as_object);
    let columns: Vec<_> = columns
        .into_iter()
        .flat_map(Map::keys)
        .map(String::as_str)
        .collect();
    json!({"about": rows.len(), "columns": columns.join(" ")})
}

/// Without what is left out, and of long lists their length and some elements.
fn shortened(value: Value) -> Value {
    match value {
        Value::Object(all) => {
            let kept = all
                .into_iter()
                .filter(|(name, _)| !LEFT_OUT.contains(&&**name));
            let shorter = |(name, x): (String, Value)| match x {
                Value::String(text) if name == "note" => (name, json!(without_digits(&text))),
                x => (name, shortened(x)),
            };
            Value::Object(kept.map(shorter).collect())
        }
        Value::Array(all) if all.len() > 2 * KEPT => {
            let length = all.len();
            let some = (0..KEPT).map(|i| shortened(all[i * (length - 1) / (KEPT - 1)].clone()));
            json!({"length": length, "some": some.collect::<Vec<_>>()})
        }
        Value::Array(all) => Value::Array(all.into_iter().map(shortened).collect()),
        other => other,
    }
}

/// The largest number of this name in a value.
fn largest(value: &Value, name: &str) -> f64 {
    fn all(value: &Value) -> f64 {
        match value {
            Value::Number(x) => x.as_f64().map_or(0.0, f64::abs),
            Value::Array(all_of) => all_of.iter().map(all).fold(0.0, f64::max),
            _ => 0.0,
        }
    }
    match value {
        Value::Object(fields) => {
            let of = |(key, x): (&String, &Value)| {
                let here = if key == name { all(x) } else { 0.0 };
                here.max(largest(x, name))
            };
            fields.iter().map(of).fold(0.0, f64::max)
        }
        Value::Array(elements) => elements
            .iter()
            .map(|x| largest(x, name))
            .fold(0.0, f64::max),
        _ => 0.0,
    }
}

/// Where two values differ, the first of them being as it was.
struct Comparison<'a> {
    whole: &'a Value,
    found: Vec<String>,
}

impl Comparison<'_> {
    /// `bounds` are those of both, where they are told.
    fn compare(&mut self, path: &str, [was, is]: [&Value; 2], bounds: [Option<&Value>; 2]) {
        let name = path.rsplit('/').find(|part| part.parse::<usize>().is_err());
        let name = name.unwrap_or("");
        match [was, is] {
            [Value::Object(a), Value::Object(b)] => self.objects(path, [a, b]),
            [Value::Array(a), Value::Array(b)] if a.len() == b.len() => {
                for (i, (x, y)) in a.iter().zip(b).enumerate() {
                    // One for each element, or one for all.
                    let of = |bound: Option<&Value>| {
                        bound
                            .and_then(|all| all.get(i).or(Some(all).filter(|x| !x.is_array())))
                            .cloned()
                    };
                    let [p, q] = bounds.map(of);
                    self.compare(&format!("{path}/{i}"), [x, y], [p.as_ref(), q.as_ref()]);
                }
            }
            [Value::Number(a), Value::Number(b)] => {
                let [a, b] = [a, b].map(|x| x.as_f64().expect("a double"));
                let [p, q] = bounds.map(|bound| bound.and_then(Value::as_f64));
                let is_bound = name == "uncertainty" || name.ends_with("_uncertainty");
                let same = match (p, q) {
                    _ if name == "about" => (a - b).abs() <= MORE * a,
                    _ if is_bound => b <= LOOSER * a + f64::MIN_POSITIVE,
                    (Some(p), Some(q)) => (a - b).abs() <= p + q,
                    _ => (a - b).abs() <= OFF * largest(self.whole, name).max(a.abs()),
                };
                if !same {
                    self.found.push(format!("{path}: {a:e} is {b:e}"));
                }
            }
            _ if was == is => {}
            _ => self.found.push(format!("{path}: {was} is {is}")),
        }
    }

    fn objects(&mut self, path: &str, [a, b]: [&Map<String, Value>; 2]) {
        for (name, was) in a {
            let Some(is) = b.get(name) else {
                self.found.push(format!("{path}/{name} is missing"));
                continue;
            };
            let bound = |of: &Map<String, Value>| {
                let known = if name == "value" {
                    of.get("uncertainty")
                } else {
                    of.get(&format!("{name}_uncertainty"))
                };
                known.cloned()
            };
            let [p, q] = [bound(a), bound(b)];
            self.compare(
                &format!("{path}/{name}"),
                [was, is],
                [p.as_ref(), q.as_ref()],
            );
        }
    }
}

#[test]
fn every_command_says_what_it_said() {
    let differ = |(name, arguments): (String, String)| {
        let text = fs::read_to_string(folder().join(format!("{name}.json")))
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let was: Value = serde_json::from_str(&text).expect("JSON");
        let mut comparison = Comparison {
            whole: &was,
            found: Vec::new(),
        };
        comparison.compare("", [&was, &said(&arguments)], [None; 2]);
        let found = comparison.found;
        (!found.is_empty()).then(|| format!("twinslip {arguments}\n  {}", found.join("\n  ")))
    };
    let all: Vec<String> = commands().into_par_iter().filter_map(differ).collect();
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
#[ignore = "it writes among the sources"]
fn write() {
    for old in fs::read_dir(folder()).expect("a folder") {
        let path = old.expect("an entry").path();
        if path.extension().is_some_and(|kind| kind == "json") {
            fs::remove_file(path).expect("removed");
        }
    }
    commands().into_par_iter().for_each(|(name, arguments)| {
        let text = format!("{}\n", said(&arguments));
        fs::write(folder().join(format!("{name}.json")), text).expect("written");
    });
}
