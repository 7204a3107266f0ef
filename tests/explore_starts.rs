//! How `twinslip explore` begins and ends: its address, a port, a scene, a browser, Ctrl-C, and the page as one file.

use crate::command;
use command::explore::{STREAM, Server, begun};
use command::{folder, program, refused, refused_in_one_line, twinslip};
use serde_json::{Value, json};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};
use twinslip_cli::internals::explore_bundle as bundle;

/// What the page begins with.
fn begin(page: &str) -> Value {
    let (_, rest) = page
        .split_once("<script type=\"application/json\" id=\"begin\">")
        .expect("the element");
    let (json, _) = rest.split_once("</script>").expect("its end");
    serde_json::from_str(json).expect("JSON")
}

fn begins(arguments: &[&str]) -> Value {
    begin(&Server::start(arguments).get("").body)
}

#[test]
fn the_page_begins_with_the_options_of_the_command_line() {
    let plain = begins(&[]);
    assert_eq!(
        (&plain["options"], &plain["scene"]),
        (&json!({}), &Value::Null)
    );
    assert!(
        plain["systems"]
            .as_array()
            .is_some_and(|all| all.contains(&json!("lorenz")))
    );
    assert!(
        plain["glossary"]
            .as_str()
            .is_some_and(|text| text.contains("| `PD` |"))
    );
    assert!(
        plain["example"]
            .as_str()
            .is_some_and(|text| text.contains("[rates]"))
    );

    let given = [
        "--driving",
        "10um/s",
        "--stiffness=5MPa/mm",
        "--set",
        "c=0.002",
        "--law",
        "ageing",
        "--slip-length=10um",
    ];
    let options = begins(&given)["options"].clone();
    let told = json!({"driving": 1e-5, "stiffness": 5_000_000_000_u64, "si": true, "set": ["residual_strength=0.002"], "law": "dieterich-ruina", "slip_length": 1e-5});
    assert_eq!(options, told);

    let options = begins(&["--system", "lorenz", "--set", "r=30,s=9"])["options"].clone();
    assert_eq!(options, json!({"system": "lorenz", "set": ["r=30", "s=9"]}));
}

#[test]
fn a_scene_gives_its_options_and_those_of_the_command_line_replace_them() {
    let begin = begins(&["fig12", "--set", "R=50"]);
    assert_eq!(begin["options"], json!({"set": ["healing_time=50"]}));
    let scene = &begin["scene"];
    assert_eq!(
        (&scene["name"], &scene["command"]),
        (&json!("fig12"), &json!("locus"))
    );
    assert_eq!(scene["options"]["of"], "torus");
    assert!(
        scene["about"]
            .as_str()
            .is_some_and(|text| text.starts_with("Figs 6, 12 and 14"))
    );

    let place = folder("explore-scene");
    let system = "name = \"line\"\nstates = [\"x\"]\n[parameters]\na = 1.0\n[rates]\nx = \"-a*x\"\n[start]\nx = 1.0";
    std::fs::write(place.join("line.toml"), system).expect("written");
    let scene = "command = \"integrate\"\nsystem = \"line.toml\"\nuntil = 3\n[set]\na = 2\n";
    std::fs::write(place.join("scene.toml"), scene).expect("written");
    let server = Server::start_in(&place, &["scene.toml", "--set", "a=3"]);
    let begin = begin_of(&server);
    // Requests name no file: the page has its text.
    assert_eq!(
        begin["options"],
        json!({"system": format!("{system}\n"), "set": ["a=3"]})
    );
    assert_eq!(begin["scene"]["options"], json!({"until": 3}));
    assert_eq!(server.object("model", &begin["options"]).status, 200);
    let mut options = begin["options"].clone();
    options["until"] = json!(1);
    options["final_only"] = json!(true);
    let run = server.object("integrate", &options).json();
    assert!(
        (run["result"]["final"]["x"].as_f64().expect("a number") - (-3.0f64).exp()).abs() < 1e-6
    );
}

fn begin_of(server: &Server) -> Value {
    begin(&server.get("").body)
}

#[test]
fn what_is_wrong_is_said_in_a_sentence_before_there_is_a_page() {
    refused("explore --port 65536", "'--port <P>'");
    refused("explore --driving x", "is not a number");
    refused_in_one_line(
        "explore --driving -1",
        "driving is -1, but must be positive and finite",
    );
    refused_in_one_line("explore --set q=1", "q");
    refused_in_one_line("explore --system nosuch", "none of those that are built in");
    refused_in_one_line("explore nosuch", "no built-in scene of this name");
    refused("explore --save x.html --port 1", "cannot be used with");
    let server = Server::start(&[]);
    let port = server.port;
    refused_in_one_line(&format!("explore --port {port}"), "can't listen there");
    drop(server);
}

