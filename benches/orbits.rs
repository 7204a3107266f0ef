//! Periodic orbits: one Newton step with its monodromy by each method, and a hundred orbits one after the other.
//!
//! `newton-step/ORBIT/METHOD`: a step of multiple shooting on a closed orbit, all tangents and the linear equations, at 1e-12.
//! `hundred-orbits`: K = 0.14, V_H from 1 to 100, asymmetric, each from the one before, with multipliers: what a
//! continuation code does for a branch.
#![allow(missing_docs)]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;
use twinslip::equilibrium::Symmetry;
use twinslip::field::Vector;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{AnyField, Choice, MAX_STEPS, Tolerances};
use twinslip::internals::newton_step;
use twinslip::model::Loading;
use twinslip::orbit::{
    InitialGuess, InterfaceSystem, OrbitAccuracy, Query, ShootingNodes, Tracer, close, find,
    floquet,
};

fn slab(driving: f64, stiffness: f64) -> InterfaceSystem {
    InterfaceSystem {
        law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
        interfaces: 2,
        loading: Loading::new(driving, stiffness).expect("positive"),
    }
}

/// The asymmetric orbit, closed to rounding.
fn shooting(slab: &InterfaceSystem) -> ShootingNodes {
    let query = Query {
        symmetry: Symmetry::Asymmetric,
        begin: InitialGuess::Anywhere,
    };
    let orbit = find(slab, &query, &OrbitAccuracy::of(Choice::Taylor))
        .expect("an orbit")
        .orbit;
    let nodes = orbit.nodes.into_iter().map(Vector::from_vec);
    ShootingNodes {
        nodes: nodes.collect(),
        durations: orbit.durations,
    }
}

fn tracer(name: &str, tolerance: f64) -> Tracer {
    let choice = Choice::named(name).expect("a method of this build");
    let tolerances = Tolerances::equal(tolerance).expect("valid");
    Tracer::new(choice, tolerances, MAX_STEPS).expect("valid")
}

fn newton_steps(criterion: &mut Criterion) {
    let mut methods = vec!["taylor", "rodas5p", "rodas4"];
    if cfg!(feature = "sundials") {
        methods.extend(["cvode-bdf", "cvode-adams"]);
    }
    for (name, driving, stiffness) in [("relaxation-1", 1.0, 0.14), ("small-stiffness", 0.2, 0.05)]
    {
        let slab = slab(driving, stiffness);
        let field = AnyField::new::<3>(slab.whole());
        let mut group = criterion.benchmark_group(format!("newton-step/{name}"));
        group
            .sample_size(10)
            .measurement_time(Duration::from_secs(2));
        for method in &methods {
            let mut tracer = tracer(method, 1e-12);
            let closed = shooting(&slab);
            group.bench_function(BenchmarkId::from_parameter(method), |bencher| {
                bencher.iter(|| {
                    newton_step(&mut tracer, &field, black_box(&closed)).expect("an orbit")
                });
            });
        }
    }
}

fn hundred_orbits(criterion: &mut Criterion) {
    let velocities: Vec<f64> = (0..100)
        .map(|i| 100.0_f64.powf(f64::from(i) / 99.0))
        .collect();
    let first = shooting(&slab(1.0, 0.14));
    let mut group = criterion.benchmark_group("hundred-orbits");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(3));
    group.bench_function("taylor", |bencher| {
        bencher.iter(|| {
            let mut tracer = tracer("taylor", 1e-12);
            let mut shooting = first.clone();
            let mut last = 1.0;
            let mut unstable = 0;
            for &driving in black_box(&velocities) {
                let slab = slab(driving, 0.14);
                let field = AnyField::new::<3>(slab.whole());
                // K V_H T hardly changes.
                shooting
                    .durations
                    .iter_mut()
                    .for_each(|t| *t *= last / driving);
                last = driving;
                let closed = close(&mut tracer, &field, shooting).expect("an orbit");
                let multipliers = floquet(&closed, &field);
                unstable += usize::from(multipliers.multipliers[0].ln_abs.value > 0.0);
                shooting = closed
                    .shooting
                    .meshed(&mut tracer, &field)
                    .expect("the same orbit");
            }
            unstable
        });
    });
}

criterion_group!(benches, newton_steps, hundred_orbits);
criterion_main!(benches);
