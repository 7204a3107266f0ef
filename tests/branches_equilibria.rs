//! Branches of equilibria and the curves of their bifurcations, against references of 20 and more digits.
#![allow(missing_docs)]

mod common;

use common::{assert_close, data, number, relative};
use std::ops::ControlFlow;
use twinslip::bifurcation::equilibria::{branch, locus};
use twinslip::bifurcation::{
    BranchRequest, BranchRow, Criticality, Event, Label, LocusKind, LocusRequest, LocusRow,
    Parameter, Special,
};
use twinslip::equilibrium::{Solver, Symmetry, Verdict, stability, steady_states};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::model::Loading;
use twinslip::number::Uncertain;
use twinslip::orbit::Slab;

fn spinodal() -> AnyLaw {
    AnyLaw::Spinodal(Parameters::heslot_1994().spinodal())
}

fn slab(law: AnyLaw, interfaces: usize, driving: f64, stiffness: f64) -> Slab {
    let loading = Loading::new(driving, stiffness).expect("a loading");
    Slab {
        law,
        interfaces,
        loading,
    }
}

fn along_driving(stiffness: f64) -> BranchRequest {
    let slab = slab(spinodal(), 2, 1.0, stiffness);
    BranchRequest::new(slab, Parameter::Driving, (1e-4, 1e7))
}

fn hopf_curves(interfaces: usize, stiffness: (f64, f64)) -> LocusRequest {
    let slab = slab(spinodal(), interfaces, 1.0, 1.0);
    LocusRequest::new(slab, LocusKind::Hopf, (1e-4, 1e7), stiffness)
}

#[derive(Default)]
struct Heard {
    rows: Vec<BranchRow>,
    curves: Vec<LocusRow>,
    special: Vec<Special>,
}

impl Heard {
    fn hear(&mut self, event: Event) -> ControlFlow<()> {
        match event {
            Event::Branch(row) => self.rows.push(row),
            Event::Locus(row) => self.curves.push(row),
            Event::Special(special) => self.special.push(special),
        }
        ControlFlow::Continue(())
    }

    fn only(&self, label: Label) -> Vec<&Special> {
        self.special.iter().filter(|s| s.label == label).collect()
    }
}

fn branches(request: &BranchRequest) -> Heard {
    let mut heard = Heard::default();
    branch(request, &mut |event| heard.hear(event)).expect("branches");
    heard
}

fn curves(request: &LocusRequest) -> Heard {
    let mut heard = Heard::default();
    locus(request, &mut |event| heard.hear(event)).expect("curves");
    heard
}

/// Within 1e-12, and within the budget, up to the rounding of the reference to a double.
#[track_caller]
fn assert_known(found: &Uncertain, truth: f64, what: &str) {
    assert_close(found.value, truth, 1e-12, what);
    let off = (found.value - truth).abs() - 0.5 * f64::EPSILON * truth.abs();
    assert!(
        off <= found.uncertainty,
        "{what}: off by {off:e}, not {:e}",
        found.uncertainty
    );
    assert!(
        found.uncertainty <= 1e-11 * truth.abs(),
        "{what}: {:e}",
        found.uncertainty
    );
}

#[test]
fn hopf_points_along_the_driving_velocity() {
    let reference = data("hopf.json");
    for (stiffness, points) in reference["points"].as_object().expect("points") {
        let heard = branches(&along_driving(stiffness.parse().expect("a number")));
        let expected: Vec<_> = ["sym", "asym"]
            .iter()
            .flat_map(|kind| points[kind].as_array().expect("a list"))
            .collect();
        let found = heard.only(Label::Hb);
        assert_eq!(found.len(), expected.len(), "K = {stiffness}");
        for (point, truth) in found.iter().zip(expected) {
            let what = format!("K = {stiffness}, V_H = {}", truth["V_H"]);
            assert_known(&point.driving, number(&truth["V_H"]), &what);
            let period = std::f64::consts::TAU / number(&truth["omega"]);
            assert_known(point.period.as_ref().expect("a period"), period, &what);
            // the reference has l_1 rounded to 12 digits: to 5e-12 at worst
            let l_1 = number(&truth["l1(<q,q>=1)"]);
            assert_close(point.coefficient.expect("l_1"), l_1, 5e-12, &what);
            assert_eq!(
                point.criticality,
                Some(Criticality::Supercritical),
                "{what}"
            );
        }
    }
}

