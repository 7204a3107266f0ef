//! `twinslip reference`: the pages of the documentation on commands, columns and files, as Markdown.

mod columns;
mod commands;
mod files;
mod meanings;

use super::Ending;
use std::path::PathBuf;
use twinslip::error::{Error, Result};

pub const EXAMPLE: &str = "Example, in a clone, after an option or a column has changed:
  twinslip reference --out docs/reference";

/// `reference`: the pages on commands, columns and files.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct ReferenceOptions {
    /// Folder for the pages commands.md, columns.md and files.md; it is made where it is missing
    #[arg(long, value_name = "DIR", default_value = "docs/reference")]
    out: PathBuf,
}

/// What each page begins with, so that nobody edits it by hand.
const NOTE: &str =
    "<!-- Written by `twinslip reference`: change the program, not this page. -->\n\n";

pub fn run(options: &ReferenceOptions) -> Result<Ending> {
    let pages = [
        ("commands.md", commands::page()),
        ("columns.md", columns::page()),
        ("files.md", files::page()),
    ];
    let failed = |path: PathBuf| {
        move |error: std::io::Error| Error::File {
            action: "write",
            path,
            reason: error.to_string(),
        }
    };
    std::fs::create_dir_all(&options.out).map_err(failed(options.out.clone()))?;
    for (name, text) in pages {
        let path = options.out.join(name);
        std::fs::write(&path, format!("{NOTE}{text}")).map_err(failed(path))?;
    }
    Ok(Ending::Done)
}

/// Text of the program in Markdown: characters that would be markup are escaped.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        if "\\*_<>[]|`".contains(letter) {
            escaped.push('\\');
        }
        escaped.push(letter);
    }
    escaped
}

/// A cell of a table with code in it.
fn code(text: &str) -> String {
    format!("`{}`", text.replace('|', "\\|"))
}
