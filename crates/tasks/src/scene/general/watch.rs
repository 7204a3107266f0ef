//! Formulas whose zeros are looked for along branches and curves.

use super::{RowKind, SlabSubject, Subject};
use crate::scene::following::explain_watched;
use crate::scene::system::System;
use crate::scene::text::NamedFormula;
use crate::scene::units::Quantity;
use serde_json::{Value, json};
use std::sync::Arc;
use twinslip::bifurcation::UserFunction;
use twinslip::error::{Error, Result};
use twinslip::model::Loading;
use twinslip::orbit::{Digits, ParametrisedField, Profile, ShootingNodes, Solution, WithFunctions};

/// Formulas in what rows show: the parameters, what the system tells of a state or an orbit, and the period.
#[derive(Debug, Clone, PartialEq)]
pub struct Watched {
    /// As they were given: first that which is held, if one is.
    pub texts: Vec<String>,
    /// Whether one is.
    holds: bool,
    /// Whether they are of orbits.
    orbits: bool,
    formulas: Vec<NamedFormula>,
    /// The parameters, with what is known of each that does not vary, in the user's units.
    parameters: Vec<(&'static str, Quantity, Option<f64>)>,
    /// What the system tells.
    numbers: Vec<Quantity>,
    /// Whether a formula names anything of an orbit that takes a run along it.
    needs_numbers: Vec<bool>,
}

/// What a period is called in formulas.
const PERIOD: &str = "period";

impl Watched {
    /// Reads the formulas; they must be in what this kind of rows shows.
    ///
    /// # Errors
    /// [`Error::Input`] for what is wrong in one of them.
    pub fn new(
        (held, watched): (Option<&str>, &[String]),
        subject: &dyn Subject,
        kind: RowKind,
    ) -> Result<Self> {
        let outward = |quantity, x| subject.units().outward(quantity, x);
        let known = subject.parameters().into_iter();
        let known = known.map(|(name, quantity)| {
            let value = subject.value(name).ok();
            (name, quantity, value.map(|x| outward(quantity, x)))
        });
        let parameters: Vec<_> = known.collect();
        let numbers = subject.numbers(kind);
        let mut names: Vec<String> = parameters.iter().map(|one| one.0.to_owned()).collect();
        names.extend(numbers.iter().map(|(name, _)| name.clone()));
        let has_period = kind.orbits || kind.curve;
        names.extend(has_period.then(|| PERIOD.to_owned()));
        let held = held.map(|text| ("hold", text));
        let watched = watched.iter().map(|text| ("watch", &**text));
        let all: Vec<(&str, &str)> = held.into_iter().chain(watched).collect();
        let formulas = all.iter().map(|&(option, text)| {
            if kind.orbits {
                not_a_state((option, text), subject, &names)?;
            }
            NamedFormula::parse(option, text, &names)
        });
        let formulas = formulas.collect::<Result<Vec<_>>>()?;
        let of_numbers = parameters.len()..parameters.len() + numbers.len();
        let needs_numbers = formulas
            .iter()
            .map(|formula| of_numbers.clone().any(|i| formula.names(i)));
        Ok(Watched {
            texts: all.iter().map(|(_, text)| (*text).to_owned()).collect(),
            holds: held.is_some(),
            orbits: kind.orbits,
            needs_numbers: needs_numbers.collect(),
            formulas,
            parameters,
            numbers: numbers.into_iter().map(|(_, quantity)| quantity).collect(),
        })
    }

    /// Which formulas there are, for the output, where there are any.
    pub fn told_in(&self, numerics: &mut Value) {
        let (held, watched) = self.texts.split_at(usize::from(self.holds));
        if let [held] = held {
            numerics["hold"] = json!(held);
        }
        if !watched.is_empty() {
            numerics["watch"] = json!(watched);
        }
    }

    /// The same as words of a plan.
    pub fn explain(&self) -> String {
        explain_watched(&self.texts[usize::from(self.holds)..])
    }

