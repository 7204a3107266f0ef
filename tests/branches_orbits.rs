//! Branches of periodic orbits, against points known to twenty digits.

use crate::common;
use crate::common::heard;
use crate::common::returns;
use common::{data, number};
use heard::{Heard, assert_known, slab, two};
use returns::returns;
use std::ops::ControlFlow::Continue;
use twinslip::bifurcation::{
    BranchRequest, BranchRow, Criticality, Event, Label, Parameter, Special, equilibria, orbits,
};
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::Choice;
use twinslip::number::Uncertain;

/// Relative bar for parameters and periods.
const BAR: f64 = 1e-10;

fn along_driving(stiffness: f64) -> BranchRequest {
    BranchRequest::new(two(1.0, stiffness), Parameter::Driving, (1e-3, 1e4))
}

fn branch(request: &BranchRequest) -> Heard {
    Heard::of_all(|seen| orbits::branch(request, seen))
}

fn label(name: &str) -> Label {
    Label::named(name.split(' ').next().expect("a word")).expect("a label")
}

#[test]
fn bifurcations_along_branches_are_where_they_are_known_to_be() {
    let known = data("orbit_bifurcations.json");
    let heard = branch(&along_driving(0.14));
    for point in known["K=0.14"].as_array().expect("points") {
        let (name, exact) = (
            point["type"].as_str().expect("a name"),
            number(&point["V_H"]),
        );
        let found = heard.nearest(label(name), exact);
        assert_known(name, found.driving, exact, BAR);
        assert_known(
            name,
            found.period.expect("a period"),
            number(&point["period"]),
            BAR,
        );
    }
    for stiffness in [0.13, 0.05] {
        let heard = branch(&along_driving(stiffness));
        for point in known["PF"][stiffness.to_string()]["PF"]
            .as_array()
            .expect("points")
        {
            let exact = number(&point["V_H"]);
            let found = heard.nearest(Label::Pf, exact);
            assert_known("PF", found.driving, exact, BAR);
            assert_known(
                "PF",
                found.period.expect("a period"),
                number(&point["period"]),
                BAR,
            );
        }
        if stiffness == 0.05 {
            let exact = number(&known["SN"][0]["V_H"]);
            assert_known("SN", heard.nearest(Label::Sn, exact).driving, exact, BAR);
        }
    }
}

fn names(heard: &Heard) -> Vec<(Label, String)> {
    let names = heard.special.iter().filter(|s| s.label != Label::Ep);
    names
        .map(|s| (s.label, format!("{:.6e}", s.driving.value)))
        .collect()
}

/// Orbits vanish where equilibria begin to oscillate: both tell of the same point.
#[test]
fn hopf_points_are_those_of_the_equilibria() {
    let requests = [
        along_driving(0.14),
        BranchRequest::new(two(200.0, 1.0), Parameter::Stiffness, (0.01, 0.4)),
    ];
    for request in requests {
        let heard = branch(&request);
        let of_equilibria = Heard::of_all(|seen| equilibria::branch(&request, seen));
        let found = heard.of(Label::Hb);
        assert!(found.len() > 1, "{found:?}");
        for point in found {
            let driving = point.driving.value;
            let other = of_equilibria
                .of(Label::Hb)
                .into_iter()
                .find(|s| s.driving.value == driving && s.stiffness.value == point.stiffness.value);
            let other = other.unwrap_or_else(|| panic!("{point:?}"));
            assert_eq!(point.driving.uncertainty, other.driving.uncertainty);
            assert_eq!(point.stiffness.uncertainty, other.stiffness.uncertainty);
            assert_eq!(point.coefficient, other.coefficient);
            assert_eq!(point.criticality, other.criticality);
            assert_eq!(point.note, other.note);
        }
    }
}

#[test]
fn step_limits_change_no_list() {
    for stiffness in [0.14, 0.13] {
        let list = |step: f64| {
            let request = BranchRequest {
                step,
                ..along_driving(stiffness)
            };
            names(&branch(&request))
        };
        let usual = list(1.0);
        assert_eq!(usual, list(4.0), "K = {stiffness}, longer steps");
        assert_eq!(usual, list(0.25), "K = {stiffness}, shorter steps");
        assert!(
            usual.iter().all(|(label, _)| *label != Label::Mx),
            "{usual:?}"
        );
    }
}

