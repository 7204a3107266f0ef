//! Flow maps to third order: against maps in closed form, and against the flow itself at finite variations.

use std::f64::consts::PI;
use twinslip::Error;
use twinslip::field::{Jacobian, State, VectorField};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Integrator, MAX_STEPS, Taylor, Tolerances};
use twinslip::internals::Element;
use twinslip::model::classics::Lorenz;
use twinslip::model::{DifferenceChart, Loading, Smooth, to_difference_chart, two_interfaces};
use twinslip::number::Real;
use twinslip::series::{Equations, Jet3};

fn taylor(tolerance: f64) -> Taylor {
    Taylor::new(Tolerances::equal(tolerance).unwrap(), MAX_STEPS).unwrap()
}

fn largest(c: Jet3) -> f64 {
    c.0.iter().fold(0.0, |largest, c| largest.max(c.abs()))
}

/// What a polynomial leaves out falls with the fourth power of the variations.
#[track_caller]
fn assert_third_order(made: impl Fn(f64, f64) -> f64, exact: impl Fn(f64, f64) -> f64, h: f64) {
    let error = |h: f64| {
        let corners = [(h, h), (h, -h), (-h, 0.3 * h), (0.2 * h, -h)];
        let errors = corners.map(|(s, t)| (made(s, t) - exact(s, t)).abs());
        errors.into_iter().fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(h), error(0.5 * h));
    let rounding = 1e-14 * (1.0 + exact(0.0, 0.0).abs());
    assert!(coarse > 50.0 * rounding, "nothing to see: {coarse:e}");
    assert!(fine < coarse / 11.0 + rounding, "{coarse:e}, {fine:e}");
}

#[test]
fn functions_are_right_to_third_order() {
    let x = Jet3([0.7, 0.5, -0.8, 0.3, 0.2, -0.4, 0.6, 0.1, -0.3, 0.2]);
    type Function = (Jet3, fn(f64) -> f64);
    let functions: [Function; 9] = [
        (x * x, |x| x * x),
        (Jet3::constant(1.0) / x, |x| 1.0 / x),
        (Element::exp(x), f64::exp),
        (Element::exp_m1(x), f64::exp_m1),
        (Element::ln(x), f64::ln),
        (Element::ln_1p(x), f64::ln_1p),
        (Element::powf(x, -1.3), |x| x.powf(-1.3)),
        (x.sinh_cosh().0, f64::sinh),
        (x.sinh_cosh().1, f64::cosh),
    ];
    for (made, exact) in functions {
        assert!((made.value() - exact(0.7)).abs() < 1e-15);
        assert_third_order(|s, t| made.at(s, t), |s, t| exact(x.at(s, t)), 0.01);
    }
}

/// r' = r (mu - r^2), theta' = 1 + beta r^2 in Cartesian coordinates, in the parameters (mu, beta).
#[derive(Debug, Clone, Copy)]
struct Wheel;

