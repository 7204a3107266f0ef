//! Ten thousand requests that no page sends: bytes at random, torn and malformed heads, JSON that is none, paths, numbers beyond all bounds,
//! clients that stop in the midst. The server answers the next good request as the first, has grown by little and has touched no file.

use crate::command;
use command::explore::{COMMANDS, Server};
use command::{contents, folder};
use serde_json::json;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::Duration;

/// Requests.
const MANY: usize = 10_000;
/// Mebibytes that the server may have grown by.
#[cfg(target_os = "linux")]
const GROWTH: f64 = 64.0;

/// The memory of a process, in mebibytes.
#[cfg(target_os = "linux")]
fn memory(process: u32) -> f64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).expect("its status");
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmRSS:"))
        .expect("its memory");
    line.trim()
        .trim_end_matches(" kB")
        .parse::<f64>()
        .expect("a number")
        / 1024.0
}

/// Numbers that are the same each time (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A whole number from 0 to one less than this, or 0.
    fn below(&mut self, end: u64) -> u64 {
        self.next() % end.max(1)
    }
}

fn text(random: &mut Random, longest: u64) -> Vec<u8> {
    (0..random.below(longest))
        .map(|_| random.below(256) as u8)
        .collect()
}

/// One of these.
fn one<'a>(random: &mut Random, all: &[&'a str]) -> &'a str {
    all[random.below(all.len() as u64) as usize]
}

/// What it may ask for beside the commands.
const ALSO: [&str; 2] = ["model", "save"];
const VALUES: [&str; 30] = [
    "null",
    "true",
    "false",
    "0",
    "-1",
    "1e308",
    "-1e308",
    "1e-320",
    "18446744073709551616",
    "1e999",
    "NaN",
    "\"\"",
    "\"/etc/passwd\"",
    "\"../../etc/passwd\"",
    "\"a\\nb\"",
    "\"\\u0000\"",
    "\"--output=pwned\"",
    "\"-\"",
    "[]",
    "[[[[]]]]",
    "{\"a\":{\"b\":{}}}",
    "[1,2,3]",
    "[\"a=1\",\"b=2\"]",
    "\"file:///etc/passwd\"",
    "\"pwned.csv\"",
    "\"pwned.svg\"",
    "\"0:0\"",
    "\"1:2:99999999999999999999\"",
    "\"\u{202e}\"",
    "\"name = \\\"x\\\"\\nstates = [\\\"x\\\"]\\n[rates]\\nx = \\\"((((((((((x\\\"\\n\"",
];

/// The options of a request, of which few make sense.
fn options(random: &mut Random, names: &[String]) -> Vec<u8> {
    let mut pairs = vec![];
    for _ in 0..random.below(6) {
        let name = &names[random.below(names.len() as u64) as usize];
        pairs.push(format!("\"{name}\": {}", one(random, &VALUES)));
    }
    let body = format!("{{{}}}", pairs.join(","));
    let body = match random.below(12) {
        0 => return body.as_bytes()[..random.below(body.len() as u64 + 1) as usize].to_vec(),
        1 => "[".repeat(random.below(200_000) as usize),
        2 => "{\"a\":".repeat(random.below(50_000) as usize),
        3 => format!("{body}{body}"),
        4 => format!(
            "{{\"set\": [{}]}}",
            vec!["\"a=1\""; random.below(20_000) as usize].join(",")
        ),
        _ => body,
    };
    body.into_bytes()
}

