//! What the page begins with: the options of a model, from the command line or a scene, and what the page explains itself by.

use super::super::call::Call;
use super::super::catalogue::{OptionInfo, OptionKind, options};
use super::super::{program, scene_words};
use clap::Arg;
use clap::parser::ValueSource;
use serde_json::{Map, Value, json};
use std::path::Path;
use twinslip::error::{Error, Result};
use twinslip::friction::AnyLaw;
use twinslip_tasks::scene::{Command, about, plain, sentence, shipped, shipped_systems};

/// Headings of the options that make a model.
pub const MODEL: [&str; 2] = ["Model", "SI units"];
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
    let told = scene.map(Scene::read).transpose()?;
    // Symbols and units mean what they do beside the options of the scene: those of the command line go with these.
    let typed = texts(program(), &call.words, &options("orbit"))?;
    let mut words = vec!["twinslip".to_owned(), "orbit".to_owned()];
    let of_scene = told.iter().flat_map(|scene| &scene.model);
    let kept = of_scene.filter(|(option, _)| {
        option.repeated || typed.iter().all(|(other, _)| other.name != option.name)
    });
    for (option, texts) in kept.chain(&typed) {
        let name = &option.name;
        words.extend(match option.kind {
            OptionKind::Switch => vec![format!("--{name}")],
            _ => texts
                .iter()
                .map(|text| format!("--{name}={text}"))
                .collect(),
        });
    }
    let mut model = Map::new();
    for (option, texts) in texts(Command::program(), &applied(&words)?, &options("orbit"))? {
        model.insert(option.name.replace('-', "_"), value(&option, texts)?);
    }
    let systems = shipped_systems();
    let example = systems.iter().find(|(name, _)| *name == EXAMPLE);
    let names: Vec<&str> = systems.iter().map(|(name, _)| *name).collect();
    Ok(json!({
        "options": model,
        "scene": told.map(|scene| scene.told),
        "systems": names,
        "example": example.map_or("", |(_, text)| text),
        "glossary": GLOSSARY,
    }))
}

/// Options that were given, with what stands there.
type Given = Vec<(OptionInfo, Vec<String>)>;

/// A scene, read.
struct Scene {
    /// Its options of the model.
    model: Given,
    /// What the page is told of it.
    told: Value,
}

impl Scene {
    fn read(path: &Path) -> Result<Self> {
        let words = std::iter::once("twinslip".to_owned()).chain(scene_words(path)?);
        let words: Vec<String> = words.collect();
        let command = words.get(1).map_or("", String::as_str);
        let known = options(command);
        let is_model =
            |(option, _): &(OptionInfo, Vec<String>)| MODEL.contains(&option.heading.as_str());
        let mut model = texts(Command::program(), &words, &known)?;
        model.retain(is_model);
        let mut others = Map::new();
        for one in texts(Command::program(), &applied(&words)?, &known)? {
            if !is_model(&one) {
                others.insert(one.0.name.replace('-', "_"), value(&one.0, one.1)?);
            }
        }
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let about = shipped(&name).map(about);
        let told = json!({"name": name, "about": about, "command": command, "options": others});
        Ok(Scene { model, told })
    }
}

/// Words without units and symbols, as they are parsed.
fn applied(words: &[String]) -> Result<Vec<String>> {
    let plain = plain(words).map_err(Error::Input)?;
    Ok(plain.applied(words))
}

/// Those of the options that these words give, with their texts as they stand there, units and symbols too.
fn texts(program: clap::Command, words: &[String], known: &[OptionInfo]) -> Result<Given> {
    let as_text = |option: Arg| match option.get_action().takes_values() {
        true => option.value_parser(clap::value_parser!(String)),
        false => option,
    };
    let command = words.get(1).map_or("", String::as_str);
    let program = program.mut_subcommand(command, |command| command.mut_args(as_text));
    // A value with a unit stands for an option that others need.
    let implied = plain(words).map_err(Error::Input)?.implied;
    let words = words.iter().map(String::as_str);
    let matches = program.try_get_matches_from(words.chain(implied));
    let matches = matches.map_err(|error| Error::Input(sentence(&error)))?;
    let Some((_, matches)) = matches.subcommand() else {
        return Ok(Vec::new());
    };
    let given = |option: &OptionInfo| {
        let id = option.name.replace('-', "_");
        let source = matches
            .try_contains_id(&id)
            .ok()
            .and_then(|_| matches.value_source(&id));
        let texts = || matches.get_raw(&id).into_iter().flatten();
        let texts = || {
            texts()
                .map(|text| text.to_string_lossy().into_owned())
                .collect()
        };
        (source == Some(ValueSource::CommandLine)).then(|| (option.clone(), texts()))
    };
    let is_implied = |option: &OptionInfo| {
        implied.and_then(|flag| flag.strip_prefix("--")) == Some(&option.name)
    };
    let known = known.iter().filter(|option| !is_implied(option));
    Ok(known.filter_map(given).collect())
}

/// The value of an option, as a request has it.
fn value(option: &OptionInfo, texts: Vec<String>) -> Result<Value> {
    if option.repeated {
        let name = |text: &str| text.split('=').next().unwrap_or_default().trim().to_owned();
        let is_last = |i: usize| {
            texts[i + 1..]
                .iter()
                .all(|later| name(later) != name(&texts[i]))
        };
        let last = (0..texts.len()).filter(|&i| option.name != "set" || is_last(i));
        return Ok(last.map(|i| texts[i].as_str()).collect());
    }
    let text = texts.join(",");
    Ok(match (option.kind, option.name.as_str()) {
        (OptionKind::Switch, _) => json!(true),
        (OptionKind::Number | OptionKind::Count, _) => match text.trim().parse::<f64>() {
            Ok(x) if x.fract() == 0.0 && x.abs() < 9e15 => json!(x as i64),
            Ok(x) => json!(x),
            Err(_) => json!(text),
        },
        (_, "law") if AnyLaw::NAMES.contains(&text.as_str()) => json!(text),
        (_, "system" | "law") => json!(content(&text)?),
        _ => json!(text),
    })
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
