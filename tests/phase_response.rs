//! The phase response of periodic orbits and their derivatives in parameters, beside values of 22 digits and more and beside identities.

use crate::command::{csv, folder, number, object, refused_in_one_line, twinslip};
use crate::common::text::file;
use crate::common::{self, data};
use serde_json::Value;

const VAN_DER_POL: &str = "name = \"van der Pol\"\nstates = [\"x\", \"y\"]\n[parameters]\nmu = 1.0\n[rates]\nx = \"y\"\ny = \"mu*(1-x*x)*y-x\"\n";
const FORCED: &str = "name = \"forced\"\nstates = [\"x\", \"v\"]\nperiod = \"2*pi/omega\"\n[parameters]\ndelta = 0.25\ngamma = 0.3\nomega = 1.0\n[rates]\n\
    x = \"v\"\nv = \"-x - x^3 - delta*v + gamma*cos(omega*t)\"\n[start]\nx = 1.0\nv = 0.0\n";
const POINCARE: &str = "name = \"Poincare\"\nstates = [\"x\", \"y\"]\n[parameters]\nlam = 0.5\nom = 2\nq = 0\n[rates]\n\
    x = \"lam*x*(1-(x*x+y*y))-y*(om+q*(1-(x*x+y*y)))\"\ny = \"lam*y*(1-(x*x+y*y))+x*(om+q*(1-(x*x+y*y)))\"\n";
const MORRIS_LECAR: &str = "name = \"Morris-Lecar\"\nstates = [\"V\", \"w\"]\n[parameters]\nI = 50\nC = 20\ngL = 2\ngK = 8\ngCa = 4\nVL = -60\n\
    VK = -84\nVCa = 120\nV1 = -1.2\nV2 = 18\nV3 = 12\nV4 = 17.4\nphi = 0.06\n[rates]\n\
    V = \"(I-gL*(V-VL)-gK*w*(V-VK)-gCa*(1+tanh((V-V1)/V2))/2*(V-VCa))/C\"\n\
    w = \"phi*((1+tanh((V-V3)/V4))/2-w)*(exp((V-V3)/(2*V4))+exp(-(V-V3)/(2*V4)))/2\"\n";

/// An independent value is within the bound of what was found, which is this near, too.
#[track_caller]
fn within(found: &Value, exact: f64, bar: f64, what: &str) {
    within_of(found, (exact, 0.0), bar, what);
}

/// The same of a value that is known to an error.
#[track_caller]
fn within_of(found: &Value, (exact, known): (f64, f64), bar: f64, what: &str) {
    let (value, bound) = (number(found, "/value"), number(found, "/uncertainty"));
    let off = (value - exact).abs();
    // Of the digits of a double in which the value is written.
    let rounding = 4.0 * f64::EPSILON * exact.abs();
    assert!(
        off <= bound + rounding + known && bound <= bar * exact.abs().max(1.0),
        "{what}: {value} ± {bound} for {exact}"
    );
}

fn parameters(case: &Value) -> String {
    let all = case["problem"]["parameters"]
        .as_object()
        .expect("parameters");
    let all = all
        .iter()
        .map(|(name, x)| format!(" --set {name}={}", common::number(x)));
    all.collect()
}

#[test]
fn responses_are_those_of_the_reference_within_their_bounds() {
    /// Rows between two points of the reference.
    const BETWEEN: usize = 500;
    /// What differences of rows leave of a correction by them.
    const CORRECTED: f64 = 1e-4;
    let cases = data("phase.json");
    for case in cases["cases"].as_array().expect("cases") {
        let id = case["id"].as_str().expect("an id");
        let text = match id {
            _ if id.contains("van_der_pol") => VAN_DER_POL,
            _ if id.contains("morris") => MORRIS_LECAR,
            _ => POINCARE,
        };
        let states: &[&str] = if id.contains("morris") {
            &["V", "w"]
        } else {
            &["x", "y"]
        };
        let at = |state: &str| match &case["values"]["phase_0"][state] {
            Value::Null => f64::from(u8::from(state == "x")),
            x => common::number(x),
        };
        let begin: Vec<f64> = states.iter().map(|state| at(state)).collect();
        let period = common::number(&case["values"]["period"]);
        let path = file(&format!("phase-response-{id}"), text);
        let made = object(&format!(
            "orbit --system {path}{} --start {:?},{:?} --period-guess {period:?} --phase-response --points {} --crosscheck none",
            parameters(case),
            begin[0],
            begin[1],
            8 * BETWEEN + 1
        ));
        let rows = made["result"]["rows"].as_array().expect("rows");
        assert_eq!(rows.len(), 8 * BETWEEN + 1);
        let response = |row: &Value, state: &str| number(row, &format!("/response_{state}/value"));
        // The orbit may begin beside the reference's phase 0.
        let later: f64 = states
            .iter()
            .zip(&begin)
            .map(|(state, x)| {
                response(&rows[0], state) * (x - number(&rows[0], &format!("/{state}")))
            })
            .sum();
        assert!(later.abs() < 1e-6, "{id}: {later}");
        let step = period / (8 * BETWEEN) as f64;
        for (i, exact) in case["values"]["Z"]
            .as_array()
            .expect("values")
            .iter()
            .enumerate()
        {
            let k = i * BETWEEN;
            let around = [(k + 8 * BETWEEN - 1) % (8 * BETWEEN), k + 1];
            for state in states {
                let [before, after] = around.map(|k| response(&rows[k], state));
                let moved = later * (after - before) / (2.0 * step);
                let exact = common::number(&exact[*state]) - moved;
                let found = &rows[k][format!("response_{state}")];
                within_of(
                    found,
                    (exact, CORRECTED * moved.abs()),
                    1e-9,
                    &format!("{id}, {state} at {i}/8"),
                );
            }
        }
    }
}

