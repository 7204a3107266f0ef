//! Where one of the parameters, as K, is largest along a curve of bifurcations.
//!
//! The slope of a curve is known by gradients, to six digits or so. The points themselves are known to the last: the curve is
//! interpolated through a few, over the distance along one direction, and the interpolating polynomial has its top where the
//! curve has. Two widths of the interval show what the interpolation errs by.

use crate::model::Parameter;
use crate::number::Uncertain;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, PalcSettings, ParametrisedField, Regular,
    TangentVector, TestFunction,
};

/// A stationary value of a parameter on a curve.
pub struct Top {
    /// A point of the curve next to it.
    pub orbit: Regular,
    /// Both parameters.
    pub at: [Uncertain; 2],
    /// The period.
    pub period: Uncertain,
    /// Whether it is a maximum.
    pub largest: bool,
    /// Whether the other parameter is stationary too: the curve has a cusp.
    pub both: bool,
}

/// Points of the interpolation, and the half widths of its two intervals.
const POINTS: usize = 13;
const WIDTHS: [f64; 2] = [0.04, 0.027];
/// Tolerance of the points.
const FINE: f64 = 1e-16;
/// A slope, over half the interval, that is less than this part of the other coordinate's bend is zero.
const STAYS: f64 = 1e-4;
/// A stationary point within this part of the shorter arc is in its midst.
const CENTRED: f64 = 0.5;

/// The stationary point of a coordinate along the curve of a test function, near a site on it.
pub fn top(
    family: &dyn ParametrisedField,
    near: &ContinuationPoint,
    test_function: TestFunction,
    coordinate: usize,
) -> Option<Top> {
    let stationary = |corrector: &mut Corrector<'_>, near: &_, direction: &_, width| {
        stationary(
            corrector,
            (near, direction),
            width,
            (test_function, coordinate),
        )
    };
    let mut corrector = Corrector::new(family, FINE).ok()?;
    let settings = PalcSettings::locus(test_function, 1.0);
    let own = [Condition::TestFunction(test_function)];
    let here = corrector.look(near.clone(), &settings.free, &own).ok()?;
    let any = here.along[0].clone();
    let mut direction = settings.direction(&here, &any)?;
    let mut near = near.clone();
    let mut first = stationary(&mut corrector, &near, &direction, WIDTHS[0])?;
    // Where it is farther than the shorter arc goes, both begin there.
    if first.s.abs() > CENTRED * WIDTHS[1] {
        let site = near.moved(&direction, first.s);
        let conditions = settings.and(Condition::Plane(&direction, &site));
        let there = corrector.correct(site.clone(), &settings.free, &conditions, Goal::STEP);
        near = there.ok()?.site;
        let there = corrector.look(near.clone(), &settings.free, &own).ok()?;
        direction = settings.direction(&there, &direction)?;
        first = stationary(&mut corrector, &near, &direction, WIDTHS[0])?;
    }
    let second = stationary(&mut corrector, &near, &direction, WIDTHS[1])?;
    let at = near.moved(&direction, second.s);
    let conditions = settings.and(Condition::Plane(&direction, &at));
    let orbit = corrector
        .correct(at.clone(), &settings.free, &conditions, Goal::SHARP)
        .ok()?;
    let (parameters, scale) = (family.parameters(second.at), family.scale(second.at));
    // The value at a stationary point is known far better than its place.
    let uncertain = |i: usize| {
        let apart = 3.0 * (first.at[i] - second.at[i]).abs() + second.errors[i];
        let rounding = 8.0 * f64::EPSILON * parameters[i].abs();
        Uncertain::new(parameters[i], scale[i].abs() * apart + rounding)
    };
    let apart = 3.0 * (first.period - second.period).abs();
    Some(Top {
        at: [uncertain(0), uncertain(1)],
        period: Uncertain::new(second.period, apart + 1e-14 * second.period),
        largest: second.bend < 0.0,
        both: first.both && second.both,
        orbit,
    })
}

struct Stationary {
    s: f64,
    at: [f64; 2],
    period: f64,
    bend: f64,
    /// Whether the other coordinate is stationary too.
    both: bool,
    /// What the points' own noise makes of both coordinates.
    errors: [f64; 2],
}

