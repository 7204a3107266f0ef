//! Points of codimension two on curves of Hopf points, and on those of bifurcations of orbits, of systems whose bifurcations are known in closed form; and the
//! coefficients of normal forms.

use crate::command::object;
use crate::common::text::file;
use serde_json::Value;

/// A system of formulas: rates and what these name, with the parameters' values.
struct System {
    parameters: &'static str,
    named: &'static str,
    rates: &'static str,
    start: &'static str,
}

impl System {
    /// Its file.
    fn path(&self, name: &str) -> String {
        let lines = |text: &str| {
            text.split("; ")
                .map(|line| format!("{line}\n"))
                .collect::<String>()
        };
        let states = self.rates.split("; ").map(|rate| {
            let (state, _) = rate.split_once(" = ").expect("a rate");
            format!("{state:?}")
        });
        let states: Vec<String> = states.collect();
        let text = format!(
            "name = {name:?}\nstates = [{}]\n[parameters]\n{}[where]\n{}[rates]\n{}[start]\n{}",
            states.join(", "),
            lines(self.parameters),
            lines(self.named),
            lines(self.rates),
            lines(self.start),
        );
        file(&format!("codimension_two_{name}"), &text)
    }
}

/// The special points of a run.
fn special(run: &str) -> Vec<Value> {
    let made = object(run);
    made["result"]["special"]
        .as_array()
        .expect("a list")
        .clone()
}

/// Fails unless just these are the points other than ends: by curve, label and two parameters, each within its bound, and this near.
#[track_caller]
fn are(special: &[Value], names: [&str; 2], expected: &[(u64, &str, [f64; 2])], near: f64) {
    let others = special.iter().filter(|one| one["label"] != "EP");
    let others: Vec<&Value> = others.collect();
    let labels: Vec<_> = others
        .iter()
        .map(|one| (&one["branch"], &one["label"]))
        .collect();
    assert_eq!(others.len(), expected.len(), "{labels:?}");
    for (curve, label, truth) in expected {
        let is = |one: &&&Value| one["branch"] == *curve && one["label"] == *label;
        let found = others.iter().find(is);
        let found = found.unwrap_or_else(|| panic!("{label} of {labels:?}"));
        for (name, truth) in names.iter().zip(truth) {
            within(&found[*name], *truth, near);
        }
    }
}

/// Fails unless a number is within its bound of a truth that is known to the last digit, and the bound is this small.
#[track_caller]
fn within(number: &Value, truth: f64, near: f64) {
    let part = |name: &str| number[name].as_f64().unwrap_or_else(|| panic!("{number}"));
    let off = (part("value") - truth).abs();
    let rounding = 2.0 * f64::EPSILON * truth.abs();
    let bound = part("uncertainty");
    assert!(
        off <= bound + rounding && bound < near,
        "{number} for {truth}"
    );
}

/// Every curve goes from one end of the ranges to the other.
#[track_caller]
fn are_whole(special: &[Value], curves: u64) {
    for curve in 0..curves {
        let ends = special
            .iter()
            .filter(|one| one["branch"] == curve && one["label"] == "EP");
        assert_eq!(ends.count(), 2, "curve {curve}");
    }
}

/// Two oscillators that damp each other: the Hopf points of each are m_i = 0 (Kuznetsov 2004, (8.112)).
const TWO_OSCILLATORS: System = System {
    parameters: "m1 = 0.4; m2 = 0.2; th = 1.5; de = 0.5; w1 = 1.0; w2 = 1.7",
    named: r#"r1 = "x1^2+y1^2"; r2 = "x2^2+y2^2""#,
    rates: r#"x1 = "x1*(m1-r1-th*r2)-w1*y1"; y1 = "y1*(m1-r1-th*r2)+w1*x1"; x2 = "x2*(m2-de*r1-r2)-w2*y2"; y2 = "y2*(m2-de*r1-r2)+w2*x2""#,
    start: "x1 = 0.0; y1 = 0.0; x2 = 0.0; y2 = 0.0",
};

