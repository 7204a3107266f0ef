//! The public benchmark of spring sliders, `benches/spring-sliders`: the commands and the equations that it publishes give its references.

use crate::command::{object, run};
use crate::common::{self, ROOT};
use serde_json::Value;
use std::fmt::Write;
use std::fs;

/// Largest error in the norm of the benchmark, at rtol 1e-13.
const TIGHT: f64 = 1e-10;

/// The problems, each with its references.
fn problems() -> Vec<(Value, Value)> {
    let read = |name: &str| {
        let path = format!("{ROOT}/benches/spring-sliders/{name}");
        let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
        let all: Value = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{path}: {e}"));
        list(&all["problems"]).to_vec()
    };
    let (problems, references) = (read("problems.json"), read("references.json"));
    assert_eq!(problems.len(), references.len());
    problems.into_iter().zip(references).collect()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a text")
}

fn pairs(table: &Value) -> impl Iterator<Item = (&String, &str)> {
    let table = table.as_object().expect("a table");
    table.iter().map(|(name, value)| (name, text(value)))
}

/// |q - Q|/(1 + |Q|)
fn error(made: f64, reference: f64) -> f64 {
    (made - reference).abs() / (1.0 + reference.abs())
}

#[test]
fn every_problem_has_references_of_twenty_digits_at_its_times() {
    for (problem, reference) in problems() {
        let name = text(&problem["name"]);
        assert_eq!(problem["name"], reference["name"]);
        let times = list(&problem["times"]).iter();
        let known = list(&reference["values"]);
        assert!(times.eq(known.iter().map(|row| &row["time"])), "{name}");
        for row in known {
            for form in list(&problem["forms"]) {
                for (quantity, _) in pairs(&form["compared"]) {
                    let digits = text(&row[quantity]);
                    let digits = digits.trim_start_matches(['-', '0', '.']);
                    let digits = digits.chars().filter(char::is_ascii_digit).count();
                    assert!(digits >= 20, "{name}, {quantity}: {digits}");
                }
            }
        }
    }
}

#[test]
fn the_page_of_problems_has_what_the_file_says() {
    let path = format!("{ROOT}/benches/spring-sliders/PROBLEMS.md");
    let page = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    for (problem, _) in problems() {
        let (_, section) = page
            .split_once(&format!("(`{}`)\n", text(&problem["name"])))
            .expect("a section");
        let section = section.split("\n## ").next().expect("a section");
        let has = |what: &str| assert!(section.contains(what), "{}: {what}", problem["name"]);
        has(text(&problem["about"]));
        has(&format!("\n{}\n", text(&problem["twinslip"])));
        for (name, value) in pairs(&problem["parameters"]).chain(pairs(&problem["constants"])) {
            has(&format!("{name} = {value}"));
        }
        for form in list(&problem["forms"]) {
            for (name, formula) in pairs(&form["where"]) {
                has(&format!("\n{name} = {formula}\n"));
            }
            for (name, rate) in pairs(&form["rates"]) {
                let start = text(&form["start"][name]);
                has(&format!("\nd{name}/dt = {rate}    ({start})\n"));
            }
            for (name, formula) in pairs(&form["compared"]) {
                has(&format!("{name} = {formula}"));
            }
        }
    }
}

/// A command without the changes of the driving velocity from this time on, which it would refuse.
fn before(command: &str, time: &str) -> String {
    let Some((model, rest)) = command.split_once(" --program ") else {
        return command.to_owned();
    };
    let (program, rest) = rest.split_once(' ').expect("options behind it");
    let time: f64 = time.parse().expect("a time");
    let begins = |change: &&str| {
        let begin = change
            .split(':')
            .next()
            .and_then(|begin| begin.parse().ok());
        begin.is_some_and(|begin: f64| begin < time)
    };
    let kept: Vec<&str> = program.split(',').filter(begins).collect();
    match kept.is_empty() {
        true => format!("{model} {rest}"),
        false => format!("{model} --program {} {rest}", kept.join(",")),
    }
}

