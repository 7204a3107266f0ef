//! What periodic orbits show.

use super::diagram::axis_label;
use super::heat_map::MOST_PANELS;
use super::text::parameters_of;
use crate::scene::{AnySystem, Column, Described, OrbitDerivatives, OrbitPlan, Quantity};
use twinslip::number::Uncertain;
use twinslip::orbit::{Orbit, PhaseResponse};
use twinslip_output::plot::{Axis, Drawing, Panel, PlotSeries};

/// The columns of periodic orbits; a table has room for what is looked at first.
pub fn orbit_columns(plan: &OrbitPlan) -> Vec<Column<Orbit>> {
    use Quantity::{Number, Time};
    let system = &plan.system;
    let (slides, interfaces) = (system.slides(), system.clusters().len());
    let period = Column::uncertain("period", Time, |orbit: &Orbit| orbit.period.into())
        .meaning("period of the orbit");
    let mut columns = match slides {
        true => {
            let plan = plan.clone();
            let symmetry = move |orbit: &Orbit| plan.symmetry(orbit).map(|of| of.name()).into();
            let symmetry = Column::new("symmetry", Number, symmetry)
                .meaning("symmetric where both interfaces move alike, else asymmetric");
            vec![symmetry.in_table_if(interfaces > 1), period]
        }
        false => vec![period],
    };
    if slides {
        columns.extend(of_interfaces());
    } else {
        columns.extend(extremes(system, 0));
    }
    for i in 0..system.states().len() - 1 {
        columns.extend(multiplier_columns(i));
    }
    columns.push(
        Column::new("verdict", Number, |orbit: &Orbit| {
            orbit.verdict().name().into()
        })
        .meaning("stable, unstable or undecided"),
    );
    columns.extend(system.states().into_iter().enumerate().map(|(i, name)| {
        let point = move |orbit: &Orbit| orbit.point[of_state(i, orbit)].into();
        let column = Column::new(name, system.quantity(i), point).not_in_table();
        match i {
            0 => column.meaning("stress at the first point of the orbit"),
            _ => column.meaning("ln ψ of interface i at the first point of the orbit"),
        }
    }));
    columns.extend([
        Column::new("trivial_defect", Number, |orbit: &Orbit| {
            orbit.floquet.trivial_defect.into()
        })
        .meaning("distance of the multiplier along the orbit from 1: a check")
        .not_in_table(),
        Column::new("liouville_defect", Number, |orbit: &Orbit| {
            orbit.floquet.liouville_defect.into()
        })
        .meaning("difference between the logarithm of the product of the multipliers and the integral of the divergence: a check")
        .not_in_table(),
    ]);
    if slides {
        let all = extremes(system, 1).into_iter();
        columns.extend(all.map(Column::not_in_table));
    }
    columns
}

/// The place of a state on an orbit: where both interfaces move alike they share one.
fn of_state(i: usize, orbit: &Orbit) -> usize {
    i.min(orbit.point.len() - 1)
}

/// The columns that orbits of interfaces have beside those of all systems.
fn of_interfaces() -> [Column<Orbit>; 4] {
    use Quantity::{SlipRate, State, Stress};
    [
        Column::uncertain("stress_min", Stress, |orbit: &Orbit| {
            orbit.stress_min.into()
        })
        .meaning("least stress of the orbit"),
        Column::uncertain("stress_max", Stress, |orbit: &Orbit| {
            orbit.stress_max.into()
        })
        .meaning("largest stress of the orbit"),
        Column::new("slip_rate_max", SlipRate, |orbit: &Orbit| {
            known(orbit.slip_rate_max).into()
        })
        .meaning("largest slip rate of an interface on the orbit"),
        Column::new("state_min", State, |orbit: &Orbit| orbit.state_min.into())
            .meaning("least ψ on the orbit"),
    ]
}

/// A largest slip rate, which is found on power series alone.
pub fn known(slip_rate: f64) -> Option<f64> {
    Some(slip_rate).filter(|v| v.is_finite())
}

/// The least and the largest value of each state, from one on.
fn extremes(system: &AnySystem, from: usize) -> Vec<Column<Orbit>> {
    let states = system.states().into_iter().take(system.moving());
    let states = states.enumerate().skip(from);
    let both = states.flat_map(|(i, name)| {
        let quantity = system.quantity(i);
        ["min", "max"]
            .into_iter()
            .enumerate()
            .map(move |(end, which)| {
                let value = move |orbit: &Orbit| orbit.extremes[of_state(i, orbit)][end].into();
                Column::uncertain(format!("{name}_{which}"), quantity, value).meaning(match end {
                    0 => "least ln ψ of interface i on the orbit",
                    _ => "largest ln ψ of interface i on the orbit",
                })
            })
    });
    both.collect()
}