/// The same in coordinates that are shifted, coupled and bent, with m1 = p - 0.3 + 0.2 q and m2 = q + 0.1 - 0.3 p.
const COUPLED_OSCILLATORS: System = System {
    parameters: "p = 0.4; q = 0.2; th = 1.5; de = 0.5; w1 = 1.0; w2 = 1.7",
    named: r#"m1 = "p - 0.3 + 0.2*q"; m2 = "q + 0.1 - 0.3*p"; x1 = "u1 - 1"; y1 = "v1 - 0.3*x1"; x2 = "u2 - 0.5*y1"; y2 = "v2 - 0.25*x2^2"; r1 = "x1^2+y1^2"; r2 = "x2^2+y2^2"; fx1 = "x1*(m1-r1-th*r2)-w1*y1"; fy1 = "y1*(m1-r1-th*r2)+w1*x1"; fx2 = "x2*(m2-de*r1-r2)-w2*y2"; fy2 = "y2*(m2-de*r1-r2)+w2*x2""#,
    rates: r#"u1 = "fx1"; v1 = "fy1 + 0.3*fx1"; u2 = "fx2 + 0.5*fy1"; v2 = "fy2 + 0.5*x2*fx2""#,
    start: "u1 = 1.0; v1 = 0.0; u2 = 0.0; v2 = 0.0",
};

/// That two whole curves of Hopf points cross in a double Hopf point there, and nothing else is on them.
#[track_caller]
fn cross_in(run: &str, names: [&str; 2], there: [f64; 2], near: f64) -> Vec<Value> {
    let all = special(run);
    are(&all, names, &[(0, "HH", there), (1, "HH", there)], near);
    are_whole(&all, 2);
    all
}

#[test]
fn curves_of_hopf_points_go_through_a_double_hopf_point() {
    let path = TWO_OSCILLATORS.path("two_oscillators");
    let run = format!("locus hopf --system {path} --in m1,m2 --range m1=-1,1 --range m2=-1,1");
    let all = cross_in(&run, ["m1", "m2"], [0.0, 0.0], 1e-14);
    // No pair of another period is told than that of the curve.
    let periods = [std::f64::consts::TAU, std::f64::consts::TAU / 1.7];
    for one in &all {
        let curve = one["branch"].as_u64().expect("a number") as usize;
        let period = one["period"]["value"].as_f64().expect("a number");
        assert!((period - periods[curve]).abs() < 1e-12, "{one}");
    }
    let path = COUPLED_OSCILLATORS.path("coupled_oscillators");
    for ranges in [
        "--range p=-1,1 --range q=-1,1",
        "--range p=-0.5,1 --range q=-0.8,1.3",
    ] {
        let run = format!("locus hopf --system {path} --in p,q {ranges}");
        cross_in(&run, ["p", "q"], [16.0 / 53.0, -0.5 / 53.0], 1e-13);
    }
}

/// Two real eigenvalues q and -1/2 beside the pair: the curve of Hopf points goes on where their sum is zero, and nothing is there.
#[test]
fn a_neutral_saddle_beside_a_pair_is_no_double_hopf_point() {
    let system = System {
        parameters: "p = 0.4; q = 0.2",
        named: r#"r = "x^2+y^2""#,
        rates: r#"x = "x*(p-0.3*q-r)-y"; y = "y*(p-0.3*q-r)+x"; z = "q*z+x*w-z^3"; w = "-0.5*w+x*z""#,
        start: "x = 0.0; y = 0.0; z = 0.0; w = 0.0",
    };
    let path = system.path("neutral_saddle");
    let run = format!("locus hopf --system {path} --in p,q --range p=-1,1 --range q=0.1,1");
    let made = object(&run);
    let all = made["result"]["special"].as_array().expect("a list");
    are(all, ["p", "q"], &[], 1e-13);
    are_whole(all, 1);
    for row in made["result"]["rows"].as_array().expect("rows") {
        let of = |name: &str| row[name]["value"].as_f64().expect("a number");
        assert!((of("p") - 0.3 * of("q")).abs() < 1e-12, "{row}");
    }
}

