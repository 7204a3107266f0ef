//! The fields that scripts read, by name and type.

use crate::command;
use command::{csv, number, object, twinslip};
use serde_json::Value;

fn fields(value: &Value) -> Vec<&str> {
    value
        .as_object()
        .expect("an object")
        .keys()
        .map(String::as_str)
        .collect()
}

fn uncertain(value: &Value) {
    assert_eq!(fields(value), ["value", "uncertainty"]);
    assert!(value["value"].is_f64() && value["uncertainty"].as_f64().is_some_and(|u| u >= 0.0));
}

fn envelope(value: &Value, command: &str) {
    for field in [
        "twinslip", "command", "sundials", "model", "units", "numerics", "result", "work",
    ] {
        assert!(value.get(field).is_some(), "{field}");
    }
    assert_eq!(value["twinslip"], env!("CARGO_PKG_VERSION"));
    assert_eq!(value["command"][1], command);
    assert_eq!(value["sundials"].is_string(), cfg!(feature = "sundials"));
    assert_eq!(value["model"]["healing_time"], 100.0);
}

#[test]
fn law() {
    let made = object("law --points 11");
    envelope(&made, "law");
    let result = &made["result"];
    let extrema = result["extrema"].as_array().expect("a list");
    assert_eq!(extrema[0]["kind"], "maximum");
    assert_eq!(extrema[1]["kind"], "minimum");
    for extremum in extrema {
        uncertain(&extremum["slip_rate"]);
        uncertain(&extremum["stress"]);
    }
    let v_peak = number(&made, "/result/extrema/0/slip_rate/value");
    assert!((v_peak / 0.024931583134438452 - 1.0).abs() < 1e-13);
    uncertain(&result["critical_stiffness_maximum"]["slip_rate"]);
    uncertain(&result["critical_stiffness_maximum"]["stiffness"]);
    assert_eq!(result["transition_rate"], 1000.0);
    let rows = result["rows"].as_array().expect("a list");
    assert_eq!(rows.len(), 11);
    assert_eq!(
        fields(&rows[0]),
        [
            "slip_rate",
            "stress",
            "friction",
            "state",
            "critical_stiffness",
            "stress_uncertainty",
            "state_uncertainty"
        ]
    );
    assert_eq!(
        (&rows[0]["slip_rate"], &rows[10]["slip_rate"]),
        (&1e-3.into(), &1e6.into())
    );
    let ageing = object("law --law dieterich-ruina --points 2");
    assert_eq!(ageing["result"]["extrema"], serde_json::json!([]));
    assert!(ageing["result"]["critical_stiffness_maximum"].is_null());
    assert!(ageing["result"]["transition_rate"].is_null());
}

const ROW: [&str; 10] = [
    "time",
    "stress",
    "state_1",
    "state_2",
    "log_state_1",
    "log_state_2",
    "slip_rate_1",
    "slip_rate_2",
    "slip_1",
    "slip_2",
];

#[test]
fn integrate() {
    let made =
        object("integrate --driving 10 --stiffness 0.14 --until 12 --events --estimate-error");
    envelope(&made, "integrate");
    let rows = made["result"]["rows"].as_array().expect("a list");
    assert_eq!(fields(&rows[0]), ROW);
    assert!(
        rows.iter()
            .all(|row| row.as_object().unwrap().values().all(Value::is_number))
    );
    let last = &made["result"]["final"];
    assert_eq!(fields(last)[..10], ROW);
    assert!(
        last["error_estimate"]
            .as_f64()
            .is_some_and(|e| e > 0.0 && e < 1e-3)
    );
    for field in [
        "steps",
        "rejected",
        "rhs",
        "jacobians",
        "factorisations",
        "nonlinear",
    ] {
        assert!(made["work"][field].is_u64(), "{field}");
    }
    let events = made["result"]["events"].as_array().expect("a list");
    assert_eq!(
        fields(&events[0]),
        [
            "onset",
            "recurrence",
            "duration",
            "stress_drop",
            "peak_slip_rate",
            "slip_1",
            "slip_2",
            "leader"
        ]
    );
    assert!(events[0]["recurrence"].is_null() && events[1]["recurrence"].is_f64());
    assert!(events[0]["leader"] == 1 || events[0]["leader"] == 2);
    let plain = object("integrate --driving 10 --stiffness 0.14 --until 1");
    assert!(plain["result"].get("events").is_none());
    assert!(plain["result"]["final"]["error_estimate"].is_null());
    assert_eq!(plain["numerics"]["method"], "auto");
    assert_eq!(plain["numerics"]["atol"], 1e-8);
}

