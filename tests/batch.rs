//! Many runs in lanes are the same runs: against one after the other, whatever shares the batch, and where some fail.

use twinslip::Error;
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Batch, BatchRun, Control, Integrator, MAX_STEPS, Taylor, Tolerances};
use twinslip::model::{Loading, two_interfaces};

fn spinodal() -> AnyLaw {
    AnyLaw::Spinodal(Parameters::heslot_1994().spinodal())
}

fn batch(law: AnyLaw, tolerance: f64) -> Batch {
    Batch::new(law, Tolerances::equal(tolerance).unwrap(), MAX_STEPS).unwrap()
}

/// Runs of very different lengths, some of them backwards.
fn sweep(n: usize) -> Vec<BatchRun> {
    let run = |i: usize| {
        let x = i as f64 / n as f64;
        let far = 0.02 + 2.0 * ((7 * i) % n) as f64 / n as f64;
        BatchRun {
            loading: Loading::new(20.0 + 100.0 * x, 0.12 + 0.05 * x).unwrap(),
            start: State::<3>::new(10.0 + x, (0.01 + 0.1 * x).ln(), (0.002 + 0.01 * x).ln()),
            t: if i % 5 == 4 {
                (1.0, 0.99)
            } else {
                (x, x + far)
            },
        }
    };
    (0..n).map(run).collect()
}

/// The blow-up of the Dieterich-Ruina law, at t = 226.641267031787.
fn blow_up() -> BatchRun {
    BatchRun {
        loading: Loading::new(1.0, 0.35).unwrap(),
        start: State::<3>::new(10.85, 1.99_f64.ln(), 2.01_f64.ln()),
        t: (0.0, 300.0),
    }
}

fn one_by_one(law: AnyLaw, tolerance: f64, runs: &[BatchRun]) -> Vec<twinslip::Result<State<3>>> {
    let mut taylor = Taylor::new(Tolerances::equal(tolerance).unwrap(), MAX_STEPS).unwrap();
    let flow =
        |run: &BatchRun| taylor.flow(&*two_interfaces(law, run.loading), run.t, &run.start, None);
    runs.iter().map(flow).collect()
}

#[test]
fn lanes_go_where_single_runs_go() {
    // Where both have the same order, and where the tolerance is less than what they may be apart.
    for tolerance in [1e-5, 1e-7, 1e-13] {
        for n in [64, 9, 1] {
            let runs = sweep(n);
            let lanes = batch(spinodal(), tolerance).flow(&runs, None);
            let single = one_by_one(spinodal(), tolerance, &runs);
            assert_eq!(lanes.len(), n);
            for ((lane, single), run) in lanes.iter().zip(&single).zip(&runs) {
                let (lane, single) = (lane.as_ref().unwrap(), single.as_ref().unwrap());
                let apart = (lane - single).amax();
                assert!(apart < 1e-10, "{run:?}: {apart:e} apart at {tolerance:e}");
            }
        }
    }
    assert!(batch(spinodal(), 1e-9).flow(&[], None).is_empty());
}

/// To the bit: in any order, with any neighbours, alone, and a second time.
#[test]
fn a_run_does_not_depend_on_its_neighbours() {
    let mut runs = sweep(37);
    // Some near tau = 0, where series are made in another way.
    for (i, run) in runs.iter_mut().enumerate().step_by(6) {
        run.start[0] = 0.05 * i as f64 - 0.7;
    }
    let mut batch = batch(spinodal(), 1e-9);
    let ends = batch.flow(&runs, None);
    assert_eq!(batch.flow(&runs, None), ends);
    let backwards: Vec<_> = runs.iter().rev().copied().collect();
    let mut reversed = batch.flow(&backwards, None);
    reversed.reverse();
    assert_eq!(reversed, ends);
    for (run, end) in runs.iter().zip(&ends) {
        assert_eq!(&batch.flow(&[*run], None)[0], end);
    }
}

#[test]
fn equal_interfaces_stay_equal() {
    let mut run = sweep(9)[3];
    run.start[2] = run.start[1];
    for end in batch(spinodal(), 1e-9).flow(&[run, sweep(9)[2], run], None) {
        let end = end.unwrap();
        assert_eq!(end[1] == end[2], end[1].to_bits() == end[2].to_bits());
    }
    let ends = batch(spinodal(), 1e-9).flow(&[run; 5], None);
    assert!(
        ends.iter()
            .all(|end| end.as_ref().unwrap()[1] == end.as_ref().unwrap()[2])
    );
}

