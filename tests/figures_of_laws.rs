//! Figures 1, 2, 4, 15 and 17: what their sheets have against values of the paper, its errata and independent methods.

use nalgebra::Complex;
use std::sync::atomic::AtomicBool;
use twinslip::bifurcation::equilibria::CharacteristicCubic;
use twinslip::equilibrium::{Pitchfork, Solver, Symmetry, Verdict, stability, steady_states};
use twinslip::field::State;
use twinslip::friction::{AnyLaw, ExtremumKind, Parameters};
use twinslip::model::{Loading, two_interfaces};
use twinslip_output::Cell;
use twinslip_paper::{Made, Make, Pieces, Product};

fn made(id: &str) -> Made {
    let stop = AtomicBool::new(false);
    let product = Product::named(id).unwrap();
    let Make::Figure(make) = product.make else {
        panic!("{id} is no figure");
    };
    let made = make(&Pieces::new(&stop)).unwrap();
    assert!(!made.method.is_empty() && !product.caption.is_empty() && !product.alt.is_empty());
    let drawing = made.drawing.as_ref().expect("a picture");
    assert!(drawing.svg().unwrap().len() > 1000);
    made.sheet.csv(&[]).unwrap();
    made
}

/// The cells of some columns of a part; a word is `None`.
fn columns<const N: usize>(made: &Made, part: &str, names: [&str; N]) -> Vec<[Option<f64>; N]> {
    let found: Vec<_> = made.sheet.parts.iter().filter(|p| p.name == part).collect();
    assert!(!found.is_empty(), "no part {part}");
    let mut rows = Vec::new();
    for part in found {
        let places = names.map(|name| part.columns.iter().position(|c| c == name).unwrap());
        rows.extend(part.rows.iter().map(|row| {
            places.map(|i| match row[i] {
                Cell::Number(x) => x.is_finite().then_some(x),
                _ => None,
            })
        }));
    }
    rows
}

fn numbers<const N: usize>(made: &Made, part: &str, names: [&str; N]) -> Vec<[f64; N]> {
    let rows = columns(made, part, names);
    rows.into_iter()
        .map(|row| row.map(|x| x.expect("a number")))
        .collect()
}

fn close(found: f64, expected: f64, relative: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off < relative, "{found} for {expected}: {off:e}");
}

/// (36) as printed.
fn printed(v: f64, c: f64) -> f64 {
    let (a, b, a_v, r) = (0.0349_f64, 0.0489_f64, 0.369_f64, 100.0);
    let gamma0 = 2.0 * (-a_v / a).exp();
    (v / gamma0 * (c + (1.0 + r) / (1.0 + r * v)).powf(b / a)).asinh()
}

#[test]
fn figure_1_has_the_printed_numbers() {
    let made = made("fig01");
    let [maximum] = numbers(&made, "maximum", ["slip_rate", "friction"])[..] else {
        panic!("one maximum");
    };
    // a L / ((b - a) t**)  (7); errata
    close(maximum[0], 0.0349 * 0.9e-6 / (0.014 * 90.0), 1e-13);
    close(maximum[1], 0.40467743205, 1e-10);
    let names = ["slip_rate", "friction", "critical_stiffness"];
    // (17), and mu_ss = a_v + (a - b) ln V
    for [v, mu, k] in numbers(&made, "dieterich-ruina", names) {
        close(k, 0.014 / 0.9e-6, 1e-12);
        close(mu, 0.369 - 0.014 * (v / 1e-6).ln(), 1e-12);
    }
    let bounded = numbers(&made, "bounded", names);
    assert!(
        bounded
            .iter()
            .all(|row| (row[2] < 0.0) == (row[0] < maximum[0]))
    );
    assert!(
        bounded
            .iter()
            .all(|row| row[2] < 0.014 / 0.9e-6 && row[1] <= maximum[1])
    );
    let at = bounded.iter().find(|row| row[0] == maximum[0]);
    assert_eq!(at.expect("the maximum among the points")[2], 0.0);
}