#[test]
fn equilibria() {
    let made = object("equilibria --driving 1000 --stiffness 0.45");
    envelope(&made, "equilibria");
    let list = made["result"]["equilibria"].as_array().expect("a list");
    assert_eq!(list.len(), 3);
    for one in list {
        uncertain(&one["stress"]);
        for field in ["state", "log_state", "slip_rate"] {
            assert_eq!(one[field].as_array().map(Vec::len), Some(2), "{field}");
            let bounds = &one[format!("{field}_uncertainty")];
            let bounds = bounds.as_array().expect("a list");
            assert!(bounds.len() == 2 && bounds.iter().all(|x| x.as_f64() > Some(0.0)));
        }
        let bounds = one["eigenvalue_uncertainty"].as_array().expect("a list");
        assert!(bounds.len() == 3 && bounds.iter().all(|x| x.as_f64() > Some(0.0)));
        let eigenvalues = one["eigenvalues"].as_array().expect("a list");
        assert_eq!(eigenvalues.len(), 3);
        assert!(
            eigenvalues
                .iter()
                .all(|z| z.as_array().is_some_and(|z| z.len() == 2))
        );
        assert!(one["residual"].is_f64());
    }
    let verdicts: Vec<&Value> = list.iter().map(|one| &one["verdict"]).collect();
    assert_eq!(verdicts, ["stable", "unstable", "stable"]);
    assert_eq!(list[2]["symmetry"], "symmetric");
    let bare = object("equilibria --driving 1000 --solver newton");
    assert!(bare["result"]["equilibria"][0]["eigenvalues"].is_null());
    assert!(bare["result"]["equilibria"][0]["verdict"].is_null());
}

#[test]
fn orbit() {
    let made = object("orbit --driving 1 --stiffness 0.14 --symmetry asymmetric");
    envelope(&made, "orbit");
    let orbit = &made["result"]["orbit"];
    for field in ["period", "stress_min", "stress_max"] {
        uncertain(&orbit[field]);
    }
    for field in [
        "slip_rate_max",
        "state_min",
        "trivial_defect",
        "liouville_defect",
    ] {
        assert!(orbit[field].is_f64(), "{field}");
    }
    assert_eq!(orbit["symmetry"], "asymmetric");
    assert_eq!(orbit["verdict"], "stable");
    assert_eq!(orbit["method"], "taylor");
    assert_eq!(orbit["point"].as_array().map(Vec::len), Some(3));
    let multipliers = orbit["multipliers"].as_array().expect("a list");
    assert_eq!(multipliers.len(), 3);
    assert_eq!(multipliers[0], serde_json::json!([1.0, 0.0]));
    let logs = orbit["log_multipliers"].as_array().expect("a list");
    assert_eq!(logs.len(), 2);
    for (one, mu) in logs.iter().zip(&multipliers[1..]) {
        uncertain(&one["ln_abs"]);
        assert_eq!(
            (&one["kind"], &one["angle_over_pi"]),
            (&"real".into(), &0.0.into())
        );
        let ratio = number(one, "/ln_abs/value").exp() / number(mu, "/0");
        assert!((ratio - 1.0).abs() < 1e-14);
    }
    let second = &orbit["crosscheck"];
    let method = if cfg!(feature = "sundials") {
        "cvode-adams"
    } else {
        "rodas5p"
    };
    assert_eq!(second["method"], method);
    assert!(number(second, "/period_difference").abs() < 1e-7);
    assert_eq!(
        second["ln_abs_difference"].as_array().map(Vec::len),
        Some(2)
    );
    assert_eq!(made["result"]["others"], serde_json::json!([]));
    // A pair: one above the real axis, one below.
    let pair =
        object("orbit --driving 0.07 --stiffness 0.14 --symmetry asymmetric --crosscheck none");
    let multipliers = &pair["result"]["orbit"]["multipliers"];
    assert_eq!(number(multipliers, "/1/1"), -number(multipliers, "/2/1"));
    assert!(number(multipliers, "/1/1") > 0.0);
    assert!(pair["result"]["orbit"]["crosscheck"].is_null());
    assert_eq!(
        pair["result"]["orbit"]["log_multipliers"][0]["kind"],
        "complex"
    );
    let single = object("orbit --interfaces 1 --driving 1 --stiffness 0.28");
    assert_eq!(
        single["result"]["orbit"]["multipliers"]
            .as_array()
            .map(Vec::len),
        Some(2)
    );
    let table =
        csv(&twinslip("orbit --driving 1 --stiffness 0.14 --crosscheck none --format csv").out);
    assert_eq!(table[0][..3], ["symmetry", "period", "period_uncertainty"]);
    assert_eq!(table[0].len(), table[1].len());
}

