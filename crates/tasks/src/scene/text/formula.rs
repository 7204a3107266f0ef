//! A formula in numbers that have names, as an option gives it.

use super::grammar::{Token, Wrong, parse};
use super::lowering::operation;
use twinslip::error::{Error, Result, did_you_mean};
use twinslip::expression::{Binary, Builder, Expressions, Function, Place};

/// A formula in numbers that have names.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::scene) struct NamedFormula {
    expressions: Expressions,
}

impl NamedFormula {
    /// From the text of an option: an expression in these names by the grammar of files, or `EXPRESSION = EXPRESSION`, which is zero where both are
    /// equal.
    ///
    /// # Errors
    /// [`Error::Input`] with the letter for what is wrong in the text.
    pub fn parse(option: &str, text: &str, names: &[String]) -> Result<Self> {
        let wrong = |Wrong { at, what }| {
            let letter = text[..at].chars().count() + 1;
            Error::Input(format!("`{option}` {text:?}, letter {letter}: {what}"))
        };
        let mut builder = Builder::default();
        let mut whole: Option<Place> = None;
        let mut begin = 0;
        for (number, side) in text.split('=').enumerate() {
            if number > 1 {
                let what = "a second `=`; there is one at most";
                return Err(wrong(Wrong::new(begin - 1, what)));
            }
            let place = lowered(&mut builder, side, names)
                .map_err(|error| wrong(Wrong::new(begin + error.at, error.what)))?;
            whole = Some(match whole {
                None => place,
                Some(first) => builder.binary(Binary::Difference, first, place)?,
            });
            begin += side.len() + 1;
        }
        let expressions = builder.complete(whole.into_iter().collect());
        if !(0..names.len()).any(|i| expressions.names_variable(i)) {
            return Err(Error::Input(format!(
                "`{option}` {text:?} names nothing that varies: it must be a formula in some of {}",
                names.join(", ")
            )));
        }
        Ok(NamedFormula { expressions })
    }

    /// Whether it names the i-th of the names.
    pub fn names(&self, i: usize) -> bool {
        self.expressions.names_variable(i)
    }

    /// Its value for these values of the names.
    pub fn at(&self, values: &[f64]) -> f64 {
        let all = self.expressions.evaluate(values, &[]);
        all.first().copied().unwrap_or(f64::NAN)
    }
}

/// The place of what a formula makes of the variables that have these names.
fn lowered(builder: &mut Builder, text: &str, names: &[String]) -> Result<Place, Wrong> {
    let mut stack = Vec::new();
    for item in parse(text)? {
        let made = match &item.token {
            Token::Name(name) => match names.iter().position(|known| known == name) {
                Some(i) => builder.variable(i),
                None if name == "pi" => builder.pi(),
                None => return Err(Wrong::new(item.at, unknown(name, names))),
            },
            token => operation(builder, token, &mut stack),
        };
        stack.push(made.map_err(|error| Wrong::new(item.at, error.to_string()))?);
    }
    let whole = stack.pop().filter(|_| stack.is_empty());
    whole.ok_or_else(|| Wrong::new(0, "the formula is incomplete"))
}

/// What is said of a name that is none.
fn unknown(name: &str, names: &[String]) -> String {
    if Function::named(name).is_some() {
        return format!("{name:?} is a function, whose argument must follow in parentheses");
    }
    let hint = did_you_mean(name, names.iter().map(String::as_str).chain(["pi"]));
    let known = names.join(", ");
    format!("{name:?} has no value here; there are {known}{hint}")
}
