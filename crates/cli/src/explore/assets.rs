//! The files of the page.

use std::borrow::Cow;
use std::path::PathBuf;

/// The environment variable that names a folder with the files of the page, which are then read at each request: for those who change
/// the page.
const FOLDER: &str = "TWINSLIP_EXPLORE_PAGE";

/// A file of the page, as the program carries it.
macro_rules! files {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("page/", $name)))),*]
    };
}

/// The modules of the script; the one that begins is [`MAIN`].
const MODULES: &[(&str, &str)] = &files!["main.js"];
/// The module that the others are for.
pub const MAIN: &str = "main.js";

/// Names and texts of all modules.
pub fn modules() -> Vec<(String, Cow<'static, str>)> {
    let Some(folder) = folder() else {
        let all = MODULES.iter();
        return all
            .map(|(name, text)| ((*name).to_owned(), Cow::Borrowed(*text)))
            .collect();
    };
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut all: Vec<_> = files
        .filter_map(|file| {
            let name = file.file_name().into_string().ok()?;
            let text = std::fs::read_to_string(file.path()).ok()?;
            name.ends_with(".js").then_some((name, Cow::Owned(text)))
        })
        .collect();
    all.sort();
    all
}

/// The page.
pub fn index() -> Cow<'static, str> {
    read("index.html", include_str!("page/index.html"))
}

/// Its looks.
pub fn style() -> Cow<'static, str> {
    read("style.css", include_str!("page/style.css"))
}

fn read(name: &str, carried: &'static str) -> Cow<'static, str> {
    let text = folder().and_then(|folder| std::fs::read_to_string(folder.join(name)).ok());
    text.map_or(Cow::Borrowed(carried), Cow::Owned)
}

fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os(FOLDER)?;
    (!folder.is_empty()).then(|| folder.into())
}
