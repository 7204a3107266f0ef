//! What can go wrong, with the numbers that say where, how far off, and what to try.

use std::borrow::Cow;
use std::path::PathBuf;

/// The crate's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Every failure of the library. [`Error::is_input`] separates bad input (exit status 2) from numerical failure (1).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A parameter outside its domain.
    #[error("{name} is {value}, but must be {must}")]
    Parameter {
        /// The parameter as the user names it.
        name: String,
        /// The value given.
        value: String,
        /// What is allowed.
        must: Cow<'static, str>,
    },
    /// An input that can't be read as what it should be: a scene file, a start, a combination of options.
    #[error("{0}")]
    Input(String),
    /// A file that can't be read or written.
    #[error("cannot {action} {}: {reason}", path.display())]
    File {
        /// `read`, `write`, `create`.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The operating system's words.
        reason: String,
    },
    /// A SUNDIALS function returned a negative code.
    #[error("{function} returned {name} ({code}){}{}", at(time), said(message))]
    Sundials {
        /// The C function.
        function: &'static str,
        /// The flag's own name, such as `CV_ERR_FAILURE`.
        name: String,
        /// The flag.
        code: i32,
        /// Time that the integration had reached; `None` where there is none.
        time: Option<f64>,
        /// The message that SUNDIALS would have printed.
        message: String,
    },
    /// An integrator returned successfully at another time than the one asked for (SUNDIALS issue 82).
    #[error(
        "asked for the state at t = {asked}, but the integrator returned t = {returned}; try a larger tolerance"
    )]
    WrongTime {
        /// The time asked for.
        asked: f64,
        /// The time returned.
        returned: f64,
    },
    /// The step fell below the spacing of the floating-point numbers around t.
    #[error(
        "the step fell to {h:e} at t = {t}, below what can be added to t; try a larger tolerance"
    )]
    StepTooSmall {
        /// Time reached.
        t: f64,
        /// Last step tried.
        h: f64,
    },
    /// The solution leaves every bound in finite time: there is nothing to compute beyond t.
    #[error(
        "the solution blows up in finite time: at t = {t} it changes at the rate {rate:e} and accelerates; there is no solution beyond"
    )]
    BlowUp {
        /// Time of the singularity, to rounding.
        t: f64,
        /// Largest component of |dy/dt| there.
        rate: f64,
    },
    /// The bound on work was used up.
    #[error(
        "{limit} steps were used up at t = {t}, before t = {end}; raise --max-steps, loosen the tolerance or shorten the run"
    )]
    TooManySteps {
        /// Time reached.
        t: f64,
        /// Time asked for.
        end: f64,
        /// The bound.
        limit: usize,
    },
    /// A right-hand side was not finite where it had to be.
    #[error("{what} is not finite at t = {t}")]
    NonFinite {
        /// What was evaluated.
        what: &'static str,
        /// Where.
        t: f64,
    },
    /// The field has no formula that power series could run on.
    #[error(
        "this field is not written for power series, which the method taylor needs; choose another method"
    )]
    NotAnalytic,
    /// A run did not come back to the section within the time it was given.
    #[error(
        "no return to the section from t = {since} to t = {t}: the run stayed between {lowest} and {highest}, the section lies at {section}; move the section in between, cross it the other way or wait longer"
    )]
    NoReturn {
        /// Time of the last return; the beginning of the run if there was none.
        since: f64,
        /// Time reached.
        t: f64,
        /// Where the section lies, in the direction of its normal: the stress of a section of constant stress.
        section: f64,
        /// The lowest the run has been since in that direction.
        lowest: f64,
        /// The highest.
        highest: f64,
    },
    /// An iteration stopped before its tolerance.
    #[error(
        "{what} did not converge: residual {residual:e} after {iterations} iterations, {tolerance:e} was asked for"
    )]
    NotConverged {
        /// What was solved.
        what: &'static str,
        /// Iterations made.
        iterations: usize,
        /// Residual reached.
        residual: f64,
        /// Residual asked for.
        tolerance: f64,
    },
    /// A branch or curve went no further than its method could.
    #[error(
        "the curve ends at V_H = {driving}, K = {stiffness}, where the method goes no further; try a smaller --step-limit"
    )]
    Stuck {
        /// V_H reached.
        driving: f64,
        /// K reached.
        stiffness: f64,
    },
    /// A branch or curve has more points than are allowed.
    #[error(
        "stopped after {limit} points, as many as allowed; raise --max-points, or --step-limit for longer steps"
    )]
    TooManyPoints {
        /// The bound.
        limit: usize,
    },
    /// The user stopped it (Ctrl-C), or the caller's callback did.
    #[error("interrupted; what was finished is kept")]
    Interrupted,
    /// Something else was found where a periodic orbit was looked for.
    #[error("{what}; {hint}")]
    NoOrbit {
        /// What happened.
        what: String,
        /// What to try.
        hint: &'static str,
    },
}

