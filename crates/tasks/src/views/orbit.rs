//! What periodic orbits show.

use crate::scene::{Column, Quantity};
use twinslip::orbit::Orbit;

/// The columns of periodic orbits of so many interfaces; a table has room for what is looked at first.
pub fn orbit_columns(interfaces: usize) -> Vec<Column<Orbit>> {
    use Quantity::{LogState, Number, SlipRate, State, Stress, Time};
    let mut columns = vec![
        Column::new("symmetry", Number, |orbit: &Orbit| {
            orbit.symmetry.name().into()
        })
        .in_table_if(interfaces > 1),
        Column::uncertain("period", Time, |orbit: &Orbit| orbit.period.into()),
        Column::uncertain("stress_min", Stress, |orbit: &Orbit| {
            orbit.stress_min.into()
        }),
        Column::uncertain("stress_max", Stress, |orbit: &Orbit| {
            orbit.stress_max.into()
        }),
        Column::new("slip_rate_max", SlipRate, |orbit: &Orbit| {
            orbit.slip_rate_max.into()
        }),
        Column::new("state_min", State, |orbit: &Orbit| orbit.state_min.into()),
    ];
    for i in 0..interfaces {
        columns.extend(multiplier_columns(i));
    }
    columns.extend([
        Column::new("verdict", Number, |orbit: &Orbit| {
            orbit.verdict().name().into()
        }),
        Column::new("stress", Stress, |orbit: &Orbit| orbit.point[0].into()).not_in_table(),
    ]);
    columns.extend((1..=interfaces).map(|i| {
        Column::new(format!("log_state_{i}"), LogState, move |orbit: &Orbit| {
            // Where both interfaces move alike they share a state.
            orbit.point[i.min(orbit.point.len() - 1)].into()
        })
        .not_in_table()
    }));
    columns.extend([
        Column::new("trivial_defect", Number, |orbit: &Orbit| {
            orbit.floquet.trivial_defect.into()
        })
        .not_in_table(),
        Column::new("liouville_defect", Number, |orbit: &Orbit| {
            orbit.floquet.liouville_defect.into()
        })
        .not_in_table(),
    ]);
    columns
}

/// Of one multiplier, counted from 0. Its bound is a column of its own: no unit rounds it.
pub(super) fn multiplier_columns(i: usize) -> [Column<Orbit>; 4] {
    use Quantity::Number;
    let of = move |orbit: &Orbit| orbit.floquet.multipliers[i];
    let place = i + 1;
    [
        Column::new(
            format!("ln_abs_multiplier_{place}"),
            Number,
            move |orbit: &Orbit| of(orbit).ln_abs.value.into(),
        ),
        Column::new(
            format!("ln_abs_multiplier_{place}_uncertainty"),
            Number,
            move |orbit: &Orbit| of(orbit).ln_abs.uncertainty.into(),
        )
        .not_in_table(),
        Column::new(
            format!("angle_over_pi_{place}"),
            Number,
            move |orbit: &Orbit| of(orbit).known_angle().into(),
        ),
        Column::new(format!("kind_{place}"), Number, move |orbit: &Orbit| {
            of(orbit).kind.name().into()
        })
        .not_in_table(),
    ]
}
