//! The continuation of a curve that is known in closed form: its steps, what is met on them, and why it ends.

use std::f64::consts::TAU;
use std::ops::ControlFlow::{Break, Continue};
use twinslip::continuation::{
    Continuation, Met, SolutionCurve, StepControl, Stop, WatchedFunction,
};
use twinslip::{Error, Result};

/// The unit circle, a point of it by its angle; beyond `wall` there is none.
struct Circle {
    wall: f64,
    /// Whether Newton's method knows the conditions.
    solves: bool,
    corrections: usize,
    renewed: usize,
}

const CIRCLE: Circle = Circle {
    wall: f64::INFINITY,
    solves: false,
    corrections: 0,
    renewed: 0,
};

/// Of an angle: cos - c.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cosine(f64);

impl SolutionCurve for Circle {
    type Point = f64;
    type TestFunction = Cosine;

    fn control(&self) -> StepControl {
        StepControl {
            first: 0.01,
            longest: 0.9,
            shortest: 1e-6,
            error: 0.005,
            cosine: 0.5,
            progress: 1e-3,
        }
    }

    fn correct(&mut self, from: &f64, distance: f64) -> Result<(f64, f64)> {
        self.corrections += 1;
        let to = from + distance.asin();
        if to > self.wall {
            return Err(Error::Input("behind the wall".into()));
        }
        Ok((to, 1.0 - (1.0 - distance * distance).sqrt()))
    }

    fn cosine(&self, a: &f64, b: &f64) -> f64 {
        (a - b).cos()
    }

    fn failed(&mut self, here: &f64, again: bool) -> Result<Option<f64>, Stop> {
        self.renewed += usize::from(!again);
        Ok((!again).then_some(*here))
    }

    fn value(&self, at: &f64, watch: WatchedFunction<Cosine>) -> f64 {
        match watch {
            WatchedFunction::TestFunction(Cosine(c)) => at.cos() - c,
            WatchedFunction::Turn(_) => -at.sin(),
            WatchedFunction::Value(_, value) => at.cos() - value,
            WatchedFunction::UserFunction(_) => f64::NAN,
        }
    }

    fn slopes(
        &mut self,
        at: &f64,
        watches: &[WatchedFunction<Cosine>],
        _: f64,
    ) -> Vec<Option<f64>> {
        let slope = |watch: &WatchedFunction<Cosine>| match watch {
            WatchedFunction::Turn(_) => None,
            _ => Some(-at.sin()),
        };
        watches.iter().map(slope).collect()
    }

    fn solves(&self, _: WatchedFunction<Cosine>) -> bool {
        self.solves
    }

    fn solve(
        &mut self,
        from: &f64,
        near: &f64,
        watch: WatchedFunction<Cosine>,
    ) -> Option<(f64, f64)> {
        let mut at = *near;
        for _ in 0..20 {
            let slope = match watch {
                WatchedFunction::Turn(_) => -at.cos(),
                _ => -at.sin(),
            };
            at -= self.value(&at, watch) / slope;
        }
        at.is_finite().then_some(((at - from).sin(), at))
    }
}

/// All zeros up to an angle, in their order, and where the steps ended.
fn zeros(curve: Circle, watches: &[WatchedFunction<Cosine>], end: f64) -> (Vec<f64>, Vec<f64>) {
    let (mut zeros, mut steps) = (Vec::new(), Vec::new());
    let mut continuation = Continuation::new(curve, 0.1);
    let stop = continuation.follow(watches, 1000, &mut |_, _, met| {
        match met {
            Met::Zero(_, at) if *at < end => zeros.push(*at),
            Met::Zero(..) => {}
            Met::Point(at) => steps.push(*at),
        }
        if steps.last().is_some_and(|at| *at > end) {
            Break(())
        } else {
            Continue(())
        }
    });
    assert_eq!(stop, Ok(Stop::Observer));
    (zeros, steps)
}

/// By Newton's method or in a bracket, and twice in one step too: once around the circle in eight steps.
#[test]
fn zeros_are_the_same_however_they_are_landed_on() {
    for gap in [0.3_f64, 1e-2, 1e-4, 1e-6] {
        // Two zeros next to each other, at both sides of the turn at pi.
        let near = Cosine(-(0.5 * gap).cos());
        let watches = [
            WatchedFunction::TestFunction(near),
            WatchedFunction::Turn(0),
            WatchedFunction::Value(0, 0.5),
        ];
        let half = 0.5 * TAU;
        let expected = [
            TAU / 6.0,
            half - 0.5 * gap,
            half,
            half + 0.5 * gap,
            5.0 * TAU / 6.0,
        ];
        for solves in [false, true] {
            let curve = Circle { solves, ..CIRCLE };
            let (found, _) = zeros(curve, &watches, 0.99 * TAU);
            assert_eq!(found.len(), 5, "{gap} {solves}: {found:?}");
            for (at, expected) in found.iter().zip(expected) {
                // cos is flat at pi: its rounding is so much of the angle
                let rounding = 4.0 * f64::EPSILON / gap.min(0.1);
                assert!(
                    (at - expected).abs() < rounding,
                    "{gap} {solves}: {found:?}"
                );
            }
        }
    }
}

/// The prediction's error, once steps have grown, is the one that is wanted.
#[test]
fn steps_have_the_wanted_error() {
    let (_, steps) = zeros(CIRCLE, &[], 20.0);
    let grown = steps.windows(2).skip_while(|pair| pair[1] - pair[0] < 0.09);
    let lengths: Vec<f64> = grown.map(|pair| (pair[1] - pair[0]).sin()).collect();
    assert!(lengths.len() > 100);
    for length in lengths {
        let error = 1.0 - (1.0 - length * length).sqrt();
        assert!((error / 0.005 - 1.0).abs() < 0.01, "{error}");
    }
    // Each is twice the one before until then.
    for i in 0..2 {
        let length = |i: usize| (steps[i + 1] - steps[i]).sin();
        assert!((length(i + 1) / length(i) - 2.0).abs() < 1e-9);
    }
}

#[test]
fn every_end_is_told_in_words() {
    let wall = Circle {
        wall: 2.0,
        ..CIRCLE
    };
    let mut continuation = Continuation::new(wall, 0.1);
    let end = continuation.follow(&[], 1000, &mut |_, _, _| Continue(()));
    let end = end.expect("an end");
    let Stop::StepTooSmall { length, because } = &end else {
        panic!("{end:?}");
    };
    // Down to the last step that is allowed, and after every step described anew but once.
    assert!(continuation.now <= 2.0 && continuation.now > 2.0 - 5e-6);
    assert!(*length < 1e-5 && *because == Some(Error::Input("behind the wall".into())));
    assert!(continuation.curve.renewed > 0);
    assert!(end.to_string().contains("finds no further point"), "{end}");
    // Where points are found, but no step is short enough for their directions.
    let end = Stop::StepTooSmall {
        length: 1e-9,
        because: None,
    };
    assert!(end.to_string().contains("the direction"), "{end}");
    let mut continuation = Continuation::new(CIRCLE, 0.1);
    let end = continuation.follow(&[], 7, &mut |_, _, _| Continue(()));
    assert_eq!(end, Ok(Stop::MaxPoints(7)));
    assert_eq!(continuation.curve.corrections, 7);
}
