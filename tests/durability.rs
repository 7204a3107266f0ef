//! What is written is not lost, doubled or mixed: kills at random moments, two writers at once, damaged and foreign files.

use crate::command;
use command::{Ended, contents, csv, folder, object, twinslip};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const SWEEP: &str = "sweep -q --driving 0.14:0.5:6 --stiffness 0.3:0.5:4";
const LONG_SWEEP: &str = "sweep -q --driving 0.14:0.5:2000 --stiffness 0.36:0.5:2000";
const BRANCH: &str = "branch equilibria -q --stiffness 0.14";
const LOCUS: &str = "locus hopf -q --step-limit 0.5";
const RUN: &str = "integrate -q --driving 10 --stiffness 0.14 --until 40 --rtol 1e-10";

fn begin(arguments: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_twinslip"))
        .args(arguments.split_whitespace())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

/// Waits until a file has so many bytes.
fn grown(path: &Path, bytes: u64) {
    let begun = Instant::now();
    while fs::metadata(path).map_or(0, |data| data.len()) < bytes {
        assert!(begun.elapsed() < Duration::from_secs(120), "no row came");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn done(arguments: &str) {
    let ended = twinslip(arguments);
    assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{arguments}");
}

/// Done, be a verdict undecided or not.
fn computed(arguments: &str) {
    let ended = twinslip(arguments);
    assert!(matches!(ended.code, 0 | 3), "{arguments}: {}", ended.err);
}

/// Refused with one sentence, which has these words.
fn refused(arguments: &str, words: &str) {
    let Ended { code, out, err } = twinslip(arguments);
    assert_eq!((code, out.as_str()), (2, ""), "{arguments}: {err}");
    assert!(err.contains(words), "{arguments}: {err}");
    assert_eq!(err.lines().count(), 1, "{arguments}: {err}");
}

/// The bytes of a file, without the command, which names the file.
fn read(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("written");
    let lines = text.split_inclusive('\n');
    lines
        .filter(|line| !line.starts_with("# command:"))
        .collect()
}

fn special(path: &Path) -> PathBuf {
    path.with_extension("special.csv")
}

fn random() -> u64 {
    std::hash::BuildHasher::hash_one(&std::hash::RandomState::new(), 0u8)
}

/// Kills it again and again, each time on its way to the end, and goes on with what is left; in the end the bytes are those of an
/// uninterrupted run.
fn killed(name: &str, command: &str, files: fn(&Path) -> Vec<PathBuf>) {
    const KILLS: u64 = 12;
    let place = folder(name);
    let [whole, torn] = ["whole.csv", "torn.csv"].map(|name| place.join(name));
    let begun = Instant::now();
    computed(&format!("{command} -o {}", whole.display()));
    // Where a kill falls is chance, and depends on the machine: what must hold does not.
    let span = begun.elapsed().as_micros() as u64;
    let resume = format!("{command} --resume {}", torn.display());
    for _ in 0..KILLS {
        let mut child = begin(&resume);
        std::thread::sleep(Duration::from_micros(random() % span));
        child.kill().expect("SIGKILL");
        child.wait().expect("it ends");
    }
    computed(&resume);
    for (whole, torn) in files(&whole).iter().zip(files(&torn)) {
        assert!(read(whole) == read(&torn), "{command}: {}", torn.display());
    }
    // What is complete stays as it is.
    let before = fs::read(&torn).expect("written");
    computed(&resume);
    assert!(fs::read(&torn).expect("written") == before);
}

#[test]
fn a_killed_sweep_ends_in_the_same_bytes() {
    let command = "sweep -q --driving 0.14:0.5:20 --stiffness 0.34:0.5:20";
    killed("durable-sweep", command, |path| vec![path.to_owned()]);
}

#[test]
fn a_killed_branch_ends_in_the_same_bytes() {
    killed(
        "durable-branch",
        &format!("{BRANCH} --step-limit 0.02"),
        |path| vec![path.to_owned(), special(path)],
    );
}

#[test]
fn a_killed_branch_of_orbits_ends_in_the_same_bytes() {
    let command = "branch orbits -q --stiffness 0.14 --from 0.06 --to 0.13";
    killed("durable-orbits", command, |path| {
        vec![path.to_owned(), special(path)]
    });
}

#[test]
fn a_killed_locus_ends_in_the_same_bytes() {
    killed("durable-locus", LOCUS, |path| {
        vec![path.to_owned(), special(path)]
    });
}

/// A run can't be gone on with: what is left of one is replaced on request alone.
#[test]
fn a_killed_run_is_not_replaced_without_a_word() {
    let place = folder("durable-run");
    let [whole, torn] = ["whole.csv", "torn.csv"].map(|name| place.join(name));
    let mut child =
        begin(&format!("{RUN} --until 1e9 -o {}", torn.display()).replacen("--until 40 ", "", 1));
    grown(&torn, 20_000);
    child.kill().expect("SIGKILL");
    child.wait().expect("it ends");
    let left = fs::read(&torn).expect("written");
    for command in [
        RUN,
        SWEEP,
        BRANCH,
        "law -q --points 9",
        "law -q --points 9 --format table",
    ] {
        refused(
            &format!("{command} -o {}", torn.display()),
            "it holds an unfinished run",
        );
    }
    assert!(fs::read(&torn).expect("written") == left);
    done(&format!("{RUN} --force -o {}", torn.display()));
    done(&format!("{RUN} -o {}", whole.display()));
    assert!(read(&torn) == read(&whole));
}

/// A file is replaced without a word only if it is empty, or a run has ended in it.
#[test]
fn what_is_no_result_is_not_replaced_without_a_word() {
    let place = folder("durable-foreign");
    let path = place.join("notes.csv");
    let commands = [
        "law -q --points 9",
        "law -q --points 9 --format table",
        "equilibria -q --driving 10 --stiffness 0.14",
        "integrate -q --driving 10 --stiffness 0.14 --until 12",
        BRANCH,
        "locus pitchfork -q",
        SWEEP,
    ];
    for command in commands {
        fs::write(&path, "my,own,notes\n1,2,3\n").expect("written");
        refused(
            &format!("{command} -o {}", path.display()),
            "replace it with --force",
        );
        assert_eq!(
            fs::read_to_string(&path).expect("there"),
            "my,own,notes\n1,2,3\n"
        );
        done(&format!("{command} --force -o {}", path.display()));
        // Again, and over the result of any other command.
        let first = fs::read(&path).expect("written");
        done(&format!("{command} -o {}", path.display()));
        let again = String::from_utf8(fs::read(&path).expect("written")).expect("text");
        assert_eq!(
            String::from_utf8(first)
                .expect("text")
                .replace(" --force", ""),
            again
        );
        done(&format!("law -q --points 9 -o {}", path.display()));
        fs::write(&path, "").expect("written");
        done(&format!("{command} -o {}", path.display()));
    }
    // A computation that failed has ended too.
    let blows = "integrate -q --law dieterich-ruina --driving 10 --stiffness 0.3 --until 100";
    for _ in 0..2 {
        let ended = twinslip(&format!("{blows} -o {}", path.display()));
        assert_eq!(ended.code, 1, "{}", ended.err);
    }
    assert!(read(&path).contains("# rows: ended by an error"));
    // Nothing that is no CSV of this program is gone on with, be it without a line break.
    for text in ["notes", "notes\n1,2\n", "# notes\n", "# notes"] {
        fs::write(&path, text).expect("written");
        for command in [BRANCH, SWEEP] {
            refused(
                &format!("{command} --resume {}", path.display()),
                "notes.csv",
            );
            assert_eq!(fs::read_to_string(&path).expect("there"), text);
        }
    }
    // The file of special points is protected as that of the rows is.
    let rows = place.join("rows.csv");
    fs::write(special(&rows), "my,own,notes\n").expect("written");
    refused(
        &format!("{BRANCH} -o {}", rows.display()),
        "rows.special.csv",
    );
    assert!(!rows.exists());
}

#[test]
fn two_writers_do_not_share_a_file() {
    let place = folder("durable-writers");
    let path = place.join("map.csv");
    let resume = format!("{LONG_SWEEP} --resume {}", path.display());
    let mut first = begin(&resume);
    grown(&path, 4000);
    let file = path.display();
    for second in [
        resume.clone(),
        format!("{LONG_SWEEP} -o {file}"),
        format!("{SWEEP} -o {file}"),
        format!("{SWEEP} --force -o {file}"),
        format!("{BRANCH} --force -o {file}"),
        format!("{RUN} --force -o {file}"),
        format!("law -q --force --format table -o {file}"),
    ] {
        refused(&second, "another run is writing to it");
    }
    first.kill().expect("SIGKILL");
    first.wait().expect("it ends");
    // Every row is there once, in the order of the grid.
    let text = fs::read_to_string(&path).expect("written");
    let whole = &text[..=text.rfind('\n').expect("lines")];
    let table = csv(whole);
    for (k, row) in table[1..].iter().enumerate() {
        let driving: f64 = row[0].parse().expect("a number");
        let expected = 0.14 + 0.36 * (k % 2000) as f64 / 1999.0;
        assert!((driving - expected).abs() < 1e-9, "row {k}: {row:?}");
    }
    // The end of the first frees the file.
    refused(&format!("{SWEEP} -o {file}"), "it holds an unfinished run");
    done(&format!("{SWEEP} --force -o {file}"));
    // Two that begin at once: one of them writes, the other one is refused.
    let path = place.join("both.csv");
    let both = [0, 1].map(|_| begin(&format!("{BRANCH} --step-limit 0.02 -o {}", path.display())));
    let codes = both.map(|child| child.wait_with_output().expect("it ends").status.code());
    assert!(codes.contains(&Some(0)), "{codes:?}");
    assert!(
        codes.iter().all(|code| matches!(code, Some(0 | 2))),
        "{codes:?}"
    );
    let alone = place.join("alone.csv");
    done(&format!(
        "{BRANCH} --step-limit 0.02 -o {}",
        alone.display()
    ));
    assert!(read(&path) == read(&alone) && read(&special(&path)) == read(&special(&alone)));
}

/// Changes of the lines of a file that are no end of it, with what must be said of each.
fn damages(text: &str) -> Vec<(String, String)> {
    let lines: Vec<&str> = text.lines().collect();
    let head = lines
        .iter()
        .take_while(|line| line.starts_with('#'))
        .count()
        + 1;
    let at = head + (lines.len() - head) / 2;
    let with = |change: &dyn Fn(&mut Vec<String>)| {
        let mut lines: Vec<String> = lines.iter().map(|line| line.to_string()).collect();
        change(&mut lines);
        lines.join("\n") + "\n"
    };
    let damaged = |line: usize, why: &str| format!("line {line} is damaged: {why}");
    let changed = "it is not as it was written";
    let digit = |line: &str| {
        let first = line
            .find(|c: char| ('1'..='8').contains(&c))
            .expect("a digit");
        let mut line = line.to_owned();
        line.replace_range(first..=first, "9");
        line
    };
    vec![
        (
            with(&|lines| lines[at] = digit(&lines[at])),
            damaged(at + 1, changed),
        ),
        (
            with(&|lines| lines[at] = lines[at].split(',').take(3).collect::<Vec<_>>().join(",")),
            damaged(at + 1, changed),
        ),
        (
            with(&|lines| drop(lines.remove(at))),
            damaged(at + 1, "a row is missing before it"),
        ),
        (
            with(&|lines| drop(lines.drain(at - 1..at + 1))),
            damaged(at, "2 rows are missing before it"),
        ),
        (
            with(&|lines| lines.insert(at, lines[at - 1].clone())),
            damaged(at + 1, "it is a row that stands before it already"),
        ),
        (
            with(&|lines| lines.swap(at, at + 1)),
            damaged(at + 1, "a row is missing before it"),
        ),
        (
            with(&|lines| lines.insert(at, "nonsense".into())),
            damaged(at + 1, changed),
        ),
        (
            with(&|lines| lines.insert(at, String::new())),
            damaged(at + 1, changed),
        ),
        (
            text.replacen("# twinslip ", "# twinslip 0.0.", 1),
            "it was written by twinslip 0.0.".into(),
        ),
        (
            text.replacen("healing_time = 100", "healing_time = 101", 1),
            "it was written with healing_time = 101".into(),
        ),
    ]
}

#[test]
fn damage_is_named_by_its_line() {
    let place = folder("durable-damage");
    let path = place.join("rows.csv");
    for command in [BRANCH, LOCUS, SWEEP] {
        done(&format!("{command} --force -o {}", path.display()));
        let resume = format!("{command} --resume {}", path.display());
        let whole = fs::read_to_string(&path).expect("written");
        // Whether it was finished makes no difference.
        let place = whole.find("# rows: ").expect("a remark") + 8;
        let mut unfinished = whole.clone();
        unfinished.replace_range(place..place + 32, &format!("{:<32}", "unfinished"));
        for text in [&whole, &unfinished] {
            for (damaged, sentence) in damages(text) {
                fs::write(&path, &damaged).expect("written");
                refused(&resume, &sentence);
                assert_eq!(fs::read_to_string(&path).expect("there"), damaged);
            }
            // The end of a file may be missing: that is computed again.
            for part in [whole.len() - 1, whole.len() * 2 / 3] {
                fs::write(&path, &text[..part]).expect("written");
                done(&resume);
                assert!(
                    fs::read_to_string(&path).expect("there") == whole,
                    "{command} {part}"
                );
            }
        }
        if command == SWEEP {
            continue;
        }
        let points = special(&path);
        let whole_points = fs::read_to_string(&points).expect("written");
        for (damaged, sentence) in damages(&whole_points) {
            fs::write(&points, damaged).expect("written");
            refused(&resume, &sentence);
        }
        let lines: Vec<&str> = whole_points.lines().collect();
        let cut = lines[..lines.len() - 3].join("\n") + "\n";
        fs::write(&points, cut).expect("written");
        refused(&resume, "special points, but");
        // Without any of them all is computed again.
        fs::remove_file(&points).expect("removed");
        done(&resume);
        assert!(fs::read_to_string(&path).expect("there") == whole);
        assert!(
            read(&points) == {
                fs::write(&points, &whole_points).expect("written");
                read(&points)
            }
        );
    }
}

#[test]
fn merged_parts_are_checked() {
    let place = folder("durable-merge");
    let parts = [1, 2].map(|i| place.join(format!("{i}.csv")));
    for (i, part) in parts.iter().enumerate() {
        done(&format!(
            "{SWEEP} --shard {}/2 -o {}",
            i + 1,
            part.display()
        ));
    }
    let merge = format!(
        "merge -q {} {} -o {}",
        parts[0].display(),
        parts[1].display(),
        place.join("merged.csv").display()
    );
    done(&merge);
    let whole = fs::read_to_string(&parts[1]).expect("written");
    let lines: Vec<&str> = whole.lines().collect();
    let mut cut = lines.clone();
    let short = lines[12].split(',').take(3).collect::<Vec<_>>().join(",");
    cut[12] = &short;
    fs::write(&parts[1], cut.join("\n") + "\n").expect("written");
    refused(&merge, "line 13 is damaged: it is not as it was written");
}

/// The file of special points: what it holds, and that it is told in JSON too.
#[test]
fn special_points_stand_beside_the_rows() {
    let place = folder("durable-special");
    let path = place.join("orbits.csv");
    let command = "branch orbits -q --stiffness 0.14 --from 0.06 --to 0.2 --at 0.1";
    done(&format!("{command} -o {}", path.display()));
    let table = csv(&fs::read_to_string(place.join("orbits.special.csv")).expect("written"));
    let columns = [
        "label",
        "name",
        "branch",
        "symmetry",
        "driving",
        "driving_uncertainty",
        "stiffness",
        "stiffness_uncertainty",
        "period",
        "period_uncertainty",
        "criticality",
        "coefficient",
    ];
    assert_eq!(table[0][..columns.len()], columns);
    assert_eq!(table[0].last().map(String::as_str), Some("row_check"));
    let made = object(&command.replace(" -q", ""));
    let listed = made["result"]["special"].as_array().expect("a list");
    assert_eq!(table.len() - 1, listed.len());
    for (line, one) in table[1..].iter().zip(listed) {
        assert_eq!(line[0], one["label"].as_str().expect("a label"));
        assert_eq!(line[2].parse().ok(), one["branch"].as_u64());
        assert_eq!(line[3], one["symmetry"].as_str().expect("a word"));
        assert_eq!(line[4].parse().ok(), one["driving"]["value"].as_f64());
        assert_eq!(line[5].parse().ok(), one["driving"]["uncertainty"].as_f64());
        assert_eq!(line[10], one["criticality"].as_str().unwrap_or_default());
        assert_eq!(line[11].parse().ok(), one["coefficient"].as_f64());
    }
    let symmetries: std::collections::BTreeSet<&str> =
        table[1..].iter().map(|line| line[3].as_str()).collect();
    assert_eq!(
        symmetries.into_iter().collect::<Vec<_>>(),
        ["asymmetric", "symmetric"]
    );
    // Rows know it as well, and agree.
    let rows = csv(&fs::read_to_string(&path).expect("written"));
    let at = |name: &str| rows[0].iter().position(|one| one == name).expect("it");
    for line in &table[1..] {
        let same = |row: &&Vec<String>| row[at("branch")] == line[2];
        assert!(
            rows[1..]
                .iter()
                .filter(same)
                .all(|row| row[at("symmetry")] == line[3])
        );
    }
}

#[test]
fn output_that_is_deleted_is_told_at_the_end() {
    let place = folder("durable-deleted");
    let path = place.join("hopf.csv");
    for file in [path.clone(), special(&path)] {
        let child = begin(&format!(
            "locus hopf -q --step-limit 0.05 -o {}",
            path.display()
        ));
        grown(&path, 3000);
        fs::remove_file(&file).expect("it is there");
        let ended = child.wait_with_output().expect("it ends");
        let said = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(2), "{said}");
        assert!(said.contains("it was deleted or replaced"), "{said}");
        for name in contents(&place) {
            fs::remove_file(place.join(name)).expect("removed");
        }
    }
}

/// A limit on the size of files stands for a full disk; the system's signal on it ends nothing.
#[test]
fn a_file_that_grows_too_large_leaves_nothing_beside_it() {
    let place = folder("durable-large");
    let path = place.join("run.json");
    let program = env!("CARGO_BIN_EXE_twinslip");
    let script = format!("ulimit -f 4; exec {program} {RUN} -o {}", path.display());
    let ended = Command::new("bash").args(["-c", &script]).output();
    let ended = ended.expect("bash");
    let err = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(2), "{err}");
    assert!(
        err.contains("cannot write") && err.contains("large"),
        "{err}"
    );
    assert_eq!(contents(&place), [""; 0]);
    // Rows that were written stay, and no part of one.
    for command in [
        &format!("{RUN} --points 200"),
        "law --law slip",
        "branch equilibria --stiffness 0.1 --from 0.05 --to 1",
    ] {
        let path = place.join("rows.csv");
        let script = format!(
            "ulimit -f 4; exec {program} {command} -o {}",
            path.display()
        );
        let ended = Command::new("bash").args(["-c", &script]).output();
        assert_eq!(ended.expect("bash").status.code(), Some(2), "{command}");
        for name in contents(&place) {
            let text = fs::read_to_string(place.join(&name)).expect("rows");
            assert!(text.ends_with('\n'), "{command}: {name}: {text}");
            fs::remove_file(place.join(name)).expect("removed");
        }
    }
}

/// Nobody reads what is said: the run goes on.
#[test]
fn messages_that_cannot_be_written_are_no_error() {
    let program = env!("CARGO_BIN_EXE_twinslip");
    let commands = [
        "law --points 9",
        "integrate --driving 10 --stiffness 0.14 --until 12",
        "equilibria --driving 10 --stiffness 0.14",
        "orbit --driving 0.2 --stiffness 0.14 --crosscheck none",
        "section --interfaces 1 --driving 1 --stiffness 0.1 --skip 50 --returns 9",
        "branch equilibria --stiffness 0.14",
        "locus pitchfork",
        "sweep --driving 0.14:0.5:2 --stiffness 0.3:0.5:2",
    ];
    for command in commands {
        for to in ["/dev/full", ">(exec true)"] {
            let script = format!("exec {program} {command} --explain 2> {to}");
            let ended = Command::new("bash").args(["-c", &script]).output();
            let ended = ended.expect("bash");
            assert_eq!(ended.status.code(), Some(0), "{command} 2> {to}");
            assert!(!ended.stdout.is_empty(), "{command} 2> {to}");
        }
    }
    let script = format!("exec {program} law --law none 2> /dev/full");
    let ended = Command::new("bash").args(["-c", &script]).output();
    assert_eq!(ended.expect("bash").status.code(), Some(2));
}

#[test]
fn what_is_read_and_echoed_is_bounded() {
    let place = folder("durable-scene");
    refused("run /dev/zero", "it is longer than");
    let path = place.join("long.toml");
    let scene = |law: &str| format!("command = \"law\"\nlaw = \"{law}\"\n");
    fs::write(&path, scene(&"x".repeat(50_000_000))).expect("written");
    refused(&format!("run {}", path.display()), "it is longer than");
    for key in ["law = ", "points = ", "nonsense = ", "command = "] {
        let text = format!("{}\n", scene("spinodal")).replacen("command = ", key, 1);
        let text = text.replacen(
            "law = \"spinodal\"",
            &format!("{key}\"{}\"", "x".repeat(100_000)),
            1,
        );
        fs::write(&path, text).expect("written");
        let ended = twinslip(&format!("run {}", path.display()));
        assert_eq!(ended.code, 2);
        assert!(ended.err.len() < 3000, "{} bytes are said", ended.err.len());
    }
    let ended = twinslip(&format!("law --law {}", "x".repeat(100_000)));
    assert_eq!(ended.code, 2);
    assert!(ended.err.len() < 3000, "{} bytes are said", ended.err.len());
    let ended = twinslip(&format!("law --points {}", "x".repeat(100_000)));
    assert_eq!(ended.code, 2);
    assert!(ended.err.len() < 3000, "{} bytes are said", ended.err.len());
}

/// Ctrl-C in the midst of what tells nothing on its way.
#[test]
fn an_interrupt_says_what_is_kept() {
    let place = folder("durable-interrupt");
    let rows = place.join("torus.csv");
    for (arguments, kept) in [
        (
            format!("figure 6 --out {}", place.display()),
            "no file was written",
        ),
        (
            format!("reproduce --only fig06 --out {}", place.display()),
            "what was finished is in",
        ),
        (
            format!(
                "locus torus --stiffness-range 0.02,0.3 -o {}",
                rows.display()
            ),
            "go on with --resume",
        ),
        (
            "integrate --driving 10 --stiffness 0.14 --until 1e9 --format csv".to_owned(),
            "interrupted",
        ),
    ] {
        let child = begin(&arguments);
        std::thread::sleep(Duration::from_millis(700));
        let pid = child.id().to_string();
        let sent = Command::new("kill").args(["-INT", &pid]).status();
        assert!(sent.expect("kill").success());
        let ended = child.wait_with_output().expect("it ends");
        let said = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(130), "{arguments}: {said}");
        assert!(
            said.contains("interrupted") && said.contains(kept),
            "{arguments}: {said}"
        );
    }
    let temporary = |name: &String| name.ends_with(".tmp");
    assert!(!contents(&place).iter().any(temporary));
}
