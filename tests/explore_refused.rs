//! Who may ask the server of `twinslip explore`, and what for: the page that it has sent, and nobody else.

use crate::command;
use command::explore::{Answer, COMMANDS, Server};
use command::folder;
use serde_json::{Value, json};

/// The answer to a request with another first line and other fields beside the host.
fn asked(server: &Server, first: &str, fields: &[(&str, &str)], body: &str) -> Answer {
    let head = server.head(first, fields);
    server
        .exchange((head + body).as_bytes())
        .expect("an answer")
}

fn post(server: &Server, path: &str, fields: &[(&str, &str)], body: &str) -> Answer {
    let length = body.len().to_string();
    let mut all = vec![("Content-Length", length.as_str()), ("Connection", "close")];
    all.extend(fields);
    let first = format!("POST {}{path}", server.base);
    asked(server, &first, &all, body)
}

const JSON: (&str, &str) = ("Content-Type", "application/json");
const CLOSE: (&str, &str) = ("Connection", "close");

#[test]
fn the_page_and_its_parts_are_there_with_their_heads() {
    let server = Server::start(&[]);
    let kinds = [
        ("", "text/html; charset=utf-8"),
        ("explore.js", "text/javascript; charset=utf-8"),
        ("style.css", "text/css; charset=utf-8"),
    ];
    for (path, kind) in kinds {
        let answer = server.get(path);
        assert_eq!((answer.status, answer.head("content-type")), (200, kind));
        assert!(!answer.body.is_empty());
        let policy = answer.head("content-security-policy");
        for part in [
            "default-src 'none'",
            "script-src 'self'",
            "connect-src 'self'",
            "frame-ancestors 'none'",
            "base-uri 'none'",
            "form-action 'none'",
        ] {
            assert!(policy.contains(part), "{policy}");
        }
        assert!(!policy.contains("unsafe"), "{policy}");
        let heads = [
            ("x-content-type-options", "nosniff"),
            ("referrer-policy", "no-referrer"),
            ("cross-origin-resource-policy", "same-origin"),
            ("cross-origin-opener-policy", "same-origin"),
            ("cache-control", "no-store"),
        ];
        for (name, value) in heads {
            assert_eq!(answer.head(name), value, "{name}");
        }
        assert_eq!(answer.head("access-control-allow-origin"), "");
    }
    // Without the last slash the page's parts would be looked for elsewhere.
    let bare = server.base.trim_end_matches('/').to_owned();
    let answer = asked(&server, &format!("GET {bare}"), &[CLOSE], "");
    assert_eq!(
        (answer.status, answer.head("location")),
        (308, server.base.as_str())
    );
}

#[test]
fn nobody_asks_without_the_secret() {
    let server = Server::start(&[]);
    let secret = server.base.trim_matches('/').to_owned();
    assert!(secret.len() >= 32, "128 bits");
    let mut other = secret.clone().into_bytes();
    other[0] = if other[0] == b'0' { b'1' } else { b'0' };
    let other = String::from_utf8(other).expect("ASCII");
    let shorter = &secret[..secret.len() - 1];
    let paths = [
        "/".to_owned(),
        "/api/model".into(),
        format!("/{other}/"),
        format!("/{shorter}/"),
        format!("/{secret}0/"),
        format!("/{secret}x"),
        format!("//{secret}/"),
        format!("/./{secret}/"),
        format!("/%2e/{secret}/"),
        format!("/{}/", secret.to_uppercase() + "A"),
        format!("/{}/", "0".repeat(10_000)),
        "*".into(),
    ];
    for path in paths {
        let answer = asked(&server, &format!("GET {path}"), &[CLOSE], "");
        assert_eq!(answer.status, 403, "{path}");
        assert!(!answer.body.contains(&secret));
    }
    // Each server has its own.
    assert_ne!(Server::start(&[]).base, server.base);
}

