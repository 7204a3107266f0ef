//! Interfaces in clusters that move alike, of any number: against references of thirty digits, against the full space, and what a
//! cluster's own equations do not see.

use crate::command::{csv, folder, number, object, refused_in_one_line, twinslip};
use serde_json::Value;
use std::fs;

fn reference() -> Value {
    let text = include_str!("data/clusters.json");
    serde_json::from_str(text).expect("JSON")
}

#[track_caller]
fn close(made: f64, known: f64, tolerance: f64) {
    let off = (made - known).abs();
    assert!(
        off <= tolerance * known.abs().max(1e-300),
        "{made} for {known}"
    );
}

/// A value with its uncertainty contains the known one, and the uncertainty is no larger than this.
#[track_caller]
fn holds(made: &Value, known: f64, sharp: f64) {
    let (value, uncertainty) = (number(made, "/value"), number(made, "/uncertainty"));
    assert!((value - known).abs() <= uncertainty, "{made} for {known}");
    assert!(uncertainty <= sharp, "{made} for {known}");
}

/// psi as a file has it, a number for each cluster.
fn start(orbit: &Value) -> String {
    let psi = orbit["start"]["psi"].as_array().expect("a list").iter();
    let psi = psi.map(|psi| psi.as_str().map_or_else(|| psi.to_string(), str::to_owned));
    let tau = orbit["start"]["tau"].to_string();
    let all: Vec<String> = std::iter::once(tau.trim_matches('"').to_owned())
        .chain(psi)
        .collect();
    all.join(",")
}

fn decimal(value: &Value) -> f64 {
    let text = value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned);
    text.parse().expect("a number")
}

fn counts(orbit: &Value) -> Vec<u64> {
    let all = orbit["clusters"].as_array().expect("a list").iter();
    all.map(|count| decimal(count) as u64).collect()
}

fn listed<T: ToString>(all: &[T]) -> String {
    let all: Vec<String> = all.iter().map(T::to_string).collect();
    all.join(",")
}

#[test]
fn orbits_of_clusters_meet_their_references() {
    let all = reference();
    let all = all["orbits"].as_object().expect("orbits").values().cloned();
    let mut seen = 0;
    for known in all.filter(|orbit| decimal(&orbit["eta"]) == 0.0) {
        let made = object(&format!(
            "orbit --clusters {} --driving {} --stiffness {} --start {} --period-guess {}",
            listed(&counts(&known)),
            decimal(&known["V_H"]),
            decimal(&known["K"]),
            start(&known),
            decimal(&known["period"])
        ));
        let orbit = &made["result"]["orbit"];
        holds(&orbit["period"], decimal(&known["period"]), 1e-12);
        let logs = orbit["log_multipliers"].as_array().expect("a list");
        let within: Vec<&Value> = logs.iter().filter(|one| one["kind"] == "within").collect();
        let transverse = known["transverse"].as_array().expect("a list");
        assert_eq!(within.len(), transverse.len(), "{}", known["name"]);
        for (made, known) in within.iter().zip(transverse) {
            holds(&made["ln_abs"], decimal(&known["ln_mu_transverse"]), 1e-9);
            assert_eq!(decimal(&made["cluster"]), decimal(&known["cluster"]) + 1.0);
            assert_eq!(
                decimal(&made["multiplicity"]),
                decimal(&known["multiplicity"])
            );
        }
        if let Some(reduced) = known["ln_abs_multipliers_reduced"].as_array() {
            for (made, known) in logs.iter().zip(reduced) {
                holds(&made["ln_abs"], decimal(known), 1e-8);
            }
        }
        let stable = known["stable"] == true;
        let verdict = if stable { "stable" } else { "unstable" };
        assert_eq!(orbit["verdict"], verdict, "{}", known["name"]);
        seen += 1;
    }
    assert!(seen >= 2, "{seen}");
}

/// The multipliers of states that part are those of the full space.
#[test]
fn multipliers_within_clusters_are_those_of_the_full_space() {
    let cycle = [0.010_867_742_834_401_131, 0.852_316_657_340_941_2];
    for (clusters, driving, stiffness) in [([1, 2], 10.0, 0.14), ([2, 4], 20.0, 0.07)] {
        let loading = format!("--driving {driving} --stiffness {stiffness} --period-guess 3.115");
        let reduced = object(&format!(
            "orbit --clusters {} --start 9.8,{} {loading} --crosscheck none",
            listed(&clusters),
            listed(&cycle)
        ));
        let each = cycle.iter().zip(clusters);
        let each: Vec<f64> = each.flat_map(|(&psi, count)| vec![psi; count]).collect();
        let full = object(&format!(
            "orbit --interfaces {} --start 9.8,{} {loading} --crosscheck none",
            clusters[0] + clusters[1],
            listed(&each)
        ));
        let logs = |object: &Value| -> Vec<(f64, f64)> {
            let list = object["result"]["orbit"]["log_multipliers"].clone();
            let list = list.as_array().expect("a list").clone();
            let each = list.iter().flat_map(|one| {
                let times = one["multiplicity"].as_u64().unwrap_or(1) as usize;
                let one = &one["ln_abs"];
                vec![(number(one, "/value"), number(one, "/uncertainty")); times]
            });
            let mut all: Vec<_> = each.collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            all
        };
        let (reduced, full) = (logs(&reduced), logs(&full));
        assert_eq!(full.len(), clusters[0] + clusters[1]);
        assert_eq!(reduced.len(), full.len());
        for ((a, off), (b, also)) in reduced.iter().zip(&full) {
            assert!((a - b).abs() <= off + also + 1e-12, "{reduced:?} {full:?}");
        }
    }
}

