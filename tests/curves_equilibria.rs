//! Curves of pitchforks, folds and Hopf points of equilibria, against references of 20 and more digits.

use crate::common;
use crate::common::heard;
use common::{assert_close, data, number, relative};
use heard::{Heard, assert_same, assert_sharp, slab, spinodal};
use std::ops::ControlFlow;
use twinslip::Error;
use twinslip::bifurcation::equilibria::locus;
use twinslip::bifurcation::{Criticality, Event, Label, LocusKind, LocusRequest};
use twinslip::equilibrium::{Solver, Symmetry, stability, steady_states};
use twinslip::friction::{AnyLaw, Parameters};

fn hopf_curves(interfaces: usize, stiffness: (f64, f64)) -> LocusRequest {
    let slab = slab(spinodal(), interfaces, 1.0, 1.0);
    LocusRequest::new(slab, LocusKind::Hopf, (1e-4, 1e7), stiffness)
}

fn curves(request: &LocusRequest) -> Heard {
    Heard::of_all(|seen| locus(request, seen))
}

#[test]
fn no_hopf_points_where_there_are_none() {
    let heard = curves(&hopf_curves(2, (0.4, 10.0)));
    assert!(heard.points.is_empty() && heard.special.is_empty());
}

/// As many points as are allowed are handed on, then comes an error.
#[test]
fn a_curve_has_no_more_points_than_allowed() {
    let request = LocusRequest {
        kind: LocusKind::Pitchfork,
        step: 1e-3,
        max_points: 7,
        ..hopf_curves(2, (1e-3, 1.0))
    };
    let mut points = 0;
    let ended = locus(&request, &mut |event| {
        points += usize::from(matches!(event, Event::Locus(_)));
        ControlFlow::Continue(())
    });
    assert_eq!(ended, Err(Error::TooManyPoints { limit: 7 }));
    assert_eq!(points, 7);
}

#[test]
fn the_tops_of_the_hopf_curves() {
    let heard = curves(&hopf_curves(2, (1e-3, 1.0)));
    let tops = heard.of(Label::Top);
    let known = &data("steady_states.json")["constants"];
    let expected = [
        ("max_k_c_sym_V_H", "max_k_c_sym(=half)"),
        ("max_kstar_V_H", "max_kstar"),
    ];
    assert_eq!(tops.len(), expected.len());
    for (top, (v, k)) in tops.iter().zip(expected) {
        assert_sharp(v, top.driving, number(&known[v]));
        assert_sharp(k, top.stiffness, number(&known[k]));
    }
    let heard = curves(&hopf_curves(1, (1e-3, 1.0)));
    let top = heard.of(Label::Top);
    assert_eq!(top.len(), 1);
    assert_sharp(
        "V of the largest k_c",
        top[0].driving,
        number(&known["max_k_c_V"]),
    );
    assert_sharp("k_c", top[0].stiffness, number(&known["max_k_c"]));
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
    let wanted = heard.of(Label::Uz);
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
            assert_sharp(name, found.driving, truth);
        }
    }
    // four ends, of which K is exactly the range's
    let ends = heard.of(Label::Ep);
    assert_eq!(ends.len(), 4);
    assert!(ends.iter().all(|s| s.stiffness.value == 1e-3));
    assert!(
        heard
            .points
            .iter()
            .all(|row| (1e-3..=1.0).contains(&row.stiffness.value))
    );
    for row in &heard.points {
        let off = row.stiffness.uncertainty / row.stiffness.value
            + row.driving.uncertainty / row.driving.value;
        assert!(off < 1e-11, "V_H = {}: {off:e}", row.driving.value);
    }
}

#[test]
fn the_same_special_points_whatever_the_steps() {
    let list = |step: f64| {
        let request = LocusRequest {
            step,
            at_stiffness: vec![0.14],
            ..hopf_curves(2, (1e-3, 1.0))
        };
        curves(&request).list()
    };
    let usual = list(1.0);
    for step in [0.25, 4.0] {
        assert_same(&usual, &list(step), 1e-13);
    }
}

/// A range of K that cuts off the top leaves two pieces of the asymmetric curve.
#[test]
fn what_leaves_the_range_is_two_curves() {
    let heard = curves(&hopf_curves(2, (0.2, 0.3)));
    let numbers: Vec<_> = heard.points.iter().map(|row| row.curve).collect();
    assert!(numbers.is_sorted());
    assert_eq!(numbers.last(), Some(&1));
    let ends: Vec<_> = heard
        .of(Label::Ep)
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
    for row in heard.points.iter().step_by(7) {
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
            assert!(heard.of(label).is_empty(), "{}", label.name());
        }
        let super_ = Some(Criticality::Supercritical);
        assert!(heard.points.iter().all(|row| row.criticality == super_));
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
    let [hopf, fold] = [&on_hopf, &on_fold].map(|heard| heard.of(Label::Bt)[0].clone());
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
                .points
                .iter()
                .filter(|r| r.curve == number_of_curve)
                .collect();
            assert!(rows.len() > 20);
            for row in &rows {
                assert_sharp(name, row.driving, number(&reference[*name]));
            }
            assert!(
                rows.iter()
                    .any(|r| r.label == Some(Label::Uz) && r.stiffness.value == 0.14)
            );
            assert_eq!(rows[0].stiffness.value, 1e-3);
            assert_eq!(rows.last().unwrap().stiffness.value, 1.0);
        }
        assert_eq!(heard.points.last().unwrap().curve, names.len() - 1);
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
            let at = heard.of(Label::Uz);
            assert!(!at.is_empty(), "{}", law.name());
            let rate = 2.0 / interfaces as f64;
            let k = twinslip::friction::critical_stiffness(&law, rate) / interfaces as f64;
            assert_close(at[0].stiffness.value, k, 1e-13, law.name());
            if matches!(law, AnyLaw::DieterichRuina(_)) {
                let beta_less_1 = 140.0 / 349.0;
                assert_close(k, beta_less_1 / interfaces as f64, 1e-15, "(17)");
                // its Hopf points are degenerate all along: l_1 = 0
                assert_eq!(heard.of(Label::Gh).len(), 0);
                assert_eq!(heard.of(Label::Top).len(), 0);
            }
        }
    }
}

#[test]
fn an_observer_may_end_it() {
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
