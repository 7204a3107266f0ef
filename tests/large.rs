//! Systems of forty to a hundred variables in the commands, against values that were computed elsewhere: Lorenz's ring of 1996, a ring of van der Pol's
//! oscillators and the Brusselator in cells. Further commands on such systems are in `many_variables*`.

use super::many_variables_orbits::{brusselator, oscillators, within};
use crate::command::{self, object};
use crate::common::data;
use crate::common::text::file;
use serde_json::Value;
use std::borrow::Cow;
use std::f64::consts::{PI, TAU};
use twinslip::field::{Matrix, Vector};
use twinslip::integrate::AnyField;
use twinslip_tasks::scene::{TextModel, TextOptions};

fn number(text: &Value) -> f64 {
    match text {
        Value::String(text) => text.parse().expect("a number"),
        number => number.as_f64().expect("a number"),
    }
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array()
        .expect("a list")
        .iter()
        .map(number)
        .collect()
}

/// The values of a case.
fn case(id: &str) -> Value {
    let all = data("large.json");
    let mut cases = all["cases"].as_array().expect("a list").iter();
    let one = cases.find(|case| case["id"] == id).expect("a case");
    one["values"].clone()
}

/// That a run ends where it does, within its own estimate and a bar.
#[track_caller]
fn ends(command: &str, known: &[(String, f64)], bar: f64) {
    let made = object(command);
    let end = &made["result"]["final"];
    for (name, known) in known {
        let uncertainty = &end[format!("{name}_uncertainty")];
        let made = serde_json::json!({ "value": end[name], "uncertainty": uncertainty });
        within(&made, *known, bar);
    }
}

#[test]
fn the_ring_of_forty_ends_where_its_series_of_34_digits_do() {
    let known = numbers(&case("lorenz96_N40_F8_end_state")["x"]);
    let known: Vec<_> = (0..)
        .map(|i| format!("x{i}"))
        .zip(known.iter().copied())
        .collect();
    ends(
        "integrate --system lorenz-96 --until 2 --rtol 1e-13 --estimate-error",
        &known,
        1e-9,
    );
}

#[test]
fn ten_oscillators_out_of_phase_end_where_their_series_of_34_digits_do() {
    let values = case("ring_vdp_N10_end_state");
    let path = file("large_oscillators", &oscillators(10, 1.0));
    let start: Vec<String> = (0..10)
        .map(|i| format!("{},0", (10 + 7 * i % 10) as f64 / 10.0))
        .collect();
    let of = |name: &str| {
        let named = numbers(&values[name]).into_iter().enumerate();
        let named = named.map(|(i, x)| (format!("{name}{i}"), x));
        named.collect::<Vec<_>>()
    };
    let command = format!(
        "integrate --system {path} --set mu=1 --set k=0.1 --start {} --until 30 --rtol 1e-13 --estimate-error",
        start.join(",")
    );
    ends(&command, &[of("x"), of("y")].concat(), 1e-11);
}

