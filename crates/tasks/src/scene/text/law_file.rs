//! A friction law from a TOML file: its slip rate and its evolution, and the interfaces that have it.

use super::file::{Meaning, Tables, parsed};
use super::fingerprint::fingerprint;
use super::lowering::lowered_apart;
use crate::scene::file::Reader;
use toml::de::DeTable;
use twinslip::error::{Error, Result};
use twinslip::expression::{Binary, Builder, Expressions, Function, Place};

/// What the formulas of a law are in.
const QUANTITIES: [&str; 3] = ["tau", "psi", "v"];
/// Names that interfaces give to their parameters and columns, and so a law can't.
const TAKEN: [&str; 5] = ["driving", "driving_rate", "stiffness", "stress", "time"];
/// The same, with the number of the interface behind them.
const NUMBERED: [&str; 4] = ["state_", "log_state_", "slip_rate_", "slip_"];

/// A friction law as a file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct LawFile {
    /// What it is called.
    pub name: String,
    /// v, in (tau, psi) and the parameters.
    pub slip_rate: Expressions,
    /// dpsi/dt, in (v, psi) and the parameters.
    pub evolution: Expressions,
    /// The parameters and their values in the file.
    pub parameters: Vec<(String, f64)>,
    /// A number that tells its formulas from others.
    pub fingerprint: String,
    /// Where radiation damping stands among the parameters, where the law has it beside what the file says.
    pub damping: Option<usize>,
}

impl LawFile {
    /// Reads a text, under the name that messages shall use for it.
    ///
    /// # Errors
    /// [`twinslip::error::Error::Input`] with file, line and column for what is wrong in it.
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let reader = Reader { name: file, text };
        let table = parsed(&reader)?;
        let tables = read(reader, table.get_ref())?;
        let formulas = lowered_apart(
            &tables,
            &[&[Some(0), Some(1), None], &[None, Some(1), Some(0)]],
        )?;
        let [slip_rate, evolution] =
            <[Expressions; 2]>::try_from(formulas).expect("one for each of the two formulas");
        let own = |(name, value): &(&str, f64)| ((*name).to_owned(), *value);
        Ok(LawFile {
            parameters: tables.parameters.iter().map(own).collect(),
            name: tables.name,
            slip_rate,
            evolution,
            fingerprint: fingerprint(table.get_ref()),
            damping: None,
        })
    }

    /// The place of a parameter of this name, where the law has one.
    pub(super) fn place(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|(own, _)| own == name)
    }

    /// The same law with radiation damping, which is a parameter more: tau - eta v stands in the place of tau.
    ///
    /// # Errors
    /// [`Error::Input`] for a slip rate that is not a factor times sinh or exp of the stress.
    pub(super) fn damped(mut self, damping: f64) -> Result<Self> {
        let place = self.parameters.len();
        let Some(slip_rate) = self.slip_rate.damped(place)? else {
            return Err(Error::Input(format!(
                "`damping`: the slip rate of the law {} must be a factor times sinh or exp of a multiple of tau",
                self.name
            )));
        };
        self.slip_rate = slip_rate;
        self.damping = Some(place);
        self.parameters.push((DAMPING.into(), damping));
        Ok(self)
    }

    /// The law of an interface whose slip length and normal stress are l and n in units of others: two parameters more, both 1. With q =
    /// a/(n a_i), of which a is that of the unit of stress, the interface slides at law(q tau), and its state evolves in units of its own
    /// time l, in which R is R/l and, where the law does not bound psi, psi is psi/l.
    ///
    /// # Errors
    /// [`Error::Input`] where there are too many operations.
    pub(super) fn scaled(mut self, unit: f64, bounds_state: bool) -> Result<Self> {
        let [slip_rate, evolution] = [0, 1].map(|which| {
            let mut builder = Builder::default();
            let own = self.own_units(&mut builder, unit)?;
            let Own { l, q, parameters } = &own;
            let (first, psi) = (builder.variable(0)?, builder.variable(1)?);
            let psi = match bounds_state {
                true => psi,
                false => builder.binary(Binary::Quotient, psi, *l)?,
            };
            let made = if which == 0 {
                let tau = builder.binary(Binary::Product, first, *q)?;
                builder.insert(&self.slip_rate, &[tau, psi], parameters)?[0]
            } else {
                let rate = builder.insert(&self.evolution, &[first, psi], parameters)?[0];
                match bounds_state {
                    true => builder.binary(Binary::Quotient, rate, *l)?,
                    false => rate,
                }
            };
            Ok(builder.complete(vec![made]))
        });
        (self.slip_rate, self.evolution) = (slip_rate?, evolution?);
        let more = SCALES.map(|name| (name.to_owned(), 1.0));
        self.parameters.extend(more);
        Ok(self)
    }

    fn own_units(&self, builder: &mut Builder, unit: f64) -> Result<Own> {
        let count = self.parameters.len();
        let parameters = (0..count).map(|i| builder.parameter(i));
        let mut parameters = parameters.collect::<Result<Vec<Place>>>()?;
        let (l, n) = (builder.parameter(count)?, builder.parameter(count + 1)?);
        let unit = builder.number(unit)?;
        let stress = match self.place("direct_effect") {
            Some(a) => builder.binary(Binary::Product, n, parameters[a])?,
            None => n,
        };
        let q = builder.binary(Binary::Quotient, unit, stress)?;
        if let Some(i) = self.place("healing_time") {
            parameters[i] = builder.binary(Binary::Quotient, parameters[i], l)?;
        }
        if let Some(i) = self.damping {
            parameters[i] = builder.binary(Binary::Product, parameters[i], q)?;
        }
        Ok(Own { l, q, parameters })
    }
}

