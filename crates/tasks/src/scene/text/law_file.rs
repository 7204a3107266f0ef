//! A friction law from a TOML file: its slip rate and its evolution.

use super::file::{Meaning, Tables, parsed};
use super::fingerprint::fingerprint;
use super::lowering::lowered_apart;
use super::modulation::Modulation;
use super::more_states::SECOND_SLIP_LENGTH;
use crate::scene::file::Reader;
use toml::de::DeTable;
use twinslip::error::{Error, Result};
use twinslip::expression::{Binary, Builder, Expressions, Place};

/// What the formulas of a law are in.
const QUANTITIES: [&str; 4] = ["tau", "psi", "v", "stress_rate"];
/// Where dtau/dt stands among the variables of an evolution, behind v and psi.
const STRESS_RATE: usize = 2;
/// Names that interfaces give to their parameters and columns, and so a law can't.
const TAKEN: [&str; 5] = ["driving", "driving_rate", "stiffness", "stress", "time"];
/// The same, with the number of the interface behind them.
const NUMBERED: [&str; 7] = [
    "state_",
    "log_state_",
    "second_state_",
    "log_second_state_",
    "slip_rate_",
    "log_slip_rate_",
    "slip_",
];

/// A friction law as a file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct LawFile {
    /// What it is called.
    pub name: String,
    /// v, in tau, the psi of all state variables and the parameters.
    pub slip_rate: Expressions,
    /// dpsi/dt of each state variable, in (v, psi, dtau/dt) and the parameters.
    pub evolutions: Vec<Expressions>,
    /// What an interface with mass moves by, where it has one.
    pub inertia: Option<Inertia>,
    /// What varies in time.
    pub modulations: Vec<Modulation>,
    /// Where the phase of what varies is a state in the place of time: where its period stands among the parameters.
    pub forced_by: Option<usize>,
    /// The parameters and their values in the file.
    pub parameters: Vec<(String, f64)>,
    /// A number that tells its formulas from others.
    pub fingerprint: String,
    /// Where radiation damping stands among the parameters, where the law has it beside what the file says.
    pub damping: Option<usize>,
}

/// The motion of an interface with mass.
#[derive(Debug, Clone, PartialEq)]
pub struct Inertia {
    /// The friction stress without damping, in v, the psi of all state variables and the parameters.
    pub friction: Expressions,
    /// Where the mass stands among the parameters.
    pub mass: usize,
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
            &[
                &[Some(0), Some(1), None, None],
                &[None, Some(1), Some(0), Some(STRESS_RATE)],
            ],
        )?;
        let [slip_rate, evolution] =
            <[Expressions; 2]>::try_from(formulas).expect("one for each of the two formulas");
        let own = |(name, value): &(&str, f64)| ((*name).to_owned(), *value);
        Ok(LawFile {
            parameters: tables.parameters.iter().map(own).collect(),
            name: tables.name,
            slip_rate,
            evolutions: vec![evolution],
            inertia: None,
            modulations: Vec::new(),
            forced_by: None,
            fingerprint: fingerprint(table.get_ref()),
            damping: None,
        })
    }

    /// The place of a parameter of this name, where the law has one.
    pub(super) fn place(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|(own, _)| own == name)
    }

    /// The same law with radiation damping, which is a parameter more: tau - eta v stands in the place of tau. Of a law with mass the friction
    /// stays as it is: what is radiated resists beside it.
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
    pub(super) fn scaled(mut self, unit: f64) -> Result<Self> {
        let bounds_state = self.bounds_state();
        let own_state = |builder: &mut Builder, psi: Place, l: Place| match bounds_state {
            true => Ok(psi),
            false => builder.binary(Binary::Quotient, psi, l),
        };
        let states = 1..=self.evolutions.len();
        let mut builder = Builder::default();
        let own = self.own_units(&mut builder, unit)?;
        let tau = builder.variable(0)?;
        let mut variables = vec![builder.binary(Binary::Product, tau, own.q)?];
        for i in states.clone() {
            let psi = builder.variable(i)?;
            variables.push(own_state(&mut builder, psi, own.l)?);
        }
        let slip_rate = builder.insert(&self.slip_rate, &variables, &own.parameters)?;
        let slip_rate = builder.complete(slip_rate);
        let mut evolutions = Vec::with_capacity(self.evolutions.len());
        for evolution in &self.evolutions {
            let mut builder = Builder::default();
            let own = self.own_units(&mut builder, unit)?;
            let (v, psi) = (builder.variable(0)?, builder.variable(1)?);
            let psi = own_state(&mut builder, psi, own.l)?;
            let stress_rate = builder.variable(STRESS_RATE)?;
            let stress_rate = builder.binary(Binary::Product, stress_rate, own.q)?;
            let stress_rate = builder.binary(Binary::Product, stress_rate, own.l)?;
            let variables = [v, psi, stress_rate];
            let rate = builder.insert(evolution, &variables, &own.parameters)?[0];
            let rate = match bounds_state {
                true => builder.binary(Binary::Quotient, rate, own.l)?,
                false => rate,
            };
            evolutions.push(builder.complete(vec![rate]));
        }
        if let Some(mut inertia) = self.inertia.take() {
            let mut builder = Builder::default();
            let own = self.own_units(&mut builder, unit)?;
            let mut variables = vec![builder.variable(0)?];
            for i in states {
                let psi = builder.variable(i)?;
                variables.push(own_state(&mut builder, psi, own.l)?);
            }
            let friction = builder.insert(&inertia.friction, &variables, &own.parameters)?[0];
            let friction = builder.binary(Binary::Quotient, friction, own.q)?;
            inertia.friction = builder.complete(vec![friction]);
            self.inertia = Some(inertia);
        }
        (self.slip_rate, self.evolutions) = (slip_rate, evolutions);
        let more = SCALES.map(|name| (name.to_owned(), 1.0));
        self.parameters.extend(more);
        Ok(self)
    }

    /// Whether the evolution depends on dtau/dt.
    pub(super) fn names_stress_rate(&self) -> bool {
        self.evolutions
            .iter()
            .any(|evolution| evolution.names_variable(STRESS_RATE))
    }

    /// Whether psi is a number, and no time: then the law has a healing time, as the unit of it.
    pub(super) fn bounds_state(&self) -> bool {
        self.place(HEALING_TIME).is_some()
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
        if let Some(i) = self.place(HEALING_TIME) {
            parameters[i] = builder.binary(Binary::Quotient, parameters[i], l)?;
        }
        if let Some(i) = self.place(SECOND_SLIP_LENGTH) {
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

/// What the radiation damping is called.
pub(super) const DAMPING: &str = "damping";
/// What the unit of a bounded state is called.
pub(super) const HEALING_TIME: &str = "healing_time";
/// Where V_H and K stand among the parameters of interfaces.
pub(super) const DRIVING: usize = 0;
pub(super) const STIFFNESS: usize = 1;
