//! `sweep` and `merge` as a user meets them: the same bytes however a sweep is run, killed, gone on with or shared out.

use crate::command;
use command::{csv, folder, object, run, twinslip};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// About the Hopf points: rest, and quick cycles.
const GRID: &str = "sweep --driving 0.14:0.5:6 --stiffness 0.3:0.5:4";

fn sweep(more: &str) -> command::Ended {
    twinslip(&format!("{GRID} -q {more}"))
}

/// The sweep of one run, to compare with.
fn whole(place: &Path, more: &str) -> String {
    let path = place.join("whole.csv");
    let ended = sweep(&format!("{more} -o {}", path.display()));
    assert_eq!((ended.code, ended.err.as_str()), (0, ""));
    fs::read_to_string(path).expect("written")
}

fn refused(arguments: &str, sentence: &str) {
    let ended = twinslip(arguments);
    assert_eq!(ended.code, 2, "{arguments}: {}", ended.err);
    assert_eq!(ended.out, "", "{arguments}");
    assert!(
        ended.err.starts_with("error: ") && ended.err.contains(sentence),
        "{arguments}: {}",
        ended.err
    );
    assert_eq!(ended.err.lines().count(), 1, "{arguments}: {}", ended.err);
}

#[test]
fn rows_are_those_of_the_grid_in_its_order_in_all_formats() {
    let ended = twinslip(&format!("{GRID} --format csv"));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let table = csv(&ended.out);
    assert_eq!(
        table[0],
        [
            "driving",
            "stiffness",
            "regime",
            "symmetry",
            "period",
            "stress_min",
            "stress_max",
            "lyapunov_max",
            "lyapunov_max_uncertainty",
            "returns",
            "period_of_orbit",
            "start_stress",
            "start_state_1",
            "start_state_2",
            "note",
            "row_check"
        ]
    );
    assert_eq!(table.len(), 1 + 24);
    for (k, row) in table[1..].iter().enumerate() {
        let (i, j) = ((k % 6) as f64, (k / 6) as f64);
        let near = |cell: &str, x: f64| (cell.parse::<f64>().expect("a number") - x).abs() < 1e-12;
        assert!(near(&row[0], 0.14 + 0.072 * i) && near(&row[1], 0.3 + 0.2 / 3.0 * j));
    }
    assert!(ended.err.contains("24 points in ") && ended.err.contains(" a second: "));
    // The first lines are those of any run of it, and can be typed.
    let typed = "# command: twinslip sweep --driving 0.14:0.5:6 --stiffness 0.3:0.5:4\n";
    assert!(ended.out.contains(typed), "{}", ended.out);
    let made = object(GRID);
    let rows = made["result"]["rows"].as_array().expect("rows");
    for (row, line) in rows.iter().zip(&table[1..]) {
        assert_eq!(row["driving"].as_f64(), line[0].parse().ok());
        assert_eq!(row["regime"], *line[2]);
        let fields = ["/lyapunov_max/value", "/lyapunov_max/uncertainty"];
        for (field, cell) in fields.iter().zip(&line[7..]) {
            let value = row.pointer(field).and_then(|x| x.as_f64());
            assert_eq!(value, cell.parse().ok());
        }
    }
    let regimes = made["result"]["regimes"].as_object().expect("counts");
    let sum: u64 = regimes.values().filter_map(|n| n.as_u64()).sum();
    assert_eq!((sum, regimes.len()), (24, 5));
    let table = sweep("--format table");
    let line = table.out.lines().next().expect("names");
    assert!(
        line.contains("regime") && !line.contains("start_"),
        "{line}"
    );
}

#[test]
fn bytes_depend_on_neither_threads_nor_words() {
    let place = folder("sweep-threads");
    for more in ["", "--follow", "--starts 2 --seed 7"] {
        let one = whole(&place, &format!("{more} --threads 1"));
        assert_eq!(one, whole(&place, &format!("{more} --threads 2")), "{more}");
    }
    // The same sweep in other words.
    let path = place.join("other.csv");
    let other = format!(
        "sweep -q --law spinodal --stiffness 0.30:5e-1:4 --driving 1.4e-1:0.5:6 --seed 1 -o {}",
        path.display()
    );
    assert_eq!(twinslip(&other).code, 0);
    assert_eq!(
        fs::read_to_string(path).expect("written"),
        whole(&place, "")
    );
}

