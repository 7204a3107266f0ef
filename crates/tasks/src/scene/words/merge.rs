//! The options of a scene with those that are given beside it, which take their place.

use super::{SI, plain};
use std::collections::BTreeSet;

/// The command line of a scene, the name of the program first, with the options of its command that are given beside it: each takes the
/// place of the scene's, and so does a value of `set` for its parameter. Options of the scene that exclude one that is given are left
/// out.
///
/// # Errors
/// As of [`plain`]; a sentence for a value with a unit beside a scene without units.
pub fn merged(
    program: &clap::Command,
    scene: &[String],
    given: &[String],
) -> Result<Vec<String>, String> {
    let of_scene = plain(scene)?;
    // What an option means may depend on the scene: its command and what varies.
    let all = [scene, given].concat();
    let of_all = plain(&all)?;
    if let (Some(SI), None, Some(value)) = (of_all.implied, of_scene.implied, &of_all.with_unit) {
        return Err(format!(
            "{value}: the numbers of this scene are dimensionless; give this one without its unit, or --si with all others"
        ));
    }
    let expanded = |words: &[String], new: &[Option<Vec<String>>]| {
        let pairs = words.iter().zip(new);
        let each = pairs.flat_map(|(word, new)| new.clone().unwrap_or_else(|| vec![word.clone()]));
        each.collect::<Vec<String>>()
    };
    let given = expanded(given, &of_all.words[scene.len()..]);
    let command = scene.get(1).and_then(|name| program.find_subcommand(name));
    let Some(command) = command else {
        return Ok(all);
    };
    let mut scene = expanded(scene, &of_scene.words);
    let by_flag = |word: &str| {
        let long = word.strip_prefix("--").map(|word| word.split('=').next());
        let short = word.strip_prefix('-').filter(|_| long.is_none());
        command.get_arguments().find(|arg| match long.flatten() {
            Some(long) => arg.get_long() == Some(long),
            None => short.is_some_and(|short| arg.get_short() == short.chars().next()),
        })
    };
    let mut replaced = BTreeSet::new();
    let mut parameters = BTreeSet::new();
    for (place, word) in given.iter().enumerate() {
        let Some(arg) = by_flag(word) else { continue };
        let name = arg.get_long().unwrap_or_default();
        if name == "set" {
            let value = word.split_once('=').map(|(_, value)| value);
            let value = value.or_else(|| given.get(place + 1).map(String::as_str));
            let names = value.into_iter().flat_map(|value| value.split(','));
            parameters
                .extend(names.filter_map(|pair| Some(pair.split_once('=')?.0.replace('_', "-"))));
            continue;
        }
        replaced.insert(name.to_owned());
        parameters.insert(name.to_owned());
        let excluded = command.get_arg_conflicts_with(arg);
        replaced.extend(
            excluded
                .into_iter()
                .filter_map(|arg| arg.get_long())
                .map(str::to_owned),
        );
    }
    replaced.extend(parameters.iter().cloned());
    scene = scene
        .into_iter()
        .filter_map(|word| keep(word, &replaced, &parameters))
        .collect();
    // Without a format of its own, a new file has that of its ending.
    if replaced.contains("output") {
        scene.retain(|word| !word.starts_with("--format="));
    }
    scene.extend(given);
    scene.extend(of_scene.implied.map(str::to_owned));
    Ok(scene)
}

/// A word of a scene, unless an option takes its place; of `set` what is left of it.
fn keep(
    word: String,
    replaced: &BTreeSet<String>,
    parameters: &BTreeSet<String>,
) -> Option<String> {
    let Some(flag) = word.strip_prefix("--") else {
        return Some(word);
    };
    let (flag, value) = flag.split_once('=').unwrap_or((flag, ""));
    if flag != "set" {
        return (!replaced.contains(flag)).then_some(word);
    }
    let left = value.split(',').filter(|pair| {
        let name = pair.split('=').next().unwrap_or_default();
        !parameters.contains(&name.replace('_', "-"))
    });
    let left: Vec<&str> = left.collect();
    (!left.is_empty()).then(|| format!("--set={}", left.join(",")))
}
