//! The scenes that the program carries: those of the paper's figures, and some more.

use include_dir::{Dir, include_dir};
use std::path::Path;
use twinslip::friction::AnyLaw;

static SCENES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../scenes");

/// The text of the scene of that name, which is that of its file without the ending.
pub fn shipped(name: &str) -> Option<&'static str> {
    SCENES.get_file(format!("{name}.toml"))?.contents_utf8()
}

/// The text of the built-in system file of that name: `lorenz`, `lorenz.toml` or the path that its file has.
pub(super) fn shipped_system(path: &Path) -> Option<&'static str> {
    shipped_in("systems", path)
}

/// The text of the built-in law file of that name.
pub(super) fn shipped_law(path: &Path) -> Option<&'static str> {
    shipped_in("laws", path)
}

fn shipped_in(folder: &str, path: &Path) -> Option<&'static str> {
    let path = path.strip_prefix("scenes").unwrap_or(path);
    let path = path.strip_prefix(folder).unwrap_or(path);
    let file = Path::new(folder).join(path).with_extension("toml");
    SCENES.get_file(file)?.contents_utf8()
}

/// The names of these systems, sorted.
pub(super) fn shipped_system_names() -> Vec<&'static str> {
    SCENES.get_dir("systems").map_or_else(Vec::new, names)
}

/// The systems that are built in, sorted: names and texts.
pub fn shipped_systems() -> Vec<(&'static str, &'static str)> {
    texts("systems")
}

/// The names of all friction laws: those that are built in, and those of the files that the program carries.
pub(super) fn law_names() -> Vec<&'static str> {
    let files = SCENES.get_dir("laws").map_or_else(Vec::new, names);
    let others = files
        .into_iter()
        .filter(|name| !AnyLaw::NAMES.contains(name));
    AnyLaw::NAMES.into_iter().chain(others).collect()
}

/// The friction laws that are built in as files, sorted: names and texts.
pub fn shipped_laws() -> Vec<(&'static str, &'static str)> {
    texts("laws")
}

fn texts(folder: &'static str) -> Vec<(&'static str, &'static str)> {
    let names = SCENES.get_dir(folder).map_or_else(Vec::new, names);
    let text = |name: &'static str| Some((name, shipped_in(folder, Path::new(name))?));
    names.into_iter().filter_map(text).collect()
}

/// The names of all scenes, sorted.
pub fn shipped_names() -> Vec<&'static str> {
    names(&SCENES)
}

fn names(folder: &Dir<'static>) -> Vec<&'static str> {
    let stem = |file: &include_dir::File<'static>| file.path().file_stem()?.to_str();
    let mut names: Vec<&str> = folder.files().filter_map(stem).collect();
    names.sort_unstable();
    names
}

/// What a scene shows: the first sentence of the remark at its head, in the first paragraph.
pub fn about(text: &str) -> String {
    let remark: Vec<&str> = text
        .lines()
        .map_while(|line| line.strip_prefix('#').map(str::trim))
        .take_while(|line| !line.is_empty())
        .collect();
    let remark = remark.join(" ");
    let end = remark
        .match_indices(". ")
        .map(|(i, _)| i)
        .find(|&i| remark[i + 2..].starts_with(char::is_uppercase));
    remark[..end.unwrap_or(remark.len())]
        .trim_end_matches('.')
        .to_owned()
}
