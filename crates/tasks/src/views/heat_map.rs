//! The states of a system of many variables in time, as colours: one row for each.

use super::fit::in_digits;
use super::text::parameters_of;
use crate::scene::AnySystem;
use twinslip_output::RowList;
use twinslip_output::plot::{Axis, Cells, Panel, Shade, Swatch};

/// More states than this have no panels of their own.
pub const MOST_PANELS: usize = 8;

/// Shades on each side of the middle, and columns, at most.
const STEPS: i32 = 6;
const COLUMNS: usize = 400;
/// Below the middle and above it.
const LOW: [u8; 3] = [0, 84, 147];
const HIGH: [u8; 3] = [196, 78, 0];

/// All states between their least and their largest value: the one colour below the middle, the other above it.
pub fn states_in_time(system: &AnySystem, rows: &RowList) -> Panel {
    let column = |name: &str| rows.column(name).unwrap_or_default();
    let states = system.states();
    let states: Vec<Vec<f64>> = states.iter().map(|name| column(name)).collect();
    let all = || states.iter().flatten().copied().filter(|x| x.is_finite());
    let least = all().fold(f64::INFINITY, f64::min);
    let most = all().fold(f64::NEG_INFINITY, f64::max);
    let (middle, half) = (0.5 * (least + most), 0.5 * (most - least));
    let level = |x: f64| match half > 0.0 && x.is_finite() {
        true => ((x - middle) / half * f64::from(STEPS)).round() as i32,
        false => 0,
    };
    let (times, shown) = shown(&column("time"));
    let number = |i: usize| 0.5 + i as f64;
    let cells = Cells {
        y_edges: (0..=states.len()).map(number).collect(),
        fills: states
            .iter()
            .flat_map(|state| shown.iter().map(|&k| vec![shade(level(state[k]))]))
            .collect(),
        x_edges: times,
        swatches: vec![Swatch {
            shades: (-STEPS..=STEPS).map(shade).collect(),
            label: format!("{} to {}", in_digits(least, 3), in_digits(most, 3)),
        }],
    };
    Panel {
        cells: Some(cells),
        ..Panel::new(
            parameters_of(system),
            Axis::linear("time t"),
            Axis::linear("number of the state").within(number(0), number(states.len())),
        )
    }
}

/// White in the middle.
fn shade(level: i32) -> Shade {
    Shade {
        colour: if level < 0 { LOW } else { HIGH },
        lightness: 1.0 - f64::from(level.abs()) / f64::from(STEPS),
    }
}

/// Edges between the samples that are shown, growing, and which these are.
fn shown(times: &[f64]) -> (Vec<f64>, Vec<usize>) {
    let count = times.len().min(COLUMNS);
    let mut shown: Vec<usize> = (0..count).map(|k| k * times.len() / count).collect();
    if times.first() > times.last() {
        shown.reverse();
    }
    // Of samples at one time, as at an event, the first is enough.
    shown.dedup_by_key(|k| times[*k].to_bits());
    let at = |k: &usize| times[*k];
    let between = shown
        .windows(2)
        .map(|pair| 0.5 * (at(&pair[0]) + at(&pair[1])));
    let ends = (shown.first().map(at), shown.last().map(at));
    let edges = ends.0.into_iter().chain(between).chain(ends.1).collect();
    (edges, shown)
}
