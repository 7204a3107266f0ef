//! `twinslip completions` and `twinslip man`: what a shell and a reader of manual pages need.

use super::{Ending, program, written};
use clap_complete::Shell;
use std::io::Write;
use std::path::PathBuf;
use twinslip::error::{Error, Result};
use twinslip_output::Place;

pub const COMPLETIONS_EXAMPLE: &str = "Example, for the bash of this user, from the next shell on:
  twinslip completions bash > ~/.local/share/bash-completion/completions/twinslip";

pub const MAN_EXAMPLE: &str = "Example, and how to read one of the pages:
  twinslip man --out man
  man man/twinslip-integrate.1";

/// `completions`: names of commands, options and values for a shell.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct CompletionsOptions {
    /// For which shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// `man`: manual pages.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct ManOptions {
    /// Where the pages go, one for each command; the directory is made where it is missing
    #[arg(long, value_name = "DIR", default_value = "man")]
    out: PathBuf,
}

pub fn completions(options: &CompletionsOptions) -> Result<Ending> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut program(), "twinslip", &mut script);
    let place = Place::Standard;
    let mut to = place.stream()?;
    written(to.write_all(&script).and_then(|()| to.flush()), &place)
}

pub fn man(options: &ManOptions) -> Result<Ending> {
    std::fs::create_dir_all(&options.out)
        .and_then(|()| clap_mangen::generate_to(program(), &options.out))
        .map_err(|error| Error::File {
            action: "write",
            path: options.out.clone(),
            reason: error.to_string(),
        })?;
    Ok(Ending::Done)
}
