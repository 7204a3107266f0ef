//! Interfaces under one stress by the formulas of their law: which variables they have, and the rates of these.

use super::law_file::{DRIVING, Inertia, LawFile, STIFFNESS};
use super::modulation::{Clock, Factor, NORMAL_STRESS, NORMAL_STRESS_COUPLING};
use super::more_states::EVOLUTION_EFFECT;
use crate::scene::units::Quantity;
use twinslip::error::Result;
use twinslip::expression::{Binary, Builder, Expressions, Function, Place};

/// Which variables interfaces have, in this order: the stress, ln psi of each, ln psi of the second state variable of each, and with mass ln v
/// of each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::scene) struct StateLayout {
    /// How many interfaces or clusters there are.
    pub parts: usize,
    /// How many state variables each has.
    pub states: usize,
    /// Whether they have mass.
    pub mass: bool,
}

impl StateLayout {
    /// The place of ln psi of a part, of the first state variable or the second, both from 0.
    pub fn log_state(self, which: usize, part: usize) -> usize {
        1 + which * self.parts + part
    }

    /// The place of ln v of a part with mass.
    pub fn log_slip_rate(self, part: usize) -> usize {
        1 + self.states * self.parts + part
    }

    /// How many variables there are.
    pub fn count(self) -> usize {
        1 + self.of_each() * self.parts
    }

    /// Whether there is more than the stress and one state variable of each.
    pub fn has_more(self) -> bool {
        self.of_each() > 1
    }

    /// The variables of a part.
    pub fn of_part(self, part: usize) -> Vec<usize> {
        let all = (0..self.of_each()).map(|which| 1 + which * self.parts + part);
        all.collect()
    }

    fn of_each(self) -> usize {
        self.states + usize::from(self.mass)
    }

    /// What is measured by the variable at this place.
    pub fn quantity(self, place: usize) -> Quantity {
        match place {
            0 => Quantity::Stress,
            _ if place >= self.count() => Quantity::Number,
            _ if self.mass && place >= self.log_slip_rate(0) => Quantity::LogSlipRate,
            _ => Quantity::LogState,
        }
    }

    /// The names of all variables.
    pub fn names(self) -> Vec<String> {
        const PREFIXES: [&str; 2] = ["log_state", "log_second_state"];
        let states = PREFIXES.into_iter().take(self.states);
        let prefixes = states.chain(self.mass.then_some("log_slip_rate"));
        let each = prefixes.flat_map(|name| (1..=self.parts).map(move |i| format!("{name}_{i}")));
        std::iter::once("stress".to_owned()).chain(each).collect()
    }
}

/// The rates of the variables, on a ramp with that of V_H, and where something varies in time with that of time; and the slip rates of the
/// interfaces.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sliding {
    pub rates: Expressions,
    pub slip_rates: Expressions,
}

impl Sliding {
    /// Of clusters of interfaces under one stress, (11) and (19): dtau/dt = K (V_H - sum of n_i v_i), dw_i/dt = (dpsi_i/dt)/psi_i with
    /// psi_i = e^(w_i), the i-th cluster being n_i interfaces that move alike. With mass v_i = e^(u_i) and m du_i/dt = (tau - tau_f(v_i,
    /// psi_i))/v_i - eta.
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
        let layout = law.layout(places.len());
        let tau = builder.variable(0)?;
        // Behind the states there are V_H on a ramp, and time or the phase where something varies.
        let behind = layout.count();
        let time = match (law.modulations.is_empty(), law.forced_by) {
            (true, _) => None,
            (false, None) => Some(Clock::Time(builder.variable(behind + usize::from(ramp))?)),
            (false, Some(period)) => {
                let period = builder.parameter(places[0][period])?;
                Some(Clock::Phase(builder.variable(behind)?, period))
            }
        };
        let mut parts = Vec::with_capacity(places.len());
        for (i, places) in places.iter().enumerate() {
            let parameters = places.iter().map(|&place| builder.parameter(place));
            let mut part = Part {
                parameters: parameters.collect::<Result<Vec<Place>>>()?,
                ..Part::default()
            };
            for which in 0..layout.states {
                let log_state = builder.variable(layout.log_state(which, i))?;
                part.states.push(builder.call(Function::Exp, &[log_state])?);
                part.logs.push(log_state);
            }
            if let (Some(one), Some(time)) = (law.modulation(NORMAL_STRESS), time) {
                part.normal = Some(one.factor(&mut builder, &part.parameters, time)?);
            }
            part.slip_rate = match law.inertia {
                Some(_) => {
                    let log_rate = builder.variable(layout.log_slip_rate(i))?;
                    builder.call(Function::Exp, &[log_rate])?
                }
                None => part.quasi_static(&mut builder, law, tau)?,
            };
            parts.push(part);
        }
        let first = builder.parameter(DRIVING)?;
        let mut total = match ramp {
            true => builder.variable(behind)?,
            false => first,
        };
        if let (Some(one), Some(time)) = (law.modulation("driving"), time) {
            let factor = one.factor(&mut builder, &parts[0].parameters, time)?;
            total = builder.binary(Binary::Product, total, factor.value)?;
        }
        for (part, &count) in parts.iter().zip(counts) {
            let all = match count {
                1 => part.slip_rate,
                _ => {
                    let count = builder.number(count as f64)?;
                    builder.binary(Binary::Product, part.slip_rate, count)?
                }
            };
            total = builder.binary(Binary::Difference, total, all)?;
        }
        let stiffness = builder.parameter(STIFFNESS)?;
        let stress_rate = builder.binary(Binary::Product, stiffness, total)?;
        let mut rates: Vec<Place> = vec![stress_rate; layout.count()];
        for (i, part) in parts.iter().enumerate() {
            for (which, evolution) in law.evolutions.iter().enumerate() {
                let variables = [part.slip_rate, part.states[which], stress_rate];
                let evolution = builder.insert(evolution, &variables, &part.parameters)?[0];
                let mut rate = builder.over_exponential(evolution, part.logs[which])?;
                if which == 0 {
                    rate = part.coupled(&mut builder, law, rate)?;
                }
                rates[layout.log_state(which, i)] = rate;
            }
            if let Some(inertia) = &law.inertia {
                let place = layout.log_slip_rate(i);
                rates[place] = part.accelerated(&mut builder, (law, inertia), (tau, place))?;
            }
        }
        if ramp {
            rates.push(first);
        }
        if let Some(clock) = time {
            let one = builder.number(1.0)?;
            rates.push(match clock {
                Clock::Time(_) => one,
                Clock::Phase(_, period) => builder.binary(Binary::Quotient, one, period)?,
            });
        }
        let slip_rates = parts.iter().map(|part| part.slip_rate).collect();
        let (rates, slip_rates) = builder.complete_both(rates, slip_rates);
        Ok(Sliding { rates, slip_rates })
    }
}