impl Equations<2, 2> for Wheel {
    const PARAMETERS: [&'static str; 2] = ["x", "y"];

    #[inline(always)]
    fn rates<T: Real>(&self, [x, y]: [T; 2], [mu, beta]: [T; 2]) -> [T; 2] {
        let squared = x * x + y * y;
        let (growth, speed) = (mu - squared, beta * squared + 1.0);
        [growth * x - speed * y, speed * x + growth * y]
    }
}

/// The return map of the wheel to y = 0 in closed form. With q = 1 + r^2 (e^(2 mu T) - 1) / mu after the time T, r goes to
/// r e^(mu T) / sqrt q, and the angle grows by T + (beta/2) ln q.
#[test]
fn the_return_map_of_a_wheel_is_its_closed_form() {
    let (mu, beta) = (0.04, 0.7);
    let field = Smooth {
        equations: Wheel,
        parameters: [mu, beta],
    };
    // Begins at the radius r0 + s and the angle t.
    let radius = Jet3::linear(0.3, [1.0, 0.0]);
    let angle = Jet3::linear(0.0, [0.0, 1.0]);
    let cosine = Jet3([1.0, 0.0, 0.0, 0.0, 0.0, -0.5, 0.0, 0.0, 0.0, 0.0]);
    let sine = angle - angle * angle * angle.scaled(1.0 / 6.0);
    let start = [radius * cosine, radius * sine];
    let normal = State::<2>::new(0.0, 1.0);
    let plane = (&normal, &State::<2>::zeros());
    let (time, [x, y]) = taylor(1e-15)
        .transport_onto(&field, (0.0, 5.9), start, plane)
        .unwrap();
    assert!(largest(y) < 1e-13, "{y:?}");
    let grown = Element::exp(time.scaled(2.0 * mu));
    let q = Jet3::constant(1.0) + radius * radius * (grown - Jet3::constant(1.0)).scaled(1.0 / mu);
    let turned = angle + time + Element::ln(q).scaled(0.5 * beta);
    let excess = turned - Jet3::constant(2.0 * PI);
    assert!(largest(excess) < 1e-11, "{excess:?}");
    let exact = radius * Element::exp(time.scaled(mu)) * Element::powf(q, -0.5);
    let error = largest(x - exact);
    assert!(error < 1e-12 * largest(exact), "{error:e}");
    // Far from the plane there is no passage.
    let missed = taylor(1e-15).transport_onto(
        &field,
        (0.0, 3.0),
        start,
        (&normal, &State::<2>::new(0.0, 50.0)),
    );
    assert!(matches!(missed, Err(Error::NotConverged { .. })));
}

/// The polynomial against the flow from varied starts, in every component.
fn check_flow(field: &dyn VectorField<3>, y: [f64; 3], t: f64, h: f64) {
    let directions = [[0.4, 1.0], [1.0, -0.3], [-0.5, 0.7]];
    let start = std::array::from_fn(|i| Jet3::linear(y[i], directions[i]));
    let end = taylor(1e-15).transport(field, (0.0, t), start).unwrap();
    for (i, end) in end.iter().enumerate() {
        let exact = |s: f64, t_: f64| {
            let varied = State::from(start.map(|x| x.at(s, t_)));
            taylor(1e-15).flow(field, (0.0, t), &varied, None).unwrap()[i]
        };
        assert_third_order(|s, t| end.at(s, t), exact, h);
    }
    // The linear part is the tangent.
    let (_, d) = taylor(1e-15)
        .derivatives(field, (0.0, t), &State::from(y), &[])
        .unwrap();
    let tangent = Jacobian::<3>::from(d.start);
    for k in 0..2 {
        let exact = tangent * State::<3>::from(directions.map(|direction| direction[k]));
        let made = State::<3>::from(end.map(|end| end.0[1 + k]));
        assert!((made - exact).amax() < 1e-11 * tangent.amax());
    }
}

#[test]
fn lorenz_is_transported() {
    let lorenz = Smooth {
        equations: Lorenz::classical(),
        parameters: [28.0, 8.0 / 3.0],
    };
    check_flow(&lorenz, [1.0, 2.0, 20.0], 1.0, 1e-2);
}

#[test]
fn two_interfaces_are_transported() {
    let law = Parameters::heslot_1994().spinodal();
    let loading = Loading::new(0.5, 0.14).unwrap();
    let y = State::<3>::new(10.0, -0.7, -2.0);
    let field = two_interfaces(AnyLaw::Spinodal(law), loading);
    check_flow(&*field, [y[0], y[1], y[2]], 20.0, 1e-2);
    let x = to_difference_chart(&y).unwrap();
    check_flow(
        &DifferenceChart::new(&law.into()).at(&loading),
        [x[0], x[1], x[2]],
        20.0,
        1e-2,
    );
}

/// There and back is the identity.
#[test]
fn transport_turns_back() {
    let lorenz = Smooth {
        equations: Lorenz::classical(),
        parameters: [28.0, 8.0 / 3.0],
    };
    let start = [
        Jet3::linear(1.0, [1.0, 0.0]),
        Jet3::linear(2.0, [0.0, 1.0]),
        Jet3::linear(20.0, [0.5, 0.5]),
    ];
    let there = taylor(1e-15).transport(&lorenz, (0.0, 0.3), start).unwrap();
    let back = taylor(1e-15).transport(&lorenz, (0.3, 0.0), there).unwrap();
    for (back, start) in back.into_iter().zip(start) {
        assert!(largest(back - start) < 1e-9, "{back:?}");
    }
}
