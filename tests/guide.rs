//! The README and the pages under `docs/`: every command runs as it stands and prints what the page shows, and links lead to files.

use crate::command::folder;
use crate::common::ROOT;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

/// What a page asks its reader to do, in order.
enum Piece {
    /// A block whose first line is `# NAME.toml` or `# NAME.csv` is a file that the reader writes.
    File(String, String),
    /// A line of a block `sh`: a command, of which only its success and its files are looked at.
    Run(String),
    /// A command in a block `console` behind `$`, and the lines below it.
    Shown(String, Vec<String>),
}

fn pieces(text: &str) -> Vec<Piece> {
    let mut found = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let Some(language) = line.strip_prefix("```") else {
            continue;
        };
        let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
        match language {
            "sh" => found.extend(block.iter().map(|line| Piece::Run((*line).to_owned()))),
            "console" => {
                for line in block {
                    if let Some(command) = line.strip_prefix("$ ") {
                        found.push(Piece::Shown(command.to_owned(), Vec::new()));
                    } else if let Some(Piece::Shown(_, shown)) = found.last_mut() {
                        shown.push(line.to_owned());
                    }
                }
            }
            "toml" | "csv" => {
                let name = block.first().and_then(|line| line.strip_prefix("# "));
                let is_file = |name: &&str| name.ends_with(&format!(".{language}"));
                if let Some(name) = name.filter(is_file) {
                    found.push(Piece::File(name.to_owned(), block.join("\n") + "\n"));
                }
            }
            _ => {}
        }
    }
    found
}

/// The same command over less, where that is as good a test of it: grids have a few points, a staircase its first steps. All figures go one
/// way, and `./reproduce` makes the sixth.
fn shortened(line: &str) -> String {
    let few = |word: &str| {
        let mut parts: Vec<String> = word.split(':').map(str::to_owned).collect();
        let count = parts.get(2).filter(|_| parts.len() == 3);
        let count = count.map(|count| {
            (
                count.trim_end_matches("log").parse::<u32>(),
                count.ends_with("log"),
            )
        });
        if let Some((Ok(7..), log)) = count {
            parts[2] = format!("6{}", if log { "log" } else { "" });
        }
        parts.join(":")
    };
    let words: Vec<String> = line.split_whitespace().map(few).collect();
    let line = words.join(" ");
    let line = line.replace("figure 6", "figure 5");
    line.replace("--to 1e6 -o staircase-20", "--to 20 -o staircase-20")
}

/// Runs a line by the shell, in which `twinslip` is the program under test, as a reader does who stands in the repository.
fn by_shell(line: &str, place: &Path) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_twinslip"));
    let mut path = vec![program.parent().expect("a folder").to_owned()];
    path.extend(std::env::split_paths(
        &std::env::var_os("PATH").unwrap_or_default(),
    ));
    Command::new("sh")
        .args(["-c", line])
        .env("PATH", std::env::join_paths(path).expect("a path"))
        .current_dir(place)
        .output()
        .expect("a shell")
}

/// The files that a line says it writes.
fn written(line: &str) -> Vec<&str> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let writes = |option: &str| {
        ["-o", "--output", "--report"].contains(&option) || option.starts_with("--plot")
    };
    let pairs = words.windows(2).filter(|pair| writes(pair[0]));
    pairs
        .map(|pair| pair[1])
        .filter(|file| *file != "-")
        .collect()
}

/// Runs a line, which must end with one of these statuses, and says what is wrong with it.
fn ends(line: &str, place: &Path, with: &[i32]) -> Result<Output, String> {
    if !line.starts_with("twinslip ") {
        return Err(format!("{line}: no command of twinslip"));
    }
    let ended = by_shell(line, place);
    let err = String::from_utf8_lossy(&ended.stderr);
    if !ended.status.code().is_some_and(|code| with.contains(&code)) {
        return Err(format!("{line}: {:?}: {err}", ended.status.code()));
    }
    for file in written(line) {
        if !place.join(file).metadata().is_ok_and(|data| data.len() > 0) {
            return Err(format!("{line}: {file} is not written"));
        }
    }
    Ok(ended)
}

