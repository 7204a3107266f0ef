//! What the rows of a sweep show, and how they are read again.

use super::PointOutcome;
use crate::scene::{CellValue, Column, Diagram, Moving, Quantity, SweepLayout, Units};
use twinslip::equilibrium::Symmetry;
use twinslip::number::Uncertain;
use twinslip::section::Regime;
use twinslip::sweep::SweepRow;

/// The regimes in the order of summaries and legends.
pub const REGIMES: [Regime; 5] = [
    Regime::Steady,
    Regime::Periodic,
    Regime::Torus,
    Regime::Chaotic,
    Regime::Undecided,
];

/// A value that a state comes back to on an attractor.
#[derive(Debug, Clone, PartialEq)]
pub struct Dot {
    /// The parameters that vary.
    pub parameters: Vec<f64>,
    /// The number of the start, from 1.
    pub start: usize,
    /// Its number on the attractor, from 1.
    pub n: usize,
    /// The value.
    pub value: f64,
    /// What the attractor is.
    pub regime: Regime,
}

/// The values of a point of a diagram, of a sweep of so many starts.
pub fn dots(row: &SweepRow, starts: usize) -> impl Iterator<Item = Dot> + '_ {
    let each = row.dots.iter().zip(1..);
    each.map(move |(&value, n)| Dot {
        parameters: row.parameters.clone(),
        start: row.number % starts + 1,
        n,
        value,
        regime: row.regime,
    })
}

/// The columns of a diagram.
pub fn diagram_columns(layout: &SweepLayout, diagram: &Diagram, starts: usize) -> Vec<Column<Dot>> {
    use Quantity::Number;
    let parameters = layout.parameters.iter().enumerate();
    let mut columns: Vec<Column<Dot>> = parameters
        .map(|(i, (name, quantity))| {
            Column::new(name.clone(), *quantity, move |dot: &Dot| {
                dot.parameters[i].into()
            })
        })
        .collect();
    if starts > 1 {
        columns.push(Column::new("start", Number, |dot: &Dot| dot.start.into()));
    }
    columns.extend([
        Column::new("n", Number, |dot: &Dot| dot.n.into()),
        Column::new(diagram.name.clone(), diagram.quantity, |dot: &Dot| {
            dot.value.into()
        }),
        Column::new("regime", Number, |dot: &Dot| dot.regime.name().into()),
    ]);
    columns
}

/// The columns of the points of a sweep. A row's start is one that `integrate --start` takes.
pub fn sweep_columns(layout: &SweepLayout) -> Vec<Column<SweepRow>> {
    use Quantity::{Growth, Number, Time};
    let regime = Column::new("regime", Number, |row: &SweepRow| row.regime.name().into());
    let period = Column::new("period", Time, |row: &SweepRow| row.period.into());
    let [(least, _), (most, quantity)] = range_names(layout);
    let range = [
        Column::new(least, quantity, |row: &SweepRow| {
            row.range.map(|range| range.0).into()
        }),
        Column::new(most, quantity, |row: &SweepRow| {
            row.range.map(|range| range.1).into()
        }),
    ];
    let exponent = Column::uncertain("lyapunov_max", Growth, |row: &SweepRow| {
        row.lyapunov_max.into()
    });
    let returns = Column::new("returns", Number, |row: &SweepRow| row.returns.into());
    let per_period = |name: &'static str| {
        Column::new(name, Number, |row: &SweepRow| {
            CellValue::Word(row.returns_per_period.map(|q| q.to_string()))
        })
    };
    let note = Column::new("note", Number, |row: &SweepRow| {
        // A row is a line, whatever the reason says.
        CellValue::Word(row.note.as_ref().map(|note| note.replace('\n', " ")))
    });
    let parameters = layout.parameters.iter().enumerate();
    let mut columns: Vec<Column<SweepRow>> = parameters
        .map(|(i, (name, quantity))| {
            Column::new(name.clone(), *quantity, move |row: &SweepRow| {
                row.parameters[i].into()
            })
        })
        .collect();
    let starts = starts(layout).into_iter().enumerate();
    let starts = starts.map(|(i, (name, quantity))| {
        Column::new(name, quantity, move |row: &SweepRow| {
            let start = row.start.get(i).copied();
            match quantity {
                Quantity::State => start.map(f64::exp).into(),
                _ => start.into(),
            }
        })
    });
    match layout.moves {
        Moving::Interfaces(count) => {
            let symmetry = Column::new("symmetry", Number, |row: &SweepRow| {
                row.symmetry.map(Symmetry::name).into()
            })
            .in_table_if(count > 1);
            columns.extend([regime, symmetry, period]);
            columns.extend(range);
            columns.extend([exponent, returns, per_period("period_of_orbit")]);
            columns.extend(starts);
        }
        Moving::States(..) => {
            columns.extend(starts);
            columns.extend([regime, per_period("returns_per_period"), period]);
            columns.extend(range);
            columns.extend([exponent, returns]);
        }
    }
    columns.push(note);
    for column in &mut columns {
        column.in_table = !column.name.starts_with("start_") && column.name != "note";
    }
    columns
}