/// l, q, and the parameters of a law in units of its own.
struct Own {
    l: Place,
    q: Place,
    parameters: Vec<Place>,
}

/// The parameters that an interface has where the units are not its own.
pub(super) const SCALES: [&str; 2] = ["slip_length", "normal_stress"];

fn read<'a>(reader: Reader<'a>, table: &'a DeTable<'_>) -> Result<Tables<'a>> {
    const KEYS: [&str; 5] = ["name", "slip_rate", "evolution", "parameters", "where"];
    let mut tables = Tables::with_keys(reader, table, &KEYS)?;
    match table.get("name") {
        Some(_) => tables.read_name(table)?,
        None => tables.name = tables.reader.name.to_owned(),
    }
    for (i, name) in QUANTITIES.into_iter().enumerate() {
        tables.declare_at(name, 0, Meaning::State(i))?;
        tables.states.push(name);
    }
    tables.read_parameters(table)?;
    if let Some(key) = table.get("parameters").and_then(|all| {
        let names = all.get_ref().as_table()?.keys();
        names.into_iter().find(|key| taken(key.get_ref()))
    }) {
        let what = format!(
            "no parameter of a law can be called {}: interfaces have that name",
            key.get_ref()
        );
        return Err(tables.reader.misplaced(key.span().start, what));
    }
    tables.read_where(table)?;
    for (name, what) in [
        (
            "slip_rate",
            "how fast does an interface slide, in tau and psi?",
        ),
        (
            "evolution",
            "at which rate does the state change, in v and psi?",
        ),
    ] {
        let Some((key, value)) = table.get_key_value(name) else {
            return Err(tables.missing(name, what));
        };
        let formula = tables.formula(key, value)?;
        tables.rates.push(formula);
    }
    Ok(tables)
}

fn taken(name: &str) -> bool {
    let numbered = |begin: &&str| {
        let rest = name.strip_prefix(*begin);
        rest.is_some_and(|rest| !rest.is_empty() && rest.bytes().all(|c| c.is_ascii_digit()))
    };
    TAKEN.contains(&name) || NUMBERED.iter().any(numbered)
}

/// The rates of the stress, of ln psi of each interface and on a ramp of V_H, and the slip rates of the interfaces.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sliding {
    pub rates: Expressions,
    pub slip_rates: Expressions,
}

impl Sliding {
    /// Of clusters of interfaces under one stress, (11) and (19): dtau/dt = K (V_H - sum of n_i v_i), dw_i/dt = (dpsi_i/dt)/psi_i with
    /// psi_i = e^(w_i), the i-th cluster being n_i interfaces that move alike.
    ///
    /// The parameters are V_H, or on a ramp its rate of change, K, and those of the law; `places` has for each cluster where each
    /// of the law's own stands among them.
    ///
    /// # Errors
    /// [`twinslip::error::Error::Input`] where there are too many operations.
    pub fn of(
        law: &LawFile,
        (places, counts): (&[Vec<usize>], &[usize]),
        ramp: bool,
    ) -> Result<Self> {
        let mut builder = Builder::default();
        let tau = builder.variable(0)?;
        let (mut slip_rates, mut evolutions): (Vec<Place>, Vec<Place>) = Default::default();
        for (i, places) in places.iter().enumerate() {
            let log_state = builder.variable(i + 1)?;
            let psi = builder.call(Function::Exp, &[log_state])?;
            let parameters = places.iter().map(|&place| builder.parameter(place));
            let parameters = parameters.collect::<Result<Vec<Place>>>()?;
            let v = builder.insert(&law.slip_rate, &[tau, psi], &parameters)?[0];
            let evolution = builder.insert(&law.evolution, &[v, psi], &parameters)?[0];
            slip_rates.push(v);
            evolutions.push(builder.over_exponential(evolution, log_state)?);
        }
        let first = builder.parameter(DRIVING)?;
        let driving = if ramp {
            builder.variable(places.len() + 1)?
        } else {
            first
        };
        let mut total = driving;
        for (&v, &count) in slip_rates.iter().zip(counts) {
            let all = match count {
                1 => v,
                _ => {
                    let count = builder.number(count as f64)?;
                    builder.binary(Binary::Product, v, count)?
                }
            };
            total = builder.binary(Binary::Difference, total, all)?;
        }
        let stiffness = builder.parameter(STIFFNESS)?;
        let mut rates = vec![builder.binary(Binary::Product, stiffness, total)?];
        rates.extend(evolutions);
        if ramp {
            rates.push(first);
        }
        let (rates, slip_rates) = builder.complete_both(rates, slip_rates);
        Ok(Sliding { rates, slip_rates })
    }
}

/// What the radiation damping is called.
pub(super) const DAMPING: &str = "damping";
/// Where V_H and K stand among the parameters of interfaces.
pub(super) const DRIVING: usize = 0;
pub(super) const STIFFNESS: usize = 1;
