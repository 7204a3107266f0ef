//! From the formulas of a file to operations: names looked up, those of `[where]` put in their places.

use super::file::{Formula, Meaning, TIME, Tables, TimeUse};
use super::grammar::{Token, Wrong};
use twinslip::error::{Error, Result, did_you_mean};
use twinslip::expression::{Binary, Builder, Expressions, Function, Place};

/// The operations of all rates; and where time is first named, if it is. It is then the variable after the states, and has the rate after theirs.
pub(super) fn lowered(tables: &Tables<'_>) -> Result<(Expressions, Option<TimeUse>)> {
    lowered_by(tables, None)
}

/// The same with a period of all that depends on time: in the place of time the variable after the states is then its phase, which goes from 0 to 1 in
/// a period.
pub(super) fn lowered_by_phase(
    tables: &Tables<'_>,
    period: &Formula<'_>,
) -> Result<(Expressions, Option<TimeUse>)> {
    lowered_by(tables, Some(period))
}

fn lowered_by(
    tables: &Tables<'_>,
    period: Option<&Formula<'_>>,
) -> Result<(Expressions, Option<TimeUse>)> {
    let states: Vec<_> = (0..tables.states.len()).map(Some).collect();
    let mut lowering = Lowering::of(tables, &states);
    if let Some(period) = period {
        lowering.states = &[];
        lowering.period = Some(lowering.place(period)?);
        lowering.states = &states;
    }
    lowering.takes_time = true;
    lowering.check()?;
    let rates = tables.rates.iter();
    let rates: Result<Vec<Place>> = rates.map(|rate| lowering.place(rate)).collect();
    let mut rates = rates?;
    if lowering.time.is_some() {
        let one = lowering.builder.number(1.0)?;
        rates.push(match lowering.period {
            None => one,
            Some(period) => lowering.builder.binary(Binary::Quotient, one, period)?,
        });
    }
    Ok((lowering.builder.complete(rates), lowering.time))
}

/// The operations of each rate on its own, in those states that have a place for it.
pub(super) fn lowered_apart(
    tables: &Tables<'_>,
    states: &[&[Option<usize>]],
) -> Result<Vec<Expressions>> {
    let all: Vec<_> = (0..tables.states.len()).map(Some).collect();
    Lowering::of(tables, &all).check()?;
    let each = tables.rates.iter().zip(states);
    let one = |(rate, states): (&Formula<'_>, &&[Option<usize>])| {
        let mut lowering = Lowering::of(tables, states);
        let place = lowering.place(rate)?;
        Ok(lowering.builder.complete(vec![place]))
    };
    each.map(one).collect()
}

/// Carries out an operation that is no name with the last numbers of a stack.
pub(super) fn operation(
    builder: &mut Builder,
    token: &Token,
    stack: &mut Vec<Place>,
) -> Result<Place> {
    let mut pop = || stack.pop().expect("operands stand before their operator");
    match *token {
        Token::Number(x) => builder.number(x),
        Token::Negative => builder.negative(pop()),
        Token::Binary(binary) => {
            let b = pop();
            builder.binary(binary, pop(), b)
        }
        Token::Call(function) if function.arguments() == 2 => {
            let b = pop();
            builder.call(function, &[pop(), b])
        }
        Token::Call(function) => builder.call(function, &[pop()]),
        Token::Name(_) => unreachable!("names are looked up"),
    }
}

/// How far a formula of `[where]` is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Progress {
    Open,
    Begun,
    Done(Place),
}

/// From formulas to operations.
struct Lowering<'t, 'a> {
    tables: &'t Tables<'a>,
    /// The place of each state among the variables, where the formula may name it.
    states: &'t [Option<usize>],
    /// Whether formulas may name time, and where one did first.
    takes_time: bool,
    time: Option<TimeUse>,
    /// The period, where the variable after the states is a phase.
    period: Option<Place>,
    builder: Builder,
    defined: Vec<Progress>,
}

impl<'t, 'a> Lowering<'t, 'a> {
    fn of(tables: &'t Tables<'a>, states: &'t [Option<usize>]) -> Self {
        Lowering {
            tables,
            states,
            takes_time: false,
            time: None,
            period: None,
            builder: Builder::default(),
            defined: vec![Progress::Open; tables.defined.len()],
        }
    }

