//! The server of `twinslip explore`, and a client of it.

use super::program;
use crate::common::ROOT;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Nobody waits longer for an answer.
const PATIENCE: Duration = Duration::from_secs(120);

/// What a page may ask for.
pub const COMMANDS: [&str; 8] = [
    "law",
    "integrate",
    "equilibria",
    "orbit",
    "section",
    "branch",
    "locus",
    "sweep",
];

/// A server that runs until it is dropped.
pub struct Server {
    pub child: Child,
    pub port: u16,
    /// The first part of all paths, with slashes on both sides.
    pub base: String,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// An answer over HTTP.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    /// Names in small letters.
    pub heads: Vec<(String, String)>,
    pub body: String,
}

impl Answer {
    pub fn head(&self, name: &str) -> &str {
        let head = self.heads.iter().find(|(known, _)| known == name);
        head.map_or("", |(_, value)| value)
    }

    pub fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap_or_else(|error| panic!("{error}: {}", self.body))
    }

    /// The sentence of an error.
    pub fn message(&self) -> String {
        let message = &self.json()["error"]["message"];
        message.as_str().unwrap_or_default().to_owned()
    }

    /// The lines of a stream.
    pub fn lines(&self) -> Vec<Value> {
        let line = |line: &str| {
            serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"))
        };
        self.body.lines().map(line).collect()
    }
}

impl Server {
    /// A server that was started with these arguments.
    pub fn start(arguments: &[&str]) -> Self {
        Self::start_in(Path::new(ROOT), arguments)
    }

    /// The same in another folder.
    pub fn start_in(folder: &Path, arguments: &[&str]) -> Self {
        Self::of(
            program()
                .current_dir(folder)
                .args(["explore", "--no-browser"])
                .args(arguments),
        )
    }

    /// The server that this command starts.
    pub fn of(command: &mut Command) -> Self {
        let child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut child = child.expect("it starts");
        let mut line = String::new();
        let out = child.stdout.take().expect("a pipe");
        BufReader::new(out)
            .read_line(&mut line)
            .expect("its address");
        let rest = line
            .trim()
            .strip_prefix("http://127.0.0.1:")
            .expect("an address");
        let (port, path) = rest.split_once('/').expect("a path");
        Server {
            child,
            port: port.parse().expect("a port"),
            base: format!("/{path}"),
        }
    }

    pub fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        stream.set_write_timeout(Some(PATIENCE)).expect("a timeout");
        stream
    }

    /// The head of a request with these fields beside the host.
    pub fn head(&self, first: &str, fields: &[(&str, &str)]) -> String {
        let mut head = format!("{first} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n", self.port);
        for (name, value) in fields {
            head += &format!("{name}: {value}\r\n");
        }
        head + "\r\n"
    }

    /// The answer to a page.
    pub fn get(&self, path: &str) -> Answer {
        let head = self.head(
            &format!("GET {}{path}", self.base),
            &[("Connection", "close")],
        );
        self.exchange(head.as_bytes()).expect("an answer")
    }

    /// The answer to these bytes, after which the connection is to be closed; none where there is none.
    pub fn exchange(&self, bytes: &[u8]) -> Option<Answer> {
        let mut stream = self.connect();
        // A server that refuses early need not read on.
        let _ = stream.write_all(bytes);
        let mut all = Vec::new();
        let _ = stream.read_to_end(&mut all);
        answer(&all)
    }

    /// A request for a command, on its way; nothing of the answer is read.
    pub fn ask(&self, command: &str, options: &Value, fields: &[(&str, &str)]) -> TcpStream {
        let body = options.to_string();
        let length = body.len().to_string();
        let mut all = vec![
            ("Content-Type", "application/json"),
            ("Content-Length", &length),
            ("Connection", "close"),
        ];
        all.extend(fields);
        let head = self.head(&format!("POST {}api/{command}", self.base), &all);
        let mut stream = self.connect();
        stream
            .write_all((head + &body).as_bytes())
            .expect("it reads");
        stream
    }

    /// The object that a command answers with.
    pub fn object(&self, command: &str, options: &Value) -> Answer {
        whole(self.ask(command, options, &[]))
    }

    /// The stream that a command answers with.
    pub fn stream(&self, command: &str, options: &Value) -> Answer {
        whole(self.ask(command, options, &[STREAM]))
    }
}

/// Asks for lines.
pub const STREAM: (&str, &str) = ("Accept", "application/x-ndjson");

/// All of an answer.
pub fn whole(mut stream: TcpStream) -> Answer {
    let mut all = Vec::new();
    stream.read_to_end(&mut all).expect("an answer");
    answer(&all).expect("an answer")
}

/// The first bytes of a body, after the head of the answer.
pub fn begun(stream: &mut TcpStream) -> Vec<u8> {
    let mut all = Vec::new();
    let mut byte = [0];
    while !all.ends_with(b"\r\n\r\n") {
        stream.read_exact(&mut byte).expect("a head");
        all.push(byte[0]);
    }
    stream.read_exact(&mut byte).expect("a body");
    byte.to_vec()
}

/// Head and body.
fn answer(bytes: &[u8]) -> Option<Answer> {
    let end = bytes.windows(4).position(|four| four == b"\r\n\r\n")?;
    let head = String::from_utf8_lossy(&bytes[..end]);
    let mut lines = head.lines();
    let status = lines.next()?.split(' ').nth(1)?.parse().ok()?;
    let field = |line: &str| {
        let (name, value) = line.split_once(':')?;
        Some((name.to_lowercase(), value.trim().to_owned()))
    };
    let heads: Vec<(String, String)> = lines.filter_map(field).collect();
    let chunked = heads
        .iter()
        .any(|(name, value)| name == "transfer-encoding" && value == "chunked");
    let body = &bytes[end + 4..];
    let body = if chunked { joined(body) } else { body.to_vec() };
    Some(Answer {
        status,
        heads,
        body: String::from_utf8_lossy(&body).into_owned(),
    })
}

/// The bytes of all chunks.
fn joined(mut chunks: &[u8]) -> Vec<u8> {
    let mut all = Vec::new();
    while let Some(end) = chunks.windows(2).position(|two| two == b"\r\n") {
        let length =
            usize::from_str_radix(&String::from_utf8_lossy(&chunks[..end]), 16).unwrap_or(0);
        let rest = &chunks[end + 2..];
        if length == 0 || rest.len() < length {
            break;
        }
        all.extend_from_slice(&rest[..length]);
        chunks = rest.get(length + 2..).unwrap_or_default();
    }
    all
}
