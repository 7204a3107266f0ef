//! Branches of equilibria of N equal interfaces: against two interfaces, all steady states at a V_H, and the whole Jacobian matrix.

use crate::cluster_equilibria::{eigenvalues, jacobian};
use crate::command::{csv, folder, object, refused, twinslip};
use crate::common::heard::{Heard, slab, spinodal};
use crate::common::{assert_close, number};
use std::ops::ControlFlow::Continue;
use twinslip::bifurcation::equilibria::{EquilibriumOfRow, branch, locus};
use twinslip::bifurcation::{
    BranchRequest, BranchRow, Event, Label, LocusKind, LocusRequest, Parameter, Special,
};
use twinslip::equilibrium::{
    Equilibrium, Symmetry, Verdict, cluster_stability, cluster_steady_states,
};
use twinslip::friction::{AnyLaw, Parameters};

const RANGE: (f64, f64) = (1e-3, 1e6);

/// Rows and special points, in their order.
fn told(request: &BranchRequest) -> (Vec<BranchRow>, Vec<Special>) {
    let (mut rows, mut special) = (Vec::new(), Vec::new());
    branch(request, &mut |event| {
        match event {
            Event::Branch(row) => rows.push(row),
            Event::Special(one) => special.push(one),
            other => panic!("nothing else is told of: {other:?}"),
        }
        Continue(())
    })
    .expect("branches");
    (rows, special)
}

fn along_driving(law: AnyLaw, interfaces: usize, stiffness: f64) -> BranchRequest {
    let slab = slab(law, interfaces, 1.0, stiffness);
    BranchRequest::new(slab, Parameter::Driving, RANGE)
}

fn of(row: &BranchRow) -> &EquilibriumOfRow {
    row.equilibrium.as_ref().expect("an equilibrium")
}

/// The special points of a command with this label: V_H with its uncertainty, ascending.
fn points(command: &str, label: &str) -> Vec<[f64; 2]> {
    let made = object(command);
    let special = made["result"]["special"]
        .as_array()
        .expect("points")
        .clone();
    let these = special.iter().filter(|one| one["label"] == label);
    let known = |one: &serde_json::Value| {
        let driving = &one["driving"];
        [number(&driving["value"]), number(&driving["uncertainty"])]
    };
    let mut all: Vec<[f64; 2]> = these.map(known).collect();
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    all
}

/// The law from a file is the same one, and its equilibria are followed step by step by their equations.
#[test]
fn two_interfaces_have_the_bifurcations_of_their_equations() {
    for (command, label, count) in [
        (
            "branch equilibria --stiffness 0.14 --from 0.06 --to 300",
            "HB",
            4,
        ),
        (
            "branch equilibria --stiffness 0.02 --from 0.06 --to 300",
            "HB",
            0,
        ),
        ("locus hopf", "EP", 4),
    ] {
        let made = points(command, label);
        let known = points(&format!("{command} --law scenes/laws/spinodal.toml"), label);
        assert_eq!((made.len(), known.len()), (count, count), "{command}");
        for ([a, p], [b, q]) in made.into_iter().zip(known) {
            assert!((a - b).abs() <= p + q, "{command}: {a} ± {p}, {b} ± {q}");
        }
    }
}

fn other_laws() -> [AnyLaw; 4] {
    let parameters = Parameters::heslot_1994();
    ["bounded", "regularised-ageing", "dieterich-ruina", "slip"]
        .map(|name| AnyLaw::named(name, parameters).expect("a law"))
}

