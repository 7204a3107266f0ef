//! Equilibria of textbook systems along a parameter: known pitchforks, folds and Hopf points.

use nalgebra::Complex;
use std::ops::ControlFlow;
use twinslip::Error;
use twinslip::bifurcation::Label;
use twinslip::bifurcation::equilibria::generic::{FieldEquilibria, FoundEquilibrium, Onward};
use twinslip::bifurcation::equilibria::generic_curve::{
    EquilibriumBifurcation, EquilibriumCurve, EquilibriumCurvePoint,
};
use twinslip::continuation::{Settings, Stop};
use twinslip::field::{Jacobian, State, Vector, VectorField, vector};
use twinslip::integrate::AnyField;
use twinslip::model::classics;
use twinslip::number::Real;
use twinslip::orbit::{OverParameters, ParametrisedField};
use twinslip::series::Equations;

/// Lorenz (1963), sigma = 10, beta = 8/3.
struct Lorenz {
    rho: f64,
}

impl VectorField<3> for Lorenz {
    fn f(&self, y: &State<3>) -> State<3> {
        State::<3>::new(
            10.0 * (y[1] - y[0]),
            y[0] * (self.rho - y[2]) - y[1],
            y[0] * y[1] - 8.0 / 3.0 * y[2],
        )
    }
    fn jacobian(&self, y: &State<3>) -> Jacobian<3> {
        #[rustfmt::skip]
        let j = Jacobian::<3>::new(
            -10.0,           10.0, 0.0,
            self.rho - y[2], -1.0, -y[0],
            y[1],            y[0], -8.0 / 3.0,
        );
        j
    }
    fn second_derivative(&self, _: &State<3>, u: &State<3>, v: &State<3>) -> State<3> {
        State::<3>::new(0.0, -(u[0] * v[2] + u[2] * v[0]), u[0] * v[1] + u[1] * v[0])
    }
}

/// x' = A - (B + 1) x + x^2 y, y' = B x - x^2 y.
struct Brusselator {
    a: f64,
    b: f64,
}

impl VectorField<2> for Brusselator {
    fn f(&self, y: &State<2>) -> State<2> {
        let cubic = y[0] * y[0] * y[1];
        State::<2>::new(
            self.a - (self.b + 1.0) * y[0] + cubic,
            self.b * y[0] - cubic,
        )
    }
    fn jacobian(&self, y: &State<2>) -> Jacobian<2> {
        let (by_x, by_y) = (2.0 * y[0] * y[1], y[0] * y[0]);
        Jacobian::<2>::new(by_x - self.b - 1.0, by_y, self.b - by_x, -by_y)
    }
    fn second_derivative(&self, y: &State<2>, u: &State<2>, v: &State<2>) -> State<2> {
        let s = 2.0 * y[1] * u[0] * v[0] + 2.0 * y[0] * (u[0] * v[1] + u[1] * v[0]);
        State::<2>::new(s, -s)
    }
}

/// y' = p + y^2 - y^3 / 3: folds at y = 0 (p = 0) and y = 2 (p = -4/3).
struct Folded {
    p: f64,
}

impl VectorField<1> for Folded {
    fn f(&self, y: &State<1>) -> State<1> {
        State::<1>::new(self.p + y[0] * y[0] - y[0].powi(3) / 3.0)
    }
    fn jacobian(&self, y: &State<1>) -> Jacobian<1> {
        Jacobian::<1>::new(2.0 * y[0] - y[0] * y[0])
    }
    fn second_derivative(&self, y: &State<1>, u: &State<1>, v: &State<1>) -> State<1> {
        State::<1>::new((2.0 - 2.0 * y[0]) * u[0] * v[0])
    }
}

