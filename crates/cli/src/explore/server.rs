//! The server of the page: who may ask, what for, and the answers.

use super::answer::{self, Answer};
use super::outbox::{Outbox, Whole, object, too_many_rows};
use super::patient::Patient;
use super::queue::Queue;
use super::request::COMMANDS;
use super::save::{BEGIN, begin_element, in_script, saved_page};
use super::work::{self, Work, begin, too_many_waiting};
use super::{assets, bundle, token};
use crate::failure::Failure;
use http_body_util::{BodyExt, LengthLimitError, Limited};
use hyper::body::{Body, Bytes, Incoming};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{HeaderMap, Method, Request, StatusCode, header};
use hyper_util::rt::TokioTimer;
use serde_json::{Map, Value, json};
use std::convert::Infallible;
use std::future::poll_fn;
use std::sync::{Arc, PoisonError};
use std::task::Poll;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::{Mutex, Semaphore};
use tokio::time::timeout;
use twinslip::error::Result;

/// Connections at once; more wait to be accepted.
const MOST_CONNECTIONS: usize = 64;
/// Bytes of a page that is saved.
const LONGEST_PAGE: usize = 64 << 20;
/// Bytes of the head of a request.
const LONGEST_HEAD: usize = 16 << 10;
/// Fields in the head of a request.
const MOST_HEADS: usize = 64;
/// A head or a body that takes longer to come is not waited for.
const PATIENCE: Duration = Duration::from_secs(20);

/// What answers requests.
pub struct Server {
    /// The secret first part of all paths.
    pub token: String,
    /// The port that it listens on.
    pub port: u16,
    /// What it was started with, for the page.
    pub begin: Value,
    /// Commands that run and wait.
    pub queue: Arc<Queue>,
    /// Held while a page is saved.
    pub saving: Mutex<()>,
    /// The secret of an address that leads to the page once.
    pub ticket: std::sync::Mutex<Option<String>>,
}

