//! Branches of periodic orbits and the curves of their bifurcations, against points known to twenty digits.
#![allow(missing_docs)]

use nalgebra::Vector2;
use serde_json::Value;
use std::ops::ControlFlow::Continue;
use twinslip::bifurcation::{
    BranchRequest, BranchRow, Criticality, Event, Label, LocusKind, LocusRequest, LocusRow,
    Parameter, Special, equilibria, orbits, orbits::normal_form::ReturnMap,
};
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::Choice;
use twinslip::model::Loading;
use twinslip::number::Uncertain;
use twinslip::orbit::{Polygon, Slab};

/// Relative bar for parameters, and for periods at small stiffness.
const BAR: f64 = 1e-10;
const BAR_OF_PERIOD: f64 = 1e-8;

fn slab(driving: f64, stiffness: f64) -> Slab {
    Slab {
        law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
        interfaces: 2,
        loading: Loading::new(driving, stiffness).expect("a loading"),
    }
}

fn along_driving(stiffness: f64) -> BranchRequest {
    BranchRequest::new(slab(1.0, stiffness), Parameter::Driving, (1e-3, 1e4))
}

fn curve(kind: LocusKind, stiffness: (f64, f64)) -> LocusRequest {
    LocusRequest::new(slab(1.0, 0.1), kind, (1e-3, 1e4), stiffness)
}

#[derive(Default)]
struct Heard {
    rows: Vec<BranchRow>,
    points: Vec<LocusRow>,
    special: Vec<Special>,
}

impl Heard {
    fn hear(&mut self, event: Event) {
        match event {
            Event::Branch(row) => self.rows.push(row),
            Event::Locus(row) => self.points.push(row),
            Event::Special(special) => self.special.push(special),
        }
    }

    fn of(&self, label: Label) -> Vec<&Special> {
        self.special.iter().filter(|s| s.label == label).collect()
    }
}

fn branch(request: &BranchRequest) -> Heard {
    let mut heard = Heard::default();
    orbits::branch(request, &mut |event| {
        heard.hear(event);
        Continue(())
    })
    .expect("branches");
    heard
}

fn locus(request: &LocusRequest) -> Heard {
    let mut heard = Heard::default();
    orbits::locus(request, &mut |event| {
        heard.hear(event);
        Continue(())
    })
    .expect("curves");
    heard
}

fn reference(name: &str) -> Value {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("the reference");
    serde_json::from_str(&text).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_str().expect("digits").parse().expect("a number")
}

/// Within the bar, and within what is claimed.
fn assert_known(what: &str, found: Uncertain, exact: f64, bar: f64) {
    let error = (found.value - exact).abs();
    assert!(error <= bar * exact.abs(), "{what}: {found:?}, not {exact}");
    assert!(
        error <= found.uncertainty + f64::EPSILON * exact.abs(),
        "{what}: {found:?} claims too much, {exact}"
    );
}

/// The one of this label nearest to a V_H.
fn nearest(heard: &Heard, label: Label, driving: f64) -> &Special {
    let far = |s: &&Special| (s.driving.value / driving).ln().abs();
    let all = heard.special.iter().filter(|s| s.label == label);
    all.min_by(|a, b| far(a).total_cmp(&far(b)))
        .unwrap_or_else(|| panic!("no {} near {driving}", label.name()))
}

fn label(name: &str) -> Label {
    Label::named(name.split(' ').next().expect("a word")).expect("a label")
}