#[test]
fn derivatives_of_van_der_pol_are_those_of_the_reference() {
    let path = file("derivatives-van-der-pol", VAN_DER_POL);
    let cases = data("phase.json");
    let all = cases["cases"].as_array().expect("cases").iter();
    let mut seen = 0;
    for case in all.filter(|case| !case["values"]["dT_dmu"].is_null()) {
        let exact = |name: &str| common::number(&case["values"][name]);
        for method in ["auto", "radau", "rodas5p"] {
            let made = object(&format!(
                "orbit --system {path}{} --start 2,0 --derivatives mu --method {method} --crosscheck none",
                parameters(case)
            ));
            let found = &made["result"]["orbit"]["derivatives"];
            within(&found["period"]["mu"], exact("dT_dmu"), 1e-9, "dT");
            within(
                &found["ln_abs"][0]["mu"],
                exact("dln_multiplier_dmu"),
                1e-8,
                "dln",
            );
            within(
                &found["maximum"]["x"]["mu"],
                exact("dxmax_dmu"),
                1e-9,
                "dmax",
            );
            within(
                &found["minimum"]["x"]["mu"],
                -exact("dxmax_dmu"),
                1e-9,
                "dmin",
            );
            seen += 1;
        }
    }
    assert_eq!(seen, 6);
}

/// What a kick along the flow advances an orbit by is its own time: Z . f = 1, with differences of the states for f.
#[track_caller]
fn carries_the_flow(words: &str, states: &[&str]) {
    let made = object(&format!(
        "orbit {words} --phase-response --points 4001 --crosscheck none"
    ));
    let rows = made["result"]["rows"].as_array().expect("rows");
    let step = number(&rows[1], "/time") - number(&rows[0], "/time");
    // Where the motion is slow differences are accurate.
    let mut seen = 0;
    for k in 2..rows.len() - 2 {
        let state = |k: usize, name: &str| number(&rows[k], &format!("/{name}"));
        let rate = |name: &str, by: usize| {
            (state(k + by, name) - state(k - by, name)) / (2.0 * by as f64 * step)
        };
        let product = |by: usize| -> f64 {
            states
                .iter()
                .map(|name| number(&rows[k], &format!("/response_{name}/value")) * rate(name, by))
                .sum()
        };
        let [one, two] = [product(1), product(2)];
        if (one - two).abs() < 1e-8 {
            let product = (4.0 * one - two) / 3.0;
            assert!((product - 1.0).abs() < 1e-7, "{words}: {product} at {k}");
            seen += 1;
        }
    }
    assert!(seen > 100, "{words}: {seen} rows");
}

#[test]
fn interfaces_of_every_kind_have_responses() {
    let two = ["stress", "log_state_1", "log_state_2"];
    carries_the_flow("--driving 1 --stiffness 0.02 --interfaces 1", &two[..2]);
    carries_the_flow("--driving 1 --stiffness 0.02", &two);
    carries_the_flow(
        "--driving 0.5 --stiffness 0.02 --set residual_strength_2=0.002",
        &two,
    );
    carries_the_flow(
        "--driving 1 --stiffness 0.02 --interfaces 3 --clusters 2,1",
        &two,
    );
    carries_the_flow(
        "--si --driving 1e-6 --stiffness 1e6 --interfaces 1",
        &two[..2],
    );
}

