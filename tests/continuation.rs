//! Curves of zeros with known shapes: circle, cusp, pitchfork, and what lies on them.

use nalgebra::{DMatrix, DVector};
use std::ops::ControlFlow;
use twinslip::continuation::{
    CurveObserver, CurvePoint, PointKind, Settings, Start, Stop, ZeroProblem, follow,
};
use twinslip::{Error, Result};

/// One equation in one unknown, with its two derivatives.
struct Scalar<F: Fn(f64, f64) -> [f64; 3]>(F);

impl<F: Fn(f64, f64) -> [f64; 3]> ZeroProblem for Scalar<F> {
    fn dimension(&self) -> usize {
        1
    }
    fn residual(&self, u: &DVector<f64>, lambda: f64) -> Result<DVector<f64>> {
        Ok(DVector::from_element(1, (self.0)(u[0], lambda)[0]))
    }
    fn jacobian(&self, u: &DVector<f64>, lambda: f64) -> Result<DMatrix<f64>> {
        let [_, by_u, by_lambda] = (self.0)(u[0], lambda);
        Ok(DMatrix::from_row_slice(1, 2, &[by_u, by_lambda]))
    }
}

/// Test functions of a point, and how many points may be seen.
struct Look<T: Fn(&CurvePoint) -> Vec<f64>> {
    tests: T,
    patience: usize,
    ending: Option<usize>,
}

