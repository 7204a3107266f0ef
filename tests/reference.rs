//! The pages on commands, columns and files are those that the program writes.

use crate::command::{folder, run};
use crate::common::ROOT;
use std::path::Path;

const PAGES: [&str; 3] = ["commands.md", "columns.md", "files.md"];

#[test]
fn the_reference_is_that_of_the_program() {
    let place = folder("reference");
    let ended = run(&["reference", "--out", place.to_str().expect("UTF-8")]);
    assert_eq!(ended.code, 0, "{}", ended.err);
    for page in PAGES {
        let read = |path: &Path| std::fs::read_to_string(path).expect(page);
        let written = read(&place.join(page));
        let kept = read(&Path::new(ROOT).join("docs/reference").join(page));
        let lines = written.lines().zip(kept.lines()).enumerate();
        for (number, (written, kept)) in lines {
            assert_eq!(
                written,
                kept,
                "docs/reference/{page}:{}: run `twinslip reference`",
                number + 1
            );
        }
        assert_eq!(
            written, kept,
            "docs/reference/{page} has other lines at its end"
        );
    }
}

/// The pages name what a run writes, and not only what the lists say.
#[test]
fn columns_of_a_run_are_in_the_reference() {
    let columns = std::fs::read_to_string(Path::new(ROOT).join("docs/reference/columns.md"))
        .expect("columns.md");
    for command in [
        "law --points 3",
        "integrate --driving 10 --stiffness 0.14 --until 1 --program 0.5:5",
        "equilibria --driving 10 --stiffness 0.14",
        "equilibria --interfaces 3 --driving 10 --stiffness 0.14",
        "integrate --interfaces 9 --driving 10 --stiffness 0.14 --until 0.01 --points 2",
        "section --driving 10 --stiffness 0.14 --returns 40 --skip 20",
        "branch equilibria --stiffness 0.14 --from 100 --to 200",
        "locus pitchfork",
        "sweep --driving 10:20:2 --stiffness 0.14",
    ] {
        let words: Vec<&str> = command
            .split(' ')
            .chain(["--format", "csv", "-q"])
            .collect();
        let ended = run(&words);
        let header = ended.out.lines().find(|line| !line.starts_with('#'));
        let header = header.unwrap_or_else(|| panic!("{command}: {}", ended.err));
        for name in header.split(',').filter(|name| *name != "row_check") {
            let parts = name.split('_').map(|part| match part.parse::<usize>() {
                Ok(_) => "i",
                Err(_) => part,
            });
            let name = parts.collect::<Vec<_>>().join("_");
            let listed = |name: &str| columns.contains(&format!("| `{name}`"));
            let plain = name.strip_suffix("_uncertainty");
            assert!(
                listed(&name) || plain.is_some_and(listed),
                "{command}: {name}"
            );
        }
    }
}
