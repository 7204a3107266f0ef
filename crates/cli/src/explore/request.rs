//! From the options of a request to the words of a command line.
//!
//! A request comes from a page, and names no file: an option that takes one may have its content instead, as a text of several lines, or
//! the name of what is built in. What may be given is listed here, option by option; one that is listed nowhere is refused.

use crate::catalogue::{OptionInfo, OptionKind, options};
use serde_json::{Map, Value};
use std::path::Path;
use twinslip::error::{Error, did_you_mean};
use twinslip::friction::AnyLaw;
use twinslip_tasks::scene::{shipped_laws, shipped_systems};

/// The commands that a page may ask for.
pub const COMMANDS: [&str; 8] = [
    "law",
    "integrate",
    "equilibria",
    "orbit",
    "section",
    "branch",
    "locus",
    "sweep",
];

/// Options of text that name no file, whatever the text.
const TEXTS: [&str; 27] = [
    "along",
    "at",
    "at-driving",
    "at-stiffness",
    "box",
    "clusters",
    "columns",
    "crosscheck",
    "curves",
    "derivatives",
    "diagram",
    "draw",
    "driving",
    "driving-range",
    "grid",
    "in",
    "method",
    "modulate",
    "of",
    "range",
    "set",
    "solver",
    "start",
    "state-1",
    "state-2",
    "stiffness",
    "stiffness-range",
];
/// More of them.
const MORE_TEXTS: [&str; 5] = ["hold", "surface", "symmetry", "time-unit", "watch"];
/// Options of files that are switches here: what they name goes into the answer.
const INTO_THE_ANSWER: [&str; 3] = ["events", "participation", "plot"];
/// Options of files whose content may be given.
const CONTENTS: [&str; 5] = ["begin", "ensemble", "law", "program", "system"];
/// Options that have no meaning in a request, or are decided by the server.
pub const REFUSED: [&str; 12] = [
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

/// The largest numbers that are allowed of what is counted.
const LARGEST: [(&str, f64); 10] = [
    ("doublings", 12.0),
    ("draws", 1000.0),
    ("interfaces", 1000.0),
    ("max-points", 100_000.0),
    ("max-steps", 1e7),
    ("points", 200_000.0),
    ("returns", 200_000.0),
    ("skip", 1e7),
    ("starts", 1000.0),
    ("turns", 1000.0),
];
/// Options that are grids `[NAME=]A:B:N[log]`, in `sweep`.
const GRIDS: [&str; 5] = ["driving", "grid", "state-1", "state-2", "stiffness"];
/// Points of a grid, starts included.
const MOST_POINTS: f64 = 200_000.0;
/// Values of an option that may be given again.
const MOST_VALUES: usize = 256;
/// Bytes of a text of one line.
const LONGEST_LINE: usize = 4096;

/// The words of a command line with these options, the command's name first.
///
/// # Errors
/// [`Error::Input`] that names the option, for one that is not known, not allowed here, or of the wrong kind.
pub fn words(command: &str, asked: &Map<String, Value>) -> Result<Vec<String>, Error> {
    if !COMMANDS.contains(&command) {
        return Err(Error::unknown("command", command, &COMMANDS));
    }
    let known = options(command);
    let mut words = vec![command.to_owned()];
    let mut given = Vec::with_capacity(asked.len());
    for (name, value) in asked {
        let plain = name.replace('_', "-");
        let option = known.iter().find(|option| option.name == plain);
        let Some(option) = option else {
            let hint = did_you_mean(&plain, known.iter().map(|option| option.name.as_str()));
            return wrong(name, format!("is no option of {command}{hint}"));
        };
        if given.contains(&plain) {
            return wrong(name, "is given twice");
        }
        given.push(plain);
        if matches!(value, Value::Null | Value::Bool(false)) {
            continue;
        }
        let texts = texts(name, option, value)?;
        if option.positional {
            words.extend(texts.into_iter().flatten());
        } else {
            words.extend(texts.into_iter().map(|text| match text {
                Some(text) => format!("--{}={text}", option.name),
                None => format!("--{}", option.name),
            }));
        }
    }
    bounded_grid(command, asked)?;
    Ok(words)
}

fn wrong<T>(name: &str, why: impl std::fmt::Display) -> Result<T, Error> {
    Err(Error::Input(format!("`{name}` {why}")))
}

/// The values of an option, as often as it is given; `None` for one that is given without.
fn texts(name: &str, option: &OptionInfo, value: &Value) -> Result<Vec<Option<String>>, Error> {
    let plain = option.name.as_str();
    if REFUSED.contains(&plain) {
        return wrong(name, "can't be given here");
    }
    if INTO_THE_ANSWER.contains(&plain) {
        return match value {
            // The name says what kind of picture it is, and no more: the picture goes into the answer.
            Value::Bool(true) if plain == "plot" => Ok(vec![Some("picture.svg".into())]),
            Value::Bool(true) => Ok(vec![None]),
            _ => wrong(
                name,
                "must be true or false: what it is about goes into the answer, and not into a file",
            ),
        };
    }
    if CONTENTS.contains(&plain) {
        let Value::String(text) = value else {
            return wrong(name, "must be a text");
        };
        return content(name, plain, text).map(|text| vec![Some(text)]);
    }
    match option.kind {
        OptionKind::Switch => match value {
            Value::Bool(true) => Ok(vec![None]),
            _ => wrong(name, "must be true or false"),
        },
        OptionKind::Number | OptionKind::Count => {
            let text = line(name, value)?;
            bounded(name, plain, &text)?;
            Ok(vec![Some(text)])
        }
        OptionKind::Text if TEXTS.contains(&plain) || MORE_TEXTS.contains(&plain) => match value {
            Value::Bool(true) if plain == "crosscheck" => Ok(vec![None]),
            Value::Array(_) if option.positional => wrong(name, "must be a word"),
            Value::Array(values) if values.len() > MOST_VALUES => {
                wrong(name, format!("has more than {MOST_VALUES} values"))
            }
            Value::Array(values) => {
                let texts = values.iter().map(|value| line(name, value));
                let texts = texts.collect::<Result<Vec<String>, Error>>()?;
                Ok(if option.repeated {
                    texts.into_iter().map(Some).collect()
                } else {
                    vec![Some(texts.join(","))]
                })
            }
            value => {
                let text = line(name, value)?;
                if option.positional && !text.starts_with(|c: char| c.is_ascii_lowercase()) {
                    return wrong(name, format!("is {text:?}, but must be a word"));
                }
                Ok(vec![Some(text)])
            }
        },
        OptionKind::Text | OptionKind::File => wrong(name, "can't be given here"),
    }
}

/// A number, or a text of one line.
fn line(name: &str, value: &Value) -> Result<String, Error> {
    match value {
        Value::Number(number) => Ok(number_text(number)),
        Value::String(text) if text.len() > LONGEST_LINE => {
            wrong(name, format!("is longer than {LONGEST_LINE} bytes"))
        }
        Value::String(text) if text.contains(char::is_control) => {
            wrong(name, "must be a text of one line")
        }
        Value::String(text) => Ok(text.clone()),
        _ => wrong(name, "must be a number or a text"),
    }
}

/// Whole numbers without a point, as counts have to be.
pub fn number_text(number: &serde_json::Number) -> String {
    /// Doubles count to here without gaps.
    const MOST: f64 = 9e15;
    match number.as_f64() {
        Some(x) if x.fract() == 0.0 && x.abs() < MOST && (x != 0.0 || x.is_sign_positive()) => {
            format!("{x:.0}")
        }
        _ => number.to_string(),
    }
}

/// The content of a file, or what is built in by its name.
fn content(name: &str, plain: &str, text: &str) -> Result<String, Error> {
    if text.contains('\0') {
        return wrong(name, "has a zero byte, which no text may have");
    }
    if plain == "program" && text.trim_end().to_lowercase().ends_with(".csv") {
        return wrong(
            name,
            "must be T:V,T:V,... or a table, and can't be a file here",
        );
    }
    if plain == "ensemble" {
        let draws = text
            .rsplit_once('}')
            .and_then(|(_, draws)| draws.trim().strip_prefix(':'));
        bounded(name, "draws", draws.unwrap_or_default())?;
        if !text.contains('\n') {
            return wrong(name, "must be the text of a fit, and can't be a file here");
        }
    }
    if plain == "begin" && !text.contains('\n') {
        return wrong(
            name,
            "must be the text of a file of special points, a colon and the number of a row, and can't be a file here",
        );
    }
    if text.contains('\n') || plain == "program" {
        return Ok(text.to_owned());
    }
    if plain == "law" && (AnyLaw::NAMES.contains(&text) || ["ageing", "aging"].contains(&text)) {
        return Ok(text.to_owned());
    }
    let files = match plain {
        "law" => shipped_laws(),
        _ => shipped_systems(),
    };
    let stem = match plain {
        "law" => text.strip_suffix(".toml").unwrap_or(text),
        _ => text,
    };
    match files.iter().find(|(known, _)| *known == stem) {
        // A file of that name would be read in place of what is built in.
        Some((_, content)) if Path::new(text).exists() => Ok((*content).to_owned()),
        Some(_) => Ok(text.to_owned()),
        None => {
            let laws = AnyLaw::NAMES.iter().filter(|_| plain == "law").copied();
            let others = files.iter().map(|(known, _)| *known);
            let others = others.filter(|known| plain != "law" || !AnyLaw::NAMES.contains(known));
            unknown(name, text, &laws.chain(others).collect::<Vec<_>>())
        }
    }
}

fn unknown(name: &str, text: &str, known: &[&str]) -> Result<String, Error> {
    let hint = did_you_mean(text, known.iter().copied());
    let known = known.join(", ");
    wrong(
        name,
        format!(
            "{text:?} is none of those that are built in, {known}, and no text of several lines{hint}"
        ),
    )
}

/// That a count is not larger than a page can have any use for.
fn bounded(name: &str, plain: &str, text: &str) -> Result<(), Error> {
    let largest = LARGEST.iter().find(|(counted, _)| *counted == plain);
    match (largest, text.trim().parse::<f64>()) {
        (Some((_, most)), Ok(x)) if x > *most => {
            wrong(name, format!("is {text}, but must be at most {most} here"))
        }
        _ => Ok(()),
    }
}

/// That all points of a grid are no more than a page can have any use for, and neither are interfaces.
fn bounded_grid(command: &str, asked: &Map<String, Value>) -> Result<(), Error> {
    let plain = |name: &str| name.replace('_', "-");
    for (name, value) in asked {
        if plain(name) == "clusters" {
            let text = flat(value).join(",");
            let counts = text.split(',').map(|count| count.trim().parse::<f64>());
            bounded(
                name,
                "interfaces",
                &counts.flatten().sum::<f64>().to_string(),
            )?;
        }
    }
    if command != "sweep" {
        return Ok(());
    }
    let mut points = 1.0;
    for (name, value) in asked {
        if GRIDS.contains(&plain(name).as_str()) {
            for grid in flat(value).iter().flat_map(|text| text.split(',')) {
                let count = grid
                    .split(':')
                    .nth(2)
                    .map(|count| count.trim_end_matches("log"));
                points *= count
                    .and_then(|count| count.trim().parse().ok())
                    .unwrap_or(1.0);
            }
        }
        if name == "starts" {
            points *= flat(value)[0].parse().unwrap_or(1.0);
        }
        if points > MOST_POINTS || points.is_nan() {
            let most = format!("has more than {MOST_POINTS} points with the other options");
            return wrong(name, most);
        }
    }
    Ok(())
}

/// The texts of a value.
fn flat(value: &Value) -> Vec<String> {
    match value {
        Value::Array(values) => values.iter().flat_map(flat).collect(),
        Value::String(text) => vec![text.clone()],
        Value::Number(number) => vec![number_text(number)],
        _ => vec![String::new()],
    }
}