/// Whether a terminal would have a table where a pipe has CSV.
fn is_table(line: &str) -> bool {
    let rows = [
        "law",
        "integrate",
        "equilibria",
        "orbit",
        "section",
        "branch",
        "locus",
        "sweep",
        "run",
    ];
    let command = line.split_whitespace().nth(1).unwrap_or_default();
    rows.contains(&command)
        && !["--format", " -o ", "--list", "--show", "--help", " -h"]
            .iter()
            .any(|word| line.contains(word))
}

/// Whether two lines say the same. Other kinds of processors round differently: numbers may differ in their seventh digit and beyond, and
/// error bounds, which stand behind `±`, by a factor of ten.
fn same(shown: &str, printed: &str) -> bool {
    let number = |word: &str| word.trim_matches(['(', ')', ',', ';']).parse::<f64>();
    let (shown, printed): (Vec<_>, Vec<_>) = (
        shown.split_whitespace().collect(),
        printed.split_whitespace().collect(),
    );
    let equal = |i: usize| match (number(shown[i]), number(printed[i])) {
        (Ok(a), Ok(b)) if i > 0 && shown[i - 1] == "±" => a <= 10.0 * b && b <= 10.0 * a,
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-6 * a.abs(),
        _ => shown[i] == printed[i],
    };
    shown.len() == printed.len() && (0..shown.len()).all(equal)
}

/// Compares what a page shows with what a terminal would: all of standard output, in which `...` stands for any number of lines, and any of
/// the messages.
fn compare(shown: &[String], out: &str, err: &str) -> Result<(), String> {
    let mut out = out.lines().peekable();
    let mut err = err.lines();
    let mut left_out = false;
    for line in shown {
        if line == "..." {
            left_out = true;
            continue;
        }
        if out.peek().is_some_and(|printed| same(line, printed)) {
            out.next();
            left_out = false;
        } else if left_out && out.clone().any(|printed| same(line, printed)) {
            out.find(|printed| same(line, printed));
            left_out = false;
        } else if !err.any(|message| same(line, message)) {
            return Err(format!("not printed: {line}"));
        }
    }
    match out.next() {
        Some(line) if !left_out => Err(format!("not shown: {line}")),
        _ => Ok(()),
    }
}

/// How many commands of a page ran, how many outputs agreed, and what is wrong.
fn tried(name: &str, text: &str) -> (usize, usize, String) {
    let place = folder(&format!("page-{}", name.replace('/', "-")));
    for data in ["tests", "scenes"] {
        std::os::unix::fs::symlink(Path::new(ROOT).join(data), place.join(data)).expect("a link");
    }
    let (mut ran, mut agreed, mut wrong) = (0, 0, String::new());
    let pieces = pieces(text);
    for (i, piece) in pieces.iter().enumerate() {
        let checked = match piece {
            Piece::File(file, content) => {
                std::fs::write(place.join(file), content).expect("a file");
                continue;
            }
            // A map is done with undecided points too, and where these lie depends on the grid, which is shortened.
            Piece::Run(line) if line.starts_with("twinslip sweep ") => {
                ends(&shortened(line), &place, &[0, 3]).map(|_| ())
            }
            Piece::Run(line) => ends(&shortened(line), &place, &[0]).map(|_| ()),
            Piece::Shown(line, _) if line == "echo $?" => continue,
            Piece::Shown(line, shown) => {
                let status = match pieces.get(i + 1) {
                    Some(Piece::Shown(next, status)) if next == "echo $?" => {
                        status.concat().parse().expect("a status")
                    }
                    _ => 0,
                };
                let mut whole = line.clone();
                // A pipe has CSV for the reader too.
                if is_table(line) && !line.contains(" | ") {
                    whole = format!("{line} --format table");
                }
                agreed += 1;
                ends(&whole, &place, &[status]).and_then(|Output { stdout, stderr, .. }| {
                    let (out, err) = (
                        String::from_utf8_lossy(&stdout),
                        String::from_utf8_lossy(&stderr),
                    );
                    compare(shown, &out, &err).map_err(|what| format!("{line}: {what}\n{out}{err}"))
                })
            }
        };
        ran += 1;
        if let Err(what) = checked {
            let _ = writeln!(wrong, "{name}: {what}");
        }
    }
    (ran, agreed, wrong)
}

