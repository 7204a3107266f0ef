//! Curves of bifurcations of periodic orbits, against points known to twenty digits.

use crate::common;
use crate::common::heard;
use crate::common::returns;
use common::{data, number};
use heard::{Heard, assert_known, assert_sharp_claims, two};
use returns::returns;
use std::ops::ControlFlow::{Break, Continue};
use std::sync::OnceLock;
use twinslip::bifurcation::{Criticality, Event, Label, LocusKind, LocusRequest, Special, orbits};
use twinslip::equilibrium::Symmetry;
use twinslip::integrate::Choice;
use twinslip::number::Uncertain;

/// Relative bar for parameters, and for periods at small stiffness.
const BAR: f64 = 1e-10;
const BAR_OF_PERIOD: f64 = 1e-8;

fn curve(kind: LocusKind, stiffness: (f64, f64)) -> LocusRequest {
    LocusRequest::new(two(1.0, 0.1), kind, (1e-3, 1e4), stiffness)
}

fn locus(request: &LocusRequest) -> Heard {
    Heard::of_all(|seen| orbits::locus(request, seen))
}

/// All curves of a kind, down to small stiffness, followed once.
fn whole(kind: LocusKind) -> &'static Heard {
    static ALL: [OnceLock<Heard>; 4] = [const { OnceLock::new() }; 4];
    let place = match kind {
        LocusKind::Torus => 0,
        LocusKind::PeriodDoubling => 1,
        LocusKind::OrbitPitchfork => 2,
        _ => 3,
    };
    ALL[place].get_or_init(|| {
        locus(&LocusRequest {
            at_stiffness: vec![0.1, 0.05, 0.02],
            ..curve(kind, (0.005, 0.4))
        })
    })
}

#[test]
fn resonances_and_tops_are_where_they_are_known_to_be() {
    let known = data("orbit_bifurcations.json");
    let heard = whole(LocusKind::Torus);
    for point in known["resonances"].as_array().expect("points") {
        let name = match point["name"].as_str().expect("a name") {
            "1:4" => Label::R4,
            "1:3" => Label::R3,
            _ => Label::R2,
        };
        let exact = number(&point["V_H"]);
        let found = heard.nearest(name, exact);
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
    let found = heard.nearest(Label::Top, 0.1139);
    assert_known("V_H of the top", found.driving, number(&top["V_H"]), BAR);
    assert_known("K of the top", found.stiffness, number(&top["K"]), BAR);
    // The same resonance on the other curve that ends there.
    let doublings = whole(LocusKind::PeriodDoubling);
    let (here, there) = (
        heard.nearest(Label::R2, 0.099),
        doublings.nearest(Label::R2, 0.099),
    );
    assert!((here.stiffness.value / there.stiffness.value - 1.0).abs() < BAR);
    // The angle falls to pi at the resonance 1:2.
    let angles = heard.points.iter().filter_map(|point| point.angle_over_pi);
    assert!(angles.clone().fold(0.0, f64::max) > 0.999);
    // Pitchforks of orbits: K = 0.134253359245 at V_H = 1.250228463, by an independent computation to so many digits.
    let pitchforks = whole(LocusKind::OrbitPitchfork);
    let top = pitchforks.nearest(Label::Top, 1.25);
    assert!((top.driving.value / 1.250228463 - 1.0).abs() < 1e-9);
    assert!((top.stiffness.value / 0.134253359245 - 1.0).abs() < 1e-11);
}

/// On the threads of several cores, and on the one of a pool that has one.
#[test]
fn what_is_found_does_not_depend_on_threads() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    let pool = pool.build().expect("a thread");
    for (kind, stiffness) in [
        (LocusKind::OrbitPitchfork, (0.09, 0.25)),
        (LocusKind::Torus, (0.15, 0.4)),
    ] {
        let request = curve(kind, stiffness);
        let follow = |most: usize| {
            let mut events = Vec::new();
            let mut seen = |event| {
                events.push(event);
                match events.len() < most {
                    true => Continue(()),
                    false => Break(()),
                }
            };
            orbits::locus(&request, &mut seen).expect("curves");
            events
        };
        let all = follow(usize::MAX);
        assert!(all.len() > 10, "{}", all.len());
        assert_eq!(pool.install(|| follow(usize::MAX)), all);
        // Whoever has had enough in the midst of a second half is told no more.
        let most = all.len() - 1;
        assert_eq!(follow(most), all[..most]);
        assert_eq!(pool.install(|| follow(most)), all[..most]);
    }
}

