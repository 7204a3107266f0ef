//! One fit of a velocity step with 10,000 samples, from what the record shows: `cargo bench --bench fit`.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use twinslip::fit::{
    FittedRecord, FreeParameter, Intervals, Loss, Motion, Prior, Problem, Record, Sampling, Scale,
    Stretch, fit, guesses, posterior,
};
use twinslip::model::Slider;

const SAMPLES: usize = 10_000;
const FREE: [&str; 5] = [
    "stiffness",
    "direct_effect",
    "evolution_effect",
    "slip_length",
    "reference_friction",
];
const TRUTH: [f64; 9] = [3e3, 0.008, 0.0085, 1e-5, 0.6, 1.0, 1.0, 1.0, 1.0];

/// Uniform numbers about zero with a variance of 1.
fn noise() -> impl FnMut() -> f64 {
    let mut state = 88_172_645_463_325_252_u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 12_f64.sqrt()
    }
}

fn fits(criterion: &mut Criterion) {
    let slider = Slider::new("slip", 3e-6).expect("a law");
    let stretch = |span, velocity| Stretch {
        span,
        velocity: (velocity, velocity),
    };
    let motion = Motion {
        before: 3e-6,
        stretches: vec![stretch((0.0, 20.0), 3e-6), stretch((20.0, 80.0), 1e-5)],
    };
    let times = (0..SAMPLES).map(|i| 80.0 * i as f64 / (SAMPLES - 1) as f64);
    let times: Vec<f64> = times.collect();
    let quiet = Record {
        displacement: motion.displacement(&times),
        friction: vec![0.0; SAMPLES],
        weights: vec![1.0; SAMPLES],
        times,
    };
    let free = FREE.map(|name| {
        let linear = name == "reference_friction";
        FreeParameter {
            name: name.into(),
            scale: if linear {
                Scale::Linear
            } else {
                Scale::Logarithmic
            },
            bounds: if linear { (-1e9, 1e9) } else { (1e-12, 1e12) },
            of_record: None,
        }
    });
    let problem = |record| Problem::<3> {
        sliders: &slider,
        records: vec![FittedRecord {
            record,
            motion: &motion,
            parameters: TRUTH.to_vec(),
            drift: 0.0,
        }],
        free: free.to_vec(),
        loss: Loss::Linear,
    };
    let clean = {
        let problem = problem(&quiet);
        let truth = problem.variables(&TRUTH[..FREE.len()]);
        problem.friction(&truth).expect("a friction")
    };
    let mut noise = noise();
    let friction = clean.into_iter().map(|mu| mu + 2e-4 * noise());
    let record = Record {
        friction: friction.collect(),
        ..quiet.clone()
    };
    let problem = problem(&record);
    let shown = guesses(&record, &motion, 3e-6)[0];
    let start = vec![
        shown.stiffness,
        shown.direct_effect,
        shown.evolution_effect,
        shown.slip_length,
        shown.reference_friction,
    ];
    let mut group = criterion.benchmark_group("fit of 10,000 samples");
    group.sample_size(20);
    for (name, intervals) in [
        ("standard errors", Intervals::Linear),
        ("profiles", Intervals::Profile),
    ] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| fit(black_box(&problem), std::slice::from_ref(&start), intervals));
        });
    }
    let minimum = problem.variables(&TRUTH[..FREE.len()]);
    group.bench_function("friction with derivatives", |bencher| {
        bencher.iter(|| problem.response(black_box(&minimum)));
    });
    let found = fit(&problem, std::slice::from_ref(&start), Intervals::Linear).expect("a fit");
    let log = |low, high| Prior::LogUniform { low, high };
    let sampling = Sampling {
        draws: 4000,
        seed: 1,
        priors: vec![
            log(1.0, 1e7),
            log(1e-6, 1.0),
            log(1e-6, 1.0),
            log(1e-8, 1e-2),
            Prior::Uniform {
                low: 0.0,
                high: 3.0,
            },
        ],
    };
    let begin = [found.variables.clone()];
    group.sample_size(10);
    group.bench_function("4,000 draws of the posterior", |bencher| {
        bencher.iter(|| posterior(&problem, &found, &begin, black_box(&sampling), &|| true));
    });
    group.finish();
}

criterion_group!(benches, fits);
criterion_main!(benches);
