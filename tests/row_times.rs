//! Rows at fixed times are at the times that were asked for, as they were asked for.

use super::command::{csv, object, twinslip};

const SI: &str =
    "integrate --si --law slip --interfaces 1 --driving 7e-7 --stiffness 1e10 --until 10";

fn times(words: &str) -> Vec<f64> {
    let made = object(words);
    let rows = made["result"]["rows"].as_array().expect("rows").clone();
    rows.iter()
        .map(|row| row["time"].as_f64().expect("a time"))
        .collect()
}

fn are(times: &[f64], parts: u32, of: f64) {
    // Integers divided once are the doubles nearest to the decimal fractions.
    let asked: Vec<f64> = (0..=parts).map(|i| f64::from(i) / of).collect();
    assert_eq!(times, asked);
}

#[test]
fn times_in_si_are_round() {
    are(&times(&format!("{SI} --every 1")), 10, 1.0);
    are(&times(&format!("{SI} --every 0.1")), 100, 10.0);
    are(&times(&format!("{SI} --points 101")), 100, 10.0);
    are(
        &times(&format!("{SI} --every 0.1 --method rodas5p")),
        100,
        10.0,
    );
    // Of other scales and units of time, too.
    are(
        &times(&format!(
            "{SI} --slip-length 1.7e-5 --reference-rate 3e-6 --every 0.1"
        )),
        100,
        10.0,
    );
    let years = "integrate --si --law slip --interfaces 1 --driving 7e-10 --stiffness 1e12 --until 1 --time-unit year";
    are(&times(&format!("{years} --every 0.01")), 100, 100.0);
    // In a table and in CSV.
    for row in &csv(&twinslip(&format!("{SI} --every 0.1 --format csv -q")).out)[1..] {
        assert!(row[0].len() <= 4, "{row:?}");
    }
    // Those of a program, on both sides of its changes.
    let program = times(&format!("{SI} --program 3:1e-6,7:3e-7 --every 0.7"));
    for asked in [0.7, 2.1, 3.0, 4.9, 6.3, 7.0, 9.1, 10.0] {
        assert!(
            program.contains(&asked) || asked == 10.0,
            "{asked}: {program:?}"
        );
    }
}

#[test]
fn times_without_units_are_round() {
    are(
        &times(
            "integrate --law slip --interfaces 1 --driving 1 --stiffness 1.1 --until 1 --every 0.1",
        ),
        10,
        10.0,
    );
    are(
        &times("integrate --system lorenz --until 1 --every 0.1"),
        10,
        10.0,
    );
    let many = "integrate --interfaces 20 --driving 0.1 --stiffness 0.2 --start spread:0.5 --until 1 --draw residual_strength=8e-4:1.2e-3";
    are(&times(&format!("{many} --every 0.1")), 10, 10.0);
    // What is no decimal fraction is a multiple.
    let third = 1.0 / 3.0;
    let made = times(&format!(
        "integrate --system lorenz --until 1 --every {third}"
    ));
    assert_eq!(made, [0.0, third, 2.0 * third, 1.0]);
}
