//! The report in a real browser: it is all there, fits phones and desktops, and asks for nothing.
//!
//! Needs chromium; `tests/browser.sh` installs and runs it. The environment variable TWINSLIP_REPORT names a report to try in
//! place of the made-up ones.

mod devtools;
use crate::common::pages;

use devtools::Browser;
use serde_json::Value;
use std::path::{Path, PathBuf};

const MEASURE: &str = include_str!("measure.js");
/// A phone, a tablet, a desktop; in CSS pixels.
const WIDTHS: [u32; 3] = [360, 768, 1280];

/// What the browser complained about, and what it asked for besides the page and what is in it.
fn complaints(events: &[Value], address: &str) -> Vec<String> {
    let mut found = Vec::new();
    for event in events {
        let what = &event["params"];
        match event["method"].as_str().unwrap_or("") {
            "Runtime.exceptionThrown"
            | "Runtime.consoleAPICalled"
            | "Log.entryAdded"
            | "Network.loadingFailed" => {
                found.push(event.to_string());
            }
            "Network.requestWillBeSent" => {
                let asked = what["request"]["url"].as_str().unwrap_or("");
                if asked != address && !asked.starts_with("data:") {
                    found.push(format!("asks for {asked}"));
                }
            }
            _ => {}
        }
    }
    found
}

/// The address of a file, as the browser writes it.
fn address(file: &Path) -> String {
    let mut address = "file://".to_owned();
    for byte in file.to_str().expect("a name in UTF-8").bytes() {
        if byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte) {
            address.push(char::from(byte));
        } else {
            address.push_str(&format!("%{byte:02X}"));
        }
    }
    address
}

