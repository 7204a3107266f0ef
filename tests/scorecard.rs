//! The scorecard: its rule, and its numbers against references of twenty and more digits.

use crate::common;
use common::{data, number, relative};
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;
use twinslip::number::Uncertain;
use twinslip_output::Cell;
use twinslip_paper::Pieces;
use twinslip_paper::scorecard::{
    Agreement, Answer, Entry, compare, difference, entries, json, table1,
};

static STOP: AtomicBool = AtomicBool::new(false);

fn pieces() -> &'static Pieces<'static> {
    static PIECES: OnceLock<Pieces<'static>> = OnceLock::new();
    PIECES.get_or_init(|| Pieces::new(&STOP))
}

fn all() -> &'static [Entry] {
    static ENTRIES: OnceLock<Vec<Entry>> = OnceLock::new();
    ENTRIES.get_or_init(|| entries(pieces()).expect("entries"))
}

fn entry(id: &str) -> &'static Entry {
    let found = all().iter().find(|entry| entry.id == id);
    found.unwrap_or_else(|| panic!("no {id}"))
}

fn value(answer: &Answer) -> Uncertain {
    match answer {
        Answer::Number(x) => *x,
        Answer::Word(word) => panic!("{word} is no number"),
    }
}

fn verdict(printed: &str, value: f64) -> Agreement {
    compare(printed, &Answer::Number(Uncertain::new(value, 0.0))).0
}

#[test]
fn a_number_agrees_if_it_rounds_to_the_printed_one() {
    for (printed, value, agrees) in [
        ("0.0767", 0.07674, true),
        ("0.0767", 0.07676, false),
        ("0.1000", 0.1000265, true),
        ("0.1000", 0.10006, false),
        ("4.30e4", 42982.86, true),
        ("4.30e4", 42949.0, false),
        ("4.440e4", 44402.5, true),
        ("4.440e4", 44406.0, false),
        ("2.49e-8", 2.4929e-8, true),
        ("2.49e-8", 2.496e-8, false),
        ("405.16", 405.1576, true),
        ("405.16", 405.1127, false),
        ("-1.0027", -1.00277, false),
        ("-1.0027", -1.00274, true),
        ("10.7", 10.5731, false),
        ("3", 3.4, true),
        ("3", 3.6, false),
    ] {
        let expected = if agrees {
            Agreement::Agrees
        } else {
            Agreement::Differs
        };
        assert_eq!(verdict(printed, value), expected, "{printed} and {value}");
    }
}

#[test]
fn what_is_printed_of_a_number_agrees_with_it_and_with_no_other() {
    // Numbers of all sizes, written with two to six digits as the paper might.
    for i in 0..2000_i32 {
        let x = 10_f64.powf(f64::from(i) * 0.004 - 4.0) * if i % 2 == 0 { 1.0 } else { -1.0 };
        for digits in 1..6 {
            let printed = format!("{x:.digits$e}");
            assert_eq!(verdict(&printed, x), Agreement::Agrees, "{printed} and {x}");
            let power: i32 = printed.split_once('e').expect("a power").1.parse().unwrap();
            let unit = 10_f64.powi(power - digits as i32);
            let printed_value: f64 = printed.parse().unwrap();
            for off in [-0.6 * unit, 0.6 * unit] {
                let other = printed_value + off;
                assert_eq!(verdict(&printed, other), Agreement::Differs, "{printed}");
            }
            for off in [-0.4 * unit, 0.4 * unit] {
                let other = printed_value + off;
                assert_eq!(verdict(&printed, other), Agreement::Agrees, "{printed}");
            }
        }
    }
}

#[test]
fn a_bound_agrees_if_it_is_right_and_tight() {
    for (printed, value, agrees) in [
        ("< 0.2", 0.19685, true),
        ("< 0.2", 0.1001, true),
        ("< 0.2", 0.0999, false),
        ("< 0.2", 0.26, false),
        ("< 0.216", 0.215653, true),
        ("< 0.135", 0.134253, true),
        ("< 0.135", 0.1339, false),
        ("< 0.135", 0.1356, false),
        ("> 0.135", 0.1356, true),
        ("> 0.135", 0.1339, false),
        ("> 0.135", 0.137, false),
    ] {
        let agreed = verdict(printed, value) == Agreement::Agrees;
        assert_eq!(agreed, agrees, "{printed} and {value}");
    }
}

