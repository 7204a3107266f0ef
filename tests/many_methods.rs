//! Methods for many interfaces against each other and against the engines of few, and the arrow matrix against a dense one.

use crate::command::{number, object};
use nalgebra::{DMatrix, DVector};
use serde_json::Value;
use twinslip::friction::{AnyLaw, Formulas, Parameters};
use twinslip::many::{ManyInterfaces, OneOfMany, arrow_solution};
use twinslip::model::Loading;
use twinslip::number::{Jet, Real};

const METHODS: &[&str] = &[
    "rodas5p",
    "rodas4",
    #[cfg(feature = "sundials")]
    "cvode-bdf",
];

fn last(run: &str) -> Value {
    object(run)["result"]["final"].clone()
}

#[track_caller]
fn close(made: &Value, known: &Value, columns: &[&str], tolerance: f64) {
    for column in columns {
        let [made, known] = [made, known].map(|of| number(of, &format!("/{column}")));
        let off = (made - known).abs() / (1.0 + known.abs());
        assert!(off <= tolerance, "{column}: {made} for {known}: {off:e}");
    }
}

const KINDS: &[&str] = &[
    "--driving 40 --stiffness 0.035 --until 4",
    "--driving 40 --stiffness 0.035 --until 4 --damping 0.01",
    "--driving 40 --stiffness 0.035 --until 4 --damping 1e-3 --draw direct_effect=0.03:0.04,normal_stress=0.9:1.1,slip_length=0.5:2",
    "--driving 40 --stiffness 0.08 --until 1 --law slip",
    "--driving 40 --stiffness 0.08 --until 1 --law slip --damping 0.01 --draw slip_length=0.8:1.2",
    "--driving 40 --stiffness 0.08 --until 2 --law dieterich-ruina --damping 0.02 --draw evolution_effect=0.04:0.05",
    "--driving 40 --stiffness 0.08 --until 1 --law regularised-ageing --damping 0.05 --draw normal_stress=0.98:1.02",
    "--driving 40 --stiffness 0.05 --until 2 --law bounded --draw healing_time=10:1000log",
];

/// Power series on the one side, linear systems with an arrow matrix on the other.
#[test]
fn all_methods_agree() {
    let columns = [
        "stress",
        "state_1",
        "state_37",
        "slip_rate_9",
        "slip_2",
        "slip",
        "slip_rate_max",
    ];
    for kind in KINDS {
        let run = |method: &str, rtol: &str| {
            last(&format!(
                "integrate --interfaces 37 --start spread:0.3 --final-only {kind} --method {method} --rtol {rtol} --columns {}",
                columns.join(",")
            ))
        };
        let known = run("taylor", "1e-15");
        for method in METHODS {
            let made = run(method, "1e-11");
            let tolerance = if *method == "cvode-bdf" { 2e-8 } else { 1e-9 };
            close(&made, &known, &columns, tolerance);
        }
    }
}

/// The engines of one interface and of two have other formulas for damping and for other units of stress.
#[test]
fn few_are_those_of_the_other_engines() {
    for law in ["spinodal", "slip", "dieterich-ruina", "regularised-ageing"] {
        let (psi, until) = match law {
            "spinodal" => ("0.011", 3.0),
            _ => ("1.2", 1.0),
        };
        let run = |interfaces: u32, columns: &str| {
            let n = f64::from(interfaces);
            let psi = vec![psi; interfaces as usize].join(",");
            last(&format!(
                "integrate --law {law} --interfaces {interfaces} --driving {} --stiffness {} --damping 0.02 --start 10.2,{psi} \
                 --until {until} --final-only --rtol 1e-14 --method taylor --columns stress,{columns}",
                n,
                0.3 / n
            ))
        };
        let (many, alone) = (
            run(16, "state_16,slip_rate_3,slip_2"),
            run(1, "state_1,slip_rate_1,slip_1"),
        );
        for (mine, its) in [
            ("stress", "stress"),
            ("state_16", "state_1"),
            ("slip_rate_3", "slip_rate_1"),
            ("slip_2", "slip_1"),
        ] {
            let [made, known] =
                [(&many, mine), (&alone, its)].map(|(of, name)| number(of, &format!("/{name}")));
            let off = (made / known - 1.0).abs();
            assert!(off < 1e-11, "{law}, {mine}: {made} for {known}: {off:e}");
        }
    }
}

pub fn law(name: &str, a: f64, b: f64) -> AnyLaw {
    of_slip_length(name, a, b, 1.0)
}

fn of_slip_length(name: &str, a: f64, b: f64, length: f64) -> AnyLaw {
    let parameters = Parameters::new(a, b, 0.369, 100.0, 1e-3);
    AnyLaw::of_slip_length(name, parameters.expect("parameters"), length).expect("a law")
}