/// A request, of which something is wrong more often than not.
fn request(random: &mut Random, server: &Server, names: &[String]) -> Vec<u8> {
    let (port, base) = (server.port, &server.base);
    if random.below(8) == 0 {
        return text(random, 3000);
    }
    let body = options(random, names);
    let method = one(
        random,
        &[
            "POST",
            "POST",
            "POST",
            "POST",
            "GET",
            "PUT",
            "HEAD",
            "CONNECT",
            "post",
            "PRI",
            "\u{1F980}",
        ],
    );
    let own = format!(
        "{base}api/{}",
        one(random, &[&COMMANDS[..], &ALSO].concat())
    );
    let path = match random.below(10) {
        0 => one(
            random,
            &[
                "/",
                "*",
                "/../../etc/passwd",
                "//",
                "http://127.0.0.1/",
                "/%00",
                "?",
                "",
                "/api/orbit",
                "/\u{7f}",
            ],
        )
        .to_owned(),
        1 => format!(
            "{base}{}",
            one(
                random,
                &[
                    "../",
                    "%2e%2e/",
                    "explore.js",
                    "style.css",
                    "page/main.js",
                    "api/fit",
                    "api/\0",
                    "api//orbit"
                ]
            )
        ),
        _ => own,
    };
    let version = one(
        random,
        &[
            "HTTP/1.1", "HTTP/1.1", "HTTP/1.1", "HTTP/1.1", "HTTP/1.0", "HTTP/2.0", "HTTP/9",
            "ICY", "",
        ],
    );
    let host = match random.below(8) {
        0 => "attacker.example".to_owned(),
        1 => String::new(),
        _ => format!("127.0.0.1:{port}"),
    };
    let length = match random.below(12) {
        0 => "-1".to_owned(),
        1 => "18446744073709551616".into(),
        2 => (body.len() + 100).to_string(),
        3 => format!("{}, {}", body.len(), body.len()),
        4 => "0".into(),
        _ => body.len().to_string(),
    };
    let mut head = format!(
        "{method} {path} {version}\r\nHost: {host}\r\nContent-Length: {length}\r\nConnection: close\r\n"
    );
    let fields = [
        "Content-Type: application/json",
        "Content-Type: text/plain",
        "Accept: application/x-ndjson",
        "Priority: u=6",
        "Priority: u=99999, i",
        "Origin: null",
        "Origin: http://attacker.example",
        "Transfer-Encoding: chunked",
        "Transfer-Encoding: gzip",
        "Expect: 100-continue",
        "Upgrade: websocket",
        "Sec-Fetch-Site: cross-site",
        ": empty",
        "No colon",
        " folded",
        "X: \u{1}",
        "Content-Length: 3",
        "Host: second",
    ];
    if random.below(4) > 0 {
        head += "Content-Type: application/json\r\n";
    }
    for _ in 0..random.below(3) {
        head += one(random, &fields);
        head += one(random, &["\r\n", "\r\n", "\r\n", "\n", "\r", ""]);
    }
    let mut all = (head + "\r\n").into_bytes();
    all.extend_from_slice(&body);
    if random.below(10) == 0 {
        all.truncate(random.below(all.len() as u64) as usize);
    }
    all
}

/// Sends it, and reads some, all or nothing of what comes.
fn send(random: &mut Random, server: &Server, bytes: &[u8]) -> Option<TcpStream> {
    let mut stream = server.connect();
    let _ = stream.write_all(bytes);
    let _ = stream.set_read_timeout(Some(Duration::from_millis(100)));
    match random.below(10) {
        // The client is there, and does nothing.
        0 => return Some(stream),
        1 => {}
        2 => {
            let _ = stream.read(&mut [0; 100]);
        }
        _ => {
            let _ = stream.shutdown(Shutdown::Write);
            let _ = stream.read_to_end(&mut Vec::new());
        }
    }
    None
}

#[test]
fn ten_thousand_hostile_requests_change_nothing() {
    let place = folder("explore-hostile");
    std::fs::write(place.join("kept.toml"), "secret").expect("written");
    let server = Server::start_in(&place, &[]);
    let good = json!({"driving": 10, "stiffness": 0.14, "symmetry": "asymmetric"});
    let first = server.object("orbit", &good);
    assert_eq!(first.status, 200);
    let mut names: Vec<String> = COMMANDS
        .iter()
        .flat_map(|command| twinslip_cli::options(command))
        .map(|option| option.name)
        .collect();
    names.extend(["recording".into(), "__proto__".into(), String::new()]);
    let mut random = Random(2026);
    let mut idle = std::collections::VecDeque::new();
    #[cfg(target_os = "linux")]
    let before = memory(server.child.id());
    for _ in 0..MANY {
        let bytes = request(&mut random, &server, &names);
        idle.extend(send(&mut random, &server, &bytes));
        // Idle clients leave after a while, so that there is a place for others.
        if idle.len() > 20 {
            idle.pop_front();
        }
    }
    let again = server.object("orbit", &good);
    assert_eq!((again.status, again.body), (200, first.body));
    #[cfg(target_os = "linux")]
    {
        let growth = memory(server.child.id()) - before;
        assert!(growth < GROWTH, "{growth:.1} MiB");
        println!("grown by {growth:.1} MiB");
    }
    assert_eq!(contents(&place), ["kept.toml"]);
}