#[test]
fn a_port_that_is_asked_for_is_taken() {
    let free = std::net::TcpListener::bind(("127.0.0.1", 0)).expect("a port");
    let port = free.local_addr().expect("an address").port();
    drop(free);
    let server = Server::start(&["--port", &port.to_string()]);
    assert_eq!(server.port, port);
    // It is there for this machine alone.
    let others = std::net::TcpListener::bind(("127.0.0.2", port));
    assert!(others.is_ok() || cfg!(not(target_os = "linux")));
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_it_at_once_also_while_commands_run() {
    let interrupt = |process: u32| {
        let kill = std::process::Command::new("kill")
            .args(["-INT", &process.to_string()])
            .status();
        assert!(kill.expect("kill").success());
    };
    for busy in [false, true] {
        let mut server = Server::start(&[]);
        let long = json!({"driving": 0.102, "stiffness": 0.2, "until": 1e9, "points": 200_000});
        let mut running = Vec::new();
        for _ in 0..if busy { 3 } else { 0 } {
            let mut stream = server.ask("integrate", &long, &[STREAM]);
            if running.len() < 2 {
                begun(&mut stream);
            }
            running.push(stream);
        }
        let begun = Instant::now();
        interrupt(server.child.id());
        let status = server.child.wait().expect("it ends");
        assert_eq!(status.code(), Some(130));
        assert!(begun.elapsed() < Duration::from_secs(20));
    }
}

/// The browser gets an address that leads to the page once: what a program is started with is no secret.
#[cfg(target_os = "linux")]
#[test]
fn the_browser_is_opened_with_an_address_that_works_once() {
    use std::os::unix::fs::PermissionsExt;
    let place = folder("explore-browser");
    let opener = place.join("xdg-open");
    let said = place.join("address");
    std::fs::write(
        &opener,
        format!(
            "#!/bin/sh\necho \"$1\" > {0}.new && mv {0}.new {0}\n",
            said.display()
        ),
    )
    .expect("written");
    std::fs::set_permissions(&opener, PermissionsExt::from_mode(0o755)).expect("executable");
    let path = format!(
        "{}:{}",
        place.display(),
        std::env::var("PATH").expect("a path")
    );
    let mut explore = program();
    explore.env("PATH", path).env("DISPLAY", ":0");
    let server = Server::of(explore.arg("explore"));
    let begun = Instant::now();
    let address = loop {
        if let Ok(address) = std::fs::read_to_string(&said) {
            break address.trim().to_owned();
        }
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "the browser is opened"
        );
        std::thread::sleep(Duration::from_millis(10));
    };
    let secret = server.base.trim_matches('/');
    assert!(!address.contains(secret));
    let ticket = address.rsplit('/').next().expect("a path");
    assert_eq!(ticket.len(), secret.len());
    let get = |path: &str| {
        let head = server.head(&format!("GET {path}"), &[("Connection", "close")]);
        server.exchange(head.as_bytes()).expect("an answer")
    };
    assert_eq!(get(&format!("/{ticket}/")).status, 403);
    let first = get(&format!("/{ticket}"));
    assert_eq!(
        (first.status, first.head("location")),
        (303, server.base.as_str())
    );
    assert_eq!(get(&format!("/{ticket}")).status, 403);
    assert_eq!(get(&server.base).status, 200);
}

/// The parts of a saved page, which needs nothing else.
fn is_whole(page: &str) {
    let (head, _) = page.split_once("</head>").expect("a head");
    for part in [
        "http-equiv=\"Content-Security-Policy\"",
        "default-src 'none'; script-src 'sha256-",
        "style-src 'sha256-",
    ] {
        assert!(head.contains(part), "{part}");
    }
    for part in ["src=\"explore.js\"", "href=\"style.css\"", "unsafe-inline"] {
        assert!(!page.contains(part), "{part}");
    }
    let count = |part: &str| page.matches(part).count();
    assert_eq!(
        (
            count("<script"),
            count("</script"),
            count("<style"),
            count("</style")
        ),
        (2, 2, 1, 1)
    );
}

#[test]
fn a_page_saves_itself_as_one_file() {
    let server = Server::start(&[]);
    let content = json!({"recording": {"run:0": [{"say": "</script><!-- <script>"}, {"ended": "done"}]}, "state": {"active": 0}});
    let answer = server.object("save", &content);
    assert_eq!(
        (answer.status, answer.head("content-type")),
        (200, "text/html; charset=utf-8")
    );
    assert!(
        answer
            .head("content-disposition")
            .starts_with("attachment; filename=")
    );
    is_whole(&answer.body);
    let mut told = begin(&answer.body);
    assert_eq!(told["saved"], content);
    told.as_object_mut().expect("an object").remove("saved");
    assert_eq!(told, begin_of(&server));
    for wrong in [
        json!({}),
        json!([]),
        json!({"recording": 1}),
        json!({"recording": {}, "more": 1}),
    ] {
        assert_eq!(server.object("save", &wrong).status, 400, "{wrong}");
    }
}

