//! What `twinslip explore` answers is what the command line prints.

use crate::command;
use command::explore::{Answer, COMMANDS, Server};
use command::{csv, folder, run};
use serde_json::{Value, json};
use twinslip_cli::internals::explore_words as words;
use twinslip_cli::options;

/// Commands with their options, as a request has them.
fn asked() -> Vec<(&'static str, Value)> {
    let at = |driving: f64, stiffness: f64| json!({"driving": driving, "stiffness": stiffness});
    let with = |mut options: Value, more: Value| {
        let more = more.as_object().expect("an object").clone();
        options.as_object_mut().expect("an object").extend(more);
        options
    };
    let text = "name = \"oscillator\"\nstates = [\"x\", \"y\"]\n[parameters]\nmu = 1.0\n[rates]\nx = \"y\"\ny = \"mu*(1 - x^2)*y - x\"\n[start]\nx = 2.0\ny = 0.0\n";
    vec![
        ("equilibria", at(10.0, 0.14)),
        ("equilibria", at(1000.0, 0.45)),
        (
            "equilibria",
            with(at(1e-3, 0.2), json!({"interfaces": 5, "solver": "newton"})),
        ),
        (
            "equilibria",
            json!({"system": "lorenz", "box": "x=-50:50,y=-50:50,z=-50:100"}),
        ),
        ("integrate", with(at(10.0, 0.14), json!({"until": 5}))),
        (
            "integrate",
            with(
                at(0.12, 0.14),
                json!({"until": 10, "points": 21, "final_only": null, "events": true}),
            ),
        ),
        (
            "integrate",
            with(
                at(1.0, 0.5),
                json!({"until": 60, "program": "10:0,20:1,30-40:10", "points": 7}),
            ),
        ),
        (
            "integrate",
            with(
                at(10.0, 0.14),
                json!({"until": 5, "method": "rodas5p", "rtol": 1e-6, "atol": 1e-9, "estimate_error": true}),
            ),
        ),
        (
            "integrate",
            json!({"driving": "10um/s", "stiffness": "5MPa/mm", "until": "2s", "final-only": true}),
        ),
        (
            "integrate",
            json!({"system": text, "until": 3, "set": ["mu=4"], "points": 3}),
        ),
        (
            "integrate",
            json!({"system": "van-der-pol", "until": 3, "set": "mu=4", "final_only": true, "start": [1, 0.5]}),
        ),
        (
            "orbit",
            with(
                at(10.0, 0.14),
                json!({"symmetry": "asymmetric", "points": 5}),
            ),
        ),
        ("orbit", with(at(0.2, 0.05), json!({"crosscheck": "none"}))),
        ("orbit", json!({"system": "van-der-pol", "set": ["mu=8"]})),
        ("section", with(at(0.2, 0.05), json!({"returns": 40}))),
        (
            "law",
            json!({"from": 1e-2, "to": 1e3, "points": 9, "law": "ageing", "set": ["R=50", "b=0.06"]}),
        ),
        (
            "branch",
            json!({"of": "equilibria", "stiffness": 0.14, "from": 1, "to": 100}),
        ),
        (
            "branch",
            json!({"of": "orbits", "stiffness": 0.14, "along": "driving=5:20", "symmetry": "symmetric"}),
        ),
        (
            "locus",
            json!({"of": "pitchfork", "stiffness_range": [0.1, 0.2], "at": ["driving=1,2"]}),
        ),
        (
            "sweep",
            json!({"driving": "0.1:0.2:3", "stiffness": "0.1:0.2:2", "lyapunov": false}),
        ),
    ]
}

/// The command line with these options.
fn arguments(command: &str, options: &Value) -> Vec<String> {
    let mut all = words(command, options.as_object().expect("an object")).expect("allowed");
    all.extend(["--format=json".into(), "-q".into()]);
    all
}

/// An object without the words of its command.
fn without_command(object: &str) -> String {
    let (before, rest) = object.split_once("\"command\":[").expect("a command");
    let (_, after) = rest.split_once("],\"sundials\"").expect("its end");
    format!("{before}{after}")
}

#[test]
fn objects_are_those_of_the_command_line() {
    let server = Server::start(&[]);
    let all = asked();
    assert!(all.len() >= 20);
    for (command, options) in all {
        let arguments = arguments(command, &options);
        let ended = run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
        let Answer {
            status,
            heads: _,
            body,
        } = server.object(command, &options);
        assert_eq!(status, 200, "{command} {options}: {body}");
        assert!(matches!(ended.code, 0 | 3), "{}", ended.err);
        assert_eq!(
            without_command(&body),
            without_command(&ended.out),
            "{command} {options}"
        );
    }
}