impl Error {
    /// A parameter outside its domain: `Error::parameter("K", -1.0, "positive and finite")`.
    pub fn parameter(
        name: impl Into<String>,
        value: impl ToString,
        must: impl Into<Cow<'static, str>>,
    ) -> Self {
        Error::Parameter {
            name: name.into(),
            value: shortest(echoed(value.to_string())),
            must: must.into(),
        }
    }

    /// A name that is none of those that there are, with the one that may have been meant:
    /// `Error::unknown("law", "spinodl", &AnyLaw::NAMES)`.
    pub fn unknown(what: impl Into<String>, given: &str, known: &[&str]) -> Self {
        let list = match known {
            [one] => (*one).to_owned(),
            [others @ .., last] if others.len() < 3 => format!("{} or {last}", others.join(", ")),
            _ => format!("one of {}", known.join(", ")),
        };
        let hint = did_you_mean(given, known.iter().copied());
        Error::parameter(what, given, list + &hint)
    }

    /// Whether the input is to blame (exit status 2) and not the computation (exit status 1).
    pub fn is_input(&self) -> bool {
        matches!(
            self,
            Error::Parameter { .. } | Error::Input(_) | Error::File { .. }
        )
    }
}

/// What was given, as messages show it: of what is long the begin.
fn echoed(given: String) -> String {
    /// Letters that are shown.
    const SHOWN: usize = 80;
    let length = given.chars().count();
    if length <= SHOWN {
        return given;
    }
    let begin: String = given.chars().take(SHOWN).collect();
    format!("{begin}... ({length} letters)")
}

/// Names at least as similar as this (Jaro-Winkler) are offered as what may have been meant.
const SIMILAR: f64 = 0.75;

/// `; did you mean "x"?` for the known name most like the given one, or nothing if none is.
pub fn did_you_mean<'a>(given: &str, known: impl Iterator<Item = &'a str>) -> String {
    // Underscores are what most would write first: they count as hyphens.
    let plain = |name: &str| name.replace('_', "-").to_lowercase();
    let given = plain(given);
    known
        .map(|name| (strsim::jaro_winkler(&given, &plain(name)), name))
        .filter(|&(similarity, _)| similarity >= SIMILAR)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(String::new(), |(_, name)| {
            format!("; did you mean {name:?}?")
        })
}

/// A count with its thousands apart: `63,183`.
pub(crate) fn count(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A number with many zeros is easier to read with an exponent, and nothing at all is easily overlooked.
fn shortest(plain: String) -> String {
    if plain.is_empty() {
        return "\"\"".into();
    }
    match plain.parse::<f64>() {
        Ok(x) if plain.len() > 8 => format!("{x:?}"),
        _ => plain,
    }
}

fn at(time: &Option<f64>) -> String {
    time.map_or(String::new(), |t| format!(" at t = {t}"))
}

fn said(message: &str) -> String {
    if message.is_empty() {
        String::new()
    } else {
        format!(": {message}")
    }
}