/// Many variables: the determinants are left for what takes their place.
#[test]
fn a_double_hopf_point_is_met_among_many_variables() {
    let rates = TWO_OSCILLATORS.rates;
    let rates = format!(
        r#"{rates}; z1 = "x1-z1"; z2 = "x2-2*z2"; z3 = "z1-3*z3"; z4 = "z2-4*z4"; z5 = "z3-5*z5"; z6 = "z4-6*z6""#
    );
    let system = System {
        rates: Box::leak(rates.into_boxed_str()),
        start: "x1 = 0.0; y1 = 0.0; x2 = 0.0; y2 = 0.0; z1 = 0.0; z2 = 0.0; z3 = 0.0; z4 = 0.0; z5 = 0.0; z6 = 0.0",
        ..TWO_OSCILLATORS
    };
    let path = system.path("many_variables");
    let run = format!("locus hopf --system {path} --in m1,m2 --range m1=-1,1 --range m2=-1,1");
    cross_in(&run, ["m1", "m2"], [0.0, 0.0], 1e-13);
}

const CYCLE: &str =
    r#"x = "x*(b1+b2*rr-rr*rr)-y*(om+qq*rr)"; y = "y*(b1+b2*rr-rr*rr)+x*(om+qq*rr)""#;
const OF_CYCLE: &str = "b1 = -0.1; b2 = 1.0; om = 1.0; qq = 0.3";