#[test]
fn twenty_five_oscillators_in_phase_have_the_multipliers_of_their_waves() {
    let known = case("ring_vdp_N25_in_phase");
    let made = object("orbit --system oscillator-ring --crosscheck none");
    let orbit = &made["result"]["orbit"];
    within(&orbit["period"], number(&known["period"]), 1e-11);
    assert_eq!(orbit["verdict"], "unstable");
    let mut left: Vec<&Value> = orbit["log_multipliers"]
        .as_array()
        .expect("a list")
        .iter()
        .collect();
    assert_eq!(left.len(), 49);
    let mut take = |ln: f64, angle: f64| {
        let near = left.iter().position(|one| {
            let turned = number(&one["angle_over_pi"]);
            (number(&one["ln_abs"]["value"]) - ln).abs() < 1e-10 && (turned - angle).abs() < 1e-10
        });
        let near = near.unwrap_or_else(|| panic!("no multiplier of ln {ln}, angle {angle}"));
        within(&left.swap_remove(near)["ln_abs"], ln, 1e-10);
    };
    take(number(&known["in_phase_ln_multiplier"]), 0.0);
    for wave in known["transverse"].as_array().expect("a list") {
        for one in wave["multipliers"].as_array().expect("two") {
            let (re, im) = match one {
                Value::Array(parts) => (number(&parts[0]), number(&parts[1])),
                one => (number(one), 0.0),
            };
            for _ in 0..wave["multiplicity"].as_u64().expect("a count") {
                take(re.hypot(im).ln(), im.abs().atan2(re) / PI);
            }
        }
    }
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn the_cycle_of_twenty_five_cells_has_its_leading_multipliers() {
    let known = case("brusselator_N25_cycle_L0.6");
    let made = object("orbit --system brusselator-cells --crosscheck none");
    let orbit = &made["result"]["orbit"];
    within(&orbit["period"], number(&known["period"]), 1e-11);
    assert_eq!(orbit["verdict"], "stable");
    // The first one is 1, of the flow itself.
    let leading = known["leading_multipliers"].as_array().expect("a list")[1..].iter();
    for (one, known) in orbit["log_multipliers"]
        .as_array()
        .expect("a list")
        .iter()
        .zip(leading)
    {
        let known = match known {
            Value::Array(parts) => number(&parts[0]).hypot(number(&parts[1])),
            known => number(known),
        };
        let off = number(&one["ln_abs"]["value"]) - known.ln();
        assert!(off.abs() < 1e-10, "{one}");
    }
}

#[test]
fn the_exponents_of_the_chaotic_ring_are_those_of_long_runs() {
    let known = case("lorenz96_N40_F8_lyapunov");
    let made = object(
        "section --system lorenz-96 --surface x0=0 --upwards --skip 10 --returns 200 --lyapunov",
    );
    assert_eq!(made["result"]["regime"], "chaotic");
    let exponents = made["result"]["lyapunov"].as_array().expect("a list");
    assert_eq!(exponents.len(), 40);
    let values = numbers(&known["exponents"]);
    let known = values.iter().zip(numbers(&known["standard_errors"]));
    for (made, (known, error)) in exponents.iter().zip(known) {
        let off = number(&made["value"]) - known;
        let bar = 2.0 * (number(&made["uncertainty"]) + error);
        assert!(off.abs() < bar, "{made} for {known} ± {error}");
    }
    // Volumes shrink as the trace says.
    let sum: f64 = exponents.iter().map(|one| number(&one["value"])).sum();
    assert!((sum + 40.0).abs() < 1e-6, "{sum}");
}

#[test]
fn a_hundred_variables_have_the_hopf_points_of_their_waves() {
    const CELLS: usize = 50;
    let path = file("large_cells", &brusselator(CELLS, 0.6, 0.0));
    let made = object(&format!(
        "branch equilibria --system {path} --along L --from 0.3 --to 1.2"
    ));
    let special = made["result"]["special"].as_array().expect("a list");
    let found = special.iter().filter(|point| point["label"] == "HB");
    let found: Vec<&Value> = found.collect();
    assert_eq!(found.len(), 2);
    for (wave, point) in (1..).zip(found) {
        let size = (CELLS + 1) as f64;
        let squared = 4.0 * (size * (PI * f64::from(wave) / (2.0 * size)).sin()).powi(2);
        let length = (0.012 * squared / 0.45).sqrt();
        let slow = 4.0 + 0.004 * squared / length.powi(2);
        within(&point["L"], length, 1e-10);
        within(
            &point["period"],
            TAU / (4.0 * 5.45 - slow.powi(2)).sqrt(),
            1e-10,
        );
    }
}

#[test]
fn derivatives_of_many_variables_at_once_are_those_of_each() {
    let options = TextOptions {
        system: Some("brusselator-cells".into()),
        ..TextOptions::default()
    };
    let model = TextModel::named(&options).expect("a good file");
    let system = model.expect("a system").system;
    let field = AnyField::of_text(Cow::Borrowed(&system)).expect("a field");
    let n = field.dimension();
    let y = Vector::from_fn(n, |i, _| 2.0 + 0.3 * (1.7 * i as f64).sin());
    let unit = |i: usize| Vector::from_fn(n, |k, _| f64::from(u8::from(i == k)));
    let jacobian = field.jacobian(&y);
    for j in 0..n {
        // The rates are cubic: differences of this order are exact but for rounding.
        let at = |h: f64| field.f(&(&y + unit(j) * h));
        let h = 0.25;
        let column = ((at(h) - at(-h)) * 8.0 - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
        assert!((jacobian.column(j) - column).amax() < 1e-11, "{j}");
    }
    let mut all = vec![Matrix::zeros(n, n); n];
    for second in field.second_derivatives(&y) {
        for (i, j) in second.orders() {
            assert_eq!(all[second.of][(i, j)], 0.0, "only once");
            all[second.of][(i, j)] = second.value;
        }
    }
    for i in 0..n {
        for j in 0..n {
            let each = field.second_derivative(&y, &unit(i), &unit(j));
            let together = Vector::from_fn(n, |k, _| all[k][(i, j)]);
            assert_eq!(each, together, "{i}, {j}");
        }
    }
    let place = field.parameter_names().iter().position(|name| *name == "L");
    let by_length = field.parameter_jacobian(&y, place.expect("a parameter"));
    // D (N + 1)^2 / L^2 is all that depends on L.
    let diffusion = 0.008 * (26.0_f64 / 0.6).powi(2);
    assert!((by_length[(3, 3)] - 4.0 * diffusion / 0.6).abs() < 1e-10);
    assert!((by_length[(3, 4)] + 2.0 * diffusion / 0.6).abs() < 1e-10);
    assert_eq!(by_length[(3, 28)], 0.0);
}

#[test]
fn a_picture_says_which_states_it_shows() {
    let picture = command::folder("large-picture").join("waves.svg");
    let ended = command::twinslip(&format!(
        "branch equilibria --system brusselator-cells --along L=0.4:0.6 -q --plot {}",
        picture.display()
    ));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let drawn = std::fs::read_to_string(picture).expect("a picture");
    assert!(drawn.contains("the first 6 of 50 states"), "{drawn:.2000}");
}
