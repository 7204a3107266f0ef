//! Branches of equilibria, against references of 20 and more digits.

use crate::common;
use crate::common::heard;
use common::{assert_close, data, number, relative};
use heard::{Heard, assert_same, assert_sharp, slab, spinodal, two};
use std::ops::ControlFlow;
use twinslip::bifurcation::equilibria::branch;
use twinslip::bifurcation::{BranchRequest, Criticality, Label, Parameter, Special};
use twinslip::equilibrium::{Solver, Symmetry, Verdict, stability, steady_states};

fn along_driving(stiffness: f64) -> BranchRequest {
    BranchRequest::new(two(1.0, stiffness), Parameter::Driving, (1e-4, 1e7))
}

fn branches(request: &BranchRequest) -> Heard {
    Heard::of_all(|seen| branch(request, seen))
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
        let found = heard.of(Label::Hb);
        assert_eq!(found.len(), expected.len(), "K = {stiffness}");
        for (point, truth) in found.iter().zip(expected) {
            let what = format!("K = {stiffness}, V_H = {}", truth["V_H"]);
            assert_sharp(&what, point.driving, number(&truth["V_H"]));
            let period = std::f64::consts::TAU / number(&truth["omega"]);
            assert_sharp(&what, point.period.expect("a period"), period);
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
    let pitchforks = heard.of(Label::Bp);
    assert_eq!(pitchforks.len(), 2);
    for (point, [at, coefficient, criticality]) in pitchforks.iter().zip([
        ["2V_M", "pitchfork_coef_-3t2/t3_M", "super"],
        ["2V_m", "pitchfork_coef_-3t2/t3_m", "sub"],
    ]) {
        assert_sharp(at, point.driving, number(&reference[at]));
        let truth = number(&reference[coefficient]);
        assert_close(point.coefficient.expect("one"), truth, 1e-9, coefficient);
        let is = match criticality {
            "super" => Criticality::Supercritical,
            _ => Criticality::Subcritical,
        };
        assert_eq!(point.criticality, Some(is), "{at}");
    }
    let folds = heard.of(Label::Lp);
    assert_eq!(folds.len(), 1);
    assert_sharp("V_sn", folds[0].driving, number(&reference["V_sn_fold"]));
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
    assert!(heard.of(Label::Hb).is_empty());
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

#[test]
fn the_same_special_points_whatever_the_steps() {
    let list = |step: f64| {
        let request = BranchRequest {
            step,
            at: vec![1.0, 100.0],
            ..along_driving(0.05)
        };
        branches(&request).list()
    };
    let usual = list(1.0);
    for step in [0.25, 4.0] {
        assert_same(&usual, &list(step), 1e-13);
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
        let mut all: Vec<_> = heard
            .list()
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
    let ends = piece.of(Label::Ep);
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
            .of(Label::Hb)
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
                let found = heard.of(Label::Hb).iter().filter(below).count();
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
        let hopf = heard.of(Label::Hb);
        assert_eq!(hopf.len(), 1, "V_H = {v}");
        assert_close(hopf[0].stiffness.value, k, 1e-12, "K");
        assert_eq!(heard.of(Label::Uz)[0].stiffness.value, 0.5);
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
        assert!(heard.of(Label::Hb).is_empty(), "K = {stiffness}");
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
}

/// At tiny stiffness omega is lost in rounding: a Hopf point has no period then, and no number that is none.
#[test]
fn a_frequency_below_rounding_gives_no_period() {
    let of = |stiffness: f64| {
        let heard = branches(&along_driving(stiffness));
        let periods: Vec<_> = heard.of(Label::Hb).iter().map(|hb| hb.period).collect();
        assert!(!periods.is_empty());
        periods
    };
    assert!(of(0.14).iter().all(Option::is_some));
    let periods = of(9.054e-56);
    assert!(
        periods
            .iter()
            .flatten()
            .all(|period| period.value.is_finite())
    );
    assert!(periods.iter().any(Option::is_none), "{periods:?}");
}
