//! `twinslip explore`: a page in the browser on which a system is explored, and the server on this machine that computes for it.

mod answer;
mod assets;
mod begin;
mod browser;
pub(crate) mod bundle;
mod engine;
mod model;
mod outbox;
mod patient;
mod queue;
pub(crate) mod request;
mod save;
mod server;
mod start;
mod work;

pub use engine::{Asked, Engine, widget_begin, widget_module, widget_style};

use super::call::Call;
use super::words::time;
use super::{Ending, say};
use queue::Queue;
use serde_json::{Value, json};
use server::{Server, serve};
use std::io::Write;
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tokio::sync::Mutex;
use twinslip::error::{Error, Result};
use twinslip_output::{Place, write_whole};
use twinslip_tasks::scene::ModelOptions;

pub(crate) const EXAMPLE: &str = "Example, two interfaces, a scene, and a system of one's own:
  twinslip explore
  twinslip explore fig12
  twinslip explore --system lorenz --no-browser";

/// `explore`: a page on which a system is explored.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub(crate) struct ExploreOptions {
    /// Begin with the system and the options of this scene: a built-in one, such as fig12, or a file
    #[arg(value_name = "SCENE")]
    scene: Option<PathBuf>,
    /// What slides.
    #[command(flatten)]
    model: ModelOptions,
    /// Port of 127.0.0.1 that the server listens on; 0 takes one that is free
    #[arg(long, value_name = "P", default_value_t = 0, help_heading = "Page")]
    port: u16,
    /// Only print the address of the page, and open no browser
    #[arg(long, help_heading = "Page")]
    no_browser: bool,
    /// Write the page with its first pictures into FILE.html, which needs no server, instead of serving it
    #[arg(long, value_name = "FILE", conflicts_with_all = ["port", "no_browser"], help_heading = "Page")]
    save: Option<PathBuf>,
}

pub(crate) fn run(options: &ExploreOptions, call: &Call) -> Result<Ending> {
    let begin = begin::begin(options.scene.as_deref(), call)?;
    if let Some(path) = &options.save {
        return save(path, &begin, call);
    }
    check(&begin)?;
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
        saving: Mutex::new(()),
        ticket: std::sync::Mutex::default(),
    });
    let address = server.address();
    let mut out = std::io::stdout();
    // A closed standard output is nobody's.
    let _ = writeln!(out, "{address}").and_then(|()| out.flush());
    if options.no_browser {
        say("the page is at this address until Ctrl-C");
    } else if !browser::has_display() {
        say("no display was found: open this address in a browser; Ctrl-C ends");
    } else if let Err(error) = browser::open(&server.ticket()?) {
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

/// What is wrong with the options of a model is said before there is a page.
fn check(begin: &Value) -> Result<()> {
    let given = begin["options"].as_object().cloned().unwrap_or_default();
    model::model_description(&request::words("orbit", &given)?).map(drop)
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

/// Writes the page with the answers to what it shows first.
fn save(path: &Path, begin: &Value, call: &Call) -> Result<Ending> {
    let wrong = |action, reason: String| Error::File {
        action,
        path: path.to_owned(),
        reason,
    };
    Place::File(path.to_owned()).check()?;
    let given = begin["options"].as_object().cloned().unwrap_or_default();
    let mut progress = call.progress(false);
    let recording = start::recording(&given, |part| progress.come(part))?;
    let seconds = progress.finish().as_secs_f64();
    let content = json!({"recording": recording, "state": null}).to_string();
    let page = save::saved_page(begin, &content).map_err(Error::Input)?;
    write_whole(path, page.as_bytes()).map_err(|error| wrong("write", error.to_string()))?;
    let megabytes = page.len() as f64 / 1e6;
    let (file, time) = (path.display(), time(seconds));
    call.say(format_args!(
        "wrote the page into {file}, {megabytes:.1} MB in {time}; it needs no server"
    ));
    Ok(Ending::Done)
}