#[test]
fn an_orbit_that_is_none_fails_and_bad_input_is_refused() {
    for (arguments, code, said) in [
        (
            "orbit --driving 1000 --stiffness 0.14",
            1,
            "converges to an equilibrium",
        ),
        ("orbit --driving 1", 2, "--stiffness"),
        (
            "orbit --driving 1 --stiffness 0.14 --symmetry odd",
            2,
            "symmetry is odd",
        ),
        (
            "orbit --driving 1 --stiffness 0.14 --crosscheck taylor",
            2,
            "the method of the orbit itself",
        ),
        (
            "orbit --driving 1 --stiffness 0.14 --period-guess 3",
            2,
            "--start",
        ),
        ("orbit --driving 1 --stiffness 0.14 --rtol 0", 2, "rtol"),
        (
            "orbit --driving 1 --stiffness 0.14 --interfaces 1 --symmetry asymmetric",
            2,
            "single interface",
        ),
    ] {
        let ended = twinslip(arguments);
        assert_eq!(ended.code, code, "{arguments}: {}", ended.err);
        assert!(ended.err.contains(said), "{arguments}: {}", ended.err);
    }
}

#[test]
fn section() {
    let made = object(
        "section --driving 10 --stiffness 0.14 --start 9.9,0.9,1e-3 --skip 300 --returns 60 --lyapunov",
    );
    envelope(&made, "section");
    let result = &made["result"];
    let rows = result["rows"].as_array().expect("a list");
    assert_eq!(rows.len(), 60);
    assert_eq!(
        fields(&rows[0]),
        [
            "n",
            "time",
            "log_state_1",
            "log_state_2",
            "slip_rate_1",
            "slip_rate_2",
            "slip_rate_sum",
            "next_slip_rate_sum",
            "stress"
        ]
    );
    for pair in rows.windows(2) {
        assert_eq!(pair[0]["next_slip_rate_sum"], pair[1]["slip_rate_sum"]);
    }
    assert_eq!(result["regime"], "periodic");
    assert_eq!(result["period_of_orbit"], 1);
    uncertain(&result["period"]);
    assert!(result["rotation_number"].is_null());
    let exponents = result["lyapunov"].as_array().expect("a list");
    assert_eq!(exponents.len(), 3);
    exponents.iter().for_each(uncertain);
    assert_eq!(result["lyapunov_converged"], true);
    assert!(result["lyapunov_along_flow"].is_f64() && result["liouville_defect"].is_f64());
    // Without exponents there is no such field; where a torus is, there is a rotation number.
    let torus = object("section --driving 0.102 --stiffness 0.2 --returns 600");
    assert!(torus["result"].get("lyapunov").is_none());
    assert_eq!(torus["result"]["regime"], "torus");
    assert!(torus["result"]["period_of_orbit"].is_null());
    uncertain(&torus["result"]["rotation_number"]);
    let rest = object("section --driving 1000 --stiffness 0.14 --lyapunov");
    assert_eq!(rest["result"]["regime"], "steady");
    assert_eq!(rest["result"]["lyapunov"].as_array().map(Vec::len), Some(3));
    // In the symmetric subspace the orbit is stable; across it the largest exponent is positive.
    let symmetric = object(
        "section --driving 0.2 --stiffness 0.14 --start 11,0.3,0.3 --skip 50 --returns 60 --lyapunov",
    );
    assert_eq!(symmetric["result"]["regime"], "periodic");
    let multiplier = 43.7139146599523_f64;
    let period = 215.60668708;
    let across = number(&symmetric, "/result/lyapunov/0/value");
    assert!(
        (across / (multiplier.ln() / period) - 1.0).abs() < 1e-4,
        "{across}"
    );
    let one = object("section --interfaces 1 --driving 1 --stiffness 0.1 --skip 50 --returns 9");
    assert_eq!(
        fields(&one["result"]["rows"][0]),
        [
            "n",
            "time",
            "log_state_1",
            "slip_rate_1",
            "slip_rate_sum",
            "next_slip_rate_sum",
            "stress"
        ]
    );
    assert_eq!(one["result"]["regime"], "periodic");
}