#[test]
fn figure_4_has_the_extrema_and_the_largest_critical_stiffness() {
    let made = made("fig04");
    let names = ["slip_rate", "friction"];
    // errata: closed forms in 60 digits
    let maximum = numbers(&made, "maximum", names)[0];
    close(maximum[0], 0.024_931_583_134_438_45, 1e-14);
    close(maximum[1], 0.404_679_123_19, 1e-11);
    let minimum = numbers(&made, "minimum", names)[0];
    close(minimum[0], 405.112_661_540_074_7, 1e-14);
    for [v, mu] in numbers(&made, "spinodal", names) {
        close(mu, 0.0349 * printed(v, 1e-3), 1e-13);
    }
    let names = ["slip_rate", "critical_stiffness"];
    for [_, k] in numbers(&made, "dieterich-ruina", names) {
        close(k, 0.401_146_131_805_157_59, 1e-13);
    }
    // tests/data/steady_states.json; the symmetric state of two interfaces has half of K at twice the V (29): errata
    let largest = numbers(&made, "largest", names)[0];
    close(largest[0], 0.5 * 5.384_051_685_863, 1e-12);
    close(largest[1], 0.393_693_008_894_583_27, 1e-14);
    let curve = numbers(&made, "stability", names);
    assert!(curve.iter().all(|row| (0.0..=largest[1]).contains(&row[1])));
    assert_eq!((curve[0][0], curve[0][1]), (maximum[0], 0.0));
}

