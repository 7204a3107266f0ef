//! Interfaces whose friction law is from a file, and what the options say about them.

use super::file::PHASE;
use super::forcing::TimeIs;
use super::friction::Friction;
use super::law_file::{DRIVING, LawFile, STIFFNESS};
use super::model::number;
use super::slab_options::{Own, counts, damped, extended, parameters, unit_of_stress, units};
use super::sliding::{Sliding, StateLayout};
use crate::scene::options::{ModelOptions, SlabOptions};
use crate::scene::plan::{NEAR_SYMMETRIC, USUAL_START};
use crate::scene::units::{Quantity, Units};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::friction::positive;
use twinslip::integrate::AnyField;
use twinslip::model::TextSystem;
use twinslip::number::{Interval, Jet, Real, Uncertain};
use twinslip::orbit::{AlongArcs, ShootingNodes, WithinCluster, within_clusters};
use twinslip::random::Random;

/// Interfaces under one stress, with the law of a file: each on its own, or in clusters that move alike.
#[derive(Debug, Clone, PartialEq)]
pub struct TextSlab {
    law: LawFile,
    /// How many interfaces there are in each cluster.
    counts: Vec<usize>,
    /// For each cluster where the law's own parameters stand among those of the system.
    places: Vec<Vec<usize>>,
    /// V_H, where it is given.
    pub(super) driving: Option<f64>,
    /// K, where given.
    pub(super) stiffness: Option<f64>,
    /// The units of the numbers.
    pub(super) units: Units,
}

