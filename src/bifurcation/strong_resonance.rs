//! The global bifurcations of the approximating system (39)-(40) near a 1:2 resonance, of the full system at finite mu: its
//! cycles, the pair of homoclinic orbits of the origin, and the fold where two cycles merge. [`StrongResonance`] has the local
//! ones, and what these two tend to as mu -> 0.
//!
//! A cycle is met on the section w = 0 by its largest v, the amplitude A, and is the only one there as mu_1 varies: more of it
//! damps. So cycles are functions mu_1(A) at fixed mu_2, each the zero of a return map by bracketed secants. The system is odd:
//! a cycle around the origin returns to its mirror image after half a period.

use crate::error::{Error, Result};
use crate::field::State;
use crate::integrate::{Control, Integrator, MAX_STEPS, Taylor, Tolerances};
use crate::model::{Smooth, normal_form::StrongResonance};
use crate::number::bracketed_root;

/// Relative tolerance of a step.
const RTOL: f64 = 1e-15;
/// What is left of a return map by rounding, relative to the amplitude: it counts as zero.
const ROUNDING: f64 = 1e-15;
/// Longer than any turn looked for, in 1/sqrt(|mu_2| + A^2).
const HORIZON: f64 = 400.0;

/// What a cycle goes around.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Around {
    /// The origin, and for mu_2 < 0 the states beside it: an invariant torus around the original orbit.
    Origin,
    /// The state v = sqrt(-mu_2) alone: one of a pair.
    Beside,
}

/// A cycle of (39)-(40).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ResonanceCycle {
    /// (mu_1, mu_2) at which it is one.
    pub mu: [f64; 2],
    /// Its largest v.
    pub amplitude: f64,
    /// Its period.
    pub period: f64,
    /// ln of its multiplier: stable where negative.
    pub log_multiplier: f64,
}

/// The homoclinic orbits of the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Homoclinic {
    /// (mu_1, mu_2) at which they are.
    pub mu: [f64; 2],
    /// Their largest |v|.
    pub amplitude: f64,
}

/// A passage of the section w = 0.
struct AxisPassage {
    time: f64,
    v: f64,
}

fn field(mu: [f64; 2]) -> Smooth<StrongResonance, 2, 2> {
    Smooth {
        equations: StrongResonance,
        parameters: mu,
    }
}

fn taylor(size: f64, mu2: f64) -> Result<Taylor> {
    // w = 0 at every passage: its absolute tolerance is in its own measure
    let measure = size * (size * size + mu2.abs()).sqrt();
    Taylor::new(Tolerances::new(RTOL, RTOL * measure)?, MAX_STEPS)
}

/// The first passage of w = 0 from this state, on the way that `direction` says.
fn passage(mu: [f64; 2], start: State<2>, size: f64, direction: f64) -> Result<AxisPassage> {
    let field = field(mu);
    let horizon = direction * HORIZON / (size * size + mu[1].abs()).sqrt();
    let mut found = None;
    let mut look = |step: &crate::integrate::Step<'_, 2>| {
        let (before, after) = (step.y0[1], step.y1[1]);
        if before * after >= 0.0 && after != 0.0 {
            return Ok(Control::Continue);
        }
        let along = |t: f64| {
            let y = step.after(t);
            (y[1], field_slope(mu, &y))
        };
        let after = bracketed_root("a passage of w = 0", 0.0, step.length, along)?;
        let (time, v) = ((step.begin + after).hi(), step.after(after)[0]);
        found = Some(AxisPassage { time, v });
        Ok(Control::Stop)
    };
    taylor(size, mu[1])?.flow(&field, (0.0, horizon), &start, Some(&mut look))?;
    found.ok_or(Error::NotConverged {
        what: "the return to w = 0",
        iterations: MAX_STEPS,
        residual: horizon.abs(),
        tolerance: 0.0,
    })
}

/// dw/dt
fn field_slope(mu: [f64; 2], y: &State<2>) -> f64 {
    use crate::field::VectorField;
    field(mu).f(y)[1]
}

/// The zero of a smooth function without its slope: that of the last secant serves. Values below `negligible` are zero.
fn secant_root(
    what: &'static str,
    (a, b): (f64, f64),
    negligible: f64,
    mut g: impl FnMut(f64) -> Result<f64>,
) -> Result<f64> {
    let mut failed = None;
    let mut last: Option<(f64, f64)> = None;
    let root = bracketed_root(what, a, b, |x| {
        let value = match g(x) {
            Ok(value) if value.abs() > negligible => value,
            Ok(_) => 0.0,
            Err(error) => {
                failed.get_or_insert(error);
                f64::NAN
            }
        };
        let slope = last.map_or(f64::NAN, |(x0, value0)| (value - value0) / (x - x0));
        last = Some((x, value));
        (value, slope)
    });
    failed.map_or(root, Err)
}

