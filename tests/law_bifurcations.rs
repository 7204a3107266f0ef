//! Bifurcations along constants of the law, and in planes of which they are a coordinate. What is known of them was computed in
//! 128-bit arithmetic by two methods, for the decimals of the parameters.

use crate::common::assert_close;
use std::f64::consts::TAU;
use std::ops::ControlFlow::{Break, Continue};
use twinslip::bifurcation::Label;
use twinslip::bifurcation::equilibria::generic::{FieldEquilibria, FoundEquilibrium, Onward};
use twinslip::bifurcation::equilibria::generic_curve::{EquilibriumBifurcation, EquilibriumCurve};
use twinslip::continuation::Met;
use twinslip::continuation::{Settings, Stop};
use twinslip::equilibrium::Symmetry;
use twinslip::field::Vector;
use twinslip::friction::{AnyLaw, Law, Parameters};
use twinslip::integrate::AnyField;
use twinslip::model::{Loading, Parameter};
use twinslip::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, InterfaceSystem, OverLoadings, OverLogarithms,
    Palc, PalcSettings, ParametrisedField, ShootingNodes, TestFunction, Tracer, hopf_points,
};

fn slab(driving: f64, stiffness: f64) -> InterfaceSystem {
    InterfaceSystem {
        law: AnyLaw::named("spinodal", Parameters::heslot_1994()).unwrap(),
        interfaces: 2,
        loading: Loading::new(driving, stiffness).unwrap(),
    }
}

/// The symmetric equilibria at V_H = 10, K = 0.14 along a constant.
fn along(name: &str, from: f64, settings: &Settings) -> Vec<FoundEquilibrium> {
    let slab = slab(10.0, 0.14).with(name, from).unwrap();
    let fields = |value| -> AnyField<'_> {
        let slab = slab.with(name, value).expect("positive");
        AnyField::new::<3>(slab.whole())
    };
    let family = FieldEquilibria {
        fields: &fields,
        along: name,
        scale: None,
        bounds: &[],
    };
    let w = slab.steady_log_state();
    let start = Vector::from_column_slice(&[slab.steady_stress(), w, w]);
    let growing = from == settings.range.0;
    let mut found = Vec::new();
    let branch = family
        .follow(
            &Onward::along(start, from, growing),
            settings,
            &mut |point| {
                found.push(point.clone());
                Continue(())
            },
        )
        .unwrap();
    assert_eq!(branch.stopped, Stop::RangeEnd);
    found
}

fn only(points: &[FoundEquilibrium], label: Label) -> &FoundEquilibrium {
    let mut all = points.iter().filter(|point| point.label == Some(label));
    let first = all.next().expect("one");
    assert!(all.next().is_none(), "{label:?}");
    first
}

#[test]
fn equilibria_bifurcate_along_a_constant_of_the_law() {
    let in_c = along(
        "residual_strength",
        1e-3,
        &Settings::new((1e-3, 0.1), 5e-3).unwrap(),
    );
    let hopf = only(&in_c, Label::Hb);
    assert_close(hopf.parameter, 0.018735943401831972, 1e-10, "Hopf in c");
    assert_close(hopf.state[0], 10.063107232323294, 1e-12, "its stress");
    let omega = TAU / hopf.period.expect("a period");
    assert_close(omega, 2.6483957456327074, 1e-10, "its frequency");
    let pitchfork = only(&in_c, Label::Bp);
    assert_close(
        pitchfork.parameter,
        0.08030597350672092,
        1e-12,
        "pitchfork in c",
    );
    assert_close(pitchfork.state[0], 10.408382364344998, 1e-12, "its stress");
    let in_r = along(
        "healing_time",
        5.0,
        &Settings::new((0.3, 5.0), 0.1).unwrap(),
    );
    let pitchfork = only(&in_r, Label::Bp);
    assert_close(
        pitchfork.parameter,
        0.5026668977839942,
        1e-12,
        "pitchfork in R",
    );
    assert_close(pitchfork.state[0], 10.995748755511173, 1e-12, "its stress");
}

#[test]
fn pitchforks_lie_at_the_extrema_of_steady_stress_for_any_residual_strength() {
    for (c, known) in [
        (5e-4, [0.04986015430333202, 1620.5405123385333]),
        (8e-4, [0.049861961420325514, 1012.8041208466026]),
    ] {
        let slab = slab(10.0, 0.14).with("residual_strength", c).unwrap();
        let extrema = slab.law.steady_extrema();
        assert_eq!(extrema.len(), 2);
        for (v, known) in extrema.iter().zip(known) {
            assert_close(2.0 * v, known, 1e-13, "a pitchfork");
        }
    }
}

