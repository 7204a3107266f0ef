//! How much longer a run takes whose equations were read from a file than one whose equations are compiled: `cargo bench --bench
//! from_file` prints both times and their ratio.
//!
//! Runs of one kind and the other take turns, so that what else the machine does meets both, and the shortest of each counts.

use std::hint::black_box;
use std::time::{Duration, Instant};
use twinslip::field::{State, VectorField};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Integrator, MAX_STEPS, Taylor, Tolerances};
use twinslip::model::classics::Lorenz;
use twinslip::model::{Loading, Smooth, two_interfaces};
use twinslip_tasks::scene::SystemFile;

/// Two interfaces with law (35), as one would write them.
const SPINODAL: &str = include_str!("../tests/data/two-interfaces.toml");
const LORENZ: &str = include_str!("../scenes/systems/lorenz.toml");

/// Pairs of runs.
const RUNS: usize = 60;

/// The shortest times of runs by both fields, with the steps of the last.
fn compared(
    fields: [&dyn VectorField<3>; 2],
    (until, start): (f64, State<3>),
    rtol: f64,
) -> [(Duration, usize); 2] {
    let tolerances = Tolerances::equal(rtol).expect("positive");
    let mut taylor = Taylor::new(tolerances, MAX_STEPS).expect("steps");
    let mut shortest = [(Duration::MAX, 0); 2];
    for _ in 0..RUNS {
        for (field, shortest) in fields.iter().zip(&mut shortest) {
            let clock = Instant::now();
            let end = taylor.flow(*field, (0.0, until), &start, None);
            let taken = clock.elapsed();
            black_box(end).expect("a run");
            *shortest = (shortest.0.min(taken), Integrator::<3>::work(&taylor).steps);
        }
    }
    shortest
}

fn main() {
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let interfaces = two_interfaces(law, Loading::new(10.0, 0.14).expect("positive"));
    let read = |text| SystemFile::parse("bench", text).expect("a system").system;
    let (spinodal, lorenz) = (read(SPINODAL), read(LORENZ));
    let (spinodal, lorenz) = (
        spinodal.field::<3>().expect("three states"),
        lorenz.field::<3>().expect("three states"),
    );
    let compiled = Smooth {
        equations: Lorenz::classical(),
        parameters: [28.0, 8.0 / 3.0],
    };
    let slides = (100.0, State::<3>::new(9.9, -6.0, -6.2));
    let turns = (50.0, State::<3>::new(1.0, 1.0, 20.0));
    println!("system     rtol    built in: us, steps     from a file: us, steps     ratio");
    for rtol in [1e-6, 1e-8, 1e-11, 1e-14] {
        let pairs: [(&str, [&dyn VectorField<3>; 2], _); 2] = [
            ("spinodal", [&*interfaces, &spinodal], slides),
            ("lorenz", [&compiled, &lorenz], turns),
        ];
        for (name, fields, run) in pairs {
            let [(own, own_steps), (read, read_steps)] = compared(fields, run, rtol);
            let [own, read] = [own, read].map(|time| time.as_secs_f64() * 1e6);
            println!(
                "{name:<10} {rtol:<7e} {own:>9.0} {own_steps:>8} {read:>15.0} {read_steps:>8} {:>14.2}",
                read / own
            );
        }
    }
}