/// Whatever the instructions, the regimes are the same, and the numbers to what they claim.
#[test]
fn vector_instructions_change_no_verdict() {
    let with = |vectors: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_twinslip"))
            .args(GRID.split_whitespace())
            .args(["-q", "--format", "csv"])
            .env("TWINSLIP_VECTORS", vectors)
            .output()
            .expect("the program starts");
        let words = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
        (
            output.status.code(),
            words(output.stdout),
            words(output.stderr),
        )
    };
    let (code, out, _) = with("avx512");
    assert_eq!(code, Some(0));
    let all = csv(&out);
    for vectors in ["avx2", "none"] {
        let (code, out, _) = with(vectors);
        assert_eq!(code, Some(0), "{vectors}");
        for (row, other) in all[1..].iter().zip(&csv(&out)[1..]) {
            assert_eq!(row[..4], other[..4], "{vectors}");
            let number = |cell: &str| cell.parse::<f64>().ok();
            for (x, y) in row[4..7].iter().zip(&other[4..7]) {
                let (x, y) = (number(x), number(y));
                let apart = x.zip(y).map_or(0.0, |(x, y)| (x - y).abs() / x.abs());
                assert!(
                    x.is_some() == y.is_some() && apart < 1e-7,
                    "{vectors}: {row:?} {other:?}"
                );
            }
        }
    }
    let (code, out, err) = with("sse");
    assert_eq!((code, out.as_str()), (Some(2), ""));
    assert_eq!(
        err,
        "error: TWINSLIP_VECTORS is sse, but must be avx512, avx2 or none\n"
    );
}

/// Cut off at any byte, a file is gone on with and ends as if it had never been interrupted.
#[test]
fn a_torn_file_is_gone_on_with() {
    let place = folder("sweep-torn");
    let torn = place.join("torn.csv");
    for more in ["", "--follow", "--shard 2/3"] {
        let whole = whole(&place, more);
        let rows = whole.find(",row_check\n").expect("columns") + 10;
        for part in [
            0,
            9,
            rows - 5,
            rows + 1,
            rows + 30,
            (rows + whole.len()) / 2,
            whole.len() - 1,
            whole.len(),
        ] {
            fs::write(&torn, &whole[..part]).expect("written");
            let ended = sweep(&format!("{more} --resume {}", torn.display()));
            assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{more} {part}");
            let text = fs::read_to_string(&torn).expect("written");
            assert!(text == whole, "{more}: {part} bytes were there");
        }
    }
    // A file that is not there is begun, and -o may say so too.
    let absent = place.join("absent.csv");
    let path = absent.display();
    assert_eq!(sweep(&format!("--resume {path} -o {path}")).code, 0);
    assert_eq!(
        fs::read_to_string(&absent).expect("written"),
        whole(&place, "")
    );
}

/// kill -9 at random moments: each time the next run goes on, and in the end no row is lost or doubled.
#[cfg(unix)]
#[test]
fn a_killed_sweep_ends_in_the_same_bytes() {
    const KILLS: usize = 20;
    let place = folder("sweep-killed");
    let grid = "sweep -q --driving 0.14:0.5:20 --stiffness 0.34:0.5:20";
    let whole = place.join("whole.csv");
    let begun = std::time::Instant::now();
    // Two of its points are undecided.
    let code = twinslip(&format!("{grid} -o {}", whole.display())).code;
    assert_eq!(code, 3);
    // Where a kill falls is chance, and depends on the machine: what must hold does not.
    let span = begun.elapsed().as_micros() as u64;
    let path = place.join("killed.csv");
    let resume = format!("{grid} --resume {}", path.display());
    let mut random = std::hash::BuildHasher::hash_one(&std::hash::RandomState::new(), 0u8);
    let mut lengths = Vec::new();
    for kill in 0..KILLS {
        random = random
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        let threads = 1 + kill % 2;
        let mut child = Command::new(env!("CARGO_BIN_EXE_twinslip"))
            .args(resume.split(' '))
            .args(["--threads", &threads.to_string()])
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        std::thread::sleep(Duration::from_micros((random >> 33) % (span / 4 + 1)));
        child.kill().expect("SIGKILL");
        child.wait().expect("it ends");
        lengths.push(fs::metadata(&path).map_or(0, |data| data.len()));
    }
    let ended = twinslip(&resume);
    assert_eq!((ended.code, ended.err.as_str()), (code, ""));
    let [whole, killed] = [whole, path].map(|path| fs::read(path).expect("written"));
    assert!(
        whole == killed,
        "other bytes after {lengths:?} of {}",
        whole.len()
    );
    assert!(lengths.is_sorted(), "rows were lost: {lengths:?}");
}

