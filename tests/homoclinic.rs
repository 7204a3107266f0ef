//! Curves of homoclinic orbits, against values that are known to 20 digits, in closed form, or by other methods.

use crate::command;
use crate::common::{data, number as exact};
use command::number;
use serde_json::Value;

const FILES: &str = "tests/data/homoclinic";

/// The special points of all curves.
#[track_caller]
fn special(arguments: &str) -> Vec<Value> {
    let ended = command::twinslip(&format!("locus homoclinic {arguments} --format json -q"));
    assert_eq!(ended.code, 0, "{arguments}: {}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let all = made["result"]["special"]
        .as_array()
        .expect("special points");
    all.clone()
}

/// The values of the parameter at all points of this label where the other one has this value, if one is given.
fn at(all: &[Value], label: &str, other: Option<(&str, f64)>, name: &str) -> Vec<[f64; 2]> {
    let is_there = |point: &&Value| {
        let there = |(name, value): (&str, f64)| number(point, &format!("/{name}/value")) == value;
        point["label"] == label && other.is_none_or(there)
    };
    let value = |point: &Value, part: &str| number(point, &format!("/{name}/{part}"));
    let found = all.iter().filter(is_there);
    found
        .map(|point| ["value", "uncertainty"].map(|part| value(point, part)))
        .collect()
}

#[track_caller]
fn is(found: &[[f64; 2]], truth: f64, sharp: f64) {
    assert!(!found.is_empty(), "nothing for {truth}");
    for [value, off] in found {
        assert!(
            (value - truth).abs() <= *off && *off < sharp,
            "{value} ± {off:e} for {truth}"
        );
    }
}

fn reference(file: &str, id: &str, value: &str) -> f64 {
    let all = data(file);
    let cases = all["cases"].as_array().expect("cases");
    let one = cases.iter().find(|one| one["id"] == id);
    exact(&one.expect("the case")["values"][value])
}

#[test]
fn they_pass_the_known_values() {
    let r = |id| reference("homoclinic.json", id, "r");
    let found = special("--system lorenz --in r,s --range r=5,40 --range s=5,15 --at s=10");
    let there = at(&found, "UZ", Some(("s", 10.0)), "r");
    is(&there, r("lorenz_homoclinic_10_8/3"), 1e-10);
    let found =
        special("--system lorenz --in r,b --set s=5 --range r=3,20 --range b=0.7,2 --at b=1");
    let there = at(&found, "UZ", Some(("b", 1.0)), "r");
    is(&there, r("lorenz_homoclinic_5_1"), 1e-10);

    // The saddle quantity is zero where SciPy's DOP853 (3e-14), by bisection of what the unstable manifold does, has it.
    let asked = "--in lam,alpha --range lam=0.3,1.6 --range alpha=0.2,1.2 --at alpha=0.4,0.8";
    let found = special(&format!(
        "--system tests/data/cases/shimizu-morioka.toml {asked}"
    ));
    for (alpha, id) in [
        (0.4, "shimizu_morioka_alpha0.4"),
        (0.8, "shimizu_morioka_alpha0.8"),
    ] {
        let truth = reference("homoclinic.json", id, "lam");
        is(
            &at(&found, "UZ", Some(("alpha", alpha)), "lam"),
            truth,
            1e-11,
        );
    }
    is(
        &at(&found, "NSS", None, "alpha"),
        0.605_857_764_842_28,
        1e-11,
    );
    is(&at(&found, "NSS", None, "lam"), 1.044_694_655_263, 1e-11);
}

#[test]
fn they_end_at_a_bogdanov_takens_point() {
    let asked = "--in b1,b2 --range b1=-1,0.5 --range b2=-1.5,0.2 --at b2=-1,-0.04";
    let found = special(&format!("--system {FILES}/bogdanov-takens.toml {asked}"));
    for (b2, id) in [
        (-1.0, "bt_homoclinic_b2_-1"),
        (-0.04, "bt_homoclinic_b2_-0.04"),
    ] {
        let truth = reference("codim2_starts.json", id, "b1");
        is(&at(&found, "UZ", Some(("b2", b2)), "b1"), truth, 1e-11);
    }
    is(&at(&found, "BT", None, "b1"), 0.0, 1e-15);
    is(&at(&found, "BT", None, "b2"), 0.0, 1e-15);
}

/// The orbit in the plane z = 0 does not depend on what is there outside of it. With mu it is pushed out of that plane, in which alone it does not arrive along
/// the leading direction; with k the adjoint solution is.
#[test]
fn flips_are_where_symmetry_has_them() {
    let system = format!("--system {FILES}/sandstede.toml --range m=-0.3,0.3");
    let found = special(&format!(
        "{system} --in m,mu --set k=0 --range mu=-0.9,1.1 --at mu=0.5"
    ));
    is(&at(&found, "OFS", None, "mu"), 0.0, 1e-6);
    is(&at(&found, "UZ", Some(("mu", 0.5)), "m"), 0.0, 1e-11);
    assert!(at(&found, "IFS", None, "mu").is_empty());
    let found = special(&format!("{system} --in m,k --set mu=0 --range k=-0.9,1.1"));
    is(&at(&found, "IFS", None, "k"), 0.0, 1e-6);
    is(&at(&found, "IFS", None, "m"), 0.0, 1e-11);
    assert!(at(&found, "OFS", None, "k").is_empty());
}

/// On a curve along which the saddle quantity is zero throughout no point is one of codimension two.
#[test]
fn nothing_is_invented_where_a_test_is_zero_all_along() {
    let asked = "--in mu,eps --range mu=-0.3,0.2 --range eps=0.1,1 --at eps=0.5";
    let found = special(&format!(
        "--system tests/data/cases/damped-loop.toml {asked}"
    ));
    is(&at(&found, "UZ", Some(("eps", 0.5)), "mu"), 0.0, 1e-11);
    assert!(at(&found, "NSS", None, "mu").is_empty());
    let note = found[0]["note"].as_str().expect("a note");
    assert!(note.contains("zero within its error"), "{note}");
}

/// The saddle-node on the cycle of the Morris-Lecar neuron, the saddle loop, and where one goes over into the other: by bisection of the side of the saddle-node on
/// which the orbit that leaves it returns (SciPy's DOP853, 3e-14).
#[test]
fn saddles_and_saddle_nodes_meet_in_the_non_central_orbit() {
    let asked = "--in I,phi --range I=34,44 --range phi=0.05,0.25 --at phi=0.23";
    let found = special(&format!(
        "--system tests/data/cases/morris-lecar.toml {asked}"
    ));
    let id = "morris_lecar_homoclinic_I_phi0.23";
    let truth = reference("homoclinic.json", id, "I");
    is(&at(&found, "UZ", Some(("phi", 0.23)), "I"), truth, 1e-9);
    let fold = reference("homoclinic.json", "morris_lecar_SNIC_phi1/15", "I_SN");
    is(&at(&found, "NCH", None, "I"), fold, 1e-11);
    let meet = at(&found, "NCH", None, "phi");
    assert_eq!(meet.len(), 2, "{meet:?}");
    is(&meet, 0.194_231_322_676_47, 1e-11);
    is(&at(&found, "EP", Some(("phi", 0.05)), "I"), fold, 1e-11);
}

/// AUTO-07p's demo mtn, a predator and its prey (Champneys, Kuznetsov & Sandstede 1996, Int. J. Bifurcation Chaos 6, 867): both non-central orbits, between them the saddle-nodes, and a
/// saddle, to the five or six digits of its manual.
#[test]
fn the_predator_and_its_prey_are_as_in_auto() {
    let asked = "--in Z,K --range Z=0.06,0.1 --range K=4,16 --at K=9.17683";
    let found = special(&format!("--system {FILES}/predator-prey.toml {asked}"));
    let mut meet = at(&found, "NCH", None, "K");
    meet.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let known = [5.18032, 6.61046, 6.61046];
    assert_eq!(meet.len(), known.len(), "{meet:?}");
    for ([value, off], known) in meet.iter().zip(known) {
        assert!((value - known).abs() < 2e-5 && *off < 1e-10, "{meet:?}");
    }
    let at_saddle = at(&found, "UZ", Some(("K", 9.17683)), "Z");
    assert!((at_saddle[0][0] - 7.67874e-2).abs() < 1e-7, "{at_saddle:?}");
}

/// AUTO-07p's demo cir, an electronic circuit (Freire, Rodriguez-Luis, Gamero & Ponce 1993, Physica D 62, 230): a saddle-focus that is neutral, and then a saddle. Its manual
/// has four or five digits.
#[test]
fn the_circuit_is_as_in_auto() {
    let asked = "--in nu,be --range nu=-0.78,-0.6 --range be=0.55,0.77 --at be=0.6";
    let found = special(&format!("--system {FILES}/circuit.toml {asked}"));
    for (label, nu, be) in [
        ("NSF", -0.7204001, 0.5912315),
        ("DRS", -0.7590583, 0.7428734),
    ] {
        let there = [at(&found, label, None, "nu"), at(&found, label, None, "be")];
        let near = |i: usize, known: f64| (there[i][0][0] - known).abs() < 3e-5;
        assert!(
            there[0].len() == 1 && near(0, nu) && near(1, be),
            "{label}: {there:?}"
        );
    }
    let there = at(&found, "UZ", Some(("be", 0.6)), "nu");
    assert!((there[0][0] + 0.7213093).abs() < 1e-7, "{there:?}");
    let note = |label: &str| {
        let one = found.iter().find(|point| point["label"] == label);
        one.and_then(|point| point["note"].as_str().map(str::to_owned))
    };
    let says = note("UZ").expect("a note");
    assert!(
        says.contains("Shilnikov's condition does not hold"),
        "{says}"
    );
}

#[test]
fn what_it_has_no_use_for_is_refused() {
    for option in ["--criticality", "--crosscheck rodas4"] {
        let ended = command::twinslip(&format!(
            "locus homoclinic --system lorenz --in r,s --range r=5,40 --range s=5,15 {option}"
        ));
        assert_eq!(ended.code, 2, "{}", ended.err);
        let name = option.split(' ').next().expect("a name");
        assert!(ended.err.contains(name), "{}", ended.err);
    }
}