#[test]
fn curves_go_down_to_small_stiffness() {
    let known = data("small_stiffness.json");
    let kinds = [
        (LocusKind::Torus, "TR"),
        (LocusKind::PeriodDoubling, "PD"),
        (LocusKind::OrbitPitchfork, "PF"),
        (LocusKind::OrbitSaddleNode, "SN"),
    ];
    let mut ratios = Vec::new();
    for (kind, name) in kinds {
        let heard = whole(kind);
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
            let found = heard.special.iter().find(here);
            let found = found.unwrap_or_else(|| panic!("{what} is missing"));
            ratios.push(assert_known(&what, found.driving, exact, BAR));
            let period = number(&point["period"]);
            ratios.push(assert_known(
                &what,
                found.period.expect("a period"),
                period,
                BAR_OF_PERIOD,
            ));
        }
    }
    assert_sharp_claims(ratios);
}

/// A piece of a curve that tells which way each bifurcation goes, with steps this much longer.
fn with_criticality(
    kind: LocusKind,
    driving: (f64, f64),
    stiffness: (f64, f64),
    step: f64,
) -> Heard {
    locus(&LocusRequest {
        criticality: true,
        at_stiffness: vec![0.05, 0.025],
        driving,
        step,
        ..curve(kind, stiffness)
    })
}

fn tori() -> &'static Heard {
    static TORI: OnceLock<Heard> = OnceLock::new();
    TORI.get_or_init(|| with_criticality(LocusKind::Torus, (1e-3, 1e4), (0.02, 0.1), 1.0))
}

/// Points at which the cubic coefficient is zero: the same from longer and shorter steps along other pieces, and as many as there are.
#[test]
fn bifurcations_change_the_way_they_go_where_the_coefficient_is_zero() {
    let (doubling, pitchfork) = (LocusKind::PeriodDoubling, LocusKind::OrbitPitchfork);
    let torus = with_criticality(LocusKind::Torus, (0.054, 0.055), (0.033, 0.035), 0.5);
    let cases = [
        (Label::Ch, tori(), &torus),
        (
            Label::Gpd,
            &with_criticality(doubling, (0.06, 0.1), (0.08, 0.12), 2.0),
            &with_criticality(doubling, (0.08, 0.0845), (0.088, 0.1), 0.5),
        ),
        (
            Label::Cp,
            &with_criticality(pitchfork, (0.05, 0.08), (0.02, 0.1), 2.0),
            &with_criticality(pitchfork, (0.058, 0.06), (0.03, 0.033), 0.5),
        ),
    ];
    for (label, long, short) in cases {
        assert!(long.of(Label::Mx).is_empty() && short.of(Label::Mx).is_empty());
        let (long, short) = (long.of(label), short.of(label));
        assert_eq!((long.len(), short.len()), (1, 1), "{label:?}");
        for (a, b) in long.iter().zip(&short) {
            for (a, b) in [(a.driving, b.driving), (a.stiffness, b.stiffness)] {
                assert!(
                    (a.value - b.value).abs() <= a.uncertainty + b.uncertainty,
                    "{label:?}: {a:?} and {b:?}"
                );
                assert!(a.uncertainty < 1e-8 * a.value, "{label:?}: {a:?}");
            }
        }
    }
    // The degenerate pitchfork is where the curve of folds ends: K = 0.0314028, V_H = 0.0591300 by an independent computation.
    let folds = whole(LocusKind::OrbitSaddleNode);
    let end = folds.of(Label::Cp)[0];
    assert!((end.stiffness.value - 0.0314028).abs() < 5e-8);
    assert!((end.driving.value - 0.0591300).abs() < 5e-8);
    // The other flank goes on to smaller K.
    let flank = folds.points.iter().filter(|p| p.driving.value < 0.08);
    let last = flank
        .map(|p| p.stiffness.value)
        .fold(f64::INFINITY, f64::min);
    assert!((last / end.stiffness.value - 1.0).abs() < 1e-4, "{last}");
}

/// Above the Chenciner point what is beside the orbit comes nearer, below it goes away.
#[test]
fn returns_go_the_way_that_the_coefficient_says() {
    let heard = tori();
    for (stiffness, way) in [
        (0.05, Criticality::Supercritical),
        (0.025, Criticality::Subcritical),
    ] {
        let here = heard
            .special
            .iter()
            .find(|s| s.stiffness.value == stiffness);
        let here = here.expect("a torus bifurcation");
        assert_eq!(here.criticality, Some(way));
        let field = two(here.driving.value, stiffness).whole();
        let (early, late) = returns(&*field, here, 0.03);
        println!("{stiffness} {early} {late}");
        assert_eq!(
            late < early,
            way == Criticality::Supercritical,
            "{early} then {late}"
        );
        assert!((late / early - 1.0).abs() > 1e-5, "{early} then {late}");
    }
}