impl ResonanceCycle {
    /// The cycle of this amplitude at this mu_2.
    ///
    /// # Errors
    /// [`Error::Input`] for an amplitude that no such cycle can have; those of the integration.
    pub fn of(around: Around, mu2: f64, amplitude: f64) -> Result<Self> {
        let least = StrongResonance::steady(mu2).unwrap_or(0.0);
        if !(amplitude > least && amplitude.is_finite()) || (around == Around::Beside && mu2 >= 0.0)
        {
            return Err(Error::Input(format!(
                "no cycle of this kind has the amplitude {amplitude} at mu_2 = {mu2}"
            )));
        }
        // with mu_1 = 0 energy is only lost; with mu_1 = -A^2 none is lost where |v| < A
        let range = (-amplitude * amplitude, 0.0);
        let negligible = ROUNDING * amplitude;
        let mu1 = secant_root("a cycle", range, negligible, |mu1| {
            Ok(around.turn([mu1, mu2], amplitude)?.1 - amplitude)
        })?;
        let mu = [mu1, mu2];
        let (time, _) = around.turn(mu, amplitude)?;
        let start = State::<2>::new(amplitude, 0.0);
        let (_, d) = taylor(amplitude, mu2)?.derivatives(&field(mu), (0.0, time), &start, &[])?;
        let turns = match around {
            Around::Origin => 2.0,
            Around::Beside => 1.0,
        };
        Ok(ResonanceCycle {
            mu,
            amplitude,
            period: turns * time,
            log_multiplier: turns * d.log_determinant,
        })
    }

    /// (sn): the cycle around all three steady states in which a stable and an unstable one merge, for mu_2 < 0.
    ///
    /// # Errors
    /// [`Error::Input`] unless mu_2 < 0; those of the integration.
    pub fn fold(mu2: f64) -> Result<Self> {
        let inner = Homoclinic::at(mu2)?.amplitude;
        // next to the homoclinic orbits the saddle's trace is positive and decides; large cycles are stable
        let range = (1.005 * inner, 1.3 * inner);
        let amplitude = secant_root("a fold of cycles", range, 1e-13, |a| {
            Ok(Self::of(Around::Origin, mu2, a)?.log_multiplier)
        })?;
        Self::of(Around::Origin, mu2, amplitude)
    }
}

impl Around {
    /// From v = A, w = 0 to the next maximum of v, or for a cycle around the origin to the minimum, which stands for it with its
    /// sign turned: the time and the v there.
    fn turn(self, mu: [f64; 2], amplitude: f64) -> Result<(f64, f64)> {
        let start = State::<2>::new(amplitude, 0.0);
        let there = passage(mu, start, amplitude, 1.0)?;
        match self {
            Around::Origin => Ok((there.time, -there.v)),
            Around::Beside => {
                let start = State::<2>::new(there.v, 0.0);
                let back = passage(mu, start, amplitude, 1.0)?;
                Ok((there.time + back.time, back.v))
            }
        }
    }
}

impl Homoclinic {
    /// (global): where the unstable manifold of the origin returns as the stable one, for mu_2 < 0.
    ///
    /// # Errors
    /// [`Error::Input`] unless mu_2 < 0; those of the integration.
    pub fn at(mu2: f64) -> Result<Self> {
        let Some(scale) = StrongResonance::steady(mu2) else {
            return Err(Error::Input(format!(
                "the origin has homoclinic orbits for mu_2 < 0, not at {mu2}"
            )));
        };
        let far = |mu1: f64, direction: f64| {
            let mu = [mu1, mu2];
            let v = START * scale;
            let start = State::<2>::new(v, manifold(mu, direction, v));
            Ok(passage(mu, start, scale, direction)?.v)
        };
        let apart = |mu1: f64| Ok(far(mu1, 1.0)? - far(mu1, -1.0)?);
        let range = (mu2, 0.7 * mu2);
        let mu1 = secant_root("a homoclinic orbit", range, ROUNDING * scale, apart)?;
        Ok(Homoclinic {
            mu: [mu1, mu2],
            amplitude: far(mu1, 1.0)?,
        })
    }
}

/// v at which an orbit leaves the series of a manifold, in sqrt(-mu_2).
const START: f64 = 0.1;

/// w on the unstable (direction 1) or stable (-1) manifold of the origin at v: the odd series w = sum_j c_j v^j of
/// w dw/dv = -mu_1 w - mu_2 v - v^3 - v^2 w. Its singularities are no nearer than about sqrt(-mu_2).
fn manifold([mu1, mu2]: [f64; 2], direction: f64, v: f64) -> f64 {
    /// Coefficients of v, v^3, ..., v^19.
    const TERMS: usize = 10;
    let root = (mu1 * mu1 - 4.0 * mu2).sqrt();
    let mut c = [0.0; TERMS];
    c[0] = 0.5 * (direction * root - mu1);
    for n in 1..TERMS {
        let j = (2 * n + 1) as f64;
        let products: f64 = (1..n).map(|i| (2 * i + 1) as f64 * c[i] * c[n - i]).sum();
        let cubic = if n == 1 { 1.0 } else { 0.0 };
        c[n] = -(cubic + c[n - 1] + products) / ((1.0 + j) * c[0] + mu1);
    }
    v * c.iter().rev().fold(0.0, |sum, c| sum * v * v + c)
}