/// A split of the cluster that sticks grows as its multiplier says, in the full space.
#[test]
fn a_small_split_grows_by_the_multiplier() {
    let known = reference()["orbits"]["N3_12_single_slips"].clone();
    let log = decimal(&known["transverse"][0]["ln_mu_transverse"]);
    let psi: Vec<f64> = known["start"]["psi"]
        .as_array()
        .map_or(vec![], |all| all.iter().map(decimal).collect());
    let split = 1e-5;
    let ended = object(&format!(
        "integrate --interfaces 3 --driving 10 --stiffness 0.14 --until {} --start 9.8,{},{:e},{:e} --rtol 1e-15 --method taylor --final-only",
        decimal(&known["period"]),
        psi[0],
        psi[1] * f64::exp(0.5 * split),
        psi[1] * f64::exp(-0.5 * split)
    ));
    let of = |name: &str| number(&ended["result"]["final"], name);
    let grown = ((of("/log_state_2") - of("/log_state_3")) / split).ln();
    assert!((grown - log).abs() < 1e-6, "{grown} for {log}");
}

#[test]
fn runs_of_three_meet_their_reference_and_those_of_clusters_the_full_space() {
    let known = reference()["trajectories"]["N3_K0.14_VH10"].clone();
    for end in known["ends"].as_array().expect("ends") {
        let made = object(&format!(
            "integrate --interfaces 3 --driving 10 --stiffness 0.14 --start 9.9,0.00202,0.00204,0.00206 --until {} --rtol 1e-15 --method taylor --final-only",
            decimal(&end["t"])
        ));
        let made = &made["result"]["final"];
        close(number(made, "/stress"), decimal(&end["tau"]), 1e-10);
        for i in 1..=3 {
            let psi = decimal(&end["psi"][i.to_string()]);
            close(number(made, &format!("/state_{i}")), psi, 1e-10);
        }
    }
    let run = |what: &str| {
        object(&format!(
            "integrate {what} --driving 10 --stiffness 0.14 --until 4 --rtol 1e-14 --method taylor --final-only"
        ))
    };
    let reduced = run("--clusters 1,3,2 --start 9.9,0.0021,0.0020,0.0018");
    let full = run("--interfaces 6 --start 9.9,0.0021,0.0020,0.0020,0.0020,0.0018,0.0018");
    for (mine, its) in [(1, 1), (2, 3), (3, 6)] {
        for name in ["state", "slip_rate", "slip"] {
            let made = number(&reduced["result"]["final"], &format!("/{name}_{mine}"));
            let known = number(&full["result"]["final"], &format!("/{name}_{its}"));
            close(made, known, 1e-10);
        }
    }
    let balance = |object: &Value, counts: &[f64]| {
        // dtau/dt = K (V_H - sum of rates), integrated.
        let end = &object["result"]["final"];
        let slips = counts.iter().zip(1..);
        let slip: f64 = slips
            .map(|(n, i)| n * number(end, &format!("/slip_{i}")))
            .sum();
        number(end, "/stress") - (9.9 + 0.14 * (10.0 * 4.0 - slip))
    };
    assert!(balance(&reduced, &[1.0, 3.0, 2.0]).abs() < 1e-10);
    assert!(balance(&full, &[1.0; 6]).abs() < 1e-10);
}

