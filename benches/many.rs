//! Time of a step over the number of interfaces: `cargo bench --bench many` prints it for numbers from 100 to a million, on one core and on
//! all, beside the engine for a few variables where that can go; and the time of all methods against their error, for 100 and 10,000
//! interfaces. `benches/peers/many/run` runs others on the same.
//!
//! Runs take turns, so that what else the machine does meets all, and the shortest of each counts.

use rayon::ThreadPoolBuilder;
use std::hint::black_box;
use std::time::{Duration, Instant};
use twinslip::error::Result;
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Integrator, MAX_STEPS, RosenbrockMethod, Taylor, Tolerances};
#[cfg(feature = "sundials")]
use twinslip::many::ManyCvode;
use twinslip::many::{
    Beginning, ManyInterfaces, ManyMethod, ManyObserver, ManyRosenbrock, ManyStep, ManyTaylor,
    Slips,
};
use twinslip::model::{Loading, two_interfaces};

/// Times that each is run.
const RUNS: usize = 3;
const TOLERANCE: f64 = 1e-10;
const UNTIL: f64 = 2.0;

/// So many of the same share of V_H and the same N K as ten: the same cycle for all. With the states of the beginning.
fn problem(count: usize) -> (ManyInterfaces, Vec<f64>) {
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let share = count as f64 / 10.0;
    let loading = Loading::new(10.0 * share, 0.14 / share).expect("positive");
    let interfaces = ManyInterfaces::alike(law, count, loading).expect("a law that ages");
    let states = (0..count).map(|i| 0.002 * (1.0 + 1e-2 * (i % 97) as f64));
    (interfaces, states.collect())
}

/// What a run takes, at best, and what it comes to.
fn best<T>(cores: usize, run: impl Fn() -> T + Sync) -> (f64, T)
where
    T: Send,
{
    let pool = ThreadPoolBuilder::new().num_threads(cores).build();
    let pool = pool.expect("threads");
    let (mut shortest, mut made) = (Duration::MAX, None);
    for _ in 0..RUNS {
        let clock = Instant::now();
        let end = pool.install(&run);
        shortest = shortest.min(clock.elapsed());
        made = Some(black_box(end));
    }
    (shortest.as_secs_f64(), made.expect("a run"))
}

/// Nanoseconds of a step and interface, and the steps.
fn timed(count: usize, cores: usize) -> (f64, usize) {
    let (interfaces, states) = problem(count);
    let taylor = ManyTaylor::new(TOLERANCE, MAX_STEPS).expect("a tolerance");
    let (seconds, steps) = best(cores, || {
        let end = taylor.flow(&interfaces, (9.9, &states), UNTIL, &mut |_| Ok(true));
        end.expect("a run").steps()
    });
    (seconds * 1e9 / (steps * count) as f64, steps)
}

/// tau and ln psi of all at the end.
fn end(
    method: &ManyMethod,
    (interfaces, states): &(ManyInterfaces, Vec<f64>),
) -> (usize, Vec<f64>) {
    struct Last {
        count: usize,
        state: Vec<f64>,
        steps: usize,
    }
    impl ManyObserver for Last {
        fn step(&mut self, step: &dyn ManyStep) -> Result<bool> {
            self.steps += 1;
            if step.end() == UNTIL {
                let logs = (0..self.count).map(|i| step.interface(i, UNTIL)[0].ln());
                self.state = [step.stress(UNTIL)].into_iter().chain(logs).collect();
            }
            Ok(true)
        }
    }
    let mut last = Last {
        count: interfaces.count(),
        state: Vec::new(),
        steps: 0,
    };
    let beginning = Beginning::Start(9.9, states);
    let run = method.run(interfaces, beginning, UNTIL, &Slips::default(), &mut last);
    run.expect("a run");
    (last.steps, last.state)
}

/// The time of every method against its largest error, of tau over 1 + tau and of all ln psi, on one core.
fn methods(count: usize) {
    let problem = problem(count);
    let taylor = |tolerance: f64| {
        ManyMethod::Taylor(ManyTaylor::new(tolerance, MAX_STEPS).expect("a tolerance"))
    };
    let (_, known) = end(&taylor(1e-15), &problem);
    println!(
        "\n{count} interfaces until t = {UNTIL}; at the end tau = {}, ln psi_1 = {}",
        known[0], known[1]
    );
    println!("method       rtol     steps    seconds     error");
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
        let rodas =
            |method| ManyRosenbrock::new(method, tolerance, MAX_STEPS).map(ManyMethod::Rosenbrock);
        let mut all = vec![taylor(tolerance)];
        all.extend(rodas(RosenbrockMethod::Rodas5P));
        all.extend(rodas(RosenbrockMethod::Rodas4));
        #[cfg(feature = "sundials")]
        all.extend(ManyCvode::new(tolerance, MAX_STEPS).map(ManyMethod::Cvode));
        for method in all {
            let (seconds, (steps, made)) = best(1, || end(&method, &problem));
            let off = |(a, b): (&f64, &f64)| (a - b).abs();
            let stress = (made[0] - known[0]).abs() / (1.0 + known[0].abs());
            let error = made[1..]
                .iter()
                .zip(&known[1..])
                .map(off)
                .fold(stress, f64::max);
            let name = method.name();
            println!("{name:<10} {tolerance:>6.0e} {steps:>9} {seconds:>10.6} {error:>9.1e}");
        }
    }
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
    methods(100);
    methods(10_000);
}
