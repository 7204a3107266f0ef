//! Columns and titles of user-defined systems.

use super::diagram::value;
use crate::scene::{AnySystem, Column, Described, Quantity, TextEquilibrium, TextModel, Units};
use Quantity::Number;

/// The columns of equilibria; a table has room for the leading eigenvalue.
pub fn text_equilibria_columns(model: &TextModel) -> Vec<Column<TextEquilibrium>> {
    type Row = TextEquilibrium;
    let states = model.system.states().iter().enumerate();
    let mut columns: Vec<Column<Row>> = states
        .map(|(i, name)| {
            let value = move |row: &Row| row.state[i].into();
            Column::uncertain(*name, model.quantity(i), value)
        })
        .collect();
    let interfaces = model.slab.as_ref().map_or(0, |slab| slab.clusters().len());
    for (i, rate) in (1..=interfaces).enumerate() {
        let v = move |row: &Row| row.slip_rate.get(i).copied().into();
        columns.push(Column::new(
            format!("slip_rate_{rate}"),
            Quantity::SlipRate,
            v,
        ));
    }
    for i in 0..model.system.states().len() {
        let place = i + 1;
        let value = |row: &Row, i: usize| row.stability.eigenvalues.get(i).copied();
        let [re, im] = Column::eigenvalue(i, Quantity::Growth, value);
        let mut of_one = [
            re,
            im,
            Column::new(
                format!("eigenvalue_uncertainty_{place}"),
                Quantity::Growth,
                move |row: &Row| row.stability.uncertainty.get(i).copied().into(),
            )
            .not_in_table(),
        ];
        for column in &mut of_one {
            column.in_table &= i == 0;
        }
        columns.extend(of_one);
    }
    columns.extend([
        Column::new("verdict", Number, |row: &Row| {
            row.stability.verdict.name().into()
        }),
        Column::new("residual", Number, |row: &Row| row.residual.into()).not_in_table(),
        Column::new("unstable", Number, |row: &Row| {
            row.stability.unstable().into()
        })
        .not_in_table(),
    ]);
    columns
}

/// The name of a system with the values of its parameters.
pub fn with_parameters(model: &TextModel) -> String {
    with_fixed_parameters(model, |_| false)
}

/// The same without the parameters that vary.
pub fn with_fixed_parameters(model: &TextModel, varies: impl Fn(&str) -> bool) -> String {
    let system = &model.system;
    let quantity = |name: &str| match model.slab {
        Some(_) => Quantity::of_parameter(name),
        None => Number,
    };
    let all = system.parameter_names().iter().zip(system.parameters());
    let fixed = all.filter(|(name, _)| !varies(name));
    let all: Vec<_> = fixed.map(|(name, x)| (*name, quantity(name), *x)).collect();
    titled(Some(model.name()), &all, model.units())
}

/// The title of a picture with the parameters of any system.
pub(super) fn parameters_of(system: &AnySystem) -> String {
    titled(system.name(), &system.parameters(), system.units())
}

/// A name, where there is one, with the values of parameters.
pub(super) fn titled(
    name: Option<&str>,
    parameters: &[(&str, Quantity, f64)],
    units: &Units,
) -> String {
    /// More of these would hide what is drawn.
    const MOST: usize = 8;
    let shown = parameters.iter().take(MOST);
    let each = shown.map(|(name, quantity, x)| value(name, *quantity, *x, units));
    let values = each.collect::<Vec<_>>().join(", ");
    match (name, values.is_empty()) {
        (None, _) => values,
        (Some(name), true) => name.to_owned(),
        (Some(name), false) => format!("{name}: {values}"),
    }
}