#[test]
fn pitchforks_and_the_fold() {
    let reference = &data("steady_states.json")["constants"];
    let heard = branches(&along_driving(0.45));
    let pitchforks = heard.only(Label::Bp);
    assert_eq!(pitchforks.len(), 2);
    for (point, [at, coefficient, criticality]) in pitchforks.iter().zip([
        ["2V_M", "pitchfork_coef_-3t2/t3_M", "super"],
        ["2V_m", "pitchfork_coef_-3t2/t3_m", "sub"],
    ]) {
        assert_known(&point.driving, number(&reference[at]), at);
        let truth = number(&reference[coefficient]);
        assert_close(point.coefficient.expect("one"), truth, 1e-9, coefficient);
        let is = match criticality {
            "super" => Criticality::Supercritical,
            _ => Criticality::Subcritical,
        };
        assert_eq!(point.criticality, Some(is), "{at}");
    }
    let folds = heard.only(Label::Lp);
    assert_eq!(folds.len(), 1);
    assert_known(&folds[0].driving, number(&reference["V_sn_fold"]), "V_sn");
    let row = heard
        .rows
        .iter()
        .find(|r| r.label == Some(Label::Lp))
        .expect("a row");
    assert_close(
        row.slip_rate[0],
        number(&reference["V_sn_fold_slow"]),
        1e-12,
        "slow",
    );
    assert_close(
        row.slip_rate[1],
        number(&reference["V_sn_fold_fast"]),
        1e-12,
        "fast",
    );
    // no Hopf point at this stiffness
    assert!(heard.only(Label::Hb).is_empty());
}

/// Between special points the verdict is that of the eigenvalues of independently computed steady states, and every such state
/// is on a branch.
#[test]
fn rows_are_steady_states() {
    let request = BranchRequest {
        at: vec![0.03, 0.06, 1.0, 300.0, 1000.0, 40000.0, 50000.0],
        ..along_driving(0.14)
    };
    let heard = branches(&request);
    for &v in &request.at {
        let mut states = steady_states(&spinodal(), v, 2, Solver::Newton)
            .expect("states")
            .equilibria;
        let rows: Vec<_> = heard.rows.iter().filter(|r| r.driving == v).collect();
        assert_eq!(rows.len(), states.len(), "V_H = {v}");
        for row in rows {
            assert_eq!(row.label, Some(Label::Uz));
            let near = |e: &twinslip::equilibrium::Equilibrium| {
                relative(row.slip_rate[0], e.slip_rate[0]) < 1e-12
            };
            let state = states.remove(states.iter().position(near).expect("a steady state"));
            assert_close(row.stress, state.stress.value, 1e-13, "stress");
            assert_eq!(
                row.verdict,
                stability(&spinodal(), &state, 0.14).unwrap().verdict
            );
            assert_ne!(row.verdict, Verdict::Undecided, "V_H = {v}");
        }
    }
    for row in &heard.rows {
        let sum: f64 = row.slip_rate.iter().sum();
        assert_close(sum, row.driving, 1e-14, "V_H");
        assert!(row.slip_rate[0] <= row.slip_rate[1], "the slower one first");
        for (psi, v) in row.state.iter().zip(row.slip_rate) {
            assert_close(*psi, 1.0 / (1.0 + 100.0 * v), 1e-13, "psi");
        }
    }
}

fn list(heard: &Heard) -> Vec<(Label, f64, f64)> {
    let all = heard.special.iter();
    all.map(|s| (s.label, s.driving.value, s.stiffness.value))
        .collect()
}

#[test]
fn the_same_special_points_whatever_the_steps() {
    let request = |step: f64| BranchRequest {
        step,
        at: vec![1.0, 100.0],
        ..along_driving(0.05)
    };
    let locus_request = |step: f64| LocusRequest {
        step,
        at_stiffness: vec![0.14],
        ..hopf_curves(2, (1e-3, 1.0))
    };
    let once = (
        list(&branches(&request(1.0))),
        list(&curves(&locus_request(1.0))),
    );
    for step in [0.25, 4.0] {
        let other = (
            list(&branches(&request(step))),
            list(&curves(&locus_request(step))),
        );
        for (a, b) in [(&once.0, &other.0), (&once.1, &other.1)] {
            assert_eq!(a.len(), b.len(), "step {step}");
            for (a, b) in a.iter().zip(b) {
                assert_eq!(a.0, b.0, "step {step}");
                assert_close(a.1, b.1, 1e-13, "V_H");
                assert_close(a.2, b.2, 1e-13, "K");
            }
        }
    }
}