#[test]
fn files_of_other_sweeps_are_refused_and_stay() {
    let place = folder("sweep-other");
    let path = place.join("whole.csv");
    let whole = whole(&place, "");
    let resume = format!("--resume {}", path.display());
    for (arguments, sentence) in [
        (
            "sweep --driving 0.14:0.5:7 --stiffness 0.3:0.5:4",
            "it was written with driving = 0.14:0.5:6, but this run has driving = 0.14:0.5:7",
        ),
        (
            "sweep --driving 0.14:0.5:6 --stiffness 0.3:0.5:4 --law bounded",
            "it was written with law = spinodal, but this run has law = bounded",
        ),
        (
            "sweep --driving 0.14:0.5:6 --stiffness 0.3:0.5:4 --seed 2 --starts 2",
            "it was written with ",
        ),
        (
            "sweep --driving 0.14:0.5:6 --stiffness 0.3:0.5:4 --shard 1/2",
            "it is of the whole sweep, but this run is of the part 1/2",
        ),
        (
            "branch equilibria --stiffness 0.14",
            "its columns are not those of this command",
        ),
        (
            "sweep --driving 0.14:0.5:6 --stiffness 0.3:0.5:4 --format json",
            "only CSV can be gone on with",
        ),
        (
            "sweep --driving 0.14:0.5:6 --stiffness 0.3:0.5:4 -o other.csv",
            "leave out --output",
        ),
    ] {
        refused(&format!("{arguments} {resume}"), sentence);
    }
    assert_eq!(fs::read_to_string(&path).expect("there"), whole);
    // A row that is missing in the midst, another program, and no CSV at all.
    let rows: Vec<&str> = whole.lines().collect();
    let damaged = [&rows[..rows.len() - 9], &rows[rows.len() - 8..]].concat();
    let damaged = damaged.join("\n") + "\n";
    let older = whole.replacen("# twinslip ", "# twinslip 0.0.", 1);
    for (text, sentence) in [
        (
            damaged.as_str(),
            "line 23 is damaged: a row is missing before it",
        ),
        (&older, "it was written by twinslip 0.0."),
        ("a,b\n1,2\n", "it is not the CSV of a sweep"),
        (
            &format!("{whole}{}\n", rows[rows.len() - 1]),
            "it has more rows than the sweep",
        ),
    ] {
        fs::write(&path, text).expect("written");
        refused(&format!("{GRID} {resume}"), sentence);
        assert_eq!(fs::read_to_string(&path).expect("there"), text);
    }
}