#[test]
fn nothing_is_invented() {
    for stiffness in [0.14, 0.135] {
        let request = BranchRequest {
            symmetry: Some(Symmetry::Symmetric),
            ..along_driving(stiffness)
        };
        let heard = branch(&request);
        assert!(heard.of(Label::Pf).is_empty(), "K = {stiffness}");
        assert_eq!(heard.of(Label::Hb).len(), 2, "K = {stiffness}");
    }
    assert!(branch(&along_driving(0.45)).special.is_empty());
    // No symmetric orbit, and on the asymmetric branch nothing but its two ends.
    let heard = branch(&along_driving(0.3));
    let labels: Vec<Label> = heard.special.iter().map(|s| s.label).collect();
    assert_eq!(labels, [Label::Hb, Label::Hb]);
}

#[test]
fn rows_are_orbits() {
    use twinslip::orbit::{InitialGuess, OrbitAccuracy, Query, find};
    let request = BranchRequest {
        at: vec![0.2, 10.0],
        symmetry: Some(Symmetry::Asymmetric),
        ..along_driving(0.14)
    };
    let heard = branch(&request);
    for &driving in &request.at {
        let row = heard
            .rows
            .iter()
            .find(|row| row.driving == driving)
            .expect("a row");
        assert_eq!(row.label, Some(Label::Uz));
        let query = Query {
            symmetry: Symmetry::Asymmetric,
            begin: InitialGuess::Anywhere,
        };
        let accuracy = OrbitAccuracy::of(Choice::Taylor);
        let orbit = find(&two(driving, 0.14), &query, &accuracy)
            .expect("an orbit")
            .orbit;
        let period = row.period.expect("a period");
        assert!((period / orbit.period.value - 1.0).abs() < 1e-12);
        assert!((row.stress_range.0 - orbit.stress_min.value).abs() < 1e-6);
        assert!((row.stress_range.1 - orbit.stress_max.value).abs() < 1e-6);
        let logs = &orbit.floquet.multipliers;
        for (found, exact) in row.ln_abs_multiplier.iter().zip(logs) {
            assert!((found.expect("ln |mu|") - exact.ln_abs.value).abs() < 1e-6);
        }
        assert_eq!(row.verdict, orbit.verdict());
    }
}

#[test]
fn branches_along_the_stiffness_meet_those_along_the_driving_velocity() {
    let known = data("orbit_bifurcations.json");
    let torus = &known["K=0.14"][0];
    let driving = number(&torus["V_H"]);
    let request = BranchRequest {
        symmetry: Some(Symmetry::Asymmetric),
        ..BranchRequest::new(two(driving, 1.0), Parameter::Stiffness, (0.08, 0.4))
    };
    let heard = branch(&request);
    let found = heard.of(Label::Tr);
    let here = found
        .iter()
        .find(|s| (s.stiffness.value - 0.14).abs() < 1e-6);
    assert_known("K", here.expect("the torus").stiffness, 0.14, BAR);
}

#[test]
fn bifurcations_go_the_way_that_orbits_and_tori_beside_them_do() {
    let request = BranchRequest {
        symmetry: Some(Symmetry::Asymmetric),
        doublings: 1,
        ..along_driving(0.14)
    };
    let heard = branch(&request);
    let torus = heard.nearest(Label::Tr, 0.0767);
    assert_eq!(torus.criticality, Some(Criticality::Supercritical));
    for driving in [0.0884, 0.0998] {
        let doubling = heard.nearest(Label::Pd, driving);
        assert_eq!(doubling.criticality, Some(Criticality::Subcritical));
    }
    // The orbits of twice the period that part from it are unstable in the direction in which they part: by their smaller
    // multiplier.
    let known = heard.nearest(Label::Pd, 0.0884);
    let twice = 2.0 * known.period.expect("a period").value;
    let doubled: Vec<&BranchRow> = heard
        .rows
        .iter()
        .filter(|row| (row.period.expect("a period") / twice - 1.0).abs() < 1e-3)
        .collect();
    assert!(!doubled.is_empty());
    for row in doubled {
        assert_eq!(row.verdict, Verdict::Unstable);
        assert!(row.ln_abs_multiplier[1].expect("ln |mu|") > 0.0, "{row:?}");
    }
    // Where the multipliers of the orbit itself are of modulus 1 the returns of a point beside it come nearer, slowly.
    let field = two(torus.driving.value, 0.14).whole();
    let (early, late) = returns(&*field, torus, 0.01);
    assert!(late < early * (1.0 - 1e-3), "{early} then {late}");
    assert!(late > 0.5 * early, "{early} then {late}");
}