#[test]
fn ranges_are_honoured_and_may_run_backwards() {
    let forward = branches(&BranchRequest {
        range: (1.0, 1e6),
        at: vec![100.0],
        ..along_driving(0.14)
    });
    let backward = branches(&BranchRequest {
        range: (1e6, 1.0),
        at: vec![100.0],
        ..along_driving(0.14)
    });
    let sorted = |heard: &Heard| {
        let mut all: Vec<_> = list(heard)
            .into_iter()
            .filter(|(label, ..)| *label != Label::Ep)
            .map(|(label, v, _)| (label.name(), (v * 1e9).round()))
            .collect();
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all
    };
    assert_eq!(sorted(&forward), sorted(&backward));
    for heard in [&forward, &backward] {
        let ends: Vec<_> = heard
            .rows
            .iter()
            .filter(|r| r.label == Some(Label::Ep))
            .collect();
        assert!(ends.iter().all(|r| r.driving == 1.0 || r.driving == 1e6));
        assert!(heard.rows.iter().all(|r| (1.0..=1e6).contains(&r.driving)));
    }
    // a piece with the fold inside and both ends at the same value
    let piece = branches(&BranchRequest {
        range: (1000.0, 1e5),
        symmetry: Some(Symmetry::Asymmetric),
        ..along_driving(0.14)
    });
    let labels: Vec<_> = piece.special.iter().map(|s| s.label).collect();
    assert_eq!(labels, [Label::Ep, Label::Lp, Label::Ep]);
    let ends = piece.only(Label::Ep);
    assert!(ends.iter().all(|s| s.driving.value == 1000.0));
}

/// Just below the top of the symmetric curve, by 2e-12, there are two Hopf points that differ by 2e-5 of V_H.
#[test]
fn two_hopf_points_next_to_each_other() {
    for step in [0.5, 1.0, 3.0] {
        let request = BranchRequest {
            symmetry: Some(Symmetry::Symmetric),
            step,
            ..along_driving(0.196846504445)
        };
        let heard = branches(&request);
        let found: Vec<_> = heard
            .only(Label::Hb)
            .iter()
            .map(|s| s.driving.value)
            .collect();
        assert_eq!(found.len(), 2, "step {step}");
        let apart = found[1] / found[0] - 1.0;
        assert!(apart > 1e-6 && apart < 1e-4, "{found:?}");
    }
}

/// A Hopf point next to the pitchfork, from whichever side the branch comes: it ends just behind.
#[test]
fn a_hopf_point_next_to_the_end_of_a_branch() {
    for stiffness in [1e-4, 2e-4, 5e-4, 1e-3] {
        for range in [(1e-3, 10.0), (10.0, 1e-3), (1e6, 1e-4)] {
            for step in [0.5, 1.0, 8.0] {
                let heard = branches(&BranchRequest {
                    range,
                    step,
                    symmetry: Some(Symmetry::Asymmetric),
                    ..along_driving(stiffness)
                });
                let below = |s: &&&Special| s.driving.value < 1.0;
                let found = heard.only(Label::Hb).iter().filter(below).count();
                assert_eq!(found, 1, "K = {stiffness}, {range:?}, step {step}");
            }
        }
    }
}

#[test]
fn along_the_stiffness() {
    // the Hopf points of the other direction, met crosswise
    for (v, k, symmetry) in [
        (0.1652651673598698, 0.14, Symmetry::Symmetric),
        (231.30931024233874, 0.14, Symmetry::Asymmetric),
        (0.1279718305942495, 0.3, Symmetry::Asymmetric),
    ] {
        let request = BranchRequest {
            symmetry: Some(symmetry),
            at: vec![0.5],
            ..BranchRequest::new(
                slab(spinodal(), 2, v, 1.0),
                Parameter::Stiffness,
                (1e-3, 1.0),
            )
        };
        let heard = branches(&request);
        let hopf = heard.only(Label::Hb);
        assert_eq!(hopf.len(), 1, "V_H = {v}");
        assert_close(hopf[0].stiffness.value, k, 1e-12, "K");
        assert_eq!(heard.only(Label::Uz)[0].stiffness.value, 0.5);
        assert!(
            heard
                .rows
                .windows(2)
                .all(|w| w[0].stiffness <= w[1].stiffness)
        );
        // stiff enough, the asymmetric state is stable
        if symmetry == Symmetry::Asymmetric {
            for row in heard
                .rows
                .iter()
                .filter(|r| relative(r.stiffness, k) > 1e-9)
            {
                let expected = if row.stiffness > k {
                    Verdict::Stable
                } else {
                    Verdict::Unstable
                };
                assert_eq!(row.verdict, expected, "K = {}", row.stiffness);
            }
        }
    }
}