#[test]
fn parts_are_merged_to_the_bytes_of_one_run() {
    let place = folder("sweep-parts");
    let name = |n: usize| place.join(format!("{n}.csv")).display().to_string();
    for more in ["", "--follow --starts 2"] {
        let whole = whole(&place, more);
        for part in 1..=3 {
            let ended = sweep(&format!("{more} --shard {part}/3 -o {}", name(part)));
            assert_eq!(ended.code, 0, "{}", ended.err);
        }
        let out = place.join("merged.csv").display().to_string();
        let ended = run(&["merge", &name(3), &name(1), &name(2), "-o", &out]);
        assert_eq!(ended.code, 0, "{}", ended.err);
        let rows = csv(&whole).len() - 1;
        assert!(ended.err.contains(&format!("{rows} rows of 3 parts")));
        assert!(fs::read_to_string(&out).expect("merged") == whole, "{more}");
    }
    let merged = run(&["merge", &name(1), &name(2), &name(3), "-q", "-o", "-"]);
    assert_eq!((merged.code, merged.err.as_str()), (0, ""));
    let out = place.join("refused.csv").display().to_string();
    let merge = |parts: &[&str]| format!("merge {} -o {out}", parts.join(" "));
    refused(&merge(&[&name(1), &name(3)]), "the parts 2/3 are missing");
    refused(
        &merge(&[&name(1), &name(2), &name(1)]),
        "are both the part 1/3",
    );
    let other = name(4);
    let of_other = |grid: &str, shard: &str| {
        let ended = twinslip(&format!("sweep {grid} -q --shard {shard} -o {other}"));
        assert_eq!(ended.code, 0, "{}", ended.err);
    };
    of_other(
        "--driving 0.14:0.5:6 --stiffness 0.3:0.5:5 --follow --starts 2",
        "3/3",
    );
    let mixed = merge(&[&name(1), &name(2), &other]);
    refused(&mixed, "are of different sweeps");
    of_other(
        "--driving 0.14:0.5:6 --stiffness 0.3:0.5:4 --follow --starts 2",
        "3/4",
    );
    refused(&mixed, "are of different sweeps");
    let path = place.join("whole.csv").display().to_string();
    refused(
        &merge(&[&name(1), &path]),
        "it is a whole sweep, not a part of one",
    );
    refused(&merge(&["/dev/null"]), "it is not the CSV of a sweep");
    refused(&merge(&[&format!("{}.none", name(1))]), "cannot read");
    refused(
        &format!("merge {} {} {} -o {}", name(1), name(2), name(3), name(1)),
        "both a part and the whole",
    );
    let text = fs::read_to_string(name(2)).expect("a part");
    fs::write(name(2), &text[..text.len() - 3]).expect("written");
    refused(
        &merge(&[&name(1), &name(2), &name(3)]),
        "it ends after 0 of 12 rows; finish it with --resume",
    );
    assert!(!Path::new(&out).exists());
}

#[test]
fn wrong_grids_are_refused_in_one_sentence() {
    let plane = |driving: &str| format!("sweep --driving {driving} --stiffness 0.14");
    for (arguments, sentence) in [
        (
            "sweep --stiffness 0.14".to_owned(),
            "--driving A:B:N is missing",
        ),
        (
            "sweep --driving 0.1".to_owned(),
            "--stiffness A:B:N is missing",
        ),
        (plane("0.1:0.2"), "--driving"),
        (plane("0.1:0.2:x"), "--driving"),
        (plane("0.1:0.2:0"), "driving"),
        (plane("0:0.2:5"), "driving"),
        (plane("-1:0.2:5log"), "driving"),
        (
            plane("-1"),
            "driving is -1, but must be positive and finite",
        ),
        (plane("nan:1:5"), "driving"),
        (plane("0.2:0.1:5"), "driving"),
        (plane("1:2:99999999999999999999"), "driving"),
        (plane("0.1 --starts 0"), "starts is 0, but must be"),
        (
            plane("0.1 --threads 0"),
            "threads is 0, but must be at least 1",
        ),
        (
            plane("0.1 --max-returns 1"),
            "max-returns is 1, but must be",
        ),
        (plane("0.1 --rtol 2"), "rtol is 2, but must be"),
        (plane("0.1 --interfaces 1"), "sweep needs two interfaces"),
        (plane("0.1 --shard 0/3"), "shard is 0/3, but must be I/N"),
        (plane("0.1 --shard 4/3"), "shard is 4/3, but must be I/N"),
        (plane("0.1 --shard 2"), "shard is 2, but must be I/N"),
        (plane("0.1 --plot map.pdf"), "map.pdf"),
        (plane("0.1 --resume -"), "only a file can be gone on with"),
        (
            plane("0.1:0.2:2 --basin --state-1 0.1:0.2:2 --state-2 0.1:0.2:2"),
            "with --basin --driving must be a single value, not 0.1:0.2:2",
        ),
    ] {
        refused(&arguments, sentence);
    }
}

