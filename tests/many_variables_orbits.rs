//! Orbits and returns of systems from formulas in more variables than most: rings of oscillators that do in phase what one does, with the multipliers of each
//! wave number; the Brusselator in cells, against series in long doubles; and a ring at rest.

use crate::command::object;
use crate::common::data;
use crate::common::text::file;
use serde_json::Value;
use std::f64::consts::PI;

fn number(text: &Value) -> f64 {
    let number = text.as_str().expect("a text").parse();
    number.expect("a number")
}

/// A ring of van der Pol's oscillators, which begins in phase.
pub fn oscillators(count: usize, x: f64) -> String {
    let states: Vec<String> = (0..count)
        .flat_map(|i| [format!("x{i}"), format!("y{i}")])
        .collect();
    let (mut rates, mut start) = (String::new(), String::new());
    for i in 0..count {
        let (next, last) = ((i + 1) % count, (i + count - 1) % count);
        rates += &format!("x{i} = \"y{i}\"\n");
        rates +=
            &format!("y{i} = \"mu*(1 - x{i}^2)*y{i} - x{i} + k*(x{next} + x{last} - 2*x{i})\"\n");
        start += &format!("x{i} = {x:?}\ny{i} = 0.0\n");
    }
    format!(
        "name = \"oscillators\"\nstates = {states:?}\n[parameters]\nmu = 0.5\nk = 0.3\n[rates]\n{rates}[start]\n{start}"
    )
}

/// The Brusselator in cells between held ends.
pub fn brusselator(cells: usize, length: f64, deviation: f64) -> String {
    let states: Vec<String> = (0..2 * cells)
        .map(|i| format!("{}{}", ["X", "Y"][i / cells], i % cells))
        .collect();
    let (mut rates, mut start) = (String::new(), String::new());
    for (name, held, made, rate, begin) in [
        ("X", "A", "A - (B + 1)*X# + X#^2*Y#", "Dx", 2.0),
        ("Y", "B/A", "B*X# - X#^2*Y#", "Dy", 2.725),
    ] {
        for i in 0..cells {
            let at = |j: Option<usize>| match j.filter(|j| *j < cells) {
                Some(j) => format!("{name}{j}"),
                None => held.to_owned(),
            };
            let (last, next) = (at(i.checked_sub(1)), at(Some(i + 1)));
            let made = made.replace('#', &i.to_string());
            let squared = (cells + 1).pow(2);
            rates += &format!(
                "{name}{i} = \"{made} + {squared}*{rate}/L^2*({last} - 2*{name}{i} + {next})\"\n"
            );
            let wave = (PI * (i + 1) as f64 / (cells + 1) as f64).sin();
            start += &format!("{name}{i} = {:?}\n", begin + deviation * wave);
        }
    }
    format!(
        "name = \"cells\"\nstates = {states:?}\n[parameters]\nA = 2.0\nB = 5.45\nDx = 0.008\nDy = 0.004\nL = {length:?}\n[rates]\n{rates}[start]\n{start}"
    )
}

/// That a number with an uncertainty is as near as that, and nearer than a bar.
#[track_caller]
pub fn within(made: &Value, known: f64, bar: f64) {
    let part = |name: &str| made[name].as_f64().expect("a number");
    let (value, uncertainty) = (part("value"), part("uncertainty"));
    let off = (value - known).abs();
    assert!(
        off <= uncertainty + f64::EPSILON * known.abs() && off < bar && uncertainty < bar,
        "{made} for {known}"
    );
}

