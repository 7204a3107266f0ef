//! Zeros along series, and the slips and stick-slip events that follow: across joints of steps, and against other methods.

use proptest::prelude::*;
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Control, Integrator, MAX_STEPS, Taylor, Tolerances};
use twinslip::model::{Loading, two_interfaces};
use twinslip::number::DoubleDouble;
use twinslip::number::polynomial::Crossing;
use twinslip::series::{Expansion, Passage, Section, Zeros};
use twinslip_tasks::scene::{IntegrateOptions, Plan, RunOutcome, Sink, SlipEvent, run};

#[derive(clap::Parser)]
struct Line {
    #[command(flatten)]
    options: IntegrateOptions,
}

struct Rows(Vec<Vec<f64>>);

impl Sink for Rows {
    fn row(&mut self, row: &[f64]) -> Control {
        self.0.push(row.to_vec());
        Control::Continue
    }
    fn reached(&mut self, _: f64) -> Control {
        Control::Continue
    }
}

fn made(arguments: &str) -> (RunOutcome, Vec<Vec<f64>>) {
    let words = std::iter::once("line").chain(arguments.split_whitespace());
    let line = <Line as clap::Parser>::parse_from(words);
    let plan = Plan::new(&line.options).expect("a plan");
    let mut rows = Rows(Vec::new());
    let outcome = run(&plan, &mut rows).expect("a run");
    assert!(outcome.failure.is_none(), "{:?}", outcome.failure);
    (outcome, rows.0)
}

/// The expansion at `from`, up to `to`, of x(t) = scale prod (t - r).
fn cut(roots: &[f64], scale: f64, from: f64, to: f64) -> Expansion<1> {
    let mut expansion = Expansion::new();
    expansion.begin = DoubleDouble::from(from);
    expansion.length = to - from;
    expansion.order = roots.len();
    let c = &mut expansion.variables[0];
    c[0] = scale;
    for (degree, root) in roots.iter().enumerate() {
        for j in (0..=degree).rev() {
            c[j + 1] += c[j];
            c[j] *= from - root;
        }
    }
    expansion
}

fn passages(roots: &[f64], scale: f64, cuts: &[f64], section: Section<'_>) -> Vec<(f64, Crossing)> {
    let mut zeros = Zeros::default();
    let mut all = Vec::new();
    for pair in cuts.windows(2) {
        let mut found: Vec<Passage> = Vec::new();
        cut(roots, scale, pair[0], pair[1]).crossings(section, None, &mut zeros, &mut found);
        all.extend(found.iter().map(|p| (pair[0] + p.time, p.crossing)));
    }
    all
}

const ZERO: Section<'static> = Section::Plane {
    normal: &[1.0],
    offset: 0.0,
};

fn assert_zeros(roots: &[f64], scale: f64, cuts: &[f64]) {
    let found = passages(roots, scale, cuts, ZERO);
    assert_eq!(found.len(), roots.len(), "{roots:?} {cuts:?}: {found:?}");
    let falls_first = (scale > 0.0) == roots.len().is_multiple_of(2);
    for (i, ((at, crossing), root)) in found.iter().zip(roots).enumerate() {
        assert!((at - root).abs() < 1e-10, "{root} at {at}");
        let falls = falls_first == (i % 2 == 0);
        let expected = [Crossing::Upwards, Crossing::Downwards][usize::from(falls)];
        assert_eq!(*crossing, expected, "{roots:?} {cuts:?}");
    }
}

#[test]
fn a_zero_at_a_joint_is_found_once() {
    for scale in [1.0, -1.0, 1e-9] {
        for roots in [vec![0.3_f64], vec![0.3, 0.7], vec![0.1, 0.3, 0.31, 0.7]] {
            for root in &roots {
                for joint in [*root, root.next_up(), root.next_down()] {
                    assert_zeros(&roots, scale, &[0.0, joint, 1.0]);
                    assert_zeros(&roots, scale, &[0.0, joint, joint.next_up(), 1.0]);
                    assert_zeros(&roots, scale, &[0.0, joint.next_down(), joint, 1.0]);
                }
            }
        }
    }
}