#[test]
fn rows_come_in_lines_with_the_digits_of_csv() {
    let server = Server::start(&[]);
    let rows = |answer: &Answer| -> Vec<Value> {
        let lines = answer.lines().into_iter();
        let rows = lines.filter_map(|line| Some(line.get("rows")?.as_array()?.clone()));
        rows.flatten().collect()
    };
    for (command, options) in asked() {
        // What these find is in the object.
        let in_object = ["equilibria", "law", "orbit"].contains(&command);
        if in_object && options.get("points") != Some(&json!(5)) {
            continue;
        }
        let answer = server.stream(command, &options);
        let lines = answer.lines();
        assert_eq!(answer.status, 200);
        assert_eq!(answer.head("content-type"), "application/x-ndjson");
        let last = lines.last().expect("lines");
        assert!(
            ["done", "undecided"].contains(&last["ended"].as_str().unwrap_or("")),
            "{command} {options}: {last}"
        );
        let mut line = words(command, options.as_object().expect("an object")).expect("allowed");
        if options.get("events").is_some() {
            line.retain(|word| word != "--events");
        }
        line.extend(["--format=csv".into(), "-q".into()]);
        let ended = run(&line.iter().map(String::as_str).collect::<Vec<_>>());
        let mut table = csv(&ended.out);
        if table[0].last().is_some_and(|name| name == "row_check") {
            table.iter_mut().for_each(|row| drop(row.pop()));
        }
        let columns = lines
            .iter()
            .find_map(|line| line.get("columns"))
            .expect("columns");
        let names: Vec<&str> = columns
            .as_array()
            .expect("a list")
            .iter()
            .filter_map(Value::as_str)
            .collect();
        assert_eq!(names, table[0]);
        let units = lines
            .iter()
            .find_map(|line| line.get("units"))
            .expect("units");
        assert_eq!(units.as_array().map(Vec::len), Some(names.len()));
        let rows = rows(&answer);
        assert_eq!(rows.len(), table.len() - 1, "{command} {options}");
        for (row, told) in rows.iter().zip(&table[1..]) {
            for (cell, told) in row.as_array().expect("a row").iter().zip(told) {
                match cell {
                    Value::Null => assert_eq!(told, ""),
                    Value::Number(number) => {
                        assert_eq!(number.as_f64(), told.parse().ok(), "{told}")
                    }
                    Value::String(text) => assert_eq!(text, told),
                    other => panic!("{other}"),
                }
            }
        }
        let object = lines
            .iter()
            .find_map(|line| line.get("object"))
            .expect("an object");
        let kept = object.pointer("/result/rows").and_then(Value::as_array);
        assert!(kept.is_none_or(Vec::is_empty), "{command}: rows come once");
    }
}

#[test]
fn pictures_special_points_messages_and_ends_are_lines() {
    let server = Server::start(&[]);
    let kinds = |answer: &Answer| -> Vec<String> {
        let kind = |line: &Value| {
            line.as_object()
                .and_then(|line| line.keys().next().cloned())
        };
        let mut kinds: Vec<String> = answer.lines().iter().filter_map(kind).collect();
        // Rows go out when they are 20 ms old, in as many lines as that makes.
        kinds.dedup();
        kinds
    };
    let run = json!({"driving": 10, "stiffness": 0.14, "until": 2, "points": 3, "plot": true});
    let answer = server.stream("integrate", &run);
    assert_eq!(
        kinds(&answer),
        ["columns", "rows", "object", "picture", "say", "ended"]
    );
    let lines = answer.lines();
    let pictures = lines.iter().map(|line| &line["picture"]);
    let picture = pictures.into_iter().find(|picture| !picture.is_null());
    let picture = picture.expect("a picture");
    assert!(picture["blocks"][0]["columns"][0][0]["series"].is_array());
    let branch = json!({"of": "equilibria", "stiffness": 0.14, "plot": true});
    let answer = server.stream("branch", &branch);
    let lines = answer.lines();
    let special = lines
        .iter()
        .find_map(|line| line.get("special"))
        .expect("special points");
    assert_eq!(special["columns"][0], "label");
    assert_eq!(
        special["rows"][0].as_array().map(Vec::len),
        special["columns"].as_array().map(Vec::len)
    );
    let section = json!({"driving": 0.102, "stiffness": 0.2, "returns": 30});
    assert_eq!(
        server.stream("section", &section).lines().last(),
        Some(&json!({"ended": "undecided"}))
    );
    let wrong = server.stream("orbit", &json!({"driving": -1, "stiffness": 0.14}));
    let told = &wrong.lines()[0]["error"];
    assert_eq!(
        (&told["kind"], &told["field"]),
        (&json!("input"), &json!("driving"))
    );
    let failed = json!({"driving": 10, "stiffness": 0.14, "until": 1e6, "max_steps": 10, "final_only": true});
    let lines = server.stream("integrate", &failed).lines();
    let told = lines.last().map(|line| &line["error"]["kind"]);
    assert_eq!(told, Some(&json!("numerical")));
    let statuses = [
        ("orbit", json!({"driving": -1, "stiffness": 0.14}), 400),
        ("integrate", failed, 422),
    ];
    for (command, options, status) in statuses {
        assert_eq!(server.object(command, &options).status, status);
    }
}

