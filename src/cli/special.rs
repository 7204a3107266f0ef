//! Special points as objects and as a short table.

use crate::bifurcation::{Criticality, Special};
use crate::scene::{CellValue, Column, GeneralRow, Quantity, Units};
use crate::views;
use serde_json::{Value, json};

/// What a second method says of the special points.
#[derive(Default)]
pub struct Checks {
    /// Its name, if there is one.
    pub method: Option<&'static str>,
    /// Relative differences in V_H, K and the period, of the first so many points.
    pub differences: Vec<Option<[f64; 3]>>,
}

/// `result.special`.
pub fn objects<S>(
    special: &[S],
    columns: &[Column<S>],
    checks: &Checks,
    units: &Units,
) -> Vec<Value> {
    let object = |(i, one): (usize, &S)| {
        let mut object = views::object(columns, one, units);
        if let Some(method) = checks.method {
            let difference = checks.differences.get(i).copied().flatten();
            let check = difference.map(|[driving, stiffness, period]| {
                json!({
                    "method": method,
                    "driving_difference": driving,
                    "stiffness_difference": stiffness,
                    "period_difference": period,
                })
            });
            object.insert("crosscheck".to_owned(), json!(check));
        }
        Value::Object(object)
    };
    special.iter().enumerate().map(object).collect()
}

/// The table of special points in V_H and K, a line each with the header first; none where there is none.
pub fn lines(special: &[Special], checks: &Checks, units: &Units) -> Vec<String> {
    if special.is_empty() {
        return Vec::new();
    }
    let check = checks
        .method
        .map(|method| format!("{method} differs in V_H, K, period by"));
    let header = vec![
        String::new(),
        String::new(),
        format!("V_H [{}]", units.name(Quantity::SlipRate)),
        format!("K [{}]", units.name(Quantity::Stiffness)),
        format!("period [{}]", units.name(Quantity::Time)),
        String::new(),
        check.unwrap_or_default(),
        String::new(),
    ];
    let mut table = vec![header];
    for (i, one) in special.iter().enumerate() {
        let difference = checks.differences.get(i).copied().flatten();
        table.push(line(one, difference, units));
    }
    aligned(&table)
}

/// The same in other parameters, by the columns that are numbers with their budgets.
pub fn general_lines(
    special: &[GeneralRow],
    columns: &[Column<GeneralRow>],
    units: &Units,
) -> Vec<String> {
    if special.is_empty() {
        return Vec::new();
    }
    let known: Vec<_> = columns.iter().filter(|column| column.uncertain).collect();
    let named = |column: &&Column<GeneralRow>| match units.name(column.quantity) {
        "" | "1" => column.name.to_string(),
        unit => format!("{} [{unit}]", column.name),
    };
    let around = |first: [String; 2], inner: Vec<String>, last: [String; 2]| -> Vec<String> {
        first.into_iter().chain(inner).chain(last).collect()
    };
    let empty = || [String::new(), String::new()];
    let mut table = vec![around(empty(), known.iter().map(named).collect(), empty())];
    for one in special {
        let cell = |column: &&Column<GeneralRow>| match column.entry(one) {
            CellValue::Uncertain(Some(x)) => {
                units.outward_uncertain(column.quantity, x).to_string()
            }
            _ => String::new(),
        };
        let label = one
            .label
            .map_or(["", ""], |label| [label.name(), label.meaning()]);
        let criticality = one.criticality.map_or("", Criticality::name).to_owned();
        table.push(around(
            label.map(str::to_owned),
            known.iter().map(cell).collect(),
            [criticality, one.note.clone().unwrap_or_default()],
        ));
    }
    aligned(&table)
}

fn line(one: &Special, difference: Option<[f64; 3]>, units: &Units) -> Vec<String> {
    let number = |quantity, x| units.outward_uncertain(quantity, x).to_string();
    let period = one.period.map(|x| number(Quantity::Time, x));
    let difference = difference.map(|[v, k, t]| format!("{v:.1e}, {k:.1e}, {t:.1e}"));
    vec![
        one.label.name().to_owned(),
        one.label.meaning().to_owned(),
        number(Quantity::SlipRate, one.driving),
        number(Quantity::Stiffness, one.stiffness),
        period.unwrap_or_default(),
        one.criticality.map_or("", Criticality::name).to_owned(),
        difference.unwrap_or_default(),
        one.note.clone().unwrap_or_default(),
    ]
}

/// Columns of equal width, without those in which no row has anything.
fn aligned(table: &[Vec<String>]) -> Vec<String> {
    let length = |text: &String| text.chars().count();
    let columns = table.first().map_or(0, Vec::len);
    let widths: Vec<usize> = (0..columns)
        .map(|i| {
            let rows = table[1..].iter().map(|row| length(&row[i])).max();
            let widest = table.iter().map(|row| length(&row[i])).max();
            rows.filter(|&width| width > 0)
                .and(widest)
                .unwrap_or_default()
        })
        .collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).filter(|&(_, &width)| width > 0);
        let cells: Vec<String> = cells
            .map(|(text, &width)| format!("{text:<width$}"))
            .collect();
        format!("  {}", cells.join("  ")).trim_end().to_owned()
    };
    table.iter().map(line).collect()
}