/// Everything wrong with the page at that width, and the files that it links to.
fn examine(
    browser: &mut Browser,
    file: &Path,
    width: u32,
    scripts: bool,
) -> (Vec<String>, Vec<PathBuf>) {
    let address = address(file);
    let events = browser.open(&address, width, scripts);
    let measured = browser.evaluate(&format!("{MEASURE}({width})"));
    let list = |name: &str| -> Vec<String> {
        let items = measured[name].as_array().expect("a list");
        items
            .iter()
            .map(|item| item.as_str().expect("a text").to_owned())
            .collect()
    };
    let mut wrong = complaints(&events, &address);
    wrong.extend(list("wrong"));
    let files = list("files").into_iter().map(PathBuf::from).collect();
    // Enlarged pictures scroll in their frames: the page fits as before.
    browser.evaluate("document.querySelectorAll('.zoom').forEach((box) => box.click())");
    let measured = browser.evaluate(&format!("{MEASURE}({width})"));
    let enlarged = measured["wrong"].as_array().expect("a list");
    wrong.extend(enlarged.iter().map(|item| format!("enlarged: {item}")));
    let small = browser.evaluate(
        "[...document.querySelectorAll('.zoom:checked + .picture img')].filter((image) => image.width < 1000).length",
    );
    if small != 0 {
        wrong.push(format!("{small} pictures are not enlarged"));
    }
    (wrong, files)
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// The file of that page.
fn written(folder: &Path, html: &str) -> PathBuf {
    let file = folder.join("report.html");
    std::fs::write(&file, html).expect("a file");
    file
}

fn assert_fits(browser: &mut Browser, file: &Path, linked_files_exist: bool) {
    for width in WIDTHS {
        let (wrong, files) = examine(browser, file, width, false);
        assert!(
            wrong.is_empty(),
            "{} at {width}:\n{}",
            file.display(),
            wrong.join("\n")
        );
        if linked_files_exist {
            assert!(!files.is_empty(), "{} links to no file", file.display());
            for linked in files {
                assert!(linked.is_file(), "{} is not there", linked.display());
            }
        }
    }
}

#[test]
#[ignore = "needs chromium: tests/browser.sh runs it"]
fn the_report_fits_and_stands_alone() {
    let mut browser = Browser::start(&folder("browser-report").join("profile"));
    if let Some(report) = std::env::var_os("TWINSLIP_REPORT") {
        let report = Path::new(&report)
            .canonicalize()
            .expect("TWINSLIP_REPORT names a file");
        assert_fits(&mut browser, &report, true);
        return;
    }
    for (name, page) in [
        ("browser-plain", pages::plain()),
        ("browser-hostile", pages::hostile()),
    ] {
        let file = written(&folder(name), &page.html());
        assert_fits(&mut browser, &file, false);
        let title = browser.evaluate("document.title");
        assert_eq!(
            title,
            page.title.split_whitespace().collect::<Vec<_>>().join(" "),
            "no script ran"
        );
        let figures = browser.evaluate("document.querySelectorAll('img').length");
        assert_eq!(
            figures,
            page.figures
                .iter()
                .filter(|figure| !figure.svg.is_empty())
                .count()
        );
    }
}

/// Each fault is found; else the test above would say nothing.
#[test]
#[ignore = "needs chromium: tests/browser.sh runs it"]
fn faults_are_found() {
    let faults = [
        ("<div style='width: 500px'>wide</div>", "sticks out"),
        ("<div style='width: 500px'>wide</div>", "the page is"),
        (
            "<div style='width: 50px'><span style='display: block; width: 90px'>x</span></div>",
            "content is wider",
        ),
        (
            "<div style='margin-left: -40px; width: 50px'>lost at the left</div>",
            "sticks out",
        ),
        (
            "<img src='data:image/svg+xml,%3Csvg xmlns=%22http://www.w3.org/2000/svg%22 width=%225%22 height=%225%22/%3E'>",
            "no alternative",
        ),
        (
            "<img alt='broken' src='data:image/svg+xml,no'>",
            "not drawn",
        ),
        (
            "<img alt='elsewhere' src='http://127.0.0.1:9/x.png'>",
            "asks for http",
        ),
        (
            "<img alt='elsewhere' src='http://127.0.0.1:9/x.png'>",
            "loadingFailed",
        ),
        ("<link rel='stylesheet' href='beside.css'>", "asks for file"),
        ("<a href='#nowhere'>x</a>", "no target"),
        ("<a href='https://example.org/'>x</a>", "leads away"),
        ("<a href='x.csv'></a>", "without words"),
        ("<p id='a'></p><p id='a'></p>", "twice the id"),
        ("<section aria-labelledby='b'></section>", "nothing labels"),
        ("<script>throw new Error('thrown')</script>", "thrown"),
        ("<script>console.error('said')</script>", "said"),
        ("<script></script>", "there is a script"),
        ("<p onclick='x()'>x</p>", "a script in onclick"),
        ("<table><tr><th>x</th></tr></table>", "no scope"),
        ("<h3>x</h3>", "from level 1 to 3"),
        ("<main></main>", "not one main"),
    ];
    let folder = folder("browser-faults");
    let mut browser = Browser::start(&folder.join("profile"));
    let page = |body: &str| {
        format!(
            "<!DOCTYPE html><html lang='en'><head><meta charset='utf-8'><meta name='viewport' content='width=device-width'>\
             <title>t</title></head><body><main><h1>t</h1>{body}</main></body></html>"
        )
    };
    let file = written(
        &folder,
        &page("<p>Nothing is wrong here: <a href='x.csv'>x</a></p>"),
    );
    let (wrong, files) = examine(&mut browser, &file, 360, true);
    assert_eq!(wrong, Vec::<String>::new());
    assert_eq!(files, [folder.join("x.csv")]);
    for (body, sentence) in faults {
        let file = written(&folder, &page(body));
        let (wrong, _) = examine(&mut browser, &file, 360, true);
        assert!(
            wrong.iter().any(|found| found.contains(sentence)),
            "{body}: {wrong:#?}"
        );
    }
}
