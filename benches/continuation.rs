//! Branches and curves of periodic orbits: what the paper's figures take, on one core, without drawing; the last of them with all
//! cores too.
//!
//! `figure-7`: both branches of orbits at K = 0.14 with all special points. `figure-12/...`: the curves of torus bifurcations
//! and period doublings with their resonances, K from 0.05 to the top, every point to 1e-9 or better; then the same with the
//! pitchforks and folds of orbits, down to K = 0.01 and to 0.001. `pitchforks`: from the top to K = 0.005, at slow driving.
#![allow(missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::ops::ControlFlow::Continue;
use std::time::Duration;
use twinslip::bifurcation::{BranchRequest, Event, LocusKind, LocusRequest, Parameter, orbits};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::model::Loading;
use twinslip::orbit::InterfaceSystem;

fn slab(stiffness: f64) -> InterfaceSystem {
    InterfaceSystem {
        law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
        interfaces: 2,
        loading: Loading::new(1.0, stiffness).expect("positive"),
    }
}

fn branches(stiffness: f64) -> usize {
    let request = BranchRequest::new(slab(stiffness), Parameter::Driving, (1e-3, 1e4));
    let mut special = 0;
    orbits::branch(&request, &mut |event| {
        special += usize::from(matches!(event, Event::Special(_)));
        Continue(())
    })
    .expect("branches");
    special
}

fn curves(kinds: &[LocusKind], driving: (f64, f64), stiffness: (f64, f64)) -> usize {
    let of_kind = |&kind| LocusRequest::new(slab(0.1), kind, driving, stiffness);
    let requests: Vec<LocusRequest> = kinds.iter().map(of_kind).collect();
    let mut points = 0;
    orbits::loci(&requests, &mut |_, event| {
        points += usize::from(matches!(event, Event::Locus(_)));
        Continue(())
    })
    .expect("curves");
    points
}

const ALL: (f64, f64) = (1e-3, 1e4);

fn figures(criterion: &mut Criterion) {
    // In a pool of threads all is done on one.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    let pool = pool.build().expect("a thread");
    let one_core = |kinds: &[LocusKind], driving, stiffness| {
        pool.install(|| curves(kinds, black_box(driving), black_box(stiffness)))
    };
    let mut group = criterion.benchmark_group("continuation");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(10));
    group.bench_function("figure-7", |b| b.iter(|| branches(black_box(0.14))));
    let both = [LocusKind::Torus, LocusKind::PeriodDoubling];
    group.bench_function("figure-12/torus+doubling", |b| {
        b.iter(|| one_core(&both, ALL, (0.05, 0.4)));
    });
    let pitchforks = LocusKind::OrbitPitchfork;
    let all = [both[0], both[1], pitchforks, LocusKind::OrbitSaddleNode];
    for (name, least) in [("all-to-0.01", 0.01), ("all-to-0.001", 0.001)] {
        group.bench_function(format!("figure-12/{name}"), |b| {
            b.iter(|| one_core(&all, ALL, (least, 0.4)));
        });
    }
    group.bench_function("pitchforks", |b| {
        b.iter(|| one_core(&[pitchforks], (1e-3, 1.25), (0.005, 0.4)));
    });
    group.bench_function("figure-12/all-to-0.001/all-cores", |b| {
        b.iter(|| curves(&all, ALL, black_box((0.001, 0.4))));
    });
    group.finish();
}

criterion_group!(benches, figures);
criterion_main!(benches);