#[test]
fn a_number_with_its_logarithm_is_one_fact() {
    for (printed, value, agrees, off) in [
        ("0.0552 (log10: -1.2582)", 0.05518, true, 0.0),
        // The logarithm is wrong by a unit of its last digit, which the number does not show, and the other way round.
        ("0.0552 (log10: -1.2581)", 0.05518, false, 2.3e-4),
        ("0.0553 (log10: -1.2582)", 0.05518, false, 0.0),
        ("0.0821 (log10: -1.0859)", 0.0799, false, 0.02696),
    ] {
        let agreed = verdict(printed, value) == Agreement::Agrees;
        assert_eq!(agreed, agrees, "{printed} and {value}");
        let computed = Answer::Number(Uncertain::new(value, 0.0));
        let found = difference(printed, &computed).expect("a number");
        assert!((found - off).abs() < 1e-4, "{printed}: {found}");
    }
}

#[test]
fn differences_are_parts_of_the_computed_value() {
    let of = |printed: &str, value: f64| {
        difference(printed, &Answer::Number(Uncertain::new(value, 0.0)))
    };
    assert_eq!(of("1.5", 1.0), Some(0.5));
    assert_eq!(of("-0.5", -1.0), Some(-0.5));
    assert_eq!(of("< 0.2", 0.25), Some(0.2_f64 / 0.25 - 1.0));
    assert_eq!(of("> 3", 2.0), Some(0.5));
    assert_eq!(of("1", 0.0), None, "nothing is a part of zero");
    assert_eq!(of("stable", 1.0), None);
    assert_eq!(difference("stable", &Answer::Word("unstable")), None);
}

#[test]
fn the_uncertainty_decides_nothing_but_is_told() {
    for (value, uncertainty, agrees, decided) in [
        (0.07674, 1e-6, true, true),
        (0.07674, 1e-4, true, false),
        (0.07676, 1e-4, false, false),
        (0.07676, 1e-6, false, true),
        (0.07674, f64::INFINITY, true, false),
    ] {
        let computed = Answer::Number(Uncertain::new(value, uncertainty));
        let (verdict, is_decided) = compare("0.0767", &computed);
        assert_eq!(verdict == Agreement::Agrees, agrees);
        assert_eq!(is_decided, decided, "{value} +- {uncertainty}");
    }
}

#[test]
fn a_claim_agrees_if_the_words_are_the_same() {
    let compared = |word| compare("supercritical", &Answer::Word(word)).0;
    assert_eq!(compared("supercritical"), Agreement::Agrees);
    assert_eq!(compared("subcritical"), Agreement::Differs);
    // A number can't be held against a word.
    assert_eq!(verdict("supercritical", 1.0), Agreement::Differs);
    assert_eq!(compare("0.2", &Answer::Word("0.20")).0, Agreement::Differs);
}

#[test]
fn there_are_enough_entries_and_each_is_whole() {
    let entries = all();
    assert!((50..=70).contains(&entries.len()), "{}", entries.len());
    let ids: BTreeSet<&str> = entries.iter().map(|entry| entry.id).collect();
    assert_eq!(ids.len(), entries.len());
    for entry in entries {
        let id = entry.id;
        for text in [id, entry.place, entry.quantity, entry.printed] {
            assert!(!text.trim().is_empty(), "{id}");
        }
        match &entry.computed {
            Answer::Number(x) => {
                assert!(x.value.is_finite() && x.uncertainty.is_finite(), "{id}");
                assert!(x.uncertainty < 1e-9 * x.value.abs(), "{id}: {x:?}");
                // Every number has a second method, and that agrees within both uncertainties.
                let second = entry.second.as_ref().unwrap_or_else(|| panic!("{id}"));
                let other = value(&second.value);
                let apart = (x.value - other.value).abs();
                assert!(
                    apart <= x.uncertainty + other.uncertainty,
                    "{id}: {other:?}"
                );
                assert!(apart < 1e-8 * x.value.abs(), "{id}: {apart:e}");
            }
            Answer::Word(word) => {
                assert!(!word.is_empty(), "{id}");
                if let Some(second) = &entry.second {
                    assert_eq!(second.value, entry.computed, "{id}");
                }
                assert!(entry.second.is_some() || !entry.note.is_empty(), "{id}");
            }
        }
    }
}

