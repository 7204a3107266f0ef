//! Answers over HTTP: their heads, and bodies that are written as a command yields them.

use super::outbox::Outbox;
use hyper::body::{Body, Bytes, Frame, SizeHint};
use hyper::header::{self, HeaderName, HeaderValue};
use hyper::{Response, StatusCode};
use serde_json::Value;
use std::convert::Infallible;
use std::future::Future;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::time::{Instant, Sleep, sleep_until};

/// The least time between two pieces of an answer.
const BETWEEN: Duration = Duration::from_millis(20);

/// What a page may do: run the script and use the styles that came with it, ask this server, and nothing else.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data: blob:; \
    base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Heads of every answer.
const HEADS: [(HeaderName, &str); 6] = [
    (header::CONTENT_SECURITY_POLICY, POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (
        HeaderName::from_static("cross-origin-resource-policy"),
        "same-origin",
    ),
    (
        HeaderName::from_static("cross-origin-opener-policy"),
        "same-origin",
    ),
    (header::CACHE_CONTROL, "no-store"),
];

/// An answer with a body of ours.
pub type Answer = Response<AnswerBody>;

/// The body of an answer.
pub enum AnswerBody {
    /// Known as a whole.
    Whole(Option<Bytes>),
    /// Lines of a command that may still run.
    Lines(Lines),
}

/// Lines of a command on their way; the command is stopped when they are dropped.
pub struct Lines {
    outbox: Arc<Outbox>,
    /// When the next piece may go.
    next: Pin<Box<Sleep>>,
    ended: bool,
}

impl Drop for Lines {
    fn drop(&mut self) {
        self.outbox.leave();
    }
}

impl Body for AnswerBody {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        let lines = match self.get_mut() {
            AnswerBody::Whole(bytes) => {
                return Poll::Ready(bytes.take().map(|bytes| Ok(Frame::data(bytes))));
            }
            AnswerBody::Lines(lines) => lines,
        };
        if lines.ended {
            return Poll::Ready(None);
        }
        let (some, ended) = lines.outbox.is_ready(context.waker());
        if !some && !ended {
            return Poll::Pending;
        }
        // The last piece does not wait.
        if !ended && lines.next.as_mut().poll(context).is_pending() {
            return Poll::Pending;
        }
        lines.next.as_mut().reset(Instant::now() + BETWEEN);
        let (text, ended) = lines.outbox.take();
        lines.ended = ended;
        match text.is_empty() {
            true => Poll::Ready(None),
            false => Poll::Ready(Some(Ok(Frame::data(text.into())))),
        }
    }

    fn is_end_stream(&self) -> bool {
        match self {
            AnswerBody::Whole(bytes) => bytes.is_none(),
            AnswerBody::Lines(lines) => lines.ended,
        }
    }

    fn size_hint(&self) -> SizeHint {
        match self {
            AnswerBody::Whole(bytes) => {
                SizeHint::with_exact(bytes.as_ref().map_or(0, Bytes::len) as u64)
            }
            AnswerBody::Lines(_) => SizeHint::default(),
        }
    }
}

/// An answer of this type.
pub fn whole(status: StatusCode, kind: &'static str, body: impl Into<Bytes>) -> Answer {
    let bytes: Bytes = body.into();
    with_heads(
        status,
        kind,
        AnswerBody::Whole(Some(bytes).filter(|bytes| !bytes.is_empty())),
    )
}

/// An answer in JSON.
pub fn json(status: StatusCode, value: &Value) -> Answer {
    whole(status, "application/json", value.to_string() + "\n")
}

/// Lines of JSON as a command yields them.
pub fn lines(outbox: Arc<Outbox>) -> Answer {
    let body = AnswerBody::Lines(Lines {
        outbox,
        next: Box::pin(sleep_until(Instant::now())),
        ended: false,
    });
    with_heads(StatusCode::OK, "application/x-ndjson", body)
}

fn with_heads(status: StatusCode, kind: &'static str, body: AnswerBody) -> Answer {
    let mut answer = Response::new(body);
    *answer.status_mut() = status;
    let heads = answer.headers_mut();
    heads.insert(header::CONTENT_TYPE, HeaderValue::from_static(kind));
    for (name, value) in HEADS {
        heads.insert(name, HeaderValue::from_static(value));
    }
    answer
}
