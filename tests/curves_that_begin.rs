//! Curves that begin at points of codimension two, against values that are known to 20 digits or in closed form.

use crate::command::{self, number};
use crate::common::{data, number as exact};
use serde_json::Value;
use std::path::PathBuf;

const FILES: &str = "tests/data/codimension_two";

/// A curve whose special points are kept in a file, and their labels.
struct Kept {
    file: PathBuf,
    labels: Vec<String>,
}

impl Kept {
    /// The curves that a command follows.
    #[track_caller]
    fn new(name: &str, arguments: &str) -> Self {
        let rows = command::folder(&format!("begin-{name}")).join("curve.csv");
        let ended = command::twinslip(&format!("locus {arguments} -q -o {}", rows.display()));
        assert_eq!(ended.code, 0, "{arguments}: {}", ended.err);
        let file = rows.with_file_name("curve.special.csv");
        let text = std::fs::read_to_string(&file).expect("special points");
        let special = command::csv(&text).into_iter().skip(1);
        Kept {
            labels: special.map(|row| row[0].clone()).collect(),
            file,
        }
    }

    /// `begin` of the first of its points with a label.
    #[track_caller]
    fn begin(&self, label: &str) -> String {
        let row = self.labels.iter().position(|one| one == label);
        let row = row.unwrap_or_else(|| panic!("no {label}")) + 1;
        format!("--begin {}:{row}", self.file.display())
    }
}

/// The special points of the curves that a command follows.
#[track_caller]
fn followed(arguments: &str) -> Vec<Value> {
    let made = command::object(&format!("locus {arguments}"));
    let all = made["result"]["special"].as_array();
    all.expect("special points").clone()
}

/// That the points with a label have this value of a parameter, in the order of the curve, each inside its bound, which is sharp.
#[track_caller]
fn are(found: &[Value], label: &str, name: &str, truths: &[f64]) {
    let there: Vec<&Value> = found.iter().filter(|one| one["label"] == label).collect();
    assert_eq!(there.len(), truths.len(), "{label}: {found:#?}");
    for (one, truth) in there.into_iter().zip(truths) {
        let value = number(one, &format!("/{name}/value"));
        let off = number(one, &format!("/{name}/uncertainty"));
        assert!(
            (value - truth).abs() <= off && off < 1e-11,
            "{name} = {value} ± {off:e} for {truth}"
        );
    }
}

fn reference(id: &str, value: &str) -> f64 {
    let all = data("codim2_starts.json");
    let cases = all["cases"].as_array().expect("cases");
    let one = cases.iter().find(|one| one["id"] == id);
    let path = format!("/values/{value}");
    exact(one.expect("the case").pointer(&path).expect("the value"))
}

#[test]
fn folds_of_orbits_leave_a_degenerate_hopf_point() {
    let system = format!("--system {FILES}/bautin.toml");
    let plane = "--in b1,b2 --range b1=-1,1 --range b2=-1.1,1.3";
    let hopf = Kept::new("gh", &format!("hopf {system} {plane}"));
    let folds = followed(&format!(
        "orbit-saddle-node {system} {} --at b2=1.2",
        hopf.begin("GH")
    ));
    let id = "bautin_curved_b2_1.2";
    let b1 = reference(id, "fold_of_cycles/b1");
    are(&folds, "UZ", "b1", &[b1]);
    let asked = folds.iter().find(|one| one["label"] == "UZ");
    let period = number(asked.expect("it"), "/period/value");
    let truth = reference(id, "fold_of_cycles/period");
    assert!((period / truth - 1.0).abs() < 1e-13, "{period}");
    // b1 = -b2^2/4 begins at b2 = 0, and is there on one side alone.
    are(&folds, "GH", "b1", &[0.0]);
    are(&folds, "EP", "b1", &[-0.4225]);
    // The curve of Hopf points goes through it.
    let hopfs = followed(&format!("hopf {system} {}", hopf.begin("GH")));
    are(&hopfs, "EP", "b1", &[0.0, 0.0]);
    are(&hopfs, "GH", "b2", &[0.0]);
}