#[test]
fn verdicts_are_those_of_the_rule() {
    let of = |verdict: Agreement| -> BTreeSet<&str> {
        let these = all().iter().filter(|entry| entry.verdict == verdict);
        these.map(|entry| entry.id).collect()
    };
    for entry in all() {
        let (by_rule, decided) = compare(entry.printed, &entry.computed);
        let expected = match entry.verdict {
            // Evidence turns a difference into a misprint and nothing else.
            Agreement::Misprint => Agreement::Differs,
            other => other,
        };
        assert_eq!(by_rule, expected, "{}", entry.id);
        assert!(decided, "{}", entry.id);
        let reason = entry.note.contains("misprint: ");
        assert_eq!(reason, entry.verdict == Agreement::Misprint, "{}", entry.id);
    }
    let misprints = [
        "frequency-at-onset",
        "stress-of-fig-3",
        "PD-first",
        "PD-last",
    ];
    assert_eq!(of(Agreement::Misprint), BTreeSet::from(misprints));
    let table = all().iter().filter(|entry| entry.id.starts_with("1:"));
    let table: BTreeSet<&str> = table.map(|entry| entry.id).collect();
    // V_H is printed twice, as a number and as its logarithm, and counted once.
    assert_eq!(table.len(), 10);
    let mut differ: BTreeSet<&str> = table;
    assert!(differ.remove("1:2-K"));
    // Where only the last digit of the logarithm is wrong, that is said: 0.02 % is not 4 %.
    let off = |id: &str| {
        let entry = entry(id);
        difference(entry.printed, &entry.computed).expect("a number")
    };
    assert!((off("1:2-V_H") - 1.6e-4).abs() < 1e-5, "{}", off("1:2-V_H"));
    assert!((off("1:4-first-K").abs() - 0.0438).abs() < 1e-4);
    differ.extend([
        "steeper-strengthening",
        "sum-of-rates",
        "V_m",
        "stress-at-V_sn",
        "slow-interface-below-V_M",
        "torus-at-0.14",
        "roots-of-42",
    ]);
    assert_eq!(of(Agreement::Differs), differ);
}

/// Within what is claimed, up to the rounding of the reference to a double; what is given to fewer digits, within these.
#[track_caller]
fn assert_known(id: &str, exact: f64, digits: f64) {
    let found = value(&entry(id).computed);
    let error = (found.value - exact).abs();
    let slack = 0.5 * f64::EPSILON * exact.abs() + digits;
    assert!(
        error <= found.uncertainty + slack,
        "{id}: {found:?} is off by {error:e} from {exact}"
    );
}

#[test]
fn numbers_of_the_laws_are_the_known_ones() {
    let known = &data("steady_states.json")["constants"];
    for (id, name) in [
        ("V_M-of-law-6", "law6_V_M_m_per_s"),
        ("mu-maximum-of-law-6", "law6_mu_ss(V_M)"),
        ("stress-of-fig-3", "DR_tau_ss(1)"),
        ("K_c", "K_c_DR"),
        ("V_M", "V_M"),
        ("V_m", "V_m"),
        ("V_m-approximate", "V_m_approx_paper"),
        ("mu-maximum", "law35_mu_ss(V_M)"),
        ("V_sn", "V_sn_fold"),
        ("V_sn-approximate", "V_sn_approx_paper"),
        ("largest-K-of-symmetric-hopf", "max_k_c_sym(=half)"),
    ] {
        let exact = number(&known[name]);
        assert_known(id, exact, 0.0);
        // The second method has digits of its own.
        let second = entry(id).second.as_ref().expect("a second method");
        let other = value(&second.value);
        let apart = (other.value - exact).abs();
        assert!(
            apart <= other.uncertainty + 0.5 * f64::EPSILON * exact,
            "{id}"
        );
    }
}

