//! Systems of four, six and twelve equations, and formulas that no code is compiled for: held against 31 digits, differences and
//! an unlike method as the small ones are, and against closed forms.

use crate::systems::check;
use twinslip::field::State;
use twinslip::integrate::{Integrator, MAX_STEPS, Taylor, Tolerances};
use twinslip::model::Smooth;
use twinslip::number::Real;
use twinslip::series::{Equations, Jet3};

/// Two van der Pol oscillators with a spring between them, in (x_1, v_1, x_2, v_2) and the parameters (mu, k).
#[derive(Debug, Clone, Copy)]
struct Coupled;

impl Equations<4, 2> for Coupled {
    const PARAMETERS: [&'static str; 2] = ["mu", "k"];

    #[inline(always)]
    fn rates<T: Real>(&self, [x, v, y, w]: [T; 4], [mu, k]: [T; 2]) -> [T; 4] {
        let one = T::constant(1.0);
        let pull = k * (y - x);
        [
            v,
            mu * (one - x * x) * v - x + pull,
            w,
            mu * (one - y * y) * w - y * 1.2 - pull,
        ]
    }
}

/// Three units that turn, in the parameters (a, k), with every function of angles.
#[derive(Debug, Clone, Copy)]
struct Turning;

impl Turning {
    fn rate<T: Real>(x: T, y: T, [a, k]: [T; 2]) -> T {
        let pull = k * (y - x);
        a - x.sin() * 0.7 + pull.tanh() + (x * y).atan() * x.cos() - (x * x + 2.0).log10()
    }
}

impl Equations<3, 2> for Turning {
    const PARAMETERS: [&'static str; 2] = ["first", "second"];

    #[inline(always)]
    fn rates<T: Real>(&self, [x, y, z]: [T; 3], p: [T; 2]) -> [T; 3] {
        [
            Self::rate(x, y, p),
            Self::rate(y, z, p),
            Self::rate(z, x, p),
        ]
    }
}

impl Equations<4, 2> for Turning {
    const PARAMETERS: [&'static str; 2] = ["first", "second"];

    fn rates<T: Real>(&self, [x, y, z, w]: [T; 4], p: [T; 2]) -> [T; 4] {
        [
            Self::rate(x, y, p),
            Self::rate(y, z, p),
            Self::rate(z, w, p),
            Self::rate(w, x, p),
        ]
    }
}

#[test]
fn functions_of_angles_are_right_in_three_and_in_four_equations() {
    let parameters = [1.3, 0.4];
    let equations = Turning;
    check::<_, 3>(
        Smooth {
            equations,
            parameters,
        },
        [0.3, -1.2, 2.0],
        3.0,
    );
    check::<_, 4>(
        Smooth {
            equations,
            parameters,
        },
        [0.3, -1.2, 2.0, 0.8],
        3.0,
    );
}

/// A ring of bistable units, x_i' = a x_i - x_i^3 + k (x_(i+1) - 2 x_i + x_(i-1)) + e^(-x_i^2), in the parameters (a, k).
#[derive(Debug, Clone, Copy)]
struct Ring<const N: usize>;

impl<const N: usize> Equations<N, 2> for Ring<N> {
    const PARAMETERS: [&'static str; 2] = ["a", "k"];

    fn rates<T: Real>(&self, x: [T; N], [a, k]: [T; 2]) -> [T; N] {
        std::array::from_fn(|i| {
            let (next, last) = (x[(i + 1) % N], x[(i + N - 1) % N]);
            let squared = x[i] * x[i];
            (a - squared) * x[i] + k * (next - x[i] * 2.0 + last) + (-squared).exp()
        })
    }
}

fn spread<const N: usize>() -> [f64; N] {
    std::array::from_fn(|i| 0.4 + (1.3 * i as f64).sin())
}

#[test]
fn four_equations_are_right() {
    let field = Smooth {
        equations: Coupled,
        parameters: [0.8, 0.3],
    };
    check(field, [1.0, 0.2, -0.5, 1.4], 5.0);
}

#[test]
fn six_equations_are_right() {
    let field = Smooth {
        equations: Ring::<6>,
        parameters: [1.1, 0.4],
    };
    check(field, spread(), 1.5);
}

#[test]
fn twelve_equations_are_right() {
    let field = Smooth {
        equations: Ring::<12>,
        parameters: [1.1, 0.4],
    };
    check(field, spread(), 1.5);
}

/// x_i' = lambda_i x_i in three variables, each rate by a sum of forty products: more than there is room for in compiled code.
#[derive(Debug, Clone, Copy)]
struct Long;

impl Equations<3, 2> for Long {
    const PARAMETERS: [&'static str; 2] = ["a", "b"];

    fn rates<T: Real>(&self, x: [T; 3], [a, b]: [T; 2]) -> [T; 3] {
        let one = x[0] / (x[0] + 0.0);
        let mut sum = T::constant(0.0);
        for i in 1..=40 {
            sum = sum + one * one.powf(f64::from(i)) / 40.0;
        }
        [a * sum * x[0], b * sum * x[1], (a + b) * x[2] * sum]
    }
}

#[test]
fn a_long_formula_runs_in_loops() {
    let field = Smooth {
        equations: Long,
        parameters: [-0.7, 0.2],
    };
    let mut taylor = Taylor::new(Tolerances::equal(1e-14).unwrap(), MAX_STEPS).unwrap();
    let y = State::<3>::new(1.0, 2.0, -0.5);
    let end = taylor.flow(&field, (0.0, 2.0), &y, None).unwrap();
    let (same, derivatives) = taylor.derivatives(&field, (0.0, 2.0), &y, &[0, 1]).unwrap();
    for (i, rate) in [-0.7_f64, 0.2, -0.5].into_iter().enumerate() {
        let growth = (2.0 * rate).exp();
        assert!((end[i] / (growth * y[i]) - 1.0).abs() < 1e-13, "{i}");
        assert!((same[i] / end[i] - 1.0).abs() < 1e-13, "{i}");
        assert!(
            (derivatives.start[i][i] / growth - 1.0).abs() < 1e-13,
            "{i}"
        );
    }
    assert!((derivatives.parameters[0][0] / (2.0 * end[0]) - 1.0).abs() < 1e-13);
    assert!((derivatives.log_determinant + 2.0).abs() < 1e-13);
}

/// x' = 1, y' = |x| - a y, z' = b: not smooth where x = 0.
#[derive(Debug, Clone, Copy)]
struct Bent;

impl Equations<4, 2> for Bent {
    const PARAMETERS: [&'static str; 2] = ["a", "b"];

    fn rates<T: Real>(&self, [x, y, _, u]: [T; 4], [a, b]: [T; 2]) -> [T; 4] {
        [T::constant(1.0), x.abs() - a * y, b, u * 0.0]
    }
}

#[test]
fn no_step_leads_over_a_kink() {
    let field = Smooth {
        equations: Bent,
        parameters: [0.0, 3.0],
    };
    let y = State::<4>::new(-1.0, 0.0, 0.0, 7.0);
    let tolerances = Tolerances::equal(1e-14).unwrap();
    for mut taylor in [
        Taylor::new(tolerances, MAX_STEPS).unwrap(),
        Taylor::reference(MAX_STEPS).unwrap(),
    ] {
        let end = taylor.flow(&field, (0.0, 3.0), &y, None).unwrap();
        assert!(
            (end - State::<4>::new(2.0, 2.5, 9.0, 7.0)).amax() < 1e-14,
            "{end}"
        );
    }
}

/// x' = x below 1 and 2 - x above, by a choice in the formula: the solution turns from e^t to 2 - e^-t, smoothly once.
#[derive(Debug, Clone, Copy)]
struct Choosing;

impl Equations<4, 2> for Choosing {
    const PARAMETERS: [&'static str; 2] = ["first", "second"];

    fn rates<T: Real>(&self, x: [T; 4], _: [T; 2]) -> [T; 4] {
        let zero = T::constant(0.0);
        let rate = if x[0].leading() < 1.0 {
            x[0]
        } else {
            -x[0] + 2.0
        };
        [rate, zero, zero, zero]
    }
}

#[test]
fn a_formula_that_chooses_is_recorded_anew_at_every_step() {
    let field = Smooth {
        equations: Choosing,
        parameters: [0.0; 2],
    };
    let mut taylor = Taylor::new(Tolerances::equal(1e-13).unwrap(), MAX_STEPS).unwrap();
    let half = (0.5_f64.ln().abs(), State::<4>::new(0.5, 0.0, 0.0, 0.0));
    let there = taylor.flow(&field, (0.0, half.0), &half.1, None).unwrap();
    assert!((there[0] - 1.0).abs() < 1e-13);
    let above = State::<4>::new(1.0 + 1e-9, 0.0, 0.0, 0.0);
    let end = taylor.flow(&field, (0.0, 1.0), &above, None).unwrap();
    let exact = 2.0 - (1.0 - 1e-9) * (-1.0_f64).exp();
    assert!((end[0] - exact).abs() < 1e-13, "{end}");
}

/// The map of four equations to third order, against differences of flows.
#[test]
fn four_equations_are_transported() {
    let field = Smooth {
        equations: Coupled,
        parameters: [0.8, 0.3],
    };
    let y = [1.0, 0.2, -0.5, 1.4];
    let directions = [[0.6, 0.3], [-0.2, 0.5], [0.1, -0.4], [0.8, 0.2]];
    let start = std::array::from_fn(|i| Jet3::linear(y[i], directions[i]));
    let mut taylor = Taylor::new(Tolerances::equal(1e-14).unwrap(), MAX_STEPS).unwrap();
    let made = taylor.transport(&field, (0.0, 2.0), start).unwrap();
    let mut flow = |s: f64, t: f64| {
        let y = State::<4>::from_fn(|i, _| y[i] + s * directions[i][0] + t * directions[i][1]);
        taylor.flow(&field, (0.0, 2.0), &y, None).unwrap()
    };
    // What is left is of the fourth order.
    let mut left = |h: f64| {
        let corners = [(h, h), (h, -h), (-h, 0.3 * h)];
        let apart = |(s, t): (f64, f64)| {
            let end = flow(s, t);
            let off = (0..4).map(|i| (made[i].at(s, t) - end[i]).abs());
            off.fold(0.0, f64::max)
        };
        corners.map(apart).into_iter().fold(0.0, f64::max)
    };
    let (coarse, fine) = (left(0.02), left(0.01));
    assert!(
        coarse > 1e-9 && fine < coarse / 13.0,
        "{coarse:e}, {fine:e}"
    );
}
