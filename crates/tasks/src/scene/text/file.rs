//! A system from a TOML file: states, parameters and the formulas of their rates, all names resolved.

use super::fingerprint::fingerprint;
use super::grammar::{self, Item, Wrong, begins_name, continues_name};
use super::lowering::{lowered, lowered_by_phase};
use crate::scene::file::Reader;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use twinslip::error::{Error, Result, did_you_mean};
use twinslip::expression::Function;
use twinslip::model::TextSystem;

/// Tables of a file have no more entries.
const MOST: usize = 200;
/// What stands in rows beside the states, and so can't be one.
const COLUMNS: [&str; 6] = ["time", "return", "period", "verdict", "residual", "point"];

/// What time is called in formulas, where nothing else is.
pub(super) const TIME: &str = "t";
/// What the phase of a periodic forcing is called, where it is a state.
pub(in crate::scene) const PHASE: &str = "phase";

pub(super) type Key<'a> = Spanned<Cow<'a, str>>;

/// A system as a file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct SystemFile {
    /// What it is called.
    pub name: String,
    /// The system, its parameters as in the file.
    pub system: TextSystem,
    /// The start of every state that has one.
    pub start: Vec<Option<f64>>,
    /// A number that tells its formulas from others.
    pub fingerprint: String,
    /// Where a formula first names time, if one does.
    pub time: Option<TimeUse>,
    /// Where the file has a period of what depends on time: the same with its phase as one state more, the last.
    pub forced: Option<TextSystem>,
}

/// Where a formula names time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TimeUse {
    /// Of what the formula is: a state whose rate it is, or a name of `[where]`.
    pub formula: String,
    /// Line and column, from 1 on.
    pub place: (usize, usize),
}

impl SystemFile {
    /// Reads a text, under the name that messages shall use for it.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line and column for what is wrong in it.
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let reader = Reader { name: file, text };
        let table = parsed(&reader)?;
        Tables::of_system(reader, table.get_ref())?.system(fingerprint(table.get_ref()))
    }
}

/// The text as TOML.
pub(super) fn parsed<'a>(reader: &Reader<'a>) -> Result<Spanned<DeTable<'a>>> {
    DeTable::parse(reader.text).map_err(|error| {
        let place = error.span().unwrap_or(0..0);
        reader.misplaced(place.start, error.message().replace('\n', ", "))
    })
}

/// A formula with the place of its text in the file.
pub(super) struct Formula<'a> {
    pub name: &'a str,
    pub items: Vec<Item>,
    /// Where it begins, and whether its letters stand there as they are.
    begin: usize,
    plain: bool,
}

impl Formula<'_> {
    /// Where a place of it stands in the file.
    fn offset(&self, at: usize) -> usize {
        self.begin + if self.plain { at } else { 0 }
    }
}

/// What a name stands for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Meaning {
    State(usize),
    Parameter(usize),
    /// A formula of `[where]`.
    Defined(usize),
}

/// All that a file has.
pub(super) struct Tables<'a> {
    pub reader: Reader<'a>,
    pub name: String,
    pub states: Vec<&'a str>,
    /// Where their list stands.
    states_at: usize,
    pub parameters: Vec<(&'a str, f64)>,
    pub rates: Vec<Formula<'a>>,
    pub defined: Vec<Formula<'a>>,
    start: Vec<Option<f64>>,
    /// The period of all that depends on time.
    pub period: Option<Formula<'a>>,
    pub meanings: BTreeMap<&'a str, Meaning>,
}

impl<'a> Tables<'a> {
    fn of_system(reader: Reader<'a>, table: &'a DeTable<'_>) -> Result<Self> {
        const KEYS: [&str; 7] = [
            "name",
            "states",
            "parameters",
            "period",
            "rates",
            "where",
            "start",
        ];
        let mut tables = Self::with_keys(reader, table, &KEYS)?;
        tables.read_name(table)?;
        tables.read_states(table)?;
        tables.read_parameters(table)?;
        tables.read_where(table)?;
        tables.read_rates(table)?;
        if let Some((key, value)) = table.get_key_value("period") {
            tables.period = Some(tables.formula(key, value)?);
        }
        tables.start = vec![None; tables.states.len()];
        for (key, value) in tables.table(table, "start")? {
            let state = tables.state(key)?;
            tables.start[state] = Some(tables.number(value)?);
        }
        Ok(tables)
    }

    /// Nothing yet of a file that has no other keys than these.
    pub fn with_keys(reader: Reader<'a>, table: &DeTable<'_>, keys: &[&str]) -> Result<Self> {
        for (key, _) in table {
            let name = key.get_ref().as_ref();
            if !keys.contains(&name) {
                let hint = did_you_mean(name, keys.iter().copied());
                let what = format!("unknown key {name:?}, there are {}{hint}", keys.join(", "));
                return Err(reader.misplaced(key.span().start, what));
            }
        }
        Ok(Tables {
            name: String::new(),
            states: Vec::new(),
            states_at: 0,
            parameters: Vec::new(),
            rates: Vec::new(),
            defined: Vec::new(),
            start: Vec::new(),
            period: None,
            meanings: BTreeMap::new(),
            reader,
        })
    }

