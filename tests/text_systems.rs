//! User-defined systems from files: against values that others computed, closed forms, and the built-in systems.

use crate::command;
use crate::common::text::{SPINODAL, file, near};
use crate::common::{data, number as known};
use command::{folder, number, object, twinslip};
use serde_json::Value;
use std::fs;

/// A number with its budget, which must hold the truth.
#[track_caller]
fn budgeted(made: &Value, pointer: &str, exact: f64) {
    let value = number(made, &format!("{pointer}/value"));
    let uncertainty = number(made, &format!("{pointer}/uncertainty"));
    near(value, exact, 1e-10);
    let rounding = 2.0 * f64::EPSILON * exact.abs();
    assert!(
        (value - exact).abs() <= uncertainty + rounding,
        "{pointer}: {value} +- {uncertainty} for {exact}"
    );
}

#[test]
fn the_van_der_pol_orbit_is_that_of_others() {
    let exact = &data("foreign.json")["van_der_pol_mu5"];
    let made = object("orbit --system van-der-pol");
    budgeted(&made, "/result/orbit/period", known(&exact["period"]));
    let extremes = "/result/orbit/extremes";
    budgeted(
        &made,
        &format!("{extremes}/x/max"),
        known(&exact["amplitude"]),
    );
    budgeted(&made, &format!("{extremes}/y/max"), known(&exact["max_y"]));
    budgeted(
        &made,
        "/result/orbit/log_multipliers/0/ln_abs",
        known(&exact["ln_multiplier"]),
    );
    assert_eq!(made["result"]["orbit"]["verdict"], "stable");
    let apart = number(&made, "/result/orbit/crosscheck/period_difference");
    assert!(apart.abs() < 1e-8, "{apart}");
    assert_eq!(made["model"]["parameters"]["mu"], 5.0);
    assert_eq!(made["model"]["states"], serde_json::json!(["x", "y"]));
}

#[test]
fn the_unstable_lorenz_orbit_is_that_of_others() {
    let exact = &data("foreign.json")["lorenz"]["orbit_r24"];
    let start: Vec<&str> = exact["start"]
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_str().unwrap())
        .collect();
    let made = object(&format!(
        "orbit --system lorenz --set r=24 --start {} --period-guess 0.68",
        start.join(",")
    ));
    let orbit = &made["result"]["orbit"];
    budgeted(&made, "/result/orbit/period", known(&exact["period"]));
    for (i, exact) in exact["ln_multipliers"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
    {
        let pointer = format!("/result/orbit/log_multipliers/{i}/ln_abs");
        budgeted(&made, &pointer, known(exact));
    }
    for state in ["x", "z"] {
        for (end, exact) in ["min", "max"]
            .iter()
            .zip(exact[format!("{state}_extrema")].as_array().unwrap())
        {
            budgeted(
                &made,
                &format!("/result/orbit/extremes/{state}/{end}"),
                known(exact),
            );
        }
    }
    assert_eq!(orbit["verdict"], "unstable");
}

