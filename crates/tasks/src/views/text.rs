//! What user-defined systems show: columns and pictures.

use super::diagram::value;
use super::heat_map::{MOST_PANELS, states_in_time};
use super::last_part::with_last_part;
use super::law::law_columns;
use super::orbit::multiplier_columns;
use crate::scene::{
    Column, Described, Quantity, TextEquilibrium, TextLawPoint, TextModel, TextPlan,
    TextSectionPlan, TextSlab,
};
use Quantity::Number;
use twinslip::orbit::Orbit;
use twinslip_output::RowList;
use twinslip_output::plot::{Axis, Drawing, Panel, PlotSeries, Stroke};

/// The columns of the steady-state friction of a law from a file: those of a law that is built in, and error budgets.
pub fn text_law_columns(two: bool) -> Vec<Column<TextLawPoint>> {
    type Row = TextLawPoint;
    let known = |x: f64| Some(x).filter(|x| x.is_finite());
    let built_in = law_columns(two).into_iter();
    let mut columns: Vec<Column<Row>> = built_in
        .map(|column| {
            let name = column.name.clone();
            Column::new(name, Number, move |at: &Row| column.entry(&at.point))
        })
        .collect();
    columns.extend([
        Column::new("stress_uncertainty", Number, move |at: &Row| {
            known(at.stress.uncertainty).into()
        })
        .not_in_table(),
        Column::new("state_uncertainty", Number, move |at: &Row| {
            known(at.state.uncertainty).into()
        })
        .not_in_table(),
    ]);
    columns
}

/// The columns of equilibria; a table has room for the leading eigenvalue.
pub fn text_equilibria_columns(model: &TextModel) -> Vec<Column<TextEquilibrium>> {
    type Row = TextEquilibrium;
    let states = model.system.states().iter().enumerate();
    let mut columns: Vec<Column<Row>> = states
        .map(|(i, name)| Column::uncertain(*name, Number, move |row: &Row| row.state[i].into()))
        .collect();
    let interfaces = model.slab.as_ref().map_or(0, |slab| slab.clusters().len());
    for (i, rate) in (1..=interfaces).enumerate() {
        let v = move |row: &Row| row.slip_rate.get(i).copied().into();
        columns.push(Column::new(format!("slip_rate_{rate}"), Number, v));
    }
    for i in 0..model.system.states().len() {
        let value = move |row: &Row| row.stability.eigenvalues.get(i).copied();
        let place = i + 1;
        let mut of_one = [
            Column::new(
                format!("eigenvalue_{place}_re"),
                Number,
                move |row: &Row| value(row).map(|z| z.re).into(),
            ),
            Column::new(
                format!("eigenvalue_{place}_im"),
                Number,
                move |row: &Row| value(row).map(|z| z.im).into(),
            ),
            Column::new(
                format!("eigenvalue_uncertainty_{place}"),
                Number,
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
    ]);
    columns
}

/// The columns of periodic orbits.
pub fn text_orbit_columns(model: &TextModel) -> Vec<Column<Orbit>> {
    let mut columns = vec![Column::uncertain("period", Number, |orbit: &Orbit| {
        orbit.period.into()
    })];
    let states = model.system.states();
    for (i, name) in states.iter().enumerate() {
        for (end, which) in ["min", "max"].into_iter().enumerate() {
            columns.push(Column::uncertain(
                format!("{name}_{which}"),
                Number,
                move |orbit: &Orbit| orbit.extremes[i][end].into(),
            ));
        }
    }
    for i in 0..states.len() - 1 {
        columns.extend(multiplier_columns(i));
    }
    columns.push(Column::new("verdict", Number, |orbit: &Orbit| {
        orbit.verdict().name().into()
    }));
    columns.extend(states.iter().enumerate().map(|(i, name)| {
        let point = move |orbit: &Orbit| orbit.point[i].into();
        Column::new(*name, Number, point).not_in_table()
    }));
    columns
}

/// The name of a system with the values of its parameters.
pub fn with_parameters(model: &TextModel) -> String {
    /// More of these would hide what is drawn.
    const MOST: usize = 8;
    let system = &model.system;
    let all = system.parameter_names().iter().zip(system.parameters());
    let each = all
        .take(MOST)
        .map(|(name, x)| value(name, Number, *x, model.units()));
    match each.collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => model.name().to_owned(),
        values => format!("{}: {values}", model.name()),
    }
}

