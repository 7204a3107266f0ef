//! What is written is not lost, doubled or mixed: kills at random moments, interrupts, two writers at once, full disks, files that
//! are deleted meanwhile, messages that nobody reads.

use crate::command;
use crate::common::random;
use command::durable::{BRANCH, LOCUS, RUN, SWEEP, begin, done, grown, read, special};
use command::{contents, csv, folder, refused_in_one_line as refused, twinslip};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

const LONG_SWEEP: &str = "sweep -q --driving 0.14:0.5:2000 --stiffness 0.36:0.5:2000";

/// Done, be a verdict undecided or not.
fn computed(arguments: &str) {
    let ended = twinslip(arguments);
    assert!(matches!(ended.code, 0 | 3), "{arguments}: {}", ended.err);
}

/// Kills it again and again, each time on its way to the end, and goes on with what is left; in the end the bytes are those of an
/// uninterrupted run.
fn killed(name: &str, command: &str, files: fn(&Path) -> Vec<PathBuf>) {
    const KILLS: u64 = 6;
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
        &format!("{BRANCH} --step-limit 0.04"),
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

#[test]
fn output_that_is_deleted_is_told_at_the_end() {
    let place = folder("durable-deleted");
    let path = place.join("hopf.csv");
    for file in [path.clone(), special(&path)] {
        let child = begin(&format!(
            "locus hopf -q --step-limit 0.15 -o {}",
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
            "finished parts are in",
        ),
        (
            format!("locus torus --step-limit 1e-3 -o {}", rows.display()),
            "resume with --resume",
        ),
        (
            "integrate --driving 10 --stiffness 0.14 --until 1e9 --format csv".to_owned(),
            "interrupted",
        ),
    ] {
        let child = begin(&arguments);
        std::thread::sleep(Duration::from_millis(400));
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

/// Runs of many interfaces, killed again and again: with their events by power series, and by methods that begin anew at each checkpoint.
#[test]
fn a_killed_run_of_many_interfaces_ends_in_the_same_bytes() {
    const KILLS: usize = 10;
    let place = folder("durable-many");
    let methods: &[(&str, &str)] = &[
        ("taylor", "--events --participation"),
        ("rodas5p", ""),
        #[cfg(feature = "sundials")]
        ("cvode-bdf", ""),
    ];
    for (method, also) in methods {
        let [rows, saved] = ["run.csv", "run.saved"].map(|name| place.join(name));
        let command = format!(
            "integrate -q --interfaces 100 --driving 100 --stiffness 0.01 --start spread:1 --until 3 --points 200 \
             --columns time,stress,slip,slip_rate_max,state_1,slip_7 --draw residual_strength=8e-4:1.2e-3 --method {method} {also} \
             -o {} --checkpoint {} --checkpoint-steps 20",
            rows.display(),
            saved.display()
        );
        let all: Vec<PathBuf> = match also.is_empty() {
            true => vec![rows.clone()],
            false => ["run.csv", "run.events.csv", "run.participation.csv"]
                .map(|name| place.join(name))
                .to_vec(),
        };
        let begun = Instant::now();
        computed(&command);
        let span = begun.elapsed().as_micros() as u64;
        assert!(
            !saved.exists(),
            "{method}: a complete run leaves no checkpoint"
        );
        let known: Vec<Vec<u8>> = all
            .iter()
            .map(|path| fs::read(path).expect("written"))
            .collect();
        assert!(known[0].len() > 10_000);
        fs::remove_file(&rows).expect("there");
        let mut gone_on = 0;
        for kill in 0..KILLS {
            let mut child = begin(&command);
            // The first one as soon as there is a checkpoint: a busy machine starts programs late.
            match kill {
                0 => grown(&saved, 1),
                _ => std::thread::sleep(Duration::from_micros(random() % span / 2)),
            }
            child.kill().expect("SIGKILL");
            child.wait().expect("it ends");
            gone_on += usize::from(saved.exists());
        }
        assert!(gone_on > 0, "{method}: no kill fell into a run");
        computed(&command);
        for (path, known) in all.iter().zip(&known) {
            let made = fs::read(path).expect("written");
            assert!(made == *known, "{method}: {}", path.display());
        }
    }
}

#[test]
fn a_checkpoint_of_another_run_is_refused() {
    let place = folder("checkpoint-of-another");
    let [rows, saved] = ["run.csv", "run.saved"].map(|name| place.join(name));
    let command = |more: &str| {
        format!(
            "integrate -q --interfaces 20 --driving 20 --stiffness 0.05 --start spread:1 --until 1e5 {more} -o {} --checkpoint {} --checkpoint-steps 5",
            rows.display(),
            saved.display()
        )
    };
    let mut child = begin(&command(""));
    grown(&rows, 5000);
    child.kill().expect("SIGKILL");
    child.wait().expect("it ends");
    refused(&command("--rtol 1e-9"), "another run, as numerics differs");
    refused(
        &command("--seed 2 --draw slip_length=1:2"),
        "another run, as draw differs",
    );
    let mut bytes = fs::read(&saved).expect("written");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&saved, &bytes).expect("written");
    refused(&command(""), "no checkpoint of this version, or is damaged");
    bytes[middle] ^= 1;
    fs::write(&saved, &bytes).expect("written");
    let beginning = fs::read(&rows).expect("written")[..10].to_vec();
    fs::write(&rows, beginning).expect("written");
    refused(&command(""), "has lost rows");
    for (more, sentence) in [
        ("--format json", "only rows in CSV"),
        ("--plot a.svg", "draw the rows"),
    ] {
        refused(&command(more), sentence);
    }
    refused(
        "integrate --interfaces 9 --driving 10 --stiffness 0.1 --until 1 --checkpoint a",
        "-o FILE.csv",
    );
    refused(
        "integrate --interfaces 9 --driving 10 --stiffness 0.1 --until 1 --checkpoint a --checkpoint-steps 0 -o b.csv",
        "checkpoint-steps is 0, but must be at least 1",
    );
    refused(
        "integrate --driving 10 --stiffness 0.1 --until 1 --checkpoint a -o b.csv",
        "for runs of many interfaces",
    );
}
