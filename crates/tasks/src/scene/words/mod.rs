//! A command line as it is typed, turned into plain options: numbers with units into numbers in SI, symbols into names of parameters, and
//! ranges `NAME=A:B` into a name and the ends of the range.
//!
//! This is done on the words, before they are parsed, so that flags, scene files and Python share one behaviour in all commands.

mod merge;
mod ranges;
mod symbols;
mod unit;

pub(super) use merge::merged;
pub(super) use symbols::{indexed, symbol};
pub(super) use unit::{Kind, with_unit};

use super::command::Command;
use super::ensemble::implied;
use super::program::is_table;
use super::units::TimeUnit;
use clap::Subcommand;
use twinslip::friction::AnyLaw;

const SI: &str = "--si";

/// What an option takes, where that is more than a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shape {
    /// Numbers with commas or colons between.
    Numbers(Kind),
    /// Times of a run; likewise.
    Times,
    /// `T:V,T1-T2:V,...`.
    Program,
    /// The first number is a stress.
    Start,
    /// `NAME=EPS:PERIOD[:PHASE]`.
    Modulation,
    /// `NAME=NUMBERS`, with commas between.
    Pairs,
    /// Values of the parameter that varies, whose name may stand before them.
    At,
    /// Names of parameters, which may have ranges.
    Along,
    In,
    /// Names of laws.
    Law,
}

/// A command line in plain options.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plain {
    /// What stands in place of each word; `None` where the word stays.
    pub words: Vec<Option<Vec<String>>>,
    /// An option that follows from the others, if it does.
    pub implied: Option<&'static str>,
    /// The first value with a unit.
    pub with_unit: Option<String>,
    /// The options whose values have dimensions and no unit.
    pub without_unit: Vec<String>,
}

/// A command line, the name of the program first, in plain options.
///
/// # Errors
/// A sentence for a unit that is not known or of the wrong kind, and for a range that is none.
pub fn plain<S: AsRef<str>>(words: &[S]) -> Result<Plain, String> {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    let mut line = Plain {
        words: vec![None; words.len()],
        implied: implied(&words),
        with_unit: None,
        without_unit: Vec::new(),
    };
    // The page of `explore` begins with options of the model.
    let has_options = |word: &&&str| Command::has_subcommand(word) || **word == "explore";
    let Some(command) = words.get(1).filter(has_options) else {
        return Ok(line);
    };
    let context = Context::of(command, &words);
    let mut place = 2;
    while let Some(&word) = words.get(place).filter(|word| **word != "--") {
        let here = place;
        place += 1;
        let (flag, value) = match word.strip_prefix("--").map(|word| word.split_once('=')) {
            Some(Some((flag, value))) => (flag, Some(value)),
            Some(None) => (&word[2..], words.get(place).copied()),
            None => continue,
        };
        let (Some(shape), Some(value)) = (context.shape(flag), value) else {
            continue;
        };
        let mut made = Made::new(&context, flag);
        let options = made
            .options(shape, value)
            .map_err(|why| format!("`{flag}` {why}"))?;
        if made.with_unit && line.with_unit.is_none() {
            line.with_unit = Some(format!("--{flag} {value}"));
        }
        if made.without_unit && !made.with_unit {
            line.without_unit.push(format!("--{flag} {value}"));
        }
        let followed = !word.contains('=');
        if options != [(flag.to_owned(), value.to_owned())] {
            let options = options
                .iter()
                .map(|(flag, value)| format!("--{flag}={value}"));
            line.words[here] = Some(options.collect());
            if followed {
                line.words[place] = Some(Vec::new());
            }
        }
        place += usize::from(followed);
    }
    let si_is_an_option = context.command != "fit";
    if line.with_unit.is_some() && si_is_an_option && !words.contains(&SI) {
        line.implied = Some(SI);
    }
    Ok(line)
}

impl Plain {
    /// A sentence on numbers without a unit beside others with one, which say that all are in SI.
    pub fn warning(&self) -> Option<String> {
        let first = self.without_unit.first()?;
        (self.implied == Some(SI) && self.with_unit.is_some()).then(|| {
            let (others, are) = match self.without_unit.len() {
                1 => (String::new(), "is"),
                n => (format!(" and {} more", n - 1), "are"),
            };
            format!("{first}{others} {are} without a unit and {are} read in SI, as other values have units")
        })
    }