/// Answers requests for ever.
pub async fn serve(listener: TcpListener, server: Arc<Server>) -> Infallible {
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    loop {
        let place = Arc::clone(&places).acquire_owned().await;
        let Ok((stream, _)) = listener.accept().await else {
            // Too many files are open, say: others may be closed soon.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        // Lines are short, and wanted at once.
        let _ = stream.set_nodelay(true);
        let server = Arc::clone(&server);
        tokio::spawn(async move {
            let service = service_fn(|request| {
                let server = Arc::clone(&server);
                async move { Ok::<_, Infallible>(server.answer(request).await) }
            });
            let connection = http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(PATIENCE)
                .max_buf_size(LONGEST_HEAD)
                .max_headers(MOST_HEADS)
                .serve_connection(Patient::new(stream), service);
            // That a client goes away is its own affair.
            let _ = connection.await;
            drop(place);
        });
    }
}

fn refused(status: StatusCode, message: impl Into<String>) -> Answer {
    let failure = Failure {
        kind: "input",
        field: None,
        words: message.into(),
    };
    answer::json(status, &json!({"error": object(&failure)}))
}

impl Server {
    /// The address of the page.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// An address that leads to the page once. A browser is begun with it: the words of a command line are no secret on a machine that
    /// others use too.
    pub fn ticket(&self) -> Result<String> {
        let ticket = token()?;
        let address = format!("http://127.0.0.1:{}/{ticket}", self.port);
        *self.ticket.lock().unwrap_or_else(PoisonError::into_inner) = Some(ticket);
        Ok(address)
    }

    /// Whether a request comes with the ticket, which is then no longer valid.
    fn takes_ticket(&self, path: &str) -> bool {
        let mut ticket = self.ticket.lock().unwrap_or_else(PoisonError::into_inner);
        let path = path.strip_prefix('/').unwrap_or_default();
        let is = ticket
            .as_ref()
            .is_some_and(|own| same(path.as_bytes(), own.as_bytes()));
        if is {
            *ticket = None;
        }
        is
    }

    async fn answer(&self, request: Request<Incoming>) -> Answer {
        let path = request.uri().path();
        let allowed = self.local(&request).and_then(|()| {
            if request.method() == Method::GET && self.takes_ticket(path) {
                return Ok(true);
            }
            self.known(path).map(|()| false)
        });
        match allowed {
            Err(why) => {
                let mut answer = refused(StatusCode::FORBIDDEN, why);
                let close = header::HeaderValue::from_static("close");
                answer.headers_mut().insert(header::CONNECTION, close);
                return answer;
            }
            Ok(true) => return self.page_is_at(StatusCode::SEE_OTHER),
            Ok(false) => {}
        }
        let inner = path
            .get(1 + self.token.len()..)
            .unwrap_or_default()
            .to_owned();
        if request.uri().query().is_some() {
            return refused(StatusCode::NOT_FOUND, "there is no such page");
        }
        let got = request.method() == Method::GET;
        match (inner.as_str(), inner.strip_prefix("/api/")) {
            ("" | "/" | "/explore.js" | "/style.css", _) if !got => not_allowed("GET"),
            ("", _) => self.page_is_at(StatusCode::PERMANENT_REDIRECT),
            ("/", _) => answer::whole(StatusCode::OK, "text/html; charset=utf-8", self.page()),
            ("/style.css", _) => {
                let style = assets::style().into_owned();
                answer::whole(StatusCode::OK, "text/css; charset=utf-8", style)
            }
            ("/explore.js", _) => match bundle::bundle(&assets::modules(), assets::MAIN) {
                Ok(script) => {
                    answer::whole(StatusCode::OK, "text/javascript; charset=utf-8", script)
                }
                Err(why) => refused(StatusCode::INTERNAL_SERVER_ERROR, why),
            },
            (_, Some(command)) if command == "model" || COMMANDS.contains(&command) => {
                match request.method() == Method::POST {
                    true => self.asked(command, request).await,
                    false => not_allowed("POST"),
                }
            }
            (_, Some("save")) => match request.method() == Method::POST {
                true => self.saved(request).await,
                false => not_allowed("POST"),
            },
            _ => refused(StatusCode::NOT_FOUND, "there is no such page"),
        }
    }

    /// Leads to the page.
    fn page_is_at(&self, status: StatusCode) -> Answer {
        let mut answer = answer::whole(status, "text/plain", "");
        let address = header::HeaderValue::try_from(format!("/{}/", self.token));
        answer
            .headers_mut()
            .insert(header::LOCATION, address.expect("a token is plain"));
        answer
    }

    /// That a request comes from this machine, and from the page of this server or from nowhere.
    fn local(&self, request: &Request<Incoming>) -> std::result::Result<(), &'static str> {
        let heads = request.headers();
        let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        let is_host = |host: &str| hosts.iter().any(|own| own == host);
        // A name that leads here, of another site, is not ours.
        if !only(heads, header::HOST).is_some_and(is_host) || request.uri().authority().is_some() {
            return Err("this server answers at 127.0.0.1 and localhost alone");
        }
        let origin = heads.get_all(header::ORIGIN).iter();
        let mut origins = origin.map(|origin| origin.to_str().ok()?.strip_prefix("http://"));
        if !origins.all(|origin| origin.is_some_and(is_host)) {
            return Err("other pages have no access");
        }
        let site = heads.get_all("sec-fetch-site").iter();
        let mut sites = site.map(|site| site.as_bytes());
        if !sites.all(|site| [&b"same-origin"[..], b"none"].contains(&site)) {
            return Err("other pages have no access");
        }
        Ok(())
    }

    /// That it knows the secret.
    fn known(&self, path: &str) -> std::result::Result<(), &'static str> {
        let path = path.as_bytes();
        let token = path.get(1..=self.token.len()).unwrap_or_default();
        let ends = path
            .get(1 + self.token.len())
            .is_none_or(|&next| next == b'/');
        match same(token, self.token.as_bytes()) && ends {
            true => Ok(()),
            false => Err("the address lacks the secret that twinslip explore has printed"),
        }
    }

    fn page(&self) -> String {
        let begin = in_script(&self.begin.to_string());
        assets::index().replacen(BEGIN, &begin_element(&begin), 1)
    }

    /// A command, or the description of a model.
    async fn asked(&self, command: &str, request: Request<Incoming>) -> Answer {
        let heads = request.headers();
        let streams = is(heads, header::ACCEPT, "application/x-ndjson");
        let behind =
            only(heads, header::HeaderName::from_static("priority")).is_some_and(is_background);
        let options = match options(request).await {
            Ok(options) => options,
            Err(refused) => return refused,
        };
        let work = match Work::new(command, &options) {
            Ok(work) => work,
            Err(error) => {
                let failure = Failure::of(&error);
                return answer::json(StatusCode::BAD_REQUEST, &json!({"error": object(&failure)}));
            }
        };
        let outbox = Arc::new(Outbox::new(
            streams,
            behind.then(|| Arc::clone(&self.queue)),
        ));
        let added = begin(&self.queue, &outbox, work);
        if !added {
            return refused(StatusCode::SERVICE_UNAVAILABLE, too_many_waiting());
        }
        let lines = answer::lines(Arc::clone(&outbox));
        if streams {
            return lines;
        }
        let whole = poll_fn(|context| {
            outbox
                .whole(context.waker())
                .map_or(Poll::Pending, Poll::Ready)
        });
        let whole = whole.await;
        drop(lines);
        whole_answer(whole)
    }
}