#[test]
fn tori_leave_a_zero_hopf_point() {
    let system = format!("--system {FILES}/zero-hopf.toml");
    let plane = "--in b1,b2 --range b1=-1,1 --range b2=-1.1,1";
    let fold = Kept::new("zh", &format!("saddle-node {system} {plane}"));
    let begin = fold.begin("ZH");
    let tori = followed(&format!("torus {system} {begin} --at b1=-0.2"));
    are(&tori, "UZ", "b2", &[reference("zero_hopf_A", "b2")]);
    are(&tori, "ZH", "b2", &[0.0]);
    are(&tori, "EP", "b1", &[-1.0]);
    let rows = command::twinslip(&format!("locus torus {system} {begin} --at b1=-0.2 -q"));
    let rows = command::csv(&rows.out);
    let column = |name: &str| {
        rows[0]
            .iter()
            .position(|one| one == name)
            .expect("the column")
    };
    let asked = rows.iter().find(|row| row[column("b1")] == "-0.2");
    let angle: f64 = asked.expect("it")[column("angle_over_pi")]
        .parse()
        .expect("a number");
    let truth = reference("zero_hopf_A", "angle_of_multipliers") / std::f64::consts::PI;
    assert!((angle - truth).abs() < 1e-9, "{angle} for {truth}");
    // A curve that is followed down to the point ends there.
    let all = followed(&format!("torus {system} {plane}"));
    are(&all, "ZH", "b2", &[0.0]);
    are(&all, "R1", "b2", &[]);
    let hopf = followed(&format!("hopf {system} {begin}"));
    are(&hopf, "ZH", "b1", &[0.0]);
    let folds = followed(&format!("saddle-node {system} {begin}"));
    are(&folds, "ZH", "b2", &[0.0]);
}

#[test]
fn two_curves_of_tori_leave_a_double_hopf_point() {
    let system = format!("--system {FILES}/hopf-hopf.toml");
    let plane = "--in m1,m2 --range m1=-1,1 --range m2=-1.1,1";
    let hopf = Kept::new("hh", &format!("hopf {system} {plane}"));
    let begin = hopf.begin("HH");
    let tori = followed(&format!("torus {system} {begin} --at m1=0.4"));
    // m2 = de m1 of the cycle of the first pair, and m1 = th m2 of that of the second.
    let first = reference("hopf_hopf_A", "m2");
    are(&tori, "UZ", "m2", &[first, 0.4 / 1.5]);
    are(&tori, "HH", "m2", &[0.0, 0.0]);
    are(&tori, "EP", "m1", &[1.0, 1.0]);
    let curves = followed(&format!("hopf {system} {begin}"));
    are(&curves, "HH", "m1", &[0.0, 0.0]);
    let ends = curves.iter().filter(|one| one["label"] == "EP");
    assert_eq!(ends.count(), 4, "{curves:#?}");
}

#[test]
fn homoclinic_orbits_leave_a_double_zero() {
    let system = "--system tests/data/homoclinic/bogdanov-takens.toml";
    let plane = "--in b1,b2 --range b1=-1,0.5 --range b2=-1.5,0.2";
    let fold = Kept::new("bt", &format!("saddle-node {system} {plane}"));
    let begin = fold.begin("BT");
    let orbits = followed(&format!("homoclinic {system} {begin} --at b2=-1,-0.04"));
    let truths = ["-1", "-0.04"].map(|b2| reference(&format!("bt_homoclinic_b2_{b2}"), "b1"));
    are(&orbits, "UZ", "b1", &truths);
    are(&orbits, "BT", "b1", &[0.0]);
    // On one side alone: on the other there are neutral saddles.
    let hopf = followed(&format!("hopf {system} {begin}"));
    are(&hopf, "EP", "b2", &[-1.5]);
    are(&hopf, "BT", "b2", &[0.0]);
}

