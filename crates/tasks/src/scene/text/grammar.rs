//! The grammar of formulas: numbers, names, calls, `+ - * / ^` and parentheses, by the combinators of winnow.
//!
//! A formula becomes its operations in the order in which a stack machine carries them out, each with its place in the text.

use twinslip::error::did_you_mean;
use twinslip::expression::{Binary, Function};
use winnow::ModalResult;
use winnow::ascii::{digit0, digit1, multispace0};
use winnow::combinator::{Infix, Prefix, cut_err, expression, opt, separated};
use winnow::error::{ErrMode, ParserError};
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location, Stateful};
use winnow::token::{any, one_of, take_while};

/// No formula is longer, in bytes.
pub(super) const LONGEST: usize = 4000;
/// Parentheses, signs and powers within each other.
const DEEPEST: usize = 64;

/// An operation, and where it stands in the text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Item {
    pub at: usize,
    pub token: Token,
}

/// What a stack machine does with the last numbers that it has made.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name(String),
    Negative,
    Binary(Binary),
    Call(Function),
}

/// What is wrong at a place of the text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wrong {
    pub at: usize,
    pub what: String,
}

impl Wrong {
    pub fn new(at: usize, what: impl Into<String>) -> Self {
        let what = what.into();
        Wrong { at, what }
    }
}

/// The text, and how deep in parentheses, signs and powers it is read.
type Text<'i> = Stateful<LocatingSlice<&'i str>, usize>;
type Items = Vec<Item>;
type Read<T> = ModalResult<T, Wrong>;

impl ParserError<Text<'_>> for Wrong {
    type Inner = Self;

    fn from_input(input: &Text<'_>) -> Self {
        let found = match input.input.chars().next() {
            None => "the formula ends".to_owned(),
            Some(c) => format!("`{c}` stands"),
        };
        let what = format!("{found} where a number, a name or `(` is expected");
        Wrong::new(input.current_token_start(), what)
    }

    fn into_inner(self) -> Result<Self, Self> {
        Ok(self)
    }
}

/// The operations of a formula.
pub(super) fn parse(text: &str) -> Result<Items, Wrong> {
    if text.len() > LONGEST {
        return Err(Wrong::new(
            0,
            format!(
                "a formula of {} letters; at most {LONGEST} are allowed",
                text.len()
            ),
        ));
    }
    let mut input = Text {
        input: LocatingSlice::new(text),
        state: 0,
    };
    let read = formula(&mut input).and_then(|items| {
        let rest = input.input.chars().next();
        match rest {
            None => Ok(items),
            Some(c) => cut(input.current_token_start(), unexpected(c)),
        }
    });
    read.map_err(|error| match error {
        ErrMode::Backtrack(wrong) | ErrMode::Cut(wrong) => wrong,
        ErrMode::Incomplete(_) => Wrong::new(text.len(), "the formula ends too early"),
    })
}

/// What stands behind a whole formula.
fn unexpected(c: char) -> String {
    match c {
        ')' => "`)` closes nothing".to_owned(),
        ',' => "`,` stands outside of the arguments of a function".to_owned(),
        c if c.is_alphanumeric() || "_(.".contains(c) => {
            format!("`{c}` stands where an operator is expected; products need `*`")
        }
        c => format!("`{c}` is no operator; there are + - * / ^"),
    }
}

fn cut<T>(at: usize, what: impl Into<String>) -> Read<T> {
    Err(ErrMode::Cut(Wrong::new(at, what)))
}

fn formula(input: &mut Text<'_>) -> Read<Items> {
    let items = expression(operand)
        .prefix(sign)
        .infix(operator)
        .parse_next(input)?;
    multispace0.parse_next(input)?;
    Ok(items)
}

/// One level deeper, unless that is too deep.
fn descend(input: &mut Text<'_>, at: usize) -> Read<()> {
    input.state += 1;
    if input.state > DEEPEST {
        return cut(
            at,
            format!("parentheses, signs and powers are nested more than {DEEPEST} deep"),
        );
    }
    Ok(())
}

/// Binds less than a power and more than a product.
fn sign<'i>(input: &mut Text<'i>) -> Read<Prefix<Text<'i>, Items, ErrMode<Wrong>>> {
    const POWER: i64 = 7;
    multispace0.parse_next(input)?;
    let at = input.current_token_start();
    let sign = one_of(['-', '+']).parse_next(input)?;
    descend(input, at)?;
    Ok(match sign {
        '-' => Prefix(POWER, |input: &mut Text<'_>, mut items: Items| {
            input.state -= 1;
            let at = items[0].at;
            items.push(Item {
                at,
                token: Token::Negative,
            });
            Ok(items)
        }),
        _ => Prefix(POWER, |input: &mut Text<'_>, items| {
            input.state -= 1;
            Ok(items)
        }),
    })
}