    /// As functions of solutions of this subject, whose family of all states this is.
    pub(super) fn of<'w>(
        &'w self,
        subject: &'w dyn Subject,
        family: &'w dyn ParametrisedField,
    ) -> Functions<'w> {
        Functions(Box::new(move |which, solution, at| {
            let shrunk = match solution {
                Solution::Equilibrium { state, period } if self.orbits => {
                    period.map(|period| ShootingNodes {
                        nodes: vec![state.clone()],
                        durations: vec![period],
                    })
                }
                _ => None,
            };
            // An orbit that has shrunk to a Hopf point is told of as an orbit.
            let solution = shrunk.as_ref().map_or(solution, Solution::Orbit);
            let numbers = match self.needs_numbers[which] {
                true => subject.told((family, at), solution, Digits::All).ok(),
                false => None,
            };
            let period = match solution {
                Solution::Equilibrium { period, .. } => period,
                Solution::Orbit(shooting) => Some(shooting.period()),
            };
            let free = family.plane().into_iter().zip(family.parameters(at));
            let period = period.map(|period| period * subject.unit_of_time());
            let known = (numbers.as_deref(), period);
            self.value(which, subject, free.rev(), known)
        }))
    }

    /// The value of one of them by the free parameters and by what is known of the solution. NaN where something that it names is not known.
    fn value(
        &self,
        which: usize,
        subject: &dyn Subject,
        free: impl Iterator<Item = (usize, f64)>,
        (numbers, period): (Option<&[f64]>, Option<f64>),
    ) -> f64 {
        let outward = |quantity, x| subject.units().outward(quantity, x);
        let held = self.parameters.iter().map(|one| one.2.unwrap_or(f64::NAN));
        let mut values: Vec<f64> = held.collect();
        for (place, value) in free {
            values[place] = outward(self.parameters[place].1, value);
        }
        for (i, &quantity) in self.numbers.iter().enumerate() {
            let number = numbers.and_then(|all| all.get(i));
            values.push(number.map_or(f64::NAN, |&x| outward(quantity, x)));
        }
        values.push(period.map_or(f64::NAN, |x| outward(Quantity::Time, x)));
        self.formulas[which].at(&values)
    }
}

type Function<'w> = dyn Fn(usize, Solution<'_>, [f64; 2]) -> f64 + Sync + 'w;

/// Formulas as functions of solutions.
pub struct Functions<'w>(Box<Function<'w>>);

impl Functions<'_> {
    /// A family with these functions.
    pub fn with<'f>(&'f self, family: &'f dyn ParametrisedField) -> WithFunctions<'f> {
        WithFunctions {
            family,
            functions: &*self.0,
        }
    }
}

/// Formulas of equal interfaces with these free parameters, of V_H and K.
///
/// # Errors
/// As of [`Watched::new`].
pub(in crate::scene) fn user_functions(
    texts: &[String],
    system: &System,
    (kind, free): (RowKind, &[&str]),
) -> Result<Vec<UserFunction>> {
    if texts.is_empty() {
        return Ok(Vec::new());
    }
    if system.interfaces > 2 {
        return Err(Error::Input(format!(
            "`watch` has no meaning for the branches of all partitions of {} interfaces together; say by `clusters` which ones slide alike",
            system.interfaces
        )));
    }
    let subject = Arc::new(SlabSubject::new(system.clone(), free)?);
    let watched = Arc::new(Watched::new((None, texts), &*subject, kind)?);
    let names = subject.parameters();
    let place = |wanted: &str| names.iter().position(|(name, _)| *name == wanted);
    let places = ["driving", "stiffness"].map(|name| place(name).unwrap_or_default());
    let function = |(which, text): (usize, &String)| {
        let (subject, watched) = (Arc::clone(&subject), Arc::clone(&watched));
        let value = move |loading: Loading, profile: &Profile, period: Option<f64>| {
            let free = places.into_iter().zip([loading.driving, loading.stiffness]);
            let numbers = subject.shown(profile);
            watched.value(which, &*subject, free, (Some(&numbers), period))
        };
        UserFunction {
            text: text.clone(),
            value: Arc::new(value),
        }
    };
    Ok(texts.iter().enumerate().map(function).collect())
}

/// That a formula of orbits names no state, which has no one value along an orbit.
fn not_a_state(
    (option, text): (&str, &str),
    subject: &dyn Subject,
    names: &[String],
) -> Result<()> {
    let state = RowKind {
        orbits: false,
        curve: false,
        homoclinic: false,
    };
    let states = subject.numbers(state).into_iter().map(|(name, _)| name);
    let words = text.split(|c: char| !(c.is_alphanumeric() || c == '_'));
    let Some(state) = states
        .filter(|state| !names.contains(state))
        .find(|state| words.clone().any(|word| word == state))
    else {
        return Ok(());
    };
    Err(Error::Input(format!(
        "`{option}` {text:?}: {state} varies along an orbit and has no one value; there are {}",
        names.join(", ")
    )))
}