/// An interface, or a cluster of some that move alike.
#[derive(Debug, Default)]
struct Part {
    parameters: Vec<Place>,
    /// ln psi of each state variable, and psi.
    logs: Vec<Place>,
    states: Vec<Place>,
    slip_rate: Place,
    /// The normal stress over its mean, where it varies.
    normal: Option<Factor>,
}

impl Part {
    /// v without mass, at the stress tau: with the normal stress n the law has tau/n in the place of tau, and eta/n in that of eta.
    fn quasi_static(&self, builder: &mut Builder, law: &LawFile, tau: Place) -> Result<Place> {
        let (mut stress, mut parameters) = (tau, self.parameters.clone());
        if let Some(normal) = self.normal {
            stress = builder.binary(Binary::Quotient, tau, normal.value)?;
            if let Some(damping) = law.damping {
                parameters[damping] =
                    builder.binary(Binary::Quotient, parameters[damping], normal.value)?;
            }
        }
        let variables: Vec<Place> = std::iter::once(stress).chain(self.states.clone()).collect();
        Ok(builder.insert(&law.slip_rate, &variables, &parameters)?[0])
    }

    /// The rate of ln v, which stands at this place.
    fn accelerated(
        &self,
        builder: &mut Builder,
        (law, inertia): (&LawFile, &Inertia),
        (tau, place): (Place, usize),
    ) -> Result<Place> {
        let log_rate = builder.variable(place)?;
        let rate = std::iter::once(self.slip_rate);
        let variables: Vec<Place> = rate.chain(self.states.clone()).collect();
        let mut friction = builder.insert(&inertia.friction, &variables, &self.parameters)?[0];
        if let Some(normal) = self.normal {
            friction = builder.binary(Binary::Product, friction, normal.value)?;
        }
        let force = builder.binary(Binary::Difference, tau, friction)?;
        let mut of_rate = builder.over_exponential(force, log_rate)?;
        if let Some(damping) = law.damping {
            of_rate = builder.binary(Binary::Difference, of_rate, self.parameters[damping])?;
        }
        builder.binary(Binary::Quotient, of_rate, self.parameters[inertia.mass])
    }

    /// The rate of ln psi with what the normal stress adds to it, where the law has such a coupling.
    fn coupled(&self, builder: &mut Builder, law: &LawFile, rate: Place) -> Result<Place> {
        let (Some(normal), Some(alpha), Some(b)) = (
            self.normal,
            law.place(NORMAL_STRESS_COUPLING),
            law.place(EVOLUTION_EFFECT),
        ) else {
            return Ok(rate);
        };
        let ratio = builder.binary(Binary::Quotient, self.parameters[alpha], self.parameters[b])?;
        let moved = builder.binary(Binary::Product, ratio, normal.growth)?;
        builder.binary(Binary::Difference, rate, moved)
    }
}

impl LawFile {
    /// The variables of so many interfaces or clusters with this law.
    pub(super) fn layout(&self, parts: usize) -> StateLayout {
        StateLayout {
            parts,
            states: self.evolutions.len(),
            mass: self.inertia.is_some(),
        }
    }
}