/// What rounding makes of the sign at a joint: whatever the two sides say, one crossing, and none where there is none.
#[test]
fn the_sides_of_a_joint_need_not_agree() {
    let step = |c: [f64; 2]| {
        let mut expansion = Expansion::<1>::new();
        (expansion.order, expansion.length) = (1, 1.0);
        expansion.variables[0][..2].copy_from_slice(&c);
        expansion
    };
    const OFF: f64 = 1e-16;
    for before in [-OFF, 0.0, OFF] {
        for after in [-OFF, 0.0, OFF] {
            let mut zeros = Zeros::default();
            let mut found = Vec::new();
            for c in [[before - 1.0, 1.0], [after, 1.0], [1.0, 1.0]] {
                step(c).crossings(ZERO, None, &mut zeros, &mut found);
            }
            let crossings: Vec<Crossing> = found.iter().map(|p| p.crossing).collect();
            assert_eq!(crossings, [Crossing::Upwards], "{before:e} {after:e}");
        }
    }
}

proptest! {
    #[test]
    fn cuts_never_change_the_count(
        gaps in prop::collection::vec(0.02..0.2_f64, 1..6),
        cuts in prop::collection::vec((0.0..1.2_f64, 0..6_usize, -1..=1_i8), 0..12),
        scale in prop::sample::select(vec![1.0, -1.0, 1e6, -1e-6]),
    ) {
        let roots: Vec<f64> = gaps
            .iter()
            .scan(0.0, |at, gap| {
                *at += gap;
                Some(*at)
            })
            .collect();
        // at random, and at roots or one unit in the last place beside them
        let mut times: Vec<f64> = cuts
            .iter()
            .map(|(at, which, side)| match (roots.get(*which), side) {
                (None, _) => *at,
                (Some(root), -1) => root.next_down(),
                (Some(root), 1) => root.next_up(),
                (Some(root), _) => *root,
            })
            .chain([0.0, 1.2])
            .collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        assert_zeros(&roots, scale, &times);
    }
}

/// The slip rate exceeds V_H by little, twice in one step: four stress extrema; where it only touches V_H, none.
#[test]
fn four_extrema_in_one_step() {
    let section = Section::Extremum { normal: &[-1.0] };
    // tau' = -(v - V_H), v - V_H = -prod (t - r)
    let of = |roots: [f64; 4]| {
        let rate = cut(&roots, -1.0, 0.0, 1.0);
        let mut tau = Expansion::<1>::new();
        (tau.order, tau.length) = (5, 1.0);
        for j in 0..=4 {
            tau.variables[0][j + 1] = -rate.variables[0][j] / (j + 1) as f64;
        }
        let mut found = Vec::new();
        tau.crossings(section, None, &mut Zeros::default(), &mut found);
        found
    };
    let roots = [0.2, 0.2001, 0.7, 0.7001];
    let found = of(roots);
    let (up, down) = (Crossing::Upwards, Crossing::Downwards);
    let crossings: Vec<Crossing> = found.iter().map(|p| p.crossing).collect();
    assert_eq!(crossings, [up, down, up, down]);
    for (passage, root) in found.iter().zip(roots) {
        assert!((passage.time - root).abs() < 1e-10);
    }
    let touching = of([0.25, 0.25, 0.75, 0.75]);
    assert!(touching.iter().all(|p| p.crossing == Crossing::Touching));
    assert_eq!(touching.len(), 2);
}

fn fields(event: &SlipEvent) -> [f64; 7] {
    let [first, second] = event.slip;
    [
        event.onset,
        event.recurrence.unwrap_or(1.0),
        event.duration,
        event.stress_drop,
        event.peak_slip_rate,
        first,
        second,
    ]
}