#[test]
fn the_published_commands_give_the_references_within_their_bounds() {
    for (problem, reference) in problems() {
        let command = text(&problem["twinslip"]);
        let (command, until) = command.rsplit_once(" --until ").expect("an end");
        let command = command.strip_prefix("twinslip ").expect("a command");
        let last = list(&problem["times"]).last().expect("a time");
        assert_eq!(until, text(last), "{command}");
        for row in list(&reference["values"]) {
            let time = text(&row["time"]);
            let made = object(&format!(
                "{} --until {time} --final-only --rtol 1e-13 --estimate-error",
                before(command, time)
            ));
            let last = &made["result"]["final"];
            for (quantity, known) in pairs(row).filter(|(name, _)| *name != "time") {
                let known: f64 = known.parse().expect(known);
                // Of a mass a run has the slip rate itself.
                let value = match quantity.strip_prefix("log_slip") {
                    Some(rest) => common::number(&last[format!("slip{rest}")]).ln(),
                    None => common::number(&last[quantity]),
                };
                let off = error(value, known);
                assert!(
                    off <= TIGHT,
                    "{command} at {time}: {quantity} = {value}, not {known}"
                );
                let bound = common::number(&last[format!("{quantity}_uncertainty")]);
                // The bound is for the numbers as doubles: those of the problem move the solution besides.
                let limit = common::number(&reference["double_limit"]) * (1.0 + known.abs());
                assert!(
                    (value - known).abs() <= bound + limit + 4.0 * f64::EPSILON * known.abs(),
                    "{command} at {time}: {quantity} = {value} +- {bound}, not {known}"
                );
            }
        }
    }
}

/// A file with the equations of a form, for a stretch in which these parameters are changed.
fn system(problem: &Value, form: &Value, changed: &Value) -> String {
    let mut made = format!(
        "name = \"published\"\nstates = {}\n[where]\n",
        form["states"]
    );
    for (name, formula) in pairs(&problem["constants"]).chain(pairs(&form["where"])) {
        writeln!(made, "{name} = \"{formula}\"").expect("a string");
    }
    made += "[rates]\n";
    for (name, formula) in pairs(&form["rates"]) {
        writeln!(made, "{name} = \"{formula}\"").expect("a string");
    }
    made += "[parameters]\n";
    for (name, value) in pairs(&problem["parameters"]) {
        let value = changed.get(name).map_or(value, text);
        writeln!(made, "{name} = {value}").expect("a string");
    }
    made
}

/// The value of a formula in a state: the rate of a variable over a unit of time.
fn value(problem: &Value, form: &Value, formula: &str, state: &[f64]) -> f64 {
    let mut made = "name = \"value\"\nstates = [\"made\"]\n[where]\n".to_owned();
    for (name, constant) in pairs(&problem["constants"]) {
        writeln!(made, "{name} = \"{constant}\"").expect("a string");
    }
    write!(made, "[rates]\nmade = \"{formula}\"\n[start]\nmade = 0\n").expect("a string");
    made += "[parameters]\n";
    for (name, value) in pairs(&problem["parameters"]) {
        writeln!(made, "{name} = {value}").expect("a string");
    }
    for (name, value) in list(&form["states"]).iter().zip(state) {
        writeln!(made, "{} = {value:?}", text(name)).expect("a string");
    }
    last(&made, "0", "1", &["made".into()])[0]
}

/// The last state of a system that is begun at this one.
fn last(system: &str, start: &str, until: &str, states: &[Value]) -> Vec<f64> {
    let start = format!("--start={start}");
    let arguments = "integrate --final-only --format json -q --rtol 1e-13 --method taylor";
    let mut all: Vec<&str> = arguments.split(' ').collect();
    all.extend([&start, "--until", until, "--system", system]);
    let ended = run(&all);
    assert_eq!(ended.code, 0, "{system}: {}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let end = &made["result"]["final"];
    let states = states.iter().map(text);
    states.map(|name| common::number(&end[name])).collect()
}

#[test]
fn the_published_equations_give_the_references_in_both_forms() {
    for (problem, reference) in problems() {
        for form in list(&problem["forms"]) {
            let states = list(&form["states"]);
            let start = states.iter().map(|name| {
                let formula = text(&form["start"][text(name)]);
                value(&problem, form, formula, &[])
            });
            let mut state: Vec<f64> = start.collect();
            let until = problem["times"].as_array().and_then(|times| times.last());
            let whole = serde_json::json!([{ "until": until }]);
            let mut begin = 0.0;
            for stretch in list(problem.get("segments").unwrap_or(&whole)) {
                let end = common::number(&stretch["until"]);
                let start: Vec<String> = state.iter().map(|value| format!("{value:?}")).collect();
                let made = system(&problem, form, stretch);
                state = last(&made, &start.join(","), &(end - begin).to_string(), states);
                begin = end;
            }
            let known = list(&reference["values"]).last().expect("a row");
            for (quantity, formula) in pairs(&form["compared"]) {
                let made = value(&problem, form, formula, &state);
                let off = error(made, common::number(&known[quantity]));
                assert!(
                    off <= TIGHT,
                    "{}, {}: {quantity} off by {off:e}",
                    problem["name"],
                    form["name"]
                );
            }
        }
    }
}
