//! No step of a sweep's runs allocates. A file of its own: the counting allocator is that of the whole binary.
#![allow(missing_docs)]

use allocation_counter::measure;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::section::Regime;
use twinslip::sweep::{Grid, Range, Settings, Sweeper};

#[test]
fn no_step_allocates() {
    // Just below the Hopf point of the asymmetric steady state runs return for long.
    let at = |text: &str| Settings {
        law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
        grid: Grid::Plane {
            driving: Range::parse("driving", text).unwrap(),
            stiffness: Range::parse("stiffness", "0.14:0.14:1").unwrap(),
        },
        starts: 1,
        seed: 0,
        follow: false,
        rtol: 1e-9,
        lyapunov: false,
        max_returns: 4000,
        max_steps: 10_000_000,
    };
    let mut counts = Vec::new();
    for text in ["0.06:0.06:1", "0.063:0.063:1"] {
        let settings = at(text);
        let mut sweeper = Sweeper::new(&settings).unwrap();
        let mut rows = Vec::with_capacity(1);
        let counted = measure(|| sweeper.rows(0..1, &mut rows));
        assert_eq!(rows[0].regime, Regime::Steady);
        counts.push((rows[0].returns, counted.count_total));
    }
    let [(few, short), (many, long)] = counts[..] else {
        unreachable!();
    };
    assert!(many > few + 500, "{few} and {many} returns");
    // Some for each time that the run is judged, some hundred where it may creep to an orbit; none for its ten thousands of steps,
    // dozens of which lie between two returns.
    assert!(
        long - short < (many - few) as u64,
        "{short} and {long} allocations, {few} and {many} returns"
    );
}