fn all(
    family: &FieldEquilibria<'_>,
    onward: &Onward,
    settings: &Settings,
) -> Vec<FoundEquilibrium> {
    let mut found = Vec::new();
    let branch = family
        .follow(onward, settings, &mut |point| {
            found.push(point.clone());
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(branch.stopped, Stop::RangeEnd);
    found
}

fn only(points: &[FoundEquilibrium], label: Label) -> Vec<FoundEquilibrium> {
    points
        .iter()
        .filter(|p| p.label == Some(label))
        .cloned()
        .collect()
}

#[test]
fn lorenz_has_a_pitchfork_and_a_subcritical_hopf_point() {
    let fields = |rho| AnyField::new::<3>(Box::new(Lorenz { rho }));
    let family = FieldEquilibria {
        fields: &fields,
        along: "rho",
        scale: None,
        bounds: &[],
    };
    for longest in [0.5, 2.0] {
        let settings = Settings::new((0.0, 30.0), longest).unwrap();
        let origin = all(
            &family,
            &Onward::along(Vector::zeros(3), 0.0, true),
            &settings,
        );
        assert!(only(&origin, Label::Hb).is_empty() && only(&origin, Label::Lp).is_empty());
        let pitchforks = only(&origin, Label::Bp);
        assert_eq!(pitchforks.len(), 1);
        assert!((pitchforks[0].parameter - 1.0).abs() < 1e-11);

        for onward in family.switch(&pitchforks[0], 1e-3).unwrap() {
            let side = all(&family, &onward, &settings);
            // x = y = +-sqrt(beta (rho - 1)), z = rho - 1
            for point in &side {
                let excess = point.parameter - 1.0;
                assert!((point.state[2] - excess).abs() < 1e-10);
                assert!((point.state[0].powi(2) - 8.0 / 3.0 * excess).abs() < 1e-9);
            }
            let hopf = only(&side, Label::Hb);
            assert_eq!(hopf.len(), 1, "longest {longest}");
            // rho_H = sigma (sigma + beta + 3) / (sigma - beta - 1) = 470/19, omega^2 = beta (sigma + rho)
            let rho = 470.0 / 19.0;
            assert!(
                (hopf[0].parameter - rho).abs() < 1e-9,
                "{}",
                hopf[0].parameter
            );
            let omega = (8.0 / 3.0 * (10.0 + rho)).sqrt();
            assert!((hopf[0].period.unwrap() * omega / std::f64::consts::TAU - 1.0).abs() < 1e-9);
            assert!(
                hopf[0].coefficient.unwrap() > 0.0,
                "subcritical (Marsden and McCracken 1976)"
            );
        }
    }
}

#[test]
fn the_brusselator_oscillates_beyond_its_hopf_point() {
    for a in [0.7, 1.0, 2.0] {
        let fields = |b| AnyField::new::<2>(Box::new(Brusselator { a, b }));
        let family = FieldEquilibria {
            fields: &fields,
            along: "b",
            scale: None,
            bounds: &[],
        };
        let settings = Settings::new((0.5, 8.0), 0.3).unwrap();
        let start = Vector::from_vec(vec![a, 0.5 / a]);
        let points = all(&family, &Onward::along(start, 0.5, true), &settings);
        let hopf = only(&points, Label::Hb);
        assert_eq!(hopf.len(), 1);
        assert!((hopf[0].parameter - (1.0 + a * a)).abs() < 1e-10);
        assert!((hopf[0].period.unwrap() - std::f64::consts::TAU / a).abs() < 1e-9);
        // supercritical for every A (Kuznetsov 2004, exercises to chapter 3)
        assert!(hopf[0].coefficient.unwrap() < 0.0);
        let on_axis = hopf[0].eigenvalues[0] - Complex::new(0.0, a);
        assert!(on_axis.norm() < 1e-9, "{on_axis}");
    }
}

#[test]
fn both_folds_of_a_cubic() {
    let fields = |p| AnyField::new::<1>(Box::new(Folded { p }));
    let family = FieldEquilibria {
        fields: &fields,
        along: "p",
        scale: None,
        bounds: &[],
    };
    let mut settings = Settings::new((-2.0, 1.0), 0.2).unwrap();
    settings.wanted = vec![-0.5];
    let start = Vector::from_vec(vec![-1.2]);
    let points = all(&family, &Onward::along(start, -2.0, true), &settings);
    let folds: Vec<_> = only(&points, Label::Lp)
        .iter()
        .map(|f| (f.state[0], f.parameter))
        .collect();
    assert_eq!(folds.len(), 2, "{folds:?}");
    for ((y, p), (y_0, p_0)) in folds.iter().zip([(0.0, 0.0), (2.0, -4.0 / 3.0)]) {
        assert!(
            (y - y_0).abs() < 1e-10 && (p - p_0).abs() < 1e-12,
            "{y} {p}"
        );
    }
    // the S is crossed three times at p = -1/2
    let wanted = only(&points, Label::Uz);
    assert_eq!(wanted.len(), 3);
    assert!(wanted.iter().all(|point| point.parameter == -0.5));
}

#[test]
fn a_start_of_another_dimension_is_an_error() {
    let settings = Settings::new((-2.0, 1.0), 0.2).unwrap();
    let fields = |p| AnyField::new::<1>(Box::new(Folded { p }));
    let family = FieldEquilibria {
        fields: &fields,
        along: "p",
        scale: None,
        bounds: &[],
    };
    let onward = Onward::along(Vector::zeros(2), -2.0, true);
    let refused = family.follow(&onward, &settings, &mut |_| ControlFlow::Continue(()));
    assert!(matches!(refused, Err(Error::Parameter { .. })));

    let curve = EquilibriumCurve {
        family: &OverParameters::both(Cusp),
        kind: EquilibriumBifurcation::Fold,
    };
    let start = (&Vector::zeros(2), [-1.99, 3.0]);
    let refused = curve.follow(start, true, &settings, &mut |_| ControlFlow::Continue(()));
    assert!(matches!(refused, Err(Error::Parameter { .. })));
}

/// (x', y') = S (y, -x - p y^3) S^-1, conservative at every p, in coordinates in which rounding shows: the two eigenvalues sum to
/// zero throughout, and to rounding of either sign.
struct Conservative {
    p: f64,
}

impl Conservative {
    const SHEAR: [f64; 4] = [0.31, 1.7, -0.9, 0.47];

    fn back(y: &State<2>) -> State<2> {
        let [a, b, c, d] = Self::SHEAR;
        let determinant = a * d - b * c;
        State::<2>::new(d * y[0] - b * y[1], a * y[1] - c * y[0]) / determinant
    }

    fn forth(y: &State<2>) -> State<2> {
        let [a, b, c, d] = Self::SHEAR;
        State::<2>::new(a * y[0] + b * y[1], c * y[0] + d * y[1])
    }
}

impl VectorField<2> for Conservative {
    fn f(&self, y: &State<2>) -> State<2> {
        let u = Self::back(y);
        Self::forth(&State::<2>::new(
            u[1],
            self.p - (1.0 + self.p * self.p) * u[0].sinh(),
        ))
    }
    fn jacobian(&self, y: &State<2>) -> Jacobian<2> {
        let u = Self::back(y);
        let by = -(1.0 + self.p * self.p) * u[0].cosh();
        let column = |i: usize| {
            let mut unit = State::<2>::zeros();
            unit[i] = 1.0;
            let v = Self::back(&unit);
            Self::forth(&State::<2>::new(v[1], by * v[0]))
        };
        Jacobian::<2>::from_columns(&[column(0), column(1)])
    }
    fn second_derivative(&self, y: &State<2>, u: &State<2>, v: &State<2>) -> State<2> {
        let (at, u, v) = (Self::back(y), Self::back(u), Self::back(v));
        let by = -(1.0 + self.p * self.p) * at[0].sinh();
        Self::forth(&State::<2>::new(0.0, by * u[0] * v[0]))
    }
}

/// What is zero throughout has no certain sign, and no change of one.
#[test]
fn a_conservative_system_has_no_hopf_points() {
    let family = FieldEquilibria {
        fields: &|p| AnyField::new::<2>(Box::new(Conservative { p })),
        along: "p",
        scale: None,
        bounds: &[],
    };
    for longest in [0.3, 0.05, 0.01] {
        let settings = Settings::new((-2.0, 2.0), longest).unwrap();
        let asinh = (-2.0_f64 / 5.0).asinh();
        let begin = Conservative::forth(&State::<2>::new(asinh, 0.0));
        let begin = vector(&begin);
        let points = all(&family, &Onward::along(begin, -2.0, true), &settings);
        // along the branch u = asinh(p / (1 + p^2)) has an extremum at p = 1, which is no fold in p
        let special: Vec<_> = points.iter().filter_map(|point| point.label).collect();
        assert_eq!(special, [Label::Ep, Label::Ep], "longest {longest}");
    }
}

/// y' = p + q y - y^3: folds where 27 p^2 = 4 q^3, and a cusp where they meet.
#[derive(Debug, Clone, Copy)]
struct Cusp;

impl Equations<1, 2> for Cusp {
    const PARAMETERS: [&'static str; 2] = ["p", "q"];

    fn rates<T: Real>(&self, [y]: [T; 1], [p, q]: [T; 2]) -> [T; 1] {
        [p + q * y - y * y * y]
    }
}

fn curve(
    family: &dyn ParametrisedField,
    kind: EquilibriumBifurcation,
    (state, at): (&[f64], [f64; 2]),
    growing: bool,
    range: (f64, f64),
) -> Vec<EquilibriumCurvePoint> {
    let settings = Settings::new(range, 0.1).unwrap();
    let mut found = Vec::new();
    let curve = EquilibriumCurve { family, kind };
    let state = Vector::from_column_slice(state);
    let branch = curve
        .follow((&state, at), growing, &settings, &mut |point| {
            found.push(point.clone());
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(branch.stopped, Stop::RangeEnd);
    found
}

#[test]
fn folds_are_followed_past_their_cusp_in_two_parameters() {
    let family = OverParameters::both(Cusp);
    let start: (&[f64], _) = (&[1.01], [-1.99, 3.0]);
    let kind = EquilibriumBifurcation::Fold;
    let found = curve(&family, kind, start, false, (-1.0, 4.0));
    for point in &found {
        let ([p, q], y) = (point.at, point.state[0]);
        assert!((27.0 * p * p - 4.0 * q * q * q).abs() < 1e-10, "{point:?}");
        assert!((q - 3.0 * y * y).abs() < 1e-11, "{point:?}");
        assert!(point.frequency.is_none());
    }
    let last = found.last().unwrap();
    assert_eq!(last.at[1], 4.0);
    assert!((last.state[0] + (4.0_f64 / 3.0).sqrt()).abs() < 1e-12);
}

#[test]
fn hopf_points_are_followed_in_two_parameters() {
    let family = OverParameters::both(classics::Brusselator);
    let start: (&[f64], _) = (&[1.0, 2.0], [1.01, 2.0]);
    let kind = EquilibriumBifurcation::Hopf;
    let found = curve(&family, kind, start, true, (2.0, 5.0));
    for point in &found {
        // B = 1 + A^2, omega = A
        let [a, b] = point.at;
        assert!((b - 1.0 - a * a).abs() < 1e-11, "{point:?}");
        assert!((point.frequency.unwrap() - a).abs() < 1e-11, "{point:?}");
    }
    assert!((found.last().unwrap().at[0] - 2.0).abs() < 1e-12);
}