#[test]
fn a_second_method_finds_the_same_points() {
    let request = BranchRequest {
        symmetry: Some(Symmetry::Asymmetric),
        ..along_driving(0.14)
    };
    let heard = branch(&request);
    let mut checked = 0;
    for special in &heard.special {
        let difference = orbits::crosscheck(
            (&request.slab, &[]),
            special,
            Choice::named("rodas5p").expect("a method"),
        )
        .expect("a point");
        if let Some([driving, stiffness, period]) = difference {
            assert!(
                driving.abs() < 1e-8 && period.abs() < 1e-8,
                "{special:?}: {difference:?}"
            );
            assert_eq!(stiffness, 0.0);
            checked += 1;
        }
    }
    assert_eq!(checked, 4);
}

#[test]
fn who_has_heard_enough_is_left_alone() {
    let mut rows = 0;
    orbits::branch(&along_driving(0.14), &mut |event| {
        rows += usize::from(matches!(event, Event::Branch(_)));
        if rows == 5 {
            std::ops::ControlFlow::Break(())
        } else {
            Continue(())
        }
    })
    .expect("branches");
    assert_eq!(rows, 5);
}

/// Of a branch that is known already nothing is told, under another number neither.
#[test]
fn branches_that_are_skipped_are_not_told_of() {
    let heard = branch(&along_driving(0.14));
    let last = heard.rows.last().expect("a row").branch;
    assert!(last > 0);
    for skipped in 0..=last {
        let rest = branch(&BranchRequest {
            skip: vec![skipped],
            ..along_driving(0.14)
        });
        let mut expected = heard.rows.clone();
        expected.retain(|row| row.branch != skipped);
        assert_eq!(rest.rows, expected);
    }
}

#[test]
fn what_is_less_accurate_than_asked_for_says_so() {
    for tolerance in [1e-15, 1e-11] {
        let heard = branch(&BranchRequest {
            tolerance,
            symmetry: Some(Symmetry::Asymmetric),
            ..along_driving(0.14)
        });
        let mut accurate = 0;
        for point in &heard.special {
            let less = |x: Uncertain| x.uncertainty > tolerance * x.value;
            let is = less(point.driving) || less(point.stiffness);
            let note = point.note.as_deref().unwrap_or("");
            let says = note.contains("less accurate than asked for");
            assert_eq!(says, is, "{tolerance}: {point:?}");
            accurate += usize::from(!is);
        }
        assert_eq!(accurate == heard.special.len(), tolerance > 1e-12);
    }
}

#[test]
fn ranges_must_be_positive() {
    let mut ignored = |_| Continue(());
    let bad = BranchRequest {
        range: (0.0, 1.0),
        ..along_driving(0.14)
    };
    assert!(orbits::branch(&bad, &mut ignored).is_err_and(|e| e.is_input()));
}

/// Of one interface that ages or slips by (4) all orbits exist at K_c: a conservative system.
#[test]
fn branches_of_degenerate_hopf_points_are_vertical() {
    let parameters = Parameters::heslot_1994();
    for law in [
        AnyLaw::DieterichRuina(parameters.dieterich_ruina()),
        AnyLaw::Slip(parameters.slip()),
    ] {
        let slab = slab(law, 1, 1.0, 0.3);
        let request = BranchRequest::new(slab, Parameter::Stiffness, (0.01, 0.5));
        let heard = branch(&request);
        let labels: Vec<Label> = heard.special.iter().map(|s| s.label).collect();
        assert_eq!(labels, [Label::Hb, Label::Ep], "{:?}", heard.special);
        let (hopf, end) = (&heard.special[0], &heard.special[1]);
        let note = end.note.as_deref().expect("a note");
        assert!(note.starts_with("vertical branch"), "{note}");
        let critical = hopf.stiffness.value;
        let off = (end.stiffness.value - critical).abs();
        assert!(off <= end.stiffness.uncertainty, "{end:?}");
        assert!(end.stiffness.uncertainty < 1e-8);
        // The rows are orbits all the same, of all sizes.
        let periods: Vec<f64> = heard.rows.iter().filter_map(|row| row.period).collect();
        assert!(periods.len() > 10 && periods[periods.len() - 1] > 2.0 * periods[0]);
        for row in &heard.rows {
            assert!((row.stiffness / critical - 1.0).abs() < 1e-10, "{row:?}");
        }
    }
}