/// Two interfaces of which the second has another direct effect, normal stress and slip length.
#[test]
fn two_that_differ_in_stress_are_those_of_the_other_engine() {
    for name in ["spinodal", "slip"] {
        let known = last(&format!(
            "integrate --law {name} --driving 2 --stiffness 0.3 --damping 0.02 --set direct_effect_2=0.03,normal_stress_2=1.2,slip_length_2=1.5 \
             --start 10.2,0.6,0.5 --until 0.5 --final-only --rtol 1e-14 --method taylor"
        ));
        let one = OneOfMany {
            damping: 0.02,
            ..law(name, 0.0349, 0.0489).into()
        };
        let two = OneOfMany {
            law: of_slip_length(name, 0.03, 0.0489, 1.5),
            slip_length: 1.5,
            stress_factor: 0.0349 / (1.2 * 0.03),
            ..one
        };
        let loading = Loading::new(2.0, 0.3).expect("positive");
        let interfaces = ManyInterfaces::new(&[one, two], loading).expect("laws of one kind");
        let taylor = twinslip::many::ManyTaylor::new(1e-15, 10_000).expect("a tolerance");
        let made = taylor.flow(&interfaces, (10.2, &[0.6, 0.5]), 0.5, &mut |_| Ok(true));
        let made = made.expect("a flow");
        for (made, column) in [
            (made.stress(), "stress"),
            (made.state(0), "state_1"),
            (made.state(1), "state_2"),
        ] {
            let known = number(&known, &format!("/{column}"));
            let off = (made / known - 1.0).abs();
            assert!(off < 1e-11, "{name}, {column}: {made} for {known}: {off:e}");
        }
    }
}

/// J of (ln psi of each, tau), by jets of the laws.
pub fn jacobian(all: &[OneOfMany], loading: Loading, stress: f64, states: &[f64]) -> DMatrix<f64> {
    let n = all.len();
    let mut matrix = DMatrix::zeros(n + 1, n + 1);
    for (i, (one, psi)) in all.iter().zip(states).enumerate() {
        let [tau, w] = Jet::<f64, 2>::variables([stress, psi.ln()]);
        let psi = w.exp();
        let v = one
            .law
            .slip_rate(one.law.activation(tau * one.stress_factor), psi);
        let rate = one.law.evolution(v / one.slip_length, psi) / psi;
        matrix[(n, n)] -= loading.stiffness * v.gradient[0];
        matrix[(n, i)] = -loading.stiffness * v.gradient[1];
        matrix[(i, n)] = rate.gradient[0];
        matrix[(i, i)] = rate.gradient[1];
    }
    matrix
}

/// Elimination along the arrow and dense elimination with pivots, of a hundred interfaces: the same digits.
#[test]
fn the_arrow_matrix_is_solved_as_a_dense_one() {
    const N: usize = 100;
    for name in ["spinodal", "slip", "dieterich-ruina"] {
        let all: Vec<OneOfMany> = (0..N)
            .map(|i| {
                let part = i as f64 / N as f64;
                OneOfMany {
                    slip_length: 0.5 + part,
                    stress_factor: 1.1 - 0.2 * part,
                    ..law(name, 0.0349, 0.045 + 0.005 * part).into()
                }
            })
            .collect();
        let loading = Loading::new(50.0, 0.02).expect("positive");
        let interfaces = ManyInterfaces::new(&all, loading).expect("laws of one kind");
        let states: Vec<f64> = (0..N).map(|i| 0.01 * 1.05_f64.powi(i as i32)).collect();
        let b = DVector::from_fn(N + 1, |i, _| (1.7 * i as f64).sin());
        let stress = 9.5;
        let jacobian = jacobian(&all, loading, stress, &states);
        for diagonal in [1e-2, 1.0, 1e3] {
            let made = arrow_solution(&interfaces, (stress, &states), diagonal, b.as_slice());
            let made = DVector::from_vec(made.expect("pivots"));
            let matrix = DMatrix::identity(N + 1, N + 1) * diagonal - &jacobian;
            let known = matrix
                .clone()
                .full_piv_lu()
                .solve(&b)
                .expect("not singular");
            // backward: what is left of the system, in its rows
            let left = &matrix * &made - &b;
            for i in 0..=N {
                let size: f64 = (0..=N).map(|j| (matrix[(i, j)] * made[j]).abs()).sum();
                assert!(
                    left[i].abs() <= 1e-13 * size,
                    "{name}, row {i}: {:e}",
                    left[i] / size
                );
            }
            let off = (&made - &known).amax() / known.amax();
            assert!(off < 1e-10, "{name}, {diagonal}: {off:e}");
        }
    }
}
