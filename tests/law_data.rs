//! `law --data`: measured friction beside the law.

use super::command::{folder, number, object, refused_in_one_line, twinslip};
use std::fs;

#[test]
fn measured_friction_stands_beside_the_law() {
    let folder = folder("law_data");
    // The law itself at three rates, off by a known difference.
    let law = object("law --from 0.01 --to 100 --points 3");
    let rows = law["result"]["rows"].as_array().expect("rows");
    let of = |name: &str, i: usize| rows[i][name].as_f64().expect("a number");
    let table = |head: &str, rate: f64| {
        let rows = [2, 0, 1].map(|i| {
            format!(
                "{},{},0.003\n",
                of("slip_rate", i) * rate,
                of("friction", i) + 0.002
            )
        });
        head.to_owned() + &rows.concat()
    };
    let plain = folder.join("plain.csv");
    let picture = folder.join("law.svg");
    fs::write(&plain, table("Slip rate,mu,mu_error\n", 1.0)).expect("a file");
    let made = object(&format!(
        "law --data {} --plot {}",
        plain.display(),
        picture.display()
    ));
    let data = made["result"]["data"].as_array().expect("a list");
    assert_eq!(data.len(), 3);
    for (i, one) in data.iter().enumerate() {
        assert!(
            (number(one, "/rate") / of("slip_rate", i) - 1.0).abs() < 1e-12,
            "{one}"
        );
        assert!(
            (number(one, "/friction") - number(one, "/law") - 0.002).abs() < 1e-9,
            "{one}"
        );
        assert!((number(one, "/uncertainty") - 0.003).abs() < 1e-12);
    }
    assert!(
        fs::read_to_string(&picture)
            .expect("a picture")
            .contains("measured")
    );
    // In SI, rates in a unit of theirs; V* is 1 um/s.
    let si = folder.join("si.csv");
    fs::write(
        &si,
        table("velocity (um/s);friction;uncertainty\n", 1.0).replace(',', ";"),
    )
    .expect("a file");
    let words = "--si --reference-rate 1e-6 --slip-length 1e-5 --normal-stress 5e6";
    let ended = twinslip(&format!(
        "law --data {} {words} --format json",
        si.display()
    ));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let made: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
    let first = &made["result"]["data"][0];
    assert!(
        (number(first, "/rate") / (of("slip_rate", 0) * 1e-6) - 1.0).abs() < 1e-9,
        "{first}"
    );
    assert!(
        (number(first, "/friction") - number(first, "/law") - 0.002).abs() < 1e-9,
        "{first}"
    );
    // Without --si a rate in um/s has no place on the axis.
    refused_in_one_line(
        &format!("law --data {}", si.display()),
        "the slip rates are in um/s, but the law is dimensionless; give --si",
    );
    let none = folder.join("none.csv");
    fs::write(&none, "time,friction\n1,0.6\n2,0.6\n").expect("a file");
    refused_in_one_line(
        &format!("law --data {}", none.display()),
        "which column is the slip rate?",
    );
    let zero = folder.join("zero.csv");
    fs::write(&zero, "rate,friction\n1,0.6\n0,0.6\n").expect("a file");
    refused_in_one_line(&format!("law --data {}", zero.display()), "zero.csv:3: ");
    let ended = twinslip(&format!("law --data {}", plain.display()));
    assert!(ended.err.contains("measured friction at 3 slip rates differs from the law by 0.00200 (root mean square); 3 are within their uncertainty"), "{}", ended.err);
}