/// x'' = p x' - x - x^3: all orbits exist at p = 0, also where the system comes from a file.
#[test]
fn branches_of_conservative_systems_from_files_are_vertical() {
    let text = "name = \"undamped at 0\"
states = [\"x\", \"y\"]
[parameters]
p = -0.5
[rates]
x = \"y\"
y = \"p*y - x - x^3\"
[start]
x = 0.0
y = 0.0
";
    let file = crate::common::text::file("vertical-of-file", text);
    let ended = crate::command::twinslip(&format!(
        "branch orbits --system {file} --along p --from -0.5 --to 0.5 --format json -q"
    ));
    assert!([0, 3].contains(&ended.code), "{}", ended.err);
    let made: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
    let special = made["result"]["special"].as_array().expect("a list");
    let end = special.last().expect("an end");
    assert_eq!(end["label"], "EP", "{end}");
    let note = end["note"].as_str().expect("a note");
    assert!(note.starts_with("vertical branch: on "), "{note}");
    let [at, off] = ["/p/value", "/p/uncertainty"].map(|name| crate::command::number(end, name));
    assert!(at.abs() <= off && off < 1e-8, "{at:e} +- {off:e}");
    let rows = made["result"]["rows"].as_array().expect("rows");
    assert!(rows.len() < 80, "{}", rows.len());
}

/// No fold without a turn: next to a Hopf point that is nearly degenerate K falls, at first by less than what the continuation errs by.
#[test]
fn a_fold_is_told_of_only_where_the_parameter_turns() {
    let parameters = Parameters::heslot_1994();
    for law in [
        AnyLaw::RegularisedAgeing(parameters.regularised_ageing()),
        AnyLaw::Bounded(parameters.bounded()),
    ] {
        let slab = slab(law, 1, 1.0, 0.3);
        let request = BranchRequest::new(slab, Parameter::Stiffness, (0.38, 0.5));
        let heard = branch(&request);
        let column: Vec<f64> = heard.rows.iter().map(|row| row.stiffness).collect();
        assert!(column.windows(2).all(|pair| pair[1] < pair[0]));
        assert_eq!(heard.of(Label::Sn).len(), 0, "{:?}", heard.special);
    }
    // And where there are folds, K or V_H turns in the rows.
    let heard = branch(&along_driving(0.05));
    let folds = heard.of(Label::Sn);
    assert!(!folds.is_empty());
    for fold in folds {
        let at = heard
            .rows
            .iter()
            .position(|row| row.label == Some(Label::Sn) && row.driving == fold.driving.value);
        let at = at.expect("a row");
        let [before, here, after] = [at - 1, at, at + 1].map(|i| heard.rows[i].driving);
        assert!((here - before) * (here - after) > 0.0, "{fold:?}");
    }
}

/// The coefficient of a normal form belongs to the bifurcation: not to the branch along which that was found, nor to its nodes.
#[test]
fn coefficients_do_not_depend_on_nodes() {
    let along_stiffness = BranchRequest::new(two(3.9, 0.2), Parameter::Stiffness, (0.1, 0.5));
    let heard = branch(&along_stiffness);
    let [one] = heard.of(Label::Pf)[..] else {
        panic!("{:?}", heard.special);
    };
    let known = |special: &Special| {
        let (value, uncertainty) = (special.coefficient, special.coefficient_uncertainty);
        Uncertain::new(value.expect("one"), uncertainty.expect("its error"))
    };
    for step in [1.0, 0.4] {
        let along_driving = BranchRequest {
            step,
            ..BranchRequest::new(
                two(1.0, one.stiffness.value),
                Parameter::Driving,
                (2.0, 8.0),
            )
        };
        let heard = branch(&along_driving);
        let other = heard.nearest(Label::Pf, 3.9);
        assert!((other.driving.value / 3.9 - 1.0).abs() < 1e-10);
        assert_eq!(one.criticality, other.criticality);
        let (a, b) = (known(one), known(other));
        let off = (a.value - b.value).abs();
        assert!(off <= a.uncertainty + b.uncertainty, "{a:?}, {b:?}");
        assert!(a.uncertainty < 1e-4 * a.value.abs(), "{a:?}");
    }
}
