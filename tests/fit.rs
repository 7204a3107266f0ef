//! Fits of records whose parameters are known: derivatives, minima, errors.

use super::common::synthetic::{Chance, FAST, Making, SLOW, Shows, Synthetic};
use rayon::prelude::*;
use twinslip::fit::{
    Autoregression, DRIFT, Fit, Intervals, Loss, Motion, Problem, Record, Response, Sliders,
    Stretch, fit, guesses,
};
use twinslip::model::Slider;

const ALL: [&str; 5] = [
    "stiffness",
    "direct_effect",
    "evolution_effect",
    "slip_length",
    "reference_friction",
];
const LAWS: [&str; 4] = ["dieterich-ruina", "slip", "regularised-ageing", "spinodal"];

fn making(law: &'static str) -> Making {
    Making {
        law,
        samples: 400,
        noise: 0.02,
        memory: 0.0,
        has_drift: false,
        shows: Shows::Step,
    }
}

/// Where a search begins that reads the record alone.
fn start(synthetic: &Synthetic, free: &[&str]) -> Vec<f64> {
    let guess = guesses(&synthetic.record, &synthetic.motion, SLOW)[0];
    let of = |name: &&str| match *name {
        "stiffness" => guess.stiffness,
        "direct_effect" => guess.direct_effect,
        "evolution_effect" => guess.evolution_effect,
        "slip_length" => guess.slip_length,
        "reference_friction" => guess.reference_friction,
        DRIFT => 0.0,
        other => synthetic.value(other),
    };
    free.iter().map(of).collect()
}

#[test]
fn derivatives_are_those_of_differences_in_every_parameter() {
    for (law, states) in [
        ("spinodal", 1),
        ("bounded", 1),
        ("slip", 2),
        ("dieterich-ruina", 2),
    ] {
        let slider = Slider::new(law, SLOW).expect("a law");
        let truth = [2e3, 0.01, 0.009, 1e-5, 0.6, 50.0, 1e-3, 0.004, 6e-5];
        let stretch = |span, velocity| Stretch { span, velocity };
        let motion = Motion {
            before: SLOW,
            stretches: vec![
                stretch((0.0, 5.0), (SLOW, SLOW)),
                stretch((5.0, 8.0), (SLOW, FAST)),
                stretch((8.0, 20.0), (FAST, FAST)),
                stretch((20.0, 60.0), (3e-7, 3e-7)),
            ],
        };
        let times: Vec<f64> = (0..241).map(|i| 0.25 * f64::from(i)).collect();
        let free: Vec<usize> = (0..Slider::NAMES.len()).collect();
        let at = |parameters: &[f64]| {
            let given = (parameters, &free[..]);
            if states == 1 {
                Response::of::<3>(&slider, &motion, &times, given)
            } else {
                Response::of::<4>(&slider, &motion, &times, given)
            }
            .expect("a friction")
        };
        let here = at(&truth);
        for (j, name) in Slider::NAMES.iter().enumerate() {
            // Differences of fourth order.
            let moved = |by: f64| {
                let mut parameters = truth;
                parameters[j] *= 1.0 + by;
                at(&parameters).friction
            };
            let h = 1e-3;
            let [near_up, near_down, far_up, far_down] = [h, -h, 2.0 * h, -2.0 * h].map(moved);
            let largest = here.derivatives.column(j).amax();
            for i in 0..times.len() {
                let difference = (8.0 * (near_up[i] - near_down[i]) - (far_up[i] - far_down[i]))
                    / (12.0 * h * truth[j]);
                let off = (difference - here.derivatives[(i, j)]).abs();
                assert!(
                    off <= 1e-7 * largest,
                    "{law} {name} at {}: {off:e} of {largest:e}",
                    times[i]
                );
            }
            let has = match *name {
                "healing_time" => ["spinodal", "bounded"].contains(&law),
                "residual_strength" => law == "spinodal",
                "evolution_effect_2" | "slip_length_2" => states == 2,
                _ => true,
            };
            assert_eq!(largest > 0.0, has, "{law} {name}");
        }
    }
}

#[test]
#[cfg(feature = "sundials")]
fn sensitivities_of_cvodes_say_the_same() {
    for (seed, law) in LAWS.into_iter().enumerate() {
        let synthetic = Synthetic::new(&making(law), &mut Chance::new(seed as u64));
        let problem = synthetic.problem(&ALL);
        let truth = ALL.map(|name| synthetic.value(name));
        let difference =
            twinslip::fit::by_sensitivities(&problem, &problem.variables(&truth)).expect("a run");
        assert!(difference < 1e-7, "{law}: {difference:e}");
    }
}

