//! Bands of a friction law.

use super::added::{Added, put_band};
use super::bands::{Band, Banded};
use super::item::{Item, Measured};
use super::member::Yield;
use super::picture::{BandsAt, PointAt};
use super::told;
use serde_json::Value;

/// The columns that get bands.
const COLUMNS: [&str; 4] = ["stress", "friction", "critical_stiffness", "state"];

/// Rows, then what the law is known by.
pub fn items(found: &Yield) -> Vec<Item> {
    let rows = found.rows.iter().enumerate().map(|(i, row)| Item {
        class: format!("row {i}"),
        place: vec![],
        numbers: COLUMNS
            .map(|name| {
                let value = found.number(row, name);
                match name {
                    "state" => Measured::log(name, value),
                    _ => Measured::linear(name, value),
                }
            })
            .into(),
        holds: false,
    });
    let mut all: Vec<Item> = rows.collect();
    all.extend(
        landmarks(&found.object["result"])
            .into_iter()
            .map(|(_, item)| item),
    );
    all
}

/// Where a landmark is in the result.
#[derive(Debug, Clone, PartialEq)]
enum At {
    /// In a list.
    Listed(&'static str, usize),
    /// The only one.
    Single(&'static str),
}

/// All landmarks of one or two laws.
fn landmarks(result: &Value) -> Vec<(At, Item)> {
    let mut all = Vec::new();
    for list in ["extrema", "critical_stiffness_maxima", "transition_rates"] {
        let found = result[list].as_array().into_iter().flatten();
        let placed = found.enumerate();
        all.extend(placed.map(|(i, one)| (At::Listed(list, i), landmark(list, one))));
    }
    for single in ["critical_stiffness_maximum", "transition_rate"] {
        if !result[single].is_null() {
            all.push((At::Single(single), landmark(single, &result[single])));
        }
    }
    all
}

fn landmark(list: &str, one: &Value) -> Item {
    let value = |name: &str| {
        let number = |x: &Value| x.as_f64().or_else(|| x["value"].as_f64());
        number(&one[name]).unwrap_or(f64::NAN)
    };
    let rate = match one.as_f64() {
        Some(rate) => rate,
        None => value("slip_rate"),
    };
    let mut numbers = vec![Measured::log("slip_rate", rate)];
    if !one["stress"].is_null() {
        numbers.push(Measured::linear("stress", value("stress")));
    }
    if !one["stiffness"].is_null() {
        numbers.push(Measured::log("stiffness", value("stiffness")));
    }
    let words = match list {
        "extrema" => format!("{} of stress", one["kind"].as_str().unwrap_or_default()),
        "critical_stiffness_maxima" | "critical_stiffness_maximum" => {
            "maximum of critical_stiffness".to_owned()
        }
        _ => "high-velocity strengthening".to_owned(),
    };
    let whose = one["interface"]
        .as_u64()
        .map_or(String::new(), |number| format!("interface {number}: "));
    Item {
        class: format!("{whose}{words}"),
        place: vec![rate.ln()],
        numbers,
        holds: false,
    }
}

/// What is added to rows, and put into the object; and the landmarks in words.
pub fn finish(estimate: &mut Yield, items: &[Item], banded: &[Banded]) -> (Added, Vec<String>) {
    let (of_rows, of_landmarks) = banded.split_at(estimate.rows.len());
    let rows: Vec<Option<&Banded>> = of_rows.iter().map(Some).collect();
    let added = Added::bands(estimate, &COLUMNS.map(str::to_owned), &rows);
    let result = &mut estimate.object["result"];
    added.put_into(&mut result["rows"]);
    let landmarks = landmarks(result);
    for ((at, item), known) in landmarks.iter().zip(of_landmarks) {
        let object = match at {
            At::Listed(list, i) => result[*list][*i].as_object_mut(),
            At::Single("transition_rate") => {
                let object = result.as_object_mut();
                if let Some(object) = object {
                    put_band(object, "transition_rate", &known.bands[0]);
                    object.insert(
                        "transition_rate_probability".into(),
                        known.probability.into(),
                    );
                }
                None
            }
            At::Single(single) => result[*single].as_object_mut(),
        };
        let Some(object) = object else { continue };
        for (number, band) in item.numbers.iter().zip(&known.bands) {
            put_band(object, &number.name, band);
        }
        object.insert("probability".into(), known.probability.into());
    }
    let found = &items[estimate.rows.len()..];
    let lines = found.iter().zip(of_landmarks);
    (
        added,
        lines.map(|(item, known)| told(item, known)).collect(),
    )
}

/// Where a picture shows the rows, with their bands.
pub fn shown(estimate: &Yield, banded: &[Banded]) -> BandsAt {
    let mut at = BandsAt::default();
    for (row, known) in estimate.rows.iter().zip(banded) {
        let rate = estimate.number(row, "slip_rate");
        for (name, band) in COLUMNS.iter().zip(&known.bands) {
            if let Some(ends) = band.linear {
                at.put(rate, estimate.number(row, name), ends);
            }
        }
    }
    at
}

/// Where a picture shows the landmarks: the stress of extrema, or its coefficient of friction, and critical stiffnesses.
pub fn points(estimate: &Yield, items: &[Item], banded: &[Banded]) -> Vec<PointAt> {
    let rows = estimate.rows.len();
    let first = estimate.rows.first();
    let coefficient = first.map_or(f64::NAN, |row| {
        estimate.number(row, "friction") / estimate.number(row, "stress")
    });
    let found = items[rows..].iter().zip(&banded[rows..]);
    found
        .flat_map(|(item, known)| {
            let numbers = item.numbers.iter().zip(&known.bands);
            let (rate, along) = (item.numbers[0].value, known.bands[0].linear);
            let point = move |factor: f64, y: f64, band: &Band| PointAt {
                x: rate,
                y: Some(factor * y),
                along,
                across: band.linear.map(|ends| ends.map(|end| factor * end)),
            };
            numbers
                .skip(1)
                .flat_map(move |(number, band)| {
                    let factors = [1.0, coefficient];
                    factors.map(|factor| point(factor, number.value, band))
                })
                .collect::<Vec<_>>()
        })
        .collect()
}