/// Of one multiplier, counted from 0. Its bound is a column of its own: no unit rounds it.
fn multiplier_columns(i: usize) -> [Column<Orbit>; 4] {
    use Quantity::Number;
    let of = move |orbit: &Orbit| orbit.floquet.multipliers[i];
    let place = i + 1;
    [
        Column::new(
            format!("ln_abs_multiplier_{place}"),
            Number,
            move |orbit: &Orbit| of(orbit).ln_abs.value.into(),
        )
        .meaning("logarithm of the absolute value of multiplier i"),
        Column::new(
            format!("ln_abs_multiplier_{place}_uncertainty"),
            Number,
            move |orbit: &Orbit| of(orbit).ln_abs.uncertainty.into(),
        )
        .meaning("bound on its error")
        .not_in_table(),
        Column::new(
            format!("angle_over_pi_{place}"),
            Number,
            move |orbit: &Orbit| of(orbit).known_angle().into(),
        )
        .meaning("argument of the multiplier over π: 0 of a positive real one, 1 of a negative one"),
        Column::new(format!("kind_{place}"), Number, move |orbit: &Orbit| {
            of(orbit).kind.name().into()
        })
        .meaning("kind of multiplier i: real, complex, or below floor where it is too small for its sign to be known")
        .not_in_table(),
    ]
}

/// The columns of the derivatives of one of the orbits, in the user's units, where there are any; the others have none.
pub fn derivative_columns(
    plan: &OrbitPlan,
    of: &Orbit,
    derivatives: &[OrbitDerivatives],
) -> Vec<Column<Orbit>> {
    let states = plan.system.states();
    let column = |what: String, name: &str, slope: Option<Uncertain>| {
        let period = of.period;
        let of_it = move |orbit: &Orbit| slope.filter(|_| orbit.period == period).into();
        Column::uncertain(format!("{what}_by_{name}"), Quantity::Number, of_it)
            .meaning("derivative of it in the parameter")
            .not_in_table()
    };
    let each = derivatives.iter().flat_map(|one| {
        let name = &one.name;
        let mut columns = vec![column("period".into(), name, Some(one.period))];
        for (state, ends) in states.iter().zip(&one.extremes) {
            for (end, slope) in ["min", "max"].into_iter().zip(ends) {
                columns.push(column(format!("{state}_{end}"), name, Some(*slope)));
            }
        }
        for (j, slope) in one.ln_abs.iter().enumerate() {
            let what = format!("ln_abs_multiplier_{}", j + 1);
            columns.push(column(what, name, *slope));
        }
        columns
    });
    each.collect()
}

/// The columns of the phase response.
pub fn response_columns(system: &AnySystem) -> Vec<Column<PhaseResponse>> {
    let mut columns = vec![
        Column::new("phase", Quantity::Number, |row: &PhaseResponse| {
            row.phase.into()
        })
        .meaning("part of the period since the first point of the orbit"),
        Column::new("time", Quantity::Time, |row: &PhaseResponse| {
            row.time.into()
        })
        .meaning("time since then"),
    ];
    let states = system.states();
    columns.extend(states.iter().enumerate().map(|(i, name)| {
        let state = move |row: &PhaseResponse| row.state[i].into();
        let column = Column::new(name.clone(), system.quantity(i), state);
        column.meaning(match i {
            0 => "stress",
            _ => "ln ψ of interface i",
        })
    }));
    columns.extend(states.iter().enumerate().map(|(i, name)| {
        let response = move |row: &PhaseResponse| row.response[i].into();
        let column = Column::uncertain(format!("response_{name}"), system.response(i), response);
        column.meaning(match i {
            0 => "time by which a small kick in the stress advances the orbit, over the kick",
            _ => "the same of a kick in ln ψ of interface i",
        })
    }));
    columns
}

/// The states and the responses against the phase; of many states the responses in one panel.
pub fn picture_of_responses(system: &AnySystem, rows: &[PhaseResponse]) -> Drawing {
    let units = system.units();
    let phases: Vec<f64> = rows.iter().map(|row| row.phase).collect();
    let columns = response_columns(system);
    let count = system.states().len();
    let (states, responses) = columns[2..].split_at(count);
    let series = |label: &str, column: &Column<PhaseResponse>| {
        let values = rows.iter().map(|row| column.number(row, units));
        PlotSeries::new(label, phases.clone(), values.collect())
    };
    let panel = |title: String, name: String, quantity, series| Panel {
        series,
        ..Panel::new(
            title,
            Axis::linear("phase"),
            Axis::linear(axis_label(&name, quantity, units)),
        )
    };
    if count > MOST_PANELS {
        let all = |columns: &[Column<PhaseResponse>]| {
            let names = system.states();
            let named = columns.iter().zip(&names);
            named.map(|(column, name)| series(name, column)).collect()
        };
        let title = parameters_of(system);
        return Drawing::columns(vec![vec![
            panel(title, "states".into(), Quantity::Number, all(states)),
            panel(
                String::new(),
                "response".into(),
                Quantity::Number,
                all(responses),
            ),
        ]]);
    }
    let column = |columns: &[Column<PhaseResponse>], title: String| {
        let each = columns.iter().enumerate().map(|(i, column)| {
            let title = if i == 0 { title.clone() } else { String::new() };
            panel(
                title,
                column.name.replace('_', " "),
                column.quantity,
                vec![series("", column)],
            )
        });
        each.collect::<Vec<_>>()
    };
    Drawing::columns(vec![
        column(states, parameters_of(system)),
        column(responses, "phase response".into()),
    ])
}
