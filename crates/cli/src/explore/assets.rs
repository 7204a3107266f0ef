//! The files of the page.

use include_dir::{Dir, include_dir};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// The environment variable that names a folder with the files of the page, which are then read at each request: for those who change
/// the page.
const FOLDER: &str = "TWINSLIP_EXPLORE_PAGE";
/// The module that the others are for.
pub const MAIN: &str = "main.js";

/// The files as the program carries them.
static PAGE: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/src/explore/page");

/// Paths from the folder of the page, and texts, of all modules.
pub fn modules() -> Vec<(String, Cow<'static, str>)> {
    let mut all = Vec::new();
    match folder() {
        None => add_carried(&PAGE, &mut all),
        Some(folder) => add_read(&folder, "", &mut all),
    }
    all.sort();
    all
}

fn is_module(name: &str) -> bool {
    name.ends_with(".js")
}

fn add_carried(folder: &Dir<'static>, all: &mut Vec<(String, Cow<'static, str>)>) {
    for file in folder.files() {
        // Folders are named with / on every system.
        let name = file.path().to_string_lossy().replace('\\', "/");
        if let Some(text) = file.contents_utf8().filter(|_| is_module(&name)) {
            all.push((name, Cow::Borrowed(text)));
        }
    }
    folder.dirs().for_each(|inside| add_carried(inside, all));
}

fn add_read(folder: &Path, above: &str, all: &mut Vec<(String, Cow<'static, str>)>) {
    for file in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let (path, name) = (file.path(), file.file_name());
        let name = format!("{above}{}", name.to_string_lossy());
        if path.is_dir() {
            add_read(&path, &format!("{name}/"), all);
        } else if let Some(text) = std::fs::read_to_string(&path)
            .ok()
            .filter(|_| is_module(&name))
        {
            all.push((name, Cow::Owned(text)));
        }
    }
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