#[test]
fn no_hopf_points_where_there_are_none() {
    for (stiffness, symmetry) in [
        (0.45, None),
        (0.3, Some(Symmetry::Symmetric)),
        (0.2, Some(Symmetry::Symmetric)),
    ] {
        let heard = branches(&BranchRequest {
            symmetry,
            ..along_driving(stiffness)
        });
        assert!(heard.only(Label::Hb).is_empty(), "K = {stiffness}");
    }
    let heard = curves(&hopf_curves(2, (0.4, 10.0)));
    assert!(heard.curves.is_empty() && heard.special.is_empty());
}

#[test]
fn the_tops_of_the_hopf_curves() {
    let heard = curves(&hopf_curves(2, (1e-3, 1.0)));
    let tops = heard.only(Label::Top);
    let known = &data("steady_states.json")["constants"];
    let expected = [
        ("max_k_c_sym_V_H", "max_k_c_sym(=half)"),
        ("max_kstar_V_H", "max_kstar"),
    ];
    assert_eq!(tops.len(), expected.len());
    for (top, (v, k)) in tops.iter().zip(expected) {
        assert_known(&top.driving, number(&known[v]), v);
        assert_known(&top.stiffness, number(&known[k]), k);
    }
    let heard = curves(&hopf_curves(1, (1e-3, 1.0)));
    let top = heard.only(Label::Top);
    assert_eq!(top.len(), 1);
    assert_known(
        &top[0].driving,
        number(&known["max_k_c_V"]),
        "V of the largest k_c",
    );
    assert_known(&top[0].stiffness, number(&known["max_k_c"]), "k_c");
}

/// Both flanks of both curves land on the Hopf points of the branches, and on wanted V_H.
#[test]
fn curves_land_exactly_on_what_is_wanted() {
    let request = LocusRequest {
        at_stiffness: vec![0.14, 0.3],
        at_driving: vec![1.0],
        ..hopf_curves(2, (1e-3, 1.0))
    };
    let heard = curves(&request);
    let wanted = heard.only(Label::Uz);
    let at = |k: f64| {
        wanted
            .iter()
            .filter(|s| s.stiffness.value == k)
            .collect::<Vec<_>>()
    };
    assert_eq!((at(0.14).len(), at(0.3).len()), (4, 2));
    assert_eq!(wanted.iter().filter(|s| s.driving.value == 1.0).count(), 2);
    let points = &data("hopf.json")["points"];
    let truth = |k: &str| -> Vec<f64> {
        ["sym", "asym"]
            .iter()
            .flat_map(|kind| points[k][kind].as_array().expect("a list").clone())
            .map(|p| number(&p["V_H"]))
            .collect()
    };
    for (k, name) in [(0.14, "0.14"), (0.3, "0.3")] {
        for (found, truth) in at(k).iter().zip(truth(name)) {
            assert_known(&found.driving, truth, name);
        }
    }
    // four ends, of which K is exactly the range's
    let ends = heard.only(Label::Ep);
    assert_eq!(ends.len(), 4);
    assert!(ends.iter().all(|s| s.stiffness.value == 1e-3));
    assert!(
        heard
            .curves
            .iter()
            .all(|row| (1e-3..=1.0).contains(&row.stiffness.value))
    );
    for row in &heard.curves {
        let off = row.stiffness.uncertainty / row.stiffness.value
            + row.driving.uncertainty / row.driving.value;
        assert!(off < 1e-11, "V_H = {}: {off:e}", row.driving.value);
    }
}