    /// The words with what stands in their place.
    pub fn applied<W: Clone + From<String>>(&self, words: &[W]) -> Vec<W> {
        let mut all = Vec::with_capacity(words.len() + 1);
        for (word, new) in words.iter().zip(&self.words) {
            match new {
                Some(new) => all.extend(new.iter().cloned().map(W::from)),
                None => all.push(word.clone()),
            }
        }
        all.extend(self.implied.map(|flag| W::from(flag.to_owned())));
        all
    }
}

/// What the meaning of other options depends on.
#[derive(Debug, Clone, Copy)]
struct Context<'a> {
    command: &'a str,
    /// A system from a file has its own names and no units.
    system: bool,
    /// A law from a file may have parameters that are called as the symbols are.
    law_file: bool,
    along: &'a str,
    /// The unit of times of a run, in seconds.
    seconds: f64,
}

impl<'a> Context<'a> {
    fn of(command: &'a str, words: &[&'a str]) -> Self {
        let last = |flag: &str| {
            let mut pairs = words.iter().enumerate().rev();
            pairs.find_map(|(place, word)| match word.strip_prefix(flag) {
                Some("") => words.get(place + 1).copied(),
                Some(rest) => rest.strip_prefix('='),
                None => None,
            })
        };
        let law = last("--law").map(symbols::law);
        let along = last("--along").unwrap_or("driving");
        let unit = last("--time-unit").map(TimeUnit::named);
        Context {
            command,
            system: last("--system").is_some(),
            law_file: law.is_some_and(|law| !AnyLaw::NAMES.contains(&law)),
            along: along.split('=').next().unwrap_or(along),
            seconds: unit.and_then(Result::ok).map_or(1.0, TimeUnit::seconds),
        }
    }

    fn shape(&self, flag: &str) -> Option<Shape> {
        let shape = match flag {
            "along" => return Some(Shape::Along),
            "in" => return Some(Shape::In),
            "range" => return Some(Shape::Pairs),
            "at" if self.command == "branch" => return Some(Shape::At),
            _ if self.system => return None,
            "law" => Shape::Law,
            "program" => Shape::Program,
            "start" => Shape::Start,
            "modulate" => Shape::Modulation,
            "set" | "grid" | "draw" | "bounds" | "surface" | "state-1" | "state-2" => Shape::Pairs,
            "at" if self.command == "locus" => Shape::Pairs,
            "from" | "to" => match self.command {
                "law" => Shape::Numbers(Kind::Velocity),
                "fit" => Shape::Times,
                _ => Shape::Numbers(self.measures(&self.parameter(self.along))?),
            },
            "until" | "every" | "patience" | "period-guess" | "max-step" => Shape::Times,
            "shear-modulus" => Shape::Numbers(Kind::Stress),
            "shear-wave-speed" | "driving-range" | "at-driving" => Shape::Numbers(Kind::Velocity),
            "stiffness-range" | "at-stiffness" => Shape::Numbers(Kind::Stiffness),
            flag => Shape::Numbers(symbols::measures(&flag.replace('-', "_"))?),
        };
        Some(shape)
    }

    /// The name of a parameter that may be given by its symbol.
    fn parameter(&self, symbol: &str) -> String {
        match self.system || self.law_file {
            true => symbol.to_owned(),
            false => symbols::parameter(symbol),
        }
    }

    /// What a parameter measures; nothing is known of those of systems from files.
    fn measures(&self, name: &str) -> Option<Kind> {
        symbols::measures(name).filter(|_| !self.system)
    }
}

/// The plain options of one that was typed.
struct Made<'a> {
    context: &'a Context<'a>,
    flag: &'a str,
    with_unit: bool,
    without_unit: bool,
}

impl<'a> Made<'a> {
    fn new(context: &'a Context<'a>, flag: &'a str) -> Self {
        Made {
            context,
            flag,
            with_unit: false,
            without_unit: false,
        }
    }