#[test]
fn the_lorenz_hopf_point_is_where_others_have_it() {
    let exact = &data("foreign.json")["lorenz"];
    let r = known(&exact["hopf_r"]);
    let ended = twinslip(&format!(
        "equilibria --system lorenz --set r={r} --start 8,8,23.7 --format json -q"
    ));
    // On the point itself stability cannot be told.
    assert_eq!(ended.code, 3, "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let one = &made["result"]["equilibria"][0];
    assert_eq!(one["verdict"], "undecided");
    let pair = one["eigenvalues"].as_array().expect("a list");
    near(pair[0][0].as_f64().unwrap(), 0.0, 1e-12);
    near(
        pair[0][1].as_f64().unwrap(),
        known(&exact["hopf_omega"]),
        1e-12,
    );
    for (r, verdict) in [(24.7, "stable"), (24.8, "unstable")] {
        let made = object(&format!(
            "equilibria --system lorenz --set r={r} --start 8,8,23.7"
        ));
        assert_eq!(made["result"]["equilibria"][0]["verdict"], verdict);
    }
}

#[test]
fn orbits_of_roessler_and_lorenz_84_are_those_of_others() {
    let all = data("foreign_orbits.json");
    let exact = &all["records"]["3b_lorenz84_orbit_F2_G0.5"]["values"];
    let made = object("orbit --system lorenz-84 --set F=2 --set G=0.5 --start 1.05,0.46,0");
    budgeted(&made, "/result/orbit/period", known(&exact["period"]));
    let pair = &exact["multipliers"][0];
    for i in 0..2 {
        let one = format!("/result/orbit/log_multipliers/{i}");
        budgeted(&made, &format!("{one}/ln_abs"), known(&pair["ln_abs"]));
        let angle = number(&made, &format!("{one}/angle_over_pi"));
        near(angle, known(&pair["arg"]) / std::f64::consts::PI, 1e-10);
    }
    // Where the period doubles one multiplier is -1.
    let exact = &all["records"]["2_roessler_PD1"]["values"];
    let c = known(&exact["c"]);
    let ended = twinslip(&format!(
        "orbit --system roessler --set c={c} --start 0,-4.79,0.0525 --period-guess 5.77 --format json -q"
    ));
    assert_eq!(ended.code, 3, "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    budgeted(&made, "/result/orbit/period", known(&exact["period"]));
    near(
        number(&made, "/result/orbit/log_multipliers/0/ln_abs/value"),
        0.0,
        1e-10,
    );
    assert_eq!(
        number(&made, "/result/orbit/log_multipliers/0/angle_over_pi"),
        1.0
    );
}

#[test]
fn the_wave_around_six_variables_is_that_of_others() {
    let exact = &data("foreign_orbits.json")["records"]["4a_lorenz96_N6_F2"]["values"];
    let names = |i: usize| format!("x{}", i % 6 + 1);
    let rate = |i: usize| {
        let [next, before, last] = [i + 1, i + 4, i + 5].map(names);
        format!("{0} = \"({next} - {before})*{last} - {0} + F\"\n", names(i))
    };
    let states: Vec<String> = (0..6).map(|i| format!("{:?}", names(i))).collect();
    let text = format!(
        "name = \"ring\"\nstates = [{}]\n[parameters]\nF = 2\n[rates]\n{}",
        states.join(", "),
        (0..6).map(rate).collect::<String>()
    );
    let system = file("text_ring", &text);
    let point = exact["point"].as_array().expect("a list").iter();
    let point: Vec<String> = point.map(|x| format!("{:.6}", known(x))).collect();
    let made = object(&format!(
        "orbit --system {system} --start {} --period-guess 2.73",
        point.join(",")
    ));
    budgeted(&made, "/result/orbit/period", known(&exact["period"]));
    for i in 0..5 {
        let one = format!("/result/orbit/log_multipliers/{i}");
        let multiplier = &exact["multipliers"][i];
        budgeted(
            &made,
            &format!("{one}/ln_abs"),
            known(&multiplier["ln_abs"]),
        );
        let angle = number(&made, &format!("{one}/angle_over_pi"));
        near(
            angle,
            known(&multiplier["arg"]).abs() / std::f64::consts::PI,
            1e-9,
        );
    }
}

#[test]
fn all_equilibria_of_a_box_are_found_and_counted_for_certain() {
    let made = object("equilibria --system lorenz --box x=-50:50,y=-50:50,z=-50:100");
    let list = made["result"]["equilibria"].as_array().expect("a list");
    assert_eq!((list.len(), &made["result"]["complete"]), (3, &true.into()));
    let r = 28.0;
    let b = number(&made, "/model/parameters/b");
    let x = (b * (r - 1.0)).sqrt();
    for (i, exact) in [[-x, -x, r - 1.0], [0.0; 3], [x, x, r - 1.0]]
        .into_iter()
        .enumerate()
    {
        for (state, exact) in ["x", "y", "z"].into_iter().zip(exact) {
            let pointer = format!("/result/equilibria/{i}/{state}");
            near(number(&made, &format!("{pointer}/value")), exact, 1e-14);
            assert!(number(&made, &format!("{pointer}/uncertainty")) < 1e-13);
        }
        assert_eq!(list[i]["verdict"], "unstable");
    }
    // At the origin: -b, and the roots of z^2 + (s + 1) z - s (r - 1).
    let root = (121.0_f64 + 4.0 * 270.0).sqrt();
    let exact = [0.5 * (-11.0 + root), -b, 0.5 * (-11.0 - root)];
    for (i, exact) in exact.into_iter().enumerate() {
        let value = number(&made, &format!("/result/equilibria/1/eigenvalues/{i}/0"));
        let bound = number(
            &made,
            &format!("/result/equilibria/1/eigenvalue_uncertainty/{i}"),
        );
        assert!(
            (value - exact).abs() <= bound && bound < 1e-12,
            "{value} +- {bound} for {exact}"
        );
    }
}

#[test]
fn equilibria_appear_at_the_folds_that_others_have() {
    let record = &data("foreign_orbits.json")["records"]["3a_lorenz84_equilibria_G0.5"]["values"];
    let [high, low] = [0, 1].map(|i| known(&record["folds"][i]["F"]));
    let count = |force: f64| {
        let made = object(&format!(
            "equilibria --system lorenz-84 --set F={force},G=0.5 --box x=-10:10,y=-10:10,z=-10:10"
        ));
        assert_eq!(made["result"]["complete"], true);
        made["result"]["equilibria"]
            .as_array()
            .expect("a list")
            .len()
    };
    let apart = 1e-6;
    let counts = [low - apart, low + apart, high - apart, high + apart].map(count);
    assert_eq!(counts, [1, 3, 3, 1]);
    // On the fold two are one, as far as can be told.
    let ended = twinslip(&format!(
        "equilibria --system lorenz-84 --set F={high},G=0.5 --box x=-10:10,y=-10:10,z=-10:10 --format json"
    ));
    assert_eq!(ended.code, 3, "{}", ended.err);
    assert!(ended.err.contains("undecided"), "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    assert_eq!(made["result"]["complete"], false);
}

#[test]
fn the_interfaces_written_as_a_file_are_the_built_in_ones() {
    let path = file("text_spinodal", SPINODAL);
    let (psi1, psi2) = ((-6.0_f64).exp(), (-6.2_f64).exp());
    let numerics = "--until 2 --rtol 1e-14 --method taylor --final-only";
    let built_in = object(&format!(
        "integrate --driving 10 --stiffness 0.14 --start 9.9,{psi1},{psi2} {numerics}"
    ));
    let written = object(&format!("integrate --system {path} {numerics}"));
    for (own, name) in [
        ("tau", "stress"),
        ("w1", "log_state_1"),
        ("w2", "log_state_2"),
    ] {
        let exact = number(&built_in, &format!("/result/final/{name}"));
        near(
            number(&written, &format!("/result/final/{own}")),
            exact,
            1e-12,
        );
    }
    let built_in = object("orbit --driving 10 --stiffness 0.14 --symmetry asymmetric");
    let point = built_in["result"]["orbit"]["point"]
        .as_array()
        .expect("a list");
    let point: Vec<String> = point.iter().map(Value::to_string).collect();
    let written = object(&format!(
        "orbit --system {path} --start {}",
        point.join(",")
    ));
    let exact = |pointer: &str| number(&built_in, &format!("/result/orbit/{pointer}"));
    let made = |pointer: &str| number(&written, &format!("/result/orbit/{pointer}"));
    near(made("period/value"), exact("period/value"), 1e-12);
    near(
        made("extremes/tau/min/value"),
        exact("stress_min/value"),
        1e-12,
    );
    near(
        made("extremes/tau/max/value"),
        exact("stress_max/value"),
        1e-12,
    );
    for i in 0..2 {
        let one = format!("log_multipliers/{i}/ln_abs");
        let apart = made(&format!("{one}/value")) - exact(&format!("{one}/value"));
        let budget = made(&format!("{one}/uncertainty")) + exact(&format!("{one}/uncertainty"));
        assert!(apart.abs() <= budget, "{apart} with {budget}");
    }
}

/// Along x' = 1 every function is the integral of its derivative: in power series, in 31 digits, and by another method's Jacobians.
#[test]
fn every_function_is_the_integral_of_its_derivative() {
    let functions = [
        ("exp(x)", "exp(x)"),
        ("ln(x + 2)", "1/(x + 2)"),
        ("log10(x + 2)", "1/((x + 2)*ln(10))"),
        ("sqrt(x + 2)", "0.5/sqrt(x + 2)"),
        ("sin(x)", "cos(x)"),
        ("cos(x)", "-sin(x)"),
        ("tan(x)", "1 + tan(x)^2"),
        ("sinh(x)", "cosh(x)"),
        ("cosh(x)", "sinh(x)"),
        ("tanh(x)", "1 - tanh(x)^2"),
        ("asinh(5*x)", "5/sqrt(1 + 25*x^2)"),
        ("atan(x)", "1/(1 + x^2)"),
        ("abs(x)", "x/abs(x)"),
        ("min(x, 0.25)", "0.5 + 0.5*(0.25 - x)/abs(0.25 - x)"),
        (
            "max(x^2, x)",
            "0.5*(2*x + 1) + 0.5*(2*x - 1)*(x^2 - x)/abs(x^2 - x)",
        ),
        ("pow(x + 2, p)", "p*(x + 2)^(p - 1)"),
        ("(x + 2)^x", "(x + 2)^x*(ln(x + 2) + x/(x + 2))"),
        ("x^5 - x^-2", "5*x^4 + 2*x^-3"),
        ("-x^2 + 2^-x", "-2*x - ln(2)*2^(-x)"),
        ("2^3^0.5*x + pi*x", "2^(3^0.5) + pi"),
    ];
    let place = folder("text_functions");
    for (i, (function, derivative)) in functions.into_iter().enumerate() {
        // The derivative of abs has no value at 0 itself, nor has x^-2.
        let begin = if function.contains("-2") { 0.5 } else { -0.7 };
        let path = place.join(format!("{i}.toml"));
        let text = format!(
            "name = \"f\"\nstates = [\"x\", \"y\", \"z\"]\n[parameters]\np = 1.7\n[rates]\nx = \"1\"\ny = \"{derivative}\"\nz = \"({function})*0.1\"\n"
        );
        fs::write(&path, text).expect("a file");
        let until = 1.3 - begin;
        let system = path.display();
        let run = |method: &str, rtol: f64| {
            let made = object(&format!(
                "integrate --system {system} --start {begin},0,0 --until {until} --method {method} --rtol {rtol} --final-only"
            ));
            ["y", "z"].map(|state| number(&made, &format!("/result/final/{state}")))
        };
        let [y, z] = run("taylor", 1e-15);
        let [_, by_other] = run("rodas5p", 1e-10);
        near(by_other, z, 1e-7);
        let value = |x: f64| {
            let p = 1.7_f64;
            match i {
                0 => x.exp(),
                1 => (x + 2.0).ln(),
                2 => (x + 2.0).log10(),
                3 => (x + 2.0).sqrt(),
                4 => x.sin(),
                5 => x.cos(),
                6 => x.tan(),
                7 => x.sinh(),
                8 => x.cosh(),
                9 => x.tanh(),
                10 => (5.0 * x).asinh(),
                11 => x.atan(),
                12 => x.abs(),
                13 => x.min(0.25),
                14 => (x * x).max(x),
                15 => (x + 2.0).powf(p),
                16 => (x + 2.0).powf(x),
                17 => x.powi(5) - x.powi(-2),
                18 => -x * x + (-x).exp2(),
                _ => 2_f64.powf(3_f64.sqrt()) * x + std::f64::consts::PI * x,
            }
        };
        let exact = value(1.3) - value(begin);
        assert!(
            (y - exact).abs() < 1e-13 * (1.0 + exact.abs()),
            "{function}: {y} for {exact}"
        );
    }
}

#[test]
fn a_run_that_begins_on_a_kink_leaves_it_to_its_own_side() {
    let text = "name = \"kink\"\nstates = [\"x\", \"y\", \"z\"]\n[parameters]\ns = 1\n[rates]\nx = \"s\"\ny = \"max(x, 0)\"\nz = \"abs(x)\"\n";
    let system = file("text_kink", text);
    for (s, y) in [(1.0, 0.5), (-1.0, 0.0)] {
        let made = object(&format!(
            "integrate --system {system} --set s={s} --start 0,0,0 --until 1 --method taylor --final-only"
        ));
        near(number(&made, "/result/final/y"), y, 1e-14);
        near(number(&made, "/result/final/z"), 0.5, 1e-14);
    }
}

#[test]
fn the_block_with_inertia_loses_its_stability_where_its_polynomial_says() {
    // With g = gamma^2/xi the eigenvalues of steady sliding solve x^3 + (1 + g) x^2 + (gamma^2 - eps g) x + gamma^2 = 0, of which two are
    // imaginary at eps = g xi/(1 + g).
    let (gamma, xi): (f64, f64) = (0.8, 0.5);
    let g = gamma * gamma / xi;
    let hopf = g * xi / (1.0 + g);
    let at = |eps: f64| {
        let ended = twinslip(&format!(
            "equilibria --system inertial-block --set eps={eps} --start 0,0,0 --format json -q"
        ));
        let made: Value = serde_json::from_str(&ended.out).expect("JSON");
        made["result"]["equilibria"][0].clone()
    };
    let one = at(hopf);
    near(number(&one, "/eigenvalues/0/0"), 0.0, 1e-14);
    let frequency = (gamma * gamma / (1.0 + g)).sqrt();
    near(number(&one, "/eigenvalues/0/1"), frequency, 1e-14);
    assert_eq!(one["verdict"], "undecided");
    assert_eq!(at(0.999 * hopf)["verdict"], "stable");
    assert_eq!(at(1.001 * hopf)["verdict"], "unstable");
}

#[test]
fn equal_blocks_slip_as_one_that_falls_from_static_to_sliding_friction() {
    // From the static friction 1 a block swings about that of sliding, 1/phi, to 2/phi - 1.
    let made = object(
        "integrate --system two-blocks --set beta=1,nu=1e-3,delta=3e-5,weakening=5e-4 --start 0.5,0.5,0.01,0.01 --until 1500 --points 150001 --columns time,y1,y2",
    );
    let rows = made["result"]["rows"].as_array().expect("rows");
    let of = |name: &str| -> Vec<f64> {
        let late = rows.iter().filter(|row| number(row, "/time") > 600.0);
        late.map(|row| row[name].as_f64().expect("a number"))
            .collect()
    };
    let (first, second) = (of("y1"), of("y2"));
    let most = first.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = first.iter().copied().fold(f64::INFINITY, f64::min);
    near(most, 1.0, 0.01);
    near(least, 2.0 / 1.25 - 1.0, 0.01);
    // Both start alike.
    assert!(first.iter().zip(&second).all(|(a, b)| (a - b).abs() < 1e-3));
}

#[test]
fn logarithms_and_exponentials_have_the_names_of_other_languages() {
    let path = file(
        "names_of_functions",
        r#"
        name = "names"
        states = ["x", "y", "z", "s"]
        [rates]
        x = "expm1(-x) + 1"
        y = "exp(-log1p(s))"
        z = "log(1 + s) - ln(1 + s) + 1e12*expm1(1e-12)"
        s = "1"
        [start]
        x = 0.0
        y = 0.0
        z = 0.0
        s = 0.0
        "#,
    );
    for method in ["taylor", "rodas5p"] {
        let made = object(&format!(
            "integrate --system {path} --until 2 --final-only --method {method} --rtol 1e-12 --atol 1e-12"
        ));
        let at = |name: &str| number(&made, &format!("/result/final/{name}"));
        near(at("x"), 3.0_f64.ln(), 1e-11);
        near(at("y"), 3.0_f64.ln(), 1e-11);
        near(at("z"), 2.0 * (1.0 + 0.5e-12), 1e-14);
    }
}