#[test]
fn a_basin_has_a_row_for_each_start() {
    let ended = twinslip(
        "sweep --basin --driving 0.5 --stiffness 0.4 --state-1 0.01:1:3log --state-2 0.1:0.9:2 --format csv -q",
    );
    assert_eq!(ended.code, 0, "{}", ended.err);
    let table = csv(&ended.out);
    let at = |name: &str| table[0].iter().position(|one| one == name).expect("it");
    let (state_1, state_2) = (at("start_state_1"), at("start_state_2"));
    let number = |row: &[String], at: usize| row[at].parse::<f64>().expect("a number");
    let starts: Vec<(f64, f64)> = table[1..]
        .iter()
        .map(|row| (number(row, state_1), number(row, state_2)))
        .collect();
    let expected = [0.1, 0.9]
        .map(|b| [0.01, 0.1, 1.0].map(|a| (a, b)))
        .concat();
    assert_eq!(starts.len(), expected.len());
    for (found, expected) in starts.iter().zip(expected) {
        let off = (found.0 / expected.0 - 1.0).abs() + (found.1 / expected.1 - 1.0).abs();
        assert!(off < 1e-12, "{found:?} is not {expected:?}");
    }
}

/// One undecided row of many is enough, in one run or in parts, in all formats, and however the file came to be.
#[test]
fn an_undecided_row_has_its_own_exit_code() {
    // A step is no run: each point is a row with its reason.
    let ended = sweep("--max-steps 1 --format csv");
    assert_eq!(ended.code, 3, "{}", ended.err);
    let table = csv(&ended.out);
    assert!(table[1..].iter().all(|row| row[2] == "undecided"));
    assert!(table[1..].iter().all(|row| !row[14].is_empty()));
    // Points at rest are told without many steps, cycles are not.
    let place = folder("sweep-undecided");
    let path = place.join("some.csv").display().to_string();
    let some = format!("{GRID} -q --max-steps 300");
    let ended = twinslip(&format!("{some} -o {path}"));
    assert_eq!((ended.code, ended.err.as_str()), (3, ""));
    let text = fs::read_to_string(&path).expect("rows");
    let undecided = csv(&text)[1..]
        .iter()
        .filter(|row| row[2] == "undecided")
        .count();
    assert!(undecided > 0 && undecided < 24, "{text}");
    assert_eq!(twinslip(&format!("{some} --format json")).code, 3);
    assert_eq!(twinslip(&format!("{some} --format table")).code, 3);
    // There is nothing left to do, and it still is so.
    assert_eq!(twinslip(&format!("{some} --resume {path}")).code, 3);
    let parts = [1, 2].map(|n| place.join(format!("{n}.csv")).display().to_string());
    for (n, part) in parts.iter().enumerate() {
        twinslip(&format!("{some} --shard {}/2 -o {part}", n + 1));
    }
    let merged = place.join("merged.csv").display().to_string();
    let ended = run(&["merge", &parts[0], &parts[1], "-o", &merged]);
    assert_eq!(ended.code, 3, "{}", ended.err);
    let said = format!("24 rows of 2 parts, {undecided} of them undecided");
    assert!(ended.err.contains(&said), "{}", ended.err);
    assert_eq!(fs::read_to_string(&merged).expect("merged"), text);
}

/// No more threads are started than there are points, and none that no machine has.
#[test]
fn threads_are_bounded() {
    let few = "sweep -q --driving 0.4:0.5:2 --stiffness 0.4:0.5:2 --format csv";
    let one = twinslip(&format!("{few} --threads 1"));
    let many = twinslip(&format!("{few} --threads 1000"));
    assert_eq!((one.code, &one.out), (many.code, &many.out));
    refused(
        &format!("{few} --threads 2000"),
        "threads is 2000, but must be at least 1 and at most 1024",
    );
}

