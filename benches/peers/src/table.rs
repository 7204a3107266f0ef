//! Ratios at equal error.

use crate::common::reach::{Reached, time_to_reach};
use crate::common::results::{Row, distinct, points, time_text};
use crate::common::scene::{Problem, SCENES};
use std::fmt::Write;
use std::path::Path;

const ERRORS: [f64; 5] = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12];
const OURS: &str = "twinslip ";
/// How the names of methods end that make many runs at once.
const MANY: &str = " batch";

const HEAD: &str = "# twinslip and its peers at equal error\n\n\
    One run, one core, all in turn; thread CPU time of one run, median, log-log interpolated at equal global error at the end, \
    never at equal tolerance. In brackets the time over that of the fastest method of twinslip at that error. `-`: not reached \
    at any tolerance, or not within the bound on time; `<=`: even the loosest tolerance errs less. Compile time of heyoka is \
    left out; the call from Python, some microseconds, is in its times and in those of scipy. `batch` is the time of \
    one of 8 (AVX-512) or 4 runs made at once, and its error that of the first; ratios are to the fastest method of one run.\n";

/// One table per scene.
pub fn markdown(root: &Path, rows: &[Row]) -> String {
    let mut text = HEAD.to_owned();
    let mut scenes = distinct(rows, |row| &row.scene);
    let place = |scene: &String| SCENES.iter().position(|known| known == scene);
    scenes.sort_by_key(|scene| place(scene).unwrap_or(SCENES.len()));
    for scene in scenes {
        let title = match scene.strip_suffix(", tangent") {
            Some(name) => format!("{name}: tangent flow over one cycle"),
            None => Problem::load(root, &scene).title(),
        };
        let heads: Vec<String> = ERRORS.iter().map(|error| format!("{error:.0e}")).collect();
        let _ = write!(text, "\n## {title}\n\n| | {} |\n", heads.join(" | "));
        let _ = writeln!(text, "|---{}|", "|---:".repeat(ERRORS.len()));
        let here: Vec<Row> = rows.iter().filter(|r| r.scene == scene).cloned().collect();
        let methods = distinct(&here, |row| &row.method);
        let time = |method: &str, error| time_to_reach(&points(&here, &scene, method), error);
        let best = ERRORS.map(|error| {
            methods
                .iter()
                .filter(|method| method.starts_with(OURS) && !method.ends_with(MANY))
                .filter_map(|method| time(method, error))
                .map(|reached| reached.seconds)
                .reduce(f64::min)
        });
        for method in &methods {
            let cells: Vec<String> = ERRORS
                .iter()
                .zip(best)
                .map(|(&error, best)| cell(time(method, error), best))
                .collect();
            let _ = writeln!(text, "| {method} | {} |", cells.join(" | "));
        }
    }
    text
}

fn cell(time: Option<Reached>, best: Option<f64>) -> String {
    let Some(Reached { seconds, at_most }) = time else {
        return "-".into();
    };
    let bound = if at_most { "<= " } else { "" };
    let ratio = best.map_or(String::new(), |best| match seconds / best {
        ratio if ratio < 10.0 => format!(" ({ratio:.2})"),
        ratio => format!(" ({ratio:.0})"),
    });
    format!("{bound}{}{ratio}", time_text(seconds))
}