#[test]
fn interfaces_that_move_alike_share_a_response_and_derivatives() {
    let words = "orbit --driving 1 --stiffness 0.02 --crosscheck none";
    let names = "residual_strength,residual_strength_1,residual_strength_2";
    let made = object(&format!(
        "{words} --phase-response --points 9 --derivatives {names}"
    ));
    for row in made["result"]["rows"].as_array().expect("rows") {
        assert_eq!(row["response_log_state_1"], row["response_log_state_2"]);
    }
    let found = &made["result"]["orbit"]["derivatives"];
    for of in [
        &found["period"],
        &found["maximum"]["stress"],
        &found["ln_abs"][0],
        &found["ln_abs"][1],
    ] {
        let slope = |name: &str| number(of, &format!("/{name}/value"));
        let bounds: f64 = [
            "residual_strength",
            "residual_strength_1",
            "residual_strength_2",
        ]
        .iter()
        .map(|name| number(of, &format!("/{name}/uncertainty")))
        .sum();
        let off = slope("residual_strength")
            - slope("residual_strength_1")
            - slope("residual_strength_2");
        assert!(off.abs() <= bounds, "{of}: {off} beyond {bounds}");
    }
}

#[test]
fn derivatives_of_interfaces_are_what_orbits_beside_differ_by() {
    /// Of the parameter.
    const PART: f64 = 1e-3;
    for (words, name, value) in [
        ("--driving 1", "stiffness", 0.02),
        (
            "--driving 0.5 --set residual_strength_2=0.002",
            "stiffness",
            0.02,
        ),
        (
            "--driving 1 --interfaces 3 --clusters 2,1 --start near-symmetric:0.1",
            "stiffness",
            0.02,
        ),
        (
            "--si --driving 1e-6 --interfaces 1 --healing-time 90",
            "stiffness",
            1e6,
        ),
    ] {
        let orbit = |value: f64, more: &str| {
            let made = object(&format!(
                "orbit {words} --{name} {value:e} --crosscheck none{more}"
            ));
            made["result"]["orbit"].clone()
        };
        let found = orbit(value, &format!(" --derivatives {name}"));
        let slope = |at: &str| {
            let beside = |step: f64| number(&orbit(value * (1.0 + step), ""), at);
            let over = |step: f64| (beside(step) - beside(-step)) / (2.0 * step * value);
            (4.0 * over(0.5 * PART) - over(PART)) / 3.0
        };
        let found = &found["derivatives"];
        for (at, found) in [
            ("/period/value", &found["period"]),
            ("/extremes/stress/max/value", &found["maximum"]["stress"]),
            ("/log_multipliers/0/ln_abs/value", &found["ln_abs"][0]),
        ] {
            let (known, slope) = (number(found, &format!("/{name}/value")), slope(at));
            let off = (known / slope - 1.0).abs();
            assert!(off < 1e-6, "{words}, {at}: {known} for {slope}");
        }
    }
}

#[test]
fn a_forced_orbit_has_derivatives_but_no_phase_of_its_own() {
    let path = file("derivatives-forced", FORCED);
    let made = object(&format!(
        "orbit --system {path} --derivatives delta,omega --crosscheck none"
    ));
    let period = &made["result"]["orbit"]["derivatives"]["period"];
    assert!(number(&period["delta"], "/value").abs() < 1e-13);
    within(
        &period["omega"],
        -std::f64::consts::TAU,
        1e-9,
        "the period of the forcing",
    );
    refused_in_one_line(
        &format!("orbit --system {path} --phase-response"),
        "under a periodic forcing no kick moves it",
    );
}

#[test]
fn rows_and_the_picture_have_the_responses() {
    let folder = folder("phase-response-rows");
    let picture = folder.join("response.svg").display().to_string();
    let made = twinslip(&format!(
        "orbit --system fitzhugh-nagumo --phase-response --points 11 --format csv --crosscheck none --plot {picture}"
    ));
    assert_eq!(made.code, 0, "{}", made.err);
    let rows = csv(&made.out);
    assert_eq!(rows.len(), 12);
    let text = std::fs::read_to_string(picture).expect("a picture");
    assert!(text.contains("response v") && text.contains("phase response"));
}

#[test]
fn a_parameter_that_there_is_not_is_refused_with_those_there_are() {
    refused_in_one_line(
        "orbit --system lorenz --derivatives foo",
        "no parameter `foo`; known are",
    );
}