fn operator<'i>(input: &mut Text<'i>) -> Read<Infix<Text<'i>, Items, ErrMode<Wrong>>> {
    multispace0.parse_next(input)?;
    let at = input.current_token_start();
    let operator = one_of(['+', '-', '*', '/', '^']).parse_next(input)?;
    if operator == '*' && input.input.starts_with('*') {
        return cut(at, "`**` is no operator; powers are written with ^");
    }
    Ok(match operator {
        '+' => Infix::Left(3, |_, a, b| Ok(joined(a, b, Binary::Sum))),
        '-' => Infix::Left(3, |_, a, b| Ok(joined(a, b, Binary::Difference))),
        '*' => Infix::Left(5, |_, a, b| Ok(joined(a, b, Binary::Product))),
        '/' => Infix::Left(5, |_, a, b| Ok(joined(a, b, Binary::Quotient))),
        _ => {
            descend(input, at)?;
            Infix::Right(9, |input: &mut Text<'_>, a, b| {
                input.state -= 1;
                Ok(joined(a, b, Binary::Power))
            })
        }
    })
}

fn joined(mut a: Items, b: Items, binary: Binary) -> Items {
    let at = b[0].at;
    a.extend(b);
    a.push(Item {
        at,
        token: Token::Binary(binary),
    });
    a
}

fn operand(input: &mut Text<'_>) -> Read<Items> {
    multispace0.parse_next(input)?;
    let at = input.current_token_start();
    match input.input.chars().next() {
        Some(c) if c.is_ascii_digit() || c == '.' => number(input, at),
        Some(c) if begins_name(c) => name(input, at),
        Some('(') => {
            any.parse_next(input)?;
            descend(input, at)?;
            let items = cut_err(formula).parse_next(input)?;
            closed(input, at)?;
            Ok(items)
        }
        _ => Err(ErrMode::Backtrack(Wrong::from_input(input))),
    }
}

/// The parenthesis that closes the one at a place.
fn closed(input: &mut Text<'_>, opened: usize) -> Read<()> {
    match input.input.chars().next() {
        Some(')') => {
            any.parse_next(input)?;
            input.state -= 1;
            Ok(())
        }
        None => cut(opened, "`(` is not closed"),
        Some(c) => cut(input.current_token_start(), unexpected(c)),
    }
}

fn number(input: &mut Text<'_>, at: usize) -> Read<Items> {
    let exponent = (one_of(['e', 'E']), opt(one_of(['-', '+'])), digit1);
    let text = (digit0, opt(('.', digit0)), opt(exponent))
        .take()
        .parse_next(input)?;
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(vec![Item {
            at,
            token: Token::Number(x),
        }]),
        Ok(_) => cut(at, format!("{text} is beyond the range of numbers")),
        Err(_) => cut(at, format!("`{text}` is no number")),
    }
}

/// Whether a name may begin with this.
pub(super) fn begins_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

/// Whether a name may go on with this.
pub(super) fn continues_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// A name, or a function with its arguments.
fn name(input: &mut Text<'_>, at: usize) -> Read<Items> {
    let name: &str = take_while(1.., continues_name).parse_next(input)?;
    let name = name.to_owned();
    multispace0.parse_next(input)?;
    let opened = input.current_token_start();
    if !input.input.starts_with('(') {
        return Ok(vec![Item {
            at,
            token: Token::Name(name),
        }]);
    }
    let Some(function) = Function::named(&name) else {
        let hint = did_you_mean(&name, Function::NAMES.into_iter());
        let known = Function::NAMES.join(", ");
        return cut(
            at,
            format!("{name:?} is no function, there are {known}{hint}"),
        );
    };
    any.parse_next(input)?;
    descend(input, opened)?;
    let arguments: Vec<Items> = separated(1.., cut_err(formula), ',').parse_next(input)?;
    closed(input, opened)?;
    let count = function.arguments();
    if arguments.len() != count {
        let must = if count == 1 {
            "one argument"
        } else {
            "two arguments"
        };
        return cut(
            at,
            format!("{name:?} takes {must}, and has {} here", arguments.len()),
        );
    }
    let mut items = arguments.concat();
    items.push(Item {
        at,
        token: Token::Call(function),
    });
    Ok(items)
}
