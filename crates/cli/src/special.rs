//! Special points as objects and as a short table.

use serde_json::{Value, json};
use twinslip::bifurcation::{Criticality, Label, Special};
use twinslip_tasks::scene::{CellValue, Column, GeneralRow, Quantity, Units};
use twinslip_tasks::views;

/// What a second method says of the special points.
#[derive(Default)]
pub struct Checks<'a> {
    /// Its name, if there is one.
    pub method: Option<&'static str>,
    /// The names of the parameters, those that vary first.
    pub names: Vec<&'a str>,
    /// Relative differences in the parameters that vary and, last, the period, of the first so many points.
    pub differences: Vec<Option<Vec<f64>>>,
}

impl Checks<'_> {
    /// The differences of a point by the names of what differs.
    fn of(&self, i: usize) -> Option<Vec<(&str, f64)>> {
        let (period, parameters) = self.differences.get(i)?.as_ref()?.split_last()?;
        let parameters = self.names.iter().copied().zip(parameters.iter().copied());
        Some(parameters.chain([("period", *period)]).collect())
    }

    /// The heading of the differences in a table.
    fn heading(&self, symbols: &str) -> String {
        self.method.map_or(String::new(), |method| {
            format!("{method} differs in {symbols}period by")
        })
    }

    /// The differences of a point in a table.
    fn cell(&self, i: usize) -> String {
        let all = self.of(i).unwrap_or_default();
        let all: Vec<String> = all.iter().map(|(_, x)| format!("{x:.1e}")).collect();
        all.join(", ")
    }
}

/// `result.special`.
pub fn objects<S>(
    special: &[S],
    columns: &[Column<S>],
    checks: &Checks<'_>,
    units: &Units,
) -> Vec<Value> {
    let object = |(i, one): (usize, &S)| {
        let mut object = views::object(columns, one, units);
        if let Some(method) = checks.method {
            let check = checks.of(i).map(|all| {
                let mut check = json!({"method": method});
                for (name, difference) in all {
                    check[format!("{name}_difference")] = json!(difference);
                }
                check
            });
            object.insert("crosscheck".to_owned(), json!(check));
        }
        Value::Object(object)
    };
    special.iter().enumerate().map(object).collect()
}

/// The table of special points in V_H and K, a line each with the header first; none where there is none.
pub fn lines(special: &[Special], checks: &Checks<'_>, units: &Units) -> Vec<String> {
    if special.is_empty() {
        return Vec::new();
    }
    let header = vec![
        String::new(),
        String::new(),
        format!("V_H [{}]", units.name(Quantity::SlipRate)),
        format!("K [{}]", units.name(Quantity::Stiffness)),
        format!("period [{}]", units.name(Quantity::Time)),
        String::new(),
        checks.heading("V_H, K, "),
        String::new(),
    ];
    let mut table = vec![header];
    for (i, one) in special.iter().enumerate() {
        table.push(line(one, checks.cell(i), units));
    }
    aligned(&table)
}

/// The same in other parameters, by the columns that are numbers with their budgets.
pub fn general_lines(
    special: &[GeneralRow],
    columns: &[Column<GeneralRow>],
    checks: &Checks<'_>,
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
    let around = |first: [String; 2], inner: Vec<String>, last: [String; 3]| -> Vec<String> {
        first.into_iter().chain(inner).chain(last).collect()
    };
    let empty = String::new;
    let heading = checks.heading("what varies and the ");
    let mut table = vec![around(
        [empty(), empty()],
        known.iter().map(named).collect(),
        [empty(), heading, empty()],
    )];
    for (i, one) in special.iter().enumerate() {
        let cell = |column: &&Column<GeneralRow>| match column.entry(one) {
            CellValue::Uncertain(Some(x)) => {
                units.outward_uncertain(column.quantity, x).to_string()
            }
            _ => String::new(),
        };
        let label = [one.label.map(Label::name), one.meaning()].map(Option::unwrap_or_default);
        let criticality = one.criticality.map_or("", Criticality::name).to_owned();
        table.push(around(
            label.map(str::to_owned),
            known.iter().map(cell).collect(),
            [
                criticality,
                checks.cell(i),
                one.note.clone().unwrap_or_default(),
            ],
        ));
    }
    aligned(&table)
}

fn line(one: &Special, difference: String, units: &Units) -> Vec<String> {
    let number = |quantity, x| units.outward_uncertain(quantity, x).to_string();
    let period = one.period.map(|x| number(Quantity::Time, x));
    vec![
        one.label.name().to_owned(),
        one.label.meaning().to_owned(),
        number(Quantity::SlipRate, one.driving),
        number(Quantity::Stiffness, one.stiffness),
        period.unwrap_or_default(),
        one.criticality.map_or("", Criticality::name).to_owned(),
        difference,
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