#[test]
fn other_names_and_other_pages_are_refused() {
    let server = Server::start(&[]);
    let (port, base) = (server.port, &server.base);
    let own = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    let with_host = |hosts: &[&str]| {
        let hosts: String = hosts
            .iter()
            .map(|host| format!("Host: {host}\r\n"))
            .collect();
        let request = format!("GET {base} HTTP/1.1\r\n{hosts}Connection: close\r\n\r\n");
        server
            .exchange(request.as_bytes())
            .expect("an answer")
            .status
    };
    for host in &own {
        assert_eq!(with_host(&[host]), 200);
    }
    let others = [
        "127.0.0.1".to_owned(),
        "localhost".into(),
        format!("127.0.0.1:{}", port ^ 1),
        format!("attacker.example:{port}"),
        format!("127.0.0.1:{port}.attacker.example"),
        format!("127.0.0.1.attacker.example:{port}"),
        format!("[::1]:{port}"),
        format!("0.0.0.0:{port}"),
        format!("127.1:{port}"),
        format!("user@127.0.0.1:{port}"),
        String::new(),
    ];
    for host in &others {
        assert_eq!(with_host(&[host]), 403, "{host}");
    }
    assert_eq!(with_host(&[]), 403);
    assert_eq!(with_host(&[&own[0], &own[0]]), 403);
    let absolute = format!("GET http://127.0.0.1:{port}{base}");
    assert_eq!(asked(&server, &absolute, &[CLOSE], "").status, 403);

    let model = |fields: &[(&str, &str)]| {
        let fields: Vec<_> = fields.iter().copied().chain([JSON]).collect();
        post(&server, "api/model", &fields, "{}").status
    };
    for host in &own {
        assert_eq!(model(&[("Origin", &format!("http://{host}"))]), 200);
    }
    for origin in [
        "null",
        "http://attacker.example",
        "https://127.0.0.1",
        "file://",
        "",
        "http://127.0.0.1",
    ] {
        assert_eq!(model(&[("Origin", origin)]), 403, "{origin}");
    }
    let https = format!("https://{}", own[0]);
    assert_eq!(model(&[("Origin", &https)]), 403);
    let own_origin = format!("http://{}", own[0]);
    assert_eq!(
        model(&[
            ("Origin", &own_origin),
            ("Origin", "http://attacker.example")
        ]),
        403
    );
    for (site, status) in [
        ("same-origin", 200),
        ("none", 200),
        ("cross-site", 403),
        ("same-site", 403),
        ("", 403),
    ] {
        assert_eq!(model(&[("Sec-Fetch-Site", site)]), status, "{site}");
    }
}

#[test]
fn methods_paths_types_and_sizes_are_held_to() {
    let server = Server::start(&[]);
    let base = &server.base;
    for method in [
        "POST", "PUT", "HEAD", "DELETE", "OPTIONS", "TRACE", "PATCH", "BREW",
    ] {
        let answer = asked(
            &server,
            &format!("{method} {base}"),
            &[CLOSE, ("Content-Length", "0")],
            "",
        );
        assert_eq!(
            (answer.status, answer.head("allow")),
            (405, "GET"),
            "{method}"
        );
    }
    for method in ["GET", "PUT", "OPTIONS"] {
        for path in ["api/orbit", "api/model", "api/save"] {
            let answer = asked(&server, &format!("{method} {base}{path}"), &[CLOSE], "");
            assert_eq!(
                (answer.status, answer.head("allow")),
                (405, "POST"),
                "{method} {path}"
            );
        }
    }
    for path in [
        "api/fit",
        "api/run",
        "api/reproduce",
        "api/",
        "api",
        "api/orbit/",
        "api/Orbit",
        "api/%6frbit",
        "api/../",
        "etc/passwd",
    ] {
        assert_eq!(post(&server, path, &[JSON], "{}").status, 404, "{path}");
    }
    for path in [
        "index.html",
        "page/main.js",
        "../Cargo.toml",
        "..%2f..%2fCargo.toml",
        "explore.js?x",
        "?x",
        "/",
    ] {
        assert_eq!(server.get(path).status, 404, "{path}");
    }
    for kind in [
        "text/plain",
        "application/x-www-form-urlencoded",
        "multipart/form-data",
        "",
        "application/jsonx",
    ] {
        assert_eq!(
            post(&server, "api/model", &[("Content-Type", kind)], "{}").status,
            415,
            "{kind}"
        );
    }
    assert_eq!(post(&server, "api/model", &[], "{}").status, 415);
    let kind = ("Content-Type", "application/json; charset=utf-8");
    assert_eq!(post(&server, "api/model", &[kind], "{}").status, 200);

    let long = format!("{{\"law\": \"{}\"}}", " ".repeat(1 << 20));
    assert_eq!(post(&server, "api/model", &[JSON], &long).status, 413);
    let told = [JSON, CLOSE, ("Content-Length", "99999999999")];
    assert_eq!(
        asked(&server, &format!("POST {base}api/model"), &told, "{").status,
        413
    );
    let deep = format!(
        "{{\"set\": {}{}}}",
        "[".repeat(100_000),
        "]".repeat(100_000)
    );
    assert_eq!(post(&server, "api/model", &[JSON], &deep).status, 400);
    let long = "x".repeat(100_000);
    let many: Vec<_> = (0..200).map(|_| ("X", "y")).collect();
    for fields in [&[("X-Long", long.as_str())][..], &many] {
        let head = server.head(&format!("GET {base}"), fields);
        let answer = server.exchange(head.as_bytes());
        assert!(answer.is_none_or(|answer| [400, 431].contains(&answer.status)));
    }
    assert_eq!(server.get("").status, 200);
}