/// What a file says of itself is checked before anything is made of it.
#[test]
fn parts_that_a_file_makes_up_are_refused() {
    let place = folder("sweep-made-up");
    let whole = whole(&place, "");
    let path = place.join("part.csv").display().to_string();
    let out = place.join("out.csv").display().to_string();
    let told = |shard: &str| {
        let text = whole.replacen("\ndriving,", &format!("\n# shard: {shard}\ndriving,"), 1);
        fs::write(&path, text).expect("written");
        format!("merge {path} -o {out}")
    };
    refused(&told("1/1000000000"), "N at most 1000000");
    refused(&told("1/18446744073709551615"), "N at most 1000000");
    refused(
        &told("1/1000000"),
        "10/1000000, 11/1000000 and 999989 others are missing",
    );
    fs::write(&path, "# x\n".repeat(100_000)).expect("written");
    refused(&format!("merge {path} -o {out}"), "too many remarks");
    refused(&format!("{GRID} --shard 1/1000000000"), "N at most 1000000");
    assert!(!Path::new(&out).exists());
}

/// Curves over a map are kept, and computed again where what is kept is not whole.
#[test]
fn curves_over_a_map_are_kept_and_never_trusted_blindly() {
    let place = folder("sweep-curves");
    let cache = place.join("cache");
    let picture = place.join("map.svg");
    let draw = |cache: &str, grid: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_twinslip"))
            .args(format!("sweep {grid} --curves pitchfork,hopf").split(' '))
            .args(["-o".as_ref(), place.join("map.csv").as_os_str()])
            .args(["--plot".as_ref(), picture.as_os_str()])
            .env("TWINSLIP_CACHE", cache)
            .output()
            .expect("the program starts");
        let said = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(0), "{said}");
        fs::remove_file(place.join("map.csv")).expect("rows");
        (said, fs::read_to_string(&picture).expect("a picture"))
    };
    const WINDOW: &str = "--driving 0.04:0.07:2 --stiffness 0.13:0.15:2";
    let folder = cache.display().to_string();
    let kept = |n: usize| format!("{n} of them kept from before");
    let (said, first) = draw(&folder, WINDOW);
    assert!(
        said.contains("2 curves") && !said.contains("kept"),
        "{said}"
    );
    let files = || {
        let mut names = command::contents(&cache);
        names.sort();
        names.into_iter().map(|name| cache.join(name))
    };
    let whole: Vec<(_, String)> = files()
        .map(|path| (path.clone(), fs::read_to_string(path).expect("text")))
        .collect();
    assert_eq!(whole.len(), 2);
    let (said, again) = draw(&folder, WINDOW);
    assert!(said.contains(&kept(2)) && again == first, "{said}");
    // Another window has other curves.
    let (said, _) = draw(&folder, "--driving 0.03:0.07:2 --stiffness 0.13:0.15:2");
    assert!(!said.contains("kept"), "{said}");
    let (path, text) = &whole[0];
    let last = text.rfind(|c: char| c.is_ascii_digit()).expect("a digit");
    let digit = if text.as_bytes()[last] == b'7' {
        "3"
    } else {
        "7"
    };
    let changed = format!("{}{digit}{}", &text[..last], &text[last + 1..]);
    let other = whole[1].1.as_str();
    for damaged in [&changed, &text[..text.len() / 2], "", "\u{0}", other] {
        fs::write(path, damaged).expect("written");
        let (said, again) = draw(&folder, WINDOW);
        assert!(said.contains(&kept(1)) && again == first, "{said}");
        assert_eq!(&fs::read_to_string(path).expect("text"), text);
    }
    // Where there is no place for them, or none that can be written, they are computed.
    let before = command::contents(&place).len();
    for nowhere in ["", "/dev/null/none"] {
        let (said, again) = draw(nowhere, WINDOW);
        assert!(!said.contains("kept") && again == first, "{said}");
    }
    assert_eq!(command::contents(&place).len(), before);
    let explained = twinslip(&format!(
        "sweep {WINDOW} --curves pitchfork,hopf --plot {} -o {} --explain",
        picture.display(),
        place.join("other.csv").display()
    ));
    assert!(
        explained
            .err
            .contains("pitchfork, hopf, over the window of the map"),
        "{}",
        explained.err
    );
}

