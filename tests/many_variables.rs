//! Systems from formulas in more variables than most: Lorenz's ring of 1996 with 12, 40 and 100, against series in 50 digits; its equilibrium, whose
//! eigenvalues are those of a circulant matrix; and a chain along which something diffuses.

use crate::command::{object, twinslip};
use crate::common::data;
use crate::common::text::file;
use std::borrow::Cow;
use std::f64::consts::PI;
use twinslip::field::Vector;
use twinslip::integrate::{AnyField, AnyIntegrator, Choice, MAX_STEPS, Tolerances};
use twinslip::model::TextSystem;
use twinslip_tasks::scene::{TextModel, TextOptions};

/// Lorenz's ring as a file.
pub fn text(count: usize, forcing: f64) -> String {
    let names: Vec<String> = (0..count).map(|i| format!("x{i}")).collect();
    let (mut rates, mut start) = (String::new(), String::new());
    for i in 0..count {
        let of = |by: usize| &names[(i + by) % count];
        let (next, before, last) = (of(1), of(count - 2), of(count - 1));
        rates += &format!("x{i} = \"({next} - {before})*{last} - x{i} + F\"\n");
        start += &format!("x{i} = {:?}\n", 0.9 * forcing);
    }
    format!(
        "name = \"ring\"\nstates = {names:?}\n[parameters]\nF = {forcing:?}\n[rates]\n{rates}[start]\n{start}"
    )
}

fn ring(count: usize) -> TextSystem {
    let options = TextOptions {
        system: Some(text(count, 8.0).into()),
        ..TextOptions::default()
    };
    let model = TextModel::named(&options).expect("a good file");
    model.expect("a system").system
}

#[test]
fn rings_of_a_dozen_to_a_hundred_come_where_their_series_do() {
    let all = data("lorenz_96.json");
    for count in [12, 40, 100] {
        let system = ring(count);
        let field = AnyField::of_text(Cow::Borrowed(&system)).expect("a field");
        assert_eq!(field.dimension(), count);
        let start = Vector::from_fn(count, |i, _| 8.0 + ((7 * i % 13) as f64 - 6.0) / 64.0);
        let known = all[count.to_string()].as_array().expect("a list").iter();
        let known: Vec<f64> = known
            .map(|x| x.as_str().unwrap().parse().unwrap())
            .collect();
        for method in ["taylor", "radau", "rodas5p"] {
            let tolerances = Tolerances::equal(1e-12).expect("tolerances");
            let choice = Choice::named(method).expect("a method");
            let mut by = AnyIntegrator::new(choice, tolerances, MAX_STEPS).expect("a method");
            let end = by.flow(&field, (0.0, 2.0), &start, None).expect("a run");
            // The ring is chaotic: what steps err grows a hundredfold.
            let bar = if method == "rodas5p" { 1e-7 } else { 1e-9 };
            let off = (end - Vector::from_column_slice(&known)).amax();
            assert!(off < bar, "{count}, {method}: {off}");
        }
    }
}

#[test]
fn the_equilibrium_of_a_ring_has_the_eigenvalues_of_a_circulant() {
    // Beside the Hopf point F = 1 / max(cos(a) - cos(2 a)), a = 2 pi k / 40, k = 8.
    let angle = |k: usize| 2.0 * PI * k as f64 / 40.0;
    let hopf = 1.0 / (angle(8).cos() - angle(16).cos());
    for (forcing, verdict) in [(0.99 * hopf, "stable"), (1.01 * hopf, "unstable")] {
        let path = file("many_variables_equilibrium", &text(40, forcing));
        let made = object(&format!("equilibria --system {path}"));
        let found = made["result"]["equilibria"].as_array().expect("a list");
        let [one] = &found[..] else {
            panic!("{found:?}")
        };
        assert_eq!(one["verdict"], verdict);
        let eigenvalues = one["eigenvalues"].as_array().expect("a list");
        assert_eq!(eigenvalues.len(), 40);
        for k in 0..40 {
            let real = -1.0 + forcing * (angle(k).cos() - angle(2 * k).cos());
            let imaginary = forcing * (angle(k).sin() + angle(2 * k).sin());
            let off = |pair: &serde_json::Value| {
                let part = |i: usize| pair[i].as_f64().expect("a number");
                (part(0) - real).hypot(part(1) - imaginary)
            };
            let nearest = eigenvalues.iter().map(off).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-12, "{k}: {nearest}");
        }
    }
}

/// A wave in a ring along which something diffuses decays as it is.
#[test]
fn a_wave_decays_in_a_ring_of_fifty() {
    const COUNT: usize = 50;
    let wave = |i: usize| (2.0 * PI * 3.0 * i as f64 / COUNT as f64).cos();
    let names: Vec<String> = (0..COUNT).map(|i| format!("u{i}")).collect();
    let (mut rates, mut start) = (String::new(), String::new());
    for i in 0..COUNT {
        let (next, last) = ((i + 1) % COUNT, (i + COUNT - 1) % COUNT);
        rates += &format!("u{i} = \"D*(u{next} - 2*u{i} + u{last})\"\n");
        start += &format!("u{i} = {:?}\n", wave(i));
    }
    let text = format!(
        "name = \"diffusion\"\nstates = {names:?}\n[parameters]\nD = 100.0\n[rates]\n{rates}[start]\n{start}"
    );
    let path = file("many_variables_diffusion", &text);
    let half = PI * 3.0 / COUNT as f64;
    let left = (-4.0 * 100.0 * half.sin().powi(2) * 0.1).exp();
    for (method, tolerance, bar) in [
        ("auto", 1e-12, 1e-10),
        ("taylor", 1e-12, 1e-10),
        ("radau", 1e-12, 1e-10),
        ("rodas5p", 1e-12, 1e-10),
        ("rodas4", 1e-10, 1e-8),
        ("rosenbrock23", 1e-8, 1e-5),
        ("cvode-bdf", 1e-12, 1e-9),
        ("cvode-adams", 1e-12, 1e-9),
    ] {
        if method.starts_with("cvode") && !cfg!(feature = "sundials") {
            continue;
        }
        let made = object(&format!(
            "integrate --system {path} --until 0.1 --method {method} --rtol {tolerance} --atol {tolerance} --final-only"
        ));
        for i in [0, 7, 49] {
            let made = made["result"]["final"][format!("u{i}")].as_f64();
            let off = (made.expect("a number") - left * wave(i)).abs();
            assert!(off < bar, "{method}, u{i}: {off}");
        }
    }
}

#[test]
fn many_states_are_drawn_in_one_panel() {
    let path = file("many_variables_picture", &text(12, 8.0));
    let picture = path.replace("system.toml", "run.svg");
    let data = path.replace("system.toml", "run.csv");
    let run =
        format!("integrate --system {path} --until 5 --points 300 -o {data} --plot {picture} -q");
    let made = twinslip(&run);
    assert_eq!(made.code, 0, "{}", made.err);
    let drawn = std::fs::read_to_string(&picture).expect("a picture");
    assert!(drawn.contains("number of the state"));
    assert_eq!(drawn.matches("time t").count(), 1);
}

#[test]
fn more_variables_than_a_hundred_are_refused() {
    let path = file("many_variables_beyond", &text(101, 1.0));
    for command in [
        "integrate --until 1",
        "orbit",
        "branch equilibria --along F --from 1 --to 2",
    ] {
        let made = twinslip(&format!("{command} --system {path} -q"));
        assert_eq!(made.code, 2);
        let says = "there are 101 states, but there must be 1 to 100";
        assert!(made.err.contains(says), "{command}: {}", made.err);
    }
}