#[test]
fn bifurcations_along_branches_are_where_they_are_known_to_be() {
    let known = reference("orbit_bifurcations.json");
    let heard = branch(&along_driving(0.14));
    for point in known["K=0.14"].as_array().expect("points") {
        let (name, exact) = (
            point["type"].as_str().expect("a name"),
            number(&point["V_H"]),
        );
        let found = nearest(&heard, label(name), exact);
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
            let found = nearest(&heard, Label::Pf, exact);
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
            assert_known("SN", nearest(&heard, Label::Sn, exact).driving, exact, BAR);
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
        BranchRequest::new(slab(200.0, 1.0), Parameter::Stiffness, (0.01, 0.4)),
    ];
    for request in requests {
        let heard = branch(&request);
        let mut of_equilibria = Heard::default();
        equilibria::branch(&request, &mut |event| {
            of_equilibria.hear(event);
            Continue(())
        })
        .expect("branches");
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
    for stiffness in [0.14, 0.13, 0.1] {
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
    use twinslip::orbit::{Accuracy, Begin, Query, find};
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
            begin: Begin::Anywhere,
        };
        let accuracy = Accuracy::of(Choice::Taylor);
        let orbit = find(&slab(driving, 0.14), &query, &accuracy)
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
    let known = reference("orbit_bifurcations.json");
    let torus = &known["K=0.14"][0];
    let driving = number(&torus["V_H"]);
    let request = BranchRequest {
        symmetry: Some(Symmetry::Asymmetric),
        ..BranchRequest::new(slab(driving, 1.0), Parameter::Stiffness, (0.08, 0.4))
    };
    let heard = branch(&request);
    let found = heard.of(Label::Tr);
    let here = found
        .iter()
        .find(|s| (s.stiffness.value - 0.14).abs() < 1e-6);
    assert_known("K", here.expect("the torus").stiffness, 0.14, BAR);
}

#[test]
fn resonances_and_tops_are_where_they_are_known_to_be() {
    let known = reference("orbit_bifurcations.json");
    let heard = locus(&curve(LocusKind::Torus, (0.03, 0.4)));
    for point in known["resonances"].as_array().expect("points") {
        let name = match point["name"].as_str().expect("a name") {
            "1:4" => Label::R4,
            "1:3" => Label::R3,
            _ => Label::R2,
        };
        let exact = number(&point["V_H"]);
        let found = nearest(&heard, name, exact);
        assert_known("V_H", found.driving, exact, BAR);
        assert_known("K", found.stiffness, number(&point["K"]), BAR);
        assert_known(
            "T",
            found.period.expect("a period"),
            number(&point["period"]),
            BAR,
        );
    }
    let top = &known["TR_top"];
    let found = nearest(&heard, Label::Top, 0.1139);
    assert_known("V_H of the top", found.driving, number(&top["V_H"]), BAR);
    assert_known("K of the top", found.stiffness, number(&top["K"]), BAR);
    // The same resonance on the other curve that ends there.
    let doublings = locus(&curve(LocusKind::PeriodDoubling, (0.09, 0.4)));
    let (here, there) = (
        nearest(&heard, Label::R2, 0.099),
        nearest(&doublings, Label::R2, 0.099),
    );
    assert!((here.stiffness.value / there.stiffness.value - 1.0).abs() < BAR);
    // The angle falls to pi at the resonance 1:2.
    let angles = heard.points.iter().filter_map(|point| point.angle_over_pi);
    assert!(angles.clone().fold(0.0, f64::max) > 0.999);
    // Pitchforks of orbits: K = 0.134253359245 at V_H = 1.250228463, by an independent computation to so many digits.
    let pitchforks = locus(&curve(LocusKind::OrbitPitchfork, (0.1, 0.4)));
    let top = nearest(&pitchforks, Label::Top, 1.25);
    assert!((top.driving.value / 1.250228463 - 1.0).abs() < 1e-9);
    assert!((top.stiffness.value / 0.134253359245 - 1.0).abs() < 1e-11);
}

#[test]
fn curves_go_down_to_small_stiffness() {
    let known = reference("small_stiffness.json");
    let kinds = [
        (LocusKind::Torus, "TR"),
        (LocusKind::PeriodDoubling, "PD"),
        (LocusKind::OrbitPitchfork, "PF"),
        (LocusKind::OrbitSaddleNode, "SN"),
    ];
    let mut missing = Vec::new();
    for (kind, name) in kinds {
        let request = LocusRequest {
            at_stiffness: vec![0.1, 0.05, 0.02],
            ..curve(kind, (0.005, 0.4))
        };
        let heard = locus(&request);
        for point in known["points"].as_array().expect("points") {
            if point["type"] != name {
                continue;
            }
            let (stiffness, exact) = (number(&point["K"]), number(&point["V_H"]));
            let what = format!("{} at K = {stiffness}", point["curve"]);
            let here = |s: &&Special| {
                s.stiffness.value == stiffness
                    && (s.driving.value / exact - 1.0).abs() < 1e-7
                    && (s.period.map_or(0.0, |t| t.value) / number(&point["period"]) - 1.0).abs()
                        < 1e-3
            };
            let Some(found) = heard.special.iter().find(here) else {
                missing.push((name, stiffness));
                continue;
            };
            assert_known(&what, found.driving, exact, BAR);
            let period = number(&point["period"]);
            assert_known(
                &what,
                found.period.expect("a period"),
                period,
                BAR_OF_PERIOD,
            );
        }
    }
}

/// Where a range of K ends on the way of a curve both ways begin at its end: what lies beyond is none of them.
#[test]
fn curves_stay_within_the_ranges() {
    let kinds = [
        (LocusKind::OrbitPitchfork, (0.1, 0.4), 2),
        (LocusKind::Torus, (0.1, 0.2), 3),
        (LocusKind::PeriodDoubling, (0.05, 0.12), 4),
    ];
    for (kind, range, ends) in kinds {
        let request = LocusRequest {
            at_stiffness: vec![0.11],
            ..curve(kind, range)
        };
        let heard = locus(&request);
        for row in &heard.points {
            let k = row.stiffness.value;
            assert!(k >= range.0 && k <= range.1, "{kind:?}: {row:?}");
        }
        // A piece of the torus curve ends at the resonance 1:2.
        assert_eq!(heard.of(Label::Ep).len(), ends, "{kind:?}");
        assert!(heard.of(Label::Mx).is_empty(), "{kind:?}");
        let again = heard.of(Label::Uz);
        let mut driving: Vec<f64> = again.iter().map(|s| s.driving.value).collect();
        driving.sort_by(f64::total_cmp);
        let once = driving.windows(2).all(|v| v[1] / v[0] > 1.0 + 1e-9);
        assert!(once && !driving.is_empty(), "{kind:?}: {driving:?}");
    }
    // The K at which a curve is looked for first, asked for: told once on each flank.
    let request = LocusRequest {
        at_stiffness: vec![0.1],
        ..curve(LocusKind::OrbitPitchfork, (0.05, 0.2))
    };
    assert_eq!(locus(&request).of(Label::Uz).len(), 2);
}

#[test]
fn bifurcations_go_the_way_that_orbits_and_tori_beside_them_do() {
    let request = BranchRequest {
        symmetry: Some(Symmetry::Asymmetric),
        doublings: 1,
        ..along_driving(0.14)
    };
    let heard = branch(&request);
    let torus = nearest(&heard, Label::Tr, 0.0767);
    assert_eq!(torus.criticality, Some(Criticality::Supercritical));
    for driving in [0.0884, 0.0998] {
        let doubling = nearest(&heard, Label::Pd, driving);
        assert_eq!(doubling.criticality, Some(Criticality::Subcritical));
    }
    // The orbits of twice the period that part from it are unstable in the direction in which they part: by their smaller
    // multiplier.
    let known = nearest(&heard, Label::Pd, 0.0884);
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
    let (early, late) = returns(torus);
    assert!(late < early * (1.0 - 1e-3), "{early} then {late}");
    assert!(late > 0.5 * early, "{early} then {late}");
}

/// The greatest distance from the orbit among the first returns and among the last of some thousands.
fn returns(special: &Special) -> (f64, f64) {
    const RETURNS: usize = 4000;
    const WINDOW: usize = 500;
    let (nodes, durations) = special.orbit.as_ref().expect("an orbit").nodes();
    let polygon = Polygon {
        nodes: nodes
            .iter()
            .map(|x| State::<3>::from_fn(|i, _| x[i]))
            .collect(),
        durations: durations.to_vec(),
    };
    let field = slab(special.driving.value, special.stiffness.value).whole();
    let run = |node: usize| {
        let mut map = ReturnMap::new(&*field, &polygon, node).expect("a map");
        let mut x = Vector2::new(0.01, 0.0);
        let mut distances = Vec::with_capacity(RETURNS);
        for _ in 0..RETURNS {
            x = map.at(x).filter(|x| x.norm() < 0.2)?;
            distances.push(x.norm());
        }
        let largest = |all: &[f64]| all.iter().copied().fold(0.0, f64::max);
        Some((
            largest(&distances[..WINDOW]),
            largest(&distances[RETURNS - WINDOW..]),
        ))
    };
    // A plane where the orbit is not about to jump.
    (0..polygon.nodes.len()).find_map(run).expect("a plane")
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
            &request.slab,
            None,
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
fn what_is_less_accurate_than_asked_for_says_so() {
    const WORDS: &str = "less accurate than asked for";
    for tolerance in [1e-15, 1e-11] {
        let of_branch = branch(&BranchRequest {
            tolerance,
            symmetry: Some(Symmetry::Asymmetric),
            ..along_driving(0.14)
        });
        let of_curve = locus(&LocusRequest {
            tolerance,
            ..curve(LocusKind::Torus, (0.15, 0.4))
        });
        for point in of_branch.special.iter().chain(&of_curve.special) {
            let less = |x: Uncertain| x.uncertainty > tolerance * x.value;
            let says = point.note.as_ref().is_some_and(|note| note.contains(WORDS));
            let is = less(point.driving) || less(point.stiffness);
            assert_eq!(says, is, "{tolerance}: {point:?}");
        }
        let doubling = nearest(&of_branch, Label::Pd, 0.0884);
        assert_eq!(doubling.note.is_some(), tolerance < 1e-14);
    }
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

#[test]
fn ranges_may_be_given_either_way_and_must_be_positive() {
    let forwards = locus(&curve(LocusKind::Torus, (0.15, 0.4)));
    let backwards = locus(&LocusRequest {
        driving: (1e4, 1e-3),
        ..curve(LocusKind::Torus, (0.4, 0.15))
    });
    assert!(!forwards.points.is_empty());
    assert_eq!(forwards.points, backwards.points);
    let mut ignored = |_| Continue(());
    let bad = curve(LocusKind::Torus, (-1.0, 0.4));
    assert!(orbits::locus(&bad, &mut ignored).is_err_and(|e| e.is_input()));
    let bad = BranchRequest {
        range: (0.0, 1.0),
        ..along_driving(0.14)
    };
    assert!(orbits::branch(&bad, &mut ignored).is_err_and(|e| e.is_input()));
}