/// Landings on some V_H are all steady states there.
fn landings_are_all_states(law: AnyLaw, interfaces: usize, at: &[f64]) -> usize {
    let stiffness = 0.14;
    let request = BranchRequest {
        at: at.to_vec(),
        ..along_driving(law, interfaces, stiffness)
    };
    let (rows, _) = told(&request);
    let mut seen = 0;
    for &driving in at {
        let what = format!("{}, N = {interfaces}, V_H = {driving}", law.name());
        let landed = |row: &&BranchRow| row.label == Some(Label::Uz) && row.driving == driving;
        let mut these: Vec<_> = rows.iter().filter(landed).collect();
        these.sort_by(|a, b| b.stress.total_cmp(&a.stress));
        let known = cluster_steady_states(&law, driving, interfaces).expect("solved");
        assert!(known.complete, "{what}");
        assert_eq!(these.len(), known.equilibria.len(), "{what}");
        for (row, state) in these.into_iter().zip(&known.equilibria) {
            let what = format!("{what}: {row:?}");
            assert_close(row.stress, state.stress.value, 1e-12, &what);
            let counts: Vec<usize> = of(row).clusters.iter().map(|one| one.count).collect();
            assert_eq!(counts, state.counts, "{what}");
            let share = of(row).share.expect("a share");
            let present: Vec<usize> = share.into_iter().filter(|&n| n > 0).collect();
            assert_eq!(counts, present, "{what}");
            for (i, one) in of(row).clusters.iter().enumerate() {
                assert_close(one.slip_rate, state.slip_rate[i], 1e-12, &what);
                assert_close(one.state, state.state()[i], 1e-12, &what);
            }
            let known = cluster_stability(&law, state, stiffness).expect("K is valid");
            assert_eq!(of(row).unstable, known.unstable(), "{what}");
            for (a, b) in of(row).eigenvalues.iter().zip(&known.eigenvalues) {
                let apart = (a.value - b.value).norm();
                assert!(apart <= a.uncertainty + b.uncertainty, "{what}");
            }
            assert_eq!(row.verdict, known.verdict, "{what}");
            seen += 1;
        }
    }
    seen
}

#[test]
fn landings_are_all_steady_states() {
    assert!(landings_are_all_states(spinodal(), 3, &[0.02, 0.073, 10.0, 1134.8, 1500.0, 5e4]) > 20);
    assert!(landings_are_all_states(spinodal(), 10, &[1.0, 4000.0, 3e5]) > 50);
    for law in other_laws() {
        landings_are_all_states(law, 4, &[0.05, 10.0, 3000.0]);
    }
}

/// The steady state that a row is of.
fn state_of(law: &AnyLaw, interfaces: usize, row: &BranchRow) -> Equilibrium {
    let found = cluster_steady_states(law, row.driving, interfaces).expect("solved");
    let off = |one: &Equilibrium| (one.stress.value - row.stress).abs();
    let nearest = { found.equilibria.into_iter() }.min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.expect("one at least")
}

#[test]
fn a_pair_of_eigenvalues_of_the_whole_matrix_crosses_at_hopf_points() {
    let mut seen = 0;
    for (law, interfaces, stiffness) in [
        (spinodal(), 3, 0.14),
        (spinodal(), 4, 0.05),
        (spinodal(), 5, 0.14),
        (other_laws()[0], 3, 0.1),
    ] {
        let (rows, special) = told(&along_driving(law, interfaces, stiffness));
        let rows = rows.iter().filter(|row| row.label == Some(Label::Hb));
        let points = special.iter().filter(|one| one.label == Label::Hb);
        for (row, point) in rows.zip(points) {
            assert_eq!(row.driving, point.driving.value);
            let state = state_of(&law, interfaces, row);
            let omega = std::f64::consts::TAU / point.period.expect("a period").value;
            let all = eigenvalues(&jacobian(&law, &state, stiffness));
            let nearest = { all.iter() }.map(|z| (z - omega * nalgebra::Complex::i()).norm());
            let apart = nearest.fold(f64::INFINITY, f64::min);
            let size = all.iter().map(|z| z.norm()).fold(0.0, f64::max);
            assert!(
                apart < 1e-11 * size + 1e-10 * omega,
                "{row:?}: {apart:e} of {size:e}"
            );
            // along K the same point is met
            let slab = slab(law, interfaces, row.driving, 1.0);
            let range = (0.1 * stiffness, 10.0 * stiffness);
            let request = BranchRequest::new(slab, Parameter::Stiffness, range);
            let (_, again) = told(&request);
            let again = again.iter().filter(|one| one.label == Label::Hb);
            let again = again.map(|one| (one.stiffness.value / stiffness - 1.0).abs());
            let off = again.fold(f64::INFINITY, f64::min);
            assert!(off < 1e-11, "{row:?}: {off:e}");
            seen += 1;
        }
    }
    assert!(seen > 12, "{seen}");
}

