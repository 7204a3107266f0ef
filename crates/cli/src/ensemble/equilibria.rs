//! Bands of steady states.

use super::added::{Added, put_band};
use super::bands::{Band, Banded};
use super::item::{Item, Measured};
use super::member::Yield;
use super::picture::PointAt;
use super::{percent, told};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// What there is one of for each interface, cluster or eigenvalue.
const LISTS: [&str; 3] = ["state", "log_state", "slip_rate"];

/// The columns that get bands.
fn columns(found: &Yield) -> Vec<String> {
    let numbered = |name: &str, base: &str| {
        let rest = name
            .strip_prefix(base)
            .and_then(|rest| rest.strip_prefix('_'));
        rest.is_some_and(|rest| rest.bytes().all(|byte| byte.is_ascii_digit()))
    };
    let of_eigenvalue = |name: &str| {
        name.starts_with("eigenvalue_") && (name.ends_with("_re") || name.ends_with("_im"))
    };
    let wanted = |name: &&String| {
        *name == "stress" || of_eigenvalue(name) || LISTS.iter().any(|base| numbered(name, base))
    };
    found.columns.iter().filter(wanted).cloned().collect()
}

/// Each steady state, by its symmetry and its place among those by stress.
pub fn items(found: &Yield) -> Vec<Item> {
    let columns = columns(found);
    // Of a single interface no state is symmetric.
    let single = found.object["model"]["interfaces"] == 1;
    let item = |row: &Vec<twinslip_output::Cell>| {
        let numbers = columns.iter().map(|name| {
            let value = found.number(row, name);
            match name.starts_with("state_") || name.starts_with("slip_rate_") {
                true => Measured::log(name, value),
                false => Measured::linear(name, value),
            }
        });
        Item {
            class: match single {
                true => "steady state".to_owned(),
                false => format!("{} steady state", found.word(row, "symmetry")),
            },
            place: vec![-found.number(row, "stress")],
            numbers: numbers.collect(),
            holds: found.word(row, "verdict") == "stable",
        }
    };
    found.rows.iter().map(item).collect()
}

/// The steady states where a picture shows them, each with the band of its stress.
pub fn points(items: &[Item], banded: &[Banded]) -> Vec<PointAt> {
    let pairs = items.iter().zip(banded);
    let point = |(item, known): (&Item, &Banded)| {
        // The stress is the first of the columns.
        let (stress, band) = (item.numbers.first()?, known.bands.first()?);
        Some(PointAt {
            x: stress.value,
            y: None,
            along: band.linear,
            across: None,
        })
    };
    pairs.filter_map(point).collect()
}

/// How many draws have how many steady states, as parts of all.
pub fn counts(numbers: &[usize]) -> Map<String, Value> {
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    for &number in numbers {
        *counts.entry(number).or_default() += 1;
    }
    let part = |count: usize| json!(count as f64 / numbers.len() as f64);
    counts
        .into_iter()
        .map(|(number, count)| (number.to_string(), part(count)))
        .collect()
}

/// What is added to rows, and put into the object; and the steady states in words.
pub fn finish(estimate: &mut Yield, items: &[Item], banded: &[Banded]) -> (Added, Vec<String>) {
    let names = columns(estimate);
    let rows: Vec<Option<&Banded>> = banded.iter().map(Some).collect();
    let stability = names.iter().any(|name| name.starts_with("eigenvalue_"));
    let mut added = Added::bands(estimate, &names, &rows)
        .with("probability", banded.iter().map(|one| one.probability));
    if stability {
        added = added.with("probability_stable", banded.iter().map(|one| one.holds));
    }
    let list = estimate.object["result"]["equilibria"].as_array_mut();
    for (object, known) in list.into_iter().flatten().zip(banded) {
        let Some(object) = object.as_object_mut() else {
            continue;
        };
        let bands: BTreeMap<&str, Band> = names
            .iter()
            .map(String::as_str)
            .zip(known.bands.iter().copied())
            .collect();
        if let Some(band) = bands.get("stress") {
            put_band(object, "stress", band);
        }
        // A steady state of several interfaces may have fewer clusters than there are columns.
        let length = |list: &str| object[list].as_array().map_or(0, Vec::len);
        let (states, eigenvalues) = (length("state"), length("eigenvalues"));
        for (end, of) in ENDS {
            for base in LISTS {
                let each = (1..=states).map_while(|i| bands.get(format!("{base}_{i}").as_str()));
                let each: Vec<Value> = each.map(|band| json!(of(band))).collect();
                object.insert(format!("{base}_{end}"), json!(each));
            }
            let part = |i: usize, part: &str| {
                let band = bands.get(format!("eigenvalue_{i}_{part}").as_str());
                band.copied().map(|band| of(&band))
            };
            let pairs = (1..=eigenvalues).map_while(|i| Some([part(i, "re")?, part(i, "im")?]));
            let pairs: Vec<[Option<f64>; 2]> = pairs.collect();
            if stability {
                object.insert(format!("eigenvalues_{end}"), json!(pairs));
            }
        }
        object.insert("probability".into(), json!(known.probability));
        if stability {
            object.insert("probability_stable".into(), json!(known.holds));
        }
    }
    let lines = items.iter().zip(banded).map(|(item, known)| {
        let mut shown = item.clone();
        // The others are in the rows.
        shown.numbers.truncate(1);
        let stable = known
            .holds
            .filter(|_| stability)
            .map_or(String::new(), |part| {
                format!(", stable in {}", percent(part))
            });
        format!("{}{stable}", told(&shown, known))
    });
    (added, lines.collect())
}

/// An end of a band, where it has one.
type End = fn(&Band) -> Option<f64>;

/// The ends of a band by derivatives, and by draws.
const ENDS: [(&str, End); 4] = [
    ("lower", |band| band.linear.map(|ends| ends[0])),
    ("upper", |band| band.linear.map(|ends| ends[1])),
    ("draws_lower", |band| band.draws.map(|ends| ends[0])),
    ("draws_upper", |band| band.draws.map(|ends| ends[1])),
];
