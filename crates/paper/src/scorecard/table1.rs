//! Table 1: the strong resonances along the curve of torus bifurcations.

use super::rule::forms;
use super::second::{BY_SECOND, again};
use super::{Answer, Entry, difference, missing};
use crate::product::Made;
use crate::{Pieces, Sheet};
use twinslip::bifurcation::{Label, Special};
use twinslip::error::Result;
use twinslip::number::Uncertain;
use twinslip_output::Cell;

/// A column of the printed table: the resonance, and of V_H and K the entry's name, what it is, and as printed. V_H is printed
/// twice, by itself and as its logarithm, and is one fact.
struct Printed {
    label: Label,
    name: &'static str,
    numbers: [[&'static str; 3]; 2],
}

const TABLE: [Printed; 5] = [
    Printed {
        label: Label::R4,
        name: "1:4",
        numbers: [
            [
                "1:4-first-V_H",
                "V_H of the resonance 1:4",
                "0.0552 (log10: -1.2582)",
            ],
            ["1:4-first-K", "K of the resonance 1:4", "0.0387"],
        ],
    },
    Printed {
        label: Label::R4,
        name: "1:4",
        numbers: [
            [
                "1:4-second-V_H",
                "V_H of the resonance 1:4",
                "0.0821 (log10: -1.0859)",
            ],
            ["1:4-second-K", "K of the resonance 1:4", "0.1566"],
        ],
    },
    Printed {
        label: Label::R4,
        name: "1:4",
        numbers: [
            [
                "1:4-third-V_H",
                "V_H of the resonance 1:4",
                "0.1136 (log10: -0.9447)",
            ],
            ["1:4-third-K", "K of the resonance 1:4", "0.1956"],
        ],
    },
    Printed {
        label: Label::R3,
        name: "1:3",
        numbers: [
            [
                "1:3-V_H",
                "V_H of the resonance 1:3",
                "0.1057 (log10: -0.9761)",
            ],
            ["1:3-K", "K of the resonance 1:3", "0.1617"],
        ],
    },
    Printed {
        label: Label::R2,
        name: "1:2",
        numbers: [
            [
                "1:2-V_H",
                "V_H of the resonance 1:2",
                "0.0994 (log10: -1.0027)",
            ],
            ["1:2-K", "K of the resonance 1:2", "0.1376"],
        ],
    },
];
const UNITS: [&str; 2] = ["V*", "a sigma/L"];

/// The resonances in the order of the table.
pub(super) fn resonances(pieces: &Pieces<'_>) -> Result<Vec<Special>> {
    let curves = pieces.curves("fig12")?;
    let mut all = Vec::new();
    for label in [Label::R4, Label::R3, Label::R2] {
        let mut these: Vec<Special> = curves
            .special
            .iter()
            .filter(|s| s.label == label)
            .cloned()
            .collect();
        these.sort_by(|a, b| a.driving.value.total_cmp(&b.driving.value));
        all.extend(these);
    }
    let labels: Vec<Label> = all.iter().map(|s| s.label).collect();
    if labels != TABLE.map(|column| column.label) {
        return Err(missing("the torus curve has not the resonances of Table 1"));
    }
    Ok(all)
}

/// The ten facts.
pub fn entries(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let mut all = Vec::new();
    for (special, column) in resonances(pieces)?.iter().zip(&TABLE) {
        let first = [special.driving, special.stiffness];
        let second = again(pieces, special)?;
        for (i, [id, quantity, printed]) in column.numbers.into_iter().enumerate() {
            let place = match column.label {
                Label::R2 => "Table 1; Fig. 14, caption",
                _ => "Table 1",
            };
            let entry = Entry::number((id, place), quantity, UNITS[i], printed, first[i]);
            all.push(entry.beside(BY_SECOND, Answer::Number(second[i])));
        }
    }
    Ok(all)
}

/// log10 of a number.
fn logarithm(x: Uncertain) -> Uncertain {
    let logarithm = x.value.log10();
    let part = x.uncertainty / x.value / std::f64::consts::LN_10;
    Uncertain::new(logarithm, part + f64::EPSILON * logarithm.abs())
}

/// The table with the values computed.
///
/// # Errors
/// Those of the curve and of the second method.
pub fn table1(pieces: &Pieces<'_>) -> Result<Made> {
    let mut rows = Vec::new();
    for (special, column) in resonances(pieces)?.iter().zip(&TABLE) {
        let again = again(pieces, special)?;
        let [[_, _, both], [_, _, stiffness]] = column.numbers;
        let (driving, in_logarithm) = forms(both);
        let logarithms = in_logarithm.map(|printed| {
            let part = difference(both, &Answer::Number(special.driving));
            let [first, second] = [special.driving, again[0]].map(logarithm);
            ("log10(V_H/V*)", printed, part, first, second)
        });
        let numbers = [
            ("V_H/V*", driving, special.driving, again[0]),
            ("K", stiffness, special.stiffness, again[1]),
        ]
        .map(|(quantity, printed, first, second)| {
            let part = difference(printed, &Answer::Number(first));
            (quantity, printed, part, first, second)
        });
        for (quantity, printed, part, first, second) in logarithms.into_iter().chain(numbers) {
            rows.push(vec![
                Cell::from(column.name),
                Cell::from(quantity),
                Cell::from(printed),
                Cell::from(first.value),
                Cell::from(first.uncertainty),
                Cell::from(second.value),
                part.map_or(Cell::Missing, Cell::from),
            ]);
        }
    }
    let columns = [
        "resonance",
        "quantity",
        "printed",
        "computed",
        "uncertainty",
        "second_method",
        "relative_difference",
    ];
    let mut sheet = Sheet::new();
    sheet.add("table1", &columns, rows);
    Ok(Made {
        sheet,
        drawing: None,
        method: "resonances along the torus curve of fig12: orbits by multiple shooting with \
         Taylor series at 1e-16, in three solutions; second_method: the same conditions from \
         nodes cut to a few digits, by CVODE's Adams method at 1e-12 (Rodas5P in a \
         build without SUNDIALS); relative_difference is that of the printed V_H or K from the computed \
         one, also where the logarithm is printed"
            .into(),
    })
}
