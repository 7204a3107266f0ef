//! Sweeps that are killed, interrupted, gone on with or shared out, and `merge`: the same bytes as of one run.

use crate::command;
use command::sweeps::{GRID, sweep, whole};
use command::{csv, folder, refused_in_one_line as refused, run, twinslip};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

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
        let mut child = crate::command::program()
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
            "only CSV can be resumed",
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
    let child = crate::command::program()
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
    assert!(said.contains("interrupted; resume with --resume"), "{said}");
    let text = fs::read_to_string(&path).expect("kept");
    assert!(text.ends_with('\n') && text.starts_with("# twinslip"));
    let table = csv(&text);
    // Reasons may have commas.
    assert!(table.len() > 2 && table.iter().all(|row| row.len() >= table[0].len()));
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
    refused(&mixed, "belong to different sweeps");
    of_other(
        "--driving 0.14:0.5:6 --stiffness 0.3:0.5:4 --follow --starts 2",
        "3/4",
    );
    refused(&mixed, "belong to different sweeps");
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