#[test]
fn two_methods_find_the_same_events() {
    for (arguments, least) in [
        (
            "--driving 10 --stiffness 0.14 --start 10,0.5,0.001 --until 60",
            15,
        ),
        (
            "--driving 0.2 --stiffness 0.05 --start 11.4,0.3,0.05 --until 8000",
            8,
        ),
        // small excursions that grow about the threshold
        (
            "--driving 10 --stiffness 0.14 --start near-symmetric:0.01 --until 8 --event-threshold 1",
            2,
        ),
        (
            "--law dieterich-ruina --driving 1 --stiffness 0.45 --start 10.85,1.9,2.1 --until 60 --event-threshold 1",
            1,
        ),
    ] {
        let of = |method: &str| {
            made(&format!(
                "{arguments} --events --final-only --method {method}"
            ))
            .0
            .events
        };
        let (ours, theirs) = (of("taylor --rtol 1e-13"), of("rodas5p --rtol 1e-12"));
        assert!(ours.len() >= least, "{arguments}: {}", ours.len());
        assert_eq!(ours.len(), theirs.len(), "{arguments}");
        for (a, b) in ours.iter().zip(&theirs) {
            for (i, (x, y)) in fields(a).into_iter().zip(fields(b)).enumerate() {
                let off = (x / y - 1.0).abs();
                assert!(off < 1e-9, "{arguments}: field {i}, {x} and {y}, {off:e}");
            }
        }
    }
}

#[test]
fn slips_balance_the_spring() {
    for (arguments, v_h, k, rtol) in [
        (
            "--driving 10 --stiffness 0.14 --until 100",
            10.0,
            0.14,
            1e-12,
        ),
        (
            "--driving 10 --stiffness 0.14 --until 100 --start 10,0.5,0.001",
            10.0,
            0.14,
            1e-4,
        ),
        (
            "--driving 0.2 --stiffness 0.05 --until 10000 --start 11.4,0.3,0.05",
            0.2,
            0.05,
            1e-8,
        ),
    ] {
        let (_, rows) = made(&format!(
            "{arguments} --method taylor --rtol {rtol} --columns time,stress,slip_1,slip_2"
        ));
        let stress = rows[0][1];
        for row in &rows {
            let pull = k * (v_h * row[0] - row[2] - row[3]);
            let defect = (pull - (row[1] - stress)).abs();
            let scale = stress.abs().max(k * v_h * row[0]);
            assert!(
                defect < 1e-12 * scale,
                "{arguments}: {defect:e} at {}",
                row[0]
            );
        }
    }
}

#[test]
fn slips_meet_the_reference() -> twinslip::Result<()> {
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let field = two_interfaces(law, Loading::new(0.2, 0.05)?);
    let start = State::<3>::new(11.4, 0.3_f64.ln(), 0.05_f64.ln());
    let slips = |mut method: Taylor| -> twinslip::Result<[f64; 2]> {
        let mut slips = [DoubleDouble::ZERO; 2];
        method.flow(
            &*field,
            (0.0, 500.0),
            &start,
            Some(&mut |step| {
                let series = step.series().expect("a series");
                let within = series.slips(series.length);
                slips = [0, 1].map(|i| slips[i] + within[i]);
                Ok(Control::Continue)
            }),
        )?;
        Ok(slips.map(DoubleDouble::hi))
    };
    let ours = slips(Taylor::new(Tolerances::equal(1e-14)?, MAX_STEPS)?)?;
    let reference = slips(Taylor::reference(MAX_STEPS)?)?;
    for (ours, reference) in ours.iter().zip(reference) {
        let off = (ours / reference - 1.0).abs();
        assert!(off < 1e-12, "{ours} and {reference}: {off:e}");
    }
    Ok(())
}

#[test]
fn rows_between_steps_are_ends_of_shorter_runs() {
    let columns = "--columns time,stress,log_state_1,log_state_2,slip_1,slip_2";
    let scene = format!(
        "--driving 10 --stiffness 0.14 --start 10,0.5,0.001 --method taylor --rtol 1e-13 {columns}"
    );
    let (_, rows) = made(&format!("{scene} --until 4 --points 33"));
    for row in &rows[1..] {
        let (_, end) = made(&format!("{scene} --until {} --final-only", row[0]));
        for (x, y) in row.iter().zip(&end[0]) {
            let off = (x / y - 1.0).abs();
            assert!(off < 1e-13, "at {}: {x} and {y}, {off:e}", row[0]);
        }
    }
}
