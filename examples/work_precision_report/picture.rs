//! Work-precision diagrams: panels of points joined by lines, both axes logarithmic.

use crate::common::results::{Row, distinct};
use twinslip_output::plot::{Axis, Block, Drawing, Key, Mark, Panel, PlotSeries, Symbol};

const COLUMNS: usize = 3;
/// Of the errors that are shown; smaller ones stand at the end.
const ERRORS: (f64, f64) = (1e-16, 1.0);
/// From this error on no digit is right: such points are not drawn.
const WRONG: f64 = 0.5;

/// How the points of a method look.
struct Look {
    method: &'static str,
    colour: usize,
    symbol: Symbol,
    filled: bool,
}

const fn look(method: &'static str, colour: usize, symbol: Symbol, filled: bool) -> Look {
    Look {
        method,
        colour,
        symbol,
        filled,
    }
}

/// What `auto` chose has a line and points of its own already: it is a dot on these.
const CHOOSES: &str = "auto";
const LOOKS: [Look; 7] = [
    look("taylor", 1, Symbol::Diamond, true),
    look("rodas5p", 0, Symbol::Square, true),
    look("rodas4", 4, Symbol::Triangle, true),
    look("rosenbrock23", 2, Symbol::Plus, true),
    look("cvode-bdf", 5, Symbol::Star, true),
    look("cvode-adams", 3, Symbol::Square, false),
    look(CHOOSES, 7, Symbol::Dot, true),
];

/// The picture of all scenes.
pub fn picture(title: &str, titles: &[(String, String)], rows: &[Row]) -> Drawing {
    let times = decades(rows);
    let mut columns = vec![Vec::new(); titles.len().min(COLUMNS)];
    for (i, (scene, title)) in titles.iter().enumerate() {
        let here: Vec<&Row> = rows.iter().filter(|row| row.scene == *scene).collect();
        columns[i % COLUMNS].push(panel(title, times, &here));
    }
    // The first panel's legend is that of all.
    let known = distinct(rows, |row| &row.method);
    let looks = LOOKS
        .iter()
        .filter(|look| known.iter().any(|method| method == look.method));
    columns[0][0].keys = looks
        .map(|look| Key {
            symbol: look.symbol,
            filled: look.filled,
            colour: Some(look.colour),
            label: look.method.to_owned(),
        })
        .collect();
    let title = title.to_owned();
    Drawing::blocks(vec![Block { title, columns }])
}

/// (time, error) of a row that is drawn.
fn drawn(row: &Row) -> Option<(f64, f64)> {
    let (error, time) = row.point().filter(|&(error, _)| error < WRONG)?;
    Some((time, error.max(ERRORS.0)))
}

/// Powers of ten around all times: the same for all panels, so that scenes can be compared.
fn decades(rows: &[Row]) -> (f64, f64) {
    let times = || rows.iter().filter_map(drawn).map(|point| point.0.log10());
    let (lo, hi) = (
        times().fold(f64::INFINITY, f64::min),
        times().fold(f64::NEG_INFINITY, f64::max),
    );
    (10_f64.powf(lo.floor()), 10_f64.powf(hi.ceil()))
}

fn panel(title: &str, times: (f64, f64), rows: &[&Row]) -> Panel {
    let mut panel = Panel::new(
        title,
        Axis::log("CPU time of a run [s]").within(times.0, times.1),
        Axis::log("largest relative error").within(ERRORS.0, ERRORS.1),
    );
    for look in &LOOKS {
        let of_method = rows.iter().filter(|row| row.method == look.method);
        let points: Vec<(f64, f64)> = of_method.filter_map(|row| drawn(row)).collect();
        let (x, y) = points.iter().copied().unzip();
        if look.method != CHOOSES {
            panel
                .series
                .push(PlotSeries::new("", x, y).colour(look.colour));
        }
        panel.marks.extend(points.iter().map(|&(x, y)| Mark {
            filled: look.filled,
            ..Mark::new(x, y, "").symbol(look.symbol).colour(look.colour)
        }));
    }
    panel
}