#[test]
fn figure_2_solves_the_equations_it_shows() {
    let made = made("fig02");
    let names = ["driving", "slip_rate_1", "slip_rate_2"];
    let paper = Parameters::heslot_1994();
    let v_m = 405.112_661_540_074_7;
    let turned = |v: f64| 2.0 * printed(v_m, 1e-3) - printed(2.0 * v_m - v, 1e-3);
    type Law<'a> = &'a dyn Fn(f64) -> f64;
    let cases: [(&str, Law<'_>, f64, bool); 4] = [
        ("maximum-supercritical", &|v| printed(v, 1e-3), 1.0, true),
        ("maximum-subcritical", &turned, -1.0, false),
        ("minimum-supercritical", &|v| printed(v, 2.75), -1.0, true),
        ("minimum-subcritical", &|v| printed(v, 1e-3), 1.0, false),
    ];
    for (case, tau, side, stable) in cases {
        let branch = format!("{case}-asymmetric");
        for row in &made
            .sheet
            .parts
            .iter()
            .find(|p| p.name == branch)
            .unwrap()
            .rows
        {
            let expected = if stable { "stable" } else { "unstable" };
            assert_eq!(row[3], Cell::from(expected), "{case}");
        }
        let rows = numbers(&made, &branch, names);
        let fork = rows[0][0];
        for [driving, one, two] in rows {
            close(one + two, driving, 1e-14);
            assert!((tau(one) - tau(two)).abs() < 1e-13, "{case} at {driving}");
            // Which way the branch opens.
            assert!(side * (driving - fork) >= 0.0, "{case} at {driving}");
        }
        let symmetric = made
            .sheet
            .parts
            .iter()
            .find(|p| p.name == format!("{case}-symmetric"));
        let words: Vec<_> = symmetric
            .unwrap()
            .rows
            .iter()
            .map(|row| row[3].clone())
            .collect();
        let before = if case.starts_with("maximum") {
            "stable"
        } else {
            "unstable"
        };
        assert_eq!(words[0], Cell::from(before), "{case}");
        assert_ne!(words[0], words[2], "{case}");
    }
    // What is said of stability holds by the eigenvalues of a stiff slab.
    for (case, parameters) in [
        ("maximum-supercritical", paper),
        ("minimum-subcritical", paper),
        (
            "minimum-supercritical",
            Parameters {
                residual_strength: 2.75,
                ..paper
            },
        ),
    ] {
        let law = AnyLaw::Spinodal(parameters.spinodal());
        let rows = numbers(&made, &format!("{case}-asymmetric"), names);
        for [driving, _, slow] in rows.into_iter().skip(20).step_by(40) {
            let found = steady_states(&law, driving, 2, Solver::Newton)
                .unwrap()
                .equilibria;
            let nearest = |a: f64| (a / slow - 1.0).abs() < 1e-9;
            let state = found
                .iter()
                .find(|state| nearest(state.slip_rate[0]))
                .unwrap();
            let verdict = stability(&law, state, 1e3).unwrap().verdict;
            let expected = if case.ends_with("supercritical") {
                Verdict::Stable
            } else {
                Verdict::Unstable
            };
            assert_eq!(verdict, expected, "{case} at {driving}");
        }
    }
}

/// (24) is the limit of the branch.
#[test]
fn the_parabola_is_tangent() {
    let paper = Parameters::heslot_1994();
    for c in [1e-3, 0.3, 2.75] {
        let law = Parameters {
            residual_strength: c,
            ..paper
        }
        .spinodal();
        for fork in Pitchfork::all(&law) {
            let bend = |part: f64| {
                let z = part * fork.slip_rate;
                let off = |lambda: f64| (lambda - fork.slip_rate) / (z * z);
                off(fork.branch(&law, z).unwrap()) / off(fork.parabola(z))
            };
            // The next term is of the second order: extrapolated away.
            let limit = (4.0 * bend(1e-3) - bend(2e-3)) / 3.0;
            assert!(
                (limit - 1.0).abs() < 1e-7,
                "c = {c}, {:?}: {limit}",
                fork.kind
            );
        }
    }
}

/// tau_ss'''(V_M) > 0 for every spinodal law; tau_ss'''(V_m) has both signs.
#[test]
fn a_spinodal_maximum_is_supercritical() {
    let (mut maxima, mut signs) = (0, [0; 2]);
    for beta in [1.01, 1.2, 1.4, 3.0, 20.0] {
        for healing_time in [0.1, 10.0, 100.0, 1e4] {
            for i in 0..100 {
                let law = Parameters {
                    beta,
                    healing_time,
                    residual_strength: 1e-6 * 10_f64.powf(0.1 * f64::from(i)),
                    ..Parameters::heslot_1994()
                };
                for fork in Pitchfork::all(&law.spinodal()) {
                    if fork.kind == ExtremumKind::Maximum {
                        maxima += 1;
                        assert!(fork.curvature < 0.0 && fork.third > 0.0, "{law:?}");
                    } else {
                        signs[usize::from(fork.third > 0.0)] += 1;
                    }
                }
            }
        }
    }
    assert!(
        maxima > 500 && signs.iter().all(|&n| n > 0),
        "{maxima} {signs:?}"
    );
}

#[test]
fn figure_15_has_its_points_in_order() {
    let made = made("fig15");
    let special = numbers(&made, "l2-special", ["mu_1", "v"]);
    assert!(
        special
            .windows(2)
            .all(|pair| pair[0][0] < pair[1][0] && pair[0][1] < pair[1][1])
    );
    let reach = |part: &str| {
        let rows = numbers(&made, part, ["mu_1"]);
        rows.iter()
            .fold(f64::NEG_INFINITY, |largest, row| largest.max(row[0]))
    };
    // No cycle beyond the fold, and none beside the origin beyond the homoclinic orbits.
    close(reach("l2-cycles"), special[2][0], 1e-12);
    assert!(reach("l2-cycles-beside") <= special[1][0] * (1.0 - 1e-12));
    assert!(reach("l1-cycles") < 0.0);
}

/// The asymmetric state of figure 17 at a stiffness, its cubic, and the eigenvalues of the Jacobian of (19).
fn jacobian_eigenvalues(k: f64) -> (CharacteristicCubic, Vec<Complex<f64>>) {
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let states = steady_states(&law, 0.06, 2, Solver::Newton)
        .unwrap()
        .equilibria;
    let state = states
        .into_iter()
        .find(|state| state.symmetry == Symmetry::Asymmetric)
        .unwrap();
    let cubic = CharacteristicCubic::new(&law, [state.slip_rate[1], state.slip_rate[0]]);
    let field = two_interfaces(law, Loading::new(0.06, k).unwrap());
    let y = State::<3>::new(state.stress.value, state.log_state[0], state.log_state[1]);
    assert!(field.f(&y).amax() < 1e-14);
    let mut found: Vec<_> = field
        .jacobian(&y)
        .complex_eigenvalues()
        .iter()
        .copied()
        .collect();
    found.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    (cubic, found)
}

#[test]
fn figure_17_touches_where_the_discriminant_vanishes() {
    let made = made("fig17");
    let names = ["stiffness", "growth_rate", "frequency"];
    for (part, sign) in [("first-tangency", 1.0), ("second-tangency", -1.0)] {
        let [k, s, _] = numbers(&made, part, names)[0];
        let (cubic, _) = jacobian_eigenvalues(k);
        assert!(sign * cubic.discriminant(k * (1.0 - 1e-9)) > 0.0, "{part}");
        assert!(sign * cubic.discriminant(k * (1.0 + 1e-9)) < 0.0, "{part}");
        // Q_3 = L and Q_3' = L'
        let gap = |s: f64| cubic.q_3(k, s) - cubic.line(s);
        let size = cubic.line(s).abs();
        assert!(gap(s).abs() < 1e-12 * size, "{part}");
        let h = 1e-4 * s;
        assert!((gap(s + h) - gap(s - h)).abs() < 1e-9 * size, "{part}");
    }
    // errata: the sum is positive, against the paper's assumption
    let [s_1, s_2] = numbers(&made, "state", ["s_1", "s_2"])[0];
    assert!(s_1 > 0.0 && s_2 < 0.0 && s_1 + s_2 > 0.0);
    let caption = Product::named("fig17").unwrap().caption;
    let [first, _, _] = numbers(&made, "first-tangency", names)[0];
    let [critical, _, _] = numbers(&made, "critical", names)[0];
    for number in [
        format!("s_1 = {s_1:.5}"),
        format!("s_2 = −{:.5}", -s_2),
        format!("K = {first:.5}"),
        format!("k_c* = {critical:.4}"),
    ] {
        assert!(caption.contains(&number), "{number}");
    }
}

#[test]
fn figure_17_has_the_eigenvalues_of_the_jacobian() {
    let made = made("fig17");
    let [k, _, omega] = numbers(&made, "critical", ["stiffness", "growth_rate", "frequency"])[0];
    let (_, found) = jacobian_eigenvalues(k);
    assert!(found[0].re.abs() < 1e-12 * omega.max(1.0), "{found:?}");
    close(found[0].im, omega, 1e-10);

    let names = [
        "stiffness",
        "growth_rate_1",
        "growth_rate_2",
        "growth_rate_3",
        "frequency",
    ];
    let rows = columns(&made, "roots", names);
    assert!(rows.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    for row in rows.iter().step_by(7) {
        let [k, one, two, three, omega] = *row;
        let (_, found) = jacobian_eigenvalues(k.unwrap());
        let mut expected: Vec<Complex<f64>> = match omega {
            Some(omega) => vec![
                Complex::new(one.unwrap(), omega),
                Complex::new(two.unwrap(), -omega),
            ],
            None => [one, two].map(|x| Complex::new(x.unwrap(), 0.0)).to_vec(),
        };
        expected.push(Complex::new(three.unwrap(), 0.0));
        expected.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        // the double root doubles the digits that the matrix algorithm loses
        let size = found.iter().map(|s| s.norm()).fold(0.0, f64::max);
        for (a, b) in expected.iter().zip(&found) {
            assert!(
                (a - b).norm() < 3e-8 * size,
                "K = {k:?}: {expected:?} and {found:?}"
            );
        }
    }
}

#[test]
fn figure_17_marks_roots() {
    let made = made("fig17");
    let marked = numbers(&made, "real-roots", ["stiffness", "s"]);
    assert_eq!(marked.len(), 6);
    let (cubic, _) = jacobian_eigenvalues(1.0);
    for [k, s] in marked {
        assert!(
            (cubic.q_3(k, s) - cubic.line(s)).abs() < 1e-17,
            "K = {k}, s = {s}"
        );
        close(cubic.stiffness_of(s).unwrap(), k, 1e-10);
    }
}