/// In V_H/N and N K interfaces that move alike are the same for every N: they split where those of two do.
#[test]
fn a_cluster_of_orbits_splits_at_the_scaled_pitchfork_of_two() {
    let text = include_str!("data/orbit_bifurcations.json");
    let known: Value = serde_json::from_str(text).expect("JSON");
    let pitchforks = known["PF"]["0.13"]["PF"].as_array().expect("a list");
    let folder = folder("clusters_split");
    for n in [2, 3] {
        let ratio = f64::from(n) / 2.0;
        let rows = folder.join(format!("{n}.csv"));
        let ended = twinslip(&format!(
            "branch orbits --clusters {n} --stiffness {} --from {} --to {} -o {} -q",
            0.13 / ratio,
            0.1 * ratio,
            7.0 * ratio,
            rows.display()
        ));
        assert_eq!(ended.code, 0, "{}", ended.err);
        let special = fs::read_to_string(rows.with_extension("special.csv")).expect("a file");
        let table = csv(&special);
        let column = |name: &str| table[0].iter().position(|known| known == name).expect(name);
        let splits = table.iter().filter(|row| row[0] == "BP");
        let splits: Vec<&Vec<String>> = splits.collect();
        assert_eq!(splits.len(), pitchforks.len(), "{special}");
        for (split, known) in splits.into_iter().zip(pitchforks) {
            let cell = |name: &str| split[column(name)].parse::<f64>().expect(name);
            let off = (cell("driving") - ratio * decimal(&known["V_H"])).abs();
            assert!(off <= cell("driving_uncertainty"), "{special}");
            assert!(cell("driving_uncertainty") < 1e-9, "{special}");
            let off = (cell("period") - decimal(&known["period"])).abs();
            assert!(off <= cell("period_uncertainty"), "{special}");
            assert_eq!(split[column("name")], "branch point");
            let accurate = cell("driving_uncertainty") <= 1e-11 * cell("driving");
            let note = split[column("note")].as_str();
            let less = "cluster 1 splits; less accurate than asked for";
            assert_eq!(note, if accurate { "cluster 1 splits" } else { less });
        }
        // The verdict changes there, which the subspace alone does not see.
        let table = csv(&fs::read_to_string(&rows).expect("a file"));
        let column = |name: &str| table[0].iter().position(|known| known == name).expect(name);
        let [within, verdict] = ["within_1", "verdict"].map(column);
        let mut words = Vec::new();
        for row in &table[1..] {
            let growth: f64 = row[within].parse().expect("a number");
            if growth > 1e-3 {
                assert_eq!(row[verdict], "unstable");
            }
            words.push(row[verdict].clone());
        }
        assert!(words.iter().any(|word| word == "stable"));
        assert!(words.iter().any(|word| word == "unstable"));
    }
}

/// Equilibria of clusters split where their slip rate passes an extremum of the steady stress.
#[test]
fn a_cluster_at_rest_splits_at_the_extrema_of_the_steady_stress() {
    let law = object("law --driving 1");
    let minimum = number(&law, "/result/extrema/1/slip_rate/value");
    let made = object("branch equilibria --clusters 5 --stiffness 0.14 --from 1000 --to 3000");
    let special = made["result"]["special"].as_array().expect("a list");
    let splits: Vec<&Value> = special.iter().filter(|one| one["label"] == "BP").collect();
    assert_eq!(splits.len(), 1, "{special:?}");
    holds(&splits[0]["driving"], 5.0 * minimum, 1e-8);
}

#[test]
fn starts_may_be_spread_by_a_seed() {
    let rows = |seed: u32| {
        let made = object(&format!(
            "integrate --interfaces 4 --driving 10 --stiffness 0.14 --start spread:0.2:{seed} --until 1 --points 2"
        ));
        let first = made["result"]["rows"][0].clone();
        [1, 2, 3, 4].map(|i| number(&first, &format!("/log_state_{i}")))
    };
    let steady = (1.0_f64 / (1.0 + 100.0 * 2.5)).ln();
    let (once, again, other) = (rows(7), rows(7), rows(8));
    assert_eq!(once, again);
    assert_ne!(once, other);
    for w in once {
        assert!((w - steady).abs() < 0.2, "{w} beside {steady}");
    }
    assert!(once.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn what_clusters_can_not_be_is_said() {
    let loading = "--driving 10 --stiffness 0.14 --until 1";
    for (what, sentence) in [
        (
            "--clusters 1,0",
            "must be 1 to 7 whole numbers, each at least 1",
        ),
        (
            "--clusters 1,x",
            "must be 1 to 7 whole numbers, each at least 1",
        ),
        ("--clusters 1,1,1,1,1,1,1,1", "must be 1 to 7 whole numbers"),
        (
            "--interfaces 4 --clusters 1,2",
            "together are 4, the number of --interfaces",
        ),
        ("--interfaces 0", "interfaces is 0, but must be at least 1"),
        (
            "--clusters 1,2 --start 9,0.1",
            "must be TAU,PSI1,PSI2, near-symmetric[:EPS] or spread[:EPS[:SEED]]",
        ),
        ("--interfaces 3 --start 9,0.1", "must be TAU,PSI1,...,PSI3"),
        (
            "--interfaces 3 --start spread:0.1:x",
            "must be TAU,PSI1,...,PSI3",
        ),
        ("--clusters 1,2 --set damping_2=1", "set"),
    ] {
        refused_in_one_line(&format!("integrate {what} {loading}"), sentence);
    }
}
