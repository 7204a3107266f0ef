//! How rows are shown: the columns of results, as cells and as objects, and their pictures.

use crate::scene::{CellValue, Column, Quantity, Units};
use serde_json::{Map, Value, json};
use twinslip::number::Uncertain;
use twinslip_output::Cell;

mod bifurcation;
mod catalogue;
mod clusters;
mod diagram;
mod equilibria;
mod fit;
mod general;
mod heat_map;
mod holds;
mod labels;
mod last_part;
mod law;
mod law_picture;
mod listing;
mod look;
mod many;
mod many_equilibria;
mod map;
mod orbit;
mod points;
mod run;
mod steady_picture;
pub mod sweep;
mod text;

pub use bifurcation::{branch_columns, locus_columns, special_columns};
pub use catalogue::{many_event_columns, participation_columns, picture_of_events};
pub use clusters::staircase;
pub use diagram::{axis_label, branch_lines, branches, curves, parameters};
pub use equilibria::equilibria_columns;
pub use fit::{
    FitRow, digits_of, fit_columns, in_digits, label_of, parameter_label, picture_of_fit,
    picture_of_parameters, scale_name,
};
pub use general::{general_branches, general_curves, general_lines};
pub use holds::{measured_healing, picture_of_holds};
pub use labels::named_strokes;
pub use law::law_columns;
pub use law_picture::picture_of_law;
pub use listing::{Listed, Listing};
pub use look::{look_columns, picture_of_look};
pub use many::many_run;
pub use many_equilibria::steady_interface_columns;
pub use map::{picture_of_section, return_map, states_at_returns};
pub use orbit::{derivative_columns, known, orbit_columns, picture_of_responses, response_columns};
pub use points::{Dot, REGIMES, diagram_columns, dots, outcome, sweep_columns, sweep_row};
pub use run::{event_columns, panels_in_time, phase_plane, picture_of_run};
pub use steady_picture::{
    picture_of_equilibria, picture_of_many_equilibrium, picture_of_text_equilibria,
};
pub use sweep::{
    Basins, GridSide, PointOutcome, basin_map, basins_of_states, diagram_picture, parameter_map,
    regime_line, regime_map,
};
pub use text::{text_equilibria_columns, with_fixed_parameters, with_parameters};

/// The names as written, error budgets in columns of their own but in tables.
pub fn names<R>(columns: &[Column<R>], table: bool) -> Vec<(String, Quantity)> {
    let mut names = Vec::new();
    for column in columns.iter().filter(|column| column.in_table || !table) {
        names.push((column.name.to_string(), column.quantity));
        if column.uncertain && !table {
            names.push((format!("{}_uncertainty", column.name), column.quantity));
        }
    }
    names
}

/// A row in the user's units.
pub fn cells<R>(columns: &[Column<R>], row: &R, units: &Units, table: bool) -> Vec<Cell> {
    let mut cells = Vec::new();
    for column in columns.iter().filter(|column| column.in_table || !table) {
        match column.entry(row) {
            CellValue::Number(x) => cells.push(x.map(|x| units.outward(column.quantity, x)).into()),
            CellValue::Uncertain(x) => {
                let x = x.map(|x| units.outward_uncertain(column.quantity, x));
                cells.push(x.map(|x| x.value).into());
                if !table {
                    cells.push(x.map(|x| x.uncertainty).into());
                }
            }
            CellValue::Word(word) => cells.push(word.map_or(Cell::Missing, Cell::Text)),
            CellValue::Count(n) => cells.push(Cell::Text(n.to_string())),
            CellValue::Named(all) if all.is_empty() => cells.push(Cell::Missing),
            CellValue::Named(all) => {
                let each = all.iter().map(|(name, x)| {
                    let Uncertain { value, uncertainty } = x;
                    format!("{name} = {value} +- {uncertainty:e}")
                });
                let each: Vec<String> = each.collect();
                cells.push(Cell::Text(each.join("; ")));
            }
        }
    }
    cells
}

/// A row as an object.
pub fn object<R>(columns: &[Column<R>], row: &R, units: &Units) -> Map<String, Value> {
    let value = |column: &Column<R>| match column.entry(row) {
        CellValue::Number(x) => json!(x.map(|x| units.outward(column.quantity, x))),
        CellValue::Uncertain(x) => x.map_or(Value::Null, |x| {
            let x = units.outward_uncertain(column.quantity, x);
            twinslip_output::uncertain((x.value, x.uncertainty))
        }),
        CellValue::Word(word) => json!(word),
        CellValue::Count(n) => json!(n),
        CellValue::Named(all) if all.is_empty() => Value::Null,
        CellValue::Named(all) => {
            let each = all.into_iter().map(|(name, x)| {
                let x = twinslip_output::uncertain((x.value, x.uncertainty));
                (name, x)
            });
            Value::Object(each.collect())
        }
    };
    let pairs = columns.iter();
    pairs
        .map(|column| (column.name.to_string(), value(column)))
        .collect()
}