/// V_H and the frequency at the Hopf points of K = 0.14, by V_H: at c = 0.0008 and at c = 0.0005.
const HOPF: [(Symmetry, [[f64; 2]; 2]); 4] = [
    (
        Symmetry::Asymmetric,
        [
            [0.06303677609322199, 0.020663936676223866],
            [0.06303242135287633, 0.020662352560108323],
        ],
    ),
    (
        Symmetry::Symmetric,
        [
            [0.16523005551624834, 0.04628595970101988],
            [0.16517743824108183, 0.04627201574729297],
        ],
    ),
    (
        Symmetry::Symmetric,
        [
            [238.77879124906315, 63.177577145728],
            [382.16661131142916, 101.11443039207036],
        ],
    ),
    (
        Symmetry::Asymmetric,
        [
            [289.1508780219383, 108.19213682823572],
            [462.6755827406521, 173.1191567943141],
        ],
    ),
];

#[test]
fn hopf_points_are_followed_in_the_plane_of_driving_and_residual_strength() {
    let slab = slab(10.0, 0.14);
    let names = ["driving", "residual_strength"];
    let family = OverLogarithms::new(slab, Symmetry::Asymmetric, names).unwrap();
    let curve = EquilibriumCurve {
        family: &family,
        kind: EquilibriumBifurcation::Hopf,
    };
    let ends = [8e-4_f64, 5e-4].map(f64::ln);
    let mut settings = Settings::new((ends[1], 1e-3_f64.ln()), 0.1).unwrap();
    settings.wanted = vec![ends[0]];
    for symmetry in [Symmetry::Symmetric, Symmetry::Asymmetric] {
        let mut begun = hopf_points(&slab, symmetry, Parameter::Driving).unwrap();
        begun.sort_by(|a, b| a.driving.total_cmp(&b.driving));
        let known: Vec<_> = HOPF.iter().filter(|(of, _)| *of == symmetry).collect();
        assert_eq!(begun.len(), known.len());
        for (hopf, (_, known)) in begun.iter().zip(known) {
            let w = &hopf.equilibrium.log_state;
            let start = Vector::from_column_slice(&[hopf.equilibrium.stress.value, w[0], w[1]]);
            let at = [hopf.driving.ln(), settings.range.1];
            let mut found = Vec::new();
            let branch = curve
                .follow((&start, at), false, &settings, &mut |point| {
                    if ends.contains(&point.at[1]) {
                        found.push([point.at[0].exp(), point.frequency.expect("a pair")]);
                    }
                    Continue(())
                })
                .unwrap();
            assert_eq!(branch.stopped, Stop::RangeEnd);
            assert_eq!(found.len(), 2);
            for (found, known) in found.iter().zip(known) {
                assert_close(found[0], known[0], 1e-10, "V_H");
                assert_close(found[1], known[1], 1e-10, "omega");
            }
        }
    }
}

/// What is known of a bifurcation of orbits: their symmetry, V_H, K, c, its start, its period.
struct Known {
    symmetry: Symmetry,
    driving: f64,
    stiffness: f64,
    residual_strength: f64,
    tau: f64,
    psi: [f64; 2],
    period: f64,
    kind: TestFunction,
}

const TORUS: Known = Known {
    symmetry: Symmetry::Asymmetric,
    driving: 0.07675565393585058,
    stiffness: 0.14,
    residual_strength: 0.0011,
    tau: 11.4,
    psi: [0.6056743261414944, 0.54503110736905],
    period: 334.17970918313983,
    kind: TestFunction::Torus,
};

const DOUBLING: Known = Known {
    symmetry: Symmetry::Asymmetric,
    driving: 0.0884,
    stiffness: 0.14,
    residual_strength: 0.0009747144081494844,
    tau: 11.4,
    psi: [0.6873583972754089, 0.6721391277501686],
    period: 361.54330095233854,
    kind: TestFunction::Doubling,
};