/// A cycle with a perturbation that turns by half while it turns once, and whose amplitude s has (s^2)' ~ p + q s^2 - s^4.
#[test]
fn folds_of_doubled_orbits_leave_a_degenerate_period_doubling() {
    let system = format!("--system {FILES}/doubling.toml");
    let plane = "--in p,q --range p=-0.5,0.5 --range q=-0.5,0.6";
    let start = "--start=0.8,0,0,0 --period-guess 6.28 --criticality";
    let doublings = Kept::new("gpd", &format!("period-doubling {system} {plane} {start}"));
    let begin = doublings.begin("GPD");
    let folds = followed(&format!("orbit-saddle-node {system} {begin} --at q=0.4"));
    are(&folds, "UZ", "p", &[-0.04]);
    are(&folds, "EP", "p", &[-0.09]);
    are(&folds, "GPD", "p", &[0.0]);
    let period = number(&folds[1], "/period/value");
    assert!(
        (period / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-13,
        "{period}"
    );
    let own = followed(&format!("period-doubling {system} {begin}"));
    are(&own, "EP", "p", &[0.0, 0.0]);
}

#[test]
fn both_curves_that_meet_in_a_fold_flip_leave_it() {
    let system = format!("--system {FILES}/fold-flip.toml");
    let plane = "--in b1,b2 --range b1=-0.3,0.2 --range b2=0.3,1.2";
    let folds = Kept::new("ff", &format!("orbit-saddle-node {system} {plane}"));
    let begin = folds.begin("FF");
    // r^2 = 0.4, where the multiplier is -1, on b1 + b2 r^2 = r^4.
    let doublings = followed(&format!("period-doubling {system} {begin}"));
    are(&doublings, "EP", "b1", &[0.04, -0.3]);
    are(&doublings, "FF", "b2", &[0.8]);
    // b1 = -b2^2/4.
    let folds = followed(&format!("orbit-saddle-node {system} {begin}"));
    are(&folds, "EP", "b1", &[-0.0225, -0.3]);
    are(&folds, "FF", "b1", &[-0.16]);
}

/// The curve of period doublings of two interfaces passes a resonance 1:2; tori of the orbits and of those of twice the period leave it.
#[test]
fn two_curves_of_tori_leave_a_resonance_1_2_of_interfaces() {
    let range = "--driving-range 0.08:0.12 --stiffness-range 0.13:0.16";
    let doublings = Kept::new("r2", &format!("period-doubling {range}"));
    let begin = doublings.begin("R2");
    let tori = followed(&format!("torus {begin} {range}"));
    let at: Vec<[f64; 2]> = tori
        .iter()
        .filter(|one| one["label"] == "R2")
        .map(|one| ["driving", "stiffness"].map(|name| number(one, &format!("/{name}/value"))))
        .collect();
    let near = |one: &&[f64; 2]| {
        (one[0] - 0.099_364_328_916).abs() + (one[1] - 0.137_573_697_102).abs() < 1e-11
    };
    assert!(at.iter().filter(near).count() >= 2, "{tori:#?}");
    let periods = tori.iter().filter(|one| one["label"] == "R3");
    let periods: Vec<f64> = periods.map(|one| number(one, "/period/value")).collect();
    assert!(periods.iter().any(|period| *period > 700.0), "{periods:?}");
}

#[test]
fn what_is_no_beginning_is_refused() {
    let system = format!("--system {FILES}/zero-hopf.toml");
    let plane = "--in b1,b2 --range b1=-1,1 --range b2=-1.1,1";
    let fold = Kept::new("refused", &format!("saddle-node {system} {plane}"));
    let file = fold.file.display();
    let refused = |arguments: &str, sentence: &str| {
        command::refused_in_one_line(&format!("locus {arguments}"), sentence);
    };
    refused(
        &format!("torus {system} --begin {file}:1"),
        ":1 is EP (end), but must be a point of codimension two",
    );
    refused(
        &format!("period-doubling {system} {}", fold.begin("ZH")),
        "is ZH (zero-Hopf), which no curve of period-doubling leaves; saddle-node, hopf, torus do",
    );
    refused(
        &format!("torus {system} --begin {file}:9"),
        ":9: it has 3 rows",
    );
    refused(
        &format!("torus {system} --begin {file}:0"),
        "\"0\" must be the number of a row, from 1",
    );
    refused(
        &format!("torus {system} --begin {file}"),
        "must be FILE.special.csv:ROW",
    );
    refused(
        &format!("torus {system} {} --start x=1", fold.begin("ZH")),
        "--start has no meaning beside --begin",
    );
    refused(
        &format!(
            "torus {system} {} --in b1,th --range th=-1,1",
            fold.begin("ZH")
        ),
        "there is no th, which varies along the curve; its plane is b1, b2",
    );
    // Where the sum of its multipliers is beyond 2 an orbit is a neutral saddle.
    let begin = fold.begin("ZH");
    let ended = command::twinslip(&format!("locus torus {system} --set sg=-1 {begin}"));
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(
        ended.err.contains("no such curve is found to leave"),
        "{}",
        ended.err
    );
}
