//! `sweep` as a user meets it: rows, grids, verdicts, and curves over maps, the same however it is run.

use crate::command;
use command::sweeps::{GRID, sweep, whole};
use command::{csv, folder, object, refused_in_one_line as refused, run, twinslip};
use std::fs;

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
        let output = crate::command::program()
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

/// The multiplier of a point that the last step of Newton's method was much nearer to than it is itself to the orbit: that it hardly changed on this step says
/// little of the way that is left.
#[test]
fn exponents_of_cycles_are_within_their_bounds() {
    let orbit = object("orbit --interfaces 1 --driving 1 --stiffness 0.3");
    let orbit = &orbit["result"]["orbit"];
    let at = |path: &str| {
        orbit
            .pointer(path)
            .and_then(|x| x.as_f64())
            .expect("a number")
    };
    let known = at("/log_multipliers/0/ln_abs/value") / at("/period/value");
    for vectors in ["avx2", "none"] {
        let ended = command::program()
            .args(
                "sweep --interfaces 1 --driving 1:2:2 --stiffness 0.3:0.31:2 --format json -q"
                    .split(' '),
            )
            .env("TWINSLIP_VECTORS", vectors)
            .output()
            .expect("the program starts");
        let made: serde_json::Value = serde_json::from_slice(&ended.stdout).expect("JSON");
        let exponent = &made["result"]["rows"][0]["lyapunov_max"];
        let [value, off] =
            ["value", "uncertainty"].map(|part| exponent[part].as_f64().expect("a number"));
        assert!(
            (value - known).abs() <= off && off < 1e-7,
            "{vectors}: {value} ± {off:e} for {known}"
        );
    }
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
        (
            plane("0.1 --interfaces 0"),
            "interfaces is 0, but must be at least 1",
        ),
        (plane("0.1 --shard 0/3"), "shard is 0/3, but must be I/N"),
        (plane("0.1 --shard 4/3"), "shard is 4/3, but must be I/N"),
        (plane("0.1 --shard 2"), "shard is 2, but must be I/N"),
        (plane("0.1 --plot map.pdf"), "map.pdf"),
        (plane("0.1 --resume -"), "only a file can be resumed"),
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
    assert!(ended.err.contains("24 rows of 2 parts"), "{}", ended.err);
    let said = format!("undecided: the regime of {undecided} rows");
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

/// Curves over a map are kept, and computed again where what is kept is not whole.
#[test]
fn curves_over_a_map_are_kept_and_never_trusted_blindly() {
    let place = folder("sweep-curves");
    let cache = place.join("cache");
    let picture = place.join("map.svg");
    let draw = |cache: &str, grid: &str| {
        let output = crate::command::program()
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
