//! Work against precision: the time of every method at many tolerances, beside the error that it makes.
//!
//! Compare at equal error, never at equal tolerance. Three kinds of groups: `flow/SCENE`, the state at the end of each scene;
//! `tangent/SCENE`, the tangent flow over one cycle; `cvode-against-rosenbrock/SCENE`, the old rivals at every decade. Errors:
//! the largest relative one of (tau, psi1, psi2) for a state, the largest entry of |M - M*| / max |M*| for a tangent.
//!
//! Rows go to `benches/results/*.csv`; `cargo run --release --example work_precision_report` makes tables and pictures of them.

#[path = "../common/mod.rs"]
mod common;
mod measure;

use common::exact::{exact_end, exact_tangent};
use common::methods::methods;
use common::results::{Row, merge};
use common::scene::{CYCLES, Problem, SCENES, state_error};
use criterion::{Criterion, criterion_group, criterion_main};
use measure::{Task, group};
use std::hint::black_box;
use std::path::{Path, PathBuf};

const TOLERANCES: [f64; 7] = [1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14];
const DECADES: [f64; 7] = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Writes only what `cargo bench` measured, not what `cargo test` looked at.
fn keep(file: &str, rows: &[Row]) {
    if std::env::args().any(|argument| argument == "--bench") {
        let path: PathBuf = root().join("benches/results").join(file);
        merge(&path, rows).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    }
}

/// The state at the end of `scene`.
fn flow(
    criterion: &mut Criterion,
    name: &str,
    scene: &str,
    tolerances: &[f64],
    chosen: impl Fn(&str) -> bool,
) -> Vec<Row> {
    let problem = Problem::load(root(), scene);
    let exact = exact_end(&problem);
    let field = problem.field();
    let mut methods = methods();
    methods.retain(|(method, _)| chosen(method));
    let task = Task {
        scene,
        tolerances,
        run: &|integrator| {
            integrator.flow(
                &*field,
                (0.0, problem.until),
                black_box(&problem.start),
                None,
            )
        },
        error: &|y| state_error(y, &exact),
    };
    group(criterion, name, &methods, &task)
}

fn flows(criterion: &mut Criterion) {
    for scene in SCENES {
        let rows = flow(criterion, "flow", scene, &TOLERANCES, |_| true);
        keep("flow.csv", &rows);
    }
}

fn cvode_against_rosenbrock(criterion: &mut Criterion) {
    let name = "cvode-against-rosenbrock";
    let rivals = |method: &str| method.starts_with("cvode") || method.starts_with("ro");
    for scene in ["relaxation-10", "damped"] {
        let rows = flow(criterion, name, scene, &DECADES, rivals);
        keep("cvode_against_rosenbrock.csv", &rows);
    }
}

fn tangents(criterion: &mut Criterion) {
    for (scene, begin, period) in CYCLES {
        let problem = Problem::load(root(), scene);
        let problem = Problem {
            start: exact_end(&problem.until(begin)),
            ..problem.until(period)
        };
        let exact = exact_tangent(&problem);
        let field = problem.field();
        let task = Task {
            scene,
            tolerances: &TOLERANCES,
            run: &|integrator| {
                integrator.tangent_flow(&*field, (0.0, period), black_box(&problem.start))
            },
            error: &|(_, m)| (m - exact).amax() / exact.amax(),
        };
        let rows = group(criterion, "tangent", &methods(), &task);
        keep("tangent.csv", &rows);
    }
}

criterion_group!(benches, flows, cvode_against_rosenbrock, tangents);
criterion_main!(benches);