const PITCHFORK: Known = Known {
    symmetry: Symmetry::Symmetric,
    driving: 4.710203064028729,
    stiffness: 0.13,
    residual_strength: 0.0011,
    tau: 9.8,
    psi: [0.031507777781210784; 2],
    period: 8.84121498467507,
    kind: TestFunction::Transverse,
};

/// The orbit with the bifurcation, along the parameter of this place from a little beside it.
fn found(
    family: &dyn ParametrisedField,
    known: &Known,
    mut at: [f64; 2],
    free: usize,
) -> ContinuationPoint {
    let w = known.psi.map(f64::ln);
    let start = Vector::from_fn(family.dimension(), |i, _| match i {
        0 => known.tau,
        i => w[i - 1],
    });
    at[free] += 1e-4;
    let field = family.field(at);
    let mut tracer = Tracer::taylor(1e-12).unwrap();
    let shooting = ShootingNodes::along(&mut tracer, &field, &start, known.period).unwrap();
    let mut corrector = Corrector::new(family, 1e-15).unwrap();
    let meets = [Condition::TestFunction(known.kind)];
    let site = ContinuationPoint { shooting, at };
    let sharp = corrector.correct(site, &[free], &meets, Goal::SHARP);
    sharp.unwrap().site
}

fn is_found_along_both(known: &Known) {
    let slab = slab(known.driving, known.stiffness)
        .with("residual_strength", known.residual_strength)
        .unwrap();
    for (first, value) in [("driving", known.driving), ("stiffness", known.stiffness)] {
        let names = [first, "residual_strength"];
        let family = OverLogarithms::new(slab, known.symmetry, names).unwrap();
        let exact = [value, known.residual_strength];
        for free in [0, 1] {
            let site = found(&family, known, exact.map(f64::ln), free);
            let what = format!("{:?} in {first}, {free}", known.kind);
            assert_close(site.at[free].exp(), exact[free], 1e-10, &what);
            assert_close(site.shooting.period(), known.period, 1e-10, &what);
        }
    }
}

#[test]
fn orbits_bifurcate_where_they_do_in_128_bits() {
    is_found_along_both(&TORUS);
    is_found_along_both(&DOUBLING);
    is_found_along_both(&PITCHFORK);
}

/// From the doubling at V_H = 0.0884 in the plane of K and c: where the curve then is, the doubling along V_H, which compiled series find
/// without derivatives in c, is at that V_H.
#[test]
fn doublings_are_followed_in_the_plane_of_stiffness_and_residual_strength() {
    let slab = slab(DOUBLING.driving, DOUBLING.stiffness);
    let names = ["stiffness", "residual_strength"];
    let family = OverLogarithms::new(slab, Symmetry::Asymmetric, names).unwrap();
    let exact = [DOUBLING.stiffness, DOUBLING.residual_strength].map(f64::ln);
    let first = found(&family, &DOUBLING, exact, 1);
    let mut corrector = Corrector::new(&family, 1e-15).unwrap();
    let settings = PalcSettings::locus(TestFunction::Doubling, 0.01);
    let meets = [Condition::TestFunction(TestFunction::Doubling)];
    let here = corrector.look(first.clone(), &[0, 1], &meets).unwrap();
    let direction = settings.direction(&here, &here.along[0]).unwrap();
    let mut palc = Palc::from(&mut corrector, settings, here.site, direction).unwrap();
    let mut steps = 0;
    let mut last = None;
    palc.follow(&[], 100, &mut |_, _, met| match met {
        Met::Point(point) => {
            steps += 1;
            last = Some(point.here.site.clone());
            if steps == 5 { Break(()) } else { Continue(()) }
        }
        Met::Zero(..) => Continue(()),
    })
    .unwrap();
    let sharp = corrector.correct(last.unwrap(), &[1], &meets, Goal::SHARP);
    let site = sharp.unwrap().site;
    let moved = (site.at[1] - first.at[1]).abs();
    assert!(moved > 1e-3, "{moved}");
    let family = OverLoadings::new(family.slab(site.at), Symmetry::Asymmetric);
    let mut corrector = Corrector::new(&family, 1e-15).unwrap();
    let at = [DOUBLING.driving.ln() + 1e-5, site.at[0]];
    let beside = ContinuationPoint { at, ..site };
    let sharp = corrector.correct(beside, &[0], &meets, Goal::SHARP);
    let driving = sharp.unwrap().site.at[0].exp();
    assert_close(driving, DOUBLING.driving, 1e-10, "V_H");
}
