//! Time of each integrator to the end of a run whose end is known to twenty digits, with the error beside it.
//!
//! One group per scene, one line per method and tolerance; compare at equal error, never at equal tolerance. Set-up is
//! outside the timed loop. The symmetric scene is the paper's runs with K = 0.05; in three dimensions it would leave the
//! symmetric subspace by rounding.

#[path = "../tests/common/trajectories.rs"]
mod trajectories;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;
use trajectories::Run;
use twinslip::field::{State, VectorField};
use twinslip::integrate::{Choice, Integrator, MAX_STEPS, Tolerances};
use twinslip::model::{symmetric, two_interfaces};

const TOLERANCES: [f64; 3] = [1e-4, 1e-6, 1e-8];

/// Relaxation oscillations, symmetric ones at small stiffness, and a stiff relaxation to the steady state.
const SCENES: [&str; 4] = [
    "A3_K0.14_VH100, t = 4",
    "D_K0.2_VH0.102_torus, t = 2000",
    "B2_K0.05_VH0.2_exact_sym, t = 2000",
    "A5_K0.14_VH1000_far, t = 200",
];

/// Every integrator of this dimension and build.
fn integrators<const N: usize>(tolerances: Tolerances) -> Vec<Box<dyn Integrator<N>>> {
    let integrator = |choice: Choice| choice.integrator(tolerances, MAX_STEPS).expect("checked");
    Choice::all().into_iter().map(integrator).collect()
}

fn measure<const N: usize>(
    criterion: &mut Criterion,
    run: &Run,
    field: &dyn VectorField<N>,
    start: &State<N>,
) {
    let mut group = criterion.benchmark_group(&run.name);
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    let t = (0.0, run.end_time);
    for tolerance in TOLERANCES {
        let tolerances = Tolerances::equal(tolerance).expect("checked");
        for mut integrator in integrators::<N>(tolerances) {
            let end = integrator.flow(field, t, start, None).expect("runs");
            let label = BenchmarkId::new(integrator.name(), format!("{tolerance:.0e}"));
            let (error, work) = (run.error(&end), integrator.work());
            println!(
                "{} {tolerance:.0e}: error {error:.1e}, {} steps, {} refused",
                integrator.name(),
                work.steps,
                work.rejected
            );
            group.bench_function(label, |bencher| {
                bencher.iter(|| integrator.flow(field, t, black_box(start), None));
            });
        }
    }
    group.finish();
}

fn work_precision(criterion: &mut Criterion) {
    for scene in SCENES {
        let run = Run::named(scene);
        if run.is_symmetric() {
            let field = symmetric(run.law, run.loading);
            let start = State::<2>::new(run.start[0], run.start[1]);
            measure::<2>(criterion, &run, &*field, &start);
        } else {
            let field = two_interfaces(run.law, run.loading);
            measure::<3>(criterion, &run, &*field, &run.start);
        }
    }
}

criterion_group!(benches, work_precision);
criterion_main!(benches);
