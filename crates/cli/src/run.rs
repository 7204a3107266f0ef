//! `twinslip run SCENE`.

use super::call::Call;
use super::{Ending, compute, written};
use std::io::Write;
use std::path::{Path, PathBuf};
use twinslip::error::{Error, Result, did_you_mean};
use twinslip_output::Place;
use twinslip_tasks::scene::{Command, SceneFile, about, shipped, shipped_names};

pub const EXAMPLE: &str =
    "Example, the torus of the paper's Fig. 13, the same at another stiffness, and the list of scenes:
  twinslip run fig13 -o fig13.csv --plot fig13.svg
  twinslip run fig13 --set stiffness=0.19 --until 500
  twinslip run --list";

/// `run`: a scene, and the options that replace those of the scene.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct RunOptions {
    /// The scene: the name of a built-in one, or a file: TOML with command = "integrate" (or another command) and that
    /// command's options by their own names
    #[arg(value_name = "SCENE", required_unless_present = "list")]
    scene: Option<PathBuf>,
    /// Options of the scene's command, which replace those of the scene: --set K=0.1, --until 500, --rtol 1e-10
    #[arg(
        value_name = "OPTIONS",
        trailing_var_arg = true,
        allow_hyphen_values = true,
        conflicts_with_all = ["list", "show"]
    )]
    options: Vec<String>,
    /// List the built-in scenes, with what each shows
    #[arg(long)]
    list: bool,
    /// Write the text of the scene instead of running it, to start a scene file from
    #[arg(long, conflicts_with = "list")]
    show: bool,
    /// Draw into FILE.svg or FILE.png
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Where results go; what is given here replaces what the scene says.
    #[command(flatten)]
    output: twinslip_tasks::scene::OutputOptions,
}

pub fn run(options: &RunOptions, call: &Call) -> Result<Ending> {
    let path = match &options.scene {
        Some(path) if !options.list => path,
        _ => return said(&list()),
    };
    if options.show {
        return match built_in(path)? {
            Some((_, text)) => said(text),
            None => Err(Error::Input(format!(
                "--show is for scenes that are built in, and {} is a file",
                path.display()
            ))),
        };
    }
    let scene = read(path)?;
    let mut given = Vec::new();
    let texts = [
        ("plot", text(&options.plot)),
        ("output", text(&options.output.output)),
        ("format", options.output.format.clone()),
    ];
    for (flag, value) in texts {
        given.extend(value.map(|value| format!("--{flag}={value}")));
    }
    let switches = [
        ("quiet", options.output.quiet),
        ("force", options.output.force),
        ("explain", options.output.explain),
    ];
    let on = switches.iter().filter(|(_, on)| *on);
    given.extend(on.map(|(flag, _)| format!("--{flag}")));
    given.extend(options.options.iter().cloned());
    let command = Command::of_scene(&scene, &given)?;
    compute(&command, call).map_err(|error| match error {
        error @ (Error::Parameter { .. } | Error::Input(_)) => scene.locate(&error),
        error => error,
    })
}

/// A scene that is built in, or a file.
///
/// # Errors
/// [`Error::File`] if it can't be read, [`Error::Input`] with file and line for what is wrong in it.
pub fn read(path: &Path) -> Result<SceneFile> {
    match built_in(path)? {
        Some((name, text)) => SceneFile::parse(&name, text, &Command::program()),
        None => SceneFile::read(path, &Command::program()),
    }
}

/// The name and text of the scene that is built in, if there is no such file: `fig12`, `fig12.toml` or `scenes/fig12.toml`.
fn built_in(path: &Path) -> Result<Option<(String, &'static str)>> {
    if path.exists() {
        return Ok(None);
    }
    let plain = path.strip_prefix("scenes").unwrap_or(path);
    let text = plain.to_string_lossy();
    let name = text.strip_suffix(".toml").unwrap_or(&text);
    if let Some(text) = shipped(name) {
        return Ok(Some((name.to_owned(), text)));
    }
    let hint = did_you_mean(name, shipped_names().into_iter());
    Err(Error::Input(format!(
        "cannot read {}: there is no such file, and no built-in scene of this name{hint} (twinslip run --list names them all)",
        path.display()
    )))
}

/// The scenes that are built in, with what each shows.
fn list() -> String {
    let names = shipped_names();
    let width = names.iter().map(|name| name.len()).max().unwrap_or(0);
    names
        .into_iter()
        .map(|name| {
            format!(
                "{name:<width$}  {}\n",
                about(shipped(name).unwrap_or_default())
            )
        })
        .collect()
}

fn said(text: &str) -> Result<Ending> {
    let place = Place::Standard;
    let mut to = place.stream()?;
    written(
        to.write_all(text.as_bytes()).and_then(|()| to.flush()),
        &place,
    )
}

fn text(path: &Option<PathBuf>) -> Option<String> {
    path.as_ref()
        .map(|path| path.to_string_lossy().into_owned())
}
