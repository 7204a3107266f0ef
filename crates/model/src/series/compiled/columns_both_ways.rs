//! The columns of derivatives of a formula at a state, made in loops and compiled: for tests that compare the two, where there are lanes.

use super::columns::CompiledColumns;
use super::formulas::When;
use crate::series::column_series::{ColumnChunks, ExpandColumns};
use crate::series::element::Element;
use crate::series::linearised::Entries;
use crate::series::program::Program;
use crate::series::program_rows::ProgramRows;

/// The series of the columns of derivatives at a state, in lanes of X, in loops and compiled, of a program that gives the Jacobian and the derivatives
/// in so many parameters; `None` where they are not compiled.
pub(in crate::series) fn columns_both_ways<X: Element>(
    (program, parameters): (&Program, usize),
    state: &[f64],
    (order, unit): (usize, f64),
    (room, any): (usize, X),
) -> Option<[Vec<f64>; 2]> {
    let mut rows = ProgramRows::new(program, room, 0.0);
    rows.begin(state);
    rows.prepare();
    rows.integrate(unit);
    for k in 1..order {
        rows.level(k, unit);
    }
    let n = state.len();
    let entries = Entries::of(program, n, parameters);
    let of = (&entries.jacobian[..], &entries.forcing[..]);
    let mut columns = ColumnChunks::new(n, n + parameters, room, any);
    columns.start();
    columns.begin();
    let lanes = |columns: &ColumnChunks<X>| {
        let all = columns.series.iter();
        all.flat_map(|x| (0..X::LANES).map(|lane| x.lane(lane)))
            .collect()
    };
    let sizes = (n, columns.chunks);
    let mut compiled = CompiledColumns::when(When::AtOnce, of, sizes, (room, any))?;
    let made = compiled.expand(&mut columns.series, &rows, (order, unit));
    let by_kernel = made.then(|| lanes(&columns))?;
    any.run(ExpandColumns {
        columns: &mut columns,
        jacobian: &entries.jacobian,
        forcing: &entries.forcing,
        rows: &rows,
        unit,
        order,
    });
    Some([lanes(&columns), by_kernel])
}