/// The README and all pages, by their names in the repository.
fn pages() -> Vec<(String, String)> {
    let mut folders = vec![PathBuf::from("docs")];
    let mut names = vec![PathBuf::from("README.md")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(Path::new(ROOT).join(&folder)).expect("docs/") {
            let name = folder.join(entry.expect("an entry").file_name());
            if Path::new(ROOT).join(&name).is_dir() {
                folders.push(name);
            } else if name.extension().is_some_and(|extension| extension == "md") {
                names.push(name);
            }
        }
    }
    let read = |name: PathBuf| {
        let text = std::fs::read_to_string(Path::new(ROOT).join(&name)).expect("a page");
        (name.display().to_string(), text)
    };
    names.into_iter().map(read).collect()
}

#[test]
fn every_command_of_every_page_runs_and_prints_what_is_shown() {
    let pages = pages();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut results = Vec::new();
        while let Some((name, text)) = pages.get(next.fetch_add(1, Ordering::Relaxed)) {
            results.push(tried(name, text));
        }
        results
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let results: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let ended = workers
            .into_iter()
            .flat_map(|worker| worker.join().expect("no panic"));
        ended.collect()
    });
    let wrong: String = results.iter().map(|(.., wrong)| wrong.as_str()).collect();
    assert!(wrong.is_empty(), "{wrong}");
    let ran: usize = results.iter().map(|(ran, ..)| ran).sum();
    let agreed: usize = results.iter().map(|(_, agreed, _)| agreed).sum();
    assert!(ran > 80 && agreed > 0, "{ran} commands, {agreed} outputs");
}

/// The comparison above finds a changed digit, a line too many and a line too few.
#[test]
fn an_output_that_differs_is_found() {
    let shown = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let out = "a b\n1.0\n2.0\n3.0\n";
    for right in [
        "a b\n1.0\n2.0\n3.0",
        "a b\n...\n3.0",
        "a b\n...",
        "a b\n...\n3.0\nsaid",
    ] {
        assert_eq!(compare(&shown(right), out, "said\n"), Ok(()), "{right}");
    }
    for wrong in [
        "a b\n1.0\n2.0",
        "a b\n1.1\n2.0\n3.0",
        "a b\n3.0",
        "a b\n...\n4.0",
        "a b\n...\n3.0\n2.0",
        "",
    ] {
        assert!(compare(&shown(wrong), out, "said\n").is_err(), "{wrong}");
    }
    assert!(same(
        "period 3.114952 ± 3.1e-14",
        "period 3.1149521 ± 5e-14"
    ));
    assert!(!same(
        "period 3.114952 ± 3.1e-14",
        "period 3.114972 ± 3.1e-14"
    ));
    assert!(!same(
        "period 3.114952 ± 3.1e-14",
        "period 3.114952 ± 3.1e-12"
    ));
}

/// Relative links and pictures of all documents; anchors are checked where the site is built.
#[test]
fn what_documents_point_to_is_there() {
    let mut checked = 0;
    let mut texts = pages();
    for name in ["CONTRIBUTING.md", "CHANGELOG.md"] {
        let text = std::fs::read_to_string(Path::new(ROOT).join(name)).expect(name);
        texts.push((name.to_owned(), text));
    }
    for (name, text) in texts {
        let folder = Path::new(ROOT).join(&name);
        let folder = folder.parent().expect("a folder");
        for link in text.split("](").skip(1) {
            let (link, _) = link.split_once(')').expect("an end");
            let (file, _) = link.split_once('#').unwrap_or((link, ""));
            if !link.starts_with("http") {
                assert!(folder.join(file).exists(), "{name}: {link}");
                checked += 1;
            }
        }
    }
    assert!(checked > 60, "{checked}");
}