/// A fold of cycles at b1 = -b2^2/4, where r^2 = b2/2, with a pair that grows by r^2 - 0.4 around the cycle: its tori are on b1 = 0.16 - 0.4 b2.
#[test]
fn a_fold_of_cycles_and_a_torus_bifurcation_meet() {
    let rates =
        format!(r#"{CYCLE}; u = "u*(rr-0.4-u^2-v^2)-1.7*v"; v = "v*(rr-0.4-u^2-v^2)+1.7*u""#);
    let system = System {
        parameters: OF_CYCLE,
        named: r#"rr = "x^2+y^2""#,
        rates: Box::leak(rates.into_boxed_str()),
        start: "x = 0.0; y = 0.0; u = 0.0; v = 0.0",
    };
    let path = system.path("fold_and_torus");
    for kind in ["orbit-saddle-node", "torus"] {
        let run = format!(
            "locus {kind} --system {path} --in b1,b2 --range b1=-0.3,0.2 --range b2=0.3,1.2"
        );
        let all = special(&run);
        are(&all, ["b1", "b2"], &[(0, "FN", [-0.16, 0.8])], 1e-13);
        are_whole(&all, 1);
    }
}

/// The same with a multiplier -1: a perturbation that turns by half while the cycle turns once, and grows by sqrt(r^2/1.6) - 1/2.
#[test]
fn a_fold_of_cycles_and_a_period_doubling_meet() {
    let rates = format!(
        r#"{CYCLE}; u = "u*(-0.5-u^2-v^2)+be*(x*u+y*v)-half*v"; v = "v*(-0.5-u^2-v^2)+be*(y*u-x*v)+half*u""#
    );
    let system = System {
        parameters: OF_CYCLE,
        named: r#"rr = "x^2+y^2"; be = "0.5/sqrt(0.4)"; half = "0.5*(om+qq*rr)""#,
        rates: Box::leak(rates.into_boxed_str()),
        start: "x = 0.0; y = 0.0; u = 0.0; v = 0.0",
    };
    let path = system.path("fold_and_flip");
    for kind in ["orbit-saddle-node", "period-doubling"] {
        let run = format!(
            "locus {kind} --system {path} --in b1,b2 --range b1=-0.3,0.2 --range b2=0.3,1.2"
        );
        let all = special(&run);
        are(&all, ["b1", "b2"], &[(0, "FF", [-0.16, 0.8])], 1e-13);
        are_whole(&all, 1);
    }
}

/// A cycle of radius 0.8 with two perturbations: both are neutral where p + q/5 = 0 and q - 3 p/10 = 1/10.
const STEADY_CYCLE: &str = r#"x = "x*(0.64-rr)-y*(om+qq*rr)"; y = "y*(0.64-rr)+x*(om+qq*rr)""#;
const NEUTRAL: [f64; 2] = [-0.02 / 1.06, 0.1 / 1.06];
const RANGES: &str =
    "--in p,q --range p=-0.5,0.8 --range q=-0.7,0.6 --start=0.8,0,0,0,0,0 --period-guess 5.27";

#[test]
fn a_period_doubling_and_a_pair_on_the_circle_meet() {
    // The pair of the first is all but real where they meet.
    for (name, frequency) in [("0.6", "0.6"), ("0.7", "0.7")] {
        let rates = format!(
            r#"{STEADY_CYCLE}; u = "u*(c-u^2-v^2)+0.625*(x*u+y*v)-half*v"; v = "v*(c-u^2-v^2)+0.625*(y*u-x*v)+half*u"; z = "z*(d-z^2-w^2)-{frequency}*w"; w = "w*(d-z^2-w^2)+{frequency}*z""#
        );
        let system = System {
            parameters: "p = -0.1; q = -0.2; om = 1.0; qq = 0.3",
            named: r#"rr = "x^2+y^2"; half = "0.5*(om+qq*rr)"; c = "p+0.2*q-0.5"; d = "q-0.3*p-0.1""#,
            rates: Box::leak(rates.into_boxed_str()),
            start: "x = 0.8; y = 0.0; u = 0.0; v = 0.0; z = 0.0; w = 0.0",
        };
        let path = system.path(&format!("flip_and_torus_{name}"));
        let all = special(&format!("locus period-doubling --system {path} {RANGES}"));
        are(&all, ["p", "q"], &[(0, "PN", NEUTRAL)], 1e-13);
        are_whole(&all, 1);
    }
}

/// Two pairs on the circle: the curves of tori of both go straight on through the point.
#[test]
fn curves_of_tori_go_through_a_double_neimark_sacker_point() {
    let rates = format!(
        r#"{STEADY_CYCLE}; u = "u*(c-u^2-v^2)-1.9*v"; v = "v*(c-u^2-v^2)+1.9*u"; z = "z*(d-z^2-w^2)-0.7*w"; w = "w*(d-z^2-w^2)+0.7*z""#
    );
    let system = System {
        parameters: "p = -0.1; q = 0.315; om = 1.0; qq = 0.3",
        named: r#"rr = "x^2+y^2"; c = "p+0.2*q"; d = "q-0.3*p-0.1""#,
        rates: Box::leak(rates.into_boxed_str()),
        start: "x = 0.8; y = 0.0; u = 0.0; v = 0.0; z = 0.0; w = 0.0",
    };
    let path = system.path("two_tori");
    let all = special(&format!("locus torus --system {path} {RANGES}"));
    // Of the other oscillators' cycles the curves end where these shrink to a double Hopf point.
    let period = |one: &Value| one["period"]["value"].as_f64().expect("a number");
    let own = std::f64::consts::TAU / 1.192;
    let ours: Vec<Value> = all
        .iter()
        .filter(|one| (period(one) - own).abs() < 1e-9)
        .cloned()
        .collect();
    let met: Vec<&Value> = ours.iter().filter(|one| one["label"] == "NN").collect();
    assert_eq!(met.len(), 2, "{met:?}");
    for one in met {
        within(&one["p"], NEUTRAL[0], 1e-13);
        within(&one["q"], NEUTRAL[1], 1e-13);
    }
    let count = |label: &str| ours.iter().filter(|one| one["label"] == label).count();
    assert_eq!((count("EP"), ours.len()), (4, 6));
    for one in all.iter().filter(|one| one["label"] != "EP") {
        let label = one["label"].as_str().expect("a label");
        assert!(["NN", "HH"].contains(&label), "{one}");
        within(&one["p"], NEUTRAL[0], 1e-12);
        within(&one["q"], NEUTRAL[1], 1e-12);
    }
}

/// r^2 = 1 + s with s' ~ c1 + c2 s - s^3, where c1 and c2 are the parameters, or mixtures of them.
#[test]
fn folds_of_cycles_meet_at_a_cusp() {
    for (name, named, truth) in [
        ("cusp", r#"c1 = "b1"; c2 = "b2""#, [0.0, 0.0]),
        (
            "mixed_cusp",
            r#"c1 = "b1+0.5*b2-0.1"; c2 = "b2-0.3*b1""#,
            [0.1 / 1.15, 0.03 / 1.15],
        ),
    ] {
        let named = format!(r#"rr = "x^2+y^2"; grow = "c1+c2*(rr-1)-(rr-1)^3"; {named}"#);
        let system = System {
            parameters: "b1 = -0.3; b2 = 0.2; om = 1.0; qq = 0.3",
            named: Box::leak(named.into_boxed_str()),
            rates: r#"x = "x*grow-y*(om+qq*rr)"; y = "y*grow+x*(om+qq*rr)""#,
            start: "x = 0.0; y = 0.0",
        };
        let path = system.path(name);
        let run = format!(
            "locus orbit-saddle-node --system {path} --in b1,b2 --range b1=-0.5,0.5 --range b2=-0.2,0.8"
        );
        let all = special(&run);
        are(&all, ["b1", "b2"], &[(0, "CP", truth)], 1e-12);
        are_whole(&all, 1);
    }
}

/// The only point with a label, with the coefficients of its normal form.
#[track_caller]
fn has(all: &[Value], label: &str, coefficients: &[(&str, f64)]) -> Value {
    let found: Vec<&Value> = all.iter().filter(|one| one["label"] == label).collect();
    let first = found.first().unwrap_or_else(|| panic!("no {label}"));
    for one in &found {
        for (name, truth) in coefficients {
            within(&one["normal_form"][*name], *truth, 1e-11);
        }
    }
    (*first).clone()
}

/// Normal forms have their own coefficients, where eigenvectors have the length 1: a pair that turns in a plane is along (1, -i) / sqrt 2. A change of
/// coordinates changes none of them but by lengths.
#[test]
fn normal_forms_have_the_coefficients_of_the_closed_forms() {
    let plane = "--range b1=-1,1 --range b2=-1,1";
    // Bogdanov-Takens.
    let system = System {
        parameters: "b1 = -0.1; b2 = -1.0; sg = -1.0",
        named: r#"one = "1""#,
        rates: r#"x = "y"; y = "one*b1+b2*x+x*x+sg*x*y""#,
        start: "x = 0.0; y = 0.0",
    };
    let path = system.path("bogdanov_takens");
    for kind in ["hopf", "saddle-node"] {
        let all = special(&format!("locus {kind} --system {path} --in b1,b2 {plane}"));
        let found = has(&all, "BT", &[("a", 1.0), ("b", -1.0)]);
        assert_eq!(found["criticality"], "supercritical");
    }
    // Generalised Hopf, in the coordinates of the form and in curved ones: |z|^2 is twice that of the eigenvector's coordinate.
    let curved = System {
        parameters: "b1 = -0.2; b2 = 1.2; om = 2.0; q = -0.5; c = 0.7",
        named: r#"Y = "w-c*u*u"; rr = "u*u+Y*Y"; fx = "u*(b1+b2*rr-rr*rr)-Y*(om+q*rr)"; fy = "Y*(b1+b2*rr-rr*rr)+u*(om+q*rr)""#,
        rates: r#"u = "fx"; w = "fy+2*c*u*fx""#,
        start: "u = 0.0; w = 0.0",
    };
    let all = special(&format!(
        "locus hopf --system {} --in b1,b2 {plane}",
        curved.path("curved_bautin")
    ));
    let found = has(&all, "GH", &[("l_2", -4.0 / 2.0)]);
    assert_eq!(found["criticality"], "supercritical");
    assert_eq!(found["coefficient"], found["normal_form"]["l_2"]["value"]);
    // Cusp, on a curved centre manifold.
    let cusp = System {
        parameters: "a = -0.1; b = 1.0",
        named: r#"v = "y-0.5*x*x"; along = "a+b*x-2*x^3+v*x*0.4""#,
        rates: r#"x = "along"; y = "-1.3*v+x*along""#,
        start: "x = 0.0; y = 0.0",
    };
    let all = special(&format!(
        "locus saddle-node --system {} --in a,b --range a=-1,1 --range b=-1,1",
        cusp.path("curved_cusp")
    ));
    has(&all, "CP", &[("c", -2.0)]);
    // Zero-Hopf, with another time and on a curved manifold.
    let zero_hopf = System {
        parameters: "b1 = -0.2; b2 = 0.0; th = -0.8; sg = 1.0; om = 1.0",
        named: r#"z = "s-0.3*x*x-0.2*x*y"; rr = "x*x+y*y"; time = "exp(0.4*z)"; fx = "(x*(b2+th*z+z*z)-om*y)*time"; fy = "(y*(b2+th*z+z*z)+om*x)*time"; fz = "(b1+z*z+sg*rr)*time""#,
        rates: r#"x = "fx"; y = "fy"; s = "fz+0.6*x*fx+0.2*(x*fy+y*fx)""#,
        start: "x = 0.0; y = 0.0; s = 0.447",
    };
    let path = zero_hopf.path("zero_hopf");
    let ranges = "--range b1=-0.5,0.6 --range b2=-0.7,0.6 --start=0,0,0.447";
    for kind in ["hopf", "saddle-node"] {
        let all = special(&format!("locus {kind} --system {path} --in b1,b2 {ranges}"));
        let found = has(&all, "ZH", &[("s", 1.0), ("theta", -0.8), ("E_0", 1.0)]);
        assert_eq!(found["note"], "s = 1, theta < 0: tori");
    }
    // Double Hopf.
    let path = TWO_OSCILLATORS.path("double_hopf_form");
    let run = format!("locus hopf --system {path} --in m1,m2 --range m1=-1,1 --range m2=-1,1");
    let quadruple = [
        ("p_11", -2.0),
        ("p_12", -3.0),
        ("p_21", -1.0),
        ("p_22", -2.0),
    ];
    let ratios = [("theta", 1.5), ("delta", 0.5)];
    let all = special(&run);
    has(&all, "HH", &quadruple);
    let found = has(&all, "HH", &ratios);
    assert_eq!(found["note"], "simple case II");
    let path = COUPLED_OSCILLATORS.path("double_hopf_coupled");
    let all = special(&format!(
        "locus hopf --system {path} --in p,q --range p=-1,1 --range q=-1,1"
    ));
    has(&all, "HH", &ratios);
}

/// From 40 digits, by the multilinear forms of Kuznetsov (1999), of the Lorenz system of 1984 and of the Roessler system.
#[test]
fn normal_forms_have_the_coefficients_of_forty_digits() {
    let run =
        "locus hopf --system lorenz-84 --set a=0.25 --set b=4 --in F,G --range F=0,4 --range G=0,4";
    let zero_hopf = [
        ("s", 1.0),
        ("theta", -4.063_270_535_527_228),
        ("E_0", 1.477_146_189_873_172_3),
    ];
    has(&special(run), "ZH", &zero_hopf);
    let run = "locus hopf --system roessler --in a,c --range a=0.05,1.5 --range c=0.2,6";
    has(&special(run), "GH", &[("l_2", 0.377_819_221_256_898_3)]);
}

/// A curve of tori of a cycle that shrinks to a double Hopf point or to a zero-Hopf point ends there, and nothing is told of rounding beside it. Around the
/// z axis of the normal form of a zero-Hopf point the tori are on b2 = 0, and the second frequency is sqrt(1.6 r^2).
#[test]
fn curves_of_tori_end_where_their_cycle_shrinks_to_a_point() {
    let path = TWO_OSCILLATORS.path("tori_of_two_oscillators");
    let run =
        format!("locus torus --system {path} --in m1,m2 --range m1=-0.9,1.1 --range m2=-0.8,1.2");
    let all = special(&run);
    are(&all, ["m1", "m2"], &[(0, "HH", [0.0, 0.0])], 1e-13);
    let system = System {
        parameters: "b1 = -0.2; b2 = 0.0; th = -0.8; sg = 1.0; om = 1.0",
        named: r#"rr = "x*x+y*y"; grow = "b2+th*z+z*z""#,
        rates: r#"x = "x*grow-om*y"; y = "y*grow+om*x"; z = "b1+z*z+sg*rr""#,
        start: "x = 0.0; y = 0.0; z = 0.447",
    };
    let path = system.path("tori_of_zero_hopf");
    let all = special(&format!(
        "locus torus --system {path} --in b1,b2 --range b1=-0.5,0.6 --range b2=-0.7,0.6 --box x=-2:2,y=-2:2,z=-2:2"
    ));
    let met =
        |label: &str| -> Vec<&Value> { all.iter().filter(|one| one["label"] == label).collect() };
    assert_eq!(met("ZH").len(), 1);
    within(&met("ZH")[0]["b1"], 0.0, 1e-13);
    within(&met("ZH")[0]["b2"], 0.0, 1e-13);
    // The angle of the multipliers is a quarter or a third of a turn, or three of these, where 1.6 r^2 is 1/16 or 1/9, and so on.
    assert_eq!(
        [
            met("R3").len(),
            met("R4").len(),
            met("R1").len(),
            met("EP").len(),
            all.len()
        ],
        [2, 2, 0, 1, 6]
    );
}
