//! The global bifurcations of the normal form (39)-(40) at finite mu, which figure 15 shows: limits at the resonance, and other
//! methods.

use std::f64::consts::TAU;
use twinslip::bifurcation::strong_resonance::{Around, Homoclinic, ResonanceCycle};
use twinslip::field::State;
use twinslip::integrate::{
    Control, Integrator, MAX_STEPS, Rosenbrock, RosenbrockMethod, Tolerances,
};
use twinslip::model::Smooth;
use twinslip::model::normal_form::StrongResonance;

fn close(found: f64, expected: f64, relative: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off < relative, "{found} for {expected}: {off:e}");
}

/// The curves of the full system leave the resonance with the slopes of the Melnikov integrals, which are even in sqrt(-mu_2).
#[test]
fn the_curves_tend_to_their_asymptotes() {
    let ratios = |mu2: f64| {
        let global = Homoclinic::at(mu2).unwrap().mu[0] / mu2;
        let fold = ResonanceCycle::fold(mu2).unwrap().mu[0] / mu2;
        [global - 0.8, fold - StrongResonance::fold_of_cycles(1.0)]
    };
    for off in ratios(-1e-8) {
        assert!(off.abs() < 1e-9, "{off:e}");
    }
    let [near, far] = [-1e-3, -1e-2].map(ratios);
    for i in 0..2 {
        // of the first order in mu_2
        let order = (far[i] / near[i]).log10();
        assert!((order - 1.0).abs() < 1e-3, "{order}");
    }
}

/// How many cycles around the origin have amplitudes in this range, by a Rosenbrock method: how often the displacement by half a
/// turn changes its sign.
fn cycles_met(mu: [f64; 2], amplitudes: (f64, f64)) -> usize {
    let field = Smooth {
        equations: StrongResonance,
        parameters: mu,
    };
    let displacement = |amplitude: f64| {
        let tolerances = Tolerances::equal(1e-10).unwrap();
        let mut method =
            Rosenbrock::<2>::new(RosenbrockMethod::Rodas5P, tolerances, MAX_STEPS).unwrap();
        let mut back = f64::NAN;
        let start = State::<2>::new(amplitude, 0.0);
        let flow = method.flow(
            &field,
            (0.0, 1e3),
            &start,
            Some(&mut |step| {
                if !(step.y0[1] < 0.0 && step.y1[1] >= 0.0) {
                    return Ok(Control::Continue);
                }
                let (mut low, mut high) = (step.t0, step.t1);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if step.dense(middle)[1] < 0.0 {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                back = -step.dense(low)[0];
                Ok(Control::Stop)
            }),
        );
        flow.unwrap();
        assert!(back.is_finite());
        back - amplitude
    };
    const POINTS: usize = 60;
    let (from, to) = amplitudes;
    let at = |i: usize| from + (to - from) * i as f64 / POINTS as f64;
    let signs: Vec<bool> = (0..=POINTS).map(|i| displacement(at(i)) > 0.0).collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

#[test]
fn two_cycles_merge_at_the_fold() {
    for mu2 in [-0.1, -0.5] {
        let inner = Homoclinic::at(mu2).unwrap().amplitude;
        let fold = ResonanceCycle::fold(mu2).unwrap();
        let range = (1.002 * inner, 1.4 * inner);
        assert!(fold.log_multiplier.abs() < 1e-12);
        assert_eq!(cycles_met([fold.mu[0] * 1.001, mu2], range), 2);
        assert_eq!(cycles_met([fold.mu[0] * 0.999, mu2], range), 0);
    }
}

/// Cycles on both sides come to the homoclinic orbits, which are found without any cycle.
#[test]
fn cycles_end_at_the_homoclinic_orbits() {
    for mu2 in [-0.01, -0.5] {
        let global = Homoclinic::at(mu2).unwrap();
        for (around, sign) in [(Around::Beside, -1.0), (Around::Origin, 1.0)] {
            let off = |part: f64| {
                let amplitude = global.amplitude * (1.0 + sign * part);
                let cycle = ResonanceCycle::of(around, mu2, amplitude).unwrap();
                (cycle.mu[0] / global.mu[0] - 1.0).abs()
            };
            assert!(off(1e-10) < 1e-8, "{around:?} at {mu2}: {:e}", off(1e-10));
        }
    }
}

/// TR: A = 2 sqrt(-mu_1), with the frequency sqrt(mu_2); TR2: the frequency sqrt(-2 mu_2).
#[test]
fn cycles_begin_at_the_local_bifurcations() {
    let small = ResonanceCycle::of(Around::Origin, 0.4, 1e-3).unwrap();
    close(-4.0 * small.mu[0], 1e-6, 1e-5);
    close(small.period, TAU / 0.4_f64.sqrt(), 1e-5);
    assert!(small.log_multiplier < 0.0);
    let beside = ResonanceCycle::of(Around::Beside, -0.5, 0.5_f64.sqrt() + 1e-4).unwrap();
    close(beside.mu[0], -0.5, 1e-6);
    close(beside.period, TAU, 1e-5);
    assert!(beside.log_multiplier > 0.0);
    assert!(ResonanceCycle::of(Around::Beside, 0.5, 1.0).is_err());
    assert!(ResonanceCycle::of(Around::Origin, -0.5, 0.7).is_err());
    assert!(Homoclinic::at(0.1).is_err() && Homoclinic::at(f64::NAN).is_err());
}
