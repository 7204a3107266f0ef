//! `twinslip explore`: a page in the browser on which a system is explored, and the server on this machine that computes for it.

mod answer;
mod assets;
mod browser;
mod bundle;
mod model;
mod outbox;
mod queue;
mod request;
mod server;

use super::call::Call;
use super::{Ending, say};
use queue::Queue;
use serde_json::{Map, Value, json};
use server::{Server, serve};
use std::io::Write;
use std::net::{Ipv4Addr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use twinslip::error::{Error, Result};
use twinslip_tasks::scene::{Command, ModelOptions, sentence};

pub const EXAMPLE: &str = "Example, two interfaces, a scene, and a system of one's own:
  twinslip explore
  twinslip explore fig12
  twinslip explore --system lorenz --no-browser";

/// `explore`: a page on which a system is explored.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct ExploreOptions {
    /// Begin with the system and the options of this scene: a built-in one, such as fig12, or a file
    #[arg(value_name = "SCENE")]
    scene: Option<PathBuf>,
    /// What slides.
    #[command(flatten)]
    model: ModelOptions,
    /// Port of 127.0.0.1 that the server listens on; 0 takes one that is free
    #[arg(long, value_name = "P", default_value_t = 0, help_heading = "Server")]
    port: u16,
    /// Only print the address of the page, and open no browser
    #[arg(long, help_heading = "Server")]
    no_browser: bool,
}

pub fn run(options: &ExploreOptions, call: &Call) -> Result<Ending> {
    let begin = begin(options, call)?;
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, options.port));
    let refused = |error: std::io::Error| {
        Error::Input(format!(
            "`port` {}: can't listen there, {error}; --port 0 takes one that is free",
            options.port
        ))
    };
    let listener = listener.map_err(refused)?;
    let port = listener.local_addr().map_err(refused)?.port();
    let server = Arc::new(Server {
        token: token()?,
        port,
        begin,
        queue: Arc::new(Queue::new()),
    });
    let address = server.address();
    let mut out = std::io::stdout();
    // A closed standard output is nobody's.
    let _ = writeln!(out, "{address}").and_then(|()| out.flush());
    if options.no_browser {
        say("the page is at this address until Ctrl-C");
    } else if !browser::has_display() {
        say("no display was found: open this address in a browser; Ctrl-C ends");
    } else if let Err(error) = browser::open(&address) {
        say(format_args!(
            "no browser could be opened ({error}): open this address in one; Ctrl-C ends"
        ));
    } else {
        say("the page opens in the browser; Ctrl-C ends");
    }
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let served = runtime.and_then(|runtime| {
        runtime.block_on(async {
            listener.set_nonblocking(true)?;
            let listener = tokio::net::TcpListener::from_std(listener)?;
            match serve(listener, server).await {}
        })
    });
    served.map_err(refused)
}

/// 160 random bits, which nobody guesses.
fn token() -> Result<String> {
    let mut bytes = [0; 20];
    getrandom::fill(&mut bytes).map_err(|error| Error::File {
        action: "read",
        path: "the random numbers of the system".into(),
        reason: error.to_string(),
    })?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// What the page begins with: the options of the model as `model`, and of a scene its command and options.
fn begin(options: &ExploreOptions, call: &Call) -> Result<Value> {
    let _ = (
        options,
        call,
        sentence as fn(&clap::Error) -> String,
        Command::program(),
    );
    Ok(json!({"model": Map::new(), "scene": null}))
}