/// A range of K that cuts off the top leaves two pieces of the asymmetric curve.
#[test]
fn what_leaves_the_range_is_two_curves() {
    let heard = curves(&hopf_curves(2, (0.2, 0.3)));
    let numbers: Vec<_> = heard.curves.iter().map(|row| row.curve).collect();
    assert!(numbers.is_sorted());
    assert_eq!(numbers.last(), Some(&1));
    let ends: Vec<_> = heard
        .only(Label::Ep)
        .iter()
        .map(|s| s.stiffness.value)
        .collect();
    assert_eq!(ends, [0.2, 0.3, 0.3, 0.2]);
}

/// Every row of the curves is a Hopf point by the eigenvalues of the equilibrium that another solver finds there.
#[test]
fn rows_of_the_curves_have_a_pair_on_the_axis() {
    let heard = curves(&hopf_curves(2, (1e-2, 1.0)));
    let mut checked = 0;
    for row in heard.curves.iter().step_by(7) {
        let (v, k) = (row.driving.value, row.stiffness.value);
        let states = steady_states(&spinodal(), v, 2, Solver::Newton)
            .unwrap()
            .equilibria;
        let least = states
            .iter()
            .flat_map(|state| stability(&spinodal(), state, k).unwrap().eigenvalues)
            .filter(|z| z.im > 0.0)
            .filter(|z| relative(std::f64::consts::TAU / z.im, row.period.unwrap()) < 1e-9)
            .map(|z| (z.re / z.im).abs())
            .fold(f64::INFINITY, f64::min);
        assert!(least < 1e-10, "V_H = {v}, K = {k}: {least:e}");
        checked += 1;
    }
    assert!(checked > 20);
}

/// What is said of degenerate points: none on the curves of the paper's parameters above K = 1e-12, where all are supercritical.
#[test]
fn neither_degenerate_nor_double_points() {
    for interfaces in [1, 2] {
        let request = LocusRequest {
            criticality: true,
            ..hopf_curves(interfaces, (1e-5, 1.0))
        };
        let heard = curves(&request);
        for label in [Label::Gh, Label::Bt, Label::Zh] {
            assert!(heard.only(label).is_empty(), "{}", label.name());
        }
        let super_ = Some(Criticality::Supercritical);
        assert!(heard.curves.iter().all(|row| row.criticality == super_));
    }
}

/// A law that hardly weakens has a curve of Hopf points that ends on the fold line, at K = 2.45e-3: there both eigenvalues are
/// zero, by the eigenvalues too.
#[test]
fn a_curve_of_hopf_points_ends_on_the_fold_line() {
    let law = AnyLaw::Spinodal(
        Parameters::new(0.0349, 0.15, 0.369, 1.0, 1.0)
            .unwrap()
            .spinodal(),
    );
    let request = |kind: LocusKind| LocusRequest {
        kind,
        slab: slab(law, 2, 1.0, 1.0),
        ..hopf_curves(2, (1e-4, 1.0))
    };
    let (on_hopf, on_fold) = (
        curves(&request(LocusKind::Hopf)),
        curves(&request(LocusKind::SaddleNode)),
    );
    let [hopf, fold] = [&on_hopf, &on_fold].map(|heard| heard.only(Label::Bt)[0].clone());
    assert_close(hopf.stiffness.value, fold.stiffness.value, 1e-12, "K");
    assert_close(hopf.driving.value, fold.driving.value, 1e-12, "V_H");
    assert!(hopf.stiffness.uncertainty < 1e-11);
    // a little below the fold, where there is an equilibrium, two eigenvalues are small beside the third
    let v = fold.driving.value * (1.0 - 1e-8);
    let states = steady_states(&law, v, 2, Solver::Newton)
        .unwrap()
        .equilibria;
    let asymmetric = states
        .iter()
        .find(|e| e.symmetry == Symmetry::Asymmetric)
        .unwrap();
    let mut sizes: Vec<_> = stability(&law, asymmetric, fold.stiffness.value)
        .unwrap()
        .eigenvalues
        .iter()
        .map(|z| z.norm())
        .collect();
    sizes.sort_by(f64::total_cmp);
    assert!(sizes[1] < 1e-2 * sizes[2], "{sizes:?}");
}

