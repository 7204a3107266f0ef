//! What a request asks for, however it came: its options are read, its words checked, and its command put into the queue.

use super::model;
use super::outbox::Outbox;
use super::queue::{MOST_WAITING, Queue};
use super::request::words;
use crate::call::Outlet;
use crate::failure::Failure;
use crate::{Ending, run_into};
use serde_json::{Map, Value};
use std::sync::Arc;
use twinslip::error::Result;

/// Bytes of the options of a request.
pub const LONGEST: usize = 1 << 20;

/// What a request asks for, as the words of a command line.
pub enum Work {
    /// A command.
    Command(Vec<String>),
    /// The description of the model that its options make.
    Model(Vec<String>),
}

impl Work {
    /// The work that a command, or `model`, with these options is.
    ///
    /// # Errors
    /// Those of [`words`].
    pub fn new(command: &str, options: &Map<String, Value>) -> Result<Self> {
        match command {
            // Its options are those of the model, which an orbit has too.
            "model" => words("orbit", options).map(Work::Model),
            _ => words(command, options).map(Work::Command),
        }
    }
}

/// The options of a request, a JSON object; none are an empty one.
///
/// # Errors
/// A sentence on what is wrong with the text.
pub fn options(text: &[u8]) -> std::result::Result<Map<String, Value>, String> {
    let text = if text.is_empty() { b"{}" } else { text };
    // It goes no deeper than 128 levels.
    serde_json::from_slice(text).map_err(|error| format!("the options are no JSON object: {error}"))
}

/// Runs it as soon as there is a place; false if too many wait.
pub fn begin(queue: &Arc<Queue>, outbox: &Arc<Outbox>, work: Work) -> bool {
    queue.add(Arc::clone(outbox), move |outbox| {
        let ended = match &work {
            Work::Command(words) => run_into(words, Arc::<Outbox>::clone(outbox)),
            Work::Model(words) => model::model_description(words).map(|model| {
                outbox.object(model.to_string().as_bytes());
                Ending::Done
            }),
        };
        outbox.end(ended.map_err(|error| Failure::of(&error)));
    })
}

/// The sentence on a request that came when too many were waiting.
pub fn too_many_waiting() -> String {
    format!("{MOST_WAITING} commands wait already; ask again when some are done")
}