#[test]
fn the_command_line_saves_a_page_with_its_first_answers() {
    let place = folder("explore-save");
    let file = place.join("page.html");
    let path = file.to_str().expect("UTF-8");
    let ended = twinslip(&format!("explore --system van-der-pol --save {path}"));
    assert_eq!((ended.code, ended.out.as_str()), (0, ""), "{}", ended.err);
    assert!(ended.err.contains("it needs no server"), "{}", ended.err);
    let page = std::fs::read_to_string(&file).expect("written");
    is_whole(&page);
    let begin = begin(&page);
    assert_eq!(begin["options"], json!({"system": "van-der-pol"}));
    let recording = begin["saved"]["recording"]
        .as_object()
        .expect("a recording");
    for place in [
        "model",
        "equilibria:0",
        "orbit:0",
        "run:0",
        "section:0",
        "branch:x:equilibria",
        "branch:x:orbits",
    ] {
        let lines = recording[place].as_array().expect("lines");
        let last = lines.last().expect("a line");
        assert!(last.get("ended").is_some(), "{place}: {last}");
    }
    let drawn = recording["run:0"].as_array().expect("lines");
    assert!(drawn.iter().any(|line| line.get("picture").is_some()));
    let nowhere = Path::new(path).join("page.html");
    refused_in_one_line(
        &format!("explore --save {}", nowhere.display()),
        "cannot write",
    );
}

#[test]
fn modules_become_one_script() {
    let files = |pairs: &[(&str, &'static str)]| -> Vec<(String, &'static str)> {
        pairs
            .iter()
            .map(|(name, text)| ((*name).to_owned(), *text))
            .collect()
    };
    let main = "import { a, b as c } from \"./x.js\";\nexport const d = a + c;\n";
    let script = bundle(
        &files(&[
            ("main.js", main),
            (
                "x.js",
                "export const a = 1;\nexport async function b() {}\nconst own = 2;\n",
            ),
            ("left.js", "out"),
        ]),
        "main.js",
    );
    let wanted = "const twinslipExplore = (() => {\n\"use strict\";\nconst modules = {};\nmodules[\"x.js\"] = (() => {\nconst a = 1;\nasync function b() {}\nconst own = 2;\n\
        return { a, b };\n})();\nmodules[\"main.js\"] = (() => {\nconst { a, b: c } = modules[\"x.js\"];\nconst d = a + c;\nreturn { d };\n})();\n\
        return modules[\"main.js\"];\n})();\n";
    assert_eq!(script.as_deref(), Ok(wanted));
    let wrong = [
        (
            "import x from \"./x.js\";\n",
            "main.js:1: this form of import is not known",
        ),
        (
            "\nexport default 1;\n",
            "main.js:2: this form of export is not known",
        ),
        (
            "export { a } from \"./x.js\";\n",
            "this form of export is not known",
        ),
        (
            "import { a } from \"./y.js\";\n",
            "main.js imports y.js, which is not there",
        ),
        (
            "import { z } from \"./x.js\";\n",
            "main.js imports z, which x.js does not export",
        ),
        (
            "import { d } from \"./main.js\";\nexport const d = 1;\n",
            "imports go round in a circle: main.js -> main.js",
        ),
    ];
    for (main, sentence) in wrong {
        let error = bundle(
            &files(&[("main.js", main), ("x.js", "export const a = 1;\n")]),
            "main.js",
        );
        let error = error.expect_err(main);
        assert!(error.contains(sentence), "{error}");
    }
}

/// The files of modules below a folder, by their paths from it.
fn modules(folder: &Path, above: &str) -> Vec<String> {
    let below = |file: std::fs::DirEntry| {
        let name = format!("{above}{}", file.file_name().to_string_lossy());
        match file.path().is_dir() {
            true => modules(&file.path(), &format!("{name}/")),
            false => vec![name],
        }
    };
    let files = std::fs::read_dir(folder).expect("a folder").flatten();
    let mut all: Vec<String> = files.flat_map(below).collect();
    all.retain(|name| name.ends_with(".js"));
    all
}

#[test]
fn the_script_of_the_page_holds_all_its_modules() {
    let script = Server::start(&[]).get("explore.js").body;
    let folder = Path::new(crate::common::ROOT).join("crates/cli/src/explore/page");
    let mut left = modules(&folder, "");
    assert!(left.len() > 20);
    left.retain(|name| !script.contains(&format!("modules[\"{name}\"] = ")));
    assert!(left.is_empty(), "{left:?} are imported by none");
    assert!(!script.contains("</script"));
}

#[test]
fn help_has_an_example_and_shells_complete_it() {
    let help = twinslip("explore --help").out;
    for part in [
        "--port",
        "--no-browser",
        "--save",
        "--system",
        "twinslip explore fig12",
    ] {
        assert!(help.contains(part), "{part}");
    }
    for shell in ["bash", "zsh", "fish"] {
        assert!(
            twinslip(&format!("completions {shell}"))
                .out
                .contains("no-browser"),
            "{shell}"
        );
    }
    let unheard = program()
        .args(["explore", "--no-browser", "--driving", "-1"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    assert_eq!(unheard.expect("it starts").code(), Some(2));
}
