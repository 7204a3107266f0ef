//! What can go wrong, with the numbers that say where, how far off, and what to try.

mod messages;

use messages::{
    blow_up, no_orbit, no_return, non_finite, step_too_small, stuck, sundials, too_fast,
    too_many_steps, undecided_end, underflow, wrong_time,
};
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
    #[error("{}", sundials(&MessageUnits::NONE, function, name, *code, *time, message))]
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
    #[error("{}", wrong_time(&MessageUnits::NONE, *asked, *returned))]
    WrongTime {
        /// The time asked for.
        asked: f64,
        /// The time returned.
        returned: f64,
    },
    /// The step fell below the spacing of the floating-point numbers around t.
    #[error("{}", step_too_small(&MessageUnits::NONE, *t, *h))]
    StepTooSmall {
        /// Time reached.
        t: f64,
        /// Last step tried.
        h: f64,
    },
    /// The solution leaves every bound in finite time: there is nothing to compute beyond t.
    #[error("{}", blow_up(&MessageUnits::NONE, *t, *uncertainty))]
    BlowUp {
        /// Time of the singularity, as the run has it.
        t: f64,
        /// Bound on the error of t, where a second run has given one.
        uncertainty: Option<f64>,
        /// Largest component of |dy/dt| where the run ended.
        rate: f64,
    },
    /// A run leaves every bound in finite time, but a second one with smaller tolerances does not, or at quite another time: whether the
    /// solution ends is undecided.
    #[error("{}", undecided_end(&MessageUnits::NONE, *t, *again))]
    UndecidedEnd {
        /// Time at which the run left every bound.
        t: f64,
        /// The time at which the second run did, if it did.
        again: Option<f64>,
    },
    /// The solution goes on, but for a while it changes faster than doubles can follow: within less than the spacing of the
    /// numbers around t, or beyond the largest of them.
    #[error("{}", too_fast(&MessageUnits::NONE, (*t, *uncertainty), *overflows, *lasting))]
    TooFast {
        /// Time at which it does, as the run has it.
        t: f64,
        /// Bound on the error of t, where a second run has given one.
        uncertainty: Option<f64>,
        /// Largest component of |dy/dt| where the run ended.
        rate: f64,
        /// Whether the rates go on to leave the range of doubles.
        overflows: bool,
        /// The equations whose solutions are known to exist for all time, where they are: a friction law by its name.
        lasting: Option<&'static str>,
    },
    /// The bound on work was used up.
    #[error("{}", too_many_steps(&MessageUnits::NONE, *limit, *t, *end))]
    TooManySteps {
        /// Time reached.
        t: f64,
        /// Time asked for.
        end: f64,
        /// The bound.
        limit: usize,
    },
    /// A right-hand side was not finite where it had to be.
    #[error("{}", non_finite(&MessageUnits::NONE, what, *t))]
    NonFinite {
        /// What was evaluated.
        what: &'static str,
        /// Where.
        t: f64,
    },
    /// A variable that is a factor of its own rate fell below the least double and grew again: its digits are lost.
    #[error("{}", underflow(&MessageUnits::NONE, *variable, *t))]
    Underflow {
        /// Its place among the variables, from 0.
        variable: usize,
        /// The time at which it is not known any more.
        t: f64,
    },
    /// The field has no formula that power series could run on.
    #[error(
        "the method taylor needs equations that have power series, and these have none; choose another method"
    )]
    NotAnalytic,
    /// A run did not come back to the section within the time it was given.
    #[error("{}", no_return(&MessageUnits::NONE, (*since, *t), *section, (*lowest, *highest)))]
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
        "{what} did not converge: residual {residual:e} after {iterations} iterations, tolerance {tolerance:e}"
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
    #[error("{}", stuck(&MessageUnits::NONE, *driving, *stiffness))]
    Stuck {
        /// V_H reached.
        driving: f64,
        /// K reached.
        stiffness: f64,
    },
    /// A branch or curve has more points than are allowed.
    #[error(
        "stopped at the limit of {limit} points; raise `max_points`, or `step_limit` for longer steps"
    )]
    TooManyPoints {
        /// The bound.
        limit: usize,
    },
    /// A formula that holds in few dimensions only was asked of a larger system.
    #[error(
        "{what} is available only for systems of {known} variables, and this one has {dimension}"
    )]
    Dimension {
        /// The formula.
        what: &'static str,
        /// Where it holds: `2 or 3`.
        known: &'static str,
        /// The number of variables.
        dimension: usize,
    },
    /// The user stopped it (Ctrl-C), or the caller's callback did.
    #[error("interrupted; what was finished is kept")]
    Interrupted,
    /// Something else was found where a periodic orbit was looked for.
    #[error("{}", no_orbit(&MessageUnits::NONE, what, *period, hint))]
    NoOrbit {
        /// What happened.
        what: String,
        /// The period of what was found instead.
        period: Option<f64>,
        /// What to try.
        hint: &'static str,
    },
    /// Another error in other words: in the user's units, or with advice.
    #[error("{words}")]
    InUnits {
        /// The error itself, dimensionless.
        error: Box<Error>,
        /// What it says.
        words: String,
    },
}