/// A limit on the size of files stands for a full disk.
#[test]
fn a_full_disk_is_one_error_and_what_is_whole_stays() {
    let place = folder("sweep-full");
    let path = place.join("full.csv");
    let grid = "sweep -q --driving 0.14:0.5:10 --stiffness 0.3:0.5:6";
    let script = format!(
        "trap '' XFSZ; ulimit -f 4; exec {} {grid} -o {}",
        env!("CARGO_BIN_EXE_twinslip"),
        path.display()
    );
    let ended = Command::new("bash")
        .args(["-c", &script])
        .output()
        .expect("bash");
    let err = String::from_utf8(ended.stderr).expect("UTF-8");
    assert_eq!(ended.status.code(), Some(2), "{err}");
    assert_eq!(err.lines().count(), 1, "{err}");
    assert!(
        err.contains("cannot write") && err.contains("large"),
        "{err}"
    );
    // To the last row that is whole.
    let kept = fs::read_to_string(&path).expect("kept");
    let longest = kept.lines().map(str::len).max().expect("rows");
    assert!(kept.ends_with('\n') && kept.len() <= 4096 && kept.len() + longest + 1 > 4096);
    assert_eq!(
        twinslip(&format!("{grid} --resume {}", path.display())).code,
        0
    );
    let other = place.join("whole.csv");
    assert_eq!(twinslip(&format!("{grid} -o {}", other.display())).code, 0);
    let [full, whole] = [path, other].map(|path| fs::read(path).expect("written"));
    assert!(full == whole);
}

#[cfg(unix)]
#[test]
fn an_interrupt_keeps_whole_rows_and_says_how_to_go_on() {
    let path = folder("sweep-interrupt").join("map.csv");
    let long = format!(
        "sweep --driving 0.14:0.5:2000 --stiffness 0.36:0.5:2000 -o {}",
        path.display()
    );
    let child = Command::new(env!("CARGO_BIN_EXE_twinslip"))
        .args(long.split(' '))
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // As soon as there are rows, which is after the handler is there and long before the end.
    let begun = std::time::Instant::now();
    while fs::metadata(&path).map_or(0, |data| data.len()) < 4000 {
        assert!(begun.elapsed() < Duration::from_secs(120), "no row came");
        std::thread::sleep(Duration::from_millis(5));
    }
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(killed.expect("kill").success());
    let ended = child.wait_with_output().expect("it ends");
    assert_eq!(ended.status.code(), Some(130));
    let said = String::from_utf8_lossy(&ended.stderr);
    assert!(said.contains("interrupted; go on with --resume"), "{said}");
    let text = fs::read_to_string(&path).expect("kept");
    assert!(text.ends_with('\n') && text.starts_with("# twinslip"));
    let table = csv(&text);
    // Reasons may have commas.
    assert!(table.len() > 2 && table.iter().all(|row| row.len() >= table[0].len()));
}

#[cfg(not(feature = "parquet"))]
#[test]
fn parquet_is_refused_by_a_build_without() {
    let path = folder("sweep-no-parquet").join("map.parquet");
    let arguments = format!("{GRID} -q -o {}", path.display());
    refused(&arguments, "build with --features parquet");
    refused(&format!("{GRID} --format parquet"), "needs a file");
}

/// The file is there when all rows are, and nothing else; what was interrupted is gone on with.
#[cfg(feature = "parquet")]
#[test]
fn parquet_is_made_of_the_rows_of_all_runs() {
    let place = folder("sweep-parquet");
    let path = place.join("map.parquet");
    let csv = whole(&place, "");
    let torn = &csv[..csv.len() - 100];
    fs::write(place.join("map.parquet.csv"), torn).expect("written");
    let ended = sweep(&format!("--resume {}", path.display()));
    assert_eq!((ended.code, ended.err.as_str()), (0, ""));
    let resumed = fs::read(&path).expect("a file");
    assert!(resumed.starts_with(b"PAR1") && resumed.ends_with(b"PAR1"));
    assert_eq!(sweep(&format!("-o {}", path.display())).code, 0);
    assert_eq!(fs::read(&path).expect("a file"), resumed);
    assert!(!place.join("map.parquet.csv").exists());
}