/// The fields of special points of branches and curves.
fn specials(made: &Value) {
    let list = made["result"]["special"].as_array().expect("a list");
    assert!(!list.is_empty());
    for one in list {
        assert_eq!(
            fields(one)[..10],
            [
                "label",
                "name",
                "branch",
                "symmetry",
                "driving",
                "stiffness",
                "period",
                "criticality",
                "coefficient",
                "note"
            ]
        );
        uncertain(&one["driving"]);
        uncertain(&one["stiffness"]);
        if !one["period"].is_null() {
            uncertain(&one["period"]);
        }
        assert!(one["coefficient"].is_null() || one["coefficient"].is_f64());
    }
}

const BRANCH: [&str; 16] = [
    "driving",
    "stiffness",
    "stress",
    "stress_min",
    "stress_max",
    "period",
    "state_1",
    "state_2",
    "slip_rate_1",
    "slip_rate_2",
    "ln_abs_multiplier_1",
    "ln_abs_multiplier_2",
    "verdict",
    "label",
    "branch",
    "symmetry",
];

/// Branches of equilibria.
const GROWTH: [&str; 10] = [
    "eigenvalue_1_re",
    "eigenvalue_1_im",
    "eigenvalue_uncertainty_1",
    "eigenvalue_2_re",
    "eigenvalue_2_im",
    "eigenvalue_uncertainty_2",
    "eigenvalue_3_re",
    "eigenvalue_3_im",
    "eigenvalue_uncertainty_3",
    "unstable",
];

#[test]
fn branch() {
    let arguments = "branch equilibria --stiffness 0.14";
    let made = object(arguments);
    envelope(&made, "branch");
    specials(&made);
    assert_eq!(made["numerics"]["of"], "equilibria");
    assert_eq!(made["numerics"]["along"], "driving");
    assert_eq!(made["numerics"]["tolerance"], 1e-11);
    let rows = made["result"]["rows"].as_array().expect("a list");
    assert_eq!(fields(&rows[0]), [&BRANCH[..], &GROWTH].concat());
    assert!(rows.iter().all(|row| row["period"].is_null()));
    assert!(rows.iter().all(|row| row["branch"].is_u64()));
    let table = csv(&twinslip(&format!("{arguments} --format csv")).out);
    assert_eq!(table[0][..16], BRANCH);
    assert_eq!(table[0][16..26], GROWTH);
    assert_eq!(table[0][26..], ["row_check"]);
    assert_eq!(table.len() - 1, rows.len());
    for (line, row) in table[1..].iter().zip(rows) {
        assert_eq!(line[0].parse::<f64>().unwrap(), number(row, "/driving"));
        assert_eq!(line[12], row["verdict"].as_str().unwrap());
        assert_eq!(line[13], row["label"].as_str().unwrap_or_default());
    }
    let orbits =
        object("branch orbits --stiffness 0.14 --symmetry asymmetric --from 0.06 --to 0.07");
    specials(&orbits);
    let rows = orbits["result"]["rows"].as_array().expect("a list");
    assert_eq!(fields(&rows[0]), BRANCH);
    assert!(rows.iter().any(|row| row["period"].is_f64()
        && row["ln_abs_multiplier_1"].is_f64()
        && number(row, "/stress_min") < number(row, "/stress_max")));
}

#[test]
fn locus() {
    let arguments = "locus hopf --at-stiffness 0.14";
    let made = object(arguments);
    envelope(&made, "locus");
    specials(&made);
    assert_eq!(made["numerics"]["of"], "hopf");
    let rows = made["result"]["rows"].as_array().expect("a list");
    assert_eq!(
        fields(&rows[0]),
        [
            "driving",
            "stiffness",
            "period",
            "angle_over_pi",
            "criticality",
            "label",
            "curve",
            "symmetry"
        ]
    );
    for row in rows {
        uncertain(&row["driving"]);
        uncertain(&row["stiffness"]);
    }
    let table = csv(&twinslip(&format!("{arguments} --format csv")).out);
    assert_eq!(
        table[0],
        [
            "driving",
            "driving_uncertainty",
            "stiffness",
            "stiffness_uncertainty",
            "period",
            "angle_over_pi",
            "criticality",
            "label",
            "curve",
            "symmetry",
            "row_check"
        ]
    );
    assert_eq!(table.len() - 1, rows.len());
}