/// The states in time, each in a panel or, of many, all in one, and beside them the first two against each other.
pub fn text_run(plan: &TextPlan, rows: &RowList) -> Drawing {
    let column = |name: &str| rows.column(name).unwrap_or_default();
    if let Some(slab) = &plan.model.slab {
        return sliding(&plan.model, slab, rows);
    }
    let states = plan.model.system.states();
    let in_time = states.iter().enumerate().map(|(i, name)| Panel {
        series: vec![PlotSeries::new("", column("time"), column(name))],
        ..Panel::new(
            if i == 0 {
                with_parameters(&plan.model)
            } else {
                String::new()
            },
            Axis::linear("time t"),
            Axis::linear(*name),
        )
    });
    let in_time = match states.len() > MOST_PANELS {
        true => vec![states_in_time(plan, rows)],
        false => in_time.collect(),
    };
    let plane = match states {
        [first, second, ..] => vec![vec![Panel {
            series: vec![PlotSeries::new("", column(first), column(second))],
            ..Panel::new("phase plane", Axis::linear(*first), Axis::linear(*second))
        }]],
        _ => Vec::new(),
    };
    let first = states.first().map_or(Vec::new(), |name| column(name));
    with_last_part(in_time, plane, (&column("time"), &first))
}

/// Stress, states and slip rates of interfaces in time, and beside them the stress against the slip rates.
fn sliding(model: &TextModel, slab: &TextSlab, rows: &RowList) -> Drawing {
    let column = |name: &str| rows.column(name).unwrap_or_default();
    let each = |symbol: &str, x: Option<&str>, y: Option<&str>| -> Vec<PlotSeries> {
        let one = |i: usize| {
            let of = |name: Option<&str>, other: &str| match name {
                Some(name) => column(&format!("{name}_{i}")),
                None => column(other),
            };
            let name = if slab.clusters().len() == 1 {
                String::new()
            } else {
                format!("{symbol}_{i}")
            };
            PlotSeries::new(name, of(x, "time"), of(y, "stress"))
        };
        (1..=slab.clusters().len()).map(one).collect()
    };
    let panel = |title: &str, x: Axis, y: Axis, series| Panel {
        series,
        ..Panel::new(title, x, y)
    };
    let time = || Axis::linear("time t");
    let mut rates = each("v", None, Some("slip_rate"));
    rates.extend(
        rows.column("driving")
            .map(|driving| PlotSeries::new("V_H", column("time"), driving).stroke(Stroke::Dotted)),
    );
    let stress = vec![PlotSeries::new("", column("time"), column("stress"))];
    let title = with_parameters(model);
    let in_time = vec![
        panel(&title, time(), Axis::linear("stress τ"), stress),
        panel(
            "state",
            time(),
            Axis::log("state ψ"),
            each("ψ", None, Some("state")),
        ),
        panel("slip rate", time(), Axis::log("slip rate v"), rates),
    ];
    let plane = panel(
        "phase plane",
        Axis::log("slip rate v"),
        Axis::linear("stress τ"),
        each("v", Some("slip_rate"), None),
    );
    let in_time_of = (&column("time")[..], &column("stress")[..]);
    with_last_part(in_time, vec![vec![plane]], in_time_of)
}

/// A state at each return against itself at the next, and where there is one more the states at the returns.
pub fn text_return_map(plan: &TextSectionPlan, rows: &RowList) -> Drawing {
    let names = plan.model.system.states();
    // In the section that state is the same.
    let free: Vec<&str> = (0..names.len())
        .filter(|i| *i != plan.state)
        .map(|i| names[i])
        .collect();
    let values = rows.column(free[0]).unwrap_or_default();
    let (here, next) = (values[..values.len() - 1].to_vec(), values[1..].to_vec());
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let title = format!(
        "return map at {}, {}",
        value(names[plan.state], Number, plan.value, plan.model.units()),
        with_parameters(&plan.model)
    );
    let map = Panel {
        series: vec![
            PlotSeries::dots("", here, next),
            PlotSeries::new("diagonal", vec![least, most], vec![least, most]),
        ],
        ..Panel::new(
            title,
            Axis::linear(format!("{} at return n", free[0])),
            Axis::linear(format!("{} at return n + 1", free[0])),
        )
    };
    let mut columns = vec![vec![map]];
    if let [first, second, ..] = free[..] {
        let column = |name: &str| rows.column(name).unwrap_or_default();
        columns.push(vec![Panel {
            series: vec![PlotSeries::dots("", column(first), column(second))],
            ..Panel::new(
                "states at the returns",
                Axis::linear(first),
                Axis::linear(second),
            )
        }]);
    }
    Drawing::columns(columns)
}