#[test]
fn options_that_have_no_place_in_a_request_are_refused_in_a_sentence() {
    let server = Server::start(&[]);
    let place = folder("explore-refused");
    let file = place.join("system.toml");
    std::fs::write(
        &file,
        "name = \"x\"\nstates = [\"x\"]\n[rates]\nx = \"-x\"\n[start]\nx = 1.0\n",
    )
    .expect("written");
    let path = file.to_str().expect("UTF-8");
    let cases: Vec<(&str, Value, &str)> = vec![
        (
            "integrate",
            json!({"output": "x.csv"}),
            "`output` can't be given here",
        ),
        (
            "integrate",
            json!({"checkpoint": "x"}),
            "`checkpoint` can't be given here",
        ),
        (
            "integrate",
            json!({"plot": path}),
            "`plot` must be true or false",
        ),
        (
            "integrate",
            json!({"events": path}),
            "`events` must be true or false",
        ),
        (
            "integrate",
            json!({"plot_events": true}),
            "`plot_events` can't be given here",
        ),
        (
            "integrate",
            json!({"system": path}),
            "none of those that are built in",
        ),
        (
            "integrate",
            json!({"system": "system.toml"}),
            "none of those that are built in",
        ),
        (
            "integrate",
            json!({"system": ["lorenz"]}),
            "`system` must be a text",
        ),
        (
            "integrate",
            json!({"law": path}),
            "none of those that are built in",
        ),
        (
            "integrate",
            json!({"program": "changes.csv"}),
            "`program` must be",
        ),
        (
            "integrate",
            json!({"program": "x\n.csv"}),
            "`program` must be",
        ),
        (
            "law",
            json!({"ensemble": "fit.json"}),
            "`ensemble` must be the text of a fit",
        ),
        (
            "law",
            json!({"ensemble": "{\n}:100000"}),
            "`ensemble` is 100000, but must be at most 1000",
        ),
        (
            "sweep",
            json!({"threads": 2}),
            "`threads` can't be given here",
        ),
        (
            "sweep",
            json!({"resume": "x.csv"}),
            "`resume` can't be given here",
        ),
        (
            "sweep",
            json!({"shard": "1/2"}),
            "`shard` can't be given here",
        ),
        (
            "sweep",
            json!({"driving": "1:2:1000", "stiffness": "1:2:1000"}),
            "more than 200000 points",
        ),
        (
            "sweep",
            json!({"grid": ["a=1:2:1000", "b=1:2:1e3log"]}),
            "more than 200000 points",
        ),
        (
            "sweep",
            json!({"grid": ["a=1:2:1000"], "starts": 1000}),
            "more than 200000 points",
        ),
        (
            "integrate",
            json!({"points": 1e9}),
            "`points` is 1000000000, but must be at most 200000",
        ),
        (
            "integrate",
            json!({"interfaces": 1e6}),
            "`interfaces` is 1000000, but must be at most 1000",
        ),
        (
            "integrate",
            json!({"clusters": "600,600"}),
            "`clusters` is 1200, but must be at most 1000",
        ),
        ("section", json!({"returns": 1e7}), "`returns` is 10000000"),
        (
            "branch",
            json!({"of": "orbits", "max_points": 1e7}),
            "`max_points` is 10000000",
        ),
        (
            "branch",
            json!({"of": "--output=x"}),
            "`of` is \"--output=x\", but must be a word",
        ),
        (
            "branch",
            json!({"of": ["orbits", "--output=x"]}),
            "`of` must be a word",
        ),
        (
            "integrate",
            json!({"quiet": true}),
            "`quiet` can't be given here",
        ),
        (
            "integrate",
            json!({"until": true}),
            "`until` must be a number or a text",
        ),
        (
            "integrate",
            json!({"until": {"a": 1}}),
            "`until` must be a number or a text",
        ),
        (
            "integrate",
            json!({"until": "1\n--output=x"}),
            "`until` must be a text of one line",
        ),
        (
            "integrate",
            json!({"final_only": 1}),
            "`final_only` must be true or false",
        ),
        (
            "integrate",
            json!({"final-only": true, "final_only": true}),
            "is given twice",
        ),
        (
            "integrate",
            json!({"untill": 1}),
            "`untill` is no option of integrate; did you mean \"until\"?",
        ),
        ("integrate", json!({"": 1}), "`` is no option of integrate"),
        (
            "integrate",
            json!({"--until": 1}),
            "is no option of integrate",
        ),
        (
            "integrate",
            json!({"until=1 --output": "x"}),
            "is no option of integrate",
        ),
        (
            "integrate",
            json!({"set": vec!["a=1"; 1000]}),
            "`set` has more than 256 values",
        ),
        (
            "integrate",
            json!({"set": [["a=1"]]}),
            "`set` must be a number or a text",
        ),
        (
            "integrate",
            json!({"surface": "x".repeat(5000)}),
            "`surface` is no option of integrate",
        ),
        (
            "section",
            json!({"surface": "x".repeat(5000)}),
            "`surface` is longer than 4096 bytes",
        ),
        (
            "integrate",
            json!({"help": true}),
            "is no option of integrate",
        ),
        (
            "integrate",
            json!({"version": true}),
            "is no option of integrate",
        ),
        ("model", json!({"nonsense": 1}), "`nonsense` is no option"),
    ];
    for (command, options, sentence) in cases {
        for answer in [
            server.object(command, &options),
            server.stream(command, &options),
        ] {
            assert_eq!(answer.status, 400, "{command} {options}: {}", answer.body);
            let told = &answer.json()["error"];
            assert_eq!(told["kind"], "input");
            assert!(
                answer.message().contains(sentence),
                "{command} {options}: {told}"
            );
        }
    }
    for body in ["", "{}"] {
        assert_eq!(
            post(&server, "api/model", &[JSON], body).status,
            200,
            "{body}"
        );
    }
    for body in [
        "[]",
        "1",
        "{",
        "{\"a\":1}{",
        "nul",
        "\u{feff}{}",
        "{\"until\": 1e999}",
        "{\"until\": NaN}",
    ] {
        let answer = post(&server, "api/integrate", &[JSON], body);
        assert_eq!(answer.status, 400, "{body}");
        assert!(
            answer.message().contains("no JSON object") || body.contains("\"a\""),
            "{}",
            answer.body
        );
    }
    // The file was there, and is as it was.
    assert_eq!(command::contents(&place), ["system.toml"]);
}

/// A pipe that nobody writes into keeps who opens it for ever.
#[cfg(unix)]
#[test]
fn no_word_of_a_request_opens_a_file() {
    let place = folder("explore-pipes");
    let names = [
        "pipe.toml",
        "pipe.csv",
        "pipe.json",
        "lorenz",
        "spinodal",
        "pipe",
    ];
    for name in names {
        let made = std::process::Command::new("mkfifo")
            .arg(place.join(name))
            .status();
        assert!(made.expect("mkfifo").success());
    }
    let server = Server::start_in(&place, &[]);
    for command in COMMANDS {
        for option in twinslip_cli::options(command) {
            for name in names {
                for path in [
                    name.to_owned(),
                    place.join(name).to_str().expect("UTF-8").to_owned(),
                ] {
                    let options = json!({option.name.clone(): path});
                    // Whatever it says of it, it says it at once.
                    assert_ne!(
                        server.object(command, &options).body,
                        "",
                        "{command} {options}"
                    );
                }
            }
        }
    }
    let lorenz = json!({"system": "lorenz", "until": 1, "final_only": true});
    assert_eq!(server.object("integrate", &lorenz).status, 200);
}