#[test]
fn answers_end_at_the_rows_that_are_allowed() {
    let server = Server::start(&[]);
    let endless = json!({"driving": 0.102, "stiffness": 0.2, "until": 1e9, "columns": "time"});
    let lines = server.stream("integrate", &endless).lines();
    let rows: usize = lines
        .iter()
        .filter_map(|line| line.get("rows")?.as_array().map(Vec::len))
        .sum();
    assert_eq!(rows, 200_000);
    assert!(lines.iter().any(|line| {
        line["say"]
            .as_str()
            .is_some_and(|text| text.contains("stopped at 200000 rows"))
    }));
    assert_eq!(lines.last(), Some(&json!({"ended": "interrupted"})));
    let answer = server.object("integrate", &endless);
    assert_eq!(answer.status, 400);
    assert!(
        answer.message().contains("stopped at 200000 rows"),
        "{}",
        answer.body
    );
}

/// What a picture is made of is kept, too.
#[test]
fn runs_end_at_the_points_of_a_picture_that_are_allowed() {
    let server = Server::start(&[]);
    let endless =
        json!({"driving": 0.102, "stiffness": 0.2, "until": 1e9, "points": 2, "plot": true});
    let lines = server.stream("integrate", &endless).lines();
    let said = |line: &Value| {
        line["say"]
            .as_str()
            .is_some_and(|text| text.contains("the picture has as many points"))
    };
    assert!(lines.iter().any(said));
    assert!(lines.iter().any(|line| line.get("picture").is_some()));
    assert_eq!(lines.last(), Some(&json!({"ended": "interrupted"})));
}

#[test]
fn a_model_is_described() {
    let server = Server::start(&[]);
    let model = server.object("model", &json!({"driving": 10})).json();
    assert_eq!(model["kind"], "interfaces");
    assert_eq!(model["axes"][0], "driving");
    let lines = server.stream("model", &json!({})).lines();
    assert_eq!(lines[0]["object"]["kind"], "interfaces");
    assert_eq!(lines[1], json!({"ended": "done"}));
}

/// An option that is listed nowhere is refused: one that is new has to be looked at.
#[test]
fn every_option_is_either_allowed_or_refused() {
    const REFUSED: [&str; 12] = [
        "checkpoint",
        "checkpoint-steps",
        "data",
        "explain",
        "force",
        "format",
        "output",
        "plot-events",
        "quiet",
        "resume",
        "shard",
        "threads",
    ];
    let place = folder("explore-options");
    let file = place.join("secret.toml");
    std::fs::write(&file, "secret").expect("written");
    let path = file.to_str().expect("UTF-8");
    for command in COMMANDS {
        for option in options(command) {
            let name = option.name.as_str();
            let asked = |value: Value| {
                let one = [(name.to_owned(), value)].into_iter().collect();
                words(command, &one)
            };
            let tried = [
                json!(true),
                json!(1),
                json!("1"),
                json!("spinodal"),
                json!("lorenz"),
                json!("a\nb"),
                json!(["1"]),
            ];
            let allowed = tried
                .iter()
                .filter(|value| asked((*value).clone()).is_ok())
                .count();
            if REFUSED.contains(&name) {
                assert_eq!(allowed, 0, "{command} --{name}");
            } else {
                assert!(allowed > 0, "{command} --{name} is listed nowhere");
            }
            // No file gets into an option that may read one.
            let reads = ["data", "ensemble", "law", "system"].contains(&name)
                || option.kind.name() == "file";
            if reads {
                for path in [path, "secret.toml", "-", "/dev/stdin", "../Cargo.toml"] {
                    let given = asked(json!(path));
                    assert!(given.is_err(), "{command} --{name} {path}: {given:?}");
                }
            }
            let zero = asked(json!("1\0"));
            assert!(zero.is_err(), "{command} --{name}: {zero:?}");
        }
    }
    let program = [("program".to_owned(), json!("changes.CSV"))]
        .into_iter()
        .collect();
    assert!(words("integrate", &program).is_err());
}
