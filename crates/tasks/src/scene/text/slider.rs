//! A slider on a spring whose friction law is from a file, in seconds and metres.

use super::friction::Friction;
use super::law_file::LawFile;
use super::model::read_law;
use std::borrow::Cow;
use std::path::Path;
use twinslip::error::{Error, Result};
use twinslip::expression::{Binary, Builder, Expressions, Function, Place};
use twinslip::field::{State, VectorField};
use twinslip::fit::Sliders;
use twinslip::friction::positive;
use twinslip::model::{TextField, TextSystem};

/// The parameters that a slider has before those of the law.
const APPARATUS: [&str; 2] = ["stiffness", "slip_length"];
/// The states: mu, w and V/V*.
const STATES: [&str; 3] = ["friction", "log_state", "velocity"];
/// What the law must have: friction is a tau.
const DIRECT_EFFECT: &str = "direct_effect";

/// dmu/dt = k V* (V/V* - v), dw/dt = (V*/L) (dpsi/dt)/psi, with tau = mu/a and psi = e^w in L/V*: as of
/// [`twinslip::model::Slider`], by formulas that were read.
#[derive(Debug, Clone, PartialEq)]
pub struct TextSlider {
    law: LawFile,
    system: TextSystem,
    /// Where the law has its a.
    direct_effect: usize,
    reference_rate: f64,
}

impl TextSlider {
    /// A slider with the law of this file.
    ///
    /// # Errors
    /// [`Error::File`]; [`Error::Input`] with file, line and column for what is wrong in it, and for a law without a parameter
    /// direct_effect; [`Error::Parameter`] unless V* is positive.
    pub fn read(path: &Path, reference_rate: f64) -> Result<Self> {
        let law = read_law(path)?;
        let Some(direct_effect) = law.place(DIRECT_EFFECT) else {
            return Err(Error::Input(format!(
                "the law {} has no parameter {DIRECT_EFFECT}, which relates friction to its stress",
                law.name
            )));
        };
        if let Some((name, _)) = law
            .parameters
            .iter()
            .find(|(name, _)| APPARATUS.contains(&name.as_str()) || name == twinslip::fit::DRIFT)
        {
            return Err(Error::Input(format!(
                "the law {} has a parameter {name}: that is a name of the apparatus",
                law.name
            )));
        }
        let rates = rates(&law, direct_effect, reference_rate)?;
        let apparatus = APPARATUS.map(|name| (name, 1.0));
        let own = law.parameters.iter().map(|(name, x)| (name.as_str(), *x));
        let all = apparatus
            .into_iter()
            .chain(own)
            .chain([("acceleration", 0.0)]);
        let parameters: Vec<(&str, f64)> = all.collect();
        Ok(TextSlider {
            system: TextSystem::new(rates, &STATES, &parameters)?,
            law,
            direct_effect,
            reference_rate: positive("reference-rate", reference_rate)?,
        })
    }

    /// What the law is called.
    pub fn name(&self) -> &str {
        &self.law.name
    }

    /// The parameters of the law, and their values in the file.
    pub fn constants(&self) -> &[(String, f64)] {
        &self.law.parameters
    }
}

/// The rates of mu, w and V/V*. The last parameter is the acceleration.
fn rates(law: &LawFile, direct_effect: usize, reference_rate: f64) -> Result<Expressions> {
    let mut builder = Builder::default();
    let [mu, w, velocity] = [0, 1, 2].map(|i| builder.variable(i));
    let (mu, w, velocity) = (mu?, w?, velocity?);
    let [stiffness, length] = [0, 1].map(|i| builder.parameter(i));
    let own = (0..law.parameters.len()).map(|i| builder.parameter(APPARATUS.len() + i));
    let own = own.collect::<Result<Vec<Place>>>()?;
    let reference = builder.number(reference_rate)?;
    let tau = builder.binary(Binary::Quotient, mu, own[direct_effect])?;
    let psi = builder.call(Function::Exp, &[w])?;
    let v = builder.insert(&law.slip_rate, &[tau, psi], &own)?[0];
    let per_second = builder.binary(Binary::Quotient, reference, length?)?;
    let stiffness = builder.binary(Binary::Product, stiffness?, reference)?;
    let stretching = builder.binary(Binary::Difference, velocity, v)?;
    let of_friction = builder.binary(Binary::Product, stiffness, stretching)?;
    // As the law has it, in L/V*.
    let of_stress = builder.binary(Binary::Quotient, of_friction, own[direct_effect])?;
    let of_stress = builder.binary(Binary::Quotient, of_stress, per_second)?;
    let evolution = builder.insert(&law.evolutions[0], &[v, psi, of_stress], &own)?[0];
    let evolution = builder.over_exponential(evolution, w)?;
    let of_state = builder.binary(Binary::Product, evolution, per_second)?;
    let acceleration = builder.parameter(APPARATUS.len() + own.len())?;
    Ok(builder.complete(vec![of_friction, of_state, acceleration]))
}

impl Sliders<3> for TextSlider {
    fn names(&self) -> Vec<&'static str> {
        let all = self.system.parameter_names();
        all[..all.len() - 1].to_vec()
    }

    fn reference_rate(&self) -> f64 {
        self.reference_rate
    }

    fn field(&self, parameters: &[f64], acceleration: f64) -> Result<Box<dyn VectorField<3> + '_>> {
        let mut system = self.system.clone();
        let all = parameters.iter().chain(std::iter::once(&acceleration));
        for (place, value) in all.enumerate() {
            system.put(place, *value);
        }
        Ok(Box::new(TextField::<3>::of(Cow::Owned(system))?))
    }

    fn steady(&self, parameters: &[f64], v: f64) -> Result<State<3>> {
        let own = parameters[APPARATUS.len()..].to_vec();
        let a = own[self.direct_effect];
        let steady = Friction::new(&self.law, own).steady(v)?;
        Ok(State::from([a * steady.stress, steady.log_states[0], v]))
    }
}