/// The names and quantities of a start.
fn starts(layout: &SweepLayout) -> Vec<(String, Quantity)> {
    match &layout.moves {
        Moving::Interfaces(count) => {
            let states = (1..=*count).map(|i| (format!("start_state_{i}"), Quantity::State));
            let stress = ("start_stress".to_owned(), Quantity::Stress);
            std::iter::once(stress).chain(states).collect()
        }
        Moving::States(names, _) => {
            let start = |name: &&str| (format!("start_{name}"), Quantity::Number);
            names.iter().map(start).collect()
        }
    }
}

/// Of what rows tell the least and the greatest value.
fn range_names(layout: &SweepLayout) -> [(String, Quantity); 2] {
    let (name, quantity) = match &layout.moves {
        Moving::Interfaces(_) => ("stress", Quantity::Stress),
        Moving::States(names, section) => (names[*section], Quantity::Number),
    };
    ["min", "max"].map(|end| (format!("{name}_{end}"), quantity))
}

/// A row from the cells of its line, by the names of their columns; `None` if they are not those of a row.
pub fn sweep_row<'a>(
    number: usize,
    cell: &dyn Fn(&str) -> &'a str,
    layout: &SweepLayout,
    units: &Units,
) -> Option<SweepRow> {
    let maybe = |name: &str, quantity| {
        let text = cell(name);
        match text.is_empty() {
            true => Some(None),
            false => Some(Some(units.inward(quantity, text.parse().ok()?))),
        }
    };
    let text = |name: &str| Some(cell(name)).filter(|text| !text.is_empty());
    let exponent = maybe("lyapunov_max", Quantity::Growth)?;
    let bound = maybe("lyapunov_max_uncertainty", Quantity::Growth)?;
    let [least, most] = range_names(layout);
    let range = (maybe(&least.0, least.1)?, maybe(&most.0, most.1)?);
    let parameters = layout.parameters.iter();
    let parameters = parameters.map(|(name, quantity)| maybe(name, *quantity)?);
    let start: Option<Vec<Option<f64>>> = starts(layout)
        .into_iter()
        .map(|(name, quantity)| {
            let value = maybe(&name, quantity)?;
            Some(match quantity {
                Quantity::State => value.map(f64::ln),
                _ => value,
            })
        })
        .collect();
    let per_period = text("period_of_orbit").or(text("returns_per_period"));
    Some(SweepRow {
        dots: Vec::new(),
        number,
        parameters: parameters.collect::<Option<_>>()?,
        // Where there is no start all of it is missing.
        start: start?.into_iter().flatten().collect(),
        regime: REGIMES
            .into_iter()
            .find(|regime| regime.name() == cell("regime"))?,
        symmetry: Symmetry::named(cell("symmetry")),
        returns_per_period: per_period.and_then(|text| text.parse().ok()),
        period: maybe("period", Quantity::Time)?,
        range: range.0.zip(range.1),
        lyapunov_max: exponent.map(|x| Uncertain::new(x, bound.unwrap_or(f64::INFINITY))),
        returns: cell("returns").parse().ok()?,
        note: text("note").map(str::to_owned),
    })
}

/// What a picture shows of a row.
pub fn outcome(row: &SweepRow) -> PointOutcome {
    PointOutcome {
        number: row.number,
        regime: row.regime,
        symmetry: row.symmetry,
        returns_per_period: row.returns_per_period,
        period: row.period,
        stress_range: row.range,
        lyapunov_max: row.lyapunov_max,
    }
}
