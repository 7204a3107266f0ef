//! `twinslip run SCENE.toml`.

use super::{Ending, compute};
use crate::error::{Error, Result};
use crate::scene::{Command, SceneFile};
use std::path::PathBuf;

pub const EXAMPLE: &str = "Example, the torus of the paper's Fig. 13:
  twinslip run scenes/fig13.toml -o fig13.csv --plot fig13.svg";

/// `run`: a scene file, and what may be said anew.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct RunOptions {
    /// The scene: TOML with command = "integrate" (or another command) and that command's options by their own names
    #[arg(value_name = "SCENE.toml")]
    scene: PathBuf,
    /// Draw into FILE.svg or FILE.png
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Where results go; what is given here replaces what the scene says.
    #[command(flatten)]
    output: crate::scene::OutputOptions,
}

pub fn run(options: &RunOptions, words: &[String]) -> Result<Ending> {
    let scene = SceneFile::read(&options.scene, &Command::program())?;
    let (mut replaced, mut added) = (Vec::new(), Vec::new());
    let texts = [
        ("plot", path(&options.plot)),
        ("output", path(&options.output.output)),
        ("format", options.output.format.clone()),
    ];
    for (flag, value) in texts {
        if let Some(value) = value {
            replaced.push(flag);
            added.push(format!("--{flag}={value}"));
        }
    }
    if options.output.output.is_some() && options.output.format.is_none() {
        // A new FILE has a format of its own, by its extension.
        replaced.push("format");
    }
    let switches = [
        ("quiet", options.output.quiet),
        ("force", options.output.force),
        ("explain", options.output.explain),
    ];
    for (flag, on) in switches {
        if on {
            replaced.push(flag);
            added.push(format!("--{flag}"));
        }
    }
    let command = Command::of_scene(&scene, &replaced, &added)?;
    compute(&command, words).map_err(|error| match error {
        error @ (Error::Parameter { .. } | Error::Input(_)) => scene.locate(&error),
        error => error,
    })
}

fn path(path: &Option<PathBuf>) -> Option<String> {
    path.as_ref()
        .map(|path| path.to_string_lossy().into_owned())
}
