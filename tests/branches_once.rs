//! A branch that is followed from one end is not counted again from its other end, nor are mirror images; and branches of orbits begin where
//! no Hopf point is.

use crate::command;
use command::{Ended, twinslip};
use std::collections::BTreeMap;

/// The rows of a CSV by the number of their branch or curve: values by the names of columns.
type Branches = BTreeMap<usize, Vec<BTreeMap<String, String>>>;

fn branches(ended: &Ended) -> Branches {
    let mut lines = ended.out.lines().filter(|line| !line.starts_with('#'));
    let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let mut all = Branches::new();
    for line in lines {
        let cells = line.split(',').map(str::to_owned);
        let names = head.iter().map(|name| (*name).to_owned());
        let row: BTreeMap<String, String> = names.zip(cells).collect();
        let number = row.get("branch").or(row.get("curve"));
        let number = number.expect("a number").parse().expect("a count");
        all.entry(number).or_default().push(row);
    }
    all
}

/// Follows, and tells the symmetries of what is found, each over the whole range of the first column.
#[track_caller]
fn symmetries(arguments: &str, range: [f64; 2]) -> Vec<String> {
    let ended = twinslip(&format!("{arguments} --format csv"));
    assert_eq!(ended.code, 0, "{arguments}: {}", ended.err);
    let first = ended.out.lines().find(|line| !line.starts_with('#'));
    let first = first.expect("a head").split(',').next().expect("a column");
    let found = branches(&ended);
    let numbers: Vec<usize> = found.keys().copied().collect();
    assert_eq!(numbers, (0..found.len()).collect::<Vec<_>>(), "{arguments}");
    let symmetry = |rows: &Vec<BTreeMap<String, String>>| {
        let ends = [&rows[0], &rows[rows.len() - 1]];
        let mut ends = ends.map(|row| row[first].parse::<f64>().expect("a number"));
        ends.sort_by(f64::total_cmp);
        assert_eq!(ends, range, "{arguments}");
        rows[0].get("symmetry").cloned().unwrap_or_default()
    };
    found.values().map(symmetry).collect()
}

#[test]
fn a_branch_between_hopf_points_beyond_both_ends_is_one() {
    let between = "--stiffness 0.14 --from 1 --to 2";
    let both = symmetries(&format!("branch orbits {between}"), [1.0, 2.0]);
    assert_eq!(both, ["symmetric", "asymmetric"]);
    let single = symmetries(
        &format!("branch orbits --interfaces 1 {between}"),
        [1.0, 2.0],
    );
    assert_eq!(single, ["symmetric"]);
    let nerve = "branch orbits --system fitzhugh-nagumo --along I --from 0.5 --to 0.8";
    assert_eq!(symmetries(nerve, [0.5, 0.8]).len(), 1);
}

/// What is known of a torn file is followed again, so that its other ends are known too.
#[test]
fn a_branch_is_one_where_a_file_is_resumed() {
    let place = command::folder("branches-once");
    let path = place.join("orbits.csv");
    let line = |option: &str| {
        let orbits = "branch orbits --stiffness 0.14 --from 1 --to 2 -q";
        twinslip(&format!("{orbits} {option} {}", path.display())).code
    };
    let rows = || -> Vec<String> {
        let text = std::fs::read_to_string(&path).expect("rows");
        let rows = text.lines().filter(|line| !line.starts_with('#'));
        rows.map(str::to_owned).collect()
    };
    assert_eq!(line("-o"), 0);
    let (whole, bytes) = (rows(), std::fs::read(&path).expect("rows"));
    for part in [bytes.len() / 2, bytes.len() * 4 / 5] {
        std::fs::write(&path, &bytes[..part]).expect("a torn file");
        assert_eq!(line("--resume"), 0);
        assert_eq!(rows(), whole, "{part} bytes were there");
    }
}

#[test]
fn mirror_images_are_one_branch_and_one_curve() {
    let branch = "branch equilibria --along residual_strength --from 5e-4 --to 2e-3 --stiffness 0.14 --driving 2";
    let both = ["symmetric", "asymmetric"];
    assert_eq!(symmetries(branch, [5e-4, 2e-3]), both);
    let ended = twinslip(branch);
    assert!(
        ended
            .err
            .contains("an asymmetric branch stands for its mirror image too"),
        "{}",
        ended.err
    );
    // The slow interface first.
    for row in &branches(&ended)[&1] {
        let state = |name: &str| row[name].parse::<f64>().expect("a number");
        assert!(state("state_1") > state("state_2"), "{row:?}");
    }
    let curve = twinslip(
        "locus hopf --in stiffness,residual_strength --range stiffness=0.05,0.4 --range residual_strength=5e-4,2e-3 --driving 2 --format csv",
    );
    let found = branches(&curve);
    let of_curves = found.values().map(|rows| rows[0]["symmetry"].as_str());
    assert_eq!(of_curves.collect::<Vec<_>>(), both);
    assert!(curve.err.contains("on 2 curves"), "{}", curve.err);
    // Parts of a file's law that are equal are known as such.
    let clusters = "branch equilibria --clusters 1,1 --stiffness 0.14 --from 1 --to 2";
    assert_eq!(symmetries(clusters, [1.0, 2.0]).len(), 2);
}

/// Interfaces that differ have no mirror images.
#[test]
fn branches_of_interfaces_that_differ_stay_apart() {
    let differ =
        "branch equilibria --stiffness 0.14 --from 1 --to 2 --set residual_strength_2=0.002";
    assert_eq!(symmetries(differ, [1.0, 2.0]).len(), 3);
}

#[test]
fn orbits_begin_at_those_that_are_found_where_no_hopf_point_is_met() {
    let along = "branch orbits --along residual_strength --from 9.9e-4 --to 1.01e-3";
    for loading in [
        "--driving 0.0768 --stiffness 0.14",
        "--driving 5.3 --stiffness 0.13",
    ] {
        let arguments = format!("{along} {loading}");
        let ended = twinslip(&arguments);
        assert_eq!(ended.code, 0, "{arguments}: {}", ended.err);
        let found = branches(&ended);
        // A branch has one symmetry, also where another one parts from it.
        for rows in found.values() {
            assert!(
                rows.iter()
                    .all(|row| row["symmetry"] == rows[0]["symmetry"]),
                "{rows:?}"
            );
        }
        // Each begins with its own orbit: of two at one value the periods differ.
        let begins = found.values().map(|rows| {
            (
                rows[0]["residual_strength"].clone(),
                rows[0]["period"].clone(),
            )
        });
        let begins: Vec<_> = begins.collect();
        assert!(!begins.is_empty(), "{arguments}");
        let orbit = twinslip(&format!(
            "orbit {loading} --set residual_strength=9.9e-4 --crosscheck none --format json"
        ));
        let orbit: serde_json::Value = serde_json::from_str(&orbit.out).expect("JSON");
        let period = orbit["result"]["orbit"]["period"]["value"]
            .as_f64()
            .expect("a period");
        let near = |(at, t): &(String, String)| {
            let [at, t] = [at, t].map(|x| x.parse::<f64>().expect("a number"));
            at == 9.9e-4 && (t / period - 1.0).abs() < 1e-9
        };
        assert!(
            begins.iter().any(near),
            "{arguments}: {begins:?} and not {period}"
        );
        assert!(
            ended
                .err
                .contains("begins here, at an orbit found by a search"),
            "{}",
            ended.err
        );
    }
}
