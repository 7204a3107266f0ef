//! Markdown tables of times at equal error.

use crate::common::reach::{Reached, time_to_reach};
use crate::common::results::{Row, distinct, points, time_text};
use std::fmt::Write;

/// What is compared.
pub const ERRORS: [f64; 5] = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12];
/// Plain C with stock CVODES, as `benches/peers` names it; ours there are `twinslip NAME`.
const STOCK: &str = "C cvode-bdf";

pub const HEAD: &str = "# Time to reach an error\n\n\
    Thread CPU time of one run, median, log-log interpolated between tolerances at equal error, not at equal tolerance. `-`: \
    not reached at any tolerance within the bound on time; `<=`: even the loosest tolerance errs less. In brackets: how \
    many times faster than plain C with stock CVODES (BDF) at the same error, where `benches/peers/run` measured both in turn.\n";

/// One table per scene.
pub fn tables(what: &str, titles: &[(String, String)], rows: &[Row], peers: &[Row]) -> String {
    let mut text = format!("\n## {what}\n");
    for (scene, title) in titles {
        let heads: Vec<String> = ERRORS.iter().map(|error| format!("{error:.0e}")).collect();
        let _ = write!(
            text,
            "\n### {title}\n\n| method | {} |\n",
            heads.join(" | ")
        );
        let _ = writeln!(text, "|---{}|", "|---:".repeat(ERRORS.len()));
        let here: Vec<Row> = rows.iter().filter(|r| r.scene == *scene).cloned().collect();
        for method in distinct(&here, |row| &row.method) {
            let own = points(&here, scene, &method);
            let cells = ERRORS.map(|error| {
                let ratio = ratio(peers, scene, &method, error);
                cell(time_to_reach(&own, error), ratio)
            });
            let _ = writeln!(text, "| {method} | {} |", cells.join(" | "));
        }
        for row in here.iter().filter(|row| row.point().is_none()) {
            // Skipped ones follow from the first that took too long.
            if !row.status.contains("already") {
                let Row {
                    method,
                    tolerance,
                    status,
                    ..
                } = row;
                let _ = write!(text, "\n{method} at {tolerance:.0e}: {status}\n");
            }
        }
    }
    text
}

fn cell(time: Option<Reached>, ratio: Option<f64>) -> String {
    let Some(Reached { seconds, at_most }) = time else {
        return "-".into();
    };
    let bound = if at_most { "<= " } else { "" };
    let ratio = ratio.map_or(String::new(), |ratio| match ratio {
        ratio if ratio < 10.0 => format!(" ({ratio:.1})"),
        ratio => format!(" ({ratio:.0})"),
    });
    format!("{bound}{}{ratio}", time_text(seconds))
}

/// The time of plain C over ours, both of the same run of the peers; none where either is only a bound.
fn ratio(peers: &[Row], scene: &str, method: &str, error: f64) -> Option<f64> {
    let time = |method: &str| {
        time_to_reach(&points(peers, scene, method), error)
            .filter(|reached| !reached.at_most)
            .map(|reached| reached.seconds)
    };
    Some(time(STOCK)? / time(&format!("twinslip {method}"))?)
}