impl TextSlab {
    /// The interfaces that the options describe, and their equations. Of V_H and K those that are `free` need not be given.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub(super) fn new(
        law: LawFile,
        options: &ModelOptions,
        (free, time): (&[&str], TimeIs),
    ) -> Result<(Self, TextSystem)> {
        let counts = counts(&options.slab)?;
        let interfaces = counts.len();
        let units = units(&law, &options.slab)?;
        let law = extended(law, &options.slab, (&units, free))?;
        if law.layout(interfaces).has_more() && counts.iter().any(|&count| count > 1) {
            return Err(Error::Input(
                "`clusters` that split are of interfaces with one state variable and without mass; leave it out, or give each cluster one interface".into(),
            ));
        }
        let law = damped(law, options, (&units, free))?;
        let law = match unit_of_stress(&options.slab, &units, free)? {
            Some(unit) => law.scaled(unit)?,
            None => law,
        };
        let mut loading = [options.driving, options.stiffness];
        let own = parameters(&law, options, (interfaces, &units, free), &mut loading)?;
        for (name, value) in ["driving", "stiffness"].into_iter().zip(&mut loading) {
            let allows_rest = name == "driving" && *value == Some(0.0) && free.contains(&name);
            if let Some(value) = value.as_mut().filter(|_| !allows_rest) {
                *value = units.inward(Quantity::of_parameter(name), positive(name, *value)?);
            }
        }
        let [driving, stiffness] = loading;
        let needed = |name: &str, symbol: &str, value: Option<f64>| match value {
            // Any value, which is set before it counts.
            None if free.contains(&name) => Ok(1.0),
            None => Err(Error::Input(format!(
                "`{name}` {symbol} is missing, and has no default"
            ))),
            Some(value) => Ok(value),
        };
        let mut names = vec![
            ("driving".to_owned(), needed("driving", "V_H", driving)?),
            ("stiffness".to_owned(), needed("stiffness", "K", stiffness)?),
        ];
        let mut places = vec![Vec::new(); interfaces];
        for Own {
            name,
            values,
            differs,
        } in own
        {
            for (i, places) in places.iter_mut().enumerate() {
                places.push(names.len() + if differs { i } else { 0 });
            }
            if differs {
                let each = values.iter().enumerate();
                names.extend(each.map(|(i, &value)| (format!("{name}_{}", i + 1), value)));
            } else {
                names.push((name, values[0]));
            }
        }
        let twice = |(i, (name, _)): &(usize, &(String, f64))| {
            names[..*i].iter().any(|(other, _)| other == name)
        };
        if let Some((_, (name, _))) = names.iter().enumerate().find(twice) {
            return Err(Error::Input(format!(
                "`set`: {name} is both a parameter of the law {} and that of one interface",
                law.name
            )));
        }
        let mut slab = TextSlab {
            law,
            counts,
            places,
            driving,
            stiffness,
            units,
        };
        let parameters: Vec<(&str, f64)> = names.iter().map(|(n, x)| (n.as_str(), *x)).collect();
        if time == TimeIs::Phase {
            slab.forced(&parameters)?;
        }
        let system = slab.system(&parameters, false)?;
        Ok((slab, system))
    }

    /// Whether a parameter varies in time.
    pub(super) fn varies_in_time(&self, name: &str) -> bool {
        self.law.modulation(name).is_some()
    }

    /// How many interfaces there are.
    pub fn interfaces(&self) -> usize {
        self.counts.iter().sum()
    }

    /// How many of them there are in each cluster.
    pub fn clusters(&self) -> &[usize] {
        &self.counts
    }

    /// Which variables they have.
    pub(in crate::scene) fn layout(&self) -> StateLayout {
        self.law.layout(self.counts.len())
    }

    /// Groups of clusters as large, each by its variables, with the same parameters whatever varies: an exchange of these is no change.
    pub(in crate::scene) fn interchangeable(&self) -> Vec<Vec<Vec<usize>>> {
        let same = |i: usize, j: usize| {
            self.counts[i] == self.counts[j] && self.places[i] == self.places[j]
        };
        let of = |first: usize| {
            let all = (first..self.counts.len()).filter(|&i| same(first, i));
            all.map(|i| self.layout().of_part(i)).collect::<Vec<_>>()
        };
        let firsts = (0..self.counts.len()).filter(|&i| (0..i).all(|j| !same(i, j)));
        firsts.map(of).filter(|group| group.len() > 1).collect()
    }

    /// Whether all parts are in one state, where two numbers are the same by this.
    pub(in crate::scene) fn move_alike(
        &self,
        state: &[f64],
        same: impl Fn(f64, f64) -> bool,
    ) -> bool {
        let layout = self.layout();
        let first = layout.of_part(0);
        (1..layout.parts).all(|part| {
            let mut pairs = layout.of_part(part).into_iter().zip(&first);
            pairs.all(|(i, &j)| same(state[i], state[j]))
        })
    }

    /// Whether there are two parts, as large, whose parameters are the same, in a state space of three dimensions.
    pub(in crate::scene) fn are_equal(&self, system: &TextSystem) -> bool {
        let equal = matches!(self.counts[..], [one, other] if one == other);
        equal && !self.layout().has_more() && !self.differ(system)
    }

    /// Whether the interfaces differ in any parameter of the law.
    pub(in crate::scene) fn differ(&self, system: &TextSystem) -> bool {
        let own = |places: &Vec<usize>| -> Vec<f64> {
            places.iter().map(|&i| system.parameters()[i]).collect()
        };
        self.places
            .windows(2)
            .any(|pair| own(&pair[0]) != own(&pair[1]))
    }

    /// What the law is called.
    pub fn law_name(&self) -> &str {
        &self.law.name
    }

    /// The parameters of these interfaces as an object has them.
    pub(super) fn echo(&self, system: &TextSystem, slab: &SlabOptions) -> Map<String, Value> {
        let all = system.parameter_names().iter().zip(system.parameters());
        let all = all.map(|(name, &x)| {
            let quantity = Quantity::of_parameter(name);
            (
                name,
                self.units
                    .outward_uncertain(quantity, Uncertain::new(x, 0.0))
                    .value,
            )
        });
        let own = all.clone().skip(STIFFNESS + 1);
        let own: Map<String, Value> = own.map(|(n, x)| ((*n).to_owned(), json!(x))).collect();
        let mut echo = Map::new();
        echo.insert("law".into(), json!(self.law.name));
        echo.insert("interfaces".into(), json!(self.interfaces()));
        if self.interfaces() > 2 || self.has_clusters() {
            echo.insert("clusters".into(), json!(self.counts));
        }
        for (name, value) in all.take(STIFFNESS + 1) {
            echo.insert((*name).to_owned(), json!(value));
        }
        echo.insert("formulas".into(), json!(self.law.fingerprint));
        echo.insert("states".into(), json!(system.states()));
        echo.insert("parameters".into(), Value::Object(own));
        if slab.si {
            let unit = |quantity| json!(self.units.factor(quantity));
            echo.insert("si".into(), json!(true));
            echo.insert("slip_length".into(), unit(Quantity::Length));
            echo.insert("reference_rate".into(), unit(Quantity::SlipRate));
            echo.insert("normal_stress".into(), unit(Quantity::NormalStress));
            echo.insert("time_unit".into(), json!(slab.time_unit));
        }
        echo
    }

    /// The equations at these parameters; on a ramp V_H is the last state, and its rate of change stands in its place.
    fn system(&self, parameters: &[(&str, f64)], ramp: bool) -> Result<TextSystem> {
        let parts = (&*self.places, &*self.counts);
        let Sliding { rates, slip_rates } = Sliding::of(&self.law, parts, ramp)?;
        let mut states = self.layout().names();
        if ramp {
            states.push("driving".into());
        }
        let forced = self.law.forced_by.is_some();
        if forced {
            states.push(PHASE.into());
        }
        let states: Vec<&str> = states.iter().map(String::as_str).collect();
        let system = TextSystem::sliding((rates, slip_rates), &states, parameters)?;
        Ok(match forced {
            true => system.forced(),
            false => system,
        })
    }

    /// Takes the phase of what varies in time as a state in the place of time.
    fn forced(&mut self, parameters: &[(&str, f64)]) -> Result<()> {
        let periods = self.law.modulations.iter().flat_map(|one| {
            let each = self.places.iter();
            each.map(|places| parameters[places[one.period()]])
        });
        let mut periods: Vec<(&str, f64)> = periods.collect();
        periods.dedup();
        if let [(first, one), (second, other), ..] = periods[..]
            && periods.iter().any(|(_, period)| *period != one)
        {
            return Err(Error::Input(format!(
                "`modulate`: {first} is {one} and {second} {other}; all that varies must have one period, except in `integrate`"
            )));
        }
        self.law.forced_by = self.law.modulations.first().map(|one| one.period());
        Ok(())
    }

    /// The same equations on a ramp of V_H, which is then the last state.
    pub(super) fn on_ramp(&self, system: &TextSystem, rate: f64) -> Result<TextSystem> {
        let all = system.parameter_names().iter().zip(system.parameters());
        let mut parameters: Vec<(&str, f64)> = all.map(|(name, &x)| (*name, x)).collect();
        parameters[DRIVING] = ("driving_rate", rate);
        self.system(&parameters, true)
    }

    /// The friction of an interface at the parameters of the system.
    pub fn friction(&self, system: &TextSystem, interface: usize) -> Friction<'_> {
        let all = system.parameters();
        let places = self.places[interface].iter();
        Friction::new(&self.law, places.map(|&place| all[place]).collect())
    }

    /// The multipliers of an orbit within its clusters, at the parameters of the system.
    ///
    /// # Errors
    /// Those of [`within_clusters`].
    pub(in crate::scene) fn within(
        &self,
        system: &TextSystem,
        shooting: &ShootingNodes,
        along: AlongArcs,
    ) -> Result<Vec<WithinCluster>> {
        let each: Vec<_> = (0..self.counts.len())
            .map(|i| self.friction(system, i))
            .collect();
        let rate = |cluster: usize, [tau, w]: [f64; 2]| {
            let psi = Real::exp(Jet::variable(w, 1));
            each[cluster].split_rate(Jet::variable(tau, 0), psi)
        };
        let field = AnyField::of_text(Cow::Borrowed(system))?;
        within_clusters(&field, shooting, &self.counts, &rate, along)
    }

    /// The eigenvalues of an equilibrium within its clusters, with what the state's last digits make of them.
    pub(in crate::scene) fn within_state(
        &self,
        system: &TextSystem,
        state: &Vector,
    ) -> Vec<WithinCluster> {
        /// Of a state, in units of 1 + |x|.
        const ROUNDED: f64 = 4.0 * f64::EPSILON;
        let counts = self.counts.iter().enumerate();
        let split = counts.filter(|(_, count)| **count > 1);
        let within = split.map(|(i, &count)| {
            let [tau, w] = [state[0], state[i + 1]];
            let psi = Real::exp(Jet::variable(w, 1));
            let friction = self.friction(system, i);
            let rate: Jet<f64, 2> = friction.split_rate(Jet::variable(tau, 0), psi);
            let [of_tau, of_state] = rate.gradient.map(f64::abs);
            let moved = of_tau * (1.0 + tau.abs()) + of_state * (1.0 + w.abs());
            WithinCluster {
                cluster: i + 1,
                multiplicity: count - 1,
                ln_abs: Uncertain::new(rate.value, ROUNDED * (moved + rate.value.abs())),
            }
        });
        within.collect()
    }

    /// tau and ln psi of every interface, as `--start` gives them.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Parameter`] for what can't be read or is outside its domain, [`Error::NotConverged`] where the law
    /// has no steady state at which to start.
    pub(in crate::scene) fn start(
        &self,
        text: Option<&str>,
        system: &TextSystem,
    ) -> Result<Vec<f64>> {
        let text = text.unwrap_or(USUAL_START);
        let layout = self.layout();
        let shape = shape_of_start(layout);
        let unreadable = || {
            Error::Input(format!(
                "`start` {text:?} must be {shape}, {USUAL_START}[:EPS] or {SPREAD}[:EPS[:SEED]]"
            ))
        };
        let read = |part: &str| {
            number(part).ok_or_else(|| {
                Error::Input(format!("`start` {text:?}: {part:?} is not a finite number"))
            })
        };
        if let Some(rest) = text.strip_prefix(USUAL_START) {
            let asymmetry = match rest.strip_prefix(':') {
                Some(part) => read(part)?,
                None if rest.is_empty() => NEAR_SYMMETRIC,
                None => return Err(unreadable()),
            };
            return self.near_symmetric(asymmetry, system, &shape);
        }
        if let Some(rest) = text.strip_prefix(SPREAD) {
            let mut parts = rest.split(':');
            let begins = parts.next() == Some("");
            let by = parts.next().map_or(Ok(NEAR_SYMMETRIC), read)?;
            let seed = parts.next().map_or(Ok(1), str::parse);
            return match (seed, parts.next()) {
                (Ok(seed), None) if begins => self.spread(by, seed, system, &shape),
                _ => Err(unreadable()),
            };
        }
        let mut start = text.split(',').map(read).collect::<Result<Vec<f64>>>()?;
        if start.len() != layout.count() {
            return Err(unreadable());
        }
        start[0] = self.units.inward(Quantity::Stress, start[0]);
        for (place, value) in start.iter_mut().enumerate().skip(1) {
            let (name, quantity) = match layout.quantity(place) {
                Quantity::LogSlipRate => ("v in `start`", Quantity::SlipRate),
                _ => ("psi in `start`", Quantity::State),
            };
            *value = self.units.inward(quantity, positive(name, *value)?).ln();
        }
        Ok(start)
    }

    /// What stress and ln psi have where every interface slides steadily, at rates from a small part of V_H to all of it. Equilibria have
    /// rates whose sum is V_H.
    pub(super) fn steady_box(&self, system: &TextSystem) -> Result<Vec<Interval>> {
        /// The least rate over V_H, and at how many rates the range is looked at.
        const LEAST: f64 = 1e-6;
        const RATES: usize = 61;
        /// Of a range, on either side of it.
        const MARGIN: f64 = 0.05;
        let driving = system.parameters()[DRIVING];
        let layout = self.layout();
        let mut ends = vec![(f64::INFINITY, f64::NEG_INFINITY); layout.count()];
        let mut put = |i: usize, x: f64| ends[i] = (ends[i].0.min(x), ends[i].1.max(x));
        for i in 0..self.counts.len() {
            let friction = self.friction(system, i);
            for k in 0..RATES {
                // What moves alike has equal parts of V_H.
                let v = match self.counts[..] {
                    [count] => driving / count as f64,
                    _ => driving * LEAST.powf(k as f64 / (RATES - 1) as f64),
                };
                let steady = friction.steady(v)?;
                put(0, steady.stress);
                for (which, w) in steady.log_states.into_iter().enumerate() {
                    put(layout.log_state(which, i), w);
                }
                if layout.mass {
                    put(layout.log_slip_rate(i), v.ln());
                }
            }
        }
        let wider = |(low, high): (f64, f64)| {
            let by = MARGIN * (high - low) + MARGIN;
            Interval::new(low - by, high + by)
        };
        Ok(ends.into_iter().map(wider).collect())
    }

    /// The steady stress of the first interface at an equal share of V_H.
    pub(in crate::scene) fn mean_stress(&self, system: &TextSystem) -> Result<f64> {
        let v = system.parameters()[DRIVING] / self.interfaces() as f64;
        Ok(self.friction(system, 0).steady(v)?.stress)
    }

    /// A start of interfaces that move alike: all in their steady states, and moved by exp(EPS) of the usual start.
    pub(super) fn alike(&self, system: &TextSystem) -> Result<Vec<f64>> {
        let mut start = self.start(Some(&format!("{USUAL_START}:0")), system)?;
        start[1..=self.counts.len()]
            .iter_mut()
            .for_each(|w| *w += NEAR_SYMMETRIC);
        Ok(start)
    }

    /// Each interface in its steady state at an equal share of V_H, the stress that of the first, and the last one moved by exp(EPS).
    fn near_symmetric(&self, by: f64, system: &TextSystem, shape: &str) -> Result<Vec<f64>> {
        let mut start = self.steady(USUAL_START, system, shape)?;
        start[self.counts.len()] += by;
        Ok(start)
    }

    /// The same, and each psi times exp(EPS z), z drawn between -1 and 1.
    fn spread(&self, by: f64, seed: u64, system: &TextSystem, shape: &str) -> Result<Vec<f64>> {
        let mut start = self.steady(SPREAD, system, shape)?;
        let mut random = Random::new(seed, 0);
        for log_state in &mut start[1..=self.counts.len()] {
            *log_state += by * random.between((-1.0, 1.0));
        }
        Ok(start)
    }

    /// Each interface in its steady state at an equal share of V_H, the stress that of the first.
    fn steady(&self, name: &str, system: &TextSystem, shape: &str) -> Result<Vec<f64>> {
        let driving = system.parameters()[DRIVING];
        if driving == 0.0 {
            return Err(Error::Input(format!(
                "`start` {name} is at the steady state, of which there is none at V_H = 0: give `start` {shape}"
            )));
        }
        let v = driving / self.interfaces() as f64;
        let layout = self.layout();
        let mut start = vec![0.0; layout.count()];
        for i in 0..self.counts.len() {
            let steady = self.friction(system, i).steady(v)?;
            if i == 0 {
                start[0] = steady.stress;
            }
            for (which, w) in steady.log_states.into_iter().enumerate() {
                start[layout.log_state(which, i)] = w;
            }
            if layout.mass {
                start[layout.log_slip_rate(i)] = v.ln();
            }
        }
        Ok(start)
    }

    /// Whether any interfaces move alike by being in one cluster.
    pub(in crate::scene) fn has_clusters(&self) -> bool {
        self.counts.iter().any(|&count| count > 1)
    }
}

/// What a start has: tau, psi of each part, psi of the second state variable of each, and the slip rate of each with mass.
fn shape_of_start(layout: StateLayout) -> String {
    let mut shape = "TAU".to_owned();
    let second = (layout.states > 1).then_some("SECOND_PSI");
    let mass = layout.mass.then_some("V");
    for name in std::iter::once("PSI").chain(second).chain(mass) {
        shape += &match layout.parts {
            1 => format!(",{name}"),
            2 => format!(",{name}1,{name}2"),
            count => format!(",{name}1,...,{name}{count}"),
        };
    }
    shape
}

/// A start at steady states that are moved apart at random.
pub(in crate::scene) const SPREAD: &str = "spread";
