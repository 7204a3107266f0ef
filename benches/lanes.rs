//! A sweep of 64 runs, one after the other and in lanes, side by side.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Batch, BatchRun, Integrator, MAX_STEPS, Taylor, Tolerances};
use twinslip::model::{Loading, two_interfaces};

const RUNS: usize = 64;

/// Stick-slip at 64 velocities and stiffnesses.
fn runs() -> Vec<BatchRun> {
    let run = |i: usize| {
        let x = i as f64 / RUNS as f64;
        BatchRun {
            loading: Loading::new(100.0 * (1.0 + x), 0.12 + 0.03 * x).expect("positive"),
            start: State::<3>::new(10.0 + x, (0.01 + 0.1 * x).ln(), (0.001 + 0.01 * x).ln()),
            t: (0.0, 2.0 + x),
        }
    };
    (0..RUNS).map(run).collect()
}

fn sweeps(criterion: &mut Criterion) {
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let runs = runs();
    let fields: Vec<_> = runs
        .iter()
        .map(|run| two_interfaces(law, run.loading))
        .collect();
    let mut group = criterion.benchmark_group("64 runs");
    group
        .sample_size(20)
        .measurement_time(Duration::from_secs(2));
    for tolerance in [1e-5, 1e-9, 1e-13] {
        let tolerances = Tolerances::equal(tolerance).expect("checked");
        let mut taylor = Taylor::new(tolerances, MAX_STEPS).expect("checked");
        let mut batch = Batch::new(law, tolerances, MAX_STEPS).expect("checked");
        let label = |name: &str| BenchmarkId::new(name, format!("{tolerance:.0e}"));
        group.bench_function(label("one by one"), |bencher| {
            bencher.iter(|| {
                for (run, field) in runs.iter().zip(&fields) {
                    let end = taylor.flow(&**field, run.t, &run.start, None);
                    black_box(end).expect("runs");
                }
            });
        });
        group.bench_function(label(&format!("{} lanes", batch.lanes())), |bencher| {
            bencher.iter(|| batch.flow(black_box(&runs), None));
        });
    }
    group.finish();
}

criterion_group!(benches, sweeps);
criterion_main!(benches);