/// Where nothing moves and all rates are zero to the last digit, too.
#[test]
fn a_slider_at_rest_on_its_path_has_derivatives() {
    let slider = Slider::new("slip", SLOW).expect("a law");
    let parameters = [1e4, 0.01, 0.009, 1e-5, 0.6, 1.0, 1.0, 1.0, 1.0];
    let motion = Motion {
        before: SLOW,
        stretches: vec![Stretch {
            span: (0.0, 100.0),
            velocity: (SLOW, SLOW),
        }],
    };
    let sliders: &dyn Sliders<3> = &slider;
    let free = [0, 1, 2, 3, 4];
    let found = Response::of(sliders, &motion, &[0.0, 50.0, 100.0], (&parameters, &free));
    let found = found.expect("a run");
    // At V* friction is a_v.
    for i in 0..3 {
        assert!((found.friction[i] - 0.6).abs() < 1e-15);
        for j in 0..4 {
            assert!(found.derivatives[(i, j)].abs() < 1e-12, "{i} {j}");
        }
        assert!((found.derivatives[(i, 4)] - 1.0).abs() < 1e-12);
    }
}

/// A stiff spring moves the slider as the load point moves: then friction after a step is a closed form,
/// mu = mu_0 + a ln(V/V_0) + b ln(psi/psi_0), with psi of the ageing law 1/V + (psi_0 - 1/V) e^(-V t/L), and of the slip law
/// ln(psi V) = e^(-V t/L) ln(psi_0 V).
#[test]
fn on_a_stiff_spring_friction_is_a_closed_form() {
    let (a, b, length) = (0.01, 0.013, 1e-5);
    for law in ["dieterich-ruina", "slip"] {
        let slider = Slider::new(law, SLOW).expect("a law");
        let motion = Motion {
            before: SLOW,
            stretches: vec![Stretch {
                span: (0.0, 10.0),
                velocity: (FAST, FAST),
            }],
        };
        let times: Vec<f64> = (1..=100).map(|i| 0.1 * f64::from(i)).collect();
        let sliders: &dyn Sliders<3> = &slider;
        let on = |stiffness: f64| {
            let parameters = [stiffness, a, b, length, 0.6, 1.0, 1.0, 1.0, 1.0];
            let found = Response::of(sliders, &motion, &times, (&parameters, &[]));
            found.expect("a run").friction
        };
        // The spring gives way by mu/k: its effect goes as 1/k, and by two stiffnesses is taken away.
        let (soft, stiff) = (on(1e6), on(2e6));
        let ratio = FAST / SLOW;
        for (i, &t) in times.iter().enumerate() {
            let mu = 2.0 * stiff[i] - soft[i];
            let decay = (-FAST * t / length).exp();
            let log_state = if law == "slip" {
                decay * ratio.ln() - ratio.ln()
            } else {
                (1.0 / ratio + (1.0 - 1.0 / ratio) * decay).ln()
            };
            let expected = 0.6 + a * ratio.ln() + b * log_state;
            assert!((stiff[i] - expected).abs() < 1e-4, "{law} {t}");
            assert!((mu - expected).abs() < 1e-6, "{law} {t}: {mu} {expected}");
        }
    }
}

#[test]
fn a_clean_record_gives_its_parameters_back_from_a_start_off_by_five() {
    clean_records_give_their_parameters_back(8, 0);
}

#[test]
#[ignore = "takes minutes"]
fn clean_records_give_their_parameters_back_in_98_of_100() {
    clean_records_give_their_parameters_back(100, 2);
}