    pub fn read_parameters(&mut self, table: &'a DeTable<'_>) -> Result<()> {
        for (key, value) in self.table(table, "parameters")? {
            let number = self.number(value)?;
            let place = self.parameters.len();
            self.declare(key, Meaning::Parameter(place))?;
            self.parameters.push((key.get_ref(), number));
        }
        Ok(())
    }

    pub fn read_where(&mut self, table: &'a DeTable<'_>) -> Result<()> {
        for (key, value) in self.table(table, "where")? {
            let place = self.defined.len();
            self.declare(key, Meaning::Defined(place))?;
            let formula = self.formula(key, value)?;
            self.defined.push(formula);
        }
        Ok(())
    }

    pub fn read_name(&mut self, table: &'a DeTable<'_>) -> Result<()> {
        let Some(value) = table.get("name") else {
            return Err(self.missing("name", "what is the system called?"));
        };
        let name = value.get_ref().as_str().unwrap_or_default();
        if name.is_empty() || name.len() > MOST {
            let what = format!("name must be a text of 1 to {MOST} letters");
            return Err(self.reader.misplaced(value.span().start, what));
        }
        self.name = name.to_owned();
        Ok(())
    }

    /// That a key is missing, and what it would say.
    pub fn missing(&self, key: &str, what: &str) -> Error {
        let what = format!("the key {key} is missing: {what}");
        self.reader.misplaced(0, what)
    }

    fn read_states(&mut self, table: &'a DeTable<'_>) -> Result<()> {
        let Some(value) = table.get("states") else {
            return Err(self.missing("states", "which are the names of all states?"));
        };
        let at = value.span().start;
        self.states_at = at;
        let most = TextSystem::LARGEST;
        let Some(list) = value.get_ref().as_array() else {
            let kind = value.get_ref().type_str();
            let what = format!("states must be a list of names, not {kind}");
            return Err(self.reader.misplaced(at, what));
        };
        if !(1..=most).contains(&list.len()) {
            let what = format!(
                "there are {} states, but there must be 1 to {most}",
                list.len()
            );
            return Err(self.reader.misplaced(at, what));
        }
        for (i, item) in list.iter().enumerate() {
            let at = item.span().start;
            let Some(name) = item.get_ref().as_str() else {
                let what = format!("a state is a name, not {}", item.get_ref().type_str());
                return Err(self.reader.misplaced(at, what));
            };
            if COLUMNS.contains(&name) {
                let what = format!("no state can be called {name}, as a column of results is");
                return Err(self.reader.misplaced(at, what));
            }
            self.declare_at(name, at, Meaning::State(i))?;
            self.states.push(name);
        }
        Ok(())
    }

    fn read_rates(&mut self, table: &'a DeTable<'_>) -> Result<()> {
        let mut rates: Vec<Option<Formula<'a>>> = Vec::new();
        rates.resize_with(self.states.len(), || None);
        for (key, value) in self.table(table, "rates")? {
            let state = self.state(key)?;
            rates[state] = Some(self.formula(key, value)?);
        }
        for (state, rate) in self.states.iter().zip(rates) {
            match rate {
                Some(rate) => self.rates.push(rate),
                None => {
                    let at = table.get("rates").map_or(0, |value| value.span().start);
                    let what = format!("the state {state} has no formula in [rates]");
                    return Err(self.reader.misplaced(at, what));
                }
            }
        }
        Ok(())
    }

    /// The entries of a table, in the order of the file; none where there is no such table.
    fn table(
        &self,
        table: &'a DeTable<'_>,
        name: &str,
    ) -> Result<Vec<(&'a Key<'a>, &'a Spanned<DeValue<'a>>)>> {
        let Some(value) = table.get(name) else {
            return Ok(Vec::new());
        };
        let Some(entries) = value.get_ref().as_table() else {
            let kind = value.get_ref().type_str();
            let what = format!("{name} must be a table, [{name}], not {kind}");
            return Err(self.reader.misplaced(value.span().start, what));
        };
        let mut entries: Vec<_> = entries.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        if entries.len() > MOST {
            let what = format!(
                "[{name}] has {} entries, at most {MOST} are allowed",
                entries.len()
            );
            return Err(self.reader.misplaced(value.span().start, what));
        }
        Ok(entries)
    }