#[test]
fn a_failure_stays_in_its_lane() {
    let law = AnyLaw::DieterichRuina(Parameters::heslot_1994().dieterich_ruina());
    let calm = |i: usize| BatchRun {
        loading: Loading::new(1.0, 2.0 + 0.1 * i as f64).unwrap(),
        start: State::<3>::new(10.85, 0.1, -0.1),
        t: (0.0, 300.0),
    };
    let mut runs: Vec<_> = (0..20).map(calm).collect();
    let alone = batch(law, 1e-10).flow(&runs, None);
    let mut bad = blow_up();
    runs[3] = bad;
    bad.start[1] = f64::NAN;
    runs[11] = bad;
    runs[12].t.1 = 0.0;
    let ends = batch(law, 1e-10).flow(&runs, None);
    for i in (0..20).filter(|i| ![3, 11, 12].contains(i)) {
        assert!(ends[i].is_ok());
        assert_eq!(ends[i], alone[i]);
    }
    match &ends[3] {
        Err(Error::BlowUp { t, .. }) => assert!((t - 226.641267031787).abs() < 1e-7, "{t}"),
        other => panic!("no blow-up: {other:?}"),
    }
    assert!(matches!(ends[11], Err(Error::NonFinite { .. })));
    assert_eq!(ends[12], Ok(runs[12].start));
    // As single runs do.
    let single = one_by_one(law, 1e-10, &runs[3..4]);
    assert!(matches!(single[0], Err(Error::BlowUp { .. })));
}

#[test]
fn too_many_steps_end_the_run_that_needs_them() {
    let tolerances = Tolerances::equal(1e-9).unwrap();
    let mut runs = sweep(16);
    let steps = |run: &BatchRun| {
        let mut batch = batch(spinodal(), 1e-9);
        batch.flow(&[*run], None)[0].as_ref().unwrap();
        batch.work().steps
    };
    runs.retain(|run| run.t.0 < run.t.1);
    let needed: Vec<_> = runs.iter().map(steps).collect();
    let mut sorted = needed.clone();
    sorted.sort_unstable();
    let limit = sorted[sorted.len() / 2];
    let ends = Batch::new(spinodal(), tolerances, limit)
        .unwrap()
        .flow(&runs, None);
    assert!(ends.iter().any(Result::is_err));
    for (end, needed) in ends.iter().zip(&needed) {
        match end {
            Ok(_) => assert!(*needed <= limit),
            Err(Error::TooManySteps { limit: named, .. }) => {
                assert!(*needed > limit && *named == limit);
            }
            Err(other) => panic!("{other}"),
        }
    }
}

/// Steps, dense output and slips of every run, and each stopped or failed by its own observer.
#[test]
fn observers_see_and_stop_single_runs() {
    let runs = sweep(20);
    let mut batch = batch(spinodal(), 1e-9);
    let unseen = batch.flow(&runs, None);
    let mut reached = vec![f64::NAN; runs.len()];
    let mut steps = vec![0; runs.len()];
    let mut observer = |run: usize, step: &twinslip::integrate::Step<'_, 3>| {
        if steps[run] == 0 {
            assert_eq!((step.t0, *step.y0), (runs[run].t.0, runs[run].start));
        } else {
            assert_eq!(step.t0, reached[run]);
        }
        reached[run] = step.t1;
        steps[run] += 1;
        let end = step.dense(step.t1);
        assert!(
            (end - step.y1).amax() < 1e-11,
            "{:e}",
            (end - step.y1).amax()
        );
        let series = step.series().expect("a Taylor method has them");
        let slips = series.slips(step.t1 - step.t0);
        let Loading { driving, stiffness } = runs[run].loading;
        // dtau = K (V_H dt - the slips)
        let expected = stiffness * (driving * (step.t1 - step.t0) - slips[0] - slips[1]);
        assert!((expected - (step.y1[0] - step.y0[0])).abs() < 1e-10);
        match (run, steps[run]) {
            (2, 3) => Ok(Control::Stop),
            (6, 5) => Err(Error::Input("enough".to_string())),
            _ => Ok(Control::Continue),
        }
    };
    let ends = batch.flow(&runs, Some(&mut observer));
    for (i, run) in runs.iter().enumerate() {
        match i {
            2 => assert!(ends[2].is_ok() && reached[2] < run.t.1 && steps[2] == 3),
            6 => assert_eq!(ends[6], Err(Error::Input("enough".to_string()))),
            _ => {
                assert_eq!(ends[i], unseen[i]);
                assert_eq!(reached[i], run.t.1);
            }
        }
    }
}

#[test]
fn wrong_tolerances_and_no_steps_are_refused() {
    let fine = Tolerances::equal(1e-9).unwrap();
    assert!(Batch::new(spinodal(), fine, 0).is_err());
    let wrong = Tolerances { rtol: -1.0, ..fine };
    assert!(Batch::new(spinodal(), wrong, MAX_STEPS).is_err());
    assert!([1, 4, 8].contains(&batch(spinodal(), 1e-9).lanes()));
}
