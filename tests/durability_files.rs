//! Files that are there already: foreign, damaged and hostile ones are neither replaced nor believed, and those beside the rows are
//! protected as these are.

use crate::command;
use command::durable::{BRANCH, LOCUS, SWEEP, done, read, special};
use command::{csv, folder, object, refused_in_one_line as refused, twinslip};
use std::fs;

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
