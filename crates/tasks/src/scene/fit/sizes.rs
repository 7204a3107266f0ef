//! Sizes that nothing in a laboratory has, which tell of a unit that is not stated.

use twinslip::error::{Error, Result};

/// No friction coefficient is larger.
const MOST_FRICTION: f64 = 3.0;
/// No normal stress, in Pa, is smaller.
const LEAST_STRESS: f64 = 1e3;
/// So far, in m, and so fast, in m/s, a load point goes only where its column states its unit.
const FARTHEST: f64 = 0.1;
const FASTEST: f64 = 1.0;

/// # Errors
/// [`Error::Input`] for a friction coefficient that nothing has; `line` says where a sample is.
pub(super) fn friction(
    friction: &[f64],
    column: &str,
    line: impl Fn(usize) -> String,
) -> Result<()> {
    match friction.iter().position(|mu| mu.abs() > MOST_FRICTION) {
        None => Ok(()),
        Some(at) => Err(Error::Input(format!(
            "{}: the friction, column {column}, is {}, but no friction coefficient is above {MOST_FRICTION}; if it is a stress, state its unit, such as `friction` \"{column} [MPa]\"",
            line(at),
            friction[at]
        ))),
    }
}

/// # Errors
/// [`Error::Input`] for a normal stress, in a column that states no unit, that no experiment has.
pub(super) fn normal_stress(mean: f64, own: &str, is_stated: bool) -> Result<()> {
    if is_stated || mean >= LEAST_STRESS {
        return Ok(());
    }
    Err(Error::Input(format!(
        "{own}, states no unit, and would be {mean} Pa on average; state its unit, such as `normal_stress_column` \"NAME [MPa]\""
    )))
}

/// Counts a displacement, `own` in words, upwards, and says what is not certain of it.
///
/// # Errors
/// [`Error::Input`] for one that is in no unit that is stated, and cannot be in m.
pub(super) fn displacement(
    times: &[f64],
    moved: &mut [f64],
    own: &str,
    is_stated: bool,
) -> Result<Vec<String>> {
    let (first, last) = (moved[0], moved[moved.len() - 1]);
    let mut notes = Vec::new();
    if last < first {
        for x in moved.iter_mut() {
            *x = -*x;
        }
        notes.push(format!("{own} decreases, so its sign is reversed"));
    }
    let far = (last - first).abs();
    let speed = far / (times[times.len() - 1] - times[0]);
    let is_large = far > FARTHEST || speed > FASTEST;
    let how = "state its unit, such as `displacement` \"NAME [um]\"";
    match (is_stated, is_large) {
        (false, true) => {
            return Err(Error::Input(format!(
                "{own}, states no unit, and would be {far:.3e} m in this window, at {speed:.3e} m/s on average; {how}"
            )));
        }
        (false, false) => notes.push(format!(
            "{own}, states no unit and is taken in m, so that the load point goes {far:.3e} m: if that is not so, {how}"
        )),
        (true, true) if speed > FASTEST => notes.push(format!(
            "{own}, goes at {speed:.3e} m/s on average, by the unit that it states"
        )),
        (true, _) => {}
    }
    Ok(notes)
}