#[test]
fn a_ring_of_ten_oscillators_has_the_orbit_of_one_and_the_multipliers_of_its_waves() {
    let known = &data("many_variables.json")["van_der_pol"];
    let path = file(
        "many_variables_oscillators",
        &oscillators(10, number(&known["x_max"])),
    );
    let made = object(&format!("orbit --system {path} --crosscheck none"));
    let orbit = &made["result"]["orbit"];
    within(&orbit["period"], number(&known["period"]), 1e-10);
    assert_eq!(orbit["verdict"], "unstable");
    let logs = orbit["log_multipliers"].as_array().expect("a list");
    assert_eq!(logs.len(), 19);
    let alike = |ln: f64, angle: f64| {
        let near = logs.iter().filter(|one| {
            let turned = one["angle_over_pi"].as_f64().expect("an angle");
            let value = one["ln_abs"]["value"].as_f64().expect("a number");
            (value - ln).abs() < 1e-10 && (turned - angle).abs() < 1e-10
        });
        let near: Vec<&Value> = near.collect();
        near.iter()
            .for_each(|one| within(&one["ln_abs"], ln, 1e-10));
        near.len()
    };
    assert_eq!(alike(number(&known["in_phase_ln_multiplier"]), 0.0), 1);
    // Two waves along ten are five along twenty-five, and four are ten.
    for (wave, times) in [(5, [2, 2]), (10, [4, 4])] {
        let both = known["transverse"][wave - 1].as_array().expect("a list");
        for (one, times) in both.iter().zip(times) {
            let (re, im) = match one {
                Value::Array(parts) => (number(&parts[0]), number(&parts[1])),
                one => (number(one), 0.0),
            };
            let angle = im.abs().atan2(re) / PI;
            assert_eq!(alike(re.hypot(im).ln(), angle), times, "{wave}");
        }
    }
}

#[test]
fn the_cycle_of_fifty_variables_returns_as_its_series_do() {
    let known = &data("many_variables.json")["brusselator"];
    let path = file("many_variables_cells", &brusselator(25, 0.6, 0.1));
    let made = object(&format!(
        "section --system {path} --surface X12=2 --upwards --returns 100 --lyapunov"
    ));
    let result = &made["result"];
    assert_eq!(result["regime"], "periodic");
    within(&result["period"], number(&known["period"]), 1e-10);
    let last = result["rows"]
        .as_array()
        .expect("rows")
        .last()
        .expect("one");
    for name in ["X", "Y"] {
        for (i, known) in known[name].as_array().expect("a list").iter().enumerate() {
            let made = last[format!("{name}{i}")].as_f64().expect("a number");
            assert!((made - number(known)).abs() < 1e-8, "{name}{i}: {made}");
        }
    }
}

#[test]
fn the_exponents_of_a_ring_at_rest_are_those_of_a_circulant() {
    const COUNT: usize = 40;
    let path = file(
        "many_variables_at_rest",
        &super::many_variables::text(COUNT, 0.5),
    );
    let made = object(&format!(
        "section --system {path} --surface x0=0.45 --lyapunov"
    ));
    assert_eq!(made["result"]["regime"], "steady");
    let angle = |k: usize| 2.0 * PI * k as f64 / COUNT as f64;
    let rate = |k: usize| 0.5 * (angle(k).cos() - angle(2 * k).cos()) - 1.0;
    let mut known: Vec<f64> = (0..COUNT).map(rate).collect();
    known.sort_by(|a, b| b.total_cmp(a));
    let exponents = made["result"]["lyapunov"].as_array().expect("a list");
    assert_eq!(exponents.len(), COUNT);
    for (made, known) in exponents.iter().zip(known) {
        within(made, known, 1e-10);
    }
}

#[test]
fn a_sweep_tells_the_cycle_of_a_ring() {
    let known = &data("many_variables.json")["van_der_pol"];
    let path = file("many_variables_swept", &oscillators(6, 2.0));
    let made = object(&format!("sweep --system {path} --grid mu=0.5:1:2"));
    let rows = made["result"]["rows"].as_array().expect("rows");
    assert_eq!(rows[0]["regime"], "periodic");
    let period = rows[0]["period"].as_f64().expect("a number");
    let off = period - number(&known["period"]);
    assert!(off.abs() < 1e-6, "{period}");
}