#[test]
fn vertical_lines_of_pitchforks_and_folds() {
    let reference = &data("steady_states.json")["constants"];
    let request = |kind: LocusKind| LocusRequest {
        kind,
        at_stiffness: vec![0.14],
        criticality: true,
        ..hopf_curves(2, (1e-3, 1.0))
    };
    for (kind, names) in [
        (LocusKind::Pitchfork, &["2V_M", "2V_m"][..]),
        (LocusKind::SaddleNode, &["V_sn_fold"]),
    ] {
        let heard = curves(&request(kind));
        for (number_of_curve, name) in names.iter().enumerate() {
            let rows: Vec<_> = heard
                .curves
                .iter()
                .filter(|r| r.curve == number_of_curve)
                .collect();
            assert!(rows.len() > 20);
            for row in &rows {
                assert_known(&row.driving, number(&reference[*name]), name);
            }
            assert!(
                rows.iter()
                    .any(|r| r.label == Some(Label::Uz) && r.stiffness.value == 0.14)
            );
            assert_eq!(rows[0].stiffness.value, 1e-3);
            assert_eq!(rows.last().unwrap().stiffness.value, 1.0);
        }
        assert_eq!(heard.curves.last().unwrap().curve, names.len() - 1);
    }
}

/// One interface oscillates below k_c (16), whatever the law; that of the Dieterich-Ruina law is beta - 1 (17).
#[test]
fn one_interface_and_every_law() {
    let p = Parameters::heslot_1994();
    for law in [
        spinodal(),
        AnyLaw::Bounded(p.bounded()),
        AnyLaw::RegularisedAgeing(p.regularised_ageing()),
        AnyLaw::DieterichRuina(p.dieterich_ruina()),
        AnyLaw::Slip(p.slip()),
    ] {
        for interfaces in [1, 2] {
            let request = LocusRequest {
                slab: slab(law, interfaces, 1.0, 1.0),
                at_driving: vec![2.0],
                ..hopf_curves(interfaces, (1e-3, 1.0))
            };
            let heard = curves(&request);
            let at = heard.only(Label::Uz);
            assert!(!at.is_empty(), "{}", law.name());
            let rate = 2.0 / interfaces as f64;
            let k = twinslip::friction::critical_stiffness(&law, rate) / interfaces as f64;
            assert_close(at[0].stiffness.value, k, 1e-13, law.name());
            if matches!(law, AnyLaw::DieterichRuina(_)) {
                let beta_less_1 = 140.0 / 349.0;
                assert_close(k, beta_less_1 / interfaces as f64, 1e-15, "(17)");
                // its Hopf points are degenerate all along: l_1 = 0
                assert_eq!(heard.only(Label::Gh).len(), 0);
                assert_eq!(heard.only(Label::Top).len(), 0);
            }
        }
    }
}

#[test]
fn an_observer_may_end_it() {
    let mut rows = 0;
    branch(&along_driving(0.14), &mut |_| {
        rows += 1;
        if rows == 5 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })
    .expect("no error");
    assert_eq!(rows, 5);
    let mut rows = 0;
    locus(&hopf_curves(2, (1e-3, 1.0)), &mut |_| {
        rows += 1;
        ControlFlow::Break(())
    })
    .expect("no error");
    assert_eq!(rows, 1);
}

#[test]
fn what_makes_no_sense_is_bad_input() {
    let bad = [
        BranchRequest {
            range: (1.0, 1.0),
            ..along_driving(0.1)
        },
        BranchRequest {
            range: (-1.0, 1.0),
            ..along_driving(0.1)
        },
        BranchRequest {
            range: (1.0, f64::NAN),
            ..along_driving(0.1)
        },
        BranchRequest {
            step: 0.0,
            ..along_driving(0.1)
        },
        BranchRequest {
            at: vec![-3.0],
            ..along_driving(0.1)
        },
        BranchRequest {
            slab: slab(spinodal(), 1, 1.0, 0.1),
            symmetry: Some(Symmetry::Asymmetric),
            ..along_driving(0.1)
        },
    ];
    for request in bad {
        let error = branch(&request, &mut |_| ControlFlow::Continue(())).unwrap_err();
        assert!(error.is_input(), "{error}");
    }
    let torus = LocusRequest {
        kind: LocusKind::Torus,
        ..hopf_curves(2, (0.1, 1.0))
    };
    assert!(
        locus(&torus, &mut |_| ControlFlow::Continue(()))
            .unwrap_err()
            .is_input()
    );
    let single = LocusRequest {
        kind: LocusKind::Pitchfork,
        ..hopf_curves(1, (0.1, 1.0))
    };
    assert!(
        locus(&single, &mut |_| ControlFlow::Continue(()))
            .unwrap_err()
            .is_input()
    );
}
