//! Steady states of laws with any parameters: both solvers agree within their error budgets, and a brute-force scan finds
//! no state that they missed.

use proptest::prelude::*;
use twinslip::equilibrium::{Equilibrium, Solver, Symmetry, Verdict, stability, steady_states};
use twinslip::friction::{AnyLaw, Parameters, critical_stiffness, steady_stress};

const SOLVERS: &[Solver] = &[
    Solver::Newton,
    #[cfg(feature = "sundials")]
    Solver::Kinsol,
];

/// Closer to V_H/2 than this the difference of two rounded stresses has no sign to scan for.
const NEAR_HALF: f64 = 1e-4;

/// Sign changes of tau_ss(V_H - s) - tau_ss(s) on a fine grid of s < V_H/2, logarithmic towards 0 and towards V_H/2.
fn scanned(law: &AnyLaw, driving: f64) -> usize {
    let half = 0.5 * driving;
    let sign = |x: f64| steady_stress(law, half * (2.0 - x)) > steady_stress(law, half * x);
    let towards_half = (0..460).map(|i| 1.0 - NEAR_HALF * (0.02 * f64::from(i)).exp());
    let towards_zero = (1..8000).map(|i| (-0.01 * f64::from(i)).exp());
    let mut grid: Vec<f64> = towards_half
        .chain(towards_zero)
        .filter(|&x| x > 0.0 && x <= 1.0 - NEAR_HALF)
        .collect();
    grid.sort_by(f64::total_cmp);
    grid.windows(2)
        .filter(|pair| sign(pair[0]) != sign(pair[1]))
        .count()
}

fn law() -> impl Strategy<Value = AnyLaw> {
    (
        0..AnyLaw::NAMES.len(),
        0.3..3.0,
        0.0..8.0_f64,
        -6.0..-1.0_f64,
    )
        .prop_map(|(i, beta, ln_r, log_c)| {
            let p = Parameters::new(0.0349, 0.0349 * beta, 0.369, ln_r.exp(), 10f64.powf(log_c))
                .expect("valid");
            AnyLaw::named(AnyLaw::NAMES[i], p).expect("known")
        })
}

/// Asymmetric states that a scan can see.
fn scannable(found: &[Equilibrium], driving: f64) -> usize {
    let slowest = 0.5 * driving * (1.0 - NEAR_HALF);
    let seen = |e: &&Equilibrium| e.symmetry == Symmetry::Asymmetric && e.slip_rate[0] < slowest;
    found.iter().filter(seen).count()
}

proptest! {
    #[test]
    fn solvers_agree_and_nothing_is_missed(law in law(), log_v in -5.0..6.0_f64, log_k in -3.0..2.0_f64) {
        let (driving, k) = (10f64.powf(log_v), 10f64.powf(log_k));
        let found: Vec<_> = SOLVERS.iter().map(|&s| steady_states(&law, driving, 2, s).expect("solved")).collect();
        let scan = scanned(&law, driving);
        for states in &found {
            if states.complete {
                let count = scannable(&states.equilibria, driving);
                prop_assert!(count >= scan, "{count} states found, a scan shows {scan}");
                // each tangency makes two: the scan may miss pairs, never a single one
                prop_assert!((count - scan).is_multiple_of(2), "{count} states found, a scan shows {scan}");
            }
            for state in &states.equilibria {
                prop_assert!(state.residual(&law, driving) < 1e-9);
                let at = stability(&law, state, k).expect("K is valid");
                let growing = at.eigenvalues[0].re > 0.0;
                prop_assert!(at.verdict == Verdict::Undecided || growing == (at.verdict == Verdict::Unstable));
                if state.symmetry == Symmetry::Symmetric && at.verdict != Verdict::Undecided {
                    let weakens = critical_stiffness(&law, 0.5 * driving) > 0.0;
                    prop_assert_eq!(weakens, at.verdict == Verdict::Unstable);
                }
            }
        }
        if let [a, b] = &found[..] {
            prop_assert_eq!(a.equilibria.len(), b.equilibria.len());
            for (x, y) in a.equilibria.iter().zip(&b.equilibria) {
                let apart = (x.stress.value - y.stress.value).abs();
                prop_assert!(apart <= x.stress.uncertainty + y.stress.uncertainty, "{x:?} {y:?}");
                for i in 0..2 {
                    let apart = (x.slip_rate[i] - y.slip_rate[i]).abs();
                    prop_assert!(apart <= x.slip_rate_uncertainty()[i] + y.slip_rate_uncertainty()[i]);
                }
            }
        }
    }
}
