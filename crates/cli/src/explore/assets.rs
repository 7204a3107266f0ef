//! The files of the page.

use include_dir::{Dir, include_dir};
use std::borrow::Cow;
use std::path::PathBuf;

/// The environment variable that names a folder with the files of the page, which are then read at each request: for those who change
/// the page.
const FOLDER: &str = "TWINSLIP_EXPLORE_PAGE";
/// The module that the others are for.
pub const MAIN: &str = "main.js";

/// The files as the program carries them.
static PAGE: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/src/explore/page");

/// Names and texts of all modules.
pub fn modules() -> Vec<(String, Cow<'static, str>)> {
    let named = |name: &str| name.ends_with(".js").then(|| name.to_owned());
    let mut all: Vec<(String, Cow<'static, str>)> = match folder() {
        None => PAGE
            .files()
            .filter_map(|file| {
                let name = named(file.path().to_str()?)?;
                Some((name, Cow::Borrowed(file.contents_utf8()?)))
            })
            .collect(),
        Some(folder) => std::fs::read_dir(folder)
            .into_iter()
            .flatten()
            .filter_map(|file| {
                let file = file.ok()?;
                let name = named(file.file_name().to_str()?)?;
                Some((name, Cow::Owned(std::fs::read_to_string(file.path()).ok()?)))
            })
            .collect(),
    };
    all.sort();
    all
}

/// The page, as a text in which the parts that begin it stand where a server or a file puts its own.
pub fn index() -> Cow<'static, str> {
    read("index.html")
}

/// Its styles.
pub fn style() -> Cow<'static, str> {
    read("style.css")
}

fn read(name: &str) -> Cow<'static, str> {
    let text = folder().and_then(|folder| std::fs::read_to_string(folder.join(name)).ok());
    let carried = || PAGE.get_file(name).and_then(|file| file.contents_utf8());
    text.map_or_else(|| Cow::Borrowed(carried().unwrap_or_default()), Cow::Owned)
}

fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os(FOLDER)?;
    (!folder.is_empty()).then(|| folder.into())
}
