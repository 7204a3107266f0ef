//! Parameters of interfaces that vary in time: the driving velocity and the normal stress.

use super::law_file::LawFile;
use super::model::number;
use super::more_states::EVOLUTION_EFFECT;
use crate::scene::units::{Quantity, Units};
use twinslip::error::{Error, Result};
use twinslip::expression::{Binary, Builder, Function, Place};
use twinslip::friction::positive;

/// What may vary.
const NAMES: [&str; 2] = ["driving", NORMAL_STRESS];
pub(super) const NORMAL_STRESS: &str = "normal_stress";
/// What follows of the name of what varies in the names of the parameters by which it does.
const SUFFIXES: [&str; 3] = ["amplitude", "period", "phase"];
/// alpha of Linker and Dieterich (1992).
pub(in crate::scene) const NORMAL_STRESS_COUPLING: &str = "normal_stress_coupling";

/// A parameter times 1 + EPS cos(2 pi (t/PERIOD + PHASE)).
#[derive(Debug, Clone, PartialEq)]
pub struct Modulation {
    /// Which parameter.
    pub(super) name: &'static str,
    /// Where EPS stands among the parameters of the law, PERIOD and PHASE behind it.
    first: usize,
}

/// By what the time is told of what varies: itself, or the phase of the forcing with its period.
#[derive(Debug, Clone, Copy)]
pub(super) enum Clock {
    Time(Place),
    Phase(Place, Place),
}

/// The factor of what varies, and its rate over itself.
#[derive(Debug, Clone, Copy)]
pub(super) struct Factor {
    pub value: Place,
    pub growth: Place,
}

/// NAME, EPS, PERIOD and PHASE of a text.
fn read(text: &str) -> Option<(&str, f64, f64, f64)> {
    let (name, numbers) = text.split_once('=')?;
    let numbers = numbers.split(':').map(number);
    match numbers.collect::<Option<Vec<f64>>>()?[..] {
        [eps, period] => Some((name.trim(), eps, period, 0.0)),
        [eps, period, phase] => Some((name.trim(), eps, period, phase)),
        _ => None,
    }
}

impl LawFile {
    /// The law of interfaces of which parameters vary, each by a text `NAME=EPS:PERIOD[:PHASE]`.
    ///
    /// # Errors
    /// [`Error::Input`] for a text that is no such, and for a parameter that varies twice; [`Error::Parameter`] for one that can't vary, a
    /// normal stress that does not stay positive and a period that isn't.
    pub(super) fn modulated(mut self, texts: &[String], units: &Units) -> Result<Self> {
        for text in texts {
            let Some((name, eps, period, phase)) = read(text) else {
                return Err(Error::Input(format!(
                    "`modulate` {text:?} must be NAME=EPS:PERIOD[:PHASE], for NAME times 1 + EPS cos(2 pi (t/PERIOD + PHASE))"
                )));
            };
            let known = NAMES.into_iter().find(|known| *known == name);
            let name = known.ok_or_else(|| Error::unknown("modulate", name, &NAMES))?;
            if self.modulation(name).is_some() {
                return Err(Error::Input(format!("`modulate` varies {name} twice")));
            }
            if name == NORMAL_STRESS && eps.abs() >= 1.0 {
                let must = "between -1 and 1: the normal stress stays positive";
                return Err(Error::parameter(
                    "the EPS of normal_stress in `modulate`",
                    eps,
                    must,
                ));
            }
            let period = positive("the PERIOD of `modulate`", period)?;
            let period = units.inward(Quantity::Time, period);
            self.modulations.push(Modulation {
                name,
                first: self.parameters.len(),
            });
            let values = SUFFIXES.into_iter().zip([eps, period, phase]);
            let all = values.map(|(suffix, value)| (format!("{name}_{suffix}"), value));
            self.parameters.extend(all);
        }
        Ok(self)
    }

    /// The law whose state changes with the normal stress sigma: dpsi/dt has the term -(alpha/b) psi dsigma/dt/sigma (Linker and Dieterich
    /// 1992, J. Geophys. Res. 97, 4923-4940).
    ///
    /// # Errors
    /// [`Error::Input`] for a normal stress that does not vary, and for a law without b.
    pub(super) fn coupled(mut self, alpha: f64) -> Result<Self> {
        if self.modulation(NORMAL_STRESS).is_none() {
            return Err(Error::Input(
                "`normal_stress_coupling` is of a normal stress that varies: give `modulate` normal_stress=EPS:PERIOD".into(),
            ));
        }
        if self.place(EVOLUTION_EFFECT).is_none() {
            return Err(Error::Input(format!(
                "`normal_stress_coupling`: the law {} has no parameter {EVOLUTION_EFFECT}, over which it is taken",
                self.name
            )));
        }
        self.parameters.push((NORMAL_STRESS_COUPLING.into(), alpha));
        Ok(self)
    }

    /// How a parameter varies, where it does.
    pub(super) fn modulation(&self, name: &str) -> Option<&Modulation> {
        self.modulations.iter().find(|one| one.name == name)
    }
}

impl Modulation {
    /// Where its period stands among the parameters of the law.
    pub(super) fn period(&self) -> usize {
        self.first + 1
    }

    /// The factor at this time, by the parameters of an interface.
    ///
    /// # Errors
    /// [`Error::Input`] where there are too many operations.
    pub(super) fn factor(
        &self,
        builder: &mut Builder,
        parameters: &[Place],
        time: Clock,
    ) -> Result<Factor> {
        let [eps, own, phase] = [0, 1, 2].map(|i| parameters[self.first + i]);
        let (turns, period) = match time {
            Clock::Time(time) => (builder.binary(Binary::Quotient, time, own)?, own),
            Clock::Phase(turns, period) => (turns, period),
        };
        let (one, two, pi) = (builder.number(1.0)?, builder.number(2.0)?, builder.pi()?);
        let circle = builder.binary(Binary::Product, two, pi)?;
        let turns = builder.binary(Binary::Sum, turns, phase)?;
        let angle = builder.binary(Binary::Product, circle, turns)?;
        let cosine = builder.call(Function::Cos, &[angle])?;
        let swing = builder.binary(Binary::Product, eps, cosine)?;
        let value = builder.binary(Binary::Sum, one, swing)?;
        let sine = builder.call(Function::Sin, &[angle])?;
        let frequency = builder.binary(Binary::Quotient, circle, period)?;
        let rate = builder.binary(Binary::Product, eps, frequency)?;
        let rate = builder.binary(Binary::Product, rate, sine)?;
        let rate = builder.negative(rate)?;
        let growth = builder.binary(Binary::Quotient, rate, value)?;
        Ok(Factor { value, growth })
    }
}
