//! Table 1: the strong resonances along the curve of torus bifurcations.

use super::second::{BY_SECOND, again};
use super::{Answer, Entry, missing};
use crate::bifurcation::{Label, Special};
use crate::error::Result;
use crate::number::Uncertain;
use crate::output::Cell;
use crate::paper::product::Made;
use crate::paper::{Pieces, Sheet};

/// A column of the printed table: the resonance, and of each of its numbers the entry's name, what it is, and as printed.
struct Printed {
    label: Label,
    name: &'static str,
    numbers: [[&'static str; 3]; 3],
}

const TABLE: [Printed; 5] = [
    Printed {
        label: Label::R4,
        name: "1:4",
        numbers: [
            [
                "1:4-first-log10-V_H",
                "log10 V_H/V* of the resonance 1:4",
                "-1.2582",
            ],
            ["1:4-first-V_H", "V_H of the resonance 1:4", "0.0552"],
            ["1:4-first-K", "K of the resonance 1:4", "0.0387"],
        ],
    },
    Printed {
        label: Label::R4,
        name: "1:4",
        numbers: [
            [
                "1:4-second-log10-V_H",
                "log10 V_H/V* of the resonance 1:4",
                "-1.0859",
            ],
            ["1:4-second-V_H", "V_H of the resonance 1:4", "0.0821"],
            ["1:4-second-K", "K of the resonance 1:4", "0.1566"],
        ],
    },
    Printed {
        label: Label::R4,
        name: "1:4",
        numbers: [
            [
                "1:4-third-log10-V_H",
                "log10 V_H/V* of the resonance 1:4",
                "-0.9447",
            ],
            ["1:4-third-V_H", "V_H of the resonance 1:4", "0.1136"],
            ["1:4-third-K", "K of the resonance 1:4", "0.1956"],
        ],
    },
    Printed {
        label: Label::R3,
        name: "1:3",
        numbers: [
            [
                "1:3-log10-V_H",
                "log10 V_H/V* of the resonance 1:3",
                "-0.9761",
            ],
            ["1:3-V_H", "V_H of the resonance 1:3", "0.1057"],
            ["1:3-K", "K of the resonance 1:3", "0.1617"],
        ],
    },
    Printed {
        label: Label::R2,
        name: "1:2",
        numbers: [
            [
                "1:2-log10-V_H",
                "log10 V_H/V* of the resonance 1:2",
                "-1.0027",
            ],
            ["1:2-V_H", "V_H of the resonance 1:2", "0.0994"],
            ["1:2-K", "K of the resonance 1:2", "0.1376"],
        ],
    },
];
const QUANTITIES: [&str; 3] = ["log10(V_H/V*)", "V_H/V*", "K"];
const UNITS: [&str; 3] = ["", "V*", "a sigma/L"];

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

/// log10 V_H, V_H and K.
fn three([driving, stiffness]: [Uncertain; 2]) -> [Uncertain; 3] {
    let logarithm = driving.value.log10();
    let relative = driving.uncertainty / driving.value;
    let off = relative / std::f64::consts::LN_10 + f64::EPSILON * logarithm.abs();
    [Uncertain::new(logarithm, off), driving, stiffness]
}

/// The fifteen numbers.
pub fn entries(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let mut all = Vec::new();
    for (special, column) in resonances(pieces)?.iter().zip(&TABLE) {
        let first = three([special.driving, special.stiffness]);
        let second = three(again(pieces, special)?);
        for (i, [id, quantity, printed]) in column.numbers.into_iter().enumerate() {
            let place = match (column.label, i) {
                (Label::R2, 1 | 2) => "Table 1; Fig. 14, caption",
                _ => "Table 1",
            };
            let entry = Entry::number((id, place), quantity, UNITS[i], printed, first[i]);
            let entry = entry.beside(BY_SECOND, Answer::Number(second[i]));
            let (what, off) = (["V_H", "V_H", "K"][i], 100.0 * off(printed, first[i].value));
            all.push(entry.noted(format!("the printed {what} is off by {off:.2} %")));
        }
    }
    Ok(all)
}

/// By which part a printed V_H or K differs from the computed one; of a logarithm, the V_H that it is the logarithm of.
fn off(printed: &str, computed: f64) -> f64 {
    printed.parse::<f64>().map_or(f64::NAN, |x| {
        if x < 0.0 {
            (std::f64::consts::LN_10 * (x - computed)).exp_m1()
        } else {
            x / computed - 1.0
        }
    })
}

/// The table with the values computed.
///
/// # Errors
/// Those of the curve and of the second method.
pub fn table1(pieces: &Pieces<'_>) -> Result<Made> {
    let mut rows = Vec::new();
    for (special, column) in resonances(pieces)?.iter().zip(&TABLE) {
        let first = three([special.driving, special.stiffness]);
        let second = three(again(pieces, special)?);
        for (i, [_, _, printed]) in column.numbers.into_iter().enumerate() {
            rows.push(vec![
                Cell::from(column.name),
                Cell::from(QUANTITIES[i]),
                Cell::from(printed),
                Cell::from(first[i].value),
                Cell::from(first[i].uncertainty),
                Cell::from(second[i].value),
                Cell::from(off(printed, first[i].value)),
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
         nodes cut to a few digits, by CVODE's BDF at 1e-12 (Rodas5P in a build without \
         SUNDIALS); relative_difference is that of the printed V_H or K from the computed \
         one, also where the logarithm is printed"
            .into(),
    })
}
