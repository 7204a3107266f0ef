//! Events: zeros of functions of time and state.

use super::formula::IvpFormula;
use std::fmt;
use std::sync::Arc;

/// Why a function that is called ends the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Halt<E> {
    /// It asks to stop, as where the user has interrupted: what was computed so far is kept.
    Stop,
    /// It failed; [`IvpPlan::solve`](super::IvpPlan::solve) returns the error as it is.
    Failed(E),
}

impl<E> From<E> for Halt<E> {
    fn from(error: E) -> Self {
        Halt::Failed(error)
    }
}

/// A function of the user's time and values.
type Function<'a, E> = dyn FnMut(f64, &[f64]) -> Result<f64, Halt<E>> + 'a;

/// An event: a zero of a function of time and values. The function is looked at at the end of each step, and within steps of power
/// series, which are long, half as many times as their order. An event is found where the function has another sign than at the last
/// look, or is 0 at either; of several zeros between two looks one is found, or none. As in SciPy, a function that is 0 to the bit at the
/// end of a step has an event in this step and in the next. Of a function that is a formula no
/// zero is missed, but where [`IvpOutcome::undecided`](super::IvpOutcome::undecided) says so.
pub struct IvpEvent<'a, E> {
    /// Of the user's time and values.
    pub function: Box<Function<'a, E>>,
    /// Only zeros through which the function rises (positive) or falls (negative) along the run; all where it is 0.
    pub direction: f64,
    /// After so many of these events the run ends, at the last of them; never where it is `None` or 0.
    pub terminal: Option<usize>,
    /// The function as a formula, where it is one: by it the parts of a step are found in which there is one zero at most, and the function
    /// is looked at between these.
    pub formula: Option<Arc<IvpFormula>>,
    /// The side on which the run begins, positive or negative, of a function that may be 0 there but for rounding: an event is then only
    /// where it comes to the other side.
    pub side: Option<f64>,
}

impl<'a, E> IvpEvent<'a, E> {
    /// Zeros in either direction, which do not end the run.
    pub fn new(function: impl FnMut(f64, &[f64]) -> Result<f64, Halt<E>> + 'a) -> Self {
        IvpEvent {
            function: Box::new(function),
            direction: 0.0,
            terminal: None,
            formula: None,
            side: None,
        }
    }

    /// Zeros of a formula, likewise.
    pub fn of(formula: IvpFormula) -> Self {
        let formula = Arc::new(formula);
        let function = Arc::clone(&formula);
        IvpEvent {
            formula: Some(formula),
            ..Self::new(move |time, values| Ok(function.at(time, values)))
        }
    }

    /// What the function counts as where the run begins.
    pub(super) fn beginning(&self, value: f64) -> f64 {
        match self.side {
            Some(side) if value * side <= 0.0 => f64::MIN_POSITIVE.copysign(side),
            _ => value,
        }
    }

    /// Whether there is an event between a step's ends with these values of the function.
    pub(super) fn is_between(&self, before: f64, after: f64) -> bool {
        let up = before <= 0.0 && after >= 0.0;
        let down = before >= 0.0 && after <= 0.0;
        if let Some(side) = self.side {
            return if side > 0.0 {
                before >= 0.0 && after < 0.0
            } else {
                before <= 0.0 && after > 0.0
            };
        }
        let way = self.direction;
        (up && way > 0.0) || (down && way < 0.0) || ((up || down) && way == 0.0)
    }

    /// Whether so many of them end the run.
    pub(super) fn ends_after(&self, count: usize) -> bool {
        self.terminal.is_some_and(|most| most > 0 && count >= most)
    }
}

impl<E> fmt::Debug for IvpEvent<'_, E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("IvpEvent")
            .field("direction", &self.direction)
            .field("terminal", &self.terminal)
            .finish_non_exhaustive()
    }
}

/// The zero of g between the times of two points, by the method of Brent (1973) in the form and to the tolerance of SciPy: inverse
/// quadratic interpolation, and bisection where that is no better. The values at the ends are known, and of different signs or 0.
/// `None` where g is not a number.
pub(super) fn zero<E>(
    (mut before, mut g_before): (f64, f64),
    (mut x, mut g): (f64, f64),
    mut at: impl FnMut(f64) -> Result<f64, E>,
) -> Result<Option<f64>, E> {
    /// Absolute, and relative to the time.
    const TOLERANCE: f64 = 4.0 * f64::EPSILON;
    /// Bisection alone needs some 2100 at most, between any two doubles.
    const MOST: usize = 4000;
    if g_before == 0.0 {
        return Ok(Some(before));
    }
    let (mut beyond, mut g_beyond) = (before, g_before);
    let (mut step, mut last_step) = (x - before, x - before);
    for _ in 0..MOST {
        if g != 0.0 && g.is_sign_negative() != g_before.is_sign_negative() {
            (beyond, g_beyond) = (before, g_before);
            (last_step, step) = (x - before, x - before);
        }
        if g_beyond.abs() < g.abs() {
            (before, x, beyond) = (x, beyond, x);
            (g_before, g, g_beyond) = (g, g_beyond, g);
        }
        let delta = 0.5 * (TOLERANCE + TOLERANCE * x.abs());
        let half = 0.5 * (beyond - x);
        if g == 0.0 || half.abs() < delta {
            return Ok(Some(x));
        }
        let mut next = half;
        let mut shorter = half;
        if last_step.abs() > delta && g.abs() < g_before.abs() {
            let tried = if before == beyond {
                -g * (x - before) / (g - g_before)
            } else {
                let one = (g_before - g) / (before - x);
                let other = (g_beyond - g) / (beyond - x);
                -g * (g_beyond * other - g_before * one) / (other * one * (g_beyond - g_before))
            };
            if 2.0 * tried.abs() < last_step.abs().min(3.0 * half.abs() - delta) {
                (shorter, next) = (step, tried);
            }
        }
        (last_step, step) = (shorter, next);
        (before, g_before) = (x, g);
        x += if step.abs() > delta {
            step
        } else {
            delta.copysign(half)
        };
        g = at(x)?;
        if g.is_nan() {
            return Ok(None);
        }
    }
    Ok(Some(x))
}