#[test]
fn two_states_are_born_or_die_at_folds() {
    const BESIDE: f64 = 1e-9;
    let interfaces = 5;
    let (rows, _) = told(&along_driving(spinodal(), interfaces, 0.14));
    let mut seen = 0;
    for row in rows.iter().filter(|row| row.label == Some(Label::Lp)) {
        // beside a branch point one of them may have passed it, where two clusters exchange their places
        let sorted = |mut counts: Vec<usize>| {
            counts.sort_unstable();
            counts
        };
        let counts = sorted(of(row).clusters.iter().map(|one| one.count).collect());
        let near = |factor: f64| {
            let found = cluster_steady_states(&spinodal(), row.driving * factor, interfaces);
            let found = found.expect("solved");
            assert!(found.complete, "{row:?}");
            let close = |one: &&Equilibrium| {
                sorted(one.counts.clone()) == counts && (one.stress.value - row.stress).abs() < 0.01
            };
            found.equilibria.iter().filter(close).count()
        };
        let (less, more) = (near(1.0 - BESIDE), near(1.0 + BESIDE));
        assert_eq!(less.abs_diff(more), 2, "{row:?}: {less} {more}");
        seen += 1;
    }
    assert!(seen >= 8, "{seen}");
}

#[test]
fn stability_changes_at_bifurcations_alone() {
    for (law, interfaces, stiffness) in [
        (spinodal(), 3, 0.14),
        (spinodal(), 6, 0.03),
        (spinodal(), 5, 2.0),
        (other_laws()[0], 4, 0.1),
    ] {
        let (rows, _) = told(&along_driving(law, interfaces, stiffness));
        let mut changes = 0;
        for branch in rows.chunk_by(|a, b| a.branch == b.branch) {
            // at a bifurcation itself the number is that of either side
            let plain: Vec<usize> = (0..branch.len())
                .filter(|&i| {
                    !branch[i]
                        .label
                        .is_some_and(|label| Label::BIFURCATIONS.contains(&label))
                })
                .collect();
            for pair in plain.windows(2) {
                let between = &branch[pair[0] + 1..pair[1]];
                let [a, b] = [&branch[pair[0]], &branch[pair[1]]];
                if between.is_empty() {
                    let what = format!("{} {stiffness}: {a:?} {b:?}", law.name());
                    assert_eq!(of(a).unstable, of(b).unstable, "{what}");
                    assert_eq!(a.verdict, b.verdict, "{what}");
                }
                if let [only] = between {
                    let change = of(a).unstable.abs_diff(of(b).unstable);
                    let fits = match only.label {
                        Some(Label::Hb) => change == 2,
                        Some(Label::Lp) => change == 1,
                        _ => true,
                    };
                    assert!(fits, "{a:?} {only:?} {b:?}");
                    changes += 1;
                }
            }
        }
        assert!(changes > 5, "{} {stiffness}: {changes}", law.name());
    }
}

/// With k of five sticking and all others sliding fast there are four stairs. Besides there is the end of the branch that leads to the last
/// of them, where one interface slides at a middle rate; nothing else is stable that is not all alike.
#[test]
fn stairs_are_stable() {
    let (rows, _) = told(&along_driving(spinodal(), 5, 0.14));
    let stable = rows.iter().filter(|row| row.verdict == Verdict::Stable);
    let apart = stable.filter(|row| row.symmetry == Symmetry::Asymmetric);
    let mut stairs: Vec<[usize; 3]> = apart.filter_map(|row| of(row).share).collect();
    stairs.sort_unstable();
    stairs.dedup();
    let known = [[1, 0, 4], [2, 0, 3], [3, 0, 2], [4, 0, 1], [4, 1, 0]];
    assert_eq!(stairs, known);
}

#[test]
fn one_symmetry_and_a_range_downwards() {
    let (all, _) = told(&along_driving(spinodal(), 4, 0.14));
    let request = BranchRequest {
        symmetry: Some(Symmetry::Symmetric),
        ..along_driving(spinodal(), 4, 0.14)
    };
    let (alike, special) = told(&request);
    let expected: Vec<_> = all.iter().filter(|row| row.branch == 0).cloned().collect();
    assert_eq!(alike, expected);
    assert_eq!(
        special.iter().filter(|one| one.label == Label::Bp).count(),
        2
    );
    let down = BranchRequest {
        range: (RANGE.1, RANGE.0),
        ..request.clone()
    };
    let (mut down, _) = told(&down);
    down.reverse();
    assert_eq!(alike, down);
    let request = BranchRequest {
        symmetry: Some(Symmetry::Asymmetric),
        ..request
    };
    let (apart, _) = told(&request);
    assert_eq!(apart.len() + alike.len(), all.len());
}

