//! No step of a sweep's runs allocates.

use allocation_counter::measure;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::section::Regime;
use twinslip::sweep::{Grid, Range, SweepSettings, Sweeper};

/// Allocations from one return to the next, which are dozens of steps apart: for the state where it crosses, and for the looks
/// for an equilibrium there and every 32 steps on the way.
const PER_RETURN: u64 = 6;
/// Allocations of a look for what a run creeps to: of Newton's method, which makes vectors and matrices all along the way.
const SEARCH: u64 = 400;

#[test]
fn no_step_allocates() {
    // Just below the Hopf point of the asymmetric steady state runs return for long.
    let at = |text: &str| SweepSettings {
        grid: Grid::Plane {
            law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
            driving: Range::parse("driving", text).unwrap(),
            stiffness: Range::parse("stiffness", "0.14:0.14:1").unwrap(),
        },
        starts: 1,
        seed: 0,
        follow: false,
        rtol: 1e-9,
        lyapunov: false,
        diagram: None,
        max_returns: 4000,
        max_steps: 10_000_000,
    };
    let allocated = |text: &str| {
        let settings = at(text);
        let mut sweeper = Sweeper::new(&settings).unwrap();
        let mut rows = Vec::with_capacity(1);
        let counted = measure(|| sweeper.rows(0..1, &mut rows));
        assert_eq!(rows[0].regime, Regime::Steady);
        println!(
            "{text}: {} returns, {}",
            rows[0].returns, counted.count_total
        );
        (rows[0].returns, counted.count_total)
    };
    let between = |a: usize, b: usize| u64::try_from(b - a).expect("few");
    // Both are judged at 64 and at 128 returns, and then no more: what lies between them is returns, and steps, none of which
    // allocates.
    let [(few, short), (more, long)] =
        ["0.0630317:0.0630317:1", "0.0630319:0.0630319:1"].map(allocated);
    assert!((128..256).contains(&few) && (few + 20..256).contains(&more));
    assert!(
        long.abs_diff(short) < PER_RETURN * between(few, more),
        "{short} and {long} allocations, {few} and {more} returns"
    );
    // At 256 and at 512 it may creep to an orbit, which is looked for by Newton's method.
    let (many, longest) = allocated("0.063033:0.063033:1");
    assert!((512..1024).contains(&many), "{many}");
    assert!(
        longest - long < 2 * SEARCH + PER_RETURN * between(more, many),
        "{long} and {longest} allocations, {more} and {many} returns"
    );
}
