//! The curves of bifurcations over a map. They take seconds where the points of a small map take none, and they depend on the
//! model and the window alone: so they are kept in a file, in a folder of the user's for such files.
//!
//! A file is trusted only if it tells the hash of what it holds, and the key of the curve that is asked for: the version and the
//! file of the program, and all of the plan. A damaged one is computed again.

use super::super::report::Report;
use super::super::words::time;
use std::fmt::Write;
use std::fs::{self, File};
use std::io::Read;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::UNIX_EPOCH;
use twinslip::bifurcation::{Event, LocusRow};
use twinslip::equilibrium::Symmetry;
use twinslip::number::Uncertain;
use twinslip_output::{shortest, write_whole};
use twinslip_paper::hash;
use twinslip_tasks::scene::LocusPlan;

/// The folder, instead of the usual one; curves are not kept where it is empty.
const FOLDER: &str = "TWINSLIP_CACHE";
/// A larger file is none of ours.
const LARGEST: u64 = 1 << 26;

/// The curves of these plans, with their titles.
pub fn curves<'a>(plans: &'a [LocusPlan], report: &Report<'_>) -> Vec<(&'a str, Vec<LocusRow>)> {
    let mut progress = report.progress();
    progress.begin("over the map");
    let (mut computed, all) = (0, plans.len());
    let curves: Vec<(&str, Vec<LocusRow>)> = plans
        .iter()
        .enumerate()
        .map(|(i, locus)| {
            let title = locus.curve.title;
            let kept = KeptCurve::of(locus, report);
            if let Some(points) = kept.as_ref().and_then(KeptCurve::read) {
                return (title, points);
            }
            let told = |place: &str| format!("over the map: {title}, {} of {all}{place}", i + 1);
            progress.reached_at(|| told(""));
            let mut points = Vec::new();
            let followed = locus.follow(&[], &mut |event| {
                if let Event::Locus(row) = event {
                    let place = (row.driving.value, row.stiffness.value);
                    progress.reached_at(|| {
                        told(&format!(", V_H = {:.3e}, K = {:.3e}", place.0, place.1))
                    });
                    points.push(row);
                }
                match report.call.stops() {
                    true => ControlFlow::Break(()),
                    false => ControlFlow::Continue(()),
                }
            });
            computed += 1;
            match (followed, kept) {
                // A map without all of a curve is better than none.
                (Err(error), _) => {
                    progress.finish();
                    report.say(format!("of the {title} over the map: {error}"));
                    progress.begin("over the map");
                }
                (Ok(()), Some(kept)) if !report.call.stops() => kept.write(&points),
                (Ok(()), _) => {}
            }
            (title, points)
        })
        .collect();
    let seconds = progress.finish().as_secs_f64();
    if all > 0 {
        let kept = match all - computed {
            0 => String::new(),
            n => format!(", {n} of them kept from before"),
        };
        report.say(format!(
            "{all} curves of bifurcations over the map in {}{kept}",
            time(seconds)
        ));
    }
    curves
}

/// What they cost, in words; `None` where there are none.
pub fn explain(plans: &[LocusPlan]) -> Option<String> {
    let names: Vec<&str> = plans.iter().map(|locus| locus.curve.name).collect();
    let kept = match folder() {
        Some(folder) => format!("then kept in {}", folder.display()),
        None => "and again each time: there is no folder to keep them in".to_owned(),
    };
    let text = format!(
        "  curves            {}, over the window of the map: some seconds each the first time, {kept}; --curves none leaves them out",
        names.join(", ")
    );
    (!plans.is_empty()).then_some(text)
}

/// Where curves are kept; `None` where they are not.
fn folder() -> Option<PathBuf> {
    let named = |name: &str| std::env::var_os(name).map(PathBuf::from);
    if let Some(folder) = named(FOLDER) {
        return (!folder.as_os_str().is_empty()).then_some(folder);
    }
    let caches = match cfg!(windows) {
        true => named("LOCALAPPDATA"),
        false => named("XDG_CACHE_HOME").or_else(|| Some(named("HOME")?.join(".cache"))),
    };
    // A relative path would be another one in each folder.
    let caches = caches.filter(|caches| caches.is_absolute())?;
    Some(caches.join("twinslip"))
}

/// A curve that may be kept.
struct KeptCurve {
    path: PathBuf,
    key: String,
}

impl KeptCurve {
    fn of(locus: &LocusPlan, report: &Report<'_>) -> Option<Self> {
        let program = report.call.program().and_then(fs::metadata).ok()?;
        let made = program.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
        let key = format!(
            "twinslip {} of {} bytes made at {}: {locus:?}",
            env!("CARGO_PKG_VERSION"),
            program.len(),
            made.as_nanos()
        )
        .replace('\n', " ");
        let name = format!("curve-{}.csv", &hash(key.as_bytes())[..16]);
        let path = folder()?.join(name);
        Some(KeptCurve { path, key })
    }

    /// The points, if they are there and whole.
    fn read(&self) -> Option<Vec<LocusRow>> {
        let mut text = String::new();
        let file = File::open(&self.path).ok()?;
        file.take(LARGEST).read_to_string(&mut text).ok()?;
        let (told, rest) = text.split_once('\n')?;
        let (key, rows) = rest.split_once('\n')?;
        let whole = told == hash(rest.as_bytes()) && key == self.key;
        whole.then(|| rows.lines().map(point).collect())?
    }

    /// That they can't be kept is no reason to complain: they are computed again.
    fn write(&self, points: &[LocusRow]) {
        let mut rest = format!("{}\n", self.key);
        for row in points {
            let [v, k] = [row.driving.value, row.stiffness.value].map(shortest);
            let symmetry = row.symmetry.name();
            writeln!(rest, "{},{symmetry},{v},{k}", row.curve).expect("writing to a string");
        }
        let text = format!("{}\n{rest}", hash(rest.as_bytes()));
        if let Some(folder) = self.path.parent()
            && fs::create_dir_all(folder).is_ok()
        {
            let _ = write_whole(&self.path, text.as_bytes());
        }
    }
}

/// A point from its line, as far as a picture shows it.
fn point(line: &str) -> Option<LocusRow> {
    let mut cells = line.split(',');
    let curve = cells.next()?.parse().ok()?;
    let symmetry = Symmetry::named(cells.next()?)?;
    let mut number = || Some(Uncertain::new(cells.next()?.parse().ok()?, 0.0));
    let (driving, stiffness) = (number()?, number()?);
    Some(LocusRow::new(curve, symmetry, driving, stiffness))
}
