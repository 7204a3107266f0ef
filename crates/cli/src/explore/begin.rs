//! What the page begins with: the options of a model, from the command line or a scene, and what the page explains itself by.

use super::super::call::Call;
use super::super::catalogue::{OptionInfo, OptionKind, options};
use super::super::{program, scene_words};
use clap::parser::ValueSource;
use serde_json::{Map, Value, json};
use std::path::Path;
use twinslip::error::{Error, Result};
use twinslip::friction::AnyLaw;
use twinslip_tasks::scene::{Command, about, plain, sentence, shipped, shipped_systems};

/// Headings of the options that make a model.
const MODEL: [&str; 2] = ["Model", "SI units"];
/// The words of the glossary.
const GLOSSARY: &str = include_str!("../../../../docs/glossary.md");
/// A system that those who write their own may begin with.
const EXAMPLE: &str = "van-der-pol";
/// Bytes of a file with a system or a law.
const LONGEST: u64 = 1 << 20;

/// The object that the page begins with.
///
/// - `options`: those of the model, as a request has them; what was given as a file is its text.
/// - `scene`: null, or of a scene its `name`, what it is `about`, its `command` and the `options` beside those of the model.
/// - `systems`: the names of those that are built in, and `example`, the text of one.
/// - `glossary`: the terms of the field, in Markdown.
///
/// # Errors
/// Those of the command line and of the scene.
pub fn begin(scene: Option<&Path>, call: &Call) -> Result<Value> {
    let mut model = Map::new();
    let told = scene.map(|path| of_scene(path, &mut model)).transpose()?;
    let known = options("orbit");
    let words = applied(&call.words)?;
    let matches = program().try_get_matches_from(&words);
    let matches = matches.map_err(|error| Error::Input(sentence(&error)))?;
    if let Some((_, matches)) = matches.subcommand() {
        let own = known
            .iter()
            .filter(|option| MODEL.contains(&option.heading.as_str()));
        for option in own {
            let Some(value) = given(option, matches)? else {
                continue;
            };
            add(&mut model, option, value);
        }
    }
    let systems = shipped_systems();
    let example = systems.iter().find(|(name, _)| *name == EXAMPLE);
    let names: Vec<&str> = systems.iter().map(|(name, _)| *name).collect();
    Ok(json!({
        "options": model,
        "scene": told,
        "systems": names,
        "example": example.map_or("", |(_, text)| text),
        "glossary": GLOSSARY,
    }))
}

/// The options of a scene, of which those of the model are put with the others of it.
fn of_scene(path: &Path, model: &mut Map<String, Value>) -> Result<Value> {
    let words = std::iter::once("twinslip".to_owned()).chain(scene_words(path)?);
    let words = applied(&words.collect::<Vec<_>>())?;
    let matches = Command::program().try_get_matches_from(&words);
    let matches = matches.map_err(|error| Error::Input(sentence(&error)))?;
    let Some((command, matches)) = matches.subcommand() else {
        return Ok(Value::Null);
    };
    let mut others = Map::new();
    for option in &options(command) {
        if let Some(value) = given(option, matches)? {
            match MODEL.contains(&option.heading.as_str()) {
                true => add(model, option, value),
                false => add(&mut others, option, value),
            }
        }
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let about = shipped(&name).map(about);
    Ok(json!({"name": name, "about": about, "command": command, "options": others}))
}

/// Words without units and symbols, as they are parsed.
fn applied(words: &[String]) -> Result<Vec<String>> {
    let plain = plain(words).map_err(Error::Input)?;
    Ok(plain.applied(words))
}

/// Puts an option with the others, instead of the same one before; what may be given again comes after what was given.
fn add(all: &mut Map<String, Value>, option: &OptionInfo, value: Value) {
    let name = option.name.replace('-', "_");
    match (all.get_mut(&name), value) {
        (Some(Value::Array(before)), Value::Array(mut value)) => {
            let named = |one: &Value| {
                one.as_str()
                    .and_then(|text| text.split_once('=').map(|(name, _)| name.to_owned()))
            };
            before.retain(|one| value.iter().all(|new| named(new) != named(one)));
            before.append(&mut value);
        }
        (_, value) => {
            all.insert(name, value);
        }
    }
}

/// The value of an option that was given, as a request has it.
fn given(option: &OptionInfo, matches: &clap::ArgMatches) -> Result<Option<Value>> {
    let id = option.name.replace('-', "_");
    let source = matches
        .try_contains_id(&id)
        .ok()
        .and_then(|_| matches.value_source(&id));
    if source != Some(ValueSource::CommandLine) {
        return Ok(None);
    }
    if option.kind == OptionKind::Switch {
        return Ok(Some(json!(matches.get_flag(&id))));
    }
    let texts = matches.get_raw(&id).into_iter().flatten();
    let texts: Vec<String> = texts
        .map(|text| text.to_string_lossy().into_owned())
        .collect();
    if option.repeated {
        return Ok(Some(json!(texts)));
    }
    let text = texts.join(",");
    Ok(Some(match (option.kind, option.name.as_str()) {
        (OptionKind::Number | OptionKind::Count, _) => match text.trim().parse::<f64>() {
            Ok(x) if x.fract() == 0.0 && x.abs() < 9e15 => json!(x as i64),
            Ok(x) => json!(x),
            Err(_) => json!(text),
        },
        (_, "law") if AnyLaw::NAMES.contains(&text.as_str()) => json!(text),
        (_, "system" | "law") => json!(content(&text)?),
        _ => json!(text),
    }))
}

/// The text of a file, where one is named.
fn content(text: &str) -> Result<String> {
    let path = Path::new(text);
    // What is not there is refused where the model is made.
    if text.contains('\n') || !path.exists() {
        return Ok(text.to_owned());
    }
    let wrong = |reason: String| Error::File {
        action: "read",
        path: path.to_owned(),
        reason,
    };
    let length = std::fs::metadata(path)
        .map_err(|error| wrong(error.to_string()))?
        .len();
    if length > LONGEST {
        return Err(wrong(format!("it is longer than {LONGEST} bytes")));
    }
    let content = std::fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
    Ok(content + "\n")
}
