//! Points of a map of regimes per second: in lanes and one by one, on one core and on two, and how the cost grows with the points.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::sweep::{Grid, Range, SweepSettings, Sweeper, UnitShare, run};

/// n x n points.
fn map(n: usize, driving: (f64, f64), stiffness: (f64, f64)) -> SweepSettings {
    let range = |(from, to): (f64, f64)| Range {
        from,
        to,
        count: n,
        log: false,
    };
    SweepSettings {
        grid: Grid::Plane {
            law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
            driving: range(driving),
            stiffness: range(stiffness),
        },
        starts: 1,
        seed: 0,
        follow: false,
        rtol: 1e-9,
        lyapunov: false,
        diagram: None,
        max_returns: 2000,
        max_steps: 10_000_000,
    }
}

/// Where the paper's tori and resonances are.
fn whole(n: usize) -> SweepSettings {
    map(n, (0.04, 0.2), (0.02, 0.25))
}

/// Where interfaces that stick come to their ends over thousands of cycles, or to rest.
fn slow(n: usize) -> SweepSettings {
    map(n, (0.01, 100.0), (0.01, 1.0))
}

/// Where all runs settle on stick-slip cycles.
fn cycles(n: usize) -> SweepSettings {
    map(n, (0.125, 0.2), (0.08, 0.25))
}

fn sweeps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sweep");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(5));
    for (name, settings) in [
        ("whole", whole(12)),
        ("slow", slow(12)),
        ("cycles", cycles(24)),
    ] {
        let points = settings.points();
        group.throughput(Throughput::Elements(points as u64));
        let mut lanes = Sweeper::new(&settings).expect("checked");
        let mut alone = Sweeper::one_by_one(&settings).expect("checked");
        for (way, sweeper) in [("lanes", &mut lanes), ("one by one", &mut alone)] {
            group.bench_function(BenchmarkId::new(way, name), |bencher| {
                bencher.iter(|| {
                    let mut rows = Vec::with_capacity(points);
                    sweeper.rows(0..points, &mut rows);
                    rows
                });
            });
        }
    }
    let over = |settings: &SweepSettings, threads: usize| {
        let stop = AtomicBool::new(false);
        let seen = &mut |_: &[_]| ControlFlow::Continue(());
        run(settings, UnitShare::from(0), Some(threads), &stop, seen).expect("checked");
    };
    let settings = cycles(48);
    group.throughput(Throughput::Elements(settings.points() as u64));
    for threads in [1, 2] {
        group.bench_function(BenchmarkId::new("threads", threads), |bencher| {
            bencher.iter(|| over(&settings, threads));
        });
    }
    for n in [16, 32, 64] {
        let settings = cycles(n);
        group.throughput(Throughput::Elements(settings.points() as u64));
        group.bench_function(BenchmarkId::new("points", n * n), |bencher| {
            bencher.iter(|| over(&settings, 1));
        });
    }
    group.finish();
}

criterion_group!(benches, sweeps);
criterion_main!(benches);
