//! The sentences of errors, with numbers in the user's units.

use super::{MessageUnits, count};

/// A number as people write it: in digits, or with an exponent where these would be many.
pub(super) fn number(x: f64) -> String {
    if x == 0.0 || (1e-4..1e15).contains(&x.abs()) {
        x.to_string()
    } else {
        format!("{x:e}")
    }
}

pub(super) fn measured(x: f64, (factor, name): (f64, &str)) -> String {
    // The last digit of a product is no digit of x.
    let x = if factor == 1.0 {
        x
    } else {
        format!("{:.14e}", x * factor).parse().unwrap_or(x * factor)
    };
    named(number(x), name)
}

/// A number with its unit, if that has a name.
pub(super) fn named(number: String, unit: &str) -> String {
    if unit.is_empty() {
        number
    } else {
        format!("{number} {unit}")
    }
}

/// A time to the digits that are known.
pub(super) fn known(t: f64, uncertainty: Option<f64>, (factor, name): (f64, &str)) -> String {
    /// What the rounding to the digits told may add to a bound.
    const TOLD: f64 = 1.07;
    let Some(uncertainty) = uncertainty else {
        return measured(t, (factor, name));
    };
    let (t, uncertainty) = (t * factor, uncertainty * factor * TOLD);
    let decimals = 2.0 - uncertainty.log10().floor();
    let t = if (0.0..=17.0).contains(&decimals) && t.abs() < 1e15 {
        format!("{t:.*}", decimals as usize)
    } else {
        number(t)
    };
    named(format!("{t} ± {uncertainty:.1e}"), name)
}

pub(super) fn step_too_small(units: &MessageUnits, t: f64, h: f64) -> String {
    let (t, h) = (measured(t, units.time), measured(h, units.time));
    format!(
        "the step fell to {h} at t = {t}, below what can be added to t: just beyond it the right-hand side is not smooth or not defined, \
         so that the solution may end there, or the tolerance is too small"
    )
}

pub(super) fn blow_up(units: &MessageUnits, t: f64, uncertainty: Option<f64>) -> String {
    let t = known(t, uncertainty, units.time);
    format!(
        "the solution blows up in finite time: it grows without bound at t = {t}, and no solution exists beyond"
    )
}

pub(super) fn undecided_end(units: &MessageUnits, t: f64, again: Option<f64>) -> String {
    let second = match again {
        Some(again) => format!("does so at t = {}", measured(again, units.time)),
        None => "does not".to_owned(),
    };
    let t = measured(t, units.time);
    format!(
        "the run grows without bound at t = {t}, but a second one with smaller tolerances {second}: whether the solution ends there is \
         undecided; try a smaller absolute tolerance"
    )
}

pub(super) fn too_fast(
    units: &MessageUnits,
    (t, uncertainty): (f64, Option<f64>),
    overflows: bool,
    lasting: Option<&str>,
) -> String {
    let spacing = measured(t.abs() * f64::EPSILON, units.time);
    let t = known(t, uncertainty, units.time);
    let how = if overflows {
        "its rates exceed 1.8e308, the largest double".to_owned()
    } else {
        format!("it changes within less than {spacing}, the spacing of doubles there")
    };
    let lasting = match lasting {
        Some(name) => format!(
            "; solutions of the law {name} exist for all time, so this is not a blow-up but the limit of double precision"
        ),
        None => String::new(),
    };
    format!(
        "at t = {t} the solution is too fast for double precision: {how}{lasting}; no tolerance helps, a stiffer spring may"
    )
}

pub(super) fn too_many_steps(units: &MessageUnits, limit: usize, t: f64, end: f64) -> String {
    // A run that goes on until it meets something has no end.
    let before = if end.is_finite() {
        format!(", before t = {}", measured(end, units.time))
    } else {
        String::new()
    };
    format!(
        "the limit of {} steps was reached at t = {}{before}; raise `max_steps`, loosen the tolerance or shorten the run",
        count(limit),
        measured(t, units.time)
    )
}

pub(super) fn non_finite(units: &MessageUnits, what: &str, t: f64) -> String {
    let t = measured(t, units.time);
    format!("{what} is not finite at t = {t}, where the solution may end")
}

pub(super) fn underflow(units: &MessageUnits, variable: usize, t: f64) -> String {
    format!(
        "variable {} fell below {:.1e}, the smallest normal double, and grows again: from t = {} on its value is unknown; use its logarithm as the variable",
        variable + 1,
        f64::MIN_POSITIVE,
        measured(t, units.time)
    )
}

pub(super) fn no_return(
    units: &MessageUnits,
    (since, t): (f64, f64),
    section: f64,
    (lowest, highest): (f64, f64),
) -> String {
    let [since, t] = [since, t].map(|t| measured(t, units.time));
    if lowest > highest {
        return format!(
            "no return to the section from t = {since} to t = {t}, which is less than one step; allow more time"
        );
    }
    let [section, lowest, highest] =
        [section, lowest, highest].map(|stress| measured(stress, units.stress));
    format!(
        "no return to the section from t = {since} to t = {t}: the run stayed between {lowest} and {highest}, the section lies at {section}; move the section in between, cross it in the other direction or allow more time"
    )
}

pub(super) fn no_orbit(
    units: &MessageUnits,
    what: &str,
    period: Option<f64>,
    hint: &str,
) -> String {
    let period = period.map_or(String::new(), |period| {
        format!(", of period {}", measured(period, units.time))
    });
    format!("{what}{period}; {hint}")
}

pub(super) fn stuck(units: &MessageUnits, driving: f64, stiffness: f64) -> String {
    let driving = measured(driving, units.slip_rate);
    let stiffness = measured(stiffness, units.stiffness);
    format!(
        "the curve ends at V_H = {driving}, K = {stiffness}, where no further point is found; try a smaller `step_limit`"
    )
}

pub(super) fn wrong_time(units: &MessageUnits, asked: f64, returned: f64) -> String {
    let [asked, returned] = [asked, returned].map(|t| measured(t, units.time));
    format!(
        "asked for the state at t = {asked}, but the integrator returned t = {returned}; try a larger tolerance"
    )
}

pub(super) fn sundials(
    units: &MessageUnits,
    function: &str,
    name: &str,
    code: i32,
    time: Option<f64>,
    message: &str,
) -> String {
    let at = time.map_or(String::new(), |t| {
        format!(" at t = {}", measured(t, units.time))
    });
    let said = if message.is_empty() {
        String::new()
    } else {
        format!(": {message}")
    };
    format!("{function} returned {name} ({code}){at}{said}")
}