fn stationary(
    corrector: &mut Corrector<'_>,
    (near, direction): (&ContinuationPoint, &TangentVector),
    width: f64,
    (test_function, coordinate): (TestFunction, usize),
) -> Option<Stationary> {
    // K is the coordinate that is stationary, V the other one.
    let (mut v, mut k, mut t) = ([0.0; POINTS], [0.0; POINTS], [0.0; POINTS]);
    let other = 1 - coordinate;
    for i in 0..POINTS {
        // Chebyshev's points: the least of the interpolation's error.
        let s = ((i as f64 + 0.5) * std::f64::consts::PI / POINTS as f64).cos();
        let at = near.moved(direction, width * s);
        let conditions = [
            Condition::TestFunction(test_function),
            Condition::Plane(direction, &at),
        ];
        let orbit = corrector
            .correct(at.clone(), &Parameter::PLANE, &conditions, Goal::SHARP)
            .ok()?;
        (v[i], k[i]) = (orbit.site.at[other], orbit.site.at[coordinate]);
        t[i] = orbit.site.shooting.period();
    }
    let [v, k, t] = [v, k, t].map(|values| coefficients(&values));
    let mut x = 0.0;
    for _ in 0..50 {
        let (_, slope, bend) = value(&k, x);
        let dx = -slope / bend;
        x += dx;
        if dx.abs() < 1e-16 {
            break;
        }
    }
    let (top, _, bend) = value(&k, x);
    let inside = x.abs() < 1.0 && top.is_finite();
    // The last coefficients are noise, or what is left of the curve: so much every one of them may err by, and the slope of T_n by
    // n times that, over the root of 1 - x^2.
    let noise = |c: &[f64; POINTS]| {
        let last = c[POINTS - 1].abs().max(c[POINTS - 2].abs());
        last.max(f64::EPSILON * c[0].abs())
    };
    let orders = (POINTS * (POINTS - 1) / 2) as f64;
    let off = orders * noise(&k) / (bend.abs() * (1.0 - x * x).sqrt());
    let (_, slope_of_v, _) = value(&v, x);
    let in_order = |[of_v, of_k]: [f64; 2]| match coordinate {
        0 => [of_k, of_v],
        _ => [of_v, of_k],
    };
    let errors = in_order([
        slope_of_v.abs() * off + POINTS as f64 * noise(&v),
        POINTS as f64 * noise(&k) + 0.5 * bend.abs() * off * off,
    ]);
    inside.then(|| Stationary {
        errors,
        s: width * x,
        at: in_order([value(&v, x).0, top]),
        period: value(&t, x).0,
        bend,
        both: slope_of_v.abs() < STAYS * bend.abs(),
    })
}

/// Of the polynomials of Chebyshev, by the sums over the points that these are orthogonal in.
fn coefficients(values: &[f64; POINTS]) -> [f64; POINTS] {
    std::array::from_fn(|n| {
        let sum: f64 = (0..POINTS)
            .map(|i| {
                let angle = (i as f64 + 0.5) * std::f64::consts::PI / POINTS as f64;
                values[i] * (n as f64 * angle).cos()
            })
            .sum();
        sum * if n == 0 { 1.0 } else { 2.0 } / POINTS as f64
    })
}

/// The sum of c_n T_n(x) with its first two derivatives.
fn value(c: &[f64; POINTS], x: f64) -> (f64, f64, f64) {
    let (mut t, mut dt, mut ddt) = ((1.0, x), (0.0, 1.0), (0.0, 0.0));
    let mut sum = (c[0] + c[1] * x, c[1], 0.0);
    for c in &c[2..] {
        let next = 2.0 * x * t.1 - t.0;
        let slope = 2.0 * t.1 + 2.0 * x * dt.1 - dt.0;
        let bend = 4.0 * dt.1 + 2.0 * x * ddt.1 - ddt.0;
        (t, dt, ddt) = ((t.1, next), (dt.1, slope), (ddt.1, bend));
        sum = (sum.0 + c * next, sum.1 + c * slope, sum.2 + c * bend);
    }
    sum
}
