//! One zero of a scalar function: in a bracket, by Newton steps where they behave and bisection where they don't; and how
//! far off it can be.

use super::{Interval, Real};
use crate::error::{Error, Result};

/// Doubles can be halved about 2100 times from end to end; a safeguarded step at least halves the bracket every other time.
const MAX_ITERATIONS: usize = 300;

/// The zero of g in `[a, b]`, where g(a) and g(b) have opposite signs; g returns its value and slope.
///
/// Converges to the floating-point number at which the computed g changes sign: the last bracket is two neighbours, or the
/// Newton correction is below half a unit in the last place.
///
/// # Errors
/// [`Error::NotConverged`] if the signs at the ends agree or g is not finite in between.
#[doc(hidden)]
pub fn bracketed_root(
    what: &'static str,
    a: f64,
    b: f64,
    mut g: impl FnMut(f64) -> (f64, f64),
) -> Result<f64> {
    let (ga, gb) = (g(a).0, g(b).0);
    if ga == 0.0 {
        return Ok(a);
    }
    if gb == 0.0 {
        return Ok(b);
    }
    // False for NaN too.
    let straddled = ga * gb.signum() < 0.0;
    if !straddled {
        return Err(Error::NotConverged {
            what,
            iterations: 0,
            residual: ga.abs().min(gb.abs()),
            tolerance: 0.0,
        });
    }
    // `below` keeps the side where g is negative.
    let (mut below, mut above) = if ga < 0.0 { (a, b) } else { (b, a) };
    let mut x = middle(a, b);
    let mut last_step = (b - a).abs();
    let mut residual = f64::NAN;
    for _ in 0..MAX_ITERATIONS {
        let (value, slope) = g(x);
        residual = value;
        if value == 0.0 {
            return Ok(x);
        }
        if !value.is_finite() {
            break;
        }
        if value < 0.0 {
            below = x;
        } else {
            above = x;
        }
        let newton = x - value / slope;
        let inside = newton > below.min(above) && newton < below.max(above);
        // Newton steps must at least halve, or be rounding already; otherwise bisect, so that no function makes this crawl.
        let next = if newton == x || (inside && (newton - x).abs() < 0.5 * last_step) {
            newton
        } else {
            middle(below, above)
        };
        last_step = (next - x).abs();
        if last_step == 0.0 || next == below || next == above {
            return Ok(next);
        }
        x = next;
    }
    Err(Error::NotConverged {
        what,
        iterations: MAX_ITERATIONS,
        residual: residual.abs(),
        tolerance: 0.0,
    })
}

/// Half-way between the ends of a bracket: by their logarithms where one is a million times the other. 0 has none.
fn middle(a: f64, b: f64) -> f64 {
    /// Beyond this ratio.
    const FAR: f64 = 1e6;
    let alike = a != 0.0 && b != 0.0 && a.signum() == b.signum();
    if alike && (a / b > FAR || b / a > FAR) {
        (a.abs().sqrt() * b.abs().sqrt()).copysign(a)
    } else {
        0.5 * a + 0.5 * b
    }
}

/// The smallest radius (by powers of two) within which g certainly changes sign around v > 0; infinite if there is none.
#[doc(hidden)]
pub fn enclosing_radius(v: f64, g: impl Fn(Interval) -> Interval) -> f64 {
    let mut radius = v * f64::EPSILON;
    while radius < 0.5 * v {
        let ends = [v - radius, v + radius].map(|x| g(Interval::constant(x)).sign());
        if let [Some(left), Some(right)] = ends
            && left != right
        {
            return radius;
        }
        radius *= 2.0;
    }
    f64::INFINITY
}