    /// Looks at all formulas of `[where]`, also those that nothing uses: they may have mistakes.
    fn check(&mut self) -> Result<()> {
        (0..self.tables.defined.len()).try_for_each(|i| self.define(i).map(|_| ()))
    }

    /// The value of a formula of `[where]`, which is not in the making.
    fn define(&mut self, i: usize) -> Result<Place> {
        if let Progress::Done(place) = self.defined[i] {
            return Ok(place);
        }
        self.defined[i] = Progress::Begun;
        let place = self.place(&self.tables.defined[i])?;
        self.defined[i] = Progress::Done(place);
        Ok(place)
    }

    /// Carries out a formula on a stack.
    fn place(&mut self, formula: &Formula<'_>) -> Result<Place> {
        let mut stack: Vec<Place> = Vec::new();
        for item in &formula.items {
            let made = match &item.token {
                Token::Name(name) => self.named(formula, item.at, name)?,
                token => operation(&mut self.builder, token, &mut stack)
                    .map_err(|error| self.wrong(formula, item.at, error.to_string()))?,
            };
            stack.push(made);
        }
        let whole = stack.pop().filter(|_| stack.is_empty());
        whole.ok_or_else(|| self.wrong(formula, 0, "the formula is incomplete"))
    }

    fn named(&mut self, formula: &Formula<'_>, at: usize, name: &str) -> Result<Place> {
        let made = match self.tables.meanings.get(name) {
            Some(&Meaning::State(i)) => match self.states.get(i) {
                Some(&Some(i)) => self.builder.variable(i),
                None => {
                    let what = format!("{name:?} is a state, on which a period cannot depend");
                    return Err(self.wrong(formula, at, what));
                }
                Some(None) => return Err(self.wrong(formula, at, self.out_of_place(name))),
            },
            Some(&Meaning::Parameter(i)) => self.builder.parameter(i),
            Some(&Meaning::Defined(i)) if self.defined[i] == Progress::Begun => {
                let what = match formula.name {
                    own if own == name => format!("{name:?} is defined by itself"),
                    other => format!("{name:?} is defined by {other:?}, and that by {name:?}"),
                };
                return Err(self.wrong(formula, at, what));
            }
            Some(&Meaning::Defined(i)) => return self.define(i),
            None if name == "pi" => self.builder.pi(),
            None if name == TIME && self.takes_time => {
                let place = || self.tables.time_use(formula, at);
                self.time.get_or_insert_with(place);
                let last = self.builder.variable(self.states.len());
                match (last, self.period) {
                    (Ok(phase), Some(period)) => {
                        self.builder.binary(Binary::Product, phase, period)
                    }
                    (last, _) => last,
                }
            }
            None => return Err(self.wrong(formula, at, self.unknown(name))),
        };
        made.map_err(|error| self.wrong(formula, at, error.to_string()))
    }

    fn out_of_place(&self, name: &str) -> String {
        let names = self.tables.states.iter().zip(self.states);
        let known: Vec<&str> = names.filter_map(|(name, at)| at.map(|_| *name)).collect();
        format!(
            "{name:?} has no value in what this formula is part of, which is in {}",
            known.join(" and ")
        )
    }

    fn unknown(&self, name: &str) -> String {
        if Function::named(name).is_some() {
            return format!("{name:?} is a function, whose argument must follow in parentheses");
        }
        if name == TIME {
            let what = match self.tables.period {
                Some(_) => "a period",
                None => "a law",
            };
            return format!("{name:?} is time, on which {what} cannot depend");
        }
        if name == "time" && self.takes_time {
            return format!("{name:?} is no state: in formulas time is called {TIME}");
        }
        let known = self.tables.meanings.keys().copied().chain(["pi"]);
        let hint = did_you_mean(name, known);
        format!("{name:?} is no state, no parameter and not defined in [where]{hint}")
    }

    fn wrong(&self, formula: &Formula<'_>, at: usize, what: impl Into<String>) -> Error {
        self.tables.located(formula, Wrong::new(at, what))
    }
}