/// So many records, of which this many may fail.
fn clean_records_give_their_parameters_back(count: u64, may_fail: usize) {
    let failed: Vec<String> = (0..count)
        .into_par_iter()
        .filter_map(|seed| {
            let mut chance = Chance::new(seed);
            let law = LAWS[seed as usize % LAWS.len()];
            let quiet = Making {
                noise: 1e-4,
                ..making(law)
            };
            let synthetic = Synthetic::new(&quiet, &mut chance);
            let problem = synthetic.problem(&ALL);
            let off: Vec<f64> = ALL
                .iter()
                .map(|name| match *name {
                    "reference_friction" => synthetic.value(name) * chance.between(0.9, 1.1),
                    name => {
                        let by = if chance.uniform() < 0.5 { 0.2 } else { 5.0 };
                        synthetic.value(name) * by
                    }
                })
                .collect();
            let starts = [off, start(&synthetic, &ALL)];
            let found = fit(&problem, &starts, Intervals::Linear);
            let good = |fit: &Fit| {
                fit.parameters.iter().all(|one| {
                    let truth = synthetic.value(&one.name);
                    (one.value - truth).abs() < 6.0 * one.uncertainty && fit.verdict.is_minimum
                })
            };
            match found {
                Ok(fit) if good(&fit) => None,
                other => Some(format!("{seed} {law}: {other:?}")),
            }
        })
        .collect();
    assert!(
        failed.len() <= may_fail,
        "{} of {count}:\n{}",
        failed.len(),
        failed.join("\n")
    );
}

/// Whether the intervals of each parameter hold the true value, and how many standard errors the value is off.
fn judged(making: &Making, free: &[&str], seed: u64) -> Vec<(bool, f64)> {
    let synthetic = Synthetic::new(making, &mut Chance::new(seed));
    let problem = synthetic.problem(free);
    let found = fit(&problem, &[start(&synthetic, free)], Intervals::Profile).expect("a fit");
    let each = found.parameters.iter().map(|one| {
        let truth = synthetic.value(&one.name);
        let (low, high) = one.interval;
        let variable = |x: f64| one.scale.inward(x);
        let error = one.uncertainty / one.scale.slope(one.value);
        let off = (variable(one.value) - variable(truth)) / error;
        ((low..=high).contains(&truth), off)
    });
    each.collect()
}

/// In fifty fits, whose coverage is known to some 2 per cent and each mean error to 0.14.
#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    intervals_hold_the_truth(10, (0.90, 0.99), 0.45);
}

#[test]
#[ignore = "takes minutes"]
fn intervals_hold_the_truth_in_93_to_97_of_100() {
    // A mean of 500 is known to 0.045.
    intervals_hold_the_truth(100, (0.93, 0.97), 0.1);
}

/// So many fits of each kind of record: the part of the intervals that hold the truth is between these, and the mean error of each
/// parameter, in standard errors, below this.
fn intervals_hold_the_truth(each: u64, coverage: (f64, f64), bias: f64) {
    let white = |law| Making {
        noise: 0.03,
        ..making(law)
    };
    let kinds: [(Making, &[&str]); 5] = [
        (white("dieterich-ruina"), &ALL),
        (white("slip"), &ALL),
        (
            Making {
                noise: 0.1,
                ..white("regularised-ageing")
            },
            &ALL,
        ),
        (
            Making {
                memory: 0.8,
                samples: 1200,
                ..white("slip")
            },
            &ALL,
        ),
        (
            Making {
                memory: 0.6,
                samples: 1200,
                has_drift: true,
                ..white("dieterich-ruina")
            },
            &[
                "stiffness",
                "direct_effect",
                "evolution_effect",
                "slip_length",
                "reference_friction",
                DRIFT,
            ],
        ),
    ];
    let cases: Vec<(usize, u64)> = (0..kinds.len())
        .flat_map(|kind| (0..each).map(move |seed| (kind, 1000 * (kind as u64 + 1) + seed)))
        .collect();
    let all: Vec<(usize, Vec<(bool, f64)>)> = cases
        .par_iter()
        .map(|&(kind, seed)| {
            let (making, free) = &kinds[kind];
            (kind, judged(making, free, seed))
        })
        .collect();
    for kind in 0..kinds.len() {
        let own = || {
            all.iter()
                .filter(|(of, _)| *of == kind)
                .flat_map(|(_, each)| each)
        };
        let held = own().filter(|(held, _)| *held).count() as f64 / own().count() as f64;
        println!("kind {kind}: {held}");
    }
    let flat = || all.iter().flat_map(|(_, each)| each);
    let count = flat().count() as f64;
    let held = flat().filter(|(held, _)| *held).count() as f64 / count;
    assert!((coverage.0..=coverage.1).contains(&held), "{held}");
    for (place, name) in ALL.iter().enumerate() {
        let of = || all.iter().map(|(_, each)| each[place].1);
        let mean = of().sum::<f64>() / all.len() as f64;
        println!("{name}: bias {mean}");
        assert!(mean.abs() < bias, "{name}: {mean}");
    }
}

