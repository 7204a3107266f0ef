//! What a fit may be, and what may be given beside it.

use crate::command::{folder, number, object, refused_in_one_line, twinslip};
use crate::common::ROOT;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use twinslip_tasks::scene::EnsembleFile;

fn data() -> PathBuf {
    Path::new(ROOT).join("tests/data/fit.json")
}

fn fit() -> String {
    data().display().to_string()
}

/// The fit of the file, changed.
fn changed(place: &Path, change: impl FnOnce(&mut Value)) -> String {
    let text = fs::read_to_string(data()).expect("written");
    let mut all: Value = serde_json::from_str(&text).expect("JSON");
    change(&mut all["result"]["fit"]);
    let path = place.join("fit.json");
    fs::write(&path, all.to_string()).expect("a place to write");
    path.display().to_string()
}

#[test]
fn what_is_given_holds_over_what_was_fixed() {
    let made = object(&format!(
        "law --points 2 --normal-stress 1e6 --ensemble {}:0",
        fit()
    ));
    assert_eq!(number(&made, "/model/normal_stress"), 1e6);
    let made = object(&format!(
        "law --points 2 --set healing_time=50 --ensemble {}:0",
        fit()
    ));
    assert_eq!(number(&made, "/model/healing_time"), 50.0);
}

#[test]
fn a_parameter_is_fitted_or_given_or_varies() {
    let fit = fit();
    let refused = |asked: &str, sentence: &str| {
        refused_in_one_line(&format!("{asked} --ensemble {fit}"), sentence);
    };
    refused("law --direct-effect 0.01", "--direct-effect is given");
    refused("law --set slip_length=1e-5", "--slip-length is given");
    refused(
        "branch equilibria --along slip_length --from 1e-6 --to 1e-5 --driving 1e-6 --stiffness 1e10",
        "--along slip_length",
    );
    refused(
        "sweep --driving 1e-6 --stiffness 1e10 --grid evolution_effect=0.01:0.02:3",
        "--grid evolution_effect",
    );
    refused("law --law slip", "is a fit of the law dieterich-ruina");
    refused("law --law spinodal", "is a fit of the law dieterich-ruina");
    refused(
        "locus hopf --resume nothing.csv",
        "cannot be resumed or split",
    );
    refused_in_one_line(
        &format!("sweep --driving 1e-6 --stiffness 1e10 --ensemble {fit}:0"),
        "need draws",
    );
    refused_in_one_line(
        &format!("law --ensemble {fit}:many"),
        "must be a whole number",
    );
    let ended = twinslip(&format!("equilibria --system lorenz --ensemble {fit}"));
    assert_eq!(ended.code, 2);
    assert!(ended.err.contains("cannot be used with"), "{}", ended.err);
}

#[test]
fn a_file_that_is_no_fit_is_refused() {
    let place = folder("ensemble-refused");
    let refused = |sentence: &str, change: &dyn Fn(&mut Value)| {
        let file = changed(&place, change);
        refused_in_one_line(&format!("law --ensemble {file}"), sentence);
    };
    refused("has 2 state variables", &|fit| fit["states"] = json!(2));
    refused("which is not built in", &|fit| {
        fit["law"] = json!("my.toml")
    });
    refused("must be positive", &|fit| {
        fit["parameters"][0]["value"] = json!(-0.01);
    });
    refused("the uncertainty of slip_length is null", &|fit| {
        fit["parameters"][2]["uncertainty"] = Value::Null;
    });
    refused("must be log or linear", &|fit| {
        fit["parameters"][1]["scale"] = json!("square");
    });
    refused("no parameter of an interface", &|fit| {
        fit["parameters"][1]["name"] = json!("colour");
    });
    refused(
        "the fit has direct_effect for each of several records",
        &|fit| {
            fit["parameters"][1]["name"] = json!("direct_effect");
        },
    );
    refused("6 rows of 6 numbers", &|fit| {
        fit["correlation"].as_array_mut().expect("rows").pop();
    });
    refused("must be between -1 and 1", &|fit| {
        fit["correlation"][0][1] = json!(1.5);
    });
    refused("of no distribution", &|fit| {
        for (i, j, x) in [(0, 1, 0.99), (1, 2, 0.99), (0, 2, -0.99)] {
            fit["correlation"][i][j] = json!(x);
            fit["correlation"][j][i] = json!(x);
        }
    });
    refused("no parameter of friction", &|fit| {
        for one in fit["parameters"].as_array_mut().expect("a list") {
            one["name"] = json!("stiffness");
        }
    });
    // What a law can't have, the command says.
    refused("direct-effect", &|fit| {
        fit["parameters"][0]["value"] = json!(-0.01);
        fit["parameters"][0]["scale"] = json!("linear");
    });
    let path = place.join("other.json");
    fs::write(&path, "{\"result\": {}}").expect("a place to write");
    let asked = format!("law --ensemble {}", path.display());
    refused_in_one_line(&asked, "not what twinslip fit writes as JSON");
    refused_in_one_line("law --ensemble nothing.json", "nothing.json");
}

#[test]
fn an_undecided_fit_is_warned_of() {
    let place = folder("ensemble-undecided");
    let file = changed(&place, |fit| fit["verdict"] = json!("undecided"));
    let ended = twinslip(&format!("law --points 2 --ensemble {file}:0"));
    assert_eq!(ended.code, 0);
    assert!(
        ended.err.starts_with("warning: the fit in "),
        "{}",
        ended.err
    );
}

#[test]
fn members_that_fail_are_counted() {
    let place = folder("ensemble-failed");
    // A fifth or so of all draws are negative, which no direct effect is.
    let file = changed(&place, |fit| {
        fit["parameters"][0]["scale"] = json!("linear");
        fit["parameters"][0]["uncertainty"] = json!(0.0101);
    });
    let ended = twinslip(&format!(
        "law --points 2 --ensemble {file}:100 --format json"
    ));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let ensemble = &made["result"]["ensemble"];
    let (failed, draws) = (number(ensemble, "/failed"), number(ensemble, "/draws"));
    assert_eq!(failed + draws, 100.0);
    // Phi(-1) = 0.159, with four standard errors.
    assert!((failed / 100.0 - 0.159).abs() < 4.0 * 0.0366, "{failed}");
    let told = format!("{failed} members failed, the first one as");
    assert!(ended.err.contains(&told), "{}", ended.err);
}

#[test]
fn a_number_of_draws_stands_behind_the_file() {
    let read = |text: &str| EnsembleFile::parse(text).expect("readable");
    let file = read("a/fit.json:50");
    assert_eq!(file.path, Path::new("a/fit.json"));
    assert_eq!(file.draws, Some(50));
    assert_eq!(read("fit.json:0").draws, Some(0));
    assert_eq!(read("fit.json").draws, None);
    assert_eq!(read("C:\\fit.json").path, Path::new("C:\\fit.json"));
    for wrong in ["fit.json:", "fit.json:-1", "fit.json:many", "fit.json:1e7"] {
        assert!(EnsembleFile::parse(wrong).is_err(), "{wrong}");
    }
}
