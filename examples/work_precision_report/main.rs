//! Tables and pictures of what the benchmarks measured: `benches/results/*.csv` become `summary.md` and one SVG each, with
//! `--png` a PNG too. Run `cargo bench --bench work_precision` first, or `benches/report`, which does both.

#[path = "../../benches/common/mod.rs"]
mod common;
mod picture;
mod summary;

use common::results::{Row, read};
use common::scene::{Problem, SCENES};
use std::error::Error;
use std::path::Path;
use twinslip_output::write_whole;

/// Files of rows, and what they hold.
const FILES: [(&str, &str); 3] = [
    (
        "flow",
        "State at the end: error against time, every method at tolerances from 1e-3 to 1e-14",
    ),
    ("tangent", "Tangent flow over one cycle: error against time"),
    (
        "cvode_against_rosenbrock",
        "CVODE against Rosenbrock: state at the end, tolerances from 1e-4 to 1e-10",
    ),
];

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let folder = root.join("benches/results");
    let peers = read(&folder.join("peers.csv"))?;
    let mut text = summary::HEAD.to_owned();
    for (name, what) in FILES {
        let mut rows = read(&folder.join(format!("{name}.csv")))?;
        if rows.is_empty() {
            println!("{name}.csv: nothing measured yet");
            continue;
        }
        // In the order of the scenes, whatever was measured last.
        let place = |row: &Row| SCENES.iter().position(|scene| *scene == row.scene);
        rows.sort_by_key(place);
        let titles: Vec<(String, String)> = common::results::distinct(&rows, |row| &row.scene)
            .into_iter()
            .map(|scene| {
                let title = match name {
                    "tangent" => format!("{scene}, one cycle"),
                    _ => Problem::load(root, &scene).title(),
                };
                (scene, title)
            })
            .collect();
        let picture = picture::picture(what, &titles, &rows);
        let svg = picture.svg()?;
        write(&folder.join(format!("{name}.svg")), svg.as_bytes())?;
        if std::env::args().any(|argument| argument == "--png") {
            write(&folder.join(format!("{name}.png")), &picture.png()?)?;
        }
        // Peers ran the flows only.
        let peers = if name == "tangent" { &[] } else { &peers[..] };
        text += &summary::tables(what, &titles, &rows, peers);
    }
    write(&folder.join("summary.md"), text.as_bytes())
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Box<dyn Error>> {
    write_whole(path, bytes)?;
    println!("{}", path.display());
    Ok(())
}