/// Pitchforks in another formulation, and orbits along which the interfaces come near each other.
#[test]
fn a_second_method_finds_the_same_points() {
    let method = Choice::named("rodas5p").expect("a method");
    for (kind, label, driving) in [
        (LocusKind::OrbitPitchfork, Label::Uz, 0.0665),
        (LocusKind::OrbitPitchfork, Label::Uz, 0.0554),
        (LocusKind::PeriodDoubling, Label::Uz, 0.0585),
        (LocusKind::PeriodDoubling, Label::Uz, 0.0664),
        (LocusKind::OrbitSaddleNode, Label::Uz, 0.0665),
        (LocusKind::OrbitSaddleNode, Label::Uz, 0.1642),
        (LocusKind::Torus, Label::Uz, 0.0570),
        (LocusKind::Torus, Label::R4, 0.0549),
    ] {
        let special = whole(kind).nearest(label, driving);
        assert!((special.driving.value / driving - 1.0).abs() < 1e-2);
        let slab = two(1.0, 0.1);
        let difference = orbits::crosscheck((&slab, &[]), special, method).expect("a point");
        let [driving, stiffness, period] = difference.expect("an orbit");
        let largest = driving.abs().max(stiffness.abs()).max(period.abs());
        assert!(largest < 1e-9, "{kind:?} {special:?}: {difference:?}");
    }
}

/// The tops of all curves, from ranges that begin elsewhere; and several curves at once are the same.
#[test]
fn tops_are_found_from_any_range() {
    let kinds = [
        (LocusKind::PeriodDoubling, 1),
        (LocusKind::Torus, 1),
        (LocusKind::OrbitPitchfork, 1),
    ];
    for range in [(0.09, 0.25), (0.1, 0.3)] {
        let requests = kinds.map(|(kind, _)| curve(kind, range));
        let mut together: Vec<Vec<Special>> = vec![Vec::new(); kinds.len()];
        orbits::loci(&requests, &mut |i, event| {
            if let Event::Special(special) = event {
                together[i].push(special);
            }
            Continue(())
        })
        .expect("curves");
        for ((request, (kind, count)), together) in requests.iter().zip(kinds).zip(&together) {
            let alone = locus(request);
            let tops = |all: &[Special]| all.iter().filter(|s| s.label == Label::Top).count();
            assert_eq!(tops(&alone.special), count, "{kind:?} {range:?}");
            assert_eq!(tops(together), count, "{kind:?} {range:?}");
            assert_eq!(alone.special.len(), together.len(), "{kind:?} {range:?}");
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

/// The folds of orbits have their top at K = 0.0722: wherever the range ends above that, they are found.
#[test]
fn curves_with_low_tops_are_found_from_any_range() {
    for largest in [0.08, 0.3] {
        let request = LocusRequest {
            symmetry: Some(Symmetry::Asymmetric),
            ..curve(LocusKind::OrbitSaddleNode, (0.065, largest))
        };
        let heard = locus(&request);
        let tops = heard.of(Label::Top);
        assert_eq!(tops.len(), 1, "{largest}");
        assert!((tops[0].stiffness.value - 0.0722).abs() < 1e-4);
    }
}

/// Of a curve that is known already nothing is told, under another number neither.
#[test]
fn curves_that_are_skipped_are_not_told_of() {
    let all = curve(LocusKind::PeriodDoubling, (0.07, 0.12));
    let heard = locus(&all);
    for skipped in [0, 1] {
        let rest = locus(&LocusRequest {
            skip: vec![skipped],
            ..all.clone()
        });
        let mut expected = heard.points.clone();
        expected.retain(|point| point.curve != skipped);
        assert!(!expected.is_empty());
        assert_eq!(rest.points, expected);
    }
}

#[test]
fn what_is_less_accurate_than_asked_for_says_so() {
    for tolerance in [1e-15, 1e-11] {
        let heard = locus(&LocusRequest {
            tolerance,
            ..curve(LocusKind::Torus, (0.15, 0.4))
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
        assert_eq!(accurate > 2, tolerance > 1e-12);
    }
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
}