impl<T: Fn(&CurvePoint) -> Vec<f64>> CurveObserver for Look<T> {
    fn tests(&self, point: &CurvePoint) -> Result<Vec<f64>> {
        Ok((self.tests)(point))
    }
    fn ends(&self, test: usize) -> bool {
        self.ending == Some(test)
    }
    fn seen(&mut self, _: &CurvePoint, _: PointKind) -> ControlFlow<()> {
        self.patience -= 1;
        if self.patience == 0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

fn look<T: Fn(&CurvePoint) -> Vec<f64>>(tests: T) -> Look<T> {
    Look {
        tests,
        patience: usize::MAX,
        ending: None,
    }
}

fn start(u: f64, lambda: f64, direction: [f64; 2]) -> Start {
    Start {
        u: DVector::from_element(1, u),
        lambda,
        direction: DVector::from_row_slice(&direction),
        across: false,
    }
}

fn circle(u: f64, l: f64) -> [f64; 3] {
    [u * u + l * l - 1.0, 2.0 * u, 2.0 * l]
}

/// u^3 - u + lambda: folds at u = +-1/sqrt 3.
fn s_shaped(u: f64, l: f64) -> [f64; 3] {
    [u * u * u - u + l, 3.0 * u * u - 1.0, 1.0]
}

#[test]
fn a_circle_is_closed_and_has_two_folds() {
    let settings = Settings::new((-2.0, 2.0), 0.2).unwrap();
    let mut watch = look(|p| vec![p.lambda_slope(), p.u[0] - 0.6]);
    let branch = follow(
        &Scalar(circle),
        &start(1.0, 0.0, [0.0, 1.0]),
        &settings,
        &mut watch,
    )
    .unwrap();
    assert_eq!(branch.stopped, Stop::Closed);
    let marks: Vec<_> = branch
        .points
        .iter()
        .filter(|(_, mark)| *mark != PointKind::Step)
        .map(|(p, mark)| (*mark, p.u[0], p.lambda))
        .collect();
    let expected = [
        (PointKind::Begin, 1.0, 0.0),
        (PointKind::Zero(1), 0.6, 0.8),
        (PointKind::Zero(0), 0.0, 1.0),
        (PointKind::Zero(0), 0.0, -1.0),
        (PointKind::Zero(1), 0.6, -0.8),
        (PointKind::Begin, 1.0, 0.0),
    ];
    assert_eq!(marks.len(), expected.len(), "{marks:?}");
    for ((mark, u, lambda), (mark_0, u_0, lambda_0)) in marks.iter().zip(expected) {
        assert_eq!(*mark, mark_0);
        assert!(
            (u - u_0).abs() < 1e-13 && (lambda - lambda_0).abs() < 1e-13,
            "{mark:?}: {u} {lambda}"
        );
    }
    for (p, _) in &branch.points {
        assert!((p.u[0].hypot(p.lambda) - 1.0).abs() < 1e-14);
    }
}

#[test]
fn the_same_special_points_whatever_the_steps() {
    let fold = 1.0 / 3_f64.sqrt();
    let fold_lambda = fold - fold.powi(3);
    for longest in [0.8, 0.2, 0.05, 0.0125] {
        let mut settings = Settings::new((-1.0, 1.0), longest).unwrap();
        settings.wanted = vec![0.2];
        // a parabola of the unknown that is negative over 0.02 only: two zeros that a long step contains both
        let mut watch = look(|p| vec![p.lambda_slope(), (p.u[0] + 0.31) * (p.u[0] + 0.33)]);
        let begin = start(1.324717957244746, -1.0, [0.0, 1.0]);
        let branch = follow(&Scalar(s_shaped), &begin, &settings, &mut watch).unwrap();
        assert_eq!(branch.stopped, Stop::RangeEnd);
        let special: Vec<_> = branch
            .points
            .iter()
            .filter(|(_, mark)| *mark != PointKind::Step)
            .map(|(p, mark)| (*mark, p.u[0], p.lambda))
            .collect();
        let root = |guess: f64| {
            let mut u = guess;
            for _ in 0..50 {
                u -= s_shaped(u, 0.2)[0] / s_shaped(u, 0.2)[1];
            }
            u
        };
        let on = |u: f64| u - u * u * u;
        let expected = [
            (PointKind::Begin, 1.324717957244746, -1.0),
            (PointKind::Wanted(0), root(0.9), 0.2),
            (PointKind::Zero(0), fold, fold_lambda),
            (PointKind::Wanted(0), root(0.2), 0.2),
            (PointKind::Zero(1), -0.31, on(-0.31)),
            (PointKind::Zero(1), -0.33, on(-0.33)),
            (PointKind::Zero(0), -fold, -fold_lambda),
            (PointKind::Wanted(0), root(-1.1), 0.2),
            (PointKind::Highest, -1.324717957244746, 1.0),
        ];
        assert_eq!(
            special.len(),
            expected.len(),
            "longest {longest}: {special:?}"
        );
        for ((mark, u, lambda), (mark_0, u_0, lambda_0)) in special.iter().zip(expected) {
            assert_eq!(*mark, mark_0, "longest {longest}");
            assert!(
                (u - u_0).abs() < 1e-12,
                "longest {longest}, {mark:?}: {u}, not {u_0}"
            );
            assert!((lambda - lambda_0).abs() < 1e-12);
            if matches!(mark, PointKind::Wanted(_) | PointKind::Highest) {
                assert_eq!(*lambda, lambda_0, "landed exactly");
            }
        }
    }
}

/// The surface x^3 + lambda x = mu of a cusp, cut close to its tip.
#[test]
fn through_the_tip_of_a_cusp() {
    // x^3 + lambda x = 0.001: nearly a pitchfork, folds of two separate curves; the lower one has its fold
    // at x = -(0.0005)^(1/3)
    let problem = Scalar(|x: f64, l: f64| [x * x * x + l * x - 0.001, 3.0 * x * x + l, x]);
    let settings = Settings::new((-1.0, 1.0), 0.1).unwrap();
    let x = -1.0005;
    let mut watch = look(|p| vec![p.lambda_slope()]);
    let branch = follow(
        &problem,
        &start(x + 0.001, -1.0, [0.0, 1.0]),
        &settings,
        &mut watch,
    )
    .unwrap();
    assert_eq!(branch.stopped, Stop::RangeEnd);
    let folds: Vec<_> = branch
        .points
        .iter()
        .filter(|(_, m)| matches!(m, PointKind::Zero(_)))
        .collect();
    assert_eq!(folds.len(), 1);
    let tip = -(0.0005_f64).cbrt();
    assert!((folds[0].0.u[0] - tip).abs() < 1e-12);
    assert!((folds[0].0.lambda + 3.0 * tip * tip).abs() < 1e-12);
    // it came back to the end that it started from, on the other sheet
    let (end, mark) = branch.points.last().unwrap();
    assert_eq!((*mark, end.lambda), (PointKind::Lowest, -1.0));
    assert!(end.u[0] > -0.0011 && end.u[0] < -0.0009);
}

#[test]
fn straight_through_a_pitchfork() {
    // u (lambda - u^2): along u = 0 the derivative in u changes its sign at 0
    let problem = Scalar(|u: f64, l: f64| [u * (l - u * u), l - 3.0 * u * u, u]);
    let settings = Settings::new((-1.0, 1.03), 0.1).unwrap();
    let mut watch = look(|p| vec![p.lambda]);
    let branch = follow(
        &problem,
        &start(0.0, -1.0, [0.0, 1.0]),
        &settings,
        &mut watch,
    )
    .unwrap();
    assert_eq!(branch.stopped, Stop::RangeEnd);
    assert!(branch.points.iter().all(|(p, _)| p.u[0] == 0.0));
    let zeros: Vec<_> = branch
        .points
        .iter()
        .filter(|(_, m)| *m == PointKind::Zero(0))
        .collect();
    assert_eq!(zeros.len(), 1);
    assert!(zeros[0].0.lambda.abs() < 1e-15);
    assert_eq!(branch.points.last().unwrap().0.lambda, 1.03);
}

/// A branch point on a curved branch, u = lambda^2 + sin lambda: next to it the equations are singular.
#[test]
fn a_branch_point_on_a_curved_branch() {
    let problem = Scalar(|u: f64, l: f64| {
        let (w, w_l) = (u - l * l - l.sin(), -2.0 * l - l.cos());
        let v = l - 0.5 - w * w;
        [w * v, v - 2.0 * w * w, w_l * v + w * (1.0 - 2.0 * w * w_l)]
    });
    for longest in [0.5, 0.1, 0.03] {
        let settings = Settings::new((-1.0, 1.5), longest).unwrap();
        // the determinant of the equation's derivatives over the tangent
        let mut watch = look(|p| {
            let [_, by_u, by_l] = (problem.0)(p.u[0], p.lambda);
            vec![by_u * p.tangent[1] - by_l * p.tangent[0]]
        });
        let u = 1.0 - 1.0_f64.sin();
        let branch = follow(&problem, &start(u, -1.0, [0.0, 1.0]), &settings, &mut watch).unwrap();
        assert_eq!(branch.stopped, Stop::RangeEnd, "longest {longest}");
        let zeros: Vec<_> = branch
            .points
            .iter()
            .filter(|(_, m)| *m == PointKind::Zero(0))
            .collect();
        assert_eq!(zeros.len(), 1);
        assert!(
            (zeros[0].0.lambda - 0.5).abs() < 1e-9,
            "{}",
            zeros[0].0.lambda
        );
        let end = &branch.points.last().unwrap().0;
        assert!(
            (end.u[0] - 2.25 - 1.5_f64.sin()).abs() < 1e-12,
            "still on its branch"
        );
    }
}

#[test]
fn every_end_has_its_reason() {
    let settings = Settings::new((-2.0, 2.0), 0.2).unwrap();
    let begin = start(1.0, 0.0, [0.0, 1.0]);
    let mut impatient = Look {
        patience: 3,
        ..look(|_| vec![])
    };
    let branch = follow(&Scalar(circle), &begin, &settings, &mut impatient).unwrap();
    assert_eq!((branch.stopped, branch.points.len()), (Stop::Observer, 3));

    let mut ended = Look {
        ending: Some(0),
        ..look(|p| vec![p.u[0]])
    };
    let branch = follow(&Scalar(circle), &begin, &settings, &mut ended).unwrap();
    assert_eq!(branch.stopped, Stop::Ended(0));
    assert!(branch.points.last().unwrap().0.u[0].abs() < 1e-15);

    let few = Settings {
        max_points: 4,
        ..settings.clone()
    };
    let branch = follow(&Scalar(circle), &begin, &few, &mut look(|_| vec![])).unwrap();
    assert_eq!(branch.stopped, Stop::MaxPoints(4));

    // u = sqrt(1 - lambda) is not differentiable at its end
    let root = Scalar(|u: f64, l: f64| [u - (1.0 - l).sqrt(), 1.0, 0.5 / (1.0 - l).sqrt()]);
    let branch = follow(&root, &begin, &settings, &mut look(|_| vec![])).unwrap();
    let Stop::StepTooSmall { .. } = branch.stopped else {
        panic!("{:?}", branch.stopped)
    };
    let lambda = branch.points.last().unwrap().0.lambda;
    assert!((lambda - 1.0).abs() < 1e-6, "{lambda}");
}

#[test]
fn a_start_that_is_none_is_an_error() {
    let settings = Settings::new((-2.0, 2.0), 0.2).unwrap();
    let nowhere = Scalar(|u: f64, l: f64| [u * u + l * l + 1.0, 2.0 * u, 2.0 * l]);
    let found = follow(
        &nowhere,
        &start(1.0, 0.0, [0.0, 1.0]),
        &settings,
        &mut look(|_| vec![]),
    );
    assert!(
        matches!(found, Err(Error::NotConverged { .. })),
        "{found:?}"
    );
    let outside = follow(
        &Scalar(circle),
        &start(1.0, 3.0, [0.0, 1.0]),
        &settings,
        &mut look(|_| vec![]),
    );
    assert!(outside.unwrap_err().is_input());
    assert!(Settings::new((1.0, 1.0), 0.2).is_err());
    assert!(Settings::new((0.0, f64::NAN), 0.2).is_err());
    assert!(Settings::new((0.0, 1.0), -0.2).is_err());
    assert!(
        Settings {
            first_step: 1.0,
            ..settings
        }
        .checked()
        .is_err()
    );
}

/// A curved branch u = (lambda^2 + 0.3 lambda, sin lambda), turned, with a pitchfork at 0.6; derivatives are forward differences.
struct Rough;

impl Rough {
    const TURN: f64 = 0.4;

    fn turned([x, y]: [f64; 2], sign: f64) -> [f64; 2] {
        let (s, c) = (sign * Self::TURN).sin_cos();
        [c * x - s * y, s * x + c * y]
    }

    fn at(lambda: f64) -> DVector<f64> {
        let place = [lambda * lambda + 0.3 * lambda, lambda.sin()];
        DVector::from_row_slice(&Self::turned(place, 1.0))
    }

    fn value(u: &DVector<f64>, lambda: f64) -> DVector<f64> {
        let [x, y] = Self::turned([u[0], u[1]], -1.0);
        let (x, y) = (x - lambda * lambda - 0.3 * lambda, y - lambda.sin());
        let both = [x * (lambda - 0.6 - x * x), y * (0.5 * x - 1.0)];
        DVector::from_row_slice(&Self::turned(both, 1.0))
    }
}

impl ZeroProblem for Rough {
    fn dimension(&self) -> usize {
        2
    }
    fn residual(&self, u: &DVector<f64>, lambda: f64) -> Result<DVector<f64>> {
        Ok(Self::value(u, lambda))
    }
    fn jacobian(&self, u: &DVector<f64>, lambda: f64) -> Result<DMatrix<f64>> {
        let h = 1.5e-8;
        let here = Self::value(u, lambda);
        let mut all = DMatrix::zeros(2, 3);
        for j in 0..3 {
            let (mut v, mut l) = (u.clone(), lambda);
            if j < 2 {
                v[j] += h;
            } else {
                l += h;
            }
            all.set_column(j, &((Self::value(&v, l) - &here) / h));
        }
        Ok(all)
    }
}

/// With derivatives of eight digits the equations are singular within 1e-7 of the branch point, where the test function has
/// its zero: there the branch once ended, for most lengths of the steps.
#[test]
fn a_branch_point_is_passed_with_rough_derivatives() {
    for longest in [0.2, 0.1, 0.05, 0.04, 0.03, 0.02] {
        for from in [-1.0, 0.0, 0.1, 0.3] {
            let settings = Settings::new((-2.0, 1.5), longest).unwrap();
            let mut watch = look(|p| {
                let extended = Rough.jacobian(&p.u, p.lambda).unwrap();
                let mut square = extended.insert_row(2, 0.0);
                square.row_mut(2).copy_from(&p.tangent.transpose());
                vec![p.lambda_slope(), square.determinant()]
            });
            let begin = Start {
                u: Rough::at(from),
                lambda: from,
                direction: DVector::from_row_slice(&[0.0, 0.0, 1.0]),
                across: false,
            };
            let what = format!("steps up to {longest} from {from}");
            let branch = follow(&Rough, &begin, &settings, &mut watch).unwrap();
            assert_eq!(branch.stopped, Stop::RangeEnd, "{what}");
            let zeros = branch
                .points
                .iter()
                .filter(|(_, m)| *m == PointKind::Zero(1));
            let zeros: Vec<_> = zeros.map(|(p, _)| p.lambda).collect();
            assert_eq!(zeros.len(), 1, "{what}");
            assert!((zeros[0] - 0.6).abs() < 1e-6, "{what}: {}", zeros[0]);
            let (end, _) = branch.points.last().unwrap();
            let off = (&end.u - Rough::at(1.5)).amax();
            assert!(off < 1e-9, "{what}: off its branch by {off:e}");
        }
    }
}

/// Newton's method alone runs away from these: it needs damping.
#[test]
fn a_rough_start_is_good_enough() {
    type Function = fn(f64, f64) -> [f64; 3];
    let steep: Function = |u, l| {
        [
            (u - l).atan(),
            1.0 / (1.0 + (u - l).powi(2)),
            -1.0 / (1.0 + (u - l).powi(2)),
        ]
    };
    let exponential: Function = |u, l| [u.exp() - 2.0 - l, u.exp(), -1.0];
    let defined: Function = |u, l| [u.ln() - l, 1.0 / u, -1.0];
    let cases = [
        (steep, 3.0, 0.0),
        (steep, -40.0, 0.0),
        (exponential, 30.0, 2.0_f64.ln()),
        (exponential, -4.0, 2.0_f64.ln()),
        (defined, 50.0, 1.0),
    ];
    let settings = Settings::new((-1.0, 1.0), 0.1).unwrap();
    for (function, guess, zero) in cases {
        let problem = Scalar(function);
        let begin = start(guess, 0.0, [0.0, 1.0]);
        let branch = follow(&problem, &begin, &settings, &mut look(|_| vec![]))
            .unwrap_or_else(|e| panic!("from {guess}: {e}"));
        let first = branch.points[0].0.u[0];
        assert!((first - zero).abs() < 1e-13, "from {guess}: {first}");
        assert_eq!(branch.stopped, Stop::RangeEnd);
    }
}