    fn number(&self, value: &Spanned<DeValue<'_>>) -> Result<f64> {
        let text = match value.get_ref() {
            DeValue::Integer(number) if number.radix() == 10 => number.as_str(),
            DeValue::Float(number) => number.as_str(),
            other => {
                let what = format!("a number is expected here, not {}", other.type_str());
                return Err(self.reader.misplaced(value.span().start, what));
            }
        };
        match text.replace('_', "").parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            _ => {
                let what = format!("{text} is not a finite number");
                Err(self.reader.misplaced(value.span().start, what))
            }
        }
    }

    /// The place of the state that a key names.
    fn state(&self, key: &Key<'_>) -> Result<usize> {
        let name = key.get_ref().as_ref();
        let place = self.states.iter().position(|state| *state == name);
        place.ok_or_else(|| {
            let hint = did_you_mean(name, self.states.iter().copied());
            let states = self.states.join(", ");
            let what = format!("{name:?} is no state, there are {states}{hint}");
            self.reader.misplaced(key.span().start, what)
        })
    }

    fn declare(&mut self, key: &'a Key<'_>, meaning: Meaning) -> Result<()> {
        self.declare_at(key.get_ref(), key.span().start, meaning)
    }

    /// Gives a name its meaning.
    pub fn declare_at(&mut self, name: &'a str, at: usize, meaning: Meaning) -> Result<()> {
        let wrong = |what: &str| Err(self.reader.misplaced(at, format!("{name:?} {what}")));
        let mut letters = name.chars();
        if !(letters.next().is_some_and(begins_name) && letters.all(continues_name)) {
            return wrong(
                "is not a name: names have letters, digits and _, and do not begin with a digit",
            );
        }
        if name == "pi" || Function::named(name).is_some() {
            return wrong("is reserved in formulas");
        }
        if self.meanings.insert(name, meaning).is_some() {
            return wrong("is given twice among states, parameters and [where]");
        }
        Ok(())
    }

    pub fn formula(
        &self,
        key: &'a Key<'_>,
        value: &'a Spanned<DeValue<'_>>,
    ) -> Result<Formula<'a>> {
        let Range { start, end } = value.span();
        let Some(text) = value.get_ref().as_str() else {
            let kind = value.get_ref().type_str();
            let what = format!("a formula is a text in quotes, not {kind}");
            return Err(self.reader.misplaced(start, what));
        };
        // Within the quotes, unless it is written with escapes.
        let inside = self
            .reader
            .text
            .get(start..end)
            .and_then(|raw| raw.find(text));
        let formula = Formula {
            name: key.get_ref(),
            items: Vec::new(),
            begin: start + inside.unwrap_or(0),
            plain: inside.is_some(),
        };
        let items = grammar::parse(text).map_err(|wrong| self.located(&formula, wrong))?;
        Ok(Formula { items, ..formula })
    }

    pub fn located(&self, formula: &Formula<'_>, Wrong { at, what }: Wrong) -> Error {
        self.reader.misplaced(formula.offset(at), what)
    }

    /// That a formula names time there.
    pub fn time_use(&self, formula: &Formula<'_>, at: usize) -> TimeUse {
        let of_rate = self.rates.iter().any(|rate| std::ptr::eq(rate, formula));
        let kind = if of_rate { "the rate of " } else { "" };
        TimeUse {
            formula: format!("{kind}{}", formula.name),
            place: self.reader.place(formula.offset(at)),
        }
    }

    /// The system with the phase of its period as the last state, where the file has a period.
    fn forced(&self) -> Result<Option<TextSystem>> {
        let Some(period) = &self.period else {
            return Ok(None);
        };
        let (rates, time) = lowered_by_phase(self, period)?;
        let wrong = |what: String| Err(self.located(period, Wrong::new(0, what)));
        if time.is_none() {
            return wrong(format!(
                "there is a period, but no formula names {TIME}, the time"
            ));
        }
        if self.meanings.contains_key(PHASE) {
            return wrong(format!(
                "{PHASE} is the phase of the period, and nothing else can be called so"
            ));
        }
        let states: Vec<&str> = self.states.iter().copied().chain([PHASE]).collect();
        let system = TextSystem::new(rates, &states, &self.parameters)?;
        Ok(Some(system.forced()))
    }

    fn system(self, fingerprint: String) -> Result<SystemFile> {
        let (rates, time) = lowered(&self)?;
        let most = TextSystem::LARGEST - 1;
        let system = match &time {
            None => TextSystem::new(rates, &self.states, &self.parameters)?,
            Some(TimeUse { formula, .. }) if self.states.len() > most => {
                let what = format!(
                    "there are {} states, but there must be 1 to {most} where {formula} names {TIME}, the time",
                    self.states.len()
                );
                return Err(self.reader.misplaced(self.states_at, what));
            }
            Some(_) => TextSystem::in_time(rates, &self.states, &self.parameters)?,
        };
        Ok(SystemFile {
            forced: self.forced()?,
            system,
            name: self.name,
            start: self.start,
            fingerprint,
            time,
        })
    }
}