    /// Names and values of options.
    fn options(&mut self, shape: Shape, value: &str) -> Result<Vec<(String, String)>, String> {
        let seconds = self.context.seconds;
        let value = match shape {
            Shape::Along => return self.along(value),
            Shape::In => return self.within(value),
            Shape::Pairs => return self.pairs(value),
            Shape::At => {
                let along = self.context.along;
                let values = value
                    .strip_prefix(along)
                    .and_then(|rest| rest.strip_prefix('='))
                    .unwrap_or(value);
                match self.context.measures(&self.context.parameter(along)) {
                    Some(kind) => self.numbers(values, kind, 1.0)?,
                    None => values.to_owned(),
                }
            }
            Shape::Law => {
                let names: Vec<&str> = value.split(',').map(symbols::law).collect();
                names.join(",")
            }
            Shape::Numbers(kind) => self.numbers(value, kind, 1.0)?,
            Shape::Times => self.numbers(value, Kind::Time, seconds)?,
            Shape::Program => self.program(value)?,
            Shape::Modulation => {
                let (name, numbers) = value.split_once('=').unwrap_or((value, ""));
                let mut parts: Vec<String> = numbers.split(':').map(str::to_owned).collect();
                if let Some(period) = parts.get_mut(1) {
                    *period = self.number(period, Kind::Time, seconds)?;
                }
                format!("{}={}", self.context.parameter(name), parts.join(":"))
            }
            Shape::Start => {
                let (stress, states) = value.split_at(value.find(',').unwrap_or(value.len()));
                self.number(stress, Kind::Stress, 1.0)? + states
            }
        };
        Ok(vec![(self.flag.to_owned(), value)])
    }

    /// The velocities and times of a program; a file, or its text, stays.
    fn program(&mut self, text: &str) -> Result<String, String> {
        if is_table(text) {
            return Ok(text.to_owned());
        }
        let seconds = self.context.seconds;
        let changes = text.split(',').map(|change| {
            let Some((times, velocity)) = change.split_once(':') else {
                return Ok(change.to_owned());
            };
            let velocity = self.number(velocity, Kind::Velocity, 1.0)?;
            // The hyphen of a ramp, and not that of an exponent.
            let ramp = times
                .char_indices()
                .skip(1)
                .find(|&(place, c)| c == '-' && !times[..place].ends_with(['e', 'E', ' ']));
            Ok(match ramp {
                Some((place, _)) => format!(
                    "{}-{}:{velocity}",
                    self.number(&times[..place], Kind::Time, seconds)?,
                    self.number(&times[place + 1..], Kind::Time, seconds)?
                ),
                None => format!("{}:{velocity}", self.number(times, Kind::Time, seconds)?),
            })
        });
        Ok(changes.collect::<Result<Vec<String>, String>>()?.join(","))
    }

    /// `A:B:N[log]` and `A,B`: what has units, without.
    fn numbers(&mut self, text: &str, kind: Kind, seconds: f64) -> Result<String, String> {
        let mut all = String::with_capacity(text.len());
        for part in text.split_inclusive([':', ',', ';']) {
            let end = part.trim_end_matches([':', ',', ';']);
            all += &self.number(end, kind, seconds)?;
            all += &part[end.len()..];
        }
        Ok(all)
    }

    fn number(&mut self, text: &str, kind: Kind, seconds: f64) -> Result<String, String> {
        let (number, log) = match text.strip_suffix("log") {
            Some(number) => (number, "log"),
            None => (text, ""),
        };
        // The stiffness of a fit may be friction per length.
        let of_friction = self.context.command == "fit"
            && with_unit(number).is_some_and(|(_, unit)| unit.starts_with('/'));
        if of_friction {
            return Ok(text.to_owned());
        }
        match unit::in_si(number, kind, seconds).map_err(|why| format!("{text}: {why}"))? {
            Some(x) => {
                self.with_unit = true;
                Ok(format!("{x:?}{log}"))
            }
            None => {
                let is_number = number.trim().parse().is_ok_and(|x: f64| x != 0.0);
                self.without_unit |= is_number && kind != Kind::Number;
                Ok(text.to_owned())
            }
        }
    }
}