/// The units in which an error tells its numbers: how large one dimensionless unit is, and the name behind a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MessageUnits {
    /// Of times.
    pub time: (f64, &'static str),
    /// Of stresses.
    pub stress: (f64, &'static str),
    /// Of slip rates.
    pub slip_rate: (f64, &'static str),
    /// Of stiffnesses.
    pub stiffness: (f64, &'static str),
}

impl MessageUnits {
    /// Numbers as they are, without a name.
    const NONE: MessageUnits = MessageUnits {
        time: (1.0, ""),
        stress: (1.0, ""),
        slip_rate: (1.0, ""),
        stiffness: (1.0, ""),
    };
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
            value: echoed(shortest(value.to_string())),
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

    /// A parameter that an option names and that there is not: `Error::no_parameter("set", "foo", &["driving", "stiffness"])`.
    pub fn no_parameter(option: &str, given: &str, known: &[&str]) -> Self {
        let hint = did_you_mean(given, known.iter().copied());
        let (option, given) = (option_name(option), echoed(given.to_owned()));
        Error::Input(format!(
            "{option}: no parameter `{given}`; known are {}{hint}",
            known.join(", ")
        ))
    }

    /// Whether a solution left every bound, or what doubles can follow.
    pub fn runs_away(&self) -> bool {
        match self {
            Error::BlowUp { .. } | Error::TooFast { .. } | Error::UndecidedEnd { .. } => true,
            Error::InUnits { error, .. } => error.runs_away(),
            _ => false,
        }
    }

    /// The same error, which ends with what else would help.
    pub fn advising(self, advice: &str) -> Self {
        let words = format!("{self}; {advice}");
        Error::InUnits {
            error: Box::new(self),
            words,
        }
    }

    /// That a formula holds for so many variables.
    ///
    /// # Errors
    /// [`Error::Dimension`] where it does not.
    pub fn dimension_unless(
        holds: bool,
        what: &'static str,
        known: &'static str,
        dimension: usize,
    ) -> std::result::Result<(), Self> {
        if holds {
            return Ok(());
        }
        Err(Error::Dimension {
            what,
            known,
            dimension,
        })
    }

    /// The same error, with its times, stresses, slip rates and stiffnesses told in these units.
    pub fn in_units(self, units: &MessageUnits) -> Self {
        let words = match &self {
            Error::StepTooSmall { t, h } => step_too_small(units, *t, *h),
            Error::BlowUp { t, uncertainty, .. } => blow_up(units, *t, *uncertainty),
            Error::UndecidedEnd { t, again } => undecided_end(units, *t, *again),
            Error::TooFast {
                t,
                uncertainty,
                overflows,
                lasting,
                ..
            } => too_fast(units, (*t, *uncertainty), *overflows, *lasting),
            Error::TooManySteps { t, end, limit } => too_many_steps(units, *limit, *t, *end),
            Error::NonFinite { what, t } => non_finite(units, what, *t),
            Error::Underflow { variable, t } => underflow(units, *variable, *t),
            Error::NoReturn {
                since,
                t,
                section,
                lowest,
                highest,
            } => no_return(units, (*since, *t), *section, (*lowest, *highest)),
            Error::Stuck { driving, stiffness } => stuck(units, *driving, *stiffness),
            Error::WrongTime { asked, returned } => wrong_time(units, *asked, *returned),
            Error::NoOrbit { what, period, hint } => no_orbit(units, what, *period, hint),
            // The message of SUNDIALS tells times of its own.
            Error::Sundials {
                function,
                name,
                code,
                time,
                ..
            } => sundials(units, function, name, *code, *time, ""),
            _ => return self,
        };
        Error::InUnits {
            error: Box::new(self),
            words,
        }
    }

    /// Whether the input is to blame (exit status 2) and not the computation (exit status 1).
    pub fn is_input(&self) -> bool {
        match self {
            Error::Parameter { .. }
            | Error::Input(_)
            | Error::File { .. }
            | Error::Dimension { .. } => true,
            Error::InUnits { error, .. } => error.is_input(),
            _ => false,
        }
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

/// An option in a message: its field's name in backticks, whether it is given by that or as a flag has it, with hyphens.
#[doc(hidden)]
pub fn option_name(name: &str) -> String {
    format!("`{}`", name.replace('-', "_"))
}

/// A count with its thousands apart: `63,183`.
#[doc(hidden)]
pub fn count(n: usize) -> String {
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
        Ok(x) if format!("{x:?}").len() < plain.len() => format!("{x:?}"),
        _ => plain,
    }
}
