//! Branches of orbits whose period grows without bound, against values of the homoclinic orbits and saddle-nodes known to 22 digits and more.

use crate::command;
use crate::common::{data, number as exact};
use command::number;
use serde_json::Value;

/// The end of the only branch: its label, its name, and the parameter with its bound.
fn end(arguments: &str, parameter: &str) -> (String, String, f64, f64) {
    let ended = command::twinslip(&format!("branch orbits {arguments} --format json -q"));
    // A special point on the way may be undecided.
    assert!([0, 3].contains(&ended.code), "{arguments}: {}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let all = made["result"]["special"]
        .as_array()
        .expect("special points");
    let last = all.last().expect("an end");
    let word = |name: &str| last[name].as_str().expect("a word").to_owned();
    let value = |part: &str| number(last, &format!("/{parameter}/{part}"));
    (
        word("label"),
        word("name"),
        value("value"),
        value("uncertainty"),
    )
}

fn reference(id: &str, value: &str) -> f64 {
    let all = data("homoclinic.json");
    let cases = all["cases"].as_array().expect("cases").iter();
    let one = cases.clone().find(|one| one["id"] == id);
    exact(&one.expect("the case")["values"][value])
}

fn case(name: &str) -> String {
    format!("--system tests/data/cases/{name}.toml")
}

#[track_caller]
fn ends_at(arguments: &str, parameter: &str, name: &str, truth: f64, sharp: f64) {
    let (label, told, value, off) = end(arguments, parameter);
    assert_eq!(
        (label.as_str(), told.as_str()),
        ("HOM", name),
        "{arguments}"
    );
    assert!(
        (value - truth).abs() <= off && off < sharp,
        "{value} ± {off:e} for {truth}: {arguments}"
    );
}

#[test]
fn branches_end_at_homoclinic_orbits() {
    let truth = reference("lorenz_homoclinic_10_8/3", "r");
    let lorenz = "--system lorenz --along r --from 10 --to 30";
    ends_at(lorenz, "r", "homoclinic", truth, 1e-5);

    let truth = reference("shimizu_morioka_alpha0.4", "lam");
    let asked = format!(
        "{} --along lam --from 0.5 --to 1.4",
        case("shimizu-morioka")
    );
    ends_at(&asked, "lam", "homoclinic", truth, 1e-7);

    let truth = reference("kuznetsov_6.1_homoclinic", "alpha");
    let asked = format!("{} --along alpha --from 0.5 --to -0.5", case("planar-loop"));
    ends_at(&asked, "alpha", "homoclinic", truth, 1e-6);

    let truth = reference("planar_exact_loop_mu-0.001", "homoclinic_mu");
    let asked = format!("{} --along mu --from -0.3 --to 0.2", case("damped-loop"));
    ends_at(&asked, "mu", "homoclinic", truth, 1e-11);

    let truth = reference("morris_lecar_homoclinic_I_phi0.23", "I");
    let system = case("morris-lecar");
    let asked = format!("{system} --set phi=0.23 --along I --from 30 --to 60");
    ends_at(&asked, "I", "homoclinic", truth, 1e-3);
}

/// x''' + b x'' + x' = mu x - x^2, b = 0.4: the branch goes to and fro about the value at which an orbit is homoclinic to the saddle-focus at 0, which
/// is known by bisection of what its unstable manifold does.
#[test]
fn branches_end_at_orbits_that_are_homoclinic_to_a_saddle_focus() {
    let text = "name = \"saddle-focus\"
states = [\"x\", \"y\", \"z\"]
[parameters]
mu = 0.5
b = 0.4
[rates]
x = \"y\"
y = \"z\"
z = \"mu*x - y - b*z - x^2\"
[start]
x = 0.4
y = 0.1
z = 0.0
";
    let file = crate::common::text::file("saddle-focus", text);
    let asked = format!("--system {file} --along mu --from 0.1 --to 3");
    ends_at(&asked, "mu", "homoclinic", 1.606_203_845_707_1, 1e-7);
}

/// Symmetric orbits that wind about two saddle-foci in turn. Where one of them is connected with the other is known by bisection of the side to which
/// the stable manifold leaves, back in time (SciPy's DOP853, 1e-12). Beside a turn of the branch the last orbits seem to tend to another value.
#[test]
fn a_branch_that_may_turn_once_more_has_not_come_to_its_limit() {
    let asked =
        "--system tests/data/oscillators/torus-circuit.toml --along nu --from -0.9 --to -0.4";
    ends_at(asked, "nu", "homoclinic", -0.797_519_830_65, 5e-3);
}

/// Hindmarsh and Rose's branch from the second Hopf point goes to and fro, and every turn of it makes the orbit two spikes longer beside another
/// orbit. The folds are those of AUTO-07p (NTST = 400, EPSL = 1e-8, DSMAX = 0.02), which with a step of 0.05 leaves some of them out.
#[test]
fn no_turn_of_a_branch_beside_another_orbit_is_lost() {
    const FOLDS: [[f64; 2]; 14] = [
        [5.3427984126, 72.560076],
        [5.3410654239, 85.311703],
        [5.3420779410, 91.413908],
        [5.3406350631, 98.741806],
        [5.3418540861, 105.302375],
        [5.3405291943, 112.409567],
        [5.3417991022, 119.106329],
        [5.3405010530, 126.220905],
        [5.3417835638, 132.971918],
        [5.3404925048, 140.127338],
        [5.3417785120, 146.896912],
        [5.3404895533, 154.086960],
        [5.3417766765, 160.856035],
        [5.3404884392, 168.072146],
    ];
    // Between the first two AUTO has no other fold, but its orbits turn there.
    const TURN: f64 = 76.65;
    /// Between the turns of one side, some time later.
    const LONGER: [f64; 2] = [13.9, 14.1];
    let asked = "branch orbits --system tests/data/oscillators/hindmarsh-rose.toml --along I --from 4.9 --to 6";
    let ended = command::twinslip(&format!("{asked} --format json -q"));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let all = made["result"]["special"].as_array().expect("points");
    let folds: Vec<[f64; 2]> = all
        .iter()
        .filter(|one| one["label"] == "SN")
        .map(|one| ["/I/value", "/period/value"].map(|at| number(one, at)))
        .filter(|[_, period]| (period - TURN).abs() > 0.1)
        .collect();
    for (fold, known) in folds.iter().zip(&FOLDS) {
        let near = |i: usize, off: f64| (fold[i] - known[i]).abs() < off;
        assert!(near(0, 2e-9) && near(1, 1e-4), "{fold:?} for {known:?}");
    }
    for three in folds.windows(3).skip(FOLDS.len()) {
        let longer = three[2][1] - three[0][1];
        assert!(longer > LONGER[0] && longer < LONGER[1], "{three:?}");
    }
    let end = all.last().expect("an end");
    let at = |part: &str| number(end, &format!("/I/{part}"));
    let [value, off] = [at("value"), at("uncertainty")];
    assert_eq!(end["label"], "HOM");
    let last = &folds[folds.len() - 2..];
    for [fold, _] in last {
        assert!(
            (fold - value).abs() <= off * (1.0 + 1e-6),
            "{value} ± {off}"
        );
    }
    // The folds tend to where orbits touch that are homoclinic to the other one.
    assert!((value - off - 5.340_487_7).abs() < 1e-8 && (value + off - 5.341_775_48).abs() < 1e-8);
}

#[test]
fn branches_end_at_saddle_nodes_on_the_cycle() {
    const NAME: &str = "saddle-node on a cycle";
    let truth = reference("planar_SNIC_exact_mu0.01", "SNIC_mu");
    let system = case("saddle-node-on-circle");
    let asked = format!("{system} --along mu --from 1 --to -0.5 --start -1,0");
    ends_at(&asked, "mu", NAME, truth, 1e-12);
}

#[test]
#[ignore = "takes half a minute: .ci/run runs it"]
fn a_branch_of_a_neuron_ends_at_a_saddle_node_on_the_cycle() {
    const NAME: &str = "saddle-node on a cycle";
    let truth = reference("morris_lecar_SNIC_phi1/15", "I_SN");
    let asked = format!("{} --along I --from 30 --to 60", case("morris-lecar"));
    ends_at(&asked, "I", NAME, truth, 1e-10);
}

/// Where the period is finite the range ends, or another bifurcation.
#[test]
fn other_ends_are_called_what_they_are() {
    let asked = format!("{} --along I --from 45 --to 60", case("morris-lecar"));
    let (label, ..) = end(&asked, "I");
    assert_eq!(label, "EP");
}
