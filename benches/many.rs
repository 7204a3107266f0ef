//! Time of a step over the number of interfaces: `cargo bench --bench many` prints it for numbers from 100 to a million, on one core and on
//! all, beside the engine for a few variables where that can go.
//!
//! Runs take turns, so that what else the machine does meets all, and the shortest of each counts.

use rayon::ThreadPoolBuilder;
use std::hint::black_box;
use std::time::{Duration, Instant};
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Integrator, MAX_STEPS, Taylor, Tolerances};
use twinslip::many::{ManyInterfaces, ManyTaylor};
use twinslip::model::{Loading, two_interfaces};

/// Times that each is run.
const RUNS: usize = 3;
const TOLERANCE: f64 = 1e-10;
const UNTIL: f64 = 2.0;

/// Nanoseconds of a step and interface, and the steps.
fn timed(count: usize, cores: usize) -> (f64, usize) {
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    // As ten at the same share of V_H and the same N K: the same cycle for all.
    let share = count as f64 / 10.0;
    let loading = Loading::new(10.0 * share, 0.14 / share).expect("positive");
    let interfaces = ManyInterfaces::alike(&law, count, loading).expect("a law that ages");
    let states: Vec<f64> = (0..count)
        .map(|i| 0.002 * (1.0 + 1e-2 * (i % 97) as f64))
        .collect();
    let taylor = ManyTaylor::new(TOLERANCE, MAX_STEPS).expect("a tolerance");
    let pool = ThreadPoolBuilder::new().num_threads(cores).build();
    let pool = pool.expect("threads");
    let (mut shortest, mut steps) = (Duration::MAX, 0);
    for _ in 0..RUNS {
        let clock = Instant::now();
        let end =
            pool.install(|| taylor.flow(&interfaces, (9.9, &states), UNTIL, &mut |_| Ok(true)));
        let taken = clock.elapsed();
        steps = black_box(end).expect("a run").steps();
        shortest = shortest.min(taken);
    }
    let each = shortest.as_secs_f64() * 1e9 / (steps * count) as f64;
    (each, steps)
}

/// The same of two by the engine for a few variables.
fn two() -> f64 {
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let field = two_interfaces(law, Loading::new(2.0, 0.7).expect("positive"));
    let tolerances = Tolerances::equal(TOLERANCE).expect("positive");
    let mut taylor = Taylor::new(tolerances, MAX_STEPS).expect("steps");
    let start = State::<3>::new(9.9, 0.002_f64.ln(), 0.003_f64.ln());
    let mut shortest = Duration::MAX;
    for _ in 0..200 {
        let clock = Instant::now();
        let end = taylor.flow(&*field, (0.0, UNTIL), &start, None);
        shortest = shortest.min(clock.elapsed());
        black_box(end).expect("a run");
    }
    let steps = Integrator::<3>::work(&taylor).steps;
    shortest.as_secs_f64() * 1e9 / (2 * steps) as f64
}

fn main() {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    println!(
        "two interfaces by their own engine: {:.0} ns a step and interface",
        two()
    );
    println!("interfaces      steps   ns a step and interface: one core   {cores} cores");
    for count in [100, 1_000, 10_000, 100_000, 1_000_000] {
        let (alone, steps) = timed(count, 1);
        let (all, _) = timed(count, cores);
        println!("{count:>10} {steps:>10} {alone:>38.0} {all:>9.0}");
    }
}