#[test]
fn a_scene_is_what_the_flags_say() {
    let place = folder("scene-of-shares");
    let scene = place.join("shares.toml");
    let text = "command = \"branch\"\nof = \"equilibria\"\ninterfaces = 4\nstiffness = 0.14\nfrom = 0.1\nto = 5000\nat = [1500]\n";
    std::fs::write(&scene, text).expect("written");
    let of_scene = object(&format!("run {}", scene.display()));
    let flags = "branch equilibria --interfaces 4 --stiffness 0.14 --from 0.1 --to 5000 --at 1500";
    let of_flags = object(flags);
    assert_eq!(of_scene["result"], of_flags["result"]);
    let rows = of_flags["result"]["rows"].as_array().expect("rows");
    assert!(rows.len() > 100);
    for row in rows {
        let share = ["slow", "middle", "fast"].map(|name| number(&row[name]));
        assert_eq!(share.iter().sum::<f64>(), 4.0, "{row}");
        let counts = ["count_1", "count_2", "count_3"].map(|name| row[name].as_f64());
        assert_eq!(counts.iter().flatten().sum::<f64>(), 4.0, "{row}");
        for name in ["stress", "stress_min", "stress_max", "unstable", "branch"] {
            assert!(row[name].is_number(), "{name}: {row}");
        }
        let inside = (0.1..=5000.0).contains(&number(&row["driving"]));
        assert!(inside && row["period"].is_null(), "{row}");
    }
}

#[test]
fn an_interrupted_run_goes_on() {
    let place = folder("resume-of-shares");
    let [whole, cut] = ["whole.csv", "cut.csv"].map(|name| place.join(name));
    let flags = "branch equilibria -q --interfaces 3 --stiffness 0.14";
    let run = |more: String| {
        let ended = twinslip(&format!("{flags} {more}"));
        assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{more}");
    };
    run(format!("-o {}", whole.display()));
    run(format!("-o {}", cut.display()));
    let text = std::fs::read_to_string(&cut).expect("rows");
    // two branches are there, and a part of the third
    let upto = text.len() * 3 / 5;
    let text = text[..upto].replace(", complete", ", unfinished");
    std::fs::write(&cut, text).expect("cut");
    run(format!("--resume {0} -o {0} --plot {0}.svg", cut.display()));
    let [whole, cut] = [whole, cut].map(|path| csv(&std::fs::read_to_string(path).expect("rows")));
    assert_eq!(whole, cut);
}

#[test]
fn what_makes_no_sense_is_refused_in_a_sentence() {
    let flags = "branch equilibria --stiffness 0.14";
    for (more, words) in [
        ("--interfaces 601", "between 1 and 600"),
        (
            "--interfaces 100",
            "max-points is 20000, but must be at least about",
        ),
        ("--interfaces 3 --driving 1", "cannot be given"),
        ("--interfaces 3 --at 1e9", "in the range"),
        ("--interfaces 3 --from 2 --to 2", "two different ends"),
        (
            "--interfaces 3 --crosscheck taylor",
            "applies only to orbits",
        ),
    ] {
        refused(&format!("{flags} {more}"), words);
    }
    refused(
        "branch equilibria --interfaces 3",
        "--stiffness K is missing",
    );
    refused(
        "branch equilibria --interfaces 3 --along stiffness",
        "--driving V_H is missing",
    );
}

/// The special points of curves with this label, by V_H.
fn on_curves(special: &[Special], label: Label) -> Vec<&Special> {
    let mut these: Vec<_> = special.iter().filter(|one| one.label == label).collect();
    these.sort_by(|a, b| a.driving.value.total_cmp(&b.driving.value));
    these
}

#[test]
fn curves_of_three_interfaces_cross_a_stiffness_at_the_hopf_points_there() {
    let slab = slab(spinodal(), 3, 1.0, 1.0);
    let request = LocusRequest {
        at_stiffness: vec![0.12],
        ..LocusRequest::new(slab, LocusKind::Hopf, RANGE, (1e-3, 1.0))
    };
    let curves = Heard::of_all(|seen| locus(&request, seen));
    let crossings = on_curves(&curves.special, Label::Uz);
    let (_, special) = told(&along_driving(spinodal(), 3, 0.12));
    let points = on_curves(&special, Label::Hb);
    assert_eq!(points.len(), 6);
    assert_eq!(crossings.len(), points.len());
    for (a, b) in crossings.into_iter().zip(points) {
        assert_close(a.driving.value, b.driving.value, 1e-13, "a Hopf point");
    }
    let refusal = LocusRequest {
        kind: LocusKind::Torus,
        ..request
    };
    assert!(locus(&refusal, &mut |_| Continue(())).is_err());
}