#[test]
fn autoregressions_are_found_and_widen_errors() {
    let mut chance = Chance::new(5);
    let n = 20_000;
    let (mut x, mut all) = (0.0, Vec::with_capacity(n));
    for _ in 0..n {
        x = 0.9 * x + chance.normal();
        all.push(x);
    }
    let noise = Autoregression::of(&all);
    assert!((noise.coefficients[0] - 0.9).abs() < 0.02, "{noise:?}");
    assert!((noise.innovation - 1.0).abs() < 0.03, "{noise:?}");
    // Of a mean of such noise the variance is 1/(1 - 0.9)^2 of that of white noise of these innovations.
    assert!((noise.long_run_variance() / 100.0 - 1.0).abs() < 0.25);
    let ones = nalgebra::DMatrix::from_element(n, 1, 1.0);
    let sum = noise.covariance_of(&ones)[(0, 0)];
    assert!((sum / (n as f64 * noise.long_run_variance()) - 1.0).abs() < 1e-2);
    let white: Vec<f64> = (0..n).map(|_| chance.normal()).collect();
    let noise = Autoregression::of(&white);
    assert!((noise.long_run_variance() - 1.0).abs() < 0.1, "{noise:?}");
}

#[test]
fn what_the_data_do_not_determine_is_told() {
    let synthetic = Synthetic::new(&making("slip"), &mut Chance::new(3));
    // Before the step friction says nothing of L.
    let quiet = Record {
        times: synthetic.record.times[..90].to_vec(),
        displacement: synthetic.record.displacement[..90].to_vec(),
        friction: synthetic.record.friction[..90].to_vec(),
        weights: vec![1.0; 90],
    };
    let free = ["slip_length", "evolution_effect", "reference_friction"];
    let mut problem = synthetic.problem(&free);
    problem.records[0].record = &quiet;
    let truth: Vec<f64> = free.iter().map(|name| synthetic.value(name)).collect();
    let found = fit(&problem, &[truth], Intervals::Profile).expect("a fit");
    assert_eq!(found.verdict.name(), "undecided");
    let said = found.verdict.undecided.join("\n");
    assert!(said.contains("slip_length is not determined"), "{said}");
    assert!(
        said.contains("evolution_effect is not determined"),
        "{said}"
    );
    let known = found
        .parameters
        .iter()
        .find(|one| one.name == "reference_friction");
    let known = known.expect("it is free");
    assert!((known.value - 0.6).abs() < 5.0 * known.uncertainty);
}

#[test]
fn what_depends_on_the_undetermined_has_no_error() {
    let synthetic = Synthetic::new(&making("slip"), &mut Chance::new(3));
    let problem = synthetic.problem(&ALL);
    let truth = ALL.map(|name| synthetic.value(name)).to_vec();
    let mut found = fit(&problem, &[truth], Intervals::Linear).expect("a fit");
    let known = found.standard_errors()[4];
    found.parameters[0].uncertainty = f64::INFINITY;
    // Not 0, as a product of 0 and infinity would be read.
    assert_eq!(found.propagated(&[1.0, 0.0, 0.0, 0.0, 1.0]), f64::INFINITY);
    let error = found.propagated(&[0.0, 0.0, 0.0, 0.0, 2.0]);
    assert!((error - 2.0 * known).abs() <= 1e-12 * known, "{error}");
}

#[test]
fn outliers_count_less_where_that_is_asked() {
    let mut chance = Chance::new(8);
    let mut synthetic = Synthetic::new(&making("slip"), &mut chance);
    for i in (0..synthetic.record.friction.len()).step_by(23) {
        synthetic.record.friction[i] += 0.01 * chance.uniform();
    }
    let off = |loss: Loss| {
        let problem = Problem {
            loss,
            ..synthetic.problem(&ALL)
        };
        let found = fit(&problem, &[start(&synthetic, &ALL)], Intervals::Linear).expect("a fit");
        let level = &found.parameters[4];
        (level.value - 0.6).abs()
    };
    let scale = 1e-3;
    let plain = off(Loss::Linear);
    for loss in [
        Loss::SoftL1 { scale },
        Loss::Huber { scale },
        Loss::Cauchy { scale },
    ] {
        assert!(off(loss) < 0.5 * plain, "{loss:?}");
    }
}