#[test]
fn an_undecided_verdict_has_its_own_exit_code() {
    // V_H = 2 V_M to the last digit: which side of the pitchfork it is on can't be told.
    let ended =
        twinslip("equilibria --driving 0.049863166268876906 --stiffness 0.45 --format json");
    assert_eq!(ended.code, 3, "{}{}", ended.out, ended.err);
    // A few returns of a torus: it may yet be anything.
    let ended = twinslip("section --driving 0.102 --stiffness 0.2 --returns 50 --format json");
    assert_eq!(ended.code, 3, "{}{}", ended.out, ended.err);
    assert!(ended.out.contains("\"regime\":\"undecided\"") && ended.err.contains("record more"));
}

#[test]
fn csv_holds_the_same_numbers_as_json() {
    let arguments = "integrate --driving 10 --stiffness 0.14 --until 12";
    let made = object(arguments);
    let rows = made["result"]["rows"].as_array().expect("a list");
    let table = csv(&twinslip(&format!("{arguments} --format csv")).out);
    assert_eq!(table[0], ROW);
    assert_eq!(table.len() - 1, rows.len());
    for (line, row) in table[1..].iter().zip(rows) {
        for (text, value) in line.iter().zip(row.as_object().unwrap().values()) {
            assert_eq!(text.parse::<f64>().unwrap(), value.as_f64().unwrap());
        }
    }
    let law = object("law --points 7");
    let table = csv(&twinslip("law --points 7 --format csv").out);
    for (line, row) in table[1..]
        .iter()
        .zip(law["result"]["rows"].as_array().unwrap())
    {
        let values: Vec<f64> = row
            .as_object()
            .unwrap()
            .values()
            .map(|x| x.as_f64().unwrap())
            .collect();
        assert_eq!(
            line.iter()
                .map(|x| x.parse().unwrap())
                .collect::<Vec<f64>>(),
            values
        );
    }
    let uncertain = csv(&twinslip("equilibria --driving 1000 --format csv").out);
    assert_eq!(uncertain[0][1..3], ["stress", "stress_uncertainty"]);
    let stable = csv(&twinslip("equilibria --driving 1000 --stiffness 1 --format csv").out);
    for name in [
        "log_state_uncertainty_2",
        "slip_rate_uncertainty_1",
        "eigenvalue_uncertainty_3",
    ] {
        let column = stable[0].iter().position(|x| x == name).expect("a column");
        assert!(
            stable[1..]
                .iter()
                .all(|row| row[column].parse::<f64>().is_ok())
        );
    }
}

#[test]
fn si_is_the_same_run_in_other_units() {
    // K = 0.14 a sigma/L and V_H = 10 V*, with L = 0.9 um, V* = 1 um/s, sigma = 2 MPa.
    let stiffness = 0.14 * 0.0349 * 2e6 / 0.9e-6;
    let si = object(&format!(
        "integrate --si --normal-stress 2e6 --driving 1e-5 --stiffness {stiffness} --until 10.8 --final-only --rtol 1e-10"
    ));
    let plain =
        object("integrate --driving 10 --stiffness 0.14 --until 12 --final-only --rtol 1e-10");
    let units = [
        ("time", 0.9),
        ("stress", 0.0349 * 2e6),
        ("state_1", 1.0),
        ("slip_rate_1", 1e-6),
        ("slip_1", 0.9e-6),
    ];
    for (name, unit) in units {
        let ratio = number(&si, &format!("/result/final/{name}"))
            / number(&plain, &format!("/result/final/{name}"));
        assert!((ratio / unit - 1.0).abs() < 1e-5, "{name}: {ratio}");
    }
    assert_eq!(si["units"]["stress"], "Pa");
    assert_eq!(plain["units"]["stress"], "a sigma");
    let healing = object("law --si --points 2");
    assert_eq!(healing["model"]["healing_time"], 90.0);
    let v_peak = number(&healing, "/result/extrema/0/slip_rate/value");
    assert!((v_peak / 2.4931583134438452e-8 - 1.0).abs() < 1e-13);
}
