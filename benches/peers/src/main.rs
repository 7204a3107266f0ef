//! twinslip beside plain C, scipy, heyoka and other Rust crates: the same scenes, one run, one core.
//!
//! Every peer integrates every scene at many tolerances, in turn with all others, so that a busy machine disturbs all alike;
//! times are medians of thread CPU time, errors global ones at the end. Rows go to `benches/results/peers.csv`, times at
//! equal error and ratios to `benches/results/peers.md` and to standard output. Arguments choose scenes; without any, all.

mod children;
#[path = "../../common/mod.rs"]
mod common;
mod crates;
mod model;
mod ours;
mod peer;
#[path = "../../ffi_overhead/stock.rs"]
mod stock;
mod table;

use common::exact::{exact_end, exact_tangent};
use common::reach::median;
use common::results::{OK, Row, merge, read, rounded};
use common::scene::{CYCLES, Problem, SCENES, state_error};
use peer::{Answer, Peer, Question};
use std::path::Path;
use twinslip::field::{Jacobian, State};

const TOLERANCES: [f64; 8] = [1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 1e-15];
/// A run that takes longer is not repeated, nor are tighter tolerances tried.
const LIMIT: f64 = 1.0;
/// Runs are repeated until they take this long together,
const SHARE: f64 = 0.3;
/// or so many times.
const ROUNDS: usize = 7;
/// The least time that is measured as one.
const LEAST: f64 = 2e-3;

/// One peer at one tolerance while it takes its turns.
struct Entry {
    peer: Box<dyn Peer>,
    tolerance: f64,
    repeat: u32,
    times: Vec<f64>,
    row: Row,
    /// Why no tighter tolerance is tried.
    slow: Option<String>,
}

impl Entry {
    /// The first run: error, steps, and how often to repeat.
    fn begin(
        &mut self,
        scene: &str,
        tolerance: f64,
        tangent: bool,
        error: &dyn Fn(&Answer) -> f64,
    ) {
        self.times.clear();
        self.tolerance = tolerance;
        let mut row = Row::without(scene, self.peer.name(), tolerance, OK);
        match &self.slow {
            Some(reason) => row.status = format!("skipped: {reason}"),
            None => match self.peer.ask(&Question {
                tolerance,
                tangent,
                repeat: 1,
            }) {
                Ok(answer) => {
                    row.error = Some(rounded(error(&answer)));
                    row.steps = answer.steps;
                    row.seconds = Some(rounded(answer.seconds));
                    self.repeat = (LEAST / answer.seconds).clamp(1.0, 1000.0) as u32;
                    if answer.seconds > LIMIT {
                        self.slow =
                            Some(format!("took {:.2} s at {tolerance:.0e}", answer.seconds));
                    }
                }
                Err(error) => row.status = error,
            },
        }
        self.row = row;
    }

    /// One more turn, if there is anything to gain.
    fn turn(&mut self, tangent: bool) {
        let Entry {
            tolerance, repeat, ..
        } = *self;
        let spent: f64 = self.times.iter().sum::<f64>() * f64::from(repeat);
        if self.row.point().is_none() || self.slow.is_some() || spent > SHARE {
            return;
        }
        if let Ok(answer) = self.peer.ask(&Question {
            tolerance,
            tangent,
            repeat,
        }) {
            self.times.push(answer.seconds);
        }
    }

    fn end(&mut self) -> Row {
        if let Some(seconds) = median(std::mem::take(&mut self.times)) {
            self.row.seconds = Some(rounded(seconds));
        }
        let Row {
            scene,
            method,
            tolerance,
            seconds,
            error,
            status,
            ..
        } = &self.row;
        let number = |x: &Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.2e}"));
        println!(
            "{scene:15} {method:38} {tolerance:7.0e} {:>9} s, error {:>9}, {status}",
            number(seconds),
            number(error)
        );
        self.row.clone()
    }
}

/// All peers at all tolerances, in turn.
fn compare(
    scene: &str,
    peers: Vec<Box<dyn Peer>>,
    tangent: bool,
    error: &dyn Fn(&Answer) -> f64,
) -> Vec<Row> {
    let entry = |peer| Entry {
        peer,
        tolerance: 0.0,
        repeat: 1,
        times: Vec::new(),
        row: Row::without(scene, "", 0.0, ""),
        slow: None,
    };
    let mut entries: Vec<Entry> = peers.into_iter().map(entry).collect();
    let mut rows = Vec::new();
    for tolerance in TOLERANCES {
        for entry in &mut entries {
            entry.begin(scene, tolerance, tangent, error);
        }
        for _ in 0..ROUNDS {
            for entry in &mut entries {
                entry.turn(tangent);
            }
        }
        rows.extend(entries.iter_mut().map(Entry::end));
    }
    rows
}

fn flow(root: &Path, program: &stock::Program, scene: &str) -> Vec<Row> {
    let problem = Problem::load(root, scene);
    let exact = exact_end(&problem);
    let mut peers = ours::all(&problem, false);
    peers.extend(children::c(&problem, program, false));
    peers.extend(children::python(root, &problem, false));
    peers.extend(crates::all(&problem));
    compare(scene, peers, false, &|answer| {
        state_error(&State::<3>::from(answer.end), &exact)
    })
}

fn tangent(
    root: &Path,
    program: &stock::Program,
    scene: &str,
    begin: f64,
    period: f64,
) -> Vec<Row> {
    let problem = Problem::load(root, scene);
    let problem = Problem {
        start: exact_end(&problem.until(begin)),
        ..problem.until(period)
    };
    let exact = exact_tangent(&problem);
    let mut peers = ours::all(&problem, true);
    peers.extend(children::c(&problem, program, true));
    peers.extend(children::python(root, &problem, true));
    let name = format!("{scene}, tangent");
    compare(&name, peers, true, &|answer| {
        let m = answer.tangent.expect("asked for");
        let m = Jacobian::<3>::from_fn(|i, j| m[i][j]);
        (m - exact).amax() / exact.amax()
    })
}

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let chosen: Vec<String> = std::env::args().skip(1).collect();
    let wanted = |scene: &str| chosen.is_empty() || chosen.iter().any(|name| name == scene);
    let own = std::env::current_exe().expect("a path");
    let folder = own.parent().expect("a folder");
    let program = stock::Program::compile(&root, folder, stock::Clock::Cpu);
    let results = root.join("benches/results");
    let file = results.join("peers.csv");
    // Kept after every scene: a long comparison can be ended early.
    let keep =
        |rows: &[Row]| merge(&file, rows).unwrap_or_else(|error| panic!("peers.csv: {error}"));
    for scene in SCENES.into_iter().filter(|scene| wanted(scene)) {
        keep(&flow(&root, &program, scene));
    }
    for (scene, begin, period) in CYCLES.into_iter().filter(|cycle| wanted(cycle.0)) {
        keep(&tangent(&root, &program, scene, begin, period));
    }
    let rows = read(&file).unwrap_or_else(|error| panic!("peers.csv: {error}"));
    let text = table::markdown(&root, &rows);
    println!("\n{text}");
    std::fs::write(results.join("peers.md"), text).expect("benches/results can be written");
}