impl Server {
    /// The page with what it shows, as a file.
    async fn saved(&self, request: Request<Incoming>) -> Answer {
        // Such a body is large: one at a time.
        let Ok(_place) = self.saving.try_lock() else {
            return refused(
                StatusCode::SERVICE_UNAVAILABLE,
                "another page is being saved; try again",
            );
        };
        let content = match body(request, LONGEST_PAGE, 6 * PATIENCE).await {
            Ok(content) => content,
            Err(refused) => return refused,
        };
        let content = std::str::from_utf8(&content).unwrap_or_default();
        match saved_page(&self.begin, content) {
            Ok(page) => {
                let mut answer = answer::whole(StatusCode::OK, "text/html; charset=utf-8", page);
                let name =
                    header::HeaderValue::from_static("attachment; filename=\"twinslip.html\"");
                answer
                    .headers_mut()
                    .insert(header::CONTENT_DISPOSITION, name);
                answer
            }
            Err(why) => refused(StatusCode::BAD_REQUEST, why),
        }
    }
}

fn not_allowed(method: &'static str) -> Answer {
    let mut answer = refused(
        StatusCode::METHOD_NOT_ALLOWED,
        format!("the method is {method} here"),
    );
    let value = header::HeaderValue::from_static(method);
    answer.headers_mut().insert(header::ALLOW, value);
    answer
}

/// The value of a field that stands there once.
fn only(heads: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    let mut all = heads.get_all(name).iter();
    let first = all.next()?.to_str().ok();
    first.filter(|_| all.next().is_none())
}

/// Whether `Priority` (RFC 9218) has the urgency of what nobody waits for.
fn is_background(priority: &str) -> bool {
    let urgency = priority
        .split(',')
        .find_map(|part| part.trim().strip_prefix("u="));
    urgency
        .and_then(|number| number.parse::<u8>().ok())
        .is_some_and(|number| number >= 6)
}

/// Whether these are the same bytes, in a time that tells nothing of how many are.
fn same(given: &[u8], own: &[u8]) -> bool {
    let differences = given.iter().zip(own).fold(0, |all, (a, b)| all | (a ^ b));
    given.len() == own.len() && std::hint::black_box(differences) == 0
}

/// Whether a field names this type.
fn is(heads: &HeaderMap, name: header::HeaderName, wanted: &str) -> bool {
    let value = only(heads, name).unwrap_or_default();
    let kind = value.split(';').next().unwrap_or_default();
    kind.trim().eq_ignore_ascii_case(wanted)
}

/// The body of a request, which is JSON of at most so many bytes.
async fn body(
    request: Request<Incoming>,
    longest: usize,
    patience: Duration,
) -> std::result::Result<Bytes, Answer> {
    if !is(request.headers(), header::CONTENT_TYPE, "application/json") {
        return Err(refused(
            StatusCode::UNSUPPORTED_MEDIA_TYPE,
            "the body must be application/json",
        ));
    }
    let too_long = || {
        let why = format!("the body is longer than {longest} bytes");
        refused(StatusCode::PAYLOAD_TOO_LARGE, why)
    };
    if request.body().size_hint().lower() > longest as u64 {
        return Err(too_long());
    }
    let body = Limited::new(request.into_body(), longest).collect();
    match timeout(patience, body).await {
        Ok(Ok(body)) => Ok(body.to_bytes()),
        Ok(Err(error)) if error.is::<LengthLimitError>() => Err(too_long()),
        Ok(Err(_)) => Err(refused(
            StatusCode::BAD_REQUEST,
            "the body did not come whole",
        )),
        Err(_) => Err(refused(
            StatusCode::REQUEST_TIMEOUT,
            "the body did not come in time",
        )),
    }
}

/// The options in the body of a request.
async fn options(request: Request<Incoming>) -> std::result::Result<Map<String, Value>, Answer> {
    let body = body(request, work::LONGEST, PATIENCE).await?;
    work::options(&body).map_err(|why| refused(StatusCode::BAD_REQUEST, why))
}

/// The answer to who asked for an object alone.
fn whole_answer(whole: Whole) -> Answer {
    let failure = match whole.ended {
        Ok(_) if whole.exceeded => Failure {
            kind: "input",
            field: None,
            words: too_many_rows(),
        },
        Ok(_) => return answer::whole(StatusCode::OK, "application/json", whole.object),
        Err(failure) => failure,
    };
    let status = match failure.kind {
        "input" | "file" => StatusCode::BAD_REQUEST,
        "numerical" => StatusCode::UNPROCESSABLE_ENTITY,
        _ => StatusCode::INTERNAL_SERVER_ERROR,
    };
    answer::json(status, &json!({"error": object(&failure)}))
}
