//! `twinslip completions` and `twinslip man`: what a shell and a reader of manual pages need.

use super::{Ending, program, say, written};
use clap_complete::Shell;
use std::io::IsTerminal;
use std::path::PathBuf;
use twinslip::error::{Error, Result};
use twinslip_output::Place;

pub const COMPLETIONS_EXAMPLE: &str = "Example, for new bash shells of this user:
  twinslip completions bash -o ~/.local/share/bash-completion/completions/twinslip";

pub const MAN_EXAMPLE: &str = "Example, and a command that shows one of the pages:
  twinslip man --out man
  man man/twinslip-integrate.1";

/// `completions`: names of commands, options and values for a shell.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct CompletionsOptions {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
    /// Write the script to FILE; - is standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// `man`: manual pages.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct ManOptions {
    /// Directory of the pages, one for each command; it is created if needed
    #[arg(long, value_name = "DIR", default_value = "man")]
    out: PathBuf,
}

/// Where a shell looks for the script, and the line that loads it there.
fn usage(shell: Shell) -> &'static str {
    match shell {
        Shell::Bash => {
            "save it as ~/.local/share/bash-completion/completions/twinslip; new shells load it"
        }
        Shell::Zsh => {
            "save it as _twinslip in a directory of $fpath, such as ~/.zfunc; new shells load it after compinit"
        }
        Shell::Fish => "save it as ~/.config/fish/completions/twinslip.fish; new shells load it",
        Shell::PowerShell => "append it to the file $PROFILE; new shells load it",
        Shell::Elvish => "append it to ~/.config/elvish/rc.elv; new shells load it",
        _ => "save it where this shell looks for completions",
    }
}

pub fn completions(options: &CompletionsOptions) -> Result<Ending> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut program(), "twinslip", &mut script);
    let place = Place::new(options.output.as_deref());
    let ended = written(place.write(&script), &place)?;
    let shell = options.shell;
    match place.path() {
        Some(path) => say(format_args!(
            "wrote the completions for {shell} into {}",
            path.display()
        )),
        // In a pipe the script is already where it goes.
        None if std::io::stdout().is_terminal() => say(format_args!(
            "the script above completes twinslip in {shell}: {}",
            usage(shell)
        )),
        None => {}
    }
    Ok(ended)
}

pub fn man(options: &ManOptions) -> Result<Ending> {
    let program = program();
    // One for the program, and one for each command.
    let shown = program.get_subcommands().filter(|one| !one.is_hide_set());
    let pages = 1 + shown.count();
    std::fs::create_dir_all(&options.out)
        .and_then(|()| clap_mangen::generate_to(program, &options.out))
        .map_err(|error| Error::File {
            action: "write",
            path: options.out.clone(),
            reason: error.to_string(),
        })?;
    say(format_args!(
        "wrote {pages} pages into {0}; read one by: man {0}/twinslip.1",
        options.out.display()
    ));
    Ok(Ending::Done)
}