#[test]
fn numbers_of_orbits_are_the_known_ones() {
    let known = data("orbit_bifurcations.json");
    assert_known("largest-K-of-torus", number(&known["TR_top"]["K"]), 0.0);
    // By an independent computation to so many digits.
    assert_known("largest-K-of-orbit-pitchforks", 0.134253359245, 5e-13);
    let names = ["1:4-first", "1:4-second", "1:4-third", "1:3", "1:2"];
    let points = known["resonances"].as_array().expect("points");
    for (name, point) in names.iter().zip(points) {
        let of = |key: &str| number(&point[key]);
        assert_known(&format!("{name}-V_H"), of("V_H"), 0.0);
        assert_known(&format!("{name}-K"), of("K"), 0.0);
        // Of the logarithm the table has the reference.
        let logarithm = of("log10V_H");
        let driving = value(&entry(&format!("{name}-V_H")).computed).value;
        assert!((driving.log10() - logarithm).abs() < 1e-13, "{name}");
    }
    assert_known("K-of-1:2-in-the-text", number(&points[4]["K"]), 0.0);
    for point in known["K=0.14"].as_array().expect("points") {
        let exact = number(&point["V_H"]);
        let name = point["type"].as_str().expect("a name");
        let which = if exact < 0.09 { "first" } else { "last" };
        assert_known(&format!("{name}-{which}"), exact, 0.0);
    }
}

#[test]
fn the_file_has_what_was_agreed() {
    let file = json(all());
    let listed = file["entries"].as_array().expect("a list");
    assert_eq!(listed.len(), all().len());
    for (object, entry) in listed.iter().zip(all()) {
        for key in [
            "id", "where", "quantity", "unit", "printed", "verdict", "note",
        ] {
            assert!(object[key].is_string(), "{}: {key}", entry.id);
        }
        let sized = matches!(entry.computed, Answer::Number(_));
        assert_eq!(
            object["relative_difference"].is_f64(),
            sized,
            "{}",
            entry.id
        );
        let verdicts = ["agrees", "differs", "misprint"];
        assert!(verdicts.contains(&object["verdict"].as_str().unwrap()));
        let answers = [&object["computed"], &object["second"]["computed"]];
        for (i, answer) in answers.into_iter().enumerate() {
            let known = match answer {
                Value::Object(x) => x["value"].is_f64() && x["uncertainty"].is_f64(),
                Value::String(word) => !word.is_empty(),
                Value::Null => i == 1 && entry.second.is_none(),
                _ => false,
            };
            assert!(known, "{}: {answer}", entry.id);
        }
    }
    let counted: u64 = ["agrees", "differs", "misprint"]
        .iter()
        .map(|key| file[key].as_u64().expect("a count"))
        .sum();
    assert_eq!(counted as usize, listed.len());
}

#[test]
fn table_1_has_both_methods_beside_what_is_printed() {
    let made = table1(pieces()).expect("the table");
    let part = &made.sheet.parts[0];
    assert_eq!(part.rows.len(), 15);
    let at = |name: &str| part.columns.iter().position(|column| column == name);
    let [computed, second, off] = ["computed", "second_method", "relative_difference"]
        .map(|name| at(name).unwrap_or_else(|| panic!("no column {name}")));
    let cell = |row: &[Cell], i: usize| match row[i] {
        Cell::Number(x) => x,
        _ => panic!("no number"),
    };
    let mut largest: f64 = 0.0;
    for row in &part.rows {
        assert_eq!(row.len(), part.columns.len());
        assert!(relative(cell(row, second), cell(row, computed)) < 1e-8);
        largest = largest.max(cell(row, off).abs());
    }
    // The first K of the resonance 1:4 is printed 4.4 % off.
    assert!((largest - 0.0438).abs() < 1e-4, "{largest}");
}
